//! Tests of singular designs, dead centres and the ends of the travel.

use super::{at, bound, nominal, reference, size, strut, unsuitable, with_points};
use hardpoint::attia::Drive;
use hardpoint::attia::{PointCoordinates, Pose, Station, solve_travel};
use hardpoint::attia::{Refusal, Singular};
use hardpoint::attia::{Strut, StrutPoints};
use hardpoint::number::Vector3;
use std::f64::consts::PI;

/// The paper's drive reverses at theta = pi (t = 1.2985 s). The solver refuses this station, and solves the stations
/// before and after it.
#[test]
fn the_paper_s_drive_bounces_at_its_dead_centre() {
    let strut = strut(&reference("attia-example"));
    let mechanism = PointCoordinates::new(&strut, StrutPoints::Spread, Drive::PaperTheta).unwrap();
    let mut last = mechanism.design();
    let mut height = Vec::new();
    for step in 0..=200 {
        let t = 0.01 * step as f64;
        let theta = 1.0 + t + 0.5 * t * t;
        last = mechanism.track(&last, at(theta)).unwrap();
        let p5 = last.moving()[0];
        assert!(p5.y > strut.lower_arm_front.y, "the arm stays outboard");
        height.push(p5.z);
    }
    let lowest = height
        .iter()
        .enumerate()
        .min_by(|a, b| a.1.total_cmp(b.1))
        .unwrap()
        .0;
    assert_eq!(lowest, 130);
    for theta in [PI, PI + 1e-9, PI - 1e-9] {
        match mechanism.track(&last, at(theta)) {
            Err(Refusal::Unreachable { value, limit }) => {
                assert_eq!(limit, Singular::DeadCentre);
                assert!((value - PI).abs() < 1e-4);
            }
            other => panic!("{other:?}"),
        }
    }
}

/// If point 1 is half a metre farther forward, d51 is larger than the arm's radius. There is no solution near theta =
/// pi. After this gap, the arm is on the same side as before.
#[test]
fn where_the_arm_is_shorter_than_d51_stations_near_pi_are_refused() {
    let mut strut = strut(&reference("attia-example"));
    strut.lower_arm_front.x += 0.5;
    let mechanism = PointCoordinates::new(&strut, StrutPoints::Spread, Drive::PaperTheta).unwrap();
    let d51 = (strut.lower_ball_joint - strut.lower_arm_front).norm();
    let radius = 0.3643199727801098_f64;
    let limit = (-radius / d51).acos();
    let mut last = mechanism.design();
    for step in 0..=60 {
        let theta = mechanism.design().station().value + 0.05 * step as f64;
        match mechanism.track(&last, at(theta)) {
            Ok(pose) => {
                assert!(theta.cos() > limit.cos(), "{theta}");
                last = pose;
            }
            Err(refusal) => {
                assert!(theta.cos() < limit.cos(), "{theta}: {refusal}");
                assert!(matches!(
                    refusal,
                    Refusal::Unreachable {
                        limit: Singular::DeadCentre,
                        ..
                    }
                ));
            }
        }
    }
    assert!(last.station().value > PI && last.moving()[0].y > strut.lower_arm_front.y);
}

/// Near the end of a solution branch, the equations are satisfied up to rounding errors even slightly beyond the end.
/// This zone grows with the coordinates. The solver returns no pose beyond the end, however close to the end and from
/// whatever start. Before the end, the error of a returned pose is within the conditioning of the equations.
#[test]
fn what_rounding_alone_solves_is_refused() {
    for distance in [0.0, 1.0, 128.0, 8192.0] {
        // Rounding error of the coordinates, and so of the limits.
        let rounding = 4.0 * f64::EPSILON * (1.0 + distance);
        let far =
            |strut: Strut| with_points(&strut, |p| p + Vector3::new(distance, -distance, distance));

        // The paper's drive, with d51 larger than the arm's radius: the range of the drive does not end where
        // sin(theta) is zero.
        let mut strut = strut(&reference("attia-example"));
        strut.lower_arm_front.x += 0.5;
        let d51 = (strut.lower_ball_joint - strut.lower_arm_front).norm();
        let limit = (-0.3643199727801098 / d51).acos();
        let strut = far(strut);
        let mechanism =
            PointCoordinates::new(&strut, StrutPoints::Spread, Drive::PaperTheta).unwrap();
        check_end(&mechanism, at, limit, rounding, |pose| {
            let depth = strut.lower_arm_front.z + d51 * pose.station().value.cos();
            (pose.moving()[0].z - depth).abs()
        });

        // Limits of travel of a road car in bump and droop, to 110 digits. At these limits the travel reverses.
        let strut = far(nominal());
        let mechanism = PointCoordinates::new(&strut, StrutPoints::Spread, Drive::Travel).unwrap();
        for limit in [0.3496678070358349, -0.3657959368312455] {
            check_end(&mechanism, at, limit, rounding, |pose| {
                let height = mechanism.wheel_centre().of(pose.moving()).z;
                (height - strut.wheel_centre.z - pose.station().value).abs()
            });
        }

        // Toggle of the tie rod over the rack displacement, at a constant arm angle.
        let mechanism =
            PointCoordinates::new(&strut, StrutPoints::Spread, Drive::ArmAngle).unwrap();
        let by_rack = |rack| Station { value: 0.0, rack };
        check_end(&mechanism, by_rack, rack_at_toggle(), rounding, |pose| {
            let inner = strut.tie_rod_inner + Vector3::new(0.0, pose.station().rack, 0.0);
            let length = (pose.moving()[3] - inner).norm();
            (length - (strut.tie_rod_outer - strut.tie_rod_inner).norm()).abs()
        });
    }
}

/// Asserts that stations beyond the limit by more than `rounding` are refused. Stations before the limit by a thousand
/// times `rounding` must be solved, with an `error` within the conditioning.
fn check_end(
    mechanism: &PointCoordinates,
    station: impl Fn(f64) -> Station,
    limit: f64,
    rounding: f64,
    error: impl Fn(&Pose) -> f64,
) {
    let largest = size(mechanism.design().moving());
    for near in [0.9, 0.99, 1.0 - 1e-7] {
        let start = mechanism
            .track(&mechanism.design(), station(limit * near))
            .unwrap();
        for doubling in 0..20 {
            let offset = limit.signum() * rounding * f64::from(1 << doubling);
            let beyond = mechanism.track(&start, station(limit + offset));
            assert!(
                matches!(beyond, Err(Refusal::Unreachable { .. })),
                "{offset:e} beyond {limit}: {beyond:?}"
            );
            match mechanism.track(&start, station(limit - offset)) {
                Ok(pose) => {
                    let (error, bound) = (error(&pose), bound(mechanism, &pose, 0, largest));
                    assert!(error < bound, "{offset:e} before {limit}: {error:e}");
                }
                Err(refusal) => assert!(doubling < 10, "{offset:e} before {limit}: {refusal}"),
            }
        }
    }
}

/// Inward rack displacement of the nominal car at the toggle of the tie rod. There, the tie rod just reaches the circle
/// on which its outer end moves about the steering axis.
fn rack_at_toggle() -> f64 {
    let s = nominal();
    let axis = (s.strut_top - s.lower_ball_joint).normalised();
    let radius_and_height = |p: Vector3<f64>| {
        let arm = p - s.lower_ball_joint;
        (arm.cross(axis).norm(), arm.dot(axis))
    };
    let (radius, height) = radius_and_height(s.tie_rod_outer);
    let length = (s.tie_rod_outer - s.tie_rod_inner).norm();
    let gap = |rack: f64| {
        let (r, h) = radius_and_height(s.tie_rod_inner + Vector3::new(0.0, rack, 0.0));
        length - (r - radius).hypot(h - height)
    };
    let (mut solved, mut beyond) = (0.0, -0.25);
    for _ in 0..60 {
        let middle = 0.5 * (solved + beyond);
        if gap(middle) > 0.0 {
            solved = middle
        } else {
            beyond = middle
        }
    }
    solved
}

#[test]
fn singular_designs_are_named() {
    let refusal = |change: &dyn Fn(&mut Strut), points, drive| {
        let mut strut = nominal();
        change(&mut strut);
        PointCoordinates::new(&strut, points, drive).unwrap_err()
    };
    let singular =
        |change: &dyn Fn(&mut Strut)| refusal(change, StrutPoints::Spread, Drive::ArmAngle);
    for (what, strut) in unsuitable() {
        let refused = PointCoordinates::new(&strut, StrutPoints::Spread, Drive::ArmAngle);
        assert_eq!(refused.unwrap_err(), Refusal::Singular(what));
    }
    assert_eq!(
        singular(&|s| s.strut_upper = Some(s.strut_lower)),
        Refusal::Singular(Singular::StrutPointsCoincide)
    );
    assert_eq!(
        singular(&|s| {
            s.tie_rod_outer = s.lower_ball_joint
                + (s.tie_rod_inner - s.lower_ball_joint) * 0.3
                + (s.strut_top - s.lower_ball_joint) * 0.1;
        }),
        Refusal::Singular(Singular::TieRodToggle)
    );
    // If points 6 and 7 are only one micrometre apart, fewer than half of the digits are correct.
    assert_eq!(
        refusal(
            &|s| s.strut_upper = Some(s.strut_lower + s.axis() * 1e-6),
            StrutPoints::Study,
            Drive::Travel
        ),
        Refusal::Singular(Singular::StrutPointsCoincide)
    );
    assert_eq!(
        refusal(
            &|s| {
                s.lower_arm_front = Vector3::new(0.12, 0.705, 0.5);
                s.lower_arm_rear = Vector3::new(-0.26, 0.705, 0.5);
            },
            StrutPoints::Spread,
            Drive::PaperTheta
        ),
        Refusal::Singular(Singular::DeadCentre)
    );
    assert_eq!(singular(&|s| s.strut_top.x = f64::NAN), Refusal::NotFinite);
}

#[test]
fn beyond_the_travel_limits_there_is_no_pose() {
    // Limits of the nominal car to 110 digits: +0.3496678..., -0.3657959...
    for (request, limit) in [(0.36, 0.3496678070358349), (-0.4, -0.3657959368312455)] {
        match solve_travel(&nominal(), request, 0.0).unwrap_err() {
            Refusal::Unreachable { value, limit: what } => {
                assert_eq!(what, Singular::TravelLimit);
                // The solver stops where the slope is about 1/condition, with half of the digits. The error of the
                // height is the square of this: well below a micrometre.
                assert!((value - limit).abs() < 1e-6, "{value}");
            }
            other => panic!("{other:?}"),
        }
        assert!(solve_travel(&nominal(), limit * (1.0 - 1e-6), 0.0).is_ok());
    }
    for rack in [-0.25, 0.25] {
        assert!(solve_travel(&nominal(), 0.0, rack).is_err());
    }
}
