//! The obstacles about a load: which steps need them, and the contacts that a step leaves behind.
//!
//! A step is first taken as if there were no obstacles, unless the load touches one. It stands where
//! the load cannot reach any obstacle in it, by a bound of its distance (the free-space certificate)
//! or by a look at the features near its end. Elsewhere it is solved with the features within reach.
//! Displacements that could pass over a feature are looked at piece by piece, and cut before the
//! first one that they would pass.

use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

use super::gap::FeaturePair;
use super::solve::{SideForce, SideMode};
use super::step::{CLOSED, Candidate, ContactStep, Found, Sides};
use super::surroundings::{Pair, PairKey, Surroundings};
use crate::backend::friction::FrictionSolver;
use crate::backend::increment::{Coasting, Increment, Objective, Step, minimise_step};
use crate::backend::springs::Place;
use crate::backend::{Status, StepReport, TransitionKind};
use crate::math::{Pose, Vec2, Vec3};
use crate::model::System;

/// A contact that is closed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Touching {
    pub key: PairKey,
    pub mode: SideMode,
    pub force: SideForce,
    /// Slip coordinate (m).
    pub slip: f64,
    /// Force on the load (N, world) and where it acts (m, world).
    pub on_load: [Vec2; 2],
}

/// What a step did at the obstacles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SideWork {
    /// Energy lost to side friction (J).
    pub friction: f64,
    /// Work of moving obstacles on the load (J).
    pub of_obstacles: f64,
    /// Bound of the energy that a step of first order mistakes (J).
    pub uncertainty: f64,
    /// Share of the step at which it ends: before an obstacle that it would have passed, or where no
    /// longer path has an answer. `None` for a whole step.
    pub cut: Option<f64>,
    /// Shift along the load's axes at the end, and turn, that close overlaps by rounding (m, m, rad).
    pub push_out: Vec3,
}

/// A step: when it begins and ends, and the guess of its increment.
#[derive(Clone, Copy, Debug)]
pub struct Task {
    /// (s)
    pub from: f64,
    /// (s)
    pub to: f64,
    pub guess: Option<Vec3>,
    /// Whether the load has inertia: an overlap by rounding is closed without a speed.
    pub has_inertia: bool,
    pub scope: Scope,
}

/// Features that a step looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// Those that touch at the start, and those that the load slides on to from there.
    Touching,
    /// All within reach.
    Near,
}

/// Answer of a step with the features within reach.
struct Answer {
    found: Found,
    candidates: Vec<Candidate>,
    /// Share of the increment at which it is cut, before a feature that it would pass.
    cut: Option<f64>,
    /// Whether the load would overlap an obstacle there: a straight path along one cuts its corner.
    overlaps_at_cut: bool,
}

impl Answer {
    /// Whether the step did not converge, or is not one to go.
    fn is_poor(&self) -> bool {
        self.found.increment.report.status != Status::Converged || self.overlaps_at_cut
    }
}

/// The obstacles, with what is known of their distance.
#[derive(Debug)]
pub struct Obstacles {
    surroundings: Surroundings,
    /// Place and time of a distance from all obstacles (m).
    clear: Option<(Place, f64, f64)>,
}

/// Share of the smallest feature that a load moves by in one piece (1).
const PIECE: f64 = 0.25;
/// Most pieces of a displacement (1).
const MOST_PIECES: usize = 4096;
/// Reach of the first look for features, over the load's radius (1).
const REACH: f64 = 0.01;
/// Most times that the motion of the obstacles in a step is halved (1).
const MOST_HALVINGS: i32 = 6;
/// Displacement over the load's radius to which the first resistance holds the load (1), the ratio
/// of one resistance to the one before, and their number.
const SOFTEST: f64 = 0.3;
const STIFFER: f64 = 8.0;
const MOST_RESISTANCES: usize = 6;
/// Increment, over the load's radius, that is none (1).
const SHORTEST: f64 = 1e-9;
/// Most rounds in which contacts are closed (1): each takes an error to its square, but for contacts
/// that open each other.
const MOST_CLOSINGS: usize = 12;
/// Most attempts with farther and farther features (1).
const MOST_ATTEMPTS: usize = 12;

impl Obstacles {
    /// The obstacles of a system; `None` without any.
    pub fn of(system: &System) -> Option<Self> {
        (!system.world.is_empty()).then(|| Self { surroundings: Surroundings::new(system), clear: None })
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
    fn known_clearance(&self, system: &System, at: &Place, time: f64) -> f64 {
        let Some((place, since, clearance)) = &self.clear else { return 0.0 };
        clearance - at.pose.edge_displacement(&place.pose, system.load.radius) - self.surroundings.longest_path(system, *since, time)
    }

    /// Whether nothing can touch a load that stands still at `at` between two times (s).
    pub fn is_far(&mut self, system: &System, at: &Place, [from, to]: [f64; 2]) -> bool {
        let shift = self.surroundings.longest_path(system, from, to);
        if self.known_clearance(system, at, from) > shift {
            return true;
        }
        let clearance = self.surroundings.clearance(system, at, from);
        self.clear = Some((*at, from, clearance));
        clearance > shift
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
            self.clear = Some((end, task.to, self.surroundings.clearance(system, &end, task.to)));
        }
        is_free
    }

    /// Share of an increment after which a load meets a feature, at the start of the piece in which it
    /// does; `None` for a free path. The `known` features are left out where the end of the increment
    /// says all of them, and those that touch anywhere.
    fn first_hit(&mut self, system: &System, start: &Place, twist: &Vec3, task: &Task, known: &[(PairKey, bool)]) -> Option<f64> {
        let is_known = |pair: &Pair, n_pieces: usize| known.iter().any(|(key, touches)| *key == pair.key && (*touches || n_pieces == 1));
        let (_, [share, _]) = self.hits(system, start, twist, [task.from, task.to], is_known)?;
        Some(share)
    }

    /// Features that a load passes through along an increment between two times (s), but the known
    /// ones, in the first piece in which it does, with the shares between which this piece lies.
    /// Whether a pair is known may depend on the number of pieces. `None` for a free path.
    pub(super) fn hits(
        &mut self,
        system: &System,
        start: &Place,
        twist: &Vec3,
        [from, to]: [f64; 2],
        is_known: impl Fn(&Pair, usize) -> bool,
    ) -> Option<(Vec<Pair>, [f64; 2])> {
        let of_load = twist.xy().norm() + system.load.radius * twist.z.abs();
        let moved = of_load + self.surroundings.longest_path(system, from, to);
        if self.known_clearance(system, start, from) > moved {
            return None;
        }
        let n_pieces = (moved / (PIECE * self.surroundings.fineness())).ceil().clamp(1.0, MOST_PIECES as f64) as usize;
        let closed = CLOSED * system.load.radius;
        let mut pairs = Vec::new();
        let at = |piece: usize| {
            let share = piece as f64 / n_pieces as f64;
            (start.moved_by(&(share * twist)), from + share * (to - from))
        };
        for piece in 0..n_pieces {
            let ((here, now), (there, then)) = (at(piece), at(piece + 1));
            pairs.clear();
            let reach = 1.001 * (of_load / n_pieces as f64 + self.surroundings.longest_path(system, now, then)) + closed;
            self.surroundings.pairs(system, &here, now, reach, &mut pairs);
            let is_hit = |pair: &Pair| {
                let path = &system.world.obstacles[pair.key.obstacle].path;
                let start = Surroundings::relative(&here, &path.pose_at(now));
                let end = Surroundings::relative(&there, &path.pose_at(then));
                let (gap, beyond) = (pair.features.gap(&end), self.surroundings.beyond(pair, &end));
                gap < -closed && beyond <= 0.0 && !self.surroundings.passes_end(pair, &start, &end)
            };
            pairs.retain(|pair| !is_known(pair, n_pieces) && is_hit(pair));
            if !pairs.is_empty() {
                return Some((pairs, [piece, piece + 1].map(|piece| piece as f64 / n_pieces as f64)));
            }
        }
        None
    }

    /// The pose near `pose` at which the contacts are closed that were at the end of a step. Sums of
    /// poses that keep to a curve leave it.
    pub fn close(&self, system: &System, pose: &Pose, touching: &[Touching], time: f64) -> Pose {
        let (mobility, mut closed) = (mobility(system), *pose);
        for _ in 0..MOST_CLOSINGS {
            let mut worst = 0.0f64;
            for Touching { key, force, .. } in touching {
                let seen = Surroundings::relative(&Place::of(&closed), &system.world.obstacles[key.obstacle].path.pose_at(time));
                let gap = self.surroundings.features(key).gap_with_derivatives(&seen);
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
        self.surroundings.pairs(system, at, time, reach + 10.0 * CLOSED * system.load.radius, &mut pairs);
        pairs
    }

    /// See [`Surroundings::beyond`].
    pub(super) fn beyond(&self, pair: &Pair, at: &Place) -> f64 {
        self.surroundings.beyond(pair, at)
    }

    /// Whether a pair is closed.
    pub(super) fn is_closed(&self, system: &System, pair: &Pair, at: &Place, time: f64) -> bool {
        let seen = Surroundings::relative(at, &system.world.obstacles[pair.key.obstacle].path.pose_at(time));
        let closed = 10.0 * CLOSED * system.load.radius;
        pair.features.gap(&seen) <= closed && self.surroundings.beyond(pair, &seen) <= closed
    }

    /// The step with the features within reach. Where a load without inertia has no answer there, or
    /// one that leads through an obstacle, it takes a shorter path: to where the obstacles are half
    /// way, or against a resistance that is proportional to its displacement.
    fn find_with_contacts(
        &mut self,
        system: &System,
        step: &mut Step,
        solver: &mut FrictionSolver,
        touching: &mut Vec<Touching>,
        task: &Task,
    ) -> (Increment, SideWork) {
        let start = step.potential.start;
        let mut answer = self.find_near(system, step, solver, touching, task);
        let mut cut = answer.cut;
        if answer.is_poor() && task.scope == Scope::Near && !task.has_inertia {
            let report = answer.found.increment.report;
            if let Some((other, share)) = self.find_shorter(system, step, solver, touching, task) {
                (answer, cut) = (other, Some(share));
                answer.found.increment.report.n_solves += report.n_solves;
                answer.found.increment.report.n_iterations += report.n_iterations;
            }
        }
        if let Some(share) = answer.cut {
            let twist = share * answer.found.increment.twist;
            let Increment { mode, mut report, .. } = answer.found.increment;
            if answer.overlaps_at_cut {
                (report.status, report.n_not_converged) = (report.status.max(Status::NotConverged), 1);
            }
            touching.clear();
            return (step.found(&twist, mode, report), SideWork { cut, ..SideWork::default() });
        }
        let end = if let Some(share) = cut { task.from + share * (task.to - task.from) } else { task.to };
        let of_found = &mut answer.found.increment.report;
        of_found.is_indeterminate = !answer.found.are_forces_unique;
        if answer.found.sides.iter().any(|(_, force)| force.normal > 0.0) {
            of_found.contact_residual = of_found.residual;
        }
        let work = self.accept(system, &start, &Task { to: end, ..*task }, &answer, touching);
        (answer.found.increment, SideWork { cut, ..work })
    }

    /// Answer of a shorter path, and the share of the time of the step at its end.
    fn find_shorter(
        &mut self,
        system: &System,
        step: &mut Step,
        solver: &mut FrictionSolver,
        touching: &[Touching],
        task: &Task,
    ) -> Option<(Answer, f64)> {
        let warm_start = solver.warm_start().clone();
        let n_moving = if self.surroundings.longest_path(system, task.from, task.to) > 0.0 { MOST_HALVINGS } else { 0 };
        for halving in 1..=n_moving {
            let share = 0.5f64.powi(halving);
            let to = task.from + share * (task.to - task.from);
            solver.set_warm_start(warm_start.clone()).expect("it is the solver's own");
            let answer = self.find_near(system, step, solver, touching, &Task { to, guess: None, ..*task });
            if !answer.is_poor() && answer.cut.is_none() {
                return Some((answer, share));
            }
        }
        let length = system.load.radius;
        let gradient = step.gradient(&Vec3::zeros());
        let mut stiffness = (gradient.xy().norm() + gradient.z.abs() / length) / (SOFTEST * length);
        for _ in 0..MOST_RESISTANCES {
            step.potential.inertia =
                Some(Coasting { shift: Vec2::zeros(), turn: 0.0, stiffness: (stiffness, stiffness * length * length) });
            solver.set_warm_start(warm_start.clone()).expect("it is the solver's own");
            let answer = self.find_near(system, step, solver, touching, &Task { guess: None, ..*task });
            step.potential.inertia = None;
            if !answer.is_poor() && answer.cut.is_none() {
                let moves = step.size(&answer.found.increment.twist) > SHORTEST;
                return moves.then_some((answer, 1.0));
            }
            stiffness *= STIFFER;
        }
        None
    }

    /// Whether a pair overlaps by more than rounding.
    fn overlaps(&self, system: &System, pair: &Pair, at: &Place, time: f64) -> bool {
        let seen = Surroundings::relative(at, &system.world.obstacles[pair.key.obstacle].path.pose_at(time));
        pair.features.gap(&seen) < -10.0 * CLOSED * system.load.radius && self.surroundings.beyond(pair, &seen) <= 0.0
    }

    /// The step with the features within reach, which is widened until it suffices.
    fn find_near(&mut self, system: &System, step: &mut Step, solver: &mut FrictionSolver, touching: &[Touching], task: &Task) -> Answer {
        let (start, radius) = (step.potential.start, system.load.radius);
        let shift = self.surroundings.longest_path(system, task.from, task.to);
        let size = |twist: &Vec3| twist.xy().norm() + radius * twist.z.abs();
        let mut reach = 2.0 * shift + (REACH * radius).max(2.0 * task.guess.as_ref().map_or(0.0, size));
        let warm_start = solver.warm_start().clone();
        let mut report = StepReport::default();
        let mut attempt = 0;
        loop {
            let candidates = self.candidates(system, &start, task, reach, touching);
            let suggested = suggested(&candidates, touching);
            let mut contact = ContactStep { step, surroundings: &self.surroundings, candidates: &candidates };
            let mut found = contact.find(solver, &suggested, task.guess);
            report.n_solves += found.increment.report.n_solves;
            report.n_iterations += found.increment.report.n_iterations;
            let hit = self.hit_of(system, &start, task, (&candidates, &found), touching);
            attempt += 1;
            // A load with inertia takes the whole step.
            let moved = size(&found.increment.twist) + shift;
            let is_hit = hit == Some(0.0) || task.has_inertia && hit.is_some();
            if is_hit && attempt < MOST_ATTEMPTS && reach < 2.0 * moved {
                reach = (4.0 * reach).min(2.0 * moved);
                solver.set_warm_start(warm_start.clone()).expect("it is the solver's own");
                continue;
            }
            let of_found = &mut found.increment.report;
            (of_found.n_solves, of_found.n_iterations) = (report.n_solves, report.n_iterations);
            let cut = hit.filter(|share| *share > 0.0 && !task.has_inertia);
            if hit.is_some() && cut.is_none() {
                of_found.status = of_found.status.max(Status::NotConverged);
                of_found.n_not_converged = 1;
            }
            let at_cut = cut.map(|share| (start.moved_by(&(share * found.increment.twist)), task.from + share * (task.to - task.from)));
            let overlaps_at_cut =
                at_cut.is_some_and(|(place, time)| candidates.iter().any(|it| self.overlaps(system, &it.pair, &place, time)));
            return Answer { found, candidates, cut, overlaps_at_cut };
        }
    }

    /// Share of the increment after which the load meets a feature that its candidates leave out.
    fn hit_of(
        &mut self,
        system: &System,
        start: &Place,
        task: &Task,
        (candidates, found): (&[Candidate], &Found),
        touching: &[Touching],
    ) -> Option<f64> {
        if task.scope == Scope::Touching {
            return None;
        }
        let touches = |key: &PairKey, force: &SideForce| force.normal > 0.0 || touching.iter().any(|touching| touching.key == *key);
        let sides = candidates.iter().zip(&found.sides);
        let known: SmallVec<[(PairKey, bool); 4]> = sides.map(|(it, (_, force))| (it.pair.key, touches(&it.pair.key, force))).collect();
        let twist = &found.increment.twist;
        self.first_hit(system, start, twist, task, &known)
            .or_else(|| self.overlaps_at_end(system, start, twist, task, &known).then_some(0.0))
    }

    /// Whether features that were apart at the start overlap at the end of an increment, but the
    /// known ones. Those that the load reaches through a known one are not on the path elsewhere.
    fn overlaps_at_end(&mut self, system: &System, start: &Place, twist: &Vec3, task: &Task, known: &[(PairKey, bool)]) -> bool {
        let of_load = twist.xy().norm() + system.load.radius * twist.z.abs();
        let moved = of_load + self.surroundings.longest_path(system, task.from, task.to);
        if moved == 0.0 || !known.iter().any(|(_, touches)| *touches) {
            return false;
        }
        let closed = CLOSED * system.load.radius;
        let mut pairs = Vec::new();
        self.surroundings.pairs(system, start, task.from, 1.001 * moved + closed, &mut pairs);
        let end = start.moved_by(twist);
        pairs.iter().filter(|pair| !known.iter().any(|(key, _)| *key == pair.key)).any(|pair| {
            let path = &system.world.obstacles[pair.key.obstacle].path;
            let [before, after] = [(start, task.from), (&end, task.to)].map(|(at, time)| Surroundings::relative(at, &path.pose_at(time)));
            let overlaps = pair.features.gap(&after) < -closed && self.surroundings.beyond(pair, &after) <= 0.0;
            overlaps && !self.surroundings.passes_end(pair, &before, &after)
        })
    }

    fn candidates(&mut self, system: &System, start: &Place, task: &Task, reach: f64, touching: &[Touching]) -> Vec<Candidate> {
        let mut pairs = Vec::new();
        self.surroundings.pairs(system, start, task.from, reach, &mut pairs);
        if task.scope == Scope::Touching {
            let touches = |pair: &Pair| touching.iter().any(|touching| touching.key == pair.key);
            let closed: SmallVec<[Pair; 4]> = pairs.iter().filter(|pair| touches(pair)).copied().collect();
            pairs.retain(|pair| touches(pair) || closed.iter().any(|closed| self.surroundings.continues(closed, pair)));
        }
        let candidate = |pair: Pair| {
            let path = &system.world.obstacles[pair.key.obstacle].path;
            let near = touching.iter().find(|touching| touching.key == pair.key).map_or(0.0, |touching| touching.slip);
            let at_start = Surroundings::relative(start, &path.pose_at(task.from));
            let slip = pair.features.slip(&at_start, near);
            let overlaps = task.has_inertia && self.surroundings.beyond(&pair, &at_start) <= 0.0;
            let least_gap = if overlaps { pair.features.gap(&at_start).min(0.0) } else { 0.0 };
            Candidate { pair, start: Surroundings::relative(start, &path.pose_at(task.to)), slip, least_gap }
        };
        pairs.into_iter().map(candidate).collect()
    }

    /// Keeps the closed contacts of a step and returns its work at the obstacles.
    fn accept(
        &mut self,
        system: &System,
        start: &Place,
        task: &Task,
        Answer { found, candidates, .. }: &Answer,
        touching: &mut Vec<Touching>,
    ) -> SideWork {
        let closed = 10.0 * CLOSED * system.load.radius;
        let mut work = SideWork::default();
        let last = std::mem::take(touching);
        for (candidate, (mode, force)) in candidates.iter().zip(&found.sides) {
            let Candidate { pair: Pair { key, features, .. }, start: moved, slip, .. } = candidate;
            let end = moved.moved_by(&found.increment.twist);
            let (gap_at_end, slip_at_end) = (features.gap(&end), features.slip(&end, *slip));
            let obstacle = system.world.obstacles[key.obstacle].path.pose_at(task.to);
            if force.normal > 0.0 {
                let before = last.iter().find(|touching| touching.key == *key).map_or(SideForce::default(), |touching| touching.force);
                let slipped = slip_at_end - slip;
                work.friction += (-force.tangential * slipped).max(0.0);
                let gap_at_start = features.gap(moved);
                work.uncertainty += force.normal * gap_at_start.max(0.0) + (force.tangential - before.tangential).abs() * slipped.abs();
                if system.world.obstacles[key.obstacle].path.moves() {
                    let standing = Surroundings::relative(start, &system.world.obstacles[key.obstacle].path.pose_at(task.from));
                    let approach = features.gap(&standing) - gap_at_start;
                    let drag = slip - features.slip(moved, *slip);
                    let mean = |a: f64, b: f64| 0.5 * (a + b);
                    let (normal, tangential) = (mean(before.normal, force.normal), mean(before.tangential, force.tangential));
                    work.of_obstacles += normal * approach + tangential * drag;
                    work.uncertainty += (force.normal - before.normal).abs() * approach.abs();
                }
            }
            if candidate.least_gap < 0.0 && gap_at_end < 0.0 {
                let normal = features.gap_with_derivatives(&end).gradient;
                let along = normal.component_mul(&mobility(system));
                work.push_out += (-gap_at_end - normal.dot(&work.push_out)).max(0.0) / normal.dot(&along) * along;
            }
            if gap_at_end <= closed && self.surroundings.beyond(&candidate.pair, &end) <= closed {
                let on_load = on_load(features, force, &end, &obstacle);
                touching.push(Touching { key: *key, mode: *mode, force: *force, slip: slip_at_end, on_load });
            }
        }
        self.clear = None;
        work
    }
}

/// Force of a contact on the load (N, world) and where it acts (m, world), for a load at `at` in the
/// frame of an obstacle.
pub(super) fn on_load(features: &FeaturePair, force: &SideForce, at: &Place, obstacle: &crate::math::Pose) -> [Vec2; 2] {
    let normal = features.normal(at);
    let in_frame = force.normal * normal + force.tangential * crate::math::perpendicular(&normal);
    [crate::math::rotation(obstacle.heading) * in_frame, obstacle.to_world(&features.contact_point(at))]
}

/// Directions in which contact forces move the load (1, 1, 1/m^2): the inverse of its inertia, over
/// that of its mass.
fn mobility(system: &System) -> Vec3 {
    Vec3::new(1.0, 1.0, system.load.mass / system.load.inertia)
}

/// Modes and forces of the candidates in the last step.
fn suggested(candidates: &[Candidate], touching: &[Touching]) -> Sides {
    let last = |candidate: &Candidate| touching.iter().find(|touching| touching.key == candidate.pair.key);
    candidates
        .iter()
        .map(|candidate| last(candidate).map_or((SideMode::Open, SideForce::default()), |last| (last.mode, last.force)))
        .collect()
}

/// What happened at the obstacles between two sets of contacts.
pub fn transitions(before: &[Touching], after: &[Touching]) -> SmallVec<[TransitionKind; 2]> {
    let mut kinds = SmallVec::new();
    let of = |touching: &[Touching], obstacle: usize| {
        let mine = || touching.iter().filter(move |touching| touching.key.obstacle == obstacle);
        (mine().count() > 0).then(|| mine().any(|touching| touching.mode == SideMode::Stick))
    };
    let mut obstacles: SmallVec<[usize; 4]> = before.iter().chain(after).map(|touching| touching.key.obstacle).collect();
    obstacles.sort_unstable();
    obstacles.dedup();
    for obstacle in obstacles {
        kinds.extend(match (of(before, obstacle), of(after, obstacle)) {
            (None, Some(_)) => Some(TransitionKind::Touch { obstacle }),
            (Some(_), None) => Some(TransitionKind::Separation { obstacle }),
            (Some(false), Some(true)) => Some(TransitionKind::SideStick { obstacle }),
            (Some(true), Some(false)) => Some(TransitionKind::SideSlip { obstacle }),
            _ => None,
        });
    }
    kinds
}
