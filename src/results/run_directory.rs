//! Directory to which a run writes its results.

use super::claim::{Claim, Sharing, examine, is_wanted, may_be_moved, names, resolved};
use super::lock::NotLocked;
use super::manifest::{self, Manifest, RunRecord, matches};
use super::open_runs::{self, OpenRun, make_directory, not_a_directory, write_whole};
use super::{Lock, Owner, Refusal, SUMMARY, TEMPORARY, WriteError, restated, unwritten};
use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};

/// Directory that belongs to a run until this value is dropped.
#[derive(Debug)]
pub struct RunDirectory {
    path: PathBuf,
    state: Mutex<RunState>,
    command: String,
    digest: String,
    force: bool,
    set_aside: Option<PathBuf>,
    /// Canonical paths of the files that the run has read. [`RunDirectory::finish`] never removes them, even if a run wrote them.
    inputs: Vec<PathBuf>,
    lock: Mutex<Option<Lock>>,
}

#[derive(Debug)]
struct RunState {
    manifest: Manifest,
    /// Earlier runs whose results this run replaces.
    replaced: Vec<RunRecord>,
    /// Names of the files that this run has written.
    written: BTreeSet<String>,
    /// Names of the files of earlier runs that [`RunDirectory::finish`] has removed.
    removed: Vec<String>,
    /// True if a signal stopped the work before its end.
    interrupted: bool,
}

impl RunDirectory {
    /// Claims a directory for a run before any computation. Creates the directory if it does not exist. Returns a refusal if the
    /// run may not write there.
    pub fn claim(path: &Path, claim: &Claim<'_>) -> Result<Self, Refusal> {
        let failed = |error| Refusal::Unwritable(unwritten(path)(error));
        make_directory(path).map_err(failed)?;
        let owner = Owner::here(&format!("hardpoint {} {}", claim.command, claim.study));
        let lock_path = path.join(format!("{TEMPORARY}lock"));
        let locked = |result: Result<Lock, NotLocked>| {
            result.map_err(|reason| match reason {
                NotLocked::Held(owner) => Refusal::Busy {
                    directory: path.display().to_string(),
                    owner,
                },
                NotLocked::Failed(error) => Refusal::Unwritable(unwritten(&lock_path)(error)),
            })
        };
        let (mut lock, is_alone) = match claim.sharing {
            Sharing::Alone => (locked(Lock::exclusive(&lock_path, &owner))?, true),
            // The first shard prepares the directory; the other shards find it prepared.
            Sharing::Together => match Lock::at_once(&lock_path, &owner) {
                Ok(lock) => (lock, true),
                Err(_) => (locked(Lock::shared(&lock_path, &owner))?, false),
            },
        };
        // A temporary file is created here to check write access before the work starts.
        temporary(path).map_err(failed)?;
        let mut set_aside = None;
        let manifest = match examine(path, claim) {
            Ok(manifest) => manifest,
            Err(Refusal::Taken { .. })
                if claim.set_aside && is_alone && may_be_moved(path, claim) =>
            {
                // The lock file is not a result, so it is removed before the directory is moved aside.
                lock.remove_file();
                set_aside = Some(move_aside(path).map_err(failed)?);
                std::fs::create_dir_all(path).map_err(failed)?;
                drop(lock);
                lock = locked(Lock::exclusive(&lock_path, &owner))?;
                Manifest::default()
            }
            Err(refusal) => return Err(refusal),
        };
        let is_replaced = |run: &&RunRecord| {
            let wanted = |file: &String| is_wanted(claim, file);
            !run.is_of(claim.command, &claim.digest) && run.files.iter().any(wanted)
        };
        let replaced: Vec<RunRecord> = manifest.runs.iter().filter(is_replaced).cloned().collect();
        if !is_alone && !replaced.is_empty() {
            // Shards of the earlier run are still writing to the directory.
            return Err(Refusal::Busy {
                directory: path.display().to_string(),
                owner: None,
            });
        }
        let directory = RunDirectory {
            path: path.to_owned(),
            state: Mutex::new(RunState {
                replaced,
                manifest,
                written: BTreeSet::new(),
                removed: Vec::new(),
                interrupted: false,
            }),
            command: claim.command.to_owned(),
            digest: claim.digest.clone(),
            force: claim.force,
            set_aside,
            inputs: resolved(claim.inputs),
            lock: Mutex::new(Some(lock)),
        };
        directory.begin(claim).map_err(Refusal::Unwritable)?;
        if is_alone {
            directory.clear_leftovers();
        }
        Ok(directory)
    }

    /// Checks that a directory could be claimed, except for its lock. A temporary file is made and removed; nothing else changes.
    pub fn check(path: &Path, claim: &Claim<'_>) -> Result<(), Refusal> {
        // A missing directory would be created in its nearest existing parent.
        let there = path
            .ancestors()
            .find(|above| above.symlink_metadata().is_ok());
        let there = there.filter(|above| !above.as_os_str().is_empty());
        let there = there.unwrap_or(Path::new("."));
        let writable = if there.is_dir() {
            temporary(there).map(drop)
        } else {
            Err(not_a_directory(there))
        };
        writable.map_err(|error| Refusal::Unwritable(unwritten(path)(error)))?;
        examine(path, claim).map(drop)
    }

    /// Claims the directory of a finished run for files made from its results.
    pub fn reopen(path: &Path, files: &[&str], force: bool) -> Result<Self, Refusal> {
        let manifest = Manifest::read(path).unwrap_or_default();
        let main = manifest.author("summary.json");
        let claim = Claim {
            command: main.map_or("report", |run| &run.command),
            study: main.map_or("", |run| &run.study),
            digest: main.map_or_else(String::new, |run| run.digest.clone()),
            files,
            force,
            resume: true,
            reopens: true,
            ..Claim::default()
        };
        RunDirectory::claim(path, &claim)
    }

    /// Allows other runs of the same command and study to write to this directory, too.
    pub fn share(&self) -> Result<(), WriteError> {
        let mut held = self.lock.lock().unwrap_or_else(|e| e.into_inner());
        let Some(lock) = held.take() else {
            return Ok(());
        };
        let owner = Owner::here(&format!("hardpoint {}", self.command));
        let shared = lock.share(&owner).map_err(|reason| {
            let error = match reason {
                NotLocked::Held(_) => io::Error::other("another run has locked it"),
                NotLocked::Failed(error) => error,
            };
            unwritten(&self.path)(error)
        });
        *held = Some(shared?);
        Ok(())
    }

    /// Records that the run has begun.
    fn begin(&self, claim: &Claim<'_>) -> Result<(), WriteError> {
        let mut state = self.state();
        let mut runs = state.manifest.runs.clone();
        match runs.iter_mut().find(|run| self.is_own(run)) {
            Some(_) if claim.resume && claim.former.is_none() => {
                open_runs::begin(self.open_run(claim), || ());
                return Ok(());
            }
            Some(known) => {
                known.finished = false;
                known.interrupted = false;
                known.version = env!("CARGO_PKG_VERSION").to_owned();
            }
            None => runs.push(RunRecord {
                command: claim.command.to_owned(),
                study: claim.study.to_owned(),
                digest: claim.digest.clone(),
                version: env!("CARGO_PKG_VERSION").to_owned(),
                finished: false,
                interrupted: false,
                files: Vec::new(),
            }),
        }
        state.manifest.runs = runs;
        let run = self.open_run(claim);
        let written = open_runs::begin(run, || {
            self.put_undivided(manifest::NAME, &state.manifest.text())
        });
        written?;
        // The summary of an earlier run stays until it is replaced, so it is marked as unfinished.
        let former = std::fs::read_to_string(self.path.join(SUMMARY));
        match former {
            Ok(text) if self.wrote(&state.manifest, SUMMARY) && text.starts_with('{') => {
                self.put(SUMMARY, restated(&text, false, false).as_bytes())
            }
            _ => Ok(()),
        }
    }

    /// Data about the run for the code that records an interruption by a signal.
    fn open_run(&self, claim: &Claim<'_>) -> OpenRun {
        OpenRun {
            path: self.path.clone(),
            command: self.command.clone(),
            digest: self.digest.clone(),
            computes: !claim.reopens,
            has_summary: is_wanted(claim, SUMMARY),
            is_alone: claim.sharing == Sharing::Alone,
        }
    }

    fn state(&self) -> MutexGuard<'_, RunState> {
        // The state is complete even after a panic in a thread, so a poisoned lock is harmless.
        self.state.lock().unwrap_or_else(|e| e.into_inner())
    }

    fn is_own(&self, run: &RunRecord) -> bool {
        run.is_of(&self.command, &self.digest)
    }

    /// True if a file is recorded as written by this run.
    fn wrote(&self, manifest: &Manifest, name: &str) -> bool {
        manifest.author(name).is_some_and(|run| self.is_own(run))
    }

    fn store(&self, state: &RunState) -> Result<(), WriteError> {
        self.put(manifest::NAME, state.manifest.text().as_bytes())
    }

    /// Path of the directory.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Directory to which the claim moved earlier results. `None` if it moved none.
    pub fn set_aside(&self) -> Option<&Path> {
        self.set_aside.as_deref()
    }

    /// Records names of files as written by this run. A star in a name represents digits. Without `--force`, refuses an existing
    /// file that this run did not write.
    pub fn record(&self, names: &[&str]) -> Result<(), WriteError> {
        let mut state = self.state();
        let before = state.manifest.clone();
        for name in names {
            if !self.force && self.path.join(name).symlink_metadata().is_ok() {
                // Another shard of the same sweep may have recorded the file in the meantime.
                if !self.wrote(&state.manifest, name)
                    && let Ok(present) = Manifest::read(&self.path)
                {
                    state.manifest = present;
                }
                if !self.wrote(&state.manifest, name) {
                    let message =
                        "it exists already and is not from this run; --force overwrites it";
                    let error = io::Error::new(io::ErrorKind::AlreadyExists, message);
                    return Err(unwritten(&self.path.join(name))(error));
                }
            }
            state.written.insert((*name).to_owned());
            for run in &mut state.manifest.runs {
                let is_own = run.is_of(&self.command, &self.digest);
                if is_own && !run.wrote(name) {
                    run.files.push((*name).to_owned());
                } else if !is_own {
                    run.files.retain(|file| file != name);
                }
            }
        }
        if state.manifest == before {
            Ok(())
        } else {
            self.store(&state)
        }
    }

    /// Writes a file and records it as written by this run. If the run has been interrupted, a summary states this. Only
    /// [`RunDirectory::finish`] records that the run has finished.
    pub fn write(&self, name: &str, contents: &[u8]) -> Result<(), WriteError> {
        self.record(&[name])?;
        if name != SUMMARY {
            return self.put(name, contents);
        }
        let interrupted = self.state().interrupted;
        let text = String::from_utf8_lossy(contents);
        self.put(name, restated(&text, false, interrupted).as_bytes())
    }

    /// Records that a signal has ended the work. Later summaries and [`RunDirectory::finish`] state this.
    pub fn mark_interrupted(&self) {
        self.state().interrupted = true;
    }

    /// Writes a file completely or not at all.
    fn put(&self, name: &str, contents: &[u8]) -> Result<(), WriteError> {
        let path = self.path.join(name);
        write_whole(&path, contents).map_err(unwritten(&path))
    }

    /// Writes a file within a step that no signal can interrupt.
    fn put_undivided(&self, name: &str, text: &str) -> Result<(), WriteError> {
        let path = self.path.join(name);
        open_runs::put(&path, text.as_bytes()).map_err(unwritten(&path))
    }

    /// Writes `run.json` for a run that ends now, and removes the run from the list of runs in progress.
    fn store_last(&self, state: &RunState) -> Result<(), WriteError> {
        let text = state.manifest.text();
        open_runs::end(&self.path, || self.put_undivided(manifest::NAME, &text))
    }

    /// Records in `summary.json` how the run ended, if this run has written this file.
    fn restate_summary(&self, state: &RunState) -> Result<(), WriteError> {
        if !state.written.contains(SUMMARY) {
            return Ok(());
        }
        let path = self.path.join(SUMMARY);
        let text = std::fs::read_to_string(&path).map_err(unwritten(&path))?;
        let text = restated(&text, !state.interrupted, state.interrupted);
        self.put(SUMMARY, text.as_bytes())
    }

    /// Records an interrupted run that a later run continues. All files of the interrupted run stay.
    pub fn leave_unfinished(&self) -> Result<(), WriteError> {
        let mut state = self.state();
        let interrupted = state.interrupted;
        let own = state.manifest.runs.iter_mut();
        for run in own.filter(|run| self.is_own(run)) {
            run.finished = false;
            run.interrupted = interrupted;
        }
        if interrupted {
            self.restate_summary(&state)?;
        }
        self.store_last(&state)
    }

    /// Removes a file that is recorded for this run, because it would contradict the new results. Other files stay.
    pub fn remove(&self, name: &str) -> Result<(), WriteError> {
        let is_own = {
            let mut state = self.state();
            state.written.remove(name);
            self.wrote(&state.manifest, name)
        };
        let path = self.path.join(name);
        match is_own.then(|| std::fs::remove_file(&path)) {
            Some(Err(error)) if error.kind() != io::ErrorKind::NotFound => {
                Err(unwritten(&path)(error))
            }
            _ => Ok(()),
        }
    }

    /// Removes the files that match these patterns: files of this run, or with `--force` all of them. A star represents digits.
    pub fn remove_all(&self, patterns: &[&str]) -> Result<(), WriteError> {
        let state = self.state();
        for name in names(&self.path) {
            let is_own = self.force || self.wrote(&state.manifest, &name);
            if is_own && patterns.iter().any(|p| matches(p, &name)) {
                let path = self.path.join(&name);
                std::fs::remove_file(&path).map_err(unwritten(&path))?;
            }
        }
        Ok(())
    }

    /// Ends the run. Removes the files of replaced runs, and of earlier runs of this study, that this run did not write again.
    /// Records the run as finished, or as interrupted after [`RunDirectory::mark_interrupted`].
    pub fn finish(&self) -> Result<(), WriteError> {
        let mut state = self.state();
        self.restate_summary(&state)?;
        let RunState {
            manifest,
            replaced,
            written,
            removed,
            interrupted,
        } = &mut *state;
        let mut stale: Vec<String> = Vec::new();
        for run in &mut manifest.runs {
            if run.is_of(&self.command, &self.digest) {
                run.finished = !*interrupted;
                run.interrupted = *interrupted;
                let all = std::mem::take(&mut run.files).into_iter();
                let (mut kept, gone): (Vec<_>, Vec<_>) =
                    all.partition(|name| written.contains(name));
                kept.sort();
                run.files = kept;
                stale.extend(gone);
            } else if replaced.iter().any(|r| run.is_of(&r.command, &r.digest)) {
                stale.append(&mut run.files);
            }
        }
        manifest.runs.retain(|run| !run.files.is_empty());
        for name in names(&self.path) {
            let is_stale = stale.iter().any(|pattern| matches(pattern, &name));
            let path = self.path.join(&name);
            let is_input = |path: &Path| {
                let real = path.canonicalize();
                real.is_ok_and(|real| self.inputs.contains(&real))
            };
            if is_stale && manifest.author(&name).is_none() && !is_input(&path) {
                std::fs::remove_file(&path).map_err(unwritten(&path))?;
                removed.push(name);
            }
        }
        self.store_last(&state)
    }

    /// Sorted names of the files of earlier runs that [`RunDirectory::finish`] has removed, because they would contradict the new
    /// results.
    pub fn removed(&self) -> Vec<String> {
        self.state().removed.clone()
    }

    /// Removes the temporary files of runs that died.
    fn clear_leftovers(&self) {
        let Ok(entries) = std::fs::read_dir(&self.path) else {
            return;
        };
        for entry in entries.flatten() {
            let name = entry.file_name();
            let is_ours = name.to_string_lossy().starts_with(TEMPORARY);
            let is_lock = name == format!("{TEMPORARY}lock").as_str();
            let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
            if is_ours && !is_lock && is_file {
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }
}

impl Drop for RunDirectory {
    fn drop(&mut self) {
        open_runs::end(&self.path, || ());
    }
}

/// Renames a directory to the first free name of `name.1`, `name.2` and so on.
fn move_aside(path: &Path) -> io::Result<PathBuf> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let free = (1_u64..)
        .map(|number| path.with_file_name(format!("{name}.{number}")))
        .find(|place| place.symlink_metadata().is_err());
    let place = free.ok_or_else(|| io::Error::other("all names for the old results are in use"))?;
    std::fs::rename(path, &place)?;
    Ok(place)
}

/// Makes a temporary file in `directory`, which must be the directory of the final file.
pub fn temporary(directory: &Path) -> io::Result<tempfile::NamedTempFile> {
    temporary_of(directory, "file")
}

/// Makes a temporary file whose name contains `stem`. The name shows to which part or program the file belongs, so that
/// leftovers of dead runs can be found.
pub fn temporary_of(directory: &Path, stem: &str) -> io::Result<tempfile::NamedTempFile> {
    tempfile::Builder::new()
        .prefix(&format!("{TEMPORARY}{stem}-"))
        .permissions(readable())
        .tempfile_in(directory)
}

/// Permissions of result files: all users can read, the owner can write. By default, only the owner could read a temporary file.
#[cfg(unix)]
fn readable() -> std::fs::Permissions {
    std::os::unix::fs::PermissionsExt::from_mode(0o644)
}

#[cfg(not(unix))]
fn readable() -> std::fs::Permissions {
    // On systems other than Unix, a new file gets its permissions from the directory. The value returned here has no effect,
    // but `Permissions` has no other constructor.
    std::fs::metadata(".")
        .map(|m| m.permissions())
        .expect("the current directory exists")
}
