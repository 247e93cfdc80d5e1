//! Tests of builds against a 60-digit solution from other equations (`tests/data/own/builds.py`).

use super::independent::coordinate;
use super::other_equations::{Drawing, Motion};
use super::{assembler, parameter, plan, study};
use crate::support::number;
use hardpoint::assembly::{Rest, built_curves};
use hardpoint::bench::DoubleDouble;
use hardpoint::model::Axis;
use hardpoint::number::Scalar;
use serde_json::Value;

/// Positions of builds agree with the reference to 1e-13 of the suspension's size, camber and toe to 1e-12 degrees. Derivatives
/// of camber and toe with respect to lengths and points agree to 1e-10, relative to the larger of their value and 0.01.
#[test]
fn builds_of_every_topology_are_those_of_another_formulation() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/own/builds.json");
    let cases: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let cases = cases.as_array().unwrap();
    assert!(cases.len() >= 30);
    for case in cases {
        let name = case["study"].as_str().unwrap();
        let study = study(
            name,
            &[
                "outputs.characteristics=[\"camber\",\"toe\"]",
                "outputs.points=[\"wheel_centre\"]",
                "outputs.order=\"position\"",
                "motion.travel=[0.0, 25.0]",
                "motion.rack=0.0",
            ],
        );
        let assembler = assembler(&study);
        let mechanism = &assembler.suspension().mechanism;
        let mut parts = assembler.drawn().clone();
        let key = |entry: &Value| {
            let (of, axis) = (entry["of"].as_str().unwrap(), entry["axis"].as_str());
            parameter(&assembler, of, axis)
        };
        for change in case["changes"].as_array().unwrap() {
            parts.change(mechanism, key(change), number(&change["by"]));
        }
        let built = assembler.build(&parts, Rest::Height(0.0)).unwrap();
        let size = study.wheel().size();
        for (point, place) in case["stations"][0]["points"].as_object().unwrap() {
            let id = mechanism.point(point).unwrap();
            let off = built.suspension.design[id.0] - crate::support::vector(place);
            assert!(off.norm() < 1e-13 * size, "{name} {point}: {off:?}");
        }

        let directions: Vec<_> = case["derivatives"].as_array().unwrap().iter().collect();
        assert!(directions.len() >= 5, "{name}");
        let parameters: Vec<_> = directions.iter().map(|d| [(key(d), 1.0)]).collect();
        let parameters: Vec<_> = parameters.iter().map(|d| &d[..]).collect();
        let found = built_curves(&assembler, &built, &plan(&study), &parameters).unwrap();
        assert_eq!(case["stations"].as_array().unwrap().len(), 2, "{name}");
        for (station, expected) in case["stations"].as_array().unwrap().iter().enumerate() {
            let values = &found.curves.stations[station].values;
            for (column, key) in ["camber_deg", "toe_deg"].into_iter().enumerate() {
                let off = values[column].unwrap() - number(&expected[key]);
                assert!(off.abs() < 1e-12, "{name} {key}: {off}");
            }
            let centre = crate::support::vector(&expected["points"]["wheel_centre"]).to_array();
            for (value, expected) in values[2..5].iter().zip(centre) {
                assert!((value.unwrap() - expected).abs() < 1e-13 * size, "{name}");
            }
        }
        for (d, expected) in directions.iter().enumerate() {
            for (column, key) in ["camber_deg", "toe_deg"].into_iter().enumerate() {
                let (value, truth) = (found.derivative(d, 1, column), number(&expected[key]));
                let off = (value - truth).abs();
                assert!(
                    off < 1e-10 * truth.abs().max(0.01),
                    "{name} {expected}: {value} {off}"
                );
            }
        }
    }
}

/// The solver `other_equations` agrees with the 60-digit reference values to all 25 digits that are stored.
#[test]
fn the_other_equations_give_the_reference_answers() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/own/builds.json");
    let cases: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let mut compared = 0;
    for answer in cases.as_array().unwrap() {
        let name = answer["study"].as_str().unwrap();
        let path = format!("{}/studies/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let drawing = Drawing::read(&std::fs::read_to_string(path).unwrap(), &[]);
        let mut parts = drawing.drawn();
        for change in answer["changes"].as_array().unwrap() {
            let (of, by) = (change["of"].as_str().unwrap(), decimal(&change["by"]));
            let changed = match change["axis"].as_str() {
                Some(axis) => {
                    let id = drawing.names.iter().position(|n| n == of).unwrap();
                    let axis = Axis::ALL.iter().position(|a| a.name() == axis).unwrap();
                    coordinate(&mut parts.points[id], axis)
                }
                None => {
                    let member = drawing.members.iter().position(|(n, _)| n == of);
                    &mut parts.lengths[member.unwrap()]
                }
            };
            *changed = *changed + by;
        }
        let rest = drawing.put_together(&parts).unwrap();
        for station in answer["stations"].as_array().unwrap() {
            let at = Motion {
                travel: station["travel"].as_f64().unwrap(),
                rack: 0.0,
            };
            let solved = drawing.moved(&parts, &rest, at).unwrap();
            let found = drawing.read_off(&parts, at, &solved);
            for (point, place) in station["points"].as_object().unwrap() {
                compared += 1;
                let id = drawing.names.iter().position(|n| n == point).unwrap();
                for (found, place) in found.places[id]
                    .to_array()
                    .into_iter()
                    .zip(place.as_array().unwrap())
                {
                    let off = (found - decimal(place)).value();
                    assert!(off.abs() < 1e-20, "{name} {point}: {off}");
                }
            }
            for (found, key) in found.angles.into_iter().zip(["camber_deg", "toe_deg"]) {
                let expected = decimal(&station[key]);
                // Studies with angles take their sines in doubles, which limits the accuracy.
                let fine = if drawing.spin.is_ok() { 1e-20 } else { 1e-13 };
                let off = (found - expected).value();
                assert!(off.abs() < fine, "{name} {key}: {off}");
            }
        }
    }
    assert!(compared >= 800, "{compared} points");
}

/// Number that the file stores as a decimal string, with more digits than a double.
fn decimal(value: &Value) -> DoubleDouble {
    let text = value.as_str().unwrap();
    let high = number(value);
    // Adds the digits from left to right, with the precision of two doubles.
    let (digits, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let ten = DoubleDouble::from(10.0);
    let mut sum = DoubleDouble::default();
    for digit in whole
        .trim_start_matches('-')
        .chars()
        .chain(fraction.chars())
    {
        sum = sum * ten + f64::from(digit.to_digit(10).unwrap()).into();
    }
    let power = exponent.parse::<i32>().unwrap() - fraction.len() as i32;
    for _ in 0..power.unsigned_abs() {
        sum = if power < 0 { sum / ten } else { sum * ten };
    }
    let sum = if high < 0.0 { -sum } else { sum };
    assert_eq!(sum.value(), high);
    sum
}
