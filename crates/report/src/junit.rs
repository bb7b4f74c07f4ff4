//! Results as JUnit XML, which services for continuous integration read.

use std::fmt::{self, Display};

/// Test cases under one name.
#[derive(Clone, Debug, PartialEq)]
pub struct Suite {
    pub name: String,
    /// Time that all cases took together (s).
    pub wall_s: f64,
    pub cases: Vec<Case>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// What the case belongs to.
    pub class: String,
    pub name: String,
    pub outcome: Outcome,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    Passed,
    /// The result is not as expected: a line, and the details.
    Failed(String, String),
    /// There is no result: why.
    Error(String),
    /// The case was not judged: why.
    Skipped(String),
}

impl Suite {
    fn count(&self, is: fn(&Outcome) -> bool) -> usize {
        self.cases.iter().filter(|case| is(&case.outcome)).count()
    }
}

impl Display for Suite {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let failures = self.count(|outcome| matches!(outcome, Outcome::Failed(..)));
        let errors = self.count(|outcome| matches!(outcome, Outcome::Error(_)));
        let skipped = self.count(|outcome| matches!(outcome, Outcome::Skipped(_)));
        let counts = format!("tests=\"{}\" failures=\"{failures}\" errors=\"{errors}\"", self.cases.len());
        let time = format!("time=\"{:.3}\"", self.wall_s);
        writeln!(f, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
        writeln!(f, "<testsuites name=\"{}\" {counts} {time}>", escaped(&self.name))?;
        writeln!(f, "  <testsuite name=\"{}\" {counts} skipped=\"{skipped}\" {time}>", escaped(&self.name))?;
        self.cases.iter().try_for_each(|case| write!(f, "{case}"))?;
        writeln!(f, "  </testsuite>\n</testsuites>")
    }
}

impl Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let start = format!("    <testcase classname=\"{}\" name=\"{}\"", escaped(&self.class), escaped(&self.name));
        match &self.outcome {
            Outcome::Passed => writeln!(f, "{start}/>"),
            Outcome::Failed(line, details) => {
                writeln!(f, "{start}>\n      <failure message=\"{}\">{}</failure>\n    </testcase>", escaped(line), escaped(details))
            }
            Outcome::Error(why) => writeln!(f, "{start}>\n      <error message=\"{}\"/>\n    </testcase>", escaped(why)),
            Outcome::Skipped(why) => writeln!(f, "{start}>\n      <skipped message=\"{}\"/>\n    </testcase>", escaped(why)),
        }
    }
}

/// A text between tags or quotation marks. XML has no control characters except for tabs and line
/// ends, which become references so that attributes keep them.
fn escaped(text: &str) -> String {
    let mut xml = String::with_capacity(text.len());
    for char in text.chars() {
        match char {
            '&' => xml += "&amp;",
            '<' => xml += "&lt;",
            '>' => xml += "&gt;",
            '"' => xml += "&quot;",
            '\t' => xml += "&#9;",
            '\n' => xml += "&#10;",
            '\r' => xml += "&#13;",
            '\u{0}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => xml.push('\u{fffd}'),
            other => xml.push(other),
        }
    }
    xml
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_outcome_is_counted_and_every_text_escaped() {
        let case = |name: &str, outcome| Case { class: "check".to_owned(), name: name.to_owned(), outcome };
        let suite = Suite {
            name: "a & b".to_owned(),
            wall_s: 1.5,
            cases: vec![
                case("good", Outcome::Passed),
                case("bad", Outcome::Failed("x < \"y\"".to_owned(), "1 > 0\n\u{1b}end".to_owned())),
                case("none", Outcome::Error("no run".to_owned())),
                case("shown", Outcome::Skipped("for information".to_owned())),
            ],
        };
        let expected = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>
<testsuites name=\"a &amp; b\" tests=\"4\" failures=\"1\" errors=\"1\" time=\"1.500\">
  <testsuite name=\"a &amp; b\" tests=\"4\" failures=\"1\" errors=\"1\" skipped=\"1\" time=\"1.500\">
    <testcase classname=\"check\" name=\"good\"/>
    <testcase classname=\"check\" name=\"bad\">
      <failure message=\"x &lt; &quot;y&quot;\">1 &gt; 0&#10;\u{fffd}end</failure>
    </testcase>
    <testcase classname=\"check\" name=\"none\">
      <error message=\"no run\"/>
    </testcase>
    <testcase classname=\"check\" name=\"shown\">
      <skipped message=\"for information\"/>
    </testcase>
  </testsuite>
</testsuites>
";
        assert_eq!(suite.to_string(), expected);
    }
}
