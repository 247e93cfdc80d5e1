//! Tests of robust tuning of solid axles. The program assembles the whole axle. The parts of both halves scatter, and so
//! do the parts that exist once.

use super::kinds::{KINDS, Kind};
use super::{STILL, case, study_of};
use crate::tuning::robust_axle::{
    assert_builds_are_written_builds, assert_derivatives_are_slopes, known,
};
use hardpoint::study::Study;
use std::path::Path;

fn read(text: &str) -> Study {
    Study::from_text("solid.toml", text, Path::new("")).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// Robust tuning of an axle of this kind.
fn tuning(kind: &Kind, scatter: &str) -> Study {
    let study = kind.study(scatter, "");
    let rack = if kind.is_steered() {
        "rack = 15.0, "
    } else {
        ""
    };
    let targets = format!(
        "optimise.targets=[\
         {{ characteristic = \"mean_steer\", over = \"roll\", heave = -20.0, {rack}at = -2.0, value = 0.0, tolerance = 0.05 }}, \
         {{ characteristic = \"axle_lateral\", over = \"heave\", at = -20.0, value = 0.0, tolerance = 0.5 }}, \
         {{ characteristic = \"camber\", over = \"roll\", {rack}at = 1.5, value = 0.0, tolerance = 0.05 }}, \
         {{ characteristic = \"roll_steer\", over = \"roll\", {rack}at = 0.0, value = 0.0, tolerance = 0.01 }}]"
    );
    let variables = "optimise.variables=[\
         { hardpoint = \"lower_link_chassis\", axis = \"z\", range = [-20.0, 20.0] }, \
         { hardpoint = \"upper_link_axle\", axis = \"y\", range = [-20.0, 20.0] }, \
         { hardpoint = \"wheel_centre\", axis = \"z\", range = [-20.0, 20.0] }, \
         { hardpoints = [\"lower_link_axle\", \"upper_link_axle\"], axis = \"x\", range = [-20.0, 20.0] }, \
         { hardpoint = \"lower_link_axle\", axis = \"y\", range = [-20.0, 20.0] }]";
    let sets = [&targets, variables, "optimise.scatter=2"].map(str::to_owned);
    let read = study.with_overrides("solid.toml", &sets);
    read.unwrap_or_else(|e| panic!("{}: {e}", kind.name))
}

const X: [f64; 5] = [3.0, -2.0, 1.0, 2.5, -1.5];

/// The derivatives of builds equal difference quotients. The variables move both halves, and every part of every kind
/// of axle scatters.
#[test]
fn derivatives_of_builds_of_solid_axles_are_exact() {
    for kind in KINDS {
        let study = tuning(kind, &kind.scatter(0.3));
        assert_derivatives_are_slopes(&study, &X, &[0.2; 5], 1e-7);
    }
}

/// A build of the tuning equals the build that `tolerance` assembles from the same deviations.
#[test]
fn builds_of_a_solid_axle_are_those_of_tolerance() {
    for kind in KINDS {
        let mut parts = vec![
            known(
                r#"hardpoint = "lower_link_axle", axis = "z", side = "left""#,
                1.5,
            ),
            known(
                r#"hardpoint = "lower_link_chassis", axis = "y", side = "right""#,
                -1.2,
            ),
            known(
                r#"hardpoint = "wheel_centre", axis = "z", side = "right""#,
                0.7,
            ),
            known(r#"length = "lower_link", side = "right""#, 0.9),
        ];
        if kind.is_steered() {
            parts.push(known(r#"hardpoint = "panhard_axle", axis = "y""#, 0.8));
            parts.push(known(r#"length = "drag_link""#, -0.6));
        }
        let study = tuning(kind, &parts.join(", "));
        assert_builds_are_written_builds(&study, &X, read);
    }
}

/// Robust tuning of a twist beam.
fn tuning_of_beam(scatter: &str) -> Study {
    let template = include_str!("../../../engine/templates/twist_beam.toml");
    read(&format!(
        "{template}\n[tolerance]\nscatter = [{scatter}]\n[optimise]\nscatter = 2\nvariables = [\
         {{ hardpoint = \"mount\", axis = \"z\", range = [-20.0, 20.0] }}, \
         {{ hardpoint = \"mount\", axis = \"y\", range = [-20.0, 20.0] }}, \
         {{ hardpoint = \"shear_centre\", axis = \"x\", range = [-20.0, 20.0] }}, \
         {{ hardpoint = \"wheel_centre\", axis = \"z\", range = [-20.0, 20.0] }}]\ntargets = [\
         {{ characteristic = \"mean_steer\", over = \"roll\", heave = -30.0, at = -2.0, value = 0.0, tolerance = 0.05 }}, \
         {{ characteristic = \"camber\", over = \"roll\", at = 1.5, value = 0.0, tolerance = 0.05 }}, \
         {{ characteristic = \"axle_lateral\", over = \"heave\", at = -20.0, value = 0.0, tolerance = 0.5 }}, \
         {{ characteristic = \"roll_steer\", over = \"roll\", at = 0.0, value = 0.0, tolerance = 0.01 }}]\n"
    ))
}

const X_OF_BEAM: [f64; 4] = [3.0, -2.0, 2.5, 1.0];

/// The derivatives of builds equal difference quotients. The variables move both halves, and every part of a twist beam
/// scatters.
#[test]
fn derivatives_of_builds_of_twist_beams_are_exact() {
    let study = tuning_of_beam(
        "{ hardpoints = [\"mount\", \"wheel_centre\"], sigma = 0.3 }, { hardpoint = \"shear_centre\", sigma = 0.3 }",
    );
    assert_derivatives_are_slopes(&study, &X_OF_BEAM, &[0.2; 4], 1e-7);
}

/// A build of the tuning equals the build that `tolerance` assembles from the same deviations.
#[test]
fn builds_of_a_twist_beam_are_those_of_tolerance() {
    let parts = [
        known(r#"hardpoint = "mount", axis = "x", side = "left""#, 1.5),
        known(r#"hardpoint = "mount", axis = "y", side = "right""#, -1.2),
        known(
            r#"hardpoint = "wheel_centre", axis = "z", side = "right""#,
            0.7,
        ),
        known(r#"hardpoint = "shear_centre", axis = "z""#, 0.9),
    ];
    let study = tuning_of_beam(&parts.join(", "));
    assert_builds_are_written_builds(&study, &X_OF_BEAM, read);
}

/// The program refuses `scatter` in `[optimise]` without a section `[tolerance]`, because without scatter of parts
/// there are no builds.
#[test]
fn scatter_needs_tolerances() {
    let study = study_of(&case("solid_four_link"), STILL);
    let text = format!(
        "{study}\n[optimise]\nscatter = 16\nvariables = [{{ hardpoint = \"wheel_centre\", axis = \"z\", range = [-5.0, 5.0] }}]\n\
         targets = [{{ characteristic = \"track\", over = \"heave\", at = 0.0, value = 1500.0, tolerance = 1.0 }}]\n"
    );
    let found = Study::from_text("solid.toml", &text, Path::new("")).unwrap_err();
    let found = found.to_string();
    assert!(found.contains("scatter\" needs [tolerance]"), "{found}");
}
