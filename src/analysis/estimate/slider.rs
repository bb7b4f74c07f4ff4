//! A mass on a spring and a dashpot that slides with Coulomb friction in one direction, stepped exactly while its force grows evenly.
//!
//! ```text
//! m x'' = A + a t - k x - c x' - f sign(x')        |A + a t - k x| <= f holds it at rest
//! ```
//!
//! Between the instants at which it stops and starts the equation is linear with a known solution, so the length of a step is no source of error.

use crate::math::Arc;

/// What slides. Nothing here changes within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slider {
    /// (kg)
    pub mass: f64,
    /// (N s/m)
    pub damping: f64,
    /// (N/m)
    pub stiffness: f64,
    /// (N)
    pub friction: f64,
}

/// Where a slider is at the end of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slid {
    /// From where the step began (m).
    pub shift: f64,
    /// Length of the way there (m).
    pub way: f64,
    /// (m/s)
    pub speed: f64,
}

/// Longest piece between two looks at the sign of the speed, in radians of the oscillation.
const PIECE: f64 = 0.5;
/// A slider that oscillates faster than this many pieces a step is looked at more seldom.
const MOST_PIECES: f64 = 64.0;
/// Stops and starts within one step: beyond, it is left at rest.
const MOST_TURNS: u32 = 200;

impl Slider {
    /// A step of `duration` (s) with the speed at its start (m/s) under a `force` (N) that grows by `rate` (N/s) on a slider that stays where it is.
    pub fn slide(&self, speed: f64, force: f64, rate: f64, duration: f64) -> Slid {
        let piece = (PIECE / self.frequency()).max(duration / MOST_PIECES);
        let (mut slid, mut time) = (Slid { speed, ..Slid::default() }, 0.0);
        for _ in 0..MOST_TURNS {
            let left = duration - time;
            if left <= 1e-12 * duration {
                break;
            }
            let mut net = force + rate * time - self.stiffness * slid.shift;
            let mut sign = slid.speed.signum();
            if slid.speed == 0.0 {
                let wait = self.wait(net, rate);
                if wait >= left {
                    break;
                }
                time += wait;
                net += rate * wait;
                sign = if net.abs() > self.friction { net.signum() } else { rate.signum() };
            }
            let (length, net) = (piece.min(duration - time), net - sign * self.friction);
            let flow = |time: f64| self.flow(slid.speed, net, rate, time);
            let (shift, speed) = flow(length);
            let (taken, shift, speed) = if speed * sign > 0.0 {
                (length, shift, speed)
            } else {
                let thrust = |time: f64, shift: f64| sign * (net + rate * time - self.stiffness * shift) / self.mass;
                stop(|time| (flow(time).0, sign * flow(time).1), thrust, length)
            };
            time += taken;
            slid = Slid { shift: slid.shift + shift, way: slid.way + shift.abs(), speed };
        }
        slid
    }

    /// (rad/s)
    pub fn frequency(&self) -> f64 {
        (self.stiffness.max(0.0) / self.mass).sqrt()
    }

    /// Time until a slider at rest under the force `net` (N), growing by `rate` (N/s), begins to slide (s).
    fn wait(&self, net: f64, rate: f64) -> f64 {
        if net.abs() > self.friction {
            0.0
        } else if rate == 0.0 {
            f64::INFINITY
        } else {
            (self.friction - net * rate.signum()) / rate.abs()
        }
    }

    /// Shift (m) and speed (m/s) after `time` (s) from rest or with `speed`, friction counted in `net` (N).
    fn flow(&self, speed: f64, net: f64, rate: f64, time: f64) -> (f64, f64) {
        let Slider { mass, damping, stiffness, .. } = *self;
        if stiffness == 0.0 {
            let shift = time * (speed + time / mass * (0.5 * net + time * rate / 6.0));
            return (shift, speed + time / mass * (net + 0.5 * time * rate));
        }
        let follow = rate / stiffness;
        let centre = (net - damping * follow) / stiffness;
        let decay = 0.5 * damping / mass;
        let (cos, sin) = oscillation(decay, stiffness / mass - decay * decay, time);
        let (away, drift) = (-centre, speed - follow);
        let shift = away * (cos + decay * sin) + drift * sin;
        let speed = drift * (cos - decay * sin) - stiffness / mass * away * sin;
        (centre + follow * time + shift, follow + speed)
    }
}

/// `exp(-a t) cos(b t)` and `exp(-a t) sin(b t) / b` with `b^2` of either sign.
fn oscillation(decay: f64, square: f64, time: f64) -> (f64, f64) {
    let rate = square.abs().sqrt();
    let fade = || if decay == 0.0 { 1.0 } else { (-decay * time).exp() };
    if rate * time < 1e-6 {
        let fade = fade();
        return (fade, fade * time);
    }
    if square > 0.0 {
        // Small angles are mostly asked for, and have short series.
        let (turn, fade) = (Arc::of(rate * time).rotation(), fade());
        return (fade * turn.m11, fade * turn.m21 / rate);
    }
    let (slow, fast) = (((rate - decay) * time).exp(), (-(rate + decay) * time).exp());
    (0.5 * (slow + fast), 0.5 * (slow - fast) / rate)
}

/// The instant within `length` (s) at which a speed ends, the shift there, and no speed: by Newton's method between an instant before and one after. `flow`
/// gives shift and speed at an instant, the latter positive at first, and `thrust` what the speed would grow by there without a dashpot, over time.
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
        // What is left is of the order of its square.
        if step.abs() <= 1e-9 * length {
            break;
        }
    }
    (time, flow(time).0, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SLIDER: Slider = Slider { mass: 0.0016, damping: 0.0, stiffness: 0.664, friction: 0.022 };

    fn in_steps(slider: &Slider, force: f64, rate: f64, n: u32, duration: f64) -> (f64, f64) {
        let step = duration / f64::from(n);
        let (mut shift, mut speed) = (0.0, 0.0);
        for i in 0..n {
            let slid = slider.slide(speed, force + rate * step * f64::from(i) - slider.stiffness * shift, rate, step);
            (shift, speed) = (shift + slid.shift, slid.speed);
        }
        (shift, speed)
    }

    /// A spring pulled at v: rest until it carries the friction, then x = v t - (v / omega) sin(omega t).
    #[test]
    fn a_pulled_slider_starts_within_a_step_and_swings() {
        let (speed, omega) = (0.03, SLIDER.frequency());
        let onset = SLIDER.friction / SLIDER.stiffness / speed;
        let after: f64 = 0.777;
        let expected = speed * after - speed / omega * (omega * after).sin();
        for n in [1, 7, 400] {
            let (shift, _) = in_steps(&SLIDER, 0.0, SLIDER.stiffness * speed, n, onset + after);
            // Rounding of order one sums of n steps.
            assert!((shift - expected).abs() < 1e-12, "{n}: {shift} {expected}");
        }
    }

    /// Half-swings of 2 (F - (2 j + 1) f) / k to and fro until the spring holds less than friction.
    #[test]
    fn a_released_slider_swings_to_and_fro_until_friction_holds_it() {
        for (force, expected) in [(1.2, 0.4), (1.66, 1.32), (2.5, 3.0), (3.5, 4.0), (6.0, 6.0), (0.9, 0.0)] {
            let slid = SLIDER.slide(0.0, force * SLIDER.friction, 0.0, 3.0);
            // Instants of stops are found to rounding.
            assert!((slid.shift * SLIDER.stiffness / SLIDER.friction - expected).abs() < 1e-9, "{force}: {slid:?}");
            assert_eq!(slid.speed, 0.0);
        }
    }

    #[test]
    fn damping_shortens_the_first_swing_and_is_continuous_through_critical() {
        let critical = 2.0 * (SLIDER.stiffness * SLIDER.mass).sqrt();
        let first = |zeta: f64| Slider { damping: zeta * critical, ..SLIDER }.slide(0.0, 2.0 * SLIDER.friction, 0.0, 4.0).shift;
        let way = SLIDER.friction / SLIDER.stiffness;
        let factor = 1.0 + (-std::f64::consts::PI * 0.3 / 0.91f64.sqrt()).exp();
        assert!((first(0.3) / way - factor).abs() < 1e-9);
        // Continuous to first order in the difference.
        assert!((first(1.0 - 1e-7) - first(1.0 + 1e-7)).abs() < 1e-6 * way);
        // 81 radians of the slow mode, 0.13 of them a decade: 2e-5 is left.
        assert!((first(2.0) / way - 1.0).abs() < 1e-4);
    }

    /// Without a spring: v^2 / (2 mu g), and nothing while a force stays within friction.
    #[test]
    fn a_slider_without_spring_coasts() {
        let free = Slider { stiffness: 0.0, ..SLIDER };
        let slid = free.slide(0.2, 0.0, 0.0, 1.0);
        assert!((slid.shift - 0.2 * 0.2 * free.mass / (2.0 * free.friction)).abs() < 1e-15, "{slid:?}");
        assert_eq!(free.slide(0.0, 0.99 * free.friction, 0.0, 1.0), Slid::default());
        let frictionless = Slider { friction: 0.0, ..free };
        assert!((frictionless.slide(0.1, 0.0, 0.0, 2.0).shift - 0.2).abs() < 1e-15);
    }
}
