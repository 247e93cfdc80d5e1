//! Commands for programs that call this library. They take studies in memory instead of files, and return errors instead of
//! printing text.

use super::exit::{Exit, Stop};
use super::{Arguments, Command, export, import, interrupt, sweep, terminal};
use crate::study::{Study, StudyErrors};
use crate::threads::stoppable;
use clap::Parser;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

/// Reason why a command inside another program has no result.
#[derive(Debug)]
pub enum NotDone {
    /// The study is wrong.
    WrongStudy(StudyErrors),
    /// The call or the input is wrong. Contains the reason in words.
    WrongInput(String),
    /// Some results could not be computed or written. Contains the reason in words.
    Incomplete(String),
    /// The command was interrupted.
    Interrupted,
}

impl From<Stop> for NotDone {
    fn from(stop: Stop) -> Self {
        match stop {
            Stop::WrongStudy(errors) => NotDone::WrongStudy(errors),
            Stop::ClosedPipe => {
                NotDone::Incomplete("the reader of the output closed it".to_owned())
            }
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
    let (ended, output) = terminal::capture(|| catch_unwind(AssertUnwindSafe(run)));
    match ended {
        Ok(Some(found)) => Ok((found?, output)),
        Ok(None) => Err(NotDone::Interrupted),
        Err(payload) if payload.is::<interrupt::Ended>() => Err(NotDone::Interrupted),
        Err(payload) => resume_unwind(payload),
    }
}

/// Parses the command from its arguments. The arguments do not contain the program's name.
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
    embedded(|| export::run_of(&arguments, Some(study))).map(|(_, output)| output)
}

/// `hardpoint import` that writes no study file. Returns the text of the study, and the summary of the import. `points` is a JSON
/// map that replaces the file. `names` maps hardpoints to their names in the file.
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
/// requested part is computed. Without shards, every design must also be solved and every output have a value.
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
