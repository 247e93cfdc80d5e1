//! Whatever was run in a directory, read back.

use super::run::{Run, RunError};
use super::sweep::{NotThisSweep, SweepRun};
use std::path::Path;

/// A run that has ended.
#[derive(Clone, Debug)]
pub enum FinishedRun {
    /// Curves of one or two designs.
    Curves(Box<Run>),
    /// Many designs.
    Sweep(Box<SweepRun>),
}

/// Why a directory cannot be reported on.
#[derive(Debug, thiserror::Error)]
pub enum NotFinished {
    /// It is not that of a solve or an optimisation.
    #[error(transparent)]
    Curves(#[from] RunError),
    /// It is not that of a sweep.
    #[error(transparent)]
    Sweep(#[from] NotThisSweep),
}

impl FinishedRun {
    /// Reads the directory of a solve, an optimisation or a sweep: of the one that ran last, where
    /// several wrote to the same place.
    pub fn read(directory: &Path) -> Result<Self, NotFinished> {
        match is_sweep(directory) {
            true => Ok(FinishedRun::Sweep(Box::new(SweepRun::read(directory)?))),
            false => Ok(FinishedRun::Curves(Box::new(Run::read(directory)?))),
        }
    }
}

/// `summary.json` comes last and says what it is of. A sweep removes it as it begins.
fn is_sweep(directory: &Path) -> bool {
    #[derive(serde::Deserialize)]
    struct Summary {
        command: String,
    }
    let text = std::fs::read(directory.join("summary.json")).ok();
    let summary = text.and_then(|text| serde_json::from_slice::<Summary>(&text).ok());
    let is_there = directory.join("sweep.json").is_file();
    is_there && summary.is_none_or(|summary| summary.command == "sweep")
}
