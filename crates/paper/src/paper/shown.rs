//! One run of four ants as in the paper: series over time, snapshots of load, springs and ants, and
//! the path.

use std::cell::RefCell;
use std::rc::Rc;

use super::facts::{Changes, Series, series_in_window, series_of};
use super::trial::{Case, Trial};
use cohaul::backend::Motion;
use cohaul::math::{Pose, Summary, Vec2};
use cohaul::model::ant::Ant;
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Ants, Commands, Controller, Keep, Row, Simulation, View};

/// A run for figures.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// `None` for a scene that is none of the paper's trials.
    pub trial: Option<Trial>,
    pub seed: u64,
    pub series: Series,
    /// Changes within the window of [`series_in_window`], and its start and end (s).
    pub changes: Changes,
    pub window_s: [f64; 2],
    /// Of the load (m), at every window of the series.
    pub path: Vec<Vec2>,
    pub snapshots: Vec<Snapshot>,
    pub load_radius: f64,
    pub nest: Vec2,
    pub arrival_radius: f64,
}

/// Everything at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// (s)
    pub time: f64,
    pub load: Pose,
    /// Root and tip (m, world), and whether it is held.
    pub springs: Vec<([Vec2; 2], bool)>,
    pub ants: Vec<Ant>,
    /// Number of ants that pull (1).
    pub n_pulling: usize,
}

/// Instants that are shown, over the run's length (1).
const SHARES: [f64; 6] = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];
/// Ants are looked at so often (s).
const LOOK_S: f64 = 0.25;

/// Runs `trial` of `case` at `seed` and keeps the data of the figures; `None` for a trial without
/// ants.
pub fn shown(trial: Trial, case: &Case, seed: u64) -> Option<Shown> {
    let scenario = trial.scenario(case, seed);
    let Drive::Ants(drive) = &scenario.drive else { return None };
    let seen = Rc::new(RefCell::new(Seen::new()));
    let controller = Watched { ants: Ants::new(&scenario, drive), every: LOOK_S, seen: Rc::clone(&seen) };
    let mut run = Simulation::with_controller(&scenario, &case.options(&scenario), Keep::Trace, Box::new(controller));
    run.run(|_| true);
    let (trace, outcome) = run.into_results();
    let seen = seen.borrow();
    let instants = SHARES.map(|share| share * outcome.time);
    let snapshot = |time: f64| {
        let (time, ants) = seen.iter().rev().find(|(at, _)| *at <= time).or(seen.first())?;
        let row = trace.rows.get(trace.rows.partition_point(|row| row.time < *time))?;
        Some(Snapshot {
            time: *time,
            load: row.motion.pose,
            springs: springs(&scenario, row),
            ants: ants.clone(),
            n_pulling: row.tips.len(),
        })
    };
    let stride = (LOOK_S / scenario.control_period).round().max(1.0) as usize;
    let in_window = series_in_window(&trace, &scenario);
    Some(Shown {
        trial: Some(trial),
        seed,
        changes: Changes::of(&in_window, seed),
        window_s: in_window.span(),
        series: series_of(&trace, &scenario),
        path: trace.rows.iter().step_by(stride).map(|row| row.motion.pose.position).collect(),
        snapshots: instants.into_iter().filter_map(snapshot).collect(),
        load_radius: scenario.system.load.radius,
        nest: drive.nest_position,
        arrival_radius: drive.arrival_radius,
    })
}

/// Root and tip (m, world) of each spring, and whether it is held.
pub(crate) fn springs(scenario: &Scenario, row: &Row) -> Vec<([Vec2; 2], bool)> {
    let pose = &row.motion.pose;
    let of = |(at, spring): (usize, &cohaul::model::PolarSpring)| {
        let held = row.tips.iter().find(|tip| tip.spring == at);
        let tip = held.map_or_else(|| pose.to_world(&spring.rest_tip()), |tip| tip.position);
        ([pose.to_world(&spring.root), tip], held.is_some())
    };
    scenario.system.springs.iter().enumerate().map(of).collect()
}

/// Ants at some times (s).
type Seen = Vec<(f64, Vec<Ant>)>;

/// Ants that leave a note of themselves now and then.
struct Watched {
    ants: Ants,
    every: f64,
    seen: Rc<RefCell<Seen>>,
}

impl Controller for Watched {
    fn decide(&mut self, view: &View, commands: &mut Commands) {
        self.ants.decide(view, commands);
        let mut seen = self.seen.borrow_mut();
        if seen.last().is_none_or(|(last, _)| view.time >= last + self.every) {
            seen.push((view.time, self.ants.ants().to_vec()));
        }
    }

    fn targets(&mut self, view: &View, until: f64) -> &[Vec2] {
        self.ants.targets(view, until)
    }

    fn arrived(&self, motion: &Motion) -> Option<bool> {
        self.ants.arrived(motion)
    }

    fn pulls(&self) -> Summary {
        self.ants.pulls()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::backend::BackendKind;
    use cohaul::model::ant::Mode;
    use cohaul::scenario::presets::Preset;

    /// The figures show the run that is compared. Pulling ants stand at attached tips.
    #[test]
    fn a_watched_run_is_the_run() {
        let case = Case::new(Preset::default(), BackendKind::QuasiStatic);
        let shown = shown(Trial::FIVE_TEN, &case, 2).unwrap();
        let facts = super::super::run(Trial::FIVE_TEN, &case, 2, |_| true).unwrap();
        assert_eq!(shown.changes, facts.changes);
        assert_eq!(shown.snapshots.len(), SHARES.len());
        for snapshot in &shown.snapshots[1..] {
            for ant in &snapshot.ants {
                if let Mode::Transport { spring, .. } = ant.mode {
                    assert_eq!(snapshot.springs[spring], ([snapshot.springs[spring].0[0], ant.position], true));
                }
            }
        }
    }
}
