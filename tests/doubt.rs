//! A comparison doubts itself: where an exact run cannot be trusted, it charges nobody.
//!
//! The exact backends are wrapped, and report what a gate would: a pose inside an obstacle, a step
//! that was cut, another admissible motion, steps that did not converge, and energy from nowhere.
//! The truth of each scene is known, and so is the verdict without a doubt.

use std::path::Path;

use cohaul::analysis::compare::{Cause, DoubtKind, Open, Pathwise, Settings, ThreeWay, Verdict};
use cohaul::backend::{
    Backend, BackendKind, BackendOptions, Doubts, EnergyLedger, Hook, Motion, RestoreError, SaveError, SavedState, SideContact, Status,
    StepReport, Transition, Wrapped, build,
};
use cohaul::math::Vec2;
use cohaul::model::{Outline, OutlinePart};
use cohaul::scenario::Scenario;
use cohaul::simulation::backend_of;
use cohaul_report::page::Answer;
use cohaul_studies::compare::answer::{of_ensemble, of_paths, sentence_of_ensemble, sentence_of_paths};

/// A backend that adds its own finding to the report of every advance from `since` (s) on.
struct Doubtful {
    time: f64,
    since: f64,
    finding: StepReport,
}

impl Hook for Doubtful {
    fn advance(&mut self, inside: &mut dyn Backend, tip_targets: &[Vec2], duration: f64) -> StepReport {
        let mut report = inside.advance(tip_targets, duration);
        // Times are sums of periods; half a period is far from rounding.
        if self.time + 0.5 * duration >= self.since {
            report.add(&self.finding);
        }
        self.time += duration;
        report
    }
}

/// The scene of a release jump: quasi-static is not valid, and rapier is right.
fn release() -> Scenario {
    Scenario::read(Path::new("scenarios/analytic/release-jump.json")).unwrap()
}

/// The scene of tests/verdict.rs with a tenth of the mass, in which an engine with a wrong mass is
/// wrong.
fn ramp() -> Scenario {
    let mut scenario = Scenario::read(Path::new("scenarios/analytic/ramp-and-hold.json")).unwrap();
    scenario.system.load.mass *= 0.1;
    scenario.system.load.inertia *= 0.1;
    scenario
}

/// An engine whose load has half more mass than that of the scene.
fn heavy(given: &Scenario, options: &BackendOptions) -> Box<dyn Backend> {
    let mut system = given.system.clone();
    system.load.mass *= 1.5;
    build(&system, given.start, &BackendOptions::new(BackendKind::Inertial, options.step_s))
}

/// The inertial backend at a fixed step: an engine without fault.
fn exact_engine(given: &Scenario, options: &BackendOptions) -> Box<dyn Backend> {
    backend_of(given, &BackendOptions::new(BackendKind::Inertial, options.step_s))
}

fn settings() -> Settings {
    Settings { step_s: Some(2e-4), check_suggestions: false, ..Settings::default() }
}

/// Comparison with a heavy engine, in which the backend `kind` reports a finding from a time on
/// (s).
fn doubted(scenario: &Scenario, kind: BackendKind, finding: StepReport, since: f64) -> Pathwise {
    let references = |given: &Scenario, options: &BackendOptions| -> Box<dyn Backend> {
        let inside = backend_of(given, options);
        let finding = if options.kind == kind { finding } else { StepReport::default() };
        Box::new(Wrapped { inside, hook: Doubtful { time: 0.0, since, finding } })
    };
    ThreeWay::new(scenario, &settings()).references(&references).engine(&heavy).prescribed(|_| true).unwrap()
}

fn findings() -> [(DoubtKind, StepReport); 4] {
    let of = |doubts| StepReport { doubts, ..StepReport::default() };
    [
        (DoubtKind::Overlap, of(Doubts { overlap_m: 1e-5, ..Doubts::default() })),
        (DoubtKind::GateCut, of(Doubts { n_gate_cuts: 1, ..Doubts::default() })),
        (DoubtKind::NotUnique, of(Doubts { n_not_unique: 1, ..Doubts::default() })),
        (DoubtKind::NotConverged, StepReport { status: Status::NotConverged, n_not_converged: 1, ..StepReport::default() }),
    ]
}

#[test]
fn an_engine_is_not_charged_with_a_difference_from_a_doubtful_run() {
    let scenario = ramp();
    let certain = doubted(&scenario, BackendKind::Inertial, StepReport::default(), 0.0);
    assert!(
        certain.causes.iter().any(|cause| cause.is_of_engine()) && certain.doubts.is_empty(),
        "{:?} {:?}",
        certain.causes,
        certain.doubts
    );
    for kind in [BackendKind::QuasiStatic, BackendKind::Inertial] {
        for (doubt, finding) in findings() {
            let found = doubted(&scenario, kind, finding, 0.0);
            let seen = found.doubts.iter().map(|it| (it.kind, it.backend, it.time_s)).collect::<Vec<_>>();
            assert_eq!(seen, [(doubt, Some(kind), 0.0)]);
            for (name, of) in found.verdicts.named() {
                let both = Open { inertia_effect: true, engine_error: true };
                assert_eq!((of.verdict, of.open), (Verdict::Inconclusive, both), "{name} {doubt:?}");
            }
            let causes = if doubt == DoubtKind::NotUnique { vec![Cause::NotUnique] } else { Vec::new() };
            assert_eq!((&found.causes, found.suggested_changes.as_slice()), (&causes, [].as_slice()));
            assert_eq!(of_paths(&found), Answer::Open);
            let sentence = sentence_of_paths(&found);
            assert!(sentence.contains("inconclusive, because") && sentence.contains(kind.name()), "{sentence}");
            assert!(!sentence.contains("exceeds") && !sentence.contains("valid for"), "{sentence}");
            // The numbers stay as they were computed. Without a doubt exact runs may be sharper.
            let [kept, known] = [&found, &certain].map(|found| found.edge_displacement);
            let error = kept.reference_error_m + known.reference_error_m;
            assert!((kept.engine_error_m - known.engine_error_m).abs() <= error, "{kept:?} {known:?}");
        }
    }
}

/// A doubt before and after the first divergence, which is the same in both.
#[test]
fn a_difference_of_paths_before_the_first_doubt_remains() {
    let scenario = ramp();
    let (_, finding) = findings()[0];
    let certain = doubted(&scenario, BackendKind::Inertial, StepReport::default(), 0.0);
    let first = certain.verdicts.path.first_divergence.engine_error.unwrap().time_s;
    let before = doubted(&scenario, BackendKind::Inertial, finding, first - 2.0 * scenario.control_period);
    assert!(!before.verdict.has_engine() && before.verdicts.path.open.engine_error, "{:?}", before.verdicts.path);
    assert!(!before.causes.iter().any(|cause| cause.is_of_engine()));
    let after = doubted(&scenario, BackendKind::Inertial, finding, first + 2.0 * scenario.control_period);
    assert!(after.verdict.has_engine() && !after.verdicts.path.open.engine_error, "{:?}", after.verdicts.path);
    assert!(after.causes.iter().any(|cause| cause.is_of_engine()));
    // Numbers of the whole run are not known.
    assert_eq!(after.verdicts.energy.verdict, Verdict::Inconclusive);
    let sentence = sentence_of_paths(&after);
    assert!(
        sentence.contains("exceeds the tolerance for the path (") && sentence.contains("All else is inconclusive, because"),
        "{sentence}"
    );
}

/// A backend whose ledger has a share of the work of the tips too much.
struct EnergyFromNowhere {
    inside: Box<dyn Backend>,
    share: f64,
}

impl Backend for EnergyFromNowhere {
    fn energy(&self) -> EnergyLedger {
        let energy = self.inside.energy();
        EnergyLedger { friction: energy.friction + self.share * energy.largest_entry(), ..energy }
    }

    fn attach(&mut self, spring: usize, tip: Vec2) {
        self.inside.attach(spring, tip);
    }

    fn release(&mut self, spring: usize) {
        self.inside.release(spring);
    }

    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport {
        self.inside.advance(tip_targets, duration)
    }

    fn motion(&self) -> Motion {
        self.inside.motion()
    }

    fn tip(&self, spring: usize) -> Option<Vec2> {
        self.inside.tip(spring)
    }

    fn pull(&self, spring: usize) -> Vec2 {
        self.inside.pull(spring)
    }

    fn friction_forces(&self) -> Vec<Vec2> {
        self.inside.friction_forces()
    }

    fn side_contacts(&self) -> Vec<SideContact> {
        self.inside.side_contacts()
    }

    fn transitions(&self) -> &[Transition] {
        self.inside.transitions()
    }

    fn pose_error(&self) -> Option<cohaul::backend::PoseError> {
        self.inside.pose_error()
    }

    fn companion(&self) -> Option<&dyn Backend> {
        self.inside.companion()
    }

    fn save(&self) -> Result<SavedState, SaveError> {
        self.inside.save()
    }

    fn restore(&mut self, state: &SavedState) -> Result<(), RestoreError> {
        self.inside.restore(state)
    }
}

/// A hair below and above the bound. The largest entry is at most that of the whole run, which the
/// bound is measured by, and equal to it at the end.
#[test]
fn a_ledger_that_does_not_close_leaves_the_verdict_open() {
    let scenario = release();
    for (share, is_open) in [(0.0, false), (0.9e-3, false), (1.1e-3, true), (-1.1e-3, true), (0.1, true)] {
        let references = |given: &Scenario, options: &BackendOptions| -> Box<dyn Backend> {
            Box::new(EnergyFromNowhere { inside: backend_of(given, options), share })
        };
        let found = ThreeWay::new(&scenario, &settings()).references(&references).engine(&exact_engine).prescribed(|_| true).unwrap();
        let kinds = found.doubts.iter().map(|doubt| doubt.kind).collect::<Vec<_>>();
        assert_eq!(!kinds.is_empty(), is_open, "{share}: {kinds:?}");
        assert!(kinds.iter().all(|kind| *kind == DoubtKind::OpenLedger));
        if is_open {
            assert_eq!(found.verdicts.energy.verdict, Verdict::Inconclusive);
            assert!(sentence_of_paths(&found).contains("the energy ledger of the"), "{}", sentence_of_paths(&found));
        } else {
            assert!(found.causes.contains(&Cause::Inertia));
        }
    }
}

#[test]
fn a_doubtful_seed_leaves_the_closed_loop_open() {
    let ants = Scenario { duration: 1.0, ..Scenario::read(Path::new("scenarios/paper/four-ants-four-springs.json")).unwrap() };
    let second = ants.seed + 1;
    let references = |given: &Scenario, options: &BackendOptions| -> Box<dyn Backend> {
        let is_doubtful = given.seed == second && options.kind == BackendKind::Inertial;
        let finding = if is_doubtful { findings()[2].1 } else { StepReport::default() };
        Box::new(Wrapped { inside: backend_of(given, options), hook: Doubtful { time: 0.0, since: 0.5, finding } })
    };
    let found = ThreeWay::new(&ants, &Settings::default()).references(&references).closed_loop(3, |_| true).unwrap();
    assert_eq!(found.doubts.iter().map(|it| (it.seed, it.doubt.kind)).collect::<Vec<_>>(), [(second, DoubtKind::NotUnique)]);
    assert_eq!((found.verdict, of_ensemble(&found), found.n_seeds_needed), (Verdict::Inconclusive, Answer::Open, None));
    assert!(found.verdicts.iter().all(|of| matches!(of.verdict, Verdict::Inconclusive | Verdict::NotComputed)));
    let sentence = sentence_of_ensemble(&found);
    assert!(sentence.contains("inconclusive, because with seed 2, from 500 ms on the inertial motion is not unique"), "{sentence}");
}

/// The scene with little inertia, and the same normal loads.
fn light(mut scenario: Scenario) -> Scenario {
    scenario.system.load.mass *= 1e-2;
    scenario.system.load.inertia *= 1e-2;
    scenario
}

/// A disc that is pulled along a wall without friction, at which it is pressed.
fn along_a_wall() -> Scenario {
    light(Scenario::read(Path::new("scenarios/contact/wall-slide.json")).unwrap())
}

/// The scene with more walls in its only obstacle.
fn with_walls(mut scenario: Scenario, points: &[[f64; 2]]) -> Scenario {
    let points = points.iter().map(|[x, y]| Vec2::new(*x, *y)).collect();
    scenario.system.world.obstacles[0].outline.parts.push(OutlinePart::Polyline { points });
    scenario
}

/// The wall ends the path of the exact loads, where `STOP` is (m).
const STOP: [[f64; 2]; 2] = [[0.02, -0.0122], [0.02, 0.001]];

fn compared_at_wall(scenario: &Scenario, seen_by_exact: &Scenario, engine: &cohaul::simulation::MakeBackend) -> Pathwise {
    let references = |_: &Scenario, options: &BackendOptions| backend_of(seen_by_exact, options);
    ThreeWay::new(scenario, &settings()).references(&references).engine(engine).prescribed(|_| true).unwrap()
}

/// Both exact backends see a stop in the wall that is not there.
#[test]
fn a_place_that_holds_both_exact_loads_and_not_the_engine_is_doubtful() {
    let scenario = along_a_wall();
    let found = compared_at_wall(&scenario, &with_walls(scenario.clone(), &STOP), &exact_engine);
    let doubt = found.doubts.first().unwrap_or_else(|| panic!("no doubt: {:?}", found.verdicts.path));
    assert_eq!((doubt.kind, doubt.backend, doubt.obstacle), (DoubtKind::SameStop, None, Some(0)));
    assert!(doubt.time_s < found.verdicts.path.first_divergence.engine_error.unwrap().time_s);
    assert!(!found.verdicts.named().iter().any(|(_, of)| of.verdict.has_engine()));
    let sentence = sentence_of_paths(&found);
    assert!(sentence.contains("obstacle 0 holds both exact loads where the load of the engine passes"), "{sentence}");
}

/// A box pressed on a wall, the front corner of which passes the end of the wall. The exact
/// backends see a spur of a ten-thousandth of the load's radius there; the engine's load goes on
/// and still touches the end.
#[test]
fn a_corner_that_catches_at_the_end_of_a_wall_is_doubtful() {
    let text = r#"{
      "name": "box past the end of a wall", "duration_s": 1.2, "control_period_s": 0.005,
      "load": { "mass_kg": 0.01, "outline": { "rectangle": { "size_m": [0.2, 0.1] } } },
      "ground": { "friction_coefficient": 0.3, "supports": { "uniform": { "n": 16 } } },
      "springs": [{ "root_m": [0, 0], "bearing_rad": 0, "rest_length_m": 0, "radial_stiffness_n_per_m": 2, "torsional_stiffness_nm_per_rad": 0 }],
      "obstacles": [{ "name": "wall", "outline": { "polyline": { "points_m": [[-1.763, -0.05], [0.12, -0.05]] } } }],
      "drive": { "kind": "tips", "paths": [{ "spring": 0, "waypoints": [[0, 0, 0], [0.2, 0, -0.02], [1.2, 0.08, -0.02]] }] }
    }"#;
    // So light that the impact on the spur hardly turns it.
    let scenario = light(light(Scenario::parse(text, "wall end").unwrap()));
    let caught = with_walls(scenario.clone(), &[[0.12, -0.05], [0.12, -0.04999]]);
    let found = compared_at_wall(&scenario, &caught, &exact_engine);
    assert!(found.doubts.iter().any(|doubt| doubt.kind == DoubtKind::SameStop), "{:?} {:?}", found.doubts, found.verdicts.path);
    assert!(!found.verdicts.path.verdict.has_engine());
}

/// The stop is there, and an engine that ignores it lies in it.
#[test]
fn an_engine_that_passes_through_an_obstacle_is_charged() {
    let scenario = with_walls(along_a_wall(), &STOP);
    let through = |given: &Scenario, options: &BackendOptions| {
        let mut seen = given.clone();
        let parts = seen.system.world.obstacles[0].outline.parts[..1].to_vec();
        seen.system.world.obstacles[0].outline = Outline { parts };
        exact_engine(&seen, options)
    };
    let found = compared_at_wall(&scenario, &scenario, &through);
    assert!(found.verdict.has_engine() && found.doubts.is_empty(), "{:?} {:?}", found.doubts, found.verdicts.path);
}

/// The stop is there. An engine whose load has too much friction lags before it, and one whose load
/// recoils from it leaves it again: both are charged.
#[test]
fn an_engine_that_lags_or_recoils_is_charged() {
    let scenario = with_walls(along_a_wall(), &STOP);
    let lags = |given: &Scenario, options: &BackendOptions| {
        let mut seen = given.clone();
        seen.system.ground.friction_coefficient *= 1.5;
        exact_engine(&seen, options)
    };
    let recoils = |given: &Scenario, options: &BackendOptions| {
        let mut seen = given.clone();
        seen.system.world.obstacles[0].restitution = 1.0;
        // Mass makes the recoil long.
        seen.system.load.mass *= 1e2;
        exact_engine(&seen, options)
    };
    let engines: [&cohaul::simulation::MakeBackend; 2] = [&lags, &recoils];
    for engine in engines {
        let found = compared_at_wall(&scenario, &scenario, engine);
        assert!(found.verdict.has_engine() && found.doubts.is_empty(), "{:?} {:?}", found.doubts, found.verdicts.path);
    }
}
