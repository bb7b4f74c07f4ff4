//! Time of a run: ticks of behaviour, the parts of a control period whose ends have rows too, and the end.

/// Instants nearer to each other than this share of a control period are one.
pub(crate) const SAME_INSTANT: f64 = 1e-9;

/// Where a run is in time.
pub(super) struct Clock {
    /// Between two ticks (s).
    period: f64,
    /// Of the run (s).
    end: f64,
    /// Equal parts of each control period, rows at whose ends are kept.
    pub n_parts: u64,
    /// Number of the last tick passed or reached.
    pub tick: u64,
    /// (s)
    pub time: f64,
}

impl Clock {
    /// At the start of a run that ends at `end` (s), with ticks every `period` (s).
    pub fn new(period: f64, end: f64) -> Self {
        Self { period, end, n_parts: 1, tick: 0, time: 0.0 }
    }

    /// The tick at this instant; `None` between ticks.
    pub fn tick_now(&self) -> Option<u64> {
        (self.time == self.tick_time(self.tick)).then_some(self.tick)
    }

    /// Whether this is the end.
    pub fn is_at_end(&self) -> bool {
        self.end - self.time <= self.same_instant()
    }

    /// Whether a part of a control period, or all of it, ends at this instant.
    pub fn ends_part(&self) -> bool {
        self.tick_now().is_some() || self.n_parts > 1 && (self.time - self.part_time(self.part_now().floor())).abs() <= self.same_instant()
    }

    /// The first one after now (s) of the next tick, the next end of a part, the end of the run and `instant` (s), if there is one.
    pub fn next(&self, instant: Option<f64>) -> f64 {
        let end = self.tick_time(self.tick + 1).min(self.end);
        let instant = instant.map_or(end, |instant| instant.min(end));
        if self.n_parts == 1 {
            return instant;
        }
        let part = self.part_time(self.part_now().floor() + 1.0);
        if part < instant - self.same_instant() { part } else { instant }
    }

    /// Goes on to a later time (s), no further than the next tick.
    pub fn move_to(&mut self, time: f64) {
        self.time = time;
        if time >= self.tick_time(self.tick + 1) {
            self.tick += 1;
        }
    }

    /// Time of a tick (s): a product, not a sum, so that no rounding grows.
    fn tick_time(&self, tick: u64) -> f64 {
        tick as f64 * self.period
    }

    /// How many parts of this control period have passed, those within rounding of their end included (1).
    fn part_now(&self) -> f64 {
        (self.time + self.same_instant() - self.tick_time(self.tick)) / self.period * self.n_parts as f64
    }

    /// When a part of this control period ends (s).
    fn part_time(&self, part: f64) -> f64 {
        self.tick_time(self.tick) + self.period * part / self.n_parts as f64
    }

    /// Instants nearer to each other than this are one (s).
    fn same_instant(&self) -> f64 {
        SAME_INSTANT * self.period
    }
}
