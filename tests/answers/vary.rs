//! Maps of comparisons over parameters of a scene.

use cohaul::analysis::compare::{Settings, ThreeWay};
use cohaul::backend::{BackendKind, Integrator};
use cohaul_studies::runner::Records;
use cohaul_studies::sweep::{Ask, Design, Plan, Variant};
use cohaul_studies::vary::report::{Map, share};
use cohaul_studies::vary::{Cell, Question, tasks};

const SCENE: &str = include_str!("../../scenarios/analytic/ramp-and-hold.json");

/// Plan over these parameters of a load of 1.6 g that a spring tows for half a second.
fn plan(axes: &[&str]) -> Plan {
    let settings = Settings::default();
    let (integrator, backend) = (Integrator::default(), BackendKind::QuasiStatic);
    let variant = Variant { backend, step_s: None, tolerance_m: None, integrator, rapier: settings.rapier, skips: settings.skips };
    let design = Design::new(axes.iter().map(|axis| axis.parse().unwrap()).collect(), None).unwrap();
    Plan::new(Ask { file: "towed".into(), text: SCENE.into(), design, variants: vec![variant], first_seed: None, n_seeds: 1 }).unwrap()
}

fn question(everywhere: bool) -> Question {
    Question { settings: Settings { step_s: Some(1e-3), ..Settings::default() }, everywhere }
}

fn map(plan: &Plan, question: &Question) -> Map {
    Map::new(plan, question, tasks(plan, question).finished(&|_| true).unwrap(), 1.0)
}

/// The scale of the inertia at the same normal loads takes the inertia effect, which goes by the
/// square root of it, from far below the tolerance to far above.
const OVER_INERTIA: &str = "inertia_scale=log:1e-6:1:7";

#[test]
fn a_point_has_the_verdicts_of_a_comparison_of_its_scene() {
    let (plan, question) = (plan(&[OVER_INERTIA]), question(false));
    let map = map(&plan, &question);
    for cell in [&map.cells[0], &map.cells[6]] {
        let scenario = plan.scenario(&cell.values).unwrap();
        let found = ThreeWay::new(&scenario, &question.settings).prescribed(|_| true).unwrap();
        let compared = cell.compared.as_ref().expect("corners are compared");
        for ((_, expected), of) in found.verdicts.named().into_iter().zip(compared) {
            assert_eq!((of.verdict, of.inertia_effect, of.tolerance), (expected.verdict, expected.inertia_effect, expected.tolerance));
        }
    }
    let shares = [0, 6].map(|at| share(&map.cells[at], 0).unwrap());
    assert!(shares[0] < 1.0 && shares[1] > 1.0, "{shares:?} {}", map.text());
}

/// The estimate decides some points alone, and as the comparison does.
#[test]
fn what_the_estimate_decides_alone_is_what_the_comparison_finds() {
    let plan = plan(&[OVER_INERTIA]);
    let (screened, whole) = (map(&plan, &question(false)), map(&plan, &question(true)));
    assert!(screened.n_by_estimate >= 2 && screened.n_compared >= 2, "{}", screened.text());
    assert_eq!((whole.n_by_estimate, whole.n_compared, whole.n_failed), (0, 7, 0));
    for (cell, expected) in screened.cells.iter().zip(&whole.cells) {
        assert_eq!(cell.is_valid_for_path(), expected.is_valid_for_path(), "{:?}", cell.values);
    }
    // Neighbours have one range.
    assert!(screened.answer.contains("inertia_scale from") && !screened.text().contains("NaN"), "{}", screened.answer);
}

/// A load that no pull moves agrees on all backends, which says nothing on inertia.
#[test]
fn a_point_at_which_nothing_moved_is_not_called_valid() {
    let map = map(&plan(&["ground.friction_coefficient=1.4,1000"]), &question(false));
    let at_rest = &map.cells[1];
    assert!(at_rest.is_valid_for_path().is_none() && map.text().contains("at rest"), "{}", map.text());
    assert!(map.answer.contains(", no answer because nothing moved at 1. "), "{}", map.answer);
    assert!(at_rest.compared.as_ref().unwrap()[0].is_valid.is_none() && !map.answer.contains("open at"));
}

#[test]
fn a_stopped_map_goes_on_to_the_same_cells() {
    let room = tempfile::tempdir().unwrap();
    let (plan, question) = (plan(&["load.radius_m=0.0122,0.02", OVER_INERTIA]), question(false));
    let expected = map(&plan, &question).cells;
    let path = room.path().join("out.journal");
    let open = || Records::<Cell>::open(&path, "compare", &plan.identity).unwrap();
    let mut stopped = open();
    tasks(&plan, &question).run(&mut stopped, &|share| share < 0.3).unwrap();
    assert!((1..14).contains(&stopped.n_done()), "{}", stopped.n_done());
    drop(stopped);
    let mut records = open();
    tasks(&plan, &question).run(&mut records, &|_| true).unwrap();
    assert_eq!(records.complete(14).ok().unwrap().0, expected);
}
