//! Tests of files of OptimumKinematics and Assetto Corsa: the content of exported files, and their import as a study.

use super::parsers::{cells, close, of_text, sample, template};
use super::round_trips::studies;
use super::{Said, file, imported};
use hardpoint::exchange::{Outgoing, Page, csv, optimum_k_rows, suspensions_ini, workbook};
use hardpoint::model::{Frame, FrameConvention, LengthUnit, Side};
use hardpoint::number::Vector3;
use std::collections::BTreeMap;

/// The export writes double wishbones in the layout of OptimumKinematics: the points of both wheels, the contact point
/// instead of the wheel centre, and toe-out positive.
#[test]
fn optimum_k_tables_hold_the_wheel() {
    let mut count = 0;
    for study in studies() {
        let suspension = study.wheel();
        let topology = suspension.mechanism.topology.name;
        let outgoing = Outgoing::of(&study, None, None);
        if topology != "double_wishbone" {
            assert!(optimum_k_rows(&outgoing).unwrap_err().contains(topology));
            continue;
        }
        count += 1;
        let (rows, _) = optimum_k_rows(&outgoing).unwrap();
        let rows = cells(&rows);
        let number = |name: &str, column: usize| {
            let row = rows.iter().find(|row| row[1] == name);
            row.unwrap_or_else(|| panic!("{name}"))[column]
                .parse::<f64>()
                .unwrap()
        };
        let iso = |s| {
            outgoing
                .in_convention(FrameConvention::Iso8855)
                .position(s, suspension.mechanism.wheel_centre)
        };
        for (side, first) in [(Side::Left, 2), (Side::Right, 6)] {
            let frame = Frame::new(FrameConvention::Iso8855, side);
            for (own, name) in [
                ("lower_arm_front", "CHAS_LowFor"),
                ("upper_arm_rear", "CHAS_UppAft"),
                ("upper_ball_joint", "UPRI_UppPnt"),
                ("tie_rod_outer", "UPRI_TiePnt"),
            ] {
                let id = suspension.mechanism.point(own).unwrap();
                let expected = frame.vector(suspension.design[id.0]).to_array();
                assert_eq!(
                    [0, 1, 2].map(|k| number(name, first + k)),
                    expected.map(|x| x + 0.0)
                );
            }
            // Wheel centre from the contact point, by the equation of the import.
            let [camber, toe_out] =
                ["Static Camber", "Static Toe"].map(|name| number(name, first).to_radians());
            let toe = -toe_out;
            let radius = number("Tire Diameter", first) / 2.0;
            let left = [
                number("Longitudinal Offset", first) + radius * camber.sin() * toe.sin(),
                number("Half Track", first)
                    + number("Lateral Offset", first)
                    + radius * camber.sin() * toe.cos(),
                number("Vertical Offset", first) + radius * camber.cos(),
            ];
            let [x, y, z] = left;
            let found = frame.vector(Vector3::new(x, y.abs(), z)).to_array();
            let within = suspension.length_unit.convert(1e-9, LengthUnit::Millimetre);
            assert!(close(found, iso(side), within), "{found:?} {:?}", iso(side));
        }
    }
    assert!(count >= 18, "{count}");
    // The file has -0.3 for a toe-in of 0.3 degrees.
    let text = template("double_wishbone");
    let text = text
        .replace("spindle_inner    =", "# spindle_inner =")
        .replace("# static_camber =", "static_toe = 0.3\nstatic_camber =");
    let study = of_text(&text);
    let (rows, _) = optimum_k_rows(&Outgoing::of(&study, None, None)).unwrap();
    let toe = cells(&rows)
        .into_iter()
        .find(|row| row[1] == "Static Toe")
        .unwrap();
    assert_eq!([&toe[2], &toe[6]], ["-0.3", "-0.3"]);
}

/// The file contains rod, rocker and spring of a pushrod, and the part that carries the rod.
#[test]
fn optimum_k_tables_hold_the_rocker() {
    let study = sample("double_wishbone_pushrod.toml");
    let outgoing = Outgoing::of(&study, None, None);
    let (rows, notes) = optimum_k_rows(&outgoing).unwrap();
    let rows = cells(&rows);
    let at = |name: &str| {
        let row = rows.iter().find(|row| row[1] == name).unwrap();
        [2, 3, 4].map(|k| row[k].parse::<f64>().unwrap())
    };
    let own = |name: &str| {
        outgoing
            .points(Side::Left)
            .find(|(n, ..)| *n == name)
            .unwrap()
            .2
    };
    for (name, hardpoint) in [
        ("NSMA_PPAttPnt_L", "pushrod_outer"),
        ("ROCK_RodPnt_L", "pushrod_inner"),
        ("ROCK_CoiPnt_L", "spring_lower"),
        ("CHAS_AttPnt_L", "spring_upper"),
        ("CHAS_RocPiv_L", "rocker_pivot_front"),
        ("CHAS_RocAxi_L", "rocker_pivot_rear"),
    ] {
        assert_eq!(at(name), own(hardpoint), "{name}");
    }
    let attached = rows.iter().find(|row| row[1] == "Push Pull").unwrap();
    let id = study.wheel().mechanism.point("pushrod_outer").unwrap();
    let expected = match outgoing.body(Side::Left, id) {
        Some("lower_arm") => "LowerAArm",
        Some("upper_arm") => "UpperAArm",
        _ => "Upright",
    };
    assert_eq!(attached[4], expected);
    assert!(
        !notes.iter().any(|note| note.contains("pushrod")),
        "{notes:?}"
    );
}

/// The points of every wishbone and strut in `suspensions.ini` are relative to the wheel centre. Added to the wheel
/// centre, they equal the points of the study.
#[test]
fn suspensions_ini_holds_the_points() {
    let mut kinds = BTreeMap::new();
    for study in studies() {
        let suspension = study.wheel();
        let topology = suspension.mechanism.topology.name;
        let outgoing = Outgoing::of(&study, None, None);
        let keys: &[(&str, &str)] = match topology {
            "double_wishbone" => &[
                ("WBCAR_TOP_FRONT", "upper_arm_front"),
                ("WBCAR_TOP_REAR", "upper_arm_rear"),
                ("WBTYRE_TOP", "upper_ball_joint"),
                ("WBCAR_BOTTOM_FRONT", "lower_arm_front"),
                ("WBCAR_STEER", "tie_rod_inner"),
                ("WBTYRE_STEER", "tie_rod_outer"),
            ],
            "macpherson" => &[
                ("STRUT_CAR", "strut_top"),
                ("STRUT_TYRE", "strut_lower"),
                ("WBCAR_BOTTOM_REAR", "lower_arm_rear"),
                ("WBTYRE_BOTTOM", "lower_ball_joint"),
            ],
            _ => {
                assert!(suspensions_ini(&outgoing).unwrap_err().contains(topology));
                continue;
            }
        };
        if suspension.mechanism.strut_upper().is_some() {
            assert!(
                suspensions_ini(&outgoing)
                    .unwrap_err()
                    .contains("strut_upper")
            );
            continue;
        }
        *kinds.entry(topology).or_insert(0) += 1;
        let written = suspensions_ini(&outgoing).unwrap();
        let text = String::from_utf8(written.bytes).unwrap();
        let value = |key: &str| {
            let mut lines = text.lines();
            lines
                .find_map(|line| line.strip_prefix(key)?.strip_prefix('='))
                .unwrap_or_else(|| panic!("{key}"))
        };
        let metres = |length: f64| LengthUnit::Metre.convert(length, suspension.length_unit);
        let centre = suspension.design[suspension.mechanism.wheel_centre.0].map(metres);
        assert!((value("TRACK").parse::<f64>().unwrap() - 2.0 * centre.y).abs() < 1e-14);
        for (key, name) in keys {
            let parts: Vec<f64> = value(key)
                .split(',')
                .map(|x| x.trim().parse().unwrap())
                .collect();
            let id = suspension.mechanism.point(name).unwrap();
            let expected = suspension.design[id.0].map(metres).to_array();
            // Coordinates relative to the wheel centre: x inboard, y up, z forward.
            let found = [
                centre.x + parts[2],
                centre.y - parts[0],
                centre.z + parts[1],
            ];
            assert!(close(found, expected, 1e-14), "{key}");
        }
        let camber = value("STATIC_CAMBER").parse::<f64>().unwrap();
        let (_, side) = suspension.frame.meaning();
        assert_eq!(camber, outgoing.static_angles(side)[0]);
    }
    assert!(
        kinds.len() == 2 && kinds.values().all(|count| *count >= 18),
        "{kinds:?}"
    );
}

/// BASEY is the height of the wheel centre minus the height of the centre of gravity. The height of the wheel centre is
/// the radius times the cosine of camber.
#[test]
fn heights_of_suspensions_ini_are_from_the_centre_of_gravity() {
    let mut study = of_text(template("macpherson"));
    study.wheel_mut().wheel_radius = Some(300.0);
    study.wheel_mut().vehicle.cg_height = Some(550.0);
    study.wheel_mut().vehicle.wheelbase = Some(2600.0);
    let outgoing = Outgoing::of(&study, None, None);
    let text = String::from_utf8(suspensions_ini(&outgoing).unwrap().bytes).unwrap();
    let value = |key: &str| {
        text.lines()
            .find_map(|line| line.strip_prefix(key))
            .unwrap()
            .to_owned()
    };
    let [camber, _] = outgoing.static_angles(Side::Left);
    let expected = 0.3 * camber.to_radians().cos() - 0.55;
    assert!((value("BASEY=").parse::<f64>().unwrap() - expected).abs() < 1e-12);
    assert_eq!(value("WHEELBASE="), "2.6");
}

/// After an export to OptimumKinematics and an import, double wishbones have the same points in the file's unit. The
/// file gives the contact point instead of the wheel centre, so the wheel centre is equal only up to rounding errors.
/// The angles have the signs of the study.
#[test]
fn double_wishbones_come_back_from_optimum_k() {
    let directory = tempfile::tempdir().unwrap();
    for study in studies() {
        let suspension = study.wheel();
        if suspension.mechanism.topology.name != "double_wishbone" {
            continue;
        }
        let (_, side) = suspension.frame.meaning();
        for unit in LengthUnit::ALL {
            let outgoing = Outgoing::of(&study, Some(unit), Some(FrameConvention::Iso8855));
            let (rows, notes) = optimum_k_rows(&outgoing).unwrap();
            let table = file(&directory, "optimum.csv", &csv(&rows));
            let name = "Front Suspension".to_owned();
            let book = file(
                &directory,
                "optimum.xlsx",
                &workbook(&[Page { name, rows }]),
            );
            for path in [table, book] {
                let said = Said {
                    side: Some(side),
                    ..Said::default()
                };
                let back = imported(&path, "double_wishbone", &said).unwrap();
                assert_eq!(
                    (back.unit, back.frame, back.side),
                    (unit, outgoing.convention, side)
                );
                let size = outgoing.length(suspension.size());
                for (name, _, position) in outgoing.points(side) {
                    // The format has one name for both kinds of rods, and one axis point of a bar on each side.
                    let name = name.replace("pullrod", "pushrod");
                    let found = back
                        .hardpoints
                        .iter()
                        .find(|h| h.name.replace("pullrod", "pushrod") == name);
                    match (name.as_str(), found) {
                        ("spindle_inner" | "anti_roll_bar_inner", _) => (),
                        ("wheel_centre", Some(found)) => {
                            assert!(close(found.position, position, 1e-14 * size), "{name}");
                        }
                        (_, Some(found)) => assert_eq!(found.position, position, "{name}"),
                        // The file cannot contain a spring without a rocker, or a bar with an oblique axis. The notes
                        // name these parts.
                        (name, None) => {
                            assert!(notes.iter().any(|note| note.contains(name)), "{name}");
                        }
                    }
                }
                let angles = [back.static_camber, back.static_toe].map(|angle| angle.unwrap());
                let expected = outgoing.static_angles(side);
                assert!(
                    angles
                        .iter()
                        .zip(expected)
                        .all(|(a, b)| (a - b).abs() < 1e-13),
                    "{angles:?} {expected:?}"
                );
                assert_eq!(
                    back.wheel_radius,
                    suspension.wheel_radius.map(|r| outgoing.length(r))
                );
            }
        }
    }
}

/// Wishbones and struts keep their positions relative to the wheel centre through an export to Assetto Corsa and back.
/// The positions are in metres.
#[test]
fn wishbones_and_struts_come_back_from_assetto_corsa() {
    let directory = tempfile::tempdir().unwrap();
    for study in studies() {
        let suspension = study.wheel();
        let topology = suspension.mechanism.topology.name;
        let outgoing = Outgoing::of(&study, Some(LengthUnit::Metre), None);
        let Ok(written) = suspensions_ini(&outgoing) else {
            continue;
        };
        let path = file(&directory, "suspensions.ini", &written.bytes);
        let said = Said {
            side: Some(Side::Left),
            ..Said::default()
        };
        let back = imported(&path, topology, &said).unwrap();
        assert_eq!(back.unit, LengthUnit::Metre);
        let (_, side) = suspension.frame.meaning();
        let own = Frame::new(back.frame, Side::Left);
        let at = |name: &str| {
            back.hardpoints
                .iter()
                .find(|h| h.name == name)
                .unwrap()
                .position
        };
        let centre = outgoing.place(side, suspension.mechanism.wheel_centre);
        for hardpoint in &back.hardpoints {
            let id = suspension.mechanism.point(hardpoint.name).unwrap();
            let expected = own.vector(outgoing.place(side, id) - centre).to_array();
            let [a, b] = [hardpoint.position, at("wheel_centre")];
            let found = [0, 1, 2].map(|k| a[k] - b[k]);
            assert!(close(found, expected, 1e-14), "{}", hardpoint.name);
        }
        assert_eq!(back.static_camber, Some(outgoing.static_angles(side)[0]));
    }
}
