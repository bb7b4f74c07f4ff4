//! What a page asks and what it receives: one JSON object a message.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::hand::Handle;
use super::parameters::Parameter;
use super::settings::Settings;
use cohaul::analysis::compare::Numbers;
use cohaul::formats::{Format, Found};
use cohaul::scenario::cut;
use cohaul_report::page::Replay;

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Ask {
    Play,
    Pause,
    /// One control period.
    Step,
    /// Back to the start of the scene, with all that was dragged.
    Restart,
    GoTo {
        time_s: f64,
    },
    /// Simulated time over real time (1).
    Pace {
        factor: f64,
    },
    /// The page has drawn this frame. Only a few frames are sent ahead of it.
    Drawn {
        frame: u64,
    },
    /// A parameter, by its key.
    Set {
        what: String,
        value: f64,
    },
    Settings {
        settings: Settings,
    },
    /// Takes a tip or a pusher towards a place (m, world), until it is dropped.
    Drag {
        handle: Handle,
        to: [f64; 2],
    },
    Drop,
    /// Lets go of the tip of a spring.
    Release {
        spring: usize,
    },
    Ants {
        on: bool,
    },
    /// A scene that comes with the program.
    Shipped {
        name: String,
    },
    Open {
        saved: Saved,
    },
    Save,
    /// Hands the scene to who opened the page, and ends the server.
    HandBack,
}

/// Everything that a page shows, as a file or a link holds it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Saved {
    /// `None` in what a program without versions saved, which is of the first one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub format: Option<Found>,
    pub scenario: Value,
    #[serde(default)]
    pub settings: Settings,
    #[serde(default)]
    pub time_s: f64,
    /// The scene as it was opened, from which sliders reach; none where it is `scenario`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base: Option<Value>,
    /// Speed of the drive over that of the base (1).
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub speed: f64,
}

fn one() -> f64 {
    1.0
}

fn is_one(speed: &f64) -> bool {
    *speed == 1.0
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "tell", rename_all = "kebab-case")]
pub enum Tell {
    Scene(Box<SceneNow>),
    Frame(Frame),
    Estimate(Estimated),
    Comparing {
        /// Part of the comparison that is done (1).
        share: f64,
    },
    Verdict(Judged),
    Saved(Saved),
    /// The scene that was handed back.
    Handed(Saved),
    /// What was asked is not done, with the reason.
    Refused {
        why: String,
    },
}

/// Longest reason (characters). It may quote a message of any length.
const LONGEST_REASON: usize = 5000;

impl Tell {
    /// A refusal for this reason, which is cut if it is long.
    pub fn refused(why: String) -> Self {
        Tell::Refused { why: cut(why, LONGEST_REASON) }
    }
}

/// The scene after a change.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneNow {
    /// Format of all messages.
    pub format: Format,
    pub name: String,
    /// As a replay of no length: outlines, springs, nest.
    pub replay: Replay,
    pub duration_s: f64,
    pub control_period_s: f64,
    pub parameters: Vec<Parameter>,
    pub numbers: Numbers,
    pub settings: Settings,
    /// Names of all backends, shown or not.
    pub all_backends: Vec<&'static str>,
    /// Step of each of all backends (s).
    pub steps_s: Vec<f64>,
    /// Numbers of the obstacles that can be dragged.
    pub pushers: Vec<usize>,
    /// Whether the scene has ants that can be switched on.
    pub has_ants: bool,
    pub ants_on: bool,
    pub shipped: Vec<&'static str>,
}

/// All backends at one time. Numbers that are not finite are left out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Frame {
    pub frame: u64,
    pub time_s: f64,
    pub is_playing: bool,
    pub has_ended: bool,
    /// Time that computing took over the simulated time, since the last frame (1).
    pub share: Option<f64>,
    /// Tips and ants: one for all, or one for each backend whose ants decide for themselves.
    pub stages: Vec<StageNow>,
    pub lanes: Vec<LaneNow>,
    /// x, y and heading of each obstacle that moves, in the order of `pushers`.
    pub pushers: Vec<[f64; 3]>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageNow {
    /// Tip of each spring that is drawn (m); none of a free one.
    pub tips: Vec<Option<[f64; 2]>>,
    /// x, y, heading, and whether it holds a tip (0 or 1).
    pub ants: Vec<[f64; 4]>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LaneNow {
    /// x, y (m) and heading (rad).
    pub pose: Option<[f64; 3]>,
    /// Velocity (m/s) and turn rate (rad/s).
    pub twist: Option<[f64; 3]>,
    /// Size of the pull of each spring that is drawn (N).
    pub pulls: Vec<Option<f64>>,
    /// x, y (m), force on the load along x and y (N), and number of the obstacle.
    pub contacts: Vec<[f64; 5]>,
    /// Elastic energy, kinetic energy and energy dissipated so far (J).
    pub energy: Option<[f64; 3]>,
    /// Whether the run can be trusted so far: `ok`, `doubtful` or `failed`.
    pub status: &'static str,
    /// What happened, if it is not ok.
    pub cause: &'static str,
    pub has_arrived: bool,
}

/// What a quasi-static run alone says of the inertia effect, at once.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimated {
    /// `yes`, `no` or `open`: whether inertia is negligible.
    pub negligible: &'static str,
    pub sentence: String,
}

/// Result of a comparison of the scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judged {
    /// `yes`, `no`, `partly` or `open`: whether quasi-static is valid.
    pub valid: &'static str,
    pub answer: String,
    /// Name, inertia effect and engine error over the tolerance, and verdict in words.
    pub quantities: Vec<(&'static str, Option<f64>, Option<f64>, String)>,
    /// Numbers of the run; none where there was no comparison.
    pub numbers: Option<Numbers>,
}
