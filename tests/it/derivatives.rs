//! Tests of every derivative of every quantity against difference quotients of the values.
//!
//! The difference quotients are central, of sixth order, with steps h of 0.05 mm. The truncation error is largest for a
//! swing arm that has a pole (an infinite value) at a distance of d = 6 mm in a hardpoint coordinate: 36 (h/d)^6 = 1e-11
//! of the derivative. The rounding error is that of the values divided by the step: 1e-15, 1e-14, 1e-13 for values, first
//! and second derivatives, over 5e-5. The bounds 1e-9, 1e-8, 1e-7 are above both errors.

use crate::support::Case;
use hardpoint::characteristics::{Characteristic, Constants, Quantity, WheelReading};
use hardpoint::derive::{DesignSeries, MotionPoint};
use hardpoint::model::{
    ArmId, Axis, Body, Drive, Mechanism, Point, PointId, Rocker, RockerId, Rod,
};
use hardpoint::number::{Jet, Vector3};
use hardpoint::solve::{Solver, StationOrder};
use std::ops::ControlFlow;

const CONSTANTS: Constants = Constants {
    size: 0.8,
    wheel_radius: 0.3,
    rim_diameter: 0.43,
    wheelbase: 2.6,
    cg_height: 0.5,
    is_front: true,
    brake_share: 0.65,
    drive_share: 0.4,
    brake_torque_by_carrier: 1.0,
    drive_torque_by_carrier: 0.0,
};

/// Step in metres or radians.
const STEP: f64 = 5e-5;

/// Weights of the sixth-order central difference of the first derivative, at 1, 2, 3 steps.
const WEIGHTS: [f64; 3] = [3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0];

fn difference(step: f64, f: impl Fn(f64) -> Vec<f64>) -> Vec<f64> {
    let mut sum = vec![0.0; f(0.0).len()];
    for (k, weight) in WEIGHTS.iter().enumerate() {
        let offset = (k + 1) as f64 * step;
        for ((s, plus), minus) in sum.iter_mut().zip(f(offset)).zip(f(-offset)) {
            *s += weight * (plus - minus) / step;
        }
    }
    sum
}

/// Nominal strut suspension with a point on every body, a rocker and an anti-roll bar.
fn with_extra_points() -> (Mechanism, Vec<Vector3<f64>>) {
    let case = Case::read("nominal");
    let (mut mechanism, mut design) = (case.mechanism, case.design);
    for (name, body, at) in [
        ("damper", Body::Arm(ArmId(0)), [0.02, 0.6, 0.18]),
        ("caliper", Body::Knuckle, [-0.1, 0.7, 0.35]),
        ("rocker_pivot_front", Body::Chassis, [0.02, 0.36, 0.56]),
        ("rocker_pivot_rear", Body::Chassis, [-0.02, 0.37, 0.56]),
        ("pushrod_inner", Body::Rocker(RockerId(0)), [0.0, 0.42, 0.6]),
        ("pushrod_outer", Body::Knuckle, [0.01, 0.6, 0.4]),
        ("anti_roll_bar_inner", Body::Chassis, [-0.2, 0.2, 0.34]),
        ("anti_roll_bar_outer", Body::Chassis, [-0.2, 0.54, 0.33]),
        (
            "drop_link_inner",
            Body::Rocker(RockerId(1)),
            [-0.1, 0.54, 0.33],
        ),
        ("drop_link_outer", Body::Arm(ArmId(0)), [-0.1, 0.55, 0.2]),
    ] {
        mechanism.points.push(Point {
            name: name.to_owned(),
            body,
        });
        design.push(Vector3::from(at));
    }
    for (rod, names) in [
        (
            Rod::Pushrod,
            [
                "rocker_pivot_front",
                "rocker_pivot_rear",
                "pushrod_inner",
                "pushrod_outer",
            ],
        ),
        (
            Rod::DropLink,
            [
                "anti_roll_bar_inner",
                "anti_roll_bar_outer",
                "drop_link_inner",
                "drop_link_outer",
            ],
        ),
    ] {
        let [first, second, inner, outer] = names.map(|name| mechanism.point(name).unwrap());
        mechanism.rockers.push(Rocker {
            rod,
            first,
            second,
            inner,
            outer,
        });
    }
    (mechanism, design)
}

fn quantities(mechanism: &Mechanism) -> Vec<Quantity> {
    let mut all: Vec<Quantity> = Characteristic::ALL
        .iter()
        .map(|c| Quantity::Characteristic(*c))
        .collect();
    for name in [
        "tie_rod_outer",
        "damper",
        "caliper",
        "rod_point",
        "pushrod_inner",
    ] {
        let point = mechanism.point(name).unwrap();
        all.extend(Axis::ALL.map(|axis| Quantity::Coordinate(point, axis)));
    }
    all.extend(Axis::ALL.map(Quantity::AngularVelocity));
    all
}

/// Returns the value and the first two derivatives of every quantity.
fn series(
    mechanism: &Mechanism,
    design: &[Vector3<f64>],
    point: MotionPoint<f64>,
) -> Vec<[f64; 3]> {
    let mut solver = Solver::new(mechanism, design).unwrap();
    let design_series = DesignSeries::<4>::new(mechanism, design);
    let mut found = Vec::new();
    solver
        .for_each_pose(
            point.drive,
            &StationOrder::through(&[point.value]),
            point.rack,
            |solver, _, pose| {
                let motion = point.along_drive();
                let at = solver
                    .configuration_series(&design_series, pose.unwrap(), &motion)
                    .unwrap();
                let view = WheelReading::of(&at, CONSTANTS);
                found = quantities(mechanism)
                    .into_iter()
                    .map(|q| {
                        let value = view.value(&at, q);
                        [0, 1, 2].map(|k| value.derivative(k))
                    })
                    .collect();
                ControlFlow::Continue(())
            },
        )
        .unwrap();
    found
}

const PLACES: [MotionPoint<f64>; 3] = [
    MotionPoint {
        drive: Drive::Travel,
        value: 0.02,
        rack: 0.01,
    },
    MotionPoint {
        drive: Drive::Travel,
        value: -0.06,
        rack: -0.02,
    },
    MotionPoint {
        drive: Drive::ArmAngle,
        value: -0.15,
        rack: 0.015,
    },
];

/// Asserts that each found derivative equals the difference quotient, within the bound of its order times the scale of its
/// quantity.
fn compare(
    mechanism: &Mechanism,
    values: &[[f64; 3]],
    found: &[f64],
    wanted: &[f64],
    order: usize,
    what: &str,
) {
    let quantities = quantities(mechanism);
    assert!([values.len(), found.len(), wanted.len()] == [quantities.len(); 3]);
    for ((quantity, value), (f, w)) in quantities.iter().zip(values).zip(found.iter().zip(wanted)) {
        // The length y of a swing arm is the inverse of a rotation rate. So an error of the rate causes an error y^2
        // times larger in y. The same factor applies to the position of the end of the swing arm.
        let pole = match quantity {
            Quantity::Characteristic(
                Characteristic::FrontViewSwingArm
                | Characteristic::SideViewSwingArm
                | Characteristic::FrontViewCentreLateral
                | Characteristic::FrontViewCentreHeight
                | Characteristic::SideViewCentreLongitudinal
                | Characteristic::SideViewCentreHeight,
            ) => value[0] * value[0],
            _ => 1.0,
        };
        let scale = w.abs().max(1.0).max(pole);
        let bound = match order {
            0 => 1e-9,
            1 => 1e-8,
            _ => 1e-7,
        };
        assert!(
            (f - w).abs() <= bound * scale,
            "{what} of {quantity:?}, order {order}: {f} and {w}"
        );
    }
}

#[test]
fn derivatives_by_the_drive_are_those_of_the_values() {
    let (mechanism, design) = with_extra_points();
    for place in PLACES {
        let here = series(&mechanism, &design, place);
        for order in [0, 1] {
            let wanted = difference(STEP, |offset| {
                let moved = MotionPoint {
                    value: place.value + offset,
                    ..place
                };
                series(&mechanism, &design, moved)
                    .iter()
                    .map(|s| s[order])
                    .collect()
            });
            let found: Vec<f64> = here.iter().map(|s| s[order + 1]).collect();
            compare(
                &mechanism,
                &here,
                &found,
                &wanted,
                order,
                "drive derivative",
            );
        }
    }
}

#[test]
fn derivatives_by_every_hardpoint_coordinate_are_those_of_the_values() {
    let (mechanism, design) = with_extra_points();
    let count = quantities(&mechanism).len();
    for place in PLACES {
        let here = series(&mechanism, &design, place);
        // Indices: found[order][quantity][point]
        let mut found = vec![vec![vec![Vector3::default(); design.len()]; count]; 3];
        let mut solver = Solver::new(&mechanism, &design).unwrap();
        let design_series = DesignSeries::<4>::new(&mechanism, &design);
        let mut buffer = vec![Vector3::new(0.0, 0.0, 0.0).map(Jet::constant); design.len()];
        solver
            .for_each_pose(
                place.drive,
                &StationOrder::through(&[place.value]),
                place.rack,
                |solver, _, pose| {
                    let motion = place.along_drive();
                    let linearised = solver
                        .linearised(&design_series, pose.unwrap(), &motion)
                        .unwrap();
                    let view = WheelReading::of(&linearised.at, CONSTANTS);
                    for (k, quantity) in quantities(&mechanism).into_iter().enumerate() {
                        view.gradients(
                            &linearised,
                            quantity,
                            2,
                            &mut buffer,
                            &mut |order, p, gradient| {
                                found[order][k][p.0] = gradient;
                            },
                        );
                    }
                    ControlFlow::Continue(())
                },
            )
            .unwrap();
        for point in 0..design.len() {
            for axis in Axis::ALL {
                let wanted = difference(STEP, |offset| {
                    let mut moved = design.clone();
                    let mut coordinates = moved[point].to_array();
                    coordinates[axis as usize] += offset;
                    moved[point] = Vector3::from(coordinates);
                    let rows = series(&mechanism, &moved, place);
                    rows.into_iter().flatten().collect()
                });
                for order in 0..3 {
                    let found: Vec<f64> = found[order]
                        .iter()
                        .map(|by_point| by_point[point].to_array()[axis as usize])
                        .collect();
                    let wanted: Vec<f64> = wanted.chunks(3).map(|w| w[order]).collect();
                    let what = format!("by {}.{}", mechanism.name(PointId(point)), axis.name());
                    compare(&mechanism, &here, &found, &wanted, order, &what);
                }
            }
        }
    }
}

/// Outputs, also gains per wheel travel, are the same whichever drive (travel or arm angle) moves the mechanism. The test omits
/// the three components of the angular velocity, which are per unit of the drive.
#[test]
fn gains_and_centres_do_not_depend_on_the_drive() {
    let (mechanism, design) = with_extra_points();
    let angle = PLACES[2];
    let by_angle = series(&mechanism, &design, angle);
    let mut solver = Solver::new(&mechanism, &design).unwrap();
    let mut travel = 0.0;
    solver
        .for_each_pose(
            angle.drive,
            &StationOrder::through(&[angle.value]),
            angle.rack,
            |_, _, pose| {
                let pose = pose.unwrap();
                let centre = mechanism.wheel_centre;
                let lever = design[centre.0] - design[mechanism.origin.0];
                travel = (pose.origin + pose.rotation.apply(lever)).z - design[centre.0].z;
                ControlFlow::Continue(())
            },
        )
        .unwrap();
    let place = MotionPoint {
        drive: Drive::Travel,
        value: travel,
        rack: angle.rack,
    };
    let by_travel = series(&mechanism, &design, place);
    let mut compared = 0;
    for ((quantity, a), b) in quantities(&mechanism).iter().zip(&by_angle).zip(&by_travel) {
        if !quantity.is_rate() {
            let error = (a[0] - b[0]).abs() / b[0].abs().max(1.0);
            assert!(error < 1e-12, "{quantity:?}: {} and {}", a[0], b[0]);
            compared += 1;
        }
    }
    assert_eq!(compared, by_angle.len() - 3);
}
