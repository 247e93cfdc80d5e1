//! Tests of layouts of charts.

use super::super::Source;
use super::super::labels::LABEL;
use super::super::{Chart, Line, Quantity, Wanted};
use super::{AxisLayout, LETTER, SIZE};
use crate::report::curve_table::CurveTable;

/// Table of the lines y = a + b x over x from -40 to 40. `lines` has a and b of each line.
fn table(lines: &[[f64; 2]]) -> CurveTable {
    let places: Vec<f64> = (-4..=4).map(|k| 10.0 * f64::from(k)).collect();
    let column = |f: &dyn Fn(f64) -> f64| places.iter().map(|x| Some(f(*x))).collect();
    let mut columns: Vec<Vec<Option<f64>>> = vec![column(&|x| x)];
    columns.extend(lines.iter().map(|[a, b]| column(&|x| a + b * x)));
    let names = (0..lines.len()).map(|k| format!("y{k}"));
    CurveTable {
        header: ["x".to_owned()].into_iter().chain(names).collect(),
        columns,
        status: Vec::new(),
    }
}

fn line(number: usize, rows: std::ops::Range<usize>) -> Line {
    Line {
        label: Some(format!("line {number}")),
        told: String::new(),
        class: "main strong".to_owned(),
        is_main: true,
        in_strip: true,
        has_dots: false,
        source: Source {
            table: 0,
            x: "x".to_owned(),
            y: format!("y{number}"),
            rows: rows.collect(),
        },
    }
}

fn chart(lines: Vec<Line>, wanted: Vec<Wanted>) -> Chart {
    Chart {
        key: "y".to_owned(),
        x: Quantity::of_column("travel_mm"),
        y: Quantity::new("y", "toe", "°"),
        lines,
        wanted,
        ..Chart::default()
    }
}

/// Labels of curves with nearly equal end values keep their order and their distance, and stay beside the plot.
#[test]
fn labels_at_the_ends_do_not_overlap() {
    let slopes: Vec<[f64; 2]> = (0..9).map(|k| [0.0, 1.0 + 1e-3 * f64::from(k)]).collect();
    let lines = (0..9).map(|k| line(k, 0..9)).collect();
    let layout = chart(lines, Vec::new()).layout(&[table(&slopes)]);
    assert_eq!(layout.labels.len(), 9);
    for pair in layout.labels.windows(2) {
        assert!(pair[1].at[1] - pair[0].at[1] >= LABEL - 1e-9, "{pair:?}");
        assert!(pair[1].end[1] >= pair[0].end[1]);
    }
    for label in &layout.labels {
        assert!(
            label.at[1] >= layout.plot[1] && label.at[1] <= layout.plot[3],
            "{label:?}"
        );
        let width = LETTER * label.text.chars().count() as f64;
        assert!(
            label.at[0] > layout.plot[2] && label.at[0] + width <= SIZE[0],
            "{label:?}"
        );
    }
}

/// For a straight curve and a constant target, the deviation is their difference divided by the tolerance, also between the rows of
/// the table.
#[test]
fn deviations_are_in_tolerances() {
    let wanted = Wanted::Values {
        points: vec![[-40.0, 1.0], [5.0, 1.0], [40.0, 1.0]],
        tolerance: 0.25,
        column: Some("y0".to_owned()),
    };
    let layout = chart(vec![line(0, 0..9)], vec![wanted]).layout(&[table(&[[1.0, 0.01]])]);
    let expected = [[-40.0, -1.6], [5.0, 0.2], [40.0, 1.6]];
    for (found, expected) in layout.deviations[0].points.iter().zip(expected) {
        assert!(
            (found[0] - expected[0]).abs() + (found[1] - expected[1]).abs() < 1e-12,
            "{found:?}"
        );
    }
    let svg = layout.element();
    assert_eq!(svg.matches("class=\"dot main bad\"").count(), 2);
    assert!(layout.strip.is_some());
    assert!(svg.contains("target ± 0.25 °"));
}

/// Both wheels share a chart. The strip compares each curve with the targets of its own wheel only. A target at other
/// poses than the curves has no deviations. The remarks have the tolerance of every target.
#[test]
fn each_wheel_has_its_own_targets() {
    let at = |value: f64, tolerance: f64, column: Option<&str>| Wanted::Values {
        points: vec![[-40.0, value], [40.0, value]],
        tolerance,
        column: column.map(str::to_owned),
    };
    let wanted = vec![
        at(1.0, 0.25, Some("y0")),
        at(-1.0, 0.5, Some("y1")),
        at(9.0, 0.5, None),
    ];
    let lines = vec![line(0, 0..9), line(1, 0..9)];
    let layout = chart(lines, wanted).layout(&[table(&[[1.25, 0.0], [-1.0, 0.0]])]);
    let found: Vec<_> = (layout.deviations.iter())
        .map(|of| (of.line, of.points.clone()))
        .collect();
    assert_eq!(
        found,
        [
            (0, vec![[-40.0, 1.0], [40.0, 1.0]]),
            (1, vec![[-40.0, 0.0], [40.0, 0.0]])
        ]
    );
    let svg = layout.element();
    assert_eq!(svg.matches("target ± 0.25 °").count(), 1);
    assert_eq!(svg.matches("target ± 0.5 °").count(), 1);
}

/// The data of an axis contain the power of ten that its labels leave out. So a script can write the value of a tick.
#[test]
fn labels_of_ticks_have_their_power_of_ten() {
    let quantity = Quantity::new("gain", "camber gain", "°/mm");
    for (values, power, title) in [
        ([0.0, 6e-4], -6, "camber gain [10⁻⁶ °/mm]"),
        ([0.0, 0.06], 0, "camber gain [°/mm]"),
    ] {
        let axis = AxisLayout::unit(&quantity, values.into_iter());
        assert_eq!((axis.power, axis.title.as_str()), (power, title));
        for (share, label) in &axis.ticks {
            let value = label.parse::<f64>().unwrap() * 10f64.powi(axis.power);
            let at = axis.low + share * (axis.high - axis.low);
            assert!((value - at).abs() < 1e-9 * axis.high, "{label}");
        }
    }
}

/// Ticks and curves use the same linear scale.
#[test]
fn ticks_and_curves_share_a_scale() {
    let layout = chart(vec![line(0, 0..9)], Vec::new()).layout(&[table(&[[0.0, 2.0]])]);
    let at = |axis: &AxisLayout, [from, to]: [f64; 2], value: f64| {
        from + (value - axis.low) / (axis.high - axis.low) * (to - from)
    };
    let [left, top, right, bottom] = layout.plot;
    for (place, label) in &layout.x.ticks {
        let value: f64 = label.replace('\u{2212}', "-").parse().unwrap();
        assert!(
            (place - at(&layout.x, [left, right], value)).abs() < 1e-9,
            "{label}"
        );
    }
    let end = layout.labels[0].end;
    assert!((end[0] - at(&layout.x, [left, right], 40.0)).abs() < 1e-9);
    assert!((end[1] - at(&layout.y, [bottom, top], 80.0)).abs() < 1e-9);
    let json = serde_json::to_value(&layout).unwrap();
    assert_eq!(json["lines"][0]["rows"].as_array().unwrap().len(), 9);
    assert_eq!(
        json["x"]["ticks"].as_array().unwrap().len(),
        layout.x.ticks.len()
    );
}

/// A gap in the data is a gap in the curve, and a cross marks its position.
#[test]
fn gaps_stay_gaps() {
    let mut table = table(&[[0.0, 1.0]]);
    table.columns[1][4] = None;
    let chart = Chart {
        failed: vec![0.0],
        ..chart(vec![line(0, 0..9)], Vec::new())
    };
    let svg = chart.layout(&[table]).element();
    assert_eq!(svg.matches("class=\"line main strong\"").count(), 2);
    assert_eq!(svg.matches("class=\"failed\"").count(), 1);
    assert!(svg.contains("not solved"));
}

/// If a title such as "rise by vertical force" is longer than its axis, the words after "by" are omitted. The other axis names this
/// load. The unit stays.
#[test]
fn a_long_title_keeps_its_unit() {
    let titled = |name: &str| {
        let chart = Chart {
            y: Quantity::new("column", name, "mm"),
            ..chart(vec![line(0, 0..9)], Vec::new())
        };
        chart.layout(&[table(&[[0.0, 1.0]])]).element()
    };
    assert!(
        titled("inboard displacement by lateral force").contains(">inboard displacement [mm]<")
    );
    assert!(titled("rise by vertical force").contains(">rise by vertical force [mm]<"));
    assert!(titled(&"many letters ".repeat(5)).contains(">[mm]<"));
}
