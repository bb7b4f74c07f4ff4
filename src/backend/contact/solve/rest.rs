//! Forces of a load that does not move.
//!
//! They are not unique. From given ones, which need not balance the drive, the least change in
//! units of the room to each limit leads to forces that do.

use smallvec::SmallVec;

use super::problem::{Candidate, PerCone, Problem, Start};
use super::types::{PerContact, SideForce, SideMode};
use crate::backend::friction::ContactMode;
use crate::backend::friction::cones::slip_gram;
use crate::backend::numerics::{BALANCE_ROUNDS, FORCE_RIDGE, LEAST_ROOM};
use crate::math::{Mat3, PositiveDefinite, Vec2, Vec3};
use crate::model::support::slip_velocity;

/// Rest with forces near those of `start`; `None` where they cannot balance.
///
/// The squares of their changes over this `power` of their rooms have the least sum. With the
/// second one, forces near a limit hardly change. With the first one, forces that start from none
/// all take the same share of their limits along a straight drive.
pub fn balance(problem: &Problem, modes: &[SideMode], start: &Start, power: i32) -> Option<Candidate> {
    // A contact that has not slipped sticks.
    let at_rest = |(k, mode): (usize, &SideMode)| match mode {
        SideMode::Slide { .. } if problem.rows[k].friction_coefficient > 0.0 && !problem.slips(k, &Vec3::zeros()) => SideMode::Stick,
        mode => *mode,
    };
    let modes: PerContact<SideMode> = modes.iter().enumerate().map(at_rest).collect();
    let mut forces = Forces {
        problem,
        modes: &modes,
        power,
        ground: start.ground_forces.iter().copied().collect(),
        sides: start.forces.iter().copied().collect(),
    };
    forces.open();
    for _ in 0..BALANCE_ROUNDS {
        forces.change(&forces.missing())?;
    }
    let is_touched = modes.iter().any(|mode| *mode != SideMode::Open);
    Some(Candidate {
        twist: Vec3::zeros(),
        ground: ContactMode::Stick,
        ground_forces: forces.ground,
        forces: forces.sides,
        modes,
        are_forces_unique: !is_touched,
        is_consistent: true,
        is_stable: true,
        n_iterations: BALANCE_ROUNDS,
    })
}

struct Forces<'a> {
    problem: &'a Problem<'a>,
    modes: &'a [SideMode],
    power: i32,
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

    /// Adds the least change that balances `missing`, in units of the room of each force.
    fn change(&mut self, missing: &Vec3) -> Option<()> {
        let Problem { cones, rows, force, .. } = self.problem;
        let ground_room: PerCone<f64> =
            self.ground.iter().zip(&cones.limits).map(|(f, limit)| (limit - f.norm()).max(LEAST_ROOM * limit).powi(self.power)).collect();
        // Columns of the sides with their rooms: what one unit of each adds to the wrench.
        let mut columns: SmallVec<[(usize, bool, Vec3, f64); 8]> = SmallVec::new();
        for k in (0..rows.len()).filter(|k| self.modes[*k] != SideMode::Open) {
            let SideForce { normal, tangential } = self.sides[k];
            let room = normal.max(LEAST_ROOM * force);
            columns.push((k, true, -self.problem.direction_of(k, self.modes[k]), room.powi(self.power)));
            if self.modes[k] == SideMode::Stick {
                let room = (self.friction(k) * normal - tangential.abs()).max(LEAST_ROOM * self.friction(k) * room);
                columns.push((k, false, -rows[k].tangent, room.powi(self.power)));
            }
        }
        let mut gram = Mat3::zeros();
        for (offset, room) in cones.offsets.iter().zip(&ground_room) {
            gram += *room * slip_gram(offset);
        }
        for (_, _, column, room) in &columns {
            gram += *room * column * column.transpose();
        }
        gram += Mat3::from_diagonal_element(FORCE_RIDGE * gram.amax());
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
