//! Finds the car that a command names by a study or by the directory of a run.

use super::super::exit::Stop;
use crate::study::CarStudy;
use std::path::{Path, PathBuf};

/// File of a car's study: the given file itself, or the study kept in a run's directory. After a tuning it is the tuned study.
/// `None` if the source is not a car.
pub(in crate::cli) fn file_of(source: &Path) -> Option<PathBuf> {
    let file = if source.is_dir() {
        let kept = ["optimised.toml", "study.toml"].map(|name| source.join(name));
        kept.into_iter().find(|file| file.is_file())?
    } else {
        source.to_owned()
    };
    CarStudy::is_at(&file).then_some(file)
}

/// Reads the study from a file that [`file_of`] returned.
pub(super) fn read(file: &Path, changes: &[String]) -> Result<CarStudy, Stop> {
    Ok(CarStudy::read(file, changes)?)
}
