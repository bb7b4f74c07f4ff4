use cohaul::math::{RandomStreams, Stream};
use cohaul::model::SpringDesign;
use cohaul_paper::calibrate::{Held, Limits, Made, Target, Wanted, design, on_grid};

use super::TRUTH;

fn wanted(design: &SpringDesign, at_stretch_m: f64, held: Held) -> Wanted {
    Wanted {
        target: Target {
            radial_stiffness_n_per_m: design.secant_radial_stiffness(at_stretch_m),
            at_stretch_m,
            torsional_stiffness_nm_per_rad: design.torsional_stiffness(),
        },
        held,
        youngs_modulus_pa: design.youngs_modulus,
        member_depth_m: design.member_depth,
        rest_length_m: design.rest_length(),
        characteristic_radius_factor: design.characteristic_radius_factor,
        stiffness_coefficient: design.stiffness_coefficient,
    }
}

fn all_held(design: &SpringDesign) -> [Held; 3] {
    [
        Held::ShortMemberLengthM(design.short_member_length),
        Held::FoldedMemberLengthM(design.folded_member_length),
        Held::MemberWidthM(design.member_width),
    ]
}

fn free(design: &SpringDesign) -> [f64; 4] {
    [design.short_member_length, design.folded_member_length, design.link_length, design.member_width]
}

#[test]
fn the_stiffnesses_of_any_spring_lead_back_to_it_whichever_dimension_is_held() {
    let streams = RandomStreams::new(3);
    for k in 0..200 {
        let [a, b] = streams.uniform_pair(Stream::Scene, 0, k);
        let [c, d] = streams.uniform_pair(Stream::Scene, 1, k);
        let made = SpringDesign {
            short_member_length: 5e-3 + 0.01 * a,
            folded_member_length: 8e-3 + 0.01 * b,
            member_width: 3e-4 + 5e-4 * c,
            youngs_modulus: 1e5 * 1e3f64.powf(d),
            ..TRUTH
        };
        for at in [0.0, 4e-3, 0.8 * 2.0 * made.folded_member_length] {
            for held in all_held(&made) {
                let found = design(&wanted(&made, at, held), &Limits::default()).unwrap();
                for (a, b) in free(&found).into_iter().zip(free(&made)) {
                    // Bisection to the last bit; the difference of two sums in kappa_tau loses up
                    // to two digits.
                    assert!((a / b - 1.0).abs() < 1e-12, "{held:?} at {at}: {a} {b}");
                }
            }
        }
    }
}

/// From the two printed stiffnesses alone: h = 0.8 mm and l_2 = 11.9 mm, as printed.
#[test]
fn the_printed_stiffnesses_give_the_printed_dimensions() {
    let target = Target { radial_stiffness_n_per_m: 0.664, at_stretch_m: 8e-3, torsional_stiffness_nm_per_rad: 4.52e-4 };
    let ask = Wanted { target, ..wanted(&TRUTH, 8e-3, Held::ShortMemberLengthM(9.8e-3)) };
    let found = design(&ask, &Limits::default()).unwrap();
    // Half of the last printed digits.
    assert!((found.folded_member_length - 11.9e-3).abs() < 0.05e-3, "{found:?}");
    assert!((found.member_width - 0.8e-3).abs() < 0.05e-3);
    let made = Made::of(&found, &target);
    assert!(made.radial_error_share.abs() < 1e-13 && made.torsional_error_share.abs() < 1e-13, "{made:?}");
    let rounded = Made::of(&on_grid(&found, 1e-4, 8e-3).unwrap(), &target);
    assert!((rounded.dimensions.folded_member_length_m - 11.9e-3).abs() < 1e-12);
    assert!(rounded.radial_error_share != 0.0 && rounded.radial_error_share.abs() < 2e-3, "{rounded:?}");
    // As the pivots of the paper's spring are pinned to 6 or 7 digits elsewhere.
    assert!((rounded.torsional_stiffness_nm_per_rad / 4.524581e-4 - 1.0).abs() < 2e-7);
}

#[test]
fn what_cannot_be_built_is_refused_with_its_reason() {
    let refused = |radial: f64, torsional: f64, held: Held| {
        let target = Target { radial_stiffness_n_per_m: radial, at_stretch_m: 8e-3, torsional_stiffness_nm_per_rad: torsional };
        design(&Wanted { target, ..wanted(&TRUTH, 8e-3, held) }, &Limits::default()).unwrap_err()
    };
    let short = Held::ShortMemberLengthM(9.8e-3);
    for (radial, torsional, held, words) in [
        (0.664, 4.52e-4, Held::ShortMemberLengthM(0.03), "shorter than the rest length"),
        (0.664, 4.52e-4, Held::FoldedMemberLengthM(3e-3), "longer than half the stretch"),
        (0.664, 4.52e-4, Held::FoldedMemberLengthM(4.1e-3), "stretch: must be 7.101 mm or less"),
        (0.664, 1e-4, Held::MemberWidthM(8e-4), "torsional stiffness: must be above"),
        (664.0, 1e-4, short, "stretch: must be"),
        (6.64e-4, 4.52e-7, short, "to be cut"),
        (66.4, 4.52e-2, short, "widths long"),
    ] {
        let error = refused(radial, torsional, held);
        assert!(error.contains(words), "{held:?}: {error}");
    }
}

/// A hair above what leaves no room for the short member there is a spring, a hair below there is
/// none.
#[test]
fn the_least_torsional_stiffness_is_the_least() {
    let held = Held::FoldedMemberLengthM(TRUTH.folded_member_length);
    let ask = |factor: f64| {
        let base = wanted(&TRUTH, 8e-3, held);
        // The short member as long as the whole spring.
        let bending = TRUTH.pivot_stiffnesses()[0] * TRUTH.short_member_length;
        let least = bending / TRUTH.rest_length() + 4.0 * bending / TRUTH.folded_member_length;
        let target = Target { torsional_stiffness_nm_per_rad: factor * least, ..base.target };
        design(&Wanted { target, ..base }, &Limits::default())
    };
    assert!(ask(1.0 + 1e-6).unwrap().link_length > 0.0);
    assert!(ask(1.0 - 1e-6).is_err());
}
