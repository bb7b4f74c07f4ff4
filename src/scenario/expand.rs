//! The expanded file of a scenario: every default is written out, every short form is replaced.
//! Equal scenarios have the same expanded file, and so the same hash.

use std::fmt::Write;

use sha2::{Digest, Sha256};

use super::format::{
    AntsEntry, AntsKind, DriveEntry, GroundEntry, LoadEntry, PathEntry, ScenarioFile, SpringEntry, SpringsEntry, SupportEntry,
    SupportsEntry, TipsEntry, TipsKind,
};
use super::json::plain;
use super::{AntDrive, Drive, Scenario, TipPath};
use crate::math::Vec2;
use crate::model::Ground;

impl Scenario {
    /// The file that states the whole scenario without defaults. It reads as an equal scenario. It
    /// has no gravity, which only replaces missing normal loads.
    pub fn expanded(&self) -> ScenarioFile {
        ScenarioFile {
            schema: None,
            name: self.name.clone(),
            duration_s: plain(self.duration),
            control_period_s: plain(self.control_period),
            seed: self.seed,
            load: self.load_entry(),
            ground: ground_entry(&self.system.ground),
            springs: self.system.springs.iter().map(|spring| SpringsEntry::One(SpringEntry::of(spring))).collect(),
            drive: match &self.drive {
                Drive::Tips(paths) => DriveEntry::Tips(TipsEntry { kind: TipsKind::Tips, paths: paths.iter().map(path_entry).collect() }),
                Drive::Ants(ants) => DriveEntry::Ants(Box::new(ants_entry(ants))),
            },
        }
    }

    /// SHA-256 of the expanded file in hexadecimal. Equal scenarios have the same hash, however
    /// they are written.
    pub fn hash(&self) -> String {
        let text = serde_json::to_string(&self.expanded()).expect("the format is plain data");
        Sha256::digest(text).iter().fold(String::new(), |mut hex, byte| {
            write!(hex, "{byte:02x}").expect("a string takes all text");
            hex
        })
    }

    fn load_entry(&self) -> LoadEntry {
        let (load, start) = (&self.system.load, &self.start);
        LoadEntry {
            mass_kg: plain(load.mass),
            inertia_kg_m2: Some(plain(load.inertia)),
            radius_m: plain(load.radius),
            position_m: pair(&start.pose.position),
            heading_rad: plain(start.pose.heading),
            velocity_m_per_s: pair(&start.twist.linear),
            turn_rate_rad_per_s: plain(start.twist.angular),
        }
    }
}

fn ground_entry(ground: &Ground) -> GroundEntry {
    let supports = ground
        .supports
        .iter()
        .map(|support| SupportEntry { offset_m: pair(&support.offset), normal_load_n: Some(plain(support.normal_load)) });
    GroundEntry {
        friction_coefficient: plain(ground.friction_coefficient),
        gravity_m_per_s2: None,
        supports: SupportsEntry::List(supports.collect()),
    }
}

fn path_entry(path: &TipPath) -> PathEntry {
    let waypoints = path.waypoints.iter().map(|point| [point.time, point.position.x, point.position.y].map(plain));
    PathEntry { spring: path.spring, waypoints: waypoints.collect(), release_s: path.release.map(plain) }
}

fn ants_entry(ants: &AntDrive) -> AntsEntry {
    let some = |value: f64| Some(plain(value));
    AntsEntry {
        kind: AntsKind::Ants,
        n_ants: ants.n_ants,
        preset: None,
        nest_position_m: Some(pair(&ants.nest_position)),
        arrival_radius_m: some(ants.arrival_radius),
        start_half_width_m: some(ants.start_half_width),
        search_speed_m_per_s: some(ants.search_speed),
        pull_speed_m_per_s: some(ants.pull_speed),
        sensing_range_m: some(ants.sensing_range),
        target_variance_m2: some(ants.target_variance),
        target_redraw_period_s: some(ants.target_redraw_period),
        steering_gain_per_s: some(ants.steering_gain),
        steering_half_angle_rad: some(ants.steering_half_angle),
        control_offset_m: some(ants.control_offset),
        grasp_probability: some(ants.grasp_probability),
        grasp_decision_period_s: some(ants.grasp_decision_period),
        grasp_pace: Some(ants.grasp_pace),
        strong_pull_n: some(ants.release.strong_pull),
        release_steepness_per_n: some(ants.release.steepness),
        release_decision_period_s: some(ants.release.period),
        release_pace: Some(ants.release_pace),
    }
}

fn pair(vector: &Vec2) -> [f64; 2] {
    [plain(vector.x), plain(vector.y)]
}
