//! Tests of sweeps, builds and limits of a wheel with elastic parts.

use super::support::{assert_printed_builds, elastic, with};
use hardpoint::optimise::{Control, TargetLayout, assessed_at, tune};
use hardpoint::study::Study;
use hardpoint::sweep::SweepPlan;
use hardpoint::tolerance::{Expansion, Problem, monte_carlo};
use std::ops::ControlFlow;

const NAME: &str = "double_wishbone_compliance.toml";

const SWEEP: &str = r#"
[outputs]
characteristics = ["toe", "bump_steer", "toe_by_lateral_force", "recession_by_braking"]

[optimise]
variables = [{ hardpoint = "tie_rod_inner", axis = "z", range = [-1.0, 1.0] }]
targets = [
  { characteristic = "camber", points = [[-40.0, 0.5], [40.0, -0.5]], tolerance = 0.1 },
  { figure = "toe_by_aligning_moment", value = -0.02, tolerance = 0.01 },
]

[sweep]
method = "sobol"
samples = 7
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-3.0, 3.0] },
  { bushing = "lower_arm_rear", stiffness = "y", range = [0.5, 2.0], relative = true },
  { bushing = "upper_arm_front", stiffness = "tx", range = [3.0e4, 9.0e4] },
]
"#;

/// Returns true if two numbers differ by at most the size of the last correction of an equilibrium.
fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-11 * b.abs().max(1e-2)
}

/// The program computes the rows of a sweep in SIMD lanes. They equal the results of each design alone, up to rounding
/// errors.
#[test]
fn rows_of_a_sweep_are_those_of_single_designs() {
    let study = elastic(&with(NAME, SWEEP));
    let plan = SweepPlan::of(&study, study.sweep.as_ref().unwrap()).unwrap();
    let names = plan.record.columns();
    assert!(
        names.contains(&"lower_arm_rear_stiffness_y_factor".to_owned()),
        "{names:?}"
    );
    assert!(
        names.contains(&"upper_arm_front_stiffness_tx_N_mm_per_rad".to_owned()),
        "{names:?}"
    );
    let mut worker = plan.worker().unwrap();
    let rows = worker.rows(0).clone();
    assert_eq!(rows.designs(), 7);
    assert!(rows.failing.iter().all(Option::is_none));
    let outputs: Vec<String> = plan
        .record
        .outputs
        .iter()
        .map(|o| o.column.clone())
        .collect();
    let column = |name: &str| {
        outputs
            .iter()
            .position(|o| o == name)
            .unwrap_or_else(|| panic!("{name} in {outputs:?}"))
    };
    for number in 0..rows.designs() {
        let moved = plan.moved(number as u64);
        let factor = rows.variables(number)[1];
        let text = study.with_points_of(&moved);
        let read = elastic(&text);
        assert_eq!(read.compliance(), moved.compliance(), "{factor}");
        let curves = read.curves().unwrap();
        let of = |name: &str| curves.columns.iter().position(|c| c.name == name).unwrap();
        let values = |name: &str| -> Vec<f64> {
            curves
                .stations
                .iter()
                .map(|s| s.value(of(name)).unwrap())
                .collect()
        };
        let row = rows.outputs(number);
        let toe = values("toe_deg");
        let least = toe.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(is_same(row[column("toe_min_deg")], least));
        // Travel 0 is the third station.
        for name in [
            "toe",
            "bump_steer",
            "toe_by_lateral_force",
            "recession_by_braking",
        ] {
            let unit = outputs
                .iter()
                .find_map(|o| o.strip_prefix(&format!("{name}_design")))
                .unwrap();
            let found = row[column(&format!("{name}_design{unit}"))];
            let expected = values(&format!("{name}{unit}"))[2];
            assert!(is_same(found, expected), "{name}: {found} {expected}");
        }
        // The gain of toe (derivative in the design position) equals the bump steer, up to rounding.
        let (gain, steer) = (
            row[column("toe_gain_deg_per_mm")],
            row[column("bump_steer_design_deg_per_mm")],
        );
        assert!((gain - steer).abs() < 1e-14 + 1e-12 * steer.abs());
        let camber = {
            let mut own = read.clone();
            own.one_wheel_mut().unwrap().outputs.characteristics =
                vec![hardpoint::Characteristic::Camber];
            own.curves()
                .unwrap()
                .stations
                .iter()
                .map(|s| s.value(0).unwrap())
                .collect::<Vec<_>>()
        };
        let wanted = [0.5, 0.25, 0.0, -0.25, -0.5];
        let rms = camber
            .iter()
            .zip(wanted)
            .map(|(c, w)| ((c - w) / 0.1).powi(2))
            .sum::<f64>()
            / 5.0;
        assert!((row[column("rms_camber")] - rms.sqrt()).abs() < 1e-9 * rms.sqrt());
    }
    assert!(
        !outputs
            .iter()
            .any(|o| o.starts_with("toe_by_lateral_force_min"))
    );
}

const BUILDS: &str = r#"
[outputs]
characteristics = ["toe", "camber", "toe_by_lateral_force"]

[tolerance]
builds = 1500
seed = 3
scatter = [
  { hardpoint = "tie_rod_inner", sigma = 0.05 },
  { length = "tie_rod", sigma = 0.03 },
  { bushing = "lower_arm_rear", stiffness = "y", sigma = 0.02, relative = true },
  { bushing = "lower_arm_front", stiffness = "x", limits = [-30.0, 30.0] },
]
bands = [
  { characteristic = "toe", at = 20.0, between = [-0.2, 0.2] },
  { characteristic = "toe_by_lateral_force", at_most = 0.05 },
]
"#;

/// For small scatter, the standard deviation of builds equals the first-order result. The gradients equal difference
/// quotients.
#[test]
fn builds_scatter_as_first_order_says() {
    let study = elastic(&with(NAME, BUILDS));
    let tolerance = study.tolerance.as_ref().unwrap();
    let problem = Problem::of(&study, tolerance).unwrap();
    let drawn = problem.drawn().unwrap();
    let expansion = Expansion::of(&problem).unwrap();
    let builds = monte_carlo(&problem, &drawn, |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(
        (builds.builds, builds.rejected(), builds.incomplete),
        (1500, 0, 0)
    );
    let design = problem.stations().design();
    let mut checked = 0;
    for (output, column) in problem.outputs().iter().enumerate() {
        let is_figure = column.name.starts_with("toe_by");
        for station in 0..problem.stations().count() {
            let cell = problem.cell(output, station);
            let spread = &builds.spreads[cell];
            if is_figure && station != design {
                assert_eq!(spread.count, 0);
                assert!(expansion.variance[cell].is_nan());
                continue;
            }
            let sigma = expansion.variance[cell].sqrt();
            assert!(
                (spread.sigma - sigma).abs() < 4.5 * spread.sigma_error,
                "{} {station}: {} {sigma}",
                column.name,
                spread.sigma
            );
            assert!(expansion.holds(cell).is_none());
            checked += 1;
        }
    }
    assert_eq!(checked, 2 * problem.stations().count() + 1);
    // The derivative with respect to a rate equals the change of the test result in a study with another rate.
    let (cell, rate) = (
        problem.cell(2, design),
        expansion.gradient(problem.cell(2, design))[4],
    );
    let at = |factor: f64| {
        let text = with(NAME, BUILDS).replace(
            "[700.0, 2500.0, 1800.0, 8.0e4, 2.5e5, 2.5e5]",
            &format!("[700.0, {}, 1800.0, 8.0e4, 2.5e5, 2.5e5]", 2500.0 * factor),
        );
        let study = elastic(&text);
        let problem = Problem::of(&study, study.tolerance.as_ref().unwrap()).unwrap();
        problem.drawn().unwrap()[cell]
    };
    let expected = (at(1.001) - at(0.999)) / 0.002;
    assert!(
        rate != 0.0 && (rate - expected).abs() < 1e-5 * rate.abs(),
        "{rate} {expected}"
    );
}

/// Builds that are printed as studies have the values of the Monte Carlo builds. With two builds, smallest and largest value
/// of the analysis are the values of these builds.
#[test]
fn printed_builds_are_the_builds() {
    let text = with(NAME, BUILDS);
    let study = elastic(&text.replace("builds = 1500", "builds = 2"));
    let problem = Problem::of(&study, study.tolerance.as_ref().unwrap()).unwrap();
    let drawn = problem.drawn().unwrap();
    let found = monte_carlo(&problem, &drawn, |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(found.builds, 2);
    let rate = |study: &Study| study.compliance().unwrap().parts.bushings[1].shapes[1].clone();
    let built = [0, 1].map(|number| elastic(&problem.built_text(number).unwrap()));
    assert!(rate(&built[0]) != rate(&study) && rate(&built[0]) != rate(&built[1]));
    let curves = built.map(|study| study.curves().unwrap());
    let compared = assert_printed_builds(&problem, &found, &curves, is_same);
    // Toe and camber at each station, and one test result; two builds.
    assert_eq!(compared, 2 * (2 * problem.stations().count() + 1));
}

const LIMITED: &str = r#"
[optimise]
good_enough = 0.0
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] },
  { bushing = "lower_arm_rear", stiffness = "y", range = [0.2, 5.0], relative = true },
]
targets = [
  { characteristic = "toe_by_lateral_force", value = 0.09, tolerance = 0.005 },
  { characteristic = "toe", at = 20.0, value = 0.05, tolerance = 0.02 },
]
constraints = [
  { characteristic = "toe_by_lateral_force", at_most = 0.06 },
  { characteristic = "camber", at_least = -2.0 },
  { length = "tie_rod", between = [290.0, 320.0] },
]
"#;

/// A limit on a test result is active if the target demands more. The derivatives of the limit equal difference
/// quotients.
#[test]
fn a_figure_keeps_its_limit() {
    let study = elastic(&with(NAME, LIMITED));
    let optimise = study.optimise.as_ref().unwrap();
    let layout = TargetLayout::of(optimise, &study.vehicle);
    let at = |x: &[f64]| {
        assessed_at(study.wheel(), &optimise.variables, &layout, x)
            .unwrap()
            .unwrap()
    };
    let x = [1.3, 0.2];
    let found = at(&x);
    // One row for the test result, five stations of camber, two limits of a length.
    assert_eq!(found.rows.residuals.len(), 8);
    for (k, step) in [(0, 1e-3), (1, 1e-4)] {
        let moved = |by: f64| {
            let mut x = x;
            x[k] += by;
            at(&x).rows.residuals
        };
        let slopes = (moved(step) - moved(-step)) / (2.0 * step);
        for row in 0..8 {
            let (own, expected) = (found.rows.jacobian[(row, k)], slopes[row]);
            assert!(
                (own - expected).abs() < 1e-5 * expected.abs().max(1e-3),
                "{row} {k}: {own} {expected}"
            );
        }
    }
    let tuning = tune(&study.vehicle, optimise, Control::default()).unwrap();
    let best = tuning.best.unwrap();
    let tuned = study.moved(&best.offsets);
    let value = figure(&study, &tuned, "toe_by_lateral_force");
    assert!((value - 0.06).abs() < 1e-6, "{value}");
    assert!(best.constraints[0].margin.abs() < 1e-6);
}

/// Printed test result of a moved study.
fn figure(study: &Study, moved: &Study, name: &str) -> f64 {
    let text =
        study.with_points_of(moved) + &format!("\n[outputs]\ncharacteristics = [\"{name}\"]\n");
    let curves = elastic(&text).curves().unwrap();
    let middle = curves.stations.len() / 2;
    curves.stations[middle].value(0).unwrap()
}

/// The program refuses constraints on poses of the rigid mechanism. It accepts constraints on the design.
#[test]
fn constraints_of_poses_are_refused() {
    let fails =
        r#"{ point = "tie_rod_inner", outside = { box = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]] } }"#;
    let text =
        with(NAME, LIMITED).replace("{ length = \"tie_rod\", between = [290.0, 320.0] }", fails);
    let errors =
        Study::elastic_from_text("case.toml", &text, std::path::Path::new("")).unwrap_err();
    let said = errors.render(false);
    assert!(said.contains("at = \"design\""), "{said}");
}
