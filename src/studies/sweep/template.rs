//! Makes the scenario of a point of the design.
//!
//! A parameter is set in the scenario as written where that has a place for it. Defaults then
//! follow: normal loads and the moment of inertia follow the mass. Otherwise it is set in the
//! expanded scenario, where nothing follows. Every scenario is validated as a whole.

use serde_json::Value;

use super::axis::{Axis, INERTIA};
use super::column::Column;
use super::error::SweepError;
use super::path::Path;
use crate::output::table::Kind;
use crate::scenario::Scenario;
use crate::scenario::json::without_mark;

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
    /// Mass and moment of inertia at the same normal loads.
    Inertia,
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
        let scenario = self.parsed(&written, values)?;
        if pairs().all(|(place, _)| matches!(place.target, Target::Written(_))) {
            return Ok(scenario);
        }
        let mut expanded = expanded(&scenario);
        for (place, value) in pairs() {
            match &place.target {
                Target::Written(_) => {}
                Target::Expanded(path) => self.set(path, &mut expanded, place, value)?,
                Target::Inertia => scale_inertia(&mut expanded, value)?,
            }
        }
        self.parsed(&expanded, values)
    }

    fn parsed(&self, scene: &Value, values: &[Value]) -> Result<Scenario, SweepError> {
        Scenario::parse(&scene.to_string(), &self.file).map_err(|source| SweepError::Point { values: self.described(values), source })
    }

    fn set(&self, path: &Path, scene: &mut Value, place: &Place, value: &Value) -> Result<(), SweepError> {
        // Another parameter may have removed the place, as fewer springs do.
        if path.set(scene, value) { Ok(()) } else { Err(no_such(&place.name)) }
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
        if axis.path == INERTIA {
            return Ok(Place { name, target: Target::Inertia, kind: Kind::Number });
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
            None => return Err(no_such(&axis.path)),
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

fn no_such(path: &str) -> SweepError {
    SweepError::axis(path, "must be a parameter of the scenario as written or as `cohaul scenario show` expands it", "no such place")
}

fn expanded(scenario: &Scenario) -> Value {
    serde_json::to_value(scenario.expanded()).expect("a scenario is plain data")
}

/// Normal loads are written out in an expanded scenario, and stay. So do the dashpots, whose
/// damping ratios are those of the mass.
fn scale_inertia(expanded: &mut Value, scale: &Value) -> Result<(), SweepError> {
    let refused = || SweepError::axis(INERTIA, "must be a positive number", scale);
    let scale = scale.as_f64().filter(|scale| *scale > 0.0).ok_or_else(refused)?;
    for key in ["mass_kg", "inertia_kg_m2"] {
        let value = &mut expanded["load"][key];
        *value = Value::from(scale * value.as_f64().expect("an expanded load has both"));
    }
    for spring in expanded["springs"].as_array_mut().into_iter().flatten() {
        let ratio = spring["damping_ratio"].as_f64().filter(|ratio| *ratio > 0.0);
        ratio.into_iter().for_each(|ratio| spring["damping_ratio"] = Value::from(ratio / scale.sqrt()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = include_str!("../../../scenarios/paper/four-ants-four-springs.json");

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

    #[test]
    fn defaults_short_forms_and_every_spring_can_be_varied() {
        let four = scenario(&["drive.pull_speed_m_per_s=0.05", "springs[0].ring.n=3", "ground.gravity_m_per_s2=1.62"]).unwrap();
        let crate::scenario::Drive::Ants(ants) = &four.drive else { panic!("ants") };
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
            (&["springs[0].ring.n=2", "springs[3].damping_ratio=0.1"], "springs[3].damping_ratio: must be a parameter"),
        ] {
            let error = scenario(specs).unwrap_err().to_string();
            assert!(error.contains(why), "{error}");
        }
    }
}
