//! An engine as a comparison uses it: by its name, and anew for each run.

use std::sync::Arc;

use cohaul::analysis::compare::{EngineName, Pathwise, ThreeWay, Tier};
use cohaul::backend::{Backend, BackendOptions, Unmoved};
use cohaul::scenario::Scenario;
use cohaul::simulation::backend_of;

use crate::channel::{Channel, Complaint};
use crate::driven::{Driven, NoStart};

/// A way to open a channel to a new run of an engine.
pub type Open<'a> = dyn Fn() -> Result<Box<dyn Channel>, String> + Sync + 'a;

/// An engine that has named itself, or rapier.
pub struct Engine<'a> {
    name: EngineName,
    /// `None` for rapier.
    open: Option<&'a Open<'a>>,
    /// Why it does not take the scenario that it was met on.
    refused: Option<String>,
    complaint: Arc<Complaint>,
}

impl<'a> Engine<'a> {
    /// Starts a run of the engine on a scenario, to learn its name and whether it takes it.
    ///
    /// # Errors
    /// When it does not start, in words.
    pub fn meet(open: &'a Open<'a>, scenario: &Scenario, options: &BackendOptions) -> Result<Self, String> {
        let complaint = Arc::new(Complaint::default());
        let (name, refused) = match Driven::start(open()?, scenario, options, &complaint) {
            Ok((_, name)) => (name, None),
            Err(NoStart::Refused(name, why)) => (name, Some(why)),
            Err(NoStart::Wrong(what)) => return Err(what),
        };
        Ok(Self { name, open: Some(open), refused, complaint })
    }

    /// The engine that the library has itself, in this version.
    pub fn rapier(version: &str) -> Self {
        let name = EngineName { version: Some(version.to_owned()), ..ThreeWay::RAPIER };
        Self { name, open: None, refused: None, complaint: Arc::default() }
    }

    /// Those that take the scenario that they were met on, and those that refuse it.
    ///
    /// # Errors
    /// When none takes it, with what each says.
    pub fn willing(engines: &[Self]) -> Result<(Vec<&Self>, Vec<&Self>), String> {
        let (willing, refusing): (Vec<&Self>, Vec<&Self>) = engines.iter().partition(|engine| engine.refused.is_none());
        if willing.is_empty() {
            let says = |engine: &&Self| format!("{} refuses the scene: {}", engine.name.name, engine.refused().unwrap_or_default());
            return Err(refusing.iter().map(says).collect::<Vec<_>>().join("; "));
        }
        Ok((willing, refusing))
    }

    /// # Errors
    /// When two engines have one name, and tables could not tell them apart.
    pub fn check_names(engines: &[Self]) -> Result<(), String> {
        let names: Vec<&str> = engines.iter().map(|engine| &*engine.name.name).collect();
        match names.iter().enumerate().find(|(at, name)| names[..*at].contains(name)) {
            Some((_, name)) => Err(format!("must be engines of different names, found {name} twice")),
            None => Ok(()),
        }
    }

    /// A single run, whose faults are its own.
    ///
    /// # Errors
    /// When it does not start.
    pub fn once(&self, scenario: &Scenario, options: &BackendOptions) -> Result<(Box<dyn Backend>, Arc<Complaint>), NoStart> {
        let complaint = Arc::new(Complaint::default());
        let Some(open) = self.open else { return Ok((backend_of(scenario, options), complaint)) };
        let (driven, _) = Driven::start(open().map_err(NoStart::Wrong)?, scenario, options, &complaint)?;
        Ok((Box::new(driven), complaint))
    }

    pub fn name(&self) -> &EngineName {
        &self.name
    }

    /// Why it does not take the scenario that it was met on, if it does not.
    pub fn refused(&self) -> Option<&str> {
        self.refused.as_deref()
    }

    /// Whether nothing was wrong so far.
    pub fn is_well(&self) -> bool {
        !self.complaint.is_made()
    }

    /// What was wrong first, in any run.
    pub fn complaint(&self) -> Option<String> {
        self.complaint.text()
    }

    /// A new run of the engine. One that does not start fails at its first step.
    pub fn backend(&self, scenario: &Scenario, options: &BackendOptions) -> Box<dyn Backend> {
        let Some(open) = self.open else { return backend_of(scenario, options) };
        match open().map_err(NoStart::Wrong).and_then(|channel| Driven::start(channel, scenario, options, &self.complaint)) {
            Ok((driven, _)) => Box::new(driven),
            Err(what) => {
                self.complaint.make(format!("{}: {what}", self.name.name));
                Box::new(Unmoved(scenario.start))
            }
        }
    }

    /// Compares the paths of the engine in a tier of paths, beside the exact ones of `another`
    /// engine's if there is one; `None` when `watch`, which gets the share done (1), said no.
    pub fn paths(&self, runs: ThreeWay, tier: Tier, another: Option<&Pathwise>, watch: impl Fn(f64) -> bool + Sync) -> Option<Pathwise> {
        let make = |scenario: &Scenario, options: &BackendOptions| self.backend(scenario, options);
        let runs = runs.engine(&make).named(&self.name);
        let runs = another.map_or(runs, |another| runs.beside(another));
        let watch = |share: f64| watch(share) && self.is_well();
        match tier {
            Tier::Prescribed => runs.prescribed(watch),
            Tier::Controlled => runs.controlled(watch),
            Tier::Replayed | Tier::ClosedLoop => runs.replayed(watch),
        }
    }
}
