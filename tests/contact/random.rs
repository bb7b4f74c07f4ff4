//! Random loads, springs and obstacles on both exact backends: whatever the scene, nothing
//! penetrates or passes through, all stays finite, losses only grow, each contact is recorded when
//! it closes and when it opens, and a restored run goes on as the one that it was saved from.

use std::ops::{AddAssign, Range};
use std::time::{Duration, Instant};

use cohaul::backend::BackendKind::{Inertial, QuasiStatic};
use cohaul::backend::{Backend, BackendKind, BackendOptions, EnergyLedger, Status, StepReport, TransitionKind, build};
use cohaul::math::{Pose, direction};
use cohaul::model::Obstacle;
use cohaul::model::geometry::overlap_depth;
use rayon::prelude::*;

use crate::random_scene::Scene;

/// Depth over the sizes of load and obstacle that is rounding (1): the error of the distances by
/// which overlaps are checked is about 5e-9 of the larger size.
const ROUNDING_OF_LOAD: f64 = 1e-7;
const ROUNDING_OF_OBSTACLE: f64 = 4e-8;
/// Fall of a loss over slip limit times size (1) that is the error of a step: the extrapolated loss
/// of a step in which contacts change may be that of a shorter path.
const FALL: f64 = 1e-3;
/// Residual up to which a step converges (1).
const RESIDUAL: f64 = 1e-9;

/// Time of a scene from which on the long survey names it.
const LONG: Duration = Duration::from_secs(5);

/// What happened in runs.
#[derive(Debug, Default)]
struct Findings {
    faults: Vec<String>,
    n_advances: u64,
    n_steps: u64,
    n_not_converged: u64,
    /// Advances without an answer.
    n_failed: u64,
    /// Largest number of cone problems in an advance.
    most_solves: u64,
}

impl AddAssign for Findings {
    fn add_assign(&mut self, other: Self) {
        self.faults.extend(other.faults);
        self.n_advances += other.n_advances;
        self.n_steps += other.n_steps;
        self.n_not_converged += other.n_not_converged;
        self.n_failed += other.n_failed;
        self.most_solves = self.most_solves.max(other.most_solves);
    }
}

impl Findings {
    fn note(&mut self, report: &StepReport) {
        self.n_advances += 1;
        self.n_steps += report.n_steps;
        self.n_not_converged += report.n_not_converged;
        self.n_failed += u64::from(report.status == Status::Failed);
        self.most_solves = self.most_solves.max(report.n_solves);
    }
}

/// A run of a random scene.
struct Run {
    scene: Scene,
    options: BackendOptions,
    load: Box<dyn Backend>,
    /// The same run, restored.
    restored: Option<Box<dyn Backend>>,
    attached: Vec<bool>,
    /// Sides of the long walls on which the load was last.
    sides: Vec<Option<bool>>,
    /// Obstacles that the load touches by the transitions.
    touched: Vec<usize>,
    energy: EnergyLedger,
}

impl Run {
    fn new(seed: u64, kind: BackendKind, way: usize) -> Self {
        let scene = Scene::new(seed);
        let options = scene.options(kind, way);
        let mut load = build(&scene.system, scene.start, &options);
        for (spring, _) in scene.attached.iter().enumerate().filter(|(_, is_attached)| **is_attached) {
            load.attach(spring, scene.tip(spring, 0.0));
        }
        let sides = scene.system.world.obstacles[..scene.n_long].iter().map(|wall| is_left_of(wall, &scene.start.pose)).collect();
        Self { options, attached: scene.attached.clone(), sides, touched: Vec::new(), energy: load.energy(), restored: None, load, scene }
    }

    /// Advances to the end, or to the first step without an answer: from there on the load may be
    /// anywhere.
    fn go(mut self, findings: &mut Findings) -> Vec<String> {
        let mut faults = Vec::new();
        for tick in 0..self.scene.n_advances {
            if tick == self.scene.n_advances / 3 {
                self.change_attachment(tick);
            }
            let targets = self.scene.targets(self.share(tick + 1));
            let report = self.load.advance(&targets, self.scene.duration);
            findings.note(&report);
            let solved = report.status == Status::Converged;
            faults
                .extend(self.faults(tick, &report, solved).into_iter().map(|fault| format!("tick {tick}: {fault} ({:?})", report.status)));
            if let Some(restored) = &mut self.restored {
                restored.advance(&targets, self.scene.duration);
                if bits(restored.as_ref()) != bits(self.load.as_ref()) {
                    faults.push(format!("tick {tick}: the restored run differs"));
                }
            }
            if !faults.is_empty() || !solved {
                break;
            }
            if tick == 8 {
                self.restore();
            }
        }
        faults
    }

    fn share(&self, tick: usize) -> f64 {
        tick as f64 / self.scene.n_advances as f64
    }

    fn change_attachment(&mut self, tick: usize) {
        let tip = self.scene.tip(0, self.share(tick));
        for load in [Some(&mut self.load), self.restored.as_mut()].into_iter().flatten() {
            if self.attached[0] { load.release(0) } else { load.attach(0, tip) }
        }
        self.attached[0] = !self.attached[0];
    }

    fn restore(&mut self) {
        let text = serde_json::to_string(&self.load.save().expect("an exact backend saves its state")).unwrap();
        let mut again = build(&self.scene.system, self.scene.start, &self.options);
        again.restore(&serde_json::from_str(&text).unwrap()).unwrap();
        self.restored = Some(again);
    }

    /// What is wrong after an advance; only what always holds where it was not `solved`.
    fn faults(&mut self, tick: usize, report: &StepReport, solved: bool) -> Vec<String> {
        let (motion, energy) = (self.load.motion(), self.load.energy());
        if !motion.pose.is_finite() || !motion.twist.is_finite() || !energy.defect().is_finite() {
            return vec![format!("not finite: {motion:?} {energy:?}")];
        }
        let mut faults = Vec::new();
        if report.is_refused() {
            faults.push("refused".into());
        }
        faults.extend(self.unrecorded());
        if solved {
            if report.residual > RESIDUAL {
                faults.push(format!("residual {:e}", report.residual));
            }
            faults.extend(self.overlaps(&motion.pose, (tick + 1) as f64 * self.scene.duration));
            faults.extend(self.falls(&energy));
        }
        self.energy = energy;
        faults
    }

    fn overlaps(&mut self, pose: &Pose, time: f64) -> Vec<String> {
        let (system, mut faults) = (&self.scene.system, Vec::new());
        for (index, obstacle) in system.world.obstacles.iter().enumerate() {
            let allowed = ROUNDING_OF_LOAD * system.load.radius + ROUNDING_OF_OBSTACLE * obstacle.outline.extent();
            let depth = overlap_depth(&system.world.outline, pose, &obstacle.outline, &obstacle.path.pose_at(time)).unwrap_or(0.0);
            if depth > allowed {
                faults.push(format!("overlap of {:e} R with obstacle {index}", depth / system.load.radius));
            }
        }
        let now: Vec<Option<bool>> = system.world.obstacles[..self.sides.len()].iter().map(|wall| is_left_of(wall, pose)).collect();
        let passed = now.iter().zip(&self.sides).enumerate().filter(|(_, (now, side))| now.zip(**side).is_some_and(|(a, b)| a != b));
        faults.extend(passed.map(|(index, _)| format!("passed through wall {index}")));
        self.sides = now;
        faults
    }

    /// What the transitions say of contacts that is not so.
    fn unrecorded(&mut self) -> Vec<String> {
        let mut faults = Vec::new();
        for transition in self.load.transitions() {
            let place = transition.kind.obstacle().map(|obstacle| self.touched.binary_search(&obstacle));
            match (&transition.kind, place) {
                (TransitionKind::Touch { obstacle }, Some(Err(at))) => self.touched.insert(at, *obstacle),
                (TransitionKind::Separation { .. }, Some(Ok(at))) => drop(self.touched.remove(at)),
                (TransitionKind::Touch { .. } | TransitionKind::Separation { .. }, _) => {
                    faults.push(format!("recorded twice: {transition:?}"))
                }
                _ => (),
            }
        }
        let mut touched: Vec<usize> = self.load.side_contacts().iter().map(|contact| contact.obstacle).collect();
        touched.sort_unstable();
        touched.dedup();
        if touched != self.touched {
            faults.push(format!("touches {touched:?}, recorded are {:?}", self.touched));
        }
        faults
    }

    fn falls(&self, energy: &EnergyLedger) -> Option<String> {
        let losses = |energy: &EnergyLedger| [energy.friction, energy.side_friction, energy.impacts];
        let unit = self.scene.scale * self.scene.force;
        let fallen = losses(energy).iter().zip(losses(&self.energy)).any(|(now, before)| *now < before - FALL * unit);
        fallen.then(|| format!("losses fell from {:?} to {:?}", losses(&self.energy), losses(energy)))
    }
}

/// Whether a load is left of a wall; `None` beyond its ends, where the load may go round.
fn is_left_of(wall: &Obstacle, pose: &Pose) -> Option<bool> {
    let at = wall.path.pose_at(0.0);
    let (along, offset) = (direction(at.heading), pose.position - at.position);
    (along.dot(&offset).abs() <= wall.outline.extent()).then(|| along.perp(&offset) > 0.0)
}

fn bits(load: &dyn Backend) -> [u64; 8] {
    let (motion, energy) = (load.motion(), load.energy());
    let [x, y, heading, vx, vy, rate] = motion.entries();
    [x, y, heading, vx, vy, rate, energy.friction, energy.side_friction].map(f64::to_bits)
}

/// Runs of these seeds, backends and ways to step; see [`Scene::options`].
fn hunt(seeds: Range<u64>, kinds: &[BackendKind], ways: &[usize]) -> Findings {
    let mut all = Findings::default();
    for seed in seeds {
        for kind in kinds {
            for way in ways {
                let mut findings = Findings::default();
                let faults = Run::new(seed, *kind, *way).go(&mut findings);
                findings.faults = faults.into_iter().map(|fault| format!("{seed} {} {way}: {fault}", kind.name())).collect();
                all += findings;
            }
        }
    }
    all
}

/// Random scenes show no fault as long as all steps converge, and nearly all of them do. Without an
/// answer are squeezes between obstacles that move at each other, and loads that several of them
/// press.
#[test]
fn random_scenes_show_no_faults() {
    let findings = hunt(0..8, &[QuasiStatic, Inertial], &[0, 1]);
    assert!(findings.faults.is_empty(), "{:#?}", findings.faults);
    assert!(findings.n_advances > 700 && 50 * findings.n_not_converged < findings.n_steps, "{findings:?}");
}

/// Scenes in which a load once overlapped an obstacle in steps that were said to converge: at a
/// line on which it could lie on either side, in an enclosed corner, on a path that was too long to
/// be looked at as a whole, where it met one feature on the way to another one, where it slid along
/// a line into its bend, where it moved so far that an end of a line passed a corner, where such an
/// end entered and left it within a step, where two features that it would touch hid each other,
/// and where an increment overflowed. One scene was restored with another list of near obstacles,
/// in one a cut path ended across an obstacle that it did not know, in one a rest with a residual
/// of 1e-6 was said to converge, in one the force of a contact held a load at rest although the
/// obstacle had moved past its corner, and in two a line was wrongly said to enter the load through
/// its corner, or not to.
#[test]
fn scenes_that_once_showed_faults_show_none() {
    // The first one takes nearly as long as all others together.
    let seeds = [81158, 24, 33, 57, 119, 144, 149, 177, 40008, 40087, 40095, 40120, 40146, 40326, 40354, 40406, 40455, 61364, 62218, 81095];
    seeds.into_par_iter().with_max_len(1).for_each(|seed| {
        let findings = hunt(seed..seed + 1, &[QuasiStatic, Inertial], &[0, 1]);
        assert!(findings.faults.is_empty(), "{:#?}", findings.faults);
    });
}

/// A path of which each short piece has an answer, and no longer one, ends after bounded work, and
/// is reported. The 25th advance of this scene would take 2.9 million iterations.
#[test]
fn a_path_that_obstacles_divide_takes_bounded_work() {
    let mut run = Run::new(301598, QuasiStatic, 0);
    let mut report = StepReport::default();
    for tick in 0..25 {
        if tick == run.scene.n_advances / 3 {
            run.change_attachment(tick);
        }
        let targets = run.scene.targets(run.share(tick + 1));
        report = run.load.advance(&targets, run.scene.duration);
    }
    let StepReport { status, n_iterations, .. } = report;
    assert!(status == Status::NotConverged && (1_000_000..2_000_000).contains(&n_iterations), "{status:?} {n_iterations}");
}

/// A load that slides along a bent line overlaps it on the straight way between two poses, where it
/// has contacts at both. That is no reason for shorter steps, which take ten times as many solves.
#[test]
fn a_contact_that_is_kept_cuts_no_path() {
    let findings = hunt(177..178, &[QuasiStatic], &[0]);
    assert!(findings.most_solves < 10_000, "{findings:?}");
}

#[test]
#[ignore = "takes minutes"]
fn many_random_scenes_show_no_faults() {
    for (kind, way) in [QuasiStatic, Inertial].into_iter().flat_map(|kind| (0..3).map(move |way| (kind, way))) {
        let findings = hunt(0..200, &[kind], &[way]);
        println!("{} {way}: {findings:?}", kind.name());
        assert!(findings.faults.is_empty(), "{:#?}", findings.faults);
    }
}

/// Over a million steps, nothing passes through a wall and nothing penetrates. `COHAUL_SEED` is the
/// first seed in place of 1000, `COHAUL_STEPS` the number of steps.
#[test]
#[ignore = "takes an hour on two cores"]
fn a_million_random_steps_pass_through_nothing() {
    const AT_ONCE: u64 = 64;
    let number = |name: &str| std::env::var(name).ok().and_then(|n| n.parse().ok());
    let (first, n_steps) = (number("COHAUL_SEED").unwrap_or(1000), number("COHAUL_STEPS").unwrap_or(1_000_000));
    let (mut all, mut seed) = (Findings::default(), first);
    let of_seed = |seed: u64| {
        let start = Instant::now();
        let findings = hunt(seed..seed + 1, &[QuasiStatic, Inertial], &[0, 1]);
        if start.elapsed() > LONG {
            println!("{seed} takes {:.1?} for {} steps", start.elapsed(), findings.n_steps);
        }
        findings
    };
    while all.n_steps < n_steps {
        (seed..seed + AT_ONCE).into_par_iter().map(of_seed).collect::<Vec<Findings>>().into_iter().for_each(|found| all += found);
        seed += AT_ONCE;
        println!("{} seeds, {} steps, {} faults", seed - first, all.n_steps, all.faults.len());
    }
    println!("{} seeds, {all:?}", seed - first);
    assert!(all.faults.is_empty(), "{:#?}", all.faults);
}
