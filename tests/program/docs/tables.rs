//! Tables of the book that follow from the program: printed values that presets replace, choices
//! that the paper leaves open, account rules, formats, and exit codes.
//!
//! A table stands between the lines `<!-- table NAME -->` and `<!-- end -->`.

use std::fmt::Write;

use cohaul::formats::{ALL, Format};
use cohaul::model::open_choices::{OPEN_CHOICES, Range};
use cohaul::scenario::Scenario;
use cohaul::scenario::presets::Preset;
use cohaul::simulation::rules::{RULES, Rule};
use cohaul_app::cli::EXIT_CODES;
use cohaul_report::quantity::number;
use cohaul_report::table::Table;
use serde_json::Value;

/// The page with its tables as they should be.
///
/// # Panics
/// With a table that nobody makes, or one without an end.
pub fn with_tables(path: &str, text: &str) -> String {
    let (mut page, mut rest) = (String::new(), text);
    while let Some((before, after)) = rest.split_once("<!-- table ") {
        let (name, after) = after.split_once(" -->\n").unwrap_or_else(|| panic!("{path}: a table without a name"));
        let (_, after) = after.split_once("<!-- end -->").unwrap_or_else(|| panic!("{path}: the table {name} has no end"));
        let table = made(name).unwrap_or_else(|| panic!("{path}: nobody makes the table {name}"));
        write!(page, "{before}<!-- table {name} -->\n\n{}\n<!-- end -->", table.markdown()).expect("a string takes all");
        rest = after;
    }
    page + rest
}

fn made(name: &str) -> Option<Table> {
    match name {
        "replaced values" => Some(replaced_values()),
        "open choices" => Some(open_choices()),
        "account rules" => Some(account_rules()),
        "formats" => Some(formats()),
        "exit codes" => {
            Some(Table::new("", ["code", "meaning"]).with_rows(EXIT_CODES.map(|(code, meaning)| [code.to_string(), meaning.to_owned()])))
        }
        _ => None,
    }
}

/// Printed parameters that presets replace: one row for each value.
fn replaced_values() -> Table {
    let mut rows: Vec<(String, Vec<&str>)> = Vec::new();
    for preset in Preset::ALL {
        for departure in preset.departures() {
            let printed = departure.printed;
            let unit = |value: f64| format!("{} {}", number(value), printed.unit);
            let (paper, here) = (unit(printed.value), unit(departure.value));
            let row = format!("{} | {paper} | {here} | {}: {}", printed.symbol, printed.acts_in, departure.reason);
            match rows.iter_mut().find(|(found, _)| *found == row) {
                Some((_, presets)) => presets.push(preset.name()),
                None => rows.push((row, vec![preset.name()])),
            }
        }
    }
    let rows = rows.iter().map(|(row, presets)| {
        let mut fields: Vec<String> = row.split(" | ").map(str::to_owned).collect();
        fields.insert(3, presets.iter().map(|preset| format!("`{preset}`")).collect::<Vec<_>>().join(", "));
        fields
    });
    Table::new("", ["parameter", "paper", "here", "presets", "where it acts, and why"]).with_rows(rows)
}

/// What makes a run doubtful or failed.
fn account_rules() -> Table {
    let row = |rule: &Rule| {
        let limit = |limit: f64| match (limit, rule.unit) {
            (limit, _) if limit.is_infinite() => "never".to_owned(),
            (limit, "") => number(limit),
            (limit, unit) => format!("{} {unit}", number(limit)),
        };
        let cause = serde_json::to_value(rule.cause).expect("a cause is a word");
        let measure = if rule.measure.is_empty() { "whether it happened" } else { rule.measure };
        [format!("`{}`", text_of(&cause)), measure.to_owned(), limit(rule.doubtful), limit(rule.failed), rule.means.to_owned()]
    };
    Table::new("", ["rule", "measure", "doubtful above", "failed above", "what happened"]).with_rows(RULES.iter().map(row))
}

/// Formats with their versions, and what meets data of other versions.
fn formats() -> Table {
    let row = |format: &Format| {
        let [older, newer] = format.reads.answers();
        [format.name.trim_start_matches("cohaul "), &format.version.to_string(), format.place, older, newer].map(str::to_owned)
    };
    Table::new("", ["format", "version", "written to", "older data", "newer data"]).with_rows(ALL.iter().map(row))
}

fn open_choices() -> Table {
    let path = "scenarios/paper/four-ants-four-springs.json";
    let scene = Scenario::read(&super::root().join(path)).expect("a scene of the project");
    let expanded = serde_json::to_value(scene.expanded()).expect("a scene is plain data");
    let written: Value = serde_json::from_str(&super::read(path)).expect("a scene is JSON");
    // Supports are written out in an expanded scene.
    let default = |key: &str| {
        let place = format!("/{}", key.replace('.', "/"));
        text_of(written.pointer(&place).or_else(|| expanded.pointer(&place)).expect("a key of the scene"))
    };
    let row = |choice: &cohaul::model::open_choices::OpenChoice| {
        let unit = if choice.unit.is_empty() { String::new() } else { format!(" {}", choice.unit) };
        let range = match choice.range {
            Range::Between { low, high, .. } => format!("{} to {}{unit}", number(low), number(high)),
            Range::Numbers(all) => format!("{}{unit}", all.iter().map(|value| number(*value)).collect::<Vec<_>>().join(", ")),
            Range::Words(all) => all.join(", "),
            Range::Fixed(way) => way.to_owned(),
        };
        let key = choice.key.map_or_else(|| "none".to_owned(), |key| format!("`{key}`"));
        let default = match (choice.key, choice.range) {
            (Some(key), Range::Between { .. } | Range::Numbers(_) | Range::Words(_)) => format!("{}{unit}", default(key)),
            _ => String::new(),
        };
        [choice.name.to_owned(), key, default, range, choice.reason.to_owned()]
    };
    Table::new("", ["choice", "key", "default", "range", "why it is open"]).with_rows(OPEN_CHOICES.iter().map(row))
}

fn text_of(value: &Value) -> String {
    value.as_f64().map_or_else(|| value.as_str().expect("a number or a word").to_owned(), number)
}

#[test]
fn a_table_is_replaced_and_the_rest_is_kept() {
    let page = with_tables("page", "before\n<!-- table replaced values -->\nold\n<!-- end -->\nafter\n");
    assert!(page.starts_with("before\n<!-- table replaced values -->\n\n| parameter |") && page.ends_with("<!-- end -->\nafter\n"));
    assert!(!page.contains("old") && page.contains("| beta | 1.047 rad |"), "{page}");
    assert_eq!(with_tables("page", &page), page);
}
