//! A mass on a spring and a dashpot with Coulomb friction, in one direction.
//!
//! ```text
//! m x'' = A + a t - k x - c x' - f sign(x')        |A + a t - k x| <= f holds it at rest
//! ```
//!
//! Between stops and starts the equation is linear and its solution known, so that the length of a
//! step causes no error.

use crate::math::damped_rotation;

/// Parameters of the oscillator, which are constant within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionOscillator {
    /// (kg)
    pub mass: f64,
    /// (N s/m)
    pub damping: f64,
    /// (N/m)
    pub stiffness: f64,
    /// (N)
    pub friction: f64,
}

/// Motion of the oscillator in one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slide {
    /// Displacement from the start of the step (m).
    pub shift: f64,
    /// Path length (m).
    pub length: f64,
    /// Speed at the end (m/s).
    pub speed: f64,
}

/// Longest time between two checks of the sign of the speed (rad of the oscillation).
const PIECE: f64 = 0.5;
/// Largest number of such checks in a step (1); pieces become longer beyond it.
const MOST_PIECES: f64 = 64.0;
/// Largest number of stops and starts in a step (1); beyond it the oscillator rests.
const MOST_TURNS: u32 = 200;

impl FrictionOscillator {
    /// A step of `duration` (s) from the given speed (m/s). The `force` (N) on a fixed mass grows
    /// by `rate` (N/s).
    pub fn step(&self, speed: f64, force: f64, rate: f64, duration: f64) -> Slide {
        let piece = (PIECE / self.frequency()).max(duration / MOST_PIECES);
        let (mut slide, mut time) = (Slide { speed, ..Slide::default() }, 0.0);
        for _ in 0..MOST_TURNS {
            let left = duration - time;
            if left <= 1e-12 * duration {
                break;
            }
            let mut net = force + rate * time - self.stiffness * slide.shift;
            let mut sign = slide.speed.signum();
            if slide.speed == 0.0 {
                let wait = self.wait(net, rate);
                if wait >= left {
                    break;
                }
                time += wait;
                net += rate * wait;
                sign = if net.abs() > self.friction { net.signum() } else { rate.signum() };
            }
            let (length, net) = (piece.min(duration - time), net - sign * self.friction);
            let flow = |time: f64| self.flow(slide.speed, net, rate, time);
            let (shift, speed) = flow(length);
            let (taken, shift, speed) = if speed * sign > 0.0 {
                (length, shift, speed)
            } else {
                let thrust = |time: f64, shift: f64| sign * (net + rate * time - self.stiffness * shift) / self.mass;
                stop(|time| (flow(time).0, sign * flow(time).1), thrust, length)
            };
            time += taken;
            slide = Slide { shift: slide.shift + shift, length: slide.length + shift.abs(), speed };
        }
        slide
    }

    /// Natural frequency (rad/s).
    pub fn frequency(&self) -> f64 {
        (self.stiffness.max(0.0) / self.mass).sqrt()
    }

    /// Time until a mass at rest under the force `net` (N), growing by `rate` (N/s), begins to move
    /// (s).
    fn wait(&self, net: f64, rate: f64) -> f64 {
        if net.abs() > self.friction {
            0.0
        } else if rate == 0.0 {
            f64::INFINITY
        } else {
            (self.friction - net * rate.signum()) / rate.abs()
        }
    }

    /// Shift (m) and speed (m/s) after `time` (s) without a stop; `net` (N) includes friction.
    fn flow(&self, speed: f64, net: f64, rate: f64, time: f64) -> (f64, f64) {
        let FrictionOscillator { mass, damping, stiffness, .. } = *self;
        if stiffness == 0.0 {
            let shift = time * (speed + time / mass * (0.5 * net + time * rate / 6.0));
            return (shift, speed + time / mass * (net + 0.5 * time * rate));
        }
        let follow = rate / stiffness;
        let centre = (net - damping * follow) / stiffness;
        let decay = 0.5 * damping / mass;
        let (cos, sin) = damped_rotation(decay, stiffness / mass, time);
        let (away, drift) = (-centre, speed - follow);
        let shift = away * (cos + decay * sin) + drift * sin;
        let speed = drift * (cos - decay * sin) - stiffness / mass * away * sin;
        (centre + follow * time + shift, follow + speed)
    }
}

/// Time of the stop within `length` (s), the shift there, and zero speed, by Newton's method within
/// a bracket. `flow` gives shift and speed at a time, with a positive speed at first. `thrust`
/// gives the acceleration there without a dashpot.
fn stop(flow: impl Fn(f64) -> (f64, f64), thrust: impl Fn(f64, f64) -> f64, length: f64) -> (f64, f64, f64) {
    let (mut moving, mut stopped, mut time) = (0.0, length, length);
    for _ in 0..60 {
        let (shift, speed) = flow(time);
        if speed > 0.0 {
            moving = time
        } else {
            stopped = time
        }
        let next = time - speed / thrust(time, shift);
        let is_between = next > moving && next < stopped;
        let next = if is_between { next } else { 0.5 * (moving + stopped) };
        let step = next - time;
        time = next;
        // The remaining error is of the order of its square.
        if step.abs() <= 1e-9 * length {
            break;
        }
    }
    (time, flow(time).0, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const OSCILLATOR: FrictionOscillator = FrictionOscillator { mass: 0.0016, damping: 0.0, stiffness: 0.664, friction: 0.022 };

    fn in_steps(oscillator: &FrictionOscillator, force: f64, rate: f64, n: u32, duration: f64) -> (f64, f64) {
        let step = duration / f64::from(n);
        let (mut shift, mut speed) = (0.0, 0.0);
        for i in 0..n {
            let slide = oscillator.step(speed, force + rate * step * f64::from(i) - oscillator.stiffness * shift, rate, step);
            (shift, speed) = (shift + slide.shift, slide.speed);
        }
        (shift, speed)
    }

    /// A spring pulled at v: rest until it carries the friction, then x = v t - (v / omega)
    /// sin(omega t).
    #[test]
    fn a_pulled_mass_starts_within_a_step_and_oscillates() {
        let (speed, omega) = (0.03, OSCILLATOR.frequency());
        let onset = OSCILLATOR.friction / OSCILLATOR.stiffness / speed;
        let after: f64 = 0.777;
        let expected = speed * after - speed / omega * (omega * after).sin();
        for n in [1, 7, 400] {
            let (shift, _) = in_steps(&OSCILLATOR, 0.0, OSCILLATOR.stiffness * speed, n, onset + after);
            // Rounding of sums of n steps of order one.
            assert!((shift - expected).abs() < 1e-12, "{n}: {shift} {expected}");
        }
    }

    /// Half-swings of 2 (F - (2 j + 1) f) / k until the spring force is below friction.
    #[test]
    fn a_released_mass_oscillates_until_friction_stops_it() {
        for (force, expected) in [(1.2, 0.4), (1.66, 1.32), (2.5, 3.0), (3.5, 4.0), (6.0, 6.0), (0.9, 0.0)] {
            let slide = OSCILLATOR.step(0.0, force * OSCILLATOR.friction, 0.0, 3.0);
            // Stops are found to rounding.
            assert!((slide.shift * OSCILLATOR.stiffness / OSCILLATOR.friction - expected).abs() < 1e-9, "{force}: {slide:?}");
            assert_eq!(slide.speed, 0.0);
        }
    }

    #[test]
    fn damping_shortens_the_first_swing_and_is_continuous_through_critical() {
        let critical = 2.0 * (OSCILLATOR.stiffness * OSCILLATOR.mass).sqrt();
        let first =
            |zeta: f64| FrictionOscillator { damping: zeta * critical, ..OSCILLATOR }.step(0.0, 2.0 * OSCILLATOR.friction, 0.0, 4.0).shift;
        let jump = OSCILLATOR.friction / OSCILLATOR.stiffness;
        let factor = 1.0 + (-std::f64::consts::PI * 0.3 / 0.91f64.sqrt()).exp();
        assert!((first(0.3) / jump - factor).abs() < 1e-9);
        // Continuous to first order in the difference.
        assert!((first(1.0 - 1e-7) - first(1.0 + 1e-7)).abs() < 1e-6 * jump);
        // The slow mode decays over 81 rad, which leaves 2e-5.
        assert!((first(2.0) / jump - 1.0).abs() < 1e-4);
    }

    /// Without a spring: v^2 / (2 mu g), and rest while the force is below friction.
    #[test]
    fn a_mass_without_spring_coasts() {
        let free = FrictionOscillator { stiffness: 0.0, ..OSCILLATOR };
        let slide = free.step(0.2, 0.0, 0.0, 1.0);
        assert!((slide.shift - 0.2 * 0.2 * free.mass / (2.0 * free.friction)).abs() < 1e-15, "{slide:?}");
        assert_eq!(free.step(0.0, 0.99 * free.friction, 0.0, 1.0), Slide::default());
        let frictionless = FrictionOscillator { friction: 0.0, ..free };
        assert!((frictionless.step(0.1, 0.0, 0.0, 2.0).shift - 0.2).abs() < 1e-15);
    }
}
