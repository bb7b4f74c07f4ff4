//! Which tip a searching ant senses: the nearest tip of a free spring within its sensing range.
//!
//! The tip of a free spring is fixed to the load, so that tips are sorted once into square cells of
//! the load's frame. One comparison excludes an ant that is farther from the load than every tip
//! and its own range. For any other ant, only the cells within its range are searched.

use crate::math::{Mat2, Pose, Vec2, rotation};
use crate::model::PolarSpring;

/// Relative margin of every bound (1). It is far above rounding, so that no tip within range is
/// missed.
const SLACK: f64 = 1e-12;

/// Tips of the free springs of a load.
pub struct Sensing {
    /// Sensing range of an ant (m).
    reach: f64,
    /// Rest position of each tip in the load's frame (m).
    tips: Vec<Vec2>,
    is_free: Vec<bool>,
    n_free: usize,
    /// Largest distance of a tip from the load's origin (m).
    farthest: f64,
    cells: Cells,
}

/// Pose of the load with its rotation matrix.
#[derive(Clone, Copy)]
pub struct Placed {
    pub position: Vec2,
    heading: f64,
    /// Rotation from the load's axes to those of the world.
    pub turn: Mat2,
}

/// Tips that ants can sense at one instant.
pub struct Around<'a> {
    sensing: &'a Sensing,
    load: Placed,
    /// Square of the distance from the load beyond which no tip is within range (m^2).
    far: f64,
    /// Margin of the bounds (m).
    slack: f64,
    /// Whether cells out of range are skipped.
    skips: bool,
}

impl Placed {
    pub fn new(pose: &Pose) -> Self {
        Self { position: pose.position, heading: pose.heading, turn: rotation(pose.heading) }
    }

    /// The load at another pose. The rotation is computed again only for another heading.
    pub fn moved_to(self, pose: &Pose) -> Self {
        if pose.heading == self.heading { Self { position: pose.position, ..self } } else { Self::new(pose) }
    }

    /// Position of a point in the world, equal to [`Pose::to_world`] to the bit (m).
    fn to_world(self, point_in_load: &Vec2) -> Vec2 {
        self.position + self.turn * point_in_load
    }
}

impl Sensing {
    /// A load whose springs are all free.
    pub fn new(springs: &[PolarSpring], reach: f64) -> Self {
        let tips: Vec<Vec2> = springs.iter().map(PolarSpring::rest_tip).collect();
        let farthest = tips.iter().map(|tip| tip.norm()).fold(0.0, f64::max);
        Self { reach, is_free: vec![true; tips.len()], n_free: tips.len(), farthest, cells: Cells::new(&tips), tips }
    }

    pub fn take(&mut self, spring: usize) {
        self.n_free -= usize::from(std::mem::replace(&mut self.is_free[spring], false));
    }

    pub fn free(&mut self, spring: usize) {
        self.n_free += usize::from(!std::mem::replace(&mut self.is_free[spring], true));
    }

    pub fn free_all(&mut self) {
        self.is_free.fill(true);
        self.n_free = self.tips.len();
    }

    pub fn has_free(&self) -> bool {
        self.n_free > 0
    }

    pub fn around(&self, load: Placed, skips: bool) -> Around<'_> {
        let slack = SLACK * (self.farthest + self.reach + load.position.x.abs() + load.position.y.abs());
        let far = self.farthest + self.reach + slack;
        Around { sensing: self, load, far: far * far, slack, skips }
    }
}

impl Around<'_> {
    /// Whether an ant at `position` (m, world) is too far from the load to sense any tip.
    pub fn is_far(&self, position: &Vec2) -> bool {
        self.skips && (position - self.load.position).norm_squared() > self.far
    }

    /// Spring with the nearest free tip within range of `position` that is sensed, and that tip (m,
    /// world). Of equally near tips it is the first.
    pub fn nearest(&self, position: &Vec2, is_sensed: impl Fn(&Vec2) -> bool) -> Option<(usize, Vec2)> {
        let mut nearest = Nearest { distance: f64::INFINITY, found: None };
        let load = &self.load;
        if self.skips {
            let in_load = load.turn.tr_mul(&(position - self.load.position));
            let window = self.sensing.reach + self.slack;
            self.sensing
                .cells
                .within(&in_load, window)
                .flatten()
                .for_each(|spring| self.compare(load, *spring as usize, position, &is_sensed, &mut nearest));
        } else {
            (0..self.sensing.tips.len()).for_each(|spring| self.compare(load, spring, position, &is_sensed, &mut nearest));
        }
        nearest.found
    }

    fn compare(&self, load: &Placed, spring: usize, position: &Vec2, is_sensed: &impl Fn(&Vec2) -> bool, nearest: &mut Nearest) {
        if !self.sensing.is_free[spring] {
            return;
        }
        let tip = load.to_world(&self.sensing.tips[spring]);
        let distance = (tip - position).norm();
        let is_first = || nearest.found.is_none_or(|(found, _)| spring < found);
        let is_nearer = || distance < nearest.distance || distance == nearest.distance && is_first();
        if distance <= self.sensing.reach && is_nearer() && is_sensed(&tip) {
            *nearest = Nearest { distance, found: Some((spring, tip)) };
        }
    }
}

struct Nearest {
    distance: f64,
    found: Option<(usize, Vec2)>,
}

/// A square grid of n x n cells, about as many as there are points, and the points in each.
struct Cells {
    low: Vec2,
    side: f64,
    n: usize,
    /// Index in `points` of the first point of each cell, row by row, and the number of points.
    starts: Vec<usize>,
    points: Vec<u32>,
}

impl Cells {
    fn new(points: &[Vec2]) -> Self {
        let n = (points.len() as f64).sqrt().ceil().max(1.0) as usize;
        let bound =
            |of: fn(f64, f64) -> f64, start: f64| points.iter().fold(Vec2::new(start, start), |b, p| Vec2::new(of(b.x, p.x), of(b.y, p.y)));
        let (low, high) = (bound(f64::min, f64::INFINITY), bound(f64::max, f64::NEG_INFINITY));
        let extent = (high.x - low.x).max(high.y - low.y);
        let side = if extent > 0.0 { extent / n as f64 } else { 1.0 };
        let mut cells = Self { low, side, n, starts: Vec::with_capacity(n * n + 1), points: (0..points.len() as u32).collect() };
        let cell_of = |point: &u32| {
            let [column, row] = cells.at(&points[*point as usize]);
            row * n + column
        };
        let mut sorted = cells.points.clone();
        sorted.sort_by_key(cell_of);
        let starts = (0..=n * n).map(|cell| sorted.partition_point(|point| cell_of(point) < cell)).collect();
        (cells.starts, cells.points) = (starts, sorted);
        cells
    }

    /// Column and row of the cell that contains `point` or is nearest to it.
    fn at(&self, point: &Vec2) -> [usize; 2] {
        // The cast takes negative numbers to zero.
        [(point.x - self.low.x) / self.side, (point.y - self.low.y) / self.side].map(|along| (along as usize).min(self.n - 1))
    }

    /// Points within `reach` of `centre` along both axes, and some others, row by row.
    fn within(&self, centre: &Vec2, reach: f64) -> impl Iterator<Item = &[u32]> {
        let [first, bottom] = self.at(&(centre - Vec2::new(reach, reach)));
        let [last, top] = self.at(&(centre + Vec2::new(reach, reach)));
        (bottom..=top).map(move |row| &self.points[self.starts[row * self.n + first]..self.starts[row * self.n + last + 1]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{RandomStreams, Stream};

    /// Roots in a disc of 12 mm, rest tips up to 40 mm from the origin, some of them on one place.
    fn springs(n: usize) -> Vec<PolarSpring> {
        let streams = RandomStreams::new(3);
        let spring = |j: u32| {
            let [u, v] = streams.uniform_pair(Stream::Scene, j / 2, 0);
            let root = 0.012 * v * Vec2::new((7.0 * u).cos(), (7.0 * u).sin());
            PolarSpring {
                root,
                bearing: 9.0 * u,
                rest_length: 0.028 * v,
                radial_stiffness: 1.0,
                torsional_stiffness: 0.0,
                ..PolarSpring::default()
            }
        };
        (0..n as u32).map(spring).collect()
    }

    #[test]
    fn cells_and_bounds_find_what_a_search_of_all_tips_finds() {
        let streams = RandomStreams::new(5);
        for (n_springs, reach, far_away) in [(1, 0.015, 0.0), (2, 0.015, 0.0), (5, 0.1, 3.0), (300, 0.004, 0.1), (1000, 0.015, 1e3)] {
            let mut sensing = Sensing::new(&springs(n_springs), reach);
            (0..n_springs).filter(|spring| spring % 3 == 2).for_each(|spring| sensing.take(spring));
            let load = Placed::new(&Pose::new(far_away, -far_away, 1.0 + far_away));
            let (quick, slow) = (sensing.around(load, true), sensing.around(load, false));
            let (mut n_found, mut n_far) = (0, 0);
            for ant in 0..4000 {
                let [u, v] = streams.uniform_pair(Stream::Start, ant, 0);
                let position = load.position + 0.08 * Vec2::new(2.0 * u - 1.0, 2.0 * v - 1.0);
                let expected = slow.nearest(&position, |_| true);
                n_far += u32::from(quick.is_far(&position));
                n_found += u32::from(expected.is_some());
                assert_eq!(
                    if quick.is_far(&position) { None } else { quick.nearest(&position, |_| true) },
                    expected,
                    "{n_springs} springs, ant {ant}"
                );
            }
            assert!(n_found > 50 && (n_far > 50 || reach == 0.1), "{n_found} found, {n_far} far");
        }
    }

    #[test]
    fn a_tip_is_sensed_up_to_the_edge_of_the_reach_whatever_is_left_out() {
        let sensing = Sensing::new(&springs(1), 0.015);
        let load = Placed::new(&Pose::new(0.2, 0.1, 2.0));
        let tip = load.to_world(&sensing.tips[0]);
        let out = (tip - load.position).normalize();
        for skips in [true, false] {
            let around = sensing.around(load, skips);
            // A hair is 1e-14 m here: places near 0.2 m round to 3e-17 m, and the slack is 1e-13 m.
            let (inside, outside) = (tip + (0.015 - 1e-14) * out, tip + (0.015 + 1e-14) * out);
            assert!(!around.is_far(&inside) && around.nearest(&inside, |_| true).is_some());
            assert_eq!(around.nearest(&outside, |_| true), None);
        }
        assert!(sensing.around(load, true).is_far(&(tip + 0.016 * out)));
    }
}
