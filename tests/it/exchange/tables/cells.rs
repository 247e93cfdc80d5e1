//! Tests of the cells of a table: units, decimal commas, meaningless words and huge texts.

use super::{FRONT, has_points, of, rows};
use crate::exchange::Said;
use hardpoint::model::LengthUnit;

#[test]
fn cells_that_mean_nothing_are_refused_with_their_place() {
    let table = |header: &str, cell: &str| {
        format!(
            "{header},name,x,y,z\n{}",
            rows(&FRONT, |name| format!("{cell},{name}"))
        )
    };
    for (header, cell, expected) in [
        ("frame", "iso", "line 2, column 1: the frame is \"iso\""),
        (
            "side",
            "port",
            "line 2, column 1: the wheel or axle is \"port\"",
        ),
        (
            "corner",
            "F1",
            "line 2, column 1: the wheel or axle is \"F1\"",
        ),
        ("frame", "8855", "line 2, column 1: the frame is"),
    ] {
        let refused = of("points.csv", &table(header, cell), &Said::default()).unwrap_err();
        assert!(refused.contains(expected), "{refused}");
    }
    let node = "{\"frame\": \"nautical\", \"LBJ\": [1, 2, 3]}";
    assert!(
        of("points.json", node, &Said::default())
            .unwrap_err()
            .contains("the frame is \"nautical\"")
    );
}

#[test]
fn inch_marks_and_decimal_commas_are_read() {
    let inches = FRONT.map(|(name, p)| (name, p.map(|x| (x / 25.4 * 1000.0).round() / 1000.0)));
    let marked: String = inches
        .iter()
        .map(|(name, [x, y, z])| format!("{name},{x}\",{y}\",{z}\"\n"))
        .collect();
    let read = of(
        "points.csv",
        &format!("name,x,y,z\n{marked}"),
        &Said::default(),
    )
    .unwrap();
    assert_eq!(read.unit, LengthUnit::Inch);
    has_points(&read, &inches);
    let mixed = format!("name,x,y,z\n{marked}").replacen("\",", ",", 1);
    assert!(
        of("points.csv", &mixed, &Said::default())
            .unwrap_err()
            .contains("marked as inches")
    );
    let commas: String = inches
        .iter()
        .map(|(name, p)| {
            let [x, y, z] = p.map(|x| x.to_string().replace('.', ","));
            format!("{name};{x};{y};{z}\n")
        })
        .collect();
    has_points(
        &of(
            "points.csv",
            &format!("name;x;y;z\n{commas}"),
            &Said::default(),
        )
        .unwrap(),
        &inches,
    );
}

/// A cell of several megabytes is neither a name nor a number. The import skips this cell and reads the rest.
#[test]
fn a_huge_cell_is_passed_over() {
    let huge = "lower arm ".repeat(500_000);
    let text = format!("name,x,y,z,remarks\n{}", rows(&FRONT, str::to_owned));
    let remark = text.replacen("124\n", &format!("124,{huge}\n"), 1);
    has_points(
        &of("points.csv", &remark, &Said::default()).unwrap(),
        &FRONT,
    );
    let row = format!("{text}{huge},1,2,3,\n");
    has_points(&of("points.csv", &row, &Said::default()).unwrap(), &FRONT);
    let number = text.replacen("124\n", &format!("{}\n", "1".repeat(5_000_000)), 1);
    let refused = of("points.csv", &number, &Said::default()).unwrap_err();
    assert!(
        refused.contains("a text of 5000000 bytes") && refused.len() < 300,
        "{}",
        refused.len()
    );
}
