//! Files for other tools, read back by small parsers of their own: planted lengths in every unit, signs in every frame,
//! solids and drawings that close, curves that are those of the study written in the other unit and axes.

use super::round_trips::{changed, studies};
use hardpoint::exchange::{
    Envelope, Outgoing, Page, Span, Tool, Tyre, Value, csv, curves_in, drawing, optimum_k_rows,
    page_of_csv, suspensions_ini, under_names_of,
};
use hardpoint::model::{Axis, Frame, FrameConvention, LengthUnit, Side};
use hardpoint::number::Vector3;
use hardpoint::solved::Solved;
use hardpoint::study::Study;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;

fn sample(name: &str) -> Study {
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
    let text = std::fs::read_to_string(samples.join(name)).unwrap();
    Study::from_text(name, &text, &samples).unwrap()
}

fn of_text(text: &str) -> Study {
    Study::from_text("s.toml", text, Path::new(".")).unwrap()
}

/// A text of the rows of a page, cell by cell.
fn cells(rows: &[Vec<Value>]) -> Vec<Vec<String>> {
    let text = String::from_utf8(csv(rows)).unwrap();
    let lines = text
        .lines()
        .map(|line| line.split(',').map(str::to_owned).collect());
    lines.collect()
}

fn all_ways() -> impl Iterator<Item = (LengthUnit, FrameConvention, Side)> {
    let both = |unit| FrameConvention::ALL.map(|convention| (unit, convention));
    let pairs = LengthUnit::ALL.into_iter().flat_map(both);
    pairs.flat_map(|(unit, convention)| Side::ALL.map(|side| (unit, convention, side)))
}

/// The pairs of a drawing: a code, and the value on the line below.
fn pairs(drawing: &[u8]) -> Vec<(u32, String)> {
    let text = std::str::from_utf8(drawing).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let (pairs, rest) = lines.as_chunks::<2>();
    assert!(rest.is_empty());
    let pair = |[code, value]: &[&str; 2]| (code.trim().parse().unwrap(), (*value).to_owned());
    pairs.iter().map(pair).collect()
}

/// An entity of a drawing: its kind, layer, places by code, text.
#[derive(Clone, Debug, Default)]
struct Entity {
    kind: String,
    layer: String,
    numbers: BTreeMap<u32, f64>,
    text: String,
}

impl Entity {
    fn place(&self, first: u32) -> [f64; 3] {
        [0, 10, 20].map(|axis| self.numbers[&(first + axis)])
    }
}

fn entities(drawing: &[u8]) -> Vec<Entity> {
    let pairs = pairs(drawing);
    let begins = pairs.iter().position(|(_, value)| value == "ENTITIES");
    let mut entities: Vec<Entity> = Vec::new();
    for (code, value) in &pairs[begins.unwrap() + 1..] {
        match code {
            0 if value == "ENDSEC" => break,
            0 => entities.push(Entity {
                kind: value.clone(),
                ..Entity::default()
            }),
            8 => entities.last_mut().unwrap().layer.clone_from(value),
            1 => entities.last_mut().unwrap().text.clone_from(value),
            code => {
                let number = value.parse().unwrap();
                entities.last_mut().unwrap().numbers.insert(*code, number);
            }
        }
    }
    entities
}

fn close(a: [f64; 3], b: [f64; 3], within: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= within)
}

/// Lengths of 508 mm, 0.508 m and 20 in are one length in each of the files, whichever of them the study is written in.
#[test]
fn planted_lengths_are_right_in_every_file_and_unit() {
    let template = hardpoint::model::Topology::named("double_wishbone").unwrap();
    let study = of_text(template.template);
    let mut design = study.suspension.design.clone();
    let id = study.suspension.mechanism.point("wheel_centre").unwrap();
    design[id.0].y = 508.0;
    let inner = study.suspension.mechanism.point("spindle_inner").unwrap();
    design[inner.0].y = 408.0;
    let planted = study.at_design(design);
    let twenty = [508.0, 0.508, 20.0];
    for (own, _) in LengthUnit::ALL.into_iter().zip(twenty) {
        let mut study = planted.clone();
        let length = |x: f64| own.convert(x, LengthUnit::Millimetre);
        let points = planted.suspension.design.iter();
        study.suspension.design = points.map(|p| p.map(length)).collect();
        study.suspension.wheel_radius = Some(length(254.0));
        study.suspension.tyre_width = Some(length(127.0));
        study.suspension.length_unit = own;
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

            // A wheel that stands straight: half track and diameter are those of the wheel centre.
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

            // Always metres there.
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

/// In its axes each file has the wheel on the right side, ahead and above.
#[test]
fn files_have_the_signs_of_their_axes() {
    let template = hardpoint::model::Topology::named("double_wishbone").unwrap();
    let study = of_text(template.template);
    for (unit, convention, side) in all_ways() {
        let study = changed(&study, unit, convention, side);
        for out in FrameConvention::ALL {
            let outgoing = Outgoing::of(&study, None, Some(out));
            let left = if side == Side::Left { 1.0 } else { -1.0 };
            // x, y and z of a point ahead, on this wheel's side, above.
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

/// A study as its author would have written it in another unit and other axes.
fn rewritten(study: &Study, unit: LengthUnit, convention: FrameConvention) -> Study {
    let own = study.suspension.length_unit;
    let (_, side) = study.suspension.frame.meaning();
    let length = |x: f64| unit.convert(x, own);
    let mut other = study.clone();
    let suspension = &mut other.suspension;
    suspension.design = study
        .suspension
        .design
        .iter()
        .map(|p| p.map(length))
        .collect();
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
    let along = study.suspension.frame.sign(Axis::Y) * suspension.frame.sign(Axis::Y);
    other.motion.values = study.motion.values.iter().map(|x| length(*x)).collect();
    other.motion.rack = study
        .motion
        .rack
        .iter()
        .map(|x| along * length(*x))
        .collect();
    other
}

/// Coordinates, angular velocities, racks, angles and gains with their derivatives: the columns of a study in other units
/// and axes are what that study, written in them, is solved to.
#[test]
fn curves_are_those_of_the_study_in_the_other_unit_and_axes() {
    let template = hardpoint::model::Topology::named("double_wishbone")
        .unwrap()
        .template;
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
                        // The travel is the wheel centre's height: its second derivative is rounding.
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
    values.fold(0.0, f64::max)
}

/// Newton metres are printed in metres whatever the unit of length; a name that ends as a unit does is no unit.
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
    // From metres: `m` in a torque is none of the study's lengths.
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
    other.suspension.length_unit = unit;
    other
}

/// The envelope of a tyre: each solid closed, outward, of the volume of its prism, around the wheel of its pose.
#[test]
fn tyre_envelopes_are_closed_solids_about_the_wheel() {
    let text = hardpoint::model::Topology::named("double_wishbone")
        .unwrap()
        .template;
    let template = of_text(text);
    for (unit, convention, side) in all_ways().step_by(3) {
        let study = changed(&template, unit, convention, side);
        for out in LengthUnit::ALL {
            let outgoing = Outgoing::of(&study, Some(out), Some(FrameConvention::SaeJ670));
            let length = |mm: f64| out.convert(mm, LengthUnit::Millimetre);
            let tyre = Tyre {
                radius: length(300.0),
                width: length(200.0),
            };
            let travel = Span {
                ends: [length(-20.0), length(20.0)],
                values: 3,
            };
            let rack = Span {
                ends: [length(-8.0), length(8.0)],
                values: 3,
            };
            let envelope = Envelope::of(&outgoing, tyre, travel, rack).unwrap();
            assert_eq!(envelope.solids.len(), 9);
            for (number, solid) in envelope.solids.iter().enumerate() {
                closed(solid);
                let prism = 96.0 * (PI / 96.0).tan() * tyre.radius.powi(2) * tyre.width;
                assert!(
                    (volume(solid) / prism - 1.0).abs() < 1e-4,
                    "{}",
                    volume(solid)
                );
                // The wheel centre is up by the travel: downward in these axes.
                let frame = Frame::new(FrameConvention::SaeJ670, side);
                let id = study.suspension.mechanism.wheel_centre;
                let design = outgoing.position(side, id);
                let corners = solid.iter().flatten();
                let z: f64 = corners.clone().map(|p| f64::from(p[2])).sum();
                let z = z / corners.count() as f64;
                let travel = [-20.0, 0.0, 20.0][number % 3];
                let expected = design[2] + frame.sign(Axis::Z) * length(travel);
                assert!((z - expected).abs() < length(0.01), "{z} {expected}");
            }
            // The rack goes along the file's y: rearward and forward steer are mirror poses of each other's side.
            let stl = envelope.stl();
            assert_eq!(stl.len(), 84 + 50 * envelope.triangles());
            let title = std::str::from_utf8(&stl[..80]).unwrap();
            assert!(
                title.contains(&format!("unit {}; frame sae_j670", out.symbol())),
                "{title}"
            );
            assert!(!title.starts_with("solid"));
        }
    }
}

/// A rack that moves to the left turns the wheels the same way, in whichever axes the file is.
#[test]
fn the_rack_of_an_envelope_goes_along_the_axis_of_the_file() {
    let template = of_text(
        hardpoint::model::Topology::named("double_wishbone")
            .unwrap()
            .template,
    );
    let still = Span {
        ends: [0.0; 2],
        values: 1,
    };
    let tyre = Tyre {
        radius: 300.0,
        width: 200.0,
    };
    let mut found = Vec::new();
    for convention in FrameConvention::ALL {
        let outgoing = Outgoing::of(&template, None, Some(convention));
        // To the left.
        let y = Frame::new(convention, Side::Left).sign(Axis::Y);
        let rack = Span {
            ends: [8.0 * y, 8.0 * y],
            values: 1,
        };
        let envelope = Envelope::of(&outgoing, tyre, still, rack).unwrap();
        let frame = Frame::new(convention, Side::Left);
        let point = |p: &[f32; 3]| frame.vector(Vector3::from(p.map(f64::from)));
        // The outboard centre of the cylinder, seen from the car.
        found.push(point(&envelope.solids[0][0][0]));
    }
    assert!(
        (found[0] - found[1]).norm_squared() < 1e-6 && (found[0] - found[2]).norm_squared() < 1e-6
    );
    let straight = Envelope::of(&Outgoing::of(&template, None, None), tyre, still, still).unwrap();
    let straight = Vector3::from(straight.solids[0][0][0].map(f64::from));
    assert!((found[0] - straight).norm_squared() > 1.0);
}

/// Every edge belongs to two triangles, which run along it in opposite directions.
fn closed(solid: &[[[f32; 3]; 3]]) {
    let mut edges: BTreeMap<[[u32; 3]; 2], i32> = BTreeMap::new();
    for triangle in solid {
        for k in 0..3 {
            let ends = [k, (k + 1) % 3].map(|k| triangle[k].map(f32::to_bits));
            assert_ne!(ends[0], ends[1]);
            *edges.entry(ends).or_default() += 1;
        }
    }
    for ([a, b], count) in &edges {
        assert_eq!((*count, edges.get(&[*b, *a])), (1, Some(&1)));
    }
}

/// The volume that triangles enclose, positive if they are seen from outside.
fn volume(solid: &[[[f32; 3]; 3]]) -> f64 {
    let origin = Vector3::from(solid[0][0].map(f64::from));
    let six = solid.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|p| Vector3::from(p.map(f64::from)) - origin);
        a.dot(b.cross(c))
    });
    six.sum::<f64>() / 6.0
}

#[test]
fn envelopes_that_cannot_be_are_refused_by_name() {
    let arm = of_text(
        hardpoint::model::Topology::named("semi_trailing_arm")
            .unwrap()
            .template,
    );
    let outgoing = Outgoing::of(&arm, None, None);
    let tyre = Tyre {
        radius: 300.0,
        width: 200.0,
    };
    let span = |a: f64, b: f64| Span {
        ends: [a, b],
        values: 3,
    };
    let steered = Envelope::of(&outgoing, tyre, span(-10.0, 10.0), span(-5.0, 5.0));
    assert!(
        steered
            .unwrap_err()
            .contains("no point of this suspension is on the rack")
    );
    let far = Envelope::of(&outgoing, tyre, span(-10.0, 4000.0), span(0.0, 0.0));
    let said = far.unwrap_err();
    assert!(said.contains("left wheel at travel 1995 mm"), "{said}");
}

/// Centre lines join hardpoints by name, on the layers of their bodies; every point is there once with its name.
#[test]
fn drawings_join_hardpoints() {
    for study in studies().iter().step_by(7) {
        let outgoing = Outgoing::of(study, Some(LengthUnit::Inch), Some(FrameConvention::XRear));
        let (_, side) = study.suspension.frame.meaning();
        let entities = entities(&drawing(&outgoing));
        let of = |kind: &str| {
            entities
                .iter()
                .filter(|e| e.kind == kind)
                .collect::<Vec<_>>()
        };
        let points: Vec<_> = outgoing.points(side).collect();
        assert_eq!(of("POINT").len(), points.len());
        for (name, _, position) in &points {
            let text = of("TEXT").into_iter().find(|e| e.text == *name).unwrap();
            assert_eq!((text.place(10), text.layer.as_str()), (*position, "NAMES"));
        }
        let is_point = |place: [f64; 3]| points.iter().any(|(_, _, known)| *known == place);
        for line in of("LINE") {
            let [from, to] = [10, 11].map(|code| line.place(code));
            assert!(
                is_point(to) && (is_point(from) || line.layer == "SPIN_AXIS"),
                "{line:?}"
            );
        }
        let said = of("TEXT")
            .into_iter()
            .find(|e| e.layer == "UNIT_AND_FRAME")
            .unwrap();
        assert_eq!(
            said.text,
            "unit in; frame x_rear: x rearward, y right, z up"
        );
        // Every layer that is used is in the table of layers, and the unit is said there too.
        let pairs = pairs(&drawing(&outgoing));
        let insunits = pairs
            .iter()
            .position(|(_, value)| value == "$INSUNITS")
            .unwrap();
        assert_eq!(pairs[insunits + 1], (70, "1".to_owned()));
        for entity in &entities {
            assert!(
                pairs
                    .iter()
                    .any(|(code, value)| *code == 2 && *value == entity.layer)
            );
        }
    }
    let wishbone = of_text(
        hardpoint::model::Topology::named("double_wishbone")
            .unwrap()
            .template,
    );
    let outgoing = Outgoing::of(&wishbone, None, None);
    let at = |name: &str| {
        outgoing
            .points(Side::Left)
            .find(|(n, ..)| *n == name)
            .unwrap()
            .2
    };
    let drawn = entities(&drawing(&outgoing));
    for (layer, from, to) in [
        ("LOWER_ARM", "lower_arm_front", "lower_ball_joint"),
        ("UPPER_ARM", "upper_ball_joint", "upper_arm_rear"),
        ("TIE_ROD", "tie_rod_inner", "tie_rod_outer"),
    ] {
        let line = drawn.iter().find(|e| {
            let ends = (e.kind == "LINE").then(|| [e.place(10), e.place(11)]);
            ends.is_some_and(|ends| ends == [at(from), at(to)] || ends == [at(to), at(from)])
        });
        assert_eq!(line.unwrap().layer, layer);
    }
}

/// Double wishbones as OptimumKinematics has them: the points of both wheels, the wheel by its contact point, toe-out
/// positive.
#[test]
fn optimum_k_tables_hold_the_wheel() {
    let mut count = 0;
    for study in studies() {
        let suspension = &study.suspension;
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
            // The wheel centre from the contact point, by the reader's equation.
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
    // Toe-in of 0.3 degrees is written as -0.3.
    let text = hardpoint::model::Topology::named("double_wishbone")
        .unwrap()
        .template;
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

/// Rod, rocker and spring of a pushrod, with the part that the rod is mounted on.
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
    let id = study.suspension.mechanism.point("pushrod_outer").unwrap();
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

/// Every wishbone and strut in `suspensions.ini`, put together again from the wheel centre: the same points.
#[test]
fn suspensions_ini_holds_the_points() {
    let mut kinds = BTreeMap::new();
    for study in studies() {
        let suspension = &study.suspension;
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
            // x inboard, y up, z forward of the wheel centre.
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

/// BASEY is the height of the wheel centre over the centre of gravity: radius times the cosine of camber, less its height.
#[test]
fn heights_of_suspensions_ini_are_from_the_centre_of_gravity() {
    let mut study = of_text(
        hardpoint::model::Topology::named("macpherson")
            .unwrap()
            .template,
    );
    study.suspension.wheel_radius = Some(300.0);
    study.suspension.vehicle.cg_height = Some(550.0);
    study.suspension.vehicle.wheelbase = Some(2600.0);
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

/// The curves of a run under the names of other tools.
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
    // A corner has the side of its study.
    let mut corner = of_text(
        hardpoint::model::Topology::named("macpherson")
            .unwrap()
            .template,
    );
    corner.suspension.frame = Frame::new(FrameConvention::Iso8855, Side::Right);
    let outgoing = Outgoing::of(&corner, None, None);
    let page = page_of_csv("curves", b"travel_mm,camber_deg\n0,1\n").unwrap();
    let (named, _) = under_names_of(Tool::Adams, &outgoing, &page);
    assert_eq!(
        cells(&named.rows)[0],
        ["travel_mm", "camber_angle.right [deg]"]
    );
}
