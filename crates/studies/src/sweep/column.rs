//! Columns, fields and lines of the table. The line of a run is written once, where the run ends;
//! every later step copies it.

use serde::{Deserialize, Serialize};

use super::error::SweepError;
use cohaul::scenario::cut;
use cohaul::simulation::run_facts;
use cohaul_report::table::{Field, Kind};

/// A column of the table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// Name, which ends in the unit.
    pub name: String,
    pub kind: Kind,
}

impl Column {
    pub fn new(name: impl Into<String>, kind: Kind) -> Self {
        Self { name: name.into(), kind }
    }
}

/// Kind of the column of a number of a run.
fn kind_of(fact: &run_facts::Fact) -> Kind {
    match fact.kind {
        run_facts::Kind::Number => Kind::Number,
        run_facts::Kind::Count => Kind::Whole,
        run_facts::Kind::Flag => Kind::Truth,
    }
}

/// Field with the value of a number of a run.
pub fn field_of(value: run_facts::Value) -> Field {
    match value {
        run_facts::Value::Absent | run_facts::Value::Undefined => Field::Empty,
        run_facts::Value::Number(value) => Field::Number(value),
        run_facts::Value::Count(value) => Field::Whole(value),
        run_facts::Value::Flag(value) => Field::Truth(value),
    }
}

/// Columns before the parameters.
pub const BEFORE: [(&str, Kind); 3] = [("cell", Kind::Whole), ("key", Kind::Word), ("point", Kind::Whole)];
/// Columns between parameters and measures.
const BETWEEN: [(&str, Kind); 5] =
    [("backend", Kind::Word), ("step_s", Kind::Number), ("seed", Kind::Whole), ("status", Kind::Word), ("cause", Kind::Word)];

/// Columns of the inertia estimate, which quasi-static runs alone have: largest edge displacement
/// (m), the same over the path length (1), and whether the model behind it is valid.
pub const ESTIMATE: [(&str, Kind); 3] =
    [("inertia_estimate_m", Kind::Number), ("inertia_estimate_share", Kind::Number), ("inertia_estimate_is_valid", Kind::Truth)];

/// The numbers of a run that have a column.
pub fn facts() -> impl Iterator<Item = &'static run_facts::Fact> {
    run_facts::FACTS.iter().filter(|fact| !fact.column.is_empty())
}

/// All columns, with those of `parameters` in place.
pub fn columns(parameters: Vec<Column>, most_attached: usize, can_be_more: bool) -> Vec<Column> {
    let fixed = |columns: &[(&str, Kind)]| columns.iter().map(|(name, kind)| Column::new(*name, *kind)).collect::<Vec<_>>();
    let measured = facts().map(|fact| Column::new(fact.column, kind_of(fact))).collect();
    let shares = (0..=most_attached).map(|n| {
        let or_more = if n == most_attached && can_be_more { "_or_more" } else { "" };
        Column::new(format!("time_share_{n}{or_more}_attached"), Kind::Number)
    });
    [fixed(&BEFORE), parameters, fixed(&BETWEEN), measured, fixed(&ESTIMATE), shares.collect()].concat()
}

/// Text of a field with all its digits, and without quotes.
pub fn text_of(field: &Field) -> String {
    match field {
        Field::Word(word) => word.clone(),
        field => line_of(std::slice::from_ref(field)),
    }
}

/// The fields as a line of the table, without its end.
pub fn line_of(fields: &[Field]) -> String {
    let mut line = String::with_capacity(16 * fields.len());
    for (at, field) in fields.iter().enumerate() {
        if at > 0 {
            line.push(',');
        }
        field.write(&mut line);
    }
    line
}

/// The names of the columns as a line.
pub fn head_of(columns: &[Column]) -> String {
    line_of(&columns.iter().map(|column| Field::Word(column.name.clone())).collect::<Vec<_>>())
}

/// Longest part of a line in a message (characters).
const LONGEST_LINE: usize = 500;

/// Fields of a line.
///
/// # Errors
/// When the line does not fit the columns.
pub fn fields_of(line: &str, columns: &[Column]) -> Result<Vec<Field>, SweepError> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).buffer_capacity(line.len().max(1)).from_reader(line.as_bytes());
    let record = reader.records().next().and_then(Result::ok).filter(|record| record.len() == columns.len());
    let parse = |record: csv::StringRecord| record.iter().zip(columns).map(|(text, column)| Field::parse(text, column.kind)).collect();
    record.and_then(parse).ok_or_else(|| SweepError::Line(cut(line.to_owned(), LONGEST_LINE)))
}

/// Rows of a table, read line by line in the order of cells.
pub trait Table {
    /// Calls `visit` with every line, without its end.
    ///
    /// # Errors
    /// When the table cannot be read, or `visit` fails.
    fn visit(&self, visit: &mut dyn FnMut(&str) -> Result<(), SweepError>) -> Result<(), SweepError>;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_reads_back_as_it_was() {
        let kinds = [Kind::Whole, Kind::Number, Kind::Word, Kind::Word, Kind::Truth, Kind::Number, Kind::Word];
        let columns: Vec<Column> = kinds.iter().map(|kind| Column::new("a,b", *kind)).collect();
        let fields = vec![
            Field::Whole(u64::MAX),
            Field::Number(0.1 + 0.2),
            Field::Word("says \"no\", twice".into()),
            Field::Word("plain".into()),
            Field::Truth(false),
            Field::Empty,
            Field::Word("\"".into()),
        ];
        let line = line_of(&fields);
        assert_eq!(line, "18446744073709551615,0.30000000000000004,\"says \"\"no\"\", twice\",plain,false,,\"\"\"\"");
        assert_eq!(fields_of(&line, &columns).unwrap(), fields);
    }

    #[test]
    fn a_line_that_does_not_fit_is_refused() {
        let columns = [Column::new("n", Kind::Whole), Column::new("x", Kind::Number)];
        for line in ["1", "1,2,3", "x,2", "1,NaN", "-1,2", "\"1,2", "\"1\"x,2"] {
            assert!(fields_of(line, &columns).is_err(), "{line}");
        }
    }
}
