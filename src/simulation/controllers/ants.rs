//! Ants: the behaviour model in a closed loop with the load, Eq. (17) to (23).
//!
//! A free spring relaxes to its rest shape, where the next ant finds its tip. `Deviation:` the
//! paper may be read as if a tip stays where it was let go, which would tie the load to the ground.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::avoiding::Avoiding;
use super::controller::{Commands, Controller, View};
use super::periods::Periods;
use super::releases::Releases;
use super::sensing::{Around, Placed, Sensing};
use crate::backend::{AttachedTip, Motion, RestoreError, SaveError};
use crate::math::{LANES, RandomStreams, Stream, Summary, Vec2};
use crate::model::PolarSpring;
use crate::model::ant::{Ant, Mode, Steering};
use crate::model::avoidance::Side;
use crate::model::behaviour::{GraspPace, HalfAngle, hazard_of, probability_within, turn_towards};
use crate::model::team::Haul;
use crate::scenario::{AntDrive, Drive, Scenario};
use crate::simulation::clock::SAME_INSTANT;
use crate::simulation::trace::{Event, EventKind, Trace};
use crate::stop;

/// The ants of one run.
pub struct Ants {
    drive: AntDrive,
    streams: RandomStreams,
    control_period: f64,
    /// Probability of a grasp per tick within range of a tip (1).
    grasp_probability: f64,
    /// Standard deviation of the believed position of the load along each axis (m).
    belief_spread: f64,
    half_angle: HalfAngle,
    /// Steering over one control period.
    steering: Steering,
    state: State,
    releases: Releases,
    sensing: Sensing,
    /// What the ants avoid; `None` where they pass through everything.
    avoiding: Option<Avoiding>,
    /// Last known pose of the load.
    load: Placed,
    /// Periods between new beliefs.
    beliefs: Periods,
    /// First tick at which a new belief may be due.
    next_belief: u64,
    targets: Vec<Vec2>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct State {
    ants: Vec<Ant>,
    pulls: Summary,
    /// Side on which each ant passes what blocks it; empty where ants avoid nothing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    sides: Vec<Option<Side>>,
}

impl Ants {
    pub fn new(scenario: &Scenario, drive: &AntDrive) -> Self {
        let streams = RandomStreams::new(scenario.seed);
        let period = scenario.control_period;
        let grasp_probability = match drive.grasp_pace {
            GraspPace::PerTick => drive.grasp_probability,
            GraspPace::Hazard => probability_within(hazard_of(drive.grasp_probability, drive.grasp_decision_period), period),
        };
        let avoiding = Avoiding::of(scenario, drive);
        let start = |ant: usize| start_of(ant as u32, &streams, drive, &scenario.start, avoiding.as_ref());
        let ants: Vec<Ant> = (0..drive.n_ants).map(start).collect();
        let sides = if avoiding.is_some() { vec![None; ants.len()] } else { Vec::new() };
        let springs = &scenario.system.springs;
        Self {
            drive: drive.clone(),
            streams,
            control_period: period,
            grasp_probability,
            belief_spread: drive.target_variance.sqrt(),
            half_angle: HalfAngle::new(drive.steering_half_angle),
            steering: Steering::new(drive.steering_gain, period),
            state: State { ants, pulls: Summary::default(), sides },
            releases: Releases::new(drive, streams, period),
            sensing: Sensing::new(springs, drive.sensing_range),
            avoiding,
            load: Placed::new(&scenario.start.pose),
            beliefs: Periods::new(period, drive.target_redraw_period),
            next_belief: 0,
            targets: vec![Vec2::zeros(); springs.len()],
        }
    }

    /// Releases by Eq. (18).
    fn release_where_decided(&mut self, view: &View, tick: u64, commands: &mut Commands) {
        for i in 0..self.state.ants.len() {
            let Mode::Transport { spring, grasp_tick } = self.state.ants[i].mode else { continue };
            let pull = || view.pull(spring);
            if self.releases.lets_go(i, tick, tick - grasp_tick, pull, &mut self.state.pulls) {
                self.sensing.free(spring);
                let ant = &mut self.state.ants[i];
                ant.mode = Mode::Search;
                commands.events.push(Event { time: view.time, spring, ant: Some(i), tip: ant.position, kind: EventKind::Release });
            }
        }
    }

    /// Lets searching ants grasp, or draw a new believed position of the load when it is due. The
    /// error of the belief is normal with the target variance along each axis.
    fn grasp_or_believe(&mut self, view: &View, tick: u64, commands: &mut Commands) {
        if self.state.ants.iter().all(|ant| ant.mode != Mode::Search) {
            return;
        }
        self.load = self.load.moved_to(&view.motion.pose);
        if let Some(avoiding) = &mut self.avoiding {
            avoiding.place(&view.motion.pose, view.time);
        }
        let belief = self.belief_due(tick);
        let n_released = commands.events.len();
        for i in 0..self.state.ants.len() {
            stop::point();
            if self.state.ants[i].mode != Mode::Search {
                continue;
            }
            // Releases are in the order of ants. An ant that has just let go does not grasp at
            // once.
            let has_let_go = commands.events[..n_released].binary_search_by_key(&Some(i), |event| event.ant).is_ok();
            if !has_let_go && self.sensing.has_free() {
                let around = self.sensing.around(self.load, view.skips.distant_ants);
                let position = &self.state.ants[i].position;
                if around.is_far(position) {
                    commands.skipped.distant_ants += 1;
                } else if let Some((spring, tip)) = self.grasped(i, tick, position, &around) {
                    self.grasp(i, tick, spring, tip);
                    commands.events.push(Event { time: view.time, spring, ant: Some(i), tip, kind: EventKind::Grasp });
                    continue;
                }
            }
            if let Some(belief) = belief {
                self.believe(i, belief);
            }
        }
    }

    /// Number of the belief that is drawn at a tick; `None` where none is due.
    fn belief_due(&mut self, tick: u64) -> Option<u64> {
        if tick < self.next_belief {
            return None;
        }
        self.next_belief = tick.saturating_add(self.beliefs.quiet_after(tick));
        (tick == 0 || self.beliefs.ends_with(tick)).then(|| self.beliefs.passed(tick) as u64)
    }

    fn believe(&mut self, i: usize, belief: u64) {
        self.state.ants[i].belief_error = self.belief_spread * self.streams.normal_pair(Stream::Target, i as u32, belief);
    }

    /// Takes grasps and releases from a recorded run instead of deciding them. Beliefs are drawn as
    /// in the run.
    fn follow(&mut self, events: &[Event], tick: u64) {
        let mut has_grasped = vec![false; self.state.ants.len()];
        for (event, i) in events.iter().filter_map(|event| Some((event, event.ant?))) {
            let ant = &mut self.state.ants[i];
            has_grasped[i] = event.kind == EventKind::Grasp;
            (ant.position, ant.mode) = match event.kind {
                EventKind::Grasp => (event.tip, Mode::Transport { spring: event.spring, grasp_tick: tick }),
                EventKind::Release => (ant.position, Mode::Search),
            };
        }
        let belief = self.belief_due(tick);
        for (i, has_grasped) in has_grasped.into_iter().enumerate() {
            if !has_grasped && self.state.ants[i].mode == Mode::Search {
                belief.into_iter().for_each(|belief| self.believe(i, belief));
            }
        }
    }

    /// Spring and tip (m, world) that an ant grasps: the nearest free one, with the probability of
    /// one tick. The draw comes first because it is cheaper than the search and mostly fails.
    fn grasped(&self, i: usize, tick: u64, position: &Vec2, around: &Around) -> Option<(usize, Vec2)> {
        let is_drawn = self.streams.uniform(Stream::Grasp, i as u32, tick) < self.grasp_probability;
        let is_sensed = |tip: &Vec2| self.avoiding.as_ref().is_none_or(|avoiding| avoiding.senses(position, tip));
        if is_drawn { around.nearest(position, is_sensed) } else { None }
    }

    fn grasp(&mut self, i: usize, tick: u64, spring: usize, tip: Vec2) {
        let ant = &mut self.state.ants[i];
        ant.mode = Mode::Transport { spring, grasp_tick: tick };
        ant.position = tip;
        self.state.pulls.add(0.0);
        self.sensing.take(spring);
        self.releases.begin(i, tick);
    }

    /// Moves attached ants to their tips.
    fn follow_tips(&mut self, tips: &[AttachedTip]) {
        for ant in &mut self.state.ants {
            let Mode::Transport { spring, .. } = ant.mode else { continue };
            if let Some(tip) = tips.iter().find(|tip| tip.spring == spring) {
                ant.position = tip.position;
            }
        }
    }

    /// Moves all ants from one time to another (s) while the load is at `motion`, and stores the
    /// new positions of their tips in `targets`.
    fn walk(&mut self, motion: &Motion, springs: &[PolarSpring], [from, until]: [f64; 2]) {
        let duration = until - from;
        // A tick lasts a control period, up to the rounding of the times at its ends.
        let is_tick = (duration - self.control_period).abs() <= SAME_INSTANT * self.control_period + f64::EPSILON * until;
        let steering = if is_tick { self.steering } else { Steering::new(self.drive.steering_gain, duration) };
        let searched = self.drive.search_speed * steering.duration();
        self.load = self.load.moved_to(&motion.pose);
        if let Some(avoiding) = &mut self.avoiding {
            avoiding.place(&motion.pose, until);
        }
        let haul = Haul {
            load: (self.load.position, self.load.turn),
            nest: self.drive.nest_position,
            half_angle: self.half_angle,
            steering,
            speed: self.drive.pull_speed,
        };
        // Ants that pull and their springs, in teams that fill the lanes.
        let (mut team, mut n_in_team) = ([(0, 0); LANES], 0);
        for i in 0..self.state.ants.len() {
            let ant = &mut self.state.ants[i];
            match ant.mode {
                Mode::Search => match &self.avoiding {
                    None => {
                        let target = self.load.position + ant.belief_error - ant.position;
                        ant.walk(searched, steering.turn(turn_towards(&target, &ant.ahead)), self.drive.control_offset);
                    }
                    Some(avoiding) => {
                        stop::point();
                        let target = self.load.position + ant.belief_error;
                        let draw = || drawn_side(&self.streams, i, from / self.control_period);
                        avoiding.walk(ant, &mut self.state.sides[i], &target, searched, &steering, draw);
                    }
                },
                Mode::Transport { spring, .. } => {
                    self.state.sides.get_mut(i).into_iter().for_each(|side| *side = None);
                    team[n_in_team] = (i, spring);
                    n_in_team += 1;
                    if n_in_team == LANES {
                        self.pull(&team, &haul, springs);
                        n_in_team = 0;
                    }
                }
            }
        }
        if n_in_team > 0 {
            self.pull(&team[..n_in_team], &haul, springs);
        }
    }

    /// Moves a team of ants, each with its spring, and their tips. A team fills the lanes at most.
    fn pull(&mut self, team: &[(usize, usize)], haul: &Haul, springs: &[PolarSpring]) {
        let ants = &mut self.state.ants;
        // Empty lanes repeat the first ant.
        let of = |k: usize| team[if k < team.len() { k } else { 0 }];
        let pulled = haul.pulled(std::array::from_fn(|k| &ants[of(k).0]), std::array::from_fn(|k| &springs[of(k).1].root));
        for (k, (i, spring)) in team.iter().enumerate() {
            let ant = &mut ants[*i];
            let tip = pulled.tip.lane(k);
            ant.position = self.avoiding.as_ref().map_or(tip, |avoiding| avoiding.dragged(&ant.position, &tip));
            ant.ahead = pulled.ahead.lane(k);
            ant.heading += pulled.turn.as_array()[k];
            self.targets[*spring] = ant.position;
        }
    }
}

/// Recomputes the ants of a recorded run of `scenario` from the same random draws. `visit` receives
/// the number of each row and the ants at that instant, in order. A trace without ants has none.
pub fn follow_ants(scenario: &Scenario, trace: &Trace, mut visit: impl FnMut(usize, &[Ant])) {
    let Drive::Ants(drive) = &scenario.drive else { return };
    let mut ants = Ants::new(scenario, drive);
    let mut events = &trace.events[..];
    for (at, row) in trace.rows.iter().enumerate() {
        let (now, later) = events.split_at(events.partition_point(|event| event.time <= row.time));
        ants.follow(now, at as u64);
        ants.follow_tips(&row.tips);
        events = later;
        visit(at, ants.ants());
        if let Some(next) = trace.rows.get(at + 1) {
            ants.walk(&row.motion, &scenario.system.springs, [row.time, next.time]);
        }
    }
}

/// Start of an ant: uniform in the free part of a square about the load, with any heading.
fn start_of(ant: u32, streams: &RandomStreams, drive: &AntDrive, load: &Motion, avoiding: Option<&Avoiding>) -> Ant {
    let position = |draw: u64| {
        let [u, v] = streams.uniform_pair(Stream::Start, ant, draw);
        load.pose.position + drive.start_half_width * Vec2::new(2.0 * u - 1.0, 2.0 * v - 1.0)
    };
    // The draw of number 1 is the heading.
    let other = |attempt: u64| position(if attempt == 0 { 0 } else { attempt + 1 });
    let heading = PI * (2.0 * streams.uniform(Stream::Start, ant, 1) - 1.0);
    Ant::new(avoiding.map_or_else(|| position(0), |avoiding| avoiding.start(other)), heading)
}

/// Side that an ant takes at a time in ticks, where both are equal.
fn drawn_side(streams: &RandomStreams, ant: usize, ticks: f64) -> Side {
    if streams.uniform(Stream::Side, ant as u32, ticks.round() as u64) < 0.5 { Side::Left } else { Side::Right }
}

impl Controller for Ants {
    /// Decides releases first: another ant can take a spring at the tick at which it was let go.
    fn decide(&mut self, view: &View, commands: &mut Commands) {
        // Obstacles may turn between two ticks, where ants walk on as they decided.
        let Some(tick) = view.tick else { return };
        self.release_where_decided(view, tick, commands);
        self.grasp_or_believe(view, tick, commands);
    }

    fn targets(&mut self, view: &View, until: f64) -> &[Vec2] {
        self.walk(&view.motion, &view.scenario.system.springs, [view.time, until]);
        &self.targets
    }

    fn arrived(&self, motion: &Motion) -> Option<bool> {
        Some((motion.pose.position - self.drive.nest_position).norm_squared() <= self.drive.arrival_radius * self.drive.arrival_radius)
    }

    fn ants(&self) -> &[Ant] {
        &self.state.ants
    }

    fn pulls(&self) -> Summary {
        self.state.pulls
    }

    fn save(&self) -> Result<serde_json::Value, SaveError> {
        Ok(serde_json::to_value(&self.state).expect("ants are plain data"))
    }

    fn restore(&mut self, state: &serde_json::Value) -> Result<(), RestoreError> {
        let state = State::deserialize(state).map_err(RestoreError::unreadable)?;
        if state.ants.len() != self.drive.n_ants {
            return Err(RestoreError(format!("{} ants, not {}", state.ants.len(), self.drive.n_ants)));
        }
        if state.sides.len() != self.state.sides.len() {
            return Err(RestoreError(format!("sides of {} ants, not {}", state.sides.len(), self.state.sides.len())));
        }
        self.sensing.free_all();
        let mut is_taken = vec![false; self.targets.len()];
        for ant in &state.ants {
            if let Mode::Transport { spring, .. } = ant.mode {
                match is_taken.get_mut(spring) {
                    None => return Err(RestoreError(format!("an ant at spring {spring} of {}", self.targets.len()))),
                    Some(true) => return Err(RestoreError(format!("two ants at spring {spring}"))),
                    Some(is_taken) => *is_taken = true,
                }
                self.sensing.take(spring);
            }
        }
        self.releases.forget();
        self.next_belief = 0;
        self.state = state;
        Ok(())
    }

    fn check(&self, tick: u64, _time: f64, tips: &[AttachedTip]) -> Result<(), RestoreError> {
        let mut n_attached = 0;
        for ant in &self.state.ants {
            let Mode::Transport { spring, grasp_tick } = ant.mode else { continue };
            n_attached += 1;
            if grasp_tick > tick {
                return Err(RestoreError(format!("at tick {tick}, an ant that grasped at tick {grasp_tick}")));
            }
            if tips.iter().all(|tip| tip.spring != spring) {
                return Err(RestoreError(format!("an ant at spring {spring}, which is free")));
            }
        }
        if n_attached == tips.len() {
            Ok(())
        } else {
            Err(RestoreError(format!("{} attached springs, but {n_attached} attached ants", tips.len())))
        }
    }
}
