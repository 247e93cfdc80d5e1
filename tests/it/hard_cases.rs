//! Tests of difficult cases from the reference and other sources: states near folds (ends of travel) and toggles, the
//! folds themselves, and requests without a solution. Condition numbers give the bounds of the errors.

use crate::support::larger;
use crate::support::random::Random;
use crate::support::{AXES, Case, motion, number, order_to, sensitivity_errors, vector};
use hardpoint::analyse::RangeEnd;
use hardpoint::characteristics::{Characteristic, Constants, Quantity, WheelReading};
use hardpoint::curves::curves;
use hardpoint::derive::{DesignSeries, MotionPoint};
use hardpoint::mechanism::Failure;
use hardpoint::mechanism::LimitCause;
use hardpoint::model::Drive;
use hardpoint::number::Vector3;
use hardpoint::plan::Plan;
use hardpoint::solve::{Acceptance, Rejection, Solver, StationOrder};
use serde_json::Value;
use std::ops::ControlFlow;

/// Returns true if a motion with this drive reaches the state from the design position. The reference also lists other
/// assemblies with the same drive value.
fn is_connected(case: &Case, state: &Value) -> bool {
    let label = state["label"].as_str().unwrap_or("");
    let other_mode = state["drive"]["kind"] == "arm_delta" && state["drive"]["tierod_mode"] == -1;
    // w is the distance of point p8 from the plane of p5, p4 and p3. At the toggle, w is zero. If w has the same sign
    // in the design position and at the fold of travel, the toggle is beyond the fold. This is the case upward, but not
    // downward.
    let toggle_beyond = label.contains("w=0") && {
        let end = if motion(state).1 > 0.0 { "up" } else { "down" };
        let designed = number(&case.json["design"]["p8_distance_from_plane_5_4_3"]);
        designed * number(&case.json["travel_folds"][end]["w"]) > 0.0
    };
    !label.starts_with("beyond") && !other_mode && !toggle_beyond
}

/// Returns the failure of a visit to one station, or `None` if the station has a pose.
fn failure(case: &Case, state: &Value) -> Option<Failure> {
    let (drive, value, rack, _) = motion(state);
    let mut failure = None;
    case.solver()
        .for_each_pose(drive, &order_to(value), rack, |_, _, pose| {
            failure = pose.err();
            ControlFlow::Continue(())
        })
        .unwrap();
    failure
}

/// Checks every existing state against a bound from its condition number k. Positions agree to max(1e-14, 8 e k), angles to
/// twice this bound. Derivatives and sensitivities agree to max(1e-13, 8 e k^2), relative to the largest of their kind
/// (module `conditioning`). Here e is the machine epsilon. The factor 8 covers rounding errors of the residuals, which are
/// sums of up to eight products. Far from the origin, rounding errors of residuals are relative to the coordinates. There e,
/// 1e-14 and 1e-13 are multiplied by the ratio of the coordinates to the size of the mechanism. Returns the number of
/// checked states.
fn check(name: &str) -> usize {
    check_case(name, &Case::read(name))
}

fn check_case(name: &str, case: &Case) -> usize {
    let design_series = DesignSeries::<3>::new(&case.mechanism, &case.design);
    let mut solver = case.solver();
    let size = solver.size();
    let coarse = match case.mechanism.coordinate_scale(&case.design) / size {
        far if far > 100.0 => far,
        _ => 1.0,
    };
    let mut checked = 0;
    for state in case.states().iter().filter(|s| s["exists"] == true) {
        if !is_connected(case, state) {
            continue;
        }
        let (drive, value, rack, sign) = motion(state);
        solver
            .for_each_pose(drive, &order_to(value), rack, |solver, _, pose| {
                let pose = pose.unwrap_or_else(|f| panic!("{name} {:?}: {f}", state["drive"]));
                let point = MotionPoint { drive, value, rack };
                let k = solver.conditioning(pose, &point).number;
                let bound = [
                    (8.0 * f64::EPSILON * k).max(1e-14),
                    (8.0 * f64::EPSILON * k * k).max(1e-13),
                    (8.0 * f64::EPSILON * k * k).max(1e-13),
                ]
                .map(|bound| coarse * bound);
                let at = solver
                    .configuration_series(&design_series, pose, &point.along_drive())
                    .unwrap();
                let view = WheelReading::of(&at, Constants::default());
                let mut worst = [0.0_f64; 3];
                let mut largest = [size, 0.0, 0.0];
                let mut found = Vec::new();
                for p in ["p5", "p6", "p7", "p8", "p9", "p10", "p11"] {
                    for (order, key) in ["positions", "d1", "d2"].into_iter().enumerate() {
                        let wanted = case.frame.vector(vector(&state[key][p])).to_array();
                        for axis in AXES {
                            let wanted = wanted[axis as usize] * sign.powi(order as i32);
                            let series =
                                view.value(&at, Quantity::Coordinate(case.point(p), axis));
                            if order > 0 {
                                largest[order] = larger(largest[order], wanted.abs());
                            }
                            found.push((order, series.derivative(order) - wanted));
                        }
                    }
                }
                for (order, error) in found {
                    assert!(error.is_finite());
                    worst[order] = larger(worst[order], (error / largest[order]).abs());
                }
                for (name, c) in [
                    ("camber", Characteristic::Camber),
                    ("toe", Characteristic::Toe),
                    ("kpi", Characteristic::KingpinInclination),
                    ("caster", Characteristic::Caster),
                ] {
                    let series = view.value(&at, Quantity::Characteristic(c));
                    let error = series[0] - number(&state["angles"][name]["d0"]);
                    assert!(error.abs() <= 2.0 * bound[0], "{name} {error:e}");
                }
                println!(
                    "{name} {drive:?} {value:<22} k {k:.1e}  errors {:.1e} {:.1e} {:.1e}  of bounds {:.1e} {:.1e}",
                    worst[0], worst[1], worst[2], bound[0], bound[1]
                );
                for order in 0..3 {
                    assert!(worst[order] <= bound[order], "{name} {drive:?} {value} order {order}");
                }
                if state.get("sens").is_some() {
                    let motion = point.along_drive();
                    let linearised = solver.linearised(&design_series, pose, &motion).unwrap();
                    let errors = sensitivity_errors(case, state, sign, &view, &linearised);
                    println!("    sensitivities {:.1e} {:.1e} {:.1e}", errors[0].0, errors[1].0, errors[2].0);
                    for error in errors {
                        assert!(error.0 <= bound[1], "{name} {drive:?} {value} {:e}", error.0);
                    }
                }
                checked += 1;
                ControlFlow::Continue(())
            })
            .unwrap();
    }
    checked
}

#[test]
fn states_beside_the_folds_of_travel() {
    assert_eq!(check("travel-limit"), 10);
}

#[test]
fn states_beside_the_toggle_of_the_tie_rod() {
    assert_eq!(check("tie-rod-toggle"), 17);
}

#[test]
fn strut_points_a_millimetre_apart() {
    assert_eq!(check("strut-points-1mm"), 3);
}

#[test]
fn angular_velocity_in_the_plane_of_three_points() {
    assert_eq!(check("angular-velocity-in-plane"), 8);
}

/// Results for degenerate designs agree with reference values from another formulation (`tests/data/own`).
#[test]
fn own_hard_cases() {
    for (name, states, beyond) in [
        ("assemblies-2um", 7, 2),
        ("ball-joint-on-strut-axis", 3, 0),
        ("coplanar-knuckle", 3, 0),
        ("far-from-origin", 3, 0),
        ("half-turn", 2, 0),
        ("planar", 6, 2),
        ("strut-points-1um", 2, 0),
    ] {
        let case = Case::own(name);
        assert_eq!(check_case(name, &case), states, "{name}");
        let mut refused = 0;
        for state in case.states().iter().filter(|s| s["exists"] == false) {
            let (drive, value, rack, sign) = motion(state);
            let known = sign * number(&state["limit"]);
            let range = case.solver().drive_range(drive, rack).unwrap();
            let end = if value > 0.0 {
                range.upper
            } else {
                range.lower
            };
            let RangeEnd::Fold(exact) = end else {
                panic!("{name} {end:?}")
            };
            let size = case.solver().size();
            let bound = match drive {
                Drive::Travel => 4.0 * f64::EPSILON * size,
                // The squared distance of p8 from its plane falls from 1e-12 m^2 to zero at the toggle. It is computed
                // from squares of lengths, which have rounding errors.
                Drive::ArmAngle => 8.0 * f64::EPSILON * size * size * known.abs() / 1e-12,
            };
            match failure(&case, state) {
                Some(Failure::Unreachable { limit, cause, .. }) => {
                    let error = limit - known;
                    println!("{name} {limit:e} error {error:.1e} of {bound:.1e} {cause:?}");
                    assert!(error.abs() <= bound, "{error:e}");
                    assert!((exact.value - known).abs() <= bound);
                    let expected = match name {
                        "assemblies-2um" => LimitCause::TieRodToggle,
                        _ if value > 0.0 => LimitCause::CentreHighest,
                        _ => LimitCause::CentreLowest,
                    };
                    assert_eq!(cause, expected);
                    refused += 1;
                }
                other => panic!("{name} {:?}: {other:?}", state["drive"]),
            }
        }
        assert_eq!(refused, beyond, "{name}");
    }
}

#[test]
fn what_has_no_solution_is_refused_with_the_limit() {
    let case = Case::read("no-assembly");
    let racks = &case.json["rack_limits_at_zero_travel_float"];
    for state in case.states() {
        assert_eq!(state["exists"], false);
        let found = failure(&case, state);
        println!("{found:?}");
        match found.expect("a refusal") {
            Failure::Unreachable { drive, limit, .. } => {
                assert_eq!(drive, Drive::Travel);
                let known = if motion(state).1 > 0.0 {
                    0.34966781
                } else {
                    -0.36579594
                };
                assert!((limit - known).abs() < 1e-8, "{limit}");
            }
            Failure::RackUnreachable { limit, .. } => {
                let known = number(&racks[if limit > 0.0 { "rack+1" } else { "rack-1" }]);
                // The file contains the limit with nine decimals.
                assert!((limit - known).abs() <= 0.5e-9, "{limit} {known}");
            }
            other => panic!("{:?}: {other}", state["drive"]),
        }
    }
}

/// The closed form estimates condition numbers correctly within a factor of ten. The test moves each coordinate at random by up
/// to 16 % of the suspension's size. The program computes condition numbers above 1000 exactly.
#[test]
fn estimated_condition_numbers_hold_to_a_factor_of_ten() {
    for name in ["macpherson_solve.toml", "double_wishbone_solve.toml"] {
        let suspension = crate::support::study(name, &[]).into_wheel();
        let mechanism = &suspension.mechanism;
        let size = suspension.size();
        let (mut least, mut most, mut estimated, mut exact) = (f64::INFINITY, 0.0_f64, 0, 0);
        for number in 0..2000 {
            let random = &mut Random(number);
            let scatter = [0.01, 0.05, 0.16][number as usize % 3] * size;
            let design = random.scattered(&suspension.design, scatter);
            let Ok(mut solver) = Solver::new(mechanism, &design) else {
                continue;
            };
            let (drive, unit) = match number % 4 {
                0 => (Drive::ArmAngle, 1.0),
                _ => (Drive::Travel, size),
            };
            let values: Vec<f64> = (-4..=4).map(|k| 0.025 * k as f64 * unit).collect();
            let station_order = StationOrder::through(&values);
            let series = DesignSeries::<1>::new(mechanism, &design);
            let visited =
                solver.for_each_pose(drive, &station_order, 0.0, |solver, station, pose| {
                    if let Ok(pose) = pose {
                        let point = MotionPoint {
                            drive,
                            value: values[station],
                            rack: 0.0,
                        };
                        let conditioned =
                            solver.conditioned_series(&series, pose, &point.along_drive());
                        let found = conditioned.unwrap().1.number;
                        let true_one = solver.conditioning(pose, &point).number;
                        if found == true_one {
                            exact += 1
                        } else {
                            assert!(found < 1e3);
                            least = least.min(found / true_one);
                            most = larger(most, found / true_one);
                            estimated += 1;
                        }
                    }
                    ControlFlow::Continue(())
                });
            assert!(visited.is_ok() || number % 3 == 2);
        }
        println!("{name}: {estimated} estimated, {exact} exact, ratios {least:.2} to {most:.2}");
        assert!(estimated > 1000);
        assert!(least > 0.1 && most < 10.0);
    }
}

/// The limits of travel agree with values known to 45 digits. Their derivatives with respect to every hardpoint agree,
/// too.
#[test]
fn limits_of_travel_are_exact() {
    let case = Case::read("travel-limit");
    let mut solver = case.solver();
    let size = solver.size();
    let limits = solver.limits().unwrap();
    for (end, key, cause) in [
        (&limits.travel.upper, "up", LimitCause::CentreHighest),
        (&limits.travel.lower, "down", LimitCause::CentreLowest),
    ] {
        let known = &case.json["limits"][key];
        let RangeEnd::Fold(limit) = end else {
            panic!("{end:?}")
        };
        let error = limit.value - number(&known["travel"]);
        println!("{key} {} error {error:.1e} {:?}", limit.value, limit.cause);
        assert!(error.abs() <= 4.0 * f64::EPSILON * size, "{error:e}");
        assert_eq!(limit.cause, cause);
        let mut worst = 0.0_f64;
        let mut count = 0;
        for (param, value) in known["limit_sensitivity"].as_object().unwrap() {
            let (point, axis) = param.split_once('.').unwrap();
            let axis = AXES.into_iter().find(|a| a.name() == axis).unwrap();
            let found: Vector3<f64> = case.frame.vector(limit.gradient[case.point(point).0]);
            worst = larger(
                worst,
                (found.to_array()[axis as usize] - number(value)).abs(),
            );
            count += 1;
        }
        println!("{count} sensitivities to {worst:.1e}");
        assert!(count >= 27 && worst < 1e-12, "{worst:e}");
    }
    // The arm can make a full turn.
    let arm = limits.arm_angle.unwrap();
    assert_eq!(
        (arm.lower, arm.upper),
        (RangeEnd::FullTurn, RangeEnd::FullTurn)
    );
}

#[test]
fn limits_at_the_toggle_of_the_tie_rod_are_exact() {
    let case = Case::read("tie-rod-toggle");
    let mut solver = case.solver();
    let size = solver.size();
    let limits = solver.limits().unwrap();
    let json = &case.json;
    let arm = limits.arm_angle.unwrap();
    // The reference measures the arm angle in the opposite direction.
    let wanted = [
        (
            &limits.travel.upper,
            number(&json["travel_folds"]["up"]["travel"]),
            size,
            LimitCause::CentreHighest,
        ),
        (
            &limits.travel.lower,
            number(&json["travel_folds"]["down"]["travel"]),
            size,
            LimitCause::CentreLowest,
        ),
        (
            &arm.upper,
            -number(&json["limit_arm_delta"][0]),
            1.0,
            LimitCause::TieRodToggle,
        ),
        (
            &arm.lower,
            -number(&json["limit_arm_delta"][1]),
            1.0,
            LimitCause::TieRodToggle,
        ),
    ];
    // Near both ends of the travel, the tie rod is close to its toggle. The solver still finds the ends, and names the toggle
    // as the nearest singularity.
    for (end, known, unit, cause) in wanted {
        let RangeEnd::Fold(limit) = end else {
            panic!("{end:?}")
        };
        let error = (limit.value - known) / unit;
        println!("{} error {error:.1e} {:?}", limit.value, limit.cause);
        assert!(error.abs() < 1e-13, "{error:e}");
        assert_eq!(limit.cause, cause);
        assert_eq!(limit.nearest.unwrap().cause, LimitCause::TieRodToggle);
    }
}

/// The program refuses a target that is a nanometre (or nanoradian) beyond a fold, and reports the fold as the limit.
#[test]
fn a_nanometre_beyond_a_fold_is_refused() {
    for (name, beyond) in [("travel-limit", 2), ("tie-rod-toggle", 4)] {
        let case = Case::read(name);
        let mut refused = 0;
        for state in case.states().iter().filter(|s| s["exists"] == false) {
            let (drive, value, _, _) = motion(state);
            match failure(&case, state) {
                Some(Failure::Unreachable { limit, cause, .. }) => {
                    let short = (value - limit).abs();
                    println!(
                        "{name} {:?}: short by {short:.2e}, {cause:?}",
                        state["drive"]["value"]
                    );
                    assert!((0.9e-9..1.1e-9).contains(&short), "{short:e}");
                    let tie_rod = name == "tie-rod-toggle" && drive == Drive::ArmAngle;
                    assert_eq!(cause == LimitCause::TieRodToggle, tie_rod);
                    refused += 1;
                }
                other => panic!("{name} {:?}: {other:?}", state["drive"]),
            }
        }
        assert_eq!(refused, beyond, "{name}");
    }
}

/// The fast solver (tracker) rejects stations near a fold and leaves them to the slower continuation. The result counts
/// these stations for each kind of rejection. The continuation solves the reachable ones.
#[test]
fn what_is_left_to_the_continuation_has_a_reason() {
    let solved = |name: &str, travel: &str| {
        let study = crate::support::study(name, &[&format!("motion.travel={travel}")]);
        curves(study.wheel(), &Plan::of(study.one_wheel().unwrap())).unwrap()
    };
    let wide = "{ from = -300.0, to = 300.0, steps = 41 }";
    let ordinary = solved("macpherson_solve.toml", "[-80.0, 0.0, 80.0]");
    assert_eq!(ordinary.left_to_continuation, []);
    let steep = solved("macpherson_solve.toml", wide);
    assert_eq!(steep.left_to_continuation, [(Rejection::FoldNear, 3)]);
    assert_eq!(steep.failed(), 0);
    let beyond = solved("double_wishbone_solve.toml", wide);
    let left = beyond.left_to_continuation.iter().map(|(_, count)| count);
    assert_eq!((left.sum::<usize>(), beyond.failed()), (9, 9));
}

/// A pose that fails several checks has the reason of the first one. A pose that passes all checks has no reason.
#[test]
fn the_first_check_that_fails_gives_the_reason() {
    for first in Rejection::ALL {
        let mut acceptance = Acceptance::everywhere(0.0_f64);
        acceptance.require(true, first);
        assert!(acceptance.lanes() && acceptance.reason(0).is_none());
        acceptance.require(false, first);
        for second in Rejection::ALL {
            for passes in [true, false] {
                acceptance.require(passes, second);
                assert!(!acceptance.lanes());
                assert_eq!(acceptance.reason(0), Some(first), "before {second:?}");
            }
        }
    }
}
