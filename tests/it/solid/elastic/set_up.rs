//! Tests of set-ups of elastic solid axles: target values in equilibrium, first-order effects, and the rigid limit.

use super::super::set_up::{column, linear_remainders, quarters};
use super::rigid_limit::{rigid, stiffer};
use super::{Kind, Scatter, elastic, made, results};
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::set_up::{FoundSetUp, set_up};
use hardpoint::study::Study;
use std::path::Path;

const KINDS: [Kind; 3] = [Kind::FourLink, Kind::ThreeLinkPanhard, Kind::FiveLink];
const MOTION: &str =
    "[motion]\nheave = [0.0]\n[outputs]\ncharacteristics = [\"camber\", \"toe\"]\n";

fn text(kind: Kind, relaxed: &str) -> String {
    let scatter = Scatter {
        points: 20.0,
        differs: true,
        rates: [3.5, 3.8],
        springs: true,
    };
    let text = made(kind, scatter, &mut Random(7), MOTION).text;
    text.replace("relaxed = \"free\"", &format!("relaxed = \"{relaxed}\""))
}

/// Target values of the axle: `axle_steer`, `axle_lateral`, `axle_longitudinal`, `pinion_angle`.
const WANT: [f64; 4] = [0.15, 1.2, -2.0, 0.6];
const NAMES: [&str; 4] = [
    "axle_steer",
    "axle_lateral",
    "axle_longitudinal",
    "pinion_angle",
];

fn found(text: &str, kind: Kind, want: [f64; 4], further: &str) -> FoundSetUp {
    let panhard = match kind {
        Kind::FourLink => "",
        _ => "{ length = \"panhard\" },",
    };
    let [steer, lateral, longitudinal, pinion] = want;
    let text = format!(
        "{text}[setup]\nadjust = [{panhard} {{ length = \"lower_link\" }}, {{ length = \"upper_link\" }}]\n\
         want = {{ axle_steer = {steer:?}, axle_lateral = {lateral:?}, axle_longitudinal = {longitudinal:?}, \
         pinion_angle = {pinion:?} }}\n{further}\n"
    );
    let study = Study::elastic_from_text("solid.toml", &text, Path::new(""));
    let study = study.unwrap_or_else(|e| panic!("{e}\n{text}"));
    let found = set_up(&study, study.setup.as_ref().unwrap());
    found.unwrap_or_else(|why| panic!("{kind:?}: {}", why.reason()))
}

/// The equilibrium of the adjusted study has all target values. The test computes the direction of the axle from its
/// points, and reads camber and toe.
#[test]
fn the_adjusted_axle_has_the_wanted_values_in_equilibrium() {
    for kind in KINDS {
        for relaxed in ["free", "at_design_load"] {
            let text = text(kind, relaxed);
            let found = found(&text, kind, WANT, "");
            let summary = &found.wheels[0];
            let value = |name: &str| summary.statics[column(summary, name)].set.unwrap();
            for (name, wanted) in NAMES.into_iter().zip(WANT) {
                let off = value(name) - wanted;
                assert!(off.abs() < 1e-9, "{kind:?}, {relaxed}, {name}: {off:e}");
            }
            let both = found.adjusted.axle().unwrap();
            let axle = elastic(both);
            let at = axle.at([0.0; 2], 0.0).unwrap();
            let now = results(&axle, &at);
            for (number, name) in [
                (0, "left_toe"),
                (1, "left_camber"),
                (8, "right_toe"),
                (9, "right_camber"),
            ] {
                let off = now[number].to_degrees() - value(name);
                assert!(off.abs() < 1e-8, "{kind:?}, {relaxed}, {name}: {off:e}");
            }
            // Displacement of the wheel centres in equilibrium, relative to the nominal wheel centres.
            let nominal = Study::elastic_from_text("solid.toml", &text, Path::new("")).unwrap();
            let design = &nominal.axle().unwrap().axle.left;
            let centres = ["wheel_centre", "right_wheel_centre"];
            let centres =
                centres.map(|name| design.design[design.mechanism.point(name).unwrap().0]);
            let shift = |k: usize| {
                let design = [0, 1].map(|side| centres[side].to_array()[k]);
                0.5 * ((now[2 + k] - design[0]) + (now[10 + k] - design[1]))
            };
            assert!((shift(1) - 1.2).abs() < 1e-8, "{kind:?}: {}", shift(1));
            assert!((shift(0) + 2.0).abs() < 1e-8, "{kind:?}: {}", shift(0));
            assert!(shift(2).abs() < 1e-9);
        }
    }
}

/// The effects at the nominal design predict every static value to first order. If the target changes are halved, the
/// prediction error is a quarter.
#[test]
fn effects_predict_to_first_order() {
    for kind in KINDS {
        let text = text(kind, "free");
        // The nominal axle moves into its equilibrium. Target changes are relative to that equilibrium.
        let nominal = found(&text, kind, WANT, "").wheels[0].clone();
        let drawn = NAMES.map(|name| nominal.statics[column(&nominal, name)].nominal.unwrap());
        let remainders = |scale: f64| -> Vec<f64> {
            let want = [0, 1, 2, 3].map(|k| drawn[k] + scale * WANT[k]);
            let found = found(&text, kind, want, "");
            let summary = &found.wheels[0];
            linear_remainders(summary)
        };
        let [whole, half] = [0.5, 0.25].map(remainders);
        let looked_at = quarters([&whole, &half], 1e-7, &format!("{kind:?}"));
        assert!(looked_at >= 3, "{kind:?}: {looked_at}");
    }
}

/// With stiff links the adjustments approach those of the rigid axle. The difference is proportional to one over the
/// stiffness.
#[test]
fn stiff_links_have_the_set_up_of_the_rigid_axle() {
    for kind in [Kind::FourLink, Kind::ThreeLinkPanhard] {
        let text = text(kind, "free");
        let amounts = |text: &str| -> Vec<f64> {
            let found = found(text, kind, WANT, "ride_height_change = 15.0");
            found.wheels[0]
                .adjustments
                .iter()
                .map(|a| a.amount)
                .collect()
        };
        let expected = amounts(&rigid(&text));
        let errors = [1.0, 10.0, 100.0, 1e5].map(|factor| {
            let found = amounts(&stiffer(&text, factor));
            let errors = found.iter().zip(&expected).map(|(a, b)| (a - b).abs());
            errors.fold(0.0, larger)
        });
        for pair in errors[..3].windows(2) {
            assert!(
                (0.08..0.12).contains(&(pair[1] / pair[0])),
                "{kind:?}: {errors:?}"
            );
        }
        assert!(
            errors[0] > 1e-3 && errors[3] < 1e-4 * errors[0],
            "{kind:?}: {errors:?}"
        );
    }
}
