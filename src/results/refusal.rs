//! Refusals of a directory for the results of a run.

use super::Owner;
use std::path::PathBuf;

/// A file or directory that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {path}: {source}")]
pub struct WriteError {
    /// The file that was to be written.
    pub path: PathBuf,
    /// Error of the system.
    pub source: std::io::Error,
}

/// Refusal of a directory for the results of a run. Each names the file and a remedy.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// The directory cannot be written to.
    #[error(transparent)]
    Unwritable(#[from] WriteError),
    /// Another run writes there now.
    #[error(
        "{directory} is being written by {who}: wait for it, or give another directory with --out",
        who = owner.as_ref().map_or_else(|| "another run".to_owned(), Owner::to_string)
    )]
    Busy {
        /// The directory.
        directory: String,
        /// Process that writes, if known.
        owner: Option<Owner>,
    },
    /// The directory holds an input of the run under the name of a result.
    #[error(
        "{file} is an input of this run, and the results would overwrite it: give another directory \
         with --out"
    )]
    Input {
        /// The input.
        file: String,
    },
    /// The directory holds files that no run has written.
    #[error(
        "{file} exists already and is not from a run recorded in run.json: give another \
         directory with --out, or overwrite it with --force"
    )]
    Foreign {
        /// One of them.
        file: String,
    },
    /// The directory holds the results of another run.
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
        /// The directory.
        directory: String,
        /// Command that wrote the results.
        command: String,
        /// The name of their study.
        study: String,
        /// True for the same study, if known: sweeps and other commands use different digests.
        same_study: Option<bool>,
        /// True if that run has ended.
        is_finished: bool,
        /// One of its files.
        file: String,
    },
    /// The directory holds a sweep that has not ended.
    #[error(
        "{directory} holds an unfinished sweep of this study: continue it with --resume, or restart it \
         with --force"
    )]
    Unfinished {
        /// The directory.
        directory: String,
    },
    /// The record of the runs in the directory cannot be read.
    #[error(
        "hardpoint did not write {file} in this form ({reason}), so the files beside it are unknown: \
         give another directory with --out, or write there with --force"
    )]
    Unreadable {
        /// The record.
        file: String,
        /// Fault of the file.
        reason: String,
    },
}

impl Refusal {
    /// Message for a directory that another option than `--out` gives.
    pub fn with_option(&self, option: &str) -> String {
        let advice = |option| format!("give another directory with {option}");
        self.to_string().replace(&advice("--out"), &advice(option))
    }
}
