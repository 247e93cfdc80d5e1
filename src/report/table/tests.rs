//! Tests of tables.

use super::{Cell, Column, Format, Table, Tables};
use serde_json::Value;

fn table() -> Table {
    let readers = Column::for_readers("range");
    let programs = ["range min", "range max"].map(Column::for_programs);
    let columns = [Column::from("output"), "min".into(), readers].into_iter();
    let mut table = Table::with_columns(columns.chain(programs));
    let row = |name: &str, min: f64, [low, high]: [f64; 2]| -> [Cell; 5] {
        let range = Cell::from(format!("{low} .. {high}"));
        [name.into(), min.into(), range, low.into(), high.into()]
    };
    table.push(row("camber_deg", -1.5, [-5.0, 5.0]));
    table.push(row("toe_deg", 1.0 / 3.0, [0.25, 10.0]));
    table
}

#[test]
fn a_reader_sees_digits_that_matter_and_a_program_gets_the_number() {
    let mut tables = Tables::default();
    tables.push("outputs", table());
    assert_eq!(
        tables.render(Format::Text, 80),
        "  output           min       range\n  camber_deg      -1.5     -5 .. 5\n  toe_deg     0.333333  0.25 .. 10\n"
    );
    assert_eq!(
        tables.render(Format::Csv, 80),
        "table,output,min,range_min,range_max\noutputs,camber_deg,-1.5,-5.0,5.0\n\
         outputs,toe_deg,0.3333333333333333,0.25,10.0\n"
    );
    let json: Value = serde_json::from_str(&tables.render(Format::Json, 80)).unwrap();
    assert_eq!(json["outputs"][1]["min"].as_f64(), Some(1.0 / 3.0));
    assert_eq!(json["outputs"][0]["range_max"], 5.0);
    assert_eq!(json["outputs"][1]["output"], "toe_deg");
}

#[test]
fn a_table_without_rows_is_no_line_that_nobody_can_name() {
    let mut tables = Tables::default();
    tables.push("none", Table::new(["study"]));
    assert_eq!(tables.render(Format::Csv, 80), "table,study\n");
    tables.push("outputs", table());
    assert!(tables.render(Format::Csv, 80).starts_with("table,output,"));
    assert!(tables.render(Format::Json, 80).contains("\"none\": []"));
}

#[test]
fn what_says_what_a_row_is_of_stands_in_every_piece() {
    let names = ["adjustment", "per", "camber_deg", "toe_deg", "caster_deg"];
    let mut table = Table::new(names).keyed(2);
    for per in ["mm", "turn"] {
        let head = [Cell::from("lower arm, front stud"), per.into()];
        table.push_row(head.into_iter().chain([0.123456; 3].map(Cell::from)));
    }
    let text = table.text(46);
    let pieces: Vec<&str> = text.split("\n\n").collect();
    assert!(pieces.len() > 1, "{text}");
    for piece in pieces {
        let [header, mm, turn] = [0, 1, 2].map(|line| piece.lines().nth(line).unwrap());
        assert!(header.starts_with("  adjustment"), "{text}");
        assert!(
            header.contains(" per ") && mm.contains(" mm ") && turn.contains(" turn "),
            "{text}"
        );
    }
    // If the space is too small, only the first column is repeated.
    let names = [Cell::from("n".repeat(14)), "m".repeat(14).into()];
    let mut table = Table::new(["a", "b", "c", "d"]).keyed(2);
    table.push_row(names.into_iter().chain([-0.123456e-10; 2].map(Cell::from)));
    let text = table.text(40);
    assert!(
        text.lines().all(|line| line.chars().count() <= 40),
        "{text}"
    );
}

/// Output to a pipe never breaks a name, for any number of columns.
#[test]
fn names_are_not_broken() {
    let columns = [
        "camber_gain_deg_per_mm",
        "roll_centre_height_mm",
        "half_track_change_mm",
    ];
    let sides = ["left", "right"];
    let all = columns
        .iter()
        .flat_map(|c| sides.map(|side| format!("{c}_{side}")));
    let all: Vec<String> = all.collect();
    let header = ["hardpoint".to_owned()].into_iter().chain(all.clone());
    let mut table = Table::with_columns(header.map(Column::from));
    for name in ["upper_front_link_outer", "lower_rear_link_inner"] {
        let numbers = (0..6).map(|k| Cell::from(0.123456 * f64::from(k)));
        table.push_row([Cell::from(name)].into_iter().chain(numbers));
    }
    let text = table.text(100);
    let longest = text.lines().map(|line| line.chars().count()).max();
    assert!(longest <= Some(100), "{text}");
    for name in all
        .iter()
        .map(String::as_str)
        .chain(["upper_front_link_outer"])
    {
        assert!(text.contains(name), "{name}:\n{text}");
    }
    assert!(text.contains("\n\n"), "{text}");
}

#[test]
fn text_that_looks_like_a_number_stays_text() {
    let mut table = Table::new(["study", "misfit"]);
    table.push([Cell::from("1e5"), Cell::from(f64::NAN)]);
    assert_eq!(table.json()[0]["study"], "1e5");
    assert!(table.json()[0]["misfit"].is_null());
    assert_eq!(table.csv(None), "study,misfit\n1e5,\n");
}

#[test]
fn lines_are_no_longer_than_the_width() {
    let mut wide = Table::new(["effect", "because of", "what", "cost"]);
    let because = "motion_ratio, spring_length, anti_roll_bar_angle (line 51)";
    wide.push([
        Cell::from("rocker"),
        because.into(),
        "turned by the pushrod".into(),
        0.25.into(),
    ]);
    let columns = (0..20).map(|k| format!("upper_front_link_inner_{k}_mm"));
    let mut long = Table::with_columns(["design".to_owned()].into_iter().chain(columns));
    long.push_row((0..21).map(|k| Cell::from(f64::from(k) / 7.0)));
    for table in [&wide, &long] {
        for width in [40, 60, 80, 100, 200] {
            let text = table.text(width);
            let longest = text.lines().map(|l| l.chars().count()).max().unwrap();
            assert!(longest <= width, "{longest} of {width}:\n{text}");
            // No text is lost.
            let letters = |text: &str| text.chars().filter(|c| !c.is_whitespace()).count();
            assert!(letters(&text) >= letters(&table.text(10_000)), "{text}");
        }
    }
    assert!(wide.text(60).lines().count() <= 1 + 4, "{}", wide.text(60));
}

/// A compared run may have the name of a column.
#[test]
fn columns_of_equal_names_stay_apart() {
    let mut table = Table::new(["changed", "unit", "unit", "unit"]);
    let [first, second] = [30.0, 35.0].map(Cell::from);
    table.push([
        Cell::from("front.spring.rate"),
        "N_per_mm".into(),
        first,
        second,
    ]);
    let row = &table.json()[0];
    assert_eq!(row["unit"], "N_per_mm");
    assert_eq!(row["unit_2"], 30.0);
    assert_eq!(row["unit_3"], 35.0);
    assert!(table.csv(None).starts_with("changed,unit,unit_2,unit_3\n"));
}
