//! `--quiet`: nothing but errors and asked-for data.

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
