//! An ant as a point that walks (Eq. 17) and steers (Eq. 20).

use serde::{Deserialize, Serialize};

use crate::math::{Arc, Mat2, Number, Vec2, direction, perpendicular};

/// What an ant is doing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "mode")]
pub enum Mode {
    /// Walks towards where it believes the load to be, and grasps the tip of a free spring in reach.
    Search,
    /// Holds the tip of one spring and walks backwards with it.
    Transport { spring: usize, grasp_tick: u64 },
}

/// An ant between two ticks. Its position (m, world) is that of its mandibles: the tip it holds, while it holds one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ant {
    pub position: Vec2,
    /// Direction it faces (rad, world). It pulls towards heading + pi.
    pub heading: f64,
    /// The same as a unit vector, which turns with the heading: a rotation by what an ant turns in a tick takes far less than the sine of where it faces.
    pub ahead: Vec2,
    pub mode: Mode,
    /// Offset of the believed from the true position of the load (m), redrawn now and then.
    pub belief_error: Vec2,
}

impl Ant {
    /// A searching ant that believes the load to be where it is.
    pub fn new(position: Vec2, heading: f64) -> Self {
        Self { position, heading, ahead: direction(heading), mode: Mode::Search, belief_error: Vec2::zeros() }
    }

    /// Walks a `way` (m) and a `turn` (rad), both at constant speed: an arc, Eq. (17).
    pub fn walk(&mut self, way: f64, turn: f64) {
        let arc = Arc::of(turn);
        let axes = Mat2::from_columns(&[self.ahead, perpendicular(&self.ahead)]);
        self.position += axes * arc.shift(&Vec2::new(way, 0.0));
        self.turn(&arc);
    }

    /// Turns on the spot along `arc`.
    pub fn turn(&mut self, arc: &Arc) {
        let ahead = arc.rotation() * self.ahead;
        // Back to length one, from which rounding alone has taken it.
        self.ahead = (1.5 - 0.5 * ahead.norm_squared()) * ahead;
        self.heading += arc.angle();
    }
}

/// How ants steer, Eq. (20): at gain (1/s) times heading error (rad), as its mean over a duration (s) while the desired heading stands still. The error then decays as
/// exp(-gain t), and no choice of control period makes it overshoot. The exponential is the same for all ants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steering {
    /// (s)
    duration: f64,
    /// Share of the error that is steered out (1).
    share: f64,
}

impl Steering {
    /// For a gain (1/s) and a duration (s).
    pub fn new(gain: f64, duration: f64) -> Self {
        Self { duration, share: -(-gain * duration).exp_m1() }
    }

    /// (s)
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Turn within the duration for a heading error (rad), or for several side by side.
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
        reached.walk(velocity * duration, turn_rate * duration);
        // Radius 0.04 m: rounding only.
        assert!((reached.position - Vec2::new(0.04, 0.04)).norm() < 1e-16);
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

    /// Through a million ticks: the heading, some hundred radians at last, loses up to 3e-14 in each, a random walk of 3e-11.
    #[test]
    fn an_ant_goes_on_facing_where_it_heads() {
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
