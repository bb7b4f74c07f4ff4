//! The step of a load at obstacles: with the features within reach, and by shorter paths where the
//! whole one has no answer.

use smallvec::SmallVec;

use super::candidates::{CLOSED, Candidate, Candidates, ContactStep, Sides, gap_rounding};
use super::displacement::PIECE;
use super::newton::Newton;
use super::obstacles::{Obstacles, Scope, SideWork, Task, Touching, mobility, on_load};
use super::solve::{SideForce, SideMode};
use super::step::Found;
use super::surroundings::{Pair, PairKey, Surroundings};
use crate::backend::friction::{ContactMode, FrictionSolver};
use crate::backend::increment::{Coasting, Course, Increment, Objective, Step, Straight};
use crate::backend::springs::Place;
use crate::backend::{Status, StepReport};
use crate::math::{Vec2, Vec3, increment_of};
use crate::model::System;

/// Most times that the motion of the obstacles in a step is halved (1).
const MOST_HALVINGS: i32 = 6;
/// Displacement over the load's radius to which the first resistance holds the load (1), the ratio
/// of one resistance to the one before, and their number.
const SOFTEST: f64 = 0.3;
const STIFFER: f64 = 8.0;
const MOST_RESISTANCES: usize = 6;
/// Increment, over the load's radius, that is none (1).
const SHORTEST: f64 = 1e-9;
/// Increment over the load's radius beyond which it is no answer (1): there a gap as small as a
/// contact may have is far below the rounding of positions. Where nothing resists, and rounding
/// alone says that contacts can be met, increments overflow.
const FARTHEST: f64 = 1e9;
/// Most attempts with farther and farther features (1).
const MOST_ATTEMPTS: usize = 12;
/// Reach of the first look for features, over the load's radius, and of the last one (1). Paths
/// beyond it are cut where they would pass through one.
const REACH: f64 = 0.01;
const LONGEST_REACH: f64 = 2.0;

/// Answer of a step with the features within reach.
pub struct Answer {
    pub found: Found,
    pub candidates: Candidates,
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

impl Obstacles {
    /// The step with the features within reach. Where a load without inertia has no answer there,
    /// or one that leads through an obstacle, it takes a shorter path: to where the obstacles are
    /// half way, or against a resistance that is proportional to its displacement.
    pub(super) fn find_with_contacts(
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
            let mut spent = answer.found.increment.report;
            if let Some((other, share)) = self.find_shorter(system, step, solver, touching, task, &mut spent) {
                (answer, cut) = (other, Some(share));
            }
            let of_found = &mut answer.found.increment.report;
            (of_found.n_solves, of_found.n_iterations) = (spent.n_solves, spent.n_iterations);
        }
        if let Some(share) = answer.cut {
            let Increment { twist, mode, mut report, .. } = answer.found.increment;
            let twist = if answer.overlaps_at_cut { Vec3::zeros() } else { share * twist };
            // Another leg would end there as well.
            let cut = cut.filter(|_| !answer.overlaps_at_cut);
            if cut.is_none() {
                (report.status, report.n_not_converged) = (report.status.max(Status::NotConverged), 1);
            }
            touching.clear();
            return (step.found(&twist, mode, report), SideWork { cut, ..SideWork::default() });
        }
        let end = if let Some(share) = cut { task.from + share * (task.to - task.from) } else { task.to };
        let work = self.settle(system, &start, &Task { to: end, ..*task }, &mut answer, touching);
        (answer.found.increment, SideWork { cut, ..work })
    }

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
        let start = *course.start;
        let candidates = self.touching_candidates(system, &start, task, touching);
        let suggested = suggested(&candidates, touching);
        let mut contact = ContactStep { step: course, surroundings: &self.surroundings, candidates: &candidates, start_at: Vec3::zeros() };
        let Newton { at, sides, are_forces_unique, report, .. } =
            contact.newton(&suggested, task.guess?).filter(|found| found.is_stable)?;
        let increment = course.found(&at, ContactMode::Slip, report);
        if !course.goes_on(&at, &increment) {
            return None;
        }
        solver.keep_gliding(&at);
        let found = Found { increment, sides, are_forces_unique };
        let mut answer = Answer { found, candidates, cut: None, overlaps_at_cut: false };
        let work = self.settle(system, &start, task, &mut answer, touching);
        Some((answer.found.increment, work, at))
    }

    /// Takes note of what is known of the contact forces, and accepts the answer.
    fn settle(&mut self, system: &System, start: &Place, task: &Task, answer: &mut Answer, touching: &mut Vec<Touching>) -> SideWork {
        let of_found = &mut answer.found.increment.report;
        of_found.is_indeterminate = !answer.found.are_forces_unique;
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
        let closed = 10.0 * CLOSED * system.load.radius;
        let rounding = gap_rounding(&start.pose, system.load.radius);
        let mut work = SideWork::default();
        let last = std::mem::take(touching);
        for (candidate, (mode, force)) in candidates.iter().zip(&found.sides) {
            let Candidate { pair: pair @ Pair { key, features, .. }, start: moved, slip, .. } = candidate;
            let end = moved.moved_by(&found.increment.twist);
            let (gap_at_end, slip_at_end) = (features.gap(&end), features.slip(&end, *slip));
            let path = &system.world.obstacles[key.obstacle].path;
            let obstacle = path.pose_at(task.to);
            if force.normal > 0.0 {
                let apart = Touching { force: SideForce::default(), on_load: [Vec2::zeros(); 2], key: *key, mode: *mode, slip: *slip };
                let before = last.iter().find(|touching| touching.key == *key).unwrap_or(&apart);
                let slipped = slip_at_end - slip;
                let tangential = if task.is_smooth { 0.5 * (before.force.tangential + force.tangential) } else { force.tangential };
                work.friction += (-tangential * slipped).max(0.0);
                let gap_at_start = features.gap(moved);
                work.uncertainty +=
                    force.normal * gap_at_start.max(0.0) + (force.tangential - before.force.tangential).abs() * slipped.abs();
                if path.moves() {
                    let [force_now, point] = on_load(features, force, &end, &obstacle);
                    let shift = point - path.pose_at(task.from).to_world(&obstacle.to_local(&point));
                    work.of_obstacles += if before.force.normal > 0.0 {
                        0.5 * (before.on_load[0] + force_now).dot(&shift)
                    } else {
                        // A contact that closes in the step has the whole force from then on.
                        let gap = features.gap(&Surroundings::relative(start, &path.pose_at(task.from)));
                        force_now.dot(&shift) - force.normal * gap.max(0.0)
                    };
                    work.uncertainty += (force_now - before.on_load[0]).norm() * shift.norm();
                }
            }
            let beyond_at_end = self.surroundings.pair_beyond(pair, &end);
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
                let on_load = on_load(features, force, &end, &obstacle);
                touching.push(Touching { key: *key, mode: *mode, force: *force, slip: slip_at_end, on_load });
            }
        }
        self.clear = None;
        work
    }

    /// Answer of a shorter path, and the share of the time of the step at its end. Adds what it
    /// takes to the work that has been `spent`.
    fn find_shorter(
        &mut self,
        system: &System,
        step: &mut Step,
        solver: &mut FrictionSolver,
        touching: &[Touching],
        task: &Task,
        spent: &mut StepReport,
    ) -> Option<(Answer, f64)> {
        let mut add = |StepReport { n_solves, n_iterations, .. }: &StepReport| {
            spent.n_solves += n_solves;
            spent.n_iterations += n_iterations;
        };
        let warm_start = solver.warm_start().clone();
        let n_moving = if self.surroundings.longest_path(system, task.from, task.to) > 0.0 { MOST_HALVINGS } else { 0 };
        for halving in 1..=n_moving {
            let share = 0.5f64.powi(halving);
            let to = task.from + share * (task.to - task.from);
            solver.set_warm_start(warm_start.clone()).expect("it is the solver's own");
            let answer = self.find_near(system, step, solver, touching, &Task { to, step: share * task.step, guess: None, ..*task });
            add(&answer.found.increment.report);
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
            add(&answer.found.increment.report);
            if !answer.is_poor() && answer.cut.is_none() {
                let moves = step.size(&answer.found.increment.twist) > SHORTEST;
                return moves.then_some((answer, 1.0));
            }
            stiffness *= STIFFER;
        }
        None
    }

    /// Whether a pair overlaps by more than rounding.
    pub fn overlaps(&self, system: &System, key: &PairKey, at: &Place, time: f64) -> bool {
        let seen = Surroundings::relative(at, &system.world.obstacles[key.obstacle].path.pose_at(time));
        self.surroundings.features(key).gap(&seen) < -10.0 * CLOSED * system.load.radius && self.surroundings.beyond(key, &seen) <= 0.0
    }

    /// The step with the features within reach, which is widened until it suffices.
    fn find_near(&mut self, system: &System, step: &mut Step, solver: &mut FrictionSolver, touching: &[Touching], task: &Task) -> Answer {
        let (start, radius) = (step.potential.start, system.load.radius);
        let shift = self.surroundings.longest_path(system, task.from, task.to);
        let size = |twist: &Vec3| twist.xy().norm() + radius * twist.z.abs();
        let longest = 2.0 * shift + LONGEST_REACH * radius;
        let mut reach = (2.0 * shift + (REACH * radius).max(2.0 * task.guess.as_ref().map_or(0.0, size))).min(longest);
        // Features that touch are all that such a step looks at: it is taken once.
        let warm_start = (task.scope == Scope::Near).then(|| solver.warm_start().clone());
        let mut report = StepReport::default();
        let mut attempt = 0;
        loop {
            let candidates = self.candidates(system, &start, task, reach, touching);
            let suggested = suggested(&candidates, touching);
            let start_at = carried(system, &start, task, &candidates, touching);
            let mut contact = ContactStep { step, surroundings: &self.surroundings, candidates: &candidates, start_at };
            let mut found = contact.find(solver, &suggested, task.guess);
            report.n_solves += found.increment.report.n_solves;
            report.n_iterations += found.increment.report.n_iterations;
            let length = size(&found.increment.twist);
            if !length.is_finite() || length > FARTHEST * radius {
                found = contact.none(found.increment.report);
            }
            let moved = size(&found.increment.twist) + shift;
            // Candidates that hold all that the load can reach leave nothing to hit.
            let is_known = task.scope == Scope::Near
                && 1.001 * moved + CLOSED * radius <= reach
                && moved <= PIECE * self.surroundings.fineness()
                && !passes_beside(&candidates, &found, radius);
            let hit = if is_known { None } else { self.hit_of(system, &start, task, (&candidates, &found), touching) };
            attempt += 1;
            let cut = hit.filter(|share| *share > 0.0 && !task.has_inertia);
            let overlaps_at_cut = cut.is_some_and(|share| {
                let (twist, to) = (share * found.increment.twist, task.from + share * (task.to - task.from));
                let place = start.moved_by(&twist);
                candidates.iter().any(|it| self.overlaps(system, &it.pair.key, &place, to))
                    || self.comes_to_cross(system, &[start, place], [task.from, to])
            });
            // A load with inertia takes the whole step, as does one whose path cuts a corner.
            let is_hit = hit.is_some() && cut.is_none() || overlaps_at_cut;
            if let Some(warm_start) = warm_start.as_ref().filter(|_| is_hit && attempt < MOST_ATTEMPTS && reach < longest.min(2.0 * moved))
            {
                reach = (4.0 * reach).min(2.0 * moved).min(longest);
                solver.set_warm_start(warm_start.clone()).expect("it is the solver's own");
                continue;
            }
            let of_found = &mut found.increment.report;
            (of_found.n_solves, of_found.n_iterations) = (report.n_solves, report.n_iterations);
            if hit.is_some() && cut.is_none() {
                of_found.status = of_found.status.max(Status::NotConverged);
                of_found.n_not_converged = 1;
            }
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
        self.first_hit(system, start, twist, task, &known).or_else(|| {
            let overlaps = self.overlaps_at_end(system, start, twist, task, &known)
                || self.comes_to_cross(system, &[*start, start.moved_by(twist)], [task.from, task.to]);
            overlaps.then_some(0.0)
        })
    }
}

/// Whether features without a force are past each other at the end: beside each other there, they
/// may have touched on the way.
fn passes_beside(candidates: &[Candidate], found: &Found, radius: f64) -> bool {
    let is_past = |it: &Candidate| it.pair.features.gap(&it.start.moved_by(&found.increment.twist)) < it.closed - CLOSED * radius;
    candidates.iter().zip(&found.sides).any(|(it, (_, force))| force.normal == 0.0 && is_past(it))
}

/// Increment of a load that a moving obstacle carries along: that on which it rests, or else one
/// that it may touch. Features that pass through each other would be on the wrong sides of a load
/// that stands still.
fn carried(system: &System, start: &Place, task: &Task, candidates: &[Candidate], touching: &[Touching]) -> Vec3 {
    let keys = touching.iter().map(|touching| touching.key).chain(candidates.iter().map(|candidate| candidate.pair.key));
    let mut paths = keys.map(|key| &system.world.obstacles[key.obstacle].path);
    let Some(path) = paths.find(|path| path.moves()) else { return Vec3::zeros() };
    let [from, to] = [task.from, task.to].map(|time| path.pose_at(time));
    let shift = to.to_world(&from.to_local(&start.pose.position)) - start.pose.position;
    increment_of(&start.turn, &shift, to.heading - from.heading)
}

/// Modes and forces of the candidates in the last step.
fn suggested(candidates: &[Candidate], touching: &[Touching]) -> Sides {
    let last = |candidate: &Candidate| touching.iter().find(|touching| touching.key == candidate.pair.key);
    candidates
        .iter()
        .map(|candidate| last(candidate).map_or((SideMode::Open, SideForce::default()), |last| (last.mode, last.force)))
        .collect()
}
