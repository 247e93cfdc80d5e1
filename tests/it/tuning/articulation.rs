//! Tests of joint angles against studs that rotate with three points of the carrier. Tests of the price of a joint
//! angle limit (change of the misfit per degree).

use super::edited;
use crate::support::larger;
use hardpoint::mechanism::Configuration;
use hardpoint::model::{Drive, PointId, Suspension};
use hardpoint::number::{Vector3, Width};
use hardpoint::optimise::{Assessment, Constrained, Control, Objective, Price, TargetLayout};
use hardpoint::solve::{Solver, StationOrder};
use hardpoint::study::Study;
use nalgebra::DVector;
use std::ops::ControlFlow;

type Triad = [Vector3<f64>; 3];

/// Orthonormal axes from three points.
fn triad([a, b, c]: [Vector3<f64>; 3]) -> Triad {
    let x = (b - a).normalised();
    let z = x.cross(c - a).normalised();
    [x, z.cross(x), z]
}

fn turned(from: &Triad, to: &Triad, v: Vector3<f64>) -> Vector3<f64> {
    let [x, y, z] = from.map(|axis| axis.dot(v));
    to[0] * x + to[1] * y + to[2] * z
}

fn angle(a: Vector3<f64>, b: Vector3<f64>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b)).to_degrees()
}

/// `v` rotated about an axis by the angle from `from` to `to`, as seen along the axis.
fn about(axis: Vector3<f64>, [from, to]: [Vector3<f64>; 2], v: Vector3<f64>) -> Vector3<f64> {
    let across = |p: Vector3<f64>| p - axis * axis.dot(p);
    let (from, to) = (across(from), across(to));
    let turn = axis.dot(from.cross(to)).atan2(from.dot(to));
    v * turn.cos() + axis.cross(v) * turn.sin() + axis * (axis.dot(v) * (1.0 - turn.cos()))
}

/// Joint of the carrier with the arm or rod on the other side of the joint.
enum Joint {
    /// Arm, by the points of its axis.
    Arm(&'static str, [&'static str; 2]),
    /// Rod, by its other end.
    Rod(&'static str, &'static str),
}

/// Angles of a joint in every pose, for some travels at one rack displacement. The stud is fixed in the carrier and
/// rotates with three points of the carrier.
fn angles(
    suspension: &Suspension,
    joint: &Joint,
    stud: Vector3<f64>,
    travels: &[f64],
    rack: f64,
) -> Vec<f64> {
    let (mechanism, design) = (&suspension.mechanism, &suspension.design);
    let id = |name: &str| mechanism.point(name).unwrap();
    let corners: [PointId; 3] = ["lower_ball_joint", "tie_rod_outer", "wheel_centre"].map(id);
    let designed = triad(corners.map(|id| design[id.0]));
    let mut solver = Solver::new(mechanism, design).unwrap();
    let order = StationOrder::through(travels);
    let mut found = vec![f64::NAN; travels.len()];
    solver
        .for_each_pose(Drive::Travel, &order, rack, |_, station, pose| {
            let at = Configuration::new(mechanism, design, *pose.unwrap(), rack);
            let now = triad(corners.map(|id| at.point(id)));
            let carried = turned(&designed, &now, stud);
            let ends = |name: &str| [design[id(name).0], at.point(id(name))];
            found[station] = match joint {
                Joint::Arm(outer, axis) => {
                    let [front, rear] = axis.map(|name| design[id(name).0]);
                    let levers = ends(outer).map(|p| p - front);
                    let housing = about((rear - front).normalised(), levers, stud);
                    angle(carried, housing)
                }
                Joint::Rod(outer, inner) => {
                    let [[outer, outer_now], [inner, inner_now]] = [ends(outer), ends(inner)];
                    (angle(carried, inner_now - outer_now) - angle(stud, inner - outer)).abs()
                }
            };
            ControlFlow::Continue(())
        })
        .unwrap();
    found
}

const STRUT_ARM: Joint = Joint::Arm("lower_ball_joint", ["lower_arm_front", "lower_arm_rear"]);
const UPPER_ARM: Joint = Joint::Arm("upper_ball_joint", ["upper_arm_front", "upper_arm_rear"]);
const ROD: Joint = Joint::Rod("tie_rod_outer", "tie_rod_inner");

/// The margins in degrees equal those of studs that are fixed in the carrier. This holds in SIMD lanes and station by
/// station. The test covers struts and wishbones. The stud is along the steering axis or given by the study. The test
/// uses a moved design, both ends of the travel and two rack displacements.
#[test]
fn margins_are_those_of_studs_fixed_in_the_carrier() {
    let travels = [-60.0, 65.0];
    let motion = "motion.travel=[-60.0, 65.0]";
    let studs =
        "suspension.studs={ lower_ball_joint = [0.1, -0.3, 1.0], tie_rod_outer = [0.2, 0.1, 0.9] }";
    let own = [Vector3::new(0.1, -0.3, 1.0), Vector3::new(0.2, 0.1, 0.9)];
    for (file, upper, joints) in [
        ("macpherson_front.toml", "strut_top", vec![STRUT_ARM, ROD]),
        (
            "double_wishbone_front.toml",
            "upper_ball_joint",
            vec![STRUT_ARM, ROD, UPPER_ARM],
        ),
    ] {
        for studs in [None, Some(studs)] {
            let constraint = |joint: &Joint| {
                let (Joint::Arm(name, _) | Joint::Rod(name, _)) = joint;
                format!("{{ articulation = \"{name}\", at_most = 33.0, rack = [0.0, 14.0] }}")
            };
            let constraints: Vec<String> = joints.iter().map(constraint).collect();
            let constraints = format!("optimise.constraints=[{}]", constraints.join(", "));
            let overrides = [Some(motion), Some(constraints.as_str()), studs];
            let overrides: Vec<&str> = overrides.into_iter().flatten().collect();
            let study = edited(file, &overrides);
            let (suspension, optimise) = (study.wheel(), study.optimise.as_ref().unwrap());
            let layout = TargetLayout::of(optimise, &study.vehicle);
            let count = optimise.variables.len();
            let x = DVector::from_fn(count, |j, _| 4.0 * ((j * 7 + 3) as f64).sin());
            let moved = study.moved(x.as_slice()).into_wheel();
            for width in [None, Width::widest()] {
                let problem = Objective::new(suspension, &optimise.variables, &layout).unwrap();
                let mut problem = problem.with_width(suspension, width);
                assert_eq!(problem.is_in_lanes(&x), width.is_some(), "{file}");
                let mut at = Assessment::new(&problem.shape());
                problem.assess(&x, &mut at).unwrap();
                for (number, joint) in joints.iter().enumerate() {
                    let design = |name| moved.design[moved.mechanism.point(name).unwrap().0];
                    let stud = match (studs, joint) {
                        (Some(_), Joint::Arm("lower_ball_joint", _)) => own[0],
                        (Some(_), Joint::Rod(..)) => own[1],
                        _ => design(upper) - design("lower_ball_joint"),
                    };
                    let all = [0.0, 14.0].map(|rack| angles(&moved, joint, stud, &travels, rack));
                    let largest = all.iter().flatten().copied().fold(0.0, larger);
                    let labels = layout.labels().iter().enumerate();
                    let own = labels.filter(|(_, label)| label.constraint == number);
                    let margins = own.map(|(row, _)| layout.margin(row, at.rows.residuals[row]));
                    let margin = margins.fold(f64::INFINITY, f64::min);
                    assert!(largest > 2.0, "{file} {number}: {largest}");
                    assert!(
                        (33.0 - largest - margin).abs() < 1e-9,
                        "{file} {number} {width:?}: {margin}, truly {}",
                        33.0 - largest
                    );
                }
            }
        }
    }
}

/// Margins of a drive shaft's joints are in degrees. The test computes them from the coordinates of the shaft's ends
/// and from the spin axis.
#[test]
fn margins_of_a_drive_shaft_are_degrees() {
    let [inner, outer] = super::DRIVE_SHAFT;
    let constraints = "optimise.constraints=[\
        { articulation = \"drive_shaft_outer\", at_most = 31.0 }, \
        { articulation = \"drive_shaft_inner\", at_most = 27.0 }]";
    let motion = "motion.travel=[-60.0, 65.0]";
    let study = edited(
        "double_wishbone_front.toml",
        &[inner, outer, motion, constraints],
    );
    let (suspension, optimise) = (study.wheel(), study.optimise.as_ref().unwrap());
    let layout = TargetLayout::of(optimise, &study.vehicle);
    let mut problem = Objective::new(suspension, &optimise.variables, &layout).unwrap();
    let mut at = Assessment::new(&problem.shape());
    let x = DVector::zeros(optimise.variables.len());
    problem.assess(&x, &mut at).unwrap();
    let (mechanism, design) = (&suspension.mechanism, &suspension.design);
    let mut solver = Solver::new(mechanism, design).unwrap();
    let order = StationOrder::through(&[-60.0, 65.0]);
    let mut largest = [0.0_f64; 2];
    solver
        .for_each_pose(Drive::Travel, &order, 0.0, |_, _, pose| {
            let at = Configuration::new(mechanism, design, *pose.unwrap(), 0.0);
            let end = |name: &str| at.point(mechanism.point(name).unwrap());
            let shaft = end("drive_shaft_outer") - end("drive_shaft_inner");
            let across = Vector3::new(0.0, 1.0, 0.0);
            let found = [angle(shaft, at.spin_axis()), angle(shaft, across)];
            largest = std::array::from_fn(|k| larger(largest[k], found[k]));
            ControlFlow::Continue(())
        })
        .unwrap();
    for (number, limit) in [31.0, 27.0].into_iter().enumerate() {
        let labels = layout.labels().iter().enumerate();
        let own = labels.filter(|(_, label)| label.constraint == number);
        let margins = own.map(|(row, _)| layout.margin(row, at.rows.residuals[row]));
        let margin = margins.fold(f64::INFINITY, f64::min);
        let wanted = limit - largest[number];
        assert!(
            largest[number] > 2.0 && (margin - wanted).abs() < 1e-9,
            "{margin} {wanted}"
        );
    }
}

/// The joint angle has a kink at 0. There, the margin equals the limit, and the program gives zero as the derivative of
/// the constraint.
#[test]
fn a_joint_that_does_not_turn_has_its_whole_limit() {
    let constraint = "optimise.constraints=[{ articulation = \"lower_ball_joint\", at_most = 18.5, at = \"design\" }]";
    let study = edited("macpherson_front.toml", &[constraint]);
    let (suspension, optimise) = (study.wheel(), study.optimise.as_ref().unwrap());
    let layout = TargetLayout::of(optimise, &study.vehicle);
    let mut problem = Objective::new(suspension, &optimise.variables, &layout).unwrap();
    let mut at = Assessment::new(&problem.shape());
    let x = DVector::zeros(optimise.variables.len());
    problem.assess(&x, &mut at).unwrap();
    assert_eq!(at.rows.residuals.len(), 1);
    let margin = layout.margin(0, at.rows.residuals[0]);
    assert!((margin - 18.5).abs() < 1e-6, "{margin}");
    assert!(at.rows.jacobian.iter().all(|slope| slope.abs() < 1e-7));
}

/// Strut whose ball joint turns too far, with a limit on this joint angle.
fn limited(limit: f64) -> Study {
    edited(
        "macpherson_front.toml",
        &[
            "motion.travel={ from = -60.0, to = 60.0, steps = 13 }",
            "optimise.starts=1",
            "optimise.good_enough=0.0",
            &format!(
                "optimise.constraints=[{{ articulation = \"lower_ball_joint\", at_most = {limit:?} }}]"
            ),
        ],
    )
}

/// The tuned design satisfies the limit everywhere, and the limit is active. The price of the limit is the slope of the
/// misfit with respect to the limit in degrees.
#[test]
fn the_price_of_a_joint_is_per_degree() {
    let tuned = |limit: f64| {
        let study = limited(limit);
        let tuning = study.tune(Control::default()).unwrap();
        (study, tuning.best.unwrap())
    };
    let free = {
        let (study, best) = tuned(60.0);
        let margin = best.constraints[0].margin;
        assert_eq!(best.constraints[0].price, Price::Nothing);
        let moved = study.moved(&best.offsets).into_wheel();
        let largest = largest_angle(&moved);
        assert!((60.0 - largest - margin).abs() < 1e-4, "{margin} {largest}");
        largest
    };
    let limit = free - 0.8;
    let (study, best) = tuned(limit);
    let outcome = best.constraints[0];
    assert!(outcome.margin.abs() < 1e-5, "{outcome:?}");
    let largest = largest_angle(&study.moved(&best.offsets).into_wheel());
    assert!((largest - limit).abs() < 1e-4, "{largest} {limit}");
    let step = 0.02;
    let [low, high] = [-step, step].map(|by| tuned(limit + by).1.after.misfit);
    let slope = (low - high) / (2.0 * step);
    let price = outcome.price.per_unit().unwrap();
    assert!((price - slope).abs() < 2e-3 * slope, "{price} {slope}");
}

/// Largest angle of the ball joint in the range of the motion.
fn largest_angle(moved: &Suspension) -> f64 {
    let design = |name| moved.design[moved.mechanism.point(name).unwrap().0];
    let stud = design("strut_top") - design("lower_ball_joint");
    let travels: Vec<f64> = (0..=240).map(|k| -60.0 + 0.5 * f64::from(k)).collect();
    let all = angles(moved, &STRUT_ARM, stud, &travels, 0.0);
    all.into_iter().fold(0.0, larger)
}
