//! Tests that results do not depend on the car's position, orientation or scale. Also tests that a mirrored car steers
//! in the opposite direction.

use super::{characteristics, template, travel};
use crate::support::random::Random;
use hardpoint::characteristics::Characteristic as C;
use hardpoint::derive::MotionPoint;
use hardpoint::model::{Drive, Suspension};
use hardpoint::number::{Jet, Vector3};

const TOPOLOGIES: [&str; 7] = [
    "macpherson",
    "double_wishbone",
    "five_link",
    "semi_trailing_arm",
    "double_wishbone_pushrod",
    "integral_link",
    "h_arm",
];

/// Scatter of points, and largest wheel travel. A racing car's rocker is small and allows less travel.
fn extent(name: &str) -> (f64, f64) {
    match name {
        "double_wishbone_pushrod" => (8.0, 30.0),
        _ => (15.0, 60.0),
    }
}

/// Outputs of rockers, if there are any.
fn of_rockers(suspension: &Suspension) -> impl Iterator<Item = C> {
    let has_rockers = suspension.mechanism.spring_rocker().is_some()
        && suspension.mechanism.anti_roll_bar().is_some();
    [
        C::SpringLength,
        C::SpringInclination,
        C::MotionRatio,
        C::RockerAngle,
        C::AntiRollBarAngle,
    ]
    .into_iter()
    .filter(move |_| has_rockers)
}

fn readable(suspension: &Suspension) -> Vec<C> {
    let steered = suspension.mechanism.steering_axis.is_some();
    [
        C::Camber,
        C::CamberGain,
        C::HalfTrackChange,
        C::WheelbaseChange,
    ]
    .into_iter()
    .chain(
        [C::ScrubRadius, C::CasterTrail]
            .into_iter()
            .filter(|_| steered),
    )
    .chain(of_rockers(suspension))
    .collect()
}

fn compare(
    name: &str,
    found: &[Jet<f64, 3>],
    wanted: &[Jet<f64, 3>],
    // Factor by which all lengths differ.
    scale: f64,
    read: &[C],
) {
    for ((found, wanted), c) in found.iter().zip(wanted).zip(read) {
        let of_length = match c {
            C::Camber
            | C::SpringInclination
            | C::MotionRatio
            | C::RockerAngle
            | C::AntiRollBarAngle => 0,
            C::CamberGain => -1,
            _ => 1,
        };
        for order in 0..2 {
            let expected = wanted[order] * scale.powi(of_length - order as i32);
            // Scale of the error: 500 mm times `scale` for each power of a length, and 1 rad for an angle.
            let unit =
                500.0_f64.powi(of_length - order as i32) * scale.powi(of_length - order as i32);
            let error = (found[order] - expected).abs() / unit;
            assert!(
                error < 1e-11,
                "{name} {} order {order}: {error:e}",
                c.info().name
            );
        }
    }
}

#[test]
fn shift_and_scale() {
    for name in TOPOLOGIES {
        let suspension = template(name);
        let read = readable(&suspension);
        let (scatter, reach) = extent(name);
        let mut random = Random(9);
        for _ in 0..20 {
            let design = random.scattered(&suspension.design, scatter);
            let point = travel(reach * random.signed(), 10.0 * random.signed());
            let plain = characteristics(&suspension, &design, point, &read).unwrap();
            let by = random.vector(1000.0);
            let shifted: Vec<_> = design.iter().map(|p| *p + by).collect();
            let found = characteristics(&suspension, &shifted, point, &read).unwrap();
            compare(name, &found, &plain, 1.0, &read);

            let metres: Vec<_> = design.iter().map(|p| *p * 1e-3).collect();
            let mut small = suspension.clone();
            small.wheel_radius = small.wheel_radius.map(|r| r * 1e-3);
            let point = MotionPoint {
                value: point.value * 1e-3,
                rack: point.rack * 1e-3,
                ..point
            };
            let found = characteristics(&small, &metres, point, &read).unwrap();
            compare(name, &found, &plain, 1e-3, &read);
        }
    }
}

/// The car is turned about the vertical, with the rack at rest. Heights, camber and values in the wheel's directions
/// stay equal. Toe changes by the rotation of the car.
#[test]
fn turn_about_the_vertical() {
    for name in TOPOLOGIES {
        let suspension = template(name);
        let steered = suspension.mechanism.steering_axis.is_some();
        let mut read = vec![C::Camber, C::CamberGain];
        read.extend(
            [C::ScrubRadius, C::CasterTrail]
                .into_iter()
                .filter(|_| steered && name != "five_link"),
        );
        read.extend(of_rockers(&suspension));
        let (scatter, reach) = extent(name);
        let mut random = Random(10);
        for _ in 0..20 {
            let design = random.scattered(&suspension.design, scatter);
            let point = travel(reach * random.signed(), 0.0);
            let plain = characteristics(&suspension, &design, point, &read).unwrap();
            let angle = 0.5 * random.signed();
            let (sine, cosine) = angle.sin_cos();
            let turned: Vec<_> = design
                .iter()
                .map(|p| Vector3::new(cosine * p.x - sine * p.y, sine * p.x + cosine * p.y, p.z))
                .collect();
            let found = characteristics(&suspension, &turned, point, &read).unwrap();
            compare(name, &found, &plain, 1.0, &read);
            // The rotation is to the left, and this is a left wheel. So its front edge moves outboard.
            let [before, after] = [&design, &turned]
                .map(|design| characteristics(&suspension, design, point, &[C::Toe]).unwrap());
            let error = (after[0][0] - (before[0][0] - angle)).abs();
            assert!(error < 1e-11, "{name}: {error:e}");
        }
    }
}

/// A design is mirrored front to rear. At the same travel and rack displacement, its motion must be mirrored too. The
/// order of the two pivots of an arm must not matter.
#[test]
fn mirror() {
    for name in TOPOLOGIES {
        let suspension = template(name);
        let (scatter, reach) = extent(name);
        let mut random = Random(11);
        for i in 0..20 {
            let design = random.scattered(&suspension.design, scatter);
            let mirrored: Vec<_> = design
                .iter()
                .map(|p| Vector3::new(-p.x, p.y, p.z))
                .collect();
            let angle = i % 2 == 0 && !suspension.mechanism.arms.is_empty();
            let point = if angle {
                MotionPoint {
                    drive: Drive::ArmAngle,
                    value: reach / 400.0 * random.signed(),
                    rack: 10.0 * random.signed(),
                }
            } else {
                travel(reach * random.signed(), 10.0 * random.signed())
            };
            // Lengths and angles of rockers equal those of the mirror image.
            let signs = [
                (C::Camber, 1.0),
                (C::Toe, -1.0),
                (C::HalfTrackChange, 1.0),
                (C::WheelbaseChange, -1.0),
            ];
            let signs = signs
                .into_iter()
                .chain(of_rockers(&suspension).map(|c| (c, 1.0)));
            let (read, signs): (Vec<_>, Vec<_>) = signs.unzip();
            let plain = characteristics(&suspension, &design, point, &read).unwrap();
            let found = characteristics(&suspension, &mirrored, point, &read).unwrap();
            for ((a, b), sign) in plain.iter().zip(&found).zip(signs) {
                let error = (a[0] - sign * b[0]).abs();
                assert!(error < 1e-11, "{name}: {error:e}");
            }
        }
    }
}
