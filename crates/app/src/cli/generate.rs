//! `cohaul completions` and `cohaul man`: files for shells and manuals, made from the command line.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Command};
use clap_complete::Shell;

use super::console::print;
use super::error::{CliError, at_output};

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul completions bash > ~/.local/share/bash-completion/completions/cohaul
  cohaul completions fish > ~/.config/fish/completions/cohaul.fish
  cohaul completions zsh > ~/.zfunc/_cohaul")]
pub struct CompletionsArgs {
    /// The shell
    shell: Shell,
}

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul man | man -l -
  cohaul man ~/.local/share/man/man1")]
pub struct ManArgs {
    /// Folder for one page a command; without it the main page is printed
    #[arg(value_name = "DIR")]
    folder: Option<PathBuf>,
}

pub fn completions(args: &CompletionsArgs, command: &mut Command) -> Result<ExitCode, CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, command, "cohaul", &mut script);
    print(&String::from_utf8_lossy(&script))?;
    Ok(ExitCode::SUCCESS)
}

pub fn man(args: &ManArgs, command: Command) -> Result<ExitCode, CliError> {
    match &args.folder {
        Some(folder) => {
            std::fs::create_dir_all(folder).map_err(at_output(folder))?;
            clap_mangen::generate_to(command, folder).map_err(at_output(folder))?;
        }
        None => {
            let mut page = Vec::new();
            clap_mangen::Man::new(command).render(&mut page)?;
            print(&String::from_utf8_lossy(&page))?;
        }
    }
    Ok(ExitCode::SUCCESS)
}
