//! Bisection.

/// Ends of an interval halved `n` times around the place up to which `is_below` holds.
pub fn bisected([mut low, mut high]: [f64; 2], n: u32, mut is_below: impl FnMut(f64) -> bool) -> [f64; 2] {
    for _ in 0..n {
        let middle = 0.5 * (low + high);
        if is_below(middle) { low = middle } else { high = middle }
    }
    [low, high]
}
