//! References that errors are measured against: a closed form where there is one, else the exact
//! backend of the same kind under error control far tighter than any setting that is tried.

use crate::known_answers::known;
use cohaul::backend::{BackendKind, BackendOptions, Status, Tolerance};
use cohaul::math::Pose;
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Row, Simulation};

/// A path at the rows of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    pub poses: Vec<Pose>,
    pub source: String,
    /// Reference error: bound of the edge displacement between this path and the true one (m).
    pub reference_error: f64,
}

/// Tolerance of the runs that tell how long the path is, over the load's radius (1).
const FIRST_TOLERANCE: f64 = 1e-3;
/// Tolerance of a reference, over the length of the path (1): a hundredth of the tightest that is
/// tried.
const TOLERANCE: f64 = 1e-9;
/// The same among obstacles: a tenth of the tightest. Error control cuts its macro-steps at every
/// touch and lift-off, and the positions of these are known to rounding of the places in the scene.
const TOLERANCE_AMONG_OBSTACLES: f64 = 1e-8;

impl Reference {
    /// Reference for backends of this kind; `watch` as in [`Simulation::run`], with the
    /// share done (1). `None` when it said to stop.
    ///
    /// # Errors
    /// When a run has no finite answer.
    pub fn find(scenario: &Scenario, kind: BackendKind, mut watch: impl FnMut(f64) -> bool) -> Option<Result<Self, String>> {
        let load = &scenario.system.load;
        if let Some(known) = known(scenario, kind) {
            let times = row_times(scenario);
            let poses = times.map(|time| known.at(time)).collect();
            // Some roundings of places in the scene.
            return Some(Ok(Self { poses, source: format!("closed form: {}", known.formula), reference_error: 1e-15 }));
        }
        let rough = run(scenario, kind, FIRST_TOLERANCE * load.radius, |share| watch(0.2 * share))?;
        let rough: Vec<Pose> = match rough {
            Ok(rows) => rows.iter().map(|row| row.motion.pose).collect(),
            Err(cause) => return Some(Err(cause)),
        };
        let share = if scenario.system.world.is_empty() { TOLERANCE } else { TOLERANCE_AMONG_OBSTACLES };
        let tolerance = share * path_length(&rough, load.radius);
        let rows = run(scenario, kind, tolerance, |share| watch(0.2 + 0.8 * share))?;
        Some(rows.map(|rows| Self {
            poses: rows.iter().map(|row| row.motion.pose).collect(),
            source: format!("{} within {tolerance:.1e} m", kind.name()),
            reference_error:
                rows.iter().filter_map(|row| row.error).map(|error| error.position + load.radius * error.heading).fold(0.0, f64::max),
        }))
    }

    /// Path length of the load's edge (m): the sum of edge displacements from row to row.
    pub fn path_length(&self, radius: f64) -> f64 {
        path_length(&self.poses, radius)
    }

    /// Edge displacement between `poses` and the reference: largest and final one (m).
    ///
    /// # Panics
    /// When the rows are not those of the reference.
    pub fn errors(&self, poses: impl ExactSizeIterator<Item = Pose>, radius: f64) -> [f64; 2] {
        assert_eq!(poses.len(), self.poses.len(), "rows at the same ticks");
        let errors = poses.zip(&self.poses).map(|(pose, known)| pose.edge_displacement(known, radius));
        // A maximum that does not lose what is no number.
        errors.fold([0.0, 0.0], |[most, _], error| [if error <= most { most } else { error }, error])
    }
}

/// A load that stays where it is has no path: a millionth of its radius stands in.
fn path_length(poses: &[Pose], radius: f64) -> f64 {
    let way = poses.windows(2).map(|pair| pair[1].edge_displacement(&pair[0], radius)).fold(0.0, |sum, way| sum + way);
    way.max(1e-6 * radius)
}

/// Times of the rows of a run with prescribed tips (s): every tick, and the end.
fn row_times(scenario: &Scenario) -> impl Iterator<Item = f64> {
    let (period, end) = (scenario.control_period, scenario.duration);
    let n_ticks = (end / period - 1e-9).ceil() as u64;
    (0..n_ticks).map(move |tick| tick as f64 * period).chain([end])
}

/// Rows of a run under error control.
fn run(scenario: &Scenario, kind: BackendKind, tolerance: f64, mut watch: impl FnMut(f64) -> bool) -> Option<Result<Vec<Row>, String>> {
    let options = BackendOptions::within(kind, Tolerance::at_edge(tolerance, &scenario.system.load));
    let start = |options: &BackendOptions| Simulation::new(scenario, options, Keep::Trace);
    let (trace, outcome) = finished(start, &options, |time| watch(time / scenario.duration))?.into_results();
    let failed = outcome.steps.status == Status::Failed;
    Some(if failed { Err(format!("{}: the reference has no finite answer", kind.name())) } else { Ok(trace.rows) })
}

/// A run that `start` makes, to its end; `None` when `watch` stopped it.
pub fn finished<'a>(
    start: impl Fn(&BackendOptions) -> Simulation<'a>,
    options: &BackendOptions,
    watch: impl FnMut(f64) -> bool,
) -> Option<Simulation<'a>> {
    let mut run = start(options);
    run.run_to_tolerance(start, watch);
    run.is_finished().then_some(run)
}
