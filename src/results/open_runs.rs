//! Runs that this process is writing. If a signal ends the process, the directories of the runs record the interruption.

use super::manifest::{Manifest, NAME, RunRecord};
use super::{SUMMARY, TEMPORARY, restated, temporary};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A run in progress.
#[derive(Debug)]
pub(super) struct OpenRun {
    pub(super) path: PathBuf,
    pub(super) command: String,
    pub(super) digest: String,
    /// True if the run computes results. False if it makes files from a finished run.
    pub(super) computes: bool,
    /// True if the command writes `summary.json`.
    pub(super) has_summary: bool,
    /// True if no other process writes to the directory.
    pub(super) is_alone: bool,
}

/// Runs in progress. Only the holder of this mutex may write results. The code that handles a signal locks the mutex before it
/// ends the process, so that no write is interrupted halfway.
static OPEN: Mutex<Vec<OpenRun>> = Mutex::new(Vec::new());

fn open() -> MutexGuard<'static, Vec<OpenRun>> {
    // The list is complete even after a panic in a thread, so a poisoned lock is harmless.
    OPEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Executes a write that no signal can interrupt.
pub fn undivided<T>(write: impl FnOnce() -> T) -> T {
    let _open = open();
    write()
}

/// Registers a run in progress and executes its first write. No signal can take effect between the two steps.
pub(super) fn begin<T>(run: OpenRun, first: impl FnOnce() -> T) -> T {
    let mut open = open();
    open.push(run);
    first()
}

/// Removes a run from the list of runs in progress and executes its last write. No signal can take effect between the two steps.
pub(super) fn end<T>(path: &Path, last: impl FnOnce() -> T) -> T {
    let mut open = open();
    open.retain(|run| run.path != path);
    last()
}

/// Records every run in progress that computes results as interrupted, and ends the process. No other write happens in between.
pub fn exit_interrupted(code: i32) -> ! {
    let mut open = open();
    for run in open.drain(..) {
        if run.computes {
            // If this write fails, `run.json` still states that the run has not finished, which is true.
            let _ = run.record_interruption();
        }
        if run.is_alone {
            clear(&run.path);
        }
    }
    super::lock::release_all();
    std::process::exit(code)
}

impl OpenRun {
    fn record_interruption(&self) -> io::Result<()> {
        let mut manifest = Manifest::read(&self.path).map_err(io::Error::other)?;
        let is_own = |run: &RunRecord| run.is_of(&self.command, &self.digest);
        let had_summary = manifest.author(SUMMARY).is_some_and(is_own);
        for run in &mut manifest.runs {
            let own = is_own(run);
            if own {
                run.finished = false;
                run.interrupted = true;
            }
            if self.has_summary && own && !run.wrote(SUMMARY) {
                run.files.push(SUMMARY.to_owned());
            } else if self.has_summary && !own {
                run.files.retain(|name| name != SUMMARY);
            }
        }
        put(&self.path.join(NAME), manifest.text().as_bytes())?;
        if !self.has_summary {
            return Ok(());
        }
        let former = std::fs::read_to_string(self.path.join(SUMMARY));
        let text = former
            .ok()
            .filter(|text| had_summary && text.starts_with('{'));
        let text = text.unwrap_or_else(|| {
            let command = serde_json::Value::from(self.command.as_str());
            format!("{{\n  \"command\": {command}\n}}\n")
        });
        put(
            &self.path.join(SUMMARY),
            restated(&text, false, true).as_bytes(),
        )
    }
}

/// Removes the temporary files and the lock file of a directory. They belong to this process, because no other process writes
/// there.
fn clear(directory: &Path) {
    for entry in std::fs::read_dir(directory).into_iter().flatten().flatten() {
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_file && entry.file_name().to_string_lossy().starts_with(TEMPORARY) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Writes a file completely or not at all. No signal can interrupt the write. A named pipe or a character device receives the
/// contents.
pub fn write_whole(path: &Path, contents: &[u8]) -> io::Result<()> {
    if is_stream(path) {
        // The reader of the pipe determines how long this write takes, so a signal may interrupt it.
        let mut stream = std::fs::OpenOptions::new().write(true).open(path)?;
        return stream.write_all(contents);
    }
    undivided(|| put(path, contents))
}

/// Writes a file under a temporary name, then renames it. A symbolic link stays, and its target is replaced. Within
/// [`undivided`], no signal can interrupt it.
pub fn put(path: &Path, contents: &[u8]) -> io::Result<()> {
    let path = &target(path);
    match std::fs::metadata(path) {
        Ok(there) if there.is_dir() => return Err(io::Error::other("it is a directory")),
        Ok(there) if !there.is_file() => {
            return Err(io::Error::other("it exists and is not a regular file"));
        }
        _ => {}
    }
    let directory = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    if let Some(file) = directory.filter(|folder| folder.is_file()) {
        return Err(not_a_directory(file));
    }
    let mut file = temporary(directory.unwrap_or(Path::new(".")))?;
    file.write_all(contents)?;
    file.flush()?;
    file.persist(path).map_err(|e| e.error)?;
    Ok(())
}

/// File to which a symbolic link leads, also if that file does not exist yet. Other paths stay unchanged.
fn target(path: &Path) -> PathBuf {
    const LONGEST_CHAIN: usize = 40;
    let mut path = path.to_owned();
    for _ in 0..LONGEST_CHAIN {
        let Ok(link) = std::fs::read_link(&path) else {
            break;
        };
        path = path.parent().unwrap_or(Path::new("")).join(link);
    }
    path
}

/// True for a named pipe and a character device, which are written into and cannot be replaced.
#[cfg(unix)]
fn is_stream(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    let kind = std::fs::metadata(path).map(|there| there.file_type());
    kind.is_ok_and(|kind| kind.is_fifo() || kind.is_char_device())
}

#[cfg(not(unix))]
fn is_stream(_: &Path) -> bool {
    false
}

/// Makes a directory and all missing directories above it. If a file prevents this, the error names the file.
pub fn make_directory(path: &Path) -> io::Result<()> {
    std::fs::create_dir_all(path).map_err(|error| {
        let there = path.ancestors().find(|above| above.exists());
        match there.filter(|there| !there.is_dir()) {
            Some(file) => not_a_directory(file),
            None => error,
        }
    })
}

/// Error for a path at which there is a file instead of a directory.
pub(super) fn not_a_directory(file: &Path) -> io::Error {
    let message = format!("{} is a file; expected a directory", file.display());
    io::Error::new(io::ErrorKind::NotADirectory, message)
}
