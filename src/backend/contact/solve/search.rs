//! The order of the methods.
//!
//! 1. `guess`: contacts that the increment without contacts overlaps are closed, and Newton's
//!    method does the rest.
//! 2. `frictionless`: the convex step without side friction, then Newton's method with the signs of
//!    its slips. Next to the limit of slipping, Newton's method finds the limit itself (`limit`).
//! 3. `rest_or_slide`: the convex step with friction cones, which is exact if nothing slides. It is
//!    accepted if it is stable: the step with slip offsets far smaller than the increment slips by
//!    less than these. Else, and where something slides, Newton's method on the offsets.
//! 4. `smoothed`: Coulomb's law itself, smoothed.
//! 5. `enumerate`: all modes.

use nalgebra::linalg::Schur;
use nalgebra::{DMatrix, DVector};

use super::modes::{CONSISTENT, newton, next_to_the_limit};
use super::path::{Path, follow, sides_of};
use super::problem::{Candidate, PerCone, Problem, RESTS, Start};
use super::relaxed::Relaxed;
use super::types::{PerContact, SideForce, SideMode, Stage};
use crate::backend::friction::ContactMode;
use crate::math::{Vec2, Vec3};

/// Residual up to which an answer is taken without looking for a better one (1).
pub const ACCEPTED: f64 = 1e-12;
/// Slip offset over the size of the increment at which rest is asked whether it is stable (1). In a
/// short step a load slides by little before its springs hold it again, and the offset has to be
/// less than that.
const DISTURBANCE: f64 = 1e-9;
/// Size of the increment over that offset that its step is solved for (1).
const MAGNIFIED: f64 = 1e3;
/// Slip offset over the size of the increment at which the search for a slide begins (1).
const FIRST_OFFSET: f64 = 1e-3;
/// Slips beyond the offsets that are rounding, over the offsets (1).
const ROUNDED: f64 = 1e-6;
/// Changes of modes at most in one walk.
const MOST_CHANGES: u32 = 6;
/// Rounds of Newton's method on the offsets.
const MOST_ROUNDS: u32 = 40;
/// Rounds of Newton's method away from a rest that is not stable.
const FEW_ROUNDS: u32 = 12;
/// Difference of two increments over their size that is rounding (1).
const SAME: f64 = 1e-9;
/// Rounds after which steps are shortened: Newton's method goes to and fro.
const LONG_ROUNDS: u32 = 25;
/// Growth of the slip by its offset from which on the offset is not near its root (1).
const STEEP: f64 = 0.9;
/// Rounds of rotations at most that decouple a slope into its eigenvalues: one takes some three.
const MOST_ROTATIONS: usize = 200;
/// Slip over the size of the increment below which a contact sticks (1).
const SLOW: f64 = 1e-7;
/// Size of the increment, over that without contacts, below which it becomes what lengths are
/// compared with (1).
const SMALL: f64 = 0.1;
/// Contacts up to which all combinations of modes are tried.
const FEW: usize = 4;

pub struct Search<'a> {
    problem: Problem<'a>,
    pub best: Option<(Candidate, f64)>,
    pub n_solves: u32,
    pub n_iterations: u32,
    /// Ends of paths, from which the enumeration starts.
    starts: Vec<(Vec3, PerCone<Vec2>, PerContact<SideForce>)>,
}

/// Modes in which a search starts.
struct Guess {
    ground: ContactMode,
    modes: PerContact<SideMode>,
}

impl<'a> Search<'a> {
    pub fn new(problem: Problem<'a>) -> Self {
        Self { problem, best: None, n_solves: 0, n_iterations: 0, starts: Vec::new() }
    }

    /// Runs all methods until one finds an answer. `free` is the answer without contacts.
    pub fn run(&mut self, free: Option<&Candidate>) -> Stage {
        if free.is_some_and(|free| self.guess(free)) {
            return Stage::Guess;
        }
        self.frictionless()
            .or_else(|| self.rest_or_slide())
            .or_else(|| self.smoothed().then_some(Stage::Smoothed))
            .or_else(|| self.enumerate().then_some(Stage::Enumeration))
            .unwrap_or(if self.best.as_ref().is_some_and(|(_, residual)| *residual <= ACCEPTED) { Stage::Unstable } else { Stage::Failed })
    }

    /// Takes a candidate if it is better than the best; returns whether it is a stable answer. Of
    /// unstable answers the first one is kept.
    fn consider(&mut self, candidate: Candidate) -> bool {
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
    fn walk(&mut self, mut guess: Guess, start: &Start) -> bool {
        let Some(mut found) = self.newton(&guess, start) else { return false };
        for _ in 0..MOST_CHANGES {
            let modes: PerContact<SideMode> = (0..guess.modes.len()).map(|k| self.changed(k, &found)).collect();
            if self.consider(found.clone()) {
                return true;
            }
            if modes == guess.modes {
                return false;
            }
            guess.modes = modes;
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

    fn frictionless(&mut self) -> Option<Stage> {
        let mut smooth = self.problem.frictionless();
        let mut path = self.follow(&smooth);
        // Where obstacles hold the load back, the increment may be far smaller than without them.
        let size = path.twist.amax();
        if path.is_converged && size < SMALL * smooth.extent && size > RESTS * smooth.extent {
            smooth = smooth.resized(size);
            self.problem.extent = size;
            self.starts.clear();
            path = self.follow(&smooth);
        }
        let modes = self.modes_of(&smooth, &path);
        let found = polish(&smooth, &path, &sides_of(&path.forces), modes)?.sticking(&self.problem);
        self.n_iterations += found.n_iterations;
        if self.consider(found.clone()) {
            return Some(Stage::Frictionless);
        }
        let start = Start { twist: &found.twist, ground_forces: &found.ground_forces, forces: &found.forces };
        if self.walk(Guess { ground: found.ground, modes: found.modes.clone() }, &start) {
            return Some(Stage::Modes);
        }
        self.limit(&smooth, &path).then_some(Stage::Limit)
    }

    /// Rest or slip next to the limit of slipping, with the contacts that the end of a path without
    /// side friction shows, and with each support as the pinned one.
    fn limit(&mut self, smooth: &Problem, path: &Path) -> bool {
        let modes = self.modes_of(smooth, path);
        let forces = sides_of(&path.forces);
        let start = Start { twist: &path.twist, ground_forces: &path.ground_forces, forces: &forces };
        let pins = (0..smooth.cones.len()).map(ContactMode::Pinned);
        [ContactMode::Slip].into_iter().chain(pins).any(|ground| {
            let found = next_to_the_limit(smooth, ground, &modes, &start);
            found.is_some_and(|found| {
                self.n_iterations += found.n_iterations;
                self.consider(found)
            })
        })
    }

    fn follow(&mut self, problem: &Problem) -> Path {
        let path = follow(problem, &problem.rows);
        self.count(&path);
        self.starts.push((path.twist, path.ground_forces.clone(), sides_of(&path.forces)));
        path
    }

    fn count(&mut self, path: &Path) {
        self.n_solves += 1;
        self.n_iterations += path.n_iterations;
    }

    fn modes_of(&self, problem: &Problem, path: &Path) -> PerContact<SideMode> {
        let mode = |k: usize| {
            let slip = problem.slip(k, &path.twist);
            if !path.is_closed[k] {
                SideMode::Open
            } else if problem.rows[k].friction_coefficient > 0.0 && slip.abs() < SLOW * problem.extent {
                SideMode::Stick
            } else {
                SideMode::Slide { forward: slip >= 0.0 }
            }
        };
        (0..problem.rows.len()).map(mode).collect()
    }

    /// Answer of a convex step.
    fn relaxed(&mut self, offsets: &[f64]) -> Relaxed {
        let relaxed = Relaxed::new(&self.problem, offsets);
        self.count(&relaxed.path);
        relaxed
    }

    /// Exact answer in the modes that a convex step shows.
    fn polished(&mut self, relaxed: &Relaxed) -> Option<Candidate> {
        let found = polish(&self.problem, &relaxed.path, &relaxed.forces(&self.problem), relaxed.modes(&self.problem))?;
        self.n_iterations += found.n_iterations;
        Some(found)
    }

    fn rest_or_slide(&mut self) -> Option<Stage> {
        let n = self.problem.rows.len();
        let first = self.relaxed(&PerContact::from_elem(0.0, n));
        self.starts.push((first.path.twist, first.path.ground_forces.clone(), first.forces(&self.problem)));
        let rest = self.polished(&first).filter(|found| self.problem.residual_of(found) <= ACCEPTED);
        let Some(rest) = rest else {
            let closed: PerContact<bool> = first.modes(&self.problem).iter().map(|mode| *mode != SideMode::Open).collect();
            return (self.climb(PerContact::from_elem(0.0, n), first, None) || self.climb_from(&closed, FIRST_OFFSET, None))
                .then_some(Stage::Offsets);
        };
        let sticks: PerContact<bool> = rest.modes.iter().map(|mode| *mode == SideMode::Stick).collect();
        if !sticks.contains(&true) {
            return if self.consider(rest) {
                Some(Stage::Offsets)
            } else {
                self.climb(PerContact::from_elem(0.0, n), first, None).then_some(Stage::Offsets)
            };
        }
        if self.is_stable(&sticks) {
            return self.consider(rest).then_some(Stage::StableRest);
        }
        for share in [FIRST_OFFSET, DISTURBANCE] {
            if self.climb_from(&sticks, share, Some(&rest)) {
                return Some(Stage::Offsets);
            }
        }
        self.consider(rest).then_some(Stage::Unstable)
    }

    /// Slip offsets of these contacts, over the size of the increment.
    fn offsets(&self, contacts: &[bool], share: f64) -> PerContact<f64> {
        contacts.iter().map(|is_offset| if *is_offset { share * self.problem.extent } else { 0.0 }).collect()
    }

    /// Whether the contacts that stick slip by less than slip offsets that disturb them; greater
    /// ones where the least lead to no answer.
    fn is_stable(&mut self, sticks: &[bool]) -> bool {
        [DISTURBANCE, FIRST_OFFSET].into_iter().find_map(|share| self.is_stable_against(sticks, share)).unwrap_or(false)
    }

    fn is_stable_against(&mut self, sticks: &[bool], share: f64) -> Option<bool> {
        let offsets = self.offsets(sticks, share);
        let magnified = self.problem.clone().resized(MAGNIFIED * share * self.problem.extent);
        let disturbed = Relaxed::new(&magnified, &offsets);
        self.count(&disturbed.path);
        let slip = |k: usize| self.problem.slip(k, &disturbed.path.twist).abs();
        let is_stable = (0..sticks.len()).all(|k| !sticks[k] || slip(k) <= offsets[k] * (1.0 + ROUNDED));
        disturbed.path.is_converged.then_some(is_stable)
    }

    /// Newton's method on the slip offsets, from one of this `share` at these contacts.
    fn climb_from(&mut self, contacts: &[bool], share: f64, rest: Option<&Candidate>) -> bool {
        let offsets = self.offsets(contacts, share);
        let disturbed = self.relaxed(&offsets);
        self.climb(offsets, disturbed, rest)
    }

    /// Newton's method on the slip offsets; it leads away from a `rest` that is not stable.
    fn climb(&mut self, mut offsets: PerContact<f64>, mut relaxed: Relaxed, rest: Option<&Candidate>) -> bool {
        let is_rest = |found: &Candidate, same: f64| rest.is_some_and(|rest| (found.twist - rest.twist).amax() <= same);
        for round in 0..if rest.is_some() { FEW_ROUNDS } else { MOST_ROUNDS } {
            let same = SAME * self.problem.extent;
            let found = self.polished(&relaxed).filter(|found| !is_rest(found, same));
            if found.is_some_and(|found| self.consider(found)) {
                return true;
            }
            let Some(step) = self.offset_step(&relaxed, &offsets, round) else { return false };
            offsets.iter_mut().zip(&step).for_each(|(offset, step)| *offset = (*offset + step).max(0.0));
            relaxed = self.relaxed(&offsets);
        }
        false
    }

    fn offset_step(&self, relaxed: &Relaxed, offsets: &[f64], round: u32) -> Option<PerContact<f64>> {
        let n = offsets.len();
        let slips: PerContact<f64> = (0..n).map(|k| self.problem.slip(k, &relaxed.path.twist)).collect();
        let missing = DVector::from_fn(n, |k, _| slips[k].abs() - offsets[k]);
        let slope = DMatrix::from_fn(n, n, |k, l| slips[k].signum() * relaxed.slip_by_offset(&self.problem, k, l));
        // Without a contact there is nothing to offset.
        if n == 0 || !slope.iter().all(|v| v.is_finite()) {
            return None;
        }
        let step = if round < LONG_ROUNDS && steepest(&slope) < STEEP {
            (DMatrix::identity(n, n) - slope).lu().solve(&missing)?
        } else {
            missing * if round < LONG_ROUNDS { 4.0 } else { 0.5 }
        };
        Some(step.iter().copied().collect())
    }

    fn smoothed(&mut self) -> bool {
        let problem = self.problem.clone();
        let path = self.follow(&problem);
        let modes = self.modes_of(&problem, &path);
        let found = polish(&problem, &path, &sides_of(&path.forces), modes);
        self.n_iterations += found.as_ref().map_or(0, |found| found.n_iterations);
        found.is_some_and(|found| self.consider(found))
    }

    fn enumerate(&mut self) -> bool {
        let n = self.problem.rows.len();
        if n > FEW {
            return false;
        }
        let grounds = [ContactMode::Slip, ContactMode::Stick].into_iter().chain((0..self.problem.cones.len()).map(ContactMode::Pinned));
        let starts = std::mem::take(&mut self.starts);
        for ground in grounds {
            for code in 0..4usize.pow(n as u32) {
                let mode = |k: usize| match code / 4usize.pow(k as u32) % 4 {
                    0 => SideMode::Slide { forward: true },
                    1 => SideMode::Slide { forward: false },
                    2 => SideMode::Open,
                    _ => SideMode::Stick,
                };
                let guess = Guess { ground, modes: (0..n).map(mode).collect() };
                for (twist, ground_forces, forces) in &starts {
                    let found = self.newton(&guess, &Start { twist, ground_forces, forces });
                    if found.is_some_and(|found| self.consider(found)) {
                        return true;
                    }
                }
            }
        }
        false
    }
}

/// Largest real part of the eigenvalues (1); infinite where they are not found. Rotations that
/// decouple entries near underflow may go on for ever.
fn steepest(slope: &DMatrix<f64>) -> f64 {
    let decoupled = Schur::try_new(slope.clone(), f64::EPSILON, MOST_ROTATIONS);
    decoupled.map_or(f64::INFINITY, |schur| schur.complex_eigenvalues().iter().map(|value| value.re).fold(f64::NEG_INFINITY, f64::max))
}

/// Exact answer in the modes that the end of a path shows. Where the mode with the ground is not
/// plain there, others are tried, and at last rest on all obstacles that touch.
fn polish(problem: &Problem, path: &Path, forces: &[SideForce], modes: PerContact<SideMode>) -> Option<Candidate> {
    let start = Start { twist: &path.twist, ground_forces: &path.ground_forces, forces };
    let shown = path.ground_mode();
    let closed = |k: usize| if problem.rows[k].friction_coefficient > 0.0 { SideMode::Stick } else { SideMode::Slide { forward: true } };
    let touching = |k: usize| if problem.rows[k].gap == 0.0 { closed(k) } else { SideMode::Open };
    let caged: PerContact<SideMode> = (0..modes.len()).map(touching).collect();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::contact::solve::ContactSystem;
    use crate::backend::friction::FrictionSolver;
    use crate::math::Mat3;
    use crate::model::{Ground, SupportPoint};

    /// Away from a rest without contacts there is no way by offsets.
    #[test]
    fn a_search_without_contacts_has_nothing_to_offset() {
        let supports = [0.0, 2.0, 4.0].map(|angle| SupportPoint { offset: crate::math::direction(angle), normal_load: 1.0 });
        let solver = FrictionSolver::new(&Ground { friction_coefficient: 1.0, supports: supports.to_vec() }, 1.0);
        let (hessian, drive) = (Mat3::identity(), Vec3::new(0.1, 0.0, 0.0));
        let problem = Problem::new(solver.cones(), &ContactSystem { hessian: &hessian, drive: &drive, rows: &[] }, None);
        let mut search = Search::new(problem);
        let relaxed = search.relaxed(&[]);
        let rest = search.polished(&relaxed).unwrap();
        assert!(!search.climb(PerContact::new(), relaxed, Some(&rest)));
    }

    /// Slopes of five contacts that resist by very different forces. Without a bound their
    /// eigenvalues take for ever.
    #[test]
    fn eigenvalues_end_where_entries_underflow() {
        let first =
            [-6.471402389709463e-167, -3.3101222011018535e-32, -7.651417684279916e-209, -8.393791688652103e-288, -7.047432314129114e-295];
        let fourth = [
            -2.5871123550944406e-167,
            -1.3233079211641296e-32,
            -3.0588543306263754e-209,
            -1.0851048106683281e-287,
            -2.8173953825785506e-295,
        ];
        let entry = |i: usize, j: usize| match i {
            0 | 1 => first[j],
            3 => fourth[j],
            _ => -first[j],
        };
        assert_eq!(steepest(&DMatrix::from_fn(5, 5, entry)), f64::INFINITY);
        let plain = DMatrix::from_row_slice(3, 3, &[0.2, 1.0, 0.0, 0.0, 0.5, 1.0, 0.0, 0.0, -3.0]);
        assert!((steepest(&plain) - 0.5).abs() < 1e-12);
    }
}
