//! Reading the reference answers, and the mechanisms they are about.
#![allow(dead_code, reason = "each test file uses a part of it")]

pub mod quadratics;
pub mod random;
pub mod small_steps;

use hardpoint::kinematics::{March, Solver};
use hardpoint::model::{
    Axis, Body, Drive, Frame, FrameConvention, Mechanism, Point, PointId, Side, Topology,
};
use hardpoint::number::Vector3;
use serde_json::Value;

/// A number that is stored as a decimal string.
pub fn number(value: &Value) -> f64 {
    value
        .as_str()
        .expect("a decimal string")
        .parse()
        .expect("a number")
}

/// A vector of such numbers.
pub fn vector(value: &Value) -> Vector3<f64> {
    Vector3::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

/// Names of the reference's points, in the order of the mechanism's.
pub const NAMES: [(&str, &str); 11] = [
    ("p1", "lower_arm_front"),
    ("p2", "lower_arm_rear"),
    ("p5", "lower_ball_joint"),
    ("p4", "strut_top"),
    ("p6", "strut_lower"),
    ("p7", "strut_upper"),
    ("p3", "tie_rod_inner"),
    ("p8", "tie_rod_outer"),
    ("p10", "wheel_centre"),
    ("p11", "spindle_inner"),
    ("p9", "rod_point"),
];

/// A case of the reference: mechanism and design in the kernel's frame.
pub struct Case {
    pub json: Value,
    pub mechanism: Mechanism,
    pub design: Vec<Vector3<f64>>,
    pub frame: Frame,
    /// Reference name of each point.
    pub names: Vec<&'static str>,
}

impl Case {
    pub fn read(name: &str) -> Case {
        let path = format!(
            "{}/tests/data/reference/{name}.json",
            env!("CARGO_MANIFEST_DIR")
        );
        let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
        let json: Value = serde_json::from_str(&text).expect("valid JSON");
        let side = if json["side"] == -1 {
            Side::Right
        } else {
            Side::Left
        };
        let frame = Frame::new(FrameConvention::Iso8855, side);
        let axis_through_top = json["strut_model"] == "axis46";
        let topology = Topology::named("macpherson").unwrap();
        let given: Vec<&str> = topology
            .hardpoints
            .iter()
            .map(|h| h.name)
            .filter(|n| !(axis_through_top && *n == "strut_upper"))
            .collect();
        let mut mechanism = (topology.build)(topology, &given);
        let top = mechanism.point("strut_top").unwrap();
        mechanism.points.push(Point {
            name: "rod_point".to_owned(),
            body: Body::StrutRod(top),
        });
        if axis_through_top {
            mechanism.points.push(Point {
                name: "strut_upper".to_owned(),
                body: Body::Knuckle,
            });
        }
        let names: Vec<&'static str> = mechanism
            .points
            .iter()
            .map(|p| NAMES.iter().find(|(_, n)| *n == p.name).unwrap().0)
            .collect();
        let design = names
            .iter()
            .map(|p| frame.vector(vector(&json["hardpoints"][p])))
            .collect();
        Case {
            json,
            mechanism,
            design,
            frame,
            names,
        }
    }

    pub fn states(&self) -> &[Value] {
        self.json["states"].as_array().unwrap()
    }

    pub fn point(&self, reference_name: &str) -> PointId {
        PointId(
            self.names
                .iter()
                .position(|n| *n == reference_name)
                .unwrap(),
        )
    }

    pub fn solver(&self) -> Solver<'_> {
        Solver::new(&self.mechanism, &self.design).unwrap()
    }
}

/// Drive, its value and the rack's in the kernel's convention, and the factor from the reference's
/// drive to the kernel's: the reference turns the arm about p2 - p1, the kernel so that a
/// positive angle raises the ball joint. The reference's rack moves along the kernel's +y already.
pub fn motion(state: &Value) -> (Drive, f64, f64, f64) {
    let value = number(&state["drive"]["value"]);
    let rack = number(&state["drive"]["rack"]);
    match state["drive"]["kind"].as_str().unwrap() {
        "travel" => (Drive::Travel, value, rack, 1.0),
        "arm_delta" => (Drive::ArmAngle, -value, rack, -1.0),
        other => panic!("{other}"),
    }
}

/// A march with one station, and stations on the way to it so that the steps are ordinary ones.
pub fn march_to(value: f64) -> March {
    March::through(&[value])
}

/// The largest of some absolute values.
#[derive(Default, Clone, Copy, Debug)]
pub struct Worst(pub f64);

impl Worst {
    pub fn note(&mut self, error: f64) {
        // NaN must win.
        if error.is_nan() || error.abs() > self.0 {
            self.0 = error.abs();
        }
    }
}

pub const AXES: [Axis; 3] = Axis::ALL;
