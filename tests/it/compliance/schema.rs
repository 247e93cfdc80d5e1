//! Tests of the names of test results in the schema for editors.

use super::support::{elastic, with};
use std::collections::BTreeSet;

/// Returns true if a text matches a pattern of groups with alternatives, such as `^(a|b)(_c_-?[0-9.]+)?(_d|_e)?$`.
fn matches(pattern: &str, text: &str) -> bool {
    let inside = pattern.strip_prefix("^(").unwrap();
    let inside = inside.strip_suffix("$").unwrap();
    let groups: Vec<&str> = inside.split('(').collect();
    let mut left: BTreeSet<&str> = BTreeSet::from([text]);
    for group in groups {
        let (alternatives, end) = group.split_once(')').unwrap();
        let mut next = match end {
            "?" => left.clone(),
            "" => BTreeSet::new(),
            other => panic!("{other}"),
        };
        for text in &left {
            for alternative in alternatives.split('|') {
                let Some(stem) = alternative.strip_suffix("-?[0-9.]+") else {
                    next.extend(text.strip_prefix(alternative));
                    continue;
                };
                let number = text.strip_prefix(stem);
                let number = number.map(|rest| rest.strip_prefix('-').unwrap_or(rest));
                let rest =
                    number.map(|n| n.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.'));
                next.extend(rest.filter(|rest| Some(rest.len()) < number.map(str::len)));
            }
        }
        left = next;
    }
    left.contains("")
}

/// The schema accepts the names of test results that studies accept: with suffixes for trail, held quantity, mode, bar,
/// steering, secant and load. It rejects other names.
#[test]
fn the_schema_accepts_figures_with_suffixes() {
    let schema = hardpoint::study::schema();
    let places = [
        "/anyOf/0/properties/outputs/properties/characteristics/items/anyOf",
        "/anyOf/0/properties/optimise/properties/targets/items/properties/figure/anyOf",
    ];
    for place in places {
        let [listed, further] = &schema.pointer(place).unwrap().as_array().unwrap()[..] else {
            panic!("{place}");
        };
        let listed: Vec<&str> = listed["enum"]
            .as_array()
            .unwrap()
            .iter()
            .map(|name| name.as_str().unwrap())
            .collect();
        let pattern = further["pattern"].as_str().unwrap();
        let knows = |name: &str| listed.contains(&name) || matches(pattern, name);
        let study = elastic(&with("subframe_axle_compliance.toml", ""));
        let figures = study.axle().unwrap().axle.figures();
        assert!(figures.len() > 30);
        let stems = figures.iter().map(|figure| figure.stem());
        for name in
            stems.chain(["toe_by_lateral_force_trail_-12.5_wheel_load_secant_lateral".to_owned()])
        {
            assert!(knows(&name), "{name}");
        }
        for wrong in [
            "toe_by_lateral_force_trail",
            "toe_by_lateral_force_trail_",
            "toe_by_lateral_force_secant_opposed",
            "toe_by_laterl_force_secant",
            "toe_by_lateral_force_30",
        ] {
            assert!(!knows(wrong), "{wrong}");
        }
    }
}
