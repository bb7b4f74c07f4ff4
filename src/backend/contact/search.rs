//! The search for the answer of a step at obstacles: with features within reach that is widened,
//! and by shorter paths where the whole one has no answer.

use super::answer::{Answer, carried, passes_beside, suggested};
use super::candidates::ContactStep;
use super::obstacles::{Obstacles, Resistance, Scope, SideWork, Task};
use super::touching::Touching;
use crate::backend::friction::{FrictionSolver, WarmStart};
use crate::backend::increment::{Coasting, Course, Increment, Objective, Step};
use crate::backend::numerics::{
    CLOSED_GAP, FIRST_REACH, FIRST_YIELD, LINEAR_STEPS, LINEAR_STEPS_NEAR, LONGEST_INCREMENT, LONGEST_REACH, MOST_RESISTANCES,
    MOTION_HALVINGS, PIECE, REACH_ATTEMPTS, SHORTEST_INCREMENT, STIFFER, STIFFER_AGAIN,
};
use crate::backend::report::{Status, StepReport};
use crate::math::{Vec2, Vec3};
use crate::model::System;
use crate::stop;

/// The search for the answer of a step.
struct Search<'a, 's> {
    obstacles: &'a mut Obstacles,
    system: &'a System,
    step: &'a mut Step<'s>,
    solver: &'a mut FrictionSolver,
    /// Contacts that are closed at the start.
    touching: &'a [Touching],
    /// Work of all attempts.
    spent: StepReport,
}

/// Answer of a path.
struct Ended {
    answer: Answer,
    /// Share of the time of the step at its end; `None` for the whole path.
    share: Option<f64>,
    resistance: Option<Resistance>,
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
        let mut search = Search { obstacles: self, system, step, solver, touching, spent: StepReport::default() };
        let Ended { mut answer, share, resistance } = search.answer(task);
        let StepReport { n_solves, n_iterations, .. } = search.spent;
        let of_found = &mut answer.found.increment.report;
        (of_found.n_solves, of_found.n_iterations) = (n_solves, n_iterations);
        if answer.cut.is_some() || answer.stays {
            let Increment { twist, mode, mut report, .. } = answer.found.increment;
            let twist = answer.cut.filter(|_| !answer.stays).unwrap_or_default() * twist;
            // Another leg would end there as well.
            let cut = share.filter(|_| !answer.stays);
            if cut.is_none() {
                (report.status, report.n_not_converged) = (report.status.max(Status::NotConverged), 1);
            }
            touching.clear();
            return (step.found(&twist, mode, report), SideWork { cut, ..SideWork::default() });
        }
        let to = share.map_or(task.to, |share| task.from + share * (task.to - task.from));
        let work = self.settle(system, &start, &Task { to, ..*task }, &mut answer, touching);
        (answer.found.increment, SideWork { cut: share, resistance, ..work })
    }
}

impl Search<'_, '_> {
    /// Answer of the whole path or of a shorter one. A leg that follows one against a resistance
    /// begins with that.
    fn answer(&mut self, task: &Task) -> Ended {
        if let Some(last) = task.resistance {
            let warm_start = self.solver.warm_start().clone();
            let goes_on = |found: &Ended| found.resistance.is_some_and(|it| it.moved > last.moved || it.stiffness > last.next());
            if let Some(found) = self.held(task, last.next(), STIFFER_AGAIN).filter(goes_on) {
                return found;
            }
            self.begin_again(&warm_start);
        }
        let answer = self.near(task);
        let is_stuck = answer.is_poor() && task.scope == Scope::Near && task.may_jump;
        let shorter = if is_stuck { self.shorter(task) } else { None };
        shorter.unwrap_or_else(|| Ended { share: answer.cut, answer, resistance: None })
    }

    fn begin_again(&mut self, warm_start: &WarmStart) {
        self.solver.set_warm_start(warm_start.clone()).expect("it is the solver's own");
    }

    /// Answer of a shorter path.
    fn shorter(&mut self, task: &Task) -> Option<Ended> {
        let warm_start = self.solver.warm_start().clone();
        let moves = self.obstacles.surroundings.longest_path(self.system, task.from, task.to) > 0.0;
        for halving in 1..=if moves { MOTION_HALVINGS } else { 0 } {
            let share = 0.5f64.powi(halving);
            let to = task.from + share * (task.to - task.from);
            self.begin_again(&warm_start);
            let answer = self.near(&Task { to, step: share * task.step, guess: None, ..*task });
            if answer.is_whole() {
                return Some(Ended { answer, share: Some(share), resistance: None });
            }
        }
        let length = self.system.load.radius;
        let gradient = self.step.gradient(&Vec3::zeros());
        let first = || (gradient.xy().norm() + gradient.z.abs() / length) / (FIRST_YIELD * length);
        let (stiffness, ratio) = task.resistance.map_or_else(|| (first(), STIFFER), |last| (last.softer(), STIFFER_AGAIN));
        self.begin_again(&warm_start);
        let found = self.held(task, stiffness, ratio)?;
        (found.resistance?.moved > SHORTEST_INCREMENT * length).then_some(found)
    }

    /// Answer against the first resistance that has one, of a stiffness (N/m) and, in turn, of the
    /// last one times a ratio. A softer one is next unless the first one had none.
    fn held(&mut self, task: &Task, first: f64, ratio: f64) -> Option<Ended> {
        let (warm_start, mut stiffness) = (self.solver.warm_start().clone(), first);
        for _ in 0..MOST_RESISTANCES {
            stop::point();
            self.begin_again(&warm_start);
            let may_soften = stiffness == first && task.resistance.is_none_or(|last| last.may_soften);
            let found = self.resisted(task, stiffness, may_soften);
            if found.is_some() {
                return found;
            }
            stiffness *= ratio;
        }
        None
    }

    /// Answer of the path against a resistance that is proportional to the displacement, of this
    /// `stiffness` (N/m); `None` where there is none.
    fn resisted(&mut self, task: &Task, stiffness: f64, may_soften: bool) -> Option<Ended> {
        let turning = stiffness * self.system.load.radius * self.system.load.radius;
        self.step.potential.inertia = Some(Coasting { shift: Vec2::zeros(), turn: 0.0, stiffness: (stiffness, turning) });
        let answer = self.near(&Task { guess: None, ..*task });
        self.step.potential.inertia = None;
        let moved = self.step.size(&answer.found.increment.twist);
        let resistance = Some(Resistance { stiffness, moved, may_soften });
        answer.is_whole().then_some(Ended { answer, share: Some(1.0), resistance })
    }

    /// Answer with the features within reach, which is widened until it suffices.
    fn near(&mut self, task: &Task) -> Answer {
        let Self { obstacles, system, step, solver, touching, spent } = self;
        let (start, radius) = (step.potential.start, system.load.radius);
        let shift = obstacles.surroundings.longest_path(system, task.from, task.to);
        let size = |twist: &Vec3| twist.xy().norm() + radius * twist.z.abs();
        let longest = 2.0 * shift + LONGEST_REACH * radius;
        let coasting = step.potential.inertia.as_ref().map_or(0.0, |it| it.shift.norm() + radius * it.turn.abs());
        let expected = task.guess.as_ref().map_or(coasting, size);
        let mut reach = (2.0 * shift + (FIRST_REACH * radius).max(2.0 * expected)).min(longest);
        // Features that touch are all that such a step looks at: it is taken once.
        let warm_start = (task.scope == Scope::Near).then(|| solver.warm_start().clone());
        let most_steps = if task.has_inertia || task.may_jump { LINEAR_STEPS } else { LINEAR_STEPS_NEAR };
        let mut attempt = 0;
        loop {
            let candidates = obstacles.candidates(system, &start, task, reach, touching);
            let suggested = suggested(&candidates, touching);
            let start_at = carried(system, &start, task, &candidates, touching);
            let mut contact =
                ContactStep { step: *step, surroundings: &obstacles.surroundings, candidates: &candidates, start_at, most_steps };
            let mut found = contact.find(solver, &suggested, task.guess);
            spent.n_solves += found.increment.report.n_solves;
            spent.n_iterations += found.increment.report.n_iterations;
            let length = size(&found.increment.twist);
            if !length.is_finite() || length > LONGEST_INCREMENT * radius {
                found = contact.none(found.increment.report);
            }
            let moved = size(&found.increment.twist) + shift;
            // Candidates that hold all that the load can reach leave nothing to hit.
            let is_known = task.scope == Scope::Near
                && 1.001 * moved + CLOSED_GAP * radius <= reach
                && moved <= PIECE * obstacles.surroundings.fineness()
                && !passes_beside(&candidates, &found, radius);
            let hit = if is_known { None } else { obstacles.hit_of(system, &start, task, (&candidates, &found), touching) };
            attempt += 1;
            let cut = hit.filter(|share| *share > 0.0 && !task.has_inertia);
            let overlaps_at_cut = cut.is_some_and(|share| {
                let (twist, to) = (share * found.increment.twist, task.from + share * (task.to - task.from));
                let place = start.moved_by(&twist);
                candidates.iter().any(|it| obstacles.overlaps(system, &it.pair.key, &place, to))
                    || obstacles.comes_to_cross(system, &[start, place], [task.from, to])
            });
            let is_hit = hit.is_some() && cut.is_none() || overlaps_at_cut;
            if let Some(warm_start) = warm_start.as_ref().filter(|_| is_hit && attempt < REACH_ATTEMPTS && reach < longest.min(2.0 * moved))
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
}
