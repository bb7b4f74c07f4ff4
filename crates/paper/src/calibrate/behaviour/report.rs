//! The result of `calibrate behaviour`: values, text, figure and table.

use std::fmt::Write;
use std::path::Path;

use serde::Serialize;

use super::holds::{Bin, HoldFit};
use super::profile::Parameter;
use super::steering::SteeringFit;
use crate::calibrate::text::percent;
use cohaul::formats::{self, Format, Versioned};
use cohaul::model::behaviour::ReleasePace;
use cohaul_report::chart::panel::{Entry, Panel, Scale, Shape, Style};
use cohaul_report::chart::{MILLI, TIME_HEIGHT, WIDTH, grid};
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::manifest::Manifest;
use cohaul_report::quantity::{number, quantity};
use cohaul_report::table::Table;

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BehaviourReport {
    pub pace: ReleasePace,
    pub confidence: f64,
    pub n_attachments: usize,
    pub n_releases: usize,
    pub mean_duration_s: f64,
    /// `null` without a release.
    pub release: Option<HoldFit>,
    /// `null` without a nest, or without tips in world axes.
    pub steering: Option<SteeringFit>,
    pub tip_noise_m: f64,
    pub warnings: Vec<String>,
}

impl Versioned for BehaviourReport {
    const FORMAT: Format = formats::CALIBRATE_BEHAVIOUR;
}

/// p-value below which a law does not fit.
const UNLIKELY: f64 = 0.01;
/// Noise of the pulls, in units of 1/zeta, above which it flattens the release law by more than a
/// few percent.
const NOISY: f64 = 0.3;

impl BehaviourReport {
    /// Adds warnings about the fit. `pull_sd` is the noise of the pulls (N), and `stiffness_error`
    /// the relative standard error of the stiffnesses (1).
    pub fn warn(&mut self, pull_sd: f64, stiffness_error: f64) {
        if let Some(found) = &self.release {
            if let Some(p) = found.p_value.filter(|p| *p < UNLIKELY) {
                self.warnings.push(format!("the release law does not fit: p = {} that bins of the pull differ as much", number(p)));
            }
            if pull_sd * found.law.steepness > NOISY {
                let noise = quantity(pull_sd, "N");
                self.warnings.push(format!("the noise of the pulls, {noise}, is not small beside 1/zeta: the fitted law is too flat"));
            }
            if stiffness_error > 0.0 {
                let share = number(percent(stiffness_error));
                self.warnings
                    .push(format!("the stiffnesses have a standard error of {share} %, which F_m and 1/zeta share beyond their intervals"));
            }
        }
        if let Some(p) = self.steering.as_ref().and_then(|found| found.p_value).filter(|p| *p < UNLIKELY) {
            self.warnings.push(format!("the paths of the tips are farther from the fit than the stated noise: p = {}", number(p)));
        }
    }

    pub fn text(&self) -> String {
        let mut text = String::new();
        let mut line = |name: &str, value: String| writeln!(text, "{name:<18}{value}").expect("a string takes all");
        let (n, released) = (self.n_attachments, self.n_releases);
        line("attachments", format!("{n}, of which {released} end with a release; {} on average", quantity(self.mean_duration_s, "s")));
        line("intervals", format!("{} %", percent(self.confidence)));
        match &self.release {
            None => line("release law", "not fitted: the table has no release under a pull".to_owned()),
            Some(found) => {
                line("zeta", parameter(&found.steepness_per_n, |value| format!("{} 1/N", number(value))));
                line("F_m", parameter(&found.strong_pull_n, |value| quantity(value, "N")));
                line("D_r", parameter(&found.decision_period_s, |value| quantity(value, "s")));
                if let (Some(chi), Some(p)) = (found.chi_squared, found.p_value) {
                    let n = found.bins.len();
                    line("  check of fit", format!("chi^2 {} in {n} bins of the pull, p = {}", number(chi), number(p)));
                }
            }
        }
        match &self.steering {
            None => line("steering", "not fitted: it needs a nest, and tips in world axes".to_owned()),
            Some(found) => {
                line("k", parameter(&found.steering_gain_per_s, |value| format!("{} 1/s", number(value))));
                line("beta", parameter(&found.steering_half_angle_rad, |value| quantity(value, "rad")));
                line("pull speed", parameter(&found.pull_speed_m_per_s, |value| quantity(value, "m/s")));
                let stated = if self.tip_noise_m > 0.0 { quantity(self.tip_noise_m, "m") } else { "none".to_owned() };
                line("  check of fit", format!("residuals {} rms, stated noise {stated}", quantity(found.residual_rms_m, "m")));
            }
        }
        line("not in the table", "speed in Search, sensing range, grasp probability".to_owned());
        text
    }
}

/// A parameter with its interval.
fn parameter(found: &Parameter, shown: impl Fn(f64) -> String) -> String {
    if let (true, Some(value)) = (found.is_given, found.value) {
        return format!("{}, given", shown(value));
    }
    let limits = match (found.low, found.high) {
        (Some(low), Some(high)) => format!("{} to {}", shown(low), shown(high)),
        (Some(low), None) => format!("{} or more", shown(low)),
        (None, Some(high)) => format!("{} or less", shown(high)),
        (None, None) => return "not determined by this recording".to_owned(),
    };
    found.value.map_or(limits.clone(), |value| format!("{}; {limits}", shown(value)))
}

const LAW: Style = Style { color: "#0072B2", dash: "", width: 1.8 };
const COUNTED: Style = Style { color: "#000000", dash: "", width: 1.0 };

/// Release rate against the pull: counted in bins, with 95 % intervals, and the fitted law.
fn figure(found: &HoldFit, pace: ReleasePace) -> String {
    const N: usize = 200;
    let mut panel = Panel::new("pull (mN)", "release rate (1/s)", Scale::FromZero);
    let most = found.bins.last().map_or(0.0, |bin| bin.pull_high_n);
    let rate =
        |pull: f64| if pace == ReleasePace::Hazard { found.law.hazard(pull) } else { found.law.probability(pull) / found.law.period };
    // A Poisson count of n has about the interval (sqrt n -+ 1)^2.
    let ends = |bin: &Bin| [-1.0, 1.0].map(|side| ((bin.n_releases as f64).sqrt() + side).max(0.0).powi(2) / bin.duration_s);
    let shown = most.min(found.bins.last().map_or(0.0, |bin| 2.0 * bin.mean_pull_n));
    let law = (0..=N).map(|i| shown * i as f64 / N as f64).map(|pull| [MILLI * pull, rate(pull)]).collect();
    let bars = found.bins.iter().flat_map(|bin| {
        let [low, high] = ends(bin);
        let at = MILLI * bin.mean_pull_n;
        [[at, low], [at, high], [f64::NAN; 2]]
    });
    let dots = found.bins.iter().map(|bin| [MILLI * bin.mean_pull_n, bin.n_releases as f64 / bin.duration_s]).collect();
    panel.add(law, LAW, Shape::Path);
    panel.add(bars.collect(), COUNTED, Shape::Path);
    panel.add(dots, COUNTED, Shape::Dots);
    let legend = vec![Entry::line("fitted law, Eq. (18)", LAW), Entry::dot("counted in bins of the pull, with 95 % intervals", COUNTED)];
    grid(&[panel], &[legend], 1, WIDTH, TIME_HEIGHT)
}

fn bin_table(bins: &[Bin]) -> Table {
    Table::of(
        bins,
        &[
            ("pull low", "N", &|bin| bin.pull_low_n.into()),
            ("pull high", "N", &|bin| bin.pull_high_n.into()),
            ("mean pull", "N", &|bin| bin.mean_pull_n.into()),
            ("duration", "s", &|bin| bin.duration_s.into()),
            ("releases", "", &|bin| bin.n_releases.into()),
            ("expected releases", "", &|bin| bin.n_expected.into()),
        ],
    )
}

/// Writes `behaviour.json`, `behaviour.txt`, `releases.csv`, `releases.svg` and `manifest.json` to
/// the folder `target`, all or nothing.
///
/// # Errors
/// When the folder may not be written, a number is not finite, or the disk fails.
pub fn write_behaviour(target: &Path, found: &BehaviourReport, manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write_json("behaviour.json", found)?;
    folder.write("behaviour.txt", |out| out.write_all(found.text().as_bytes()))?;
    if let Some(release) = &found.release {
        folder.write("releases.csv", |out| bin_table(&release.bins).write_csv(out))?;
        folder.write("releases.svg", |out| out.write_all(figure(release, found.pace).as_bytes()))?;
    }
    folder.finish(manifest)
}
