//! README and page in the output folder of `paper`: results in tables with notes, and figures.

use crate::paper::figure::Figures;
use crate::paper::report::Paper;
use crate::paper::{Conclusion, Grade, Standing, printed_share, with_interval};
use cohaul::model::paper::SIMULATED_SAMPLES;
use cohaul_report::manifest::Manifest;
use cohaul_report::page::{Answer, Block, Headline, Page};
use cohaul_report::quantity::{number, quantity};
use cohaul_report::table::Table;
use cohaul_report::text::wrapped_markdown;

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
A claim holds where the whole interval is beyond the limit. Each limit is the value of a model that contradicts the claim, or beyond it. In these models speed is proportional to the number of ants, a run has no phases, or one run in twenty lasts as long as the printed one. The paper gives no limits. Phases are looked for from the first instant at which all ants of the trial pull until the load is within 60 mm of the nest. Before that the interaction forces can only rise, and near the nest the direction to it turns fast.
";
const FORCES: &str = "
On the inertial backend. Positions are those of 30 video frames per second, averaged over the smoothing time; the first row of each trial is the acceleration at the control period. The paper says that inertial forces are of order 1e-4 mN, beside 22 mN of friction, and prints no smoothing time.
";

/// A table with its title and what to know of it.
struct Part {
    title: &'static str,
    table: Table,
    note: String,
}

/// The README in Markdown.
pub fn paper_readme(found: &Paper) -> String {
    let tables = parts(found).into_iter().map(|Part { title, table, note }| format!("\n## {title}\n\n{}\n{note}\n", table.markdown()));
    let tables: String = tables.collect();
    wrapped_markdown(&format!("# The paper's results\n\n{}\n\n{}\n{tables}\n## Files\n\n{FILES}", found.answer, made_by(found)))
}

/// The page with its `figures`: what is not reproduced, then every table, and the figures.
pub fn paper_page(found: &Paper, figures: &Figures, manifest: &Manifest) -> Page {
    let answer = if found.not_reproduced.is_empty() { Answer::Yes } else { Answer::Partly };
    let headline = Headline::new(answer, found.answer.clone()).with(Block::text(made_by(found).replace('`', "")));
    let page = parts(found).into_iter().fold(Page::new("The paper's results", headline), |page, Part { title, table, note }| {
        let note = (!note.is_empty()).then(|| Block::text(note.replace('`', "")));
        page.section(title, [Block::Table(table)].into_iter().chain(note).collect())
    });
    page.section("Figures", figures.iter().map(|(_, caption, svg)| Block::figure(svg.as_str(), *caption)).collect()).from(manifest)
}

/// What made the results, and what the intervals are.
fn made_by(found: &Paper) -> String {
    format!(
        "Made by `cohaul paper`, {}, seeds from {}. Intervals are 95 %, Student's t times the standard error by the bootstrap over seeds; ticks and pulls of one run are not independent.",
        found.reading(),
        found.first_seed
    )
}

/// All tables that have lines, what is not reproduced first.
fn parts(found: &Paper) -> Vec<Part> {
    let missed = part("What is not reproduced", &["what", "paper", "here", ""], &found.not_reproduced, "", |missed| {
        let certain = if missed.is_certain { "not reproduced" } else { "these seeds do not tell" };
        vec![missed.what.clone(), missed.paper.clone(), missed.here.clone(), certain.to_owned()]
    });
    let sets = part("Sets of runs", &["set", "seeds", "runs that arrive"], &found.sets, "", |set| {
        vec![set.name.clone(), set.n_seeds.to_string(), format!("{} of {}", set.n_arrived, set.n_runs)]
    });
    let all = [missed, sets].into_iter().chain(beside_the_paper(found)).chain(beside_each_other(found));
    all.filter(|part| !part.table.rows.is_empty()).collect()
}

/// What the paper prints, says or measured beside the first set.
fn beside_the_paper(found: &Paper) -> [Part; 5] {
    let printed: Vec<_> = found.table.iter().filter_map(|row| Some((row.printed?, row))).collect();
    [
        part("Beside what is printed", &["quantity", "paper", "here", "grade", "why"], &printed, GRADES, |(printed, row)| {
            let grade = row.grade.map_or("", Grade::name).to_owned();
            vec![row.quantity.clone(), quantity(*printed, row.unit), with_interval(&row.ours, row.unit), grade, row.why.clone()]
        }),
        part("Claims", &["claim", "where", "statistic", "limit", "here", "holds", "contradicts"], &found.claims, NULLS, |claim| {
            let limit = format!("{} {}", claim.side(), number(claim.limit));
            let [name, source, holds, contradicts] =
                [claim.claim, claim.source, holds(claim.holds), claim.contradicts.name()].map(str::to_owned);
            vec![name, source, claim.statistic.clone(), limit, with_interval(&claim.found, ""), holds, contradicts]
        }),
        samples(found),
        part(
            "Beside what was measured on ants",
            &["quantity", "measured", "samples", "here"],
            &found.experiment,
            "Pulls of all trials at every control period, and group sizes of the trial of ten ants. The paper does not say that its simulation meets these numbers; they have no grade.",
            |row| {
                vec![row.quantity.clone(), quantity(row.measured, row.unit), row.n_measured.to_string(), with_interval(&row.here, row.unit)]
            },
        ),
        part(
            "Inertial force m a by smoothing time",
            &["trial", "smoothing", "mean", "rms", "largest"],
            &found.inertial_force,
            FORCES,
            |row| {
                let rms = row.rms_n.map_or_else(String::new, |rms| quantity(rms.value, "N"));
                let (smoothing, largest) = (quantity(row.smoothing_s, "s"), quantity(row.largest_n, "N"));
                vec![row.trial.name(), smoothing, with_interval(&row.mean_n, "N"), rms, largest]
            },
        ),
    ]
}

/// Sets beside each other, backends on the same path, and changes in each run.
fn beside_each_other(found: &Paper) -> [Part; 3] {
    let sets = found.conclusions.iter().take(1).flat_map(|conclusion| conclusion.on.iter().map(|standing| standing.set.as_str()));
    let heads: Vec<&str> = std::iter::once("conclusion").chain(sets).collect();
    let lengths = ["trial", "verdict", "inertia effect", "engine error", "reference error", "path length"];
    [
        part(
            "Conclusions by backend and inertia",
            &heads,
            &found.conclusions,
            "Each cell is the value and whether the conclusion holds there (`?`: unknown with these seeds). Inertia is scaled at the same friction.",
            conclusion,
        ),
        part("Replayed: largest edge displacements", &lengths, &found.replayed, "", |one| {
            let lengths = [one.inertia_effect_m, one.engine_error_m, one.reference_error_m].map(|length| quantity(length, "m"));
            let path = format!("{} in {}", quantity(one.path_length_m, "m"), quantity(one.duration_s, "s"));
            [vec![one.trial.name(), one.verdict.clone()], lengths.to_vec(), vec![path]].concat()
        }),
        part(
            "One change of mean in a run",
            &["trial", "series", "runs", "significant", "of those rising", "median time"],
            &found.transitions,
            "Best place of two means by least squares; significant at 5 % among series of the same 4 s blocks in random order, so that a twentieth is chance. From the first instant at which all ants pull to 60 mm before the nest.",
            |row| {
                let [n_runs, n_significant, n_rising] = [row.n_runs, row.n_significant, row.n_rising].map(|n| n.to_string());
                let median = row.median_time_s.map_or_else(String::new, |time| quantity(time, "s"));
                vec![row.trial.name(), row.series.to_owned(), n_runs, n_significant, n_rising, median]
            },
        ),
    ]
}

fn part<T>(title: &'static str, heads: &[&str], rows: &[T], note: &str, cells: impl Fn(&T) -> Vec<String>) -> Part {
    let table = Table::new("", heads.iter().copied()).with_rows(rows.iter().map(cells));
    Part { title, table, note: note.trim().to_owned() }
}

/// Printed counts as a mixture of the trials.
fn samples(found: &Paper) -> Part {
    let sizes: Vec<_> = found.mixture.iter().flat_map(|mixture| (1..=10).map(move |size| (size, mixture))).collect();
    let note = found.mixture.as_ref().map_or_else(String::new, |mixture| {
        let trials = mixture.trials.iter();
        let trials = trials.map(|part| format!("{} {} ({} runs)", part.trial.name(), number(part.weight), number(part.n_runs)));
        format!(
            "Weights of the trials, by the largest likelihood of the printed counts, and runs with as many samples at every control period: {}. Of samples with two or more ants, a share of {} has another number of ants in the mixture than printed.",
            trials.collect::<Vec<_>>().join(", "),
            number(mixture.misplaced())
        )
    });
    let heads = ["pulling ants", "printed samples", "mixture", "printed share of two or more", "mixture"];
    part("Samples of Fig. 9 as a mixture of the trials", &heads, &sizes, &note, |(size, mixture)| {
        let share = |share: f64| if *size > 1 { number(share) } else { String::new() };
        let counts = [*size as u64, SIMULATED_SAMPLES[size - 1], mixture.n_samples(*size)].map(|n| n.to_string());
        [counts.to_vec(), vec![share(printed_share(*size)), share(mixture.share_of_two_or_more(*size))]].concat()
    })
}

fn holds(holds: Option<bool>) -> &'static str {
    match holds {
        Some(true) => "yes",
        Some(false) => "no",
        None => "?",
    }
}

fn conclusion(conclusion: &Conclusion) -> Vec<String> {
    let cell = |standing: &Standing| {
        let value = standing.value.map_or_else(|| "-".to_owned(), number);
        let is_changed = conclusion.changed_on.contains(&standing.set);
        let answer = format!("{value}, {}", holds(standing.holds));
        if is_changed { format!("**{answer}**") } else { answer }
    };
    std::iter::once(conclusion.conclusion.clone()).chain(conclusion.on.iter().map(cell)).collect()
}
