//! An ant as a point that walks (Eq. 17) and steers (Eq. 19).

use serde::{Deserialize, Serialize};

use crate::math::{Arc, Mat2, Number, Vec2, direction, perpendicular};

/// What an ant is doing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "mode")]
pub enum Mode {
    /// The ant walks towards where it believes the load to be, and grasps the tip of a free spring
    /// in reach.
    Search,
    /// The ant is attached to the tip of one spring and walks backwards with it.
    Transport { spring: usize, grasp_tick: u64 },
}

/// An ant between two ticks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ant {
    /// Position of its mandibles (m, world): that of the tip, while the ant is attached to one.
    pub position: Vec2,
    /// Direction that the ant faces (rad, world). It pulls towards heading + pi.
    pub heading: f64,
    /// Heading as a unit vector. It is turned with the heading: the rotation by the small turn of a
    /// tick is far cheaper than the sine of the heading.
    pub ahead: Vec2,
    /// Current behaviour.
    pub mode: Mode,
    /// Offset of the believed from the true position of the load (m), redrawn now and then.
    pub belief_error: Vec2,
}

impl Ant {
    /// A searching ant that believes the load to be where the load is.
    pub fn new(position: Vec2, heading: f64) -> Self {
        Self { position, heading, ahead: direction(heading), mode: Mode::Search, belief_error: Vec2::zeros() }
    }

    /// Walks a `distance` (m) with a `turn` (rad), both at constant rate, about a point that lies
    /// the offset (m) behind its position: the exact solution of Eq. (17) with the inputs of Eq.
    /// (20). The point behind walks an arc, and the position is the offset ahead of it.
    pub fn walk(&mut self, distance: f64, turn: f64, control_offset: f64) {
        let arc = Arc::of(turn);
        let before = self.ahead;
        let axes = Mat2::from_columns(&[before, perpendicular(&before)]);
        self.position += axes * arc.shift(&Vec2::new(distance, 0.0));
        self.turn(&arc);
        if control_offset > 0.0 {
            self.position += control_offset * (self.ahead - before);
        }
    }

    /// Turns on the spot along `arc`.
    pub fn turn(&mut self, arc: &Arc) {
        let ahead = arc.rotation() * self.ahead;
        // Rounding has changed the length from one.
        self.ahead = (1.5 - 0.5 * ahead.norm_squared()) * ahead;
        self.heading += arc.angle();
    }
}

/// Steering of the ants, Eq. (19): the turn rate is gain (1/s) times heading error (rad). Over a
/// tick it is the mean of that law for a constant desired heading: the error decays as exp(-gain
/// t), and no choice of control period makes it overshoot. The exponential is the same for all
/// ants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steering {
    /// Duration of a tick (s).
    duration: f64,
    /// Fraction of the error that is removed in a tick (1).
    share: f64,
}

impl Steering {
    /// Steering with this gain (1/s) over ticks of this duration (s).
    pub fn new(gain: f64, duration: f64) -> Self {
        Self { duration, share: -(-gain * duration).exp_m1() }
    }

    /// Duration of a tick (s).
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Turn within a tick for a heading error (rad), or for several errors side by side.
    pub fn turn<T: Number>(&self, heading_error: T) -> T {
        heading_error * T::from(self.share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn start() -> Ant {
        Ant::new(Vec2::zeros(), 0.0)
    }

    #[test]
    fn a_quarter_circle_has_the_radius_velocity_over_turn_rate() {
        let (velocity, turn_rate, duration) = (0.08, 2.0, std::f64::consts::FRAC_PI_4);
        let mut reached = start();
        reached.walk(velocity * duration, turn_rate * duration, 0.0);
        // Radius 0.04 m: rounding only.
        assert!((reached.position - Vec2::new(0.04, 0.04)).norm() < 1e-16);
    }

    /// Eq. (20) in small explicit steps: v (cos, sin) + r omega (-sin, cos). Heun's rule with 1e5
    /// steps errs by less than 1e-11 m on a path of 5 cm.
    #[test]
    fn a_searching_ant_follows_eq_20_with_its_offset() {
        let (speed, turn_rate, offset, duration) = (0.08, 3.0, 2e-3, 0.6);
        let velocity = |heading: f64| speed * direction(heading) + offset * turn_rate * perpendicular(&direction(heading));
        let n = 100_000;
        let step = duration / f64::from(n);
        let at = |k: i32| 0.4 + turn_rate * step * f64::from(k);
        let expected = (0..n).fold(Vec2::new(0.1, 0.2), |sum, k| sum + 0.5 * step * (velocity(at(k)) + velocity(at(k + 1))));
        let walked = |offset: f64| {
            let mut ant = Ant::new(Vec2::new(0.1, 0.2), 0.4);
            (0..240).for_each(|_| ant.walk(speed * duration / 240.0, turn_rate * duration / 240.0, offset));
            ant.position
        };
        assert!((walked(offset) - expected).norm() < 1e-11, "{} {expected}", walked(offset));
        // After a turn of 1.8 rad the offset matters by 2 r sin 0.9.
        let apart = (walked(offset) - walked(0.0)).norm();
        assert!((apart - 2.0 * offset * 0.9f64.sin()).abs() < 1e-11, "{apart}");
    }

    #[test]
    fn steering_does_not_depend_on_the_control_period() {
        let error_after = |n: u32| {
            let steering = Steering::new(8.0, 0.1 / f64::from(n));
            (0..n).fold(1.0, |error, _| error - steering.turn(error))
        };
        for n in [1, 7, 100] {
            assert!((error_after(n) - (-0.8f64).exp()).abs() < 1e-14);
        }
    }

    /// Over a million ticks the heading, some hundred radians in the end, loses up to 3e-14 in
    /// each: a random walk of 3e-11.
    #[test]
    fn the_unit_vector_follows_the_heading() {
        let mut ant = Ant::new(Vec2::zeros(), 0.3);
        let mut farthest: f64 = 0.0;
        for tick in 0..1_000_000 {
            let turn = 2e-3 * (1e-3 * f64::from(tick)).sin() + if tick % 1000 == 0 { 0.4 } else { 0.0 };
            ant.turn(&Arc::of(turn));
            farthest = farthest.max((ant.ahead - direction(ant.heading)).norm());
        }
        assert!(ant.heading > 300.0 && farthest < 1e-10, "{farthest}");
        assert!((ant.ahead.norm() - 1.0).abs() <= 2.0 * f64::EPSILON);
    }
}
