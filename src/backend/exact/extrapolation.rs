//! Macro-steps under error control: a first-order step, extrapolated, and restarted where the
//! contact mode changes.
//!
//! A macro-step of length H is taken by 1, 2, 3 ... equal steps of the method. Their errors are a
//! series in whole powers of the step as long as no support starts or stops slipping on the way.
//! Neville's table over the step (Aitken, 1932; Neville, 1934; for implicit Euler Deuflhard, 1983)
//! removes one power a column:
//!
//! ```text
//! T(n, 1) = n steps    T(n, k + 1) = T(n, k) + (T(n, k) - T(n - 1, k)) (n - k) / k
//! ```
//!
//! Columns are added until the last two agree within the tolerance. A load that sticks in all rows
//! sticks exactly, and nothing is left to extrapolate.
//!
//! The series breaks off where the contact mode changes on the way, or a support reverses. The
//! table need not show it: a change in the first step of all rows leaves a series, toward the
//! answer with the change at the start. Such a macro-step is cut at the change, by halves, until
//! the plain answers of one and two steps agree within the tolerance. That macro-step is taken as
//! it stands, so that the change is located to its length, and the order starts anew behind it.
//! Attachments, releases and corners of tip paths fall between advances and are instants of their
//! own already.

use super::control::{Column, Task};
use super::load::{Exact, Method, Snapshot};
use super::progress::{Effort, Progress};
use crate::backend::friction::ContactMode;
use crate::backend::numerics::{AIM, FASTEST_GROWTH, FAVOURED_ROWS, FORCED_GROWTH, LONGEST_SHORTEST, MOST_ROWS, SHORTENED_TO_SOLVE};
use crate::backend::report::{Motion, Status, StepReport, Transition, TransitionKind};
use crate::backend::springs::TipPaths;
use crate::math::{Vec2, rotation};
use crate::model::System;
use crate::stop;

/// Moves the load along the whole paths, at the pace that the last advance left.
pub fn advance<M: Method>(load: &mut Exact<M>, task: &Task) -> StepReport {
    let mut report = StepReport::default();
    let duration = task.paths.duration;
    let longest = task.longest / duration;
    let (mut now, mut effort) = (Progress::new(&load.pace, duration, longest), Effort::new(longest));
    load.pace.allow_work(duration);
    while now.at < 1.0 && report.status != Status::Failed {
        now.shortest = effort.shortest_after(load, &mut report, now.shortest);
        let limit = load.until_waypoint(&task.paths, [now.at, now.change_by.unwrap_or(1.0)]);
        let least = now.shortest.max((M::shortest_macro_step(load, task) / duration).min(longest)).max(now.to_jump);
        now.macro_step = now.macro_step.min(longest).max(least);
        let to = if limit - now.at <= 1.01 * now.macro_step { limit } else { now.at + now.macro_step };
        meet_waypoint(load, &task.paths, [now.at, to], &mut report);
        let (start, before) = (load.snapshot(), report);
        let is_shortest = to - now.at <= LONGEST_SHORTEST * least;
        let limits = Limits { is_shortest, may_wait: !is_shortest || to < limit, is_given_up: effort.is_given_up };
        let tried = attempt(load, task, &start, [now.at, to], limits, &mut report);
        let has_jumped = M::has_jumped(load);
        M::allow_jumps(load, true);
        match tried {
            Attempt::Taken { growth, error, n_rows } => {
                let touches = !start.state.side.touching.is_empty();
                let is_favoured = if touches { n_rows < MOST_ROWS && load.pace.trial.is_due() } else { n_rows < FAVOURED_ROWS };
                let is_solved = report.n_not_converged == before.n_not_converged;
                // With inertia the load goes on from wherever it is.
                let decides_jumps = M::shortest_macro_step(load, task) > 0.0;
                if is_shortest && !is_solved && decides_jumps {
                    effort.give_up(load, &mut report);
                }
                if error > 1.0 {
                    now.shortest *= FORCED_GROWTH;
                    now.had_answers &= is_solved;
                }
                note_taken(load, (&start, has_jumped, effort.is_given_up), before.doubts.n_not_unique, to * duration, &mut report);
                now.take(to, if is_favoured { growth.max(2.0) } else { growth });
            }
            Attempt::NoBalance => {
                load.reset(&start);
                report.n_rejected += 1;
                now.seek_balance(to, is_shortest);
            }
            Attempt::TooLong { macro_step, change } => {
                load.reset(&start);
                if change.is_none() {
                    load.pace.trial.fail();
                }
                report.n_rejected += 1;
                let is_held_up = effort.is_held_up(load, now.at);
                now.shorten(if is_held_up { macro_step.min(0.5 * (to - now.at)) } else { macro_step }, change);
            }
        }
    }
    now.hand_on(&mut load.pace, duration);
    report
}

/// Records what has happened in a macro-step since the `start` of it, whether the load is known to
/// have jumped and whether the rest of the advance is given up. It ends at `time` (s).
fn note_taken<M: Method>(
    load: &mut Exact<M>,
    (start, has_jumped, is_given_up): (&Snapshot<M::Memory>, bool, bool),
    n_not_unique: u64,
    time: f64,
    report: &mut StepReport,
) {
    let kind = load.state.contact.transition_from(start.state.contact.last());
    let kinds = complete_snap_through(load, start, has_jumped, report).into_iter().chain(kind);
    load.transitions.extend(kinds.map(|kind| Transition { time, kind }));
    if load.obstacles.is_some() {
        load.note_not_unique(n_not_unique, report, time);
        load.note_contacts(&start.state.side.touching, time);
        load.pass_gate(report, time, is_given_up);
    }
}

/// What an attempt may do.
#[derive(Clone, Copy)]
struct Limits {
    /// Whether the macro-step is not shortened.
    is_shortest: bool,
    /// Whether another macro-step is tried where there is no balance near the end of this one.
    may_wait: bool,
    /// Whether it is taken by a single step, whatever that is worth.
    is_given_up: bool,
}

enum Attempt {
    Taken {
        /// Factor by which the next macro-step may be longer (1).
        growth: f64,
        /// Error over the tolerance (1): above one for a macro-step that could not be shortened.
        error: f64,
        /// Number of rows of the table.
        n_rows: usize,
    },
    /// There is no balance near the end of the macro-step, and none to which the load jumps. It
    /// does once tips and obstacles have moved beyond the last balance by more than rounding.
    NoBalance,
    TooLong {
        /// Share to try instead.
        macro_step: f64,
        /// Share of the paths by which the contact mode changes.
        change: Option<f64>,
    },
}

/// One macro-step from `start` between two shares of the paths. One that is taken leaves the load
/// at its end.
fn attempt<M: Method>(
    load: &mut Exact<M>,
    task: &Task,
    start: &Snapshot<M::Memory>,
    [from, to]: [f64; 2],
    Limits { is_shortest, may_wait, is_given_up }: Limits,
    report: &mut StepReport,
) -> Attempt {
    let (length, Task { control, paths, .. }) = (to - from, task);
    load.reset(start);
    M::allow_jumps(load, is_shortest && !is_given_up);
    let before = load.flow();
    let (mut last_row, touches) = (Vec::<Vec<f64>>::new(), !start.state.side.touching.is_empty());
    let (mut last_error, mut n_rises, mut changed_before) = (f64::INFINITY, 0, None);
    for n in 1..=MOST_ROWS {
        let Row { flow, cost, changed_in } = row(load, paths, start, [from, to], n);
        report.add(&cost.work());
        if M::is_about_to_jump(load, &cost) && may_wait && !is_given_up {
            return Attempt::NoBalance;
        }
        if M::has_jumped(load) || is_given_up {
            report.add(&StepReport { n_steps: 1, n_solves: 0, n_iterations: 0, n_skipped: 0, ..cost });
            return Attempt::Taken { growth: FASTEST_GROWTH, error: 0.0, n_rows: n };
        }
        let row = extrapolated(flow, &last_row);
        // A change that only a longer step has seen lies at its end.
        let changed_in = changed_in.or(changed_before.map(|_| n));
        changed_before = changed_in;
        if n == 1 {
            last_row = row;
            continue;
        }
        let (moving, side_change) = ((&load.system, &load.state.motion), load.side_friction_change(&start.state.side));
        let error = control.error(moving, side_change, changed_in, &before, [&row, &last_row], length * paths.duration);
        let is_solved = cost.status == Status::Converged || length <= SHORTENED_TO_SOLVE;
        // Further rows do not help where there is no series. That of a load at an obstacle may be
        // one of even powers, whose errors rise once.
        n_rises = if error >= last_error { n_rises + 1 } else { 0 };
        let has_all_rows = !is_solved || changed_in.is_some() || n >= 4 && n_rises > usize::from(touches) || n == MOST_ROWS;
        if is_solved && error <= 1.0 || is_shortest && has_all_rows {
            if let Some(share) = keep(load, task, (start, &before), [from, to], [&row, &last_row], (changed_in.is_none(), is_shortest)) {
                return Attempt::TooLong { macro_step: share * length, change: Some(from + share * length) };
            }
            report.add(&StepReport { n_steps: 1, n_solves: 0, n_iterations: 0, n_skipped: 0, ..cost });
            let power = if changed_in.is_none() { n } else { 1 };
            return Attempt::Taken { growth: growth(error, power), error, n_rows: n };
        }
        if let Some(changed) = changed_in {
            let change = changed as f64 / n as f64 * length;
            // Such an error falls at least in proportion.
            let is_short_enough = error * change <= AIM * length;
            return Attempt::TooLong { macro_step: if is_short_enough { change } else { 0.5 * change }, change: Some(from + change) };
        }
        if has_all_rows {
            return Attempt::TooLong { macro_step: length * growth(error, n).clamp(0.1, 0.5), change: None };
        }
        (last_row, last_error) = (row, error);
    }
    unreachable!("the last row is taken or too long")
}

/// Moves the load to the answer of the last two rows of a table. Steps look where they end, and no
/// step has ended at an extrapolated answer. Where that one passes through an obstacle, or a
/// contact pulls or slides against its friction, returns the share of the macro-step that leads
/// there. The shortest macro-step takes the answer of its steps.
fn keep<M: Method>(
    load: &mut Exact<M>,
    Task { paths, control, .. }: &Task,
    (start, before): (&Snapshot<M::Memory>, &[f64]),
    shares: [f64; 2],
    [row, last_row]: [&[Vec<f64>]; 2],
    (is_smooth, is_shortest): (bool, bool),
) -> Option<f64> {
    let times = shares.map(|share| load.time_at(paths, share));
    let (n, stepped) = (row.len(), if control.keeps == Column::Last { &row[0] } else { &last_row[0] });
    match (control.keeps, is_smooth) {
        (Column::Last, true) => load.set_flow(&row[n - 1]),
        (Column::LastButOne, true) => load.set_flow(&row[n - 2]),
        (Column::Last, false) => {
            load.set_flow(stepped);
            return None;
        }
        (Column::LastButOne, false) => load.set_flow(&control.strayed(before, stepped, (shares[1] - shares[0]) * paths.duration)),
    }
    let reversal = if is_smooth && control.settling_time.is_some() { load.reversal_unseen(&start.state, times) } else { None };
    let opening = if is_smooth { load.opening_unseen(&start.state, &row[n - 1]) } else { None };
    let share = load.touch_unseen(start, times).or(reversal).or(opening).or_else(|| (load.depth_inside() > 0.0).then_some(0.5))?;
    if is_smooth && !is_shortest {
        return Some(share);
    }
    load.set_flow(stepped);
    None
}

/// Takes note of obstacles that have another velocity from the start of a macro-step on.
fn meet_waypoint<M: Method>(load: &mut Exact<M>, paths: &TipPaths, shares: [f64; 2], report: &mut StepReport) {
    if load.obstacles.is_some() {
        let touching = load.state.side.touching.clone();
        let times = shares.map(|share| load.time_at(paths, share));
        report.add(&M::meet_waypoint(load, times));
        load.note_contacts(&touching, shares[0] * paths.duration);
    }
}

/// Completes a snap-through that has begun since the start of a macro-step. Where the load is known
/// to have jumped, no smooth path allows for what is missing.
fn complete_snap_through<M: Method>(
    load: &mut Exact<M>,
    before: &Snapshot<M::Memory>,
    has_jumped: bool,
    report: &mut StepReport,
) -> Option<TransitionKind> {
    let start = before.state.snap_start();
    if has_jumped {
        load.state.side.uncertainty = 0.0;
    }
    let allowed = |load: &Exact<M>| {
        if has_jumped {
            return 0.0;
        }
        let end = &load.state.motion.pose;
        load.springs.work_error(&load.system.springs, &before.attachments, &start.pose, end) + load.obstacle_work_error(&before.state.side)
    };
    M::complete_snap_through(load, &start, allowed, report)
}

/// Velocity of each support times its slip limit (W, world): zero without friction or slip.
fn slips_of<M: Method>(load: &Exact<M>) -> Vec<Vec2> {
    let (System { ground, .. }, Motion { pose, twist }) = (&load.system, &load.state.motion);
    let turn = rotation(pose.heading);
    let slip = |offset: &Vec2| twist.velocity_at(&(turn * offset));
    let mut slips: Vec<Vec2> =
        ground.supports.iter().zip(ground.slip_limits()).map(|(support, limit)| limit * slip(&support.offset)).collect();
    if let Some(ContactMode::Pinned(support)) = load.mode() {
        slips[support] = Vec2::zeros();
    }
    slips
}

/// One row of the table before extrapolation.
struct Row {
    flow: Vec<f64>,
    cost: StepReport,
    /// The first of the n steps, counted from one, that changes the contact mode or reverses a
    /// support.
    changed_in: Option<usize>,
}

fn row<M: Method>(load: &mut Exact<M>, paths: &TipPaths, start: &Snapshot<M::Memory>, [from, to]: [f64; 2], n: usize) -> Row {
    load.reset(start);
    let share = |i: usize| if i == n { to } else { from + (to - from) * i as f64 / n as f64 };
    let (mut cost, mut changed_in) = (StepReport::default(), None);
    let (mut mode, mut slips, mut sides) = (load.mode(), slips_of(load), load.contacts());
    let macro_step = (to - from) * paths.duration;
    let support = M::begin_row(load, macro_step, n);
    for i in 1..=n {
        stop::point();
        cost.add(&M::step(load, paths, share(i - 1), share(i)));
        if M::is_about_to_jump(load, &cost) {
            break;
        }
        let (mode_now, slips_now, sides_now) = (load.mode(), slips_of(load), load.contacts());
        let reverses = || slips.iter().zip(&slips_now).any(|(before, now)| before.dot(now) < 0.0);
        if mode.is_some_and(|before| mode_now != Some(before) || reverses()) || !sides.go_on(&sides_now) {
            changed_in = changed_in.or(Some(i));
        }
        (mode, slips, sides) = (mode_now, slips_now, sides_now);
    }
    M::end_row(load, support, macro_step / n as f64);
    Row { flow: load.flow(), cost, changed_in }
}

/// Row n of Neville's table from its first entry and the row before.
fn extrapolated(first: Vec<f64>, last_row: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = last_row.len() + 1;
    let mut row = vec![first];
    for k in 1..n {
        let weight = (n - k) as f64 / k as f64;
        let entries = row[k - 1].iter().zip(&last_row[k - 1]).map(|(now, before)| now + (now - before) * weight);
        row.push(entries.collect());
    }
    row
}

/// Factor by which a macro-step may be longer, whose error over the tolerance is `error` and grows
/// with this power of its length (1).
fn growth(error: f64, power: usize) -> f64 {
    if error.is_finite() { (AIM / error.max(1e-300)).powf(1.0 / power as f64).min(FASTEST_GROWTH) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::super::contact::GroundContact;
    use super::super::control::Control;
    use super::super::load::State;
    use super::*;
    use crate::backend::numerics::{SHORTEST_MACRO_STEP, SHORTEST_UNSOLVED};
    use crate::backend::report::Skips;
    use crate::backend::stepping::Stepping;
    use crate::math::{Pose, RandomStreams, Stream, Twist};
    use crate::model::{Ground, Load, World};

    /// A method with an answer, or with another one at each step and no convergence.
    struct Drifting {
        has_answer: bool,
        n_steps: u64,
    }

    impl Method for Drifting {
        type Memory = ();

        fn step(load: &mut Exact<Self>, _: &TipPaths, from: f64, to: f64) -> StepReport {
            let Drifting { has_answer, n_steps } = &mut load.method;
            *n_steps += 1;
            let displacement = if *has_answer { to - from } else { RandomStreams::new(1).uniform(Stream::Start, 0, *n_steps) };
            load.state.motion.pose.position.x += displacement;
            let status = if *has_answer { Status::Converged } else { Status::NotConverged };
            StepReport { status, n_steps: 1, n_not_converged: u64::from(!*has_answer), ..StepReport::default() }
        }

        fn rest(_: &mut Exact<Self>) -> bool {
            false
        }

        fn keeps_mode(_: &Exact<Self>) -> bool {
            true
        }

        fn longest_macro_step(_: &Exact<Self>, _: &TipPaths) -> f64 {
            f64::INFINITY
        }

        fn disturb(_: &mut State<()>, _: usize) {}
    }

    /// The first advance without an answer tries macro-steps down to the shortest. The next ones
    /// try fewer and fewer, in the end with a tenth of the steps. The load arrives, every such
    /// advance reports it, and macro-steps are soon as short as before behind it.
    #[test]
    fn where_nothing_converges_each_advance_tries_fewer_macro_steps() {
        let system = System {
            load: Load { mass: 1.0, radius: 1.0, inertia: 0.5 },
            ground: Ground { friction_coefficient: 0.0, supports: Vec::new() },
            springs: Vec::new(),
            world: World::default(),
        };
        let start = Motion { pose: Pose::new(0.0, 0.0, 0.0), twist: Twist::ZERO };
        let control = Control { position: 1e-6, heading: 1e-6, energy: 1e-6, settling_time: None, keeps: Column::Last };
        let paths = TipPaths { from: &[], targets: &[], duration: 1.0 };
        let task = Task { paths, longest: f64::INFINITY, control };
        let method = Drifting { has_answer: true, n_steps: 0 };
        let mut load = Exact::with(method, (), (system, start), Stepping::Controlled(control), Skips::NONE);
        load.state.contact = GroundContact::Known(ContactMode::Slip);
        let mut next = |has_answer| {
            load.method = Drifting { has_answer, n_steps: 0 };
            let report = advance(&mut load, &task);
            assert_eq!(report.n_not_converged == 0, has_answer);
            (load.method.n_steps, load.pace.shortest)
        };
        assert_eq!(next(true).1, SHORTEST_MACRO_STEP);
        let lost: Vec<_> = (0..6).map(|_| next(false)).collect();
        assert!(lost[..3].windows(2).all(|pair| pair[1].0 < pair[0].0 && pair[1].1 > pair[0].1), "{lost:?}");
        assert!(lost[3..].iter().all(|(n_steps, shortest)| 10 * n_steps < lost[0].0 && *shortest == SHORTEST_UNSOLVED), "{lost:?}");
        let found: Vec<_> = (0..3).map(|_| next(true).1).collect();
        assert_eq!(found[2], SHORTEST_MACRO_STEP, "{found:?}");
    }
}
