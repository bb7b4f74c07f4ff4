//! One scene from nanometres to kilometres and from micrograms to tonnes, and loads of any
//! proportion.

use super::super::map::{Answer, Asked, Axis, Cell, Map};
use super::super::scene::{Scene, load, rest_tip, spring};
use crate::verify::scenes::{LOAD_RADIUS, MASS, SLIP_STRETCH};
use cohaul::math::Vec2;
use cohaul::scenario::format::{DriveEntry, OutlineEntry, ScenarioFile, SpringsEntry, SupportsEntry};

pub fn maps() -> Vec<Map> {
    vec![
        Map {
            name: "scales",
            what: "one scene in units of other lengths and masses; the answer in those units is the same",
            x: Axis::log("length_m", 1e-9, 1e3, 37),
            y: Axis::log("mass_kg", 1e-9, 1e3, 37),
            cell: scaled,
        },
        Map {
            name: "gyration-mass",
            what: "a load of any inertia is drawn aside, 60 steps, the friction that of its weight; exact answer at finer steps",
            x: Axis::log("inertia_share", 1e-9, 1e9, 31),
            y: Axis::log("mass_kg", 1e-9, 1e3, 31),
            cell: gyration,
        },
    ]
}

/// Thrown and turned, hauled by two springs of which one is let go.
fn base() -> ScenarioFile {
    const N_STEPS: u32 = 60;
    let (ahead, aside) = (rest_tip(0.0), rest_tip(1.0));
    let mut scene = Scene::paper(2e-3, N_STEPS)
        .pulled(spring(0.0), &[(0.0, ahead), (30.0, ahead + Vec2::new(2.0, 0.3) * SLIP_STRETCH)])
        .pulled(spring(1.0), &[(5.0, aside), (20.0, aside + Vec2::new(0.5, 1.0) * SLIP_STRETCH)]);
    scene.paths[1].release_s = Some(40.0 * scene.step);
    scene.load.velocity_m_per_s = [0.05, -0.02];
    scene.load.turn_rate_rad_per_s = 2.0;
    scene.file()
}

/// With the radius of the load as the length. Gravity stays, so times go with the root of lengths,
/// and forces with masses.
fn scaled(length: f64, mass: f64) -> Cell {
    in_units(&base, length, mass)
}

/// The scene of `base` in units in which the load has this radius (m) and this mass (kg).
pub(super) fn in_units(base: &dyn Fn() -> ScenarioFile, length: f64, mass: f64) -> Cell {
    let (l, m) = (length / LOAD_RADIUS, mass / MASS);
    let t = l.sqrt();
    let mut file = base();
    file.duration_s *= t;
    file.control_period_s *= t;
    file.load.mass_kg = file.load.mass_kg.map(|mass| m * mass);
    file.load.radius_m = file.load.radius_m.map(|radius| l * radius);
    file.load.velocity_m_per_s = file.load.velocity_m_per_s.map(|speed| speed * l / t);
    file.load.turn_rate_rad_per_s /= t;
    if let SupportsEntry::List(supports) = &mut file.ground.supports {
        for support in supports {
            support.offset_m = support.offset_m.map(|offset| offset * l);
            support.normal_load_n = support.normal_load_n.map(|load| load * m);
        }
    }
    for spring in &mut file.springs {
        let SpringsEntry::One(spring) = spring else { continue };
        spring.root_m = spring.root_m.map(|root| root * l);
        spring.rest_length_m *= l;
        spring.radial_stiffness_n_per_m *= m / l;
        spring.torsional_stiffness_nm_per_rad *= m * l;
    }
    if let DriveEntry::Tips(tips) = &mut file.drive {
        for path in &mut tips.paths {
            path.waypoints.iter_mut().for_each(|[time, x, y]| (*time, *x, *y) = (*time * t, *x * l, *y * l));
            path.release_s = path.release_s.map(|time| time * t);
        }
    }
    for obstacle in &mut file.obstacles {
        obstacle.position_m = obstacle.position_m.map(|position| position.map(|place| place * l));
        match &mut obstacle.outline {
            OutlineEntry::Disc(disc) => disc.radius_m *= l,
            OutlineEntry::Polyline(walls) => walls.points_m.iter_mut().for_each(|point| *point = point.map(|place| place * l)),
            other => panic!("discs and walls are scaled, found {other:?}"),
        }
    }
    let base = base().checked("base").expect("the base scene obeys the rules of the format");
    Cell { scenario: file.checked("cell"), asked: Asked { answer: Answer::Scaled { base: Box::new(base), length: l }, ..Asked::default() } }
}

/// Inertia in shares of m R^2; springs as stiff as makes the load slip at the paper's stretch.
fn gyration(share: f64, mass: f64) -> Cell {
    const N_STEPS: u32 = 60;
    let factor = mass / MASS;
    let mut spring = spring(0.0);
    spring.radial_stiffness_n_per_m *= factor;
    spring.torsional_stiffness_nm_per_rad *= factor;
    let tip = rest_tip(0.0);
    let mut scene =
        Scene::paper(1e-3, N_STEPS).pulled(spring, &[(0.0, tip), (f64::from(N_STEPS), tip + Vec2::new(0.5, 1.5) * SLIP_STRETCH)]);
    scene.load = load(mass);
    scene.load.inertia_kg_m2 = Some(share * mass * LOAD_RADIUS * LOAD_RADIUS);
    scene.supports.iter_mut().for_each(|support| support.normal_load_n = support.normal_load_n.map(|load| load * factor));
    scene.cell(Asked::finer())
}
