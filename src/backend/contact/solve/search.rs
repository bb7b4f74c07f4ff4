//! The order of the methods.
//!
//! 1. `guess`: contacts that the increment without contacts overlaps are closed, and Newton's
//!    method does the rest.
//! 2. `frictionless`: the convex step without side friction, then Newton's method with the signs of
//!    its slips. Next to the limit of slipping, Newton's method finds the limit itself (`limit`).
//! 3. `rest_or_slide`: rest that is stable, or else a slide near it.
//! 4. `smoothed`: Coulomb's law itself, smoothed, where no answer is known.
//! 5. `enumerate`: all modes. Where an answer is known that is not stable, the search starts from
//!    it, in modes near its own: most stable answers that the methods before missed are there.

use super::modes::{contradict, newton, next_to_the_limit};
use super::path::{Path, follow, sides_of};
use super::problem::{Candidate, PerCone, Problem, Start};
use super::types::{PerContact, SideForce, SideMode, Stage};
use crate::backend::friction::ContactMode;
use crate::backend::numerics::{ACCEPTED, CONSISTENT, FEW_CONTACTS, MODE_CHANGES, MOST_OTHERS, RESTS, SLOW_CONTACT, SMALL_INCREMENT};
use crate::math::{Vec2, Vec3};
use crate::stop;

pub struct Search<'a> {
    pub(super) problem: Problem<'a>,
    pub best: Option<(Candidate, f64)>,
    pub n_solves: u32,
    pub n_iterations: u32,
    /// Answer without side friction, where it is not one with side friction.
    pub(super) frictionless: Option<Candidate>,
    /// Ends of paths, from which the enumeration starts.
    pub(super) starts: Vec<(Vec3, PerCone<Vec2>, PerContact<SideForce>)>,
}

/// Modes in which a search starts.
pub(super) struct Guess {
    pub ground: ContactMode,
    pub modes: PerContact<SideMode>,
}

impl<'a> Search<'a> {
    pub fn new(problem: Problem<'a>) -> Self {
        Self { problem, best: None, n_solves: 0, n_iterations: 0, frictionless: None, starts: Vec::new() }
    }

    /// Runs all methods until one finds an answer. `free` is the answer without contacts.
    pub fn run(&mut self, free: Option<&Candidate>) -> Stage {
        if free.is_some_and(|free| self.guess(free)) {
            return Stage::Guess;
        }
        self.frictionless(free)
            .or_else(|| self.rest_or_slide())
            .or_else(|| (self.unstable().is_none() && self.smoothed().0).then_some(Stage::Smoothed))
            .or_else(|| self.enumerate().then_some(Stage::Enumeration))
            .unwrap_or(if self.unstable().is_some() { Stage::Unstable } else { Stage::Failed })
    }

    /// The answer that is known but not stable, if there is one.
    fn unstable(&self) -> Option<&Candidate> {
        self.best.as_ref().filter(|(_, residual)| *residual <= ACCEPTED).map(|(found, _)| found)
    }

    /// Takes a candidate if it is better than the best; returns whether it is a stable answer. Of
    /// unstable answers the first one is kept.
    pub(super) fn consider(&mut self, candidate: Candidate) -> bool {
        let residual = self.problem.residual_of(&candidate);
        let is_accepted = residual <= ACCEPTED && candidate.is_consistent;
        let is_answer = is_accepted && candidate.is_stable;
        let is_best = |(best, least): &(Candidate, f64)| {
            let is_known = *least <= ACCEPTED && best.is_consistent;
            !is_known && (is_accepted || residual < *least)
        };
        if is_answer || self.best.as_ref().is_none_or(is_best) {
            self.best = Some((candidate, residual));
        }
        is_answer
    }

    fn newton(&mut self, guess: &Guess, start: &Start) -> Option<Candidate> {
        stop::point();
        let found = newton(&self.problem, guess.ground, &guess.modes, start)?;
        self.n_iterations += found.n_iterations;
        Some(found)
    }

    fn guess(&mut self, free: &Candidate) -> bool {
        if free.ground == ContactMode::Stick {
            return false;
        }
        let modes = (0..self.problem.rows.len()).map(|k| self.mode_by_gap(k, &free.twist)).collect();
        let start = Start { twist: &free.twist, ground_forces: &free.ground_forces, forces: &free.forces };
        self.walk(Guess { ground: free.ground, modes }, &start)
    }

    fn mode_by_gap(&self, k: usize, twist: &Vec3) -> SideMode {
        let overlaps = self.problem.gap(k, twist) < 0.0;
        if overlaps { SideMode::Slide { forward: self.problem.slip(k, twist) >= 0.0 } } else { SideMode::Open }
    }

    /// Newton's method, with modes changed where their inequalities are violated.
    pub(super) fn walk(&mut self, mut guess: Guess, start: &Start) -> bool {
        let Some(mut found) = self.newton(&guess, start) else { return false };
        let mut before = PerContact::new();
        for _ in 0..MODE_CHANGES {
            let modes: PerContact<SideMode> = (0..guess.modes.len()).map(|k| self.changed(k, &found)).collect();
            if self.consider(found.clone()) {
                return true;
            }
            // Modes to and fro lead nowhere.
            if modes == guess.modes || modes == before {
                return false;
            }
            before = std::mem::replace(&mut guess.modes, modes);
            let start = Start { twist: &found.twist, ground_forces: &found.ground_forces, forces: &found.forces };
            let Some(next) = self.newton(&guess, &start) else { return false };
            found = next;
        }
        self.consider(found)
    }

    /// Mode of contact k after an answer that violates its conditions.
    fn changed(&self, k: usize, found: &Candidate) -> SideMode {
        let friction = self.problem.rows[k].friction_coefficient;
        let SideForce { normal, tangential } = found.forces[k];
        let slip = self.problem.slip(k, &found.twist);
        match found.modes[k] {
            SideMode::Open => self.mode_by_gap(k, &found.twist),
            _ if normal < 0.0 || self.problem.gap(k, &found.twist) > CONSISTENT * self.problem.lengths(&found.twist) => SideMode::Open,
            SideMode::Stick if tangential.abs() > friction * normal => SideMode::Slide { forward: tangential < 0.0 },
            SideMode::Slide { forward } if friction > 0.0 && (slip > 0.0) != forward => SideMode::Stick,
            mode => mode,
        }
    }

    fn frictionless(&mut self, free: Option<&Candidate>) -> Option<Stage> {
        let mut smooth = Search::new(self.problem.frictionless());
        let stage = smooth.convex(free);
        self.problem.extent = smooth.problem.extent;
        self.starts.append(&mut smooth.starts);
        self.n_solves += smooth.n_solves;
        self.n_iterations += smooth.n_iterations;
        let (found, _) = smooth.best?;
        let sticking = found.clone().sticking(&self.problem);
        if self.consider(sticking.clone()) {
            return Some(stage);
        }
        let start = Start { twist: &found.twist, ground_forces: &found.ground_forces, forces: &found.forces };
        if self.walk(Guess { ground: sticking.ground, modes: sticking.modes }, &start) {
            return Some(Stage::Modes);
        }
        self.frictionless = Some(found);
        None
    }

    /// The best answer of a step without side friction, from the one without contacts or else along
    /// a path.
    fn convex(&mut self, free: Option<&Candidate>) -> Stage {
        if free.is_some_and(|free| self.guess(free)) {
            let (Candidate { twist, ground_forces, forces, .. }, _) = self.best.as_ref().expect("a guess that was found");
            self.starts.push((*twist, ground_forces.clone(), forces.clone()));
            self.shrink(twist.amax());
            return Stage::Frictionless;
        }
        self.best = None;
        let (mut is_found, mut path) = self.smoothed();
        if path.is_converged && self.shrink(path.twist.amax()) {
            (self.best, self.starts) = (None, Vec::new());
            (is_found, path) = self.smoothed();
        }
        let forces = sides_of(&path.forces);
        let start = Start { twist: &path.twist, ground_forces: &path.ground_forces, forces: &forces };
        if !is_found && self.limit(&self.modes_of(&self.problem, &path), &start) { Stage::Limit } else { Stage::Frictionless }
    }

    /// Compares lengths with an increment of this size, where obstacles hold the load back so that
    /// it is far smaller than without them. Returns whether it is.
    fn shrink(&mut self, size: f64) -> bool {
        let is_small = size < SMALL_INCREMENT * self.problem.extent && size > RESTS * self.problem.extent;
        if is_small {
            self.problem.extent = size;
        }
        is_small
    }

    /// Rest or slip next to the limit of slipping in these modes, with no support or with each of
    /// them as the pinned one.
    pub(super) fn limit(&mut self, modes: &[SideMode], start: &Start) -> bool {
        let pins = (0..self.problem.cones.len()).map(ContactMode::Pinned);
        [ContactMode::Slip].into_iter().chain(pins).any(|ground| {
            let found = next_to_the_limit(&self.problem, ground, modes, start);
            found.is_some_and(|found| {
                self.n_iterations += found.n_iterations;
                self.consider(found)
            })
        })
    }

    fn follow(&mut self, problem: &Problem) -> Path {
        let path = follow(problem);
        self.count(&path);
        self.starts.push((path.twist, path.ground_forces.clone(), sides_of(&path.forces)));
        path
    }

    pub(super) fn count(&mut self, path: &Path) {
        self.n_solves += 1;
        self.n_iterations += path.n_iterations;
    }

    fn modes_of(&self, problem: &Problem, path: &Path) -> PerContact<SideMode> {
        let mode = |k: usize| {
            let slip = problem.slip(k, &path.twist);
            if !path.is_closed[k] {
                SideMode::Open
            } else if problem.rows[k].friction_coefficient > 0.0 && slip.abs() < SLOW_CONTACT * problem.extent {
                SideMode::Stick
            } else {
                SideMode::Slide { forward: slip >= 0.0 }
            }
        };
        (0..problem.rows.len()).map(mode).collect()
    }

    /// Exact answer near the end of a path; returns whether it is one, and the path.
    fn smoothed(&mut self) -> (bool, Path) {
        let problem = self.problem.clone();
        let path = self.follow(&problem);
        let modes = self.modes_of(&problem, &path);
        let found = polish(&problem, &path, &sides_of(&path.forces), modes);
        self.n_iterations += found.as_ref().map_or(0, |found| found.n_iterations);
        (found.is_some_and(|found| self.consider(found)), path)
    }

    fn enumerate(&mut self) -> bool {
        let n = self.problem.rows.len();
        if n > FEW_CONTACTS {
            return false;
        }
        let grounds = [ContactMode::Slip, ContactMode::Stick].into_iter().chain((0..self.problem.cones.len()).map(ContactMode::Pinned));
        let known = self.unstable().cloned();
        let starts = match &known {
            Some(known) => vec![(known.twist, known.ground_forces.clone(), known.forces.clone())],
            None => std::mem::take(&mut self.starts),
        };
        let is_near = |modes: &PerContact<SideMode>| {
            let n_others = |known: &Candidate| known.modes.iter().zip(modes).filter(|(known, mode)| known != mode).count();
            known.as_ref().is_none_or(|known| n_others(known) <= MOST_OTHERS)
        };
        for ground in grounds {
            for code in 0..4usize.pow(n as u32) {
                let mode = |k: usize| match code / 4usize.pow(k as u32) % 4 {
                    0 => SideMode::Slide { forward: true },
                    1 => SideMode::Slide { forward: false },
                    2 => SideMode::Open,
                    _ => SideMode::Stick,
                };
                let guess = Guess { ground, modes: (0..n).map(mode).collect() };
                if !is_near(&guess.modes) {
                    continue;
                }
                for (at, (twist, ground_forces, forces)) in starts.iter().enumerate() {
                    let start = Start { twist, ground_forces, forces };
                    if at == 0 && contradict(&self.problem, ground, &guess.modes, &start) {
                        break;
                    }
                    let found = self.newton(&guess, &start);
                    if found.is_some_and(|found| self.consider(found)) {
                        return true;
                    }
                }
            }
        }
        false
    }
}

/// Exact answer in the modes that the end of a path shows. Where the mode with the ground is not
/// plain there, others are tried, and at last rest on all obstacles that touch.
pub(super) fn polish(problem: &Problem, path: &Path, forces: &[SideForce], modes: PerContact<SideMode>) -> Option<Candidate> {
    let start = Start { twist: &path.twist, ground_forces: &path.ground_forces, forces };
    let shown = path.ground_mode();
    let caged = problem.touching();
    let guesses = [(shown, &modes), (ContactMode::Slip, &modes), (ContactMode::Stick, &modes), (ContactMode::Stick, &caged)];
    let mut best: Option<(Candidate, f64)> = None;
    for (at, (ground, modes)) in guesses.into_iter().enumerate() {
        if at > 0 && ground == shown && *modes == *guesses[0].1 {
            continue;
        }
        let Some(found) = newton(problem, ground, modes, &start) else { continue };
        let residual = problem.residual_of(&found);
        if best.as_ref().is_none_or(|(_, least)| residual < *least) {
            best = Some((found, residual));
        }
        if residual <= ACCEPTED {
            break;
        }
    }
    best.map(|(found, _)| found)
}
