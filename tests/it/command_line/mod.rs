//! Tests of the program as a user runs it: sample studies, results, exit codes and messages.

mod builds;
mod mistakes;
mod poses;

use crate::support::{larger, one_line, studies};
use assert_cmd::Command;
use std::fs;
use std::path::PathBuf;

fn hardpoint(arguments: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("hardpoint")
        .unwrap()
        .args(arguments)
        .assert()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Runs a command on a sample study, with results in a new directory.
fn run(command: &str, study: &str, more: &[&str]) -> (tempfile::TempDir, String) {
    let directory = tempfile::tempdir().unwrap();
    let study = studies().join(study);
    let out = directory.path().join("run");
    let mut arguments = vec![
        command,
        study.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ];
    arguments.extend(more);
    let assert = hardpoint(&arguments).success();
    let said = text(&assert.get_output().stdout);
    (directory, said)
}

fn json(directory: &tempfile::TempDir, name: &str) -> serde_json::Value {
    let path = directory.path().join("run").join(name);
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

fn csv(directory: &tempfile::TempDir, name: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let path = directory.path().join("run").join(name);
    let mut reader = csv::Reader::from_path(path).unwrap();
    let header = reader
        .headers()
        .unwrap()
        .iter()
        .map(str::to_owned)
        .collect();
    let rows = reader
        .records()
        .map(|r| r.unwrap().iter().map(str::to_owned).collect());
    (header, rows.collect())
}

fn column(table: &(Vec<String>, Vec<Vec<String>>), name: &str) -> Vec<f64> {
    let index = table.0.iter().position(|n| n == name).unwrap();
    table
        .1
        .iter()
        .map(|row| row[index].parse().unwrap())
        .collect()
}

#[test]
fn the_template_runs_as_it_is() {
    let template = hardpoint(&["new", "macpherson"]).success();
    let directory = tempfile::tempdir().unwrap();
    let study = directory.path().join("mine.toml");
    fs::write(&study, &template.get_output().stdout).unwrap();
    let study = study.to_str().unwrap();
    // The template names no file that its user does not have.
    let written = text(&template.get_output().stdout);
    assert!(!written.contains("_solve.toml") && written.contains("hardpoint check STUDY.toml"));
    hardpoint(&["check", study]).success();
    let assert = Command::cargo_bin("hardpoint")
        .unwrap()
        .args(["solve", study])
        .current_dir(directory.path())
        .assert()
        .success();
    assert!(text(&assert.get_output().stdout).contains("41 of 41 stations"));
    assert!(directory.path().join("out/mine/curves.csv").is_file());
}

#[test]
fn solving_the_sample_gives_a_row_for_each_station() {
    let (directory, _) = run("solve", "macpherson_solve.toml", &[]);
    let curves = csv(&directory, "curves.csv");
    let travel = column(&curves, "travel_mm");
    assert_eq!(
        (travel.len(), travel[0], travel[20], travel[40]),
        (41, -80.0, 0.0, 80.0)
    );
    // The static camber is determined by the hardpoints alone: the spin axis runs from `spindle_inner` to `wheel_centre`.
    let (dx, dy, dz) = (0.2_f64, 100.0, 0.9);
    let camber = -(dz / (dx * dx + dy * dy + dz * dz).sqrt())
        .asin()
        .to_degrees();
    assert!((column(&curves, "camber_deg")[20] - camber).abs() < 1e-12);
    assert_eq!(
        json(&directory, "summary.json")["failed"]
            .as_array()
            .unwrap()
            .len(),
        0
    );
}

#[test]
fn the_front_sample_meets_its_camber_and_kingpin_curves() {
    let (directory, _) = run("optimise", "macpherson_front.toml", &[]);
    let summary = json(&directory, "summary.json");
    assert!(summary["misfit_before"].as_f64().unwrap() > 10.0);
    assert!(summary["misfit_after"].as_f64().unwrap() < 1.0);
    for target in summary["targets"].as_array().unwrap() {
        assert!(target["after"]["rms"].as_f64().unwrap() < 1.0, "{target}");
    }
    // The curves in the results meet every point of the camber target within two tolerances.
    let curves = csv(&directory, "curves.csv");
    let travel = column(&curves, "travel_mm");
    let camber = column(&curves, "camber_deg");
    for (at, wanted) in [(-80.0, 1.16), (0.0, -0.52), (80.0, -0.94)] {
        let station = travel.iter().position(|t| *t == at).unwrap();
        assert!(
            (camber[station] - wanted).abs() < 2.0 * 0.02,
            "at {at}: {}",
            camber[station]
        );
    }
    let variables = summary["variables"].as_array().unwrap();
    assert_eq!(variables.len(), 7);
    assert!(variables.iter().all(|v| v["at_bound"].is_null()));
    // A design with the smallest misfit is farther from the nominal design than a design whose misfit is `good_enough`.
    let least = ["--set", "optimise.good_enough=0.0"];
    let (other, _) = run("optimise", "macpherson_front.toml", &least);
    let moved = |summary: &serde_json::Value| {
        let variables = summary["variables"].as_array().unwrap().iter();
        let offsets = variables.map(|v| v["offset"].as_f64().unwrap().powi(2));
        offsets.sum::<f64>()
    };
    assert!(moved(&json(&other, "summary.json")) > moved(&summary));
}

/// A tuning reports two numbers for the accuracy: the condition number of the tuned design's equations and the certified
/// bounds.
#[test]
fn a_tuning_says_what_is_known_of_its_accuracy() {
    let certify = ["--set", "outputs.certify=true"];
    let (directory, said) = run("optimise", "macpherson_front.toml", &certify);
    let summary = json(&directory, "summary.json");
    let worst = summary["condition"]["worst"].as_f64().unwrap();
    assert!((1.0..1e4).contains(&worst), "{worst}");
    let certificate = &summary["certificate"];
    assert_eq!(certificate["proved"], 41);
    assert_eq!(certificate["one_branch"], true);
    assert!(said.contains("41 of 41 stations certified"), "{said}");
    // A run that computes only positions, by the closed form, also reports a condition number.
    let (directory, _) = run("solve", "macpherson_front.toml", &[]);
    let summary = json(&directory, "summary.json");
    assert!(summary["condition"]["worst"].as_f64().unwrap() >= 1.0);
    assert!(
        summary["condition"]["ill_conditioned"]
            .as_array()
            .unwrap()
            .is_empty()
    );
    assert!(summary["certificate"].is_null());
}

#[test]
fn the_bump_steer_sample_holds_its_toe() {
    let (directory, _) = run("optimise", "macpherson_bump_steer.toml", &[]);
    let spread = |name: &str| {
        let toe = column(&csv(&directory, name), "toe_deg");
        toe.iter().copied().fold(f64::MIN, larger) - toe.iter().copied().fold(f64::MAX, f64::min)
    };
    // The target is constant toe, with a tolerance of 0.01 deg. With three variable coordinates, the deviation is at most
    // three tolerances.
    assert!(spread("curves_before.csv") > 1.0);
    assert!(spread("curves.csv") < 0.03);
}

#[test]
fn the_tuned_study_runs_and_gives_the_tuned_curves() {
    let (directory, _) = run("optimise", "macpherson_front.toml", &[]);
    let run_directory = directory.path().join("run");
    let tuned = run_directory.join("optimised.toml");
    let again = directory.path().join("again");
    hardpoint(&[
        "solve",
        tuned.to_str().unwrap(),
        "--out",
        again.to_str().unwrap(),
    ])
    .success();
    let read = |path: PathBuf| fs::read_to_string(path).unwrap();
    assert_eq!(
        read(again.join("curves.csv")),
        read(run_directory.join("curves.csv"))
    );
    assert!(read(tuned).contains("# Offsets from the design."));
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let runs = ["1", "2", "3"].map(|threads| {
        let set = ["--threads", threads, "--set", "optimise.starts=6"];
        run("optimise", "macpherson_front.toml", &set).0
    });
    let mut names: Vec<_> = fs::read_dir(runs[0].path().join("run"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    names.sort();
    assert!(names.len() >= 5, "{names:?}");
    for name in names {
        let contents =
            |run: &tempfile::TempDir| fs::read(run.path().join("run").join(&name)).unwrap();
        assert_eq!(contents(&runs[0]), contents(&runs[1]), "{name:?}");
        assert_eq!(contents(&runs[0]), contents(&runs[2]), "{name:?}");
    }
}

#[test]
fn the_main_csv_goes_to_standard_output_alone() {
    let study = studies().join("macpherson_solve.toml");
    let assert = hardpoint(&["solve", study.to_str().unwrap(), "--out", "-"]).success();
    let out = assert.get_output();
    assert!(text(&out.stdout).starts_with("travel_mm,camber_deg"));
    assert_eq!(text(&out.stdout).lines().count(), 42);
    assert!(text(&out.stderr).contains("41 of 41 stations"));
}

#[test]
fn tables_come_as_csv_and_json_too() {
    let study = studies().join("macpherson_solve.toml");
    let study = study.to_str().unwrap();
    let assert = hardpoint(&["check", study, "--format", "json"]).success();
    let table: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    assert_eq!(table["design"][0]["output"], "camber_deg");
    let assert = hardpoint(&["check", study, "--format", "csv"]).success();
    let tables = text(&assert.get_output().stdout);
    assert!(tables.starts_with("table,output,at_design,unit\ndesign,camber_deg,-0.5"));
    assert!(tables.contains("\n\ntable,effect,state,cost,because_of,what\neffects,position,on,"));
}

/// `hardpoint new` writes its study to a file. It replaces an existing file only with `--force`.
#[test]
fn a_new_study_goes_into_a_file() {
    let directory = tempfile::tempdir().unwrap();
    let study = directory.path().join("racer.toml");
    let new = ["new", "double_wishbone", "--out", study.to_str().unwrap()];
    hardpoint(&new).code(0);
    let printed = hardpoint(&["new", "double_wishbone"]).code(0);
    assert_eq!(fs::read(&study).unwrap(), printed.get_output().stdout);
    let again = hardpoint(&new).code(2);
    assert!(text(&again.get_output().stderr).contains("already exists; --force"));
    hardpoint(&[&new[..], &["--force"]].concat()).code(0);
}

/// A new run that writes no page removes the page of an earlier run. Otherwise a user would take the old page for the new
/// one.
#[test]
fn a_run_without_a_page_removes_that_of_an_earlier_one() {
    let (directory, _) = run("solve", "five_link_solve.toml", &["--report"]);
    let page = directory.path().join("run/report.html");
    assert!(page.exists());
    let study = studies().join("five_link_solve.toml");
    let out = directory.path().join("run");
    hardpoint(&[
        "solve",
        study.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ])
    .success();
    assert!(!page.exists());
}

/// A count of one is followed by a singular noun.
#[test]
fn one_is_singular() {
    let one = "sweep={ method = \"sobol\", samples = 1, variables = [ { hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-1.0, 1.0] } ] }";
    let (_, said) = run("sweep", "macpherson_sweep.toml", &["--set", one]);
    assert!(said.contains("1 design, all solved"), "{said}");
    let study = studies().join("macpherson_sweep.toml");
    let checked = hardpoint(&["check", study.to_str().unwrap(), "--set", one]).success();
    let said = text(&checked.get_output().stdout);
    assert!(said.contains("sobol, 1 design of 1 variable."), "{said}");
}
