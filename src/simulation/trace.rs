//! What is kept of a run: a row at every control tick (and at ends of parts of a control period, where a comparison asks for them), the events between, and how
//! it ended.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::backend::{AttachedTips, EnergyLedger, Motion, PoseError, StepReport, Transition, TransitionCounts};
use crate::math::{Summary, Vec2};
use crate::model::interaction_force;

/// The run as it was: rows at every control tick at least, and at the exact end.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Trace {
    pub rows: Vec<Row>,
    pub events: Vec<Event>,
    /// Where the load's motion is not smooth, as the backend saw it.
    pub transitions: Vec<Transition>,
}

/// The state at one instant, after what happened there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// (s)
    pub time: f64,
    pub motion: Motion,
    pub energy: EnergyLedger,
    /// Tips that are held, in the order of their springs.
    #[serde(serialize_with = "as_slice", deserialize_with = "from_list")]
    pub tips: AttachedTips,
    /// How far the pose may be wrong; `None` where the backend does not know.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<PoseError>,
}

fn as_slice<S: Serializer>(tips: &AttachedTips, serializer: S) -> Result<S::Ok, S::Error> {
    tips.as_slice().serialize(serializer)
}

fn from_list<'de, D: Deserializer<'de>>(deserializer: D) -> Result<AttachedTips, D::Error> {
    Vec::deserialize(deserializer).map(AttachedTips::from_vec)
}

impl Row {
    /// Sum of the signed interaction forces of all pairs of holders (N), Eq. (4): positive when they pull apart.
    pub fn interaction(&self) -> f64 {
        let pairs = self.tips.iter().enumerate().flat_map(|(at, a)| self.tips[at + 1..].iter().map(move |b| (a, b)));
        pairs.map(|(a, b)| interaction_force([a.position, b.position], [a.pull, b.pull])).fold(0.0, |sum, force| sum + force)
    }
}

/// Something that happened at an instant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// (s)
    pub time: f64,
    pub spring: usize,
    /// The ant that did it; `None` for a prescribed path.
    pub ant: Option<usize>,
    /// Tip at that instant (m, world).
    pub tip: Vec2,
    pub kind: EventKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    Grasp,
    Release,
}

/// How a run ended and what it amounts to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// End of the run (s).
    pub time: f64,
    pub motion: Motion,
    pub energy: EnergyLedger,
    pub steps: StepReport,
    /// As the backend saw them; none of one that cannot tell.
    #[serde(default)]
    pub transitions: TransitionCounts,
    /// How far the pose was wrong at worst; `None` where the backend does not know.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<PoseError>,
    /// Whether the load reached the nest; `None` without ants.
    pub arrived: Option<bool>,
    /// Size of the pulls at the ants' release decisions, the grasp included (N).
    pub pulls: Summary,
}
