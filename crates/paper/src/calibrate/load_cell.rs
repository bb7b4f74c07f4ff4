//! Readings of a load cell on a grid of tip positions, as the paper takes and transforms them
//! (Sections III-C and III-D).
//!
//! A stage moves the tip of a spring over a rectangular grid and measures the force on it along x,
//! the axis of the undeformed spring, and along y. At the polar angle theta of the tip about the
//! root, the forces along and across the spring are
//!
//! ```text
//! F_r     =  F_x cos(theta) + F_y sin(theta)
//! F_theta = -F_x sin(theta) + F_y cos(theta)
//! ```
//!
//! Case 1 has the tips on the axis. For cases 2 and 3 F_theta is interpolated along the circles on
//! which the mechanisms of Eq. (2) and (3) lead the tip, where these cross the rows of the grid:
//!
//! ```text
//! case 2, y > 0    (x - l_1)^2 + y^2 = (l_3 + l_5)^2
//! case 3, y < 0    x^2 + y^2 = (l_1 + l_3 + l_5)^2
//! ```

use serde::Serialize;

use super::case::Case;
use super::dimensions::Dimensions;
use super::measurements::{Measurement, Measurements};
use cohaul::formats::{self, Format, Versioned};
use cohaul::math::{Summary, Vec2};
use cohaul::scenario::ScenarioError;
use cohaul_report::table::Table;
use cohaul_studies::csv_input;

const COLUMNS: [&str; 5] = ["trial", "x_m", "y_m", "force_x_n", "force_y_n"];

/// Places of a grid for each reading, above which the readings lie on none (1).
const MOST_NODES_PER_READING: usize = 4;

/// Readings of all trials on one grid.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadCell {
    /// Lines of the grid, from the root along and across the undeformed spring (m).
    xs: Vec<f64>,
    ys: Vec<f64>,
    trials: Vec<GridTrial>,
}

/// Forces along and across the spring at the nodes of the grid (N), row by row of equal y; `None`
/// where nothing was read.
#[derive(Clone, Debug, PartialEq)]
struct GridTrial {
    name: String,
    forces: Vec<Option<Vec2>>,
}

/// What `calibrate grid --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GridReport {
    pub n_trials: usize,
    pub n_x: usize,
    pub n_y: usize,
    pub n_readings: usize,
    /// Readings of each case that are written for `calibrate fit`.
    pub n_of_case: Vec<(Case, usize)>,
    /// Mean over the nodes of the standard deviation between trials, along and across the spring
    /// (N); `null` for one trial.
    pub radial_sd_n: Option<f64>,
    pub tangential_sd_n: Option<f64>,
}

impl Versioned for GridReport {
    const FORMAT: Format = formats::CALIBRATE_GRID;
}

/// A node of the lookup table: force at a tip position, over all trials.
#[derive(Clone, Copy, Debug)]
struct Node {
    place: Vec2,
    radial: Summary,
    tangential: Summary,
}

impl LoadCell {
    /// Reads a table with the columns `trial,x_m,y_m,force_x_n,force_y_n`; `file` is its name in
    /// errors.
    ///
    /// # Errors
    /// When a row is no reading, a tip is on its root, or a node comes twice in a trial.
    pub fn parse(text: &str, file: &str) -> Result<Self, ScenarioError> {
        let mut table = csv_input::Table::parse(text, file, &COLUMNS)?;
        table.require(&COLUMNS);
        let mut table = table.whole()?;
        let mut rows: Vec<(usize, String, Vec2, Vec2)> = Vec::new();
        for row in 0..table.n_rows() {
            let [x, y, force_x, force_y] = ["x_m", "y_m", "force_x_n", "force_y_n"].map(|column| table.number(row, column));
            let (Some(x), Some(y), Some(force_x), Some(force_y)) = (x, y, force_x, force_y) else { continue };
            if x == 0.0 && y == 0.0 {
                table.at(row, "x_m", "must not be on the root, where no direction is along the spring", x);
            }
            rows.push((row, table.text(row, "trial").to_owned(), Vec2::new(x, y), Vec2::new(force_x, force_y)));
        }
        if rows.is_empty() {
            table.report("rows", "must hold readings", "none");
        }
        let lines = |of: fn(&Vec2) -> f64| {
            let mut all: Vec<f64> = rows.iter().map(|(_, _, place, _)| of(place)).collect();
            all.sort_by(f64::total_cmp);
            all.dedup();
            all
        };
        let (xs, ys) = (lines(|place| place.x), lines(|place| place.y));
        let n_nodes = xs.len().saturating_mul(ys.len());
        if n_nodes > MOST_NODES_PER_READING * rows.len() {
            let rule = format!("must lie on a grid, with at most {MOST_NODES_PER_READING} places for each reading");
            table.report("x_m, y_m", &rule, format!("{} x {} places for {} readings", xs.len(), ys.len(), rows.len()));
            table.whole()?;
            unreachable!("a table with a fault is not whole");
        }
        let mut found = Self { xs, ys, trials: Vec::new() };
        for (row, trial, place, force) in rows {
            if !found.add(trial, place, force) {
                table.at(row, "x_m", "must be read once in a trial at each node of the grid", place.x);
            }
        }
        table.whole()?;
        Ok(found)
    }

    /// Adds a reading; `false` if the node has one.
    fn add(&mut self, trial: String, place: Vec2, force: Vec2) -> bool {
        let n = self.xs.len() * self.ys.len();
        let at = self.trials.iter().position(|own| own.name == trial).unwrap_or_else(|| {
            self.trials.push(GridTrial { name: trial, forces: vec![None; n] });
            self.trials.len() - 1
        });
        let line = |lines: &[f64], value: f64| lines.partition_point(|own| *own < value);
        let node = &mut self.trials[at].forces[line(&self.ys, place.y) * self.xs.len() + line(&self.xs, place.x)];
        let along = place.normalize();
        node.replace(Vec2::new(force.dot(&along), along.perp(&force))).is_none()
    }

    /// Forces along and across the spring of a trial at a place between the nodes (N), by bilinear
    /// interpolation; `None` beyond the grid, or beside a node without a reading.
    fn at(&self, trial: &GridTrial, place: Vec2) -> Option<Vec2> {
        let (x, y) = (between(&self.xs, place.x)?, between(&self.ys, place.y)?);
        let mut sum = Vec2::zeros();
        for (column, of_x) in x {
            for (row, of_y) in y {
                // A node without weight may be missing.
                if of_x * of_y > 0.0 {
                    sum += of_x * of_y * trial.forces[row * self.xs.len() + column]?;
                }
            }
        }
        Some(sum)
    }

    /// Readings of the three cases as `calibrate fit` takes them: stretches on the axis, and swings
    /// of the two circles where they cross the rows of the grid.
    pub fn measurements(&self, dimensions: &Dimensions) -> Measurements {
        let design = dimensions.of_material(1.0);
        let (short, link, rest) = (design.short_member_length, design.link_length, design.rest_length());
        let mut found = Measurements::default();
        for trial in &self.trials {
            let mut add = |case: Case, at: f64, place: Vec2| {
                let Some(force) = self.at(trial, place).filter(|_| at.abs() < case.limit(&design)) else { return };
                let force = if case.is_radial() { force.x } else { force.y };
                found.add(case, trial.name.clone(), Measurement { at, force, sd: None });
            };
            self.xs.iter().for_each(|x| add(Case::Radial, x - rest, Vec2::new(*x, 0.0)));
            for y in &self.ys {
                let (case, radius, centre) = if *y > 0.0 { (Case::TangentialTwo, link, short) } else { (Case::TangentialThree, rest, 0.0) };
                if *y != 0.0 && y.abs() < radius {
                    let x = centre + (radius * radius - y * y).sqrt();
                    add(case, y.atan2(x), Vec2::new(x, *y));
                }
            }
        }
        found.trials.sort_by_key(|trial| trial.case);
        found
    }

    /// Nodes that at least one trial has read.
    fn nodes(&self) -> Vec<Node> {
        let node = |at: usize| {
            let forces = || self.trials.iter().filter_map(move |trial| trial.forces[at]);
            let place = Vec2::new(self.xs[at % self.xs.len()], self.ys[at / self.xs.len()]);
            Node { place, radial: Summary::of(forces().map(|force| force.x)), tangential: Summary::of(forces().map(|force| force.y)) }
        };
        (0..self.xs.len() * self.ys.len()).map(node).filter(|node| node.radial.n() > 0).collect()
    }

    /// The lookup table: mean force along and across the spring at each tip position, with the
    /// standard deviation between trials.
    pub fn lookup(&self) -> Table {
        let sd = |of: &Summary| (of.n() > 1).then(|| of.sd());
        Table::of(
            &self.nodes(),
            &[
                ("x", "m", &|node| node.place.x.into()),
                ("y", "m", &|node| node.place.y.into()),
                ("radial force", "N", &|node| node.radial.mean().into()),
                ("radial force sd", "N", &|node| sd(&node.radial).into()),
                ("tangential force", "N", &|node| node.tangential.mean().into()),
                ("tangential force sd", "N", &|node| sd(&node.tangential).into()),
                ("n trials", "", &|node| node.radial.n().into()),
            ],
        )
    }

    pub fn report(&self, measurements: &Measurements) -> GridReport {
        let nodes = self.nodes();
        let sd = |of: fn(&Node) -> Summary| {
            let sds = Summary::of(nodes.iter().map(of).filter(|summary| summary.n() > 1).map(|summary| summary.sd()));
            (sds.n() > 0).then(|| sds.mean())
        };
        let n_of = |case: Case| (case, measurements.of_case(case).map(|trial| trial.points.len()).sum());
        GridReport {
            n_trials: self.trials.len(),
            n_x: self.xs.len(),
            n_y: self.ys.len(),
            n_readings: self.trials.iter().flat_map(|trial| &trial.forces).flatten().count(),
            n_of_case: Case::ALL.map(n_of).to_vec(),
            radial_sd_n: sd(|node| node.radial),
            tangential_sd_n: sd(|node| node.tangential),
        }
    }
}

/// The two lines about a value with their weights; `None` beyond the lines.
fn between(lines: &[f64], value: f64) -> Option<[(usize, f64); 2]> {
    let above = lines.partition_point(|line| *line < value);
    let high = *lines.get(above)?;
    if high == value {
        return Some([(above, 1.0), (above, 0.0)]);
    }
    let low = *lines.get(above.checked_sub(1)?)?;
    let share = (value - low) / (high - low);
    Some([(above - 1, 1.0 - share), (above, share)])
}

/// The readings as the table that `calibrate fit` reads.
pub fn measurement_table(measurements: &Measurements) -> Table {
    let readings: Vec<_> = measurements.trials.iter().flat_map(|trial| trial.points.iter().map(move |point| (trial, point))).collect();
    Table::of(
        &readings,
        &[
            ("case", "", &|(trial, _)| trial.case.name().into()),
            ("trial", "", &|(trial, _)| trial.name.as_str().into()),
            ("displacement", "m", &|(trial, point)| trial.case.is_radial().then_some(point.at).into()),
            ("swing", "rad", &|(trial, point)| (!trial.case.is_radial()).then_some(point.at).into()),
            ("force", "N", &|(_, point)| point.force.into()),
        ],
    )
}
