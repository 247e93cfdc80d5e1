//! A planted geometry comes back.

use hardpoint::optimise::{Control, moved_design, tune};
use hardpoint::study::{Interpolation, Optimise, Study, Target, Variable, Wanted};
use std::path::Path;

fn front() -> Study {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/macpherson_front.toml");
    Study::read(&path, &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// The study's tuning, wanted what its own design has.
fn planted(study: &Study) -> Optimise {
    let suspension = &study.suspension;
    let mut optimise = study.optimise.clone().unwrap();
    optimise.good_enough = 0.0;
    let plan = hardpoint::plan::Plan::with_targets(study);
    let curves = hardpoint::curves::curves(suspension, &plan).unwrap();
    for target in &mut optimise.targets {
        let column = target.of.column.clone();
        let index = curves
            .columns
            .iter()
            .position(|c| c.name == column)
            .unwrap();
        let unit = target.of.unit;
        target.wanted = Wanted::Curve {
            points: curves
                .stations
                .iter()
                .map(|s| {
                    [
                        s.travel.unwrap(),
                        unit.from_printed(s.values[index].unwrap()),
                    ]
                })
                .collect(),
            interpolation: Interpolation::Linear,
        };
    }
    optimise
}

/// The camber and kingpin curves of the design are the targets. From 20 designs up to 10 mm away in
/// six coordinates the search comes back to it, to 1e-9 m, in tens of iterations.
#[test]
fn a_planted_design_is_recovered_from_every_start() {
    let study = front();
    let suspension = &study.suspension;
    let mut optimise = planted(&study);
    let variables = optimise.variables.clone();
    for seed in 0..20_u32 {
        // A cheap generator is enough: the starts only have to be spread and repeatable.
        let mut state = u64::from(seed).wrapping_mul(0x9E37_79B9_7F4A_7C15) + 1;
        let mut offset = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            20.0 * ((state >> 11) as f64 / (1_u64 << 53) as f64) - 10.0
        };
        let mut start = suspension.clone();
        optimise.variables = variables
            .iter()
            .map(|variable| {
                let away = offset();
                let [moved] = variable.moves[..] else {
                    panic!("one coordinate each");
                };
                let point = &mut start.design[moved.point.0];
                let mut coordinates = point.to_array();
                coordinates[moved.axis as usize] += away;
                *point = coordinates.into();
                Variable {
                    range: [-30.0, 30.0],
                    ..variable.clone()
                }
            })
            .collect();
        let tuning = tune(&start, &study.motion, &optimise, Control::default()).unwrap();
        let best = tuning
            .best
            .unwrap_or_else(|| panic!("seed {seed}: {:?}", tuning.before));
        let fit = tuning.starts.best_fit().unwrap();
        let iterations = fit.history.last().unwrap().iteration;
        let worst = best
            .design
            .iter()
            .zip(&suspension.design)
            .map(|(found, planted)| (*found - *planted).norm())
            .fold(0.0, f64::max);
        println!(
            "seed {seed}: {iterations} iterations, {worst:.1e} mm, {}",
            fit.termination
        );
        assert!(
            worst < 1e-6,
            "seed {seed}: {worst} mm away after {iterations} iterations"
        );
        assert!(iterations < 50, "seed {seed}: {iterations} iterations");
    }
}

/// An arm that is raised and tilted, the rack beside it: points that move together come back together.
#[test]
fn points_moved_together_come_back() {
    let variables = "optimise.variables=[
        { hardpoints = [\"lower_arm_front\", \"lower_arm_rear\"], axis = \"z\", range = [-30.0, 30.0] },
        { hardpoints = [\"lower_arm_front\", \"lower_arm_rear\"], factors = [1.0, -0.5], axis = \"z\", range = [-30.0, 30.0] },
        { hardpoint = \"tie_rod_inner\", axis = \"y\", range = [-30.0, 30.0] }]";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/macpherson_front.toml");
    let study = Study::read(&path, &[variables.to_owned()]).unwrap_or_else(|e| panic!("{e}"));
    let optimise = planted(&study);
    assert_eq!(optimise.variables[1].name, "lower_arm_front+lower_arm_rear");
    let mut start = study.suspension.clone();
    let away = nalgebra::DVector::from_column_slice(&[-6.0, 8.0, 5.0]);
    let frame = study.suspension.frame;
    let design = &study.suspension.design;
    moved_design(
        design,
        &frame,
        &optimise.variables,
        &away,
        &mut start.design,
    );
    let point = |name: &str| study.suspension.mechanism.point(name).unwrap().0;
    let rear = point("lower_arm_rear");
    assert_eq!(start.design[rear].z - design[rear].z, -6.0 - 0.5 * 8.0);
    let tuning = tune(&start, &study.motion, &optimise, Control::default()).unwrap();
    let best = tuning.best.unwrap();
    let apart = best.design.iter().zip(design);
    let worst = apart.map(|(a, b)| (*a - *b).norm()).fold(0.0, f64::max);
    assert!(worst < 1e-6, "{worst}");
    for (offset, away) in best.offsets.iter().zip(&away) {
        assert!((offset + away).abs() < 1e-6);
    }
}

/// A bound that keeps the planted design out of reach is active at the solution, and the other
/// coordinates make the best of it: no feasible move lowers the misfit.
#[test]
fn an_active_bound_is_where_it_stops() {
    let study = front();
    let mut optimise = study.optimise.clone().unwrap();
    optimise.good_enough = 0.0;
    let optimise = &optimise;
    let tuning = tune(
        &study.suspension,
        &study.motion,
        optimise,
        Control::default(),
    )
    .unwrap();
    let fit = tuning.starts.best_fit().unwrap();
    let gradient = fit.evaluation.jacobian.tr_mul(&fit.evaluation.residuals);
    let scale = fit.evaluation.residuals.norm();
    for (k, variable) in optimise.variables.iter().enumerate() {
        let [lower, upper] = variable.range;
        let slope = gradient[k] * (upper - lower) / scale;
        assert!((lower..=upper).contains(&fit.x[k]));
        if fit.x[k] == upper {
            assert!(slope < 0.0, "{k}: {slope}");
        } else if fit.x[k] == lower {
            assert!(slope > 0.0, "{k}: {slope}");
        } else {
            // Stopped at a relative reduction of 1e-10: the slope left is of the order of its root.
            assert!(slope.abs() < 1e-3, "{k}: {slope}");
        }
    }
    assert!(
        fit.x
            .iter()
            .zip(&optimise.variables)
            .any(|(x, v)| *x == v.range[1])
    );
}

/// Weights and tolerances mean what they say: scaling all of either changes nothing.
#[test]
fn only_the_proportion_of_weights_matters() {
    let study = front();
    let mut optimise = study.optimise.clone().unwrap();
    optimise.good_enough = 0.0;
    let scaled = hardpoint::study::Optimise {
        targets: optimise
            .targets
            .iter()
            .map(|t| Target {
                weight: 8.0 * t.weight,
                ..t.clone()
            })
            .collect(),
        ..optimise.clone()
    };
    let best = |o| {
        tune(&study.suspension, &study.motion, &o, Control::default())
            .unwrap()
            .best
            .unwrap()
    };
    let (a, b) = (best(optimise), best(scaled));
    assert_eq!(a.after, b.after);
    assert_eq!(a.offsets, b.offsets);
}
