//! Tests of invented workbooks in the layout of OptimumKinematics.

use super::{Said, at, close, file, imported, runs};
use hardpoint::exchange::{Page, Value, workbook};
use hardpoint::model::{AxlePosition, FrameConvention, LengthUnit, Side};

/// Points of an invented left wheel under the names of OptimumKinematics.
const OPTIMUM: [(&str, [f64; 3]); 17] = [
    ("CHAS_LowFor", [151.0, 205.0, 118.0]),
    ("CHAS_LowAft", [-139.0, 207.0, 123.0]),
    ("CHAS_UppFor", [119.0, 246.0, 262.0]),
    ("CHAS_UppAft", [-122.0, 248.0, 256.0]),
    ("UPRI_LowPnt", [4.0, 571.0, 121.0]),
    ("UPRI_UppPnt", [-9.0, 548.0, 286.0]),
    ("CHAS_TiePnt", [51.0, 146.0, 145.0]),
    ("UPRI_TiePnt", [72.0, 562.0, 152.0]),
    ("NSMA_PPAttPnt_L", [-3.0, 509.0, 297.0]),
    ("CHAS_AttPnt_L", [-60.0, 60.0, 150.0]),
    ("CHAS_RocAxi_L", [40.0, 262.0, 150.0]),
    ("CHAS_RocPiv_L", [-30.0, 262.0, 150.0]),
    ("ROCK_RodPnt_L", [0.0, 222.0, 155.0]),
    ("ROCK_CoiPnt_L", [0.0, 262.0, 195.0]),
    ("NSMA_UBarAttPnt_L", [0.0, 235.0, 175.0]),
    ("UBAR_AttPnt_L", [-150.0, 235.0, 180.0]),
    ("CHAS_PivPnt_L", [-150.0, 230.0, 240.0]),
];

/// Workbook of one axle: titles, names in column B, left wheel in C to E, right wheel in G to I.
fn optimum(rod: &str, bar: &str) -> Vec<Vec<Value>> {
    let row = |cells: &[&str]| -> Vec<Value> {
        let cell = |text: &&str| match (*text, text.parse()) {
            ("", _) => Value::Empty,
            (_, Ok(number)) => Value::Number(number),
            (text, Err(_)) => Value::Text(text.to_owned()),
        };
        cells.iter().map(cell).collect()
    };
    let mut rows = vec![
        row(&["", "Name:", "made up"]),
        row(&["User Options", "Length", "millimeter", "mm"]),
        row(&["", "Angle", "degree", "deg"]),
    ];
    for (title, points) in [
        ("Double A-Arm", &OPTIMUM[..8]),
        ("Push Pull", &OPTIMUM[8..14]),
        ("U-Bar", &OPTIMUM[14..]),
    ] {
        rows.push(row(&[]));
        rows.push(row(&[
            title,
            "Point Name",
            "Left",
            "",
            "",
            "",
            "Right",
            "",
            "",
        ]));
        rows.push(row(&["", "", "X", "Y", "Z", "", "X", "Y", "Z"]));
        for (name, [x, y, z]) in points {
            let numbers = [*x, *y, *z, *x, -y, *z].map(|number| number.to_string());
            let [x, y, z, right_x, right_y, right_z] = numbers.each_ref().map(String::as_str);
            rows.push(row(&["", name, x, y, z, "", right_x, right_y, right_z]));
        }
    }
    rows.push(row(&[]));
    rows.push(row(&["Wheels", "Point Name", "Left", "", "", "", "Right"]));
    for (name, value) in [
        ("Half Track", "603"),
        ("Longitudinal Offset", "2"),
        ("Lateral Offset", "1"),
        ("Vertical Offset", "0"),
        ("Static Camber", "-1.5"),
        ("Static Toe", "0.25"),
        ("Rim Diameter", "254"),
        ("Tire Diameter", "406"),
    ] {
        rows.push(row(&["", name, value, "", "", "", value]));
    }
    rows.push(row(&["Attachment", "Element", "", "Attached To"]));
    rows.push(row(&[
        "",
        "Push Pull",
        "NSMA_PPAttPnt_L",
        "Double A-Arm",
        rod,
    ]));
    rows.push(row(&["", "U-Bar", "NSMA_UBarAttPnt_L", "Push Pull", bar]));
    rows
}

fn page(name: &str, rows: Vec<Vec<Value>>) -> Page {
    Page {
        name: name.to_owned(),
        rows,
    }
}

#[test]
fn workbooks_of_optimum_kinematics_are_read() {
    let directory = tempfile::tempdir().unwrap();
    let book = workbook(&[page("Front Suspension", optimum("UpperAArm", "Rocker"))]);
    let path = file(&directory, "car.xlsx", &book);
    // Calculated by hand: a toe-out of 0.25 is a toe-in of -0.25. The wheel centre is one radius above the contact
    // point, in the wheel plane.
    let (camber, toe) = (-1.5_f64.to_radians(), -0.25_f64.to_radians());
    let centre = [
        2.0 + 203.0 * camber.sin() * toe.sin(),
        604.0 + 203.0 * camber.sin() * toe.cos(),
        203.0 * camber.cos(),
    ];
    for (side, sign) in [(Side::Left, 1.0), (Side::Right, -1.0)] {
        let said = Said {
            side: Some(side),
            ..Said::default()
        };
        let read = imported(&path, "double_wishbone", &said).unwrap();
        assert_eq!((read.side, read.frame), (side, FrameConvention::Iso8855));
        assert_eq!(read.unit, LengthUnit::Millimetre);
        assert_eq!(
            (read.static_camber, read.static_toe),
            (Some(-1.5), Some(-0.25))
        );
        assert_eq!(read.wheel_radius, Some(203.0));
        close(
            at(&read, "wheel_centre"),
            [centre[0], sign * centre[1], centre[2]],
            "wheel_centre",
        );
        for (name, point) in [
            ("lower_arm_front", 0),
            ("upper_ball_joint", 5),
            ("tie_rod_outer", 7),
            // The rod's higher end is at the wheel.
            ("pullrod_outer", 8),
            ("pullrod_inner", 12),
            ("rocker_pivot_front", 10),
            ("rocker_pivot_rear", 11),
            ("spring_upper", 9),
            ("spring_lower", 13),
            ("drop_link_outer", 14),
            ("drop_link_inner", 15),
            ("anti_roll_bar_outer", 16),
        ] {
            let [x, y, z] = OPTIMUM[point].1;
            assert_eq!(at(&read, name), [x, sign * y, z], "{name}");
        }
        // The U-bar turns about the line through the pivots of both wheels.
        assert_eq!(
            at(&read, "anti_roll_bar_inner"),
            [-150.0, -sign * 230.0, 240.0]
        );
        let text = read.study("s", "there").unwrap();
        assert!(text.contains("drop_link_outer = \"rocker\""), "{text}");
        assert!(
            !text.contains("pullrod_outer = \""),
            "a pullrod's usual body is the upper arm: {text}"
        );
        runs(&read);
    }
}

#[test]
fn rods_of_optimum_kinematics_keep_their_bodies() {
    let directory = tempfile::tempdir().unwrap();
    let on_upright = workbook(&[page("Front", optimum("Upright", "LowerAArm"))]);
    let path = file(&directory, "upright.xlsx", &on_upright);
    let text = imported(&path, "double_wishbone", &Said::default()).unwrap();
    let text = text.study("s", "there").unwrap();
    assert!(
        text.contains("pullrod_outer = \"knuckle\"") && !text.contains("drop_link_outer = \""),
        "{text}"
    );
}

/// The workbook has two sheets; `--axle` chooses one.
#[test]
fn one_sheet_of_optimum_kinematics_is_chosen() {
    let directory = tempfile::tempdir().unwrap();
    let two = workbook(&[
        page("Front Suspension", optimum("UpperAArm", "Rocker")),
        page("Rear Suspension", optimum("Upright", "Rocker")),
    ]);
    let path = file(&directory, "two.xlsx", &two);
    let refused = imported(&path, "double_wishbone", &Said::default()).unwrap_err();
    assert!(refused.contains("--sheet 'Rear Suspension'"), "{refused}");
    let said = Said {
        axle: Some(AxlePosition::Rear),
        ..Said::default()
    };
    let read = imported(&path, "double_wishbone", &said).unwrap();
    assert!(
        read.notes
            .texts()
            .any(|note| note.contains("Rear Suspension"))
    );
}
