//! K10: two robots tow a box on damped springs, and a third one pushes it through a doorway. The
//! box stands while the robots start, and their springs pull with k v t + c v each: in both models,
//! so that inertia is no part of it.

use cohaul::analysis::compare::{Settings, ThreeWay, Verdict};
use cohaul::scenario::Scenario;

const DOORWAY: &str = include_str!("../common/three-robots-doorway.json");

fn doorway(damping_ratio: f64) -> Scenario {
    let mut scenario = Scenario::parse(DOORWAY, "doorway").unwrap();
    scenario.system.springs.iter_mut().for_each(|spring| spring.damping_ratio = damping_ratio);
    scenario
}

#[test]
fn quasi_static_is_valid_in_a_doorway_with_dashpots_and_without() {
    let (stiffness, speed, time) = (65.4, 0.1, 0.1);
    for damping_ratio in [0.0, 0.3] {
        let scenario = doorway(damping_ratio);
        let found = ThreeWay::new(&scenario, &Settings::default()).prescribed(|_| true).unwrap();
        let verdicts = &found.verdicts;
        for (name, of) in verdicts.named() {
            assert!(!of.verdict.has_inertia(), "{damping_ratio} {name}: {of:?}");
        }
        assert!(matches!(verdicts.pulls.verdict, Verdict::Agree | Verdict::Engine), "{:?}", verdicts.pulls);
        // k v t + c v of both springs.
        let dashpot = 2.0 * damping_ratio * (stiffness * scenario.system.load.mass).sqrt();
        let peak = 2.0 * (stiffness * speed * time + dashpot * speed);
        let measure = verdicts.pulls.measures.iter().find(|measure| measure.name == "peak net pull").unwrap();
        if damping_ratio > 0.0 {
            assert!((peak - 2.68).abs() < 5e-3, "{peak}");
            for pull in [measure.quasi_static, measure.inertial] {
                assert!((pull / peak - 1.0).abs() < 1e-6, "{pull} {peak}");
            }
        }
        // Without the dashpots in the quasi-static model they count as inertia, and are named
        // beside it otherwise.
        let damping = found.damping_effect;
        assert_eq!(damping.is_some(), damping_ratio > 0.0);
        if let Some(damping) = damping {
            assert!((damping.peak_net_pull_n / peak - 1.0).abs() < 1e-6 && damping.peak_net_pull_without_n < 0.8 * peak, "{damping:?}");
            let settings = Settings { rate_independent: true, ..Settings::default() };
            let found = ThreeWay::new(&scenario, &settings).prescribed(|_| true).unwrap();
            assert!(found.verdicts.pulls.verdict.has_inertia() && found.damping_effect.is_none(), "{:?}", found.verdicts.pulls);
        }
    }
}
