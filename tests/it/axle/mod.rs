//! Tests of axles against independent results, symmetry and statics.

mod acceleration;
mod at_load;
mod by_wheel;
mod certificate;
mod commands;
mod different_sides;
mod drawings;
mod gradients;
mod lanes;
mod limits;
mod loads;
mod named_motions;
mod one_state;
mod over_time;
mod own;
mod points;
mod reference;
mod right;
mod rocker_springs;
mod rows;
mod side_by_side;
mod springs;
mod sweep;
mod symmetry;
mod targets_of_motions;
mod toggles;
mod tuning;

use hardpoint::axle::{Axle, Law, Setup, SpringLaw};
use hardpoint::characteristics::Constants;
use hardpoint::model::Suspension;
use hardpoint::study::Study;
use serde_json::Value;
use std::path::Path;

/// Left wheel of a reference case in `tests/data/reference/axle`, as a study would define it.
fn suspension(case: &Value) -> Suspension {
    let mut text = format!("[suspension]\ntopology = {}\n", case["topology"]);
    text += "[suspension.hardpoints]\n";
    for (name, point) in case["left"].as_object().unwrap() {
        text += &format!("{name} = {point}\n");
    }
    text += "[suspension.bodies]\n";
    for (name, body) in case["on"].as_object().into_iter().flatten() {
        text += &format!("{name} = {body}\n");
    }
    text += &format!("[wheel]\nradius = {}\n", case["radius"]);
    text += &format!("[vehicle]\nwheelbase = {}\n", case["wheelbase"]);
    text += "[motion]\ntravel = 0.0\n";
    let study = Study::from_text("case.toml", &text, Path::new("."));
    study.unwrap_or_else(|e| panic!("{e:?}")).into_wheel()
}

/// The axle of a reference case.
fn axle(case: &Value) -> Axle {
    let left = suspension(case);
    let spring = SpringLaw {
        spring: Law::Linear {
            force: case["spring"]["force_at_design"].as_f64().unwrap(),
            rate: case["spring"]["stiffness"].as_f64().unwrap(),
        },
        bump_stop: None,
        rebound_stop: None,
        own_length: None,
    };
    let setup = Setup {
        wheel_radius: left.wheel_radius,
        wheelbase: left.vehicle.wheelbase,
        c_factor: case["c_factor"].as_f64(),
        springs: Some([spring.clone(), spring]),
        bar_rate: case["bar_stiffness"].as_f64(),
        constants: Constants::of(&left),
        per_metre: 1000.0,
        ..Setup::default()
    };
    Axle {
        left,
        right: None,
        setup,
        elastic: None,
    }
}
