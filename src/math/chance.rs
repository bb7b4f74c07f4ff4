//! Counter-based random draws: chance is a pure function of (seed, stream, agent, tick).
//!
//! The generator is Philox4x32-10 (Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011). No state is
//! kept, so what one backend draws cannot depend on how often another one steps, and a draw that nobody asks for costs nothing.

use std::f64::consts::TAU;

use super::Vec2;

/// What a draw is for. The numbers are part of every stored result: append, never renumber.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Stream {
    /// Start position and heading of an ant.
    Start = 0,
    /// Where a searching ant believes the load to be.
    Target = 1,
    /// Whether an ant in reach of a free spring grasps it.
    Grasp = 2,
    /// Whether a pulling ant lets go.
    Release = 3,
    /// What a random scenario is made of.
    Scene = 4,
    /// Points of a sweep's design.
    Design = 5,
    /// In which order, or how often, parts of a sample are taken again.
    Resample = 6,
}

/// All chance of one run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chance {
    seed: u64,
}

impl Chance {
    pub fn new(seed: u64) -> Self {
        Self { seed }
    }

    /// Two independent uniform draws in (0, 1) with 52 random bits each.
    pub fn uniform_pair(&self, stream: Stream, agent: u32, tick: u64) -> [f64; 2] {
        let counter = [[tick], [tick >> 32], [u64::from(agent)], [stream as u64]];
        let words = philox4x32_10(counter, [self.seed as u32, (self.seed >> 32) as u32]).map(|[word]| word as u32);
        [open_unit(words[0], words[1]), open_unit(words[2], words[3])]
    }

    /// One uniform draw in (0, 1).
    pub fn uniform(&self, stream: Stream, agent: u32, tick: u64) -> f64 {
        self.uniform_pair(stream, agent, tick)[0]
    }

    /// What [`Chance::uniform`] draws at so many ticks from this one on, side by side.
    #[inline]
    pub fn uniforms<const N: usize>(&self, stream: Stream, agent: u32, tick: u64) -> [f64; N] {
        let ticks: [u64; N] = std::array::from_fn(|k| tick.wrapping_add(k as u64));
        let counters = [ticks, ticks.map(|tick| tick >> 32), [u64::from(agent); N], [stream as u64; N]];
        let [high, low, ..] = philox4x32_10(counters, [self.seed as u32, (self.seed >> 32) as u32]);
        std::array::from_fn(|k| open_unit(high[k] as u32, low[k] as u32))
    }

    /// Two independent standard normal draws (Box and Muller 1958).
    pub fn normal_pair(&self, stream: Stream, agent: u32, tick: u64) -> Vec2 {
        let [u, v] = self.uniform_pair(stream, agent, tick);
        let radius = (-2.0 * u.ln()).sqrt();
        let (sin, cos) = (TAU * v).sin_cos();
        Vec2::new(radius * cos, radius * sin)
    }
}

/// The 52 high bits of (high, low), put into the middle of their cell of (0, 1): neither end is ever drawn.
fn open_unit(high: u32, low: u32) -> f64 {
    let bits = ((u64::from(high) << 32) | u64::from(low)) >> 12;
    // As the digits of a number from 1 to 2: no conversion, which would go one by one.
    const ONE: u64 = 1f64.to_bits();
    f64::from_bits(ONE | bits) - 1.0 + 0.5 / (1u64 << 52) as f64
}

/// Of N counters side by side. Words are the low halves of what stands for them; whatever is above takes no part in products, and is left there.
// In place: counters stay in registers.
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

    /// Across the tick at which the low word of the counter begins anew, too.
    #[test]
    fn draws_side_by_side_are_those_one_by_one() {
        let chance = Chance::new(0x1234_5678_9abc_def0);
        for first in [0, 77, (1 << 32) - 5, u64::MAX - 2] {
            let together: [f64; 16] = chance.uniforms(Stream::Release, 2, first);
            for (k, drawn) in together.into_iter().enumerate() {
                assert_eq!(drawn, chance.uniform(Stream::Release, 2, first.wrapping_add(k as u64)), "{first} {k}");
            }
        }
    }

    #[test]
    fn draws_differ_in_every_part_of_their_key_and_normals_have_unit_variance() {
        let chance = Chance::new(7);
        let base = chance.uniform(Stream::Grasp, 3, 11);
        assert_eq!(base, chance.uniform(Stream::Grasp, 3, 11));
        assert_ne!(base, chance.uniform(Stream::Release, 3, 11));
        assert_ne!(base, chance.uniform(Stream::Grasp, 4, 11));
        assert_ne!(base, chance.uniform(Stream::Grasp, 3, 12));
        assert_ne!(base, chance.uniform(Stream::Grasp, 3, 11 + (1 << 32)));
        assert_ne!(base, Chance::new(8).uniform(Stream::Grasp, 3, 11));
        let n = 40_000;
        let squares: f64 = (0..n).map(|tick| chance.normal_pair(Stream::Target, 0, tick).norm_squared()).sum();
        // The mean of n chi-square(2) draws has standard deviation 2 / sqrt(n) = 0.01; five of them.
        assert!((squares / n as f64 - 2.0).abs() < 0.05);
    }
}
