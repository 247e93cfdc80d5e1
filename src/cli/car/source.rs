//! Cars that a command names by a study or by the directory of a run.

use super::super::exit::Stop;
use crate::study::CarStudy;
use std::path::{Path, PathBuf};

/// The file of a car: a study itself, or the study that a run keeps. After a tuning it is the tuned one. `None` if it is no
/// car.
pub(in crate::cli) fn file_of(source: &Path) -> Option<PathBuf> {
    let file = match source.is_dir() {
        true => {
            let kept = ["optimised.toml", "study.toml"].map(|name| source.join(name));
            kept.into_iter().find(|file| file.is_file())?
        }
        false => source.to_owned(),
    };
    CarStudy::is_at(&file).then_some(file)
}

/// The study of a file that [`file_of`] found.
pub(super) fn read(file: &Path, changes: &[String]) -> Result<CarStudy, Stop> {
    Ok(CarStudy::read(file, changes)?)
}
