//! The verdicts of a comparison of paths, quantity by quantity.

use super::course::Course;
use super::difference::{Difference, Jumps};
use super::divergence::{Divergence, PathPair};
use super::quantity::{Courses, FirstDivergence, Open, QuantityVerdict, Verdicts};
use super::settings::{LEAST_MOTION, Settings};
use super::solution::Solution;
use super::verdict::Verdict;
use crate::math::Vec2;
use crate::scenario::Scenario;
use crate::simulation::Row;

/// Two differences of poses and the reference error: inertia effect, engine error, reference error.
pub(super) type Poses<'a> = [&'a Difference; 3];

pub(super) struct Runs<'a> {
    pub scenario: &'a Scenario,
    pub settings: &'a Settings,
    /// Quasi-static, inertial and rapier.
    pub solutions: &'a [Solution; 3],
    /// Jumps of the quasi-static load.
    pub jumps: &'a Jumps,
    /// Inertial beside quasi-static, and rapier beside inertial.
    pub pairs: [&'a PathPair<'a>; 2],
    pub poses: Poses<'a>,
}

impl Runs<'_> {
    /// All verdicts, from the largest edge displacement that counts as agreement (m).
    pub fn verdicts(&self, tolerance: f64) -> Verdicts {
        let Self { scenario, settings, pairs, .. } = self;
        let courses = self.courses();
        let times = &courses.runs[0].times;
        let diverges = |which: usize, time: f64| pairs[which].divergence_at(time);
        let [pull, speed, energy] = least_sizes(scenario);
        let of = |reduced: &[_], share: f64, least: f64, unit| QuantityVerdict::on(reduced, (share, least), times, unit, diverges);
        let (pulls, speeds) = (courses.pulls(), courses.speeds());
        let mut verdicts = Verdicts {
            path: self.of_poses("m", tolerance, |difference| difference.edge_displacement_max_m, |pair| pair.first_divergence()),
            heading: self.of_poses(
                "rad",
                self.heading_tolerance(),
                |difference| difference.heading_max_rad,
                |pair| pair.first_divergence_of_heading(self.heading_tolerance()),
            ),
            pulls: of(&pulls, settings.tolerance_pull_share, pull, "N"),
            speed: of(&speeds, settings.tolerance_speed_share, speed, "m/s"),
            energy: of(&courses.energy(), settings.tolerance_energy_share, energy, "J"),
        };
        let reaches = |solution: &Solution| solution.reach(scenario.system.load.radius) > self.least_motion();
        let moves = verdicts.path.verdict.has_inertia() || self.solutions[..2].iter().any(reaches);
        let loses_energy = verdicts.energy.measures.iter().any(|measure| measure.quasi_static.max(measure.inertial) > energy);
        for of_load in [&mut verdicts.path, &mut verdicts.heading, &mut verdicts.speed, &mut verdicts.energy] {
            if !moves && of_load.verdict == Verdict::Agree && (of_load.unit != "J" || !loses_energy) {
                of_load.verdict = Verdict::NothingMoved;
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
        largest: impl Fn(&Difference) -> f64,
        first: impl Fn(&PathPair) -> Option<Divergence>,
    ) -> QuantityVerdict {
        let [inertia_effect, engine_error, reference_error] = self.poses.map(largest);
        let [by_inertia, by_engine] = self.pairs;
        QuantityVerdict {
            verdict: Verdict::of(inertia_effect, engine_error, reference_error, tolerance),
            inertia_effect,
            engine_error,
            reference_error,
            tolerance,
            unit,
            first_divergence: FirstDivergence { inertia_effect: first(by_inertia), engine_error: first(by_engine) },
            open: Open::default(),
            measures: Vec::new(),
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
        let course = |solution: &Solution, rows: &[Row]| Course::of(solution.kind, rows, &scenario.system, jumps, scenario.control_period);
        let companion = |solution: &Solution| {
            let rows = &solution.trace.companion;
            (!rows.is_empty()).then(|| course(solution, rows))
        };
        Courses {
            runs: solutions.each_ref().map(|solution| course(solution, &solution.trace.rows)),
            companions: [companion(&solutions[0]), companion(&solutions[1])],
        }
    }
}

/// Length below which the load counts as resting (m).
fn least_motion(scenario: &Scenario) -> f64 {
    LEAST_MOTION * scenario.system.load.radius
}

/// Sizes of pull (N), speed (m/s) and energy (J) below which nothing is compared: those of a load
/// that moves by a millionth of its radius, within a control period.
pub(super) fn least_sizes(scenario: &Scenario) -> [f64; 3] {
    let (system, length) = (&scenario.system, least_motion(scenario));
    let stiffness = system.springs.iter().map(|spring| spring.radial_stiffness).fold(0.0, f64::max);
    let (friction, elastic) = (system.total_slip_limit(), stiffness * length);
    // Without friction and springs there is neither a force nor a loss.
    let [force, energy] = [LEAST_MOTION * friction + elastic, (friction + elastic) * length].map(|size| size.max(f64::MIN_POSITIVE));
    [force, length / scenario.control_period, energy]
}
