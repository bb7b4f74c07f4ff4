//! An independent solution for a load on springs along one line: what a comparison must find.
//!
//! The equation of motion m x'' = sum of k (p_j - x) + c (p_j' - x') - f sign(x') is integrated by
//! the classical Runge-Kutta method in steps of 1/500 rad. Without inertia the load moves just so
//! far that undamped springs pull with f at most, and on n damped ones their mean stretch w obeys n
//! k w + n c w' = f sign(x'). Neither shares code with the backends.

use cohaul::scenario::Scenario;
use serde_json::json;

/// A scene along x: all springs act at the centre of the load.
#[derive(Clone, Debug)]
pub struct Line {
    pub name: &'static str,
    pub mass: f64,
    pub friction: f64,
    pub stiffness: f64,
    pub damping_ratio: f64,
    /// Start speed of the load (m/s).
    pub start: f64,
    pub tips: Vec<Tip>,
    pub duration: f64,
    pub period: f64,
}

/// Corners of a tip's path: time (s) and place (m). It is attached from the first one on.
#[derive(Clone, Debug)]
pub struct Tip {
    pub corners: Vec<(f64, f64)>,
    pub release: Option<f64>,
}

/// State at a tick.
#[derive(Clone, Debug)]
pub struct Tick {
    pub place: f64,
    pub speed: f64,
    /// Pull of each spring; `None` once it is released.
    pub pulls: Vec<Option<f64>>,
    pub dissipated: f64,
}

pub const RADIUS: f64 = 0.1;
const GRAVITY: f64 = 9.81;

impl Tip {
    fn at(&self, time: f64) -> (f64, f64) {
        let leg = self.corners.windows(2).find(|leg| time < leg[1].0);
        leg.map_or((self.corners[self.corners.len() - 1].1, 0.0), |leg| {
            let speed = (leg[1].1 - leg[0].1) / (leg[1].0 - leg[0].0);
            (leg[0].1 + speed * (time - leg[0].0), speed)
        })
    }

    fn is_held(&self, time: f64) -> bool {
        self.release.is_none_or(|release| time < release - 1e-12)
    }
}

impl Line {
    pub fn scene(&self) -> Scenario {
        let spring = json!({
            "root_m": [0.0, 0.0], "bearing_rad": 0.0, "rest_length_m": 0.0, "radial_stiffness_n_per_m": self.stiffness,
            "torsional_stiffness_nm_per_rad": 0.0, "damping_ratio": self.damping_ratio
        });
        let path = |(spring, tip): (usize, &Tip)| {
            let waypoints: Vec<_> = tip.corners.iter().map(|(time, place)| [*time, *place, 0.0]).collect();
            match tip.release {
                Some(release) => json!({ "spring": spring, "waypoints": waypoints, "release_s": release }),
                None => json!({ "spring": spring, "waypoints": waypoints }),
            }
        };
        let file = json!({
            "name": self.name, "duration_s": self.duration, "control_period_s": self.period,
            "load": { "mass_kg": self.mass, "radius_m": RADIUS, "velocity_m_per_s": [self.start, 0.0] },
            "ground": { "friction_coefficient": self.friction / (self.mass * GRAVITY), "gravity_m_per_s2": GRAVITY,
                        "supports": { "tripod": { "radius_m": 0.6 * RADIUS } } },
            "springs": self.tips.iter().map(|_| &spring).collect::<Vec<_>>(),
            "drive": { "kind": "tips", "paths": self.tips.iter().enumerate().map(path).collect::<Vec<_>>() }
        });
        Scenario::parse(&file.to_string(), self.name).unwrap()
    }

    fn damping(&self) -> f64 {
        2.0 * self.damping_ratio * (self.stiffness * self.mass).sqrt()
    }

    /// Pull of each spring on its tip, with a load at a place and a speed.
    fn pulls(&self, time: f64, place: f64, speed: f64) -> Vec<Option<f64>> {
        let pull = |tip: &Tip| {
            let (at, velocity) = tip.at(time);
            tip.is_held(time).then(|| self.stiffness * (at - place) + self.damping() * (velocity - speed))
        };
        self.tips.iter().map(pull).collect()
    }

    /// Pulls as a backend reports them at a tick: dashpots have the force of the step before.
    fn pulls_at_tick(&self, time: f64, place: f64, speed: f64) -> Vec<Option<f64>> {
        let in_dashpot = |tip: &Tip| if time > 0.0 { self.damping() * (tip.at(time - 1e-9).1 - speed) } else { 0.0 };
        let pull = |tip: &Tip| tip.is_held(time).then(|| self.stiffness * (tip.at(time).0 - place) + in_dashpot(tip));
        self.tips.iter().map(pull).collect()
    }

    fn drive(&self, time: f64, place: f64, speed: f64) -> f64 {
        self.pulls(time, place, speed).into_iter().flatten().sum()
    }

    fn released_in(&self, from: f64, to: f64) -> impl Iterator<Item = &Tip> {
        self.tips.iter().filter(move |tip| tip.is_held(from) && !tip.is_held(to))
    }

    fn elastic(&self, tip: &Tip, time: f64, place: f64) -> f64 {
        0.5 * self.stiffness * (tip.at(time).0 - place).powi(2)
    }

    /// States with inertia every `every` seconds.
    pub fn with_inertia(&self, every: f64) -> Vec<Tick> {
        let rate = (self.tips.len().max(1) as f64 * self.stiffness / self.mass).sqrt();
        let n = (every * rate / 2e-3).ceil().max(20.0) as usize;
        let (step, n_all) = (every / n as f64, (self.duration / every).round() as usize);
        let (mut place, mut speed, mut dissipated, mut ticks) = (0.0f64, self.start, 0.0, Vec::new());
        for tick in 0..=n_all {
            let time = tick as f64 * every;
            ticks.push(Tick { place, speed, pulls: self.pulls_at_tick(time, place, speed), dissipated });
            for i in 0..n {
                let (mut now, next) = (time + i as f64 * step, time + (i + 1) as f64 * step);
                // A load that stops goes on from there.
                while next - now > 1e-9 * step {
                    let (before, at, length) = (speed, place, next - now);
                    let middle = now + 0.5 * length;
                    let share = self.advance(&mut place, &mut speed, [now, next]);
                    let in_dashpots = |tip: &Tip| self.damping() * (tip.at(middle).1 - 0.5 * (before + speed)).powi(2) * share * length;
                    let damped: f64 = self.tips.iter().filter(|tip| tip.is_held(middle)).map(in_dashpots).sum();
                    dissipated += self.friction * (place - at).abs() + damped;
                    now += share * length;
                }
                dissipated += self.released_in(next - step, next).map(|tip| self.elastic(tip, next, place)).sum::<f64>();
            }
        }
        ticks
    }

    /// Moves the load over a step, or up to where it stops; returns the share of the step (1).
    fn advance(&self, place: &mut f64, speed: &mut f64, [now, next]: [f64; 2]) -> f64 {
        let (step, middle) = (next - now, 0.5 * (now + next));
        let (x, u) = (*place, *speed);
        if u == 0.0 && self.drive(middle, x, 0.0).abs() <= self.friction {
            return 1.0;
        }
        let sign = if u != 0.0 { u.signum() } else { self.drive(middle, x, 0.0).signum() };
        let force = |x: f64, u: f64, t: f64| (self.drive(t, x, u) - sign * self.friction) / self.mass;
        // A corner or a release is at the end of a step.
        let late = next - 1e-3 * step;
        let u1 = force(x, u, now);
        let (x2, u2) = (u + 0.5 * step * u1, force(x + 0.5 * step * u, u + 0.5 * step * u1, middle));
        let (x3, u3) = (u + 0.5 * step * u2, force(x + 0.5 * step * x2, u + 0.5 * step * u2, middle));
        let (x4, u4) = (u + step * u3, force(x + step * x3, u + step * u3, late));
        let moved = (x + step / 6.0 * (u + 2.0 * x2 + 2.0 * x3 + x4), u + step / 6.0 * (u1 + 2.0 * u2 + 2.0 * u3 + u4));
        if moved.1 * sign > 0.0 {
            (*place, *speed) = moved;
            return 1.0;
        }
        let share = u / (u - moved.1);
        (*place, *speed) = (x + 0.5 * share * step * u, 0.0);
        if share > 0.0 { share } else { 1.0 }
    }

    /// Place and speed after a step of a load without inertia on these damped springs, and what is
    /// dissipated in it.
    fn relaxed(&self, held: &[&Tip], place: f64, [before, now]: [f64; 2]) -> (f64, f64, f64) {
        let (n, step, middle) = (held.len() as f64, now - before, 0.5 * (before + now));
        let mean = |of: &dyn Fn(&Tip) -> f64| if n > 0.0 { held.iter().map(|tip| of(tip)).sum::<f64>() / n } else { 0.0 };
        let velocity = mean(&|tip| tip.at(middle).1);
        let (stretch, balance) = (mean(&|tip| tip.at(before).0) - place, self.friction / (n * self.stiffness));
        let drive = n * (self.stiffness * stretch + self.damping() * velocity);
        let aside = |tip: &&Tip| self.damping() * (tip.at(middle).1 - velocity).powi(2) * step;
        let in_dashpots: f64 = held.iter().map(aside).sum();
        if drive.abs() <= self.friction || n == 0.0 {
            return (place, 0.0, in_dashpots + n * self.damping() * velocity * velocity * step);
        }
        let (away, time) = (stretch - drive.signum() * balance, self.damping() / self.stiffness);
        let left = away * (-step / time).exp();
        let moved = velocity * step + away - left;
        let rates = 0.5 * (away * away - left * left) / time;
        let speed = velocity + left / time;
        (place + moved, speed, in_dashpots + self.friction * moved.abs() + n * self.damping() * rates)
    }

    /// States without inertia every `every` seconds, jumps included in what is dissipated.
    pub fn without_inertia(&self, every: f64) -> Vec<Tick> {
        let (n, n_all) = (200, (self.duration / every).round() as usize);
        let (mut place, mut dissipated, mut ticks, mut last, mut speed) = (0.0, 0.0, Vec::new(), 0.0, 0.0);
        for tick in 0..=n_all {
            let time = tick as f64 * every;
            ticks.push(Tick { place, speed: (place - last) / every, pulls: self.pulls_at_tick(time, place, speed), dissipated });
            last = place;
            for i in 1..=n {
                let (before, now) = (time + (i - 1) as f64 * every / n as f64, time + i as f64 * every / n as f64);
                // A release acts from its instant on.
                let held: Vec<&Tip> = self.tips.iter().filter(|tip| tip.is_held(before)).collect();
                let (last_instant, at) = (before - every / n as f64, place);
                let released: Vec<&Tip> = self.released_in(last_instant, before).collect();
                if self.damping() > 0.0 {
                    let lost;
                    (place, speed, lost) = self.relaxed(&held, place, [before, now]);
                    dissipated += lost + released.iter().map(|tip| self.elastic(tip, before, at)).sum::<f64>();
                    continue;
                }
                let elastic = |place: f64| held.iter().map(|tip| self.elastic(tip, now, place)).sum::<f64>();
                let drive: f64 = held.iter().map(|tip| self.stiffness * (tip.at(now).0 - place)).sum();
                if drive.abs() > self.friction {
                    place += drive.signum() * (drive.abs() - self.friction) / (self.stiffness * held.len() as f64);
                }
                // All of what the springs lose in a jump is lost.
                let in_motion = if released.is_empty() { self.friction * (place - at).abs() } else { elastic(at) - elastic(place) };
                dissipated += in_motion + released.iter().map(|tip| self.elastic(tip, before, at)).sum::<f64>();
            }
        }
        ticks
    }
}
