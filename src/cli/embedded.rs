//! Commands for programs that call this library: studies in memory instead of files, errors instead of text.

use super::exit::{Exit, Stop};
use super::{Arguments, Command, export, import, interrupt, sweep, terminal};
use crate::study::{Study, StudyErrors};
use crate::threads::stoppable;
use clap::Parser;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

/// Reason why an embedded command has no result.
#[derive(Debug)]
pub enum NotDone {
    /// The study is wrong.
    WrongStudy(StudyErrors),
    /// The call or the input is wrong, in words.
    WrongInput(String),
    /// A part could not be solved or written, in words.
    Incomplete(String),
    /// The command was interrupted.
    Interrupted,
}

impl From<Stop> for NotDone {
    fn from(stop: Stop) -> Self {
        match stop {
            Stop::WrongStudy(errors) => NotDone::WrongStudy(errors),
            Stop::ClosedPipe => NotDone::Incomplete("nobody reads the output".to_owned()),
            Stop::Failed { message, exit } => {
                let text = message.trim_end();
                let text = text.strip_prefix("error: ").unwrap_or(text).to_owned();
                match exit {
                    Exit::WrongInput => NotDone::WrongInput(text),
                    _ => NotDone::Incomplete(text),
                }
            }
        }
    }
}

/// Runs a command on this thread. Returns its result and its remarks.
fn embedded<T>(run: impl FnOnce() -> Result<T, Stop>) -> Result<(T, String), NotDone> {
    crate::attia::register();
    let run = || stoppable(interrupt::stop(), run);
    let (ended, said) = terminal::capture(|| catch_unwind(AssertUnwindSafe(run)));
    match ended {
        Ok(Some(found)) => Ok((found?, said)),
        Ok(None) => Err(NotDone::Interrupted),
        Err(payload) if payload.is::<interrupt::Ended>() => Err(NotDone::Interrupted),
        Err(payload) => resume_unwind(payload),
    }
}

/// The command of these arguments; the program's name is left out.
fn parsed(arguments: &[String]) -> Result<Command, NotDone> {
    let program = ["hardpoint".to_owned()];
    let arguments = Arguments::try_parse_from(program.iter().chain(arguments));
    let arguments = arguments.map_err(|error| NotDone::WrongInput(error.render().to_string()))?;
    Ok(arguments.command)
}

/// `hardpoint export` of a study in memory. The source in `arguments` is only a name for messages. Returns the remarks.
pub fn export_study(study: &Study, arguments: &[String]) -> Result<String, NotDone> {
    let Command::Export(arguments) = parsed(arguments)? else {
        return Err(NotDone::WrongInput("expected an export".to_owned()));
    };
    embedded(|| export::run_of(&arguments, Some(study))).map(|(_, said)| said)
}

/// `hardpoint import` without a study file: the text of the study, and the summary of the import. `points` is a map in JSON in place
/// of the file, `names` are those in the file by hardpoint.
pub fn import_study(
    arguments: &[String],
    points: Option<&str>,
    names: BTreeMap<String, String>,
) -> Result<(String, String), NotDone> {
    let Command::Import(arguments) = parsed(arguments)? else {
        return Err(NotDone::WrongInput("expected an import".to_owned()));
    };
    let (found, _) = embedded(|| import::in_memory(&arguments, points, &names))?;
    Ok(found)
}

/// `hardpoint sweep` of a study in memory. The study in `arguments` is only a name for messages. Returns true if every
/// part that was asked for is whole.
pub fn sweep_study(study: &Study, arguments: &[String]) -> Result<bool, NotDone> {
    let Command::Sweep(arguments) = parsed(arguments)? else {
        return Err(NotDone::WrongInput("expected a sweep".to_owned()));
    };
    let (exit, _) = embedded(|| sweep::run_study(&arguments, study))?;
    match exit {
        Exit::Interrupted => Err(NotDone::Interrupted),
        exit => Ok(exit == Exit::Done),
    }
}
