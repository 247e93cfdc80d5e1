//! Support for tests. Reads the reference values, and the mechanisms of the reference.
#![allow(dead_code, reason = "each test binary uses a part of it")]

pub mod bounded;
pub mod mutants;
pub mod quadratics;
pub mod random;
#[cfg(target_os = "linux")]
pub mod signals;
pub mod small_steps;

use hardpoint::characteristics::{Characteristic, Quantity, WheelReading};
use hardpoint::model::{
    Axis, Body, Drive, Frame, FrameConvention, Mechanism, Point, PointId, Side, Topology,
};
use hardpoint::number::{Jet, Vector3};
use hardpoint::solve::{Solver, StationOrder};
use hardpoint::study::Study;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// True if the processor has SIMD lanes. Without SIMD lanes, the program solves each design alone. Tests that count the
/// work of lanes then end early. Other tests check the solutions of designs alone.
pub fn has_lanes() -> bool {
    hardpoint::number::Width::widest().is_some()
}

/// Larger of two numbers. NaN if one of them is NaN, so that a comparison of the largest error with its bound fails. `f64::max`
/// would ignore NaN.
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// Folder of the sample studies.
pub fn studies() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/studies"))
}

/// Text of a sample study.
pub fn sample(name: &str) -> String {
    let path = studies().join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Sample study with some of its keys changed.
pub fn study(name: &str, overrides: &[&str]) -> Study {
    let overrides: Vec<String> = overrides.iter().map(|o| (*o).to_owned()).collect();
    Study::read(&studies().join(name), &overrides).unwrap_or_else(|e| panic!("{e}"))
}

/// A printed text on one line, with single spaces.
pub fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Number that is stored as a decimal string.
pub fn number(value: &Value) -> f64 {
    value
        .as_str()
        .expect("a decimal string")
        .parse()
        .expect("a number")
}

/// Vector of numbers that are stored as decimal strings.
pub fn vector(value: &Value) -> Vector3<f64> {
    Vector3::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

/// Names of the reference's points, in the order of the mechanism's points.
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

/// Case of the reference: mechanism and design in the solver's frame.
pub struct Case {
    pub json: Value,
    pub mechanism: Mechanism,
    pub design: Vec<Vector3<f64>>,
    pub frame: Frame,
    /// Reference name of each point.
    pub names: Vec<&'static str>,
}

impl Case {
    /// Reads a case of `tests/data/reference`.
    pub fn read(name: &str) -> Case {
        Case::of("reference", name)
    }

    /// Reads a case of `tests/data/own`.
    pub fn own(name: &str) -> Case {
        Case::of("own", name)
    }

    fn of(folder: &str, name: &str) -> Case {
        let path = format!(
            "{}/tests/data/{folder}/{name}.json",
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

    /// States of the case, at least one.
    pub fn states(&self) -> &[Value] {
        let states = self.json["states"].as_array().unwrap();
        assert!(!states.is_empty(), "a case has states");
        states
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

/// Drive, its value and the rack displacement in the solver's convention. Also the factor from the reference's drive to
/// the solver's drive. The reference turns the arm about p2 - p1. In the solver, a positive angle raises the ball
/// joint. The reference's rack already moves along the solver's +y.
pub fn motion(state: &Value) -> (Drive, f64, f64, f64) {
    let value = number(&state["drive"]["value"]);
    let rack = number(&state["drive"]["rack"]);
    match state["drive"]["kind"].as_str().unwrap() {
        "travel" => (Drive::Travel, value, rack, 1.0),
        "arm_delta" => (Drive::ArmAngle, -value, rack, -1.0),
        other => panic!("{other}"),
    }
}

/// Order of stations for a single station. It has intermediate stations, so that the steps have ordinary lengths.
pub fn order_to(value: f64) -> StationOrder {
    StationOrder::through(&[value])
}

/// Largest of several absolute values.
#[derive(Default, Clone, Copy, Debug)]
pub struct Worst(pub f64);

impl Worst {
    pub fn note(&mut self, error: f64) {
        self.0 = larger(self.0, error.abs());
    }
}

pub const AXES: [Axis; 3] = Axis::ALL;

/// Names of the reference's angles.
pub const ANGLES: [(&str, Characteristic); 4] = [
    ("camber", Characteristic::Camber),
    ("toe", Characteristic::Toe),
    ("kpi", Characteristic::KingpinInclination),
    ("caster", Characteristic::Caster),
];

/// Largest errors of the sensitivities in a state, separately for value, first and second derivative. Each error is
/// relative to the largest sensitivity of its kind: of all points, or of all angles.
pub fn sensitivity_errors(
    case: &Case,
    state: &Value,
    sign: f64,
    view: &WheelReading<3>,
    linearised: &hardpoint::derive::Linearised<'_, 3>,
) -> [Worst; 3] {
    let mut errors = [Worst::default(); 3];
    let sens = &state["sens"];
    let list = |key: &str| -> Vec<String> {
        let names = sens[key].as_array().unwrap().iter();
        names.map(|v| v.as_str().unwrap().to_owned()).collect()
    };
    let (params, outputs) = (list("params"), list("outputs"));
    let mut buffer = vec![Vector3::new(0.0, 0.0, 0.0).map(Jet::constant); case.design.len()];
    for points in [true, false] {
        // The scale is the largest sensitivity of all points, or of all angles, at this order.
        let mut scale = [0.0_f64; 3];
        let mut found = Vec::new();
        for (column, output) in outputs.iter().enumerate() {
            let (quantity, output_sign) = match output.split_once('.') {
                Some((point, axis)) if points => {
                    let axis = AXES.into_iter().find(|a| a.name() == axis).unwrap();
                    (
                        Quantity::Coordinate(case.point(point), axis),
                        case.frame.sign(axis),
                    )
                }
                None if !points => match ANGLES.iter().find(|(n, _)| n == output) {
                    Some((_, c)) => (Quantity::Characteristic(*c), 1.0),
                    None => continue,
                },
                _ => continue,
            };
            view.gradients(
                linearised,
                quantity,
                2,
                &mut buffer,
                &mut |order, PointId(p), gradient| {
                    for axis in AXES {
                        let param = format!("{}.{}", case.names[p], axis.name());
                        let Some(row) = params.iter().position(|n| *n == param) else {
                            continue;
                        };
                        let wanted = number(&sens[format!("d{order}")][row][column]);
                        scale[order] = scale[order].max(wanted.abs());
                        let flip = output_sign * case.frame.sign(axis) * sign.powi(order as i32);
                        found.push((order, gradient.to_array()[axis as usize] * flip - wanted));
                    }
                },
            );
        }
        assert!(found.len() > 100);
        for (order, error) in found {
            errors[order].note(error / scale[order]);
        }
    }
    errors
}

/// Rows of a CSV text by column.
pub fn rows_by_column(csv: &[u8]) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_reader(csv);
    let header = reader.headers().unwrap().clone();
    let row = |record: csv::StringRecord| {
        let cells = header.iter().zip(&record);
        cells
            .map(|(name, cell)| (name.to_owned(), cell.to_owned()))
            .collect()
    };
    reader
        .records()
        .map(|record| row(record.unwrap()))
        .collect()
}

/// Asserts that all numbers in two SVG pictures differ by at most one pixel, and that the other text is equal. The
/// tolerance allows for rounding errors on another platform, or for a slightly better optimum.
pub fn assert_same_picture(kept: &str, made: &str, name: &str) {
    let pieces = |svg: &str| -> Vec<String> {
        let parts = svg.split_inclusive(|c: char| !(c.is_ascii_digit() || ".-".contains(c)));
        parts.map(str::to_owned).collect()
    };
    let (kept, made) = (pieces(kept), pieces(made));
    assert_eq!(kept.len(), made.len(), "{name} is another picture");
    for (a, b) in kept.iter().zip(&made) {
        let number =
            |s: &str| s[..s.len() - s.chars().last().map_or(0, char::len_utf8)].parse::<f64>();
        match (number(a), number(b)) {
            (Ok(x), Ok(y)) => assert!((x - y).abs() <= 1.0, "{name}: {a} and {b}"),
            _ => assert_eq!(a, b, "{name}"),
        }
    }
}
