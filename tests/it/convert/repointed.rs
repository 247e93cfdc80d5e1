//! Tests of the path of a file of designs in studies that a command writes into another directory.

use super::{ROOT, converted, done, run};
use std::fs;
use std::path::{Path, PathBuf};

const DESIGNS: &str = "tie_rod_inner_dz\n-1.0\n0.0\n1.0\n";

/// Writes a sample study with a file of designs into a directory `mine`.
fn with_designs(directory: &Path, sample: &str) -> PathBuf {
    let mine = directory.join("mine");
    fs::create_dir_all(&mine).unwrap();
    fs::write(mine.join("designs.csv"), DESIGNS).unwrap();
    let text = fs::read_to_string(Path::new(ROOT).join("studies").join(sample)).unwrap();
    let file = mine.join(sample);
    fs::write(&file, text + "\n[sweep]\ndesigns = \"designs.csv\"\n").unwrap();
    file
}

/// Number of designs that a sweep of the study solves.
fn designs_of(study: &Path, out: &Path) -> usize {
    let out = out.to_str().unwrap();
    done(&["sweep", study.to_str().unwrap(), "--out", out, "--force"]);
    let table = fs::read_to_string(Path::new(out).join("designs.csv")).unwrap();
    table.lines().count() - 1
}

/// A conversion of masses changes no point, so the designs stay valid. The new study names the same file.
#[test]
fn a_converted_study_finds_its_designs() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    let study = with_designs(directory.path(), "macpherson_solve.toml");
    let new = converted(&study, &["--mass-unit", "lb"], &at("new").join("below"));
    let text = fs::read_to_string(&new).unwrap();
    assert!(text.contains("../../mine/designs.csv"), "{text}");
    assert_eq!(designs_of(&new, &at("out")), 3);
    // In other units, axes or on the other side, the coordinates of the designs would be wrong.
    for options in [["--unit", "in"], ["--frame", "x_rear"], ["--side", "right"]] {
        let (code, said) = run(&[&["convert", study.to_str().unwrap()], &options[..]].concat());
        assert_eq!(code, 2, "{said}");
        assert!(said.contains("sweep.designs"), "{said}");
    }
}

/// The studies that a tuning writes name the same designs: the copy of the study and the tuned study.
#[test]
fn a_tuned_study_finds_its_designs() {
    let directory = tempfile::tempdir().unwrap();
    let study = with_designs(directory.path(), "macpherson_bump_steer.toml");
    let out = directory.path().join("runs").join("tuned");
    done(&[
        "optimise",
        study.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
        "--set",
        "optimise.max_iterations=1",
        "--set",
        "optimise.side_effects=false",
    ]);
    for name in ["study.toml", "optimised.toml"] {
        let found = designs_of(&out.join(name), &directory.path().join(name));
        assert_eq!(found, 3, "{name}");
    }
}

/// A car's run and a converted car keep the designs of an axle's sweep.
#[test]
fn the_axles_of_a_car_find_their_designs() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    let front = with_designs(directory.path(), "car_front.toml");
    let mine = front.parent().unwrap();
    for name in ["car.toml", "car_rear.toml"] {
        fs::copy(Path::new(ROOT).join("studies").join(name), mine.join(name)).unwrap();
    }
    let car = mine.join("car.toml");
    let new = converted(&car, &["--mass-unit", "lb"], &at("new"));
    assert_eq!(
        designs_of(&new.with_file_name("car_front.toml"), &at("a")),
        3
    );
    let out = at("run");
    done(&[
        "solve",
        car.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(designs_of(&out.join("front.toml"), &at("b")), 3);
}
