//! Steps that are left out are those whose outcome is known: the run with all steps is the same
//! one.

use cohaul::backend::rapier::{EngineSettings, FrictionModel, Precision, RapierOptions, SpringModel};
use cohaul::backend::{Backend, BackendKind, BackendOptions, Skips, StepReport, build};
use cohaul::math::{Pose, Vec2};
use cohaul::model::System;

use crate::scenes::{at_rest, busy_system};

fn variants() -> impl Iterator<Item = RapierOptions> {
    let frictions = [FrictionModel::Aligned, FrictionModel::Polygon, FrictionModel::Box];
    let springs = [SpringModel::Joint, SpringModel::Aggregate, SpringModel::Force];
    let settings = [EngineSettings::Recommended, EngineSettings::EngineDefaults];
    frictions.into_iter().flat_map(move |friction| {
        springs.into_iter().flat_map(move |springs| {
            [Precision::F64, Precision::F32].into_iter().flat_map(move |precision| {
                settings.into_iter().map(move |settings| RapierOptions { friction, springs, precision, settings })
            })
        })
    })
}

fn run(system: &System, rapier: RapierOptions, skips: Skips) -> Box<dyn Backend> {
    let options = BackendOptions { rapier, skips, ..BackendOptions::new(BackendKind::Rapier, 1e-3) };
    build(system, at_rest(Pose::new(0.01, -0.02, 0.3)), &options)
}

/// Where the tips are at a tick of 5 ms: at rest, drawn out so far that the load slips, at rest
/// again.
fn tips(system: &System, tick: i32) -> Vec<Vec2> {
    let drawn = f64::from((tick - 40).clamp(0, 60));
    let start = Pose::new(0.01, -0.02, 0.3);
    system.springs.iter().map(|spring| start.to_world(&spring.rest_tip()) + drawn * Vec2::new(6e-4, 1e-4)).collect()
}

/// Grasps, rests, pulls, rests, lets go, rests.
fn tick(run: &mut dyn Backend, system: &System, tick: i32) -> StepReport {
    match tick {
        10 => (0..3).for_each(|spring| run.attach(spring, tips(system, tick)[spring] + Vec2::new(0.0, 2e-3))),
        220 => (0..3).for_each(|spring| run.release(spring)),
        _ => (),
    }
    let nudged: Vec<Vec2> = tips(system, tick).iter().map(|tip| tip + Vec2::new(0.0, 2e-3)).collect();
    run.advance(&nudged, 5e-3)
}

#[test]
fn what_is_left_out_does_not_show() {
    let system = busy_system(0.1);
    for options in variants() {
        let [mut lean, mut full] = [Skips::ALL, Skips::NONE].map(|skips| run(&system, options, skips));
        let (mut left_out, mut made) = (StepReport::default(), StepReport::default());
        for at in 0..300 {
            left_out.add(&tick(&mut *lean, &system, at));
            made.add(&tick(&mut *full, &system, at));
            let [lean, full] = [&lean, &full].map(|run| run.motion().pose);
            let gap = (lean.position - full.position).norm().max(0.0122 * (lean.heading - full.heading).abs());
            // As promised: a step of less than 1e-21 m may be left out, and there are 1500; where
            // one fell into slip, that comes to some roundings.
            assert!(gap <= 1e-15, "{options:?} {at}: {gap}");
        }
        let gap = (lean.energy().defect() - full.energy().defect()).abs();
        // In f32 a load whose pose does not change has a speed of 1e-9 m/s all the same, and the
        // friction of 7 mN that it books with that is 1e-14 J a step.
        assert!(gap < if options.precision == Precision::F64 { 1e-18 } else { 1e-11 }, "{options:?} {gap}");
        assert!(lean.motion().pose.position.x > 0.02, "{}", lean.motion().pose.position);
        let skipped = left_out.skipped;
        assert_eq!((made.n_skipped, left_out.n_steps, left_out.n_skipped), (0, 1500, skipped.free_load + skipped.still_tips));
        // Fifty steps before the grasp, and what is left of four hundred after the release.
        assert!(skipped.free_load >= 50, "{options:?} {skipped:?}");
        match (options.settings, options.precision) {
            // Its creep is what it is run for.
            (EngineSettings::EngineDefaults, _) => assert_eq!(skipped.still_tips, 0, "{options:?}"),
            // 150 steps between the grasp and the pull, most of 600 after it.
            (EngineSettings::Recommended, Precision::F64) => assert!(skipped.still_tips > 400, "{options:?} {skipped:?}"),
            (EngineSettings::Recommended, Precision::F32) => (),
        }
    }
}

#[test]
fn each_kind_has_its_switch() {
    let system = busy_system(0.1);
    let count = |skips| {
        let mut run = run(&system, RapierOptions::default(), skips);
        let mut report = StepReport::default();
        (0..60).for_each(|at| report.add(&tick(&mut *run, &system, at)));
        report.skipped
    };
    let all = count(Skips::ALL);
    let no_free = count(Skips { free_load: false, ..Skips::ALL });
    let no_still = count(Skips { still_tips: false, ..Skips::ALL });
    assert!(all.free_load == 50 && all.still_tips > 100, "{all:?}");
    // A free load that rapier moves rounds its angle, with which rest can begin a step later or
    // sooner.
    assert!(no_free.free_load == 0 && no_free.still_tips > 100, "{no_free:?}");
    assert_eq!((no_still.free_load, no_still.still_tips), (all.free_load, 0));
}

/// A tip that moves by a hair ends the rest at once.
#[test]
fn a_tip_that_moves_is_never_left_out() {
    let system = busy_system(0.0);
    let mut run = run(&system, RapierOptions::default(), Skips::ALL);
    for at in 0..30 {
        tick(&mut *run, &system, at);
    }
    let mut still: Vec<Vec2> = (0..3).map(|spring| run.tip(spring).unwrap()).collect();
    let before = run.pull(1);
    assert_eq!(run.advance(&still, 5e-3).n_skipped, 5);
    still[1].x = still[1].x.next_up();
    assert_eq!(run.advance(&still, 5e-3).n_skipped, 0);
    assert_ne!(run.pull(1), before);
}

/// Rest belongs to the state: saved in its midst, a run goes on bit for bit and leaves out the same
/// steps.
#[test]
fn a_run_saved_at_rest_goes_on_at_rest() {
    let system = busy_system(0.1);
    for options in variants() {
        let mut whole = run(&system, options, Skips::ALL);
        for at in 0..35 {
            tick(&mut *whole, &system, at);
        }
        let mut resumed = run(&system, options, Skips::ALL);
        resumed.restore(&whole.save().unwrap()).unwrap();
        for at in 35..80 {
            let reports = [&mut whole, &mut resumed].map(|run| tick(&mut **run, &system, at));
            assert_eq!(reports[0].skipped, reports[1].skipped, "{options:?} {at}");
            assert_eq!(whole.save().unwrap(), resumed.save().unwrap(), "{options:?} {at}");
        }
    }
}
