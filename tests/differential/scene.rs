//! Scenes as data, and the scenario in JSON that a scene stands for.

use cohaul::scenario::Scenario;
use serde_json::{Value, json};

/// A point (m).
pub type Point = [f64; 2];

/// A part of an outline, in the frame of its body (m).
#[derive(Clone, Debug)]
pub enum Part {
    Disc { centre: Point, radius: f64 },
    Polygon(Vec<Point>),
    Line(Vec<Point>),
}

/// An obstacle. It stands still where its path has one waypoint.
#[derive(Clone, Debug)]
pub struct Body {
    pub parts: Vec<Part>,
    pub friction: f64,
    pub restitution: f64,
    /// Time (s), position (m) and heading (rad) of waypoints.
    pub path: Vec<[f64; 4]>,
}

/// A spring without rest length, and the waypoints of its tip.
#[derive(Clone, Debug)]
pub struct Spring {
    pub root: Point,
    /// (N/m)
    pub stiffness: f64,
    /// Time (s) and position (m) of waypoints.
    pub path: Vec<[f64; 3]>,
}

/// A load that springs pull along a ground with friction, among obstacles.
#[derive(Clone, Debug)]
pub struct Scene {
    pub name: String,
    /// (s)
    pub duration: f64,
    pub control_period: f64,
    /// Outline of the load about its centre of mass.
    pub load: Vec<Part>,
    /// (kg)
    pub mass: f64,
    /// About the centre of mass (kg m^2).
    pub inertia: f64,
    /// Position (m) and heading (rad) at the start.
    pub start: [f64; 3],
    /// Velocity (m/s) and turn rate (rad/s) at the start.
    pub velocity: [f64; 3],
    pub ground_friction: f64,
    /// Offsets of supports from the centre of mass (m), and normal loads on them (N).
    pub supports: Vec<(Point, f64)>,
    pub springs: Vec<Spring>,
    pub obstacles: Vec<Body>,
}

/// Standard gravity of the scenes (m/s^2).
pub const GRAVITY: f64 = 9.81;

/// Corners of a rectangle about `centre` (m), counter-clockwise.
pub fn rectangle([x, y]: Point, [width, height]: Point) -> Part {
    let (a, b) = (0.5 * width, 0.5 * height);
    Part::Polygon(vec![[x - a, y - b], [x + a, y - b], [x + a, y + b], [x - a, y + b]])
}

/// A body at rest whose frame is that of the world.
pub fn fixed(parts: Vec<Part>, friction: f64) -> Body {
    Body { parts, friction, restitution: 0.0, path: vec![[0.0; 4]] }
}

impl Part {
    fn json(&self) -> Value {
        let outline = match self {
            Self::Disc { radius, .. } => json!({ "disc": { "radius_m": radius } }),
            Self::Polygon(points) => json!({ "polygon": { "points_m": points } }),
            Self::Line(points) => json!({ "polyline": { "points_m": points } }),
        };
        let position = if let Self::Disc { centre, .. } = self { *centre } else { [0.0; 2] };
        json!({ "outline": outline, "position_m": position })
    }

    /// Largest distance of a point of the part from the origin (m).
    pub fn extent(&self) -> f64 {
        match self {
            Self::Disc { centre: [x, y], radius } => x.hypot(*y) + radius,
            Self::Polygon(points) | Self::Line(points) => points.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max),
        }
    }
}

fn outline(parts: &[Part]) -> Value {
    match parts {
        [Part::Disc { centre: [0.0, 0.0], radius }] => json!({ "disc": { "radius_m": radius } }),
        [part @ (Part::Polygon(_) | Part::Line(_))] => part.json()["outline"].take(),
        parts => json!({ "compound": { "parts": parts.iter().map(Part::json).collect::<Vec<_>>() } }),
    }
}

impl Body {
    fn json(&self, index: usize) -> Value {
        let mut body = json!({
            "name": format!("obstacle {index}"), "outline": outline(&self.parts),
            "friction_coefficient": self.friction, "restitution": self.restitution,
        });
        if let [[_, x, y, heading]] = self.path[..] {
            body["position_m"] = json!([x, y]);
            body["heading_rad"] = json!(heading);
        } else {
            body["path"] = json!({ "waypoints": self.path });
        }
        body
    }
}

impl Spring {
    fn json(&self) -> Value {
        json!({
            "root_m": self.root, "bearing_rad": 0.0, "rest_length_m": 0.0,
            "radial_stiffness_n_per_m": self.stiffness, "torsional_stiffness_nm_per_rad": 0.0,
        })
    }
}

impl Scene {
    /// Largest distance of a point of the load from its centre of mass (m).
    pub fn size(&self) -> f64 {
        self.load.iter().map(Part::extent).fold(0.0, f64::max)
    }

    pub fn json(&self) -> Value {
        let supports: Vec<Value> =
            self.supports.iter().map(|(offset, load)| json!({ "offset_m": offset, "normal_load_n": load })).collect();
        let tips: Vec<Value> =
            self.springs.iter().enumerate().map(|(spring, one)| json!({ "spring": spring, "waypoints": one.path })).collect();
        let ([x, y, heading], [u, v, rate]) = (self.start, self.velocity);
        json!({
            "name": self.name, "duration_s": self.duration, "control_period_s": self.control_period,
            "load": {
                "mass_kg": self.mass, "inertia_kg_m2": self.inertia, "outline": outline(&self.load),
                "position_m": [x, y], "heading_rad": heading, "velocity_m_per_s": [u, v], "turn_rate_rad_per_s": rate,
            },
            "ground": { "friction_coefficient": self.ground_friction, "supports": supports },
            "springs": self.springs.iter().map(Spring::json).collect::<Vec<_>>(),
            "obstacles": self.obstacles.iter().enumerate().map(|(index, body)| body.json(index)).collect::<Vec<_>>(),
            "side_friction_rule": "max",
            "drive": { "kind": "tips", "paths": tips },
        })
    }

    /// The scenario of this scene.
    ///
    /// # Panics
    /// When the scene breaks a rule of the format.
    pub fn scenario(&self) -> Scenario {
        Scenario::parse(&self.json().to_string(), &self.name).unwrap_or_else(|error| panic!("{error}"))
    }
}
