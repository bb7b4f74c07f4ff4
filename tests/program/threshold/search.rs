//! What a search says of what it cannot tell, and a search that was stopped.

use cohaul::analysis::compare::Settings;
use cohaul_studies::runner::Records;
use cohaul_studies::threshold::report::Thresholds;
use cohaul_studies::threshold::{Class, Effect, Point, search};

use crate::scenes::{boundaries, plan, searched, tow};

const HELD: &str = include_str!("../../../scenarios/analytic/ramp-and-hold.json");

/// The spring reaches 26.56 mN, which is the slip limit at mu = 1.692.
#[test]
fn a_load_that_no_pull_moves_is_a_range_of_its_own() {
    let scene = serde_json::from_str(HELD).unwrap();
    let found = searched(&scene, "ground.friction_coefficient=1:4");
    let (classes, values) = boundaries(&found, "path");
    assert_eq!(classes, [Class::NotValid, Class::NothingMoves], "{}", found.text());
    assert!((values[0] / 1.692 - 1.0).abs() < 0.01, "{values:?}");
    assert!(found.answer.contains("Nothing moves from ground.friction_coefficient = 1.7 on (path"), "{}", found.answer);
    assert!(!found.text().contains("NaN"), "{}", found.text());
}

/// Points of a search in which the path has these effects over the tolerance at 1, 2, 4, ...
fn points(shares: &[Option<f64>]) -> Vec<Point> {
    let of = |(at, share): (usize, &Option<f64>)| {
        let class = |share: f64| match share {
            0.0 => Class::NothingMoves,
            _ if share < 0.9 => Class::Valid,
            _ if share > 1.1 => Class::NotValid,
            _ => Class::Open,
        };
        let effect = share.map(|share| Effect { class: class(share), inertia_effect: share, reference_error: 0.1, tolerance: 1.0 });
        let failure = share.is_none().then(|| "the inertial run failed at 2 s: a step had no finite solution".to_owned());
        let doubt = share.filter(|share| *share == 1.0).map(|_| "from 3 s on the motion is not unique".to_owned());
        Point { value: f64::from(1 << at), effects: [effect, None, None, None, None, None], doubt, failure }
    };
    shares.iter().enumerate().map(of).collect()
}

/// Every answer has its range, with the reason why there is none.
#[test]
fn points_that_are_open_or_fail_are_said() {
    let plan = plan(&tow(0.0, 0.05, 0.2), "load.mass_kg=1:64");
    let answer = |shares: &[Option<f64>]| Thresholds::new(&plan, &Settings::default(), &points(shares), 1.0).answer;
    let said = answer(&[Some(0.0), Some(0.5), Some(1.0), Some(1.0), Some(2.0), None, None]);
    for part in [
        "Quasi-static is valid from load.mass_kg = 1.41 to 2.83 (path)",
        " The answer is open from load.mass_kg = 2.83 to 11.3 (path): from 3 s on the motion is not unique.",
        " Nothing moves up to load.mass_kg = 1.41 (path).",
        " There is no result from load.mass_kg = 22.6 on (path): the inertial run failed at 2 s: a step had no finite solution.",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(answer(&[Some(2.0), None]).starts_with("Quasi-static is valid at no certain load.mass_kg from 1 to 2 (path)."));
    assert!(answer(&[Some(2.0), Some(3.0)]).starts_with("Quasi-static is valid at no load.mass_kg from 1 to 2 (path)."));
    // A power law between 0.5 and 2.
    let said = answer(&[Some(0.5), Some(2.0)]);
    assert!(said.starts_with("Quasi-static is valid up to load.mass_kg = 1.41 (path)"), "{said}");
}

/// What the reference error alone hides about a limit is a part of its range.
#[test]
fn the_range_of_a_limit_has_what_the_reference_error_hides() {
    let plan = plan(&tow(0.0, 0.05, 0.2), "load.mass_kg=1:64");
    let mut points = points(&[Some(0.5), Some(1.05), Some(2.0)]);
    points[1].doubt = None;
    for (at, value) in [0.99, 1.0, 1.02].into_iter().enumerate() {
        points[at].value = value;
    }
    let found = Thresholds::new(&plan, &Settings::default(), &points, 1.0);
    let (classes, values) = boundaries(&found, "path");
    assert_eq!(classes, [Class::Valid, Class::NotValid], "{}", found.answer);
    assert!(0.99 < values[0] && values[0] < 1.02 && found.text().contains("0.9900 to 1.020"), "{}", found.text());
}

/// Rounds follow from the records alone.
#[test]
fn a_stopped_search_goes_on_to_the_same_points() {
    let room = tempfile::tempdir().unwrap();
    let (plan, settings) = (plan(&tow(0.3, 0.05, 0.1), "speed=0.5:4"), Settings::default());
    let whole = |records: &mut Records<Point>| search(&plan, &settings, records, &|_| true).unwrap();
    let mut expected = Records::in_memory();
    let n = whole(&mut expected);
    assert!(n > 14, "the grid has 13 points, and there is a limit: {n}");
    let open = || Records::<Point>::open(&room.path().join("out.journal"), "threshold", &plan.identity).unwrap();
    for most in [0.2, 0.4] {
        let mut stopped = open();
        search(&plan, &settings, &mut stopped, &|share| share < most).unwrap();
        assert!((1..n).contains(&stopped.n_done()), "{}", stopped.n_done());
    }
    let mut records = open();
    assert_eq!(whole(&mut records), n);
    assert_eq!(records.complete(n).ok().unwrap().0, expected.complete(n).ok().unwrap().0);
}
