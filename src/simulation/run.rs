//! One run of one scenario: the loop of sensing, deciding, moving and recording.

use super::account::Account;
use super::checkpoints::Checkpoints;
use super::clock::Clock;
use super::controllers::{Commands, Controller, View, controller_of};
use super::repeats::Repeats;
use super::resolution::Resolution;
use super::trace::{Event, EventKind, Keep, MOST_CONTACT_TRANSITIONS, Outcome, Row, Totals, Trace};
use crate::backend::{
    AttachedTip, AttachedTips, Backend, BackendOptions, Computes, Motion, Status, StepReport, Transition, build, judge_exact,
};
use crate::model::System;
use crate::model::ant::Ant;
use crate::scenario::Scenario;

/// Displacement of a load over its radius that is rounding, whose energies are none (1).
const ROUNDED_MOTION: f64 = 1e-12;

/// One run of one scenario on one backend.
pub struct Simulation<'a> {
    pub(super) scenario: &'a Scenario,
    pub(super) options: BackendOptions,
    pub(super) backend: Box<dyn Backend>,
    pub(super) controller: Box<dyn Controller>,
    pub(super) keep: Keep,
    pub(super) clock: Clock,
    pub(super) finished: bool,
    pub(super) totals: Totals,
    pub(super) trace: Trace,
    /// Attached tips in the order of their springs. Their positions and pulls are those of this
    /// instant only where a trace is kept.
    pub(super) tips: AttachedTips,
    /// Empty between steps; kept for its memory.
    commands: Commands,
    /// Whether the trace has rows of the less exact run beside this one.
    pub(super) keeps_companion: bool,
    /// Whether a step has begun and not ended.
    is_stepping: bool,
    pub(super) checkpoints: Option<Box<Checkpoints>>,
}

impl<'a> Simulation<'a> {
    /// A run of the scenario as it stands.
    ///
    /// # Panics
    /// When [`build`] refuses the options.
    pub fn new(scenario: &'a Scenario, options: &BackendOptions, keep: Keep) -> Self {
        Self::with_controller(scenario, options, keep, controller_of(scenario))
    }

    /// A run of the scenario's load under another controller.
    ///
    /// # Panics
    /// When [`build`] refuses the options.
    pub fn with_controller(scenario: &'a Scenario, options: &BackendOptions, keep: Keep, controller: Box<dyn Controller>) -> Self {
        Self::from_parts(scenario, options, keep, controller, backend_of(scenario, options))
    }

    /// A run of a controller on a backend that was built from `options` elsewhere.
    pub fn from_parts(
        scenario: &'a Scenario,
        options: &BackendOptions,
        keep: Keep,
        controller: Box<dyn Controller>,
        backend: Box<dyn Backend>,
    ) -> Self {
        Self {
            scenario,
            options: *options,
            keep,
            clock: Clock::new(scenario.control_period, scenario.duration),
            finished: false,
            totals: Totals {
                resolution: Resolution::starting(&scenario.start, options.step_s, scenario.system.load.radius),
                ..Totals::default()
            },
            trace: Trace::default(),
            tips: attached_tips(scenario, backend.as_ref()),
            commands: Commands::default(),
            keeps_companion: false,
            is_stepping: false,
            checkpoints: None,
            controller,
            backend,
        }
    }

    /// What the backend computes.
    pub fn computes(&self) -> Computes {
        self.backend.computes()
    }

    /// Records `n_parts` rows in each control period in place of one. Meant for controllers whose
    /// decisions are bound to no tick: [`Tips`](super::Tips) and [`Replay`](super::Replay).
    pub fn with_rows_per_period(mut self, n_parts: u64) -> Self {
        self.clock.n_parts = n_parts.max(1);
        self
    }

    /// Keeps the rows of the less exact run beside this one as well, under error control.
    pub fn with_companion(mut self) -> Self {
        self.keeps_companion = true;
        self
    }

    /// Keeps a state of a second ago or so in memory, so that a run that is stopped in the midst of
    /// a step can be saved: see [`Simulation::save`].
    pub fn with_checkpoints(mut self) -> Self {
        self.checkpoints = Some(Box::default());
        self
    }

    /// Runs to the end, or until `watch` returns `false`, which receives the time (s) before every
    /// step.
    pub fn run(&mut self, mut watch: impl FnMut(f64) -> bool) {
        while !self.finished && watch(self.clock.time) {
            self.step();
        }
    }

    /// Runs to the end and hands the rows over in groups instead of keeping them. The rows of the
    /// last group stay in the trace.
    ///
    /// # Errors
    /// When `take_rows` fails, which ends the run.
    pub fn run_streaming<E>(
        &mut self,
        mut watch: impl FnMut(f64) -> bool,
        mut take_rows: impl FnMut(&[Row]) -> Result<(), E>,
    ) -> Result<(), E> {
        // So many rows stay in the nearest cache of a processor.
        const ROWS_IN_GROUP: usize = 64;
        while !self.finished && watch(self.clock.time) {
            self.step();
            if self.trace.rows.len() >= ROWS_IN_GROUP {
                take_rows(&self.trace.rows)?;
                self.trace.rows.clear();
                self.trace.between.clear();
            }
        }
        Ok(())
    }

    /// Runs to the end under error control. While the error bound exceeds the tolerance, the
    /// run starts again with a smaller error for each macro-step, from what `restart` makes of the
    /// options. The outcome says which error remains. At obstacles a run may jump, or end without
    /// an answer, where smaller errors do not help: what follows there is not decided.
    pub fn run_to_tolerance(&mut self, mut restart: impl FnMut(&BackendOptions) -> Self, mut watch: impl FnMut(f64) -> bool) {
        let mut repeats = Repeats::default();
        while !self.finished && watch(self.clock.time) {
            self.step();
            let Totals { error, steps, doubtful, .. } = &self.totals;
            if let Some(options) = repeats.next((self.scenario, &self.options), self.clock.time, *error, (steps, doubtful)) {
                let has_checkpoints = self.checkpoints.is_some();
                *self = restart(&options);
                self.checkpoints = has_checkpoints.then(Box::default);
            }
        }
    }

    /// Senses, decides, acts, records and advances to the next instant; does nothing once the run
    /// is finished. A [`stop`](crate::stop) may leave the step in its midst.
    ///
    /// # Panics
    /// When the last step was stopped.
    pub fn step(&mut self) {
        if self.finished {
            return;
        }
        assert!(!self.is_stepping, "a run that was stopped in a step does not go on");
        if self.checkpoints.is_some() {
            self.take_checkpoint();
        }
        self.is_stepping = true;
        self.step_on();
        self.is_stepping = false;
    }

    fn step_on(&mut self) {
        if self.keep == Keep::Trace {
            self.backend.read_tips(&mut self.tips);
        }
        let motion = self.backend.motion();
        if self.is_over(&motion) {
            self.record(motion);
            self.finished = true;
            return;
        }
        let (tick, skips) = (self.clock.tick_now(), self.options.skips);
        let (scenario, time) = (self.scenario, self.clock.time);
        let tips = if self.keep == Keep::Trace { &self.tips[..] } else { &[] };
        self.controller.decide(&View { scenario, backend: self.backend.as_ref(), motion, tips, time, tick, skips }, &mut self.commands);
        self.act();
        self.record(motion);
        let until = self.clock.next(self.controller.next_instant(time), |time| scenario.system.world.next_corner(time));
        let world = &scenario.system.world;
        let is_steered = world.is_empty() || self.steer(motion, until);
        let view = View { scenario, backend: self.backend.as_ref(), motion, tips: &[], time, tick, skips };
        let hand = if world.is_empty() { None } else { self.controller.hand(&view, until) };
        let targets = self.controller.targets(&view, until);
        let failed = StepReport { status: Status::Failed, ..StepReport::default() };
        let (backend, has_inertia) = (self.backend.as_mut(), self.options.kind.has_inertia());
        let report = match hand {
            None if is_steered => backend.advance(targets, until - time),
            Some(hand) if is_steered => hand.advance(backend, world, [time, until], targets, has_inertia).unwrap_or_else(|error| {
                self.controller.cannot_push(error);
                failed
            }),
            _ => failed,
        };
        self.totals.doubtful.note(&report, time);
        self.totals.steps.add(&report);
        self.observe();
        if self.options.kind.has_inertia() && self.options.tolerance.is_none() {
            self.totals.resolution.add(&motion, &self.backend.motion(), &report, scenario.system.load.radius);
        }
        if report.status == Status::Failed {
            // What lies beyond has no meaning. Time and rows end where the last answer was.
            self.totals.failed_at = Some(time);
            self.finished = true;
            return;
        }
        self.clock.move_to(until);
    }

    pub fn is_finished(&self) -> bool {
        self.finished
    }

    /// Whether a step was stopped in its midst. The run is of no further use then, except for
    /// [`Simulation::save`].
    pub fn is_stopped(&self) -> bool {
        self.is_stepping
    }

    /// Time that the run has reached (s).
    pub fn time(&self) -> f64 {
        self.clock.time
    }

    /// Pose and twist of the load at this time.
    pub fn motion(&self) -> Motion {
        self.backend.motion()
    }

    /// Number of attached springs.
    pub fn n_attached(&self) -> usize {
        self.tips.len()
    }

    pub fn backend(&self) -> &dyn Backend {
        self.backend.as_ref()
    }

    /// The ants as they stand now; none under another controller.
    pub fn ants(&self) -> &[Ant] {
        self.controller.ants()
    }

    /// Tip and pull of every attached spring now.
    pub fn attached_tips(&self) -> AttachedTips {
        attached_tips(self.scenario, self.backend.as_ref())
    }

    pub fn trace(&self) -> &Trace {
        &self.trace
    }

    /// Result of the run up to this time.
    pub fn outcome(&self) -> Outcome {
        let (motion, energy) = (self.backend.motion(), self.backend.energy());
        let mut steps = self.totals.steps;
        if self.options.kind.is_exact() {
            let share = self.options.tolerance.map(|tolerance| tolerance.position_m / self.scenario.system.load.radius);
            let System { load, .. } = &self.scenario.system;
            let least = ROUNDED_MOTION * load.radius * self.scenario.system.total_slip_limit();
            judge_exact(&energy, share, least, &mut steps);
        }
        let mut outcome = Outcome {
            time: self.clock.time,
            motion,
            energy,
            steps,
            account: Account::default(),
            resolution: self.totals.resolution,
            failed_at: self.totals.failed_at,
            doubtful: self.totals.doubtful,
            transitions: self.totals.transitions,
            contact_transitions: self.totals.contact_transitions.clone(),
            error: self.totals.error,
            arrived: self.controller.arrived(&motion),
            pulls: self.controller.pulls(),
        };
        outcome.account = Account::of(self.scenario, &self.options, &outcome);
        outcome
    }

    /// Trace and outcome of the run up to this time.
    pub fn into_results(self) -> (Trace, Outcome) {
        let outcome = self.outcome();
        (self.trace, outcome)
    }

    fn is_over(&self, motion: &Motion) -> bool {
        self.clock.is_at_end() || self.controller.arrived(motion) == Some(true)
    }

    /// Sends obstacles where they shall be at the time `until` (s). Returns whether the backend
    /// does it.
    fn steer(&mut self, motion: Motion, until: f64) -> bool {
        let (tick, skips) = (self.clock.tick_now(), self.options.skips);
        let (scenario, time) = (self.scenario, self.clock.time);
        let view = View { scenario, backend: self.backend.as_ref(), motion, tips: &[], time, tick, skips };
        let targets = self.controller.pushers(&view, until);
        targets.iter().all(|target| self.backend.steer(target.obstacle, &[(until - time, target.pose)]))
    }

    /// Carries out the commands and empties them.
    fn act(&mut self) {
        for event in &self.commands.events {
            let Event { spring, tip: position, .. } = *event;
            let at = self.tips.partition_point(|tip| tip.spring < spring);
            match event.kind {
                EventKind::Release => {
                    self.backend.release(spring);
                    self.tips.remove(at);
                }
                EventKind::Grasp => {
                    self.backend.attach(spring, position);
                    self.tips.insert(at, AttachedTip { spring, position, pull: self.backend.pull(spring) });
                }
            }
        }
        if self.keep == Keep::Trace {
            self.trace.events.extend_from_slice(&self.commands.events);
        }
        self.totals.steps.skipped.add(&std::mem::take(&mut self.commands.skipped));
        self.commands.events.clear();
    }

    /// Adds up what the backend reports of its last advance.
    fn observe(&mut self) {
        if let Some(now) = self.backend.pose_error() {
            self.totals.error = Some(self.totals.error.unwrap_or_default().max(&now));
        }
        for transition in self.backend.transitions() {
            let transition = Transition { time: self.clock.time + transition.time, ..*transition };
            self.totals.transitions.add(&transition.kind);
            let contacts = &mut self.totals.contact_transitions;
            if transition.kind.obstacle().is_some() && contacts.len() < MOST_CONTACT_TRANSITIONS {
                contacts.push(transition);
            }
            if self.keep == Keep::Trace {
                self.trace.transitions.push(transition);
            }
        }
    }

    /// Adds a state between two rows.
    // A function of its own: rows come far more often.
    #[cold]
    fn add_between(&mut self, motion: Motion) {
        let (energy, error) = (self.backend.energy(), self.backend.pose_error());
        let (time, contacts, tips) = (self.clock.time, self.backend.side_contacts(), self.tips.clone());
        let steered = self.backend.steered();
        self.trace.between.push(Row { time, motion, energy, tips, contacts, steered, error });
    }

    /// Adds a row at every tick, at the ends of parts of control periods, and at the end.
    fn record(&mut self, motion: Motion) {
        if self.keep == Keep::Trace && (self.clock.ends_part() || self.is_over(&motion)) {
            let (energy, error) = (self.backend.energy(), self.backend.pose_error());
            let (contacts, steered) = match self.scenario.system.world.is_empty() {
                true => (Vec::new(), Vec::new()),
                false => (self.backend.side_contacts(), self.backend.steered()),
            };
            self.trace.rows.push(Row { time: self.clock.time, motion, energy, tips: AttachedTips::new(), contacts, steered, error });
            // The row is long, so its tips are written in place.
            self.trace.rows.last_mut().expect("a row was just added").tips.extend_from_slice(&self.tips);
        } else if self.keep == Keep::Trace {
            self.add_between(motion);
        }
        if self.keeps_companion && (self.clock.tick_now().is_some() || self.is_over(&motion)) {
            let row = |backend: &dyn Backend| Row {
                time: self.clock.time,
                motion: backend.motion(),
                energy: backend.energy(),
                tips: attached_tips(self.scenario, backend),
                contacts: backend.side_contacts(),
                steered: backend.steered(),
                error: None,
            };
            self.trace.companion.extend(self.backend.companion().map(row));
        }
    }
}

/// Makes the backend of a scenario: a parameter where another engine can take the place of a
/// backend.
pub type MakeBackend<'a> = dyn Fn(&Scenario, &BackendOptions) -> Box<dyn Backend> + Sync + 'a;

/// The scenario's load on the backend that the options name: the usual [`MakeBackend`].
///
/// # Panics
/// When [`build`] refuses the options.
pub fn backend_of(scenario: &Scenario, options: &BackendOptions) -> Box<dyn Backend> {
    build(&scenario.system, scenario.start, options)
}

/// Attached tips in the order of their springs, read one by one.
pub(super) fn attached_tips(scenario: &Scenario, backend: &dyn Backend) -> AttachedTips {
    let attached = |spring| Some(AttachedTip { spring, position: backend.tip(spring)?, pull: backend.pull(spring) });
    (0..scenario.system.springs.len()).filter_map(attached).collect()
}
