//! Limits and geometry that the rules of several sections share.

use std::f64::consts::TAU;

use crate::math::{Vec2, direction};

/// Largest number of springs or supports, in one ring and in all (1).
pub const MOST_IN_RING: usize = 100_000;
/// Largest number of ants (1).
pub const MOST_ANTS: usize = 1_000_000;

/// Whether a letter controls a terminal or the direction of text.
pub fn is_control(letter: char) -> bool {
    letter.is_control() || matches!(letter, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Point at `bearing` (rad) and `radius` (m).
pub fn polar(radius: f64, bearing: f64) -> Vec2 {
    radius * direction(bearing)
}

/// Directions of `n` equal angles from `first` on (rad).
pub fn bearings(n: usize, first: f64) -> impl Iterator<Item = f64> {
    (0..n).map(move |index| first + TAU * index as f64 / n as f64)
}
