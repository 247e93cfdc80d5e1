//! Tests of variables of a car that change the same distance or the same springs.

use super::one_point;
use crate::support::larger;
use hardpoint::car::{AxleParameter, CarQuantity, CarSolver, CarVariable, Case, Moves, moved};
use hardpoint::model::Axis;
use hardpoint::report::{optimised_car, settings_of_car};
use hardpoint::study::CarStudy;
use std::fs;

/// A variable moves the front wheel centre along x, and another one changes the wheelbase. The order of the variables does not
/// matter, and the slopes are those of finite differences.
#[test]
fn the_order_of_variables_does_not_matter() {
    let path = crate::support::studies().join("off_road_car.toml");
    let base = CarStudy::read(&path, &[]).unwrap().car;
    let centre = one_point(0, base.axles[0].left.mechanism.wheel_centre, Axis::X);
    let wheelbase = Moves::Wheelbase.value(&base).unwrap();
    let variables = [centre, Moves::Wheelbase].map(|moves| CarVariable {
        moves,
        range: [f64::NEG_INFINITY, f64::INFINITY],
    });
    let x = [4.0, wheelbase + 30.0];
    let car = moved(&base, &variables, &x);
    let mut reversed = variables.clone();
    reversed.reverse();
    assert_eq!(moved(&base, &reversed, &[x[1], x[0]]), car);
    let mut case = Case::at_rest("static");
    case.setting.elastic_tyres = false;
    let distance = CarQuantity::named("wheelbase_at_contact")[0];
    let at = |x: &[f64]| {
        let car = moved(&base, &variables, x);
        let mut solver = CarSolver::new(&car).unwrap();
        let found = solver.solve(&case).unwrap();
        let of = solver.gradients(&case, &found, &[distance]).unwrap();
        (
            of[0].value,
            variables
                .each_ref()
                .map(|own| own.moves.slope(&car, &of[0])),
        )
    };
    let (_, slopes) = at(&x);
    let mut worst = 0.0;
    for (k, slope) in slopes.into_iter().enumerate() {
        let beside = |step: f64| {
            let mut x = x;
            x[k] += step;
            at(&x).0
        };
        let by_step = (beside(0.01) - beside(-0.01)) / 0.02;
        worst = larger(worst, (slope - by_step).abs());
    }
    assert!(worst < 1e-5, "{worst}");
}

/// A variable changes the rates of both springs of an axle. The settings of the changed car contain both rates, also if the study
/// gives the same rate twice.
#[test]
fn the_right_spring_follows_the_left_one() {
    let path = crate::support::studies().join("car.toml");
    let variable = CarVariable {
        moves: Moves::Rate {
            axle: 0,
            parameter: AxleParameter::SpringRate,
        },
        range: [20.0, 45.0],
    };
    for rate in ["34.0", "30.0"] {
        let mut settings = vec![format!(
            "front.axle.right={{ spring = {{ rate = {rate} }} }}"
        )];
        let study = CarStudy::read(&path, &settings).unwrap();
        let variables = [variable.clone()];
        let car = moved(&study.car, &variables, &[43.0]);
        settings.extend(settings_of_car(&study, &car, &variables, &[43.0]));
        let again = CarStudy::read(&path, &settings).unwrap().car;
        let springs = |car: &hardpoint::car::Car| car.axles[0].setup.springs.clone();
        assert_ne!(springs(&car), springs(&study.car));
        assert_eq!(springs(&again), springs(&car));
    }
}

/// A variable moves the points of both wheels, also if the right wheel has points of its own. The settings and the studies of the
/// changed car contain the points of both wheels.
#[test]
fn points_of_the_right_wheel_move_too() {
    let path = crate::support::studies().join("car.toml");
    let right = "front.axle.right={ hardpoints = { tie_rod_inner = [-110.0, -330.5, 243.0] } }";
    let mut settings = vec![right.to_owned()];
    let study = CarStudy::read(&path, &settings).unwrap();
    let variables = study.optimise.as_ref().unwrap().variables.clone();
    let number = |label: &str| {
        let mut labels = variables.iter().map(|own| own.moves.label(&study.car));
        labels.position(|own| own == label).unwrap()
    };
    let values = variables.iter().map(|own| own.moves.value(&study.car));
    let mut x: Vec<f64> = values.map(Option::unwrap).collect();
    x[number("front.tie_rod_inner.z")] += 5.0;
    let car = moved(&study.car, &variables, &x);
    let right_of = |car: &hardpoint::car::Car| car.axles[0].right.as_ref().unwrap().design.clone();
    assert_ne!(right_of(&car), right_of(&study.car));
    settings.extend(settings_of_car(&study, &car, &variables, &x));
    let again = CarStudy::read(&path, &settings).unwrap().car;
    assert_eq!(right_of(&again), right_of(&car));
    let directory = tempfile::tempdir().unwrap();
    let names = ["optimised", "optimised_front", "optimised_rear"];
    for (name, text) in names.into_iter().zip(optimised_car(&study, &car, &x)) {
        fs::write(directory.path().join(format!("{name}.toml")), text).unwrap();
    }
    let again = CarStudy::read(&directory.path().join("optimised.toml"), &[]).unwrap();
    assert_eq!(again.car.axles, car.axles);
}
