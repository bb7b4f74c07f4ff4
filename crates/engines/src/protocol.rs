//! Requests to an engine and its answers: JSON objects, one a line, in SI units and world axes.
//!
//! The load's origin is its centre of mass. Headings turn counter-clockwise, without wrapping.

use serde::{Deserialize, Serialize};

use cohaul::backend::BackendOptions;
use cohaul::math::{Pose, Twist, Vec2};
use cohaul::model::{Motion, Outline, OutlinePart, PolarSpring, SpringLaw, System};

/// Version of the protocol: a request `start` carries it.
pub const VERSION: u32 = 1;

/// A request, by its `call`.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "call", rename_all = "snake_case")]
pub enum Request {
    /// The first request: a new run. Answered by [`Started`].
    Start {
        protocol: u32,
        scene: Box<Scene>,
        /// Longest step (s).
        longest_step_s: f64,
    },
    /// The tip of a free spring is attached. Answered by an empty object, as `release` and `end`.
    Attach { spring: usize, tip_m: [f64; 2] },
    /// An attached spring is released.
    Release { spring: usize },
    /// The attached tips and the obstacles move in straight lines, at constant speed, to these
    /// places within the duration, in `n_steps` equal steps. Answered by [`Advanced`].
    Advance {
        /// Target of each spring's tip (m); `null` for a free spring.
        tips_m: Vec<Option<[f64; 2]>>,
        /// Target pose of each obstacle (m, m, rad).
        obstacles: Vec<[f64; 3]>,
        duration_s: f64,
        n_steps: u64,
    },
    /// The last request. The engine may end.
    End,
}

/// A scene, as an engine gets it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    pub mass_kg: f64,
    /// Moment of inertia about the centre of mass (kg m^2).
    pub inertia_kg_m2: f64,
    /// Radius that makes an angle an edge displacement (m).
    pub radius_m: f64,
    /// Pose at the start (m, m, rad).
    pub pose: [f64; 3],
    /// Twist at the start (m/s, m/s, rad/s).
    pub twist: [f64; 3],
    pub outline: Vec<Part>,
    pub supports: Vec<Support>,
    pub springs: Vec<Spring>,
    pub obstacles: Vec<Obstacle>,
}

/// Part of an outline, in the frame of its body.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Part {
    Disc {
        centre_m: [f64; 2],
        radius_m: f64,
    },
    /// Corners, counter-clockwise; not always convex.
    Polygon {
        corners_m: Vec<[f64; 2]>,
    },
    /// A chain of walls without thickness.
    Polyline {
        points_m: Vec<[f64; 2]>,
    },
}

/// A point under the load with Coulomb friction on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Support {
    /// In the load's frame.
    pub offset_m: [f64; 2],
    /// Largest friction force, mu N.
    pub slip_limit_n: f64,
}

/// A spring of the load: after the paper's polar law, with dashpots along and across, or a rope.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spring {
    /// Root in the load's frame.
    pub root_m: [f64; 2],
    /// Direction of the undeformed spring in the load's frame.
    pub bearing_rad: f64,
    pub rest_length_m: f64,
    pub radial_stiffness_n_per_m: f64,
    pub torsional_stiffness_nm_per_rad: f64,
    pub radial_damping_ns_per_m: f64,
    pub torsional_damping_nms_per_rad: f64,
    pub law: SpringLaw,
}

/// An obstacle at the start.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Obstacle {
    pub name: String,
    pub outline: Vec<Part>,
    pub pose: [f64; 3],
    /// Coefficient of friction between load and obstacle (1).
    pub friction_coefficient: f64,
    /// Coefficient of restitution of an impact (1).
    pub restitution: f64,
}

/// Answer to `start`.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Started {
    /// Needed unless the scene is refused.
    #[serde(default)]
    pub name: String,
    #[serde(default)]
    pub version: Option<String>,
    /// Why the engine does not take the scene.
    #[serde(default)]
    pub refused: Option<String>,
}

/// Answer to `advance`: the state at its end. Left out may be all but the pose; what is left out is
/// not judged, but for the pulls, which follow from the spring law.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Advanced {
    /// (m, m, rad)
    pub pose: [f64; 3],
    /// (m/s, m/s, rad/s)
    #[serde(default)]
    pub twist: Option<[f64; 3]>,
    /// Whether all steps were solved as the engine means to; `true` where it cannot tell.
    #[serde(default = "yes")]
    pub converged: bool,
    /// Force on each spring's tip; `null` for free springs (N).
    #[serde(default)]
    pub pulls_n: Option<Vec<Option<[f64; 2]>>>,
    /// Energy dissipated since the start (J), without that of springs that were released.
    #[serde(default)]
    pub dissipated_j: Option<f64>,
    /// Forces of obstacles on the load.
    #[serde(default)]
    pub contacts: Option<Vec<Contact>>,
}

/// Force of an obstacle on the load, averaged over the last step.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Its place in the scene's list.
    pub obstacle: usize,
    pub point_m: [f64; 2],
    pub force_n: [f64; 2],
}

/// What an engine may ask in the midst of an advance, in place of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(tag = "ask", rename_all = "snake_case", deny_unknown_fields)]
pub enum Ask {
    /// The wrench of all attached springs on the load at this pose and twist, after this share of
    /// the advance (1). Answered by [`WrenchOnLoad`].
    Wrench {
        pose: [f64; 3],
        #[serde(default)]
        twist: [f64; 3],
        share: f64,
    },
}

/// Answer to an engine that asks for the wrench.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WrenchOnLoad {
    /// Force (N, N) and torque about the centre of mass (N m).
    pub wrench: [f64; 3],
}

fn yes() -> bool {
    true
}

pub fn pair(v: &Vec2) -> [f64; 2] {
    [v.x, v.y]
}

pub fn of_pose(pose: &Pose) -> [f64; 3] {
    [pose.position.x, pose.position.y, pose.heading]
}

pub fn of_twist(twist: &Twist) -> [f64; 3] {
    [twist.linear.x, twist.linear.y, twist.angular]
}

impl Request {
    /// The first request of a run from this `start`.
    pub fn start(system: &System, start: &Motion, options: &BackendOptions) -> Self {
        let scene = Box::new(Scene::of(system, start));
        Self::Start { protocol: VERSION, scene, longest_step_s: options.step_s }
    }
}

impl Scene {
    fn of(system: &System, start: &Motion) -> Self {
        let System { load, ground, springs, world } = system;
        let supports = ground.supports.iter().zip(ground.slip_limits());
        let spring = |spring: &PolarSpring| {
            let (radial, torsional) = system.dashpot(spring);
            Spring {
                root_m: pair(&spring.root),
                bearing_rad: spring.bearing,
                rest_length_m: spring.rest_length,
                radial_stiffness_n_per_m: spring.radial_stiffness,
                torsional_stiffness_nm_per_rad: spring.torsional_stiffness,
                radial_damping_ns_per_m: radial,
                torsional_damping_nms_per_rad: torsional,
                law: spring.law,
            }
        };
        let obstacle = |obstacle: &cohaul::model::Obstacle| Obstacle {
            name: obstacle.name.clone(),
            outline: parts(&obstacle.outline),
            pose: of_pose(&obstacle.path.pose_at(0.0)),
            friction_coefficient: obstacle.friction_coefficient,
            restitution: obstacle.restitution,
        };
        Self {
            mass_kg: load.mass,
            inertia_kg_m2: load.inertia,
            radius_m: load.radius,
            pose: of_pose(&start.pose),
            twist: of_twist(&start.twist),
            outline: parts(&world.outline),
            supports: supports.map(|(at, limit)| Support { offset_m: pair(&at.offset), slip_limit_n: limit }).collect(),
            springs: springs.iter().map(spring).collect(),
            obstacles: world.obstacles.iter().map(obstacle).collect(),
        }
    }
}

fn parts(outline: &Outline) -> Vec<Part> {
    let pairs = |points: &[Vec2]| points.iter().map(pair).collect();
    let part = |part: &OutlinePart| match part {
        OutlinePart::Disc { centre, radius } => Part::Disc { centre_m: pair(centre), radius_m: *radius },
        OutlinePart::Polygon { corners } => Part::Polygon { corners_m: pairs(corners) },
        OutlinePart::Polyline { points } => Part::Polyline { points_m: pairs(points) },
    };
    outline.parts.iter().map(part).collect()
}
