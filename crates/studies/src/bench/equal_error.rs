//! The cheapest setting of each method at an error.
//!
//! A coarse setting may be exact by coincidence: an event falls on a step, or two errors cancel. So
//! a level of error counts as reached by a setting only if it holds at every finer one of the
//! method too, and what a level costs then never falls with the level.

use serde::Serialize;

use super::work::Row;
use crate::methods::Method;
use cohaul::backend::Setting;

/// Levels of error over the length of the path (1).
pub const LEVELS: [f64; 7] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];

/// What a level of error costs by a method.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EqualError {
    pub scene: String,
    /// Over the length of the path (1).
    pub error: f64,
    pub method: String,
    /// The cheapest setting that reaches it: a step (s) or a tolerance (m). All of them `null`
    /// where none does.
    pub step_s: Option<f64>,
    pub tolerance_m: Option<f64>,
    /// Least CPU time (s).
    pub cpu_s: Option<f64>,
    /// That over the least of all rapier variants (1); `null` where none of those reaches the
    /// level.
    pub over_rapier: Option<f64>,
}

/// Cheapest setting that reaches the level of `error` (1). `rows` are those of one method in one
/// scene, from coarse to fine. Settings without an answer count for nothing; a failed one excludes
/// all coarser ones.
pub fn cheapest<'a>(rows: &[&'a Row], error: f64) -> Option<&'a Row> {
    let holds = |row: &&&Row| !row.is_answered() || row.share.is_some_and(|share| share <= error);
    let reached = rows.iter().rev().take_while(holds).filter_map(|row| Some((*row, row.timing()?.min_s)));
    reached.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(row, _)| row)
}

/// All scenes, levels and methods of `rows`.
pub fn equal_errors(rows: &[Row]) -> Vec<EqualError> {
    let mut scenes: Vec<&str> = rows.iter().map(|row| row.scene.as_str()).collect();
    scenes.dedup();
    let at = |scene: &&str| LEVELS.map(|error| at_level(scene, error, rows));
    scenes.iter().flat_map(at).flatten().collect()
}

fn at_level(scene: &str, error: f64, rows: &[Row]) -> Vec<EqualError> {
    let of = |method: &str| rows.iter().filter(|row| row.scene == scene && row.method == method).collect::<Vec<&Row>>();
    let time = |row: &Row| row.timing().map(|timing| timing.min_s);
    let tried = Method::all().map(|method| (method, of(method.name))).filter(|(_, rows)| !rows.is_empty());
    let found: Vec<_> = tried.map(|(method, rows)| (method, cheapest(&rows, error))).collect();
    let rapier =
        found.iter().filter(|(method, _)| method.kind.reads(Setting::Engine) && !method.is_of_user).filter_map(|(_, row)| time((*row)?));
    let rapier = rapier.min_by(f64::total_cmp);
    let line = |(method, row): &(Method, Option<&Row>)| {
        let cpu_s = row.and_then(time);
        EqualError {
            scene: scene.to_owned(),
            error,
            method: method.name.to_owned(),
            step_s: row.and_then(|row| row.level.step()),
            tolerance_m: row.and_then(|row| row.level.tolerance()),
            cpu_s,
            over_rapier: cpu_s.zip(rapier).map(|(own, rapier)| own / rapier),
        }
    };
    found.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::super::scene::Level;
    use super::super::work::Ending;
    use super::*;

    fn row(method: &str, step: f64, share: Option<f64>, seconds: f64) -> Row {
        Row {
            scene: "scene".to_owned(),
            method: method.to_owned(),
            level: Level::Step(step),
            ending: if share.is_some() { Ending::Converged } else { Ending::Failed },
            errors_m: share.map(|share| [share, share]),
            share,
            n_steps: 1,
            n_solves: 1,
            n_not_converged: 0,
            seconds: vec![seconds],
        }
    }

    fn steps(rows: &[Row], error: f64) -> Option<f64> {
        cheapest(&rows.iter().collect::<Vec<_>>(), error)?.level.step()
    }

    #[test]
    fn a_level_counts_only_where_it_holds_at_every_finer_setting() {
        let mut rows: Vec<Row> = [(8.0, 1e-5, 1.0), (4.0, 4e-3, 2.0), (2.0, 2e-3, 4.0), (1.0, 9e-4, 8.0)]
            .map(|(step, share, seconds)| row("rapier box", step, Some(share), seconds))
            .to_vec();
        // The lucky first one is not the answer at 1e-3, but nothing speaks against it at 1e-2.
        assert_eq!([1e-2, 3e-3, 1e-3, 1e-4].map(|error| steps(&rows, error)), [Some(8.0), Some(2.0), Some(1.0), None]);
        // A failure at the finest setting takes all with it.
        rows.push(row("rapier box", 0.5, None, 16.0));
        assert_eq!(steps(&rows, 1e-2), None);
        // What was not tried says nothing.
        rows[4].ending = Ending::TooLong(1.0);
        assert_eq!(steps(&rows, 3e-3), Some(2.0));
        assert_eq!(steps(&[], 1.0), None);
    }

    #[test]
    fn the_cheapest_setting_that_holds_wins_and_costs_never_fall_with_the_level() {
        // A finer setting may cost less: the solver converges sooner.
        let rows: Vec<Row> = [(4.0, 1e-3, 5.0), (2.0, 5e-4, 3.0), (1.0, 1e-6, 7.0)]
            .map(|(step, share, seconds)| row("rapier box", step, Some(share), seconds))
            .to_vec();
        assert_eq!(steps(&rows, 1e-2), Some(2.0));
        let found = equal_errors(&rows);
        let costs: Vec<f64> = found.iter().filter_map(|line| line.cpu_s).collect();
        assert!(found.len() == LEVELS.len() && costs.len() == 5 && costs.windows(2).all(|pair| pair[0] <= pair[1]), "{costs:?}");
    }

    #[test]
    fn ratios_are_to_the_best_variant_of_rapier() {
        let rows = [
            row("quasi-static", 1.0, Some(1e-4), 1.0),
            row("rapier aligned", 1.0, Some(1e-3), 8.0),
            row("rapier box", 1.0, Some(1e-3), 5.0),
        ];
        let found = equal_errors(&rows);
        let ratio = |error: f64, method: &str| found.iter().find(|line| line.error == error && line.method == method).unwrap().over_rapier;
        assert_eq!(
            [ratio(1e-3, "quasi-static"), ratio(1e-3, "rapier aligned"), ratio(1e-3, "rapier box")],
            [Some(0.2), Some(1.6), Some(1.0)]
        );
        // None of the engine's settings reaches this: there is a cost, but no ratio.
        assert_eq!((ratio(1e-4, "quasi-static"), ratio(1e-4, "rapier box")), (None, None));
    }
}
