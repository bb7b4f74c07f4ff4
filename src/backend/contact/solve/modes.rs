//! Newton's method in modes that do not change.
//!
//! With the supports split into those that slip and those that stick, and the contacts into open,
//! sticking and sliding ones, the conditions of the step are equations in the increment x and one
//! force r_j per row:
//!
//! ```text
//! H x - w + sum_slipping c_i B_i' u_i - sum_j d_j r_j = 0        a_j x = b_j
//! ```
//!
//! A closed contact has the row of its gap, with the direction `d = n - sign(s) mu t` where it
//! slides. A sticking contact has two rows, n and t, and a sticking support the two of B_i. Rows
//! that depend on the others have forces that are not unique. They keep theirs, and the others do
//! the rest.

use smallvec::SmallVec;

use super::linear::{Basis, MOST, System};
use super::problem::{Candidate, PerCone, Problem, Start};
use super::types::{PerContact, SideForce, SideMode};
use crate::backend::friction::ContactMode;
use crate::backend::numerics::{
    CONSISTENT, CONTRADICTS, MODE_ITERATIONS, MOST_IDLE, NOTHING_LEFT, RESTS, ROUNDED_RISE, SOFT_RIDGE, WELL_POSED,
};
use crate::math::{Mat3, Vec2, Vec3};

/// What the force of a row belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Owner {
    Normal(usize),
    Tangent(usize),
    Support(usize, usize),
    /// Length of the twist at the limit of slipping; its force is the share of the drive there.
    Length,
}

/// An equation `row . x = target` and the force that sees to it.
#[derive(Clone, Copy, Debug)]
struct Equation {
    owner: Owner,
    row: Vec3,
    direction: Vec3,
    target: f64,
    force: f64,
    /// How far the force may change before it meets a limit.
    room: f64,
}

impl Equation {
    fn error(&self, twist: &Vec3) -> f64 {
        self.row.dot(twist) - self.target
    }
}

impl Candidate {
    /// All forces divided by a number.
    fn over(mut self, divisor: f64) -> Self {
        self.ground_forces.iter_mut().for_each(|force| *force /= divisor);
        for force in &mut self.forces {
            *force = SideForce { normal: force.normal / divisor, tangential: force.tangential / divisor };
        }
        self
    }

    /// Rest with the forces of an increment that has shrunk to rounding: those of a load at the
    /// very limit of slipping, whose direction the increment still shows.
    fn at_the_limit(self, problem: &Problem) -> Self {
        Self { twist: Vec3::zeros(), ground: ContactMode::Stick, is_consistent: true, ..self }.sticking(problem)
    }

    /// The same with contacts that stick where they resist a slip, and slip by rounding only.
    /// Others slide as they slip.
    pub fn sticking(mut self, problem: &Problem) -> Self {
        for (k, mode) in self.modes.iter_mut().enumerate() {
            let slips = problem.slips(k, &self.twist);
            match mode {
                SideMode::Slide { forward } if slips => *forward = problem.slip(k, &self.twist) > 0.0,
                SideMode::Slide { .. } if problem.rows[k].friction_coefficient > 0.0 => *mode = SideMode::Stick,
                _ => (),
            }
        }
        self
    }
}

/// Answer in these modes near `start`; `None` where Newton's method does not lead to one. It need
/// not satisfy any inequality.
pub fn newton(problem: &Problem, ground: ContactMode, modes: &[SideMode], start: &Start) -> Option<Candidate> {
    let pin = match ground {
        ContactMode::Stick => return super::rest::balance(problem, modes, start, 2),
        ContactMode::Pinned(cone) => Some(cone),
        ContactMode::Slip => None,
    };
    let equations = equations(problem, pin, modes, start);
    let (chosen, others) = independent(equations, start.twist);
    let fixed: Vec3 = others.iter().map(|other| other.force * other.direction).sum();
    let mut search = Search { problem, pin, equations: chosen, fixed, twist: *start.twist };
    let (n_iterations, slopes) = search.run()?;
    if search.twist.amax() <= RESTS * problem.extent {
        return Some(search.candidate(ground, modes, &others, true, n_iterations).at_the_limit(problem));
    }
    let is_stable = search.is_stable(&slopes, modes);
    Some(search.candidate(ground, modes, &others, is_stable, n_iterations))
}

/// Answer of a load next to the limit of slipping in these modes, near which forces at rest have
/// all but no room. At the limit itself, the forces of a slip along a twist x of any length balance
/// a share s of the drive:
///
/// ```text
/// sum_slipping c_i B_i' u_i - sum_j d_j r_j = s w        a_j x = 0
/// ```
///
/// The load rests if s >= 1, with these forces over s. Otherwise it slips along x, by what its
/// springs take of the rest of the drive. `None` where `start` shows no twist or where contacts
/// have a gap.
pub fn next_to_the_limit(problem: &Problem, ground: ContactMode, modes: &[SideMode], start: &Start) -> Option<Candidate> {
    let pin = if let ContactMode::Pinned(cone) = ground { Some(cone) } else { None };
    let size = start.twist.norm();
    let touches = |k: usize| modes[k] == SideMode::Open || problem.rows[k].gap == 0.0 && problem.rows[k].slip == 0.0;
    if size == 0.0 || !(0..modes.len()).all(touches) {
        return None;
    }
    let mut limit = problem.clone().resized(size);
    (limit.h, limit.w) = (Mat3::zeros(), Vec3::zeros());
    let (mut chosen, others) = independent(equations(&limit, pin, modes, start), start.twist);
    if chosen.len() > 2 {
        return None;
    }
    chosen.push(Equation { owner: Owner::Length, row: start.twist / size, direction: problem.w, target: size, force: 1.0, room: 0.0 });
    let fixed: Vec3 = others.iter().map(|other| other.force * other.direction).sum();
    let mut search = Search { problem: &limit, pin, equations: chosen, fixed, twist: *start.twist };
    let (n_iterations, _) = search.run()?;
    let share = search.equations.last()?.force;
    let found = search.candidate(ground, modes, &others, true, n_iterations);
    if share >= 1.0 {
        return Some(found.over(share).at_the_limit(problem));
    }
    let length = (1.0 - share) * problem.w.dot(&found.twist) / found.twist.dot(&(problem.h * found.twist));
    let twist = length * found.twist;
    let start = Start { twist: &twist, ground_forces: &found.ground_forces, forces: &found.forces };
    if length > 0.0 && length.is_finite() { newton(&problem.clone().resized(twist.amax()), ground, modes, &start) } else { None }
}

/// Whether these modes leave one increment alone, in which gaps or slips are not as they say: no
/// answer has them, whatever the forces.
pub fn contradict(problem: &Problem, ground: ContactMode, modes: &[SideMode], start: &Start) -> bool {
    let pin = match ground {
        ContactMode::Stick => return false,
        ContactMode::Pinned(cone) => Some(cone),
        ContactMode::Slip => None,
    };
    let (chosen, others) = independent(equations(problem, pin, modes, start), start.twist);
    let [a, b, c] = &chosen[..] else { return false };
    let rows = Mat3::from_rows(&[a, b, c].map(|equation| equation.row.transpose()));
    let well_posed = |inverse: &Mat3| inverse.norm() * rows.norm() <= WELL_POSED;
    let Some(inverse) = rows.try_inverse().filter(well_posed) else { return false };
    let twist = inverse * Vec3::new(a.target, b.target, c.target);
    let allowed = CONTRADICTS * problem.lengths(&twist);
    let is_otherwise = |(k, mode): (usize, &SideMode)| match mode {
        SideMode::Open => problem.gap(k, &twist) < -allowed,
        SideMode::Slide { forward } if problem.rows[k].friction_coefficient > 0.0 => {
            (problem.slip(k, &twist) * if *forward { 1.0 } else { -1.0 }) < -allowed
        }
        SideMode::Slide { .. } | SideMode::Stick => false,
    };
    others.iter().any(|other| other.error(&twist).abs() > allowed) || modes.iter().enumerate().any(is_otherwise)
}

fn equations(problem: &Problem, pin: Option<usize>, modes: &[SideMode], start: &Start) -> SmallVec<[Equation; 8]> {
    let mut equations = SmallVec::new();
    if let Some(cone) = pin {
        let (offset, force) = (problem.cones.offsets[cone], start.ground_forces[cone]);
        let room = (problem.cones.limits[cone] - force.norm()).max(0.0);
        for (axis, row) in [Vec3::new(1.0, 0.0, -offset.y), Vec3::new(0.0, 1.0, offset.x)].into_iter().enumerate() {
            equations.push(Equation { owner: Owner::Support(cone, axis), row, direction: -row, target: 0.0, force: force[axis], room });
        }
    }
    for (k, mode) in modes.iter().enumerate().filter(|(_, mode)| **mode != SideMode::Open) {
        let (row, SideForce { normal, tangential }) = (&problem.rows[k], start.forces[k]);
        let direction = problem.direction_of(k, *mode);
        equations.push(Equation {
            owner: Owner::Normal(k),
            row: row.normal,
            direction,
            target: -row.gap,
            force: normal,
            room: normal.max(0.0),
        });
        if *mode == SideMode::Stick {
            let room = (row.friction_coefficient * normal - tangential.abs()).max(0.0);
            let (row, target) = (row.tangent, -row.slip);
            equations.push(Equation { owner: Owner::Tangent(k), row, direction: row, target, force: tangential, room });
        }
    }
    equations
}

/// Splits the equations into independent ones, those with most room or else most overlap first, and
/// the others.
fn independent(mut equations: SmallVec<[Equation; 8]>, twist: &Vec3) -> (SmallVec<[Equation; 3]>, SmallVec<[Equation; 8]>) {
    if equations.len() > 1 {
        equations.sort_by(|a, b| b.room.total_cmp(&a.room).then_with(|| a.error(twist).total_cmp(&b.error(twist))));
    }
    let (mut basis, mut chosen, mut others) = (Basis::default(), SmallVec::new(), SmallVec::new());
    for equation in equations {
        if basis.takes(&equation.row) { chosen.push(equation) } else { others.push(equation) }
    }
    (chosen, others)
}

struct Search<'a> {
    problem: &'a Problem<'a>,
    pin: Option<usize>,
    equations: SmallVec<[Equation; 3]>,
    /// Wrench of the forces that do not change.
    fixed: Vec3,
    twist: Vec3,
}

impl Search<'_> {
    /// Runs Newton's method; returns the number of iterations and the derivative of the imbalance.
    fn run(&mut self) -> Option<(u32, Mat3)> {
        let (mut best, mut best_size) = ((self.twist, self.equations.clone()), f64::INFINITY);
        let (mut n, mut n_idle) = (0, 0);
        loop {
            let mut slopes = self.problem.h;
            let imbalance = self.imbalance(Some(&mut slopes))?;
            let size = self.size(&imbalance);
            n_idle = if size < 0.5 * best_size { 0 } else { n_idle + 1 };
            if size < best_size {
                best = (self.twist, self.equations.clone());
            }
            let leads_nowhere = n == MODE_ITERATIONS || n_idle == MOST_IDLE;
            let is_over = size <= NOTHING_LEFT || size >= best_size && best_size <= ROUNDED_RISE || leads_nowhere;
            best_size = best_size.min(size);
            if is_over {
                (self.twist, self.equations) = best;
                let moves = self.twist.amax() > RESTS * self.problem.extent;
                return (if moves { best_size.is_finite() } else { best_size <= ROUNDED_RISE }).then_some((n, slopes));
            }
            n += 1;
            self.step(&imbalance, &slopes)?;
        }
    }

    fn imbalance(&self, mut slopes: Option<&mut Mat3>) -> Option<Vec3> {
        let Problem { cones, h, w, .. } = self.problem;
        let mut sum = h * self.twist - w - self.fixed;
        for (k, (offset, limit)) in cones.offsets.iter().zip(&cones.limits).enumerate() {
            if self.pin == Some(k) {
                continue;
            }
            let slip = cones.slip(k, &self.twist);
            let speed = slip.norm();
            let moves = speed > 0.0;
            if !moves {
                return None;
            }
            let unit = slip / speed;
            sum += *limit * Vec3::new(unit.x, unit.y, offset.perp(&unit));
            if let Some(slopes) = &mut slopes {
                let turned = Vec3::new(-unit.y, unit.x, offset.dot(&unit));
                **slopes += (limit / speed) * turned * turned.transpose();
            }
        }
        Some(self.equations.iter().fold(sum, |sum, equation| sum - equation.force * equation.direction))
    }

    /// Largest residual, forces over the forces and lengths over the increment (1).
    fn size(&self, imbalance: &Vec3) -> f64 {
        let forces = self.equations.iter().map(|equation| equation.force.abs()).fold(self.problem.force, f64::max);
        let targets = self.equations.iter().map(|equation| equation.target.abs());
        let lengths = targets.fold(self.twist.amax(), f64::max).max(f64::MIN_POSITIVE);
        let gaps = self.equations.iter().map(|equation| equation.error(&self.twist).abs() / lengths);
        gaps.fold(imbalance.amax() / forces, f64::max)
    }

    fn step(&mut self, imbalance: &Vec3, slopes: &Mat3) -> Option<()> {
        // Forces in units in which the entries of rows and slopes are alike.
        let unit = slopes.amax().max(f64::MIN_POSITIVE);
        let rows = self.equations.iter().map(|equation| (equation.row, unit * equation.direction));
        let mut system = System::bordered(slopes, rows);
        (0..3).for_each(|i| system.set_right(i, -imbalance[i]));
        for (j, equation) in self.equations.iter().enumerate() {
            system.set_right(3 + j, -equation.error(&self.twist));
        }
        system.scale();
        let step: [f64; MOST] = system.solve()?;
        self.twist += Vec3::new(step[0], step[1], step[2]);
        self.equations.iter_mut().zip(&step[3..]).for_each(|(equation, change)| equation.force += unit * change);
        Some(())
    }

    /// Whether all principal minors of `R C D'` are positive, with C the inverse of the `slopes`
    /// where the sticking support lets the load move: a small violation of any of the rows is then
    /// driven back by its force.
    fn is_stable(&self, slopes: &Mat3, modes: &[SideMode]) -> bool {
        let rows = 0..self.equations.len();
        let is_of_support = |j: &usize| matches!(self.equations[*j].owner, Owner::Support(..));
        let slides = |j: &usize| {
            let Owner::Normal(k) = self.equations[*j].owner else { return false };
            matches!(modes[k], SideMode::Slide { .. }) && self.problem.rows[k].friction_coefficient > 0.0
        };
        let contacts: SmallVec<[usize; 3]> = rows.clone().filter(|j| !is_of_support(j)).collect();
        let supports: SmallVec<[usize; 3]> = rows.filter(is_of_support).collect();
        (1..1usize << contacts.len()).all(|group| {
            let mut chosen: SmallVec<[usize; 3]> =
                contacts.iter().enumerate().filter(|(bit, _)| group >> bit & 1 == 1).map(|(_, j)| *j).collect();
            // Rows whose forces act along them have positive minors.
            if !chosen.iter().any(slides) {
                return true;
            }
            let sign = if supports.len().is_multiple_of(2) { 1.0 } else { -1.0 };
            chosen.extend(supports.iter().copied());
            sign * self.bordered(slopes, &chosen).sign() > 0.0
        })
    }

    /// The `slopes` with the rows of some equations below, and their directions beside. Its
    /// determinant has the sign of that of `R C D'`, times -1 for each row of a support.
    fn bordered(&self, slopes: &Mat3, chosen: &[usize]) -> System {
        let size = slopes.amax().max(f64::MIN_POSITIVE);
        let hessian = slopes / size + SOFT_RIDGE * Mat3::identity();
        let equations = chosen.iter().map(|j| &self.equations[*j]);
        let mut system = System::bordered(&hessian, equations.map(|equation| (equation.row, equation.direction)));
        system.scale();
        system
    }

    fn candidate(self, ground: ContactMode, modes: &[SideMode], others: &[Equation], is_stable: bool, n_iterations: u32) -> Candidate {
        let cones = self.problem.cones;
        let slip_force = |k: usize| (cones.limits[k] / cones.slip(k, &self.twist).norm()) * cones.slip(k, &self.twist);
        let force_of = |k: usize| if self.pin == Some(k) { Vec2::zeros() } else { slip_force(k) };
        let mut ground_forces: PerCone<Vec2> = (0..cones.len()).map(force_of).collect();
        let mut forces: PerContact<SideForce> = SmallVec::from_elem(SideForce::default(), modes.len());
        for Equation { owner, force, .. } in self.equations.iter().chain(others) {
            match *owner {
                Owner::Normal(k) => forces[k].normal = *force,
                Owner::Tangent(k) => forces[k].tangential = *force,
                Owner::Support(k, axis) => ground_forces[k][axis] = *force,
                Owner::Length => (),
            }
        }
        let modes: PerContact<SideMode> = modes.into();
        for (k, mode) in modes.iter().enumerate() {
            if let SideMode::Slide { forward } = mode {
                let sign = if *forward { 1.0 } else { -1.0 };
                forces[k].tangential = -sign * self.problem.rows[k].friction_coefficient * forces[k].normal;
            }
        }
        let is_consistent = others.iter().all(|other| other.error(&self.twist).abs() <= CONSISTENT * self.problem.lengths(&self.twist));
        let are_forces_unique = others.is_empty();
        Candidate { twist: self.twist, ground, ground_forces, forces, modes, are_forces_unique, is_consistent, is_stable, n_iterations }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::contact::solve::{ContactRow, ContactSystem};
    use crate::backend::friction::FrictionSolver;
    use crate::model::Ground;

    /// Three closed gaps move the load by (1, 2, 3). That overlaps a fourth one, unless it is wide
    /// enough, and slips forward along the first, by two.
    #[test]
    fn modes_that_fix_the_increment_contradict_gaps_and_slips() {
        let solver = FrictionSolver::new(&Ground { friction_coefficient: 0.0, supports: Vec::new() }, 1.0);
        let row = |normal: Vec3, gap: f64| ContactRow { normal, tangent: Vec3::y(), gap, slip: 0.0, friction_coefficient: 0.5 };
        let contradicts = |width: f64, forward: bool| {
            let rows = [row(Vec3::x(), -1.0), row(Vec3::y(), -2.0), row(Vec3::z(), -3.0), row(-Vec3::x(), width)];
            let system = ContactSystem { hessian: &Mat3::identity(), drive: &Vec3::zeros(), rows: &rows };
            let problem = Problem::new(solver.cones(), &system, None);
            let slides = SideMode::Slide { forward: true };
            let modes = [SideMode::Slide { forward }, slides, slides, SideMode::Open];
            let start = Start { twist: &Vec3::zeros(), ground_forces: &[], forces: &[SideForce::default(); 4] };
            contradict(&problem, ContactMode::Slip, &modes, &start)
        };
        assert_eq!([0.9, 1.1].map(|width| contradicts(width, true)), [true, false]);
        assert!(contradicts(1.1, false));
    }
}
