//! The expanded file of a scenario: every default is written out, every short form is replaced.
//! Equal scenarios have the same expanded file, and so the same hash.

use sha2::{Digest, Sha256};

use super::format::{
    AntsEntry, AntsKind, CompoundEntry, DiscEntry, DriveEntry, GroundEntry, LoadEntry, ObstacleEntry, ObstaclePathEntry, OutlineEntry,
    PartEntry, PathEntry, PolygonEntry, PolylineEntry, ScenarioFile, SpringEntry, SpringsEntry, SupportEntry, SupportsEntry, TipsEntry,
    TipsKind,
};
use super::json::plain;
use super::presets::{self, Preset};
use super::{AntDrive, Drive, Scenario, TipPath};
use crate::math::{Pose, Vec2};
use crate::model::{Ground, Obstacle, Outline, OutlinePart, SideFrictionRule};

impl Scenario {
    /// The file that states the whole scenario without defaults. It reads as an equal scenario. It
    /// has no gravity, which only replaces missing normal loads. Obstacles have the combined
    /// coefficients of their contact with the load, which the rule "max" leaves as they are.
    pub fn expanded(&self) -> ScenarioFile {
        ScenarioFile {
            schema: None,
            format: None,
            name: self.name.clone(),
            duration_s: plain(self.duration),
            control_period_s: plain(self.control_period),
            seed: self.seed,
            load: self.load_entry(),
            ground: ground_entry(&self.system.ground),
            springs: self.system.springs.iter().map(|spring| SpringsEntry::One(SpringEntry::of(spring))).collect(),
            obstacles: self.system.world.obstacles.iter().map(obstacle_entry).collect(),
            side_friction_rule: match self.system.world.is_empty() {
                true => SideFrictionRule::default(),
                false => SideFrictionRule::Max,
            },
            drive: match &self.drive {
                Drive::Tips(paths) => DriveEntry::Tips(TipsEntry { kind: TipsKind::Tips, paths: paths.iter().map(path_entry).collect() }),
                Drive::Ants(ants) => DriveEntry::Ants(Box::new(ants_entry(ants, self.system.world.is_empty()))),
            },
        }
    }

    /// SHA-256 of the expanded file in hexadecimal. Equal scenarios have the same hash, however
    /// they are written.
    pub fn hash(&self) -> String {
        sha256_hex(serde_json::to_string(&self.expanded()).expect("the format is plain data").as_bytes())
    }

    fn load_entry(&self) -> LoadEntry {
        let (load, start) = (&self.system.load, &self.start);
        let (radius_m, outline) = match self.system.world.outline.centred_radius() {
            Some(radius) => (Some(plain(radius)), None),
            None => (None, Some(outline_entry(&self.system.world.outline))),
        };
        LoadEntry {
            mass_kg: Some(plain(load.mass)),
            density_kg_per_m2: None,
            inertia_kg_m2: Some(plain(load.inertia)),
            radius_m,
            outline,
            side_friction_coefficient: 0.0,
            restitution: 0.0,
            position_m: pair(&start.pose.position),
            heading_rad: plain(start.pose.heading),
            velocity_m_per_s: pair(&start.twist.linear),
            turn_rate_rad_per_s: plain(start.twist.angular),
        }
    }
}

/// SHA-256 of `bytes` in hexadecimal.
pub fn sha256_hex(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

fn ground_entry(ground: &Ground) -> GroundEntry {
    let supports = ground.supports.iter().map(|support| SupportEntry {
        offset_m: pair(&support.offset),
        normal_load_n: Some(plain(support.normal_load)),
        friction_coefficient: support.friction_coefficient.map(plain),
    });
    GroundEntry {
        friction_coefficient: plain(ground.friction_coefficient),
        gravity_m_per_s2: None,
        supports: SupportsEntry::List(supports.collect()),
    }
}

/// One part as it is, several as a compound.
fn outline_entry(outline: &Outline) -> OutlineEntry {
    match outline.parts.as_slice() {
        [OutlinePart::Disc { .. }] if outline.centred_radius().is_none() => compound(&outline.parts),
        [only] => part_entry(only).outline,
        parts => compound(parts),
    }
}

fn compound(parts: &[OutlinePart]) -> OutlineEntry {
    OutlineEntry::Compound(CompoundEntry { parts: parts.iter().map(part_entry).collect() })
}

fn part_entry(part: &OutlinePart) -> PartEntry {
    let points = |list: &[Vec2]| list.iter().map(pair).collect();
    let (outline, position_m) = match part {
        OutlinePart::Disc { centre, radius } => (OutlineEntry::Disc(DiscEntry { radius_m: plain(*radius) }), pair(centre)),
        OutlinePart::Polygon { corners } => (OutlineEntry::Polygon(PolygonEntry { points_m: points(corners) }), [0.0; 2]),
        OutlinePart::Polyline { points: ends } => (OutlineEntry::Polyline(PolylineEntry { points_m: points(ends) }), [0.0; 2]),
    };
    PartEntry { outline, position_m, heading_rad: 0.0 }
}

fn obstacle_entry(obstacle: &Obstacle) -> ObstacleEntry {
    let waypoints = &obstacle.path.waypoints;
    let (_, start) = waypoints[0];
    let row = |(time, pose): &(f64, Pose)| [*time, pose.position.x, pose.position.y, pose.heading].map(plain);
    let moves = obstacle.path.moves();
    ObstacleEntry {
        name: obstacle.name.clone(),
        outline: outline_entry(&obstacle.outline),
        position_m: (!moves).then(|| pair(&start.position)),
        heading_rad: (!moves).then(|| plain(start.heading)),
        friction_coefficient: plain(obstacle.friction_coefficient),
        restitution: plain(obstacle.restitution),
        path: moves.then(|| ObstaclePathEntry { waypoints: waypoints.iter().map(row).collect() }),
    }
}

fn path_entry(path: &TipPath) -> PathEntry {
    let waypoints = path.waypoints.iter().map(|point| [point.time, point.position.x, point.position.y].map(plain));
    PathEntry { spring: path.spring, waypoints: waypoints.collect(), release_s: path.release.map(plain) }
}

/// Ants with all their parameters. In a scenario without obstacles those of avoidance are left out
/// where they are the defaults, so that its hash is that of a scenario which knows of no obstacles.
fn ants_entry(ants: &AntDrive, is_empty: bool) -> AntsEntry {
    let some = |value: f64| Some(plain(value));
    let standard = presets::ants(Preset::default(), ants.n_ants);
    let avoidance = |drive: &AntDrive| (drive.avoidance, drive.body_radius, drive.look_ahead);
    let avoids = !is_empty || avoidance(ants) != avoidance(&standard);
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
        avoidance: avoids.then_some(ants.avoidance),
        body_radius_m: some(ants.body_radius).filter(|_| avoids),
        look_ahead_m: some(ants.look_ahead).filter(|_| avoids),
    }
}

fn pair(vector: &Vec2) -> [f64; 2] {
    [plain(vector.x), plain(vector.y)]
}
