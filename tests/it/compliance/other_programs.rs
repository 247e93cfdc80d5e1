//! Tests of property files of bushings, and of results with the definitions of other programs.

use super::support::{elastic, with};
use hardpoint::compliance::{ElasticWheel, HeldQuantity, Shape, WheelLoads};
use hardpoint::number::Vector3;
use hardpoint::report::OtherProgram;
use hardpoint::rig::RigTests;
use hardpoint::study::Study;

const NAME: &str = "double_wishbone_compliance.toml";

/// Property file of a bushing with straight curves, and with these points of the curve along y.
fn bus(fy: &str) -> String {
    let mut text = "[MDI_HEADER]\nFILE_TYPE = 'bus'\n[UNITS]\nLENGTH = 'mm'\nANGLE = 'degrees'\nFORCE = 'newton'\n[DAMPING]\nFX_DAMPING = 1.0\n".to_owned();
    let degrees = 10.0_f64;
    let torque = |rate: f64| rate * degrees.to_radians();
    for (name, x, f) in [
        ("FX", 5.0, 5.0 * 700.0),
        ("FZ", 5.0, 5.0 * 1800.0),
        ("TX", degrees, torque(8.0e4)),
        ("TY", degrees, torque(2.5e5)),
        ("TZ", degrees, torque(2.5e5)),
    ] {
        text += &format!(
            "[{name}_CURVE]\n{{ x f }}\n{:?} {:?}\n0.0 0.0\n{x:?} {f:?}\n",
            -x, -f
        );
    }
    text + &format!("[FY_CURVE]\n{fy}\n")
}

/// A property file with straight curves defines a bushing whose stiffnesses are the slopes of the curves.
#[test]
fn a_property_file_with_straight_curves_is_a_linear_bushing() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(
        directory.path().join("rear.bus"),
        bus("-5.0 -12500.0\n0.0 0.0\n5.0 12500.0"),
    )
    .unwrap();
    let linear = "stiffness = [700.0, 2500.0, 1800.0, 8.0e4, 2.5e5, 2.5e5]";
    let text = with(NAME, "").replace(linear, "file = \"rear.bus\"");
    let study = Study::elastic_from_text("case.toml", &text, directory.path())
        .unwrap_or_else(|e| panic!("{e}"));
    let plain = elastic(&with(NAME, ""));
    assert_eq!(study.inputs, [directory.path().join("rear.bus")]);
    let figures = |study: &Study| {
        let tests = RigTests::of(study, None).unwrap();
        let outcomes = tests.results.stations[0].outcomes.as_ref().unwrap().clone();
        outcomes
            .into_iter()
            .flat_map(|o| o.figures)
            .filter_map(|f| f.value)
            .collect::<Vec<f64>>()
    };
    let (found, expected) = (figures(&study), figures(&plain));
    assert_eq!(found.len(), expected.len());
    assert!(found.len() > 25, "{}", found.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() < 1e-9 * b.abs().max(1e-9), "{a} {b}");
    }
    // The text of the study needs no separate file.
    assert!(!study.text.contains("rear.bus"));
    assert_eq!(elastic(&study.text).compliance(), study.compliance());
    // Mistakes: a law whose force decreases, a missing block, a law in addition to the file, a missing file.
    for (fy, more, phrase) in [
        ("-5.0 100.0\n5.0 -100.0", "", "must rise"),
        (
            "[FY_CURVE]",
            "",
            "the file has no block [FY_CURVE]: expected FX_CURVE, FY_CURVE",
        ),
        (
            "-5.0 -100.0\n5.0 100.0",
            "\ncubic = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]",
            "remove the key cubic",
        ),
    ] {
        let whole = bus(fy).replace("[FY_CURVE]\n[FY_CURVE]", "[OTHER]");
        std::fs::write(directory.path().join("rear.bus"), whole).unwrap();
        let text = with(NAME, "").replace(linear, &format!("file = \"rear.bus\"{more}"));
        let said = Study::elastic_from_text("case.toml", &text, directory.path())
            .unwrap_err()
            .render(false);
        assert!(said.contains(phrase), "{said}");
    }
    let text = with(NAME, "").replace(linear, "file = \"none.bus\"");
    let said = Study::elastic_from_text("case.toml", &text, directory.path())
        .unwrap_err()
        .render(false);
    assert!(said.contains("cannot read"), "{said}");
    let law = &study.compliance().unwrap().parts.bushings[1].shapes[3];
    assert!(matches!(law, Shape::Curve { .. }) && (law.initial_rate() - 8.0e4).abs() < 1e-6);
}

/// Results with the definitions of other programs equal rotations and displacements of the wheel under test loads.
/// These loads act on the ground straight below the wheel centre. The test covers a left and a right wheel.
#[test]
fn values_of_other_programs_follow_their_definitions() {
    for side in ["left", "right"] {
        // In the compliance matrices of other programs, the wheel load is held and the springs can move. So the tests
        // hold the wheel load.
        let tests = "relaxed = \"at_design_load\"\ntests = [{ load = \"lateral\", hold = \"wheel_load\" }, { load = \"aligning\", hold = \"wheel_load\" }, { load = \"vertical\" }]";
        let mut text = with(NAME, "").replace("relaxed = \"at_design_load\"", tests);
        if side == "right" {
            text = text.replace(
                "topology = \"double_wishbone\"",
                "topology = \"double_wishbone\"\nside = \"right\"",
            );
            let mirrored: Vec<String> = text.lines().map(mirror).collect();
            text = mirrored.join("\n");
        }
        let study = elastic(&text);
        let wheel = ElasticWheel::new(study.wheel(), &study.compliance().unwrap().parts).unwrap();
        let at = wheel.at(0.0, 0.0).unwrap();
        let tangent = wheel.tangent(&at, HeldQuantity::WheelLoad).unwrap();
        let along = |load: &WheelLoads| wheel.twist_along(&tangent, load).unwrap();
        // In the frame of a left wheel: an inboard force of 1 kN, 310 mm straight below the wheel centre.
        let mut force = WheelLoads::none(0.0);
        force.centre = Vector3::new(0.0, -1000.0, 0.0);
        force.moment = Vector3::new(-310.0 * 1000.0, 0.0, 0.0);
        let [shift, turn] = along(&force);
        let mut moment = WheelLoads::none(0.0);
        moment.moment.z = 1e5;
        let [_, twist] = along(&moment);
        let mut up = WheelLoads::none(0.0);
        up.centre.z = 1.0;
        let [rise, _] = along(&up);
        let named = |program, name: &str| {
            let csv = RigTests::of(&study, Some(program))
                .unwrap()
                .results
                .kc_csv();
            let mut reader = csv::Reader::from_reader(&csv[..]);
            let header = reader.headers().unwrap().clone();
            let cell = |record: &csv::StringRecord, column: &str| {
                record[header.iter().position(|c| c == column).unwrap()].to_owned()
            };
            let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
            let row = rows.iter().find(|row| cell(row, "other_name") == name)?;
            let own: f64 = cell(row, "value").parse().unwrap();
            Some((cell(row, "other_value").parse::<f64>().unwrap(), own))
        };
        // Toe-in of a left wheel is a rotation to the right. Positive camber tilts the top outboard.
        let expected = [
            (
                OtherProgram::Altair,
                "Lateral Force Steer",
                turn.z.to_degrees(),
                -1.0,
            ),
            (
                OtherProgram::Altair,
                "Lateral Force Camber",
                -turn.x.to_degrees(),
                1.0,
            ),
            (
                OtherProgram::Altair,
                "Lateral Force Deflection",
                -shift.y,
                1.0,
            ),
            (
                OtherProgram::Altair,
                "Aligning Torque Steer",
                twist.z.to_degrees(),
                -1.0,
            ),
            (
                OtherProgram::Adams,
                "alt_steer_compliance",
                twist.z.to_degrees() / 1e5,
                -1.0,
            ),
            (OtherProgram::Adams, "wheel_rate", 1.0 / rise.z, 1.0),
        ];
        for (program, name, expected, sign) in expected {
            let (found, own) = named(program, name).unwrap_or_else(|| panic!("{name}"));
            assert!(
                (found - expected).abs() < 1e-9 * expected.abs(),
                "{side} {name}: {found} {expected}"
            );
            if name != "Lateral Force Camber" || own.abs() > 1e-6 {
                assert_eq!(
                    found.signum(),
                    sign * own.signum(),
                    "{side} {name}: {found} {own}"
                );
            }
        }
        let camber = named(OtherProgram::Adams, "alt_camber_compliance");
        match side {
            "left" => {
                let (found, _) = camber.unwrap();
                let expected = -twist.x.to_degrees() / 1e5;
                assert!((found - expected).abs() < 1e-9 * expected.abs());
            }
            _ => assert!(camber.is_none()),
        }
    }
}

/// Line of hardpoints with the sign of y reversed.
fn mirror(line: &str) -> String {
    let Some((name, list)) = line
        .split_once('=')
        .filter(|(_, list)| list.trim().starts_with('[') && list.matches(',').count() == 2)
    else {
        return line.to_owned();
    };
    let numbers: Vec<f64> = list
        .trim()
        .trim_matches(['[', ']'])
        .split(',')
        .map(|n| n.trim().parse().unwrap())
        .collect();
    format!(
        "{name}= [{:?}, {:?}, {:?}]",
        numbers[0], -numbers[1], numbers[2]
    )
}
