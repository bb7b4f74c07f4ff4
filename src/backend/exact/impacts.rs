//! Steps with inertia among obstacles.
//!
//! While the load touches nothing it moves as without obstacles. A step in which it would pass
//! through one ends where it touches: the instant is located to rounding, and the impact law of
//! `contact::impact` changes the velocity there.
//!
//! Steps of a load that touches an obstacle are those of implicit Euler with the conditions of
//! contact at their end. One whole step and two halves are extrapolated to second order where the
//! contact modes are the same, and go on by backward differences (`touching`).

use super::inertial::{Inertial, Memory};
use super::load::{Exact, Snapshot};
use super::one_step::Integrator;
use super::side::Impact;
use crate::backend::contact::{Reflection, Scope, SpeedLimits, Strike, Touching};
use crate::backend::numerics::{
    EARLIER_TOUCHES, LEAST_FALL, LOCATED_GAP, LOCATING_ATTEMPTS, LOCATING_NEWTON_ATTEMPTS, MOST_TOUCHES, NEGLIGIBLE_BOUNCE, ROUNDED_GAP,
    STANDSTILL, STEP_HALVINGS, STEP_ITERATIONS, TOUCHED_GAP,
};
use crate::backend::report::{ImpactLaw, Motion, Status, StepReport};
use crate::backend::springs::TipPaths;
use crate::backend::stepping::Stepping;
use crate::math::{Twist, Vec2, Vec3, rotation};
use crate::model::support::wrench_of;
use crate::stop;

/// What an impact without a law adds to a report.
pub(super) fn without_law() -> StepReport {
    StepReport { status: Status::NotConverged, n_not_converged: 1, ..StepReport::default() }
}

impl Exact<Inertial> {
    /// Takes a step among obstacles. It is divided at waypoints of obstacles.
    pub(super) fn step_among_obstacles(&mut self, paths: &TipPaths, from: f64, to: f64) -> StepReport {
        let mut report = StepReport::default();
        let (mut at, mut n_touches) = (from, 0);
        while at < to {
            stop::point();
            let until = self.until_waypoint(paths, [at, to]);
            report.add(&self.meet_waypoint([at, until].map(|share| self.time_at(paths, share))));
            if n_touches >= MOST_TOUCHES || report.n_iterations >= STEP_ITERATIONS {
                report.add(&self.step_touching(paths, [at, until], Scope::Near));
                at = until;
                continue;
            }
            let (next, part) = self.move_to_touch(paths, [at, until]);
            report.add(&part);
            if part.status == Status::Failed {
                break;
            }
            n_touches += if next > at { 1 } else { STANDSTILL };
            at = next;
        }
        StepReport { n_steps: 1, ..report }
    }

    /// Moves the load up to the next touch, or to the end. Returns the share of the paths there.
    fn move_to_touch(&mut self, paths: &TipPaths, [from, to]: [f64; 2]) -> (f64, StepReport) {
        let start = self.snapshot();
        let (to, mut report) = self.move_as_far_as_solved(paths, [from, to], &start);
        let times = [from, to].map(|share| self.time_at(paths, share));
        let Some(mut found) = self.strikes(&start.state, times, &[]) else { return (to, report) };
        if report.status == Status::Failed {
            return (to, report);
        }
        let mut end = to;
        for _ in 0..EARLIER_TOUCHES {
            let (strikes, share) = found;
            end = self.locate(&strikes, paths, [from, from + share * (end - from)], &start, &mut report);
            let time = self.time_at(paths, end);
            self.state.side.n_divided += usize::from(end < to);
            let Some(earlier) = self.strikes(&start.state, [times[0], time], &self.located(&strikes, time)) else {
                let limits = self.speed_limits(self.change_since(&start.state.motion), [time - times[0], times[1] - times[0]]);
                if self.strike(&strikes, limits, time) != Some(ImpactLaw::None) {
                    return (end, report);
                }
                report.add(&without_law());
                if end < to {
                    report.add(&self.step_touching(paths, [end, to], Scope::Near));
                }
                return (to, report);
            };
            found = earlier;
        }
        self.reset(&start);
        report.add(&self.step_touching(paths, [from, to], Scope::Near));
        (to, report)
    }

    /// Those of these features that touch now.
    fn located(&self, strikes: &[Strike], time: f64) -> Vec<Strike> {
        let closed = TOUCHED_GAP * self.system.load.radius;
        strikes.iter().filter(|strike| self.nearest(std::slice::from_ref(strike), time).0.abs() <= closed).copied().collect()
    }

    /// Moves the load from the `start` to where it touches by these features, at the latest at the
    /// end of this part of the paths, and returns the share there. Where its motion jumps with the
    /// length of the part, as between contact modes, it stays before the touch.
    fn locate(
        &mut self,
        strikes: &[Strike],
        paths: &TipPaths,
        [from, to]: [f64; 2],
        start: &Snapshot<Memory>,
        report: &mut StepReport,
    ) -> f64 {
        let (mut free, mut hit, mut end) = (from, to, to);
        for attempt in 0..LOCATING_ATTEMPTS {
            stop::point();
            self.reset(start);
            if end <= from {
                break;
            }
            let part = self.move_on(paths, [from, end], start);
            report.n_solves += part.n_solves;
            report.n_iterations += part.n_iterations;
            report.status = report.status.max(part.status);
            if part.status != Status::Converged && report.n_iterations >= STEP_ITERATIONS {
                break;
            }
            let (gap, speed) = self.nearest(strikes, self.time_at(paths, end));
            if gap.abs() <= LOCATED_GAP * self.system.load.radius || end == free {
                break;
            }
            if hit - free <= 2.0 * f64::EPSILON * hit {
                end = free;
                continue;
            }
            *(if gap > 0.0 { &mut free } else { &mut hit }) = end;
            let newton = end - gap / (speed * paths.duration);
            let is_between = newton > free && newton < hit;
            end = if attempt < LOCATING_NEWTON_ATTEMPTS && is_between { newton } else { 0.5 * (free + hit) };
        }
        end
    }

    /// Moves the load on, for a shorter time where the whole one has no answer. Returns the share
    /// of the paths there.
    fn move_as_far_as_solved(&mut self, paths: &TipPaths, [from, to]: [f64; 2], start: &Snapshot<Memory>) -> (f64, StepReport) {
        let whole = self.move_on(paths, [from, to], start);
        let (mut end, mut report) = (to, whole);
        for _ in 0..STEP_HALVINGS {
            stop::point();
            if report.status == Status::Converged {
                return (end, report);
            }
            if report.n_iterations >= STEP_ITERATIONS {
                break;
            }
            self.reset(start);
            end = 0.5 * (from + end);
            let StepReport { n_solves, n_iterations, .. } = report;
            report = self.move_on(paths, [from, end], start);
            report.n_solves += n_solves;
            report.n_iterations += n_iterations;
        }
        if report.status == Status::Converged {
            return (end, report);
        }
        self.reset(start);
        let StepReport { n_solves, n_iterations, .. } = report;
        report = self.move_on(paths, [from, to], start);
        report.n_solves += n_solves;
        report.n_iterations += n_iterations;
        (to, report)
    }

    /// Least distance of the features that are about to touch (m), negative for an overlap, and the
    /// speed at which it grows (m/s).
    fn nearest(&self, strikes: &[Strike], time: f64) -> (f64, f64) {
        let Self { obstacles: Some(obstacles), system, state, .. } = self else { return (0.0, 0.0) };
        let instant = self.instant(time);
        let of_pair = |strike: &Strike| obstacles.distance_and_rate(system, strike, &state.motion, instant);
        strikes.iter().map(of_pair).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0.0))
    }

    /// Change of the velocity of the load's edge since another motion, or more (m/s).
    fn change_since(&self, before: &Motion) -> f64 {
        let (now, before) = (&self.state.motion.twist, &before.twist);
        (now.linear - before.linear).norm() + self.system.load.radius * (now.angular - before.angular).abs()
    }

    /// What springs and ground give the load within `duration` (N s, N s, N m s; load axes).
    fn momentum_within(&self, duration: f64) -> Vec3 {
        let Self { springs, system, state, .. } = self;
        let Motion { pose, twist } = &state.motion;
        let turn = rotation(pose.heading);
        let pulls = -springs.reaction(&system.springs, pose).gradient;
        let mut sum = turn.tr_mul(&pulls.xy()).push(pulls.z);
        for (support, limit) in system.ground.supports.iter().zip(system.ground.slip_limits()) {
            let slip = turn.tr_mul(&twist.velocity_at(&(turn * support.offset)));
            let friction = slip.try_normalize(0.0).map_or(Vec2::zeros(), |along| -limit * along);
            sum += wrench_of(&support.offset, &friction);
        }
        duration * sum
    }

    /// Speeds that are none for a load whose edge has changed its velocity by `change` (m/s) since
    /// it `moved` on (s), within a step of `duration` (s).
    ///
    /// A load that is pressed against an obstacle bounces infinitely often before it stays there.
    /// At fixed steps a bounce that would end within a step is none, and under error control one
    /// that leads no farther than a hundredth of what a macro-step may be wrong by.
    pub(super) fn speed_limits(&self, change: f64, [moved, duration]: [f64; 2]) -> SpeedLimits {
        let rounding = ROUNDED_GAP * self.system.load.radius;
        let softest = match &self.stepping {
            Stepping::Fixed(_) => change.max(rounding / duration),
            Stepping::Controlled(control) => (2.0 * (NEGLIGIBLE_BOUNCE * control.position).max(rounding) * change / duration).sqrt(),
        };
        // What it gains on its way through a gap by rounding.
        let gained = if moved > 0.0 { (2.0 * rounding * change / moved).sqrt() } else { 0.0 };
        SpeedLimits { softest, rounding: gained.min(2.0 * change), momentum: self.momentum_within(duration) }
    }

    /// Applies the law of impacts at a time (s), where the load touches by these features and by
    /// those that were closed before. Returns the law that the velocity follows; `None` for a touch
    /// without an approach above rounding.
    pub(super) fn strike(&mut self, strikes: &[Strike], limits: SpeedLimits, time: f64) -> Option<ImpactLaw> {
        let instant = self.instant(time);
        let Self { obstacles, system, state, springs, .. } = self;
        let Some(obstacles) = obstacles else { return None };
        let Reflection { twist, loss, of_obstacles, obstacle, law } =
            obstacles.reflect(system, &mut state.side.touching, strikes, &state.motion, (instant, limits));
        let kinetic = system.load.kinetic_energy(&twist);
        state.motion.twist = twist;
        state.energy.kinetic = kinetic;
        state.energy.impacts += loss;
        state.energy.obstacle_work += of_obstacles;
        state.memory.forget_steps();
        state.forecast.forget();
        state.side.impacts.extend(law.map(|law| Impact { time, obstacle, loss, law }));
        springs.refresh(&system.springs, &state.motion.pose);
        law
    }

    /// Moves the load from the `start`, without regard to what it does not touch yet.
    fn move_on(&mut self, paths: &TipPaths, [from, to]: [f64; 2], start: &Snapshot<Memory>) -> StepReport {
        if self.state.side.touching.is_empty() {
            return self.step_freely(paths, from, to);
        }
        if self.method.integrator == Integrator::Euler {
            return self.step_touching(paths, [from, to], Scope::Touching);
        }
        if let Some(report) = self.go_on_touching(paths, [from, to]) {
            return report;
        }
        let mut report = self.step_touching(paths, [from, to], Scope::Touching);
        if self.has_stood(start) {
            self.remember_touching(start, (to - from) * paths.duration);
            return report;
        }
        let whole = (self.flow(), self.contacts(), self.state.contact.last());
        self.reset(start);
        let middle = 0.5 * (from + to);
        report.add(&self.step_touching(paths, [from, middle], Scope::Touching));
        let half = (self.contacts(), self.state.contact.last());
        report.add(&self.step_touching(paths, [middle, to], Scope::Touching));
        let halves = (self.flow(), self.contacts(), self.state.contact.last());
        // Forces that hold a load are no series in the step: they are not unique.
        if self.stands_since(start) {
            self.remember_touching(start, (to - from) * paths.duration);
            return StepReport { n_steps: 1, ..report };
        }
        if whole.1.go_on(&halves.1) && whole.1.go_on(&half.0) && whole.2 == halves.2 && half.1 == whole.2 {
            let flow: Vec<f64> = halves.0.iter().zip(&whole.0).map(|(fine, coarse)| 2.0 * fine - coarse).collect();
            self.set_flow(&flow);
            // Features that part may overlap where both answers have them apart, and losses of
            // steps that are no series may fall.
            let (now, before) = (&self.state.energy, &start.state.energy);
            let fall = (before.friction - now.friction).max(before.side_friction - now.side_friction);
            let falls = fall > LEAST_FALL * self.system.total_slip_limit() * self.system.load.radius;
            if falls || self.overlaps_of(&start.state.side.touching, self.time_at(paths, to)) {
                self.set_flow(&halves.0);
            }
            self.remember_touching(start, (to - from) * paths.duration);
        }
        StepReport { n_steps: 1, ..report }
    }

    /// Whether the load has stood still since the `start`, and nothing was lost or the forces of
    /// the obstacles have not changed. Halves of such a step would give the same: forces between
    /// those at its ends hold the load as well.
    fn has_stood(&self, start: &Snapshot<Memory>) -> bool {
        let (now, before) = (&self.state, &start.state);
        let is_lossless =
            now.energy.side_friction == before.energy.side_friction && now.energy.obstacle_work == before.energy.obstacle_work;
        let is_unchanged = |(now, before): (&Touching, &Touching)| now.key == before.key && now.force == before.force;
        let [now, before] = [&now.side.touching, &before.side.touching];
        let are_unchanged = now.len() == before.len() && now.iter().zip(before).all(is_unchanged);
        self.stands_since(start) && (is_lossless || are_unchanged) && !self.method.is_damped
    }

    fn stands_since(&self, start: &Snapshot<Memory>) -> bool {
        self.state.motion == start.state.motion && self.state.motion.twist == Twist::ZERO
    }
}
