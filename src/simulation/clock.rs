//! Time of a run: control ticks, the parts of a control period at whose ends rows are recorded, and
//! the end.

pub use crate::scenario::SAME_INSTANT;

/// Position of a run in time.
pub(super) struct Clock {
    /// Time between two ticks (s).
    period: f64,
    /// End of the run (s).
    end: f64,
    /// Number of equal parts of a control period at whose ends rows are recorded.
    pub n_parts: u64,
    /// Number of the last tick that was reached.
    pub tick: u64,
    /// Time that was reached (s).
    pub time: f64,
}

impl Clock {
    /// A clock at the start of a run that ends at `end` (s) and has a tick every `period` (s).
    pub fn new(period: f64, end: f64) -> Self {
        Self { period, end, n_parts: 1, tick: 0, time: 0.0 }
    }

    /// Number of the tick at this instant; `None` between ticks.
    pub fn tick_now(&self) -> Option<u64> {
        (self.time == self.tick_time(self.tick)).then_some(self.tick)
    }

    /// Whether the time is in the control period that begins with the last tick, and not after the
    /// end.
    pub fn is_in_period(&self) -> bool {
        self.time >= self.tick_time(self.tick) && self.time < self.tick_time(self.tick + 1) && self.time <= self.end
    }

    pub fn is_at_end(&self) -> bool {
        self.end - self.time <= self.same_instant()
    }

    /// Whether a control period or a part of one ends at this instant.
    pub fn ends_part(&self) -> bool {
        self.tick_now().is_some() || self.n_parts > 1 && (self.time - self.part_time(self.part_now().floor())).abs() <= self.same_instant()
    }

    /// Next instant of the run (s): the first of the next tick, the next end of a part, the end of
    /// the run, `instant` (s) and the `next_corner` of an obstacle after a time (s). A corner that
    /// is one with an instant of the others, or with the present, is no instant of its own.
    pub fn next(&self, instant: Option<f64>, next_corner: impl Fn(f64) -> f64) -> f64 {
        let (next, same) = (self.next_of_run(instant), self.same_instant());
        let corner = next_corner(self.time + same);
        if corner < next - same { corner } else { next }
    }

    fn next_of_run(&self, instant: Option<f64>) -> f64 {
        let end = self.tick_time(self.tick + 1).min(self.end);
        let instant = instant.map_or(end, |instant| instant.min(end));
        if self.n_parts == 1 {
            return instant;
        }
        let part = self.part_time(self.part_now().floor() + 1.0);
        if part < instant - self.same_instant() { part } else { instant }
    }

    /// Moves to a later time (s), at most to the next tick.
    pub fn move_to(&mut self, time: f64) {
        self.time = time;
        if time >= self.tick_time(self.tick + 1) {
            self.tick += 1;
        }
    }

    /// Time of a tick (s). It is a product and no sum, so that rounding does not grow.
    fn tick_time(&self, tick: u64) -> f64 {
        tick as f64 * self.period
    }

    /// Number of parts of this control period that have passed, up to rounding (1).
    fn part_now(&self) -> f64 {
        (self.time + self.same_instant() - self.tick_time(self.tick)) / self.period * self.n_parts as f64
    }

    /// Time at which a part of this control period ends (s).
    fn part_time(&self, part: f64) -> f64 {
        self.tick_time(self.tick) + self.period * part / self.n_parts as f64
    }

    /// Instants nearer than this are one (s).
    fn same_instant(&self) -> f64 {
        SAME_INSTANT * self.period
    }
}
