//! Claim of a run: its request to write to a directory. The claim decides which existing files the run may replace.

use super::manifest::{self, Manifest, RunRecord, matches};
use super::{Refusal, TEMPORARY};
use std::path::{Path, PathBuf};

/// Permission for other runs to write to the claimed directory at the same time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sharing {
    /// Only this run may write.
    #[default]
    Alone,
    /// Runs of the same command with the same study may write, such as the shards of a sweep.
    Together,
}

/// Request of a run to write to a directory.
#[derive(Clone, Debug, Default)]
pub struct Claim<'a> {
    /// Name of the command, as in `solve`.
    pub command: &'a str,
    /// Name of the study.
    pub study: &'a str,
    /// Digest that identifies the run ([`RunRecord::digest`]).
    pub digest: String,
    /// Digest of an earlier run of the same command whose results this run continues: the same sweep with fewer samples.
    pub former: Option<String>,
    /// Names of the files that this run may write, as far as they are known in advance. A star represents digits.
    pub files: &'a [&'a str],
    /// Files that this run has read.
    pub inputs: &'a [PathBuf],
    /// True if this run may replace existing results of any command.
    pub force: bool,
    /// True if this run continues an unfinished run of the same command and study.
    pub resume: bool,
    /// True if this run may move the results of other runs aside. This is allowed in a default directory, which the user has not
    /// chosen.
    pub set_aside: bool,
    /// Permission for other runs to write at the same time.
    pub sharing: Sharing,
    /// True if this run makes files from the results of a finished run, and does not change the state of that run.
    pub reopens: bool,
}

/// Returns the record of the runs in a directory. Returns an error if the claim may not replace a file there.
pub(super) fn examine(path: &Path, claim: &Claim<'_>) -> Result<Manifest, Refusal> {
    let shown = |name: &str| path.join(name).display().to_string();
    let entries = names(path);
    let inputs: Vec<PathBuf> = resolved(claim.inputs);
    for name in entries.iter().filter(|name| is_wanted(claim, name)) {
        let there = path.join(name).canonicalize().ok();
        if there.is_some_and(|there| inputs.contains(&there)) {
            return Err(Refusal::Input { file: shown(name) });
        }
    }
    let manifest = match Manifest::read(path) {
        Ok(mut manifest) => {
            let taken_over = |run: &&mut RunRecord| {
                let former = claim.former.as_deref();
                run.command == claim.command && Some(run.digest.as_str()) == former
            };
            for run in manifest.runs.iter_mut().filter(taken_over) {
                run.digest.clone_from(&claim.digest);
            }
            manifest
        }
        Err(_) if claim.force => Manifest::default(),
        Err(reason) => {
            return Err(Refusal::Unreadable {
                file: shown(manifest::NAME),
                reason,
            });
        }
    };
    if claim.force {
        return Ok(manifest);
    }
    let mut taken = None;
    for name in entries.iter().filter(|name| is_wanted(claim, name)) {
        match manifest.author(name) {
            None => return Err(Refusal::Foreign { file: shown(name) }),
            Some(run) if run.is_of(claim.command, &claim.digest) => {
                let is_begun = run.command == "sweep" && !run.finished;
                if is_begun && !claim.resume {
                    return Err(Refusal::Unfinished {
                        directory: path.display().to_string(),
                    });
                }
            }
            Some(run) => {
                taken.get_or_insert_with(|| Refusal::Taken {
                    directory: path.display().to_string(),
                    command: run.command.clone(),
                    study: run.study.clone(),
                    same_study: run
                        .digests_as(claim.command)
                        .then(|| run.digest == claim.digest),
                    is_finished: run.finished,
                    file: name.clone(),
                });
            }
        }
    }
    taken.map_or(Ok(manifest), Err)
}

/// True if a directory may be moved aside: it contains only files of runs, no unfinished sweep, and no input of this run.
pub(super) fn may_be_moved(path: &Path, claim: &Claim<'_>) -> bool {
    let Ok(manifest) = Manifest::read(path) else {
        return false;
    };
    let inputs = resolved(claim.inputs);
    let is_ours = |name: &String| {
        let there = path.join(name).canonicalize().ok();
        let is_input = there.is_some_and(|there| inputs.contains(&there));
        let own = name == manifest::NAME || name.starts_with(TEMPORARY);
        !is_input && (own || manifest.author(name).is_some())
    };
    let unfinished = |run: &RunRecord| run.command == "sweep" && !run.finished;
    !manifest.runs.iter().any(unfinished) && names(path).iter().all(is_ours)
}

/// True if a claim names this file, directly or by a pattern with a star.
pub(super) fn is_wanted(claim: &Claim<'_>, name: &str) -> bool {
    let mut files = claim.files.iter();
    files.any(|file| *file == name || matches(file, name))
}

/// Canonical paths. Paths that do not exist are left out.
pub(super) fn resolved(paths: &[PathBuf]) -> Vec<PathBuf> {
    let paths = paths.iter();
    paths.filter_map(|path| path.canonicalize().ok()).collect()
}

/// Sorted names of all entries of a directory. Empty if the directory cannot be read.
pub(super) fn names(path: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}
