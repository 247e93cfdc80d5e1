//! Directories with results of runs, and the rules by which a run may replace the files of another run.
//!
//! A run records in `run.json` which files it wrote, with the command, the digest of the study and the version of the program
//! ([`RunRecord`]). From then on:
//!
//! 1. Only the same command with the same study may replace a file.
//! 2. A file that no run has recorded belongs to the user and is never touched. The same is true for every input.
//! 3. An unfinished sweep is continued or, on request, started again.
//! 4. A file appears completely or not at all, because the program writes it under another name and then renames it.
//! 5. While a run writes, it holds a [`Lock`]. If the run dies, the operating system releases the lock.
//! 6. The next run removes the temporary files of a run that died.
//!
//! `--force` cancels the first three rules, but an input is never replaced.

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
pub use open_runs::{exit_interrupted, make_directory, put, undivided, write_whole};
pub use owner::Owner;
pub use refusal::{Refusal, WriteError};
pub use run_directory::{RunDirectory, temporary, temporary_of};

use crate::study::{Designs, Study};
use std::path::Path;

/// Prefix of the names of all temporary files.
pub const TEMPORARY: &str = ".hardpoint-";

/// File in which a run records its results.
pub const SUMMARY: &str = "summary.json";

/// Text of a `summary.json` with new values of its first two keys: `finished`, and `interrupted` (true if a signal ended the run).
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

/// SHA-256 of the whole content of a study, as hexadecimal digits. The content is the text with the changes of `--set` and with
/// curves from files, and the file of the designs of its sweep.
pub fn study_digest(study: &Study) -> String {
    let mut hash = hmac_sha256::Hash::new();
    hash.update(study.text.as_bytes());
    match study.sweep.as_ref().map(|sweep| &sweep.designs) {
        // An unreadable file of designs is an error of the sweep only, because other commands do not need this file.
        Some(Designs::File(path)) => hash.update(std::fs::read(path).unwrap_or_default()),
        Some(Designs::Given(table)) => hash.update(table.digest),
        Some(Designs::Sampled(_)) | None => {}
    }
    hex(&hash.finalize())
}

/// SHA-256 of several texts from which a run is made, as hexadecimal digits.
pub fn digest_of_texts(texts: &[&str]) -> String {
    let mut hash = hmac_sha256::Hash::new();
    for text in texts {
        // The length separates the texts, so that different texts never give the same input.
        hash.update(text.len().to_le_bytes());
        hash.update(text.as_bytes());
    }
    hex(&hash.finalize())
}

/// Bytes as hexadecimal digits.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Converts an I/O error at a path to a write error.
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
