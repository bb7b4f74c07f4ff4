//! Random loads on few springs, whose tips move slowly: what is hard for a load without inertia.
//!
//! | what | distribution (log: uniform in the logarithm) |
//! |---|---|
//! | supports | by turns two, three or four on a line, a triangle, or 5-8 anywhere; unequal loads |
//! | springs | 1-5 with roots inside or on the edge, at any bearing |
//! | rest length over length at the start | log 0.5-2: stretched and compressed springs |
//! | stiffness | one spring reaches the friction limit at a stretch of log 0.05-0.6 lengths |
//! | torsion over radial stiffness times squared length | log 0.003-1 |
//! | tips | three straight parts by about the stretch at slipping; some are released |

use std::f64::consts::{PI, TAU};

use cohaul::backend::{Backend, StepReport, TransitionKind};
use cohaul::math::{Pose, RandomStreams, Stream, Twist, Vec2, direction, rotation};
use cohaul::model::{Ground, Load, Motion, PolarSpring, SupportPoint, System, World};

/// Control periods of a pull.
pub const N_PERIODS: u32 = 90;
/// (s)
pub const PERIOD: f64 = 0.01;

/// A load at rest, and where its tips go.
pub struct Pull {
    pub system: System,
    pub start: Motion,
    tips: Vec<TipPath>,
}

struct TipPath {
    corners: [Vec2; 4],
    /// Control period at whose start the spring is released.
    release: Option<u32>,
}

struct Draws(RandomStreams, u64);

impl Draws {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.1 += 1;
        low + (high - low) * self.0.uniform(Stream::Scene, 0, self.1)
    }

    fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    fn count(&mut self, low: usize, high: usize) -> usize {
        low + self.between(0.0, (high - low + 1) as f64) as usize
    }
}

impl Pull {
    /// The random pull of this seed, from the distribution in the table above.
    pub fn random(seed: u64) -> Self {
        let draws = &mut Draws(RandomStreams::new(seed), 0);
        let (radius, limit) = (draws.log_between(6e-3, 30e-3), draws.log_between(1e-3, 3e-2));
        let pose = Pose::new(draws.between(-0.1, 0.1), draws.between(-0.1, 0.1), draws.between(-PI, PI));
        let supports = supports(seed, radius, limit, draws);
        let (ahead, n) = (draws.between(0.0, TAU), draws.count(1, 5));
        let (mut springs, mut tips) = (Vec::new(), Vec::new());
        for index in 0..n {
            let bearing = draws.between(-PI, PI);
            let root = radius * draws.between(0.3, 1.0) * direction(bearing + draws.between(-0.6, 0.6));
            let rest_length = radius * draws.log_between(0.4, 2.0);
            let stretch = rest_length * draws.log_between(0.05, 0.6);
            let radial_stiffness = limit / stretch;
            let torsional_stiffness = radial_stiffness * rest_length.powi(2) * draws.log_between(0.003, 1.0);
            springs.push(PolarSpring { root, bearing, rest_length, radial_stiffness, torsional_stiffness, ..PolarSpring::default() });
            let length = rest_length / draws.log_between(0.5, 2.0);
            let mut corner = pose.to_world(&(root + length * direction(bearing + draws.between(-0.4, 0.4))));
            let corners = [0; 4].map(|_| {
                let here = corner;
                corner += stretch * draws.between(0.2, 2.0) * direction(ahead + draws.between(-0.8, 0.8));
                here
            });
            let release = draws.between(0.0, 1.0) < 0.4 && index > 0;
            tips.push(TipPath { corners, release: release.then(|| draws.count(10, N_PERIODS as usize - 10) as u32) });
        }
        let load = Load { mass: 1e-3, radius, inertia: 5e-4 * radius * radius };
        let ground = Ground { friction_coefficient: 1.0, supports };
        Self { system: System { load, ground, springs, world: World::default() }, start: Motion { pose, twist: Twist::ZERO }, tips }
    }

    /// Moves the load of this pull from its start, and hands each period to `look`: its number,
    /// what it cost, and the load at its end.
    pub fn run(&self, load: &mut dyn Backend, mut look: impl FnMut(u32, &StepReport, &dyn Backend)) {
        (0..self.tips.len()).for_each(|spring| load.attach(spring, self.tips[spring].corners[0]));
        for period in 0..N_PERIODS {
            for (spring, tip) in self.tips.iter().enumerate() {
                if tip.release == Some(period) {
                    load.release(spring);
                }
            }
            let targets: Vec<Vec2> = self.tips.iter().map(|tip| tip.at(period + 1)).collect();
            let report = load.advance(&targets, PERIOD);
            look(period, &report, load);
        }
    }

    /// Pose to which the load jumps when all tips are attached and stand still for so many seconds,
    /// and whether the end of a jump depends on the dissipation.
    pub fn jump(&self, load: &mut dyn Backend, n_seconds: u32) -> (Pose, bool) {
        let tips: Vec<Vec2> = self.tips.iter().map(|tip| tip.corners[0]).collect();
        (0..tips.len()).for_each(|spring| load.attach(spring, tips[spring]));
        let mut is_uncertain = false;
        for _ in 0..n_seconds {
            load.advance(&tips, 1.0);
            is_uncertain |= load.transitions().iter().any(|it| matches!(it.kind, TransitionKind::Jump { is_uncertain: true, .. }));
        }
        (load.motion().pose, is_uncertain)
    }

    /// The load with next to no mass on springs that all relax in a second. `lightness` is the time
    /// in which the stiffest spring moves the mass (s).
    pub fn damped(&self, lightness: f64) -> System {
        let mut system = self.system.clone();
        let stiffest = system.springs.iter().map(|spring| spring.radial_stiffness).fold(0.0, f64::max);
        system.load.mass = stiffest * lightness * lightness;
        system.load.inertia = 0.5 * system.load.mass * system.load.radius.powi(2);
        for spring in &mut system.springs {
            spring.damping_ratio = 0.5 * (spring.radial_stiffness / system.load.mass).sqrt();
        }
        // The limits of friction stay, since the ground carries them.
        system
    }

    /// Least length of an attached spring over its rest length (1).
    pub fn shortest(&self, load: &dyn Backend) -> f64 {
        let pose = load.motion().pose;
        let length =
            |(index, spring): (usize, &PolarSpring)| Some((load.tip(index)? - pose.to_world(&spring.root)).norm() / spring.rest_length);
        self.system.springs.iter().enumerate().filter_map(length).fold(f64::INFINITY, f64::min)
    }
}

impl TipPath {
    /// Position at the start of a period (m, world).
    fn at(&self, period: u32) -> Vec2 {
        const PART: u32 = N_PERIODS / 3;
        let part = (period / PART).min(2);
        let share = f64::from(period - part * PART) / f64::from(PART);
        let [from, to] = [part, part + 1].map(|corner| self.corners[corner as usize]);
        from + share * (to - from)
    }
}

/// Supports about the centre of mass, whose limits add up to `limit` (N).
fn supports(seed: u64, radius: f64, limit: f64, draws: &mut Draws) -> Vec<SupportPoint> {
    let first = draws.between(0.0, TAU);
    let mut offsets: Vec<Vec2> = match seed % 4 {
        0 => vec![direction(first), -direction(first)],
        1 => (0..draws.count(3, 4)).map(|_| draws.between(-1.0, 1.0) * direction(first)).collect(),
        2 => (0..3).map(|k| direction(first + f64::from(k) * TAU / 3.0 + draws.between(-0.7, 0.7))).collect(),
        _ => (0..draws.count(5, 8)).map(|_| draws.between(0.1, 1.0).sqrt() * direction(draws.between(0.0, TAU))).collect(),
    };
    if seed % 4 == 1 {
        // Not quite through the centre of mass.
        let aside = draws.between(-0.3, 0.3) * (rotation(0.5 * PI) * direction(first));
        offsets.iter_mut().for_each(|offset| *offset += aside);
    }
    let shares: Vec<f64> = offsets.iter().map(|_| draws.log_between(0.5, 3.0)).collect();
    let sum: f64 = shares.iter().sum();
    let reach = radius * draws.between(0.4, 0.9);
    offsets
        .iter()
        .zip(&shares)
        .map(|(offset, share)| SupportPoint { offset: reach * offset, normal_load: limit * share / sum, friction_coefficient: None })
        .collect()
}
