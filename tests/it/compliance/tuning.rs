//! Tests of tuning kinematics and compliance together.

use super::support::{elastic, with};
use hardpoint::optimise::{Control, LeastSquares, Linearisation, Objective, TargetLayout, tune};
use hardpoint::study::{Study, Wanted};
use nalgebra::DVector;
use std::path::Path;

/// Six coordinates, six rates and ten targets: four kinematic targets over travel, six results of tests.
const ASKED: &str = r#"
[optimise]
good_enough = 0.0
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-15.0, 15.0] },
  { hardpoint = "tie_rod_outer", axis = "x", range = [-15.0, 15.0] },
  { hardpoint = "upper_arm_front", axis = "z", range = [-15.0, 15.0] },
  { hardpoint = "upper_arm_rear", axis = "z", range = [-15.0, 15.0] },
  { hardpoint = "lower_arm_front", axis = "z", range = [-15.0, 15.0] },
  { hardpoint = "lower_ball_joint", axis = "x", range = [-15.0, 15.0] },
  { bushing = "lower_arm_front", stiffness = "x", range = [0.5, 2.0], relative = true },
  { bushing = "lower_arm_front", stiffness = "y", range = [0.5, 2.0], relative = true },
  { bushing = "lower_arm_rear", stiffness = "x", range = [0.5, 2.0], relative = true },
  { bushing = "lower_arm_rear", stiffness = "y", range = [0.5, 2.0], relative = true },
  { bushing = "upper_arm_front", stiffness = "y", range = [3000.0, 12000.0] },
  { bushing = "upper_arm_rear", stiffness = "y", range = [3000.0, 12000.0] },
]
targets = [
  { characteristic = "toe", at = 30.0, value = 0.0, tolerance = 0.02 },
  { characteristic = "toe", at = -30.0, value = 0.0, tolerance = 0.02 },
  { characteristic = "camber", at = 30.0, value = 0.0, tolerance = 0.05 },
  { characteristic = "camber", at = -30.0, value = 0.0, tolerance = 0.05 },
  { figure = "toe_by_lateral_force", value = 0.0, tolerance = 0.005 },
  { figure = "camber_by_lateral_force", value = 0.0, tolerance = 0.01 },
  { figure = "toe_by_lateral_force_trail_30", value = 0.0, tolerance = 0.005 },
  { figure = "toe_by_braking", value = 0.0, tolerance = 0.01 },
  { figure = "recession_by_braking", value = 0.0, tolerance = 0.05 },
  { figure = "toe_by_aligning_moment_secant", value = 0.0, tolerance = 0.005 },
]
"#;

const NAME: &str = "double_wishbone_compliance.toml";

fn study(asked: &str) -> Study {
    elastic(&with(NAME, asked))
}

/// Random numbers between -1 and 1.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Random design within 5 mm and 20 % of the study's design.
fn planted(study: &Study, seed: u64) -> DVector<f64> {
    let variables = &study.optimise.as_ref().unwrap().variables;
    let mut number = numbers(seed);
    let offsets = variables.iter().map(|variable| match &variable.rate {
        None => 5.0 * number(),
        Some(rate) if rate.is_relative => (1.0 + 0.2 * number()).ln(),
        Some(rate) => 0.2 * rate.design * number(),
    });
    DVector::from_vec(offsets.collect())
}

/// Study whose targets are the values of a known design.
fn with_planted_targets(mut study: Study, at: &DVector<f64>) -> Study {
    let optimise = study.optimise.as_ref().unwrap();
    let layout = TargetLayout::of(optimise, &study.vehicle);
    let mut problem = Objective::new(study.wheel(), &optimise.variables, &layout).unwrap();
    let mut found = Linearisation::new(layout.residuals(), at.len());
    problem.evaluate(at, &mut found).unwrap();
    let of_rows = layout.targets_of_rows();
    let values: Vec<f64> = (0..optimise.targets.len())
        .map(|target| {
            let row = of_rows.iter().position(|of| *of == target).unwrap();
            found.residuals[row] / layout.share(target) * optimise.targets[target].tolerance
        })
        .collect();
    drop(problem);
    for (target, found) in study
        .optimise
        .as_mut()
        .unwrap()
        .targets
        .iter_mut()
        .zip(values)
    {
        let Wanted::At { value, .. } = &mut target.wanted else {
            panic!("single values")
        };
        *value = found;
    }
    study
}

/// A tuning meets ten targets of kinematics and compliance. The targets are values of a known design that is up to 5 mm
/// and 20 % away.
#[test]
fn planted_targets_of_kinematics_and_compliance_come_back() {
    let asked = study(ASKED);
    for seed in 1..=20 {
        let study = with_planted_targets(asked.clone(), &planted(&asked, seed));
        let optimise = study.optimise.as_ref().unwrap();
        let tuning = tune(&study.vehicle, optimise, Control::default()).unwrap();
        let before = tuning.before.as_ref().unwrap().misfit;
        let best = tuning.best.as_ref().unwrap();
        println!(
            "seed {seed}: misfit {before:.2} -> {:.1e}",
            best.after.misfit
        );
        assert!(before > 0.1, "{seed}: {before}");
        assert!(best.after.misfit < 1e-6, "{seed}: {}", best.after.misfit);
    }
}

/// The Jacobian of targets with respect to hardpoints and rates equals difference quotients of fourth order.
#[test]
fn slopes_along_variables_are_those_of_differences() {
    let study = study(ASKED);
    let optimise = study.optimise.as_ref().unwrap();
    let layout = TargetLayout::of(optimise, &study.vehicle);
    let mut problem = Objective::new(study.wheel(), &optimise.variables, &layout).unwrap();
    let x = planted(&study, 7);
    let mut here = Linearisation::new(layout.residuals(), x.len());
    problem.evaluate(&x, &mut here).unwrap();
    for (column, variable) in optimise.variables.iter().enumerate() {
        let step = match &variable.rate {
            None => 0.1,
            Some(rate) if rate.is_relative => 0.01,
            Some(rate) => 0.01 * rate.design,
        };
        let mut at = |factor: f64| {
            let mut moved = x.clone();
            moved[column] += factor * step;
            let mut found = Linearisation::new(layout.residuals(), x.len());
            problem.evaluate(&moved, &mut found).unwrap();
            found.residuals
        };
        let near = (at(1.0) - at(-1.0)) * 8.0;
        let slopes = (near - (at(2.0) - at(-2.0))) / (12.0 * step);
        for (row, slope) in slopes.iter().enumerate() {
            let found = here.jacobian[(row, column)];
            let size = here.jacobian.row(row).amax() * 15.0;
            // The bound applies to the error of the derivative times the full range of the variable.
            let range = variable.range[1] - variable.range[0];
            let error = (found - slope).abs() * range / size;
            assert!(
                error < 1e-5,
                "{row} by {}: {found} {slope}",
                variable.label()
            );
        }
    }
}

/// The tuned text contains the tuned rates and hardpoints. Read again, it is the tuned study.
#[test]
fn the_tuned_text_is_the_tuned_study() {
    let asked = study(ASKED);
    let offsets = planted(&asked, 3);
    let moved = asked.moved(offsets.as_slice());
    assert_ne!(moved.wheel().design, asked.wheel().design);
    assert_ne!(moved.compliance(), asked.compliance());
    let text = asked.with_points_of(&moved);
    let read = Study::elastic_from_text("tuned.toml", &text, Path::new("")).unwrap();
    assert_eq!(read.wheel().design, moved.wheel().design);
    let (read, moved) = (read.compliance().unwrap(), moved.compliance().unwrap());
    assert_eq!(read.parts, moved.parts);
}

/// The program refuses quantities of the rigid mechanism, misspelled test results, unknown axes, ranges without the present
/// rate, and points without bushing. The message names the reason or the correct name.
#[test]
fn mistakes_in_a_tuning_are_refused() {
    let text = with(NAME, ASKED);
    let refused = [
        (
            "characteristic = \"toe\"",
            "characteristic = \"roll_centre_height\"",
            "rigid mechanism",
        ),
        (
            "figure = \"toe_by_braking\"",
            "figure = \"toe_by_brakin\"",
            "toe_by_braking",
        ),
        ("stiffness = \"x\"", "stiffness = \"u\"", "\"tx\""),
        ("range = [3000.0, 12000.0]", "range = [30.0, 120.0]", "6000"),
        (
            "bushing = \"lower_arm_rear\"",
            "bushing = \"tie_rod_inner\"",
            "bushing",
        ),
    ];
    for (from, to, reason) in refused {
        assert!(text.contains(from), "{from}");
        let wrong = text.replacen(from, to, 1);
        let errors = Study::elastic_from_text("case.toml", &wrong, Path::new("")).unwrap_err();
        let rendered = errors.render(false);
        assert!(rendered.contains(reason), "{to}: {rendered}");
    }
}

/// If modulus and area define the stiffness of a link, the variable is their product, a force. The label and the unit
/// of the variable state this.
#[test]
fn modulus_times_area_is_a_force() {
    let asked = "[optimise]\nvariables = [{ link = \"toe_link\", range = [0.5, 2.0], relative = true }]\n\
                 targets = [{ characteristic = \"toe\", at = 0.0, value = 0.0, tolerance = 0.1 }]\n";
    let study = elastic(&with("five_link_compliance.toml", asked));
    let variable = &study.optimise.as_ref().unwrap().variables[0];
    assert_eq!(variable.way(), "modulus times area");
    let mut rate = variable.rate.unwrap();
    assert_eq!(rate.design, 70000.0 * 110.0);
    rate.is_relative = false;
    assert_eq!(rate.value_unit(study.wheel().length_unit), "N");
}
