//! Steps without a finite answer end a run; nothing that is not a number leaves it.

use cohaul::backend::Status;
use cohaul::backend::rapier::{FrictionModel, Precision, RapierOptions, SpringModel};
use cohaul::math::{Pose, Vec2};

use crate::scenes::{at_rest, backend, busy_system};

#[test]
fn a_tip_out_of_the_world_freezes_the_load_where_it_was() {
    for precision in [Precision::F64, Precision::F32] {
        for springs in [SpringModel::Joint, SpringModel::Aggregate, SpringModel::Force] {
            for friction in [FrictionModel::Aligned, FrictionModel::Polygon] {
                for far in [f64::NAN, f64::INFINITY, 1e200, 1e300] {
                    frozen_by(far, RapierOptions { precision, springs, friction, ..RapierOptions::default() });
                }
            }
        }
    }
}

fn frozen_by(far: f64, options: RapierOptions) {
    let system = busy_system(0.1);
    let mut run = backend(&system, at_rest(Pose::new(0.0, 0.0, 0.0)), 1e-3, options);
    run.attach(0, Vec2::new(0.06, 0.03));
    let near = [Vec2::new(0.08, 0.03); 3];
    assert_eq!(run.advance(&near, 0.05).status, Status::Converged);
    let (before, books) = (run.motion(), run.energy());
    let report = run.advance(&[Vec2::new(far, 0.0); 3], 1e-3);
    assert_eq!((report.status, report.n_not_converged), (Status::Failed, 1), "{far} {options:?}");
    assert_eq!((run.motion(), run.energy()), (before, books));
    assert!(run.pull(0).norm().is_finite());
    // From then on nothing moves, not in a restored run either.
    let mut again = backend(&system, at_rest(Pose::new(0.0, 0.0, 0.0)), 1e-3, options);
    again.restore(&run.save().unwrap()).unwrap();
    for run in [&mut run, &mut again] {
        assert_eq!(run.advance(&near, 0.05).status, Status::Failed);
        run.release(0);
        assert_eq!(run.motion(), before);
        assert!(run.energy().defect().is_finite());
    }
    assert_eq!(run.save().unwrap(), again.save().unwrap());
}

#[test]
fn a_grasp_beyond_any_energy_ends_the_run_as_well() {
    let mut run = backend(&busy_system(0.0), at_rest(Pose::new(0.0, 0.0, 0.0)), 1e-3, RapierOptions::default());
    run.attach(1, Vec2::new(1e200, 0.0));
    assert_eq!(run.advance(&[Vec2::new(1e200, 0.0); 3], 1e-3).status, Status::Failed);
    assert_eq!(run.motion(), at_rest(Pose::new(0.0, 0.0, 0.0)));
    run.release(1);
    assert_eq!(run.energy().defect(), 0.0);
}
