//! The four trials of the paper as scenarios: as many ants and springs, and who moves the load.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use cohaul::backend::{BackendKind, BackendOptions};
use cohaul::scenario::presets::Preset;
use cohaul::scenario::{Scenario, ScenarioError};

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
/// Longest time of a run of the literal presets (s). Their four ants need more than the 300 s of
/// the scenarios.
const LITERAL_DURATION_S: f64 = 1800.0;

/// Who carries, and how the load is moved: all that a set of seeds has in common.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    pub preset: Preset,
    pub backend: BackendKind,
    /// Mass and moment of inertia over those of the paper's load (1), at the same friction.
    pub inertia: f64,
    /// Keys of the scenario, as `drive.pull_speed_m_per_s`, with their values.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<(String, Value)>,
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
    /// # Errors
    /// When a value that the case sets breaks a rule of scenarios.
    pub fn checked(self, case: &Case, seed: u64) -> Result<Scenario, ScenarioError> {
        let mut scene: Value = serde_json::from_str(self.text()).expect("scenarios of the project are JSON");
        scene["drive"]["preset"] = case.preset.name().into();
        // The text of any number of ants on ten springs is that of ten.
        scene["drive"]["n_ants"] = self.n_ants().into();
        if let Preset::LiteralNewtons | Preset::LiteralMillinewtons = case.preset {
            scene["control_period_s"] = LITERAL_PERIOD_S.into();
            scene["duration_s"] = LITERAL_DURATION_S.into();
        }
        case.set.iter().for_each(|(key, value)| set(&mut scene, key, value));
        let mut scenario = Scenario::parse(&scene.to_string(), &self.name())?;
        scenario.seed = seed;
        scenario.system.load.mass *= case.inertia;
        scenario.system.load.inertia *= case.inertia;
        Ok(scenario)
    }

    /// The same of a case whose values were checked.
    ///
    /// # Panics
    /// When a value that the case sets breaks a rule of scenarios.
    pub fn scenario(self, case: &Case, seed: u64) -> Scenario {
        self.checked(case, seed).unwrap_or_else(|error| panic!("{error}"))
    }
}

/// Sets a key of a scenario as written. A path through a number, a word or a list leads to a
/// scenario that breaks a rule.
fn set(scene: &mut Value, key: &str, value: &Value) {
    let mut place = scene;
    for part in key.split('.') {
        if !place.is_object() {
            *place = json!({});
        }
        place = &mut place[part];
    }
    *place = value.clone();
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
        Self { preset, backend, inertia: 1.0, set: Vec::new() }
    }

    /// How a scenario of this case is run: at the step that its backend has unasked.
    pub fn options(&self, scenario: &Scenario) -> BackendOptions {
        BackendOptions::at_step(None, self.backend, &scenario.system, scenario.control_period)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::scenario::Drive;

    #[test]
    fn inertia_is_scaled_and_friction_is_not() {
        let case = |inertia| Case { inertia, ..Case::new(Preset::default(), BackendKind::Inertial) };
        for trial in Trial::ALL {
            let [one, ten] = [1.0, 10.0].map(|inertia| trial.scenario(&case(inertia), 3).system);
            assert_eq!((ten.load.mass, ten.load.inertia), (10.0 * one.load.mass, 10.0 * one.load.inertia));
            assert_eq!(ten.total_slip_limit(), one.total_slip_limit());
        }
    }

    /// A value is set at its key, and a wrong key or value is an error that names its path.
    #[test]
    fn values_are_set_at_their_keys() {
        let case =
            |key: &str, value: Value| Case { set: vec![(key.to_owned(), value)], ..Case::new(Preset::default(), BackendKind::QuasiStatic) };
        let slow = Trial::FourFour.scenario(&case("drive.pull_speed_m_per_s", json!(0.02)), 1);
        let Drive::Ants(ants) = slow.drive else { panic!("ants") };
        assert_eq!(ants.pull_speed, 0.02);
        for (key, value) in [
            ("drive.pull_speed", json!(0.02)),
            ("drive.pull_speed_m_per_s", json!("fast")),
            ("drive.n_ants.most", json!(3)),
            ("springs.0.rest_length_m", json!(0.02)),
            ("", json!(1)),
        ] {
            let error = Trial::FourFour.checked(&case(key, value), 1).unwrap_err().to_string();
            assert!(key.split('.').next().is_some_and(|part| error.contains(part)), "{key}: {error}");
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
