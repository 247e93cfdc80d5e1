//! Tests of studies of axles with elastic parts: curves, sweeps, tunings and builds.

use super::super::support::{elastic, fourth_order, with};
use crate::support::larger;
use crate::support::mutants::mutilated;
use crate::support::random::Random;
use hardpoint::axle::{AxleCurves, TestFigure, axle_curves};
use hardpoint::compliance::TestMode;
use hardpoint::curves::Curves;
use hardpoint::model::Side;
use hardpoint::optimise::{Control, Linearisation, TargetLayout, assessed_at, tune};
use hardpoint::study::{Study, Wanted};
use hardpoint::sweep::SweepPlan;
use hardpoint::tolerance::{Expansion, Problem, monte_carlo};
use std::ops::ControlFlow;
use std::path::Path;

const SUBFRAME: &str = "subframe_axle_compliance.toml";

/// Text of the subframe study with the motion `motion`. Hardpoints and rates of the right wheel differ from those of
/// the left wheel.
fn asymmetric(motion: &str, more: &str) -> String {
    let text = with(SUBFRAME, more);
    let own = "[axle.right.hardpoints]\ntie_rod_outer = [-143.0, -683.0, 231.0]\nlower_arm_rear = [-196.0, -372.0, 201.0]\n\
               [axle.right.bushings.lower_arm_rear]\nstiffness = [900.0, 2100.0, 1700.0, 8.0e4, 2.5e5, 2.5e5]\n\
               [axle.right.bushings.upper_arm_rear]\nscale = [1.2, 1.1, 1.0, 1.0, 1.0, 1.0]\n";
    replaced(
        &replaced(
            &text,
            "heave = { from = -30.0, to = 30.0, steps = 3 }",
            motion,
        ),
        "[axle]\nright = \"mirrored\"\n",
        &format!("[axle]\n{own}"),
    )
}

fn replaced(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "{old}");
    text.replacen(old, new, 1)
}

fn curves(study: &Study) -> Curves {
    let both = study.axle().unwrap();
    let AxleCurves { curves, .. } = axle_curves(&both.axle, &both.plan).unwrap();
    assert!(curves.are_complete());
    curves
}

/// Values of a station as printed, by column name.
fn values(text: &str, station: usize) -> Vec<(String, f64)> {
    let curves = curves(&elastic(text));
    let columns = curves.columns.iter().enumerate();
    let value = |k: usize| curves.stations[station].value(k).unwrap();
    columns
        .map(|(k, column)| (column.name.clone(), value(k)))
        .collect()
}

fn value_of(values: &[(String, f64)], name: &str) -> f64 {
    let found = values.iter().find(|(known, _)| known == name);
    found.unwrap_or_else(|| panic!("{name} in {values:?}")).1
}

/// Derivative from finite differences of fourth order.
fn difference(step: f64, at: impl Fn(f64) -> f64) -> f64 {
    fourth_order([-2.0, -1.0, 1.0, 2.0].map(|steps| at(steps * step)), step)
}

const OUTPUTS: &str = r#"
[outputs]
characteristics = [
  "camber", "toe", "caster", "kingpin_offset", "steer", "mean_steer", "track", "track_change", "wheel_load",
]
order = "velocity"
"#;

/// Derivatives along both travels and the rack equal difference quotients. The wheels are different.
#[test]
fn derivatives_along_motions_agree_with_differences() {
    let here = [-10.0, 5.0, 3.0];
    let at = |[left, right, rack]: [f64; 3]| {
        let motion =
            format!("travel_left = [{left:?}]\ntravel_right = [{right:?}]\nrack = [{rack:?}]");
        values(&asymmetric(&motion, OUTPUTS), 0)
    };
    let found = at(here);
    let mut checked = 0;
    for (number, along) in ["travel_left", "travel_right", "rack"].iter().enumerate() {
        let moved: Vec<_> = [-0.2, -0.1, 0.1, 0.2]
            .iter()
            .map(|by| {
                let mut place = here;
                place[number] += by;
                at(place)
            })
            .collect();
        for (k, (name, _)) in found.iter().enumerate() {
            let marks = ["travel_left", "travel_right", "rack"];
            if marks
                .iter()
                .any(|mark| name.contains(&format!("_by_{mark}_")))
            {
                continue;
            }
            let mark = format!("_by_{along}_");
            let derivative = found[k + 1..]
                .iter()
                .find(|(other, _)| other.contains(&mark))
                .unwrap_or_else(|| panic!("{name} {mark}"));
            let expected = fourth_order(std::array::from_fn(|at| moved[at][k].1), 0.1);
            assert!(
                (derivative.1 - expected).abs() < 1e-8 * expected.abs().max(1.0),
                "{}: {} {expected}",
                derivative.0,
                derivative.1
            );
            checked += 1;
        }
    }
    assert_eq!(checked, 3 * 15);
}

/// Sensitivities to the hardpoints of either wheel equal difference quotients.
#[test]
fn sensitivities_by_both_wheels_agree_with_differences() {
    let outputs = r#"
[outputs]
characteristics = ["camber", "mean_steer", "wheel_load", "toe_by_lateral_force_trail_30", "camber_by_roll_without_bar"]
sensitivities = ["lower_arm_rear"]
"#;
    let motion = "travel_left = [-10.0]\ntravel_right = [5.0]\nrack = [3.0]";
    let study = elastic(&asymmetric(motion, outputs));
    let curves = curves(&study);
    let values_at = |side: Side, axis: usize, by: f64| {
        let mut text = asymmetric(motion, outputs);
        let (old, mut place) = match side {
            Side::Left => (
                "lower_arm_rear      = [-200.0, 375.0, 198.0]",
                [-200.0, 375.0, 198.0],
            ),
            Side::Right => (
                "lower_arm_rear = [-196.0, -372.0, 201.0]",
                [-196.0, -372.0, 201.0],
            ),
        };
        place[axis] += by;
        text = replaced(&text, old, &format!("lower_arm_rear = {place:?}"));
        values(&text, 0)
    };
    let mut checked = 0;
    for side in Side::ALL {
        for axis in 0..3 {
            let moved: Vec<_> = [-0.2, -0.1, 0.1, 0.2]
                .map(|by| values_at(side, axis, by))
                .into();
            for (k, column) in curves.columns.iter().enumerate() {
                let own = curves
                    .sensitivities
                    .iter()
                    .find(|s| s.column == k && s.side == Some(side) && s.axis as usize == axis);
                let own = own
                    .unwrap_or_else(|| panic!("{} {side:?}", column.name))
                    .value;
                let expected = fourth_order(std::array::from_fn(|at| moved[at][k].1), 0.1);
                let scale = curves.stations[0].value(k).unwrap().abs().max(1.0);
                assert!(
                    (own - expected).abs() < 1e-9 * scale,
                    "{} {side:?} {axis}: {own} {expected}",
                    column.name
                );
                checked += 1;
            }
        }
    }
    assert_eq!(checked, 6 * 9);
}

/// Without subframe, elastic rack and bar, each wheel of a symmetric axle equals a single wheel. Heave of the axle
/// corresponds to the travel of the single wheel. A parallel load on the axle corresponds to the load on the single
/// wheel.
#[test]
fn a_symmetric_axle_in_heave_is_one_wheel() {
    let tests = "relaxed = \"at_design_load\"\ntests = [{ load = \"lateral\", trail = 30.0 }, { load = \"braking\" }]\n";
    let outputs = r#"
[outputs]
characteristics = ["toe", "camber", "caster", "half_track_change", "toe_by_lateral_force_trail_30", "recession_by_braking_secant"]
sensitivities = ["tie_rod_inner", "lower_arm_rear"]
"#;
    let wheel = with("double_wishbone_compliance.toml", outputs);
    let wheel = replaced(&wheel, "relaxed = \"at_design_load\"", tests);
    let axle = replaced(&wheel, "travel = {", "heave = {") + "\n[axle]\nright = \"mirrored\"\n";
    let one = elastic(&wheel).curves().unwrap();
    let both = curves(&elastic(&axle));
    let mut checked = 0;
    for (k, column) in both.columns.iter().enumerate() {
        let name = column.name.split_once('_').unwrap().1;
        let own = one.columns.iter().position(|c| c.name == name);
        let own = own.unwrap_or_else(|| panic!("{name} in {:?}", one.columns));
        for (station, (both_at, one_at)) in both.stations.iter().zip(&one.stations).enumerate() {
            let (found, expected) = (both_at.value(k).unwrap(), one_at.value(own).unwrap());
            assert!(
                (found - expected).abs() < 1e-9 * expected.abs().max(1e-3),
                "{name} {station}: {found} {expected}"
            );
            for s in both
                .sensitivities
                .iter()
                .filter(|s| s.column == k && s.station == station)
            {
                let same = one.sensitivities.iter().find(|o| {
                    (o.station, o.column, o.point, o.axis) == (station, own, s.point, s.axis)
                });
                let expected = same.unwrap().value;
                assert!(
                    (s.value - expected).abs() < 1e-8 * expected.abs().max(1e-3),
                    "{name} {station} {:?}: {} {expected}",
                    s.axis,
                    s.value
                );
                checked += 1;
            }
        }
    }
    // Number of compared values: two wheels, six outputs, five stations, and six coordinates (two points).
    assert_eq!(checked, 2 * 6 * 5 * 6);
}

/// Motion of the tunings.
const MOTION: &str = "heave = [-30.0, 0.0, 30.0]\nrack = [0.0, 3.0]";

const TUNED: &str = r#"
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

const SCATTERED: &str = r#"
[outputs]
characteristics = ["toe", "toe_by_lateral_force_trail_30"]

[tolerance]
builds = 400
seed = 3
scatter = [
  { hardpoint = "lower_arm_rear", sigma = 0.3 },
  { bushing = "lower_arm_rear", stiffness = "y", sigma = 0.05, relative = true },
  { bushing = "subframe_rear", stiffness = "y", sigma = 0.05, relative = true },
]
bands = [
  { characteristic = "toe", over = "heave", between = [-0.4, 0.6] },
  { characteristic = "toe_by_lateral_force_trail_30", between = [-0.008, 0.003] },
]
"#;

/// The parts of each wheel scatter independently. Parts of the subframe have one deviation for both wheels. The
/// first-order result has the standard deviations of the builds. A build that is printed as a study has the values of the
/// Monte Carlo build.
#[test]
fn builds_scatter_by_sides_and_shared_parts_once() {
    let text = with(SUBFRAME, SCATTERED);
    let study = elastic(&text);
    let tolerance = study.tolerance.as_ref().unwrap();
    let names: Vec<&str> = tolerance
        .scatter
        .iter()
        .flat_map(|c| &c.sources)
        .map(|s| s.name.as_str())
        .collect();
    let expected = [
        "left lower_arm_rear x",
        "left lower_arm_rear y",
        "left lower_arm_rear z",
        "right lower_arm_rear x",
        "right lower_arm_rear y",
        "right lower_arm_rear z",
        "left lower_arm_rear stiffness y",
        "right lower_arm_rear stiffness y",
        "subframe_rear stiffness y",
    ];
    assert_eq!(names, expected);
    let problem = Problem::of(&study, tolerance).unwrap();
    let expansion = Expansion::of(&problem).unwrap();
    let drawn = problem.drawn().unwrap();
    let builds = monte_carlo(&problem, &drawn, |_| ControlFlow::Continue(())).unwrap();
    assert_eq!((builds.rejected(), builds.incomplete), (0, 0));
    let design = problem.stations().design();
    let mut checked = 0;
    for (output, column) in problem.outputs().iter().enumerate() {
        for station in 0..problem.stations().count() {
            let cell = problem.cell(output, station);
            let (spread, sigma) = (&builds.spreads[cell], expansion.variance[cell].sqrt());
            if column.name.contains("_by_") && station != design {
                assert!(spread.count == 0 && sigma.is_nan());
                continue;
            }
            let error = spread.sigma_error.max(1e-12);
            assert!(
                (spread.sigma - sigma).abs() < 4.5 * error,
                "{} {station}: {} {sigma}",
                column.name,
                spread.sigma
            );
            checked += 1;
        }
    }
    assert_eq!(checked, 2 * 3 + 2);
    let text = problem.built_text(5).unwrap();
    assert!(text.starts_with("# Without [tolerance]"), "{text}");
    let built = curves(&elastic(&text));
    // The parts of the left wheel differ from the nominal design, so the toe of the left wheel differs too.
    let toe = |curves: &Curves, side: &str| {
        let name = format!("{side}_toe_deg");
        let column = curves.columns.iter().position(|c| c.name == name).unwrap();
        curves.stations[1].value(column).unwrap()
    };
    let own = curves(&study);
    assert!((toe(&built, "left") - toe(&own, "left")).abs() > 1e-3);
    assert!((toe(&built, "left") - toe(&built, "right")).abs() > 1e-3);
}

/// A rate of a build differs between the wheels. The text of the build has no variables of rates, no tolerances, and no
/// robust tuning, also if lists are written in separate sections.
#[test]
fn the_text_of_a_build_leaves_out_rates_in_separate_sections() {
    let rate =
        "bushing = \"upper_arm_front\"\nstiffness = \"y\"\nrange = [0.5, 2.0]\nrelative = true\n";
    let point = "hardpoint = \"tie_rod_inner\"\naxis = \"z\"\nrange = [-5.0, 5.0]\n";
    for (optimise, variable) in [("", rate), ("[optimise]\nscatter = 8\n", point)] {
        let more = format!(
            "\n{optimise}[[optimise.variables]]\n{variable}[[optimise.targets]]\ncharacteristic = \"toe\"\nover = \"heave\"\n\
             at = 30.0\nvalue = 0.1\ntolerance = 0.02\nside = \"left\"\n\
             [[tolerance.scatter]]\nbushing = \"lower_arm_rear\"\nstiffness = \"y\"\nsigma = 0.05\nrelative = true\n"
        );
        let study = elastic(&with(SUBFRAME, &more));
        let problem = Problem::of(&study, study.tolerance.as_ref().unwrap()).unwrap();
        let text = problem.built_text(0).unwrap();
        let left_out = "# Without [optimise], [tolerance]: ";
        assert!(text.starts_with(left_out), "{text}");
        let built = elastic(&text);
        assert!(built.optimise.is_none() && built.tolerance.is_none());
    }
}

/// Derivatives with respect to the tolerance sources equal difference quotients between studies with the changed number.
#[test]
fn sensitivities_of_builds_agree_with_differences() {
    let text = with(SUBFRAME, SCATTERED);
    let study = elastic(&text);
    let problem = Problem::of(&study, study.tolerance.as_ref().unwrap()).unwrap();
    let expansion = Expansion::of(&problem).unwrap();
    let design = problem.stations().design();
    let own = |side: &str, factor: f64| {
        let rates = format!("[700.0, {}, 1800.0, 8.0e4, 2.5e5, 2.5e5]", 2500.0 * factor);
        match side {
            "left" => {
                let both = replaced(
                    &text,
                    "[700.0, 2500.0, 1800.0, 8.0e4, 2.5e5, 2.5e5]",
                    &rates,
                );
                let right = "[axle.right.bushings.lower_arm_rear]\nstiffness = [700.0, 2500.0, 1800.0, 8.0e4, 2.5e5, 2.5e5]\n";
                replaced(&both, "right = \"mirrored\"\n", right)
            }
            "right" => {
                let right = format!("[axle.right.bushings.lower_arm_rear]\nstiffness = {rates}\n");
                replaced(&text, "right = \"mirrored\"\n", &right)
            }
            _ => {
                let mount = format!("[3000.0, {}, 2500.0, 2.0e5, 3.0e5, 2.0e5]", 4000.0 * factor);
                replaced(
                    &text,
                    "[3000.0, 4000.0, 2500.0, 2.0e5, 3.0e5, 2.0e5]",
                    &mount,
                )
            }
        }
    };
    let mut checked = 0;
    for (source, side) in [(6, "left"), (7, "right"), (8, "subframe")] {
        for (output, column) in problem.outputs().iter().enumerate() {
            let cell = problem.cell(output, design);
            let found = expansion.gradient(cell)[source] * column.factor();
            let at = |by: f64| {
                let text = own(side, 1.0 + by);
                let alone = text.split("[tolerance]").next().unwrap().to_owned();
                value_of(&values(&alone, 1), &column.name)
            };
            let expected = difference(0.01, at);
            let scale = expected.abs().max(1e-3);
            assert!(
                (found - expected).abs() < 1e-6 * scale,
                "{} {side}: {found} {expected}",
                column.name
            );
            checked += 1;
        }
    }
    assert_eq!(checked, 3 * 4);
}

const SWEPT: &str = r#"
[outputs]
characteristics = ["toe", "camber", "wheel_load", "toe_by_lateral_force_trail_30"]
order = "velocity"

[sweep]
method = "sobol"
samples = 7
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-3.0, 3.0] },
  { bushing = "lower_arm_front", stiffness = "y", range = [0.5, 2.0], relative = true },
  { bushing = "subframe_rear", stiffness = "tz", range = [1.0e5, 4.0e5] },
]
"#;

/// Rows of a sweep equal the results of each design alone: smallest and largest value, value and slope in the design
/// position, and test results there.
#[test]
fn rows_of_a_sweep_are_those_of_single_designs() {
    let motion = "heave = [-20.0, 0.0, 15.0]";
    let study = elastic(&asymmetric(motion, SWEPT));
    let plan = SweepPlan::of(&study, study.sweep.as_ref().unwrap()).unwrap();
    let columns: Vec<String> = plan
        .record
        .outputs
        .iter()
        .map(|o| o.column.clone())
        .collect();
    let mut worker = plan.worker().unwrap();
    let rows = worker.rows(0).clone();
    assert!(rows.failing.iter().all(Option::is_none));
    let mut checked = 0;
    for design in 0..7 {
        let moved = plan.moved(design as u64);
        let alone = curves(&moved);
        for (k, name) in columns.iter().enumerate() {
            let found = rows.outputs[design * columns.len() + k];
            let of = |station: usize, name: &str| {
                let column = alone.columns.iter().position(|c| c.name == name);
                let column = column.unwrap_or_else(|| panic!("{name} in {columns:?}"));
                alone.stations[station].value(column).unwrap()
            };
            let stripped = |mark: &str| {
                let (name, unit) = name.split_once(mark)?;
                Some(format!("{name}{unit}"))
            };
            let expected = if let Some(name) = stripped("_design") {
                of(1, &name)
            } else if let Some(name) = stripped("_min") {
                (0..3).map(|s| of(s, &name)).fold(f64::INFINITY, f64::min)
            } else if let Some(name) = stripped("_max") {
                (0..3).map(|s| of(s, &name)).fold(f64::NEG_INFINITY, larger)
            } else {
                // A column without these suffixes contains a slope or a test result in the design position.
                of(1, name)
            };
            assert!(
                (found - expected).abs() < 1e-9 * expected.abs().max(1.0),
                "{name} {design}: {found} {expected}"
            );
            checked += 1;
        }
    }
    assert_eq!(checked, 7 * columns.len());
    assert!(
        columns.iter().any(|c| c.contains("toe_by_heave")),
        "{columns:?}"
    );
}

/// The program refuses quantities of the rigid mechanism. For an unknown name it suggests the nearest one.
#[test]
fn what_an_elastic_axle_does_not_have_is_refused() {
    let refused = |text: &str| {
        let read = Study::elastic_from_text("case.toml", text, std::path::Path::new(""));
        match read {
            Ok(_) => panic!("{text}"),
            Err(errors) => errors.to_string(),
        }
    };
    let output = |name: &str| {
        with(
            SUBFRAME,
            &format!("\n[outputs]\ncharacteristics = [{name:?}]\n"),
        )
    };
    for (text, why) in [
        (output("roll_centre_lateral"), "applies to the rigid mechanism only"),
        (output("toe_by_lateral_force_trail"), "did you mean \"toe_by_lateral_force_trail_30\"?"),
        (
            replaced(&output("toe_by_lateral_force_trail_30"), "[outputs]\n", "[outputs]\npoints = [\"wheel_centre\"]\n"),
            "points",
        ),
        (
            with(SUBFRAME, "\n[axle.right.bushings.subframe_rear]\nstiffness = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0]\n")
                .replacen("right = \"mirrored\"\n", "", 1),
            "\"subframe_rear\" is not a part of one wheel in [bushings]",
        ),
        (
            asymmetric("heave = [0.0]", TUNED).replace("upper_arm_front\", stiffness", "lower_arm_rear\", stiffness"),
            "has different rates on both wheels",
        ),
        (
            with(SUBFRAME, &SCATTERED.replace("stiffness = \"y\", sigma = 0.05, relative = true },\n]", "stiffness = \"y\", sigma = 0.05, relative = true, side = \"left\" },\n]")),
            "both wheels share this part",
        ),
        (
            with(SUBFRAME, "\n[motions.corner]\nroll = [0.0, 1.0]\n"),
            "roll",
        ),
    ] {
        let said = refused(&text);
        assert!(said.contains(why), "{why}: {said}");
    }
}

/// The program refuses a stiffness of rack or column for wheels without a rack.
#[test]
fn the_stiffness_of_a_missing_rack_is_refused() {
    let parts = ["bushings", "axle"].map(str::to_owned);
    let text = hardpoint::cli::template("semi_trailing_arm", &parts).unwrap();
    elastic(&text);
    let text = text + "\n[steering]\nrack_stiffness = 1000.0\n";
    let read = Study::elastic_from_text("case.toml", &text, Path::new(""));
    let said = read.unwrap_err().to_string();
    assert!(said.contains("this axle has no rack"), "{said}");
}

/// Every test result has a unique name, and the value under this name equals the value that `hardpoint kc` writes.
#[test]
fn figures_have_names_of_their_own() {
    let study = elastic(&with(SUBFRAME, ""));
    let axle = &study.axle().unwrap().axle;
    let figures = &axle.elastic.as_ref().unwrap().figures;
    let names: Vec<String> = figures.iter().map(TestFigure::name).collect();
    for (k, name) in names.iter().enumerate() {
        assert!(!names[..k].contains(name), "{name}");
    }
    for name in [
        "left_compliant_ride_rate_heave",
        "left_compliant_ride_rate_vertical",
        "understeer_by_aligning_moment",
    ] {
        assert!(names.contains(&name.to_owned()), "{name} in {names:?}");
    }
    let stems: Vec<String> = figures.iter().map(TestFigure::stem).collect();
    let mut asked: Vec<&str> = stems.iter().map(String::as_str).collect();
    asked.sort_unstable();
    asked.dedup();
    let more = format!("\n[outputs]\ncharacteristics = {asked:?}\n");
    let text = with(SUBFRAME, &more);
    let found = values(&text, 1);
    let read = elastic(&text);
    let tests = hardpoint::rig::RigTests::of(&read, None).unwrap();
    let rows = crate::support::rows_by_column(&tests.results.kc_csv());
    let mut checked = 0;
    for figure in figures {
        let wheel = figure.side().map_or("axle", Side::name);
        let mode = match figure.test.mode {
            TestMode::Single(_) => "single",
            TestMode::Opposed => "opposed",
            TestMode::Parallel | TestMode::OneWheel => "parallel",
        };
        let bar = if figure.test.has_bar {
            "connected"
        } else {
            "disconnected"
        };
        let key = if figure.is_secant { "secant" } else { "value" };
        let trail = |row: &str| row.parse::<f64>().unwrap_or(0.0) == figure.test.trail;
        let row = rows.iter().find(|row| {
            row["load"] == figure.test.load.name()
                && row["quantity"] == figure.quantity
                && row["wheel"] == wheel
                && (row["mode"].is_empty() || row["mode"] == mode)
                && row["anti_roll_bar"] == bar
                && trail(&row["trail_mm"])
                && (row["travel_left_mm"].parse() == Ok(0.0)
                    && row["travel_right_mm"].parse() == Ok(0.0))
        });
        // If a load acts on one wheel only, the table has no results of the other wheel.
        let row = row.unwrap_or_else(|| panic!("{}", figure.name()));
        let expected: f64 = row[key].parse().unwrap();
        let name = figure.name();
        let own = found.iter().find(|(column, _)| {
            column
                .strip_prefix(&name)
                .is_some_and(|unit| (unit.is_empty() || unit.starts_with('_')) && is_unit(unit))
        });
        let own = own.unwrap_or_else(|| panic!("{name} in {found:?}")).1;
        assert!(
            (own - expected).abs() < 1e-9 * expected.abs().max(1e-9),
            "{name}: {own} {expected}"
        );
        checked += 1;
    }
    assert_eq!(checked, figures.len());
}

/// Returns true if the end of a column name is a unit and nothing else.
fn is_unit(end: &str) -> bool {
    let words = [
        "trail", "secant", "opposed", "left", "right", "without", "locked", "heave", "vertical",
        "lateral",
    ];
    !end.split('_').any(|word| words.contains(&word))
}

const EVERYTHING: &str = r#"
[outputs]
characteristics = ["toe", "bump_steer", "wheel_load", "toe_by_lateral_force_trail_30", "steer_by_roll"]
sensitivities = ["lower_arm_rear"]

[sweep]
method = "sobol"
samples = 3
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-3.0, 3.0] },
  { bushing = "subframe_rear", stiffness = "tz", range = [1.0e5, 4.0e5] },
]

[optimise]
max_iterations = 2
variables = [
  { hardpoint = "lower_arm_front", axis = "z", range = [-15.0, 15.0] },
  { bushing = "lower_arm_front", stiffness = "y", range = [0.3, 3.0], relative = true },
]
targets = [
  { characteristic = "toe", over = "heave", points = [[-30.0, 0.1], [30.0, 0.1]], tolerance = 0.02 },
  { figure = "understeer_by_aligning_moment", at_most = 0.02, tolerance = 0.005 },
]

[tolerance]
builds = 3
seed = 3
scatter = [
  { hardpoint = "lower_arm_rear", sigma = 0.3 },
  { bushing = "upper_arm_rear", stiffness = "y", sigma = 0.05, relative = true, side = "right" },
]
bands = [{ characteristic = "steer_by_roll", between = [-0.1, 0.1] }]
"#;

/// Solves, sweeps, tunes and builds a study. Asserts that every value in the results is finite.
fn use_all_of(study: &Study) {
    let Some(both) = study.axle() else { return };
    if let Ok(found) = axle_curves(&both.axle, &both.plan) {
        for station in &found.curves.stations {
            assert!(
                station
                    .values
                    .iter()
                    .flatten()
                    .all(|value| value.is_finite())
            );
        }
        assert!(
            found
                .curves
                .sensitivities
                .iter()
                .all(|s| s.value.is_finite())
        );
    }
    if let Some(sweep) = &study.sweep
        && let Ok(plan) = SweepPlan::of(study, sweep)
        && let Ok(mut worker) = plan.worker()
    {
        let rows = worker.rows(0);
        assert!(rows.outputs.iter().all(|value| !value.is_infinite()));
    }
    if let Some(optimise) = &study.optimise
        && let Ok(tuning) = tune(&study.vehicle, optimise, Control::default())
    {
        let best = tuning.best.iter();
        let mut offsets = best.flat_map(|best| &best.offsets);
        assert!(offsets.all(|offset| offset.is_finite()));
    }
    // A study that gives no number of builds would run thousands of builds.
    let few = study.tolerance.as_ref().filter(|own| own.builds < 100);
    if let Some(tolerance) = few
        && let Ok(problem) = Problem::of(study, tolerance)
        && let (Ok(drawn), Ok(_)) = (problem.drawn(), Expansion::of(&problem))
    {
        let builds = monte_carlo(&problem, &drawn, |_| ControlFlow::Continue(()));
        assert!(builds.is_ok());
        if let Ok(text) = problem.built_text(1) {
            elastic(&text);
        }
    }
}

fn mutilated_studies(cases: u64) -> [usize; 2] {
    let text = with(SUBFRAME, EVERYTHING);
    let (mut used, mut refused) = (0, 0);
    for case in 0..cases {
        let mut random = Random(case + 990_000_000);
        let text = mutilated(&text, &mut random);
        match Study::elastic_from_text("study.toml", &text, std::path::Path::new(".")) {
            Err(errors) => {
                refused += 1;
                assert!(!errors.all().is_empty());
            }
            Ok(study) => {
                used += 1;
                use_all_of(&study);
            }
        }
    }
    [used, refused]
}

/// Randomly damaged studies are computed or refused with a reason: no command panics or loops forever.
#[test]
fn mutilated_studies_are_computed_or_refused() {
    use_all_of(&elastic(&with(SUBFRAME, EVERYTHING)));
    let [used, refused] = mutilated_studies(60);
    assert!(used > 5 && refused > 30, "{used} {refused}");
}

#[test]
#[ignore = "2000 studies: minutes"]
fn two_thousand_mutilated_studies_are_computed_or_refused() {
    let [used, refused] = mutilated_studies(2000);
    println!("{used} computed, {refused} refused");
    assert!(used > 200 && refused > 1000, "{used} {refused}");
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
