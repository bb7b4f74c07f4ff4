//! Numbers of a run on the three backends, such as a peak pull, from their courses over the ticks.

use serde::Serialize;

use super::course::{Course, Ranged, Signal};
use super::parts::{Others, Parts};
use super::verdict::Verdict;

/// One number of a run on the exact backends and the engine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RunMeasure {
    /// Such as `peak pull`.
    pub name: &'static str,
    /// Spring that it belongs to; left out for numbers of the load.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spring: Option<usize>,
    /// Obstacle whose force it is; left out for other numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub obstacle: Option<usize>,
    pub quasi_static: f64,
    pub inertial: f64,
    pub engine: f64,
    /// Distance of inertial from quasi-static, outside of what no law determines.
    pub inertia_effect: f64,
    /// Distance of the engine from inertial, outside of what no law determines.
    pub engine_error: f64,
    pub reference_error: f64,
    pub tolerance: f64,
    pub parts: Parts,
    /// Width of the numbers that are as right as those of the exact runs: that of the contact
    /// forces of a load at rest, of which the ground bears as much as it happens to. Left out if
    /// all are determined.
    #[serde(skip_serializing_if = "crate::math::is_zero")]
    pub undetermined: f64,
}

/// Number that a course over ticks is reduced to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Largest value.
    Peak,
    /// Mean over the ticks at which there is a value.
    Mean,
    /// Value at the end.
    Last,
}

/// One number, with its course over the ticks on each backend.
pub(super) struct Reduced<'a> {
    kind: Kind,
    name: &'static str,
    /// Name of the numbers of which the tolerance is a share.
    pub scale: &'static str,
    spring: Option<usize>,
    obstacle: Option<usize>,
    /// Quasi-static, inertial and engine.
    signals: [&'a Signal; 3],
    /// The less exact runs beside the first two.
    companions: [Option<&'a Signal>; 2],
    others: Others<&'a Signal>,
}

/// Courses of the three runs, of the less exact runs beside the first two, and of the runs that
/// tell parts of the differences.
pub(super) struct Courses {
    pub runs: [Course; 3],
    pub companions: [Option<Course>; 2],
    pub others: Others<Course>,
}

impl RunMeasure {
    /// Name with the spring or the obstacle, such as `peak pull of spring 2`.
    pub fn label(&self) -> String {
        match (self.spring, self.obstacle) {
            (Some(spring), _) => format!("{} of spring {spring}", self.name),
            (_, Some(obstacle)) => format!("{} of obstacle {obstacle}", self.name),
            (None, None) => self.name.to_owned(),
        }
    }

    pub(super) fn differences(&self) -> [f64; 2] {
        [self.inertia_effect, self.engine_error]
    }

    /// Difference over the tolerance (1) that counts under a verdict on all numbers.
    pub(super) fn weight(&self, verdict: Verdict) -> f64 {
        match verdict {
            Verdict::Inertia | Verdict::InertiaAndEngine => self.inertia_effect / self.tolerance,
            Verdict::Engine => self.engine_error / self.tolerance,
            _ => self.inertia_effect.max(self.engine_error) / self.tolerance,
        }
    }
}

impl Courses {
    /// Peak and mean pull of each spring that is ever attached, and of the vector sum of the pulls.
    pub fn pulls(&self) -> Vec<Reduced<'_>> {
        let is_attached = |spring: &usize| self.runs[0].pulls[*spring].iter().any(Option::is_some);
        let springs = (0..self.runs[0].pulls.len()).filter(is_attached);
        let of_springs = springs.flat_map(|spring| {
            [("peak pull", Kind::Peak), ("mean pull", Kind::Mean)]
                .map(|(name, kind)| Reduced { spring: Some(spring), ..self.reduced(name, kind, |course| &course.pulls[spring]) })
        });
        let net = [("peak net pull", Kind::Peak), ("mean net pull", Kind::Mean)];
        of_springs.chain(net.map(|(name, kind)| self.reduced(name, kind, |course| &course.net_pull))).collect()
    }

    /// Peak and mean force of each obstacle that a load ever touches.
    pub fn contacts(&self) -> Vec<Reduced<'_>> {
        let is_touched = |obstacle: &usize| {
            let forces = self.runs.iter().flat_map(|course| &course.contact_forces[*obstacle]);
            forces.flatten().any(|force| force.value > 0.0)
        };
        let of_obstacle = |obstacle: usize| {
            [("peak contact force", Kind::Peak), ("mean contact force", Kind::Mean)].map(|(name, kind)| Reduced {
                obstacle: Some(obstacle),
                ..self.reduced(name, kind, move |course| &course.contact_forces[obstacle])
            })
        };
        (0..self.runs[0].contact_forces.len()).filter(is_touched).flat_map(of_obstacle).collect()
    }

    /// Speeds of the centre and of the edge. The tolerance of both is a share of the latter: a load
    /// that turns about its centre has no speed to be compared with.
    pub fn speeds(&self) -> Vec<Reduced<'_>> {
        let (peak, mean) = ("peak edge speed", "mean edge speed");
        vec![
            Reduced { scale: peak, ..self.reduced("peak speed", Kind::Peak, |course| &course.speed.between_jumps) },
            Reduced { scale: mean, ..self.reduced("mean speed", Kind::Mean, |course| &course.speed.at_ticks) },
            self.reduced(peak, Kind::Peak, |course| &course.edge_speed.between_jumps),
            self.reduced(mean, Kind::Mean, |course| &course.edge_speed.at_ticks),
        ]
    }

    pub fn energy(&self) -> Vec<Reduced<'_>> {
        vec![self.reduced("energy dissipated", Kind::Last, |course| &course.dissipated)]
    }

    /// The measure of one's own, with its name.
    pub fn own(&self, name: &'static str) -> Vec<Reduced<'_>> {
        vec![self.reduced(name, Kind::Last, |course| &course.own)]
    }

    fn reduced<'a>(&'a self, name: &'static str, kind: Kind, of: impl Fn(&'a Course) -> &'a Signal) -> Reduced<'a> {
        let companions = self.companions.each_ref().map(|course| course.as_ref().map(&of));
        let (signals, others) = (self.runs.each_ref().map(&of), self.others.map(&of));
        Reduced { kind, name, scale: name, spring: None, obstacle: None, signals, companions, others }
    }
}

impl Reduced<'_> {
    /// Whether each run has this number.
    pub fn exists(&self) -> bool {
        let companions = self.companions.iter().copied().flatten();
        self.signals.into_iter().chain(companions).all(|signal| signal.iter().any(Option::is_some))
    }

    /// Size of the larger one of the quasi-static and the inertial value.
    pub fn size(&self) -> f64 {
        self.kind.number(self.signals[0]).value.abs().max(self.kind.number(self.signals[1]).value.abs())
    }

    pub(super) fn measure(&self, tolerance: f64) -> RunMeasure {
        let numbers = self.signals.map(|signal| self.kind.number(signal));
        let error = |at: usize| self.companions[at].map_or(0.0, |companion| self.kind.number(companion).gap(&numbers[at]));
        let others = self.others.map(|signal| self.kind.number(signal).value);
        let [quasi_static, inertial, engine] = numbers.map(|number| number.value);
        RunMeasure {
            name: self.name,
            spring: self.spring,
            obstacle: self.obstacle,
            quasi_static,
            inertial,
            engine,
            inertia_effect: numbers[1].gap(&numbers[0]),
            engine_error: numbers[2].gap(&numbers[1]),
            reference_error: error(0).max(error(1)),
            tolerance,
            parts: Parts::of_numbers([quasi_static, inertial, engine], &others),
            undetermined: numbers[..2].iter().map(|number| number.high - number.low).fold(0.0, f64::max),
        }
    }

    /// First time (s) at which the numbers so far differ by more than the tolerance and the
    /// reference error, if they do at the end; a peak from the other run's final one.
    pub(super) fn first_divergence(&self, which: usize, measure: &RunMeasure, times: &[f64]) -> Option<f64> {
        let [a, b] = [self.signals[which], self.signals[which + 1]];
        let (last, allowed) = (a.len().min(b.len()).checked_sub(1)?, measure.tolerance + measure.reference_error);
        let [of_a, of_b] = [a, b].map(|signal| self.kind.so_far(signal));
        let differ = |at: &usize| match self.kind {
            Kind::Peak => of_a[*at].excess(&of_b[last]).max(of_b[*at].excess(&of_a[last])) > allowed,
            Kind::Mean | Kind::Last => of_a[*at].gap(&of_b[*at]) > allowed,
        };
        (differ(&last)).then(|| (0..=last).find(differ).and_then(|at| times.get(at).copied()))?
    }
}

impl Kind {
    /// Zero if there is no value.
    fn number(self, signal: &Signal) -> Ranged {
        self.so_far(signal).last().copied().unwrap_or_default()
    }

    /// Values up to each tick. Means are sums over the number of values in the whole run, so that
    /// they end at the mean.
    fn so_far(self, signal: &Signal) -> Vec<Ranged> {
        let n = signal.iter().flatten().count().max(1) as f64;
        let mut so_far = Ranged::default();
        let next = |value: &Option<Ranged>| {
            so_far = match (self, value) {
                (_, None) => so_far,
                (Kind::Peak, Some(value)) => so_far.map(*value, f64::max),
                (Kind::Mean, Some(value)) => so_far.map(*value, |sum, value| sum + value / n),
                (Kind::Last, Some(value)) => *value,
            };
            so_far
        };
        signal.iter().map(next).collect()
    }
}
