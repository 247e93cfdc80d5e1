//! Tests of files whose values an import or export could lose or change without a message.

use super::{Said, file, imported};
use hardpoint::exchange::{FileUnit, Imported, Outgoing, into_subsystem};
use hardpoint::model::{AxlePosition, LengthUnit, Side};
use hardpoint::study::Study;
use std::fs;
use std::path::Path;

/// Hardpoints of a double wishbone as a subsystem file.
pub(super) const SUBSYSTEM: &str = "\
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
    let said = Said {
        unit: unit.map(Into::into),
        side: Some(side),
        radius: Some(0.31),
        bushings: true,
        ..Said::default()
    };
    imported(path, "double_wishbone", &said).unwrap()
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
        &crate::support::studies().join("double_wishbone_solve.toml"),
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
    let notes = read.notes.texts().collect::<Vec<_>>().join("\n");
    assert!(
        !notes.contains("assumed: the file states none") && !notes.contains("deduced"),
        "{notes}"
    );
}

/// The unit of a file of Assetto Corsa is fixed, because its rates, masses and offsets depend on it. `--unit` cannot replace it.
#[test]
fn a_fixed_unit_is_not_replaced() {
    let directory = tempfile::tempdir().unwrap();
    let path = file(&directory, "suspensions.ini", AXLE.as_bytes());
    let read = |unit: &str| {
        let said = Said {
            unit: FileUnit::named(unit),
            ..Said::default()
        };
        imported(&path, "double_wishbone", &said)
    };
    assert_eq!(read("m").unwrap().unit, LengthUnit::Metre);
    for unit in ["mm", "cm"] {
        let refused = read(unit).unwrap_err();
        assert!(
            refused.contains(&format!(
                "--unit {unit}: files of this format are always in m"
            )),
            "{refused}"
        );
    }
}

/// A live axle without TRACK has no wheel centres. The message names the key, and no other option.
#[test]
fn a_live_axle_needs_its_track() {
    let directory = tempfile::tempdir().unwrap();
    let text = "[REAR]\nTYPE=AXLE\n[AXLE]\nJ0_CAR=0.5,0.1,0.4\nJ0_AXLE=0.2,0.1,0.0\nJ1_CAR=-0.5,0.1,0.4\n\
         J1_AXLE=-0.2,0.1,0.0\nJ2_CAR=0.4,-0.1,0.5\nJ2_AXLE=0.5,-0.12,0.0\nJ3_CAR=-0.4,-0.1,0.5\nJ3_AXLE=-0.5,-0.12,0.0\n";
    let path = file(&directory, "suspensions.ini", text.as_bytes());
    let refused = imported(&path, "solid_axle", &Said::default()).unwrap_err();
    assert!(
        refused.contains("[REAR] has no TRACK") && !refused.contains("--side"),
        "{refused}"
    );
}

const WHEEL: &str = "\
name,x,y,z
UCA front,135,265,330
UCA rear,-165,270,318
UBJ,-8,545,365
LCA front,150,215,142
LCA rear,-180,220,138
LBJ,6,575,130
tie rod inner,68,230,170
Point 8,75,560,165
wheel centre,0,620,255
Notes,to be done,see drawing,later
";

/// A row of texts has no coordinates. The import lists it.
#[test]
fn rows_of_texts_are_listed() {
    let directory = tempfile::tempdir().unwrap();
    let text = WHEEL.replace("Point 8", "tie rod outer");
    let path = file(&directory, "points.csv", text.as_bytes());
    let read = imported(&path, "double_wishbone", &Said::default()).unwrap();
    let wanted = "Notes: these rows have texts instead of coordinates";
    assert!(
        read.left_out.contains(&wanted.to_owned()),
        "{:?}",
        read.left_out
    );
}

/// Axes of the user that contradict the points are used, with a warning in the first line.
#[test]
fn axes_that_the_points_contradict_are_a_warning() {
    let directory = tempfile::tempdir().unwrap();
    let text = WHEEL.replace("Point 8", "tie rod outer");
    let path = file(&directory, "points.csv", text.as_bytes());
    let call = |axes: &str| {
        let base = [
            "hardpoint",
            "import",
            path.to_str().unwrap(),
            "--topology",
            "double_wishbone",
        ];
        let base = base
            .into_iter()
            .chain(["--axes", axes, "--out"])
            .map(str::to_owned);
        let out = directory.path().join(format!("{axes}.toml"));
        hardpoint::cli::run_captured(base.chain([out.to_str().unwrap().to_owned()]))
    };
    let (code, said) = call("rearward,right,up");
    assert_eq!(code, 0, "{said}");
    assert!(
        said.starts_with("warning: please check: in the points x points forward"),
        "{said}"
    );
    let (code, said) = call("forward,left,up");
    assert_eq!(code, 0, "{said}");
    assert!(!said.contains("warning"), "{said}");
}

/// The import of Python reads `--map`. Names in the call have priority. It refuses the three studies of a car.
#[test]
fn names_of_a_map_are_read_in_memory() {
    let directory = tempfile::tempdir().unwrap();
    let path = file(&directory, "points.csv", WHEEL.as_bytes());
    let map = file(&directory, "names.toml", b"tie_rod_outer = \"Point 8\"\n");
    let base = [
        "import",
        path.to_str().unwrap(),
        "--topology",
        "double_wishbone",
    ];
    let call = |more: &[&str], names: &[(&str, &str)]| {
        let arguments: Vec<String> = base.iter().chain(more).map(|&a| a.to_owned()).collect();
        let names = names
            .iter()
            .map(|(a, b)| ((*a).to_owned(), (*b).to_owned()));
        hardpoint::cli::import_study(&arguments, None, names.collect())
    };
    let map = ["--map", map.to_str().unwrap()];
    let (study, _) = call(&map, &[]).unwrap();
    assert!(
        study.contains("tie_rod_outer") && study.contains("[75.0, 560.0, 165.0]"),
        "{study}"
    );
    assert!(call(&[], &[]).is_err());
    assert!(call(&map, &[("tie_rod_outer", "Point 9")]).is_err());
    let refused = call(&["--car", "--out", "car"], &[]).unwrap_err();
    assert!(
        format!("{refused:?}").contains("--car writes three studies"),
        "{refused:?}"
    );
}

/// The name of a study in memory is no path. A directory with this name does not change the export.
#[test]
fn the_name_of_a_study_in_memory_is_no_path() {
    let directory = tempfile::tempdir().unwrap();
    let samples = crate::support::studies();
    let own = samples.join("double_wishbone_front.toml");
    let study = Study::read(&own, &[]).unwrap();
    let run = directory.path().join("run");
    fs::create_dir(&run).unwrap();
    fs::copy(&own, run.join("optimised.toml")).unwrap();
    fs::copy(
        samples.join("double_wishbone_solve.toml"),
        run.join("study.toml"),
    )
    .unwrap();
    let exported = |name: &str, out: &str| {
        let out = directory.path().join(out);
        let source = directory.path().join(name);
        let paths = [&source, &out].map(|path| path.to_str().unwrap().to_owned());
        let [source, target] = paths;
        let arguments = [
            "export", &source, "--to", "csv", "--round", "7", "--out", &target,
        ];
        hardpoint::cli::export_study(&study, &arguments.map(str::to_owned)).unwrap();
        fs::read_to_string(out).unwrap()
    };
    assert_eq!(exported("run", "a.csv"), exported("absent.toml", "b.csv"));
}
