//! Where the balance is lost: jumps after a grasp or a release, and snaps while tips move.

use super::QuasiStatic;
use crate::backend::StepReport;
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
        self.state.regime = regime;
        let end = &self.state.motion.pose;
        let way = (end.position - start.position).norm() + self.system.load.radius * (end.heading - start.heading).abs();
        if way > SMALLEST_JUMP * self.system.load.radius {
            let kind = self.book_jump(&start, defect);
            self.transitions.push(Transition { time: 0.0, kind });
        }
        report
    }

    /// Legs to a balance with the tips as they are.
    fn settle(&mut self) -> StepReport {
        self.gather();
        let mut report = StepReport::default();
        for _ in 0..MOST_LEGS {
            let before = self.state.motion.pose;
            report.add(&self.balance(None).0);
            if self.state.motion.pose == before {
                break;
            }
        }
        report
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
        allowed: impl FnOnce() -> f64,
        report: &mut StepReport,
    ) -> Option<TransitionKind> {
        let missing = defect - self.state.energy.defect();
        let rounding = SNAP_ROUNDING * (self.state.energy.tip_work.abs() + self.state.energy.dissipated() + self.state.energy.elastic);
        if missing <= rounding || self.state.motion.pose == *start || missing <= allowed() + rounding {
            return None;
        }
        let regime = self.state.regime;
        report.add(&StepReport { n_steps: 0, ..self.settle() });
        self.state.regime = regime;
        Some(self.book_jump(start, defect))
    }
}
