//! Forces of a load that does not move.
//!
//! They are not unique. From given ones, which need not balance the drive, the least change in
//! units of the room to each limit leads to forces that do.

use smallvec::SmallVec;

use super::problem::{Candidate, PerCone, Problem, Start};
use super::types::{ContactRow, PerContact, SideForce, SideMode};
use crate::backend::friction::ContactMode;
use crate::backend::friction::cones::slip_gram;
use crate::math::{Mat3, PositiveDefinite, Vec2, Vec3};
use crate::model::support::slip_velocity;

/// Rounds: the second one balances what rounding has left.
const N_ROUNDS: u32 = 2;
/// Least room, over the limit (1).
const LEAST_ROOM: f64 = 1e-9;
/// Share of the limits that forces may need where a load goes on resting (1).
const CLEAR: f64 = 0.95;
/// Sine of the angle between two sides of one wall (1).
const PARALLEL: f64 = 1e-9;
/// Ridge for forces that do not span all wrenches, over the largest entry (1).
const RIDGE: f64 = 1e-15;

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
    for _ in 0..N_ROUNDS {
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
        n_iterations: N_ROUNDS,
    })
}

/// Whether forces at rest leave so much of their limits that the load cannot slide as well.
///
/// Obstacles on several sides can wedge a load by forces that need no drive, and the ground may
/// press a load at rest against an obstacle. Both raise the limit of the side friction, and neither
/// is left once the load slides. Along a straight wall, the ground holds a sliding load back by its
/// own limit. It must therefore be able to hold back there what it does at rest, and what it adds
/// to the side friction.
pub fn is_clear(problem: &Problem, rest: &Candidate) -> bool {
    let sides = || problem.rows.iter().zip(&rest.forces).filter(|(_, side)| side.normal != 0.0);
    let mut normals = sides().map(|(row, _)| row.normal.xy());
    let first = normals.next().unwrap_or_default();
    let is_along = |normal: Vec2| first.dot(&normal) > 0.0 && first.perp(&normal).abs() <= PARALLEL * first.norm() * normal.norm();
    if sides().any(|(row, _)| row.friction_coefficient > 0.0) && !normals.all(is_along) {
        return false;
    }
    let within = |row: &ContactRow, (force, limit): (&Vec2, &f64)| {
        let normal = row.normal.xy();
        let pressing = force.dot(&normal).max(0.0);
        force.perp(&normal).abs() + row.friction_coefficient * pressing <= CLEAR * limit * normal.norm()
    };
    let mut ground = rest.ground_forces.iter().zip(&problem.cones.limits);
    ground.all(|of| of.0.norm() <= CLEAR * of.1 && sides().all(|(row, _)| within(row, of)))
        && sides().all(|(row, side)| side.tangential.abs() <= CLEAR * row.friction_coefficient * side.normal)
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
        gram += Mat3::from_diagonal_element(RIDGE * gram.amax());
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

#[cfg(test)]
mod tests {
    use super::super::go_on_resting;
    use super::super::types::ContactSystem;
    use super::*;
    use crate::backend::friction::FrictionSolver;
    use crate::model::{Ground, SupportPoint};

    /// Whether a load on one support under its centre, whose slip limit is 1 N, goes on resting
    /// with forces near these. Contacts are in its centre.
    fn goes_on(drive: Vec2, ground: Vec2, sides: &[(Vec2, SideForce)]) -> bool {
        let support = SupportPoint { offset: Vec2::zeros(), normal_load: 1.0 };
        let mut solver = FrictionSolver::new(&Ground { friction_coefficient: 1.0, supports: vec![support] }, 1.0);
        solver.keep_scaled(Vec3::zeros(), ContactMode::Stick, &[ground]);
        let row = |(normal, _): &(Vec2, SideForce)| ContactRow {
            normal: normal.push(0.0),
            tangent: Vec3::new(normal.y, -normal.x, 0.0),
            gap: 0.0,
            slip: 0.0,
            friction_coefficient: 1.5,
        };
        let rows: PerContact<ContactRow> = sides.iter().map(row).collect();
        let system = ContactSystem { hessian: &Mat3::zeros(), drive: &drive.push(0.0), rows: &rows };
        let forces: PerContact<SideForce> = sides.iter().map(|(_, force)| *force).collect();
        go_on_resting(&system, &mut solver, &vec![SideMode::Stick; rows.len()], &forces).is_some()
    }

    /// What a wall and the ground can hold together, however the ground presses the load against
    /// the wall: 1 N and 1.5 times the force that the drive presses with.
    #[test]
    fn a_load_that_may_slide_does_not_go_on_resting() {
        let force = |normal: f64, tangential: f64| SideForce { normal, tangential };
        let wall = Vec2::y();
        assert!(goes_on(Vec2::new(2.0, -1.0), Vec2::new(0.6, 0.0), &[(wall, force(1.0, -1.4))]));
        // Nor does it matter that the ground pressed it so far.
        assert!(goes_on(Vec2::new(1.75, -1.0), Vec2::new(0.0, 1.0), &[(wall, force(2.0, -1.75))]));
        assert!(!goes_on(Vec2::new(2.5, -1.0), Vec2::new(1.0, 0.0), &[(wall, force(1.0, -1.5))]));
        let pressed = |push: f64| goes_on(Vec2::new(push, 0.0), Vec2::new(0.2, 0.6), &[(wall, force(0.6, 0.2 - push))]);
        assert!(!pressed(1.0) && !pressed(1.05));
        // Two walls that hold the load against a pull away from both of them.
        let walls = [1.0, -1.0].map(|side| Vec2::new(side, 1.0).normalize());
        let tangential = 10.0 + 1.5 / 2f64.sqrt();
        let wedged = [(walls[0], force(10.0, tangential)), (walls[1], force(10.0, -tangential))];
        assert!(!goes_on(Vec2::new(0.0, 1.5), Vec2::zeros(), &wedged));
        assert!(goes_on(Vec2::new(0.0, -5.0), Vec2::zeros(), &[(wall, force(5.0, 0.0))]));
    }
}
