//! Singular designs, dead centres and the ends of the travel.

use super::{at, nominal, reference, strut, unsuitable};
use hardpoint::kinematics::point_coordinates::{
    Drive, PointCoordinates, Refusal, Singular, Strut, StrutPoints, solve_travel,
};
use hardpoint::number::Vector3;
use std::f64::consts::PI;

/// The drive turns back at theta = pi (t = 1.2985 s): refused there, followed on either side of it.
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

/// With point 1 half a metre ahead, d51 exceeds the arm's radius: no solution near pi, the same side
/// afterwards.
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
    // A micrometre between 6 and 7 leaves fewer than half of the digits.
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
                // Half of the digits are left where the slope is 1/condition, so the height is known
                // to its square: well within a micrometre.
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
