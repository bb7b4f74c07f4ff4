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
use crate::backend::numerics::{LAST_SMOOTHING, NEAR_SMOOTHING, PATH_IMBALANCE, PATH_ITERATIONS, PATH_ROUNDING, SHARE_TO_LIMIT};
use crate::math::{Mat2, Mat3, Vec2, Vec3, perpendicular};
use crate::model::support::{slip_velocity, wrench_of};
use crate::stop;

/// One entry per row.
type PerRow<T> = SmallVec<[T; 8]>;

/// End of a path, in units of the cones.
#[derive(Clone, Debug)]
pub struct Path {
    pub twist: Vec3,
    pub ground_forces: PerCone<Vec2>,
    /// Force of each row.
    pub forces: PerRow<SideForce>,
    /// Whether each row is closed.
    pub is_closed: PerRow<bool>,
    /// Cones that stick.
    sticking: PerCone<usize>,
    pub is_converged: bool,
    pub n_iterations: u32,
    /// Inverse of the derivative of the imbalance at the end (scaled for the path).
    inverse: Mat3,
    /// Force of each row over its gap there (scaled for the path).
    stiffness: PerRow<f64>,
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
    while n_iterations < PATH_ITERATIONS {
        stop::point();
        n_iterations += 1;
        let Some((step, found)) = state.newton_step(smoothing) else { break };
        slopes = found;
        let Some(share) = state.advance(&step, smoothing) else { break };
        if smoothing <= LAST_SMOOTHING && state.is_solved(smoothing) {
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
        .max(LAST_SMOOTHING);
    }
    state.end(smoothing, &slopes, is_converged, n_iterations)
}

/// State of Newton's method in units of the path: lengths by the extent of the increment, forces by
/// those of the step.
struct State<'a> {
    problem: &'a Problem<'a>,
    h: Mat3,
    w: Vec3,
    supports: PerCone<Support>,
    rows: PerRow<Row>,
    twist: Vec3,
}

/// A support in units of the path.
struct Support {
    offset: Vec2,
    limit: f64,
    force: Vec2,
    /// Force after a step of the forces alone, and its derivative by the slip.
    next: Vec2,
    slope: Mat2,
}

/// A row in units of the path.
struct Row {
    scaled: ContactRow,
    /// Variable that stands for the gap after the increment.
    gap: f64,
    force: SideForce,
    /// Force after a step of the forces alone.
    next: SideForce,
    /// Derivative of the normal force by the gap, with the sign changed.
    stiffness: f64,
    /// Derivative of the friction by the slip, with the sign changed, and by the gap.
    by_slip: f64,
    coupling: f64,
    /// Changes of the gap variable and of the force in a step.
    change: (f64, SideForce),
}

impl<'a> State<'a> {
    fn new(problem: &'a Problem) -> Self {
        let Problem { cones, h, w, rows, extent, force, .. } = problem;
        let support = |(offset, limit): (&Vec2, &f64)| {
            let zero = Vec2::zeros();
            Support { offset: *offset, limit: limit / force, force: zero, next: zero, slope: Mat2::zeros() }
        };
        let row = |row: &ContactRow| {
            let scaled = ContactRow { gap: row.gap / extent, slip: row.slip / extent, ..*row };
            let (force, none) = (SideForce { normal: 1.0, tangential: 0.0 }, SideForce::default());
            Row { scaled, gap: scaled.gap.max(1.0), force, next: none, stiffness: 0.0, by_slip: 0.0, coupling: 0.0, change: (0.0, none) }
        };
        Self {
            problem,
            h: h * (*extent / force),
            w: w / *force,
            supports: cones.offsets.iter().zip(&cones.limits).map(support).collect(),
            rows: rows.iter().map(row).collect(),
            twist: Vec3::zeros(),
        }
    }

    fn imbalance(&self) -> Vec3 {
        let ground: Vec3 = self.supports.iter().map(|support| wrench_of(&support.offset, &support.force)).sum();
        let sides: Vec3 = self.rows.iter().map(|row| row.wrench(&row.force)).sum();
        self.h * self.twist - self.w + ground - sides
    }

    /// Whether all conditions of the smoothed step hold, as far as it matters.
    fn is_solved(&self, smoothing: f64) -> bool {
        let near = NEAR_SMOOTHING * smoothing;
        let support = |support: &Support| {
            let (slip, speed) = support.slip_and_speed(&self.twist, smoothing);
            (support.force * speed - support.limit * slip).norm() <= near * support.limit
        };
        let row = |row: &Row| {
            let (SideForce { normal, tangential }, slip) = (row.force, row.slip(&self.twist));
            let slips = tangential * slip.hypot(smoothing) + row.scaled.friction_coefficient * normal * slip;
            let gap_error = row.gap_error(&self.twist, smoothing).abs();
            normal * row.gap <= near && gap_error <= near + PATH_ROUNDING * row.gap && slips.abs() <= near * normal.max(1.0)
        };
        self.imbalance().amax() <= PATH_IMBALANCE && self.supports.iter().all(support) && self.rows.iter().all(row)
    }

    /// Newton step of the twist, and the derivative of the imbalance by the twist.
    fn newton_step(&mut self, smoothing: f64) -> Option<(Vec3, Mat3)> {
        let mut slopes = self.h;
        let mut sum = self.h * self.twist - self.w;
        for support in &mut self.supports {
            support.prepare(&self.twist, smoothing);
            sum += wrench_of(&support.offset, &support.next);
            slopes += support.slope_by_twist();
        }
        for row in &mut self.rows {
            row.prepare(&self.twist, smoothing);
            let ContactRow { normal, tangent, friction_coefficient, .. } = row.scaled;
            sum -= row.next.normal * normal;
            slopes += (row.stiffness * normal) * normal.transpose();
            if friction_coefficient > 0.0 {
                sum -= row.next.tangential * tangent;
                slopes += tangent * (row.by_slip * tangent - row.coupling * normal).transpose();
            }
        }
        let step = slopes.lu().solve(&-sum).filter(|step| step.iter().all(|v| v.is_finite()))?;
        Some((step, slopes))
    }

    /// Goes as far along the step as the limits allow; returns that share of it. `None`, with
    /// nothing changed, where forces overflow.
    fn advance(&mut self, step: &Vec3, smoothing: f64) -> Option<f64> {
        let mut share: f64 = 1.0;
        for row in &mut self.rows {
            let (along, across) = (row.scaled.normal.dot(step), row.scaled.tangent.dot(step));
            let normal = row.next.normal - row.stiffness * along - row.force.normal;
            let gap = along + smoothing * normal + row.gap_error(&self.twist, smoothing);
            let tangential = row.next.tangential - row.by_slip * across + row.coupling * along - row.force.tangential;
            if !(gap + normal + tangential).is_finite() {
                return None;
            }
            if gap < 0.0 {
                share = share.min(-SHARE_TO_LIMIT * row.gap / gap);
            }
            if normal < 0.0 {
                share = share.min(-SHARE_TO_LIMIT * row.force.normal / normal);
            }
            row.change = (gap, SideForce { normal, tangential });
        }
        for support in &mut self.supports {
            let next = support.next + support.slope * support.slip(step);
            support.force += share * (next - support.force);
            let size = support.force.norm();
            if size > support.limit {
                support.force *= support.limit / size;
            }
        }
        self.twist += share * step;
        for row in &mut self.rows {
            let (gap, change) = row.change;
            row.gap += share * gap;
            row.force.normal += share * change.normal;
            let limit = row.scaled.friction_coefficient * row.force.normal;
            row.force.tangential = (row.force.tangential + share * change.tangential).clamp(-limit, limit);
        }
        Some(share)
    }

    fn end(self, smoothing: f64, slopes: &Mat3, is_converged: bool, n_iterations: u32) -> Path {
        let Problem { extent, force, .. } = self.problem;
        let slow = smoothing.sqrt();
        let sticks = |k: &usize| self.supports[*k].slip(&self.twist).norm() < slow;
        Path {
            twist: *extent * self.twist,
            ground_forces: self.supports.iter().map(|support| *force * support.force).collect(),
            forces: self
                .rows
                .iter()
                .map(|row| SideForce { normal: force * row.force.normal, tangential: force * row.force.tangential })
                .collect(),
            is_closed: self.rows.iter().map(|row| row.force.normal > row.gap).collect(),
            sticking: (0..self.supports.len()).filter(sticks).collect(),
            is_converged,
            n_iterations,
            inverse: slopes.try_inverse().filter(|inverse| inverse.iter().all(|v| v.is_finite())).unwrap_or_default(),
            stiffness: self.rows.iter().map(|row| row.force.normal / (row.gap + smoothing * row.force.normal)).collect(),
        }
    }
}

impl Support {
    fn slip(&self, twist: &Vec3) -> Vec2 {
        slip_velocity(&self.offset, twist)
    }

    /// Slip, and its smoothed size.
    fn slip_and_speed(&self, twist: &Vec3, smoothing: f64) -> (Vec2, f64) {
        let slip = self.slip(twist);
        (slip, (slip.norm_squared() + smoothing * smoothing).sqrt())
    }

    /// Force without a step of the twist, and its derivative by the slip.
    fn prepare(&mut self, twist: &Vec3, smoothing: f64) {
        let (slip, speed) = self.slip_and_speed(twist, smoothing);
        let turned = self.force * slip.transpose() / (speed * speed);
        self.next = self.limit / speed * slip;
        self.slope = Mat2::from_diagonal_element(self.limit / speed) - 0.5 * (turned + turned.transpose());
    }

    /// Derivative of the wrench by the twist.
    fn slope_by_twist(&self) -> Mat3 {
        let by_turn = perpendicular(&self.offset);
        let turned = self.slope * by_turn;
        Mat3::new(
            self.slope.m11,
            self.slope.m12,
            turned.x,
            self.slope.m21,
            self.slope.m22,
            turned.y,
            turned.x,
            turned.y,
            by_turn.dot(&turned),
        )
    }
}

impl Row {
    fn wrench(&self, force: &SideForce) -> Vec3 {
        force.normal * self.scaled.normal + force.tangential * self.scaled.tangent
    }

    fn slip(&self, twist: &Vec3) -> f64 {
        self.scaled.slip + self.scaled.tangent.dot(twist)
    }

    /// What is missing in the gap variable at the twist and at the force.
    fn gap_error(&self, twist: &Vec3, smoothing: f64) -> f64 {
        self.scaled.gap + self.scaled.normal.dot(twist) + smoothing * self.force.normal - self.gap
    }

    /// Force without a step of the twist, and its derivatives.
    fn prepare(&mut self, twist: &Vec3, smoothing: f64) {
        let Self { scaled: ContactRow { friction_coefficient, .. }, gap, force: SideForce { normal, tangential }, .. } = *self;
        let width = gap + smoothing * normal;
        self.stiffness = normal / width;
        self.next.normal = normal + (smoothing - normal * (gap + self.gap_error(twist, smoothing))) / width;
        if friction_coefficient > 0.0 {
            let slip = self.slip(twist);
            let speed = (slip * slip + smoothing * smoothing).sqrt();
            let share = friction_coefficient * slip / speed;
            self.next.tangential = -share * self.next.normal;
            self.by_slip = (tangential * slip / speed + friction_coefficient * normal) / speed;
            self.coupling = share * self.stiffness;
        }
    }
}

/// Forces of contacts from those of their rows.
pub fn sides_of(forces: &[SideForce]) -> PerContact<SideForce> {
    forces.iter().copied().collect()
}
