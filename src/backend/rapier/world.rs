//! Bodies and joints of rapier for one precision. The file is included twice; `Real` and the crate
//! are set by the module that includes it.

use super::engine::prelude::{
    ActiveHooks, CCDSolver, ColliderHandle, ColliderSet, DefaultBroadPhase, GenericJoint, ImpulseJointHandle, ImpulseJointSet,
    IntegrationParameters, IslandManager, JointAxesMask, JointAxis, JointMotor, MassProperties, MotorModel, MultibodyJointSet, NarrowPhase,
    PhysicsHooks, PhysicsPipeline, Pose, RigidBodyBuilder, RigidBodyHandle, RigidBodySet, SoftBodySet, SpringCoefficients, Vector,
};
use crate::backend::numerics::FASTEST_CORRECTION;

use super::Real;
use super::convert::{narrow, pose_of, unit, wide, widened};
use super::impact::ImpactLaw;
use super::obstacles::{Obstacles, load_collider};
use crate::backend::rapier::contacts::{ContactPoint, ObstacleStep};
use crate::backend::rapier::joints::{AxisLaw, BodyState, Engine, FrictionJoint, SpringJoint, StepInputs};
use crate::backend::rapier::{EngineSettings, FrictionModel, RapierOptions};
use crate::math::{Twist, Vec2, Vec3, Wrench, perpendicular};
use crate::model::System;

/// Solver iterations over the joints in one step. They start from zero impulses in every step, so a
/// load that they do not quite stop creeps on. Largest residual after 8, 16 and 24 iterations, for
/// springs of the paper all around its load and aligned friction: 1e-11, 3e-16, 3e-16 for four
/// springs at 1 ms; 2e-5, 1e-9, 1e-13 for ten at 2.5 ms; 9e-6, 4e-10, 4e-14 for a hundred at 1 ms.
/// Fixed axes share a pull and reach their limits one after another. At 0.9 of the slip limit a
/// polygon creeps by 1e-10 m/s after 24 iterations, and not at all after 48; at 0.98 it creeps by
/// 4e-7 m/s.
fn n_iterations(friction: FrictionModel) -> usize {
    match friction {
        FrictionModel::Aligned => 24,
        FrictionModel::Polygon | FrictionModel::Box => 48,
    }
}

/// Least h^2 k + h d of a motor (kg, or kg m^2). Rapier treats values below 1e-20 as zero and the
/// motor as a lock. A mass of 1e-18 kg is negligible beside that of the load.
const SOFTEST: Real = 1e-18;

/// Contacts that are rigid at any step, with their natural frequency (Hz). Those of the engine are
/// springs of 30 and 60 Hz, in which a wall gives way by 58 um to 13 mN on 1.6 g. At 1e6 Hz a disc
/// that hits a wall leaves it again by 0.02 um in steps of 50 us, at 1e9 Hz by 2e-14 m.
const RIGID: SpringCoefficients<Real> = SpringCoefficients { natural_frequency: 1e9, damping_ratio: 1.0 };

/// One load in rapier. Without obstacles its collision stage finds empty lists; this takes a
/// fiftieth of a step with four springs, and the public pipeline has no step without it. Sleep,
/// handlers, hooks and new searches for islands are left out.
pub struct World {
    mass: Real,
    inertia: Real,
    settings: EngineSettings,
    /// Largest velocity at which a penetration is removed (m/s).
    fastest: f64,
    parameters: IntegrationParameters,
    /// Sweeps over all joints and contacts in a substep.
    n_sweeps: usize,
    obstacles: Option<Obstacles>,
    sets: Sets,
}

/// Parts that [`Engine::rebuild`] makes anew.
struct Sets {
    pipeline: PhysicsPipeline,
    islands: IslandManager,
    broad_phase: DefaultBroadPhase,
    narrow_phase: NarrowPhase,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    joints: ImpulseJointSet,
    multibody_joints: MultibodyJointSet,
    soft_bodies: SoftBodySet,
    ccd: CCDSolver,
    load: RigidBodyHandle,
    /// Collider of the load; `None` without obstacles.
    load_collider: Option<ColliderHandle>,
    /// Bodies of the obstacles in their order.
    obstacles: Vec<RigidBodyHandle>,
    friction: Vec<ImpulseJointHandle>,
    springs: Vec<ImpulseJointHandle>,
}

impl World {
    /// World with the load of `system` alone. The first rebuild adds joints and obstacles.
    pub fn new(system: &System, body: &BodyState, options: &RapierOptions) -> Self {
        let (mass, inertia) = (system.load.mass as Real, system.load.inertia as Real);
        let mut parameters = parameters(options);
        let obstacles = (!system.world.is_empty()).then(|| Obstacles::new(&system.world));
        if obstacles.is_some() && options.settings == EngineSettings::Recommended {
            set_contacts(&mut parameters, system.load.radius as Real);
        }
        let n_sweeps = parameters.num_internal_pgs_iterations;
        let (settings, fastest) = (options.settings, FASTEST_CORRECTION * system.load.radius);
        Self { mass, inertia, settings, fastest, parameters, n_sweeps, obstacles, sets: Sets::new(mass, inertia, body, 0, 0) }
    }

    fn substep(&self) -> Real {
        self.parameters.dt / self.parameters.num_solver_iterations as Real
    }

    /// The law of impacts in a step of the present duration; `None` where the engine's own holds.
    fn impact_law<'a>(&self, shapes: &'a Obstacles, obstacles: &'a [ObstacleStep]) -> Option<ImpactLaw<'a>> {
        let load = self.sets.load_collider.filter(|_| self.settings == EngineSettings::Recommended)?;
        let (body, duration) = (self.body(), widened(self.parameters.dt));
        let rate = RIGID.erp_inv_dt(self.parameters.dt);
        let twist = Twist { linear: body.velocity, angular: body.turn_rate };
        Some(ImpactLaw { shapes, obstacles, load, position: body.position, twist, duration, fastest: self.fastest, rate })
    }
}

fn parameters(options: &RapierOptions) -> IntegrationParameters {
    match options.settings {
        EngineSettings::EngineDefaults => IntegrationParameters::default(),
        EngineSettings::Recommended => IntegrationParameters {
            // Steps are divided outside: within a step the direction of friction would not follow.
            num_solver_iterations: 1,
            num_internal_pgs_iterations: n_iterations(options.friction),
            num_internal_stabilization_iterations: 0,
            max_ccd_substeps: 0,
            normalized_max_linear_velocity: Real::MAX,
            ..IntegrationParameters::default()
        },
    }
}

/// Sets what matters for contacts of a load of this `extent` (m). The engine's unit of length is
/// the size of its objects: with a metre for a load of 12 mm it would freeze contacts until the
/// load has moved by 50 mm.
fn set_contacts(parameters: &mut IntegrationParameters, extent: Real) {
    parameters.length_unit = extent;
    parameters.contact_softness = RIGID;
    parameters.static_contact_softness = RIGID;
    parameters.contact_recycling = false;
    // Penetrations are limited by the law of impacts, which needs any velocity.
    parameters.normalized_max_corrective_velocity = Real::MAX;
}

impl Engine for World {
    fn body(&self) -> BodyState {
        let load = &self.sets.bodies[self.sets.load];
        let rotation = load.rotation();
        BodyState {
            position: wide(load.translation()),
            rotation: Vec2::new(widened(rotation.re), widened(rotation.im)),
            velocity: wide(load.linvel()),
            turn_rate: widened(load.angvel()),
        }
    }

    fn let_move(&mut self, obstacle: usize) -> bool {
        let shape = self.obstacles.as_mut().and_then(|shapes| shapes.list.get_mut(obstacle));
        shape.is_some_and(|shape| !std::mem::replace(&mut shape.moves, true))
    }

    fn rebuild(&mut self, body: &BodyState, n_friction: usize, n_springs: usize, obstacles: &[ObstacleStep]) {
        self.sets = Sets::new(self.mass, self.inertia, body, n_friction, n_springs);
        if let Some(shapes) = &self.obstacles {
            let hooks = match self.settings {
                EngineSettings::Recommended => ActiveHooks::MODIFY_SOLVER_CONTACTS,
                EngineSettings::EngineDefaults => ActiveHooks::empty(),
            };
            self.sets.add_obstacles(shapes, obstacles, hooks);
        }
    }

    fn find_contacts(&mut self, reach: f64, contacts: &mut Vec<ContactPoint>) {
        let default = IntegrationParameters::default().normalized_prediction_distance;
        self.parameters.normalized_prediction_distance = default.max(reach as Real / self.parameters.length_unit);
        // Without time the engine finds contacts and moves nothing.
        self.sets.step(&IntegrationParameters { dt: 0.0, ..self.parameters }, &());
        self.read_contacts(contacts);
    }

    fn read_contacts(&self, contacts: &mut Vec<ContactPoint>) {
        contacts.clear();
        if let Some(shapes) = &self.obstacles {
            let sets = &self.sets;
            shapes.read_contacts(&sets.narrow_phase, &sets.colliders, sets.load_collider, self.parameters.dt, contacts);
        }
    }

    fn step(&mut self, duration: f64, inputs: &StepInputs) -> bool {
        let StepInputs { friction, springs, .. } = *inputs;
        assert_eq!(
            (friction.len(), springs.len()),
            (self.sets.friction.len(), self.sets.springs.len()),
            "joints are rebuilt when they change"
        );
        self.parameters.dt = duration as Real;
        self.parameters.num_internal_pgs_iterations = inputs.more_sweeps * self.n_sweeps;
        self.sets.set_joints(friction, springs, self.substep());
        if let Some(push) = inputs.push {
            self.sets.push(push);
        }
        self.sets.move_obstacles(inputs.obstacles);
        match self.obstacles.as_ref().and_then(|shapes| self.impact_law(shapes, inputs.obstacles)) {
            Some(law) => self.sets.step(&self.parameters, &law),
            None => self.sets.step(&self.parameters, &()),
        }
    }

    fn memory(&self) -> String {
        let sets = &self.sets;
        let mut joints = sets.joints.clone();
        // Each step sets the limits anew, and JSON has no infinity.
        joints.map_attached_joints_mut(sets.load, |_, _, _, joint| {
            joint.data.motors.iter_mut().for_each(|motor| motor.max_force = Real::MAX)
        });
        let memory = (&sets.islands, &sets.broad_phase, &sets.narrow_phase, &sets.bodies, &sets.colliders, &joints);
        serde_json::to_string(&memory).expect("the sets of the engine are plain data")
    }

    fn recall(&mut self, memory: &str) -> Result<(), serde_json::Error> {
        let sets = &mut self.sets;
        let n_expected = [sets.bodies.len(), sets.colliders.len(), sets.joints.len()];
        let read: (IslandManager, DefaultBroadPhase, NarrowPhase, RigidBodySet, ColliderSet, ImpulseJointSet) =
            serde_json::from_str(memory)?;
        let n_found = [read.3.len(), read.4.len(), read.5.len()];
        if n_found != n_expected {
            return Err(serde::de::Error::custom(format!("bodies, shapes and joints are {n_found:?}, not {n_expected:?}")));
        }
        (sets.islands, sets.broad_phase, sets.narrow_phase, sets.bodies, sets.colliders, sets.joints) = read;
        sets.pipeline = PhysicsPipeline::new();
        sets.ccd = CCDSolver::new();
        Ok(())
    }

    fn friction_wrench(&self, joint: usize) -> Wrench {
        let data = &self.sets.joints.get(self.sets.friction[joint]).expect("joints live as long as their world").data;
        let rotation = data.local_frame1.rotation;
        let axis = Vec2::new(widened(rotation.re), widened(rotation.im));
        let [along, across, turning] = data.motors.map(|motor| -widened(motor.impulse) / widened(self.substep()));
        Wrench { force: along * axis + across * perpendicular(&axis), torque: turning }
    }
}

impl Sets {
    /// Friction joints come first: rapier solves them last in an iteration, so that friction limits
    /// hold exactly.
    fn new(mass: Real, inertia: Real, body: &BodyState, n_friction: usize, n_springs: usize) -> Self {
        let mut bodies = RigidBodySet::new();
        let ground = bodies.insert(RigidBodyBuilder::fixed());
        let load = bodies.insert(
            RigidBodyBuilder::dynamic()
                .pose(Pose::from_parts(narrow(&body.position), unit(&body.rotation)))
                .linvel(narrow(&body.velocity))
                .angvel(body.turn_rate as Real)
                .additional_mass_properties(MassProperties::new(Vector::ZERO, mass, inertia))
                .allow_fast_rotation(true)
                // A sleeping load would ignore the pull of its springs, and the state of the body
                // does not show sleep.
                .can_sleep(false),
        );
        let mut joints = ImpulseJointSet::new();
        // The engine applies forces at the anchor of the second body, which must be the load: else
        // friction would act at a point of the ground.
        let friction: Vec<_> = (0..n_friction).map(|_| joints.insert(ground, load, GenericJoint::default(), false)).collect();
        let springs: Vec<_> = (0..n_springs).map(|_| joints.insert(load, ground, GenericJoint::default(), false)).collect();
        let is_in_order = friction.iter().chain(&springs).enumerate().all(|(at, handle)| place(*handle) == at);
        assert!(is_in_order, "a fresh set numbers its joints in the order of insertion");
        Self {
            pipeline: PhysicsPipeline::new(),
            islands: IslandManager::new(),
            broad_phase: DefaultBroadPhase::new(),
            narrow_phase: NarrowPhase::new(),
            bodies,
            colliders: ColliderSet::new(),
            joints,
            multibody_joints: MultibodyJointSet::new(),
            soft_bodies: SoftBodySet::new(),
            ccd: CCDSolver::new(),
            load,
            load_collider: None,
            obstacles: Vec::new(),
            friction,
            springs,
        }
    }

    fn add_obstacles(&mut self, shapes: &Obstacles, steps: &[ObstacleStep], hooks: ActiveHooks) {
        let Some(collider) = load_collider(shapes, hooks) else { return };
        self.load_collider = Some(self.colliders.insert_with_parent(collider, self.load, &mut self.bodies));
        for (shape, step) in shapes.list.iter().zip(steps) {
            let body = if shape.moves { RigidBodyBuilder::kinematic_position_based() } else { RigidBodyBuilder::fixed() };
            let body = self.bodies.insert(body.pose(pose_of(&step.start)));
            if let Some(collider) = shape.collider() {
                self.colliders.insert_with_parent(collider, body, &mut self.bodies);
            }
            self.obstacles.push(body);
        }
    }

    fn move_obstacles(&mut self, steps: &[ObstacleStep]) {
        for (handle, step) in self.obstacles.iter().zip(steps) {
            let body = &mut self.bodies[*handle];
            if body.is_kinematic() {
                body.set_next_kinematic_position(pose_of(&step.end));
            }
        }
    }

    /// Writes the data of all joints. Access by handle would make the engine search for new islands
    /// at every joint.
    fn set_joints(&mut self, friction: &[FrictionJoint], springs: &[SpringJoint], substep: Real) {
        let pose = *self.bodies[self.load].position();
        self.joints.map_attached_joints_mut(self.load, |_, _, handle, joint| {
            let at = place(handle);
            match friction.get(at) {
                Some(friction) => set_friction(&mut joint.data, friction),
                None => set_spring(&mut joint.data, &springs[at - friction.len()], &pose, substep),
            }
        });
    }

    /// Replaces the external wrench on the load (N, N, N m).
    fn push(&mut self, wrench: &Vec3) {
        let load = &mut self.bodies[self.load];
        load.reset_forces(false);
        load.reset_torques(false);
        load.add_force(narrow(&wrench.xy()), false);
        load.add_torque(wrench.z as Real, false);
    }

    fn step(&mut self, parameters: &IntegrationParameters, hooks: &dyn PhysicsHooks) -> bool {
        self.pipeline.step(
            Vector::ZERO,
            parameters,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &mut self.joints,
            &mut self.multibody_joints,
            &mut self.soft_bodies,
            &mut self.ccd,
            hooks,
            &(),
        );
        // Rapier disables a body with a state that is not finite.
        self.bodies[self.load].is_enabled()
    }
}

/// Place of a joint in the order of insertion.
fn place(handle: ImpulseJointHandle) -> usize {
    handle.into_raw_parts().0 as usize
}

/// Friction between ground and load: rigid axes with a largest force are Coulomb's law.
fn set_friction(data: &mut GenericJoint, joint: &FrictionJoint) {
    data.local_frame1.rotation = unit(&joint.direction);
    data.local_frame2.translation = narrow(&joint.offset);
    data.motor_axes = JointAxesMask::empty();
    let [along, across] = joint.limits;
    for (axis, limit) in [(JointAxis::LinX, along), (JointAxis::LinY, across), (JointAxis::AngX, joint.turning_limit)] {
        let motor = &mut data.motors[axis as usize];
        motor.impulse = 0.0;
        if limit > 0.0 {
            data.motor_axes |= JointAxesMask::from(axis);
            motor.max_force = limit as Real;
        }
    }
}

/// Spring between load and ground. Both frames are those of the joint, so that the engine's own
/// distances are zero up to rounding. The force of the law is set as a target speed of the motor.
fn set_spring(data: &mut GenericJoint, joint: &SpringJoint, load: &Pose, substep: Real) {
    let frame = Pose::from_parts(load.translation + narrow(&joint.arm), unit(&joint.direction));
    data.local_frame1 = load.inv_mul(&frame);
    data.local_frame2 = frame;
    data.motor_axes = JointAxesMask::empty();
    let laws = [(JointAxis::LinX, &joint.axes[0]), (JointAxis::LinY, &joint.axes[1]), (JointAxis::AngX, &joint.turning)];
    for (axis, law) in laws {
        if let Some(law) = law {
            data.motor_axes |= JointAxesMask::from(axis);
            set_motor(&mut data.motors[axis as usize], law, substep);
        }
    }
}

fn set_motor(motor: &mut JointMotor, law: &AxisLaw, substep: Real) {
    let (stiffness, damping) = (law.stiffness as Real, law.damping as Real);
    motor.impulse = 0.0;
    motor.model = MotorModel::ForceBased;
    motor.stiffness = stiffness;
    motor.damping = damping.max(SOFTEST / substep - substep * stiffness);
    motor.max_force = Real::INFINITY;
    motor.target_vel = -(law.force as Real) / (substep * stiffness + motor.damping);
}
