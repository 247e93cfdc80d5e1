//! Tests of the units of margins and prices. A margin has the unit in which the study writes the limit. A price is the
//! change of the misfit per this unit of the limit. The output names the units.

use hardpoint::optimise::Control;
use hardpoint::report::{TuningSummary, brief};
use hardpoint::study::Study;
use serde_json::Value;
use std::path::Path;

/// Strut with constraints in every unit. Lengths in millimetres are multiplied by `per`.
fn strut(unit: &str, per: f64) -> Study {
    let point = |v: [f64; 3]| format!("{:?}", v.map(|c| c * per));
    let length = |v: f64| format!("{:?}", v * per);
    let rate = |v: f64| format!("{:?}", v / per);
    let text = format!(
        r#"
[suspension]
topology = "macpherson"
length_unit = "{unit}"
[suspension.hardpoints]
lower_arm_front = {}
lower_arm_rear = {}
lower_ball_joint = {}
strut_top = {}
strut_lower = {}
tie_rod_inner = {}
tie_rod_outer = {}
wheel_centre = {}
spindle_inner = {}
[wheel]
radius = {}
[motion]
travel = [{}, {}, 0.0, {}, {}]
[outputs]
characteristics = ["toe"]
loads = [{{ name = "kerb", at = "wheel_centre", force = [-1500.0, 0.0, 6000.0] }}]
[optimise]
starts = 1
good_enough = 0.0
variables = [
  {{ hardpoint = "tie_rod_outer", axis = "z", range = [{}, {}] }},
  {{ hardpoint = "lower_ball_joint", axis = "y", range = [{}, {}] }},
  {{ hardpoint = "lower_ball_joint", axis = "z", range = [{}, {}] }},
]
targets = [
  {{ characteristic = "toe", points = [[{}, 0.5], [{}, -0.5]], tolerance = 0.05 }},
  {{ characteristic = "roll_centre_height", at = 0.0, value = {}, tolerance = {} }},
]
constraints = [
  {{ point = "tie_rod_outer", inside = {{ sphere = {{ centre = {}, radius = {} }} }}, at = "design" }},
  {{ length = "tie_rod", between = [{}, {}] }},
  {{ characteristic = "bump_steer", between = [{}, {}] }},
  {{ characteristic = "camber", between = [-6.0, 6.0] }},
  {{ characteristic = "motion_ratio", at_least = 0.5 }},
  {{ load = "kerb_tie_rod", between = [-9000.0, 9000.0] }},
  {{ articulation = "lower_ball_joint", at_most = 30.0 }},
]
"#,
        point([120.0, 360.0, 195.0]),
        point([-260.0, 350.0, 205.0]),
        point([5.0, 705.0, 190.0]),
        point([-35.0, 575.0, 850.0]),
        point([-11.0, 623.0, 370.0]),
        point([-110.0, 330.0, 243.0]),
        point([-130.0, 690.0, 240.0]),
        point([0.0, 760.0, 300.0]),
        point([-0.2, 660.0, 299.1]),
        length(300.0),
        length(-40.0),
        length(-20.0),
        length(20.0),
        length(40.0),
        length(-20.0),
        length(20.0),
        length(-20.0),
        length(20.0),
        length(-20.0),
        length(20.0),
        length(-40.0),
        length(40.0),
        length(90.0),
        length(2.0),
        point([-130.0, 690.0, 240.0]),
        length(4.0),
        length(340.0),
        length(400.0),
        rate(-0.2),
        rate(0.2),
    );
    Study::from_text("strut.toml", &text, Path::new(".")).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn summary(study: &Study) -> (Value, String) {
    let optimise = study.optimise.as_ref().unwrap();
    let tuning = study.tune(Control::default()).unwrap();
    let summary = TuningSummary::of(study, optimise, &tuning, None);
    let table = summary.constraints_table().unwrap().text(200);
    (serde_json::to_value(&summary).unwrap(), table)
}

fn near_to(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * (1.0 + b.abs())
}

#[test]
fn margins_and_prices_are_in_the_study_s_unit() {
    let (wanted, _) = summary(&strut("mm", 1.0));
    let priced = wanted["constraints"].as_array().unwrap().iter();
    assert!(
        priced.filter(|c| !c["price"].is_null()).count() > 0,
        "{wanted}"
    );
    for (unit, per) in [("mm", 1.0), ("in", 1.0 / 25.4), ("m", 1e-3)] {
        let (found, table) = summary(&strut(unit, per));
        let lists = [&wanted, &found].map(|summary| summary["constraints"].as_array().unwrap());
        assert_eq!(lists[0].len(), 7);
        for (number, (mm, own)) in lists[0].iter().zip(lists[1]).enumerate() {
            // Factor that converts a number of this unit from the study in millimetres.
            let (symbol, factor) = match number {
                0 | 1 => (unit.to_owned(), per),
                2 => (format!("deg/{unit}"), 1.0 / per),
                4 => ("1".to_owned(), 1.0),
                5 => ("N".to_owned(), 1.0),
                _ => ("deg".to_owned(), 1.0),
            };
            assert_eq!(own["unit"], symbol, "{own}");
            assert_eq!(own["at_unit"], unit, "{own}");
            assert_eq!(own["status"], mm["status"], "{own} {mm}");
            let number = |value: &Value| value.as_f64();
            let near =
                |a: f64, b: f64, scale: f64| (a - b).abs() <= 1e-5 * scale.abs().max(b.abs());
            let margins = [own, mm].map(|c| number(&c["margin"]).unwrap());
            assert!(near(margins[0], margins[1] * factor, factor), "{own} {mm}");
            match [own, mm].map(|c| number(&c["price"])) {
                [Some(own), Some(mm)] => assert!(near(own, mm / factor, 0.0), "{own} {mm}"),
                prices => assert_eq!(prices, [None, None]),
            }
            match [own, mm].map(|c| number(&c["at"])) {
                [Some(own), Some(mm)] => assert!(near(own, mm * per, per), "{own} {mm}"),
                places => assert_eq!(places, [None, None]),
            }
        }
        // The length of the tie rod does not change along the motion. Value, margin and limit agree.
        let tie_rod = &lists[1][1];
        assert!(tie_rod["at"].is_null(), "{tie_rod}");
        let [value, limit, margin] =
            ["value", "limit", "margin"].map(|key| tie_rod[key].as_f64().unwrap());
        assert!(near_to((value - limit).abs(), margin.abs()), "{tie_rod}");
        let is_limit = [340.0 * per, 400.0 * per]
            .iter()
            .any(|own| near_to(limit, *own));
        assert!(is_limit, "{tie_rod}");
        assert!(table.contains(&brief(value)), "{table}");
        assert!(
            table.contains("at least") || table.contains("at most"),
            "{table}"
        );
        // Regions, forces and joint angles have no single value.
        assert!(lists[1][0]["value"].is_null() && lists[1][5]["value"].is_null());
        // The table shows the travel with its unit too.
        let at = lists[1][3]["at"].as_f64().unwrap();
        let place = format!("{} {unit}", brief(at));
        assert!(table.contains(&place), "{place}: {table}");
    }
}

/// The manual's example of a planar rocker is valid in a study with a rocker, and the tuning satisfies it. The points
/// stay in one plane, although the variables alone could move them out of it.
#[test]
fn the_manual_s_planar_rocker_is_tuned() {
    let manual = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/tuning.md");
    let manual = std::fs::read_to_string(manual).unwrap();
    let example = manual
        .lines()
        .find(|line| line.starts_with("coplanar = "))
        .unwrap();
    let (example, _) = example.split_once(']').unwrap();
    let points = example.split_once('[').unwrap().1;
    assert_eq!(points.split(',').count(), 4);
    let variables = "optimise.variables=[\
        { hardpoint = \"pushrod_inner\", axis = \"x\", range = [-25.0, 25.0] }, \
        { hardpoint = \"pushrod_inner\", axis = \"y\", range = [-25.0, 25.0] }, \
        { hardpoint = \"pushrod_inner\", axis = \"z\", range = [-25.0, 25.0] }, \
        { hardpoint = \"spring_lower\", axis = \"x\", range = [-25.0, 25.0] }, \
        { hardpoint = \"spring_lower\", axis = \"y\", range = [-25.0, 25.0] }, \
        { hardpoint = \"spring_lower\", axis = \"z\", range = [-25.0, 25.0] }, \
        { hardpoint = \"drop_link_outer\", axis = \"y\", range = [-20.0, 20.0] }]";
    let constraint = format!("optimise.constraints=[{{ {example}] }}]");
    let study = super::edited("double_wishbone_rocker.toml", &[variables, &constraint]);
    let tuning = study.tune(Control::default()).unwrap();
    let best = tuning.best.unwrap();
    assert!(best.after.misfit < 0.11, "{}", best.after.misfit);
    assert!(
        best.constraints[0].margin.abs() < 1e-5,
        "{:?}",
        best.constraints
    );
}
