//! Tests of messages and refusals of the commands for studies with elastic parts.

use super::command::{hardpoint, study};
use std::path::Path;

/// Runs a command that must be refused. Checks the exit code and returns the messages.
fn refused(arguments: &[&str], directory: &Path) -> String {
    let ran = hardpoint(arguments, directory);
    let said = String::from_utf8_lossy(&ran.stderr).into_owned();
    assert_eq!(ran.status.code(), Some(2), "{arguments:?}: {said}");
    assert!(ran.stdout.is_empty(), "{arguments:?}");
    said
}

/// `assemblies` refuses elastic parts, because it would ignore them. `check` lists them.
#[test]
fn assemblies_refuses_elastic_parts_and_check_lists_them() {
    let directory = tempfile::tempdir().unwrap();
    let path = study("double_wishbone_compliance.toml");
    let said = refused(&["assemblies", &path], directory.path());
    assert!(said.contains("would ignore them"), "{said}");
    let ran = hardpoint(&["check", &path], directory.path());
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert_eq!(ran.status.code(), Some(0), "{said}");
    assert!(said.contains("Elastic parts") && said.contains("lower_arm_rear"));
}

/// `kc` refuses topologies whose arm is connected to the carrier at two points, because its tests do not support them.
#[test]
fn kc_refuses_arms_that_hold_the_carrier_twice() {
    let directory = tempfile::tempdir().unwrap();
    for topology in ["integral_link", "h_arm"] {
        let path = study(&format!("{topology}_solve.toml"));
        let said = refused(&["kc", &path, "--out", "kc"], directory.path());
        assert!(said.contains("at two points"), "{said}");
    }
}

/// A page needs a directory, so `kc` refuses it with results on standard output.
#[test]
fn a_page_of_tests_needs_a_directory() {
    let directory = tempfile::tempdir().unwrap();
    let study = study("double_wishbone_compliance.toml");
    let said = refused(&["kc", &study, "--out", "-", "--report"], directory.path());
    assert!(said.contains("--report needs a directory"), "{said}");
}

/// `kc` and `setup` make no pictures, so they have no option `--plots`.
#[test]
fn tests_and_set_ups_have_no_option_for_pictures() {
    let directory = tempfile::tempdir().unwrap();
    let study = study("double_wishbone_compliance.toml");
    for command in ["kc", "setup"] {
        let help = hardpoint(&[command, "--help"], directory.path());
        assert!(!String::from_utf8_lossy(&help.stdout).contains("--plots"));
        let said = refused(&[command, &study, "--plots", "pictures"], directory.path());
        assert!(said.contains("unexpected argument '--plots'"), "{said}");
    }
}

/// The program names a measured sheet that does not exist. It does not ask for the keys of a curve, because a sheet does
/// not need them.
#[test]
fn a_missing_sheet_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let path = study("double_wishbone_compliance.toml");
    let optimise = "optimise={variables=[{rate=\"spring\",range=[5.0,150.0]}],\
                    targets=[{file=\"nofile.csv\",tolerance=1.0}]}";
    let said = refused(&["optimise", &path, "--set", optimise], directory.path());
    assert!(
        said.contains("cannot read ") && said.contains("nofile.csv"),
        "{said}"
    );
    assert!(
        !said.contains("expected \"figure\" or \"characteristic\""),
        "{said}"
    );
}

/// If the spring has no force, `kc` refuses the study and names the spring, because the spring cannot carry the wheel.
/// `kc` accepts a small spring force. It also accepts a spring without force if the parts are free of force in the
/// design position.
#[test]
fn a_spring_without_force_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    for name in [
        "double_wishbone_compliance.toml",
        "subframe_axle_compliance.toml",
    ] {
        let path = study(name);
        let kc = |changes: &[&str]| {
            let mut arguments = vec!["kc", &path, "--out", "-"];
            for change in changes {
                arguments.extend(["--set", change]);
            }
            hardpoint(&arguments, directory)
        };
        let ran = kc(&["spring.force=0.0"]);
        let said = String::from_utf8_lossy(&ran.stderr).into_owned();
        assert_ne!(ran.status.code(), Some(0), "{name}");
        assert!(
            said.contains("the spring's force in the design position is 0"),
            "{said}"
        );
        assert!(!said.contains("leverage"), "{said}");
        assert!(kc(&["spring.force=0.001"]).status.success(), "{name}");
        let free = ["spring.force=0.0", "compliance.relaxed=\"free\""];
        assert!(kc(&free).status.success(), "{name}");
    }
}

/// `kc` does not ask for elastic parts that the study cannot have.
#[test]
fn kc_does_not_ask_for_impossible_parts() {
    let directory = tempfile::tempdir().unwrap();
    for (name, reason) in [
        (
            "twist_beam_solve.toml",
            "elastic parts are not available for twist beams yet",
        ),
        (
            "off_road_car_front.toml",
            "elastic parts are not available for a steered solid axle yet",
        ),
    ] {
        let said = refused(&["kc", &study(name)], directory.path());
        assert!(said.contains(reason), "{name}: {said}");
        assert!(!said.contains("expected [compliance]"), "{name}: {said}");
    }
    // A solid axle on links can have elastic parts, so the message asks for them.
    let said = refused(&["kc", &study("solid_axle_rear.toml")], directory.path());
    assert!(said.contains("expected [compliance]"), "{said}");
}

/// `kc` explains the signs of derivatives only if it has solved a station.
#[test]
fn signs_are_explained_only_if_there_are_values() {
    let directory = tempfile::tempdir().unwrap();
    let path = study("double_wishbone_compliance.toml");
    for (travel, is_explained) in [("0.0", true), ("900.0", false)] {
        let motion = format!("motion={{ travel = [{travel}] }}");
        let arguments = ["kc", &path, "--set", &motion, "--out", "kc"];
        let ran = hardpoint(&arguments, directory.path());
        let said = String::from_utf8(ran.stdout).unwrap();
        assert_eq!(
            said.contains("Derivatives at the station"),
            is_explained,
            "{said}"
        );
    }
}
