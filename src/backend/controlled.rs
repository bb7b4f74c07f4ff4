//! Steps under error control: a first-order step, extrapolated, and restarted where the friction changes its regime.
//!
//! A stride of length H is taken by 1, 2, 3 ... equal steps of the method, whose errors are a series in whole powers of the step as long as no support
//! starts or stops slipping on the way. Neville's table over the step (Aitken, 1932; Neville, 1934; for implicit Euler Deuflhard, 1983) removes one
//! power a column:
//!
//! ```text
//! T(n, 1) = n steps    T(n, k + 1) = T(n, k) + (T(n, k) - T(n - 1, k)) (n - k) / k
//! ```
//!
//! and the columns go on until the last two agree within the tolerance. A load that sticks in all rows sticks exactly: nothing is left to extrapolate.
//!
//! Where the regime changes on the way, or a support turns back, the series breaks off. The table need not show it: what happens in the first step of all
//! rows leaves them a series, toward what would be if it had happened at the start. Such a stride is cut at the change, by halves, until the plain answers of one and
//! two steps agree within the tolerance: that stride is taken as it stands, the change is located to its length, and behind it the order starts anew. Grasps,
//! releases and corners of tip paths fall between advances, so that they are instants of their own already.

use serde::{Deserialize, Serialize};

use super::friction::Regime;
use super::springs::Attachment;
use super::transition::{Transition, TransitionKind};
use super::{Motion, Status, StepReport};
use crate::math::{Twist, Vec2, rotation};
use crate::model::System;

/// A one-step method of first order.
pub(super) trait FirstOrder {
    type State: Clone;

    fn state(&self) -> &Self::State;

    fn set_state(&mut self, state: Self::State);

    /// Makes ready for a stride (s) of so many equal steps, and gives the support that [`FirstOrder::end_row`] is to know of.
    fn begin_row(&mut self, _stride: f64, _n_steps: usize) -> Option<usize> {
        None
    }

    /// Brings what steps of this length (s) have led to to the instant at which they end.
    fn end_row(&mut self, _support: Option<usize>, _step: f64) {}

    /// One step, in which the tips go from one share of their way to another.
    fn step(&mut self, way: &Way, from: f64, to: f64) -> StepReport;

    /// How the load rested on the ground at the end of the last step; `None` when something has happened since.
    fn regime(&self) -> Option<Regime>;

    /// What moves, on what, and how it moves now.
    fn moving(&self) -> (&System, &Motion);

    /// How the load rested on the ground at the end of the last step, whatever has happened since.
    fn last_regime(&self) -> Regime;

    /// Everything that changes smoothly: pose and twist (m, rad, m/s, rad/s), energy lost to friction and work of the tips (J), then what the method likes.
    fn flow(&self) -> Vec<f64>;

    /// Puts a flow in place of the state's own.
    fn set_flow(&mut self, flow: &[f64]);

    /// Ends and books a jump that the load has begun since the state `before`, if it has.
    fn finish_snap(&mut self, _before: &Self::State, _report: &mut StepReport) -> Option<TransitionKind> {
        None
    }
}

/// The way of the tips in one advance.
pub(super) struct Way<'a> {
    pub from: &'a [Attachment],
    /// (m, world, one entry a spring)
    pub targets: &'a [Vec2],
    /// (s)
    pub duration: f64,
    /// Longest stride (s). Implicit steps that are much longer than an oscillation agree with each other on what is left when it has died out, so the
    /// table cannot tell that it has not.
    pub longest: f64,
}

/// What an advance hands on to the next one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Pace {
    /// Stride to start with (s).
    stride: f64,
    /// Shortest stride over the advance (1).
    shortest: f64,
}

impl Default for Pace {
    fn default() -> Self {
        Self { stride: f64::MAX, shortest: SHORTEST }
    }
}

impl Pace {
    /// Behind an advance that had no answer in places, such as one through a spring's root, the next one gives up earlier, and behind one that had it again later.
    fn hand_on(&mut self, had_answers: bool) {
        let shortest = if had_answers { self.shortest * self.shortest } else { self.shortest.sqrt() };
        self.shortest = shortest.clamp(SHORTEST, SHORTEST_WHERE_NONE_CONVERGES);
    }
}

/// How exact each stride is to be, and what is kept of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Error of the position in a stride (m).
    pub position: f64,
    /// Error of the heading in a stride (rad).
    pub heading: f64,
    /// Error of friction loss and work of the tips in a stride (J). Where one motion alone is left, as about a captured support, poses may be exact at any
    /// stride while the work on the way is not.
    pub energy: f64,
    /// Time over which a speed that is wrong makes the position wrong (s); `None` for a method that carries no speed on.
    pub settling_time: Option<f64>,
    pub keeps: Column,
}

/// Which column of the table a stride ends in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// The last one: the best there is.
    Last,
    /// The one before, whose error is what the control sees. A run that keeps it shows how such errors add up.
    LastButOne,
}

/// Rows of the table. Errors fall with the power of the row, roundings grow by about four a row.
const MOST_ROWS: usize = 8;
/// Length over the advance (1) down to which a stride is shortened because its steps did not converge: where shorter ones do not either, what they reach
/// is compared like any other answer, and their status says so.
const SHORTENED_TO_SOLVE: f64 = 1.0 / 1024.0;
/// So many attempts at strides in an advance, and for each of the longest that it has room for, are enough: strides that stay short have met what strides do not resolve,
/// such as a motion that no force resists.
const MANY_ATTEMPTS: f64 = 256.0;
const MANY_A_STRIDE: f64 = 64.0;
/// Growth of the shortest stride beyond each time as many.
const GROWTH_AFTER_MANY: f64 = 32.0;
/// Growth of the shortest stride, for the rest of an advance, with each stride that had to be taken as it was: where nothing converges the load still arrives,
/// and what that is worth shows in the statuses of the steps and in the run beside.
const FORCED_GROWTH: f64 = 2.0;
/// A stride that took fewer rows than these may be longer at less cost in all: more rows then do what shorter strides would.
const FAVOURED_ROWS: usize = 5;
/// Shortest stride over the advance (1). What still differs there is a jump.
const SHORTEST: f64 = 1.0 / (1u64 << 30) as f64;
/// The same in the long run where strides neither converge nor agree however short they are: nothing shorter is any better there, and much slower.
const SHORTEST_WHERE_NONE_CONVERGES: f64 = 1.0 / 16.0;
/// What a stride with a change in it may err, over the tolerance of a smooth one (1): there are few of them.
const CHANGE_SHARE: f64 = 10.0;
/// A stride aims at this share of the tolerance, so that few fail (1).
const AIM: f64 = 0.5;
/// Rounding of energies that have added up over a run and been extrapolated (1).
const ENERGY_ROUNDING: f64 = 1e-14;
/// Largest growth from one stride to the next: behind a located change the stride has to come back from nearly nothing.
const FASTEST_GROWTH: f64 = 64.0;

/// Moves the load along the whole way, at the pace that the last advance left.
pub(super) fn advance<M: FirstOrder>(
    method: &mut M,
    way: &Way,
    control: &Control,
    pace: &mut Pace,
    transitions: &mut Vec<Transition>,
) -> StepReport {
    let (mut report, mut had_answers) = (StepReport::default(), true);
    let longest = way.longest / way.duration;
    let (mut at, mut stride, mut shortest) = (0.0, pace.stride / way.duration, pace.shortest.min(longest));
    // Share by which the regime changes, once that is known.
    let mut change_by = None;
    let (mut n_attempts, many) = (0.0, MANY_ATTEMPTS + MANY_A_STRIDE * longest.recip());
    while at < 1.0 {
        n_attempts += 1.0;
        if n_attempts > many {
            (n_attempts, shortest) = (0.0, (shortest * GROWTH_AFTER_MANY).min(1.0));
        }
        let limit = change_by.unwrap_or(1.0);
        stride = stride.min(longest).max(shortest);
        let to = if limit - at <= 1.01 * stride { limit } else { at + stride };
        let (start, before, n_not_converged) = (method.state().clone(), method.last_regime(), report.n_not_converged);
        match attempt(method, way, control, &start, [at, to], shortest, &mut report) {
            Attempt::Taken { growth, error } => {
                if error > 1.0 {
                    shortest *= FORCED_GROWTH;
                    had_answers &= report.n_not_converged == n_not_converged;
                }
                let kind = TransitionKind::between(before, method.last_regime());
                let kinds = method.finish_snap(&start, &mut report).into_iter().chain(kind);
                transitions.extend(kinds.map(|kind| Transition { time: to * way.duration, kind }));
                change_by = change_by.filter(|change| *change > to);
                let was_cut = to - at < 0.99 * stride;
                stride = match change_by {
                    Some(change) => change - to,
                    None => ((to - at) * growth).max(if was_cut { stride } else { 0.0 }),
                };
                at = to;
            }
            Attempt::TooLong { stride: shorter, change } => {
                method.set_state(start);
                report.n_rejected += 1;
                stride = shorter;
                change_by = change.or(change_by).filter(|change| *change > at);
            }
        }
    }
    // Rounded to the advance, a longer stride says that nothing limits it.
    pace.stride = stride.min(1e6) * way.duration;
    pace.hand_on(had_answers);
    report
}

enum Attempt {
    Taken {
        /// What the next stride may be longer (1).
        growth: f64,
        /// Over the tolerance (1): above one for a stride that could not be shortened.
        error: f64,
    },
    TooLong {
        /// Share to try instead.
        stride: f64,
        /// Share of the way by which the regime changes.
        change: Option<f64>,
    },
}

/// One stride from `start` between two shares of the way. A stride that is taken leaves the method in its end.
fn attempt<M: FirstOrder>(
    method: &mut M,
    way: &Way,
    control: &Control,
    start: &M::State,
    [from, to]: [f64; 2],
    shortest: f64,
    report: &mut StepReport,
) -> Attempt {
    let length = to - from;
    let is_shortest = length <= 1.5 * shortest;
    method.set_state(start.clone());
    let before = method.flow();
    let mut last_row: Vec<Vec<f64>> = Vec::new();
    let (mut last_error, mut changed_before) = (f64::INFINITY, None);
    for n in 1..=MOST_ROWS {
        let Row { flow, cost, changed_in } = row(method, way, start, [from, to], n);
        report.add(&StepReport { n_steps: 0, status: Status::Converged, residual: 0.0, n_not_converged: 0, ..cost });
        let row = extrapolated(flow, &last_row);
        // A change that only a longer step has seen lies at its end.
        let changed_in = changed_in.or(changed_before.map(|_| n));
        changed_before = changed_in;
        if n == 1 {
            last_row = row;
            continue;
        }
        let is_smooth = changed_in.is_none();
        let plain = control.distance(&row[0], &last_row[0]);
        let error = match is_smooth {
            true => control.distance(&row[n - 1], &row[n - 2]).min(plain),
            // What happens in the first step of all rows hides from their difference, and so does what stops a load.
            false if changed_in == Some(1) || control.settling_time.is_some() => {
                let duration = length * way.duration;
                plain.max(control.loss_of_way(&before, &row[0], duration)).max(control.before_stop(method.moving(), duration))
                    / CHANGE_SHARE
            }
            false => plain / CHANGE_SHARE,
        };
        let is_solved = cost.status == Status::Converged || length <= SHORTENED_TO_SOLVE;
        // Further rows do not help what is no series.
        let has_all_rows = !is_solved || !is_smooth || n >= 4 && error >= last_error || n == MOST_ROWS;
        if is_solved && error <= 1.0 || is_shortest && has_all_rows {
            match (control.keeps, is_smooth) {
                (Column::Last, true) => method.set_flow(&row[n - 1]),
                (Column::LastButOne, true) => method.set_flow(&row[n - 2]),
                (Column::Last, false) => method.set_flow(&row[0]),
                (Column::LastButOne, false) => method.set_flow(&control.strayed(&before, &last_row[0], length * way.duration)),
            }
            report.add(&StepReport { n_steps: 1, n_solves: 0, n_iterations: 0, n_skipped: 0, ..cost });
            let power = if is_smooth { n } else { 1 };
            let least = if n < FAVOURED_ROWS { 2.0 } else { 0.0 };
            return Attempt::Taken { growth: growth(error, power).max(least), error };
        }
        if let Some(changed) = changed_in {
            let change = changed as f64 / n as f64 * length;
            // Such an error falls at least in proportion.
            let is_short_enough = error * change <= AIM * length;
            return Attempt::TooLong { stride: if is_short_enough { change } else { 0.5 * change }, change: Some(from + change) };
        }
        if has_all_rows {
            return Attempt::TooLong { stride: length * growth(error, n).clamp(0.1, 0.5), change: None };
        }
        (last_row, last_error) = (row, error);
    }
    unreachable!("the last row is taken or too long")
}

/// Velocity of each support times what friction it has there (W, world): nothing where there is no friction, or no slip.
fn slips_of<M: FirstOrder>(method: &M) -> Vec<Vec2> {
    let (System { ground, .. }, Motion { pose, twist }) = method.moving();
    let turn = rotation(pose.heading);
    let slip = |offset: &Vec2| twist.velocity_at(&(turn * offset));
    let mut slips: Vec<Vec2> =
        ground.supports.iter().zip(ground.slip_limits()).map(|(support, limit)| limit * slip(&support.offset)).collect();
    if let Some(Regime::Pinned(support)) = method.regime() {
        slips[support] = Vec2::zeros();
    }
    slips
}

/// One row of the table before extrapolation.
struct Row {
    flow: Vec<f64>,
    cost: StepReport,
    /// The first of the n steps, counted from one, whose regime is another than before it, or which turns the slip of a support back.
    changed_in: Option<usize>,
}

fn row<M: FirstOrder>(method: &mut M, way: &Way, start: &M::State, [from, to]: [f64; 2], n: usize) -> Row {
    method.set_state(start.clone());
    let share = |i: usize| if i == n { to } else { from + (to - from) * i as f64 / n as f64 };
    let (mut cost, mut changed_in) = (StepReport::default(), None);
    let (mut regime, mut slips) = (method.regime(), slips_of(method));
    let stride = (to - from) * way.duration;
    let support = method.begin_row(stride, n);
    for i in 1..=n {
        cost.add(&method.step(way, share(i - 1), share(i)));
        let (regime_now, slips_now) = (method.regime(), slips_of(method));
        let turned_back = || slips.iter().zip(&slips_now).any(|(before, now)| before.dot(now) < 0.0);
        if regime.is_some_and(|before| regime_now != Some(before) || turned_back()) {
            changed_in = changed_in.or(Some(i));
        }
        (regime, slips) = (regime_now, slips_now);
    }
    method.end_row(support, stride / n as f64);
    Row { flow: method.flow(), cost, changed_in }
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

/// How much longer a stride may be whose error, over the tolerance, is `error` and grows with this power of its length.
fn growth(error: f64, power: usize) -> f64 {
    if error.is_finite() { (AIM / error.max(1e-300)).powf(1.0 / power as f64).min(FASTEST_GROWTH) } else { 0.0 }
}

impl Control {
    /// How far two flows lie apart, over the tolerance (1).
    fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let poses = self.size(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
        let speeds = self.settling_time.map_or(0.0, |time| time * self.size(a[3] - b[3], a[4] - b[4], a[5] - b[5]));
        let energy = |at: usize| (a[at] - b[at]).abs() / (self.energy + ENERGY_ROUNDING * a[at].abs());
        poses.max(speeds).max(energy(6)).max(energy(7))
    }

    /// How far an implicit step of `duration` (s) between two flows may have gone too short or too far, over the tolerance (1): where its speed has dropped to
    /// nothing, one step and two find the same place, and that is not the right one.
    fn loss_of_way(&self, a: &[f64], b: &[f64], duration: f64) -> f64 {
        0.5 * duration * self.size(a[3] - b[3], a[4] - b[4], a[5] - b[5])
    }

    /// How far friction could have let a load go that stops within `duration` (s), over the tolerance (1): nothing for one that goes on. A load that is about
    /// to stop as a stride begins loses no way by a long one, yet when it stops is not to be any time within.
    fn before_stop(&self, (system, motion): (&System, &Motion), duration: f64) -> f64 {
        if self.settling_time.is_none() || motion.twist != Twist::ZERO {
            return 0.0;
        }
        self.size(0.5 * system.total_slip_limit() / system.load.mass * duration * duration, 0.0, 0.0)
    }

    /// The flow `b` with what its way from `a` may have lost. Where a load stops, one step and two find the same place: a run that shows how errors add up would not show
    /// that one.
    fn strayed(&self, a: &[f64], b: &[f64], duration: f64) -> Vec<f64> {
        let mut strayed = b.to_vec();
        if self.settling_time.is_some() {
            (0..3).for_each(|i| strayed[i] += 0.5 * duration * (a[i + 3] - b[i + 3]));
        }
        strayed
    }

    /// Of a shift (m) and a turn (rad), over the tolerance (1).
    fn size(&self, x: f64, y: f64, turn: f64) -> f64 {
        let (shift, turn) = (x.hypot(y) / self.position, turn.abs() / self.heading);
        // `max` drops what is not a number.
        if (shift + turn).is_nan() { f64::INFINITY } else { shift.max(turn) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Pose, RandomStreams, Stream, Twist};
    use crate::model::{Ground, Load};

    /// A method with an answer, or with another one at each step and no convergence.
    struct Drifting {
        state: Motion,
        system: System,
        has_answer: bool,
        n_steps: u64,
    }

    impl FirstOrder for Drifting {
        type State = Motion;

        fn state(&self) -> &Motion {
            &self.state
        }

        fn set_state(&mut self, state: Motion) {
            self.state = state;
        }

        fn step(&mut self, _: &Way, from: f64, to: f64) -> StepReport {
            self.n_steps += 1;
            let way = if self.has_answer { to - from } else { RandomStreams::new(1).uniform(Stream::Start, 0, self.n_steps) };
            self.state.pose.position.x += way;
            let status = if self.has_answer { Status::Converged } else { Status::NotConverged };
            StepReport { status, n_steps: 1, n_not_converged: u64::from(!self.has_answer), ..StepReport::default() }
        }

        fn regime(&self) -> Option<Regime> {
            Some(Regime::Slip)
        }

        fn last_regime(&self) -> Regime {
            Regime::Slip
        }

        fn moving(&self) -> (&System, &Motion) {
            (&self.system, &self.state)
        }

        fn flow(&self) -> Vec<f64> {
            let mut flow = vec![0.0; 8];
            flow[0] = self.state.pose.position.x;
            flow
        }

        fn set_flow(&mut self, flow: &[f64]) {
            self.state.pose.position.x = flow[0];
        }
    }

    /// The first advance without an answer looks for one in strides down to the shortest; the next ones look less and less, in the end with a tenth of the
    /// steps. The load arrives, every advance says that it is lost, and behind it strides are soon as fine as ever.
    #[test]
    fn where_nothing_converges_each_advance_looks_less_far_for_an_answer() {
        let system = System {
            load: Load { mass: 1.0, radius: 1.0, inertia: 0.5 },
            ground: Ground { friction_coefficient: 0.0, supports: Vec::new() },
            springs: Vec::new(),
        };
        let state = Motion { pose: Pose::new(0.0, 0.0, 0.0), twist: Twist::ZERO };
        let mut method = Drifting { state, system, has_answer: true, n_steps: 0 };
        let control = Control { position: 1e-6, heading: 1e-6, energy: 1e-6, settling_time: None, keeps: Column::Last };
        let way = Way { from: &[], targets: &[], duration: 1.0, longest: f64::INFINITY };
        let mut pace = Pace::default();
        let mut next = |has_answer| {
            (method.has_answer, method.n_steps) = (has_answer, 0);
            let report = advance(&mut method, &way, &control, &mut pace, &mut Vec::new());
            assert_eq!(report.n_not_converged == 0, has_answer);
            (method.n_steps, pace.shortest)
        };
        assert_eq!(next(true).1, SHORTEST);
        let lost: Vec<_> = (0..6).map(|_| next(false)).collect();
        assert!(lost[..3].windows(2).all(|pair| pair[1].0 < pair[0].0 && pair[1].1 > pair[0].1), "{lost:?}");
        assert!(
            lost[3..].iter().all(|(n_steps, shortest)| 10 * n_steps < lost[0].0 && *shortest == SHORTEST_WHERE_NONE_CONVERGES),
            "{lost:?}"
        );
        let found: Vec<_> = (0..3).map(|_| next(true).1).collect();
        assert_eq!(found[2], SHORTEST, "{found:?}");
    }
}
