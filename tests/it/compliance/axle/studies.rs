//! Tests of studies of axles with elastic parts: sweeps, refusals, names of test results, and damaged studies.

use super::builds::SCATTERED;
use super::support::{SUBFRAME, asymmetric, curves, replaced, values};
use super::tunings::TUNED;
use crate::compliance::support::{elastic, with};
use crate::support::larger;
use crate::support::mutants::mutilated;
use crate::support::random::Random;
use hardpoint::axle::{TestFigure, axle_curves};
use hardpoint::compliance::TestMode;
use hardpoint::model::Side;
use hardpoint::optimise::{Control, tune};
use hardpoint::study::Study;
use hardpoint::sweep::SweepPlan;
use hardpoint::tolerance::{Expansion, Problem, monte_carlo};
use std::ops::ControlFlow;
use std::path::Path;

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

/// Solves, sweeps, tunes and builds a study. Asserts that every value in the results is finite. Returns the number of these four
/// steps that have results.
fn use_all_of(study: &Study) -> usize {
    let Some(both) = study.axle() else { return 0 };
    let mut done = 0;
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
        done += 1;
    }
    if let Some(sweep) = &study.sweep
        && let Ok(plan) = SweepPlan::of(study, sweep)
        && let Ok(mut worker) = plan.worker()
    {
        let rows = worker.rows(0);
        assert!(rows.outputs.iter().all(|value| !value.is_infinite()));
        done += 1;
    }
    if let Some(optimise) = &study.optimise
        && let Ok(tuning) = tune(&study.vehicle, optimise, Control::default())
    {
        let best = tuning.best.iter();
        let mut offsets = best.flat_map(|best| &best.offsets);
        assert!(offsets.all(|offset| offset.is_finite()));
        done += 1;
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
            done += 1;
        }
    }
    done
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
    assert_eq!(use_all_of(&elastic(&with(SUBFRAME, EVERYTHING))), 4);
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
