//! Loads at walls, in scenes of `scenarios/contact/`.

use super::asked::{Asked, Course};
use super::scenes::{CLOSED, SLIP_STRETCH};
use super::test::{Measure, Test};
use crate::known_answers::{pulled_after_onset, slide_distance};
use crate::subject::Ended;
use crate::verify::scenes::{GRAVITY, LOAD_RADIUS, MU, RADIAL, natural_rate};
use cohaul::scenario::Scenario;

const WALL: Test = Test {
    key: "C10a",
    name: "wall",
    what: "place of a disc that a spring drags along a frictionless wall for 1 s, and the force of the wall",
    source: "v t - (v / w) sin w t after the onset; k times the depth of the tip",
    meaning: "whether an object slides along a wall as fast as it should",
    has_inertia: true,
    run: wall,
};
const ROUGH_WALL: Test = Test {
    key: "C10b",
    name: "rough wall",
    what: "place of a box that a spring drags along a wall with friction 0.3 for 1 s",
    source: "v = 54 mm/s in C10a: the wall takes 0.3 of the 20 mm/s at which the tip goes into it",
    meaning: "whether friction at a wall has its coefficient",
    has_inertia: true,
    run: rough_wall,
};
const REBOUND: Test = Test {
    key: "C11a",
    name: "rebound",
    what: "how far a disc goes back from a wall 4 mm ahead that it hits at 0.374 m/s, restitution 0.6",
    source: "(e v1)^2 / (2 mu g), v1^2 = v0^2 - 2 mu g d",
    meaning: "how far objects bounce back",
    has_inertia: true,
    run: rebound,
};
const PLASTIC: Test = Test {
    key: "C11b",
    name: "plastic impact",
    what: "place at which a disc stops that hits a frictionless wall at (0.3, -0.2) m/s, restitution 0",
    source: "(v_x^2 / (2 mu g), 0): the speed along the wall is kept, that across is lost",
    meaning: "whether an object that hits a wall slides on along it",
    has_inertia: true,
    run: plastic,
};

pub const TESTS: [Test; 4] = [WALL, ROUGH_WALL, REBOUND, PLASTIC];

/// Velocity of the tip along the wall and into it (m/s).
const TIP: [f64; 2] = [0.06, 0.02];

fn run(asked: &Asked, text: &str, name: &str) -> Result<Course, Ended> {
    let mut scenario = Scenario::parse(text, name).expect("scenarios of the project are valid");
    scenario.control_period = asked.step_s;
    asked.run(&scenario)
}

/// Displacement along a wall that takes this share of the force into it, after a time (s) (m).
fn along(friction: f64, time: f64) -> f64 {
    let speed = TIP[0] - friction * TIP[1];
    pulled_after_onset(speed, natural_rate(), time - SLIP_STRETCH / speed)
}

fn wall(asked: &Asked) -> Result<Vec<Measure>, Ended> {
    let course = run(asked, include_str!("../../../../scenarios/contact/wall-slide.json"), "wall-slide")?;
    let (end, known) = (course.end(), along(0.0, 1.0));
    let place = Measure::new("displacement", "m", known, end.motion.pose.position.x, CLOSED * LOAD_RADIUS);
    let pressed = RADIAL * TIP[1];
    let found = end.contacts.iter().map(|contact| contact.force.y).sum();
    // The force is that of the last step on average, in which the tip goes on.
    let in_step = pressed * asked.step_s;
    let force = course.computes.contacts.then(|| Measure::new("force of the wall", "N", pressed, found, in_step));
    Ok([place].into_iter().chain(force).collect())
}

fn rough_wall(asked: &Asked) -> Result<Vec<Measure>, Ended> {
    let course = run(asked, include_str!("../../../../scenarios/contact/box-wall-friction.json"), "box-wall-friction")?;
    Ok(vec![Measure::new("displacement", "m", along(0.3, 1.0), course.end().motion.pose.position.x, CLOSED * LOAD_RADIUS)])
}

fn rebound(asked: &Asked) -> Result<Vec<Measure>, Ended> {
    const SPEED: f64 = 0.5;
    const DISTANCE: f64 = 4e-3;
    const RESTITUTION: f64 = 0.6;
    let course = run(asked, include_str!("../../../../scenarios/contact/rebound.json"), "rebound")?;
    let left = slide_distance(SPEED, MU * GRAVITY) - DISTANCE;
    let known = RESTITUTION * RESTITUTION * left;
    Ok(vec![Measure::new("distance back", "m", known, DISTANCE - course.end().motion.pose.position.x, CLOSED * LOAD_RADIUS)])
}

fn plastic(asked: &Asked) -> Result<Vec<Measure>, Ended> {
    let course = run(asked, include_str!("../../../../scenarios/contact/oblique-impact.json"), "oblique-impact")?;
    let (end, known) = (course.end().motion.pose.position, slide_distance(0.3, MU * GRAVITY));
    Ok(vec![
        Measure::new("along the wall", "m", known, end.x, CLOSED * LOAD_RADIUS),
        Measure::over(known, "across the wall", "m", 0.0, end.y, CLOSED * LOAD_RADIUS),
    ])
}
