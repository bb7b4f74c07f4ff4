//! One time-incremental step: the body-twist increment that minimises potential plus friction.
//!
//! ```text
//! minimise over x    E(q exp x) + sum_i c_i |B_i x|
//! ```
//!
//! E is the elastic energy with the tips where they are at the end of the step and, with inertia, half the mass matrix over the squared step about
//! the pose that the load would coast to. Without inertia this is the paper's max-min principle, Eq. (15), in its time-incremental form: the printed
//! instantaneous form fixes a direction but no speed. `Deviation:` Eq. (11)-(16) are posed for increments, not velocities.
//!
//! The constant-twist path from q to q exp x dissipates just sum_i c_i |B_i x| with constant B_i, so the problem is the same in every world frame.
//! E is not convex in general. The minimum wanted is the one that descent from rest reaches, by proximal Newton: the cone problem with the
//! Hessian of E, made positive definite where it is not, and a line search on the true objective.

use super::friction::{EXACT, FrictionSolver, Regime};
use super::spring_blocks::SpringBlocks;
use super::{Status, StepReport};
use crate::math::{Mat2, Mat3, Pose, PositiveDefinite, Twist, Vec2, Vec3, mean_rotation, mean_rotation_derivatives, rotation, shift_of};
use crate::model::support::slip_velocity;
use crate::model::{Ground, Load, Reaction};

/// What the increment is to minimise, besides friction.
pub struct Potential<'a> {
    /// Pose at the start of the step.
    pub start: Pose,
    /// Springs with their tips where the step evaluates them.
    pub springs: &'a mut SpringBlocks,
    /// Dashpots as springs of this step.
    pub dashpots: Option<&'a mut SpringBlocks>,
    /// `None` neglects inertia.
    pub inertia: Option<Coasting>,
    /// Where on the way the springs act.
    pub springs_at: Stage,
}

/// The increment at which springs are evaluated while the load's own is x: offset + share x. Their energy counts over the share, so that its derivative by
/// x is the force there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage {
    /// Body-twist increment (m, m, rad).
    pub offset: Vec3,
    /// (1)
    pub share: f64,
}

impl Stage {
    /// The end of the step.
    pub const END: Stage = Stage { offset: Vec3::new(0.0, 0.0, 0.0), share: 1.0 };

    fn of(&self, twist: &Vec3) -> Vec3 {
        self.offset + self.share * twist
    }
}

/// The inertia of the load as a spring to where it would coast. Shift and turn, not a pose: over a short step the difference of two poses
/// has too few digits for the line search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coasting {
    /// Way of the load's origin within the step if no force acted (m, world).
    pub shift: Vec2,
    /// Turn within the step if no torque acted (rad).
    pub turn: f64,
    /// Mass and moment of inertia over the squared step (N/m, N m/rad).
    pub stiffness: (f64, f64),
}

/// The increment found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Increment {
    /// Body-twist increment (m, m, rad).
    pub twist: Vec3,
    /// Energy lost to friction (J).
    pub friction: f64,
    pub regime: Regime,
    pub report: StepReport,
}

/// Size of a Newton step, over the size of the increment, at which the increment is exact to rounding.
const RELATIVE_TOLERANCE: f64 = 1e-12;
/// The same over the extent of the load, for increments that are themselves near rounding.
const ABSOLUTE_TOLERANCE: f64 = 1e-15;
/// Residual of the cone problem, or size of the last Newton step over the load's extent, above which a step counts as not converged.
/// A thousand times what steps reach that end by their tolerance, and far below what a path's own error could show.
const LARGEST_RESIDUAL: f64 = 1e-9;
/// Where a guess takes more, the descent from rest is the better way.
const MOST_GLIDING: u64 = 6;
/// Converging steps take two to six; where the energy has a kink none will do.
const MOST_ITERATIONS: u64 = 60;
/// Longest turn in one Newton step (rad): the quadratic model says little beyond.
const LONGEST_TURN: f64 = 0.5;

/// Minimises over increments, near a `guess` if that is good and from rest else. `length` (m) is the extent of the load, which makes turns and shifts
/// comparable.
pub fn minimise(mut potential: Potential, ground: &Ground, solver: &mut FrictionSolver, length: f64, guess: Option<Vec3>) -> Increment {
    let turn = rotation(potential.start.heading);
    guess
        .filter(|_| solver.accuracy() == 0.0)
        .and_then(|guess| glide(&mut potential, ground, solver, &turn, length, guess))
        .unwrap_or_else(|| descend_from_rest(&mut potential, ground, solver, &turn, length))
}

/// Newton's method on springs and friction at once, for a load all of whose supports go on slipping; `None` when it does not lead from `guess` to the
/// minimum in a few iterations. Where the energy is convex at both ends there is but one.
fn glide(
    potential: &mut Potential,
    ground: &Ground,
    solver: &mut FrictionSolver,
    turn: &Mat2,
    length: f64,
    guess: Vec3,
) -> Option<Increment> {
    let size = |twist: &Vec3| twist.xy().norm() / length + twist.z.abs();
    let mut at = guess;
    let mut last = f64::INFINITY;
    for n_iterations in 0..MOST_GLIDING {
        let local = potential.at(&at, turn);
        let (step, residual) = solver.gliding_step(&at, &local.gradient, &local.hessian)?;
        let (correction, extent) = (size(&step), size(&at));
        let tolerance = RELATIVE_TOLERANCE * extent + ABSOLUTE_TOLERANCE;
        // One more iteration costs little and takes the last digits.
        let is_last = correction <= tolerance && (residual <= EXACT || last <= tolerance);
        if (n_iterations == 0 || is_last) && PositiveDefinite::new(&local.hessian).is_none() {
            return None;
        }
        if is_last {
            solver.keep_gliding(&at);
            let report = StepReport { residual, n_steps: 1, n_solves: 1, n_iterations, ..StepReport::default() };
            return (residual <= LARGEST_RESIDUAL).then(|| Increment {
                twist: at,
                friction: friction_loss(ground, &at),
                regime: Regime::Slip,
                report,
            });
        }
        // Newton's method that converges does so fast; a guess that is off by half of itself is none.
        let is_near = correction <= (0.5 * last).max(tolerance) && correction <= 0.5 * extent;
        if !is_near {
            return None;
        }
        last = correction;
        at += step;
    }
    None
}

fn descend_from_rest(potential: &mut Potential, ground: &Ground, solver: &mut FrictionSolver, turn: &Mat2, length: f64) -> Increment {
    let size = |twist: &Vec3| twist.xy().norm() / length + twist.z.abs();
    let is_frictionless = solver.is_frictionless();
    let mut at = Vec3::zeros();
    let mut local = potential.at(&at, turn);
    let mut report = StepReport { n_steps: 1, ..StepReport::default() };
    let mut residual = f64::INFINITY;
    let mut regime = Regime::Stick;
    for _ in 0..MOST_ITERATIONS {
        let hessian = positive_definite(&local.hessian, length);
        let solution = solver.solve(&hessian, &(hessian * at - local.gradient));
        regime = solution.regime;
        report.n_solves += 1;
        report.n_iterations += u64::from(solution.n_iterations);
        let full_step = solution.increment - at;
        let step = shortened(full_step);
        if !step.iter().all(|v| v.is_finite()) {
            break;
        }
        let tolerance = RELATIVE_TOLERANCE.max(solver.accuracy()) * size(&solution.increment) + ABSOLUTE_TOLERANCE;
        let is_last = size(&step) <= tolerance || is_frictionless && local.is_balanced(&hessian, &step, &potential.start, length);
        residual = solution.residual.max(if is_last { 0.0 } else { size(&step) / size(&solution.increment).max(1.0) });
        if step == Vec3::zeros() {
            break;
        }
        let Some((next, there)) = descend(potential, ground, &local, [&at, &step], turn, length) else { break };
        // At the end of a full step the friction is that of the solution, so that only the change of the springs' forces is left out of balance.
        let is_exact = size(&(next - solution.increment)) <= f64::EPSILON * size(&next) && {
            let left = there.gradient - local.gradient - hessian * full_step;
            PositiveDefinite::new(&hessian).is_some_and(|factor| size(&factor.solve(&left)) <= tolerance)
        };
        (at, local) = (next, there);
        if is_last || is_exact || at == Vec3::zeros() {
            residual = if is_exact { solution.residual } else { residual };
            break;
        }
    }
    report.residual = if residual.is_finite() { residual } else { 1.0 };
    report.status = if residual <= LARGEST_RESIDUAL.max(solver.accuracy()) { Status::Converged } else { Status::NotConverged };
    report.n_not_converged = u64::from(report.status != Status::Converged);
    Increment { twist: at, friction: friction_loss(ground, &at), regime, report }
}

/// Energy that the supports lose along a constant-twist path (J).
pub fn friction_loss(ground: &Ground, twist: &Vec3) -> f64 {
    ground.supports.iter().zip(ground.slip_limits()).map(|(support, limit)| limit * slip_velocity(&support.offset, twist).norm()).sum()
}

impl Potential<'_> {
    /// Energy (J), gradient and Hessian by the body-twist increment, at the increment `twist`; `turn` takes the axes of the start to world axes.
    fn at(&mut self, twist: &Vec3, turn: &Mat2) -> Reaction {
        let (stage, share) = (self.springs_at.of(twist), self.springs_at.share);
        let Pose { position, heading } = self.start;
        let pose = Pose { position: position + shift_of(turn, &stage), heading: heading + stage.z };
        let mut elastic = self.springs.reaction(&pose);
        if let Some(dashpots) = &mut self.dashpots {
            elastic.add(&dashpots.reaction(&pose));
        }
        let mut sum = in_body_increments(&elastic, turn, &stage);
        sum.energy /= share;
        sum.hessian *= share;
        if let Some(coasting) = &self.inertia {
            sum.add(&in_body_increments(&coasting.reaction(turn, twist), turn, twist));
        }
        sum
    }
}

impl Reaction {
    /// Whether a Newton `step` without friction corrects nothing but rounding of the forces, for which the largest stiffness times the largest coordinate
    /// stands. Without friction a load on one spring has a motion that no force resists, so that the step itself need not be small.
    fn is_balanced(&self, hessian: &Mat3, step: &Vec3, pose: &Pose, length: f64) -> bool {
        let units = Vec3::new(length, length, 1.0);
        let stiffness = Mat3::from_fn(|i, j| hessian[(i, j)] * units[i] * units[j]).amax();
        let stretch = if stiffness > 0.0 { (2.0 * self.energy / stiffness).sqrt() } else { 0.0 };
        let coordinate = 1.0 + pose.position.norm() / length + pose.heading.abs() + stretch;
        (hessian * step).component_mul(&units).amax() <= 8.0 * f64::EPSILON * stiffness * coordinate
    }
}

impl Coasting {
    /// Of a load with `twist` over `step` (s).
    pub fn of(load: &Load, twist: &Twist, step: f64) -> Self {
        Self {
            shift: step * twist.linear,
            turn: step * twist.angular,
            stiffness: (load.mass / (step * step), load.inertia / (step * step)),
        }
    }

    /// Energy and its derivatives by the load's pose, at the increment `twist` from a start whose axes `turn` takes to world axes.
    fn reaction(&self, turn: &Mat2, twist: &Vec3) -> Reaction {
        let (linear, angular) = self.stiffness;
        let away = shift_of(turn, twist) - self.shift;
        let turn = twist.z - self.turn;
        Reaction {
            energy: 0.5 * linear * away.norm_squared() + 0.5 * angular * turn * turn,
            gradient: Vec3::new(linear * away.x, linear * away.y, angular * turn),
            hessian: Mat3::from_diagonal(&Vec3::new(linear, linear, angular)),
        }
    }
}

/// Derivatives by (x, y, heading) turned into derivatives by the increment (u, delta) of
/// `x = x_0 + R V(delta) u`, `heading = heading_0 + delta`, where R is the rotation `turn` by heading_0.
pub fn in_body_increments(world: &Reaction, turn: &Mat2, twist: &Vec3) -> Reaction {
    let (first, second) = mean_rotation_derivatives(twist.z);
    let by_shift = turn * mean_rotation(twist.z);
    let by_turn = turn * first * twist.xy();
    let force = world.gradient.xy();
    let mixed = (turn * first).tr_mul(&force);
    let twice = force.dot(&(turn * second * twist.xy()));
    // [S t; 0 1]' [A b; b' c] [S t; 0 1] by blocks.
    let linear = world.hessian.fixed_view::<2, 2>(0, 0).into_owned();
    let coupling = Vec2::new(world.hessian.m13, world.hessian.m23);
    let bent = linear * by_turn;
    let shifts = by_shift.tr_mul(&(linear * by_shift));
    let both = by_shift.tr_mul(&(bent + coupling)) + mixed;
    let turns = by_turn.dot(&(bent + 2.0 * coupling)) + world.hessian.m33 + twice;
    let along = by_shift.tr_mul(&force);
    Reaction {
        energy: world.energy,
        gradient: Vec3::new(along.x, along.y, by_turn.dot(&force) + world.gradient.z),
        hessian: Mat3::new(shifts.m11, shifts.m12, both.x, shifts.m21, shifts.m22, both.y, both.x, both.y, turns),
    }
}

/// `hessian` itself where it is positive definite, in units where lengths count in `length`.
///
/// Where it is not, mostly because turning a load while it shifts turns its way, the pivot of the turn is replaced by its absolute value: friction resists
/// turning far more, and the stiffness against shifts, which sets the way, stays exact. Where shifts are unstable too, absolute values of all eigenvalues
/// take their place. Pivots are kept above 1e-12 of the largest entry.
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

fn shortened(step: Vec3) -> Vec3 {
    if step.z.abs() > LONGEST_TURN { step * (LONGEST_TURN / step.z.abs()) } else { step }
}

/// The first of the points at 1, 1/2, 1/4 ... of the step where the objective has fallen by Armijo's rule, or by nothing but rounding, and what the
/// potential is there; `None` when there is none.
fn descend(
    potential: &mut Potential,
    ground: &Ground,
    local: &Reaction,
    [at, step]: [&Vec3; 2],
    turn: &Mat2,
    length: f64,
) -> Option<(Vec3, Reaction)> {
    let (friction, friction_there) = (friction_loss(ground, at), friction_loss(ground, &(at + step)));
    let before = local.energy + friction;
    let predicted = local.gradient.dot(step) + friction_there - friction;
    // Rounding of the sum, and of the lengths that a stiff spring sees: its force times that of the load's position.
    let force = (2.0 * local.energy * local.hessian.m11.max(local.hessian.m22)).max(0.0).sqrt();
    let rounding = 1e-14 * (before.abs() + local.gradient.dot(step).abs() + friction_there)
        + 4.0 * f64::EPSILON * force * (potential.start.position.norm() + length);
    let mut share = 1.0;
    for _ in 0..40 {
        let next = at + share * step;
        let there = potential.at(&next, turn);
        let after = there.energy + friction_loss(ground, &next);
        if after <= before + 1e-4 * share * predicted.min(0.0) + rounding {
            return Some((next, there));
        }
        share *= 0.5;
    }
    None
}
