//! Tests of `hardpoint kc` and `hardpoint check` of an axle as a user runs them.

use super::super::command::{self, hardpoint};
use crate::support::rows_by_column;
use std::collections::BTreeMap;
use std::path::Path;

const STUDY: &str = "subframe_axle_compliance.toml";

fn study() -> String {
    command::study(STUDY)
}

/// Reads the rows of a table, each with its values by column name.
fn rows(path: &Path) -> Vec<BTreeMap<String, String>> {
    rows_by_column(&std::fs::read(path).unwrap())
}

/// The printed table names the travels of an axle as `kc.csv` does.
#[test]
fn printed_and_written_travels_have_the_same_names() {
    let directory = tempfile::tempdir().unwrap();
    let call = ["kc", &study(), "--out", "kc", "--format", "json"];
    let ran = hardpoint(&call, directory.path());
    let errors = String::from_utf8_lossy(&ran.stderr);
    assert_eq!(ran.status.code(), Some(0), "{errors}");
    let printed: serde_json::Value = serde_json::from_slice(&ran.stdout).unwrap();
    let written = rows(&directory.path().join("kc/kc.csv"));
    for name in ["travel_left_mm", "travel_right_mm", "rack_mm"] {
        assert!(printed["figures"][0][name].is_number(), "{name}");
        assert!(written[0].contains_key(name), "{name}");
    }
}

#[test]
fn kc_tests_both_wheels_of_an_axle() {
    let directory = tempfile::tempdir().unwrap();
    let ran = hardpoint(&["kc", &study(), "--out", "kc"], directory.path());
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    let errors = String::from_utf8_lossy(&ran.stderr);
    assert_eq!(ran.status.code(), Some(0), "{said}{errors}");
    let figures = rows(&directory.path().join("kc/kc.csv"));
    let values = |load: &str, mode: &str, wheel: &str, quantity: &str| -> Vec<f64> {
        let is = |row: &&BTreeMap<String, String>| {
            row["load"] == load
                && row["mode"] == mode
                && row["wheel"] == wheel
                && row["quantity"] == quantity
        };
        let found: Vec<f64> = figures
            .iter()
            .filter(is)
            .map(|row| row["value"].parse().unwrap())
            .collect();
        assert!(!found.is_empty(), "{load} {mode} {wheel} {quantity}");
        found
    };
    let value = |load: &str, mode: &str, wheel: &str, quantity: &str| {
        values(load, mode, wheel, quantity)[0]
    };
    // On a symmetric axle both wheels have equal values, and the values of the axle follow from those of one wheel.
    for (load, mode, quantity) in [
        ("heave", "", "toe_by_heave"),
        ("roll", "", "camber_by_roll"),
        ("roll", "", "steer_by_roll"),
        ("steering", "", "steer_by_rack"),
        ("steering", "", "caster_by_rack"),
        ("lateral", "parallel", "toe_by_lateral_force"),
        ("lateral", "opposed", "toe_by_lateral_force"),
        ("lateral", "single", "contact_by_lateral_force"),
        ("braking", "parallel", "recession_by_braking"),
        ("vertical", "opposed", "compliant_wheel_rate"),
    ] {
        let [left, right] = ["left", "right"].map(|wheel| value(load, mode, wheel, quantity));
        // In roll and in steering, the wheels move in opposite directions. So camber by roll and caster by rack have
        // opposite signs at the two wheels. Steer is positive to the left at both wheels, so its values are equal.
        let is_opposite = ["camber_by_roll", "caster_by_rack"].contains(&quantity);
        let sign = if is_opposite { -1.0 } else { 1.0 };
        assert!(
            (left - sign * right).abs() < 1e-9 * left.abs(),
            "{quantity}: {left} {right}"
        );
    }
    let toe = value("lateral", "parallel", "left", "toe_by_lateral_force");
    let steer = value("lateral", "parallel", "axle", "axle_steer_by_lateral_force");
    assert!((steer - toe).abs() < 1e-9 * toe.abs(), "{steer} {toe}");
    let understeer = value("lateral", "parallel", "axle", "understeer_by_lateral_force");
    assert!((understeer + steer).abs() < 1e-12);
    // The anti-roll bar adds stiffness in roll and none in heave.
    let stiffness = values("roll", "", "axle", "compliant_roll_stiffness");
    assert_eq!(stiffness.len(), 2);
    assert!(stiffness[0] > 1.05 * stiffness[1], "{stiffness:?}");
    let rates =
        ["parallel", "opposed"].map(|mode| value("vertical", mode, "left", "compliant_wheel_rate"));
    assert!(rates[1] > 1.05 * rates[0], "{rates:?}");
    let states: Vec<&str> = figures
        .iter()
        .map(|row| row["anti_roll_bar"].as_str())
        .collect();
    assert!(states.contains(&"connected") && states.contains(&"disconnected"));

    assert_secants_are_near_derivatives(&figures);
    assert_levels_have_numbers(&rows(&directory.path().join("kc/levels.csv")));
    assert_is_symmetric(&rows(&directory.path().join("kc/compliance_matrix.csv")));
}

/// The loads of the secant are symmetric about the load of the derivative, so both slopes are nearly equal.
fn assert_secants_are_near_derivatives(figures: &[BTreeMap<String, String>]) {
    let secants = figures
        .iter()
        .filter(|row| !row["secant"].is_empty() && row["quantity"] == "toe_by_lateral_force");
    assert_eq!(secants.clone().count(), 6);
    for row in secants {
        let [value, secant] = ["value", "secant"].map(|key| row[key].parse::<f64>().unwrap());
        assert!(
            (value - secant).abs() < 0.05 * value.abs(),
            "{value} {secant}"
        );
    }
}

fn assert_levels_have_numbers(levels: &[BTreeMap<String, String>]) {
    let level = levels
        .iter()
        .find(|row| row["load"] == "lateral" && row["mode"] == "single" && row["level"] == "5");
    let level = level.unwrap();
    assert_eq!(level["side"], "left");
    for column in [
        "left_toe_deg",
        "right_subframe_front_force_y_N",
        "mean_steer_deg",
        "rack_force_N",
        "anti_roll_bar_torque_N_m",
    ] {
        level[column]
            .parse::<f64>()
            .unwrap_or_else(|_| panic!("{column}"));
    }
}

/// The compliance matrix of both wheels is symmetric.
fn assert_is_symmetric(matrix: &[BTreeMap<String, String>]) {
    assert_eq!(matrix.len(), 12);
    let names = ["fx", "fy", "fz", "mx", "my", "mz"];
    let names: Vec<String> = ["left_", "right_"]
        .iter()
        .flat_map(|side| names.map(|n| format!("{side}{n}")))
        .collect();
    let entry = |i: usize, j: usize| matrix[i][&names[j]].parse::<f64>().unwrap();
    for i in 0..12 {
        for j in 0..i {
            let scale = (entry(i, i) * entry(j, j)).sqrt();
            assert!((entry(i, j) - entry(j, i)).abs() < 1e-10 * scale, "{i} {j}");
        }
    }
}

#[test]
fn check_lists_mounts_and_commands_of_rigid_mechanisms_refuse() {
    let directory = tempfile::tempdir().unwrap();
    let checked = hardpoint(&["check", &study()], directory.path());
    let said = String::from_utf8_lossy(&checked.stdout).into_owned();
    assert_eq!(checked.status.code(), Some(0), "{said}");
    for word in [
        "subframe_front",
        "rack",
        "The subframe holds lower_arm_front",
        "vertical_force",
    ] {
        assert!(said.contains(word), "{word}: {said}");
    }
    let refused = hardpoint(&["assemblies", &study()], directory.path());
    let errors = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2), "{errors}");
    assert!(errors.contains("elastic parts"), "{errors}");
    let named = hardpoint(&["kc", &study(), "--names", "spmm"], directory.path());
    let errors = String::from_utf8_lossy(&named.stderr).into_owned();
    assert_eq!(named.status.code(), Some(2), "{errors}");
    assert!(errors.contains("--names spmm is not available"), "{errors}");
}

/// `check` warns about the right wheel of an elastic axle, if this wheel has its own points.
#[test]
fn check_warns_about_the_right_wheel() {
    let directory = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(study()).unwrap();
    let own = "[axle.right.hardpoints]\nupper_arm_front = [-150.0, -430.0, 492.0]\n\
               upper_arm_rear = [80.0, -440.0, 508.0]";
    let exchanged = text.replace("right = \"mirrored\"", own);
    assert_ne!(exchanged, text);
    std::fs::write(directory.path().join("right.toml"), exchanged).unwrap();
    let checked = hardpoint(&["check", "right.toml"], directory.path());
    let said = String::from_utf8_lossy(&checked.stdout).into_owned();
    let said = crate::support::one_line(&said);
    assert!(
        said.contains("right wheel: upper_arm_front is behind upper_arm_rear"),
        "{said}"
    );
}

/// If all mounts of a subframe are on one line, only their torsional stiffness holds the subframe against rotation about this
/// line. The forces at the design load are computed without torsional stiffness. Then nothing holds the subframe, so the program
/// refuses such mounts.
#[test]
fn mounts_on_one_line_do_not_hold_the_subframe() {
    let directory = tempfile::tempdir().unwrap();
    let with_front_at = |x: &str| {
        let mounts = format!(
            "subframe.mounts={{ subframe_front = [{x}, 350.0, 160.0], subframe_rear = [0.0, 250.0, 160.0] }}"
        );
        let torsion = "bushings.subframe_front.stiffness=[4000.0, 5000.0, 3500.0, 2e7, 3e7, 2e7]";
        let tests = "compliance.tests=[{ load = \"braking\", levels = 3 }]";
        let study = study();
        let sets = ["--set", &mounts, "--set", torsion, "--set", tests];
        hardpoint(
            &[&["kc", &study, "--out", "-"][..], &sets].concat(),
            directory.path(),
        )
    };
    let refused = with_front_at("0.0");
    let errors = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2), "{errors}");
    assert!(
        errors.contains("only the torsional stiffness of bushings holds the subframe"),
        "{errors}"
    );
    // The program accepts a mount one millimetre away from the line.
    assert_eq!(with_front_at("1.0").status.code(), Some(0));
}

/// For an axle without elastic parts, `kc` tests the rigid mechanism. The results agree with the curves.
#[test]
fn kc_tests_the_rigid_mechanism_of_an_axle() {
    let directory = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(study()).unwrap();
    let (rigid, _) = text.split_once("[compliance]").unwrap();
    let rigid = rigid
        .replace("rack_stiffness", "# rack")
        .replace("column_stiffness", "# column");
    let more = "[outputs]\ncharacteristics = [\"force_roll_centre_height\", \"bump_steer\"]\n";
    std::fs::write(directory.path().join("axle.toml"), format!("{rigid}{more}")).unwrap();
    for (command, out) in [("kc", "kc"), ("solve", "solve")] {
        let ran = hardpoint(&[command, "axle.toml", "--out", out], directory.path());
        let errors = String::from_utf8_lossy(&ran.stderr).into_owned();
        assert_eq!(ran.status.code(), Some(0), "{errors}");
    }
    let figures = rows(&directory.path().join("kc/kc.csv"));
    let value = |wheel: &str, quantity: &str| -> f64 {
        let is =
            |row: &&BTreeMap<String, String>| row["wheel"] == wheel && row["quantity"] == quantity;
        figures.iter().find(is).unwrap()["value"].parse().unwrap()
    };
    let curves = rows(&directory.path().join("solve/curves.csv"));
    let at_design = curves
        .iter()
        .find(|row| row["heave_mm"].parse() == Ok(0.0))
        .unwrap();
    let curve = |column: &str| at_design[column].parse::<f64>().unwrap();
    let height = value("axle", "force_roll_centre_height_compliant");
    assert!((height - curve("force_roll_centre_height_mm")).abs() < 1e-9 * height);
    let steer = value("right", "toe_by_heave");
    assert!((steer - curve("right_bump_steer_deg_per_mm")).abs() < 1e-9 * steer.abs());
    value("axle", "steer_by_roll");
}

/// If the initial state has no equilibrium, the message names the part that is too soft.
#[test]
fn a_loose_subframe_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let text = std::fs::read_to_string(study()).unwrap();
    let loose = text
        .replace("relaxed = \"at_design_load\"", "relaxed = \"free\"")
        .replace(
            "[4000.0, 5000.0, 3500.0, 2.0e5, 3.0e5, 2.0e5]",
            "[0.2, 0.2, 0.2, 10.0, 10.0, 10.0]",
        )
        .replace(
            "[3000.0, 4000.0, 2500.0, 2.0e5, 3.0e5, 2.0e5]",
            "[0.2, 0.2, 0.2, 10.0, 10.0, 10.0]",
        );
    std::fs::write(here.join("loose.toml"), loose).unwrap();
    let ran = hardpoint(&["kc", "loose.toml", "--out", "kc"], here);
    let said = String::from_utf8_lossy(&ran.stdout);
    assert_eq!(ran.status.code(), Some(1), "{said}");
    assert!(said.contains("then the subframe moves along"), "{said}");
}

/// `check` warns of a c_factor with the wrong sign, also for an axle with elastic parts.
#[test]
fn a_wheel_that_turns_against_the_steering_wheel_is_doubted() {
    let directory = tempfile::tempdir().unwrap();
    for (sign, is_wrong) in [("-", false), ("", true)] {
        let factor = format!("steering.c_factor={sign}60.0");
        let ran = hardpoint(&["check", &study(), "--set", &factor], directory.path());
        let said =
            [&ran.stdout, &ran.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
        let said = crate::support::one_line(&said.concat());
        let doubt = "the wheels turn against the steering wheel";
        assert_eq!(said.contains(doubt), is_wrong, "{said}");
    }
}
