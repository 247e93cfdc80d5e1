//! Tests of steered axles with springs and anti-roll bar against an independent solution with 100 digits.

use super::axle;
use hardpoint::axle::{
    AxleQuantity as A, AxleSolver, AxleState, Motion, Placement, Quantity, WheelQuantity as W,
};
use hardpoint::characteristics::Characteristic as C;
use hardpoint::model::Side::{Left, Right};
use hardpoint::number::Vector3;
use serde_json::Value;

pub fn read(name: &str) -> Value {
    let path = format!(
        "{}/tests/data/reference/axle/{name}.json",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    serde_json::from_str(&text).expect("valid JSON")
}

pub fn placement(motion: &Value) -> Placement {
    let number = |key: &str| motion[key].as_f64().unwrap_or(0.0);
    let rack = number("rack");
    match motion["kind"].as_str().unwrap() {
        "roll" => Placement::Roll {
            heave: number("heave"),
            roll: number("roll_deg").to_radians(),
            rack,
        },
        kind => Placement::Travels {
            travels: [number("travel_left"), number("travel_right")],
            rack,
            on_plane: kind == "travels",
        },
    }
}

/// Quantities of the catalogue with their names in the reference, and the scale of errors: a length, or 1 for angles
/// and plain numbers.
fn quantities() -> Vec<(String, Quantity, f64)> {
    let mut all = Vec::new();
    for (side, name) in [(Left, "left"), (Right, "right")] {
        let mut add = |stem: &str, q: Quantity, scale: f64| {
            all.push((format!("{stem}_{name}"), q, scale));
        };
        add("camber", Quantity::Corner(side, C::Camber), 1.0);
        add("toe", Quantity::Corner(side, C::Toe), 1.0);
        add("motion_ratio", Quantity::Corner(side, C::MotionRatio), 1.0);
        add(
            "bar_angle",
            Quantity::Corner(side, C::AntiRollBarAngle),
            1.0,
        );
        add(
            "bar_motion_ratio",
            Quantity::Corner(side, C::AntiRollBarMotionRatio),
            1e-2,
        );
        for (stem, q, scale) in [
            ("steer", W::Steer, 1.0),
            ("camber_to_road", W::CamberToRoad, 1.0),
            ("jacking_coefficient", W::JackingCoefficient, 1.0),
            ("side_force_jacking", W::SideForceJacking, 1.0),
            ("roll_camber", W::RollCamber, 1.0),
            ("roll_camber_to_road", W::RollCamberToRoad, 1.0),
            ("roll_steer", W::WheelRollSteer, 1.0),
            ("wheel_load", W::WheelLoad, 1e4),
            ("spring_force", W::SpringForce, 1e4),
        ] {
            add(stem, Quantity::Wheel(side, q), scale);
        }
    }
    let length = 1e3;
    for (name, q, scale) in [
        ("roll_angle", A::RollAngle, 1.0),
        ("track", A::Track, length),
        ("roll_centre_height", A::RollCentreHeight, length),
        ("roll_centre_lateral", A::RollCentreLateral, length),
        ("force_roll_centre_height", A::ForceRollCentreHeight, length),
        ("jacking_force_ratio", A::JackingForceRatio, 1.0),
        ("mean_steer", A::MeanSteer, 1.0),
        ("ackermann_error_exact", A::AckermannError, 1.0),
        ("ackermann_exact", A::Ackermann, 100.0),
        ("ackermann_by_inner", A::AckermannByInner, 100.0),
        ("ackermann_by_cotangents", A::AckermannByCotangents, 100.0),
        ("turning_circle_exact", A::TurningCircle, length),
        ("steering_ratio", A::SteeringRatio, 1.0),
        ("roll_steer", A::RollSteer, 1.0),
        ("bar_torque", A::BarTorque, 1e6),
        ("roll_moment", A::RollMoment, 1e7),
        ("roll_stiffness_pads", A::RollStiffness, 1e8),
        ("roll_stiffness", A::RollStiffnessOnRoad, 1e8),
        ("roll_stiffness_at_load", A::RollStiffnessAtLoad, 1e8),
        ("ride_rate", A::RideRate, 1e2),
    ] {
        all.push((name.to_owned(), Quantity::Axle(q), scale));
    }
    all
}

/// Factor by which a quotient is less accurate than its operands.
pub(super) fn condition(name: &str, state: &AxleState<f64>) -> f64 {
    let value = |q| Quantity::Axle(q).evaluate(state);
    let jacking = [Left, Right].map(|s| Quantity::Wheel(s, W::JackingCoefficient).evaluate(state));
    match name {
        // The divisor is the sum of the jacking coefficients of both wheels. It loses digits if they have opposite
        // signs.
        n if n.starts_with("roll_centre") => {
            let sum = (jacking[0] + jacking[1]).abs();
            ((jacking[0].abs() + jacking[1].abs()) / sum)
                .powi(3)
                .max(1.0)
        }
        n if n.starts_with("ackermann") && !n.starts_with("ackermann_error") => {
            (1.0 / value(A::MeanSteer).abs()).powi(3)
        }
        n if n.starts_with("turning_circle") => (1.0 / value(A::MeanSteer).abs()).powi(2),
        _ => 1.0,
    }
}

/// Names of the numbers in the array `of` of each state, in the order of the array.
pub(super) fn names<'c>(case: &'c Value, of: &str) -> Vec<&'c str> {
    let names = case["names"][of].as_array().unwrap().iter();
    names.map(|name| name.as_str().unwrap()).collect()
}

fn number(value: &Value) -> Option<f64> {
    value.as_str().and_then(|text| text.parse().ok())
}

struct Worst(f64, String);

impl Worst {
    fn note(&mut self, error: f64, what: impl FnOnce() -> String) {
        // This form of the comparison makes NaN the largest error.
        if error.is_nan() || error > self.0 {
            *self = Worst(error, what());
        }
    }
}

#[test]
fn every_value_is_the_reference_s() {
    for name in ["macpherson_front", "double_wishbone_front"] {
        let case = read(name);
        let axle = axle(&case);
        let quantities = quantities();
        let wanted: Vec<_> = quantities.iter().map(|(_, q, _)| *q).collect();
        let mut solver = AxleSolver::<3>::new(&axle, &wanted, true).unwrap();
        let names = names(&case, "values");
        let (mut worst, mut compared) = (Worst(0.0, String::new()), 0);
        let bar_sign = if name == "macpherson_front" {
            -1.0
        } else {
            1.0
        };
        for state in case["states"].as_array().unwrap() {
            let label = state["motion"].to_string();
            let placed = solver.place(&placement(&state["motion"])).expect(&label);
            let read = solver.read(&placed).expect(&label);
            let expected = |name: &str| {
                let index = names.iter().position(|n| *n == name).unwrap();
                number(&state["values"][index])
            };
            for (i, side) in ["left", "right"].into_iter().enumerate() {
                let travel = expected(&format!("travel_{side}")).unwrap();
                worst.note((placed.travels[i] - travel).abs() / 100.0, || {
                    format!("{label} travel_{side}")
                });
            }
            for (name, quantity, scale) in &quantities {
                let Some(expected) = expected(name) else {
                    continue;
                };
                // The reference keeps both travels constant where the case gives them; the program keeps roll angle and
                // mean travel constant.
                let found = match (name.as_str(), state["motion"]["kind"].as_str()) {
                    ("steering_ratio", Some("travels")) => {
                        let by_rack = Quantity::Axle(A::MeanSteer);
                        let by_rack = by_rack.evaluate(&read.state.moving(Motion::Rack))[1];
                        Ok(std::f64::consts::TAU / (axle.setup.c_factor.unwrap() * by_rack))
                    }
                    _ => quantity.value(&read.state),
                };
                let Ok(mut found) = found else {
                    panic!("{label} {name}: {found:?}, expected {expected}");
                };
                // The reference counts lever angles positive in jounce; the program counts them positive in the
                // direction in which the drop link pushes.
                if name.starts_with("bar_") {
                    found *= bar_sign;
                }
                let size = expected.abs().max(*scale) * condition(name, &read.state);
                worst.note((found - expected).abs() / size, || {
                    format!("{label} {name}: {found} {expected}")
                });
                compared += 1;
            }
        }
        // Straight ahead, the reference has no values of the five quantities of a turn. With given travels of both wheels, it has
        // no values of eleven quantities of roll and heave.
        let missing = if name == "macpherson_front" {
            9 * 5 + 4 * 11
        } else {
            7 * 5
        };
        let states = case["states"].as_array().unwrap().len();
        assert_eq!(compared, states * quantities.len() - missing, "{name}");
        println!("{name}: {:e} {}", worst.0, worst.1);
        assert!(worst.0 < 1e-12, "{name}: {:e} {}", worst.0, worst.1);
    }
}

#[test]
fn derivatives_along_motions_are_the_reference_s() {
    for name in ["macpherson_front", "double_wishbone_front"] {
        let case = read(name);
        let axle = axle(&case);
        let quantities = quantities();
        let wanted: Vec<_> = quantities.iter().map(|(_, q, _)| *q).collect();
        let mut solver = AxleSolver::<4>::new(&axle, &wanted, true).unwrap();
        let (mut worst, mut compared) = (Worst(0.0, String::new()), 0);
        for state in case["states"].as_array().unwrap() {
            let label = state["motion"].to_string();
            let placed = solver.place(&placement(&state["motion"])).expect(&label);
            let read = solver.read(&placed).expect(&label);
            for (key, motion) in [
                ("by_roll", Motion::Roll),
                ("by_heave", Motion::Heave),
                ("by_rack", Motion::Rack),
            ] {
                if state[key].is_null() {
                    continue;
                }
                let moving = read.state.moving(motion);
                let names = names(&case, key);
                for (name, expected) in names.into_iter().zip(state[key].as_array().unwrap()) {
                    let entry = quantities.iter().find(|(n, _, _)| n == name);
                    let (Some((_, quantity, scale)), Some(expected)) = (entry, number(expected))
                    else {
                        continue;
                    };
                    let found = quantity.evaluate(&moving)[1];
                    // A radian of roll is a large motion, so derivatives per radian have the size of the values
                    // themselves. Derivatives per unit of heave or rack are about a hundredth of this size.
                    let per = if key == "by_roll" { 1.0 } else { 1e-2 };
                    let size = expected.abs().max(scale * per);
                    let size = size * condition(name, &read.state);
                    worst.note((found - expected).abs() / size, || {
                        format!("{label} {key} {name}: {found} {expected}")
                    });
                    compared += 1;
                }
            }
        }
        assert!(compared > 600, "{name}: {compared}");
        println!("{name}: {:e} {}", worst.0, worst.1);
        assert!(worst.0 < 1e-10, "{name}: {:e} {}", worst.0, worst.1);
    }
}

#[test]
fn gradients_by_hardpoints_are_the_reference_s() {
    for name in ["macpherson_front", "double_wishbone_front"] {
        let case = read(name);
        let axle = axle(&case);
        let quantities = quantities();
        let names = names(&case, "sens");
        // In the file, derivatives of roll stiffnesses have only four (on the pads of a rig) or seven (on the road)
        // correct digits. `gradients` tests these derivatives.
        let is_exact = |name: &str| !name.starts_with("roll_stiffness");
        let known = |name: &str| {
            quantities
                .iter()
                .find(|(n, _, _)| n == name && is_exact(name))
        };
        let wanted: Vec<_> = names.iter().filter_map(|n| known(n)).collect();
        let just: Vec<_> = wanted.iter().map(|(_, q, _)| *q).collect();
        let mut solver = AxleSolver::<4>::new(&axle, &just, true).unwrap();
        let mechanism = &axle.left.mechanism;
        let (mut worst, mut compared) = (Worst(0.0, String::new()), 0);
        for state in case["states"].as_array().unwrap() {
            let Some(sensitivities) = state["sens"].as_object() else {
                continue;
            };
            let label = state["motion"].to_string();
            let placed = solver.place(&placement(&state["motion"])).expect(&label);
            let read = solver.read(&placed).expect(&label);
            let mut found = vec![[Vec::new(), Vec::new()]; just.len()];
            solver
                .gradients(&placed, &just, |i, gradients| {
                    found[i] = gradients.map(|g: &[Vector3<f64>]| g.to_vec());
                })
                .expect(&label);
            for (coordinate, values) in sensitivities {
                let parts: Vec<&str> = coordinate.split('.').collect();
                let (side, point, axis) = match parts[..] {
                    [point, axis] => (None, point, axis),
                    [side, point, axis] => (Some(side), point, axis),
                    _ => panic!("{coordinate}"),
                };
                let point = mechanism.point(point).expect(point).0;
                let axis = ["x", "y", "z"].iter().position(|a| *a == axis).unwrap();
                for ((name, quantity, scale), found) in wanted.iter().zip(&found) {
                    let index = names.iter().position(|n| n == name).unwrap();
                    let Some(expected) = number(&values[index]) else {
                        continue;
                    };
                    if quantity.value(&read.state).is_err() {
                        continue;
                    }
                    let [left, right] = [0, 1].map(|w| found[w][point].to_array()[axis]);
                    // The right wheel's frame has y outboard.
                    let mirror = if axis == 1 { -1.0 } else { 1.0 };
                    let found = match side {
                        None => left + right,
                        Some("left") => left,
                        _ => right * mirror,
                    };
                    let size = expected.abs().max(scale * 1e-2) * condition(name, &read.state);
                    worst.note((found - expected).abs() / size, || {
                        format!("{label} {name} by {coordinate}: {found} {expected}")
                    });
                    compared += 1;
                }
            }
        }
        assert!(compared > 400, "{name}: {compared}");
        println!("{name}: {:e} {}", worst.0, worst.1);
        assert!(worst.0 < 1e-10, "{name}: {:e} {}", worst.0, worst.1);
    }
}
