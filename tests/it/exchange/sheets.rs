//! Tests of tables that people write by hand: headers with spaces, names of bodies, values of the wheel, missing units, and
//! points with an error.

use super::{Said, file, imported};
use hardpoint::exchange::{FileUnit, Imported, Notes};
use hardpoint::model::LengthUnit;

/// Double wishbone with pushrod in millimetres: names and coordinates.
const POINTS: [(&str, [f64; 3]); 15] = [
    ("UCA front inner", [125.0, 255.0, 285.0]),
    ("UCA rear inner", [-135.0, 260.0, 275.0]),
    ("UBJ", [-6.0, 535.0, 322.0]),
    ("LCA front inner", [130.0, 190.0, 118.0]),
    ("LCA rear inner", [-150.0, 195.0, 112.0]),
    ("LBJ", [6.0, 560.0, 128.0]),
    ("Tie rod inner", [75.0, 215.0, 150.0]),
    ("Tie rod outer", [68.0, 552.0, 160.0]),
    ("Wheel centre", [0.0, 610.0, 228.0]),
    ("Pushrod lower (on LCA)", [0.0, 525.0, 145.0]),
    ("Pushrod upper", [0.0, 290.0, 400.0]),
    ("Rocker pivot front", [15.0, 245.0, 375.0]),
    ("Rocker pivot rear", [-15.0, 245.0, 375.0]),
    ("Damper to rocker", [0.0, 235.0, 425.0]),
    ("Damper to chassis", [0.0, 50.0, 410.0]),
];

/// Rows of the points. `per` is the length of one millimetre in the unit of the rows. `between` is the text between two
/// cells.
fn rows(per: f64, between: &str) -> String {
    let row = |(name, at): &(&str, [f64; 3])| {
        let cells = at.map(|x| format!("{between}{:.4}", x * per));
        format!("{name}{}\n", cells.concat())
    };
    POINTS.iter().map(row).collect()
}

/// The table with one name or coordinate replaced.
fn changed(name: &str, new_name: &str, at: [f64; 3]) -> String {
    let row = |(own, place): &(&str, [f64; 3])| {
        let (own, place) = if *own == name {
            (new_name, at)
        } else {
            (*own, *place)
        };
        format!("{own};{};{};{}\n", place[0], place[1], place[2])
    };
    let rows: String = POINTS.iter().map(row).collect();
    format!("Point;x [mm];y [mm];z [mm]\n{rows}")
}

fn read_as(text: &str, said: &Said) -> Result<Imported, String> {
    let directory = tempfile::tempdir().unwrap();
    let path = file(&directory, "points.txt", text.as_bytes());
    imported(&path, "double_wishbone", said)
}

fn read(text: &str) -> Result<Imported, String> {
    read_as(text, &Said::default())
}

fn place(read: &Imported, name: &str) -> [f64; 3] {
    let mut points = read.hardpoints.iter();
    points.find(|point| point.name == name).unwrap().position
}

/// A header whose cells are separated by spaces states the unit like any other header.
#[test]
fn a_header_with_spaces_states_its_unit() {
    for (head, between) in [
        ("Point   x [cm]   y [cm]   z [cm]", "   "),
        ("Point x [cm] y [cm] z [cm]", " "),
        ("Point name x (cm) y (cm) z up (cm)", "  "),
    ] {
        let found = read(&format!("{head}\n{}", rows(0.1, between))).unwrap();
        assert_eq!(found.unit, LengthUnit::Millimetre, "{head}");
        assert_eq!(
            place(&found, "upper_ball_joint"),
            [-6.0, 535.0, 322.0],
            "{head}"
        );
    }
    for head in [
        "Point x [furlong] y [furlong] z [furlong]",
        "Point x [mm] y [furlong] z [mm]",
    ] {
        let refused = read(&format!("{head}\n{}", rows(0.1, " "))).unwrap_err();
        assert!(
            refused.contains("line 1") && refused.contains("furlong"),
            "{refused}"
        );
    }
}

/// If a table has no unit and may be in centimetres, the import does not read inches. It refuses the table, and
/// `--unit` accepts both units.
#[test]
fn inches_and_centimetres_are_not_confused() {
    let table = |per: f64| format!("Point,x,y,z\n{}", rows(per, ","));
    let refused = read(&table(0.1)).unwrap_err();
    for word in ["--unit in", "--unit cm", "states no unit"] {
        assert!(refused.contains(word), "{word}: {refused}");
    }
    let said = Said {
        unit: FileUnit::named("cm"),
        ..Said::default()
    };
    let found = read_as(&table(0.1), &said).unwrap();
    assert_eq!(place(&found, "lower_ball_joint"), [6.0, 560.0, 128.0]);
    // In centimetres, this suspension would have a size of only 0.2 m. So the import reads inches.
    let inches = read(&table(1.0 / 25.4)).unwrap();
    assert_eq!(inches.unit, LengthUnit::Inch);
    let note = inches.notes.texts().find(|note| note.starts_with("unit:"));
    assert!(note.unwrap().contains("inches"), "{:?}", inches.notes);
    let millimetres = read(&table(1.0)).unwrap();
    assert_eq!(millimetres.unit, LengthUnit::Millimetre);
}

/// Names of the body after the name of a pushrod do not hide the pushrod.
#[test]
fn bodies_of_rods_are_read_from_their_names() {
    for (body, upper) in [
        ("(on UCA)", true),
        ("(on upper arm)", true),
        ("(upper wishbone)", true),
        ("on upper wishbone", true),
        ("(on LCA)", false),
        ("(lower wishbone)", false),
    ] {
        let name = format!("Pushrod lower {body}");
        let z = if upper { 315.0 } else { 145.0 };
        let text = changed("Pushrod lower (on LCA)", &name, [0.0, 520.0, z]);
        let study = read(&text).unwrap().study("s", "there").unwrap();
        assert!(study.contains("rocker_pivot_front"), "{body}");
        assert!(study.contains("spring_upper"), "{body}");
        let says_upper = study.contains("pushrod_outer = \"upper_arm\"");
        assert_eq!(says_upper, upper, "{body}\n{study}");
    }
}

/// If one end of a drop link names its body, the other end is on the bar. Otherwise the import asks for the body.
#[test]
fn ends_of_a_drop_link_are_read_from_the_body_of_one_end() {
    let bar = "ARB pivot inner;0;50;300\nARB pivot outer;0;265;300\n";
    let base = changed("", "", [0.0; 3]);
    let ends = |one: &str, other: &str| format!("{base}{one};0;270;390\n{other};60;265;300\n{bar}");
    let found = read(&ends("Droplink lower (on rocker)", "Droplink upper")).unwrap();
    assert_eq!(place(&found, "drop_link_outer"), [0.0, 270.0, 390.0]);
    assert_eq!(place(&found, "drop_link_inner"), [60.0, 265.0, 300.0]);
    let found = read(&ends("Drop link upper (rocker)", "Drop link lower")).unwrap();
    assert_eq!(place(&found, "drop_link_outer"), [0.0, 270.0, 390.0]);
    assert_eq!(place(&found, "drop_link_inner"), [60.0, 265.0, 300.0]);
    let found = read(&ends("Drop link upper", "Drop link lower")).unwrap();
    let said = found.left_out.join("\n");
    assert!(
        said.contains("on the bar") && said.contains("--map"),
        "{said}"
    );
}

/// The import writes values of the wheel to the study if the study has a key for them.
#[test]
fn values_of_the_wheel_are_in_the_study() {
    let base = changed("", "", [0.0; 3]);
    let values = "Static camber;-1,5\nStatic toe (deg, toe out positive);0,10\nLoaded radius;228,0\nTyre width;190,5\n\
                  Rim diameter;330,2\nCG height;290,0\n";
    let german = base.replace(";125;", ";125,0;") + values;
    let study = read(&german).unwrap().study("s", "there").unwrap();
    for line in [
        "static_camber = -1.5",
        "static_toe = -0.1",
        "tyre_width = 190.5",
        "rim_diameter = 330.2",
        "cg_height = 290.0",
    ] {
        assert!(study.contains(line), "{line}\n{study}");
    }
    let study = read(&format!("{base}tyre_width;190\n"))
        .unwrap()
        .study("s", "there")
        .unwrap();
    assert!(study.contains("tyre_width = 190.0"), "{study}");
}

/// A suspension that cannot reach the usual travel has a note with the travel and its reason. Other suspensions have none.
#[test]
fn a_shortened_travel_is_reported_with_its_reason() {
    // The pushrod is in line with its lever after a few millimetres.
    let text = changed("Pushrod upper", "Pushrod upper", [0.0, 240.0, 425.0]);
    let found = read(&text).unwrap();
    let (study, notes) = found.study_and_notes("s", "there").unwrap();
    assert!(!study.contains("from = -80.0"), "{study}");
    let note = notes.texts().last().unwrap();
    for words in [
        "instead of the usual 80 mm",
        "pushrod",
        "travel 21 mm",
        "wrong",
    ] {
        assert!(note.contains(words), "{note}");
    }
    let without_rocker: String = changed("", "", [0.0; 3])
        .lines()
        .filter(|line| {
            !["Push", "Rock", "Damp"]
                .iter()
                .any(|own| line.starts_with(own))
        })
        .map(|line| format!("{line}\n"))
        .collect();
    let (_, notes) = read(&without_rocker)
        .unwrap()
        .study_and_notes("s", "there")
        .unwrap();
    assert_eq!(notes, Notes::default());
}

/// The import names a coordinate with a wrong decimal place, even if the suspension with this point moves.
#[test]
fn a_wrong_decimal_place_is_named_by_the_import() {
    let text = "SAE J670, dimensions in mm\nPoint;X;Y;Z\nLCA front;180;-352;-205\nLCA rear;-165;-360;-212\nLBJ;12;-715;-188\n\
                UCA front;95;-455;-560\nUCA rear;-110;-462;-548\nUBJ;-22;-66.8;-580\nTie rod inner;-118;-370;-252\n\
                Tie rod outer;-128;-700;-243\nWheel centre;0;-775;-322\n";
    let notes = |text: &str| {
        let study = read(text).unwrap().study_and_notes("s", "there");
        study.unwrap().1
    };
    let named = "upper_ball_joint seems to have y = -668 instead of -66.8 (a wrong decimal place)";
    let found = notes(text);
    assert!(found.doubts().next().unwrap().contains(named), "{found:?}");
    assert_eq!(notes(&text.replace("-66.8", "-668")), Notes::default());
}

/// The import finds a value outside the table of points: above the header, with its unit in a separate cell, or with its name in
/// the first column. It uses the value, or lists it as left out.
#[test]
fn values_in_any_column_are_read_or_listed() {
    let base = changed("", "", [0.0; 3]);
    for (row, listed) in [
        ("Negative camber;1.0;deg;", "Negative camber"),
        ("Caster;5;deg;positive rearward", "Caster"),
        ("Rack travel;75;mm;", "Rack travel"),
        ("Rack travel;75;total;", "Rack travel"),
    ] {
        let found = read(&format!("{base}{row}\n")).unwrap();
        let line = found.left_out.iter().find(|line| line.contains(listed));
        assert!(line.is_some(), "{row}: {:?}", found.left_out);
    }
    let numbered: String = base
        .lines()
        .enumerate()
        .map(|(n, line)| match n {
            0 => format!("No.;{line}\n"),
            n => format!("{n};{line}\n"),
        })
        .collect();
    let with_row = format!("{numbered}Loaded radius;228;;;;\nRide frequency;2.5;Hz;;;\n");
    let found = read(&with_row).unwrap();
    assert_eq!(found.wheel_radius, Some(228.0));
    assert!(found.left_out.join("\n").contains("Ride frequency"));
    let above = read(&format!("Loaded radius;228;mm;;\n{base}")).unwrap();
    assert_eq!(above.wheel_radius, Some(228.0));
    // All coordinates are whole numbers, so the value above the header shows the decimal comma.
    let above = "Static camber;-1,5;;\nLoaded radius;22,8 cm;;\n";
    let above = read(&format!("{above}{base}")).unwrap();
    assert_eq!(above.static_camber, Some(-1.5));
    assert_eq!(above.wheel_radius, Some(228.0));
}

/// The message about unclear axes names the point whose coordinate has the wrong sign.
#[test]
fn a_wrong_sign_that_hides_the_axes_is_named() {
    for (name, at) in [
        ("UCA front inner", [125.0, 255.0, -285.0]),
        ("UCA rear inner", [-135.0, 260.0, -275.0]),
        ("LCA front inner", [130.0, 190.0, -118.0]),
    ] {
        let Err(refused) = read(&changed(name, name, at)) else {
            continue;
        };
        assert!(refused.contains(&format!("{name:?}")), "{refused}");
    }
    let refused = read(&changed(
        "UCA front inner",
        "UCA front inner",
        [125.0, 255.0, -285.0],
    ));
    assert!(refused.unwrap_err().contains("z = 285 instead of -285"));
}
