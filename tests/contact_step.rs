//! One linear step with ground friction and side contacts: conditions of Coulomb's law for random
//! steps, clarabel for those without side friction, invariances, and squeezes.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use cohaul::backend::contact::{ContactRow, ContactSolution, ContactSystem, Ending, SideMode, Stage, certificate, solve_contacts};
use cohaul::backend::friction::{ContactMode, FrictionSolver};
use cohaul::math::{Mat3, RandomStreams, Stream, Vec2, Vec3, direction, perpendicular};
use cohaul::model::support::{slip_velocity, wrench_of};
use cohaul::model::{Ground, SupportPoint};

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
        SupportPoint { offset, normal_load: weight / n as f64 * draws.between(0.3, 1.0) }
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
        is_closed: i / 12 % 2 == 0,
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
    let rows = contacts(&mut draws, class.geometry, class.n, size)
        .into_iter()
        .map(|(point, normal)| {
            let gap = if class.is_closed { 0.0 } else { reach * draws.log_between(1e-3, 3.0) };
            row(point, normal, gap, friction)
        })
        .collect();
    Step { ground, size, hessian, drive, rows }
}

#[derive(Default)]
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

fn survey(range: std::ops::Range<u64>) -> Tally {
    let mut all = Tally::default();
    let mut tallies: BTreeMap<String, Tally> = BTreeMap::new();
    for i in range {
        let step = random_step(i);
        let solution = step.solve();
        let residual = step.certificate(&solution).max(solution.residual);
        let Class { geometry, load, is_closed, n } = class(i);
        let friction = step.rows[0].friction_coefficient;
        for key in [format!("{geometry:?}"), format!("{load:?}"), format!("closed {is_closed}"), format!("K {n}"), format!("mu {friction}")]
        {
            tallies.entry(key).or_default().add(&solution, residual);
        }
        if residual > 1e-11 || solution.stage >= Stage::Enumeration {
            println!(
                "check {i}: {:?} mu {friction} {residual:.1e} {:?} {:?} {:?}",
                class(i),
                solution.stage,
                solution.ground_mode,
                solution.modes
            );
        }
        all.add(&solution, residual);
    }
    tallies.iter().for_each(|(name, tally)| tally.print(name));
    all.print("all");
    all
}

#[test]
fn random_steps_satisfy_the_conditions_of_coulombs_law() {
    let n = std::env::var("STEPS").ok().and_then(|n| n.parse().ok()).unwrap_or(960);
    let all = survey(0..n);
    assert_eq!(all.n_failed, 0);
}

#[test]
fn debug_one() {
    let Some(list) = std::env::var("CASES").ok() else { return };
    for i in list.split(',').map(|i| i.parse().unwrap()) {
        let step = random_step(i);
        let solution = step.solve();
        let solver = FrictionSolver::new(&step.ground, step.size);
        let free = solver.clone().solve(&step.hessian, &step.drive);
        println!(
            "{i} {:?} size {:.1e} own residual {:.1e} certificate {:.1e}",
            class(i),
            step.size,
            solution.residual,
            step.certificate(&solution)
        );
        println!("  free {:?} {:.1e} {:?}", free.mode, free.residual, free.increment.as_slice());
        println!("  {:?} {:?} {:?} {:?}", solution.stage, solution.ground_mode, solution.modes, solution.increment.as_slice());
        for (row, force) in step.rows.iter().zip(&solution.forces) {
            let gap = row.gap + row.normal.dot(&solution.increment);
            println!(
                "  g {:.3e} n {:.3?} gap {gap:.3e} slip {:.3e} p {:.3e} tau {:.3e}",
                row.gap,
                row.normal.as_slice(),
                row.tangent.dot(&solution.increment),
                force.normal,
                force.tangential
            );
        }
        println!("  limits {:?}", step.ground.slip_limits().collect::<Vec<_>>());
        println!("  forces {:?}", solution.ground_forces.iter().map(|f| f.norm()).collect::<Vec<_>>());
    }
}
