//! The scene on each backend, side by side.

use super::message::{LaneNow, StageNow};
use super::scene::LiveScene;
use cohaul::backend::{Motion, RestoreError, SaveError};
use cohaul::math::Vec2;
use cohaul::model::ant::Mode;
use cohaul::scenario::Drive;
use cohaul::simulation::{Keep, SavedRun, Simulation};
use cohaul_report::account_words;

/// What of a scene is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    pub springs: Vec<usize>,
    pub n_ants: usize,
    pub pushers: Vec<usize>,
}

impl Drawn {
    pub fn of(scene: &LiveScene) -> Self {
        let replay = scene.replay();
        Self { springs: replay.springs().collect(), n_ants: replay.n_ants(), pushers: scene.pushers() }
    }
}

/// One run of the scene on each backend that is shown, all at the same control tick.
pub struct Lanes<'a> {
    scene: &'a LiveScene,
    runs: Vec<Simulation<'a>>,
}

impl<'a> Lanes<'a> {
    /// The scene at its start.
    pub fn new(scene: &'a LiveScene) -> Self {
        let scenario = &scene.scenario;
        let run = |kind: &_| Simulation::new(scenario, &scene.settings.options(*kind, scenario), Keep::Outcome);
        Self { scene, runs: scene.settings.backends.iter().map(run).collect() }
    }

    /// Goes on where another future of the same scene was left.
    ///
    /// # Errors
    /// When a state does not fit the scene.
    pub fn resume(scene: &'a LiveScene, saved: &[SavedRun]) -> Result<Self, RestoreError> {
        let runs = saved.iter().map(|saved| Simulation::resume_with_other_future(&scene.scenario, saved, Keep::Outcome));
        Ok(Self { scene, runs: runs.collect::<Result<_, _>>()? })
    }

    /// # Errors
    /// When a backend cannot be saved.
    pub fn save(&self) -> Result<Vec<SavedRun>, SaveError> {
        self.runs.iter().map(Simulation::save).collect()
    }

    pub fn scene(&self) -> &'a LiveScene {
        self.scene
    }

    /// Control period (s).
    pub fn period(&self) -> f64 {
        self.scene.scenario.control_period
    }

    /// Time that the runs have reached (s).
    pub fn time(&self) -> f64 {
        self.runs.iter().map(Simulation::time).fold(0.0, f64::max)
    }

    pub fn motions(&self) -> impl Iterator<Item = Motion> + '_ {
        self.runs.iter().map(Simulation::motion)
    }

    /// Number of the last control tick that was reached.
    pub fn tick(&self) -> u64 {
        (self.time() / self.period() + 1e-6) as u64
    }

    pub fn has_ended(&self) -> bool {
        let left = self.scene.scenario.duration - self.time();
        left <= 1e-6 * self.period() || self.runs.iter().all(Simulation::is_finished)
    }

    /// Goes on to the next control tick, or to the end.
    pub fn advance(&mut self) {
        let period = self.period();
        let until = ((self.tick() + 1) as f64 * period).min(self.scene.scenario.duration) - 1e-6 * period;
        for run in &mut self.runs {
            while run.time() < until && !run.is_finished() {
                run.step();
            }
        }
    }

    /// Tip of a free spring of the first backend (m, world), where a hand takes it.
    pub fn rest_tip(&self, spring: usize) -> Option<Vec2> {
        let tip = self.scene.scenario.system.springs.get(spring)?.rest_tip();
        Some(self.runs.first()?.motion().pose.to_world(&tip))
    }

    /// Tips and ants as they are drawn: once where all runs have the same.
    pub fn stages(&self, drawn: &Drawn) -> Vec<StageNow> {
        let n = if matches!(self.scene.scenario.drive, Drive::Ants(_)) { self.runs.len() } else { 1 };
        self.runs[..n].iter().map(|run| stage(run, drawn)).collect()
    }

    pub fn lanes(&self, drawn: &Drawn) -> Vec<LaneNow> {
        self.runs.iter().map(|run| lane(run, drawn)).collect()
    }

    /// Pose of each obstacle that is drawn as a pusher.
    pub fn pushers(&self, drawn: &Drawn) -> Vec<[f64; 3]> {
        let pose = |number: &usize| {
            let pose = self.scene.scenario.system.world.obstacles[*number].path.pose_at(self.time());
            [pose.position.x, pose.position.y, pose.heading]
        };
        drawn.pushers.iter().map(pose).collect()
    }
}

fn stage(run: &Simulation, drawn: &Drawn) -> StageNow {
    let tip = |spring: &usize| run.backend().tip(*spring).and_then(|tip| finite([tip.x, tip.y]));
    let ants = run.ants().iter().take(drawn.n_ants).filter_map(|ant| {
        let holds = if matches!(ant.mode, Mode::Transport { .. }) { 1.0 } else { 0.0 };
        finite([ant.position.x, ant.position.y, ant.heading, holds])
    });
    StageNow { tips: drawn.springs.iter().map(tip).collect(), ants: ants.collect() }
}

fn lane(run: &Simulation, drawn: &Drawn) -> LaneNow {
    let (backend, outcome) = (run.backend(), run.outcome());
    let (pose, twist, energy) = (outcome.motion.pose, outcome.motion.twist, outcome.energy);
    let pull = |spring: &usize| backend.tip(*spring).and_then(|_| finite([backend.pull(*spring).norm()])).map(|[size]| size);
    let contacts = backend.side_contacts();
    let contacts = contacts.iter().filter_map(|at| finite([at.point.x, at.point.y, at.force.x, at.force.y, at.obstacle as f64]));
    LaneNow {
        pose: finite([pose.position.x, pose.position.y, pose.heading]),
        twist: finite([twist.linear.x, twist.linear.y, twist.angular]),
        pulls: drawn.springs.iter().map(pull).collect(),
        contacts: contacts.collect(),
        energy: finite([energy.elastic, energy.kinetic, energy.dissipated()]),
        status: account_words::name(outcome.account.health),
        cause: account_words::cause(&outcome.account).unwrap_or_default(),
        has_arrived: outcome.arrived == Some(true),
    }
}

/// The numbers, if all are finite.
fn finite<const N: usize>(numbers: [f64; N]) -> Option<[f64; N]> {
    numbers.iter().all(|number| number.is_finite()).then_some(numbers)
}
