//! Uniform supports against closed forms of the friction of discs and rectangles.

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use cohaul::math::{Vec2, direction, perpendicular};
use cohaul::model::geometry::area_moments;
use cohaul::model::uniform_supports::uniform_supports;
use cohaul::model::{Outline, OutlinePart, SupportPoint};

const COUNTS: [usize; 4] = [12, 24, 48, 96];

fn polygon(list: &[[f64; 2]]) -> Outline {
    Outline { parts: vec![OutlinePart::Polygon { corners: list.iter().copied().map(Vec2::from).collect() }] }
}

fn rectangle(x: f64, y: f64) -> Outline {
    polygon(&[[-x, -y], [x, -y], [x, y], [-x, y]])
}

/// Force and torque about the origin of the friction on supports that turn about `centre`.
fn friction(supports: &[SupportPoint], centre: &Vec2) -> (Vec2, f64) {
    let mut sum = (Vec2::zeros(), 0.0);
    for support in supports {
        let arm = support.offset - centre;
        // A support at the centre of rotation has no friction.
        let force = if arm.norm() == 0.0 { Vec2::zeros() } else { support.normal_load * perpendicular(&arm.normalize()) };
        sum = (sum.0 + force, sum.1 + support.offset.perp(&force));
    }
    sum
}

/// Complete elliptic integrals K and E of this parameter by the arithmetic-geometric mean.
fn elliptic(parameter: f64) -> (f64, f64) {
    let (mut a, mut b, mut sum, mut power) = (1.0, (1.0 - parameter).sqrt(), 0.5 * parameter, 0.5);
    for _ in 0..8 {
        let c = 0.5 * (a - b);
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        power *= 2.0;
        sum += power * c * c;
    }
    (0.5 * PI / a, 0.5 * PI / a * (1.0 - sum))
}

/// Friction of a unit disc under a unit weight that turns about `centre`: integrals of the
/// uniform pressure in closed form.
fn disc_friction(centre: &Vec2) -> (Vec2, f64) {
    let ratio = centre.norm();
    let square = ratio * ratio;
    let (force, torque) = if ratio <= 1.0 {
        let (k, e) = elliptic(square);
        let force = 4.0 / (3.0 * PI * ratio) * ((square + 1.0) * e + (square - 1.0) * k);
        (force, 4.0 / (9.0 * PI) * ((4.0 - 2.0 * square) * e + (square - 1.0) * k))
    } else {
        let (k, e) = elliptic(1.0 / square);
        let force = 4.0 / (3.0 * PI) * ((square + 1.0) * e - (square - 1.0) * k);
        (force, 4.0 * ratio / (9.0 * PI) * ((4.0 - 2.0 * square) * e + (2.0 * square - 5.0 + 3.0 / square) * k))
    };
    (-force * perpendicular(&(centre / ratio)), torque)
}

/// Friction of a rectangle of half sides `x` and `y` under a unit weight that turns about
/// `centre`. With G the mean distance from the centre, the mean unit vector from there is -grad
/// G. Both follow from the integral of the distance over a rectangle with a corner at the
/// centre.
fn rectangle_friction(x: f64, y: f64, centre: &Vec2) -> (Vec2, f64) {
    let part = |a: f64, b: f64| a.abs().powi(3) * a.signum() / 6.0 * (b / a.abs()).asinh();
    let integral = |a: f64, b: f64| a * b * a.hypot(b) / 3.0 + part(a, b) + part(b, a);
    let slope = |a: f64, b: f64| 0.5 * (b * a.hypot(b) + a * a * (b / a.abs()).asinh());
    let (left, right, down, up) = (-x - centre.x, x - centre.x, -y - centre.y, y - centre.y);
    let over = |f: &dyn Fn(f64, f64) -> f64| (f(right, up) - f(left, up) - f(right, down) + f(left, down)) / (4.0 * x * y);
    let mean_direction = Vec2::new(over(&slope), over(&|a, b| slope(b, a)));
    let force = perpendicular(&mean_direction);
    (force, over(&integral) + centre.perp(&force))
}

/// Largest errors of force and torque (over the extent) for centres within 1.5 extents.
fn worst(outline: &Outline, n: usize, exact: impl Fn(&Vec2) -> (Vec2, f64)) -> (f64, f64) {
    let supports = uniform_supports(outline, n, 1.0);
    let extent = outline.extent();
    let mut worst: (f64, f64) = (0.0, 0.0);
    let anywhere = (1..3000).map(|index| {
        // Irrational steps: no centre is on a support or on a line of symmetry.
        let at = |step: f64| 1.5 * extent * (2.0 * (index as f64 * step).fract() - 1.0);
        Vec2::new(at(0.754_877_666_246_693), at(0.569_840_290_998_053))
    });
    let beside = supports.iter().flat_map(|support| (0..16).map(|way| support.offset + 1e-6 * direction(0.1 + TAU * way as f64 / 16.0)));
    for centre in anywhere.chain(beside) {
        let ((force, torque), (true_force, true_torque)) = (friction(&supports, &centre), exact(&centre));
        worst = (worst.0.max((force - true_force).norm()), worst.1.max((torque - true_torque).abs() / extent));
    }
    worst
}

#[test]
fn the_weight_and_its_centre_are_those_of_the_outline() {
    let (x, y) = (5.0 / 4.0, 3.0 / 4.0);
    let l = polygon(&[[-x, -y], [3.0 - x, -y], [3.0 - x, 1.0 - y], [1.0 - x, 1.0 - y], [1.0 - x, 2.0 - y], [-x, 2.0 - y]]);
    let square =
        |at: f64| OutlinePart::Polygon { corners: [[at, 0.0], [at + 1.0, 0.0], [at + 1.0, 1.0], [at, 1.0]].map(Vec2::from).into() };
    let mixed = Outline { parts: vec![OutlinePart::Disc { centre: Vec2::new(-2.0, 1.0), radius: 0.5 }, square(0.0), square(3.0)] };
    for outline in [Outline::disc(0.0122), rectangle(0.0122, 0.008), l, mixed] {
        for n in [3, 4, 16, 97, 1000] {
            let supports = uniform_supports(&outline, n, 0.0157);
            let centroid = area_moments(&outline).centroid();
            let weight: f64 = supports.iter().map(|support| support.normal_load).sum();
            let centre = supports.iter().map(|support| support.normal_load * support.offset).sum::<Vec2>() / weight;
            // Rounding of up to a thousand summands.
            assert!((weight / 0.0157 - 1.0).abs() < 1e-13, "{weight}");
            assert!((centre - centroid).norm() < 1e-13 * outline.extent(), "{centre} {centroid}");
            assert!(supports.iter().all(|support| support.normal_load > 0.0));
            // Cells at the edge of a concave outline are cut, so that there are a few more.
            let n_found = supports.len();
            assert!(n_found >= 3 && (n < 16 || (0.7..1.6).contains(&(n_found as f64 / n as f64))), "{n}: {n_found}");
        }
    }
}

/// 2/3 mu m g R for a disc, exactly; the mean distance from the centre for a rectangle.
#[test]
fn spinning_friction_is_that_of_the_pressure() {
    let spin = |outline: &Outline, n| friction(&uniform_supports(outline, n, 1.0), &Vec2::zeros()).1;
    for n in [3, 8, 12, 24, 48, 96, 1000] {
        // Rounding of the eigenvalues of the Jacobi matrix.
        assert!((spin(&Outline::disc(0.3), n) - 0.2).abs() < 1e-14, "{n}");
    }
    let (x, y): (f64, f64) = (0.9, 0.4);
    let mean = x.hypot(y) / 3.0 + x * x / (6.0 * y) * (y / x).asinh() + y * y / (6.0 * x) * (x / y).asinh();
    for n in COUNTS {
        // Midpoints are too near to the centre by 0.35 to 0.51 of 1 / n.
        let error = spin(&rectangle(x, y), n) / mean - 1.0;
        assert!((-0.52 / n as f64..-0.2 / n as f64).contains(&error), "{n}: {error}");
    }
}

/// The table above. The tolerance is its rounding.
#[test]
fn friction_has_the_stated_accuracy() {
    let side = FRAC_1_SQRT_2;
    let discs = [(0.124, 0.092), (0.059, 0.048), (0.035, 0.027), (0.018, 0.016)];
    let squares = [(0.096, 0.091), (0.047, 0.046), (0.025, 0.025), (0.013, 0.013)];
    let mut sharp = 0;
    for (n, (disc, square)) in COUNTS.into_iter().zip(discs.into_iter().zip(squares)) {
        let found = [
            (worst(&Outline::disc(1.0), n, disc_friction), disc),
            (worst(&rectangle(side, side), n, |centre| rectangle_friction(side, side, centre)), square),
        ];
        for ((force, torque), (force_bound, torque_bound)) in found {
            assert!(force < force_bound && torque < torque_bound, "{n}: {force} {torque}");
            sharp += usize::from(force > 0.9 * force_bound) + usize::from(torque > 0.9 * torque_bound);
        }
    }
    // Bounds that nothing comes near to would state nothing.
    assert_eq!(sharp, 16);
}
