//! Forces of a load that does not move.
//!
//! They are not unique. From given ones, which need not balance the drive, the least change in
//! units of the room to each limit leads to forces that do.

use smallvec::SmallVec;

use super::modes::{Start, direction_of};
use super::problem::{Candidate, PerCone, Problem};
use super::types::{PerContact, SideForce, SideMode};
use crate::backend::friction::ContactMode;
use crate::backend::friction::cones::slip_gram;
use crate::math::{Mat3, PositiveDefinite, Vec2, Vec3};
use crate::model::support::slip_velocity;

/// Rounds at most. The room changes with the forces, and each round takes it anew.
const MOST_ROUNDS: u32 = 8;
/// Imbalance over the forces that is rounding (1).
const ROUNDED: f64 = 1e-16;
/// Least room, over the limit (1).
const LEAST_ROOM: f64 = 1e-9;
/// Share of its limit to which a force beyond it is moved back (1).
const WITHIN: f64 = 0.999;

/// Rest with forces near those of `start`; `None` where they cannot balance.
pub fn balance(problem: &Problem, modes: &[SideMode], start: &Start) -> Option<Candidate> {
    let mut forces =
        Forces { problem, modes, ground: start.ground_forces.iter().copied().collect(), sides: start.forces.iter().copied().collect() };
    forces.open();
    let mut n_iterations = 0;
    for round in 0..MOST_ROUNDS {
        let missing = forces.missing();
        if missing.amax() <= ROUNDED * problem.force {
            break;
        }
        if round > 0 && !forces.are_within() {
            forces.move_back();
        }
        n_iterations += 1;
        forces.change(&forces.missing())?;
    }
    let is_touched = modes.iter().any(|mode| *mode != SideMode::Open);
    Some(Candidate {
        twist: Vec3::zeros(),
        ground: ContactMode::Stick,
        ground_forces: forces.ground,
        forces: forces.sides,
        modes: modes.into(),
        are_forces_unique: !is_touched,
        is_consistent: true,
        is_stable: true,
        n_iterations,
    })
}

struct Forces<'a> {
    problem: &'a Problem<'a>,
    modes: &'a [SideMode],
    ground: PerCone<Vec2>,
    sides: PerContact<SideForce>,
}

impl Forces<'_> {
    /// Takes the forces off contacts that are open, and gives those that slide theirs.
    fn open(&mut self) {
        for k in 0..self.modes.len() {
            self.sides[k] = match self.modes[k] {
                SideMode::Open => SideForce::default(),
                SideMode::Stick => self.sides[k],
                SideMode::Slide { .. } => self.sliding(k, self.sides[k].normal),
            };
        }
    }

    fn friction(&self, k: usize) -> f64 {
        self.problem.rows[k].friction_coefficient
    }

    fn sliding(&self, k: usize, normal: f64) -> SideForce {
        let sign = if self.modes[k] == (SideMode::Slide { forward: true }) { 1.0 } else { -1.0 };
        SideForce { normal, tangential: -sign * self.friction(k) * normal }
    }

    /// Wrench that the ground has yet to balance.
    fn missing(&self) -> Vec3 {
        self.problem.w + self.problem.side_wrench(&self.sides) - self.problem.cones.wrench(&self.ground)
    }

    fn are_within(&self) -> bool {
        let limits = &self.problem.cones.limits;
        self.ground.iter().zip(limits).all(|(force, limit)| force.norm() <= *limit)
            && (0..self.sides.len()).all(|k| {
                let SideForce { normal, tangential } = self.sides[k];
                normal >= 0.0 && tangential.abs() <= self.friction(k) * normal
            })
    }

    fn move_back(&mut self) {
        for (force, limit) in self.ground.iter_mut().zip(&self.problem.cones.limits) {
            let size = force.norm();
            if size > *limit {
                *force *= WITHIN * limit / size;
            }
        }
        for k in 0..self.sides.len() {
            let friction = self.friction(k);
            let side = &mut self.sides[k];
            side.normal = side.normal.max(0.0);
            if side.tangential.abs() > friction * side.normal {
                side.tangential = WITHIN * friction * side.normal * side.tangential.signum();
            }
        }
    }

    /// Adds the least change that balances `missing`, in units of the room of each force.
    fn change(&mut self, missing: &Vec3) -> Option<()> {
        let Problem { cones, rows, force, .. } = self.problem;
        let ground_room: PerCone<f64> =
            self.ground.iter().zip(&cones.limits).map(|(f, limit)| (limit - f.norm()).max(LEAST_ROOM * limit).powi(2)).collect();
        // Columns of the sides with their rooms: what one unit of each adds to the wrench.
        let mut columns: SmallVec<[(usize, bool, Vec3, f64); 8]> = SmallVec::new();
        for k in (0..rows.len()).filter(|k| self.modes[*k] != SideMode::Open) {
            let SideForce { normal, tangential } = self.sides[k];
            let room = normal.max(LEAST_ROOM * force);
            columns.push((k, true, -direction_of(self.problem, k, self.modes[k]), room * room));
            if self.modes[k] == SideMode::Stick {
                let room = (self.friction(k) * normal - tangential.abs()).max(LEAST_ROOM * self.friction(k) * room);
                columns.push((k, false, -rows[k].tangent, room * room));
            }
        }
        let mut gram = Mat3::zeros();
        for (offset, room) in cones.offsets.iter().zip(&ground_room) {
            gram += *room * slip_gram(offset);
        }
        for (_, _, column, room) in &columns {
            gram += *room * column * column.transpose();
        }
        gram += Mat3::from_diagonal_element(1e-15 * gram.amax());
        let twist = PositiveDefinite::new(&gram)?.solve(missing);
        for ((force, offset), room) in self.ground.iter_mut().zip(&cones.offsets).zip(&ground_room) {
            *force += *room * slip_velocity(offset, &twist);
        }
        for (k, is_normal, column, room) in columns {
            let change = room * column.dot(&twist);
            if !is_normal {
                self.sides[k].tangential += change;
            } else if self.modes[k] == SideMode::Stick {
                self.sides[k].normal += change;
            } else {
                self.sides[k] = self.sliding(k, self.sides[k].normal + change);
            }
        }
        Some(())
    }
}
