//! A smoothed step, and the path of its answers as the smoothing vanishes.
//!
//! With a smoothing e, and lengths and forces in units in which the step is of order one,
//!
//! ```text
//! f_i sqrt(|v_i|^2 + e^2) = c_i v_i           support i with the slip v_i = B_i x
//! p_k y_k = e                                 contact k; y_k > 0 is its gap plus e p_k
//! tau_k sqrt(s_k^2 + e^2) = -mu_k p_k s_k     its friction at the slip s_k
//! ```
//!
//! replace the conditions of the step. The term e p_k keeps forces finite where obstacles hold the
//! load from all sides. Newton's method on these products, with the forces as
//! unknowns of their own, follows the path down to e near rounding in some twenty iterations
//! (Andersen, Christiansen, Conn and Overton 2000, for sums of norms). Without side friction the
//! step is convex and the path leads to its answer from anywhere. With side friction it starts at
//! contacts that resist little, so that it prefers sliding to rest, but it may end.

use smallvec::SmallVec;

use super::problem::{PerCone, Problem};
use super::types::{ContactRow, PerContact, SideForce};
use crate::backend::friction::ContactMode;
use crate::math::{Mat2, Mat3, Vec2, Vec3};

/// Iterations at most; a convex step takes some twenty.
const MOST_ITERATIONS: u32 = 80;
/// Smoothing at the end (1).
const END: f64 = 1e-13;
/// Imbalance at the end (1).
const BALANCED: f64 = 1e-11;
/// Error of a condition over the smoothing that does not matter (1).
const NEAR: f64 = 10.0;
/// Rounding of a gap, over the gap (1).
const ROUNDED: f64 = 1e-15;
/// Share of the distance to a limit that a step may go (1).
const SHARE: f64 = 0.97;

/// End of a path, in units of the cones.
#[derive(Clone, Debug)]
pub struct Path {
    pub twist: Vec3,
    pub ground_forces: PerCone<Vec2>,
    /// Force of each row.
    pub forces: SmallVec<[SideForce; 8]>,
    /// Whether each row is closed.
    pub is_closed: SmallVec<[bool; 8]>,
    /// Cones that stick.
    sticking: PerCone<usize>,
    pub is_converged: bool,
    pub n_iterations: u32,
    /// Inverse of the derivative of the imbalance at the end (scaled for the path).
    inverse: Mat3,
    /// Force of each row over its gap there (scaled for the path).
    stiffness: SmallVec<[f64; 8]>,
}

impl Path {
    /// Contact mode with the ground that the end shows; a pinned support is named by its cone.
    pub fn ground_mode(&self) -> ContactMode {
        match self.sticking[..] {
            [] => ContactMode::Slip,
            [cone] => ContactMode::Pinned(cone),
            _ => ContactMode::Stick,
        }
    }

    /// Derivative of the increment by the gap of a row.
    pub fn by_gap(&self, row: &ContactRow, j: usize) -> Vec3 {
        -self.stiffness[j] * (self.inverse * row.normal)
    }
}

/// The answer of a step.
pub fn follow(problem: &Problem) -> Path {
    let mut state = State::new(problem);
    let (mut smoothing, mut n_iterations, mut is_converged) = (1.0, 0, false);
    let mut slopes = Mat3::zeros();
    while n_iterations < MOST_ITERATIONS {
        n_iterations += 1;
        let Some((step, found)) = state.newton_step(smoothing) else { break };
        slopes = found;
        let Some(share) = state.advance(&step, smoothing) else { break };
        if smoothing <= END && state.is_solved(smoothing) {
            is_converged = true;
            break;
        }
        smoothing = (smoothing
            * if share > 0.8 {
                0.1
            } else if share > 0.3 {
                0.4
            } else {
                1.0
            })
        .max(END);
    }
    state.end(problem, smoothing, &slopes, is_converged, n_iterations)
}

/// State of Newton's method in units of the path: lengths by the extent of the increment, forces by
/// those of the step.
struct State<'a> {
    problem: &'a Problem<'a>,
    h: Mat3,
    w: Vec3,
    limits: PerCone<f64>,
    rows: SmallVec<[ContactRow; 8]>,
    twist: Vec3,
    ground: PerCone<Vec2>,
    gaps: SmallVec<[f64; 8]>,
    sides: SmallVec<[SideForce; 8]>,
    /// Force of each support after a step of the forces alone, and its derivative by the slip.
    next_ground: PerCone<(Vec2, Mat2)>,
    /// The same of each row.
    next_sides: SmallVec<[Side; 8]>,
}

impl<'a> State<'a> {
    fn new(problem: &'a Problem) -> Self {
        let Problem { cones, h, w, rows, extent, force, .. } = problem;
        let scaled = |row: &ContactRow| ContactRow { gap: row.gap / extent, slip: row.slip / extent, ..*row };
        Self {
            problem,
            h: h * (*extent / force),
            w: w / *force,
            limits: cones.limits.iter().map(|limit| limit / force).collect(),
            rows: rows.iter().map(scaled).collect(),
            twist: Vec3::zeros(),
            ground: SmallVec::from_elem(Vec2::zeros(), cones.len()),
            gaps: rows.iter().map(|row| (row.gap / extent).max(1.0)).collect(),
            sides: SmallVec::from_elem(SideForce { normal: 1.0, tangential: 0.0 }, rows.len()),
            next_ground: PerCone::new(),
            next_sides: SmallVec::new(),
        }
    }

    fn imbalance(&self) -> Vec3 {
        let sides: Vec3 = self.rows.iter().zip(&self.sides).map(|(row, f)| f.normal * row.normal + f.tangential * row.tangent).sum();
        self.h * self.twist - self.w + self.problem.cones.wrench(&self.ground) - sides
    }

    /// Whether all conditions of the smoothed step hold, as far as it matters.
    fn is_solved(&self, smoothing: f64) -> bool {
        let near = NEAR * smoothing;
        let support = |k: usize| {
            let slip = self.problem.cones.slip(k, &self.twist);
            let speed = (slip.norm_squared() + smoothing * smoothing).sqrt();
            (self.ground[k] * speed - self.limits[k] * slip).norm() <= near * self.limits[k]
        };
        let row = |j: usize| {
            let (SideForce { normal, tangential }, gap, friction) = (self.sides[j], self.gaps[j], self.rows[j].friction_coefficient);
            let slip = self.slip_of(j);
            let slips = tangential * slip.hypot(smoothing) + friction * normal * slip;
            normal * gap <= near && self.gap_error(j, smoothing).abs() <= near + ROUNDED * gap && slips.abs() <= near * normal.max(1.0)
        };
        self.imbalance().amax() <= BALANCED && (0..self.ground.len()).all(support) && (0..self.rows.len()).all(row)
    }

    fn slip_of(&self, j: usize) -> f64 {
        self.rows[j].slip + self.rows[j].tangent.dot(&self.twist)
    }

    /// What is missing in the gap variable of row j at the twist and at its force.
    fn gap_error(&self, j: usize, smoothing: f64) -> f64 {
        self.rows[j].gap + self.rows[j].normal.dot(&self.twist) + smoothing * self.sides[j].normal - self.gaps[j]
    }

    /// Newton step of the twist, and the derivative of the imbalance by the twist.
    fn newton_step(&mut self, smoothing: f64) -> Option<(Vec3, Mat3)> {
        let mut slopes = self.h;
        let mut sum = self.h * self.twist - self.w;
        self.next_ground = (0..self.ground.len()).map(|k| self.support(k, smoothing)).collect();
        self.next_sides = (0..self.rows.len()).map(|j| self.side(j, smoothing)).collect();
        for (k, (force, slope)) in self.next_ground.iter().enumerate() {
            let offset = self.problem.cones.offsets[k];
            sum += Vec3::new(force.x, force.y, offset.perp(force));
            let jacobian = nalgebra::Matrix2x3::new(1.0, 0.0, -offset.y, 0.0, 1.0, offset.x);
            slopes += jacobian.transpose() * slope * jacobian;
        }
        for (side, row) in self.next_sides.iter().zip(&self.rows) {
            sum -= side.normal * row.normal + side.tangential * row.tangent;
            slopes += side.stiffness * row.normal * row.normal.transpose();
            slopes += row.tangent * (side.by_slip * row.tangent - side.coupling * row.normal).transpose();
        }
        let step = slopes.lu().solve(&-sum).filter(|step| step.iter().all(|v| v.is_finite()))?;
        Some((step, slopes))
    }

    /// Force of support k without a step, and its derivative by the slip.
    fn support(&self, k: usize, smoothing: f64) -> (Vec2, Mat2) {
        let slip = self.problem.cones.slip(k, &self.twist);
        let speed = (slip.norm_squared() + smoothing * smoothing).sqrt();
        let (limit, force) = (self.limits[k], self.ground[k]);
        let turned = force * slip.transpose() / (speed * speed);
        (limit / speed * slip, Mat2::from_diagonal_element(limit / speed) - 0.5 * (turned + turned.transpose()))
    }

    /// Force of row j without a step of the twist, and its derivatives.
    fn side(&self, j: usize, smoothing: f64) -> Side {
        let (SideForce { normal, tangential }, gap, friction) = (self.sides[j], self.gaps[j], self.rows[j].friction_coefficient);
        let stiffness = normal / (gap + smoothing * normal);
        let without = normal + (smoothing - normal * (gap + self.gap_error(j, smoothing))) / (gap + smoothing * normal);
        if friction == 0.0 {
            return Side { normal: without, tangential: 0.0, stiffness, by_slip: 0.0, coupling: 0.0 };
        }
        let slip = self.slip_of(j);
        let speed = (slip * slip + smoothing * smoothing).sqrt();
        let share = friction * slip / speed;
        Side {
            normal: without,
            tangential: -share * without,
            stiffness,
            by_slip: (tangential * slip / speed + friction * normal) / speed,
            coupling: share * stiffness,
        }
    }

    /// Goes as far along the step as the limits allow; returns that share of it. `None`, with
    /// nothing changed, where forces overflow.
    fn advance(&mut self, step: &Vec3, smoothing: f64) -> Option<f64> {
        let mut share: f64 = 1.0;
        let mut changes: SmallVec<[(f64, SideForce); 8]> = SmallVec::new();
        for (j, row) in self.rows.iter().enumerate() {
            let (along, across) = (row.normal.dot(step), row.tangent.dot(step));
            let side = &self.next_sides[j];
            let normal = side.normal - side.stiffness * along - self.sides[j].normal;
            let gap = along + smoothing * normal + self.gap_error(j, smoothing);
            let tangential = side.tangential - side.by_slip * across + side.coupling * along - self.sides[j].tangential;
            if !(gap + normal + tangential).is_finite() {
                return None;
            }
            if gap < 0.0 {
                share = share.min(-SHARE * self.gaps[j] / gap);
            }
            if normal < 0.0 {
                share = share.min(-SHARE * self.sides[j].normal / normal);
            }
            changes.push((gap, SideForce { normal, tangential }));
        }
        for k in 0..self.ground.len() {
            let (force, slope) = self.next_ground[k];
            let next = force + slope * self.problem.cones.slip(k, step);
            let change = next - self.ground[k];
            self.ground[k] += share * change;
            let (size, limit) = (self.ground[k].norm(), self.limits[k]);
            if size > limit {
                self.ground[k] *= limit / size;
            }
        }
        self.twist += share * step;
        for (j, (gap, change)) in changes.into_iter().enumerate() {
            self.gaps[j] += share * gap;
            let friction = self.rows[j].friction_coefficient;
            let side = &mut self.sides[j];
            side.normal += share * change.normal;
            side.tangential = (side.tangential + share * change.tangential).clamp(-friction * side.normal, friction * side.normal);
        }
        Some(share)
    }

    fn end(self, problem: &Problem, smoothing: f64, slopes: &Mat3, is_converged: bool, n_iterations: u32) -> Path {
        let Problem { extent, force, cones, .. } = problem;
        let slow = smoothing.sqrt();
        let sticking = (0..cones.len()).filter(|k| cones.slip(*k, &self.twist).norm() < slow).collect();
        let unscaled = |side: &SideForce| SideForce { normal: force * side.normal, tangential: force * side.tangential };
        Path {
            twist: *extent * self.twist,
            ground_forces: self.ground.iter().map(|f| *force * f).collect(),
            forces: self.sides.iter().map(unscaled).collect(),
            is_closed: self.sides.iter().zip(&self.gaps).map(|(side, gap)| side.normal > *gap).collect(),
            sticking,
            is_converged,
            n_iterations,
            inverse: slopes.try_inverse().filter(|inverse| inverse.iter().all(|v| v.is_finite())).unwrap_or_default(),
            stiffness: self.sides.iter().zip(&self.gaps).map(|(side, gap)| side.normal / (gap + smoothing * side.normal)).collect(),
        }
    }
}

/// Force of a row and its derivatives.
struct Side {
    normal: f64,
    tangential: f64,
    stiffness: f64,
    by_slip: f64,
    coupling: f64,
}

/// Forces of contacts from those of their rows.
pub fn sides_of(forces: &[SideForce]) -> PerContact<SideForce> {
    forces.iter().copied().collect()
}
