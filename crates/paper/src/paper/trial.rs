//! The four trials of the paper as scenarios: as many ants and springs, and who moves the load.

use serde::{Deserialize, Serialize};

use cohaul::backend::{BackendKind, BackendOptions};
use cohaul::scenario::presets::{self, Preset};
use cohaul::scenario::{Drive, Scenario};

/// Ants over springs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Trial {
    OneOne,
    FourFour,
    /// So many ants, from one to ten, on ten springs.
    OnTen(u8),
}

/// Control period of the literal presets (s). At the printed walking speed a spring gains 4 mN in a
/// step, and pulls are as printed.
pub const LITERAL_PERIOD_S: f64 = 0.08;

/// Who carries, and how the load is moved: all that a set of seeds has in common.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    pub preset: Preset,
    pub backend: BackendKind,
    /// Mass and moment of inertia over those of the paper's load (1), at the same friction.
    pub inertia: f64,
}

impl Trial {
    pub const FIVE_TEN: Trial = Trial::OnTen(5);
    pub const TEN_TEN: Trial = Trial::OnTen(10);
    /// The trials of the paper.
    pub const ALL: [Trial; 4] = [Trial::OneOne, Trial::FourFour, Trial::FIVE_TEN, Trial::TEN_TEN];
    /// Number of all trials.
    pub(super) const COUNT: usize = 12;

    /// Numbers of ants and of springs.
    fn counts(self) -> [usize; 2] {
        match self {
            Trial::OneOne => [1, 1],
            Trial::FourFour => [4, 4],
            Trial::OnTen(n_ants) => [n_ants.into(), 10],
        }
    }

    pub fn name(self) -> String {
        self.counts().map(|n| n.to_string()).join("/")
    }

    pub fn n_ants(self) -> usize {
        self.counts()[0]
    }

    /// From zero to below [`Trial::COUNT`].
    pub(super) fn index(self) -> usize {
        match self {
            Trial::OneOne => 0,
            Trial::FourFour => 1,
            Trial::OnTen(n_ants) => 1 + usize::from(n_ants),
        }
    }

    pub(super) fn text(self) -> &'static str {
        match self {
            Trial::OneOne => include_str!("../../../../scenarios/paper/one-ant-one-spring.json"),
            Trial::FourFour => include_str!("../../../../scenarios/paper/four-ants-four-springs.json"),
            Trial::FIVE_TEN => include_str!("../../../../scenarios/paper/five-ants-ten-springs.json"),
            Trial::OnTen(_) => include_str!("../../../../scenarios/paper/ten-ants-ten-springs.json"),
        }
    }

    /// The trial of `case` at `seed`.
    ///
    /// # Panics
    /// Never: the texts are scenarios of the project.
    pub fn scenario(self, case: &Case, seed: u64) -> Scenario {
        let mut scenario = Scenario::parse(self.text(), &self.name()).expect("scenarios of the project are valid");
        scenario.seed = seed;
        scenario.drive = Drive::Ants(presets::ants(case.preset, self.n_ants()));
        if let Preset::LiteralNewtons | Preset::LiteralMillinewtons = case.preset {
            scenario.control_period = LITERAL_PERIOD_S;
        }
        scenario.system.load.mass *= case.inertia;
        scenario.system.load.inertia *= case.inertia;
        scenario
    }
}

impl From<Trial> for String {
    fn from(trial: Trial) -> Self {
        trial.name()
    }
}

impl TryFrom<String> for Trial {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        let all = [Trial::OneOne, Trial::FourFour].into_iter().chain((1..=10).map(Trial::OnTen));
        all.into_iter().find(|trial| trial.name() == name).ok_or_else(|| format!("no trial {name}"))
    }
}

impl Case {
    /// The backend with the load of the paper.
    pub fn new(preset: Preset, backend: BackendKind) -> Self {
        Self { preset, backend, inertia: 1.0 }
    }

    /// How a scenario of this case is run: at the step that its backend has unasked.
    pub fn options(&self, scenario: &Scenario) -> BackendOptions {
        BackendOptions::at_step(None, self.backend, &scenario.system, scenario.control_period)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inertia_is_scaled_and_friction_is_not() {
        let case = |inertia| Case { inertia, ..Case::new(Preset::default(), BackendKind::Inertial) };
        for trial in Trial::ALL {
            let [one, ten] = [1.0, 10.0].map(|inertia| trial.scenario(&case(inertia), 3).system);
            assert_eq!((ten.load.mass, ten.load.inertia), (10.0 * one.load.mass, 10.0 * one.load.inertia));
            assert_eq!(ten.total_slip_limit(), one.total_slip_limit());
        }
    }

    /// What a user runs from `scenarios/paper` is what is judged here.
    #[test]
    fn the_default_case_is_the_shipped_scenario() {
        for trial in Trial::ALL {
            let shipped = Scenario::parse(trial.text(), "shipped").unwrap();
            assert_eq!(trial.scenario(&Case::new(Preset::default(), BackendKind::QuasiStatic), shipped.seed), shipped);
        }
    }
}
