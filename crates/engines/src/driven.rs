//! The backend that asks an engine.

use std::f64::consts::PI;
use std::sync::Arc;

use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use cohaul::analysis::compare::EngineName;
use cohaul::backend::{Backend, BackendOptions, Computes, EnergyLedger, Motion, SideContact, Status, StepReport, n_steps_in};
use cohaul::math::{Pose, Twist, Vec2};
use cohaul::model::System;
use cohaul::scenario::Scenario;

use crate::channel::{Channel, Complaint, shortened};
use crate::protocol::{Advanced, Request, Started, of_pose};
use crate::springs::Springs;

/// Why a run does not start.
#[derive(Debug, thiserror::Error)]
pub enum NoStart {
    /// The engine, which need not have said its name, does not take the scene.
    #[error("start: {1}")]
    Refused(EngineName, String),
    #[error("{0}")]
    Wrong(String),
}

impl From<String> for NoStart {
    fn from(what: String) -> Self {
        Self::Wrong(what)
    }
}

/// A load that an engine moves.
pub struct Driven {
    channel: Box<dyn Channel>,
    complaint: Arc<Complaint>,
    springs: Arc<Springs>,
    system: System,
    name: String,
    longest_step: f64,
    motion: Motion,
    /// Sum of all advances (s).
    elapsed: f64,
    computes: Computes,
    pulls: Option<Vec<Option<Vec2>>>,
    contacts: Vec<SideContact>,
    energy: EnergyLedger,
}

impl Driven {
    /// A new run of an engine behind a channel, and what it says of itself. Its faults become the
    /// `complaint`, and end the run as failed.
    ///
    /// # Errors
    /// When the engine does not start.
    pub fn start(
        mut channel: Box<dyn Channel>,
        scenario: &Scenario,
        options: &BackendOptions,
        complaint: &Arc<Complaint>,
    ) -> Result<(Self, EngineName), NoStart> {
        let Scenario { system, start, .. } = scenario;
        let springs = Arc::new(Springs::new(system));
        let request = Request::start(system, start, options);
        let started: Started = read(channel.exchange(&line(&request), &springs), "start")?;
        if started.refused.is_none() || !started.name.is_empty() {
            check_words("name", &started.name)?;
            started.version.iter().try_for_each(|version| check_words("version", version))?;
        }
        if let Some(why) = started.refused {
            let name = if started.name.is_empty() { "engine".into() } else { started.name.into() };
            return Err(NoStart::Refused(EngineName { name, version: started.version }, shortened(why.trim())));
        }
        let name = EngineName { name: started.name.clone().into(), version: started.version };
        let energy = EnergyLedger { initial: system.load.kinetic_energy(&start.twist), ..EnergyLedger::default() };
        let driven = Self {
            channel,
            complaint: Arc::clone(complaint),
            springs,
            system: system.clone(),
            name: started.name,
            longest_step: options.step_s,
            motion: *start,
            elapsed: 0.0,
            computes: Computes::ALL,
            pulls: None,
            contacts: Vec::new(),
            energy,
        };
        Ok((driven, name))
    }

    /// Sends a request and reads its answer.
    fn ask<T: DeserializeOwned>(&mut self, request: &Request, call: &str) -> Result<T, String> {
        read(self.channel.exchange(&line(request), &self.springs), call)
    }

    /// Attaches or releases a spring: what its tip was pulled with is over.
    fn change(&mut self, spring: usize, request: &Request, call: &str) {
        self.pulls.iter_mut().for_each(|pulls| pulls[spring] = None);
        let answer = self.ask::<Map<String, Value>>(request, call);
        let is_empty = |answer: Map<String, Value>| match answer.keys().next() {
            None => Ok(()),
            Some(key) => Err(format!("{call}: must be answered by an empty object, found {}", shortened(key))),
        };
        self.told(answer.and_then(is_empty));
    }

    /// Keeps what was wrong in an answer, if anything was.
    fn told<T>(&self, answer: Result<T, String>) -> Option<T> {
        answer.map_err(|what| self.complaint.make(format!("{}, at {} s: {what}", self.name, self.elapsed))).ok()
    }

    fn advanced(&mut self, targets: &[Vec2], duration: f64) -> Result<bool, String> {
        self.springs.set_out(targets, duration);
        let at_end = |obstacle: &cohaul::model::Obstacle| of_pose(&obstacle.path.pose_at(self.elapsed + duration));
        let request = Request::Advance {
            tips_m: self.springs.targets(),
            obstacles: self.system.world.obstacles.iter().map(at_end).collect(),
            duration_s: duration,
            n_steps: n_steps_in(duration, self.longest_step),
        };
        let found: Advanced = self.ask(&request, "advance")?;
        self.check(&found, duration)?;
        let [x, y, heading] = found.pose;
        let (before, pose) = (self.motion.pose, Pose::new(x, y, heading));
        let twist = found.twist.map(|[u, v, w]| Twist { linear: Vec2::new(u, v), angular: w });
        // The last displacement over its time, as for a load without inertia.
        let mean = Twist { linear: (pose.position - before.position) / duration, angular: (pose.heading - before.heading) / duration };
        let vector = |[x, y]: [f64; 2]| Vec2::new(x, y);
        self.motion = Motion { pose, twist: twist.unwrap_or(mean) };
        self.elapsed += duration;
        self.springs.arrive(&pose);
        let Computes { twist: twists, energy, contacts } = self.computes;
        self.computes = Computes {
            twist: twists && twist.is_some(),
            energy: energy && found.dissipated_j.is_some(),
            contacts: contacts && found.contacts.is_some(),
        };
        self.pulls = found.pulls_n.map(|pulls| pulls.into_iter().map(|pull| pull.map(vector)).collect());
        let contact =
            |it: crate::protocol::Contact| SideContact { obstacle: it.obstacle, point: vector(it.point_m), force: vector(it.force_n) };
        self.contacts = found.contacts.unwrap_or_default().into_iter().map(contact).collect();
        self.record(found.dissipated_j);
        Ok(found.converged)
    }

    /// # Errors
    /// What an answer has that no state of a load has after a `duration` (s), in words.
    fn check(&self, found: &Advanced, duration: f64) -> Result<(), String> {
        let pulls = found.pulls_n.iter().flatten().flatten().flatten();
        let contacts = found.contacts.iter().flatten();
        let of_contacts = contacts.clone().flat_map(|contact| contact.point_m.iter().chain(&contact.force_n));
        let numbers = found.pose.iter().chain(found.twist.iter().flatten()).chain(pulls).chain(of_contacts).chain(&found.dissipated_j);
        if let Some(number) = numbers.copied().find(|number| number.abs() > FARTHEST) {
            return Err(format!("advance: must answer numbers up to {FARTHEST:e}, found {number:e}"));
        }
        let ([.., heading], rate) = (found.pose, self.motion.twist.angular);
        let turn = heading - self.motion.pose.heading;
        let beyond = turn - 0.5 * duration * (rate + found.twist.map_or(rate, |[.., rate]| rate));
        if (beyond.abs() - 2.0 * PI).abs() < SEAM {
            return Err(format!("pose: must have a heading that is not wrapped, found a turn by {turn:.3} rad in one advance"));
        }
        let n_springs = self.system.springs.len();
        if let Some(pulls) = found.pulls_n.as_ref().filter(|pulls| pulls.len() != n_springs) {
            return Err(format!("pulls_n: must have one entry a spring, {n_springs}, found {}", pulls.len()));
        }
        let n_obstacles = self.system.world.obstacles.len();
        match contacts.map(|contact| contact.obstacle).find(|obstacle| *obstacle >= n_obstacles) {
            Some(_) if n_obstacles == 0 => Err("contacts: must be none without obstacles, found one".to_owned()),
            Some(obstacle) => Err(format!("contacts: must name one of {n_obstacles} obstacles by its place from 0, found {obstacle}")),
            None => Ok(()),
        }
    }

    /// Records the energy that is dissipated (J). The engine states no work, which is what closes
    /// the ledger: nothing is claimed of its balance.
    fn record(&mut self, dissipated: Option<f64>) {
        let Some(friction) = dissipated else { return };
        let (elastic, kinetic) = (self.springs.energy(&self.motion.pose), self.system.load.kinetic_energy(&self.motion.twist));
        let tip_work = elastic + kinetic + friction + self.energy.released - self.energy.initial;
        self.energy = EnergyLedger { elastic, kinetic, friction, tip_work, ..self.energy };
    }
}

/// Longest name or version of an engine (bytes).
const LONGEST_NAME: usize = 40;
/// Largest number that a state may have, in any unit: far beyond, squares have no finite number.
const FARTHEST: f64 = 1e60;
/// How near to a whole turn a heading that changes by more than the turn rates before and after an
/// advance say is taken for a wrapped one (rad). Rates that change by less within it say more.
const SEAM: f64 = 0.5;

/// Errs with a name or version that tables cannot show, or that names another run.
fn check_words(key: &str, words: &str) -> Result<(), String> {
    match words.len() {
        n if words.trim().is_empty() || n > LONGEST_NAME => Err(format!("{key}: must have 1 to {LONGEST_NAME} bytes, found {n}")),
        _ if words.chars().any(char::is_control) => Err(format!("{key}: must have no control characters, found {words:?}")),
        _ if matches!(words, "quasi-static" | "inertial" | "rapier") => {
            Err(format!("{key}: must differ from the other runs, found {words}"))
        }
        _ => Ok(()),
    }
}

fn line(request: &Request) -> String {
    serde_json::to_string(request).expect("requests are plain data")
}

/// The answer to a `call`, or what is wrong with it.
fn read<T: DeserializeOwned>(answer: Result<String, String>, call: &str) -> Result<T, String> {
    let wrong = |error: serde_json::Error, answer: &str| format!("{}, found {}", shortened(&error.to_string()), shortened(answer.trim()));
    let parsed = |answer: String| serde_json::from_str(&answer).map_err(|error| wrong(error, &answer));
    answer.and_then(parsed).map_err(|what| format!("{call}: {what}"))
}

impl Backend for Driven {
    fn attach(&mut self, spring: usize, tip: Vec2) {
        self.springs.attach(spring, tip, &self.motion.pose);
        self.change(spring, &Request::Attach { spring, tip_m: [tip.x, tip.y] }, "attach");
    }

    fn release(&mut self, spring: usize) {
        let pose = self.motion.pose;
        let before = self.springs.energy(&pose);
        self.springs.release(spring);
        let left = self.springs.energy(&pose);
        // The engine cannot know what a spring keeps that it no longer has.
        self.energy.release(before - left, left);
        self.change(spring, &Request::Release { spring }, "release");
    }

    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport {
        let n_steps = n_steps_in(duration, self.longest_step);
        // A run that waits for others is of no use once something was wrong.
        let answer = if self.complaint.is_made() { Ok(None) } else { self.advanced(tip_targets, duration).map(Some) };
        let answer = self.told(answer).flatten();
        let status = match answer {
            None => Status::Failed,
            Some(false) => Status::NotConverged,
            Some(true) => Status::Converged,
        };
        let is_unsolved = status == Status::NotConverged;
        // How far it is from a solution, the engine does not say: as far as can be.
        let (n_not_converged, residual) = if is_unsolved { (n_steps, 1.0) } else { (0, 0.0) };
        StepReport { status, n_steps, n_not_converged, residual, ..StepReport::default() }
    }

    fn motion(&self) -> Motion {
        self.motion
    }

    fn tip(&self, spring: usize) -> Option<Vec2> {
        self.springs.tip(spring)
    }

    fn pull(&self, spring: usize) -> Vec2 {
        let stated = self.pulls.as_ref().and_then(|pulls| pulls[spring]);
        stated.unwrap_or_else(|| self.springs.pull(spring, &self.motion.pose, &self.motion.twist))
    }

    fn energy(&self) -> EnergyLedger {
        self.energy
    }

    fn computes(&self) -> Computes {
        self.computes
    }

    fn side_contacts(&self) -> Vec<SideContact> {
        self.contacts.clone()
    }
}
