//! Ants that pull, computed side by side.

use super::ant::{Ant, Steering};
use super::behaviour::{HalfAngle, facing_for_pull, turns_towards};
use crate::math::{Arc, LANES, Mat2, Numbers, SERIES_BELOW, Vec2, Vectors, small_rotation};

/// Quantities that all ants of one load share during a tick.
#[derive(Clone, Copy, Debug)]
pub struct Haul {
    /// Origin of the load (m, world), and the rotation of its axes to those of the world.
    pub load: (Vec2, Mat2),
    /// Position of the nest (m, world).
    pub nest: Vec2,
    /// Largest angle between a pull and its spring.
    pub half_angle: HalfAngle,
    /// Steering of the ants.
    pub steering: Steering,
    /// Walking speed of a pulling ant (m/s).
    pub speed: f64,
}

/// State of ants after a tick.
#[derive(Clone, Copy, Debug)]
pub struct Pulled {
    /// Positions of their tips (m, world).
    pub tip: Vectors,
    /// Angles by which they turned (rad).
    pub turn: Numbers,
    /// Unit vectors along which they face.
    pub ahead: Vectors,
}

impl Haul {
    /// State after the tick of ants that pull at springs with these roots (m, load axes), Eq.
    /// (21-23). Each ant drags its tip backwards while it turns to the direction in which it wants
    /// to pull. Eq. (23) has no offset: the ant turns about its mandibles.
    #[inline]
    pub fn pulled(&self, ants: [&Ant; LANES], roots: [&Vec2; LANES]) -> Pulled {
        let position = Vectors::new(ants.map(|ant| ant.position));
        let ahead = Vectors::new(ants.map(|ant| ant.ahead));
        let (origin, turn) = &self.load;
        let root =
            Vectors::new(roots.map(|root| *root)).turned(Numbers::splat(turn.m11), Numbers::splat(turn.m21)).and(Vectors::splat(*origin));
        let to_nest = Vectors::splat(self.nest).less(position);
        let desired = facing_for_pull(self.half_angle.pull_directions(position.less(root), to_nest));
        let turn = self.steering.turn(turns_towards(desired, ahead));
        let along = ahead.times(Numbers::splat(-self.speed * self.steering.duration()));
        Pulled { tip: position.and(along), turn, ahead: turned(ahead, turn) }
    }
}

/// Unit vectors turned by angles (rad) as in [`Ant::turn`].
fn turned(ahead: Vectors, turns: Numbers) -> Vectors {
    let (cos, sin) = if turns.abs().simd_lt(Numbers::splat(SERIES_BELOW)).all() {
        small_rotation(turns)
    } else {
        let rotations = turns.to_array().map(|turn| Arc::of(turn).rotation());
        (Numbers::new(rotations.map(|turn| turn.m11)), Numbers::new(rotations.map(|turn| turn.m21)))
    };
    let ahead = ahead.turned(cos, sin);
    ahead.times(Numbers::splat(1.5) - Numbers::splat(0.5) * ahead.dot(ahead))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{RandomStreams, Stream, direction, rotation, wrap_to_pi};

    /// The ants one by one with angles, for small turns and large ones, alike and unlike.
    #[test]
    fn ants_side_by_side_pull_as_each_would_alone() {
        let mut largest_turn: f64 = 0.0;
        for case in 0..800 {
            let streams = RandomStreams::new(case);
            let draw = |ant: usize, k: u64| 2.0 * streams.uniform(Stream::Start, ant as u32, k) - 1.0;
            let haul = Haul {
                load: (Vec2::new(0.1, -0.2), rotation(2.0 * draw(9, 0))),
                nest: Vec2::new(0.2, -0.17),
                half_angle: HalfAngle::new(0.6),
                steering: Steering::new(8.0, if case % 7 == 0 { 0.3 } else { 0.0025 }),
                speed: 0.05,
            };
            let apart = if case % 2 == 0 { 3.0 } else { 0.05 };
            let roots: [Vec2; LANES] = std::array::from_fn(|ant| 0.0122 * direction(3.0 * draw(ant, 1)));
            let ants: [Ant; LANES] = std::array::from_fn(|ant| {
                let at = haul.load.0 + haul.load.1 * (3.0 * roots[ant]) + 0.002 * Vec2::new(draw(ant, 2), draw(ant, 3));
                let towards = by_angles(&haul, &at, &roots[ant]);
                Ant::new(at, towards + apart * draw(ant, 4))
            });
            let pulled = haul.pulled(ants.each_ref(), roots.each_ref());
            for (k, (ant, root)) in ants.iter().zip(&roots).enumerate() {
                let error = wrap_to_pi(by_angles(&haul, &ant.position, root) - ant.heading);
                let turn = haul.steering.turn(error);
                let moved = -haul.speed * haul.steering.duration() * ant.ahead;
                let mut alone = *ant;
                alone.turn(&Arc::of(turn));
                largest_turn = largest_turn.max(turn.abs());
                // Rounding of angles of order one, and of places of order 0.1 m.
                let heading = ant.heading + pulled.turn.as_array()[k];
                assert!((heading - alone.heading).abs() < 4e-15 && (pulled.ahead.lane(k) - alone.ahead).norm() < 4e-15, "{case}");
                assert!((pulled.tip.lane(k) - ant.position - moved).norm() < 1e-16, "{case}");
            }
        }
        assert!(largest_turn > 1.0, "{largest_turn}: beyond the series too");
    }

    /// Eq. (22): the heading for the pull of an ant at this place.
    fn by_angles(haul: &Haul, at: &Vec2, root: &Vec2) -> f64 {
        let along = at - (haul.load.0 + haul.load.1 * root);
        let to_nest = haul.nest - at;
        let spring = along.y.atan2(along.x);
        spring + wrap_to_pi(to_nest.y.atan2(to_nest.x) - spring).clamp(-0.6, 0.6) + std::f64::consts::PI
    }
}
