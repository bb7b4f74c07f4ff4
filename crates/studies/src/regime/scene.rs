//! The scenes at one point of the plane, on the paper's load, friction and stiffness.
//!
//! The speed of the tips sets epsilon, and the time between events sets Phi. Other masses at the
//! same friction (`mass_factor`) give the same ratios at the same epsilon, Phi and zeta.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::script::{Act, Cue};
use crate::variants::names;
use crate::verify::scenes::{LOAD_RADIUS, SLIP_STRETCH, at_rest, isotropic, natural_rate, paper_springs, paper_system};
use cohaul::backend::{BackendKind, BackendOptions, Tolerance};
use cohaul::math::{Vec2, direction};
use cohaul::model::PolarSpring;
use cohaul::scenario::{Drive, Scenario};

/// Which grasps and releases the load is subject to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scene {
    /// One ant on a spring through the centre pulls for T_e since the slip onset, then releases.
    Excursion,
    /// Two ants pull apart, one to the front and one to the rear. The rear ant releases, and T_e
    /// later the front ant.
    TugOfWar,
    /// Four ants around the paper's load, on its own springs. Every T_e one ant grasps, and one
    /// releases after an attachment of three T_e.
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

#[derive(Clone, Debug)]
pub struct Staged {
    pub scenario: Scenario,
    pub cues: Vec<Cue>,
    /// Tolerance of the error control for the edge displacement (m).
    pub tolerance_m: f64,
}

/// Longest tick (rad of the load on its spring). Paths are compared at ticks, so that a largest
/// distance between two ticks is missed by an eighth of the square of the tick.
const TICK: f64 = 0.1;
/// Longest tick in the haul (rad), which takes a thousand times the work.
const HAUL_TICK: f64 = 0.25;
/// Fewest ticks between two events.
const FEWEST_TICKS: f64 = 16.0;
/// Tolerance of the error control over the path length of a tip between events (1): a hundredth of
/// the relative tolerance of the map.
const TOLERANCE: f64 = 1e-4;
/// Tolerance of the error control in the haul (1): a tenth of the relative tolerance of the map.
/// The load stops and starts with every ripple, and each of these events is located.
const HAUL_TOLERANCE: f64 = 1e-3;
/// Grasps in the haul: two rounds.
const N_GRASPS: u64 = 8;
/// Springs of the haul in the order in which they are grasped: front, rear, left, right.
const ROUND: [usize; 4] = [0, 2, 1, 3];
/// Directions in which their ants pull (rad): to the nest on the x axis, but no further than pi/3
/// from the spring.
const PULLS: [f64; 4] = [0.0, PI / 6.0, 2.0 * PI / 3.0, -PI / 6.0];

impl Scene {
    pub const ALL: [Scene; 3] = [Scene::Excursion, Scene::TugOfWar, Scene::Haul];

    pub fn name(self) -> &'static str {
        names::<Self>()[self as usize]
    }

    pub fn what(self) -> &'static str {
        match self {
            Scene::Excursion => "one ant pulls through the centre for T_e since the slip onset, then releases",
            Scene::TugOfWar => "two ants pull apart; one releases, and T_e later the other",
            Scene::Haul => "four ants around the paper's load; every T_e one grasps and one releases",
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

impl Staged {
    /// Options of a run. The laws compare with the rate-independent model.
    pub fn options(&self, kind: BackendKind) -> BackendOptions {
        let options = BackendOptions::within(kind, Tolerance::at_edge(self.tolerance_m, &self.scenario.system.load));
        BackendOptions { rate_independent: !kind.has_inertia(), ..options }
    }
}

/// The pull begins a radian before the load moves, or at the rest shape if that comes later.
fn excursion(at: &Setting, rate: f64, speed: f64) -> Staged {
    let lead = (2.0 * at.zeta + 1.0).min(1.0 / at.epsilon);
    let pull = lead + at.phi;
    let n = n_ticks(pull, TICK);
    let forward = Vec2::new(1.0, 0.0);
    let stretch = (SLIP_STRETCH - speed * lead / rate) * forward;
    let cues = vec![grasp(0, 0, stretch, speed * forward), release(n, 0)];
    staged(at, vec![isotropic(Vec2::zeros(), at.zeta)], cues, [pull / n as f64 / rate, rate], n, at.epsilon * (2.0 + 2.0 * at.zeta))
}

/// Both springs begin in balance at the stretch f / k. The remaining spring is therefore at the
/// slip limit plus the displacement of the tips, which is the jump.
fn tug_of_war(at: &Setting, rate: f64, speed: f64) -> Staged {
    let n = n_ticks(at.phi, TICK);
    let forward = Vec2::new(1.0, 0.0);
    let pulled = |spring: usize, side: Vec2| grasp(0, spring, SLIP_STRETCH * side, speed * side);
    let cues = vec![pulled(0, forward), pulled(1, -forward), release(n, 1), release(2 * n, 0)];
    let springs = vec![isotropic(Vec2::zeros(), at.zeta); 2];
    staged(at, springs, cues, [at.phi / n as f64 / rate, rate], 2 * n, at.epsilon * (2.0 + at.phi))
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
    let haul = staged(at, springs, cues, [at.phi / n as f64 / rate, rate], N_GRASPS * n, at.epsilon * (3.0 + at.phi));
    Staged { tolerance_m: HAUL_TOLERANCE / TOLERANCE * haul.tolerance_m, ..haul }
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

/// A scene of `n` ticks of this length (s), and as many more as the load coasts for (rad): epsilon
/// times its speed at the last release, in units of the speed of the tips.
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
        // A script drives the scene in place of its own tips.
        drive: Drive::Tips(Vec::new()),
    };
    // Of the path length of a tip between two events.
    let stroke = at.epsilon * at.phi * SLIP_STRETCH;
    Staged { scenario, cues, tolerance_m: (TOLERANCE * stroke).min(1e-2 * LOAD_RADIUS) }
}
