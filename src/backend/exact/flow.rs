//! Where a jump ends if its path bends.
//!
//! Friction alone does not say where a jump leads: whatever else dissipates decides its path. The
//! load is taken as the limit without mass of a load on damped springs whose dashpots are in
//! proportion to the springs, radial and torsional: all springs relax in the same time. Its path
//! obeys
//!
//! ```text
//! M(q) v + sum_i B_i' f_i = w(q)        M: dashpots, w: wrench of the springs
//! ```
//!
//! One minimisation along a constant twist is the same as one implicit step of this flow, of
//! infinite length. It leads to the same place as long as the path is straight: as long as what the
//! springs pull more than friction resists is in line with the drag of the dashpots.

use super::dashpots::Dashpots;
use super::load::{Exact, SnapStart};
use super::quasi_static::QuasiStatic;
use crate::backend::increment::{Increment, Potential, minimise};
use crate::backend::springs::{Attachment, Attachments, Place};
use crate::backend::{Status, StepReport};
use crate::math::{Arc, Pose, Vec2, Vec3, increment_of, rotation};
use crate::model::support::{slip_velocity, wrench_of};
use crate::model::{Ground, PolarSpring};

/// Share of the forces out of line up to which the end of a jump is certain: to 1 % of its length
/// on a thousand random jumps (1).
const CERTAIN: f64 = 0.005;
/// Share from which on the load follows the flow (1). Below, its end differs by some percent.
const FOLLOWED: f64 = 0.1;
/// Shares of the path at which forces are compared (1).
const SHARES: [f64; 3] = [0.0, 0.5, 0.9];
/// Edge displacement over the load's radius below which a path has no room to bend (1).
const SHORTEST: f64 = 1e-9;
/// Slip of a support over that of the fastest one below which it sticks (1).
const HELD: f64 = 1e-9;
/// Steps of the flow over the displacement (1), for an error of some thousandths.
const N_PARTS: f64 = 64.0;
/// Largest number of steps. Nearly all jumps need less than 300.
const MOST_STEPS: u32 = 2000;
/// Dashpots over springs below which one step reaches the balance (1).
const WEAKEST: f64 = 1e-3;

impl Exact<QuasiStatic> {
    /// Moves a load that the rule of constant twist has taken from `start` to a balance, as the
    /// report of the `rule` says, to where the flow leads, if its path bends by much. At the start
    /// the springs were attached as `then`. Returns the report of what was kept, and whether the
    /// end depends on the dissipation.
    #[inline(never)]
    pub(super) fn follow_flow(&mut self, start: &SnapStart, then: &[Attachment], rule: StepReport) -> (StepReport, bool) {
        let (length, end) = (self.edge_displacement(&start.pose), self.state.motion.pose);
        let departure = self.departure_from_flow(&start.pose, &rule);
        if departure <= FOLLOWED {
            return (rule, departure > CERTAIN);
        }
        let settled = self.snapshot();
        self.set_back(start, then);
        let flow = self.creep_for(length);
        if flow.status != Status::Converged {
            self.reset(&settled);
            self.springs.refresh(&self.system.springs, &end);
        }
        let (mut kept, left) = if flow.status == Status::Converged { (flow, rule) } else { (rule, flow) };
        kept.add(&left.work());
        (kept, true)
    }

    /// Share of the forces that would lead the load from `start` elsewhere than to where the `rule`
    /// has taken it (1). Infinite where that is no balance, or not on the way of any flow.
    fn departure_from_flow(&self, start: &Pose, rule: &StepReport) -> f64 {
        let is_long = self.edge_displacement(start) > SHORTEST * self.system.load.radius;
        if self.obstacles.is_some() || self.springs.is_empty() || self.solver.accuracy() > 0.0 || !is_long {
            return 0.0;
        }
        if rule.status != Status::Converged {
            return f64::INFINITY;
        }
        let end = self.state.motion.pose;
        let twist = increment_of(&rotation(start.heading), &(end.position - start.position), end.heading - start.heading);
        self.out_of_line(start, &twist)
    }

    /// Whether the end of a snap-through depends on the dissipation. It is not followed: the load
    /// had already moved when the tips came to where they are.
    pub(super) fn is_uncertain_from(&self, start: &Pose, rule: &StepReport) -> bool {
        self.departure_from_flow(start, rule) > CERTAIN
    }

    /// Largest share of the forces that is out of line with a path of constant twist from `start`
    /// (1). Infinite where a support that sticks on the path would slip.
    fn out_of_line(&self, start: &Pose, twist: &Vec3) -> f64 {
        let Self { system, springs, .. } = self;
        let radius = system.load.radius;
        let units = Vec3::new(radius, radius, 1.0);
        let (friction, pin) = full_friction(&system.ground, twist);
        let at = |share: f64| {
            let arc = Arc::of(share * twist.z);
            let place = Place::of(start).moved(&(share * twist.xy()), &arc);
            let pull = -springs.reaction(&system.springs, &place.pose).gradient;
            let pull = rotation(place.pose.heading).tr_mul(&pull.xy()).push(pull.z);
            let mut dashpots = Dashpots::default();
            dashpots.renew_as(system, springs, &place.pose, in_proportion(1.0));
            let Some(blocks) = dashpots.blocks() else { return 0.0 };
            blocks.start(&place);
            let drag = (blocks.reaction(&place).hessian * twist).component_mul(&units);
            let left = (pull - friction).component_mul(&units);
            let Some((offset, limit)) = pin else {
                let across = left - left.dot(&drag) / drag.norm_squared() * drag;
                return across.norm() / (left.norm() + system.total_slip_limit() * radius);
            };
            // The moment about the support sets the speed, and the support bears what is left.
            let about = Vec3::new(offset.y, -offset.x, 1.0).component_div(&units);
            let on_support = left - left.dot(&about) / drag.dot(&about) * drag;
            if on_support.xy().norm() <= limit * radius { 0.0 } else { f64::INFINITY }
        };
        SHARES.into_iter().map(at).fold(0.0, f64::max)
    }

    /// Moves the load along the flow to its balance, in steps of a small part of `length` (m).
    fn creep_for(&mut self, length: f64) -> StepReport {
        let longest = length / N_PARTS;
        let (mut drag, mut report) = (1.0, StepReport::default());
        for _ in 0..MOST_STEPS {
            let increment = self.creep(drag);
            report.add(&StepReport { n_steps: 0, ..increment.report });
            let size = increment.twist.xy().norm() + self.system.load.radius * increment.twist.z.abs();
            // Steps that follow a snap-through of the flow itself are long at any drag.
            if size > 1.5 * longest && drag < 1e9 {
                drag *= 2.0;
                continue;
            }
            let taken = self.accept(increment, None);
            if taken.status == Status::Failed || drag < WEAKEST {
                break;
            }
            if size < 0.75 * longest {
                drag *= 0.5;
            }
        }
        report.add(&self.settle());
        report
    }

    /// Implicit step of the flow from where the load is, with dashpots as springs of the stiffness
    /// `drag` times that of the springs (1).
    fn creep(&mut self, drag: f64) -> Increment {
        let start = *self.springs.place();
        let Self { springs, system, solver, .. } = self;
        let mut dashpots = Dashpots::default();
        dashpots.renew_as(system, springs, &start.pose, in_proportion(drag));
        let mut blocks = dashpots.blocks();
        if let Some(blocks) = &mut blocks {
            blocks.start(&start);
        }
        let potential = Potential { dashpots: blocks, ..Potential::of(springs.blocks(), start) };
        minimise(potential, &system.ground, solver, system.load.radius, None)
    }

    /// Puts the load back to where it was at the `start`, with the tips where they are. The springs
    /// get the swings that they had `then`: on the way of a jump they may turn by more than half a
    /// turn, and no pose tells how they turn back.
    fn set_back(&mut self, start: &SnapStart, then: &[Attachment]) {
        let mut attachments = Attachments::clone(&self.springs);
        for (attachment, then) in attachments.as_mut_slice().iter_mut().zip(then) {
            attachment.swing = then.swing;
        }
        self.springs.reset(attachments);
        self.springs.refresh(&self.system.springs, &start.pose);
        let accepted = self.springs.accept(&start.pose);
        let state = &mut self.state;
        (state.energy.elastic, state.energy.friction, state.motion.pose) = (accepted.elastic, start.friction, start.pose);
        state.certificate.forget();
    }
}

/// Stiffness of dashpots as springs in proportion to the springs (N/m, N m/rad).
fn in_proportion(share: f64) -> impl Fn(&PolarSpring) -> (f64, f64) {
    move |spring| (share * spring.radial_stiffness, share * spring.torsional_stiffness)
}

/// Friction on all supports that slip with this twist, at its limits (N, N, N m; load axes), and
/// offset (m) and limit (N) of the one that does not.
fn full_friction(ground: &Ground, twist: &Vec3) -> (Vec3, Option<(Vec2, f64)>) {
    let of = |offset: &Vec2| slip_velocity(offset, twist);
    let fastest = ground.supports.iter().map(|support| of(&support.offset).norm()).fold(0.0, f64::max);
    let (mut sum, mut pin) = (Vec3::zeros(), None);
    for (support, limit) in ground.supports.iter().zip(ground.slip_limits()).filter(|(_, limit)| *limit > 0.0) {
        let slip = of(&support.offset);
        if slip.norm() <= HELD * fastest {
            pin = Some((support.offset, limit));
        } else {
            sum += wrench_of(&support.offset, &(limit * slip.normalize()));
        }
    }
    (sum, pin)
}
