//! The table of a sweep as Parquet. The same rows make the same bytes: row groups of a fixed number of rows, one compression, and no version or time of anything.

use std::io::{self, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;

use crate::studies::sweep::{Column, Field, Kind, SweepError, Table, fields_of};

/// Rows that are in memory at a time.
pub const ROWS_A_GROUP: usize = 1 << 16;

/// Writes all rows of `table`; an empty field is a null.
///
/// # Errors
/// When the table cannot be read, or `out` fails.
pub fn write_parquet(columns: &[Column], table: &dyn Table, out: &mut dyn Write) -> Result<(), SweepError> {
    let schema = Arc::new(schema(columns).map_err(failed)?);
    let properties = WriterProperties::builder().set_created_by("cohaul".to_owned()).set_compression(Compression::SNAPPY).build();
    let written = Written::default();
    let mut writer = SerializedFileWriter::new(written.clone(), schema, Arc::new(properties)).map_err(failed)?;
    let mut rows: Vec<Vec<Field>> = Vec::new();
    table.visit(&mut |line| {
        let fields = fields_of(line, columns);
        rows.push(fields.ok_or_else(|| SweepError::Output(format!("a row does not fit the table's columns: {line}")))?);
        if rows.len() == ROWS_A_GROUP {
            write_group(columns, &mut rows, &mut writer).map_err(failed)?;
            written.pass_on(out)?;
        }
        Ok(())
    })?;
    if !rows.is_empty() {
        write_group(columns, &mut rows, &mut writer).map_err(failed)?;
    }
    writer.close().map_err(failed)?;
    written.pass_on(out)
}

fn failed(error: impl ToString) -> SweepError {
    SweepError::Output(error.to_string())
}

fn schema(columns: &[Column]) -> Result<Type, ParquetError> {
    let field = |column: &Column| {
        let (physical, logical) = match column.kind {
            Kind::Whole => (Physical::INT64, Some(LogicalType::integer(64, false))),
            Kind::Number => (Physical::DOUBLE, None),
            Kind::Word => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Kind::Truth => (Physical::BOOLEAN, None),
        };
        let builder = Type::primitive_type_builder(&column.name, physical).with_repetition(Repetition::OPTIONAL);
        builder.with_logical_type(logical).build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<_, _>>()?;
    Type::group_type_builder("runs").with_fields(fields).build()
}

/// Writes rows as one group and forgets them.
fn write_group(columns: &[Column], rows: &mut Vec<Vec<Field>>, writer: &mut SerializedFileWriter<Written>) -> Result<(), ParquetError> {
    let mut group = writer.next_row_group()?;
    for (at, column) in columns.iter().enumerate() {
        let mut target = group.next_column()?.expect("a writer a column");
        let fields = rows.iter().map(|row| &row[at]);
        match column.kind {
            // Parquet keeps the bits of an unsigned number in a signed one.
            Kind::Whole => write_column::<Int64Type>(fields, |field| whole(field).map(|value| value as i64), &mut target)?,
            Kind::Number => write_column::<DoubleType>(fields, Field::number, &mut target)?,
            Kind::Word => write_column::<ByteArrayType>(fields, word, &mut target)?,
            Kind::Truth => write_column::<BoolType>(fields, truth, &mut target)?,
        }
        target.close()?;
    }
    group.close()?;
    rows.clear();
    Ok(())
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

/// What the writer has written and has not gone out yet: it wants to own what it writes to.
#[derive(Clone, Default)]
struct Written(Arc<Mutex<Vec<u8>>>);

impl Written {
    fn bytes(&self) -> MutexGuard<'_, Vec<u8>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn pass_on(&self, out: &mut dyn Write) -> Result<(), SweepError> {
        out.write_all(&std::mem::take(&mut *self.bytes())).map_err(failed)
    }
}

impl Write for Written {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.bytes().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field as Read;

    use super::*;

    struct Lines(Vec<String>);

    impl Table for Lines {
        fn visit(&self, visit: &mut dyn FnMut(&str) -> Result<(), SweepError>) -> Result<(), SweepError> {
            self.0.iter().try_for_each(|line| visit(line))
        }
    }

    fn columns() -> Vec<Column> {
        [("cell", Kind::Whole), ("x_m", Kind::Number), ("cause", Kind::Word), ("arrived", Kind::Truth)]
            .map(|(name, kind)| Column::new(name, kind))
            .to_vec()
    }

    fn written(lines: &[&str]) -> Vec<u8> {
        let mut bytes = Vec::new();
        write_parquet(&columns(), &Lines(lines.iter().map(|line| (*line).to_owned()).collect()), &mut bytes).unwrap();
        bytes
    }

    #[test]
    fn every_field_reads_back_and_equal_rows_are_equal_bytes() {
        let lines = ["18446744073709551615,0.30000000000000004,\"a, b\",true", "1,-5e-324,,false", "2,,plain,"];
        let bytes = written(&lines);
        assert_eq!(bytes, written(&lines));
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
    }

    #[test]
    fn a_row_more_than_a_group_begins_the_next() {
        let lines: Vec<String> = (0..=ROWS_A_GROUP).map(|cell| format!("{cell},,,")).collect();
        let mut bytes = Vec::new();
        write_parquet(&columns(), &Lines(lines), &mut bytes).unwrap();
        let reader = SerializedFileReader::new(bytes::Bytes::from(bytes)).unwrap();
        let counts: Vec<i64> = reader.metadata().row_groups().iter().map(|group| group.num_rows()).collect();
        assert_eq!(counts, [ROWS_A_GROUP as i64, 1]);
    }
}
