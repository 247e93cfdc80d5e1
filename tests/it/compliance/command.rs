//! `hardpoint kc` and `hardpoint check` as a user runs them.

use std::path::Path;
use std::process::{Command, Output};

fn hardpoint(arguments: &[&str], directory: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hardpoint"))
        .args(arguments)
        .current_dir(directory)
        .output()
        .unwrap()
}

fn study(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("studies")
        .join(name);
    path.display().to_string()
}

fn rows(path: &Path) -> Vec<csv::StringRecord> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    reader.records().map(Result::unwrap).collect()
}

#[test]
fn kc_writes_figures_levels_and_the_matrix() {
    let directory = tempfile::tempdir().unwrap();
    let path = study("double_wishbone_compliance.toml");
    let ran = hardpoint(&["kc", &path, "--out", "kc"], directory.path());
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert_eq!(
        ran.status.code(),
        Some(0),
        "{said}{}",
        String::from_utf8_lossy(&ran.stderr)
    );
    assert!(said.contains("toe_by_lateral_force") && said.contains("design load: 4682 N"));
    let figures = rows(&directory.path().join("kc/kc.csv"));
    // The reference corner at its design height: tests/data/reference/elasto.
    let value = |load: &str, trail: &str, quantity: &str| -> f64 {
        let row = figures
            .iter()
            .find(|row| &row[2] == load && &row[4] == trail && &row[9] == quantity);
        row.unwrap_or_else(|| panic!("{quantity}"))[10]
            .parse()
            .unwrap()
    };
    let per_kilonewton = 1000.0_f64.to_degrees();
    for (found, expected) in [
        (
            value("lateral", "0.0", "toe_by_lateral_force"),
            8.01723593199302e-7 * per_kilonewton,
        ),
        (
            value("lateral", "0.0", "camber_by_lateral_force"),
            4.56633741523367e-7 * per_kilonewton,
        ),
        (
            value("lateral", "0.0", "contact_by_lateral_force"),
            2.17364662478179e-4 * 1000.0,
        ),
        (
            value("lateral", "30.0", "toe_by_lateral_force"),
            6.88275823562774e-7 * per_kilonewton,
        ),
        (
            value("aligning", "", "toe_by_aligning_moment"),
            -3.78159988439469e-9 * 1e5_f64.to_degrees(),
        ),
        (
            value("braking", "", "toe_by_braking"),
            6.57802096512894e-7 * per_kilonewton,
        ),
        (
            value("braking", "", "recession_by_braking"),
            5.90204424586487e-4 * 1000.0,
        ),
        (
            value("lateral", "0.0", "jacking_by_lateral_force"),
            0.110384332605338,
        ),
        (
            value("vertical", "", "compliant_wheel_rate"),
            44.5411779348996,
        ),
    ] {
        assert!(
            (found - expected).abs() < 1e-10 * expected.abs(),
            "{found} {expected}"
        );
    }
    let levels = rows(&directory.path().join("kc/levels.csv"));
    assert_eq!(levels.len(), 6 * 11);
    assert!(levels.iter().all(|row| &row[row.len() - 1] == "ok"));
    assert_eq!(
        rows(&directory.path().join("kc/compliance_matrix.csv")).len(),
        6
    );
}

#[test]
fn a_rigid_study_has_its_kinematics_and_jacking() {
    let directory = tempfile::tempdir().unwrap();
    let path = study("macpherson_solve.toml");
    let ran = hardpoint(&["kc", &path, "--out", "-"], directory.path());
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert_eq!(
        ran.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&ran.stderr)
    );
    assert!(said.contains("toe_by_heave") && said.contains("jacking_by_lateral_force"));
    assert!(!said.contains("toe_by_lateral_force"));
}

#[test]
fn other_commands_refuse_elastic_parts() {
    let directory = tempfile::tempdir().unwrap();
    let path = study("double_wishbone_compliance.toml");
    for command in ["solve", "limits", "setup"] {
        let ran = hardpoint(&[command, &path], directory.path());
        assert_eq!(ran.status.code(), Some(2), "{command}");
        let said = String::from_utf8_lossy(&ran.stderr).into_owned();
        assert!(said.contains("here they would be left out"), "{said}");
    }
    let ran = hardpoint(&["check", &path], directory.path());
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert_eq!(ran.status.code(), Some(0), "{said}");
    assert!(said.contains("Elastic parts") && said.contains("lower_arm_rear"));
}

/// A load that the wheel does not hold: the rest is written, the share is named, the exit code is 1.
#[test]
fn a_load_that_is_not_held_is_said() {
    let directory = tempfile::tempdir().unwrap();
    let path = study("double_wishbone_compliance.toml");
    let tests =
        "compliance.tests=[{ load = \"lateral\", hold = \"wheel_load\", window = 90000.0 }]";
    let ran = hardpoint(
        &["kc", &path, "--out", "kc", "--set", tests],
        directory.path(),
    );
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert_eq!(
        ran.status.code(),
        Some(1),
        "{said}{}",
        String::from_utf8_lossy(&ran.stderr)
    );
    assert!(
        said.contains("not solved") && said.contains("holds 0."),
        "{said}"
    );
    let levels = rows(&directory.path().join("kc/levels.csv"));
    assert!(
        levels
            .iter()
            .any(|row| &row[row.len() - 1] == "no_equilibrium")
    );
}
