//! Names of commands in a help text.

/// The names in all lists of subcommands of a help text, without `help` itself.
pub fn subcommands(help: &str) -> Vec<String> {
    let lists = help.lines().skip_while(|line| !line.ends_with(':')).take_while(|line| !["Arguments:", "Options:"].contains(line));
    let names = lists.filter(|line| line.starts_with("  ") && !line.starts_with("   ")).filter_map(|line| line.split_whitespace().next());
    names.filter(|name| *name != "help" && !name.starts_with(['-', '<'])).map(str::to_owned).collect()
}
