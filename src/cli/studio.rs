//! `hardpoint studio`

use super::exit::{Exit, Stop};
use super::{interrupt, terminal};
use crate::studio::Studio;
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Arguments of the live page.
#[derive(Args)]
pub(super) struct StudioArguments {
    /// The study file (TOML)
    study: PathBuf,
    /// Port on this machine [default: 7353, or any free port if it is in use]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    port: Option<u16>,
    /// Do not open a browser
    #[arg(long)]
    no_open: bool,
}

pub(super) fn run(arguments: &StudioArguments) -> Result<Exit, Stop> {
    if arguments.study == Path::new("-") {
        return Err(Stop::wrong_input(
            "the live page saves to the study's file; standard input is none",
        ));
    }
    let studio = Studio::open(&arguments.study, arguments.port).map_err(Stop::wrong_input)?;
    let address = studio.address();
    let mut out = std::io::stdout();
    writeln!(out, "{address}")?;
    out.flush()?;
    terminal::note(
        "Keep this address private. Ctrl-C ends the server; unsaved changes stay in the browser.\n",
    );
    if !arguments.no_open
        && let Err(error) = open::that_detached(&address)
    {
        terminal::note(&format!(
            "No browser could be opened ({error}): open the address yourself.\n"
        ));
    }
    studio.serve(interrupt::flag()).map_err(Stop::wrong_input)?;
    Ok(Exit::Interrupted)
}
