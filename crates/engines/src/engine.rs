//! An engine as a comparison uses it: by its name, and anew for each run.

use std::sync::Arc;

use cohaul::analysis::compare::EngineName;
use cohaul::backend::{Backend, BackendOptions, EnergyLedger, Motion, Status, StepReport};
use cohaul::math::Vec2;
use cohaul::scenario::Scenario;

use crate::channel::{Channel, Complaint};
use crate::driven::Driven;

/// A way to open a channel to a new run of an engine.
pub type Open<'a> = dyn Fn() -> Result<Box<dyn Channel>, String> + Sync + 'a;

/// An engine that has named itself.
pub struct Engine<'a> {
    name: EngineName,
    open: &'a Open<'a>,
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
        Ok(Self { name: EngineName { name: started.name.into(), version: started.version }, open, complaint })
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
        match (self.open)().and_then(|channel| Driven::start(channel, scenario, options, &self.complaint)) {
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
