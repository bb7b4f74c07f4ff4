//! The part of a run in which a phase change is looked for.
//!
//! While the team gathers, the sum of the interaction forces begins at zero, and can only rise.
//! Near the nest the direction to it turns fast, and the load with it. A test that contains these
//! ends finds both in every run, with phases or without. The window leaves them out by a rule that
//! does not look at the three series.

use cohaul::math::Vec2;
use cohaul::simulation::Row;

/// Distance of the load from the nest at which the window ends (m): two and a half times the
/// diameter of the load, so that the direction to the nest turns by less than 23 degrees while the
/// load moves by its diameter.
pub const END_BEFORE_NEST_M: f64 = 0.06;

/// Rows from the first at which `n_pulling` ants pull, up to the first behind it at which the load
/// is within 60 mm of the `nest` (m); up to the last row without a nest. Empty where so many never
/// pull at once.
pub fn window(rows: &[Row], n_pulling: usize, nest: Option<Vec2>) -> &[Row] {
    let first = rows.iter().position(|row| row.tips.len() >= n_pulling).unwrap_or(rows.len());
    let rows = &rows[first..];
    let is_near = |row: &Row| nest.is_some_and(|nest| (row.motion.pose.position - nest).norm() <= END_BEFORE_NEST_M);
    &rows[..rows.iter().position(is_near).unwrap_or(rows.len())]
}

/// Number of ants that pull once a team of unknown size has gathered: the median over the rows in
/// which any pulls (1).
pub fn gathered(rows: &[Row]) -> usize {
    let mut sizes: Vec<usize> = rows.iter().map(|row| row.tips.len()).filter(|n| *n > 0).collect();
    sizes.sort_unstable();
    sizes.get(sizes.len() / 2).copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::{BLOCK, Changes, PhaseSign, Series};
    use cohaul::backend::{EnergyLedger, Motion};
    use cohaul::math::{Pose, RandomStreams, Stream, Twist};
    use cohaul::simulation::{AttachedTip, AttachedTips};

    const PERIOD: f64 = 0.1;
    const NEST: Vec2 = Vec2::new(0.3, 0.0);

    /// A run of four ants without phases: they gather one after another in the first 12 s, the load
    /// goes 0.3 m to the nest at a speed that drifts about its mean, and within 50 mm of the nest
    /// it swings round.
    fn run(seed: u64) -> Vec<Row> {
        let streams = RandomStreams::new(seed);
        let normal = |what: u32, at: usize| streams.normal_pair(Stream::Scene, what, at as u64).x;
        let (mut x, mut heading, mut rows, mut slow) = (0.0, 0.0, Vec::new(), [0.0; 6]);
        for at in 0..900 {
            slow.iter_mut().enumerate().for_each(|(k, value)| *value = 0.8 * *value + 0.5 * normal(k as u32, at));
            let n_pulling = (1 + at / 40).min(4);
            let tip = |k: usize| {
                let outwards = Vec2::new([0.03, 0.0, -0.03, 0.0][k], [0.0, 0.03, 0.0, -0.03][k]);
                let pull = (6e-3 + 2e-3 * slow[k]) * outwards / 0.03;
                AttachedTip { spring: k, position: Vec2::new(x, 0.0) + outwards, pull }
            };
            rows.push(Row {
                time: PERIOD * at as f64,
                motion: Motion { pose: Pose::new(x, 0.0, heading), twist: Twist::default() },
                energy: EnergyLedger::default(),
                tips: AttachedTips::from_vec((0..n_pulling).map(tip).collect()),
                contacts: Vec::new(),
                steered: Vec::new(),
                error: None,
            });
            x += 3.4e-4 * (1.0 + 0.3 * slow[4]);
            let is_swinging = (NEST.x - x).abs() < 0.05;
            heading += (0.02 + 0.01 * slow[5]).abs() * if is_swinging { 3.0 } else { 1.0 };
        }
        rows
    }

    fn whole(rows: &[Row]) -> &[Row] {
        rows
    }

    fn fair(rows: &[Row]) -> &[Row] {
        window(rows, 4, Some(NEST))
    }

    fn n_found(of: fn(&[Row]) -> &[Row], sign: PhaseSign) -> usize {
        let n = |seed: u64| {
            let rows = run(seed);
            sign.is_in(&Changes::of(&Series::of_rows(of(&rows), PERIOD, 1), seed)).unwrap()
        };
        (0..200).filter(|seed| n(4000 + seed)).count()
    }

    /// Whole runs show a turn rate that rises, and interaction forces that rise and never fall,
    /// although they have no phases. In the window each sign comes by chance, in 2.5 % of runs and
    /// 5 % for all at once, up to three standard deviations: 12 and 19 of 200.
    #[test]
    fn a_gathering_and_a_swing_are_no_phases() {
        assert!(n_found(whole, PhaseSign::TurnRateRises) > 150);
        assert_eq!(n_found(whole, PhaseSign::InteractionFalls), 0);
        for sign in [PhaseSign::SpeedRises, PhaseSign::TurnRateRises, PhaseSign::InteractionFalls] {
            let n = n_found(fair, sign);
            assert!(n <= 12, "{sign:?}: {n}");
        }
        assert!(n_found(fair, PhaseSign::AllAtOnce) <= 19);
    }

    #[test]
    fn the_window_begins_with_the_team_and_ends_before_the_nest() {
        let rows = run(1);
        let found = window(&rows, 4, Some(NEST));
        assert!((found[0].time - 12.0).abs() < 1e-9, "{}", found[0].time);
        let last = found.last().unwrap().motion.pose.position.x;
        // One step is at most a millimetre.
        assert!((NEST.x - last - END_BEFORE_NEST_M).abs() < 1e-3 && found.len() > 4 * BLOCK * 5);
        assert_eq!(window(&rows, 4, None).len(), rows.len() - 120);
        assert!(window(&rows, 5, None).is_empty() && window(&[], 0, None).is_empty());
        assert_eq!((gathered(&rows), gathered(&rows[..100]), gathered(&[])), (4, 2, 0));
    }
}
