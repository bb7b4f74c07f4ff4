//! The reduced inertial model: a load with mass beside the quasi-static load.
//!
//! The model slides in one direction at a time, a body twist n of unit edge displacement, as a
//! friction oscillator with
//!
//! ```text
//! m_n = n'Mn    k_n = n'Hn    c_n = n'Cn    f_n = h(n) = sum_i c_i |B_i n|
//! under the force n'(wrench of springs and dashpots)
//! ```
//!
//! H is the Hessian of the springs' energy by body twists, and C is the damping matrix of the
//! dashpots. While the quasi-static load slips, its springs and friction balance. The model then
//! departs from it only by changes of speed: a slip onset at the speed s gives `-(s / w) sin(w t)`,
//! a stop lets the model coast, and a jump leaves it behind by the whole jump.
//!
//! The direction follows the quasi-static load. A model at rest that friction does not hold starts
//! in the direction of its own cone problem. A moving model turns towards the increment g as
//! friction turns its momentum, `(M v / t + h'') n = M v / t n_old + h'' g`. A jump over L adds the
//! momentum of the swing that follows it, M w L, to h'' t.
//!
//! The offset r across the slip, `n'Hr = 0`, is constant while the model sticks. Over a path dx it
//! drifts to where the springs balance what the dashpots do to the model beyond what they do to the
//! load without inertia, d = C (v - v_model): `h'' dr = (d - H r) dx`, implicit. Beside a load
//! without dashpots d is their whole wrench. Where the model moves alone, springs and friction
//! across its path turn it in the same way, with its mass.

use serde::{Deserialize, Serialize};

use super::friction_oscillator::FrictionOscillator;
use super::interval::Interval;
use super::slip::{Resistance, edge_length, increment};
use super::springs::{Dashpots, ModelSprings, SpringForces};
use super::static_friction::{StaticFriction, StickTest};
use crate::backend::Motion;
use crate::backend::friction::FrictionSolver;
use crate::backend::increment::{friction_loss, positive_definite};
use crate::backend::springs::Place;
use crate::math::{Mat2, Mat3, Pose, PositiveDefinite, Vec3, rotation};
use crate::model::{Load, System};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReducedModel {
    pub pose: Pose,
    /// Direction of slip (1, 1, 1/m); zero before the first motion.
    direction: Vec3,
    /// Speed along the direction, not negative (m/s).
    pub speed: f64,
    /// Derivative of the springs' energy by body twists (N, N, N m); `None` if it was not needed.
    gradient: Option<Vec3>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModelStep {
    pub moved: bool,
    /// Frequency of its oscillation (rad/s); zero at rest or without springs.
    pub frequency: f64,
    /// Whether its heading differs too much from the quasi-static load for a balance beside it.
    pub is_invalid: bool,
    /// Damping ratio of its oscillation (1).
    pub damping_ratio: f64,
}

/// Solvers and caches of a model. Apart from warm starts, they do not change the result.
#[derive(Clone, Debug)]
pub struct Workspace {
    pub solver: FrictionSolver,
    pub static_friction: StaticFriction,
    pub springs: ModelSprings,
    /// Whether the quasi-static load has no dashpots.
    pub beside_rate_independent: bool,
    /// Last rotation of the model, and of the quasi-static load.
    own: Turned,
    beside: Turned,
    /// Friction against the last direction of slip.
    slip: Option<(Vec3, Resistance)>,
}

/// Largest difference of headings at which the model drifts beside the quasi-static load (rad).
const FARTHEST_TURN: f64 = std::f64::consts::PI;
/// Least stiffness along the slip, divided by the sum of the radial stiffnesses (1). Below it the
/// load is about to buckle.
const LEAST_STIFFNESS: f64 = 1e-5;

impl ReducedModel {
    pub fn new(system: &System, start: &Motion) -> Self {
        let linear = rotation(start.pose.heading).tr_mul(&start.twist.linear);
        let twist = linear.push(start.twist.angular);
        let speed = edge_length(&twist, system.load.radius);
        let direction = if speed > 0.0 { twist / speed } else { Vec3::zeros() };
        Self { pose: start.pose, direction, speed, gradient: None }
    }

    /// Body twist of the model (m/s, m/s, rad/s).
    pub fn twist(&self) -> Vec3 {
        self.speed * self.direction
    }

    /// Advances through an interval of the quasi-static load.
    pub fn advance(&mut self, system: &System, interval: &Interval, workspace: &mut Workspace) -> ModelStep {
        if self.rests_on(interval, workspace) {
            self.gradient = None;
            return ModelStep::default();
        }
        let last = *self;
        let at = workspace.own.place(&self.pose);
        let mut course = None;
        if self.speed == 0.0 {
            let gradient = workspace.springs.gradient(system, interval, &at, 1.0);
            let test = workspace.static_friction.test(&(workspace.springs.drag(system, interval, &at) - gradient));
            let StickTest::Undecided(near) = test else { return self.rest(gradient) };
            course = Some(near);
        }
        let forces = workspace.springs.forces(system, interval, &at);
        match course {
            Some(near) => match onset(system, &forces, &near, workspace) {
                Some(direction) => self.direction = direction,
                None => return self.rest(forces.elastic.gradient),
            },
            None => {
                let goal = increment(&workspace.beside.place(interval.before), interval.after);
                self.turn(system, interval, &goal, &forces, workspace);
            }
        }
        let beside = workspace.beside.place(interval.after);
        let step = self.slide(system, interval, &forces, [&at, &beside], workspace);
        if !self.pose.is_finite() || !self.speed.is_finite() || !self.direction.iter().all(|v| v.is_finite()) {
            *self = Self { speed: 0.0, gradient: None, ..last };
            return ModelStep::default();
        }
        step
    }

    /// Whether the model keeps resting, because nothing changed or because it rests at the pose of
    /// the quasi-static load.
    fn rests_on(&self, interval: &Interval, workspace: &Workspace) -> bool {
        let nothing_changed =
            || !interval.is_event && interval.before == interval.after && interval.attachments.tips_are_at(interval.targets);
        self.speed == 0.0 && (self.pose == *interval.after && !workspace.springs.is_damped || nothing_changed())
    }

    /// Rests, with this gradient.
    fn rest(&mut self, gradient: Vec3) -> ModelStep {
        self.gradient = Some(gradient);
        ModelStep::default()
    }

    /// Turns a moving model towards the `increment` of the quasi-static load.
    fn turn(&mut self, system: &System, interval: &Interval, increment: &Vec3, forces: &SpringForces, workspace: &mut Workspace) {
        let length = edge_length(increment, system.load.radius);
        if length == 0.0 {
            return;
        }
        let goal = increment / length;
        // Without friction nothing else turns it.
        if interval.is_event && system.total_slip_limit() == 0.0 {
            return self.take(system, &goal);
        }
        let sudden = if interval.is_event { length * oscillator(system, forces, &goal, workspace).frequency() } else { 0.0 };
        let momentum = |speed: f64| Mat3::from_diagonal(&(speed / interval.duration * masses(&system.load)));
        let turning = workspace.resistance(system, &self.direction).turning + momentum(sudden);
        let push = momentum(self.speed) * self.direction + turning * goal;
        let course = solve(&(turning + momentum(self.speed)), &push).unwrap_or(goal);
        self.take(system, &course);
    }

    /// Takes the direction of `course`, with the component of its momentum in that direction.
    fn take(&mut self, system: &System, course: &Vec3) {
        let direction = course / edge_length(course, system.load.radius);
        let momentum = masses(&system.load).component_mul(&direction);
        self.speed *= momentum.dot(&self.direction) / momentum.dot(&direction);
        self.direction = direction;
    }

    /// Slides along its direction from the place `at`, then across it, beside the quasi-static
    /// load.
    fn slide(
        &mut self,
        system: &System,
        interval: &Interval,
        forces: &SpringForces,
        [at, beside]: [&Place; 2],
        workspace: &mut Workspace,
    ) -> ModelStep {
        let (n, elastic) = (self.direction, &forces.elastic);
        let before = self.gradient.filter(|_| !interval.is_event).unwrap_or_else(|| workspace.springs.gradient(system, interval, at, 0.0));
        let oscillator = oscillator(system, forces, &n, workspace);
        let (begin, end) = (-n.dot(&before), -n.dot(&elastic.gradient));
        let drag = forces.dashpots.as_ref().map_or(0.0, |dashpots| n.dot(&dashpots.drag));
        let frequency = oscillator.frequency();
        let damping_ratio = if frequency > 0.0 { 0.5 * oscillator.damping / (oscillator.mass * frequency) } else { 0.0 };
        let slide = oscillator.step(self.speed, begin + drag, (end - begin) / interval.duration, interval.duration);
        let at = at.moved_by(&(slide.shift * n));
        self.pose = at.pose;
        self.gradient = Some(elastic.gradient + elastic.hessian * n * slide.shift);
        (self.speed, self.direction) = (slide.speed.abs(), if slide.speed < 0.0 { -n } else { n });
        let mut is_invalid = false;
        if slide.length > 0.0 {
            let of_load = (!workspace.beside_rate_independent && forces.dashpots.is_some())
                .then(|| increment(&workspace.beside.place(interval.before), interval.after));
            let across = Across::new(system, forces, [slide.shift * n, of_load.unwrap_or_default()], interval.duration, of_load.is_some());
            let moves_alone =
                interval.before == interval.after && !interval.is_event && self.speed > 0.0 && slide.shift.abs() == slide.length;
            let resistance = workspace.resistance(system, &self.direction);
            if moves_alone {
                self.steer(system, &across, resistance, &at, slide.length, interval.duration);
            } else if (beside.pose.heading - at.pose.heading).abs() > FARTHEST_TURN {
                is_invalid = true;
            } else if oscillator.stiffness > 0.0 {
                self.drift(system, &across, resistance, [&at, beside], oscillator.stiffness, slide.length);
            }
        }
        ModelStep { moved: slide.length > 0.0, frequency, is_invalid, damping_ratio }
    }

    /// Drifts across the slip over a path of this `length` (m), to where springs balance dashpots.
    fn drift(&mut self, system: &System, across: &Across, against: &Resistance, [at, beside]: [&Place; 2], stiffness: f64, length: f64) {
        let n = self.direction;
        let offset = increment(beside, &at.pose);
        let pull = across.hessian * n;
        let offset = offset - n * (pull.dot(&offset) / stiffness);
        let source = across.driving - pull * (n.dot(&across.driving) / stiffness);
        let push = length * (source - across.hessian * offset);
        let Some(change) = solve(&(against.turning + length * across.stiffness), &push) else { return };
        // The slip cannot turn by more than its own length.
        let change = length / edge_length(&change, system.load.radius).max(length) * change;
        // Friction does this work, up to its limits. Springs that resist more are far from balance.
        let resisting = self.gradient.expect("a model that moved has a gradient") - across.dashpots;
        let work = resisting.dot(&change) + 0.5 * change.dot(&(across.hessian * change));
        if work <= system.ground.slip_limits().sum::<f64>() * edge_length(&change, system.load.radius) {
            self.pose = at.moved_by(&change).pose;
        }
    }

    /// Turns a model that moves while the quasi-static load rests.
    fn steer(&mut self, system: &System, across: &Across, against: &Resistance, at: &Place, length: f64, duration: f64) {
        let gradient = self.gradient.expect("a model that moved has a gradient");
        let masses = masses(&system.load);
        let inertia = masses.component_mul(&self.direction);
        let net = across.dashpots - gradient - against.wrench;
        let aside = net - inertia * (self.direction.dot(&net) / self.direction.dot(&inertia));
        let stiffness = Mat3::from_diagonal(&(masses / (duration * duration))) + across.stiffness;
        let Some(aside) = solve(&(against.turning + length * stiffness), &(length * aside)) else { return };
        self.pose = at.moved_by(&aside).pose;
        self.gradient = Some(gradient + across.hessian * aside);
        self.take(system, &(length * self.direction + aside));
    }
}

/// The last heading (rad) and its rotation.
#[derive(Clone, Copy, Debug)]
struct Turned {
    heading: f64,
    turn: Mat2,
}

impl Turned {
    const NONE: Turned = Turned { heading: 0.0, turn: Mat2::new(1.0, 0.0, 0.0, 1.0) };

    fn place(&mut self, pose: &Pose) -> Place {
        if self.heading != pose.heading {
            *self = Self { heading: pose.heading, turn: rotation(pose.heading) };
        }
        Place { pose: *pose, turn: self.turn }
    }
}

impl Workspace {
    pub fn new(system: &System, beside_rate_independent: bool) -> Self {
        let solver = FrictionSolver::new(&system.ground, system.load.radius);
        let static_friction = StaticFriction::new(&system.ground);
        Self {
            solver,
            static_friction,
            springs: ModelSprings::new(system),
            beside_rate_independent,
            own: Turned::NONE,
            beside: Turned::NONE,
            slip: None,
        }
    }

    fn resistance(&mut self, system: &System, n: &Vec3) -> &Resistance {
        let known = self.slip.take().filter(|(known, _)| known == n);
        &self.slip.insert(known.unwrap_or_else(|| (*n, Resistance::of(&system.ground, n)))).1
    }
}

/// Direction in which a model at rest begins to slip, if it does; searched first `near` a guess.
fn onset(system: &System, forces: &SpringForces, near: &Vec3, workspace: &mut Workspace) -> Option<Vec3> {
    let hessian = positive_definite(&forces.elastic.hessian, system.load.radius);
    let pull = forces.dashpots.as_ref().map_or(Vec3::zeros(), |dashpots| dashpots.drag) - forces.elastic.gradient;
    let length = (near.dot(&pull) - friction_loss(&system.ground, near)) / near.dot(&(hessian * near));
    let slip = Some(length * near).filter(|_| length > 0.0).and_then(|near| workspace.solver.slide(&hessian, &pull, &near));
    let twist = slip.unwrap_or_else(|| workspace.solver.solve(&hessian, &pull)).increment;
    let length = edge_length(&twist, system.load.radius);
    if length == 0.0 {
        workspace.static_friction.continue_from(workspace.solver.forces());
    }
    (length > 0.0 && length.is_finite()).then(|| twist / length)
}

/// Stiffness and damping across a slip.
struct Across {
    hessian: Mat3,
    /// Stiffness of both within the interval, kept positive definite (N/m, N, N m/rad).
    stiffness: Mat3,
    /// Wrench of the dashpots at the mean speed (N, N, N m).
    dashpots: Vec3,
    /// The same, beyond their wrench on the quasi-static load.
    driving: Vec3,
}

impl Across {
    /// Values for an increment of the model, beside one of the quasi-static load, within `duration`
    /// (s). That load may have the same dashpots.
    fn new(system: &System, forces: &SpringForces, [of_model, of_load]: [Vec3; 2], duration: f64, is_load_damped: bool) -> Self {
        let hessian = forces.elastic.hessian;
        let stiffness = positive_definite(&hessian, system.load.radius);
        match &forces.dashpots {
            None => Self { hessian, stiffness, dashpots: Vec3::zeros(), driving: Vec3::zeros() },
            Some(Dashpots { damping, drag }) => {
                let dashpots = drag - damping * of_model / duration;
                let driving = if is_load_damped { damping * (of_load - of_model) / duration } else { dashpots };
                Self { hessian, stiffness: stiffness + damping / duration, dashpots, driving }
            }
        }
    }
}

fn oscillator(system: &System, forces: &SpringForces, n: &Vec3, workspace: &mut Workspace) -> FrictionOscillator {
    let along = |matrix: &Mat3| n.dot(&(matrix * n));
    let radial = workspace.springs.radial;
    let stiffness = along(&forces.elastic.hessian).abs().max(LEAST_STIFFNESS * radial);
    FrictionOscillator {
        mass: n.dot(&masses(&system.load).component_mul(n)),
        damping: forces.dashpots.as_ref().map_or(0.0, |dashpots| along(&dashpots.damping).max(0.0)),
        stiffness,
        friction: workspace.resistance(system, n).loss,
    }
}

/// Diagonal of the mass matrix (kg, kg, kg m^2).
fn masses(load: &Load) -> Vec3 {
    Vec3::new(load.mass, load.mass, load.inertia)
}

/// Solution x of A x = b with a symmetric A.
fn solve(a: &Mat3, b: &Vec3) -> Option<Vec3> {
    PositiveDefinite::new(a).map(|factor| factor.solve(b)).or_else(|| a.try_inverse().map(|inverse| inverse * b))
}
