//! A saved run goes on bit for bit, and two runs are one.

use cohaul::backend::rapier::{EngineSettings, FrictionModel, Precision, RapierOptions, SpringModel};
use cohaul::backend::{Backend, SavedState};
use cohaul::math::Vec2;

use crate::scenes::{backend, busy_system, busy_tips, moving, with_friction};

fn all_options() -> Vec<RapierOptions> {
    let mut all = Vec::new();
    for friction in [FrictionModel::Aligned, FrictionModel::Polygon, FrictionModel::Box] {
        for springs in [SpringModel::Joint, SpringModel::Aggregate, SpringModel::Force] {
            for precision in [Precision::F64, Precision::F32] {
                for settings in [EngineSettings::Recommended, EngineSettings::EngineDefaults] {
                    all.push(RapierOptions { friction, springs, precision, settings });
                }
            }
        }
    }
    all
}

fn fresh(options: RapierOptions) -> Box<dyn Backend> {
    backend(&busy_system(0.1), moving(Vec2::new(0.05, 0.02), 1.0), 1e-3, options)
}

/// Grasps and releases before, at and after the places where runs are saved.
fn tick(run: &mut dyn Backend, tick: i32) {
    let time = 5e-3 * f64::from(tick);
    match tick {
        2 | 61 => run.attach(2, busy_tips(time)[2]),
        5 | 45 => run.attach(0, busy_tips(time)[0]),
        20 | 71 => run.attach(1, busy_tips(time)[1]),
        30 => run.release(0),
        50 => run.release(2),
        65 => run.release(1),
        _ => (),
    }
    run.advance(&busy_tips(time + 5e-3), 5e-3);
}

/// All digits of the state: the text of a float in JSON is exact, and tells -0 from 0.
fn digits(run: &dyn Backend) -> String {
    serde_json::to_string(&run.save().unwrap()).unwrap()
}

#[test]
fn a_restored_run_goes_on_bit_for_bit() {
    for options in all_options() {
        let mut whole = fresh(options);
        let mut resumed: Vec<Box<dyn Backend>> = Vec::new();
        for at in 0..80 {
            if [0, 1, 10, 29, 30, 48, 60, 66].contains(&at) {
                let text = digits(&*whole);
                let mut run = fresh(options);
                run.restore(&serde_json::from_str::<SavedState>(&text).unwrap()).unwrap();
                assert_eq!(digits(&*run), text);
                resumed.push(run);
            }
            tick(&mut *whole, at);
            for run in &mut resumed {
                tick(&mut **run, at);
                assert_eq!(digits(&**run), digits(&*whole), "{options:?} tick {at}");
                assert_eq!(run.energy(), whole.energy());
                assert_eq!(run.friction_forces(), whole.friction_forces());
            }
        }
        assert_eq!(resumed.len(), 8);
        assert!(whole.motion().pose.position.norm() > 1e-3);
    }
}

#[test]
fn two_runs_are_one_bit_for_bit() {
    for options in all_options() {
        let [mut one, mut two] = [fresh(options), fresh(options)];
        for at in 0..80 {
            tick(&mut *one, at);
            tick(&mut *two, at);
        }
        assert_eq!(digits(&*one), digits(&*two));
    }
}

/// Other options or other springs are another run.
#[test]
fn a_state_of_another_run_is_refused() {
    let mut run = fresh(RapierOptions::default());
    let other = fresh(with_friction(FrictionModel::Box)).save().unwrap();
    assert!(run.restore(&other).unwrap_err().to_string().contains("options"));
    assert!(run.restore(&SavedState(serde_json::json!({"kind": "inertial"}))).is_err());
    let mut missing = run.save().unwrap();
    missing.0["state"]["attachments"] = serde_json::json!([{"spring": 7, "tip": [0.0, 0.0], "swing": 0.0}]);
    assert!(run.restore(&missing).unwrap_err().to_string().contains("spring"));
}
