//! A controller that grasps and releases at given ticks and moves tips at given velocities. A tip
//! is grasped where the load is at that time, which differs between the paths with and without
//! inertia.

use cohaul::backend::Motion;
use cohaul::math::Vec2;
use cohaul::math::rotation;
use cohaul::simulation::{Commands, Controller, Event, EventKind, View};

/// A grasp or a release of one spring at a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cue {
    pub tick: u64,
    pub spring: usize,
    pub act: Act,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Act {
    /// Takes the tip of the undeformed spring, displaced by `stretch` (m, world), and moves it at
    /// `velocity` (m/s, world).
    Grasp {
        stretch: Vec2,
        velocity: Vec2,
    },
    Release,
}

/// Controller that follows cues. They are in the order of their ticks, releases of a tick first.
pub struct Script {
    cues: Vec<Cue>,
    next: usize,
    /// Attached tips, an entry for each spring.
    attached: Vec<Option<Attached>>,
    targets: Vec<Vec2>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Attached {
    /// Time of the grasp (s).
    since: f64,
    /// Position of the tip at the grasp (m, world).
    from: Vec2,
    /// Velocity of the tip (m/s, world).
    velocity: Vec2,
}

impl Attached {
    /// Position of the tip (m, world), by one product from the grasp, so that rounding does not
    /// accumulate.
    fn position(&self, time: f64) -> Vec2 {
        self.from + (time - self.since) * self.velocity
    }
}

impl Script {
    pub fn new(cues: Vec<Cue>, n_springs: usize) -> Self {
        Self { cues, next: 0, attached: vec![None; n_springs], targets: vec![Vec2::zeros(); n_springs] }
    }
}

impl Controller for Script {
    fn decide(&mut self, view: &View, commands: &mut Commands) {
        let Motion { pose, .. } = view.motion;
        while let Some(cue) = self.cues.get(self.next).filter(|cue| view.tick == Some(cue.tick)) {
            let (time, attached) = (view.time, &mut self.attached[cue.spring]);
            let (tip, kind) = match cue.act {
                Act::Release => (attached.take().map_or(Vec2::zeros(), |attached| attached.position(time)), EventKind::Release),
                Act::Grasp { stretch, velocity } => {
                    let rest = rotation(pose.heading) * view.scenario.system.springs[cue.spring].rest_tip();
                    let from = pose.position + rest + stretch;
                    *attached = Some(Attached { since: time, from, velocity });
                    (from, EventKind::Grasp)
                }
            };
            commands.events.push(Event { time, spring: cue.spring, ant: None, tip, kind });
            self.next += 1;
        }
    }

    fn targets(&mut self, _: &View, until: f64) -> &[Vec2] {
        for (target, attached) in self.targets.iter_mut().zip(&self.attached) {
            *target = attached.map_or(*target, |attached| attached.position(until));
        }
        &self.targets
    }
}
