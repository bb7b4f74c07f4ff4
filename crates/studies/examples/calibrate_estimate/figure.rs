//! Scatter plot of estimated over measured inertia effects, in decades.

use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::plot::{LinePlot, LineStyle, ScatterPlot};
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::render::render::render_multiple;

use super::scene::{Class, Found};

const LOW: f64 = -8.0;
const HIGH: f64 = 0.0;

pub fn scatter(found: &[Found]) -> String {
    let mut plots: Vec<Plot> = vec![diagonal(1.0, "", "equal", "#000000")];
    for (factor, dash, label) in [(2.0f64, "6 3", "factor 2"), (5.0, "2 3", "factor 5")] {
        plots.push(diagonal(factor, dash, label, "#777777"));
        plots.push(diagonal(1.0 / factor, dash, "", "#777777"));
    }
    for (label, color, keep) in classes() {
        let shown = found.iter().filter(|scene| scene.is_certain() && scene.estimate.edge_displacement_max_m > 0.0 && keep(scene));
        let points = shown.map(|scene| (scene.measured.log10(), scene.estimate.edge_displacement_max_m.log10()));
        plots.push(ScatterPlot::new().with_data(points).with_color(color).with_size(2.6).with_legend(label).into());
    }
    let ticks = TickFormat::Custom(Arc::new(|value: f64| format!("1e{value:.0}")));
    let mut layout = Layout::new((LOW, HIGH), (LOW, HIGH))
        .with_width(760.0)
        .with_height(560.0)
        .with_x_axis_min(LOW)
        .with_x_axis_max(HIGH)
        .with_y_axis_min(LOW)
        .with_y_axis_max(HIGH)
        .with_x_tick_step(1.0)
        .with_y_tick_step(1.0)
        .with_x_tick_format(ticks.clone())
        .with_y_tick_format(ticks)
        .with_x_label("measured inertia effect, max. edge displacement (m)")
        .with_y_label("estimated from the quasi-static run (m)")
        .with_show_grid(false);
    layout.show_legend = true;
    SvgBackend::new().render_scene(&render_multiple(plots, layout))
}

type Keep = fn(&Found) -> bool;

/// Random scenes by the trigger of their largest effect, scenes of ants, and stored scenes; colours
/// of Okabe and Ito.
fn classes() -> [(&'static str, &'static str, Keep); 5] {
    fn tips(scene: &Found, kind: &str) -> bool {
        scene.class == Class::Random && !scene.has_ants && scene.kind() == kind
    }
    [
        ("driving", "#0072B2", |scene| tips(scene, "driving")),
        ("jumps", "#D55E00", |scene| tips(scene, "jump")),
        ("starts", "#009E73", |scene| tips(scene, "start")),
        ("ants", "#CC79A7", |scene| scene.class == Class::Random && scene.has_ants),
        ("stored", "#000000", |scene| scene.class == Class::Stored),
    ]
}

fn diagonal(factor: f64, dash: &str, label: &str, color: &str) -> Plot {
    let shift = factor.log10();
    let ends = [(LOW.max(LOW - shift), LOW.max(LOW + shift)), (HIGH.min(HIGH - shift), HIGH.min(HIGH + shift))];
    let style = if dash.is_empty() { LineStyle::Solid } else { LineStyle::Custom(dash.to_owned()) };
    let line = LinePlot::new().with_data(ends).with_color(color).with_stroke_width(1.0).with_line_style(style);
    if label.is_empty() { line.into() } else { line.with_legend(label).into() }
}
