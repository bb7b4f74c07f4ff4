//! Dimensions of a spring for wanted stiffnesses.
//!
//! With B = 2 gamma K_Theta E I the pivots have the stiffnesses k_1 = B / l_1 and k_2 ... k_5 = B /
//! l_2. Hence
//!
//! ```text
//! kappa_tau = B (1 / l_1 + 4 / l_2)
//! kappa_rho = B / l_2^3  s(r / 2 l_2)      s(sin phi) = 2 phi / sin(2 phi)
//! ```
//!
//! where kappa_rho is the secant stiffness at the stretch r, and s = 1 gives the tangent at zero.
//! These are two equations for l_1, l_2 and the width in B. One of the three is given, beside
//! material, depth and rest length. The other two are unique, because l_2^3 / s grows with l_2.

use serde::Serialize;

use super::case::MOST_TURN;
use super::dimensions::Dimensions;
use cohaul::formats::{self, Format, Versioned};
use cohaul::math::bisected;
use cohaul::model::SpringDesign;

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Target {
    /// kappa_rho as the secant stiffness at [`Target::at_stretch_m`].
    pub radial_stiffness_n_per_m: f64,
    /// Stretch of the secant; zero gives the tangent.
    pub at_stretch_m: f64,
    /// kappa_tau, the sum of all pivot stiffnesses.
    pub torsional_stiffness_nm_per_rad: f64,
}

/// The dimension that is given.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Held {
    ShortMemberLengthM(f64),
    FoldedMemberLengthM(f64),
    MemberWidthM(f64),
}

/// A spring to be designed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Wanted {
    pub target: Target,
    pub held: Held,
    pub youngs_modulus_pa: f64,
    pub member_depth_m: f64,
    /// l_0, the distance from root to tip without force.
    pub rest_length_m: f64,
    pub characteristic_radius_factor: f64,
    pub stiffness_coefficient: f64,
}

/// Limits of what can be built.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limits {
    pub least_width_m: f64,
    /// Smallest length of a member over its width. Shorter members deform by shear and at their
    /// ends, which the model leaves out.
    pub least_slenderness: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { least_width_m: 1e-4, least_slenderness: 5.0 }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Made {
    pub dimensions: Dimensions,
    pub rest_length_m: f64,
    pub radial_stiffness_n_per_m: f64,
    pub torsional_stiffness_nm_per_rad: f64,
    /// Slope of the force at zero stretch.
    pub tangent_at_zero_n_per_m: f64,
    pub pivot_stiffnesses_nm_per_rad: [f64; 5],
    /// Stretch at which members are straight.
    pub stretch_limit_m: f64,
    /// Achieved stiffness over wanted stiffness, minus one.
    pub radial_error_share: f64,
    pub torsional_error_share: f64,
}

/// The result of `calibrate design`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DesignReport {
    pub wanted: Wanted,
    pub limits: Limits,
    pub exact: Made,
    /// The design with lengths rounded to a grid; absent without a grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on_grid: Option<Made>,
}

impl Versioned for DesignReport {
    const FORMAT: Format = formats::CALIBRATE_DESIGN;
}

/// The spring that is wanted.
///
/// # Errors
/// When there is none, or none that can be built: what is missing.
pub fn design(wanted: &Wanted, limits: &Limits) -> Result<SpringDesign, String> {
    let target = &wanted.target;
    let (bending, short, folded) = match wanted.held {
        Held::ShortMemberLengthM(short) => {
            let folded = root(0.5 * target.at_stretch_m, |folded| {
                bending_of(target, folded) * (1.0 / short + 4.0 / folded) - target.torsional_stiffness_nm_per_rad
            });
            (bending_of(target, folded), short, folded)
        }
        Held::FoldedMemberLengthM(folded) => {
            if folded <= 0.5 * target.at_stretch_m {
                return Err(format!("folded member: must be longer than half the stretch of {} m, found {folded} m", target.at_stretch_m));
            }
            let bending = bending_of(target, folded);
            (bending, short_member(wanted, bending, folded)?, folded)
        }
        Held::MemberWidthM(width) => {
            let bending = bending_per_moment(wanted) * width.powi(3) * wanted.member_depth_m / 12.0;
            let folded = root(0.5 * target.at_stretch_m, |folded| bending_of(target, folded) - bending);
            (bending, short_member(wanted, bending, folded)?, folded)
        }
    };
    let width = match wanted.held {
        Held::MemberWidthM(width) => width,
        _ => (12.0 * bending / (bending_per_moment(wanted) * wanted.member_depth_m)).cbrt(),
    };
    let made = SpringDesign {
        youngs_modulus: wanted.youngs_modulus_pa,
        member_width: width,
        member_depth: wanted.member_depth_m,
        short_member_length: short,
        folded_member_length: folded,
        link_length: wanted.rest_length_m - short,
        characteristic_radius_factor: wanted.characteristic_radius_factor,
        stiffness_coefficient: wanted.stiffness_coefficient,
    };
    buildable(&made, target, limits).map(|()| made)
}

/// 2 gamma K_Theta E, which is B over the second moment of area.
fn bending_per_moment(wanted: &Wanted) -> f64 {
    2.0 * wanted.characteristic_radius_factor * wanted.stiffness_coefficient * wanted.youngs_modulus_pa
}

/// Value of B that gives the wanted kappa_rho with folded members of this length.
fn bending_of(target: &Target, folded: f64) -> f64 {
    let turn = (target.at_stretch_m / (2.0 * folded)).asin();
    let stiffening = if turn == 0.0 { 1.0 } else { 2.0 * turn / (2.0 * turn).sin() };
    target.radial_stiffness_n_per_m * folded.powi(3) / stiffening
}

/// Length l_1 that gives the wanted kappa_tau (m).
fn short_member(wanted: &Wanted, bending: f64, folded: f64) -> Result<f64, String> {
    let (asked, folds) = (wanted.target.torsional_stiffness_nm_per_rad, 4.0 * bending / folded);
    // The short member is shorter than the whole spring.
    let least = folds + bending / wanted.rest_length_m;
    if asked <= least {
        return Err(format!(
            "torsional stiffness: must be above {least:.4e} N m/rad with a folded member of {:.3} mm and a rest length of {:.3} mm, found {asked:.4e}",
            1e3 * folded,
            1e3 * wanted.rest_length_m
        ));
    }
    Ok(bending / (asked - folds))
}

/// Root of an increasing function that is negative at `low`.
fn root(low: f64, function: impl Fn(f64) -> f64) -> f64 {
    let low = low.max(1e-9);
    let mut high = 2.0 * low;
    while function(high) < 0.0 && high < 1e6 {
        high *= 2.0;
    }
    let [low, high] = bisected([low, high], 100, |middle| function(middle) < 0.0);
    0.5 * (low + high)
}

fn buildable(made: &SpringDesign, target: &Target, limits: &Limits) -> Result<(), String> {
    let (reach, stretch) = (1e3 * MOST_TURN.sin() * 2.0 * made.folded_member_length, 1e3 * target.at_stretch_m);
    if stretch > reach {
        let folded = 1e3 * made.folded_member_length;
        return Err(format!("stretch: must be {reach:.3} mm or less with a folded member of {folded:.3} mm, found {stretch:.3} mm"));
    }
    if made.link_length <= 0.0 {
        let (short, rest) = (1e3 * made.short_member_length, 1e3 * made.rest_length());
        return Err(format!("short member: must be shorter than the rest length of {rest:.3} mm, found {short:.3} mm"));
    }
    if made.member_width < limits.least_width_m {
        let (least, found) = (1e3 * limits.least_width_m, 1e3 * made.member_width);
        return Err(format!(
            "member width: must be {least:.3} mm or more to be cut, found {found:.4} mm: softer material, or longer members, make it wider"
        ));
    }
    for (name, length) in [("short", made.short_member_length), ("folded", made.folded_member_length)] {
        if length < limits.least_slenderness * made.member_width {
            let (least, found, width) = (limits.least_slenderness, 1e3 * length, 1e3 * made.member_width);
            return Err(format!("{name} member: must be {least} widths long or more, found {found:.3} mm at a width of {width:.3} mm"));
        }
    }
    Ok(())
}

impl Made {
    pub fn of(design: &SpringDesign, target: &Target) -> Self {
        let radial = design.secant_radial_stiffness(target.at_stretch_m);
        let torsional = design.torsional_stiffness();
        Self {
            dimensions: Dimensions::of(design),
            rest_length_m: design.rest_length(),
            radial_stiffness_n_per_m: radial,
            torsional_stiffness_nm_per_rad: torsional,
            tangent_at_zero_n_per_m: design.tangent_radial_stiffness(0.0),
            pivot_stiffnesses_nm_per_rad: design.pivot_stiffnesses(),
            stretch_limit_m: 2.0 * design.folded_member_length,
            radial_error_share: radial / target.radial_stiffness_n_per_m - 1.0,
            torsional_error_share: torsional / target.torsional_stiffness_nm_per_rad - 1.0,
        }
    }
}

/// The design with lengths and width rounded to a grid, at the same rest length. `None` if a length
/// rounds to zero, or the members become straight at `stretch`.
pub fn on_grid(design: &SpringDesign, grid: f64, stretch: f64) -> Option<SpringDesign> {
    let on_grid = |length: f64| (length / grid).round() * grid;
    let short = on_grid(design.short_member_length);
    let made = SpringDesign {
        member_width: on_grid(design.member_width),
        short_member_length: short,
        folded_member_length: on_grid(design.folded_member_length),
        link_length: design.rest_length() - short,
        ..*design
    };
    let is_whole = [made.member_width, short, made.folded_member_length, made.link_length].iter().all(|length| *length > 0.0);
    (is_whole && stretch < 2.0 * made.folded_member_length).then_some(made)
}
