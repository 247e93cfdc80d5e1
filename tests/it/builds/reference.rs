//! Tests of builds against a 60-digit solution from other equations (`tests/data/own/builds.py`).

use super::{assembler, parameter, plan, study};
use crate::support::number;
use hardpoint::assembly::{Rest, built_curves};
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
