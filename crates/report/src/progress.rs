//! Progress of work that lasts, on standard error: a bar on a terminal, and elsewhere a line now
//! and then.
//!
//! The work only stores how far it is. A thread beside it looks at that and draws, also while the
//! work is in a piece that lasts long.

use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::thread::{self, Thread};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Work shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);
/// Interval between two updates of the bar.
const GLANCE: Duration = Duration::from_millis(100);
/// Time of the first line where there is no terminal. Each further one comes at twice the time of
/// the one before.
const FIRST_LINE: Duration = Duration::from_secs(5);
/// Share of the work (1) and its time from which on the rate of the work tells how long all of it
/// takes.
const FIRST_PERCENT: f64 = 0.01;
const FIRST_TIME: Duration = Duration::from_millis(300);
/// Time above which work is announced as long (s).
pub const LONG: f64 = 30.0;
/// Time over that of an announcement from which on work is announced again (1).
const FAR_LONGER: f64 = 4.0;

/// Progress of one piece of work.
pub struct Progress {
    label: String,
    /// Amount of the work; infinite where it is unknown.
    total: f64,
    /// Unit of the total; none for a share.
    unit: &'static str,
    /// Expected time of the whole work (s).
    expected: Option<f64>,
    /// Time that was announced before the work (s), for this and what comes with it.
    announced: f64,
}

impl Progress {
    /// Progress towards `total` (s, simulated), shown under `label`.
    pub fn start(total: f64, label: &str) -> Self {
        Self { label: label.to_owned(), total, unit: "s", expected: None, announced: 0.0 }
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

    /// Progress of work of which only the time is known that it has taken.
    pub fn of_unknown(label: &str) -> Self {
        Self { unit: "", ..Self::start(f64::INFINITY, label) }
    }

    /// The same for work that is expected to take this time (s).
    pub fn expecting(self, time_s: f64) -> Self {
        Self { expected: Some(time_s), announced: time_s, ..self }
    }

    /// The same for work that is a part of what is expected to take this time (s).
    pub fn as_part_of(self, time_s: f64) -> Self {
        Self { announced: time_s, ..self }
    }

    /// Runs `work`, which tells how much of it is done, and shows that. Work with an expected time
    /// that turns out to take long is announced by `too_long`, with the time of the whole of it
    /// (s).
    pub fn shown<T>(self, too_long: &(dyn Fn(f64) + Sync), work: impl FnOnce(&(dyn Fn(f64) + Sync)) -> T) -> T {
        /// Ends the thread that draws, also when the work unwinds.
        struct End<'a>(&'a AtomicBool, Thread);
        impl Drop for End<'_> {
            fn drop(&mut self) {
                self.0.store(true, Relaxed);
                self.1.unpark();
            }
        }
        let (done, has_ended) = (AtomicU64::new(0), AtomicBool::new(false));
        let draw = || {
            let (started, mut shown) = (Instant::now(), Shown::new(self, std::io::stderr().is_terminal()));
            loop {
                thread::park_timeout(shown.next(started.elapsed()));
                if has_ended.load(Relaxed) {
                    return shown.finish();
                }
                shown.look(f64::from_bits(done.load(Relaxed)), started.elapsed(), too_long);
            }
        };
        thread::scope(|scope| {
            // Work that cannot be shown is done all the same.
            let drawing = thread::Builder::new().name("progress".to_owned()).spawn_scoped(scope, draw);
            let _end = drawing.map(|drawing| End(&has_ended, drawing.thread().clone()));
            work(&|now| done.store(now.to_bits(), Relaxed))
        })
    }

    /// Share of the work (1) at this amount.
    fn share(&self, done: f64) -> f64 {
        if self.total > 0.0 { (done / self.total).clamp(0.0, 1.0) } else { 1.0 }
    }

    /// Time of the whole work (s), once its own rate tells it.
    fn measured(&self, done: f64, elapsed: Duration) -> Option<f64> {
        let share = self.share(done);
        (share >= FIRST_PERCENT && elapsed >= FIRST_TIME).then(|| elapsed.as_secs_f64() / share)
    }

    /// Time of the whole work (s) by its rate, or else as expected.
    fn whole(&self, done: f64, elapsed: Duration) -> Option<f64> {
        let share = self.share(done);
        let by_rate = || (share > 0.0).then(|| elapsed.as_secs_f64() / share);
        let expected = self.expected.filter(|time| *time > elapsed.as_secs_f64());
        self.measured(done, elapsed).or(expected).or_else(by_rate)
    }

    /// Share of the work, rate, and time that is left. A run of ants may end sooner.
    fn message(&self, done: f64, elapsed: Duration) -> String {
        if self.total == f64::INFINITY {
            return format!("{} so far", clock(elapsed.as_secs_f64()));
        }
        let (unit, percent, rate) = (self.unit, 100.0 * self.share(done), done / elapsed.as_secs_f64());
        let of_total = if unit.is_empty() { String::new() } else { format!(" of {} {unit}", self.total) };
        let speed = if unit.is_empty() || rate.is_nan() || rate <= 0.0 { String::new() } else { format!(", {rate:.3} {unit}/s") };
        let left = self.whole(done, elapsed).map(|whole| (whole - elapsed.as_secs_f64()).max(0.0));
        let left = left.map_or(String::new(), |left| format!(", {} left", clock(left.ceil())));
        format!("{percent:3.0} %{of_total}{speed}{left}")
    }
}

/// What is shown of progress.
struct Shown {
    progress: Progress,
    display: Display,
    /// Whether the work was announced as long since it began.
    is_announced: bool,
}

enum Display {
    /// Standard error is no terminal; the next line comes at this time.
    Lines(Duration),
    /// Standard error is a terminal, and the work is not yet older than [`PATIENCE`].
    Waiting,
    On(ProgressBar),
}

impl Shown {
    fn new(progress: Progress, is_terminal: bool) -> Self {
        Self { progress, display: if is_terminal { Display::Waiting } else { Display::Lines(FIRST_LINE) }, is_announced: false }
    }

    /// Time until the next look.
    fn next(&self, elapsed: Duration) -> Duration {
        match self.display {
            // The work may turn out to be long before the next line.
            Display::Lines(next) => next.saturating_sub(elapsed).clamp(GLANCE, PATIENCE),
            Display::Waiting => PATIENCE.saturating_sub(elapsed),
            Display::On(_) => GLANCE,
        }
    }

    fn look(&mut self, done: f64, elapsed: Duration, too_long: &dyn Fn(f64)) {
        if let Some(whole) = self.long(done, elapsed) {
            self.is_announced = true;
            match &self.display {
                Display::On(bar) => bar.suspend(|| too_long(whole)),
                _ => too_long(whole),
            }
        }
        let Self { progress, display, .. } = self;
        match display {
            Display::Lines(next) if elapsed >= *next => {
                // A closed standard error is no reason to end.
                let _ = writeln!(std::io::stderr(), "{}: {}", progress.label, progress.message(done, elapsed).trim_start());
                *next = 2 * elapsed;
            }
            Display::Waiting if elapsed >= PATIENCE => self.display = Display::On(bar(&progress.label)),
            _ => {}
        }
        if let Display::On(bar) = &self.display {
            bar.set_position((1000.0 * self.progress.share(done)) as u64);
            bar.set_message(self.progress.message(done, elapsed));
        }
    }

    /// Time of the whole work (s) where it is to be announced as long now.
    fn long(&self, done: f64, elapsed: Duration) -> Option<f64> {
        let announced = self.progress.expected.filter(|_| !self.is_announced).map(|_| self.progress.announced)?;
        let limit = if announced > LONG { FAR_LONGER * announced } else { LONG };
        let so_far = elapsed.as_secs_f64();
        let whole = match self.progress.measured(done, elapsed) {
            Some(whole) => whole,
            None if so_far > limit => self.progress.whole(done, elapsed).unwrap_or(so_far),
            None => return None,
        };
        (whole > limit).then_some(whole)
    }

    /// The work is over: the bar vanishes.
    fn finish(self) {
        if let Display::On(bar) = self.display {
            bar.finish_and_clear();
        }
    }
}

/// A bar of a thousand parts, drawn at most ten times a second.
fn bar(label: &str) -> ProgressBar {
    let style = ProgressStyle::with_template("{prefix:.20} [{wide_bar}] {msg}").expect("the template is a constant").progress_chars("=> ");
    ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr_with_hz(10)).with_style(style).with_prefix(label.to_owned())
}

/// Minutes and seconds, and hours where there are any.
fn clock(time_s: f64) -> String {
    let seconds = time_s as u64;
    let (hours, minutes, seconds) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    if hours > 0 { format!("{hours}:{minutes:02}:{seconds:02}") } else { format!("{minutes}:{seconds:02}") }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    const NOBODY: &dyn Fn(f64) = &|_| {};

    fn seconds(time_s: f64) -> Duration {
        Duration::from_secs_f64(time_s)
    }

    #[test]
    fn a_bar_comes_only_after_the_patience_is_over() {
        let mut shown = Shown::new(Progress::start(300.0, "run"), true);
        assert_eq!(shown.next(seconds(0.2)), seconds(0.8));
        shown.look(1.0, PATIENCE - Duration::from_millis(1), NOBODY);
        assert!(matches!(shown.display, Display::Waiting));
        shown.look(30.0, PATIENCE, NOBODY);
        let Display::On(bar) = &shown.display else { panic!("no bar") };
        assert_eq!(bar.position(), 100);
        shown.finish();
    }

    #[test]
    fn lines_come_ever_more_rarely() {
        let mut shown = Shown::new(Progress::start(300.0, "run"), false);
        let mut times = Vec::new();
        for tenth in 1..900 {
            let Display::Lines(before) = shown.display else { panic!("a bar") };
            shown.look(f64::from(tenth), seconds(0.1 * f64::from(tenth)), NOBODY);
            let Display::Lines(next) = shown.display else { panic!("a bar") };
            if next != before {
                times.push((0.1 * f64::from(tenth)).round() as u64);
            }
        }
        assert_eq!(times, [5, 10, 20, 40, 80]);
    }

    #[test]
    fn rate_and_remaining_time_follow_from_what_was_done() {
        let message = |progress: Progress, done, elapsed| progress.message(done, seconds(elapsed));
        let run = || Progress::start(300.0, "run");
        // 60 s in 20 s: the other 240 s take 80 s.
        assert_eq!(message(run(), 60.0, 20.0), " 20 % of 300 s, 3.000 s/s, 1:20 left");
        assert_eq!(message(Progress::of_share("run"), 0.5, 20.0), " 50 %, 0:20 left");
        assert_eq!(message(run(), 0.0, 20.0), "  0 % of 300 s");
        assert_eq!(message(run(), 300.1, 20.0), "100 % of 300 s, 15.005 s/s, 0:00 left");
        assert_eq!(message(Progress::of_unknown("fit"), 0.0, 4000.0), "1:06:40 so far");
        assert_eq!(Progress::start(0.0, "run").share(0.0), 1.0);
        // Before the first percent is done, the time is the expected one.
        assert_eq!(message(run().expecting(70.0), 0.3, 20.0), "  0 % of 300 s, 0.015 s/s, 0:50 left");
        assert_eq!(message(run().expecting(70.0), 60.0, 20.0), " 20 % of 300 s, 3.000 s/s, 1:20 left");
    }

    #[test]
    fn work_that_turns_out_to_be_long_is_announced_once() {
        let announced = |expected: Option<f64>, looks: &[(f64, f64)]| {
            let run = Progress::start(100.0, "run");
            let progress = if let Some(time_s) = expected { run.expecting(time_s) } else { run };
            let (mut shown, whole) = (Shown::new(progress, false), Cell::new(0.0));
            looks.iter().for_each(|(done, elapsed)| shown.look(*done, seconds(*elapsed), &|time| whole.set(whole.get() + time)));
            whole.get()
        };
        // A percent in half a second is 50 s in all.
        assert_eq!(announced(Some(1.0), &[(0.9, 0.45), (1.0, 0.5), (2.0, 1.0)]), 50.0);
        assert_eq!(announced(Some(1.0), &[(1.0, 0.2), (10.0, 2.0)]), 0.0, "20 s are not long");
        assert_eq!(announced(Some(40.0), &[(10.0, 5.0)]), 0.0, "it was announced before the run");
        assert_eq!(announced(Some(40.0), &[(10.0, 50.0)]), 500.0, "but it is far longer");
        assert_eq!(announced(Some(1.0), &[(0.0, 29.0), (0.0, 31.0)]), 31.0, "nothing is done in half a minute");
        assert_eq!(announced(None, &[(1.0, 50.0)]), 0.0, "a study is long");
    }

    #[test]
    fn the_thread_that_draws_ends_with_the_work() {
        let shown = Progress::of_share("work").shown(&|_| {}, |at| {
            at(0.5);
            7
        });
        assert_eq!(shown, 7);
        let stop = cohaul::stop::Stop::default();
        stop.ask();
        assert!(stop.run(|| Progress::of_share("work").shown(&|_| {}, |_| cohaul::stop::point())).is_none());
    }
}
