//! Tests of the program's solver against the reference values (110 digits, see `tests/data/reference`).

use crate::support::larger;
use crate::support::{
    ANGLES, AXES, Case, Worst, motion, number, order_to, sensitivity_errors, vector,
};
use hardpoint::characteristics::{Constants, Quantity, WheelReading};
use hardpoint::derive::{DesignSeries, MotionPoint};
use hardpoint::model::Axis;
use hardpoint::number::Jet;
use serde_json::Value;
use std::ops::ControlFlow;

/// All reference values of a state, as (name, quantity, values of order 0, 1, 2).
fn expected(case: &Case, state: &Value, sign: f64) -> Vec<(String, Quantity, [f64; 3])> {
    let orders = [1.0, sign, sign * sign];
    let mut all = Vec::new();
    for name in ["p5", "p6", "p7", "p8", "p9", "p10", "p11"] {
        let by_order =
            ["positions", "d1", "d2"].map(|key| case.frame.vector(vector(&state[key][name])));
        for axis in AXES {
            let values = [0, 1, 2].map(|k| by_order[k].to_array()[axis as usize] * orders[k]);
            let quantity = Quantity::Coordinate(case.point(name), axis);
            all.push((format!("{name}.{}", axis.name()), quantity, values));
        }
    }
    for (name, characteristic) in ANGLES {
        let series = &state["angles"][name];
        let values = [0, 1, 2].map(|k| number(&series[format!("d{k}")]) * orders[k]);
        all.push((
            name.to_owned(),
            Quantity::Characteristic(characteristic),
            values,
        ));
    }
    all
}

#[derive(Default)]
struct Errors {
    /// Errors of positions relative to the suspension size, and errors of angles.
    value: Worst,
    /// Error relative to the largest value of the same kind and order.
    first: Worst,
    second: Worst,
    sensitivity: [Worst; 3],
    rack: [Worst; 2],
    turning: [Worst; 2],
}

fn check(name: &str) -> Errors {
    let case = Case::read(name);
    let mut errors = Errors::default();
    let mut solver = case.solver();
    let design_series = DesignSeries::<3>::new(&case.mechanism, &case.design);
    let size = solver.size();
    let mut with_sensitivities = 0;
    for state in case.states() {
        assert_eq!(state["exists"], true);
        let (drive, value, rack, sign) = motion(state);
        let mut visited = 0;
        solver
            .for_each_pose(drive, &order_to(value), rack, |solver, _, pose| {
                visited += 1;
                let pose = pose.unwrap_or_else(|f| panic!("{name} {:?}: {f}", state["drive"]));
                let point = MotionPoint { drive, value, rack };
                let linearised = solver
                    .linearised(&design_series, pose, &point.along_drive())
                    .unwrap();
                let view = WheelReading::of(&linearised.at, Constants::default());
                let outputs = expected(&case, state, sign);
                let is_point = |q: &Quantity| matches!(q, Quantity::Coordinate(..));
                let scale = |points: bool, order: usize| {
                    outputs
                        .iter()
                        .filter(|(_, q, _)| is_point(q) == points)
                        .map(|(_, _, v)| v[order].abs())
                        .fold(0.0, larger)
                };
                for (_, quantity, values) in &outputs {
                    let series = view.value(&linearised.at, *quantity);
                    let points = is_point(quantity);
                    let unit = if points { size } else { 1.0 };
                    errors.value.note((series[0] - values[0]) / unit);
                    errors
                        .first
                        .note((series.derivative(1) - values[1]) / scale(points, 1));
                    errors
                        .second
                        .note((series.derivative(2) - values[2]) / scale(points, 2));
                }
                turning(&case, state, sign, &view, &linearised.at, &mut errors);
                if state.get("sens").is_some() {
                    let found = sensitivity_errors(&case, state, sign, &view, &linearised);
                    for (all, here) in errors.sensitivity.iter_mut().zip(found) {
                        all.note(here.0);
                    }
                    with_sensitivities += 1;
                }
                by_rack(&case, state, solver, pose, &point, &mut errors);
                ControlFlow::Continue(())
            })
            .unwrap();
        assert_eq!(visited, 1);
    }
    assert!(with_sensitivities > 0, "{name}");
    println!(
        "{name:28} value {:.1e}  rates {:.1e} {:.1e}  sensitivities {:.1e} {:.1e} {:.1e}  rack {:.1e} {:.1e}  omega, alpha {:.1e} {:.1e}",
        errors.value.0,
        errors.first.0,
        errors.second.0,
        errors.sensitivity[0].0,
        errors.sensitivity[1].0,
        errors.sensitivity[2].0,
        errors.rack[0].0,
        errors.rack[1].0,
        errors.turning[0].0,
        errors.turning[1].0,
    );
    errors
}

/// Compares angular velocity and acceleration with respect to the drive.
fn turning(
    case: &Case,
    state: &Value,
    sign: f64,
    view: &WheelReading<3>,
    at: &hardpoint::mechanism::Configuration<Jet<f64, 3>>,
    errors: &mut Errors,
) {
    for (order, key) in ["omega_per_drive", "alpha_per_drive"]
        .into_iter()
        .enumerate()
    {
        let wanted = vector(&state[key]);
        for axis in AXES {
            let series = view.value(at, Quantity::AngularVelocity(axis));
            let wanted_here = wanted.to_array()[axis as usize]
                * case.frame.turn_sign(axis)
                * if order == 0 { sign } else { 1.0 };
            errors.turning[order].note((series.derivative(order) - wanted_here) / wanted.norm());
        }
    }
}

/// Compares derivatives with respect to the rack displacement at a fixed drive value.
fn by_rack(
    case: &Case,
    state: &Value,
    solver: &hardpoint::solve::Solver,
    pose: &hardpoint::mechanism::Pose<f64>,
    point: &MotionPoint<f64>,
    errors: &mut Errors,
) {
    let design_series = DesignSeries::<3>::new(&case.mechanism, &case.design);
    let motion = MotionPoint {
        drive: point.drive,
        value: Jet::constant(point.value),
        rack: Jet::variable(point.rack),
    };
    let at = solver
        .configuration_series(&design_series, pose, &motion)
        .unwrap();
    let view = WheelReading::of(&at, Constants::default());
    for (order, key) in ["rack_d1", "rack_d2"].into_iter().enumerate() {
        let largest = ["p8", "p10", "p11"]
            .map(|p| vector(&state[key][p]).norm())
            .into_iter()
            .fold(0.0, larger);
        for name in ["p5", "p6", "p8", "p10", "p11"] {
            let wanted = case.frame.vector(vector(&state[key][name]));
            for axis in Axis::ALL {
                let series = view.value(&at, Quantity::Coordinate(case.point(name), axis));
                let error = series.derivative(order + 1) - wanted.to_array()[axis as usize];
                errors.rack[order].note(error / largest);
            }
        }
    }
}

/// Asserts the bounds for an ordinary road-car strut. Errors of positions are below 1e-13 of the suspension size, and
/// errors of first and second derivatives below 1e-11. Errors of sensitivities (of positions and both derivatives) are
/// below 1e-10 of the largest of their kind.
fn within_bounds(errors: &Errors) {
    assert!(errors.value.0 < 1e-13, "{:e}", errors.value.0);
    for e in [
        errors.first,
        errors.second,
        errors.turning[0],
        errors.turning[1],
    ] {
        assert!(e.0 < 1e-11, "{:e}", e.0);
    }
    for e in errors.sensitivity {
        assert!(e.0 < 1e-10, "{:e}", e.0);
    }
    for e in errors.rack {
        assert!(e.0 < 1e-11, "{:e}", e.0);
    }
}

#[test]
fn nominal() {
    within_bounds(&check("nominal"));
}

#[test]
fn nominal_with_the_strut_line_through_its_mount() {
    within_bounds(&check("nominal-axis-through-top"));
}

#[test]
fn nominal_on_the_right() {
    within_bounds(&check("nominal-right"));
}

#[test]
fn nominal_in_millimetres() {
    within_bounds(&check("nominal-in-mm"));
}

#[test]
fn vertical_strut() {
    within_bounds(&check("vertical-strut"));
}
