//! The scene of a measured run: the user's scene with the start of the load and the paths of what
//! moves it as they were recorded.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::recording::{MeasuredRun, Track};
use super::smoothing::{Smoothed, pose_at, smoothed, usual_bound};
use crate::sweep::Place;
use cohaul::math::{Pose, Vec2};
use cohaul::model::geometry::way_out;
use cohaul::scenario::json::without_mark;
use cohaul::scenario::{Drive, Scenario, ScenarioError};

/// How a recording becomes scenes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Preparation {
    pub start: Start,
    /// Largest deviation of a smooth path from a recorded place (m). `None` is what each track
    /// suggests by its rounding and noise.
    pub bound_m: Option<f64>,
    /// Largest displacement of an obstacle that overlaps the load at the start (m).
    pub largest_shift_m: f64,
    /// Longest time without a place of an obstacle or tip that is bridged (s). `None` is ten times
    /// the median between two rows.
    pub longest_gap_s: Option<f64>,
}

/// What happens to an obstacle that overlaps the load at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// Its path is moved out along the normal, until it touches the load.
    Touching,
    /// The run is left out.
    Recorded,
}

/// Displacement at the start over the load's radius that is usual (1). Cameras and robots agree to
/// a millimetre or two.
pub const USUAL_SHIFT: f64 = 0.02;
/// Bridged gap over the median time between two rows (1).
const USUAL_GAP: f64 = 10.0;

/// A scene, for runs with other starts and paths.
#[derive(Clone, Debug)]
pub struct SceneTemplate {
    file: String,
    written: Value,
    pub base: Scenario,
}

/// A value for a number of the scene, at all its places.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    pub places: Vec<Place>,
    pub value: f64,
}

/// The scene of a measured run.
#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    pub scenario: Scenario,
    /// Time in the recording at which the scene begins (s).
    pub begins_at: f64,
    /// Largest displacement of an obstacle to where it touches the load (m).
    pub shift_m: f64,
    /// Largest bound of a smooth path (m).
    pub bound_m: f64,
    /// Largest deviation of a smooth path from a recorded place (m).
    pub deviation_m: f64,
    /// Number of waypoints of all paths (1).
    pub n_waypoints: usize,
    /// Longest gap that was bridged (s).
    pub longest_gap_s: f64,
}

/// What is remembered of all paths of a run.
#[derive(Default)]
struct Paths {
    bound: f64,
    deviation: f64,
    n_waypoints: usize,
    gap: f64,
}

impl SceneTemplate {
    /// # Errors
    /// When the text is no scenario, or has ants.
    pub fn new(text: &str, file: &str) -> Result<Self, ScenarioError> {
        let base = Scenario::parse(text, file)?;
        if let Drive::Ants(_) = base.drive {
            let finding = cohaul::scenario::Finding {
                path: "drive.kind".into(),
                rule: "must be \"tips\" for measured runs: ants decide for themselves".into(),
                found: "\"ants\"".into(),
            };
            return Err(ScenarioError::Invalid { file: file.to_owned(), findings: vec![finding] });
        }
        let written = serde_json::from_str(without_mark(text)).expect("a scenario is JSON");
        Ok(Self { file: file.to_owned(), written, base })
    }

    /// Names of the obstacles.
    pub fn obstacles(&self) -> Vec<String> {
        self.base.system.world.obstacles.iter().map(|obstacle| obstacle.name.clone()).collect()
    }

    pub fn written(&self) -> &Value {
        &self.written
    }

    /// The scene with some numbers changed.
    ///
    /// # Errors
    /// When it breaks a rule, or has no such place.
    pub fn changed(&self, changes: &[Change]) -> Result<Self, String> {
        let mut written = self.written.clone();
        for Change { places, value } in changes {
            for place in places {
                if !place.set(&mut written, &json!(value)) {
                    return Err(format!("{}: has no place {place:?}", self.file));
                }
            }
        }
        Self::new(&written.to_string(), &self.file).map_err(|error| error.to_string())
    }

    /// The scene of a run. Bounds of smooth paths are multiplied by `factor` (1).
    ///
    /// # Errors
    /// Why the run has no scene, in words.
    pub fn of_run(&self, run: &MeasuredRun, preparation: &Preparation, factor: f64) -> Result<Prepared, String> {
        let [(begins_at, start), .., (ends_at, _)] = run.load.samples[..] else {
            return Err(format!("the load is seen {} times, and must be twice at least", run.load.samples.len()));
        };
        let (mut scene, mut all, mut shift_m) = (self.written.clone(), Paths::default(), 0.0_f64);
        scene["load"]["position_m"] = json!([start.position.x, start.position.y]);
        scene["load"]["heading_rad"] = json!(start.heading);
        let period = self.base.control_period;
        scene["duration_s"] = json!(period * ((ends_at - begins_at) / period - 1e-9).ceil().max(1.0));
        for (at, obstacle) in self.base.system.world.obstacles.iter().enumerate() {
            let Some((name, track)) = run.obstacles.iter().find(|(name, _)| *name == obstacle.name) else { continue };
            let path = all.path(name, track, [begins_at, ends_at], obstacle.outline.extent(), preparation, factor)?;
            let shift = match preparation.start {
                Start::Recorded => Vec2::zeros(),
                Start::Touching => {
                    let out = way_out(&self.base.system.world.outline, &start, &obstacle.outline, &pose_at(&path, 0.0));
                    out.ok_or_else(|| format!("{name} overlaps the load at the start, and no short displacement parts them"))?
                }
            };
            if shift.norm() > preparation.largest_shift_m {
                let [found, most] = [shift.norm(), preparation.largest_shift_m].map(|length| 1e3 * length);
                return Err(format!("{name} overlaps the load at the start by {found:.3} mm, more than {most:.3} mm"));
            }
            shift_m = shift_m.max(shift.norm());
            let waypoint = |(time, pose): &(f64, Pose)| json!([time, pose.position.x + shift.x, pose.position.y + shift.y, pose.heading]);
            let entry = scene["obstacles"][at].as_object_mut().expect("an obstacle is an object");
            entry.retain(|key, _| !["position_m", "heading_rad", "path"].contains(&key.as_str()));
            entry.insert("path".into(), json!({ "waypoints": path.iter().map(waypoint).collect::<Vec<_>>() }));
        }
        for (spring, track) in &run.tips {
            let path = all.path(&format!("tip {spring}"), track, [begins_at, ends_at], 0.0, preparation, factor)?;
            let waypoints: Vec<Value> = path.iter().map(|(time, pose)| json!([time, pose.position.x, pose.position.y])).collect();
            let paths = scene["drive"]["paths"].as_array_mut().expect("tips have paths");
            paths.retain(|path| path["spring"] != json!(spring));
            paths.push(json!({ "spring": spring, "waypoints": waypoints }));
        }
        let scenario = Scenario::parse(&scene.to_string(), &self.file).map_err(|error| error.to_string())?;
        let Paths { bound: bound_m, deviation: deviation_m, n_waypoints, gap: longest_gap_s } = all;
        Ok(Prepared { scenario, begins_at, shift_m, bound_m, deviation_m, n_waypoints, longest_gap_s })
    }
}

impl Paths {
    /// The smooth path of a track over the times of a run, which begins at zero.
    ///
    /// # Errors
    /// When the track has a gap that is too long.
    fn path(
        &mut self,
        name: &str,
        track: &Track,
        [begins_at, ends_at]: [f64; 2],
        extent: f64,
        preparation: &Preparation,
        factor: f64,
    ) -> Result<Vec<(f64, Pose)>, String> {
        let within: Vec<(f64, Pose)> = track.samples.iter().filter(|(time, _)| (begins_at..=ends_at).contains(time)).copied().collect();
        let samples: Vec<(f64, Pose)> = within.iter().map(|(time, pose)| (time - begins_at, *pose)).collect();
        let (Some((first, _)), Some((last, _))) = (samples.first(), samples.last()) else {
            return Err(format!("{name} is not seen while the load is"));
        };
        let longest = preparation.longest_gap_s.unwrap_or_else(|| USUAL_GAP * median_interval(&samples));
        let gap = Track { samples: samples.clone() }.longest_gap().max(*first).max(ends_at - begins_at - last);
        if gap > longest && samples.len() > 1 {
            return Err(format!("{name} is lost for {gap:.3} s, more than {longest:.3} s"));
        }
        let bound = factor * preparation.bound_m.unwrap_or_else(|| usual_bound(&samples, extent));
        let Smoothed { waypoints, deviation } = smoothed(&samples, bound, extent);
        self.bound = self.bound.max(bound);
        self.deviation = self.deviation.max(deviation);
        self.n_waypoints += waypoints.len();
        self.gap = self.gap.max(gap);
        Ok(waypoints)
    }
}

fn median_interval(samples: &[(f64, Pose)]) -> f64 {
    let mut intervals: Vec<f64> = samples.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    intervals.sort_by(f64::total_cmp);
    intervals.get(intervals.len() / 2).copied().unwrap_or(f64::INFINITY)
}
