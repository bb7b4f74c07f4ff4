//! A load that is let go with a speed: how far it slides and turns before friction stops it.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4};

use cohaul::backend::rapier::{EngineSettings, FrictionModel, Precision, RapierOptions};
use cohaul::backend::{Motion, Status};
use cohaul::math::{Vec2, direction};

use crate::scenes::{GRAVITY, MASS, MU, SLIP_LIMIT, backend, moving, paper_body, peers_body, with_friction};

const SPEED: f64 = 0.2;
/// v0^2 / (2 mu g) (m).
const SLIDE: f64 = SPEED * SPEED / (2.0 * MU * GRAVITY);

/// Where the peers' body ends that starts at this speed.
fn end_of(velocity: Vec2, turn_rate: f64, step: f64, options: RapierOptions) -> Motion {
    let mut backend = backend(&peers_body(), moving(velocity, turn_rate), step, options);
    // Longer than the longest stop, 54 ms.
    assert_ne!(backend.advance(&[], 0.1).status, Status::Failed);
    backend.motion()
}

/// Implicit Euler falls short by v0 h / 2 - r (1 - r) a h^2 / 2, with r the part of a step in which
/// the load would have stopped.
#[test]
fn a_slide_falls_short_by_half_a_step_of_its_speed_in_every_direction() {
    assert!((SLIDE - 1.45624e-3).abs() < 5e-9, "v^2 / (2 mu g)");
    for angle in [0.0, FRAC_PI_4, 2.0] {
        for step in [2e-3, 1e-3, 5e-4, 2.5e-4] {
            let end = end_of(SPEED * direction(angle), 0.0, step, RapierOptions::default());
            let short = SLIDE - end.pose.position.norm();
            let parabola = MU * GRAVITY * step * step / 8.0;
            assert!((short - SPEED * step / 2.0 + parabola / 2.0).abs() < 0.501 * parabola, "{angle} {step}: {short}");
            // Symmetric supports: no turn, up to rounding over the run.
            assert!(end.pose.heading.abs() < 1e-15);
        }
    }
    let error = end_of(SPEED * Vec2::x(), 0.0, 1e-3, RapierOptions::default()).pose.position.x / SLIDE - 1.0;
    assert!((error + 0.0675).abs() < 5e-5, "engines without model error are 6.75 % off at 1 ms: {error}");
}

/// At 45 degrees each axis of the box brakes with the whole limit: sqrt(2) times the friction,
/// however short the step.
#[test]
fn the_box_stops_a_diagonal_slide_29_percent_early_at_any_step() {
    for step in [1e-3, 1e-4, 1e-5] {
        let end = end_of(SPEED * direction(FRAC_PI_4), 0.0, step, with_friction(FrictionModel::Box));
        let short = FRAC_1_SQRT_2 * SLIDE - end.pose.position.norm();
        // The same offset of implicit Euler with sqrt(2) times the deceleration.
        assert!((short - SPEED * step / 2.0).abs() < 0.3 * MU * GRAVITY * step * step, "{step}: {short}");
    }
    let end = end_of(SPEED * direction(FRAC_PI_4), 0.0, 2.5e-4, with_friction(FrictionModel::Box));
    // -29.3 % and the offset of the step: -31 % at 1 ms.
    assert!((end.pose.position.norm() / SLIDE - 0.69).abs() < 0.001);
}

/// The polygon's width over the disc's is pi / 16 / tan(pi / 16) along its axes and pi / 16 /
/// sin(pi / 16) between them.
#[test]
fn the_polygon_errs_by_its_width() {
    let half_side = std::f64::consts::PI / 16.0;
    for (angle, width) in [(0.0, half_side / half_side.tan()), (half_side, half_side / half_side.sin())] {
        let step = 1e-4;
        let end = end_of(SPEED * direction(angle), 0.0, step, with_friction(FrictionModel::Polygon));
        let short = SLIDE / width - end.pose.position.norm();
        assert!((short - SPEED * step / 2.0).abs() < 0.2 * MU * GRAVITY * step * step, "{angle}: {short}");
    }
}

#[test]
fn a_spin_stops_where_the_moment_of_friction_says() {
    let (spin, system) = (20.0, peers_body());
    let deceleration = SLIP_LIMIT * 0.02 / system.load.inertia;
    let angle = spin * spin / (2.0 * deceleration);
    assert!((angle - 0.539628).abs() < 5e-7, "omega^2 I / (2 f a)");
    for step in [1e-3, 5e-4, 2.5e-4] {
        let end = end_of(Vec2::zeros(), spin, step, RapierOptions::default());
        let short = angle - end.pose.heading;
        // Rapier turns by atan(h omega) where h omega is meant: (h omega)^3 / 3 less a step, in the
        // mean over the stop half of (h omega)^2 / 3.
        let linearised = angle * (step * spin).powi(2) / 6.0;
        assert!((short - spin * step / 2.0 - linearised).abs() < 0.13 * deceleration * step * step, "{step}: {short}");
        assert!(end.pose.position.norm() < 1e-16);
    }
}

/// Slide and spin on a tripod (extrapolated to 14 digits by an independent program), chi = 1.125,
/// start (1, 0) and 0.3 in units of a and sqrt(mu g a): one support is caught on the way.
#[test]
fn slide_and_spin_converge_to_the_known_end() {
    let system = paper_body();
    let a = 2.0 * 0.0122 / 3.0;
    let (length, speed) = (a, (MU * GRAVITY * a).sqrt());
    let time = length / speed;
    let end = |step: f64| {
        let mut backend = backend(&system, moving(speed * Vec2::x(), 0.3 / time), step * time, RapierOptions::default());
        let report = backend.advance(&[], 1.25 * time);
        assert_eq!(report.status, Status::Converged);
        let pose = backend.motion().pose;
        [pose.position.x / length, pose.position.y / length, pose.heading]
    };
    let known = [0.526608062481981, 0.00799629577564152, 0.235877956752436];
    let (coarse, fine) = (end(2e-3), end(1e-3));
    for i in 0..3 {
        let (far, near) = (coarse[i] - known[i], fine[i] - known[i]);
        // First order: halving the step halves the error, up to the place of the stop within a
        // step.
        assert!((far / near - 2.0).abs() < 0.05, "{i}: {far} {near}");
        // What is left after Richardson's step is O(h^2).
        assert!((2.0 * fine[i] - coarse[i] - known[i]).abs() < 2e-6, "{i}: {}", 2.0 * fine[i] - coarse[i] - known[i]);
    }
}

/// Slide and spin, distance from the start. The exact end is the aligned one at vanishing step.
#[test]
fn slide_and_spin_tell_the_friction_models_apart() {
    let end = |step: f64, options| end_of(SPEED * Vec2::x(), 10.0, step, options).pose.position.norm();
    let limit = |options| 2.0 * end(5e-5, options) - end(1e-4, options);
    let exact = limit(RapierOptions::default());
    // Recorded from two other steps, 100 us and 10 us.
    assert!((exact - 3.592949e-3).abs() < 2e-9, "{exact}");
    let polygon = limit(with_friction(FrictionModel::Polygon)) / exact - 1.0;
    assert!(polygon.abs() < 0.001 && polygon != 0.0, "{polygon}");
    let box_friction = limit(with_friction(FrictionModel::Box)) / exact - 1.0;
    assert!((box_friction + 0.265).abs() < 0.002, "{box_friction}");
    let as_shipped = limit(RapierOptions::engine_defaults()) / exact - 1.0;
    assert!((as_shipped + 0.265).abs() < 0.002, "{as_shipped}");
}

/// One precision is not the other, and both slide alike.
#[test]
fn single_precision_slides_as_double_does() {
    let single = RapierOptions { precision: Precision::F32, ..RapierOptions::default() };
    for turn_rate in [0.0, 10.0] {
        let [wide, narrow] = [RapierOptions::default(), single].map(|options| end_of(SPEED * Vec2::x(), turn_rate, 1e-3, options));
        let gap = (wide.pose.position - narrow.pose.position).norm();
        // Some tens of steps with the rounding of speeds of 0.2 m/s and positions of 3 mm.
        assert!(gap > 0.0 && gap < 1e-8, "{gap}");
    }
}

/// Without friction a load keeps its speed of 1 cm/s. At 0.3 m from the origin a step of 10 us is
/// 3.36 last digits of f32 there, 2^-25 m, of which the engine adds 3: the position loses 10.6 % of
/// the path, which no iteration can see. A step of 1 ms is 336 digits.
#[test]
fn a_step_of_few_last_digits_does_not_pass_for_converged() {
    let mut system = peers_body();
    system.ground.friction_coefficient = 0.0;
    let (speed, duration) = (0.01, 0.5);
    let way = |precision, step| {
        let mut start = moving(Vec2::new(speed, 0.0), 0.0);
        start.pose.position.x = 0.3;
        let mut run = backend(&system, start, step, RapierOptions { precision, ..RapierOptions::default() });
        let report = run.advance(&[], duration);
        ((run.motion().pose.position.x - 0.3) / (speed * duration), report)
    };
    let lost = 1.0 - 3.0 * f64::from(2.0f32.powi(-25)) / (f64::from(speed as f32) * 1e-5);
    let (found, report) = way(Precision::F32, 1e-5);
    assert!((1.0 - found - lost).abs() < 1e-3 && lost > 0.1, "{found} {lost}");
    assert_eq!(report.status, Status::NotConverged);
    assert!((report.lost_share - lost).abs() < 1e-3, "{report:?}");
    for (precision, step) in [(Precision::F32, 1e-3), (Precision::F64, 1e-5)] {
        let (found, report) = way(precision, step);
        assert!((found - 1.0).abs() < 5e-3, "{precision:?} {step}: {found}");
        assert_eq!((report.status, report.lost_share), (Status::Converged, 0.0));
    }
}

/// The engine's numbers are f32, so the start is rounded to them and every pose is one of them.
#[test]
fn the_pose_is_the_one_the_engine_holds() {
    let single = RapierOptions { precision: Precision::F32, ..RapierOptions::default() };
    let start = moving(Vec2::new(0.1, 0.0), 3.0);
    let mut run = backend(&peers_body(), start, 1e-3, single);
    assert_eq!(run.motion().twist.linear.x, f64::from(0.1f32));
    run.advance(&[], 5e-3);
    assert_eq!(run.motion().pose.position.x, f64::from(run.motion().pose.position.x as f32));
}

#[test]
fn a_load_without_friction_turns_on_and_its_heading_counts_whole_turns() {
    let mut system = peers_body();
    system.ground.friction_coefficient = 0.0;
    let (spin, step, duration) = (20.0, 1e-3, 2.0);
    for settings in [EngineSettings::Recommended, EngineSettings::EngineDefaults] {
        let options = RapierOptions { settings, ..RapierOptions::default() };
        let mut run = backend(&system, moving(Vec2::new(0.3, 0.0), spin), step, options);
        let report = run.advance(&[], duration);
        let n_substeps = if settings == EngineSettings::Recommended { 1.0 } else { 4.0 };
        let turned = duration / step * n_substeps * (step / n_substeps * spin).atan();
        // Rounding of 8000 additions to 40 rad.
        assert!((run.motion().pose.heading - turned).abs() < 1e-11, "{}", run.motion().pose.heading - turned);
        assert!((run.motion().pose.position.x - 0.6).abs() < 1e-12);
        assert_eq!((report.n_steps, report.n_solves, report.n_skipped), (2000, 0, 0));
        assert!((run.energy().kinetic - 0.5 * MASS * 0.09 - 0.5 * system.load.inertia * 400.0).abs() < 1e-17);
    }
}

#[test]
fn steps_at_rest_are_skipped_and_counted() {
    let mut run = backend(&peers_body(), moving(SPEED * Vec2::x(), 0.0), 1e-3, RapierOptions::default());
    let report = run.advance(&[], 0.1);
    // 14 steps to brake, one to stop, and up to two in which the sweeps shrink the rest of the
    // speed.
    assert_eq!((report.n_steps, report.n_skipped, report.n_solves), (100, 84, 16));
    assert_eq!(run.friction_forces(), vec![Vec2::zeros(); 3]);
    let again = run.advance(&[], 1.0);
    assert_eq!((again.n_steps, again.n_skipped, again.n_solves), (1000, 1000, 0));
}
