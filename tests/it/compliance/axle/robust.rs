//! Tests of robust tuning of axles with elastic parts. Hardpoints and rates of each wheel scatter independently. Shared
//! parts have one deviation for both wheels.

use super::super::support::{elastic, with};
use crate::tuning::robust_axle::{
    assert_builds_are_written_builds, assert_derivatives_are_slopes, builds_at, known,
};
use hardpoint::optimise::{Assessment, Constrained, Objective, TargetLayout};
use hardpoint::study::{Optimise, Study};
use nalgebra::DVector;

const TUNED: &str = r#"
[optimise]
scatter = 2
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] },
  { bushing = "lower_arm_rear", stiffness = "y", range = [0.5, 2.0], relative = true },
  { bushing = "upper_arm_front", stiffness = "y", range = [3000.0, 12000.0] },
  { bushing = "subframe_rear", stiffness = "y", range = [0.5, 2.0], relative = true },
  { hardpoint = "lower_arm_rear", axis = "z", range = [-10.0, 10.0] },
]
targets = [
  { characteristic = "toe", over = "heave", at = 30.0, value = 0.3, tolerance = 0.02 },
  { characteristic = "mean_steer", over = "heave", at = 0.0, value = 0.0, tolerance = 0.01 },
  { figure = "toe_by_lateral_force_trail_30", value = 0.0, tolerance = 0.001 },
]
"#;

const SCATTER: &str = r#"
[tolerance]
scatter = [
  { hardpoints = ["tie_rod_inner", "lower_ball_joint"], sigma = 0.5 },
  { bushing = "lower_arm_rear", stiffness = "y", sigma = 0.1, relative = true },
  { bushing = "upper_arm_front", stiffness = "y", sigma = 400.0 },
  { bushing = "subframe_rear", stiffness = "y", sigma = 0.1, relative = true },
]
"#;

fn study(more: &str) -> Study {
    elastic(&with("subframe_axle_compliance.toml", more))
}

/// The derivatives of the builds' residuals equal difference quotients. The variables include rates that also scatter:
/// a rate of both wheels and a rate of a shared part.
#[test]
fn derivatives_of_builds_of_elastic_axles_are_exact() {
    let study = study(&format!("{TUNED}{SCATTER}"));
    let x = [1.5, 0.2, 500.0, -0.1, 1.0];
    assert_derivatives_are_slopes(&study, &x, &[0.1, 0.01, 50.0, 0.01, 0.1], 1e-5);
    // The parts of both wheels scatter independently, so even the mean steer of a symmetric axle scatters.
    let found = builds_at(&study, &DVector::from_column_slice(&x)).residuals;
    assert_eq!(found.len(), 2 * 5);
    assert!((found[2] - found[7]).abs() > 0.1, "{found}");
}

/// A build of the tuning equals the build that `tolerance` assembles from the same deviations.
#[test]
fn builds_of_an_elastic_axle_are_those_of_tolerance() {
    let parts = [
        known(
            "hardpoint = \"tie_rod_inner\", axis = \"z\", side = \"left\"",
            0.8,
        ),
        known(
            "hardpoint = \"lower_ball_joint\", axis = \"x\", side = \"right\"",
            0.5,
        ),
        known(
            "bushing = \"lower_arm_rear\", stiffness = \"y\", relative = true, side = \"right\"",
            0.3,
        ),
        known(
            "bushing = \"subframe_rear\", stiffness = \"y\", relative = true",
            -0.2,
        ),
    ];
    let scatter = format!("[tolerance]\nscatter = [{}]\n", parts.join(", "));
    let study = study(&format!("{TUNED}{scatter}"));
    assert_builds_are_written_builds(&study, &[1.5, 0.0, 0.0, 0.0, 1.0], elastic);
}

/// A rate scatters about its tuned value. This holds for a rate of both wheels and for a shared part.
#[test]
fn rates_scatter_about_their_tuned_values() {
    let text = format!("{TUNED}{SCATTER}");
    let tuned = study(&text);
    let factor = 0.2_f64.exp();
    let moved = with("subframe_axle_compliance.toml", &text);
    let moved = moved
        .replace(
            "[700.0, 2500.0,",
            &format!("[700.0, {:?},", 2500.0 * factor),
        )
        .replace(
            "[3000.0, 4000.0,",
            &format!("[3000.0, {:?},", 4000.0 * factor),
        );
    let found = builds_at(
        &tuned,
        &DVector::from_column_slice(&[0.0, 0.2, 0.0, 0.2, 0.0]),
    );
    let expected = builds_at(&elastic(&moved), &DVector::zeros(5));
    let off = (&found.residuals - &expected.residuals).amax();
    assert!(off < 1e-7 * expected.residuals.amax(), "{off:e}");
}

/// Constraints on test results apply to the nominal design. So a robust tuning has the same rows of constraints as a
/// tuning without scatter.
#[test]
fn constraints_of_a_robust_tuning_are_those_of_the_nominal_design() {
    let constraints =
        "constraints = [{ characteristic = \"toe_by_lateral_force_trail_30\", at_most = 0.01 }]\n";
    let study = study(&format!("{TUNED}{constraints}{SCATTER}"));
    let x = DVector::from_column_slice(&[1.5, 0.2, 500.0, -0.1, 1.0]);
    let optimise = study.optimise.as_ref().unwrap();
    let plain = Optimise {
        scatter: None,
        ..optimise.clone()
    };
    let layout = TargetLayout::of(&plain, &study.vehicle);
    let mut problem = Objective::new(study.wheel(), &plain.variables, &layout).unwrap();
    let mut expected = Assessment::new(&problem.shape());
    problem.assess(&x, &mut expected).unwrap();

    let layout = TargetLayout::of(optimise, &study.vehicle);
    let (variables, scatter) = (&optimise.variables, optimise.scatter.as_ref().unwrap());
    let assembled = study.vehicle.assembled().unwrap();
    let problem = Objective::of_builds(&assembled, variables, &layout, scatter, None);
    let mut problem = problem.unwrap();
    let mut found = Assessment::new(&problem.shape());
    problem.assess(&x, &mut found).unwrap();
    assert_eq!(found.rows.residuals.len(), 2);
    let off = (&found.rows.residuals - &expected.rows.residuals).amax();
    assert!(off < 1e-9, "{off:e}");
    let off = (&found.rows.jacobian - &expected.rows.jacobian).amax();
    assert!(off < 1e-7 * expected.rows.jacobian.amax(), "{off:e}");
}
