//! Cost of a step over the number of attached springs, of supports, of contacts and of obstacles
//! far away, and of a control tick over the number of ants.
//!
//! Stiffness and weight are shared out among springs and supports, so that loads of all sizes move
//! alike and only the work differs. Every round runs the same steps from the same start.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::clock::{Clock, Timing};
use super::fit::{Line, PowerLaw, line, power_law};
use crate::variants;
use crate::verify::scenes::{GRAVITY, LOAD_RADIUS, MASS, SUPPORT_RADIUS, paper_springs, paper_system};
use cohaul::backend::{BackendKind, BackendOptions, Motion, build, default_step};
use cohaul::math::{Pose, Twist, Vec2, direction};
use cohaul::model::{Obstacle, ObstaclePath, Outline, OutlinePart, PolarSpring, SupportPoint, System, World};
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Keep, Simulation};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Time of a step.
    Springs,
    /// Time of a step.
    Supports,
    /// Time of a step along a rough wall.
    Contacts,
    /// Time of a step along a rough wall, with the others out of reach.
    Obstacles,
    /// Time of a control tick.
    Ants,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GrowthPoint {
    pub quantity: Quantity,
    pub backend: BackendKind,
    pub n: usize,
    /// CPU time a step, or a tick, of each round (s).
    pub seconds: Vec<f64>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    pub quantity: Quantity,
    pub backend: BackendKind,
    /// Over sizes from a thirtieth of the largest on, where what does not grow is small; `null`
    /// with fewer than two of them.
    pub power_law: Option<PowerLaw>,
    /// Over all sizes (s, s per one more).
    pub line: Option<Line>,
}

/// Sizes up to the largest at which each quantity is tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    /// A scene of ants; their number is replaced.
    pub ants: Scenario,
    pub is_quick: bool,
}

impl Quantity {
    pub fn name(self) -> &'static str {
        variants::names::<Self>()[self as usize]
    }

    fn sizes(self, is_quick: bool) -> Vec<usize> {
        match self {
            Quantity::Contacts => vec![1, 2],
            Quantity::Ants => sizes(10_000, is_quick),
            _ => sizes(1_000, is_quick),
        }
    }
}

impl GrowthPoint {
    pub fn timing(&self) -> Option<Timing> {
        Timing::of(&self.seconds)
    }
}

/// Steps that bring a load from rest to a steady slip, and ticks that bring ants to it.
const LEAD_IN: u64 = 40;
/// Timed steps or ticks: fewer of large systems.
const MOST_STEPS: u64 = 400;
const FEWEST_STEPS: u64 = 20;
/// Steps times size that are about enough.
const WORK: u64 = 20_000;

impl Growth {
    /// All points without times.
    pub fn points(&self) -> Vec<GrowthPoint> {
        let mut points = Vec::new();
        for quantity in variants::all::<Quantity>() {
            let backends = if quantity == Quantity::Ants { &[BackendKind::QuasiStatic][..] } else { &BackendKind::ALL };
            for backend in backends {
                points.extend(quantity.sizes(self.is_quick).into_iter().map(|n| GrowthPoint {
                    quantity,
                    backend: *backend,
                    n,
                    seconds: Vec::new(),
                }));
            }
        }
        points
    }

    /// CPU time a step, or a tick, of one round (s).
    pub fn time(&self, point: &GrowthPoint) -> f64 {
        let n_steps = (WORK / point.n as u64).clamp(FEWEST_STEPS, MOST_STEPS);
        match point.quantity {
            Quantity::Springs => drag(&dragged(point.n, 3), point.backend, n_steps),
            Quantity::Supports => drag(&dragged(4, point.n), point.backend, n_steps),
            Quantity::Contacts => drag(&along_a_wall(point.n, 0), point.backend, MOST_STEPS),
            Quantity::Obstacles => drag(&along_a_wall(1, point.n - 1), point.backend, MOST_STEPS),
            Quantity::Ants => ticks(&self.ants, point.n, n_steps),
        }
    }
}

/// 1, 3, 10, 30 ... up to `largest`; only powers of ten if it is to be quick.
fn sizes(largest: usize, is_quick: bool) -> Vec<usize> {
    let decades = (0..).map(|power| 10usize.pow(power)).take_while(|size| *size <= largest);
    decades.flat_map(|size| [size, 3 * size]).filter(|size| *size <= largest && !(is_quick && size.to_string().starts_with('3'))).collect()
}

/// A load of 1.6 g on `n_supports` supports and `n_springs` springs, with weight and stiffness
/// shared out evenly.
fn dragged(n_springs: usize, n_supports: usize) -> System {
    // All springs together are as stiff as four of the paper's.
    let share = 4.0 / n_springs as f64;
    let springs = paper_springs(n_springs).into_iter().map(|spring| PolarSpring {
        radial_stiffness: share * spring.radial_stiffness,
        torsional_stiffness: share * spring.torsional_stiffness,
        ..spring
    });
    let support = |i: usize| SupportPoint {
        offset: SUPPORT_RADIUS * direction(TAU * (0.25 + i as f64 / n_supports as f64)),
        normal_load: MASS * GRAVITY / n_supports as f64,
        friction_coefficient: None,
    };
    let mut system = paper_system(springs.collect());
    system.ground.supports = (0..n_supports).map(support).collect();
    system
}

/// The load on four springs beside a wall with friction, as a disc with one contact or as a box
/// with two, and posts in rows half a metre away and farther.
fn along_a_wall(n_contacts: usize, n_far: usize) -> System {
    const FRICTION: f64 = 0.3;
    const N_IN_ROW: usize = 32;
    let obstacle = |outline: Outline, position: Vec2| Obstacle {
        name: String::new(),
        outline,
        friction_coefficient: FRICTION,
        restitution: 0.0,
        path: ObstaclePath::fixed(Pose { position, heading: 0.0 }),
    };
    let wall = Outline { parts: vec![OutlinePart::Polyline { points: vec![Vec2::new(-1.0, 0.0), Vec2::new(1.0, 0.0)] }] };
    let post = |i: usize| {
        let place = Vec2::new(0.05 * ((i % N_IN_ROW) as f64 - 0.5 * N_IN_ROW as f64), -0.5 - 0.05 * (i / N_IN_ROW) as f64);
        obstacle(Outline::disc(LOAD_RADIUS), place)
    };
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| LOAD_RADIUS * Vec2::new(x, y));
    let outline = if n_contacts == 1 {
        Outline::disc(LOAD_RADIUS)
    } else {
        Outline { parts: vec![OutlinePart::Polygon { corners: corners.to_vec() }] }
    };
    let obstacles = [obstacle(wall, Vec2::new(0.0, LOAD_RADIUS))].into_iter().chain((0..n_far).map(post)).collect();
    System { world: World { outline, obstacles }, ..dragged(4, 3) }
}

/// CPU time a step (s) while all tips go on at 30 mm/s along a bow, after the load has begun to
/// slip.
fn drag(system: &System, kind: BackendKind, n_steps: u64) -> f64 {
    const SPEED: f64 = 0.03;
    const PERIOD: f64 = 2.5e-3;
    // The fastest oscillation is that of four springs, whatever their number.
    let step = default_step(kind, &dragged(4, 3), PERIOD);
    let start = Motion { pose: Pose::new(0.0, 0.0, 0.0), twist: Twist::ZERO };
    let mut backend = build(system, start, &BackendOptions::new(kind, step));
    let tips = |time: f64| -> Vec<Vec2> {
        let bow = Vec2::new(SPEED * time, 0.5 * SPEED * time * time);
        system.springs.iter().map(|spring| spring.rest_tip() + bow).collect()
    };
    tips(0.0).into_iter().enumerate().for_each(|(spring, tip)| backend.attach(spring, tip));
    // A stretch of 8 mm makes four springs of the paper slip: 0.27 s.
    let slips_at = 0.3;
    for i in 1..=LEAD_IN {
        backend.advance(&tips(slips_at * i as f64 / LEAD_IN as f64), slips_at / LEAD_IN as f64);
    }
    let all: Vec<Vec<Vec2>> = (1..=n_steps).map(|i| tips(slips_at + i as f64 * step)).collect();
    let clock = Clock::start();
    for tips in &all {
        backend.advance(tips, step);
    }
    clock.seconds() / n_steps as f64
}

/// CPU time a control tick (s) with this number of ants.
fn ticks(scenario: &Scenario, n_ants: usize, n_ticks: u64) -> f64 {
    let mut scenario = scenario.clone();
    if let Drive::Ants(drive) = &mut scenario.drive {
        drive.n_ants = n_ants;
    }
    let options = BackendOptions::new(BackendKind::QuasiStatic, scenario.control_period);
    let mut run = Simulation::new(&scenario, &options, Keep::Outcome);
    (0..LEAD_IN).for_each(|_| run.step());
    let clock = Clock::start();
    (0..n_ticks).for_each(|_| run.step());
    clock.seconds() / n_ticks as f64
}

pub fn fits(points: &[GrowthPoint]) -> Vec<Fit> {
    let of_curve = |curve: &[GrowthPoint]| {
        let timed: Vec<[f64; 2]> = curve.iter().filter_map(|point| Some([point.n as f64, point.timing()?.min_s])).collect();
        let largest = timed.iter().map(|point| point[0]).fold(0.0, f64::max);
        let large: Vec<[f64; 2]> = timed.iter().filter(|point| 30.0 * point[0] >= largest).copied().collect();
        Fit { quantity: curve[0].quantity, backend: curve[0].backend, power_law: power_law(&large), line: line(&timed) }
    };
    points.chunk_by(|one, next| one.quantity == next.quantity && one.backend == next.backend).map(of_curve).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::backend::Status;

    #[test]
    fn sizes_are_even_in_the_logarithm() {
        assert_eq!(sizes(1000, false), [1, 3, 10, 30, 100, 300, 1000]);
        assert_eq!(sizes(1000, true), [1, 10, 100, 1000]);
    }

    #[test]
    fn each_curve_has_its_own_fit() {
        let mut points = Growth {
            ants: cohaul::scenario::Scenario::read("../../scenarios/paper/four-ants-four-springs.json".as_ref()).unwrap(),
            is_quick: false,
        }
        .points();
        for point in &mut points {
            let n = point.n as f64;
            // Two rounds: the least counts.
            let cost = if point.quantity == Quantity::Springs { 1e-6 + 1e-8 * n } else { 1e-9 * n * n };
            point.seconds = vec![2.0 * cost, cost];
        }
        let fits = fits(&points);
        assert_eq!(fits.len(), 13);
        for fit in &fits {
            let (line, law) = (fit.line.unwrap(), fit.power_law.unwrap());
            if fit.quantity == Quantity::Springs {
                assert!((line.slope / 1e-8 - 1.0).abs() < 1e-9 && law.exponent > 0.6 && law.exponent < 1.0, "{fit:?}");
            } else {
                assert!((law.exponent - 2.0).abs() < 1e-9, "{fit:?}");
            }
        }
    }

    /// The number of contacts is what it is called, and posts out of reach change nothing.
    #[test]
    fn loads_along_a_wall_have_their_contacts() {
        for (n_contacts, n_far) in [(1, 0), (2, 0), (1, 999)] {
            let system = along_a_wall(n_contacts, n_far);
            let mut load = build(
                &system,
                Motion { pose: Pose::new(0.0, 0.0, 0.0), twist: Twist::ZERO },
                &BackendOptions::new(BackendKind::QuasiStatic, 1e-3),
            );
            let tips = |by: Vec2| -> Vec<Vec2> { system.springs.iter().map(|spring| spring.rest_tip() + by).collect() };
            tips(Vec2::zeros()).into_iter().enumerate().for_each(|(spring, tip)| load.attach(spring, tip));
            let report = load.advance(&tips(Vec2::new(0.02, 0.004)), 0.1);
            assert_eq!((report.status, load.side_contacts().len()), (Status::Converged, n_contacts));
            assert!(load.motion().pose.position.x > 1e-3 && load.motion().pose.position.y.abs() < 1e-9);
        }
    }

    /// Loads of all sizes are dragged alike, so that costs compare.
    #[test]
    fn dragged_loads_slip_in_the_timed_steps() {
        for (n_springs, n_supports) in [(1, 3), (3, 3), (100, 3), (4, 1), (4, 30)] {
            let system = dragged(n_springs, n_supports);
            assert!((system.total_slip_limit() - 1.4 * 9.81 * 1.6e-3).abs() < 1e-15);
            assert!((system.springs.iter().map(|spring| spring.radial_stiffness).sum::<f64>() - 2.656).abs() < 1e-12);
            assert!(drag(&system, BackendKind::QuasiStatic, 3) > 0.0);
        }
    }
}
