//! Tests of the semi-trailing arm. Its motion is a rotation about one axis, which the tests calculate by hand.

use super::{at, characteristics, template, travel};
use crate::support::Worst;
use crate::support::random::Random;
use hardpoint::characteristics::{Characteristic, Constants, Quantity, WheelReading};
use hardpoint::derive::{DesignSeries, MotionPoint};
use hardpoint::mechanism::Failure;
use hardpoint::model::{Axis, Drive};
use hardpoint::number::{Dual, Jet, Real, Vector3};
use hardpoint::study::Study;
use std::path::Path;

/// Wheel centre and inner end of the spindle, rotated about the axis until the centre has risen by `travel`. The angle
/// follows from the height z.(l cos + (e x l) sin) of the centre. Here l is the centre's lever about the axis, and e is
/// the axis direction.
fn turned<T: Real>(p: &[Vector3<T>], travel: T) -> [Vector3<T>; 2] {
    let [first, second, centre, spindle] = [p[0], p[1], p[2], p[3]];
    let axis = (second - first).normalised();
    let lever = |p: Vector3<T>| p - first - axis * axis.dot(p - first);
    let (a, b) = (lever(centre), axis.cross(lever(centre)));
    let height = a.z + travel;
    let h = a.z * a.z + b.z * b.z;
    // With this root, the arm angle is zero at travel zero. With the other root, it is not zero.
    let root = (h - height * height).sqrt();
    let root = root * b.z.sign();
    let (cosine, sine) = (
        (a.z * height + b.z * root) / h,
        (b.z * height - a.z * root) / h,
    );
    [centre, spindle].map(|p| {
        let l = lever(p);
        p - l + l * cosine + axis.cross(l) * sine
    })
}

#[test]
fn turns_about_its_axis() {
    let suspension = template("semi_trailing_arm");
    let mechanism = &suspension.mechanism;
    let names: Vec<&str> = mechanism.points.iter().map(|p| p.name.as_str()).collect();
    let order = [
        "arm_pivot_inner",
        "arm_pivot_outer",
        "wheel_centre",
        "spindle_inner",
    ];
    assert_eq!(names[..4], order);
    let mut random = Random(8);
    let mut worst = [Worst::default(); 3];
    let mut gradients = [Worst::default(); 3];
    for _ in 0..10_000 {
        let design = random.scattered(&suspension.design, 60.0);
        let value = 80.0 * random.signed();
        let point = travel(value, 0.0);
        let design_series = DesignSeries::<3>::new(mechanism, &design);
        at(mechanism, &design, point, |solver, pose| {
            let linearised = solver
                .linearised(&design_series, pose, &point.along_drive())
                .unwrap();
            let view = WheelReading::of(&linearised.at, Constants::default());
            type Wanted = Dual<Jet<f64, 3>, 12>;
            let seeded: Vec<Vector3<Wanted>> = design[..4]
                .iter()
                .enumerate()
                .map(|(k, p)| {
                    Vector3::new(
                        Dual::input(Jet::constant(p.x), 3 * k),
                        Dual::input(Jet::constant(p.y), 3 * k + 1),
                        Dual::input(Jet::constant(p.z), 3 * k + 2),
                    )
                })
                .collect();
            let wanted = turned(&seeded, Dual::constant(Jet::variable(value)));
            let mut buffer = vec![Vector3::new(0.0, 0.0, 0.0).map(Jet::constant); design.len()];
            for (id, wanted) in [2, 3].into_iter().zip(wanted) {
                for (axis, wanted) in Axis::ALL.into_iter().zip(wanted.to_array()) {
                    let quantity = Quantity::Coordinate(hardpoint::model::PointId(id), axis);
                    let found = view.value(&linearised.at, quantity);
                    for k in 0..3 {
                        // The scale of the error is a power of the suspension size: for lengths, ratios and curvatures.
                        let scale = solver.size().powi(1 - k as i32);
                        worst[k].note((found[k] - wanted.value[k]) / scale);
                    }
                    view.gradients(
                        &linearised,
                        quantity,
                        2,
                        &mut buffer,
                        &mut |order, id, g| {
                            if id.0 >= 4 {
                                assert_eq!(g, Vector3::default());
                                return;
                            }
                            for (by, g) in g.to_array().into_iter().enumerate() {
                                let wanted = wanted.partials[3 * id.0 + by].derivative(order);
                                let scale = solver.size().powi(-(order as i32));
                                gradients[order].note((g - wanted) / scale);
                            }
                        },
                    );
                }
            }
        })
        .unwrap()
        .unwrap();
    }
    println!("{worst:?} {gradients:?}");
    assert!(worst[0].0 < 1e-13, "{worst:?}");
    for e in [worst[1], worst[2]].iter().chain(&gradients) {
        assert!(e.0 < 1e-10, "{worst:?} {gradients:?}");
    }
}

/// If the axis is along y, the arm is a trailing arm: no camber change, no toe change, no track change. The arm angle
/// is then a plain rotation.
#[test]
fn a_transverse_axis_makes_a_trailing_arm() {
    let mut suspension = template("semi_trailing_arm");
    for (name, y) in [("arm_pivot_inner", 300.0), ("arm_pivot_outer", 560.0)] {
        let id = suspension.mechanism.point(name).unwrap();
        suspension.design[id.0] = Vector3::new(400.0, y, 250.0);
    }
    for (name, y) in [("wheel_centre", 740.0), ("spindle_inner", 640.0)] {
        let id = suspension.mechanism.point(name).unwrap();
        suspension.design[id.0] = Vector3::new(0.0, y, 310.0);
    }
    let wanted = [
        Characteristic::Camber,
        Characteristic::Toe,
        Characteristic::HalfTrackChange,
        Characteristic::WheelbaseChange,
    ];
    let design = &suspension.design;
    let found = characteristics(&suspension, design, travel(60.0, 0.0), &wanted).unwrap();
    for series in &found[..3] {
        assert!(series.0.iter().all(|c| c.abs() < 1e-14), "{series:?}");
    }
    let radius = 400.0_f64.hypot(60.0);
    let forward = 400.0 - (radius * radius - 120.0 * 120.0).sqrt();
    assert!((found[3][0] - forward).abs() < 1e-12);

    let angle = (120.0 / radius).asin() - (60.0 / radius).asin();
    let point = MotionPoint {
        drive: Drive::ArmAngle,
        value: angle,
        rack: 0.0,
    };
    let found = characteristics(&suspension, design, point, &wanted).unwrap();
    assert!((found[3][0] - forward).abs() < 1e-12);
}

/// The travel ends where the arm is vertical: the wheel cannot rise farther than the arm's length.
#[test]
fn travel_ends_where_the_arm_stands_upright() {
    let suspension = template("semi_trailing_arm");
    let found = at(
        &suspension.mechanism,
        &suspension.design,
        travel(900.0, 0.0),
        |_, _| (),
    );
    assert!(
        matches!(found, Ok(Err(Failure::Unreachable { .. }))),
        "{found:?}"
    );
}

/// The program refuses outputs that need a steering axis, and names them. Without `[outputs]`, it omits them.
#[test]
fn has_no_steering_axis() {
    let text = include_str!("../../../studies/semi_trailing_arm_solve.toml");
    let asked = text.replace("\"camber\", ", "\"camber\", \"caster\", ");
    let refused = Study::from_text("asked", &asked, Path::new(".")).unwrap_err();
    let message = refused.to_string();
    let expected = "caster needs a steering axis, which semi_trailing_arm does not have";
    assert!(message.contains(expected), "{message}");

    let (silent, _) = text.split_once("[outputs]").unwrap();
    let study = Study::from_text("silent", silent, Path::new(".")).unwrap();
    let expected = [Characteristic::Camber, Characteristic::Toe];
    assert_eq!(study.one_wheel().unwrap().outputs.characteristics, expected);
}
