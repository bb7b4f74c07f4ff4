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
use super::spring_blocks::{Place, SpringBlocks};
use super::{Status, StepReport};
use crate::math::{Arc, Mat2, Mat3, Pose, PositiveDefinite, Twist, Vec2, Vec3, rotation, shift_of};
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
    /// How far it takes the load's origin (m, world).
    pub shift: Vec2,
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
pub fn minimise(potential: Potential, ground: &Ground, solver: &mut FrictionSolver, length: f64, guess: Option<Vec3>) -> Increment {
    let turn = rotation(potential.start.heading);
    let mut step = Step { potential, ground, turn, length };
    let guess = guess.filter(|_| solver.accuracy() == 0.0);
    if let Some(found) = guess.and_then(|guess| step.glide(solver, guess, None)) {
        return found;
    }
    let local = step.potential.at(&Vec3::zeros(), &turn);
    step.rest(solver, &local).unwrap_or_else(|| step.descend_from_rest(solver, local))
}

/// One step to be found.
struct Step<'a> {
    potential: Potential<'a>,
    ground: &'a Ground,
    /// Takes the axes of the start to world axes.
    turn: Mat2,
    /// Extent of the load (m).
    length: f64,
}

/// How Newton's method gets on from a guess.
struct Approach {
    n_iterations: u64,
    /// Size of the last correction.
    last: f64,
}

enum Next {
    /// Where it is, it is exact to rounding.
    Done,
    Correct,
    /// It leads elsewhere, if anywhere.
    GiveUp,
}

impl Approach {
    const NEW: Approach = Approach { n_iterations: 0, last: f64::INFINITY };

    /// What to do about a `correction` of this size, at an increment of size `extent` with this residual (1).
    fn judge(&mut self, correction: f64, extent: f64, residual: f64) -> Next {
        let tolerance = RELATIVE_TOLERANCE * extent + ABSOLUTE_TOLERANCE;
        // One more iteration costs little and takes the last digits.
        if correction <= tolerance && (residual <= EXACT || self.last <= tolerance) {
            return if residual <= LARGEST_RESIDUAL { Next::Done } else { Next::GiveUp };
        }
        self.n_iterations += 1;
        // Newton's method that converges does so fast; a guess that is off by half of itself is none.
        let is_near = correction <= (0.5 * self.last).max(tolerance) && correction <= 0.5 * extent;
        self.last = correction;
        if is_near && self.n_iterations < MOST_GLIDING { Next::Correct } else { Next::GiveUp }
    }
}

impl Step<'_> {
    fn size(&self, twist: &Vec3) -> f64 {
        twist.xy().norm() / self.length + twist.z.abs()
    }

    fn found(&self, twist: &Vec3, regime: Regime, report: StepReport) -> Increment {
        Increment { twist: *twist, shift: shift_of(&self.turn, twist), friction: friction_loss(self.ground, twist), regime, report }
    }

    /// Newton's method on springs and friction at once, for a load that goes on turning about one support, or all of whose supports go on slipping;
    /// `None` when it does not lead from `guess`, where the potential is `there` if that is known, to the minimum in a few iterations. Where the springs'
    /// energy is convex at both ends there is but one.
    fn glide(&mut self, solver: &mut FrictionSolver, guess: Vec3, there: Option<Reaction>) -> Option<Increment> {
        let pin = solver.unit_turn();
        let mut at = pin.map_or(guess, |(unit_turn, _)| guess.z * unit_turn);
        let mut approach = Approach::NEW;
        let mut there = there.filter(|_| at == guess);
        loop {
            let local = there.take().unwrap_or_else(|| self.potential.at(&at, &self.turn));
            let (step, residual) = match pin {
                Some((unit_turn, _)) => {
                    let (step, residual) = solver.pivoting_step(at.z, &local.gradient, &local.hessian)?;
                    (step * unit_turn, residual)
                }
                None => solver.gliding_step(&at, &local.gradient, &local.hessian)?,
            };
            let is_first = approach.n_iterations == 0;
            let next = approach.judge(self.size(&step), self.size(&at), residual);
            if (is_first || matches!(next, Next::Done)) && PositiveDefinite::new(&local.hessian).is_none() {
                return None;
            }
            match next {
                Next::GiveUp => return None,
                Next::Correct => at = pin.map_or(at + step, |(unit_turn, _)| (at.z + step.z) * unit_turn),
                Next::Done => {
                    let regime = match pin {
                        Some((_, support)) => solver.keep_pivoting(at.z, &local.gradient).then_some(Regime::Pinned(support))?,
                        None => solver.keep_gliding(&at),
                    };
                    let n_iterations = approach.n_iterations;
                    return Some(self.found(
                        &at,
                        regime,
                        StepReport { residual, n_steps: 1, n_solves: 1, n_iterations, ..StepReport::default() },
                    ));
                }
            }
        }
    }

    /// No increment, for a load that was at rest and can go on to be, with what the potential is there.
    fn rest(&self, solver: &mut FrictionSolver, local: &Reaction) -> Option<Increment> {
        let residual = solver.rest(&local.gradient)?;
        Some(self.found(&Vec3::zeros(), Regime::Stick, StepReport { residual, n_steps: 1, n_solves: 1, ..StepReport::default() }))
    }

    /// Proximal Newton's method from no increment, with what the potential is there.
    fn descend_from_rest(&mut self, solver: &mut FrictionSolver, mut local: Reaction) -> Increment {
        let length = self.length;
        let is_frictionless = solver.is_frictionless();
        let mut at = Vec3::zeros();
        let mut report = StepReport { n_steps: 1, ..StepReport::default() };
        let mut residual = f64::INFINITY;
        let mut regime = Regime::Stick;
        for n_before in 0..MOST_ITERATIONS {
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
            let tolerance = RELATIVE_TOLERANCE.max(solver.accuracy()) * self.size(&solution.increment) + ABSOLUTE_TOLERANCE;
            let start = &self.potential.start;
            let is_last = self.size(&step) <= tolerance || is_frictionless && local.is_balanced(&hessian, &step, start, length);
            residual = solution.residual.max(if is_last { 0.0 } else { self.size(&step) / self.size(&solution.increment).max(1.0) });
            if step == Vec3::zeros() {
                break;
            }
            let Some((next, there)) = self.descend(&local, &at, &step) else { break };
            // At the end of a full step the friction is that of the solution, so that only the change of the springs' forces is left out of balance.
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
            let may_glide = n_before == 0 && is_full && regime != Regime::Stick && solver.accuracy() == 0.0;
            if let Some(mut found) = may_glide.then(|| self.glide(solver, at, Some(local))).flatten() {
                found.report.n_solves += report.n_solves;
                found.report.n_iterations += report.n_iterations;
                return found;
            }
        }
        report.residual = if residual.is_finite() { residual } else { 1.0 };
        report.status = if residual <= LARGEST_RESIDUAL.max(solver.accuracy()) { Status::Converged } else { Status::NotConverged };
        report.n_not_converged = u64::from(report.status != Status::Converged);
        self.found(&at, regime, report)
    }

    /// The first of the points at 1, 1/2, 1/4 ... of the `step` from an increment where the objective has fallen by Armijo's rule, or by nothing but
    /// rounding, and what the potential is there; `None` when there is none.
    fn descend(&mut self, local: &Reaction, at: &Vec3, step: &Vec3) -> Option<(Vec3, Reaction)> {
        let (friction, friction_there) = (friction_loss(self.ground, at), friction_loss(self.ground, &(at + step)));
        let before = local.energy + friction;
        let predicted = local.gradient.dot(step) + friction_there - friction;
        // Rounding of the sum, and of the lengths that a stiff spring sees: its force times that of the load's position.
        let force = (2.0 * local.energy * local.hessian.m11.max(local.hessian.m22)).max(0.0).sqrt();
        let rounding = 1e-14 * (before.abs() + local.gradient.dot(step).abs() + friction_there)
            + 4.0 * f64::EPSILON * force * (self.potential.start.position.norm() + self.length);
        let mut share = 1.0;
        for _ in 0..40 {
            let next = at + share * step;
            let there = self.potential.at(&next, &self.turn);
            let after = there.energy + friction_loss(self.ground, &next);
            if after <= before + 1e-4 * share * predicted.min(0.0) + rounding {
                return Some((next, there));
            }
            share *= 0.5;
        }
        None
    }
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
        let arc = Arc::of(stage.z);
        let pose = Pose { position: position + turn * arc.shift(&stage.xy()), heading: heading + stage.z };
        let place = Place { pose, turn: turn * arc.rotation() };
        let mut elastic = self.springs.reaction(&place);
        if let Some(dashpots) = &mut self.dashpots {
            elastic.add(&dashpots.reaction(&place));
        }
        let mut sum = by_increment(&elastic, &arc, &stage.xy());
        sum.energy /= share;
        sum.hessian *= share;
        if let Some(coasting) = &self.inertia {
            let arc = Arc::of(twist.z);
            sum.add(&by_increment(&coasting.reaction(turn, twist, &arc), &arc, &twist.xy()));
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

    /// Energy and its derivatives by shifts along the load's axes and by its turn, at the increment `twist` along `arc` from a start whose axes `turn` takes
    /// to world axes.
    fn reaction(&self, turn: &Mat2, twist: &Vec3, arc: &Arc) -> Reaction {
        let (linear, angular) = self.stiffness;
        let away = turn * arc.shift(&twist.xy()) - self.shift;
        let pull = linear * (turn * arc.rotation()).tr_mul(&away);
        let turn = twist.z - self.turn;
        Reaction {
            energy: 0.5 * linear * away.norm_squared() + 0.5 * angular * turn * turn,
            gradient: pull.push(angular * turn),
            hessian: Mat3::from_diagonal(&Vec3::new(linear, linear, angular)),
        }
    }
}

/// Derivatives by shifts along the load's axes and by its turn, turned into derivatives by the increment (u, delta) of
/// `x = x_0 + R V(delta) u`, `heading = heading_0 + delta` that led there along `arc`, with u the `shift` (m).
fn by_increment(local: &Reaction, arc: &Arc, shift: &Vec2) -> Reaction {
    // Seen from the end, where the axes have turned by delta, V is its own transpose.
    let mean = arc.mean_rotation();
    let first = arc.first_at_end();
    let by_turn = first * shift;
    let force = local.gradient.xy();
    // [V' t; 0 1]' [A b; b' c] [V' t; 0 1] by blocks.
    let linear = local.hessian.fixed_view::<2, 2>(0, 0).into_owned();
    let coupling = Vec2::new(local.hessian.m13, local.hessian.m23);
    let bent = linear * by_turn;
    let shifts = mean * linear * mean.transpose();
    let both = mean * (bent + coupling) + first.tr_mul(&force);
    let turns = by_turn.dot(&(bent + 2.0 * coupling)) + local.hessian.m33 + force.dot(&(arc.second_at_end() * shift));
    let along = mean * force;
    Reaction {
        energy: local.energy,
        gradient: along.push(by_turn.dot(&force) + local.gradient.z),
        hessian: Mat3::new(shifts.m11, shifts.m12, both.x, shifts.m21, shifts.m22, both.y, both.x, both.y, turns),
    }
}

/// Derivatives by (x, y, heading) turned into derivatives by an increment from there, of a load whose axes `turn` takes to world axes.
pub fn in_body_increments(world: &Reaction, turn: &Mat2) -> Reaction {
    by_increment(&world.in_axes(turn), &Arc::of(0.0), &Vec2::zeros())
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::held::HeldSprings;
    use crate::math::{Chance, Stream, direction};
    use crate::model::{PolarSpring, SupportPoint};

    fn ground() -> Ground {
        let supports = [0.5, 2.6, 4.7].map(|angle| SupportPoint { offset: 0.0081333 * direction(angle), normal_load: 0.005232 });
        Ground { friction_coefficient: 1.4, supports: supports.to_vec() }
    }

    /// A forecast that is off by a tenth leads to the increment that descent from rest finds, whether the load slips or turns about a support. Newton's method ends at rounding: 1e-12 of the increment, and of its friction.
    #[test]
    fn a_forecast_leads_where_descent_from_rest_does() {
        let (ground, start) = (ground(), Pose::new(0.1, -0.05, 0.7));
        let mut n_found = [0; 2];
        for case in 0..1000 {
            let chance = Chance::new(case);
            let draw = |k: u64| 2.0 * chance.uniform(Stream::Start, 0, k) - 1.0;
            let n = 1 + case as usize % 3;
            let springs: Vec<PolarSpring> = (0..n as u32).map(|k| spring(0.4 + 2.0 * f64::from(k))).collect();
            let mut held = HeldSprings::default();
            for (k, spring) in springs.iter().enumerate() {
                let way = 0.025 * Vec2::new(1.0 + draw(2 * k as u64), draw(2 * k as u64 + 1));
                let tip = start.to_world(&(spring.rest_tip() + rotation(spring.bearing) * way));
                held.grasp(&springs, k, tip, &start);
            }
            let mut blocks = SpringBlocks::default();
            blocks.gather(&springs, held.grips());
            blocks.start(&Place::of(&start));
            let mut solver = FrictionSolver::new(&ground, 0.0122);
            let mut find = |guess| {
                let potential = Potential { start, springs: &mut blocks, dashpots: None, inertia: None, springs_at: Stage::END };
                minimise(potential, &ground, &mut solver, 0.0122, guess)
            };
            let fallen = find(None);
            if fallen.regime == Regime::Stick || fallen.report.status != Status::Converged {
                continue;
            }
            let glided = find(Some(fallen.twist.component_mul(&Vec3::new(1.1, 0.95, 0.9))));
            if glided.report.n_solves > 1 {
                continue;
            }
            n_found[usize::from(glided.regime != Regime::Slip)] += 1;
            assert_eq!(glided.regime, fallen.regime, "{case}");
            let away = glided.twist - fallen.twist;
            let size = fallen.twist.xy().norm() + 0.0122 * fallen.twist.z.abs();
            assert!(away.xy().norm() + 0.0122 * away.z.abs() <= 1e-12 * size, "{case}: {away:?} of {fallen:?}");
            assert!((glided.friction - fallen.friction).abs() <= 1e-12 * fallen.friction, "{case}");
        }
        assert!(n_found[0] > 60 && n_found[1] > 20, "{n_found:?}");
    }

    fn spring(bearing: f64) -> PolarSpring {
        PolarSpring {
            root: 0.0122 * direction(bearing),
            bearing,
            rest_length: 0.0263,
            radial_stiffness: 0.664,
            torsional_stiffness: 4.52e-4,
            damping_ratio: 0.0,
        }
    }
}
