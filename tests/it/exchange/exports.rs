//! Tests of files for other tools: given lengths in every unit, signs in every frame, and curves in other units and
//! axes.

use super::parsers::{all_ways, cells, entities, of_text, sample, template};
use super::round_trips::changed;
use crate::support::larger;
use hardpoint::exchange::{
    Envelope, Outgoing, Page, Span, Tool, Tyre, Value, curves_in, drawing, optimum_k_rows,
    page_of_csv, suspensions_ini, under_names_of,
};
use hardpoint::model::{Axis, Frame, FrameConvention, LengthUnit, Side};
use hardpoint::solved::Solved;
use hardpoint::study::Study;

/// A length of 508 mm is exported as 508 mm, 0.508 m or 20 in. This holds for every file format and every unit of the
/// study.
#[test]
fn planted_lengths_are_right_in_every_file_and_unit() {
    let study = of_text(template("double_wishbone"));
    let mut design = study.wheel().design.clone();
    let id = study.wheel().mechanism.point("wheel_centre").unwrap();
    design[id.0].y = 508.0;
    let inner = study.wheel().mechanism.point("spindle_inner").unwrap();
    design[inner.0].y = 408.0;
    let planted = study.at_design(design);
    let twenty = [508.0, 0.508, 20.0];
    for (own, _) in LengthUnit::ALL.into_iter().zip(twenty) {
        let mut study = planted.clone();
        let length = |x: f64| own.convert(x, LengthUnit::Millimetre);
        let points = planted.wheel().design.iter();
        study.wheel_mut().design = points.map(|p| p.map(length)).collect();
        study.wheel_mut().wheel_radius = Some(length(254.0));
        study.wheel_mut().tyre_width = Some(length(127.0));
        study.wheel_mut().length_unit = own;
        for (unit, expected) in LengthUnit::ALL.into_iter().zip(twenty) {
            let outgoing = Outgoing::of(&study, Some(unit), None);
            let tolerance = 1e-12 * expected;
            let is = |text: &str| (text.parse::<f64>().unwrap() - expected).abs() <= tolerance;
            let table = cells(&hardpoint::exchange::point_rows(&outgoing));
            let row = |name: &str| table.iter().find(|row| row[0] == name).unwrap().clone();
            assert!(is(&row("wheel_centre")[2]), "{own:?} {unit:?}");
            assert_eq!(table[0][2], format!("y_{}", unit.symbol()));
            let radius = row(&format!("wheel_radius_{}", unit.symbol()));
            assert!((radius[1].parse::<f64>().unwrap() - expected / 2.0).abs() <= tolerance);

            let lines = entities(&drawing(&outgoing));
            let point = lines.iter().find(|e| e.text == "wheel_centre").unwrap();
            assert!(is(&point.place(10)[1].to_string()));

            // The half track belongs to the contact point, so it depends on the camber.
            let (rows, _) = optimum_k_rows(&outgoing).unwrap();
            let rows = cells(&rows);
            let figure = |name: &str| rows.iter().find(|row| row[1] == name).unwrap()[2].clone();
            assert!(is(&figure("Tire Diameter")));
            let angle = -outgoing.spin_axis(Side::Left).z.asin();
            let outward = expected / 2.0 * angle.sin();
            let track = figure("Half Track").parse::<f64>().unwrap();
            assert!(
                (track - (expected - outward)).abs() <= 1e-6 * expected,
                "{track}"
            );
            assert!(
                (figure("Tire Width").parse::<f64>().unwrap() - expected / 4.0).abs() <= tolerance
            );
            let length = rows
                .iter()
                .find(|row| row.iter().any(|cell| cell == "Length"));
            assert!(length.unwrap().contains(&unit.symbol().to_owned()));

            // The unit of this file is always the metre.
            let ini = String::from_utf8(suspensions_ini(&outgoing).unwrap().bytes).unwrap();
            let track = ini.lines().find_map(|line| line.strip_prefix("TRACK="));
            assert!((track.unwrap().parse::<f64>().unwrap() - 1.016).abs() <= 1e-12);

            let tyre = Tyre {
                radius: expected / 2.0,
                width: expected / 4.0,
            };
            let still = Span {
                ends: [0.0; 2],
                values: 1,
            };
            let envelope = Envelope::of(&outgoing, tyre, still, still).unwrap();
            let corners = envelope.solids[0].iter().flatten();
            let (sum, count) =
                corners.fold((0.0, 0.0), |(sum, n), p| (sum + f64::from(p[1]), n + 1.0));
            assert!(
                (sum / count - expected).abs() <= 1e-5 * expected,
                "{}",
                sum / count
            );
        }
    }
}

/// In the axes of each file, the wheel is on the correct side, ahead of the origin and above it.
#[test]
fn files_have_the_signs_of_their_axes() {
    let study = of_text(template("double_wishbone"));
    for (unit, convention, side) in all_ways() {
        let study = changed(&study, unit, convention, side);
        for out in FrameConvention::ALL {
            let outgoing = Outgoing::of(&study, None, Some(out));
            let left = if side == Side::Left { 1.0 } else { -1.0 };
            // Signs of x, y and z of a point on this wheel's side that is ahead of the origin and above it.
            let signs = match out {
                FrameConvention::Iso8855 => [1.0, left, 1.0],
                FrameConvention::SaeJ670 => [1.0, -left, -1.0],
                FrameConvention::XRear => [-1.0, -left, 1.0],
            };
            let at = |name: &str| {
                let found = outgoing.points(side).find(|(known, ..)| *known == name);
                found.unwrap().2
            };
            let (front, rear) = (at("lower_arm_front"), at("lower_arm_rear"));
            assert!((front[0] - rear[0]) * signs[0] > 0.0);
            assert!(at("wheel_centre")[1] * signs[1] > 0.0);
            let above = at("upper_ball_joint")[2] - at("lower_ball_joint")[2];
            assert!(above * signs[2] > 0.0);
        }
    }
}

/// Study as its author would write it in another unit and other axes.
fn rewritten(study: &Study, unit: LengthUnit, convention: FrameConvention) -> Study {
    let own = study.wheel().length_unit;
    let (_, side) = study.wheel().frame.meaning();
    let length = |x: f64| unit.convert(x, own);
    let mut other = study.clone();
    let suspension = other.wheel_mut();
    suspension.design = study.wheel().design.iter().map(|p| p.map(length)).collect();
    suspension.length_unit = unit;
    suspension.frame = Frame::new(convention, side);
    suspension.wheel_radius = suspension.wheel_radius.map(length);
    let vehicle = &mut suspension.vehicle;
    for figure in [
        &mut vehicle.wheelbase,
        &mut vehicle.track,
        &mut vehicle.cg_height,
    ] {
        *figure = figure.map(length);
    }
    let along = study.wheel().frame.sign(Axis::Y) * suspension.frame.sign(Axis::Y);
    let motion = &mut other.one_wheel_mut().unwrap().motion;
    motion.values = study.motion().values.iter().map(|x| length(*x)).collect();
    motion.rack = study
        .motion()
        .rack
        .iter()
        .map(|x| along * length(*x))
        .collect();
    other
}

/// Curves are converted to the other unit and axes: coordinates, angular velocities, racks, angles, gains and
/// derivatives. They equal the curves of the same study, rewritten in that unit and these axes.
#[test]
fn curves_are_those_of_the_study_in_the_other_unit_and_axes() {
    let template = template("double_wishbone");
    let mut text = template.to_owned();
    let motion = text.find("[motion]").unwrap();
    text.truncate(motion);
    text += "[motion]\ntravel = { from = -30.0, to = 30.0, steps = 4 }\nrack = [-10.0, 0.0, 10.0]\n[outputs]\n\
             characteristics = [\"camber\", \"toe\", \"scrub_radius\", \"bump_steer\", \"side_view_centre_longitudinal\"]\n\
             points = [\"wheel_centre\", \"tie_rod_outer\"]\nknuckle = true\norder = \"acceleration\"\n";
    let study = of_text(&text);
    let csv_of = |study: &Study| Solved::of(study).unwrap().csv();
    let own = page_of_csv("curves", &csv_of(&study)).unwrap();
    for unit in LengthUnit::ALL {
        for convention in FrameConvention::ALL {
            let outgoing = Outgoing::of(&study, Some(unit), Some(convention));
            let found = curves_in(&outgoing, own.clone());
            let expected = csv_of(&rewritten(&study, unit, convention));
            let expected = page_of_csv("curves", &expected).unwrap();
            let columns = expected.rows[0].len();
            assert!(columns > 20);
            assert_eq!(found.rows[0][..columns], expected.rows[0]);
            let said: Vec<_> = found.rows[1][columns..].to_vec();
            assert_eq!(
                said,
                [
                    Value::Text("left".to_owned()),
                    Value::Text(convention.name().to_owned())
                ]
            );
            for column in 0..columns {
                let scale = largest(&expected, column);
                for (found, expected) in found.rows[1..].iter().zip(&expected.rows[1..]) {
                    let name = &expected_name(&own, column);
                    match (&found[column], &expected[column]) {
                        // The travel equals the height of the wheel centre, so the second derivative of that height is
                        // only a rounding error.
                        (Value::Number(a), Value::Number(b)) if scale < 1e-12 => {
                            assert!(a.abs() < 1e-12 && b.abs() < 1e-12, "{name}: {a} {b}");
                        }
                        (Value::Number(a), Value::Number(b)) => {
                            assert!((a - b).abs() <= 1e-9 * scale, "{name}: {a} {b}");
                        }
                        (a, b) => assert_eq!(a, b, "{name}"),
                    }
                }
            }
        }
    }
}

fn expected_name(page: &Page, column: usize) -> String {
    format!("{:?}", page.rows[0][column])
}

fn largest(page: &Page, column: usize) -> f64 {
    let values = page.rows[1..].iter().filter_map(|row| match row[column] {
        Value::Number(x) => Some(x.abs()),
        _ => None,
    });
    values.fold(0.0, larger)
}

/// The program converts the unit at the end of a name. `N m` stays `N m` for any unit of length. A name that merely
/// ends like a unit has no unit.
#[test]
fn units_of_an_axle_are_converted_by_their_names() {
    let study = sample("macpherson_axle.toml");
    let header = [
        "rack_mm",
        "left_wheel_rate_N_per_mm",
        "roll_stiffness_N_m_per_deg",
        "ride_frequency_Hz",
        "left_roll_steer_deg_per_deg",
        "toe_d2_deg_per_mm2",
        "left_wheel_centre_vx_mm_per_s",
    ];
    let page = Page {
        name: "curves".to_owned(),
        rows: vec![
            header.map(|name| Value::Text(name.to_owned())).to_vec(),
            vec![Value::Number(127.0); header.len()],
        ],
    };
    let converted = |unit: LengthUnit| {
        let outgoing = Outgoing::of(&study, Some(unit), None);
        cells(&curves_in(&outgoing, page.clone()).rows)
    };
    let expected = [
        (
            LengthUnit::Metre,
            [0.127, 127e3, 127.0, 127.0, 127.0, 127e6, 0.127],
        ),
        (
            LengthUnit::Inch,
            [
                5.0,
                127.0 * 25.4,
                127.0,
                127.0,
                127.0,
                127.0 * 25.4 * 25.4,
                5.0,
            ],
        ),
    ];
    for (unit, expected) in expected {
        let found = converted(unit);
        assert_eq!(found[0][0], format!("rack_{}", unit.symbol()));
        assert_eq!(found[0][2], header[2]);
        assert_eq!(found[0][5], format!("toe_d2_deg_per_{}2", unit.symbol()));
        for (found, expected) in found[1].iter().zip(expected) {
            let found = found.parse::<f64>().unwrap();
            assert!(
                (found - expected).abs() <= 1e-12 * expected,
                "{found} {expected}"
            );
        }
    }
    // In a study in metres, the `m` of a torque is not the study's length unit.
    let in_metres = rewritten_unit(&study, LengthUnit::Metre);
    let outgoing = Outgoing::of(&in_metres, Some(LengthUnit::Millimetre), None);
    let names = [
        "track_m",
        "roll_stiffness_N_m_per_deg",
        "left_wheel_rate_N_per_m",
    ];
    let page = Page {
        name: "curves".to_owned(),
        rows: vec![
            names.map(|name| Value::Text(name.to_owned())).to_vec(),
            vec![Value::Number(2.0); 3],
        ],
    };
    let found = cells(&curves_in(&outgoing, page).rows);
    assert_eq!(
        found[0][..3],
        ["track_mm", names[1], "left_wheel_rate_N_per_mm"]
    );
    assert_eq!(found[1][..3], ["2000.0", "2.0", "0.002"]);
}

fn rewritten_unit(study: &Study, unit: LengthUnit) -> Study {
    let mut other = study.clone();
    other.wheel_mut().length_unit = unit;
    other
}

/// Curves of a run can have the names of other tools.
#[test]
fn curves_have_the_names_of_other_tools() {
    let names = [
        "travel_mm",
        "left_camber_deg",
        "right_toe_deg",
        "left_scrub_radius_mm",
        "roll_centre_height_mm",
        "status",
    ];
    let page = Page {
        name: "curves".to_owned(),
        rows: vec![
            names.map(|name| Value::Text(name.to_owned())).to_vec(),
            vec![
                Value::Number(1.0),
                Value::Number(-2.0),
                Value::Number(3.0),
                Value::Number(4.0),
                Value::Number(5.0),
                Value::Text("ok".to_owned()),
            ],
        ],
    };
    let axle = sample("macpherson_axle.toml");
    let outgoing = Outgoing::of(&axle, None, None);
    let (named, left_out) = under_names_of(Tool::Adams, &outgoing, &page);
    assert_eq!(
        cells(&named.rows),
        [
            [
                "travel_mm",
                "camber_angle.left [deg]",
                "toe_angle.right [deg]",
                "scrub_radius.left [mm]",
                "status"
            ],
            ["1.0", "-2.0", "3.0", "4.0", "ok"]
        ]
    );
    assert_eq!(left_out, ["roll_centre_height_mm"]);
    let (named, left_out) = under_names_of(Tool::Altair, &outgoing, &page);
    assert_eq!(
        cells(&named.rows),
        [
            ["travel_mm", "Right Toe-in Angle [deg]", "status"],
            ["1.0", "3.0", "ok"]
        ]
    );
    assert_eq!(left_out.len(), 3);
    // If the study has a single wheel, the exported names contain the side of this wheel.
    let mut corner = of_text(template("macpherson"));
    corner.wheel_mut().frame = Frame::new(FrameConvention::Iso8855, Side::Right);
    let outgoing = Outgoing::of(&corner, None, None);
    let page = page_of_csv("curves", b"travel_mm,camber_deg\n0,1\n").unwrap();
    let (named, _) = under_names_of(Tool::Adams, &outgoing, &page);
    assert_eq!(
        cells(&named.rows)[0],
        ["travel_mm", "camber_angle.right [deg]"]
    );
}

/// The export of a subsystem names, for each wheel, the points whose bodies the file cannot express.
#[test]
fn bodies_of_both_wheels_are_named() {
    let axle = include_str!("../../../studies/double_wishbone_axle.toml");
    let said = |text: &str| {
        let study = of_text(text);
        let outgoing = Outgoing::of(&study, None, None);
        hardpoint::exchange::subsystem(&outgoing).notes.join("\n")
    };
    assert!(said(axle).contains("[suspension.bodies]: drop_link_outer"));
    assert!(!said(axle).contains("right wheel"));
    let moved = "[axle.right.bodies]\nspring_lower = \"knuckle\"\n[axle]\n";
    let differs = axle
        .replace("[axle]\n", moved)
        .replace("right = \"mirrored\"", "");
    let right = said(&differs);
    assert!(
        right.contains("right wheel that differ from those of the other wheel: spring_lower"),
        "{right}"
    );
}
