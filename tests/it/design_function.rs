//! Tests of studies as functions of their design: variables, outputs and failures.

use crate::support::study;
use hardpoint::model::PointId;
use hardpoint::study::{DesignTable, Designs, FileFormat, Sweep, SweepVariable};
use hardpoint::{DesignFunction, DesignStatus, DesignVariable, FunctionError};

/// Values of one design, as `values` and `value_and_jacobian` return them, with the status of both calls and the Jacobian.
fn both_calls(f: &DesignFunction, x: &[f64]) -> ([Vec<f64>; 2], [DesignStatus; 2], Vec<f64>) {
    let mut values = [vec![0.0; f.len()], vec![0.0; f.len()]];
    let mut status = [[DesignStatus::Faulty]; 2];
    let mut jacobian = vec![0.0; f.len() * x.len()];
    let mut evaluation = f.evaluation();
    evaluation.values(x, &mut values[0], &mut status[0]);
    evaluation.value_and_jacobian(x, &mut values[1], &mut jacobian, &mut status[1]);
    (values, status.map(|[own]| own), jacobian)
}

/// A study without variables of its own has the coordinates of the points that it gives. Points of the right half of a rigid
/// axle, and points that move with another point, follow from them.
#[test]
fn points_that_follow_are_no_variables() {
    for name in [
        "solid_axle_solve.toml",
        "twist_beam_solve.toml",
        "off_road_car_front.toml",
    ] {
        let study = study(name, &[]);
        let mechanism = &study.wheel().mechanism;
        let variables = DesignVariable::of(&study);
        let far = (0..mechanism.points.len()).filter(|k| mechanism.is_far(PointId(*k)));
        let far: Vec<String> = far.map(|k| mechanism.points[k].name.clone()).collect();
        assert!(!far.is_empty());
        assert_eq!(
            variables.len(),
            3 * (mechanism.points.len() - far.len()),
            "{name}"
        );
        for point in far {
            for end in ["dz", "z"] {
                let variable = format!("{point}_{end}");
                assert!(
                    variables.iter().all(|own| own.name != variable),
                    "{variable}"
                );
                let found = DesignVariable::named(&variable, &study);
                assert!(
                    matches!(found, Err(FunctionError::UnknownVariable(..))),
                    "{variable}"
                );
            }
        }
    }
}

/// Failures include the designs of all blocks, with the index of each design in the call.
#[test]
fn failures_of_many_designs_have_the_designs_indices() {
    let study = study(
        "macpherson_solve.toml",
        &[
            "motion={ travel = [0.0, 900.0] }",
            "outputs={ characteristics = [\"camber\"] }",
        ],
    );
    let f = DesignFunction::with_variables(
        &study,
        vec![DesignVariable::named("strut_top_dy", &study).unwrap()],
    )
    .unwrap();
    let x: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
    let mut status = vec![DesignStatus::Ok; 200];
    let mut values = vec![0.0; 200 * f.len()];
    let mut evaluation = f.evaluation();
    for _ in 0..2 {
        evaluation.values(&x, &mut values, &mut status);
        assert_eq!(status, [DesignStatus::Failed; 200]);
        let failures: Vec<(usize, usize)> = evaluation
            .failures()
            .map(|(design, station, _)| (design, station))
            .collect();
        assert_eq!(
            failures,
            (0..200).map(|design| (design, 1)).collect::<Vec<_>>()
        );
    }
}

/// A study without outputs of a function is refused, for a wheel and for an axle.
#[test]
fn a_function_has_outputs() {
    let points = "outputs={ points = [\"wheel_centre\"] }";
    let refused = DesignFunction::of(&study("macpherson_axle.toml", &[points]));
    assert_eq!(refused.unwrap_err(), FunctionError::NoOutputs);
    let loads = "outputs={ lengths = [[\"strut_top\", \"wheel_centre\"]] }";
    let refused = DesignFunction::of(&study("macpherson_solve.toml", &[loads]));
    assert_eq!(refused.unwrap_err(), FunctionError::NoOutputs);
    assert!(DesignFunction::of(&study("macpherson_solve.toml", &[points])).is_ok());
}

/// Variables of a table of designs have names, also if the study has `[optimise]`.
#[test]
fn variables_of_a_table_are_found_beside_those_of_a_tuning() {
    let mut study = study("macpherson_front.toml", &[]);
    assert!(study.optimise.is_some());
    let offset = DesignVariable::named("strut_lower_dx", &study).unwrap();
    let column = SweepVariable {
        name: "lower_end_of_strut".to_owned(),
        ..offset.swept_as().unwrap()
    };
    study.sweep = Some(Sweep {
        designs: Designs::Given(DesignTable::of(vec![column], vec![0.0, 1.0]).unwrap()),
        curves: false,
        format: FileFormat::Csv,
        constraints: true,
    });
    assert!(DesignVariable::named("lower_end_of_strut", &study).is_ok());
}

/// At a toggle, the values and the status are the same with and without derivatives, for a wheel and for an axle. Outputs
/// that do not depend on the rocker keep their values. Outputs without a value have no derivatives.
#[test]
fn derivatives_change_neither_values_nor_status_at_a_toggle() {
    let of_axle = study(
        "macpherson_axle.toml",
        &[
            "motion={ travel_left = [0.0, 180.0], travel_right = 0.0 }",
            "outputs={ characteristics = [\"spring_force\", \"anti_roll_bar_torque\"] }",
        ],
    );
    let near = "suspension.hardpoints.pushrod_inner=[0.0, 185.0, 486.0]";
    let of_wheel = study(
        "double_wishbone_pushrod.toml",
        &[
            near,
            "motion={ travel = [0.0, 60.0] }",
            "outputs={ characteristics = [\"camber\", \"rocker_angle\"] }",
        ],
    );
    for study in [of_axle, of_wheel] {
        let variable = DesignVariable::named("wheel_centre_dz", &study).unwrap();
        let f = DesignFunction::with_variables(&study, vec![variable]).unwrap();
        let ([plain, with], status, jacobian) = both_calls(&f, &[0.0]);
        assert_eq!(status, [DesignStatus::Failed; 2]);
        let (mut free, mut stuck) = (0, 0);
        for (k, (a, b)) in plain.iter().zip(&with).enumerate() {
            let name = &f.outputs()[k / f.stations()];
            assert_eq!(a.is_nan(), b.is_nan(), "{name}");
            assert!(jacobian[k].is_nan() || !b.is_nan(), "{name}");
            assert!(
                a.is_nan() || (a - b).abs() < 1e-9 * a.abs().max(1.0),
                "{name}: {a} {b}"
            );
            // Station 1 is beyond the toggle.
            if k % f.stations() == 1 {
                free += usize::from(!a.is_nan());
                stuck += usize::from(a.is_nan());
            }
        }
        assert!(free > 0 && stuck > 0, "{free} {stuck}");
    }
}
