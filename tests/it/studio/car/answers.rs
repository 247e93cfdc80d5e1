//! Tests of answers: they equal the results of `hardpoint solve`, gradients equal slopes, and tunings keep locks.

use super::{as_it_is, moved, save, served, solve};
use crate::studio::answers::answered;
use crate::studio::tuning::tuned;
use crate::studio::{columns, solved};
use serde_json::{Value, json};

/// The test moves points of both axles, including wheel centres. Each number of the page then equals the number
/// from the saved files, bit for bit. The table of load cases has the same numbers.
#[test]
fn answers_are_those_of_solve() {
    for name in ["car", "formula_student_car"] {
        let served = served(name, as_it_is);
        let moves = [
            ("front_tie_rod_inner", 2, 1.37),
            ("front_wheel_centre", 0, 2.5),
            ("rear_wheel_centre", 0, -1.25),
            ("rear_wheel_centre", 2, 0.5),
        ];
        let of = moved(&served, &moves);
        let answer = solve(&served, &of);
        let csv = served.post("csv", &of);
        let points = served.post("points", &of);
        assert_eq!(save(&served, &of, false).status, 200, "{name}");
        let expected = solved(&served.study);
        assert_eq!(csv.body, expected, "{name}");
        let mut export = assert_cmd::Command::cargo_bin("hardpoint").unwrap();
        export
            .arg("export")
            .arg(&served.study)
            .args(["--to", "csv"]);
        let exported = export.assert().success().get_output().stdout.clone();
        assert_eq!(points.body, exported, "{name}");
        let expected = columns(&expected);
        let mut compared = 0;
        for (column, values) in answered(&answer) {
            let Some((_, printed)) = expected.iter().find(|(name, _)| *name == column) else {
                continue;
            };
            assert_eq!(&values, printed, "{name}: {column}");
            compared += 1;
        }
        assert!(compared >= 10, "{name}");
    }
}

/// Difference quotient of fourth order.
fn slope(at: impl Fn(f64) -> f64, h: f64) -> f64 {
    (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h)
}

/// The misfit has targets of load cases, and in one car a target of a single axle. The gradients of the misfit and of
/// each target equal slopes. The test includes the wheel centres, because the wheelbase couples them to the other axle.
#[test]
fn gradients_of_the_misfit_are_its_slopes() {
    for name in ["car", "formula_student_car"] {
        let served = served(name, as_it_is);
        let of = moved(&served, &[("front_tie_rod_inner", 2, 0.4)]);
        let misfit = |by: f64, point: &str, axis: usize| {
            let of = moved(
                &served,
                &[("front_tie_rod_inner", 2, 0.4), (point, axis, by)],
            );
            solve(&served, &of)["misfit"].clone()
        };
        let here = solve(&served, &of)["misfit"].clone();
        let overview = served.overview();
        let points = overview["points"].as_array().unwrap();
        let place = |name: &str| points.iter().position(|p| p["name"] == name).unwrap();
        for (point, axis) in [
            ("front_wheel_centre", 0),
            ("front_tie_rod_outer", 2),
            ("rear_wheel_centre", 0),
            ("rear_wheel_centre", 1),
        ] {
            let near = |said: &Value, at: &dyn Fn(f64) -> f64| {
                let said = said[place(point)][axis].as_f64().unwrap();
                let slope = slope(at, 0.05);
                let close = 1e-6 * slope.abs().max(1.0);
                assert!(
                    (slope - said).abs() < close,
                    "{name} {point} {axis}: {slope} {said}"
                );
            };
            near(&here["gradient"], &|by| {
                misfit(by, point, axis)["value"].as_f64().unwrap()
            });
            for k in 0..here["targets"].as_array().unwrap().len() {
                near(&here["targets"][k]["gradient"], &|by| {
                    misfit(by, point, axis)["targets"][k]["rms"]
                        .as_f64()
                        .unwrap()
                });
            }
        }
    }
}

/// The effect of a coordinate on the results of every case equals the slope of the results.
#[test]
fn influences_are_slopes_of_the_results() {
    let served = served("car", as_it_is);
    let names = ["wheel_load", "camber_to_road", "roll", "roll_centre_height"];
    let values = |by: f64| {
        let of = moved(&served, &[("rear_toe_link_inner", 2, by)]);
        let message = json!({"of": of, "characteristics": names, "at": [0.0], "curves_rack": null, "over": 0});
        answered(&served.post("solve", &message).json())
    };
    let overview = served.overview();
    let points = overview["points"].as_array().unwrap();
    let point = points
        .iter()
        .position(|p| p["name"] == "rear_toe_link_inner")
        .unwrap();
    let of = moved(&served, &[]);
    let message = json!({"of": of, "characteristics": names, "point": point, "axis": 2});
    let found = served.post("influence", &message).json();
    let h = 0.1;
    let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| values(k * h));
    let mut compared = 0;
    for (k, column) in found["columns"].as_array().unwrap().iter().enumerate() {
        assert_eq!(column["column"], a[k].0.as_str());
        for (case, said) in column["slopes"].as_array().unwrap().iter().enumerate() {
            let [a, b, c, d] = [&a, &b, &c, &d].map(|at| at[k].1[case].unwrap());
            let slope = (8.0 * (c - b) - (d - a)) / (12.0 * h);
            let said = said.as_f64().unwrap();
            let near = 1e-6 * slope.abs().max(1.0);
            assert!((slope - said).abs() < near, "{column} {case}: {slope}");
            compared += 1;
        }
    }
    assert_eq!(compared, 5 * (4 + 4 + 1 + 2));
}

/// The server immediately refuses points that form no suspension. It gives the same reason as for a file.
#[test]
fn implausible_points_are_refused() {
    let served = served("car", as_it_is);
    let of = moved(&served, &[("rear_lower_front_link_inner", 2, 225_000.0)]);
    let message =
        json!({"of": of, "characteristics": ["roll"], "at": [0.0], "curves_rack": null, "over": 0});
    let refused = served.post("solve", &message);
    assert_eq!(refused.status, 422);
    let why = refused.text();
    assert!(
        why.contains("rear axle") && why.contains("impossible for a suspension"),
        "{why}"
    );
}

/// A tuning starts from the moved design, but its ranges are relative to the design in the file. If the moved design is
/// outside a range, the proposal reports this. A locked coordinate keeps its value.
#[test]
fn tunings_keep_locks_and_tell_wide_ranges() {
    let served = served("car", as_it_is);
    let of = moved(&served, &[("front_tie_rod_inner", 2, 17.0)]);
    let tune = |locked: &[[bool; 3]]| {
        let state = tuned(&served, &of, locked);
        assert!(state["error"].is_null(), "{state}");
        state["proposal"].clone()
    };
    let said = |proposal: &Value| proposal["remarks"].to_string();
    let overview = served.overview();
    let points = overview["points"].as_array().unwrap();
    let place = |name: &str| points.iter().position(|p| p["name"] == name).unwrap();
    let [front, rear] = ["front_tie_rod_inner", "rear_toe_link_inner"].map(place);
    let free = vec![[false; 3]; points.len()];
    let proposal = tune(&free);
    assert!(
        said(&proposal).contains("2 outside of its range"),
        "{proposal}"
    );
    assert_ne!(proposal["design"][front][2], of["design"][front][2]);

    let mut locked = free;
    locked[front][2] = true;
    let proposal = tune(&locked);
    assert!(
        !said(&proposal).contains("outside of its range"),
        "{proposal}"
    );
    assert_eq!(proposal["design"][front], of["design"][front]);
    assert_ne!(proposal["design"][rear], of["design"][rear]);
    assert!(!proposal["edits"].as_array().unwrap().is_empty());
}
