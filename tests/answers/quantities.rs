//! Verdicts on every quantity, on scenes along one line whose truth comes from an independent
//! solution.

use cohaul::analysis::compare::{Pathwise, QuantityVerdict, Settings, ThreeWay, Verdict};
use cohaul::backend::{BackendKind, BackendOptions, default_step};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Simulation};
use cohaul_studies::compare::answer::sentence_of_paths;
use rayon::prelude::*;

use crate::oracle::{Line, RADIUS, Tick, Tip};

fn ramp(speed: f64, until: f64) -> Tip {
    Tip { corners: vec![(0.0, 0.0), (until, speed * until)], release: None }
}

/// The paper's load: f = 22 mN at 0.664 N/m. The tip moves for 0.5 s and holds.
fn light(name: &'static str, mass_factor: f64, speed: f64, damping_ratio: f64) -> Line {
    let (mass, friction, stiffness) = (0.0016 * mass_factor, 0.022, 0.664);
    Line { name, mass, friction, stiffness, damping_ratio, start: 0.0, tips: vec![ramp(speed, 0.5)], duration: 0.6, period: 2.5e-3 }
}

/// A box of 2 kg that a robot tows by an almost rigid link.
fn towed(name: &'static str, speed: f64, damping_ratio: f64) -> Line {
    let (mass, friction, stiffness) = (2.0, 8.0, 1e5);
    Line { name, mass, friction, stiffness, damping_ratio, start: 0.0, tips: vec![ramp(speed, 0.4)], duration: 0.5, period: 2.5e-3 }
}

/// Several tips pull a load and hold; some are released.
fn team(name: &'static str, damping_ratio: f64, tips: &[(f64, Option<f64>)]) -> Line {
    let tip = |(stretch, release): &(f64, Option<f64>)| Tip { corners: vec![(0.0, 0.0), (0.1, *stretch)], release: *release };
    let tips = tips.iter().map(tip).collect();
    Line { name, mass: 0.5, friction: 2.0, stiffness: 200.0, damping_ratio, start: 0.0, tips, duration: 0.5, period: 2.5e-3 }
}

fn scenes() -> Vec<Line> {
    let mut scenes = vec![
        light("slow and light", 1e-3, 0.1, 0.0),
        light("slow and light, damped", 1e-3, 0.1, 0.7),
        light("a thirtieth of the mass", 0.03, 0.1, 0.7),
        light("as in the paper", 1.0, 0.1, 0.0),
        light("as in the paper, slow", 1.0, 0.07, 0.0),
        light("as in the paper, critically damped", 1.0, 0.1, 1.0),
        light("heavy", 10.0, 0.1, 0.0),
        light("heavy, damped", 10.0, 0.1, 0.5),
        light("below the slip limit", 1.0, 0.05, 0.0),
        light("below the slip limit, damped", 1.0, 0.05, 0.3),
        team("a team that holds", 0.0, &[(0.02, None), (0.01, None)]),
        team("a team without a release", 0.7, &[(0.02, None), (0.01, None), (0.03, None)]),
        team("one of three is released", 0.1, &[(0.02, None), (0.01, None), (-0.03, Some(0.25))]),
        team("two of three are released", 0.1, &[(0.04, None), (-0.02, Some(0.2)), (-0.02, Some(0.3))]),
        team("one of three is released, critically damped", 1.0, &[(0.02, None), (0.01, None), (-0.03, Some(0.25))]),
        team("a release that moves nothing", 0.0, &[(0.004, None), (-0.004, Some(0.25))]),
        team("a tug of war", 0.0, &[(0.03, None), (-0.03, Some(0.25))]),
        team("a tug of war, overdamped", 3.0, &[(0.03, None), (-0.03, Some(0.25))]),
    ];
    let towing = [0.1, 0.3, 0.7, 1.0, 1.5, 3.0, 10.0, 20.0];
    let names = ["0.1", "0.3", "0.7", "1", "1.5", "3", "10", "20"];
    scenes.extend(towing.iter().zip(names).map(|(zeta, name)| towed(name, 0.5, *zeta)));
    scenes.push(towed("towed slowly", 2e-4, 0.1));
    scenes.push(towed("towed at a creep, damped", 2e-4, 1.0));
    scenes.push(Line { start: 0.3, tips: Vec::new(), ..towed("a start with speed", 0.0, 0.0) });
    scenes.push(Line { start: 0.3, ..light("a start with speed on a spring", 1.0, 0.1, 0.2) });
    scenes.push(Line { start: -0.1, ..towed("a start against the pull", 0.1, 0.5) });
    scenes.push(Line { tips: vec![ramp(0.1, 0.2), ramp(0.2, 0.4)], ..towed("two unequal tips", 0.0, 0.5) });
    scenes
}

/// Numbers of a run at its ticks.
struct Numbers {
    peaks: Vec<f64>,
    means: Vec<f64>,
    net: [f64; 2],
    speed: [f64; 2],
    dissipated: f64,
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(sum, n), value| (sum + value, n + 1.0));
    if n > 0.0 { sum / n } else { 0.0 }
}

fn peak(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

impl Numbers {
    /// `jumps` are the ticks before which a load without inertia has jumped.
    fn of(ticks: &[Tick], jumps: &[usize]) -> Self {
        let n_springs = ticks[0].pulls.len();
        let pulls = |spring: usize| ticks.iter().filter_map(move |tick| tick.pulls[spring].map(f64::abs));
        let net = || ticks.iter().map(|tick| tick.pulls.iter().flatten().sum::<f64>().abs());
        let speeds = || ticks.iter().map(|tick| tick.speed.abs());
        let between = ticks.iter().enumerate().filter(|(at, _)| !jumps.contains(at)).map(|(_, tick)| tick.speed.abs());
        Self {
            peaks: (0..n_springs).map(|spring| peak(pulls(spring))).collect(),
            means: (0..n_springs).map(|spring| mean(pulls(spring))).collect(),
            net: [peak(net()), mean(net())],
            speed: [peak(between), mean(speeds())],
            dissipated: ticks.last().unwrap().dissipated,
        }
    }

    /// All numbers with their names and springs, in the order of the verdict.
    fn list(&self) -> Vec<(&'static str, f64)> {
        let of_springs = self.peaks.iter().zip(&self.means).flat_map(|(peak, mean)| [("peak pull", *peak), ("mean pull", *mean)]);
        let net = [("peak net pull", self.net[0]), ("mean net pull", self.net[1])];
        let of_load = [("peak speed", self.speed[0]), ("mean speed", self.speed[1]), ("energy dissipated", self.dissipated)];
        of_springs.chain(net).chain(of_load).collect()
    }
}

/// Rapier alone, at its ticks.
fn of_rapier(scenario: &Scenario) -> (Numbers, Vec<f64>) {
    let step = default_step(BackendKind::Rapier, &scenario.system, scenario.control_period);
    let mut run = Simulation::new(scenario, &BackendOptions::new(BackendKind::Rapier, step), Keep::Trace);
    run.run(|_| true);
    let tick = |row: &cohaul::simulation::Row| Tick {
        place: row.motion.pose.position.x,
        speed: row.motion.twist.linear.norm() + RADIUS * row.motion.twist.angular.abs(),
        pulls: (0..scenario.system.springs.len())
            .map(|spring| row.tips.iter().find(|tip| tip.spring == spring).map(|tip| tip.pull.x))
            .collect(),
        dissipated: row.energy.dissipated(),
    };
    let ticks: Vec<Tick> = run.trace().rows.iter().map(tick).collect();
    (Numbers::of(&ticks, &[]), ticks.iter().map(|tick| tick.place).collect())
}

/// Whether a verdict on two differences is right: the causes beyond the tolerance, and none that is
/// within it. A difference nearer to the tolerance than the reference error may be left open.
fn assert_right(name: &str, found: &QuantityVerdict, [inertia, engine]: [f64; 2], margin: f64) {
    let (tolerance, open) = (1.0, margin);
    for (cause, share, is_named) in [("inertia", inertia, found.verdict.has_inertia()), ("engine", engine, found.verdict.has_engine())] {
        let is_open = (share - tolerance).abs() <= open;
        assert!(is_open || is_named == (share > tolerance), "{name}: {cause} is {share} of the tolerance: {:?}", found.verdict);
    }
}

struct Outcome {
    name: &'static str,
    verdicts: [Verdict; 6],
    n_numbers: usize,
}

fn check(line: &Line) -> Outcome {
    let scenario = line.scene();
    let found = ThreeWay::new(&scenario, &Settings::default()).prescribed(|_| true).unwrap();
    let name = line.name;
    // A release moves a load without inertia and dashpots at once.
    let releases = || line.tips.iter().filter_map(|tip| tip.release).filter(|_| line.damping_ratio == 0.0);
    let jumps: Vec<usize> = releases().map(|release| (release / line.period).round() as usize + 1).collect();
    let [with, without] = [line.with_inertia(line.period), line.without_inertia(line.period)];
    let (rapier, places) = of_rapier(&scenario);
    let lists = [Numbers::of(&without, &jumps).list(), Numbers::of(&with, &[]).list(), rapier.list()];
    let moves = peak(with.iter().chain(&without).map(|tick| tick.place.abs())) > 0.0;

    // Numbers of pulls, speed and energy, one by one.
    let verdicts = &found.verdicts;
    let measures = [&verdicts.pulls, &verdicts.speed, &verdicts.energy].into_iter().flat_map(|of| &of.measures);
    // A load that does not turn has the speed of its edge.
    let measures: Vec<_> = measures.filter(|measure| !measure.name.contains("edge")).collect();
    assert_eq!(measures.len(), lists[0].len(), "{name}");
    let mut shares = vec![];
    for (at, measure) in measures.iter().enumerate() {
        assert_eq!(measure.name, lists[0][at].0);
        let values = [0, 1, 2].map(|kind| lists[kind][at].1);
        // The truth has an error of its own, from steps of 1/500 rad.
        let allowed = measure.reference_error + 5e-3 * measure.tolerance + 1e-12;
        for (found, truth) in [(measure.quasi_static, values[0]), (measure.inertial, values[1])] {
            assert!((found - truth).abs() <= allowed, "{name}, {}: {found} is not {truth}, {measure:?}", measure.label());
        }
        shares.push((
            measure.name,
            [(values[1] - values[0]).abs() / measure.tolerance, (values[2] - values[1]).abs() / measure.tolerance],
            allowed / measure.tolerance,
        ));
    }
    for (of, names) in [
        (&verdicts.pulls, &["peak pull", "mean pull", "peak net pull", "mean net pull"][..]),
        (&verdicts.speed, &["peak speed", "mean speed"]),
        (&verdicts.energy, &["energy dissipated"]),
    ] {
        let of_these = || shares.iter().filter(|(name, ..)| names.contains(name));
        let largest = [0, 1].map(|which| peak(of_these().map(|(_, shares, _)| shares[which])));
        assert_right(&format!("{name}, {}", names[0]), of, largest, peak(of_these().map(|(.., margin)| *margin)));
    }

    // The path, eight times in a control period, but not between a release and the next tick.
    const FINER: f64 = 8.0;
    let is_compared =
        |at: usize| releases().map(|release| at as f64 / FINER - release / line.period).all(|ticks| !(0.01..=0.99).contains(&ticks));
    let [fine_with, fine_without] = [line.with_inertia(line.period / FINER), line.without_inertia(line.period / FINER)];
    let apart = fine_with.iter().zip(&fine_without).map(|(with, without)| (with.place - without.place).abs());
    let inertia = peak(apart.enumerate().filter(|(at, _)| is_compared(*at)).map(|(_, apart)| apart));
    let engine = peak(places.iter().zip(&with).map(|(place, with)| (place - with.place).abs()));
    let path = &verdicts.path;
    // Up to half a radian lies between two instants of a comparison, and as much here.
    let allowed = path.reference_error + 5e-3 * path.tolerance + 0.035 * inertia + 1e-12;
    assert!((path.inertia_effect - inertia).abs() <= allowed, "{name}: {inertia} {path:?}");
    if moves {
        // Engine errors between ticks may be larger.
        let engine = if engine > path.tolerance { engine } else { path.engine_error };
        assert_right(&format!("{name}, path"), path, [inertia, engine].map(|apart| apart / path.tolerance), allowed / path.tolerance);
    } else {
        assert_eq!([path.verdict, verdicts.heading.verdict, verdicts.speed.verdict], [Verdict::NothingMoved; 3], "{name}");
    }
    // Nothing turns the load but the engine.
    assert!(!verdicts.heading.verdict.has_inertia() && verdicts.heading.inertia_effect < 1e-12, "{name}: {:?}", verdicts.heading);
    assert_sentence(name, !line.tips.is_empty(), &found);
    Outcome { name, verdicts: verdicts.named().map(|(_, of)| of.verdict), n_numbers: measures.len() }
}

/// The sentence names every quantity on the side on which its verdict puts it, and pulls only of a
/// load with springs.
fn assert_sentence(name: &str, has_springs: bool, found: &Pathwise) {
    let sentence = sentence_of_paths(found);
    if found.verdict == Verdict::NothingMoved {
        assert!(sentence.starts_with("Nothing moved: no answer; the largest net pull is "), "{name}: {sentence}");
        return;
    }
    let (inertia, _) = sentence.split_once(" The engine error").unwrap_or_else(|| panic!("{name}: {sentence}"));
    let side = |what: &str| inertia.find(what).unwrap_or_else(|| panic!("{name}: no {what} in {sentence}"));
    let not = inertia.find("not ").unwrap_or(usize::MAX);
    assert_eq!(inertia.contains("pull"), has_springs, "{name}: {sentence}");
    let words = found.verdicts.named().into_iter().zip(["path", "heading", "pull", "contact", "speed", "energy"]);
    for ((_, of), word) in words.filter(|(_, word)| *word != "contact" && (has_springs || *word != "pull")) {
        let (at, again) = (side(word), inertia.find("it is valid").unwrap_or(usize::MAX));
        if of.verdict.has_inertia() {
            assert!(at > not && at < again, "{name}: {sentence}");
        } else if of.verdict == Verdict::Agree {
            assert!(at < not || at > again, "{name}: {sentence}");
        }
    }
}

/// Every number of the truth is met within the reference error, and every verdict is right.
#[test]
fn every_quantity_of_known_scenes_has_the_right_verdict() {
    let outcomes: Vec<Outcome> = scenes().par_iter().map(check).collect();
    assert!(outcomes.len() >= 32 && outcomes.iter().map(|outcome| outcome.n_numbers).sum::<usize>() > 200);
    for outcome in &outcomes {
        println!("{:<45} {:?}", outcome.name, outcome.verdicts);
    }
    let any = |is: &dyn Fn(&[Verdict; 6]) -> bool| outcomes.iter().any(|outcome| is(&outcome.verdicts));
    assert!(any(&|[path, _, pulls, ..]| *path == Verdict::Agree && pulls.has_inertia()), "the path agrees and pulls do not");
    assert!(any(&|verdicts| verdicts.iter().all(|of| matches!(of, Verdict::Agree))), "all agree");
    assert!(any(&|[path, _, pulls, ..]| path.has_inertia() && *pulls == Verdict::Agree), "the path does not agree and pulls do");
    assert!(any(&|[path, ..]| *path == Verdict::NothingMoved), "nothing moves");
}
