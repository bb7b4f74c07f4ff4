//! Is quasi-static valid for a robot that slows down near its goal? A verdict on each quantity.

use cohaul::analysis::compare::{Settings, ThreeWay};
use cohaul::math::Vec2;
use cohaul::scenario::Scenario;
use cohaul::simulation::{Commands, Controller, Event, EventKind, View};

/// The tip moves along x, the slower the nearer the load is to 20 mm.
struct Approach(Vec2);

impl Controller for Approach {
    fn decide(&mut self, view: &View, commands: &mut Commands) {
        if view.time == 0.0 {
            commands.events.push(Event { time: 0.0, kind: EventKind::Grasp, spring: 0, ant: None, tip: self.0 });
        }
    }

    fn targets(&mut self, view: &View, until: f64) -> &[Vec2] {
        let left = 0.02 - view.motion.pose.position.x;
        self.0.x += (3.0 * left).clamp(-0.1, 0.1) * (until - view.time);
        std::slice::from_ref(&self.0)
    }
}

fn main() -> Result<(), cohaul::scenario::ScenarioError> {
    let scenario = Scenario::read("scenarios/analytic/ramp-and-hold.json".as_ref())?;
    let settings = Settings::default();
    let each_run = |_: &Scenario| -> Box<dyn Controller> { Box::new(Approach(Vec2::zeros())) };
    let found = ThreeWay::new(&scenario, &settings).controller(&each_run).controlled(|_share| true).expect("it is not stopped");
    println!("{}", found.verdict.text());
    for (name, of) in found.verdicts.named() {
        println!("{name:8} {:.3e} {}: {}", of.inertia_effect, of.unit, of.verdict.text());
    }
    Ok(())
}
