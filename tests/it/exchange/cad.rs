//! Tests of CAD files: closed solids, and drawings that join hardpoints.

use super::parsers::{all_ways, entities, of_text, pairs, template};
use super::round_trips::{changed, studies};
use crate::support::larger;
use hardpoint::exchange::{Envelope, Outgoing, Span, Tyre, drawing};
use hardpoint::model::{Axis, Frame, FrameConvention, LengthUnit, Side};
use hardpoint::number::Vector3;
use hardpoint::study::Study;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;

/// Each solid in the envelope of a tyre is closed and has outward faces. Its volume is that of its prism. It contains
/// the cylinder of the tyre at the pose of the solid.
#[test]
fn tyre_envelopes_are_closed_solids_about_the_wheel() {
    let text = template("double_wishbone");
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
                // The wheel centre is above its design position by the travel. Up is negative z in these axes.
                let frame = Frame::new(FrameConvention::SaeJ670, side);
                let id = study.wheel().mechanism.wheel_centre;
                let design = outgoing.position(side, id);
                let corners = solid.iter().flatten();
                let z: f64 = corners.clone().map(|p| f64::from(p[2])).sum();
                let z = z / corners.count() as f64;
                let travel = [-20.0, 0.0, 20.0][number % 3];
                let expected = design[2] + frame.sign(Axis::Z) * length(travel);
                assert!((z - expected).abs() < length(0.01), "{z} {expected}");
            }
            // STL files have a title with unit and frame.
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

/// A rack that moves to the left steers the wheels in the same direction, whatever the axes of the file.
#[test]
fn the_rack_of_an_envelope_goes_along_the_axis_of_the_file() {
    let template = of_text(template("double_wishbone"));
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
        // Sign of a rack displacement to the left in the axes of the file.
        let y = Frame::new(convention, Side::Left).sign(Axis::Y);
        let rack = Span {
            ends: [8.0 * y, 8.0 * y],
            values: 1,
        };
        let envelope = Envelope::of(&outgoing, tyre, still, rack).unwrap();
        let frame = Frame::new(convention, Side::Left);
        let point = |p: &[f32; 3]| frame.vector(Vector3::from(p.map(f64::from)));
        // Outboard centre of the cylinder, in the axes of the car.
        found.push(point(&envelope.solids[0][0][0]));
    }
    assert!(
        (found[0] - found[1]).norm_squared() < 1e-6 && (found[0] - found[2]).norm_squared() < 1e-6
    );
    let straight = Envelope::of(&Outgoing::of(&template, None, None), tyre, still, still).unwrap();
    let straight = Vector3::from(straight.solids[0][0][0].map(f64::from));
    assert!((found[0] - straight).norm_squared() > 1.0);
}

/// Asserts that every edge belongs to two triangles, which have opposite directions along the edge.
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

/// The envelope contains both wheels of a solid axle or twist beam at every combination of their travels. Each wheel
/// centre is above its design position by the travel of that wheel. A mirrored axle with swapped travels is the mirror
/// image. The wheel centres of an unsteered axle keep their distance.
#[test]
fn tyres_of_solid_axles_take_all_combinations_of_travels() {
    let steered = include_str!("../../../studies/off_road_car_front.toml");
    for (text, racks) in [
        (template("solid_axle"), 1),
        (template("twist_beam"), 1),
        (steered, 2),
    ] {
        let study = of_text(text);
        let outgoing = Outgoing::of(&study, None, Some(FrameConvention::Iso8855));
        let tyre = Tyre {
            radius: 300.0,
            width: 200.0,
        };
        let travel = Span {
            ends: [-30.0, 30.0],
            values: 3,
        };
        let rack = Span {
            ends: [-10.0 * f64::from(racks - 1), 0.0],
            values: racks as usize,
        };
        let envelope = Envelope::of(&outgoing, tyre, travel, rack).unwrap();
        let [left, right] = [0, 1].map(|side| {
            let each = envelope.solids.len() / 2;
            let solids = &envelope.solids[side * each..][..each];
            let centre = |solid: &Vec<[[f32; 3]; 3]>| {
                closed(solid);
                let [outer, inner] = [0, 1].map(|k| Vector3::from(solid[k][0].map(f64::from)));
                (outer + inner) * 0.5
            };
            solids.iter().map(centre).collect::<Vec<_>>()
        });
        assert_eq!(left.len(), 9 * racks as usize);
        let wheel_centre = study.wheel().mechanism.wheel_centre;
        let design = Side::ALL.map(|side| Vector3::from(outgoing.position(side, wheel_centre)));
        let apart = |a: Vector3<f64>, b: Vector3<f64>| (a - b).norm_squared().sqrt();
        let travels = [-30.0, 0.0, 30.0];
        // The file stores coordinates with 32 bits.
        for (number, (l, r)) in left.iter().zip(&right).enumerate() {
            let own = [travels[number / 3 % 3], travels[number % 3]];
            assert!((l.z - design[0].z - own[0]).abs() < 1e-3, "{number}: {l:?}");
            assert!((r.z - design[1].z - own[1]).abs() < 1e-3, "{number}: {r:?}");
            if racks == 1 {
                let other = right[3 * (number % 3) + number / 3];
                let mirrored = Vector3::new(other.x, -other.y, other.z);
                assert!(apart(*l, mirrored) < 1e-3, "{number}: {l:?} {other:?}");
            }
            if text == template("solid_axle") {
                assert!((apart(*l, *r) - apart(design[0], design[1])).abs() < 1e-3);
            }
        }
        if racks == 2 {
            // A displacement of the steering gear moves the tyre.
            assert!(apart(left[4], left[13]) > 0.1);
        }
    }
}

/// Volume enclosed by triangles. It is positive if their faces point outward.
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
    let arm = of_text(template("semi_trailing_arm"));
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
            .contains("this suspension is not steered")
    );
    let path = Path::new("studies/solid_axle_five_links.toml");
    let elastic = Study::read_elastic(path, &[]).unwrap();
    let elastic = Envelope::of(
        &Outgoing::of(&elastic, None, None),
        tyre,
        span(-10.0, 10.0),
        span(0.0, 0.0),
    );
    assert!(elastic.unwrap_err().contains("elastic parts"));
    let far = Envelope::of(&outgoing, tyre, span(-10.0, 4000.0), span(0.0, 0.0));
    let said = far.unwrap_err();
    assert!(said.contains("left wheel at travel 1995 mm"), "{said}");
}

/// Centre lines join hardpoints by name, on the layers of their bodies. Every point appears once with its name.
#[test]
fn drawings_join_hardpoints() {
    for study in studies().iter().step_by(7) {
        let outgoing = Outgoing::of(study, Some(LengthUnit::Inch), Some(FrameConvention::XRear));
        let (_, side) = study.wheel().frame.meaning();
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
        // Letters are 6 mm high in the file's unit.
        for text in of("TEXT") {
            assert!((text.number(40) - 6.0 / 25.4).abs() < 1e-15);
        }
        let said = of("TEXT")
            .into_iter()
            .find(|e| e.layer == "UNIT_AND_FRAME")
            .unwrap();
        assert_eq!(
            said.text,
            "unit in; frame x_rear: x rearward, y right, z up"
        );
        // The table of layers contains every used layer, and the header contains the unit.
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
    let wishbone = of_text(template("double_wishbone"));
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

/// Between the poses of the envelope, corners of the tyre can be outside the solids. Their distance is at most the
/// stated bound. More poses give a smaller bound.
#[test]
fn the_gap_between_poses_is_bounded() {
    assert_gap_is_bounded("double_wishbone", 20.0);
    assert_gap_is_bounded("solid_axle", 0.0);
}

fn assert_gap_is_bounded(topology: &str, rack: f64) {
    let study = of_text(template(topology));
    let outgoing = Outgoing::of(&study, None, None);
    let tyre = Tyre {
        radius: 300.0,
        width: 200.0,
    };
    let envelope = |values: usize| {
        let span = |end: f64| Span {
            ends: [-end, end],
            values,
        };
        Envelope::of(&outgoing, tyre, span(40.0), span(rack)).unwrap()
    };
    let (coarse, dense) = (envelope(3), envelope(9));
    assert!(dense.gap() < 0.3 * coarse.gap());
    let point = |p: [f32; 3]| Vector3::from(p.map(f64::from));
    // Centre and axis of each solid, from the centres of its two end faces.
    let cylinders = coarse.solids.iter().map(|solid| {
        let [outer, inner] = [point(solid[0][0]), point(solid[1][0])];
        ((outer + inner) * 0.5, (outer - inner) * (1.0 / tyre.width))
    });
    let cylinders: Vec<_> = cylinders.collect();
    let radius = tyre.radius / (PI / 96.0).cos();
    let outside = |p: Vector3<f64>| {
        let of_one = cylinders.iter().map(|(centre, axis)| {
            let from = p - *centre;
            let along = from.dot(*axis);
            let radial = (from.norm_squared() - along * along).max(0.0).sqrt();
            let [a, b] = [radial - radius, along.abs() - 0.5 * tyre.width].map(|d| d.max(0.0));
            a.hypot(b)
        });
        of_one.fold(f64::INFINITY, f64::min)
    };
    let corners = dense.solids.iter().flatten().flatten();
    let farthest = corners.map(|p| outside(point(*p))).fold(0.0, larger);
    assert!(
        farthest > 1.0 && farthest <= coarse.gap(),
        "{farthest} {}",
        coarse.gap()
    );
}
