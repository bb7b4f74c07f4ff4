//! Step against stiffness, mass and damping: scenes on the x axis with closed answers.
//!
//! Ramp: the tip of one spring goes ahead by twice the stretch f / k at which the load slips, at
//! constant speed v. Without inertia the load then follows at f / k; with it, x = v t - (v / w) sin
//! w t from the onset on. Release: the spring is grasped at a stretch of 2 f / k. Without inertia
//! the load jumps by f / k, or relaxes, x = (f / k) (1 - exp(-w t / (2 z))). With it, x = (f / k)
//! (1 - exp(-z w t) (cos + ...)): a damped oscillator up to its first stop, where friction keeps
//! it.

use super::super::map::{Asked, Axis, Cell, Map};
use super::super::scene::{Scene, load, rest_tip, stiff_spring};
use crate::verify::scenes::{MASS, RADIAL, SLIP_LIMIT, natural_rate};
use cohaul::math::Vec2;
use cohaul::scenario::format::SpringEntry;

const N_STEPS: u32 = 160;

pub fn maps() -> Vec<Map> {
    vec![
        Map {
            name: "step-stiffness",
            what: "a spring is drawn ahead until the load slips, in 160 steps; closed answer",
            x: Axis::log("step_s", 1e-6, 1.0, 31),
            y: Axis::log("stiffness_n_per_m", 1e-4, 1e8, 37),
            cell: ramp,
        },
        Map {
            name: "step-mass",
            what: "a load at rest is let go at twice its friction limit, 160 steps, the friction the same for all masses; closed answer",
            x: Axis::log("step_s", 1e-6, 1.0, 31),
            y: Axis::log("mass_kg", 1e-9, 1e3, 37),
            cell: |step, mass| release(step, mass, 0.0),
        },
        Map {
            name: "step-damping",
            what: "the same with a dashpot, the step in radians of the oscillation; closed answer",
            x: Axis::log("step_rad", 1e-3, 1e3, 31),
            y: Axis::log("damping_ratio", 1e-4, 1e4, 33).and_zero(),
            cell: |radians, damping_ratio| release(radians / natural_rate(), MASS, damping_ratio),
        },
    ]
}

fn ramp(step: f64, stiffness: f64) -> Cell {
    let slip_stretch = SLIP_LIMIT / stiffness;
    let end = rest_tip(0.0) + Vec2::new(2.0 * slip_stretch, 0.0);
    let scene = Scene::paper(step, N_STEPS).pulled(stiff_spring(0.0, stiffness), &[(0.0, rest_tip(0.0)), (f64::from(N_STEPS), end)]);
    let (speed, since) = (2.0 * slip_stretch / scene.duration(), 0.5 * scene.duration());
    let rate = (stiffness / MASS).sqrt();
    // The difference of two numbers that are nearly equal, by its series where it has too few
    // digits.
    let angle = rate * since;
    let lag = if angle < 1e-2 { angle.powi(3) / 6.0 - angle.powi(5) / 120.0 } else { angle - angle.sin() };
    let inertial = speed / rate * lag;
    scene.cell(Asked::shift(slip_stretch, inertial, inertial.min(slip_stretch)))
}

fn release(step: f64, mass: f64, damping_ratio: f64) -> Cell {
    let slip_stretch = SLIP_LIMIT / RADIAL;
    let tip = rest_tip(0.0) + Vec2::new(2.0 * slip_stretch, 0.0);
    let spring = SpringEntry { damping_ratio, ..stiff_spring(0.0, RADIAL) };
    let mut scene = Scene::paper(step, N_STEPS).pulled(spring, &[(0.0, tip)]);
    scene.load = load(mass);
    let angle = (RADIAL / mass).sqrt() * scene.duration();
    let relaxed = slip_stretch * -(-angle / (2.0 * damping_ratio)).exp_m1();
    let inertial = slip_stretch * released(angle, damping_ratio);
    scene.cell(Asked::shift(relaxed, inertial, inertial.min(relaxed)))
}

/// Displacement at the angle w t of an oscillator that starts at rest at a distance of one, up to
/// its first stop (1).
fn released(angle: f64, z: f64) -> f64 {
    // For w t so small that only the force at the start counts, differences of near equals would be
    // left.
    let early = angle < 1e-3 && z * angle < 1e-3;
    let damped = (1.0 - z * z).abs().sqrt();
    match () {
        _ if early => 0.5 * angle * angle * (1.0 - 2.0 * z * angle / 3.0),
        _ if z == 1.0 => 1.0 - (-angle).exp() * (1.0 + angle),
        _ if z < 1.0 => {
            let phase = (damped * angle).min(std::f64::consts::PI);
            1.0 - (-z * phase / damped).exp() * (phase.cos() + z / damped * phase.sin())
        }
        _ => {
            // Both roots of s^2 + 2 z s + 1; the slow one by their product, which is one.
            let fast = z + damped;
            let slow = 1.0 / fast;
            let (slow_loss, fast_loss) = (-(-slow * angle).exp_m1(), -(-fast * angle).exp_m1());
            (fast * slow_loss - slow * fast_loss) / (fast - slow)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::released;

    /// The answer itself, against 1e5 steps of the equation of motion by the trapezoidal rule:
    /// second order, 1e-9.
    #[test]
    fn the_closed_answer_solves_the_equation_of_motion() {
        for (z, angle) in [(0.0, 1.0), (0.0, 10.0), (0.3, 2.0), (0.3, 20.0), (1.0, 3.0), (4.0, 5.0), (100.0, 50.0), (1e-4, 9e-4)] {
            let (n, mut x, mut v) = (100_000, 0.0, 0.0);
            let h = angle / f64::from(n);
            for _ in 0..n {
                let next = (v * (1.0 - z * h - h * h / 4.0) + h * (1.0 - x)) / (1.0 + z * h + h * h / 4.0);
                if next < 0.0 {
                    break;
                }
                x += 0.5 * h * (v + next);
                v = next;
            }
            // The stop falls within a step, whose displacement is of second order too.
            assert!((released(angle, z) - x).abs() < 1e-6 * x.max(1e-7), "{z} {angle}: {} {x}", released(angle, z));
        }
    }
}
