//! Numbers that stand in the paper's text. Of its figures only form and captions are known, so none of their values is here.

/// Pull at the ants' decisions: mean, standard deviation, largest (N), and size of the sample (1).
pub const PULL_MEAN_N: f64 = 5.0e-3;
pub const PULL_SD_N: f64 = 5.1e-3;
pub const PULL_MAX_N: f64 = 36.5e-3;
pub const N_PULLS: u64 = 520_057;

/// Instants at which 6, 7, 8, 9 and 10 of ten ants pulled (1).
pub const INSTANTS_BY_SIZE: [u64; 5] = [4956, 17_700, 38_777, 46_289, 19_234];
/// The smallest of those groups.
pub const SMALLEST_COUNTED: usize = 6;

/// Share of the instants at which `size` of ten ants pulled, of those with six or more (1).
pub fn share_of_size(size: usize) -> f64 {
    INSTANTS_BY_SIZE[size - SMALLEST_COUNTED] as f64 / INSTANTS_BY_SIZE.iter().sum::<u64>() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of the printed groups is that of a binomial of ten with p = 0.84 that is cut below six: to 0.01, as p has two digits.
    #[test]
    fn printed_groups_have_the_mean_of_a_binomial() {
        let choose = [210.0, 120.0, 45.0, 10.0, 1.0];
        let binomial = |size: usize| choose[size - 6] * 0.84f64.powi(size as i32) * 0.16f64.powi(10 - size as i32);
        let mean = |weight: &dyn Fn(usize) -> f64| {
            let total: f64 = (6..=10).map(weight).sum();
            (6..=10).map(|size| size as f64 * weight(size)).sum::<f64>() / total
        };
        assert!((mean(&share_of_size) - mean(&binomial)).abs() < 0.01);
    }
}
