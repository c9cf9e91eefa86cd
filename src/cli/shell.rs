//! `completions` and `man`: the program for shells and readers of manuals.

use super::Cli;
use super::output::{self, Output};
use anyhow::Context;
use clap::{Args, Command, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// Print the completions of a shell
#[derive(Debug, Args)]
#[command(after_long_help = COMPLETIONS)]
pub struct Completions {
    /// The shell
    shell: Shell,
}

const COMPLETIONS: &str = "\
Examples:
  lugwheel completions bash > ~/.local/share/bash-completion/completions/lugwheel
  lugwheel completions zsh > ~/.zfunc/_lugwheel
  lugwheel completions fish > ~/.config/fish/completions/lugwheel.fish";

/// Print the manual page, or write one of every command
#[derive(Debug, Args)]
#[command(after_long_help = MANUAL)]
pub struct Manual {
    /// Folder for the pages of all commands
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

const MANUAL: &str = "\
Examples:
  lugwheel man | man -l -
  lugwheel man --out ~/.local/share/man/man1";

impl Completions {
    /// Prints them.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "lugwheel", &mut script);
        output.print(&Text(String::from_utf8(script)?))
    }
}

impl Manual {
    /// Prints the page of the program, or writes those of all commands.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        let mut program = Cli::command();
        program.build();
        let Some(folder) = &self.out else {
            return output.print(&Text(page(&program)?));
        };
        let mut pages = Vec::new();
        add_pages(&program, "", &mut pages)?;
        let claim = output.claim(&[]);
        claim.own_folder(folder)?;
        claim.files_in(folder, pages.iter().map(|(name, _)| name))?;
        for (name, text) in &pages {
            output::write_file(&folder.join(name), text)?;
        }
        output.print(&Pages {
            folder: folder.display().to_string(),
            pages: pages.into_iter().map(|(name, _)| name).collect(),
        })
    }
}

/// Adds the page of a command behind `parent`, and those of its subcommands.
fn add_pages(
    command: &Command,
    parent: &str,
    pages: &mut Vec<(String, String)>,
) -> anyhow::Result<()> {
    let name = match parent {
        "" => command.get_name().to_owned(),
        parent => format!("{parent}-{}", command.get_name()),
    };
    pages.push((format!("{name}.1"), page(command)?));
    let own = command.get_subcommands();
    for inner in own.filter(|inner| inner.get_name() != "help") {
        add_pages(inner, &name, pages)?;
    }
    Ok(())
}

fn page(command: &Command) -> anyhow::Result<String> {
    let mut page = Vec::new();
    Man::new(command.clone())
        .render(&mut page)
        .context("cannot make the manual page")?;
    Ok(String::from_utf8(page)?)
}

#[derive(Serialize)]
struct Text(String);

impl fmt::Display for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// What was written.
#[derive(Serialize)]
struct Pages {
    folder: String,
    pages: Vec<String>,
}

impl fmt::Display for Pages {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} manual pages written to {}",
            self.pages.len(),
            self.folder
        )
    }
}
