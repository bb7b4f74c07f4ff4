//! Descent from rest: proximal Newton's method, from any start.

use super::corrector::{Corrected, Wanted, correct};
use super::objective::Objective;
use super::potential::{Course, Increment, Step, friction_curvature, friction_force, friction_loss};
use crate::backend::friction::{ContactMode, FrictionSolver};
use crate::backend::numerics::{
    ABSOLUTE_TOLERANCE, DESCENT_ITERATIONS, EXACT, HELD_SLIP, JOINT_EACH, JOINT_ITERATIONS, JOINT_STEP, LARGEST_RESIDUAL, LEAST_CURVATURE,
    LONGEST_TURN, MOST_CORRECTIONS, RELATIVE_TOLERANCE, SHORT_STEP, SLOW_DESCENT, STEADY,
};
use crate::backend::report::{Status, StepReport};
use crate::math::{Mat3, Pose, PositiveDefinite, Vec3};
use crate::model::support::slip_velocity;
use crate::model::{Reaction, SupportPoint};
use crate::stop;

/// Progress of a descent.
struct Pace {
    /// Size of the last full step.
    last: Option<f64>,
    /// Number of corrections tried.
    n_corrections: u32,
}

impl Step<'_> {
    /// Zero increment, for a load that was at rest and can stay so.
    pub(super) fn rest(&mut self, solver: &mut FrictionSolver) -> Option<Increment> {
        if !solver.was_at_rest() {
            return None;
        }
        let residual = solver.rest(&self.gradient(&Vec3::zeros()))?;
        Some(self.found(&Vec3::zeros(), ContactMode::Stick, StepReport { residual, n_steps: 1, n_solves: 1, ..StepReport::default() }))
    }

    /// Proximal Newton's method from no increment.
    pub(super) fn descend_from_rest(&mut self, solver: &mut FrictionSolver) -> Increment {
        let (mut local, length) = (self.at(&Vec3::zeros()), self.length);
        let is_frictionless = solver.is_frictionless();
        let mut at = Vec3::zeros();
        let mut report = StepReport { n_steps: 1, ..StepReport::default() };
        let mut residual = f64::INFINITY;
        let mut mode = ContactMode::Stick;
        let mut pace = Pace { last: None, n_corrections: 0 };
        for iteration in 0..DESCENT_ITERATIONS {
            stop::point();
            let stiffened = positive_definite(&local.hessian, length);
            let is_slow = iteration >= SLOW_DESCENT && stiffened != local.hessian;
            let held = if is_slow { self.held_by_friction(&local.hessian, &at) } else { None };
            let hessian = held.unwrap_or(stiffened);
            let solution = solver.solve(&hessian, &(hessian * at - local.gradient));
            mode = solution.mode;
            report.n_solves += 1;
            report.n_iterations += u64::from(solution.n_iterations);
            let full_step = solution.increment - at;
            let step = shortened(full_step);
            if !step.iter().all(|v| v.is_finite()) {
                break;
            }
            let tolerance =
                RELATIVE_TOLERANCE.max(solver.accuracy()) * self.size(&solution.increment) + ABSOLUTE_TOLERANCE + self.rounding();
            let start = &self.potential.start.pose;
            let is_last = self.size(&step) <= tolerance || is_frictionless && local.is_balanced(&hessian, &step, start, length);
            residual = solution.residual.max(if is_last { 0.0 } else { self.size(&step) / self.size(&solution.increment).max(1.0) });
            if step == Vec3::zeros() {
                break;
            }
            let Some((next, there)) = self.descend(&local, &at, &step) else { break };
            // At the end of a full step the friction is that of the solution, so that only the
            // change of the springs' forces is left out of balance.
            let is_full = self.size(&(next - solution.increment)) <= f64::EPSILON * self.size(&next);
            let is_exact = is_full && {
                let left = there.gradient - local.gradient - hessian * full_step;
                PositiveDefinite::new(&hessian).is_some_and(|factor| self.size(&factor.solve(&left)) <= tolerance)
            };
            (at, local) = (next, there);
            if is_last || is_exact || at == Vec3::zeros() {
                residual = if is_exact { solution.residual } else { residual };
                break;
            }
            let is_exact_solver = solver.accuracy() == 0.0;
            let may_correct = is_full && mode != ContactMode::Stick && is_exact_solver;
            let mut found = may_correct.then(|| self.correct_on(solver, (at, local), &mut pace, self.size(&full_step))).flatten();
            if found.is_none() && is_slow && iteration % JOINT_EACH == 0 && mode == ContactMode::Slip && is_exact_solver {
                (at, local, found) = self.glide(solver, (at, local));
            }
            if let Some(Corrected { at, mode, report: found }) = found {
                report.n_solves += found.n_solves;
                report.n_iterations += found.n_iterations;
                return self.found(&at, mode, StepReport { residual: found.residual, ..report });
            }
        }
        report.residual = if residual.is_finite() { residual } else { 1.0 };
        report.status = if residual <= LARGEST_RESIDUAL.max(solver.accuracy()) { Status::Converged } else { Status::NotConverged };
        report.n_not_converged = u64::from(report.status != Status::Converged);
        self.found(&at, mode, report)
    }

    /// The `hessian` at an increment, with so much of the curvature of friction there as makes it
    /// positive definite with a margin. Friction resists a change of direction, and its curvature
    /// is zero along the increment: the stiffness along it, which sets its length, stays exact.
    /// `None` where all of that curvature does not suffice: no minimum is near.
    #[inline(never)]
    pub fn held_by_friction(&self, hessian: &Mat3, at: &Vec3) -> Option<Mat3> {
        let units = Vec3::new(self.length, self.length, 1.0);
        let size = |matrix: &Mat3| Mat3::from_fn(|i, j| matrix[(i, j)] * units[i] * units[j]).amax();
        let curvature = friction_curvature(self.ground, at, HELD_SLIP * self.length * self.size(at));
        // Any share holds springs without stiffness, which slack ropes are.
        let least = LEAST_CURVATURE * size(hessian) / size(&curvature);
        let mut share = if least > 0.0 { least } else { LEAST_CURVATURE };
        while share < 0.5 {
            if PositiveDefinite::new(&(hessian + share * curvature)).is_some() {
                return Some(hessian + 2.0 * share * curvature);
            }
            share *= 4.0;
        }
        PositiveDefinite::new(&(hessian + curvature)).is_some().then(|| hessian + 2.0 * curvature)
    }

    /// Minimum that the descent is about to reach, by the corrector, from where a full `step` of
    /// this size has led. It is tried from the first step on where the energy of the springs is
    /// convex. Elsewhere the descent makes it so and gets on by a share in each step. Once steps
    /// are short, it goes to a minimum that lies no farther than the sum of the steps to come.
    fn correct_on(&mut self, solver: &mut FrictionSolver, (at, there): (Vec3, Reaction), pace: &mut Pace, step: f64) -> Option<Corrected> {
        let length = self.length;
        let Some(last) = pace.last.replace(step) else { return correct(self, solver, length, at, Some(there), Wanted::Only) };
        let share = step / last;
        if step > SHORT_STEP * self.size(&at) || share > STEADY || pace.n_corrections == MOST_CORRECTIONS {
            return None;
        }
        pace.n_corrections += 1;
        let left = step * share / (1.0 - share);
        correct(self, solver, length, at, Some(there), Wanted::Nearest).filter(|found| self.size(&(found.at - at)) <= 2.0 * left)
    }

    /// Newton's method on springs and friction at once, with a line search, from an increment at
    /// which all supports slip. Returns where it ends, and the minimum if it is one. The method
    /// stops where a support comes to slip too slowly.
    ///
    /// Where friction does not hold the springs any more, the objective falls ever faster in some
    /// direction. The method then follows that direction, and comes away from a balance that has
    /// just ended.
    #[inline(never)]
    fn glide(&mut self, solver: &mut FrictionSolver, (mut at, mut local): (Vec3, Reaction)) -> (Vec3, Reaction, Option<Corrected>) {
        let mut last = f64::INFINITY;
        for n_iterations in 0..JOINT_ITERATIONS {
            stop::point();
            let newton = solver.gliding_step(&at, &local.gradient, Some(&local.hessian), &mut None);
            if let Some((_, residual)) = newton.filter(|(_, residual)| *residual <= EXACT && *residual >= 0.25 * last) {
                let report = StepReport { residual, n_solves: 1, n_iterations, ..StepReport::default() };
                return (at, local, Some(Corrected { at, mode: solver.keep_gliding(&at), report }));
            }
            last = newton.map_or(f64::INFINITY, |(_, residual)| residual);
            let Some(step) = newton.map(|(step, _)| step).or_else(|| self.falling_step(&at, &local)) else { break };
            let share = self.size(&step) / self.size(&at);
            let Some(next) = self.descend(&local, &at, &(step * (JOINT_STEP / share).min(1.0))) else { break };
            (at, local) = next;
        }
        (at, local, None)
    }

    /// Newton step with the absolute values of the eigenvalues, where one is negative.
    fn falling_step(&self, at: &Vec3, local: &Reaction) -> Option<Vec3> {
        let units = Vec3::new(self.length, self.length, 1.0);
        let least = HELD_SLIP * self.length * self.size(at);
        let is_slow = |support: &SupportPoint| slip_velocity(&support.offset, at).norm() <= least;
        if self.ground.supports.iter().any(is_slow) {
            return None;
        }
        let hessian = local.hessian + friction_curvature(self.ground, at, least);
        let gradient = (local.gradient + friction_force(self.ground, at)).component_mul(&units);
        let eigen = Mat3::from_fn(|i, j| hessian[(i, j)] * units[i] * units[j]).symmetric_eigen();
        let along = eigen.eigenvectors.tr_mul(&gradient).component_div(&eigen.eigenvalues.abs());
        let step = -(eigen.eigenvectors * along).component_mul(&units);
        (eigen.eigenvalues.min() < 0.0 && step.iter().all(|v| v.is_finite())).then_some(step)
    }

    /// First of the points at 1, 1/2, 1/4 ... of the `step` from an increment where the objective
    /// has fallen by Armijo's rule, or by nothing but rounding, with the potential there. `None`
    /// when there is none.
    fn descend(&mut self, local: &Reaction, at: &Vec3, step: &Vec3) -> Option<(Vec3, Reaction)> {
        let (friction, friction_there) = (friction_loss(self.ground, at), friction_loss(self.ground, &(at + step)));
        let before = local.energy + friction;
        let predicted = local.gradient.dot(step) + friction_there - friction;
        // Rounding of the sum, and of the lengths that a stiff spring sees: its force times that of
        // the load's position.
        let force = (2.0 * local.energy * local.hessian.m11.max(local.hessian.m22)).max(0.0).sqrt();
        let rounding = 1e-14 * (before.abs() + local.gradient.dot(step).abs() + friction_there)
            + 4.0 * f64::EPSILON * force * (self.potential.start.pose.position.norm() + self.length);
        let mut share = 1.0;
        for _ in 0..40 {
            let next = at + share * step;
            let there = self.at(&next);
            let after = there.energy + friction_loss(self.ground, &next);
            if after <= before + 1e-4 * share * predicted.min(0.0) + rounding {
                let is_concave = share == 1.0 && before - after > rounding && before - after >= -predicted;
                return Some(if is_concave { self.go_on(at, step, (next, there), (before, after)) } else { (next, there) });
            }
            share *= 0.5;
        }
        None
    }

    /// Last of the points at 1, 2, 4 ... of the `step` from an increment up to which the objective
    /// has fallen ever faster, with the potential there. The objective is `before` at the
    /// increment, and `after` at the first point, which is `reached` (J).
    ///
    /// Where a balance has just ended, the load starts with next to no force. Along a path that
    /// mixes stiff and unstable motions the model has made the unstable ones stiff, and takes only
    /// a share of the path so far at each step. The search stops where the fall slows down: the
    /// minimum lies beyond.
    #[inline(never)]
    fn go_on(&mut self, at: &Vec3, step: &Vec3, mut reached: (Vec3, Reaction), (before, mut after): (f64, f64)) -> (Vec3, Reaction) {
        let mut share = 2.0;
        while share * self.size(step) <= LONGEST_TURN {
            let next = at + share * step;
            let there = self.at(&next);
            let further = there.energy + friction_loss(self.ground, &next);
            let falls_faster = after - further >= before - after;
            if !falls_faster {
                break;
            }
            (reached, after) = ((next, there), further);
            share *= 2.0;
        }
        reached
    }
}

impl Reaction {
    /// Whether a Newton `step` without friction corrects only rounding of the forces, estimated by
    /// the largest stiffness times the largest coordinate. Without friction a load on one spring
    /// has a motion that no force resists, so that the step itself need not be small.
    fn is_balanced(&self, hessian: &Mat3, step: &Vec3, pose: &Pose, length: f64) -> bool {
        let units = Vec3::new(length, length, 1.0);
        let stiffness = Mat3::from_fn(|i, j| hessian[(i, j)] * units[i] * units[j]).amax();
        let stretch = if stiffness > 0.0 { (2.0 * self.energy / stiffness).sqrt() } else { 0.0 };
        let coordinate = 1.0 + pose.position.norm() / length + pose.heading.abs() + stretch;
        (hessian * step).component_mul(&units).amax() <= 8.0 * f64::EPSILON * stiffness * coordinate
    }
}

/// The `hessian` itself where it is positive definite, with lengths in units of `length`.
///
/// Elsewhere, mostly because a turn also turns the shift, the pivot of the turn is replaced by its
/// absolute value. Friction resists turning far more, and the stiffness against shifts, which sets
/// the path, stays exact. Where shifts are unstable too, the eigenvalues are replaced by their
/// absolute values. Pivots are kept above 1e-12 of the largest entry.
pub fn positive_definite(hessian: &Mat3, length: f64) -> Mat3 {
    let units = Vec3::new(length, length, 1.0);
    let mut scaled = Mat3::from_fn(|i, j| hessian[(i, j)] * units[i] * units[j]);
    let least = 1e-12 * scaled.amax().max(f64::MIN_POSITIVE);
    let raised = scaled - Mat3::from_diagonal(&Vec3::new(least, least, least));
    if PositiveDefinite::new(&raised).is_some() {
        return *hessian;
    }
    let shifts = raised.fixed_view::<2, 2>(0, 0).into_owned();
    if let Some(factor) = shifts.cholesky() {
        let coupling = scaled.fixed_view::<2, 1>(0, 2).into_owned();
        let pivot = scaled.m33 - coupling.dot(&factor.solve(&coupling));
        scaled.m33 += pivot.abs().max(least) - pivot;
    } else {
        let mut eigen = scaled.symmetric_eigen();
        eigen.eigenvalues.apply(|value| *value = value.abs().max(least));
        scaled = eigen.recompose();
    }
    Mat3::from_fn(|i, j| scaled[(i, j)] / (units[i] * units[j]))
}

/// A step without what lies beyond the longest turn.
pub fn shortened(step: Vec3) -> Vec3 {
    if step.z.abs() > LONGEST_TURN { step * (LONGEST_TURN / step.z.abs()) } else { step }
}

#[cfg(test)]
mod tests {
    use super::super::minimise::minimise;
    use super::super::minimise::tests::{ground, spring};
    use super::super::potential::Potential;
    use super::*;
    use crate::backend::springs::Attachments;
    use crate::backend::springs::{Place, SpringBlocks};
    use crate::math::{RandomStreams, Stream, Vec2, rotation};
    use crate::model::PolarSpring;

    /// Tips pushed towards the load make it unstable against turns, which friction alone holds
    /// back. The descent then makes the energy of the springs convex and gets on by a share in each
    /// step. Hundreds of steps lead, to the rounding of some hundred solutions, where the corrector
    /// does.
    #[test]
    fn a_descent_is_left_for_where_it_leads() {
        let (ground, start) = (ground(), Pose::new(0.1, -0.05, 0.7));
        let mut n_found = 0;
        for case in 0..2000 {
            let streams = RandomStreams::new(case);
            let draw = |k: u64| 2.0 * streams.uniform(Stream::Start, 0, k) - 1.0;
            let springs: Vec<PolarSpring> = (0..3).map(|k| spring(0.4 + 2.0 * f64::from(k))).collect();
            let mut held = Attachments::default();
            for (k, spring) in springs.iter().enumerate() {
                let shift = Vec2::new(-0.01 * (1.0 + draw(2 * k as u64)), 0.02 * draw(2 * k as u64 + 1));
                held.attach(&springs, k, start.to_world(&(spring.rest_tip() + rotation(spring.bearing) * shift)), &start);
            }
            let mut blocks = SpringBlocks::default();
            blocks.fill(&springs, &held);
            blocks.start(&Place::of(&start));
            let mut solver = FrictionSolver::new(&ground, 0.0122);
            let found = minimise(Potential::of(&mut blocks, Place::of(&start)), &ground, &mut solver, 0.0122, None);
            let mut step = Step { potential: Potential::of(&mut blocks, Place::of(&start)), ground: &ground, length: 0.0122 };
            let is_convex = PositiveDefinite::new(&step.at(&found.twist).hessian).is_some();
            let is_found = found.report.status == Status::Converged && found.report.n_solves < 12;
            if is_convex || found.mode == ContactMode::Stick || !is_found {
                continue;
            }
            let (mut at, mut last) = (Vec3::zeros(), f64::INFINITY);
            for _ in 0..400 {
                let there = step.at(&at);
                let hessian = positive_definite(&there.hessian, 0.0122);
                let full = solver.solve(&hessian, &(hessian * at - there.gradient)).increment - at;
                let Some((next, _)) = step.descend(&there, &at, &shortened(full)) else { break };
                (last, at) = (step.size(&(next - at)), next);
            }
            if last > 1e-12 * step.size(&at) {
                continue;
            }
            n_found += 1;
            assert!(step.size(&(found.twist - at)) <= 1e-11 * step.size(&at), "{case}: {found:?} {at}");
        }
        assert!(n_found > 30, "{n_found}");
    }
}
