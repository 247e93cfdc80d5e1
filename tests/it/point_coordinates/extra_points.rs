//! Tests of points of interest on every body, in both formulations, against reference values of 110 digits.

use super::{bound, number, reference, size, strut, vector};
use hardpoint::attia::Drive;
use hardpoint::attia::Moving;
use hardpoint::attia::PointCoordinates;
use hardpoint::attia::StrutPoints;
use hardpoint::curves::{Curves, curves};
use hardpoint::number::Vector3;
use hardpoint::plan::Plan;
use hardpoint::study::Study;
use serde_json::Value;
use std::path::Path;

const HARDPOINTS: [(&str, &str); 10] = [
    ("lower_arm_front", "p1"),
    ("lower_arm_rear", "p2"),
    ("tie_rod_inner", "p3"),
    ("strut_top", "p4"),
    ("lower_ball_joint", "p5"),
    ("strut_lower", "p6"),
    ("strut_upper", "p7"),
    ("tie_rod_outer", "p8"),
    ("wheel_centre", "p10"),
    ("spindle_inner", "p11"),
];

/// Spring seat on the lower arm. It lies neither on the arm's axis nor in the arm's plane.
const SEAT: Vector3<f64> = Vector3::new(-0.02, 0.56, 0.17);

/// Study of the road car at these travels, with the reference's extra points.
fn study(case: &Value, travels: &[f64], formulation: &str) -> Study {
    let coordinates = |name: &str| {
        let p = vector(&case["hardpoints"][name]);
        format!("{:?}", p.to_array())
    };
    let mut text = "[suspension]\ntopology = \"macpherson\"\nlength_unit = \"m\"\n\
                    [suspension.hardpoints]\n"
        .to_owned();
    for (name, point) in HARDPOINTS {
        text += &format!("{name} = {}\n", coordinates(point));
    }
    text += "[suspension.extra_points]\n";
    for (name, body, position) in [
        ("rod_point", "strut_rod", coordinates("p9")),
        ("hub", "knuckle", coordinates("p11")),
        ("seat", "lower_arm", format!("{:?}", SEAT.to_array())),
        ("tower", "chassis", coordinates("p4")),
    ] {
        text += &format!("{name} = {{ body = {body:?}, position = {position} }}\n");
    }
    text += &format!(
        "[motion]\ntravel = {travels:?}\n[solver]\nformulation = {formulation:?}\n[outputs]\n\
         points = [\"rod_point\", \"hub\", \"seat\", \"tower\"]\norder = \"acceleration\"\n"
    );
    Study::from_text("extra.toml", &text, Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
}

/// Position of a point with its first and second derivatives, from the columns.
fn point(curves: &Curves, station: usize, name: &str) -> [Vector3<f64>; 3] {
    [0, 1, 2].map(|order| {
        let component = |axis: &str| {
            let output = format!("{name}_{axis}");
            let of = |c: &hardpoint::curves::Column| c.output == output && c.order == order;
            let column = curves.columns.iter().position(of).unwrap();
            curves.stations[station].values[column].unwrap()
        };
        Vector3::new(component("x"), component("y"), component("z"))
    })
}

/// Position, velocity and acceleration of a point of the lower arm. The point turns about the line from point 1 to
/// point 2 like point 5 of the reference.
fn arm_point(case: &Value, state: &Value, designed: Vector3<f64>) -> [Vector3<f64>; 3] {
    let at = |name: &str| vector(&case["hardpoints"][name]);
    let (p1, axis) = (at("p1"), (at("p2") - at("p1")).normalised());
    let across = |p: Vector3<f64>| (p - p1) - axis * axis.dot(p - p1);
    let of_five = |key: &str| vector(&state[key]["p5"]);
    let (before, now) = (across(at("p5")), across(of_five("positions")));
    let inverse = 1.0 / before.norm_squared();
    let (cosine, sine) = (
        before.dot(now) * inverse,
        axis.dot(before.cross(now)) * inverse,
    );
    let speed = |v: Vector3<f64>| axis.dot(now.cross(v)) * inverse;
    let (first, second) = (speed(of_five("d1")), speed(of_five("d2")));
    let lever = across(designed);
    let turned = lever * cosine + axis.cross(lever) * sine;
    [
        designed - lever + turned,
        axis.cross(turned) * first,
        axis.cross(turned) * second - turned * (first * first),
    ]
}

#[test]
fn extra_points_on_every_body_move_as_the_reference_says() {
    let case = reference("nominal");
    let still = |state: &&Value| number(&state["drive"]["rack"]) == 0.0;
    let states = case["states"].as_array().unwrap();
    let states: Vec<&Value> = states
        .iter()
        .filter(|s| s["drive"]["kind"] == "travel")
        .filter(still)
        .collect();
    let travels: Vec<f64> = states
        .iter()
        .map(|s| number(&s["drive"]["value"]))
        .collect();
    assert!(travels.len() > 20);
    let equations =
        PointCoordinates::new(&strut(&case), StrutPoints::Spread, Drive::Travel).unwrap();
    hardpoint::attia::register();
    for formulation in ["knuckle_pose", "point_coordinates"] {
        let study = study(&case, &travels, formulation);
        let curves = curves(study.wheel(), &Plan::of(study.one_wheel().unwrap())).unwrap();
        equations.for_each_pose(&equations.design(), &travels, &mut |station, pose| {
            let (pose, state) = (pose.unwrap(), states[station]);
            let by_order =
                |name: &str| ["positions", "d1", "d2"].map(|key| vector(&state[key][name]));
            let zero = Vector3::new(0.0, 0.0, 0.0);
            let tower = [vector(&case["hardpoints"]["p4"]), zero, zero];
            for (name, expected) in [
                ("rod_point", by_order("p9")),
                ("hub", by_order("p11")),
                ("seat", arm_point(&case, state, SEAT)),
                ("tower", tower),
            ] {
                let found = point(&curves, station, name);
                for order in 0..3 {
                    let of_all = ["p5", "p6", "p7", "p8", "p10"].map(|p| by_order(p)[order]);
                    let largest = size(&Moving::from(of_all));
                    let bound = bound(&equations, pose, order, largest);
                    let error = (found[order] - expected[order]).norm();
                    assert!(
                        error < bound,
                        "{formulation}, {name}, order {order}: {error:e}, {bound:e}"
                    );
                }
            }
        });
    }
}
