//! No number of an answer is NaN or infinite, whatever the damping, stiffness and speed.

use cohaul::analysis::compare::{Settings, ThreeWay};
use cohaul::backend::{BackendKind, BackendOptions};
use cohaul::math::{RandomStreams, Stream};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Simulation, backend_of};
use cohaul_report::json;
use cohaul_report::text::Detail;
use cohaul_studies::compare::comparison::{Comparison, Tiers};
use cohaul_studies::compare::text::text;
use rayon::prelude::*;
use serde_json::json;

/// One link of a load to a tip, and a second one that is released.
struct Link {
    mass: f64,
    stiffness: f64,
    damping_ratio: f64,
    /// Speed of the tip (m/s).
    speed: f64,
    /// Start speed of the load (m/s).
    start: f64,
    duration: f64,
    friction_coefficient: f64,
}

impl Link {
    /// The load is pulled along x until 0.8 of the duration. The second link is released before.
    fn scene(&self) -> Scenario {
        let period = self.duration / 10.0;
        let spring = json!({
            "root_m": [0.0, 0.01], "bearing_rad": 0.0, "rest_length_m": 0.05, "radial_stiffness_n_per_m": self.stiffness,
            "torsional_stiffness_nm_per_rad": 1e-3 * self.stiffness, "damping_ratio": self.damping_ratio
        });
        let path = |spring: usize, share: f64| json!({ "spring": spring, "waypoints": [[0.0, 0.05, 0.01], [share * self.duration, 0.05 + share * self.speed * self.duration, 0.01]] });
        let mut released = path(1, 0.6);
        released["release_s"] = json!(0.55 * self.duration);
        let file = json!({
            "name": "links", "duration_s": self.duration, "control_period_s": period,
            "load": { "mass_kg": self.mass, "radius_m": 0.1, "velocity_m_per_s": [0.0, self.start] },
            "ground": { "friction_coefficient": self.friction_coefficient, "supports": { "tripod": { "radius_m": 0.06 } } },
            "springs": [spring, spring],
            "drive": { "kind": "tips", "paths": [path(0, 0.8), released] }
        });
        Scenario::parse(&file.to_string(), "links").unwrap()
    }

    /// The link of a number: logarithmic in mass, stiffness, damping and speed, over decades beyond
    /// every device. The scene takes up to 30 rad of the oscillation.
    fn random(number: u64) -> Self {
        let uniform = |at: u64| RandomStreams::new(number).uniform(Stream::Scene, 0, at);
        let between = |at: u64, low: f64, high: f64| low * (high / low).powf(uniform(at));
        let (mass, stiffness) = (between(0, 1e-5, 1e2), between(1, 1e-2, 1e8));
        let rate = (stiffness / mass).sqrt();
        Self {
            mass,
            stiffness,
            damping_ratio: if uniform(2) < 0.1 { 0.0 } else { between(3, 1e-3, 1e4) },
            speed: if uniform(4) < 0.1 { 0.0 } else { between(5, 1e-9, 1e2) },
            start: if uniform(6) < 0.7 { 0.0 } else { between(7, 1e-6, 1e2) },
            duration: (between(8, 1e-2, 30.0) / rate).clamp(1e-6, 10.0),
            friction_coefficient: if uniform(9) < 0.1 { 0.0 } else { between(10, 1e-3, 10.0) },
        }
    }
}

/// Compares on the backends, runs each of them, and checks every number and every word.
fn check(scenario: &Scenario, settings: &Settings, name: &str) {
    let found = ThreeWay::new(scenario, settings).prescribed(|_| true).unwrap();
    let comparison = Comparison::new(scenario, settings, Tiers { prescribed: Some(found), ..Tiers::default() }, 0.0);
    json::check(&comparison).unwrap_or_else(|error| panic!("{name}: {error}"));
    for detail in [Detail::Brief, Detail::Full] {
        let text = text(&comparison, detail);
        assert!(
            !text.contains("NaN") && !text.split_whitespace().any(|word| word.trim_matches(['(', ',', ')', '-']) == "inf"),
            "{name}: {text}"
        );
    }
    for kind in BackendKind::ALL {
        let options = BackendOptions::new(kind, scenario.control_period);
        let mut run = Simulation::from_parts(
            scenario,
            &options,
            Keep::Trace,
            cohaul::simulation::controller_of(scenario),
            backend_of(scenario, &options),
        );
        run.run(|_| true);
        json::check(run.trace()).unwrap_or_else(|error| panic!("{name}: {kind:?}: {error}"));
    }
}

/// Links of robots that are almost rigid and overdamped: at 1e5 N/m, cosh of a damped phase leaves
/// the range of numbers after 0.1 s.
#[test]
fn rigid_overdamped_links_have_finite_answers() {
    [0.1, 0.999_999, 1.0, 1.5, 3.0, 10.0, 20.0].into_par_iter().for_each(|damping_ratio| {
        let link = Link { mass: 2.0, stiffness: 1e5, damping_ratio, speed: 0.05, start: 0.0, duration: 1.0, friction_coefficient: 0.4 };
        check(&link.scene(), &Settings { step_s: Some(1e-3), ..Settings::default() }, &format!("damping ratio {damping_ratio}"));
    });
}

fn search(numbers: std::ops::Range<u64>) {
    numbers.into_par_iter().for_each(|number| {
        let link = Link::random(number);
        let step = if number % 2 == 0 { None } else { Some(link.duration / 10.0) };
        check(&link.scene(), &Settings { step_s: step, ..Settings::default() }, &format!("link {number}"));
    });
}

#[test]
fn random_links_have_finite_answers() {
    search(0..300);
}

/// As above, on more links.
#[test]
#[ignore = "sixty times as many links as random_links_have_finite_answers, which runs always"]
fn many_random_links_have_finite_answers() {
    search(300..20_000);
}
