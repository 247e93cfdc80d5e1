//! Tests of tunings of axles with elastic parts: slopes, planted targets, rates of springs and steering, and limits.

use super::support::{SUBFRAME, asymmetric, curves, replaced, value_of, values};
use crate::compliance::support::{elastic, fourth_order, with};
use hardpoint::optimise::{Control, Linearisation, TargetLayout, assessed_at, tune};
use hardpoint::study::{Study, Wanted};
use std::path::Path;

/// Motion of the tunings.
const MOTION: &str = "heave = [-30.0, 0.0, 30.0]\nrack = [0.0, 3.0]";

pub const TUNED: &str = r#"
[optimise]
good_enough = 0.0
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-15.0, 15.0] },
  { hardpoint = "tie_rod_outer", axis = "x", range = [-15.0, 15.0] },
  { hardpoint = "lower_ball_joint", axis = "x", range = [-15.0, 15.0] },
  { bushing = "upper_arm_front", stiffness = "y", range = [0.3, 3.0], relative = true },
  { bushing = "lower_arm_front", stiffness = "y", range = [3000.0, 20000.0] },
  { bushing = "subframe_rear", stiffness = "y", range = [0.3, 3.0], relative = true },
]
targets = [
  { characteristic = "toe", over = "heave", at = 30.0, value = 0.1, tolerance = 0.02, side = "left" },
  { characteristic = "camber", over = "heave", at = -30.0, value = 0.1, tolerance = 0.02, side = "right" },
  { characteristic = "mean_steer", over = "rack", at = 3.0, value = -1.2, tolerance = 0.02 },
  { figure = "toe_by_lateral_force_trail_30", side = "left", value = 0.0, tolerance = 0.005 },
  { figure = "camber_by_lateral_force_trail_30_opposed", side = "right", value = 0.0, tolerance = 0.01 },
  { figure = "steer_by_roll", side = "left", value = 0.0, tolerance = 0.01 },
  { figure = "toe_by_aligning_moment_secant", side = "left", value = 0.0, tolerance = 0.005 },
]
"#;

/// Derivatives of the target residuals with respect to hardpoints and rates equal difference quotients, for equal and for
/// different wheels.
#[test]
fn slopes_along_variables_are_those_of_differences() {
    let alike = replaced(
        &with(SUBFRAME, TUNED),
        "heave = { from = -30.0, to = 30.0, steps = 3 }",
        MOTION,
    );
    for text in [alike, asymmetric(MOTION, TUNED)] {
        let study = elastic(&text);
        let optimise = study.optimise.as_ref().unwrap();
        let layout = TargetLayout::of(optimise, &study.vehicle);
        let x = [1.5, -2.0, 1.0, 0.1, 400.0, -0.15];
        let at = |x: &[f64]| {
            let found = assessed_at(study.wheel(), &optimise.variables, &layout, x);
            found.unwrap().unwrap().goal
        };
        assert_slopes(at, &x, &[0.1, 0.1, 0.1, 0.01, 20.0, 0.01], 7);
    }
}

/// Asserts the number of residuals, and that their derivatives with respect to every variable equal difference quotients.
fn assert_slopes(at: impl Fn(&[f64]) -> Linearisation, x: &[f64], steps: &[f64], rows: usize) {
    let found = at(x);
    assert_eq!(found.residuals.len(), rows);
    for (k, step) in steps.iter().enumerate() {
        let moved = [-2.0, -1.0, 1.0, 2.0].map(|steps| {
            let mut x = x.to_vec();
            x[k] += steps * step;
            at(&x).residuals
        });
        for row in 0..rows {
            let own = found.jacobian[(row, k)];
            let expected = fourth_order(moved.each_ref().map(|at| at[row]), *step);
            assert!(
                (own - expected).abs() < 2e-7 * expected.abs().max(1e-2),
                "{row} {k}: {own} {expected}"
            );
        }
    }
}

/// A tuning that starts at the study's design reaches the values of a known design. Its variables are hardpoints and
/// rates of both wheels.
#[test]
fn planted_targets_come_back() {
    let text = replaced(
        &with(SUBFRAME, TUNED),
        "heave = { from = -30.0, to = 30.0, steps = 3 }",
        MOTION,
    );
    let mut study = elastic(&text);
    for (seed, known) in [
        [1.5, -2.0, 1.0, 0.1, 400.0, -0.15],
        [-3.0, 4.0, -2.5, -0.18, -1500.0, 0.12],
        [4.0, 1.0, 4.5, 0.15, 1700.0, 0.18],
    ]
    .iter()
    .enumerate()
    {
        let optimise = study.optimise.as_ref().unwrap();
        let layout = TargetLayout::of(optimise, &study.vehicle);
        let found = assessed_at(study.wheel(), &optimise.variables, &layout, known);
        let residuals = found.unwrap().unwrap().goal.residuals;
        let of_rows = layout.targets_of_rows();
        let read: Vec<f64> = optimise
            .targets
            .iter()
            .enumerate()
            .map(|(target, own)| {
                let row = of_rows.iter().position(|of| *of == target).unwrap();
                let Wanted::At { value, .. } = own.wanted else {
                    panic!("single values")
                };
                value + residuals[row] / layout.share(target) * own.tolerance
            })
            .collect();
        for (target, read) in study
            .optimise
            .as_mut()
            .unwrap()
            .targets
            .iter_mut()
            .zip(read)
        {
            let Wanted::At { value, .. } = &mut target.wanted else {
                panic!("single values")
            };
            *value = read;
        }
        let tuning = tune(
            &study.vehicle,
            study.optimise.as_ref().unwrap(),
            Control::default(),
        )
        .unwrap();
        assert!(tuning.before.as_ref().unwrap().misfit > 0.1);
        let best = tuning.best.as_ref().unwrap();
        assert!(best.after.misfit < 1e-6, "{seed}: {}", best.after.misfit);
    }
}

const RATES: &str = r#"
[outputs]
characteristics = ["toe", "wheel_load", "compliant_roll_stiffness"]

[optimise]
variables = [
  { rate = "spring", range = [60.0, 130.0] },
  { rate = "anti_roll_bar", range = [0.5, 2.0], relative = true },
  { rate = "rack", range = [0.5, 2.0], relative = true },
  { rate = "column", range = [1.0e6, 4.0e6] },
]
targets = [
  { characteristic = "wheel_load", over = "heave", at = 30.0, value = 7000.0, tolerance = 50.0, side = "left" },
  { figure = "compliant_roll_stiffness", value = 700.0, tolerance = 5.0 },
  { figure = "toe_by_lateral_force_trail_30", side = "left", value = 0.0, tolerance = 0.005 },
  { figure = "toe_by_aligning_moment_opposed_locked_rack", side = "left", value = 0.0, tolerance = 0.005 },
]
"#;

/// Slopes along the rates of spring, bar, rack and column equal difference quotients. The changed study can be written
/// and read.
#[test]
fn rates_of_springs_bar_and_steering_vary() {
    let text = replaced(
        &with(SUBFRAME, RATES),
        "heave = { from = -30.0, to = 30.0, steps = 3 }",
        MOTION,
    );
    let study = elastic(&text);
    let optimise = study.optimise.as_ref().unwrap();
    let layout = TargetLayout::of(optimise, &study.vehicle);
    let labels: Vec<String> = optimise.variables.iter().map(|v| v.label()).collect();
    let expected = [
        "spring_rate",
        "anti_roll_bar_rate",
        "rack_stiffness",
        "column_stiffness",
    ];
    assert_eq!(labels, expected);
    let x = [8.0, 0.2, -0.3, 4.0e5];
    let at = |x: &[f64]| {
        let found = assessed_at(study.wheel(), &optimise.variables, &layout, x);
        found.unwrap().unwrap().goal
    };
    assert_slopes(at, &x, &[0.5, 0.01, 0.01, 2.0e4], 4);
    // If the rack is locked, the stiffnesses of rack and steering column have no effect. So the derivatives of the
    // residual with index 3 (`..._locked_rack`) are zero.
    let slopes = at(&x).jacobian;
    assert_eq!([slopes[(3, 2)], slopes[(3, 3)]], [0.0; 2]);
    assert!(slopes[(2, 2)] != 0.0 && slopes[(2, 3)] != 0.0);

    let moved = study.moved(&x);
    let written = study.with_rates_of(text.clone(), &moved);
    for kept in ["# N/mm along the spring", "# N mm/rad at the pinion"] {
        assert!(written.contains(kept), "{written}");
    }
    let read = elastic(&written);
    assert_eq!(read.axle().unwrap().axle, moved.axle().unwrap().axle);
    let [own, again] = [&moved, &read].map(curves);
    for (own, again) in own.stations.iter().zip(&again.stations) {
        for k in 0..3 {
            assert_eq!(own.value(k), again.value(k));
        }
    }
    // If the study repeats a rate in `[axle.right]`, the program changes it there too.
    let repeated = "right = { spring = { rate = 90.0 } }\n";
    let text = replaced(&text, "right = \"mirrored\"\n", repeated);
    let study = elastic(&text);
    let moved = study.moved(&x);
    let read = elastic(&study.with_rates_of(text, &moved));
    assert_eq!(read.axle().unwrap().axle, moved.axle().unwrap().axle);
}

/// The program refuses rates that the study does not have, and lists the available rates.
#[test]
fn unknown_rates_are_refused() {
    for (rate, expected) in [
        (
            "rate = \"heave_spring\"",
            "expected \"spring\", \"anti_roll_bar\", \"rack\" or \"column\"",
        ),
        (
            "rate = \"rack\", stiffness = \"x\"",
            "selects an axis of a bushing",
        ),
        (
            "rate = \"rack\", link = \"tie_rod\"",
            "expected one of the keys \"bushing\", \"link\" and \"rate\"",
        ),
    ] {
        let text = with(SUBFRAME, &replaced(RATES, "rate = \"rack\"", rate));
        let read = Study::elastic_from_text("case.toml", &text, Path::new(""));
        let error = read.unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

const LIMITED: &str = r#"
[optimise]
good_enough = 0.0
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] },
  { bushing = "lower_arm_rear", stiffness = "y", range = [0.2, 5.0], relative = true },
  { bushing = "subframe_rear", stiffness = "y", range = [0.3, 3.0], relative = true },
]
targets = [
  { characteristic = "toe", over = "heave", at = 20.0, value = 0.05, tolerance = 0.02 },
  { figure = "toe_by_lateral_force_trail_30", value = -0.03, tolerance = 0.005 },
]
constraints = [
  { characteristic = "understeer_by_lateral_force_trail_30", at_most = 0.015 },
  { characteristic = "camber_by_braking", between = [-0.05, 0.03], side = "right" },
  { characteristic = "wheel_load", at_most = 6000.0 },
  { length = "tie_rod", between = [290.0, 320.0], at = "design" },
]
"#;

/// The derivatives of limits on an axle's test results equal difference quotients. The toe target demands more
/// understeer than its limit allows. So the tuned axle has the limit value.
#[test]
fn figures_of_an_axle_keep_their_limits() {
    let study = elastic(&with(SUBFRAME, LIMITED));
    let optimise = study.optimise.as_ref().unwrap();
    let names: Vec<&str> = optimise
        .constraints
        .iter()
        .map(|c| c.name.as_str())
        .collect();
    // The test result of the axle has one limit. The wheel load has one limit for each wheel.
    assert_eq!(names.len(), 5, "{names:?}");
    assert!(
        names.contains(&"wheel_load at most 6000, left wheel"),
        "{names:?}"
    );
    let layout = TargetLayout::of(optimise, &study.vehicle);
    let at = |x: &[f64]| {
        let found = assessed_at(study.wheel(), &optimise.variables, &layout, x);
        found.unwrap().unwrap().rows
    };
    let x = [1.3, 0.2, -0.1];
    // Seven rows: five limits of quantities and test results, and two limits of a length.
    assert_slopes(at, &x, &[0.05, 0.005, 0.005], 7);
    let tuning = tune(&study.vehicle, optimise, Control::default()).unwrap();
    let best = tuning.best.unwrap();
    let tuned = study.moved(&best.offsets);
    let more = "\n[outputs]\ncharacteristics = [\"understeer_by_lateral_force_trail_30\", \"toe_by_lateral_force_trail_30\"]\n";
    let text = study
        .with_points_of(&tuned)
        .split("[optimise]")
        .next()
        .unwrap()
        .to_owned()
        + more;
    let found = values(&text, 1);
    let understeer = value_of(&found, "understeer_by_lateral_force_trail_30_deg_per_kN");
    assert!((understeer - 0.015).abs() < 1e-6, "{understeer}");
    let refused = with(
        SUBFRAME,
        &LIMITED.replace("at_most = 0.015 }", "at_most = 0.015, motion = \"x\" }"),
    );
    let read = Study::elastic_from_text("case.toml", &refused, std::path::Path::new("."));
    let said = read.map(drop).unwrap_err().to_string();
    assert!(said.contains("applies to a motion"), "{said}");
}
