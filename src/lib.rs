//! Simulates how ants or robots drag one load together, and measures whether inertia may be
//! neglected.
//!
//! The same grasps, releases and tip motions drive three models of the load: quasi-static (no
//! inertia), inertial (the same springs and exact friction with the mass matrix), and the
//! rigid-body engine rapier2d. Two differences and one bound follow from them:
//!
//! ```text
//! inertia effect  = inertial - quasi-static
//! engine error    = rapier   - inertial
//! reference error = bound of the numerical error of the quasi-static and the inertial path
//! ```
//!
//! ```
//! use cohaul::{Scenario, Settings, ThreeWay, Verdict};
//!
//! let scenario = Scenario::read("scenarios/analytic/release-jump.json".as_ref())?;
//! let compared = ThreeWay::new(&scenario, &Settings::default()).prescribed(|_share| true);
//! let found = compared.expect("it is not stopped");
//! // The load jumps when the spring is released; one with inertia takes time for that, and the
//! // engine errs by more than the tolerance as well.
//! assert_eq!(found.verdict, Verdict::InertiaAndEngine);
//! # Ok::<(), cohaul::ScenarioError>(())
//! ```
//!
//! Start with [`Scenario`] and [`Simulation`] for one run, and with [`ThreeWay`] for a comparison.
//! A model of your own implements [`Backend`], and a controller of your own implements
//! [`Controller`]. Units are SI; angles are in radians, counter-clockwise.
//!
//! The feature `rapier-f32` (default) adds rapier in single precision.
#![forbid(unsafe_code)]

pub mod analysis;
pub mod backend;
pub mod formats;
pub mod math;
pub mod model;
pub mod scenario;
pub mod simulation;
pub mod stop;

pub use analysis::compare::{
    Cause, ClosedLoop, Difference, Distribution, Divergence, Doubt, DoubtKind, EdgeDisplacement, FirstDifferentDecision, FirstDivergence,
    MakeController, Measure, MeasureVerdict, Numbers, Open, PairedDifference, Pathwise, Point, Predicted, QuantityVerdict, ReferenceError,
    RunMeasure, SeedDoubt, SeedRuns, Settings, Solution, SuggestedChange, ThreeWay, Tier, Verdict, Verdicts,
};
pub use analysis::estimate::{Estimator, InertiaEstimate, Largest, with_estimate};
pub use analysis::{ByTrigger, Trigger, TriggerKind};
pub use backend::rapier::{EngineSettings, FrictionModel, Precision, SpringModel};
pub use backend::{
    AttachedTip, AttachedTips, Backend, BackendKind, BackendOptions, ConeSolver, DefectParts, Doubts, EnergyLedger, Integrator, Motion,
    PoseError, RapierOptions, RestoreError, SaveError, SavedState, Setting, Skip, SkipCounts, Skips, Status, StepReport, Tolerance,
    Transition, TransitionCounts, TransitionKind, build, default_step, step_of,
};
pub use math::{Interval, Pose, Summary, Twist, Vec2, Wrench};
pub use model::behaviour::{GraspPace, HalfAngle, ReleaseLaw, ReleasePace};
pub use model::{
    Ground, Load, Obstacle, ObstaclePath, Outline, OutlinePart, PolarSpring, Reaction, SpringDesign, SpringShape, SupportPoint, System,
    World, interaction_force,
};
pub use scenario::{AntDrive, Drive, Finding, Scenario, ScenarioError, TipPath, Waypoint};
pub use simulation::{
    Ants, Commands, Controller, DoubtTimes, Event, EventKind, Keep, MakeBackend, Outcome, Replay, Row, SavedRun, Simulation, Tips, Trace,
    View,
};

/// The examples of the book run as tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/src/library.md")]
struct Book;
