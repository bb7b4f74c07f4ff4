//! Triggers: what an inertia effect or a divergence of two paths is attributed to.

use serde::{Deserialize, Serialize};

/// Event or state of the load to which a difference between two paths is attributed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trigger {
    pub kind: TriggerKind,
    /// Spring that was grasped or released; left out for other triggers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spring: Option<usize>,
    /// Support that was pinned or unpinned; left out for other triggers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub support: Option<usize>,
    /// Obstacle that the load touched or left; left out for other triggers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub obstacle: Option<usize>,
    /// Time at which it happened (s).
    pub time_s: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TriggerKind {
    /// The load starts with speed.
    Start,
    Grasp,
    Release,
    /// The load begins to move.
    SlipOnset,
    /// The load comes to rest.
    Stop,
    /// One support stops slipping, and the load turns about it.
    Pinning,
    /// The support that the load turned about slips again.
    Unpinning,
    /// The quasi-static load jumps.
    Jump,
    /// The load touches, hits or leaves an obstacle, or begins to stick or slide there.
    Contact,
    /// The tips drive the load, or stop.
    Driving,
}

/// Largest inertia effects, as edge displacements, by what they are attributed to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ByTrigger {
    /// After a start with speed (m).
    pub start_m: f64,
    /// After a grasp, a release or a quasi-static jump (m).
    pub jumps_m: f64,
    /// While the tips drive the load, or stop (m).
    pub driving_m: f64,
}

impl Trigger {
    pub fn new(kind: TriggerKind, time_s: f64) -> Self {
        Self { kind, spring: None, support: None, obstacle: None, time_s }
    }

    /// Plain name, such as `release of spring 1`.
    pub fn name(&self) -> String {
        let kind = match self.kind {
            TriggerKind::Start => "start with speed",
            TriggerKind::Grasp => "grasp",
            TriggerKind::Release => "release",
            TriggerKind::SlipOnset => "slip onset",
            TriggerKind::Stop => "stop",
            TriggerKind::Pinning => "pinning",
            TriggerKind::Unpinning => "unpinning",
            TriggerKind::Jump => "quasi-static jump",
            TriggerKind::Contact => "contact",
            TriggerKind::Driving => "change of speed",
        };
        match (self.spring, self.support, self.obstacle) {
            (Some(spring), _, _) => format!("{kind} of spring {spring}"),
            (_, Some(support), _) => format!("{kind} of support {support}"),
            (_, _, Some(obstacle)) => format!("{kind} with obstacle {obstacle}"),
            _ => kind.to_owned(),
        }
    }
}

impl ByTrigger {
    /// Share of the triggers of one kind.
    pub(crate) fn of_mut(&mut self, kind: TriggerKind) -> &mut f64 {
        match kind {
            TriggerKind::Start => &mut self.start_m,
            TriggerKind::Grasp | TriggerKind::Release | TriggerKind::Jump => &mut self.jumps_m,
            _ => &mut self.driving_m,
        }
    }

    /// All parts (m) with their names.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, f64)> + use<> {
        [("start", self.start_m), ("jumps", self.jumps_m), ("driving", self.driving_m)].into_iter()
    }

    /// Largest of all (m).
    pub fn max(&self) -> f64 {
        self.start_m.max(self.jumps_m).max(self.driving_m)
    }
}
