//! The paper's results made again, for people.

use super::{Claim, Conclusion, Grade, with_interval};
use crate::paper::report::Paper;
use cohaul::model::paper::SIMULATED_SAMPLES;
use cohaul_report::quantity::{number, quantity};
use cohaul_report::table::wrapped;
use cohaul_report::text::{Detail, WIDTH, listed};

/// The answer, what is not reproduced, and conclusions that change; in full, also quantities beside
/// printed ones, claims, speed by group size, transitions, backends and replayed runs.
pub fn paper_text(found: &Paper, detail: Detail) -> String {
    let head = format!("{}\n\n{}, seeds from {}\n", wrapped(&found.answer, 0, WIDTH), found.reading(), found.first_seed);
    let sets = section("sets of runs", &found.sets, |set| {
        vec![set.name.clone(), format!("{} seeds", set.n_seeds), format!("{} of {} runs arrived", set.n_arrived, set.n_runs)]
    });
    let missed = section("not reproduced", &found.not_reproduced, |missed| {
        let certain = if missed.is_certain { "" } else { "these seeds do not tell" };
        vec![missed.what.clone(), format!("paper {}", missed.paper), format!("here {}", missed.here), certain.to_owned()]
    });
    if detail == Detail::Brief {
        let more = "--verbose prints all numbers beside the paper's, claims and differences\n";
        return [head, sets, missed, changed(found), more.to_owned()].concat();
    }
    let table = section("beside the paper", &found.table, |row| {
        let printed = row.printed.map_or_else(|| "not printed".to_owned(), |printed| format!("paper {}", quantity(printed, row.unit)));
        let here = format!("here {}", with_interval(&row.ours, row.unit));
        vec![row.quantity.clone(), printed, here, row.grade.map_or("", Grade::name).to_owned()]
    });
    let claims = section("claims", &found.claims, claim);
    let sets_and_claims = [head, sets, missed, table, claims].concat();
    sets_and_claims + &of_ants(found) + &of_sets(found)
}

/// Groups, pulls and forces, on the first set.
fn of_ants(found: &Paper) -> String {
    let sizes: Vec<_> = found.mixture.iter().flat_map(|mixture| (1..=10).map(|size| (size, mixture.n_samples(size)))).collect();
    let samples = section("samples by number of pulling ants, mixture of the trials", &sizes, |(size, n)| {
        vec![size.to_string(), format!("paper n = {}", SIMULATED_SAMPLES[size - 1]), format!("mixture n = {n}")]
    });
    let experiment = section("measured on ants, not graded", &found.experiment, |row| {
        vec![row.quantity.clone(), format!("measured {}", quantity(row.measured, row.unit)), with_interval(&row.here, row.unit)]
    });
    let title = "inertial force by smoothing time (paper: 1e-4 mN, friction 22 mN)";
    let forces = section(title, &found.inertial_force, |row| {
        let largest = format!("largest {}", quantity(row.largest_n, "N"));
        vec![row.trial.name(), quantity(row.smoothing_s, "s"), format!("mean {}", with_interval(&row.mean_n, "N")), largest]
    });
    let speeds = section("load speed by number of pulling ants, ten springs", &found.load_speed, |speeds| {
        let headway = format!("as ants, towards the nest {}", with_interval(&speeds.headway_m_per_s, "m/s"));
        let (n, printed) = (format!("n = {}", speeds.n_instants), format!("paper n = {}", speeds.printed_instants));
        vec![speeds.n_transporting.to_string(), speeds.trial.name(), with_interval(&speeds.load_speed_m_per_s, "m/s"), headway, n, printed]
    });
    let transitions = section("one change of mean in a run", &found.transitions, |row| {
        let counts = format!("in {} of {} runs, {} rising", row.n_significant, row.n_runs, row.n_rising);
        let at = row.median_time_s.map_or_else(String::new, |time| format!("median at {}", quantity(time, "s")));
        let ratio = row.median_ratio.map_or_else(String::new, |ratio| format!("after over before {}", number(ratio)));
        vec![row.trial.name(), row.series.to_owned(), counts, at, ratio]
    });
    [samples, experiment, forces, speeds, transitions].concat()
}

/// What differs between sets of the same preset, and between backends on the same path.
fn of_sets(found: &Paper) -> String {
    let same_preset = found.sets.iter().skip(1).zip(0..).filter(|(set, _)| set.preset == found.preset);
    let on_others = same_preset.flat_map(|(_, at)| found.table.iter().filter_map(move |row| Some((row, row.on_others.get(at)?))));
    let shifted: Vec<_> = on_others.filter(|(_, other)| other.is_shifted).collect();
    let others = section("other sets, paired differences", &shifted, |(row, other)| {
        let difference = format!("difference {}", with_interval(&other.minus_first, row.unit));
        vec![other.set.clone(), row.quantity.clone(), with_interval(&other.value, row.unit), difference]
    });
    let replayed = section("replayed: largest edge displacements", &found.replayed, |one| {
        let [inertia, engine, reference, path] =
            [one.inertia_effect_m, one.engine_error_m, one.reference_error_m, one.path_length_m].map(|length| quantity(length, "m"));
        let lengths = [format!("inertia effect {inertia}"), format!("engine error {engine}"), format!("reference error {reference}")];
        let path = format!("path length {path} in {}", quantity(one.duration_s, "s"));
        [vec![one.trial.name(), one.verdict.clone()], lengths.to_vec(), vec![path]].concat()
    });
    [others, changed(found), replayed].concat()
}

/// Conclusions that differ between the first set and others; "none" where several sets agree.
fn changed(found: &Paper) -> String {
    let mut changed: Vec<_> = found.conclusions.iter().filter(|conclusion| !conclusion.changed_on.is_empty()).map(conclusion).collect();
    if changed.is_empty() && found.conclusions.first().is_some_and(|conclusion| conclusion.on.len() > 1) {
        changed = vec![vec!["none".to_owned()]];
    }
    section("conclusions that change", &changed, Vec::clone)
}

/// A title and the cells of each row; nothing of no rows.
fn section<T>(title: &str, rows: &[T], cells: impl Fn(&T) -> Vec<String>) -> String {
    if rows.is_empty() {
        return String::new();
    }
    format!("{title}\n{}", listed(&rows.iter().map(cells).collect::<Vec<_>>()))
}

fn claim(claim: &Claim) -> Vec<String> {
    let verdict = match claim.holds {
        Some(true) => "holds",
        Some(false) => "does not hold",
        None => "unknown",
    };
    let limit = format!("{} {}: {}", claim.side(), number(claim.limit), claim.statistic);
    vec![claim.claim.to_owned(), verdict.to_owned(), with_interval(&claim.found, ""), limit]
}

fn conclusion(conclusion: &Conclusion) -> Vec<String> {
    let value = |set: &String| {
        let standing = conclusion.on.iter().find(|standing| standing.set == *set);
        format!("{set}: {}", standing.and_then(|standing| standing.value).map_or_else(|| "none".to_owned(), number))
    };
    let first = conclusion.on.first().map_or_else(String::new, |standing| value(&standing.set));
    let others: Vec<String> = conclusion.changed_on.iter().map(value).collect();
    vec![conclusion.conclusion.clone(), first, others.join(", ")]
}
