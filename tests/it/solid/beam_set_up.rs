//! Tests of set-ups of twist beams against an independent formulation (`built_beam.rs`).

use super::built_beam::{HEAVE, Parts, angles, nominal, study};
use super::own::minus;
use crate::compliance::support::fourth_order;
use hardpoint::set_up::{FoundSetUp, set_up};
use hardpoint::study::{Study, Vehicle};
use std::path::Path;

fn found(study: &Study) -> FoundSetUp {
    let found = set_up(study, study.setup.as_ref().unwrap());
    found.unwrap_or_else(|why| panic!("{}", why.reason()))
}

/// The program computes shims at the mounts and at the wheel flanges. With these shims, the independent formulation
/// gives the target values too.
#[test]
fn set_ups_are_met_in_the_other_formulation() {
    let adjust = "adjust = [{ shim = \"mount\", axis = \"x\" }, { shim = \"spindle_inner\", axis = \"x\" }, { shim = \"spindle_inner\", axis = \"z\" }, \
                  { shim = \"mount\", axis = \"y\", side = \"left\" }]";
    let want = "want = { camber = -1.6, toe = 0.25, axle_longitudinal = 1.5, axle_lateral = -0.7 }\nride_height_change = -12.0";
    let study = study(HEAVE, &format!("[setup]\n{adjust}\n{want}\n"));
    let found = found(&study);
    let [summary] = &found.wheels[..] else {
        panic!("a twist beam is set up as a whole");
    };
    assert!(summary.met);
    let mut parts = Parts::nominal();
    for adjustment in &summary.adjustments {
        parts.change(&adjustment.adjustment, adjustment.amount);
    }
    let x = parts.solved([12.0; 2]);
    let mut middle = [0.0; 3];
    for side in 0..2 {
        let [centre, axis] = parts.wheel(&x, side);
        let [camber, toe] = angles(axis);
        assert!(
            (camber + 1.6).abs() < 1e-9 && (toe - 0.25).abs() < 1e-9,
            "{side}: {camber} {toe}"
        );
        let moved = minus(centre, nominal("wheel_centre", side));
        middle = [0, 1, 2].map(|k: usize| middle[k] + 0.5 * moved[k]);
    }
    assert!(
        (middle[0] - 1.5).abs() < 1e-9 && (middle[1] + 0.7).abs() < 1e-9,
        "{middle:?}"
    );
    // The travels of the curves start from the new resting position.
    let Vehicle::Axle(both) = &found.adjusted.vehicle else {
        panic!("an axle");
    };
    let curves = hardpoint::axle::axle_curves(&both.axle, &both.plan)
        .unwrap()
        .curves;
    let camber = curves
        .columns
        .iter()
        .position(|c| c.name == "left_camber_deg")
        .unwrap();
    assert!((curves.stations[0].value(camber).unwrap() + 1.6).abs() < 1e-9);
}

/// The effects of the adjustments equal difference quotients (fourth order) of the independent formulation.
#[test]
fn effects_are_slopes_in_the_other_formulation() {
    let adjust = "adjust = [{ shim = \"mount\", axis = \"x\" }, { shim = \"mount\", axis = \"z\" }, { shim = \"spindle_inner\", axis = \"z\" }]";
    let study = study(
        HEAVE,
        &format!("[setup]\n{adjust}\nwant = {{ toe = 0.1 }}\n"),
    );
    let found = found(&study);
    let summary = &found.wheels[0];
    for adjustment in &summary.adjustments {
        let h = 0.2;
        let at = [-2.0, -1.0, 1.0, 2.0].map(|step| {
            let mut parts = Parts::nominal();
            parts.change(&adjustment.adjustment, step * h);
            let x = parts.solved([0.0; 2]);
            let [left, right] = [0, 1].map(|side| angles(parts.wheel(&x, side)[1]));
            [left[0], right[0], left[1], right[1]]
        });
        let columns = [
            "left_camber_deg",
            "right_camber_deg",
            "left_toe_deg",
            "right_toe_deg",
        ];
        for (k, column) in columns.iter().enumerate() {
            let slope = fourth_order(at.map(|values| values[k]), h);
            let place = summary
                .statics
                .iter()
                .position(|s| s.column == *column)
                .unwrap();
            let own = adjustment.by_length[place].unwrap();
            assert!(
                (own - slope).abs() < 1e-7 * slope.abs() + 1e-9,
                "{} {column}: {own} {slope}",
                adjustment.adjustment
            );
        }
    }
}

/// The program refuses links and spring seats as adjustments of a twist beam: a twist beam has no links, and its spring
/// seats are fixed.
#[test]
fn parts_that_a_beam_does_not_have_are_refused() {
    let refusal = |further: &str| {
        let text = format!(
            "{}{further}",
            include_str!("../../../engine/templates/twist_beam.toml")
        );
        let read = Study::from_text("beam.toml", &text, Path::new(""));
        read.map(|_| ()).unwrap_err().to_string()
    };
    let said = refusal("\n[tolerance]\nscatter = [{ length = \"mount\", sigma = 0.1 }]\n");
    assert!(said.contains("a twist beam has no links"), "{said}");
    let said = refusal("\n[setup]\nadjust = [{ length = \"mount\" }]\nwant = { toe = 0.1 }\n");
    assert!(said.contains("a twist beam has no links"), "{said}");
    let said = refusal(
        "\n[tolerance]\nscatter = [{ hardpoint = \"shear_centre\", sigma = 0.1, side = \"left\" }]\n",
    );
    assert!(
        said.contains("the axle has only one shear_centre"),
        "{said}"
    );
    let said = refusal(
        "\n[setup]\nadjust = [{ shim = \"spring_lower\", axis = \"z\" }]\nwant = { toe = 0.1 }\n",
    );
    assert!(said.contains("springs cannot be adjusted yet"), "{said}");
}
