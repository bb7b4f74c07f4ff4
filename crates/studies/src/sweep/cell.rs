//! Runs one cell and writes its row. The row depends on the cell alone, wherever and whenever it
//! ran.

use super::column::{ESTIMATE, facts, field_of, line_of};
use super::error::SweepError;
use super::plan::{Place, Plan, content_key, point_hash};
use super::report::{DOUBTFUL, FAILED, NOT_WITHIN_TOLERANCE};
use crate::stress::guard::guarded;
use cohaul::analysis::estimate::{InertiaEstimate, with_estimate};
use cohaul::backend::BackendOptions;
use cohaul::scenario::Scenario;
use cohaul::simulation::run_facts::Run;
use cohaul::simulation::{Cause, Health, Keep, Outcome, Repeats, Simulation, backend_of, controller_of};
use cohaul_report::account_words;
use cohaul_report::table::Field;

/// What is added up while a run goes on.
struct Totals {
    /// Length of the path, straight between control instants (m).
    path_length: f64,
    /// Time with 0, 1, 2 ... attached springs; the last one with more too (s).
    time_attached: Vec<f64>,
    /// Of a quasi-static run.
    estimate: Option<InertiaEstimate>,
}

/// A point of the design, ready to run with all methods and seeds.
pub struct Prepared<'a> {
    plan: &'a Plan,
    pub point: u64,
    values: Vec<serde_json::Value>,
    scenario: Scenario,
    /// Options and the shared part of the key, for each method.
    variants: Vec<(BackendOptions, Vec<u8>)>,
}

impl<'a> Prepared<'a> {
    /// # Errors
    /// When the point breaks a rule of the scenario.
    pub fn new(plan: &'a Plan, point: u64) -> Result<Self, SweepError> {
        let values = plan.values(point);
        let scenario = plan.scenario(&values)?;
        let options = plan.identity.variants.iter().map(|variant| variant.options(&scenario));
        let variants = options.map(|options| (options, point_hash(&scenario, &options))).collect();
        Ok(Self { plan, point, values, scenario, variants })
    }

    /// Line of a cell of this point; `None` when `go_on` ended it.
    pub fn line(&mut self, cell: u64, go_on: &dyn Fn() -> bool) -> Option<String> {
        let place = self.plan.place(cell);
        self.scenario.seed = place.seed;
        let (options, hash) = &self.variants[place.variant];
        let mut fields = self.head(cell, &place, options, &content_key(hash, place.seed));
        let ran = guarded(|| run(&self.scenario, options, self.plan.most_attached, go_on));
        let measured = match ran {
            Ok(None) => return None,
            Ok(Some((outcome, totals))) => {
                let path_length = Some(totals.path_length);
                let run = Run { scenario: &self.scenario, options, outcome: &outcome, path_length, wall_time: None };
                measured(&run, &totals)
            }
            Err(panic) => Err(format!("panicked: {panic}")),
        };
        let (status, cause, rest) = measured.unwrap_or_else(|cause| ("failed", cause, Vec::new()));
        fields.extend([Field::Word(status.to_owned()), Field::Word(cause)]);
        fields.extend(rest);
        fields.resize(self.plan.identity.columns.len(), Field::Empty);
        Some(line_of(&fields))
    }

    fn head(&self, cell: u64, place: &Place, options: &BackendOptions, key: &str) -> Vec<Field> {
        let parameters = self.values.iter().zip(self.plan.identity.parameters());
        let mut fields = vec![Field::Whole(cell), Field::Word(key.to_owned()), Field::Whole(place.point)];
        fields.extend(parameters.map(|(value, column)| Field::of_value(value, column.kind)));
        let step_s = options.step_s.is_finite().then_some(options.step_s);
        fields.extend([options.kind.name().into(), step_s.into(), place.seed.into()]);
        fields
    }
}

/// Number of steps between two calls of `go_on`, which reads what threads share.
const STEPS_UNASKED: u64 = 64;

/// Runs to the end. Under error control, the run starts again with a smaller error for each
/// macro-step until it is within its tolerance or cannot be.
fn run(scenario: &Scenario, options: &BackendOptions, most_attached: usize, go_on: &dyn Fn() -> bool) -> Option<(Outcome, Totals)> {
    let (mut options, mut repeats) = (*options, Repeats::default());
    loop {
        let (backend, estimator) = match options.kind.has_inertia_estimate() {
            true => {
                let (backend, estimator) = with_estimate(&scenario.system, scenario.start, &options);
                (backend, Some(estimator))
            }
            false => (backend_of(scenario, &options), None),
        };
        let mut run = Simulation::from_parts(scenario, &options, Keep::Outcome, controller_of(scenario), backend);
        let mut totals = Totals { path_length: 0.0, time_attached: vec![0.0; most_attached + 1], estimate: None };
        for step in 0u64.. {
            if run.is_finished() {
                break;
            }
            if step.is_multiple_of(STEPS_UNASKED) && !go_on() {
                return None;
            }
            let (time, from) = (run.time(), run.motion().pose.position);
            run.step();
            totals.path_length += (run.motion().pose.position - from).norm();
            totals.time_attached[run.n_attached().min(most_attached)] += run.time() - time;
        }
        let outcome = run.outcome();
        totals.estimate = estimator.map(|estimator| estimator.borrow().estimate());
        match repeats.next((scenario, &options), outcome.time, outcome.error, (&outcome.steps, &outcome.doubtful)) {
            Some(tighter) => options = tighter,
            None => return Some((outcome, totals)),
        }
    }
}

/// Status, cause and numbers, or the number that is not finite.
fn measured(run: &Run, totals: &Totals) -> Result<(&'static str, String, Vec<Field>), String> {
    let end = run.outcome.time;
    let of = totals.estimate;
    let estimate: [Field; ESTIMATE.len()] =
        [of.map(|of| of.edge_displacement_max_m).into(), of.map(|of| of.share).into(), of.map(|of| !of.is_invalid).into()];
    let estimate = ESTIMATE.map(|(name, _)| name).into_iter().zip(estimate);
    let shares = totals.time_attached.iter().map(|time| ("time_share", (end > 0.0).then_some(time / end).into()));
    let named: Vec<(&str, Field)> = facts().map(|fact| (fact.column, field_of(fact.in_table(run)))).chain(estimate).chain(shares).collect();
    if let Some((name, value)) = named.iter().find_map(|(name, field)| Some((name, field.number().filter(|value| !value.is_finite())?))) {
        return Err(format!("{name} is {value}"));
    }
    let account = &run.outcome.account;
    let status = match account.worst() {
        Some(finding) if finding.cause == Cause::ToleranceMissed => NOT_WITHIN_TOLERANCE,
        Some(finding) if finding.health == Health::Failed => FAILED,
        Some(_) => DOUBTFUL,
        None => "finished",
    };
    let cause = account_words::cause(account).unwrap_or_default().to_owned();
    Ok((status, cause, named.into_iter().map(|(_, field)| field).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::column::fields_of;
    use crate::sweep::plan::tests::plan;

    #[test]
    fn a_number_without_a_value_fails_a_run_by_name_and_a_stop_ends_it() {
        let plan = plan(&["duration_s=0.1,0.2"], None, 1);
        let prepared = Prepared::new(&plan, 0).unwrap();
        let options = &prepared.variants[0].0;
        let (mut outcome, totals) = run(&prepared.scenario, options, 4, &|| true).unwrap();
        let status = |outcome: &Outcome| {
            let run = Run { scenario: &prepared.scenario, options, outcome, path_length: None, wall_time: None };
            measured(&run, &totals).map(|(status, ..)| status)
        };
        assert_eq!(status(&outcome), Ok("finished"));
        outcome.motion.pose.heading = f64::NAN;
        assert_eq!(status(&outcome), Err("heading_rad is NaN".to_owned()));
        assert!(run(&prepared.scenario, options, 4, &|| false).is_none());
    }

    #[test]
    fn a_panic_is_a_row_that_says_where() {
        let plan = plan(&["duration_s=0.1,0.2"], None, 1);
        let line = Prepared::new(&plan, 1).unwrap().line(2, &|| panic!("broken, on purpose")).unwrap();
        let fields = fields_of(&line, &plan.identity.columns).unwrap();
        let of = |name: &str| fields[plan.identity.column(name).unwrap()].clone();
        assert_eq!((of("status"), of("duration_s"), of("x_m")), (Field::Word("failed".into()), Field::Number(0.2), Field::Empty));
        let Field::Word(cause) = of("cause") else { panic!("no cause") };
        assert!(cause.starts_with("panicked: broken, on purpose at ") && cause.contains("cell.rs"), "{cause}");
    }
}
