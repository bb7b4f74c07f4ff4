//! An engine as a comparison uses it: by its name, and anew for each run.

use std::sync::Arc;

use cohaul::analysis::compare::{EngineName, ThreeWay};
use cohaul::backend::{Backend, BackendOptions, EnergyLedger, Motion, Status, StepReport};
use cohaul::math::Vec2;
use cohaul::scenario::Scenario;
use cohaul::simulation::backend_of;

use crate::channel::{Channel, Complaint};
use crate::driven::Driven;

/// A way to open a channel to a new run of an engine.
pub type Open<'a> = dyn Fn() -> Result<Box<dyn Channel>, String> + Sync + 'a;

/// An engine that has named itself, or rapier.
pub struct Engine<'a> {
    name: EngineName,
    /// `None` for rapier.
    open: Option<&'a Open<'a>>,
    complaint: Arc<Complaint>,
}

impl<'a> Engine<'a> {
    /// Starts a run of the engine on a scenario, to learn its name.
    ///
    /// # Errors
    /// When it does not start, in words.
    pub fn meet(open: &'a Open<'a>, scenario: &Scenario, options: &BackendOptions) -> Result<Self, String> {
        let complaint = Arc::new(Complaint::default());
        let (_, started) = Driven::start(open()?, scenario, options, &complaint)?;
        Ok(Self { name: EngineName { name: started.name.into(), version: started.version }, open: Some(open), complaint })
    }

    /// The engine that the library has itself, in this version.
    pub fn rapier(version: &str) -> Self {
        let name = EngineName { version: Some(version.to_owned()), ..ThreeWay::RAPIER };
        Self { name, open: None, complaint: Arc::default() }
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
    /// When it does not start, in words.
    pub fn once(open: &Open, scenario: &Scenario, options: &BackendOptions) -> Result<(Box<dyn Backend>, Arc<Complaint>), String> {
        let complaint = Arc::new(Complaint::default());
        let (driven, _) = Driven::start(open()?, scenario, options, &complaint)?;
        Ok((Box::new(driven), complaint))
    }

    pub fn name(&self) -> &EngineName {
        &self.name
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
        match open().and_then(|channel| Driven::start(channel, scenario, options, &self.complaint)) {
            Ok((driven, _)) => Box::new(driven),
            Err(what) => {
                self.complaint.make(format!("{}: {what}", self.name.name));
                Box::new(Broken { motion: scenario.start })
            }
        }
    }
}

/// A run that has not started.
struct Broken {
    motion: Motion,
}

impl Backend for Broken {
    fn attach(&mut self, _: usize, _: Vec2) {}

    fn release(&mut self, _: usize) {}

    fn advance(&mut self, _: &[Vec2], _: f64) -> StepReport {
        StepReport { status: Status::Failed, ..StepReport::default() }
    }

    fn motion(&self) -> Motion {
        self.motion
    }

    fn tip(&self, _: usize) -> Option<Vec2> {
        None
    }

    fn pull(&self, _: usize) -> Vec2 {
        Vec2::zeros()
    }

    fn energy(&self) -> EnergyLedger {
        EnergyLedger::default()
    }
}
