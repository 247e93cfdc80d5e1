//! Tests of car tunings with targets and constraints of single axles, and with variables that move several hardpoints.

use super::commands::hardpoint;
use crate::support::studies;
use hardpoint::axle::{AxleSolver, Placement, Quantity};
use hardpoint::car::{CarGoals, CarQuantity, CarSolver, CarTarget, moved, tune};
use hardpoint::study::{CarStudy, Vehicle};
use serde_json::Value;
use std::path::Path;

/// Sample car with this section in place of its `[optimise]`.
fn car(directory: &Path, optimise: &str) -> std::path::PathBuf {
    for name in ["car.toml", "car_front.toml", "car_rear.toml"] {
        std::fs::copy(studies().join(name), directory.join(name)).unwrap();
    }
    let path = directory.join("car.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let (text, _) = text.split_once("[optimise]").unwrap();
    std::fs::write(&path, format!("{text}\n{optimise}")).unwrap();
    path
}

const BUMP_STEER: &str = r#"
[optimise]
variables = [
  { axle = "front", hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] },
  { axle = "front", hardpoints = ["lower_arm_front", "lower_arm_rear"], axis = "z", factors = [1.0, 1.0], range = [-10.0, 10.0] },
  { axle = "front", rate = "anti_roll_bar", percent = 40.0 },
  { axle = "rear", rate = "anti_roll_bar", percent = 40.0 },
]
targets = [
  { axle = "front", characteristic = "toe", side = "left", over = "roll", points = [[-3.0, 0.03], [0.0, 0.0], [3.0, -0.04]], tolerance = 0.01 },
  { case = "turn", characteristic = "lateral_load_transfer_distribution", value = 48.0, tolerance = 0.1 },
  { case = "turn", characteristic = "roll", value = 2.4, tolerance = 0.02 },
]
constraints = [
  { axle = "front", length = "tie_rod", kept = true },
  { case = "turn", characteristic = "front_right_wheel_load", at_most = 7000.0 },
]
"#;

/// The outer joint of the arm lies on the axis of its inner joints. The reason names the point in words.
#[test]
fn the_fault_of_an_axle_is_in_words() {
    let directory = tempfile::tempdir().unwrap();
    let path = car(directory.path(), BUMP_STEER);
    let mut study = CarStudy::read(&path, &[]).unwrap();
    let Vehicle::Axle(both) = &mut study.axles[0].vehicle else {
        panic!("an axle of a car");
    };
    let left = &mut both.axle.left;
    let [joint, inner] =
        ["lower_ball_joint", "lower_arm_front"].map(|name| left.mechanism.point(name).unwrap());
    left.design[joint.0] = left.design[inner.0];
    let rig = study.optimise.as_ref().unwrap().rigs[0].as_ref().unwrap();
    let columns = rig.columns.iter().max().unwrap() + 1;
    let reason = rig
        .outcome(&study.axles[0].vehicle, &vec![0.0; columns])
        .unwrap_err();
    assert!(reason.contains("lower_ball_joint"), "{reason}");
    assert!(!reason.contains("PointId"), "{reason}");
}

/// A tuning meets a constraint of an axle and a constraint of a load case together. The misfit is the root mean square over
/// targets of load cases and targets of axles.
#[test]
fn targets_of_cases_and_axles_are_tuned_together() {
    let directory = tempfile::tempdir().unwrap();
    let path = car(directory.path(), BUMP_STEER);
    let study = CarStudy::read(&path, &[]).unwrap();
    let wanted = study.optimise.as_ref().unwrap();
    let tuned = study.tuned(wanted, Default::default()).unwrap();
    let rig = wanted.rigs[0].as_ref().unwrap();
    let outcome = rig
        .outcome(&study.axles[0].vehicle, tuned.fit.x.as_slice())
        .unwrap();
    // The tie rod keeps its length although its inner point moves.
    assert!(outcome.margins[0].abs() < 1e-6, "{outcome:?}");
    let design = &tuned.study.car.axles[0].left.design;
    let before = &study.car.axles[0].left.design;
    let point = |name: &str| study.car.axles[0].left.mechanism.point(name).unwrap();
    let [inner, outer] = ["tie_rod_inner", "tie_rod_outer"].map(point);
    let length = |of: &[hardpoint::number::Vector3<f64>]| (of[inner.0] - of[outer.0]).norm();
    assert!((length(design) - length(before)).abs() < 1e-6);
    // The points of both arms move by the same amount.
    let moved_by = |name: &str| (design[point(name).0] - before[point(name).0]).z;
    assert_eq!(moved_by("lower_arm_front"), moved_by("lower_arm_rear"));
    assert!(moved_by("lower_arm_front") != 0.0);
    // Computes the misfit from published values.
    let mut solver = CarSolver::new(&tuned.study.car).unwrap();
    let turn = study
        .cases
        .iter()
        .position(|case| case.name == "turn")
        .unwrap();
    let case = &study.cases[turn];
    let found = solver.solve(case).unwrap();
    let solved = solver.solved(case, &found).unwrap();
    let mut sum = outcome.targets[0].rms.powi(2);
    for target in &wanted.targets {
        let value = target.quantity.printed(&solved, case).unwrap();
        sum += (target.deviation(value) / target.tolerance).powi(2);
    }
    let misfit = (sum / 3.0).sqrt();
    assert!(
        (tuned.fit.misfit() / misfit - 1.0).abs() < 1e-9,
        "{} {misfit}",
        tuned.fit.misfit()
    );
    let load = CarQuantity::named("front_right_wheel_load")[0];
    assert!(load.printed(&solved, case).unwrap() < 7000.0 + 1e-3);
}

/// A target over the stations of an axle counts as one target. A tuning finds the design from which the targets of load
/// cases and of axles were computed.
#[test]
fn planted_bump_steer_and_distribution_are_found() {
    let directory = tempfile::tempdir().unwrap();
    let kept = "{ axle = \"front\", length = \"tie_rod\", kept = true },";
    let without_tie_rod = BUMP_STEER.replace(kept, "");
    let path = car(directory.path(), &without_tie_rod);
    let study = CarStudy::read(&path, &[]).unwrap();
    let wanted = study.optimise.clone().unwrap();
    let planted = [2.0, -3.0, 700_000.0, 350_000.0];
    let truth = moved(&study.car, &wanted.variables, &planted);
    // Curve of the car with the known design, from the study of its axle.
    let front = &study.axles[0];
    let text = front.with_points_of(&front.at_design(truth.axles[0].left.design.clone()));
    let axle = hardpoint::study::Study::from_text("front.toml", &text, Path::new(".")).unwrap();
    let own = axle.axle().unwrap();
    let toe = Quantity::named("toe");
    let mut solver = AxleSolver::<4>::new(&own.axle, &toe, false).unwrap();
    let mut points = Vec::new();
    for roll in [-3.0_f64, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0] {
        let placement = Placement::Roll {
            heave: 0.0,
            roll: roll.to_radians(),
            rack: 0.0,
        };
        let placed = solver.place(&placement).unwrap();
        // The first value is that of the left wheel.
        let value = solver.read(&placed).unwrap().value(toe[0]).unwrap();
        points.push(format!("[{roll:?}, {:?}]", value.to_degrees()));
    }
    let curve = "points = [[-3.0, 0.03], [0.0, 0.0], [3.0, -0.04]]";
    let text = without_tie_rod.replace(
        curve,
        &format!(
            "points = [{}], interpolation = \"linear\"",
            points.join(", ")
        ),
    );
    let path = car(directory.path(), &text);
    let study = CarStudy::read(&path, &[]).unwrap();
    let wanted = study.optimise.as_ref().unwrap();
    let mut solver = CarSolver::new(&truth).unwrap();
    let values: Vec<CarTarget> = wanted
        .targets
        .iter()
        .map(|target| {
            let case = &study.cases[target.case];
            let found = solver.solve(case).unwrap();
            let solved = solver.solved(case, &found).unwrap();
            let value = target.quantity.printed(&solved, case).unwrap();
            CarTarget {
                wanted: [value; 2],
                ..target.clone()
            }
        })
        .collect();
    let goals = CarGoals {
        targets: &values,
        constraints: &[],
        ..study.goals(wanted)
    };
    let tuning = tune(&study.car, goals, wanted.run, Default::default()).unwrap();
    let tuned = tuning.starts.best_fit().unwrap();
    assert!(tuned.misfit() < 1e-6, "{:e}", tuned.misfit());
    for (found, planted) in tuned.x.iter().zip(planted) {
        assert!(
            (found - planted).abs() < 1e-4 * planted.abs(),
            "{:?}",
            tuned.x
        );
    }
}

/// A car whose goals belong to one axle has the same price of a constraint (misfit per unit of the limit) as the study of
/// this axle. Three points on a line are a constraint with two components.
#[test]
fn a_constraint_of_one_axle_has_the_price_of_the_axle() {
    let goals = r#"
variables = [
  { axle = "front", hardpoint = "tie_rod_inner", axis = "y", range = [-60.0, 60.0] },
  { axle = "front", hardpoint = "tie_rod_inner", axis = "z", range = [-60.0, 60.0] },
  { axle = "front", hardpoint = "tie_rod_outer", axis = "x", range = [-10.0, 10.0] },
]
targets = [
  { axle = "front", characteristic = "toe", side = "left", over = "roll", points = [[-3.0, 0.03], [0.0, 0.0], [3.0, -0.04]], tolerance = 0.01 },
]
constraints = [{ axle = "front", line = ["lower_arm_front", "lower_arm_rear", "tie_rod_inner"] }]
"#;
    let directory = tempfile::tempdir().unwrap();
    car(directory.path(), &format!("[optimise]\n{goals}"));
    let front = std::fs::read_to_string(studies().join("car_front.toml")).unwrap();
    let goals = goals.replace("axle = \"front\", ", "");
    let axle = format!("{front}\n[optimise]\ngood_enough = 0.0\n{goals}");
    std::fs::write(directory.path().join("axle.toml"), axle).unwrap();
    let price = |study: &str| {
        hardpoint(
            directory.path(),
            &["optimise", study, "--out", "tuned", "--force"],
        );
        let summary = std::fs::read_to_string(directory.path().join("tuned/summary.json")).unwrap();
        let summary: Value = serde_json::from_str(&summary).unwrap();
        summary["constraints"][0]["price"].as_f64().unwrap()
    };
    let [of_car, of_axle] = ["car.toml", "axle.toml"].map(price);
    assert!(
        of_axle > 1.0 && (of_car / of_axle - 1.0).abs() < 1e-6,
        "{of_car} {of_axle}"
    );
}

/// The terminal lists targets of load cases, targets of axles, and constraints. The JSON output contains them.
#[test]
fn the_command_reports_both_kinds() {
    let directory = tempfile::tempdir().unwrap();
    car(directory.path(), BUMP_STEER);
    let arguments = ["optimise", "car.toml", "--out", "tuned", "--report"];
    let said = hardpoint(directory.path(), &arguments).get_output().clone();
    let text = String::from_utf8(said.stdout).unwrap();
    assert!(
        text.contains("toe_rms_deviation_deg") && text.contains("front axle alone"),
        "{text}"
    );
    assert!(text.contains("margin after"), "{text}");
    // Terminal and page name the curve of a target of one axle. The value is the deviation from this curve.
    assert!(text.contains("0 (target -0.04 to 0.03)"), "{text}");
    let page = std::fs::read_to_string(directory.path().join("tuned/report.html")).unwrap();
    assert!(page.contains(">0 (target −0.04 to 0.03)</td>"));
    let summary = std::fs::read_to_string(directory.path().join("tuned/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["targets"].as_array().unwrap().len(), 3);
    assert_eq!(summary["constraints"].as_array().unwrap().len(), 2);
}

/// Every target and constraint belongs to either a load case or an axle. The program refuses an entry with both or
/// without either. It also refuses keys and rates that a car does not have.
#[test]
fn mistakes_of_places_are_named() {
    let directory = tempfile::tempdir().unwrap();
    for (from, to, expected) in [
        (
            "{ case = \"turn\", characteristic = \"roll\",",
            "{ characteristic = \"roll\",",
            "expected the key \"case\" (a load case) or the key \"axle\"",
        ),
        (
            "{ case = \"turn\", characteristic = \"roll\",",
            "{ case = \"turn\", axle = \"front\", characteristic = \"roll\",",
            "only one of them",
        ),
        (
            "{ case = \"turn\", characteristic = \"roll\",",
            "{ case = \"turn\", over = \"roll\", characteristic = \"roll\",",
            "over is for a single axle",
        ),
        (
            "characteristic = \"toe\", side = \"left\"",
            "characteristic = \"roll_stiffness_at_load\"",
            "depends on rates of the front axle",
        ),
        (
            "factors = [1.0, 1.0]",
            "factors = [1.0]",
            "expected 2 factors",
        ),
        (
            "percent = 40.0",
            "relative = 0.4",
            "has the key \"percent\" instead of \"relative\"",
        ),
        // Division by the square of these numbers would overflow.
        (
            "value = 48.0, tolerance = 0.1",
            "value = 48.0, tolerance = 1e-300",
            "expected a number of at least 1e-12",
        ),
        (
            "value = 48.0, tolerance = 0.1",
            "value = 48.0, tolerance = 0.1, weight = 1e-300",
            "expected a number of at least 1e-12",
        ),
    ] {
        let path = car(directory.path(), &BUMP_STEER.replacen(from, to, 1));
        let errors = CarStudy::read(&path, &[]).unwrap_err();
        let text = format!("{errors}");
        assert!(text.contains(expected), "{expected}: {text}");
    }
    // The study of an axle has no load cases.
    let front = std::fs::read_to_string(studies().join("car_front.toml")).unwrap();
    let text = format!(
        "{front}\n[optimise]\nvariables = [{{ hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-5.0, 5.0] }}]\ntargets = [{{ case = \"turn\", characteristic = \"toe\", at = 0.0, value = 0.0, tolerance = 0.1 }}]\n"
    );
    let errors =
        hardpoint::study::Study::from_text("front.toml", &text, Path::new(".")).unwrap_err();
    assert!(format!("{errors}").contains("case needs [car]"), "{errors}");
}

/// The calculation of a single axle uses the rates of the axle's study. If a variable changes a rate of this axle, the
/// program refuses targets and constraints that depend on rates: by their quantity, or by a motion at constant wheel load.
#[test]
fn goals_that_depend_on_a_variable_rate_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    for end in ["", "_front", "_rear"] {
        let file = format!("off_road_car{end}.toml");
        std::fs::copy(studies().join(&file), directory.path().join(&file)).unwrap();
    }
    let path = directory.path().join("off_road_car.toml");
    let car = std::fs::read_to_string(&path).unwrap();
    let point =
        "{ axle = \"rear\", hardpoint = \"upper_link_axle\", axis = \"z\", range = [-10.0, 10.0] }";
    let rate = "{ axle = \"rear\", rate = \"spring\", range = [20.0, 60.0] }";
    let roll =
        "{ case = \"turn\", characteristic = \"roll\", value = 3.0, tolerance = 0.1 }".to_owned();
    let steer = format!(
        "{roll}, {{ axle = \"rear\", characteristic = \"axle_steer\", over = \"roll\", points = [[-2.0, 0.1], [2.0, -0.1]], tolerance = 0.05 }}"
    );
    let limit =
        "{ axle = \"rear\", characteristic = \"wheel_rate\", at = \"design\", at_least = 45.0 }";
    let held = ["rear.motion.hold=\"wheel_load\"".to_owned()];
    let (of_constraint, of_target) = (
        "this constraint depends on rates of the rear axle",
        "this target depends on rates of the rear axle",
    );
    for (has_rate, targets, constraint, changes, refused) in [
        (true, &roll, limit, &[][..], Some(of_constraint)),
        (false, &roll, limit, &[], None),
        (true, &steer, "", &held, Some(of_target)),
        (true, &steer, "", &[], None),
        (false, &steer, "", &held, None),
    ] {
        let rate = if has_rate { rate } else { "" };
        let optimise = format!(
            "[optimise]\nvariables = [{point}, {rate}]\ntargets = [{targets}]\nconstraints = [{constraint}]\n"
        );
        let optimise = optimise.replace(", ]", "]");
        std::fs::write(&path, format!("{car}\n{optimise}")).unwrap();
        let said = CarStudy::read(&path, changes).map_err(|errors| errors.to_string());
        match (said, refused) {
            (Ok(_), None) => {}
            (Err(said), Some(phrase)) => assert!(said.contains(phrase), "{optimise}: {said}"),
            (said, _) => panic!("{optimise}: {:?}", said.err()),
        }
    }
}
