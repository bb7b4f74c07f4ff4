//! The reference scene: three of four springs on curved paths in one second, through rest, rotation
//! about a support and free slip.
//!
//! The known poses are those of an independent program, extrapolated over halved steps; it
//! parametrises the step in world increments, too, with the same limit.

use super::case::{Bound, Case, Family, Plan};
use super::measured::{Measured, Value};
use super::scenes::{SUPPORT_RADIUS, at_rest, drive, n_pieces, paper_springs, paper_system, reference_tips};
use crate::methods::Method;
use crate::subject::Runs;

/// x, y (m) and heading (rad) at half way and at the end.
pub type Poses = [[f64; 3]; 2];

/// Without inertia; ten digits.
pub const QUASI_STATIC: Poses = [[0.01390510503, 0.00217369982, 0.22067685358], [0.03129917543, 0.00241685635, 0.05295349298]];
/// Friction loss of that (J), nine digits.
pub const LOSS: f64 = 6.98738388e-4;
/// With the paper's mass in one second; ten digits.
pub const INERTIAL: Poses = [[0.0129133674, 0.0020246454, 0.2189682137], [0.0312405053, 0.0024621252, 0.0539447220]];

pub fn cases() -> Vec<Case> {
    vec![
        case("reference-quasi-static", "without inertia", QUASI_STATIC, quasi_static_plans()),
        case("reference-inertial", "of 1.6 g", INERTIAL, inertial_plans()),
    ]
}

fn case(name: &str, which: &str, known: Poses, plans: Vec<Plan>) -> Case {
    Case {
        name: name.to_owned(),
        family: Family::Reference,
        what: format!("poses at half way and at the end of a load {which} on three springs, through rest, pivoting and slip"),
        source: "extrapolation to ten digits by an independent program".to_owned(),
        run: Box::new(move |runs| poses(runs, known)),
        plans,
    }
}

fn quasi_static_plans() -> Vec<Plan> {
    let first = Bound::pose(4e-5, 6e-4, "one step's share of the path of 31 mm, of its turn and of its loss");
    let limit = Bound::pose(2e-10, 1e-9, "changes of contact mode within steps leave a part of h^2; ten digits of the known answer");
    let with_loss = |bound: Bound, ratio| Bound { errors: super::Errors { ratio: Some(ratio), ..bound.errors }, ..bound };
    vec![Plan::first_order(Method::QUASI_STATIC, 1.0 / 800.0, 5, with_loss(first, 1.25e-3), with_loss(limit, 1e-8))]
}

/// Swings of the load about its path must be resolved before errors fall as they should.
fn inertial_plans() -> Vec<Plan> {
    let first = Bound::pose(3e-5, 1e-4, "damping by omega h / 2 of swings that the change of contact mode begins");
    let limit = Bound::pose(2e-9, 2e-8, "changes of contact mode within steps leave a part of h^2; ten digits of the known answer");
    let midpoint = Bound::pose(1e-7, 3e-7, "changes of contact mode lie within steps: h^2 with no steady constant");
    let first_order = |method| Plan::first_order(method, 1.0 / 6400.0, 4, first.clone(), limit.clone());
    vec![
        first_order(Method::INERTIAL_EULER),
        first_order(Method::RAPIER),
        Plan::within(2.0, Method::INERTIAL_MIDPOINT, 1.0 / 3200.0, 4, midpoint),
    ]
}

fn poses(runs: &Runs, known: Poses) -> Measured {
    let mut run = runs.start(&paper_system(paper_springs(4)), at_rest());
    // An even number: half way is a node.
    let n = 2 * n_pieces(0.5, runs) as u32;
    let mut found = Vec::with_capacity(n as usize);
    let report = drive(run.as_mut(), reference_tips, 1.0, n, |_, run| {
        let pose = run.motion().pose;
        found.push([pose.position.x, pose.position.y, pose.heading]);
    });
    let [half_way, end] = [n / 2, n].map(|node| found[node as usize - 1]);
    let mut values = [Value::pose(half_way, known[0]), Value::pose(end, known[1])].concat();
    if !runs.kind.has_inertia() {
        values.push(Value::ratio(run.energy().friction / LOSS, 1.0));
    }
    Measured { values, arm: SUPPORT_RADIUS, report }
}
