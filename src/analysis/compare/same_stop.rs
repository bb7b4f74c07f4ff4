//! Places at which both exact loads are held while the engine's load passes.
//!
//! Both exact backends share the code for contacts. If it is wrong at a feature of an obstacle, as
//! a corner that catches where nothing is in the way, both stop or turn there alike, and only the
//! engine is right. The sign of it is looked for where the engine first diverges from the inertial
//! run:
//!
//! * both exact loads are pushed by the same obstacle at about the same place;
//! * the engine's load does not touch it there, or the exact ones have a corner at a corner of the
//!   obstacle, past which a load may slide that still touches it. Without corners, side friction
//!   may hold the exact loads where the engine's load slides, which is an engine error;
//! * the point of the load at which it is held hardly moves along the obstacle on either exact
//!   path, against that of the engine's load. The load may turn about it;
//! * the engine's load is ahead, against the force that holds the exact loads;
//! * the engine's load lies beside the obstacle. Inside of it, it has passed through the obstacle
//!   and not past a feature, which is an engine error.
//!
//! The rule has limits. It sees one instant, so that it misses a wrong stop after another
//! divergence, one from which the engine's load recoils, and one that makes the load slide and not
//! stop. It cannot tell who is right, and also doubts a stop that an engine passes since its load
//! has left the path before by less than the tolerance.

use super::doubt::{Doubt, DoubtKind};
use super::solution::Solution;
use crate::backend::SideContact;
use crate::math::Vec2;
use crate::model::geometry::overlap_depth;
use crate::model::{Obstacle, Outline};
use crate::scenario::Scenario;
use crate::simulation::Row;

/// Distance within which contacts are at the same place, over the load's radius (1). The exact
/// loads meet a feature within their difference, which may be several tolerances of the path;
/// another feature of the load is about a radius away.
const SAME_PLACE: f64 = 0.1;
/// Distance from a corner within which a contact is at it, over the load's radius (1): far more
/// than the error of a touch, and far less than an edge.
const AT_CORNER: f64 = 1e-3;
/// Largest speed of a held point over that of the same point of the engine's load (1).
const HELD: f64 = 0.5;
/// Depth inside the obstacle over the advance against its force from which on the engine's load
/// passes through the obstacle (1): an engine that ignores it lies as deep as it is ahead, and one
/// that passes a feature lies in it by the softness of its contacts.
const THROUGH: f64 = 0.5;

/// The rows of the three runs at one instant, quasi-static first, and those before them.
struct Instant<'a> {
    scenario: &'a Scenario,
    rows: [&'a Row; 3],
    before: [&'a Row; 3],
}

/// The doubt about a place that holds both exact loads and not that of the engine, at the first
/// divergence of the engine (s).
pub(super) fn same_stop(scenario: &Scenario, solutions: &[Solution; 3], diverges_at: f64) -> Option<Doubt> {
    let rows = |at: usize| solutions.each_ref().map(|solution| solution.trace.rows.get(at));
    let at = solutions[1].trace.rows.partition_point(|row| row.time < diverges_at);
    let instant = Instant::of(scenario, rows(at), rows(at.checked_sub(1)?))?;
    let held = instant.rows[1].contacts.iter().find(|contact| instant.is_passed(contact))?;
    // Both are held there since the end of the last row at which one of them was not.
    let is_held = |at: usize| {
        let pushed = |row: Option<&Row>| row.is_some_and(|row| instant.is_pushed(row, held));
        solutions[..2].iter().all(|solution| pushed(solution.trace.rows.get(at)))
    };
    let since = (0..=at).rev().take_while(|at| is_held(*at)).last()?;
    let time_s = solutions[1].trace.rows[since.saturating_sub(1)].time;
    Some(Doubt { kind: DoubtKind::SameStop, backend: None, time_s, obstacle: Some(held.obstacle) })
}

impl<'a> Instant<'a> {
    fn of(scenario: &'a Scenario, rows: [Option<&'a Row>; 3], before: [Option<&'a Row>; 3]) -> Option<Self> {
        let all = |rows: [Option<&'a Row>; 3]| Some([rows[0]?, rows[1]?, rows[2]?]);
        Some(Self { scenario, rows: all(rows)?, before: all(before)? })
    }

    fn obstacle(&self, contact: &SideContact) -> Option<&'a Obstacle> {
        self.scenario.system.world.obstacles.get(contact.obstacle)
    }

    /// Whether a contact of the inertial load holds both exact loads and not that of the engine.
    fn is_passed(&self, contact: &SideContact) -> bool {
        let Some(obstacle) = self.obstacle(contact) else { return false };
        let [quasi_static, inertial, engine] = self.rows;
        if !self.is_pushed(inertial, contact) || !self.is_pushed(quasi_static, contact) {
            return false;
        }
        if self.touches(engine, contact, |_| true) && !self.is_at_corners(contact, obstacle) {
            return false;
        }
        let moved = [0, 1, 2].map(|run| self.moved_along(run, contact, obstacle));
        let ahead = -self.lead(contact).dot(&contact.force) / contact.force.norm();
        moved[0].max(moved[1]) <= HELD * moved[2] && ahead > 0.0 && self.depth_of_engine(contact, obstacle) <= THROUGH * ahead
    }

    /// Whether an obstacle pushes the load of a row where it pushes at `contact` at this instant.
    fn is_pushed(&self, row: &Row, contact: &SideContact) -> bool {
        self.touches(row, contact, |force| force.norm() > 0.0)
    }

    /// Whether the load of a row touches the obstacle of `contact` at the same place, with a force
    /// that counts. Places are compared in the frame of the obstacle, which may move.
    fn touches(&self, row: &Row, contact: &SideContact, counts: impl Fn(&Vec2) -> bool) -> bool {
        let Some(obstacle) = self.obstacle(contact) else { return false };
        let place = self.rows[1].pose_of(contact.obstacle, obstacle).to_local(&contact.point);
        let reach = SAME_PLACE * self.scenario.system.load.radius;
        let is_there = |other: &SideContact| (row.pose_of(other.obstacle, obstacle).to_local(&other.point) - place).norm() <= reach;
        row.contacts.iter().any(|other| other.obstacle == contact.obstacle && counts(&other.force) && is_there(other))
    }

    /// Whether the inertial load touches a corner of the obstacle with a corner of its own.
    fn is_at_corners(&self, contact: &SideContact, obstacle: &Obstacle) -> bool {
        let (load, reach) = (&self.scenario.system.world.outline, AT_CORNER * self.scenario.system.load.radius);
        let [in_load, in_obstacle] =
            [self.rows[1].motion.pose, self.rows[1].pose_of(contact.obstacle, obstacle)].map(|pose| pose.to_local(&contact.point));
        let is_corner = |outline: &Outline, point: Vec2| outline.corners().any(|corner| (corner - point).norm() <= reach);
        is_corner(load, in_load) && is_corner(&obstacle.outline, in_obstacle)
    }

    /// Point of the load of a run that is held on the inertial one (m, world), at this instant and
    /// before it.
    fn held_point(&self, run: usize, contact: &SideContact) -> [Vec2; 2] {
        let point_in_load = self.rows[1].motion.pose.to_local(&contact.point);
        [self.rows[run], self.before[run]].map(|row| row.motion.pose.to_world(&point_in_load))
    }

    /// Displacement of that point along the obstacle since the row before (m).
    fn moved_along(&self, run: usize, contact: &SideContact, obstacle: &Obstacle) -> f64 {
        let [now, before] = self.held_point(run, contact);
        let local = |point: &Vec2, row: &Row| row.pose_of(contact.obstacle, obstacle).to_local(point);
        (local(&now, self.rows[run]) - local(&before, self.before[run])).norm()
    }

    /// Displacement of that point of the engine's load from that of the inertial one (m).
    fn lead(&self, contact: &SideContact) -> Vec2 {
        self.held_point(2, contact)[0] - self.held_point(1, contact)[0]
    }

    /// Depth of the engine's load inside the obstacle (m).
    fn depth_of_engine(&self, contact: &SideContact, obstacle: &Obstacle) -> f64 {
        let at = self.rows[2].pose_of(contact.obstacle, obstacle);
        let world = &self.scenario.system.world;
        overlap_depth(&world.outline, &self.rows[2].motion.pose, &obstacle.outline, &at).unwrap_or(0.0)
    }
}
