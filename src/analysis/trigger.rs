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
    /// After a grasp, a release or another quasi-static jump (m).
    pub jumps_m: f64,
    /// After a release (m).
    #[serde(default)]
    pub release_m: f64,
    /// After a grasp (m).
    #[serde(default)]
    pub grasp_m: f64,
    /// While the tips drive the load, or stop; slip onsets and contacts included (m).
    pub driving_m: f64,
    /// After a slip onset (m).
    #[serde(default)]
    pub slip_onset_m: f64,
    /// After a contact with an obstacle began, changed or ended (m).
    #[serde(default)]
    pub contact_m: f64,
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
    /// Adds an inertia effect (m) after a trigger of this kind.
    pub fn add(&mut self, kind: TriggerKind, effect: f64) {
        let Self { start_m, jumps_m, release_m, grasp_m, driving_m, slip_onset_m, contact_m } = self;
        let parts = match kind {
            TriggerKind::Start => [Some(start_m), None],
            TriggerKind::Release => [Some(jumps_m), Some(release_m)],
            TriggerKind::Grasp => [Some(jumps_m), Some(grasp_m)],
            TriggerKind::Jump => [Some(jumps_m), None],
            TriggerKind::SlipOnset => [Some(driving_m), Some(slip_onset_m)],
            TriggerKind::Contact => [Some(driving_m), Some(contact_m)],
            _ => [Some(driving_m), None],
        };
        parts.into_iter().flatten().for_each(|part| *part = part.max(effect));
    }

    /// Largest effect after triggers of this kind, or of those that are counted with it (m).
    pub fn of(&self, kind: TriggerKind) -> f64 {
        match kind {
            TriggerKind::Start => self.start_m,
            TriggerKind::Release => self.release_m,
            TriggerKind::Grasp => self.grasp_m,
            TriggerKind::Jump => self.jumps_m,
            TriggerKind::SlipOnset => self.slip_onset_m,
            TriggerKind::Contact => self.contact_m,
            _ => self.driving_m,
        }
    }

    /// Parts (m) with their names. Jumps and driving are left out where they are no more than their
    /// own parts.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, f64)> + use<> {
        let beyond = |all: f64, parts: [f64; 2]| if all > parts[0].max(parts[1]) { all } else { 0.0 };
        [
            ("start", self.start_m),
            ("release", self.release_m),
            ("grasp", self.grasp_m),
            ("jump", beyond(self.jumps_m, [self.release_m, self.grasp_m])),
            ("slip onset", self.slip_onset_m),
            ("contact", self.contact_m),
            ("driving", beyond(self.driving_m, [self.slip_onset_m, self.contact_m])),
        ]
        .into_iter()
    }

    /// Largest of all (m).
    pub fn max(&self) -> f64 {
        self.start_m.max(self.jumps_m).max(self.driving_m)
    }
}
