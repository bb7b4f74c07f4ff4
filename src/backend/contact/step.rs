//! One time-incremental step of a load that touches obstacles.
//!
//! ```text
//! balance    dE/dx + sum_i B_i' f_i = sum_k p_k dgap_k/dx + tau_k dslip_k/dx
//! contact    gap_k >= 0, p_k >= 0, p_k gap_k = 0 at the end of the step
//! friction   |tau_k| <= mu_k p_k, against the slip of the step where there is any
//! ```
//!
//! A guess of the contact modes makes this a system of equations, which Newton's method solves with
//! the curvature of springs, gaps and slips (`newton_corrector`). Elsewhere, and for a load of
//! which a support sticks, the step is linearised again and again, and each linear step is solved
//! for good (`solve_contacts`).

use smallvec::SmallVec;

use super::candidates::{Candidate, ContactStep, Local, Locals, Sides};
use super::newton::Newton;
use super::solve::{ContactRow, ContactSystem, Ending, PerContact, SideForce, SideMode, Stage, go_on_resting, may_rest, solve_contacts};
use crate::backend::friction::{ContactMode, FrictionSolver};
use crate::backend::increment::{Course, Increment, Objective, Step, positive_definite, shortened};
use crate::backend::numerics::{ALIGNED, CLOSED_GAP, FAILED_STEPS, KEPT_GAP, LARGEST_RESIDUAL, LONGEST_TURN, STEPS_ALIKE, STEPS_IN_FULL};
use crate::backend::report::{Status, StepReport};
use crate::math::{Mat3, Vec3};
use crate::stop;

/// What a step with contacts found.
pub struct Found {
    pub increment: Increment,
    pub sides: Sides,
    /// Whether no other contact forces balance the load.
    pub are_forces_unique: bool,
    /// Whether the load began to move although it could have gone on resting.
    pub could_rest: bool,
}

/// How far the search goes along each linear step.
///
/// Where the springs are not convex, a linear step makes them so and takes only a share of the
/// path. Steps that point the same way are therefore doubled, and doubled again.
#[derive(Default)]
struct Pace {
    last: Vec3,
    n_alike: i32,
}

impl Pace {
    /// Share of the next linear step (1, 1, rad) that the load goes.
    fn stride(&mut self, step: &Vec3) -> f64 {
        let last = std::mem::replace(&mut self.last, *step);
        let is_alike = step.dot(&last) >= ALIGNED * step.norm() * last.norm() && 2.0 * step.norm() >= last.norm();
        self.n_alike = if is_alike { self.n_alike + 1 } else { 0 };
        if self.n_alike < STEPS_ALIKE {
            return 1.0;
        }
        let longest = LONGEST_TURN / step.norm();
        2f64.powi(self.n_alike + 1 - STEPS_ALIKE).min(longest).max(1.0)
    }
}

impl ContactStep<'_, Step<'_>> {
    /// The step, from what the last one suggests: its modes and forces, and a guess of the
    /// increment.
    pub fn find(&mut self, solver: &mut FrictionSolver, suggested: &Sides, guess: Option<Vec3>) -> Found {
        if solver.was_at_rest() {
            if let Some(found) = self.rest(solver, suggested) {
                return found;
            }
        } else if let Some(guess) = guess
            && let Some(found) = self.newton_corrector(solver, suggested, guess, false)
        {
            return found;
        }
        let was_at_rest = solver.was_at_rest();
        if !was_at_rest
            && suggested.iter().any(|(_, force)| force.normal > 0.0)
            && let Some(found) = self.rest(solver, suggested)
        {
            return found;
        }
        let mut found = self.descend(solver);
        found.could_rest = was_at_rest && found.increment.twist != Vec3::zeros() && self.could_rest(solver, &found.sides);
        if self.overlaps(&found.increment.twist) {
            let report = &mut found.increment.report;
            (report.status, report.n_not_converged) = (report.status.max(Status::NotConverged), 1);
        }
        found
    }

    /// Whether side friction could hold the load where the step begins, with normal forces near
    /// those of its answer.
    fn could_rest(&mut self, solver: &FrictionSolver, sides: &Sides) -> bool {
        let drags =
            |((_, force), candidate): (&(SideMode, SideForce), &Candidate)| force.normal > 0.0 && candidate.pair.friction_coefficient > 0.0;
        if !sides.iter().zip(self.candidates).any(drags) {
            return false;
        }
        let mut locals = Locals::new();
        self.fill_locals(&Vec3::zeros(), &mut locals);
        let (rows, row_of) = self.rows(&Vec3::zeros(), &locals);
        let forces: PerContact<SideForce> = row_of.iter().map(|index| sides[*index].1).collect();
        let drive = -self.step.gradient(&Vec3::zeros());
        may_rest(&ContactSystem { hessian: &Mat3::zeros(), drive: &drive, rows: &rows }, solver, &forces)
    }

    /// Whether a pair overlaps by more than rounding at an increment.
    fn overlaps(&self, at: &Vec3) -> bool {
        let mut locals = Locals::new();
        self.fill_locals(at, &mut locals);
        locals.iter().any(|local| local.gap.energy < -KEPT_GAP * self.step.length && local.beyond <= 0.0)
    }

    /// Zero increment, for a load at rest that the last normal forces without friction still hold
    /// there, which is then the only answer, or that other forces hold by so much that it cannot
    /// slide as well. Against an obstacle that slides by, the friction is that of its slip: there a
    /// load rests where the last forces balance it.
    fn rest(&mut self, solver: &mut FrictionSolver, last: &Sides) -> Option<Found> {
        let closed = CLOSED_GAP * self.step.length;
        let drive = -self.step.gradient(&Vec3::zeros());
        let (mut sides, mut locals) = (Sides::new(), Locals::new());
        self.fill_locals(&Vec3::zeros(), &mut locals);
        let (mut missing, mut slides) = (drive, false);
        for (((mode, force), local), candidate) in last.iter().zip(&locals).zip(self.candidates) {
            let (overlaps, touches) = (local.gap.energy < -closed, local.gap.energy.abs() <= closed && local.beyond <= closed);
            if overlaps && local.beyond <= 0.0 || force.normal > 0.0 && !touches {
                return None;
            }
            let (slip, friction) = (local.slip.energy, candidate.pair.friction_coefficient * force.normal);
            let is_slid_by = friction > 0.0 && slip.abs() > candidate.rounding(self.step.length);
            let tangential = if is_slid_by { -friction.copysign(slip) } else { 0.0 };
            missing += force.normal * local.gap.gradient + tangential * local.slip.gradient;
            sides.push((*mode, SideForce { tangential, ..*force }));
            slides |= is_slid_by;
        }
        let mut report = StepReport { n_steps: 1, n_solves: 1, ..StepReport::default() };
        if slides {
            let last = solver.hold(&-missing, LARGEST_RESIDUAL)?;
            report.residual = solver.rest(&-missing).unwrap_or(last);
        } else if let Some(residual) = solver.rest(&-missing).filter(|residual| *residual <= LARGEST_RESIDUAL) {
            report.residual = residual;
        } else {
            let (rows, row_of) = self.rows(&Vec3::zeros(), &locals);
            let of_rows = |index: &usize| last[*index];
            let (modes, forces): (PerContact<SideMode>, PerContact<SideForce>) = row_of.iter().map(of_rows).unzip();
            let system = ContactSystem { hessian: &Mat3::zeros(), drive: &drive, rows: &rows };
            let solution = go_on_resting(&system, solver, &modes, &forces)?;
            (report.residual, report.n_iterations) = (solution.residual, solution.n_iterations.into());
            for (row, index) in row_of.into_iter().enumerate() {
                sides[index] = (self.candidates[index].pair.mode(solution.modes[row]), solution.forces[row]);
            }
        }
        // The friction of the ground may take the place of any contact force.
        let are_forces_unique = sides.iter().all(|(_, force)| force.normal == 0.0);
        Some(Found { increment: self.step.found(&Vec3::zeros(), ContactMode::Stick, report), sides, are_forces_unique, could_rest: false })
    }

    /// The answer of [`Self::newton`] in the last mode on the ground, with which the friction
    /// solver goes on. It may be unstable where the linear step has no other answer.
    fn newton_corrector(&mut self, solver: &mut FrictionSolver, sides: &Sides, guess: Vec3, may_be_unstable: bool) -> Option<Found> {
        let pin = solver.unit_turn();
        let (guess, pivot) = match pin {
            Some((unit_turn, support)) => (guess.z * unit_turn, Some(self.step.ground.supports[support].offset)),
            None => (guess, None),
        };
        let found = self.newton(sides, guess, pivot).filter(|found| found.is_stable || may_be_unstable)?;
        let Newton { mut at, sides, are_forces_unique, report, .. } = found;
        let mode = match pin {
            Some((unit_turn, support)) => {
                at = at.z * unit_turn;
                let gradient = self.gradient_with(&at, &sides);
                solver.keep_pivoting(at.z, &gradient).then_some(ContactMode::Pinned(support))?
            }
            None => solver.keep_gliding(&at),
        };
        Some(Found { increment: self.step.found(&at, mode, report), sides, are_forces_unique, could_rest: false })
    }

    /// Gradient of all but the friction of the ground at an increment, under these contact forces.
    fn gradient_with(&mut self, at: &Vec3, sides: &Sides) -> Vec3 {
        let mut locals = Locals::new();
        self.fill_locals(at, &mut locals);
        let of_side = |((_, force), local): (&(SideMode, SideForce), &Local)| {
            force.normal * local.gap.gradient + force.tangential * local.slip.gradient
        };
        self.step.gradient(at) - sides.iter().zip(&locals).map(of_side).sum::<Vec3>()
    }

    /// Linear steps from where the search begins.
    fn descend(&mut self, solver: &mut FrictionSolver) -> Found {
        let length = self.step.length;
        let (mut at, mut sides) = (self.start_at, Sides::new());
        let mut report = StepReport { n_steps: 1, ..StepReport::default() };
        let mut mode = ContactMode::Stick;
        let (mut n_failed, mut locals, mut pace) = (0, Locals::new(), Pace::default());
        for round in 0..self.most_steps {
            stop::point();
            let local = self.step.at(&at);
            self.fill_locals(&at, &mut locals);
            let hessian = self.curvature(&local.hessian, &at, mode, (&sides, &locals));
            let (rows, row_of) = self.rows(&at, &locals);
            let drive = hessian * at - local.gradient;
            let solution = solve_contacts(&ContactSystem { hessian: &hessian, drive: &drive, rows: &rows }, solver, None);
            report.n_solves += u64::from(solution.n_solves);
            report.n_iterations += u64::from(solution.n_iterations);
            mode = solution.ground_mode;
            // Gaps that contradict each other have no finite one.
            report.residual = solution.residual.min(1.0);
            report.is_indeterminate = !solution.are_forces_unique && solution.forces.iter().any(|force| force.normal > 0.0);
            if solution.ending == Ending::Infeasible {
                if at != Vec3::zeros() {
                    // Gaps that bend away may contradict each other far from the start.
                    at *= if round == 0 { 0.0 } else { 0.5 };
                    continue;
                }
                return self.none(report);
            }
            sides = self.open();
            for (row, candidate) in row_of.iter().enumerate() {
                sides[*candidate] = (self.candidates[*candidate].pair.mode(solution.modes[row]), solution.forces[row]);
            }
            let next = solution.increment;
            if at == Vec3::zeros() && next == Vec3::zeros() {
                return self.ended(next, mode, sides, report);
            }
            let may_be_unstable = solution.stage == Stage::Unstable;
            let change = shortened(next - at);
            let is_whole = change == next - at;
            if is_whole
                && mode != ContactMode::Stick
                && let Some(found) = self.newton_corrector(solver, &sides, next, may_be_unstable)
            {
                let residual = found.increment.report.residual;
                let report = StepReport { residual, is_indeterminate: false, ..report };
                return Found { increment: Increment { report, ..found.increment }, ..found };
            }
            n_failed += u32::from(solution.ending != Ending::Converged);
            let stride = pace.stride(&change.component_div(&Vec3::new(length, length, 1.0)));
            let stride = if stride > 1.0 || round < STEPS_IN_FULL { stride } else { 0.5 };
            at = if is_whole && stride == 1.0 { next } else { at + stride * change };
            if self.step.size(&change) <= 1e-12 * self.step.size(&at) + 1e-15 {
                return self.ended(at, mode, sides, report);
            }
            if n_failed == FAILED_STEPS {
                break;
            }
        }
        self.ended(at, mode, sides, StepReport { status: Status::NotConverged, residual: report.residual.max(1e-9), ..report })
    }

    /// Curvature at an increment, of the springs and of gaps and slips with these forces, made
    /// positive definite. Where the load slips, ground friction may suffice for it: what is left of
    /// the path then needs fewer linear steps.
    fn curvature(&self, of_springs: &Mat3, at: &Vec3, mode: ContactMode, (sides, locals): (&Sides, &Locals)) -> Mat3 {
        if *of_springs == Mat3::zeros() {
            return *of_springs;
        }
        let mut hessian = *of_springs;
        for ((_, force), local) in sides.iter().zip(locals) {
            hessian -= force.normal * local.gap.hessian + force.tangential * local.slip.hessian;
        }
        let stiffened = positive_definite(&hessian, self.step.length);
        let may_be_held = *at != Vec3::zeros() && mode == ContactMode::Slip && stiffened != hessian;
        let held = if may_be_held { self.step.held_by_friction(&hessian, at) } else { None };
        held.unwrap_or(stiffened)
    }

    /// A step without an answer: the load stays.
    pub fn none(&self, report: StepReport) -> Found {
        let failed = StepReport { status: Status::Failed, residual: 1.0, ..report };
        self.ended(Vec3::zeros(), ContactMode::Stick, self.open(), failed)
    }

    fn open(&self) -> Sides {
        self.candidates.iter().map(|_| (SideMode::Open, SideForce::default())).collect()
    }

    /// A step that ends here; one with a large residual has not converged.
    fn ended(&self, at: Vec3, mode: ContactMode, sides: Sides, report: StepReport) -> Found {
        let status = report.status.max(status_of(report.residual));
        let n_not_converged = u64::from(status != Status::Converged);
        let are_forces_unique = !report.is_indeterminate;
        Found {
            increment: self.step.found(&at, mode, StepReport { status, n_not_converged, ..report }),
            sides,
            are_forces_unique,
            could_rest: false,
        }
    }

    /// Rows of the candidates that can touch near an increment, and the candidate of each.
    fn rows(&self, at: &Vec3, locals: &[Local]) -> (PerContact<ContactRow>, PerContact<usize>) {
        let closed = CLOSED_GAP * self.step.length;
        let (mut rows, mut row_of) = (SmallVec::new(), SmallVec::new());
        for (index, (local, candidate)) in locals.iter().zip(self.candidates).enumerate() {
            if local.beyond > closed {
                continue;
            }
            let gap = if local.gap.energy.abs() <= 1e-13 * self.step.length { 0.0 } else { local.gap.energy };
            let rounding = candidate.rounding(self.step.length);
            let rounded = |value: f64| if value.abs() <= rounding { 0.0 } else { value };
            rows.push(ContactRow {
                normal: local.gap.gradient,
                tangent: local.slip.gradient,
                gap: rounded(gap - local.gap.gradient.dot(at)),
                slip: rounded(local.slip.energy - local.slip.gradient.dot(at)),
                friction_coefficient: candidate.pair.friction_coefficient,
            });
            row_of.push(index);
        }
        (rows, row_of)
    }
}

/// Status of a step with this residual (1), as without contacts.
fn status_of(residual: f64) -> Status {
    if residual <= LARGEST_RESIDUAL { Status::Converged } else { Status::NotConverged }
}
