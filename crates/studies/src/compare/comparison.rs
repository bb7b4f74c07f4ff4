//! A comparison as data: the answer, and the results by tier.

use serde::Serialize;

use crate::compare::answer;
use crate::compare::beside::Beside;
use cohaul::analysis::compare::{ClosedLoop, EngineName, Pathwise, Settings, Verdict};
use cohaul::formats::{self, Format, Versioned};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Health, Trace};
use cohaul_engines::Engine;
use cohaul_report::chart::Labelled;
use cohaul_report::page::Answer;

/// Result of `cohaul compare`, as `--json` prints it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Whether the quasi-static backend is valid, and the engine error, in words.
    pub answer: String,
    pub scenario: String,
    pub seed: u64,
    pub settings: Settings,
    pub tiers: Tiers,
    /// Paths of the engines after the first, beside the same exact paths as in the tiers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub other_engines: Vec<Pathwise>,
    /// Engines that do not take the scene, where others do.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub refused_by: Vec<Refusal>,
    /// A path recorded elsewhere, beside those of the first tier of paths.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beside: Option<Beside>,
    /// Real time that the comparison took (s).
    pub wall_s: f64,
}

/// An engine that does not take the scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Refusal {
    pub engine: EngineName,
    pub why: String,
}

impl Refusal {
    /// The refusals of these engines.
    pub fn of(engines: &[&Engine]) -> Vec<Self> {
        let refusal = |engine: &&Engine| Some(Self { engine: engine.name().clone(), why: engine.refused()?.to_owned() });
        engines.iter().filter_map(refusal).collect()
    }
}

impl Versioned for Comparison {
    const FORMAT: Format = formats::COMPARE;
}

/// Results by tier; a tier that was not asked for is left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Tiers {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prescribed: Option<Pathwise>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub replayed: Option<Pathwise>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub controlled: Option<Pathwise>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closed_loop: Option<ClosedLoop>,
}

impl Comparison {
    /// `tiers` after `wall_s` (s) of real time. The answer is that of paths, if there are any.
    pub fn new(scenario: &Scenario, settings: &Settings, tiers: Tiers, wall_s: f64) -> Self {
        let paths = tiers.pathwise().next().map(answer::sentence_of_paths);
        let answer = paths.or(tiers.closed_loop.as_ref().map(answer::sentence_of_ensemble)).unwrap_or_default();
        let (scenario, seed) = (scenario.name.clone(), scenario.seed);
        Self { answer, scenario, seed, settings: *settings, tiers, other_engines: Vec::new(), refused_by: Vec::new(), beside: None, wall_s }
    }

    /// With the paths of other engines, and those that refuse the scene. The answer has them too.
    pub fn with_other_engines(mut self, others: Vec<Pathwise>, refused_by: Vec<Refusal>) -> Self {
        let tier = self.tiers.pathwise().next().map(|found| found.tier);
        for other in others.iter().filter(|other| Some(other.tier) == tier) {
            self.answer = format!("{} {}", self.answer, answer::sentence_of_engine(other));
        }
        for Refusal { engine, why } in &refused_by {
            self.answer = format!("{} {} refuses the scene: {}.", self.answer, engine.name, why.trim_end_matches('.'));
        }
        Self { other_engines: others, refused_by, ..self }
    }

    /// Comparisons of paths of all engines, those of the first one before the others.
    pub fn all_paths(&self) -> impl Iterator<Item = &Pathwise> {
        self.tiers.pathwise().chain(&self.other_engines)
    }

    /// Comparisons of the paths of all engines in the tier of the first one's `found`.
    pub fn side_by_side<'a>(&'a self, found: &'a Pathwise) -> Vec<&'a Pathwise> {
        [found].into_iter().chain(self.other_engines.iter().filter(|other| other.tier == found.tier)).collect()
    }

    /// Runs of all engines in that tier, after the exact ones.
    pub fn runs<'a>(&'a self, found: &'a Pathwise) -> Vec<Labelled<'a>> {
        let of_engine = |of: &'a Pathwise| Labelled { label: &of.engine.name, trace: &of.solutions[2].trace };
        let exact = found.solutions[..2].iter().map(|solution| Labelled { label: solution.kind.name(), trace: &solution.trace });
        exact.chain(self.side_by_side(found).into_iter().map(of_engine)).collect()
    }

    /// Lays a recorded path beside those of the first tier of paths.
    ///
    /// # Errors
    /// When there is no instant at which both exist.
    pub fn lay_beside(&mut self, file: &str, recorded: Trace) -> Result<(), String> {
        let Some(found) = self.tiers.pathwise().next() else { return Ok(()) };
        self.beside = Some(Beside::new(file, recorded, found)?);
        Ok(())
    }

    /// The worst account: a comparison that could not be computed has failed, and one with doubts
    /// or with a run that is not ok is doubtful.
    pub fn worst(&self) -> Health {
        let accounts = self.all_paths().flat_map(|found| &found.solutions).map(|solution| solution.account.health);
        let is_doubted =
            self.all_paths().any(|found| !found.doubts.is_empty()) || self.tiers.closed_loop.iter().any(|found| !found.doubts.is_empty());
        match () {
            () if !self.are_computed() => Health::Failed,
            () if is_doubted || accounts.max() > Some(Health::Ok) => Health::Doubtful,
            () => Health::Ok,
        }
    }

    /// Whether all runs succeeded.
    pub fn are_computed(&self) -> bool {
        let verdicts = self.all_paths().map(|found| found.verdict);
        verdicts.chain(self.tiers.closed_loop.iter().map(|found| found.verdict)).all(|verdict| verdict != Verdict::NotComputed)
    }

    /// Whether the answer is that quasi-static is valid.
    pub fn is_valid(&self) -> Answer {
        let paths = self.tiers.pathwise().next().map(answer::of_paths);
        paths.or(self.tiers.closed_loop.as_ref().map(answer::of_ensemble)).unwrap_or(Answer::Open)
    }
}

impl Tiers {
    /// Comparisons of paths: prescribed, replayed, then controlled.
    pub fn pathwise(&self) -> impl Iterator<Item = &Pathwise> {
        [&self.prescribed, &self.replayed, &self.controlled].into_iter().flatten()
    }
}
