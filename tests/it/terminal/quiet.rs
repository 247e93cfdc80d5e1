//! Tests of `--quiet`: the program prints only errors and requested data.

use super::{Called, study};

#[test]
fn quiet_says_nothing_where_all_is_well() {
    for (command, name, more) in [
        ("solve", "macpherson_solve", &[][..]),
        ("optimise", "macpherson_front", &[]),
        ("sweep", "macpherson_sweep", &["--set", "sweep.samples=32"]),
        ("check", "macpherson_solve", &[]),
    ] {
        let called = Called::on(command, name, &[more, &["--quiet"]].concat());
        assert_eq!(called.code(), Some(0));
        assert_eq!(
            (called.said(), called.complained()),
            Default::default(),
            "{command}"
        );
        if command != "check" {
            assert!(!called.file("summary.json").is_empty());
        }
    }
}

#[test]
fn quiet_leaves_data_that_were_asked_for() {
    let path = study("macpherson_solve");
    let path = path.to_str().unwrap();
    let called = Called::with(&["-q", "solve", path, "--out", "-"], &[]);
    assert!(called.said().starts_with("travel_mm,"));
    assert_eq!(called.complained(), "");
    let called = Called::on("solve", "macpherson_solve", &["-q", "--format", "json"]);
    assert!(called.said().starts_with('{'));
    assert_eq!(called.complained(), "");
    let called = Called::on("limits", "macpherson_solve", &["-q"]);
    assert!(called.said().contains("travel_mm") && !called.said().contains("Over the study"));
}

#[test]
fn quiet_leaves_errors() {
    let more = ["-q", "--set", "motion.travel=[-400.0, 0.0]"];
    let called = Called::on("solve", "macpherson_solve", &more);
    assert_eq!(called.code(), Some(1));
    assert_eq!(called.said(), "");
    assert!(
        called.complained().starts_with("not solved: travel -400"),
        "{}",
        called.complained()
    );
    let called = Called::on(
        "solve",
        "macpherson_solve",
        &["-q", "--set", "motion.rack=near"],
    );
    assert_eq!(called.code(), Some(2));
    assert!(called.complained().contains("error"));
}

/// A quiet command with exit code 1 prints only the missing results.
#[test]
fn quiet_says_what_could_not_be_had() {
    let same = "[1.47979023854085, 0.3715370715633186, 0.2223007791913243]";
    let centre = format!("suspension.hardpoints.wheel_centre={same}");
    let mount = format!("suspension.hardpoints.strut_upper={same}");
    let spindle = "suspension.hardpoints.spindle_inner=[1.60607, 0.39391, 0.04829]";
    let empty = ["-q", "--set", &centre, "--set", &mount, "--set", spindle];
    let toggle = ["-q", "--set", "motion.travel=[0.0, 100.0, 150.0, 160.0]"];
    for (name, more, missing) in [
        ("attia", &empty[..], "attia_camber_deg"),
        ("double_wishbone_pushrod", &toggle, "is at toggle"),
    ] {
        let called = Called::on("solve", name, more);
        assert_eq!(called.code(), Some(1), "{name}");
        let complained = called.complained();
        let lines: Vec<&str> = complained.lines().filter(|line| !line.is_empty()).collect();
        assert!(complained.contains(missing), "{complained}");
        assert!(
            lines.iter().all(|line| line.starts_with("warning: ")),
            "{complained}"
        );
    }
}

/// `setup` states the unsolved stations around the new static position, also with `--quiet`.
#[test]
fn a_set_up_states_its_unsolved_stations() {
    let far = [
        "--set",
        "setup.want={ camber = -1.5 }",
        "--set",
        "motion.travel=[-500.0, 0.0]",
    ];
    for quiet in [&[][..], &["-q"]] {
        let called = Called::on(
            "setup",
            "double_wishbone_tolerance",
            &[&far[..], quiet].concat(),
        );
        assert_eq!(called.code(), Some(1));
        let told = if quiet.is_empty() {
            called.said()
        } else {
            called.complained()
        };
        assert!(told.contains("not solved: travel -500"), "{told}");
    }
}

/// Each failure of a command without files has its own line, also with `--quiet`.
#[test]
fn quiet_failures_have_their_own_lines() {
    let far = "motion.travel=[-400.0, 0.0, 400.0]";
    for command in ["check", "limits"] {
        let called = Called::on(command, "macpherson_solve", &["-q", "--set", far]);
        assert_eq!(called.code(), Some(1), "{command}");
        let complained = called.complained();
        let lines = complained
            .lines()
            .filter(|line| line.starts_with("not solved: travel"));
        assert_eq!(lines.count(), 2, "{command}: {complained}");
        assert!(complained.ends_with('\n'), "{command}");
    }
}
