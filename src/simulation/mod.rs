//! Floor 3: behaviour, backend and clock make a trace. The loop that everybody reads first is [`Simulation::step`].

mod ants;
mod clock;
mod periods;
mod releases;
mod replay;
pub mod run_facts;
mod saved;
mod sensing;
mod tips;
mod trace;

use serde::{Deserialize, Serialize};

use crate::backend::{
    Backend, BackendOptions, Motion, PoseError, RestoreError, SkipCounts, Skips, StepReport, Transition, TransitionCounts, build,
};
use crate::math::{Summary, Vec2};
use crate::scenario::{Drive, Scenario};
use clock::Clock;

pub use crate::backend::{AttachedTip, AttachedTips};
pub use ants::{Ants, follow_ants};
pub(crate) use clock::SAME_INSTANT;
pub use replay::Replay;
pub use saved::SavedRun;
pub use tips::Tips;
pub use trace::{Event, EventKind, Outcome, Row, Trace};

/// What moves the tips: grasps, releases and paths, from what it sees of the load.
///
/// A controller that draws a spring along and lets go as soon as the load has come 10 mm:
///
/// ```
/// use cohaul::backend::{BackendKind, BackendOptions, Motion, RestoreError};
/// use cohaul::math::Vec2;
/// use cohaul::scenario::Scenario;
/// use cohaul::simulation::{Driver, Event, EventKind, Keep, Orders, Simulation, View};
///
/// struct Tow {
///     tip: Vec2,
///     is_held: bool,
///     is_done: bool,
/// }
///
/// impl Driver for Tow {
///     fn decide(&mut self, view: &View, orders: &mut Orders) {
///         let has_come = view.motion.pose.position.x >= 0.01;
///         let kind = match (self.is_held, has_come) {
///             (false, false) if !self.is_done => EventKind::Grasp,
///             (true, true) => EventKind::Release,
///             _ => return,
///         };
///         (self.is_held, self.is_done) = (!self.is_held, has_come);
///         orders.events.push(Event { time: view.time, kind, spring: 0, ant: None, tip: self.tip });
///     }
///
///     fn targets(&mut self, view: &View, until: f64) -> &[Vec2] {
///         if self.is_held {
///             self.tip.x += 0.05 * (until - view.time);
///         }
///         std::slice::from_ref(&self.tip)
///     }
///
///     fn next_instant(&self, _time: f64) -> Option<f64> {
///         None
///     }
///
///     fn arrived(&self, _motion: &Motion) -> Option<bool> {
///         None
///     }
///
///     // A run of this controller is not meant to be saved.
///     fn save(&self) -> serde_json::Value {
///         serde_json::Value::Null
///     }
///
///     fn restore(&mut self, _state: &serde_json::Value) -> Result<(), RestoreError> {
///         Err(RestoreError("a tow has no state".into()))
///     }
/// }
///
/// let scenario = Scenario::read("scenarios/analytic/centre-pull.json".as_ref())?;
/// for kind in BackendKind::ALL {
///     let tow = Tow { tip: Vec2::zeros(), is_held: false, is_done: false };
///     let mut run = Simulation::driven(&scenario, &BackendOptions::new(kind, 1e-3), Keep::Trace, Box::new(tow));
///     run.run(|_time| true);
///     let (trace, outcome) = run.into_results();
///     let released = trace.events.last().filter(|event| event.kind == EventKind::Release);
///     // The tip is ahead of the load by what the spring is stretched: f / k = 33 mm, and 43 mm take 0.86 s.
///     assert!(released.is_some_and(|event| (event.time - 0.86).abs() < 0.06), "{kind:?}");
///     assert!(outcome.motion.pose.position.x >= 0.01);
/// }
/// # Ok::<(), cohaul::scenario::ScenarioError>(())
/// ```
pub trait Driver {
    /// Adds what happens at this instant to `orders`, which are empty.
    fn decide(&mut self, view: &View, orders: &mut Orders);

    /// Where the tips are to be at the time `until` (s; m, world, one entry a spring), on straight ways from where they are now.
    fn targets(&mut self, view: &View, until: f64) -> &[Vec2];

    /// The first time after `time` (s), besides ticks, at which something happens or a tip turns.
    fn next_instant(&self, time: f64) -> Option<f64>;

    /// Whether the load is where it should go; `None` when it has no such place.
    fn arrived(&self, motion: &Motion) -> Option<bool>;

    /// Pulls at the ants' decisions (N).
    fn pulls(&self) -> Summary {
        Summary::default()
    }

    fn save(&self) -> serde_json::Value;

    /// # Errors
    /// When the state is not one that a driver of this kind saved.
    fn restore(&mut self, state: &serde_json::Value) -> Result<(), RestoreError>;

    /// # Errors
    /// When the state restored last is not one at this `tick` with these tips held.
    fn check(&self, _tick: u64, _tips: &[AttachedTip]) -> Result<(), RestoreError> {
        Ok(())
    }
}

/// What a driver can see at one instant.
pub struct View<'a> {
    pub scenario: &'a Scenario,
    pub backend: &'a dyn Backend,
    /// Of the load.
    pub motion: Motion,
    /// Held tips in the order of their springs, if somebody has looked at them.
    pub tips: &'a [AttachedTip],
    /// (s)
    pub time: f64,
    /// Number of the tick at this instant; `None` between ticks.
    pub tick: Option<u64>,
    /// What may be left out.
    pub skips: Skips,
}

impl View<'_> {
    /// Force of the holder on the tip of a spring (N, world); zero where nobody holds it.
    pub fn pull(&self, spring: usize) -> Vec2 {
        // Where all springs before it are held, it stands at its own number.
        let at_its_number = self.tips.get(spring).filter(|tip| tip.spring == spring);
        let seen = at_its_number.or_else(|| Some(&self.tips[self.tips.binary_search_by_key(&spring, |tip| tip.spring).ok()?]));
        seen.map_or_else(|| self.backend.pull(spring), |tip| tip.pull)
    }
}

/// What a driver does at one instant: releases first, then grasps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Orders {
    pub events: Vec<Event>,
    /// What was left out on the way to them.
    pub skipped: SkipCounts,
}

/// What is kept of a run while it goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Keep {
    /// Rows and events.
    Trace,
    /// Only how it ends: memory does not grow with the run.
    Outcome,
}

/// One run of one scenario on one backend.
pub struct Simulation<'a> {
    scenario: &'a Scenario,
    options: BackendOptions,
    backend: Box<dyn Backend>,
    driver: Box<dyn Driver>,
    keep: Keep,
    clock: Clock,
    finished: bool,
    steps: StepReport,
    error: Option<PoseError>,
    transitions: TransitionCounts,
    trace: Trace,
    /// Of the springs that are held, in their order. Where a trace is kept it has their places and pulls at this instant, looked at once for all.
    tips: AttachedTips,
    /// Kept for its memory.
    orders: Orders,
}

impl<'a> Simulation<'a> {
    /// A run of the scenario as it stands.
    ///
    /// # Panics
    /// When the options are none that [`build`] takes.
    pub fn new(scenario: &'a Scenario, options: &BackendOptions, keep: Keep) -> Self {
        Self::driven(scenario, options, keep, driver_of(scenario))
    }

    /// A run of the scenario's load with another driver than the scenario's own.
    ///
    /// # Panics
    /// As [`Simulation::new`].
    pub fn driven(scenario: &'a Scenario, options: &BackendOptions, keep: Keep, driver: Box<dyn Driver>) -> Self {
        Self::on(scenario, options, keep, driver, built(scenario, options))
    }

    /// A run on a backend made elsewhere; `options` say what it is.
    pub fn on(scenario: &'a Scenario, options: &BackendOptions, keep: Keep, driver: Box<dyn Driver>, backend: Box<dyn Backend>) -> Self {
        let (steps, transitions, trace) = (StepReport::default(), TransitionCounts::default(), Trace::default());
        let (clock, finished, error) = (Clock::new(scenario.control_period, scenario.duration), false, None);
        let (tips, orders) = (held_by(scenario, backend.as_ref()), Orders::default());
        Self { scenario, options: *options, backend, driver, keep, clock, finished, steps, error, transitions, trace, tips, orders }
    }

    /// The same with a row at the end of each of `n_parts` equal parts of a control period, in place of at ticks alone. Meant for drivers to which one instant
    /// is as good as another: [`Tips`] and [`Replay`].
    pub fn in_parts(mut self, n_parts: u64) -> Self {
        self.clock.n_parts = n_parts.max(1);
        self
    }

    /// Runs to the end; `watch` sees the time (s) before every step and says whether to go on.
    pub fn run(&mut self, mut watch: impl FnMut(f64) -> bool) {
        while !self.finished && watch(self.clock.time) {
            self.step();
        }
    }

    /// Runs to the end like [`Simulation::run`], and lets `see` have the rows, some at a time, in place of keeping them; the last of them are left in the trace.
    ///
    /// # Errors
    /// Those of `see`, which end the run.
    pub fn run_past<E>(&mut self, mut watch: impl FnMut(f64) -> bool, mut see: impl FnMut(&[Row]) -> Result<(), E>) -> Result<(), E> {
        // What a processor has nearest to it.
        const SOME: usize = 64;
        while !self.finished && watch(self.clock.time) {
            self.step();
            if self.trace.rows.len() >= SOME {
                see(&self.trace.rows)?;
                self.trace.rows.clear();
            }
        }
        Ok(())
    }

    /// Runs to the end like [`Simulation::run`]; under error control once more with smaller errors of strides, from a start that `afresh` makes, as long as they
    /// add up to more than the tolerance. What they add up to in the end, more than the tolerance or not, is in the outcome.
    pub fn run_within(&mut self, mut afresh: impl FnMut(&BackendOptions) -> Self, mut watch: impl FnMut(f64) -> bool) {
        while !self.finished && watch(self.clock.time) {
            self.step();
            if let Some(tighter) = self.options.tolerance.filter(|_| !self.is_within()).and_then(|tolerance| tolerance.tightened()) {
                let options = BackendOptions { tolerance: Some(tighter), ..self.options };
                *self = afresh(&options);
            }
        }
    }

    /// Whether the pose has been within the tolerance so far; always without one.
    fn is_within(&self) -> bool {
        self.options.tolerance.zip(self.error).is_none_or(|(tolerance, error)| tolerance.allows(&error))
    }

    /// Sense and decide, act, record, move on to the next instant; nothing once the run is finished.
    pub fn step(&mut self) {
        if self.finished {
            return;
        }
        if self.keep == Keep::Trace {
            self.backend.read_tips(&mut self.tips);
        }
        let motion = self.backend.motion();
        if self.is_over(&motion) {
            self.record(motion);
            self.finished = true;
            return;
        }
        let (tick, skips) = (self.clock.tick_now(), self.options.skips);
        let (scenario, time) = (self.scenario, self.clock.time);
        let tips = if self.keep == Keep::Trace { &self.tips[..] } else { &[] };
        self.driver.decide(&View { scenario, backend: self.backend.as_ref(), motion, tips, time, tick, skips }, &mut self.orders);
        self.act();
        self.record(motion);
        let until = self.clock.next(self.driver.next_instant(time));
        let view = View { scenario, backend: self.backend.as_ref(), motion, tips: &[], time, tick, skips };
        let targets = self.driver.targets(&view, until);
        self.steps.add(&self.backend.advance(targets, until - time));
        self.observe();
        self.clock.move_to(until);
    }

    pub fn is_finished(&self) -> bool {
        self.finished
    }

    /// (s)
    pub fn time(&self) -> f64 {
        self.clock.time
    }

    /// Pose and twist of the load now.
    pub fn motion(&self) -> Motion {
        self.backend.motion()
    }

    /// Number of springs that are held.
    pub fn n_held(&self) -> usize {
        self.tips.len()
    }

    /// What moves the load, as it is now.
    pub fn backend(&self) -> &dyn Backend {
        self.backend.as_ref()
    }

    pub fn trace(&self) -> &Trace {
        &self.trace
    }

    pub fn outcome(&self) -> Outcome {
        let motion = self.backend.motion();
        Outcome {
            time: self.clock.time,
            motion,
            energy: self.backend.energy(),
            steps: self.steps,
            transitions: self.transitions,
            error: self.error,
            arrived: self.driver.arrived(&motion),
            pulls: self.driver.pulls(),
        }
    }

    /// The trace and the outcome of a run that is over.
    pub fn into_results(self) -> (Trace, Outcome) {
        let outcome = self.outcome();
        (self.trace, outcome)
    }

    fn is_over(&self, motion: &Motion) -> bool {
        self.clock.is_at_end() || self.driver.arrived(motion) == Some(true)
    }

    /// Carries the orders out and empties them.
    fn act(&mut self) {
        for event in &self.orders.events {
            let Event { spring, tip: position, .. } = *event;
            let at = self.tips.partition_point(|tip| tip.spring < spring);
            match event.kind {
                EventKind::Release => {
                    self.backend.release(spring);
                    self.tips.remove(at);
                }
                EventKind::Grasp => {
                    self.backend.attach(spring, position);
                    self.tips.insert(at, AttachedTip { spring, position, pull: self.backend.pull(spring) });
                }
            }
        }
        if self.keep == Keep::Trace {
            self.trace.events.extend_from_slice(&self.orders.events);
        }
        self.steps.skipped.add(&std::mem::take(&mut self.orders.skipped));
        self.orders.events.clear();
    }

    /// What the backend says of the advance that it has made.
    fn observe(&mut self) {
        if let Some(now) = self.backend.pose_error() {
            self.error = Some(self.error.unwrap_or_default().max(&now));
        }
        for transition in self.backend.transitions() {
            self.transitions.add(&transition.kind);
            if self.keep == Keep::Trace {
                self.trace.transitions.push(Transition { time: self.clock.time + transition.time, ..*transition });
            }
        }
    }

    /// A row at every tick, at the ends of parts between them, and at the end.
    fn record(&mut self, motion: Motion) {
        if self.keep == Keep::Trace && (self.clock.ends_part() || self.is_over(&motion)) {
            let (energy, error) = (self.backend.energy(), self.backend.pose_error());
            self.trace.rows.push(Row { time: self.clock.time, motion, energy, tips: AttachedTips::new(), error });
            // Filled where it stands: a row is long.
            self.trace.rows.last_mut().expect("a row was just added").tips.extend_from_slice(&self.tips);
        }
    }
}

/// What makes the backend of a scenario: a parameter where another engine can be put in a backend's place.
pub type Make<'a> = dyn Fn(&Scenario, &BackendOptions) -> Box<dyn Backend> + Sync + 'a;

/// The scenario's load on the backend that the options name, which is what a [`Make`] is by default.
///
/// # Panics
/// As [`build`].
pub fn built(scenario: &Scenario, options: &BackendOptions) -> Box<dyn Backend> {
    build(&scenario.system, scenario.start, options)
}

/// The scenario's own driver.
pub fn driver_of(scenario: &Scenario) -> Box<dyn Driver> {
    match &scenario.drive {
        Drive::Tips(paths) => Box::new(Tips::new(scenario, paths)),
        Drive::Ants(drive) => Box::new(Ants::new(scenario, drive)),
    }
}

/// Tips of the springs that are held, in their order.
fn held_by(scenario: &Scenario, backend: &dyn Backend) -> AttachedTips {
    let held = |spring| Some(AttachedTip { spring, position: backend.tip(spring)?, pull: backend.pull(spring) });
    (0..scenario.system.springs.len()).filter_map(held).collect()
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;
    use std::rc::Rc;

    use super::*;
    use crate::backend::BackendKind;

    /// Ants that compare what they are shown with what the backend says tip by tip, and note the latter once they have acted.
    struct Looking {
        ants: Box<dyn Driver>,
        said: Rc<RefCell<Vec<AttachedTips>>>,
    }

    fn said(view: &View) -> AttachedTips {
        held_by(view.scenario, view.backend)
    }

    impl Driver for Looking {
        fn decide(&mut self, view: &View, orders: &mut Orders) {
            assert_eq!(view.tips, &said(view)[..], "at {} s", view.time);
            view.tips.iter().for_each(|tip| assert_eq!(view.pull(tip.spring), tip.pull));
            let free = (0..view.scenario.system.springs.len()).find(|spring| view.tips.iter().all(|tip| tip.spring != *spring));
            free.into_iter().for_each(|spring| assert_eq!(view.pull(spring), Vec2::zeros()));
            self.ants.decide(view, orders);
        }

        fn targets(&mut self, view: &View, until: f64) -> &[Vec2] {
            self.said.borrow_mut().push(said(view));
            self.ants.targets(view, until)
        }

        fn next_instant(&self, time: f64) -> Option<f64> {
            self.ants.next_instant(time)
        }

        fn arrived(&self, motion: &Motion) -> Option<bool> {
            self.ants.arrived(motion)
        }

        fn save(&self) -> serde_json::Value {
            self.ants.save()
        }

        fn restore(&mut self, state: &serde_json::Value) -> Result<(), RestoreError> {
            self.ants.restore(state)
        }
    }

    /// Parts of periods add rows and leave the rest as it is: those at ticks, at the end and the events, with waypoints, a release and the end between ticks and between
    /// parts; and so in a replay, whose tips go straight from one recorded row to the next.
    #[test]
    fn parts_of_periods_add_rows_and_change_nothing() {
        let text = include_str!("../../scenarios/analytic/ramp-and-hold.json")
            .replace("[0.5, 0.04, 0.0]] }", "[0.51, 0.04, 0.0], [0.625, 0.03, 0.001]], \"release_s\": 0.77 }")
            .replace("\"duration_s\": 1.0", "\"duration_s\": 0.93")
            .replace("\"control_period_s\": 0.001", "\"control_period_s\": 0.1");
        let scenario = Scenario::parse(&text, "ramps").unwrap();
        // Steps that end with each part and with each instant between them.
        let options = BackendOptions::new(BackendKind::QuasiStatic, 1e-4);
        let run = |driver: Box<dyn Driver>, n_parts| {
            let mut run = Simulation::driven(&scenario, &options, Keep::Trace, driver).in_parts(n_parts);
            run.run(|_| true);
            run.into_results().0
        };
        let of_tips = |n_parts| run(driver_of(&scenario), n_parts);
        let plain = of_tips(1);
        let replay = |n_parts| run(Box::new(Replay::new(std::sync::Arc::new(of_tips(100)), 1)), n_parts);
        assert_eq!(plain.rows.len(), 11);
        for (trace, n_parts) in [(of_tips(4), 4), (of_tips(7), 7), (replay(100), 100), (replay(300), 300)] {
            assert_eq!(trace.rows.len() as u64, (9.3 * n_parts as f64 - 1e-9).ceil() as u64 + 1, "{n_parts} parts");
            assert!(trace.rows.windows(2).all(|pair| pair[1].time - pair[0].time > 1e-3 / 4.0));
            // Roundings of places of some 0.04 m.
            let is_same =
                |a: &Row, b: &Row| (a.time - b.time).abs() < 1e-12 && (a.motion.pose.position - b.motion.pose.position).norm() < 1e-15;
            assert!(
                plain.rows.iter().all(|row| trace.rows.iter().any(|other| is_same(row, other))),
                "{n_parts} parts: a row at every tick"
            );
            assert!(of_tips(n_parts).rows.iter().zip(&trace.rows).all(|(row, other)| is_same(row, other)), "{n_parts} parts");
            assert_eq!(trace.events.len(), 2);
        }
    }

    /// Tips that are looked at together are, to the last bit, where and as each of them is: while a load waits, slips or has just been let go, on more springs than are
    /// evaluated side by side. A row after a grasp or a release has pulls from before for the others, which one by one are evaluated anew: roundings of places of
    /// 0.1 m under some 0.7 N/m.
    #[test]
    fn tips_looked_at_together_are_what_each_is() {
        let text = include_str!("../../scenarios/paper/four-ants-four-springs.json")
            .replace("\"n\": 4", "\"n\": 7")
            .replace("\"n_ants\": 4", "\"n_ants\": 7");
        let scenario = Scenario { duration: 8.0, ..Scenario::parse(&text, "seven ants").unwrap() };
        for (kind, step) in [(BackendKind::QuasiStatic, 2.5e-3), (BackendKind::Inertial, 2.5e-3), (BackendKind::Rapier, 1e-3)] {
            let options = BackendOptions::new(kind, step);
            let said = Rc::new(RefCell::new(Vec::new()));
            let driver = Looking { ants: driver_of(&scenario), said: Rc::clone(&said) };
            let mut run = Simulation::driven(&scenario, &options, Keep::Trace, Box::new(driver));
            run.run(|_| true);
            let trace = run.trace();
            assert!(trace.events.len() > 20 && trace.rows.iter().any(|row| row.tips.len() > 4), "{kind:?}");
            for (row, said) in trace.rows.iter().zip(said.borrow().iter()) {
                assert_eq!(row.tips.len(), said.len());
                for (tip, said) in row.tips.iter().zip(said) {
                    assert_eq!((tip.spring, tip.position), (said.spring, said.position));
                    assert!((tip.pull - said.pull).norm() < 1e-16, "{kind:?} at {} s: {tip:?} {said:?}", row.time);
                }
            }
        }
    }
}
