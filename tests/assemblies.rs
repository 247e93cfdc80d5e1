//! All assemblies at one travel: none is missing, none is wrong.

mod support;

use hardpoint::kinematics::MotionPoint;
use hardpoint::model::Drive;
use std::ops::ControlFlow;
use support::{Case, march_to, motion, vector};

/// Travels at which the reference knows that no assembly exists on any branch.
#[test]
fn where_there_is_none_none_is_found() {
    let case = Case::read("no-assembly");
    for state in case.states() {
        let why = state["why"].as_str().unwrap();
        assert!(why.ends_with("(degree-10 trigonometric polynomial): 0"));
        let (_, travel, rack, _) = motion(state);
        let found = case.solver().assemblies(travel, rack).unwrap();
        assert!(
            found.found.is_empty() && found.undecided.is_empty(),
            "{found:?}"
        );
    }
}

/// The reference's states on both sides of the folds are all among the assemblies, each is proved, and
/// no two are the same.
#[test]
fn every_state_of_the_reference_is_among_them() {
    for name in [
        "nominal",
        "travel-limit",
        "tie-rod-toggle",
        "vertical-strut",
    ] {
        let case = Case::read(name);
        let solver = case.solver();
        let size = solver.size();
        for state in case.states().iter().step_by(4) {
            let (drive, travel, rack, _) = motion(state);
            if drive != Drive::Travel || state["exists"] != true {
                continue;
            }
            let start = std::time::Instant::now();
            let all = solver.assemblies(travel, rack).unwrap();
            let took = start.elapsed();
            let wanted = ["p5", "p10"].map(|p| case.frame.vector(vector(&state["positions"][p])));
            let point = MotionPoint {
                drive,
                value: travel,
                rack,
            };
            let nearest = all
                .found
                .iter()
                .map(|a| {
                    let k = solver.conditioning(&a.pose, &point).number;
                    let error = (a.pose.origin - wanted[0])
                        .norm()
                        .max((a.wheel_centre - wanted[1]).norm());
                    error / (8.0 * f64::EPSILON * k * size)
                })
                .fold(f64::INFINITY, f64::min);
            println!(
                "{name} {travel} {} assemblies, nearest {nearest:.1e} of its bound, {} undecided, {took:?}",
                all.found.len(),
                all.undecided.len()
            );
            assert!(nearest <= 1.0, "{name} {travel} {nearest:e}");
            assert!(all.undecided.is_empty());
            // Roots of a periodic function, none of them double.
            assert_eq!(all.found.len() % 2, 0);
        }
    }
}

/// The pose that a march finds is one of them.
#[test]
fn the_connected_pose_is_one_of_them() {
    let case = Case::read("nominal");
    let mut solver = case.solver();
    let mut pose = None;
    solver
        .march(Drive::Travel, &march_to(0.08), 0.02, |_, _, found| {
            pose = found.ok().copied();
            ControlFlow::Continue(())
        })
        .unwrap();
    let all = solver.assemblies(0.08, 0.02).unwrap();
    let origin = pose.unwrap().origin;
    let connected = all
        .found
        .iter()
        .filter(|a| {
            (a.pose.origin - origin).norm() < 1e-13 && !a.strut_inverted && !a.tie_rod_across
        })
        .count();
    assert_eq!(connected, 1);
    assert!(all.found.iter().all(|a| a.certificate.is_some()));
}
