//! Loads on springs.

use std::f64::consts::TAU;

use super::asked::Asked;
use super::scenes::{CLOSED, SLIP_STRETCH, load_on, scenario, tip};
use super::test::{Measure, Test};
use crate::known_answers::pulled_after_onset;
use crate::subject::Ended;
use crate::verify::scenes::{LOAD_RADIUS, at_rest, isotropic, natural_rate};
use cohaul::math::Vec2;
use cohaul::scenario::{Scenario, TipPath};

const HOLD: Test = Test {
    key: "C3",
    name: "hold",
    what: "creep of a load that a spring pulls with 0.9 of the slip limit; the error counts over 10 mm/s",
    source: "0: a load at rest below the slip limit stays",
    meaning: "whether objects at rest creep away under a steady pull",
    has_inertia: false,
    run: hold,
};
const PULL: Test = Test {
    key: "C5",
    name: "slow pull",
    what: "place of a load 6 s after a spring through its centre began to pull it at 10 mm/s",
    source: "X - f / k - (V / w) sin w (T - t0), t0 = f / (k V)",
    meaning: "how far behind its robot a towed object is",
    has_inertia: true,
    run: pull,
};
const OSCILLATION: Test = Test {
    key: "C6",
    name: "oscillation",
    what: "amplitude and phase of a load on a spring without friction, after 20 periods, and its place half a period before",
    source: "a harmonic oscillation: 1 of the start, 0 rad, -1 of the start; the phase counts over 1 rad",
    meaning: "whether the steps create or swallow energy",
    has_inertia: true,
    run: oscillation,
};
const REGRASP: Test = Test {
    key: "C12",
    name: "regrasp",
    what: "displacement after a release and a grasp at one instant",
    source: "(S - q) - f / k, the first turning point under constant friction, for pulls k S and k q",
    meaning: "whether a team that changes hands moves the object as far as it should",
    has_inertia: true,
    run: regrasp,
};
const LIGHT: Test = Test {
    key: "C15a",
    name: "light load",
    what: "the slow pull of C5 for a thousandth of the mass at the same friction",
    source: "as C5",
    meaning: "whether a stiff spring on a light object needs smaller steps",
    has_inertia: true,
    run: |asked| pulled(asked, 1e-3),
};
const HEAVY: Test = Test {
    key: "C15b",
    name: "heavy load",
    what: "the slow pull of C5 for a thousand times the mass at the same friction",
    source: "as C5",
    meaning: "whether a heavy object that weak forces move is accurate",
    has_inertia: true,
    run: |asked| pulled(asked, 1e3),
};

pub const TESTS: [Test; 6] = [HOLD, PULL, OSCILLATION, REGRASP, LIGHT, HEAVY];

/// Speed of the tips of the slow pull (m/s).
const TIP_SPEED: f64 = 0.01;

/// The paper's load at rest on one isotropic spring through its centre.
fn towed(name: &str, mass_factor: f64, times: [f64; 2], path: TipPath) -> Scenario {
    let mut system = load_on(vec![isotropic(Vec2::zeros(), 0.0)]);
    system.load.mass *= mass_factor;
    system.load.inertia *= mass_factor;
    scenario(name, system, at_rest(), times, vec![path])
}

fn hold(asked: &Asked) -> Result<Vec<Measure>, Ended> {
    const DURATION: f64 = 2.0;
    let stretched = tip(0, &[(0.0, [0.9 * SLIP_STRETCH, 0.0])]);
    let course = asked.run(&towed("hold", 1.0, [DURATION, asked.step_s], stretched))?;
    // What happens in the first half may be the settling of a penalty law.
    let half = course.rows.iter().find(|row| row.time >= 0.5 * DURATION).expect("the run has a second half");
    let creep = (course.end().motion.pose.position - half.motion.pose.position).norm() / (course.end().time - half.time);
    Ok(vec![Measure::over(TIP_SPEED, "creep", "m/s", 0.0, creep, CLOSED * TIP_SPEED)])
}

fn pull(asked: &Asked) -> Result<Vec<Measure>, Ended> {
    pulled(asked, 1.0)
}

fn pulled(asked: &Asked, mass_factor: f64) -> Result<Vec<Measure>, Ended> {
    const DURATION: f64 = 6.0;
    let path = tip(0, &[(0.0, [0.0, 0.0]), (DURATION, [TIP_SPEED * DURATION, 0.0])]);
    let course = asked.run(&towed("slow pull", mass_factor, [DURATION, asked.step_s], path))?;
    let rate = natural_rate() / mass_factor.sqrt();
    let known = pulled_after_onset(TIP_SPEED, rate, DURATION - SLIP_STRETCH / TIP_SPEED);
    Ok(vec![Measure::new("displacement", "m", known, course.end().motion.pose.position.x, CLOSED * LOAD_RADIUS)])
}

fn oscillation(asked: &Asked) -> Result<Vec<Measure>, Ended> {
    const AMPLITUDE: f64 = 0.01;
    let rate = natural_rate();
    let period = TAU / rate;
    // Whole steps to a period, so that the end is that of one.
    let tick = period / (period / asked.step_s).ceil();
    let mut scenario = towed("oscillation", 1.0, [20.0 * period, tick], tip(0, &[(0.0, [0.0, 0.0])]));
    scenario.system.ground.friction_coefficient = 0.0;
    scenario.start.pose.position.x = AMPLITUDE;
    let course = asked.run(&scenario)?;
    let end = course.end().motion;
    // Of the instant next to it, which a whole number of steps to the half need not meet.
    let at = 19.5 * period;
    let half = course.rows.iter().min_by(|a, b| (a.time - at).abs().total_cmp(&(b.time - at).abs())).expect("a run has rows");
    let known_half = (rate * half.time).cos();
    let (x, y) = (end.pose.position.x / AMPLITUDE, -end.twist.linear.x / (rate * AMPLITUDE));
    Ok(vec![
        Measure::new("amplitude", "", 1.0, x.hypot(y), CLOSED * 20.0 * TAU),
        Measure::over(1.0, "phase", "rad", 0.0, y.atan2(x), CLOSED * 20.0 * TAU),
        Measure::new("half a period before", "", known_half, half.motion.pose.position.x / AMPLITUDE, CLOSED * 20.0 * TAU),
    ])
}

/// Two springs balance each other with 2.5 f. One is released; at the same instant a third is
/// grasped, which pulls back with 0.5 f. The load goes to the first turning point, at which the two
/// pulls left over balance, and stays.
fn regrasp(asked: &Asked) -> Result<Vec<Measure>, Ended> {
    const AT: f64 = 0.04;
    const DURATION: f64 = 0.5;
    let place = |share: f64| [share * SLIP_STRETCH, 0.0];
    let system = load_on(vec![isotropic(Vec2::zeros(), 0.0); 3]);
    let released = TipPath { release: Some(AT), ..tip(1, &[(0.0, place(-2.5))]) };
    let tips = vec![tip(0, &[(0.0, place(2.5))]), released, tip(2, &[(AT, place(-0.5))])];
    let course = asked.run(&scenario("regrasp", system, at_rest(), [DURATION, asked.step_s], tips))?;
    Ok(vec![Measure::new("displacement", "m", SLIP_STRETCH, course.end().motion.pose.position.x, CLOSED * SLIP_STRETCH)])
}
