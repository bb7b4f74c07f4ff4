//! Hours of simulated time: what adds up over many coarse steps.

use super::super::map::{Asked, Axis, Cell, Map};
use super::super::scene::{Scene, rest_tip, spring};
use crate::verify::scenes::SLIP_STRETCH;
use cohaul::math::Vec2;

pub fn maps() -> Vec<Map> {
    let (step, time) = (|| Axis::log("step_s", 0.1, 1e3, 9), || Axis::log("time_h", 1.0, 1e3, 7));
    vec![
        Map { name: "hours-held", what: "a load is pulled by 0.9 of its limit for hours; it must stick", x: step(), y: time(), cell: held },
        Map {
            name: "hours-hauled",
            what: "a load is hauled ahead for hours, two stretches of slip in each; closed answer",
            x: step(),
            y: time(),
            cell: hauled,
        },
    ]
}

/// A whole number of steps near `hours`.
fn scene(step: f64, hours: f64) -> Scene {
    Scene::paper(step, (hours * 3600.0 / step).round().max(2.0) as u32)
}

/// Along x through the centre, where the limit is that of all supports together. The tip goes on by
/// a billionth of its stretch, so that no step is skipped.
fn held(step: f64, hours: f64) -> Cell {
    let scene = scene(step, hours);
    let (tip, n) = (rest_tip(0.0), f64::from(scene.n_steps));
    let at = |share: f64| tip + Vec2::new(share * SLIP_STRETCH, 0.0);
    scene.pulled(spring(0.0), &[(0.0, tip), (1.0, at(0.9)), (n, at(0.9 + 1e-9))]).cell(Asked {
        sticks: true,
        symmetric: true,
        ..Asked::default()
    })
}

/// Slower by far than the load swings: the inertia effect is below 1e-4 of the path length.
fn hauled(step: f64, hours: f64) -> Cell {
    let scene = scene(step, hours);
    let (tip, n) = (rest_tip(0.0), f64::from(scene.n_steps));
    let way = 2.0 * hours * SLIP_STRETCH;
    let known = way - SLIP_STRETCH;
    scene.pulled(spring(0.0), &[(0.0, tip), (n, tip + Vec2::new(way, 0.0))]).cell(Asked::shift(known, known, known))
}
