//! Tests of files of Assetto Corsa: invented ones, and exported ones that are imported again.

use super::{Said, at, car_of, close, file, imported, runs, study};
use crate::support;
use hardpoint::exchange::{Imported, Outgoing, suspensions_ini, suspensions_ini_of_car};
use hardpoint::model::{AxlePosition, Frame, LengthUnit, Side};
use hardpoint::study::{CarStudy, Study};

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

const AT_FRONT: Option<AxlePosition> = Some(AxlePosition::Front);
const AT_REAR: Option<AxlePosition> = Some(AxlePosition::Rear);

/// Imports one axle of a text.
fn axle_of(text: &str, topology: &str, axle: Option<AxlePosition>) -> Result<Imported, String> {
    let directory = tempfile::tempdir().unwrap();
    let said = Said {
        axle,
        ..Said::default()
    };
    let path = file(&directory, "suspensions.ini", text.as_bytes());
    imported(&path, topology, &said)
}

#[test]
fn both_axles_of_assetto_corsa_are_read() {
    let refused = axle_of(CAR, "double_wishbone", None).unwrap_err();
    assert!(refused.contains("--axle front or --axle rear"), "{refused}");
    let wishbones = axle_of(CAR, "double_wishbone", AT_FRONT).unwrap();
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
    assert_eq!(study.wheel().vehicle.position, AT_FRONT);

    let refused = axle_of(CAR, "double_wishbone", AT_REAR).unwrap_err();
    assert!(refused.contains("--topology macpherson"), "{refused}");
    let strut = axle_of(CAR, "macpherson", AT_REAR).unwrap();
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
}

#[test]
fn axles_of_assetto_corsa_need_their_version_and_track() {
    // The first version of the format has no rim offset.
    let first = axle_of(
        &CAR.replace("VERSION=2", "VERSION=1"),
        "double_wishbone",
        AT_FRONT,
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
        axle_of(&without, "double_wishbone", AT_FRONT)
            .unwrap_err()
            .contains("--half-track")
    );
}

#[test]
fn wrong_axles_of_assetto_corsa_are_refused() {
    for (from, to, axle, expected) in [
        ("TYPE=STRUT", "TYPE=AXLE", AT_REAR, "--topology solid_axle"),
        ("TYPE=STRUT", "TYPE=ML", AT_REAR, "multilink"),
        ("TYPE=STRUT", "TYPE=COSMIC", AT_REAR, "TYPE is \"COSMIC\""),
        (
            "0.38,0.12,-0.17",
            "0.38,0.12",
            AT_FRONT,
            "line 12: WBCAR_TOP_REAR",
        ),
        (
            "TRACK=1.5\n",
            "TRACK=wide\n",
            AT_FRONT,
            "expected a number, found \"wide\"",
        ),
        ("WBCAR_STEER=0.44,-0.03,0.1", "", AT_FRONT, "tie_rod_inner"),
    ] {
        let refused = axle_of(&CAR.replacen(from, to, 1), "double_wishbone", axle).unwrap_err();
        assert!(refused.contains(expected), "{expected}: {refused}");
    }
    for text in ["[PHYSICS]\nX=1\n", "x", "{"] {
        let refused = axle_of(text, "double_wishbone", None).unwrap_err();
        assert!(
            refused.contains("[FRONT] and [REAR]") && !refused.contains("JSON"),
            "{refused}"
        );
    }
}

/// Solid axles with four links, or with a Panhard rod, keep their points through an export to Assetto Corsa and back.
/// The points are relative to the midpoint of both wheel centres.
#[test]
fn solid_axles_come_back_from_assetto_corsa() {
    let directory = tempfile::tempdir().unwrap();
    for name in ["solid_axle_solve.toml", "solid_axle_rear.toml"] {
        let own = Study::read(&support::studies().join(name), &[]).unwrap();
        let outgoing = Outgoing::of(&own, Some(LengthUnit::Metre), None);
        let written = suspensions_ini(&outgoing).unwrap();
        let path = file(&directory, "suspensions.ini", &written.bytes);
        let said = Said {
            axle: Some(AxlePosition::Rear),
            ..Said::default()
        };
        let back = imported(&path, "solid_axle", &said).unwrap();
        let mechanism = &own.wheel().mechanism;
        let centre = outgoing.place(Side::Left, mechanism.wheel_centre);
        let wheel = back
            .hardpoints
            .iter()
            .find(|h| h.name == "wheel_centre")
            .unwrap();
        let frame = Frame::new(back.frame, Side::Left);
        let links = back
            .hardpoints
            .iter()
            .filter(|h| h.name.contains("link") || h.name.contains("panhard"));
        let mut count = 0;
        for hardpoint in links {
            let id = mechanism.point(hardpoint.name).unwrap();
            let mut wanted = outgoing.place(Side::Left, id) - centre;
            wanted.y += centre.y;
            let wanted = frame.vector(wanted).to_array();
            let found = [
                hardpoint.position[0] - wheel.position[0],
                hardpoint.position[1],
                hardpoint.position[2] - wheel.position[2],
            ];
            for (found, wanted) in found.into_iter().zip(wanted) {
                assert!(
                    (found - wanted).abs() < 1e-14,
                    "{name} {}: {found} {wanted}",
                    hardpoint.name
                );
            }
            count += 1;
        }
        let has_panhard = mechanism.point("panhard_axle").is_some();
        assert_eq!(count, if has_panhard { 6 } else { 4 }, "{name}");
        study(&back.study("back", "there").unwrap());
    }
}

/// The import refuses links that a solid axle cannot have, with the reason. If the user assigns names to the links,
/// the import succeeds.
#[test]
fn other_links_of_assetto_corsa_are_named() {
    let directory = tempfile::tempdir().unwrap();
    let own = Study::read(&support::studies().join("solid_axle_solve.toml"), &[]).unwrap();
    let written = suspensions_ini(&Outgoing::of(&own, None, None)).unwrap();
    let text = String::from_utf8(written.bytes).unwrap();
    assert!(text.contains("LINK_COUNT=4"), "{text}");
    // The file has two further links that are not mirror images.
    let more = text.replace("LINK_COUNT=4", "LINK_COUNT=6")
        + "J4_CAR=0.6,0.01,0.48\nJ4_AXLE=0,0.02,-0.03\nJ5_CAR=-0.6,-0.01,0.48\nJ5_AXLE=0,0.02,-0.03\n";
    let path = file(&directory, "suspensions.ini", more.as_bytes());
    let mut said = Said {
        axle: Some(AxlePosition::Rear),
        ..Said::default()
    };
    let refused = imported(&path, "solid_axle", &said).unwrap_err();
    assert!(
        refused.contains("2 mirrored pairs and 2 single ones") && refused.contains("--map"),
        "{refused}"
    );
    let links = [("lower_link", 0), ("upper_link", 2)];
    for (part, number) in links {
        for (end, key) in [("chassis", "CAR"), ("axle", "AXLE")] {
            said.names
                .insert(format!("{part}_{end}"), format!("AXLE J{number}_{key}"));
        }
    }
    let read = imported(&path, "solid_axle", &said).unwrap();
    assert!(
        read.left_out.iter().any(|line| line.contains("J5_CAR")),
        "{:?}",
        read.left_out
    );
    let wrong = file(
        &directory,
        "suspensions.ini",
        text.replace("LINK_COUNT=4", "LINK_COUNT=5").as_bytes(),
    );
    let refused = imported(&wrong, "solid_axle", &said).unwrap_err();
    assert!(refused.contains("LINK_COUNT is 5"), "{refused}");
}

/// Rate at the left wheel in N/m: increase of the wheel load per heave of the wheel centre. With camber, the heave of
/// the contact point differs from this heave by less than 1 %.
fn springs_alone(study: &Study) -> f64 {
    let start = study.text.find("[motion]").unwrap();
    let text = study.text[..start].to_owned()
        + "[motion]\nheave = [-0.5, 0.0, 0.5]\n[outputs]\ncharacteristics = [\"wheel_load\"]\n";
    let heaving = self::study(&text);
    let solved = hardpoint::solved::Solved::of(&heaving).unwrap();
    let stations = &solved.curves().stations;
    let load = |k: usize| stations[k].value(0).unwrap();
    1000.0 * (load(2) - load(0))
}

/// A car with two double wishbone axles is exported to Assetto Corsa and imported again. The points relative to the
/// wheel centres, the wheelbase, the weight distribution and the heights stay the same.
#[test]
fn a_car_comes_back_from_assetto_corsa() {
    let directory = tempfile::tempdir().unwrap();
    let own = CarStudy::read(&support::studies().join("formula_student_car.toml"), &[]).unwrap();
    let written = suspensions_ini_of_car(&own).unwrap();
    let path = file(&directory, "suspensions.ini", &written.bytes);
    let mass = format!("[BASIC]\nTOTALMASS={:?}\n", own.car.mass);
    file(&directory, "car.ini", mass.as_bytes());
    let car = car_of(&path, None).unwrap();
    let metres = |length: f64| LengthUnit::Metre.convert(length, own.car.length_unit);
    let near =
        |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
    for (axle, (back, text)) in car.axles.iter().zip(&car.files[1..]).enumerate() {
        study(text);
        let suspension = own.axles[axle].wheel();
        let at = |name: &str| {
            back.hardpoints
                .iter()
                .find(|h| h.name == name)
                .unwrap()
                .position
        };
        let centre = suspension.design[suspension.mechanism.wheel_centre.0];
        for hardpoint in &back.hardpoints {
            let id = suspension.mechanism.point(hardpoint.name).unwrap();
            let wanted = (suspension.design[id.0] - centre).to_array();
            let wheel = at("wheel_centre");
            for k in 0..3 {
                near(hardpoint.position[k] - wheel[k], metres(wanted[k]));
            }
        }
        near(2.0 * at("wheel_centre")[1], metres(2.0 * centre.y));
        let unsprung = own.axles[axle].axle().unwrap().axle.setup.unsprung_mass;
        assert!(
            text.contains(&format!("unsprung_mass = {:?}", unsprung.unwrap())),
            "{text}"
        );
    }
    // Rate at the wheel in N/m.
    let ini = String::from_utf8(written.bytes).unwrap();
    let rates = ini.lines().filter_map(|l| l.strip_prefix("SPRING_RATE="));
    let rates: Vec<f64> = rates.map(|rate| rate.parse().unwrap()).collect();
    assert_eq!(rates.len(), 2);
    for (axle, rate) in own.axles.iter().zip(rates) {
        let slope = springs_alone(axle);
        assert!((rate / slope - 1.0).abs() < 0.01, "{rate} {slope}");
    }
    // In the game's files, springs have a rate at the wheel and no points. The import lists the missing data.
    let left_out = car.axles[0].left_out.join("\n");
    assert!(
        left_out.contains("N/m at the wheel") && left_out.contains("motion_ratio^2"),
        "{left_out}"
    );
    assert!(
        car.missing.iter().any(|line| line.contains("[spring]")),
        "{:?}",
        car.missing
    );
    let number = |key: &str, place: usize| -> f64 {
        let line = car.files[0]
            .lines()
            .find(|line| line.starts_with(key))
            .unwrap();
        let numbers = line.split(['[', ',', ']', '=']).map(str::trim);
        numbers
            .filter_map(|word| word.parse().ok())
            .nth(place)
            .unwrap()
    };
    let front = own.axles[0].wheel();
    let front = front.design[front.mechanism.wheel_centre.0];
    near(number("cg =", 0), metres(own.car.cg.x - front.x));
    near(number("cg =", 2), metres(own.car.cg.z - front.z));
    let rear = own.axles[1].wheel();
    let rear = rear.design[rear.mechanism.wheel_centre.0] + own.car.rear_offset;
    near(number("rear_offset", 2), metres(rear.z - front.z));
    let back = car.axles[1]
        .hardpoints
        .iter()
        .find(|h| h.name == "wheel_centre")
        .unwrap();
    near(-back.position[0], metres(front.x - rear.x));
}
