//! The verdicts of a comparison of paths, quantity by quantity.

use super::course::{Course, blanks};
use super::difference::{Difference, Jumps};
use super::divergence::{Divergence, PathPair};
use super::parts::{Others, Parts};
use super::quantity::{FirstDivergence, QuantityVerdict, Verdicts};
use super::reduced::Courses;
use super::settings::{FORCES, LEAST_MOTION, OwnMeasure, Settings};
use super::solution::{Point, Solution};
use super::verdict::{Answers, InertiaAnswer, Verdict};
use crate::math::Vec2;
use crate::scenario::Scenario;
use crate::simulation::Row;

/// Two differences of poses and the reference error: inertia effect, engine error, reference error.
pub(super) type Poses<'a> = [&'a Difference; 3];

pub(super) struct Runs<'a> {
    pub scenario: &'a Scenario,
    pub settings: &'a Settings,
    pub own: Option<&'a OwnMeasure<'a>>,
    /// Quasi-static, inertial and rapier.
    pub solutions: &'a [Solution; 3],
    pub extras: &'a Extras,
    /// Jumps of the quasi-static load.
    pub jumps: &'a Jumps,
    /// Inertial beside quasi-static, and rapier beside inertial.
    pub pairs: [&'a PathPair<'a>; 2],
    pub poses: Poses<'a>,
}

/// Runs that tell parts of the inertia effect; `None` where there is nothing to tell.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Extras {
    /// Inertial, with impacts that do not rebound.
    pub without_restitution: Option<Solution>,
    /// Quasi-static without dashpots.
    pub rate_independent: Option<Solution>,
}

impl Runs<'_> {
    /// All verdicts, from the largest edge displacement that counts as agreement (m).
    pub fn verdicts(&self, tolerance: f64) -> Verdicts {
        let Self { scenario, settings, pairs, .. } = self;
        let courses = self.courses();
        let times = &courses.runs[0].times;
        let diverges = |which: usize, time: f64| pairs[which].divergence_at(time);
        let [pull, speed, energy] = least_sizes(scenario);
        let kinetic = self.solutions[1].trace.rows.iter().map(|row| row.energy.kinetic).fold(0.0, f64::max);
        let energy = energy.max(LEAST_MOTION * kinetic);
        let of = |reduced: &[_], share: f64, least: f64, unit| {
            QuantityVerdict::on(reduced, |largest| share * largest.max(least), times, unit, diverges)
        };
        let own = |own: &OwnMeasure| {
            let tolerance = |largest: f64| own.tolerance.unwrap_or((FORCES * largest).max(f64::MIN_POSITIVE));
            QuantityVerdict::on(&courses.own(own.name), tolerance, times, own.unit, diverges)
        };
        let (pulls, contacts, speeds) = (courses.pulls(), courses.contacts(), courses.speeds());
        let mut verdicts = Verdicts {
            path: self.of_poses("m", tolerance, |difference| difference.edge_displacement_max_m, |pair| pair.first_divergence()),
            heading: self.of_poses(
                "rad",
                self.heading_tolerance(),
                |difference| difference.heading_max_rad,
                |pair| pair.first_divergence_of_heading(self.heading_tolerance()),
            ),
            pulls: of(&pulls, settings.tolerance_pull_share, pull, "N"),
            contacts: of(&contacts, settings.tolerance_pull_share, pull, "N"),
            speed: of(&speeds, settings.tolerance_speed_share, speed, "m/s"),
            energy: of(&courses.energy(), settings.tolerance_energy_share, energy, "J"),
            measure: self.own.map(own),
        };
        // Forces of which each law admits others may be equal all the same.
        let may_differ = |of: &Solution| of.steps.is_indeterminate && of.trace.rows.iter().any(Row::touches_two);
        if verdicts.contacts.verdict != Verdict::Agree && self.solutions[..2].iter().any(may_differ) {
            verdicts.contacts.leave_open();
        }
        let reaches = |solution: &Solution| solution.reach(scenario.system.load.radius) > self.least_motion();
        let moves = verdicts.path.verdict.has_inertia() || self.solutions[..2].iter().any(reaches);
        let loses_energy = verdicts.energy.measures.iter().any(|measure| measure.quasi_static.max(measure.inertial) > energy);
        for of_load in [&mut verdicts.path, &mut verdicts.heading, &mut verdicts.speed, &mut verdicts.energy] {
            if !moves && of_load.verdict == Verdict::Agree && (of_load.unit != "J" || !loses_energy) {
                of_load.answer(Answers { inertia: InertiaAnswer::NothingMoved, ..of_load.answers() });
            }
        }
        verdicts
    }

    /// Largest net pull on the load at a tick, with inertia or without, over the sum of all slip
    /// limits (1); `None` without friction.
    pub fn largest_pull_share(&self) -> Option<f64> {
        let rows = self.solutions[..2].iter().flat_map(|solution| &solution.trace.rows);
        let pull = rows.map(|row| row.tips.iter().map(|tip| tip.pull).sum::<Vec2>().norm()).fold(0.0, f64::max);
        let share = pull / self.scenario.system.total_slip_limit();
        share.is_finite().then_some(share)
    }

    /// Length below which the load counts as resting (m).
    fn least_motion(&self) -> f64 {
        least_motion(self.scenario)
    }

    fn of_poses(
        &self,
        unit: &'static str,
        tolerance: f64,
        largest: impl Fn(&Difference) -> f64 + Copy,
        first: impl Fn(&PathPair) -> Option<Divergence>,
    ) -> QuantityVerdict {
        let [inertia_effect, engine_error, reference_error] = self.poses.map(largest);
        let [by_inertia, by_engine] = self.pairs;
        let mut found = QuantityVerdict {
            inertia_effect,
            engine_error,
            reference_error,
            tolerance,
            parts: self.parts_of_poses(largest),
            first_divergence: FirstDivergence { inertia_effect: first(by_inertia), engine_error: first(by_engine) },
            ..QuantityVerdict::of_nothing(unit)
        };
        found.judge();
        found
    }

    /// Parts of the differences between paths, of which `largest` gives a number.
    fn parts_of_poses(&self, largest: impl Fn(&Difference) -> f64) -> Parts {
        let Extras { without_restitution, rate_independent } = self.extras;
        let [quasi_static, inertial, engine] = self.solutions;
        let radius = self.scenario.system.load.radius;
        let between = |a: &[Point], b: &[Point]| largest(&Difference::between(a, b, radius));
        let from_quasi_static = |a: &Solution| largest(&Difference::outside_jumps(&a.points, &quasi_static.points, radius, self.jumps));
        Parts {
            inertia: from_quasi_static(without_restitution.as_ref().unwrap_or(inertial)),
            impact: without_restitution.as_ref().map_or(0.0, |without| between(&inertial.points, &without.points)),
            time_step: between(&engine.points, &engine.limit),
            engine_model: between(&engine.limit, &inertial.points),
            limit_error: largest(&Difference::error_of(&engine.limit, radius)),
            dashpots: rate_independent.as_ref().map_or(0.0, |without| between(&quasi_static.points, &without.points)),
        }
    }

    /// Largest difference of headings that counts as agreement (rad): as given, or by default 0.01
    /// and at least 1 % of the turn. The turn is that without inertia, or the largest from the
    /// start with inertia if that is more.
    fn heading_tolerance(&self) -> f64 {
        const LEAST: f64 = 0.01;
        const SHARE: f64 = 0.01;
        let [quasi_static, inertial, _] = self.solutions;
        let headings = |solution: &Solution| solution.points.iter().map(|point| point.pose.heading).collect::<Vec<_>>();
        let turn = headings(quasi_static).windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, |sum, turn| sum + turn);
        let reach = headings(inertial).iter().map(|heading| (heading - inertial.points[0].pose.heading).abs()).fold(0.0, f64::max);
        self.settings.tolerance_heading_rad.unwrap_or(LEAST.max(SHARE * turn.max(reach)))
    }

    fn courses(&self) -> Courses {
        let Self { scenario, solutions, jumps, .. } = self;
        let blanks: Vec<f64> = solutions.iter().flat_map(|solution| blanks(&solution.trace, scenario)).collect();
        let course = |solution: &Solution, rows: &[Row]| {
            let course = Course::of((solution.kind, solution.computes), rows, &blanks, scenario, jumps);
            match self.own {
                Some(own) => course.with_own((own.of)(rows)),
                None => course,
            }
        };
        let companion = |solution: &Solution| {
            let rows = &solution.trace.companion;
            (!rows.is_empty()).then(|| course(solution, rows))
        };
        let of = |solution: &Solution| course(solution, &solution.trace.rows);
        let engine = &solutions[2];
        let others = Others {
            finer: engine.finer.iter().map(|rows| course(engine, rows)).collect(),
            convergence: engine.convergence,
            without_restitution: self.extras.without_restitution.as_ref().map(of),
            rate_independent: self.extras.rate_independent.as_ref().map(of),
        };
        Courses { runs: solutions.each_ref().map(of), companions: [companion(&solutions[0]), companion(&solutions[1])], others }
    }
}

/// Length below which the load counts as resting (m).
fn least_motion(scenario: &Scenario) -> f64 {
    LEAST_MOTION * scenario.system.load.radius
}

/// Sizes of pull (N), speed (m/s) and energy (J) below which nothing is compared: those of a load
/// that moves by a millionth of its radius, within a control period. A millionth of the kinetic
/// energy is no loss either.
pub(super) fn least_sizes(scenario: &Scenario) -> [f64; 3] {
    let (system, length) = (&scenario.system, least_motion(scenario));
    let stiffness = system.springs.iter().map(|spring| spring.radial_stiffness).fold(0.0, f64::max);
    let (friction, elastic) = (system.total_slip_limit(), stiffness * length);
    // Without friction and springs there is neither a force nor a loss.
    let [force, energy] = [LEAST_MOTION * friction + elastic, (friction + elastic) * length].map(|size| size.max(f64::MIN_POSITIVE));
    [force, length / scenario.control_period, energy]
}
