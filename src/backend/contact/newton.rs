//! Newton's method on the equations of `step` in given contact modes, with the curvature of
//! springs, gaps and slips.

use smallvec::SmallVec;

use super::candidates::{ContactStep, Local, Locals, Sides};
use super::linear::{Linear, Rows};
use super::solve::{Basis, SideForce, SideMode};
use crate::backend::increment::Course;
use crate::backend::numerics::{BALANCED, CLOSED_GAP, CONTACT_ITERATIONS, LONGEST_TURN, MOST_ABOUT_PIVOT, PARALLEL_NORMALS, STALLED};
use crate::backend::report::StepReport;
use crate::math::{Mat3, Vec2, Vec3};
use crate::model::support::{slip_velocity, wrench_of};
use crate::model::{Ground, Reaction};

/// Answer of Newton's method.
pub struct Newton {
    /// Increment (m, m, rad).
    pub at: Vec3,
    pub sides: Sides,
    /// Whether no other contact forces balance the load.
    pub are_forces_unique: bool,
    /// Whether a small disturbance of the answer does not grow.
    pub is_stable: bool,
    pub report: StepReport,
}

/// Support about which the load turns.
struct Pin {
    /// (m, load axes)
    offset: Vec2,
    /// Its friction on the load (N, load axes).
    force: Vec2,
}

impl<C: Course> ContactStep<'_, C> {
    /// Newton's method from a guess, for a load that slips on all supports in these contact modes,
    /// or on all but the one at `pivot` (m, load axes), about which it turns. `None` where it does
    /// not lead to an answer, or to another one.
    pub fn newton(&mut self, sides: &Sides, guess: Vec3, pivot: Option<Vec2>) -> Option<Newton> {
        let n_unknown: usize = sides.iter().map(|(mode, _)| n_forces(*mode)).sum();
        let most = if pivot.is_some() { MOST_ABOUT_PIVOT } else { Rows::BITS as usize };
        if n_unknown > most || guess == Vec3::zeros() {
            return None;
        }
        let mut pin = pivot.map(|offset| Pin { offset, force: Vec2::zeros() });
        let (mut at, mut sides) = (guess, sides.clone());
        let mut last = f64::INFINITY;
        // Both are filled anew in each iteration, and are too large to be passed around.
        let (mut system, mut locals) = (Linear::new(self.step.length()), Locals::new());
        if n_unknown > 2 {
            self.fill_locals(&guess, &mut locals);
            self.keep_ends(&mut sides, &locals);
        }
        if sides.iter().map(|(mode, _)| n_forces(*mode)).sum::<usize>() > 3 {
            system.hold(self.dependent(&sides, &locals));
        }
        for iteration in 0..CONTACT_ITERATIONS {
            self.newton_system(&at, pin.as_ref(), &sides, &mut system, &mut locals)?;
            let residual = system.residual();
            let is_done = residual <= BALANCED || residual <= STALLED && residual >= 0.5 * last;
            if is_done {
                if !self.is_admissible(&sides, &locals) {
                    return None;
                }
                let n_iterations = iteration as u64;
                let report = StepReport { residual, n_steps: 1, n_solves: 1, n_iterations, ..StepReport::default() };
                return Some(Newton { at, sides, are_forces_unique: !system.holds_any(), is_stable: system.is_stable(), report });
            }
            last = residual;
            let change = system.solve()?;
            let moved = Vec3::new(change[0], change[1], change[2]);
            if self.step.size(&moved) > 3.0 * self.step.size(&at) || moved.z.abs() > LONGEST_TURN {
                return None;
            }
            at += moved;
            let mut forces = change[3..].iter();
            if let Some(Pin { force, .. }) = &mut pin {
                force.iter_mut().for_each(|entry| *entry += forces.next().expect("a force for each row"));
            }
            for ((mode, force), candidate) in sides.iter_mut().zip(self.candidates) {
                match mode {
                    SideMode::Open => *force = SideForce::default(),
                    SideMode::Stick => {
                        force.normal += forces.next().expect("a force for each row");
                        force.tangential += forces.next().expect("a force for each row");
                    }
                    SideMode::Slide { forward } => {
                        force.normal += forces.next().expect("a force for each row");
                        let sign = if *forward { -1.0 } else { 1.0 };
                        force.tangential = sign * candidate.pair.friction_coefficient * force.normal;
                    }
                }
            }
        }
        None
    }

    /// Equations of the modes at an increment with these forces. `None` where a support stands
    /// still besides the pinned one.
    fn newton_system(&mut self, at: &Vec3, pin: Option<&Pin>, sides: &Sides, system: &mut Linear, locals: &mut Locals) -> Option<()> {
        self.fill_locals(at, locals);
        let Reaction { mut gradient, mut hessian, .. } = self.step.at(at);
        let force_scale = add_ground_friction(self.step.ground(), at, pin, &mut gradient, &mut hessian)?;
        system.begin(force_scale + gradient.xy().norm(), self.step.size(at) * self.step.length());
        if let Some(Pin { offset, force }) = pin {
            gradient -= wrench_of(offset, force);
            let slip = slip_velocity(offset, at);
            for (along, slip) in [(Vec2::x(), slip.x), (Vec2::y(), slip.y)] {
                let row = wrench_of(offset, &along);
                system.push(row, row, slip);
            }
        }
        for (((mode, force), local), candidate) in sides.iter().zip(&*locals).zip(self.candidates) {
            if *mode == SideMode::Open {
                continue;
            }
            gradient -= force.normal * local.gap.gradient + force.tangential * local.slip.gradient;
            hessian -= force.normal * local.gap.hessian + force.tangential * local.slip.hessian;
            let friction = candidate.pair.friction_coefficient;
            match mode {
                SideMode::Slide { forward } => {
                    let sign = if *forward { -1.0 } else { 1.0 };
                    let along = local.gap.gradient + sign * friction * local.slip.gradient;
                    system.push(local.gap.gradient, along, local.gap.energy);
                }
                _ => {
                    system.push(local.gap.gradient, local.gap.gradient, local.gap.energy);
                    system.push(local.slip.gradient, local.slip.gradient, local.slip.energy);
                }
            }
        }
        system.set_balance(gradient, hessian);
        Some(())
    }

    /// Opens contacts between two others of the same face, and gives their forces to these. A face
    /// on flush obstacles touches by many contacts; the two at its ends hold it like all of them,
    /// and push wherever all of them can.
    fn keep_ends(&self, sides: &mut Sides, locals: &[Local]) {
        // In load axes, the torque of a normal force is its place along the face.
        let normal = |index: usize| locals[index].gap.gradient.xy();
        let place = |index: usize| locals[index].gap.gradient.z;
        for first in 0..sides.len() {
            let (mode, friction) = (sides[first].0, self.candidates[first].pair.friction_coefficient);
            let is_alike = |index: &usize| {
                sides[*index].0 == mode
                    && self.candidates[*index].pair.friction_coefficient == friction
                    && (normal(*index) - normal(first)).norm() <= PARALLEL_NORMALS
            };
            let face: SmallVec<[usize; 8]> = (first..sides.len()).filter(is_alike).collect();
            if mode == SideMode::Open || face.len() < 3 {
                continue;
            }
            let by_place = |a: &&usize, b: &&usize| place(**a).total_cmp(&place(**b));
            let [low, high] = [face.iter().min_by(by_place), face.iter().max_by(by_place)].map(|end| *end.expect("three contacts"));
            let width = place(high) - place(low);
            for index in face.into_iter().filter(|index| *index != low && *index != high) {
                let share = if width > 0.0 { (place(index) - place(low)) / width } else { 0.0 };
                let (_, SideForce { normal, tangential }) = std::mem::replace(&mut sides[index], (SideMode::Open, SideForce::default()));
                for (end, share) in [(low, 1.0 - share), (high, share)] {
                    sides[end].1.normal += share * normal;
                    sides[end].1.tangential += share * tangential;
                }
            }
        }
    }

    /// Constraints that depend on the three with the most room for their forces: a face that sticks
    /// to another one by both of its corners has one more than the load can break.
    fn dependent(&self, sides: &Sides, locals: &[Local]) -> Rows {
        let in_units = |row: &Vec3| Vec3::new(row.x, row.y, row.z / self.step.length());
        let mut rows: SmallVec<[(f64, Vec3); 8]> = SmallVec::new();
        for (((mode, force), local), candidate) in sides.iter().zip(locals).zip(self.candidates) {
            if *mode != SideMode::Open {
                rows.push((force.normal, in_units(&local.gap.gradient)));
            }
            if *mode == SideMode::Stick {
                let room = candidate.pair.friction_coefficient * force.normal - force.tangential.abs();
                rows.push((room, in_units(&local.slip.gradient)));
            }
        }
        let mut order: SmallVec<[usize; 8]> = (0..rows.len()).collect();
        order.sort_by(|i, j| rows[*j].0.total_cmp(&rows[*i].0));
        let mut basis = Basis::default();
        order.into_iter().filter(|index| !basis.takes(&rows[*index].1)).fold(0, |held, index| held | 1 << index)
    }

    /// Whether the forces push, the signs of slip are those of the modes, and no other pair of
    /// features overlaps.
    fn is_admissible(&self, sides: &Sides, locals: &[Local]) -> bool {
        let closed = CLOSED_GAP * self.step.length();
        sides.iter().zip(locals).zip(self.candidates).all(|(((mode, force), local), candidate)| {
            let slip = local.slip.energy;
            let friction = candidate.pair.friction_coefficient;
            let touches = local.beyond <= closed && force.normal >= 0.0;
            match mode {
                SideMode::Open => local.gap.energy >= -closed || local.beyond > 0.0,
                SideMode::Stick => touches && force.tangential.abs() <= friction * force.normal,
                SideMode::Slide { forward } => touches && (friction == 0.0 || (slip >= 0.0) == *forward || slip.abs() <= closed),
            }
        })
    }
}

/// Adds the friction of the ground of a load that slips on all supports, or all but the pinned one,
/// and its derivative. Returns the sum of the slip limits (N); `None` where another support stands
/// still.
fn add_ground_friction(ground: &Ground, at: &Vec3, pin: Option<&Pin>, gradient: &mut Vec3, hessian: &mut Mat3) -> Option<f64> {
    let mut total = 0.0;
    for (support, limit) in ground.supports.iter().zip(ground.slip_limits()) {
        if limit == 0.0 {
            continue;
        }
        if pin.is_some_and(|pin| pin.offset == support.offset) {
            total += limit;
            continue;
        }
        let slip = slip_velocity(&support.offset, at);
        let speed = slip.norm();
        if speed == 0.0 {
            return None;
        }
        let (direction, stiffness) = (slip * speed.recip(), limit * speed.recip());
        *gradient += wrench_of(&support.offset, &(limit * direction));
        // B' (1 - u u') B = b b' with b the row of B across the slip.
        let across = Vec2::new(-direction.y, direction.x);
        let row = wrench_of(&support.offset, &across);
        *hessian += stiffness * row * row.transpose();
        total += limit;
    }
    Some(total)
}

/// Number of unknown forces of a contact.
fn n_forces(mode: SideMode) -> usize {
    match mode {
        SideMode::Open => 0,
        SideMode::Stick => 2,
        SideMode::Slide { .. } => 1,
    }
}
