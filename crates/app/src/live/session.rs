//! One page from its opening to its end: time, frames and changes.

use std::ops::RangeInclusive;
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError};
use std::time::{Duration, Instant};

use super::hand::{Handle, Pull, Reach, Span};
use super::lanes::{Drawn, Lanes};
use super::message::{Ask, Frame, Tell};
use super::scene::{Edit, LiveScene};
use super::verdict::Judge;
use cohaul::math::Vec2;
use cohaul::simulation::SavedRun;

/// Real time between two frames.
const FRAME: Duration = Duration::from_nanos(1_000_000_000 / 60);
/// Real time that the runs of one frame take at most.
const LONGEST_FRAME: Duration = Duration::from_millis(50);
/// Frames that are sent ahead of the page at most. A page that draws no more, as it is hidden or
/// gone, stops the runs.
const MOST_AHEAD: u64 = 8;
/// How fast what is dragged comes to the hand (1/s of real time): steadily, and without delay to
/// the eye.
const FOLLOWS: f64 = 12.0;
/// Points of a course that a page is sent at least, however fast it is computed, of a scene with
/// few springs.
const POINTS: f64 = 500.0;
/// Springs that make a point twice as large (1).
const MANY_SPRINGS: f64 = 20.0;
/// Simulated time over real time, at least and at most (1).
const PACES: RangeInclusive<f64> = 1e-3..=1e3;

/// The page has gone.
pub struct Gone;

enum Change {
    Edit(Edit),
    /// The runs begin anew and go fast to a time (s).
    Anew(f64),
}

/// A page and the runs that it shows.
pub struct Session<T> {
    tell: T,
    judge: Judge,
    drawn: Drawn,
    is_playing: bool,
    /// Simulated time over real time (1).
    pace: f64,
    /// Time to which the runs go as fast as they can (s).
    goal: f64,
    /// Simulated time that is due and shorter than a control period (s).
    due: f64,
    next: Instant,
    /// What is dragged, and where to.
    held: Option<(Handle, Vec2)>,
    n_sent: u64,
    n_drawn: u64,
    /// Control periods between two points of the course.
    every: u64,
}

impl<T: Fn(Tell) -> Result<(), Gone> + Clone + Send + 'static> Session<T> {
    pub fn new(scene: &LiveScene, judge: Judge, tell: T) -> Self {
        let drawn = Drawn::of(scene);
        Self {
            tell,
            judge,
            drawn,
            is_playing: false,
            pace: 1.0,
            goal: 0.0,
            due: 0.0,
            next: Instant::now(),
            held: None,
            n_sent: 0,
            n_drawn: 0,
            every: 1,
        }
    }

    pub fn run(mut self, mut scene: LiveScene, asks: &Receiver<Ask>) -> Result<(), Gone> {
        let mut saved: Option<Vec<SavedRun>> = None;
        self.show(&scene)?;
        loop {
            let mut lanes = match saved.take().map(|saved| Lanes::resume(&scene, &saved)) {
                Some(Ok(lanes)) => lanes,
                Some(Err(error)) => {
                    self.refuse(error.to_string())?;
                    Lanes::new(&scene)
                }
                None => Lanes::new(&scene),
            };
            let change = self.play(&mut lanes, asks)?;
            let (now, states) = (lanes.time(), lanes.save());
            drop(lanes);
            let edit = match change {
                Change::Edit(edit) => edit,
                Change::Anew(goal) => {
                    self.goal = goal;
                    continue;
                }
            };
            match (scene.apply(&edit, now), states) {
                (Ok(Reach::Future), Ok(states)) => saved = Some(states),
                (Ok(_), _) => {
                    self.goal = self.goal.max(now);
                    self.open(&edit);
                    self.show(&scene)?;
                }
                (Err(why), states) => {
                    self.held = None;
                    self.goal = self.goal.max(now);
                    saved = states.ok();
                    self.refuse(why)?;
                }
            }
        }
    }

    /// Where a scene that was just opened goes.
    fn open(&mut self, edit: &Edit) {
        match edit {
            Edit::Shipped { .. } => self.goal = 0.0,
            Edit::Open(saved) => self.goal = saved.time_s,
            _ => return,
        }
        (self.is_playing, self.held) = (false, None);
    }

    fn show(&mut self, scene: &LiveScene) -> Result<(), Gone> {
        self.drawn = Drawn::of(scene);
        self.due = 0.0;
        let n_points = POINTS / (1.0 + self.drawn.springs.len() as f64 / MANY_SPRINGS);
        self.every = (scene.scenario.duration / scene.scenario.control_period / n_points).max(1.0) as u64;
        (self.tell)(Tell::Scene(Box::new(scene.now())))?;
        self.compare(scene);
        Ok(())
    }

    fn compare(&mut self, scene: &LiveScene) {
        let tell = self.tell.clone();
        self.judge.ask(scene, move |told| {
            let _ = tell(told);
        });
    }

    fn refuse(&self, why: String) -> Result<(), Gone> {
        (self.tell)(Tell::refused(why))
    }

    fn play(&mut self, lanes: &mut Lanes, asks: &Receiver<Ask>) -> Result<Change, Gone> {
        if self.goal <= lanes.time() {
            self.send(lanes, 0.0, 0.0)?;
        }
        loop {
            // Time that passed while nothing ran is not caught up.
            self.next = self.next.max(Instant::now() - FRAME);
            if self.goal > lanes.time() && !lanes.has_ended() {
                self.hurry(lanes)?;
                match asks.try_recv().map(|ask| self.answer(ask, lanes)) {
                    Ok(Ok(Some(change))) => return Ok(change),
                    Ok(Ok(None)) | Err(TryRecvError::Empty) => continue,
                    Ok(Err(Gone)) | Err(TryRecvError::Disconnected) => return Err(Gone),
                }
            }
            let runs = self.is_playing && self.n_sent - self.n_drawn <= MOST_AHEAD;
            if let Some(ask) = receive(asks, runs.then_some(self.next))? {
                match self.answer(ask, lanes)? {
                    Some(change) => return Ok(change),
                    None => continue,
                }
            }
            self.next += FRAME;
            self.due += self.pace * FRAME.as_secs_f64();
            let n_ticks = (self.due / lanes.period() + 1e-9).floor();
            self.due -= n_ticks * lanes.period();
            if n_ticks >= 1.0 {
                if let Some(change) = self.dragged(lanes, n_ticks) {
                    return Ok(change);
                }
                self.frame(lanes, n_ticks)?;
            }
        }
    }

    /// The change that a drag makes before the runs go on by so many ticks.
    fn dragged(&mut self, lanes: &Lanes, n_ticks: f64) -> Option<Change> {
        let (handle, to) = self.held?;
        let (tick, period) = (lanes.tick() as f64, lanes.period());
        let span = Span { from: tick * period, to: (tick + n_ticks) * period };
        let rest_tip = match handle {
            Handle::Spring(spring) => lanes.rest_tip(spring).unwrap_or_default(),
            Handle::Pusher(_) => Vec2::zeros(),
        };
        // The runs go on to the end of the span before the next change.
        self.goal = span.to;
        let pull = Pull { to, rate: FOLLOWS / self.pace };
        Some(Change::Edit(Edit::Drag { handle, pull, span, rest_tip }))
    }

    fn frame(&mut self, lanes: &mut Lanes, n_ticks: f64) -> Result<(), Gone> {
        let clock = Instant::now();
        let from = lanes.time();
        // A pace that the machine cannot keep is not kept, and the page stays live.
        for _ in (0..n_ticks as u64).take_while(|_| clock.elapsed() < LONGEST_FRAME) {
            self.advance(lanes)?;
        }
        if lanes.has_ended() {
            self.is_playing = false;
        }
        self.send(lanes, lanes.time() - from, clock.elapsed().as_secs_f64())
    }

    /// Goes towards the goal for the time of a frame.
    fn hurry(&mut self, lanes: &mut Lanes) -> Result<(), Gone> {
        let (clock, from, goal) = (Instant::now(), lanes.time(), self.goal - 1e-6 * lanes.period());
        while lanes.time() < goal && !lanes.has_ended() && clock.elapsed() < FRAME {
            self.advance(lanes)?;
        }
        if lanes.time() >= goal || lanes.has_ended() {
            self.goal = 0.0;
        }
        self.send(lanes, lanes.time() - from, clock.elapsed().as_secs_f64())
    }

    /// Does what is asked, or returns the change of the scene that it takes.
    fn answer(&mut self, ask: Ask, lanes: &mut Lanes) -> Result<Option<Change>, Gone> {
        let edit = match ask {
            Ask::Play => return self.start(lanes),
            Ask::Step => return self.step(lanes),
            Ask::Restart => {
                self.is_playing = false;
                return Ok(Some(Change::Anew(0.0)));
            }
            Ask::GoTo { time_s } if time_s < lanes.time() => return Ok(Some(Change::Anew(time_s))),
            Ask::Set { what, value } => Edit::Set { what, value },
            Ask::Settings { settings } => Edit::Settings(settings),
            Ask::Release { spring } => Edit::Release { spring },
            Ask::Ants { on } => Edit::Ants { on },
            Ask::Shipped { name } => Edit::Shipped { name },
            Ask::Open { saved } => Edit::Open(Box::new(saved)),
            other => return self.note(other, lanes).map(|()| None),
        };
        Ok(Some(Change::Edit(edit)))
    }

    /// Takes in what changes no scene.
    fn note(&mut self, ask: Ask, lanes: &Lanes) -> Result<(), Gone> {
        match ask {
            Ask::Pause => {
                self.is_playing = false;
                self.send(lanes, 0.0, 0.0)?;
            }
            Ask::GoTo { time_s } => self.goal = time_s,
            Ask::Pace { factor } if PACES.contains(&factor) => self.pace = factor,
            Ask::Pace { factor } => self.refuse(format!("pace: must be from {} to {}, found {factor}", PACES.start(), PACES.end()))?,
            Ask::Drawn { frame } => self.n_drawn = frame.min(self.n_sent).max(self.n_drawn),
            Ask::Drag { handle, to } => self.held = Some((handle, Vec2::from(to))),
            Ask::Drop if self.held.take().is_some() => self.compare(lanes.scene()),
            Ask::HandBack => (self.tell)(Tell::Handed(lanes.scene().saved(lanes.time())))?,
            Ask::Save => (self.tell)(Tell::Saved(lanes.scene().saved(lanes.time())))?,
            _ => {}
        }
        Ok(())
    }

    /// Plays on, or from the start after the end.
    fn start(&mut self, lanes: &Lanes) -> Result<Option<Change>, Gone> {
        self.is_playing = true;
        if lanes.has_ended() && self.held.is_none() {
            self.due = 0.0;
            return Ok(Some(Change::Anew(0.0)));
        }
        self.send(lanes, 0.0, 0.0).map(|()| None)
    }

    fn step(&mut self, lanes: &mut Lanes) -> Result<Option<Change>, Gone> {
        self.is_playing = false;
        match self.dragged(lanes, 1.0) {
            Some(change) => Ok(Some(change)),
            None => self.frame(lanes, 1.0).map(|()| None),
        }
    }

    /// Goes on by a control period, and sends the point of the course that is due. It belongs to
    /// the next frame.
    fn advance(&mut self, lanes: &mut Lanes) -> Result<(), Gone> {
        lanes.advance();
        match lanes.tick().is_multiple_of(self.every) {
            true => self.tell_of(lanes, self.n_sent + 1, None),
            false => Ok(()),
        }
    }

    /// Sends what the runs have reached, after `simulated` (s) that took `real` (s).
    fn send(&mut self, lanes: &Lanes, simulated: f64, real: f64) -> Result<(), Gone> {
        self.n_sent += 1;
        self.tell_of(lanes, self.n_sent, (simulated > 0.0).then(|| real / simulated))
    }

    fn tell_of(&self, lanes: &Lanes, number: u64, share: Option<f64>) -> Result<(), Gone> {
        let frame = Frame {
            frame: number,
            time_s: lanes.time(),
            is_playing: self.is_playing,
            has_ended: lanes.has_ended(),
            share,
            stages: lanes.stages(&self.drawn),
            lanes: lanes.lanes(&self.drawn),
            pushers: lanes.pushers(&self.drawn),
        };
        (self.tell)(Tell::Frame(frame))
    }
}

/// The next ask; none when the time has come. Without a time it waits.
fn receive(asks: &Receiver<Ask>, until: Option<Instant>) -> Result<Option<Ask>, Gone> {
    let Some(until) = until else { return asks.recv().map(Some).map_err(|_| Gone) };
    match asks.recv_timeout(until.saturating_duration_since(Instant::now())) {
        Ok(ask) => Ok(Some(ask)),
        Err(RecvTimeoutError::Timeout) => Ok(None),
        Err(RecvTimeoutError::Disconnected) => Err(Gone),
    }
}
