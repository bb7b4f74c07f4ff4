//! Random loads, springs and obstacles on both exact backends: whatever the scene, nothing
//! penetrates or passes through, all stays finite, and the ledgers close.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::time::Instant;

use cohaul::backend::{Backend, BackendKind, BackendOptions, Integrator, Status, StepReport, Tolerance, build};
use cohaul::math::{Pose, RandomStreams, Stream, Twist, Vec2, direction};
use cohaul::model::geometry::overlap_depth;
use cohaul::model::{Ground, Load, Motion, Obstacle, ObstaclePath, Outline, OutlinePart, PolarSpring, SupportPoint, System, World};

/// Draws of one scene.
struct Draws {
    streams: RandomStreams,
    n: u64,
}

impl Draws {
    fn unit(&mut self) -> f64 {
        self.n += 1;
        self.streams.uniform(Stream::Scene, 0, self.n)
    }

    fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.unit()
    }

    fn below(&mut self, n: usize) -> usize {
        ((n as f64) * self.unit()) as usize % n
    }

    fn is(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    fn point(&mut self, radius: f64) -> Vec2 {
        radius * self.unit().sqrt() * direction(TAU * self.unit())
    }
}

/// A scene in units of the load: lengths of its size, forces of its slip limit.
struct Scene {
    system: System,
    start: Motion,
    attached: Vec<bool>,
    /// Waypoints of each tip, relative to its rest.
    waypoints: Vec<Vec<Vec2>>,
    /// Number of advances and their duration (s).
    n_advances: usize,
    duration: f64,
    scale: f64,
    force: f64,
    /// Outlines whose two sides the load must not change.
    n_long: usize,
    second: bool,
}

fn polygon(corners: impl IntoIterator<Item = Vec2>) -> OutlinePart {
    OutlinePart::Polygon { corners: corners.into_iter().collect() }
}

fn block([a, b]: [f64; 2], about: Vec2) -> OutlinePart {
    polygon([[-a, -b], [a, -b], [a, b], [-a, b]].map(|corner| about + Vec2::from(corner)))
}

/// An L whose centre of area lies near the origin.
fn angle(size: f64) -> OutlinePart {
    let corners = [[-0.6, -0.6], [0.9, -0.6], [0.9, -0.1], [-0.1, -0.1], [-0.1, 0.9], [-0.6, 0.9]];
    polygon(corners.map(|corner| size * Vec2::from(corner)))
}

/// A star with concave corners.
fn star(draws: &mut Draws, size: f64) -> OutlinePart {
    let n = 3 + draws.below(4);
    polygon((0..2 * n).map(|k| if k % 2 == 0 { size } else { 0.45 * size } * direction(PI * k as f64 / n as f64)))
}

fn load_outline(draws: &mut Draws) -> Outline {
    let parts = match draws.below(4) {
        0 => vec![OutlinePart::Disc { centre: Vec2::zeros(), radius: 1.0 }],
        1 => vec![block([draws.between(0.4, 0.9), draws.between(0.3, 0.6)], Vec2::zeros())],
        2 => vec![angle(1.0)],
        _ => vec![block([0.7, 0.2], Vec2::zeros()), OutlinePart::Disc { centre: Vec2::new(0.7, 0.0), radius: draws.between(0.21, 0.4) }],
    };
    Outline { parts }
}

fn obstacle_part(draws: &mut Draws) -> OutlinePart {
    let size = draws.between(0.1, 1.0);
    match draws.below(5) {
        0 => OutlinePart::Disc { centre: Vec2::zeros(), radius: size },
        1 => block([size, draws.between(0.1, 1.0)], Vec2::zeros()),
        2 => star(draws, size),
        3 => angle(size),
        _ => {
            let mut points = vec![Vec2::zeros()];
            for _ in 0..1 + draws.below(3) {
                let next = points[points.len() - 1] + draws.between(0.3, 2.0) * direction(draws.between(-1.0, 1.0));
                points.push(next);
            }
            OutlinePart::Polyline { points }
        }
    }
}

fn obstacle(draws: &mut Draws, is_long: bool) -> Obstacle {
    let outline = if is_long {
        Outline { parts: vec![OutlinePart::Polyline { points: vec![Vec2::new(-40.0, 0.0), Vec2::new(40.0, 0.0)] }] }
    } else {
        Outline { parts: vec![obstacle_part(draws)] }
    };
    let position = draws.between(0.8, 5.0) * direction(TAU * draws.unit());
    let pose = Pose { position, heading: TAU * draws.unit() };
    let mut waypoints = vec![(0.0, pose)];
    if !is_long && draws.is(0.25) {
        for k in 0..3 {
            let (time, last) = waypoints[waypoints.len() - 1];
            // Toward the load, or anywhere.
            let aim = if draws.is(0.5) { -0.5 * last.position } else { draws.point(2.0) };
            let heading = last.heading + if draws.is(0.5) { draws.between(-1.0, 1.0) } else { 0.0 };
            waypoints.push((time + draws.between(0.1, 0.6), Pose { position: last.position + aim, heading }));
            let _ = k;
        }
    }
    Obstacle {
        name: "obstacle".into(),
        outline,
        friction_coefficient: if draws.is(0.3) { 0.0 } else { draws.between(0.0, 2.0) },
        restitution: if draws.is(0.4) { 0.0 } else { draws.between(0.0, 0.9) },
        path: ObstaclePath { waypoints },
    }
}

fn spring(draws: &mut Draws) -> PolarSpring {
    let root = draws.point(0.5);
    let stiffness = 0.37 * 10f64.powf(draws.between(-0.5, 1.0));
    if draws.is(0.5) {
        return PolarSpring { root, bearing: 0.0, rest_length: 0.0, radial_stiffness: stiffness, torsional_stiffness: 0.0, damping_ratio: 0.0 };
    }
    let (bearing, rest_length) = (TAU * draws.unit(), draws.between(1.0, 2.5));
    let torsional_stiffness = stiffness * draws.between(0.5, 5.0);
    PolarSpring { root, bearing, rest_length, radial_stiffness: stiffness, torsional_stiffness, damping_ratio: 0.0 }
}

fn scaled_part(part: &OutlinePart, scale: f64) -> OutlinePart {
    match part {
        OutlinePart::Disc { centre, radius } => OutlinePart::Disc { centre: scale * centre, radius: scale * radius },
        OutlinePart::Polygon { corners } => OutlinePart::Polygon { corners: corners.iter().map(|corner| scale * corner).collect() },
        OutlinePart::Polyline { points } => OutlinePart::Polyline { points: points.iter().map(|point| scale * point).collect() },
    }
}

fn scaled_outline(outline: &Outline, scale: f64) -> Outline {
    Outline { parts: outline.parts.iter().map(|part| scaled_part(part, scale)).collect() }
}

fn scaled_pose(pose: &Pose, scale: f64) -> Pose {
    Pose { position: scale * pose.position, heading: pose.heading }
}

impl Scene {
    fn new(seed: u64) -> Self {
        let mut draws = Draws { streams: RandomStreams::new(seed), n: 0 };
        let draws = &mut draws;
        let outline = load_outline(draws);
        let start = Pose::new(0.0, 0.0, TAU * draws.unit());
        let n_obstacles = 1 + draws.below(20);
        let n_long = if draws.is(0.4) { 1 + draws.below(3) } else { 0 };
        let mut obstacles: Vec<Obstacle> = Vec::new();
        while obstacles.len() < n_obstacles.max(n_long) {
            let is_long = obstacles.len() < n_long;
            let one = obstacle(draws, is_long);
            let near = Outline { parts: vec![OutlinePart::Disc { centre: Vec2::zeros(), radius: 1.001 * outline.extent() }] };
            let is_close = overlap_depth(&near, &start, &one.outline, &one.path.pose_at(0.0)).is_some();
            if overlap_depth(&outline, &start, &one.outline, &one.path.pose_at(0.0)).is_none() && !(is_close && draws.is(0.5)) {
                obstacles.push(one);
            }
        }
        let scale = 10f64.powf(if draws.is(0.5) { -2.0 } else { draws.between(-6.0, 3.0) });
        let force = 10f64.powf(if draws.is(0.5) { -2.0 } else { draws.between(-6.0, 4.0) });
        let n_supports = 3 + draws.below(4);
        let supports = (0..n_supports)
            .map(|k| SupportPoint { offset: scale * 0.4 * direction(TAU * k as f64 / n_supports as f64), normal_load: force / n_supports as f64 })
            .collect();
        let springs: Vec<PolarSpring> = (0..1 + draws.below(4)).map(|_| spring(draws)).collect();
        let attached = springs.iter().map(|_| draws.is(0.85)).collect();
        let waypoints = springs.iter().map(|_| (0..4).map(|k| if k == 0 { draws.point(0.2) } else { draws.point(8.0) }).collect()).collect();
        // A slip limit of one in units of the force: a load that slides half its size in 0.1 s.
        let mass = force / (scale * 40.0);
        let unit = force / scale;
        let springs = springs
            .into_iter()
            .map(|spring| PolarSpring {
                root: scale * spring.root,
                rest_length: scale * spring.rest_length,
                radial_stiffness: unit * spring.radial_stiffness,
                torsional_stiffness: unit * scale * scale * spring.torsional_stiffness,
                ..spring
            })
            .collect();
        for obstacle in &mut obstacles {
            obstacle.outline = scaled_outline(&obstacle.outline, scale);
            obstacle.path.waypoints.iter_mut().for_each(|(_, pose)| *pose = scaled_pose(pose, scale));
        }
        let outline = scaled_outline(&outline, scale);
        let radius = outline.extent();
        let system = System {
            load: Load { mass, inertia: 0.5 * mass * radius * radius, radius },
            ground: Ground { friction_coefficient: draws.between(0.3, 1.5), supports },
            springs,
            world: World { outline, obstacles },
        };
        let start = Motion { pose: scaled_pose(&start, scale), twist: Twist::ZERO };
        Self { system, start, attached, waypoints, n_advances: 30, duration: 1.0 / 30.0, scale, force, n_long, second: draws.is(0.5) }
    }

    /// Place of a tip (m) at a share of the run.
    fn tip(&self, spring: usize, share: f64) -> Vec2 {
        let points = &self.waypoints[spring];
        let at = share * (points.len() - 1) as f64;
        let k = (at as usize).min(points.len() - 2);
        let offset = points[k] + (at - k as f64) * (points[k + 1] - points[k]);
        self.start.pose.to_world(&self.system.springs[spring].rest_tip()) + self.scale * offset
    }

    fn options(&self, kind: BackendKind, way: usize) -> BackendOptions {
        match way {
            0 => BackendOptions { integrator: Integrator::Euler, second_order: false, ..BackendOptions::new(kind, self.duration / 4.0) },
            1 => BackendOptions { integrator: Integrator::Midpoint, second_order: true, ..BackendOptions::new(kind, self.duration / 4.0) },
            _ => BackendOptions::within(kind, Tolerance::at_edge(1e-4 * self.scale, &self.system.load)),
        }
    }

    fn targets(&self, share: f64) -> Vec<Vec2> {
        (0..self.system.springs.len()).map(|spring| self.tip(spring, share)).collect()
    }
}

/// What went wrong or slowly in a run.
#[derive(Default)]
struct Findings {
    faults: Vec<String>,
    n_advances: u64,
    n_steps: u64,
    n_not_converged: u64,
    n_failed: u64,
    n_touching: u64,
    n_solves: u64,
    most_solves: (u64, f64, String),
    worst_defect: f64,
}

fn side_of(obstacle: &Obstacle, at: &Pose) -> bool {
    let pose = obstacle.path.pose_at(0.0);
    direction(pose.heading).perp(&(at.position - pose.position)) > 0.0
}

fn bits(load: &dyn Backend) -> Vec<u64> {
    let (motion, energy) = (load.motion(), load.energy());
    [motion.pose.position.x, motion.pose.position.y, motion.pose.heading, motion.twist.linear.x, energy.friction, energy.side_friction]
        .map(f64::to_bits)
        .to_vec()
}

fn run(seed: u64, kind: BackendKind, way: usize, findings: &mut Findings) {
    let scene = Scene::new(seed);
    let name = format!("{seed} {} {way}", kind.name());
    let Scene { system, .. } = &scene;
    let options = scene.options(kind, way);
    let mut load = build(system, scene.start, &options);
    let mut attached = scene.attached.clone();
    if std::env::var("SHOW").is_ok() {
        println!("{:?} scale {:e}", system.world.outline, scene.scale);
        for (index, obstacle) in system.world.obstacles.iter().enumerate() {
            println!("{index} {obstacle:?}");
        }
    }
    for (spring, _) in attached.iter().enumerate().filter(|(_, is)| **is) {
        load.attach(spring, scene.tip(spring, 0.0));
    }
    let sides: Vec<bool> = system.world.obstacles[..scene.n_long].iter().map(|wall| side_of(wall, &scene.start.pose)).collect();
    let mut other: Option<Box<dyn Backend>> = None;
    let mut is_bad = false;
    for tick in 0..scene.n_advances {
        let share = |tick: usize| tick as f64 / scene.n_advances as f64;
        if tick == scene.n_advances / 3 {
            // A spring is released or attached.
            for load in [Some(&mut load), other.as_mut()].into_iter().flatten() {
                if attached[0] { load.release(0) } else { load.attach(0, scene.tip(0, share(tick))) }
            }
            attached[0] = !attached[0];
        }
        let targets = scene.targets(share(tick + 1));
        let before = (load.motion(), load.energy());
        let clock = Instant::now();
        let report: StepReport = load.advance(&targets, scene.duration);
        let seconds = clock.elapsed().as_secs_f64();
        if seconds > 0.3 {
            println!("LONG {name} {tick} {seconds:.2} s {report:?}");
        }
        if std::env::var("SHOW").is_ok() {
            println!("{name} {tick} {:?} {:e} solves {} {:?} {:?}", report.status, report.residual, report.n_solves, load.motion(), load.transitions());
            println!("   {}", serde_json::to_string(&load.save().unwrap()).unwrap());
        }
        findings.n_advances += 1;
        findings.n_steps += report.n_steps;
        findings.n_solves += report.n_solves;
        findings.n_not_converged += report.n_not_converged;
        findings.n_failed += u64::from(report.status == Status::Failed);
        if report.n_solves > findings.most_solves.0 {
            findings.most_solves = (report.n_solves, seconds, format!("{name} tick {tick}"));
        }
        is_bad |= report.status == Status::Failed;
        let mut fault = |what: String| findings.faults.push(format!("{name} tick {tick}: {what} ({:?})", report.status));
        let (motion, energy) = (load.motion(), load.energy());
        if !motion.pose.is_finite() || !motion.twist.is_finite() || !energy.defect().is_finite() {
            fault(format!("not finite: {motion:?} {energy:?}"));
            return;
        }
        if report.is_refused() {
            fault("refused".into());
            return;
        }
        if report.status == Status::Converged && report.residual > 1e-9 {
            fault(format!("residual {:e}", report.residual));
        }
        let time = share(tick + 1) * scene.n_advances as f64 * scene.duration;
        let mut touches = false;
        for (index, obstacle) in system.world.obstacles.iter().enumerate() {
            let at = obstacle.path.pose_at(time);
            let depth = overlap_depth(&system.world.outline, &motion.pose, &obstacle.outline, &at);
            if let Some(depth) = depth
                && depth > 1e-7 * system.load.radius + 4e-8 * obstacle.outline.extent()
            {
                if !is_bad { fault(format!("penetration {:e} R of {index}", depth / scene.scale)) }
                else if depth > 0.0 { is_bad = true }
            }
            touches |= depth.is_some();
        }
        let _ = touches;
        for (index, side) in sides.iter().enumerate() {
            if side_of(&system.world.obstacles[index], &motion.pose) != *side && !is_bad {
                fault(format!("passed through wall {index}"));
            }
        }
        // Losses only grow.
        let losses = |energy: &cohaul::backend::EnergyLedger| [energy.friction, energy.side_friction, energy.impacts];
        let unit = scene.scale * scene.force;
        for (now, then) in losses(&energy).iter().zip(losses(&before.1)) {
            if *now < then - 1e-3 * unit {
                fault(format!("loss fell from {:e} to {:e}", then / unit, now / unit));
            }
        }
        findings.worst_defect = findings.worst_defect.max(energy.defect() / unit);
        if let Some(other) = &mut other {
            other.advance(&targets, scene.duration);
            if bits(other.as_ref()) != bits(load.as_ref()) {
                fault("a restored run differs".into());
                return;
            }
        } else if tick == 8 && seed % 2 == 0 {
            let saved = load.save().unwrap();
            let text = serde_json::to_string(&saved).unwrap();
            let mut again = build(system, scene.start, &options);
            match again.restore(&serde_json::from_str(&text).unwrap()) {
                Ok(()) => other = Some(again),
                Err(error) => fault(format!("restore: {error:?}")),
            }
        }
    }
}

fn hunt(seeds: std::ops::Range<u64>, kinds: &[BackendKind], ways: &[usize]) -> BTreeMap<String, Findings> {
    let mut all: BTreeMap<String, Findings> = BTreeMap::new();
    for seed in seeds {
        for kind in kinds {
            for way in ways {
                let findings = all.entry(format!("{} {way}", kind.name())).or_default();
                let clock = Instant::now();
                let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                    let mut mine = Findings::default();
                    run(seed, *kind, *way, &mut mine);
                    mine
                }));
                match caught {
                    Ok(mine) => {
                        findings.faults.extend(mine.faults);
                        findings.n_advances += mine.n_advances;
                        findings.n_steps += mine.n_steps;
                        findings.n_solves += mine.n_solves;
                        findings.n_not_converged += mine.n_not_converged;
                        findings.n_failed += mine.n_failed;
                        findings.worst_defect = findings.worst_defect.max(mine.worst_defect);
                        if mine.most_solves.0 > findings.most_solves.0 {
                            findings.most_solves = mine.most_solves;
                        }
                    }
                    Err(_) => findings.faults.push(format!("{seed} {} {way}: PANIC", kind.name())),
                }
                let seconds = clock.elapsed().as_secs_f64();
                if seconds > 2.0 {
                    println!("SLOW {seed} {} {way}: {seconds:.1} s", kind.name());
                }
            }
        }
    }
    all
}

#[test]
#[ignore = "a hunt"]
fn hunt_faults() {
    let number = |name: &str, or: u64| std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(or);
    let ways: Vec<usize> = std::env::var("WAYS").unwrap_or("01".into()).chars().map(|c| c as usize - '0' as usize).collect();
    let kinds: &[BackendKind] = match std::env::var("KIND").as_deref() {
        Ok("q") => &[BackendKind::QuasiStatic],
        Ok("i") => &[BackendKind::Inertial],
        _ => &[BackendKind::QuasiStatic, BackendKind::Inertial],
    };
    for (name, findings) in hunt(number("FROM", 0)..number("TO", 20), kinds, &ways) {
        println!(
            "{name}: {} advances, {} steps, {} solves, {} not converged, {} failed advances, most {:?}, defect {:.2e}, {} faults",
            findings.n_advances,
            findings.n_steps,
            findings.n_solves,
            findings.n_not_converged,
            findings.n_failed,
            findings.most_solves,
            findings.worst_defect,
            findings.faults.len()
        );
        for fault in findings.faults.iter().take(40) {
            println!("    {fault}");
        }
    }
}
