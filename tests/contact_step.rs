//! One linear step with ground friction and side contacts: conditions of Coulomb's law for random
//! steps, clarabel for those without side friction, invariances, and squeezes.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use cohaul::backend::contact::{
    ContactRow, ContactSolution, ContactSystem, Ending, SideMode, Stage, certificate, mode_newton, solve_contacts,
};
use cohaul::backend::friction::{ContactMode, FrictionSolver};
use cohaul::math::{Mat3, RandomStreams, Stream, Vec2, Vec3, direction, perpendicular};
use cohaul::model::support::{slip_velocity, wrench_of};
use cohaul::model::{Ground, SupportPoint};
use nalgebra::{DMatrix, DVector};

#[path = "common/convex.rs"]
mod convex;

use convex::step_with_contacts;

/// Uniform draws in (0, 1), one after the other.
struct Draws {
    streams: RandomStreams,
    n: u64,
}

impl Draws {
    fn new(seed: u64) -> Self {
        Self { streams: RandomStreams::new(seed), n: 0 }
    }

    fn unit(&mut self) -> f64 {
        self.n += 1;
        self.streams.uniform(Stream::Start, 0, self.n)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize % n
    }

    fn sign(&mut self) -> f64 {
        if self.unit() < 0.5 { -1.0 } else { 1.0 }
    }

    fn direction(&mut self) -> Vec2 {
        direction(TAU * self.unit())
    }
}

/// Walls and posts about a load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Geometry {
    Flat,
    Corner,
    Wedge,
    Posts,
}

/// Springs and drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Load {
    /// A drive of about the friction of the ground.
    Driven,
    /// A drive within a hundredth to a ten-millionth of the limit of slipping.
    NearRest,
    /// A drive that turns the load about one support while nothing touches.
    Pinned,
}

#[derive(Clone, Debug)]
struct Step {
    ground: Ground,
    size: f64,
    hessian: Mat3,
    drive: Vec3,
    rows: Vec<ContactRow>,
}

impl Step {
    fn system(&self) -> ContactSystem<'_> {
        ContactSystem { hessian: &self.hessian, drive: &self.drive, rows: &self.rows }
    }

    fn solve(&self) -> ContactSolution {
        solve_contacts(&self.system(), &mut FrictionSolver::new(&self.ground, self.size), None)
    }

    fn certificate(&self, solution: &ContactSolution) -> f64 {
        let solver = FrictionSolver::new(&self.ground, self.size);
        certificate(&self.system(), &solver, &solution.increment, &solution.ground_forces, &solution.forces)
    }
}

fn row(point: Vec2, normal: Vec2, gap: f64, friction_coefficient: f64) -> ContactRow {
    let tangent = perpendicular(&normal);
    ContactRow { normal: wrench_of(&point, &normal), tangent: wrench_of(&point, &tangent), gap, slip: 0.0, friction_coefficient }
}

fn ground(draws: &mut Draws, size: f64) -> Ground {
    let n = 1 + draws.below(6);
    let weight = draws.log_between(1e-6, 1e3);
    let (turn, friction_coefficient) = (TAU * draws.unit(), draws.between(0.1, 1.5));
    let support = |k: usize| {
        let angle = turn + TAU * k as f64 / n as f64;
        let offset = 0.6 * size * draws.between(0.5, 1.0) * direction(angle);
        SupportPoint { offset, normal_load: weight / n as f64 * draws.between(0.3, 1.0), friction_coefficient: None }
    };
    Ground { friction_coefficient, supports: (0..n).map(support).collect() }
}

/// Points and normals of contacts with a load of this size.
fn contacts(draws: &mut Draws, geometry: Geometry, n: usize, size: f64) -> Vec<(Vec2, Vec2)> {
    let first = TAU * draws.unit();
    let second = match geometry {
        Geometry::Corner => first + 0.5 * PI,
        _ => first + PI - draws.between(0.1, 1.2),
    };
    (0..n)
        .map(|k| {
            let angle = match geometry {
                Geometry::Flat => first,
                Geometry::Corner | Geometry::Wedge => [first, second][k % 2],
                Geometry::Posts => TAU * draws.unit(),
            };
            let normal = direction(angle);
            (size * (draws.between(-1.0, 1.0) * perpendicular(&normal) - 0.7 * normal), normal)
        })
        .collect()
}

fn hessian(draws: &mut Draws, stiffness: f64, size: f64) -> Mat3 {
    let mut hessian = Mat3::zeros();
    for _ in 0..3 {
        let (at, along) = (size * draws.unit() * draws.direction(), draws.direction());
        let row = wrench_of(&at, &along);
        hessian += stiffness * draws.log_between(0.03, 1.0) * row * row.transpose();
    }
    hessian
}

/// Size of the wrench along `course` at which the load starts to slip, over that of `course`.
fn slip_limit(ground: &Ground, size: f64, hessian: &Mat3, course: &Vec3) -> f64 {
    let slips = |share: f64| FrictionSolver::new(ground, size).solve(hessian, &(share * course)).mode != ContactMode::Stick;
    let (mut rests, mut moves) = (0.0, 1e3);
    for _ in 0..60 {
        let middle = 0.5 * (rests + moves);
        *(if slips(middle) { &mut moves } else { &mut rests }) = middle;
    }
    moves
}

fn drive(draws: &mut Draws, load: Load, ground: &Ground, size: f64, hessian: &Mat3) -> Vec3 {
    let total: f64 = ground.slip_limits().sum();
    let course = draws.direction();
    let course = total * Vec3::new(course.x, course.y, size * draws.between(-0.5, 0.5));
    match load {
        Load::Driven => draws.log_between(0.5, 10.0) * course,
        Load::NearRest => {
            let off = draws.sign() * draws.log_between(1e-7, 1e-2);
            slip_limit(ground, size, hessian, &course) * (1.0 + off) * course
        }
        Load::Pinned => {
            let pin = draws.below(ground.supports.len());
            let pivot = ground.supports[pin].offset;
            let turn = draws.sign() * draws.log_between(1e-3, 1.0) * total / (hessian.m11.max(hessian.m22) * size);
            let twist = turn * Vec3::new(pivot.y, -pivot.x, 1.0);
            let mut drive = hessian * twist;
            for (k, (support, limit)) in ground.supports.iter().zip(ground.slip_limits()).enumerate() {
                let slip = slip_velocity(&support.offset, &twist);
                let force = if k == pin { draws.unit() * limit * draws.direction() } else { limit * slip.normalize() };
                drive += wrench_of(&support.offset, &force);
            }
            drive
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Class {
    geometry: Geometry,
    load: Load,
    is_closed: bool,
    n: usize,
}

fn class(i: u64) -> Class {
    let i = i as usize;
    Class {
        geometry: [Geometry::Flat, Geometry::Corner, Geometry::Wedge, Geometry::Posts][i % 4],
        load: [Load::Driven, Load::NearRest, Load::Pinned][i / 4 % 3],
        is_closed: (i / 12).is_multiple_of(2),
        n: 1 + i / 24 % 4,
    }
}

fn random_step(i: u64) -> Step {
    let mut draws = Draws::new(i);
    let class = class(i);
    let size = draws.log_between(1e-6, 1e3);
    let ground = ground(&mut draws, size);
    let total: f64 = ground.slip_limits().sum();
    let stiffness = total / (size * draws.log_between(1e-4, 10.0));
    let hessian = hessian(&mut draws, stiffness, size);
    let drive = drive(&mut draws, class.load, &ground, size, &hessian);
    let reach = total / stiffness;
    let friction = [0.0, 0.3, 1.0, 2.0][draws.below(4)];
    // All obstacles together move by this twist in the step, in a third of the steps.
    let motion = if draws.unit() < 0.3 {
        reach * Vec3::new(draws.between(-1.0, 1.0), draws.between(-1.0, 1.0), draws.between(-1.0, 1.0) / size)
    } else {
        Vec3::zeros()
    };
    let rows = contacts(&mut draws, class.geometry, class.n, size)
        .into_iter()
        .map(|(point, normal)| {
            let gap = if class.is_closed { 0.0 } else { reach * draws.log_between(1e-3, 3.0) };
            let row = row(point, normal, gap, friction);
            ContactRow { gap: gap - row.normal.dot(&motion), slip: -row.tangent.dot(&motion), ..row }
        })
        .collect();
    Step { ground, size, hessian, drive, rows }
}

#[derive(Debug, Default)]
struct Tally {
    n: u32,
    n_failed: u32,
    worst: f64,
    n_solves: u64,
    n_iterations: u64,
    stages: BTreeMap<Stage, u32>,
}

impl Tally {
    fn add(&mut self, solution: &ContactSolution, residual: f64) {
        self.n += 1;
        self.n_failed += u32::from(residual > 1e-11);
        self.worst = self.worst.max(residual);
        self.n_solves += u64::from(solution.n_solves);
        self.n_iterations += u64::from(solution.n_iterations);
        *self.stages.entry(solution.stage).or_default() += 1;
    }

    fn print(&self, name: &str) {
        let each = |n: u64| n as f64 / f64::from(self.n.max(1));
        println!(
            "{name}: n {}, failed {}, worst {:.1e}, solves {:.1}, iterations {:.1}, {:?}",
            self.n,
            self.n_failed,
            self.worst,
            each(self.n_solves),
            each(self.n_iterations),
            self.stages
        );
    }
}

/// Solves random steps; returns what was found for all and for each class.
fn survey(range: std::ops::Range<u64>) -> (Tally, BTreeMap<String, Tally>) {
    let (mut all, mut classes) = (Tally::default(), BTreeMap::<String, Tally>::new());
    for i in range {
        let step = random_step(i);
        let solution = step.solve();
        let residual = step.certificate(&solution).max(solution.residual);
        let Class { geometry, load, is_closed, n } = class(i);
        let gaps = if is_closed { "closed" } else { "open" };
        let friction = step.rows[0].friction_coefficient;
        for name in [format!("{geometry:?}"), format!("{load:?}"), gaps.to_owned(), format!("{n} contacts"), format!("friction {friction}")]
        {
            classes.entry(name).or_default().add(&solution, residual);
        }
        all.add(&solution, residual);
    }
    (all, classes)
}

/// The residual is that of the answer in SI units. It is some hundred roundings of the forces, and
/// 1e-11 where many contacts share them.
#[test]
fn random_steps_satisfy_coulombs_law_at_the_obstacles_and_on_the_ground() {
    let (all, _) = survey(0..4800);
    assert_eq!(all.n_failed, 0, "{all:?}");
    // The cost is pinned: most steps need Newton's method only, and hardly any all combinations.
    assert!(all.n_iterations < 30 * u64::from(all.n), "{all:?}");
    let count = |stage: Stage| all.stages.get(&stage).copied().unwrap_or(0);
    assert!((count(Stage::Smoothed) + count(Stage::Enumeration)) * 600 < all.n, "{all:?}");
    assert!(count(Stage::Unstable) * 80 < all.n, "{all:?}");
    assert_eq!(all.stages.get(&Stage::Failed), None);
}

#[test]
#[ignore = "prints a table of 20,000 steps"]
fn survey_of_random_steps() {
    let (all, classes) = survey(0..20_000);
    classes.iter().for_each(|(name, tally)| tally.print(name));
    all.print("all");
    assert_eq!(all.n_failed, 0);
    let (worst, n_solved) = largest_excess(0..20_000);
    println!("without side friction: above clarabel by {worst:.1e} at most, which solves {n_solved}");
    // Some roundings.
    assert!(worst < 1e-14);
}

/// Value of `1/2 x'Hx - w'x + sum_i c_i |B_i x|` (J).
fn objective(step: &Step, x: &Vec3) -> f64 {
    let slip = |support: &SupportPoint| slip_velocity(&support.offset, x).norm();
    let loss: f64 = step.ground.supports.iter().zip(step.ground.slip_limits()).map(|(support, limit)| limit * slip(support)).sum();
    0.5 * x.dot(&(step.hessian * x)) - step.drive.dot(x) + loss
}

/// Objective of `x` above that of `y` (J), from the difference of the two: where a stiffness is
/// large beside another, either objective is rounded by more than they differ.
fn excess(step: &Step, x: &Vec3, y: &Vec3) -> f64 {
    let (difference, sum) = (x - y, x + y);
    let loss = |(support, limit): (&SupportPoint, f64)| {
        let slip = |increment: &Vec3| slip_velocity(&support.offset, increment);
        let length = slip(x).norm() + slip(y).norm();
        if length > 0.0 { limit * slip(&sum).dot(&slip(&difference)) / length } else { 0.0 }
    };
    let losses: f64 = step.ground.supports.iter().zip(step.ground.slip_limits()).map(loss).sum();
    difference.dot(&(0.5 * step.hessian * sum - step.drive)) + losses
}

/// Largest energy of an answer above that of clarabel over the energies in it, for steps without
/// side friction, and the number of these that clarabel solves. Its own increments may overlap by
/// its tolerance, which lowers their energy by about 1e-12 of the energies in it.
fn largest_excess(range: std::ops::Range<u64>) -> (f64, u32) {
    let (mut n_solved, mut worst) = (0, f64::NEG_INFINITY);
    for i in range {
        let mut step = random_step(i);
        step.rows.iter_mut().for_each(|row| row.friction_coefficient = 0.0);
        let solution = step.solve();
        assert!(solution.residual < 1e-11);
        let (other, is_solved) = step_with_contacts(&step.ground, step.size, &step.hessian, &step.drive, &step.rows);
        let overlap = step.rows.iter().map(|row| -(row.gap + row.normal.dot(&other))).fold(0.0, f64::max);
        let excess = excess(&step, &solution.increment, &other);
        let pushed: f64 = solution.forces.iter().map(|force| force.normal).sum();
        let size = step.drive.component_mul(&other).amax() + objective(&step, &other).abs();
        worst = worst.max((excess - pushed * overlap) / size);
        n_solved += u32::from(is_solved);
    }
    (worst, n_solved)
}

#[test]
fn without_side_friction_no_increment_has_less_energy_than_ours() {
    let (worst, n_solved) = largest_excess(0..600);
    // Some roundings.
    assert!(worst < 1e-14);
    assert!(n_solved > 300);
}

/// The drive of a step grows by 2 %, and the search starts from its answer.
#[test]
fn a_similar_step_takes_three_or_four_iterations() {
    let (mut n, mut n_warm, mut n_iterations) = (0, 0, 0);
    for i in 0..2400 {
        let mut step = random_step(i);
        let mut solver = FrictionSolver::new(&step.ground, step.size);
        let solution = solve_contacts(&step.system(), &mut solver, None);
        if solution.forces.iter().all(|force| force.normal == 0.0) || solution.ground_mode == ContactMode::Stick {
            continue;
        }
        step.drive *= 1.02;
        let next = solve_contacts(&step.system(), &mut solver, Some(&solution));
        assert!(step.certificate(&next) < 1e-11, "{i}");
        n += 1;
        if next.stage == Stage::Warm {
            n_warm += 1;
            n_iterations += next.n_iterations;
        }
    }
    assert!(n_warm * 10 > n * 9);
    assert!(n_iterations <= 4 * n_warm);
}

fn difference(a: &ContactSolution, b: &Vec3, size: f64) -> f64 {
    let units = Vec3::new(1.0, 1.0, size);
    (a.increment - b).component_mul(&units).norm() / (b.component_mul(&units).norm() + f64::MIN_POSITIVE)
}

/// Steps of some thousand whose answer is not unique, so that rounding decides between two (1).
const FEW_OTHERS: u32 = 3;

#[test]
fn the_order_of_contacts_does_not_matter() {
    let mut n_other = 0;
    for i in 0..2400 {
        let mut step = random_step(i);
        let first = step.solve();
        step.rows.reverse();
        let second = step.solve();
        let is_same =
            difference(&second, &first.increment, step.size) < 1e-9 || first.increment.amax() == 0.0 && second.increment.amax() == 0.0;
        n_other += u32::from(!is_same);
    }
    assert!(n_other <= FEW_OTHERS, "{n_other}");
}

/// Everything turned by an angle, and mirrored on the x-axis.
#[test]
fn turned_and_mirrored_steps_have_turned_and_mirrored_answers() {
    let mut n_other = 0;
    for i in 0..2400 {
        let step = random_step(i);
        let first = step.solve();
        let (sin, cos) = (0.3 + i as f64).sin_cos();
        for is_mirrored in [false, true] {
            let flip = if is_mirrored { -1.0 } else { 1.0 };
            let map = Mat3::new(cos, -sin * flip, 0.0, sin, cos * flip, 0.0, 0.0, 0.0, flip);
            let mut other = step.clone();
            other.hessian = map * step.hessian * map.transpose();
            other.hessian = 0.5 * (other.hessian + other.hessian.transpose());
            other.drive = map * step.drive;
            for support in &mut other.ground.supports {
                support.offset = (map * support.offset.push(0.0)).xy();
            }
            for row in &mut other.rows {
                (row.normal, row.tangent) = (map * row.normal, map * row.tangent);
            }
            let second = other.solve();
            let want = map * first.increment;
            let is_same = difference(&second, &want, step.size) < 1e-8 || want.amax() == 0.0 && second.increment.amax() == 0.0;
            n_other += u32::from(!is_same);
        }
    }
    assert!(n_other <= FEW_OTHERS, "{n_other}");
}

/// A load without springs on a random ground, pushed by obstacles that overlap it at first.
fn pushed_step(i: u64) -> Step {
    let mut draws = Draws::new(1_000_000 + i);
    let size = draws.log_between(1e-6, 1e3);
    let mut ground = ground(&mut draws, size);
    while ground.supports.len() < 2 {
        ground = self::ground(&mut draws, size);
    }
    let n = 1 + (i % 3) as usize;
    let normal = draws.direction();
    let depth = size * draws.log_between(1e-9, 1e-2);
    let friction = [0.0, 0.3, 1.0][draws.below(3)];
    let rows = (0..n).map(|_| {
        let at = size * (draws.between(-1.0, 1.0) * perpendicular(&normal) - 0.7 * normal);
        let mut row = row(at, normal, -depth * draws.between(0.5, 1.0), friction);
        row.slip = depth * draws.between(-0.3, 0.3);
        row
    });
    Step { rows: rows.collect(), ground, size, hessian: Mat3::zeros(), drive: Vec3::zeros() }
}

#[test]
fn pushed_loads_without_springs_satisfy_coulombs_law() {
    let mut tally = Tally::default();
    for i in 0..3000 {
        let step = pushed_step(i);
        let solution = step.solve();
        let residual = step.certificate(&solution);
        tally.add(&solution, residual);
    }
    assert_eq!(tally.n_failed, 0, "{tally:?}");
}

/// Obstacles that overlap the load at first, as after a step of their own.
fn overlapped_step(i: u64) -> Step {
    let mut step = random_step(i);
    let mut draws = Draws::new(4_000_000 + i);
    let reach = step.ground.slip_limits().sum::<f64>() / step.hessian.m11;
    step.rows.iter_mut().for_each(|row| row.gap = -reach * draws.log_between(1e-4, 1.0));
    step
}

/// Whether any modes of the contacts satisfy all conditions of a step without ground friction, in
/// which each combination of modes is a linear problem.
fn has_linear_answer(step: &Step) -> bool {
    let n = step.rows.len();
    (0..4usize.pow(n as u32)).any(|code| {
        let modes: Vec<usize> = (0..n).map(|k| code / 4usize.pow(k as u32) % 4).collect();
        let (mut rows, mut directions, mut targets) = (Vec::new(), Vec::new(), Vec::new());
        for (row, mode) in step.rows.iter().zip(&modes) {
            let sign = [0.0, 0.0, 1.0, -1.0][*mode];
            if *mode > 0 {
                rows.push(row.normal);
                directions.push(row.normal - sign * row.friction_coefficient * row.tangent);
                targets.push(-row.gap);
            }
            if *mode == 1 {
                rows.push(row.tangent);
                directions.push(row.tangent);
                targets.push(-row.slip);
            }
        }
        let (m, inverse) = (rows.len(), step.hessian.try_inverse().unwrap());
        let matrix: DMatrix<f64> = DMatrix::from_fn(m, m, |i, j| rows[i].dot(&(inverse * directions[j])));
        let size = if m > 0 { matrix.amax() } else { 0.0 };
        let right = DVector::from_fn(m, |i, _| targets[i] - rows[i].dot(&(inverse * step.drive)));
        let forces = if m > 0 { matrix.svd(true, true).solve(&right, 1e-10 * size).unwrap() } else { right };
        let pushes: Vec3 = directions.iter().zip(forces.iter()).map(|(direction, force)| *force * direction).sum();
        let x = inverse * (step.drive + pushes);
        let (length, force) = (1e-7 * step.rows.iter().map(|row| row.gap.abs()).fold(0.0, f64::max), 1e-7 * forces.amax());
        let holds = rows.iter().zip(&targets).all(|(row, target)| (row.dot(&x) - target).abs() < length);
        let mut next = forces.iter();
        holds
            && step.rows.iter().zip(&modes).all(|(row, mode)| {
                let (gap, slip) = (row.gap + row.normal.dot(&x), row.slip + row.tangent.dot(&x));
                if *mode == 0 {
                    return gap > -length;
                }
                let normal = *next.next().unwrap();
                let agrees = match mode {
                    1 => next.next().unwrap().abs() <= row.friction_coefficient * normal + force,
                    2 => slip > -length,
                    _ => slip < length,
                };
                normal > -force && agrees
            })
    })
}

/// Obstacles that move independently may wedge the load so that no increment satisfies Coulomb's
/// law, even where one keeps all gaps open. Without ground friction every combination of modes is a
/// linear problem, which tells.
#[test]
fn wedged_loads_without_ground_friction_are_solved_exactly_where_they_can_be() {
    let (mut n_solved, mut n_without) = (0, 0);
    for i in (0..2400).filter(|i| class(*i).n <= 3) {
        let mut step = overlapped_step(i);
        step.ground.friction_coefficient = 0.0;
        let solution = step.solve();
        match solution.ending {
            Ending::Converged => n_solved += 1,
            Ending::Infeasible | Ending::NotConverged => {
                assert!(!has_linear_answer(&step), "{i} {:?} {:e}", solution.ending, solution.residual);
                n_without += 1;
            }
        }
    }
    assert!(n_solved > 1500 && n_without > 100, "{n_solved} {n_without}");
}

/// A step whose springs resist in one or two directions only, drawn taut by a drive along these.
fn step_on_few_springs(i: u64) -> Step {
    let mut step = random_step(i);
    let mut draws = Draws::new(2_000_000 + i);
    let stiffness = step.hessian.m11.max(step.hessian.m22);
    step.hessian = Mat3::zeros();
    step.drive = Vec3::zeros();
    let total: f64 = step.ground.slip_limits().sum();
    for _ in 0..1 + draws.below(2) {
        let (at, along) = (step.size * draws.unit() * draws.direction(), draws.direction());
        let row = wrench_of(&at, &along);
        step.hessian += stiffness * row * row.transpose();
        step.drive += total * draws.log_between(0.1, 10.0) * row;
    }
    step
}

#[test]
fn loads_on_few_springs_satisfy_coulombs_law() {
    let mut tally = Tally::default();
    for i in (0..3000).filter(|i| random_step(*i).ground.supports.len() > 1) {
        let step = step_on_few_springs(i);
        let solution = step.solve();
        let residual = step.certificate(&solution);
        tally.add(&solution, residual);
    }
    assert_eq!(tally.n_failed, 0, "{tally:?}");
}

/// Obstacles on all sides, some of which overlap so far that the gaps contradict each other.
#[test]
fn squeezes_are_recognised_and_named() {
    let mut n_squeezed = 0;
    for i in 0..1200 {
        let mut step = random_step(i);
        let mut draws = Draws::new(3_000_000 + i);
        let n = 2 + draws.below(3);
        let n = if n == 4 { 3 } else { n };
        // Normals whose sum with positive shares is zero, through one point.
        let (at, turn) = (step.size * draws.unit() * draws.direction(), TAU * draws.unit());
        let reach = step.ground.slip_limits().sum::<f64>() / step.hessian.m11;
        let off = draws.sign() * reach * draws.log_between(1e-9, 1.0);
        step.rows = (0..n).map(|k| row(at, direction(turn + TAU * k as f64 / n as f64), 0.0, 0.3)).collect();
        let shift = Vec3::new(draws.between(-1.0, 1.0) * reach, draws.between(-1.0, 1.0) * reach, 0.0);
        step.rows.iter_mut().for_each(|row| row.gap = off - row.normal.dot(&shift));
        step.rows.push(row(at, direction(turn + 0.1), 10.0 * reach, 0.3));
        let solution = step.solve();
        if off < 0.0 {
            n_squeezed += 1;
            assert_eq!(solution.ending, Ending::Infeasible, "{i} {n} {off:e} {reach:e}");
            assert_eq!(solution.conflict.to_vec(), (0..n).collect::<Vec<_>>(), "{i}");
        } else {
            assert_ne!(solution.ending, Ending::Infeasible, "{i}");
        }
    }
    assert!(n_squeezed > 400);
}

/// In these steps rest satisfies Coulomb's law, but a small slip would go on. The answer slides.
#[test]
fn rest_that_is_not_stable_is_left() {
    for i in [75, 121, 242] {
        let solution = random_step(i).solve();
        assert_eq!(solution.stage, Stage::Offsets, "{i}");
        assert!(solution.increment.amax() > 0.0 && solution.residual < 1e-11, "{i}");
    }
}

/// In these steps rest on several contacts is not stable, but no slide is found. The search ends as
/// soon as it returns to rest: all rounds together take some 450 iterations.
#[test]
fn a_search_for_a_slide_ends_where_it_comes_back_to_rest() {
    for i in [627, 794, 1666] {
        let solution = random_step(i).solve();
        assert_eq!((solution.stage, solution.increment), (Stage::Unstable, Vec3::zeros()), "{i}");
        assert!(solution.residual < 1e-11 && solution.n_iterations < 200, "{i} {}", solution.n_iterations);
    }
}

/// In these steps a contact that slides backward satisfies Coulomb's law, but a small overlap would
/// pull it in further: a principal minor of `N C (N - sigma mu T)'` is negative. The answer sticks.
#[test]
fn slides_that_are_not_stable_are_not_taken() {
    let back = SideMode::Slide { forward: false };
    for (i, unstable) in [(626, vec![back, SideMode::Stick, SideMode::Open]), (705, vec![SideMode::Stick, back])] {
        let step = random_step(i);
        let solver = FrictionSolver::new(&step.ground, step.size);
        let solution = step.solve();
        assert!(solution.modes.iter().all(|mode| *mode == SideMode::Stick), "{i}");
        let slide = mode_newton(&step.system(), &solver, ContactMode::Slip, &unstable, &solution).unwrap();
        assert!(slide.residual < 1e-11, "{i} {slide:?}");
    }
}

/// The tripod load of the analytic scenes in millimetres and millinewtons: spring 0.664 N/m at the
/// centre, friction of 21.9744 mN on three supports at two thirds of the radius.
fn tripod(tip: Vec2, rows: Vec<ContactRow>) -> Step {
    let offset = |degrees: f64| 2.0 / 3.0 * 12.2 * direction(degrees.to_radians());
    let supports = [90.0, 210.0, 330.0].map(|degrees| SupportPoint {
        offset: offset(degrees),
        normal_load: 1.6 * 9.81 / 3.0,
        friction_coefficient: None,
    });
    let stiffness = 0.664;
    Step {
        ground: Ground { friction_coefficient: 1.4, supports: supports.to_vec() },
        size: 12.2,
        hessian: Mat3::from_diagonal(&Vec3::new(stiffness, stiffness, 0.0)),
        drive: (stiffness * tip).push(0.0),
        rows,
    }
}

/// Corners of a box of half sizes 12.2 and 8 on a wall below it; the first one is in front.
fn box_on_a_wall(friction: f64) -> Vec<ContactRow> {
    [12.2, -12.2].map(|x| row(Vec2::new(x, -8.0), Vec2::y(), 0.0, friction)).to_vec()
}

/// Where friction on the ground and the pressure on the wall keep their directions, one step is
/// exact. Forces and lengths as far as they are printed in closed form; six digits or more.
#[test]
fn a_box_drawn_along_a_wall_moves_and_presses_as_known() {
    let frictionless = tripod(Vec2::new(60.0, -20.0), vec![row(Vec2::new(0.0, -12.2), Vec2::y(), 0.0, 0.0)]).solve();
    assert!((frictionless.increment - Vec3::new(26.906024096386, 0.0, 0.0)).amax() < 1e-11, "{frictionless:?}");
    assert!((frictionless.forces[0].normal - 13.28).abs() < 1e-12);
    assert!(frictionless.are_forces_unique);

    let slides = tripod(Vec2::new(60.0, -20.0), box_on_a_wall(0.3)).solve();
    assert!((slides.increment - Vec3::new(20.906024096386, 0.0, 0.0)).amax() < 1e-11, "{slides:?}");
    let [front, rear] = [0, 1].map(|k| slides.forces[k]);
    assert!((front.normal - 7.946229508).abs() < 1e-9 && (rear.normal - 5.333770492).abs() < 1e-9);
    // The tangent is the normal turned by 90 degrees, against the motion.
    assert!((front.tangential - 0.3 * front.normal).abs() < 1e-12);

    let steep = tripod(Vec2::new(100.0, -50.0), box_on_a_wall(1.2)).solve();
    assert!((steep.increment - Vec3::new(6.906024096, 0.0, 0.0)).amax() < 1e-8, "{steep:?}");
    let wedged = tripod(Vec2::new(300.0, -270.0), box_on_a_wall(1.2)).solve();
    assert_eq!((wedged.increment, wedged.ground_mode), (Vec3::zeros(), ContactMode::Stick));
    assert_eq!(wedged.modes.to_vec(), [SideMode::Stick; 2]);
    assert!(!wedged.are_forces_unique && wedged.residual < 1e-11);
}

/// Rest would be admissible up to a pull of f sqrt(1 + mu^2) + mu P, since the ground may press the
/// box against the wall, but the box slides from f + mu P on.
#[test]
fn a_box_that_can_slide_does_not_rest() {
    let (limit, pressure, friction, stiffness) = (21.9744, 13.28, 0.3, 0.664);
    let at_onset = (limit + friction * pressure) / stiffness;
    let at_most = (limit * (1.0 + f64::powi(friction, 2)).sqrt() + friction * pressure) / stiffness;
    for beyond in [-1e-3, 1e-6, 1e-3, 0.1, 1.0] {
        assert!(at_onset + beyond < at_most);
        let found = tripod(Vec2::new(at_onset + beyond, -20.0), box_on_a_wall(friction)).solve();
        let want = if beyond < 0.0 { 0.0 } else { beyond };
        // Roundings of the tip's position.
        assert!((found.increment - Vec3::new(want, 0.0, 0.0)).amax() < 1e-12, "{beyond} {found:?}");
    }
}

/// A load leans on the corner of a wall at the limit of its friction with the ground, after a
/// spring let go. It turns about the corner by some 1e-12 m, a millionth of what it would without
/// the wall. The gap and the slip so far are roundings of a pose, and must not hide that.
#[test]
fn a_load_at_its_limit_turns_about_a_corner_whatever_rounding_says() {
    let angle = |k: usize| 0.5 * PI + TAU * k as f64 / 3.0;
    let support = |k: usize| SupportPoint {
        offset: 0.0244 / 3.0 * direction(angle(k)),
        normal_load: 0.0016 * 9.81 / 3.0,
        friction_coefficient: None,
    };
    let ground = Ground { friction_coefficient: 1.4, supports: (0..3).map(support).collect() };
    #[rustfmt::skip]
    let hessian = Mat3::new(
        1.8207226017612563, -0.06989732946218588, -0.022567979110482597,
        -0.06989732946218588, 1.7036762852036744, 0.0034143311179547567,
        -0.022567979110482597, 0.0034143311179547567, 0.002766658264262489,
    );
    let drive = Vec3::new(0.01328808952177372, 0.016841024338618643, -2.6682769502724405e-5);
    let solved = |gap: f64, slip: f64| {
        let normal = Vec3::new(-0.8083312469209345, 0.5887279467217835, 5.734663655988739e-12);
        let tangent = Vec3::new(-0.5887279467217834, -0.8083312469209344, -0.0122);
        let rows = vec![ContactRow { normal, tangent, gap, slip, friction_coefficient: 0.2 }];
        Step { ground: ground.clone(), size: 0.0122, hessian, drive, rows }.solve()
    };
    let clean = solved(0.0, 0.0);
    assert!(clean.increment.z < -1e-10 && clean.modes[0] == SideMode::Slide { forward: false }, "{clean:?}");
    let rounded = solved(-3.869047920143818e-21, 7.470237701769772e-18);
    assert_eq!(rounded.ending, Ending::Converged);
    assert_eq!(rounded.modes, clean.modes);
    // A slip of 7e-18 m matters by its share of the slip of 1e-12 m.
    assert!((rounded.increment - clean.increment).amax() < 0.01 * clean.increment.amax(), "{rounded:?}");
}

/// A pusher against the centre of a load without springs moves it as far as itself, against all of
/// the friction; far from the centre the load turns away.
#[test]
fn a_pusher_without_springs_moves_the_load() {
    for friction in [0.0, 0.3] {
        let mut step = tripod(Vec2::zeros(), vec![row(Vec2::new(-12.2, 0.0), Vec2::x(), -3.0, friction)]);
        (step.hessian, step.drive) = (Mat3::zeros(), Vec3::zeros());
        let found = step.solve();
        assert!((found.increment - Vec3::new(3.0, 0.0, 0.0)).amax() < 1e-12, "{found:?}");
        assert!((found.forces[0].normal - 21.9744).abs() < 1e-12);
        // The forces do not depend on how far the pusher goes.
        step.rows[0].gap *= 1e-6;
        let short = step.solve();
        assert!((1e6 * short.increment - found.increment).amax() < 1e-11, "{short:?}");
        assert!((short.forces[0].normal - found.forces[0].normal).abs() < 1e-12);
    }
}

/// A load that one or two obstacles hold, and a drive within a share of the limit of slipping along
/// them: from a slip with its forces, of which all on the ground are changed by that share.
fn step_at_the_limit(i: u64) -> Step {
    let mut draws = Draws::new(5_000_000 + i);
    let size = draws.log_between(1e-6, 1e3);
    let mut ground = ground(&mut draws, size);
    while ground.supports.len() < 2 {
        ground = self::ground(&mut draws, size);
    }
    let total: f64 = ground.slip_limits().sum();
    let stiffness = total / (size * draws.log_between(1e-4, 10.0));
    let hessian = hessian(&mut draws, stiffness, size);
    let friction = [0.0, 0.0, 0.3, 1.0][draws.below(4)];
    let n = 1 + draws.below(2);
    let rows: Vec<ContactRow> = (0..n)
        .map(|_| {
            let normal = draws.direction();
            row(size * (draws.between(-1.0, 1.0) * perpendicular(&normal) - 0.7 * normal), normal, 0.0, friction)
        })
        .collect();
    // A twist along the obstacles.
    let scaled = |wrench: &Vec3| Vec3::new(wrench.x, wrench.y, wrench.z / size);
    let mut twist = Vec3::new(draws.between(-1.0, 1.0), draws.between(-1.0, 1.0), draws.between(-1.0, 1.0));
    let mut basis: Vec<Vec3> = Vec::new();
    for row in &rows {
        let mut normal = scaled(&row.normal);
        basis.iter().for_each(|other| normal -= normal.dot(other) * other);
        basis.push(normal.normalize());
    }
    basis.iter().for_each(|normal| twist -= twist.dot(normal) * normal);
    let twist = Vec3::new(twist.x, twist.y, twist.z / size);
    let share = 1.0 + draws.sign() * draws.log_between(1e-13, 1e-3);
    let mut drive = Vec3::zeros();
    for (support, limit) in ground.supports.iter().zip(ground.slip_limits()) {
        drive += wrench_of(&support.offset, &(share * limit * slip_velocity(&support.offset, &twist).normalize()));
    }
    for row in &rows {
        let normal = total * draws.log_between(0.03, 3.0);
        drive -= normal * (row.normal - row.tangent.dot(&twist).signum() * friction * row.tangent);
    }
    Step { ground, size, hessian, drive, rows }
}

#[test]
fn steps_next_to_rest_at_obstacles_satisfy_coulombs_law() {
    let mut tally = Tally::default();
    for i in 0..3000 {
        let step = step_at_the_limit(i);
        let solution = step.solve();
        let residual = step.certificate(&solution);
        tally.add(&solution, residual);
    }
    // Rest has all but no room there. What is left are contacts that slide with friction at the
    // limit, and supports that stay pinned.
    assert!(tally.n_failed <= 8 && tally.worst < 2e-8, "{tally:?}");
}
