//! Tests of printed forces of joints and tie rods under loads, against independent reference values with 120 digits
//! (`tests/data/reference/elasto`).

use super::support::elastic;
use super::{case, design_load, number, points};
use serde_json::Value;

/// Cases without force curves of bushings and without static angles.
const CASES: [&str; 3] = ["double_wishbone", "double_wishbone_free", "macpherson"];

/// Numbers of a list. Missing numbers are 0.
fn numbers(list: &Value, count: usize) -> Vec<f64> {
    let at = |k: usize| list.get(k).map_or(0.0, number);
    (0..count).map(at).collect()
}

/// Text of a case up to its elastic parts.
fn text(case: &Value) -> String {
    let mut text = format!(
        "[suspension]\ntopology = {}\n[suspension.hardpoints]\n",
        case["topology"]
    );
    for (name, point) in case["hardpoints"].as_object().unwrap() {
        text += &format!("{name} = {:?}\n", numbers(point, 3));
    }
    let spring = &case["spring"];
    let [force, rate] = ["force", "rate"].map(|key| number(&spring[key]));
    text += &format!(
        "[wheel]\nradius = {:?}\n[spring]\nforce = {force:?}\nrate = {rate:?}\n",
        number(&case["radius"])
    );
    let stop = &spring["bump_stop"];
    if stop.is_object() {
        text += &format!(
            "[bump_stop]\ngap = {:?}\nforce_curve = {:?}\n",
            number(&stop["gap"]),
            points(&stop["force_curve"])
        );
    }
    text += &format!("[compliance]\nrelaxed = {}\n", case["relaxed"]);
    let parts = |key: &str| case[key].as_object().into_iter().flatten();
    for (name, stiffness) in parts("bushings").chain(parts("mount")) {
        text += &format!(
            "[bushings.{name}]\nstiffness = {:?}\n",
            numbers(stiffness, 6)
        );
        if !case["preload"][name].is_null() {
            text += &format!("preload = {:?}\n", numbers(&case["preload"][name], 6));
        }
    }
    for (name, rate) in parts("links") {
        text += &format!("[links.{name}]\naxial_stiffness = {:?}\n", number(rate));
    }
    text
}

/// Forces of ball joints on the carrier and the tension of the tie rod equal the reference. The test uses the states whose
/// loads act at the contact point. They hold the wheel height, or the vertical force is a part of the load.
#[test]
fn forces_of_joints_are_those_of_the_reference() {
    let mut compared = 0;
    for name in CASES {
        let case = case(name);
        let names = case["names"]["values"].as_array().unwrap();
        for (k, state) in case["states"].as_array().unwrap().iter().enumerate() {
            let load = &state["load"];
            let further = ["side", "trail", "centre", "moment"];
            if further.iter().any(|key| !load[key].is_null()) {
                continue;
            }
            let mut force = numbers(&load["contact"], 3);
            let hold = if load["travel"].is_null() {
                force[2] += load["on_design_load"].as_f64().unwrap_or(0.0) * design_load(&case);
                ""
            } else {
                force[2] = 0.0;
                ", hold = \"wheel_height\""
            };
            let [travel, rack] = ["travel", "rack"].map(|key| load[key].as_f64().unwrap_or(0.0));
            let study = elastic(&format!(
                "{}[motion]\ntravel = [{travel:?}]\nrack = [{rack:?}]\n[outputs]\ncharacteristics = [\"toe\"]\n\
                 loads = [{{ name = \"x\", at = \"contact_point\", force = {force:?}{hold} }}]\n",
                text(&case)
            ));
            let curves = study.curves().unwrap();
            for (value, expected) in names.iter().zip(state["values"].as_array().unwrap()) {
                let value = value.as_str().unwrap();
                let member = match value.split_once("_ball_joint_force_") {
                    Some((joint, axis)) => format!("{joint}_ball_joint_{axis}"),
                    None if value == "tie_rod_tension" => "tie_rod".to_owned(),
                    None => continue,
                };
                let column = format!("x_{member}_N");
                let place = curves.columns.iter().position(|c| c.name == column);
                let found = curves.stations[0].value(place.expect(&column)).unwrap();
                let off = (found - number(expected)).abs();
                // The largest measured error is 2e-10 N.
                assert!(off < 1e-8, "{name} {k} {value}: {found} {expected}");
                compared += 1;
            }
        }
    }
    // Five states. A wheel has two joints and a tie rod, or one joint and a tie rod for the strut.
    assert_eq!(compared, 5 * (7 + 7 + 4));
}
