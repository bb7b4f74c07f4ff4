//! First divergence of two runs, and the trigger before it.

use serde::Serialize;

use super::attributed::{Attributed, of_event, starts_with_speed};
use super::difference::Jumps;
use super::numbers::natural_rate;
use super::solution::{Point, Solution};
use crate::analysis::trigger::{Trigger, TriggerKind};
use crate::backend::{Transition, TransitionKind};
use crate::scenario::Scenario;

/// First instant at which the edge displacement between two paths exceeds the tolerance and their
/// numerical errors together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Divergence {
    /// Time from the start of the run (s).
    pub time_s: f64,
    /// What an inertia effect is attributed to then; of an engine error, the last event before it.
    /// `null` if there was none.
    pub trigger: Option<Trigger>,
}

/// Two paths of one load.
pub(super) struct PathPair<'a> {
    a: &'a Solution,
    b: &'a Solution,
    /// Radius of the load (m).
    radius: f64,
    /// Largest edge displacement that counts as agreement (m).
    tolerance: f64,
    /// Jumps after which paths are not compared.
    jumps: &'a Jumps,
    /// Attribution of the distance of an inertial from a quasi-static path.
    attributed: Option<&'a Attributed>,
    /// Motions of the load that begin within this time after a grasp or a release are its effect
    /// (s).
    response_time: f64,
}

impl<'a> PathPair<'a> {
    /// Paths of a load, with the largest edge displacement that counts as agreement (m).
    pub fn new(
        [a, b]: [&'a Solution; 2],
        scenario: &Scenario,
        tolerance: f64,
        jumps: &'a Jumps,
        attributed: Option<&'a Attributed>,
    ) -> Self {
        let rate = natural_rate(scenario);
        let response_time = if rate > 0.0 { rate.recip() } else { 0.0 };
        Self { a, b, radius: scenario.system.load.radius, tolerance, jumps, attributed, response_time }
    }

    pub fn first_divergence(&self) -> Option<Divergence> {
        self.first_where(|a, b| {
            let error = a.error.position + b.error.position + self.radius * (a.error.heading + b.error.heading);
            a.pose.edge_displacement(&b.pose, self.radius) > self.tolerance + error
        })
    }

    /// First instant at which the headings differ by more than the `tolerance` (rad) and their
    /// numerical errors together.
    pub fn first_divergence_of_heading(&self, tolerance: f64) -> Option<Divergence> {
        self.first_where(|a, b| a.difference(b).1 > tolerance + a.error.heading + b.error.heading)
    }

    /// First instant of the comparison at which the paths are apart.
    fn first_where(&self, are_apart: impl Fn(&Point, &Point) -> bool) -> Option<Divergence> {
        let mut points = self.a.points.iter().zip(&self.b.points).filter(|(a, _)| self.jumps.allow(a.time));
        points.find(|(a, b)| are_apart(a, b)).map(|(a, _)| self.divergence_at(a.time))
    }

    /// Divergence at an instant (s), with its trigger.
    pub fn divergence_at(&self, time_s: f64) -> Divergence {
        let trigger = self.attributed.map_or_else(|| self.last_before(time_s), |attributed| attributed.trigger_at(time_s));
        Divergence { time_s, trigger }
    }

    /// Last event or change of motion before an instant (s).
    fn last_before(&self, time: f64) -> Option<Trigger> {
        let until = self.jumps.since_tick(time).map_or(time, f64::next_up);
        let events = &self.a.trace.events;
        let event = events[..events.partition_point(|event| event.time < until)].last().map(of_event);
        let since = event.map_or(f64::NEG_INFINITY, |event| event.time_s + self.response_time);
        let transition = |solution: &Solution| {
            let transitions = &solution.trace.transitions;
            let last = transitions[..transitions.partition_point(|transition| transition.time < until)].last()?;
            (last.time > since).then(|| of_transition(last))
        };
        let of_load = [self.a, self.b].into_iter().filter_map(transition).max_by(|a, b| a.time_s.total_cmp(&b.time_s));
        of_load.or(event).or_else(|| starts_with_speed(self.a).then_some(Trigger::new(TriggerKind::Start, 0.0)))
    }
}

fn of_transition(transition: &Transition) -> Trigger {
    let trigger = |kind| Trigger::new(kind, transition.time);
    match transition.kind {
        TransitionKind::SlipOnset => trigger(TriggerKind::SlipOnset),
        TransitionKind::Stop => trigger(TriggerKind::Stop),
        TransitionKind::Pinning { support } => Trigger { support: Some(support), ..trigger(TriggerKind::Pinning) },
        TransitionKind::Unpinning { support } => Trigger { support: Some(support), ..trigger(TriggerKind::Unpinning) },
        TransitionKind::Touch { obstacle }
        | TransitionKind::Separation { obstacle }
        | TransitionKind::SideStick { obstacle }
        | TransitionKind::SideSlip { obstacle }
        | TransitionKind::Impact { obstacle, .. }
        | TransitionKind::NotUnique { obstacle }
        | TransitionKind::Squeeze { obstacle } => Trigger { obstacle: Some(obstacle), ..trigger(TriggerKind::Contact) },
        TransitionKind::Jump { .. } => trigger(TriggerKind::Jump),
    }
}
