//! A measured run beside its simulated ones: what inertia, an engine, smoothing and numerics make
//! of it, and how far the measured load ended from the inertial one.

use serde::{Deserialize, Serialize};

use super::recording::MeasuredRun;
use super::scene::{Preparation, Prepared, SceneTemplate};
use super::smoothing::pose_at;
use crate::stress::guard::guarded;
use cohaul::analysis::compare::{Pathwise, Point, Settings, ThreeWay};
use cohaul::backend::BackendKind;
use cohaul::math::{Pose, Vec2};
use cohaul::model::geometry::gap;
use cohaul::scenario::Scenario;
use cohaul::simulation::{Health, Keep, Outcome, Row, Simulation, Trace};

/// Compares the backends on a scene; `None` when the watch, which gets the share done (1), said no.
pub type Compare<'a> = dyn Fn(&Scenario, &Settings, &(dyn Fn(f64) -> bool + Sync)) -> Option<Pathwise> + Sync + 'a;

/// Record of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    pub run: String,
    /// `null` where the run has no result.
    pub found: Option<Found>,
    /// Why there is no result.
    pub left_out: Option<String>,
}

/// What was found of a run. Edge displacements are |dx| + R |dtheta|, with the radius R of the
/// load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Found {
    pub model_error: ModelError,
    /// Measured edge displacement from the first to the last seen pose (m).
    pub displacement_m: f64,
    /// Measured turn between these (rad).
    pub turn_rad: f64,
    /// Inertial minus quasi-static, largest edge displacement (m).
    pub inertia_effect_m: f64,
    /// Engine minus inertial, largest edge displacement (m); `null` without an engine.
    pub engine_error_m: Option<f64>,
    /// Bound of the numerical error and of what smoothing leaves open (m).
    pub reference_error_m: f64,
    /// Part of that from smoothing: edge displacement at the last pose between the path that is
    /// used and those at half and at double the bound (m).
    pub smoothing_m: f64,
    /// Bound of the deviation of the smooth paths from recorded places (m).
    pub bound_m: f64,
    /// Largest such deviation (m).
    pub deviation_m: f64,
    /// Number of waypoints of the smooth paths (1).
    pub n_waypoints: usize,
    /// Longest time without a place of an obstacle or tip, which was bridged (s).
    pub longest_gap_s: f64,
    /// Displacement of an obstacle that overlapped the load at the start (m).
    pub shift_m: f64,
    /// Measured gap between load and obstacle at the last pose, negative for an overlap (m); `null`
    /// where the simulated load touches no recorded obstacle then.
    pub end_gap_m: Option<f64>,
    /// Whether all simulated runs can be trusted.
    pub is_sure: bool,
}

/// Measured minus inertial.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelError {
    /// Edge displacement at the last measured pose (m).
    pub edge_displacement_m: f64,
    /// Largest edge displacement at any measured pose (m).
    pub edge_displacement_max_m: f64,
    /// Distance at the last measured pose (m).
    pub position_m: f64,
    /// Its part along the measured displacement (m).
    pub along_m: f64,
    /// Its part to the left of the measured displacement (m).
    pub across_m: f64,
    /// Heading at the last measured pose (rad).
    pub heading_rad: f64,
    /// Mean size of the force of obstacles on the load (N); `null` without measured forces.
    pub mean_force_n: Option<f64>,
}

/// What is asked of every run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Question {
    #[serde(flatten)]
    pub preparation: Preparation,
    /// Whether an engine is compared too.
    pub has_engine: bool,
    #[serde(skip)]
    pub settings: Settings,
}

/// All backends on a scene with the engine under the name of rapier, or the exact ones alone.
pub fn with_rapier(has_engine: bool) -> Box<Compare<'static>> {
    Box::new(move |scenario, settings, watch| {
        let runs = ThreeWay::new(scenario, settings);
        if has_engine { runs.prescribed(watch) } else { runs.without_engine(watch) }
    })
}

impl RunRecord {
    /// Record of a run of `template`; `None` when the watch ended it.
    pub fn of(
        template: &SceneTemplate,
        run: &MeasuredRun,
        question: &Question,
        compare: &Compare,
        watch: &(dyn Fn() -> bool + Sync),
    ) -> Option<Self> {
        let record = |found, left_out| Some(Self { run: run.name.clone(), found, left_out });
        match guarded(|| found(template, run, question, compare, watch)) {
            Ok(None) => None,
            Ok(Some(Ok(found))) => record(Some(found), None),
            Ok(Some(Err(why))) => record(None, Some(why)),
            Err(panic) => record(None, Some(format!("panicked: {panic}"))),
        }
    }
}

fn found(
    template: &SceneTemplate,
    run: &MeasuredRun,
    question: &Question,
    compare: &Compare,
    watch: &(dyn Fn() -> bool + Sync),
) -> Option<Result<Found, String>> {
    let prepared = match template.of_run(run, &question.preparation, 1.0) {
        Ok(prepared) => prepared,
        Err(why) => return Some(Err(why)),
    };
    let compared = compare(&prepared.scenario, &question.settings, &|_| watch())?;
    if compared.solutions[..2].iter().any(|solution| solution.failed_at.is_some()) {
        return Some(Err("the simulated load has no finite motion".to_owned()));
    }
    let smoothing_m = smoothing(template, run, question, &prepared);
    let radius = template.base.system.load.radius;
    let inertial = &compared.solutions[1];
    let (first, last) = (run.load.samples[0].1, run.load.samples[run.load.samples.len() - 1].1);
    Some(Ok(Found {
        model_error: model_error(run, &prepared, &inertial.points, &inertial.trace, radius),
        displacement_m: last.edge_displacement(&first, radius),
        turn_rad: last.heading - first.heading,
        inertia_effect_m: compared.edge_displacement.inertia_effect_m,
        engine_error_m: question.has_engine.then_some(compared.edge_displacement.engine_error_m),
        reference_error_m: compared.edge_displacement.reference_error_m + smoothing_m,
        smoothing_m,
        bound_m: prepared.bound_m,
        deviation_m: prepared.deviation_m,
        n_waypoints: prepared.n_waypoints,
        longest_gap_s: prepared.longest_gap_s,
        shift_m: prepared.shift_m,
        end_gap_m: end_gap(template, run, &prepared, &inertial.trace),
        is_sure: compared.doubts.is_empty() && compared.solutions.iter().all(|solution| solution.account.health == Health::Ok),
    }))
}

/// Edge displacement at the last pose between the quasi-static load on the path that is used and on
/// those at half and at double the bound (m).
fn smoothing(template: &SceneTemplate, run: &MeasuredRun, question: &Question, prepared: &Prepared) -> f64 {
    let radius = template.base.system.load.radius;
    let end = |prepared: &Prepared| {
        *predicted(run, prepared, BackendKind::QuasiStatic, &question.settings).poses.last().expect("there are poses")
    };
    let usual = end(prepared);
    let other = |factor: f64| match template.of_run(run, &question.preparation, factor) {
        Ok(other) if other.scenario != prepared.scenario => end(&other).edge_displacement(&usual, radius),
        Ok(_) => 0.0,
        // Without a scene at another bound the paths are known to the bound only.
        Err(_) => prepared.bound_m,
    };
    other(0.5).max(other(2.0))
}

/// What a backend says of a run at the measured instants.
pub struct Predicted {
    /// Poses at the instants at which the load was seen.
    pub poses: Vec<Pose>,
    /// Mean size of the force of obstacles on the load over the instants at which it was measured
    /// (N).
    pub mean_force: Option<f64>,
    /// Whether the load moved as the backend says throughout.
    pub is_finished: bool,
}

/// The run of a backend at its usual fixed step. A quasi-static load takes a whole control period
/// in one step: its path does not depend on time, and its steps are implicit.
pub fn simulated(prepared: &Prepared, kind: BackendKind, settings: &Settings) -> (Trace, Outcome) {
    let step_s = (kind == BackendKind::QuasiStatic).then_some(prepared.scenario.control_period);
    let options = Settings { step_s, ..*settings }.at_fixed_step(&prepared.scenario, kind);
    let mut simulation = Simulation::new(&prepared.scenario, &options, Keep::Trace);
    simulation.run(|_| true);
    simulation.into_results()
}

/// What that run says at the measured instants.
pub fn predicted(run: &MeasuredRun, prepared: &Prepared, kind: BackendKind, settings: &Settings) -> Predicted {
    let (trace, outcome) = simulated(prepared, kind, settings);
    let path: Vec<(f64, Pose)> = trace.rows.iter().map(|row| (row.time, row.motion.pose)).collect();
    let poses = run.load.samples.iter().map(|(time, _)| pose_at(&path, time - prepared.begins_at)).collect();
    Predicted {
        poses,
        mean_force: mean_forces(run, prepared, &trace).map(|[_, simulated]| simulated),
        is_finished: outcome.failed_at.is_none(),
    }
}

fn model_error(run: &MeasuredRun, prepared: &Prepared, points: &[Point], trace: &Trace, radius: f64) -> ModelError {
    let path: Vec<(f64, Pose)> = points.iter().map(|point| (point.time, point.pose)).collect();
    let pairs: Vec<(Pose, Pose)> = run.load.samples.iter().map(|(time, pose)| (*pose, pose_at(&path, time - prepared.begins_at))).collect();
    let (measured, simulated) = pairs[pairs.len() - 1];
    let difference = measured.position - simulated.position;
    let displacement = measured.position - pairs[0].0.position;
    let along = if displacement.norm() > 0.0 { displacement.normalize() } else { Vec2::x() };
    ModelError {
        edge_displacement_m: measured.edge_displacement(&simulated, radius),
        edge_displacement_max_m: pairs
            .iter()
            .map(|(measured, simulated)| measured.edge_displacement(simulated, radius))
            .fold(0.0, f64::max),
        position_m: difference.norm(),
        along_m: along.dot(&difference),
        across_m: along.perp(&difference),
        heading_rad: measured.heading - simulated.heading,
        mean_force_n: mean_forces(run, prepared, trace).map(|[measured, simulated]| measured - simulated),
    }
}

/// Mean size of the measured and of the simulated force of obstacles over the instants at which it
/// was measured (N); `None` without any.
pub fn mean_forces(run: &MeasuredRun, prepared: &Prepared, trace: &Trace) -> Option<[f64; 2]> {
    let (mut sums, mut n) = ([0.0; 2], 0.0);
    for (name, forces) in &run.forces {
        let obstacle = prepared.scenario.system.world.obstacles.iter().position(|obstacle| obstacle.name == *name)?;
        for (time, force) in forces {
            let Some(row) = row_at(trace, time - prepared.begins_at) else { continue };
            let simulated: Vec2 = row.contacts.iter().filter(|contact| contact.obstacle == obstacle).map(|contact| contact.force).sum();
            (sums[0], sums[1], n) = (sums[0] + force.norm(), sums[1] + simulated.norm(), n + 1.0);
        }
    }
    (n > 0.0).then(|| sums.map(|sum| sum / n))
}

/// Mean size of the measured forces of all obstacles (N); `None` without any.
pub fn mean_measured_force(run: &MeasuredRun) -> Option<f64> {
    let sizes: Vec<f64> = run.forces.iter().flat_map(|(_, forces)| forces).map(|(_, force)| force.norm()).collect();
    (!sizes.is_empty()).then(|| sizes.iter().sum::<f64>() / sizes.len() as f64).filter(|mean| *mean > 0.0)
}

/// First row at or after a time of a run (s), whose forces are those of the step before it; `None`
/// outside of the run.
fn row_at(trace: &Trace, time: f64) -> Option<&Row> {
    if time < 0.0 { None } else { trace.rows.get(trace.rows.partition_point(|row| row.time < time)) }
}

/// Gap over the load's radius up to which a simulated load touches (1): far above the error of
/// gaps, and far below what any camera sees.
const TOUCHES: f64 = 1e-5;

/// Measured gap between load and recorded obstacle at the last measured pose (m), for the closest
/// of those that the simulated load touches then.
fn end_gap(template: &SceneTemplate, run: &MeasuredRun, prepared: &Prepared, trace: &Trace) -> Option<f64> {
    let (time, load) = run.load.samples.last()?;
    let row = row_at(trace, time - prepared.begins_at)?;
    let (outline, radius) = (&template.base.system.world.outline, template.base.system.load.radius);
    let gaps = prepared.scenario.system.world.obstacles.iter().filter_map(|obstacle| {
        let (_, track) = run.obstacles.iter().find(|(name, _)| *name == obstacle.name)?;
        let simulated = gap(outline, &row.motion.pose, &obstacle.outline, &obstacle.path.pose_at(row.time))?;
        let measured = gap(outline, load, &obstacle.outline, &pose_at(&track.samples, *time));
        measured.filter(|_| simulated < TOUCHES * radius)
    });
    gaps.min_by(|a, b| a.abs().total_cmp(&b.abs()))
}
