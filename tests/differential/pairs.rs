//! Random scenes against themselves posed differently: their motion is the same.
//!
//! At fixed steps both runs do the same work up to rounding. Where pieces of a wall may divide a
//! step at other instants, both have other errors of their steps. These are estimated by a run at
//! half the step.

use std::fmt;
use std::ops::Range;

use cohaul::backend::BackendKind::{self, Inertial, QuasiStatic};
use rayon::prelude::*;

use crate::draws::{Draws, asked};
use crate::posed::Pose;
use crate::random_scene::Random;
use crate::run::{EXACT, Run, Steps, expect_none, keep, run, step_error};
use crate::variant::{Variant, with_polygons};

/// Largest distance at the same steps over the size (1): a thousand steps round to 1e-13, which
/// unstable motions multiply by up to ten thousand.
const SAME: f64 = 1e-9;
/// Number of scenes of the long survey.
const MANY: u64 = 2000;
/// Error of the steps over the size beyond which a scene is not posed so that its steps may be
/// divided at other instants (1).
const DEPENDS_ON_STEPS: f64 = 3e-2;

/// A scene and itself posed differently that moved differently.
struct Unequal {
    kind: BackendKind,
    seed: u64,
    variant: Variant,
    random: Random,
    apart: f64,
    allowed: f64,
    ends: [[f64; 3]; 2],
}

impl fmt::Display for Unequal {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Random { load, obstacle, drive, is_long, scene } = &self.random;
        let [end, other] = self.ends;
        write!(
            f,
            "{} {} {:?}: {load:?} of {:.3} m, {obstacle:?}, long {is_long}, {drive:?}: {:.1e} of the size, allowed {:.1e}, \
             ends {end:?} and {other:?}",
            self.kind.name(),
            self.seed,
            self.variant,
            scene.size(),
            self.apart,
            self.allowed
        )
    }
}

/// The run of a scene in the pose of another one.
fn posed(run: &Run, pose: &Pose) -> Run {
    let mut posed = run.clone();
    for one in &mut posed.poses {
        let [x, y, heading] = pose.pose([one.position.x, one.position.y, one.heading]);
        *one = cohaul::math::Pose::new(x, y, heading);
    }
    posed
}

/// What came of variants of scenes.
#[derive(Default)]
struct Findings {
    n_compared: usize,
    /// Variants without a converged answer, also where the scene itself has none.
    n_refused: usize,
    /// Variants that may divide a jump of a load without inertia otherwise.
    n_jumped: usize,
    unequal: Vec<Unequal>,
}

impl Findings {
    fn add(mut self, other: Self) -> Self {
        self.n_compared += other.n_compared;
        self.n_refused += other.n_refused;
        self.n_jumped += other.n_jumped;
        self.unequal.extend(other.unequal);
        self
    }

    /// Compares a variant of a scene with the scene.
    fn compare(&mut self, seed: u64, kind: BackendKind, variant: Variant, plain: &Run, random: &Random, of_steps: f64) {
        let (scene, pose) = variant.of(random, &mut Draws::new(seed ^ 0xd1ff));
        let other = run(&scene, kind, Steps::Default);
        if !other.has_converged() || !plain.has_converged() {
            self.n_refused += 1;
            return;
        }
        // Where a jump ends among obstacles depends on its path, and that on where steps end.
        if variant.may_cut_steps() && (other.energy.jumps > 0.0 || plain.energy.jumps > 0.0) {
            self.n_jumped += 1;
            return;
        }
        self.n_compared += 1;
        let plain = posed(plain, &pose);
        let apart = plain.apart(&other, scene.size());
        let allowed = SAME + variant.allowed() + if variant.may_cut_steps() { of_steps } else { 0.0 };
        if apart > allowed {
            keep(&format!("pair-{}-{seed}-{variant:?}", kind.name()), &scene, plain.end());
            let unequal = Unequal { kind, seed, variant, random: random.clone(), apart, allowed, ends: [plain.end(), other.end()] };
            println!("{unequal}");
            self.unequal.push(unequal);
        }
    }
}

/// Compares `n` variants of a scene.
fn of_seed(seed: u64, kind: BackendKind, n: usize) -> Findings {
    let random = Random::new(seed, kind == Inertial);
    let plain = run(&random.scene, kind, Steps::Default);
    if !plain.has_converged() {
        return Findings { n_refused: n, ..Findings::default() };
    }
    let of_steps = step_error(&random.scene, kind, &plain);
    let mut variants: Vec<Variant> = Variant::ALL.into_iter().filter(|variant| variant.applies(&random)).collect();
    variants.retain(|variant| of_steps < DEPENDS_ON_STEPS || !variant.may_cut_steps());
    Draws::new(seed ^ 0xa11).shuffle(&mut variants);
    let mut findings = Findings::default();
    for variant in variants.into_iter().take(n) {
        findings.compare(seed, kind, variant, &plain, &random, of_steps);
    }
    findings
}

/// Compares two variants of each scene of these seeds.
fn compare(seeds: Range<u64>, kind: BackendKind) -> Findings {
    seeds.into_par_iter().map(|seed| of_seed(seed, kind, 2)).reduce(Findings::default, Findings::add)
}

fn expect_equal(found: &Findings) {
    expect_none(found.unequal.iter().map(Unequal::to_string).collect());
    let Findings { n_compared, n_refused, n_jumped, .. } = found;
    assert!(*n_compared > 25 && 10 * n_refused < *n_compared, "{n_compared} compared, {n_refused} refused, {n_jumped} jumped");
}

#[test]
fn without_inertia_no_pose_of_a_scene_changes_its_motion() {
    expect_equal(&compare(0..24, QuasiStatic));
}

#[test]
fn with_inertia_no_pose_of_a_scene_changes_its_motion() {
    expect_equal(&compare(0..24, Inertial));
}

/// Distance from the disc that a polygon of `n` corners may have over the size (1): it deviates by
/// 5 / n^2 of the radius, and at each corner an impact without rebound takes a part of its energy,
/// of the order 1 / n in all.
fn of_polygon(n: usize) -> f64 {
    10.0 / n as f64
}

/// Runs with polygons in place of discs that do not come closer to that with discs.
fn not_round(seed: u64, kind: BackendKind, numbers: &[usize]) -> Option<String> {
    let random = Random::new(seed, kind == Inertial);
    let scenes: Vec<_> = numbers.iter().filter_map(|n| with_polygons(&random, *n)).collect();
    let disc = (!scenes.is_empty()).then(|| run(&random.scene, kind, Steps::Default))?;
    let runs: Vec<Run> = scenes.iter().map(|scene| run(scene, kind, Steps::Default)).collect();
    if !disc.has_converged() || runs.iter().any(|run| !run.has_converged()) {
        return None;
    }
    let apart: Vec<f64> = runs.iter().map(|run| run.apart(&disc, random.scene.size())).collect();
    let errors = scenes.iter().zip(&runs).map(|(scene, run)| step_error(scene, kind, run));
    let of_steps = errors.fold(step_error(&random.scene, kind, &disc), f64::max);
    let is_far = of_steps < DEPENDS_ON_STEPS && numbers.iter().zip(&apart).any(|(n, apart)| *apart > of_polygon(*n) + of_steps);
    is_far.then(|| {
        let scene = scenes.last().expect("there are scenes");
        keep(&format!("polygon-{}-{seed}", kind.name()), scene, disc.end());
        let Random { load, obstacle, .. } = random;
        format!("{} {seed}: {load:?}, {obstacle:?}, {numbers:?} corners are {apart:?} of the size from the disc", kind.name())
    })
}

#[test]
fn polygons_of_many_corners_move_as_discs() {
    let pairs: Vec<(u64, BackendKind)> = EXACT.into_iter().flat_map(|kind| (0..12).map(move |seed| (seed, kind))).collect();
    expect_none(pairs.into_par_iter().filter_map(|(seed, kind)| not_round(seed, kind, &[60, 240])).collect());
}

/// `COHAUL_SEED` is the first seed in place of 1000, `COHAUL_COUNT` the number of scenes.
#[test]
#[ignore = "takes half an hour"]
fn many_scenes_move_as_in_other_poses() {
    let (first, count) = (asked("COHAUL_SEED", 1000), asked("COHAUL_COUNT", MANY));
    let mut all = Vec::new();
    for kind in EXACT {
        let found = compare(first..first + count, kind);
        let (n_unequal, n) = (found.unequal.len(), found.n_compared);
        println!("{}: {n_unequal} of {n} pairs are unequal, {} refused, {} jumped", kind.name(), found.n_refused, found.n_jumped);
        let not_round: Vec<String> =
            (first..first + count / 20).into_par_iter().filter_map(|seed| not_round(seed, kind, &[12, 60, 240, 1000])).collect();
        not_round.iter().for_each(|one| println!("{one}"));
        all.extend(found.unequal.iter().map(Unequal::to_string).chain(not_round));
    }
    expect_none(all);
}
