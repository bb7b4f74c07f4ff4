//! Loads that meet obstacles: gaps, speeds, friction, notches, corners, posts, pushers, rebounds,
//! and squeezes that have no answer.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::super::map::{Asked, Axis, Cell, Map};
use super::super::scene::{Scene, disc, isotropic, load, walls};
use super::scales::in_units;
use crate::verify::scenes::{GRAVITY, LOAD_RADIUS, MASS, MU, SLIP_LIMIT, SLIP_STRETCH};
use cohaul::math::{Vec2, direction};
use cohaul::scenario::format::{LoadEntry, OutlineEntry, PolygonEntry, ScenarioFile};

/// Half the length of a wall that no load gets round (m).
const LONG: f64 = 1e3;
/// Deceleration of a load that slides (m/s^2).
const BRAKING: f64 = MU * GRAVITY;

pub fn maps() -> Vec<Map> {
    let friction = |n: usize| Axis::log("side_friction_coefficient", 1e-3, 10.0, n).and_zero();
    let gap = |n: usize| Axis::log("gap_m", 1e-12, 1.0, n).and_zero();
    let mut maps = against_walls(&friction, &gap);
    maps.extend(against_others(&friction));
    maps
}

/// Maps with straight walls. The arguments make axes with so many values.
fn against_walls(friction: &dyn Fn(usize) -> Axis, gap: &dyn Fn(usize) -> Axis) -> Vec<Map> {
    vec![
        Map {
            name: "contact-gap-speed",
            what: "a load is thrown at a thin wall, 40 steps of 1 ms; closed answer",
            x: gap(24),
            y: Axis::log("speed_m_per_s", 1e-6, 1e3, 28),
            cell: thrown,
        },
        Map {
            name: "contact-gap-step",
            what: "a spring pulls a load against a wall, 40 steps; exact answer at finer steps",
            x: gap(24),
            y: Axis::log("step_s", 1e-6, 1.0, 25),
            cell: pulled,
        },
        Map {
            name: "contact-friction-angle",
            what: "a spring pulls a disc along a rough wall and into it, 40 steps; exact answer at finer steps",
            x: friction(25),
            y: Axis::linear("angle_into_the_wall_rad", 0.0, FRAC_PI_2, 25),
            cell: along,
        },
        Map {
            name: "contact-notch",
            what: "a spring pulls a disc into a notch of two rough walls, 40 steps; exact answer at finer steps",
            x: Axis::linear("opening_angle_rad", PI / 60.0, PI, 30),
            y: Axis::log("side_friction_coefficient", 1e-3, 0.5, 25),
            cell: notch,
        },
        Map {
            name: "contact-step-stiffness",
            what: "a spring of any stiffness pulls a disc along a wall with friction 0.3, 40 steps; exact answer at finer steps",
            x: Axis::log("step_s", 1e-6, 1.0, 25),
            y: Axis::log("stiffness_n_per_m", 1e-1, 1e5, 25),
            cell: stiff,
        },
        Map {
            name: "contact-restitution",
            what: "a load is thrown at a wall and bounces off, 200 steps; closed answer",
            x: Axis::linear("restitution", 0.0, 1.0, 21),
            y: Axis::linear("gap_over_stopping_distance", 0.02, 0.98, 25),
            cell: bouncing,
        },
        Map {
            name: "contact-scales",
            what: "a throw and a pull between a wall and a post in units of other lengths and masses; the answer in those units is the same",
            x: Axis::log("length_m", 1e-6, 1e3, 19),
            y: Axis::log("mass_kg", 1e-9, 1e3, 19),
            cell: scaled,
        },
    ]
}

fn against_others(friction: &dyn Fn(usize) -> Axis) -> Vec<Map> {
    vec![
        Map {
            name: "contact-corner",
            what: "a spring pulls a disc past a corner or a post of any size, 60 steps; exact answer at finer steps",
            x: Axis::log("obstacle_radius_m", 1e-6, 1e2, 24).and_zero(),
            y: Axis::linear("offset_radii", 0.05, 1.25, 25),
            cell: corner,
        },
        Map {
            name: "contact-polygon",
            what: "a spring pulls a polygon along a rough wall and into it, 40 steps; exact answer at finer steps",
            x: Axis::counts("n_corners", 3.0, 40.0, 18),
            y: friction(19),
            cell: polygon,
        },
        Map {
            name: "contact-obstacles",
            what: "a spring pulls a disc into a field of 1 to 1000 posts with friction 0.3, 60 steps; exact answer at finer steps",
            x: Axis::counts("n_posts", 1.0, 1000.0, 25),
            y: Axis::log("gap_m", 1e-9, 1e-2, 22),
            cell: among_posts,
        },
        Map {
            name: "contact-pusher",
            what: "a round pusher with friction 0.3 pushes a free disc beside its centre, 40 steps of 1 ms; exact answer at finer steps",
            x: Axis::log("speed_m_per_s", 1e-6, 20.0, 25),
            y: Axis::linear("offset_radii", 0.0, 0.96, 25),
            cell: pushed,
        },
        Map {
            name: "contact-squeeze",
            what: "a pusher presses a free disc against a wall, and has no room for its path beyond 1; exact answer at finer steps",
            x: Axis::linear("travel_over_room", 0.1, 1.9, 19),
            y: friction(14),
            cell: squeezed,
        },
    ]
}

fn wall_across() -> OutlineEntry {
    walls(&[Vec2::new(0.0, -LONG), Vec2::new(0.0, LONG)])
}

fn wall_along() -> OutlineEntry {
    walls(&[Vec2::new(-LONG, 0.0), Vec2::new(LONG, 0.0)])
}

/// The tip of an isotropic spring at the centre leaves `start` by `shift` (m) in 30 steps.
fn drawn(scene: Scene, start: Vec2, shift: Vec2) -> Scene {
    scene.pulled(isotropic(Vec2::zeros()), &[(0.0, start), (30.0, start + shift)])
}

fn thrown(gap: f64, speed: f64) -> Cell {
    let mut scene = Scene::paper(1e-3, 40).among(wall_across(), Vec2::new(LOAD_RADIUS + gap, 0.0), 0.0);
    scene.load.velocity_m_per_s = [speed, 0.0];
    let time = scene.duration().min(speed / BRAKING);
    let displacement = (speed * time - 0.5 * BRAKING * time * time).min(gap);
    // A stop within the first step cannot be told from another one there.
    let scale = displacement.max(speed * scene.step);
    scene.cell(Asked::shift(0.0, displacement, scale))
}

fn pulled(gap: f64, step: f64) -> Cell {
    let scene = Scene::paper(step, 40).among(wall_across(), Vec2::new(LOAD_RADIUS + gap, 0.0), 0.0);
    drawn(scene, Vec2::zeros(), Vec2::new(3.0 * SLIP_STRETCH, 0.0)).cell(Asked { symmetric: true, ..Asked::finer() })
}

fn along(friction: f64, angle: f64) -> Cell {
    let scene = Scene::paper(2e-3, 40).among(wall_along(), Vec2::new(0.0, -LOAD_RADIUS), friction);
    drawn(scene, Vec2::zeros(), 3.0 * SLIP_STRETCH * direction(-angle)).cell(Asked::finer())
}

/// The disc starts a fifth of its radius above its place in the notch, and is drawn a little aside.
fn notch(angle: f64, friction: f64) -> Cell {
    let depth = LOAD_RADIUS / (0.5 * angle).sin();
    let side = |sign: f64| 2.0 * (depth + LOAD_RADIUS) * direction(FRAC_PI_2 + sign * 0.5 * angle);
    let start = Vec2::new(0.0, depth + 0.2 * LOAD_RADIUS);
    let mut scene = Scene::paper(2e-3, 40).among(walls(&[side(1.0), Vec2::zeros(), side(-1.0)]), Vec2::zeros(), friction);
    scene.load.position_m = start.into();
    drawn(scene, start, 3.0 * SLIP_STRETCH * direction(0.3 - FRAC_PI_2)).cell(Asked::finer())
}

fn stiff(step: f64, stiffness: f64) -> Cell {
    let scene = Scene::paper(step, 40).among(wall_along(), Vec2::new(0.0, -LOAD_RADIUS), 0.3);
    let mut scene = drawn(scene, Vec2::zeros(), SLIP_LIMIT / stiffness * Vec2::new(3.0, -1.0));
    scene.springs[0].radial_stiffness_n_per_m = stiffness;
    scene.cell(Asked::finer())
}

/// Thrown at 0.5 m/s at a wall within the stopping distance, for as long as a load without the wall
/// would slide.
fn bouncing(restitution: f64, share: f64) -> Cell {
    const SPEED: f64 = 0.5;
    const N_STEPS: u32 = 200;
    let gap = share * 0.5 * SPEED * SPEED / BRAKING;
    let mut scene = Scene::paper(SPEED / BRAKING / f64::from(N_STEPS), N_STEPS + 2);
    scene = scene.among(wall_across(), Vec2::new(LOAD_RADIUS + gap, 0.0), 0.0);
    scene.obstacles[0].restitution = restitution;
    scene.load.velocity_m_per_s = [SPEED, 0.0];
    let rebound = restitution * restitution * (0.5 * SPEED * SPEED / BRAKING - gap);
    let scale = (gap + rebound).max(SPEED * scene.step);
    scene.cell(Asked::shift(0.0, gap - rebound, scale))
}

/// Thrown obliquely at a wall, which it leaves, and drawn past a post.
fn base() -> ScenarioFile {
    let mut scene = Scene::paper(1e-3, 60).among(wall_along(), Vec2::new(0.0, -1.02 * LOAD_RADIUS), 0.3).among(
        disc(0.3 * LOAD_RADIUS),
        Vec2::new(1.6, -0.1) * LOAD_RADIUS,
        0.2,
    );
    scene.load.velocity_m_per_s = [0.1, -0.1];
    scene.obstacles[0].restitution = 0.5;
    drawn(scene, Vec2::zeros(), SLIP_STRETCH * Vec2::new(2.0, 1.5)).file()
}

fn scaled(length: f64, mass: f64) -> Cell {
    in_units(&base, length, mass)
}

/// The nearest point of the obstacle is ahead by a radius, and aside by the offset. Radius 0 is the
/// corner of a square.
fn corner(radius: f64, offset: f64) -> Cell {
    let nearest = Vec2::new(2.0, -offset) * LOAD_RADIUS;
    let size = 0.5 * LOAD_RADIUS;
    let square = || {
        let points_m = (0..4).map(|i| (size * direction(FRAC_PI_2 * f64::from(i))).into()).collect();
        OutlineEntry::Polygon(PolygonEntry { points_m })
    };
    let (outline, size) = if radius > 0.0 { (disc(radius), radius) } else { (square(), size) };
    let scene = Scene::paper(2e-3, 60).among(outline, nearest + Vec2::new(size, 0.0), 0.1);
    let scene = scene.pulled(isotropic(Vec2::zeros()), &[(0.0, Vec2::zeros()), (60.0, Vec2::new(6.0, 0.0) * LOAD_RADIUS)]);
    scene.cell(Asked::finer())
}

/// Posts on a spiral in steps of the golden angle, the nearest one ahead.
fn among_posts(n: f64, gap: f64) -> Cell {
    const POST: f64 = 1e-3;
    const SPACING: f64 = 4e-3;
    let golden_angle = PI * (3.0 - 5f64.sqrt());
    let place = |i: f64| (LOAD_RADIUS + POST + gap + SPACING * i.sqrt()) * direction(golden_angle * i);
    let start = Scene::paper(2e-3, 60);
    let scene = (0..n as usize).fold(start, |scene, i| scene.among(disc(POST), place(i as f64), 0.3));
    drawn(scene, Vec2::zeros(), SLIP_STRETCH * Vec2::new(3.0, 0.5)).cell(Asked::finer())
}

fn polygon(n: f64, friction: f64) -> Cell {
    let points_m = (0..n as usize).map(|i| (LOAD_RADIUS * direction(TAU * i as f64 / n)).into()).collect();
    let outline = OutlineEntry::Polygon(PolygonEntry { points_m });
    let mut scene = Scene::paper(2e-3, 40).among(wall_along(), Vec2::new(0.0, -1.05 * LOAD_RADIUS), friction);
    scene.load = LoadEntry { outline: Some(outline), radius_m: None, ..load(MASS) };
    drawn(scene, Vec2::zeros(), 3.0 * SLIP_STRETCH * direction(-0.7)).cell(Asked::finer())
}

fn pushed(speed: f64, offset: f64) -> Cell {
    const PUSHER: f64 = 0.005;
    let scene = Scene::paper(1e-3, 40);
    let reach = LOAD_RADIUS + PUSHER;
    let aside = offset * LOAD_RADIUS;
    let start = Vec2::new(-1.000001 * (reach * reach - aside * aside).sqrt(), aside);
    let end = start + Vec2::new(speed * scene.duration(), 0.0);
    scene.pushed(disc(PUSHER), [start, end], 0.3).cell(Asked::finer())
}

/// The room between pusher, disc and wall is half a radius.
fn squeezed(travel: f64, friction: f64) -> Cell {
    const PUSHER: f64 = 0.005;
    let room = 0.5 * LOAD_RADIUS;
    let start = Vec2::new(-LOAD_RADIUS - PUSHER - 0.5 * room, 0.0);
    let scene = Scene::paper(2e-3, 40).among(wall_across(), Vec2::new(LOAD_RADIUS + 0.5 * room, 0.0), friction).pushed(
        disc(PUSHER),
        [start, start + Vec2::new(travel * room, 0.0)],
        friction,
    );
    scene.cell(Asked { symmetric: true, squeeze: Some((travel - 1.0) * room).filter(|lack| *lack > 0.0), ..Asked::finer() })
}
