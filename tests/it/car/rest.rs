//! Tests of cars at rest.

use super::commands::{hardpoint, text};
use crate::support::studies;
use hardpoint::car::{CarQuantity, CarRequest, CarSolver, Case};
use hardpoint::study::CarStudy;

/// The car is ten times as heavy, and its case has a tenth of the gravity. At rest its springs cannot carry it. Only the jacking
/// heave is measured from the car at rest, so only this result is unknown.
#[test]
fn only_the_jacking_heave_needs_the_car_at_rest() {
    let path = crate::support::studies().join("off_road_car.toml");
    let mut car = CarStudy::read(&path, &[]).unwrap().car;
    car.mass *= 10.0;
    let mut case = Case::at_rest("light");
    (case.ay, case.az) = (0.02, -0.9);
    case.setting.elastic_tyres = false;
    let [roll, jacking] = ["roll", "jacking_heave"].map(|name| CarQuantity::named(name)[0]);
    let mut solver = CarSolver::new(&car).unwrap();
    assert!(
        solver
            .solve(&Case {
                az: 0.0,
                ..case.clone()
            })
            .is_err()
    );
    let found = solver.solve(&case).unwrap();
    let alone = solver.gradients(&case, &found, &[roll]).unwrap();
    let both = solver.gradients(&case, &found, &[roll, jacking]).unwrap();
    assert!(both[0].value.is_finite() && both[0].value == alone[0].value);
    // A derivative that does not exist is NaN in both.
    let bits = |k: usize, of: &[f64]| of[k].to_bits();
    let (own, other) = (&both[0].parameters, &alone[0].parameters);
    assert_eq!(own.len(), other.len());
    assert!((0..own.len()).all(|k| bits(k, own) == bits(k, other)));
    assert!(both[1].value.is_nan() && both[1].parameters.iter().all(|by| by.is_nan()));
    let cases = [case];
    let request = CarRequest::of(&cases, &[roll, jacking], []);
    let known = request.gradients(&car).unwrap();
    assert!(known[0].is_some() && known[1].is_none());
    let mut values = [0.0; 2];
    assert!(request.values(&car, &mut values).unwrap().is_none());
    assert!(values[0].is_finite() && values[1].is_nan());
}

/// The distance of the static position from the design position keeps its digits in metres.
#[test]
fn the_distance_to_the_static_position_has_digits_in_metres() {
    let directory = tempfile::tempdir().unwrap();
    let study = studies().join("car.toml");
    let study = study.to_str().unwrap();
    let convert = ["convert", study, "--unit", "m", "--out", "metres"];
    hardpoint(directory.path(), &convert).success();
    let heavy = "car.sprung_mass=1700.0";
    let solve = [
        "solve",
        "metres/car.toml",
        "--set",
        heavy,
        "--out",
        "results",
    ];
    let said = hardpoint(directory.path(), &solve).get_output().clone();
    let said = text(&said.stdout) + &text(&said.stderr);
    assert!(
        said.contains("the static position is 0.0194 m of travel"),
        "{said}"
    );
}
