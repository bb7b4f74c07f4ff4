//! Small charts in the colours of a page: bars against a threshold, and means with their intervals.

use maud::{Markup, PreEscaped, html};

use crate::chart::axis::{power_label, range};
use crate::quantity::quantity;

/// A bar of a positive value; its text stands beside it.
pub struct Bar {
    pub name: String,
    pub value: f64,
    pub text: String,
}

/// Size of a chart, of its column of names, of a row and of what stands above and below (px).
const WIDTH: f64 = 620.0;
const NAMES: f64 = 150.0;
const VALUES: f64 = 104.0;
const ROW: f64 = 36.0;
const ABOVE: f64 = 26.0;
const BELOW: f64 = 24.0;

/// Bars on a logarithmic axis, with a line at the value `tolerated` and its text above. Bars beyond
/// the line have another colour.
pub fn bars(bars: &[Bar], tolerated: f64, tolerated_text: &str) -> String {
    let logarithms = bars.iter().map(|bar| bar.value).chain([tolerated]).filter(|value| *value > 0.0).map(f64::log10);
    let (low, high) = range(logarithms).map_or((0.0, 1.0), |(low, high)| ((low - 0.3).floor(), (high + 0.05).ceil()));
    let width = WIDTH - NAMES - VALUES;
    let at = |value: f64| NAMES + width * (value.log10() - low) / (high - low);
    let bottom = ABOVE + ROW * bars.len() as f64;
    let decades = (high - low) as i32;
    let ticks = (0..=decades).step_by((decades as usize).div_ceil(8).max(1));
    let tick = |decade: i32| {
        let x = NAMES + width * f64::from(decade) / f64::from(decades);
        html! {
            (path("grid", &format!("M{x:.1} {ABOVE}V{bottom}")))
            (label(x, bottom + 16.0, "middle", "small", &power_label(low + f64::from(decade))))
        }
    };
    let row = |(row, bar): (usize, &Bar)| {
        let (y, length) = (ABOVE + ROW * row as f64, if bar.value > 0.0 { at(bar.value) - NAMES } else { 0.0 });
        let class = if bar.value > tolerated { "beyond" } else { "within" };
        html! {
            (label(NAMES - 10.0, y + 0.5 * ROW + 4.5, "end", "", &bar.name))
            rect class=(class) x=(NAMES) y=(px(y + 7.0)) width=(px(length)) height=(px(ROW - 14.0)) rx="2" {}
            (label(WIDTH, y + 0.5 * ROW + 4.5, "end", "value", &bar.text))
        }
    };
    let threshold = (tolerated > 0.0).then(|| {
        let x = at(tolerated);
        html! {
            (path("threshold", &format!("M{x:.1} {:.1}V{bottom}", ABOVE - 6.0)))
            (label(x, ABOVE - 11.0, if x > 0.7 * WIDTH { "end" } else { "middle" }, "small", tolerated_text))
        }
    });
    svg(
        WIDTH,
        bottom + BELOW,
        html! { @for decade in ticks { (tick(decade)) } @for bar in bars.iter().enumerate() { (row(bar)) } @if let Some(line) = threshold { (line) } },
    )
}

/// One quantity over runs of several kinds.
pub struct Spread {
    pub name: String,
    pub unit: &'static str,
    pub lines: Vec<SpreadLine>,
}

/// Runs of one kind: values, and their mean with its interval where there is one.
pub struct SpreadLine {
    pub name: String,
    pub color: &'static str,
    pub values: Vec<f64>,
    pub mean: f64,
    pub interval: Option<[f64; 2]>,
    pub text: String,
}

const LINE: f64 = 24.0;
const BETWEEN: f64 = 16.0;
const TEXTS: f64 = 205.0;
const SPREAD_WIDTH: f64 = 840.0;

/// Dots for values, a bar for the interval of their mean and an upright for the mean itself. The
/// axis of each quantity has its own ends, which stand above it.
pub fn spreads(spreads: &[Spread]) -> String {
    let (mut y, mut drawn) = (0.0, Vec::new());
    let width = SPREAD_WIDTH - NAMES - TEXTS;
    for spread in spreads {
        let all = |line: &SpreadLine| {
            line.values.iter().copied().chain(line.interval.into_iter().flatten()).chain([line.mean]).collect::<Vec<_>>()
        };
        let (low, high) = range(spread.lines.iter().flat_map(all)).unwrap_or((0.0, 0.0));
        let at = |value: f64| NAMES + width * if high > low { (value - low) / (high - low) } else { 0.5 };
        drawn.push(label(0.0, y + 17.0, "start", "strong", &spread.name));
        if low < high {
            drawn.push(label(NAMES, y + 17.0, "start", "small", &quantity(low, spread.unit)));
            drawn.push(label(NAMES + width, y + 17.0, "end", "small", &quantity(high, spread.unit)));
        }
        for line in &spread.lines {
            y += LINE;
            drawn.push(spread_line(line, y + 0.5 * LINE, &at));
        }
        y += LINE + BETWEEN;
    }
    svg(SPREAD_WIDTH, y, html! { @for part in drawn { (part) } })
}

fn spread_line(line: &SpreadLine, y: f64, at: &dyn Fn(f64) -> f64) -> Markup {
    // Black on paper is the ink of the page.
    let color = if line.color == "#000000" { "var(--ink)" } else { line.color };
    html! {
        (path("grid", &format!("M{NAMES} {y}H{:.1}", SPREAD_WIDTH - TEXTS)))
        (label(NAMES - 10.0, y + 4.5, "end", "", &line.name))
        @if let Some([low, high]) = line.interval {
            path style={ "stroke:" (color) } stroke-width="7" stroke-opacity="0.4" d=(format!("M{:.1} {y}H{:.1}", at(low), at(high))) {}
        }
        @for value in &line.values {
            circle cx=(px(at(*value))) cy=(y) r="3.5" style={ "fill:" (color) } fill-opacity="0.75" {}
        }
        @if line.mean.is_finite() { (path("mean", &format!("M{:.1} {:.1}v16", at(line.mean), y - 8.0))) }
        (label(SPREAD_WIDTH, y + 4.5, "end", "value", &line.text))
    }
}

fn svg(width: f64, height: f64, content: Markup) -> String {
    html! { svg viewBox=(format!("0 0 {width} {height}")) width=(width) height=(height) { (PreEscaped(content.0)) } }.into_string()
}

fn path(class: &str, d: &str) -> Markup {
    html! { path class=(class) d=(d) {} }
}

fn label(x: f64, y: f64, anchor: &str, class: &str, content: &str) -> Markup {
    html! { text x=(px(x)) y=(px(y)) text-anchor=(anchor) class=(class) { (content) } }
}

fn px(value: f64) -> String {
    format!("{value:.1}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_beyond_the_threshold_look_otherwise_and_nothing_is_broken() {
        let bar = |value: f64| Bar { name: "a <name>".to_owned(), value, text: "a value".to_owned() };
        let chart = bars(&[bar(9e-3), bar(6e-3), bar(7e-7), bar(0.0)], 6.8e-3, "agreement");
        assert_eq!((chart.matches("class=\"beyond\"").count(), chart.matches("class=\"within\"").count()), (1, 3));
        assert!(chart.contains("a &lt;name&gt;"));
        for chart in
            [chart, bars(&[bar(0.0)], 0.0, "none"), bars(&[bar(1.0)], 1.0, "all the same"), bars(&[bar(1e-300), bar(1e300)], 1.0, "far")]
        {
            assert!(!chart.contains("NaN") && !chart.contains("inf") && !chart.contains("=\"-"), "{chart}");
        }
    }

    #[test]
    fn spreads_show_what_there_is() {
        let line = |values: &[f64], mean, interval| SpreadLine {
            name: "a run".to_owned(),
            color: "#000000",
            values: values.to_vec(),
            mean,
            interval,
            text: String::new(),
        };
        let lines = vec![line(&[1.0, 2.0, 3.0], 2.0, Some([1.2, 2.8])), line(&[2.5], 2.5, None), line(&[], f64::NAN, None)];
        let chart = spreads(&[
            Spread { name: "time".to_owned(), unit: "s", lines },
            Spread { name: "none".to_owned(), unit: "", lines: Vec::new() },
        ]);
        assert_eq!((chart.matches("<circle").count(), chart.matches("class=\"mean\"").count()), (4, 2));
        assert!(chart.contains(">1.000 s<") && chart.contains(">3.000 s<") && !chart.contains("NaN") && !chart.contains("inf"), "{chart}");
    }
}
