//! The interface of a controller: what it sees of a run, and what it commands.

use std::collections::BTreeSet;

use crate::backend::{AttachedTip, Backend, Motion, RestoreError, SaveError, SideContact, SkipCounts, Skips};
use crate::math::{Pose, Summary, Vec2};
use crate::model::ObstaclePose;
use crate::model::ant::Ant;
use crate::scenario::Scenario;
use crate::simulation::hand::{Hand, HandError, pose_at};
use crate::simulation::trace::Event;

/// Moves the tips of springs (grasps, releases and paths), and obstacles that push.
///
/// An own controller needs [`decide`](Controller::decide) and [`targets`](Controller::targets).
/// This one pulls a spring along and lets go as soon as the load has come 10 mm:
///
/// ```
/// use cohaul::backend::{BackendKind, BackendOptions};
/// use cohaul::math::Vec2;
/// use cohaul::scenario::Scenario;
/// use cohaul::simulation::{Commands, Controller, Event, EventKind, Keep, Simulation, View};
///
/// #[derive(Default)]
/// struct Tow {
///     tip: Vec2,
///     is_attached: bool,
/// }
///
/// impl Controller for Tow {
///     fn decide(&mut self, view: &View, commands: &mut Commands) {
///         let kind = match (view.time == 0.0, self.is_attached && view.motion.pose.position.x >= 0.01) {
///             (true, _) => EventKind::Grasp,
///             (_, true) => EventKind::Release,
///             _ => return,
///         };
///         self.is_attached = kind == EventKind::Grasp;
///         commands.events.push(Event { time: view.time, kind, spring: 0, ant: None, tip: self.tip });
///     }
///
///     fn targets(&mut self, view: &View, until: f64) -> &[Vec2] {
///         self.tip.x += 0.05 * (until - view.time);
///         std::slice::from_ref(&self.tip)
///     }
/// }
///
/// let scenario = Scenario::read("scenarios/analytic/centre-pull.json".as_ref())?;
/// for kind in BackendKind::ALL {
///     let options = BackendOptions::new(kind, 1e-3);
///     let mut run = Simulation::with_controller(&scenario, &options, Keep::Trace, Box::new(Tow::default()));
///     run.run(|_time| true);
///     let (trace, outcome) = run.into_results();
///     // The spring stretches by f / k = 33 mm, so that the tip is 43 mm away after 0.86 s.
///     assert!(trace.events.len() == 2 && (trace.events[1].time - 0.86).abs() < 0.06, "{kind:?}");
///     assert!(outcome.motion.pose.position.x >= 0.01);
/// }
/// # Ok::<(), cohaul::scenario::ScenarioError>(())
/// ```
pub trait Controller {
    /// Adds the grasps and releases at this instant to `commands`, which are empty.
    fn decide(&mut self, view: &View, commands: &mut Commands);

    /// Positions of the tips at the time `until` (s), one for each spring (m, world). Each attached
    /// tip moves straight to its position; other entries have no effect.
    fn targets(&mut self, view: &View, until: f64) -> &[Vec2];

    /// Poses of obstacles at the time `until` (s), for each one that the controller steers. Such an
    /// obstacle moves straight there, leaves the path of the scenario for good, and stands still
    /// where it is no longer named. A run on a backend that cannot steer it fails.
    fn pushers(&mut self, _view: &View, _until: f64) -> &[ObstaclePose] {
        &[]
    }

    /// The hand that the controller holds from now to the time `until` (s), if it does: an obstacle
    /// that a spring pushes, in place of a pose. A run in which it cannot push fails.
    fn hand(&mut self, _view: &View, _until: f64) -> Option<Hand> {
        None
    }

    /// Takes note of why the hand could not push.
    fn cannot_push(&mut self, _error: HandError) {}

    /// First instant after `time`, besides control ticks, at which something happens or a tip
    /// changes its velocity (s).
    fn next_instant(&self, _time: f64) -> Option<f64> {
        None
    }

    /// Whether the load has arrived, which ends the run; `None` without a destination.
    fn arrived(&self, _motion: &Motion) -> Option<bool> {
        None
    }

    /// Pulls at the decisions of ants (N).
    fn pulls(&self) -> Summary {
        Summary::default()
    }

    /// The ants as they stand now; none for a controller without ants.
    fn ants(&self) -> &[Ant] {
        &[]
    }

    /// State of the controller, from which [`Controller::restore`] continues.
    ///
    /// # Errors
    /// When this kind of controller cannot be saved.
    fn save(&self) -> Result<serde_json::Value, SaveError> {
        Err(SaveError)
    }

    /// Continues from a state that [`Controller::save`] returned.
    ///
    /// # Errors
    /// When the state is none of this kind of controller.
    fn restore(&mut self, _state: &serde_json::Value) -> Result<(), RestoreError> {
        Err(RestoreError("this controller cannot be restored".into()))
    }

    /// Checks the restored state against the tick, the time (s) and the attached tips of the run.
    /// What happens at this time has not happened yet.
    ///
    /// # Errors
    /// When they contradict each other.
    fn check(&self, _tick: u64, _time: f64, _tips: &[AttachedTip]) -> Result<(), RestoreError> {
        Ok(())
    }
}

/// # Errors
/// When the attached `tips` of a restored run are not those of these `springs`.
pub(super) fn check_attached(springs: BTreeSet<usize>, time: f64, tips: &[AttachedTip]) -> Result<(), RestoreError> {
    let found: BTreeSet<usize> = tips.iter().map(|tip| tip.spring).collect();
    match springs.symmetric_difference(&found).next() {
        None => Ok(()),
        Some(spring) if found.contains(spring) => Err(RestoreError(format!("at {time} s, spring {spring} attached, which is free"))),
        Some(spring) => Err(RestoreError(format!("at {time} s, spring {spring} free, which is attached"))),
    }
}

/// What a controller sees at one instant.
pub struct View<'a> {
    pub scenario: &'a Scenario,
    pub backend: &'a dyn Backend,
    /// Pose and twist of the load.
    pub motion: Motion,
    /// Attached tips in the order of their springs; empty where the run did not read them.
    pub tips: &'a [AttachedTip],
    /// Time of the instant (s).
    pub time: f64,
    /// Number of the control tick at this instant; `None` between ticks.
    pub tick: Option<u64>,
    /// Work that may be skipped where its result is known.
    pub skips: Skips,
}

impl View<'_> {
    /// Pose of an obstacle at this instant (m, rad, world); `None` if there is no such obstacle.
    pub fn obstacle(&self, obstacle: usize) -> Option<Pose> {
        let world = &self.scenario.system.world;
        (obstacle < world.obstacles.len()).then(|| pose_at(self.backend, world, obstacle, self.time))
    }

    /// Closed contacts of the load with obstacles, with their forces in the last step.
    pub fn contacts(&self) -> Vec<SideContact> {
        self.backend.side_contacts()
    }

    /// Force of all contacts with an obstacle on the load in the last step (N, world).
    pub fn contact_force(&self, obstacle: usize) -> Vec2 {
        self.backend.contact_force(obstacle)
    }

    /// Friction force of the ground on each support (N, world), averaged over the last step; empty
    /// for a backend that does not compute it.
    pub fn friction_forces(&self) -> Vec<Vec2> {
        self.backend.friction_forces()
    }

    /// Force that moves the tip of a spring (N, world); zero for a spring that is not attached.
    pub fn pull(&self, spring: usize) -> Vec2 {
        // When all springs before it are attached, the index of its entry is its own number.
        let at_its_number = self.tips.get(spring).filter(|tip| tip.spring == spring);
        let read = at_its_number.or_else(|| Some(&self.tips[self.tips.binary_search_by_key(&spring, |tip| tip.spring).ok()?]));
        read.map_or_else(|| self.backend.pull(spring), |tip| tip.pull)
    }
}

/// What a controller commands at one instant: releases first, then grasps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Commands {
    pub events: Vec<Event>,
    /// Work that was skipped for the decisions.
    pub skipped: SkipCounts,
}
