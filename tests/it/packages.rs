//! Tests that each crate of the workspace can be packaged: it needs no file outside its folder. If two crates need a
//! file, one crate has the original and the other a copy. After a change, `UPDATE_README=1 cargo test --test it
//! packages::` renews the copies.

use hardpoint::model::Topology;
use std::fs;
use std::path::{Path, PathBuf};

/// Folders of the crates, relative to the workspace.
const CRATES: [&str; 5] = ["", "attia", "bench", "engine", "study-file"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Asserts that the copy has this text. If the environment has `UPDATE_README`, writes the text to the copy instead.
fn assert_copied(copy: &Path, text: &str, source: &str) {
    if std::env::var_os("UPDATE_README").is_some() {
        fs::write(copy, text).unwrap();
        return;
    }
    let copied = fs::read_to_string(copy).unwrap();
    let first = (1..)
        .zip(copied.lines().zip(text.lines()))
        .find(|(_, (a, b))| a != b);
    assert!(
        copied == text,
        "{} differs from {source}, first in {first:?}; edit {source}, then run UPDATE_README=1 cargo test --test it packages::",
        copy.display()
    );
}

/// The sample studies `TOPOLOGY_solve.toml` are the templates of `hardpoint new`.
#[test]
fn sample_studies_are_the_templates() {
    for topology in Topology::ALL {
        let source = format!("engine/templates/{}.toml", topology.name);
        let copy = root().join(format!("studies/{}_solve.toml", topology.name));
        assert_copied(&copy, topology.template, &source);
    }
}

/// Each package contains the licences of the program. Packages with fonts for pictures also contain the licence of the
/// font.
#[test]
fn packages_carry_the_licences() {
    let licences = ["LICENSE-APACHE", "LICENSE-MIT", "LICENSE-DEJAVU"];
    for folder in CRATES.into_iter().chain(["python/licences"]).skip(1) {
        for name in licences {
            let copy = root().join(folder).join(name);
            if name == "LICENSE-DEJAVU" && folder != "python/licences" {
                assert!(!copy.exists());
                continue;
            }
            let text = fs::read_to_string(root().join(name)).unwrap();
            assert_copied(&copy, &text, name);
        }
    }
}

/// The manual contains the tables of keys that the schema reads.
#[test]
fn the_manual_contains_the_tables_of_keys() {
    for (source, page) in [
        ("study-file/keys.md", "docs/study.md"),
        ("study-file/car_keys.md", "docs/car.md"),
    ] {
        let keys = fs::read_to_string(root().join(source)).unwrap();
        let (_, tables) = keys.split_once("\n\n").unwrap();
        let copy = root().join(page);
        let manual = fs::read_to_string(&copy).unwrap();
        let marker = format!("<!-- {source} -->\n\n");
        let (introduction, _) = manual.split_once(&marker).unwrap();
        let renewed = format!("{introduction}{marker}{tables}");
        assert_copied(&copy, &renewed, source);
    }
}

/// Collects Rust files below a folder.
fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, into);
        } else if path.extension().is_some_and(|kind| kind == "rs") {
            into.push(path);
        }
    }
}

/// Every file that a crate includes at compile time is in the crate's folder.
#[test]
fn crates_include_no_file_of_others() {
    let mut included = 0;
    for name in CRATES {
        let folder = root().join(name).canonicalize().unwrap();
        let mut files = Vec::new();
        sources(&folder.join("src"), &mut files);
        for file in files {
            let text = fs::read_to_string(&file).unwrap();
            for opening in ["include_str!(\"", "include_bytes!(\"", "include!(\""] {
                for rest in text.split(opening).skip(1) {
                    let (path, _) = rest.split_once('"').unwrap();
                    let path = file.parent().unwrap().join(path);
                    let path = path.canonicalize();
                    let path = path.unwrap_or_else(|e| panic!("{}: {e}", file.display()));
                    assert!(
                        path.starts_with(&folder),
                        "{} includes {}",
                        file.display(),
                        path.display()
                    );
                    included += 1;
                }
            }
        }
    }
    assert!(included > 10, "{included}");
}

/// Crates that depend on each other state the required version.
#[test]
fn dependencies_within_the_workspace_have_this_version() {
    let version = format!("version = \"{}\"", env!("CARGO_PKG_VERSION"));
    let mut dependencies = 0;
    for name in CRATES.into_iter().chain(["python"]) {
        let manifest = root().join(name).join("Cargo.toml");
        let text = fs::read_to_string(&manifest).unwrap();
        for line in text.lines().filter(|line| line.contains("path = \"")) {
            assert!(line.contains(&version), "{}: {line}", manifest.display());
            dependencies += 1;
        }
    }
    assert!(dependencies >= 5, "{dependencies}");
}
