//! `run.json`: record of the runs that wrote the files of a directory.

use serde::{Deserialize, Serialize};
use std::path::Path;

/// Name of the file with the record of the runs.
pub(super) const NAME: &str = "run.json";

/// Version of the format of `run.json`. The program reads no files of other versions.
const FORM: u32 = 1;

/// Record of the runs that wrote the files of a directory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    form: u32,
    /// Runs of the directory. No file belongs to two runs.
    pub runs: Vec<RunRecord>,
}

/// A run of a command, with the names of the files that it wrote.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// Name of the command, as in `solve`.
    pub command: String,
    /// Name of the study.
    pub study: String,
    /// SHA-256 of the whole content of the study. For `sweep` and `merge`, a digest of the designs. For
    /// `compare`, a digest of the results.
    pub digest: String,
    /// Version of the program.
    pub version: String,
    /// True if the run ended without an interruption. Results may still be missing, for example at stations without a pose.
    pub finished: bool,
    /// True if a signal ended the run.
    #[serde(default)]
    pub interrupted: bool,
    /// Names of the files that the run wrote. A star represents digits.
    pub files: Vec<String>,
}

impl Default for Manifest {
    fn default() -> Self {
        Manifest {
            form: FORM,
            runs: Vec::new(),
        }
    }
}

impl Manifest {
    /// Reads the record of a directory. Empty if the file does not exist.
    pub fn read(directory: &Path) -> Result<Self, String> {
        let bytes = match std::fs::read(directory.join(NAME)) {
            Ok(bytes) => bytes,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Manifest::default()),
            Err(e) => return Err(e.to_string()),
        };
        let manifest: Manifest = serde_json::from_slice(&bytes).map_err(|e| e.to_string())?;
        match manifest.form {
            FORM => Ok(manifest),
            other => Err(format!(
                "written in format {other}, this version reads format {FORM}"
            )),
        }
    }

    /// Text of `run.json` for this record.
    pub fn text(&self) -> String {
        serde_json::to_string_pretty(self).expect("JSON can store a manifest") + "\n"
    }

    /// Run that wrote the file with this name. `None` if no run has recorded it.
    pub fn author(&self, name: &str) -> Option<&RunRecord> {
        self.runs.iter().find(|run| run.wrote(name))
    }
}

impl RunRecord {
    /// True if the run has this command and this digest (of the study, or for `sweep` of the designs).
    pub fn is_of(&self, command: &str, digest: &str) -> bool {
        self.command == command && self.digest == digest
    }

    /// True if digests of this run can be compared with digests of runs of `command`. `sweep` and `merge` use a digest of the
    /// designs; all other commands use a digest of the study.
    pub fn digests_as(&self, command: &str) -> bool {
        let is_of_designs = |command| ["sweep", "merge"].contains(&command);
        is_of_designs(&self.command) == is_of_designs(command)
    }

    /// True if the run wrote a file with this name.
    pub fn wrote(&self, name: &str) -> bool {
        let mut files = self.files.iter();
        files.any(|pattern| pattern == name || matches(pattern, name))
    }
}

/// True if a name matches the pattern, in which a star represents digits.
pub(super) fn matches(pattern: &str, name: &str) -> bool {
    let Some((before, after)) = pattern.split_once('*') else {
        return pattern == name;
    };
    let digits = name
        .strip_prefix(before)
        .and_then(|rest| rest.strip_suffix(after));
    digits.is_some_and(|digits| {
        !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_stands_for_digits_alone() {
        for (pattern, name, expected) in [
            ("curves.csv", "curves.csv", true),
            ("curves.csv", "curves_csv", false),
            ("part-*.csv", "part-000000012.csv", true),
            ("part-*.csv", "part-.csv", false),
            ("part-*.csv", "part-mine.csv", false),
            ("part-*.csv", "part-1.parquet", false),
        ] {
            assert_eq!(matches(pattern, name), expected, "{pattern} {name}");
        }
    }

    #[test]
    fn what_is_no_manifest_is_refused() {
        let directory = tempfile::tempdir().unwrap();
        assert_eq!(Manifest::read(directory.path()).unwrap().runs, []);
        for text in ["", "{}", "{\"form\": 2, \"runs\": []}", "[1"] {
            std::fs::write(directory.path().join(NAME), text).unwrap();
            assert!(Manifest::read(directory.path()).is_err(), "{text}");
        }
    }
}
