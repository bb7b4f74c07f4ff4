//! Friction problems of a run, and the residual of an answer.

use cohaul::backend::increment::{in_body_increments, positive_definite};
use cohaul::backend::springs::Attachments;
use cohaul::backend::{BackendKind, BackendOptions};
use cohaul::math::{Mat3, Vec2, Vec3, rotation};
use cohaul::model::Ground;
use cohaul::model::support::{slip_velocity, wrench_of};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Row, Simulation};

/// Minimise `1/2 x'Hx - w'x + sum_i c_i |B_i x|` over the body-twist increment x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Problem {
    /// (N/m, N, N m/rad)
    pub hessian: Mat3,
    /// w (N, N, N m).
    pub drive: Vec3,
}

/// The first problem of each of up to `n` steps, a control period each, of a quasi-static run of
/// the scenario in which some spring is held, from the first step in which the load moves.
pub fn problems_of(scenario: &Scenario, n: usize) -> Vec<Problem> {
    let options = BackendOptions::new(BackendKind::QuasiStatic, scenario.control_period);
    let mut run = Simulation::new(scenario, &options, Keep::Trace);
    let start = scenario.start.pose;
    let mut n_held = 0;
    while n_held <= n && !run.is_finished() {
        run.step();
        let has_moved = |row: &Row| row.motion.pose != start;
        n_held += usize::from(run.trace().rows.last().is_some_and(|row| has_moved(row) && !row.tips.is_empty()));
    }
    let (springs, length) = (&scenario.system.springs, scenario.system.load.radius);
    let problem = |pair: &[Row]| {
        let pose = pair[0].motion.pose;
        let mut held = Attachments::default();
        for tip in &pair[1].tips {
            held.attach(springs, tip.spring, tip.position, &pose);
        }
        let local = in_body_increments(&held.reaction(springs, &pose), &rotation(pose.heading));
        (!held.is_empty()).then(|| Problem { hessian: positive_definite(&local.hessian, length), drive: -local.gradient })
    };
    let pairs = run.trace().rows.windows(2).skip_while(|pair| pair[1].motion.pose == start);
    pairs.filter_map(problem).take(n).collect()
}

/// Slip over the load's extent (1) below which a support counts as sticking: the direction of such
/// a slip is rounding.
const LEAST_SLIP: f64 = 1e-9;

/// What is left of the optimality conditions at the increment with these friction resistances (N,
/// load axes), over the forces in them (1): balance, limits, and that a support that slips is
/// resisted by its limit, along its slip.
pub fn kkt_residual(ground: &Ground, length: f64, problem: &Problem, increment: &Vec3, resistances: &[Vec2]) -> f64 {
    let units = Vec3::new(1.0, 1.0, length);
    let wrench = |offset: &Vec2, force: &Vec2| wrench_of(offset, force).component_div(&units);
    let scale = ground.slip_limits().sum::<f64>() + problem.drive.component_div(&units).norm();
    let supports = || ground.supports.iter().zip(ground.slip_limits()).zip(resistances);
    let linear = (problem.hessian * increment - problem.drive).component_div(&units);
    let balance = supports().fold(linear, |sum, ((support, _), force)| sum + wrench(&support.offset, force)).amax();
    let fastest = supports().map(|((support, _), _)| slip_velocity(&support.offset, increment).norm()).fold(LEAST_SLIP * length, f64::max);
    let worst = supports().map(|((support, limit), force)| {
        let slip = slip_velocity(&support.offset, increment);
        let lacking = (limit * slip.norm() - force.dot(&slip)).abs() / fastest;
        (force.norm() - limit).max(lacking)
    });
    worst.fold(balance, f64::max) / scale
}
