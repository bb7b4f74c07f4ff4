//! A first scene from a few numbers: robots that tow a box or a disc, each on its own spring.
//!
//! The roots are on the front of the load, and all tips move along x at the same speed. What the
//! numbers leave open follows from them: the springs together are stretched by a fifth of the
//! load's radius when the load begins to slip, and the load is towed by four radii.

use std::f64::consts::FRAC_PI_3;
use std::str::FromStr;

use cohaul::formats::SCENARIO;
use cohaul::math::{Vec2, direction};
use cohaul::scenario::format::{
    DiscEntry, DriveEntry, GroundEntry, LoadEntry, OutlineEntry, PathEntry, RectangleEntry, STANDARD_GRAVITY, ScenarioFile, SpringEntry,
    SpringsEntry, SupportsEntry, TipsEntry, TipsKind, UniformSupports, UniformSupportsForm,
};
use cohaul_report::json::{NotFinite, pretty};

/// The numbers of a first scene.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstScene {
    pub name: Option<String>,
    /// Number of robots (1).
    pub n_robots: usize,
    pub shape: Shape,
    /// Mass of the load (kg).
    pub mass: f64,
    /// Coefficient of friction (1).
    pub friction: f64,
    /// Speed of the robots (m/s).
    pub speed: f64,
}

/// Outline of the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Length along x and width along y (m).
    Box([f64; 2]),
    /// Diameter (m).
    Disc(f64),
}

/// Most robots of a first scene (1).
pub const MOST_ROBOTS: usize = 100;
/// Stretch of the springs at the slip limit over the load's radius (1).
const STRETCH: f64 = 0.2;
/// Rest length of the springs over the load's radius (1).
const REST_LENGTH: f64 = 1.0;
/// Stiffness across a spring over that along it (1).
const ACROSS: f64 = 0.05;
/// Damping ratio of the springs (1).
const DAMPING: f64 = 0.3;
/// Distance of the tow over the load's radius (1).
const DISTANCE: f64 = 4.0;
/// Duration of the run over that of the tow (1).
const DURATION: f64 = 1.25;
/// Control periods in the tow (1), and the longest control period (s).
const PERIODS: f64 = 400.0;
const LONGEST_PERIOD: f64 = 0.01;
/// Least rate of the load on its springs, which counts where friction is weak (rad/s).
const LEAST_RATE: f64 = 6.0;

impl FirstScene {
    /// The scene as a file, whose schema is at this place.
    pub fn file(&self, schema: &str) -> ScenarioFile {
        let radius = self.shape.radius();
        let duration = rounded(DISTANCE * radius / self.speed);
        let springs = self.springs();
        let start = |spring: &SpringEntry| Vec2::from(spring.root_m) + spring.rest_length_m * direction(spring.bearing_rad);
        let waypoint = |time: f64, tip: Vec2| [time, tip.x, tip.y].map(rounded);
        let path = |(index, spring): (usize, &SpringEntry)| {
            let (from, by) = (start(spring), Vec2::new(self.speed * duration, 0.0));
            PathEntry { spring: index, waypoints: vec![waypoint(0.0, from), waypoint(duration, from + by)], release_s: None }
        };
        ScenarioFile {
            schema: Some(schema.to_owned()),
            format: Some(SCENARIO.version),
            name: self.name.clone().unwrap_or_else(|| self.usual_name()),
            duration_s: rounded(DURATION * duration),
            control_period_s: round_down(duration / PERIODS).min(LONGEST_PERIOD),
            seed: 1,
            load: LoadEntry { mass_kg: Some(self.mass), outline: Some(self.shape.outline()), ..LoadEntry::default() },
            ground: GroundEntry {
                friction_coefficient: self.friction,
                gravity_m_per_s2: None,
                supports: SupportsEntry::Uniform(UniformSupportsForm { uniform: UniformSupports { n: Some(16), tolerance: None } }),
            },
            drive: DriveEntry::Tips(TipsEntry { kind: TipsKind::Tips, paths: springs.iter().enumerate().map(path).collect() }),
            springs: springs.into_iter().map(SpringsEntry::One).collect(),
            obstacles: Vec::new(),
            side_friction_rule: Default::default(),
        }
    }

    fn usual_name(&self) -> String {
        let load = match self.shape {
            Shape::Box(_) => "box",
            Shape::Disc(_) => "disc",
        };
        let robots = if self.n_robots == 1 { "one robot".to_owned() } else { format!("{} robots", self.n_robots) };
        format!("a {load} of {} kg towed by {robots}", self.mass)
    }

    fn springs(&self) -> Vec<SpringEntry> {
        let (radius, n) = (self.shape.radius(), self.n_robots as f64);
        let stretched = self.friction * self.mass * STANDARD_GRAVITY / (STRETCH * radius);
        let stiffness = stretched.max(self.mass * LEAST_RATE * LEAST_RATE) / n;
        let rest_length = rounded(REST_LENGTH * radius);
        let equal = SpringEntry {
            rest_length_m: rest_length,
            radial_stiffness_n_per_m: rounded(stiffness),
            torsional_stiffness_nm_per_rad: rounded(ACROSS * stiffness * rest_length * rest_length),
            damping_ratio: DAMPING,
            ..SpringEntry::default()
        };
        let at = |(root, bearing): (Vec2, f64)| SpringEntry {
            root_m: [rounded(root.x), rounded(root.y)],
            bearing_rad: rounded(bearing),
            ..equal
        };
        self.roots().into_iter().map(at).collect()
    }

    /// Roots on the front of the load, and the directions of the springs there (m, rad).
    fn roots(&self) -> Vec<(Vec2, f64)> {
        // From -1 on the right to 1 on the left.
        let side = |at: usize| (2 * at + 1) as f64 / self.n_robots as f64 - 1.0;
        let root = |at: usize| match self.shape {
            Shape::Box([length, width]) => (Vec2::new(0.5 * length, 0.5 * width * side(at)), 0.0),
            Shape::Disc(diameter) => (0.5 * diameter * direction(FRAC_PI_3 * side(at)), FRAC_PI_3 * side(at)),
        };
        (0..self.n_robots).map(root).collect()
    }
}

impl Shape {
    /// Distance of the farthest point from the centre (m).
    fn radius(self) -> f64 {
        match self {
            Shape::Box([length, width]) => 0.5 * length.hypot(width),
            Shape::Disc(diameter) => 0.5 * diameter,
        }
    }

    fn outline(self) -> OutlineEntry {
        match self {
            Shape::Box(size_m) => OutlineEntry::Rectangle(RectangleEntry { size_m }),
            Shape::Disc(diameter) => OutlineEntry::Disc(DiscEntry { radius_m: 0.5 * diameter }),
        }
    }
}

/// The text of a scene, as people write it: a list of numbers stays on one line.
///
/// # Errors
/// When a number is not finite.
pub fn text_of(file: &ScenarioFile) -> Result<String, NotFinite> {
    let number = |line: &str| line.trim().trim_end_matches(',').parse::<f64>().is_ok();
    // Lines of a list that has only numbers so far.
    let (mut text, mut open): (String, Vec<String>) = (String::new(), Vec::new());
    for line in pretty(file)?.lines() {
        if open.len() > 1 && line.trim().starts_with(']') {
            let numbers: Vec<&str> = open[1..].iter().map(|line| line.trim()).collect();
            text += &format!("{}{}{}\n", open[0], numbers.join(" "), line.trim());
            open.clear();
        } else if !open.is_empty() && number(line) {
            open.push(line.to_owned());
        } else {
            open.drain(..).for_each(|line| text += &format!("{line}\n"));
            match line.ends_with('[') {
                true => open.push(line.to_owned()),
                false => text += &format!("{line}\n"),
            }
        }
    }
    Ok(text)
}

/// The number with six significant digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse::<f64>().expect("it is a number") + 0.0
}

/// The next smaller number that is 1, 2 or 5 times a power of ten.
fn round_down(value: f64) -> f64 {
    let exponent = value.log10().floor() as i32;
    let lead = [5.0, 2.0, 1.0].into_iter().find(|lead| lead * 10f64.powi(exponent) <= value * (1.0 + 1e-9));
    format!("{}e{exponent}", lead.unwrap_or(1.0)).parse().expect("it is a number")
}

/// Lengths of a box in metres, as `0.4x0.3`, or one length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    pub length: f64,
    pub width: Option<f64>,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let one = |part: &str| {
            let value = part.trim().parse::<f64>().ok().filter(|value| value.is_finite() && *value > 0.0);
            value.ok_or_else(|| format!("must be a positive length in metres, or two as in 0.4x0.3, found {text:?}"))
        };
        match text.split_once(['x', 'X']) {
            Some((length, width)) => Ok(Self { length: one(length)?, width: Some(one(width)?) }),
            None => Ok(Self { length: one(text)?, width: None }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn periods_are_round_and_not_longer() {
        for (value, round) in [(0.0205, 0.02), (0.0199, 0.01), (0.0051, 0.005), (0.01, 0.01), (3e-4, 2e-4)] {
            assert_eq!(round_down(value), round);
        }
    }

    #[test]
    fn sizes_are_lengths_in_metres() {
        assert_eq!("0.4x0.3".parse(), Ok(Size { length: 0.4, width: Some(0.3) }));
        assert_eq!("0.4".parse(), Ok(Size { length: 0.4, width: None }));
        for wrong in ["", "0.4x", "0x1", "-1", "0.4x0.3x0.2", "nan", "40cm"] {
            assert!(wrong.parse::<Size>().unwrap_err().contains("as in 0.4x0.3"), "{wrong}");
        }
    }

    #[test]
    fn lists_of_numbers_stay_on_a_line() {
        let scene = FirstScene { name: None, n_robots: 2, shape: Shape::Box([0.4, 0.3]), mass: 2.0, friction: 0.5, speed: 0.1 };
        let file = scene.file("scenario.schema.json");
        let text = text_of(&file).unwrap();
        assert!(text.contains("\"size_m\": [0.4, 0.3]\n") && text.contains("        [0.0, 0.45, -0.075],\n"), "{text}");
        assert_eq!(serde_json::from_str::<ScenarioFile>(&text).unwrap(), file);
    }
}
