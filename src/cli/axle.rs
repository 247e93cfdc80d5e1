//! Refusals of commands that support one wheel only.

use super::exit::Stop;
use crate::study::Study;
use std::path::Path;

/// Refuses a study of an axle in a command that knows one wheel; `why` says so in a sentence.
pub(super) fn refuse(study: &Study, path: &Path, command: &str, why: &str) -> Result<(), Stop> {
    match study.axle {
        None => Ok(()),
        Some(_) => Err(Stop::in_file(
            path,
            format!(
                "axle: `hardpoint {command}` is not available for axles: {why}. Remove [axle] to use it on the left \
                 wheel"
            ),
        )),
    }
}
