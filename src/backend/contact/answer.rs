//! The answer of a step of a load at obstacles, and what it leaves behind.

use smallvec::SmallVec;

use super::candidates::{Candidate, Candidates, ContactStep, Local, Locals, Sides, gap_rounding};
use super::newton::Newton;
use super::obstacles::{Obstacles, Scope, SideWork, Task, mobility};
use super::solve::{SideForce, SideMode};
use super::step::Found;
use super::surroundings::{Pair, PairKey, Surroundings};
use super::touching::{Touching, on_load};
use crate::backend::friction::{ContactMode, FrictionSolver};
use crate::backend::increment::{Course, Increment, Straight};
use crate::backend::numerics::{CLOSED_GAP, KEPT_GAP};
use crate::backend::report::{Status, StepReport};
use crate::backend::springs::Place;
use crate::math::{Vec3, increment_of};
use crate::model::System;

/// Answer of a step with the features within reach.
pub struct Answer {
    pub found: Found,
    pub candidates: Candidates,
    /// Share of the increment at which it is cut, before a feature that it would pass.
    pub cut: Option<f64>,
    /// Whether a load without inertia stays where it is: it would overlap an obstacle at the end,
    /// or at the cut, as a straight path along one cuts its corner.
    pub stays: bool,
}

impl Answer {
    /// Whether the step did not converge, or is not one to go.
    pub fn is_poor(&self) -> bool {
        self.found.increment.report.status != Status::Converged || self.stays
    }

    /// Whether it is one to go, up to its end.
    pub fn is_whole(&self) -> bool {
        !self.is_poor() && self.cut.is_none()
    }
}

impl Obstacles {
    /// The step along a straight course, from a guess, in which all that touches goes on to do so
    /// in the same modes, with its increment along that course; `None` where there is none.
    pub fn go_on(
        &mut self,
        system: &System,
        course: &mut Straight,
        solver: &mut FrictionSolver,
        touching: &mut Vec<Touching>,
        task: &Task,
    ) -> Option<(Increment, SideWork, Vec3)> {
        let (start, guess) = (*course.start, task.guess?);
        let mut candidates = self.touching_candidates(system, &start, task, touching);
        let mut sides = suggested(&candidates, touching);
        if !self.stay_in_place(course, &candidates, &mut sides, &guess) {
            let reach = 2.0 * course.found(&guess, ContactMode::Slip, StepReport::default()).twist.xy().norm();
            candidates = self.candidates(system, &start, task, reach, touching);
            sides = suggested(&candidates, touching);
            self.stay_in_place(course, &candidates, &mut sides, &guess);
        }
        let mut contact =
            ContactStep { step: course, surroundings: &self.surroundings, candidates: &candidates, start_at: Vec3::zeros(), most_steps: 0 };
        let Newton { at, sides, are_forces_unique, report, .. } = contact.newton(&sides, guess, None).filter(|found| found.is_stable)?;
        let increment = course.found(&at, ContactMode::Slip, report);
        if !course.goes_on(&at, &increment) {
            return None;
        }
        solver.keep_gliding(&at);
        let found = Found { increment, sides, are_forces_unique, could_rest: false };
        let mut answer = Answer { found, candidates, cut: None, stays: false };
        let work = self.settle(system, &start, task, &mut answer, touching);
        Some((answer.found.increment, work, at))
    }

    /// Opens the contacts that features leave by their ends at an increment, and closes those that
    /// continue them, in the mode of one that was left. Returns whether none is left.
    fn stay_in_place(&self, course: &mut Straight, candidates: &[Candidate], sides: &mut Sides, at: &Vec3) -> bool {
        let closed = CLOSED_GAP * course.length();
        let mut locals = Locals::new();
        ContactStep { step: course, surroundings: &self.surroundings, candidates, start_at: Vec3::zeros(), most_steps: 0 }
            .fill_locals(at, &mut locals);
        let is_open = |mode: &SideMode| *mode == SideMode::Open;
        let left = |((mode, _), local): &(&(SideMode, SideForce), &Local)| !is_open(mode) && local.beyond > closed;
        let Some(mode) = sides.iter().zip(&locals).find(left).map(|((mode, _), _)| *mode) else { return true };
        for (side, local) in sides.iter_mut().zip(&locals) {
            if local.beyond > closed {
                *side = (SideMode::Open, SideForce::default());
            } else if is_open(&side.0) {
                side.0 = mode;
            }
        }
        false
    }

    /// Takes note of what is known of the contact forces, and accepts the answer.
    pub fn settle(&mut self, system: &System, start: &Place, task: &Task, answer: &mut Answer, touching: &mut Vec<Touching>) -> SideWork {
        let of_found = &mut answer.found.increment.report;
        of_found.is_indeterminate = !answer.found.are_forces_unique;
        of_found.doubts.n_not_unique = u64::from(answer.found.could_rest);
        if answer.found.sides.iter().any(|(_, force)| force.normal > 0.0) {
            of_found.contact_residual = of_found.residual;
        }
        self.accept(system, start, task, answer, touching)
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
        let closed = KEPT_GAP * system.load.radius;
        let rounding = gap_rounding(&start.pose, system.load.radius);
        let mut work = SideWork::default();
        let last = std::mem::take(touching);
        for (candidate, (mode, force)) in candidates.iter().zip(&found.sides) {
            let Candidate { pair: pair @ Pair { key, features, .. }, before, start: moved, slip, .. } = candidate;
            let end = moved.moved_by(&found.increment.twist);
            let (gap_at_end, slip_at_end) = (features.gap(&end), features.slip(&end, *slip));
            let path = &system.world.obstacles[key.obstacle].path;
            let obstacle = path.pose_at(task.to);
            if force.normal > 0.0 {
                let before = last.iter().find(|touching| touching.key == *key);
                let (force_before, on_load_before) = before.map_or_else(Default::default, |before| (before.force, before.on_load[0]));
                let slipped = slip_at_end - slip;
                let tangential = if task.is_smooth { 0.5 * (force_before.tangential + force.tangential) } else { force.tangential };
                work.friction += (-tangential * slipped).max(0.0);
                let gap_at_start = features.gap(moved);
                work.uncertainty +=
                    force.normal * gap_at_start.max(0.0) + (force.tangential - force_before.tangential).abs() * slipped.abs();
                if path.moves() {
                    let [force_now, point] = on_load(features, force, &end, &obstacle);
                    let shift = point - path.pose_at(task.from).to_world(&obstacle.to_local(&point));
                    work.of_obstacles += if force_before.normal > 0.0 {
                        0.5 * (on_load_before + force_now).dot(&shift)
                    } else {
                        // A contact that closes in the step has the whole force from then on.
                        let gap = features.gap(&Surroundings::relative(start, &path.pose_at(task.from)));
                        force_now.dot(&shift) - force.normal * gap.max(0.0)
                    };
                    work.uncertainty += (force_now - on_load_before).norm() * shift.norm();
                }
            }
            let beyond_at_end = self.surroundings.beyond(pair, [before, &end]);
            // What rounding has made of a gap is taken back without a speed.
            let overlaps = candidate.closed < 0.0 && gap_at_end < 0.0;
            let has_parted = force.normal > 0.0 && (rounding..=closed).contains(&(2.0 * gap_at_end));
            if task.has_inertia && (overlaps || has_parted) && beyond_at_end <= 0.0 {
                let normal = features.gap_with_derivatives(&end, gap_at_end).gradient;
                let along = normal.component_mul(&mobility(system));
                let missing = -gap_at_end - normal.dot(&work.push_out);
                work.push_out += if overlaps { missing.max(0.0) } else { missing } / normal.dot(&along) * along;
            }
            if gap_at_end <= closed && beyond_at_end <= closed {
                touching.push(Touching::new(pair, (*mode, *force, slip_at_end), &end, &obstacle));
            }
        }
        self.clear = None;
        work
    }

    /// Whether a pair overlaps by more than rounding.
    pub fn overlaps(&self, system: &System, key: &PairKey, at: &Place, time: f64) -> bool {
        let seen = Surroundings::relative(at, &system.world.obstacles[key.obstacle].path.pose_at(time));
        let pair = self.surroundings.pair(system, *key);
        pair.features.gap(&seen) < -KEPT_GAP * system.load.radius && self.surroundings.beyond(&pair, [&seen; 2]) <= 0.0
    }

    /// Share of the increment after which the load meets a feature that its candidates leave out.
    pub fn hit_of(
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
        self.first_hit(system, start, twist, task, &known).or_else(|| {
            let overlaps = self.overlaps_at_end(system, start, twist, task, &known)
                || self.comes_to_cross(system, &[*start, start.moved_by(twist)], [task.from, task.to]);
            overlaps.then_some(0.0)
        })
    }
}

/// Whether features without a force are past each other at the end: beside each other there, they
/// may have touched on the way.
pub fn passes_beside(candidates: &[Candidate], found: &Found, radius: f64) -> bool {
    let is_past = |it: &Candidate| it.pair.features.gap(&it.start.moved_by(&found.increment.twist)) < it.closed - CLOSED_GAP * radius;
    candidates.iter().zip(&found.sides).any(|(it, (_, force))| force.normal == 0.0 && is_past(it))
}

/// Increment of a load that a moving obstacle carries along: that on which it rests, or else one
/// that it may touch. Features that pass through each other would be on the wrong sides of a load
/// that stands still.
pub fn carried(system: &System, start: &Place, task: &Task, candidates: &[Candidate], touching: &[Touching]) -> Vec3 {
    let keys = touching.iter().map(|touching| touching.key).chain(candidates.iter().map(|candidate| candidate.pair.key));
    let mut paths = keys.map(|key| &system.world.obstacles[key.obstacle].path);
    let Some(path) = paths.find(|path| path.moves()) else { return Vec3::zeros() };
    let [from, to] = [task.from, task.to].map(|time| path.pose_at(time));
    let shift = to.to_world(&from.to_local(&start.pose.position)) - start.pose.position;
    increment_of(&start.turn, &shift, to.heading - from.heading)
}

/// Modes and forces of the candidates in the last step.
pub fn suggested(candidates: &[Candidate], touching: &[Touching]) -> Sides {
    let last = |candidate: &Candidate| touching.iter().find(|touching| touching.key == candidate.pair.key);
    candidates
        .iter()
        .map(|candidate| last(candidate).map_or((SideMode::Open, SideForce::default()), |last| (last.mode, last.force)))
        .collect()
}
