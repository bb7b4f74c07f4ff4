//! Steps of second order of a load with inertia that goes on touching obstacles in the same modes,
//! and slipping on all supports.
//!
//! With the weights a and b of backward differences (`bdf2`), over h after a step d_n that changed
//! the velocity from v_(n-1) to v_n:
//!
//! ```text
//! d = a d_n + b h v                 v at the end
//! M (v - v_n - a (v_n - v_(n-1))) = b h (forces at the end)
//! s - s_n = a (s_n - s_(n-1)) + b h (rate at the end)      shape s of a dashpot
//! gap = 0 and slip = 0 of contacts that stick, at the end
//! ```
//!
//! It takes one solution, where extrapolation takes three, and no impact or change of modes since
//! the step before the last one. With dashpots the tips go straight on.

use super::bdf2::{Past, weights};
use super::inertial::{Inertial, Memory};
use super::load::{Exact, Snapshot};
use super::one_step::{Stepped, Touched};
use crate::backend::contact::{Faces, Scope, Task};
use crate::backend::increment::{Coasting, Straight};
use crate::backend::numerics::STRAIGHT_TIP;
use crate::backend::report::{Motion, StepReport};
use crate::backend::springs::{Attachment, TipPaths};
use crate::math::{Arc, Pose, Twist, Vec2, Vec3};

impl Exact<Inertial> {
    /// Takes note of the step of this `duration` (s) since the `start`, if nothing has changed at
    /// the obstacles.
    pub(super) fn remember_touching(&mut self, start: &Snapshot<Memory>, duration: f64) {
        let state = &mut self.state;
        let [before, now] = [&start.state.side, &state.side].map(|side| Faces::of(&side.touching));
        if before.go_on(&now, self.system.load.radius) {
            let Motion { pose, twist } = start.state.motion;
            let shift = state.motion.pose.position - pose.position;
            let step = Past { shift, turn: state.motion.pose.heading - pose.heading, duration };
            let tips = if self.method.is_damped { start.attachments.iter().map(|it| it.tip).collect() } else { Vec::new() };
            state.memory.touched = Some(Touched { step, before: twist, tips });
        }
    }

    /// Takes a step by backward differences; `None`, and none is taken, where the load does not go
    /// on as in the last one.
    pub(super) fn go_on_touching(&mut self, paths: &TipPaths, [from, to]: [f64; 2]) -> Option<StepReport> {
        let Touched { step: past, before, mut tips } = self.state.memory.touched.take()?;
        let step = (to - from) * paths.duration;
        let (a, b) = weights(step / past.duration)?;
        let end = self.state.side.time + to * paths.duration;
        let Self { method, system, springs, state, solver, obstacles, .. } = self;
        let Motion { pose, twist } = state.motion;
        springs.refresh(&system.springs, &pose);
        springs.place_tips(paths, to);
        let start = *springs.place();
        let share = b * step;
        if method.is_damped {
            // A dashpot pulls otherwise at once where its tip changes its velocity.
            if !go_straight_on(paths, from - past.duration / paths.duration, &tips, system.load.radius) {
                return None;
            }
            let earlier = Pose { position: pose.position - past.shift, heading: pose.heading - past.turn };
            let carried_on = |at: usize, last: &Attachment| {
                let before = Attachment { tip: tips[at], ..*last };
                let [before, now] = [before.shape(&system.springs, &earlier), last.shape(&system.springs, &pose)];
                now.going_on(&before, a)
            };
            method.dashpots.renew_about(system, springs, &pose, share, carried_on);
        }
        let change = Twist { linear: twist.linear - before.linear, angular: twist.angular - before.angular };
        let carried = (a * past.shift, a * past.turn);
        let goes_on =
            |weight: f64| Twist { linear: twist.linear + weight * change.linear, angular: twist.angular + weight * change.angular };
        let expected = goes_on(step / past.duration);
        let expected_turn = carried.1 + share * expected.angular;
        let axes = start.turn * Arc::of(expected_turn).rotation();
        let guess = share * axes.tr_mul(&expected.linear).push(expected.angular);
        let inertia = Some(Coasting::of(&system.load, &goes_on(a), share));
        let (ground, radius, dashpots) = (&system.ground, system.load.radius, method.dashpots.blocks());
        let mut course =
            Straight { springs: springs.blocks(), dashpots, inertia, ground, start: &start, radius, carried, axes, expected_turn };
        let task = Task::inertial(end, step, Some(guess), Scope::Touching, true);
        let (found, side, at) = obstacles.as_mut()?.go_on(system, &mut course, solver, &mut state.side.touching, &task)?;
        let moved = Pose { position: pose.position + found.shift, heading: pose.heading + found.twist.z };
        let pose = if side.push_out == Vec3::zeros() { moved } else { moved.moved_by(&side.push_out) };
        let motion = Motion { pose, twist: Twist { linear: axes * at.xy() / share, angular: at.z / share } };
        if !motion.pose.is_finite() || !motion.twist.is_finite() {
            return None;
        }
        if method.is_damped {
            // Mean rates give work and losses of second order.
            method.dashpots.renew(system, springs, &start.pose, step);
            tips.iter_mut().zip(springs.iter()).for_each(|(tip, last)| *tip = last.tip);
        }
        state.side.now = end;
        state.forecast.learn(&found, step);
        let report = found.report;
        let stepped = Stepped { motion, stage: pose, friction: found.friction, mode: found.mode, past: None, side: Some(side), report };
        if !self.accept(&stepped, step) {
            return None;
        }
        let past = Past { shift: found.shift, turn: found.twist.z, duration: step };
        self.state.memory.touched = Some(Touched { step: past, before: twist, tips });
        Some(report)
    }
}

/// Whether paths of tips that began at a `share` of them, before their start, would have begun at
/// these `tips` (m, world), for a load of this `radius` (m).
fn go_straight_on(paths: &TipPaths, share: f64, tips: &[Vec2], radius: f64) -> bool {
    let goes = |(from, tip): (&Attachment, &Vec2)| {
        let missed = from.tip_towards(paths.targets, share) - tip;
        missed.norm() <= STRAIGHT_TIP * (radius + tip.norm())
    };
    tips.len() == paths.from.len() && paths.from.iter().zip(tips).all(goes)
}
