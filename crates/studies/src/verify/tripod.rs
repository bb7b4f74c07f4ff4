//! Sliding and spinning at once: which support is pinned, and where the load ends.

use super::case::{Bound, Case, Family, Plan};
use super::measured::{Measured, Value};
use super::scenes::{GRAVITY, MASS, MU, SUPPORT_RADIUS, moving, paper_system};
use crate::methods::Method;
use crate::subject::Runs;
use cohaul::backend::{Backend, StepReport};
use cohaul::math::Vec2;
use cohaul::model::System;

/// A start at speed one with `turn_rate` and I = `chi`, and what follows, in units in which the
/// supports' distance, the mass and mu g are one.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    pub name: &'static str,
    pub chi: f64,
    pub turn_rate: f64,
    pub pinning: Option<Pinning>,
    /// x, y, heading.
    pub end: [f64; 3],
    pub stop: f64,
}

/// What happens when a support stops before the others.
#[derive(Clone, Copy, Debug)]
pub struct Pinning {
    pub support: usize,
    pub time: f64,
    pub turn_rate: f64,
}

/// From an independent extrapolation (Gragg, Bulirsch and Stoer) in 28 digits, in logarithmic time
/// toward the stop.
pub const STARTS: [Start; 3] = [
    Start {
        name: "pinned",
        chi: 1.125,
        turn_rate: 0.3,
        pinning: Some(Pinning { support: 0, time: 0.922880197703212, turn_rate: 0.135938290210228 }),
        end: [0.526608062481981, 0.00799629577564152, 0.235877956752436],
        stop: 1.173047974625,
    },
    Start {
        name: "captured-late",
        chi: 1.125,
        turn_rate: 3.0,
        pinning: Some(Pinning { support: 1, time: 3.64099293050153, turn_rate: 0.0111156028753579 }),
        end: [2.20513857583066, 0.0553323017863024, 5.31706331249589],
        stop: 3.66144901874697,
    },
    Start {
        name: "free",
        chi: 0.2,
        turn_rate: 0.3,
        pinning: None,
        end: [0.504212760608845, 0.000104176387120739, 0.0967198726996441],
        stop: 1.00552965937042,
    },
];

const SOURCE: &str = "extrapolation in 28 digits by an independent program";

pub fn cases() -> Vec<Case> {
    let captured = STARTS.into_iter().filter_map(|start| Some(pinning(start, start.pinning?)));
    STARTS.map(end).into_iter().chain(captured).collect()
}

fn end(start: Start) -> Case {
    let step_s = start.stop * time_unit() / 1_000.0;
    let turn = start.end[2].abs().max(1.0);
    let first = Bound::pose(
        2e-3 * turn * SUPPORT_RADIUS,
        4e-3 * turn,
        "twice the speed's share of a step: half the displacement of the first step, and the turn that goes with it",
    );
    let left = 4.0 * turn / 8_000f64.powi(2);
    let limit = Bound::pose(left * SUPPORT_RADIUS, left, "the pinning lies within a step, which leaves some h^2 of the path");
    let share = 1e-6 * turn * turn;
    let second = Bound::pose(share * SUPPORT_RADIUS, share, "the square of a step's share of the slide, times that of the turn");
    let plan = |method| {
        if method == Method::INERTIAL_MIDPOINT {
            return Plan::of_order(2.0, method, step_s, 4, second.clone());
        }
        Plan::first_order(method, step_s, 4, first.clone(), limit.clone())
    };
    Case {
        name: format!("tripod-{}", start.name),
        family: Family::Tripod,
        what: format!("end of a slide with a spin of {} sqrt(mu g / a), I = {} m a^2", start.turn_rate, start.chi),
        source: SOURCE.to_owned(),
        run: Box::new(move |runs| {
            let (mut run, time) = started(&start, runs);
            let mut report = StepReport::default();
            report.add(&run.advance(&[], time));
            report.add(&run.advance(&[], 0.1 * time));
            let pose = run.motion().pose;
            let known = [start.end[0] * SUPPORT_RADIUS, start.end[1] * SUPPORT_RADIUS, start.end[2]];
            let values = Value::pose([pose.position.x, pose.position.y, pose.heading], known);
            Measured { values: values.to_vec(), arm: SUPPORT_RADIUS, report }
        }),
        plans: Method::all_judged_with_inertia().map(plan).collect(),
    }
}

/// A pinned support stays where it is while the load turns about it. The event comes late or early
/// by the method's first order: less than eight steps.
fn pinning(start: Start, Pinning { support, time, turn_rate }: Pinning) -> Case {
    let step_s = start.stop * time_unit() / 1_000.0;
    let rest = Bound::metres(1e-14, "rounding of places of a centimetre over a thousand steps");
    let angle = turn_rate / time_unit() * step_s;
    let middle = Bound::metres(angle * angle * SUPPORT_RADIUS, "(omega h)^2 of the arm: the step holds the support at its end velocity");
    Case {
        name: format!("tripod-{}-stays", start.name),
        family: Family::Tripod,
        what: format!("displacement of the support that is pinned at {time:.4} sqrt(a / mu g), from then to the end"),
        source: "a pinned support sticks".to_owned(),
        run: Box::new(move |runs| {
            let (mut run, stop) = started(&start, runs);
            let offset = system(start.chi).ground.supports[support].offset;
            let n = (stop / runs.step_s).round();
            let first = (time / start.stop * n).ceil() + 8.0;
            let mut report = run.advance(&[], first * runs.step_s);
            let (mut way, mut place) = (0.0, run.motion().pose.to_world(&offset));
            for _ in first as usize..(1.1 * n) as usize {
                report.add(&run.advance(&[], runs.step_s));
                let next: Vec2 = run.motion().pose.to_world(&offset);
                way += (next - place).norm();
                place = next;
            }
            Measured { values: vec![Value::metres(way, 0.0)], arm: SUPPORT_RADIUS, report }
        }),
        plans: vec![Plan::exact(Method::INERTIAL_EULER, step_s, 3, rest), Plan::within(2.0, Method::INERTIAL_MIDPOINT, step_s, 3, middle)],
    }
}

/// sqrt(a / (mu g)) (s).
fn time_unit() -> f64 {
    (SUPPORT_RADIUS / (MU * GRAVITY)).sqrt()
}

fn system(chi: f64) -> System {
    let mut system = paper_system(Vec::new());
    system.load.inertia = chi * MASS * SUPPORT_RADIUS * SUPPORT_RADIUS;
    system
}

/// The load at its start, and the time that it takes to stop (s).
fn started(start: &Start, runs: &Runs) -> (Box<dyn Backend>, f64) {
    let time = time_unit();
    let motion = moving(SUPPORT_RADIUS / time, 0.0, start.turn_rate / time);
    (runs.start(&system(start.chi), motion), start.stop * time)
}
