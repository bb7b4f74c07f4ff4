//! Cells of a sweep, and the identity that distinguishes one sweep from another.

use std::ops::Range;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};

use super::column::{BEFORE, Column, columns};
use super::design::Design;
use super::error::SweepError;
use super::template::Template;
use crate::journal::{self, Header, JournalError};
use cohaul::backend::{BackendKind, BackendOptions, Integrator, RapierOptions, Skips, Tolerance};
use cohaul::formats::SHARD;
use cohaul::scenario::{Drive, Scenario, cut};
use cohaul_report::manifest::build_of_program;
use cohaul_report::table::Kind;

/// Version of the table. It changes whenever the row of the same run would.
pub const FORMAT: u32 = SHARD.version;

/// Most cells of one file: the place of each row stays in memory.
const MOST_CELLS: u64 = 100_000_000;

/// Longest reason of an error (characters). It may quote a text of any length from a file.
const LONGEST_REASON: usize = 500;

/// A way to run every point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Variant {
    pub backend: BackendKind,
    /// (s); `None` is that of [`cohaul::backend::default_step`] at each point, unless there is a
    /// tolerance.
    pub step_s: Option<f64>,
    /// (m)
    pub tolerance_m: Option<f64>,
    pub integrator: Integrator,
    pub rapier: RapierOptions,
    pub skips: Skips,
}

impl Variant {
    pub fn options(&self, scenario: &Scenario) -> BackendOptions {
        if let Some(tolerance) = self.tolerance_m {
            let tolerance = Tolerance::at_edge(tolerance, &scenario.system.load);
            return BackendOptions { skips: self.skips, ..BackendOptions::within(self.backend, tolerance) };
        }
        let options = BackendOptions::at_step(self.step_s, self.backend, &scenario.system, scenario.control_period);
        BackendOptions { integrator: self.integrator, rapier: self.rapier, skips: self.skips, ..options }
    }
}

/// Request for a sweep.
#[derive(Clone, Debug)]
pub struct Ask {
    /// Name of the scenario's file, for errors.
    pub file: String,
    /// Text of the scenario's file.
    pub text: String,
    pub design: Design,
    pub variants: Vec<Variant>,
    /// First seed; `None` takes that of the scenario.
    pub first_seed: Option<u64>,
    pub n_seeds: u64,
}

/// All that the table depends on. Two sweeps with the same identity have the same table, and shards
/// with different identities do not belong together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    pub format: u32,
    pub version: String,
    pub commit: Option<String>,
    /// Hash of the expanded scenario before any parameter is set.
    pub scenario_sha256: String,
    pub scenario: Value,
    pub design: Design,
    pub variants: Vec<Variant>,
    pub first_seed: u64,
    pub n_seeds: u64,
    pub n_cells: u64,
    pub columns: Vec<Column>,
}

impl Identity {
    /// What differs in `other`, each with both values as far as they are short; empty when nothing
    /// does.
    pub fn differences(&self, other: &Identity) -> Vec<String> {
        let [one, two] = [self, other].map(|it| serde_json::to_value(it).expect("an identity is plain data"));
        journal::differences(&one, &two)
    }

    /// Header of the files with the rows of these cells.
    ///
    /// # Errors
    /// When there are too many cells for one file.
    pub fn header(&self, cells: Range<u64>) -> Result<Header, SweepError> {
        let n_cells = cells.end - cells.start;
        if n_cells > MOST_CELLS {
            return Err(SweepError::axis("--shard", format!("must leave at most {MOST_CELLS} runs to one part"), n_cells));
        }
        Ok(Header::new("sweep", self, cells))
    }

    /// Identity of the sweep that the file of rows at `path` belongs to, and its cells.
    ///
    /// # Errors
    /// When the file cannot be read, or holds no rows of a sweep.
    pub fn read(path: &Path) -> Result<(Self, Range<u64>), SweepError> {
        let header = Header::read(path)?;
        let foreign = |error: String| JournalError::unusable(path, format!("has no rows of a sweep that this version reads: {error}"));
        let identity: Self = serde_json::from_value(header.identity).map_err(|error| foreign(cut(error.to_string(), LONGEST_REASON)))?;
        let cells = header.begin..header.end;
        let is_part = cells.start <= cells.end && cells.end <= identity.n_cells;
        match identity.fault() {
            // The rows of another format have other columns, and the format is named.
            Some(fault) if identity.format == FORMAT => Err(foreign(fault.to_owned()).into()),
            _ if !is_part => Err(foreign(format!("cells {} to {} of {}", cells.start, cells.end, identity.n_cells)).into()),
            _ => Ok((identity, cells)),
        }
    }

    /// What no sweep of this program has; `None` if nothing.
    fn fault(&self) -> Option<&'static str> {
        if Design::new(self.design.axes.clone(), self.design.sample).is_err() {
            return Some("its design breaks a rule");
        }
        let of_point = self.n_seeds.checked_mul(self.variants.len() as u64);
        let n_cells = of_point.and_then(|n| n.checked_mul(self.design.n_points()));
        if n_cells != Some(self.n_cells) || n_cells == Some(0) {
            return Some("its number of runs does not follow from its design");
        }
        let parameters = self.columns.iter().skip(BEFORE.len()).take(self.design.axes.len());
        let parameters: Vec<Column> = parameters.cloned().collect();
        let fits = |n: usize, more: bool| columns(parameters.clone(), n, more) == self.columns;
        let are_known = (0..=MOST_ATTACHED).any(|n| fits(n, false) || fits(n, true));
        (!are_known).then_some("its columns are not those of its design")
    }

    /// Number of the point that a cell belongs to.
    pub fn point_of(&self, cell: u64) -> u64 {
        cell / (self.n_seeds * self.variants.len() as u64)
    }

    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name == name)
    }

    /// Name of a backend, with its step (s) where the sweep has several of them.
    pub fn variant_name(&self, backend: &str, step_s: Option<f64>) -> String {
        let n_variants = self.variants.iter().filter(|variant| variant.backend.name() == backend).count();
        match step_s.filter(|_| n_variants > 1) {
            Some(step) => format!("{backend} at {step} s"),
            None => backend.to_owned(),
        }
    }

    /// The columns of parameters.
    pub fn parameters(&self) -> &[Column] {
        let first = BEFORE.len();
        &self.columns[first..first + self.design.axes.len()]
    }
}

/// A sweep whose parameters all have a place in the scenario.
#[derive(Clone, Debug)]
pub struct Plan {
    template: Template,
    pub identity: Identity,
    is_whole: Vec<bool>,
    /// Largest number of attached springs with a column of its own.
    pub most_attached: usize,
}

/// Point, method and seed of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    pub point: u64,
    pub variant: usize,
    pub seed: u64,
}

/// Largest number of attached springs that may have a column of its own.
const MOST_ATTACHED: usize = 10;

impl Plan {
    /// # Errors
    /// When the scenario breaks a rule, a parameter has no place in it, or there are too many
    /// cells.
    pub fn new(ask: Ask) -> Result<Self, SweepError> {
        let template = Template::new(&ask.text, &ask.file, &ask.design.axes)?;
        let base = template.base();
        let first_seed = ask.first_seed.unwrap_or(base.seed);
        if ask.n_seeds == 0 || first_seed.checked_add(ask.n_seeds - 1).is_none() {
            return Err(SweepError::axis("--seeds", "must be at least 1, and the last seed below 2^64", ask.n_seeds));
        }
        let of_point = ask.n_seeds.checked_mul(ask.variants.len() as u64);
        let n_cells = of_point.and_then(|n| n.checked_mul(ask.design.n_points()));
        let n_cells = n_cells.ok_or_else(|| SweepError::axis("--seeds", "must make less than 2^64 runs", "more"))?;
        let can_be_more = template.varies_attachments() || attachable(base) > MOST_ATTACHED;
        let most_attached = if can_be_more { MOST_ATTACHED } else { attachable(base) };
        let parameters = template.columns();
        let (version, commit) = build_of_program();
        let is_whole = parameters.iter().map(|column| column.kind == Kind::Whole).collect();
        let identity = Identity {
            format: FORMAT,
            version: version.to_owned(),
            commit: commit.map(str::to_owned),
            scenario_sha256: base.hash(),
            scenario: template.written().clone(),
            design: ask.design,
            variants: ask.variants,
            first_seed,
            n_seeds: ask.n_seeds,
            n_cells,
            columns: columns(parameters, most_attached, can_be_more),
        };
        Ok(Self { template, identity, is_whole, most_attached })
    }

    pub fn base(&self) -> &Scenario {
        self.template.base()
    }

    pub fn place(&self, cell: u64) -> Place {
        let identity = &self.identity;
        let (rest, seed) = (cell / identity.n_seeds, cell % identity.n_seeds);
        let n_variants = identity.variants.len() as u64;
        Place { point: rest / n_variants, variant: (rest % n_variants) as usize, seed: identity.first_seed + seed }
    }

    /// Values of the parameters at a point.
    pub fn values(&self, point: u64) -> Vec<Value> {
        let values = self.identity.design.point(point, &self.is_whole);
        let whole = |(value, is_whole): (Value, &bool)| match value.as_f64() {
            Some(number) if *is_whole => Value::from(number as u64),
            _ => value,
        };
        values.into_iter().zip(&self.is_whole).map(whole).collect()
    }

    /// # Errors
    /// When the point breaks a rule of the scenario.
    pub fn scenario(&self, values: &[Value]) -> Result<Scenario, SweepError> {
        self.template.scenario(values)
    }
}

/// Number of springs that can be attached at once.
fn attachable(scenario: &Scenario) -> usize {
    let n_springs = scenario.system.springs.len();
    match &scenario.drive {
        Drive::Ants(ants) => ants.n_ants.min(n_springs),
        Drive::Tips(paths) => paths.len().min(n_springs),
    }
}

/// Short key of everything that determines the row of a cell, the format included.
pub fn content_key(of_point: &[u8], seed: u64) -> String {
    let mut hash = Sha256::new();
    hash.update(of_point);
    hash.update(seed.to_le_bytes());
    // 80 bits: two of 10^9 cells have the same key with a probability below 10^-6.
    hash.finalize()[..10].iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Part of the key that all seeds of a point and options share.
pub fn point_hash(scenario: &Scenario, options: &BackendOptions) -> Vec<u8> {
    let unseeded = Scenario { seed: 0, ..scenario.clone() };
    let text = serde_json::to_string(&(FORMAT, unseeded.hash(), options)).expect("options are plain data");
    Sha256::digest(text).to_vec()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::sweep::design::{Method, Sample};

    const SCENE: &str = include_str!("../../../../scenarios/paper/four-ants-four-springs.json");

    fn variant(backend: BackendKind) -> Variant {
        let (integrator, rapier) = (Integrator::default(), RapierOptions::default());
        Variant { backend, step_s: None, tolerance_m: None, integrator, rapier, skips: Skips::ALL }
    }

    pub fn plan(axes: &[&str], sample: Option<Sample>, n_seeds: u64) -> Plan {
        let axes = axes.iter().map(|axis| axis.parse().unwrap()).collect();
        let design = Design::new(axes, sample).unwrap();
        let variants = vec![variant(BackendKind::QuasiStatic), variant(BackendKind::Inertial)];
        Plan::new(Ask { file: "four.json".into(), text: SCENE.into(), design, variants, first_seed: Some(7), n_seeds }).unwrap()
    }

    pub fn identity() -> Identity {
        plan(&[], None, 2).identity
    }

    #[test]
    fn cells_run_through_points_then_backends_then_seeds() {
        let plan = plan(&["load.mass_kg=0.001,0.002,0.003", "drive.n_ants=2,4"], None, 5);
        assert_eq!(plan.identity.n_cells, 60);
        assert_eq!(plan.place(0), Place { point: 0, variant: 0, seed: 7 });
        assert_eq!(plan.place(9), Place { point: 0, variant: 1, seed: 11 });
        assert_eq!(plan.place(59), Place { point: 5, variant: 1, seed: 11 });
        assert_eq!(plan.values(3), [Value::from(0.002), Value::from(4)]);
        assert_eq!(plan.identity.point_of(59), 5);
        // The number of attached springs depends on a parameter, so that the last column is for ten
        // and more.
        assert_eq!(plan.identity.columns.last().unwrap().name, "time_share_10_or_more_attached");
        assert_eq!(identity().columns.last().unwrap().name, "time_share_4_attached");
    }

    /// The same physics in another notation has the same key; every number, option and seed changes
    /// it.
    #[test]
    fn keys_are_of_the_content() {
        let key = |plan: &Plan, point, variant: usize, seed| {
            let scenario = plan.scenario(&plan.values(point)).unwrap();
            content_key(&point_hash(&scenario, &plan.identity.variants[variant].options(&scenario)), seed)
        };
        let base = key(&plan(&[], None, 1), 0, 0, 7);
        let masses = plan(&["load.mass_kg=0.0016,0.0017"], None, 1);
        assert_eq!(key(&masses, 0, 0, 7), base);
        assert_ne!(key(&masses, 1, 0, 7), base);
        assert_ne!(key(&masses, 0, 1, 7), base);
        assert_ne!(key(&masses, 0, 0, 8), base);
        assert_eq!(base.len(), 20);
    }

    /// An identity is stored in the files of shards and must be equal afterwards, to the last bit.
    #[test]
    fn an_identity_reads_back_as_it_was_and_names_differences() {
        let sample = Some(Sample { method: Method::LatinHypercube, n: 3, seed: Some(1) });
        let one = plan(&["load.mass_kg=log:1e-3..0.30000000000000004"], sample, 2).identity;
        let back: Identity = serde_json::from_str(&serde_json::to_string(&one).unwrap()).unwrap();
        assert_eq!(back, one);
        let other = Identity { version: "0.0.9".into(), ..one.clone() };
        assert_eq!(one.differences(&other), ["version is \"0.0.9\", not \"0.1.0\""]);
    }
}
