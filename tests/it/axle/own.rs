//! Tests of axles with different sides against the results of an independent script
//! (`tests/data/own/generate_axles.py`).

use hardpoint::axle::{AxleQuantity as A, AxleSolver, Placement, Quantity, WheelQuantity as W};
use hardpoint::characteristics::Characteristic;
use hardpoint::model::Side::{Left, Right};
use hardpoint::study::Study;
use serde_json::Value;
use std::path::Path;

fn quantity(name: &str) -> Option<Quantity> {
    let (stem, side) = match (name.strip_suffix("_left"), name.strip_suffix("_right")) {
        (Some(stem), _) => (stem, Some(Left)),
        (_, Some(stem)) => (stem, Some(Right)),
        _ => (name, None),
    };
    let Some(side) = side else {
        let all = A::ALL.iter();
        return all
            .copied()
            .find(|q| q.info().name == stem)
            .map(Quantity::Axle);
    };
    let own = W::ALL.iter().find(|q| q.info().name == stem);
    let corner = || Characteristic::named(stem).map(|c| Quantity::Corner(side, c));
    own.map(|q| Quantity::Wheel(side, *q)).or_else(corner)
}

/// Travels and quantities of every state equal the results of the script. A value below 1 (a travel below 100 mm) has the
/// same bound as the value 1 (100 mm).
#[test]
fn axles_with_two_different_sides_are_solved() {
    for name in ["five-link-axle", "semi-trailing-axle"] {
        let path = format!("{}/tests/data/own/{name}.json", env!("CARGO_MANIFEST_DIR"));
        let case: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        let points = |which: &str| {
            let points = case[which].as_object().unwrap().iter();
            points
                .map(|(name, p)| format!("{name} = {p}\n"))
                .collect::<String>()
        };
        let text = format!(
            "[suspension]\ntopology = {}\n[suspension.hardpoints]\n{}[axle.right.hardpoints]\n{}\
             [wheel]\nradius = {}\n[motion]\nroll = 0.0\n",
            case["topology"],
            points("left"),
            points("right"),
            case["radius"],
        );
        let study = Study::from_text("case.toml", &text, Path::new(".")).unwrap();
        let axle = study.axle().unwrap().clone().axle;
        let wanted: Vec<_> = [
            "jacking_coefficient_left",
            "roll_steer_left",
            "roll_centre_height",
        ]
        .into_iter()
        .map(|name| quantity(name).unwrap())
        .collect();
        let mut solver = AxleSolver::<3>::new(&axle, &wanted, false).unwrap();
        let mut compared = 0;
        for state in case["states"].as_array().unwrap() {
            let number = |key: &str| state[key].as_f64().unwrap();
            let placement = Placement::Roll {
                heave: number("heave"),
                roll: number("roll_deg").to_radians(),
                rack: 0.0,
            };
            let placed = solver.place(&placement).unwrap();
            let read = solver.read(&placed).unwrap().state;
            for (name, expected) in state["values"].as_object().unwrap() {
                let expected: f64 = expected.as_str().unwrap().parse().unwrap();
                let (found, scale) = match name.as_str() {
                    "travel_left" => (placed.travels[0], 100.0),
                    "travel_right" => (placed.travels[1], 100.0),
                    _ => {
                        let found = quantity(name).unwrap_or_else(|| panic!("{name}"));
                        (found.value(&read).unwrap(), 1.0)
                    }
                };
                let error = (found - expected).abs() / expected.abs().max(scale);
                assert!(
                    error < 1e-12,
                    "{name} {placement:?}: {found} {expected} {error:e}"
                );
                compared += 1;
            }
        }
        assert_eq!(compared, 4 * 19, "{name}");
    }
}
