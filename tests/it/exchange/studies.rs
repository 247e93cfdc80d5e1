//! Tests of `hardpoint export --to toml`, of exported runs with `--set`, and of standard input and output of `import` and `new`.

use crate::support::studies;
use assert_cmd::Command;
use hardpoint::study::Study;
use std::fs;
use std::path::Path;

/// Runs the program in a directory with a text as standard input. Returns the exit code, the output and the messages.
fn run(arguments: &[&str], directory: &Path, input: &str) -> (i32, String, String) {
    let mut command = Command::cargo_bin("hardpoint").unwrap();
    let command = command.args(arguments).current_dir(directory);
    let output = command.write_stdin(input).output().unwrap();
    let [out, said] = [&output.stdout, &output.stderr].map(|b| String::from_utf8_lossy(b).into());
    (output.status.code().unwrap(), out, said)
}

/// The study of a rounded design has the points of the rounded table, and the targets, constraints and comments of the
/// original study.
#[test]
fn a_rounded_design_can_be_written_as_a_study() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let source = studies().join("double_wishbone_front.toml");
    let path = source.to_str().unwrap();
    let base = ["export", path, "--round", "0.5", "--round-all", "--to"];
    let (code, _, said) = run(
        &[&base[..], &["toml", "--out", "rounded.toml"]].concat(),
        here,
        "",
    );
    assert!(said.contains("misfit"), "{said}");
    let (of_table, table, _) = run(&[&base[..], &["csv"]].concat(), here, "");
    assert_eq!(code, of_table);
    let old = Study::read(&source, &[]).unwrap();
    let new = Study::read(&here.join("rounded.toml"), &[]).unwrap();
    let mut rows = table.lines().filter_map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        let numbers = cells.iter().filter_map(|cell| cell.parse::<f64>().ok());
        Some((cells.first()?.to_string(), numbers.collect::<Vec<f64>>()))
    });
    let wheel = new.wheel();
    for (point, at) in wheel.mechanism.points.iter().zip(&wheel.design) {
        let at = wheel.frame.vector(*at).to_array();
        assert!(
            at.iter().all(|x| (2.0 * x).fract() == 0.0),
            "{point:?} {at:?}"
        );
        let row = rows.find(|(name, _)| *name == point.name);
        assert_eq!(row.unwrap().1[..3], at, "{point:?}");
    }
    assert_eq!(old.optimise, new.optimise);
    let comments = |study: &Study| -> Vec<String> {
        let lines = study.text.lines().filter_map(|line| line.split_once('#'));
        lines.map(|(_, comment)| comment.to_owned()).collect()
    };
    assert_eq!(comments(&old), comments(&new));
    // `export --to toml` refuses another unit and names the command `convert`.
    let (code, _, said) = run(&["export", path, "--to", "toml", "--unit", "in"], here, "");
    assert_eq!(code, 2);
    assert!(said.contains("convert"), "{said}");
}

/// A table on standard input is imported like the same table in a file.
#[test]
fn a_table_on_standard_input_is_imported() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let source = studies().join("double_wishbone_solve.toml");
    let (_, table, _) = run(
        &["export", source.to_str().unwrap(), "--to", "csv"],
        here,
        "",
    );
    fs::write(here.join("points.csv"), &table).unwrap();
    let study = |file: &str| {
        let arguments = ["import", file, "--topology", "double_wishbone"];
        let (code, study, said) = run(&arguments, here, &table);
        assert_eq!(code, 0, "{said}");
        study
    };
    let [of_input, of_file] = [study("-"), study("points.csv")];
    assert!(of_input.starts_with("# Double wishbone"), "{of_input}");
    assert!(of_input.contains("from standard input"), "{of_input}");
    let without_title = |text: &str| text.split_once('\n').unwrap().1.to_owned();
    assert_eq!(without_title(&of_input), without_title(&of_file));
}

/// The three studies of a car need a directory. The path `-` is not one.
#[test]
fn a_car_is_not_written_to_standard_output() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let call = ["new", "formula_student_car", "--out", "-"];
    let (code, out, said) = run(&call, here, "");
    assert_eq!((code, &*out), (2, ""), "{said}");
    assert!(said.contains("directory"), "{said}");
    assert_eq!(fs::read_dir(here).unwrap().count(), 0);
}

/// Exported curves of a run include every change of `--set`, also changes that move no hardpoint.
#[test]
fn exported_curves_of_a_run_include_every_override() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let source = studies().join("double_wishbone_solve.toml");
    let study = source.to_str().unwrap();
    let few = "motion.travel=[-5.0, 5.0]";
    let solve = ["-q", "solve", study, "--set", few, "--out", "run"];
    assert_eq!(run(&solve, here, "").0, 0);
    let curves = |source: &str, more: &[&str]| {
        let export = ["export", source, "--to", "csv", "--curves"];
        let (code, out, said) = run(&[&export[..], more].concat(), here, "");
        assert_eq!(code, 0, "{said}");
        out
    };
    let own = curves("run", &[]);
    assert_eq!(own, curves("run", &["--set", few]));
    for change in ["wheel.radius=250.0", "motion.travel=[0.0, 10.0]"] {
        let of_run = curves("run", &["--set", change]);
        assert_ne!(of_run, own, "{change}");
        let of_study = curves(study, &["--set", few, "--set", change]);
        assert_eq!(of_run, of_study, "{change}");
    }
}
