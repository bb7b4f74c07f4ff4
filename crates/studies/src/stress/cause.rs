//! Outcome -> cause: the first of these facts that holds explains it, in words with its numbers.
//! Each names the quantity and the regime.
//!
//! A fact explains only what it can bring about; the limits stand beside it. What no fact explains
//! is asked for evidence: the same run at an eighth of the step. If its error falls to half or
//! less, the step is the cause. If a run in f32 finishes in f64, single precision is the cause.
//! What is left has no cause.

use std::fmt::Write;

use super::judge::{Outcome, step_radians};
use super::map::Asked;
use super::run::Run;
use crate::methods::Method;
use cohaul::model::SupportPoint;
use cohaul::scenario::Scenario;

/// Share of the rest length within which the torsional force, which goes with its inverse, is ten
/// times that at rest.
const NEAR_ROOT: f64 = 0.1;
/// Step in radians of an oscillation beyond which a first-order step damps or lags by 15 % in each
/// radian, and rapier's sweeps couple axes as strongly as the mass.
const UNRESOLVED: f64 = 0.3;
/// Turn (rad) or displacement (radii) in one step beyond which a quadratic model of the springs
/// says little.
const FAR: f64 = 0.5;
/// Steps within which a stop is no motion but an event: its place in the step decides more than a
/// tenth of the path length.
const FEW_STEPS: f64 = 10.0;
/// Moments of inertia over m R^2 beyond which turning and shifting answer to a force so unlike that
/// sweeps from one to the other hardly converge.
const UNLIKE: f64 = 30.0;
/// Spread of supports over the radius below which friction resists no turning.
const ONE_POINT: f64 = 1e-6;
/// Error that is rounding, which falls or grows with the step as it happens.
const ROUNDING: f64 = 1e-12;
/// Last digits of f32 that a run may lose.
const LOST_DIGITS: f64 = 1e3;
/// Last digits of f32 by which the gap of a contact is known.
const GAP_DIGITS: f64 = 10.0;
/// Residual of a step among obstacles that is close to its tolerance.
const CLOSE: f64 = 1e-8;

/// What is known of a run that did not finish.
pub struct Facts<'a> {
    pub scenario: &'a Scenario,
    pub asked: &'a Asked,
    pub method: Method,
    pub run: &'a Run,
    pub error: Option<f64>,
    /// The error at an eighth of the step, worked out when it is asked for.
    pub finer_error: &'a dyn Fn() -> Option<f64>,
    /// Whether the same engine finishes in double precision, worked out when it is asked for.
    pub finishes_in_double: &'a dyn Fn() -> bool,
}

impl Facts<'_> {
    /// The cause of `outcome`; `None` when nothing explains it.
    pub fn explain(&self, outcome: Outcome) -> Option<String> {
        // What follows from the scene alone comes first: where springs at rest are not resolved,
        // all that happens later is no cause but an effect.
        let cause = self
            .squeezed()
            .or_else(|| self.on_one_point())
            .or_else(|| self.unresolved(step_radians(self.scenario), "at rest"))
            .or_else(|| self.near_root())
            .or_else(|| self.far_in_a_step())
            .or_else(|| self.unresolved(self.run.seen.rate * self.scenario.control_period, "of springs as they came to be"))
            .or_else(|| self.overdamped())
            .or_else(|| self.stops_at_once(outcome))
            .or_else(|| self.pushed_slowly(outcome))
            .or_else(|| self.unlike_inertia(outcome))
            .or_else(|| self.few_digits())
            .or_else(|| self.gap_in_single(outcome))
            .or_else(|| self.close(outcome))
            .or_else(|| self.not_convex(outcome))
            .or_else(|| self.engine_defaults())
            .or_else(|| self.step())
            .or_else(|| self.single_precision())?;
        let residual = self.run.seen.report.residual;
        let has_residual = outcome == Outcome::NotConverged || self.method.has_engine_defaults();
        Some(if has_residual { format!("{cause}; residual {residual:.1e}") } else { cause })
    }

    /// Without springs nothing gives way.
    fn squeezed(&self) -> Option<String> {
        let lack = self.asked.squeeze?;
        Some(format!("a squeeze without a solution: obstacles leave the load {lack:.1e} m less room than it needs"))
    }

    /// The law of a spring with torsion has no limit at its root.
    fn near_root(&self) -> Option<String> {
        let (shortest, swing) = (self.run.seen.shortest, self.run.seen.swing);
        let has_torsion = self.scenario.system.springs.iter().any(|spring| spring.torsional_stiffness > 0.0);
        let near = shortest < NEAR_ROOT && (has_torsion || shortest < 1e-3);
        near.then(|| format!("tip at its spring's root: {shortest:.1e} rest lengths, swing {swing:.1} rad; the law has no limit there"))
    }

    fn far_in_a_step(&self) -> Option<String> {
        let seen = &self.run.seen;
        let (way, turn, tip) = (seen.step_way, seen.step_turn, seen.tip_way);
        match () {
            _ if turn > FAR => Some(format!("the load turns by {turn:.1e} rad in one step")),
            _ if way > FAR && self.scenario.system.springs.is_empty() => None,
            _ if way > FAR => Some(format!("the load moves by {way:.1e} radii in one step")),
            _ if tip > FAR => Some(format!("a tip moves by {tip:.1e} rest lengths in one step")),
            _ => None,
        }
    }

    /// `radians` of an oscillation in one step; `whose` says of which springs.
    fn unresolved(&self, radians: f64, whose: &str) -> Option<String> {
        if radians <= UNRESOLVED || !self.method.kind.has_inertia() {
            return None;
        }
        let mut cause = format!("the step does not resolve the oscillation {whose}: {radians:.1e} rad");
        if !self.method.kind.is_exact() {
            write!(cause, ", h^2 k is {:.1e} of the mass", radians * radians).expect("a string takes all");
        }
        Some(cause)
    }

    /// Step over the time in which the dashpots of all springs take the speed of the load, 2 zeta
    /// omega h each.
    fn overdamped(&self) -> Option<String> {
        let system = &self.scenario.system;
        let damping: f64 = system.springs.iter().map(|spring| system.dashpot(spring).0).sum();
        let ratio = damping * self.scenario.control_period / system.load.mass;
        let is_stiff = ratio > UNRESOLVED && self.method.kind.has_inertia();
        is_stiff.then(|| format!("the step does not resolve the dashpots: h d is {ratio:.1e} of the mass"))
    }

    fn on_one_point(&self) -> Option<String> {
        let ground = &self.scenario.system.ground;
        let total: f64 = ground.supports.iter().map(|support| support.normal_load).sum();
        let carries = |support: &&SupportPoint| support.normal_load > 1e-6 * total;
        let first = ground.supports.iter().find(carries)?;
        let spread = ground.supports.iter().filter(carries).map(|support| (support.offset - first.offset).norm()).fold(0.0, f64::max);
        let spread = spread / self.scenario.system.load.radius;
        (spread < ONE_POINT)
            .then(|| format!("all that carries stands on one point ({spread:.0e} radii): no friction resists turning about it"))
    }

    fn stops_at_once(&self, outcome: Outcome) -> Option<String> {
        let (start, system) = (&self.scenario.start.twist, &self.scenario.system);
        let speed = start.linear.norm();
        let n_steps = speed * system.load.mass / (system.total_slip_limit() * self.scenario.control_period);
        let is_about_places = matches!(outcome, Outcome::Error | Outcome::Drift);
        (is_about_places && speed > 0.0 && n_steps < FEW_STEPS).then(|| format!("the load stops within {n_steps:.1e} steps"))
    }

    /// The engine takes the directions of friction from the last step, and friction that stops the
    /// load within a step has more than one.
    fn pushed_slowly(&self, outcome: Outcome) -> Option<String> {
        let system = &self.scenario.system;
        let is_pushed = !self.method.kind.is_exact() && system.world.obstacles.iter().any(|obstacle| obstacle.path.moves());
        let n_steps = self.run.seen.speed * system.load.mass / (system.total_slip_limit() * self.scenario.control_period);
        let is_about_friction = matches!(outcome, Outcome::Error | Outcome::Drift | Outcome::NotConverged);
        (is_pushed && is_about_friction && n_steps < 1.0)
            .then(|| format!("an obstacle pushes slowly: friction stops the load within {n_steps:.1e} steps of the engine"))
    }

    fn unlike_inertia(&self, outcome: Outcome) -> Option<String> {
        let is_about_sweeps = matches!(outcome, Outcome::NotConverged | Outcome::EnergyFromNowhere) && !self.method.kind.is_exact();
        let (load, supports) = (&self.scenario.system.load, &self.scenario.system.ground.supports);
        let reach = supports.iter().map(|support| support.offset.norm()).fold(load.radius, f64::max);
        let share = load.inertia / (load.mass * reach * reach);
        let is_unlike = !(1.0 / UNLIKE..=UNLIKE).contains(&share);
        let whose = if reach > load.radius { "R the distance of the farthest support" } else { "R the load's radius" };
        (is_unlike && is_about_sweeps).then(|| format!("mass ratio: the moment of inertia is {share:.1e} m R^2, {whose}"))
    }

    /// f32 holds speeds and places to a ten-millionth of themselves, and a step has to be seen
    /// above that.
    fn few_digits(&self) -> Option<String> {
        if !self.method.options(1.0).is_single_precision() {
            return None;
        }
        let (system, seen) = (&self.scenario.system, &self.run.seen);
        let reach = seen.farthest + system.load.radius;
        let digits = seen.rim / (f64::from(f32::EPSILON) * reach);
        let pull = system.total_slip_limit() + seen.peak_force;
        let speeds = pull * self.scenario.control_period / system.load.mass / (f64::from(f32::EPSILON) * seen.speed);
        match () {
            _ if digits < LOST_DIGITS => Some(format!("f32: the whole displacement is {digits:.1e} last digits of the positions")),
            _ if speeds < 10.0 * LOST_DIGITS => Some(format!("f32: forces change the speed by {speeds:.1e} last digits in a step")),
            _ => None,
        }
    }

    /// A contact closes its gap within a step, by a speed that is known to a last digit of the
    /// position over the step.
    fn gap_in_single(&self, outcome: Outcome) -> Option<String> {
        let (system, seen) = (&self.scenario.system, &self.run.seen);
        if !self.method.options(1.0).is_single_precision() || system.world.is_empty() || outcome != Outcome::NotConverged {
            return None;
        }
        let digit = f64::from(f32::EPSILON) * (seen.farthest + system.load.radius);
        let force = GAP_DIGITS * digit * system.load.mass / self.scenario.control_period.powi(2);
        let share = force / (system.total_slip_limit() + seen.peak_force);
        (seen.report.residual <= share)
            .then(|| format!("f32: {GAP_DIGITS} last digits of a gap in one step are {share:.1e} of the friction limit"))
    }

    /// A step among obstacles that misses its tolerance by little has an answer with nearly as many
    /// digits.
    fn close(&self, outcome: Outcome) -> Option<String> {
        let is_contact = self.method.kind.is_exact() && !self.scenario.system.world.is_empty();
        let is_close = self.run.seen.report.residual <= CLOSE && outcome == Outcome::NotConverged;
        (is_contact && is_close).then(|| "a step among obstacles ended close above its tolerance".to_owned())
    }

    /// Where the energy is not convex there is more than one balance, and small differences choose.
    fn not_convex(&self, outcome: Outcome) -> Option<String> {
        let seen = &self.run.seen;
        let can_be = matches!(outcome, Outcome::Error | Outcome::Drift | Outcome::NotConverged | Outcome::EnergyFromNowhere);
        (seen.left_convex && can_be)
            .then(|| format!("a spring left its convex range: swing {:.1} rad, {:.1} rest lengths", seen.swing, seen.shortest))
    }

    fn engine_defaults(&self) -> Option<String> {
        let is_rough = self.method.has_engine_defaults() && self.run.seen.report.residual > 0.0;
        is_rough.then(|| "engine defaults: a sweep in each of four substeps, friction as a box".to_owned())
    }

    /// Evidence: in double precision the same engine finishes.
    fn single_precision(&self) -> Option<String> {
        let is_single = self.method.options(1.0).is_single_precision();
        (is_single && (self.finishes_in_double)()).then(|| "single precision: in double precision the same run finishes".to_owned())
    }

    /// Evidence: the error falls with the step.
    fn step(&self) -> Option<String> {
        let error = self.error.filter(|error| *error > ROUNDING)?;
        let finer = (self.finer_error)()?;
        (finer <= 0.5 * error).then(|| format!("the step is too long: at an eighth of it the error is {finer:.1e} in place of {error:.1e}"))
    }
}
