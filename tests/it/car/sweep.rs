//! Tests of sweeps of a car: rows equal the results of the load cases, however the program computes them.

use super::commands::{hardpoint, text};
use crate::support::rows_by_column;
use hardpoint::study::CarStudy;
use hardpoint::sweep::{CarSweepPlan, SweepStatistics};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Road car with a sweep over parts of every kind.
fn car(directory: &Path, samples: u64) {
    hardpoint(directory, &["new", "car"]).success();
    let path = directory.join("car.toml");
    let good = fs::read_to_string(&path).unwrap();
    let (head, _) = good.split_once("[gg_map]").unwrap();
    let (_, optimise) = good.split_once("[optimise]").unwrap();
    let sweep = format!(
        r#"[outputs]
characteristics = ["roll", "wheel_load", "lateral_load_transfer_distribution", "anti_dive_by_force"]

[sweep]
method = "sobol"
samples = {samples}
seed = 3
variables = [
  {{ axle = "front", rate = "anti_roll_bar", percent = 30.0 }},
  {{ axle = "rear", hardpoint = "toe_link_inner", axis = "z", range = [-8.0, 8.0] }},
  {{ axle = "rear", rate = "spring", percent = 10.0 }},
  {{ axle = "front", rate = "tyre", percent = 10.0 }},
  {{ car = "mass", range = [1400.0, 1500.0] }},
  {{ car = "cg_z", range = [540.0, 580.0], name = "height" }},
  {{ car = "wheelbase", percent = 1.0 }},
]

[optimise]"#
    );
    fs::write(&path, format!("{head}{sweep}{optimise}")).unwrap();
}

/// A row has the numbers that `hardpoint solve` finds for the design printed by `--design`, bit for bit. The misfits
/// can be computed from the columns.
#[test]
fn rows_are_those_of_solve() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    car(directory, 3);
    hardpoint(directory, &["sweep", "car.toml", "--out", "swept"]).success();
    let designs = fs::read_to_string(directory.join("swept/designs.csv")).unwrap();
    let rows = rows_by_column(designs.as_bytes());
    assert_eq!(rows.len(), 3);
    for (number, row) in rows.iter().enumerate() {
        assert_eq!(row["status"], "ok", "{row:?}");
        let said = hardpoint(
            directory,
            &["sweep", "car.toml", "--design", &number.to_string()],
        );
        let said = text(&said.success().get_output().stdout);
        let mut arguments = vec!["solve".to_owned(), "car.toml".to_owned()];
        arguments.extend(["--out".to_owned(), "-".to_owned()]);
        for line in said.lines() {
            let setting = line
                .strip_prefix("--set '")
                .unwrap()
                .strip_suffix('\'')
                .unwrap();
            arguments.extend(["--set".to_owned(), setting.to_owned()]);
        }
        assert_eq!(arguments.len(), 4 + 2 * 7, "{said}");
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let solved = hardpoint(directory, &arguments).success();
        let cases = rows_by_column(&solved.get_output().stdout);
        let mut compared = 0;
        for case in &cases {
            for (column, value) in case {
                let name = format!("{}_{column}", case["case"]);
                let Some(swept) = row.get(&name) else {
                    // If a result is not defined in a case, it has an empty cell or no column.
                    assert!(value.is_empty() || !column.contains("dive"), "{name}");
                    continue;
                };
                assert_eq!(swept, value, "{name}");
                compared += 1;
            }
        }
        // Number of compared values: roll and four wheel loads of each case, the load transfer distribution in turns, and the
        // anti-dive under braking.
        assert_eq!(compared, 5 * 5 + 3 + 2);
        let number = |column: &str| row[column].parse::<f64>().unwrap();
        let share = (number("turn_lateral_load_transfer_distribution_percent") - 48.0) / 0.5;
        assert!(
            (number("rms_turn_lateral_load_transfer_distribution") - share.abs()).abs() < 1e-12
        );
        let squares = [
            "lateral_load_transfer_distribution",
            "roll_gradient",
            "roll_steer_gradient_rear",
        ]
        .map(|target| number(&format!("rms_turn_{target}")).powi(2));
        let misfit = (squares.iter().sum::<f64>() / 3.0).sqrt();
        assert!((number("misfit") - misfit).abs() < 1e-12 * misfit);
    }
    // The summary ranks designs by misfit.
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(directory.join("swept/summary.json")).unwrap()).unwrap();
    let best = rows
        .iter()
        .min_by(|a, b| {
            let misfit = |row: &BTreeMap<String, String>| row["misfit"].parse::<f64>().unwrap();
            misfit(a).total_cmp(&misfit(b))
        })
        .unwrap();
    assert_eq!(summary["best"][0]["design"].to_string(), best["design"]);
    // The run keeps a copy of its studies.
    hardpoint(&directory.join("swept"), &["check", "study.toml"]).success();
}

/// The bytes of a sweep do not depend on the number of CPU threads, or on the use of standard output. They are also the same
/// if the sweep was extended later.
#[test]
fn bytes_do_not_depend_on_the_run() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    car(directory, 3);
    let read = |path: &str| fs::read(directory.join(path)).unwrap();
    let sweep = |out: &str, more: &[&str]| {
        let arguments = [&["sweep", "car.toml", "--out", out][..], more].concat();
        hardpoint(directory, &arguments).success()
    };
    sweep("one", &["--threads", "1"]);
    let path = directory.join("car.toml");
    let longer = fs::read_to_string(&path)
        .unwrap()
        .replace("samples = 3", "samples = 5");
    fs::write(&path, longer).unwrap();
    sweep("one", &["--resume"]);
    sweep("two", &["--threads", "2"]);
    assert_eq!(read("one/designs.csv"), read("two/designs.csv"));
    let said = sweep("-", &[]);
    assert_eq!(said.get_output().stdout, read("two/designs.csv"));
    // Two shards (parts of a sweep that run separately) complete a sweep with the same bytes.
    sweep("three", &["--shard", "1/2"]);
    sweep("three", &["--shard", "2/2"]);
    assert_eq!(read("three/designs.csv"), read("two/designs.csv"));
    // A merge keeps the studies. The merged studies give the same results.
    hardpoint(directory, &["merge", "--out", "joined", "two"]).success();
    for name in [
        "designs.csv",
        "summary.json",
        "study.toml",
        "front.toml",
        "rear.toml",
    ] {
        assert_eq!(
            read(&format!("joined/{name}")),
            read(&format!("two/{name}")),
            "{name}"
        );
    }
    hardpoint(&directory.join("joined"), &["check", "study.toml"]).success();
    // The program can make the page of a sweep.
    hardpoint(directory, &["report", "two"]).success();
}

/// The program refuses a sweep without results, and a sweep of results that have no value in any case.
#[test]
fn a_sweep_of_nothing_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    car(directory, 2);
    let path = directory.join("car.toml");
    let study = fs::read_to_string(&path).unwrap();
    let (study, _) = study.split_once("[optimise]").unwrap();
    fs::write(&path, study).unwrap();
    let case = "cases=[{ name = \"turn\", ay = 0.5 }]";
    for outputs in ["[]", "[\"anti_dive_by_force\"]"] {
        let outputs = format!("outputs.characteristics={outputs}");
        let arguments = [
            "sweep", "car.toml", "--out", "swept", "--set", case, "--set",
        ];
        let refused = hardpoint(directory, &[&arguments[..], &[&outputs]].concat()).code(2);
        let error = text(&refused.get_output().stderr);
        for phrase in ["car.toml", "[sweep]", "nothing to write for each design"] {
            assert!(error.contains(phrase), "{error}");
        }
    }
}

/// If a case of a design has no equilibrium, the row names the case and the reason. The other cases have their values.
#[test]
fn failed_cases_are_named() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    car(directory, 2);
    let path = directory.join("car.toml");
    let tipping = fs::read_to_string(&path)
        .unwrap()
        .replace("ay = 0.8", "ay = 3.5");
    fs::write(&path, tipping).unwrap();
    hardpoint(directory, &["sweep", "car.toml", "--out", "swept"]).code(1);
    let designs = fs::read_to_string(directory.join("swept/designs.csv")).unwrap();
    let rows = rows_by_column(designs.as_bytes());
    assert_eq!(rows.len(), 2);
    for row in rows {
        assert_eq!(row["failed_stations"], "1");
        // `turn` is the case after `static`.
        assert_eq!(row["failed_at_case"], "1.0");
        assert!(row["reason"].starts_with("case turn: "), "{row:?}");
        assert!(row["turn_roll_deg"].is_empty() && row["misfit"].is_empty());
        assert!(!row["braking_roll_deg"].is_empty());
    }
}

/// All designs are refused for the same reason, with different values. The program counts them together.
#[test]
fn refused_cars_are_counted_by_their_reason() {
    let directory = tempfile::tempdir().unwrap();
    car(directory.path(), 16);
    let mut study = CarStudy::read(&directory.path().join("car.toml"), &[]).unwrap();
    let mut sweep = study.sweep.take().unwrap();
    // The variable for the mass.
    sweep.sampled.variables[4].range = [-1500.0, -1400.0];
    let plan = CarSweepPlan::of(&study, &sweep).unwrap();
    let statistics = SweepStatistics::of(&plan.record, plan.worker().rows(0));
    let [failure] = &statistics.failures[..] else {
        panic!("{:?}", statistics.failures);
    };
    assert_eq!(
        (failure.designs, failure.status.as_str()),
        (16, "degenerate")
    );
    assert_eq!(failure.reason, "car.mass is not an accepted mass");
}

/// A sweep ranks designs by the misfit that a tuning minimises, also if some targets apply to a single axle.
#[test]
fn the_misfit_has_the_targets_of_single_axles() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    car(directory, 3);
    let path = directory.join("car.toml");
    let text_of = fs::read_to_string(&path).unwrap();
    let (head, _) = text_of.split_once("[optimise]").unwrap();
    let optimise = r#"[optimise]
max_iterations = 1
variables = [{ axle = "rear", hardpoint = "toe_link_inner", axis = "z", range = [-20.0, 20.0] }]
targets = [
  { characteristic = "roll_gradient", case = "turn", value = 3.2, tolerance = 0.05 },
  { axle = "rear", characteristic = "toe", side = "left", over = "roll", points = [[-3.0, 0.1], [3.0, 0.1]], tolerance = 0.02, weight = 2.0 },
]
"#;
    fs::write(&path, format!("{head}{optimise}")).unwrap();
    hardpoint(directory, &["sweep", "car.toml", "--out", "swept"]).success();
    let designs = fs::read_to_string(directory.join("swept/designs.csv")).unwrap();
    let mut deviations = Vec::new();
    for (number, row) in rows_by_column(designs.as_bytes()).iter().enumerate() {
        let arguments = ["sweep", "car.toml", "--design", &number.to_string()];
        let said = text(
            &hardpoint(directory, &arguments)
                .success()
                .get_output()
                .stdout,
        );
        let mut arguments = vec!["optimise", "car.toml", "--out", "tuned", "--force"];
        for line in said.lines() {
            let setting = line
                .strip_prefix("--set '")
                .and_then(|l| l.strip_suffix('\''));
            arguments.extend(["--set", setting.unwrap()]);
        }
        // One iteration does not converge.
        hardpoint(directory, &arguments);
        let summary = fs::read(directory.join("tuned/summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_slice(&summary).unwrap();
        let value = |column: &str| row[column].parse::<f64>().unwrap();
        let tuned = summary["misfit_before"].as_f64().unwrap();
        let swept = value("misfit");
        assert!((swept - tuned).abs() < 1e-9 * tuned, "{swept} {tuned}");
        let toe = value("rms_rear_left_toe");
        let mean = (value("rms_turn_roll_gradient").powi(2) + 2.0 * toe.powi(2)) / 3.0;
        assert!((swept - mean.sqrt()).abs() < 1e-9 * swept);
        deviations.push(toe);
    }
    // The toe link moves the toe.
    assert!(
        (deviations[0] - deviations[1]).abs() > 0.1,
        "{deviations:?}"
    );
    assert!(directory.join("swept/pareto.csv").exists());
}
