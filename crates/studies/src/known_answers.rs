//! Closed-form motions, for every study that needs a known answer.
//!
//! [`known`] recognises scenes by what the scenario says, not by its name: slides and spins to
//! rest, and a spring through the centre whose tip leaves at a constant speed and may stop. Answers
//! of single scenes with printed digits stand beside their questions in [`crate::verify`].

use cohaul::backend::BackendKind;
use cohaul::math::{Pose, Twist, Vec2, perpendicular};
use cohaul::scenario::{Drive, Scenario, TipPath};

/// A path in closed form.
pub struct Known {
    pub formula: &'static str,
    path: Box<dyn Fn(f64) -> Pose>,
}

impl Known {
    /// Pose at `time` (s).
    pub fn at(&self, time: f64) -> Pose {
        (self.path)(time)
    }
}

/// Distance of a slide from `speed` (m/s) to rest at this deceleration (m/s^2) (m).
pub fn slide_distance(speed: f64, deceleration: f64) -> f64 {
    speed * speed / (2.0 * deceleration)
}

/// Displacement of a load with inertia on a spring at a time after the onset of slip (m): its tip
/// moves at `speed` (m/s), and the load oscillates at `rate` (rad/s).
pub fn pulled_after_onset(speed: f64, rate: f64, time: f64) -> f64 {
    speed * time - speed / rate * (rate * time).sin()
}

/// Share of the whole up to which forces that should cancel may be left by rounded places of
/// supports (1).
const BALANCED: f64 = 1e-12;

/// The path of the scenario's load without inertia or with it, if it has a closed form. None is
/// known among obstacles.
pub fn known(scenario: &Scenario, kind: BackendKind) -> Option<Known> {
    if !scenario.system.world.is_empty() {
        return None;
    }
    let Drive::Tips(paths) = &scenario.drive else { return None };
    if !scenario.system.world.obstacles.is_empty() {
        return None;
    }
    match paths.as_slice() {
        [] if kind.has_inertia() => slide(scenario).or_else(|| spin(scenario)),
        [path] => pull(scenario, path, kind),
        _ => None,
    }
}

/// Supports whose friction on a load that shifts has no torque.
fn is_centred(scenario: &Scenario) -> bool {
    let ground = &scenario.system.ground;
    let torque = ground.supports.iter().zip(ground.slip_limits()).fold(Vec2::zeros(), |sum, (support, limit)| sum + limit * support.offset);
    torque.norm() <= BALANCED * scenario.system.total_slip_limit() * scenario.system.load.radius
}

fn slide(scenario: &Scenario) -> Option<Known> {
    let (start, Twist { linear, angular }) = (scenario.start.pose, scenario.start.twist);
    let speed = linear.norm();
    if angular != 0.0 || speed == 0.0 || !is_centred(scenario) {
        return None;
    }
    let braking = scenario.system.braking();
    let path = move |time: f64| {
        let time = time.min(speed / braking);
        Pose { position: start.position + linear * (time - 0.5 * braking * time * time / speed), ..start }
    };
    Some(Known { formula: "v0 t - mu g t^2 / 2 up to rest", path: Box::new(path) })
}

fn spin(scenario: &Scenario) -> Option<Known> {
    let (start, Twist { linear, angular }) = (scenario.start.pose, scenario.start.twist);
    let ground = &scenario.system.ground;
    let parts = || ground.supports.iter().zip(ground.slip_limits()).filter(|(support, _)| support.offset.norm() > 0.0);
    let force = parts().fold(Vec2::zeros(), |sum, (support, limit)| sum + limit * perpendicular(&support.offset.normalize()));
    if angular == 0.0 || linear != Vec2::zeros() || force.norm() > BALANCED * scenario.system.total_slip_limit() {
        return None;
    }
    let braking = parts().map(|(support, limit)| limit * support.offset.norm()).sum::<f64>() / scenario.system.load.inertia;
    let path = move |time: f64| {
        let time = time.min(angular.abs() / braking);
        Pose { heading: start.heading + angular * time - angular.signum() * 0.5 * braking * time * time, ..start }
    };
    Some(Known { formula: "omega0 t - f a t^2 / (2 I) up to rest", path: Box::new(path) })
}

/// A tip that leaves the centre of a load at rest along a straight line, and stops once. Without
/// inertia the load follows at the stretch f / k. With inertia it oscillates about that, and moves
/// on to a rest when the tip stops.
fn pull(scenario: &Scenario, path: &TipPath, kind: BackendKind) -> Option<Known> {
    let (start, system) = (scenario.start, &scenario.system);
    let spring = &system.springs[path.spring];
    let ([first, last], None) = (path.waypoints.as_slice(), path.release) else { return None };
    let is_plain = spring.is_isotropic() && spring.root == Vec2::zeros() && spring.damping_ratio == 0.0;
    if !is_plain || start.twist != Twist::ZERO || first.position != start.pose.position || !is_centred(scenario) {
        return None;
    }
    let displacement = last.position - first.position;
    let speed = displacement.norm() / (last.time - first.time);
    let (stiffness, limit) = (spring.radial_stiffness, system.total_slip_limit());
    let onset = first.time + limit / (stiffness * speed);
    if onset >= last.time {
        return None;
    }
    let rate = (stiffness / system.load.mass).sqrt();
    // Amplitude of the ripple: it turns the load back only above f / k.
    let amplitude = speed / rate;
    if amplitude > limit / stiffness {
        return None;
    }
    let held = last.time - onset;
    // From the stop on a free oscillation about v tau less the same force, to its first turning
    // point.
    let (lag, slope) = (-amplitude * (rate * held).sin(), speed * (1.0 - (rate * held).cos()));
    let swing = (lag * lag + (slope / rate).powi(2)).sqrt();
    let phase = (slope / rate).atan2(lag);
    let displacement_after = move |tau: f64| match () {
        _ if !kind.has_inertia() => speed * tau.min(held),
        _ if tau <= held => pulled_after_onset(speed, rate, tau),
        _ => speed * held + swing * ((rate * (tau - held)).min(phase) - phase).cos(),
    };
    let along = displacement.normalize();
    let path = move |time: f64| Pose { position: start.pose.position + along * displacement_after((time - onset).max(0.0)), ..start.pose };
    let formula = if kind.has_inertia() { "v tau - (v / omega) sin omega tau" } else { "v t - f / k" };
    Some(Known { formula, path: Box::new(path) })
}
