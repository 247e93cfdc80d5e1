//! Tests of certificates of poses and curves: the certified bounds hold for the reference, and the certifier never
//! certifies a false pose.

use crate::support::{Case, motion, order_to, vector};
use hardpoint::analyse::Certifier;
use hardpoint::derive::MotionPoint;
use hardpoint::mechanism::{Configuration, Failure};
use hardpoint::model::{Drive, Mechanism};
use hardpoint::number::Vector3;
use hardpoint::solve::{Solver, StationOrder};
use std::ops::ControlFlow;

/// Checks that the certified bound holds for every point of the reference. No bound may exceed `sharpness` times the
/// suspension size. A pose may be refused only if its condition number exceeds a million. Returns the numbers of certified
/// and refused poses.
fn check(name: &str, sharpness: f64) -> (usize, usize) {
    let case = Case::read(name);
    let certifier = Certifier::new(&case.mechanism, &case.design);
    let mut solver = case.solver();
    let size = solver.size();
    let (mut proved, mut refused) = (0, 0);
    for state in case.states().iter().filter(|s| s["exists"] == true) {
        let (drive, value, rack, _) = motion(state);
        let beyond = state["label"]
            .as_str()
            .is_some_and(|l| !l.starts_with("design"));
        if beyond && case.json["limits"].is_object() || state["drive"]["tierod_mode"] == -1 {
            continue;
        }
        solver
            .for_each_pose(drive, &order_to(value), rack, |solver, _, pose| {
                let pose = pose.unwrap();
                let point = MotionPoint { drive, value, rack };
                let certificate = match certifier.pose(pose, &point) {
                    Ok(certificate) => certificate,
                    Err(reason) => {
                        println!("{name} {drive:?} {value}: {reason}");
                        assert!(solver.conditioning(pose, &point).number > 1e6);
                        refused += 1;
                        return ControlFlow::Continue(());
                    }
                };
                assert!(certificate.error <= sharpness * size, "{certificate:?}");
                assert!(certificate.error <= certificate.uniqueness);
                let at = Configuration::new(&case.mechanism, &case.design, *pose, rack);
                for p in ["p5", "p8", "p10", "p11"] {
                    let id = case.point(p);
                    let wanted = case.frame.vector(vector(&state["positions"][p]));
                    let error = (at.point(id) - wanted).norm();
                    let lever = at.designed_lever(id).norm();
                    // Two further rounding errors are allowed: the computation of the point, and the conversion of the
                    // reference to doubles.
                    let rounding = 4.0 * f64::EPSILON * size;
                    let bound = certificate.point_error(lever) + rounding;
                    assert!(error <= bound, "{p} {error:e} {bound:e}");
                }
                proved += 1;
                if proved % 20 == 1 {
                    println!("{name} {drive:?} {value} {certificate:?}");
                }
                ControlFlow::Continue(())
            })
            .unwrap();
    }
    println!("{name}: {proved} proved, {refused} refused");
    (proved, refused)
}

#[test]
fn ordinary_poses_are_proved_to_rounding() {
    for (name, states) in [
        ("nominal", 32),
        ("nominal-right", 4),
        ("nominal-in-mm", 5),
        ("vertical-strut", 5),
    ] {
        assert_eq!(check(name, 2e-13), (states, 0), "{name}");
    }
}

/// Near a fold, the error of a pose grows in inverse proportion to the determinant of the Jacobian, and a second
/// solution is close. The program then gives a correct certificate or none. If both solutions are equal in double
/// precision, it gives none.
#[test]
fn beside_folds_and_toggles_the_proof_holds_or_is_refused() {
    let (proved, refused) = check("travel-limit", 1e-6);
    assert_eq!(proved + refused, 10);
    assert!(proved > 0);
}

/// Requests a certificate for each station: its pose is on the same solution branch as the design position. Returns the
/// error bounds or the failures.
fn certified(
    solver: &mut Solver,
    certifier: &Certifier,
    drive: Drive,
    values: &[f64],
    rack: f64,
) -> Vec<Result<f64, Failure>> {
    let mut found = vec![Err(Failure::Singular); values.len()];
    solver
        .for_each_certified_pose(
            certifier,
            drive,
            &StationOrder::through(values),
            rack,
            |_, station, proof| {
                // A separate certificate for this station is also valid, so the pose belongs to the station.
                if let Ok((pose, certificate)) = proof {
                    let point = MotionPoint {
                        drive,
                        value: values[station],
                        rack,
                    };
                    let alone = certifier.pose(pose, &point).unwrap();
                    assert!(alone.error <= 2.0 * certificate.error + 1e-15);
                }
                found[station] = proof.map(|(_, certificate)| certificate.error);
                ControlFlow::Continue(())
            },
        )
        .unwrap();
    found
}

#[test]
fn whole_curves_are_proved_to_be_one_branch() {
    let case = Case::read("nominal");
    let certifier = Certifier::new(&case.mechanism, &case.design);
    let mut solver = case.solver();
    let values: Vec<f64> = (-10..=10).map(|i| 0.01 * i as f64).collect();
    for rack in [0.0, 0.06, -0.06] {
        let start = std::time::Instant::now();
        let found = certified(&mut solver, &certifier, Drive::Travel, &values, rack);
        println!("{rack} {:?} {:?}", found[0], start.elapsed());
        assert!(found.iter().all(|r| r.is_ok_and(|e| e < 1e-13)));
    }
    let angles = [-0.3, -0.1, 0.2, 0.3];
    let found = certified(&mut solver, &certifier, Drive::ArmAngle, &angles, 0.0);
    assert!(
        found.iter().all(|r| r.is_ok_and(|e| e < 1e-13)),
        "{found:?}"
    );
    // The only stations are the ends of this range. The solver reaches both from the design position, without stations
    // between.
    let found = certified(&mut solver, &certifier, Drive::Travel, &[-0.3, 0.3], 0.0);
    println!("{found:?}");
    assert!(found.iter().all(|r| r.is_ok_and(|e| e < 1e-12)));
}

/// A pose with a small error has a certificate whose bound covers this error. A pose with a large error has none.
#[test]
fn a_wrong_pose_is_not_proved() {
    let case = Case::read("nominal");
    let certifier = Certifier::new(&case.mechanism, &case.design);
    let solver = case.solver();
    let point = |value| MotionPoint {
        drive: Drive::Travel,
        value,
        rack: 0.0,
    };
    let mut pose = None;
    let mut solver = solver;
    solver
        .for_each_pose(Drive::Travel, &order_to(0.05), 0.0, |_, _, found| {
            pose = found.ok().copied();
            ControlFlow::Continue(())
        })
        .unwrap();
    let mut pose = pose.unwrap();
    assert!(certifier.pose(&pose, &point(0.05)).is_ok());
    // A pose with an error of a micrometre is still near a solution, and the certificate bounds the distance to that
    // solution.
    pose.origin.z += 1e-6;
    let proof = certifier.pose(&pose, &point(0.05)).unwrap();
    assert!(proof.error >= 1e-6 && proof.error < 1e-4, "{proof:?}");
    // A pose with an error of a decimetre has no certificate.
    pose.origin.z += 0.1;
    assert!(certifier.pose(&pose, &point(0.05)).is_err());
}

/// Asserts that every station of a design has a certificate with an error up to the bound (in metres). A certificate from
/// interval arithmetic is valid whatever the solver did, so no second solver is necessary.
fn assert_proved(
    mechanism: &Mechanism,
    name: &str,
    design: &[Vector3<f64>],
    drive: Drive,
    values: &[f64],
    bound: f64,
) {
    let mut solver = Solver::new(mechanism, design).unwrap_or_else(|f| panic!("{name}: {f:?}"));
    let certifier = Certifier::new(mechanism, design);
    let proofs = certified(&mut solver, &certifier, drive, values, 0.0);
    for (value, proof) in values.iter().zip(proofs) {
        println!("{name} {drive:?} {value}: {proof:?}");
        let error = proof.unwrap_or_else(|f| panic!("{name} {value}: {f}"));
        assert!(error <= bound, "{name} {value}: {error:e}");
    }
}

/// Travels of the certified designs, in metres.
const TRAVELS: [f64; 3] = [-0.08, 0.05, 0.08];

/// Design of a case with some points elsewhere.
fn with(nominal: &Case, changes: &[(&str, Vector3<f64>)]) -> Vec<Vector3<f64>> {
    let mut design = nominal.design.clone();
    for (p, at) in changes {
        design[nominal.point(p).0] = *at;
    }
    design
}

/// The program certifies numbers that are hard to compute with: an angle near half a turn, large coordinates, and points that
/// are close together. The reference does not have these designs.
#[test]
fn extreme_numbers_are_proved() {
    let nominal = Case::read("nominal");
    let at = |p: &str| nominal.design[nominal.point(p).0];
    // At an arm angle within a nanoradian of half a turn, the tangent of the half angle is nearly infinite.
    let half_turn = std::f64::consts::PI - 1e-9;
    assert_proved(
        &nominal.mechanism,
        "half turn",
        &nominal.design,
        Drive::ArmAngle,
        &[-half_turn, half_turn],
        1e-13,
    );

    // Far from the origin, coordinates of 1e4 m have a rounding error of 1e4 m times the machine epsilon.
    let away = Vector3::new(1e4, -1e4, 1e4);
    let far: Vec<_> = nominal.design.iter().map(|p| *p + away).collect();
    assert_proved(
        &nominal.mechanism,
        "1e4 m away",
        &far,
        Drive::Travel,
        &TRAVELS,
        1e-10,
    );

    // Two strut points are only a micrometre apart. The given doubles define the strut's direction exactly.
    let close = at("p6") + (at("p4") - at("p6")) * (1e-6 / (at("p4") - at("p6")).norm());
    assert_proved(
        &nominal.mechanism,
        "strut points",
        &with(&nominal, &[("p7", close)]),
        Drive::Travel,
        &TRAVELS,
        1e-13,
    );
}

/// The program certifies degenerate designs that are not in the reference.
#[test]
fn degenerate_geometries_are_proved() {
    let nominal = Case::read("nominal");
    let at = |p: &str| nominal.design[nominal.point(p).0];
    // The ball joint is on the strut axis: p4, p6 and p7 are in line with it.
    let on_axis = |t: f64| at("p5") + (at("p4") - at("p5")) * t;
    let design = with(&nominal, &[("p6", on_axis(0.25)), ("p7", on_axis(0.5))]);
    assert_proved(
        &nominal.mechanism,
        "ball joint on the strut axis",
        &design,
        Drive::Travel,
        &TRAVELS,
        1e-13,
    );

    // All points of the knuckle are in one plane.
    let mut design = nominal.design.clone();
    for p in ["p5", "p6", "p7", "p8", "p10", "p11", "p4"] {
        design[nominal.point(p).0].y = 0.7;
    }
    assert_proved(
        &nominal.mechanism,
        "coplanar knuckle",
        &design,
        Drive::Travel,
        &[-0.03, 0.03],
        1e-13,
    );

    // The wheel centre is at the ball joint. In the next case the strut is horizontal, along x.
    assert_proved(
        &nominal.mechanism,
        "wheel centre on the ball joint",
        &with(&nominal, &[("p10", at("p5"))]),
        Drive::Travel,
        &TRAVELS,
        1e-13,
    );
    let design = with(
        &nominal,
        &[
            ("p4", at("p6") + Vector3::new(0.6, 0.0, 0.0)),
            ("p7", at("p6") + Vector3::new(0.1, 0.0, 0.0)),
        ],
    );
    assert_proved(
        &nominal.mechanism,
        "strut along x",
        &design,
        Drive::ArmAngle,
        &[-0.02, 0.02],
        1e-13,
    );
}
