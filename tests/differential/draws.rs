//! Random numbers of scenes.

use cohaul::math::{RandomStreams, Stream};

/// Draws of one scene, a function of its seed.
pub struct Draws {
    streams: RandomStreams,
    n: u64,
}

impl Draws {
    pub fn new(seed: u64) -> Self {
        Self { streams: RandomStreams::new(seed), n: 0 }
    }

    /// A uniform draw in (0, 1).
    pub fn unit(&mut self) -> f64 {
        self.n += 1;
        self.streams.uniform(Stream::Scene, 0, self.n)
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// An integer from 0 to `n` - 1.
    pub fn below(&mut self, n: usize) -> usize {
        ((n as f64) * self.unit()) as usize % n
    }

    pub fn is(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// Puts a list into a random order.
    pub fn shuffle<T>(&mut self, list: &mut [T]) {
        for at in (1..list.len()).rev() {
            list.swap(at, self.below(at + 1));
        }
    }
}

/// Number in an environment variable, or `otherwise`.
pub fn asked(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(otherwise)
}
