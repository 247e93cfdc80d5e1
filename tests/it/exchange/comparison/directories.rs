//! Tests of the directories of results that `compare` reads and writes.

use super::{changed, run, sample, wheel};
use crate::support::one_line;
use std::fs;

/// A run of `setup` is compared with its adjusted points, also at stations that the run does not have.
#[test]
fn a_set_up_is_compared_with_its_adjustments() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let study = |travel: &str| {
        changed(
            &sample("double_wishbone_tolerance.toml"),
            &[("travel = ", travel)],
        )
    };
    fs::write(at.join("few.toml"), study("travel = [-5.0, 0.0, 5.0]")).unwrap();
    fs::write(at.join("own.toml"), study("travel = [-10.0, 0.0, 10.0]")).unwrap();
    run(at, &["--quiet", "solve", "few.toml", "--out", "few"], 0);
    let want = "setup.want={ camber = -1.5 }";
    let set_up = ["--quiet", "setup", "own.toml", "--set", want];
    run(at, &[&set_up[..], &["--out", "set_up"]].concat(), 0);

    let compare = ["compare", "few", "set_up", "--out", "sides"];
    let [tables, said] = run(at, &compare, 0);
    assert!(said.contains("solved again"), "{said}");
    assert!(tables.contains("moved"), "{tables}");
    let at_static = |file: &str, name: &str| {
        let csv = fs::read_to_string(at.join(file)).unwrap();
        let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let header = lines.next().unwrap();
        let column = header.iter().position(|own| *own == name);
        let column = column.unwrap_or_else(|| panic!("{header:?}"));
        let row = lines.find(|row| row[0] == "0.0").unwrap();
        row[column].parse::<f64>().unwrap()
    };
    let of_run = at_static("set_up/curves.csv", "camber_deg");
    let again = at_static("sides/comparison.csv", "camber_deg [set_up]");
    // Before the adjustments, camber is -2 degrees.
    assert!((of_run + 1.5).abs() <= 0.1, "{of_run}");
    assert!((again - of_run).abs() <= 1e-9, "{again} {of_run}");

    // `export` has no adjusted study, so it refuses the run.
    let [_, said] = run(at, &["export", "set_up", "--to", "csv"], 2);
    let said = one_line(&said);
    assert!(said.contains("the points before the adjustments"), "{said}");
}

/// In the default output directory, a comparison does not overwrite an earlier comparison of other designs.
#[test]
fn another_comparison_replaces_no_earlier_one() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    fs::write(directory.join("a.toml"), wheel()).unwrap();
    let text = wheel();
    let pivot = text
        .lines()
        .find(|line| line.starts_with("lower_arm_front"))
        .unwrap();
    for (name, z) in [("b.toml", 205.0), ("c.toml", 206.0)] {
        let line = format!("lower_arm_front = [150.0, 350.0, {z:?}]");
        fs::write(directory.join(name), wheel().replace(pivot, &line)).unwrap();
    }
    let first = directory.join("out/compare/comparison.csv");
    run(directory, &["compare", "a.toml", "b.toml"], 0);
    let of_b = fs::read(&first).unwrap();
    // A repeated comparison of the same designs replaces the earlier one.
    run(directory, &["compare", "a.toml", "b.toml"], 0);
    let [_, said] = run(directory, &["compare", "a.toml", "c.toml"], 0);
    assert!(said.contains("are now in out/compare.1"), "{said}");
    assert_eq!(
        fs::read(directory.join("out/compare.1/comparison.csv")).unwrap(),
        of_b
    );
    assert_ne!(fs::read(&first).unwrap(), of_b);
    // If the user names the output directory, the program does not move earlier results to another directory. It
    // replaces these results only with `--force`.
    run(
        directory,
        &["compare", "a.toml", "b.toml", "--out", "mine"],
        0,
    );
    run(
        directory,
        &["compare", "a.toml", "c.toml", "--out", "mine"],
        2,
    );
    run(
        directory,
        &["compare", "a.toml", "c.toml", "--out", "mine", "--force"],
        0,
    );
}
