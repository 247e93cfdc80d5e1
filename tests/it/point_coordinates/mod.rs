//! Tests of the paper's formulation against the paper's table, against reference values of 110 digits, and at limits.

mod agreement;
mod extra_points;
mod limits;
mod reference;
mod scatter;
mod study;
mod table;

use crate::support::larger;
use hardpoint::attia::Moving;
use hardpoint::attia::Singular;
use hardpoint::attia::Strut;
use hardpoint::attia::{PointCoordinates, Pose, Station};
use hardpoint::number::Vector3;
use serde_json::Value;

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

/// Sound suspensions that the paper's equations cannot describe, with the reason.
fn unsuitable() -> [(Singular, Strut); 3] {
    let (s, nominal) = (nominal(), nominal());
    let (p5, steering, axis) = (
        s.lower_ball_joint,
        s.strut_top - s.lower_ball_joint,
        s.axis(),
    );
    let offset = (steering - axis * steering.dot(axis)).normalised();
    [
        // The strut's line is level, and its top mount is above the arm.
        (
            Singular::HorizontalStrut,
            Strut {
                strut_lower: s.strut_top + Vector3::new(0.02, 0.4, 0.0),
                strut_upper: None,
                ..nominal
            },
        ),
        (
            Singular::BallJointOnStrutAxis,
            Strut {
                strut_lower: p5 + steering * 0.3,
                strut_upper: None,
                ..nominal
            },
        ),
        // The steering arm points towards the strut, and the tie rod runs along the car.
        (
            Singular::CoplanarKnuckle,
            Strut {
                tie_rod_inner: p5 + Vector3::new(-0.3, -0.13, 0.05),
                tie_rod_outer: p5 + offset * 0.12 + axis * 0.05,
                ..nominal
            },
        ),
    ]
}

/// Strut with each of its points mapped by a function.
fn with_points(strut: &Strut, to: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Strut {
    Strut {
        lower_arm_front: to(strut.lower_arm_front),
        lower_arm_rear: to(strut.lower_arm_rear),
        tie_rod_inner: to(strut.tie_rod_inner),
        strut_top: to(strut.strut_top),
        lower_ball_joint: to(strut.lower_ball_joint),
        strut_lower: to(strut.strut_lower),
        strut_upper: strut.strut_upper.map(&to),
        tie_rod_outer: to(strut.tie_rod_outer),
        rod_point: strut.rod_point.map(&to),
        wheel_centre: to(strut.wheel_centre),
    }
}

fn at(value: f64) -> Station {
    Station { value, rack: 0.0 }
}

fn nominal() -> Strut {
    strut(&reference("angular-velocity-in-plane"))
}

/// Bound on the rounding error of a derivative of this order. `largest` is the size of the terms.
///
/// At a solution, each of the fifteen equations is satisfied to 8 D M eps (the solver's bound). D is the largest
/// distance, M the largest coordinate. The error of the unknowns is at most the norm of the inverse Jacobian times
/// sqrt(15) 8 D M eps. The Jacobian's norm is at least 2 D, so the error is at most 16 eps M times the condition
/// number. A derivative also inherits the errors of all lower orders, which adds this factor once for each order.
fn bound(mechanism: &PointCoordinates, pose: &Pose, order: usize, largest: f64) -> f64 {
    16.0 * (order + 1) as f64 * f64::EPSILON * mechanism.condition(pose) * largest.max(1.0)
}

fn size(points: &Moving) -> f64 {
    points.iter().map(|p| p.norm()).fold(0.0, larger)
}
