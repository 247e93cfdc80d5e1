//! Tests of solid axles in cars.

use super::random_case;
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::car::{
    AxleEnd, AxleResult, Car, CarQuantity, CarSolver, Case, GRAVITY, Longitudinal, WheelPlace,
    WheelResult, WholeResult,
};
use hardpoint::mechanism::Configuration;
use hardpoint::model::{Axis, PointId, Side};
use hardpoint::number::Vector3;
use hardpoint::study::CarStudy;
use nalgebra::{DMatrix, DVector};
use std::path::Path;

type V = Vector3<f64>;

fn car() -> Car {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/own/solid_car.toml");
    CarStudy::read(&path, &[]).unwrap().car
}

/// Car whose rear axle has random changes of its hardpoints, equal on both sides.
fn random_car(random: &mut Random) -> Car {
    let mut car = car();
    let points = car.axles[1].left.design.len();
    for point in 0..points {
        for axis in Axis::ALL {
            let moves = super::one_point(1, PointId(point), axis);
            moves.apply(4.0 * random.signed(), &mut car);
        }
    }
    car.cg.y += 20.0 * random.signed();
    car.cg.z += 30.0 * random.signed();
    car
}

/// Force at a point, as six components about the origin.
fn wrench(at: V, force: V) -> [f64; 6] {
    let moment = at.cross(force) * 1e-3;
    [force.x, force.y, force.z, moment.x, moment.y, moment.z]
}

/// The axle alone is in equilibrium: the tensions of the four links balance tyre forces, springs and inertia. The test
/// fits the four tensions to the six equilibrium equations.
#[test]
fn four_links_hold_the_axle() {
    let mut random = Random(23);
    let (mut solved, mut worst) = (0, [0.0_f64; 2]);
    for _ in 0..5 {
        let car = random_car(&mut random);
        let mut solver = CarSolver::new(&car).unwrap();
        for _ in 0..8 {
            let case = random_case(&mut random, [0.4, 0.5, 8.0]);
            let Ok(found) = solver.solve(&case) else {
                continue;
            };
            solved += 1;
            let state = solver.balance(&case, &found).unwrap();
            let left = &car.axles[1].left;
            let pose = solver.poses(&found).unwrap()[1].poses()[Side::Left as usize];
            let at = Configuration::new(&left.mechanism, &left.design, pose, 0.0);
            let place = |name: &str| {
                let id = left.mechanism.point(name).unwrap();
                at.point(id) + car.rear_offset
            };
            let road = &state.road;
            let inertia =
                (road.forward * case.ax + road.left * case.ay + road.up * (1.0 + case.az))
                    * -GRAVITY;
            let mut sum = DVector::<f64>::zeros(6);
            let mut add = |at: V, force: V| sum += DVector::from_row_slice(&wrench(at, force));
            for (number, prefix) in [(2, ""), (3, "right_")] {
                let wheel = &state.wheels[number];
                let tyre = road.up * wheel.load
                    + wheel.across * wheel.side_force
                    + wheel.heading * wheel.longitudinal_force;
                add(wheel.contact, tyre);
                add(wheel.corner.centre, inertia * 80.0);
                let [low, high] = ["lower", "upper"].map(|end| format!("{prefix}spring_{end}"));
                let low = place(&low);
                // The upper end of the right spring is the mirror image of the left one, fixed to the body.
                let high = match number {
                    2 => place(&high),
                    _ => {
                        let left = place("spring_upper");
                        V::new(left.x, -left.y, left.z)
                    }
                };
                add(low, (low - high).normalised() * wheel.spring_force);
                let sum: f64 = wheel.parts.iter().sum();
                worst[1] = larger(worst[1], (sum - wheel.load).abs() / 4000.0);
            }
            let links = ["lower_link", "upper_link"].into_iter().flat_map(|link| {
                let link = link.to_owned();
                ["", "right_"].map(|prefix| format!("{prefix}{link}"))
            });
            let columns: Vec<DVector<f64>> = links
                .map(|link| {
                    let axle = place(&format!("{link}_axle"));
                    let chassis = place(&format!("{link}_chassis"));
                    let pull = (chassis - axle).normalised();
                    DVector::from_row_slice(&wrench(axle, pull))
                })
                .collect();
            let matrix = DMatrix::from_columns(&columns);
            let tensions = matrix.clone().svd(true, true).solve(&-&sum, 1e-12).unwrap();
            let left_over = &matrix * tensions + &sum;
            worst[0] = larger(worst[0], left_over.norm() / (1700.0 * GRAVITY));
        }
    }
    println!("{solved} states, worst {worst:?}");
    assert!(solved >= 36, "{solved}");
    assert!(worst[0] < 1e-11 && worst[1] < 1e-12, "{worst:?}");
}

/// Results of the solid axle that belong to no single wheel.
fn results() -> Vec<CarQuantity> {
    let rear = |result| CarQuantity::Axle(AxleEnd::Rear, result);
    let wheel = |number, result| CarQuantity::Wheel(WheelPlace(number), result);
    vec![
        CarQuantity::Whole(WholeResult::Roll),
        CarQuantity::Whole(WholeResult::Energy),
        CarQuantity::Whole(WholeResult::JackingHeave),
        CarQuantity::Whole(WholeResult::WarpStiffness),
        CarQuantity::Whole(WholeResult::RollGradient),
        CarQuantity::Whole(WholeResult::AntiLiftRear),
        rear(AxleResult::RollCentreHeight),
        rear(AxleResult::RollCentreLateral),
        rear(AxleResult::ForceRollCentre),
        rear(AxleResult::RollAxisHeight),
        rear(AxleResult::Geometric),
        rear(AxleResult::RollSteerGradient),
        wheel(2, WheelResult::Load),
        wheel(3, WheelResult::Longitudinal),
        wheel(3, WheelResult::Elastic),
    ]
}

/// Derivatives with respect to hardpoints of both axles and to the rack equal finite differences between complete
/// designs.
#[test]
fn derivatives_are_those_of_moved_cars() {
    let car = car();
    let mut case = Case::at_rest("braked_turn");
    (case.ax, case.ay, case.racks[0]) = (-0.3, 0.4, -5.0);
    case.setting.elastic_tyres = false;
    case.setting.longitudinal = Longitudinal::Brake;
    let asked = results();
    let values = |car: &Car, case: &Case| -> Vec<f64> {
        let mut solver = CarSolver::new(car).unwrap();
        let found = solver.solve(case).unwrap();
        let solved = solver.solved(case, &found).unwrap();
        asked.iter().map(|q| q.evaluate(&solved)).collect()
    };
    let mut solver = CarSolver::with_racks(&car).unwrap();
    let found = solver.solve(&case).unwrap();
    let gradients = solver.gradients(&case, &found, &asked).unwrap();
    let now = values(&car, &case);
    for (gradient, value) in gradients.iter().zip(&now) {
        let error = (gradient.value - value).abs();
        assert!(error <= 1e-9 * value.abs().max(1e-3), "{value} {error:e}");
    }
    let check =
        |name: &str, below: &[f64], above: &[f64], step: f64, exact: &dyn Fn(usize) -> f64| {
            for (k, quantity) in asked.iter().enumerate() {
                let expected = (above[k] - below[k]) / (2.0 * step);
                let by = exact(k);
                let scale = expected.abs() + 1e-5 * now[k].abs() + 1e-9;
                assert!(
                    (by - expected).abs() < 2e-4 * scale,
                    "{} by {name}: {by} {expected}",
                    quantity.name()
                );
            }
        };
    for (axle, name) in [
        (1, "lower_link_chassis"),
        (1, "upper_link_axle"),
        (1, "spring_lower"),
        (1, "wheel_centre"),
        (0, "lower_ball_joint"),
    ] {
        let point = car.axles[axle].left.mechanism.point(name).unwrap();
        for axis in Axis::ALL {
            let step = 5e-3;
            let at = |by: f64| {
                let mut moved = car.clone();
                super::one_point(axle, point, axis).apply(by, &mut moved);
                values(&moved, &case)
            };
            let exact = |k: usize| gradients[k].hardpoints[axle][point.0][axis];
            check(name, &at(-step), &at(step), step, &exact);
        }
    }
    let step = 5e-3;
    let at = |by: f64| {
        let mut moved = case.clone();
        moved.racks[0] += by;
        values(&car, &moved)
    };
    let rack = hardpoint::car::Parameter::Axle(0, hardpoint::car::AxleParameter::Rack).place();
    check("rack", &at(-step), &at(step), step, &|k| {
        gradients[k].parameters[rack]
    });
    // A solver without racks returns NaN for these derivatives.
    let plain = CarSolver::new(&car)
        .unwrap()
        .gradients(&case, &found, &asked);
    assert!(plain.unwrap()[0].parameters[rack].is_nan());
}

/// A symmetric car at rest has zero heave and zero roll, and the roll centre of its solid axle is in the middle plane.
#[test]
fn a_symmetric_car_at_rest_is_level() {
    let mut car = car();
    car.cg.y = 0.0;
    let mut rest = Case::at_rest("static");
    rest.setting.elastic_tyres = false;
    let mut solver = CarSolver::new(&car).unwrap();
    let found = solver.solve(&rest).unwrap();
    let solved = solver.solved(&rest, &found).unwrap();
    let value = |quantity: CarQuantity| quantity.evaluate(&solved);
    assert!(value(CarQuantity::Whole(WholeResult::JackingHeave)).abs() < 1e-12);
    assert!(value(CarQuantity::Whole(WholeResult::Roll)).abs() < 1e-12);
    let lateral = CarQuantity::Axle(AxleEnd::Rear, AxleResult::RollCentreLateral);
    assert!(value(lateral).abs() < 1e-9);
}
