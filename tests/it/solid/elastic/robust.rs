//! Tests of robust tuning of elastic solid axles whose links fit without force.

use super::{Kind, Scatter, made};
use crate::support::random::Random;
use crate::tuning::robust_axle::{
    assert_builds_are_written_builds, assert_derivatives_are_slopes, known,
};
use hardpoint::study::Study;
use std::path::Path;

const TUNED: &str = r#"[motion]
heave = [-30.0, 0.0, 30.0]
[optimise]
scatter = 2
variables = [
  { hardpoint = "lower_link_axle", axis = "z", range = [-10.0, 10.0] },
  { hardpoint = "panhard_axle", axis = "z", range = [-10.0, 10.0] },
  { link = "lower_link", range = [0.5, 2.0], relative = true },
  { link = "panhard", range = [0.5, 2.0], relative = true },
]
targets = [
  { characteristic = "pinion_angle", over = "heave", at = 30.0, value = 0.5, tolerance = 0.02 },
  { characteristic = "axle_steer", over = "heave", at = -30.0, value = 0.1, tolerance = 0.02 },
  { characteristic = "axle_lateral", over = "heave", at = 30.0, value = 0.5, tolerance = 0.1 },
  { figure = "steer_by_roll", value = 0.02, tolerance = 0.01 },
]
"#;

fn study(scatter: &str) -> Study {
    let symmetric = Scatter {
        points: 0.0,
        differs: false,
        rates: [3.5, 3.5],
        springs: true,
    };
    let further = format!("{TUNED}[tolerance]\nscatter = [{scatter}]\n");
    read(&made(Kind::ThreeLinkPanhard, symmetric, &mut Random(3), &further).text)
}

fn read(text: &str) -> Study {
    let read = Study::elastic_from_text("solid.toml", text, Path::new(""));
    read.unwrap_or_else(|errors| panic!("{errors}\n{text}"))
}

const X: [f64; 4] = [1.5, -2.0, 0.2, -0.1];

#[test]
fn derivatives_of_builds_are_exact() {
    let study = study(
        "{ hardpoints = [\"lower_link_axle\", \"panhard_chassis\"], sigma = 0.5 }, { length = \"panhard\", sigma = 0.5 }, \
         { link = \"lower_link\", sigma = 0.1, relative = true }, { link = \"panhard\", sigma = 0.1, relative = true }",
    );
    assert_derivatives_are_slopes(&study, &X, &[0.1, 0.1, 0.01, 0.01], 1e-5);
}

/// A build of the tuning equals the build that `tolerance` assembles from the same deviations.
#[test]
fn builds_are_those_of_tolerance() {
    let parts = [
        known(
            "hardpoint = \"lower_link_axle\", axis = \"z\", side = \"left\"",
            0.8,
        ),
        known("hardpoint = \"panhard_chassis\", axis = \"z\"", 1.5),
        known("length = \"lower_link\", side = \"right\"", 0.5),
        known(
            "link = \"lower_link\", relative = true, side = \"right\"",
            0.3,
        ),
        known("link = \"panhard\", relative = true", -0.2),
    ];
    let study = study(&parts.join(", "));
    assert_builds_are_written_builds(&study, &[X[0], X[1], 0.0, 0.0], read);
}
