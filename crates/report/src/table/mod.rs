//! Tables: columns with a name and a unit over rows of fields. One table becomes aligned text,
//! Markdown, CSV, JSON, Parquet or, in a [`page`](crate::page), HTML.
//!
//! ```
//! use cohaul_report::table::Table;
//!
//! struct Run { backend: &'static str, path_m: f64, n_steps: u64 }
//! let runs = [Run { backend: "inertial", path_m: 0.01234, n_steps: 4000 }];
//! let table = Table::of(&runs, &[
//!     ("backend", "", &|run| run.backend.into()),
//!     ("path length", "m", &|run| run.path_m.into()),
//!     ("steps", "", &|run| run.n_steps.into()),
//! ]);
//! assert_eq!(table.text(), "  backend   path length  steps\n  inertial     12.34 mm   4000\n");
//! let mut csv = Vec::new();
//! table.write_csv(&mut csv).unwrap();
//! assert_eq!(csv, b"backend,path_length_m,steps\ninertial,0.01234,4000\n");
//! ```
//!
//! A table of words is written row by row: `Table::new("Times", ["ants", "time"]).row(["4", "78
//! s"])`. Without names of columns it is a list: `Table::list().row(["seed", "7"])`.

mod field;
mod layout;
#[cfg(feature = "parquet")]
mod parquet;
mod text;

use std::io::Write;

use serde::{Serialize, Serializer};

use crate::json::{self, NotFinite};
use crate::lines::TableError;

pub use field::{Field, Kind};
pub use layout::Layout;
pub use layout::folded;
#[cfg(feature = "parquet")]
pub use parquet::{ParquetWriter, csv_of_parquet};
pub use text::wrapped;

/// Columns over rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    pub caption: String,
    pub columns: Vec<Column>,
    /// Fields of each row, one a column; a short row ends in empty fields.
    pub rows: Vec<Vec<Field>>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// What people read above the column.
    pub name: String,
    /// SI unit of the numbers; empty where there is none.
    pub unit: &'static str,
}

/// A column with the function that takes its field from a row: name, unit, getter.
pub type Getter<'a, T> = (&'a str, &'static str, &'a dyn Fn(&T) -> Field);

impl Table {
    /// A table of these columns without units, still without rows.
    pub fn new<S: Into<String>>(caption: impl Into<String>, names: impl IntoIterator<Item = S>) -> Self {
        let columns = names.into_iter().map(|name| Column { name: name.into(), unit: "" }).collect();
        Self { caption: caption.into(), columns, rows: Vec::new() }
    }

    /// A table whose columns have no names, for text.
    pub fn list() -> Self {
        Self::default()
    }

    /// A table with a row for each of `rows`.
    pub fn of<T>(rows: &[T], columns: &[Getter<T>]) -> Self {
        Self {
            caption: String::new(),
            columns: columns.iter().map(|(name, unit, _)| Column { name: (*name).to_owned(), unit }).collect(),
            rows: rows.iter().map(|row| columns.iter().map(|(.., get)| get(row)).collect()).collect(),
        }
    }

    pub fn titled(self, caption: impl Into<String>) -> Self {
        Self { caption: caption.into(), ..self }
    }

    pub fn row<F: Into<Field>>(mut self, fields: impl IntoIterator<Item = F>) -> Self {
        self.push(fields);
        self
    }

    pub fn with_rows<F: Into<Field>>(mut self, rows: impl IntoIterator<Item = impl IntoIterator<Item = F>>) -> Self {
        rows.into_iter().for_each(|row| self.push(row));
        self
    }

    pub fn push<F: Into<Field>>(&mut self, fields: impl IntoIterator<Item = F>) {
        self.rows.push(fields.into_iter().map(Into::into).collect());
    }

    /// Writes the table as CSV, under the file names of the columns.
    ///
    /// # Errors
    /// When a number is not finite, or `out` fails.
    pub fn write_csv(&self, out: impl Write) -> Result<(), TableError> {
        let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(out);
        let names: Vec<String> = self.columns.iter().map(Column::file_name).collect();
        writer.write_record(&names)?;
        for row in &self.rows {
            if let Some((path, value)) = names.iter().zip(row).find_map(|(name, field)| Some((name.clone(), field.not_finite()?))) {
                return Err(NotFinite { path, value }.into());
            }
            writer.serialize(row)?;
        }
        Ok(writer.flush()?)
    }

    /// Writes the table as Parquet, under the file names of the columns. The metadata have no run.
    ///
    /// # Errors
    /// When a number is not finite, or `out` fails.
    #[cfg(feature = "parquet")]
    pub fn write_parquet(&self, out: &mut (dyn Write + Send)) -> Result<(), TableError> {
        let kind = |at: usize| self.rows.iter().find_map(|row| row[at].kind()).unwrap_or(Kind::Number);
        let columns: Vec<(String, Kind)> = self.columns.iter().enumerate().map(|(at, column)| (column.file_name(), kind(at))).collect();
        let mut writer = ParquetWriter::new(columns, None, out)?;
        self.rows.iter().try_for_each(|row| writer.add(row.clone()))?;
        Ok(writer.finish()?)
    }
}

/// A list of objects, one a row, whose keys are the file names of the columns.
impl Serialize for Table {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let names: Vec<String> = self.columns.iter().map(Column::file_name).collect();
        serializer.collect_seq(self.rows.iter().map(|row| Object(&names, row)))
    }
}

/// A row with the names of its fields.
struct Object<'a>(&'a [String], &'a [Field]);

impl Serialize for Object<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().zip(self.1))
    }
}

impl Column {
    /// Name in a file, which ends in the unit: `path_length_m` of `path length` in `m`.
    pub fn file_name(&self) -> String {
        let unit = self.unit.replace([' ', '^'], "").replace('/', "_per_").to_lowercase();
        let name = self.name.replace([' ', '-'], "_");
        if unit.is_empty() { name } else { format!("{name}_{unit}") }
    }
}

/// The text of a CSV table with the rows of a Parquet file: no build without that feature has it.
///
/// # Errors
/// Always.
#[cfg(not(feature = "parquet"))]
pub fn csv_of_parquet(_bytes: Vec<u8>) -> Result<String, String> {
    Err("this build reads no Parquet files".to_owned())
}

/// Writes `rows` as CSV whose columns are the fields of the rows.
///
/// # Errors
/// When a number is not finite, or `out` fails.
pub fn write_rows<T: Serialize>(rows: impl IntoIterator<Item = T>, out: impl Write) -> Result<(), TableError> {
    let mut writer = csv::Writer::from_writer(out);
    for row in rows {
        json::check(&row)?;
        writer.serialize(row)?;
    }
    Ok(writer.flush()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let rows = [("a, b", Some(0.1 + 0.2), 7_usize), ("c|d", None, 12)];
        Table::of(
            &rows,
            &[("name", "", &|row| row.0.into()), ("release speed", "m/s", &|row| row.1.into()), ("n", "", &|row| row.2.into())],
        )
    }

    #[test]
    fn files_have_every_digit_and_the_unit_in_the_name() {
        let mut out = Vec::new();
        table().write_csv(&mut out).unwrap();
        assert_eq!(String::from_utf8(out).unwrap(), "name,release_speed_m_per_s,n\n\"a, b\",0.30000000000000004,7\nc|d,,12\n");
        let mut broken = table();
        broken.rows[1][1] = Field::Number(f64::NAN);
        assert!(broken.write_csv(Vec::new()).unwrap_err().to_string().starts_with("release_speed_m_per_s is NaN"));
    }

    #[test]
    fn text_and_markdown_are_for_people() {
        assert_eq!(table().text(), "  name  release speed   n\n  a, b     300.0 mm/s   7\n  c|d               -  12\n");
        let markdown = "| name | release speed | n |\n|---|---:|---:|\n| a, b | 300.0 mm/s | 7 |\n| c\\|d | - | 12 |\n";
        assert_eq!(table().markdown(), markdown);
        let list = Table::list().row(["seed", "7"]).row(["backend", "inertial"]);
        assert_eq!(list.text(), "  seed     7\n  backend  inertial\n");
    }

    #[test]
    fn long_last_columns_wrap_to_the_width_of_a_terminal() {
        let long = "a warning of many words ".repeat(8);
        let text = Table::list().row(["warning", long.as_str()]).row(["seed", "7"]).text();
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
        assert_eq!(text.split_whitespace().collect::<Vec<_>>().join(" "), format!("warning {} seed 7", long.trim()));
        assert!(text.lines().nth(1).unwrap().starts_with("           "), "{text}");
    }

    #[cfg(feature = "parquet")]
    #[test]
    fn a_table_is_read_back_from_parquet() {
        use ::parquet::file::reader::{FileReader, SerializedFileReader};
        let mut bytes = Vec::new();
        table().write_parquet(&mut bytes).unwrap();
        let reader = SerializedFileReader::new(bytes::Bytes::from(bytes)).unwrap();
        let rows: Vec<String> = reader.get_row_iter(None).unwrap().map(|row| row.unwrap().to_string()).collect();
        assert_eq!(rows[1], "{name: \"c|d\", release_speed_m_per_s: null, n: 12}");
    }
}
