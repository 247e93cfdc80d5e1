//! Tests of one build as a separate study, and of limits of builds.

use super::{plan, study};
use crate::support::{larger, one_line};
use hardpoint::curves::curves;
use hardpoint::study::Study;
use hardpoint::tolerance::{Problem, monte_carlo};
use serde_json::Value;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Command, Output};

fn hardpoint(directory: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hardpoint"));
    command.current_dir(directory).args(arguments);
    command.output().unwrap()
}

fn sample(name: &str) -> String {
    format!("{}/studies/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

/// Prints a build into a file of the directory.
fn print_build(directory: &Path, name: &str, number: u64) -> String {
    let output = hardpoint(
        directory,
        &["tolerance", &sample(name), "--build", &number.to_string()],
    );
    assert_eq!(output.status.code(), Some(0));
    let file = format!("build{number}.toml");
    std::fs::write(directory.join(&file), output.stdout).unwrap();
    file
}

/// The points of a printed build are identical to those of the Monte Carlo build, bit for bit. Every pose of the
/// printed build can be certified.
#[test]
fn a_printed_build_is_the_build_and_can_be_proved() {
    for name in ["double_wishbone_tolerance", "macpherson_tolerance"] {
        let directory = tempfile::tempdir().unwrap();
        let file = print_build(directory.path(), name, 0);
        let overrides = [
            "tolerance.builds=2",
            "tolerance.bands=[]",
            "motion.travel=[-30.0,0.0,30.0]",
            "outputs.characteristics=[\"camber\",\"toe\"]",
        ];
        let drawing = study(name, &overrides);
        let problem = Problem::of(&drawing, drawing.tolerance.as_ref().unwrap()).unwrap();
        let built = problem.built(0).unwrap();
        let overrides = overrides.map(str::to_owned);
        let printed = Study::read(&directory.path().join(&file), &overrides).unwrap();
        for (point, place) in built.mechanism.points.iter().zip(&built.design) {
            let id = printed.wheel().mechanism.point(&point.name).unwrap();
            assert_eq!(printed.wheel().design[id.0], *place, "{}", point.name);
        }

        // With two builds, one build has the smallest value and the other the largest.
        let drawn = problem.drawn().unwrap();
        let found = monte_carlo(&problem, &drawn, |_| ControlFlow::Continue(())).unwrap();
        let both = [built, problem.built(1).unwrap()];
        let curves = both.map(|built| curves(&built, &plan(&drawing)).unwrap());
        assert_eq!(curves[0].stations.len(), problem.stations().count());
        for (cell, spread) in found.spreads.iter().enumerate() {
            let (output, number) = (
                cell / problem.stations().count(),
                cell % problem.stations().count(),
            );
            let mut values = [0, 1].map(|k| curves[k].stations[number].values[output].unwrap());
            values.sort_by(f64::total_cmp);
            for (range, value) in spread.range.into_iter().zip(values) {
                let off = range.to_degrees() - value;
                assert!(off.abs() < 1e-11, "{name} {cell}: {off}");
            }
        }

        let proved = hardpoint(
            directory.path(),
            &[
                "solve",
                &file,
                "--set",
                "outputs.certify=true",
                "--out",
                "proved",
            ],
        );
        assert_eq!(proved.status.code(), Some(0));
        let table = std::fs::read_to_string(directory.path().join("proved/curves.csv")).unwrap();
        let mut table = csv::Reader::from_reader(table.as_bytes());
        let header = table.headers().unwrap().clone();
        let column = |name: &str| header.iter().position(|h| h == name).unwrap();
        let (error, apart) = (column("position_error_mm"), column("uniqueness_mm"));
        let rows: Vec<_> = table.records().map(Result::unwrap).collect();
        assert!(rows.len() > 20, "{name}");
        for row in rows {
            let [error, apart] = [&row[error], &row[apart]].map(|v| v.parse::<f64>().unwrap());
            assert!(error < 1e-9 && apart > 0.1, "{name}: {error} {apart}");
        }
    }
}

/// A build that cannot be assembled cannot be printed as a study: the command reports this, with exit code 1.
#[test]
fn a_rejected_build_is_said_to_be_one() {
    let directory = tempfile::tempdir().unwrap();
    let scatter = "tolerance.scatter=[{length=\"tie_rod\",limits=[300.0,300.1]}]";
    let output = hardpoint(
        directory.path(),
        &[
            "tolerance",
            &sample("macpherson_tolerance"),
            "--build",
            "7",
            "--set",
            "tolerance.aligned=false",
            "--set",
            scatter,
        ],
    );
    assert_eq!(output.status.code(), Some(1));
    assert!(output.stdout.is_empty());
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        said.contains("build 7") && said.contains("cannot reach"),
        "{said}"
    );
}

/// The limits of the builds together are the nearest limits of the single builds.
#[test]
fn limits_of_builds_are_the_nearest_of_each() {
    let (name, count) = ("double_wishbone_tolerance", 4);
    let directory = tempfile::tempdir().unwrap();
    let json = |arguments: &[&str]| -> Value {
        let arguments = [&["limits"], arguments, &["--format", "json"]].concat();
        let output = hardpoint(directory.path(), &arguments);
        serde_json::from_slice(&output.stdout).unwrap()
    };
    // The travel nearly reaches the droop limit of the nominal design.
    let travel = "motion.travel=[-305.7, 0.0, 10.0]";
    let study = sample(name);
    let found = json(&[&study, "--builds", &count.to_string(), "--set", travel]);
    let number = |row: &Value, key: &str| row[key].as_f64().unwrap();
    let single: Vec<Value> = (0..count)
        .map(|build| json(&[&print_build(directory.path(), name, build)])["limits"].clone())
        .collect();
    let rows = found["limits"].as_array().unwrap();
    assert!(rows.len() >= 4);
    for (k, row) in rows.iter().enumerate() {
        assert_eq!(row["quantity"], single[0][k]["quantity"]);
        let from = single.iter().map(|limits| number(&limits[k], "from"));
        let to = single.iter().map(|limits| number(&limits[k], "to"));
        assert_eq!(number(row, "nearest"), from.fold(f64::NEG_INFINITY, larger));
        assert_eq!(
            number(row, "nearest_there"),
            to.fold(f64::INFINITY, f64::min)
        );
        let build = row["in_build"].as_u64().unwrap() as usize;
        assert_eq!(number(&single[build][k], "from"), number(row, "nearest"));
    }
    let is_short = |limits: &Value| number(&limits[0], "from") > -305.7;
    let short: Vec<bool> = single.iter().map(is_short).collect();
    let counts = &found["builds"];
    let expected = short.iter().filter(|is| **is).count() as u64;
    assert_eq!(counts[1]["number"], expected);
    assert!(expected > 0, "{short:?}");
    let first = short.iter().position(|is| *is).unwrap();
    assert_eq!(counts[1]["first"], first);
    assert_eq!(counts[0]["number"], 0);
}

/// A study that was modified in memory prints builds of the modified design: the text contains every point of the
/// build.
#[test]
fn a_build_of_a_moved_study_has_all_moved_points() {
    let study = study(
        "double_wishbone_tolerance",
        &["tolerance.bands=[]", "tolerance.aligned=false"],
    );
    let shifted = study.wheel().design.iter().enumerate();
    let shifted = shifted.map(|(number, place)| {
        let mut place = *place;
        place.z += 0.25 * (number % 3) as f64;
        place
    });
    let moved = study.at_design(shifted.collect());
    let problem = Problem::of(&moved, moved.tolerance.as_ref().unwrap()).unwrap();
    let text = problem.built_text(0).unwrap();
    let printed = Study::from_text("built.toml", &text, Path::new("")).unwrap();
    let built = problem.built(0).unwrap();
    for (point, place) in built.mechanism.points.iter().zip(&built.design) {
        let id = printed.wheel().mechanism.point(&point.name).unwrap();
        assert_eq!(printed.wheel().design[id.0], *place, "{}", point.name);
    }
}

/// A build whose rack cannot be displaced so far does not reach the motion. The travel limit is that at the rack displacements
/// that can be reached.
#[test]
fn a_rack_out_of_reach_is_no_limit_of_the_travel() {
    let directory = tempfile::tempdir().unwrap();
    let study = sample("macpherson_tolerance");
    let bands =
        "tolerance.bands=[{ characteristic = \"caster\", at = 0.0, between = [3.3, 3.65] }]";
    let limits = |rack: &str, travel: &str, format: &str| {
        let arguments = ["limits", &study, "--builds", "2", "--set", bands];
        let more = ["--set", rack, "--set", travel, "--format", format];
        let output = hardpoint(directory.path(), &[&arguments[..], &more].concat());
        assert_eq!(output.status.code(), Some(0));
        let text = String::from_utf8(output.stdout).unwrap();
        one_line(&text)
    };
    let [alone, both] = ["motion.rack=0.0", "motion.rack=[0.0, -150.0]"];
    for travel in ["motion.travel=[0.0]", "motion.travel=[0.0, 80.0]"] {
        for (rack, short) in [(alone, 0), (both, 2)] {
            let found: Value = serde_json::from_str(&limits(rack, travel, "json")).unwrap();
            assert_eq!(found["builds"][1]["number"], short, "{rack} {travel}");
        }
        let [alone, both] = [alone, both].map(|rack| limits(rack, travel, "text"));
        let (_, distance) = alone.split_once("Nearest travel limit: ").unwrap();
        let expected =
            format!("Nearest travel limit at the rack positions that can be reached: {distance}");
        assert!(both.contains(&expected), "{both} {expected}");
    }
}
