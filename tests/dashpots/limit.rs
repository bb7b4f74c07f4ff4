//! The quasi-static run of random damped scenes is the limit of the inertial run as the mass goes
//! to zero at the same dashpots and the same friction.
//!
//! | what | distribution (log: uniform in the logarithm) |
//! |---|---|
//! | supports | 3-5 about the centre of mass, with unequal loads |
//! | springs | 1-4, roots on the edge, any bearing; lengths 1-3 radii; every sixth scene isotropic |
//! | stiffness | one spring reaches the friction limit at a stretch of log 0.05-0.5 lengths |
//! | torsion over radial stiffness times squared length | log 0.03-1 |
//! | damping ratio | log 0.1-3, each spring its own |
//! | tips | two to four straight parts, some with a stop; some begin later; one may be released |

use std::f64::consts::TAU;

use cohaul::backend::BackendKind::{Inertial, QuasiStatic};
use cohaul::backend::Status;
use cohaul::math::{RandomStreams, Stream, Vec2, direction};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Outcome, Row};
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::scene::*;

/// Error of each run over the load's radius (1).
const TOLERANCE: f64 = 3e-8;
/// Masses over that of the scene (1), of which the limit is extrapolated: the path differs from
/// that without mass by a series in the mass.
const MASSES: [f64; 2] = [4e-4, 1e-4];
/// What the quasi-static run may differ from the limit by, over the size (1).
const SAME: f64 = 1e-6;

struct Draws(RandomStreams, u64);

impl Draws {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.1 += 1;
        low + (high - low) * self.0.uniform(Stream::Scene, 0, self.1)
    }

    fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    fn count(&mut self, low: usize, high: usize) -> usize {
        low + self.between(0.0, (high - low + 1) as f64) as usize
    }
}

/// The random scene of this seed, from the distribution in the table above.
fn random(seed: u64) -> Value {
    let draws = &mut Draws(RandomStreams::new(seed), 0);
    let n_springs = draws.count(1, 4);
    let (ahead, first) = (draws.between(0.0, TAU), draws.between(0.0, TAU));
    let released_spring = (draws.between(0.0, 1.0) < 0.6).then(|| draws.count(1, 4));
    let (mut springs, mut paths) = (Vec::new(), Vec::new());
    for index in 0..n_springs {
        let bearing = first + (index as f64 + draws.between(-0.3, 0.3)) * TAU / n_springs as f64;
        let length = if seed.is_multiple_of(6) { 0.0 } else { draws.between(1.0, 3.0) * RADIUS };
        let root: Vec2 = RADIUS * direction(bearing + draws.between(-0.4, 0.4));
        let stretch = draws.log_between(0.05, 0.5) * length.max(RADIUS);
        let radial = LIMIT / stretch;
        let torsional = radial * length * length * draws.log_between(0.03, 1.0);
        springs.push(json!({
            "root_m": [root.x, root.y], "bearing_rad": bearing, "rest_length_m": length, "radial_stiffness_n_per_m": radial,
            "torsional_stiffness_nm_per_rad": torsional, "damping_ratio": draws.log_between(0.1, 3.0),
        }));
        let mut tip = root + length * direction(bearing);
        let n_parts = draws.count(2, 4);
        let start = if index > 0 && draws.between(0.0, 1.0) < 0.3 { draws.between(0.05, 0.15) } else { 0.0 };
        let mut corners = vec![[start, tip.x, tip.y]];
        for part in 1..=n_parts {
            if draws.between(0.0, 1.0) < 0.75 {
                tip += stretch * draws.between(0.5, 3.0) * direction(ahead + draws.between(-0.9, 0.9));
            }
            corners.push([start + (1.0 - start) * part as f64 / n_parts as f64, tip.x, tip.y]);
        }
        let release = draws.between(0.2, 0.8);
        paths.push(if released_spring == Some(index) { released(index, &corners, release) } else { path(index, &corners) });
    }
    let mut scene = scene(1.0, &springs, &paths);
    let n = draws.count(3, 5);
    let (first, reach) = (draws.between(0.0, TAU), draws.between(0.4, 0.9) * RADIUS);
    let offsets: Vec<Vec2> = (0..n).map(|k| reach * direction(first + (k as f64 + draws.between(-0.3, 0.3)) * TAU / n as f64)).collect();
    let shares: Vec<f64> = offsets.iter().map(|_| draws.between(0.5, 1.5)).collect();
    let sum: f64 = shares.iter().sum();
    let middle = offsets.iter().zip(&shares).map(|(offset, share)| offset * (share / sum)).sum::<Vec2>();
    let support = |(offset, share): (&Vec2, &f64)| json!({ "offset_m": [offset.x - middle.x, offset.y - middle.y], "normal_load_n": MASS * GRAVITY * share / sum });
    scene["ground"]["supports"] = offsets.iter().zip(&shares).map(support).collect();
    scene
}

/// The scene with this share of the mass, the same dashpots and the same friction.
fn lighter(scenario: &Scenario, share: f64) -> Scenario {
    let mut lighter = scenario.clone();
    lighter.system.load.mass *= share;
    lighter.system.load.inertia *= share;
    lighter.system.springs.iter_mut().for_each(|spring| spring.damping_ratio /= share.sqrt());
    lighter
}

/// What a scene shows.
#[derive(Clone, Copy, Debug)]
struct Gaps {
    seed: u64,
    /// Largest edge displacement between the runs over the length of the path, or the radius if
    /// that is longer (1): for both masses, and from their limit.
    pose: [f64; 3],
    /// Largest difference of friction, damping, tip work and elastic energy from the limit at the
    /// end, over the largest of them (1), of either sign.
    energy: [f64; 2],
    /// Path length over the radius (1).
    moved: f64,
    /// Defect of the quasi-static ledger over its largest entry (1).
    defect: f64,
    n_solves: [u64; 3],
    converged: bool,
}

fn gaps(seed: u64) -> Gaps {
    let scenario = parsed(&random(seed));
    let find = |kind, share: f64| {
        let scenario = lighter(&scenario, share);
        run(&scenario, &within(&scenario, kind, TOLERANCE * RADIUS))
    };
    let (still, outcome) = find(QuasiStatic, 1.0);
    let light = MASSES.map(|share| find(Inertial, share));
    let edge = |a: &Row, b: &Row| a.motion.pose.edge_displacement(&b.motion.pose, RADIUS);
    let moved = still.windows(2).map(|pair| edge(&pair[0], &pair[1])).sum::<f64>();
    let size = moved.max(RADIUS);
    let entries = |row: &Row| {
        let pose = row.motion.pose;
        [pose.position.x, pose.position.y, RADIUS * pose.heading]
    };
    let weight = MASSES[1] / (MASSES[0] - MASSES[1]);
    let limit = |heavy: f64, light: f64| light + weight * (light - heavy);
    let from_limit = |at: usize| {
        let [a, b, c] = [&still[at], &light[0].0[at], &light[1].0[at]].map(entries);
        (0..3).map(|i| (a[i] - limit(b[i], c[i])).abs()).fold(0.0, f64::max)
    };
    let n = still.len();
    let largest = |which: usize| still.iter().zip(&light[which].0).map(|(a, b)| edge(a, b)).fold(0.0, f64::max) / size;
    let ledger = |outcome: &Outcome| {
        let energy = outcome.energy;
        [energy.friction, energy.damping, energy.tip_work, energy.elastic]
    };
    let [a, b, c] = [&outcome, &light[0].1, &light[1].1].map(ledger);
    // A load that is held has energies of rounding.
    let most = outcome.energy.largest_entry().max(1e-12 * LIMIT * RADIUS);
    let differences = [0, 1, 2, 3].map(|i| (a[i] - limit(b[i], c[i])) / most);
    Gaps {
        seed,
        pose: [largest(0), largest(1), (0..n).map(from_limit).fold(0.0, f64::max) / size],
        energy: [differences.into_iter().fold(0.0, f64::min), differences.into_iter().fold(0.0, f64::max)],
        moved: moved / RADIUS,
        defect: (outcome.energy.defect() + outcome.energy.jumps) / most,
        n_solves: [outcome.steps.n_solves, light[0].1.steps.n_solves, light[1].1.steps.n_solves],
        converged: [&outcome, &light[0].1, &light[1].1].iter().all(|outcome| outcome.steps.status == Status::Converged),
    }
}

fn assert_limit(seeds: std::ops::Range<u64>) {
    let found: Vec<Gaps> = seeds.into_par_iter().map(gaps).collect();
    let mut failed = Vec::new();
    for gaps in &found {
        let Gaps { seed, pose, energy, moved, defect, n_solves, .. } = gaps;
        let [heavy, light, limit] = pose;
        println!("{seed}: pose {heavy:.1e} {light:.1e} {limit:.1e}, energy {:.1e} {:.1e}, defect {defect:.1e}", energy[0], energy[1]);
        println!("    path {moved:.1} radii, cone problems {n_solves:?}");
        let is_same = gaps.pose[2] <= SAME && gaps.energy[1] <= SAME && gaps.energy[0] >= -SAME && gaps.defect.abs() <= SAME;
        if !(is_same && gaps.converged) {
            failed.push(gaps);
        }
    }
    assert!(failed.is_empty(), "{} of {}: {failed:#?}", failed.len(), found.len());
}

#[test]
fn it_is_the_limit_of_vanishing_mass() {
    assert_limit(0..6);
}

/// The survey of 200 scenes: `cargo test --test dashpots -- --ignored --nocapture`.
#[test]
#[ignore = "minutes"]
fn it_is_the_limit_of_vanishing_mass_on_200_scenes() {
    assert_limit(0..200);
}
