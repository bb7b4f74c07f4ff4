//! Numbers that look like another unit: millimetres, grams, degrees, percent.

use std::f64::consts::{PI, TAU};

use crate::model::{PolarSpring, System};
use crate::scenario::error::{Findings, short};
use crate::scenario::format::STANDARD_GRAVITY;
use crate::scenario::{AntDrive, Drive, Scenario, TipPath};

/// Weight of a load over gravity and the area of its disc (kg/m^2): a sheet of paper has 0.1, a
/// block of steel a metre high has 8000.
const AREAL_MASS: [f64; 2] = [1e-3, 1e4];
/// Least normal load of a mass (m/s^2): with a mass in grams it is 0.01.
const LEAST_GRAVITY: f64 = 0.1;
/// Largest coefficient of friction (1): rubber has about 2, and in percent it is 10 to 200.
const LARGEST_FRICTION: f64 = 5.0;
/// Largest damping ratio of a spring (1), beyond that of stiff links; in percent it is 5 to 100.
const LARGEST_DAMPING: f64 = 25.0;
/// Largest distance of a support or a root from the origin over the load's radius (1).
const LARGEST_OFFSET: f64 = 2.0;
/// Largest rest length over the load's radius (1).
const LONGEST_SPRING: f64 = 50.0;
/// Largest stiffness across a spring over that along it (1).
const STIFFEST_ACROSS: f64 = 100.0;
/// Longest distance in which friction stops the load, over its radius (1).
const LONGEST_COAST: f64 = 1000.0;
/// Largest sensing range of an ant over the load's radius (1).
const LONGEST_SENSING: f64 = 100.0;
/// Largest pull of an ant over the slip limit (1).
const STRONGEST_PULL: f64 = 100.0;
/// Fewest control periods that a speed lasts (1); a shorter part of a path is a jump of its tip.
const FEWEST_PERIODS: f64 = 10.0;

pub fn check(scenario: &Scenario, findings: &mut Findings) {
    let system = &scenario.system;
    weight(system, findings);
    ratios(system, findings);
    lengths(system, findings);
    angles(scenario, findings);
    coast(scenario, findings);
    match &scenario.drive {
        Drive::Tips(paths) => speeds(scenario, paths, findings),
        Drive::Ants(drive) => ants(scenario, drive, findings),
    }
}

/// Mass and size of the load against each other, and the weight against the mass.
fn weight(system: &System, findings: &mut Findings) {
    let load = &system.load;
    let weight: f64 = system.ground.supports.iter().map(|support| support.normal_load).sum();
    let areal = weight / STANDARD_GRAVITY / (PI * load.radius * load.radius);
    let [least, most] = AREAL_MASS;
    if !(least..=most).contains(&areal) {
        let rule = format!("should be in kilograms and metres: most loads have {least:e} to {most:e} kg/m^2 on their disc");
        let found = format!("{} kg/m^2 ({} kg on a radius of {} m)", short(areal), short(weight / STANDARD_GRAVITY), short(load.radius));
        findings.report("load", rule, found);
    }
    let gravity = weight / load.mass;
    if gravity < LEAST_GRAVITY {
        let rule = format!("should be in newtons, and mass_kg in kilograms: their sum should be at least {LEAST_GRAVITY} N/kg");
        findings.report("ground.supports", rule, format_args!("{} N/kg", short(gravity)));
    }
    for (unit, factor) in [("cm/s^2", 1e2), ("mm/s^2", 1e3)] {
        if (gravity / (factor * STANDARD_GRAVITY) - 1.0).abs() < 0.02 {
            let found = format!("{}, gravity on Earth in {unit}", short(gravity));
            findings.report("ground.gravity_m_per_s2", "should be in m/s^2", found);
        }
    }
}

/// Ratios, which are not in percent.
fn ratios(system: &System, findings: &mut Findings) {
    let mut at_most = |path: String, most: f64, found: f64| {
        if found > most {
            findings.report(path, format!("should be at most {most}, and is a ratio, not percent"), short(found));
        }
    };
    at_most("ground.friction_coefficient".into(), LARGEST_FRICTION, system.ground.friction_coefficient);
    for (index, support) in system.ground.supports.iter().enumerate() {
        at_most(format!("ground.supports[{index}].friction_coefficient"), LARGEST_FRICTION, support.friction_coefficient.unwrap_or(0.0));
    }
    for (index, obstacle) in system.world.obstacles.iter().enumerate() {
        at_most(format!("obstacles[{index}].friction_coefficient"), LARGEST_FRICTION, obstacle.friction_coefficient);
    }
    for (index, spring) in system.springs.iter().enumerate() {
        at_most(format!("springs[{index}].damping_ratio"), LARGEST_DAMPING, spring.damping_ratio);
    }
}

/// Lengths of supports and springs against the load, and the two stiffnesses of a spring.
fn lengths(system: &System, findings: &mut Findings) {
    let radius = system.load.radius;
    let mut within = |path: String, most: f64, found: f64| {
        if found > most * radius {
            let rule = format!("should be at most {most} radii of the load, {} m, and in metres", short(most * radius));
            findings.report(path, rule, format_args!("{} m", short(found)));
        }
    };
    for (index, support) in system.ground.supports.iter().enumerate() {
        within(format!("ground.supports[{index}].offset_m"), LARGEST_OFFSET, support.offset.norm());
    }
    for (index, spring) in system.springs.iter().enumerate() {
        within(format!("springs[{index}].root_m"), LARGEST_OFFSET, spring.root.norm());
        within(format!("springs[{index}].rest_length_m"), LONGEST_SPRING, spring.rest_length);
    }
    for (index, spring) in system.springs.iter().enumerate().filter(|(_, spring)| spring.radial_stiffness > 0.0) {
        let [along, across] = spring.along_and_across(spring.rest_length, spring.stiffness_at(spring.rest_length));
        if across > STIFFEST_ACROSS * along {
            let rule = format!("should be in N m/rad: a spring is at most {STIFFEST_ACROSS} times as stiff across as along");
            let found = format!("{} N/m across and {} N/m along", short(across), short(along));
            findings.report(format_args!("springs[{index}].torsional_stiffness_nm_per_rad"), rule, found);
        }
    }
}

/// Angles beyond a turn, as degrees mostly are.
fn angles(scenario: &Scenario, findings: &mut Findings) {
    let mut within = |path: String, angle: f64| {
        if angle.abs() > TAU {
            findings.report(path, "should be at most one turn, 2 pi, and in radians", short(angle));
        }
    };
    within("load.heading_rad".into(), scenario.start.pose.heading);
    let springs = &scenario.system.springs;
    for (index, spring) in springs.iter().enumerate() {
        // Bearings of a ring go on from that of its first spring, which counts alone.
        if index == 0 || !continues_ring(&springs[index - 1], spring) {
            within(format!("springs[{index}].bearing_rad"), spring.bearing);
        }
    }
    for (index, obstacle) in scenario.system.world.obstacles.iter().enumerate() {
        let waypoints = &obstacle.path.waypoints;
        if !obstacle.path.moves() {
            within(format!("obstacles[{index}].heading_rad"), waypoints[0].1.heading);
        }
        for (at, pair) in waypoints.windows(2).enumerate() {
            within(format!("obstacles[{index}].path.waypoints[{}][3]", at + 1), pair[1].1.heading - pair[0].1.heading);
        }
    }
}

/// Whether `next` could be the spring after `spring` in a ring.
fn continues_ring(spring: &PolarSpring, next: &PolarSpring) -> bool {
    let same = |of: fn(&PolarSpring) -> f64| of(spring) == of(next);
    same(|spring| spring.rest_length) && same(|spring| spring.radial_stiffness) && (0.0..=PI).contains(&(next.bearing - spring.bearing))
}

/// Speed of the load at the start, against the friction that stops it.
fn coast(scenario: &Scenario, findings: &mut Findings) {
    let (load, limit) = (&scenario.system.load, scenario.system.total_slip_limit());
    let speed = scenario.start.twist.linear.norm();
    let distance = load.mass * speed * speed / (2.0 * limit);
    if limit > 0.0 && distance > LONGEST_COAST * load.radius {
        let rule = format!("should be in m/s: friction should stop the load within {LONGEST_COAST} of its radii");
        findings.report("load.velocity_m_per_s", rule, format_args!("{} m/s, which takes {} m", short(speed), short(distance)));
    }
}

/// Speeds of the tips: within a control period a tip passes less than the load's diameter.
fn speeds(scenario: &Scenario, paths: &[TipPath], findings: &mut Findings) {
    let most = 2.0 * scenario.system.load.radius / scenario.control_period;
    for (index, path) in paths.iter().enumerate() {
        for (at, pair) in path.waypoints.windows(2).enumerate() {
            let duration = pair[1].time - pair[0].time;
            let speed = (pair[1].position - pair[0].position).norm() / duration;
            if duration >= FEWEST_PERIODS * scenario.control_period && speed > most {
                let rule = format!("should be reached at most at {} m/s, a diameter of the load per control period", short(most));
                findings.report(format_args!("drive.paths[{index}].waypoints[{}]", at + 1), rule, format_args!("{} m/s", short(speed)));
            }
        }
    }
}

fn ants(scenario: &Scenario, drive: &AntDrive, findings: &mut Findings) {
    let (period, radius) = (scenario.control_period, scenario.system.load.radius);
    for (key, speed) in [("search_speed_m_per_s", drive.search_speed), ("pull_speed_m_per_s", drive.pull_speed)] {
        let most = drive.sensing_range / period;
        if drive.sensing_range > 0.0 && speed > most {
            let rule = format!("should be at most {} m/s, the sensing range per control period", short(most));
            findings.report(format_args!("drive.{key}"), rule, format_args!("{} m/s", short(speed)));
        }
    }
    if drive.sensing_range > LONGEST_SENSING * radius {
        let rule = format!("should be at most {LONGEST_SENSING} radii of the load, {} m, and in metres", short(LONGEST_SENSING * radius));
        findings.report("drive.sensing_range_m", rule, format_args!("{} m", short(drive.sensing_range)));
    }
    let limit = scenario.system.total_slip_limit();
    if limit > 0.0 && drive.release.strong_pull > STRONGEST_PULL * limit {
        let rule = format!("should be in newtons, and at most {STRONGEST_PULL} slip limits, {} N", short(STRONGEST_PULL * limit));
        findings.report("drive.strong_pull_n", rule, format_args!("{} N", short(drive.release.strong_pull)));
    }
}
