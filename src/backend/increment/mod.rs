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

mod descent;
mod glide;

use super::StepReport;
use super::friction::{FrictionSolver, Regime};
use super::springs::{Place, SpringBlocks};
use crate::math::{Arc, Mat2, Mat3, Pose, Twist, Vec2, Vec3, shift_of};
use crate::model::support::slip_velocity;
use crate::model::{Ground, Load, Reaction};

pub use descent::positive_definite;
pub(super) use glide::{Glided, Objective, Wanted, glide};

/// What the increment is to minimise, besides friction.
pub struct Potential<'a> {
    /// Where the load is at the start of the step.
    pub start: Place,
    /// Springs with their tips where the step evaluates them.
    pub springs: &'a mut SpringBlocks,
    /// Dashpots as springs of this step.
    pub dashpots: Option<&'a mut SpringBlocks>,
    /// `None` neglects inertia.
    pub inertia: Option<Coasting>,
    /// Where on the way the springs act; `None` at its end, which a constant body twist leads to.
    pub springs_at: Option<Stage>,
    /// What acts besides, whatever the increment (N, N, N m; load axes at the start, about the origin).
    pub constant_wrench: Vec3,
}

impl<'a> Potential<'a> {
    /// That of springs alone, at the end of the step.
    pub fn of(springs: &'a mut SpringBlocks, start: Place) -> Self {
        Self { start, springs, dashpots: None, inertia: None, springs_at: None, constant_wrench: Vec3::zeros() }
    }
}

/// Springs act at offset + share y while the load's own way is y, both straight: shifts along the axes at the start of the step, and a turn. Inertia resists y as well, so
/// that its force and theirs balance where they are one force; by twists that lead to two places they would leave a torque. Energy of the springs counts over the share,
/// so that its derivative by y is the force there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage {
    /// Shift along the axes at the start of the step, and turn (m, m, rad).
    pub offset: Vec3,
    /// (1)
    pub share: f64,
}

impl Stage {
    /// Where that is for a load that has gone the `way` from `start`, and how far its axes have turned by then.
    pub fn place(&self, start: &Place, way: &Vec3) -> (Place, Mat2) {
        let way = self.offset + self.share * way;
        let turned = Arc::of(way.z).rotation();
        let Pose { position, heading } = start.pose;
        let pose = Pose { position: position + start.turn * way.xy(), heading: heading + way.z };
        (Place::turned(pose, start.turn * turned.column(0)), turned)
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

/// Minimises over increments, near a `guess` if that is good and from rest else. `length` (m) is the extent of the load, which makes turns and shifts
/// comparable.
pub fn minimise(potential: Potential, ground: &Ground, solver: &mut FrictionSolver, length: f64, guess: Option<Vec3>) -> Increment {
    let mut step = Step { potential, ground, length };
    let guess = guess.filter(|_| solver.accuracy() == 0.0);
    if let Some(found) = guess.and_then(|guess| glide(&mut step, solver, length, guess, None, Wanted::Only)) {
        return step.found(&found.at, found.regime, found.report);
    }
    step.rest(solver).unwrap_or_else(|| step.descend_from_rest(solver))
}

/// One step to be found.
struct Step<'a> {
    potential: Potential<'a>,
    ground: &'a Ground,
    /// Extent of the load (m).
    length: f64,
}

impl Step<'_> {
    fn found(&self, twist: &Vec3, regime: Regime, report: StepReport) -> Increment {
        Increment {
            twist: *twist,
            shift: shift_of(&self.potential.start.turn, twist),
            friction: friction_loss(self.ground, twist),
            regime,
            report,
        }
    }

    /// Of a body twist, with turns and shifts made comparable.
    fn size(&self, twist: &Vec3) -> f64 {
        twist.xy().norm() / self.length + twist.z.abs()
    }

    /// Where the springs act for the increment `twist` along `arc`, and what takes the axes there to those at its end.
    fn place(&self, twist: &Vec3, arc: &Arc) -> (Place, Option<(f64, Mat2)>) {
        let start = &self.potential.start;
        let Some(stage) = self.potential.springs_at else { return (start.moved(&twist.xy(), arc), None) };
        let (place, turned) = stage.place(start, &arc.shift(&twist.xy()).push(twist.z));
        (place, Some((stage.share, turned.transpose() * arc.rotation())))
    }
}

/// Of places that are this far from the world's origin (m), over the `extent` of a load (m): that of their coordinates, and of lengths between them.
pub fn rounding_of_places(position: &Vec2, extent: f64) -> f64 {
    8.0 * f64::EPSILON * position.norm() / extent
}

impl Objective for Step<'_> {
    fn rounding(&self) -> f64 {
        rounding_of_places(&self.potential.start.pose.position, self.length)
    }

    fn at(&mut self, twist: &Vec3) -> Reaction {
        let arc = Arc::of(twist.z);
        let (place, stage) = self.place(twist, &arc);
        let mut sum = self.potential.springs.reaction(&place);
        if let Some(dashpots) = &mut self.potential.dashpots {
            sum.add(&dashpots.reaction(&place));
        }
        if let Some((share, axes)) = stage {
            sum = sum.in_axes(&axes);
            sum.energy /= share;
            sum.hessian *= share;
        }
        if let Some(coasting) = &self.potential.inertia {
            sum.add(&coasting.reaction(&self.potential.start.turn, twist, &arc));
        }
        let mut sum = by_increment(&sum, &arc, &twist.xy());
        sum.energy -= self.potential.constant_wrench.dot(twist);
        sum.gradient -= self.potential.constant_wrench;
        sum
    }

    fn gradient(&mut self, twist: &Vec3) -> Vec3 {
        let arc = Arc::of(twist.z);
        let (place, stage) = self.place(twist, &arc);
        let mut sum = self.potential.springs.gradient(&place);
        if let Some(dashpots) = &mut self.potential.dashpots {
            sum += dashpots.gradient(&place);
        }
        if let Some((_, axes)) = stage {
            sum = axes.tr_mul(&sum.xy()).push(sum.z);
        }
        if let Some(coasting) = &self.potential.inertia {
            sum += coasting.reaction(&self.potential.start.turn, twist, &arc).gradient;
        }
        slope_by_increment(&sum, &arc, &twist.xy()) - self.potential.constant_wrench
    }
}

/// Energy that the supports lose along a constant-twist path (J).
pub fn friction_loss(ground: &Ground, twist: &Vec3) -> f64 {
    ground.supports.iter().zip(ground.slip_limits()).map(|(support, limit)| limit * slip_velocity(&support.offset, twist).norm()).sum()
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

/// The first derivative of [`by_increment`] alone.
fn slope_by_increment(gradient: &Vec3, arc: &Arc, shift: &Vec2) -> Vec3 {
    let force = gradient.xy();
    (arc.mean_rotation() * force).push((arc.first_at_end() * shift).dot(&force) + gradient.z)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::Status;
    use crate::backend::springs::Attachments;
    use crate::math::{Pose, RandomStreams, Stream, direction, rotation};
    use crate::model::{PolarSpring, SupportPoint};

    pub(super) fn ground() -> Ground {
        let supports = [0.5, 2.6, 4.7].map(|angle| SupportPoint { offset: 0.0081333 * direction(angle), normal_load: 0.005232 });
        Ground { friction_coefficient: 1.4, supports: supports.to_vec() }
    }

    /// A forecast that is off by a tenth leads to the increment that descent from rest finds, whether the load slips or turns about a support. Newton's method ends at rounding: 1e-12 of the increment, and of its friction.
    #[test]
    fn a_forecast_leads_where_descent_from_rest_does() {
        let (ground, start) = (ground(), Pose::new(0.1, -0.05, 0.7));
        let mut n_found = [0; 2];
        for case in 0..1000 {
            let streams = RandomStreams::new(case);
            let draw = |k: u64| 2.0 * streams.uniform(Stream::Start, 0, k) - 1.0;
            let n = 1 + case as usize % 3;
            let springs: Vec<PolarSpring> = (0..n as u32).map(|k| spring(0.4 + 2.0 * f64::from(k))).collect();
            let mut held = Attachments::default();
            for (k, spring) in springs.iter().enumerate() {
                let way = 0.025 * Vec2::new(1.0 + draw(2 * k as u64), draw(2 * k as u64 + 1));
                let tip = start.to_world(&(spring.rest_tip() + rotation(spring.bearing) * way));
                held.attach(&springs, k, tip, &start);
            }
            let mut blocks = SpringBlocks::default();
            blocks.gather(&springs, &held);
            blocks.start(&Place::of(&start));
            let mut solver = FrictionSolver::new(&ground, 0.0122);
            let mut find = |guess| minimise(Potential::of(&mut blocks, Place::of(&start)), &ground, &mut solver, 0.0122, guess);
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

    pub(super) fn spring(bearing: f64) -> PolarSpring {
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
