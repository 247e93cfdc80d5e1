//! Tests that a converted study has physically the same results.

use super::{INCHES, METRES, converted, is_elastic, results, studies};
use crate::support::larger;
use hardpoint::study::CarStudy;
use std::fs;
use std::path::Path;

/// Factor from a unit, given by its word, to SI units and degrees.
fn si_of_word(word: &str) -> Option<f64> {
    Some(match word {
        "mm" => 1e-3,
        "in" => 0.0254,
        "ft" => 0.3048,
        "lbf" => 4.448_221_615_260_5,
        "kN" => 1e3,
        "100" => 100.0,
        "m" | "m2" | "N" | "deg" | "rad" | "s" | "s2" | "percent" | "Hz" | "g" => 1.0,
        "mm2" => 1e-6,
        "in2" => 0.0254 * 0.0254,
        _ => return None,
    })
}

/// Splits the name of a column into the name without its unit and the factor of the unit.
fn split_unit(column: &str) -> (String, f64) {
    let words: Vec<&str> = column.split('_').collect();
    let is_unit = |word: &&str| *word == "per" || si_of_word(word).is_some();
    let units = words[1..].iter().rev().take_while(|word| is_unit(word));
    let stem = words.len() - units.count();
    let (mut factor, mut is_below) = (1.0, false);
    for word in &words[stem..] {
        match si_of_word(word) {
            None => is_below = true,
            Some(value) if is_below => factor /= value,
            Some(value) => factor *= value,
        }
    }
    (words[..stem].join("_"), factor)
}

/// Sign that converts a column to ISO 8855. `signs` are the signs of the study's axes relative to ISO 8855.
pub(super) fn sign(stem: &str, signs: [f64; 3]) -> f64 {
    if ["rack", "steer_by_rack", "caster_by_rack", "rack_force"].contains(&stem) {
        return signs[1];
    }
    // Examples of components: wheel_centre_y, wheel_centre_vy, wheel_centre_y_d1. The accelerations ax and ay of a car
    // always point forward and to the left.
    let mut words = stem.split('_').filter(|word| !["d1", "d2"].contains(word));
    let last = words.next_back().filter(|_| stem.contains('_'));
    let last = last.unwrap_or_default();
    let axis = ["x", "y", "z"]
        .iter()
        .position(|axis| [*axis, &format!("v{axis}"), &format!("a{axis}")].contains(&last));
    axis.map_or(1.0, |axis| signs[axis])
}

fn signs(options: &[&str]) -> [f64; 3] {
    match options.last() {
        Some(&"sae_j670") => [1.0, -1.0, -1.0],
        Some(&"x_rear") => [-1.0, -1.0, 1.0],
        _ => [1.0; 3],
    }
}

type Rows = Vec<Vec<Result<f64, String>>>;

/// Sign that converts a column, given by its name without the unit, to the axes of the first study.
type Signs<'a> = &'a dyn Fn(&str) -> f64;

/// Names of columns without units, and rows in SI units and in the axes of the first study, ordered by station.
fn table(file: &Path, sign: Signs<'_>) -> (Vec<String>, Rows) {
    let mut reader = csv::Reader::from_path(file).unwrap();
    let header: Vec<(String, f64)> = reader.headers().unwrap().iter().map(split_unit).collect();
    let names: Vec<String> = header.iter().map(|(stem, _)| stem.clone()).collect();
    let at = |name: &str| names.iter().position(|own| own == name);
    let mut rows: Rows = Vec::new();
    for record in reader.records() {
        let record = record.unwrap();
        // Each row of test results has its own unit.
        let own_unit = at("unit").map(|unit| split_unit(&format!("value_{}", &record[unit])).1);
        let quantity = at("quantity").map_or("", |quantity| &record[quantity]);
        let cells = record.iter().zip(&header).map(|(text, (stem, factor))| {
            let is_figure = ["value", "secant"].contains(&&**stem);
            let factor = own_unit.filter(|_| is_figure).unwrap_or(*factor);
            let name = if is_figure { quantity } else { stem };
            let number = text.parse::<f64>();
            number
                .map(|number| number * factor * sign(name) + 0.0)
                .map_err(|_| {
                    if stem == "unit" {
                        String::new()
                    } else {
                        text.to_owned()
                    }
                })
        });
        rows.push(cells.collect());
    }
    // If the y axis is reversed, rack displacements are in reverse order. So the function sorts the rows by station.
    let stations = [
        "case",
        "travel",
        "heave",
        "roll",
        "travel_left",
        "travel_right",
        "rack",
    ];
    let keys: Vec<usize> = stations.iter().filter_map(|name| at(name)).collect();
    rows.sort_by(|one, other| {
        let order = keys.iter().map(|key| match (&one[*key], &other[*key]) {
            (Ok(one), Ok(other)) if (one - other).abs() > 1e-7 => one.total_cmp(other),
            _ => std::cmp::Ordering::Equal,
        });
        order.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then)
    });
    (names, rows)
}

/// Compares two tables by column, relative to the largest value of the column.
pub(super) fn compare(label: &str, one: &Path, other: &Path, signs: Signs<'_>, bound: f64) {
    let (names, expected) = table(one, &|_| 1.0);
    let (others, found) = table(other, signs);
    assert_eq!(names, others, "{label}");
    assert_eq!(expected.len(), found.len(), "{label}");
    // The column `window` (load range of a test) has the unit of the load, which its heading does not contain. So the
    // comparison omits this column.
    let columns = names.iter().enumerate();
    for (column, name) in columns.filter(|(_, name)| *name != "window") {
        // Rows of different test results have no common scale.
        let of_row = names.iter().any(|name| name == "quantity");
        let size =
            |row: &Vec<Result<f64, String>>| row[column].as_ref().map_or(0.0, |value| value.abs());
        let largest = expected.iter().map(size).fold(0.0, larger);
        for (row, new) in expected.iter().zip(&found) {
            let scale = if of_row { size(row) } else { largest };
            let is_same = match (&row[column], &new[column]) {
                // Values below 1e-4 have an absolute bound, because they may be rounding errors.
                (Ok(old), Ok(new)) => (old - new).abs() <= bound * scale.max(1e-4),
                (old, new) => old == new,
            };
            assert!(
                is_same,
                "{label} {name}: {:?} {:?}\n{row:?}",
                row[column], new[column]
            );
        }
    }
}

pub(super) fn tables_of_results(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let is_curve = |name: &String| {
        let starts = ["curves", "kc.", "cases.", "gg."];
        name.ends_with(".csv") && starts.iter().any(|start| name.starts_with(start))
    };
    let mut names: Vec<String> = names.filter(is_curve).collect();
    names.sort();
    names
}

/// Curves, test results and states of cars are physically the same in both conversions.
#[test]
fn every_sample_study_gives_the_same_physical_results_in_other_units_and_axes() {
    let directory = tempfile::tempdir().unwrap();
    let mut compared = 0;
    for file in studies() {
        let command = if is_elastic(&file) { "kc" } else { "solve" };
        let old = results(command, &file, &[], directory.path());
        for (number, options) in [INCHES, METRES].iter().enumerate() {
            let place = directory.path().join(number.to_string());
            let new = converted(&file, options, &place);
            let new = results(command, &new, &[], &place);
            for name in tables_of_results(&old) {
                let label = format!("{} {name} {options:?}", file.display());
                // Attia's method has fifteen equations. Accelerations are less accurate with this method than with the
                // pose of the wheel carrier.
                let bound = if file.ends_with("attia.toml") {
                    1e-8
                } else {
                    1e-9
                };
                compare(
                    &label,
                    &old.join(&name),
                    &new.join(&name),
                    &|name| sign(name, signs(options)),
                    bound,
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 90, "{compared}");
}

pub(super) fn summary(directory: &Path) -> serde_json::Value {
    let text = fs::read_to_string(directory.join("summary.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

pub(super) fn assert_near(
    label: &str,
    old: &serde_json::Value,
    new: &serde_json::Value,
    bound: f64,
) {
    let (one, other) = (old.as_f64(), new.as_f64());
    let (Some(one), Some(other)) = (one, other) else {
        panic!("{label}: {old} {new}");
    };
    assert!(
        (one - other).abs() <= bound * one.abs(),
        "{label}: {one} {other}"
    );
}

/// Options that end a tuning after its first iteration.
pub(super) const FIRST_ITERATION: [&str; 6] = [
    "--set",
    "optimise.max_iterations=1",
    "--set",
    "optimise.starts=1",
    "--set",
    "optimise.side_effects=false",
];

/// Returns true if a sample has a tuning without scatter. Tunings with scatter take long, and their targets have the same form.
pub(super) fn is_plain_tuning(file: &Path) -> bool {
    let text = fs::read_to_string(file).unwrap();
    text.contains("\n[optimise]") && !text.contains("\nscatter = ")
}

/// Targets, tolerances and weights keep their meaning: the misfit of the design does not change.
#[test]
fn every_sample_tuning_begins_with_the_same_misfit_in_other_units_and_axes() {
    let directory = tempfile::tempdir().unwrap();
    let mut compared = 0;
    for file in studies().into_iter().filter(|file| is_plain_tuning(file)) {
        let old = summary(&results(
            "optimise",
            &file,
            &FIRST_ITERATION,
            directory.path(),
        ));
        for (number, options) in [INCHES, METRES].iter().enumerate() {
            let place = directory.path().join(number.to_string());
            let new = converted(&file, options, &place);
            let new = summary(&results("optimise", &new, &FIRST_ITERATION, &place));
            let label = format!("{} {options:?}", file.display());
            if CarStudy::is_at(&file) {
                assert_near(&label, &old["misfit"][0], &new["misfit"][0], 1e-9);
            } else {
                assert_near(&label, &old["misfit_before"], &new["misfit_before"], 1e-9);
            }
            compared += 1;
        }
    }
    assert!(compared > 20, "{compared}");
}
