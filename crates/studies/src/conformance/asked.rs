//! An engine as tests ask it: a fresh run for each scenario.

use std::cell::Cell;

use crate::subject::{Ended, Fresh, Meet};
use cohaul::backend::{BackendKind, BackendOptions, Computes};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Row, Simulation, controller_of};

/// What a test asks: the engine, its step, and whether to go on.
pub struct Asked<'a> {
    meet: &'a Meet<'a>,
    /// Longest step (s).
    pub step_s: f64,
    go_on: &'a dyn Fn() -> bool,
    n_not_converged: Cell<u64>,
    n_steps: Cell<u64>,
}

/// A run that came to its end.
pub struct Course {
    /// The start, and the end of each control period.
    pub rows: Vec<Row>,
    pub computes: Computes,
}

impl<'a> Asked<'a> {
    pub fn new(meet: &'a Meet<'a>, step_s: f64, go_on: &'a dyn Fn() -> bool) -> Self {
        Self { meet, step_s, go_on, n_not_converged: Cell::new(0), n_steps: Cell::new(0) }
    }

    /// Runs a scenario at the step of the test.
    ///
    /// # Errors
    /// Why there is no answer.
    pub fn run(&self, scenario: &Scenario) -> Result<Course, Ended> {
        self.run_at(scenario, self.step_s)
    }

    /// Runs a scenario at another longest step (s).
    ///
    /// # Errors
    /// Why there is no answer.
    pub fn run_at(&self, scenario: &Scenario, step_s: f64) -> Result<Course, Ended> {
        let options = BackendOptions::new(BackendKind::Rapier, step_s);
        let Fresh { backend, complaint } = (self.meet)(scenario, &options)?;
        let mut run = Simulation::from_parts(scenario, &options, Keep::Trace, controller_of(scenario), backend);
        run.run(|_| (self.go_on)());
        if !run.is_finished() {
            return Err(Ended::Stopped);
        }
        let computes = run.computes();
        let (trace, outcome) = run.into_results();
        if let Some(what) = complaint() {
            return Err(Ended::Failed(what));
        }
        if let Some(time) = outcome.failed_at {
            return Err(Ended::Failed(format!("must find a finite solution, found none after {time} s")));
        }
        if let Some(row) = trace.rows.iter().find(|row| row.motion.entries().iter().any(|entry| !entry.is_finite())) {
            return Err(Ended::Failed(format!("must have a finite pose and twist, found {:?} at {} s", row.motion.entries(), row.time)));
        }
        self.n_not_converged.set(self.n_not_converged.get() + outcome.steps.n_not_converged);
        self.n_steps.set(self.n_steps.get() + outcome.steps.n_steps);
        Ok(Course { rows: trace.rows, computes })
    }

    /// What to know of the runs so far beside their answers.
    pub fn note(&self) -> Option<String> {
        let (n, all) = (self.n_not_converged.get(), self.n_steps.get());
        (n > 0).then(|| format!("{n} of {all} steps did not converge"))
    }
}

impl Course {
    pub fn end(&self) -> &Row {
        self.rows.last().expect("a run has its start")
    }

    /// Path length of the centre of the load (m).
    pub fn path_length(&self) -> f64 {
        self.rows.windows(2).map(|pair| (pair[1].motion.pose.position - pair[0].motion.pose.position).norm()).sum()
    }
}
