//! Tests of the five-link suspension, which the program solves with the general closure (six unknowns).

use super::truth::{Errors, PLACES, Truth, lift, place, slope};
use super::{at, template, travel};
use crate::support::Worst;
use crate::support::larger;
use crate::support::quadratics::{Quadratics, design_pose};
use crate::support::random::Random;
use hardpoint::bench::DoubleDouble as Dd;
use hardpoint::characteristics::{Characteristic, Constants, Quantity, WheelReading};
use hardpoint::derive::DesignSeries;
use hardpoint::mechanism::Pose;
use hardpoint::model::{Constraint, Mechanism, PointId};
use hardpoint::number::{Jet, Matrix3, Scalar, Vector3};
use std::array::from_fn;

#[test]
fn random_linkages_agree_with_thirty_digits() {
    random_linkages(2_500);
}

#[test]
#[ignore = "10,000 designs: with .ci/long"]
fn ten_thousand_random_linkages_agree_with_thirty_digits() {
    random_linkages(10_000);
}

/// Compares `designs` random designs with the reference. They are scattered around the template, each at one position
/// within +-80 mm travel and +-20 mm rack.
fn random_linkages(designs: usize) {
    for (name, seed) in [("five_link", 5), ("integral_link", 51), ("h_arm", 52)] {
        random_designs(name, seed, designs);
    }
}

fn random_designs(name: &str, seed: u64, designs: usize) {
    let suspension = template(name);
    let mut random = Random(seed);
    let mut errors = Errors::default();
    for i in 0..designs {
        let design = random.scattered(&suspension.design, 30.0);
        let (value, rack) = (80.0 * random.signed(), 20.0 * random.signed());
        errors.check(&suspension.mechanism, &design, value, rack, i % 100 == 0);
    }
    println!("{name}: {errors:?}");
    assert_eq!(errors.disagreed, 0, "{name}");
    assert!(10 * errors.solved > 9 * designs, "{errors:?}");
    assert!(errors.by_order[0].0 < 1e-13, "{errors:?}");
    for e in [errors.by_order[1], errors.by_order[2]] {
        assert!(e.0 < 1e-10, "{errors:?}");
    }
    for e in errors.sensitivities {
        assert!(e.0 < 1e-10, "{errors:?}");
    }
}

#[test]
fn planted_poses_are_found() {
    planted_poses(2_500);
}

#[test]
#[ignore = "10,000 designs: with .ci/long"]
fn ten_thousand_planted_poses_are_found() {
    planted_poses(10_000);
}

/// The test chooses a pose of the knuckle, and then moves the chassis end of every rod. Afterwards, the rod has the
/// same length in the design position and in the chosen pose. For this, the chassis end moves to the nearest point with
/// equal distances to both positions of the knuckle end. So the pose is known except for rounding errors of the chassis
/// ends. The test counts a design if small steps from the design position reach the chosen pose.
fn planted_poses(designs: usize) {
    let suspension = template("five_link");
    let mechanism = &suspension.mechanism;
    let mut random = Random(6);
    let (mut worst, mut worst_unit) = (Worst::default(), Worst::default());
    let mut connected = 0;
    for _ in 0..designs {
        let mut design = random.scattered(&suspension.design, 20.0);
        let origin = design[mechanism.origin.0];
        let shift = Vector3::new(
            5.0 * random.signed(),
            5.0 * random.signed(),
            70.0 * random.signed(),
        );
        let planted = Pose {
            origin: origin + shift,
            rotation: Matrix3::identity(0.0).turned(random.vector(0.02)),
        };
        let image = |p: Vector3<f64>| planted.origin + planted.rotation.apply(p - origin);
        for constraint in &mechanism.constraints {
            let Constraint::Link { inner, outer } = *constraint else {
                unreachable!()
            };
            let outer = design[outer.0];
            let move_of_joint = image(outer) - outer;
            let middle = outer + move_of_joint * 0.5;
            let inner = &mut design[inner.0];
            let off = (*inner - middle).dot(move_of_joint) / move_of_joint.norm_squared();
            *inner = *inner - move_of_joint * off;
        }
        let centre = design[mechanism.wheel_centre.0];
        let value = image(centre).z - centre.z;
        let start = design_pose(mechanism, &design);
        let tracked = Quadratics::new(mechanism, &design).track(start, value, 0.0, 20);
        if !tracked.is_some_and(|p| (p.origin - planted.origin).norm() < 1e-6) {
            continue;
        }
        connected += 1;
        let point = travel(value, 0.0);
        let (apart, condition) = at(mechanism, &design, point, |solver, pose| {
            let turned = |k: usize| (pose.rotation.columns[k] - planted.rotation.columns[k]).norm();
            let shifted = (pose.origin - planted.origin).norm() / solver.size();
            let apart = (0..3).map(turned).fold(shifted, larger);
            (apart, solver.conditioning(pose, &point).number)
        })
        .unwrap()
        .unwrap();
        // Constructing and solving a pose make about five rounding errors each, of coordinates up to 1.7 times the
        // suspension size. The solved pose may differ by the sum of these errors times the condition number. This is at most about
        // 16 rounding errors times the condition number. In ten thousand designs, the largest difference is 1.2 of them.
        assert!(apart < 1e-6, "another pose, {apart} sizes away");
        worst.note(apart);
        worst_unit.note(apart / (condition * f64::EPSILON));
    }
    println!(
        "{connected} connected, {:.1e}, {:.1} units times the condition",
        worst.0, worst_unit.0
    );
    assert!(10 * connected > 9 * designs, "{connected}");
    assert!(worst_unit.0 < 16.0, "{}", worst_unit.0);
}

/// Tangents of caster and kingpin inclination, kingpin offset and spindle trail of the instantaneous axis. They follow
/// from the motion that the rack causes, in poses with thirty digits.
fn steering(
    truth: &Truth,
    mechanism: &Mechanism,
    design: &[Vector3<Dd>],
    more_travel: f64,
) -> [Dd; 4] {
    let poses = PLACES.map(|k| truth.pose(design, more_travel, k * STEP));
    let here = truth.pose(design, more_travel, 0.0);
    let shift = slope(poses.map(|p| p.origin), STEP);
    let columns: [Vector3<Dd>; 3] = from_fn(|i| {
        let rate = slope(poses.map(|p| p.rotation.columns[i]), STEP);
        here.rotation.columns[i].cross(rate)
    });
    let turn = (columns[0] + columns[1] + columns[2]) * Dd::from(0.5);
    let foot = turn.cross(shift) * (Dd::from(1.0) / turn.dot(turn));
    let centre = place(mechanism, design, &here, mechanism.wheel_centre);
    let point = here.origin + foot;
    let crossing = point + turn * ((centre.z - point.z) / turn.z);
    [
        -(turn.x / turn.z),
        -(turn.y / turn.z),
        centre.y - crossing.y,
        crossing.x - centre.x,
    ]
}

const STEP: f64 = 1e-3;

/// The outputs of the instantaneous steering axis agree with a solution of thirty digits. The test compares the values,
/// the rates, and the sensitivities of values and rates.
#[test]
fn instantaneous_steering_axis_agrees_with_thirty_digits() {
    let suspension = template("five_link");
    let mechanism = &suspension.mechanism;
    let read = [
        Characteristic::Caster,
        Characteristic::KingpinInclination,
        Characteristic::KingpinOffset,
        Characteristic::SpindleTrail,
    ];
    let mut random = Random(7);
    let mut worst = [Worst::default(); 4];
    for _ in 0..20 {
        let design = random.scattered(&suspension.design, 10.0);
        let (value, rack) = (50.0 * random.signed(), 10.0 * random.signed());
        let design_series = DesignSeries::<3>::new(mechanism, &design);
        let point = travel(value, rack);
        at(mechanism, &design, point, |solver, pose| {
            let truth = Truth::around(mechanism, &design, pose, value, rack);
            let exact: Vec<_> = design.iter().copied().map(lift).collect();
            let value_and_rate = |design: &[Vector3<Dd>]| -> [[Dd; 4]; 2] {
                let along = PLACES.map(|k| steering(&truth, mechanism, design, k * STEP));
                let rate = from_fn(|i| derivative(along.map(|values| values[i])));
                [steering(&truth, mechanism, design, 0.0), rate]
            };
            let wanted = value_and_rate(&exact);
            let mut slopes = Vec::new();
            for hardpoint in 0..design.len() {
                for axis in 0..3 {
                    let moved = PLACES.map(|k| {
                        let mut design = exact.clone();
                        let mut p = design[hardpoint].to_array();
                        p[axis] = p[axis] + Dd::from(k * STEP);
                        design[hardpoint] = Vector3::from(p);
                        value_and_rate(&design)
                    });
                    let by = |order: usize, i: usize| derivative(moved.map(|m| m[order][i]));
                    slopes.push([0, 1].map(|order| from_fn::<f64, 4, _>(|i| by(order, i).value())));
                }
            }
            let linearised = solver
                .linearised(&design_series, pose, &point.along_drive())
                .unwrap();
            let view = WheelReading::of(&linearised.at, Constants::default());
            let mut buffer = vec![Vector3::new(0.0, 0.0, 0.0).map(Jet::constant); design.len()];
            for (i, c) in read.into_iter().enumerate() {
                let series = view.value(&linearised.at, Quantity::Characteristic(c));
                let is_angle = i < 2;
                let tangent = series[0].tan();
                // d tan = (1 + tan^2) d angle
                let stretch = if is_angle {
                    1.0 + tangent * tangent
                } else {
                    1.0
                };
                let (found, rate) = if is_angle {
                    (tangent, stretch * series.derivative(1))
                } else {
                    (series[0], series.derivative(1))
                };
                let scale = if is_angle { 1.0 } else { 100.0 };
                worst[0].note((found - wanted[0][i].value()) / scale);
                worst[1].note((rate - wanted[1][i].value()) / scale * 100.0);
                let mut gradients = vec![[[0.0; 3]; 2]; design.len()];
                let quantity = Quantity::Characteristic(c);
                view.gradients(
                    &linearised,
                    quantity,
                    1,
                    &mut buffer,
                    &mut |order, id, g| {
                        gradients[id.0][order] = g.to_array();
                    },
                );
                let largest = |order: usize| {
                    let sizes = slopes.iter().map(|s| s[order][i].abs());
                    sizes.fold(0.0, larger)
                };
                let (first, second) = (largest(0), largest(1));
                for (PointId(p), axis) in
                    (0..design.len()).flat_map(|p| (0..3).map(move |a| (PointId(p), a)))
                {
                    let [by_p, by_p_rate] = [0, 1].map(|order| gradients[p][order][axis]);
                    let (by_p, by_p_rate) = if is_angle {
                        (
                            stretch * by_p,
                            stretch * (by_p_rate + 2.0 * tangent * by_p * series.derivative(1)),
                        )
                    } else {
                        (by_p, by_p_rate)
                    };
                    let wanted = slopes[3 * p + axis];
                    worst[2].note((by_p - wanted[0][i]) / first);
                    worst[3].note((by_p_rate - wanted[1][i]) / second);
                }
            }
        })
        .unwrap()
        .unwrap();
    }
    println!("value, rate and their sensitivities: {worst:?}");
    assert!(worst[0].0 < 1e-13, "{worst:?}");
    for worst in &worst[1..] {
        assert!(worst.0 < 1e-10, "{worst:?}");
    }
}

fn derivative(values: [Dd; 4]) -> Dd {
    let zero = Dd::default();
    slope(values.map(|v| Vector3::new(v, zero, zero)), STEP).x
}
