//! Numbers of a scene that sliders change.

use serde::Serialize;

use cohaul::model::SpringLaw;
use cohaul::scenario::{Drive, Scenario};

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    pub key: &'static str,
    pub name: &'static str,
    /// What changes with it.
    pub about: &'static str,
    pub unit: &'static str,
    pub value: f64,
    pub least: f64,
    pub most: f64,
    /// Whether the slider goes by equal factors.
    pub is_log: bool,
}

/// Ranges reach by this factor to either side of the scene as it was opened (1).
const REACH: f64 = 100.0;
/// The range of the speed (1): tips that leap hold no lesson.
const REACH_OF_SPEED: f64 = 10.0;

/// The parameters of a scene that was opened as `base` and whose drive is now `speed` times as
/// fast.
pub fn parameters(scenario: &Scenario, base: &Scenario, speed: f64) -> Vec<Parameter> {
    let by_factor = |key, about, unit, value, base: f64, reach: f64| Parameter {
        key,
        name: key,
        about,
        unit,
        value,
        least: base / reach,
        most: base * reach,
        is_log: true,
    };
    let [load, base_load] = [scenario, base].map(|of| &of.system.load);
    let about = "Mass and moment of inertia; the weight on the supports goes with it";
    let mass = by_factor("mass", about, "kg", load.mass, base_load.mass, REACH);
    let about = "Mass and moment of inertia at the same weight, over those of the scene as it was opened";
    let value = load.mass / weight(scenario) / (base_load.mass / weight(base));
    let inertia = by_factor("inertia", about, "", value, 1.0, REACH);
    let [value, usual] = [scenario, base].map(|of| of.system.ground.friction_coefficient);
    let (about, most) = ("Coefficient of friction with the ground", if usual > 0.0 { 3.0 * usual } else { 1.0 });
    let friction = Parameter { key: "friction", name: "friction", about, unit: "", value, least: 0.0, most, is_log: false };
    let mut found = vec![mass, inertia, friction];
    if let (Some(now), Some(stiffness)) = (mean_stiffness(scenario), mean_stiffness(base)) {
        let about = "Mean stiffness of the springs; all change by the same factor";
        found.push(by_factor("stiffness", about, "N/m", now, stiffness, REACH));
        let ratios: Vec<f64> =
            scenario.system.springs.iter().filter(|spring| spring.law == SpringLaw::Polar).map(|spring| spring.damping_ratio).collect();
        if !ratios.is_empty() {
            let (about, value) = ("Damping ratio of all springs; ropes have none", ratios.iter().sum::<f64>() / ratios.len() as f64);
            found.push(Parameter { key: "damping", name: "damping", about, unit: "", value, least: 0.0, most: 2.0, is_log: false });
        }
    }
    if is_driven(scenario) {
        let about = "Speed of tips, ants and pushers, over that of the scene as it was opened";
        found.push(Parameter { name: "drive speed", ..by_factor("speed", about, "×", speed, 1.0, REACH_OF_SPEED) });
    }
    found
}

/// Makes a change to a parameter; `speed` is that of the drive so far and becomes the new one.
///
/// # Errors
/// When there is no such parameter or the value is out of its range.
pub fn set(scenario: &mut Scenario, base: &Scenario, speed: &mut f64, key: &str, value: f64) -> Result<(), String> {
    let parameters = parameters(scenario, base, *speed);
    let found = parameters.iter().find(|parameter| parameter.key == key).ok_or_else(|| format!("no parameter {key:?}"))?;
    // The ends of a slider are rounded.
    let slack = 1e-6 * (found.most - found.least);
    if !(value >= found.least - slack && value <= found.most + slack) {
        return Err(format!("{key}: must be from {} to {}, found {value}", found.least, found.most));
    }
    let factor = value / found.value;
    let system = &mut scenario.system;
    match key {
        "mass" | "inertia" => {
            system.load.mass *= factor;
            system.load.inertia *= factor;
            if key == "mass" {
                system.ground.supports.iter_mut().for_each(|support| support.normal_load *= factor);
            }
        }
        "friction" => system.ground.friction_coefficient = value,
        "damping" => {
            system.springs.iter_mut().filter(|spring| spring.law == SpringLaw::Polar).for_each(|spring| spring.damping_ratio = value);
        }
        "stiffness" => system.springs.iter_mut().for_each(|spring| {
            spring.radial_stiffness *= factor;
            spring.torsional_stiffness *= factor;
        }),
        _ => {
            speed_up(scenario, factor);
            *speed = value;
        }
    }
    Ok(())
}

/// Makes tips, ants and pushers faster by a factor; prescribed motions end earlier.
fn speed_up(scenario: &mut Scenario, factor: f64) {
    match &mut scenario.drive {
        Drive::Ants(ants) => ants.pull_speed *= factor,
        Drive::Tips(paths) => {
            for path in paths {
                path.waypoints.iter_mut().for_each(|at| at.time /= factor);
                path.release = path.release.map(|time| time / factor);
            }
            scenario.duration /= factor;
        }
    }
    for obstacle in scenario.system.world.obstacles.iter_mut().filter(|obstacle| obstacle.path.moves()) {
        obstacle.path.waypoints.iter_mut().for_each(|(time, _)| *time /= factor);
    }
}

fn is_driven(scenario: &Scenario) -> bool {
    let has_tips = match &scenario.drive {
        Drive::Ants(_) => true,
        Drive::Tips(paths) => !paths.is_empty(),
    };
    has_tips || scenario.system.world.obstacles.iter().any(|obstacle| obstacle.path.moves())
}

/// Sum of the normal loads (N), or 1 for a load without weight.
fn weight(scenario: &Scenario) -> f64 {
    let sum: f64 = scenario.system.ground.supports.iter().map(|support| support.normal_load).sum();
    if sum > 0.0 { sum } else { 1.0 }
}

fn mean_stiffness(scenario: &Scenario) -> Option<f64> {
    let springs = &scenario.system.springs;
    let mean = springs.iter().map(|spring| spring.radial_stiffness).sum::<f64>() / springs.len() as f64;
    (mean > 0.0).then_some(mean)
}
