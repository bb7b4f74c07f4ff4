//! Convex steps that stand for side friction: the cone of each contact as two facets.
//!
//! For given slip offsets z_k the rows `(n_k -+ mu_k t_k) x >= -g_k - mu_k z_k` bound the
//! increment, and their forces lie in the friction cones (Anitescu 2006). The answer of this convex
//! step is one by Coulomb's law exactly where `z_k = |s_k|` at all closed contacts (Acary, Cadoux,
//! Lemarechal and Malick 2011).

use smallvec::SmallVec;

use super::path::{Path, follow};
use super::problem::Problem;
use super::types::{ContactRow, PerContact, SideForce, SideMode};

/// Contact and sign of the slip that a facet opposes; zero without friction.
pub type Facet = (usize, f64);

/// Facets of the friction cones for these slip offsets (scaled).
pub struct Facets<'a> {
    pub owners: SmallVec<[Facet; 8]>,
    /// The convex step: one row without friction a facet.
    pub step: Problem<'a>,
}

impl<'a> Facets<'a> {
    pub fn new(problem: &Problem<'a>, offsets: &[f64]) -> Self {
        let mut owners: SmallVec<[Facet; 8]> = SmallVec::new();
        for (k, row) in problem.rows.iter().enumerate() {
            if row.friction_coefficient > 0.0 {
                owners.extend([(k, 1.0), (k, -1.0)]);
            } else {
                owners.push((k, 0.0));
            }
        }
        let row_of = |&(k, sign): &Facet| {
            let row = &problem.rows[k];
            let friction = row.friction_coefficient;
            ContactRow {
                normal: row.normal - sign * friction * row.tangent,
                gap: row.gap + friction * (offsets[k] - sign * row.slip),
                friction_coefficient: 0.0,
                ..*row
            }
        };
        let step = problem.with_rows(owners.iter().map(row_of).collect());
        Self { owners, step }
    }
}

/// Answer of a convex step.
pub struct Relaxed<'a> {
    pub path: Path,
    facets: Facets<'a>,
}

impl<'a> Relaxed<'a> {
    /// Answer for these slip offsets (scaled).
    pub fn new(problem: &Problem<'a>, offsets: &[f64]) -> Self {
        let facets = Facets::new(problem, offsets);
        Self { path: follow(&facets.step), facets }
    }

    /// Forces at the contacts.
    pub fn forces(&self, problem: &Problem) -> PerContact<SideForce> {
        let mut forces: PerContact<SideForce> = SmallVec::from_elem(SideForce::default(), problem.rows.len());
        for ((k, sign), force) in self.facets.owners.iter().zip(&self.path.forces) {
            forces[*k].normal += force.normal;
            forces[*k].tangential -= sign * problem.rows[*k].friction_coefficient * force.normal;
        }
        forces
    }

    /// Modes of the contacts that the closed facets show.
    pub fn modes(&self, problem: &Problem) -> PerContact<SideMode> {
        let mut modes: PerContact<SideMode> = SmallVec::from_elem(SideMode::Open, problem.rows.len());
        let closed = self.facets.owners.iter().zip(&self.path.is_closed).filter(|(_, is_closed)| **is_closed);
        for ((k, sign), _) in closed {
            let forward = if *sign == 0.0 { problem.slip(*k, &self.path.twist) >= 0.0 } else { *sign > 0.0 };
            modes[*k] = if modes[*k] == SideMode::Open { SideMode::Slide { forward } } else { SideMode::Stick };
        }
        modes
    }

    /// Derivative of the slip of contact k by the slip offset of contact l.
    pub fn slip_by_offset(&self, problem: &Problem, k: usize, l: usize) -> f64 {
        let facets = self.facets.owners.iter().enumerate().filter(|(_, (owner, _))| *owner == l);
        let by_facet = |j: usize| problem.rows[k].tangent.dot(&self.path.by_gap(&self.facets.step.rows[j], j));
        problem.rows[l].friction_coefficient * facets.map(|(j, _)| by_facet(j)).sum::<f64>()
    }
}
