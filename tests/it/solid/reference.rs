//! Tests of axles on four links, and on three links with a Panhard rod, against an independent solution with 90 digits.

use super::{STILL, axle, case, points_of, study_of};
use crate::support::number;
use hardpoint::axle::{
    AxleQuantity as A, AxleSolver, AxleState, Motion, Placement, Quantity, Read,
    WheelQuantity as W, axle_curves,
};
use hardpoint::characteristics::Characteristic as C;
use hardpoint::model::Side::{self, Left, Right};
use hardpoint::number::Vector3;
use serde_json::Value;

const CASES: [&str; 2] = ["solid_four_link", "solid_three_link_panhard"];

/// Quantities with their names in the reference, and the scale of the error: a length, or 1.
fn quantities() -> Vec<(String, Quantity, f64)> {
    let mut all = Vec::new();
    for (side, name) in [(Left, "left"), (Right, "right")] {
        let mut add = |stem: &str, q: Quantity| all.push((format!("{name}_{stem}"), q, 1.0));
        add("steer", Quantity::Wheel(side, W::Steer));
        add("camber", Quantity::Corner(side, C::Camber));
        add("camber_to_road", Quantity::Wheel(side, W::CamberToRoad));
    }
    let length = 1e3;
    for (name, q, scale) in [
        ("mean_steer", A::MeanSteer, 1.0),
        ("axle_steer", A::AxleSteer, 1.0),
        ("axle_lateral", A::AxleLateral, length),
        ("axle_longitudinal", A::AxleLongitudinal, length),
        ("pinion_angle", A::PinionAngle, 1.0),
        ("track", A::Track, length),
        ("roll_centre_height", A::RollCentreHeight, length),
        ("roll_centre_lateral", A::RollCentreLateral, length),
        ("force_roll_centre_height", A::ForceRollCentreHeight, length),
        ("jacking_force_ratio", A::JackingForceRatio, 1.0),
        ("anti_squat", A::RigidAntiSquat, 100.0),
        ("anti_lift", A::RigidAntiLift, 100.0),
        ("drive_load_transfer", A::DriveLoadTransfer, 1.0),
    ] {
        all.push((name.to_owned(), Quantity::Axle(q), scale));
    }
    all
}

/// Returns the value with this name from an array whose order is that of the reference case's names.
fn named(case: &Value, values: &Value, name: &str) -> Option<f64> {
    let names = case["names"].as_array().unwrap();
    let index = names.iter().position(|n| n == name)?;
    Some(number(&values[index]))
}

fn placement(state: &Value) -> Placement {
    Placement::Roll {
        heave: state["heave"].as_f64().unwrap(),
        roll: state["roll_deg"].as_f64().unwrap().to_radians(),
        rack: 0.0,
    }
}

/// Positions of wheel centre and contact point of a side, in the vehicle's axes.
fn points(read: &Read, side: Side) -> [(&'static str, Vector3<f64>); 2] {
    let wheel = read.state.wheel(side);
    let outward = side.sign();
    let in_vehicle = |p: Vector3<f64>| Vector3::new(p.x, outward * p.y, p.z);
    use hardpoint::axle::WheelParts as _;
    [
        ("wheel_centre", in_vehicle(wheel.reading.centre())),
        ("contact_point", in_vehicle(wheel.contact_point())),
    ]
}

struct Worst(f64, String);

impl Worst {
    fn note(&mut self, found: f64, expected: f64, scale: f64, what: impl FnOnce() -> String) {
        let error = (found - expected).abs() / expected.abs().max(scale);
        // This form of the comparison makes NaN the largest error.
        if error.is_nan() || error > self.0 {
            *self = Worst(error, format!("{}: {found} {expected}", what()));
        }
    }
}

fn evaluate(quantity: Quantity, state: &AxleState<f64>) -> f64 {
    quantity.value(state).unwrap_or(f64::NAN)
}

/// Values agree with the reference to 1e-12 of their scale. The test covers both paths of the drive torque (shafts and
/// carrier).
#[test]
fn every_value_is_the_reference_s() {
    for name in CASES {
        let case = case(name);
        let text = study_of(&case, STILL);
        let by_shafts = text.replace("\"carrier\"", "\"shafts\"");
        let (study, by_shafts) = (axle(&text), axle(&by_shafts));
        let quantities = quantities();
        let wanted: Vec<_> = quantities.iter().map(|(_, q, _)| *q).collect();
        let mut solver = AxleSolver::<2>::new(&study.axle, &wanted, false).unwrap();
        let mut of_shafts = AxleSolver::<2>::new(&by_shafts.axle, &wanted, false).unwrap();
        let mut worst = Worst(0.0, String::new());
        assert_eq!(case["states"].as_array().unwrap().len(), 7);
        for state in case["states"].as_array().unwrap() {
            let label = format!("{name} {} {}", state["roll_deg"], state["heave"]);
            let placed = solver.place(&placement(state)).expect(&label);
            let read = solver.read(&placed).expect(&label);
            let expected = |name: &str| named(&case, &state["values"], name).expect(name);
            let mut note = |name: &str, found: f64, scale: f64| {
                worst.note(found, expected(name), scale, || format!("{label} {name}"));
            };
            note("roll", placed.roll, 1.0);
            for (side, word) in [(Left, "left"), (Right, "right")] {
                note(
                    &format!("travel_{word}"),
                    placed.travels[side as usize],
                    1e3,
                );
                for (point, found) in points(&read, side) {
                    for (axis, found) in ["x", "y", "z"].into_iter().zip(found.to_array()) {
                        note(&format!("{word}_{point}_{axis}"), found, 1e3);
                    }
                }
            }
            for (name, quantity, scale) in &quantities {
                note(name, evaluate(*quantity, &read.state), *scale);
            }
            let track = expected("track");
            let [height, ratio] = [A::ForceRollCentreHeight, A::JackingForceRatio]
                .map(|q| evaluate(Quantity::Axle(q), &read.state));
            note("left_side_force_load", 0.5 * ratio - height / track, 1.0);
            note("right_side_force_load", 0.5 * ratio + height / track, 1.0);
            let placed = of_shafts.place(&placement(state)).expect(&label);
            let read = of_shafts.read(&placed).expect(&label);
            let by_shafts = evaluate(Quantity::Axle(A::RigidAntiSquat), &read.state);
            note("anti_squat_shafts", by_shafts, 100.0);
        }
        println!("{name}: {:e} {}", worst.0, worst.1);
        assert!(worst.0 < 1e-12, "{name}: {:e} {}", worst.0, worst.1);
    }
}

/// Derivatives along roll and heave agree with the reference to 1e-10. This includes derivatives of quantities made of
/// velocities.
#[test]
fn derivatives_along_motions_are_the_reference_s() {
    for name in CASES {
        let case = case(name);
        let study = axle(&study_of(&case, STILL));
        let quantities = quantities();
        let wanted: Vec<_> = quantities.iter().map(|(_, q, _)| *q).collect();
        let mut solver = AxleSolver::<3>::new(&study.axle, &wanted, false).unwrap();
        let mut worst = Worst(0.0, String::new());
        for state in case["states"].as_array().unwrap() {
            let label = format!("{name} {} {}", state["roll_deg"], state["heave"]);
            let placed = solver.place(&placement(state)).expect(&label);
            let read = solver.read(&placed).expect(&label);
            for (suffix, motion) in [("by_roll", Motion::Roll), ("by_heave", Motion::Heave)] {
                let moving = read.state.moving(motion);
                // One radian of roll is a large motion, so derivatives of lengths per radian have the usual size of
                // lengths.
                let per = if suffix == "by_roll" { 1.0 } else { 1e-3 };
                let mut compared = 0;
                for (name, quantity, scale) in &quantities {
                    let name = format!("{name}_{suffix}");
                    let Some(expected) = named(&case, &state["values"], &name) else {
                        continue;
                    };
                    compared += 1;
                    let found = quantity.evaluate(&moving)[1];
                    worst.note(found, expected, scale * per, || format!("{label} {name}"));
                }
                assert!(compared >= 9, "{compared} derivatives {suffix}");
            }
        }
        println!("{name}: {:e} {}", worst.0, worst.1);
        assert!(worst.0 < 1e-10, "{name}: {:e} {}", worst.0, worst.1);
    }
}

/// Gradients with respect to points that exist once on the axle agree with the reference to 1e-10.
#[test]
fn gradients_by_single_points_are_the_reference_s() {
    let case = case("solid_three_link_panhard");
    let study = axle(&study_of(&case, STILL));
    let quantities = quantities();
    let wanted: Vec<_> = quantities.iter().map(|(_, q, _)| *q).collect();
    let mut solver = AxleSolver::<3>::new(&study.axle, &wanted, false).unwrap();
    let mechanism = &study.axle.left.mechanism;
    let mut worst = Worst(0.0, String::new());
    let mut compared = 0;
    for (key, values) in case["sens"].as_object().unwrap() {
        let words: Vec<&str> = key.split([' ', '.']).collect();
        let [point, axis, _, _, roll, _, heave] = words[..] else {
            panic!("{key}");
        };
        let names = points_of(&case);
        let Some((ours, _)) = names.iter().find(|(_, theirs)| *theirs == point) else {
            continue;
        };
        let id = mechanism.point(ours).unwrap();
        let rigid = mechanism.rigid_axle.as_ref().unwrap();
        if !rigid.singles.contains(&id) {
            continue;
        }
        let axis: usize = axis.parse().unwrap();
        let placement = Placement::Roll {
            heave: heave.parse().unwrap(),
            roll: roll.parse::<f64>().unwrap().to_radians(),
            rack: 0.0,
        };
        let placed = solver.place(&placement).unwrap();
        solver
            .gradients(&placed, &wanted, |number, [left, right]| {
                let (name, _, scale) = &quantities[number];
                let expected = named(&case, values, name).unwrap();
                assert_eq!(right[id.0], Vector3::new(0.0, 0.0, 0.0));
                let found = left[id.0].to_array()[axis];
                worst.note(found, expected, scale * 1e-3, || format!("{key} {name}"));
                compared += 1;
            })
            .unwrap();
    }
    assert_eq!(compared, 6 * quantities.len());
    println!("{:e} {}", worst.0, worst.1);
    assert!(worst.0 < 1e-10, "{:e} {}", worst.0, worst.1);
}

/// Names of links and springs in the reference and in the columns of the program.
const MEMBERS: [(&str, &str); 8] = [
    ("lower_left", "left_lower_link"),
    ("lower_right", "right_lower_link"),
    ("upper_left", "left_upper_link"),
    ("upper_right", "right_upper_link"),
    ("upper", "upper_link"),
    ("panhard", "panhard"),
    ("left_spring", "left_spring"),
    ("right_spring", "right_spring"),
];

/// Forces of links and springs agree with the reference. Its loads act on both wheels. The program prints the forces for the
/// load on each wheel, so their sum is compared. The bound is 50 rounding errors of the largest force, 1e4 N.
#[test]
fn member_forces_are_the_reference_s() {
    let mut compared = 0;
    for name in CASES {
        let case = case(name);
        let loads = case["loads"].as_object().unwrap();
        let entries = loads.iter().map(|(name, load)| {
            let force = [0, 1, 2].map(|i| load["force"][i].as_f64().unwrap());
            format!(
                "{{ name = \"{name}\", at = {}, force = {force:?} }}",
                load["at"]
            )
        });
        let entries = entries.collect::<Vec<_>>().join(", ");
        for state in case["states"].as_array().unwrap() {
            let [roll, heave] = ["roll_deg", "heave"].map(|key| state[key].as_f64().unwrap());
            let further = format!(
                "[motion]\nroll = [{roll:?}]\nheave = [{heave:?}]\n[outputs]\ncharacteristics = [\"toe\"]\nloads = [{entries}]\n"
            );
            let study = axle(&study_of(&case, &further));
            let curves = axle_curves(&study.axle, &study.plan).unwrap().curves;
            let force = |column: String| {
                let place = curves.columns.iter().position(|c| c.name == column);
                curves.stations[0].value(place.expect(&column)).unwrap()
            };
            for load in loads.keys() {
                for (theirs, ours) in MEMBERS {
                    let Some(expected) =
                        named(&case, &state["values"], &format!("{load}_{theirs}"))
                    else {
                        continue;
                    };
                    let found: f64 = ["left", "right"]
                        .map(|side| force(format!("{side}_{load}_{ours}_N")))
                        .iter()
                        .sum();
                    let off = (found - expected).abs();
                    assert!(
                        off < 1e-10,
                        "{name} {roll} {heave} {load} {theirs}: {found} {expected}"
                    );
                    compared += 1;
                }
            }
        }
    }
    // Four links and two springs, three loads, seven states, two axles.
    assert_eq!(compared, 6 * 3 * 7 * 2);
}
