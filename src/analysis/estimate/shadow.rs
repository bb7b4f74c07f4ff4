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
//! The direction comes from the load without inertia. A shadow at rest that no friction holds starts in that of its own cone problem. One that moves turns
//! towards the increment g as friction turns its momentum, `(M v / t + h'') n = M v / t n_old + h'' g`; a jump over L adds the momentum of the swing that it brings
//! about, M w L, to h'' t. Its offset r across the slip, `n'Hr = 0`, stays while it sticks and goes over a way dx to where the springs hold the dashpots' wrench d:
//! `h'' dr = (d - H r) dx`, taken implicitly. Where the shadow moves alone, springs and friction across its way turn it in the same manner, its mass included.

use serde::{Deserialize, Serialize};

use super::bearing::{Bearing, Look};
use super::pulls::{Attached, Dashpots, Pulls};
use super::slider::Slider;
use super::slip::{Resistance, increment, rim};
use crate::backend::Motion;
use crate::backend::friction::FrictionSolver;
use crate::backend::increment::{friction_loss, positive_definite};
use crate::backend::springs::Attachments;
use crate::backend::springs::Place;
use crate::math::{Mat2, Mat3, Pose, PositiveDefinite, Vec2, Vec3, rotation};
use crate::model::{Load, System};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
    /// Springs with their tips where the tick begins, and where these go (m, world, one entry a spring).
    pub held: &'a Attachments,
    pub targets: &'a [Vec2],
    /// A grasp or a release came just before.
    pub is_event: bool,
    /// (s)
    pub duration: f64,
}

/// How a shadow went on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Followed {
    /// Whether it went anywhere.
    pub moved: bool,
    /// Of its oscillation (rad/s); zero for a shadow that rested or that no spring holds.
    pub frequency: f64,
    /// Whether it had turned so far away from the load without inertia that where that balances says nothing of it.
    pub is_lost: bool,
}

/// What a shadow is followed with. But for where forces and slips are looked for first, all of it follows from what is asked.
#[derive(Clone, Debug)]
pub struct Tools {
    pub solver: FrictionSolver,
    pub bearing: Bearing,
    pub springs: Attached,
    /// Of the shadow, and of the load without inertia.
    own: Turned,
    beside: Turned,
    /// The last direction against which friction was looked at.
    slip: Option<(Vec3, Resistance)>,
}

/// Turn from the load without inertia up to which a shadow drifts beside it (rad): a twist of a whole turn leads nowhere but to where it was.
const FARTHEST_TURN: f64 = std::f64::consts::PI;
/// Stiffness along the slip, over the sum of the held springs', below which a load counts as on the verge of buckling (1).
const LEAST_STIFFNESS: f64 = 1e-5;

impl Shadow {
    pub fn new(system: &System, start: &Motion) -> Self {
        let linear = rotation(start.pose.heading).tr_mul(&start.twist.linear);
        let twist = linear.push(start.twist.angular);
        let speed = rim(&twist, system.load.radius);
        let direction = if speed > 0.0 { twist / speed } else { Vec3::zeros() };
        Self { pose: start.pose, direction, speed, gradient: None }
    }

    /// Its twist (m/s, m/s, rad/s; load axes).
    pub fn twist(&self) -> Vec3 {
        self.speed * self.direction
    }

    /// Goes on through a tick of the load without inertia.
    pub fn follow(&mut self, system: &System, tick: &Tick, tools: &mut Tools) -> Followed {
        if self.is_left_alone(tick, tools) {
            self.gradient = None;
            return Followed::default();
        }
        let last = *self;
        let at = tools.own.place(&self.pose);
        let mut course = None;
        if self.speed == 0.0 {
            let gradient = tools.springs.gradient(system, tick, &at, 1.0);
            let look = tools.bearing.look(&(tools.springs.drag(system, tick, &at) - gradient));
            let Look::Open(near) = look else { return self.rest(gradient) };
            course = Some(near);
        }
        let pulls = tools.springs.pulls(system, tick, &at);
        match course {
            Some(near) => match onset(system, &pulls, &near, tools) {
                Some(direction) => self.direction = direction,
                None => return self.rest(pulls.elastic.gradient),
            },
            None => {
                let way = increment(&tools.beside.place(tick.before), tick.after);
                self.turn(system, tick, &way, &pulls, tools);
            }
        }
        let beside = tools.beside.place(tick.after);
        let followed = self.slide(system, tick, &pulls, [&at, &beside], tools);
        if !self.pose.is_finite() || !self.speed.is_finite() || !self.direction.iter().all(|v| v.is_finite()) {
            *self = Self { speed: 0.0, gradient: None, ..last };
            return Followed::default();
        }
        followed
    }

    /// Whether it rests and goes on resting, for nothing has changed or because it is where the load without inertia rests.
    fn is_left_alone(&self, tick: &Tick, tools: &Tools) -> bool {
        let nothing_changed = || !tick.is_event && tick.before == tick.after && tick.held.tips_are_at(tick.targets);
        self.speed == 0.0 && (self.pose == *tick.after && !tools.springs.is_damped() || nothing_changed())
    }

    /// Stays where it is, with this gradient.
    fn rest(&mut self, gradient: Vec3) -> Followed {
        self.gradient = Some(gradient);
        Followed::default()
    }

    /// Turns a moving shadow towards the `way` of the load without inertia.
    fn turn(&mut self, system: &System, tick: &Tick, way: &Vec3, pulls: &Pulls, tools: &mut Tools) {
        let length = rim(way, system.load.radius);
        if length == 0.0 {
            return;
        }
        let goal = way / length;
        // Without friction nothing else would turn it.
        if tick.is_event && system.total_slip_limit() == 0.0 {
            return self.go(system, &goal);
        }
        let sudden = if tick.is_event { length * slider(system, pulls, &goal, tools).frequency() } else { 0.0 };
        let momentum = |speed: f64| Mat3::from_diagonal(&(speed / tick.duration * masses(&system.load)));
        let turning = tools.resistance(system, &self.direction).turning + momentum(sudden);
        let push = momentum(self.speed) * self.direction + turning * goal;
        let course = solve(&(turning + momentum(self.speed)), &push).unwrap_or(goal);
        self.go(system, &course);
    }

    /// Takes the direction of `course`, with what of its momentum goes that way.
    fn go(&mut self, system: &System, course: &Vec3) {
        let direction = course / rim(course, system.load.radius);
        let momentum = masses(&system.load).component_mul(&direction);
        self.speed *= momentum.dot(&self.direction) / momentum.dot(&direction);
        self.direction = direction;
    }

    /// Slides along its direction from one of two places, then to where it goes across, beside the load without inertia at the other.
    fn slide(&mut self, system: &System, tick: &Tick, pulls: &Pulls, [at, beside]: [&Place; 2], tools: &mut Tools) -> Followed {
        let (n, elastic) = (self.direction, &pulls.elastic);
        let before = self.gradient.filter(|_| !tick.is_event).unwrap_or_else(|| tools.springs.gradient(system, tick, at, 0.0));
        let slider = slider(system, pulls, &n, tools);
        let (begin, end) = (-n.dot(&before), -n.dot(&elastic.gradient));
        let drag = pulls.dashpots.as_ref().map_or(0.0, |dashpots| n.dot(&dashpots.drag));
        let frequency = slider.frequency();
        let slid = slider.slide(self.speed, begin + drag, (end - begin) / tick.duration, tick.duration);
        let at = at.moved_by(&(slid.shift * n));
        self.pose = at.pose;
        self.gradient = Some(elastic.gradient + elastic.hessian * n * slid.shift);
        (self.speed, self.direction) = (slid.speed.abs(), if slid.speed < 0.0 { -n } else { n });
        let mut is_lost = false;
        if slid.way > 0.0 {
            let across = Across::new(system, pulls, &n, slid.shift, tick.duration);
            let goes_alone = tick.before == tick.after && !tick.is_event && self.speed > 0.0 && slid.shift.abs() == slid.way;
            let resistance = tools.resistance(system, &self.direction);
            if goes_alone {
                self.steer(system, &across, resistance, &at, slid.way, tick.duration);
            } else if (beside.pose.heading - at.pose.heading).abs() > FARTHEST_TURN {
                is_lost = true;
            } else if slider.stiffness > 0.0 {
                self.drift(system, &across, resistance, [&at, beside], slider.stiffness, slid.way);
            }
        }
        Followed { moved: slid.way > 0.0, frequency, is_lost }
    }

    /// Goes over a `way` (m) to where the springs hold the wrench of the dashpots across the slip.
    fn drift(&mut self, system: &System, across: &Across, against: &Resistance, [at, beside]: [&Place; 2], stiffness: f64, way: f64) {
        let n = self.direction;
        let offset = increment(beside, &at.pose);
        let pull = across.hessian * n;
        let offset = offset - n * (pull.dot(&offset) / stiffness);
        let source = across.dashpots - pull * (n.dot(&across.dashpots) / stiffness);
        let push = way * (source - across.hessian * offset);
        let Some(change) = solve(&(against.turning + way * across.stiffness), &push) else { return };
        // The slip turns by no more than all of it.
        let change = way / rim(&change, system.load.radius).max(way) * change;
        // Friction takes it there, which has but its limits to give: where springs resist more, they are far from the balance that this is about.
        let resisting = self.gradient.expect("a shadow that slid knows it") - across.dashpots;
        let work = resisting.dot(&change) + 0.5 * change.dot(&(across.hessian * change));
        if work <= system.ground.slip_limits().sum::<f64>() * rim(&change, system.load.radius) {
            self.pose = at.moved_by(&change).pose;
        }
    }

    /// Turns a shadow that the load without inertia does not go with.
    fn steer(&mut self, system: &System, across: &Across, against: &Resistance, at: &Place, way: f64, duration: f64) {
        let gradient = self.gradient.expect("a shadow that slid knows it");
        let masses = masses(&system.load);
        let inertia = masses.component_mul(&self.direction);
        let net = across.dashpots - gradient - against.wrench;
        let aside = net - inertia * (self.direction.dot(&net) / self.direction.dot(&inertia));
        let stiffness = Mat3::from_diagonal(&(masses / (duration * duration))) + across.stiffness;
        let Some(aside) = solve(&(against.turning + way * stiffness), &(way * aside)) else { return };
        self.pose = at.moved_by(&aside).pose;
        self.gradient = Some(gradient + across.hessian * aside);
        self.go(system, &(way * self.direction + aside));
    }
}

/// The last heading (rad) whose rotation was taken.
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

impl Tools {
    pub fn new(system: &System) -> Self {
        let solver = FrictionSolver::new(&system.ground, system.load.radius);
        let bearing = Bearing::new(&system.ground);
        Self { solver, bearing, springs: Attached::new(system), own: Turned::NONE, beside: Turned::NONE, slip: None }
    }

    fn resistance(&mut self, system: &System, n: &Vec3) -> &Resistance {
        let known = self.slip.take().filter(|(known, _)| known == n);
        &self.slip.insert(known.unwrap_or_else(|| (*n, Resistance::of(&system.ground, n)))).1
    }
}

/// Direction in which a shadow at rest begins to slip, if it does: looked for `near` one first.
fn onset(system: &System, pulls: &Pulls, near: &Vec3, tools: &mut Tools) -> Option<Vec3> {
    let hessian = positive_definite(&pulls.elastic.hessian, system.load.radius);
    let pull = pulls.dashpots.as_ref().map_or(Vec3::zeros(), |dashpots| dashpots.drag) - pulls.elastic.gradient;
    let length = (near.dot(&pull) - friction_loss(&system.ground, near)) / near.dot(&(hessian * near));
    let slip = Some(length * near).filter(|_| length > 0.0).and_then(|near| tools.solver.slide(&hessian, &pull, &near));
    let twist = slip.unwrap_or_else(|| tools.solver.solve(&hessian, &pull)).increment;
    let length = rim(&twist, system.load.radius);
    if length == 0.0 {
        tools.bearing.go_on_from(tools.solver.forces());
    }
    (length > 0.0 && length.is_finite()).then(|| twist / length)
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
        let hessian = pulls.elastic.hessian;
        let stiffness = positive_definite(&hessian, system.load.radius);
        match &pulls.dashpots {
            None => Self { hessian, stiffness, dashpots: Vec3::zeros() },
            Some(Dashpots { damping, drag }) => {
                Self { hessian, stiffness: stiffness + damping / duration, dashpots: drag - damping * n * (shift / duration) }
            }
        }
    }
}

/// The shadow along `n`.
fn slider(system: &System, pulls: &Pulls, n: &Vec3, tools: &mut Tools) -> Slider {
    let along = |matrix: &Mat3| n.dot(&(matrix * n));
    let radial = tools.springs.radial();
    let stiffness = along(&pulls.elastic.hessian).abs().max(LEAST_STIFFNESS * radial);
    Slider {
        mass: n.dot(&masses(&system.load).component_mul(n)),
        damping: pulls.dashpots.as_ref().map_or(0.0, |dashpots| along(&dashpots.damping).max(0.0)),
        stiffness,
        friction: tools.resistance(system, n).loss,
    }
}

/// Diagonal of the mass matrix (kg, kg, kg m^2).
fn masses(load: &Load) -> Vec3 {
    Vec3::new(load.mass, load.mass, load.inertia)
}

/// A^-1 b of a symmetric A.
fn solve(a: &Mat3, b: &Vec3) -> Option<Vec3> {
    PositiveDefinite::new(a).map(|factor| factor.solve(b)).or_else(|| a.try_inverse().map(|inverse| inverse * b))
}
