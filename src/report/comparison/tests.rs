//! Tests of comparisons.

use super::super::curve_table::CurveTable;
use super::units::split;
use super::{Compared, ComparedPoints, Comparison, NamedPoints};
use crate::model::LengthUnit;

fn design(label: &str, unit: LengthUnit, csv: &str) -> Compared {
    Compared {
        label: label.to_owned(),
        topology: None,
        curves: CurveTable::read(csv.as_bytes()).unwrap(),
        unit,
        mechanism: None,
        points: Some(ComparedPoints::OneWheel(NamedPoints {
            points: vec![("strut_top".to_owned(), [0.0, 254.0 / 25.4, 1.0])],
            signs: [1.0; 3],
        })),
    }
}

#[test]
fn differences_are_taken_at_common_stations_in_one_unit() {
    let mm = "travel_mm,camber_deg,bump_steer_deg_per_mm,status\n-25.4,1.0,0.5,ok\n0,2.0,0.5,ok\n7,9,9,ok\n";
    let inch = "travel_in,camber_deg,bump_steer_deg_per_in,toe_deg,status\n-1,1.5,12.7,0,ok\n0,,12.7,0,ok\n";
    let designs = [
        design("a", LengthUnit::Millimetre, mm),
        design("b", LengthUnit::Inch, inch),
    ];
    let comparison = Comparison::of(&designs).unwrap();
    assert_eq!(comparison.stations, [[-25.4], [0.0]]);
    assert_eq!(comparison.outputs[0].values[1], [Some(1.5), None]);
    let steer = &comparison.outputs[1];
    assert_eq!(
        (steer.column.as_str(), steer.unit.as_str()),
        ("bump_steer_deg_per_mm", "°/mm")
    );
    assert!((steer.values[1][0].unwrap() - 0.5).abs() < 1e-15);
    // The page also has each design's own stations, and outputs that no other design has.
    let own = |column: &str| {
        let mut all = comparison.own_outputs.iter();
        &all.find(|o| o.column == column).unwrap().values
    };
    assert_eq!(comparison.own_stations[0].len(), 3);
    assert_eq!(
        own("camber_deg")[0],
        Some(vec![Some(1.0), Some(2.0), Some(9.0)])
    );
    assert_eq!(own("toe_deg")[..], [None, Some(vec![Some(0.0); 2])]);
    assert_eq!(
        comparison.partial,
        [("toe_deg".to_owned(), vec!["b".to_owned()])]
    );
    let csv = String::from_utf8(comparison.csv()).unwrap();
    assert!(
        csv.starts_with("travel_mm,camber_deg [a],camber_deg [b],camber_deg [b - a],"),
        "{csv}"
    );
    assert!(csv.contains("-25.4,1.0,1.5,0.5,"), "{csv}");
    // 10 in are 254 mm, 1 in is 25.4 mm.
    let moved = comparison.moved_table().csv(None);
    assert!(moved.contains("strut_top,b,0.0,244.0,24.4,"), "{moved}");
}

#[test]
fn what_cannot_be_compared_says_why() {
    let table = "travel_mm,camber_deg,status\n0,1.0,ok\n";
    let other = "travel_mm,camber_deg,status\n1,1.0,ok\n";
    let mm = LengthUnit::Millimetre;
    let refused = Comparison::of(&[design("a", mm, table), design("b", mm, other)]);
    assert!(
        refused
            .unwrap_err()
            .contains("have no common value of travel_mm")
    );
    let third = "travel_mm,toe_deg,status\n0,1.0,ok\n";
    let refused = Comparison::of(&[design("a", mm, table), design("b", mm, third)]);
    assert!(refused.unwrap_err().contains("have no common output"));
}

#[test]
fn units_are_told_from_names() {
    for (name, title, unit) in [
        ("camber_deg", "camber", "deg"),
        ("motion_ratio", "motion_ratio", ""),
        ("camber_d1_deg_per_mm", "camber_d1", "deg_per_mm"),
        ("braking_tie_rod_N", "braking_tie_rod", "N"),
    ] {
        assert_eq!(split(name), (title, unit));
    }
}
