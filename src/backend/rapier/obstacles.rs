//! Colliders of the load and of obstacles, and their contacts, for one precision. The file is
//! included twice, like `world.rs`.

use super::engine::prelude::{
    ActiveHooks, CoefficientCombineRule, Collider, ColliderBuilder, ColliderHandle, ColliderSet, ContactData, ContactManifold, Group,
    InteractionGroups, InteractionTestMode, NarrowPhase, Pose, SharedShape,
};

use super::Real;
use super::convert::{wide, widened};
use super::shapes::shape_of;
use crate::backend::rapier::contacts::{ContactPoint, normal_of_sides};
use crate::math::Vec2;
use crate::model::{Obstacle, World};

/// Groups of colliders: a load meets obstacles, and nothing else meets anything.
const LOADS: Group = Group::GROUP_1;
const OBSTACLES: Group = Group::GROUP_2;

/// Shapes of a world.
pub struct Obstacles {
    load: Option<(Pose, SharedShape)>,
    pub list: Vec<ObstacleShape>,
}

pub struct ObstacleShape {
    shape: Option<(Pose, SharedShape)>,
    index: usize,
    friction: f64,
    restitution: f64,
    pub moves: bool,
}

impl Obstacles {
    pub fn new(world: &World) -> Self {
        let list = world.obstacles.iter().enumerate().map(|(index, obstacle)| ObstacleShape::new(index, obstacle)).collect();
        Self { load: shape_of(&world.outline), list }
    }

    /// Adds the contacts of the load that `narrow_phase` holds, with the mean forces of a step of
    /// `duration` (s). The velocity of the obstacle and the room of the load are left out.
    pub fn read_contacts(
        &self,
        narrow_phase: &NarrowPhase,
        colliders: &ColliderSet,
        load: Option<ColliderHandle>,
        duration: Real,
        contacts: &mut Vec<ContactPoint>,
    ) {
        let Some(load) = load else { return };
        for pair in narrow_phase.contact_pairs_with(load) {
            let is_first = pair.collider1 == load;
            let other = if is_first { pair.collider2 } else { pair.collider1 };
            let obstacle = &self.list[colliders[other].user_data as usize];
            for manifold in pair.manifolds() {
                contacts.extend(obstacle.contacts_of(manifold, is_first, duration));
            }
        }
        // The order of pairs in the engine depends on how its lists grew.
        contacts.sort_by_key(|contact| contact.obstacle);
    }
}

/// Collider of the load, without mass, whose contacts call `hooks`. Its coefficients are the
/// largest, so that those of the obstacle count.
pub fn load_collider(world: &Obstacles, hooks: ActiveHooks) -> Option<Collider> {
    let (pose, shape) = world.load.clone()?;
    let mut collider = collider(pose, shape, LOADS, OBSTACLES, Real::MAX, Real::MAX);
    collider.set_active_hooks(hooks);
    Some(collider)
}

impl ObstacleShape {
    fn new(index: usize, obstacle: &Obstacle) -> Self {
        let Obstacle { outline, friction_coefficient, restitution, path, .. } = obstacle;
        Self { shape: shape_of(outline), index, friction: *friction_coefficient, restitution: *restitution, moves: path.moves() }
    }

    pub fn collider(&self) -> Option<Collider> {
        let (pose, shape) = self.shape.clone()?;
        let mut collider = collider(pose, shape, OBSTACLES, LOADS, self.friction as Real, self.restitution as Real);
        collider.user_data = self.index as u128;
        Some(collider)
    }

    /// Contacts of a manifold. The engine applies the impulses to the first body along the negative
    /// of its normal, and along the tangent a quarter turn on from there.
    fn contacts_of<'a>(
        &'a self,
        manifold: &'a ContactManifold,
        load_is_first: bool,
        duration: Real,
    ) -> impl Iterator<Item = ContactPoint> + 'a {
        let arm = move |data: &ContactData| wide(if load_is_first { data.solver_dp1 } else { data.solver_dp2 });
        let mut normal = if load_is_first { -wide(manifold.data.normal) } else { wide(manifold.data.normal) };
        if let [a, b] = manifold.data.solver_contacts[..] {
            let pair = [a, b].map(|contact| &manifold.points[contact.contact_indices()[0] as usize]);
            normal = normal_of_sides(normal, pair.map(|point| arm(&point.data)), pair.map(|point| widened(point.dist)));
        }
        let rate = if duration > 0.0 { 1.0 / widened(duration) } else { 0.0 };
        manifold.data.solver_contacts.iter().map(move |contact| {
            let point = &manifold.points[contact.contact_indices()[0] as usize];
            let data = &point.data;
            ContactPoint {
                push: rate * widened(data.impulse),
                rub: rate * widened(data.tangent_impulse.x),
                ..self.contact(arm(data), normal, widened(point.dist))
            }
        })
    }

    /// Contact at `arm` (m) with this `gap` (m), without a force and without any motion.
    pub fn contact(&self, arm: Vec2, normal: Vec2, gap: f64) -> ContactPoint {
        ContactPoint {
            obstacle: self.index,
            arm,
            normal,
            gap,
            room: gap,
            velocity: Vec2::zeros(),
            friction: self.friction,
            restitution: self.restitution,
            push: 0.0,
            rub: 0.0,
        }
    }
}

fn collider(pose: Pose, shape: SharedShape, member: Group, meets: Group, friction: Real, restitution: Real) -> Collider {
    ColliderBuilder::new(shape)
        .position(pose)
        .density(0.0)
        .friction(friction)
        .friction_combine_rule(CoefficientCombineRule::Min)
        .restitution(restitution)
        .restitution_combine_rule(CoefficientCombineRule::Min)
        .collision_groups(InteractionGroups::new(member, meets, InteractionTestMode::And))
        .build()
}
