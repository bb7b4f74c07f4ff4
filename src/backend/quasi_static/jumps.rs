//! Where the balance is lost: jumps after a grasp or a release, and snaps while tips move.

use super::QuasiStatic;
use crate::backend::StepReport;
use crate::backend::friction::EXACT;
use crate::backend::transition::{Transition, TransitionKind};
use crate::math::Pose;

/// Legs of one jump. Each is shorter than the last by orders of magnitude, and three are rarely needed.
const MOST_LEGS: u32 = 10;

/// Way of the rim in a jump, over the load's radius (1), below which it is the rounding of a load at the very edge of slipping.
const SMALLEST_JUMP: f64 = 1e-12;

/// Rounding of the energies of a run, of which the defect of a step is a difference (1).
const SNAP_ROUNDING: f64 = 1e-13;

impl QuasiStatic {
    /// Moves the load from where a grasp or a release has left it to the balance for tips that stand still. The friction of a long way depends on
    /// the way, here one constant twist; where that ends the load may have to go on, by far less, before it stays.
    // Apart from the steps, which come far more often and leave the processor no room for it.
    #[inline(never)]
    pub(super) fn jump(&mut self) -> StepReport {
        let (start, defect, regime) = (self.state.motion.pose, self.state.energy.defect(), self.state.regime);
        let report = self.settle();
        (self.state.regime, self.state.regime_is_known) = (regime, false);
        if self.way_from(&start) > SMALLEST_JUMP * self.system.load.radius {
            let kind = self.book_jump(&start, defect);
            self.transitions.push(Transition { time: 0.0, kind });
        }
        report
    }

    /// Legs to a balance with the tips as they are. Friction is wrong by the way that it was taken constant along, so that a leg goes with the square of the one before
    /// it: where two of them tell that the next would be none, it is not looked for.
    fn settle(&mut self) -> StepReport {
        self.gather();
        let no_way = self.no_way();
        let (mut report, mut last) = (StepReport::default(), None);
        for _ in 0..MOST_LEGS {
            let before = self.state.motion.pose;
            report.add(&self.balance(None));
            let way = self.way_from(&before);
            let next = last.map_or(way, |last: f64| way * (way / last).powi(2));
            if next <= no_way {
                break;
            }
            last = Some(way);
        }
        report
    }

    /// A way of the rim (m) that is rounding, of the pose and of the springs' pulls.
    fn no_way(&self) -> f64 {
        let Self { system, state, .. } = self;
        let pulls = EXACT * system.total_slip_limit() / state.held.largest_stiffness(&system.springs);
        (SMALLEST_JUMP * system.load.radius).min(pulls)
    }

    /// How far the rim has moved since the load was at `start` (m).
    fn way_from(&self, start: &Pose) -> f64 {
        let end = &self.state.motion.pose;
        (end.position - start.position).norm() + self.system.load.radius * (end.heading - start.heading).abs()
    }

    /// Books the jump that led from the pose `start` and this energy `defect` (J) to the present ones.
    fn book_jump(&mut self, start: &Pose, defect: f64) -> TransitionKind {
        let (pose, energy) = (&self.state.motion.pose, defect - self.state.energy.defect());
        self.state.energy.jumps += energy;
        TransitionKind::Jump { shift: (pose.position - start.position).norm(), turn: pose.heading - start.heading, energy }
    }

    /// Where the springs' energy is no longer convex the balance ends, and the load snaps to another one while the tips move. More energy is then missing
    /// since the pose `start` with this energy `defect` (J) than the trapezoid sum of a smooth path can be off by, which is `allowed` (J).
    pub(super) fn snap(
        &mut self,
        start: &Pose,
        defect: f64,
        allowed: impl FnOnce(&Self) -> f64,
        report: &mut StepReport,
    ) -> Option<TransitionKind> {
        let missing = defect - self.state.energy.defect();
        let rounding = SNAP_ROUNDING * (self.state.energy.tip_work.abs() + self.state.energy.dissipated() + self.state.energy.elastic);
        if missing <= rounding || self.state.motion.pose == *start || missing <= allowed(self) + rounding {
            return None;
        }
        let regime = self.state.regime;
        report.add(&StepReport { n_steps: 0, ..self.settle() });
        self.state.regime = regime;
        Some(self.book_jump(start, defect))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::{Backend, Skips, Stepping};
    use crate::math::{RandomStreams, Stream, Vec2};
    use crate::scenario::Scenario;

    /// Legs that a jump leaves out lead nowhere: further ones stay within what counts as no way, and rounding. Soft springs and stiff ones, short jumps
    /// and long.
    #[test]
    fn a_jump_ends_where_no_leg_leads_on() {
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
            let mut backend = QuasiStatic::new(system.clone(), start, Stepping::Fixed(f64::INFINITY), Skips::ALL);
            for (spring, polar) in system.springs.iter().enumerate().take(3) {
                let [u, v] = streams.uniform_pair(Stream::Scene, spring as u32, 2);
                backend.attach(spring, start.pose.to_world(&polar.rest_tip()) + reach * Vec2::new(2.0 * u - 1.0, 2.0 * v - 1.0));
            }
            backend.jump();
            let end = backend.state.motion.pose;
            let way = backend.way_from(&start.pose);
            let mut last = end;
            for _ in 0..MOST_LEGS {
                last = backend.state.motion.pose;
                backend.balance(None);
            }
            // Rounding of where tips are.
            let (rounding, further) = (4.0 * f64::EPSILON * (system.load.radius + system.springs[0].rest_length), backend.way_from(&end));
            assert!(further <= 2.0 * backend.no_way() + rounding, "{case}: {further:e} after {way:e}");
            n_jumps += u32::from(way > 0.0);
            n_cut += u32::from(last != end);
        }
        assert!(n_jumps > 100 && n_cut > 0, "{n_jumps} {n_cut}");
    }
}
