//! Tests of the paper's formulation against reference values of 110 digits.

use super::{bound, number, reference, size, strut, vector, with_points};
use crate::support::larger;
use hardpoint::attia::Drive;
use hardpoint::attia::Moving;
use hardpoint::attia::StrutPoints;
use hardpoint::attia::{Motion, Rates};
use hardpoint::attia::{PointCoordinates, Pose, Station};
use hardpoint::attia::{attia_camber, attia_kingpin};
use hardpoint::characteristics::Characteristic;
use hardpoint::number::{Jet, Vector3};
use serde_json::Value;

fn solved(case: &Value, state: &Value, points: StrutPoints) -> (PointCoordinates, Pose) {
    let value = &state["drive"]["value"];
    let (drive, value) = match state["drive"]["kind"].as_str().unwrap() {
        "travel" => (Drive::Travel, number(value)),
        "paper_theta" => (Drive::PaperTheta, number(value)),
        _ => (Drive::ArmAngle, number(&state["arm_delta"]["d0"])),
    };
    let strut = with_points(&strut(case), |p| to_left_wheel(case, p));
    let mechanism = PointCoordinates::new(&strut, points, drive).unwrap();
    let station = Station {
        value,
        rack: number(&state["drive"]["rack"]),
    };
    let pose = mechanism.track(&mechanism.design(), station).unwrap();
    (mechanism, pose)
}

/// Mirrors a point or its derivative to the left wheel, for which the equations are written.
fn to_left_wheel(case: &Value, v: Vector3<f64>) -> Vector3<f64> {
    let side = case.get("side").map_or(1.0, number);
    Vector3::new(v.x, side * v.y, v.z)
}

/// Mirrors an angular velocity or acceleration to the left wheel. The mirror image has the opposite sense of rotation.
fn turning_to_left_wheel(case: &Value, v: Vector3<f64>) -> Vector3<f64> {
    let side = case.get("side").map_or(1.0, number);
    to_left_wheel(case, v) * side
}

fn compare(name: &str) {
    let case = reference(name);
    let point = |value: &Value| to_left_wheel(&case, vector(value));
    let turning = |value: &Value| turning_to_left_wheel(&case, vector(value));
    for (state, points) in case["states"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|s| [(s, StrutPoints::Spread), (s, StrutPoints::Study)])
    {
        let (mechanism, pose) = solved(&case, state, points);
        let check = |order: usize, now: &Moving, expected: &Value| {
            let bound = bound(&mechanism, &pose, order, size(now));
            for n in [5, 6, 7, 8, 10, 11] {
                let name = format!("p{n}");
                let design = point(&case["hardpoints"][&name]);
                let error = mechanism.knuckle_point(design).of(now) - point(&expected[&name]);
                assert!(
                    error.norm() < bound,
                    "{name}, order {order}: {error:?}, {bound:e}"
                );
            }
            if points == StrutPoints::Study {
                let error = now[4] - point(&expected["p9"]);
                assert!(
                    error.norm() < bound,
                    "p9, order {order}: {error:?}, {bound:e}"
                );
            }
        };
        check(0, pose.moving(), &state["positions"]);
        for (rates, names) in [
            (Rates::BY_DRIVE, ["d1", "d2"]),
            (Rates::BY_RACK, ["rack_d1", "rack_d2"]),
        ] {
            let motion = mechanism.motion(&pose, rates).unwrap();
            check(1, &motion.velocity, &state[names[0]]);
            check(2, &motion.acceleration, &state[names[1]]);
        }

        let motion = mechanism.motion(&pose, Rates::BY_DRIVE).unwrap();
        let lever = 0.05 * case.get("length_scale").map_or(1.0, number);
        check_angular(
            (&mechanism, &pose, lever),
            &motion,
            turning(&state["omega_per_drive"]),
            turning(&state["alpha_per_drive"]),
        );

        let time = &state["time"];
        let rates = Rates {
            drive: number(&time["drive_rate"]),
            drive_acceleration: number(&time["drive_accel"]),
            rack: number(&time["rack_rate"]),
            rack_acceleration: number(&time["rack_accel"]),
        };
        let motion = mechanism.motion(&pose, rates).unwrap();
        check(1, &motion.velocity, &time["vel"]);
        check(2, &motion.acceleration, &time["acc"]);
        check_angular(
            (&mechanism, &pose, lever),
            &motion,
            turning(&time["omega"]),
            turning(&time["alpha"]),
        );
    }
}

/// A velocity error divided by the shortest lever is an error of angular velocity. The lever is the ball joint's
/// distance from the strut axis, more than 50 mm in all these cases.
fn check_angular(
    (mechanism, pose, lever): (&PointCoordinates, &Pose, f64),
    motion: &Motion,
    omega: Vector3<f64>,
    alpha: Vector3<f64>,
) {
    let angular = mechanism.angular_motion(pose, motion);
    for (order, now, of, expected) in [
        (1, angular.velocity, motion.velocity, omega),
        (2, angular.acceleration, motion.acceleration, alpha),
    ] {
        let error = (now - expected).norm();
        let bound = bound(mechanism, pose, order, size(&of)) / lever;
        assert!(error < bound, "order {order}: {error:e}, bound {bound:e}");
    }
}

#[test]
fn the_paper_s_example_to_the_accuracy_of_its_conditioning() {
    compare("attia-example");
}

#[test]
fn a_road_car_to_the_accuracy_of_its_conditioning() {
    compare("nominal");
    compare("nominal-axis-through-top");
    compare("nominal-right");
    compare("nominal-in-mm");
    compare("vertical-strut");
}

#[test]
fn angular_velocity_in_the_plane_of_6_7_8_is_no_obstacle() {
    compare("angular-velocity-in-plane");
}

/// Equation (25) fails if omega lies in the plane of points 6, 7 and 8, because it then divides about 1e-16 by about
/// 1e-16. The method of least squares finds omega from the same velocities, up to rounding errors.
#[test]
fn equation_25_fails_where_omega_lies_in_the_plane_of_6_7_8() {
    let case = reference("angular-velocity-in-plane");
    let mut worst = 0.0_f64;
    for state in case["states"].as_array().unwrap().iter().take(5) {
        let (mechanism, pose) = solved(&case, state, StrutPoints::Study);
        let motion = mechanism.motion(&pose, Rates::BY_DRIVE).unwrap();
        let ([_, p6, _, p8, _], [_, v6, v7, v8, _]) = (*pose.moving(), motion.velocity);
        let quotient = (v7 - v6).cross(v8 - v6) * (1.0 / (v7 - v6).dot(p8 - p6));
        let omega = vector(&state["omega_per_drive"]);
        worst = larger(worst, (quotient - omega).norm() / omega.norm());
        let ours = mechanism.angular_motion(&pose, &motion).velocity;
        assert!((ours - omega).norm() < 1e-12 * omega.norm());
    }
    assert!(worst > 0.01, "{worst}");
}

/// If points 6 and 7 of the study are only a millimetre apart, they reduce the accuracy. The condition number shows by
/// how much. If the formulation spreads the points, they do not reduce the accuracy.
#[test]
fn close_strut_points_cost_accuracy_unless_they_are_spread() {
    let case = reference("strut-points-1mm");
    let condition = |points| {
        let mut strut = strut(&case);
        // In this case, the strut's line runs from point 6 to point 4. Point 7 is on this line, a millimetre from point
        // 6.
        strut.strut_upper =
            (points == StrutPoints::Study).then(|| vector(&case["hardpoints"]["p7"]));
        let mechanism = PointCoordinates::new(&strut, points, Drive::Travel).unwrap();
        mechanism.condition(&mechanism.design())
    };
    assert!(condition(StrutPoints::Study) > 100.0 * condition(StrutPoints::Spread));
    for state in case["states"].as_array().unwrap() {
        let (mechanism, pose) = solved(&case, state, StrutPoints::Study);
        let error = mechanism.wheel_centre().of(pose.moving()) - vector(&state["positions"]["p10"]);
        assert!(error.norm() < bound(&mechanism, &pose, 0, 1.0));
    }
}

/// The angles of (16) and (17) and their derivatives agree with Taylor series over the motion of points 5, 7 and 10.
#[test]
fn the_paper_s_angles_and_their_derivatives() {
    for name in ["attia-example", "angular-velocity-in-plane"] {
        let case = reference(name);
        for state in case["states"].as_array().unwrap() {
            let (mechanism, pose) = solved(&case, state, StrutPoints::Study);
            let motion = mechanism.motion(&pose, Rates::BY_DRIVE).unwrap();
            let series = |of: &dyn Fn(&Moving) -> Vector3<f64>| {
                let [p, v, a] = [pose.moving(), &motion.velocity, &motion.acceleration].map(of);
                let jet = |p, v, a| Jet([p, v, 0.5 * a]);
                Vector3::new(jet(p.x, v.x, a.x), jet(p.y, v.y, a.y), jet(p.z, v.z, a.z))
            };
            let (p5, p7) = (series(&|m| m[0]), series(&|m| m[2]));
            let p10 = series(&|m| mechanism.wheel_centre().of(m));
            for (angle, name) in [
                (attia_kingpin(p5, p7), "paper_alpha"),
                (attia_camber(p7, p10), "paper_beta"),
            ] {
                let expected = &state["angles"][name];
                for (order, key) in ["d0", "d1", "d2"].into_iter().enumerate() {
                    let (now, expected) = (angle.derivative(order), number(&expected[key]));
                    // The lines 5-7 and 7-10 are at least 0.15 m long. A derivative of order k has terms with the (k +
                    // 1)-th power of their inverse.
                    let largest = size(&motion.acceleration).max(1.0);
                    let bound =
                        bound(&mechanism, &pose, order, largest) / 0.15_f64.powi(order as i32 + 1);
                    assert!(
                        (now - expected).abs() < bound,
                        "{name} {key}: {now} {expected}"
                    );
                }
            }
        }
    }
}

/// The angles are positive where the catalogue says so. A strut leans inboard, and the wheel centre is outboard of it.
#[test]
fn the_paper_s_angles_have_the_signs_of_the_catalogue() {
    let (low, high) = (0.2, 0.6);
    let (inboard, outboard) = (0.5, 0.7);
    let upper = Vector3::new(0.0, inboard, high);
    let centre = Vector3::new(0.0, outboard, low);
    assert!(attia_camber(upper, centre) > 0.0);
    let ball_joint = |y| Vector3::new(0.0, y, low);
    assert!(attia_kingpin(ball_joint(inboard - 0.1), upper) > 0.0);
    assert!(attia_kingpin(ball_joint(outboard), upper) < 0.0);
    for (name, positive) in [
        (
            "attia_camber",
            "wheel_centre below strut_upper and outboard of it",
        ),
        ("attia_kingpin", "strut_upper outboard of lower_ball_joint"),
    ] {
        assert_eq!(
            Characteristic::named(name).unwrap().info().positive,
            positive
        );
    }
}
