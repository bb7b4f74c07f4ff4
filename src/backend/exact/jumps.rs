//! Jumps of a load without inertia: after an attached or released spring, and snap-throughs while
//! tips move.

use super::contact::GroundContact;
use super::load::{Exact, SnapStart};
use super::quasi_static::QuasiStatic;
use crate::backend::numerics::{EXACT, JUMP_ENERGY_ROUNDING, JUMP_ITERATIONS, JUMP_ROUNDING, ROUNDED_PLACE, SMALLEST_JUMP};
use crate::backend::report::{Status, StepReport, Transition, TransitionKind};
use crate::math::Pose;
use crate::stop;

impl Exact<QuasiStatic> {
    /// Moves the load from where an attached or released spring has left it to the balance for tips
    /// that stand still. The friction of a long path depends on the path, here one constant twist.
    /// The load may have to go on from its end, by far less, before it stays.
    // A function of its own: steps come far more often and need the registers.
    #[inline(never)]
    pub(super) fn jump(&mut self) -> StepReport {
        let (start, last) = (self.state.snap_start(), self.state.contact.last());
        let touching = self.obstacles.is_some().then(|| self.state.side.touching.clone());
        let (report, has_path) = self.settle();
        self.state.contact = GroundContact::Unknown { last, jump_is_pending: false };
        if self.is_far_from(&start.pose) {
            let kind = self.book_jump(&start, has_path);
            self.transitions.push(Transition { time: 0.0, kind });
        }
        if let Some(touching) = touching {
            self.note_contacts(&touching, 0.0);
        }
        report
    }

    /// Iterates to a balance with the tips as they are. Each iteration takes friction as constant
    /// along its path, so that its length goes with the square of the one before. The next one is
    /// left out where two of them predict that it would be none. The last one tells whether the
    /// load is in balance. Returns also whether all of them found where they lead: one halts where
    /// a spring has swung by half a turn, from where the next goes on.
    pub(super) fn settle(&mut self) -> (StepReport, bool) {
        self.catch_up();
        self.springs.refresh(&self.system.springs, &self.state.motion.pose);
        self.set_rigid_dashpots();
        let rounding = self.displacement_rounding();
        let (mut report, mut found, mut last) = (StepReport::default(), StepReport::default(), None);
        for _ in 0..JUMP_ITERATIONS {
            stop::point();
            let before = self.state.motion.pose;
            found = self.balance(None, [self.state.side.now; 2]);
            report.add(&found);
            let length = self.edge_displacement(&before);
            let next = last.map_or(length, |last: f64| length * (length / last).powi(2));
            if next <= rounding {
                break;
            }
            last = Some(length);
        }
        let has_path = report.status == Status::Converged;
        let StepReport { status, residual, n_not_converged, .. } = found;
        (StepReport { status, residual, n_not_converged, ..report }, has_path)
    }

    /// Edge displacement (m) that is rounding of the pose and of the pulls.
    fn displacement_rounding(&self) -> f64 {
        let Self { system, springs, .. } = self;
        let pulls = EXACT * system.total_slip_limit() / springs.largest_stiffness(&system.springs);
        (JUMP_ROUNDING * system.load.radius).min(pulls)
    }

    /// Edge displacement since the load was at `start` (m).
    pub(super) fn edge_displacement(&self, start: &Pose) -> f64 {
        self.state.motion.pose.edge_displacement(start, self.system.load.radius)
    }

    /// Whether the load is farther from `start` than rounding of a load that jumps.
    pub(super) fn is_far_from(&self, start: &Pose) -> bool {
        self.edge_displacement(start) > SMALLEST_JUMP * self.system.load.radius
    }

    /// Adds the jump from `start` to the ledger.
    fn book_jump(&mut self, start: &SnapStart, has_path: bool) -> TransitionKind {
        let is_uncertain = !has_path || self.is_uncertain_from(start);
        let (pose, energy) = (&self.state.motion.pose, start.defect - self.state.energy.defect());
        self.state.energy.jumps += energy;
        let shift = (pose.position - start.pose.position).norm();
        TransitionKind::Jump { shift, turn: pose.heading - start.pose.heading, energy, is_uncertain }
    }

    /// Energy that the last step may have mistaken at obstacles (J), whose work is a force along a
    /// difference of places.
    fn uncertainty_at_obstacles(&self) -> f64 {
        if self.obstacles.is_none() {
            return 0.0;
        }
        let distance = self.state.motion.pose.position.norm() + self.system.load.radius;
        self.state.side.uncertainty + ROUNDED_PLACE * distance * self.system.total_slip_limit()
    }

    /// Completes a snap-through. The balance ends where the energy of the springs is no longer
    /// convex, and the load moves to another balance while the tips move. The energy that is
    /// missing since `start` is more than the error of the trapezoid rule on a smooth path: of the
    /// tips, `allowed` (J), and of the obstacles.
    pub(super) fn snap_through(
        &mut self,
        start: &SnapStart,
        allowed: impl FnOnce(&Self) -> f64,
        report: &mut StepReport,
    ) -> Option<TransitionKind> {
        let energy = &self.state.energy;
        let missing = start.defect - energy.defect();
        let rounding =
            JUMP_ENERGY_ROUNDING * (energy.tip_work.abs() + energy.dissipated() + energy.elastic) + self.uncertainty_at_obstacles();
        if missing < -rounding {
            report.work_error_j += allowed(self).min(-missing);
            return None;
        }
        let lost = self.lost_without_jump();
        if missing <= rounding || self.state.motion.pose == start.pose || missing <= allowed(self) + lost.unwrap_or(0.0) + rounding {
            return None;
        }
        if lost.is_none() {
            self.account_for_relaxation(missing);
            return None;
        }
        let contact = self.state.contact;
        let (found, has_path) = self.settle();
        report.add(&StepReport { n_steps: 0, ..found });
        self.state.contact = contact;
        self.is_far_from(&start.pose).then(|| self.book_jump(start, has_path))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::{Backend, Skips, Stepping};
    use crate::math::{RandomStreams, Stream, Vec2};
    use crate::scenario::Scenario;

    /// Iterations that a jump leaves out lead nowhere: further ones stay within rounding, for soft
    /// and stiff springs and for short and long jumps.
    #[test]
    fn a_jump_ends_where_no_iteration_leads_on() {
        let text = include_str!("../../../scenarios/paper/four-ants-four-springs.json");
        let Scenario { system, start, .. } = Scenario::parse(text, "four ants").unwrap();
        let (mut n_jumps, mut n_cut) = (0, 0);
        for case in 0..300 {
            let (streams, mut system) = (RandomStreams::new(case), system.clone());
            let stiffer = 10f64.powf(4.0 * streams.uniform(Stream::Scene, 0, 0));
            for spring in &mut system.springs {
                spring.radial_stiffness *= stiffer;
                spring.torsional_stiffness *= stiffer;
            }
            let reach = 0.5 * 10f64.powf(-2.0 * streams.uniform(Stream::Scene, 0, 1)) * system.springs[0].rest_length;
            let mut backend = Exact::quasi_static(&system, start, Stepping::Fixed(f64::INFINITY), Skips::ALL);
            for (spring, polar) in system.springs.iter().enumerate().take(3) {
                let [u, v] = streams.uniform_pair(Stream::Scene, spring as u32, 2);
                backend.attach(spring, start.pose.to_world(&polar.rest_tip()) + reach * Vec2::new(2.0 * u - 1.0, 2.0 * v - 1.0));
            }
            backend.jump();
            let end = backend.state.motion.pose;
            let length = backend.edge_displacement(&start.pose);
            let mut last = end;
            for _ in 0..JUMP_ITERATIONS {
                last = backend.state.motion.pose;
                backend.balance(None, [0.0; 2]);
            }
            // Rounding of where tips are.
            let (rounding, further) =
                (4.0 * f64::EPSILON * (system.load.radius + system.springs[0].rest_length), backend.edge_displacement(&end));
            assert!(further <= 2.0 * backend.displacement_rounding() + rounding, "{case}: {further:e} after {length:e}");
            n_jumps += u32::from(length > 0.0);
            n_cut += u32::from(last != end);
        }
        assert!(n_jumps > 100 && n_cut > 0, "{n_jumps} {n_cut}");
    }
}
