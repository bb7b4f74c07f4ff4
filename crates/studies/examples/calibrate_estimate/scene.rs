//! The measured and the estimated inertia effect of one scene.

use std::sync::Arc;

use cohaul::analysis::TriggerKind;
use cohaul::analysis::compare::{Difference, LEAST_HALVINGS, Numbers, Settings, Solution};
use cohaul::analysis::estimate::{InertiaEstimate, TOLERANCE_SHARE, with_estimate};
use cohaul::backend::{BackendKind, BackendOptions, Status};
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Controller, EventKind, Keep, Replay, Simulation, Trace, backend_of, controller_of};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    Stored,
    Random,
}

/// Largest edge displacements (m), measured and estimated, and properties of the scene.
pub struct Found {
    pub name: String,
    pub class: Class,
    pub seed: u64,
    pub has_ants: bool,
    pub n_releases: usize,
    pub mass: f64,
    pub numbers: Numbers,
    pub measured: f64,
    pub reference_error: f64,
    /// Path length of the measured runs (m).
    pub path_length: f64,
    pub estimate: InertiaEstimate,
    pub status: Status,
}

impl Found {
    pub fn ratio(&self) -> f64 {
        self.estimate.edge_displacement_max_m / self.measured
    }

    pub fn measured_share(&self) -> f64 {
        if self.path_length > 0.0 { self.measured / self.path_length } else { 0.0 }
    }

    /// Whether the load moves and touches nothing, and the reference error is small enough for a
    /// comparison.
    pub fn is_certain(&self) -> bool {
        let is_accurate = 3.0 * self.reference_error <= self.measured && self.status == Status::Converged;
        self.measured > 0.0 && is_accurate && !self.estimate.touches_obstacle
    }

    pub fn kind(&self) -> &'static str {
        match self.estimate.largest.map(|largest| largest.trigger.kind) {
            None => "none",
            Some(TriggerKind::Start) => "start",
            Some(TriggerKind::Grasp | TriggerKind::Release) => "jump",
            Some(_) => "driving",
        }
    }
}

pub fn measure(name: &str, class: Class, scenario: &Scenario) -> Found {
    let settings = Settings::default();
    let options = settings.at_fixed_step(scenario, BackendKind::QuasiStatic);
    let (estimate, recorded, duration) = estimated(scenario, &options);
    let has_ants = matches!(scenario.drive, Drive::Ants(_));
    let replayed = Scenario { duration, ..scenario.clone() };
    let n_releases = recorded.events.iter().filter(|event| event.kind == EventKind::Release).count();
    let recorded = Arc::new(recorded);
    let controller = || match has_ants {
        true => Box::new(Replay::new(Arc::clone(&recorded), scenario.system.springs.len())) as Box<dyn Controller>,
        false => controller_of(scenario),
    };
    let [quasi_static, inertial] = [BackendKind::QuasiStatic, BackendKind::Inertial]
        .map(|kind| solve(&replayed, &settings.under_error_control(scenario, kind), controller));
    let radius = scenario.system.load.radius;
    let own = [&quasi_static, &inertial].map(|solution| Difference::error_of(&solution.limit, radius).edge_displacement_max_m);
    Found {
        name: name.to_owned(),
        class,
        seed: scenario.seed,
        has_ants,
        n_releases,
        mass: scenario.system.load.mass,
        numbers: Numbers::of(&replayed, &inertial.trace),
        measured: Difference::between(&inertial.limit, &quasi_static.limit, radius).edge_displacement_max_m,
        reference_error: own[0].max(own[1]),
        path_length: quasi_static.path_length(radius).max(inertial.reach(radius)),
        estimate,
        status: quasi_static.steps.status.max(inertial.steps.status),
    }
}

/// Estimate of a run, with its trace and its duration (s).
fn estimated(scenario: &Scenario, options: &BackendOptions) -> (InertiaEstimate, Trace, f64) {
    let (backend, estimator) = with_estimate(&scenario.system, scenario.start, options);
    let mut run = Simulation::from_parts(scenario, options, Keep::Trace, controller_of(scenario), backend);
    run.run(|_| true);
    let (trace, outcome) = run.into_results();
    let estimate = estimator.borrow().estimate();
    (estimate, trace, outcome.time)
}

/// Solution of one backend under error control.
fn solve(scenario: &Scenario, options: &BackendOptions, controller: impl Fn() -> Box<dyn Controller> + Sync) -> Solution {
    Solution::find(scenario, options, (1, LEAST_HALVINGS), &backend_of, controller, |_| true).expect("nobody stops it")
}

pub fn table(found: &[Found]) -> Result<Vec<u8>, csv::Error> {
    let mut out = csv::Writer::from_writer(Vec::new());
    let header = "scene,seed,drive,n_releases,mass_kg,epsilon,phi,zeta,measured_m,reference_error_m,measured_path_length_m,estimated_m,estimated_path_length_m,\
                  estimate_over_measured,cause,measured_is_negligible,estimated_is_negligible,is_certain,status";
    out.write_record(header.split(','))?;
    let optional = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.4e}"));
    for scene in found {
        let estimate = &scene.estimate;
        out.write_record([
            scene.name.clone(),
            scene.seed.to_string(),
            if scene.has_ants { "ants" } else { "tips" }.to_owned(),
            scene.n_releases.to_string(),
            format!("{:.4e}", scene.mass),
            optional(scene.numbers.epsilon),
            optional(scene.numbers.phi),
            format!("{:.4}", scene.numbers.zeta.unwrap_or_default()),
            format!("{:.5e}", scene.measured),
            format!("{:.2e}", scene.reference_error),
            format!("{:.5e}", scene.path_length),
            format!("{:.5e}", estimate.edge_displacement_max_m),
            format!("{:.5e}", estimate.path_length_m),
            if scene.measured > 0.0 { format!("{:.4}", scene.ratio()) } else { String::new() },
            scene.kind().to_owned(),
            (scene.measured_share() <= TOLERANCE_SHARE).to_string(),
            estimate.is_negligible.map_or(String::new(), |is_negligible| is_negligible.to_string()),
            scene.is_certain().to_string(),
            format!("{:?}", scene.status),
        ])?;
    }
    out.into_inner().map_err(|error| error.into_error().into())
}
