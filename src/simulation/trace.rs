//! What is recorded of a run: a row at every control tick, the events between, and how it ended. A
//! comparison may ask for more rows in each control period.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Account, DoubtTimes, Resolution};
use crate::backend::{AttachedTips, EnergyLedger, Motion, PoseError, SideContact, StepReport, Transition, TransitionCounts};
use crate::math::{Pose, Summary, Vec2};
use crate::model::{Obstacle, ObstaclePath, ObstaclePose, World, interaction_force};

/// What is kept of a run while it goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Keep {
    /// Rows and events.
    Trace,
    /// Only the outcome, so that memory does not grow with the run.
    Outcome,
}

/// Course of a run: rows at every control tick at least, and at the exact end.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Trace {
    pub rows: Vec<Row>,
    pub events: Vec<Event>,
    /// States at instants between two rows at which a tip may turn. A run whose rows are handed
    /// over keeps none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub between: Vec<Row>,
    /// Instants at which the load's motion is not smooth, as the backend reported them.
    pub transitions: Vec<Transition>,
    /// Rows at the control ticks, and at the end, of the less exact run beside this one; empty
    /// unless a run keeps them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub companion: Vec<Row>,
}

/// State at one instant, after the events there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Time of the instant (s).
    pub time: f64,
    pub motion: Motion,
    pub energy: EnergyLedger,
    /// Attached tips in the order of their springs.
    #[serde(serialize_with = "as_slice", deserialize_with = "from_list")]
    pub tips: AttachedTips,
    /// Closed contacts with obstacles, with their forces in the step before the instant.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<SideContact>,
    /// Poses of the obstacles that were steered, in place of the paths of the scenario.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steered: Vec<ObstaclePose>,
    /// Estimated error of the pose; `None` where the backend estimates none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<PoseError>,
}

fn as_slice<S: Serializer>(tips: &AttachedTips, serializer: S) -> Result<S::Ok, S::Error> {
    tips.as_slice().serialize(serializer)
}

fn from_list<'de, D: Deserializer<'de>>(deserializer: D) -> Result<AttachedTips, D::Error> {
    Vec::deserialize(deserializer).map(AttachedTips::from_vec)
}

impl Trace {
    /// The world of this run, in which obstacles that were steered have the paths that they took.
    pub fn world(&self, world: &World) -> World {
        let mut world = world.clone();
        for (index, obstacle) in world.obstacles.iter_mut().enumerate() {
            if self.rows.iter().any(|row| row.steered_pose(index).is_some()) {
                let waypoints = self.rows.iter().map(|row| (row.time, row.pose_of(index, obstacle))).collect();
                obstacle.path = ObstaclePath { waypoints };
            }
        }
        world
    }
}

impl Row {
    fn steered_pose(&self, obstacle: usize) -> Option<Pose> {
        self.steered.iter().find(|steered| steered.obstacle == obstacle).map(|steered| steered.pose)
    }

    /// Pose of the obstacle of this index at this instant (m, rad, world).
    pub fn pose_of(&self, index: usize, obstacle: &Obstacle) -> Pose {
        self.steered_pose(index).unwrap_or_else(|| obstacle.path.pose_at(self.time))
    }

    /// Whether the load touches two obstacles at once, which may bear it in more than one way.
    pub fn touches_two(&self) -> bool {
        self.contacts.windows(2).any(|pair| pair[0].obstacle != pair[1].obstacle)
    }

    /// Sum of the interaction forces of all pairs of attached tips, Eq. (4); positive when they
    /// pull apart (N).
    pub fn interaction(&self) -> f64 {
        let pairs = self.tips.iter().enumerate().flat_map(|(at, a)| self.tips[at + 1..].iter().map(move |b| (a, b)));
        pairs.map(|(a, b)| interaction_force([a.position, b.position], [a.pull, b.pull])).fold(0.0, |sum, force| sum + force)
    }
}

/// A grasp or a release.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Time of the event (s).
    pub time: f64,
    pub spring: usize,
    /// Number of the ant; `None` for a prescribed path.
    pub ant: Option<usize>,
    /// Position of the tip at that instant (m, world).
    pub tip: Vec2,
    pub kind: EventKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    Grasp,
    Release,
}

impl EventKind {
    /// The word that files use.
    pub fn name(self) -> &'static str {
        match self {
            EventKind::Grasp => "grasp",
            EventKind::Release => "release",
        }
    }
}

/// Largest number of transitions at obstacles that an outcome keeps (1): enough to read, and a
/// bound of its memory.
pub const MOST_CONTACT_TRANSITIONS: usize = 50;

/// What is added up over the advances of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Totals {
    pub steps: StepReport,
    /// Start of the first advance that had no finite solution (s); `None` unless the run failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed_at: Option<f64>,
    #[serde(default, skip_serializing_if = "DoubtTimes::is_empty")]
    pub doubtful: DoubtTimes,
    #[serde(default)]
    pub resolution: Resolution,
    /// Largest error bound of the pose so far; `None` where the backend finds none.
    pub error: Option<PoseError>,
    pub transitions: TransitionCounts,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contact_transitions: Vec<Transition>,
}

/// Result of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// End of the run (s).
    pub time: f64,
    pub motion: Motion,
    pub energy: EnergyLedger,
    pub steps: StepReport,
    /// Whether the numbers can be trusted.
    #[serde(default)]
    pub account: Account,
    /// How well fixed steps of a backend with inertia resolve the motion.
    #[serde(default)]
    pub resolution: Resolution,
    /// Start of the first advance that had no finite solution (s); `None` unless the run failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed_at: Option<f64>,
    /// When the backend first reported each doubt.
    #[serde(default, skip_serializing_if = "DoubtTimes::is_empty")]
    pub doubtful: DoubtTimes,
    /// Counts of the transitions that the backend reported.
    #[serde(default)]
    pub transitions: TransitionCounts,
    /// What happened at obstacles: the first `MOST_CONTACT_TRANSITIONS` such transitions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contact_transitions: Vec<Transition>,
    /// Bound of the error of the pose; `None` where the backend finds none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<PoseError>,
    /// Whether the load reached the nest; `None` without ants.
    pub arrived: Option<bool>,
    /// Magnitudes of the pulls at the ants' decisions, with a zero for each grasp (N).
    pub pulls: Summary,
}
