//! One cell -> its row. Nothing in it depends on when, where or beside what it ran.

use serde_json::Value;

use super::column::{Column, Field, Kind, line_of};
use super::error::SweepError;
use super::plan::{Place, Plan, content_key, point_hash};
use crate::backend::{BackendOptions, Status};
use crate::scenario::Scenario;
use crate::simulation::{Keep, Outcome, Simulation};
use crate::studies::stress::guard::guarded;

/// Columns before the parameters.
pub const BEFORE: [(&str, Kind); 3] = [("cell", Kind::Whole), ("key", Kind::Word), ("point", Kind::Whole)];
/// Columns between parameters and measures.
const BETWEEN: [(&str, Kind); 5] =
    [("backend", Kind::Word), ("step_s", Kind::Number), ("seed", Kind::Whole), ("status", Kind::Word), ("cause", Kind::Word)];

/// What measures are taken from.
struct Facts<'a> {
    outcome: &'a Outcome,
    scenario: &'a Scenario,
    options: &'a BackendOptions,
    seen: &'a Seen,
}

/// What is seen on the way.
struct Seen {
    /// Sum of the distances between control instants (m).
    path_length: f64,
    /// Time with 0, 1, 2 ... springs held; the last one with more too (s).
    time_held: Vec<f64>,
}

type Take = fn(&Facts) -> Field;

/// Every measure of a run; SI units stand in the names. Columns of shares of time by number of holders follow.
const MEASURED: [(&str, Kind, Take); 41] = [
    ("arrived", Kind::Truth, |run| run.outcome.arrived.map_or(Field::Empty, Field::Truth)),
    ("time_to_nest_s", Kind::Number, |run| number_if(run.outcome.arrived == Some(true), run.outcome.time)),
    ("end_s", Kind::Number, |run| Field::Number(run.outcome.time)),
    ("x_m", Kind::Number, |run| Field::Number(run.outcome.motion.pose.position.x)),
    ("y_m", Kind::Number, |run| Field::Number(run.outcome.motion.pose.position.y)),
    ("heading_rad", Kind::Number, |run| Field::Number(run.outcome.motion.pose.heading)),
    ("vx_m_per_s", Kind::Number, |run| Field::Number(run.outcome.motion.twist.linear.x)),
    ("vy_m_per_s", Kind::Number, |run| Field::Number(run.outcome.motion.twist.linear.y)),
    ("turn_rate_rad_per_s", Kind::Number, |run| Field::Number(run.outcome.motion.twist.angular)),
    ("path_length_m", Kind::Number, |run| Field::Number(run.seen.path_length)),
    ("mean_speed_m_per_s", Kind::Number, |run| {
        let travelled = (run.outcome.motion.pose.position - run.scenario.start.pose.position).norm();
        number_if(run.outcome.time > 0.0, travelled / run.outcome.time)
    }),
    ("pull_mean_n", Kind::Number, |run| number_if(run.outcome.pulls.n() > 0, run.outcome.pulls.mean())),
    ("pull_sd_n", Kind::Number, |run| number_if(run.outcome.pulls.n() > 1, run.outcome.pulls.sd())),
    ("pull_max_n", Kind::Number, |run| number_if(run.outcome.pulls.n() > 0, run.outcome.pulls.max())),
    ("n_pulls", Kind::Whole, |run| whole_if(run.outcome.arrived.is_some(), run.outcome.pulls.n())),
    ("elastic_j", Kind::Number, |run| Field::Number(run.outcome.energy.elastic)),
    ("kinetic_j", Kind::Number, |run| Field::Number(run.outcome.energy.kinetic)),
    ("friction_j", Kind::Number, |run| Field::Number(run.outcome.energy.friction)),
    ("damping_j", Kind::Number, |run| Field::Number(run.outcome.energy.damping)),
    ("released_j", Kind::Number, |run| Field::Number(run.outcome.energy.released)),
    ("tip_work_j", Kind::Number, |run| Field::Number(run.outcome.energy.tip_work)),
    ("initial_j", Kind::Number, |run| Field::Number(run.outcome.energy.initial)),
    ("defect_j", Kind::Number, |run| Field::Number(run.outcome.energy.defect())),
    ("defect_jumps_j", Kind::Number, |run| Field::Number(run.outcome.energy.defect_parts().jumps)),
    ("defect_numerical_damping_j", Kind::Number, |run| Field::Number(run.outcome.energy.defect_parts().numerical_damping)),
    ("n_onset", Kind::Whole, |run| whole_if(run.tells(), run.outcome.transitions.n_onset)),
    ("n_stop", Kind::Whole, |run| whole_if(run.tells(), run.outcome.transitions.n_stop)),
    ("n_capture", Kind::Whole, |run| whole_if(run.tells(), run.outcome.transitions.n_capture)),
    ("n_freed", Kind::Whole, |run| whole_if(run.tells(), run.outcome.transitions.n_freed)),
    ("n_jumps", Kind::Whole, |run| whole_if(run.tells(), run.outcome.transitions.n_jumps)),
    ("largest_jump_m", Kind::Number, |run| run.outcome.transitions.largest_jump.map_or(Field::Empty, Field::Number)),
    ("error_m", Kind::Number, |run| run.outcome.error.map_or(Field::Empty, |error| Field::Number(error.position))),
    ("error_rad", Kind::Number, |run| run.outcome.error.map_or(Field::Empty, |error| Field::Number(error.heading))),
    ("residual", Kind::Number, |run| number_if(run.outcome.steps.residual.is_finite(), run.outcome.steps.residual)),
    ("n_steps", Kind::Whole, |run| Field::Whole(run.outcome.steps.n_steps)),
    ("n_solves", Kind::Whole, |run| Field::Whole(run.outcome.steps.n_solves)),
    ("n_iterations", Kind::Whole, |run| Field::Whole(run.outcome.steps.n_iterations)),
    ("n_skipped", Kind::Whole, |run| Field::Whole(run.outcome.steps.n_skipped)),
    ("n_not_converged", Kind::Whole, |run| Field::Whole(run.outcome.steps.n_not_converged)),
    ("n_rejected", Kind::Whole, |run| Field::Whole(run.outcome.steps.n_rejected)),
    ("n_skipped_ants", Kind::Whole, |run| Field::Whole(run.outcome.steps.skipped.distant_ants)),
];

impl Facts<'_> {
    /// Whether the backend knows where the load's motion was not smooth.
    fn tells(&self) -> bool {
        self.options.kind.is_exact()
    }
}

fn number_if(is_there: bool, value: f64) -> Field {
    if is_there { Field::Number(value) } else { Field::Empty }
}

fn whole_if(is_there: bool, value: u64) -> Field {
    if is_there { Field::Whole(value) } else { Field::Empty }
}

/// All columns, with those of `parameters` in their place.
pub fn columns(parameters: Vec<Column>, most_holders: usize, can_be_more: bool) -> Vec<Column> {
    let fixed = |columns: &[(&str, Kind)]| columns.iter().map(|(name, kind)| Column::new(*name, *kind)).collect::<Vec<_>>();
    let measured = MEASURED.iter().map(|(name, kind, _)| Column::new(*name, *kind)).collect();
    let shares = (0..=most_holders).map(|n| {
        let or_more = if n == most_holders && can_be_more { "_or_more" } else { "" };
        Column::new(format!("time_share_{n}{or_more}_held"), Kind::Number)
    });
    [fixed(&BEFORE), parameters, fixed(&BETWEEN), measured, shares.collect()].concat()
}

/// A point ready to run, on all variants and seeds.
pub struct Prepared<'a> {
    plan: &'a Plan,
    pub point: u64,
    values: Vec<Value>,
    scenario: Scenario,
    /// Options and the shared part of the key, a variant each.
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

    /// The line of a cell of this point; `None` when `go_on` said no.
    pub fn line(&mut self, cell: u64, go_on: &dyn Fn() -> bool) -> Option<String> {
        let place = self.plan.place(cell);
        self.scenario.seed = place.seed;
        let (options, hash) = &self.variants[place.variant];
        let mut fields = self.head(cell, &place, options, &content_key(hash, place.seed));
        let ran = guarded(|| run(&self.scenario, options, self.plan.most_holders, go_on));
        let measured = match ran {
            Ok(None) => return None,
            Ok(Some((outcome, seen))) => measured(&Facts { outcome: &outcome, scenario: &self.scenario, options, seen: &seen }),
            Err(panic) => Err(format!("panicked: {panic}")),
        };
        let n_measured = MEASURED.len() + self.plan.most_holders + 1;
        let (status, cause, rest) = match measured {
            Ok((status, cause, fields)) => (status, cause, fields),
            Err(cause) => ("failed", cause, vec![Field::Empty; n_measured]),
        };
        fields.extend([Field::Word(status.to_owned()), Field::Word(cause)]);
        fields.extend(rest);
        Some(line_of(&fields))
    }

    fn head(&self, cell: u64, place: &Place, options: &BackendOptions, key: &str) -> Vec<Field> {
        let parameters = self.values.iter().zip(self.plan.identity.parameters());
        let mut fields = vec![Field::Whole(cell), Field::Word(key.to_owned()), Field::Whole(place.point)];
        fields.extend(parameters.map(|(value, column)| Field::of_value(value, column.kind)));
        fields.push(Field::Word(options.kind.name().to_owned()));
        fields.push(number_if(options.step_s.is_finite(), options.step_s));
        fields.push(Field::Whole(place.seed));
        fields
    }
}

/// Steps between two questions whether to go on: what threads share is looked at seldom.
const STEPS_UNASKED: u64 = 64;

/// The run to its end, under error control again with finer strides until it keeps to its tolerance or cannot.
fn run(scenario: &Scenario, options: &BackendOptions, most_holders: usize, go_on: &dyn Fn() -> bool) -> Option<(Outcome, Seen)> {
    let mut options = *options;
    loop {
        let mut run = Simulation::new(scenario, &options, Keep::Outcome);
        let mut seen = Seen { path_length: 0.0, time_held: vec![0.0; most_holders + 1] };
        for step in 0u64.. {
            if run.is_finished() {
                break;
            }
            if step.is_multiple_of(STEPS_UNASKED) && !go_on() {
                return None;
            }
            let (time, from) = (run.time(), run.motion().pose.position);
            run.step();
            seen.path_length += (run.motion().pose.position - from).norm();
            seen.time_held[run.n_held().min(most_holders)] += run.time() - time;
        }
        let outcome = run.outcome();
        match tightened(&options, &outcome) {
            Some(tighter) => options = tighter,
            None => return Some((outcome, seen)),
        }
    }
}

fn tightened(options: &BackendOptions, outcome: &Outcome) -> Option<BackendOptions> {
    let tolerance = options.tolerance.filter(|tolerance| outcome.error.is_some_and(|error| !tolerance.allows(&error)))?;
    Some(BackendOptions { tolerance: Some(tolerance.tightened()?), ..*options })
}

/// Status, cause and measures, or what is wrong with a number.
fn measured(facts: &Facts) -> Result<(&'static str, String, Vec<Field>), String> {
    let shares = facts.seen.time_held.iter().map(|time| number_if(facts.outcome.time > 0.0, time / facts.outcome.time));
    let fields: Vec<Field> = MEASURED.iter().map(|(_, _, take)| take(facts)).chain(shares).collect();
    let names = MEASURED.iter().map(|(name, ..)| *name).chain(std::iter::repeat("time_share"));
    for (name, field) in names.zip(&fields) {
        if let Field::Number(value) = field
            && !value.is_finite()
        {
            return Err(format!("{name} is {value}"));
        }
    }
    let is_within = facts.options.tolerance.zip(facts.outcome.error).is_none_or(|(tolerance, error)| tolerance.allows(&error));
    let (status, cause) = match facts.outcome.steps.status {
        Status::Failed => ("failed", "some step had no finite answer".to_owned()),
        Status::NotConverged => {
            let steps = &facts.outcome.steps;
            ("not-converged", format!("{} of {} steps did not converge", steps.n_not_converged, steps.n_steps))
        }
        Status::Converged if !is_within => ("not-within-tolerance", "its estimated error is larger at the finest strides".to_owned()),
        Status::Converged => ("finished", String::new()),
    };
    Ok((status, cause, fields))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::sweep::column::fields_of;
    use crate::studies::sweep::plan::tests::plan;

    #[test]
    fn a_number_without_a_value_fails_a_run_by_name_and_a_stop_ends_it() {
        let plan = plan(&["duration_s=0.1,0.2"], None, 1);
        let prepared = Prepared::new(&plan, 0).unwrap();
        let options = &prepared.variants[0].0;
        let (mut outcome, seen) = run(&prepared.scenario, options, 4, &|| true).unwrap();
        let status =
            |outcome: &Outcome| measured(&Facts { outcome, scenario: &prepared.scenario, options, seen: &seen }).map(|(status, ..)| status);
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
