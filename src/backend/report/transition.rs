//! Instants at which the motion of the load is not smooth: slip onset, stop, pinning to a support,
//! unpinning, jump, and what happens at obstacles.

use serde::{Deserialize, Serialize};

/// An instant at which the motion of the load is not smooth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Transition {
    /// Time since the start of the advance in a backend, and since the start of the run in a trace
    /// (s). Fixed steps report their end.
    pub time: f64,
    #[serde(flatten)]
    pub kind: TransitionKind,
}

/// Kind of a transition.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "transition", rename_all = "snake_case")]
pub enum TransitionKind {
    /// The load begins to move, with all its supports or about one of them.
    SlipOnset,
    /// The load comes to rest.
    Stop,
    /// A support stops slipping, and the load turns about it.
    Pinning { support: usize },
    /// The support that the load turned about slips.
    Unpinning { support: usize },
    /// The load touches an obstacle that it did not touch.
    Touch { obstacle: usize },
    /// The load parts from an obstacle.
    Separation { obstacle: usize },
    /// A contact with an obstacle begins to stick or to roll.
    SideStick { obstacle: usize },
    /// A contact with an obstacle begins to slide.
    SideSlip { obstacle: usize },
    /// The load hits an obstacle with a finite speed, with or without a loss.
    Impact {
        obstacle: usize,
        /// Energy lost (J).
        energy: f64,
        /// The law that its velocity follows.
        law: ImpactLaw,
    },
    /// Another motion is admissible from here: the motion is not unique.
    NotUnique { obstacle: usize },
    /// No step keeps the load out of obstacles that press on it, of which this is one.
    Squeeze { obstacle: usize },
    /// A load without inertia moves by a finite displacement in no time.
    Jump {
        /// Shift of the load's origin (m).
        shift: f64,
        /// (rad)
        turn: f64,
        /// Energy that would have set a load with inertia in motion (J).
        energy: f64,
        /// Whether the end depends on what dissipates besides friction. Only runs under error
        /// control look, and only without obstacles; elsewhere it is `false`.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        is_uncertain: bool,
    },
}

/// The law that gave the velocity after an impact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ImpactLaw {
    /// Newton's law: every contact parts at its coefficient of restitution times its speed of
    /// approach, or faster.
    Newton,
    /// Poisson's law: the impulses of the plastic impact are scaled by one plus the coefficient of
    /// restitution. It is used where Newton's law gains energy or has no answer.
    Poisson,
    /// No law has an answer, and the load keeps its velocity. The step has not converged.
    None,
    /// The contact solver of the physics engine, which follows none of these laws.
    Engine,
}

/// Number of transitions of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TransitionCounts {
    pub n_slip_onset: u64,
    pub n_stop: u64,
    pub n_pinning: u64,
    pub n_unpinning: u64,
    #[serde(default, skip_serializing_if = "is_none")]
    pub n_touch: u64,
    #[serde(default, skip_serializing_if = "is_none")]
    pub n_separation: u64,
    #[serde(default, skip_serializing_if = "is_none")]
    pub n_side_stick: u64,
    #[serde(default, skip_serializing_if = "is_none")]
    pub n_side_slip: u64,
    #[serde(default, skip_serializing_if = "is_none")]
    pub n_impacts: u64,
    #[serde(default, skip_serializing_if = "is_none")]
    pub n_not_unique: u64,
    #[serde(default, skip_serializing_if = "is_none")]
    pub n_squeezes: u64,
    /// Impacts for which Newton's law gained energy or had no answer.
    #[serde(default, skip_serializing_if = "is_none")]
    pub n_impacts_by_poisson: u64,
    /// Impacts for which no law had an answer.
    #[serde(default, skip_serializing_if = "is_none")]
    pub n_impacts_without_law: u64,
    pub n_jumps: u64,
    /// Jumps whose end depends on what dissipates besides friction, as far as the run looks.
    #[serde(default, skip_serializing_if = "is_none")]
    pub n_uncertain_jumps: u64,
    /// Largest shift in a jump (m); `None` without any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_jump: Option<f64>,
}

fn is_none(count: &u64) -> bool {
    *count == 0
}

impl ImpactLaw {
    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Newton => "newton",
            Self::Poisson => "poisson",
            Self::None => "none",
            Self::Engine => "engine",
        }
    }
}

impl TransitionCounts {
    pub fn add(&mut self, kind: &TransitionKind) {
        match kind {
            TransitionKind::SlipOnset => self.n_slip_onset += 1,
            TransitionKind::Stop => self.n_stop += 1,
            TransitionKind::Pinning { .. } => self.n_pinning += 1,
            TransitionKind::Unpinning { .. } => self.n_unpinning += 1,
            TransitionKind::Touch { .. } => self.n_touch += 1,
            TransitionKind::Separation { .. } => self.n_separation += 1,
            TransitionKind::SideStick { .. } => self.n_side_stick += 1,
            TransitionKind::SideSlip { .. } => self.n_side_slip += 1,
            TransitionKind::NotUnique { .. } => self.n_not_unique += 1,
            TransitionKind::Squeeze { .. } => self.n_squeezes += 1,
            TransitionKind::Impact { law, .. } => {
                self.n_impacts += 1;
                self.n_impacts_by_poisson += u64::from(*law == ImpactLaw::Poisson);
                self.n_impacts_without_law += u64::from(*law == ImpactLaw::None);
            }
            TransitionKind::Jump { shift, is_uncertain, .. } => {
                self.n_jumps += 1;
                self.n_uncertain_jumps += u64::from(*is_uncertain);
                self.largest_jump = Some(self.largest_jump.map_or(*shift, |largest| largest.max(*shift)));
            }
        }
    }
}

impl TransitionKind {
    /// Obstacle at which it happens; `None` for a transition of the load on the ground.
    pub fn obstacle(&self) -> Option<usize> {
        match self {
            TransitionKind::Touch { obstacle }
            | TransitionKind::Separation { obstacle }
            | TransitionKind::SideStick { obstacle }
            | TransitionKind::SideSlip { obstacle }
            | TransitionKind::Impact { obstacle, .. }
            | TransitionKind::NotUnique { obstacle }
            | TransitionKind::Squeeze { obstacle } => Some(*obstacle),
            _ => None,
        }
    }

    /// Name of the kind in plain words.
    pub fn name(&self) -> &'static str {
        match self {
            TransitionKind::SlipOnset => "slip_onset",
            TransitionKind::Stop => "stop",
            TransitionKind::Pinning { .. } => "pinning",
            TransitionKind::Unpinning { .. } => "unpinning",
            TransitionKind::Touch { .. } => "touch",
            TransitionKind::Separation { .. } => "separation",
            TransitionKind::SideStick { .. } => "side_stick",
            TransitionKind::SideSlip { .. } => "side_slip",
            TransitionKind::Impact { .. } => "impact",
            TransitionKind::NotUnique { .. } => "not_unique",
            TransitionKind::Squeeze { .. } => "squeeze",
            TransitionKind::Jump { .. } => "jump",
        }
    }
}
