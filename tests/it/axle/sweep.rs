//! Tests of sweeps of axles.

use super::tuning;
use crate::support::larger;
use hardpoint::axle::axle_curves;
use hardpoint::study::Study;
use hardpoint::sweep::{Kind, SweepPlan};
use nalgebra::DVector;
use std::path::Path;

fn study(right: &str) -> Study {
    let text = crate::support::sample("five_link_axle_rear.toml");
    let head = text.split("[motion]").next().unwrap();
    let head = head.replace("[axle]\nright = \"mirrored\"", right);
    let text = format!(
        r#"{head}
[motion]
roll = [-2.0, 0.0, 2.0]
heave = [-10.0, 10.0]

[outputs]
characteristics = ["roll_steer", "toe", "force_roll_centre_height"]

[sweep]
method = "sobol"
samples = 3
variables = [
  {{ hardpoint = "toe_link_inner", axis = "z", range = [-10.0, 10.0] }},
  {{ hardpoint = "toe_link_outer", axis = "y", range = [-5.0, 5.0] }},
]
"#
    );
    Study::from_text("swept.toml", &text, Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
}

/// A row of a sweep equals the result of `solve` for the study of this design. In that study the given hardpoints of
/// the right wheel have moved like the left ones.
#[test]
fn rows_are_what_the_designs_own_curves_have() {
    let own = "[axle.right.hardpoints]\ntoe_link_inner = [-180.0, -347.0, 262.0]";
    for right in ["[axle]\nright = \"mirrored\"", own] {
        let study = study(right);
        let plan = SweepPlan::of(&study, study.sweep.as_ref().unwrap()).unwrap();
        let names: Vec<&str> = plan
            .record
            .outputs
            .iter()
            .map(|o| o.column.as_str())
            .collect();
        assert_eq!(
            names[..3],
            [
                "left_roll_steer_min_deg_per_deg",
                "left_roll_steer_max_deg_per_deg",
                "left_roll_steer_design_deg_per_deg"
            ]
        );
        let mut worker = plan.worker().unwrap();
        let rows = worker.rows(0).clone();
        for design in 0..3 {
            let text = study.with_points_of(&study.at_design(plan.design(design)));
            let alone = Study::from_text("design.toml", &text, Path::new(".")).unwrap();
            let axle = alone.axle().unwrap().clone();
            let curves = axle_curves(&axle.axle, &axle.plan).unwrap().curves;
            let width = names.len();
            let row = &rows.outputs[design as usize * width..][..width];
            for (column, found) in row.chunks_exact(3).enumerate() {
                let values = || curves.stations.iter().map(|s| s.value(column).unwrap());
                let least = values().fold(f64::INFINITY, f64::min);
                let largest = values().fold(f64::NEG_INFINITY, larger);
                for (found, expected) in found.iter().zip([least, largest]) {
                    let error = (found - expected).abs();
                    assert!(
                        error < 1e-10 * expected.abs().max(1.0),
                        "{found} {expected}"
                    );
                }
                assert!(found[2] > least && found[2] < largest);
            }
            assert!(rows.failing[design as usize].is_none());
        }
    }
}

/// A design that cannot be assembled, or cannot reach a station, has a row with a status and empty cells.
#[test]
fn designs_that_fail_say_so() {
    let mut study = study("[axle]\nright = \"mirrored\"");
    if let Some(axle) = study.axle_mut() {
        let stations = axle.plan.motion.along(hardpoint::axle::Coordinate::Heave);
        *stations.unwrap() = vec![0.0, 900.0];
    }
    let plan = SweepPlan::of(&study, study.sweep.as_ref().unwrap()).unwrap();
    let rows = plan.worker().unwrap().rows(0).clone();
    let failing = rows.failing[0].as_ref().unwrap();
    assert_eq!(
        (failing.status.as_str(), failing.stations),
        ("unreachable", 3)
    );
    assert!(rows.outputs[0].is_nan() && rows.outputs[2].is_finite());
}

/// The search for a position first assumes that the wheels move straight up. By this assumption, a wheel here would
/// pass the end of its travel. The solver still finds the position, because it extrapolates the travels from smaller
/// roll angles.
#[test]
fn a_position_before_the_end_of_the_travel_is_found_from_beyond() {
    let text = r#"
[suspension]
topology = "macpherson"
[suspension.hardpoints]
lower_arm_front  = [95.9407, 372.0355, 166.3477]
lower_arm_rear   = [-260.0, 350.0, 205.0]
lower_ball_joint = [4.1351, 662.3963, 231.7026]
strut_top        = [-30.8957, 577.2089, 790.0252]
strut_lower      = [-11.0, 623.0, 370.0]
tie_rod_inner    = [-72.6034, 306.5708, 202.2812]
tie_rod_outer    = [-134.6889, 693.3638, 262.8752]
wheel_centre     = [-22.1105, 737.1371, 257.2557]
spindle_inner    = [-0.2, 660.0, 299.1]
[axle]
right = "mirrored"
[wheel]
radius = 300.0
[motion]
roll = [10.0, 11.0, 12.0]
heave = 70.0
[outputs]
characteristics = ["camber"]
"#;
    let study =
        Study::from_text("far.toml", text, Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
    let both = study.axle().unwrap().clone();
    let curves = axle_curves(&both.axle, &both.plan).unwrap().curves;
    let right = curves.motion_index("travel_right").unwrap();
    let stations = curves.stations.iter();
    let travels: Vec<f64> = stations.map(|s| s.at[right].unwrap()).collect();
    let bend = travels[2] - 2.0 * travels[1] + travels[0];
    assert!(bend.abs() < 0.5, "{travels:?}");
}

/// A sweep reports for each design the deviations and the misfit that tuning uses. The targets are values and bands at
/// separate positions in heave, roll and steering. The test covers evaluation in SIMD lanes and one by one, with
/// mirrored and with separate right hardpoints.
#[test]
fn misfits_are_those_that_tuning_lowers() {
    if !crate::support::has_lanes() {
        return;
    }
    let own = tuning::own_right(1.5);
    for changes in [
        &[][..],
        &[("[axle]\nright = \"mirrored\"", own.as_str())][..],
    ] {
        let study = tuning::of_all_kinds(changes);
        let band = "optimise.targets=[\
            { characteristic = \"ackermann_error\", over = \"steering_wheel_angle\", between = [-0.1, 0.5], tolerance = 0.1 },\
            { characteristic = \"roll_steer\", over = \"heave\", roll = [-1.0, 1.0], at = 10.0, value = 0.1, tolerance = 0.01, weight = 2.0 },\
            { characteristic = \"toe\", over = \"heave\", points = [[-40.0, 0.1], [40.0, -0.1]], tolerance = 0.1 },\
            { characteristic = \"roll_steer\", over = \"roll\", heave = 13.0, at_most = 0.02, tolerance = 0.01 }]";
        let swept = "sweep={ method = \"sobol\", samples = 3, variables = [\
            { hardpoint = \"tie_rod_outer\", axis = \"x\", range = [-30.0, 30.0] },\
            { hardpoint = \"lower_ball_joint\", axis = \"z\", range = [-20.0, 20.0] }] }";
        let moved = "optimise.variables=[\
            { hardpoint = \"tie_rod_outer\", axis = \"x\", range = [-30.0, 30.0] },\
            { hardpoint = \"lower_ball_joint\", axis = \"z\", range = [-20.0, 20.0] }]";
        for targets in [None, Some(band.to_owned())] {
            let motion = "motion={ roll = [-2.0, 0.0, 2.0], heave = [-40.0, 40.0], steering_wheel_angle = [0.0, 300.0] }";
            let edits = [swept, moved, motion]
                .map(str::to_owned)
                .into_iter()
                .chain(targets);
            let edits: Vec<String> = edits.collect();
            let study = study.with_overrides("swept.toml", &edits);
            let study = study.unwrap_or_else(|e| panic!("{e}"));
            let layout = tuning::layout(&study);
            let plan = SweepPlan::of(&study, study.sweep.as_ref().unwrap()).unwrap();
            let outputs = &plan.record.outputs;
            let (misfit, deviations) = (plan.record.misfit().unwrap(), plan.record.deviations());
            assert!(!deviations.is_empty());
            assert!(deviations.iter().all(|k| outputs[*k].kind == Kind::Rms));
            let check = |found: &dyn Fn(usize) -> f64, x: &[f64]| {
                let tuned = tuning::evaluate(&study, &layout, &DVector::from_column_slice(x));
                let expected = layout.deviations(&tuned.residuals);
                assert_eq!(expected.len(), deviations.len());
                let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (1.0 + b.abs());
                for (k, expected) in deviations.iter().zip(expected) {
                    let found = found(*k);
                    assert!(
                        near(found, expected.rms),
                        "{}: {found} {}",
                        outputs[*k].column,
                        expected.rms
                    );
                }
                let rows = layout.residuals() as f64;
                let expected = (tuned.residuals.norm_squared() / rows).sqrt();
                assert!(
                    near(found(misfit), expected),
                    "{} {expected}",
                    found(misfit)
                );
            };
            check(&|k| outputs[k].at_design.unwrap(), &[0.0, 0.0]);
            let mut lanes = plan.worker().unwrap();
            assert_eq!(lanes.not_in_lanes(), None);
            for worker in [&mut lanes, &mut plan.worker_of_width(None).unwrap()] {
                let rows = worker.rows(0).clone();
                assert_eq!(rows.designs(), 3);
                for design in 0..rows.designs() {
                    check(&|k| rows.outputs(design)[k], rows.variables(design));
                }
            }
            assert!(lanes.one_by_one().is_empty());
        }
    }
}

/// With order = "velocity", a row has the derivatives of each quantity with respect to all motion coordinates in the
/// design position. They equal those that `solve` finds for the study of that design. Without the option, a row has no
/// derivatives.
#[test]
fn gains_are_what_the_designs_own_curves_have() {
    let own = "[axle.right.hardpoints]\ntoe_link_inner = [-180.0, -347.0, 262.0]";
    let travels =
        "motion={ travel_left = [-10.0, 20.0], travel_right = [0.0, 5.0], ground = \"plane\" }";
    for (right, motion) in [
        ("[axle]\nright = \"mirrored\"", None),
        (own, None),
        (own, Some(travels)),
    ] {
        let study = study(right);
        let asked = ["outputs.order=\"velocity\""].into_iter().chain(motion);
        let asked: Vec<String> = asked.map(str::to_owned).collect();
        let without = SweepPlan::of(&study, study.sweep.as_ref().unwrap()).unwrap();
        let is_gain = |o: &&hardpoint::sweep::OutputColumn| o.kind == Kind::Gain;
        assert!(!without.record.outputs.iter().any(|o| is_gain(&o)));
        let study = study.with_overrides("gains.toml", &asked);
        let study = study.unwrap_or_else(|e| panic!("{e}"));
        let plan = SweepPlan::of(&study, study.sweep.as_ref().unwrap()).unwrap();
        let outputs = &plan.record.outputs;
        // Roll steer and toe of two wheels, plus roll steer and roll centre of the axle, are six quantities. Each has
        // derivatives with respect to two coordinates.
        assert_eq!(outputs.iter().filter(is_gain).count(), 6 * 2);
        let rows = plan.worker().unwrap().rows(0).clone();
        assert_eq!(rows.designs(), 3);
        for design in 0..rows.designs() {
            let text = study.with_points_of(&study.at_design(plan.design(design as u64)));
            let alone = Study::from_text("design.toml", &text, Path::new(".")).unwrap();
            let both = alone.axle().unwrap().clone();
            let curves = axle_curves(&both.axle, &both.plan.at_design())
                .unwrap()
                .curves;
            for (k, output) in outputs.iter().enumerate().filter(|(_, o)| is_gain(o)) {
                let column = curves.columns.iter().position(|c| c.name == output.column);
                let expected = curves.stations[0].value(column.unwrap()).unwrap();
                let found = rows.outputs(design)[k];
                let error = (found - expected).abs();
                assert!(
                    error < 1e-9 * expected.abs().max(1e-3),
                    "{} {found} {expected}",
                    output.column
                );
            }
        }
    }
}
