//! Tests of comparisons.

use super::super::curve_table::CurveTable;
use super::{Compared, ComparedPoints, Comparison, NamedPoints};
use crate::model::{FrameConvention, LengthUnit};
use crate::report::comparison_page;

fn design(label: &str, unit: LengthUnit, csv: &str) -> Compared {
    Compared {
        label: label.to_owned(),
        topology: None,
        curves: CurveTable::read(csv.as_bytes()).unwrap(),
        unit,
        axes: Some(FrameConvention::Iso8855),
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

/// The second design has a spring, and the third design has no known points.
#[test]
fn points_of_one_design_are_named() {
    let mm = LengthUnit::Millimetre;
    let csv = "travel_mm,camber_deg,status\n0,1,ok\n";
    let mut designs = ["a", "b", "c"].map(|label| design(label, mm, csv));
    let Some(ComparedPoints::OneWheel(points)) = &mut designs[1].points else {
        panic!("the design has points")
    };
    for name in ["spring_upper", "spring_lower"] {
        points.points.push((name.to_owned(), [0.0; 3]));
    }
    designs[2].points = None;
    let comparison = Comparison::of(&designs).unwrap();
    let sentences: Vec<String> = comparison.partial_points().collect();
    assert_eq!(
        sentences,
        ["Hardpoints only in b: spring_upper, spring_lower"]
    );
    assert!(comparison_page(&comparison, &[]).contains(&sentences[0]));
}

/// A rack at -1 mm in axes with y to the right is at the same position as a rack at 1 mm with y to the left.
#[test]
fn stations_and_components_are_shown_in_the_axes_of_the_first() {
    let left = "travel_mm,rack_mm,hub_y_mm,camber_deg,status\n0,-1,5,1,ok\n0,1,7,2,ok\n";
    let right = "travel_mm,rack_mm,hub_y_mm,camber_deg,status\n0,-1,-7,2,ok\n0,1,-5,1,ok\n";
    let mm = LengthUnit::Millimetre;
    let mut designs = [design("a", mm, left), design("b", mm, right)];
    designs[1].axes = Some(FrameConvention::SaeJ670);
    let comparison = Comparison::of(&designs).unwrap();
    assert_eq!(comparison.stations, [[0.0, -1.0], [0.0, 1.0]]);
    for output in &comparison.outputs {
        assert_eq!(output.values[0], output.values[1], "{}", output.column);
    }
}

/// Without axes, a run can be compared as long as no value depends on them.
#[test]
fn values_of_unknown_axes_are_refused() {
    let mm = LengthUnit::Millimetre;
    for (csv, is_comparable) in [
        ("travel_mm,rack_mm,camber_deg,status\n0,0,1,ok\n", true),
        ("travel_mm,rack_mm,camber_deg,status\n0,1,1,ok\n", false),
        ("travel_mm,hub_y_mm,status\n0,5,ok\n", false),
    ] {
        let mut designs = [design("a", mm, csv), design("b", mm, csv)];
        designs[1].axes = None;
        let compared = Comparison::of(&designs);
        assert_eq!(compared.is_ok(), is_comparable, "{csv}");
        if let Err(why) = compared {
            assert!(why.contains("b: the sign of "), "{why}");
        }
    }
}

/// At an angle of the arm, two designs have different travels.
#[test]
fn the_travel_is_a_result_if_an_angle_is_given() {
    let mm = LengthUnit::Millimetre;
    let own = "travel_mm,arm_angle_deg,camber_deg,status\n-4,-1,1,ok\n4,1,2,ok\n";
    let other = "travel_mm,arm_angle_deg,camber_deg,status\n-5,-1,1,ok\n5,1,2,ok\n";
    let comparison = Comparison::of(&[design("a", mm, own), design("b", mm, other)]).unwrap();
    assert_eq!(comparison.stations, [[-1.0], [1.0]]);
    assert_eq!(comparison.outputs[0].column, "travel_mm");
    assert_eq!(comparison.outputs[0].values[1], [Some(-5.0), Some(5.0)]);
}

/// Curves over different drives have positions in common only by chance.
#[test]
fn curves_over_different_drives_are_refused() {
    let mm = LengthUnit::Millimetre;
    let travel = "travel_mm,camber_deg,status\n0,1,ok\n1,2,ok\n";
    let angle = "travel_mm,arm_angle_deg,camber_deg,status\n0,0,1,ok\n4,1,2,ok\n";
    for pair in [[travel, angle], [angle, travel]] {
        let refused = Comparison::of(&[design("a", mm, pair[0]), design("b", mm, pair[1])]);
        assert!(
            refused
                .unwrap_err()
                .contains("run them over the same motion")
        );
    }
}

/// At time 0, the wheel may be at any travel.
#[test]
fn a_motion_over_time_has_no_design_position() {
    let mm = LengthUnit::Millimetre;
    let over_time = "travel_mm,time_s,camber_deg,status\n-40,0,1,ok\n0,2,2,ok\n";
    let over_travel = "travel_mm,camber_deg,status\n-40,1,ok\n0,2,ok\n";
    for (csv, row) in [
        (over_time, "\ncamber_deg,a,,1.0,2.0,"),
        (over_travel, "\ncamber_deg,a,2.0,1.0,2.0,"),
    ] {
        let designs = ["a", "b"].map(|label| design(label, mm, csv));
        let table = Comparison::of(&designs).unwrap().table().csv(None);
        assert!(table.contains(row), "{table}");
    }
}

/// The same motion with fewer and with more stations: the axle passes each height twice, in opposite directions.
#[test]
fn stations_of_an_axle_over_time_are_told_apart() {
    let csv = |step: f64| {
        let mut csv =
            "heave_mm,travel_left_mm,travel_right_mm,time_s,rise_d1_mm_per_s,status\n".to_owned();
        for k in 0..=(4.0 / step) as u32 {
            let time = step * f64::from(k);
            let (heave, rise) = (20.0 * time - 5.0 * time * time, 20.0 - 10.0 * time);
            csv += &format!("{heave},{heave},{heave},{time},{rise},ok\n");
        }
        csv
    };
    let mm = LengthUnit::Millimetre;
    let designs = [design("a", mm, &csv(1.0)), design("b", mm, &csv(0.5))];
    let comparison = Comparison::of(&designs).unwrap();
    assert_eq!(comparison.motion[0].column, "heave_mm");
    assert_eq!(comparison.stations.len(), 5);
    let mut outputs = comparison.outputs.iter();
    let rise = outputs.find(|o| o.column == "rise_d1_mm_per_s");
    let rise = &rise.unwrap().values;
    assert_eq!(rise[0], [20.0, 10.0, 0.0, -10.0, -20.0].map(Some));
    assert_eq!(rise[0], rise[1]);
}

/// The page of designs with the topologies A, B and A names each topology once.
#[test]
fn each_topology_is_named_once() {
    let csv = "travel_mm,camber_deg,status\n0,1,ok\n";
    let mut designs = ["a", "b", "c"].map(|label| design(label, LengthUnit::Millimetre, csv));
    for (design, topology) in designs.iter_mut().zip(["strut", "five_link", "strut"]) {
        design.topology = Some(topology.to_owned());
    }
    let comparison = Comparison::of(&designs).unwrap();
    assert_eq!(comparison.topologies, ["strut", "five_link"]);
}
