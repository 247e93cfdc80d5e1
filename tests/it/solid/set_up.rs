//! Tests of set-ups of solid axles: geometry of the adjusted axle, first-order effects, halves and parts that exist once.

use super::kinds::{KINDS, Kind};
use hardpoint::axle::{Placement, axle_curves};
use hardpoint::model::{Side, Suspension};
use hardpoint::number::Vector3;
use hardpoint::report::SetUpSummary;
use hardpoint::set_up::{FoundSetUp, Refusal, set_up};
use hardpoint::study::{AxleStudy, Study};
use std::path::Path;

const ROLL: &str = "roll = [-2.0, 0.0, 1.5]\nheave = [0.0]\n";
const OUTPUTS: &str = "\"camber\", \"toe\", \"mean_steer\", \"track\"";

/// Study with this set-up.
fn study(kind: &Kind, setup: &str) -> Result<Study, String> {
    let scatter = "{ length = \"lower_link\", sigma = 0.1 }";
    let text = kind.study_of((scatter, ""), ROLL, OUTPUTS).text;
    let text = format!("{text}[setup]\n{setup}\n");
    Study::from_text("solid.toml", &text, Path::new(".")).map_err(|e| e.to_string())
}

fn found(kind: &Kind, setup: &str) -> FoundSetUp {
    let study = study(kind, setup).unwrap_or_else(|e| panic!("{}: {e}", kind.name));
    let found = set_up(&study, study.setup.as_ref().unwrap());
    found.unwrap_or_else(|why| panic!("{}: {}", kind.name, why.reason()))
}

/// Adjustments for the four values of the axle, and for both toes if it is steered.
fn adjust(kind: &Kind) -> String {
    let lateral = match kind.name {
        "four links and an anti-roll bar" => "",
        "Panhard rod, drag link and tie rod" => {
            "{ length = \"panhard\" }, { length = \"drag_link\" }, { length = \"tie_rod\" },"
        }
        _ => "{ length = \"watt_lower\" },",
    };
    format!("adjust = [{lateral} {{ length = \"lower_link\" }}, {{ length = \"upper_link\" }}]")
}

/// Returns the target values. Their changes are multiplied by `scale`.
fn want(kind: &Kind, scale: f64) -> Vec<(&'static str, f64)> {
    let mut want = vec![
        ("axle_steer", 0.15),
        ("axle_lateral", 1.5),
        ("axle_longitudinal", -2.0),
        ("pinion_angle", 0.8),
    ];
    for (_, value) in &mut want {
        *value *= scale;
    }
    if kind.is_steered() {
        // Without a set-up the toe is 0.1 deg, so `scale` multiplies only the change of 0.2 deg.
        want.extend([
            ("left_toe", 0.1 + 0.2 * scale),
            ("right_toe", 0.1 + 0.2 * scale),
        ]);
    }
    want
}

fn table(want: &[(&str, f64)]) -> String {
    let entries = want.iter().filter(|(name, _)| !name.starts_with("right_"));
    let entries =
        entries.map(|(name, value)| format!("{} = {value:?}", name.trim_start_matches("left_")));
    format!("want = {{ {} }}", entries.collect::<Vec<_>>().join(", "))
}

fn both(study: &Study) -> &AxleStudy {
    study.axle().unwrap()
}

fn place(suspension: &Suspension, name: &str) -> Vector3<f64> {
    let point = suspension.mechanism.point(name);
    suspension.design[point.unwrap_or_else(|| panic!("no {name}")).0]
}

/// Column of a summary's static value.
pub(super) fn column(summary: &SetUpSummary, name: &str) -> usize {
    let of_name = |column: &str| {
        column
            .strip_prefix(name)
            .is_some_and(|unit| unit.starts_with('_'))
    };
    let place = summary.statics.iter().position(|s| of_name(&s.column));
    place.unwrap_or_else(|| panic!("no {name}"))
}

/// Amount of an adjustment. 0 for a part that is not adjusted.
fn amount(summary: &SetUpSummary, kind: &Kind, member: &str) -> f64 {
    let name = match member.strip_prefix("right_") {
        Some(name) => format!("right {name}"),
        None if kind
            .members()
            .iter()
            .any(|(own, _)| *own == format!("right_{member}")) =>
        {
            format!("left {member}")
        }
        None => member.to_owned(),
    };
    let own = summary.adjustments.iter().find(|a| a.adjustment == name);
    own.map_or(0.0, |a| a.amount)
}

/// If there are as many adjustments as targets, the adjusted axle has all target values. The test computes pitch,
/// direction and position of the axle from its points, and reads toe from the curves. Only the adjusted lengths have
/// changed, by their amounts. The points of the body and the shape of the axle are unchanged.
#[test]
fn the_adjusted_axle_has_the_wanted_values() {
    for kind in KINDS {
        let want = want(kind, 1.0);
        let found = found(kind, &format!("{}\n{}", adjust(kind), table(&want)));
        let [summary] = &found.wheels[..] else {
            panic!("a solid axle is set up as a whole");
        };
        for (name, value) in &want {
            let own = &summary.statics[column(summary, name)];
            assert!(
                (own.set.unwrap() - value).abs() < 1e-9,
                "{}, {name}",
                kind.name
            );
            assert!(own.met && (own.wanted.unwrap() - value).abs() < 1e-14);
        }
        let nominal = both(&kind.study_of(
            ("{ length = \"lower_link\", sigma = 0.1 }", ""),
            ROLL,
            OUTPUTS,
        ))
        .axle
        .left
        .clone();
        let adjusted = &both(&found.adjusted).axle.left;
        for name in kind.on_body().flat_map(|name| kind.both(name)) {
            let moved = (place(adjusted, &name) - place(&nominal, &name)).norm();
            assert!(moved < 1e-12, "{}: {name} {moved:e}", kind.name);
        }
        // The left wheel's mechanism contains only its own lever of the anti-roll bar, so the test skips the right drop
        // link.
        let members = kind.members().into_iter();
        for (member, [inner, outer]) in members.filter(|(name, _)| name != "right_drop_link") {
            let [before, after] =
                [&nominal, adjusted].map(|own| (place(own, &outer) - place(own, &inner)).norm());
            let miss = after - before - amount(summary, kind, &member);
            assert!(miss.abs() < 1e-9, "{}: {member} {miss:e}", kind.name);
        }
        let on_axle: Vec<String> = kind.on_axle().flat_map(|name| kind.both(name)).collect();
        for (k, a) in on_axle.iter().enumerate() {
            for b in &on_axle[..k] {
                let [before, after] =
                    [&nominal, adjusted].map(|own| (place(own, a) - place(own, b)).norm());
                assert!((before - after).abs() < 1e-9, "{}: {a} {b}", kind.name);
            }
        }
        // Columns of the axle's rotation matrix, from three points of the axle.
        let frame = |own: &Suspension| {
            let [a, b, c] = [
                "lower_link_axle",
                "right_lower_link_axle",
                "upper_link_axle",
            ]
            .map(|name| place(own, name));
            let u = (b - a).normalised();
            let w = u.cross(c - a).normalised();
            [u, w.cross(u), w]
        };
        let (before, after) = (frame(&nominal), frame(adjusted));
        let turned = |v: Vector3<f64>| {
            let parts = before.iter().zip(after).map(|(b, a)| a * b.dot(v));
            parts.fold(Vector3::default(), |sum, part| sum + part)
        };
        let (forward, line) = (
            turned(Vector3::new(1.0, 0.0, 0.0)),
            turned(Vector3::new(0.0, 1.0, 0.0)),
        );
        let middle = |own: &Suspension| {
            (place(own, "wheel_centre") + place(own, "right_wheel_centre")) * 0.5
        };
        let moved = middle(adjusted) - middle(&nominal);
        let own = [
            (-line.x).atan2(line.y).to_degrees(),
            moved.y,
            moved.x,
            forward.z.atan2(forward.x).to_degrees(),
        ];
        for ((name, value), own) in want.iter().zip(own) {
            assert!((own - value).abs() < 1e-9, "{}: {name} {own}", kind.name);
        }
        assert!(moved.z.abs() < 1e-9);
        let both = both(&found.adjusted);
        let curves = axle_curves(&both.axle, &both.plan).unwrap().curves;
        let placements = both.plan.motion.placements().into_iter();
        let at_rest = placements.map(|placement| match placement {
            Placement::Roll { heave, roll, rack } => [heave, roll, rack] == [0.0; 3],
            _ => false,
        });
        let station = &curves.stations[at_rest
            .collect::<Vec<_>>()
            .iter()
            .position(|is| *is)
            .unwrap()];
        for (k, own) in curves.columns.iter().enumerate() {
            if let Some(value) = summary.statics.iter().find(|s| s.column == own.name) {
                let miss = station.value(k).unwrap() - value.set.unwrap();
                assert!(miss.abs() < 1e-9, "{}: {} {miss:e}", kind.name, own.name);
            }
        }
    }
}

/// Returns the prediction error of each static value: its change minus the change that the effects at the nominal
/// design predict.
pub(super) fn linear_remainders(summary: &SetUpSummary) -> Vec<f64> {
    let remainder = |i: usize| {
        let own = &summary.statics[i];
        let by = summary.adjustments.iter();
        let linear: f64 = by.map(|a| a.amount * a.by_length[i].unwrap()).sum();
        own.set.unwrap() - own.nominal.unwrap() - linear
    };
    (0..summary.statics.len()).map(remainder).collect()
}

/// Asserts that halved changes give a quarter of the remainders, or an eighth if the second-order terms are zero.
/// Remainders below `least` are rounding errors. Returns the number of larger remainders.
pub(super) fn quarters([whole, half]: [&[f64]; 2], least: f64, name: &str) -> usize {
    let mut looked_at = 0;
    for (i, (whole, half)) in whole.iter().zip(half).enumerate() {
        if whole.abs() < least {
            assert!(half.abs() < least, "{name}, value {i}: {whole:e} {half:e}");
            continue;
        }
        let ratio = half / whole;
        assert!(
            (0.12..0.28).contains(&ratio),
            "{name}, value {i}: {whole:e} {half:e}"
        );
        looked_at += 1;
    }
    looked_at
}

/// The effects at the design predict every static value to first order. If the target changes are halved, the prediction
/// error is a quarter.
#[test]
fn effects_predict_to_first_order() {
    for kind in KINDS {
        let remainders = |scale: f64| -> Vec<f64> {
            let found = found(
                kind,
                &format!("{}\n{}", adjust(kind), table(&want(kind, scale))),
            );
            let summary = &found.wheels[0];
            linear_remainders(summary)
        };
        let [whole, half] = [1.0, 0.5].map(remainders);
        let looked_at = quarters([&whole, &half], 1e-6, kind.name);
        assert!(looked_at >= 4, "{}: {looked_at}", kind.name);
    }
}

/// If parts of one half are adjusted, a symmetric axle turns to one side. If the same parts of the other half are
/// adjusted, the axle turns to the other side by the same angle.
#[test]
fn halves_are_mirror_images() {
    let kind = &KINDS[0];
    let of_side = |side: Side, sign: f64| {
        let side = side.name();
        let setup = format!(
            "adjust = [{{ length = \"lower_link\", per_turn = 2.0, side = \"{side}\" }}, \
             {{ shim = \"upper_link_axle\", axis = \"y\", side = \"{side}\" }}]\n\
             want = {{ axle_steer = {:?}, pinion_angle = 0.4 }}",
            0.2 * sign
        );
        found(kind, &setup).wheels[0].clone()
    };
    let (left, right) = (of_side(Side::Left, 1.0), of_side(Side::Right, -1.0));
    assert!(left.statics.iter().all(|s| s.met));
    for (left, right) in left.adjustments.iter().zip(&right.adjustments) {
        assert_eq!(left.adjustment.replace("left", "right"), right.adjustment);
        assert_eq!(left.instruction, right.instruction);
        assert!((left.amount - right.amount).abs() < 1e-9);
        assert!(left.amount.abs() > 0.1, "{}", left.instruction);
    }
    for (name, mirror, sign) in [
        ("left_camber", "right_camber", 1.0),
        ("left_toe", "right_toe", 1.0),
        ("axle_lateral", "axle_lateral", -1.0),
        ("axle_longitudinal", "axle_longitudinal", 1.0),
    ] {
        let value = |of: &SetUpSummary, name: &str| of.statics[column(of, name)].set.unwrap();
        let miss = value(&left, name) - sign * value(&right, mirror);
        assert!(miss.abs() < 1e-9, "{name}: {miss:e}");
    }
}

/// A Panhard rod alone moves the axle sideways. If other parts are adjusted, drag link and tie rod keep the toe of both
/// wheels. Shims are whole numbers.
#[test]
fn single_parts_and_kept_toe() {
    let steered = KINDS.iter().find(|kind| kind.is_steered()).unwrap();
    let alone = found(
        steered,
        "adjust = [{ length = \"panhard\", per_turn = 2.5 }]\nwant = { axle_lateral = -3.0 }\nride_height_change = 20.0",
    );
    let summary = &alone.wheels[0];
    assert_eq!(summary.adjustments.len(), 1);
    assert_eq!(summary.adjustments[0].adjustment, "panhard");
    assert!(summary.adjustments[0].instruction.starts_with("shorten by"));
    let value = |name: &str| &summary.statics[column(summary, name)];
    assert!((value("axle_lateral").set.unwrap() + 3.0).abs() < 1e-9);
    assert_eq!(value("ride_height_change").set, Some(20.0));
    let [nominal, adjusted] = [
        study(steered, "adjust = [{ length = \"panhard\" }]").unwrap(),
        alone.adjusted.clone(),
    ]
    .map(|own| {
        ["wheel_centre", "right_wheel_centre"].map(|name| place(&both(&own).axle.left, name).z)
    });
    for (before, after) in nominal.iter().zip(adjusted) {
        assert!((after - before + 20.0).abs() < 1e-9, "{before} {after}");
    }

    let kept = found(
        steered,
        "adjust = [{ shim = \"upper_link_chassis\", axis = \"x\", step = 1.0 }, { length = \"panhard\" }, \
         { length = \"tie_rod\", per_turn = 3.0 }, { length = \"drag_link\", per_turn = 3.0 }]\n\
         want = { axle_lateral = 2.0, pinion_angle = 1.0 }",
    );
    let summary = &kept.wheels[0];
    assert!(summary.met, "{summary:?}");
    for name in ["left_toe", "right_toe"] {
        let own = &summary.statics[column(summary, name)];
        assert!(own.kept && (own.set.unwrap() - own.nominal.unwrap()).abs() < 1e-9);
    }
    let shim = &summary.adjustments[0];
    assert_eq!(shim.adjustment, "upper_link_chassis x");
    assert!(shim.shims.unwrap().abs() > 1.0 && shim.instruction.contains("shims"));
}

/// Refusals name the entry and the reason. If no adjustment changes a target, the message states the value of the target.
#[test]
fn refusals_have_reasons() {
    let steered = KINDS.iter().find(|kind| kind.is_steered()).unwrap();
    let refused = |kind: &Kind, setup: &str| study(kind, setup).unwrap_err();
    for (kind, setup, reason) in [
        (
            steered,
            "adjust = [{ length = \"panhard\", side = \"left\" }]",
            "the axle has only one panhard: remove the key \"side\"",
        ),
        (
            steered,
            "adjust = [{ length = \"lower_link\" }, { length = \"lower_link\", side = \"right\" }]",
            "right lower_link is already adjusted",
        ),
        (
            &KINDS[0],
            "adjust = [{ shim = \"spring_lower\", axis = \"z\" }]",
            "seats of a solid axle's springs",
        ),
        (
            &KINDS[0],
            "adjust = [{ length = \"lower_link\" }]\nwant = { track_change = 1.0 }",
            "is always 0 in the static position",
        ),
        (
            &KINDS[0],
            "adjust = [{ length = \"lower_link\" }]\nwant = { bump_steer = 1.0 }",
            "independently suspended wheels",
        ),
    ] {
        let found = refused(kind, setup);
        assert!(found.contains(reason), "{found}");
    }
    // The drop link of the anti-roll bar moves no part of the axle.
    let own = study(
        &KINDS[0],
        "adjust = [{ length = \"drop_link\" }]\nwant = { pinion_angle = 1.0 }",
    )
    .unwrap();
    match set_up(&own, own.setup.as_ref().unwrap()) {
        Err(Refusal::NotMet(reason, nominal)) => {
            assert!(reason.contains("pinion_angle_deg"), "{reason}");
            assert_eq!(nominal.len(), 1);
        }
        Err(Refusal::Design(reason)) => panic!("{reason}"),
        Ok(found) => assert!(!found.met()),
    }
}
