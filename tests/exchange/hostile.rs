//! Files as they should not be: a clear refusal or the right numbers.

use super::{Said, file, imported};
use hardpoint::exchange::{Page, Value, workbook};
use hardpoint::model::{FrameConvention, LengthUnit, Side};

const TABLE: &str = "\
name,x,y,z
LCA front,120,360,195
LCA rear,-260,350,205
lower ball joint,5,705,190
top mount,-35,575,850
strut lower,-11,623,370
tie rod inner,-110,330,243
tie rod outer,-130,690,240
wheel center,0,760,300
";

fn of_text(text: &str, said: &Said) -> Result<hardpoint::exchange::Imported, String> {
    let directory = tempfile::tempdir().unwrap();
    imported(
        &file(&directory, "points.csv", text.as_bytes()),
        "macpherson",
        said,
    )
}

fn refusal(text: &str, said: &Said) -> String {
    of_text(text, said).unwrap_err()
}

#[test]
fn what_was_guessed_and_assumed_is_said() {
    let read = of_text(TABLE, &Said::default()).unwrap();
    assert_eq!(
        (read.unit, read.side, read.frame),
        (LengthUnit::Millimetre, Side::Left, FrameConvention::Iso8855)
    );
    let said = read.notes.join("\n");
    for expected in [
        "\"LCA front\" is lower_arm_front",
        "unit: mm",
        "axes: iso8855, left wheel",
        "static_camber and static_toe are taken as 0",
        "[wheel] radius",
    ] {
        assert!(said.contains(expected), "{expected}: {said}");
    }
    let text = read.study("s", "points.csv").unwrap();
    assert!(text.contains("# \"LCA front\", line 2"), "{text}");
}

#[test]
fn other_units_and_axes_are_recognised_and_contradictions_refused() {
    let scaled = |x: f64, y: f64, z: f64| {
        let mut lines = TABLE.lines();
        let mut text = lines.next().unwrap().to_owned() + "\n";
        for line in lines {
            let mut cells = line.split(',');
            text += cells.next().unwrap();
            for factor in [x, y, z] {
                text += &format!(
                    ",{:?}",
                    factor * cells.next().unwrap().parse::<f64>().unwrap()
                );
            }
            text.push('\n');
        }
        text
    };
    let metres = of_text(&scaled(0.001, 0.001, 0.001), &Said::default()).unwrap();
    assert_eq!(metres.unit, LengthUnit::Metre);
    let inches = of_text(
        &scaled(-1.0 / 25.4, 1.0 / 25.4, 1.0 / 25.4),
        &Said::default(),
    )
    .unwrap();
    assert_eq!(
        (inches.unit, inches.frame, inches.side),
        (LengthUnit::Inch, FrameConvention::XRear, Side::Right)
    );
    let sae = of_text(&scaled(1.0, -1.0, -1.0), &Said::default()).unwrap();
    assert_eq!(
        (sae.frame, sae.side),
        (FrameConvention::SaeJ670, Side::Left)
    );
    let wrong = Said {
        side: Some(Side::Right),
        frame: Some(FrameConvention::Iso8855),
        ..Said::default()
    };
    let refused = refusal(TABLE, &wrong);
    assert!(
        refused.contains("not the right wheel in iso8855"),
        "{refused}"
    );
    assert!(refused.contains("--frame iso8855 --side left"), "{refused}");
    // Mirrored in height and length: no frame of ours.
    let refused = refusal(&scaled(-1.0, 1.0, -1.0), &Said::default());
    assert!(refused.contains("fits no frame"), "{refused}");
    let refused = refusal(&scaled(1e-6, 1e-6, 1e-6), &Said::default());
    assert!(refused.contains("say the unit with --unit"), "{refused}");
}

#[test]
fn missing_doubled_and_unreadable_points_are_named() {
    let without = TABLE.replace("top mount", "Dom");
    let refused = refusal(&without, &Said::default());
    assert!(
        refused.contains("strut_top (upper strut mount on the body)"),
        "{refused}"
    );
    assert!(refused.contains("left over: Dom"), "{refused}");
    let mut said = Said::default();
    said.names.insert("strut_top".to_owned(), "Dom".to_owned());
    assert!(of_text(&without, &said).is_ok());
    said.names.insert("strut_tip".to_owned(), "Dom".to_owned());
    assert!(refusal(&without, &said).contains("no hardpoint \"strut_tip\""));

    let doubled = format!("{TABLE}LBJ,5,704,190\n");
    let refused = refusal(&doubled, &Said::default());
    assert!(
        refused.contains("\"lower ball joint\" (line 4) and \"LBJ\" (line 10) both seem to be"),
        "{refused}"
    );
    assert!(of_text(&format!("{TABLE}LBJ,5,705,190\n"), &Said::default()).is_ok());

    let refused = refusal(&TABLE.replace("705", "n/a"), &Said::default());
    assert!(
        refused.contains("lower_ball_joint: line 4, column 3: expected a number, found \"n/a\""),
        "{refused}"
    );
    for (text, expected) in [
        ("", "empty"),
        ("a,b\nc,d\n", "no table of points"),
        ("\u{0}\u{1}", "no text"),
        ("x,y,z\n1,2,3\n", "no column with names"),
    ] {
        let refused = refusal(text, &Said::default());
        assert!(refused.contains(expected), "{refused}");
    }
}

#[test]
fn more_rows_than_points_can_be_are_refused() {
    let mut text = TABLE.to_owned();
    for n in 0..300_000 {
        text += &format!("p{n},1,2,3\n");
    }
    assert!(refusal(&text, &Said::default()).contains("no table of hardpoints"));
}

fn cells() -> Vec<Vec<Value>> {
    let cell = |text: &str| match text.parse() {
        Ok(number) => Value::Number(number),
        Err(_) => Value::Text(text.to_owned()),
    };
    TABLE
        .lines()
        .map(|line| line.split(',').map(cell).collect())
        .collect()
}

#[test]
fn sheets_are_chosen_by_name_or_by_their_points() {
    let directory = tempfile::tempdir().unwrap();
    let page = |name: &str, rows| Page {
        name: name.to_owned(),
        rows,
    };
    let notes = page("notes", vec![vec![Value::Text("made by hand".to_owned())]]);
    let one = file(
        &directory,
        "one.xlsx",
        &workbook(&[notes.clone(), page("front", cells())]),
    );
    let read = imported(&one, "macpherson", &Said::default()).unwrap();
    assert!(
        read.notes
            .iter()
            .any(|note| note.contains("sheet \"front\""))
    );
    let two = workbook(&[notes, page("front", cells()), page("rear", cells())]);
    let two = file(&directory, "two.xlsx", &two);
    let refused = imported(&two, "macpherson", &Said::default()).unwrap_err();
    assert!(
        refused.contains("\"front\", \"rear\": choose one with --sheet"),
        "{refused}"
    );
    let said = |sheet| Said {
        sheet: Some(sheet),
        ..Said::default()
    };
    assert!(imported(&two, "macpherson", &said("rear")).is_ok());
    assert!(
        imported(&two, "macpherson", &said("middle"))
            .unwrap_err()
            .contains("there are \"notes\"")
    );
    assert!(
        imported(&two, "macpherson", &said("notes"))
            .unwrap_err()
            .contains("no table of points")
    );
}

#[test]
fn other_files_are_told_from_tables() {
    let directory = tempfile::tempdir().unwrap();
    let refused = |bytes: &[u8]| {
        imported(
            &file(&directory, "points", bytes),
            "macpherson",
            &Said::default(),
        )
        .unwrap_err()
    };
    assert!(refused(&[0xd0, 0xcf, 0x11, 0xe0, 0xa1]).contains("old or an encrypted workbook"));
    assert!(refused(b"PK\x03\x04 and nothing else").contains("damaged"));
    // UTF-16 with a mark, as spreadsheets save "Unicode text".
    let tabs = TABLE.replace(',', "\t");
    let wide = tabs.encode_utf16().flat_map(u16::to_le_bytes);
    let bytes: Vec<u8> = [0xff, 0xfe].into_iter().chain(wide).collect();
    assert!(
        imported(
            &file(&directory, "wide.txt", &bytes),
            "macpherson",
            &Said::default()
        )
        .is_ok()
    );
}
