//! The step in the units of the cones, with the sizes that its tolerances refer to.

use smallvec::SmallVec;

use super::types::{ContactRow, ContactSystem, PerContact, SideForce, SideMode};
use crate::backend::friction::ContactMode;
use crate::backend::friction::cones::Cones;
use crate::backend::numerics::{NO_SLIP, RESTS, ROUNDED_SLIP};
use crate::math::{Mat3, Vec2, Vec3};

/// One entry per cone.
pub type PerCone<T> = SmallVec<[T; 8]>;

/// The step in units of the cones.
#[derive(Clone, Debug)]
pub struct Problem<'a> {
    pub cones: &'a Cones,
    pub h: Mat3,
    pub w: Vec3,
    pub rows: PerContact<ContactRow>,
    /// Size of the increment that is looked for: what lengths are compared with.
    pub extent: f64,
    /// Largest overlap without an increment.
    overlap: f64,
    /// Size of the forces: the drive, the limits, and what closing gaps takes.
    pub force: f64,
}

/// Where a search starts.
#[derive(Clone, Copy, Debug)]
pub struct Start<'a> {
    pub twist: &'a Vec3,
    pub ground_forces: &'a [Vec2],
    pub forces: &'a [SideForce],
}

/// An answer in units of the cones.
#[derive(Clone, Debug)]
pub struct Candidate {
    pub twist: Vec3,
    /// Contact mode with the ground; a pinned support is named by its cone.
    pub ground: ContactMode,
    pub ground_forces: PerCone<Vec2>,
    pub forces: PerContact<SideForce>,
    pub modes: PerContact<SideMode>,
    pub are_forces_unique: bool,
    /// Whether the increment satisfies the equations of all its modes.
    pub is_consistent: bool,
    /// Whether a small disturbance of this branch decays.
    pub is_stable: bool,
    pub n_iterations: u32,
}

/// Side contact whose gap and slip are in the unit of length of `cones`, per scaled twist.
fn scaled(row: &ContactRow, cones: &Cones) -> ContactRow {
    // A wrench in units of `force` is dual to a scaled twist, and its virtual work is in units of
    // `force` times `length`.
    let (force, length) = (cones.unit_of_force(), cones.unit_of_length());
    let per_twist = |derivative: &Vec3| force * cones.scaled_gradient(derivative);
    ContactRow { normal: per_twist(&row.normal), tangent: per_twist(&row.tangent), gap: row.gap / length, slip: row.slip / length, ..*row }
}

impl<'a> Problem<'a> {
    /// The step in units of `cones`; `free` is the increment without contacts (scaled), if there is
    /// one.
    pub fn new(cones: &'a Cones, system: &ContactSystem, free: Option<Vec3>) -> Self {
        let (h, w) = cones.scaled(system.hessian, system.drive);
        let rows: PerContact<ContactRow> = system.rows.iter().map(|row| scaled(row, cones)).collect();
        let overlap = rows.iter().map(|row| -row.gap).fold(0.0, f64::max);
        let moved = free.map_or(0.0, |free| free.amax());
        let smallest = || rows.iter().map(|row| row.gap.abs()).filter(|gap| *gap > 0.0).fold(f64::INFINITY, f64::min);
        let extent = Some(moved + overlap).filter(|size| *size > 0.0).unwrap_or_else(smallest);
        let extent = if extent.is_finite() { extent } else { 1.0 };
        let limits: f64 = cones.limits.iter().sum();
        let force = w.amax() + limits + h.diagonal().amax() * overlap;
        Self { cones, h, w, rows, extent, overlap, force: if force > 0.0 { force } else { 1.0 } }
    }

    /// The step with tolerances for an increment of another size (scaled).
    pub fn resized(self, extent: f64) -> Self {
        Self { extent, ..self }
    }

    /// The step without side friction.
    pub fn frictionless(&self) -> Self {
        self.with_rows(self.rows.iter().map(|row| ContactRow { friction_coefficient: 0.0, ..*row }).collect())
    }

    /// The step with other rows.
    pub fn with_rows(&self, rows: PerContact<ContactRow>) -> Self {
        Self { rows, ..self.clone() }
    }

    /// Modes of a load that touches all obstacles without a gap, and sticks to those with friction.
    pub fn touching(&self) -> PerContact<SideMode> {
        let closed = |row: &ContactRow| if row.friction_coefficient > 0.0 { SideMode::Stick } else { SideMode::Slide { forward: true } };
        self.rows.iter().map(|row| if row.gap == 0.0 { closed(row) } else { SideMode::Open }).collect()
    }

    /// Contacts that touch.
    pub fn touching_rows(&self) -> impl Iterator<Item = usize> {
        (0..self.rows.len()).filter(|k| self.rows[*k].gap <= 0.0)
    }

    /// What the lengths after an increment are compared with: its size, unless it is rounding.
    pub fn lengths(&self, twist: &Vec3) -> f64 {
        let size = twist.amax();
        if size > RESTS * self.extent { size.max(self.overlap) } else { self.extent }
    }

    /// Gap of contact k after an increment.
    pub fn gap(&self, k: usize, twist: &Vec3) -> f64 {
        self.rows[k].gap + self.rows[k].normal.dot(twist)
    }

    /// Slip of contact k in the step after an increment.
    pub fn slip(&self, k: usize, twist: &Vec3) -> f64 {
        self.rows[k].slip + self.rows[k].tangent.dot(twist)
    }

    /// Whether the slip of contact k is more than rounding.
    pub fn slips(&self, k: usize, twist: &Vec3) -> bool {
        self.slip(k, twist).abs() > NO_SLIP * self.lengths(twist)
    }

    /// Wrench on the load per normal force of a closed contact.
    pub fn direction_of(&self, k: usize, mode: SideMode) -> Vec3 {
        let row = &self.rows[k];
        match mode {
            SideMode::Slide { forward } => row.normal - if forward { 1.0 } else { -1.0 } * row.friction_coefficient * row.tangent,
            SideMode::Open | SideMode::Stick => row.normal,
        }
    }

    /// Wrench of the obstacles on the load.
    pub fn side_wrench(&self, forces: &[SideForce]) -> Vec3 {
        self.rows.iter().zip(forces).map(|(row, force)| force.normal * row.normal + force.tangential * row.tangent).sum()
    }

    /// Largest violation of the conditions of the step, forces over the forces in it and lengths
    /// over the size of the increment (1).
    pub fn residual(&self, twist: &Vec3, ground_forces: &[Vec2], forces: &[SideForce]) -> f64 {
        let pushes = self.w + self.side_wrench(forces);
        let scale = self.cones.force_scale(&self.h, &pushes, twist);
        let balance = (self.h * twist - pushes + self.cones.wrench(ground_forces)).amax() / scale;
        let ground = (0..self.cones.len()).map(|k| self.ground_residual(k, twist, &ground_forces[k]) / scale);
        let side = (0..self.rows.len()).map(|k| self.side_residual(k, twist, &forces[k]));
        let all = ground.chain(side);
        // Not a number is a violation.
        all.fold(balance, |worst, each| if each <= worst { worst } else { each }).abs()
    }

    /// Force of support k beyond its limit, or across its slip. Slips within rounding have no
    /// direction, and those not far above have one up to an angle.
    fn ground_residual(&self, k: usize, twist: &Vec3, force: &Vec2) -> f64 {
        let (slip, limit) = (self.cones.slip(k, twist), self.cones.limits[k]);
        let (speed, above) = (slip.norm(), force.norm() - limit);
        let angle = ROUNDED_SLIP * self.lengths(twist) / speed;
        if speed == 0.0 || angle >= 1.0 { above } else { above.max(limit - force.dot(&slip) / speed - 0.5 * angle * angle * limit) }
    }

    fn side_residual(&self, k: usize, twist: &Vec3, force: &SideForce) -> f64 {
        let lengths = self.lengths(twist);
        let (gap, slip) = (self.gap(k, twist) / lengths, self.slip(k, twist) / lengths);
        let (p, tau) = (force.normal / self.force, force.tangential / self.force);
        let limit = self.rows[k].friction_coefficient * p;
        let complementary = p.max(0.0).min(gap.max(0.0));
        let against = if self.slips(k, twist) { limit + tau * slip.signum() } else { 0.0 };
        [-gap, -p, complementary, tau.abs() - limit.max(0.0), against].into_iter().fold(0.0, f64::max)
    }

    /// Residual of a candidate (1).
    pub fn residual_of(&self, candidate: &Candidate) -> f64 {
        self.residual(&candidate.twist, &candidate.ground_forces, &candidate.forces)
    }
}
