//! Outlines, obstacles and contacts of a replay.

use serde::Serialize;

use crate::page::packed::Packed;
use cohaul::math::Vec2;
use cohaul::model::{Outline, OutlinePart, World};
use cohaul::simulation::{Row, Trace};

/// Part of an outline, as the script reads it (m).
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Shape {
    /// x and y of the centre, and radius.
    Disc([f64; 3]),
    Polygon(Vec<[f64; 2]>),
    Polyline(Vec<[f64; 2]>),
}

/// An obstacle, as the script reads it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct ShownObstacle {
    name: String,
    outline: Vec<Shape>,
    /// Time, x, y and heading, straight between; one entry for an obstacle that stands still.
    path: Vec<[f64; 4]>,
}

/// Parts of an outline in the frame of its body.
pub(super) fn shapes(outline: &Outline) -> Vec<Shape> {
    let points = |points: &[Vec2]| points.iter().map(|point| [point.x, point.y]).collect();
    let shape = |part: &OutlinePart| match part {
        OutlinePart::Disc { centre, radius } => Shape::Disc([centre.x, centre.y, *radius]),
        OutlinePart::Polygon { corners } => Shape::Polygon(points(corners)),
        OutlinePart::Polyline { points: ends } => Shape::Polyline(points(ends)),
    };
    outline.parts.iter().map(shape).collect()
}

/// Waypoints that are drawn of an obstacle at most (1).
const MOST_WAYPOINTS: usize = 3000;

/// The obstacles of a world. Those that were steered are drawn where they are in the `first` run.
pub(super) fn obstacles(world: &World, first: Option<&Trace>) -> Vec<ShownObstacle> {
    let shown = |obstacle: &cohaul::model::Obstacle| {
        let waypoints = &obstacle.path.waypoints;
        let (every, last) = (waypoints.len().div_ceil(MOST_WAYPOINTS).max(1), waypoints.len() - 1);
        let drawn = waypoints.iter().enumerate().filter(|(at, _)| at % every == 0 || *at == last).map(|(_, waypoint)| waypoint);
        ShownObstacle {
            name: obstacle.name.clone(),
            outline: shapes(&obstacle.outline),
            path: drawn.map(|(time, pose)| [*time, pose.position.x, pose.position.y, pose.heading]).collect(),
        }
    };
    let world = first.map_or_else(|| world.clone(), |trace| trace.world(world));
    world.obstacles.iter().map(shown).collect()
}

/// Contacts that are drawn at most at one instant (1).
const MOST_CONTACTS: usize = 12;

/// Contacts that are drawn: an obstacle and the number of the contact with it. A contact keeps its
/// place among them, so that it can be followed from row to row.
pub(super) struct ContactSlots(Vec<(usize, usize)>);

impl ContactSlots {
    pub fn of<'a>(traces: impl Iterator<Item = &'a Trace>) -> Self {
        let mut slots: Vec<(usize, usize)> = Vec::new();
        for row in traces.flat_map(|trace| &trace.rows) {
            let new = numbered(row).map(|(slot, _)| slot).filter(|slot| !slots.contains(slot)).collect::<Vec<_>>();
            slots.extend(new);
        }
        slots.sort_unstable();
        slots.truncate(MOST_CONTACTS);
        Self(slots)
    }

    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// x, y, and force along x and y of each contact over these rows.
    pub fn series(&self, rows: &[&Row]) -> Vec<[Packed; 4]> {
        let of_slot = |slot: &(usize, usize)| {
            let mut series: [Vec<Option<f64>>; 4] = Default::default();
            for row in rows {
                let contact = numbered(row).find(|(number, _)| number == slot).map(|(_, contact)| contact);
                let values = contact.map(|contact| [contact.point.x, contact.point.y, contact.force.x, contact.force.y]);
                series.iter_mut().enumerate().for_each(|(at, series)| series.push(values.map(|values| values[at])));
            }
            series.each_ref().map(|values| Packed::short(values))
        };
        self.0.iter().map(of_slot).collect()
    }
}

/// Contacts of a row with their obstacle and their number among those with it.
fn numbered(row: &Row) -> impl Iterator<Item = ((usize, usize), &cohaul::backend::SideContact)> {
    let number = |at: usize| row.contacts[..at].iter().filter(|other| other.obstacle == row.contacts[at].obstacle).count();
    row.contacts.iter().enumerate().map(move |(at, contact)| ((contact.obstacle, number(at)), contact))
}
