//! Made-up runs for tests of reports: shaped like real ones, computed by no backend.

use std::f64::consts::FRAC_PI_2;
use std::time::{Duration, SystemTime};

use crate::manifest::Manifest;
use cohaul::backend::{BackendKind, BackendOptions, Doubts, EnergyLedger, Motion, SkipCounts, Status, StepReport, TransitionCounts};
use cohaul::math::{Pose, Summary, Twist, Vec2, direction};
use cohaul::scenario::sha256_hex;
use cohaul::simulation::{Account, AttachedTip, DoubtTimes, Event, EventKind, Outcome, Resolution, Row, Trace};

/// Simulated time between two rows (s).
const TICK: f64 = 0.025;

pub fn options(kind: BackendKind) -> BackendOptions {
    BackendOptions::new(kind, 2.5e-4)
}

/// The manifest of a run on rapier.
pub fn manifest() -> Manifest {
    let scenario = serde_json::json!({ "name": "four ants", "duration_s": 0.1 });
    let hash = sha256_hex(scenario.to_string().as_bytes());
    let started = SystemTime::UNIX_EPOCH + Duration::from_secs(1_709_210_096);
    let command = ["cohaul", "run", "four.json"].map(str::to_owned).to_vec();
    Manifest::new(&scenario, hash, 7, &options(BackendKind::Rapier), command, started)
}

pub fn outcome(arrived: Option<bool>) -> Outcome {
    let mut pulls = Summary::default();
    if arrived.is_some() {
        pulls.extend([0.001, 0.004, 0.0125]);
    }
    Outcome {
        time: 76.1,
        motion: Motion { pose: Pose::new(0.2525, -0.0031, 7.2), twist: Twist { linear: Vec2::new(1e-3, -2e-5), angular: 0.3 } },
        energy: EnergyLedger {
            elastic: 1.1e-4,
            kinetic: 3.3e-9,
            friction: 5.7e-3,
            damping: 1e-7,
            released: 2.1e-3,
            tip_work: 7.9101e-3,
            initial: 1e-9,
            jumps: 2e-7,
            numerical_damping: 3e-8,
            ..EnergyLedger::default()
        },
        steps: StepReport {
            status: Status::Converged,
            residual: 3e-13,
            n_steps: 30_440,
            n_solves: 61_002,
            n_iterations: 183_000,
            n_skipped: 22_830,
            n_not_converged: 0,
            n_rejected: 0,
            contact_residual: 0.0,
            unresolved_rad: 0.0,
            work_error_j: 0.0,
            swing_rad: 0.0,
            lost_share: 0.0,
            gained_share: 0.0,
            is_indeterminate: false,
            doubts: Doubts::default(),
            skipped: SkipCounts { free_load: 15_220, still_tips: 0, stick_certificate: 6_088, distant_ants: 1234 },
        },
        account: Account::default(),
        resolution: Resolution::default(),
        failed_at: None,
        doubtful: DoubtTimes::default(),
        transitions: TransitionCounts { n_slip_onset: 3, n_stop: 2, n_jumps: 1, largest_jump: Some(4e-3), ..TransitionCounts::default() },
        contact_transitions: Vec::new(),
        error: None,
        arrived,
        pulls,
    }
}

/// A run of `n_rows` rows: the load stays for two seconds, then winds towards the nest, stopping
/// and starting. `lag` changes its path by a part in a thousand for each part in a thousand off
/// one; 1 is the run itself.
pub fn trace(n_rows: usize, lag: f64) -> Trace {
    let mut trace = Trace::default();
    for k in 0..n_rows {
        let time = k as f64 * TICK;
        let tips = tips(time, lag);
        record_events(&mut trace, time, &tips);
        trace.rows.push(Row {
            time,
            motion: motion(time, lag),
            energy: energy(time, lag),
            tips: tips.into(),
            contacts: Vec::new(),
            steered: Vec::new(),
            error: None,
        });
    }
    trace
}

/// Progress along the way (m): stops and goes.
fn way(time: f64, lag: f64) -> f64 {
    let moved = (time - 2.0).max(0.0);
    0.004 * lag * (moved - 0.8 * (1.2 * moved).sin() / 1.2)
}

fn pose(time: f64, lag: f64) -> Pose {
    let s = way(time, lag);
    Pose::new(s, 0.03 * (20.0 * s).sin() * lag.powi(3), 0.6 * (9.0 * s).sin() + 2.5 * s * lag)
}

fn motion(time: f64, lag: f64) -> Motion {
    let (before, now) = (pose(time - 1e-4, lag), pose(time, lag));
    let shake = if lag == 1.0 { 0.0 } else { 4e-4 * (40.0 * time).sin() * f64::from(time > 2.0) };
    let linear = (now.position - before.position) / 1e-4 + Vec2::new(shake, shake);
    Motion { pose: now, twist: Twist { linear, angular: (now.heading - before.heading) / 1e-4 } }
}

fn energy(time: f64, lag: f64) -> EnergyLedger {
    let s = way(time, lag);
    EnergyLedger {
        elastic: 1e-4 * (1.0 + (3.0 * time).sin()),
        kinetic: 1e-8 * s,
        friction: 0.022 * s,
        tip_work: 0.0221 * s,
        ..EnergyLedger::default()
    }
}

/// Spring j is held in the first two thirds of every period of its own.
fn tips(time: f64, lag: f64) -> Vec<AttachedTip> {
    let pose = pose(time, lag);
    let held = |j: usize| {
        let period = 6.0 + 2.7 * j as f64;
        let age = (time + 1.3 * j as f64 - 3.0).rem_euclid(period);
        (time > 1.0 && age < period * 2.0 / 3.0).then_some(age)
    };
    let tip = |(j, age): (usize, f64)| {
        let out = direction(pose.heading + FRAC_PI_2 * j as f64);
        AttachedTip { spring: j, position: pose.position + 0.04 * out, pull: (0.0005 + 0.004 * age.min(3.0)) * out }
    };
    (0..4).filter_map(|j| held(j).map(|age| (j, age))).map(tip).collect()
}

fn record_events(trace: &mut Trace, time: f64, tips: &[AttachedTip]) {
    let before = trace.rows.last().map_or(Vec::new(), |row| row.tips.to_vec());
    let holds = |tips: &[AttachedTip], spring: usize| tips.iter().any(|tip| tip.spring == spring);
    let event = |tip: &AttachedTip, kind| Event { time, spring: tip.spring, ant: Some(tip.spring), tip: tip.position, kind };
    let grasps = tips.iter().filter(|tip| !holds(&before, tip.spring)).map(|tip| event(tip, EventKind::Grasp));
    let releases = before.iter().filter(|tip| !holds(tips, tip.spring)).map(|tip| event(tip, EventKind::Release));
    trace.events.extend(grasps.chain(releases));
}
