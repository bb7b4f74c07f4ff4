//! Forces against displacements, trial by trial.
//!
//! A trial is one loading of one spring in one case. Equal names in different cases belong to
//! different trials.

use super::case::Case;
use super::dimensions::Dimensions;
use cohaul::scenario::ScenarioError;
use cohaul_studies::csv_input::Table;

const COLUMNS: [&str; 6] = ["case", "trial", "displacement_m", "swing_rad", "force_n", "force_sd_n"];

/// One reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Stretch of the spring (m), or polar angle of its tip about the root (rad).
    pub at: f64,
    /// Along the spring, or across it (N).
    pub force: f64,
    /// Standard deviation of the force (N).
    pub sd: Option<f64>,
}

/// One loading, in the order of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    pub case: Case,
    pub name: String,
    pub points: Vec<Measurement>,
}

/// All trials of a file, case by case. Either every point has an error bar or none has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measurements {
    pub trials: Vec<Trial>,
}

impl Measurements {
    /// Reads measurements from the text of a table; `file` is its name in errors.
    ///
    /// # Errors
    /// When any row cannot be a measurement of a spring with these dimensions.
    pub fn parse(text: &str, file: &str, dimensions: &Dimensions) -> Result<Self, ScenarioError> {
        let mut table = Table::parse(text, file, &COLUMNS)?;
        table.require(&["case", "trial", "force_n"]);
        if !table.has("displacement_m") && !table.has("swing_rad") {
            table.report("header", "must have displacement_m of radial rows, swing_rad of tangential ones", "neither");
        }
        let mut table = table.whole()?;
        let mut found = Self::default();
        for row in 0..table.n_rows() {
            if let Some((case, point)) = reading(&mut table, row, dimensions) {
                found.add(case, table.text(row, "trial").to_owned(), point);
            }
        }
        let mut table = table.whole()?;
        found.trials.sort_by_key(|trial| trial.case);
        found.report_too_few(&mut table);
        table.whole()?;
        Ok(found)
    }

    pub fn of_case(&self, case: Case) -> impl Iterator<Item = &Trial> {
        self.trials.iter().filter(move |trial| trial.case == case)
    }

    pub fn has_sds(&self) -> bool {
        self.trials.iter().flat_map(|trial| &trial.points).all(|point| point.sd.is_some())
    }

    /// Adds a point to the trial of this name in this case.
    pub fn add(&mut self, case: Case, name: String, point: Measurement) {
        match self.trials.iter_mut().find(|trial| trial.case == case && trial.name == name) {
            Some(trial) => trial.points.push(point),
            None => self.trials.push(Trial { case, name, points: vec![point] }),
        }
    }

    /// Reports cases with fewer than two points away from zero, which give no error of a slope.
    fn report_too_few(&self, table: &mut Table) {
        if self.trials.is_empty() {
            table.report("rows", "must hold measurements", "none");
        }
        for case in Case::ALL {
            let away = self.of_case(case).flat_map(|trial| &trial.points).filter(|point| point.at != 0.0).count();
            if self.of_case(case).next().is_some() && away < 2 {
                let rule = "must have two points or more away from zero displacement";
                table.report(format_args!("case {}", case.name()), rule, away);
            }
        }
    }
}

/// The reading in a row; faults are reported.
fn reading(table: &mut Table, row: usize, dimensions: &Dimensions) -> Option<(Case, Measurement)> {
    let case = Case::named(table.text(row, "case"));
    if case.is_none() {
        let found = table.text(row, "case").to_owned();
        table.at(row, "case", "must be radial, tangential-2 or tangential-3 (or the number of its equation)", found);
    }
    if table.is_empty_at(row, "trial") {
        table.at(row, "trial", "must have a name", "nothing");
    }
    let (force, sd) = (table.number(row, "force_n"), error_bar(table, row));
    let case = case?;
    let at = displacement(table, row, case, dimensions);
    Some((case, Measurement { at: at?, force: force?, sd: sd? }))
}

/// The error bar. `Some(None)` in a file without error bars; `None` after a fault.
fn error_bar(table: &mut Table, row: usize) -> Option<Option<f64>> {
    if !table.has("force_sd_n") {
        return Some(None);
    }
    let sd = table.number(row, "force_sd_n")?;
    if sd <= 0.0 {
        table.at(row, "force_sd_n", "must be positive (leave the column out where errors are not known)", sd);
    }
    Some(Some(sd))
}

/// The displacement of the case, if its mechanism allows it.
fn displacement(table: &mut Table, row: usize, case: Case, dimensions: &Dimensions) -> Option<f64> {
    let (own, other) = if case.is_radial() { ("displacement_m", "swing_rad") } else { ("swing_rad", "displacement_m") };
    if !table.is_empty_at(row, other) {
        let found = table.text(row, other).to_owned();
        table.at(row, other, &format!("must be empty in a row of case {}, which goes by {own}", case.name()), found);
    }
    let at = table.number(row, own)?;
    let limit = case.limit(&dimensions.of_material(1.0));
    if at.abs() < limit {
        return Some(at);
    }
    let rule = match case {
        Case::Radial => format!("must be below {limit:.4} m, twice the folded length, where members are straight (is it in millimetres?)"),
        _ => format!("must be below {limit:.4} rad, where a pivot has made a quarter turn (is it in degrees?)"),
    };
    table.at(row, own, &rule, at);
    None
}
