//! `hardpoint studio`: serves the live page on which the user drags points.

use super::exit::{Exit, Stop};
use super::{interrupt, terminal};
use crate::studio::{Invitation, Studio};
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Arguments of the live page.
#[derive(Args)]
pub(super) struct StudioArguments {
    /// The study file (TOML) [default: the page asks for a topology and writes a new study here]
    study: Option<PathBuf>,
    /// Port on this machine [default: 7353, or any free port if it is in use]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    port: Option<u16>,
    /// Do not open a browser
    #[arg(long)]
    no_open: bool,
}

pub(super) fn run(arguments: &StudioArguments) -> Result<Exit, Stop> {
    if arguments.study.as_deref() == Some(Path::new("-")) {
        return Err(Stop::wrong_input(
            "the live page saves to the study's file, so the study cannot come from standard input",
        ));
    }
    let studio = match &arguments.study {
        Some(study) => Studio::open(study, arguments.port),
        None => Studio::choose(std::env::current_dir()?, arguments.port),
    };
    let studio = studio.map_err(|why| {
        // The text of a study error begins with `error: `. The printed line adds this word again, so it is removed here.
        let why = why.to_string();
        Stop::wrong_input(why.strip_prefix("error: ").unwrap_or(&why))
    })?;
    let address = studio.address();
    let mut out = std::io::stdout();
    writeln!(out, "{address}")?;
    out.flush()?;
    terminal::note(
        "Keep this address private. Ctrl-C ends the server; unsaved changes stay in the browser.\n",
    );
    // From here on, a signal ends the server normally, so that the file with the address is removed.
    interrupt::stops_by_itself();
    let invitation = if arguments.no_open {
        None
    } else {
        invited(&address)
    };
    studio
        .serve(interrupt::flag(), invitation)
        .map_err(Stop::wrong_input)?;
    Ok(Exit::Interrupted)
}

/// Opens a browser that reads the address from a file, because other users can see the arguments of programs.
fn invited(address: &str) -> Option<Invitation> {
    let opened = Invitation::to(address).and_then(|invitation| {
        open::that_detached(invitation.path())?;
        Ok(invitation)
    });
    opened
        .inspect_err(|error| {
            terminal::note(&format!(
                "No browser could be opened ({error}): open the address yourself.\n"
            ));
        })
        .ok()
}
