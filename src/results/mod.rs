//! The directories that hold the results of runs, and the rules by which one run may replace the files of another.
//!
//! A run records in `run.json` who wrote which files: the command, the digest of the study and the version
//! of the program ([`RunRecord`]). From then on
//!
//! 1. a file may be replaced by the same command with the same study, by nothing else;
//! 2. a file that no run has recorded belongs to someone else and is never touched, nor is an input;
//! 3. an unfinished sweep is continued or, on request, started anew;
//! 4. files appear whole or not at all: they are written under another name and renamed;
//! 5. while a run writes it holds a [`Lock`], which the operating system takes from it when it dies;
//! 6. the next run removes the temporary files of a run that died.
//!
//! `--force` lifts the first three.

mod claim;
mod lock;
mod manifest;
mod open_runs;
mod owner;
mod refusal;
mod run_directory;

pub use claim::{Claim, Sharing};
pub use lock::{Lock, NotLocked};
pub use manifest::{Manifest, RunRecord};
pub use open_runs::{exit_interrupted, put, undivided};
pub use owner::Owner;
pub use refusal::{Refusal, WriteError};
pub use run_directory::{RunDirectory, temporary, temporary_of};

use crate::study::{Designs, Study};
use std::path::Path;

/// Beginning of the names of all temporary files.
pub const TEMPORARY: &str = ".hardpoint-";

/// The file in which a run records its results.
pub const SUMMARY: &str = "summary.json";

/// A `summary.json` with its first two keys, which say whether the run has finished and whether a signal ended it.
fn restated(text: &str, finished: bool, interrupted: bool) -> String {
    let head = |finished: bool, interrupted: bool| {
        format!("\n  \"finished\": {finished},\n  \"interrupted\": {interrupted},")
    };
    let mut body = text.strip_prefix('{').unwrap_or(text);
    for [finished, interrupted] in [[false, false], [false, true], [true, false]] {
        body = body
            .strip_prefix(&head(finished, interrupted))
            .unwrap_or(body);
    }
    format!("{{{}{body}", head(finished, interrupted))
}

/// SHA-256 of the whole content of a study: its text, with the changes by `--set` and the curves from files in it,
/// and the file of its designs.
pub fn study_digest(study: &Study) -> String {
    let mut hash = hmac_sha256::Hash::new();
    hash.update(study.text.as_bytes());
    match study.sweep.as_ref().map(|sweep| &sweep.designs) {
        // A file that cannot be read is an error of the sweep; other commands do without.
        Some(Designs::File(path)) => hash.update(std::fs::read(path).unwrap_or_default()),
        Some(Designs::Given(table)) => hash.update(table.digest),
        Some(Designs::Sampled(_)) | None => {}
    }
    hex(&hash.finalize())
}

/// The digest of several texts that a run is made from.
pub fn digest_of_texts(texts: &[&str]) -> String {
    let mut hash = hmac_sha256::Hash::new();
    for text in texts {
        // The length keeps texts apart.
        hash.update(text.len().to_le_bytes());
        hash.update(text.as_bytes());
    }
    hex(&hash.finalize())
}

/// Bytes as hexadecimal digits.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Makes a write error of an I/O error at a path.
pub fn unwritten(path: &Path) -> impl FnOnce(std::io::Error) -> WriteError + '_ {
    move |source| WriteError {
        path: path.to_owned(),
        source,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_is_restated_once() {
        let text = "{\n  \"study\": \"a\"\n}\n";
        let begun = restated(text, false, false);
        let value: serde_json::Value = serde_json::from_str(&begun).unwrap();
        assert_eq!(value["finished"], false);
        assert_eq!(value["study"], "a");
        for [finished, interrupted] in [[true, false], [false, true], [false, false]] {
            let again = restated(&begun, finished, interrupted);
            assert_eq!(again, restated(text, finished, interrupted));
            assert_eq!(restated(&again, false, false), begun);
        }
    }
}
