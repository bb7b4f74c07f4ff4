//! The potential of a step: springs, dashpots, inertia and a constant wrench, with their
//! derivatives by the increment.

use super::objective::{Objective, rounding_of_places};
use crate::backend::friction::ContactMode;
use crate::backend::friction::cones::slip_gram;
use crate::backend::report::StepReport;
use crate::backend::springs::{Place, SpringBlocks, Travel};
use crate::math::{Arc, Mat2, Mat3, Pose, Twist, Vec2, Vec3, shift_of};
use crate::model::support::{slip_velocity, wrench_of};
use crate::model::{Ground, Load, Reaction, SupportPoint};

/// What the increment minimises, besides friction.
pub struct Potential<'a> {
    /// Place of the load at the start of the step.
    pub start: Place,
    /// Springs with their tips where the step evaluates them.
    pub springs: &'a mut SpringBlocks,
    /// Dashpots as springs of this step.
    pub dashpots: Option<&'a mut SpringBlocks>,
    /// Inertia of the load; `None` neglects it.
    pub inertia: Option<Coasting>,
    /// Place at which the springs act; `None` for the end of the step, along a constant body twist.
    pub springs_at: Option<Stage>,
    /// Wrench that acts besides (N, N, N m; load axes at the start, about the origin).
    pub constant_wrench: Vec3,
}

impl<'a> Potential<'a> {
    /// Potential of springs alone, at the end of the step.
    pub fn of(springs: &'a mut SpringBlocks, start: Place) -> Self {
        Self { start, springs, dashpots: None, inertia: None, springs_at: None, constant_wrench: Vec3::zeros() }
    }
}

/// Stage of a step: springs act at offset + share y while the load moves by y. Both are straight: a
/// shift along the axes at the start of the step, and a turn. Inertia resists y as well, so that
/// its force and theirs balance at one point; twists to two places would leave a torque. The energy
/// of the springs is divided by the share, so that its derivative by y is the force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage {
    /// Shift along the axes at the start of the step, and turn (m, m, rad).
    pub offset: Vec3,
    /// (1)
    pub share: f64,
}

impl Stage {
    /// Place of the stage for a load that has moved by `y` from `start`, and the turn of its axes.
    pub fn place(&self, start: &Place, y: &Vec3) -> (Place, Mat2) {
        let moved = self.offset + self.share * y;
        let turned = Arc::of(moved.z).rotation();
        let Pose { position, heading } = start.pose;
        let pose = Pose { position: position + start.turn * moved.xy(), heading: heading + moved.z };
        (Place::turned(pose, start.turn * turned.column(0)), turned)
    }
}

/// Inertia of the load as a spring to the pose that it would coast to. It holds shift and turn,
/// because over a short step the difference of two poses has too few digits for the line search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coasting {
    /// Shift of the load's origin within the step if no force acted (m, world).
    pub shift: Vec2,
    /// Turn within the step if no torque acted (rad).
    pub turn: f64,
    /// Mass and moment of inertia over the squared step (N/m, N m/rad).
    pub stiffness: (f64, f64),
}

/// Increment that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Increment {
    /// Body-twist increment (m, m, rad).
    pub twist: Vec3,
    /// Shift of the load's origin (m, world).
    pub shift: Vec2,
    /// Energy lost to friction (J).
    pub friction: f64,
    pub mode: ContactMode,
    pub report: StepReport,
}

/// A step to be found.
pub struct Step<'a> {
    pub potential: Potential<'a>,
    pub ground: &'a Ground,
    /// Extent of the load (m).
    pub length: f64,
}

/// An objective with what contacts need of it: how an increment moves the load.
pub trait Course: Objective {
    /// What all places at one increment have in common.
    type Moved;

    fn ground(&self) -> &Ground;

    /// Extent of the load (m).
    fn length(&self) -> f64;

    fn moved(&self, at: &Vec3) -> Self::Moved;

    /// Displacement of the load by an increment, seen in the frame in which it is at `start` when
    /// the step begins.
    fn seen(&self, start: &Place, at: &Vec3, moved: &Self::Moved) -> Travel;

    /// Derivatives by shifts along the load's axes and by its turn, transformed to derivatives by
    /// the increment.
    fn by_increment(&self, local: &Reaction, at: &Vec3, moved: &Self::Moved) -> Reaction;

    fn found(&self, at: &Vec3, mode: ContactMode, report: StepReport) -> Increment;

    /// Size of an increment: shift over the extent of the load plus turn (1).
    fn size(&self, at: &Vec3) -> f64 {
        at.xy().norm() / self.length() + at.z.abs()
    }
}

impl Course for Step<'_> {
    type Moved = Arc;

    fn ground(&self) -> &Ground {
        self.ground
    }

    fn length(&self) -> f64 {
        self.length
    }

    fn moved(&self, at: &Vec3) -> Arc {
        Arc::of(at.z)
    }

    fn seen(&self, start: &Place, at: &Vec3, arc: &Arc) -> Travel {
        Travel { shift: start.turn * arc.shift(&at.xy()), arc: *arc }
    }

    fn by_increment(&self, local: &Reaction, at: &Vec3, arc: &Arc) -> Reaction {
        by_increment(local, arc, &at.xy())
    }

    fn found(&self, twist: &Vec3, mode: ContactMode, report: StepReport) -> Increment {
        Increment {
            twist: *twist,
            shift: shift_of(&self.potential.start.turn, twist),
            friction: friction_loss(self.ground, twist),
            mode,
            report,
        }
    }
}

impl Step<'_> {
    /// Place at which the springs act for the increment `twist` along `arc`. With a stage, also its
    /// share and the rotation from the axes there to those at the end.
    fn place(&self, twist: &Vec3, arc: &Arc) -> (Place, Option<(f64, Mat2)>) {
        let start = &self.potential.start;
        let Some(stage) = self.potential.springs_at else { return (start.moved(&twist.xy(), arc), None) };
        let (place, turned) = stage.place(start, &arc.shift(&twist.xy()).push(twist.z));
        (place, Some((stage.share, turned.transpose() * arc.rotation())))
    }
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

/// Energy lost to friction along a constant-twist path (J).
pub fn friction_loss(ground: &Ground, twist: &Vec3) -> f64 {
    ground.supports.iter().zip(ground.slip_limits()).map(|(support, limit)| limit * slip_velocity(&support.offset, twist).norm()).sum()
}

/// First derivative of [`friction_loss`] by a twist at which all supports slip (N, N, N m).
pub fn friction_force(ground: &Ground, twist: &Vec3) -> Vec3 {
    let of =
        |(support, limit): (&SupportPoint, f64)| wrench_of(&support.offset, &(limit * slip_velocity(&support.offset, twist).normalize()));
    ground.supports.iter().zip(ground.slip_limits()).map(of).sum()
}

/// Second derivative of [`friction_loss`] by the twist (N/m, N, N m/rad): the limit of each support
/// over its slip, across the slip. It is zero along the twist itself. A support that slips by less
/// than `least` (m) counts as held, in all directions.
pub fn friction_curvature(ground: &Ground, twist: &Vec3, least: f64) -> Mat3 {
    let of = |(support, limit): (&SupportPoint, f64)| {
        let slip = slip_velocity(&support.offset, twist);
        let speed = slip.norm();
        if speed <= least {
            return limit / least * slip_gram(&support.offset);
        }
        let unit = slip / speed;
        let across = Vec3::new(-unit.y, unit.x, support.offset.dot(&unit));
        limit / speed * across * across.transpose()
    };
    ground.supports.iter().zip(ground.slip_limits()).map(of).sum()
}

impl Coasting {
    /// Inertia of a load with `twist` over `step` (s).
    pub fn of(load: &Load, twist: &Twist, step: f64) -> Self {
        Self {
            shift: step * twist.linear,
            turn: step * twist.angular,
            stiffness: (load.mass / (step * step), load.inertia / (step * step)),
        }
    }

    /// Energy with its derivatives by a shift along these `axes`, and by a turn, at both.
    pub(super) fn straight(&self, axes: &Mat2, at: &Vec3) -> Reaction {
        let (linear, angular) = self.stiffness;
        let (away, turn) = (at.xy() - axes.tr_mul(&self.shift), at.z - self.turn);
        Reaction {
            energy: 0.5 * linear * away.norm_squared() + 0.5 * angular * turn * turn,
            gradient: (linear * away).push(angular * turn),
            hessian: Mat3::from_diagonal(&Vec3::new(linear, linear, angular)),
        }
    }

    /// Energy with its derivatives by shifts along the load's axes and by its turn, at the
    /// increment `twist` along `arc`. `turn` is the rotation from the axes at the start to world
    /// axes.
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

/// First derivative of [`by_increment`] alone.
fn slope_by_increment(gradient: &Vec3, arc: &Arc, shift: &Vec2) -> Vec3 {
    let force = gradient.xy();
    (arc.mean_rotation() * force).push((arc.first_at_end() * shift).dot(&force) + gradient.z)
}

/// Derivatives by shifts along the load's axes and by its turn, transformed to derivatives by the
/// increment (u, delta) of `x = x_0 + R V(delta) u`, `heading = heading_0 + delta` along `arc`,
/// with u the `shift` (m).
pub fn by_increment(local: &Reaction, arc: &Arc, shift: &Vec2) -> Reaction {
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

/// Derivatives by (x, y, heading) transformed to derivatives by an increment from there. `turn` is
/// the rotation from load axes to world axes.
pub fn in_body_increments(world: &Reaction, turn: &Mat2) -> Reaction {
    by_increment(&world.in_axes(turn), &Arc::of(0.0), &Vec2::zeros())
}
