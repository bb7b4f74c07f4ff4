//! The scenes at one point of the plane, on the paper's load, friction and stiffness.
//!
//! Epsilon is set by the speed of the tips and Phi by the time between events. That is no loss:
//! with other masses at the same friction the same numbers give the same shares (`mass_factor`).

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::script::{Act, Cue};
use crate::backend::{BackendKind, BackendOptions, Tolerance};
use crate::math::{Vec2, direction};
use crate::model::PolarSpring;
use crate::scenario::{Drive, Scenario};
use crate::studies::verify::scenes::{LOAD_RADIUS, SLIP_STRETCH, at_rest, isotropic, natural_rate, paper_springs, paper_system};

/// What happens to the load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scene {
    /// One ant on a spring through the centre pulls for T_e since the onset of slip and lets go.
    Excursion,
    /// Two ants pull apart, one ahead and one astern; the one astern lets go, and T_e later the
    /// other.
    TugOfWar,
    /// Four ants around the paper's load on its own springs; each T_e one grasps and one lets go,
    /// whose spring it has held for three.
    Haul,
}

/// A point of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    pub phi: f64,
    pub epsilon: f64,
    pub zeta: f64,
    /// Mass over the paper's, at the paper's friction (1).
    pub mass_factor: f64,
}

/// A scene ready to run.
#[derive(Clone, Debug)]
pub struct Staged {
    pub scenario: Scenario,
    pub cues: Vec<Cue>,
    /// Error that paths may have on the rim (m).
    pub tolerance_m: f64,
}

/// Longest tick (rad of the load on its spring): paths are compared at ticks, and a distance that
/// turns between two is seen to an eighth of its square.
const TICK: f64 = 0.1;
/// The same in the haul, which is a thousand times the work.
const HAUL_TICK: f64 = 0.25;
/// Fewest ticks between two events.
const FEWEST_TICKS: f64 = 16.0;
/// Error of paths over the way of a tip between events (1): a hundredth of what counts as
/// agreement.
const TOLERANCE: f64 = 1e-4;
/// The same in the haul: a tenth. Its load stops and starts with every ripple, and each of those is
/// located.
const HAUL_TOLERANCE: f64 = 1e-3;
/// Grasps in the haul: two rounds.
const N_GRASPS: u64 = 8;
/// Springs of the haul in the order in which they are grasped: ahead, astern, left, right.
const ROUND: [usize; 4] = [0, 2, 1, 3];
/// Directions in which their ants pull (rad): to the nest on the x axis, but no further than pi/3
/// from the spring.
const PULLS: [f64; 4] = [0.0, PI / 6.0, 2.0 * PI / 3.0, -PI / 6.0];

impl Scene {
    pub const ALL: [Scene; 3] = [Scene::Excursion, Scene::TugOfWar, Scene::Haul];

    pub fn name(self) -> &'static str {
        match self {
            Scene::Excursion => "excursion",
            Scene::TugOfWar => "tug-of-war",
            Scene::Haul => "haul",
        }
    }

    pub fn what(self) -> &'static str {
        match self {
            Scene::Excursion => "one ant pulls through the centre for T_e since the onset of slip and lets go",
            Scene::TugOfWar => "two ants pull apart; one lets go, and T_e later the other",
            Scene::Haul => "four ants around the paper's load; every T_e one grasps and one lets go",
        }
    }

    pub fn staged(self, at: &Setting) -> Staged {
        let rate = natural_rate() / at.mass_factor.sqrt();
        let speed = at.epsilon * SLIP_STRETCH * rate;
        match self {
            Scene::Excursion => excursion(at, rate, speed),
            Scene::TugOfWar => tug_of_war(at, rate, speed),
            Scene::Haul => haul(at, rate, speed),
        }
    }
}

impl Setting {
    /// Way of a tip between two events (m).
    pub fn stroke(&self) -> f64 {
        self.epsilon * self.phi * SLIP_STRETCH
    }
}

impl Staged {
    pub fn options(&self, kind: BackendKind) -> BackendOptions {
        BackendOptions::within(kind, Tolerance::at_edge(self.tolerance_m, &self.scenario.system.load))
    }
}

/// The pull begins a radian before anything moves, or at the rest shape if that comes later.
fn excursion(at: &Setting, rate: f64, speed: f64) -> Staged {
    let lead = (2.0 * at.zeta + 1.0).min(1.0 / at.epsilon);
    let pull = lead + at.phi;
    let n = n_ticks(pull, TICK);
    let ahead = Vec2::new(1.0, 0.0);
    let stretch = (SLIP_STRETCH - speed * lead / rate) * ahead;
    let cues = vec![grasp(0, 0, stretch, speed * ahead), release(n, 0)];
    staged(at, vec![isotropic(Vec2::zeros(), at.zeta)], cues, [pull / n as f64 / rate, rate], n, coast_time(at, 2.0 + 2.0 * at.zeta))
}

/// Both springs begin at f / k, balanced, so that the one left behind is at its slip limit and what
/// the tips have gone meanwhile is the jump.
fn tug_of_war(at: &Setting, rate: f64, speed: f64) -> Staged {
    let n = n_ticks(at.phi, TICK);
    let ahead = Vec2::new(1.0, 0.0);
    let pulled = |spring: usize, side: Vec2| grasp(0, spring, SLIP_STRETCH * side, speed * side);
    let cues = vec![pulled(0, ahead), pulled(1, -ahead), release(n, 1), release(2 * n, 0)];
    let springs = vec![isotropic(Vec2::zeros(), at.zeta); 2];
    staged(at, springs, cues, [at.phi / n as f64 / rate, rate], 2 * n, coast_time(at, 2.0 + at.phi))
}

fn haul(at: &Setting, rate: f64, speed: f64) -> Staged {
    let n = n_ticks(at.phi, HAUL_TICK);
    let springs = paper_springs(ROUND.len()).into_iter().map(|spring| PolarSpring { damping_ratio: at.zeta, ..spring }).collect();
    let spring = |event: u64| ROUND[event as usize % ROUND.len()];
    let mut cues = Vec::new();
    for event in 0..N_GRASPS {
        if event >= 3 {
            cues.push(release(event * n, spring(event - 3)));
        }
        cues.push(grasp(event * n, spring(event), Vec2::zeros(), speed * direction(PULLS[spring(event)])));
    }
    cues.extend((N_GRASPS - 3..N_GRASPS).map(|event| release(N_GRASPS * n, spring(event))));
    let haul = staged(at, springs, cues, [at.phi / n as f64 / rate, rate], N_GRASPS * n, coast_time(at, 3.0 + at.phi));
    Staged { tolerance_m: HAUL_TOLERANCE / TOLERANCE * haul.tolerance_m, ..haul }
}

/// Radians until a load that is let go at `speed` over that of the tips stands still.
fn coast_time(at: &Setting, speed: f64) -> f64 {
    at.epsilon * speed
}

fn n_ticks(radians: f64, longest: f64) -> u64 {
    (radians / longest).ceil().max(FEWEST_TICKS) as u64
}

fn grasp(tick: u64, spring: usize, stretch: Vec2, velocity: Vec2) -> Cue {
    Cue { tick, spring, act: Act::Grasp { stretch, velocity } }
}

fn release(tick: u64, spring: usize) -> Cue {
    Cue { tick, spring, act: Act::Release }
}

/// `n` ticks of this length (s), and as many more as the load coasts for `coast` (rad).
fn staged(at: &Setting, springs: Vec<PolarSpring>, cues: Vec<Cue>, [tick, rate]: [f64; 2], n: u64, coast: f64) -> Staged {
    let n_coasting = (coast / rate / tick).ceil() as u64 + 2;
    let mut system = paper_system(springs);
    system.load.mass *= at.mass_factor;
    system.load.inertia *= at.mass_factor;
    let scenario = Scenario {
        name: "regime".to_owned(),
        duration: (n + n_coasting) as f64 * tick,
        control_period: tick,
        seed: 0,
        system,
        start: at_rest(),
        // Nothing of its own: a script drives it.
        drive: Drive::Tips(Vec::new()),
    };
    Staged { scenario, cues, tolerance_m: (TOLERANCE * at.stroke()).min(1e-2 * LOAD_RADIUS) }
}
