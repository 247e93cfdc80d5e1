//! Tests of the plausibility warnings for a study without a wheel radius.

use crate::support::studies;
use hardpoint::model::Suspension;
use hardpoint::report::{plausibility, rack_doubt, scatter_doubts, variable_plausibility};
use hardpoint::study::{CarStudy, Study};
use std::fs;

/// Warnings about a study's wheel, as if the study had no wheel radius.
fn without_radius(wheel: &Suspension) -> Vec<String> {
    let wheel = Suspension {
        wheel_radius: None,
        ..wheel.clone()
    };
    plausibility(&wheel).unwrap()
}

/// A wrong sign of one z is reported, with the name of the point, also if the study has no wheel radius.
#[test]
fn a_wrong_sign_is_reported_without_a_wheel_radius() {
    let file = studies().join("double_wishbone_pushrod.toml");
    let study = Study::read(&file, &[]).unwrap();
    let wheel = study.wheel();
    assert_eq!(without_radius(wheel), Vec::<String>::new());
    for name in [
        "wheel_centre",
        "lower_arm_front",
        "lower_arm_rear",
        "tie_rod_inner",
        "tie_rod_outer",
        "pushrod_outer",
    ] {
        let mut changed = wheel.clone();
        let id = changed.mechanism.point(name).unwrap();
        changed.design[id.0].z *= -1.0;
        let found = without_radius(&changed);
        assert!(
            found.iter().any(|doubt| doubt.contains(name)),
            "{name}: {found:?}"
        );
    }
}

/// The sample suspensions have no warning about their wheel, with and without the wheel radius.
#[test]
fn sample_suspensions_are_plausible_without_a_wheel_radius() {
    for entry in fs::read_dir(studies()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|own| own != "toml") {
            continue;
        }
        let Ok(study) = Study::read_elastic(&path, &[]) else {
            // The study of a car refers to the studies of its axles, so the test skips it.
            continue;
        };
        let wheel = study.wheel();
        let with = plausibility(wheel).unwrap();
        assert_eq!(without_radius(wheel), with, "{}", path.display());
    }
}

/// The point `spindle_inner` of the spin axis only defines a direction. Wherever it is on the axis, it does not change
/// the distance between a rod end and the wheel carrier.
#[test]
fn the_point_of_the_spin_axis_carries_no_rod() {
    let text = fs::read_to_string(studies().join("double_wishbone_pushrod.toml")).unwrap();
    let distance = |text: &str| {
        let study = Study::from_text("own.toml", text, studies()).unwrap();
        let wheel = study.wheel();
        let id = wheel.mechanism.point("pushrod_outer").unwrap();
        let seats = wheel.mechanism.seats(&wheel.design, id);
        seats
            .iter()
            .find(|seat| seat.name == "knuckle")
            .unwrap()
            .distance
    };
    // Moves the point along the spin axis, so that it is beside the pushrod.
    let own = "spindle_inner    = [   0.0,  520.0,  250.6]";
    let far = "spindle_inner = [0.0, 320.0, 241.8]";
    let with_point = text.replace(own, far);
    assert_ne!(with_point, text);
    assert_eq!(distance(&with_point), distance(&text));
}

/// A drop link on the axis of its rocker is at a distance of 0 from the rocker. The message has no decimals of this distance.
#[test]
fn a_distance_of_zero_has_no_decimals() {
    let text = fs::read_to_string(studies().join("double_wishbone_rocker.toml")).unwrap();
    let without_body = text.replace("drop_link_outer = \"rocker\"", "");
    assert_ne!(text, without_body);
    let lines = without_body.lines().map(|line| match line {
        own if own.starts_with("drop_link_outer ") => "drop_link_outer = [0.0, 205.0, 420.0]",
        other => other,
    });
    let text = lines.collect::<Vec<_>>().join("\n");
    let study = Study::from_text("own.toml", &text, studies()).unwrap();
    let found = plausibility(study.wheel()).unwrap();
    let is_said = |doubt: &String| doubt.contains("Assumed: rocker (0 mm away)");
    assert!(found.iter().any(is_said), "{found:?}");
}

/// A rack without effect is reported in every motion of an axle.
#[test]
fn a_rack_without_effect_in_a_named_motion_is_reported() {
    let text = fs::read_to_string(studies().join("semi_trailing_arm_solve.toml")).unwrap();
    let (parts, _) = text.split_once("\n[motion]").unwrap();
    let doubt = |rack: &str| {
        let motions = format!("[motion]\nheave = 0.0\n[motions.steer]\nheave = 0.0\n{rack}");
        let outputs = "[outputs]\ncharacteristics = [\"camber\"]";
        let text = format!("{parts}\n[axle]\n{motions}\n{outputs}\n");
        let study = Study::from_text("own.toml", &text, studies()).unwrap();
        rack_doubt(&study)
    };
    assert_eq!(doubt(""), None);
    let found = doubt("rack = [0.0, 10.0]").unwrap();
    assert!(
        found.contains("no part of a semi_trailing_arm is attached to the rack"),
        "{found}"
    );
}

/// The warning about a variable uses the offsets of the coordinate: values of the variable times its factor, with their unit.
#[test]
fn the_range_of_a_variable_includes_its_factor() {
    let doubts = |factor: &str, range: &str| {
        let sweep = format!(
            "sweep={{ method = \"sobol\", samples = 8, variables = [{{ hardpoints = [\"tie_rod_inner\"], \
             axis = \"z\", range = {range}, factors = [{factor}] }}] }}"
        );
        let study = Study::read(&studies().join("macpherson_solve.toml"), &[sweep]);
        variable_plausibility(&study.unwrap())
    };
    let found = doubts("-2.0", "[-126.5, -116.5]");
    let words =
        "z of tie_rod_inner, which is 243 mm in the design, has offsets from 233 to 253 mm.";
    assert!(found.len() == 1 && found[0].contains(words), "{found:?}");
    assert_eq!(doubts("0.01", "[233.0, 253.0]"), Vec::<String>::new());
}

/// Ranges of 10 in and scatters of 0.5 in are too large for a car. The same numbers in millimetres are plausible.
#[test]
fn ranges_and_scatters_too_large_for_the_suspension_are_reported() {
    let path = studies().join("double_wishbone_tolerance.toml");
    let doubts = |millimetres: f64| {
        let [range, sigma] = [10.0 * millimetres, 0.5 * millimetres];
        let variable = format!(
            "{{ hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-{range:?}, {range:?}] }}"
        );
        let sets = [
            format!("sweep={{ samples = 8, variables = [{variable}] }}"),
            format!("tolerance.scatter=[{{ hardpoint = \"tie_rod_inner\", sigma = {sigma:?} }}]"),
        ];
        let study = Study::read(&path, &sets).unwrap_or_else(|e| panic!("{e}"));
        [variable_plausibility(&study), scatter_doubts(&study)].concat()
    };
    let found = doubts(25.4);
    assert_eq!(found.len(), 2, "{found:?}");
    for phrase in [
        "the range of z of tie_rod_inner reaches 254 mm",
        "the scatter of tie_rod_inner has a standard deviation of 12.7 mm",
    ] {
        assert!(
            found.iter().any(|doubt| doubt.contains(phrase)),
            "{found:?}"
        );
    }
    assert_eq!(doubts(1.0), Vec::<String>::new());
}

/// The ranges and scatters of the sample studies are plausible.
#[test]
fn no_sample_has_a_doubtful_range_or_scatter() {
    let files = fs::read_dir(studies()).unwrap();
    let paths = files.map(|file| file.unwrap().path());
    let paths: Vec<_> = paths
        .filter(|path| path.extension().is_some_and(|end| end == "toml"))
        .collect();
    let mut read = 0;
    for path in paths.iter().filter(|path| !CarStudy::is_at(path)) {
        let study = Study::read_elastic(path, &[]).unwrap_or_else(|e| panic!("{e}"));
        let found = [variable_plausibility(&study), scatter_doubts(&study)].concat();
        assert!(
            !found.iter().any(|doubt| doubt.contains("wheel radius")),
            "{}: {found:?}",
            path.display()
        );
        read += usize::from(study.optimise.is_some() || study.tolerance.is_some());
    }
    assert!(read > 10, "{read}");
}
