//! Tests of invented files in the layouts of other tools: OptimumKinematics, Project Chrono, Assetto Corsa.

use super::{Said, file, imported};
use hardpoint::exchange::{Imported, Page, Value, workbook};
use hardpoint::model::{AxlePosition, FrameConvention, LengthUnit, Side};
use hardpoint::study::Study;
use std::path::Path;

fn at(read: &Imported, name: &str) -> [f64; 3] {
    let found = read.hardpoints.iter().find(|h| h.name == name);
    found
        .unwrap_or_else(|| panic!("{name}: {:?}", read.left_out))
        .position
}

fn close(found: [f64; 3], wanted: [f64; 3], name: &str) {
    for (found, wanted) in found.into_iter().zip(wanted) {
        assert!(
            (found - wanted).abs() < 1e-12 * 1000.0,
            "{name}: {found} {wanted}"
        );
    }
}

fn runs(read: &Imported) -> Study {
    let text = read.study("made up", "there").unwrap();
    Study::from_text("s.toml", &text, Path::new(".")).unwrap()
}

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

#[test]
fn workbooks_of_optimum_kinematics_are_read() {
    let directory = tempfile::tempdir().unwrap();
    let page = |name: &str, rows| Page {
        name: name.to_owned(),
        rows,
    };
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
    let on_upright = workbook(&[page("Front", optimum("Upright", "LowerAArm"))]);
    let path = file(&directory, "upright.xlsx", &on_upright);
    let text = imported(&path, "double_wishbone", &Said::default()).unwrap();
    let text = text.study("s", "there").unwrap();
    assert!(
        text.contains("pullrod_outer = \"knuckle\"") && !text.contains("drop_link_outer = \""),
        "{text}"
    );
    // The workbook has two sheets; `--axle` chooses one.
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

/// Part of a suspension of Project Chrono with its locations.
type Part<'a> = (&'a str, &'a [(&'a str, [f64; 3])]);

/// Suspension of Project Chrono: parts by name, each with its locations.
fn chrono(template: &str, parts: &[Part<'_>]) -> String {
    let mut text = format!(
        "// made up\n{{ \"Name\": \"x // y\", \"Type\": \"Suspension\", \"Template\": \"{template}\",\n/* two\nlines */"
    );
    for (part, locations) in parts {
        text += &format!("\n  \"{part}\": {{ \"Mass\": 1.5, \"Inertia\": [0.1, 0.2, 0.3]");
        for (key, [x, y, z]) in *locations {
            text += &format!(", \"{key}\": [{x:?}, {y:?}, {z:?}] // here");
            text.push('\n');
        }
        text += "},";
    }
    text + "\n  \"Axle\": { \"Inertia\": 0.4 } }\n"
}

fn of_chrono(topology: &str, text: &str) -> Result<Imported, String> {
    let directory = tempfile::tempdir().unwrap();
    imported(
        &file(&directory, "suspension.json", text.as_bytes()),
        topology,
        &Said::default(),
    )
}

const SPINDLE: Part<'static> = ("Spindle", &[("COM", [0.0, 0.8, 0.02])]);
const TIEROD: Part<'static> = (
    "Tierod",
    &[
        ("Location Chassis", [-0.21, 0.39, -0.02]),
        ("Location Upright", [-0.16, 0.73, -0.03]),
    ],
);
const ARMS: [Part<'static>; 2] = [
    (
        "Upper Control Arm",
        &[
            ("COM", [0.0, 0.5, 0.2]),
            ("Location Chassis Front", [0.06, 0.44, 0.2]),
            ("Location Chassis Back", [-0.19, 0.45, 0.19]),
            ("Location Upright", [-0.03, 0.68, 0.21]),
        ],
    ),
    (
        "Lower Control Arm",
        &[
            ("Location Chassis Front", [0.21, 0.31, -0.09]),
            ("Location Chassis Back", [-0.2, 0.32, -0.08]),
            ("Location Upright", [-0.01, 0.74, -0.12]),
        ],
    ),
];

#[test]
fn every_template_of_chrono_with_a_topology_is_read() {
    let spring: Part<'_> = (
        "Spring",
        &[
            ("Location Chassis", [0.05, 0.47, 0.24]),
            ("Location Arm", [0.05, 0.56, -0.09]),
        ],
    );
    let shock: Part<'_> = (
        "Shock",
        &[
            ("Location Chassis", [0.04, 0.46, 0.36]),
            ("Location Arm", [0.05, 0.56, -0.09]),
        ],
    );
    let text = chrono(
        "DoubleWishbone",
        &[SPINDLE, ARMS[0], ARMS[1], TIEROD, spring, shock],
    );
    let read = of_chrono("double_wishbone", &text).unwrap();
    assert_eq!((read.unit, read.side), (LengthUnit::Metre, Side::Left));
    assert_eq!(at(&read, "upper_arm_rear"), [-0.19, 0.45, 0.19]);
    assert_eq!(at(&read, "wheel_centre"), [0.0, 0.8, 0.02]);
    assert_eq!(at(&read, "spring_upper"), [0.05, 0.47, 0.24]);
    assert!(
        read.left_out.iter().any(|line| line.starts_with("Shock")),
        "{:?}",
        read.left_out
    );
    runs(&read);
    let refused = of_chrono("macpherson", &text).unwrap_err();
    assert!(refused.contains("--topology double_wishbone"), "{refused}");

    // The reduced template has no separate spring, and its damper is on the upright.
    let on_upright: Part<'_> = (
        "Shock",
        &[
            ("Location Chassis", [0.05, 0.47, 0.3]),
            ("Location Upright", [0.05, 0.66, -0.05]),
        ],
    );
    let text = chrono(
        "DoubleWishboneReduced",
        &[SPINDLE, ARMS[0], ARMS[1], TIEROD, on_upright],
    );
    let study = of_chrono("double_wishbone", &text)
        .unwrap()
        .study("s", "there")
        .unwrap();
    assert!(study.contains("spring_lower = \"knuckle\""), "{study}");

    let arm = ("Control Arm", ARMS[1].1);
    let strut: Part<'_> = (
        "Spring",
        &[
            ("Location Chassis", [-0.06, 0.6, 0.55]),
            ("Location Upright", [-0.03, 0.68, 0.2]),
        ],
    );
    let text = chrono("MacPhersonStrut", &[SPINDLE, arm, TIEROD, strut]);
    let read = of_chrono("macpherson", &text).unwrap();
    assert_eq!(at(&read, "strut_top"), [-0.06, 0.6, 0.55]);
    assert_eq!(at(&read, "strut_lower"), [-0.03, 0.68, 0.2]);
    runs(&read);

    let links = [
        SPINDLE,
        ("Upper Arm", ARMS[0].1),
        (
            "Lateral",
            &[
                ("Location Chassis", [0.03, 0.25, -0.12]),
                ("Location Upright", [0.02, 0.73, -0.1]),
            ][..],
        ),
        (
            "Trailing Link",
            &[
                ("Location Chassis", [0.7, 0.55, -0.06]),
                ("Location Upright", [0.0, 0.74, -0.14]),
            ],
        ),
        TIEROD,
        (
            "Spring",
            &[
                ("Location Chassis", [0.2, 0.6, 0.2]),
                ("Location Link", [0.2, 0.66, -0.12]),
            ],
        ),
    ];
    let read = of_chrono("five_link", &chrono("MultiLink", &links)).unwrap();
    assert_eq!(at(&read, "lower_front_link_inner"), [0.7, 0.55, -0.06]);
    assert_eq!(
        at(&read, "upper_rear_link_outer"),
        at(&read, "upper_front_link_outer")
    );
    let left_out = read.left_out.join("; ");
    for wanted in [
        "on a link",
        "spring_lower = [0.0000, 0.7400, -0.1400], spring_upper = [0.0000, 0.6800, 0.1800]",
        "multiply its motion_ratio by 0.71",
    ] {
        assert!(left_out.contains(wanted), "{left_out}");
    }
    runs(&read);

    let trailing: Part<'_> = (
        "Trailing Arm",
        &[
            ("Location Chassis Outer", [0.48, 0.7, 0.0]),
            ("Location Chassis Inner", [0.4, 0.4, -0.04]),
            ("Location Spindle", [0.0, 0.7, 0.0]),
        ],
    );
    let text = chrono("SemiTrailingArm", &[SPINDLE, trailing, spring]);
    let read = of_chrono("semi_trailing_arm", &text).unwrap();
    assert_eq!(at(&read, "arm_pivot_inner"), [0.4, 0.4, -0.04]);
    assert_eq!(at(&read, "spring_lower"), [0.05, 0.56, -0.09]);
    runs(&read);

    let arm: Part<'_> = (
        "Trailing Arm",
        &[
            ("Location Chassis", [0.6, 0.6, 0.05]),
            ("Location Spindle", [0.0, 0.7, 0.02]),
        ],
    );
    let links: [Part<'_>; 2] = [
        (
            "Upper Link",
            &[
                ("Location Chassis", [-0.05, 0.25, 0.22]),
                ("Location Arm", [-0.05, 0.65, 0.15]),
            ],
        ),
        (
            "Lower Link",
            &[
                ("Location Chassis", [-0.06, 0.2, -0.05]),
                ("Location Arm", [-0.06, 0.66, -0.08]),
            ],
        ),
    ];
    let text = chrono("ThreeLinkIRS", &[SPINDLE, arm, links[0], links[1], spring]);
    let read = of_chrono("trailing_arm_two_links", &text).unwrap();
    assert_eq!(at(&read, "arm_pivot"), [0.6, 0.6, 0.05]);
    assert_eq!(at(&read, "lower_link_outer"), [-0.06, 0.66, -0.08]);
    assert_eq!(at(&read, "spring_upper"), [0.05, 0.47, 0.24]);
    runs(&read);

    for (template, nearest) in [
        ("LeafspringAxle", "an axle that joins both wheels"),
        ("DeDionAxle", "an axle that joins both wheels"),
        ("GenericWheeledSuspension", "joints of any kind"),
        ("Hovercraft", "expected DoubleWishbone"),
    ] {
        let refused = of_chrono("double_wishbone", &chrono(template, &[SPINDLE])).unwrap_err();
        assert!(
            refused.contains(template) && refused.contains(nearest),
            "{refused}"
        );
    }
}

/// Car with front wishbones and rear struts, with only `TYPE` and the entries that a study needs.
const CAR: &str = "\
[HEADER]
VERSION=2
[BASIC]
WHEELBASE=2.45\t\t; metres
CG_LOCATION=0.46
[FRONT]
TYPE=DWB\t; wishbones
BASEY=-0.21
TRACK=1.5
RIM_OFFSET=0.01
WBCAR_TOP_FRONT=0.38, 0.12, 0.13 ; lateral, up, forward
WBCAR_TOP_REAR=0.38,0.12,-0.17
WBCAR_BOTTOM_FRONT=0.45,-0.07,0.14
WBCAR_BOTTOM_REAR=0.43,-0.08,-0.26
WBTYRE_TOP=0.15,0.11,-0.03
WBTYRE_BOTTOM=0.1,-0.1,0.0
WBCAR_STEER=0.44,-0.03,0.1
WBTYRE_STEER=0.1,-0.06,0.12
STATIC_CAMBER=-2.2
TOE_OUT=0.0003
SPRING_RATE=60000
[REAR]
TYPE=STRUT
TRACK=1.48
STRUT_CAR=0.2,0.45,-0.02
STRUT_TYRE=0.1,0.02,0.0
WBCAR_BOTTOM_FRONT=0.4,-0.1,0.2
WBCAR_BOTTOM_REAR=0.4,-0.1,-0.15
WBTYRE_BOTTOM=0.08,-0.12,0.01
WBCAR_STEER=0.42,-0.08,-0.18
WBTYRE_STEER=0.09,-0.09,-0.14
";

#[test]
fn both_axles_of_assetto_corsa_are_read() {
    let directory = tempfile::tempdir().unwrap();
    let read = |text: &str, topology: &str, axle: Option<AxlePosition>| {
        let said = Said {
            axle,
            ..Said::default()
        };
        imported(
            &file(&directory, "suspensions.ini", text.as_bytes()),
            topology,
            &said,
        )
    };
    let (front, rear) = (Some(AxlePosition::Front), Some(AxlePosition::Rear));
    let refused = read(CAR, "double_wishbone", None).unwrap_err();
    assert!(refused.contains("--axle front or --axle rear"), "{refused}");
    let wishbones = read(CAR, "double_wishbone", front).unwrap();
    assert_eq!(
        (wishbones.side, wishbones.unit),
        (Side::Left, LengthUnit::Metre)
    );
    // Calculated by hand: half the track minus the lateral coordinate, plus 10 mm outboard for the rim offset.
    for (name, wanted) in [
        ("upper_arm_front", [0.13, 0.75 - 0.38 + 0.01, 0.12]),
        ("lower_ball_joint", [0.0, 0.75 - 0.1 + 0.01, -0.1]),
        ("tie_rod_outer", [0.12, 0.75 - 0.1 + 0.01, -0.06]),
        ("wheel_centre", [0.0, 0.75, 0.0]),
    ] {
        close(at(&wishbones, name), wanted, name);
    }
    assert_eq!(
        (wishbones.static_camber, wishbones.static_toe),
        (Some(-2.2), Some(0.0))
    );
    assert_eq!(
        (wishbones.wheelbase, wishbones.track),
        (Some(2.45), Some(1.5))
    );
    assert!(wishbones.left_out.join(" ").contains("TOE_OUT"));
    let study = runs(&wishbones);
    assert_eq!(study.wheel().vehicle.position, front);

    let refused = read(CAR, "double_wishbone", rear).unwrap_err();
    assert!(refused.contains("--topology macpherson"), "{refused}");
    let strut = read(CAR, "macpherson", rear).unwrap();
    close(
        at(&strut, "strut_top"),
        [-2.45 - 0.02, 0.74 - 0.2, 0.45],
        "strut_top",
    );
    close(
        at(&strut, "wheel_centre"),
        [-2.45, 0.74, 0.0],
        "wheel_centre",
    );
    runs(&strut);

    // The first version of the format has no rim offset.
    let first = read(
        &CAR.replace("VERSION=2", "VERSION=1"),
        "double_wishbone",
        front,
    )
    .unwrap();
    close(
        at(&first, "upper_arm_front"),
        [0.13, 0.75 - 0.38, 0.12],
        "upper_arm_front",
    );
    // Without a track the wheel centre is at the origin.
    let without = CAR.replace("TRACK=1.5\n", "");
    assert!(
        read(&without, "double_wishbone", front)
            .unwrap_err()
            .contains("--half-track")
    );

    for (from, to, axle, expected) in [
        ("TYPE=STRUT", "TYPE=AXLE", rear, "--topology solid_axle"),
        ("TYPE=STRUT", "TYPE=ML", rear, "multilink"),
        ("TYPE=STRUT", "TYPE=COSMIC", rear, "TYPE is \"COSMIC\""),
        (
            "0.38,0.12,-0.17",
            "0.38,0.12",
            front,
            "line 12: WBCAR_TOP_REAR",
        ),
        (
            "TRACK=1.5\n",
            "TRACK=wide\n",
            front,
            "expected a number, found \"wide\"",
        ),
        ("WBCAR_STEER=0.44,-0.03,0.1", "", front, "tie_rod_inner"),
    ] {
        let refused = read(&CAR.replacen(from, to, 1), "double_wishbone", axle).unwrap_err();
        assert!(refused.contains(expected), "{expected}: {refused}");
    }
    for text in ["[PHYSICS]\nX=1\n", "x", "{"] {
        let refused = read(text, "double_wishbone", None).unwrap_err();
        assert!(
            refused.contains("[FRONT] and [REAR]") && !refused.contains("JSON"),
            "{refused}"
        );
    }
}
