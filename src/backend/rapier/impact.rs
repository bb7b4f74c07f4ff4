//! Newton's impact law with Coulomb friction in the solver of rapier, for one precision. The file
//! is included twice, like `world.rs`.
//!
//! The engine applies restitution once a step, after its solver, along the normals alone: friction
//! then never sees the impulse of the bounce, and of the rest it sees what is left after the gap is
//! closed. Here the solver itself finds the whole impact. It requires of a contact at the distance
//! `d` the normal velocity `-d / h` at the end of a step `h`, and limits friction by the impulse
//! that this takes. A contact that bounces is given the distance that requires the velocity after
//! the impact, and no restitution.

use super::Real;
use super::convert::{narrow, wide, widened};
use super::engine::prelude::{ColliderHandle, ContactModificationContext, PhysicsHooks};
use super::obstacles::Obstacles;
use crate::backend::rapier::contacts::{ContactPoint, ObstacleStep, normal_of_sides};
use crate::math::{Twist, Vec2};

/// The law for the contacts of a step.
pub struct ImpactLaw<'a> {
    pub shapes: &'a Obstacles,
    pub obstacles: &'a [ObstacleStep],
    /// Collider of the load.
    pub load: ColliderHandle,
    /// Position and twist of the load at the start of the step.
    pub position: Vec2,
    pub twist: Twist,
    /// (s)
    pub duration: f64,
    /// Largest velocity at which a penetration is removed (m/s).
    pub fastest: f64,
    /// Velocity over depth that the engine requires of a penetration (1/s).
    pub rate: Real,
}

impl PhysicsHooks for ImpactLaw<'_> {
    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        let load_is_first = context.collider1 == self.load;
        let other = if load_is_first { context.collider2 } else { context.collider1 };
        let index = context.colliders[other].user_data as usize;
        let Some(manifold) = context.rigid_mut() else { return };
        *manifold.restitution = 0.0;
        let sign = if load_is_first { -1.0 } else { 1.0 };
        let mut normal = sign * wide(*manifold.normal);
        if let [a, b] = &manifold.solver_contacts[..] {
            let arms = [a, b].map(|contact| 0.5 * (wide(contact.anchor1) + wide(contact.anchor2)) - self.position);
            let right = normal_of_sides(normal, arms, [a, b].map(|contact| widened(contact.dist)));
            if right != normal {
                (normal, *manifold.normal) = (right, narrow(&(sign * right)));
            }
        }
        let along = *manifold.normal;
        for contact in manifold.solver_contacts.iter_mut() {
            let point = if load_is_first { contact.anchor1 } else { contact.anchor2 };
            let found = self.contact(index, wide(point), normal, widened(contact.dist));
            let room = found.room_in(&self.twist, self.duration, self.fastest);
            if room != found.gap {
                contact.dist = (room / self.duration) as Real / self.rate;
                // The engine takes the middle of both anchors as the point of contact. That is the
                // point of the load, which the obstacle meets within the step.
                let half = along * (0.5 * contact.dist);
                (contact.anchor1, contact.anchor2) = (point - half, point + half);
            }
        }
    }
}

impl ImpactLaw<'_> {
    fn contact(&self, index: usize, point: Vec2, normal: Vec2, gap: f64) -> ContactPoint {
        let step = &self.obstacles[index];
        let velocity = step.twist.velocity_at(&(point - step.start.position));
        ContactPoint { velocity, ..self.shapes.list[index].contact(point - self.position, normal, gap) }
    }
}
