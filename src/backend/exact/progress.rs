//! Where an advance under error control is: the next macro-step, and the work that it took.

use super::control::Pace;
use super::load::{Exact, Method};
use crate::backend::numerics::{GROWTH_AFTER_MANY, MANY_A_MACRO_STEP, MANY_ATTEMPTS, MOST_CUTS, SOLVES_AN_ATTEMPT, TOWARDS_JUMP};
use crate::backend::report::{Status, StepReport};

/// Where an advance is, and what it knows of what comes. Lengths are shares of the advance (1).
pub struct Progress {
    pub at: f64,
    pub macro_step: f64,
    pub shortest: f64,
    /// Share by which the contact mode changes, once that is known.
    pub change_by: Option<f64>,
    /// Share by which the load is out of balance, once that is known.
    jump_by: f64,
    /// Macro-step that may lead to a jump.
    pub to_jump: f64,
    /// Whether all macro-steps that were taken as they were had an answer.
    pub had_answers: bool,
}

impl Progress {
    pub fn new(pace: &Pace, duration: f64, longest: f64) -> Self {
        let (macro_step, shortest) = (pace.macro_step / duration, pace.shortest.min(longest));
        Self { at: 0.0, macro_step, shortest, change_by: None, jump_by: 0.0, to_jump: 0.0, had_answers: true }
    }

    /// Goes on from the end of a macro-step, with one that is longer by the factor `growth`.
    pub fn take(&mut self, to: f64, growth: f64) {
        let length = to - self.at;
        self.change_by = self.change_by.filter(|change| *change > to);
        let was_cut = length < 0.99 * self.macro_step;
        self.macro_step = match self.change_by {
            Some(change) => change - to,
            None if to < self.jump_by => (length * growth).min(length.max(TOWARDS_JUMP * (self.jump_by - to))),
            None => (length * growth).max(if was_cut { self.macro_step } else { 0.0 }),
        };
        (self.at, self.to_jump) = (to, 0.0);
    }

    /// Looks for the last balance before this share, or, where that has been found, for a jump
    /// beyond it.
    pub fn seek_balance(&mut self, to: f64, is_found: bool) {
        if is_found {
            self.to_jump = (GROWTH_AFTER_MANY * (to - self.at)).min(1.0);
        } else {
            (self.macro_step, self.jump_by) = (TOWARDS_JUMP * (to - self.at), to);
        }
    }

    /// Tries a shorter macro-step, where the contact mode may be known to change by some share.
    pub fn shorten(&mut self, macro_step: f64, change: Option<f64>) {
        self.macro_step = macro_step;
        self.change_by = change.or(self.change_by).filter(|change| *change > self.at);
    }

    /// Leaves the pace for the next advance after one of this `duration` (s).
    pub fn hand_on(&self, pace: &mut Pace, duration: f64) {
        // Rounded to the advance, a longer macro-step says that nothing limits it.
        pace.macro_step = self.macro_step.min(1e6) * duration;
        pace.hand_on(self.had_answers);
    }
}

/// Attempts of an advance, and the work that they took.
pub struct Effort {
    n_attempts: f64,
    /// Number of attempts after which the shortest macro-step grows.
    many: f64,
    /// Report up to the last attempt.
    counted: StepReport,
    /// Share at which the last attempt was rejected, and how many were there, one after the other.
    rejected_at: (f64, u32),
    /// Whether the rest of the advance is taken as it comes.
    pub is_given_up: bool,
}

impl Effort {
    /// For macro-steps of at most this share of the advance.
    pub fn new(longest: f64) -> Self {
        let many = MANY_ATTEMPTS + MANY_A_MACRO_STEP * longest.recip();
        Self { n_attempts: 0.0, many, counted: StepReport::default(), rejected_at: (f64::NAN, 0), is_given_up: false }
    }

    /// Shortest macro-step after the work that the report shows, from the one before. Where a run
    /// at obstacles has no work left, the rest of the advance is one macro-step that is not
    /// decided.
    pub fn shortest_after<M: Method>(&mut self, load: &mut Exact<M>, report: &mut StepReport, shortest: f64) -> f64 {
        let n_counted = self.counted.n_solves as f64 / SOLVES_AN_ATTEMPT;
        self.n_attempts += (report.n_solves as f64 / SOLVES_AN_ATTEMPT - n_counted).max(1.0);
        let is_spent = load.pace.spend(&self.counted, report) && load.obstacles.is_some();
        if is_spent {
            self.give_up(load, report);
        }
        self.counted = *report;
        if self.is_given_up {
            return 1.0;
        }
        if self.n_attempts <= self.many {
            return shortest;
        }
        self.n_attempts = 0.0;
        (shortest * GROWTH_AFTER_MANY).min(1.0)
    }

    /// Leaves the rest of an advance at obstacles undecided.
    pub fn give_up<M: Method>(&mut self, load: &Exact<M>, report: &mut StepReport) {
        if load.obstacles.is_some() && !self.is_given_up {
            self.is_given_up = true;
            report.add(&StepReport { status: Status::NotConverged, n_not_converged: 1, ..StepReport::default() });
        }
    }

    /// Counts a rejected attempt. Returns whether several in a row at this share of an advance at
    /// obstacles have led nowhere: where each is cut by next to nothing, at a touch that stays
    /// beyond its end.
    pub fn is_held_up<M: Method>(&mut self, load: &Exact<M>, at: f64) -> bool {
        let (last, n) = self.rejected_at;
        self.rejected_at = (at, if at == last { n + 1 } else { 1 });
        self.rejected_at.1 > MOST_CUTS && load.obstacles.is_some()
    }
}
