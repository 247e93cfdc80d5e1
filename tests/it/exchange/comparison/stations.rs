//! Tests of the stations at which `compare` solves and compares designs.

use super::{assert_same, changed, run, sample, wheel};
use crate::support::one_line;
use std::fs;

/// Curves at a single rack displacement have no column for the rack. `compare` still uses the displacement.
#[test]
fn a_fixed_rack_is_part_of_the_station() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let fixed = changed(&wheel(), &[("rack = ", "rack = 10.0")]);
    fs::write(at.join("fixed.toml"), fixed).unwrap();
    fs::write(at.join("all.toml"), wheel()).unwrap();
    run(
        at,
        &[
            "convert",
            "fixed.toml",
            "--frame",
            "x_rear",
            "--out",
            "other.toml",
        ],
        0,
    );
    for (study, out) in [("all.toml", "all"), ("other.toml", "other")] {
        run(at, &["--quiet", "solve", study, "--out", out], 0);
    }
    for (sources, rows) in [
        (["fixed.toml", "other.toml"], 3),
        // The second run has no curves at two of the rack displacements, so `compare` solves its study again.
        (["all", "other"], 9),
        (["other", "all"], 3),
    ] {
        assert_same(at, sources, rows, 50);
    }
}

/// `compare` solves every other study over the drive of the first study, or states why it cannot.
#[test]
fn studies_follow_the_drive_of_the_first_study() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let travel = sample("double_wishbone_solve.toml");
    let with = |motion: &str| changed(&travel, &[("travel = ", motion)]);
    let write = |name: &str, text: &str| fs::write(at.join(name), text).unwrap();
    write("travel.toml", &travel);
    write(
        "angle.toml",
        &with("drive = \"arm_angle\"\narm_angle = { from = -5.0, to = 5.0, steps = 5 }"),
    );
    write(
        "time.toml",
        &with("time = { polynomial = [0.0, 20.0], from = -1.0, to = 1.0, steps = 7 }"),
    );
    write("macpherson.toml", &sample("macpherson_solve.toml"));
    write("five_link.toml", &sample("five_link_solve.toml"));
    write("elastic.toml", &sample("double_wishbone_compliance.toml"));
    for (first, rows, columns) in [
        ("travel.toml", 41, 9),
        ("angle.toml", 5, 10),
        ("time.toml", 7, 9),
    ] {
        for other in ["travel.toml", "angle.toml", "time.toml"] {
            assert_same(at, [first, other], rows, columns);
        }
    }
    // Another design has other travels at the same arm angles.
    let sources = ["compare", "angle.toml", "macpherson.toml", "--out", "-"];
    let [csv, _] = run(at, &sources, 0);
    assert!(csv.starts_with("arm_angle_deg,travel_mm [angle],"), "{csv}");
    assert_eq!(csv.lines().count(), 1 + 5);
    for (other, reason) in [
        ("five_link.toml", "five_link has no arm"),
        (
            "elastic.toml",
            "studies with [compliance] are solved over travel",
        ),
    ] {
        let [_, said] = run(at, &["compare", "angle.toml", other, "--out", "-"], 2);
        let said = one_line(&said);
        assert!(said.contains(reason), "{said}");
    }
    // A run that contains its study is solved again over the motion of the first run. A run without its study cannot be
    // solved again.
    run(at, &["--quiet", "solve", "angle.toml", "--out", "run"], 0);
    assert_same(at, ["run", "travel.toml"], 5, 10);
    assert_same(at, ["travel.toml", "run"], 41, 9);
    fs::remove_file(at.join("run/study.toml")).unwrap();
    let [_, said] = run(at, &["compare", "run", "travel.toml", "--out", "-"], 2);
    let said = one_line(&said);
    assert!(
        said.contains("the curves of run are over arm_angle_deg"),
        "{said}"
    );
}

/// A run with other stations is solved again, so the comparison has every station of the first design. A run without
/// its study is compared only at the common stations, and the command states their number.
#[test]
fn runs_with_other_stations_are_compared_at_all_stations_of_the_first() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    let study = |pivot: &str, from: f64, to: f64, steps: u32| {
        changed(
            &sample("double_wishbone_solve.toml"),
            &[
                (
                    "travel = ",
                    &format!("travel = {{ from = {from:?}, to = {to:?}, steps = {steps} }}"),
                ),
                ("lower_arm_front", pivot),
            ],
        )
    };
    let text = sample("double_wishbone_solve.toml");
    let pivot = text
        .lines()
        .find(|line| line.starts_with("lower_arm_front"))
        .unwrap();
    let moved = "lower_arm_front = [150.0, 350.0, 205.0]";
    fs::write(directory.join("first.toml"), study(pivot, -40.0, 40.0, 5)).unwrap();
    fs::write(directory.join("moved.toml"), study(moved, -40.0, 40.0, 5)).unwrap();
    fs::write(directory.join("other.toml"), study(moved, -30.0, 60.0, 10)).unwrap();
    run(directory, &["solve", "other.toml", "--out", "other"], 0);
    let [whole, _] = run(
        directory,
        &["compare", "first.toml", "moved.toml", "--out", "-"],
        0,
    );
    let [again, said] = run(
        directory,
        &["compare", "first.toml", "other", "--out", "-"],
        0,
    );
    assert!(said.contains("solved again over the same motion"), "{said}");
    assert_eq!(whole.replace("moved", "other"), again);
    fs::remove_file(directory.join("other/study.toml")).unwrap();
    fs::remove_file(directory.join("other/run.json")).unwrap();
    let [few, said] = run(
        directory,
        &["compare", "first.toml", "other", "--out", "-"],
        0,
    );
    // The common stations are -20, 0, 20 and 40: `other` has multiples of 10, from -30 on.
    assert_eq!(few.lines().count(), 5, "{few}");
    let said = one_line(&said);
    assert!(
        said.contains("cover only 4 common stations (first has 5, other has 10)"),
        "{said}"
    );
    // A run without its study does not affect the studies that follow: the command still solves them over the motion of
    // the first.
    let three = ["compare", "first.toml", "other", "other.toml", "--out", "-"];
    let [_, said] = run(directory, &three, 0);
    let said = one_line(&said);
    assert!(
        said.contains("(first has 5, other has 10, other.toml has 5)"),
        "{said}"
    );
}

/// A comparison of runs says at how many stations each design has no values, and exits with 1, like a comparison of studies.
#[test]
fn runs_with_unsolved_stations_are_incomplete() {
    let directory = tempfile::tempdir().unwrap();
    let study = changed(
        &sample("double_wishbone_solve.toml"),
        &[("travel = ", "travel = [-250.0, 0.0, 40.0, 250.0]")],
    );
    fs::write(directory.path().join("a.toml"), &study).unwrap();
    for run_name in ["first", "second"] {
        run(directory.path(), &["solve", "a.toml", "--out", run_name], 1);
    }
    for sources in [["first", "second"], ["first", "a.toml"]] {
        let arguments = [
            &["compare"],
            &sources[..],
            &["--out", "compared", "--force"],
        ]
        .concat();
        let [_, noted] = run(directory.path(), &arguments, 1);
        let [first, second] = sources.map(|name| name.trim_end_matches(".toml"));
        assert!(
            noted.contains(&format!(
                "Stations without all values: {first} 1 of 4, {second} 1 of 4."
            )),
            "{noted}"
        );
    }
}
