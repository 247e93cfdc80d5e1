//! Tests of the search for all assemblies of a mechanism at one travel: it finds every assembly and no false one.

use crate::support::larger;
use crate::support::quadratics::Quadratics;
use crate::support::random::Random;
use crate::support::{Case, motion, order_to, vector};
use hardpoint::analyse::Assemblies;
use hardpoint::derive::MotionPoint;
use hardpoint::mechanism::Pose;
use hardpoint::model::{Drive, Mechanism, Suspension, Topology};
use hardpoint::number::{Matrix3, Vector3};
use hardpoint::solve::Solver;
use hardpoint::study::Study;
use std::ops::ControlFlow;
use std::path::Path;

/// At travels at which the reference has no assembly on any solution branch, the search finds none.
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

/// The search finds the reference states on both sides of the folds (ends of travel where two assemblies merge), within
/// rounding errors times the condition number. It leaves nothing undecided. The test uses every fourth state.
#[test]
fn every_state_of_the_reference_is_among_them() {
    let mut compared = 0;
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
            // A periodic function without double roots has an even number of roots.
            assert_eq!(all.found.len() % 2, 0);
            compared += 1;
        }
    }
    assert_eq!(compared, 19);
}

/// The pose that the solver reaches from the design position is one of the found assemblies.
#[test]
fn the_connected_pose_is_one_of_them() {
    let case = Case::read("nominal");
    let mut solver = case.solver();
    let mut pose = None;
    solver
        .for_each_pose(Drive::Travel, &order_to(0.08), 0.02, |_, _, found| {
            pose = found.ok().copied();
            ControlFlow::Continue(())
        })
        .unwrap();
    let all = solver.assemblies(0.08, 0.02).unwrap();
    let origin = pose.unwrap().origin;
    let connected = all
        .found
        .iter()
        .filter(|a| (a.pose.origin - origin).norm() < 1e-13 && a.branch == [Some(true), Some(true)])
        .count();
    assert_eq!(connected, 1);
    assert!(all.found.iter().all(|a| a.certificate.is_some()));
}

/// Returns the suspension of a topology's template.
fn template(topology: &str) -> Suspension {
    let topology = Topology::named(topology).unwrap();
    Study::from_text(topology.name, topology.template, Path::new("."))
        .unwrap_or_else(|e| panic!("{e:?}"))
        .into_wheel()
}

fn all(mechanism: &Mechanism, design: &[Vector3<f64>], travel: f64, rack: f64) -> Assemblies {
    let solver = Solver::new(mechanism, design).unwrap();
    solver.assemblies(travel, rack).unwrap()
}

/// Returns the distance between two poses, divided by the suspension size.
fn apart(a: &Pose<f64>, b: &Pose<f64>, size: f64) -> f64 {
    let columns = a.rotation.columns.iter().zip(b.rotation.columns);
    let turned = columns.map(|(p, q)| (*p - q).norm()).fold(0.0, larger);
    (a.origin - b.origin).norm() / size + turned
}

/// Random rotation with uniform distribution.
fn any_rotation(random: &mut Random) -> Matrix3<f64> {
    loop {
        let (v, w) = (random.vector(1.0), random.signed());
        let norm = v.norm_squared() + w * w;
        if norm <= 1.0 && norm > 1e-3 {
            return Matrix3::identity(0.0).turned(v * (1.0 / w));
        }
    }
}

/// Checks two things. Newton's method on other equations, started from thousands of random poses, finds no assembly that
/// the search has missed. Each found assembly has the lengths of the design and is certified.
fn compare_with_newton(mechanism: &Mechanism, design: &[Vector3<f64>], travel: f64, rack: f64) {
    let found = all(mechanism, design, travel, rack);
    let equations = Quadratics::new(mechanism, design);
    let solver = Solver::new(mechanism, design).unwrap();
    let size = solver.size();
    assert!(found.undecided.is_empty(), "{:?}", found.undecided);
    assert_eq!(
        found.found.len() % 2,
        0,
        "an odd number, but none is double"
    );
    for assembly in &found.found {
        let error = equations.length_error(&assembly.pose, rack);
        assert!(error < 1e-12, "{error:e}");
        let height = assembly.wheel_centre.z - design[mechanism.wheel_centre.0].z - travel;
        assert!(height.abs() < 1e-12 * size, "{height:e}");
        assert!(assembly.certificate.is_some());
    }
    if (travel, rack) == (0.0, 0.0) {
        let is_design = |a: &&_| apart(a, &solver.design_pose(), size) < 1e-12;
        assert_eq!(
            found
                .found
                .iter()
                .map(|a| &a.pose)
                .filter(is_design)
                .count(),
            1
        );
    }
    let mut random = Random(11);
    let mut reached = vec![0; found.found.len()];
    let mut settled = 0;
    for _ in 0..3000 {
        let start = Pose {
            origin: design[mechanism.origin.0] + random.vector(size),
            rotation: any_rotation(&mut random),
        };
        let Some(pose) = equations.solve_from(start, travel, rack) else {
            continue;
        };
        let [x, y, z] = pose.rotation.columns;
        if x.cross(y).dot(z) < 0.0 {
            continue;
        }
        settled += 1;
        let place = found
            .found
            .iter()
            .position(|a| apart(&a.pose, &pose, size) < 1e-6);
        let place = place.unwrap_or_else(|| panic!("an assembly is missing: {pose:?}"));
        reached[place] += 1;
    }
    println!(
        "{}: {} assemblies at travel {travel}, rack {rack}, reached {reached:?}",
        mechanism.topology.name,
        found.found.len()
    );
    assert!(settled > 100 || found.found.is_empty(), "{settled}");
}

#[test]
fn no_assembly_of_a_double_wishbone_is_missing() {
    let suspension = template("double_wishbone");
    let mechanism = &suspension.mechanism;
    compare_with_newton(mechanism, &suspension.design, 0.0, 0.0);
    let mut random = Random(3);
    for _ in 0..5 {
        let design = random.scattered(&suspension.design, 60.0);
        let (travel, rack) = (80.0 * random.signed(), 30.0 * random.signed());
        compare_with_newton(mechanism, &design, travel, rack);
    }
}

#[test]
fn no_assembly_of_a_five_link_is_missing() {
    let suspension = template("five_link");
    let mechanism = &suspension.mechanism;
    compare_with_newton(mechanism, &suspension.design, 0.0, 0.0);
    let mut random = Random(5);
    let design = random.scattered(&suspension.design, 60.0);
    compare_with_newton(mechanism, &design, 70.0, -20.0);
}

/// For double wishbones, two methods find the same assemblies: the closed form over one turn of the arm, and the search
/// over all rotations.
#[test]
fn two_methods_find_the_same_double_wishbones() {
    let suspension = template("double_wishbone");
    let mut rods = suspension.mechanism.clone();
    rods.closed_form = None;
    let design = Random(8).scattered(&suspension.design, 40.0);
    let size = Solver::new(&rods, &design).unwrap().size();
    let (by_arm, by_rods) = (
        all(&suspension.mechanism, &design, 35.0, 10.0),
        all(&rods, &design, 35.0, 10.0),
    );
    assert!(by_arm.undecided.is_empty() && by_rods.undecided.is_empty());
    assert_eq!(by_arm.found.len(), by_rods.found.len());
    assert!(!by_arm.found.is_empty());
    for (a, b) in by_arm.found.iter().zip(&by_rods.found) {
        assert!(apart(&a.pose, &b.pose, size) < 1e-12);
    }
}

/// If a mechanism is mirrored, turned about the vertical and moved, the number and the properties of its assemblies do
/// not change. This includes the wheel height and the size of the rotation.
#[test]
fn assemblies_do_not_depend_on_where_the_car_stands() {
    for name in ["macpherson", "double_wishbone", "five_link"] {
        let suspension = template(name);
        let mechanism = &suspension.mechanism;
        let by = Vector3::new(300.0, -200.0, 120.0);
        let rodrigues = Vector3::new(0.0, 0.0, 0.31);
        let rotation = Matrix3::identity(0.0).turned(rodrigues);
        let moved: Vec<_> = suspension
            .design
            .iter()
            .map(|p| {
                let mirrored = Vector3::new(p.x, -p.y, p.z);
                rotation.apply(mirrored) + by
            })
            .collect();
        let key = |all: Assemblies| {
            assert!(all.undecided.is_empty());
            let mut keys: Vec<_> = all
                .found
                .iter()
                .map(|a| (a.branch.clone(), a.turn()))
                .collect();
            keys.sort_by(|a, b| a.1.total_cmp(&b.1));
            keys
        };
        let here = key(all(mechanism, &suspension.design, 30.0, 0.0));
        let there = key(all(mechanism, &moved, 30.0, 0.0));
        assert_eq!(here.len(), there.len(), "{name}");
        assert!(!here.is_empty());
        for (a, b) in here.iter().zip(&there) {
            assert_eq!(a.0, b.0, "{name}");
            assert!((a.1 - b.1).abs() < 1e-9, "{name}: {} and {}", a.1, b.1);
        }
    }
}

/// A hinged arm has two assemblies at a height below the top of its circle, one at the top, and none above it.
#[test]
fn a_hinged_arm_has_two_assemblies_or_none() {
    let suspension = template("semi_trailing_arm");
    let (mechanism, design) = (&suspension.mechanism, &suspension.design);
    let point = |name: &str| design[mechanism.point(name).unwrap().0];
    let (inner, outer) = (point("arm_pivot_inner"), point("arm_pivot_outer"));
    let axis = (outer - inner).normalised();
    let centre = design[mechanism.wheel_centre.0];
    let foot = inner + axis * axis.dot(centre - inner);
    let radius = (centre - foot).norm();
    // Height of the top of the circle above the centre of the circle.
    let rise = radius * (1.0 - axis.z * axis.z).sqrt();
    let top = foot.z + rise - centre.z;
    for (travel, count) in [
        (0.0, 2),
        (70.0, 2),
        (top - 1e-6, 2),
        (top + 1e-6, 0),
        (top - 2.0 * rise + 1.0, 2),
    ] {
        let found = all(mechanism, design, travel, 0.0);
        assert!(found.undecided.is_empty());
        assert_eq!(found.found.len(), count, "at {travel}");
        for assembly in &found.found {
            assert!((assembly.wheel_centre - foot).dot(axis).abs() < 1e-12 * radius);
            assert!(((assembly.wheel_centre - foot).norm() / radius - 1.0).abs() < 1e-13);
            assert!((assembly.wheel_centre.z - centre.z - travel).abs() < 1e-12 * radius);
        }
        let as_designed = found.found.iter().filter(|a| a.branch == [Some(true)]);
        assert_eq!(as_designed.count(), count / 2);
    }
}

/// At a fold two assemblies merge and vanish. Beyond the fold the search finds two assemblies fewer. It returns no
/// assembly in which the links fit only approximately.
#[test]
fn two_assemblies_end_at_a_fold() {
    for name in ["macpherson", "double_wishbone", "five_link"] {
        let suspension = template(name);
        let mechanism = &suspension.mechanism;
        let mut solver = Solver::new(mechanism, &suspension.design).unwrap();
        let fold = solver
            .drive_range(Drive::Travel, 0.0)
            .unwrap()
            .upper
            .value();
        let size = solver.size();
        let found = |by: f64| {
            let found = solver.assemblies(fold + by * size, 0.0).unwrap();
            assert!(found.undecided.is_empty(), "{name}");
            assert!(
                found.found.iter().all(|a| a.certificate.is_some()),
                "{name}"
            );
            found.found.len()
        };
        assert_eq!(found(-1e-9), found(1e-9) + 2, "{name} at {fold}");
    }
}

/// Returns a template with these points moved.
fn with_points(topology: &str, points: &[(&str, [f64; 3])]) -> Suspension {
    let mut suspension = template(topology);
    for (name, [x, y, z]) in points {
        let id = suspension.mechanism.point(name).unwrap().0;
        suspension.design[id] = Vector3::new(*x, *y, *z);
    }
    suspension
}

/// If the tie rod is 1.7 mm from the steering axis, its length fits only within a tiny interval of the arm angle. The
/// search finds both assemblies in this interval and leaves no interval undecided.
#[test]
fn a_tie_rod_next_to_the_steering_axis_leaves_nothing_undecided() {
    let suspension = with_points(
        "double_wishbone",
        &[
            ("upper_arm_front", [135.0, 265.0, 330.0]),
            ("upper_arm_rear", [-165.0, 270.0, 318.0]),
            ("upper_ball_joint", [-8.0, 545.0, 365.0]),
            ("lower_arm_front", [150.0, 215.0, 142.0]),
            ("lower_arm_rear", [-180.0, 220.0, 138.0]),
            ("lower_ball_joint", [6.0, 575.0, 130.0]),
            ("tie_rod_inner", [68.0, 230.0, 170.0]),
            ("tie_rod_outer", [1e-12, 560.0, 255.0]),
            ("wheel_centre", [0.0, 620.0, 255.0]),
        ],
    );
    let found = all(&suspension.mechanism, &suspension.design, 0.0, 0.0);
    assert!(found.undecided.is_empty(), "{:?}", found.undecided);
    assert_eq!(found.found.len(), 2);
    assert!(found.looked_at < 10_000, "{}", found.looked_at);
}

/// In an exact parallelogram, four solution branches meet in the position where arms and tie rod are in line with the
/// steering axis. Away from this position the search finds and certifies every assembly.
#[test]
fn parallel_arms_leave_nothing_undecided() {
    let suspension = with_points(
        "double_wishbone",
        &[
            ("upper_arm_front", [150.0, 215.0, 340.0]),
            ("upper_arm_rear", [-180.0, 215.0, 340.0]),
            ("upper_ball_joint", [0.0, 575.0, 330.0]),
            ("lower_arm_front", [150.0, 215.0, 140.0]),
            ("lower_arm_rear", [-180.0, 215.0, 140.0]),
            ("lower_ball_joint", [0.0, 575.0, 130.0]),
            ("tie_rod_inner", [100.0, 215.0, 240.0]),
            ("tie_rod_outer", [100.0, 575.0, 230.0]),
        ],
    );
    let mechanism = &suspension.mechanism;
    for travel in [0.0, 10.0, -60.0] {
        let found = all(mechanism, &suspension.design, travel, 0.0);
        assert!(found.looked_at < 12_000, "{}", found.looked_at);
    }
    compare_with_newton(mechanism, &suspension.design, 0.0, 0.0);
}
