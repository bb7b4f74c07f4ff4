//! What the source tree and the prose promise, checked on the files themselves.
//!
//! ```text
//! source.rs   files of the repository, as text and as tokens
//! imports.rs  which file uses what another file defines
//! prose.rs    paragraphs, sentences and widths
//! words.rs    phrases that nobody should have to read
//! ```

mod imports;
mod prose;
mod source;
mod words;

use std::collections::BTreeSet;
use std::fs;
use std::sync::LazyLock;

use source::{Source, markdown_files, rust_files};

/// Floors of the physics, from the bottom to the top: a file imports from its own floor and below.
const FLOORS: [&str; 6] = ["math", "model", "scenario", "backend", "simulation", "analysis"];

/// Floors inside `backend`, from the bottom to the top. Its hub `mod.rs` stands above all of them:
/// it hands on what they define and builds backends.
const BACKEND_FLOORS: [&[&str]; 7] = [
    &["numerics", "report"],
    &["friction", "springs"],
    &["increment"],
    &["contact", "shortcuts"],
    &["interface", "shared", "steered", "unmoved", "wrapped"],
    &["exact", "options", "rapier", "stepping", "tolerance"],
    &["default_step", "tandem"],
];

/// Most lines of Rust in the sources of each crate. A budget falls, but for what a new feature
/// needs: one that is a fiftieth above what it is for fails too.
const BUDGETS: [(&str, usize); 7] = [
    ("src", 40_680),
    ("crates/engines/src", 1_120),
    ("crates/report/src", 8_820),
    ("crates/studies/src", 24_200),
    // Readings of the paper, standstills, load cells, and recordings beside runs.
    ("crates/paper/src", 12_700),
    // The readers of twelve formats and of what is wrong with them.
    ("crates/recordings/src", 3_890),
    ("crates/app/src", 8_450),
];

/// Beginnings of the names of crates, and the places in which these may be used.
const FENCES: [(&str, &[&str]); 12] = [
    ("usvg", &["crates/recordings/src/drawings/svg.rs"]),
    ("i_overlay", &["crates/recordings/src/drawings/outline.rs"]),
    ("kurbo", &["crates/recordings/src/drawings/"]),
    ("tiny_skia", &["crates/report/src/picture/pen.rs"]),
    ("axum", &["crates/app/src/live/server.rs"]),
    ("hyper_util", &["crates/app/src/live/server.rs"]),
    ("tokio", &["crates/app/src/live/server.rs"]),
    ("clap", &["crates/app/src/cli/"]),
    ("clarabel", &["src/backend/friction/clarabel.rs"]),
    ("rapier2d", &["src/backend/rapier/"]),
    ("parry2d", &["src/backend/contact/", "src/model/geometry/"]),
    ("kuva", &["crates/report/src/chart/"]),
];

/// Numeric constants of the backends outside of their table: sizes of lists and texts, and one in
/// the precision of the engine.
const N_CONSTANTS_ELSEWHERE: usize = 4;

const MAX_FILE_LINES: usize = 400;
const MAX_FUNCTION_LINES: usize = 60;
const MAX_README_LINES: usize = 150;
const MAX_PROSE_COLUMNS: usize = 100;
const MAX_SENTENCE_WORDS: usize = 40;
const MAX_MEAN_WORDS: f64 = 20.0;

/// The physics, and what prints, studies and runs it.
static SRC: LazyLock<Vec<Source>> = LazyLock::new(|| BUDGETS.iter().flat_map(|(folder, _)| rust_files(folder)).collect());

/// A place that breaks a rule.
pub struct Finding {
    pub path: String,
    pub line: usize,
    pub what: String,
}

impl Finding {
    pub fn new(path: &str, line: usize, what: impl Into<String>) -> Self {
        Self { path: path.to_owned(), line, what: what.into() }
    }
}

/// Fails with every finding.
fn expect_none(rule: &str, findings: Vec<Finding>) {
    let found: Vec<String> =
        findings.iter().map(|finding| format!("{}:{}: {rule}: {}", finding.path, finding.line, finding.what)).collect();
    assert!(found.is_empty(), "{} places:\n{}\n", found.len(), found.join("\n"));
}

#[test]
fn no_import_goes_up_a_floor() {
    let floor = |name: &str| FLOORS.iter().position(|floor| *floor == name);
    let mut findings = Vec::new();
    for file in SRC.iter() {
        let Some(own) = file.folder().and_then(floor) else { continue };
        for path in file.paths().iter().filter(|path| path.names[0] == "crate") {
            if let Some(other) = path.names.get(1).and_then(|name| floor(name)).filter(|other| *other > own) {
                findings.push(Finding::new(&file.path, path.line, format!("{} imports from {} above it", FLOORS[own], FLOORS[other])));
            }
        }
    }
    expect_none("floors", findings);
}

#[test]
fn no_import_in_the_backend_goes_up_a_floor() {
    let floor = |room: &str| BACKEND_FLOORS.iter().position(|rooms| rooms.contains(&room));
    let mut findings = Vec::new();
    for file in SRC.iter().filter(|file| file.path != "src/backend/mod.rs" && file.path.starts_with("src/backend/")) {
        let at = imports::module_of("src", &file.path);
        let own = floor(&at[1]);
        if own.is_none() {
            findings.push(Finding::new(&file.path, 1, "a file without a floor"));
        }
        for path in file.paths() {
            let names = imports::from_the_root(&at, &path);
            let Some(room) = names.get(1).filter(|_| names[0] == "backend") else { continue };
            match floor(room) {
                Some(other) if Some(other) > own => findings.push(Finding::new(&file.path, path.line, format!("imports {room} above it"))),
                Some(_) => {}
                None => findings.push(Finding::new(&file.path, path.line, format!("imports {room} through the hub"))),
            }
        }
    }
    expect_none("backend floors", findings);
}

#[test]
fn every_top_folder_is_a_floor() {
    let folders: BTreeSet<String> = SRC.iter().filter_map(|file| file.folder().map(str::to_owned)).collect();
    let unknown = folders.iter().filter(|folder| !FLOORS.contains(&folder.as_str()));
    let findings = unknown.map(|folder| Finding::new(&format!("src/{folder}"), 1, "a folder without a floor")).collect();
    expect_none("folders", findings);
}

#[test]
fn libraries_stay_behind_their_fences() {
    let mut findings = Vec::new();
    for file in SRC.iter() {
        for (name, line) in file.crates_named() {
            let fence = FENCES.iter().find(|(fenced, _)| name.starts_with(fenced)).map(|(_, places)| places);
            if fence.is_some_and(|places| !places.iter().any(|place| file.path.starts_with(place))) {
                findings.push(Finding::new(&file.path, line, format!("uses {name}")));
            }
        }
    }
    expect_none("fences", findings);
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let of_crate = |folder: &str| SRC.iter().filter(|file| file.path.starts_with(folder)).collect::<Vec<_>>();
    expect_none("circles", BUDGETS.iter().flat_map(|(folder, _)| imports::circles(folder, &of_crate(folder))).collect());
}

#[test]
fn files_and_functions_are_short() {
    let mut findings = Vec::new();
    for file in SRC.iter().filter(|file| !file.is_test()) {
        let n_lines = file.n_code_lines();
        if n_lines > MAX_FILE_LINES {
            findings.push(Finding::new(&file.path, 1, format!("{n_lines} lines of code")));
        }
        let long = file.functions().into_iter().filter(|function| function.n_lines > MAX_FUNCTION_LINES);
        findings.extend(
            long.map(|function| Finding::new(&file.path, function.line, format!("fn {} has {} lines", function.name, function.n_lines))),
        );
    }
    expect_none("length", findings);
}

#[test]
fn numeric_constants_of_the_backends_stand_in_their_table() {
    const TABLE: &str = "src/backend/numerics.rs";
    let others = SRC.iter().filter(|file| file.path.starts_with("src/backend/") && file.path != TABLE && !file.is_test());
    let findings: Vec<Finding> = others
        .flat_map(|file| {
            file.numeric_constants().into_iter().map(|(name, line)| Finding::new(&file.path, line, format!("{name} is not in {TABLE}")))
        })
        .collect();
    if findings.len() != N_CONSTANTS_ELSEWHERE {
        expect_none("constants", findings);
        panic!("no constant stands outside of {TABLE}: the rule allows {N_CONSTANTS_ELSEWHERE}");
    }
}

#[test]
fn the_source_and_the_readme_stay_small() {
    let n_lines = |path: &str| fs::read_to_string(source::root().join(path)).map_or(0, |text| text.lines().count());
    let mut findings = Vec::new();
    for (folder, budget) in BUDGETS {
        let n_lines = SRC.iter().filter(|file| file.path.starts_with(folder)).map(|file| file.text.lines().count()).sum::<usize>();
        if n_lines > budget || n_lines + budget / 50 < budget {
            findings.push(Finding::new(folder, 1, format!("{n_lines} lines for a budget of {budget}")));
        }
    }
    if n_lines("README.md") > MAX_README_LINES {
        findings.push(Finding::new("README.md", 1, format!("{} lines, more than {MAX_README_LINES}", n_lines("README.md"))));
    }
    expect_none("size", findings);
}

#[test]
fn prose_wraps_at_100_columns() {
    let mut findings = Vec::new();
    let others: Vec<Source> = ["tests", "benches", "examples", "python/src"].iter().flat_map(|folder| rust_files(folder)).collect();
    for file in SRC.iter().chain(&others) {
        findings.extend(prose::wide_comments(file, MAX_PROSE_COLUMNS));
    }
    for (path, text) in markdown_files() {
        findings.extend(prose::wide_lines(&path, &text, MAX_PROSE_COLUMNS));
    }
    expect_none("width", findings);
}

#[test]
fn sentences_are_short() {
    let mut findings = Vec::new();
    let (mut n_words, mut n_sentences) = (0, 0);
    let pages = markdown_files().into_iter().flat_map(|(path, text)| prose::sentences_of_markdown(&path, &text));
    let printed = SRC.iter().filter(|file| !file.is_test()).flat_map(prose::printed_sentences);
    for sentence in pages.chain(printed) {
        n_words += sentence.n_words;
        n_sentences += 1;
        if sentence.n_words > MAX_SENTENCE_WORDS {
            findings.push(Finding::new(&sentence.path, sentence.line, format!("{} words: {}", sentence.n_words, sentence.start())));
        }
    }
    let mean = n_words as f64 / n_sentences.max(1) as f64;
    if mean > MAX_MEAN_WORDS {
        findings.push(Finding::new("README.md", 1, format!("{mean:.1} words in the mean of {n_sentences} sentences")));
    }
    expect_none("sentences", findings);
}

#[test]
fn private_words_are_not_printed() {
    let mut findings = Vec::new();
    for file in SRC.iter().filter(|file| !file.is_test()) {
        for text in file.texts() {
            findings.extend(words::private_words(&file.path, text.line, &text.text));
        }
    }
    for (path, text) in markdown_files() {
        // The glossary explains old names of options too.
        let text: Vec<&str> = text.lines().map(|line| if line.starts_with("Also: ") { "" } else { line }).collect();
        findings.extend(words::private_words(&path, 1, &text.join("\n")));
    }
    expect_none("words", findings);
}

/// The glossary is read by the program, so that its form is fixed.
#[test]
fn the_glossary_has_one_short_entry_a_term() {
    const PATH: &str = "docs/src/glossary.md";
    let text = fs::read_to_string(source::root().join(PATH)).expect("the glossary is there");
    let (mut findings, mut before, mut names) = (Vec::new(), String::new(), BTreeSet::new());
    for entry in prose::glossary(&text) {
        let mut fail = |what: String| findings.push(Finding::new(PATH, entry.line, format!("{}: {what}", entry.term)));
        if entry.term.to_lowercase() < before {
            fail(format!("stands behind {before}"));
        }
        before = entry.term.to_lowercase();
        for name in entry.names.iter().filter(|name| !names.insert(name.to_lowercase())) {
            fail(format!("{name} is explained twice"));
        }
        if !(1..=3).contains(&entry.n_sentences) {
            fail(format!("{} sentences", entry.n_sentences));
        }
    }
    assert!(names.len() > 100, "the glossary is read: {} names", names.len());
    expect_none("glossary", findings);
}

/// A rule that finds nothing anywhere would be no rule.
#[test]
fn the_rules_find_what_they_are_for() {
    let file = Source::new(
        "src/math/made_up.rs",
        "use crate::cli::{run::{self, Run}, Args};\n/// Own error on the rim.\nfn long() {\n    let _ = clap::Arg::new(\"x\");\n}\n\
         const NEAR: f64 = 1e-9;\npub const STEPS: [u32; 2] = [1, 4];\nconst NAME: &str = \"\";\nfn sized<const N: usize>() {}\n\
         #[cfg(test)]\npub(super) mod tests {\n    const FAR: f64 = 1.0;\n    fn untold() {}\n}\n",
    );
    assert_eq!(file.numeric_constants(), [("NEAR", 6), ("STEPS", 7)]);
    let names: Vec<String> = file.paths().iter().map(|path| path.names.join("::")).collect();
    assert_eq!(names, ["crate::cli::run::self", "crate::cli::run::Run", "crate::cli::Args"]);
    assert_eq!(
        file.functions().iter().map(|function| (function.name.as_str(), function.n_lines)).collect::<Vec<_>>(),
        [("long", 3), ("sized", 1)]
    );
    assert_eq!(file.n_code_lines(), 8);
    assert!(file.crates_named().iter().any(|(name, line)| name == "clap" && *line == 4));
    let found = words::private_words("x", 1, &file.texts()[0].text);
    assert_eq!(found.len(), 2, "own error, rim");
    let pages = prose::sentences_of_markdown("x", "# No\n\nOne sentence, of Eq. 10.\nTwo `a b` here. Three!\n\n- four words in it\n");
    assert_eq!(pages.iter().map(|sentence| sentence.n_words).collect::<Vec<_>>(), [5, 3, 1, 4]);
}
