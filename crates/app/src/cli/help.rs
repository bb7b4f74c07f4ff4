//! Help pages: the list of commands in groups, and what `-h` leaves to `--help`.

use clap::Command;
use clap::builder::styling::Styles;

use cohaul_report::table::wrapped;
use cohaul_report::text::WIDTH;

/// Commands by what they are for. The first group is what a newcomer needs: write or check a scene,
/// run it, compare it, look at it, and look up a term. A sweep comes after that, with the command
/// that joins its parts.
const GROUPS: [(&str, &[&str]); 5] = [
    ("Commands", &["run", "compare", "view", "render", "scenario", "explain"]),
    ("Many runs", &["sweep", "merge", "regime"]),
    ("Tests of a build, of backends and of engines", &["check", "verify", "conformance", "gate", "bench", "stress"]),
    ("The paper, and measurements", &["paper", "measured", "colony", "calibrate"]),
    ("This program", &["completions", "man"]),
];

/// The command line with its help as people read it.
pub fn arranged(command: Command) -> Command {
    let template = template(&command);
    command.mut_subcommands(with_pointer).help_template(template)
}

/// Help of the program, with its commands in groups.
fn template(command: &Command) -> String {
    let styles = Styles::styled();
    let (header, literal) = (styles.get_header(), styles.get_literal());
    let line = |name: &&str| {
        let found = command.find_subcommand(name).expect("a group has commands of the program");
        let about = found.get_about().map(ToString::to_string).unwrap_or_default();
        format!("  {literal}{name:<11}{literal:#}  {about}\n")
    };
    let group = |(title, names): &(&str, &[&str])| {
        let lines: String = names.iter().map(line).collect();
        format!("{header}{title}:{header:#}\n{lines}\n")
    };
    let groups: String = GROUPS.iter().map(group).collect();
    format!("{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{groups}{header}Options:{header:#}\n{{options}}{{after-help}}")
}

/// The command, whose `-h` names the options that only `--help` explains.
fn with_pointer(command: Command) -> Command {
    let command = command.mut_subcommands(with_pointer);
    let hidden = command.get_arguments().filter(|argument| argument.is_hide_short_help_set());
    let hidden: Vec<String> = hidden.filter_map(|argument| Some(format!("--{}", argument.get_long()?))).collect();
    if hidden.is_empty() {
        return command;
    }
    let pointer = wrapped(&format!("More options, which --help explains: {}", hidden.join(", ")), 2, WIDTH - 2);
    let after = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    command.after_long_help(after.clone()).after_help(format!("{pointer}\n\n{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_is_in_one_group() {
        let command = super::super::command();
        let mut known: Vec<&str> = command.get_subcommands().map(Command::get_name).collect();
        let mut grouped: Vec<&str> = GROUPS.iter().flat_map(|(_, names)| *names).copied().collect();
        known.sort_unstable();
        grouped.sort_unstable();
        assert_eq!(grouped, known);
    }
}
