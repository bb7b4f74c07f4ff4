//! Outlines as barriers to discs that walk: distances and first contacts, in closed form.
//!
//! Only edges and discs are needed for that, so that an outline is taken apart once. A walker is a
//! disc: its first contact with a straight edge is that of a ray with the edge inflated by the
//! radius of the disc, two straight lines and a round cap at each end.

use crate::math::{Mat2, Pose, Vec2, perpendicular, rotation};
use crate::model::{Outline, OutlinePart};

/// Discs and edges of an outline, in the frame of the body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Barrier {
    pieces: Vec<Piece>,
    /// Polygons, which have an inside.
    polygons: Vec<Vec<Vec2>>,
    /// Largest distance of a point of the outline from the origin (m).
    extent: f64,
}

/// A straight edge, or a disc as an edge of length zero with a rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Both ends (m).
    pub ends: [Vec2; 2],
    /// Radius of a disc; zero for an edge (m).
    pub rounding: f64,
}

/// A barrier at a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedBarrier {
    barrier: Barrier,
    position: Vec2,
    turn: Mat2,
    heading: f64,
}

/// Distance from an outline and the direction in which it grows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Distance from the outline, negative inside of it (m).
    pub distance: f64,
    /// Unit vector away from the outline.
    pub normal: Vec2,
}

/// Contact of a disc that moves straight ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstContact {
    /// Displacement of the disc up to the contact (m).
    pub distance: f64,
    /// Piece that it touches, in world axes.
    pub piece: Piece,
}

impl Barrier {
    /// Barrier of this outline.
    pub fn of(outline: &Outline) -> Self {
        let mut barrier = Self { extent: outline.extent(), ..Self::default() };
        let edge = |from: &Vec2, to: &Vec2| Piece { ends: [*from, *to], rounding: 0.0 };
        for part in &outline.parts {
            match part {
                OutlinePart::Disc { centre, radius } => barrier.pieces.push(Piece { ends: [*centre; 2], rounding: *radius }),
                OutlinePart::Polyline { points } => barrier.pieces.extend(points.windows(2).map(|ends| edge(&ends[0], &ends[1]))),
                OutlinePart::Polygon { corners } => {
                    let next = corners.iter().cycle().skip(1);
                    barrier.pieces.extend(corners.iter().zip(next).map(|(from, to)| edge(from, to)));
                    barrier.polygons.push(corners.clone());
                }
            }
        }
        barrier
    }

    /// Distance of a point in the frame of the body; `None` for an outline without parts.
    fn gap(&self, point: &Vec2) -> Option<Gap> {
        let nearest = self.pieces.iter().map(|piece| piece.gap(point)).min_by(|a, b| a.distance.total_cmp(&b.distance))?;
        let is_inside = nearest.distance > 0.0 && self.polygons.iter().any(|corners| contains(corners, point));
        Some(if is_inside { Gap { distance: -nearest.distance, normal: -nearest.normal } } else { nearest })
    }
}

/// Whether a polygon contains a point: a ray from it crosses the edge an odd number of times.
fn contains(corners: &[Vec2], point: &Vec2) -> bool {
    let next = corners.iter().cycle().skip(1);
    let crosses = |(from, to): &(&Vec2, &Vec2)| {
        (from.y > point.y) != (to.y > point.y) && point.x < from.x + (to.x - from.x) * (point.y - from.y) / (to.y - from.y)
    };
    corners.iter().zip(next).filter(crosses).count() % 2 == 1
}

impl Piece {
    fn gap(&self, point: &Vec2) -> Gap {
        let [from, to] = &self.ends;
        let along = to - from;
        let share = if along.norm_squared() > 0.0 { ((point - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0) } else { 0.0 };
        let away = point - (from + share * along);
        let distance = away.norm();
        // A point on an edge leaves it to the right of the edge, where the outside of a polygon is.
        let normal = if distance > 0.0 { away / distance } else { (-perpendicular(&along)).try_normalize(0.0).unwrap_or_else(Vec2::x) };
        Gap { distance: distance - self.rounding, normal }
    }

    /// Displacement along the unit vector `ahead` after which a disc of this radius touches the
    /// piece (m); `None` where it passes or leaves the piece. It is zero for a disc that overlaps
    /// the piece and comes closer.
    fn first_contact(&self, from: &Vec2, ahead: &Vec2, radius: f64) -> Option<f64> {
        let (reach, [start, end]) = (radius + self.rounding, &self.ends);
        let gap = self.gap(from);
        if gap.distance <= radius {
            return (gap.normal.dot(ahead) < 0.0).then_some(0.0);
        }
        let length = (end - start).norm();
        if length > 0.0 {
            let along = (end - start) / length;
            let (height, rise) = (along.perp(&(from - start)), along.perp(ahead));
            if height.abs() >= reach && height * rise < 0.0 {
                let distance = (height.abs() - reach) / rise.abs();
                let at = along.dot(&(from + distance * ahead - start));
                if (0.0..=length).contains(&at) {
                    return Some(distance);
                }
            }
        }
        let caps = self.ends.iter().filter_map(|centre| disc_contact(&(centre - from), ahead, reach));
        caps.min_by(f64::total_cmp)
    }
}

/// Distance along the unit vector `ahead` at which a ray from the origin enters the disc of this
/// radius about `centre` (m).
fn disc_contact(centre: &Vec2, ahead: &Vec2, radius: f64) -> Option<f64> {
    let (along, across) = (ahead.dot(centre), ahead.perp(centre));
    (along > 0.0 && across.abs() < radius).then(|| along - ((radius - across) * (radius + across)).sqrt())
}

impl PlacedBarrier {
    /// A barrier at a pose.
    pub fn new(barrier: Barrier, pose: &Pose) -> Self {
        Self { barrier, position: pose.position, turn: rotation(pose.heading), heading: pose.heading }
    }

    /// Moves the barrier to another pose.
    pub fn move_to(&mut self, pose: &Pose) {
        self.position = pose.position;
        if pose.heading != self.heading {
            (self.turn, self.heading) = (rotation(pose.heading), pose.heading);
        }
    }

    /// Corners of the box about the outline, in world axes (m); `None` for one without parts.
    pub fn bounds(&self) -> Option<[Vec2; 2]> {
        let of_end = |end: &Vec2, rounding: f64| {
            let centre = self.position + self.turn * end;
            [centre.add_scalar(-rounding), centre.add_scalar(rounding)]
        };
        let boxes = self.barrier.pieces.iter().flat_map(|piece| piece.ends.iter().map(|end| of_end(end, piece.rounding)));
        boxes.reduce(|[least, most], [low, high]| [least.inf(&low), most.sup(&high)])
    }

    /// Whether a point may be within `reach` (m) of the outline, by its distance from the origin.
    pub fn is_near(&self, point: &Vec2, reach: f64) -> bool {
        let far = self.barrier.extent + reach;
        (point - self.position).norm_squared() <= far * far
    }

    /// Distance of a point from the outline (m, world); `None` for an outline without parts. It is
    /// exact outside and inside of one part; inside of several parts that overlap it is that of the
    /// nearest edge, which may lie inside of another part.
    pub fn gap(&self, point: &Vec2) -> Option<Gap> {
        let gap = self.barrier.gap(&self.turn.tr_mul(&(point - self.position)))?;
        Some(Gap { normal: self.turn * gap.normal, ..gap })
    }

    /// First contact of a disc of `radius` (m) about `from` that moves along the unit vector
    /// `ahead` by at most `length` (m).
    pub fn first_contact(&self, from: &Vec2, ahead: &Vec2, length: f64, radius: f64) -> Option<FirstContact> {
        if !self.is_near(from, radius + length) {
            return None;
        }
        let (from, ahead) = (self.turn.tr_mul(&(from - self.position)), self.turn.tr_mul(ahead));
        let contacts = self.barrier.pieces.iter().filter_map(|piece| Some((piece.first_contact(&from, &ahead, radius)?, piece)));
        let (distance, piece) = contacts.filter(|(distance, _)| *distance <= length).min_by(|a, b| a.0.total_cmp(&b.0))?;
        let to_world = |end: Vec2| self.position + self.turn * end;
        Some(FirstContact { distance, piece: Piece { ends: piece.ends.map(to_world), rounding: piece.rounding } })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{RandomStreams, Stream, direction};
    use crate::model::geometry::{closest_point, first_hit};

    const HERE: Pose = Pose { position: Vec2::new(0.0, 0.0), heading: 0.0 };

    fn points(list: &[[f64; 2]]) -> Vec<Vec2> {
        list.iter().copied().map(Vec2::from).collect()
    }

    fn l_shape() -> OutlinePart {
        OutlinePart::Polygon { corners: points(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]) }
    }

    fn wall() -> OutlinePart {
        OutlinePart::Polyline { points: points(&[[-2.0, -1.0], [-1.0, -1.0], [-1.0, 0.5]]) }
    }

    fn disc() -> OutlinePart {
        OutlinePart::Disc { centre: Vec2::new(2.5, 2.5), radius: 0.6 }
    }

    fn placed(parts: &[OutlinePart], at: &Pose) -> PlacedBarrier {
        PlacedBarrier::new(Barrier::of(&Outline { parts: parts.to_vec() }), at)
    }

    /// parry2d answers the same with other algorithms, up to 5e-9 of the size for distances of
    /// polygons. Its ray is a disc of radius zero.
    #[test]
    fn parry_finds_the_same_distances_and_hits() {
        let streams = RandomStreams::new(2);
        let (mut n_hits, mut n_inside) = (0, 0);
        for case in 0..3000 {
            let draw = |k: u64| 8.0 * streams.uniform(Stream::Scene, case, k) - 4.0;
            let parts = if case % 2 == 0 { vec![l_shape()] } else { vec![wall(), disc()] };
            let at = Pose::new(draw(0), draw(1), draw(2));
            let outline = Outline { parts };
            let barrier = placed(&outline.parts, &at);
            let from = at.to_world(&Vec2::new(draw(3), draw(4)));
            let (ours, theirs) = (barrier.gap(&from).unwrap(), closest_point(&outline, &at, &from).unwrap());
            n_inside += u32::from(theirs.distance < 0.0);
            if theirs.distance > 0.0 {
                assert!((ours.distance - theirs.distance).abs() < 1e-7, "{case}: {ours:?} {theirs:?}");
                assert!((from - ours.distance * ours.normal - theirs.point).norm() < 1e-6, "{case}");
            }
            assert_eq!(ours.distance < 0.0, theirs.distance < 0.0, "{case}");
            let ahead = direction(draw(5));
            let found = barrier.first_contact(&from, &ahead, 5.0, 0.0).map(|contact| contact.distance);
            let hit = first_hit(&outline, &at, &from, &(from + 5.0 * ahead)).map(|share| 5.0 * share);
            if ours.distance > 0.0 {
                assert_eq!(found.is_some(), hit.is_some(), "{case}");
                n_hits += u32::from(hit.is_some());
                assert!((found.unwrap_or(0.0) - hit.unwrap_or(0.0)).abs() < 1e-7, "{case}: {found:?} {hit:?}");
            }
        }
        assert!(n_hits > 300 && n_inside > 100, "{n_hits} hits, {n_inside} inside");
    }

    /// A disc of radius 0.2 meets a wall at a height of 0.2 over it, and its end where the distance
    /// from it is 0.2.
    #[test]
    fn a_disc_touches_edges_and_ends() {
        let barrier = placed(&[OutlinePart::Polyline { points: points(&[[-1.0, 0.0], [1.0, 0.0]]) }], &HERE);
        let down = |x: f64| barrier.first_contact(&Vec2::new(x, 1.0), &Vec2::new(0.0, -1.0), 2.0, 0.2).map(|contact| contact.distance);
        // Rounding of lengths of order one.
        assert!((down(0.3).unwrap() - 0.8).abs() < 1e-15);
        assert!((down(1.12).unwrap() - (1.0 - 0.16)).abs() < 1e-15);
        assert_eq!(down(1.2 + 1e-12), None);
        assert!(down(1.2 - 1e-12).is_some());
        // A disc that touches the wall may move along it and away from it.
        let leaves = |ahead: [f64; 2]| barrier.first_contact(&Vec2::new(0.0, 0.2), &ahead.into(), 2.0, 0.2);
        assert!(leaves([1.0, 0.0]).is_none() && leaves([0.0, 1.0]).is_none());
        assert_eq!(leaves([0.6, -0.8]).unwrap().distance, 0.0);
    }

    /// In a frame that is turned, the distances are the same.
    #[test]
    fn a_barrier_moves_with_its_body() {
        let mut barrier = placed(&[l_shape()], &Pose::new(9.0, 9.0, 9.0));
        let at = Pose::new(5.0, -7.0, 2.1);
        barrier.move_to(&at);
        let (above, inside) = (at.to_world(&Vec2::new(2.0, 1.5)), at.to_world(&Vec2::new(2.0, 0.8)));
        // Rounding of positions of order ten.
        assert!((barrier.gap(&above).unwrap().distance - 0.5).abs() < 1e-14);
        let gap = barrier.gap(&inside).unwrap();
        assert!((gap.distance + 0.2).abs() < 1e-14 && (gap.normal - direction(2.1 + 0.5 * std::f64::consts::PI)).norm() < 1e-13);
        assert!(barrier.is_near(&at.position, 0.0));
        assert!(!barrier.is_near(&(at.position + Vec2::new(3.5, 0.0)), 0.1));
    }
}
