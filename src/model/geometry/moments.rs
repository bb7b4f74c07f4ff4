//! Area, centroid and second moment of outlines, in closed form.

use std::f64::consts::PI;

use crate::math::Vec2;
use crate::model::{Outline, OutlinePart};

/// Moments of the area of an outline.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AreaMoments {
    /// Area (m^2).
    pub area: f64,
    /// Integral of the position over the area (m^3).
    pub first: Vec2,
    /// Integral of the squared distance from the origin over the area (m^4).
    pub second: f64,
}

impl AreaMoments {
    /// Centroid (m). It is NaN for an outline without area.
    pub fn centroid(&self) -> Vec2 {
        self.first / self.area
    }

    /// Moments of both areas together.
    pub fn plus(self, other: Self) -> Self {
        Self { area: self.area + other.area, first: self.first + other.first, second: self.second + other.second }
    }
}

/// Moments of the area of an outline, the sum of its parts. They are those of the union where parts
/// do not overlap. Polylines have no area.
pub fn area_moments(outline: &Outline) -> AreaMoments {
    outline.parts.iter().map(of_part).fold(AreaMoments::default(), AreaMoments::plus)
}

fn of_part(part: &OutlinePart) -> AreaMoments {
    match part {
        OutlinePart::Disc { centre, radius } => {
            let area = PI * radius * radius;
            AreaMoments { area, first: area * centre, second: area * (0.5 * radius * radius + centre.norm_squared()) }
        }
        OutlinePart::Polygon { corners } => moments_of_polygon(corners),
        OutlinePart::Polyline { .. } => AreaMoments::default(),
    }
}

/// Moments of a polygon that does not cross itself, negative where its corners run clockwise. The
/// polygon is a sum of triangles with one corner in common.
pub fn moments_of_polygon(corners: &[Vec2]) -> AreaMoments {
    let Some((apex, others)) = corners.split_first() else { return AreaMoments::default() };
    let triangles = others.windows(2).map(|edge| of_triangle(apex, &edge[0], &edge[1]));
    triangles.fold(AreaMoments::default(), AreaMoments::plus)
}

/// Moments of a triangle. The second moment about the origin is exact with the weight area / 3 on
/// the midpoints of the sides, since that quadrature is exact for quadratic polynomials.
fn of_triangle(a: &Vec2, b: &Vec2, c: &Vec2) -> AreaMoments {
    let area = 0.5 * (b - a).perp(&(c - a));
    let third = area / 3.0;
    let midpoints = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
    AreaMoments { area, first: third * (a + b + c), second: third * midpoints.iter().map(Vec2::norm_squared).sum::<f64>() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle(low: [f64; 2], high: [f64; 2]) -> Vec<Vec2> {
        [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]].map(Vec2::from).to_vec()
    }

    fn assert_close(found: AreaMoments, area: f64, centroid: [f64; 2], second: f64) {
        // Rounding of sums of some ten products of order one.
        assert!((found.area - area).abs() < 1e-14 * area, "{found:?}");
        assert!((found.centroid() - Vec2::from(centroid)).norm() < 1e-14, "{found:?}");
        assert!((found.second - second).abs() < 1e-14 * second, "{found:?}");
    }

    /// A rectangle about its centre has the second moment A (w^2 + h^2) / 12, a disc A R^2 / 2, and
    /// both have A d^2 more at the distance d (Steiner).
    #[test]
    fn rectangle_and_disc_have_the_moments_of_textbooks() {
        let corners = rectangle([-1.5, -0.5], [1.5, 0.5]);
        assert_close(moments_of_polygon(&corners), 3.0, [0.0, 0.0], 3.0 * (9.0 + 1.0) / 12.0);
        let shifted: Vec<Vec2> = corners.iter().map(|corner| corner + Vec2::new(2.0, -1.0)).collect();
        assert_close(moments_of_polygon(&shifted), 3.0, [2.0, -1.0], 2.5 + 3.0 * 5.0);
        assert_close(area_moments(&Outline::disc(2.0)), 4.0 * PI, [0.0, 0.0], 8.0 * PI);
        let aside = Outline { parts: vec![OutlinePart::Disc { centre: Vec2::new(3.0, 4.0), radius: 2.0 }] };
        assert_close(area_moments(&aside), 4.0 * PI, [3.0, 4.0], 8.0 * PI + 100.0 * PI);
    }

    /// An L of two rectangles, once as a concave polygon and once as a compound.
    #[test]
    fn an_l_shape_is_the_sum_of_its_rectangles() {
        let corners = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]].map(Vec2::from);
        // Areas 3 and 1, centroids (1.5, 0.5) and (0.5, 1.5).
        let centroid = [(3.0 * 1.5 + 0.5) / 4.0, (3.0 * 0.5 + 1.5) / 4.0];
        let second = 3.0 * (9.0 + 1.0) / 12.0 + 3.0 * (2.25 + 0.25) + 2.0 / 12.0 + 2.5;
        assert_close(moments_of_polygon(&corners), 4.0, centroid, second);
        let polygon = |low, high| OutlinePart::Polygon { corners: rectangle(low, high) };
        let compound = Outline { parts: vec![polygon([0.0, 0.0], [3.0, 1.0]), polygon([0.0, 1.0], [1.0, 2.0])] };
        assert_close(area_moments(&compound), 4.0, centroid, second);
    }

    /// Half of a ring of radii 1 and 2: area 3 pi / 2, centroid at 4 (8 - 1) / (9 pi), second
    /// moment pi (16 - 1) / 4. A polygon of n chords is off by about (pi / n)^2.
    #[test]
    fn a_sector_of_a_ring_has_the_moments_of_its_integral() {
        const N: usize = 2000;
        let at = |radius: f64, k: usize| radius * crate::math::direction(PI * k as f64 / N as f64);
        let corners: Vec<Vec2> = (0..=N).map(|k| at(2.0, k)).chain((0..=N).rev().map(|k| at(1.0, k))).collect();
        let found = moments_of_polygon(&corners);
        let slack = 2.0 * (PI / N as f64).powi(2);
        assert!((found.area / (1.5 * PI) - 1.0).abs() < slack);
        assert!((found.centroid() - Vec2::new(0.0, 28.0 / (9.0 * PI))).norm() < slack);
        assert!((found.second / (3.75 * PI) - 1.0).abs() < slack);
    }

    /// parry2d integrates convex polygons and discs with code of its own.
    #[test]
    fn parry_finds_the_same_mass_properties() {
        use parry2d_f64::mass_properties::MassProperties;
        use parry2d_f64::math::Vector;
        let corners = [[0.2, -0.1], [1.3, 0.4], [0.9, 1.5], [-0.4, 1.1]].map(Vec2::from);
        let ours = moments_of_polygon(&corners);
        let parry = MassProperties::from_convex_polygon(1.0, &corners.map(|corner| Vector::new(corner.x, corner.y)));
        assert!((parry.mass() - ours.area).abs() < 1e-14);
        assert!((parry.local_com - Vector::new(ours.centroid().x, ours.centroid().y)).length() < 1e-14);
        let about_centroid = ours.second - ours.area * ours.centroid().norm_squared();
        assert!((parry.principal_inertia() - about_centroid).abs() < 1e-14);
    }
}
