//! Where a load with its mass would be, beside one without.
//!
//! The shadow slides in one direction at a time, a body twist n whose shift plus radius times turn is one, as a slider with
//!
//! ```text
//! m_n = n'Mn    k_n = n'Hn    c_n = n'Cn    f_n = h(n) = sum_i c_i |B_i n|    under n'(wrench of springs and dashpots)
//! ```
//!
//! H is the Hessian of the held springs' energy by body twists, C that of their dashpots. While the load without inertia slips, its springs and friction
//! balance, so that nothing drives the shadow's distance from it but changes of its speed: an onset at the speed s gives `-(s / w) sin(w t)`, a stop lets the
//! shadow coast, a jump leaves it behind by all of the jump.
//!
//! The direction comes from the load without inertia. A shadow at rest starts in that of its own cone problem. One that moves turns towards the increment g as
//! friction turns its momentum, `(M v / t + h'') n = M v / t n_old + h'' g`; at a jump at once. Its offset r across the slip, `n'Hr = 0`, stays while
//! it sticks and goes over a way dx to where the springs hold the dashpots' wrench d: `h'' dr = (d - H r) dx`, taken implicitly. Where the shadow moves alone,
//! springs and friction across its way turn it in the same manner, its mass included.

use serde::{Deserialize, Serialize};

use super::slider::Slider;
use super::slip::{Resistance, increment, rim};
use crate::backend::Motion;
use crate::backend::friction::FrictionSolver;
use crate::backend::held::{Grip, HeldSprings};
use crate::backend::increment::{friction_loss, in_body_increments, positive_definite};
use crate::math::{Mat3, Pose, Vec2, Vec3, rotation};
use crate::model::{Reaction, System};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shadow {
    pub pose: Pose,
    /// Direction of slip (1, 1, 1/m); zero before anything has moved.
    direction: Vec3,
    /// Along it, never against it (m/s).
    pub speed: f64,
    /// Derivative of the springs' energy by body twists at the shadow, with the tips where they are (N, N, N m); `None` when it was not needed last.
    gradient: Option<Vec3>,
}

/// What happens to the load without inertia while the shadow goes on.
pub struct Tick<'a> {
    pub before: &'a Pose,
    pub after: &'a Pose,
    /// Grips before the tips moved, and after.
    pub from: &'a [Grip],
    pub held: &'a HeldSprings,
    /// A grasp or a release came just before.
    pub is_event: bool,
    /// (s)
    pub duration: f64,
}

/// How a shadow went on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Followed {
    /// Length of the way of its rim (m).
    pub way: f64,
    /// Of its oscillation (rad/s); zero for a shadow that rested or that no spring holds.
    pub frequency: f64,
}

/// Springs and dashpots as a shadow feels them with the tips at the end of a tick, by body twists.
struct Pulls {
    elastic: Reaction,
    /// C (N s/m, N s, N m s/rad).
    damping: Mat3,
    /// Of the moving tips through the dashpots on a load at rest (N, N, N m).
    drag: Vec3,
}

/// Stiffness along the slip, over the sum of the held springs', below which a load counts as on the verge of buckling (1).
const LEAST_STIFFNESS: f64 = 1e-5;

impl Shadow {
    pub fn new(system: &System, start: &Motion) -> Self {
        let linear = rotation(start.pose.heading).tr_mul(&start.twist.linear);
        let twist = Vec3::new(linear.x, linear.y, start.twist.angular);
        let speed = rim(&twist, system.load.radius);
        let direction = if speed > 0.0 { twist / speed } else { Vec3::zeros() };
        Self { pose: start.pose, direction, speed, gradient: None }
    }

    /// Goes on through a tick of the load without inertia.
    pub fn follow(&mut self, system: &System, tick: &Tick, solver: &mut FrictionSolver) -> Followed {
        let last = self.clone();
        if self.is_left_alone(system, tick) {
            self.gradient = None;
            return Followed::default();
        }
        let pulls = self.pulls(system, tick);
        if self.speed == 0.0 {
            let Some(direction) = self.onset(system, &pulls, solver) else {
                self.gradient = Some(pulls.elastic.gradient);
                return Followed::default();
            };
            self.direction = direction;
        } else {
            self.turn(system, tick);
        }
        let followed = self.slide(system, tick, &pulls);
        if !self.pose.is_finite() || !self.speed.is_finite() || !self.direction.iter().all(|v| v.is_finite()) {
            *self = Self { speed: 0.0, gradient: None, ..last };
            return Followed::default();
        }
        followed
    }

    /// Whether it rests and goes on resting, for nothing has changed or because it is where the load without inertia rests.
    fn is_left_alone(&self, system: &System, tick: &Tick) -> bool {
        let tips_stood = || tick.held.grips().iter().zip(tick.from).all(|(now, last)| now.tip == last.tip);
        let is_undamped = || system.springs.iter().all(|spring| spring.damping_ratio == 0.0);
        let nothing_changed = !tick.is_event && tick.before == tick.after && tips_stood();
        self.speed == 0.0 && (nothing_changed || self.pose == *tick.after && is_undamped())
    }

    fn pulls(&self, system: &System, tick: &Tick) -> Pulls {
        let mut dashpots = Reaction::ZERO;
        for (grip, last) in tick.held.grips().iter().zip(tick.from) {
            let spring = &system.springs[grip.spring];
            if spring.damping_ratio > 0.0 {
                // A dashpot is a spring of stiffness c / t about its shape at the start of the tick.
                let (radial, torsional) = system.dashpot(spring);
                let shape = last.shape(&system.springs, &self.pose);
                let dashpot = spring.about(&shape, radial / tick.duration, torsional / tick.duration);
                dashpots.add(&dashpot.reaction(&self.pose, &dashpot.shape(&self.pose, &grip.tip, 0.0)));
            }
        }
        let dashpots = self.in_body(&dashpots);
        let elastic = self.in_body(&tick.held.reaction(&system.springs, &self.pose));
        Pulls { elastic, damping: tick.duration * dashpots.hessian, drag: -dashpots.gradient }
    }

    fn in_body(&self, world: &Reaction) -> Reaction {
        in_body_increments(world, &rotation(self.pose.heading))
    }

    /// Direction in which a shadow at rest begins to slip, if it does.
    fn onset(&self, system: &System, pulls: &Pulls, solver: &mut FrictionSolver) -> Option<Vec3> {
        let pull = pulls.drag - pulls.elastic.gradient;
        if solver.rest(&-pull).is_some() {
            return None;
        }
        let hessian = positive_definite(&pulls.elastic.hessian, system.load.radius);
        let twist = solver.solve(&hessian, &pull).increment;
        let length = rim(&twist, system.load.radius);
        (length > 0.0 && length.is_finite()).then(|| twist / length)
    }

    /// Turns a moving shadow towards where the load without inertia goes.
    fn turn(&mut self, system: &System, tick: &Tick) {
        let twist = increment(tick.before, tick.after);
        let length = rim(&twist, system.load.radius);
        if length == 0.0 {
            return;
        }
        let goal = twist / length;
        let momentum = system.load.mass_matrix() * (self.speed / tick.duration);
        let turning = Resistance::of(&system.ground, &self.direction).turning;
        let turned = (momentum + turning).try_inverse().map(|inverse| inverse * (momentum * self.direction + turning * goal));
        self.go(system, &turned.filter(|_| !tick.is_event).unwrap_or(goal));
    }

    /// Takes the direction of `course`, with what of its momentum goes that way.
    fn go(&mut self, system: &System, course: &Vec3) {
        let mass = system.load.mass_matrix();
        let direction = course / rim(course, system.load.radius);
        self.speed *= direction.dot(&(mass * self.direction)) / direction.dot(&(mass * direction));
        self.direction = direction;
    }

    /// Slides along its direction, then to where it goes across.
    fn slide(&mut self, system: &System, tick: &Tick, pulls: &Pulls) -> Followed {
        let n = self.direction;
        let slider = slider(system, tick.held, pulls, &n);
        let (begin, end) = (-n.dot(&self.gradient_before(system, tick)), -n.dot(&pulls.elastic.gradient));
        let slid = slider.slide(self.speed, begin + n.dot(&pulls.drag), (end - begin) / tick.duration, tick.duration);
        self.pose = self.pose.moved_by(&(slid.shift * n));
        self.gradient = Some(pulls.elastic.gradient + pulls.elastic.hessian * n * slid.shift);
        (self.speed, self.direction) = (slid.speed.abs(), if slid.speed < 0.0 { -n } else { n });
        if slid.way > 0.0 {
            let across = Across::new(system, pulls, &n, slid.shift, tick.duration);
            let goes_alone = tick.before == tick.after && !tick.is_event && self.speed > 0.0 && slid.shift.abs() == slid.way;
            if goes_alone {
                self.steer(system, &across, slid.way, tick.duration);
            } else {
                self.drift(system, tick.after, &across, slider.stiffness, slid.way);
            }
        }
        Followed { way: slid.way, frequency: slider.frequency() }
    }

    /// Gradient with the tips where they were before the tick.
    fn gradient_before(&self, system: &System, tick: &Tick) -> Vec3 {
        self.gradient.filter(|_| !tick.is_event).unwrap_or_else(|| {
            let mut before = tick.held.clone();
            before.place_tips(tick.from, &vec![Vec2::zeros(); system.springs.len()], 0.0);
            self.in_body(&before.reaction(&system.springs, &self.pose)).gradient
        })
    }

    /// Goes over a `way` (m) to where the springs hold the wrench of the dashpots across the slip.
    fn drift(&mut self, system: &System, beside: &Pose, across: &Across, stiffness: f64, way: f64) {
        if stiffness == 0.0 {
            return;
        }
        let n = self.direction;
        let offset = increment(beside, &self.pose);
        let pull = across.hessian * n;
        let offset = offset - n * (pull.dot(&offset) / stiffness);
        let source = across.dashpots - pull * (n.dot(&across.dashpots) / stiffness);
        let turning = Resistance::of(&system.ground, &n).turning;
        let Some(inverse) = (turning + way * across.stiffness).try_inverse() else { return };
        let change = inverse * (way * (source - across.hessian * offset));
        // The slip turns by no more than all of it.
        let share = way / rim(&change, system.load.radius).max(way);
        self.pose = self.pose.moved_by(&(share * change));
    }

    /// Turns a shadow that the load without inertia does not go with.
    fn steer(&mut self, system: &System, across: &Across, way: f64, duration: f64) {
        let Resistance { wrench, turning } = Resistance::of(&system.ground, &self.direction);
        let gradient = self.gradient.expect("a shadow that slid knows it");
        let mass = system.load.mass_matrix();
        let inertia = mass * self.direction;
        let net = across.dashpots - gradient - wrench;
        let aside = net - inertia * (self.direction.dot(&net) / self.direction.dot(&inertia));
        let resistance = turning + way * (mass / (duration * duration) + across.stiffness);
        let Some(inverse) = resistance.try_inverse() else { return };
        let aside = inverse * aside * way;
        self.pose = self.pose.moved_by(&aside);
        self.gradient = Some(gradient + across.hessian * aside);
        self.go(system, &(way * self.direction + aside));
    }
}

/// Springs and dashpots across a slip.
struct Across {
    hessian: Mat3,
    /// Of both against a shift within the tick, kept positive (N/m, N, N m/rad).
    stiffness: Mat3,
    /// Wrench of the dashpots at the mean speed of the tick (N, N, N m).
    dashpots: Vec3,
}

impl Across {
    /// For a slip over the `shift` (m) along `n` within `duration` (s).
    fn new(system: &System, pulls: &Pulls, n: &Vec3, shift: f64, duration: f64) -> Self {
        Self {
            hessian: pulls.elastic.hessian,
            stiffness: positive_definite(&pulls.elastic.hessian, system.load.radius) + pulls.damping / duration,
            dashpots: pulls.drag - pulls.damping * n * (shift / duration),
        }
    }
}

/// The shadow along `n`.
fn slider(system: &System, held: &HeldSprings, pulls: &Pulls, n: &Vec3) -> Slider {
    let along = |matrix: &Mat3| n.dot(&(matrix * n));
    let radial: f64 = held.grips().iter().map(|grip| system.springs[grip.spring].radial_stiffness).sum();
    let stiffness = if held.is_empty() { 0.0 } else { along(&pulls.elastic.hessian).abs().max(LEAST_STIFFNESS * radial) };
    Slider {
        mass: along(&system.load.mass_matrix()),
        damping: along(&pulls.damping).max(0.0),
        stiffness,
        friction: friction_loss(&system.ground, n),
    }
}
