//! Tables of tips that the program generates with known behaviour, as a camera would record them.

use std::fmt::Write;

use cohaul::backend::{BackendKind, BackendOptions};
use cohaul::math::{RandomStreams, Stream};
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{EventKind, Keep, Simulation, Trace};
use cohaul_paper::calibrate::behaviour::{Attachments, attachments};
use cohaul_paper::calibrate::{Recording, Sensor};
use cohaul_report::tips_csv::write_tips;
use serde_json::json;

/// What the ants of one data set do.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    pub seed: u64,
    /// Time of the recording (s).
    pub duration: f64,
    /// zeta (1/N), F_m (N) and D_r (s).
    pub steepness: f64,
    pub strong_pull: f64,
    pub period: f64,
    /// k (1/s), beta (rad) and v (m/s).
    pub gain: f64,
    pub half_angle: f64,
    pub speed: f64,
}

pub const NAMES: [&str; 6] = ["zeta", "F_m", "D_r", "k", "beta", "v"];

impl Truth {
    /// The parameters in the order of [`NAMES`].
    pub fn values(&self) -> [f64; 6] {
        [self.steepness, self.strong_pull, self.period, self.gain, self.half_angle, self.speed]
    }

    /// Other parameters for each seed, uniform or uniform in their logarithm. The ranges hold the
    /// paper's values; the speed is such that pulls reach F_m before most ants let go.
    pub fn random(seed: u64) -> Self {
        let streams = RandomStreams::new(seed);
        let between = |k: u64, low: f64, high: f64| low + (high - low) * streams.uniform(Stream::Scene, 7, k);
        let log_between = |k: u64, low: f64, high: f64| between(k, low.ln(), high.ln()).exp();
        Self {
            seed,
            duration: 60.0,
            steepness: log_between(0, 80.0, 1000.0),
            strong_pull: between(1, 0.012, 0.026),
            period: log_between(2, 0.08, 0.3),
            gain: log_between(3, 4.0, 16.0),
            half_angle: between(4, 0.3, 1.1),
            speed: between(5, 0.03, 0.07),
        }
    }

    /// Four ants at four springs whose nest is too far away to arrive.
    pub fn scenario(&self, pace: &str) -> Scenario {
        self.scenario_to(NEST, pace)
    }

    /// Four ants at four springs with the nest at this place (m).
    fn scenario_to(&self, nest: [f64; 2], pace: &str) -> Scenario {
        let text = include_str!("../../../scenarios/paper/four-ants-four-springs.json");
        let mut scene: serde_json::Value = serde_json::from_str(text).unwrap();
        scene["duration_s"] = json!(self.duration);
        scene["seed"] = json!(self.seed);
        scene["drive"] = json!({
            "kind": "ants",
            "n_ants": 4,
            "nest_position_m": nest,
            "release_pace": pace,
            "release_steepness_per_n": self.steepness,
            "strong_pull_n": self.strong_pull,
            "release_decision_period_s": self.period,
            "steering_gain_per_s": self.gain,
            "steering_half_angle_rad": self.half_angle,
            "pull_speed_m_per_s": self.speed
        });
        Scenario::parse(&scene.to_string(), "observed").unwrap()
    }

    pub fn run(&self, pace: &str) -> Observed {
        self.observed(self.scenario(pace))
    }

    fn observed(&self, scenario: Scenario) -> Observed {
        assert!(matches!(scenario.drive, Drive::Ants(_)));
        let mut run = Simulation::new(&scenario, &BackendOptions::new(BackendKind::QuasiStatic, scenario.control_period), Keep::Trace);
        run.run(|_| true);
        Observed { seed: self.seed, trace: run.into_results().0, scenario }
    }
}

/// The ants of `data/colony-tips.csv`: none of their values is that of the paper.
const COLONY: Truth =
    Truth { seed: 2010, duration: 30.0, steepness: 300.0, strong_pull: 0.018, period: 0.15, gain: 8.0, half_angle: 0.9, speed: 0.03 };

/// Comment at the top of `data/colony-tips.csv`.
pub const COLONY_COMMENT: &str =
    "# Generated, not measured: four ants on four springs for 30 s, seen 40 times a second with 0.1 mm of noise.
# Their truth: zeta 300 1/N, F_m 18 mN, D_r 0.15 s, k 8 1/s, beta 0.9 rad, pull speed 30 mm/s.
# cargo run --example generate_colony prints this file.
";

/// The rows of `data/colony-tips.csv`, to 10 micrometres and 10 microradians.
pub fn colony() -> String {
    const TENTH_OF_A_MM: f64 = 1e-4;
    let table = COLONY.observed(COLONY.scenario_to([0.2, -0.17], "hazard")).camera(10, TENTH_OF_A_MM);
    let short = |(at, field): (usize, &str)| match field.parse::<f64>() {
        Ok(number) if at != 1 => format!("{:.5}", number + 0.0).trim_end_matches('0').trim_end_matches('.').to_owned(),
        _ => field.to_owned(),
    };
    let line = |line: &str| line.split(',').enumerate().map(short).collect::<Vec<_>>().join(",") + "\n";
    table.lines().map(line).collect()
}

/// Position of the nest (m).
pub const NEST: [f64; 2] = [2.0, -1.7];

/// A run, and what can be seen of it.
pub struct Observed {
    seed: u64,
    trace: Trace,
    scenario: Scenario,
}

impl Observed {
    /// The table that the run writes: exact tips at every tick.
    pub fn exact(&self) -> String {
        let mut table = Vec::new();
        write_tips(&self.trace, &mut table).unwrap();
        String::from_utf8(table).unwrap()
    }

    /// The table of a camera that sees every `n`th tick, with `noise` on either axis of a tip (m).
    /// A release stands at the first frame after it, where the tip was last seen.
    pub fn camera(&self, n: usize, noise: f64) -> String {
        let streams = RandomStreams::new(self.seed + 1_000_000);
        let mut table = String::from("time_s,spring,x_m,y_m,heading_rad,tip_x_m,tip_y_m,event\n");
        let n_springs = self.scenario.system.springs.len();
        let mut last: Vec<Option<String>> = vec![None; n_springs];
        let mut events = self.trace.events.iter().peekable();
        for (at, row) in self.trace.rows.iter().enumerate().step_by(n) {
            let pose = &row.motion.pose;
            while let Some(event) = events.next_if(|event| event.time <= row.time) {
                // An attachment between two frames was never seen.
                if let (EventKind::Release, Some(seen)) = (event.kind, last[event.spring].take()) {
                    writeln!(table, "{},{},{seen},release", row.time, event.spring).unwrap();
                }
            }
            for tip in &row.tips {
                let error = noise * streams.normal_pair(Stream::Target, tip.spring as u32, at as u64);
                let place = tip.position + error;
                let seen = format!("{},{},{},{},{}", pose.position.x, pose.position.y, pose.heading, place.x, place.y);
                writeln!(table, "{},{},{seen},", row.time, tip.spring).unwrap();
                last[tip.spring] = Some(seen);
            }
        }
        table
    }

    pub fn sensor(&self) -> Sensor {
        Sensor::exact(self.scenario.system.springs.clone())
    }

    /// Attachments of a table of this run.
    pub fn attachments(&self, table: &str) -> Attachments {
        let sensor = self.sensor();
        let (recording, releases) = Recording::with_releases(table, "observed", Some(sensor.springs.len()), 0.0263).unwrap();
        attachments(&recording, releases.as_deref(), &sensor)
    }

    /// Number of attachments that ended with a release.
    pub fn n_releases(&self) -> usize {
        self.trace.events.iter().filter(|event| event.kind == EventKind::Release).count()
    }
}
