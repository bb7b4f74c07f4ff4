//! What figures are drawn of: traces with their names, and the surroundings of the load.

use cohaul::math::Vec2;
use cohaul::model::World;
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::Trace;

/// Print units over SI units: mm, mN.
pub const MILLI: f64 = 1e3;

/// A trace and its name in legends.
#[derive(Clone, Copy, Debug)]
pub struct Labelled<'a> {
    pub label: &'a str,
    pub trace: &'a Trace,
}

impl<'a> Labelled<'a> {
    /// Traces of the runs that are compared, with their names.
    pub fn compared(names: [&'a str; 3], traces: impl IntoIterator<Item = &'a Trace>) -> Vec<Self> {
        names.into_iter().zip(traces).map(|(label, trace)| Self { label, trace }).collect()
    }
}

/// Surroundings of a trace in its figures. Entries that are zero or `None` are not drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Outline of the load, and obstacles.
    pub world: World,
    /// Sum of the slip limits: the net pull that moves the load (N).
    pub slip_limit: f64,
    pub nest: Option<Nest>,
    /// Radius with which a difference of headings becomes an edge displacement (m).
    pub radius: f64,
    /// Largest edge displacement (m), and difference of headings (rad), at which paths agree.
    pub tolerances: Option<[f64; 2]>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nest {
    /// (m, world)
    pub position: Vec2,
    /// (m)
    pub arrival_radius: f64,
}

impl Scene {
    pub fn of(scenario: &Scenario) -> Self {
        let nest = match &scenario.drive {
            Drive::Ants(ants) => Some(Nest { position: ants.nest_position, arrival_radius: ants.arrival_radius }),
            Drive::Tips(_) => None,
        };
        let system = &scenario.system;
        let (slip_limit, radius) = (system.total_slip_limit(), system.load.radius);
        Self { world: system.world.clone(), slip_limit, nest, radius, tolerances: None }
    }

    /// With obstacles that were steered on the paths that they took in a run.
    pub fn steered_as(self, run: &Trace) -> Self {
        Self { world: run.world(&self.world), ..self }
    }

    /// With the tolerances of a comparison: edge displacement (m), and heading (rad).
    pub fn within(self, edge_displacement: f64, heading: f64) -> Self {
        Self { tolerances: Some([edge_displacement, heading]), ..self }
    }
}
