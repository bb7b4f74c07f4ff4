//! An engine that a study asks: made anew for each run, so that what is wrong in one run says
//! nothing of the next.

use std::cell::RefCell;
use std::ops::Deref;

use cohaul::backend::{Backend, BackendKind, BackendOptions, Motion, RapierOptions, Unmoved};
use cohaul::model::{Outline, System};
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Keep, Simulation, backend_of, controller_of};
use cohaul_engines::{Engine, NoStart};

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

/// The backend that the options name.
///
/// # Errors
/// Never: it is a [`Meet`].
pub fn own(scenario: &Scenario, options: &BackendOptions) -> Result<Fresh, Ended> {
    Ok(Fresh { backend: backend_of(scenario, options), complaint: Box::new(|| None) })
}

/// An engine of this library.
pub fn built_in(kind: BackendKind, rapier: RapierOptions) -> impl Fn(&Scenario, &BackendOptions) -> Result<Fresh, Ended> + Sync {
    move |scenario, options| own(scenario, &BackendOptions { kind, rapier, ..*options })
}

/// An engine of the user.
pub fn of_user<'a>(engine: &'a Engine) -> impl Fn(&Scenario, &BackendOptions) -> Result<Fresh, Ended> + Sync + 'a {
    |scenario, options| match engine.once(scenario, options) {
        Ok((backend, complaint)) => Ok(Fresh { backend, complaint: Box::new(move || complaint.text()) }),
        Err(NoStart::Refused(_, why)) => Err(Ended::Refused(why)),
        Err(NoStart::Wrong(what)) => Err(Ended::Failed(what)),
    }
}

/// Says why a run has no answer.
type End = Box<dyn Fn() -> Option<Ended>>;

/// Runs of one engine at the same options, for questions that go on whatever becomes of them.
pub struct Runs<'a> {
    options: BackendOptions,
    meet: &'a Meet<'a>,
    ends: RefCell<Vec<End>>,
}

impl Runs<'static> {
    /// Runs of the backend that the options name.
    pub fn of(options: BackendOptions) -> Self {
        Self::by(&own, options)
    }
}

impl<'a> Runs<'a> {
    pub fn by(meet: &'a Meet<'a>, options: BackendOptions) -> Self {
        Self { options, meet, ends: RefCell::default() }
    }

    /// A run of a load from a start, whose outline is its disc if it has none. Without an engine it
    /// fails at its first step.
    pub fn start(&self, system: &System, start: Motion) -> Box<dyn Backend> {
        let mut system = system.clone();
        if system.world.is_empty() {
            system.world.outline = Outline::disc(system.load.radius);
        }
        let drive = Drive::Tips(Vec::new());
        let scenario = Scenario { name: String::new(), duration: 1.0, control_period: 1.0, seed: 0, system, start, drive };
        self.backend(&scenario, &self.options)
    }

    /// A run of a scenario with its own controller, at other options.
    pub fn simulation<'s>(&self, scenario: &'s Scenario, options: &BackendOptions, keep: Keep) -> Simulation<'s> {
        Simulation::from_parts(scenario, options, keep, controller_of(scenario), self.backend(scenario, options))
    }

    fn backend(&self, scenario: &Scenario, options: &BackendOptions) -> Box<dyn Backend> {
        let mut ends = self.ends.borrow_mut();
        match (self.meet)(scenario, options) {
            Ok(Fresh { backend, complaint }) => {
                ends.push(Box::new(move || complaint().map(Ended::Failed)));
                backend
            }
            Err(ended) => {
                ends.push(Box::new(move || Some(ended.clone())));
                Box::new(Unmoved(scenario.start))
            }
        }
    }

    /// Why there is no answer, if there is none.
    pub fn ended(&self) -> Option<Ended> {
        self.ends.borrow().iter().find_map(|end| end())
    }
}

impl Deref for Runs<'_> {
    type Target = BackendOptions;

    fn deref(&self) -> &BackendOptions {
        &self.options
    }
}
