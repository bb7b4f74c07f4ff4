//! Columns, fields and lines of the table. A line is made once, where its run ends, and never again: all that follows copies it.

use serde::{Deserialize, Serialize};

use crate::output::table::{Field, Kind};

/// A column of the table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// Ends in the unit of its numbers.
    pub name: String,
    pub kind: Kind,
}

impl Column {
    pub fn new(name: impl Into<String>, kind: Kind) -> Self {
        Self { name: name.into(), kind }
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

/// The fields of a line; `None` where it does not fit the columns.
pub fn fields_of(line: &str, columns: &[Column]) -> Option<Vec<Field>> {
    let mut rest = Some(line);
    let mut fields = Vec::with_capacity(columns.len());
    for column in columns {
        let (text, after) = next_text(rest?)?;
        fields.push(Field::parse(&text, column.kind)?);
        rest = after;
    }
    rest.is_none().then_some(fields)
}

/// The text of the first field, and what follows its comma.
fn next_text(line: &str) -> Option<(std::borrow::Cow<'_, str>, Option<&str>)> {
    let Some(quoted) = line.strip_prefix('"') else {
        let (text, rest) = line.split_once(',').map_or((line, None), |(text, rest)| (text, Some(rest)));
        return Some((text.into(), rest));
    };
    let mut end = 0;
    loop {
        end += quoted[end..].find('"')?;
        if !quoted[end + 1..].starts_with('"') {
            break;
        }
        end += 2;
    }
    let text = quoted[..end].replace("\"\"", "\"");
    match &quoted[end + 1..] {
        "" => Some((text.into(), None)),
        after => after.strip_prefix(',').map(|rest| (text.into(), Some(rest))),
    }
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
        assert_eq!(fields_of(&line, &columns), Some(fields));
        // By an independent reader too.
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(line.as_bytes());
        let record = reader.records().next().unwrap().unwrap();
        assert_eq!((&record[2], &record[5], &record[6]), ("says \"no\", twice", "", "\""));
    }

    #[test]
    fn a_line_that_does_not_fit_is_none() {
        let columns = [Column::new("n", Kind::Whole), Column::new("x", Kind::Number)];
        for line in ["1", "1,2,3", "x,2", "1,NaN", "-1,2", "\"1,2", "\"1\"x,2"] {
            assert_eq!(fields_of(line, &columns), None, "{line}");
        }
    }
}
