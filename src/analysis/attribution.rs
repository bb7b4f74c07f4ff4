//! Attribution of an inertia effect to a trigger: one definition for measured and estimated paths.
//!
//! The distance between the loads with and without inertia belongs to the last disturbance that was
//! as large as the oscillation that it met, up to a tenth. That oscillation is left of earlier
//! disturbances: its amplitude is the square root of `d^2 + (u / w)^2`, with the distance d and the
//! difference of speeds u of the two loads, and w the frequency of the load on its springs. A load
//! without springs does not oscillate: u / w is then the way `u^2 / (2 a)` on which friction brakes
//! it by a. The size of a disturbance is the displacement that it brings about:
//!
//! | trigger | disturbance of the load without inertia | size |
//! |---|---|---|
//! | start | the load with inertia starts with speed | speed over w |
//! | grasp, release, jump | it jumps, or relaxes | its displacement beyond that at the speed before |
//! | slip onset | it starts from rest | change of speed over w |
//! | contact | its speed, or that of the load with inertia, changes where it touches an obstacle | change of speed over w |
//! | driving | its speed changes otherwise, with that of the tips | change of speed over w |
//!
//! On springs of damping ratio zeta the load without inertia relaxes over A in the time 2 zeta / w.
//! It leaves the load with inertia behind by A where that is the shorter time, and by A / (2 zeta)
//! where it is the longer one.

use serde::{Deserialize, Serialize};

use super::trigger::{Trigger, TriggerKind};

/// Trigger of the present distance between the loads with and without inertia.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Attribution {
    pub trigger: Trigger,
    /// Edge speed of the load without inertia in the last interval and in the one before (m/s);
    /// zero after a jump, which has no speed. A load that relaxes has one.
    speeds: [f64; 2],
    /// Edge speed of the load with inertia at the start of the last interval (m/s).
    speed_with_inertia: f64,
    /// Whether a change of speed in the last interval became the trigger. Where the change falls
    /// between the ends of an interval, the next one has the rest of it.
    has_changed: bool,
    /// Obstacle in the last interval: the speed behind an impact is seen in the next one.
    obstacle: Option<usize>,
    /// Amplitude of the oscillation at the start of the last interval (m).
    amplitude: f64,
}

/// Least size of a disturbance that becomes the trigger, over the amplitude that it meets (1). The
/// stop of a tip is as large as the undamped oscillation from its start, up to rounding.
const LEAST_SIZE: f64 = 0.9;

/// What happens to both loads in one interval.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disturbance {
    /// Start of the interval (s).
    pub time: f64,
    /// (s)
    pub duration: f64,
    /// Edge displacement of the load without inertia in the interval (m).
    pub displacement: f64,
    /// Grasp or release of a spring that pulls, or jump, in the interval.
    pub event: Option<Trigger>,
    /// Obstacle that one of the loads touches, hits or leaves in the interval.
    pub obstacle: Option<usize>,
    /// Edge displacement between the loads at the start of the interval (m).
    pub distance: f64,
    /// Edge speed of the load with inertia at the start of the interval (m/s).
    pub speed_with_inertia: f64,
    /// Frequency of the load on its springs (rad/s); zero without springs.
    pub rate: f64,
    /// Deceleration of a load that slides without springs (m/s^2).
    pub braking: f64,
    /// Damping ratio of that oscillation (1); zero where the load without inertia jumps.
    pub damping_ratio: f64,
}

impl Disturbance {
    /// How far this difference of edge speeds (m/s) takes the loads apart (m).
    fn swing(&self, speed: f64) -> f64 {
        match (self.rate > 0.0, self.braking > 0.0) {
            (true, _) => speed.abs() / self.rate,
            (false, true) => speed * speed / (2.0 * self.braking),
            (false, false) => 0.0,
        }
    }

    /// Size of an event after which the load without inertia has moved by `moved` (m) beyond its
    /// path at the speed before (m).
    fn size_of_event(&self, moved: f64) -> f64 {
        if self.damping_ratio == 0.0 || self.rate == 0.0 {
            return moved;
        }
        let slowness = 2.0 * self.damping_ratio;
        let whole = moved / -(-self.rate * self.duration / slowness).exp_m1();
        whole * slowness.recip().min(1.0)
    }
}

impl Attribution {
    pub fn new(starts_with_speed: bool) -> Self {
        let kind = if starts_with_speed { TriggerKind::Start } else { TriggerKind::Driving };
        let trigger = Trigger::new(kind, 0.0);
        Self { trigger, speeds: [0.0; 2], speed_with_inertia: 0.0, has_changed: false, obstacle: None, amplitude: 0.0 }
    }

    /// Whether the load without inertia rested in the last interval.
    pub fn rests(&self) -> bool {
        self.speeds[0] == 0.0
    }

    /// Adds an interval. Its disturbance becomes the trigger if it is large enough.
    pub fn meet(&mut self, now: &Disturbance) {
        let [last, before] = self.speeds;
        let amplitude = now.distance.hypot(now.swing(now.speed_with_inertia - last));
        let speed = now.displacement / now.duration;
        let jump = now.displacement - last * now.duration;
        let event = now.event.filter(|_| jump > 0.0 && now.size_of_event(jump) >= LEAST_SIZE * amplitude);
        let from = if (speed - before).abs() > (speed - last).abs() { before } else { last };
        let change = now.swing(speed - from);
        let of_obstacle = change.max(now.swing(now.speed_with_inertia - self.speed_with_inertia));
        let obstacle = now.obstacle.or(self.obstacle);
        let has_changed = speed != from && change >= LEAST_SIZE * amplitude && !self.has_changed;
        if let Some(event) = event {
            self.trigger = event;
        } else if obstacle.is_some() && of_obstacle > 0.0 && of_obstacle >= LEAST_SIZE * amplitude.min(self.amplitude) {
            self.trigger = Trigger { obstacle, ..Trigger::new(TriggerKind::Contact, now.time) };
        } else if has_changed {
            let kind = if from == 0.0 { TriggerKind::SlipOnset } else { TriggerKind::Driving };
            self.trigger = Trigger::new(kind, now.time);
        }
        self.speeds = match event {
            Some(_) if now.damping_ratio == 0.0 => [0.0; 2],
            Some(_) => [speed; 2],
            // The change of the last interval is complete.
            None if self.has_changed => [speed; 2],
            None => [speed, last],
        };
        self.has_changed = has_changed && event.is_none();
        (self.speed_with_inertia, self.obstacle, self.amplitude) = (now.speed_with_inertia, now.obstacle, amplitude);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STILL: Disturbance = Disturbance {
        time: 0.0,
        duration: 0.1,
        displacement: 0.0,
        event: None,
        obstacle: None,
        distance: 0.0,
        speed_with_inertia: 0.0,
        rate: 10.0,
        braking: 5.0,
        damping_ratio: 0.0,
    };

    /// Speeds of 0.1 m/s swing by 10 mm at 10 rad/s.
    #[test]
    fn a_disturbance_counts_from_the_amplitude_that_it_meets() {
        let kind = |attribution: &Attribution| attribution.trigger.kind;
        let mut load = Attribution::new(false);
        load.meet(&STILL);
        assert_eq!(kind(&load), TriggerKind::Driving);
        // It sets out within an interval, and keeps the trigger at its full speed.
        load.meet(&Disturbance { time: 0.1, displacement: 0.002, ..STILL });
        load.meet(&Disturbance { time: 0.2, displacement: 0.01, speed_with_inertia: 0.01, ..STILL });
        assert_eq!((kind(&load), load.trigger.time_s), (TriggerKind::SlipOnset, 0.1));
        load.meet(&Disturbance { time: 0.3, displacement: 0.01, distance: 0.01, speed_with_inertia: 0.1, ..STILL });
        // Its tips stop, which swings it by 10 mm, while it oscillates by 12 mm or by 10 mm.
        for (distance, expected) in [(0.012, TriggerKind::SlipOnset), (0.01, TriggerKind::Driving)] {
            let mut load = load;
            load.meet(&Disturbance { time: 0.3, distance, speed_with_inertia: 0.1, ..STILL });
            assert_eq!(kind(&load), expected, "{distance}");
        }
        // A release lets it jump by 20 mm beyond the 10 mm at its speed, or by nothing.
        for (displacement, expected) in [(0.03, TriggerKind::Release), (0.01, TriggerKind::SlipOnset)] {
            let mut load = load;
            let event = Some(Trigger { spring: Some(1), ..Trigger::new(TriggerKind::Release, 0.3) });
            load.meet(&Disturbance { time: 0.3, displacement, event, distance: 0.005, speed_with_inertia: 0.1, ..STILL });
            assert_eq!(kind(&load), expected, "{displacement}");
        }
        // It relaxes by 60 mm in 0.6 s: 10 mm beyond the load with inertia, of which a sixth of the
        // time shows less.
        let moved = -0.06 * (-0.1f64 / 0.6).exp_m1();
        for (distance, expected) in [(0.01, TriggerKind::Release), (0.012, TriggerKind::SlipOnset)] {
            let mut load = load;
            let event = Some(Trigger { spring: Some(1), ..Trigger::new(TriggerKind::Release, 0.3) });
            let relaxing = Disturbance { displacement: 0.01 + moved, event, damping_ratio: 3.0, ..STILL };
            load.meet(&Disturbance { time: 0.3, distance, speed_with_inertia: 0.1, ..relaxing });
            assert_eq!(kind(&load), expected, "{distance}");
        }
        // Without springs, a stop from 0.1 m/s takes the loads apart by 1 mm.
        for (distance, expected) in [(1.2e-3, TriggerKind::SlipOnset), (1e-3, TriggerKind::Driving)] {
            let mut load = load;
            load.meet(&Disturbance { time: 0.3, distance, speed_with_inertia: 0.1, rate: 0.0, ..STILL });
            assert_eq!(kind(&load), expected, "{distance}");
        }
        // The load with inertia hits an obstacle.
        load.meet(&Disturbance { time: 0.3, obstacle: Some(2), displacement: 0.01, speed_with_inertia: 0.05, ..STILL });
        assert_eq!((kind(&load), load.trigger.obstacle), (TriggerKind::Contact, Some(2)));
    }
}
