//! `hardpoint completions`: prints the completions of commands and options for a shell.

use super::Arguments;
use super::exit::{Exit, Stop};
use clap::CommandFactory;
use clap_complete::Shell;
use std::io::Write;

pub(super) fn run(shell: Shell) -> Result<Exit, Stop> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "hardpoint", &mut text);
    std::io::stdout().write_all(&text)?;
    Ok(Exit::Done)
}
