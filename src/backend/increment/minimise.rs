//! The increment, from a guess where it is good and from rest elsewhere.

use super::corrector::{Wanted, correct};
use super::potential::{Course, Increment, Potential, Step};
use crate::backend::friction::FrictionSolver;
use crate::math::Vec3;
use crate::model::Ground;

/// Increment that minimises potential plus friction. `length` (m) is the extent of the load, which
/// makes turns and shifts comparable.
pub fn minimise(potential: Potential, ground: &Ground, solver: &mut FrictionSolver, length: f64, guess: Option<Vec3>) -> Increment {
    minimise_step(&mut Step { potential, ground, length }, solver, guess)
}

/// [`minimise`] for a step that is kept.
pub fn minimise_step(step: &mut Step, solver: &mut FrictionSolver, guess: Option<Vec3>) -> Increment {
    let length = step.length;
    let guess = guess.filter(|_| solver.accuracy() == 0.0);
    if let Some(found) = guess.and_then(|guess| correct(step, solver, length, guess, None, Wanted::Only)) {
        return step.found(&found.at, found.mode, found.report);
    }
    step.rest(solver).unwrap_or_else(|| step.descend_from_rest(solver))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::backend::Status;
    use crate::backend::friction::ContactMode;
    use crate::backend::springs::{Attachments, Place, SpringBlocks};
    use crate::math::{Pose, RandomStreams, Stream, Vec2, direction, rotation};
    use crate::model::{PolarSpring, SupportPoint};

    pub(in crate::backend::increment) fn ground() -> Ground {
        let supports = [0.5, 2.6, 4.7].map(|angle| SupportPoint {
            offset: 0.0081333 * direction(angle),
            normal_load: 0.005232,
            friction_coefficient: None,
        });
        Ground { friction_coefficient: 1.4, supports: supports.to_vec() }
    }

    /// A forecast with an error of a tenth leads to the increment that descent from rest finds,
    /// whether the load slips or turns about a support. Newton's method ends at rounding: 1e-12 of
    /// the increment, and of its friction.
    #[test]
    fn a_forecast_leads_where_descent_from_rest_does() {
        let (ground, start) = (ground(), Pose::new(0.1, -0.05, 0.7));
        let mut n_found = [0; 2];
        for case in 0..1000 {
            let streams = RandomStreams::new(case);
            let draw = |k: u64| 2.0 * streams.uniform(Stream::Start, 0, k) - 1.0;
            let n = 1 + case as usize % 3;
            let springs: Vec<PolarSpring> = (0..n as u32).map(|k| spring(0.4 + 2.0 * f64::from(k))).collect();
            let mut held = Attachments::default();
            for (k, spring) in springs.iter().enumerate() {
                let shift = 0.025 * Vec2::new(1.0 + draw(2 * k as u64), draw(2 * k as u64 + 1));
                let tip = start.to_world(&(spring.rest_tip() + rotation(spring.bearing) * shift));
                held.attach(&springs, k, tip, &start);
            }
            let mut blocks = SpringBlocks::default();
            blocks.fill(&springs, &held);
            blocks.start(&Place::of(&start));
            let mut solver = FrictionSolver::new(&ground, 0.0122);
            let mut find = |guess| minimise(Potential::of(&mut blocks, Place::of(&start)), &ground, &mut solver, 0.0122, guess);
            let descended = find(None);
            if descended.mode == ContactMode::Stick || descended.report.status != Status::Converged {
                continue;
            }
            let corrected = find(Some(descended.twist.component_mul(&Vec3::new(1.1, 0.95, 0.9))));
            if corrected.report.n_solves > 1 {
                continue;
            }
            n_found[usize::from(corrected.mode != ContactMode::Slip)] += 1;
            assert_eq!(corrected.mode, descended.mode, "{case}");
            let away = corrected.twist - descended.twist;
            let size = descended.twist.xy().norm() + 0.0122 * descended.twist.z.abs();
            assert!(away.xy().norm() + 0.0122 * away.z.abs() <= 1e-12 * size, "{case}: {away:?} of {descended:?}");
            assert!((corrected.friction - descended.friction).abs() <= 1e-12 * descended.friction, "{case}");
        }
        assert!(n_found[0] > 60 && n_found[1] > 20, "{n_found:?}");
    }

    pub(in crate::backend::increment) fn spring(bearing: f64) -> PolarSpring {
        PolarSpring {
            root: 0.0122 * direction(bearing),
            bearing,
            rest_length: 0.0263,
            radial_stiffness: 0.664,
            torsional_stiffness: 4.52e-4,
            ..PolarSpring::default()
        }
    }
}
