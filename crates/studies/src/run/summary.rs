//! The JSON object that `run --json` prints and `summary.json` holds.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::run::answer::sentence;
use cohaul::analysis::estimate::InertiaEstimate;
use cohaul::backend::{BackendKind, Integrator, RapierOptions, Setting, Status};
use cohaul::formats::{self, Format, Versioned};
use cohaul::simulation::Account;
use cohaul::simulation::run_facts::{FACTS, Run, Value};

/// A run and what is reported of it.
#[derive(Clone, Copy, Debug)]
pub struct RunSummary<'a> {
    pub run: Run<'a>,
    /// Estimated effect of inertia, for a quasi-static run.
    pub inertia_estimate: Option<InertiaEstimate>,
}

impl Versioned for RunSummary<'_> {
    const FORMAT: Format = formats::RUN;
}

/// What was run and how, beside the numbers.
#[derive(Serialize)]
struct Object<'a> {
    answer: String,
    scenario: &'a str,
    backend: BackendKind,
    /// `null` under error control.
    step_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    integrator: Option<Integrator>,
    #[serde(skip_serializing_if = "Option::is_none")]
    rapier: Option<RapierOptions>,
    seed: u64,
    account: &'a Account,
    #[serde(flatten)]
    numbers: Node,
    #[serde(skip_serializing_if = "Option::is_none")]
    inertia_estimate: Option<InertiaEstimate>,
}

impl Serialize for RunSummary<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Run { scenario, options, outcome, .. } = self.run;
        let mut numbers = Vec::new();
        for fact in &FACTS {
            match fact.value(&self.run) {
                Value::Absent => {}
                value => insert(&mut numbers, fact.name, Node::Value(value)),
            }
        }
        insert(&mut numbers, "steps.status", Node::Status(outcome.steps.status));
        let object = Object {
            answer: sentence(&self.run, self.inertia_estimate.as_ref()),
            scenario: &scenario.name,
            backend: options.kind,
            step_s: options.step_s.is_finite().then_some(options.step_s),
            integrator: options.reads(Setting::Integrator).then_some(options.integrator),
            rapier: options.reads(Setting::Engine).then_some(options.rapier),
            seed: scenario.seed,
            account: &outcome.account,
            numbers: Node::Object(numbers),
            inertia_estimate: self.inertia_estimate,
        };
        object.serialize(serializer)
    }
}

/// A part of the object: keys keep their order.
enum Node {
    Value(Value),
    Status(Status),
    List(Vec<Value>),
    Object(Vec<(&'static str, Node)>),
}

/// Puts `leaf` where `name` says: dots lead into objects, a bracket adds to a list.
fn insert(object: &mut Vec<(&'static str, Node)>, name: &'static str, leaf: Node) {
    let (key, rest) = name.split_once(['.', '[']).unwrap_or((name, ""));
    let at = object.iter().position(|(known, _)| *known == key);
    match (at.map(|at| &mut object[at].1), leaf) {
        (Some(Node::Object(inner)), leaf) => insert(inner, rest, leaf),
        (Some(Node::List(list)), Node::Value(value)) => list.push(value),
        (None, Node::Value(value)) if rest.ends_with(']') && !rest.contains('.') => object.push((key, Node::List(vec![value]))),
        (None, leaf) if !rest.is_empty() => {
            let mut inner = Vec::new();
            insert(&mut inner, rest, leaf);
            object.push((key, Node::Object(inner)));
        }
        (_, leaf) => object.push((key, leaf)),
    }
}

impl Serialize for Node {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Node::Value(value) => value.serialize(serializer),
            Node::Status(status) => status.serialize(serializer),
            Node::List(list) => list.serialize(serializer),
            Node::Object(entries) => {
                let mut map = serializer.serialize_map(Some(entries.len()))?;
                for (key, node) in entries {
                    map.serialize_entry(key, node)?;
                }
                map.end()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::scenario::Scenario;
    use cohaul::simulation::Outcome;
    use cohaul_report::json::NotFinite;
    use cohaul_report::synthetic;

    fn json(kind: BackendKind, outcome: &Outcome) -> Result<serde_json::Value, NotFinite> {
        let scenario = Scenario::parse(include_str!("../../../../scenarios/paper/four-ants-four-springs.json"), "four ants").unwrap();
        let options = synthetic::options(kind);
        let run = Run { scenario: &scenario, options: &options, outcome, path_length: None, wall_time: Some(0.25) };
        cohaul_report::json::pretty(&RunSummary { run, inertia_estimate: None }).map(|text| serde_json::from_str(&text).unwrap())
    }

    #[test]
    fn the_contract_of_run_json_holds_for_ants() {
        let value = json(BackendKind::QuasiStatic, &synthetic::outcome(Some(false))).unwrap();
        for pointer in [
            "/final/time_s",
            "/final/position_m/1",
            "/final/heading_rad",
            "/final/velocity_m_per_s/1",
            "/final/turn_rate_rad_per_s",
            "/energy/defect_parts/quadrature_j",
            "/transitions/n_slip_onset",
            "/transitions/largest_jump_m",
            "/steps/n_steps",
            "/steps/n_solves",
            "/steps/n_skipped",
            "/steps/n_not_converged",
            "/steps/skipped/distant_ants",
            "/wall_s",
            "/seed",
            "/pull_force_n/mean",
            "/pull_force_n/n",
        ] {
            assert!(value.pointer(pointer).is_some_and(serde_json::Value::is_number), "{pointer}: {value}");
        }
        assert_eq!((&value["backend"], &value["steps"]["status"]), (&"quasi-static".into(), &"converged".into()));
        assert_eq!((&value["arrived"], value.get("time_to_nest_s")), (&false.into(), Some(&serde_json::Value::Null)));
        assert_eq!(value.get("rapier"), None);
    }

    #[test]
    fn a_run_has_only_the_numbers_of_its_backend_and_drive() {
        let arrived = json(BackendKind::Rapier, &synthetic::outcome(Some(true))).unwrap();
        assert_eq!(arrived["time_to_nest_s"], arrived["final"]["time_s"]);
        assert!(arrived["rapier"].is_object() && arrived.get("transitions").is_none());
        let tips = json(BackendKind::Inertial, &synthetic::outcome(None)).unwrap();
        for key in ["arrived", "time_to_nest_s", "pull_force_n"] {
            assert_eq!(tips.get(key), None, "{key}");
        }
    }

    /// The sum is exact: the file holds every digit, and the sum is taken in the ledger's order.
    #[test]
    fn the_energy_defect_follows_from_the_printed_numbers() {
        let energy = &json(BackendKind::Rapier, &synthetic::outcome(None)).unwrap()["energy"];
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
    fn a_number_that_is_not_finite_is_refused_by_name() {
        type Poison = fn(&mut Outcome, f64);
        let poisons: [(&str, Poison); 6] = [
            ("final.time_s", |o, v| o.time = v),
            ("final.position_m[1]", |o, v| o.motion.pose.position.y = v),
            ("energy.kinetic_j", |o, v| o.energy.kinetic = v),
            ("transitions.largest_jump_m", |o, v| o.transitions.largest_jump = Some(v)),
            ("steps.residual", |o, v| o.steps.residual = v),
            ("pull_force_n.mean", |o, v| o.pulls.add(v)),
        ];
        for (field, poison) in poisons {
            for value in [f64::NAN, f64::INFINITY] {
                let mut outcome = synthetic::outcome(Some(false));
                poison(&mut outcome, value);
                let error = json(BackendKind::Inertial, &outcome).unwrap_err();
                assert!(error.to_string().starts_with(field), "{error}");
            }
        }
    }

    #[test]
    fn a_failed_run_has_a_status_where_it_has_no_residual() {
        let mut outcome = synthetic::outcome(None);
        (outcome.steps.status, outcome.steps.residual) = (Status::Failed, f64::INFINITY);
        let steps = &json(BackendKind::Rapier, &outcome).unwrap()["steps"];
        assert_eq!((&steps["status"], &steps["residual"]), (&"failed".into(), &serde_json::Value::Null));
    }
}
