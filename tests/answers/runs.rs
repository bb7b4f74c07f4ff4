//! Tests of whole runs: rows between ticks, tips that are read together, and followed ants.

use std::cell::RefCell;
use std::rc::Rc;

use cohaul::backend::{AttachedTip, BackendKind, BackendOptions, Motion};
use cohaul::math::Vec2;
use cohaul::model::ant::Ant;
use cohaul::scenario::Scenario;
use cohaul::simulation::{AttachedTips, Commands, Controller, Keep, Replay, Row, Simulation, View, controller_of, follow_ants};

/// Ants that compare the tips in their view with those that the backend returns one by one, and
/// store the latter after they have acted.
struct Comparing {
    ants: Box<dyn Controller>,
    read: Rc<RefCell<Vec<AttachedTips>>>,
}

fn read_one_by_one(view: &View) -> AttachedTips {
    let read = |spring| Some(AttachedTip { spring, position: view.backend.tip(spring)?, pull: view.backend.pull(spring) });
    (0..view.scenario.system.springs.len()).filter_map(read).collect()
}

impl Controller for Comparing {
    fn decide(&mut self, view: &View, commands: &mut Commands) {
        assert_eq!(view.tips, &read_one_by_one(view)[..], "at {} s", view.time);
        view.tips.iter().for_each(|tip| assert_eq!(view.pull(tip.spring), tip.pull));
        let free = (0..view.scenario.system.springs.len()).find(|spring| view.tips.iter().all(|tip| tip.spring != *spring));
        free.into_iter().for_each(|spring| assert_eq!(view.pull(spring), Vec2::zeros()));
        self.ants.decide(view, commands);
    }

    fn targets(&mut self, view: &View, until: f64) -> &[Vec2] {
        self.read.borrow_mut().push(read_one_by_one(view));
        self.ants.targets(view, until)
    }

    fn arrived(&self, motion: &Motion) -> Option<bool> {
        self.ants.arrived(motion)
    }
}

/// Parts of control periods add rows and leave all others as they are, with waypoints, a
/// release and the end between ticks and between parts. The same holds in a replay, whose tips
/// move straight from one recorded row to the next.
#[test]
fn parts_of_periods_add_rows_and_change_nothing() {
    let text = include_str!("../../scenarios/analytic/ramp-and-hold.json")
        .replace("[0.5, 0.04, 0.0]] }", "[0.51, 0.04, 0.0], [0.625, 0.03, 0.001]], \"release_s\": 0.77 }")
        .replace("\"duration_s\": 1.0", "\"duration_s\": 0.93")
        .replace("\"control_period_s\": 0.001", "\"control_period_s\": 0.1");
    let scenario = Scenario::parse(&text, "ramps").unwrap();
    // Steps that end with each part and with each instant between them.
    let options = BackendOptions::new(BackendKind::QuasiStatic, 1e-4);
    let run = |controller: Box<dyn Controller>, n_parts| {
        let mut run = Simulation::with_controller(&scenario, &options, Keep::Trace, controller).with_rows_per_period(n_parts);
        run.run(|_| true);
        run.into_results().0
    };
    let of_tips = |n_parts| run(controller_of(&scenario), n_parts);
    let plain = of_tips(1);
    let replay = |n_parts| run(Box::new(Replay::new(std::sync::Arc::new(of_tips(100)), 1)), n_parts);
    assert_eq!(plain.rows.len(), 11);
    for (trace, n_parts) in [(of_tips(4), 4), (of_tips(7), 7), (replay(100), 100), (replay(300), 300)] {
        assert_eq!(trace.rows.len() as u64, (9.3 * n_parts as f64 - 1e-9).ceil() as u64 + 1, "{n_parts} parts");
        assert!(trace.rows.windows(2).all(|pair| pair[1].time - pair[0].time > 1e-3 / 4.0));
        // Roundings of places of some 0.04 m.
        let is_same =
            |a: &Row, b: &Row| (a.time - b.time).abs() < 1e-12 && (a.motion.pose.position - b.motion.pose.position).norm() < 1e-15;
        assert!(plain.rows.iter().all(|row| trace.rows.iter().any(|other| is_same(row, other))), "{n_parts} parts: a row at every tick");
        assert!(of_tips(n_parts).rows.iter().zip(&trace.rows).all(|(row, other)| is_same(row, other)), "{n_parts} parts");
        assert_eq!(trace.events.len(), 2);
    }
}

/// Tips that are read together equal, to the bit, tips that are read one by one: while the load
/// waits, slips or has just been released, on more springs than are evaluated side by side. A
/// row after a grasp or a release has pulls from before for the other tips, which one by one
/// are evaluated again: roundings of positions of 0.1 m under some 0.7 N/m.
#[test]
fn tips_read_together_equal_tips_read_one_by_one() {
    let text = include_str!("../../scenarios/paper/four-ants-four-springs.json")
        .replace("\"n\": 4", "\"n\": 7")
        .replace("\"n_ants\": 4", "\"n_ants\": 7");
    let scenario = Scenario { duration: 8.0, ..Scenario::parse(&text, "seven ants").unwrap() };
    for (kind, step) in [(BackendKind::QuasiStatic, 2.5e-3), (BackendKind::Inertial, 2.5e-3), (BackendKind::Rapier, 1e-3)] {
        let options = BackendOptions::new(kind, step);
        let read = Rc::new(RefCell::new(Vec::new()));
        let controller = Comparing { ants: controller_of(&scenario), read: Rc::clone(&read) };
        let mut run = Simulation::with_controller(&scenario, &options, Keep::Trace, Box::new(controller));
        run.run(|_| true);
        let trace = run.trace();
        assert!(trace.events.len() > 20 && trace.rows.iter().any(|row| row.tips.len() > 4), "{kind:?}");
        for (row, read) in trace.rows.iter().zip(read.borrow().iter()) {
            assert_eq!(row.tips.len(), read.len());
            for (tip, read) in row.tips.iter().zip(read) {
                assert_eq!((tip.spring, tip.position), (read.spring, read.position));
                assert!((tip.pull - read.pull).norm() < 1e-16, "{kind:?} at {} s: {tip:?} {read:?}", row.time);
            }
        }
    }
}

/// The trace alone leads the ants to where they were, to the bit: an error at one tick would
/// remain at the end.
#[test]
fn followed_ants_go_where_they_went() {
    let text = include_str!("../../scenarios/paper/four-ants-four-springs.json");
    let scenario = Scenario { duration: 12.34, ..Scenario::parse(text, "four ants").unwrap() };
    let mut run = Simulation::new(&scenario, &BackendOptions::new(BackendKind::QuasiStatic, 2.5e-3), Keep::Trace);
    run.run(|_| true);
    let saved = serde_json::to_value(run.save().unwrap()).unwrap();
    let ants: Vec<Ant> = serde_json::from_value(saved["controller"]["ants"].clone()).unwrap();
    let mut last = Vec::new();
    follow_ants(&scenario, run.trace(), |_, ants| last = ants.to_vec());
    assert!(run.trace().events.len() > 20, "grasps and releases are part of it");
    for (ant, followed) in ants.iter().zip(&last) {
        assert_eq!((ant.position, ant.heading, ant.ahead), (followed.position, followed.heading, followed.ahead));
    }
    assert_eq!(last.len(), 4);
}
