//! Oscillation of the load on its springs as attached at the largest jump.
//!
//! With the stiffness matrix K and the damping matrix C of the attached springs, the mass matrix M
//! and the direction d of the jump, Rayleigh's quotients give the rate and the damping ratio of the
//! oscillation that the jump excites:
//!
//! ```text
//! omega^2 = d.K d / d.M d    zeta = d.C d / (2 omega d.M d)
//! ```
//!
//! They are exact if d is a mode.

use super::numbers::mean_spring;
use super::solution::Solution;
use crate::backend::TransitionKind;
use crate::math::{Vec2, Vec3};
use crate::model::{PolarSpring, System};
use crate::scenario::Scenario;
use crate::simulation::Row;

/// The oscillation that a jump excites.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct JumpMode {
    /// Damping ratio (1).
    pub zeta: f64,
    /// Damping ratio of the oscillation if each spring had the ratio 1 (1).
    pub zeta_of_unit: f64,
}

impl JumpMode {
    /// Mode of the largest displacement of the quasi-static load within a control period with a
    /// grasp, a release or a jump; that of a mean spring without one.
    pub fn of(scenario: &Scenario, quasi_static: &Solution) -> Self {
        let mean = Self { zeta: mean_spring(scenario).1, zeta_of_unit: 1.0 };
        let (trace, radius) = (&quasi_static.trace, scenario.system.load.radius);
        let events = trace.events.iter().map(|event| event.time);
        let jumps = trace.transitions.iter().filter(|transition| matches!(transition.kind, TransitionKind::Jump { .. }));
        let length = |rows: &[Row]| rows[1].motion.pose.edge_displacement(&rows[0].motion.pose, radius);
        let at = |time: f64| {
            let next = trace.rows.partition_point(|row| row.time <= time).clamp(1, trace.rows.len() - 1);
            &trace.rows[next - 1..=next]
        };
        if trace.rows.len() < 2 {
            return mean;
        }
        let largest = events.chain(jumps.map(|jump| jump.time)).map(at).max_by(|a, b| length(a).total_cmp(&length(b)));
        largest.and_then(|rows| Self::along(scenario, [&rows[0], &rows[1]])).unwrap_or(mean)
    }

    /// Mode along the displacement between two rows, on the springs attached in the second.
    fn along(scenario: &Scenario, [before, after]: [&Row; 2]) -> Option<Self> {
        let (system, poses) = (&scenario.system, [before, after].map(|row| row.motion.pose));
        let shift = poses[1].position - poses[0].position;
        let step = Vec3::new(shift.x, shift.y, poses[1].heading - poses[0].heading);
        let mut sums = [0.0; 3];
        for tip in &after.tips {
            let spring = &system.springs[tip.spring];
            let of_spring = quadratic_forms(system, spring, after, tip.position, &step);
            sums = [0, 1, 2].map(|at| sums[at] + of_spring[at]);
        }
        let [stiffness, damping, unit_damping] = sums;
        let mass = system.load.mass * shift.norm_squared() + system.load.inertia * step.z * step.z;
        let rate = (stiffness / mass).sqrt();
        let ratio = |damping: f64| damping / (2.0 * rate * mass);
        let found = Self { zeta: ratio(damping), zeta_of_unit: ratio(unit_damping) };
        (rate > 0.0 && [found.zeta, found.zeta_of_unit].iter().all(|value| value.is_finite())).then_some(found)
    }
}

/// Contributions of a spring to d.K d, to d.C d, and to d.C d if its damping ratio were 1.
fn quadratic_forms(system: &System, spring: &PolarSpring, row: &Row, tip: Vec2, step: &Vec3) -> [f64; 3] {
    let pose = &row.motion.pose;
    let (root, arm) = (pose.to_world(&spring.root), pose.to_world(&spring.root) - pose.position);
    let moved = step.xy() + step.z * Vec2::new(-arm.y, arm.x);
    let (offset, length) = (tip - root, (tip - root).norm());
    // A spring without length and torsion is isotropic.
    let is_isotropic = spring.rest_length == 0.0 || length == 0.0;
    let along = if is_isotropic { moved.norm() } else { moved.dot(&offset) / length };
    let across_squared = if is_isotropic { 0.0 } else { (moved.norm_squared() - along * along).max(0.0) / (length * length) };
    let (radial, torsional) = spring.stiffness_at(length);
    let tension = spring.radial_pull(length).max(0.0) * length;
    let of_unit = PolarSpring { damping_ratio: 1.0, ..*spring };
    let form = |(radial, torsional): (f64, f64)| radial * along * along + torsional * across_squared;
    let stiffness = form((radial, torsional + tension));
    [stiffness, form(system.dashpot(spring)), form(system.dashpot(&of_unit))]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::compare::{Settings, ThreeWay};

    /// The release of one of two equal springs, aligned with the jump, leaves the load on the other
    /// one: its damping ratio and its rate are those of the load.
    #[test]
    fn a_release_excites_the_springs_that_are_left() {
        let mut scenario = Scenario::parse(include_str!("../../../scenarios/analytic/release-jump.json"), "a scene").unwrap();
        scenario.system.springs.iter_mut().for_each(|spring| spring.damping_ratio = 0.3);
        let found = ThreeWay::new(&scenario, &Settings::default()).prescribed(|_| true).unwrap();
        let mode = JumpMode::of(&scenario, &found.solutions[0]);
        // To the heading of the load, which does not turn.
        assert!((mode.zeta - 0.3).abs() < 1e-6 && (mode.zeta_of_unit - 1.0).abs() < 1e-6, "{mode:?}");
    }
}
