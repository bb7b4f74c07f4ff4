//! What a run amounts to, as the JSON object that `run --json` prints and `summary.json` holds.

use serde::Serialize;

use crate::analysis::estimate::InertiaEstimate;
use crate::backend::{
    BackendKind, BackendOptions, DefectParts, EnergyLedger, Integrator, Motion, PoseError, RapierOptions, Setting, SkipCounts, Status,
    StepReport, Tolerance, TransitionCounts,
};
use crate::math::Summary;
use crate::output::json::{self, NotFinite};
use crate::simulation::Outcome;

/// One run in SI units; names of fields are those of the JSON object.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunSummary {
    pub scenario: String,
    pub backend: BackendKind,
    /// `null` under error control.
    pub step_s: Option<f64>,
    /// Only of a run by the inertial backend at a fixed step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub integrator: Option<Integrator>,
    /// Only of a run under error control.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<Accuracy>,
    /// Only of a run by rapier: the others do not read it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rapier: Option<RapierOptions>,
    pub seed: u64,
    #[serde(rename = "final")]
    pub end: FinalState,
    pub energy: EnergySummary,
    /// Not of a run by rapier: an engine cannot tell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transitions: Option<TransitionSummary>,
    pub steps: StepSummary,
    pub wall_s: f64,
    /// Only of a run with ants.
    #[serde(flatten)]
    pub ants: Option<AntSummary>,
    /// Only of a run that was watched for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inertia_estimate: Option<InertiaEstimate>,
}

/// Errors of the pose at any instant: the largest that were asked for and found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Accuracy {
    pub asked_m: f64,
    pub asked_rad: f64,
    /// How far a less exact run beside this one strayed from it: above the error of this one.
    pub estimated_m: f64,
    pub estimated_rad: f64,
    /// No more than asked for, by strides that all converged: others may be wrong by more than the two runs differ.
    pub is_met: bool,
}

/// Where and when the load ended, in world axes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FinalState {
    pub time_s: f64,
    pub position_m: [f64; 2],
    /// Counts whole turns.
    pub heading_rad: f64,
    pub velocity_m_per_s: [f64; 2],
    pub turn_rate_rad_per_s: f64,
}

/// The ledger at the end: `defect_j = elastic_j + kinetic_j + dissipated_j - tip_work_j - initial_j`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EnergySummary {
    pub elastic_j: f64,
    pub kinetic_j: f64,
    /// The sum of the next three.
    pub dissipated_j: f64,
    pub friction_j: f64,
    pub damping_j: f64,
    pub released_j: f64,
    pub tip_work_j: f64,
    pub initial_j: f64,
    /// Energy from nowhere; negative is numerical damping, or a jump of a method without inertia.
    pub defect_j: f64,
    pub defect_parts: DefectSummary,
}

/// Where the defect comes from: parts that add up to it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DefectSummary {
    /// Lost in jumps of a load without inertia: not positive but for rounding.
    pub jumps_j: f64,
    /// What the load lost to the way in which steps are cut, by its own balance of springs, friction and motion.
    pub numerical_damping_j: f64,
    /// The rest: error of the trapezoid sums of work.
    pub quadrature_j: f64,
}

/// How often the load's motion was not smooth, as the backend saw it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TransitionSummary {
    pub n_onset: u64,
    pub n_stop: u64,
    pub n_capture: u64,
    pub n_freed: u64,
    pub n_jumps: u64,
    /// Largest shift in a jump; only of a run with one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_jump_m: Option<f64>,
}

/// What the run cost and how well its steps ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepSummary {
    /// The worst of all steps.
    pub status: Status,
    /// Largest relative residual; `null` only beside the status `failed`, when a step had no finite residual.
    pub residual: Option<f64>,
    pub n_steps: u64,
    pub n_solves: u64,
    pub n_iterations: u64,
    pub n_skipped: u64,
    pub n_not_converged: u64,
    /// Strides that error control found too long.
    pub n_rejected: u64,
    /// `n_skipped` over `n_steps`; zero without steps.
    pub share_skipped: f64,
    /// What was left out, by kind: steps, and ants at ticks too far from the load to sense a tip.
    pub skipped: SkipCounts,
}

/// What the ants achieved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AntSummary {
    pub arrived: bool,
    /// `null` when the load did not arrive.
    pub time_to_nest_s: Option<f64>,
    pub pull_force_n: PullForce,
}

/// Size of the pulls at the ants' release decisions. An empty sample has zeros beside `n` = 0.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PullForce {
    pub mean: f64,
    pub sd: f64,
    pub max: f64,
    pub n: u64,
}

impl RunSummary {
    /// The summary of a run that took `wall_s` (s) of real time.
    ///
    /// # Errors
    /// When a number of the outcome is not finite. Backends promise that none is, whatever their status.
    pub fn new(scenario: &str, options: &BackendOptions, seed: u64, outcome: &Outcome, wall_s: f64) -> Result<Self, NotFinite> {
        let summary = Self {
            scenario: scenario.to_owned(),
            backend: options.kind,
            step_s: options.step_s.is_finite().then_some(options.step_s),
            integrator: options.reads(Setting::Integrator).then_some(options.integrator),
            accuracy: options.tolerance.zip(outcome.error).map(|(asked, found)| Accuracy::new(&asked, &found, outcome.steps.status)),
            rapier: options.reads(Setting::Engine).then_some(options.rapier),
            seed,
            end: FinalState::new(outcome.time, &outcome.motion),
            energy: EnergySummary::new(&outcome.energy),
            transitions: options.kind.is_exact().then(|| TransitionSummary::new(&outcome.transitions)),
            steps: StepSummary::new(&outcome.steps),
            wall_s,
            ants: outcome.arrived.map(|arrived| AntSummary::new(arrived, outcome)),
            inertia_estimate: None,
        };
        json::check(&summary)?;
        Ok(summary)
    }

    /// The same with what inertia would have done.
    ///
    /// # Errors
    /// When a number of the estimate is not finite.
    pub fn with_estimate(self, estimate: InertiaEstimate) -> Result<Self, NotFinite> {
        let summary = Self { inertia_estimate: Some(estimate), ..self };
        json::check(&summary)?;
        Ok(summary)
    }
}

impl Accuracy {
    fn new(asked: &Tolerance, found: &PoseError, status: Status) -> Self {
        Self {
            asked_m: asked.position_m,
            asked_rad: asked.heading_rad,
            estimated_m: found.position,
            estimated_rad: found.heading,
            is_met: asked.allows(found) && status == Status::Converged,
        }
    }
}

impl FinalState {
    fn new(time: f64, motion: &Motion) -> Self {
        let (pose, twist) = (&motion.pose, &motion.twist);
        Self {
            time_s: time,
            position_m: [pose.position.x, pose.position.y],
            heading_rad: pose.heading,
            velocity_m_per_s: [twist.linear.x, twist.linear.y],
            turn_rate_rad_per_s: twist.angular,
        }
    }
}

impl EnergySummary {
    fn new(ledger: &EnergyLedger) -> Self {
        Self {
            elastic_j: ledger.elastic,
            kinetic_j: ledger.kinetic,
            friction_j: ledger.friction,
            damping_j: ledger.damping,
            released_j: ledger.released,
            dissipated_j: ledger.dissipated(),
            tip_work_j: ledger.tip_work,
            initial_j: ledger.initial,
            defect_j: ledger.defect(),
            defect_parts: DefectSummary::new(&ledger.defect_parts()),
        }
    }
}

impl DefectSummary {
    fn new(parts: &DefectParts) -> Self {
        Self { jumps_j: parts.jumps, numerical_damping_j: parts.numerical_damping, quadrature_j: parts.quadrature }
    }
}

impl TransitionSummary {
    fn new(counts: &TransitionCounts) -> Self {
        let TransitionCounts { n_onset, n_stop, n_capture, n_freed, n_jumps, largest_jump } = *counts;
        Self { n_onset, n_stop, n_capture, n_freed, n_jumps, largest_jump_m: largest_jump }
    }
}

impl StepSummary {
    fn new(report: &StepReport) -> Self {
        let residual = match report.status {
            Status::Failed if !report.residual.is_finite() => None,
            _ => Some(report.residual),
        };
        Self {
            status: report.status,
            residual,
            n_steps: report.n_steps,
            n_solves: report.n_solves,
            n_iterations: report.n_iterations,
            n_skipped: report.n_skipped,
            n_not_converged: report.n_not_converged,
            n_rejected: report.n_rejected,
            share_skipped: report.n_skipped as f64 / report.n_steps.max(1) as f64,
            skipped: report.skipped,
        }
    }
}

impl AntSummary {
    fn new(arrived: bool, outcome: &Outcome) -> Self {
        Self { arrived, time_to_nest_s: arrived.then_some(outcome.time), pull_force_n: PullForce::new(&outcome.pulls) }
    }
}

impl PullForce {
    fn new(pulls: &Summary) -> Self {
        Self { mean: pulls.mean(), sd: pulls.sd(), max: pulls.max(), n: pulls.n() }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;
    use crate::output::synthetic;

    fn summary(kind: BackendKind, outcome: &Outcome) -> Result<RunSummary, NotFinite> {
        RunSummary::new("four ants", &synthetic::options(kind), 7, outcome, 0.25)
    }

    fn json(kind: BackendKind, outcome: &Outcome) -> Value {
        serde_json::from_str(&json::pretty(&summary(kind, outcome).unwrap()).unwrap()).unwrap()
    }

    #[test]
    fn the_contract_of_run_json_holds_for_ants() {
        let value = json(BackendKind::QuasiStatic, &synthetic::outcome(Some(false)));
        for pointer in [
            "/final/time_s",
            "/final/position_m/1",
            "/final/heading_rad",
            "/final/velocity_m_per_s/1",
            "/final/turn_rate_rad_per_s",
            "/energy/defect_parts/quadrature_j",
            "/transitions/n_onset",
            "/transitions/n_jumps",
            "/transitions/largest_jump_m",
            "/steps/n_steps",
            "/steps/n_solves",
            "/steps/n_skipped",
            "/steps/n_not_converged",
            "/steps/share_skipped",
            "/steps/skipped/free_load",
            "/steps/skipped/still_tips",
            "/steps/skipped/stick_bound",
            "/steps/skipped/distant_ants",
            "/wall_s",
            "/seed",
            "/pull_force_n/mean",
            "/pull_force_n/sd",
            "/pull_force_n/max",
            "/pull_force_n/n",
        ] {
            assert!(value.pointer(pointer).is_some_and(Value::is_number), "{pointer}");
        }
        assert_eq!(value["scenario"], "four ants");
        assert_eq!(value["backend"], "quasi-static");
        assert_eq!(value["arrived"], false);
        assert_eq!(value.get("time_to_nest_s"), Some(&Value::Null));
        assert_eq!(value.get("rapier"), None);
    }

    #[test]
    fn time_to_nest_is_the_end_of_a_run_that_arrived() {
        let value = json(BackendKind::Rapier, &synthetic::outcome(Some(true)));
        assert_eq!(value["time_to_nest_s"], value["final"]["time_s"]);
        assert!(value["rapier"].is_object());
        assert_eq!(value.get("transitions"), None, "an engine cannot tell");
    }

    #[test]
    fn prescribed_tips_have_no_ant_fields() {
        let value = json(BackendKind::Inertial, &synthetic::outcome(None));
        for key in ["arrived", "time_to_nest_s", "pull_force_n", "ants"] {
            assert_eq!(value.get(key), None, "{key}");
        }
    }

    /// Exactly, not nearly: the file holds every digit and the sum is taken in the ledger's order.
    #[test]
    fn the_energy_defect_follows_from_the_printed_numbers() {
        let energy = &json(BackendKind::Rapier, &synthetic::outcome(None))["energy"];
        let of = |key: &str| energy[key].as_f64().unwrap();
        assert_eq!(of("dissipated_j"), of("friction_j") + of("damping_j") + of("released_j"));
        let defect = of("elastic_j") + of("kinetic_j") + of("dissipated_j") - of("tip_work_j") - of("initial_j");
        assert_eq!(of("defect_j"), defect);
        assert_ne!(defect, 0.0);
        let part = |key: &str| energy["defect_parts"][key].as_f64().unwrap();
        assert_eq!((part("jumps_j"), part("numerical_damping_j")), (-2e-7, -3e-8));
        // Rounding of the energies that the defect is a sum of.
        assert!((part("jumps_j") + part("numerical_damping_j") + part("quadrature_j") - defect).abs() < 1e-17);
    }

    #[test]
    fn no_number_leaves_that_is_not_finite() {
        type Poison = fn(&mut Outcome, f64);
        let poisons: [(&str, Poison); 15] = [
            ("final.time_s", |o, v| o.time = v),
            ("final.position_m[0]", |o, v| o.motion.pose.position.x = v),
            ("final.position_m[1]", |o, v| o.motion.pose.position.y = v),
            ("final.heading_rad", |o, v| o.motion.pose.heading = v),
            ("final.velocity_m_per_s[0]", |o, v| o.motion.twist.linear.x = v),
            ("final.velocity_m_per_s[1]", |o, v| o.motion.twist.linear.y = v),
            ("final.turn_rate_rad_per_s", |o, v| o.motion.twist.angular = v),
            ("energy.kinetic_j", |o, v| o.energy.kinetic = v),
            ("energy.dissipated_j", |o, v| o.energy.released = v),
            ("energy.initial_j", |o, v| o.energy.initial = v),
            ("energy.defect_parts.jumps_j", |o, v| o.energy.jumps = -v),
            ("energy.defect_parts.numerical_damping_j", |o, v| o.energy.numerical_damping = v),
            ("transitions.largest_jump_m", |o, v| o.transitions.largest_jump = Some(v)),
            ("steps.residual", |o, v| o.steps.residual = v),
            ("pull_force_n.mean", |o, v| o.pulls.add(v)),
        ];
        for (field, poison) in poisons {
            for value in [f64::NAN, f64::INFINITY] {
                let mut outcome = synthetic::outcome(Some(true));
                poison(&mut outcome, value);
                assert_eq!(summary(BackendKind::Inertial, &outcome).unwrap_err().path, field);
            }
        }
        // Sums of finite numbers can overflow too.
        let mut outcome = synthetic::outcome(None);
        (outcome.energy.elastic, outcome.energy.kinetic) = (f64::MAX, f64::MAX);
        assert_eq!(summary(BackendKind::Inertial, &outcome).unwrap_err().path, "energy.defect_j");
    }

    #[test]
    fn a_failed_run_has_a_status_where_it_has_no_residual() {
        let mut outcome = synthetic::outcome(None);
        (outcome.steps.status, outcome.steps.residual) = (Status::Failed, f64::INFINITY);
        let steps = &json(BackendKind::Rapier, &outcome)["steps"];
        assert_eq!((&steps["status"], &steps["residual"]), (&Value::from("failed"), &Value::Null));
    }
}
