//! A robot pushes a disc to a goal. Does the pushing work without inertia, with it, and in rapier?

use cohaul::analysis::compare::{OwnMeasure, Settings, ThreeWay};
use cohaul::math::{Pose, Vec2};
use cohaul::model::ObstaclePose;
use cohaul::scenario::Scenario;
use cohaul::simulation::{Commands, Controller, Row, View};

const GOAL: Vec2 = Vec2::new(0.03, 0.01);
/// Distance of the centres of pusher and disc where they touch (m).
const REACH: f64 = 0.0172;

/// The pusher goes behind the disc as seen from the goal, and on from there, until the disc is
/// within 1 mm of the goal.
#[derive(Default)]
pub struct Push(Vec<ObstaclePose>);

impl Controller for Push {
    fn decide(&mut self, _view: &View, _commands: &mut Commands) {}

    fn targets(&mut self, _view: &View, _until: f64) -> &[Vec2] {
        &[]
    }

    fn pushers(&mut self, view: &View, _until: f64) -> &[ObstaclePose] {
        let (load, pusher) = (view.motion.pose.position, view.obstacle(0).expect("a pusher").position);
        let (left, period) = (GOAL - load, view.scenario.control_period);
        if left.norm() < 0.001 {
            return &[];
        }
        let behind = load - (REACH - 0.04 * period) / left.norm() * left;
        let step = behind - pusher;
        let share = (0.08 * period / step.norm()).min(1.0);
        self.0 = vec![ObstaclePose { obstacle: 0, pose: Pose { position: pusher + share * step, heading: 0.0 } }];
        &self.0
    }
}

pub fn main() -> Result<(), cohaul::scenario::ScenarioError> {
    let scenario = Scenario::read("scenarios/contact/pusher.json".as_ref())?;
    let settings = Settings::default();
    let make = |_: &Scenario| -> Box<dyn Controller> { Box::new(Push::default()) };
    let missed = |rows: &[Row]| rows.last().map_or(f64::NAN, |row| (GOAL - row.motion.pose.position).norm());
    let measure = OwnMeasure { name: "distance to the goal", unit: "m", of: &missed, tolerance: Some(0.001) };
    let runs = ThreeWay::new(&scenario, &settings).controller(&make).measure(&measure);
    let found = runs.controlled(|_share| true).expect("it is not stopped");
    for (name, of) in found.verdicts.shown() {
        println!("{name:8} {:.3e} {:.3e} {}: {}", of.inertia_effect, of.engine_error, of.unit, of.verdict.text());
    }
    Ok(())
}
