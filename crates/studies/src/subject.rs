//! An engine that a study asks: made anew for each run, so that what is wrong in one run says
//! nothing of the next.

use cohaul::backend::{Backend, BackendKind, BackendOptions, RapierOptions};
use cohaul::scenario::Scenario;
use cohaul::simulation::backend_of;

/// A run of an engine that has not moved yet.
pub struct Fresh {
    pub backend: Box<dyn Backend>,
    /// What was wrong with the engine in this run so far, in words.
    pub complaint: Complaint,
}

/// Says what was wrong with an engine.
pub type Complaint = Box<dyn Fn() -> Option<String> + Send>;

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The engine does not take the scene.
    Refused(String),
    /// Something was wrong with the engine.
    Failed(String),
    /// The user stopped the work.
    Stopped,
}

/// Makes a run of the engine for a scenario, in steps as long as the options say at most.
pub type Meet<'a> = dyn Fn(&Scenario, &BackendOptions) -> Result<Fresh, Ended> + Sync + 'a;

/// An engine of this library.
pub fn built_in(kind: BackendKind, rapier: RapierOptions) -> impl Fn(&Scenario, &BackendOptions) -> Result<Fresh, Ended> + Sync {
    move |scenario, options| {
        let options = BackendOptions { kind, rapier, ..*options };
        Ok(Fresh { backend: backend_of(scenario, &options), complaint: Box::new(|| None) })
    }
}
