//! Tests of invented suspensions of Project Chrono.

use super::{Said, at, file, imported, runs, study};
use hardpoint::exchange::{Imported, read_points};
use hardpoint::model::{LengthUnit, Side};

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

const SPRING: Part<'static> = (
    "Spring",
    &[
        ("Location Chassis", [0.05, 0.47, 0.24]),
        ("Location Arm", [0.05, 0.56, -0.09]),
    ],
);

#[test]
fn double_wishbones_of_chrono_are_read() {
    let shock: Part<'_> = (
        "Shock",
        &[
            ("Location Chassis", [0.04, 0.46, 0.36]),
            ("Location Arm", [0.05, 0.56, -0.09]),
        ],
    );
    let text = chrono(
        "DoubleWishbone",
        &[SPINDLE, ARMS[0], ARMS[1], TIEROD, SPRING, shock],
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
}

#[test]
fn struts_of_chrono_are_read() {
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
}

#[test]
fn links_of_chrono_are_five_links() {
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
}

#[test]
fn trailing_arms_of_chrono_are_read() {
    let trailing: Part<'_> = (
        "Trailing Arm",
        &[
            ("Location Chassis Outer", [0.48, 0.7, 0.0]),
            ("Location Chassis Inner", [0.4, 0.4, -0.04]),
            ("Location Spindle", [0.0, 0.7, 0.0]),
        ],
    );
    let text = chrono("SemiTrailingArm", &[SPINDLE, trailing, SPRING]);
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
    let text = chrono("ThreeLinkIRS", &[SPINDLE, arm, links[0], links[1], SPRING]);
    let read = of_chrono("trailing_arm_two_links", &text).unwrap();
    assert_eq!(at(&read, "arm_pivot"), [0.6, 0.6, 0.05]);
    assert_eq!(at(&read, "lower_link_outer"), [-0.06, 0.66, -0.08]);
    assert_eq!(at(&read, "spring_upper"), [0.05, 0.47, 0.24]);
    runs(&read);
}

#[test]
fn other_suspensions_of_chrono_are_refused() {
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

/// The import reads the points of solid axles of Project Chrono: two pairs of links, and a triangular upper link.
#[test]
fn solid_axles_of_chrono_are_read() {
    let upper = [
        (
            "SolidAxle",
            "Upper Link",
            [0.355, 0.5, 0.15],
            [-0.055, 0.2, 0.15],
        ),
        (
            "SolidThreeLinkAxle",
            "Triangular Link",
            [0.4, 0.3, 0.2],
            [0.0, 0.0, 0.25],
        ),
    ];
    let directory = tempfile::tempdir().unwrap();
    for (template, name, chassis, axle) in upper {
        let lower = match template {
            "SolidAxle" => "Lower Link",
            _ => "Longitudinal Link",
        };
        let text = format!(
            r#"{{ "Type": "Suspension", "Template": "{template}", "Spindle": {{ "COM": [0, 0.91, 0] }},
            "{name}": {{ "Location Chassis": {chassis:?}, "Location Axle": {axle:?} }},
            "{lower}": {{ "Location Chassis": [0.45, 0.35, -0.045], "Location Axle": [0.01, 0.6, -0.075] }},
            "Draglink": {{ "Location Chassis": [0.3, 0.4, 0] }},
            "Spring": {{ "Location Chassis": [-0.08, 0.56, 0.3], "Location Axle": [-0.065, 0.575, -0.025] }} }}"#
        );
        let path = file(&directory, "axle.json", text.as_bytes());
        let table = read_points(&path, None, None).unwrap();
        assert_eq!(table.topology(None).unwrap().name, "solid_axle");
        let read = imported(&path, "solid_axle", &Said::default()).unwrap();
        let at = |name: &str| {
            read.hardpoints
                .iter()
                .find(|h| h.name == name)
                .unwrap()
                .position
        };
        assert_eq!(at("upper_link_chassis"), chassis);
        assert_eq!(at("upper_link_axle"), axle);
        assert_eq!(at("lower_link_axle"), [0.01, 0.6, -0.075]);
        assert_eq!(at("spring_lower"), [-0.065, 0.575, -0.025]);
        assert!(
            read.left_out
                .iter()
                .any(|line| line.starts_with("Draglink"))
        );
        let study = study(&read.study("axle", "there").unwrap());
        assert!(study.axle().unwrap().axle.is_rigid());
        let right = Said {
            side: Some(Side::Right),
            ..Said::default()
        };
        assert!(
            imported(&path, "solid_axle", &right)
                .unwrap_err()
                .contains("both wheels")
        );
    }
}
