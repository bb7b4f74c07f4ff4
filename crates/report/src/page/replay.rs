//! What a replay shows: load, supports, springs, ants, nest and obstacles of one run, or of several
//! side by side.
//!
//! Traces are thinned to what an eye needs (`thinning.rs`) and packed (`packed.rs`); runs that meet
//! the same tips share them. Nothing is invented: a support's friction is shown where it slips, mu
//! N against its slip by Eq. (13), and not where it sticks, as any forces within the limits that
//! balance the rest will do there. Searching ants leave no trace; they are walked again from their
//! draws.

use std::f64::consts::TAU;

use serde::Serialize;

use crate::chart::outline::front;
use crate::chart::{Labelled, Scene, trace_color};
use crate::page::packed::Packed;
use crate::page::replay_world::{ContactSlots, Shape, ShownObstacle, obstacles, shapes};
use crate::page::thinning::{Thinned, thinned};
use crate::quantity::quantity;
use crate::transition_words::in_words;
use cohaul::backend::{AttachedTips, BackendKind, EnergyLedger};
use cohaul::math::Vec2;
use cohaul::model::ant::{Ant, Mode};
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Row, Trace, follow_ants};

/// Runs of one scene, ready for a page.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Replay {
    pub name: String,
    pub caption: Vec<String>,
    pub data: Data,
}

/// As the script reads it. Lengths in m, times in s, forces in N, angles in rad.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Data {
    radius: f64,
    /// Outline in the load's frame.
    outline: Vec<Shape>,
    /// Where the heading leaves the outline.
    front: f64,
    obstacles: Vec<ShownObstacle>,
    /// Force of an obstacle whose arrow is as long as the load's radius.
    force_unit: f64,
    /// x, y and radius of arrival.
    nest: Option<[f64; 3]>,
    /// x, y in the load's frame, and mu N.
    supports: Vec<[f64; 3]>,
    /// Number, root and tip at rest in the load's frame.
    springs: Vec<(usize, [f64; 4])>,
    largest_pull: f64,
    /// Speed of slip whose arrow is as long as the load's radius.
    slip_unit: f64,
    /// Slip slower than this is drawn as sticking in all runs.
    rest_below: f64,
    opens_at: f64,
    has_ants: bool,
    stages: Vec<Stage>,
    runs: Vec<Run>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct Stage {
    times: Packed,
    /// x and y of each spring that is shown; no value while it is free.
    tips: Vec<[Packed; 2]>,
    /// x, y and heading of each ant; who holds a tip has two whole turns more.
    ants: Vec<[Packed; 3]>,
    /// Time, kind, spring, ant.
    events: Vec<(f64, &'static str, usize, Option<usize>)>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct Run {
    label: String,
    color: &'static str,
    stage: usize,
    times: Packed,
    x: Packed,
    y: Packed,
    heading: Packed,
    vx: Packed,
    vy: Packed,
    turn_rate: Packed,
    /// Size of the pull of each spring that is shown.
    pulls: Vec<Packed>,
    /// x, y, and force along x and y of each contact; no value while it is open.
    contacts: Vec<[Packed; 4]>,
    /// Time, kind, and what the load did.
    transitions: Vec<(f64, &'static str, String)>,
    /// Slip slower than this is sticking.
    sticks_below: f64,
}

/// Rows that are shown of a run at most, and the room that they may take (bytes, before base64).
const MOST_ROWS: usize = 3000;
const ROOM: usize = 1 << 20;
/// Springs, supports and ants that are drawn at most.
const MOST_PARTS: usize = 200;
/// Marks on the scrub bar at most, of each kind.
const MOST_MARKS: usize = 2000;
/// Over the fastest slip of a run, slower slip counts as none (1): an engine's friction leaves a
/// rest of it.
const STICKS_BELOW: f64 = 1e-4;
/// Slip below this counts as none in any run, in radii of the load in a second (1/s): a load that
/// creeps by rounding is at rest.
const REST: f64 = 1e-6;
/// Added to the heading of an ant that holds a tip: more than one turn, so that rounding cannot
/// blur it.
const HOLDS: f64 = 2.0 * TAU;

impl Replay {
    /// Of runs of `scenario`, with `name` above; it opens at the instant `opens_at` (s).
    pub fn new(name: impl Into<String>, scenario: &Scenario, runs: &[Labelled], opens_at: f64) -> Self {
        let system = &scenario.system;
        let shared = runs.windows(2).all(|pair| same_times(pair[0].trace, pair[1].trace));
        let parts = Parts::of(scenario, runs);
        let most = (ROOM / parts.bytes_a_row(runs.len(), shared)).clamp(2, MOST_ROWS);
        let groups: Vec<Vec<&Trace>> =
            if shared { vec![runs.iter().map(|run| run.trace).collect()] } else { runs.iter().map(|run| vec![run.trace]).collect() };
        let rows: Vec<Thinned> = groups.iter().map(|traces| thinned(traces, system.load.radius, most)).collect();
        let stages = groups.iter().zip(&rows).filter_map(|(traces, rows)| Some(stage(scenario, traces.first()?, rows, &parts)));
        let of_run = |(at, run): (usize, &Labelled)| {
            let stage = if shared { 0 } else { at };
            run_of(scenario, run, at, stage, &rows[stage], &parts)
        };
        let limits: Vec<f64> = system.ground.slip_limits().collect();
        let data = Data {
            radius: system.load.radius,
            outline: shapes(&system.world.outline),
            front: front(&system.world.outline),
            obstacles: obstacles(&system.world, runs.first().map(|run| run.trace)),
            force_unit: seldom_exceeded(forces(runs)),
            nest: Scene::of(scenario).nest.map(|nest| [nest.position.x, nest.position.y, nest.arrival_radius]),
            supports: parts
                .supports
                .iter()
                .map(|i| [system.ground.supports[*i].offset.x, system.ground.supports[*i].offset.y, limits[*i]])
                .collect(),
            springs: parts.springs.iter().map(|i| (*i, ends(&system.springs[*i]))).collect(),
            largest_pull: largest_pull(runs),
            slip_unit: seldom_exceeded(runs.iter().flat_map(|run| slips(scenario, run.trace))),
            rest_below: rest_below(scenario),
            opens_at,
            has_ants: parts.n_ants > 0,
            stages: stages.collect(),
            runs: runs.iter().enumerate().map(of_run).collect(),
        };
        let caption = caption(&parts, &rows, &data);
        Self { name: name.into(), caption, data }
    }
}

impl Replay {
    /// Of a scene before it begins, on backends with these names: what a live page draws first.
    pub fn at_start(scenario: &Scenario, labels: &[&str]) -> Self {
        let (motion, tips, energy) = (scenario.start, AttachedTips::new(), EnergyLedger::default());
        let row = Row { time: 0.0, motion, energy, tips, contacts: Vec::new(), steered: Vec::new(), error: None };
        let trace = Trace { rows: vec![row], ..Trace::default() };
        let runs: Vec<Labelled> = labels.iter().map(|label| Labelled { label, trace: &trace }).collect();
        Self::new(scenario.name.clone(), scenario, &runs, 0.0)
    }

    /// Numbers of the springs that are drawn, in their order.
    pub fn springs(&self) -> impl Iterator<Item = usize> + '_ {
        self.data.springs.iter().map(|(number, _)| *number)
    }

    pub fn n_ants(&self) -> usize {
        self.data.stages.first().map_or(0, |stage| stage.ants.len())
    }
}

fn ends(spring: &cohaul::model::PolarSpring) -> [f64; 4] {
    let tip = spring.rest_tip();
    [spring.root.x, spring.root.y, tip.x, tip.y]
}

/// Which of a scene's parts are drawn.
struct Parts {
    springs: Vec<usize>,
    supports: Vec<usize>,
    n_ants: usize,
    contacts: ContactSlots,
    /// All there are.
    n_all: [usize; 3],
}

impl Parts {
    /// Springs that are held at some time come first, the others evenly.
    fn of(scenario: &Scenario, runs: &[Labelled]) -> Self {
        let n_ants = if let Drive::Ants(drive) = &scenario.drive { drive.n_ants } else { 0 };
        let n_all = [scenario.system.springs.len(), scenario.system.ground.supports.len(), n_ants];
        let mut is_held = vec![false; n_all[0]];
        runs.iter().flat_map(|run| &run.trace.events).for_each(|event| is_held[event.spring] = true);
        let (held, others): (Vec<usize>, Vec<usize>) = (0..n_all[0]).partition(|spring| is_held[*spring]);
        let mut springs = evenly(&held, MOST_PARTS);
        springs.extend(evenly(&others, MOST_PARTS - springs.len()));
        springs.sort_unstable();
        let supports = evenly(&(0..n_all[1]).collect::<Vec<_>>(), MOST_PARTS);
        let contacts = ContactSlots::of(runs.iter().map(|run| run.trace));
        Self { springs, supports, n_ants: n_ants.min(MOST_PARTS), contacts, n_all }
    }

    /// Of all runs together, at every row.
    fn bytes_a_row(&self, n_runs: usize, shared: bool) -> usize {
        let n_stages = if shared { 1 } else { n_runs };
        n_runs * (22 + 2 * self.springs.len() + 8 * self.contacts.len()) + n_stages * (4 + 4 * self.springs.len() + 6 * self.n_ants)
    }
}

/// At most `most` of all.
fn evenly<T: Copy>(all: &[T], most: usize) -> Vec<T> {
    (0..all.len().min(most)).map(|k| all[k * all.len() / all.len().min(most)]).collect()
}

fn same_times(one: &Trace, other: &Trace) -> bool {
    one.rows.len() == other.rows.len() && one.rows.iter().zip(&other.rows).all(|(a, b)| a.time == b.time) && one.events == other.events
}

fn stage(scenario: &Scenario, trace: &Trace, thinned: &Thinned, parts: &Parts) -> Stage {
    let rows: Vec<&Row> = thinned.rows.iter().map(|at| &trace.rows[*at]).collect();
    let tip = |row: &Row, spring: usize| row.tips.iter().find(|tip| tip.spring == spring).map(|tip| tip.position);
    let axis = |spring: usize, axis: usize| Packed::short(&rows.iter().map(|row| tip(row, spring).map(|at| at[axis])).collect::<Vec<_>>());
    Stage {
        times: Packed::long(&rows.iter().map(|row| Some(row.time)).collect::<Vec<_>>()),
        tips: parts.springs.iter().map(|spring| [axis(*spring, 0), axis(*spring, 1)]).collect(),
        ants: ants(scenario, trace, thinned, parts.n_ants),
        events: evenly(&trace.events, MOST_MARKS).iter().map(|it| (it.time, it.kind.name(), it.spring, it.ant)).collect(),
    }
}

/// Ants at the rows that are shown.
fn ants(scenario: &Scenario, trace: &Trace, thinned: &Thinned, n_ants: usize) -> Vec<[Packed; 3]> {
    let mut seen: Vec<[Vec<Option<f64>>; 3]> = vec![Default::default(); n_ants];
    let mut next = 0;
    follow_ants(scenario, trace, |row, ants: &[Ant]| {
        if thinned.rows.get(next) != Some(&row) {
            return;
        }
        next += 1;
        for (ant, seen) in ants.iter().zip(&mut seen) {
            let held = matches!(ant.mode, Mode::Transport { .. });
            let heading = ant.heading.rem_euclid(TAU) + if held { HOLDS } else { 0.0 };
            for (series, value) in seen.iter_mut().zip([ant.position.x, ant.position.y, heading]) {
                series.push(Some(value));
            }
        }
    });
    seen.iter().map(|series| series.each_ref().map(|values| Packed::short(values))).collect()
}

fn run_of(scenario: &Scenario, run: &Labelled, at: usize, stage: usize, thinned: &Thinned, parts: &Parts) -> Run {
    let rows: Vec<&Row> = thinned.rows.iter().map(|at| &run.trace.rows[*at]).collect();
    let series = |value: &dyn Fn(&Row) -> f64| rows.iter().map(|row| Some(value(row))).collect::<Vec<_>>();
    let (long, short) =
        (|value: &dyn Fn(&Row) -> f64| Packed::long(&series(value)), |value: &dyn Fn(&Row) -> f64| Packed::short(&series(value)));
    let pull = |spring: usize| {
        let of_row = |row: &&Row| row.tips.iter().find(|tip| tip.spring == spring).map(|tip| tip.pull.norm());
        Packed::short(&rows.iter().map(of_row).collect::<Vec<_>>())
    };
    Run {
        label: run.label.to_owned(),
        color: color(run.label, at),
        stage,
        times: long(&|row| row.time),
        x: long(&|row| row.motion.pose.position.x),
        y: long(&|row| row.motion.pose.position.y),
        heading: long(&|row| row.motion.pose.heading),
        vx: short(&|row| row.motion.twist.linear.x),
        vy: short(&|row| row.motion.twist.linear.y),
        turn_rate: short(&|row| row.motion.twist.angular),
        pulls: parts.springs.iter().map(|spring| pull(*spring)).collect(),
        contacts: parts.contacts.series(&rows),
        transitions: evenly(&run.trace.transitions, MOST_MARKS)
            .iter()
            .map(|it| (it.time, it.kind.name(), in_words(&it.kind, &scenario.system.world)))
            .collect(),
        sticks_below: slips(scenario, run.trace).map(|slip| STICKS_BELOW * slip).fold(rest_below(scenario), f64::max),
    }
}

/// Slip that counts as none in any run (m/s).
fn rest_below(scenario: &Scenario) -> f64 {
    REST * scenario.system.load.radius
}

/// A backend has the same colour in all drawings, beside which others it may stand.
fn color(label: &str, at: usize) -> &'static str {
    trace_color(BackendKind::ALL.iter().position(|kind| kind.name() == label).unwrap_or(at))
}

/// Slip speed of the fastest support in every row (m/s).
fn slips<'a>(scenario: &'a Scenario, trace: &'a Trace) -> impl Iterator<Item = f64> + 'a {
    let arms = |row: &'a Row| {
        let turn = cohaul::math::rotation(row.motion.pose.heading);
        scenario.system.ground.supports.iter().map(move |support| turn * support.offset)
    };
    let slip = move |row: &'a Row| {
        let twist = &row.motion.twist;
        let of_arm = move |arm: Vec2| twist.velocity_at(&arm).norm();
        arms(row).map(of_arm).filter(|speed| speed.is_finite()).fold(0.0, f64::max)
    };
    trace.rows.iter().map(slip)
}

/// A value that few of those above zero exceed: arrows of it fit, and those of most others can be
/// seen.
fn seldom_exceeded(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.filter(|value| *value > 0.0).collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() * 95 / 100).copied().unwrap_or(0.0)
}

/// Sizes of the forces of obstacles on the loads (N).
fn forces<'a>(runs: &'a [Labelled]) -> impl Iterator<Item = f64> + 'a {
    let contacts = runs.iter().flat_map(|run| &run.trace.rows).flat_map(|row| &row.contacts);
    contacts.map(|contact| contact.force.norm()).filter(|force| force.is_finite())
}

fn largest_pull(runs: &[Labelled]) -> f64 {
    let pulls = runs.iter().flat_map(|run| &run.trace.rows).flat_map(|row| &row.tips).map(|tip| tip.pull.norm());
    pulls.filter(|pull| pull.is_finite()).fold(0.0, f64::max)
}

/// How the drawing is to be read, and what it leaves out.
fn caption(parts: &Parts, rows: &[Thinned], data: &Data) -> Vec<String> {
    let mut notes = Vec::new();
    if data.supports.iter().any(|support| support[2] > 0.0) {
        notes.push(
            "A slipping support has an arrow of its slip velocity and one of the friction on the load, mu N against it (Eq. 13). A sticking one has none: \
             any forces within the limits that balance the pulls hold it, so its own is not known."
                .to_owned(),
        );
        let [unit, rest] = [data.slip_unit, data.rest_below].map(|speed| quantity(speed, "m/s"));
        notes.push(format!("Slip of {unit} has an arrow as long as the load's radius; faster slip is cut there and has a second head."));
        notes.push(format!("Slip below {rest}, or below a ten-thousandth of the fastest slip of the run, is drawn as sticking."));
    }
    if data.force_unit > 0.0 {
        let unit = quantity(data.force_unit, "N");
        notes.push(format!("A force of {unit} from an obstacle has an arrow as long as the load's radius; a larger one is cut there."));
    }
    if data.has_ants {
        notes.push("Searching ants are walked again from the run's own draws; those that pull stand at the recorded tips.".to_owned());
    }
    let n_rows = rows.iter().map(|thinned| thinned.rows.len()).max().unwrap_or(0);
    let deviation = rows.iter().map(|thinned| thinned.deviation).fold(0.0, f64::max);
    let between = if deviation > 0.0 {
        format!("; between them the edge displacement from the true pose is at most {}", quantity(deviation, "m"))
    } else {
        String::new()
    };
    notes.push(format!("{n_rows} instants of each run are kept here{between}."));
    for ((n_all, n_drawn), name) in
        parts.n_all.iter().zip([parts.springs.len(), parts.supports.len(), parts.n_ants]).zip(["springs", "supports", "ants"])
    {
        if *n_all > n_drawn {
            notes.push(format!("{n_drawn} of {n_all} {name} are drawn."));
        }
    }
    notes
}
