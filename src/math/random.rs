//! Keyed random numbers: every draw is a pure function of (seed, stream, agent, tick).
//!
//! The generator is Philox4x32-10 (Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as
//! 1, 2, 3", SC 2011). No state is kept from tick to tick, so the draws of one backend cannot
//! depend on how often another one steps.

use std::convert::Infallible;
use std::f64::consts::TAU;

use rand::distr::{Distribution, Open01};
use rand::{Rng, TryRng};

use super::Vec2;

/// Purpose of a draw. The numbers are part of every stored result: append, never renumber.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Stream {
    /// Start position and heading of an ant.
    Start = 0,
    /// Position where a searching ant believes the load to be.
    Target = 1,
    /// Whether an ant in reach of a free spring grasps it.
    Grasp = 2,
    /// Whether a pulling ant releases its spring.
    Release = 3,
    /// Parts of a random scenario.
    Scene = 4,
    /// Points of a sweep's design.
    Design = 5,
    /// Order or multiplicity of the parts of a resampled sample.
    Resample = 6,
    /// Side on which an ant passes an obstacle when both are equal.
    Side = 7,
}

/// Random streams of one run, all keyed by its seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RandomStreams {
    seed: u64,
}

impl RandomStreams {
    pub fn new(seed: u64) -> Self {
        Self { seed }
    }

    /// Generator of the draws of one agent at one tick.
    // Inlined, so that a pair of draws takes them from registers.
    #[inline(always)]
    pub fn draws(&self, stream: Stream, agent: u32, tick: u64) -> Draws {
        let (key, counter) = (self.key(), [tick, tick >> 32, agent.into(), stream as u64]);
        Draws { key, counter, words: block(counter, key), n_used: 0 }
    }

    /// Two independent uniform draws in (0, 1) with 52 random bits each.
    #[inline]
    pub fn uniform_pair(&self, stream: Stream, agent: u32, tick: u64) -> [f64; 2] {
        let mut draws = self.draws(stream, agent, tick);
        [Open01.sample(&mut draws), Open01.sample(&mut draws)]
    }

    /// One uniform draw in (0, 1): the first of [`RandomStreams::uniform_pair`].
    #[inline]
    pub fn uniform(&self, stream: Stream, agent: u32, tick: u64) -> f64 {
        let [draw] = self.uniforms(stream, agent, tick);
        draw
    }

    /// Draws of [`RandomStreams::uniform`] at `N` successive ticks from this one on, computed side
    /// by side.
    #[inline]
    pub fn uniforms<const N: usize>(&self, stream: Stream, agent: u32, tick: u64) -> [f64; N] {
        let ticks: [u64; N] = std::array::from_fn(|k| tick.wrapping_add(k as u64));
        let counters = [ticks, ticks.map(|tick| tick >> 32), [u64::from(agent); N], [stream as u64; N]];
        let [high, low, ..] = philox4x32_10(counters, self.key());
        std::array::from_fn(|k| open_unit(high[k] as u32, low[k] as u32))
    }

    /// Two independent standard normal draws (Box and Muller 1958).
    // `rand_distr::StandardNormal` would draw other numbers, and a varying number of them.
    pub fn normal_pair(&self, stream: Stream, agent: u32, tick: u64) -> Vec2 {
        let [u, v] = self.uniform_pair(stream, agent, tick);
        let radius = (-2.0 * u.ln()).sqrt();
        let (sin, cos) = (TAU * v).sin_cos();
        Vec2::new(radius * cos, radius * sin)
    }

    fn key(&self) -> [u32; 2] {
        [self.seed as u32, (self.seed >> 32) as u32]
    }
}

/// Random numbers of one agent at one tick, for the distributions of `rand`.
#[derive(Clone, Debug)]
pub struct Draws {
    key: [u32; 2],
    /// Low and high word of the tick, agent, and stream plus 256 for each block that was drawn.
    counter: [u64; 4],
    words: [u32; 4],
    n_used: usize,
}

impl Draws {
    #[cold]
    fn next_block(&mut self) {
        self.counter[3] += 256;
        (self.words, self.n_used) = (block(self.counter, self.key), 0);
    }
}

impl TryRng for Draws {
    type Error = Infallible;

    #[inline]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        if self.n_used == self.words.len() {
            self.next_block();
        }
        self.n_used += 1;
        Ok(self.words[self.n_used - 1])
    }

    /// The first of two words is the high one.
    #[inline]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        let (high, low) = (self.next_u32(), self.next_u32());
        Ok((u64::from(high) << 32) | u64::from(low))
    }

    fn try_fill_bytes(&mut self, target: &mut [u8]) -> Result<(), Infallible> {
        for chunk in target.chunks_mut(4) {
            chunk.copy_from_slice(&self.next_u32().to_le_bytes()[..chunk.len()]);
        }
        Ok(())
    }
}

/// The draw that [`Open01`] makes of these words, without a conversion, which would go one by one.
fn open_unit(high: u32, low: u32) -> f64 {
    let bits = ((u64::from(high) << 32) | u64::from(low)) >> 12;
    // The bits are the digits of a number from 1 to 2.
    const ONE: u64 = 1f64.to_bits();
    f64::from_bits(ONE | bits) - (1.0 - 0.5 * f64::EPSILON)
}

/// Block of one counter.
#[inline]
fn block(counter: [u64; 4], key: [u32; 2]) -> [u32; 4] {
    philox4x32_10(counter.map(|word| [word]), key).map(|[word]| word as u32)
}

/// Blocks of N counters, computed side by side. Words stand in the low halves; what is above them
/// takes no part in products. `rand_philox` has the same function for one counter at a time, which
/// takes a fifth longer.
// Inlined, so that counters stay in registers.
#[inline(always)]
fn philox4x32_10<const N: usize>(counter: [[u64; N]; 4], key: [u32; 2]) -> [[u64; N]; 4] {
    let ([mut c0, mut c1, mut c2, mut c3], mut k) = (counter, key);
    for _ in 0..10 {
        for i in 0..N {
            let (a, b) = ((c0[i] & u64::from(u32::MAX)) * 0xD251_1F53, (c2[i] & u64::from(u32::MAX)) * 0xCD9E_8D57);
            c0[i] = (b >> 32) ^ c1[i] ^ u64::from(k[0]);
            c2[i] = (a >> 32) ^ c3[i] ^ u64::from(k[1]);
            (c1[i], c3[i]) = (b, a);
        }
        k = [k[0].wrapping_add(0x9E37_79B9), k[1].wrapping_add(0xBB67_AE85)];
    }
    [c0, c1, c2, c3]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The known answers that the authors publish with Random123.
    #[test]
    fn philox_gives_its_published_answers() {
        let philox = |counter: [u32; 4], key| philox4x32_10(counter.map(|word| [u64::from(word)]), key).map(|[word]| word as u32);
        assert_eq!(philox([0; 4], [0; 2]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
        assert_eq!(philox([u32::MAX; 4], [u32::MAX; 2]), [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]);
        let counter = [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344];
        assert_eq!(philox(counter, [0xa409_3822, 0x299f_31d0]), [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]);
    }

    /// Draws are part of every stored result: these are those of the first versions.
    #[test]
    fn draws_are_the_stored_ones() {
        let streams = RandomStreams::new(42);
        let [u, v] = streams.uniform_pair(Stream::Start, 3, 7);
        assert_eq!(
            [u, v, streams.uniform(Stream::Start, 3, 7)].map(f64::to_bits),
            [0x3fd9_67bc_b42d_808a, 0x3fb4_334a_9199_0978, 0x3fd9_67bc_b42d_808a]
        );
    }

    /// The ticks include the one at which the low word of the counter starts again from zero.
    #[test]
    fn draws_side_by_side_are_those_one_by_one() {
        let streams = RandomStreams::new(0x1234_5678_9abc_def0);
        for first in [0, 77, (1 << 32) - 5, u64::MAX - 2] {
            let together: [f64; 16] = streams.uniforms(Stream::Release, 2, first);
            for (k, drawn) in together.into_iter().enumerate() {
                assert_eq!(drawn, streams.uniform_pair(Stream::Release, 2, first.wrapping_add(k as u64))[0], "{first} {k}");
            }
        }
    }

    #[test]
    fn draws_differ_in_every_part_of_their_key_and_normals_have_unit_variance() {
        let streams = RandomStreams::new(7);
        let base = streams.uniform(Stream::Grasp, 3, 11);
        assert_eq!(base, streams.uniform(Stream::Grasp, 3, 11));
        assert_ne!(base, streams.uniform(Stream::Release, 3, 11));
        assert_ne!(base, streams.uniform(Stream::Grasp, 4, 11));
        assert_ne!(base, streams.uniform(Stream::Grasp, 3, 12));
        assert_ne!(base, streams.uniform(Stream::Grasp, 3, 11 + (1 << 32)));
        assert_ne!(base, RandomStreams::new(8).uniform(Stream::Grasp, 3, 11));
        let n = 40_000;
        let squares: f64 = (0..n).map(|tick| streams.normal_pair(Stream::Target, 0, tick).norm_squared()).sum();
        // The mean of n chi-square(2) draws has standard deviation 2 / sqrt(n) = 0.01; five of
        // them.
        assert!((squares / n as f64 - 2.0).abs() < 0.05);
    }
}
