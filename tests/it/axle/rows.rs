//! Tests of motions of an axle that are given as a table of rows: row n contains the n-th value of every coordinate.

use super::tuning::{evaluate, layout, study};
use super::with;
use crate::support::one_line;
use hardpoint::curves::Curves;
use hardpoint::optimise::Control;
use hardpoint::study::Study;
use hardpoint::tolerance::Problem;
use nalgebra::DVector;

/// Values of a column, or of a coordinate of the motion.
fn column(curves: &Curves, name: &str) -> Vec<f64> {
    let place = curves.columns.iter().position(|own| own.name == name);
    let place = place.unwrap_or_else(|| panic!("no {name}"));
    curves
        .stations
        .iter()
        .map(|s| s.values[place].unwrap())
        .collect()
}

/// Motions given as rows, and for each row the motion with only that row.
const ROWS: [(&str, &[&str]); 3] = [
    (
        "{ travel_left = [20.0, -20.0, 5.0], travel_right = [-20.0, 20.0, 5.0], rack = [8.0, -8.0, 0.0], combine = \"rows\" }",
        &[
            "{ travel_left = 20.0, travel_right = -20.0, rack = 8.0 }",
            "{ travel_left = -20.0, travel_right = 20.0, rack = -8.0 }",
            "{ travel_left = 5.0, travel_right = 5.0, rack = 0.0 }",
        ],
    ),
    (
        "{ roll = [1.0, -2.0, 1.0], heave = [-10.0, 0.0, 15.0], steering_wheel_angle = [90.0, -45.0, 90.0], combine = \"rows\" }",
        &[
            "{ roll = 1.0, heave = -10.0, steering_wheel_angle = 90.0 }",
            "{ roll = -2.0, heave = 0.0, steering_wheel_angle = -45.0 }",
            "{ roll = 1.0, heave = 15.0, steering_wheel_angle = 90.0 }",
        ],
    ),
    (
        "{ heave = 10.0, steering_wheel_angle = { from = -90.0, to = 90.0, steps = 3 }, combine = \"rows\" }",
        &[
            "{ heave = 10.0, steering_wheel_angle = -90.0 }",
            "{ heave = 10.0, steering_wheel_angle = 0.0 }",
            "{ heave = 10.0, steering_wheel_angle = 90.0 }",
        ],
    ),
];

/// Each row of a motion has the values of a motion with only the station of this row. The test covers `[motion]` and a
/// named motion.
#[test]
fn each_row_is_a_station() {
    let given = study("macpherson_axle", &[]);
    let mut compared = 0;
    for (rows, alone) in ROWS {
        let own = with(&given, &[&format!("motion={rows}")]).unwrap();
        let own = own.curves().unwrap();
        let named = with(&given, &[&format!("motions.path={rows}")]).unwrap();
        let named = named.in_motion("path").unwrap().curves().unwrap();
        assert_eq!(own, named, "{rows}");
        assert_eq!(own.stations.len(), alone.len());
        for (number, one) in alone.iter().enumerate() {
            let single = with(&given, &[&format!("motion={one}")]).unwrap();
            let single = single.curves().unwrap();
            // The solver starts a station from the previous one, so rounding differs.
            let places = own.stations[number].at.iter().zip(&single.stations[0].at);
            for (found, expected) in places {
                let apart = found.unwrap() - expected.unwrap();
                assert!(apart.abs() < 1e-9, "{one}: {found:?} {expected:?}");
            }
            for name in single.columns.iter().map(|column| &column.name) {
                let value = |curves: &Curves, station: usize| {
                    let place = curves.columns.iter().position(|own| own.name == *name);
                    curves.stations[station].value(place.unwrap())
                };
                match (value(&own, number), value(&single, 0)) {
                    (Some(found), Some(expected)) => {
                        assert!(
                            (found - expected).abs() <= 1e-9 * expected.abs().max(1.0),
                            "{one} {name}: {found} {expected}"
                        );
                        compared += 1;
                    }
                    (found, expected) => assert_eq!(found, expected, "{one} {name}"),
                }
            }
        }
    }
    // Nine rows, each with most of the 28 outputs of the study.
    assert!(compared > 9 * 20, "{compared}");
}

/// A target at a row of the motion has the same residuals and derivatives as in a motion with all combinations of
/// values.
#[test]
fn a_target_at_a_row_is_one_at_its_coordinates() {
    let given = study("macpherson_axle_front", &[]);
    let of = |motion: &str, target: &str| {
        let motion = format!("motion={motion}");
        let target = format!(
            "optimise.targets=[{{ characteristic = \"toe\", over = \"travel_left\", value = 0.3, tolerance = 0.1, {target} }}]"
        );
        let study = with(&given, &[&motion, &target]).unwrap();
        let x = DVector::from_element(study.optimise.as_ref().unwrap().variables.len(), 2.0);
        evaluate(&study, &layout(&study), &x)
    };
    let rows = of(ROWS[0].0, "at = 20.0");
    let all = of(
        "{ travel_left = [-20.0, 5.0, 20.0], travel_right = [-20.0, 5.0, 20.0], rack = [-8.0, 0.0, 8.0] }",
        "at = 20.0, travel_right = -20.0, rack = 8.0",
    );
    assert_eq!(rows.residuals.len(), 2);
    assert!(rows.residuals.amax() > 0.1);
    assert_eq!(rows.residuals, all.residuals);
    assert_eq!(rows.jacobian, all.jacobian);
}

/// A tuning meets a target in a named motion that is given as rows. A curve is compared only at these rows, even if it
/// has more points.
#[test]
fn a_tuning_meets_targets_at_rows() {
    let study = with(
        &study("macpherson_axle_front", &[]),
        &[
            "motion={ heave = [-10.0, 0.0, 10.0] }",
            "motions.path={ travel_left = [-30.0, 30.0], travel_right = [30.0, -30.0], rack = [-5.0, 5.0], combine = \"rows\" }",
            "outputs.characteristics=[\"mean_steer\"]",
            "optimise.starts=1",
            "optimise.good_enough=0.0",
            "optimise.targets=[{ characteristic = \"mean_steer\", motion = \"path\", points = [[-30.0, 2.4], [0.0, 0.0], [30.0, -2.4]], tolerance = 0.01 }]",
        ],
    )
    .unwrap();
    assert_eq!(layout(&study).residuals(), 2);
    let values = |study: &Study| {
        let curves = study.in_motion("path").unwrap().curves().unwrap();
        column(&curves, "mean_steer_deg")
    };
    assert!((values(&study)[1].abs() - 2.4).abs() > 0.05);
    let best = study.tune(Control::default()).unwrap().best.unwrap();
    let after = values(&study.moved(&best.offsets));
    assert!((after[0] - 2.4).abs() < 1e-6, "{after:?}");
    assert!((after[1] + 2.4).abs() < 1e-6, "{after:?}");
}

/// A band without `at` limits every row once, even where rows have equal values. With `at`, the band limits only the
/// rows with this value.
#[test]
fn a_band_limits_every_row() {
    let of = |rest: &str| {
        let tolerance = format!(
            "tolerance={{ builds = 2, scatter = [{{ hardpoint = \"tie_rod_outer\", sigma = 0.4 }}], bands = [{{ characteristic = \"mean_steer\", at_most = 1.0{rest} }}] }}"
        );
        let motion = format!("motion={}", ROWS[1].0);
        let study = with(&study("macpherson_axle", &[]), &[&motion, &tolerance]).unwrap();
        let problem = Problem::of(&study, study.tolerance.as_ref().unwrap()).unwrap();
        let nominal = problem.drawn().unwrap();
        let cells = problem.cells_of_bands().next().unwrap().into_iter();
        cells.map(|cell| nominal[cell]).collect::<Vec<f64>>()
    };
    let all = of("");
    assert_eq!(all.len(), 3);
    assert_eq!(of(", over = \"roll\", at = 1.0"), [all[0], all[2]]);
    assert_eq!(of(", over = \"heave\", at = 0.0"), [all[1]]);
}

#[test]
fn rows_that_do_not_fit_are_refused() {
    let given = study("macpherson_axle_front", &[]);
    let refused = |edits: &[&str], said: &str| {
        let error = with(&given, edits).unwrap_err();
        let error = one_line(&error);
        assert!(error.contains(said), "{error}");
    };
    refused(
        &[
            "motions.m={ travel_left = [1.0, 2.0, 3.0], travel_right = [1.0, 2.0], combine = \"rows\" }",
        ],
        "travel_right has 2 values, and another coordinate has 3",
    );
    refused(
        &["motions.m={ travel_left = [], combine = \"rows\" }"],
        "expected at least one value",
    );
    refused(&["motions.m={ heave = 1.0, combine = \"row\" }"], "rows");
    let rows =
        "motions.m={ travel_left = [1.0, 2.0], travel_right = [2.0, 1.0], combine = \"rows\" }";
    let target = |rest: &str| {
        format!(
            "optimise.targets=[{{ characteristic = \"toe\", motion = \"m\", tolerance = 0.1, {rest} }}]"
        )
    };
    refused(
        &[rows, &target("at = 1.5, value = 0.0")],
        "no row of the motion has 1.5; the rows have 1, 2",
    );
    refused(
        &[rows, &target("points = [[1.2, 0.0], [1.8, 0.0]]")],
        "no row of the motion is within the range of this target's curve",
    );
    refused(
        &[rows, &target("at = 1.0, value = 0.0, travel_right = 2.0")],
        "the rows of the motion m give travel_right; remove the key travel_right",
    );
    refused(
        &[
            rows,
            "optimise.constraints=[{ characteristic = \"toe\", at_most = 1.0, motion = \"m\" }]",
        ],
        "constraints cannot use the rows of the motion m",
    );
    let wheel = given.text.split("[axle]").next().unwrap();
    let text = format!("{wheel}[motion]\ntravel = [0.0, 1.0]\ncombine = \"rows\"\n");
    let error = Study::from_text("wheel.toml", &text, std::path::Path::new(".")).unwrap_err();
    assert!(
        error.to_string().contains("combine needs [axle]"),
        "{error}"
    );
}
