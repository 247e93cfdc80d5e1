//! Derivatives of builds, and what builds are.

use super::super::builds::follower;
use super::super::{Evaluation, LeastSquares, Objective, TargetLayout};
use crate::build::Assembler;
use crate::study::{Optimise, Study};
use nalgebra::DVector;
use std::path::Path;

const VARIABLES: &str = "optimise.variables=[\
    { hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-20.0, 20.0] }, \
    { hardpoint = \"lower_arm_front\", axis = \"y\", range = [-20.0, 20.0] }, \
    { rigid = [\"lower_ball_joint\", \"tie_rod_outer\", \"wheel_centre\"], shift = 10.0, turn = 3.0 }]";
const TARGETS: &str = "optimise.targets=[\
    { characteristic = \"camber\", points = [[-20.0, -1.0], [20.0, 0.5]], tolerance = 0.05 }, \
    { characteristic = \"toe\", at = 0.0, value = 0.4, tolerance = 0.05 }, \
    { characteristic = \"bump_steer\", at = 5.0, value = 0.02, tolerance = 0.001 }]";
const TRAVEL: &str = "motion.travel={ from = -20.0, to = 20.0, steps = 3 }";

fn study(file: &str, overrides: &[&str]) -> Study {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("studies")
        .join(file);
    let overrides: Vec<String> = overrides.iter().map(|o| (*o).to_owned()).collect();
    Study::read(&path, &overrides).unwrap_or_else(|e| panic!("{e}"))
}

/// The residuals of a study's builds at `x`.
fn with_problem<R>(
    study: &Study,
    f: impl FnOnce(&mut dyn FnMut(&DVector<f64>) -> Evaluation) -> R,
) -> R {
    let optimise = study.optimise.as_ref().unwrap();
    let suspension = &study.suspension;
    let layout = TargetLayout::of(
        optimise,
        &study.motion,
        &suspension.frame,
        &suspension.mechanism,
    );
    let assembler = Assembler::new(suspension).unwrap();
    let assembled = assembler.suspension();
    let scatter = optimise.scatter.as_ref().unwrap();
    let follows = follower(suspension, assembled);
    let mut problem =
        Objective::<2>::of_builds(assembled, &optimise.variables, &layout, scatter, follows)
            .unwrap();
    let count = layout.residuals();
    f(&mut |x| {
        let mut at = Evaluation::new(count, x.len());
        LeastSquares::evaluate(&mut problem, x, &mut at).unwrap();
        at
    })
}

/// Against differences of sixth order: of a wishbone with a pushrod, as assembled and with toe and camber set
/// again, and of a strut.
#[test]
fn derivatives_of_builds_are_exact() {
    for (file, more) in [
        ("double_wishbone_tolerance.toml", "tolerance.aligned=false"),
        ("double_wishbone_tolerance.toml", "tolerance.aligned=true"),
        ("macpherson_tolerance.toml", "tolerance.aligned=false"),
    ] {
        let study = study(
            file,
            &[
                TRAVEL,
                VARIABLES,
                TARGETS,
                "optimise.scatter=3",
                "tolerance.bands=[]",
                more,
            ],
        );
        with_problem(&study, |at| {
            let x = DVector::from_fn(8, |j, _| ((j * 7 + 3) as f64).sin());
            let here = at(&x);
            assert_eq!(here.residuals.len(), 3 * 5);
            for j in 0..x.len() {
                let h = 0.05;
                let mut moved = |steps: f64| {
                    let mut moved = x.clone();
                    moved[j] += steps * h;
                    at(&moved).residuals
                };
                let mut slope = DVector::zeros(here.residuals.len());
                for (k, weight) in [(1.0, 45.0), (2.0, -9.0), (3.0, 1.0)] {
                    slope += (moved(k) - moved(-k)) * (weight / (60.0 * h));
                }
                for row in 0..slope.len() {
                    let found = here.jacobian[(row, j)];
                    let largest = here.jacobian.row(row).amax().max(1e-2);
                    let off = (slope[row] - found).abs() / largest;
                    assert!(
                        off < 1e-8,
                        "{file} {more}: {row} by {j}: {found} {}",
                        slope[row]
                    );
                }
            }
        });
    }
}

/// Builds that hardly scatter are the drawing; those that are set again keep toe and camber of the drawing.
#[test]
fn builds_of_exact_parts_are_the_drawing() {
    let exact = "tolerance.scatter=[{ hardpoint = \"upper_arm_front\", sigma = 1e-9 }]";
    let study = study(
        "double_wishbone_tolerance.toml",
        &[TRAVEL, VARIABLES, TARGETS, "optimise.scatter=2", exact],
    );
    let x = DVector::from_fn(8, |j, _| ((j * 5 + 1) as f64).sin());
    let plain = Optimise {
        scatter: None,
        ..study.optimise.clone().unwrap()
    };
    let suspension = &study.suspension;
    let layout = TargetLayout::of(
        &plain,
        &study.motion,
        &suspension.frame,
        &suspension.mechanism,
    );
    let mut drawing = Objective::<2>::new(suspension, &plain.variables, &layout).unwrap();
    let mut wanted = Evaluation::new(layout.residuals(), 8);
    LeastSquares::evaluate(&mut drawing, &x, &mut wanted).unwrap();
    let found = with_problem(&study, |at| at(&x));
    for build in 0..2 {
        for row in 0..wanted.residuals.len() {
            let of_build = build * wanted.residuals.len() + row;
            let off = (found.residuals[of_build] - wanted.residuals[row]).abs();
            assert!(off < 1e-5, "{off}");
            for j in 0..8 {
                let scale = wanted.jacobian.row(row).amax();
                let off = found.jacobian[(of_build, j)] - wanted.jacobian[(row, j)];
                assert!(off.abs() < 1e-6 * scale + 1e-9, "{row} {j}: {off}");
            }
        }
    }
}
