//! Ants among obstacles: where they start, walk, pull and sense, by the rules of
//! [`crate::model::avoidance`].
//!
//! To a searching ant the load is one more barrier, unless the target lies within reach of it. An
//! ant that pulls is kept out of obstacles only, and its tip with it. The load hides no tips.

use crate::math::{Pose, Vec2};
use crate::model::ObstaclePath;
use crate::model::ant::{Ant, Steering};
use crate::model::avoidance::{Avoidance, Side, Walker};
use crate::model::behaviour::turn_towards;
use crate::model::geometry::{Among, Barrier, Barriers, PlacedBarrier};
use crate::scenario::{AntDrive, Scenario};

/// Most draws of a start (1): an ant that finds no free place in so many is pushed out of what it
/// overlaps.
const MOST_STARTS: u64 = 1000;

/// Obstacles and load as barriers to ants, at one instant.
pub struct Avoiding {
    avoidance: Avoidance,
    walker: Walker,
    /// Distance from the position of a searching ant to the point about which it turns (m).
    control_offset: f64,
    obstacles: Barriers,
    /// Paths of the obstacles that move, with their indices.
    paths: Vec<(usize, ObstaclePath)>,
    load: PlacedBarrier,
}

impl Avoiding {
    /// Barriers of a scenario at its start; `None` where ants avoid nothing.
    pub fn of(scenario: &Scenario, drive: &AntDrive) -> Option<Self> {
        if drive.avoidance == Avoidance::None {
            return None;
        }
        let world = &scenario.system.world;
        let placed = |path: &ObstaclePath, outline| PlacedBarrier::new(Barrier::of(outline), &path.pose_at(0.0));
        let moving = world.obstacles.iter().enumerate().filter(|(_, obstacle)| obstacle.path.moves());
        let paths: Vec<_> = moving.map(|(index, obstacle)| (index, obstacle.path.clone())).collect();
        let obstacles = world.obstacles.iter().map(|obstacle| placed(&obstacle.path, &obstacle.outline)).collect();
        Some(Self {
            avoidance: drive.avoidance,
            walker: Walker { radius: drive.body_radius, look_ahead: drive.look_ahead },
            control_offset: drive.control_offset,
            obstacles: Barriers::new(obstacles, paths.iter().map(|(index, _)| *index).collect(), drive.body_radius),
            paths,
            load: PlacedBarrier::new(Barrier::of(&world.outline), &scenario.start.pose),
        })
    }

    /// Moves the barriers to where they are at `time` (s).
    pub fn place(&mut self, load: &Pose, time: f64) {
        self.load.move_to(load);
        for (index, path) in &self.paths {
            self.obstacles.moving(*index).move_to(&path.pose_at(time));
        }
    }

    /// Obstacles, and the load.
    fn all(&self) -> Among<'_> {
        self.obstacles.with(Some(&self.load))
    }

    /// First of the drawn positions at which an ant overlaps nothing (m, world).
    pub fn start(&self, draw: impl Fn(u64) -> Vec2) -> Vec2 {
        let free = (0..MOST_STARTS).map(&draw).find(|at| self.walker.is_clear(self.all(), at));
        free.unwrap_or_else(|| self.walker.pushed_out(self.all(), &draw(0)).unwrap_or_else(|| draw(0)))
    }

    /// Whether an ant at `from` senses a tip: the straight way to it is free, and it can stand
    /// there.
    pub fn senses(&self, from: &Vec2, tip: &Vec2) -> bool {
        self.walker.is_way_free(self.obstacles.alone(), from, tip) && self.walker.is_clear(self.obstacles.alone(), tip)
    }

    /// Walks a searching ant a `distance` (m) towards a target (m, world).
    pub fn walk(
        &self,
        ant: &mut Ant,
        side: &mut Option<Side>,
        target: &Vec2,
        distance: f64,
        steering: &Steering,
        draw: impl FnOnce() -> Side,
    ) {
        let from = ant.position;
        let is_at_load = self.load.gap(target).is_some_and(|gap| gap.distance < self.walker.radius);
        let blocking = self.obstacles.with((!is_at_load).then_some(&self.load));
        let desired = self.walker.desired(blocking, &from, &ant.ahead, target, side, draw);
        ant.walk(distance, steering.turn(turn_towards(&desired, &ant.ahead)), self.control_offset);
        let stepped = self.walker.stepped(self.all(), &from, &ant.position, self.avoidance);
        // Between the load and an obstacle that leave no room, an ant stays out of the obstacle.
        ant.position = stepped.unwrap_or_else(|| self.dragged(&from, &ant.position));
    }

    /// Position (m, world) of an ant that drags its tip from one point to another, outside of the
    /// obstacles.
    pub fn dragged(&self, from: &Vec2, to: &Vec2) -> Vec2 {
        self.walker.stepped(self.obstacles.alone(), from, to, Avoidance::Sidestep).unwrap_or(*from)
    }
}
