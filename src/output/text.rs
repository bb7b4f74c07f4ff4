//! Text for terminals: labelled rows in sections, wrapped at 80 columns.

/// How much a command prints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// The answer and at most 15 lines of evidence.
    Brief,
    /// Everything (`--verbose`).
    Full,
}

/// Width of a line (columns).
pub const WIDTH: usize = 80;

/// Rows of a label and a value, in sections.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lines {
    pub text: String,
}

impl Lines {
    /// Column at which values begin.
    pub const VALUE: usize = 20;

    /// The answer, and an empty line after it.
    pub fn answer(&mut self, answer: &str) {
        self.wrapped("", answer, 0);
        self.text.push('\n');
    }

    /// A line, or a paragraph, of its own.
    pub fn section(&mut self, name: &str) {
        self.wrapped("", name, 0);
    }

    /// A label and its value, which continues below itself.
    pub fn row(&mut self, label: &str, value: &str) {
        self.wrapped(&format!("  {label}"), value, Self::VALUE);
    }

    fn wrapped(&mut self, label: &str, text: &str, column: usize) {
        let mut line = format!("{label:<column$}");
        if column > 0 && !line.ends_with(' ') {
            line += "  ";
        }
        let mut width = line.chars().count();
        for (at, word) in text.split(' ').enumerate() {
            let length = word.chars().count();
            let is_full = width + usize::from(at > 0) + length > WIDTH;
            if at > 0 && is_full {
                self.text += &line;
                self.text.push('\n');
                line = " ".repeat(column);
                width = column;
            } else if at > 0 {
                line.push(' ');
                width += 1;
            }
            line += word;
            width += length;
        }
        self.text += line.trim_end();
        self.text.push('\n');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_continue_below_themselves() {
        let mut lines = Lines::default();
        lines.row("label", &"word ".repeat(13));
        lines.row("a label that is too long", "value");
        let expected =
            format!("  label             {}word\n{}word\n  a label that is too long  value\n", "word ".repeat(11), " ".repeat(20));
        assert_eq!(lines.text, expected);
    }
}
