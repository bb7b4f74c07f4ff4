//! Rules of the springs, and the springs of rings.

use std::fmt::Display;

use super::shared::{MOST_IN_RING, bearings, polar};
use crate::model::{PolarSpring, SpringLaw};
use crate::scenario::error::{Findings, number};
use crate::scenario::format::{RingOfSprings, SpringEntry, SpringsEntry};

/// All springs in order; those of a ring follow at its place.
pub fn springs(entries: &[SpringsEntry], findings: &mut Findings) -> Vec<PolarSpring> {
    let n_springs = n_springs(entries);
    let mut springs = Vec::new();
    let fits = n_springs <= MOST_IN_RING;
    // A ring that is too large by itself says so at its own place.
    if !fits && entries.iter().all(|entry| n_springs_of(entry) <= MOST_IN_RING) {
        findings.report("springs", format!("must be at most {MOST_IN_RING} in all"), n_springs);
    }
    for (index, entry) in entries.iter().enumerate() {
        match entry {
            SpringsEntry::One(entry) => springs.push(one(entry, index, findings)),
            SpringsEntry::Ring(form) => springs.extend(ring(&form.ring, index, findings).filter(|_| fits)),
        }
    }
    springs
}

/// Number of springs of the entries, with those of rings (1).
pub fn n_springs(entries: &[SpringsEntry]) -> usize {
    entries.iter().map(n_springs_of).fold(0, usize::saturating_add)
}

fn n_springs_of(entry: &SpringsEntry) -> usize {
    match entry {
        SpringsEntry::One(_) => 1,
        SpringsEntry::Ring(form) => form.ring.n,
    }
}

fn one(entry: &SpringEntry, index: usize, findings: &mut Findings) -> PolarSpring {
    let place = format!("springs[{index}]");
    findings.finite_vector(format_args!("{place}.root_m"), &entry.root_m);
    findings.finite(format_args!("{place}.bearing_rad"), entry.bearing_rad);
    let spring = entry.spring();
    check_law(&place, &spring, findings);
    spring
}

/// Springs of a ring; none when their number is out of range.
fn ring(ring: &RingOfSprings, index: usize, findings: &mut Findings) -> impl Iterator<Item = PolarSpring> + use<> {
    let place = format!("springs[{index}].ring");
    findings.not_negative(format_args!("{place}.radius_m"), ring.radius_m);
    findings.finite(format_args!("{place}.first_bearing_rad"), ring.first_bearing_rad);
    let first = PolarSpring {
        root: polar(ring.radius_m, ring.first_bearing_rad),
        bearing: ring.first_bearing_rad,
        rest_length: ring.rest_length_m,
        radial_stiffness: ring.radial_stiffness_n_per_m,
        torsional_stiffness: ring.torsional_stiffness_nm_per_rad,
        damping_ratio: ring.damping_ratio,
        law: ring.law,
    };
    check_law(&place, &first, findings);
    let n = if findings.count(format_args!("{place}.n"), ring.n, MOST_IN_RING) { ring.n } else { 0 };
    let radius = ring.radius_m;
    bearings(n, first.bearing).map(move |bearing| PolarSpring { root: polar(radius, bearing), bearing, ..first })
}

/// Checks the rules of the spring law, for a single spring or a ring.
fn check_law(place: &impl Display, spring: &PolarSpring, findings: &mut Findings) {
    let key = |name: &str| format!("{place}.{name}");
    let (radial, torsional) = (spring.radial_stiffness, spring.torsional_stiffness);
    match spring.rest_length {
        0.0 => {}
        length if length > 0.0 => findings.positive_size(key("rest_length_m"), length),
        length => findings.not_negative(key("rest_length_m"), length),
    }
    findings.not_negative(key("radial_stiffness_n_per_m"), radial);
    findings.not_negative(key("torsional_stiffness_nm_per_rad"), torsional);
    findings.not_negative(key("damping_ratio"), spring.damping_ratio);
    if radial == 0.0 && torsional == 0.0 {
        findings.report(key("radial_stiffness_n_per_m"), "must be positive where the torsional stiffness is zero", number(radial));
    }
    if torsional > 0.0 && spring.rest_length == 0.0 {
        let rule = "must be positive for a spring with torsional stiffness: a spring without length has no direction";
        findings.report(key("rest_length_m"), rule, number(spring.rest_length));
    }
    if spring.law == SpringLaw::Rope {
        for (name, value) in [("torsional_stiffness_nm_per_rad", torsional), ("damping_ratio", spring.damping_ratio)] {
            if value > 0.0 {
                findings.report(key(name), "must be zero for a rope, which only pulls", number(value));
            }
        }
    }
    if spring.damping_ratio > 0.0 && radial == 0.0 {
        let rule = "must be zero where the radial stiffness is zero: critical damping is that of the radial stiffness";
        findings.report(key("damping_ratio"), rule, number(spring.damping_ratio));
    }
}
