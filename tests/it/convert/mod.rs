//! Tests of `hardpoint convert`: after conversion to other units and axes, a study describes the same vehicle.

mod mirror;
mod physical;
mod repointed;
mod texts;
mod trails;

use hardpoint::study::CarStudy;
use std::fs;
use std::path::{Path, PathBuf};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// Options of the first of two conversions. Together, the two conversions change every unit and the direction of every axis.
const INCHES: [&str; 4] = ["--unit", "in", "--frame", "sae_j670"];
/// Options of the second conversion.
const METRES: [&str; 4] = ["--unit", "m", "--frame", "x_rear"];

fn studies() -> Vec<PathBuf> {
    let entries = fs::read_dir(Path::new(ROOT).join("studies")).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|own| own == "toml"));
    files.sort();
    files
}

fn is_elastic(file: &Path) -> bool {
    fs::read_to_string(file).unwrap().contains("\n[compliance]")
}

fn run(arguments: &[&str]) -> (u8, String) {
    hardpoint::cli::run_captured([&["hardpoint", "--quiet"], arguments].concat())
}

fn done(arguments: &[&str]) {
    let (code, said) = run(arguments);
    assert_eq!(code, 0, "{arguments:?}\n{said}");
}

/// Converts a study and returns the file of the converted study.
fn converted(file: &Path, options: &[&str], directory: &Path) -> PathBuf {
    let name = file.file_name().unwrap();
    let out = if CarStudy::is_at(file) {
        directory.to_owned()
    } else {
        fs::create_dir_all(directory).unwrap();
        directory.join(name)
    };
    let (study, out) = (file.to_str().unwrap(), out.to_str().unwrap());
    // A conversion of a car also writes its axles, which are separate studies.
    let base = ["convert", study, "--out", out, "--force"];
    done(&[&base[..], options].concat());
    directory.join(name)
}

/// Runs a command on a study, and returns the directory of the results.
fn results(command: &str, file: &Path, more: &[&str], directory: &Path) -> PathBuf {
    let stem = file.file_stem().unwrap().to_str().unwrap();
    let out = directory.join(format!("{command}_{stem}"));
    let base = [
        command,
        file.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ];
    done(&[&base[..], more].concat());
    out
}
