//! README and book say what the program does: generated pages, printed outputs, commands and links.
//!
//! ```text
//! commands.rs  the page of commands, from the program's help
//! scenario.rs  the page of scenario keys, from the JSON schema
//! numerics.rs  the page of numeric constants, from their table
//! gallery.rs   the page of scenes, from their stored answers
//! console.rs   outputs under `$ cohaul ...`, and commands that are only shown
//! links.rs     links, anchors and pictures
//! numbers.rs   numbers that stand in `results/`; numbers.txt says where
//! tables.rs    tables that follow from the program
//! limits.rs    what the program is said not to do
//! names.rs     names of code, and values of options in the words of the glossary
//! ```
//!
//! `COHAUL_REWRITE=1` writes pages and outputs anew in place of comparing them.

#![cfg(unix)]

mod commands;
mod console;
mod gallery;
#[path = "../../common/help.rs"]
mod help;
mod limits;
mod links;
mod names;
mod numbers;
mod numerics;
#[path = "../../common/root.rs"]
mod root;
mod scenario;
mod tables;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    root::root().to_path_buf()
}

/// README and all pages of the book but those of `results/`, from the root of the repository.
fn pages() -> Vec<String> {
    let mut pages = vec!["README.md".to_owned(), "clusters/README.md".to_owned()];
    for folder in ["docs/src", "docs/src/reference", "docs/src/notebooks"] {
        let names =
            fs::read_dir(root().join(folder)).expect("the book is there").map(|entry| entry.expect("a folder can be read").file_name());
        let names = names.map(|name| name.to_string_lossy().into_owned()).filter(|name| name.ends_with(".md"));
        pages.extend(names.map(|name| format!("{folder}/{name}")));
    }
    pages.sort();
    pages
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn rewrites() -> bool {
    std::env::var_os("COHAUL_REWRITE").is_some()
}

/// The program with these arguments, in `folder`, at 80 columns without colour.
fn cohaul(arguments: &[String], folder: &Path) -> Command {
    let mut command = root::cohaul();
    command.args(arguments).current_dir(folder).env("COLUMNS", "80").env("NO_COLOR", "1").env_remove("COHAUL_REWRITE");
    command
}

/// What the program prints.
fn printed(arguments: &[&str]) -> String {
    let arguments: Vec<String> = arguments.iter().map(|argument| (*argument).to_owned()).collect();
    let output = cohaul(&arguments, &root()).output().expect("the program runs");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("the program prints UTF-8")
}

/// Compares a page with what it should be, or writes it.
fn expect_page(path: &str, wanted: &str) {
    if rewrites() {
        fs::write(root().join(path), wanted).expect("a page can be written");
    }
    let found = read(path);
    let differs = found.lines().zip(wanted.lines()).position(|(found, wanted)| found != wanted);
    let line = differs.unwrap_or_else(|| found.lines().count().min(wanted.lines().count())) + 1;
    assert!(found == wanted, "{path}:{line} is out of date: run COHAUL_REWRITE=1 cargo test --test docs");
}

/// The schema that shipped scenes name, and editors read.
#[test]
fn every_shipped_scene_names_the_schema() {
    expect_page("docs/src/reference/scenario.schema.json", &printed(&["scenario", "schema"]));
    let folders = fs::read_dir(root().join("scenarios")).expect("scenes are there");
    let files = folders.flat_map(|folder| fs::read_dir(folder.expect("a folder").path()).expect("scenes are there"));
    for file in files.map(|file| file.expect("a file").path()) {
        let text = fs::read_to_string(&file).expect("a scene");
        let scene: serde_json::Value = serde_json::from_str(&text).expect("a scene is JSON");
        let named = file.parent().expect("a folder").join(scene["$schema"].as_str().unwrap_or_default());
        assert!(named.is_file(), "{}: {}", file.display(), scene["$schema"]);
    }
}

#[test]
fn the_page_of_commands_is_the_help() {
    expect_page("docs/src/reference/commands.md", &commands::page());
}

#[test]
fn the_page_of_scenario_keys_is_the_schema() {
    let schema = serde_json::from_str(&printed(&["scenario", "schema"])).expect("the schema is JSON");
    expect_page("docs/src/reference/scenario.md", &scenario::page(&schema));
}

#[test]
fn the_page_of_numeric_constants_is_their_table() {
    expect_page("docs/src/reference/numerics.md", &numerics::page(&read("src/backend/numerics.rs")));
}

#[test]
fn the_gallery_has_its_stored_answers() {
    expect_page("docs/src/gallery.md", &gallery::page());
}

#[test]
fn outputs_shown_are_those_of_the_program() {
    for path in ["README.md"].into_iter().map(str::to_owned).chain(pages().into_iter().filter(|path| path.starts_with("docs/"))) {
        let text = read(&path);
        expect_page(&path, &console::with_outputs(&path, &text));
    }
}

#[test]
fn tables_shown_are_those_of_the_program() {
    for path in pages() {
        let text = read(&path);
        expect_page(&path, &tables::with_tables(&path, &text));
    }
}

/// Numbers of README and book are those of their files, and none beside a file is unchecked.
#[test]
fn numbers_shown_are_those_of_the_results() {
    let unknown: Vec<&str> = numbers::pages_named().filter(|page| !pages().iter().any(|path| path == page)).collect();
    assert!(unknown.is_empty(), "numbers.txt: no such pages: {unknown:?}");
    let mut left = Vec::new();
    for path in pages() {
        let text = read(&path);
        expect_page(&path, &numbers::with_numbers(&path, &text));
        left.extend(numbers::unchecked(&path, &text));
    }
    assert!(left.is_empty(), "numbers that nothing checks:\n{}", left.join("\n"));
}

/// What is said not to be modelled or possible is shown not to be.
#[test]
fn denials_are_true() {
    let schema = serde_json::from_str(&printed(&["scenario", "schema"])).expect("the schema is JSON");
    let wrong: Vec<String> = pages().iter().flat_map(|path| limits::false_denials(path, &read(path), &schema)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn pages_for_users_show_no_paths_of_code() {
    let schema = "docs/src/reference/scenario.schema.json".to_owned();
    let found: Vec<String> = pages().into_iter().chain([schema]).flat_map(|path| names::code_paths(&path, &read(&path))).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn values_of_options_have_the_words_of_the_glossary() {
    let wrong = names::badly_explained(&read("docs/src/reference/commands.md"));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn sentences_of_the_gallery_name_what_the_scenes_have() {
    let wrong = gallery::quantities_without_a_scene();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn commands_shown_are_understood() {
    let (mut n_commands, mut wrong) = (0, Vec::new());
    for path in pages() {
        for (line, arguments) in console::commands_shown(&read(&path)) {
            n_commands += 1;
            if let Some(why) = console::refusal(&arguments) {
                wrong.push(format!("{path}:{line}: {why}"));
            }
        }
    }
    assert!(n_commands >= 10, "{n_commands} commands are shown");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(console::refusal(&["run".into(), "x.json".into(), "--no-such-option".into()]).is_some());
}

#[test]
fn links_anchors_and_pictures_are_there() {
    let results =
        fs::read_dir(root().join("results")).expect("results are there").map(|entry| entry.expect("a folder can be read").file_name());
    let results = results.map(|name| format!("results/{}/README.md", name.to_string_lossy()));
    let broken: Vec<String> = pages().into_iter().chain(results).flat_map(|path| links::broken(&path)).collect();
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn every_page_stands_in_the_summary() {
    let summary = read("docs/src/SUMMARY.md");
    let missing: Vec<String> = pages()
        .into_iter()
        .filter_map(|page| page.strip_prefix("docs/src/").map(str::to_owned))
        .filter(|page| page != "SUMMARY.md" && !summary.contains(&format!("({page})")))
        .collect();
    assert!(missing.is_empty(), "{missing:?}");
}
