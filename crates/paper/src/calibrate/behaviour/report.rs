//! The result of `calibrate behaviour`: values, text, figure and table.

use std::fmt::Write;
use std::path::Path;

use serde::Serialize;

use super::attachments::{Attachment, Attachments};
use super::holds::{Bin, HoldFit, aged_exposures, exposures, fit as fit_holds};
use super::profile::Parameter;
use super::steering::{LEAST_NOISE, SteeringFit, fit as fit_steering};
use crate::calibrate::text::percent;
use cohaul::formats::{self, Format, Versioned};
use cohaul::math::Vec2;
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
    /// Whether the table has a column of events.
    pub has_events: bool,
    /// Number of releases that follow from a tip that sprang back within a frame (1).
    pub n_releases_by_spring_back: usize,
    /// Number of gaps within attachments that were bridged (1).
    pub n_gaps_bridged: usize,
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
/// Share of the work that is the fit of the release law (1).
const OF_RELEASES: f64 = 0.2;
/// Noise of the pulls, in units of 1/zeta, above which it flattens the release law by more than a
/// few percent.
const NOISY: f64 = 0.3;

/// What is asked about the ants of a recording.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    pub pace: ReleasePace,
    /// Known time between two release decisions (s).
    pub decision_period: Option<f64>,
    /// Position of the nest (m).
    pub nest: Option<Vec2>,
    /// Stated standard deviation of a tip along either axis (m).
    pub tip_error: f64,
    /// Larger relative standard error of the two stiffnesses (1).
    pub stiffness_error: f64,
    /// Confidence of the intervals (1).
    pub level: f64,
}

/// Residuals over the noise between frames (1) from which on the fit leaves more than noise: the
/// ratio of the two scatters by 2 % over a thousand frames.
const MORE_THAN_NOISE: f64 = 1.2;

impl BehaviourReport {
    /// Fits release law and steering to the attachments of a recording. `done` receives the share
    /// of the work done (1). `None` if the pace needs a decision period and none is known.
    pub fn fitted(found: &Attachments, asked: &Asked, done: &dyn Fn(f64)) -> Option<Self> {
        let all = &found.all;
        let exposures = match (asked.pace, asked.decision_period) {
            (ReleasePace::Hazard, _) => exposures(all),
            (_, Some(period)) => aged_exposures(all, period),
            (_, None) => return None,
        };
        let total: f64 = all.iter().map(Attachment::duration).sum();
        let release = fit_holds(&exposures, asked.decision_period, asked.level);
        done(OF_RELEASES);
        let rest = |share: f64| done(OF_RELEASES + (1.0 - OF_RELEASES) * share);
        let mut report = Self {
            pace: asked.pace,
            confidence: asked.level,
            n_attachments: all.len(),
            n_releases: all.iter().filter(|own| own.release.is_some()).count(),
            mean_duration_s: if all.is_empty() { 0.0 } else { total / all.len() as f64 },
            has_events: found.has_events,
            n_releases_by_spring_back: found.n_sprung,
            n_gaps_bridged: found.n_bridged,
            release,
            steering: asked.nest.and_then(|nest| fit_steering(all, nest, asked.tip_error, asked.level, &rest)),
            tip_noise_m: asked.tip_error,
            warnings: Vec::new(),
        };
        report.warn_of_reading(found);
        report.warn_of_release(pull_noise(all), asked.stiffness_error);
        report.warn_of_steering();
        Some(report)
    }

    /// The six parameters with the names that are printed.
    pub fn parameters(&self) -> Vec<(&'static str, &Parameter)> {
        let release =
            self.release.iter().flat_map(|of| [("zeta", &of.steepness_per_n), ("F_m", &of.strong_pull_n), ("D_r", &of.decision_period_s)]);
        let steering = self
            .steering
            .iter()
            .flat_map(|of| [("k", &of.steering_gain_per_s), ("beta", &of.steering_half_angle_rad), ("pull speed", &of.pull_speed_m_per_s)]);
        release.chain(steering).collect()
    }

    fn warn_of_reading(&mut self, found: &Attachments) {
        if !found.has_events && self.n_releases > 0 {
            let (n, reach) = (found.n_sprung, quantity(found.reach, "m"));
            self.warnings.push(format!(
                "no column event: releases by tips that sprang back within a frame: {n}; a release within {reach} of the \
                 place at rest is not seen"
            ));
        }
        if found.n_bridged > 0 {
            let n = found.n_bridged;
            self.warnings.push(format!("bridged gaps of a few frames, after which the tip came back where an ant walks to: {n}"));
        }
        let collapsed: Vec<&str> = self.parameters().iter().filter(|(_, found)| found.is_collapsed()).map(|(name, _)| *name).collect();
        if !collapsed.is_empty() {
            self.warnings.push(format!("the interval of {} has no width: its ends were not found", collapsed.join(", ")));
        }
    }

    /// `pull_sd` is the noise of the pulls (N).
    fn warn_of_release(&mut self, pull_sd: f64, stiffness_error: f64) {
        let Some(found) = &self.release else { return };
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

    fn warn_of_steering(&mut self) {
        let Some(found) = &self.steering else { return };
        if let Some(p) = found.p_value.filter(|p| *p < UNLIKELY) {
            self.warnings.push(format!("the paths of the tips are farther from the fit than the stated noise: p = {}", number(p)));
        }
        if found.residual_rms_m > MORE_THAN_NOISE * found.noise_between_frames_m {
            let [rms, noise] = [found.residual_rms_m, found.noise_between_frames_m].map(|length| quantity(length, "m"));
            self.warnings.push(format!(
                "the paths of the tips are {rms} from the fit, and the noise between frames is {noise}: releases are missing, or ants \
                 steer otherwise; intervals of k, beta and the speed are too narrow"
            ));
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
                if found.residual_rms_m < LEAST_NOISE {
                    line("  intervals", "those of 1 nm of noise".to_owned());
                }
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
    let Some(value) = found.value else { return limits };
    match found.low.zip(found.high) {
        // More digits than are shown are known.
        Some((low, high)) if shown(low) == shown(high) => format!("{} +- {} %", shown(value), number(100.0 * 0.5 * (high - low) / value)),
        _ => format!("{}; {limits}", shown(value)),
    }
}

/// Root mean square of the noise of the pulls that comes from the tips (N).
fn pull_noise(found: &[Attachment]) -> f64 {
    let all = || found.iter().flat_map(|own| &own.held);
    let squares: f64 = all().map(|held| held.pull_sd * held.pull_sd).sum();
    (squares / all().count().max(1) as f64).sqrt()
}

const LAW: Style = Style { color: "#0072B2", dash: "", width: 1.8 };
const COUNTED: Style = Style { color: "#000000", dash: "", width: 1.0 };

/// Release rate against the pull: counted in bins, with 95 % intervals, and the fitted law.
pub fn figure(found: &HoldFit, pace: ReleasePace) -> String {
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

/// Releases in bins of the pull.
pub fn table(found: &HoldFit) -> Table {
    Table::of(
        &found.bins,
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
        folder.write("releases.csv", |out| table(release).write_csv(out))?;
        folder.write("releases.svg", |out| out.write_all(figure(release, found.pace).as_bytes()))?;
    }
    folder.finish(manifest)
}
