//! Small charts in the colours of the page: bars against a threshold, and means with their intervals.

use crate::output::chart::axis::power_label;
use crate::output::page::escape::text;
use crate::output::quantity::quantity;

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

/// Bars on a logarithmic axis, with a line at what is `tolerated` and its text above. Bars beyond it look otherwise than those within.
pub fn bars(bars: &[Bar], tolerated: f64, tolerated_text: &str) -> String {
    let positive = bars.iter().map(|bar| bar.value).chain([tolerated]).filter(|value| *value > 0.0 && value.is_finite()).map(f64::log10);
    let (low, high) = positive.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    let (low, high) = if low <= high { ((low - 0.3).floor(), (high + 0.05).ceil()) } else { (0.0, 1.0) };
    let width = WIDTH - NAMES - VALUES;
    let at = |value: f64| NAMES + width * (value.log10() - low) / (high - low);
    let bottom = ABOVE + ROW * bars.len() as f64;
    let mut svg = head(WIDTH, bottom + BELOW);
    let decades = (high - low) as i32;
    for decade in (0..=decades).step_by((decades as usize).div_ceil(8).max(1)) {
        let (exponent, x) = (low + f64::from(decade), NAMES + width * f64::from(decade) / f64::from(decades));
        svg.push_str(&format!("<path class=\"grid\" d=\"M{x:.1} {ABOVE}V{bottom}\"/>"));
        svg.push_str(&label(x, bottom + 16.0, "middle", "small", &power_label(exponent)));
    }
    for (row, bar) in bars.iter().enumerate() {
        let (y, middle) = (ABOVE + ROW * row as f64, ABOVE + ROW * (row as f64 + 0.5) + 4.5);
        svg.push_str(&label(NAMES - 10.0, middle, "end", "", &bar.name));
        let end = if bar.value > 0.0 { at(bar.value) } else { NAMES };
        let class = if bar.value > tolerated { "beyond" } else { "within" };
        svg.push_str(&format!(
            "<rect class=\"{class}\" x=\"{NAMES}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"2\"/>",
            y + 7.0,
            end - NAMES,
            ROW - 14.0
        ));
        svg.push_str(&label(WIDTH, middle, "end", "value", &bar.text));
    }
    if tolerated > 0.0 {
        let x = at(tolerated);
        svg.push_str(&format!("<path class=\"threshold\" d=\"M{x:.1} {:.1}V{bottom}\"/>", ABOVE - 6.0));
        let anchor = if x > 0.7 * WIDTH { "end" } else { "middle" };
        svg.push_str(&label(x, ABOVE - 11.0, anchor, "small", tolerated_text));
    }
    svg.push_str("</svg>");
    svg
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

/// Dots for values, a bar for the interval of their mean and an upright for the mean itself; the axis of each quantity has its own ends, which stand above it.
pub fn spreads(spreads: &[Spread]) -> String {
    let height: f64 = spreads.iter().map(|spread| LINE * (spread.lines.len() + 1) as f64 + BETWEEN).sum();
    let mut svg = head(SPREAD_WIDTH, height);
    let width = SPREAD_WIDTH - NAMES - TEXTS;
    let mut y = 0.0;
    for spread in spreads {
        let all =
            spread.lines.iter().flat_map(|line| line.values.iter().copied().chain(line.interval.into_iter().flatten()).chain([line.mean]));
        let finite = all.filter(|value| value.is_finite());
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        let at = |value: f64| NAMES + width * if high > low { (value - low) / (high - low) } else { 0.5 };
        svg.push_str(&label(0.0, y + 17.0, "start", "strong", &spread.name));
        if low < high {
            svg.push_str(&label(NAMES, y + 17.0, "start", "small", &quantity(low, spread.unit)));
            svg.push_str(&label(NAMES + width, y + 17.0, "end", "small", &quantity(high, spread.unit)));
        }
        for line in &spread.lines {
            y += LINE;
            spread_line(&mut svg, line, y + 0.5 * LINE, &at);
        }
        y += LINE + BETWEEN;
    }
    svg.push_str("</svg>");
    svg
}

fn spread_line(svg: &mut String, line: &SpreadLine, y: f64, at: &dyn Fn(f64) -> f64) {
    // What is black on paper goes with the page's ink.
    let color = if line.color == "#000000" { "var(--ink)" } else { line.color };
    svg.push_str(&format!("<path class=\"grid\" d=\"M{NAMES} {y}H{:.1}\"/>", SPREAD_WIDTH - TEXTS));
    svg.push_str(&label(NAMES - 10.0, y + 4.5, "end", "", &line.name));
    if let Some([low, high]) = line.interval {
        let (from, to) = (at(low), at(high));
        svg.push_str(&format!("<path style=\"stroke:{color}\" stroke-width=\"7\" stroke-opacity=\"0.4\" d=\"M{from:.1} {y}H{to:.1}\"/>"));
    }
    for value in &line.values {
        svg.push_str(&format!("<circle cx=\"{:.1}\" cy=\"{y}\" r=\"3.5\" style=\"fill:{color}\" fill-opacity=\"0.75\"/>", at(*value)));
    }
    if line.mean.is_finite() {
        svg.push_str(&format!("<path class=\"mean\" d=\"M{:.1} {:.1}v16\"/>", at(line.mean), y - 8.0));
    }
    svg.push_str(&label(SPREAD_WIDTH, y + 4.5, "end", "value", &line.text));
}

fn head(width: f64, height: f64) -> String {
    format!("<svg viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\">")
}

fn label(x: f64, y: f64, anchor: &str, class: &str, content: &str) -> String {
    format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" class=\"{class}\">{}</text>", text(content))
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
