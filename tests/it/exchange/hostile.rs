//! Tests of faulty files: the import refuses them clearly or reads the correct numbers.

use super::{Said, file, imported};
use hardpoint::exchange::{Page, Value, workbook};
use hardpoint::model::{AxlePosition, FrameConvention, LengthUnit, Side};

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
    let said = read.notes.texts().collect::<Vec<_>>().join("\n");
    assert_eq!(read.hardpoints[0].called, "LCA front");
    for expected in [
        "unit: mm",
        "axes: iso8855, left wheel",
        "static_camber and static_toe are assumed to be 0",
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
    // With these signs, the points fit a right wheel, but also a left wheel in left-handed axes. So the import refuses
    // the file.
    let turned = scaled(-1.0 / 25.4, 1.0 / 25.4, 1.0 / 25.4);
    let refused = refusal(&turned, &Said::default());
    assert!(
        refused.contains("--side right or --axes rearward,left,up"),
        "{refused}"
    );
    let right = Said {
        side: Some(Side::Right),
        ..Said::default()
    };
    let inches = of_text(&turned, &right).unwrap();
    assert_eq!(
        (inches.unit, inches.frame, inches.side),
        (LengthUnit::Inch, FrameConvention::XRear, Side::Right)
    );
    let sae = of_text(&scaled(1.0, -1.0, -1.0), &Said::default()).unwrap();
    assert_eq!(
        (sae.frame, sae.side),
        (FrameConvention::SaeJ670, Side::Left)
    );
    // The title names the wheel, but in these axes the points are on the other side.
    let sae = Said {
        frame: Some(FrameConvention::SaeJ670),
        ..Said::default()
    };
    let refused = refusal(&TABLE.replace("name", "left wheel\nname"), &sae);
    assert!(
        refused.contains("in sae_j670 this is not the left wheel"),
        "{refused}"
    );
    assert!(refused.contains("--side right"), "{refused}");
    // In this file, x and z have opposite signs (half a turn about y). No axis convention of studies has these axes, so
    // the import changes the signs of the points.
    let turned = of_text(&scaled(-1.0, 1.0, -1.0), &Said::default()).unwrap();
    assert_eq!(
        (turned.frame, turned.side),
        (FrameConvention::Iso8855, Side::Left)
    );
    assert_eq!(turned.hardpoints[0].position, [120.0, 360.0, 195.0]);
    let refused = refusal(&scaled(1e-6, 1e-6, 1e-6), &Said::default());
    assert!(refused.contains("State the unit with --unit"), "{refused}");
}

#[test]
fn missing_doubled_and_unreadable_points_are_named() {
    let without = TABLE.replace("top mount", "Dom");
    let refused = refusal(&without, &Said::default());
    assert!(
        refused.contains("strut_top (upper strut mount on the body)"),
        "{refused}"
    );
    assert!(refused.contains("unused points: Dom"), "{refused}");
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
        ("\u{0}\u{1}", "not a text"),
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
    assert!(refusal(&text, &Said::default()).contains("not a table of hardpoints"));
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
            .texts()
            .any(|note| note.contains("sheet \"front\""))
    );
    let two = workbook(&[notes, page("front", cells()), page("rear", cells())]);
    let two = file(&directory, "two.xlsx", &two);
    let refused = imported(&two, "macpherson", &Said::default()).unwrap_err();
    assert!(
        refused.ends_with("has points in 2 sheets: give --sheet front or --sheet rear"),
        "{refused}"
    );
    let mut broken = cells();
    broken[1][1] = Value::Text("about 120".to_owned());
    let mixed = workbook(&[page("it's front", cells()), page("old", broken)]);
    let mixed = file(&directory, "mixed.xlsx", &mixed);
    let read = imported(&mixed, "macpherson", &Said::default());
    // The import first selects a sheet, and then reads its coordinates. So both sheets remain candidates, although one
    // has an invalid coordinate.
    let refused = read.unwrap_err();
    assert!(
        refused.contains("give --sheet 'it'\\''s front' or --sheet old"),
        "{refused}"
    );
    let said = |sheet| Said {
        sheet: Some(sheet),
        ..Said::default()
    };
    assert!(imported(&two, "macpherson", &said("rear")).is_ok());
    // The only sheet with points is for the other axle.
    let rear = Said {
        axle: Some(AxlePosition::Rear),
        ..Said::default()
    };
    let refused = imported(&one, "macpherson", &rear).unwrap_err();
    assert!(
        refused.contains("\"front\", which is for the front axle"),
        "{refused}"
    );
    assert!(imported(&two, "macpherson", &rear).is_ok());
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
    for (name, bytes) in [
        ("c.dxf", "999\na comment\n"),
        ("points", "  0\r\nSECTION\r\n  2\r\nHEADER\r\n"),
        ("points", "ISO-10303-21;\nHEADER;\n"),
        ("part.SLDPRT", "\0"),
    ] {
        let path = file(&directory, name, bytes.as_bytes());
        let said = imported(&path, "macpherson", &Said::default()).unwrap_err();
        assert!(
            said.contains("reads no CAD files") && said.contains("--map"),
            "{said}"
        );
    }
    // UTF-16 text with a byte order mark, as spreadsheets save "Unicode text".
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

/// The import names the cause of a problem, not its consequences. It refuses a file of rFactor and names this program.
/// It reports unknown names instead of an unknown unit.
#[test]
fn causes_are_named_and_not_their_consequences() {
    let bars = "// suspension\n[BODY]\nname=fl_spindle mass=(8.0)\npos=(0.67,0.0,-1.65)\n[BAR]\nname=fl_fore_upper\n";
    assert!(refusal(bars, &Said::default()).contains("rFactor"));
    let unknown = "name,x,y,z\nWC,0,760,300\nBolt A,120,360,195\n";
    let said = refusal(unknown, &Said::default());
    assert!(
        said.contains("missing for macpherson") && said.contains("lower_arm_front"),
        "{said}"
    );
    // A word in brackets looks like the start of JSON.
    let ini = refusal("[POINTS]\nLCA front = 120\n", &Said::default());
    assert!(ini.contains("no table of points"), "{ini}");
}

/// The import reads point names of OptimumKinematics that are nested in other keys of a script. It also reads
/// abbreviations of wishbones and track rods.
#[test]
fn keys_of_scripts_hide_no_names() {
    let directory = tempfile::tempdir().unwrap();
    let optimum = r#"{"HP_FRONT": {"CHAS_LowFor": [160, 160, 110], "CHAS_LowAft": [-160, 160, 130],
        "UPRI_LowPnt": [2, 583, 123], "CHAS_UppFor": [120, 245, 267], "CHAS_UppAft": [-120, 245, 258],
        "UPRI_UppPnt": [-11, 556, 280], "CHAS_TiePnt": [50, 145, 144], "UPRI_TiePnt": [70, 565, 150],
        "WC": [0, 613, 203]}}"#;
    let nested = r#"{"hardpoints_front": {"lwb": {"front": [177, 252, 125], "rear": [-175, 282, 126], "outer": [9, 561, 141]},
        "uwb": {"front": [178, 251, 282], "rear": [-178, 281, 265], "outer": [-16, 545, 324]},
        "tr": {"inner": [76, 230, 201], "outer": [76, 552, 241]}, "wheel": {"centre": [0, 600, 232]}}}"#;
    for (text, outer) in [
        (optimum, [2.0, 583.0, 123.0]),
        (nested, [9.0, 561.0, 141.0]),
    ] {
        let path = file(&directory, "points.json", text.as_bytes());
        let read = imported(&path, "double_wishbone", &Said::default()).unwrap();
        let joint = read
            .hardpoints
            .iter()
            .find(|h| h.name == "lower_ball_joint");
        assert_eq!(joint.unwrap().position, outer);
        assert_eq!(read.hardpoints.len(), 9, "{:?}", read.left_out);
        let axle = read
            .notes
            .texts()
            .find(|note| note.starts_with("axle: front"));
        assert!(axle.is_some(), "{:?}", read.notes);
    }
}

/// A name map in JSON works like a table, and its errors are as clear as those of a table.
#[test]
fn maps_in_json_are_tables_too() {
    let rows = TABLE.lines().skip(1);
    let entries: Vec<String> = rows
        .map(|row| {
            let (name, numbers) = row.split_once(',').unwrap();
            format!("{name:?}: [{numbers}]")
        })
        .collect();
    let of_map = |text: &str| of_text(text, &Said::default());
    let text = format!(
        "{{\"unit\": \"mm\", \"points\": {{{}}}}}",
        entries.join(", ")
    );
    let read = of_map(&text).unwrap();
    let wanted = of_text(TABLE, &Said::default()).unwrap();
    let points = |imported: &hardpoint::exchange::Imported| {
        let points = imported.hardpoints.iter();
        points.map(|h| (h.name, h.position)).collect::<Vec<_>>()
    };
    assert_eq!(points(&read), points(&wanted));

    let twice = text.replace("}}", ", \"lower wishbone front\": [120, 361, 195]}}");
    let said = of_map(&twice).unwrap_err();
    assert!(said.contains("lower wishbone front"), "{said}");
    let missing = text.replace("\"tie rod inner\": [-110,330,243], ", "");
    assert!(of_map(&missing).unwrap_err().contains("tie_rod_inner"));
    for (wrong, phrase) in [("{\"a\": [1, 2", "not JSON"), ("{}", "no table of points")] {
        let said = of_map(wrong).unwrap_err();
        assert!(said.contains(phrase), "{said}");
    }
}

/// The import reads the layout of Project Chrono's suspensions: parts with their locations, in metres.
#[test]
fn suspensions_of_chrono_are_read() {
    let text = r#"{
      "Name": "made up", "Type": "Suspension", "Template": "DoubleWishbone",
      "Camber Angle (deg)": -0.5, "Toe Angle (deg)": 0.25,
      "Spindle": { "Mass": 14, "COM": [0.0, 0.75, 0.3], "Inertia": [0.04, 0.07, 0.04], "Radius": 0.15 },
      "Upright": { "Mass": 20, "COM": [0.0, 0.7, 0.31], "Moments of Inertia": [0.1, 0.1, 0.1] },
      "Upper Control Arm": { "Location Chassis Front": [0.1, 0.42, 0.5], "Location Chassis Back": [-0.2, 0.43, 0.49],
        "Location Upright": [-0.02, 0.66, 0.52] },
      "Lower Control Arm": { "Location Chassis Front": [0.15, 0.35, 0.2], "Location Chassis Back": [-0.25, 0.36, 0.19],
        "Location Upright": [0.01, 0.71, 0.18] },
      "Tierod": { "Location Chassis": [-0.12, 0.38, 0.24], "Location Upright": [-0.13, 0.69, 0.24] },
      "Shock": { "Location Chassis": [0.0, 0.5, 0.6], "Location Arm": [0.0, 0.6, 0.25] }
    }"#;
    let directory = tempfile::tempdir().unwrap();
    let path = file(&directory, "suspension.json", text.as_bytes());
    let read = imported(&path, "double_wishbone", &Said::default()).unwrap();
    assert_eq!(read.unit, LengthUnit::Metre);
    assert_eq!(
        (read.static_camber, read.static_toe),
        (Some(-0.5), Some(0.25))
    );
    let at = |name: &str| {
        let found = read.hardpoints.iter().find(|h| h.name == name);
        found.unwrap_or_else(|| panic!("{name}")).position
    };
    assert_eq!(at("wheel_centre"), [0.0, 0.75, 0.3]);
    assert_eq!(at("upper_arm_rear"), [-0.2, 0.43, 0.49]);
    assert_eq!(at("tie_rod_inner"), [-0.12, 0.38, 0.24]);
    let study = read.study("made up", "suspension.json").unwrap();
    let study = hardpoint::study::Study::from_text("s.toml", &study, directory.path()).unwrap();
    let plan = hardpoint::plan::Plan::of(study.one_wheel().unwrap());
    let curves = hardpoint::curves::curves(study.wheel(), &plan).unwrap();
    assert!(curves.are_complete());
}

/// The import reads geometry files as the documentation of Suspension Explorer describes them. They have hub face and
/// wheel offset instead of the wheel centre, tyre size instead of a radius, and both wheels under their sides.
#[test]
fn geometry_files_of_suspension_explorer_are_read() {
    let corner = |sign: f64| {
        let point = |name: &str, [x, y, z]: [f64; 3]| {
            format!("    {name}: {{x: {x}, y: {}, z: {z}}}\n", sign * y)
        };
        [
            point("lower_wishbone_inboard_front", [210.0, 310.0, 140.0]),
            point("lower_wishbone_inboard_rear", [-190.0, 320.0, 145.0]),
            point("lower_wishbone_outboard", [5.0, 705.0, 135.0]),
            point("upper_wishbone_inboard_front", [160.0, 340.0, 330.0]),
            point("upper_wishbone_inboard_rear", [-170.0, 345.0, 325.0]),
            point("upper_wishbone_outboard", [-10.0, 665.0, 375.0]),
            point("trackrod_inboard", [-85.0, 300.0, 170.0]),
            point("trackrod_outboard", [-95.0, 690.0, 175.0]),
            point("axle_inboard", [0.0, 600.0, 260.0]),
            point("axle_outboard", [0.0, 780.0, 256.0]),
        ]
        .concat()
    };
    let text = format!(
        "type: double_wishbone\nscope: axle\nname: made up\nunits: millimeters\n\
         vehicle_config:\n  cg_position: {{x: 1100, y: 0, z: 300}}\n  wheelbase: 1600\n\
         axle_config:\n  steering: {{type: rack}}\n  wheel:\n    offset: 30 # inboard\n    tire:\n\
         \x20     aspect_ratio: 0.4\n      section_width: 180\n      rim_diameter: 13\n\
         hardpoints:\n  left:\n{}  right:\n{}",
        corner(1.0),
        corner(-1.0)
    );
    let directory = tempfile::tempdir().unwrap();
    for (side, sign) in [(Side::Left, 1.0), (Side::Right, -1.0)] {
        let said = Said {
            side: Some(side),
            ..Said::default()
        };
        let path = file(&directory, "geometry.yaml", text.as_bytes());
        let read = imported(&path, "double_wishbone", &said).unwrap();
        assert_eq!((read.side, read.unit), (side, LengthUnit::Millimetre));
        let at = |name: &str| {
            let found = read.hardpoints.iter().find(|h| h.name == name);
            found.unwrap_or_else(|| panic!("{name}")).position
        };
        assert_eq!(at("tie_rod_outer"), [-95.0, sign * 690.0, 175.0]);
        assert_eq!(at("spindle_inner"), [0.0, sign * 600.0, 260.0]);
        // The wheel centre lies on the spin axis, 30 mm inboard of `axle_outboard`. The distance from `axle_inboard` to
        // `axle_outboard` is the square root of 180^2 + 4^2.
        let length = 180.0_f64.hypot(4.0);
        let wanted = [
            0.0,
            sign * (780.0 - 30.0 * 180.0 / length),
            256.0 + 120.0 / length,
        ];
        for (found, wanted) in at("wheel_centre").into_iter().zip(wanted) {
            assert!((found - wanted).abs() < 1e-12 * 780.0, "{found} {wanted}");
        }
        assert_eq!(read.wheel_radius, Some(0.5 * 25.4 * 13.0 + 0.4 * 180.0));
        let study = read.study("made up", "geometry.yaml").unwrap();
        let study = hardpoint::study::Study::from_text("s.toml", &study, directory.path()).unwrap();
        let plan = hardpoint::plan::Plan::of(study.one_wheel().unwrap());
        let curves = hardpoint::curves::curves(study.wheel(), &plan).unwrap();
        assert!(curves.are_complete());
    }
}
