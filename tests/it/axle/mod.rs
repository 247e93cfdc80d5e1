//! Tests of axles against independent results, symmetry and statics.

mod acceleration;
mod at_load;
mod by_wheel;
mod certificate;
mod commands;
mod different_sides;
mod drawings;
mod gradients;
mod independent;
mod independent_values;
pub(crate) mod lanes;
mod limits;
mod loads;
mod named_motions;
mod one_state;
mod over_time;
mod own;
mod points;
mod reference;
mod refusals;
mod right;
mod rocker_springs;
mod rows;
mod runs;
mod side_by_side;
mod springs;
mod sweep;
mod symmetry;
mod targets_of_motions;
mod toggles;
mod tuning;

use hardpoint::axle::{Axle, Law, Setup, SpringLaw, axle_curves};
use hardpoint::characteristics::Constants;
use hardpoint::curves::Curves;
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

/// Sample study with overrides, or the errors of the study.
fn sample(name: &str, overrides: &[&str]) -> Result<Study, String> {
    let path = crate::support::studies().join(format!("{name}.toml"));
    let overrides: Vec<_> = overrides.iter().map(|o| (*o).to_owned()).collect();
    Study::read(&path, &overrides).map_err(|e| e.to_string())
}

/// Curves of a sample study of an axle with overrides.
fn solved(name: &str, overrides: &[&str]) -> Curves {
    let study = sample(name, overrides).unwrap_or_else(|e| panic!("{e}"));
    let both = study.axle().unwrap();
    axle_curves(&both.axle, &both.plan).unwrap().curves
}

/// Value of a column at a station. Panics if there is no value.
fn value(curves: &Curves, station: usize, name: &str) -> f64 {
    let found = curves.columns.iter().position(|c| c.name == name);
    let column = found.unwrap_or_else(|| panic!("no column {name}"));
    curves.stations[station].values[column].unwrap_or_else(|void| panic!("{name}: {void:?}"))
}

/// Study with changed keys, or the errors of the changed study.
fn with(study: &Study, edits: &[&str]) -> Result<Study, String> {
    let edits: Vec<String> = edits.iter().map(|edit| (*edit).to_owned()).collect();
    let study = study.with_overrides("changed.toml", &edits);
    study.map_err(|error| error.to_string())
}
