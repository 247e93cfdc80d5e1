//! Commands that write one file.

use super::exit::Stop;
use super::terminal::note;
use crate::results;
use std::path::{Path, PathBuf};

/// Path of `--out`. `None` for standard output, which is also the meaning of `-`, as in commands with directories.
pub(super) fn file_of_out(out: &Option<PathBuf>) -> Option<&Path> {
    out.as_deref().filter(|out| *out != Path::new("-"))
}

/// Writes a file completely or not at all. It replaces an existing file only with `--force`, and it never replaces an input. A
/// named pipe or a character device receives the contents.
pub(super) fn save(out: &Path, bytes: &[u8], force: bool, inputs: &[PathBuf]) -> Result<(), Stop> {
    check(out, force, inputs)?;
    results::write_whole(out, bytes)
        .map_err(|error| Stop::wrong_input(format!("cannot write {}: {error}", out.display())))
}

/// Prints the path of a file that a command has written.
pub(super) fn note_saved(out: &Path) {
    note(&format!("Written: {}\n", out.display()));
}

/// Writes the files of a directory. Writes none of them if one is an input, or exists already and `force` is false. Makes the
/// directory.
pub(super) fn save_all(
    directory: &Path,
    files: &[(&str, &str)],
    force: bool,
    inputs: &[PathBuf],
) -> Result<(), Stop> {
    if directory == Path::new("-") {
        return Err(Stop::wrong_input(
            "a car has three studies: give a directory for them with --out",
        ));
    }
    for (name, _) in files {
        check(&directory.join(name), force, inputs)?;
    }
    results::make_directory(directory).map_err(|error| {
        Stop::wrong_input(format!("cannot create {}: {error}", directory.display()))
    })?;
    let written = results::undivided(|| -> std::io::Result<()> {
        for (name, text) in files {
            results::put(&directory.join(name), text.as_bytes())?;
        }
        Ok(())
    });
    written.map_err(|error| {
        Stop::wrong_input(format!(
            "cannot write into {}: {error}",
            directory.display()
        ))
    })
}

/// Refuses a file that is an input, a directory, or an existing file that may not be replaced.
fn check(out: &Path, force: bool, inputs: &[PathBuf]) -> Result<(), Stop> {
    if let Some(input) = inputs.iter().find(|input| are_one_file(input, out)) {
        return Err(Stop::wrong_input(format!(
            "{} is {}, an input of this command: no command replaces its input, not even with --force; give another file with --out",
            out.display(),
            input.display()
        )));
    }
    if out.is_dir() {
        return Err(Stop::wrong_input(format!(
            "{} is a directory; expected the name of a file",
            out.display()
        )));
    }
    if out.is_file() && !force {
        return Err(Stop::wrong_input(format!(
            "{} already exists; --force replaces it",
            out.display()
        )));
    }
    Ok(())
}

/// True if two paths lead to the same file: their canonical paths are equal, or they are links to the same data.
fn are_one_file(one: &Path, other: &Path) -> bool {
    let [a, b] = [one, other].map(|path| path.canonicalize().ok());
    (a.is_some() && a == b) || are_one_inode(one, other)
}

#[cfg(unix)]
fn are_one_inode(one: &Path, other: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let [a, b] = [one, other].map(|path| std::fs::metadata(path).ok());
    match (a, b) {
        (Some(a), Some(b)) => (a.dev(), a.ino()) == (b.dev(), b.ino()),
        _ => false,
    }
}

#[cfg(not(unix))]
fn are_one_inode(_: &Path, _: &Path) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A named pipe receives the text and stays. A symbolic link stays, and its target is replaced. If the target did not
    /// exist, it is created.
    #[cfg(unix)]
    #[test]
    fn pipes_and_links_stay() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        let pipe = at("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        let reader = {
            let pipe = pipe.clone();
            std::thread::spawn(move || std::fs::read_to_string(pipe).unwrap())
        };
        save(&pipe, b"through", true, &[]).unwrap();
        assert_eq!(reader.join().unwrap(), "through");
        assert!(!pipe.metadata().unwrap().is_file());
        let link = at("link");
        std::os::unix::fs::symlink("target", &link).unwrap();
        for text in ["new", "again"] {
            save(&link, text.as_bytes(), true, &[]).unwrap();
            assert!(link.symlink_metadata().unwrap().is_symlink());
            assert_eq!(std::fs::read_to_string(at("target")).unwrap(), text);
        }
    }

    /// The error names a directory where a file is expected, and a file where a directory is expected.
    #[test]
    fn files_and_directories_are_told_apart() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("file");
        std::fs::write(&file, "mine").unwrap();
        for force in [false, true] {
            let said = |stop: Result<(), Stop>| format!("{:?}", stop.unwrap_err());
            let as_file = said(save(directory.path(), b"new", force, &[]));
            assert!(
                as_file.contains("is a directory; expected the name of a file"),
                "{as_file}"
            );
            let as_directory = [
                said(save_all(&file, &[("a", "new")], force, &[])),
                said(save(&file.join("below"), b"new", force, &[])),
            ];
            for said in as_directory {
                assert!(said.contains("is a file; expected a directory"), "{said}");
            }
        }
    }

    /// An input is recognised by its own name, by another path, through a symbolic link and as a hard link.
    #[test]
    fn a_file_that_was_read_is_never_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        std::fs::create_dir(at("below")).unwrap();
        std::fs::write(at("study.toml"), "as it was").unwrap();
        let mut others = vec![at("study.toml"), at("below").join("..").join("study.toml")];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("study.toml"), at("link.toml")).unwrap();
            std::fs::hard_link(at("study.toml"), at("same.toml")).unwrap();
            others.extend([at("link.toml"), at("same.toml")]);
        }
        let inputs = [at("other.toml"), at("study.toml")];
        for out in &others {
            assert!(save(out, b"new", true, &inputs).is_err(), "{out:?}");
            assert_eq!(std::fs::read_to_string(out).unwrap(), "as it was");
        }
        std::fs::write(at("copy.toml"), "as it was").unwrap();
        assert!(save(&at("copy.toml"), b"new", false, &inputs).is_err());
        assert!(save(&at("copy.toml"), b"new", true, &inputs).is_ok());
        assert_eq!(std::fs::read_to_string(at("copy.toml")).unwrap(), "new");
    }
}
