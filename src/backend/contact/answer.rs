//! The step of a load at obstacles: with the features within reach, and by shorter paths where the
//! whole one has no answer.

use smallvec::SmallVec;

use super::candidates::{CLOSED, Candidate, Candidates, ContactStep, Sides, gap_rounding};
use super::displacement::PIECE;
use super::newton::Newton;
use super::obstacles::{Obstacles, Resistance, Scope, SideWork, Task, Touching, mobility, on_load};
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
/// Ratio of a resistance to that of the next leg of the same path (1).
const SOFTER: f64 = 4.0;
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

/// Answer of a shorter path than that of a step.
struct Shorter {
    answer: Answer,
    /// Share of the time of the step at its end; `None` for the whole path.
    share: Option<f64>,
    resistance: Option<Resistance>,
}

/// Answer of a step with the features within reach.
pub struct Answer {
    pub found: Found,
    pub candidates: Candidates,
    /// Share of the increment at which it is cut, before a feature that it would pass.
    cut: Option<f64>,
    /// Whether a load without inertia stays where it is: it would overlap an obstacle at the end,
    /// or at the cut, as a straight path along one cuts its corner.
    stays: bool,
}

impl Answer {
    /// Whether the step did not converge, or is not one to go.
    fn is_poor(&self) -> bool {
        self.found.increment.report.status != Status::Converged || self.stays
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
        let (start, mut spent) = (step.potential.start, StepReport::default());
        let held = task.resistance.and_then(|last| {
            let found = self.find_held(system, step, solver, touching, task, (last.next, 2.0), &mut spent)?;
            let resistance = found.resistance?;
            (resistance.moved > last.moved || resistance.stiffness > last.next).then_some(found)
        });
        let Shorter { mut answer, share: mut cut, resistance } = held.unwrap_or_else(|| {
            let answer = self.find_near(system, step, solver, touching, task, &mut spent);
            let is_stuck = answer.is_poor() && task.scope == Scope::Near && !task.has_inertia;
            let shorter = if is_stuck { self.find_shorter(system, step, solver, touching, task, &mut spent) } else { None };
            shorter.unwrap_or_else(|| Shorter { share: answer.cut, answer, resistance: None })
        });
        let of_found = &mut answer.found.increment.report;
        (of_found.n_solves, of_found.n_iterations) = (spent.n_solves, spent.n_iterations);
        if answer.cut.is_some() || answer.stays {
            let Increment { twist, mode, mut report, .. } = answer.found.increment;
            let twist = answer.cut.filter(|_| !answer.stays).unwrap_or_default() * twist;
            // Another leg would end there as well.
            cut = cut.filter(|_| !answer.stays);
            if cut.is_none() {
                (report.status, report.n_not_converged) = (report.status.max(Status::NotConverged), 1);
            }
            touching.clear();
            return (step.found(&twist, mode, report), SideWork { cut, ..SideWork::default() });
        }
        let end = if let Some(share) = cut { task.from + share * (task.to - task.from) } else { task.to };
        let work = self.settle(system, &start, &Task { to: end, ..*task }, &mut answer, touching);
        (answer.found.increment, SideWork { cut, resistance, ..work })
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
        let mut answer = Answer { found, candidates, cut: None, stays: false };
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

    /// Answer of a shorter path.
    fn find_shorter(
        &mut self,
        system: &System,
        step: &mut Step,
        solver: &mut FrictionSolver,
        touching: &[Touching],
        task: &Task,
        spent: &mut StepReport,
    ) -> Option<Shorter> {
        let warm_start = solver.warm_start().clone();
        let n_moving = if self.surroundings.longest_path(system, task.from, task.to) > 0.0 { MOST_HALVINGS } else { 0 };
        for halving in 1..=n_moving {
            let share = 0.5f64.powi(halving);
            let to = task.from + share * (task.to - task.from);
            solver.set_warm_start(warm_start.clone()).expect("it is the solver's own");
            let answer = self.find_near(system, step, solver, touching, &Task { to, step: share * task.step, guess: None, ..*task }, spent);
            if !answer.is_poor() && answer.cut.is_none() {
                return Some(Shorter { answer, share: Some(share), resistance: None });
            }
        }
        let length = system.load.radius;
        let gradient = step.gradient(&Vec3::zeros());
        let first = || (gradient.xy().norm() + gradient.z.abs() / length) / (SOFTEST * length);
        let tried = task.resistance.map_or_else(|| (first(), STIFFER), |last| (last.next / SOFTER, 2.0));
        solver.set_warm_start(warm_start).expect("it is the solver's own");
        let found = self.find_held(system, step, solver, touching, task, tried, spent)?;
        (found.resistance?.moved > SHORTEST * length).then_some(found)
    }

    /// Answer against the first resistance that has one, of a stiffness (N/m) and, in turn, of the
    /// last one times a ratio. A softer one is next unless the first one had none.
    #[expect(clippy::too_many_arguments, reason = "a step and what is tried")]
    fn find_held(
        &mut self,
        system: &System,
        step: &mut Step,
        solver: &mut FrictionSolver,
        touching: &[Touching],
        task: &Task,
        (first, ratio): (f64, f64),
        spent: &mut StepReport,
    ) -> Option<Shorter> {
        let (warm_start, mut stiffness) = (solver.warm_start().clone(), first);
        for _ in 0..MOST_RESISTANCES {
            solver.set_warm_start(warm_start.clone()).expect("it is the solver's own");
            if let Some(mut found) = self.find_resisted(system, step, solver, touching, task, stiffness, spent) {
                let may_be_softer = stiffness == first && task.resistance.is_none_or(|last| last.next < last.stiffness);
                let next = if may_be_softer { stiffness / SOFTER } else { stiffness };
                found.resistance = found.resistance.map(|it| Resistance { next, ..it });
                return Some(found);
            }
            stiffness *= ratio;
        }
        None
    }

    /// Answer of the path against a resistance that is proportional to the displacement, of this
    /// `stiffness` (N/m); `None` where there is none.
    #[expect(clippy::too_many_arguments, reason = "a step and one number more")]
    fn find_resisted(
        &mut self,
        system: &System,
        step: &mut Step,
        solver: &mut FrictionSolver,
        touching: &[Touching],
        task: &Task,
        stiffness: f64,
        spent: &mut StepReport,
    ) -> Option<Shorter> {
        let turning = stiffness * system.load.radius * system.load.radius;
        step.potential.inertia = Some(Coasting { shift: Vec2::zeros(), turn: 0.0, stiffness: (stiffness, turning) });
        let answer = self.find_near(system, step, solver, touching, &Task { guess: None, ..*task }, spent);
        step.potential.inertia = None;
        let moved = step.size(&answer.found.increment.twist);
        (!answer.is_poor() && answer.cut.is_none()).then_some(Shorter {
            answer,
            share: Some(1.0),
            resistance: Some(Resistance { stiffness, moved, next: stiffness }),
        })
    }

    /// Whether a pair overlaps by more than rounding.
    pub fn overlaps(&self, system: &System, key: &PairKey, at: &Place, time: f64) -> bool {
        let seen = Surroundings::relative(at, &system.world.obstacles[key.obstacle].path.pose_at(time));
        self.surroundings.features(key).gap(&seen) < -10.0 * CLOSED * system.load.radius && self.surroundings.beyond(key, &seen) <= 0.0
    }

    /// The step with the features within reach, which is widened until it suffices.
    /// Adds what it takes to the work that has been `spent`.
    fn find_near(
        &mut self,
        system: &System,
        step: &mut Step,
        solver: &mut FrictionSolver,
        touching: &[Touching],
        task: &Task,
        spent: &mut StepReport,
    ) -> Answer {
        let (start, radius) = (step.potential.start, system.load.radius);
        let shift = self.surroundings.longest_path(system, task.from, task.to);
        let size = |twist: &Vec3| twist.xy().norm() + radius * twist.z.abs();
        let longest = 2.0 * shift + LONGEST_REACH * radius;
        let mut reach = (2.0 * shift + (REACH * radius).max(2.0 * task.guess.as_ref().map_or(0.0, size))).min(longest);
        // Features that touch are all that such a step looks at: it is taken once.
        let warm_start = (task.scope == Scope::Near).then(|| solver.warm_start().clone());
        let mut attempt = 0;
        loop {
            let candidates = self.candidates(system, &start, task, reach, touching);
            let suggested = suggested(&candidates, touching);
            let start_at = carried(system, &start, task, &candidates, touching);
            let mut contact = ContactStep { step, surroundings: &self.surroundings, candidates: &candidates, start_at };
            let mut found = contact.find(solver, &suggested, task.guess);
            spent.n_solves += found.increment.report.n_solves;
            spent.n_iterations += found.increment.report.n_iterations;
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
            let is_hit = hit.is_some() && cut.is_none() || overlaps_at_cut;
            if let Some(warm_start) = warm_start.as_ref().filter(|_| is_hit && attempt < MOST_ATTEMPTS && reach < longest.min(2.0 * moved))
            {
                reach = (4.0 * reach).min(2.0 * moved).min(longest);
                solver.set_warm_start(warm_start.clone()).expect("it is the solver's own");
                continue;
            }
            if hit.is_some() && cut.is_none() {
                let of_found = &mut found.increment.report;
                of_found.status = of_found.status.max(Status::NotConverged);
                of_found.n_not_converged = 1;
            }
            // A load with inertia takes the whole step.
            return Answer { found, candidates, cut, stays: is_hit && !task.has_inertia };
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
