//! The page of numeric constants, from their table in the source of the backends.

use std::fmt::Write;

const TITLE: &str = "# Numeric constants

Generated from the table of numeric constants in the source of the backends. Lengths, forces and
energies are compared with those of the load, so that most constants have the unit 1. `epsilon` is
the rounding of a number of order one in double precision, 2.2e-16.
";

/// Units that stand in parentheses in the comment of a constant.
const UNITS: [&str; 8] = ["1", "s", "m", "rad", "1/s", "m/s", "m/s, rad/s", "SI units"];

/// # Panics
/// With a constant without a comment, and one that is no count and has no unit.
pub fn page(source: &str) -> String {
    let (mut page, mut comment) = (TITLE.to_owned(), Vec::new());
    for line in source.lines() {
        if let Some(section) = line.strip_prefix("// ") {
            let section = section.trim_end_matches('.');
            write!(page, "\n## {section}\n\n| constant | value | unit | meaning |\n|---|---|---|---|\n").expect("a string takes all");
        } else if let Some(text) = line.strip_prefix("/// ") {
            comment.push(text);
        } else if let Some(constant) = line.strip_prefix("pub const ") {
            page += &row(constant, &comment.join(" "));
            comment.clear();
        }
    }
    page
}

/// Row of a constant such as `NAME: f64 = 1e-9;`.
fn row(constant: &str, comment: &str) -> String {
    let (name, rest) = constant.split_once(": ").expect("a constant has a type");
    let (kind, value) = rest.trim_end_matches(';').split_once(" = ").expect("a constant has a value");
    let value = value.replace("f64::EPSILON", "epsilon");
    let meaning = comment.replace("[`", "`").replace("`]", "`");
    let units = UNITS.iter().filter_map(|unit| Some((*unit, meaning.find(&format!(" ({unit})"))?)));
    let unit = units.min_by_key(|(_, at)| *at).map(|(unit, _)| unit);
    let is_count = !kind.contains("f64");
    assert!(!comment.is_empty() && (is_count || unit.is_some()), "{name} has no comment, or no unit in it");
    let unit = unit.unwrap_or("1");
    format!("| `{name}` | `{value}` | {unit} | {} |\n", meaning.replacen(&format!(" ({unit})"), "", 1))
}

#[test]
fn a_constant_is_a_row_with_its_unit() {
    let source =
        "//! Table.\n\n// Steps.\n\n/// Shortest step (s), over [`OTHER`]\n/// (1).\npub const SHORTEST: f64 = 2.0 * f64::EPSILON;\n";
    assert!(page(source).ends_with(
        "\n## Steps\n\n| constant | value | unit | meaning |\n|---|---|---|---|\n\
         | `SHORTEST` | `2.0 * epsilon` | s | Shortest step, over `OTHER` (1). |\n"
    ));
}
