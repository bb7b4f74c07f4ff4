//! A load towed at the end of an arm turns into line with the pull.
//!
//! Least power: heading' = -b heading / (b^2 + a^2 / 2) per path length, for an arm b and supports
//! at a.

use super::case::{Bound, Case, Family, Plan};
use super::measured::{Measured, Value};
use super::scenes::{RADIAL, SUPPORT_RADIUS, isotropic, paper_system};
use crate::methods::Method;
use crate::subject::Runs;
use cohaul::backend::{Backend, Motion};
use cohaul::math::{Pose, Twist, Vec2};
use cohaul::model::PolarSpring;

/// Arm from the load's centre to the point of towing (m) and the length over which the heading
/// decays (m), printed with five and nine digits.
pub const ARMS: [(f64, f64); 2] = [(0.071594, 0.072056), (0.0385, 0.0393591053)];

pub fn cases() -> Vec<Case> {
    ARMS.into_iter().map(|(arm, _)| case(arm)).collect()
}

fn case(arm: f64) -> Case {
    let known = (arm * arm + 0.5 * SUPPORT_RADIUS * SUPPORT_RADIUS) / arm;
    let step_s = 2e-4;
    // Tips go at 1 m/s.
    let first = Bound::metres(1.5 * step_s, "one and a half steps of the tip");
    let limit = Bound::metres(1e-5 * known, "second order in the heading, 1e-6, and the spring's stretch, 5e-7");
    Case {
        name: format!("towing-{:.1}-mm", 1e3 * arm),
        family: Family::Towing,
        what: "length over which the heading of a towed load decays".to_owned(),
        source: "(b^2 + a^2 / 2) / b".to_owned(),
        run: Box::new(move |runs| decay_length(arm, known, runs)),
        plans: vec![Plan::first_order(Method::QUASI_STATIC, step_s, 4, first, limit)],
    }
}

fn decay_length(arm: f64, known: f64, runs: &Runs) -> Measured {
    let (from, way) = (0.01, 0.1);
    let start = Motion { pose: Pose::new(0.0, 0.0, 1e-3), twist: Twist::ZERO };
    // So stiff that it lengthens the arm by 33 nm.
    let spring = PolarSpring { radial_stiffness: 1e6 * RADIAL, ..isotropic(Vec2::new(arm, 0.0), 0.0) };
    let tip = start.pose.to_world(&spring.root);
    let mut run: Box<dyn Backend> = runs.start(&paper_system(vec![spring]), start);
    run.attach(0, tip);
    let mut report = run.advance(&[tip + Vec2::new(from, 0.0)], from);
    let before = run.motion().pose.heading;
    report.add(&run.advance(&[tip + Vec2::new(from + way, 0.0)], way));
    let length = -way / (run.motion().pose.heading / before).ln();
    Measured { values: vec![Value::metres(length, known)], arm: SUPPORT_RADIUS, report }
}
