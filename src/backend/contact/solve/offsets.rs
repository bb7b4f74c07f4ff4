//! Rest, and slides near it.
//!
//! The convex step with friction cones is exact if nothing slides. Rest is stable if the step with
//! slip offsets far smaller than the increment slips by less than these. Where it is not, and where
//! something slides, Newton's method on the offsets leads to the slide (`climb`).

use nalgebra::linalg::Schur;
use nalgebra::{DMatrix, DVector};
use smallvec::SmallVec;

use super::path::follow;
use super::problem::{Candidate, PerCone, Start};
use super::relaxed::{Facet, Facets, Relaxed};
use super::rest::balance;
use super::search::{Guess, Search, polish};
use super::types::{ContactRow, PerContact, SideForce, SideMode, Stage};
use crate::backend::friction::ContactMode;
use crate::backend::numerics::{
    ACCEPTED, DISTURBANCE, DISTURBED_ROUNDS, FIRST_OFFSET, FULL_ROUNDS, MAGNIFIED, MOST_ROTATIONS, NEXT_TO_REST, OFFSET_ROUNDING,
    OFFSET_ROUNDS, SAME_INCREMENT, STEEP_SLIP, UNCHANGED_OFFSETS,
};
use crate::math::{Vec2, Vec3};
use crate::stop;

impl<'a> Search<'a> {
    /// Rest that is stable, or else a slide.
    pub(super) fn rest_or_slide(&mut self) -> Option<Stage> {
        if let Some(rest) = self.rest_by_forces() {
            return self.keep_or_leave(rest);
        }
        let none = PerContact::from_elem(0.0, self.problem.rows.len());
        let first = self.relaxed(&none);
        let (modes, forces) = (first.modes(&self.problem), first.forces(&self.problem));
        self.starts.push((first.path.twist, first.path.ground_forces.clone(), forces.clone()));
        let rest = self.polished(&first).filter(|found| self.problem.residual_of(found) <= ACCEPTED);
        let Some(rest) = rest else {
            let start = Start { twist: &first.path.twist, ground_forces: &first.path.ground_forces, forces: &forces };
            if start.twist.amax() <= NEXT_TO_REST * self.problem.extent && self.limit(&modes, &start) {
                return Some(Stage::Limit);
            }
            let closed: PerContact<bool> = modes.iter().map(|mode| *mode != SideMode::Open).collect();
            return (self.climb(none, first, None) || self.climb_from(&closed, FIRST_OFFSET, None)).then_some(Stage::Offsets);
        };
        if rest.modes.contains(&SideMode::Stick) {
            return self.keep_or_leave(rest);
        }
        (self.consider(rest) || self.climb(none, first, None)).then_some(Stage::Offsets)
    }

    /// Rest on all obstacles that touch, with forces near those that hold the load back without
    /// side friction. As the convex step has one answer, it is this one.
    fn rest_by_forces(&mut self) -> Option<Candidate> {
        let slide = self.frictionless.as_ref()?;
        let modes = self.problem.touching();
        if !modes.contains(&SideMode::Stick) {
            return None;
        }
        let n_touching = modes.iter().filter(|mode| **mode != SideMode::Open).count();
        let normal = slide.forces.iter().map(|force| force.normal).sum::<f64>() / n_touching as f64;
        let ground_forces = PerCone::from_elem(Vec2::zeros(), self.problem.cones.len());
        let forces = PerContact::from_elem(SideForce { normal, tangential: 0.0 }, modes.len());
        let start = Start { twist: &Vec3::zeros(), ground_forces: &ground_forces, forces: &forces };
        let rest = balance(&self.problem, &modes, &start, 1)?;
        (self.problem.residual_of(&rest) <= ACCEPTED).then_some(rest)
    }

    /// Slip offsets of these contacts, over the size of the increment.
    fn offsets(&self, contacts: &[bool], share: f64) -> PerContact<f64> {
        contacts.iter().map(|is_offset| if *is_offset { share * self.problem.extent } else { 0.0 }).collect()
    }

    /// This rest if it is stable, or else a slide near it.
    fn keep_or_leave(&mut self, rest: Candidate) -> Option<Stage> {
        // Greater offsets where the least lead to no answer.
        let is_stable = self.is_stable(&rest, DISTURBANCE).or_else(|| self.is_stable(&rest, FIRST_OFFSET));
        if is_stable == Some(true) {
            return self.consider(rest).then_some(Stage::StableRest);
        }
        let sticks = sticks(&rest);
        if [FIRST_OFFSET, DISTURBANCE].into_iter().any(|share| self.climb_from(&sticks, share, Some(&rest))) {
            return Some(Stage::Offsets);
        }
        self.consider(rest).then_some(Stage::Unstable)
    }

    /// Whether the contacts that stick at rest slip by less than offsets of this share of the
    /// increment, if they lead to an answer.
    fn is_stable(&mut self, rest: &Candidate, share: f64) -> Option<bool> {
        let offsets = self.offsets(&sticks(rest), share);
        let magnified = self.problem.clone().resized(MAGNIFIED * share * self.problem.extent);
        let facets = Facets::new(&magnified, &offsets);
        let disturbed = self.disturbed(&facets, &offsets, rest).or_else(|| {
            let path = follow(&facets.step);
            self.count(&path);
            path.is_converged.then_some(path.twist)
        })?;
        let slip = |k: usize| self.problem.slip(k, &disturbed).abs();
        Some((0..offsets.len()).all(|k| offsets[k] == 0.0 || slip(k) <= offsets[k] * (1.0 + OFFSET_ROUNDING)))
    }

    /// Increment of a convex step with small slip offsets, by Newton's method. A load that rests on
    /// one contact is pressed into it, on several it slips along them.
    fn disturbed(&mut self, facets: &Facets, offsets: &[f64], rest: &Candidate) -> Option<Vec3> {
        let disturbed: SmallVec<[usize; 4]> = (0..offsets.len()).filter(|k| offsets[*k] > 0.0).collect();
        let twist = if let [k] = disturbed[..] {
            let ContactRow { normal, friction_coefficient, .. } = &self.problem.rows[k];
            -(friction_coefficient * offsets[k] / normal.norm_squared()) * normal
        } else {
            let slide = self.frictionless.as_ref()?.twist;
            let length_of = |k: &usize| offsets[*k] / self.problem.slip(*k, &slide).abs();
            disturbed.iter().map(length_of).fold(f64::INFINITY, f64::min) * slide
        };
        let is_closed = |&(k, sign): &Facet| offsets[k] > 0.0 && (disturbed.len() == 1 || sign * self.problem.slip(k, &twist) >= 0.0);
        let mode = |facet| if is_closed(facet) { SideMode::Slide { forward: true } } else { SideMode::Open };
        let force = |(k, _): &Facet| SideForce { tangential: 0.0, ..rest.forces[*k] };
        let forces: PerContact<SideForce> = facets.owners.iter().map(force).collect();
        let guess = Guess { ground: ContactMode::Slip, modes: facets.owners.iter().map(mode).collect() };
        let mut search = Search::new(facets.step.clone());
        let is_found = search.walk(guess, &Start { twist: &twist, ground_forces: &rest.ground_forces, forces: &forces });
        self.n_iterations += search.n_iterations;
        search.best.filter(|_| is_found).map(|(found, _)| found.twist)
    }

    /// Answer of a convex step.
    fn relaxed(&mut self, offsets: &[f64]) -> Relaxed<'a> {
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

    /// Newton's method on the slip offsets, from one of this `share` at these contacts.
    fn climb_from(&mut self, contacts: &[bool], share: f64, rest: Option<&Candidate>) -> bool {
        let offsets = self.offsets(contacts, share);
        let disturbed = self.relaxed(&offsets);
        self.climb(offsets, disturbed, rest)
    }

    /// Newton's method on the slip offsets; it leads away from a `rest` that is not stable.
    fn climb(&mut self, mut offsets: PerContact<f64>, mut relaxed: Relaxed<'a>, rest: Option<&Candidate>) -> bool {
        let is_rest = |found: &Candidate, same: f64| rest.is_some_and(|rest| (found.twist - rest.twist).amax() <= same);
        let first = largest(&offsets);
        for round in 0..if rest.is_some() { DISTURBED_ROUNDS } else { OFFSET_ROUNDS } {
            stop::point();
            let same = SAME_INCREMENT * self.problem.extent;
            let found = self.polished(&relaxed).filter(|found| !is_rest(found, same));
            if found.is_some_and(|found| self.consider(found)) {
                return true;
            }
            let Some(step) = self.offset_step(&relaxed, &offsets, round) else { return false };
            let next: PerContact<f64> = offsets.iter().zip(&step).map(|(offset, step)| (offset + step).max(0.0)).collect();
            let height = largest(&next);
            let is_unchanged = offsets.iter().zip(&next).all(|(offset, next)| (next - offset).abs() <= UNCHANGED_OFFSETS * height);
            // Offsets below the first ones lead back to rest: in 20,000 random steps no search that
            // went on from there found a slide.
            if is_unchanged || rest.is_some() && height < first {
                return false;
            }
            offsets = next;
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
        let step = if round < FULL_ROUNDS && steepest(&slope) < STEEP_SLIP {
            (DMatrix::identity(n, n) - slope).lu().solve(&missing)?
        } else {
            missing * if round < FULL_ROUNDS { 4.0 } else { 0.5 }
        };
        Some(step.iter().copied().collect())
    }
}

/// Contacts that stick.
fn sticks(found: &Candidate) -> PerContact<bool> {
    found.modes.iter().map(|mode| *mode == SideMode::Stick).collect()
}

fn largest(offsets: &[f64]) -> f64 {
    offsets.iter().copied().fold(0.0, f64::max)
}

/// Largest real part of the eigenvalues (1); infinite where they are not found. Rotations that
/// decouple entries near underflow may go on for ever.
fn steepest(slope: &DMatrix<f64>) -> f64 {
    let decoupled = Schur::try_new(slope.clone(), f64::EPSILON, MOST_ROTATIONS);
    decoupled.map_or(f64::INFINITY, |schur| schur.complex_eigenvalues().iter().map(|value| value.re).fold(f64::NEG_INFINITY, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::contact::solve::ContactSystem;
    use crate::backend::contact::solve::problem::Problem;
    use crate::backend::friction::FrictionSolver;
    use crate::math::Mat3;
    use crate::model::{Ground, SupportPoint};

    /// Away from a rest without contacts there is no way by offsets.
    #[test]
    fn a_search_without_contacts_has_nothing_to_offset() {
        let supports = [0.0, 2.0, 4.0].map(|angle| SupportPoint {
            offset: crate::math::direction(angle),
            normal_load: 1.0,
            friction_coefficient: None,
        });
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
