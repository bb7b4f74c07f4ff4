//! Makes the scenario of a point of the design.
//!
//! A parameter is set in the scenario as written where that has a place for it. Defaults then
//! follow: normal loads and the moment of inertia follow the mass. Otherwise it is set in the
//! expanded scenario, where nothing follows. Factors come last. Every scenario is validated as a
//! whole.

use serde_json::Value;

use super::axis::Axis;
use super::column::Column;
use super::error::SweepError;
use super::factor::Factor;
use super::path::Path;
use cohaul::scenario::json::{join, without_mark};
use cohaul::scenario::{Scenario, ScenarioError, nearest};
use cohaul_report::table::Kind;

/// A scenario with places for parameters.
#[derive(Clone, Debug)]
pub struct Template {
    /// Name of the file, for errors.
    file: String,
    written: Value,
    base: Scenario,
    places: Vec<Place>,
}

#[derive(Clone, Debug)]
struct Place {
    name: String,
    target: Target,
    kind: Kind,
}

#[derive(Clone, Debug, PartialEq)]
enum Target {
    Written(Path),
    Expanded(Path),
    /// The whole scene.
    Factor(Factor),
}

impl Template {
    /// Template of the scenario in `text` with a place for each of `axes`; errors call the text
    /// `file`.
    ///
    /// # Errors
    /// When the scenario breaks a rule, or has no such parameter.
    pub fn new(text: &str, file: &str, axes: &[Axis]) -> Result<Self, SweepError> {
        let base = Scenario::parse(text, file)?;
        let written = serde_json::from_str(without_mark(text)).expect("a scenario is JSON");
        let mut template = Self { file: file.to_owned(), written, base, places: Vec::new() };
        for axis in axes {
            let place = template.place(axis)?;
            // Two names may lead to the same place.
            if let Some(other) = template.places.iter().find(|other| other.target == place.target) {
                return Err(SweepError::axis(&axis.path, "must be varied once", format!("it again as {}", other.name)));
            }
            template.places.push(place);
        }
        Ok(template)
    }

    pub fn base(&self) -> &Scenario {
        &self.base
    }

    pub fn written(&self) -> &Value {
        &self.written
    }

    pub fn columns(&self) -> Vec<Column> {
        self.places.iter().map(|place| Column::new(&place.name, place.kind)).collect()
    }

    /// Whether some parameter can change the number of springs that can be attached.
    pub fn varies_attachments(&self) -> bool {
        let varies = |path: &Path| path.begins_with("springs") || *path == Path::parse("drive.n_ants").expect("a path");
        self.places.iter().any(|place| matches!(&place.target, Target::Written(path) | Target::Expanded(path) if varies(path)))
    }

    /// Scenario with one value for each axis.
    ///
    /// # Errors
    /// When it breaks a rule.
    pub fn scenario(&self, values: &[Value]) -> Result<Scenario, SweepError> {
        let pairs = || self.places.iter().zip(values);
        let mut written = self.written.clone();
        for (place, value) in pairs() {
            if let Target::Written(path) = &place.target {
                self.set(path, &mut written, place, value)?;
            }
        }
        let mut scenario = self.parsed(&written, values)?;
        if pairs().any(|(place, _)| matches!(place.target, Target::Expanded(_))) {
            let mut expanded = expanded(&scenario);
            for (place, value) in pairs() {
                if let Target::Expanded(path) = &place.target {
                    self.set(path, &mut expanded, place, value)?;
                }
            }
            scenario = self.parsed(&expanded, values)?;
        }
        self.scaled(scenario, values)
    }

    /// The scene after all factors.
    fn scaled(&self, mut scenario: Scenario, values: &[Value]) -> Result<Scenario, SweepError> {
        let mut is_changed = false;
        for (place, value) in self.places.iter().zip(values) {
            if let Target::Factor(factor) = place.target {
                factor.apply(&mut scenario, positive(&place.name, value)?);
                is_changed = true;
            }
        }
        if is_changed { self.checked(scenario.expanded().checked(&self.file), values) } else { Ok(scenario) }
    }

    fn parsed(&self, scene: &Value, values: &[Value]) -> Result<Scenario, SweepError> {
        self.checked(Scenario::parse(&scene.to_string(), &self.file), values)
    }

    /// The scenario, or which values break a rule.
    fn checked(&self, scenario: Result<Scenario, ScenarioError>, values: &[Value]) -> Result<Scenario, SweepError> {
        scenario.map_err(|source| SweepError::Point { values: self.described(values), source })
    }

    fn set(&self, path: &Path, scene: &mut Value, place: &Place, value: &Value) -> Result<(), SweepError> {
        // Another parameter may have removed the place, as fewer springs do.
        if path.set(scene, value) { Ok(()) } else { Err(no_such(&place.name, scene)) }
    }

    /// Values for people, such as `a = 1, b = 2`.
    pub fn described(&self, values: &[Value]) -> String {
        let pairs = self.places.iter().zip(values).map(|(place, value)| match value {
            Value::String(word) => format!("{} = {word}", place.name),
            value => format!("{} = {value}", place.name),
        });
        let text = pairs.collect::<Vec<_>>().join(", ");
        if text.is_empty() { "the scenario as it is".to_owned() } else { text }
    }

    fn place(&self, axis: &Axis) -> Result<Place, SweepError> {
        let name = axis.path.clone();
        if let Some(factor) = Factor::named(&axis.path) {
            factor.check(&axis.path, &self.base)?;
            return Ok(Place { name, target: Target::Factor(factor), kind: Kind::Number });
        }
        let path = Path::parse(&axis.path)?;
        if path.begins_with("seed") {
            return Err(SweepError::axis(&axis.path, "must be set by --seed and --seeds", "it among the parameters"));
        }
        let expanded = expanded(&self.base);
        let kind = kind(axis, path.first(&expanded), path.first(&self.written));
        let takes = |value: &Value| {
            let mut trial = self.written.clone();
            path.set(&mut trial, value) && Scenario::parse(&trial.to_string(), &self.file).is_ok()
        };
        let is_written = match path.first(&expanded) {
            _ if path.first(&self.written).is_some() => true,
            Some(value) => takes(value),
            None if takes(&axis.value(0)) => true,
            None => return Err(no_such(&axis.path, &expanded)),
        };
        Ok(Place { name, target: if is_written { Target::Written(path) } else { Target::Expanded(path) }, kind })
    }
}

/// Numbers are whole where the expanded scenario has a whole one, or the scenario as written does
/// and nothing else is asked for.
fn kind(axis: &Axis, in_expanded: Option<&Value>, in_written: Option<&Value>) -> Kind {
    match (in_expanded, in_written) {
        _ if axis.has_words() => Kind::Word,
        (Some(value), _) if value.is_u64() && axis.is_whole() => Kind::Whole,
        (None, Some(value)) if value.is_u64() && axis.n_values().is_some() && axis.is_whole() => Kind::Whole,
        _ => Kind::Number,
    }
}

fn no_such(path: &str, scene: &Value) -> SweepError {
    let known = places(scene, "");
    let hint = nearest(path, known.iter().map(String::as_str)).map_or_else(String::new, |near| format!("; did you mean {near}?"));
    let rule = "must be a parameter of the scenario as written or as `cohaul scenario show` expands it";
    SweepError::axis(path, rule, format!("no such place{hint}"))
}

/// Paths of all values inside of the value at `path` that are no objects or lists.
fn places(value: &Value, path: &str) -> Vec<String> {
    match value {
        Value::Object(map) => map.iter().flat_map(|(key, inner)| places(inner, &join(path, key))).collect(),
        Value::Array(list) => list.iter().enumerate().flat_map(|(at, inner)| places(inner, &format!("{path}[{at}]"))).collect(),
        _ => vec![path.to_owned()],
    }
}

fn expanded(scenario: &Scenario) -> Value {
    serde_json::to_value(scenario.expanded()).expect("a scenario is plain data")
}

fn positive(path: &str, value: &Value) -> Result<f64, SweepError> {
    value.as_f64().filter(|value| *value > 0.0).ok_or_else(|| SweepError::axis(path, "must be a positive number", value))
}

/// Value that a parameter has in the scenario in `text`, whose file errors call `file`; 1 for a
/// factor.
///
/// # Errors
/// When the scenario breaks a rule, or has no such parameter, or it is not a positive number.
pub fn present_value(text: &str, file: &str, path: &str) -> Result<f64, SweepError> {
    if Factor::named(path).is_some() {
        return Ok(1.0);
    }
    let (template, place) = (Template::new(text, file, &[])?, Path::parse(path)?);
    let expanded = expanded(&template.base);
    let value = place.first(&template.written).or_else(|| place.first(&expanded)).ok_or_else(|| no_such(path, &expanded))?;
    positive(path, value)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = include_str!("../../../../scenarios/paper/four-ants-four-springs.json");

    fn scenario(specs: &[&str]) -> Result<Scenario, SweepError> {
        let axes: Vec<Axis> = specs.iter().map(|spec| spec.parse().unwrap()).collect();
        let values: Vec<Value> = axes.iter().map(|axis| axis.value(0)).collect();
        Template::new(SCENE, "four.json", &axes)?.scenario(&values)
    }

    /// What is left out in the file follows the mass; what is scaled as inertia alone leaves the
    /// ground as it is.
    #[test]
    fn normal_loads_follow_the_mass_and_not_the_inertia() {
        let base = scenario(&[]).unwrap().system;
        let heavy = scenario(&["load.mass_kg=0.0032"]).unwrap().system;
        assert_eq!(heavy.total_slip_limit() / base.total_slip_limit(), 2.0);
        assert_eq!(heavy.load.inertia / base.load.inertia, 2.0);
        let inert = scenario(&["inertia_scale=2"]).unwrap().system;
        assert_eq!((inert.load.mass, inert.load.inertia), (heavy.load.mass, heavy.load.inertia));
        assert_eq!(inert.ground, base.ground);
    }

    /// Other parameters come first: the size multiplies a mass that is varied too.
    #[test]
    fn factors_multiply_the_scene_that_the_other_values_make() {
        let given = scenario(&[]).unwrap();
        let faster = scenario(&["speed=2"]).unwrap();
        assert_eq!((faster.duration, faster.drive_speed()), (given.duration / 2.0, 2.0 * given.drive_speed()));
        assert_eq!(scenario(&["inertia=2"]).unwrap(), scenario(&["inertia_scale=2"]).unwrap());
        let larger = scenario(&["size=2", "load.mass_kg=0.0032"]).unwrap();
        assert_eq!(larger.system.total_slip_limit() / given.system.total_slip_limit(), 16.0);
        assert_eq!(larger.drive_speed(), given.drive_speed());
        assert_eq!(scenario(&["size=2", "speed=4", "inertia=0.5"]).unwrap(), scenario(&["inertia=0.5", "speed=4", "size=2"]).unwrap());
    }

    #[test]
    fn defaults_short_forms_and_every_spring_can_be_varied() {
        let four = scenario(&["drive.pull_speed_m_per_s=0.05", "springs[0].ring.n=3", "ground.gravity_m_per_s2=1.62"]).unwrap();
        let cohaul::scenario::Drive::Ants(ants) = &four.drive else { panic!("ants") };
        assert_eq!((ants.pull_speed, four.system.springs.len()), (0.05, 3));
        let damped = scenario(&["springs.*.damping_ratio=0.5"]).unwrap();
        assert!(damped.system.springs.iter().all(|spring| spring.damping_ratio == 0.5) && damped.system.springs.len() == 4);
        let one = scenario(&["springs[2].damping_ratio=0.5"]).unwrap();
        assert_eq!(one.system.springs.iter().filter(|spring| spring.damping_ratio == 0.5).count(), 1);
        let paced = scenario(&["drive.preset=literal-newtons", "drive.n_ants=2"]).unwrap();
        assert_ne!(paced.drive, four.drive);
    }

    #[test]
    fn what_is_not_there_or_breaks_a_rule_names_path_and_rule() {
        for (specs, why) in [
            (&["load.mas_kg=1"][..], "load.mas_kg: must be a parameter of the scenario as written or as `cohaul scenario show` expands it"),
            (&["springs[4].damping_ratio=1"], "springs[4].damping_ratio: must be a parameter"),
            (&["load.mass_kg=-1"], "with load.mass_kg = -1: four.json: load.mass_kg: must be positive, found -1"),
            (&["drive.n_ants=2.5"], "drive.n_ants: must be a whole number"),
            (&["springs.*.damping_ratio=-1"], "damping_ratio: must not be negative, found -1"),
            (&["speed=0"], "speed: must be a positive number, found 0"),
            (&["size=1e-300"], "with size = 1e-300: four.json: "),
            (&["springs[0].ring.n=2", "springs[3].damping_ratio=0.1"], "springs[3].damping_ratio: must be a parameter"),
        ] {
            let error = scenario(specs).unwrap_err().to_string();
            assert!(error.contains(why), "{error}");
        }
    }
}
