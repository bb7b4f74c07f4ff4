//! A verdict for each quantity: path, heading, pulls, speed and energy dissipated.
//!
//! Path and heading are compared instant by instant. Of pulls and speed, the peaks and the means
//! over the control ticks are compared, and of the energy its value at the end: a difference in
//! time alone is none of these. The reference error of each number is its distance from that of
//! the less exact run beside the reference run, as for the path.

use std::collections::HashMap;

use serde::Serialize;

use super::course::Course;
use super::divergence::Divergence;
use super::verdict::Verdict;

/// Verdicts on the quantities of a run, each with its own tolerance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdicts {
    /// Edge displacement of the load (m).
    pub path: QuantityVerdict,
    /// Heading of the load (rad).
    pub heading: QuantityVerdict,
    /// Peak and mean pull of each spring, and of the vector sum of all pulls (N).
    pub pulls: QuantityVerdict,
    /// Peak and mean edge speed of the load (m/s).
    pub speed: QuantityVerdict,
    /// Energy dissipated in the whole run (J).
    pub energy: QuantityVerdict,
}

/// Verdict on one quantity. Where it rests on several numbers, the differences are those of the
/// number that decides.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QuantityVerdict {
    pub verdict: Verdict,
    /// Inertial minus quasi-static, in the unit.
    pub inertia_effect: f64,
    /// Rapier minus inertial, in the unit.
    pub engine_error: f64,
    /// Numerical error of quasi-static and inertial, in the unit.
    pub reference_error: f64,
    /// Largest difference that counts as agreement, in the unit.
    pub tolerance: f64,
    pub unit: &'static str,
    pub first_divergence: FirstDivergence,
    /// Differences that a doubt leaves open; left out if there are none.
    #[serde(skip_serializing_if = "Open::is_empty")]
    pub open: Open,
    /// The numbers on which the verdict rests; left out for path and heading.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub measures: Vec<RunMeasure>,
}

/// First divergences of the runs; `null` where a difference stays below the tolerance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FirstDivergence {
    pub inertia_effect: Option<Divergence>,
    pub engine_error: Option<Divergence>,
}

/// Differences of which nothing is claimed, because an exact run is doubtful.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Open {
    pub inertia_effect: bool,
    pub engine_error: bool,
}

impl Open {
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// One number of a run on the three backends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RunMeasure {
    /// Such as `peak pull`.
    pub name: &'static str,
    /// Spring that it belongs to; left out for numbers of the load.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spring: Option<usize>,
    pub quasi_static: f64,
    pub inertial: f64,
    pub rapier: f64,
    pub inertia_effect: f64,
    pub engine_error: f64,
    pub reference_error: f64,
    pub tolerance: f64,
}

/// Range of a share of which nothing is claimed (1).
const ANYTHING: [f64; 2] = [0.0, f64::INFINITY];

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

type Signal = Vec<Option<f64>>;

/// One number, with its course over the ticks on each backend.
pub(super) struct Reduced<'a> {
    kind: Kind,
    name: &'static str,
    spring: Option<usize>,
    /// Quasi-static, inertial and rapier.
    signals: [&'a Signal; 3],
    /// The less exact runs beside the first two.
    companions: [Option<&'a Signal>; 2],
}

/// Courses of the three runs, and of the less exact runs beside the first two.
pub(super) struct Courses {
    pub runs: [Course; 3],
    pub companions: [Option<Course>; 2],
}

impl Verdicts {
    pub fn named(&self) -> [(&'static str, &QuantityVerdict); 5] {
        [("path", &self.path), ("heading", &self.heading), ("pulls", &self.pulls), ("speed", &self.speed), ("energy", &self.energy)]
    }

    /// Those that say something: without a spring that is ever attached there are no pulls.
    pub fn shown(&self) -> impl Iterator<Item = (&'static str, &QuantityVerdict)> {
        let has_pulls = self.pulls.measures.iter().any(|measure| measure.spring.is_some());
        self.named().into_iter().filter(move |(name, _)| has_pulls || *name != "pulls")
    }

    /// Leaves open what an exact run that is doubtful from a time on (s) does not show.
    ///
    /// Path and heading differ as much as they ever do: a difference beyond the tolerance before
    /// that time remains. The other quantities are numbers of the whole run, and remain open.
    pub(super) fn doubt(&mut self, since: f64) {
        let Self { path, heading, pulls, speed, energy } = self;
        [path, heading].into_iter().for_each(|of| of.doubt(since));
        [pulls, speed, energy].into_iter().for_each(|of| of.doubt(f64::NEG_INFINITY));
    }

    pub(super) fn set_all(&mut self, verdict: Verdict) {
        for of in [&mut self.path, &mut self.heading, &mut self.pulls, &mut self.speed, &mut self.energy] {
            of.verdict = verdict;
        }
    }
}

impl QuantityVerdict {
    /// The number that decides: that of the largest inertia effect over its tolerance if inertia is
    /// a cause, else that of the largest engine error, else that of the largest difference.
    pub fn deciding(&self) -> Option<&RunMeasure> {
        // A verdict may be withdrawn, and the number stays.
        let verdict = verdict_of(&self.measures);
        self.first_of_largest(|measure| measure.weight(verdict))
    }

    /// The number with the largest engine error over its tolerance.
    pub fn worst_of_engine(&self) -> Option<&RunMeasure> {
        self.first_of_largest(|measure| measure.engine_error / measure.tolerance)
    }

    fn first_of_largest(&self, weight: impl Fn(&RunMeasure) -> f64) -> Option<&RunMeasure> {
        self.measures.iter().reduce(|largest, measure| if weight(measure) > weight(largest) { measure } else { largest })
    }

    /// Leaves open what did not exceed the tolerance by the time `since` (s).
    fn doubt(&mut self, since: f64) {
        let stays = |is_cause: bool, first: Option<Divergence>| is_cause && first.is_some_and(|first| first.time_s <= since);
        let FirstDivergence { inertia_effect, engine_error } = self.first_divergence;
        let causes = [stays(self.verdict.has_inertia(), inertia_effect), stays(self.verdict.has_engine(), engine_error)];
        self.open = Open { inertia_effect: !causes[0], engine_error: !causes[1] };
        self.verdict = Verdict::of_causes(causes).unwrap_or(Verdict::Inconclusive);
    }

    /// Largest inertia effect less and plus reference error over the tolerance (1): at most one
    /// where quasi-static is valid. It may be anything where a doubt leaves it open.
    pub fn inertia_share_range(&self) -> [f64; 2] {
        if self.open.inertia_effect { ANYTHING } else { self.share_range(self.inertia_effect, |measure| measure.inertia_effect) }
    }

    /// As [`QuantityVerdict::inertia_share_range`], for the engine error.
    pub fn engine_share_range(&self) -> [f64; 2] {
        if self.open.engine_error { ANYTHING } else { self.share_range(self.engine_error, |measure| measure.engine_error) }
    }

    /// Range of a difference over its tolerance (1): the largest of all numbers, if there are any.
    fn share_range(&self, own: f64, difference: fn(&RunMeasure) -> f64) -> [f64; 2] {
        let range = |effect: f64, error: f64, tolerance: f64| [(effect - error) / tolerance, (effect + error) / tolerance];
        let of = |measure: &RunMeasure| range(difference(measure), measure.reference_error, measure.tolerance);
        let largest = self.measures.iter().map(of).reduce(|a, b| [a[0].max(b[0]), a[1].max(b[1])]);
        largest.unwrap_or(range(own, self.reference_error, self.tolerance))
    }

    /// Verdict on several numbers in one `unit`. The tolerance of each is this `share` (1) of the
    /// largest number of its name, or of `least` if that is more. `diverges` gives the first
    /// divergence at an instant (s) of inertia effect (0) or engine error (1).
    pub(super) fn on(
        reduced: &[Reduced],
        (share, least): (f64, f64),
        times: &[f64],
        unit: &'static str,
        diverges: impl Fn(usize, f64) -> Divergence,
    ) -> Self {
        let mut largest: HashMap<&str, f64> = HashMap::new();
        for one in reduced {
            let largest = largest.entry(one.name).or_insert(least);
            *largest = largest.max(one.size());
        }
        let measures: Vec<RunMeasure> = reduced.iter().map(|one| one.measure(share * largest[one.name])).collect();
        let verdict = verdict_of(&measures);
        let first = |which: usize| {
            let times = reduced.iter().zip(&measures).filter_map(|(one, measure)| one.first_divergence(which, measure, times));
            times.min_by(f64::total_cmp).map(|time| diverges(which, time))
        };
        let first_divergence = FirstDivergence { inertia_effect: first(0), engine_error: first(1) };
        let mut found = Self {
            verdict,
            inertia_effect: 0.0,
            engine_error: 0.0,
            reference_error: 0.0,
            tolerance: 0.0,
            unit,
            first_divergence,
            open: Open::default(),
            measures,
        };
        if let Some(deciding) = found.deciding().copied() {
            let RunMeasure { inertia_effect, engine_error, reference_error, tolerance, .. } = deciding;
            found = Self { inertia_effect, engine_error, reference_error, tolerance, ..found };
        }
        found
    }
}

impl RunMeasure {
    /// Name with the spring, such as `peak pull of spring 2`.
    pub fn label(&self) -> String {
        self.spring.map_or(self.name.to_owned(), |spring| format!("{} of spring {spring}", self.name))
    }

    fn verdict(&self) -> Verdict {
        Verdict::of(self.inertia_effect, self.engine_error, self.reference_error, self.tolerance)
    }

    /// Difference over the tolerance (1) that counts under a verdict on all numbers.
    fn weight(&self, verdict: Verdict) -> f64 {
        match verdict {
            Verdict::Inertia | Verdict::InertiaAndEngine => self.inertia_effect / self.tolerance,
            Verdict::Engine => self.engine_error / self.tolerance,
            _ => self.inertia_effect.max(self.engine_error) / self.tolerance,
        }
    }
}

/// Verdict on several numbers together.
fn verdict_of(measures: &[RunMeasure]) -> Verdict {
    measures.iter().map(RunMeasure::verdict).fold(Verdict::Agree, Verdict::and)
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

    pub fn speeds(&self) -> Vec<Reduced<'_>> {
        vec![
            self.reduced("peak speed", Kind::Peak, |course| &course.speed_between_jumps),
            self.reduced("mean speed", Kind::Mean, |course| &course.speed),
        ]
    }

    pub fn energy(&self) -> Vec<Reduced<'_>> {
        vec![self.reduced("energy dissipated", Kind::Last, |course| &course.dissipated)]
    }

    fn reduced<'a>(&'a self, name: &'static str, kind: Kind, of: impl Fn(&'a Course) -> &'a Signal) -> Reduced<'a> {
        let signals = self.runs.each_ref().map(&of);
        Reduced { kind, name, spring: None, signals, companions: self.companions.each_ref().map(|course| course.as_ref().map(&of)) }
    }
}

impl Reduced<'_> {
    /// Largest of the quasi-static and the inertial value.
    pub fn size(&self) -> f64 {
        self.kind.value(self.signals[0]).max(self.kind.value(self.signals[1]))
    }

    fn measure(&self, tolerance: f64) -> RunMeasure {
        let [quasi_static, inertial, rapier] = self.signals.map(|signal| self.kind.value(signal));
        let error = |at: usize, value: f64| self.companions[at].map_or(0.0, |companion| (self.kind.value(companion) - value).abs());
        RunMeasure {
            name: self.name,
            spring: self.spring,
            quasi_static,
            inertial,
            rapier,
            inertia_effect: (inertial - quasi_static).abs(),
            engine_error: (rapier - inertial).abs(),
            reference_error: error(0, quasi_static).max(error(1, inertial)),
            tolerance,
        }
    }

    /// First time (s) at which the numbers so far differ by more than the tolerance and the
    /// reference error, if they do at the end; a peak from the other run's final one.
    fn first_divergence(&self, which: usize, measure: &RunMeasure, times: &[f64]) -> Option<f64> {
        let [a, b] = [self.signals[which], self.signals[which + 1]];
        let (last, allowed) = (a.len().min(b.len()).checked_sub(1)?, measure.tolerance + measure.reference_error);
        let [of_a, of_b] = [a, b].map(|signal| self.kind.so_far(signal));
        let differ = |at: &usize| match self.kind {
            Kind::Peak => of_a[*at].max(of_b[*at]) > of_a[last].min(of_b[last]) + allowed,
            Kind::Mean | Kind::Last => (of_a[*at] - of_b[*at]).abs() > allowed,
        };
        (differ(&last)).then(|| (0..=last).find(differ).and_then(|at| times.get(at).copied()))?
    }
}

impl Kind {
    fn value(self, signal: &Signal) -> f64 {
        self.so_far(signal).last().copied().unwrap_or(0.0)
    }

    /// Values up to each tick. Means are sums over the number of values in the whole run, so that
    /// they end at the mean.
    fn so_far(self, signal: &Signal) -> Vec<f64> {
        let n = signal.iter().flatten().count().max(1) as f64;
        let mut so_far = 0.0f64;
        let next = |value: &Option<f64>| {
            so_far = match (self, value) {
                (_, None) => so_far,
                (Kind::Peak, Some(value)) => so_far.max(*value),
                (Kind::Mean, Some(value)) => so_far + value / n,
                (Kind::Last, Some(value)) => *value,
            };
            so_far
        };
        signal.iter().map(next).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The engine error of the mean is the largest share, but inertia is a cause, by the peak.
    #[test]
    fn a_withdrawn_verdict_keeps_the_number_that_decided() {
        let measure = |name, inertia_effect, engine_error| RunMeasure {
            name,
            spring: None,
            quasi_static: 0.0,
            inertial: 0.0,
            rapier: 0.0,
            inertia_effect,
            engine_error,
            reference_error: 0.0,
            tolerance: 1.0,
        };
        let measures = vec![measure("mean speed", 1.5, 9.0), measure("peak speed", 2.0, 0.0)];
        let (inertia_effect, engine_error, reference_error, tolerance) = (2.0, 0.0, 0.0, 1.0);
        let first_divergence = FirstDivergence::default();
        for verdict in [Verdict::InertiaAndEngine, Verdict::NotComputed, Verdict::Inconclusive] {
            let measures = measures.clone();
            let of = QuantityVerdict {
                verdict,
                inertia_effect,
                engine_error,
                reference_error,
                tolerance,
                unit: "m/s",
                first_divergence,
                open: Open::default(),
                measures,
            };
            assert_eq!(of.deciding().map(|measure| measure.name), Some("peak speed"), "{verdict:?}");
        }
    }
}
