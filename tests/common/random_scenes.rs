//! Random scenarios, one per seed: many different scenes for tests and calibrations.
//!
//! | what | distribution (log: uniform in the logarithm) |
//! |---|---|
//! | load | radius log 6-25 mm; inertia 0.3-1 times m R^2; mass log 3e-5-0.3 kg; a sixth start with speed |
//! | friction, half of the scenes | limit log 10-50 mN whatever the mass |
//! | friction, the others | mu log 0.2-1.5 under gravity, so that the limit scales with the mass |
//! | supports | a tripod, or 3-6 points about the centre of mass with equal or unequal loads |
//! | springs | 1-10, a ring or irregular; lengths 1-3 radii; in a seventh of the scenes without rest length |
//! | stiffness | the attached springs together reach the friction limit at a stretch of log 0.03-0.45 lengths |
//! | damping ratio | none in a third of the scenes, else uniform up to 1, in a quarter up to 2 |
//! | drive: haul (half) | tips ahead move along one path of 2-5 parts at log 1 mm/s-0.3 m/s, attached and released now and then |
//! | drive: spread (a third) | tips all around are pulled outwards and released one by one |
//! | drive: ants (a sixth) | 1-10 of the default ants on the paper's springs, for 4-8 s |
//! | time | 1.5-4 s with control periods of 1, 2.5 or 5 ms |
//!
//! Tips keep away from the roots of their springs and swings stay moderate. A tip is attached where
//! the load should be by then: at a point on a string that is dragged behind the tips.

use std::f64::consts::{PI, TAU};

use cohaul::math::{RandomStreams, Stream, Vec2, direction, wrap_to_pi};
use cohaul::model::{SideFrictionRule, paper};
use cohaul::scenario::Scenario;
use cohaul::scenario::format::{
    DriveEntry, GroundEntry, LoadEntry, PathEntry, ScenarioFile, SpringEntry, SpringsEntry, SupportEntry, SupportsEntry, TipsEntry,
    TipsKind,
};
use serde_json::json;

/// The random scenario of this seed, from the distribution in the table above.
pub fn random_scenario(seed: u64) -> Scenario {
    let draws = &mut Draws { streams: RandomStreams::new(seed), n: 0 };
    let kind = match draws.unit() {
        share if share < 1.0 / 2.0 => Kind::Haul,
        share if share < 5.0 / 6.0 => Kind::Spread,
        _ => Kind::Ants,
    };
    let name = format!("random scenario {seed}");
    file(seed, name.clone(), kind, draws).checked(&name).expect("draws obey the rules of the format")
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Haul,
    Spread,
    Ants,
}

/// Uniform draws, one after the other: all of them functions of the seed.
struct Draws {
    streams: RandomStreams,
    n: u64,
}

impl Draws {
    /// In (0, 1).
    fn unit(&mut self) -> f64 {
        self.n += 1;
        self.streams.uniform(Stream::Scene, 0, self.n)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// From `low` to `high`, both included.
    fn count(&mut self, low: usize, high: usize) -> usize {
        low + (self.unit() * (high - low + 1) as f64) as usize
    }

    fn happens(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    fn one_of<const N: usize>(&mut self, values: [f64; N]) -> f64 {
        values[self.count(0, N - 1)]
    }
}

fn file(seed: u64, name: String, kind: Kind, draws: &mut Draws) -> ScenarioFile {
    let duration_s = if kind == Kind::Ants { draws.between(4.0, 8.0) } else { draws.between(1.5, 4.0) };
    let control_period_s = draws.one_of([1e-3, 2.5e-3, 5e-3]);
    let (mut load, mut radius) = load(draws);
    if kind == Kind::Ants {
        radius = paper::LOAD_RADIUS_M;
        load.radius_m = Some(radius);
        load.inertia_kg_m2 = None;
    }
    let (ground, limit) = ground(&load, radius, kind, draws);
    let mut springs = springs(radius, kind, draws);
    let drive = match kind {
        Kind::Haul => haul(&mut springs, &load, limit, duration_s, draws),
        Kind::Spread => spread(&mut springs, &load, limit, duration_s, draws),
        Kind::Ants => ants(&mut springs, draws),
    };
    let springs = springs.into_iter().map(SpringsEntry::One).collect();
    let (obstacles, side_friction_rule) = (Vec::new(), SideFrictionRule::default());
    ScenarioFile {
        schema: None,
        format: None,
        name,
        duration_s,
        control_period_s,
        seed,
        load,
        ground,
        springs,
        obstacles,
        side_friction_rule,
        drive,
    }
}

/// The load, and its radius (m).
fn load(draws: &mut Draws) -> (LoadEntry, f64) {
    let (mass_kg, radius_m) = (draws.log_between(3e-5, 0.3), draws.log_between(6e-3, 25e-3));
    let inertia = draws.between(0.3, 1.0) * mass_kg * radius_m * radius_m;
    let position_m = [draws.between(-0.1, 0.1), draws.between(-0.1, 0.1)];
    let heading_rad = draws.between(-PI, PI);
    let moves = draws.happens(1.0 / 6.0);
    let (speed, way, turn_rate) = (draws.log_between(3e-3, 0.2), draws.between(0.0, TAU), draws.between(-3.0, 3.0));
    let load = LoadEntry {
        mass_kg: Some(mass_kg),
        inertia_kg_m2: Some(inertia),
        radius_m: Some(radius_m),
        position_m,
        heading_rad,
        velocity_m_per_s: if moves { (speed * direction(way)).into() } else { [0.0; 2] },
        turn_rate_rad_per_s: if moves { turn_rate } else { 0.0 },
        ..LoadEntry::default()
    };
    (load, radius_m)
}

/// The ground below a load of this radius (m), and the friction force that it can take (N).
fn ground(load: &LoadEntry, load_radius: f64, kind: Kind, draws: &mut Draws) -> (GroundEntry, f64) {
    const GRAVITY: f64 = 9.81;
    let weight = load.mass_kg.expect("it is given") * GRAVITY;
    let is_fixed = draws.happens(0.5);
    let (limit, friction) = (draws.log_between(0.01, 0.05), draws.log_between(0.2, 1.5));
    let friction_coefficient = match (kind, is_fixed) {
        (Kind::Ants, _) => 0.022 / weight,
        (_, true) => limit / weight,
        (_, false) => friction,
    };
    let n = if draws.happens(0.5) { 3 } else { draws.count(3, 6) };
    let (first, radius) = (draws.between(0.0, TAU), draws.between(0.4, 0.9) * load_radius);
    let (jitter, unequal) = (if draws.happens(0.5) { 0.3 } else { 0.0 }, if draws.happens(0.5) { 0.5 } else { 0.0 });
    let mut offsets = Vec::new();
    let mut shares = Vec::new();
    for index in 0..n {
        let bearing = first + (index as f64 + draws.between(-jitter, jitter)) * TAU / n as f64;
        offsets.push(radius * (1.0 - jitter * draws.unit()) * direction(bearing));
        shares.push(1.0 + draws.between(-unequal, unequal));
    }
    // The weight acts at the middle of what the supports carry.
    let sum: f64 = shares.iter().sum();
    let middle = offsets.iter().zip(&shares).map(|(offset, share)| offset * (share / sum)).sum::<Vec2>();
    let support = |(offset, share): (&Vec2, &f64)| SupportEntry {
        offset_m: (offset - middle).into(),
        normal_load_n: Some(weight * share / sum),
        friction_coefficient: None,
    };
    let supports = SupportsEntry::List(offsets.iter().zip(&shares).map(support).collect());
    (GroundEntry { friction_coefficient, gravity_m_per_s2: Some(GRAVITY), supports }, friction_coefficient * weight)
}

/// Springs of unit stiffness: the drive that holds them says how stiff they are.
fn springs(radius: f64, kind: Kind, draws: &mut Draws) -> Vec<SpringEntry> {
    let (n, is_ring, has_length) = (draws.count(1, 10), draws.happens(0.6), kind == Kind::Ants || !draws.happens(1.0 / 7.0));
    let (first, length) = (draws.between(0.0, TAU), draws.between(1.0, 3.0) * radius);
    let torsion = draws.log_between(0.2, 2.0);
    let highest = draws.one_of([0.0, 1.0, 1.0, 2.0]);
    let damping_ratio = if draws.happens(0.1) { 0.0 } else { highest * draws.unit() };
    let damped = SpringEntry { damping_ratio, ..SpringEntry::default() };
    let spring = |index: usize, draws: &mut Draws| {
        let [aside, turned, inwards, longer, softer] = if is_ring || kind == Kind::Ants {
            [0.0, 0.0, 1.0, 1.0, 1.0]
        } else {
            [
                draws.between(-0.4, 0.4),
                draws.between(-0.4, 0.4),
                draws.between(0.5, 1.0),
                draws.between(0.8, 1.2),
                draws.log_between(0.5, 2.0),
            ]
        };
        let bearing = first + (index as f64 + aside) * TAU / n as f64;
        let rest_length_m = if has_length { length * longer } else { 0.0 };
        SpringEntry {
            root_m: (radius * inwards * direction(bearing)).into(),
            bearing_rad: bearing + turned,
            rest_length_m,
            radial_stiffness_n_per_m: softer,
            torsional_stiffness_nm_per_rad: softer * torsion * rest_length_m * rest_length_m,
            ..damped
        }
    };
    (0..n).map(|index| spring(index, draws)).collect()
}

/// Multiplies all stiffnesses so that `n_held` springs together reach `limit` (N) at a stretch of
/// `slack` (m).
fn stiffen(springs: &mut [SpringEntry], n_held: usize, limit: f64, slack: f64) {
    let factor = limit / (n_held as f64 * slack);
    for spring in springs {
        spring.radial_stiffness_n_per_m *= factor;
        spring.torsional_stiffness_nm_per_rad *= factor;
    }
}

/// Where the undeformed spring ends when the load is `shift` away from its start (m, world).
fn rest_tip(spring: &SpringEntry, load: &LoadEntry, shift: Vec2) -> Vec2 {
    let [x, y] = spring.root_m;
    let root = (x * direction(load.heading_rad)) + y * direction(load.heading_rad + 0.5 * PI);
    Vec2::from(load.position_m) + shift + root + spring.rest_length_m * direction(load.heading_rad + spring.bearing_rad)
}

/// Length that deformations are measured by (m).
fn extent(springs: &[SpringEntry], load: &LoadEntry) -> f64 {
    springs.iter().map(|spring| spring.rest_length_m).fold(load.radius_m.unwrap_or(0.0), f64::max)
}

/// Corners of the way that all tips go: time (s) and displacement (m).
type Way = Vec<(f64, Vec2)>;

fn haul(springs: &mut [SpringEntry], load: &LoadEntry, limit: f64, duration: f64, draws: &mut Draws) -> DriveEntry {
    // Ahead is where the first spring points, more or less.
    let ahead = load.heading_rad + springs[0].bearing_rad + draws.between(-0.4, 0.4);
    let is_ahead = |spring: &SpringEntry| wrap_to_pi(load.heading_rad + spring.bearing_rad - ahead).abs() < 1.2;
    let held: Vec<usize> = (0..springs.len()).filter(|index| *index == 0 || is_ahead(&springs[*index])).collect();
    let slack = draws.log_between(0.03, 0.45) * extent(springs, load);
    stiffen(springs, held.len(), limit, slack);
    let way = way(ahead, draws.log_between(1e-3, 0.3), 6.0 * extent(springs, load), duration, draws);
    let paths = held.iter().map(|index| {
        let is_late = *index > 0 && draws.happens(0.5);
        let grasp = if is_late { duration * draws.between(0.1, 0.6) } else { 0.0 };
        let release_s = draws.happens(0.5).then(|| draws.between(grasp + 0.1 * duration, duration));
        let start = rest_tip(&springs[*index], load, dragged(&way, slack, grasp)) - along(&way, grasp);
        let reach = 0.15 * slack * direction(draws.between(0.0, TAU));
        let corners = way.iter().filter(|(time, _)| *time > grasp).map(|(time, shift)| point(*time, start + shift + reach));
        let waypoints = [point(grasp, start + along(&way, grasp))].into_iter().chain(corners).collect();
        PathEntry { spring: *index, waypoints, release_s }
    });
    DriveEntry::Tips(TipsEntry { kind: TipsKind::Tips, paths: paths.collect() })
}

/// A way of 2-5 legs that turns by up to 0.7 rad at its corners, turns back now and then, and rests
/// on some legs; at most `longest` (m) in all.
fn way(ahead: f64, speed: f64, longest: f64, duration: f64, draws: &mut Draws) -> Way {
    let n = draws.count(2, 5);
    let mut way = vec![(0.0, Vec2::zeros())];
    let (mut bearing, mut gone) = (ahead, 0.0);
    for index in 0..n {
        let (time, place) = way[index];
        let end = if index + 1 == n { draws.between(0.8, 1.2) } else { (index as f64 + draws.between(0.6, 1.0)) / n as f64 };
        let pace = speed * if draws.happens(0.25) { 0.0 } else { draws.between(0.3, 1.0) };
        let back = if draws.happens(0.1) { -0.3 } else { 1.0 };
        let length = (pace * (end * duration - time)).min(longest - gone).max(0.0);
        gone += length;
        way.push((end * duration, place + back * length * direction(bearing)));
        bearing = ahead + draws.between(-0.7, 0.7);
    }
    way
}

/// Displacement on a way at `time` (m).
fn along(way: &Way, time: f64) -> Vec2 {
    let leg = way.windows(2).find(|leg| time < leg[1].0);
    leg.map_or(way[way.len() - 1].1, |leg| leg[0].1 + (time - leg[0].0) / (leg[1].0 - leg[0].0) * (leg[1].1 - leg[0].1))
}

/// Displacement at `time` of a point on a string of length `slack` behind the way (m).
fn dragged(way: &Way, slack: f64, time: f64) -> Vec2 {
    const N: u32 = 200;
    (1..=N).fold(Vec2::zeros(), |place: Vec2, step| {
        let behind = along(way, time * f64::from(step) / f64::from(N)) - place;
        place + behind * (1.0 - slack / behind.norm().max(slack))
    })
}

/// Each tip goes outwards by its own stretch, all around; some are let go, and some go on slowly to
/// one side.
fn spread(springs: &mut [SpringEntry], load: &LoadEntry, limit: f64, duration: f64, draws: &mut Draws) -> DriveEntry {
    let n = springs.len();
    let slack = draws.log_between(0.05, 0.45) * extent(springs, load);
    stiffen(springs, n.div_ceil(2), limit, slack);
    let (drift, aside) = (draws.between(0.0, 1.5) * slack, direction(draws.between(0.0, TAU)));
    let paths = (0..n).map(|index| {
        let spring = &springs[index];
        let start = rest_tip(spring, load, Vec2::zeros());
        let outwards = direction(load.heading_rad + spring.bearing_rad + draws.between(-0.3, 0.3));
        let stretched = start + draws.between(0.5, 2.0) * slack * outwards;
        let (begin, end) = (draws.between(0.0, 0.1) * duration, draws.between(0.2, 0.5) * duration);
        let release_s = draws.happens(0.6).then(|| draws.between(end, 1.1 * duration));
        let waypoints = vec![point(begin, start), point(end, stretched), point(duration, stretched + drift * aside)];
        PathEntry { spring: index, waypoints, release_s }
    });
    DriveEntry::Tips(TipsEntry { kind: TipsKind::Tips, paths: paths.collect() })
}

fn ants(springs: &mut [SpringEntry], draws: &mut Draws) -> DriveEntry {
    for spring in springs.iter_mut() {
        spring.rest_length_m = paper::REST_LENGTH_M;
        spring.radial_stiffness_n_per_m = paper::RADIAL_STIFFNESS_N_PER_M;
        spring.torsional_stiffness_nm_per_rad = paper::TORSIONAL_STIFFNESS_NM_PER_RAD;
    }
    let pull_speed = draws.between(0.02, 0.08);
    let nest: [f64; 2] = (0.4 * direction(draws.between(0.0, TAU))).into();
    let ants = json!({
        "kind": "ants", "n_ants": draws.count(1, 10), "start_half_width_m": 0.05,
        "pull_speed_m_per_s": pull_speed, "nest_position_m": nest,
    });
    serde_json::from_value(ants).expect("the entry has the shape of the format")
}

fn point(time: f64, position: Vec2) -> [f64; 3] {
    [time, position.x, position.y]
}
