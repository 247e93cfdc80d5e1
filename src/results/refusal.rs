//! Reasons why a run may not write to a directory.

use super::Owner;
use std::path::PathBuf;

/// A file or directory that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {path}: {source}")]
pub struct WriteError {
    /// File that could not be written.
    pub path: PathBuf,
    /// Error of the operating system.
    pub source: std::io::Error,
}

/// Reason why a run may not write to a directory. Each message names a path. Each message but `Unwritable` also names a remedy.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// The directory cannot be written to.
    #[error(transparent)]
    Unwritable(#[from] WriteError),
    /// Another run is writing to the directory.
    #[error(
        "{directory} is being written by {who}: wait for it, or give another directory with --out",
        who = owner.as_ref().map_or_else(|| "another run".to_owned(), Owner::to_string)
    )]
    Busy {
        /// Path of the directory.
        directory: String,
        /// Process that is writing. `None` if it is not known.
        owner: Option<Owner>,
    },
    /// An input of the run has the name of a result in this directory.
    #[error(
        "{file} is an input of this run, and the results would overwrite it: give another directory \
         with --out"
    )]
    Input {
        /// Path of the input.
        file: String,
    },
    /// A result would replace a file that no run has recorded.
    #[error(
        "{file} exists already and is not from a run recorded in run.json: give another \
         directory with --out, or overwrite it with --force"
    )]
    Foreign {
        /// Path of the file.
        file: String,
    },
    /// A result would replace a file of another run.
    #[error(
        "{directory} holds the {unfinished}results of `hardpoint {command}` {of} ({file}), which would be lost: \
         give another directory with --out, or replace them with --force",
        unfinished = if *is_finished { "" } else { "unfinished " },
        of = match same_study {
            Some(true) => "of this study".to_owned(),
            Some(false) => "of another study, or of another version of this study".to_owned(),
            None => format!("of the study {study}"),
        }
    )]
    Taken {
        /// Path of the directory.
        directory: String,
        /// Command that wrote the results.
        command: String,
        /// Name of the study of the results.
        study: String,
        /// True if the results belong to the same study. `None` if this is unknown, because sweeps and other commands use
        /// different digests.
        same_study: Option<bool>,
        /// True if that run has ended.
        is_finished: bool,
        /// A file of the other run.
        file: String,
    },
    /// The directory contains an unfinished sweep.
    #[error(
        "{directory} holds an unfinished sweep of this study: continue it with --resume, or restart it \
         with --force"
    )]
    Unfinished {
        /// Path of the directory.
        directory: String,
    },
    /// The record of the runs in the directory cannot be read.
    #[error(
        "{file} is not in the format that hardpoint writes ({reason}), so the origin of the other files there is \
         unknown: give another directory with --out, or write there with --force"
    )]
    Unreadable {
        /// Path of the record.
        file: String,
        /// Error in the file.
        reason: String,
    },
}

impl Refusal {
    /// Message for a directory that is given by the option `option` instead of `--out`.
    pub fn with_option(&self, option: &str) -> String {
        let advice = |option| format!("give another directory with {option}");
        self.to_string().replace(&advice("--out"), &advice(option))
    }
}
