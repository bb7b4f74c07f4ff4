//! What must not matter: a second run, the length of control ticks, units.

use super::asked::{Asked, Course};
use super::scenes::{CLOSED, load_on, scenario, tip};
use super::test::{Measure, Test};
use crate::subject::Ended;
use crate::verify::scenes::{LOAD_RADIUS, REST_LENGTH, at_rest, paper_springs};
use cohaul::math::Pose;
use cohaul::model::{Outline, PolarSpring};
use cohaul::scenario::{Drive, Scenario};

const REPEAT: Test = Test {
    key: "C8",
    name: "repeat",
    what: "difference of two equal runs; errors of C8, C9 and C13 count over the path length",
    source: "0: equal input, equal output",
    meaning: "whether an experiment can be repeated",
    has_inertia: false,
    run: repeat,
};
const TICKS: Test = Test {
    key: "C9",
    name: "control ticks",
    what: "difference of two runs of the same steps, one with control ticks half as long",
    source: "0: a look at the state does not change it",
    meaning: "whether the rate of a controller changes the physics",
    has_inertia: false,
    run: ticks,
};
const UNITS: Test = Test {
    key: "C13",
    name: "units",
    what: "difference of a run in metres and kilograms and the same in millimetres and grams",
    source: "0: the numbers of a scene in other units describe the same motion",
    meaning: "whether the size of a scene runs into tolerances that the engine has in its own units",
    has_inertia: false,
    run: units,
};

pub const TESTS: [Test; 3] = [REPEAT, TICKS, UNITS];

/// The paper's load, which a spring at its edge tows and turns for a second.
fn towed_at_edge(control_period: f64) -> Scenario {
    let reach = LOAD_RADIUS + REST_LENGTH;
    let path = tip(0, &[(0.0, [reach, 0.0]), (0.5, [reach + 0.04, 0.02]), (1.0, [reach + 0.06, 0.05])]);
    scenario("towed at its edge", load_on(paper_springs(1)), at_rest(), [1.0, control_period], vec![path])
}

/// A third of the tip's path length, which the load follows at the length of the spring (m).
const LEAST_PATH: f64 = 0.025;

/// Largest edge displacement between two runs at instants of both (m), where places of the second
/// are divided by `unit`, over the path length.
fn difference(one: &Course, other: &Course, unit: f64) -> Vec<Measure> {
    let between = |a: &Pose, b: &Pose| (a.position - b.position / unit).norm() + LOAD_RADIUS * (a.heading - b.heading).abs();
    let mut rows = other.rows.iter().peekable();
    let mut most: f64 = 0.0;
    for row in &one.rows {
        while rows.next_if(|next| next.time < row.time * (1.0 - CLOSED)).is_some() {}
        let Some(same) = rows.peek() else { break };
        most = most.max(between(&row.motion.pose, &same.motion.pose));
    }
    let length = one.path_length().max(CLOSED * LOAD_RADIUS);
    // What stands still is the same in every scene.
    let moved = Measure::at_least("path length, at least", "m", LEAST_PATH, one.path_length(), 0.0);
    vec![Measure::over(length, "difference", "m", 0.0, most, CLOSED * length), moved]
}

fn repeat(asked: &Asked) -> Result<Vec<Measure>, Ended> {
    let scenario = towed_at_edge(asked.step_s);
    let (one, other) = (asked.run(&scenario)?, asked.run(&scenario)?);
    Ok(difference(&one, &other, 1.0))
}

fn ticks(asked: &Asked) -> Result<Vec<Measure>, Ended> {
    let (long, short) = (asked.run(&towed_at_edge(2.0 * asked.step_s))?, asked.run(&towed_at_edge(asked.step_s))?);
    Ok(difference(&long, &short, 1.0))
}

/// Millimetres to a metre, and grams to a kilogram (1).
const THOUSAND: f64 = 1e3;

fn units(asked: &Asked) -> Result<Vec<Measure>, Ended> {
    let metres = towed_at_edge(asked.step_s);
    let (one, other) = (asked.run(&metres)?, asked.run(&in_millimetres(&metres))?);
    Ok(difference(&one, &other, THOUSAND))
}

/// The numbers of a scene in millimetres, grams and seconds.
fn in_millimetres(scenario: &Scenario) -> Scenario {
    let (length, mass) = (THOUSAND, THOUSAND);
    let mut scenario = scenario.clone();
    let system = &mut scenario.system;
    system.load.mass *= mass;
    system.load.inertia *= mass * length * length;
    system.load.radius *= length;
    system.world.outline = Outline::disc(system.load.radius);
    for support in &mut system.ground.supports {
        support.offset *= length;
        support.normal_load *= mass * length;
    }
    system.springs.iter_mut().for_each(|spring| scale_spring(spring, length, mass));
    scenario.start.pose.position *= length;
    scenario.start.twist.linear *= length;
    if let Drive::Tips(paths) = &mut scenario.drive {
        paths.iter_mut().flat_map(|path| &mut path.waypoints).for_each(|at| at.position *= length);
    }
    scenario
}

fn scale_spring(spring: &mut PolarSpring, length: f64, mass: f64) {
    spring.root *= length;
    spring.rest_length *= length;
    spring.radial_stiffness *= mass;
    spring.torsional_stiffness *= mass * length * length;
}
