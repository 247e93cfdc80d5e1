//! Tests of `hardpoint compare`, as a user runs it.

mod directories;
mod frames;
mod stations;
mod units;

use crate::support::{larger, sample};
use assert_cmd::Command;
use std::collections::BTreeMap;
use std::path::Path;

const FRAMES: [&str; 2] = ["sae_j670", "x_rear"];

/// Runs a command in a directory. Returns standard output and standard error.
fn run(directory: &Path, arguments: &[&str], code: i32) -> [String; 2] {
    let mut command = Command::cargo_bin("hardpoint").unwrap();
    let done = command.current_dir(directory).args(arguments).assert();
    let output = done.code(code).get_output().clone();
    [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap())
}

/// Copies a study and replaces some of its lines. The beginning of a line selects that line.
fn changed(text: &str, lines: &[(&str, &str)]) -> String {
    let mut text = text.to_owned();
    for (start, new) in lines {
        let found = text.lines().find(|line| line.starts_with(start));
        text = text.replacen(&found.unwrap().to_owned(), new, 1);
    }
    text
}

/// Study of one wheel with several rack displacements, and components of points and forces.
fn wheel() -> String {
    changed(
        &sample("double_wishbone_solve.toml"),
        &[
            (
                "travel = ",
                "travel = { from = -20.0, to = 20.0, steps = 3 }",
            ),
            ("rack = ", "rack = [-4.0, 0.0, 10.0]"),
            (
                "# points = ",
                "points = [\"wheel_centre\", \"tie_rod_outer\"]\norder = \"acceleration\"\nknuckle = true\n\
                 loads = [{ name = \"braking\", at = \"contact_point\", force = [-3000.0, 500.0, 4000.0] }]",
            ),
        ],
    )
}

/// Study of an axle with several rack displacements, and components of points and forces.
fn axle() -> String {
    changed(
        &sample("double_wishbone_axle.toml"),
        &[
            ("roll = ", "travel_left = [-5.0, 5.0]"),
            ("heave = ", "rack = [-4.0, 0.0, 8.0]"),
            ("steering_wheel_angle = ", ""),
            // The new line omits the quantities of the sample that need a plane ground or steered wheels.
            (
                "  \"camber_to_road\"",
                "  \"camber_to_road\", \"steer\", \"force_roll_centre_height\",",
            ),
            (
                "[outputs]",
                "[outputs]\npoints = [\"wheel_centre\", \"tie_rod_outer\"]\norder = \"velocity\"\nknuckle = true\n\
                 loads = [{ name = \"braking\", at = \"contact_point\", force = [-3000.0, 500.0, 4000.0] }]",
            ),
        ],
    )
}

/// Compares two studies or runs. Returns the number of rows, and the largest difference of each column relative to its
/// largest value.
fn compare(directory: &Path, sources: [&str; 2]) -> (usize, BTreeMap<String, f64>) {
    let [one, other] = sources;
    let [_, said] = run(
        directory,
        &["compare", one, other, "--out", "sides", "--force"],
        0,
    );
    assert!(!said.contains("only in"), "{sources:?}: {said}");
    let mut reader = csv::Reader::from_path(directory.join("sides/comparison.csv")).unwrap();
    let header = reader.headers().unwrap().clone();
    let rows: Vec<_> = reader.records().map(|row| row.unwrap()).collect();
    let largest = |column: usize| {
        let cells = rows
            .iter()
            .filter_map(|row| row[column].parse::<f64>().ok());
        cells.fold(0.0, |most: f64, value| larger(most, value.abs()))
    };
    let columns = header.iter().enumerate();
    let differences = columns.filter(|(_, name)| name.contains(" - "));
    let relative = differences.map(|(column, name)| {
        // The column to the left contains the value of the second design.
        (
            name.to_owned(),
            largest(column) / largest(column - 1).max(1e-3),
        )
    });
    (rows.len(), relative.collect())
}

#[track_caller]
fn assert_same(directory: &Path, sources: [&str; 2], rows: usize, columns: usize) {
    let (found, differences) = compare(directory, sources);
    assert_eq!(found, rows, "{sources:?}");
    assert!(
        differences.len() >= columns,
        "{sources:?}: {}",
        differences.len()
    );
    for (name, difference) in differences {
        assert!(difference <= 1e-12, "{sources:?} {name}: {difference}");
    }
}
