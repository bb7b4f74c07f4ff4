//! Loads among obstacles: where they end, from closed forms and from ordinary differential
//! equations integrated independently.
//!
//! All loads are discs and boxes of the paper's mass on one isotropic spring, in the scenes of
//! `scenarios/contact/`.

use super::case::{Bound, Case, Family, Plan};
use super::measured::{Errors, Measured, Value};
use super::scenes::SUPPORT_RADIUS;
use crate::methods::Method;
use crate::subject::Runs;
use cohaul::scenario::Scenario;
use cohaul::simulation::Keep;

/// Longest step (s), which is the control period of all scenes.
const STEP: f64 = 1e-3;
const N_STEPS: usize = 4;
/// Rounding of a few hundred steps (m).
const ROUNDING: f64 = 1e-12;

struct Scene {
    name: &'static str,
    text: &'static str,
    what: &'static str,
    source: &'static str,
    /// (m, m, rad); no heading where none is known.
    end: ([f64; 2], Option<f64>),
}

const WALL: Scene = Scene {
    name: "wall-slide",
    text: include_str!("../../../../scenarios/contact/wall-slide.json"),
    what: "end of a disc that a spring drags along a frictionless wall",
    source: "spring force along the wall = slip limit",
    end: ([26.906_024_096_386e-3, 0.0], Some(0.0)),
};
const WALL_WITH_INERTIA: Scene = Scene {
    name: "wall-slide-inertia",
    what: "end of a disc with inertia that a spring drags along a frictionless wall",
    source: "speed times time - speed / omega sin(omega t) after the slip onset",
    end: ([26.065_257_955e-3, 0.0], Some(0.0)),
    ..WALL
};
const ROUGH_WALL: Scene = Scene {
    name: "wall-friction",
    text: include_str!("../../../../scenarios/contact/box-wall-friction.json"),
    what: "end of a box that a spring drags along a wall with friction 0.3",
    source: "spring force along the wall = slip limit + 0.3 of the normal force",
    end: ([20.906_024_096_386e-3, 0.0], Some(0.0)),
};
const POST: Scene = Scene {
    name: "post-arc",
    text: include_str!("../../../../scenarios/contact/post-arc.json"),
    what: "end of a disc that a spring drags round a frictionless post",
    source: "angle of the tip - asin(slip limit / (k tip radius))",
    end: ([16.379_861_540e-3, 5.247_869_655e-3], None),
};
const NOTCH: Scene = Scene {
    name: "notch-jam",
    text: include_str!("../../../../scenarios/contact/notch-jam.json"),
    what: "place at which a disc jams between two walls at a right angle",
    source: "sqrt(2) R",
    end: ([0.0, 17.253_405_461e-3], None),
};
const LIFT: Scene = Scene {
    name: "box-lift",
    text: include_str!("../../../../scenarios/contact/box-lift.json"),
    what: "end of a box whose rear corner leaves the wall",
    source: "ordinary differential equation to 1e-8",
    end: ([27.122_317_1e-3, 2.710_835_4e-3], Some(-0.244_045_45)),
};
const ROLL: Scene = Scene {
    name: "disc-roll",
    text: include_str!("../../../../scenarios/contact/disc-roll.json"),
    what: "end of a disc that rolls along a wall with friction 2",
    source: "x + T(-x / R) / (k R) = place of the tip, T the torque of the ground",
    end: ([43.364_939_119e-3, 0.0], Some(-3.554_503_206_46)),
};
const ROLL_AND_SLIP: Scene = Scene {
    name: "disc-roll-slip",
    text: include_str!("../../../../scenarios/contact/disc-roll-slip.json"),
    what: "end of a disc that rolls and slips along a wall with friction 0.2",
    source: "ordinary differential equation and steps, to 1e-9 m and 3e-8 rad",
    end: ([43.844_125_5e-3, 0.0], Some(-2.003_185_6)),
};
const REBOUND: Scene = Scene {
    name: "rebound",
    text: include_str!("../../../../scenarios/contact/rebound.json"),
    what: "place at which a sliding disc stops after its rebound from a wall, restitution 0.6",
    source: "v^2 / (2 mu g) before and after the impact",
    end: ([2.163_460_026e-3, 0.0], Some(0.0)),
};
const IMPACT: Scene = Scene {
    name: "oblique-impact",
    text: include_str!("../../../../scenarios/contact/oblique-impact.json"),
    what: "place at which a disc stops that slides on along a wall after a plastic impact",
    source: "v^2 / (2 mu g) of the speed along the wall",
    end: ([3.276_539_974e-3, 0.0], Some(0.0)),
};

const HOLDING_WALL: Scene = Scene {
    name: "wall-stick",
    text: include_str!("../../../../scenarios/contact/box-wall-stick.json"),
    what: "rest of a box whose pull stays in the friction cone of a wall, friction 1.2",
    source: "tan of the pull's angle to the wall's normal < friction coefficient",
    end: ([0.0, 0.0], Some(0.0)),
};
const SLIPPING_WALL: Scene = Scene {
    name: "wall-slip",
    text: include_str!("../../../../scenarios/contact/box-wall-slip.json"),
    what: "end of a box that a spring drags along a wall with friction 1.2",
    source: "spring force along the wall = slip limit + 1.2 of the normal force",
    end: ([6.906_024_096_386e-3, 0.0], Some(0.0)),
};
const GAP: Scene = Scene {
    name: "posts-gap",
    text: include_str!("../../../../scenarios/contact/posts-gap.json"),
    what: "place at which a disc stops between two posts",
    source: "50 mm - sqrt(17.2^2 - 16^2) mm",
    end: ([43.688_106_465e-3, 0.0], Some(0.0)),
};
const HELD: Scene = Scene {
    name: "post-held",
    text: include_str!("../../../../scenarios/contact/post-jump.json"),
    what: "place at which a post beside its path holds a disc before it jumps round it",
    source: "40 mm - sqrt(15.2^2 - 10^2) mm",
    end: ([28.552_729_583e-3, 0.0], None),
};
const STOP: Scene = Scene {
    name: "jump-to-wall",
    text: include_str!("../../../../scenarios/contact/jump-to-wall.json"),
    what: "place at which a wall stops a disc that twice the slip limit draws",
    source: "distance of the wall",
    end: ([10e-3, 0.0], Some(0.0)),
};
const OBLIQUE_REBOUND: Scene = Scene {
    name: "oblique-rebound",
    text: include_str!("../../../../scenarios/contact/oblique-rebound.json"),
    what: "place at which a disc stops that rebounds from a wall at an angle, restitution 0.5",
    source: "v^2 / (2 mu g) along (3, 1) / sqrt(10)",
    end: ([3.453_776_387_252e-3, 1.151_258_795_751e-3], Some(0.0)),
};
const PUSHER: Scene = Scene {
    name: "pusher",
    text: include_str!("../../../../scenarios/contact/pusher.json"),
    what: "end of a disc that a post pushes straight ahead",
    source: "displacement of the post",
    end: ([50e-3, 0.0], Some(0.0)),
};

pub fn cases() -> Vec<Case> {
    let (metres, pose) = (Bound::metres, Bound::pose);
    let (exact, midpoint, engine) = (Method::QUASI_STATIC, Method::INERTIAL_MIDPOINT, Method::RAPIER);
    let rounding = || Plan::exact(exact, STEP, N_STEPS, pose(ROUNDING, 1e-10, "rounding: steps end on the path at any length"));
    let with_rounding = || Plan::exact(midpoint, STEP, N_STEPS, pose(ROUNDING, 1e-10, "rounding: obstacles alone say where it is"));
    let quasi_static = |power, bound| Plan::within(power, exact, STEP, N_STEPS, bound);
    let inertial = |bound| Plan::within(1.0, midpoint, STEP, N_STEPS, bound);
    let of_engine = |bound| Plan::within(1.0, engine, STEP, N_STEPS, bound);
    let oblique =
        || vec![inertial(pose(5e-6, 1e-9, "a stop within a step, mu g h^2 / 4")), of_engine(pose(3e-4, 1e-9, "a step at 0.3 m/s"))];
    let held = metres(1e-5, "a contact that closes within a step of the tip, 0.09 m/s");
    let (controlled, with_inertia) = (Method::QUASI_STATIC_CONTROLLED, Method::INERTIAL_CONTROLLED);
    vec![
        case(WALL, vec![rounding()], Some(controlled)),
        case(
            WALL_WITH_INERTIA,
            vec![
                inertial(pose(4e-6, 1e-9, "an onset within a step, 0.06 m/s and (omega h)^2")),
                of_engine(pose(1.5e-4, 0.05, "two steps at 0.06 m/s; the disc turns while friction follows its axis")),
            ],
            Some(with_inertia),
        ),
        case(ROUGH_WALL, vec![rounding()], Some(controlled)),
        case(POST, vec![quasi_static(1.0, metres(2e-7, "a step of the angle, squared, times the radius"))], Some(controlled)),
        case(
            NOTCH,
            vec![
                rounding(),
                Plan::exact(midpoint, STEP, N_STEPS, metres(ROUNDING, "rounding: the walls alone say where it stops")),
                of_engine(metres(1e-6, "penetration of a contact that is all but rigid")),
            ],
            Some(controlled),
        ),
        case(LIFT, vec![quasi_static(1.0, pose(2e-5, 2e-3, "a third of a step of the tip, 0.06 m/s"))], Some(controlled)),
        case(ROLL, vec![quasi_static(1.0, pose(2e-7, 2e-5, "a step of the heading, squared, times the radius"))], Some(controlled)),
        case(ROLL_AND_SLIP, vec![quasi_static(1.0, pose(5e-7, 2e-4, "a slip onset within a step"))], None),
        case(
            REBOUND,
            vec![
                inertial(pose(4e-6, 1e-9, "a stop within a step, mu g h^2 / 4")),
                of_engine(pose(3e-4, 1e-9, "half a step at 0.5 m/s and its rebound")),
            ],
            Some(with_inertia),
        ),
        case(IMPACT, oblique(), Some(with_inertia)),
        case(OBLIQUE_REBOUND, oblique(), Some(with_inertia)),
        case(HOLDING_WALL, vec![rounding(), with_rounding()], Some(controlled)),
        case(SLIPPING_WALL, vec![rounding()], Some(controlled)),
        case(GAP, vec![rounding(), with_rounding()], Some(controlled)),
        case_until(0.85, HELD, vec![quasi_static(1.0, held)], Some(controlled)),
        case(STOP, vec![rounding(), with_rounding(), of_engine(pose(1e-6, 1e-9, "a contact that is all but rigid"))], Some(with_inertia)),
        case(PUSHER, vec![rounding(), with_rounding(), of_engine(pose(1e-9, 1e-9, "a contact that is all but rigid"))], Some(controlled)),
    ]
}

/// A case with its plans, and one under error control.
fn case(scene: Scene, plans: Vec<Plan>, controlled: Option<Method>) -> Case {
    case_until(f64::INFINITY, scene, plans, controlled)
}

/// The case of a scene that ends at this time, if not before (s).
fn case_until(until: f64, scene: Scene, mut plans: Vec<Plan>, controlled: Option<Method>) -> Case {
    let Scene { name, text, what, source, end: (position, heading) } = scene;
    let mut scenario = Scenario::parse(text, name).expect("scenarios of the project are valid");
    scenario.duration = scenario.duration.min(until);
    let load = scenario.system.load;
    let errors = Errors { metres: Some(0.0), radians: heading.map(|_| 0.0), ratio: None };
    plans.extend(controlled.map(|method| Plan::controlled(method, &load, &errors)));
    let run = move |runs: &Runs| {
        let mut run = runs.simulation(&scenario, runs, Keep::Outcome);
        run.run(|_| true);
        let outcome = run.outcome();
        let found = outcome.motion.pose;
        let values = [(found.position.x, position[0]), (found.position.y, position[1])].map(|(found, known)| Value::metres(found, known));
        let turn = heading.map(|known| Value::radians(found.heading, known));
        Measured { values: values.into_iter().chain(turn).collect(), arm: SUPPORT_RADIUS, report: outcome.steps }
    };
    Case { name: name.to_owned(), family: Family::Contact, what: what.to_owned(), source: source.to_owned(), run: Box::new(run), plans }
}
