//! Series of numbers as fixed point in base64: a quarter of the room that they take as JSON, and
//! read by a page in one go.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use crate::chart::axis::range;

/// Values `zero + step * k`, with k the little-endian whole numbers of `bits` in `data`. The lowest
/// k stands for no value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Packed {
    pub zero: f64,
    pub step: f64,
    pub bits: u32,
    pub data: String,
}

impl Packed {
    /// In 16 bits: to 1 part in 130,000 of the range of the values, either side.
    pub fn short(values: &[Option<f64>]) -> Self {
        Self::in_bits(16, values)
    }

    /// In 32 bits: to 1 part in 8e9 of the range.
    pub fn long(values: &[Option<f64>]) -> Self {
        Self::in_bits(32, values)
    }

    /// The values, as the page reads them.
    ///
    /// # Panics
    /// When `data` is not what this module writes.
    pub fn unpacked(&self) -> Vec<Option<f64>> {
        let bytes = STANDARD.decode(&self.data).expect("it is base64");
        let whole: Vec<i64> = match self.bits {
            16 => bytes.chunks_exact(2).map(|b| i16::from_le_bytes([b[0], b[1]]).into()).collect(),
            _ => bytes.chunks_exact(4).map(|b| i32::from_le_bytes([b[0], b[1], b[2], b[3]]).into()).collect(),
        };
        let lowest = -(1i64 << (self.bits - 1));
        whole.into_iter().map(|k| (k != lowest).then_some(self.zero + self.step * k as f64)).collect()
    }

    fn in_bits(bits: u32, values: &[Option<f64>]) -> Self {
        let largest = f64::from(i32::MAX >> (32 - bits));
        let (zero, step, whole) = scaled(values, largest);
        let bytes = |k: Option<f64>| (k.unwrap_or(-largest - 1.0) as i32).to_le_bytes().into_iter().take(bits as usize / 8);
        Self { zero, step, bits, data: STANDARD.encode(whole.flat_map(bytes).collect::<Vec<u8>>()) }
    }
}

/// Middle of the range, its size over twice `largest`, and the values in those terms. What is not
/// finite is no value.
fn scaled(values: &[Option<f64>], largest: f64) -> (f64, f64, impl Iterator<Item = Option<f64>>) {
    // Halves first: the range of finite values need not be finite.
    let halves = range(values.iter().flatten().copied()).map(|(low, high)| (0.5 * low + 0.5 * high, 0.5 * high - 0.5 * low));
    let (zero, half) = halves.unwrap_or((0.0, 0.0));
    let step = half / largest;
    let whole = move |value: f64| if step > 0.0 { ((value - zero) / step).round().clamp(-largest, largest) } else { 0.0 };
    (zero, step, values.iter().map(move |value| value.filter(|value| value.is_finite()).map(whole)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_back_within_half_a_step() {
        let values: Vec<Option<f64>> = (0..500).map(|k| (k % 7 != 3).then(|| 0.2 + 0.3 * (f64::from(k) * 0.37).sin())).collect();
        for packed in [Packed::short(&values), Packed::long(&values)] {
            for (value, found) in values.iter().zip(packed.unpacked()) {
                assert_eq!(value.is_some(), found.is_some());
                // Beside half a step the rounding of numbers of order one.
                assert!((value.unwrap_or(0.0) - found.unwrap_or(0.0)).abs() <= 0.5 * packed.step + 1e-15);
            }
        }
        assert!(Packed::short(&values).step < 0.6 / 65_000.0);
    }

    #[test]
    fn odd_series_are_packed_too() {
        let packed = |values: &[Option<f64>]| Packed::short(values).unpacked();
        assert_eq!(packed(&[]), []);
        assert_eq!(packed(&[None, None]), [None, None]);
        assert_eq!(packed(&[Some(7.25); 3]), [Some(7.25); 3]);
        assert_eq!(packed(&[Some(f64::NAN), Some(1.0), Some(f64::INFINITY)]), [None, Some(1.0), None]);
        let far = packed(&[Some(-1e308), Some(1e308)]);
        assert!(far.iter().all(|value| value.is_some_and(f64::is_finite)), "{far:?}");
    }
}
