//! Reads the results in a directory, from any command.

use super::car::{CAR_FORM, CarRecord};
use super::run::Run;
use super::sweep::SweepRun;
use serde::de::DeserializeOwned;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// A finished run.
#[derive(Clone, Debug)]
pub enum FinishedRun {
    /// Curves of one or two designs.
    Curves(Box<Run>),
    /// Many designs.
    Sweep(Box<SweepRun>),
    /// Load cases of a car.
    Car(Box<CarRecord>),
}

/// Reason why a directory does not contain the expected run.
#[derive(Debug, thiserror::Error)]
#[error("{path}: {reason}")]
pub struct NotARun {
    /// Directory of the run, or a file in this directory.
    pub path: PathBuf,
    /// Error in the file.
    pub reason: String,
}

impl NotARun {
    pub(super) fn at(path: impl Into<PathBuf>, reason: impl Display) -> Self {
        NotARun {
            path: path.into(),
            reason: reason.to_string(),
        }
    }
}

/// Reads the record of a run, if it has the format `form`. Error messages name the program or command that writes such records
/// (`writer`), and the `kind` of input to run again.
pub(super) fn in_form<T: DeserializeOwned>(
    text: &[u8],
    form: u32,
    [writer, kind]: [&str; 2],
) -> Result<T, String> {
    /// Part that all formats have in common.
    #[derive(serde::Deserialize)]
    struct Form {
        form: u32,
        version: String,
    }
    let wrong = |e: serde_json::Error| format!("not in the format of `{writer}`: {e}");
    let found: Form = serde_json::from_slice(text).map_err(wrong)?;
    if found.form == form {
        serde_json::from_slice(text).map_err(wrong)
    } else {
        Err(format!(
            "written in format {} by hardpoint {}, this version reads format {form}; run the {kind} again",
            found.form, found.version
        ))
    }
}

impl FinishedRun {
    /// Reads the directory of a sweep, or of another run that wrote `report.json`. If several commands wrote there, it reads the
    /// last run.
    pub fn read(directory: &Path) -> Result<Self, NotARun> {
        if is_sweep(directory) {
            return Ok(FinishedRun::Sweep(Box::new(SweepRun::read(directory)?)));
        }
        match CarRecord::read(directory)? {
            Some(car) => Ok(FinishedRun::Car(Box::new(car))),
            None => Ok(FinishedRun::Curves(Box::new(Run::read(directory)?))),
        }
    }
}

impl CarRecord {
    /// Reads the record of a car's run. `None` if the directory has no such record.
    pub(super) fn read(directory: &Path) -> Result<Option<Self>, NotARun> {
        #[derive(serde::Deserialize)]
        struct Kind {
            kind: Option<String>,
        }
        let path = directory.join("report.json");
        let Ok(text) = std::fs::read(&path) else {
            return Ok(None);
        };
        let kind = serde_json::from_slice::<Kind>(&text).ok();
        if kind.and_then(|kind| kind.kind).as_deref() != Some("car") {
            return Ok(None);
        }
        let record = in_form(&text, CAR_FORM, ["hardpoint", "study"]);
        record
            .map(Some)
            .map_err(|reason| NotARun::at(&path, reason))
    }
}

/// True if the last run was a sweep. Each run writes `summary.json` last, with its command. A sweep removes this file at its
/// start.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Several commands write the record of a car, so the message names none of them.
    #[test]
    fn an_old_record_of_a_car_names_no_command() {
        let directory = tempfile::tempdir().unwrap();
        let record = r#"{ "form": 0, "version": "0.0.1", "command": "tolerance", "kind": "car" }"#;
        std::fs::write(directory.path().join("report.json"), record).unwrap();
        let reason = CarRecord::read(directory.path()).unwrap_err().reason;
        assert!(reason.ends_with("; run the study again"), "{reason}");
    }
}
