//! Tables as Parquet. The same rows of the same build make the same bytes: row groups of a fixed
//! number of rows, one compression, and no time in the file.
//!
//! The metadata of a file says where its rows come from: `cohaul.version`,
//! `cohaul.scenario_sha256`, `cohaul.seed` of a single run, and `cohaul.units`, a JSON object with
//! the unit of each column that has one.

use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::record::Field as Read;
use parquet::schema::types::Type;
use serde_json::{Map, Value};

use crate::json::NotFinite;
use crate::lines::TableError;
use crate::manifest::Manifest;
use crate::table::{Field, Kind};
use cohaul::simulation::run_facts::unit_of;

/// Rows that are in memory at a time.
const ROWS_A_GROUP: usize = 1 << 16;

/// A Parquet file that is written row by row to `out`; an empty field is a null.
pub struct ParquetWriter<'a> {
    columns: Vec<(String, Kind)>,
    rows: Vec<Vec<Field>>,
    writer: SerializedFileWriter<&'a mut (dyn Write + Send)>,
}

impl<'a> ParquetWriter<'a> {
    /// Begins a file with columns of these names and kinds, whose rows come from a run with this
    /// manifest, if it is known.
    ///
    /// # Errors
    /// When a name is no name of a column.
    pub fn new(columns: Vec<(String, Kind)>, manifest: Option<&Manifest>, out: &'a mut (dyn Write + Send)) -> io::Result<Self> {
        let properties = WriterProperties::builder()
            .set_created_by("cohaul".to_owned())
            .set_compression(Compression::SNAPPY)
            .set_key_value_metadata(Some(metadata(&columns, manifest)))
            .build();
        let writer = SerializedFileWriter::new(out, Arc::new(schema(&columns)?), Arc::new(properties))?;
        Ok(Self { columns, rows: Vec::new(), writer })
    }

    /// Adds a row with a field for each column.
    ///
    /// # Errors
    /// When a number is not finite, or `out` fails.
    pub fn add(&mut self, row: Vec<Field>) -> Result<(), TableError> {
        if let Some((path, value)) = self.columns.iter().zip(&row).find_map(|((name, _), field)| Some((name.clone(), field.not_finite()?)))
        {
            return Err(NotFinite { path, value }.into());
        }
        self.rows.push(row);
        if self.rows.len() == ROWS_A_GROUP { Ok(self.write_group()?) } else { Ok(()) }
    }

    /// Writes what is left and ends the file.
    ///
    /// # Errors
    /// When `out` fails.
    pub fn finish(mut self) -> io::Result<()> {
        if !self.rows.is_empty() {
            self.write_group()?;
        }
        self.writer.close()?;
        Ok(())
    }

    /// Writes the rows as one group and forgets them.
    fn write_group(&mut self) -> io::Result<()> {
        let mut group = self.writer.next_row_group()?;
        for (at, (_, kind)) in self.columns.iter().enumerate() {
            let mut target = group.next_column()?.expect("a writer a column");
            let fields = self.rows.iter().map(|row| &row[at]);
            match kind {
                // Parquet keeps the bits of an unsigned number in a signed one.
                Kind::Whole => write_column::<Int64Type>(fields, |field| whole(field).map(|value| value as i64), &mut target)?,
                Kind::Number => write_column::<DoubleType>(fields, Field::number, &mut target)?,
                Kind::Word => write_column::<ByteArrayType>(fields, word, &mut target)?,
                Kind::Truth => write_column::<BoolType>(fields, truth, &mut target)?,
            }
            target.close()?;
        }
        group.close()?;
        self.rows.clear();
        Ok(())
    }
}

/// The text of a CSV table with the rows of a Parquet file. Fields without a value are empty.
///
/// # Errors
/// When the bytes are no Parquet file, or it has columns of lists or tables, in words.
pub fn csv_of_parquet(bytes: Vec<u8>) -> Result<String, String> {
    let in_words = |error: ParquetError| error.to_string();
    let reader = SerializedFileReader::new(bytes::Bytes::from(bytes)).map_err(in_words)?;
    let columns = reader.metadata().file_metadata().schema().get_fields().to_vec();
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(columns.iter().map(|column| column.name())).map_err(|error| error.to_string())?;
    for row in reader.get_row_iter(None).map_err(in_words)? {
        let row = row.map_err(in_words)?;
        let fields = row.get_column_iter().map(|(name, field)| match field {
            Read::Null => Ok(String::new()),
            Read::Str(text) => Ok(text.clone()),
            Read::Group(_) | Read::ListInternal(_) | Read::MapInternal(_) => Err(format!("column {name} must have one value a row")),
            Read::Float(number) => Ok(number.to_string()),
            Read::Double(number) => Ok(number.to_string()),
            other => Ok(other.to_string()),
        });
        writer.write_record(fields.collect::<Result<Vec<_>, _>>()?).map_err(|error| error.to_string())?;
    }
    let text = writer.into_inner().map_err(|error| error.to_string())?;
    String::from_utf8(text).map_err(|error| error.to_string())
}

/// Metadata of a file with these columns.
fn metadata(columns: &[(String, Kind)], manifest: Option<&Manifest>) -> Vec<KeyValue> {
    let units: Map<String, Value> =
        columns.iter().map(|(name, _)| (name.clone(), Value::from(unit_of(name)))).filter(|(_, unit)| unit.as_str() != Some("")).collect();
    let entry = |key: &str, value: String| KeyValue::new(format!("cohaul.{key}"), value);
    let mut entries = vec![entry("units", Value::Object(units).to_string())];
    if let Some(manifest) = manifest {
        entries.push(entry("version", manifest.version.to_owned()));
        entries.push(entry("scenario_sha256", manifest.scenario_sha256.clone()));
        entries.extend(manifest.seed.map(|seed| entry("seed", seed.to_string())));
    }
    entries
}

fn schema(columns: &[(String, Kind)]) -> Result<Type, ParquetError> {
    let field = |(name, kind): &(String, Kind)| {
        let (physical, logical) = match kind {
            Kind::Whole => (Physical::INT64, Some(LogicalType::integer(64, false))),
            Kind::Number => (Physical::DOUBLE, None),
            Kind::Word => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Kind::Truth => (Physical::BOOLEAN, None),
        };
        let builder = Type::primitive_type_builder(name, physical).with_repetition(Repetition::OPTIONAL);
        builder.with_logical_type(logical).build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<_, _>>()?;
    Type::group_type_builder("runs").with_fields(fields).build()
}

fn whole(field: &Field) -> Option<u64> {
    if let Field::Whole(value) = field { Some(*value) } else { None }
}

fn word(field: &Field) -> Option<ByteArray> {
    if let Field::Word(value) = field { Some(value.as_str().into()) } else { None }
}

fn truth(field: &Field) -> Option<bool> {
    if let Field::Truth(value) = field { Some(*value) } else { None }
}

/// Levels are 1 where there is a value.
fn write_column<'a, T: DataType>(
    fields: impl Iterator<Item = &'a Field>,
    of: impl Fn(&Field) -> Option<T::T>,
    target: &mut SerializedColumnWriter,
) -> Result<(), ParquetError> {
    let values: Vec<Option<T::T>> = fields.map(of).collect();
    let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
    let values: Vec<T::T> = values.into_iter().flatten().collect();
    target.typed::<T>().write_batch(&values, Some(&levels), None).map(drop)
}

#[cfg(test)]
mod tests {

    use super::*;
    use crate::synthetic::manifest;

    fn written(rows: &[Vec<Field>]) -> Vec<u8> {
        let columns = [("cell", Kind::Whole), ("x_m", Kind::Number), ("cause", Kind::Word), ("arrived", Kind::Truth)];
        let mut bytes = Vec::new();
        let mut writer =
            ParquetWriter::new(columns.map(|(name, kind)| (name.to_owned(), kind)).to_vec(), Some(&manifest()), &mut bytes).unwrap();
        rows.iter().for_each(|row| writer.add(row.clone()).unwrap());
        writer.finish().unwrap();
        bytes
    }

    #[test]
    fn every_field_reads_back_and_equal_rows_are_equal_bytes() {
        let rows = [
            vec![u64::MAX.into(), (0.1 + 0.2).into(), "a, b".into(), true.into()],
            vec![1_u64.into(), (-5e-324).into(), Field::Empty, false.into()],
            vec![2_u64.into(), Field::Empty, "plain".into(), Field::Empty],
        ];
        let bytes = written(&rows);
        assert_eq!(bytes, written(&rows));
        let reader = SerializedFileReader::new(bytes::Bytes::from(bytes)).unwrap();
        let rows: Vec<Vec<Read>> = reader
            .get_row_iter(None)
            .unwrap()
            .map(|row| row.unwrap().get_column_iter().map(|(_, field)| field.clone()).collect())
            .collect();
        assert_eq!(rows[0], [Read::ULong(u64::MAX), Read::Double(0.1 + 0.2), Read::Str("a, b".into()), Read::Bool(true)]);
        assert_eq!(rows[1], [Read::ULong(1), Read::Double(-5e-324), Read::Null, Read::Bool(false)]);
        assert_eq!(rows[2], [Read::ULong(2), Read::Null, Read::Str("plain".into()), Read::Null]);
        assert_eq!(reader.metadata().file_metadata().created_by(), Some("cohaul"));
        let entries = reader.metadata().file_metadata().key_value_metadata().unwrap();
        let entry = |key: &str| entries.iter().find(|entry| entry.key == key).and_then(|entry| entry.value.clone());
        assert_eq!(entry("cohaul.units").as_deref(), Some("{\"x_m\":\"m\"}"));
        assert_eq!(entry("cohaul.version").as_deref(), Some(env!("CARGO_PKG_VERSION")));
        assert_eq!(entry("cohaul.scenario_sha256"), Some(manifest().scenario_sha256));
        assert_eq!(entry("cohaul.seed"), manifest().seed.map(|seed| seed.to_string()));
    }

    #[test]
    fn a_row_more_than_a_group_begins_the_next() {
        let rows: Vec<Vec<Field>> = (0..=ROWS_A_GROUP).map(|cell| vec![cell.into(), Field::Empty, Field::Empty, Field::Empty]).collect();
        let reader = SerializedFileReader::new(bytes::Bytes::from(written(&rows))).unwrap();
        let counts: Vec<i64> = reader.metadata().row_groups().iter().map(|group| group.num_rows()).collect();
        assert_eq!(counts, [ROWS_A_GROUP as i64, 1]);
    }
}
