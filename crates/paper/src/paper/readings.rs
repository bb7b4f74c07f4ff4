//! Readings of what the paper leaves open, beside each other: every printed fact under the default
//! preset, under decisions once per period, and under a single time step in each unit of zeta.

use std::path::Path;

use serde::Serialize;
use serde_json::{Value, json};

use super::hold::chance_to_move;
use super::report::runs_by_set;
use super::{Answer, Case, Fact, Measure, Plan, Set, Trial, facts_of, units};
use cohaul::backend::BackendKind;
use cohaul::formats::{self, Format, Versioned};
use cohaul::scenario::presets::Preset;
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::manifest::Manifest;
use cohaul_report::quantity::quantity;
use cohaul_report::table::Table;
use cohaul_report::text::wrapped_markdown;

/// What `paper readings --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Readings {
    pub first_seed: u64,
    pub n_seeds: u64,
    pub readings: Vec<Reading>,
}

impl Versioned for Readings {
    const FORMAT: Format = formats::PAPER_READINGS;
}

/// One reading with all printed facts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reading {
    pub reading: &'static str,
    pub preset: &'static str,
    /// Keys of the scenarios that it sets, with their values.
    pub set: Vec<(String, Value)>,
    /// Number of facts that it meets, without the phase change.
    pub n_met: usize,
    pub facts: Vec<Fact>,
    /// What the paper does not print: mean times to the nest of one and four ants (s), and the
    /// chance that an attachment to a load at rest lasts until its pull moves the load (1).
    pub time_of_one_s: Option<f64>,
    pub time_of_four_s: Option<f64>,
    pub chance_to_move: Option<f64>,
}

/// Name, preset and set values of each reading.
fn cases() -> [(&'static str, Case); 4] {
    let case = |preset, set: &[(&str, Value)]| Case {
        set: set.iter().map(|(key, value)| ((*key).to_owned(), value.clone())).collect(),
        ..Case::new(preset, BackendKind::QuasiStatic)
    };
    [
        ("default", case(Preset::default(), &[])),
        ("decisions once per period", case(Preset::default(), &[("drive.release_pace", json!("aged"))])),
        ("one step of 80 ms, newtons", case(Preset::LiteralNewtons, &[])),
        ("one step of 5 ms, millinewtons", case(Preset::LiteralMillinewtons, &[("control_period_s", json!(0.005))])),
    ]
}

/// All readings with as many seeds; a quarter of the seeds with other numbers of ants.
pub fn plan(first_seed: u64, n_seeds: u64) -> Plan {
    let set = |(_, case): (&str, Case)| Set { case, n_seeds, n_crowd_seeds: n_seeds.div_ceil(4) };
    Plan { preset: Preset::default(), first_seed, sets: cases().map(set).to_vec(), replayed: Vec::new(), replayed_s: 0.0 }
}

impl Readings {
    /// Of finished runs of the plan.
    pub fn new(plan: &Plan, done: &[Answer]) -> Self {
        let runs = runs_by_set(plan, done);
        let reading = |((name, case), runs): ((&'static str, Case), &super::report::Runs)| {
            let units = units(runs);
            let facts = facts_of(&units);
            Reading {
                reading: name,
                preset: case.preset.name(),
                n_met: facts.iter().filter(|fact| fact.is_ranked && fact.is_met).count(),
                facts,
                time_of_one_s: Measure::TimeToNest(Trial::OneOne).of(&units),
                time_of_four_s: Measure::TimeToNest(Trial::FourFour).of(&units),
                chance_to_move: chance_to_move(&Trial::OneOne.scenario(&case, plan.first_seed)),
                set: case.set,
            }
        };
        let n_seeds = plan.sets.first().map_or(0, |set| set.n_seeds);
        Self { first_seed: plan.first_seed, n_seeds, readings: cases().into_iter().zip(&runs).map(reading).collect() }
    }

    /// One row for each fact, one column for each reading.
    fn table(&self) -> Table {
        let heads = ["printed fact", "paper"].into_iter().chain(self.readings.iter().map(|reading| reading.reading));
        let mut table = Table::new("Readings of the paper, fact by fact", heads);
        let mut row = |name: &str, paper: &str, cell: &dyn Fn(&Reading) -> String| {
            table.push([name.to_owned(), paper.to_owned()].into_iter().chain(self.readings.iter().map(cell)));
        };
        let value = |value: Option<f64>, unit: &str| value.map_or_else(|| "-".to_owned(), |value| quantity(value, unit));
        for (at, fact) in self.readings[0].facts.iter().enumerate() {
            row(&fact.fact, &fact.paper, &|reading| {
                let Fact { value: found, unit, is_met, .. } = reading.facts[at];
                format!("{}{}", value(found, unit), if is_met { "" } else { ", missed" })
            });
        }
        row("facts met, without the phase change", "", &|reading| reading.n_met.to_string());
        row("time to nest, 1/1", "not printed", &|reading| value(reading.time_of_one_s, "s"));
        row("time to nest, 4/4", "not printed", &|reading| value(reading.time_of_four_s, "s"));
        row("chance that a pull reaches the friction of the load", "not printed", &|reading| value(reading.chance_to_move, ""));
        table
    }

    /// The table, for people.
    pub fn text(&self) -> String {
        let seeds = format!("{} seeds from {}", self.n_seeds, self.first_seed);
        format!("{}, {seeds}\n{}", self.table().caption, self.table().text())
    }

    fn readme(&self) -> String {
        let sets = self.readings.iter().map(|reading| {
            let set: Vec<String> = reading.set.iter().map(|(key, value)| format!(" --set {key}={value}")).collect();
            format!("- {}: `cohaul paper --preset {}{}`\n", reading.reading, reading.preset, set.concat())
        });
        wrapped_markdown(&format!(
            "# Readings of the paper\n\nThe paper prints neither a time step nor the unit of zeta. Each column is one reading, without \
             inertia, on {} seeds from {}. A number is met within 10 %, or 0.05 of a share, and a claim on its side of the limit.\n\n{}\n\
             The chance is that of an attachment to a load at rest that lasts until its pull is the friction of the load, computed from the \
             release law. Any other reading is graded in the same way:\n\n{}",
            self.n_seeds,
            self.first_seed,
            self.table().markdown(),
            sets.collect::<String>()
        ))
    }

    /// One row for each reading and fact.
    fn rows(&self) -> Table {
        let facts: Vec<_> = self.readings.iter().flat_map(|reading| reading.facts.iter().map(move |fact| (reading, fact))).collect();
        Table::of(
            &facts,
            &[
                ("reading", "", &|(reading, _)| reading.reading.into()),
                ("fact", "", &|(_, fact)| fact.fact.as_str().into()),
                ("unit", "", &|(_, fact)| fact.unit.into()),
                ("paper", "", &|(_, fact)| fact.paper.as_str().into()),
                ("value", "", &|(_, fact)| fact.value.into()),
                ("is met", "", &|(_, fact)| fact.is_met.into()),
            ],
        )
    }
}

/// Writes `readings.csv`, `README.md`, `summary.json` and `manifest.json` to the folder `target`,
/// all or nothing.
///
/// # Errors
/// When the folder may not be written, or the disk fails.
pub fn write_readings(target: &Path, found: &Readings, manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write("readings.csv", |out| found.rows().write_csv(out))?;
    folder.write("README.md", |out| out.write_all(found.readme().as_bytes()))?;
    folder.write_json("summary.json", found)?;
    folder.finish(manifest)
}
