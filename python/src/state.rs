//! A load on a backend, with its time, and its state as numbers.
//!
//! ```text
//! 0       time (s)
//! 1 to 3  x, y (m, world) and heading (rad) of the load
//! 4 to 6  velocity (m/s, world) and turn rate (rad/s)
//! then    for each spring: 1 if it is attached, else 0; x and y of its tip (m, world)
//! then    for each obstacle: 1 if it was steered, else 0; x, y (m, world) and heading (rad)
//! ```

use cohaul::backend::{Backend, BackendOptions, Motion, Status, StepReport, build};
use cohaul::math::{Pose, Twist, Vec2};
use cohaul::model::geometry::overlap_depth;
use cohaul::model::{ObstaclePath, ObstaclePose};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Hand, HandError};

use crate::points::LARGEST;
use crate::seen::{Pushes, Seen, obstacle_poses};

/// Depth inside an obstacle over the load's radius up to which it is rounding (1).
const ROUNDING: f64 = 1e-6;

pub struct State {
    pub backend: Box<dyn Backend + Send>,
    pub time: f64,
    pub totals: StepReport,
    /// Attached tips (m, world).
    pub tips: Vec<Option<Vec2>>,
    /// Whether each obstacle was steered, and no longer follows its path.
    pub is_steered: Vec<bool>,
    /// Kept for their memory.
    pub targets: Vec<Vec2>,
    pub is_broken: bool,
    has_inertia: bool,
}

/// Length of the state of a load as numbers (1).
pub fn n_numbers(scenario: &Scenario) -> usize {
    7 + 3 * scenario.system.springs.len() + 4 * scenario.system.world.obstacles.len()
}

impl State {
    pub fn new(scenario: &Scenario, options: &BackendOptions) -> Self {
        Self::starting(scenario, options, scenario.start)
    }

    fn starting(scenario: &Scenario, options: &BackendOptions, start: Motion) -> Self {
        let n_springs = scenario.system.springs.len();
        Self {
            backend: build(&scenario.system, start, options),
            time: 0.0,
            totals: StepReport::default(),
            tips: vec![None; n_springs],
            is_steered: vec![false; scenario.system.world.obstacles.len()],
            targets: Vec::with_capacity(n_springs),
            is_broken: false,
            has_inertia: options.kind.has_inertia(),
        }
    }

    pub fn attach(&mut self, spring: usize, tip: Vec2) {
        self.backend.attach(spring, tip);
        self.tips[spring] = Some(tip);
    }

    pub fn release(&mut self, spring: usize) {
        self.backend.release(spring);
        self.tips[spring] = None;
    }

    pub fn seen(&self, scenario: &Scenario) -> Seen {
        Seen::of(&scenario.system, self.backend.as_ref(), self.time)
    }

    fn obstacle_poses(&self, scenario: &Scenario) -> Vec<Pose> {
        obstacle_poses(&scenario.system, self.backend.as_ref(), self.time)
    }

    /// Moves the tips to `targets`, these obstacles to their poses, and what a hand holds, and adds
    /// to the totals. It stops at each instant at which an obstacle turns.
    ///
    /// # Errors
    /// When the hand cannot push. The load may then be anywhere within the time.
    pub fn advance(&mut self, scenario: &Scenario, pushes: &Pushes, duration: f64) -> Result<Status, HandError> {
        for ObstaclePose { obstacle, pose } in &pushes.poses {
            self.is_steered[*obstacle] |= self.backend.steer(*obstacle, &[(duration, *pose)]);
        }
        let hand = pushes.hand.as_ref();
        hand.iter().for_each(|hand| self.is_steered[hand.obstacle] = true);
        let (from, to) = (self.time, self.time + duration);
        let (mut corner, mut status) = (scenario.system.world.next_corner(from), Status::Converged);
        if corner < to {
            let start: Vec<Vec2> = self.tips.iter().map(|tip| tip.unwrap_or_default()).collect();
            let end = std::mem::take(&mut self.targets);
            while corner < to {
                let share = (corner - from) / duration;
                self.targets.clear();
                self.targets.extend(start.iter().zip(&end).map(|(start, end)| start + share * (end - start)));
                status = status.max(self.advance_to(scenario, hand, corner)?);
                corner = scenario.system.world.next_corner(corner);
            }
            self.targets = end;
        }
        status = status.max(self.advance_to(scenario, hand, to)?);
        for (tip, target) in self.tips.iter_mut().zip(&self.targets) {
            if tip.is_some() {
                *tip = Some(*target);
            }
        }
        Ok(status)
    }

    fn advance_to(&mut self, scenario: &Scenario, hand: Option<&Hand>, to: f64) -> Result<Status, HandError> {
        let report = match hand {
            Some(hand) => hand.advance(self.backend.as_mut(), &scenario.system.world, [self.time, to], &self.targets, self.has_inertia)?,
            None => self.backend.advance(&self.targets, to - self.time),
        };
        self.time = to;
        self.totals.add(&report);
        Ok(report.status)
    }

    /// The state as numbers.
    pub fn numbers(&self, scenario: &Scenario) -> Vec<f64> {
        let mut numbers = vec![self.time];
        numbers.extend(self.backend.motion().entries());
        for tip in &self.tips {
            let place = tip.unwrap_or_default();
            numbers.extend([f64::from(u8::from(tip.is_some())), place.x, place.y]);
        }
        for (is_steered, pose) in self.is_steered.iter().zip(self.obstacle_poses(scenario)) {
            numbers.extend([f64::from(u8::from(*is_steered)), pose.position.x, pose.position.y, pose.heading]);
        }
        numbers
    }

    /// A load in the state of these numbers, which errors call `path`. Its energy ledger begins
    /// anew.
    ///
    /// # Errors
    /// When the numbers are those of no state, or the load lies inside an obstacle.
    pub fn of_numbers(scenario: &Scenario, options: &BackendOptions, path: &str, numbers: &[f64]) -> Result<Self, String> {
        if let Some((at, number)) = numbers.iter().enumerate().find(|(_, number)| number.is_nan() || number.abs() > LARGEST) {
            return Err(format!("{path}[{at}]: must be finite and at most {LARGEST:e} in size, found {number}"));
        }
        Self::of_finite(scenario, options, numbers).map_err(|what| format!("{path}: {what}"))
    }

    fn of_finite(scenario: &Scenario, options: &BackendOptions, numbers: &[f64]) -> Result<Self, String> {
        let n = n_numbers(scenario);
        if numbers.len() != n {
            return Err(format!("must have {n} numbers, found {}", numbers.len()));
        }
        let time = numbers[0];
        if time < 0.0 {
            return Err(format!("must have a time that is not negative, found {time} s"));
        }
        let start =
            Motion { pose: pose_of(&numbers[1..4]), twist: Twist { linear: Vec2::new(numbers[4], numbers[5]), angular: numbers[6] } };
        let (of_springs, of_obstacles) = numbers[7..].split_at(3 * scenario.system.springs.len());
        let mut state = Self::starting(scenario, options, start);
        state.time = time;
        for (obstacle, entry) in of_obstacles.chunks_exact(4).enumerate() {
            let path = &scenario.system.world.obstacles[obstacle].path;
            state.is_steered[obstacle] = is_yes(entry[0])?;
            let course = if state.is_steered[obstacle] { vec![(0.0, pose_of(&entry[1..]))] } else { rest_of(path, time) };
            if state.is_steered[obstacle] || path.moves() {
                state.backend.steer(obstacle, &course);
            }
        }
        state.check_outside(scenario, &start.pose)?;
        for (spring, entry) in of_springs.chunks_exact(3).enumerate() {
            if is_yes(entry[0])? {
                state.attach(spring, Vec2::new(entry[1], entry[2]));
            }
        }
        Ok(state)
    }

    fn check_outside(&self, scenario: &Scenario, pose: &Pose) -> Result<(), String> {
        let system = &scenario.system;
        for (obstacle, at) in system.world.obstacles.iter().zip(self.obstacle_poses(scenario)) {
            let depth = overlap_depth(&system.world.outline, pose, &obstacle.outline, &at).unwrap_or(0.0);
            if depth > ROUNDING * system.load.radius {
                return Err(format!("must have the load outside of the obstacle {:?}, found it {depth:.3e} m inside", obstacle.name));
            }
        }
        Ok(())
    }
}

fn pose_of(entries: &[f64]) -> Pose {
    Pose::new(entries[0], entries[1], entries[2])
}

fn is_yes(entry: f64) -> Result<bool, String> {
    if entry == 0.0 || entry == 1.0 { Ok(entry == 1.0) } else { Err(format!("must say 0 or 1 of springs and obstacles, found {entry}")) }
}

/// What is left of a path at `time` (s), with times from then on.
fn rest_of(path: &ObstaclePath, time: f64) -> Vec<(f64, Pose)> {
    let later = path.waypoints.iter().filter(|(at, _)| *at > time).map(|(at, pose)| (at - time, *pose));
    [(0.0, path.pose_at(time))].into_iter().chain(later).collect()
}
