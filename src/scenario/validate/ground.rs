//! Rules of the ground: friction, supports and normal loads.

use super::load::{CheckedLoad, require_centred};
use super::shared::{MOST_IN_RING, bearings, polar};
use crate::math::Vec2;
use crate::model::support::normal_loads_of_three;
use crate::model::uniform_supports::uniform_supports;
use crate::model::{Ground, SupportPoint};
use crate::scenario::error::{Findings, is_in_range, number};
use crate::scenario::format::{GroundEntry, RingOfSupports, STANDARD_GRAVITY, SupportEntry, SupportsEntry, Tripod, UniformSupports};

/// Negative normal load over the weight that counts as rounding of offsets: the centre of mass is
/// then on the edge of the supports (1).
const TIPPING_SLACK: f64 = 1e-12;

/// Smallest number of supports of a uniform pressure (1): fewer do not resist every motion.
const LEAST_UNIFORM: usize = 3;
/// Largest number of supports of a uniform pressure (1). The error of friction is then far below
/// what is known of real pressures.
const MOST_UNIFORM: usize = 10_000;
/// Error of friction over that of the weight, times the number of supports (1). It is 1.73 at most
/// in the table of errors that the unit tests of `model/uniform_supports.rs` hold.
const ERROR_BY_SUPPORTS: f64 = 2.0;

/// Ground under a load, where that is known. Unknown normal loads are NaN.
pub fn ground(entry: &GroundEntry, load: Option<&CheckedLoad>, findings: &mut Findings) -> Ground {
    findings.not_negative("ground.friction_coefficient", entry.friction_coefficient);
    let gravity = entry.gravity_m_per_s2.unwrap_or(STANDARD_GRAVITY);
    findings.positive("ground.gravity_m_per_s2", gravity);
    let weight = weight(load.map(|load| load.load.mass), gravity, findings);
    let supports = match &entry.supports {
        SupportsEntry::Tripod(form) => tripod(&form.tripod, weight, findings),
        SupportsEntry::Ring(form) => ring(&form.ring, weight, findings),
        SupportsEntry::Uniform(form) => uniform(&form.uniform, load, weight, findings),
        SupportsEntry::List(list) => listed(list, weight, findings),
    };
    Ground { friction_coefficient: entry.friction_coefficient, supports }
}

/// Weight of a `mass` (kg) under `gravity` (m/s^2); `None` where one of them is out of range (N).
fn weight(mass: Option<f64>, gravity: f64, findings: &mut Findings) -> Option<f64> {
    let is_good = |value: f64| value > 0.0 && is_in_range(value);
    let weight = mass.filter(|mass| is_good(*mass) && is_good(gravity))? * gravity;
    // At least one of three supports carries a third or more, so that some normal load is above
    // zero then.
    let fits = (weight / 3.0).is_normal() && is_in_range(weight);
    if !fits {
        findings.report(
            "ground.gravity_m_per_s2",
            "must give a weight in the range of floating-point numbers",
            format_args!("{} N", number(weight)),
        );
    }
    fits.then_some(weight)
}

fn tripod(tripod: &Tripod, weight: Option<f64>, findings: &mut Findings) -> Vec<SupportPoint> {
    findings.positive_size("ground.supports.tripod.radius_m", tripod.radius_m);
    findings.finite("ground.supports.tripod.first_bearing_rad", tripod.first_bearing_rad);
    on_circle(3, tripod.radius_m, tripod.first_bearing_rad, third_of(weight))
}

fn ring(ring: &RingOfSupports, weight: Option<f64>, findings: &mut Findings) -> Vec<SupportPoint> {
    findings.not_negative("ground.supports.ring.radius_m", ring.radius_m);
    findings.finite("ground.supports.ring.first_bearing_rad", ring.first_bearing_rad);
    match ring.normal_load_n {
        Some(load) => findings.positive("ground.supports.ring.normal_load_n", load),
        None if ring.n != 3 => undetermined("ground.supports.ring.normal_load_n", ring.n, findings),
        None => findings.positive("ground.supports.ring.radius_m", ring.radius_m),
    }
    if !findings.count("ground.supports.ring.n", ring.n, MOST_IN_RING) {
        return Vec::new();
    }
    on_circle(ring.n, ring.radius_m, ring.first_bearing_rad, ring.normal_load_n.unwrap_or(third_of(weight)))
}

fn uniform(uniform: &UniformSupports, load: Option<&CheckedLoad>, weight: Option<f64>, findings: &mut Findings) -> Vec<SupportPoint> {
    let Some(n) = n_uniform(uniform, findings) else { return Vec::new() };
    let (Some(outline), Some(weight)) = (load.and_then(|load| load.outline.as_ref()), weight) else { return Vec::new() };
    // The same fault is found where the inertia follows from the outline.
    let is_known = findings.0.iter().any(|finding| finding.path == "load.outline");
    if is_known || !require_centred("load.outline", outline, findings) {
        return Vec::new();
    }
    uniform_supports(outline, n, weight)
}

/// Number of supports of a uniform pressure, as given or by the tolerance; `None` where a rule is
/// broken (1).
fn n_uniform(uniform: &UniformSupports, findings: &mut Findings) -> Option<usize> {
    let path = "ground.supports.uniform";
    match (uniform.n, uniform.tolerance) {
        (Some(n), None) if (LEAST_UNIFORM..=MOST_UNIFORM).contains(&n) => return Some(n),
        (Some(n), None) => findings.report(format!("{path}.n"), format!("must be from {LEAST_UNIFORM} to {MOST_UNIFORM}"), n),
        (None, Some(tolerance)) => {
            let [least, most] = [MOST_UNIFORM, LEAST_UNIFORM].map(|n| ERROR_BY_SUPPORTS / n as f64);
            if (least..=most).contains(&tolerance) {
                return Some(((ERROR_BY_SUPPORTS / tolerance).ceil() as usize).clamp(LEAST_UNIFORM, MOST_UNIFORM));
            }
            findings.report(format!("{path}.tolerance"), format!("must be from {least} to {most}"), number(tolerance));
        }
        (None, None) => findings.report(path, "must have n or tolerance", "neither"),
        (Some(_), Some(_)) => findings.report(path, "must have either n or tolerance", "both"),
    }
    None
}

fn on_circle(n: usize, radius: f64, first_bearing: f64, normal_load: f64) -> Vec<SupportPoint> {
    bearings(n, first_bearing)
        .map(|bearing| SupportPoint { offset: polar(radius, bearing), normal_load, friction_coefficient: None })
        .collect()
}

fn third_of(weight: Option<f64>) -> f64 {
    weight.unwrap_or(f64::NAN) / 3.0
}

fn listed(list: &[SupportEntry], weight: Option<f64>, findings: &mut Findings) -> Vec<SupportPoint> {
    if !findings.count("ground.supports", list.len(), MOST_IN_RING) {
        return Vec::new();
    }
    for (index, support) in list.iter().enumerate() {
        findings.finite_vector(format_args!("ground.supports[{index}].offset_m"), &support.offset_m);
        if let Some(friction) = support.friction_coefficient {
            findings.not_negative(format_args!("ground.supports[{index}].friction_coefficient"), friction);
        }
    }
    let offsets = list.iter().map(|support| Vec2::from(support.offset_m));
    let loads = normal_loads(list, weight, findings);
    let all = list.iter().zip(offsets.zip(loads));
    all.map(|(entry, (offset, normal_load))| SupportPoint { offset, normal_load, friction_coefficient: entry.friction_coefficient })
        .collect()
}

/// Normal load of each support, as given or from the centre of mass (N).
fn normal_loads(list: &[SupportEntry], weight: Option<f64>, findings: &mut Findings) -> Vec<f64> {
    let n_given = list.iter().filter(|support| support.normal_load_n.is_some()).count();
    if n_given == list.len() {
        return given_loads(list, findings);
    }
    if n_given > 0 {
        let rule = "must give normal_load_n on all supports or on none";
        findings.report("ground.supports", rule, format_args!("it on {n_given} of {}", list.len()));
    } else if list.len() != 3 {
        undetermined("ground.supports", list.len(), findings);
    } else if let Some(weight) = weight {
        let offsets = [0, 1, 2].map(|index| Vec2::from(list[index].offset_m));
        return loads_of_three(&offsets, weight, findings);
    }
    vec![f64::NAN; list.len()]
}

fn given_loads(list: &[SupportEntry], findings: &mut Findings) -> Vec<f64> {
    let loads: Vec<f64> = list.iter().filter_map(|support| support.normal_load_n).collect();
    for (index, load) in loads.iter().enumerate() {
        findings.not_negative(format_args!("ground.supports[{index}].normal_load_n"), *load);
    }
    if loads.iter().all(|load| *load == 0.0) {
        findings.report("ground.supports", "must have at least one positive normal load", "zero on every support");
    }
    loads
}

fn loads_of_three(offsets: &[Vec2; 3], weight: f64, findings: &mut Findings) -> Vec<f64> {
    if !offsets.iter().flatten().all(|value| value.is_finite()) {
        return vec![f64::NAN; 3];
    }
    let Some(loads) = normal_loads_of_three(offsets, weight) else {
        let rule = "must give normal_load_n or not lie on one line: the normal loads of such supports are undetermined";
        findings.report("ground.supports", rule, "three supports on one line");
        return vec![f64::NAN; 3];
    };
    for (index, load) in loads.iter().enumerate() {
        if !(*load >= -TIPPING_SLACK * weight && load.is_finite()) {
            let rule = "must not be negative: the centre of mass lies outside the supports, and the load would tip over";
            findings.require(false, format_args!("ground.supports[{index}].normal_load_n"), rule, *load);
        }
    }
    loads.map(|load| load.max(0.0)).to_vec()
}

fn undetermined(path: &str, n: usize, findings: &mut Findings) {
    let rule = "must give normal_load_n: only three supports have normal loads that follow from the centre of mass";
    findings.report(path, rule, format_args!("{n} support{} without", if n == 1 { "" } else { "s" }));
}
