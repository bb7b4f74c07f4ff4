//! A progress bar on standard error: only on a terminal, and only for work that lasts.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Work shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);
/// Shortest interval between two updates of the bar.
const GLANCE: Duration = Duration::from_millis(10);

/// Progress of one run through simulated time. An update at every control tick costs little.
pub struct Progress {
    label: String,
    total: f64,
    /// Unit of the total; none for a share.
    unit: &'static str,
    started: Instant,
    display: Display,
    /// Age at the last update.
    updated: Duration,
}

enum Display {
    /// Standard error is no terminal.
    Off,
    /// Standard error is a terminal, and the work is not yet older than [`PATIENCE`].
    Waiting,
    On(ProgressBar),
}

impl Progress {
    /// Progress towards `total` (s, simulated), shown under `label`.
    pub fn start(total: f64, label: &str) -> Self {
        let display = if std::io::stderr().is_terminal() { Display::Waiting } else { Display::Off };
        Self { label: label.to_owned(), total, unit: "s", started: Instant::now(), display, updated: Duration::ZERO }
    }

    /// Progress of work that is measured by the fraction done (1).
    pub fn of_share(label: &str) -> Self {
        Self { unit: "", ..Self::start(1.0, label) }
    }

    /// Progress of work that is measured by the number of pieces done, of `total`. `unit` is the
    /// name of the pieces.
    pub fn of_count(total: u64, unit: &'static str, label: &str) -> Self {
        Self { unit, ..Self::start(total as f64, label) }
    }

    /// The run has reached `time` (s, simulated).
    pub fn at(&mut self, time: f64) {
        if matches!(self.display, Display::Off) {
            return;
        }
        let elapsed = self.started.elapsed();
        if elapsed >= self.updated + GLANCE {
            self.updated = elapsed;
            self.show(time, elapsed);
        }
    }

    /// The run is over: the bar vanishes.
    pub fn finish(self) {
        if let Display::On(bar) = self.display {
            bar.finish_and_clear();
        }
    }

    fn show(&mut self, time: f64, elapsed: Duration) {
        if matches!(self.display, Display::Waiting) && elapsed >= PATIENCE {
            self.display = Display::On(bar(&self.label));
        }
        if let Display::On(bar) = &self.display {
            bar.set_position((1000.0 * share(time, self.total)) as u64);
            bar.set_message(message(time, self.total, self.unit, elapsed));
        }
    }
}

/// A bar of a thousand parts, drawn at most ten times a second.
fn bar(label: &str) -> ProgressBar {
    let style = ProgressStyle::with_template("{prefix:.20} [{wide_bar}] {msg}").expect("the template is a constant").progress_chars("=> ");
    ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr_with_hz(10)).with_style(style).with_prefix(label.to_owned())
}

fn share(time: f64, total: f64) -> f64 {
    if total > 0.0 { (time / total).clamp(0.0, 1.0) } else { 1.0 }
}

/// Share of simulated time, rate, and time to come at that rate. A run of ants may end sooner.
fn message(time: f64, total: f64, unit: &str, elapsed: Duration) -> String {
    let rate = time / elapsed.as_secs_f64();
    let percent = 100.0 * share(time, total);
    let of_total = if unit.is_empty() { String::new() } else { format!(" of {total} {unit}") };
    if rate <= 0.0 || !rate.is_finite() {
        return format!("{percent:3.0} %{of_total}");
    }
    let left = ((total - time) / rate).max(0.0).ceil() as u64;
    let speed = if unit.is_empty() { String::new() } else { format!(", {rate:.3} {unit}/s") };
    format!("{percent:3.0} %{of_total}{speed}, {}:{:02} left", left / 60, left % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn progress(display: Display) -> Progress {
        Progress { display, ..Progress::start(300.0, "run") }
    }

    #[test]
    fn a_bar_comes_only_after_the_patience_is_over() {
        let mut watched = progress(Display::Waiting);
        watched.show(1.0, PATIENCE - Duration::from_millis(1));
        assert!(matches!(watched.display, Display::Waiting));
        watched.show(30.0, PATIENCE);
        let Display::On(bar) = &watched.display else { panic!("no bar") };
        assert_eq!(bar.position(), 100);
        watched.finish();
        let mut alone = progress(Display::Off);
        alone.show(30.0, 10 * PATIENCE);
        assert!(matches!(alone.display, Display::Off));
    }

    #[test]
    fn rate_and_remaining_time_follow_from_what_was_done() {
        // 60 s in 20 s: the other 240 s take 80 s.
        assert_eq!(message(60.0, 300.0, "s", Duration::from_secs(20)), " 20 % of 300 s, 3.000 s/s, 1:20 left");
        assert_eq!(message(0.5, 1.0, "", Duration::from_secs(20)), " 50 %, 0:20 left");
        assert_eq!(message(0.0, 300.0, "s", Duration::from_secs(20)), "  0 % of 300 s");
        assert_eq!(message(300.1, 300.0, "s", Duration::from_secs(20)), "100 % of 300 s, 15.005 s/s, 0:00 left");
        assert_eq!(share(0.0, 0.0), 1.0);
    }
}
