//! Words in the last column of a table.

/// Columns for the words of a verdict, of 80.
pub const WORDS: usize = 18;

/// Words that are separated by commas, in lines of at most `width` columns.
pub fn wrapped(words: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words.split(", ") {
        match lines.last_mut() {
            Some(line) if line.len() + 2 + word.len() <= width => *line = format!("{line}, {word}"),
            Some(line) => {
                line.push(',');
                lines.push(word.to_owned());
            }
            None => lines.push(word.to_owned()),
        }
    }
    lines
}
