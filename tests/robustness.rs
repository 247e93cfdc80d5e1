//! Any finite hardpoints: solved, or refused with a reason.
//!
//! Designs are drawn from a number: a road car's strut with its points scattered, and in every other one
//! something degenerate (points that coincide, line up or lie in a plane, axes along the coordinate
//! axes, a tie rod at toggle, other scales, far from the origin).

use hardpoint::kinematics::{
    Certifier, DesignFault, Failure, LimitCause, March, MotionPoint, Pose, Solver,
};
use hardpoint::model::{Constraint, Drive, Mechanism, Topology};
use hardpoint::number::Vector3;
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};
use std::ops::ControlFlow;

/// A small generator (S. Vigna, splitmix64), so that a design is known by its number alone.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// In [-1, 1).
    fn symmetric(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
    fn chance(&mut self, one_in: usize) -> bool {
        self.below(one_in) == 0
    }
}

const POINTS: [(&str, [f64; 3]); 10] = [
    ("lower_arm_front", [0.12, 0.36, 0.195]),
    ("lower_arm_rear", [-0.26, 0.35, 0.205]),
    ("lower_ball_joint", [0.005, 0.705, 0.19]),
    ("strut_top", [-0.035, 0.575, 0.85]),
    ("strut_lower", [-0.011, 0.623, 0.37]),
    ("strut_upper", [-0.017, 0.611, 0.49]),
    ("tie_rod_inner", [-0.11, 0.33, 0.243]),
    ("tie_rod_outer", [-0.13, 0.69, 0.24]),
    ("wheel_centre", [0.0, 0.76, 0.3]),
    ("spindle_inner", [-0.0002, 0.66, 0.2991]),
];

struct Trial {
    mechanism: Mechanism,
    design: Vec<Vector3<f64>>,
    drive: Drive,
    values: Vec<f64>,
    rack: f64,
    /// Whether nothing degenerate was done to it.
    ordinary: bool,
}

fn trial(number: u64) -> Trial {
    let random = &mut Random(number);
    let scatter = [0.02, 0.08, 0.2, 0.6][random.below(4)];
    let mut points = POINTS.map(|(_, p)| p.map(|c| c + scatter * random.symmetric()));
    let ordinary = random.chance(2);
    if !ordinary {
        for _ in 0..=random.below(3) {
            degrade(&mut points, random);
        }
    }
    let mut scale = 1.0;
    if !ordinary && random.chance(3) {
        scale = 10f64.powi(random.below(13) as i32 - 6);
        points = points.map(|p| p.map(|c| c * scale));
    }
    if !ordinary && random.chance(6) {
        let away = [0, 1, 2].map(|_| 1e4 * scale * random.symmetric());
        for p in &mut points {
            for (c, a) in p.iter_mut().zip(away) {
                *c += a;
            }
        }
    }
    let topology = Topology::named("macpherson").unwrap();
    let with_upper = !random.chance(4);
    let given: Vec<&str> = topology
        .hardpoints
        .iter()
        .map(|h| h.name)
        .filter(|n| with_upper || *n != "strut_upper")
        .collect();
    let mechanism = (topology.build)(topology, &given);
    let design = mechanism
        .points
        .iter()
        .map(|p| POINTS.iter().position(|(n, _)| *n == p.name).unwrap())
        .map(|k| Vector3::from(points[k]))
        .collect();
    let drive = match random.chance(4) {
        true => Drive::ArmAngle,
        false => Drive::Travel,
    };
    let reach = match drive {
        Drive::Travel => [0.05, 0.1, 0.3][random.below(3)] * scale,
        Drive::ArmAngle => [0.2, 0.5, 3.1][random.below(3)],
    };
    let values = (0..2 + random.below(5))
        .map(|_| reach * random.symmetric())
        .collect();
    let rack = match random.chance(4) {
        true => 0.1 * scale * random.symmetric(),
        false => 0.0,
    };
    Trial {
        mechanism,
        design,
        drive,
        values,
        rack,
        ordinary,
    }
}

#[allow(
    clippy::needless_range_loop,
    reason = "several points are read and one is written, coordinate by coordinate"
)]
fn degrade(points: &mut [[f64; 3]; 10], random: &mut Random) {
    let (a, b, c) = (random.below(10), random.below(10), random.below(10));
    let tiny = [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3][random.below(6)];
    let t = 2.0 * random.symmetric();
    match random.below(8) {
        // Coincident, or nearly.
        0 => points[a] = points[b].map(|v| v + tiny * random.symmetric()),
        // On a line with two others.
        1 => {
            for k in 0..3 {
                points[a][k] =
                    points[b][k] + t * (points[c][k] - points[b][k]) + tiny * random.symmetric();
            }
        }
        // In a coordinate plane with another.
        2 => points[a][b % 3] = points[c][b % 3] + tiny * random.symmetric(),
        // All in one plane.
        3 => points
            .iter_mut()
            .for_each(|p| p[a % 3] = 0.3 + tiny * random.symmetric()),
        // Strut along a coordinate axis.
        4 => {
            for k in (0..3).filter(|k| k != &(a % 3)) {
                points[4][k] = points[3][k] + tiny * random.symmetric();
                points[5][k] = points[3][k] + tiny * random.symmetric();
            }
        }
        // Tie rod's outer end into the plane of steering axis and inner end.
        5 => {
            for k in 0..3 {
                points[7][k] = points[2][k]
                    + t * (points[3][k] - points[2][k])
                    + 0.3 * (points[6][k] - points[2][k])
                    + tiny * random.symmetric();
            }
        }
        // Strut points close together.
        6 => {
            for k in 0..3 {
                points[5][k] = points[4][k] + tiny * (points[3][k] - points[4][k]);
            }
        }
        // Whole coordinates.
        _ => points.iter_mut().for_each(|p| *p = p.map(f64::round)),
    }
}

#[derive(Default, Debug)]
struct Tally {
    designs: usize,
    refused: usize,
    solved: usize,
    unreachable: usize,
    unresolved: usize,
    ordinary_unresolved: usize,
    proved: usize,
    unproved: usize,
    parted: usize,
    ordinary_unproved: usize,
}

/// How badly a pose violates the closure, in sizes: lengths of links, strut mount off its line, the
/// rotation's shape.
fn violation(trial: &Trial, pose: &Pose<f64>, rack: f64) -> f64 {
    let m = &trial.mechanism;
    let d = &trial.design;
    let origin = d[m.origin.0];
    let at = |p: usize| pose.origin + pose.rotation.apply(d[p] - origin);
    let inner_at = |p: usize| match m.points[p].body {
        hardpoint::model::Body::Rack => d[p] + Vector3::new(0.0, rack, 0.0),
        _ => d[p],
    };
    let mut worst = 0.0_f64;
    for constraint in &m.constraints {
        if let Constraint::Link { inner, outer } = constraint {
            let now = (at(outer.0) - inner_at(inner.0)).norm();
            let was = (d[outer.0] - d[inner.0]).norm();
            worst = worst.max((now - was).abs());
        }
        if let Constraint::StrutLine { top, lower, upper } = constraint {
            let base = d[upper.unwrap_or(*top).0] - d[lower.0];
            let along = base * (1.0 / base.norm());
            let image = pose.rotation.apply(along);
            worst = worst.max(image.cross(d[top.0] - at(top.0)).norm());
        }
    }
    worst
}

/// Everything that must hold for one design.
fn examine(number: u64, tally: &mut Tally) {
    let trial = trial(number);
    tally.designs += 1;
    let mut solver = match Solver::new(&trial.mechanism, &trial.design) {
        Ok(solver) => solver,
        Err(fault) => {
            assert!(!fault.describe(&trial.mechanism).is_empty());
            tally.refused += 1;
            return;
        }
    };
    let size = solver.size();
    let reach = trial.design.iter().map(|p| p.norm()).fold(size, f64::max);
    let march = March::through(&trial.values);
    let mut found: Vec<Option<Result<Pose<f64>, Failure>>> = vec![None; trial.values.len()];
    let marched = solver.march(trial.drive, &march, trial.rack, |_, station, pose| {
        found[station] = Some(pose.copied());
        ControlFlow::Continue(())
    });
    if let Err(fault) = marched {
        assert!(matches!(fault, DesignFault::Singular), "{number} {fault:?}");
        tally.refused += 1;
        return;
    }
    let certifier = Certifier::new(&trial.mechanism, &trial.design);
    for (value, found) in trial.values.iter().zip(&found) {
        let point = MotionPoint {
            drive: trial.drive,
            value: *value,
            rack: trial.rack,
        };
        match found.as_ref().expect("every station is visited") {
            Ok(pose) => {
                tally.solved += 1;
                let off = violation(&trial, pose, trial.rack);
                // The residuals are sums of products of coordinates, a few dozen roundings; NaN fails.
                assert!(
                    off <= 64.0 * f64::EPSILON * reach + 1e-9 * size,
                    "{number} {off:e}"
                );
                let k = solver.conditioning(pose, &point);
                assert!(k.number >= 1.0, "{number} {k:?}");
                match certifier.pose(pose, &point) {
                    Ok(certificate) => {
                        tally.proved += 1;
                        assert!(certificate.error <= certificate.uniqueness);
                        if let Err(apart) =
                            follow_slowly(&trial, pose, &point, certificate.uniqueness)
                        {
                            // Degenerate designs may have another assembly within a millionth of the
                            // size; then the proof of the path, where asked for, must say so.
                            assert!(!trial.ordinary, "{number}: {apart}");
                            tally.parted += 1;
                            path_is_refused(number, &trial, &certifier, &point);
                        }
                    }
                    Err(_) => {
                        tally.unproved += 1;
                        tally.ordinary_unproved += trial.ordinary as usize;
                    }
                }
            }
            Err(failure) => {
                assert!(!failure.to_string().is_empty());
                match failure {
                    Failure::Unreachable { limit, cause, .. } => {
                        assert!(
                            limit.is_finite() && limit.abs() <= value.abs(),
                            "{number} {failure:?} {value}"
                        );
                        tally.unreachable += 1;
                        let unresolved = *cause == LimitCause::Unresolved;
                        tally.unresolved += unresolved as usize;
                        tally.ordinary_unresolved += (unresolved && trial.ordinary) as usize;
                    }
                    Failure::RackUnreachable { limit, cause } => {
                        assert!(limit.is_finite() && limit.abs() <= trial.rack.abs());
                        tally.unreachable += 1;
                        let unresolved = *cause == LimitCause::Unresolved;
                        tally.unresolved += unresolved as usize;
                        tally.ordinary_unresolved += (unresolved && trial.ordinary) as usize;
                    }
                    other => panic!("{number} {other}"),
                }
            }
        }
    }
}

/// The same pose reached in many small steps lies within the uniqueness radius of the one found in few,
/// or by how much it does not.
fn follow_slowly(
    trial: &Trial,
    pose: &Pose<f64>,
    point: &MotionPoint<f64>,
    uniqueness: f64,
) -> Result<(), String> {
    let mut solver = Solver::new(&trial.mechanism, &trial.design).unwrap();
    let values: Vec<f64> = (1..=64).map(|k| point.value * k as f64 / 64.0).collect();
    let march = March::through(&values);
    let mut last = None;
    solver
        .march(trial.drive, &march, trial.rack, |_, station, pose| {
            if station == 63 {
                last = Some(pose.copied());
            }
            ControlFlow::Continue(())
        })
        .unwrap();
    let slow = last.expect("visited").map_err(|f| f.to_string())?;
    let apart = (slow.origin - pose.origin).norm();
    let turned = pose
        .rotation
        .columns
        .iter()
        .zip(slow.rotation.columns)
        .map(|(a, b)| (*a - b).norm())
        .fold(0.0, f64::max);
    if apart.max(turned * solver.size()) <= 2.0 * uniqueness {
        Ok(())
    } else {
        Err(format!("{apart:e} {turned:e} {uniqueness:e}"))
    }
}

/// What is reached differently in long and in short steps is not proved to be connected with the design.
fn path_is_refused(number: u64, trial: &Trial, certifier: &Certifier, point: &MotionPoint<f64>) {
    let mut solver = Solver::new(&trial.mechanism, &trial.design).unwrap();
    let march = March::through(&[point.value]);
    solver
        .march_certified(certifier, trial.drive, &march, trial.rack, |_, _, found| {
            assert!(found.is_err(), "{number}");
            ControlFlow::Continue(())
        })
        .unwrap();
}

#[test]
fn any_design_is_solved_or_refused_with_a_reason() {
    let config = ProptestConfig {
        cases: 1000,
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    // The same designs every time.
    let random = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    TestRunner::new_with_rng(config, random)
        .run(&any::<u64>(), |number| {
            examine(number, &mut Tally::default());
            Ok(())
        })
        .unwrap();
}

/// Designs that failed once.
#[test]
fn designs_that_failed_once() {
    for number in [
        640, 1037, 3017, 3198, 10011, 12860, 17965, 19111, 24636, 30343, 82214, 84055, 104498,
    ] {
        examine(number, &mut Tally::default());
    }
}

/// One million designs; run with `cargo test --release --test robustness -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes"]
fn a_million_designs() {
    let count = std::env::var("DESIGNS").map_or(1_000_000, |n| n.parse().unwrap());
    let mut tally = Tally::default();
    let mut slowest = (0.0, 0);
    let mut failed = Vec::new();
    for number in 0..count {
        let start = std::time::Instant::now();
        if std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| examine(number, &mut tally)))
            .is_err()
        {
            failed.push(number);
        }
        let seconds = start.elapsed().as_secs_f64();
        if (number + 1) % 50_000 == 0 {
            println!("{tally:?}, slowest {slowest:?}");
        }
        if seconds > slowest.0 {
            slowest = (seconds, number);
        }
    }
    println!("{tally:?}, slowest {slowest:?}");
    assert!(failed.is_empty(), "{failed:?}");
    assert!(slowest.0 < 10.0);
}
