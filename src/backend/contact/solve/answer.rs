//! From a step in SI units to its answer, and back.

use smallvec::SmallVec;

use super::feasible::conflict;
use super::modes::newton;
use super::problem::{Candidate, PerCone, Problem, Start};
use super::rest::balance;
use super::search::Search;
use super::types::{ContactSolution, ContactSystem, Ending, PerContact, SideForce, SideMode, Stage};
use super::unique::is_only_answer;
use crate::backend::friction::cones::Cones;
use crate::backend::friction::{ContactMode, FrictionSolution, FrictionSolver};
use crate::backend::numerics::{ACCEPTED, CONVERGED};
use crate::math::{Vec2, Vec3};

/// The increment and the forces of a step. The ground under the load is that of `solver`, whose
/// last answer becomes this one. `warm` is the answer of a similar step, from which the search
/// starts.
pub fn solve_contacts(system: &ContactSystem, solver: &mut FrictionSolver, warm: Option<&ContactSolution>) -> ContactSolution {
    let mut counts = Counts { n_solves: 0, n_iterations: 0 };
    let warm = warm.filter(|warm| warm.modes.len() == system.rows.len());
    if let Some((candidate, residual)) = warm.and_then(|warm| from_last(system, solver.cones(), warm, &mut counts)) {
        return Answer { candidate, residual, stage: Stage::Warm, counts }.keep(solver);
    }
    let free = solver.solve(system.hessian, system.drive);
    counts = Counts { n_solves: 1, n_iterations: counts.n_iterations + free.n_iterations };
    let start = untouched(&free, solver, system.rows.len());
    let is_free = free.residual <= ACCEPTED;
    let problem = Problem::new(solver.cones(), system, is_free.then_some(start.twist));
    let residual = problem.residual_of(&start);
    if residual <= ACCEPTED {
        return Answer { candidate: start, residual, stage: Stage::Free, counts }.keep(solver);
    }
    let conflict = conflict(&problem);
    if !conflict.is_empty() {
        let candidate = Candidate { twist: Vec3::zeros(), ..start };
        let mut solution = Answer { candidate, residual: f64::INFINITY, stage: Stage::Failed, counts }.keep(solver);
        (solution.ending, solution.conflict) = (Ending::Infeasible, conflict);
        return solution;
    }
    let mut search = Search::new(problem);
    let stage = search.run(is_free.then_some(&start));
    counts.n_solves += search.n_solves;
    counts.n_iterations += search.n_iterations;
    let (candidate, residual) = search.best.take().unwrap_or((start, f64::INFINITY));
    Answer { candidate, residual, stage, counts }.keep(solver)
}

/// The answer of the cone problem as one in which nothing touches.
fn untouched(free: &FrictionSolution, solver: &FrictionSolver, n_contacts: usize) -> Candidate {
    let cones = solver.cones();
    Candidate {
        twist: cones.scaled_twist(&free.increment),
        ground: mode_by_cone(cones, free.mode),
        ground_forces: solver.warm_start().forces.iter().copied().collect(),
        forces: SmallVec::from_elem(SideForce::default(), n_contacts),
        modes: SmallVec::from_elem(SideMode::Open, n_contacts),
        are_forces_unique: true,
        is_consistent: true,
        is_stable: true,
        n_iterations: 0,
    }
}

/// Whether a load could rest on all that touches, whatever else it may do: friction from none,
/// spread evenly, balances the drive. `false` proves nothing.
pub fn may_rest(system: &ContactSystem, solver: &FrictionSolver, forces: &[SideForce]) -> bool {
    let cones = solver.cones();
    let problem = Problem::new(cones, system, None);
    let forces: PerContact<SideForce> = forces.iter().map(|force| SideForce { tangential: 0.0, ..scaled_force(cones, force) }).collect();
    let ground_forces = PerCone::from_elem(Vec2::zeros(), cones.len());
    let start = Start { twist: &Vec3::zeros(), ground_forces: &ground_forces, forces: &forces };
    let rest = balance(&problem, &problem.touching(), &start, 1);
    rest.is_some_and(|rest| problem.residual_of(&rest) <= ACCEPTED)
}

/// The answer of a load that goes on resting, with forces near the last ones or, if those leave too
/// little room, with friction from none. `None`, with nothing changed, where it may slide.
pub fn go_on_resting(
    system: &ContactSystem,
    solver: &mut FrictionSolver,
    modes: &[SideMode],
    forces: &[SideForce],
) -> Option<ContactSolution> {
    let cones = solver.cones();
    let problem = Problem::new(cones, system, None);
    let forces: PerContact<SideForce> = forces.iter().map(|force| scaled_force(cones, force)).collect();
    let last = &solver.warm_start().forces;
    // The last forces may be near limits. Without any to start from, friction is spread evenly.
    let (candidate, residual) = [(1.0, 2), (0.0, 1)].into_iter().find_map(|(share, power)| {
        let ground_forces: PerCone<Vec2> = last.iter().map(|force| share * force).collect();
        let forces: PerContact<SideForce> = forces.iter().map(|f| SideForce { tangential: share * f.tangential, ..*f }).collect();
        let start = Start { twist: &Vec3::zeros(), ground_forces: &ground_forces, forces: &forces };
        let found = balance(&problem, modes, &start, power)?;
        let residual = problem.residual_of(&found);
        (residual <= ACCEPTED && is_only_answer(&problem, &found)).then_some((found, residual))
    })?;
    let counts = Counts { n_solves: 1, n_iterations: candidate.n_iterations };
    Some(Answer { candidate, residual, stage: Stage::Warm, counts }.keep(solver))
}

/// Newton's method in the modes of the last answer; an answer only where all conditions hold.
fn from_last(system: &ContactSystem, cones: &Cones, last: &ContactSolution, counts: &mut Counts) -> Option<(Candidate, f64)> {
    let (problem, found) = newton_from(system, cones, last.ground_mode, &last.modes, last)?;
    counts.n_iterations += found.n_iterations;
    let residual = problem.residual_of(&found);
    (found.is_stable && found.is_consistent && residual <= ACCEPTED).then_some((found, residual))
}

/// Newton's method from `start` in given modes.
fn newton_from<'a>(
    system: &ContactSystem,
    cones: &'a Cones,
    ground_mode: ContactMode,
    modes: &[SideMode],
    start: &ContactSolution,
) -> Option<(Problem<'a>, Candidate)> {
    let twist = cones.scaled_twist(&start.increment);
    let problem = Problem::new(cones, system, Some(twist));
    let forces: PerContact<SideForce> = start.forces.iter().map(|force| scaled_force(cones, force)).collect();
    let ground_forces = cone_forces(cones, &start.ground_forces);
    let start = Start { twist: &twist, ground_forces: &ground_forces, forces: &forces };
    let found = newton(&problem, mode_by_cone(cones, ground_mode), modes, &start)?;
    Some((problem, found))
}

/// Largest violation of the conditions of a step by an increment (m, m, rad), the friction force on
/// each support (N, load axes, opposite to its slip) and the forces at the side contacts; forces
/// over the forces in the step, lengths over the size of the increment (1).
pub fn certificate(system: &ContactSystem, solver: &FrictionSolver, increment: &Vec3, ground_forces: &[Vec2], forces: &[SideForce]) -> f64 {
    let cones = solver.cones();
    let twist = cones.scaled_twist(increment);
    let problem = Problem::new(cones, system, Some(twist));
    let forces: PerContact<SideForce> = forces.iter().map(|force| scaled_force(cones, force)).collect();
    problem.residual(&twist, &cone_forces(cones, ground_forces), &forces)
}

/// Newton's method from `start` in given modes, which it does not change. `None` where it does not
/// converge; the answer need not satisfy any inequality, as its residual shows.
pub fn mode_newton(
    system: &ContactSystem,
    solver: &FrictionSolver,
    ground_mode: ContactMode,
    modes: &[SideMode],
    start: &ContactSolution,
) -> Option<ContactSolution> {
    let cones = solver.cones();
    let (problem, candidate) = newton_from(system, cones, ground_mode, modes, start)?;
    let counts = Counts { n_solves: 0, n_iterations: candidate.n_iterations };
    let residual = problem.residual_of(&candidate);
    Some(Answer { candidate, residual, stage: Stage::Warm, counts }.solution(cones))
}

fn mode_by_cone(cones: &Cones, mode: ContactMode) -> ContactMode {
    match mode {
        ContactMode::Pinned(support) => cones.cone_of(support).map_or(ContactMode::Slip, ContactMode::Pinned),
        other => other,
    }
}

fn scaled_force(cones: &Cones, force: &SideForce) -> SideForce {
    let unit = cones.unit_of_force();
    SideForce { normal: force.normal / unit, tangential: force.tangential / unit }
}

/// Resistance of each cone from the friction forces on the supports (N).
fn cone_forces(cones: &Cones, support_forces: &[Vec2]) -> PerCone<Vec2> {
    let mut forces: PerCone<Vec2> = SmallVec::from_elem(Vec2::zeros(), cones.len());
    for (support, force) in support_forces.iter().enumerate() {
        if let Some(cone) = cones.cone_of(support) {
            forces[cone] -= force / cones.unit_of_force();
        }
    }
    forces
}

#[derive(Clone, Copy)]
struct Counts {
    n_solves: u32,
    n_iterations: u32,
}

struct Answer {
    candidate: Candidate,
    residual: f64,
    stage: Stage,
    counts: Counts,
}

impl Answer {
    /// The answer in SI units, which becomes the last one of the solver.
    fn keep(self, solver: &mut FrictionSolver) -> ContactSolution {
        let Candidate { twist, ground, ground_forces, .. } = &self.candidate;
        solver.keep_scaled(*twist, *ground, ground_forces);
        self.solution(solver.cones())
    }

    fn solution(self, cones: &Cones) -> ContactSolution {
        let Self { candidate, residual, stage, counts: Counts { n_solves, n_iterations } } = self;
        let unit = cones.unit_of_force();
        let in_newtons = |force: &SideForce| SideForce { normal: unit * force.normal, tangential: unit * force.tangential };
        let mut ground_forces = SmallVec::from_elem(Vec2::zeros(), cones.n_supports());
        cones.share_forces(&candidate.ground_forces, &mut ground_forces);
        ContactSolution {
            increment: cones.unscaled_twist(&candidate.twist),
            ground_mode: match candidate.ground {
                ContactMode::Pinned(cone) => ContactMode::Pinned(cones.first_support_of(cone)),
                other => other,
            },
            ground_forces,
            forces: candidate.forces.iter().map(in_newtons).collect(),
            modes: candidate.modes,
            residual,
            ending: if residual <= CONVERGED { Ending::Converged } else { Ending::NotConverged },
            conflict: PerContact::new(),
            are_forces_unique: candidate.are_forces_unique,
            stage,
            n_solves,
            n_iterations,
        }
    }
}
