//! Tests of the program as a user runs it: sample studies, results, exit codes and messages.

use crate::support::{larger, one_line};
use assert_cmd::Command;
use std::fs;
use std::path::{Path, PathBuf};

fn studies() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("studies")
}

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
    let (directory, said) = run("optimise", "macpherson_front.toml", &[]);
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
    assert!(
        !said.contains("at upper bound") && !said.contains("at lower bound"),
        "{said}"
    );
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

/// If the mechanism cannot reach a travel, the program writes the other stations and gives the reason. Cells without a
/// result are empty.
#[test]
fn what_cannot_be_reached_is_reported_and_left_empty() {
    let directory = tempfile::tempdir().unwrap();
    let out = directory.path().join("run");
    let study = studies().join("macpherson_solve.toml");
    let assert = hardpoint(&[
        "solve",
        study.to_str().unwrap(),
        "--set",
        "motion.travel={from=-400.0,to=400.0,steps=9}",
        "--out",
        out.to_str().unwrap(),
    ])
    .code(1);
    let said = text(&assert.get_output().stdout);
    assert!(said.contains("7 of 9 stations"), "{said}");
    assert!(said.contains("the wheel travel ends"), "{said}");
    let (header, rows) = csv(&directory, "curves.csv");
    assert_eq!(header.last().unwrap(), "status");
    for row in [&rows[0], &rows[8]] {
        assert_eq!(row.last().unwrap(), "unreachable");
        assert!(
            row[1..row.len() - 1].iter().all(String::is_empty),
            "{row:?}"
        );
    }
    assert_eq!(rows[4].last().unwrap(), "ok");
}

/// The program solves a travel just inside the limits and refuses a travel just outside. (`tests/it/hard_cases.rs`
/// compares the limits with the reference.)
#[test]
fn limits_are_sharp_and_have_a_cause() {
    let study = studies().join("macpherson_solve.toml");
    let arguments = ["limits", study.to_str().unwrap(), "--format", "json"];
    let assert = hardpoint(&arguments).success();
    let table: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    let travel = &table["limits"][0];
    assert_eq!(travel["quantity"], "travel_mm");
    let (from, to) = (
        travel["from"].as_f64().unwrap(),
        travel["to"].as_f64().unwrap(),
    );
    assert!(
        (-500.0..-200.0).contains(&from) && (200.0..500.0).contains(&to),
        "{from} {to}"
    );
    let lowest = "the wheel centre is at its lowest point, no part is at a singularity";
    assert!(travel["because"].as_str().unwrap().starts_with(lowest));
    // The message names the part that is nearest to its singularity, by the part's name in this topology.
    let wishbones = studies().join("double_wishbone_solve.toml");
    let assert = hardpoint(&["limits", wishbones.to_str().unwrap(), "--format", "json"]).success();
    let other: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    let nearest = "; nearest to its singularity: the upper arm, ";
    assert!(
        other["limits"][0]["because"]
            .as_str()
            .unwrap()
            .contains(nearest)
    );
    // The program refuses travels just outside the limits and accepts travels just inside them.
    for (travel, code) in [
        (to - 1e-6, 0),
        (to + 1e-6, 1),
        (from + 1e-6, 0),
        (from - 1e-6, 1),
    ] {
        let set = format!("motion.travel=[{travel:?}]");
        let study = study.to_str().unwrap();
        hardpoint(&["solve", study, "--set", &set, "--out", "-"]).code(code);
    }
}

#[test]
fn assemblies_are_listed_and_the_connected_one_is_named() {
    let study = studies().join("macpherson_solve.toml");
    let arguments = [
        "assemblies",
        study.to_str().unwrap(),
        "--travel",
        "30",
        "--format",
        "json",
    ];
    let assert = hardpoint(&arguments).success();
    let table: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    let rows = table["assemblies"].as_array().unwrap();
    let connected: Vec<_> = rows.iter().filter(|r| r["connected"] == true).collect();
    assert_eq!(connected.len(), 1, "{rows:?}");
    assert!((connected[0]["wheel_centre_z_mm"].as_f64().unwrap() - 330.0).abs() < 1e-9);
    assert_eq!(connected[0]["strut"], "upright");
}

/// If the design cannot be assembled, the command states this in one sentence and exits with code 1.
#[test]
fn no_assembly_is_said_in_a_sentence() {
    let study = studies().join("macpherson_solve.toml");
    let call = ["assemblies", study.to_str().unwrap(), "--travel", "500"];
    let assert = hardpoint(&call).code(1);
    let said = "at travel 500 mm, rack 0 mm the parts of the design cannot be assembled\n";
    assert_eq!(text(&assert.get_output().stdout), said);
    let assert = hardpoint(&[&call[..], &["--format", "json"]].concat()).code(1);
    let table: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    assert_eq!(table["assemblies"], serde_json::json!([]));
    assert_eq!(text(&assert.get_output().stderr), said);
}

#[test]
fn assemblies_of_every_topology_are_listed_with_their_branch() {
    for (study, columns) in [
        ("macpherson_solve", "arm_angle_deg,strut,tie_rod,"),
        ("double_wishbone_solve", "arm_angle_deg,upper_arm,tie_rod,"),
        ("semi_trailing_arm_solve", "arm_angle_deg,arm,"),
        ("five_link_solve", "turn_deg,determinant,"),
    ] {
        let study = studies().join(format!("{study}.toml"));
        let arguments = ["assemblies", study.to_str().unwrap(), "--format", "csv"];
        let assert = hardpoint(&arguments).success();
        let table = text(&assert.get_output().stdout);
        let (header, rows) = table.split_once('\n').unwrap();
        let next = "wheel_centre_x_mm,wheel_centre_y_mm,wheel_centre_z_mm,camber_deg,toe_deg,";
        assert!(
            header.starts_with(&format!("table,{columns}{next}")),
            "{header}"
        );
        assert!(header.ends_with(",connected"), "{header}");
        let connected: Vec<&str> = rows.lines().filter(|row| row.ends_with(",true")).collect();
        assert_eq!(connected.len(), 1, "{table}");
        assert!(!connected[0].contains("across") && !connected[0].contains("reversed"));
        assert!(!table.contains("NaN"), "{table}");
    }
    let study = studies().join("five_link_solve.toml");
    for travel in ["nan", "inf", "-inf", "high"] {
        let travel = format!("--travel={travel}");
        let assert = hardpoint(&["assemblies", study.to_str().unwrap(), &travel]).code(2);
        assert!(text(&assert.get_output().stderr).contains("--travel"));
    }
}

/// For each mistake, the exit code is 2, and one message gives the location and the mistake. The program writes no files.
#[test]
fn mistakes_are_named_and_nothing_is_written() {
    let good = fs::read_to_string(studies().join("macpherson_front.toml")).unwrap();
    let changed = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        good.replacen(from, to, 1)
    };
    let cases = [
        (
            changed("[motion]\ntravel", "[motion]\ntravle"),
            vec!["travle", "travel"],
        ),
        (
            changed("strut_top        = [ -35.0, 575.0, 850.0]\n", ""),
            vec!["strut_top"],
        ),
        (changed("575.0", "\"high\""), vec!["number", "high"]),
        (changed("575.0", "nan"), vec!["nan"]),
        (
            changed("[ 120.0, 360.0, 195.0]", "[-260.0, 350.0, 205.0]"),
            vec!["lower_arm_front", "lower_arm_rear", "axis of the lower arm"],
        ),
        (
            changed("from = -80.0, to = 80.0", "from = 80.0, to = -80.0"),
            vec!["from", "80"],
        ),
        (
            changed("\"camber\", \"toe\"", "\"cambr\", \"toe\""),
            vec!["cambr", "camber"],
        ),
        (
            changed("\"macpherson\"", "\"mcpherson\""),
            vec!["mcpherson", "macpherson"],
        ),
        (String::new(), vec!["empty"]),
        ("[suspension".to_owned(), vec!["not valid TOML"]),
    ];
    for (number, (study, phrases)) in cases.into_iter().enumerate() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("bad.toml");
        fs::write(&path, study).unwrap();
        let assert = Command::cargo_bin("hardpoint")
            .unwrap()
            .args(["optimise", "bad.toml"])
            .current_dir(directory.path())
            .assert()
            .code(2);
        let said = text(&assert.get_output().stderr);
        assert!(said.contains("bad.toml"), "case {number}: {said}");
        for phrase in phrases {
            assert!(
                said.contains(phrase),
                "case {number} lacks {phrase:?}: {said}"
            );
        }
        assert_eq!(
            fs::read_dir(directory.path()).unwrap().count(),
            1,
            "case {number}"
        );
    }
}

#[test]
fn wrong_calls_are_named() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path().to_str().unwrap();
    for (arguments, phrase) in [
        (vec!["solve", "absent.toml"], "does not exist"),
        (vec!["solve", here], "directory"),
        (vec!["new", "unicycle"], "macpherson"),
        (vec!["sovle"], "solve"),
        (vec!["solve"], "STUDY"),
    ] {
        let assert = hardpoint(&arguments).code(2);
        let said = text(&assert.get_output().stderr);
        assert!(said.contains(phrase), "{arguments:?}: {said}");
    }
    let study = studies().join("macpherson_solve.toml");
    let assert = hardpoint(&["optimise", study.to_str().unwrap()]).code(2);
    assert!(text(&assert.get_output().stderr).contains("[optimise]"));
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

/// The user cannot define an axle by its right wheel. The message tells the user to mirror the points.
#[test]
fn an_axle_of_a_right_wheel_is_told_to_mirror_it() {
    let study = studies().join("macpherson_axle.toml");
    let right = [
        "check",
        study.to_str().unwrap(),
        "--set",
        "suspension.side=\"right\"",
        "--set",
        "suspension.frame=\"x_rear\"",
    ];
    let said = text(&hardpoint(&right).code(2).get_output().stderr);
    assert!(said.contains("--side left"), "{said}");
}

/// If the program cannot write to the output location, it reports this before it computes anything.
#[test]
fn a_place_that_cannot_be_written_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("taken");
    fs::write(&file, "a file, not a directory").unwrap();
    let out = file.join("run");
    let study = studies().join("macpherson_solve.toml");
    let assert = hardpoint(&[
        "solve",
        study.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ]);
    let assert = assert.code(2);
    let said = text(&assert.get_output().stderr);
    assert!(
        said.contains("cannot write") && said.contains("taken"),
        "{said}"
    );
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
}

/// If a target applies at a travel that the wheel cannot reach, the tuning ends and reports the limit of the wheel
/// travel.
#[test]
fn an_unreachable_target_travel_is_a_reason_not_a_crash() {
    let directory = tempfile::tempdir().unwrap();
    let study = fs::read_to_string(studies().join("macpherson_front.toml")).unwrap();
    let study = study
        .replace(
            "from = -80.0, to = 80.0, steps = 41",
            "from = -80.0, to = 400.0, steps = 25",
        )
        .replace("[80.0, -0.94]]", "[80.0, -0.94], [400.0, -2.0]]");
    let path = directory.path().join("far.toml");
    fs::write(&path, study).unwrap();
    let assert = Command::cargo_bin("hardpoint")
        .unwrap()
        .args(["optimise", "far.toml", "--set", "optimise.starts=3"])
        .current_dir(directory.path())
        .assert()
        .code(1);
    let said = text(&assert.get_output().stdout);
    assert!(said.contains("the wheel travel ends"), "{said}");
    let summary = directory.path().join("out/far/summary.json");
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(summary).unwrap()).unwrap();
    assert!(summary["misfit_after"].is_null());
}

/// Every station of an ordinary study is certified up to rounding errors, on one solution branch. `check` names the key that
/// requests certificates.
#[test]
fn a_certificate_covers_the_whole_curve() {
    let certify = ["--set", "outputs.certify=true"];
    let (directory, said) = run("solve", "macpherson_solve.toml", &certify);
    let proved = "certificate: 41 of 41 stations certified; the whole curve is on one branch";
    assert!(said.contains(proved), "{said}");
    let table = csv(&directory, "curves.csv");
    let errors = column(&table, "position_error_mm");
    let apart = column(&table, "uniqueness_mm");
    // The strut is about 700 mm long.
    assert!(errors.iter().all(|e| *e > 0.0 && *e < 1e-10), "{errors:?}");
    assert!(apart.iter().all(|u| *u > 1.0), "{apart:?}");
    let summary = json(&directory, "summary.json");
    let certificate = &summary["certificate"];
    assert_eq!(certificate["proved"], 41);
    assert_eq!(certificate["one_branch"], true);
    let worst = errors.iter().copied().fold(0.0, larger);
    assert_eq!(certificate["largest_position_error"], worst);

    let study = studies().join("macpherson_solve.toml");
    let assert = hardpoint(&["check", study.to_str().unwrap(), certify[0], certify[1]]).success();
    let said = text(&assert.get_output().stdout);
    let row = said
        .lines()
        .find(|line| line.contains("certificate"))
        .unwrap();
    assert!(
        row.contains(" on ") && row.contains("outputs.certify (line "),
        "{row}"
    );
    let (directory, said) = run("solve", "macpherson_solve.toml", &[]);
    assert!(!said.contains("certificate"), "{said}");
    assert!(json(&directory, "summary.json")["certificate"].is_null());
}

/// The travel has a limit (fold) at 349.66780703583492 mm. Two assemblies merge there. Very close to the limit, both
/// are equal in double precision. There, the program gives a pose only without `certify`. Just before the limit the
/// program marks derivatives as inaccurate.
#[test]
fn stations_at_a_fold_are_flagged_or_not_proved() {
    let study = studies().join("macpherson_solve.toml");
    let solved = |travels: &str, more: &[&str]| {
        let travel = format!("motion.travel={travels}");
        let upper = "suspension.hardpoints.strut_upper=[-17, 611, 490]";
        let mut arguments = vec![
            "solve",
            study.to_str().unwrap(),
            "--out",
            "-",
            "--set",
            &travel,
        ];
        for set in [upper].iter().chain(more) {
            arguments.extend(["--set", set]);
        }
        let output = hardpoint(&arguments).get_output().clone();
        let rows = text(&output.stdout);
        let status = |row: &str| row.rsplit(',').next().unwrap().to_owned();
        let status: Vec<_> = rows.lines().skip(1).map(status).collect();
        (output.status.code(), status, rows, text(&output.stderr))
    };
    let near = "[0, 349.667, 349.66780703583]";
    let (code, status, _, said) = solved(near, &["outputs.order=velocity"]);
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(status, ["ok", "ok", "ill_conditioned"], "{said}");
    assert!(
        said.contains("warning: 1 station has fewer than six correct digits"),
        "{said}"
    );
    assert!(said.contains("at travel 349.668 mm"), "{said}");

    let at_fold = "[0, 300, 349.667807035834]";
    let (code, status, rows, said) = solved(at_fold, &["outputs.certify=true"]);
    assert_eq!(code, Some(1), "{said}");
    assert_eq!(status, ["ok", "ok", "uncertified"], "{said}");
    assert!(rows.lines().last().unwrap().contains(",,,"), "{rows}");
    assert!(
        said.contains("travel 349.668 mm: the pose is not certified"),
        "{said}"
    );
    assert!(said.contains("2 of 3 stations certified"), "{said}");
}

/// The program reports loads that the mechanism cannot carry. It exits with code 1 (incomplete results).
#[test]
fn loads_without_support_are_reported() {
    let study = studies().join("semi_trailing_arm_solve.toml");
    let assert = hardpoint(&[
        "solve",
        study.to_str().unwrap(),
        "--out",
        "-",
        // This value puts `spring_upper` in line with the lower end of the spring and the hinge.
        "--set",
        "suspension.hardpoints.spring_upper=[205.0, 470.0, 262.5]",
        "--set",
        "motion.travel=[-40.0, 0.0, 40.0]",
        "--set",
        "outputs.loads=[{name=\"kerb\", at=\"wheel_centre\", force=[0, 0, 1000]}]",
    ])
    .code(1);
    let (csv, said) = (&assert.get_output().stdout, &assert.get_output().stderr);
    let csv = text(csv);
    assert!(
        csv.lines()
            .next()
            .unwrap()
            .ends_with(",kerb_spring_N,status")
    );
    assert!(csv.lines().nth(2).unwrap().ends_with(",,,,unsupported"));
    let warning = "warning: loads cannot be carried at 1 station, the first at travel 0 mm: the spring, or the support that replaces it, has almost no leverage";
    assert!(text(said).contains(warning), "{}", text(said));
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

/// If a user gives a key of the study as an option, the message shows how to set this key.
#[test]
fn a_key_as_an_option_is_told_how_to_set_it() {
    let path = studies().join("macpherson_front.toml");
    let path = path.to_str().unwrap();
    for (call, tip) in [
        (
            ["optimise", path, "--starts", "8"],
            "'--set optimise.starts=VALUE'",
        ),
        (
            ["tolerance", path, "--builds", "8"],
            "'--set tolerance.builds=VALUE'",
        ),
    ] {
        let refused = hardpoint(&call).code(2);
        let said = text(&refused.get_output().stderr);
        assert!(said.contains(tip) && !said.contains("-- --"), "{said}");
    }
}

/// The program warns of probable mistakes even if the suspension is valid.
#[test]
fn doubtful_studies_are_called_so() {
    for entry in fs::read_dir(studies()).unwrap() {
        let path = entry.unwrap().path();
        // In the paper, the wheel is defined by points that are not on its spin axis.
        let is_paper = path.ends_with("attia.toml");
        if path.extension().is_some_and(|e| e == "toml") && !is_paper {
            let assert = hardpoint(&["check", path.to_str().unwrap()]).success();
            let said = text(&assert.get_output().stdout);
            assert!(!said.contains("please check"), "{said}");
        }
    }
    let study = studies().join("double_wishbone_pushrod.toml");
    let good = fs::read_to_string(&study).unwrap();
    let swapped = |a: &str, b: &str| {
        let rename = |line: &str| match line.split_whitespace().next() {
            Some(name) if name == a => line.replacen(a, b, 1),
            Some(name) if name == b => line.replacen(b, a, 1),
            _ => line.to_owned(),
        };
        good.lines().map(rename).collect::<Vec<_>>().join("\n")
    };
    let rear_pivot = |place: &str| {
        let is_pivot = |line: &&str| line.starts_with("lower_arm_rear ");
        let line = good.lines().find(is_pivot).unwrap();
        good.replace(line, &format!("lower_arm_rear = {place}"))
    };
    let wheel_centre = |place: &str| {
        let is_centre = |line: &&str| line.starts_with("wheel_centre ");
        let line = good.lines().find(is_centre).unwrap();
        good.replace(line, &format!("wheel_centre = {place}"))
    };
    let cases = [
        (
            // The point is given in centimetres by mistake.
            wheel_centre("[0.0, 620.0, 25.5]"),
            "mm below every joint of its carrier",
        ),
        (
            wheel_centre("[0.0, 620.0, 510.0]"),
            "mm above every joint of its carrier",
        ),
        (
            wheel_centre("[-1560.0, 620.0, 255.0]"),
            "mm behind every joint of its carrier",
        ),
        (
            swapped("upper_ball_joint", "lower_ball_joint"),
            "upper_ball_joint is not above lower_ball_joint",
        ),
        (
            swapped("tie_rod_inner", "tie_rod_outer"),
            "tie_rod_inner is outboard of tie_rod_outer",
        ),
        (
            swapped("pushrod_inner", "pushrod_outer"),
            "pushrod_inner is outboard of pushrod_outer",
        ),
        (
            swapped("spring_lower", "spring_upper"),
            "lengthens in jounce",
        ),
        (
            good.replace("[motion]", "[vehicle]\nwheelbase = 1.55\n\n[motion]"),
            "wheelbase is 1.55 mm",
        ),
        (
            good.replace("[motion]", "[vehicle]\nwheelbase = 270.0\n\n[motion]"),
            "wheelbase is 270 mm at a wheel radius of",
        ),
        (
            good.replace("[motion]", "[vehicle]\ncg_height = 29.0\n\n[motion]"),
            "cg_height is 29 mm at a wheel radius of",
        ),
        (
            good.replace("[motion]", "[vehicle]\ntrack = 1000.0\n\n[motion]"),
            "track is 1000 mm",
        ),
        (
            rear_pivot("[-180.0, 220.0, -138.0]"),
            "lower_arm_rear is 138 mm below the ground",
        ),
        (
            rear_pivot("[-4572.0, 220.0, 138.0]"),
            "mm away from wheel_centre. Is one of them in another unit?",
        ),
    ];
    let directory = tempfile::tempdir().unwrap();
    for (case, (text_of_study, phrase)) in cases.into_iter().enumerate() {
        let path = directory.path().join("study.toml");
        fs::write(&path, &text_of_study).unwrap();
        let path = path.to_str().unwrap();
        let out = directory.path().join(format!("run-{case}"));
        let checked = hardpoint(&["check", path]).success();
        let solved = hardpoint(&["solve", path, "--out", out.to_str().unwrap()]);
        for said in [&checked.get_output().stdout, &solved.get_output().stdout] {
            let said = text(said);
            assert!(
                said.contains("please check: ") && said.contains(phrase),
                "{phrase}\n{said}"
            );
        }
    }
}

/// If the set-up cannot reach a target value, the program names the target and the effect of each adjustment.
#[test]
fn a_set_up_out_of_reach_names_the_wish() {
    let directory = tempfile::tempdir().unwrap();
    let out = directory.path().join("run");
    let study = studies().join("double_wishbone_tolerance.toml");
    let call = |want: &str| {
        let set = format!("setup.want={want}");
        let (study, out) = (study.to_str().unwrap(), out.to_str().unwrap());
        hardpoint(&["setup", study, "--set", &set, "--out", out, "--force"])
    };
    call("{ camber = -1.5 }").success();
    // The summary contains the target values as the user wrote them.
    let summary = fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["statics"][0]["column"], "camber_deg");
    assert_eq!(summary["statics"][0]["wanted"].to_string(), "-1.5");
    let assert = call("{ camber = -90.3, toe = -5.0 }").code(1);
    let output = assert.get_output();
    let (said, error) = (text(&output.stdout), text(&output.stderr));
    assert!(
        error.contains("cannot be reached: camber_deg ends at ")
            && error.contains(", not -90.3")
            && !error.contains("toe_deg"),
        "{error}"
    );
    assert!(
        said.contains("Effect of each adjustment") && said.contains("tie_rod"),
        "{said}"
    );
    let (header, rows) = csv(&directory, "effects.csv");
    assert_eq!((header[0].as_str(), rows.len()), ("adjustment", 5));
    // The failed run has removed the files of the earlier set-up run.
    for name in ["setup.csv", "summary.json", "curves.csv"] {
        assert!(!out.join(name).exists(), "{name}");
    }
    assert!(
        fs::read_to_string(out.join("run.json"))
            .unwrap()
            .contains("\"finished\": true")
    );
}

/// Tables of a set-up have at most 100 columns of text, with every name and heading complete. Instructions use workshop
/// terms.
#[test]
fn a_set_up_is_printed_for_a_mechanic() {
    let more = [
        "--set",
        "setup.want={camber=-1.5,toe=-0.1,bump_steer=-0.01}",
    ];
    let directory = tempfile::tempdir().unwrap();
    let (study, out) = (
        studies().join("double_wishbone_tolerance.toml"),
        directory.path().join("run"),
    );
    let call = [
        "setup",
        study.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ];
    let assert = hardpoint(&[&call[..], &more].concat()).code(1);
    let said = text(&assert.get_output().stdout);
    for line in said.lines().filter(|line| !line.contains("run:")) {
        assert!(line.chars().count() <= 100, "{line}");
    }
    let rows = |name: &str| {
        said.lines()
            .filter(|line| line.split("  ").any(|cell| cell.trim() == name))
            .count()
    };
    assert_eq!(rows("upper_ball_joint y"), 2, "{said}");
    // Five rows: three for the adjustments, one for their steps, and one for the target values.
    assert_eq!(rows("bump_steer_deg_per_mm"), 5, "{said}");
    assert_eq!(rows("ride_height_change_mm"), 5, "{said}");
    assert!(
        said.contains("turns")
            && said.contains("lengthen")
            && said.contains("move outboard by ") | said.contains("move inboard by "),
        "{said}"
    );
    assert!(
        said.contains("not met: bump_steer_deg_per_mm ends at "),
        "{said}"
    );
    let summary = json(&directory, "summary.json");
    assert_eq!(summary["met"], false);
    let mut with_target = 0;
    for value in summary["statics"].as_array().unwrap() {
        let wanted = value["wanted"].as_f64();
        assert_eq!(value["miss_rounded"].is_number(), wanted.is_some());
        if let Some(wanted) = wanted {
            with_target += 1;
            let off = |set: &str, miss: &str| {
                value[set].as_f64().unwrap() - wanted - value[miss].as_f64().unwrap()
            };
            assert!(
                off("set", "miss").abs() < 1e-12
                    && off("set_rounded", "miss_rounded").abs() < 1e-12
            );
        }
    }
    assert_eq!(with_target, 3);
    // The order of adjustments is: shims first, toe last.
    let order: Vec<_> = summary["adjustments"]
        .as_array()
        .unwrap()
        .iter()
        .map(|a| a["adjustment"].as_str().unwrap())
        .collect();
    assert_eq!(order, ["upper_ball_joint y", "pushrod", "tie_rod"]);
    let (header, rows) = csv(&directory, "setup.csv");
    assert!(
        header.contains(&"instruction".to_owned())
            && header.contains(&"ride_height_change_mm".to_owned())
    );
    assert_eq!(rows.len(), 6);
}

/// If no build can be assembled, the program reports nothing about builds. The program refuses limits that make a
/// length 0 or negative.
#[test]
fn no_builds_have_no_linear_answer() {
    let short = "tolerance.scatter=[{ length = \"tie_rod\", limits = [-300.0, -250.0] }]";
    let few = [
        "--set",
        "tolerance.builds=100",
        "--set",
        "tolerance.aligned=false",
        "--set",
    ];
    let (directory, said) = run(
        "tolerance",
        "macpherson_tolerance.toml",
        &[&few[..], &[short]].concat(),
    );
    assert!(said.contains("100 builds rejected"), "{said}");
    let (header, rows) = csv(&directory, "tolerance.csv");
    let place = header
        .iter()
        .position(|name| name == "linear_holds")
        .unwrap();
    assert!(!rows.is_empty() && rows.iter().all(|row| row[place].is_empty()));
    assert!(
        said.lines()
            .filter(|line| line.contains("_deg "))
            .all(|line| !line.contains("yes")),
        "{said}"
    );

    let none = "tolerance.scatter=[{ length = \"tie_rod\", limits = [-500.0, 0.5] }]";
    let study = studies().join("macpherson_tolerance.toml");
    let call = ["tolerance", study.to_str().unwrap(), "--set", none];
    let error = text(&hardpoint(&call).code(2).get_output().stderr);
    assert!(
        error.contains(
            "tolerance.scatter[0].limits: the lowest limit makes the length 0 or negative: tie_rod is 360"
        ),
        "{error}"
    );
}

/// If the nominal design is outside a band, `tolerance` and `check` report it with the value. A nominal design inside the band
/// is not reported.
#[test]
fn a_nominal_design_outside_a_band_is_reported() {
    let bands = |low: f64| {
        let band = format!("{{ characteristic = \"toe\", at = 0.0, between = [{low:?}, 1.0] }}");
        format!("tolerance.bands=[{band}]")
    };
    let [outside, inside] = [0.5, -0.5].map(bands);
    let few = ["--set", "tolerance.builds=300", "--set"];
    let study = studies().join("macpherson_tolerance.toml");
    let words = "the nominal design is outside the band toe_deg at 0: 0.5 to 1; nominal: toe_deg";
    for (set, is_outside) in [(&outside, true), (&inside, false)] {
        let (directory, said) = run(
            "tolerance",
            "macpherson_tolerance.toml",
            &[&few[..], &[set]].concat(),
        );
        let said = one_line(&said);
        assert_eq!(said.contains(words), is_outside, "{said}");
        assert_eq!(said.contains("at travel 0 mm"), is_outside, "{said}");
        let summary = json(&directory, "summary.json");
        assert_eq!(summary["nominal_outside"].is_array(), is_outside);
        let call = ["check", study.to_str().unwrap(), "--set", set];
        let said = text(&hardpoint(&call).success().get_output().stdout);
        let said = one_line(&said);
        assert_eq!(said.contains(words), is_outside, "{said}");
    }
}

/// The heading of the ranking is `largest share`. The key in JSON is `share`.
#[test]
fn the_share_of_a_ranking_is_the_largest() {
    let few = ["--set", "tolerance.builds=300"];
    let (_, said) = run("tolerance", "macpherson_tolerance.toml", &few);
    assert!(
        said.contains("contributor") && said.contains("largest share"),
        "{said}"
    );
    let (_, printed) = run(
        "tolerance",
        "macpherson_tolerance.toml",
        &[&few[..], &["--format", "json"]].concat(),
    );
    let tables: serde_json::Value = serde_json::from_str(&printed).unwrap();
    let first = &tables["ranking"][0];
    assert!(
        first["share"].is_f64() && first["largest_share"].is_null(),
        "{first}"
    );
    // The ranking names the output to which the share belongs, and the values have an explanation of their rows.
    let output = first["output"].as_str().unwrap();
    assert!(["caster_deg", "toe_deg"].contains(&output), "{first}");
    assert!(said.contains("of the variance of"), "{said}");
    assert!(said.contains("a row where its sigma is largest"), "{said}");
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
