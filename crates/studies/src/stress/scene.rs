//! Base scenes, put together as scenario files so that the format's own rules judge every cell.

use std::f64::consts::TAU;

use super::map::{Asked, Cell};
use crate::verify::scenes::{GRAVITY, LOAD_RADIUS, MASS, MU, RADIAL, REST_LENGTH, SUPPORT_RADIUS, TORSIONAL};
use cohaul::math::{Vec2, direction};
use cohaul::model::SideFrictionRule;
use cohaul::scenario::format::{
    DiscEntry, DriveEntry, GroundEntry, LoadEntry, ObstacleEntry, ObstaclePathEntry, OutlineEntry, PathEntry, PolylineEntry, ScenarioFile,
    SpringEntry, SpringsEntry, SupportEntry, SupportsEntry, TipsEntry, TipsKind,
};

/// A scene of prescribed tips in steps of equal length, one a control period.
#[derive(Clone, Debug)]
pub struct Scene {
    pub load: LoadEntry,
    pub friction_coefficient: f64,
    pub supports: Vec<SupportEntry>,
    pub springs: Vec<SpringEntry>,
    pub paths: Vec<PathEntry>,
    pub obstacles: Vec<ObstacleEntry>,
    /// (s)
    pub step: f64,
    pub n_steps: u32,
}

impl Scene {
    /// The paper's load at rest on three supports, one of them ahead on the x axis, without
    /// springs; `n_steps` of `step` (s).
    pub fn paper(step: f64, n_steps: u32) -> Self {
        Self {
            load: load(MASS),
            friction_coefficient: MU,
            supports: ring(3, SUPPORT_RADIUS, MASS * GRAVITY),
            springs: Vec::new(),
            paths: Vec::new(),
            obstacles: Vec::new(),
            step,
            n_steps,
        }
    }

    /// (s)
    pub fn duration(&self) -> f64 {
        f64::from(self.n_steps) * self.step
    }

    /// Adds a spring whose tip goes through `waypoints` (time in steps; m, world).
    pub fn pulled(mut self, spring: SpringEntry, waypoints: &[(f64, Vec2)]) -> Self {
        let waypoints = waypoints.iter().map(|(steps, at)| [steps * self.step, at.x, at.y]).collect();
        self.paths.push(PathEntry { spring: self.springs.len(), waypoints, release_s: None });
        self.springs.push(spring);
        self
    }

    /// Adds an obstacle at rest with its origin at `position` (m) and a coefficient of `friction`
    /// (1).
    pub fn among(mut self, outline: OutlineEntry, position: Vec2, friction: f64) -> Self {
        let name = format!("obstacle {}", self.obstacles.len());
        let obstacle = ObstacleEntry {
            name,
            outline,
            position_m: Some(position.into()),
            heading_rad: None,
            friction_coefficient: friction,
            restitution: 0.0,
            path: None,
        };
        self.obstacles.push(obstacle);
        self
    }

    /// Adds a pusher that goes from `start` to `end` (m) within all steps, with a coefficient of
    /// `friction` (1).
    pub fn pushed(mut self, outline: OutlineEntry, [start, end]: [Vec2; 2], friction: f64) -> Self {
        let waypoints = vec![[0.0, start.x, start.y, 0.0], [self.duration(), end.x, end.y, 0.0]];
        self = self.among(outline, start, friction);
        let pusher = self.obstacles.last_mut().expect("it was added");
        (pusher.position_m, pusher.path) = (None, Some(ObstaclePathEntry { waypoints }));
        self
    }

    pub fn cell(self, asked: Asked) -> Cell {
        Cell { scenario: self.file().checked("cell"), asked }
    }

    pub fn file(self) -> ScenarioFile {
        ScenarioFile {
            schema: None,
            format: None,
            name: "stress".to_owned(),
            duration_s: self.duration(),
            control_period_s: self.step,
            seed: 1,
            load: self.load,
            ground: GroundEntry {
                friction_coefficient: self.friction_coefficient,
                gravity_m_per_s2: None,
                supports: SupportsEntry::List(self.supports),
            },
            springs: self.springs.into_iter().map(SpringsEntry::One).collect(),
            obstacles: self.obstacles,
            side_friction_rule: SideFrictionRule::Max,
            drive: DriveEntry::Tips(TipsEntry { kind: TipsKind::Tips, paths: self.paths }),
        }
    }
}

/// A disc of the paper's radius at rest at the origin.
pub fn load(mass: f64) -> LoadEntry {
    LoadEntry { mass_kg: Some(mass), radius_m: Some(LOAD_RADIUS), ..LoadEntry::default() }
}

/// A disc about its origin (m).
pub fn disc(radius: f64) -> OutlineEntry {
    OutlineEntry::Disc(DiscEntry { radius_m: radius })
}

/// A chain of straight walls through `points` (m).
pub fn walls(points: &[Vec2]) -> OutlineEntry {
    OutlineEntry::Polyline(PolylineEntry { points_m: points.iter().map(|point| (*point).into()).collect() })
}

/// `n` supports on a circle of `radius` (m), the first on the x axis, that share `total` (N) of
/// normal load.
pub fn ring(n: usize, radius: f64, total: f64) -> Vec<SupportEntry> {
    (0..n).map(|i| support(radius * direction(TAU * i as f64 / n as f64), total / n as f64)).collect()
}

pub fn support(offset: Vec2, normal_load: f64) -> SupportEntry {
    SupportEntry { offset_m: offset.into(), normal_load_n: Some(normal_load), friction_coefficient: None }
}

/// The paper's spring, at `bearing` (rad) on the edge of the load.
pub fn spring(bearing: f64) -> SpringEntry {
    SpringEntry {
        root_m: (LOAD_RADIUS * direction(bearing)).into(),
        bearing_rad: bearing,
        rest_length_m: REST_LENGTH,
        radial_stiffness_n_per_m: RADIAL,
        torsional_stiffness_nm_per_rad: TORSIONAL,
        ..SpringEntry::default()
    }
}

/// The paper's spring with `stiffness` (N/m) along itself, and across in the paper's proportion.
pub fn stiff_spring(bearing: f64, stiffness: f64) -> SpringEntry {
    let factor = stiffness / RADIAL;
    SpringEntry { radial_stiffness_n_per_m: stiffness, torsional_stiffness_nm_per_rad: factor * TORSIONAL, ..spring(bearing) }
}

/// A spring of the paper's stiffness in every direction from its root (m).
pub fn isotropic(root: Vec2) -> SpringEntry {
    SpringEntry { root_m: root.into(), rest_length_m: 0.0, torsional_stiffness_nm_per_rad: 0.0, ..spring(0.0) }
}

/// Where the tip of an undeformed paper's spring at `bearing` is from the load at the origin (m).
pub fn rest_tip(bearing: f64) -> Vec2 {
    (LOAD_RADIUS + REST_LENGTH) * direction(bearing)
}
