//! The README in the output folder of `paper`: sets of runs, results in tables, and the files.

use std::fmt::Write;

use crate::math::Interval;
use crate::model::paper::SIMULATED_SAMPLES;
use crate::output::quantity::{number, quantity};
use crate::output::table::Table;
use crate::output::text::wrapped_markdown;
use crate::studies::paper::report::Paper;
use crate::studies::paper::{Claim, Conclusion, Estimate, Replayed, printed_share};

/// What the files are.
const FILES: &str = "\
- `table.csv` every quantity on every set of runs, with intervals, grades and paired differences; `not-reproduced.csv`, `claims.csv`, `group-size.csv`, `samples.csv`, `experiment.csv`, `inertial-force.csv`, `transitions.csv`, `conclusions.csv`, `replayed.csv`
- `runs.csv` every run
- `pulls.svg` pulls by trial and the largest one; `group-size.svg` speed by group and shares; `backends.svg` what inertia and the engine move; `inertial-force.svg` the inertial force by smoothing time
- `transition.svg`, `snapshots.svg`, `path.svg` one run of four ants
- `report.html` all this as a page; `table.txt` what the command prints; `summary.json` the same for programs; `manifest.json` where it comes from
";

const GRADES: &str = "
Match: the two numbers are as close as two samples of the same runs, with the printed sample's own size. Near: certainly within 10 %, or within 0.05 of a share. Calibrated: as near, and parameters were chosen by it. Differs: certainly farther apart. Undecided: these seeds do not tell. A wider interval never makes a better grade. The paper's figures are known by form only: none of their values is compared.
";
const NULLS: &str = "
A claim holds where the whole interval is beyond the limit. Each limit is the value of a model that contradicts the claim, or beyond it: a speed proportional to the number of ants, or a run without phases. The paper gives no limits.
";
const FORCES: &str = "
On the inertial backend. Positions are those of 30 video frames per second, averaged over the smoothing time; the first row of each trial is the acceleration at the control period. The paper says that inertial forces are of order 1e-4 mN, beside 22 mN of friction, and prints no smoothing time.
";

/// A table with its title and what to know of it.
pub(super) struct Part {
    pub title: &'static str,
    pub table: Table,
    pub note: String,
}

/// The page in Markdown.
pub fn paper_readme(found: &Paper) -> String {
    let mut text = format!("# The paper's results\n\n{}\n\n{}\n", found.answer, made_by(found));
    for Part { title, table, note } in parts(found) {
        write!(text, "\n## {title}\n\n{}\n{note}\n", table.markdown()).expect("a string takes all");
    }
    write!(text, "\n## Files\n\n{FILES}").expect("a string takes all");
    wrapped_markdown(&text)
}

/// What made the results, and what the intervals are.
pub(super) fn made_by(found: &Paper) -> String {
    format!(
        "Made by `cohaul paper`, preset `{}`, seeds from {}. Intervals are 95 %, Student's t times the standard error by the bootstrap over seeds; ticks and pulls of one run are not independent.",
        found.preset, found.first_seed
    )
}

/// All tables that have lines, what is not reproduced first.
pub(super) fn parts(found: &Paper) -> Vec<Part> {
    let all = [
        missed(found),
        sets(found),
        printed(found),
        part("Claims", &CLAIM_HEADS, found.claims.iter().map(claim).collect(), NULLS),
        samples(found),
        part("Beside what was measured on ants", &["quantity", "measured", "samples", "here"], measured(found), MEASURED),
        part("Inertial force m a by smoothing time", &["trial", "smoothing", "mean", "rms", "largest"], forces(found), FORCES),
        part("Conclusions by backend and inertia", &heads(found), found.conclusions.iter().map(conclusion).collect(), CONCLUSIONS),
        part("Replayed: largest edge displacements", &REPLAYED_HEADS, found.replayed.iter().map(replayed).collect(), ""),
        part("One change of mean in a run", &TRANSITION_HEADS, transitions(found), TRANSITIONS),
    ];
    all.into_iter().filter(|part| !part.table.rows.is_empty()).collect()
}

const CLAIM_HEADS: [&str; 7] = ["claim", "where", "statistic", "limit", "here", "holds", "contradicts"];
const REPLAYED_HEADS: [&str; 6] = ["trial", "verdict", "inertia effect", "engine error", "reference error", "path length"];
const TRANSITION_HEADS: [&str; 6] = ["trial", "series", "runs", "significant", "of those rising", "median time"];
const MEASURED: &str = "
Pulls of all trials at every control period, and group sizes of the trial of ten ants. The paper does not say that its simulation meets these numbers; they have no grade.
";
const CONCLUSIONS: &str = "
Each cell is the value and whether the conclusion holds there (`?`: unknown with these seeds). Inertia is scaled at the same friction.
";
const TRANSITIONS: &str = "
Best place of two means by least squares; significant at 5 % among series of the same 4 s blocks in random order, so that a twentieth is chance.
";

fn part(title: &'static str, heads: &[impl AsRef<str>], lines: Vec<Vec<String>>, note: &str) -> Part {
    let table = Table::new("", heads.iter().map(AsRef::as_ref)).with_rows(lines);
    Part { title, table, note: note.trim().to_owned() }
}

fn missed(found: &Paper) -> Part {
    let missed = found.not_reproduced.iter().map(|missed| {
        let certain = if missed.is_certain { "not reproduced" } else { "these seeds do not tell" };
        vec![missed.what.clone(), missed.paper.clone(), missed.here.clone(), certain.to_owned()]
    });
    part("What is not reproduced", &["what", "paper", "here", ""], missed.collect(), "")
}

fn sets(found: &Paper) -> Part {
    let sets = found.sets.iter().map(|set| vec![set.name.clone(), set.n_seeds.to_string(), format!("{} of {}", set.n_arrived, set.n_runs)]);
    part("Sets of runs", &["set", "seeds", "runs that arrive"], sets.collect(), "")
}

fn printed(found: &Paper) -> Part {
    let rows = found.table.iter().filter(|row| row.printed.is_some());
    let rows = rows.map(|row| {
        let printed = row.printed.map_or_else(String::new, |printed| quantity(printed, row.unit));
        let grade = row.grade.map_or("", |grade| grade.name()).to_owned();
        vec![row.quantity.clone(), printed, with_interval(&row.ours, row.unit), grade, row.why.clone()]
    });
    part("Beside what is printed", &["quantity", "paper", "here", "grade", "why"], rows.collect(), GRADES)
}

fn transitions(found: &Paper) -> Vec<Vec<String>> {
    let row = |row: &crate::studies::paper::report::TransitionRow| {
        let counts = [row.n_runs, row.n_significant, row.n_rising].map(|n| n.to_string());
        let median = row.median_time_s.map_or_else(String::new, |time| quantity(time, "s"));
        [vec![row.trial.name(), row.series.to_owned()], counts.to_vec(), vec![median]].concat()
    };
    found.transitions.iter().map(row).collect()
}

fn with_interval(estimate: &Option<Estimate>, unit: &str) -> String {
    let between = |interval: Option<Interval>| {
        interval.map_or_else(String::new, |Interval { low, high }| format!(" ({} to {})", quantity(low, unit), quantity(high, unit)))
    };
    estimate.map_or_else(|| "-".to_owned(), |estimate| format!("{}{}", quantity(estimate.value, unit), between(estimate.interval_95)))
}

/// What the paper measured on ants.
fn measured(found: &Paper) -> Vec<Vec<String>> {
    let row = |row: &crate::studies::paper::Experiment| {
        vec![row.quantity.clone(), quantity(row.measured, row.unit), row.n_measured.to_string(), with_interval(&row.here, row.unit)]
    };
    found.experiment.iter().map(row).collect()
}

/// Inertial force by smoothing time.
fn forces(found: &Paper) -> Vec<Vec<String>> {
    let row = |row: &crate::studies::paper::ForceRow| {
        let rms = row.rms_n.map_or_else(String::new, |rms| quantity(rms.value, "N"));
        let smoothing = quantity(row.smoothing_s, "s");
        vec![row.trial.name(), smoothing, with_interval(&row.mean_n, "N"), rms, quantity(row.largest_n, "N")]
    };
    found.inertial_force.iter().map(row).collect()
}

/// Printed counts as a mixture of the trials.
fn samples(found: &Paper) -> Part {
    let (title, heads) = (
        "Samples of Fig. 9 as a mixture of the trials",
        ["pulling ants", "printed samples", "mixture", "printed share of two or more", "mixture"],
    );
    let Some(mixture) = &found.mixture else { return part(title, &heads, Vec::new(), "") };
    let n_printed: u64 = SIMULATED_SAMPLES.iter().sum();
    let rows = (1..=10).map(|size| {
        let share = |share: f64| if size > 1 { number(share) } else { String::new() };
        let n = (mixture.shares[size - 1] * n_printed as f64).round();
        vec![
            size.to_string(),
            SIMULATED_SAMPLES[size - 1].to_string(),
            format!("{n}"),
            share(printed_share(size)),
            share(mixture.share_of_two_or_more(size)),
        ]
    });
    let parts = mixture.trials.iter().map(|part| format!("{} {} ({} runs)", part.trial.name(), number(part.weight), number(part.n_runs)));
    let note = format!(
        "Weights of the trials, by the largest likelihood of the printed counts, and runs with as many samples at every control period: {}. Of samples with two or more ants, a share of {} has another number of ants in the mixture than printed.",
        parts.collect::<Vec<_>>().join(", "),
        number(mixture.misplaced())
    );
    part(title, &heads, rows.collect(), &note)
}

fn claim(claim: &Claim) -> Vec<String> {
    let limit = format!("{} {}", if claim.below { "below" } else { "above" }, number(claim.limit));
    let [holds, contradicts] = [holds(claim.holds), claim.contradicts.name()].map(str::to_owned);
    vec![
        claim.claim.to_owned(),
        claim.source.to_owned(),
        claim.statistic.clone(),
        limit,
        with_interval(&claim.found, ""),
        holds,
        contradicts,
    ]
}

fn holds(holds: Option<bool>) -> &'static str {
    match holds {
        Some(true) => "yes",
        Some(false) => "no",
        None => "?",
    }
}

fn heads(found: &Paper) -> Vec<String> {
    let sets = found.conclusions.first().into_iter().flat_map(|conclusion| conclusion.on.iter().map(|standing| standing.set.clone()));
    std::iter::once("conclusion".to_owned()).chain(sets).collect()
}

fn conclusion(conclusion: &Conclusion) -> Vec<String> {
    let cell = |standing: &crate::studies::paper::Standing| {
        let value = standing.value.map_or_else(|| "-".to_owned(), number);
        let is_changed = conclusion.changed_on.contains(&standing.set);
        let answer = format!("{value}, {}", holds(standing.holds));
        if is_changed { format!("**{answer}**") } else { answer }
    };
    std::iter::once(conclusion.conclusion.clone()).chain(conclusion.on.iter().map(cell)).collect()
}

fn replayed(one: &Replayed) -> Vec<String> {
    let lengths = [one.inertia_effect_m, one.engine_error_m, one.reference_error_m].map(|length| quantity(length, "m"));
    let path = format!("{} in {}", quantity(one.path_length_m, "m"), quantity(one.duration_s, "s"));
    [vec![one.trial.name(), one.verdict.clone()], lengths.to_vec(), vec![path]].concat()
}
