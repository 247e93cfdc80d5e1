//! Tests of the messages about the result of a car's tuning: targets out of reach, variables at their limits, prices of
//! constraints.

use super::commands::{hardpoint, text};
use crate::support::{one_line, studies};
use hardpoint::study::{CarStudy, TunedCar};
use serde_json::Value;

/// Both anti-roll bars.
const BARS: &str = "optimise.variables=[{axle=\"front\",rate=\"anti_roll_bar\",range=[300000.0,1500000.0]}, \
                    {axle=\"rear\",rate=\"anti_roll_bar\",range=[100000.0,800000.0]}]";
/// Target that the bars can meet.
const BALANCE: &str = "{case=\"turn\",characteristic=\"lateral_load_transfer_distribution\",value=47.0,tolerance=0.1}";

fn sets(targets: &str, constraints: &str) -> [String; 3] {
    [
        BARS.to_owned(),
        format!("optimise.targets=[{targets}]"),
        format!("optimise.constraints=[{constraints}]"),
    ]
}

fn tuned(targets: &str, constraints: &str) -> TunedCar {
    let sets = sets(targets, constraints);
    let study = CarStudy::read(&studies().join("car.toml"), &sets);
    let study = study.unwrap_or_else(|errors| panic!("{errors}"));
    let wanted = study.optimise.as_ref().unwrap();
    study.tuned(wanted, Default::default()).unwrap()
}

/// Runs the tuning, asserts its exit code, and returns the printed text on one line and `summary.json`.
fn said(targets: &str, constraints: &str, code: i32) -> (String, Value) {
    let directory = tempfile::tempdir().unwrap();
    let path = studies().join("car.toml");
    let mut arguments = vec!["optimise", path.to_str().unwrap(), "--out", "tuned"];
    let sets = sets(targets, constraints);
    for set in &sets {
        arguments.extend(["--set", set]);
    }
    let run = hardpoint(directory.path(), &arguments).code(code);
    let words = text(&run.get_output().stdout);
    let summary = std::fs::read(directory.path().join("tuned/summary.json")).unwrap();
    (one_line(&words), serde_json::from_slice(&summary).unwrap())
}

/// The bars do not affect the drag. The program reports a target for the drag and exits with code 1. This target does
/// not change the result for the other target.
#[test]
fn a_target_that_no_variable_affects_is_named() {
    let drag = "{case=\"fast\",characteristic=\"drag\",value=500.0,tolerance=1.0}";
    let both = format!("{drag},{BALANCE}");
    let (found, alone) = (tuned(&both, ""), tuned(BALANCE, ""));
    assert_eq!(found.tuning.unmoved.targets, [0]);
    assert_eq!(found.fit.x, alone.fit.x);
    assert!(alone.tuning.unmoved.targets.is_empty());
    // The misfit includes the drag.
    assert!(found.fit.misfit() > 800.0 && alone.fit.misfit() < 1e-6);
    let (words, summary) = said(&both, "", 1);
    let missed = "missed: drag_N in fast, by 1223.80 tolerances";
    assert!(words.contains(missed), "{words}");
    assert!(
        words.contains("no variable affects drag_N in fast"),
        "{words}"
    );
    assert_eq!(summary["unmoved"][0], "drag_N in fast");
}

/// The bars change the weight distribution at rest by less than its tolerance. The program reports this, because the
/// target moves both bars to the ends of their ranges.
#[test]
fn a_target_that_variables_hardly_affect_is_named() {
    let weight =
        "{case=\"static\",characteristic=\"weight_distribution_front\",value=45.0,tolerance=0.1}";
    let (words, summary) = said(&format!("{weight},{BALANCE}"), "", 0);
    let name = "weight_distribution_front_percent in static";
    let remark = format!("the variables hardly affect {name}: it is missed by 59.92 tolerances");
    assert!(words.contains(&remark), "{words}");
    assert!(words.contains("at lower bound"), "{words}");
    let record = &summary["hardly_moved"][0];
    assert_eq!(record["target"], name);
    // The weight distribution changes by less than a hundredth of its tolerance, but not by zero.
    let moved: f64 = record["change"].as_f64().unwrap();
    assert!(moved > 0.0 && moved < 0.01, "{moved}");
    assert!(words.contains(" -> "), "{words}");
    let before = summary["misfit_before"].as_f64().unwrap();
    assert!(before > summary["misfit"].as_f64().unwrap());
}

/// A violated constraint that no variable affects gives exit code 1.
#[test]
fn a_constraint_that_no_variable_affects_is_named() {
    let drag = "{case=\"fast\",characteristic=\"drag\",at_most=1000.0}";
    let (words, summary) = said(BALANCE, drag, 1);
    let remark =
        "no variable affects this constraint, which stays violated: drag in fast (at most 1000";
    assert!(words.contains(remark), "{words}");
    assert_eq!(summary["constraints"][0]["status"], "violated");
}

/// The price of a binding constraint is the decrease of the misfit when its limit is relaxed by one unit.
#[test]
fn a_price_is_the_slope_of_the_misfit() {
    let roll = "{case=\"turn\",characteristic=\"roll_gradient\",value=3.5,tolerance=0.1}";
    let target = &format!("{BALANCE},{roll}");
    let load = |most: f64| {
        format!("{{case=\"turn\",characteristic=\"front_right_wheel_load\",at_most={most}}}")
    };
    let most = 6200.0;
    let found = tuned(target, &load(most));
    let price = found.tuning.prices[0].per_unit().unwrap();
    let wider = tuned(target, &load(most + 1.0)).fit.misfit();
    let tighter = tuned(target, &load(most - 1.0)).fit.misfit();
    let slope = (tighter - wider) / 2.0;
    assert!(
        price > 0.0 && (price - slope).abs() < 1e-3 * slope,
        "{price} {slope}"
    );
}

/// If constraints conflict, the tuning minimises the largest violation. In this comparison, 1 degree counts as much as
/// 10 N, as in a study of one wheel.
#[test]
fn conflicting_violations_are_balanced_in_visible_units() {
    let constraints = "{case=\"turn\",characteristic=\"roll\",at_most=2.0}, \
                       {case=\"turn\",characteristic=\"front_right_wheel_load\",at_most=6000.0}";
    let (words, summary) = said(BALANCE, constraints, 1);
    let margin = |number: usize| {
        summary["constraints"][number]["margins"][1]
            .as_f64()
            .unwrap()
    };
    let (roll, load) = (-margin(0), -margin(1));
    assert!(
        roll > 0.0 && (load - 10.0 * roll).abs() < 1e-3 * load,
        "{roll} {load}"
    );
    assert!(
        words.contains("no start satisfied all constraints; start 0 is kept"),
        "{words}"
    );
}

/// Targets and constraints of a single axle show their own values: the range of the target curve, and both limits of a
/// length.
#[test]
fn goals_of_an_axle_have_their_values() {
    let directory = tempfile::tempdir().unwrap();
    let path = studies().join("car.toml");
    let sets = [
        "optimise.variables=[{axle=\"front\",hardpoint=\"tie_rod_inner\",axis=\"z\",range=[-15.0,15.0]}, \
         {axle=\"rear\",hardpoint=\"toe_link_inner\",axis=\"z\",range=[-15.0,15.0]}]",
        "optimise.targets=[{axle=\"front\",characteristic=\"toe\",over=\"roll\",points=[[-3.0,0.05],[3.0,0.01]], \
         tolerance=0.04,side=\"left\"}]",
        "optimise.constraints=[{axle=\"rear\",length=\"toe_link\",between=[300.0,400.0]}]",
    ];
    let mut arguments = vec!["optimise", path.to_str().unwrap(), "--out", "tuned"];
    for set in sets {
        arguments.extend(["--set", set]);
    }
    let run = hardpoint(directory.path(), &arguments).success();
    let words = text(&run.get_output().stdout);
    let words = one_line(&words);
    assert!(words.contains("0 (target 0.01 to 0.05)"), "{words}");
    assert!(words.contains("300 to 400"), "{words}");
    let summary = std::fs::read(directory.path().join("tuned/summary.json")).unwrap();
    let summary: Value = serde_json::from_slice(&summary).unwrap();
    let (target, constraint) = (&summary["targets"][0], &summary["constraints"][0]);
    assert_eq!(target["wanted"], 0.0);
    assert_eq!(target["tolerance"], 0.04);
    let number = |value: &Value| value.as_f64().unwrap();
    let curve = [0, 1].map(|k| number(&target["curve"][k]));
    assert!((curve[0] - 0.01).abs() < 1e-12 && (curve[1] - 0.05).abs() < 1e-12);
    let limits = [0, 1].map(|k| number(&constraint["limits"][k]));
    assert_eq!(limits, [300.0, 400.0]);
}

/// With `rate` and `force`, every design has the same spring force in its design position, so moves of the spring mount
/// hardly change the static ride height. A remark explains this. With `force_curve` the same spring stays in the car, and
/// the tuning reaches the target.
#[test]
fn a_moved_spring_mount_changes_the_ride_height_of_the_same_spring() {
    let directory = tempfile::tempdir().unwrap();
    for name in ["car.toml", "car_front.toml", "car_rear.toml"] {
        std::fs::copy(studies().join(name), directory.path().join(name)).unwrap();
    }
    let run = || {
        let sets = [
            "optimise.variables=[{axle=\"front\",hardpoint=\"strut_top\",axis=\"z\",range=[-15.0,15.0]}]",
            "optimise.targets=[{case=\"static\",characteristic=\"ride_height_front\",value=145.0,tolerance=0.1}]",
            "optimise.constraints=[]",
            "tolerance.scatter=[{car=\"mass\",sigma=15.0}]",
        ];
        let mut arguments = vec!["optimise", "car.toml", "--out", "tuned", "--force"];
        arguments.extend(sets.iter().flat_map(|set| ["--set", set]));
        let run = hardpoint(directory.path(), &arguments).code(0);
        let words = text(&run.get_output().stdout);
        one_line(&words)
    };
    let remark = "ride_height_front_mm in static: every design has the force of [spring]";
    let words = run();
    assert!(
        words.contains("missed: ride_height_front_mm in static"),
        "{words}"
    );
    assert!(words.contains(remark), "{words}");
    // The spring acts between strut_lower and strut_top.
    let length = [24.0_f64, 48.0, 480.0].map(|part| part * part);
    let length = length.iter().sum::<f64>().sqrt();
    let (shorter, longer) = (length - 100.0, length + 100.0);
    let curve = format!("force_curve = [[{shorter}, 6800.0], [{longer}, 800.0]]");
    let path = directory.path().join("car_front.toml");
    let front = std::fs::read_to_string(&path).unwrap();
    let same = front
        .replacen("rate = 30.0 ", &format!("{curve} #"), 1)
        .replacen("force = 3800.0 ", "# ", 1);
    std::fs::write(&path, same).unwrap();
    let words = run();
    assert!(!words.contains("missed"), "{words}");
    assert!(!words.contains(remark), "{words}");
}
