//! The directory a run writes to.

use std::io::Write;
use std::path::{Path, PathBuf};

/// A file or directory that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {path}: {source}")]
pub struct WriteError {
    /// What was to be written.
    pub path: PathBuf,
    /// Why it could not be.
    pub source: std::io::Error,
}

/// Commands whose results take long to get, and a file that tells them.
const LONG_RUNS: [(&str, &str); 2] = [("sweep", "sweep.json"), ("optimise", "optimised.toml")];

/// A directory that is not for the results of a run.
#[derive(Debug, thiserror::Error)]
pub enum NoPlace {
    /// It cannot be written.
    #[error(transparent)]
    Unwritable(#[from] WriteError),
    /// It holds what would be lost.
    #[error(
        "{path} holds the results of `hardpoint {command}` ({file}), which would be lost: give another \
         directory with --out, or remove it"
    )]
    Taken {
        /// The directory.
        path: String,
        /// Whose results they are.
        command: &'static str,
        /// What tells so.
        file: &'static str,
    },
}

/// An output directory. Files appear in it whole or not at all.
#[derive(Debug)]
pub struct RunDirectory {
    path: PathBuf,
}

impl RunDirectory {
    /// Makes the directory and sees whether files can be made in it, before anything is computed.
    pub fn create(path: &Path) -> Result<Self, WriteError> {
        let failed = |source| WriteError {
            path: path.to_owned(),
            source,
        };
        std::fs::create_dir_all(path).map_err(failed)?;
        tempfile::NamedTempFile::new_in(path).map_err(failed)?;
        Ok(RunDirectory {
            path: path.to_owned(),
        })
    }

    /// The directory for the results of a command. Those of the same command are replaced, and those of
    /// commands that take no time.
    pub fn claim(path: &Path, command: &str) -> Result<Self, NoPlace> {
        for (owner, file) in LONG_RUNS {
            if owner != command && path.join(file).is_file() {
                return Err(NoPlace::Taken {
                    path: path.display().to_string(),
                    command: owner,
                    file,
                });
            }
        }
        Ok(RunDirectory::create(path)?)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a file: beside its place first, then moved there.
    pub fn write(&self, name: &str, contents: &[u8]) -> Result<(), WriteError> {
        let path = self.path.join(name);
        let written = || -> std::io::Result<()> {
            let mut file = temporary(&self.path)?;
            file.write_all(contents)?;
            file.flush()?;
            file.persist(&path).map_err(|e| e.error)?;
            Ok(())
        };
        written().map_err(|source| WriteError {
            path: path.clone(),
            source,
        })
    }

    /// Removes a file of an earlier run, if there is one: beside the new results it would speak of others.
    pub fn remove(&self, name: &str) -> Result<(), WriteError> {
        let path = self.path.join(name);
        match std::fs::remove_file(&path) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                Err(WriteError { path, source })
            }
            _ => Ok(()),
        }
    }
}

/// A file beside the place it will take when it is whole.
pub(super) fn temporary(directory: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    tempfile::Builder::new()
        .prefix(".hardpoint-")
        .permissions(readable())
        .tempfile_in(directory)
}

/// Ordinary permissions: a temporary file would be the owner's alone.
#[cfg(unix)]
fn readable() -> std::fs::Permissions {
    std::os::unix::fs::PermissionsExt::from_mode(0o644)
}

#[cfg(not(unix))]
fn readable() -> std::fs::Permissions {
    // Elsewhere permissions are inherited from the directory; there is nothing to set, but the type
    // has no constructor of its own.
    std::fs::metadata(".")
        .map(|m| m.permissions())
        .expect("the current directory exists")
}
