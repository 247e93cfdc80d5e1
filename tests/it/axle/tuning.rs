//! Tests of targets of an axle: residuals and their derivatives, and tuned axles that meet their targets.

use crate::support::larger;
use hardpoint::axle::{AxleQuantity, AxleSolver, Placement, Quantity};
use hardpoint::characteristics::Characteristic;
use hardpoint::optimise::{
    Control, LeastSquares, Linearisation, Objective, TargetLayout, moved_design,
};
use hardpoint::study::Study;
use nalgebra::DVector;
use std::path::Path;

pub(super) fn study(name: &str, changes: &[(&str, &str)]) -> Study {
    let mut text = crate::support::sample(&format!("{name}.toml"));
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    Study::from_text("tuned.toml", &text, Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
}

/// Study with targets at every kind of position, each with few stations.
pub(super) fn of_all_kinds(changes: &[(&str, &str)]) -> Study {
    let study = study("macpherson_axle_front", changes);
    let targets = r#"optimise.targets=[
        { characteristic = "ackermann_error", over = "steering_wheel_angle", at = 300.0, value = 0.0, tolerance = 0.1 },
        { characteristic = "roll_centre_height", over = "roll", heave = 20.0, at = 2.0, value = 0.0, tolerance = 2.0 },
        { characteristic = "roll_steer", over = "heave", roll = [-1.0, 1.0], at = 10.0, value = 0.1, tolerance = 0.01, weight = 2.0 },
        { characteristic = "camber_to_road", side = "right", over = "roll", steering_wheel_angle = 200.0, at = 1.0, value = 0.0, tolerance = 0.1 },
        { characteristic = "toe", over = "heave", at = 20.0, value = 0.0, tolerance = 0.1 },
    ]"#;
    let study = study.with_overrides("tuned.toml", &[targets.replace('\n', " ")]);
    study.unwrap_or_else(|e| panic!("{e}"))
}

pub(super) fn layout(study: &Study) -> TargetLayout {
    let optimise = study.optimise.as_ref().unwrap();
    TargetLayout::of(optimise, &study.vehicle)
}

pub(super) fn evaluate(study: &Study, layout: &TargetLayout, x: &DVector<f64>) -> Linearisation {
    let variables = &study.optimise.as_ref().unwrap().variables;
    let mut objective = Objective::new(study.wheel(), variables, layout).unwrap();
    let mut found = Linearisation::new(layout.residuals(), x.len());
    LeastSquares::evaluate(&mut objective, x, &mut found).unwrap();
    found
}

/// The largest deviation of a target is at one of its stations, also if all deviations are 0.
#[test]
fn a_target_without_deviation_names_one_of_its_stations() {
    let rolls = (
        "roll = { from = -3.0, to = 3.0, steps = 7 }",
        "roll = [1.0, -3.0, 3.0]",
    );
    let study = study("macpherson_axle_front", &[rolls]);
    let layout = layout(&study);
    let residuals = DVector::zeros(layout.residuals());
    let of_roll = layout.deviations(&residuals)[1];
    assert_eq!(of_roll.worst, 0.0);
    assert!([1.0, -3.0, 3.0].contains(&of_roll.worst_at), "{of_roll:?}");
}

/// Hardpoints of the right wheel one by one: the mirror images, moved by `shift`.
pub(super) fn own_right(shift: f64) -> String {
    let left = [
        ("lower_arm_front", [120.0, 360.0, 195.0]),
        ("tie_rod_inner", [-110.0, 330.0, 243.0]),
        ("tie_rod_outer", [-130.0, 690.0, 240.0]),
    ];
    let points =
        left.map(|(name, [x, y, z])| format!("{name} = [{x:?}, {:?}, {:?}]", -y, z + shift));
    format!("[axle.right.hardpoints]\n{}", points.join("\n"))
}

/// The residual of the roll centre equals its deviation from the target, computed from a result of the axle's solver. A wheel
/// quantity without a side has one residual for each wheel. The derivatives equal the slopes of all residuals, with mirrored and
/// with separate right hardpoints.
#[test]
fn rows_are_deviations_and_their_derivatives_are_slopes() {
    let mirrored = ("[axle]\nright = \"mirrored\"", own_right(1.5));
    for changes in [&[][..], &[(mirrored.0, mirrored.1.as_str())][..]] {
        let study = of_all_kinds(changes);
        let layout = layout(&study);
        // The residuals include roll steer at two roll angles and toe of two wheels.
        assert_eq!(layout.residuals(), 1 + 1 + 2 + 1 + 2);
        let n = study.optimise.as_ref().unwrap().variables.len();
        let x = DVector::from_fn(n, |j, _| 3.0 - j as f64);
        let found = evaluate(&study, &layout, &x);

        let optimise = study.optimise.as_ref().unwrap();
        let mut axle = study.axle().unwrap().clone().axle;
        let (frame, variables) = (axle.left.frame, &optimise.variables);
        moved_design(
            &study.wheel().design,
            &frame,
            variables,
            &x,
            &mut axle.left.design,
        );
        if let Some(right) = &mut axle.right {
            let own = right.design.clone();
            moved_design(&own, &frame, variables, &x, &mut right.design);
        }
        let height = Quantity::Axle(AxleQuantity::RollCentreHeight);
        let mut solver = AxleSolver::<3>::new(&axle, &[height], false).unwrap();
        let placed = solver
            .place(&Placement::Roll {
                heave: 20.0,
                roll: 2.0_f64.to_radians(),
                rack: 0.0,
            })
            .unwrap();
        let value = height.evaluate(&solver.read(&placed).unwrap().state);
        let expected = value / 2.0 * layout.share(1);
        assert!((found.residuals[1] - expected).abs() < 1e-12 * expected.abs());

        for j in 0..n {
            let at = |step: f64| {
                let mut x = x.clone();
                x[j] += step;
                evaluate(&study, &layout, &x).residuals
            };
            let h = 0.05;
            let slope = ((at(h) - at(-h)) * 8.0 - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
            for row in 0..layout.residuals() {
                let size = found.jacobian.row(row).amax();
                let error = (found.jacobian[(row, j)] - slope[row]).abs();
                assert!(error < 1e-7 * size, "{row} by {j}: {error:e} of {size}");
            }
        }
    }
}

/// Right hardpoints that the study gives as exact mirror images are tuned like omitted ones.
#[test]
fn mirror_images_may_be_written_out() {
    let (one, two) = (of_all_kinds(&[]), {
        let own = own_right(0.0);
        of_all_kinds(&[("[axle]\nright = \"mirrored\"", own.as_str())])
    });
    let x = DVector::from_element(one.optimise.as_ref().unwrap().variables.len(), 2.0);
    let [one, two] = [one, two].map(|study| evaluate(&study, &layout(&study), &x));
    assert_eq!(one.residuals, two.residuals);
    let differ = (&one.jacobian - &two.jacobian).amax();
    assert!(differ <= 1e-13 * one.jacobian.amax(), "{differ:e}");
}

/// Tunes a study, and reads a quantity of the tuned axle at given positions.
fn tuned(study: &Study, quantity: AxleQuantity, placements: &[Placement]) -> (f64, Vec<f64>) {
    let tuning = study.tune(Control::default()).unwrap();
    let best = tuning.best.unwrap();
    let moved = study.moved(&best.offsets);
    let text = study.with_points_of(&moved);
    let again = Study::from_text("again.toml", &text, Path::new(".")).unwrap();
    let axle = again.axle().unwrap().clone().axle;
    let right = moved.axle().unwrap().clone().axle.right;
    assert_eq!(
        right.map(|r| r.design),
        axle.right.as_ref().map(|r| r.design.clone())
    );
    let quantity = Quantity::Axle(quantity);
    let mut solver = AxleSolver::<3>::new(&axle, &[quantity], false).unwrap();
    let values = placements.iter().map(|placement| {
        let placed = solver.place(placement).unwrap();
        quantity.evaluate(&solver.read(&placed).unwrap().state)
    });
    (best.after.misfit, values.collect())
}

/// A constraint on a motion of the left wheel is satisfied along the whole motion of the tuned wheel. This includes positions
/// between the stations of the tuning. The constraint is active.
#[test]
fn constraints_hold_through_a_motion_of_the_wheel() {
    let edits = [
        "motions.wheel={ travel = [-60.0, -20.0, 20.0, 60.0] }",
        "optimise.constraints=[{ characteristic = \"half_track_change\", at_most = 0.5, motion = \"wheel\" }]",
        "optimise.starts=1",
    ];
    let study = study("macpherson_axle_front", &[]);
    let study = study
        .with_overrides("axle.toml", &edits.map(str::to_owned))
        .unwrap();
    let best = study.tune(Control::default()).unwrap().best.unwrap();
    assert!(best.constraints[0].price.per_unit().unwrap() > 1.0);
    let tuned = hardpoint::model::Suspension {
        design: best.design,
        ..study.wheel().clone()
    };
    let quantities = [Characteristic::HalfTrackChange];
    let outputs = hardpoint::study::Outputs::of(quantities.to_vec());
    let values = (0..=600).map(|k| 0.2 * f64::from(k) - 60.0).collect();
    let mut wheel = hardpoint::study::WheelStudy::of(tuned);
    wheel.outputs = outputs;
    wheel.motion = hardpoint::study::Motion {
        values,
        ..study.motions[0].1.clone()
    };
    let alone = Study {
        vehicle: hardpoint::study::Vehicle::Wheel(Box::new(wheel)),
        optimise: None,
        ..study
    };
    let curves = alone.curves().unwrap();
    let most = curves.stations.iter().map(|s| s.values[0].unwrap());
    let most = most.fold(f64::NEG_INFINITY, larger);
    assert!((most - 0.5).abs() < 1e-5, "{most}");
}

#[test]
fn a_steered_front_axle_is_tuned() {
    let study = study("macpherson_axle_front", &[("starts = 2", "starts = 1")]);
    // The rack moves 52 mm per turn of the steering wheel, to the right in a left turn.
    let at = |angle: f64| Placement::Roll {
        heave: 0.0,
        roll: 0.0,
        rack: -52.0 * angle / 360.0,
    };
    let places = [90.0, -180.0, 360.0].map(at);
    let (misfit, errors) = tuned(&study, AxleQuantity::AckermannError, &places);
    assert!(misfit < 0.5, "{misfit}");
    for error in errors {
        assert!(error.to_degrees().abs() < 0.51, "{error}");
    }
}

/// If the right toe link has another length, tuning moves both sides together. The text of the tuned study has the moved
/// points of both sides.
#[test]
fn a_rear_axle_is_tuned_for_roll_steer() {
    let own = "[axle.right.hardpoints]\ntoe_link_inner = [-180.0, -347.0, 262.0]";
    let changes = [
        ("[axle]\nright = \"mirrored\"", own),
        ("to = 3.0, steps = 7", "to = 3.0, steps = 3"),
        ("to = 40.0, steps = 5", "to = 40.0, steps = 2"),
    ];
    let study = study("five_link_axle_rear", &changes);
    let at = |roll: f64| Placement::Roll {
        heave: 0.0,
        roll: roll.to_radians(),
        rack: 0.0,
    };
    let places = [-3.0, 0.0, 3.0].map(at);
    let (misfit, values) = tuned(&study, AxleQuantity::RollSteer, &places);
    assert!(misfit < 0.5, "{misfit}");
    for value in values {
        assert!((value - 0.04).abs() < 0.004, "{value}");
    }
}
