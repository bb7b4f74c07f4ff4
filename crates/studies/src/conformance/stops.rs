//! Loads that friction stops.

use std::f64::consts::{PI, SQRT_2};

use super::asked::{Asked, Course};
use super::scenes::{CLOSED, load_on, scenario, thrown};
use super::test::{Measure, Test};
use crate::known_answers::slide_distance;
use crate::subject::Ended;
use crate::verify::scenes::{GRAVITY, LOAD_RADIUS, MASS, MU, SLIP_LIMIT, SUPPORT_RADIUS, moving};
use crate::verify::tripod::STARTS;
use cohaul::math::{Vec2, direction};
use cohaul::model::SupportPoint;
use cohaul::scenario::Scenario;

const SLIDE: Test = Test {
    key: "C1",
    name: "slide",
    what: "distance of a load that starts at 0.3 m/s, and the energy it loses",
    source: "v^2 / (2 mu g), m v^2 / 2",
    meaning: "how far an object slides after it was let go",
    has_inertia: true,
    run: slide,
};
const SPIN: Test = Test {
    key: "C2",
    name: "spin",
    what: "angle of a load that starts at 40 rad/s",
    source: "I omega^2 / (2 f a), a the distance of the supports",
    meaning: "how far an object turns after it was let go",
    has_inertia: true,
    run: spin,
};
const DIRECTION: Test = Test {
    key: "C4",
    name: "friction direction",
    what: "direction of friction at one support off the centre that slips along 45 deg, and the speed it takes in a step",
    source: "Coulomb's law: against the slip velocity, which turns a little within the first step; mu g h",
    meaning: "whether a pushed object takes the right turn",
    has_inertia: true,
    run: friction_direction,
};
const ORDER: Test = Test {
    key: "C7",
    name: "order",
    what: "order of convergence of a slide with a turn, and its end in the limit of small steps",
    source: "at least 1; end from an extrapolation in 28 digits by an independent program",
    meaning: "whether smaller steps lead to the right answer, and how fast",
    has_inertia: true,
    run: order,
};
const DIRECTIONS: Test = Test {
    key: "C14",
    name: "isotropy",
    what: "spread of the distances of slides along 0, 15, 30 and 45 deg",
    source: "Coulomb's law has no preferred direction",
    meaning: "whether results depend on how a scene is turned",
    has_inertia: true,
    run: isotropy,
};

pub const TESTS: [Test; 5] = [SLIDE, SPIN, DIRECTION, ORDER, DIRECTIONS];

const SPEED: f64 = 0.3;
const TURN_RATE: f64 = 40.0;

/// Time after which a slide at this speed (m/s) is at rest, also one that is braked by three
/// quarters of friction only (s).
fn until_rest(speed: f64) -> f64 {
    speed / (0.75 * MU * GRAVITY)
}

/// The first scene, which any engine must take.
pub fn first_scene(step_s: f64) -> Scenario {
    thrown("slide", [SPEED, 0.0, 0.0], [until_rest(SPEED), step_s])
}

fn slide(asked: &Asked) -> Result<Vec<Measure>, Ended> {
    let course = asked.run(&first_scene(asked.step_s))?;
    let (end, known) = (course.end(), slide_distance(SPEED, MU * GRAVITY));
    let distance = Measure::new("distance", "m", known, end.motion.pose.position.x, CLOSED * known);
    let lost = 0.5 * MASS * SPEED * SPEED;
    let energy = course.computes.energy.then(|| Measure::new("energy lost", "J", lost, end.energy.dissipated(), CLOSED * lost));
    Ok([distance].into_iter().chain(energy).collect())
}

fn spin(asked: &Asked) -> Result<Vec<Measure>, Ended> {
    let inertia = 0.5 * MASS * LOAD_RADIUS * LOAD_RADIUS;
    let braking = SLIP_LIMIT * SUPPORT_RADIUS / inertia;
    let course = asked.run(&thrown("spin", [0.0, 0.0, TURN_RATE], [TURN_RATE / (0.75 * braking), asked.step_s]))?;
    let known = TURN_RATE * TURN_RATE / (2.0 * braking);
    Ok(vec![Measure::new("angle", "rad", known, course.end().motion.pose.heading, CLOSED * known)])
}

/// One support at distance a on the y axis slips along 45 degrees. The load brakes and begins to
/// turn, which turns the slip by f a^2 t / (2 I v) after a time t. At this speed (m/s) that is
/// small, and half of it is what the first step has on average. Some engines limit how far a load
/// goes in a step, which a far higher speed would meet.
const FAST: f64 = 1.0;

fn friction_direction(asked: &Asked) -> Result<Vec<Measure>, Ended> {
    let mut system = load_on(Vec::new());
    system.ground.supports =
        vec![SupportPoint { offset: Vec2::new(0.0, SUPPORT_RADIUS), normal_load: MASS * GRAVITY, friction_coefficient: None }];
    let along = FAST / SQRT_2;
    let h = asked.step_s;
    let course = asked.run(&scenario("one support", system.clone(), moving(along, along, 0.0), [h, h], Vec::new()))?;
    let change = course.rows[0].motion.twist.linear - course.end().motion.twist.linear;
    let turned = 0.25 * SLIP_LIMIT * SUPPORT_RADIUS * SUPPORT_RADIUS / system.load.inertia * h / FAST;
    // Of the second order in that turn.
    let direction = Measure::new("direction", "rad", PI / 4.0 + turned, change.y.atan2(change.x), 4.0 * turned * turned);
    // As the load turns, the force leaves the direction of the start: by the turn, to second order.
    let lost = MU * GRAVITY * h;
    Ok(vec![direction, Measure::new("speed lost", "m/s", lost, change.norm(), 4.0 * turned * turned * lost)])
}

/// The pinned start of the tripod, whose end is known in units of its supports' distance.
fn order(asked: &Asked) -> Result<Vec<Measure>, Ended> {
    let start = STARTS[0];
    let time = (SUPPORT_RADIUS / (MU * GRAVITY)).sqrt();
    let duration = 1.3 * start.stop * time;
    let end_at = |share: f64| -> Result<(Course, [f64; 3]), Ended> {
        let step_s = share * asked.step_s;
        let thrown = thrown("slide and turn", [SUPPORT_RADIUS / time, 0.0, start.turn_rate / time], [duration, asked.step_s]);
        let course = asked.run_at(&thrown, step_s)?;
        let pose = course.end().motion.pose;
        Ok((course, [pose.position.x, pose.position.y, LOAD_RADIUS * pose.heading]))
    };
    let (course, whole) = end_at(1.0)?;
    let (half, quarter) = (end_at(0.5)?.1, end_at(0.25)?.1);
    let apart = |a: [f64; 3], b: [f64; 3]| (a[0] - b[0]).hypot(a[1] - b[1]) + (a[2] - b[2]).abs();
    let [first, second] = [apart(whole, half), apart(half, quarter)];
    let known = [SUPPORT_RADIUS * start.end[0], SUPPORT_RADIUS * start.end[1], LOAD_RADIUS * start.end[2]];
    let length = course.path_length().max(SUPPORT_RADIUS * start.end[0]);
    // Differences that are rounding have no order, and need none.
    let order = if first <= CLOSED.sqrt() * length { f64::INFINITY } else { (first / second).log2() };
    let limit = limit(half, quarter, order);
    // All digits of the end count, and those of the three runs under their limit.
    let accuracy = 1e-9 * length;
    let of_limit = Measure::over(length, "end in the limit of small steps", "m", 0.0, apart(limit, known), accuracy);
    // What lies between two steps, as the stop, moves a measured order by a few hundredths.
    let of_order = order.is_finite().then(|| Measure::at_least("order", "", 1.0, order, 0.05));
    Ok(of_order.into_iter().chain([of_limit]).collect())
}

/// The end in the limit of small steps, where errors fall by 2^order from a half of the step to a
/// quarter. Where they do not fall at least like a square root, the last run stands for it.
fn limit(half: [f64; 3], quarter: [f64; 3], order: f64) -> [f64; 3] {
    const LEAST: f64 = 0.5;
    if order < LEAST || !order.is_finite() {
        return quarter;
    }
    let left = 1.0 / (order.exp2() - 1.0);
    [0, 1, 2].map(|at| quarter[at] + left * (quarter[at] - half[at]))
}

fn isotropy(asked: &Asked) -> Result<Vec<Measure>, Ended> {
    let known = slide_distance(SPEED, MU * GRAVITY);
    let distance = |degrees: f64| {
        let along = SPEED * direction(degrees.to_radians());
        let course = asked.run(&thrown("slide", [along.x, along.y, 0.0], [until_rest(SPEED), asked.step_s]))?;
        Ok(course.end().motion.pose.position.norm())
    };
    let found = [0.0, 15.0, 30.0, 45.0].into_iter().map(distance).collect::<Result<Vec<f64>, Ended>>()?;
    let [least, most] = [found.iter().copied().fold(f64::INFINITY, f64::min), found.iter().copied().fold(0.0, f64::max)];
    let moved = Measure::at_least("least distance, at least", "m", 0.5 * known, least, 0.0);
    Ok(vec![Measure::over(known, "spread", "m", 0.0, most - least, CLOSED * known), moved])
}
