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
- `fit.csv` every set of parameters that was tried, and how far it is from the printed numbers; `runs.csv` every run
- `pulls.svg` pulls by trial and the largest one; `group-size.svg` speed by group and shares; `backends.svg` what inertia and the engine move; `inertial-force.svg` the inertial force by smoothing time; `fit.svg` how sharp the fit is
- `transition.svg`, `snapshots.svg`, `path.svg` one run of four ants
- `table.txt` what the command prints; `summary.json` the same for programs; `manifest.json` where it comes from
";

const GRADES: &str = "
Match: the two numbers are as close as two samples of the same runs, with the printed sample's own size. Near: certainly within 10 %, or within 0.05 of a share. Calibrated: as near, and parameters were fitted to it. Differs: certainly farther apart. Undecided: these seeds do not tell. A wider interval never makes a better grade. The paper's figures are known by form only: none of their values is compared.
";
const NULLS: &str = "
A claim holds where the whole interval is beyond the limit. Each limit is the value of a model that contradicts the claim, or beyond it: a speed proportional to the number of ants, or a run without phases. The paper gives no limits.
";
const FORCES: &str = "
On the inertial backend. Positions are those of 30 video frames per second, averaged over the smoothing time; the first row of each trial is the acceleration at the control period. The paper says that inertial forces are of order 1e-4 mN, beside 22 mN of friction, and prints no smoothing time.
";

/// The page in Markdown.
pub fn paper_readme(found: &Paper) -> String {
    let mut text = format!(
        "# The paper's results\n\nMade by `cohaul paper`, preset `{}`, seeds from {}. Intervals are 95 %, Student's t times the standard error by the bootstrap over seeds; ticks and pulls of one run are not \
         independent.\n",
        found.preset, found.first_seed
    );
    let missed = found.not_reproduced.iter().map(|missed| {
        let certain = if missed.is_certain { "not reproduced" } else { "these seeds do not tell" };
        vec![missed.what.clone(), missed.paper.clone(), missed.here.clone(), certain.to_owned()]
    });
    table("What is not reproduced", &["what", "paper", "here", ""], missed.collect(), &mut text);
    let sets = found.sets.iter().map(|set| vec![set.name.clone(), set.n_seeds.to_string(), format!("{} of {}", set.n_arrived, set.n_runs)]);
    table("Sets of runs", &["set", "seeds", "runs that arrive"], sets.collect(), &mut text);
    let rows = found.table.iter().filter(|row| row.printed.is_some());
    let rows = rows.map(|row| {
        let printed = row.printed.map_or_else(String::new, |printed| quantity(printed, row.unit));
        let grade = row.grade.map_or("", |grade| grade.name()).to_owned();
        vec![row.quantity.clone(), printed, with_interval(&row.ours, row.unit), grade, row.why.clone()]
    });
    table("Beside what is printed", &["quantity", "paper", "here", "grade", "why"], rows.collect(), &mut text);
    text.push_str(GRADES);
    table(
        "Claims",
        &["claim", "where", "statistic", "limit", "here", "holds", "contradicts"],
        found.claims.iter().map(claim).collect(),
        &mut text,
    );
    text.push_str(NULLS);
    samples(found, &mut text);
    measured(found, &mut text);
    forces(found, &mut text);
    table("Conclusions by backend and inertia", &heads(found), found.conclusions.iter().map(conclusion).collect(), &mut text);
    text.push_str("\nEach cell is the value and whether the conclusion holds there (`?`: unknown with these seeds). Inertia is scaled at the same friction.\n");
    let replayed = found.replayed.iter().map(replayed).collect();
    table(
        "Replayed: largest edge displacements",
        &["trial", "verdict", "inertia effect", "engine error", "reference error", "path length"],
        replayed,
        &mut text,
    );
    let transitions = found.transitions.iter().map(|row| {
        let counts = [row.n_runs, row.n_significant, row.n_rising].map(|n| n.to_string());
        let median = row.median_time_s.map_or_else(String::new, |time| quantity(time, "s"));
        [vec![row.trial.name(), row.series.to_owned()], counts.to_vec(), vec![median]].concat()
    });
    table(
        "One change of mean in a run",
        &["trial", "series", "runs", "significant", "of those rising", "median time"],
        transitions.collect(),
        &mut text,
    );
    text.push_str("\nBest place of two means by least squares; significant at 5 % among series of the same 4 s blocks in random order, so that a twentieth is chance.\n");
    write!(text, "\n## Files\n\n{FILES}").expect("a string takes all");
    wrapped_markdown(&text)
}

/// A table under its title; nothing without lines.
fn table(title: &str, heads: &[impl AsRef<str>], lines: Vec<Vec<String>>, text: &mut String) {
    if !lines.is_empty() {
        let table = Table::new("", heads.iter().map(AsRef::as_ref)).with_rows(lines);
        write!(text, "\n## {title}\n\n{}", table.markdown()).expect("a string takes all");
    }
}

fn with_interval(estimate: &Option<Estimate>, unit: &str) -> String {
    let between = |interval: Option<Interval>| {
        interval.map_or_else(String::new, |Interval { low, high }| format!(" ({} to {})", quantity(low, unit), quantity(high, unit)))
    };
    estimate.map_or_else(|| "-".to_owned(), |estimate| format!("{}{}", quantity(estimate.value, unit), between(estimate.interval_95)))
}

/// What the paper measured on ants.
fn measured(found: &Paper, text: &mut String) {
    let measured = found.experiment.iter().map(|row| {
        vec![row.quantity.clone(), quantity(row.measured, row.unit), row.n_measured.to_string(), with_interval(&row.here, row.unit)]
    });
    table("Beside what was measured on ants", &["quantity", "measured", "samples", "here"], measured.collect(), text);
    text.push_str("\nPulls of all trials at every control period, and group sizes of the trial of ten ants. The paper does not say that its simulation meets these numbers; they have no grade.\n");
}

/// Inertial force by smoothing time.
fn forces(found: &Paper, text: &mut String) {
    let forces = found.inertial_force.iter().map(|row| {
        let mean = with_interval(&row.mean_n, "N");
        vec![
            row.trial.name(),
            quantity(row.smoothing_s, "s"),
            mean,
            row.rms_n.map_or_else(String::new, |rms| quantity(rms.value, "N")),
            quantity(row.largest_n, "N"),
        ]
    });
    table("Inertial force m a by smoothing time", &["trial", "smoothing", "mean", "rms", "largest"], forces.collect(), text);
    if !found.inertial_force.is_empty() {
        text.push_str(FORCES);
    }
}

/// Printed counts as a mixture of the trials.
fn samples(found: &Paper, text: &mut String) {
    let Some(mixture) = &found.mixture else { return };
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
    let heads = ["pulling ants", "printed samples", "mixture", "printed share of two or more", "mixture"];
    table("Samples of Fig. 9 as a mixture of the trials", &heads, rows.collect(), text);
    let parts = mixture.trials.iter().map(|part| format!("{} {} ({} runs)", part.trial.name(), number(part.weight), number(part.n_runs)));
    write!(
        text,
        "\nWeights of the trials, by the largest likelihood of the printed counts, and runs with as many samples at every control period: {}. Of samples with two or more ants, a share of {} has another number of ants in the mixture than printed.\n",
        parts.collect::<Vec<_>>().join(", "),
        number(mixture.misplaced())
    )
    .expect("a string takes all");
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
