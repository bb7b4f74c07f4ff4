//! The page of commands, from the program's help.

use crate::help::subcommands;
use crate::printed;

const TITLE: &str = "# Commands

Generated from the program: this is `cohaul help` for every command. All commands end with the
[exit codes](../runs.md#exit-codes) of the program.
";

pub fn page() -> String {
    let mut page = TITLE.to_owned();
    let mut open: Vec<Vec<String>> = vec![Vec::new()];
    while let Some(command) = open.pop() {
        let mut arguments: Vec<&str> = command.iter().map(String::as_str).collect();
        arguments.push("--help");
        let help = printed(&arguments);
        let name = ["cohaul"].into_iter().chain(command.iter().map(String::as_str)).collect::<Vec<_>>().join(" ");
        let lines: Vec<&str> = help.lines().map(str::trim_end).collect();
        page += &format!("\n## {name}\n\n```text\n{}\n```\n", lines.join("\n").trim_end());
        let below = subcommands(&help).into_iter().rev();
        open.extend(below.map(|below| command.iter().cloned().chain([below]).collect()));
    }
    page
}
