//! The obstacles about a load: which steps need them, and the contacts that a step leaves behind.
//!
//! A step is first taken as if there were no obstacles, unless the load touches one. It stands
//! where the load cannot reach any obstacle in it, by a bound of its distance (the free-space
//! certificate) or by a look at the features near its end. Elsewhere it is solved with the features
//! within reach. Displacements that could pass over a feature are looked at piece by piece, and cut
//! before the first one that they would pass.

use smallvec::SmallVec;

use super::candidates::{Candidate, Candidates, gap_rounding};
use super::gate::Gate;
use super::surroundings::{Pair, Surroundings};
use super::touching::Touching;
use crate::backend::friction::FrictionSolver;
use crate::backend::increment::{Increment, Step, minimise_step};
use crate::backend::numerics::{ALIKE, KEPT_GAP, MOST_CLOSINGS, SOFTER, SQUEEZED};
use crate::backend::springs::{Place, Travel};
use crate::math::{Arc, Pose, Vec3, rotation};
use crate::model::{ObstaclePath, System};

/// What a step did at the obstacles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SideWork {
    /// Energy lost to side friction (J).
    pub friction: f64,
    /// Work of moving obstacles on the load (J).
    pub of_obstacles: f64,
    /// Bound of the energy that a step of first order mistakes (J).
    pub uncertainty: f64,
    /// Share of the step at which it ends: before an obstacle that it would have passed, or where
    /// no longer path has an answer. `None` for a whole step.
    pub cut: Option<f64>,
    /// Shift along the load's axes at the end, and turn, that close overlaps by rounding (m, m,
    /// rad).
    pub push_out: Vec3,
    /// Against which the load has moved; `None` for none.
    pub resistance: Option<Resistance>,
}

/// A resistance to a load that is proportional to its displacement. It holds a load that has come
/// out of balance near its path, which is that of a load in a viscous fluid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resistance {
    /// (N/m)
    pub stiffness: f64,
    /// Size of the displacement (m).
    pub moved: f64,
    /// Whether no softer one has failed.
    pub may_soften: bool,
}

impl Resistance {
    pub fn softer(&self) -> f64 {
        self.next() / SOFTER
    }

    /// Stiffness to try next (N/m): a softer one, or the same where a softer one has failed.
    pub fn next(&self) -> f64 {
        if self.may_soften { self.stiffness / SOFTER } else { self.stiffness }
    }
}

/// A step: when it begins and ends, and the guess of its increment.
#[derive(Clone, Copy, Debug)]
pub struct Task {
    /// (s)
    pub from: f64,
    /// (s)
    pub to: f64,
    /// Length (s), with more digits than the difference of these times.
    pub step: f64,
    pub guess: Option<Vec3>,
    /// Whether the load has inertia: an overlap by rounding is closed without a speed.
    pub has_inertia: bool,
    /// Whether a load without inertia goes on to a balance that is not near.
    pub may_jump: bool,
    pub scope: Scope,
    /// Whether forces change smoothly since the last step: then their works are those of the
    /// trapezoid rule, and otherwise those of the forces at the end.
    pub is_smooth: bool,
    /// Resistance of the leg before on the same path.
    pub resistance: Option<Resistance>,
}

impl Task {
    /// The last `step` (s) before a time (s), for a load with inertia.
    pub fn inertial(end: f64, step: f64, guess: Option<Vec3>, scope: Scope, is_smooth: bool) -> Self {
        Self { from: end - step, to: end, step, guess, has_inertia: true, may_jump: false, scope, is_smooth, resistance: None }
    }
}

/// Features that a step looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// Those that touch at the start, and those that the load slides on to from there.
    Touching,
    /// All within reach.
    Near,
}

/// The obstacles, with what is known of their distance.
#[derive(Clone, Debug)]
pub struct Obstacles {
    pub(super) surroundings: Surroundings,
    /// Place and time of a distance from all obstacles (m).
    pub(super) clear: Option<(Place, f64, f64)>,
    gate: Gate,
}

impl Obstacles {
    /// Whether a contact is one of features that are there.
    pub fn have(&self, touching: &Touching) -> bool {
        self.surroundings.has(&touching.key)
    }

    /// The obstacles of a system; `None` without any.
    pub fn of(system: &System) -> Option<Self> {
        (!system.world.is_empty()).then(|| Self { surroundings: Surroundings::new(system), clear: None, gate: Gate::of(system) })
    }

    /// Takes note of the path of an obstacle, which is a new one.
    pub fn meet_path(&mut self, system: &System, obstacle: usize) {
        self.surroundings.meet_path(system, obstacle);
        self.clear = None;
    }

    /// The step, with the contacts that it ends in.
    pub fn find(
        &mut self,
        system: &System,
        step: &mut Step,
        solver: &mut FrictionSolver,
        touching: &mut Vec<Touching>,
        task: &Task,
    ) -> (Increment, SideWork) {
        if touching.is_empty() {
            let warm_start = solver.warm_start().clone();
            let free = minimise_step(step, solver, task.guess);
            if self.is_free(system, &step.potential.start, &free.twist, task) {
                return (free, SideWork::default());
            }
            solver.set_warm_start(warm_start).expect("it is the solver's own");
        }
        self.find_with_contacts(system, step, solver, touching, task)
    }

    /// Distance that the load is certainly away from all obstacles (m), at the start of the task.
    pub(super) fn known_clearance(&self, system: &System, at: &Place, time: f64) -> f64 {
        let Some((place, since, clearance)) = &self.clear else { return 0.0 };
        clearance - at.pose.edge_displacement(&place.pose, system.load.radius) - self.surroundings.longest_path(system, *since, time)
    }

    /// Whether nothing can touch a load that stands still at `at` between two times (s).
    pub fn is_far(&mut self, system: &System, at: &Place, [from, to]: [f64; 2]) -> bool {
        let shift = self.surroundings.longest_path(system, from, to);
        if self.known_clearance(system, at, from) > shift {
            return true;
        }
        let clearance = self.surroundings.clearance(system, at, from, 0.0);
        self.clear = Some((*at, from, clearance));
        clearance > shift
    }

    /// Whether a load at `at` is nearer than `reach` (m) to an obstacle at `time` (s), or crosses
    /// one.
    pub fn is_near(&mut self, system: &System, at: &Place, time: f64, reach: f64) -> bool {
        if self.known_clearance(system, at, time) > reach {
            return false;
        }
        let clearance = self.surroundings.clearance(system, at, time, reach);
        self.clear = Some((*at, time, clearance));
        clearance < reach || self.surroundings.crosses(system, at, time, 0.0)
    }

    /// Largest depth by which a load at `at` lies inside an obstacle at `time` (m); zero for what
    /// is rounding. See `gate`.
    pub fn depth(&mut self, system: &System, at: &Place, time: f64) -> f64 {
        let of_obstacle = |index: &usize| {
            let seen = Surroundings::relative(at, &system.world.obstacles[*index].path.pose_at(time));
            self.gate.depth(*index, &seen)
        };
        self.surroundings.near(system, at, time).iter().map(of_obstacle).fold(0.0, f64::max)
    }

    /// Obstacles so near to the load at `time` (s) that they may squeeze it.
    pub fn next_to(&mut self, system: &System, at: &Place, time: f64) -> Vec<usize> {
        let near = 2.0 * SQUEEZED * system.load.radius;
        let is_next_to = |index: &usize| {
            let seen = Surroundings::relative(at, &system.world.obstacles[*index].path.pose_at(time));
            self.gate.is_within(*index, &seen, near)
        };
        (0..system.world.obstacles.len()).filter(is_next_to).collect()
    }

    /// Longest path of a point of an obstacle between two times (s), in metres.
    pub fn longest_path(&self, system: &System, from: f64, to: f64) -> f64 {
        self.surroundings.longest_path(system, from, to)
    }

    /// Path of an obstacle between two times (s), over the radius by which it bends about the load
    /// or the load about it (1); the largest one.
    pub fn longest_bend(&self, system: &System, from: f64, to: f64) -> f64 {
        self.surroundings.longest_bend(system, from, to)
    }

    /// Whether an increment touches nothing.
    fn is_free(&mut self, system: &System, start: &Place, twist: &Vec3, task: &Task) -> bool {
        let moved = twist.xy().norm() + system.load.radius * twist.z.abs() + self.surroundings.longest_path(system, task.from, task.to);
        if self.known_clearance(system, start, task.from) > moved {
            return true;
        }
        let is_free = self.first_hit(system, start, twist, task, &[]).is_none();
        if is_free {
            let end = start.moved_by(twist);
            self.clear = Some((end, task.to, self.surroundings.clearance(system, &end, task.to, 0.0)));
        }
        is_free
    }

    /// The pose near `pose` at which the contacts are closed that were at the end of a step. Sums
    /// of poses that keep to a curve leave it.
    pub fn close(&self, system: &System, pose: &Pose, touching: &[Touching], time: f64) -> Pose {
        let (mobility, mut closed) = (mobility(system), *pose);
        for _ in 0..MOST_CLOSINGS {
            let mut worst = 0.0f64;
            for Touching { key, force, .. } in touching {
                let seen = Surroundings::relative(&Place::of(&closed), &system.world.obstacles[key.obstacle].path.pose_at(time));
                let features = self.surroundings.features(key);
                let gap = features.gap_with_derivatives(&seen, features.gap(&seen));
                let missing = if force.normal > 0.0 { -gap.energy } else { (-gap.energy).max(0.0) };
                let along = gap.gradient.component_mul(&mobility);
                closed = closed.moved_by(&(missing / gap.gradient.dot(&along) * along));
                worst = worst.max(missing.abs());
            }
            if worst <= f64::EPSILON * system.load.radius {
                break;
            }
        }
        closed
    }

    /// Pairs that a load may touch within `reach` (m).
    pub(super) fn pairs_within(&mut self, system: &System, at: &Place, time: f64, reach: f64) -> Vec<Pair> {
        let mut pairs = Vec::new();
        self.surroundings.pairs(system, at, time, reach + KEPT_GAP * system.load.radius, &mut pairs);
        pairs
    }

    /// See [`Surroundings::beside`].
    pub(super) fn beside(&self, pair: &Pair, at: &Place) -> f64 {
        self.surroundings.beside(&pair.key, at)
    }

    /// Whether a pair is closed.
    pub(super) fn is_closed(&self, system: &System, pair: &Pair, at: &Place, time: f64) -> bool {
        let seen = Surroundings::relative(at, &system.world.obstacles[pair.key.obstacle].path.pose_at(time));
        let closed = KEPT_GAP * system.load.radius;
        pair.features.gap(&seen) <= closed && self.surroundings.beside(&pair.key, &seen) <= closed
    }

    pub(super) fn candidates(&mut self, system: &System, start: &Place, task: &Task, reach: f64, touching: &[Touching]) -> Candidates {
        let mut pairs = Vec::new();
        self.surroundings.pairs(system, start, task.from, reach, &mut pairs);
        let touches = |pair: &Pair| touching.iter().any(|touching| touching.key == pair.key);
        let closed: SmallVec<[Pair; 4]> = pairs.iter().filter(|pair| touches(pair)).copied().collect();
        if task.scope == Scope::Touching {
            pairs.retain(|pair| touches(pair) || closed.iter().any(|closed| self.takes_over(system, [closed, pair], (start, task), reach)));
        }
        let candidate = |mut pair: Pair| {
            pair.is_held = closed.iter().any(|closed| self.is_same_face(system, [closed, &pair], (start, task)));
            self.candidate(system, start, task, pair, touching)
        };
        pairs.into_iter().map(candidate).collect()
    }

    /// Place of the load in the frame of the obstacle of a pair, when a step begins.
    fn seen(&self, system: &System, pair: &Pair, (start, task): (&Place, &Task)) -> Place {
        Surroundings::relative(start, &system.world.obstacles[pair.key.obstacle].path.pose_at(task.from))
    }

    /// Whether the load may go on touching by the second of two pairs where it leaves the first:
    /// one that is closed already, or that lies within `reach` (m) of where it touches. Farther
    /// away, features that belong together, such as the face of a load and its corner, touch anew:
    /// that is an impact.
    fn takes_over(&self, system: &System, [closed, next]: [&Pair; 2], (start, task): (&Place, &Task), reach: f64) -> bool {
        let seen = |pair: &Pair| self.seen(system, pair, (start, task));
        let is_near = || {
            let [one, other] = [closed, next].map(|pair| pair.features.contact_point(&seen(pair)));
            (one - other).norm() <= reach
        };
        let is_closed = || next.features.gap(&seen(next)) <= self.surroundings.flush(start);
        self.surroundings.continues((system, start, task.from), [closed, next]) && (is_closed() || is_near())
    }

    /// Whether the second of two pairs belongs to the face by which the load touches at the first
    /// one: on the same line, and as closed as rounding tells.
    fn is_same_face(&self, system: &System, [closed, next]: [&Pair; 2], (start, task): (&Place, &Task)) -> bool {
        let [one, other] = [closed, next].map(|pair| self.seen(system, pair, (start, task)));
        let is_alike = || closed.features.normal(&one).dot(&next.features.normal(&other)) >= ALIKE;
        next.features.gap(&other).abs() <= self.surroundings.flush(start)
            && self.surroundings.continues((system, start, task.from), [closed, next])
            && (closed.key.obstacle != next.key.obstacle || is_alike())
    }

    /// The pairs that touch, as candidates.
    pub(super) fn touching_candidates(&self, system: &System, start: &Place, task: &Task, touching: &[Touching]) -> Candidates {
        let pair = |touching: &Touching| self.surroundings.pair(system, touching.key);
        touching.iter().map(|it| self.candidate(system, start, task, pair(it), touching)).collect()
    }

    fn candidate(&self, system: &System, start: &Place, task: &Task, pair: Pair, touching: &[Touching]) -> Candidate {
        let path = &system.world.obstacles[pair.key.obstacle].path;
        let last = touching.iter().find(|touching| touching.key == pair.key);
        let near = last.map_or(0.0, |touching| touching.slip);
        let pair = Pair { is_held: pair.is_held || last.is_some(), ..pair };
        let at_start = Surroundings::relative(start, &path.pose_at(task.from));
        let (gap, slip) = (pair.features.gap(&at_start), pair.features.slip(&at_start, near));
        let has_touched = last.is_some() && gap <= gap_rounding(&start.pose, system.load.radius);
        let is_rounding = task.has_inertia && (gap < 0.0 || has_touched) && self.surroundings.beyond(&pair, [&at_start; 2]) <= 0.0;
        let closed = if is_rounding { gap } else { 0.0 };
        let still = Candidate { pair, before: at_start, start: at_start, gap: gap - closed, slip, slipped: 0.0, closed };
        if !path.moves() {
            return still;
        }
        let moved = Surroundings::relative(start, &path.pose_at(task.to));
        let travel = travel_seen(path, task, &at_start);
        let gap = still.gap + pair.features.gap_change([&at_start, &moved], &travel);
        Candidate { start: moved, gap, slipped: pair.features.slip_change([&at_start, &moved], &travel), ..still }
    }
}

/// Displacement of a load that stands still, seen by an obstacle that moves along a path, in whose
/// frame it is at `start` when a step begins.
fn travel_seen(path: &ObstaclePath, task: &Task, start: &Place) -> Travel {
    let (shift, turn) = path.displacement([task.from, task.to], task.step);
    let arc = Arc::of(-turn);
    Travel { shift: arc.turning(&start.pose.position) - rotation(-path.pose_at(task.to).heading) * shift, arc }
}

/// Directions in which contact forces move the load (1, 1, 1/m^2): the inverse of its inertia, over
/// that of its mass.
pub(super) fn mobility(system: &System) -> Vec3 {
    Vec3::new(1.0, 1.0, system.load.mass / system.load.inertia)
}
