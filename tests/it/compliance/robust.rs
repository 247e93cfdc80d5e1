//! Tests of robust tuning of a wheel with elastic parts: hardpoints and rates of the builds scatter.

use super::support::{elastic, fourth_order, with};
use crate::tuning::robust_axle::{assert_larger_yield, builds_at};
use hardpoint::optimise::{Control, LeastSquares, Linearisation, Objective, TargetLayout, tune};
use hardpoint::study::Optimise;
use hardpoint::tolerance::{Problem, monte_carlo};
use nalgebra::DVector;
use std::ops::ControlFlow;

const NAME: &str = "double_wishbone_compliance.toml";

const SCATTERED: &str = r#"
[optimise]
scatter = 2
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] },
  { bushing = "lower_arm_rear", stiffness = "y", range = [0.5, 2.0], relative = true },
  { bushing = "upper_arm_front", stiffness = "y", range = [3000.0, 12000.0] },
]
targets = [
  { characteristic = "toe", at = 30.0, value = 0.3, tolerance = 0.02 },
  { figure = "toe_by_lateral_force", value = 0.1, tolerance = 0.005 },
  { figure = "recession_by_braking_secant", value = 0.1, tolerance = 0.05 },
]

[tolerance]
scatter = [
  { hardpoints = ["tie_rod_inner", "lower_ball_joint"], sigma = 0.5 },
  { bushing = "lower_arm_rear", stiffness = "y", sigma = 0.1, relative = true },
  { bushing = "upper_arm_front", stiffness = "y", sigma = 400.0 },
]
"#;

/// Derivatives of the builds with respect to hardpoints and rates equal difference quotients. One rate is a variable and
/// also scatters.
#[test]
fn derivatives_of_elastic_builds_are_exact() {
    let study = elastic(&with(NAME, SCATTERED));
    let x = DVector::from_vec(vec![1.5, 0.2, 500.0]);
    let here = builds_at(&study, &x);
    assert_eq!(here.residuals.len(), 2 * 3);
    for (column, step) in [0.1, 0.01, 50.0].into_iter().enumerate() {
        let at = |factor: f64| {
            let mut moved = x.clone();
            moved[column] += factor * step;
            builds_at(&study, &moved).residuals
        };
        let moved = [-2.0, -1.0, 1.0, 2.0].map(at);
        for (row, gradient) in here.jacobian.row_iter().enumerate() {
            let slope = fourth_order([0, 1, 2, 3].map(|k: usize| moved[k][row]), step);
            let found = gradient[column];
            let size: f64 = [1.0, 1.0, 1e-4][column];
            assert!(
                (found - slope).abs() < 1e-5 * size.max(found.abs()),
                "{row} by {column}: {found} {slope}"
            );
        }
    }
    // Scatter gives the builds different values.
    let apart = (here.residuals[0] - here.residuals[3]).abs();
    assert!(apart > 0.01, "{apart}");
}

/// Builds with very small scatter have the residuals of the nominal design.
#[test]
fn builds_of_exact_parts_are_the_nominal_design() {
    let mut text = with(NAME, SCATTERED);
    for (from, to) in [
        ("sigma = 0.5", "sigma = 1e-10"),
        ("sigma = 0.1,", "sigma = 1e-12,"),
        ("sigma = 400.0", "sigma = 1e-8"),
    ] {
        assert!(text.contains(from));
        text = text.replace(from, to);
    }
    let study = elastic(&text);
    let x = DVector::from_vec(vec![1.5, 0.2, 500.0]);
    let builds = builds_at(&study, &x);
    let optimise = Optimise {
        scatter: None,
        ..study.optimise.clone().unwrap()
    };
    let layout = TargetLayout::of(&optimise, &study.vehicle);
    let mut nominal = Linearisation::new(layout.residuals(), x.len());
    let mut problem = Objective::new(study.wheel(), &optimise.variables, &layout).unwrap();
    problem.evaluate(&x, &mut nominal).unwrap();
    for build in 0..2 {
        for row in 0..3 {
            let (found, expected) = (builds.residuals[3 * build + row], nominal.residuals[row]);
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
            for column in 0..3 {
                let found = builds.jacobian[(3 * build + row, column)];
                let expected = nominal.jacobian[(row, column)];
                assert!((found - expected).abs() < 1e-6 * expected.abs().max(1e-3));
            }
        }
    }
}

/// The target is near an end of the band. So builds of the nominal optimum often miss the band.
const YIELD: &str = r#"
[optimise]
scatter = 32
robust = "yield"
good_enough = 0.0
variables = [{ hardpoint = "tie_rod_inner", axis = "z", range = [-15.0, 15.0] }]
targets = [{ characteristic = "toe", at = 30.0, value = 0.0, tolerance = 0.02 }]

[tolerance]
builds = 1000
seed = 5
scatter = [
  { hardpoint = "tie_rod_inner", axis = "z", sigma = 0.5 },
  { bushing = "lower_arm_rear", stiffness = "y", sigma = 0.1, relative = true },
]
bands = [
  { characteristic = "toe", at = 30.0, between = [-0.01, 0.06] },
  { characteristic = "toe_by_lateral_force", between = [-1.0, 1.0] },
]
"#;

/// More builds meet the bands after a robust tuning than after a plain tuning. The test counts builds of `tolerance`
/// that the tuning did not use. Their share agrees with the expected share within five standard errors of the
/// difference.
#[test]
fn the_robust_design_has_the_larger_yield() {
    let study = elastic(&with(NAME, YIELD));
    assert_larger_yield(&study, 2e-3);
}

/// A tuned rate scatters about its tuned value. So the yield after the tuning equals the yield of the tuned study after
/// reading it from its text.
#[test]
fn yields_of_a_tuned_rate_are_those_of_the_tuned_study() {
    const SECTIONS: &str = r#"
[tolerance]
builds = 120
scatter = [{ link = "toe_link", sigma = 0.1, relative = true }]
bands = [{ characteristic = "toe_by_lateral_force_trail_30", at = 0.0, at_most = 0.0945 }]
[optimise]
scatter = 8
good_enough = 0.0
variables = [{ link = "toe_link", range = [0.2, 5.0], relative = true }]
targets = [{ figure = "toe_by_lateral_force_trail_30", value = 0.094, tolerance = 0.001 }]
"#;
    let study = elastic(&with("five_link_compliance.toml", SECTIONS));
    let optimise = study.optimise.as_ref().unwrap();
    let tuning = tune(&study.vehicle, optimise, Control::default()).unwrap();
    let tuned = study.moved(&tuning.best.unwrap().offsets);
    let yields = hardpoint::yields::yields(&study, optimise, Some(&tuned), None, &false.into());
    let [before, after] = yields.unwrap().all.map(Option::unwrap);
    let again = elastic(&study.with_points_of(&tuned));
    let problem = Problem::of(&again, again.tolerance.as_ref().unwrap()).unwrap();
    let nominal = problem.drawn().unwrap();
    let builds = monte_carlo(&problem, &nominal, |_| ControlFlow::Continue(())).unwrap();
    let share = builds.in_all_bands as f64 / builds.builds as f64;
    assert!((after - share).abs() < 1e-12, "{after} {share}");
    assert!(before < 0.3 && after > 0.6, "{before} {after}");
}
