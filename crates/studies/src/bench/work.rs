//! One setting of a method in a scene: its error, its times, or why it has none.

use serde::{Deserialize, Serialize};

use super::clock::{Clock, Timing, time_of};
use super::reference::{Reference, finished};
use super::scene::{Level, Scene};
use crate::methods::Method;
use crate::subject::{Ended, Meet, Runs};
use cohaul::backend::{BackendOptions, Status};
use cohaul::simulation::Keep;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    pub scene: String,
    pub method: String,
    pub level: Level,
    pub ending: Ending,
    /// Largest and final edge displacement from the reference (m); `None` without a path.
    pub errors_m: Option<[f64; 2]>,
    /// The larger of them over the length of the path (1).
    pub share: Option<f64>,
    pub n_steps: u64,
    pub n_solves: u64,
    pub n_not_converged: u64,
    /// CPU time of each timed run (s).
    pub seconds: Vec<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind", content = "of")]
pub enum Ending {
    /// Every step met its tolerance.
    Converged,
    /// Some did not. The path has an error all the same, and that counts.
    NotConverged,
    /// Some step had no finite answer.
    Failed,
    /// Something was wrong with an engine of the user.
    Wrong(String),
    /// An engine of the user does not take the scene.
    Refused(String),
    /// It took longer than this (s).
    TooLong(f64),
    /// A coarser setting took longer than this (s).
    LeftOut(f64),
}

/// Time that an engine of the user may take, over that of another method (1): programs that answer
/// lines are slower, and few of them are here.
const OF_USER: f64 = 10.0;

impl Row {
    pub fn method(&self) -> Method {
        self.method.parse().expect("rows are of known methods")
    }

    pub fn timing(&self) -> Option<Timing> {
        Timing::of(&self.seconds)
    }

    /// Why the setting did not succeed.
    pub fn cause(&self) -> Option<String> {
        match &self.ending {
            Ending::Converged => None,
            Ending::NotConverged => Some(format!("{} of {} steps did not converge", self.n_not_converged, self.n_steps)),
            Ending::Failed => Some("a step had no finite answer".to_owned()),
            Ending::Wrong(what) => Some(what.clone()),
            Ending::Refused(why) => Some(format!("refused: {why}")),
            Ending::TooLong(budget) => Some(format!("took longer than {budget} s")),
            Ending::LeftOut(budget) => Some(format!("left out: a coarser setting took longer than {budget} s")),
        }
    }

    /// Whether the setting ran to its end.
    pub fn is_answered(&self) -> bool {
        !matches!(self.ending, Ending::TooLong(_) | Ending::LeftOut(_) | Ending::Wrong(_) | Ending::Refused(_))
    }

    fn unanswered(scene: &Scene, method: &Method, level: Level, ending: Ending) -> Self {
        Self {
            scene: scene.name.clone(),
            method: method.name.to_owned(),
            level,
            ending,
            errors_m: None,
            share: None,
            n_steps: 0,
            n_solves: 0,
            n_not_converged: 0,
            seconds: Vec::new(),
        }
    }

    /// A setting finer than one that took too long, or that its engine did not run.
    pub fn left_out(&self, scene: &Scene, method: &Method, level: Level, budget: f64) -> Self {
        let is_of_engine = matches!(self.ending, Ending::Wrong(_) | Ending::Refused(_));
        let ending = if is_of_engine { self.ending.clone() } else { Ending::LeftOut(budget) };
        Self::unanswered(scene, method, level, ending)
    }

    /// Runs the setting once for its error, for `budget` (s) at most. `watch` receives the share
    /// done (1) and returns whether to continue; `None` when it said to stop.
    pub fn measure(
        scene: &Scene,
        (method, meet): (&Method, &Meet),
        level: Level,
        (reference, path_length): (&Reference, f64),
        budget: f64,
        mut watch: impl FnMut(f64) -> bool,
    ) -> Option<Self> {
        let scenario = &scene.scenario;
        let options = level.options(method, &scenario.system.load);
        let runs = Runs::by(meet, options);
        let (mut clock, mut is_asked_to_stop) = (None, false);
        let budget = if method.is_of_user { OF_USER * budget } else { budget };
        let run = finished(
            |options| runs.simulation(scenario, options, Keep::Trace),
            &options,
            |time| {
                is_asked_to_stop = !watch(time / scenario.duration);
                !is_asked_to_stop && clock.get_or_insert_with(|| Clock::of(method)).seconds() < budget
            },
        );
        let row = |ending| Self::unanswered(scene, method, level, ending);
        match runs.ended() {
            Some(Ended::Refused(why)) => return Some(row(Ending::Refused(why))),
            Some(Ended::Failed(what)) => return Some(row(Ending::Wrong(what))),
            _ => {}
        }
        let Some(run) = run else { return (!is_asked_to_stop).then(|| row(Ending::TooLong(budget))) };
        let (trace, outcome) = run.into_results();
        let poses = trace.rows.iter().map(|row| row.motion.pose);
        let errors = reference.errors(poses, scenario.system.load.radius);
        let is_finite = errors.iter().all(|error| error.is_finite());
        let ending = match outcome.steps.status {
            Status::Converged if is_finite => Ending::Converged,
            Status::NotConverged if is_finite => Ending::NotConverged,
            _ => Ending::Failed,
        };
        let has_path = ending != Ending::Failed;
        Some(Self {
            errors_m: has_path.then_some(errors),
            share: has_path.then_some(errors[0] / path_length),
            n_steps: outcome.steps.n_steps,
            n_solves: outcome.steps.n_solves,
            n_not_converged: outcome.steps.n_not_converged,
            ..row(ending)
        })
    }

    /// Whether one more run is timed: all of them may take `budget` together (s of CPU time).
    pub fn may_be_timed(&self, budget: f64) -> bool {
        let spent: f64 = self.seconds.iter().sum();
        let is_spent = !self.seconds.is_empty() && spent + spent / self.seconds.len() as f64 > budget;
        !is_spent && self.is_answered() && self.ending != Ending::Failed
    }

    /// Time of one more run, or of several that are too short alone (s): CPU time, and of an engine
    /// of the user, which computes elsewhere, real time. Nothing watches the run, because that
    /// would take time too.
    pub fn time(&self, scene: &Scene, meet: &Meet) -> f64 {
        let (method, scenario) = (self.method(), &scene.scenario);
        let options = self.level.options(&method, &scenario.system.load);
        let start = |options: &BackendOptions| Runs::by(meet, *options).simulation(scenario, options, Keep::Outcome);
        if method.is_of_user {
            // A program starts before the clock does.
            let mut run = start(&options);
            let clock = Clock::of(&method);
            run.run(|_| true);
            return clock.seconds();
        }
        time_of(|| drop(finished(start, &options, |_| true)))
    }
}
