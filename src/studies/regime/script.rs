//! Grasps and releases at given ticks, tips at given velocities. Where a tip is grasped follows the
//! load: paths with and without inertia have their own.

use crate::backend::Motion;
use crate::math::Vec2;
use crate::math::rotation;
use crate::simulation::{Commands, Controller, Event, EventKind, View};

/// Something to do to one spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cue {
    pub tick: u64,
    pub spring: usize,
    pub act: Act,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Act {
    /// Takes the tip of the undeformed spring, moved by `stretch` (m, world), and leaves with it at
    /// `velocity` (m/s, world).
    Grasp {
        stretch: Vec2,
        velocity: Vec2,
    },
    Release,
}

/// Follows cues, which stand in the order of their ticks, releases of a tick first.
pub struct Script {
    cues: Vec<Cue>,
    /// Number of the next cue.
    next: usize,
    /// Attached tips, an entry for each spring.
    held: Vec<Option<Held>>,
    targets: Vec<Vec2>,
}

/// A tip on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Held {
    /// (s)
    since: f64,
    /// (m, world)
    from: Vec2,
    /// (m/s, world)
    velocity: Vec2,
}

impl Held {
    /// From the grasp in one product, so that no rounding grows.
    fn position(&self, time: f64) -> Vec2 {
        self.from + (time - self.since) * self.velocity
    }
}

impl Script {
    pub fn new(cues: Vec<Cue>, n_springs: usize) -> Self {
        Self { cues, next: 0, held: vec![None; n_springs], targets: vec![Vec2::zeros(); n_springs] }
    }
}

impl Controller for Script {
    fn decide(&mut self, view: &View, commands: &mut Commands) {
        let Motion { pose, .. } = view.motion;
        while let Some(cue) = self.cues.get(self.next).filter(|cue| view.tick == Some(cue.tick)) {
            let (time, held) = (view.time, &mut self.held[cue.spring]);
            let (tip, kind) = match cue.act {
                Act::Release => (held.take().map_or(Vec2::zeros(), |held| held.position(time)), EventKind::Release),
                Act::Grasp { stretch, velocity } => {
                    let rest = rotation(pose.heading) * view.scenario.system.springs[cue.spring].rest_tip();
                    let from = pose.position + rest + stretch;
                    *held = Some(Held { since: time, from, velocity });
                    (from, EventKind::Grasp)
                }
            };
            commands.events.push(Event { time, spring: cue.spring, ant: None, tip, kind });
            self.next += 1;
        }
    }

    fn targets(&mut self, _: &View, until: f64) -> &[Vec2] {
        for (target, held) in self.targets.iter_mut().zip(&self.held) {
            *target = held.map_or(*target, |held| held.position(until));
        }
        &self.targets
    }
}
