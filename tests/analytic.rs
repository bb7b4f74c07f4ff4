//! Known answers, backend by backend. Sources are sections of the model's derivation; each tolerance has its reason beside it.

mod common;

use cohaul::backend::{BackendKind, Status};
use common::*;

#[test]
fn probe() {
    for n in [200, 400, 800, 1600] {
        let mut b = backend(BackendKind::QuasiStatic, &paper_system(paper_springs(4)), at_rest(), 1.0);
        let mut mid = None;
        let r = drive(b.as_mut(), reference_tips, 1.0, n, |t, b| {
            if t == 0.5 {
                mid = Some(b.motion().pose)
            }
        });
        let e = b.energy();
        println!("{n} {:?} {:?} {:?}", mid.unwrap(), b.motion().pose, r);
        println!("  D {} defect {:e}", e.friction, e.defect());
        assert_eq!(r.status, Status::Converged);
        let mut b = backend(BackendKind::Inertial, &paper_system(paper_springs(4)), at_rest(), 1.0);
        let r = drive(b.as_mut(), reference_tips, 1.0, n, |t, b| {
            if t == 0.5 {
                mid = Some(b.motion().pose)
            }
        });
        println!("I {n} {:?} {:?} {:?}", mid.unwrap(), b.motion().pose, r);
        println!("  {:?} defect {:e}", b.energy(), b.energy().defect());
    }
}
