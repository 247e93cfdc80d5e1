//! Tests of every state of `tests/data/reference/car/road_car.json`, which an independent program solved at 90 digits.

use super::{car, case, number, reference};
use hardpoint::car::{AxleParameter, BodyParameter, CarMember, CarQuantity, CarSolver, Parameter};
use serde_json::Value;
use std::collections::HashMap;

/// Names of the reference that differ from those of the program.
const RENAMED: [(&str, &str); 12] = [
    ("roll_stiffness", "body_roll_stiffness"),
    (
        "roll_stiffness_distribution",
        "body_roll_stiffness_distribution",
    ),
    (
        "lateral_load_transfer_distribution_gradient",
        "lateral_load_transfer_distribution_local",
    ),
    ("steer_by_ay_front", "roll_steer_gradient_front"),
    ("steer_by_ay_rear", "roll_steer_gradient_rear"),
    ("steer_by_ax_front", "pitch_steer_gradient_front"),
    ("steer_by_ax_rear", "pitch_steer_gradient_rear"),
    ("understeer_by_steer", "roll_understeer"),
    (
        "front_left_camber_to_road_by_ay",
        "front_left_camber_gradient",
    ),
    (
        "front_right_camber_to_road_by_ay",
        "front_right_camber_gradient",
    ),
    (
        "rear_left_camber_to_road_by_ay",
        "rear_left_camber_gradient",
    ),
    (
        "rear_right_camber_to_road_by_ay",
        "rear_right_camber_gradient",
    ),
];

/// Program's name for a value of the reference.
fn renamed(name: &str) -> &str {
    let known = RENAMED.iter().find(|(theirs, _)| *theirs == name);
    known.map_or(name, |(_, ours)| ours)
}

/// Scale of the error of a value.
fn scale(name: &str, value: f64) -> f64 {
    let typical =
        if name.contains("percent") || name.contains("distribution") || name.contains("anti_") {
            100.0
        } else if name.ends_with("_stiffness") {
            1e7
        } else if name == "energy" {
            // The sum of the components can have either sign; its scale is a wheel load times a travel.
            4000.0 * 25.0
        } else if ["load", "force", "torque", "downforce", "drag"]
            .iter()
            .any(|part| name.contains(part))
        {
            4000.0
        } else if ["roll", "pitch"].contains(&name)
            || [
                "steer",
                "toe",
                "camber",
                "gradient",
                "inclination",
                "coefficient",
                "jacking",
                "share",
                "friction",
                "frequency",
            ]
            .iter()
            .any(|part| name.contains(part))
        {
            1.0
        } else {
            300.0
        };
    value.abs().max(typical)
}

/// The texts of a list.
fn texts(list: &Value) -> Vec<&str> {
    let list = list.as_array().unwrap().iter();
    list.map(|text| text.as_str().unwrap()).collect()
}

/// Results of a car, by name.
fn quantities() -> HashMap<String, CarQuantity> {
    let all = CarQuantity::all().into_iter();
    all.map(|quantity| (quantity.name(), quantity)).collect()
}

#[test]
fn every_value_of_every_state_agrees() {
    let file = reference();
    let car = car(&file);
    let (names, ours) = (texts(&file["names"]), quantities());
    let mut solver = CarSolver::new(&car).unwrap();
    let mut compared = 0;
    let mut worst: Vec<(f64, String)> = Vec::new();
    let mut unknown: Vec<&str> = Vec::new();
    for state in file["states"].as_array().unwrap() {
        let case = case(&state["case"]);
        let found = solver
            .solve(&case)
            .unwrap_or_else(|e| panic!("{}: {e:?}", case.name));
        let places = ["front_left", "front_right", "rear_left", "rear_right"];
        let lifted: Vec<&str> = (0..4)
            .filter(|k| found.lifted[*k])
            .map(|k| places[k])
            .collect();
        let expected = texts(&state["lifted"]);
        assert_eq!(lifted, expected, "{}", case.name);
        let solved = solver.solved(&case, &found).unwrap();
        for (name, value) in names.iter().zip(state["values"].as_array().unwrap()) {
            let expected = number(value);
            let Some(quantity) = ours.get(renamed(name)) else {
                unknown.push(name);
                continue;
            };
            if expected.is_nan() {
                continue;
            }
            let value = quantity.evaluate(&solved);
            let error = (value - expected).abs() / scale(name, expected);
            compared += 1;
            worst.push((
                error,
                format!("{} {name}: {value:e} {expected:e}", case.name),
            ));
        }
    }
    unknown.sort();
    unknown.dedup();
    worst.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (error, text) in worst.iter().take(60) {
        println!("{error:e} {text}");
    }
    println!("{compared} compared; not here: {unknown:?}");
    let (error, text) = &worst[0];
    assert!(*error < 1e-12, "{error:e} {text}");
    assert!(compared > 1800);
}

/// Forces in links, rods and struts of every state agree with those that the reference derives from free bodies.
#[test]
fn every_member_load_agrees() {
    let file = reference();
    let car = car(&file);
    let names = texts(&file["names"]);
    let members = CarMember::all(&car);
    let mut solver = CarSolver::new(&car).unwrap();
    let mut worst: Vec<(f64, String)> = Vec::new();
    for state in file["states"].as_array().unwrap() {
        let case = case(&state["case"]);
        let found = solver.solve(&case).unwrap();
        let forces = solver.members(&case, &found).unwrap();
        let forces = forces.iter().flat_map(|wheel| &wheel.forces);
        for (member, force) in members.iter().zip(forces) {
            let label = member.label();
            let Some(place) = names.iter().position(|name| *name == label) else {
                continue;
            };
            let expected = number(&state["values"][place]);
            let error = (force - expected).abs() / expected.abs().max(4000.0);
            let text = format!("{} {label}: {force} {expected}", case.name);
            worst.push((error, text));
        }
    }
    worst.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (error, text) = &worst[0];
    println!("{} compared, worst {error:e} {text}", worst.len());
    // 12 states with 24 to 26 members.
    assert!(worst.len() >= 12 * 24, "{}", worst.len());
    assert!(*error < 1e-12, "{error:e} {text}");
}

/// Derivative with respect to one parameter or one hardpoint coordinate, taken from `gradient`. The reference's name
/// `path` selects the parameter or coordinate.
fn derivative(
    car: &hardpoint::car::Car,
    gradient: &hardpoint::car::CarGradient,
    path: &str,
) -> f64 {
    let parts: Vec<&str> = path.split('.').collect();
    let axle = match parts[0] {
        "front" => 0,
        _ => 1,
    };
    let parameter = |own: AxleParameter| gradient.parameters[Parameter::Axle(axle, own).place()];
    let body = |own: BodyParameter| gradient.parameters[Parameter::Body(own).place()];
    match parts[1..] {
        ["points", name, coordinate] => {
            let id = car.axles[axle].left.mechanism.point(name).unwrap();
            gradient.hardpoints[axle][id.0].to_array()[coordinate.parse::<usize>().unwrap()]
        }
        ["spring", "rate"] => parameter(AxleParameter::SpringRate),
        ["spring", "force"] => parameter(AxleParameter::SpringForce),
        ["bar", "rate"] => parameter(AxleParameter::BarRate),
        ["tyre", "rate"] => parameter(AxleParameter::TyreRate),
        ["radius"] => parameter(AxleParameter::Radius),
        // The reference varies the unsprung mass of each wheel, the program that of the axle.
        ["unsprung_mass"] => 2.0 * parameter(AxleParameter::UnsprungMass),
        ["offset", "0"] => parameter(AxleParameter::OffsetX),
        ["sprung_mass"] => body(BodyParameter::Mass),
        ["sprung_cg", "0"] => body(BodyParameter::CgX),
        ["sprung_cg", "1"] => body(BodyParameter::CgY),
        ["sprung_cg", "2"] => body(BodyParameter::CgZ),
        ["brake_share_front"] => body(BodyParameter::BrakeShareFront),
        _ => panic!("{path}"),
    }
}

#[test]
fn every_derivative_agrees() {
    let file = reference();
    let car = car(&file);
    let (names, ours) = (texts(&file["names"]), quantities());
    let mut solver = CarSolver::new(&car).unwrap();
    let mut worst: Vec<(f64, String)> = Vec::new();
    for state in file["states"].as_array().unwrap() {
        let Some(derivatives) = state["sens"].as_object() else {
            continue;
        };
        let case = case(&state["case"]);
        let found = solver.solve(&case).unwrap();
        let known: Vec<(usize, CarQuantity)> = names
            .iter()
            .enumerate()
            .filter_map(|(k, name)| Some((k, *ours.get(renamed(name))?)))
            .collect();
        let quantities: Vec<CarQuantity> = known.iter().map(|(_, q)| *q).collect();
        let gradients = solver.gradients(&case, &found, &quantities).unwrap();
        for (path, row) in derivatives {
            for ((k, _), gradient) in known.iter().zip(&gradients) {
                let expected = number(&row[*k]);
                if expected.is_nan() {
                    continue;
                }
                let found = derivative(&car, gradient, path);
                // Scale of the error: typical size of the value divided by the typical size of the parameter (100 for a
                // length).
                let size = scale(names[*k], gradient.value)
                    / match path.as_str() {
                        p if p.ends_with("bar.rate") => 5e5,
                        p if p.contains("tyre.rate") => 200.0,
                        p if p.contains("spring.rate") => 30.0,
                        p if p.contains("spring.force") => 4000.0,
                        p if p.contains("sprung_mass") => 1000.0,
                        p if p.contains("brake_share") => 1.0,
                        _ => 100.0,
                    };
                let error = (found - expected).abs() / expected.abs().max(size);
                worst.push((
                    error,
                    format!(
                        "{} d {} / d {path}: {found:e} {expected:e}",
                        case.name, names[*k]
                    ),
                ));
            }
        }
    }
    worst.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (error, text) in worst.iter().take(60) {
        println!("{error:e} {text}");
    }
    println!("{} compared", worst.len());
    let (error, text) = &worst[0];
    assert!(*error < 1e-10, "{error:e} {text}");
    assert!(worst.len() > 8000);
}
