//! Tests of files whose values an import or export could lose or change without a message.

use super::{Said, file, imported};
use hardpoint::exchange::{ImportOptions, Imported, Outgoing, import, into_subsystem, read_points};
use hardpoint::model::{AxlePosition, LengthUnit, Side, Topology};
use hardpoint::study::Study;
use std::collections::BTreeMap;
use std::path::Path;

const SUBSYSTEM: &str = "\
[HARDPOINT]
{hardpoint_name   symmetry  x_value y_value z_value}
 'lca_front' 'left/right' -160.0 -380.0 190.0
 'lca_rear' 'left/right' 200.0 -375.0 198.0
 'lca_outer' 'left/right' -10.0 -700.0 180.0
 'uca_front' 'left/right' -80.0 -440.0 508.0
 'uca_rear' 'left/right' 150.0 -430.0 492.0
 'uca_outer' 'left/right' 25.0 -650.0 520.0
 'tierod_inner' 'left/right' 130.0 -385.0 235.0
 'tierod_outer' 'left/right' 140.0 -685.0 228.0
 'wheel_center' 'left/right' 0.0 -760.0 310.0
";

/// Property file with the same rate, in N/mm and N mm/deg, for all axes.
fn bus(rate: f64) -> String {
    let units = "[UNITS]\nLENGTH = 'mm'\nANGLE = 'degrees'\nFORCE = 'newton'\n";
    let curve = |axis| format!("[{axis}_CURVE]\n-1.0 {}\n1.0 {rate}\n", -rate);
    let curves = ["FX", "FY", "FZ", "TX", "TY", "TZ"].map(curve);
    format!("{units}{}", curves.concat())
}

fn with_bushings(path: &Path, side: Side, unit: Option<LengthUnit>) -> Imported {
    let none = BTreeMap::new();
    let options = ImportOptions {
        topology: Topology::named("double_wishbone").unwrap(),
        unit: unit.map(Into::into),
        frame: None,
        axes: None,
        side: Some(side),
        axle: None,
        half_track: None,
        radius: Some(0.31),
        bushings: true,
        names: &none,
        bodies: &none,
    };
    import(&read_points(path, None, None).unwrap(), &options).unwrap()
}

/// First rate of the study's first bushing: along the axis of the pivots.
fn rate(read: &Imported) -> f64 {
    let text = read.study("s", "there").unwrap();
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("stiffness = ["));
    line.unwrap().split(',').next().unwrap().parse().unwrap()
}

/// The rate has the unit of the study, also if the subsystem states no unit. A right bushing has priority over a left one.
#[test]
fn bushings_have_the_unit_and_the_side_of_the_wheel() {
    let directory = tempfile::tempdir().unwrap();
    file(&directory, "soft.bus", bus(100.0).as_bytes());
    file(&directory, "hard.bus", bus(900.0).as_bytes());
    let bushing = |side: &str, name: &str| {
        format!(
            "[BUSHING_ASSEMBLY]\n USAGE = 'lca_front'\n SYMMETRY = '{side}'\n PROPERTY_FILE = '{name}.bus'\n"
        )
    };
    let in_metres = SUBSYSTEM.replace(".0 ", "e-3 ").replace(".0\n", "e-3\n");
    let text = in_metres + &bushing("left", "soft") + &bushing("right", "hard");
    let path = file(&directory, "front.sub", text.as_bytes());
    for unit in [None, Some(LengthUnit::Metre)] {
        for (side, wanted) in [(Side::Left, 100.0e3), (Side::Right, 900.0e3)] {
            let read = with_bushings(&path, side, unit);
            assert_eq!(read.unit, LengthUnit::Metre);
            let found = rate(&read);
            assert!((found - wanted).abs() < 1e-9 * wanted, "{side:?}: {found}");
        }
    }
}

/// An export into a subsystem replaces all rows that an import reads, with or without quotes.
#[test]
fn rows_without_quotes_are_replaced() {
    let study = Study::read(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/double_wishbone_solve.toml"),
        &[],
    )
    .unwrap();
    let text = SUBSYSTEM.replace("'lca_rear' 'left/right'", "lca_rear left/right");
    let outgoing = Outgoing::of(&study, None, None);
    let [quoted, plain] = [SUBSYSTEM, &text].map(|text| {
        let written = into_subsystem(&outgoing, text.as_bytes()).unwrap();
        String::from_utf8(written.bytes).unwrap().replace('\'', "")
    });
    assert_eq!(plain, quoted);
}

const AXLE: &str = "\
[FRONT]
TYPE=DWB
TRACK=1.5
WBCAR_TOP_FRONT=0.38,0.12,0.13
WBCAR_TOP_REAR=0.38,0.12,-0.17
WBCAR_BOTTOM_FRONT=0.45,-0.07,0.14
WBCAR_BOTTOM_REAR=0.43,-0.08,-0.26
WBTYRE_TOP=0.15,0.11,-0.03
WBTYRE_BOTTOM=0.1,-0.1,0.0
WBCAR_STEER=0.44,-0.03,0.1
WBTYRE_STEER=0.1,-0.06,0.12
";

/// The points of a strut in a section of wishbones are no spring. The import lists them as left out.
#[test]
fn points_of_another_type_are_left_out() {
    let directory = tempfile::tempdir().unwrap();
    let text = format!("{AXLE}STRUT_CAR=0.3,0.4,0.0\nSTRUT_TYRE=0.1,0.0,0.0\n");
    let path = file(&directory, "suspensions.ini", text.as_bytes());
    let read = imported(&path, "double_wishbone", &Said::default()).unwrap();
    assert!(
        read.hardpoints
            .iter()
            .all(|h| !h.name.starts_with("spring"))
    );
    let left_out = read.left_out.join("\n");
    assert!(left_out.contains("STRUT_CAR, STRUT_TYRE"), "{left_out}");
}

/// A link of a live axle behind a gap in the numbers counts. A link with one end is refused.
#[test]
fn links_behind_a_gap_are_not_lost() {
    let directory = tempfile::tempdir().unwrap();
    let read = |more: &str| {
        let text = format!(
            "[REAR]\nTYPE=axle\nTRACK=1.5\n[AXLE]\nJ0_CAR=0.5,0.1,0.4\nJ0_AXLE=0.2,0.1,0.0\nJ1_CAR=-0.5,0.1,0.4\n\
             J1_AXLE=-0.2,0.1,0.0\nJ2_CAR=0.4,-0.1,0.5\nJ2_AXLE=0.5,-0.12,0.0\nJ3_CAR=-0.4,-0.1,0.5\nJ3_AXLE=-0.5,-0.12,0.0\n{more}"
        );
        let path = file(&directory, "suspensions.ini", text.as_bytes());
        imported(&path, "solid_axle", &Said::default())
    };
    assert!(read("").is_ok());
    let fifth = "J5_CAR=0.4,0.05,-0.2\nJ5_AXLE=-0.5,0.05,-0.2\n";
    for (more, expected) in [(fifth, "Panhard"), ("J5_CAR=0.4,0.05,-0.2\n", "line 13")] {
        let refused = read(more).unwrap_err();
        assert!(refused.contains(expected), "{refused}");
    }
}

/// An axle of Project Chrono keeps metres and ISO 8855 if the program cannot read the other axle.
#[test]
fn an_axle_beside_an_unknown_one_keeps_its_unit() {
    let directory = tempfile::tempdir().unwrap();
    let wishbones = r#"{ "Type": "Suspension", "Template": "DoubleWishbone", "Spindle": { "COM": [0.0, 0.8, 0.02] },
        "Upper Control Arm": { "Location Chassis Front": [0.06, 0.44, 0.2], "Location Chassis Back": [-0.19, 0.45, 0.19],
          "Location Upright": [-0.03, 0.68, 0.21] },
        "Lower Control Arm": { "Location Chassis Front": [0.21, 0.31, -0.09], "Location Chassis Back": [-0.2, 0.32, -0.08],
          "Location Upright": [-0.01, 0.74, -0.12] },
        "Tierod": { "Location Chassis": [-0.21, 0.39, -0.02], "Location Upright": [-0.16, 0.73, -0.03] } }"#;
    file(&directory, "front.json", wishbones.as_bytes());
    let leaf = r#"{ "Type": "Suspension", "Template": "LeafspringAxle" }"#;
    file(&directory, "rear.json", leaf.as_bytes());
    let car = r#"{ "Type": "Vehicle", "Axles": [
        { "Suspension Input File": "front.json", "Suspension Location": [1.5, 0, 0] },
        { "Suspension Input File": "rear.json", "Suspension Location": [-1.5, 0, 0] } ] }"#;
    let path = file(&directory, "car.json", car.as_bytes());
    let said = Said {
        axle: Some(AxlePosition::Front),
        ..Said::default()
    };
    let read = imported(&path, "double_wishbone", &said).unwrap();
    assert_eq!(read.unit, LengthUnit::Metre);
    let notes = read.notes.join("\n");
    assert!(
        !notes.contains("assumed: the file states none") && !notes.contains("deduced"),
        "{notes}"
    );
}
