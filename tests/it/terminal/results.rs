//! Tests of the results that a command prints: values of targets, bounds that hold them, named motions, and the order of tables.

use super::{Called, study};
use crate::support::{larger, one_line};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Smallest and largest value of a column of a CSV file.
fn range(csv: &str, column: &str) -> [f64; 2] {
    let mut lines = csv.lines();
    let place = lines
        .next()
        .unwrap()
        .split(',')
        .position(|own| own == column);
    let values = lines.filter_map(|line| line.split(',').nth(place?)?.parse::<f64>().ok());
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), larger(high, value)]
    })
}

/// The table of targets shows the range of the values before and after a tuning. The targets apply at all stations of the motion, so
/// these are the ranges of the curves.
#[test]
fn targets_have_their_values_before_and_after() {
    let called = Called::on("optimise", "macpherson_front", &[]);
    let said = called.said();
    let summary: Value = serde_json::from_str(&called.file("summary.json")).unwrap();
    for target in ["camber_deg", "kingpin_inclination_deg"] {
        let all = summary["targets"].as_array().unwrap();
        let own = all.iter().find(|own| own["output"] == target).unwrap();
        for (key, file) in [
            ("values_before", "curves_before.csv"),
            ("values_after", "curves.csv"),
        ] {
            let [low, high] = range(&called.file(file), target);
            let found = [0, 1].map(|end| number(&own[key][end]));
            assert!((found[0] - low).abs() < 1e-9 && (found[1] - high).abs() < 1e-9);
            let shown = format!("{low:.2} .. {high:.2}");
            assert!(said.contains(&shown), "{said} {shown}");
        }
    }
}

/// Tuning of the camber with one variable. `range` is the range of this variable.
fn tuned(range: [f64; 2]) -> (String, Value) {
    let variable = format!(
        "optimise.variables=[{{ hardpoint = \"strut_top\", axis = \"y\", range = {range:?} }}]"
    );
    let target = "optimise.targets=[{ characteristic = \"camber\", at = 60.0, value = -3.0, tolerance = 0.1 }]";
    let smallest = "optimise.good_enough=0.0";
    let sets = ["--set", &variable, "--set", target, "--set", smallest];
    let called = Called::on("optimise", "macpherson_front", &sets);
    let summary = serde_json::from_str(&called.file("summary.json")).unwrap();
    (called.said(), summary)
}

/// A target out of reach names the bound that holds it. If the bound moves outwards, the deviation falls as predicted, in the unit
/// of the target, and so does the misfit.
#[test]
fn a_missed_target_names_the_bound_that_holds_it() {
    let (said, before) = tuned([-5.0, 5.0]);
    let held = &before["holding"][0];
    assert_eq!(held["variable"], "strut_top.y");
    assert_eq!(held["target"], "camber_deg");
    let is_upper = held["bound"] == "upper";
    let limit = if is_upper { "<= 5 mm" } else { ">= -5 mm" };
    assert!(
        one_line(&said).contains(&format!("strut_top.y {limit}")),
        "{said}"
    );
    assert!(
        said.contains("held by bound") && said.contains(" deg per mm"),
        "{said}"
    );

    let step = 0.01;
    let end = 5.0 + step;
    let (_, after) = tuned(if is_upper { [-5.0, end] } else { [-end, 5.0] });
    let rms = |of: &Value| 0.1 * number(&of["targets"][0]["after"]["rms"]);
    for (predicted, found) in [
        (&held["deviation_per_unit"], rms(&after) - rms(&before)),
        (
            &held["misfit_per_unit"],
            number(&after["misfit_after"]) - number(&before["misfit_after"]),
        ),
    ] {
        let (predicted, found) = (number(predicted), found / step);
        assert!(predicted < 0.0);
        assert!(
            (found / predicted - 1.0).abs() < 0.01,
            "{found} {predicted}"
        );
    }
}

/// `solve` prints the ranges over a named motion. They equal the ranges of the curves of this motion.
#[test]
fn named_motions_have_a_table() {
    let called = Called::on("solve", "macpherson_steering", &[]);
    let said = called.said();
    let (_, table) = said.split_once("motion left_lock: 9 stations").unwrap();
    let [low, high] = range(&called.file("curves_left_lock.csv"), "camber_deg");
    let row = table.lines().find(|line| line.contains("camber_deg"));
    let cells: Vec<f64> = row
        .unwrap()
        .split_whitespace()
        .skip(1)
        .map(|c| c.parse().unwrap())
        .collect();
    let [.., shown_low, shown_high] = cells[..] else {
        panic!("{said}");
    };
    assert!(
        (shown_low - low).abs() < 1e-4 && (shown_high - high).abs() < 1e-4,
        "{said}"
    );

    let path = study("macpherson_steering");
    let arguments = [
        "solve",
        path.to_str().unwrap(),
        "--out",
        "run",
        "--format",
        "json",
    ];
    let tables: Value = serde_json::from_str(&Called::with(&arguments, &[]).said()).unwrap();
    let rows = tables["motions"].as_array().unwrap();
    let camber = rows
        .iter()
        .find(|row| row["output"] == "camber_deg")
        .unwrap();
    assert_eq!(camber["motion"], "left_lock");
    assert_eq!(
        [number(&camber["min"]), number(&camber["max"])],
        [low, high]
    );
}

/// A sweep prints its result, then the largest effects, then the ranges.
#[test]
fn a_sweep_names_what_matters_before_the_ranges() {
    let called = Called::on("sweep", "macpherson_sweep", &["--set", "sweep.samples=64"]);
    let said = called.said();
    let places = ["64 designs", "What matters most", "Ranges of the outputs"].map(|words| {
        said.find(words)
            .unwrap_or_else(|| panic!("{words}: {said}"))
    });
    assert!(places.is_sorted(), "{said}");
    let effects = &said[places[1]..places[2]];
    assert!(effects.contains('%'), "{effects}");
    assert!(!said[places[2]..].contains('%'), "{said}");
}

/// The column with the position of the largest difference has the unit of the motion.
#[test]
fn the_place_of_a_difference_has_its_unit() {
    let paths = ["macpherson_solve", "macpherson_front"].map(study);
    let [one, other] = paths.each_ref().map(|path| path.to_str().unwrap());
    let said = Called::with(&["compare", one, other], &[("COLUMNS", "140")]).said();
    assert!(one_line(&said).contains("at travel_mm"), "{said}");
}

/// `limits` tells wheel travel from moves of hardpoints.
#[test]
fn limits_name_the_kind_of_each_distance() {
    let said = one_line(&Called::on("limits", "macpherson_solve", &[]).said());
    let travel = said.find("mm of wheel travel away").unwrap();
    let points = said.find("the hardpoints can move by about").unwrap();
    assert!(travel < points, "{said}");
}

/// The check of the linear result needs four builds.
#[test]
fn too_few_builds_are_named() {
    for (builds, is_named) in [("3", true), ("40", false)] {
        let set = format!("tolerance.builds={builds}");
        let path = study("double_wishbone_tolerance");
        let arguments = [
            "tolerance",
            path.to_str().unwrap(),
            "--out",
            "run",
            "--set",
            &set,
        ];
        let said = one_line(&Called::with(&arguments, &[]).said());
        assert_eq!(said.contains("too few builds"), is_named, "{said}");
    }
}
