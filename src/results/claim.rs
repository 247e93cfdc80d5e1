//! The claim of a run on a directory: permissions to replace files.

use super::manifest::{self, Manifest, RunRecord, matches};
use super::{Refusal, TEMPORARY};
use std::path::{Path, PathBuf};

/// Permission for other runs to write in the directory at the same time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sharing {
    /// This run alone.
    #[default]
    Alone,
    /// Runs of the same command with the same study, as the shards of a sweep.
    Together,
}

/// The claim of a run on a directory.
#[derive(Clone, Debug, Default)]
pub struct Claim<'a> {
    /// The command, as in `solve`.
    pub command: &'a str,
    /// The name of the study.
    pub study: &'a str,
    /// SHA-256 of all that the study says.
    pub digest: String,
    /// The digest of a run of the same command whose results this one takes over: of the same sweep with fewer
    /// samples.
    pub former: Option<String>,
    /// The files it will write, as far as they are known. A star stands for digits.
    pub files: &'a [&'a str],
    /// The files it has read.
    pub inputs: &'a [PathBuf],
    /// True if existing results may be replaced, whichever command wrote them.
    pub force: bool,
    /// True if an unfinished run of the same command and study is continued.
    pub resume: bool,
    /// True if the results of other runs may be moved aside, because the user has not chosen this directory.
    pub set_aside: bool,
    /// Permission for others to write there at the same time.
    pub sharing: Sharing,
    /// True if the files derive from the results of a finished run, whose state stays as it is.
    pub reopens: bool,
}

/// The record of the runs in a directory, if this run may write there.
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

/// Returns true if a directory holds only files of finished runs, and no input of the present run.
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

/// Returns true if a run will write a file of this name, or files of these names.
pub(super) fn is_wanted(claim: &Claim<'_>, name: &str) -> bool {
    let mut files = claim.files.iter();
    files.any(|file| *file == name || matches(file, name))
}

pub(super) fn resolved(paths: &[PathBuf]) -> Vec<PathBuf> {
    let paths = paths.iter();
    paths.filter_map(|path| path.canonicalize().ok()).collect()
}

/// Sorted names of the files in a directory.
pub(super) fn names(path: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}
