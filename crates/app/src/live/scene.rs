//! Scenario and settings as a reader changes them.

use super::hand::{self, Handle, Pull, Reach, Span};
use super::message::{Saved, SceneNow};
use super::parameters::{parameters, set};
use super::settings::Settings;
use cohaul::analysis::compare::Numbers;
use cohaul::backend::{BackendKind, default_step};
use cohaul::formats::LIVE;
use cohaul::math::Vec2;
use cohaul::scenario::shipped::{names, shipped};
use cohaul::scenario::{AntDrive, Drive, Scenario, TipPath, Waypoint};
use cohaul::simulation::{EventKind, Keep, Simulation, Trace};
use cohaul_report::page::Replay;

#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    Set {
        what: String,
        value: f64,
    },
    Settings(Settings),
    /// `rest_tip` is the tip of the spring while it is free (m, world).
    Drag {
        handle: Handle,
        pull: Pull,
        span: Span,
        rest_tip: Vec2,
    },
    Release {
        spring: usize,
    },
    Ants {
        on: bool,
    },
    Shipped {
        name: String,
    },
    Open(Box<Saved>),
}

#[derive(Clone, Debug, PartialEq)]
pub struct LiveScene {
    pub scenario: Scenario,
    pub settings: Settings,
    base: Scenario,
    /// Speed of the drive over that of the base (1).
    speed: f64,
}

impl LiveScene {
    pub fn new(scenario: Scenario) -> Self {
        Self { base: scenario.clone(), scenario, settings: Settings::default(), speed: 1.0 }
    }

    /// Makes a change at the time `now` (s).
    ///
    /// # Errors
    /// With the reason, when the change cannot be made. The scene is then as it was.
    pub fn apply(&mut self, edit: &Edit, now: f64) -> Result<Reach, String> {
        let mut changed = self.clone();
        let reach = match edit {
            Edit::Set { what, value } => {
                set(&mut changed.scenario, &changed.base, &mut changed.speed, what, *value)?;
                Reach::Whole
            }
            Edit::Settings(settings) => {
                settings.check(&self.scenario)?;
                changed.settings = settings.clone();
                Reach::Whole
            }
            Edit::Drag { handle, pull, span, rest_tip } => {
                let reach = hand::drag(&mut changed.scenario, *handle, *pull, *span, *rest_tip)?;
                // A scene may end between two ticks, and steps end there.
                if span.from < now - 1e-6 * self.scenario.control_period { Reach::Whole } else { reach }
            }
            Edit::Release { spring } => hand::release(&mut changed.scenario, *spring, now)?,
            Edit::Ants { on } => {
                changed.switch_ants(*on, now)?;
                Reach::Whole
            }
            Edit::Shipped { name } => {
                let text = shipped(name).ok_or_else(|| format!("no scene {name:?}"))?;
                changed = Self { settings: changed.settings, ..Self::new(read(text, name)?) };
                Reach::Whole
            }
            Edit::Open(saved) => {
                changed = Self::open(saved)?;
                Reach::Whole
            }
        };
        // What a drag writes is valid by itself, and comes many times a second.
        if reach == Reach::Whole {
            changed.scenario = changed.scenario.expanded().checked("scene").map_err(|error| error.to_string())?;
        }
        *self = changed;
        Ok(reach)
    }

    /// The scene as it was saved.
    fn open(saved: &Saved) -> Result<Self, String> {
        saved.format.as_ref().map_or(Ok(()), |found| LIVE.check_found(found))?;
        if !(saved.speed.is_finite() && saved.speed > 0.0) {
            return Err(format!("saved.speed: must be finite and above 0, found {}", saved.speed));
        }
        let scenario = read(&saved.scenario.to_string(), "scenario")?;
        let base = saved.base.as_ref().map_or(Ok(scenario.clone()), |base| read(&base.to_string(), "base"))?;
        saved.settings.check(&scenario)?;
        Ok(Self { scenario, settings: saved.settings.clone(), base, speed: saved.speed })
    }

    /// Ants that are switched off let go at once. Their tips become prescribed ones up to now,
    /// those of the quasi-static backend, and can be dragged from then on. Switched on, those of
    /// the scene as it was opened are there from the start, at the present speed of the drive.
    fn switch_ants(&mut self, on: bool, now: f64) -> Result<(), String> {
        let has_ants = matches!(self.scenario.drive, Drive::Ants(_));
        if on == has_ants {
            return Ok(());
        }
        self.scenario.drive = match (on, &self.base.drive) {
            (true, Drive::Ants(ants)) => Drive::Ants(AntDrive { pull_speed: self.speed * ants.pull_speed, ..ants.clone() }),
            (true, Drive::Tips(_)) => return Err("ants: this scene has none".to_owned()),
            (false, _) => Drive::Tips(self.tips_until(now)),
        };
        Ok(())
    }

    fn tips_until(&self, now: f64) -> Vec<TipPath> {
        if now <= 0.0 {
            return Vec::new();
        }
        let scenario = Scenario { duration: now, ..self.scenario.clone() };
        let mut run = Simulation::new(&scenario, &self.settings.options(BackendKind::QuasiStatic, &scenario), Keep::Trace);
        run.run(|_| true);
        recorded(run.trace(), now)
    }

    pub fn saved(&self, time_s: f64) -> Saved {
        let plain = |scenario: &Scenario| serde_json::to_value(scenario.expanded()).expect("the format is plain data");
        let base = (self.base != self.scenario).then(|| plain(&self.base));
        Saved {
            format: Some(LIVE.found()),
            scenario: plain(&self.scenario),
            settings: self.settings.clone(),
            time_s,
            base,
            speed: self.speed,
        }
    }

    /// Numbers of the obstacles that can be dragged.
    pub fn pushers(&self) -> Vec<usize> {
        let obstacles = self.scenario.system.world.obstacles.iter().enumerate();
        obstacles.filter(|(_, obstacle)| obstacle.path.moves()).map(|(number, _)| number).collect()
    }

    pub fn replay(&self) -> Replay {
        let labels: Vec<&str> = self.settings.backends.iter().map(|kind| kind.name()).collect();
        Replay::at_start(&self.scenario, &labels)
    }

    pub fn now(&self) -> SceneNow {
        let scenario = &self.scenario;
        let step = |kind: BackendKind| default_step(kind, &scenario.system, scenario.control_period);
        SceneNow {
            format: LIVE,
            name: scenario.name.clone(),
            replay: self.replay(),
            duration_s: scenario.duration,
            control_period_s: scenario.control_period,
            parameters: parameters(scenario, &self.base, self.speed),
            numbers: Numbers::before_run(scenario),
            settings: self.settings.clone(),
            all_backends: BackendKind::ALL.map(BackendKind::name).to_vec(),
            steps_s: BackendKind::ALL.map(|kind| self.settings.steps_s[kind as usize].unwrap_or_else(|| step(kind))).to_vec(),
            pushers: self.pushers(),
            has_ants: [scenario, &self.base].iter().any(|of| matches!(of.drive, Drive::Ants(_))),
            ants_on: matches!(scenario.drive, Drive::Ants(_)),
            shipped: names().collect(),
        }
    }
}

fn read(text: &str, name: &str) -> Result<Scenario, String> {
    Scenario::parse(text, name).map_err(|error| error.to_string())
}

/// The tips of a run as prescribed paths. All that are still held are let go at `now` (s).
fn recorded(trace: &Trace, now: f64) -> Vec<TipPath> {
    let mut rows: Vec<_> = trace.rows.iter().chain(&trace.between).collect();
    rows.sort_by(|a, b| a.time.total_cmp(&b.time));
    let grasps = trace.events.iter().enumerate().filter(|(_, event)| event.kind == EventKind::Grasp);
    let path = |(at, grasp): (usize, &cohaul::simulation::Event)| {
        let released = trace.events[at..].iter().find(|event| event.spring == grasp.spring && event.kind == EventKind::Release);
        let end = released.map_or(now, |event| event.time);
        let first = Waypoint { time: grasp.time, position: grasp.tip };
        // A tip that is still held is let go where it is in the last row.
        let is_between = |time: f64| time > grasp.time && (time < end || released.is_none() && time <= end);
        let between = rows.iter().filter(|row| is_between(row.time)).filter_map(|row| {
            let tip = row.tips.iter().find(|tip| tip.spring == grasp.spring)?;
            Some(Waypoint { time: row.time, position: tip.position })
        });
        let last = released.map(|event| Waypoint { time: end, position: event.tip });
        TipPath { spring: grasp.spring, waypoints: [first].into_iter().chain(between).chain(last).collect(), release: Some(end) }
    };
    grasps.filter(|(_, grasp)| grasp.time < now).map(path).collect()
}
