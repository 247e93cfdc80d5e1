//! `run.json`: which run wrote which files of a directory.

use serde::{Deserialize, Serialize};
use std::path::Path;

/// Name.
pub(super) const NAME: &str = "run.json";

/// The form of the file. A reader takes no other.
const FORM: u32 = 1;

/// Record of the runs that wrote the files of a directory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    form: u32,
    /// The runs; no file belongs to two of them.
    pub runs: Vec<RunRecord>,
}

/// A run and its files.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// The command, as in `solve`.
    pub command: String,
    /// The name of the study.
    pub study: String,
    /// SHA-256 of all that the study says.
    pub digest: String,
    /// The version of the program.
    pub version: String,
    /// True if the run has ended with all of its results.
    pub finished: bool,
    /// True if a signal ended the run before that.
    #[serde(default)]
    pub interrupted: bool,
    /// Names of the files. A star stands for digits.
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
    /// Reads that of a directory: an empty one if it does not exist.
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

    /// The text of the file.
    pub fn text(&self) -> String {
        serde_json::to_string_pretty(self).expect("a manifest is plain data") + "\n"
    }

    /// The run that wrote a file.
    pub fn author(&self, name: &str) -> Option<&RunRecord> {
        self.runs.iter().find(|run| run.wrote(name))
    }
}

impl RunRecord {
    /// Returns true if the run has this command and this study.
    pub fn is_of(&self, command: &str, digest: &str) -> bool {
        self.command == command && self.digest == digest
    }

    /// Returns true if its digest is comparable with that of this command: a sweep has a digest of its designs.
    pub fn digests_as(&self, command: &str) -> bool {
        let is_of_designs = |command| ["sweep", "merge"].contains(&command);
        is_of_designs(&self.command) == is_of_designs(command)
    }

    /// Returns true if a file is one of its files.
    pub fn wrote(&self, name: &str) -> bool {
        let mut files = self.files.iter();
        files.any(|pattern| pattern == name || matches(pattern, name))
    }
}

/// Returns true if a name matches the pattern, in which a star stands for digits.
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
