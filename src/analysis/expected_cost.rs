//! Expected cost of runs, before they start.
//!
//! The number of steps follows from the scenario: at least one in each control period, at a fixed
//! step as many as fit, and under error control with inertia at least one macro-step for every two
//! radians of the fastest oscillation of the load on the springs that may be attached. Steps that a
//! run skips, because the load rests, are not known beforehand. The estimate counts them, so that a
//! run may be cheaper.
//!
//! The times are those of 110 scenes, half of them with obstacles or ants, on a virtual machine at
//! about 3 GHz. How often a load touches an obstacle is not known beforehand either, and the
//! factors of obstacles are means. A run itself tells its time better as soon as a percent of it is
//! done.

use super::compare::{Settings, is_damped};
use super::estimate::step_among_obstacles;
use crate::backend::{BackendKind, BackendOptions, LONGEST_MACRO_STEP};
use crate::model::{Outline, OutlinePart};
use crate::scenario::{Drive, Scenario};

/// Expected cost of one or more runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedCost {
    /// Number of steps; under error control number of macro-steps (1).
    pub n_steps: f64,
    /// Time on one core of a usual processor (s).
    pub time_s: f64,
    /// What the number of steps of the longest run follows from.
    pub limit: CostLimit,
}

/// What the number of steps of a run follows from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CostLimit {
    /// One advance in each control period.
    ControlPeriod,
    /// The length of the step.
    Step,
    /// The fastest oscillation of the load, which each macro-step resolves.
    Oscillation,
    /// The ants, which look about in each control period, take longer than the steps.
    Ants,
}

/// Number of seeds of a comparison over seeds without options (1).
pub const DEFAULT_SEEDS: usize = 8;

/// Time of a step at a fixed step (s), without and for each attached spring and each support.
const STEP: f64 = 0.5e-6;
const STEP_A_SPRING: f64 = 0.02e-6;
const STEP_A_SUPPORT: f64 = 0.04e-6;
/// Time of a step of rapier (s), without and for each joint: one a support, and two a spring.
const ENGINE_STEP: f64 = 3e-6;
const ENGINE_STEP_A_JOINT: f64 = 0.25e-6;

/// Time of a step among obstacles over that of one in the open (1), of an exact backend and of
/// rapier, which builds its world anew for each step and sweeps more often. Contacts cost as much
/// on the mean of scenes in which the load touches something for a part of the time.
const AMONG_OBSTACLES: f64 = 2.0;
const ENGINE_AMONG_OBSTACLES: f64 = 3.0;
/// Time in a step among obstacles for each corner of the load and for each one of an obstacle, and
/// for each obstacle in a step of rapier (s). Most obstacles are far from the load.
const STEP_A_LOAD_CORNER: f64 = 0.05e-6;
const STEP_A_CORNER: f64 = 0.005e-6;
const ENGINE_STEP_AN_OBSTACLE: f64 = 0.5e-6;

/// Time for each ant in a control period (s), without and for each doubling of the corners of
/// obstacles, which are found by a tree: of a hundred ants among a thousand small blocks.
const TICK_AN_ANT: f64 = 0.055e-6;
const TICK_A_DOUBLING: f64 = 0.1e-6;

/// Steps that error control takes in each control period and for each two radians of the fastest
/// oscillation (1). A period or an oscillation takes a macro-step of the run and one of the run
/// beside it. Each has four or five rows of the table, which are ten steps and more.
const STEPS_A_PERIOD: f64 = 15.0;
const STEPS_A_PERIOD_WITH_INERTIA: f64 = 25.0;
const STEPS_AN_OSCILLATION: f64 = 40.0;
/// The same among obstacles, over those in the open (1): where contacts open, close or turn,
/// macro-steps are cut and their steps are searched for. This is the mean of scenes. Where impacts
/// follow each other or a load jams, macro-steps cost up to a hundred times as much.
const CONTROL_AMONG_OBSTACLES: f64 = 1.25;

/// Time of the inertia estimate in the open over that of the run beside it (1). Among obstacles it
/// is a load with inertia, which costs a run of its own.
const ESTIMATE: f64 = 0.25;

/// Time for each spring and each support to begin a run (s).
const START_A_PART: f64 = 1e-6;

/// Time in which ants bring the load to the nest, over that of a straight path at their pulling
/// speed (1):
/// of many ants, and what it is more for one alone. On the paper's scenes 1, 4, 10, 100 and 300
/// ants take 15.6, 4.7, 2.6, 1.8 and 1.7 times as long.
const TRANSPORT: f64 = 1.7;
const TRANSPORT_BY_ONE: f64 = 14.0;

/// Numbers of a scenario that its cost depends on.
struct Extent {
    /// Time until the end, or until the load has probably arrived (s).
    duration: f64,
    n_periods: f64,
    /// Springs that may be attached at once (1).
    n_attached: f64,
    n_springs: f64,
    n_supports: f64,
    n_ants: f64,
    n_obstacles: f64,
    /// Corners of all obstacles and of the load (1). A disc counts as one.
    n_corners: f64,
    n_load_corners: f64,
}

impl Extent {
    fn of(scenario: &Scenario) -> Self {
        let system = &scenario.system;
        let n_corners_of = |outline: &Outline| outline.parts.iter().map(n_corners_of_part).sum::<usize>();
        let n_corners = system.world.obstacles.iter().map(|obstacle| n_corners_of(&obstacle.outline)).sum::<usize>();
        let n_springs = system.springs.len();
        let (n_attached, n_ants, duration) = match &scenario.drive {
            Drive::Tips(paths) => (paths.len().min(n_springs), 0, scenario.duration),
            Drive::Ants(ants) => {
                let n_attached = ants.n_ants.min(n_springs);
                let straight = (scenario.start.pose.position - ants.nest_position).norm() / ants.pull_speed;
                let arrival = straight * (TRANSPORT + TRANSPORT_BY_ONE / n_attached.max(1) as f64);
                (n_attached, ants.n_ants, if arrival > 0.0 { scenario.duration.min(arrival) } else { scenario.duration })
            }
        };
        Self {
            duration,
            n_periods: duration / scenario.control_period,
            n_attached: n_attached as f64,
            n_springs: n_springs as f64,
            n_supports: system.ground.supports.len() as f64,
            n_ants: n_ants as f64,
            n_obstacles: system.world.obstacles.len() as f64,
            n_corners: n_corners as f64,
            n_load_corners: n_corners_of(&system.world.outline).max(1) as f64,
        }
    }

    /// Time of a step at a fixed step (s).
    fn step_time(&self, kind: BackendKind) -> f64 {
        let is_open = self.n_obstacles == 0.0;
        if kind.is_exact() {
            let open = STEP + STEP_A_SPRING * self.n_attached + STEP_A_SUPPORT * self.n_supports;
            let of_corners = STEP_A_LOAD_CORNER * self.n_load_corners + STEP_A_CORNER * self.n_corners;
            return if is_open { open } else { AMONG_OBSTACLES * open + of_corners };
        }
        let open = ENGINE_STEP + ENGINE_STEP_A_JOINT * (2.0 * self.n_attached + self.n_supports);
        if is_open { open } else { ENGINE_AMONG_OBSTACLES * open + ENGINE_STEP_AN_OBSTACLE * self.n_obstacles }
    }

    /// Time in which all ants decide and walk, in the whole run (s).
    fn ants_time(&self) -> f64 {
        self.n_periods * self.n_ants * (TICK_AN_ANT + TICK_A_DOUBLING * (1.0 + self.n_corners).log2())
    }
}

fn n_corners_of_part(part: &OutlinePart) -> usize {
    match part {
        OutlinePart::Disc { .. } => 1,
        OutlinePart::Polygon { corners: points } | OutlinePart::Polyline { points } => points.len(),
    }
}

impl ExpectedCost {
    /// Cost of a run of `scenario` with these options.
    pub fn of_run(scenario: &Scenario, options: &BackendOptions) -> Self {
        Self::of_extent(&Extent::of(scenario), scenario, options)
    }

    fn of_extent(extent: &Extent, scenario: &Scenario, options: &BackendOptions) -> Self {
        let n_periods = extent.n_periods;
        let has_inertia = options.kind.has_inertia();
        let n_wanted = match options.tolerance {
            Some(_) if has_inertia => extent.duration * fastest_rate(scenario) / LONGEST_MACRO_STEP,
            Some(_) => 0.0,
            None => extent.duration / options.step_s,
        };
        let n_steps = n_wanted.max(n_periods);
        let n_fixed = match options.tolerance {
            None => n_steps,
            Some(_) => {
                let of_periods = n_periods * if has_inertia { STEPS_A_PERIOD_WITH_INERTIA } else { STEPS_A_PERIOD };
                let among = if extent.n_obstacles > 0.0 { CONTROL_AMONG_OBSTACLES } else { 1.0 };
                among * (of_periods + n_wanted * STEPS_AN_OSCILLATION)
            }
        };
        let of_steps = n_fixed * extent.step_time(options.kind);
        let of_ants = extent.ants_time();
        let limit = match options.tolerance {
            _ if of_ants > of_steps => CostLimit::Ants,
            // The first step of a period is shorter than the period itself by rounding only.
            _ if n_wanted <= 1.01 * n_periods => CostLimit::ControlPeriod,
            Some(_) => CostLimit::Oscillation,
            None => CostLimit::Step,
        };
        let of_start = START_A_PART * (extent.n_springs + extent.n_supports);
        Self { n_steps, time_s: of_steps + of_ants + of_start, limit }
    }

    /// As [`ExpectedCost::of_run`], with the inertia estimate if the backend has one.
    pub fn of_estimated_run(scenario: &Scenario, options: &BackendOptions) -> Self {
        let run = Self::of_run(scenario, options);
        if options.kind.has_inertia_estimate() { run.and(Self::of_estimate(scenario)) } else { run }
    }

    /// Cost of the inertia estimate beside a quasi-static run.
    fn of_estimate(scenario: &Scenario) -> Self {
        let extent = Extent { n_ants: 0.0, ..Extent::of(scenario) };
        if extent.n_obstacles > 0.0 {
            let step = step_among_obstacles(&scenario.system);
            return Self::of_extent(&extent, scenario, &BackendOptions::new(BackendKind::Inertial, step));
        }
        let options = BackendOptions::at_step(None, BackendKind::QuasiStatic, &scenario.system, scenario.control_period);
        Self::of_extent(&extent, scenario, &options).times(ESTIMATE)
    }

    /// Cost of a comparison of paths: the references and the estimate twice, the runs that tell
    /// parts of the inertia effect once, and rapier at its step and all halvings of it. Ants decide
    /// in one run, which the others replay.
    pub fn of_comparison(scenario: &Scenario, settings: &Settings) -> Self {
        let replayed = Extent { n_ants: 0.0, ..Extent::of(scenario) };
        let reference = |kind| Self::of_extent(&replayed, scenario, &settings.under_error_control(scenario, kind));
        let [quasi_static, inertial] = [BackendKind::QuasiStatic, BackendKind::Inertial].map(reference);
        let engine = Self::of_extent(&replayed, scenario, &settings.at_fixed_step(scenario, BackendKind::Rapier));
        let rate_independent = (is_damped(scenario) && !settings.rate_independent).then_some(quasi_static);
        // It is left out where the load hits nothing, which is not known beforehand.
        let may_rebound = scenario.system.world.obstacles.iter().any(|obstacle| obstacle.restitution > 0.0);
        let without_restitution = may_rebound.then_some(inertial);
        let engine = engine.times(f64::from(settings.halvings + 1).exp2() - 1.0);
        let costs = [quasi_static.times(2.0), inertial.times(2.0), engine, Self::of_estimate(scenario).times(2.0)];
        let costs = costs.into_iter().chain(rate_independent).chain(without_restitution);
        let recorded = matches!(scenario.drive, Drive::Ants(_))
            .then(|| Self::of_run(scenario, &settings.at_fixed_step(scenario, settings.recorded_from)));
        costs.chain(recorded).reduce(Self::and).expect("there are three backends")
    }

    /// Cost of a comparison over seeds: each seed on all three backends.
    pub fn of_closed_loop(scenario: &Scenario, settings: &Settings, n_seeds: usize) -> Self {
        let costs = BackendKind::COMPARED.map(|kind| Self::of_run(scenario, &settings.at_fixed_step(scenario, kind)));
        let one = costs.into_iter().reduce(Self::and).expect("there are three backends");
        one.times(n_seeds as f64)
    }

    /// Cost of `cohaul compare` without options: of paths and, with ants, over [`DEFAULT_SEEDS`].
    pub fn of_compare(scenario: &Scenario) -> Self {
        let (settings, paths) = (Settings::default(), Self::of_comparison(scenario, &Settings::default()));
        match scenario.drive {
            Drive::Tips(_) => paths,
            Drive::Ants(_) => paths.and(Self::of_closed_loop(scenario, &settings, DEFAULT_SEEDS)),
        }
    }

    fn times(self, n: f64) -> Self {
        Self { n_steps: n * self.n_steps, time_s: n * self.time_s, ..self }
    }

    /// Cost of both, with the limit of the longer one.
    pub fn and(self, other: Self) -> Self {
        let limit = if other.time_s > self.time_s { other.limit } else { self.limit };
        Self { n_steps: self.n_steps + other.n_steps, time_s: self.time_s + other.time_s, limit }
    }
}

/// Rate of the fastest oscillation of the load on all springs that may be attached (rad/s).
pub fn fastest_rate(scenario: &Scenario) -> f64 {
    let system = &scenario.system;
    match &scenario.drive {
        Drive::Tips(paths) => system.fastest_rate_on(paths.iter().map(|path| &system.springs[path.spring])),
        Drive::Ants(_) => system.fastest_rate(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(name: &str) -> Scenario {
        Scenario::read(format!("scenarios/{name}.json").as_ref()).unwrap()
    }

    fn time(scenario: &Scenario, kind: BackendKind) -> f64 {
        let options = BackendOptions::at_step(None, kind, &scenario.system, scenario.control_period);
        ExpectedCost::of_run(scenario, &options).time_s
    }

    /// Each doubling of the obstacles costs many ants the same. They take longer than the steps.
    #[test]
    fn ants_pay_for_each_doubling_of_the_obstacles() {
        let mut wall = scene("paper/wall-with-gap");
        wall.duration = 1.0;
        let few = wall.system.world.obstacles.clone();
        let Drive::Ants(ants) = &mut wall.drive else { panic!("it has ants") };
        ants.n_ants = 10_000;
        let mut time_of = |n: usize| {
            wall.system.world.obstacles = few.iter().cycle().take(n).cloned().collect();
            let options = BackendOptions::at_step(None, BackendKind::QuasiStatic, &wall.system, wall.control_period);
            assert_eq!(ExpectedCost::of_run(&wall, &options).limit, CostLimit::Ants);
            time(&wall, BackendKind::QuasiStatic)
        };
        let [first, second, third] = [100, 200, 400].map(&mut time_of);
        assert!(second > first && ((third - second) / (second - first) - 1.0).abs() < 0.05, "{first} {second} {third}");
    }

    #[test]
    fn obstacles_supports_and_seeds_cost_time() {
        let tow = scene("robots/tow-past-corner");
        let mut open = tow.clone();
        open.system.world.obstacles.clear();
        for kind in BackendKind::COMPARED {
            assert!(time(&tow, kind) > 1.5 * time(&open, kind), "{}", kind.name());
        }
        let mut many = open.clone();
        many.system.ground.supports = open.system.ground.supports.iter().cycle().take(100_000).copied().collect();
        (many.duration, many.control_period) = (1e-9, 1e-9);
        assert!(time(&many, BackendKind::QuasiStatic) > 0.05, "the start of a run alone");
        let (ants, settings) = (scene("paper/four-ants-four-springs"), Settings::default());
        let seeds = |n| ExpectedCost::of_closed_loop(&ants, &settings, n).time_s;
        assert!((seeds(32) / seeds(8) - 4.0).abs() < 1e-12);
    }

    /// Each run that a comparison or an estimate adds costs its time.
    #[test]
    fn runs_that_tell_a_part_of_the_effect_cost_time() {
        let cost = |scenario: &Scenario| ExpectedCost::of_comparison(scenario, &Settings::default());
        let controlled =
            |scenario: &Scenario, kind| ExpectedCost::of_run(scenario, &Settings::default().under_error_control(scenario, kind));
        let with_dashpots = |damping_ratio: f64| {
            let mut scene = scene("analytic/ramp-and-hold");
            scene.system.springs[0].damping_ratio = damping_ratio;
            scene
        };
        let rebounding = |restitution: f64| {
            let mut scene = scene("contact/rebound");
            scene.system.world.obstacles.iter_mut().for_each(|obstacle| obstacle.restitution = restitution);
            scene
        };
        let added = [
            (cost(&with_dashpots(0.3)), cost(&with_dashpots(0.0)), controlled(&with_dashpots(0.3), BackendKind::QuasiStatic)),
            (cost(&rebounding(0.5)), cost(&rebounding(0.0)), controlled(&rebounding(0.5), BackendKind::Inertial)),
        ];
        for (with, without, run) in added {
            let [time, steps] = [with.time_s - without.time_s, with.n_steps - without.n_steps];
            assert!((time / run.time_s - 1.0).abs() < 1e-9 && (steps / run.n_steps - 1.0).abs() < 1e-9, "{time:e} {steps:e} {run:?}");
        }
        let settings = Settings { rate_independent: true, ..Settings::default() };
        let damped = with_dashpots(0.3);
        assert!(ExpectedCost::of_comparison(&damped, &settings).time_s < cost(&damped).time_s, "the model without dashpots runs once");
    }

    #[test]
    fn an_estimate_costs_a_run_with_inertia_among_obstacles_alone() {
        let share = |scene: &Scenario, kind| {
            let options = BackendOptions::at_step(None, kind, &scene.system, scene.control_period);
            ExpectedCost::of_estimated_run(scene, &options).time_s / ExpectedCost::of_run(scene, &options).time_s
        };
        let (tow, open) = (scene("robots/tow-past-corner"), scene("analytic/ramp-and-hold"));
        assert!(share(&tow, BackendKind::QuasiStatic) > 1.9 && (1.2..1.3).contains(&share(&open, BackendKind::QuasiStatic)));
        assert_eq!((share(&tow, BackendKind::Inertial), share(&open, BackendKind::Inertial)), (1.0, 1.0));
    }

    /// A load that ants bring to the nest ends its run: a longer duration costs nothing more.
    #[test]
    fn a_run_of_ants_is_expected_to_end_at_the_nest() {
        let ants = scene("paper/ten-ants-ten-springs");
        let longer = Scenario { duration: 10.0 * ants.duration, ..ants.clone() };
        assert_eq!(time(&longer, BackendKind::Inertial), time(&ants, BackendKind::Inertial));
        let shorter = Scenario { duration: 1.0, ..ants.clone() };
        assert!(time(&shorter, BackendKind::Inertial) < 0.1 * time(&ants, BackendKind::Inertial));
    }
}
