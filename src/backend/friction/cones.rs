//! The supports as cones in scaled units: distinct points with positive limits.
//!
//! H and w know the size of the load, friction knows the arms of the supports. Where the arms are
//! far shorter than the load, the unit of length is the size of the load: in units of the arms the
//! moments would outgrow the forces beside them, and their rounding would hide the forces. There,
//! and where the supports are far closer to each other than to the origin, twists are taken about a
//! point among the supports. About the origin the slips would be small differences of large
//! numbers.

use std::collections::HashMap;

use smallvec::SmallVec;

use crate::backend::numerics::{ABOUT_MIDDLE, CLUSTERED, SAME_POINT};
use crate::math::{Mat3, Vec2, Vec3};
use crate::model::Ground;
use crate::model::support::{slip_velocity, wrench_of};
use crate::stop;

/// Cones of one ground. Supports on the same point act as one with the sum of their limits; those
/// without a limit do not act at all.
#[derive(Clone, Debug)]
pub(in crate::backend) struct Cones {
    /// Positions from `centre` over `length`.
    pub offsets: Vec<Vec2>,
    /// Limits over `force`; their sum is one.
    pub limits: Vec<f64>,
    /// Cone of each support and the share of its limit there; `None` for a support without a limit.
    shares: Vec<Option<(usize, f64)>>,
    /// Largest distance of a support from `centre` over `length`, where the supports are close
    /// together compared with the load.
    pub cluster: Option<f64>,
    /// Point that twists are about (m, load axes), unless it is the load's origin.
    centre: Option<Vec2>,
    /// Unit of length (m): the largest distance of a support from there, or the size of the load.
    length: f64,
    /// Unit of force (N): the sum of the limits.
    force: f64,
    /// Scale of each entry of a gradient.
    per_gradient: Vec3,
    /// Scale of each entry of a Hessian.
    per_hessian: Mat3,
    /// (sum_i c_i^2 B_i' B_i)^-1, if the inverse exists: it leads to the least-norm forces for a
    /// wrench, each in units of its limit.
    pub balance: Option<Mat3>,
    /// Largest change of each cone's least force per change of the wrench (Frobenius norm); empty
    /// without a `balance`.
    pub sways: Vec<f64>,
}

/// Points by the cell of a grid that they lie in: one near another is found in a time that does not
/// grow with their number.
struct Places {
    /// Distance up to which points are the same (scaled).
    same: f64,
    cells: HashMap<[i64; 2], SmallVec<[usize; 1]>>,
}

impl Places {
    fn new(same: f64) -> Self {
        Self { same, cells: HashMap::new() }
    }

    /// Cells are twice as wide as points are apart that are the same. Such points then lie in
    /// neighbouring cells, whatever the rounding.
    fn cell(&self, point: &Vec2) -> [i64; 2] {
        [point.x, point.y].map(|along| (along / (2.0 * self.same)).floor() as i64)
    }

    fn add(&mut self, point: &Vec2, index: usize) {
        self.cells.entry(self.cell(point)).or_default().push(index);
    }

    /// The first of these points that is the same as this one.
    fn first_near(&self, point: &Vec2, points: &[Vec2]) -> Option<usize> {
        let [x, y] = self.cell(point);
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x.saturating_add(i), y.saturating_add(j)]));
        let indices = around.filter_map(|cell| self.cells.get(&cell)).flatten().copied();
        indices.filter(|k| (points[*k] - point).norm() <= self.same).min()
    }
}

impl Cones {
    /// Cones of `ground` under a load of size `length_scale` (m).
    pub fn new(ground: &Ground, length_scale: f64) -> Self {
        let force: f64 = ground.slip_limits().sum();
        let carrying: Vec<Vec2> =
            ground.supports.iter().zip(ground.slip_limits()).filter(|(_, c)| *c > 0.0).map(|(s, _)| s.offset).collect();
        let Frame { centre, length, cluster, point } = Frame::of(&carrying, length_scale);
        let force = if force > 0.0 { force } else { 1.0 };
        let units = Vec3::new(length, length, 1.0);
        let mut cones = Cones {
            offsets: Vec::new(),
            limits: Vec::new(),
            shares: Vec::new(),
            cluster,
            centre,
            length,
            force,
            per_gradient: units / (length * force),
            per_hessian: units * units.transpose() / (length * force),
            balance: None,
            sways: Vec::new(),
        };
        let mut places = Places::new(SAME_POINT * cluster.unwrap_or(1.0));
        for (support, limit) in ground.supports.iter().zip(ground.slip_limits()) {
            stop::point();
            let share = (limit > 0.0).then(|| {
                let arm = point.unwrap_or_else(|| centre.map_or(support.offset, |centre| support.offset - centre));
                cones.merge(arm / length, limit / cones.force, &mut places)
            });
            cones.shares.push(share);
        }
        for (cone, share) in cones.shares.iter_mut().flatten() {
            *share /= cones.limits[*cone];
        }
        cones.balance = cones.balance_matrix();
        cones.sways = cones.sways_of(cones.balance.as_ref());
        cones
    }

    /// Number of cones (1).
    pub fn len(&self) -> usize {
        self.limits.len()
    }

    pub fn is_empty(&self) -> bool {
        self.limits.is_empty()
    }

    /// Adds a support; returns its cone and its limit.
    fn merge(&mut self, offset: Vec2, limit: f64, places: &mut Places) -> (usize, f64) {
        if let Some(k) = places.first_near(&offset, &self.offsets) {
            self.limits[k] += limit;
            return (k, limit);
        }
        places.add(&offset, self.len());
        self.offsets.push(offset);
        self.limits.push(limit);
        (self.len() - 1, limit)
    }

    fn balance_matrix(&self) -> Option<Mat3> {
        if self.len() < 2 {
            return None;
        }
        let mut gram = Mat3::zeros();
        for (offset, limit) in self.offsets.iter().zip(&self.limits) {
            gram += limit * limit * slip_gram(offset);
        }
        gram.try_inverse()
    }

    /// c_i^2 |B_i M| in the Frobenius norm, for each cone.
    fn sways_of(&self, balance: Option<&Mat3>) -> Vec<f64> {
        let sway = |balance: &Mat3, offset: &Vec2, limit: f64| {
            let columns = balance.column_iter().map(|column| slip_velocity(offset, &column.into_owned()).norm_squared());
            limit * limit * columns.sum::<f64>().sqrt()
        };
        let of = |balance: &Mat3| self.offsets.iter().zip(&self.limits).map(|(offset, limit)| sway(balance, offset, *limit)).collect();
        balance.map(of).unwrap_or_default()
    }

    /// Largest scaled norm of a wrench with this force (N) and this torque about the load's origin
    /// (N m).
    pub fn scaled_wrench(&self, force: f64, torque: f64) -> f64 {
        let about_centre = torque + self.centre.map_or(0.0, |centre| centre.norm()) * force;
        Vec2::new(force, about_centre / self.length).norm() / self.force
    }

    /// H and w in scaled units; the unit of energy is length times force.
    pub fn scaled(&self, hessian: &Mat3, drive: &Vec3) -> (Mat3, Vec3) {
        (self.scaled_hessian(hessian), self.scaled_gradient(drive))
    }

    /// Scaled Hessian.
    pub fn scaled_hessian(&self, hessian: &Mat3) -> Mat3 {
        let Some(centre) = self.centre else { return hessian.component_mul(&self.per_hessian) };
        let map = Mat3::new(1.0, 0.0, centre.y, 0.0, 1.0, -centre.x, 0.0, 0.0, 1.0);
        (map.transpose() * hessian * map).component_mul(&self.per_hessian)
    }

    /// Scaled gradient or wrench.
    pub fn scaled_gradient(&self, gradient: &Vec3) -> Vec3 {
        let at_centre = |centre: Vec2| Vec3::new(gradient.x, gradient.y, gradient.z + centre.y * gradient.x - centre.x * gradient.y);
        self.centre.map_or(*gradient, at_centre).component_mul(&self.per_gradient)
    }

    /// Twist of the load about its origin (m, m, rad) from a scaled one.
    pub fn unscaled_twist(&self, twist: &Vec3) -> Vec3 {
        let twist = Vec3::new(self.length * twist.x, self.length * twist.y, twist.z);
        self.centre.map_or(twist, |centre| slip_velocity(&-centre, &twist).push(twist.z))
    }

    /// Unit of length (m).
    pub fn unit_of_length(&self) -> f64 {
        self.length
    }

    /// Unit of force (N).
    pub fn unit_of_force(&self) -> f64 {
        self.force
    }

    /// Scaled twist from one of the load about its origin (m, m, rad).
    pub fn scaled_twist(&self, twist: &Vec3) -> Vec3 {
        let at_centre = self.centre.map_or(twist.xy(), |centre| slip_velocity(&centre, twist));
        Vec3::new(at_centre.x / self.length, at_centre.y / self.length, twist.z)
    }

    /// Index in the ground of the first support of a cone.
    pub fn first_support_of(&self, cone: usize) -> usize {
        self.shares.iter().position(|share| share.is_some_and(|(k, _)| k == cone)).expect("a cone comes from a support")
    }

    /// Cone of a support; `None` without a limit.
    pub fn cone_of(&self, support: usize) -> Option<usize> {
        self.shares[support].map(|(cone, _)| cone)
    }

    /// Number of supports, with those that have no limit (1).
    pub fn n_supports(&self) -> usize {
        self.shares.len()
    }

    /// Writes the friction forces on the supports (N, load axes) from the cones' f_i.
    pub fn share_forces(&self, cone_forces: &[Vec2], support_forces: &mut [Vec2]) {
        for (force, share) in support_forces.iter_mut().zip(&self.shares) {
            *force = share.map_or(Vec2::zeros(), |(cone, share)| -cone_forces[cone] * (share * self.force));
        }
    }

    /// Scaled slip of cone k.
    pub fn slip(&self, k: usize, twist: &Vec3) -> Vec2 {
        slip_velocity(&self.offsets[k], twist)
    }

    /// Wrench of forces on the cones, sum_i B_i' f_i (scaled).
    pub fn wrench(&self, forces: &[Vec2]) -> Vec3 {
        self.offsets.iter().zip(forces).map(|(offset, force)| wrench_of(offset, force)).sum()
    }

    /// Writes the full friction forces f_i of a twist that leaves no support at rest.
    pub fn write_slip_forces(&self, twist: &Vec3, forces: &mut [Vec2]) {
        for (k, force) in forces.iter_mut().enumerate() {
            let slip = self.slip(k, twist);
            *force = (self.limits[k] / slip.norm()) * slip;
        }
    }

    /// Index of the cone that slips least.
    pub fn slowest(&self, twist: &Vec3) -> usize {
        let speed = |k: usize| self.slip(k, twist).norm_squared();
        (0..self.len()).min_by(|a, b| speed(*a).total_cmp(&speed(*b))).expect("there is a cone")
    }

    /// Largest violation of the optimality conditions by (twist, forces), over the forces in them.
    pub fn residual(&self, h: &Mat3, w: &Vec3, twist: &Vec3, forces: &[Vec2]) -> f64 {
        let elastic = h * twist;
        let balance = (elastic - w + self.wrench(forces)).amax();
        let cones = (0..self.len()).map(|k| {
            let (slip, force, limit) = (self.slip(k, twist), forces[k], self.limits[k]);
            let above = (force.norm() - limit).max(0.0);
            let speed = slip.norm();
            // A slipping support's force is its limit along the slip. Speeds within rounding of the
            // twist have no direction, and those not far above have one up to an angle.
            let angle = 1e-15 * twist.amax() / speed;
            let aligned = speed == 0.0 || angle >= 1.0;
            let misaligned = if aligned { 0.0 } else { limit - force.dot(&slip) / speed - 0.5 * angle * angle * limit };
            above.max(misaligned)
        });
        cones.fold(balance, f64::max) / self.force_scale(h, w, twist)
    }

    /// Size of the terms of the balance, of which rounding is a share: |w|, the limits and the
    /// largest product in H x.
    pub fn force_scale(&self, h: &Mat3, w: &Vec3, twist: &Vec3) -> f64 {
        let products = (0..3).map(|j| h.column(j).amax() * twist[j].abs()).fold(0.0, f64::max);
        w.amax() + 1.0 + products
    }
}

/// Centre and unit of length of the cones.
struct Frame {
    centre: Option<Vec2>,
    length: f64,
    cluster: Option<f64>,
    /// Common position of all supports (m), if they stand on one point.
    point: Option<Vec2>,
}

impl Frame {
    /// For supports at `offsets` (m) under a load of size `length_scale` (m).
    fn of(offsets: &[Vec2], length_scale: f64) -> Self {
        let extent_about = |centre: Vec2| offsets.iter().map(|offset| (offset - centre).norm()).fold(0.0, f64::max);
        let reach = extent_about(Vec2::zeros());
        let middle = offsets.iter().sum::<Vec2>() / offsets.len().max(1) as f64;
        let extent = extent_about(middle);
        if extent <= SAME_POINT * reach.max(length_scale) {
            // One point has a method of its own, about the origin.
            Self {
                centre: None,
                length: if reach > CLUSTERED * length_scale { reach } else { length_scale },
                cluster: None,
                point: Some(middle),
            }
        } else if extent <= CLUSTERED * length_scale {
            Self { centre: Some(middle), length: length_scale, cluster: Some(extent / length_scale), point: None }
        } else if extent <= ABOUT_MIDDLE * middle.norm() {
            Self { centre: Some(middle), length: extent, cluster: None, point: None }
        } else {
            Self { centre: None, length: reach, cluster: None, point: None }
        }
    }
}

/// B'B of one support at `offset`.
pub(in crate::backend) fn slip_gram(offset: &Vec2) -> Mat3 {
    Mat3::new(1.0, 0.0, -offset.y, 0.0, 1.0, offset.x, -offset.y, offset.x, offset.norm_squared())
}
