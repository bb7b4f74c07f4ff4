//! Numbers of README and book that stand in `results/`: each is found in its file, and written by
//! `COHAUL_REWRITE=1` as that file has it.
//!
//! `numbers.txt` lists them. Under the name of a page stand the words around a number, where `{}`
//! is the number, and below them its place in `results/`, or why it has none. Parts of a place are
//! separated by ` :: `:
//!
//! ```text
//! FILE.json :: /pointer                          a number, or a number in a text
//! FILE.csv :: field; column=field :: column      of the only row with these fields
//! FILE :: words :: #2                            third number in the only line with these words
//! code :: FILE.rs :: words :: #2                 the same of the program's sources
//! ```
//!
//! A last part changes the number: `*1e3` scales it, `inverse` is one over it, `size` is without
//! sign, `count` is nothing where it is missing, `under` is any bound that is above it and at most
//! twice as large. Two places with ` over ` between them are a ratio.
//!
//! Two rules find a number that nothing checks: on every page those beside which a file of
//! `results/` is named, and on the pages about the program ([`OF_PROGRAM`]) those that have a unit
//! or three significant digits.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use super::{read, root};

/// Pages whose numbers are those of the program: bounds, defaults and times.
const OF_PROGRAM: [&str; 6] = [
    "README.md",
    "docs/src/introduction.md",
    "docs/src/runs.md",
    "docs/src/live.md",
    "docs/src/ensembles.md",
    "docs/src/where-inertia-matters.md",
];
/// Units after which a number is a statement.
const UNITS: [&str; 26] = [
    "%", "s", "ms", "µs", "m", "mm", "µm", "nm", "kg", "g", "N", "mN", "rad", "mrad", "J", "MB", "MiB", "GiB", "m/s", "mm/s", "N/m",
    "seconds", "minutes", "hours", "times", "threads",
];

/// Words of a page, and the places of their numbers; none where they are not measured.
struct Stated {
    words: &'static str,
    places: Vec<&'static str>,
}

/// Pages that `numbers.txt` names.
pub fn pages_named() -> impl Iterator<Item = &'static str> {
    include_str!("numbers.txt").lines().filter_map(|line| line.strip_prefix("# "))
}

/// What a page says.
fn stated(page: &str) -> Vec<Stated> {
    let (mut found, mut is_of_page): (Vec<Stated>, bool) = (Vec::new(), false);
    for line in include_str!("numbers.txt").lines().filter(|line| !line.is_empty()) {
        match (line.strip_prefix("# "), line.strip_prefix("  ")) {
            (Some(name), _) => is_of_page = name == page,
            (_, Some(place)) if is_of_page && !place.starts_with("not measured: ") => {
                found.last_mut().expect("words stand before their places").places.push(place);
            }
            (None, None) if is_of_page => found.push(Stated { words: line, places: Vec::new() }),
            _ => {}
        }
    }
    found
}

/// A number in a text: where it stands, and its digits.
#[derive(Clone, Debug, PartialEq)]
struct Written {
    from: usize,
    to: usize,
}

/// Begins and ends of all numbers of a text. Digits in words, versions and dates are none.
fn numbers(text: &str) -> Vec<Written> {
    let bytes = text.as_bytes();
    let is_digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
    let (mut found, mut at) = (Vec::new(), 0);
    while at < bytes.len() {
        let before = at.checked_sub(1).map(|at| bytes[at]);
        let is_start = is_digit(at) && !before.is_some_and(|byte| byte.is_ascii_alphanumeric() || b"_./".contains(&byte));
        if !is_start {
            at += 1;
            continue;
        }
        let from = at;
        while is_digit(at) || (b".,".contains(&bytes[at.min(bytes.len() - 1)]) && at < bytes.len() && is_digit(at + 1)) {
            at += 1;
        }
        if bytes.get(at) == Some(&b'e') && (is_digit(at + 1) || (bytes.get(at + 1) == Some(&b'-') && is_digit(at + 2))) {
            at += 2;
            while is_digit(at) {
                at += 1;
            }
        }
        found.push(Written { from, to: at });
    }
    found
}

fn value(digits: &str) -> f64 {
    digits.replace(',', "").parse().unwrap_or_else(|_| panic!("{digits:?} is no number"))
}

/// Half a unit of the last digit.
fn rounding(digits: &str) -> f64 {
    let (mantissa, exponent) = digits.split_once('e').unwrap_or((digits, "0"));
    let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len() as i32);
    0.5 * 10f64.powi(exponent.parse::<i32>().expect("an exponent") - decimals)
}

/// `value` with as many decimals as `digits`.
fn as_written(value: f64, digits: &str) -> String {
    let (mantissa, exponent) = digits.split_once('e').unwrap_or((digits, ""));
    let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    if exponent.is_empty() {
        let plain = format!("{value:.decimals$}");
        let (whole, rest) = plain.split_at(plain.find('.').unwrap_or(plain.len()));
        return if digits.contains(',') && whole.len() > 3 {
            format!("{},{}{rest}", &whole[..whole.len() - 3], &whole[whole.len() - 3..])
        } else {
            plain
        };
    }
    format!("{value:.decimals$e}")
}

/// The number at a place of `results/`, and whether any bound above it may be written.
fn of_results(place: &str) -> (f64, bool) {
    if let Some((above, below)) = place.split_once(" over ") {
        return (of_results(above).0 / of_results(below).0, false);
    }
    let of_code = place.strip_prefix("code :: ");
    let parts: Vec<&str> = of_code.unwrap_or(place).split(" :: ").collect();
    let (file, text) = match of_code {
        Some(_) => (parts[0].to_owned(), source(parts[0], parts[1])),
        None => (format!("results/{}", parts[0]), read(&format!("results/{}", parts[0]))),
    };
    let (found, rest) = match file.rsplit('.').next() {
        Some("json") => {
            let all: serde_json::Value = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{file}: {error}"));
            let is_count = parts.get(2) == Some(&"count");
            let found = all.pointer(parts[1]).and_then(serde_json::Value::as_f64).or(is_count.then_some(0.0));
            (found.unwrap_or_else(|| panic!("{place}: no number")), &parts[2 + usize::from(is_count)..])
        }
        Some("csv") => (of_table(&text, place, parts[1], parts[2]), &parts[3..]),
        _ => {
            let lines: Vec<&str> = text.lines().filter(|line| of_code.is_some() || line.contains(parts[1])).collect();
            assert_eq!(lines.len(), 1, "{place}: not one line");
            let nth: usize = parts[2].trim_start_matches('#').parse().expect("the place of a number in its line");
            let all = numbers(lines[0]);
            let written = all.get(nth).unwrap_or_else(|| panic!("{place}: {} numbers", all.len()));
            (value(&lines[0][written.from..written.to]), &parts[3..])
        }
    };
    match rest.first().copied() {
        None => (found, false),
        Some("inverse") => (1.0 / found, false),
        Some("size") => (found.abs(), false),
        Some("under") => (found, true),
        Some("size under") => (found.abs(), true),
        Some(scale) => {
            let (scale, is_bound) = scale.strip_suffix(" under").map_or((scale, false), |scale| (scale, true));
            let (scale, found) = scale.strip_suffix(" size").map_or((scale, found), |scale| (scale, found.abs()));
            (found * scale.trim_start_matches('*').parse::<f64>().unwrap_or_else(|_| panic!("{place}: {scale}")), is_bound)
        }
    }
}

/// The only line with these words in the sources of this name, wherever they stand, or the line of
/// the manifest that begins with them. Digits are written without the lines between them.
fn source(name: &str, words: &str) -> String {
    let mut folders: Vec<PathBuf> = ["src", "crates", "tests"].map(|folder| root().join(folder)).to_vec();
    let mut lines: Vec<String> = Vec::new();
    if name == "Cargo.toml" {
        return read(name).lines().find(|line| line.starts_with(words)).unwrap_or_else(|| panic!("{name} :: {words}")).to_owned();
    }
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(&folder).into_iter().flatten().map(|entry| entry.expect("a folder can be read").path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.file_name() == Path::new(name).file_name() {
                let text = fs::read_to_string(&path).expect("a source");
                lines.extend(text.lines().filter(|line| line.contains(words)).map(|line| line.replace('_', "")));
            }
        }
    }
    assert_eq!(lines.len(), 1, "{name} :: {words}: not one line");
    lines.remove(0)
}

fn of_table(text: &str, place: &str, fields: &str, column: &str) -> f64 {
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let at =
        table.headers().expect("a head").iter().position(|name| name == column).unwrap_or_else(|| panic!("{place}: no column {column}"));
    let head = table.headers().expect("a head").clone();
    let is_in = |row: &csv::StringRecord, field: &str| match field.split_once('=') {
        Some((name, wanted)) => head.iter().zip(row).any(|(column, cell)| column == name && cell == wanted),
        None => row.iter().any(|cell| cell == field),
    };
    let has = |row: &csv::StringRecord| fields.split("; ").all(|field| is_in(row, field));
    let rows: Vec<csv::StringRecord> = table.records().map(|row| row.expect("a row")).filter(has).collect();
    assert_eq!(rows.len(), 1, "{place}: not one row");
    rows[0][at].parse().unwrap_or_else(|_| panic!("{place}: {:?}", &rows[0][at]))
}

/// Places of the numbers of `words` in `text`, whatever its lines; `None` where the words do not
/// stand there exactly once.
fn places(text: &str, words: &str) -> Option<Vec<Written>> {
    let mut found = Vec::new();
    let all = numbers(text);
    for start in 0..text.len() {
        if text.is_char_boundary(start)
            && let Some(places) = matched(text, &all, start, words)
        {
            found.push(places);
        }
    }
    if found.len() == 1 { found.pop() } else { None }
}

/// Numbers of `words` where they begin at `start`.
fn matched(text: &str, numbers: &[Written], start: usize, words: &str) -> Option<Vec<Written>> {
    let (mut at, mut found) = (start, Vec::new());
    let mut rest = words;
    while !rest.is_empty() {
        if let Some(after) = rest.strip_prefix("{}") {
            let number = numbers.iter().find(|number| number.from == at)?;
            found.push(number.clone());
            (at, rest) = (number.to, after);
        } else if rest.starts_with(' ') {
            let blank = text[at..].len() - text[at..].trim_start().len();
            if blank == 0 {
                return None;
            }
            (at, rest) = (at + blank, rest.trim_start());
        } else {
            let letter = rest.chars().next()?;
            if !text[at..].starts_with(letter) {
                return None;
            }
            (at, rest) = (at + letter.len_utf8(), &rest[letter.len_utf8()..]);
        }
    }
    Some(found)
}

/// The page with its numbers as `results/` has them. Numbers that round to what is written stay as
/// they are.
///
/// # Panics
/// When words do not stand on the page exactly once.
pub fn with_numbers(path: &str, text: &str) -> String {
    let mut changes: Vec<(Written, String)> = Vec::new();
    for Stated { words, places: places_of } in stated(path) {
        let found = places(text, words).unwrap_or_else(|| panic!("{path}: does not say once: {words}"));
        assert!(places_of.is_empty() || found.len() == places_of.len(), "{path}: must have a place for each number of: {words}");
        for (written, place) in found.into_iter().zip(places_of) {
            let digits = &text[written.from..written.to];
            let ((wanted, is_bound), said) = (of_results(place), value(digits));
            // Numbers that end in a five may be rounded either way.
            let room = (1.0 + 1e-9) * rounding(digits);
            let agrees = if is_bound { wanted <= said && said <= 2.0 * wanted } else { (wanted - said).abs() <= room };
            if !agrees {
                changes.push((written.clone(), as_written(wanted, digits)));
            }
        }
    }
    changes.sort_by_key(|(written, _)| written.from);
    let (mut page, mut from) = (String::new(), 0);
    for (written, wanted) in changes {
        write!(page, "{}{wanted}", &text[from..written.from]).expect("a string takes all");
        from = written.to;
    }
    page + &text[from..]
}

/// Paragraphs of a page that name a file of `results/`, and the tables that they introduce or give
/// the source of; but for code and pictures.
fn with_source(text: &str) -> Vec<(usize, &str)> {
    let mut at = 0;
    let parts: Vec<(usize, &str)> = text
        .split("\n\n")
        .map(|part| {
            let begin = at;
            at += part.len() + 2;
            (begin, part)
        })
        .collect();
    let names = |at: usize| parts.get(at).is_some_and(|(_, part)| part.contains("results/"));
    let introduces = |at: usize| names(at) && parts[at].1.trim_end().ends_with(':');
    let gives_source = |at: usize| names(at) && parts[at].1.starts_with("Source:");
    let is_measured = |at: &usize| {
        let is_table_of = || parts[*at].1.starts_with('|') && (at.checked_sub(1).is_some_and(introduces) || gives_source(at + 1));
        names(*at) && !["```", "!["].iter().any(|start| parts[*at].1.starts_with(start)) || is_table_of()
    };
    (0..parts.len()).filter(is_measured).map(|at| parts[at]).collect()
}

/// Numbers of a page beside which a file of `results/` is named, and of a page about the program
/// all that have a unit or three digits, which nothing checks.
pub fn unchecked(path: &str, text: &str) -> Vec<String> {
    let checked: Vec<Written> = stated(path).iter().filter_map(|stated| places(text, stated.words)).flatten().collect();
    let is_of_program = OF_PROGRAM.contains(&path);
    let measured = with_source(text);
    let mut left = Vec::new();
    let among_code = measured.iter().filter(|(at, _)| prose(text).iter().all(|(begin, _)| begin != at));
    for (begin, part) in prose(text).into_iter().chain(among_code.copied()) {
        let plain = without_code(part);
        let is_measured = measured.iter().any(|(at, _)| *at == begin);
        let is_wanted = |number: &Written| is_measured || is_of_program && !part.starts_with('|') && is_statement(&plain, number);
        for number in numbers(&plain).into_iter().filter(|number| !is_label(&plain, number.from) && is_wanted(number)) {
            let (from, to) = (begin + number.from, begin + number.to);
            if !checked.iter().any(|one| one.from == from) {
                let line = text[..from].matches('\n').count() + 1;
                left.push(format!("{path}:{line}: {} in: {}", &text[from..to], part.lines().next().unwrap_or_default()));
            }
        }
    }
    left
}

/// Whether a number has a unit or three digits. The numbers of a range share the unit of the last.
fn is_statement(text: &str, number: &Written) -> bool {
    let digits = &text[number.from..number.to];
    if digits.matches('.').count() > 1 {
        return !is_known_version(digits);
    }
    let mut words = text[number.to..].split_whitespace();
    let after: Vec<&str> = words.by_ref().take(3).map(|word| word.trim_end_matches(['.', ',', ';', ':', ')'])).collect();
    let is_year = ["19", "20"].iter().any(|century| digits.len() == 4 && digits.starts_with(century));
    let has_unit = |at: usize| after.get(at).is_some_and(|word| UNITS.contains(word));
    let is_range = ["to", "and", "or"].iter().any(|word| after.first() == Some(word)) && has_unit(2);
    has_unit(0) || is_range || !is_year && digits.trim_start_matches(['0', '.']).bytes().filter(u8::is_ascii_digit).count() >= 3
}

/// Whether a number such as 1.2.3 is the version of something that the manifest names, or an
/// address.
fn is_known_version(digits: &str) -> bool {
    digits.matches('.').count() > 2 || read("Cargo.toml").contains(&format!("{digits}\""))
}

/// Paragraphs of a page outside of code blocks, comments and pictures, with the places where they
/// begin.
fn prose(text: &str) -> Vec<(usize, &str)> {
    let (mut at, mut is_code) = (0, false);
    let mut found = Vec::new();
    for part in text.split("\n\n") {
        let begins_in_code = is_code;
        is_code ^= part.lines().filter(|line| line.trim_start().starts_with("```")).count() % 2 == 1;
        if !begins_in_code && !part.starts_with("![") && !part.starts_with("<!--") && !part.contains("```") {
            found.push((at, part));
        }
        at += part.len() + 2;
    }
    found
}

/// Whether a place lies in the head of a table, or in the first cell of a row.
fn is_label(part: &str, at: usize) -> bool {
    let line = &part[part[..at].rfind('\n').map_or(0, |end| end + 1)..at];
    part.starts_with('|') && (!part[..at].contains('\n') || line.matches('|').count() < 2)
}

/// Code and addresses of links as blanks, so that places stay.
fn without_code(part: &str) -> String {
    let (mut plain, mut is_code, mut is_address) = (String::new(), false, false);
    for letter in part.chars() {
        match letter {
            '`' => is_code = !is_code,
            '(' if plain.ends_with(']') => is_address = true,
            ')' if is_address => is_address = false,
            _ => {}
        }
        let is_hidden = is_code || is_address || letter == '`';
        if is_hidden { plain.extend(std::iter::repeat_n(' ', letter.len_utf8())) } else { plain.push(letter) }
    }
    plain
}

#[test]
fn words_are_found_over_lines_and_numbers_in_them() {
    let text = "Of 1,100 runs, 98 % kept\nwithin 6.5e-15 m (see 2026-11-21, v1.2).";
    let digits: Vec<&str> = numbers(text).iter().map(|number| &text[number.from..number.to]).collect();
    assert_eq!(digits[..3], ["1,100", "98", "6.5e-15"]);
    let found = places(text, "{} % kept within {} m").unwrap();
    assert_eq!(found.iter().map(|number| value(&text[number.from..number.to])).collect::<Vec<_>>(), [98.0, 6.5e-15]);
    assert!(places(text, "{} runs, {} % lost").is_none() && places("1 m and 2 m", "{} m").is_none());
    assert_eq!((rounding("1,100"), rounding("0.12"), rounding("6.5e-15")), (0.5, 0.5 * 10f64.powi(-2), 0.5 * 10f64.powi(-16)));
    assert_eq!(
        (as_written(1234.4, "1,100"), as_written(0.1249, "0.12"), as_written(2.31e-14, "6.5e-15")),
        ("1,234".into(), "0.12".into(), "2.3e-14".into())
    );
}
