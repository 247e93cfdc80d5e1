//! What `check`, `solve` and `limits` say of one motion is the same, and so are their exit codes.

use std::path::Path;
use std::process::{Command, Output};

fn run(command: &str, study: &str, set: &[&str]) -> Output {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("studies")
        .join(study);
    let mut arguments = vec![command.to_owned(), path.to_str().unwrap().to_owned()];
    for value in set {
        arguments.extend(["--set".to_owned(), (*value).to_owned()]);
    }
    if command == "solve" {
        arguments.extend(["--out".to_owned(), "-".to_owned()]);
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_hardpoint"));
    command
        .args(&arguments)
        .env("COLUMNS", "400")
        .output()
        .unwrap()
}

/// What a command says, on either stream, in one line.
fn said(output: &Output) -> String {
    let both = [&output.stdout, &output.stderr].map(|s| String::from_utf8_lossy(s).into_owned());
    both.concat()
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}

#[test]
fn travel_that_is_not_reached_is_said_by_all_three() {
    for (set, code) in [
        ("motion.travel=[0.0, 300.0]", 0),
        ("motion.travel=[0.0, 400.0]", 1),
    ] {
        for command in ["check", "solve", "limits"] {
            let output = run(command, "macpherson_solve.toml", &[set]);
            assert_eq!(
                output.status.code(),
                Some(code),
                "{command}: {}",
                said(&output)
            );
            let told = said(&output).contains(
                "the wheel travel ends at 349.667807 mm: the wheel centre is at its highest",
            );
            assert_eq!(told, code == 1, "{command}: {}", said(&output));
        }
    }
}

#[test]
fn a_named_motion_that_is_not_reached_is_said_by_all_three() {
    for (set, code) in [
        ("motions.left_lock.rack=60.0", 0),
        ("motions.left_lock.rack=360.0", 1),
    ] {
        for command in ["check", "solve", "limits"] {
            let output = run(command, "macpherson_steering.toml", &[set]);
            let said = said(&output);
            assert_eq!(output.status.code(), Some(code), "{command}: {said}");
            let told = said.contains(
                "motion left_lock: not solved: travel -40 to 40, rack 360 (9 stations): the rack moves no further than",
            );
            assert_eq!(told, code == 1, "{command}: {said}");
        }
    }
}

#[test]
fn a_column_without_a_value_is_not_done() {
    // Points that the definition tells apart are at one place, so that the quotient has no value.
    let set = "suspension.hardpoints.wheel_centre=[1.47979023854085, 0.3715370715633186, 0.2223007791913243]";
    let spindle = "suspension.hardpoints.spindle_inner=[1.60607, 0.39391, 0.04829]";
    let same = "suspension.hardpoints.strut_upper=[1.47979023854085, 0.3715370715633186, 0.2223007791913243]";
    for command in ["check", "solve"] {
        let output = run(command, "attia.toml", &[set, same, spindle]);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(1), "{command}: {said}");
        let reason = "no value at any station: wheel_centre and strut_upper are at one place";
        assert!(
            said.contains("attia_camber_deg") && said.contains(reason),
            "{said}"
        );
    }
}

#[test]
fn stations_at_toggle_are_counted_as_such() {
    let output = run(
        "solve",
        "double_wishbone_pushrod.toml",
        &["motion.travel=[0.0, 100.0, 150.0, 160.0]"],
    );
    let said = said(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("2 of 4 stations solved, 2 toggle"), "{said}");
}

#[test]
fn limits_are_given_at_every_rack_of_the_study() {
    let output = run(
        "limits",
        "macpherson_solve.toml",
        &["motion.rack=[-60.0, 0.0, 60.0]"],
    );
    let said = said(&output);
    for row in ["rack -60", "rack 60", "every rack"] {
        assert!(said.contains(row), "{said}");
    }
    assert_eq!(output.status.code(), Some(0), "{said}");
}

#[test]
fn exchanged_pivots_and_offsets_for_coordinates_are_doubted() {
    let front = "suspension.hardpoints.lower_arm_front=[-260.0, 350.0, 205.0]";
    let rear = "suspension.hardpoints.lower_arm_rear=[120.0, 360.0, 195.0]";
    let text = said(&run("check", "macpherson_solve.toml", &[front, rear]));
    assert!(
        text.contains("lower_arm_front is behind lower_arm_rear"),
        "{text}"
    );
    let variable = |range: &str, absolute: bool| {
        format!(
            "sweep={{method=\"sobol\", samples=8, variables=[{{hardpoint=\"tie_rod_inner\", axis=\"z\", range={range}, \
             absolute={absolute}}}]}}"
        )
    };
    for (range, absolute, doubted) in [
        ("[-10.0, 10.0]", true, Some("Are these offsets?")),
        ("[233.0, 253.0]", false, Some("coordinates?")),
        ("[233.0, 253.0]", true, None),
        ("[-10.0, 10.0]", false, None),
    ] {
        let text = said(&run(
            "check",
            "macpherson_solve.toml",
            &[&variable(range, absolute)],
        ));
        match doubted {
            Some(phrase) => assert!(text.contains(phrase), "{text}"),
            None => assert!(!text.contains("doubtful"), "{text}"),
        }
    }
}
