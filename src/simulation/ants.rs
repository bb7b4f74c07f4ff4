//! Ants: the behaviour model closed around the load (Eq. 17-23).
//!
//! A free spring relaxes to its rest shape, where the next ant finds its tip. `Deviation:` tips that stay where they were let go, as the paper may
//! be read, would tether the load to the ground.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::{Driver, Event, EventKind, Orders, View};
use crate::backend::{Motion, RestoreError};
use crate::math::{Chance, Stream, Summary, Vec2};
use crate::model::ant::{Ant, Command, Mode, steering_turn_rate};
use crate::model::behaviour::{Pace, hazard_of, heading_error, heading_for_pull, probability_within, pull_direction};
use crate::scenario::{AntDrive, Scenario};

/// All ants of one run.
pub struct Ants {
    drive: AntDrive,
    chance: Chance,
    control_period: f64,
    /// Probability of a grasp per tick in reach of a tip.
    grasp_probability: f64,
    state: State,
    targets: Vec<Vec2>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct State {
    ants: Vec<Ant>,
    pulls: Summary,
}

impl Ants {
    pub fn new(scenario: &Scenario, drive: &AntDrive) -> Self {
        let chance = Chance::new(scenario.seed);
        let period = scenario.control_period;
        let grasp_probability = match drive.grasp_pace {
            Pace::PerTick => drive.grasp_probability,
            Pace::Hazard | Pace::Aged => probability_within(hazard_of(drive.grasp_probability, drive.grasp_decision_period), period),
        };
        let start = |ant: usize| start_of(ant as u32, &chance, drive, &scenario.start);
        let state = State { ants: (0..drive.n_ants).map(start).collect(), pulls: Summary::default() };
        let targets = vec![Vec2::zeros(); scenario.system.springs.len()];
        Self { drive: drive.clone(), chance, control_period: period, grasp_probability, state, targets }
    }

    pub fn ants(&self) -> &[Ant] {
        &self.state.ants
    }

    /// Releases first: a spring let go at a tick can be taken by another ant at the same tick, not by the one that let go.
    fn release_and_grasp(&mut self, view: &View, tick: u64) -> Vec<Event> {
        let mut events = Vec::new();
        let n_ants = self.state.ants.len();
        let was_pulling: Vec<bool> = self.state.ants.iter().map(|ant| ant.mode != Mode::Search).collect();
        for i in (0..n_ants).filter(|i| was_pulling[*i]) {
            events.extend(self.release(i, view, tick));
        }
        let mut free: Vec<bool> = (0..self.targets.len()).map(|spring| view.backend.tip(spring).is_none()).collect();
        events.iter().for_each(|event| free[event.spring] = true);
        for i in (0..n_ants).filter(|i| !was_pulling[*i]) {
            if let Some(event) = self.grasp(i, view, tick, &free) {
                free[event.spring] = false;
                events.push(event);
            }
        }
        events
    }

    /// Eq. (18).
    fn release(&mut self, i: usize, view: &View, tick: u64) -> Option<Event> {
        let Mode::Transport { spring, grasp_tick } = self.state.ants[i].mode else { return None };
        let law = &self.drive.release;
        let n_decisions = |ticks: u64| (ticks as f64 * self.control_period / law.period + 1e-9).floor();
        let age = tick - grasp_tick;
        let is_decision = age > 0 && n_decisions(age) > n_decisions(age - 1);
        let pull = || view.backend.force_on_tip(spring).norm();
        if is_decision {
            self.state.pulls.add(pull());
        }
        let probability = match self.drive.release_pace {
            Pace::Aged if !is_decision => return None,
            Pace::Aged | Pace::PerTick => law.probability(pull()),
            Pace::Hazard => probability_within(law.hazard(pull()), self.control_period),
        };
        if age == 0 || self.chance.uniform(Stream::Release, i as u32, tick) >= probability {
            return None;
        }
        let ant = &mut self.state.ants[i];
        ant.mode = Mode::Search;
        Some(Event { time: view.time, spring, ant: Some(i), tip: ant.position, kind: EventKind::Release })
    }

    /// An ant in reach of free tips grasps the nearest, with the probability of one tick.
    fn grasp(&mut self, i: usize, view: &View, tick: u64, free: &[bool]) -> Option<Event> {
        let (spring, tip) = self.tip_in_reach(&self.state.ants[i].position, view, free)?;
        if self.chance.uniform(Stream::Grasp, i as u32, tick) >= self.grasp_probability {
            return None;
        }
        let ant = &mut self.state.ants[i];
        ant.mode = Mode::Transport { spring, grasp_tick: tick };
        ant.position = tip;
        self.state.pulls.add(0.0);
        Some(Event { time: view.time, spring, ant: Some(i), tip, kind: EventKind::Grasp })
    }

    fn tip_in_reach(&self, position: &Vec2, view: &View, free: &[bool]) -> Option<(usize, Vec2)> {
        let pose = view.backend.motion().pose;
        let springs = &view.scenario.system.springs;
        let reach = self.drive.sensing_range;
        let away = (position - pose.position).norm();
        let in_reach = springs.iter().enumerate().filter(|(j, spring)| {
            // A spring whose whole circle is out of reach need not be placed.
            free[*j] && away <= reach + spring.root.norm() + spring.rest_length
        });
        let distance = |tip: &Vec2| (tip - position).norm();
        in_reach
            .map(|(j, spring)| (j, pose.to_world(&spring.rest_tip())))
            .filter(|(_, tip)| distance(tip) <= reach)
            .min_by(|a, b| distance(&a.1).total_cmp(&distance(&b.1)))
    }

    /// Draws a new belief of where the load is when its time has come; the error is normal with the target variance in each axis.
    fn renew_belief(&mut self, i: usize, tick: u64) {
        let n_beliefs = |tick: u64| (tick as f64 * self.control_period / self.drive.target_redraw_period + 1e-9).floor() as u64;
        if tick == 0 || n_beliefs(tick) > n_beliefs(tick - 1) {
            let normal = self.chance.normal_pair(Stream::Target, i as u32, n_beliefs(tick));
            self.state.ants[i].belief_error = self.drive.target_variance.sqrt() * normal;
        }
    }

    fn command(&self, ant: &Ant, view: &View, duration: f64) -> Command {
        let (desired, velocity) = match ant.mode {
            Mode::Search => {
                let target = view.backend.motion().pose.position + ant.belief_error - ant.position;
                (target.y.atan2(target.x), self.drive.search_speed)
            }
            Mode::Transport { spring, .. } => (heading_for_pull(self.pull_direction(ant, spring, view)), -self.drive.pull_speed),
        };
        let turn_rate = steering_turn_rate(heading_error(desired, ant.heading), self.drive.steering_gain, duration);
        Command { velocity, turn_rate }
    }

    /// Eq. (22).
    fn pull_direction(&self, ant: &Ant, spring: usize, view: &View) -> f64 {
        let spring = &view.scenario.system.springs[spring];
        let along = ant.position - view.backend.motion().pose.to_world(&spring.root);
        let to_nest = self.drive.nest_position - ant.position;
        pull_direction(along.y.atan2(along.x), to_nest.y.atan2(to_nest.x), self.drive.steering_half_angle)
    }
}

/// Uniform in a square about the load, facing anywhere.
fn start_of(ant: u32, chance: &Chance, drive: &AntDrive, load: &Motion) -> Ant {
    let [u, v] = chance.uniform_pair(Stream::Start, ant, 0);
    let offset = drive.start_half_width * Vec2::new(2.0 * u - 1.0, 2.0 * v - 1.0);
    let heading = PI * (2.0 * chance.uniform(Stream::Start, ant, 1) - 1.0);
    Ant { position: load.pose.position + offset, heading, mode: Mode::Search, belief_error: Vec2::zeros() }
}

impl Driver for Ants {
    fn decide(&mut self, view: &View) -> Orders {
        let tick = view.tick.expect("ants decide at ticks");
        let events = self.release_and_grasp(view, tick);
        for i in 0..self.state.ants.len() {
            if self.state.ants[i].mode == Mode::Search {
                self.renew_belief(i, tick);
            }
        }
        Orders { events }
    }

    /// Walks all ants to `until` on the way.
    fn targets(&mut self, view: &View, until: f64) -> &[Vec2] {
        let duration = until - view.time;
        for i in 0..self.state.ants.len() {
            let ant = self.state.ants[i];
            let command = self.command(&ant, view, duration);
            self.state.ants[i] = match ant.mode {
                Mode::Search => ant.walked(&command, duration),
                Mode::Transport { spring, .. } => {
                    let tip = ant.position + duration * ant.tip_velocity(&command, self.drive.control_offset);
                    self.targets[spring] = tip;
                    Ant { position: tip, heading: ant.heading + command.turn_rate * duration, ..ant }
                }
            };
        }
        &self.targets
    }

    fn next_instant(&self, _: f64) -> Option<f64> {
        None
    }

    fn arrived(&self, motion: &Motion) -> Option<bool> {
        Some((motion.pose.position - self.drive.nest_position).norm() <= self.drive.arrival_radius)
    }

    fn pulls(&self) -> Summary {
        self.state.pulls
    }

    fn save(&self) -> serde_json::Value {
        serde_json::to_value(&self.state).expect("ants are plain data")
    }

    fn restore(&mut self, state: &serde_json::Value) -> Result<(), RestoreError> {
        let state = State::deserialize(state).map_err(|error| RestoreError(error.to_string()))?;
        if state.ants.len() != self.drive.n_ants {
            return Err(RestoreError(format!("{} ants, not {}", state.ants.len(), self.drive.n_ants)));
        }
        self.state = state;
        Ok(())
    }
}
