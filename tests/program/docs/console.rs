//! Commands in README and book: outputs below `$ cohaul ...`, and commands that are only shown.
//!
//! A block `json NAME` is a file that the commands of its page may read. In a block `console`, a
//! line that begins with `$ ` is a command and the lines below it are what it prints.

use std::fs;
use std::os::unix::fs::symlink;

use crate::{cohaul, root};

/// A fenced block of a page: its first line (the number of it and what it says), and what it holds.
struct Block<'a> {
    line: usize,
    info: &'a str,
    lines: Vec<&'a str>,
}

fn blocks(text: &str) -> Vec<Block<'_>> {
    let mut found: Vec<Block> = Vec::new();
    let mut is_open = false;
    for (at, line) in text.lines().enumerate() {
        match line.strip_prefix("```") {
            Some(info) if !is_open => found.push(Block { line: at, info, lines: Vec::new() }),
            None if is_open => found.last_mut().expect("a block is open").lines.push(line),
            _ => {}
        }
        is_open ^= line.starts_with("```");
    }
    found
}

/// The page with what its commands print now.
pub fn with_outputs(path: &str, text: &str) -> String {
    let blocks = blocks(text);
    if !blocks.iter().any(|block| block.info == "console") {
        return text.to_owned();
    }
    let folder = tempfile::tempdir().expect("a folder can be made");
    for name in ["scenarios", "data", "examples", "tests"] {
        symlink(root().join(name), folder.path().join(name)).expect("a link can be made");
    }
    let mut lines: Vec<String> = Vec::new();
    let mut next = 0;
    let all: Vec<&str> = text.lines().collect();
    for block in &blocks {
        if let Some(name) = block.info.strip_prefix("json ") {
            fs::write(folder.path().join(name), block.lines.join("\n")).expect("a file can be written");
        }
        if block.info != "console" {
            continue;
        }
        lines.extend(all[next..=block.line].iter().map(|line| (*line).to_owned()));
        next = block.line + 1 + block.lines.len();
        for command in block.lines.iter().filter_map(|line| line.strip_prefix("$ ")) {
            let output = cohaul(&arguments(command).unwrap_or_else(|| panic!("{path}: not a command: {command}")), folder.path());
            lines.push(format!("$ {command}"));
            lines.extend(output_of(output, &block.lines));
        }
    }
    lines.extend(all[next..].iter().map(|line| (*line).to_owned()));
    lines.join("\n") + "\n"
}

/// What a command prints; where that names a time of this machine, the line that the page has.
fn output_of(mut command: std::process::Command, shown: &[&str]) -> Vec<String> {
    const TIMES: [&str; 2] = ["wall time", "wall-clock"];
    let output = command.output().expect("the program runs");
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    let is_time = |line: &str| TIMES.iter().any(|time| line.contains(time));
    let as_shown = |line: &str| shown.iter().find(|shown| is_time(shown)).map_or(line.to_owned(), |shown| (*shown).to_owned());
    text.lines().map(str::trim_end).map(|line| if is_time(line) { as_shown(line) } else { line.to_owned() }).collect()
}

/// Lines and arguments of the commands in blocks of shell and console.
pub fn commands_shown(text: &str) -> Vec<(usize, Vec<String>)> {
    let shells = blocks(text).into_iter().filter(|block| ["sh", "console"].contains(&block.info));
    let lines = shells.flat_map(|block| {
        let joined = block.lines.join("\n").replace("\\\n", " ");
        joined.lines().map(|line| (block.line + 1, line.to_owned())).collect::<Vec<_>>()
    });
    lines.filter_map(|(line, command)| Some((line, arguments(&command)?))).collect()
}

/// Arguments of a command that runs the program; `None` of another.
fn arguments(command: &str) -> Option<Vec<String>> {
    let command = command.trim_start_matches("$ ");
    let rest = ["cohaul ", "cargo run --release -- "].iter().find_map(|start| command.strip_prefix(start))?;
    Some(rest.split('|').next()?.split('>').next()?.split_whitespace().map(|word| word.trim_matches(['\'', '"']).to_owned()).collect())
}

/// Why the program does not understand these arguments.
pub fn refusal(arguments: &[String]) -> Option<String> {
    let with_help: Vec<String> = arguments.iter().cloned().chain(["--help".to_owned()]).collect();
    let output = cohaul(&with_help, &root()).output().expect("the program runs");
    (!output.status.success()).then(|| format!("{}: {}", arguments.join(" "), String::from_utf8_lossy(&output.stderr)))
}
