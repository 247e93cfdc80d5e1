//! Tests in which a build equals the nominal design.

use super::{assembler, parameter, study};
use hardpoint::assembly::{Parts, Rest, built_curves};
use hardpoint::curves::curves;
use hardpoint::model::{Body, Constraint, Suspension};
use hardpoint::number::Vector3;
use hardpoint::plan::Plan;

const STUDIES: [&str; 6] = [
    "macpherson_solve",
    "double_wishbone_rocker",
    "five_link_solve",
    "semi_trailing_arm_solve",
    "integral_link_solve",
    "h_arm_solve",
];

/// Nominal parts assemble to the nominal design.
#[test]
fn drawn_parts_make_the_drawing() {
    for name in STUDIES {
        let study = study(name, &[]);
        let assembler = assembler(&study);
        let built = assembler
            .build(assembler.drawn(), Rest::Height(0.0))
            .unwrap();
        let (design, size) = (&study.wheel().design, study.wheel().size());
        for (drawn, built) in design.iter().zip(&built.suspension.design) {
            assert!((*drawn - *built).norm() < 1e-14 * size, "{name}");
        }
    }
}

/// Moves the link ends on an arm together with this arm. The link ends keep their coordinates in the frame of the arm's
/// axis and outer joint.
fn keep_links_in_arms(drawn: &Suspension, moved: &mut Suspension) {
    let mechanism = &drawn.mechanism;
    for (inner, _) in mechanism.constraints.iter().filter_map(Constraint::link) {
        let Body::Arm(arm) = mechanism.body(inner) else {
            continue;
        };
        let arm = mechanism.arms[arm.0];
        let frame = |design: &[Vector3<f64>]| {
            let [front, rear, joint] = [arm.front, arm.rear, arm.outer].map(|id| design[id.0]);
            let along = (rear - front).normalised();
            let across = along.cross(joint - front).normalised();
            (joint, [along, across, along.cross(across)])
        };
        let (joint, axes) = frame(&drawn.design);
        let lever = drawn.design[inner.0] - joint;
        let [a, b, c] = axes.map(|axis| axis.dot(lever));
        let (joint, [along, across, normal]) = frame(&moved.design);
        moved.design[inner.0] = joint + along * a + across * b + normal * c;
    }
}

/// If points on the body move and the lengths are changed to match, the built curves equal the curves of the moved design. This
/// includes the first and second derivatives with respect to the travel.
#[test]
fn with_everything_recut_the_build_is_the_moved_drawing() {
    // Skips the H-arm: no change of its parts can reproduce the design with the moved second joint. Skips the semi-trailing arm: it
    // has no lengths.
    let skipped = ["h_arm_solve", "semi_trailing_arm_solve"];
    for name in STUDIES.into_iter().filter(|name| !skipped.contains(name)) {
        let study = study(name, &["outputs.order=\"acceleration\""]);
        let assembler = assembler(&study);
        let suspension = assembler.suspension();
        let mut moved: Suspension = suspension.clone();
        // Moves only inner pick-ups: they are on the body, so no static angle changes.
        let body: Vec<usize> = (0..moved.design.len())
            .filter(|i| suspension.mechanism.points[*i].body == hardpoint::model::Body::Chassis)
            .filter(|i| {
                let name = &suspension.mechanism.points[*i].name;
                name.contains("lower_arm") || name.contains("lower_front_link_inner")
            })
            .collect();
        assert!(!body.is_empty(), "{name}");
        for (k, i) in body.iter().enumerate() {
            moved.design[*i].z += 1.5 + k as f64;
            moved.design[*i].y -= 0.5;
        }
        keep_links_in_arms(suspension, &mut moved);
        let mut parts = assembler.drawn().clone();
        let recut = Parts::drawn(&moved);
        for i in &body {
            parts.points[*i] = moved.design[*i];
        }
        parts.lengths = recut.lengths;
        let built = assembler.build(&parts, Rest::Height(0.0)).unwrap();
        let plan = Plan::of(study.one_wheel().unwrap());
        let found = built_curves(&assembler, &built, &plan, &[]).unwrap().curves;
        // If an arm's axis moves in the study, a nominal point on the arm keeps the coordinates of the study. A built point
        // moves with the arm. The test takes the built points.
        let mut expected = moved.clone();
        for (i, point) in moved.mechanism.points.iter().enumerate() {
            if !matches!(
                point.body,
                hardpoint::model::Body::Chassis
                    | hardpoint::model::Body::Knuckle
                    | hardpoint::model::Body::Rack
            ) {
                expected.design[i] = built.suspension.design[i];
            }
        }
        let expected = curves(&expected, &plan).unwrap();
        assert_eq!(found.stations.len(), expected.stations.len());
        let mut compared = 0;
        for (a, b) in found.stations.iter().zip(&expected.stations) {
            for (column, (a, b)) in a.values.iter().zip(&b.values).enumerate() {
                let (Ok(a), Ok(b)) = (a, b) else {
                    assert_eq!(a, b);
                    continue;
                };
                let off = (a - b).abs() / (1.0 + b.abs());
                assert!(
                    off < 1e-11,
                    "{name} {}: {a} {b}",
                    found.columns[column].name
                );
                compared += 1;
            }
        }
        assert!(compared > 100, "{name}: {compared}");
    }
}

/// The derivative with respect to a nominal point is a sum. One term is the derivative with respect to the part's
/// point. The other terms are the derivatives with respect to the lengths that depend on the nominal point.
#[test]
fn derivatives_by_the_drawing_are_a_chain_rule_on_those_by_parts() {
    for name in [
        "macpherson_solve",
        "double_wishbone_solve",
        "five_link_solve",
    ] {
        let inner = match name {
            "five_link_solve" => "lower_front_link_inner",
            _ => "lower_arm_front",
        };
        let study = study(
            name,
            &[
                "outputs.order=\"acceleration\"",
                &format!("outputs.sensitivities=[\"{inner}\"]"),
            ],
        );
        let assembler = assembler(&study);
        let built = assembler
            .build(assembler.drawn(), Rest::Height(0.0))
            .unwrap();
        let design = &study.wheel().design;
        let mechanism = &study.wheel().mechanism;
        let id = mechanism.point(inner).unwrap();
        let member = inner.strip_suffix("_inner").unwrap_or(inner);
        let length = parameter(&assembler, member, None);
        let hardpoint::assembly::BuildParameter::Length(link) = length else {
            unreachable!()
        };
        let (_, outer) = link.ends(mechanism).unwrap();
        let along = (design[id.0] - design[outer.0]).normalised().to_array();
        let plan = Plan::of(study.one_wheel().unwrap());
        let drawn = curves(study.wheel(), &plan).unwrap();
        let directions: Vec<_> = ["x", "y", "z"]
            .into_iter()
            .zip(along)
            .map(|(axis, along)| {
                let point = parameter(&assembler, inner, Some(axis));
                [(point, 1.0), (length, along)]
            })
            .collect();
        let directions: Vec<_> = directions.iter().map(|d| &d[..]).collect();
        let by_parts = built_curves(&assembler, &built, &plan, &directions).unwrap();
        // A point on the arm keeps its position relative to the arm, so the chain rule does not cover its columns.
        let on_arm = |column: usize| {
            let output = &drawn.columns[column].output;
            ["spring", "motion"].iter().any(|w| output.contains(w))
        };
        let mut compared = 0;
        for s in drawn.sensitivities.iter().filter(|s| !on_arm(s.column)) {
            let found = by_parts.derivative(s.axis as usize, s.station, s.column);
            let off = (found - s.value).abs() / (1e-3 + s.value.abs());
            assert!(
                off < 1e-8,
                "{name} {}: {found} {}",
                drawn.columns[s.column].name,
                s.value
            );
            compared += 1;
        }
        assert!(compared > 2000, "{name}: {compared}");
    }
}
