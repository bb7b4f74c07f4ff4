//! Rules of the load: mass, inertia, outline and start.

use super::outline;
use crate::math::{Pose, Twist};
use crate::model::geometry::{AreaMoments, area_moments, overlap_of_parts};
use crate::model::{Load, Motion, Outline, OutlinePart};
use crate::scenario::error::{Findings, is_in_range, number};
use crate::scenario::format::LoadEntry;

/// Distance of the outline's centroid from the origin, over the extent, that counts as rounding of
/// the points in a file (1).
const CENTROID_SLACK: f64 = 1e-9;

/// The load as it was read. Numbers that do not follow from a wrong file are NaN.
pub struct CheckedLoad {
    pub load: Load,
    pub start: Motion,
    /// Outline; `None` where it breaks a rule.
    pub outline: Option<Outline>,
    /// Coefficient of side friction (1).
    pub side_friction: f64,
    /// Coefficient of restitution (1).
    pub restitution: f64,
}

pub fn load(entry: &LoadEntry, findings: &mut Findings) -> CheckedLoad {
    if let Some(mass) = entry.mass_kg {
        findings.positive("load.mass_kg", mass);
    }
    let outline = load_outline(entry, findings);
    findings.finite_vector("load.position_m", &entry.position_m);
    findings.finite("load.heading_rad", entry.heading_rad);
    findings.finite_vector("load.velocity_m_per_s", &entry.velocity_m_per_s);
    findings.finite("load.turn_rate_rad_per_s", entry.turn_rate_rad_per_s);
    findings.not_negative("load.side_friction_coefficient", entry.side_friction_coefficient);
    outline::restitution("load.restitution", entry.restitution, findings);
    let mass = mass(entry, outline.as_ref(), findings);
    let inertia = inertia(entry, mass, outline.as_ref(), findings);
    let radius = outline.as_ref().map_or(f64::NAN, Outline::extent);
    let pose = Pose { position: entry.position_m.into(), heading: entry.heading_rad };
    let twist = Twist { linear: entry.velocity_m_per_s.into(), angular: entry.turn_rate_rad_per_s };
    CheckedLoad {
        load: Load { mass, inertia, radius },
        start: Motion { pose, twist },
        outline,
        side_friction: entry.side_friction_coefficient,
        restitution: entry.restitution,
    }
}

/// The outline, or the disc of the short form; `None` where it breaks a rule.
fn load_outline(entry: &LoadEntry, findings: &mut Findings) -> Option<Outline> {
    match (entry.radius_m, &entry.outline) {
        (None, None) => findings.report("load.radius_m", "is required unless outline is given", "nothing"),
        (Some(_), Some(_)) => findings.report("load.outline", "must not be given together with radius_m", "both"),
        (Some(radius), None) => {
            let n_before = findings.0.len();
            findings.positive_size("load.radius_m", radius);
            return (findings.0.len() == n_before).then(|| Outline::disc(radius));
        }
        (None, Some(outline)) => return of_solid(outline::outline(outline, "load.outline", findings)?, findings),
    }
    None
}

/// The outline, unless it has walls without thickness or parts that overlap.
fn of_solid(outline: Outline, findings: &mut Findings) -> Option<Outline> {
    if outline.parts.iter().any(|part| matches!(part, OutlinePart::Polyline { .. })) {
        findings.report("load.outline", "must enclose an area: only obstacles have walls without thickness", "a polyline");
        return None;
    }
    let area = area_moments(&outline).area;
    if !area.is_normal() {
        findings.report("load.outline", "must have an area in the range of floating-point numbers", format_args!("{} m^2", number(area)));
        return None;
    }
    if let Some((one, other, depth)) = overlap_of_parts(&outline) {
        let rule = "must have parts that do not overlap, since the mass would count twice there";
        findings.report("load.outline", rule, format_args!("parts {one} and {other}, which overlap by {depth:.3e} m"));
        return None;
    }
    Some(outline)
}

/// Mass as given or from the density (kg).
fn mass(entry: &LoadEntry, outline: Option<&Outline>, findings: &mut Findings) -> f64 {
    let density = match (entry.mass_kg, entry.density_kg_per_m2) {
        (Some(mass), None) => return mass,
        (Some(mass), Some(_)) => {
            findings.report("load.density_kg_per_m2", "must not be given together with mass_kg", "both");
            return mass;
        }
        (None, None) => {
            findings.report("load.mass_kg", "is required unless density_kg_per_m2 is given", "nothing");
            return f64::NAN;
        }
        (None, Some(density)) => density,
    };
    findings.positive("load.density_kg_per_m2", density);
    let mass = outline.map_or(f64::NAN, |outline| density * area_moments(outline).area);
    if density > 0.0 && density.is_finite() && outline.is_some() && !(mass.is_normal() && mass.is_finite()) {
        let rule = "must give a mass in the range of floating-point numbers";
        findings.report("load.density_kg_per_m2", rule, format_args!("{} kg", number(mass)));
    }
    mass
}

/// Moment of inertia as given, or that of a mass (kg) spread uniformly over the outline (kg m^2).
fn inertia(entry: &LoadEntry, mass: f64, outline: Option<&Outline>, findings: &mut Findings) -> f64 {
    if let Some(given) = entry.inertia_kg_m2 {
        findings.positive("load.inertia_kg_m2", given);
        return given;
    }
    let Some(outline) = outline else { return f64::NAN };
    let inertia = match outline.centred_radius() {
        Some(radius) => 0.5 * mass * radius * radius,
        None => {
            let AreaMoments { area, second, .. } = area_moments(outline);
            require_centred("load.outline", outline, findings);
            mass * (second / area)
        }
    };
    // A wrong mass has its own finding; this is for a product that floats cannot hold.
    if mass > 0.0 && is_in_range(mass) && !(inertia > 0.0 && is_in_range(inertia)) {
        let rule = "must be given: m R^2 / 2 of this mass and radius is out of the range of floating-point numbers";
        findings.report("load.inertia_kg_m2", rule, "nothing");
    }
    inertia
}

/// Adds a finding unless the centroid of the outline is the origin of the load's frame, the centre
/// of mass. Returns whether it is.
pub fn require_centred(path: &str, outline: &Outline, findings: &mut Findings) -> bool {
    let centroid = area_moments(outline).centroid();
    let holds = centroid.norm() <= CENTROID_SLACK * outline.extent();
    if !holds {
        let rule = "must have its centroid at the origin, the centre of mass: subtract the centroid from all positions in the \
                    load's frame, or give mass_kg, inertia_kg_m2 and supports of a load that is not uniform";
        findings.report(path, rule, format_args!("the centroid [{}, {}]", number(centroid.x), number(centroid.y)));
    }
    holds
}
