//! Tests of builds of axles with elastic parts: scatter of both wheels and of shared parts, texts of builds, and derivatives.

use super::support::{SUBFRAME, curves, difference, replaced, value_of, values};
use crate::compliance::support::{assert_printed_builds, elastic, with};
use hardpoint::curves::Curves;
use hardpoint::tolerance::{Expansion, Problem, monte_carlo};
use std::ops::ControlFlow;

pub const SCATTERED: &str = r#"
[outputs]
characteristics = ["toe", "toe_by_lateral_force_trail_30"]

[tolerance]
builds = 400
seed = 3
scatter = [
  { hardpoint = "lower_arm_rear", sigma = 0.3 },
  { bushing = "lower_arm_rear", stiffness = "y", sigma = 0.05, relative = true },
  { bushing = "subframe_rear", stiffness = "y", sigma = 0.05, relative = true },
]
bands = [
  { characteristic = "toe", over = "heave", between = [-0.4, 0.6] },
  { characteristic = "toe_by_lateral_force_trail_30", between = [-0.008, 0.003] },
]
"#;

/// The parts of each wheel scatter independently. Parts of the subframe have one deviation for both wheels. The
/// first-order result has the standard deviations of the builds.
#[test]
fn builds_scatter_by_sides_and_shared_parts_once() {
    let text = with(SUBFRAME, SCATTERED);
    let study = elastic(&text);
    let tolerance = study.tolerance.as_ref().unwrap();
    let names: Vec<&str> = tolerance
        .scatter
        .iter()
        .flat_map(|c| &c.sources)
        .map(|s| s.name.as_str())
        .collect();
    let expected = [
        "left lower_arm_rear x",
        "left lower_arm_rear y",
        "left lower_arm_rear z",
        "right lower_arm_rear x",
        "right lower_arm_rear y",
        "right lower_arm_rear z",
        "left lower_arm_rear stiffness y",
        "right lower_arm_rear stiffness y",
        "subframe_rear stiffness y",
    ];
    assert_eq!(names, expected);
    let problem = Problem::of(&study, tolerance).unwrap();
    let expansion = Expansion::of(&problem).unwrap();
    let drawn = problem.drawn().unwrap();
    let builds = monte_carlo(&problem, &drawn, |_| ControlFlow::Continue(())).unwrap();
    assert_eq!((builds.rejected(), builds.incomplete), (0, 0));
    let design = problem.stations().design();
    let mut checked = 0;
    for (output, column) in problem.outputs().iter().enumerate() {
        for station in 0..problem.stations().count() {
            let cell = problem.cell(output, station);
            let (spread, sigma) = (&builds.spreads[cell], expansion.variance[cell].sqrt());
            if column.name.contains("_by_") && station != design {
                assert!(spread.count == 0 && sigma.is_nan());
                continue;
            }
            let error = spread.sigma_error.max(1e-12);
            assert!(
                (spread.sigma - sigma).abs() < 4.5 * error,
                "{} {station}: {} {sigma}",
                column.name,
                spread.sigma
            );
            checked += 1;
        }
    }
    assert_eq!(checked, 2 * 3 + 2);
}

/// Builds that are printed as studies have the values of the Monte Carlo builds. With two builds, smallest and largest value
/// of the analysis are the values of these builds. Both wheels differ from each other and from the nominal design.
#[test]
fn printed_builds_are_the_builds() {
    let study = elastic(&with(
        SUBFRAME,
        &replaced(SCATTERED, "builds = 400", "builds = 2"),
    ));
    let problem = Problem::of(&study, study.tolerance.as_ref().unwrap()).unwrap();
    let drawn = problem.drawn().unwrap();
    let found = monte_carlo(&problem, &drawn, |_| ControlFlow::Continue(())).unwrap();
    let built = [0, 1].map(|number| {
        let text = problem.built_text(number).unwrap();
        assert!(text.starts_with("# Without [tolerance]"), "{text}");
        curves(&elastic(&text))
    });
    let is_same = |a: f64, b: f64| (a - b).abs() < 1e-9;
    let compared = assert_printed_builds(&problem, &found, &built, is_same);
    // Toe of both wheels at three stations, and a test result of both wheels; two builds.
    assert_eq!(compared, 2 * (2 * 3 + 2));
    let toe = |curves: &Curves, side: &str| {
        let name = format!("{side}_toe_deg");
        let column = curves.columns.iter().position(|c| c.name == name).unwrap();
        curves.stations[1].value(column).unwrap()
    };
    let own = curves(&study);
    assert!((toe(&built[0], "left") - toe(&own, "left")).abs() > 1e-3);
    assert!((toe(&built[0], "left") - toe(&built[0], "right")).abs() > 1e-3);
}

/// A rate of a build differs between the wheels. The text of the build has no variables of rates, no tolerances, and no
/// robust tuning, also if lists are written in separate sections.
#[test]
fn the_text_of_a_build_leaves_out_rates_in_separate_sections() {
    let rate =
        "bushing = \"upper_arm_front\"\nstiffness = \"y\"\nrange = [0.5, 2.0]\nrelative = true\n";
    let point = "hardpoint = \"tie_rod_inner\"\naxis = \"z\"\nrange = [-5.0, 5.0]\n";
    for (optimise, variable) in [("", rate), ("[optimise]\nscatter = 8\n", point)] {
        let more = format!(
            "\n{optimise}[[optimise.variables]]\n{variable}[[optimise.targets]]\ncharacteristic = \"toe\"\nover = \"heave\"\n\
             at = 30.0\nvalue = 0.1\ntolerance = 0.02\nside = \"left\"\n\
             [[tolerance.scatter]]\nbushing = \"lower_arm_rear\"\nstiffness = \"y\"\nsigma = 0.05\nrelative = true\n"
        );
        let study = elastic(&with(SUBFRAME, &more));
        let problem = Problem::of(&study, study.tolerance.as_ref().unwrap()).unwrap();
        let text = problem.built_text(0).unwrap();
        let left_out = "# Without [optimise], [tolerance]: ";
        assert!(text.starts_with(left_out), "{text}");
        let built = elastic(&text);
        assert!(built.optimise.is_none() && built.tolerance.is_none());
    }
}

/// Derivatives with respect to the tolerance sources equal difference quotients between studies with the changed number.
#[test]
fn sensitivities_of_builds_agree_with_differences() {
    let text = with(SUBFRAME, SCATTERED);
    let study = elastic(&text);
    let problem = Problem::of(&study, study.tolerance.as_ref().unwrap()).unwrap();
    let expansion = Expansion::of(&problem).unwrap();
    let design = problem.stations().design();
    let own = |side: &str, factor: f64| {
        let rates = format!("[700.0, {}, 1800.0, 8.0e4, 2.5e5, 2.5e5]", 2500.0 * factor);
        match side {
            "left" => {
                let both = replaced(
                    &text,
                    "[700.0, 2500.0, 1800.0, 8.0e4, 2.5e5, 2.5e5]",
                    &rates,
                );
                let right = "[axle.right.bushings.lower_arm_rear]\nstiffness = [700.0, 2500.0, 1800.0, 8.0e4, 2.5e5, 2.5e5]\n";
                replaced(&both, "right = \"mirrored\"\n", right)
            }
            "right" => {
                let right = format!("[axle.right.bushings.lower_arm_rear]\nstiffness = {rates}\n");
                replaced(&text, "right = \"mirrored\"\n", &right)
            }
            _ => {
                let mount = format!("[3000.0, {}, 2500.0, 2.0e5, 3.0e5, 2.0e5]", 4000.0 * factor);
                replaced(
                    &text,
                    "[3000.0, 4000.0, 2500.0, 2.0e5, 3.0e5, 2.0e5]",
                    &mount,
                )
            }
        }
    };
    let mut checked = 0;
    for (source, side) in [(6, "left"), (7, "right"), (8, "subframe")] {
        for (output, column) in problem.outputs().iter().enumerate() {
            let cell = problem.cell(output, design);
            let found = expansion.gradient(cell)[source] * column.factor();
            let at = |by: f64| {
                let text = own(side, 1.0 + by);
                let alone = text.split("[tolerance]").next().unwrap().to_owned();
                value_of(&values(&alone, 1), &column.name)
            };
            let expected = difference(0.01, at);
            let scale = expected.abs().max(1e-3);
            assert!(
                (found - expected).abs() < 1e-6 * scale,
                "{} {side}: {found} {expected}",
                column.name
            );
            checked += 1;
        }
    }
    assert_eq!(checked, 3 * 4);
}
