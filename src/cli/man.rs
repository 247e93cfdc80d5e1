//! `hardpoint man`: prints the manual page of the program.

use super::Arguments;
use super::exit::{Exit, Stop};
use clap::CommandFactory;
use clap_mangen::Man;
use std::io::Write;

/// Prints one manual page: the program, then each command with its arguments.
pub(super) fn run() -> Result<Exit, Stop> {
    let mut command = Arguments::command();
    command.build();
    let mut text = Vec::new();
    Man::new(command.clone()).render(&mut text)?;
    for subcommand in command.get_subcommands().filter(|c| c.get_name() != "help") {
        let page = Man::new(subcommand.clone());
        writeln!(
            text,
            ".SH \"HARDPOINT {}\"",
            subcommand.get_name().to_uppercase()
        )?;
        if let Some(about) = subcommand.get_about() {
            writeln!(text, "{about}\n.PP")?;
        }
        page.render_synopsis_section(&mut text)?;
        page.render_options_section(&mut text)?;
    }
    std::io::stdout().write_all(&text)?;
    Ok(Exit::Done)
}
