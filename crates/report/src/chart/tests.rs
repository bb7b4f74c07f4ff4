use crate::chart::*;
use crate::synthetic;
use cohaul::math::{Pose, Vec2};
use cohaul::model::{Obstacle, ObstaclePath, Outline, OutlinePart, World};
use cohaul::simulation::Trace;

fn scene() -> Scene {
    let nest = Nest { position: Vec2::new(0.2625, 0.0), arrival_radius: 0.01 };
    let world = World { outline: Outline::disc(0.0122), obstacles: Vec::new() };
    Scene { world, slip_limit: 0.022, nest: Some(nest), radius: 0.0122, tolerances: Some([1e-3, 0.1]) }
}

fn all(traces: &[Labelled]) -> [(&'static str, String); 3] {
    [("path", path(traces, &scene())), ("position-difference", edge_difference(traces, &scene())), ("overview", overview(traces, &scene()))]
}

#[test]
fn long_runs_make_small_figures_without_a_number_that_is_not_finite() {
    // As many rows as 300 s at 2.5 ms have.
    let (a, b, c) = (synthetic::trace(120_000, 1.0), synthetic::trace(120_000, 1.003), synthetic::trace(119_000, 1.0031));
    let traces =
        [Labelled { label: "quasi-static", trace: &a }, Labelled { label: "inertial", trace: &b }, Labelled { label: "rapier", trace: &c }];
    for (name, svg) in all(&traces) {
        assert!(svg.len() < 500_000, "{name}: {} bytes", svg.len());
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{name}");
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>"), "{name}");
        assert!(!svg.contains("<script") && !svg.contains("@font-face"), "{name}");
    }
}

#[test]
fn short_runs_show_their_events_and_the_same_traces_give_the_same_bytes() {
    let (a, mut b) = (synthetic::trace(800, 1.0), synthetic::trace(800, 1.001));
    // A jump as a method without inertia makes it: one row of high speed.
    b.rows[500].motion.twist.linear *= 300.0;
    let traces = [Labelled { label: "quasi-static", trace: &a }, Labelled { label: "inertial", trace: &b }];
    let figures = all(&traces);
    let one = [Labelled { label: "a < b & \"c\" $d$", trace: &a }];
    assert!(figures[2].1.contains("peaks up to"));
    assert!(figures[1].1.contains(">release<"));
    assert!(overview(&one, &scene()).contains("a &lt; b &amp; &quot;c&quot; $d$"));
    for ((name, svg), (_, again)) in figures.iter().zip(&all(&traces)) {
        assert!(svg == again, "{name}");
    }
}

#[test]
fn nothing_and_broken_rows_are_drawn_as_gaps() {
    let empty = Trace::default();
    let mut broken = synthetic::trace(50, 1.0);
    broken.rows[20].motion.pose.position.x = f64::NAN;
    broken.rows[21].motion.twist.linear.y = f64::INFINITY;
    for traces in [vec![], vec![Labelled { label: "empty", trace: &empty }], vec![Labelled { label: "broken", trace: &broken }; 2]] {
        for (name, svg) in all(&traces) {
            assert!(svg.starts_with("<svg") && !svg.contains("NaN") && !svg.contains("inf\""), "{name}");
        }
    }
}

/// A wall of ten metres beside a path of a few hundred millimetres leaves the axes to the path: it
/// is cut one radius of the load from where the load was.
#[test]
fn a_long_wall_is_cut_near_the_path() {
    let trace = synthetic::trace(800, 1.0);
    let seen = Seen::all(&[Labelled { label: "one", trace: &trace }]);
    let wall = OutlinePart::Polyline { points: vec![Vec2::new(-5.0, -0.02), Vec2::new(5.0, -0.02)] };
    let path = ObstaclePath::fixed(Pose::new(0.0, 0.0, 0.0));
    let outline = Outline { parts: vec![wall] };
    let wall = Obstacle { name: "wall".into(), outline, friction_coefficient: 0.0, restitution: 0.0, path };
    let scene = |obstacles| Scene { world: World { outline: Outline::disc(0.0122), obstacles }, ..scene() };
    let range = |scene: &Scene| {
        let panel = panels::path(&seen, scene);
        let xs: Vec<f64> =
            panel.curves.iter().filter(|curve| curve.style != Style::NEST).flat_map(|curve| &curve.points).map(|point| point[0]).collect();
        let finite = || xs.iter().copied().filter(|x| x.is_finite());
        [finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max)]
    };
    let ([low, high], [low_with, high_with]) = (range(&scene(Vec::new())), range(&scene(vec![wall])));
    // Roundings of millimetres.
    assert!((low - low_with - 12.2).abs() < 1e-9 && (high_with - high - 12.2).abs() < 1e-9, "{low_with} {high_with}");
}
