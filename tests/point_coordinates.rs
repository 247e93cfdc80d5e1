//! The paper's formulation against its own table, against answers of 110 digits, and at its limits.

use hardpoint::kinematics::point_coordinates::{
    Drive, Motion, Moving, PointCoordinates, Pose, Rates, Refusal, Singular, Station, Strut,
    StrutPoints, attia_camber, attia_kingpin, solve_travel,
};
use hardpoint::number::{Jet, Vector3};
use serde_json::Value;
use std::f64::consts::PI;

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data");

fn reference(name: &str) -> Value {
    let text = std::fs::read_to_string(format!("{DATA}/reference/{name}.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn number(value: &Value) -> f64 {
    value
        .as_str()
        .map_or_else(|| value.as_f64().unwrap(), |text| text.parse().unwrap())
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

fn strut(case: &Value) -> Strut {
    let p = |n: usize| vector(&case["hardpoints"][format!("p{n}")]);
    Strut {
        lower_arm_front: p(1),
        lower_arm_rear: p(2),
        tie_rod_inner: p(3),
        strut_top: p(4),
        lower_ball_joint: p(5),
        strut_lower: p(6),
        strut_upper: Some(p(7)),
        tie_rod_outer: p(8),
        rod_point: Some(p(9)),
        wheel_centre: p(10),
    }
}

fn at(value: f64) -> Station {
    Station { value, rack: 0.0 }
}

/// The paper's example with its drive, at a time of Table 2: eleven vectors in the table's order.
fn table_row(theta: [f64; 3]) -> Vec<Vector3<f64>> {
    let strut = strut(&reference("attia-example"));
    let mechanism = PointCoordinates::new(&strut, StrutPoints::Study, Drive::PaperTheta).unwrap();
    let pose = mechanism.track(&mechanism.design(), at(theta[0])).unwrap();
    let rates = Rates {
        drive: theta[1],
        drive_acceleration: theta[2],
        ..Rates::default()
    };
    let motion = mechanism.motion(&pose, rates).unwrap();
    let angular = mechanism.angular_motion(&pose, &motion);
    let all = [pose.moving(), &motion.velocity, &motion.acceleration];
    let centre = mechanism.wheel_centre();
    let mut row: Vec<_> = all.map(|m| m[3]).into();
    row.extend(all.map(|m| m[4]));
    row.extend(all.map(|m| centre.of(m)));
    row.extend([angular.velocity, angular.acceleration]);
    row
}

/// Entries of Table 2 that are not within half a unit of their last printed digit:
/// name, printed, computed to three decimals.
fn misses(theta: impl Fn(f64) -> [f64; 3]) -> Vec<(String, f64, String)> {
    let table = std::fs::read_to_string(format!("{DATA}/attia-table-2.csv")).unwrap();
    let lines: Vec<Vec<&str>> = table
        .lines()
        .skip(1)
        .map(|l| l.split(',').collect())
        .collect();
    assert_eq!(lines.len(), 33);
    let mut missed = Vec::new();
    for (rows, time) in lines.chunks(11).zip([0.0, 1.0, 2.0]) {
        for (line, computed) in rows.iter().zip(table_row(theta(time))) {
            assert_eq!(line[0].parse::<f64>().unwrap(), time);
            for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
                let printed = line[2 + k];
                let decimals = printed
                    .split_once('.')
                    .map_or(0, |(_, digits)| digits.len());
                let half_a_unit = 0.5 * 0.1_f64.powi(decimals as i32);
                let (printed, computed) = (printed.parse::<f64>().unwrap(), computed.to_array()[k]);
                if (printed - computed).abs() > half_a_unit {
                    let name = format!("{} {axis} at {time} s", line[1]);
                    missed.push((name, printed, format!("{computed:.4}")));
                }
            }
        }
    }
    missed
}

#[test]
fn ninety_entries_of_table_2_come_out_and_nine_do_not() {
    let missed = misses(|t| [1.0 + t + 0.5 * t * t, 1.0 + t, 1.0]);
    let missed: Vec<_> = missed
        .iter()
        .map(|(name, printed, computed)| (name.as_str(), *printed, computed.as_str()))
        .collect();
    let expected = [
        ("position_10 y at 1 s", 0.34, "0.3104"),
        ("velocity_10 x at 1 s", -0.007, "0.0002"),
        ("velocity_10 y at 1 s", -0.6, "-0.6630"),
        ("acceleration_10 x at 1 s", 0.14, "0.1571"),
        ("acceleration_10 z at 1 s", 0.82, "1.0213"),
        ("alpha_knuckle y at 1 s", 0.3, "-0.2989"),
        ("velocity_9 y at 2 s", 0.22, "0.0221"),
        ("position_10 x at 2 s", 1.59, "1.5981"),
        ("position_10 y at 2 s", 0.5, "0.4488"),
    ];
    assert_eq!(missed, expected);
}

/// The drive as printed, 1 + t + t^2, is a misprint. At the start it has the same angle and rate, so
/// that only accelerations can tell; at 1 s and 2 s next to nothing of the table comes out.
#[test]
fn with_the_printed_drive_the_table_does_not_come_out() {
    let missed = misses(|t| [1.0 + t + t * t, 1.0 + 2.0 * t, 2.0]);
    let missed_at = |time: &str| {
        missed
            .iter()
            .filter(|(name, ..)| name.ends_with(time))
            .count()
    };
    assert_eq!(33 - missed_at("at 0 s"), 22);
    assert_eq!(33 - missed_at("at 1 s"), 3);
    assert_eq!(33 - missed_at("at 2 s"), 1);
}

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

/// Bound on the rounding error of a derivative of this order. `largest` is the size of what is computed.
///
/// At a solution each of the fifteen equations holds to 8 D M eps, with D the largest distance and M the
/// largest coordinate (the solver's own bound). The unknowns are off by no more than the norm of the
/// inverse Jacobian times sqrt(15) 8 D M eps, and the Jacobian's norm is at least 2 D: together
/// 16 eps M times the condition number. Derivatives inherit the errors of the orders below: once more
/// for each.
fn bound(mechanism: &PointCoordinates, pose: &Pose, order: usize, largest: f64) -> f64 {
    16.0 * (order + 1) as f64 * f64::EPSILON * mechanism.condition(pose) * largest.max(1.0)
}

fn solved(case: &Value, state: &Value, points: StrutPoints) -> (PointCoordinates, Pose) {
    let value = &state["drive"]["value"];
    let (drive, value) = match state["drive"]["kind"].as_str().unwrap() {
        "travel" => (Drive::Travel, number(value)),
        "paper_theta" => (Drive::PaperTheta, number(value)),
        _ => (Drive::ArmAngle, number(&state["arm_delta"]["d0"])),
    };
    let mechanism = PointCoordinates::new(&strut(case), points, drive).unwrap();
    let station = Station {
        value,
        rack: number(&state["drive"]["rack"]),
    };
    let pose = mechanism.track(&mechanism.design(), station).unwrap();
    (mechanism, pose)
}

fn size(points: &Moving) -> f64 {
    points.iter().map(|p| p.norm()).fold(0.0, f64::max)
}

fn compare(name: &str) {
    let case = reference(name);
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
                let design = vector(&case["hardpoints"][&name]);
                let error = mechanism.knuckle_point(design).of(now) - vector(&expected[&name]);
                assert!(
                    error.norm() < bound,
                    "{name}, order {order}: {error:?}, {bound:e}"
                );
            }
            if points == StrutPoints::Study {
                let error = now[4] - vector(&expected["p9"]);
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
        check_angular(
            &mechanism,
            &pose,
            &motion,
            &state["omega_per_drive"],
            &state["alpha_per_drive"],
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
        check_angular(&mechanism, &pose, &motion, &time["omega"], &time["alpha"]);
    }
}

/// A velocity error turns into one of angular velocity by the shortest lever: the ball joint's distance
/// from the strut's axis, more than 50 mm in all of these cases.
fn check_angular(
    mechanism: &PointCoordinates,
    pose: &Pose,
    motion: &Motion,
    omega: &Value,
    alpha: &Value,
) {
    let angular = mechanism.angular_motion(pose, motion);
    for (order, now, of, expected) in [
        (1, angular.velocity, motion.velocity, omega),
        (2, angular.acceleration, motion.acceleration, alpha),
    ] {
        let error = (now - vector(expected)).norm();
        let bound = bound(mechanism, pose, order, size(&of)) / 0.05;
        assert!(error < bound, "order {order}: {error:e}, bound {bound:e}");
    }
}

#[test]
fn the_paper_s_example_to_the_accuracy_of_its_conditioning() {
    compare("attia-example");
}

#[test]
fn angular_velocity_in_the_plane_of_6_7_8_is_no_obstacle() {
    compare("angular-velocity-in-plane");
}

/// Equation (25) on the very velocities from which the least squares get omega to rounding: some 1e-16
/// over some 1e-16.
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
        worst = worst.max((quotient - omega).norm() / omega.norm());
        let ours = mechanism.angular_motion(&pose, &motion).velocity;
        assert!((ours - omega).norm() < 1e-12 * omega.norm());
    }
    assert!(worst > 0.01, "{worst}");
}

/// Points 6 and 7 a millimetre apart: the study's own points cost accuracy, and the condition number
/// says how much; spread points do not.
#[test]
fn close_strut_points_cost_accuracy_unless_they_are_spread() {
    let case = reference("strut-points-1mm");
    let condition = |points| {
        let mut strut = strut(&case);
        if points == StrutPoints::Spread {
            strut.strut_upper = None;
        }
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

/// (16) and (17) with their derivatives, by Taylor series over the motion of 5, 7 and 10.
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
                    // The lines 5-7 and 7-10 are no shorter than 0.15 m; a derivative of order k has
                    // terms with the (k + 1)-th power of their inverse.
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

fn nominal() -> Strut {
    strut(&reference("angular-velocity-in-plane"))
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
    // A strut as horizontal as one can be with its top mount above the arm: its line level.
    assert_eq!(
        singular(&|s| {
            s.strut_lower = s.strut_top + Vector3::new(0.02, 0.4, 0.0);
            s.strut_upper = None;
        }),
        Refusal::Singular(Singular::HorizontalStrut)
    );
    assert_eq!(
        singular(&|s| {
            s.strut_lower = s.lower_ball_joint + (s.strut_top - s.lower_ball_joint) * 0.3;
            s.strut_upper = None;
        }),
        Refusal::Singular(Singular::BallJointOnStrutAxis)
    );
    assert_eq!(
        singular(&|s| {
            let axis = s.axis();
            s.tie_rod_outer =
                s.lower_ball_joint + (s.strut_top - s.lower_ball_joint) * 0.4 + axis * -0.3;
        }),
        Refusal::Singular(Singular::CoplanarKnuckle)
    );
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

/// A generator good enough to scatter hardpoints (Numerical Recipes' quick 64-bit one).
struct Scatter(u64);

impl Scatter {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn strut(&mut self, spread: f64) -> Strut {
        let s = nominal();
        let mut moved = |p: Vector3<f64>| p.map(|c| c + spread * self.next());
        Strut {
            lower_arm_front: moved(s.lower_arm_front),
            lower_arm_rear: moved(s.lower_arm_rear),
            tie_rod_inner: moved(s.tie_rod_inner),
            strut_top: moved(s.strut_top),
            lower_ball_joint: moved(s.lower_ball_joint),
            strut_lower: moved(s.strut_lower),
            strut_upper: s.strut_upper.map(&mut moved),
            tie_rod_outer: moved(s.tie_rod_outer),
            rod_point: None,
            wheel_centre: moved(s.wheel_centre),
        }
    }
}

/// 300 scattered struts over +-80 mm: the knuckle is rigid and not mirrored, the strut's line passes the
/// mount, the tie rod and the arm keep their lengths; a single jump arrives where small steps do.
#[test]
fn scattered_struts_stay_on_their_branch() {
    let mut scatter = Scatter(1);
    let (mut solved, mut refused) = (0, 0);
    for case in 0..300 {
        let strut = scatter.strut(0.02 + 0.06 * (case as f64 / 299.0));
        let Ok(mechanism) = PointCoordinates::new(&strut, StrutPoints::Spread, Drive::Travel)
        else {
            refused += 1;
            continue;
        };
        let design = mechanism.design();
        for end in [-0.08, 0.08] {
            let mut last = design;
            for step in 1..=80 {
                let station = at(end * step as f64 / 80.0);
                let Ok(pose) = mechanism.track(&last, station) else {
                    refused += 1;
                    assert!(mechanism.track(&design, station).is_err());
                    break;
                };
                last = pose;
                solved += 1;
                check_assembly(&strut, &mechanism, &pose);
                if step % 20 == 0 {
                    let jump = mechanism.track(&design, station).unwrap();
                    let apart = std::array::from_fn(|i| pose.moving()[i] - jump.moving()[i]);
                    assert!(
                        size(&apart) < 2.0 * bound(&mechanism, &pose, 0, 1.0),
                        "{case} {station:?}"
                    );
                }
            }
        }
    }
    println!("{solved} poses, {refused} refused");
    assert!(refused < 30, "{refused}");
}

fn check_assembly(strut: &Strut, mechanism: &PointCoordinates, pose: &Pose) {
    let ([a5, a6, a7, a8, _], [p5, p6, p7, p8, p9]) =
        (*mechanism.design().moving(), *pose.moving());
    // Twice the solver's own bound, 8 D M eps with D, M below 1.3 m.
    let rounding = 16.0 * 1.3 * 1.3 * f64::EPSILON;
    let (before, now) = ([a5, a6, a7, a8], [p5, p6, p7, p8]);
    for i in 0..4 {
        for j in 0..i {
            let change = (now[i] - now[j]).norm_squared() - (before[i] - before[j]).norm_squared();
            assert!(change.abs() < rounding);
        }
    }
    for (fixed, a, p) in [
        (strut.lower_arm_front, a5, p5),
        (strut.lower_arm_rear, a5, p5),
        (strut.tie_rod_inner, a8, p8),
    ] {
        assert!(((p - fixed).norm_squared() - (a - fixed).norm_squared()).abs() < rounding);
    }
    let volume = |p: [Vector3<f64>; 4]| (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]);
    assert!(volume(before) * volume(now) > 0.0, "mirrored");
    let along = (p7 - p6).normalised();
    for p in [strut.strut_top, p9] {
        // Equations (11)-(14) give two components of the vector products, over the axis's z.
        let off = (p - p6).cross(along).norm();
        assert!(
            off < rounding / ((p7 - p6).norm() * along.z.abs()),
            "{off:e}"
        );
    }
    assert!((p9 - strut.strut_top).dot(along) < 0.0, "rod reversed");
    let height = mechanism.wheel_centre().of(pose.moving()).z - strut.wheel_centre.z;
    let weights: f64 = mechanism.wheel_centre().shares().map(f64::abs).iter().sum();
    assert!((height - pose.station().value).abs() < rounding * weights / 0.2);
}

/// In millimetres it is the same computation: exactly so for a unit that is a power of two.
#[test]
fn the_unit_of_length_does_not_matter() {
    let s = nominal();
    let scaled = |k: f64| Strut {
        lower_arm_front: s.lower_arm_front * k,
        lower_arm_rear: s.lower_arm_rear * k,
        tie_rod_inner: s.tie_rod_inner * k,
        strut_top: s.strut_top * k,
        lower_ball_joint: s.lower_ball_joint * k,
        strut_lower: s.strut_lower * k,
        strut_upper: s.strut_upper.map(|p| p * k),
        tie_rod_outer: s.tie_rod_outer * k,
        rod_point: None,
        wheel_centre: s.wheel_centre * k,
    };
    for travel in [-0.08, 0.05] {
        let metres = solve_travel(&s, travel, 0.01).unwrap();
        let large = solve_travel(&scaled(1024.0), travel * 1024.0, 0.01 * 1024.0).unwrap();
        assert_eq!(large, metres.map(|p| p * 1024.0));
    }
}
