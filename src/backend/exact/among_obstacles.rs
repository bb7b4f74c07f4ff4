//! What a load of any exact method does with obstacles between its steps.

use smallvec::SmallVec;

use super::load::{Exact, Method, Snapshot, State};
use super::side::{Impact, SideState};
use crate::backend::contact::{Faces, Instant, Obstacles, PairKey, SideForce, SideMode, Strike, Touching, transitions};
use crate::backend::numerics::{LONGEST_CUT, PULL_ERROR, REVERSED_SLIP, SHORTEST_CUT, SQUEEZED};
use crate::backend::report::{Doubts, Motion, SideContact, Status, StepReport, Transition, TransitionKind};
use crate::backend::springs::{Place, TipPaths};
use crate::math::Twist;

/// What does not change at the obstacles while the motion is smooth.
pub struct Contacts {
    faces: Faces,
    /// Number of impacts and of divided steps.
    n_events: usize,
    /// Radius of the load (m).
    radius: f64,
}

impl Contacts {
    /// Whether the motion was smooth up to these.
    pub fn go_on(&self, now: &Self) -> bool {
        self.n_events == now.n_events && self.faces.go_on(&now.faces, self.radius)
    }
}

impl<M: Method> Exact<M> {
    /// Whether no obstacle can touch a load that stands still for `duration` (s) from now.
    pub(super) fn is_free(&mut self, duration: f64) -> bool {
        let Self { obstacles, springs, system, state, .. } = self;
        let Some(obstacles) = obstacles else { return true };
        let from = state.side.time;
        springs.refresh(&system.springs, &state.motion.pose);
        state.side.touching.is_empty() && obstacles.is_far(system, springs.place(), [from, from + duration])
    }

    /// Whether a moving obstacle may touch a load that stands still for `duration` (s) from now.
    pub(super) fn is_pushed(&mut self, duration: f64) -> bool {
        let moves = |load: &Self| load.system.world.obstacles.iter().any(|obstacle| obstacle.path.moves());
        self.obstacles.is_some() && moves(self) && !self.is_free(duration)
    }

    /// Whether features that touched overlap at `time` (s) by more than rounding.
    pub(super) fn overlaps_of(&self, touching: &[Touching], time: f64) -> bool {
        let place = Place::of(&self.state.motion.pose);
        let overlaps = |obstacles: &Obstacles| touching.iter().any(|it| obstacles.overlaps(&self.system, &it.key, &place, time));
        self.obstacles.as_ref().is_some_and(overlaps)
    }

    /// Largest depth by which the load lies inside an obstacle (m).
    pub(super) fn depth_inside(&mut self) -> f64 {
        let Self { obstacles, system, state, .. } = self;
        let place = Place::of(&state.motion.pose);
        obstacles.as_mut().map_or(0.0, |obstacles| obstacles.depth(system, &place, state.side.now))
    }

    /// Marks a step that ends inside an obstacle at `time` (s) as one that has not converged, and
    /// as failed where obstacles squeeze the load. A step that is given up may end anywhere.
    pub(super) fn pass_gate(&mut self, report: &mut StepReport, time: f64, is_given_up: bool) {
        let overlap_m = self.depth_inside();
        if overlap_m > 0.0 {
            let doubts = Doubts { overlap_m, ..Doubts::default() };
            let is_deep = !is_given_up && overlap_m > SQUEEZED * self.system.load.radius;
            let finds_no_way = report.status == Status::Failed || report.status != Status::Converged && is_deep;
            let status = if finds_no_way && self.note_squeeze(time) { Status::Failed } else { Status::NotConverged };
            report.add(&StepReport { status, n_not_converged: 1, doubts, ..StepReport::default() });
        }
    }

    /// Records which obstacles squeeze the load: all those next to it, if one of them moves. Where
    /// all stand still, the load finds its place by standing still too. Returns whether they do.
    fn note_squeeze(&mut self, time: f64) -> bool {
        let Self { obstacles: Some(obstacles), system, state, .. } = self else { return false };
        let next_to = obstacles.next_to(system, &Place::of(&state.motion.pose), state.side.now);
        let is_squeezed = next_to.iter().any(|obstacle| system.world.obstacles[*obstacle].path.moves());
        let squeezes = next_to.into_iter().filter(|_| is_squeezed);
        self.transitions.extend(squeezes.map(|obstacle| Transition { time, kind: TransitionKind::Squeeze { obstacle } }));
        is_squeezed
    }

    /// Records a motion that is not unique since `time` (s), if steps since then report it.
    pub(super) fn note_not_unique(&mut self, n_before: u64, report: &StepReport, time: f64) {
        let pressing = self.state.side.touching.iter().find(|touching| touching.force.normal > 0.0);
        let obstacle = pressing.filter(|_| report.doubts.n_not_unique > n_before).map(|touching| touching.key.obstacle);
        self.transitions.extend(obstacle.map(|obstacle| Transition { time, kind: TransitionKind::NotUnique { obstacle } }));
    }

    /// Share of a macro-step by which a contact has parted since the `start`, where the load was
    /// extrapolated to a `flow` in which it would pull; `None` without one. Implicit steps have the
    /// forces of a while before their ends, so that all of them may still press there.
    pub(super) fn opening_unseen(&self, start: &State<M::Memory>, flow: &[f64]) -> Option<f64> {
        let touching = &self.state.side.touching;
        let forces = self.forces_in(flow)?;
        let share = |(now, force): (&Touching, f64)| {
            let before = start.side.touching.iter().find(|before| before.key == now.key)?.force.normal;
            (now.mode != SideMode::Open && force < -PULL_ERROR * before).then(|| before / (before - force))
        };
        let moves = self.state.motion.twist != Twist::ZERO;
        let earliest = touching.iter().zip(forces).filter_map(share).filter(|_| moves).reduce(f64::min)?;
        Some(earliest.clamp(SHORTEST_CUT, LONGEST_CUT))
    }

    /// Time at a share of the paths (s).
    pub(super) fn time_at(&self, paths: &TipPaths, share: f64) -> f64 {
        self.state.side.time + share * paths.duration
    }

    /// An instant of the part of the motion that is under way.
    pub(super) fn instant(&self, time: f64) -> Instant {
        Instant { time, within: self.state.side.within.unwrap_or(time) }
    }

    /// Features that the load has passed through since the `start`, between two times (s), besides
    /// the known ones and those that have stayed closed, and the share of this part of the motion
    /// by which it has.
    pub(super) fn strikes(&mut self, start: &State<M::Memory>, times: [f64; 2], known: &[Strike]) -> Option<(Vec<Strike>, f64)> {
        let Self { obstacles, system, state, .. } = self;
        let was_closed = |key: &PairKey| start.side.touching.iter().any(|touching| touching.key == *key);
        let kept: SmallVec<[Touching; 2]> = state.side.touching.iter().filter(|now| was_closed(&now.key)).copied().collect();
        obstacles.as_mut()?.strikes(system, (&Place::of(&start.motion.pose), &state.motion.pose), times, known, &kept)
    }

    /// Share of a macro-step between two times (s) by which the load is likely to have touched what
    /// lies between its `start` and the pose to which it was extrapolated; `None` for a free path.
    ///
    /// The steps of the table see what they touch. An extrapolated pose lies beyond all of theirs.
    pub(super) fn touch_unseen(&mut self, start: &Snapshot<M::Memory>, times: [f64; 2]) -> Option<f64> {
        let (strikes, until) = self.strikes(&start.state, times, &[])?;
        let (Self { obstacles, system, state, .. }, duration) = (self, times[1] - times[0]);
        let obstacles = obstacles.as_ref()?;
        let gap = |strike: &Strike, state: &State<M::Memory>, time: f64| {
            let within = 0.5 * (times[0] + times[1]);
            obstacles.distance_and_rate(system, strike, &state.motion, Instant { time, within })
        };
        let share = |strike: &Strike| {
            let ((first, _), (last, rate)) = (gap(strike, &start.state, times[0]), gap(strike, state, times[1]));
            // By the speed at the end, or by the mean speed.
            [1.0 - last / (rate * duration), first / (first - last)].into_iter().find(|share| (0.0..1.0).contains(share))
        };
        let earliest = strikes.iter().filter_map(share).fold(until, f64::min);
        Some(earliest.clamp(SHORTEST_CUT, LONGEST_CUT))
    }

    /// Share of a macro-step between two times (s) by which the slip of a sliding contact has
    /// reversed since the `start`, where the load was extrapolated beyond that; `None` without one.
    pub(super) fn reversal_unseen(&self, start: &State<M::Memory>, times: [f64; 2]) -> Option<f64> {
        let Self { obstacles: Some(obstacles), system, state, .. } = self else { return None };
        let within = 0.5 * (times[0] + times[1]);
        let rate = |key: &PairKey, motion: &Motion, time: f64| obstacles.slip_rate(system, key, motion, Instant { time, within });
        let rounding = REVERSED_SLIP * state.motion.twist.linear.norm().max(system.load.radius * state.motion.twist.angular.abs());
        let share = |Touching { key, mode, .. }: &Touching| {
            let SideMode::Slide { forward } = mode else { return None };
            let sign = if *forward { 1.0 } else { -1.0 };
            let [first, last] = [(&start.motion, times[0]), (&state.motion, times[1])].map(|(motion, time)| sign * rate(key, motion, time));
            (first > rounding && last < -rounding).then(|| first / (first - last))
        };
        let earliest = state.side.touching.iter().filter_map(share).reduce(f64::min)?;
        Some(earliest.clamp(SHORTEST_CUT, LONGEST_CUT))
    }

    /// Takes note of time that has passed (s).
    pub(super) fn pass(&mut self, duration: f64) {
        if self.obstacles.is_some() {
            let side = &mut self.state.side;
            side.time += duration;
            side.now = side.time;
        }
    }

    /// Records what happened at obstacles up to `time` (s) since these contacts were closed.
    pub(super) fn note_contacts(&mut self, before: &[Touching], time: f64) {
        let side = &mut self.state.side;
        let kinds = transitions(before, &side.touching);
        self.transitions.extend(kinds.into_iter().map(|kind| Transition { time, kind }));
        let since = side.time;
        side.n_divided = 0;
        self.transitions.extend(side.impacts.drain(..).map(|Impact { time, obstacle, loss, law }| Transition {
            time: time - since,
            kind: TransitionKind::Impact { obstacle, energy: loss, law },
        }));
        self.transitions.sort_by(|a, b| a.time.total_cmp(&b.time));
    }

    /// Faces by which the load touches, and the number of impacts and of divided steps: what does
    /// not change while the motion is smooth.
    pub(super) fn contacts(&self) -> Contacts {
        let SideState { touching, impacts, n_divided, .. } = &self.state.side;
        Contacts { faces: Faces::of(touching), n_events: impacts.len() + n_divided, radius: self.system.load.radius }
    }

    /// Change of the friction of contacts that are in another mode than at the `start` (N).
    pub(super) fn side_friction_change(&self, start: &SideState) -> f64 {
        let of = |now: &Touching| {
            let before = start.touching.iter().find(|before| before.key == now.key && before.mode != now.mode);
            before.map_or(0.0, |before| (now.force.tangential - before.force.tangential).abs())
        };
        self.state.side.touching.iter().map(of).sum()
    }

    /// Bound of the error of the work at obstacles by the trapezoid rule on a smooth path since
    /// `start` (J): the change of the forces times the displacement of the obstacle and the slip.
    pub(super) fn obstacle_work_error(&self, start: &SideState) -> f64 {
        let bound = |now: &Touching| {
            let before = start.touching.iter().find(|before| before.key == now.key);
            let (force, slip) = before.map_or((SideForce::default(), now.slip), |before| (before.force, before.slip));
            let path = self.system.world.obstacles[now.key.obstacle].path_length(start.now, self.state.side.now);
            let [normal, tangential] = [now.force.normal - force.normal, now.force.tangential - force.tangential].map(f64::abs);
            (normal + tangential) * path + tangential * (now.slip - slip).abs()
        };
        self.state.side.touching.iter().map(bound).sum()
    }

    /// Closed contacts with their forces.
    pub(super) fn side_forces(&self) -> impl Iterator<Item = SideContact> + '_ {
        self.state.side.touching.iter().map(|Touching { key, on_load: [force, point], .. }| SideContact {
            obstacle: key.obstacle,
            point: *point,
            force: *force,
        })
    }
}
