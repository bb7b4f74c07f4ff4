//! A verdict for each quantity: path, heading, pulls, contact forces, speed and energy dissipated.
//!
//! Path and heading are compared instant by instant. Of forces and speed, the peaks and the means
//! over the control ticks are compared, and of the energy its value at the end: a difference in
//! time alone is none of these. The reference error of each number is its distance from that of
//! the less exact run beside the reference run, as for the path.

use std::collections::HashMap;

use serde::Serialize;

use super::divergence::Divergence;
use super::parts::Parts;
use super::reduced::{Reduced, RunMeasure};
use super::verdict::{Answers, Cause, EngineAnswer, InertiaAnswer, Verdict};

/// Verdicts on the quantities of a run, each with its own tolerance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdicts {
    /// Edge displacement of the load (m).
    pub path: QuantityVerdict,
    /// Heading of the load (rad).
    pub heading: QuantityVerdict,
    /// Peak and mean pull of each spring, and of the vector sum of all pulls (N).
    pub pulls: QuantityVerdict,
    /// Peak and mean force of each obstacle on the load, outside of impacts (N).
    pub contacts: QuantityVerdict,
    /// Peak and mean speed of the load's centre and of its edge, |v| and |v| + R |omega| (m/s).
    pub speed: QuantityVerdict,
    /// Energy dissipated in the whole run (J).
    pub energy: QuantityVerdict,
    /// Measure of one's own; left out without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measure: Option<QuantityVerdict>,
}

/// Verdict on one quantity. Where it rests on several numbers, the differences are those of the
/// number that decides.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QuantityVerdict {
    /// The word that follows from the two answers.
    pub verdict: Verdict,
    pub inertia: InertiaAnswer,
    pub engine: EngineAnswer,
    /// Causes of what exceeds the tolerance, and of what a motion that is not unique leaves open.
    pub causes: Vec<Cause>,
    /// Name of the number whose differences these are; left out for path and heading.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decided_by: Option<String>,
    /// Inertial minus quasi-static, in the unit.
    pub inertia_effect: f64,
    /// Engine minus inertial, in the unit.
    pub engine_error: f64,
    /// Numerical error of quasi-static and inertial, in the unit.
    pub reference_error: f64,
    /// Largest difference that counts as agreement, in the unit.
    pub tolerance: f64,
    pub unit: &'static str,
    /// What the differences consist of, in the unit.
    pub parts: Parts,
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

/// Range of a share of which nothing is claimed (1).
const ANYTHING: [f64; 2] = [0.0, f64::INFINITY];

impl Verdicts {
    /// All but the measure of one's own.
    pub fn named(&self) -> [(&'static str, &QuantityVerdict); 6] {
        let Self { path, heading, pulls, contacts, speed, energy, .. } = self;
        [("path", path), ("heading", heading), ("pulls", pulls), ("contacts", contacts), ("speed", speed), ("energy", energy)]
    }

    /// Those that are numbers of the whole run.
    fn of_whole_run(&mut self) -> impl Iterator<Item = &mut QuantityVerdict> {
        let Self { pulls, contacts, speed, energy, measure, .. } = self;
        [pulls, contacts, speed, energy].into_iter().chain(measure)
    }

    fn all(&self) -> impl Iterator<Item = (&'static str, &QuantityVerdict)> {
        self.named().into_iter().chain(self.measure.as_ref().map(|of| ("measure", of)))
    }

    /// Those that say something: without a spring that is ever attached there are no pulls, without
    /// an obstacle that is ever touched no contact forces, and an engine may not compute all.
    pub fn shown(&self) -> impl Iterator<Item = (&'static str, &QuantityVerdict)> {
        self.all().filter(|(name, of)| match *name {
            "path" | "heading" => true,
            "pulls" => of.measures.iter().any(|measure| measure.spring.is_some()),
            _ => !of.measures.is_empty(),
        })
    }

    /// Leaves open what an exact run that is doubtful from a time on (s) does not show.
    ///
    /// Path and heading differ as much as they ever do: a difference beyond the tolerance before
    /// that time remains. The other quantities are numbers of the whole run, and remain open.
    /// What is left open has a motion that `is_not_unique` as a cause.
    pub(super) fn doubt(&mut self, since: f64, is_not_unique: bool) {
        [&mut self.path, &mut self.heading].into_iter().for_each(|of| of.doubt(since, is_not_unique));
        self.of_whole_run().for_each(|of| of.doubt(f64::NEG_INFINITY, is_not_unique));
    }

    /// Makes no claim on anything, because a run failed.
    pub(super) fn withdraw(&mut self) {
        self.path.withdraw();
        self.heading.withdraw();
        self.of_whole_run().for_each(QuantityVerdict::withdraw);
    }

    /// Whether the reference error leaves an answer open.
    pub(super) fn are_open(&self) -> bool {
        self.all().any(|(_, of)| of.answers().is_open() && !of.causes.contains(&Cause::NotUnique))
    }
}

impl QuantityVerdict {
    /// The number that decides: that of the largest inertia effect over its tolerance if inertia is
    /// a cause, else that of the largest engine error, else that of the largest difference.
    pub fn deciding(&self) -> Option<&RunMeasure> {
        // A verdict may be withdrawn, and the number stays.
        let verdict = Answers::of([0, 1].map(|which| self.share_range(which))).verdict();
        self.first_of_largest(|measure| measure.weight(verdict))
    }

    /// The two answers, from which the verdict follows.
    pub fn answers(&self) -> Answers {
        Answers { inertia: self.inertia, engine: self.engine }
    }

    /// Sets both answers, and the verdict.
    pub(super) fn answer(&mut self, answers: Answers) {
        (self.inertia, self.engine, self.verdict) = (answers.inertia, answers.engine, answers.verdict());
    }

    /// Leaves open what the runs do not determine.
    pub(super) fn leave_open(&mut self) {
        self.open = Open { inertia_effect: true, engine_error: true };
        self.answer(Answers::OPEN);
        self.causes = vec![Cause::NotUnique];
    }

    /// Makes no claim.
    fn withdraw(&mut self) {
        self.answer(Answers::OPEN);
        self.verdict = Verdict::NotComputed;
        self.causes.clear();
    }

    /// Answers from the differences, and their causes.
    pub(super) fn judge(&mut self) {
        self.answer(Answers::of([self.inertia_share_range(), self.engine_share_range()]));
        self.causes = self.found_causes();
    }

    /// Causes of the differences that exceed their tolerance for sure, each once.
    fn found_causes(&self) -> Vec<Cause> {
        let own = [(self.differences(), self.reference_error, self.tolerance, self.parts)];
        let of_measure = |of: &RunMeasure| (of.differences(), of.reference_error, of.tolerance, of.parts);
        let numbers: Vec<_> = if self.measures.is_empty() { own.to_vec() } else { self.measures.iter().map(of_measure).collect() };
        let causes = numbers.into_iter().flat_map(|(differences, error, tolerance, parts)| {
            let exceeds = differences.map(|difference| difference - error > tolerance);
            parts.causes(exceeds, error, tolerance)
        });
        let mut causes: Vec<Cause> = causes.collect();
        causes.sort_unstable();
        causes.dedup();
        causes
    }

    fn differences(&self) -> [f64; 2] {
        [self.inertia_effect, self.engine_error]
    }

    /// The number with the largest engine error over its tolerance.
    pub fn worst_of_engine(&self) -> Option<&RunMeasure> {
        self.first_of_largest(|measure| measure.engine_error / measure.tolerance)
    }

    fn first_of_largest(&self, weight: impl Fn(&RunMeasure) -> f64) -> Option<&RunMeasure> {
        self.measures.iter().reduce(|largest, measure| if weight(measure) > weight(largest) { measure } else { largest })
    }

    /// Leaves open what did not exceed the tolerance by the time `since` (s).
    fn doubt(&mut self, since: f64, is_not_unique: bool) {
        let stays = |is_cause: bool, first: Option<Divergence>| is_cause && first.is_some_and(|first| first.time_s <= since);
        let FirstDivergence { inertia_effect, engine_error } = self.first_divergence;
        let causes = [stays(self.verdict.has_inertia(), inertia_effect), stays(self.verdict.has_engine(), engine_error)];
        self.open = Open { inertia_effect: !causes[0], engine_error: !causes[1] };
        self.answer(Answers::of([self.inertia_share_range(), self.engine_share_range()]));
        self.causes.retain(|cause| causes[usize::from(cause.is_of_engine())]);
        if is_not_unique && self.answers().is_open() {
            self.causes.push(Cause::NotUnique);
        }
    }

    /// Largest inertia effect less and plus reference error over the tolerance (1): at most one
    /// where quasi-static is valid. It may be anything where a doubt leaves it open.
    pub fn inertia_share_range(&self) -> [f64; 2] {
        if self.open.inertia_effect { ANYTHING } else { self.share_range(0) }
    }

    /// As [`QuantityVerdict::inertia_share_range`], for the engine error.
    pub fn engine_share_range(&self) -> [f64; 2] {
        if self.open.engine_error { ANYTHING } else { self.share_range(1) }
    }

    /// Range of the inertia effect (0) or the engine error (1) over its tolerance (1): the largest
    /// of all numbers, if there are any.
    fn share_range(&self, which: usize) -> [f64; 2] {
        let range = |effect: f64, error: f64, tolerance: f64| [(effect - error) / tolerance, (effect + error) / tolerance];
        let of = |measure: &RunMeasure| range(measure.differences()[which], measure.reference_error, measure.tolerance);
        let largest = self.measures.iter().map(of).reduce(|a, b| [a[0].max(b[0]), a[1].max(b[1])]);
        largest.unwrap_or(range(self.differences()[which], self.reference_error, self.tolerance))
    }

    /// Verdict on those of several numbers in one `unit` that every run has. The tolerance of each
    /// is given by a function of the largest number of its name.
    /// `diverges` gives the first divergence at an instant (s) of inertia effect (0) or engine
    /// error (1).
    pub(super) fn on(
        reduced: &[Reduced],
        tolerance: impl Fn(f64) -> f64,
        times: &[f64],
        unit: &'static str,
        diverges: impl Fn(usize, f64) -> Divergence,
    ) -> Self {
        let mut largest: HashMap<&str, f64> = HashMap::new();
        let reduced: Vec<&Reduced> = reduced.iter().filter(|one| one.exists()).collect();
        for one in &reduced {
            let largest = largest.entry(one.scale).or_insert(0.0);
            *largest = largest.max(one.size());
        }
        let measures: Vec<RunMeasure> = reduced.iter().map(|one| one.measure(tolerance(largest[one.scale]))).collect();
        let first = |which: usize| {
            let times = reduced.iter().zip(&measures).filter_map(|(one, measure)| one.first_divergence(which, measure, times));
            times.min_by(f64::total_cmp).map(|time| diverges(which, time))
        };
        let first_divergence = FirstDivergence { inertia_effect: first(0), engine_error: first(1) };
        let mut found = Self { first_divergence, measures, ..Self::of_nothing(unit) };
        // Without a number there is nothing to differ.
        let Some(deciding) = found.deciding().copied() else { return found };
        let RunMeasure { inertia_effect, engine_error, reference_error, tolerance, parts, .. } = deciding;
        found = Self { inertia_effect, engine_error, reference_error, tolerance, parts, decided_by: Some(deciding.label()), ..found };
        found.judge();
        found
    }

    /// Verdict on a quantity that is zero everywhere.
    pub(super) fn of_nothing(unit: &'static str) -> Self {
        Self {
            verdict: Verdict::Agree,
            inertia: InertiaAnswer::Negligible,
            engine: EngineAnswer::Within,
            causes: Vec::new(),
            decided_by: None,
            inertia_effect: 0.0,
            engine_error: 0.0,
            reference_error: 0.0,
            tolerance: 0.0,
            unit,
            parts: Parts::default(),
            first_divergence: FirstDivergence::default(),
            open: Open::default(),
            measures: Vec::new(),
        }
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
            obstacle: None,
            quasi_static: 0.0,
            inertial: 0.0,
            engine: 0.0,
            inertia_effect,
            engine_error,
            reference_error: 0.0,
            tolerance: 1.0,
            parts: Parts::default(),
            undetermined: 0.0,
        };
        let measures = vec![measure("mean speed", 1.5, 9.0), measure("peak speed", 2.0, 0.0)];
        let mut of = QuantityVerdict { measures, ..QuantityVerdict::of_nothing("m/s") };
        of.judge();
        assert_eq!(of.verdict, Verdict::InertiaAndEngine);
        for verdict in [Verdict::InertiaAndEngine, Verdict::NotComputed, Verdict::Inconclusive] {
            let of = QuantityVerdict { verdict, ..of.clone() };
            assert_eq!(of.deciding().map(|measure| measure.name), Some("peak speed"), "{verdict:?}");
        }
    }
}
