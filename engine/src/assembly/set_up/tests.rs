//! Thresholds and weights of set-ups, and the choice of whole shims.

use super::levels::{End, Levels, felt, least_step};
use super::problem::Problem;
use super::*;
use crate::model::LengthUnit;
use crate::study::Vehicle;
use nalgebra::{DMatrix, DVector};
use std::cell::RefCell;
use std::path::Path;

const THREE: &str = "setup.adjust=[{length=\"pushrod\",per_turn=2.5},{shim=\"upper_ball_joint\",axis=\"y\",step=0.5},\
                     {length=\"tie_rod\",per_turn=2.0}]";

fn study(overrides: &[&str]) -> Study {
    let studies = Path::new(env!("CARGO_MANIFEST_DIR")).join("../studies");
    let overrides: Vec<String> = overrides.iter().map(|o| (*o).to_owned()).collect();
    let path = studies.join("double_wishbone_tolerance.toml");
    Study::read(&path, &overrides).unwrap_or_else(|e| panic!("{e}"))
}

/// Calls a function with the set-up of a study and the state of its design.
fn with<R>(study: &Study, work: impl FnOnce(&Problem<'_>, &AdjustedSuspension) -> R) -> R {
    let assembler = Assembler::new(study.wheel()).unwrap();
    let setup = study.setup.as_ref().unwrap();
    let (problem, drawn) = Problem::of(study, setup, &assembler).unwrap();
    work(&problem, &drawn)
}

/// An adjustment changes an aim if its effect is above a hundred-millionth of the largest effect. This holds for the choice
/// of aims, and for the steps towards them.
#[test]
fn effects_count_down_to_a_hundred_millionth() {
    let rows = |across: f64| DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 1.0, across]);
    assert_eq!(felt(rows(2e-8)).len(), 2);
    assert_eq!(felt(rows(5e-9)).len(), 1);
    let step = |effect: f64| {
        let effects = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, effect]));
        least_step(effects, &DVector::from_vec(vec![0.0, effect])).unwrap()
    };
    assert!((step(2e-8)[1] - 1.0).abs() < 1e-12);
    assert_eq!(step(5e-9)[1], 0.0);
}

/// The solver tries a full step, then halves it down to a thousandth. It does not try a step below 1e-14 of the size. A step
/// without improvement counts as rounding up to 1e-7 of the size. If it is longer, the solver is stuck.
#[test]
fn steps_are_halved_and_end_at_their_thresholds() {
    with(&study(&[THREE]), |problem, drawn| {
        let size = problem.size();
        let toe = problem.targets()[1];
        let ended = |length: f64| {
            let tried = RefCell::new(Vec::new());
            let step = |_: &AdjustedSuspension, _: &DVector<f64>| {
                Some(DVector::from_element(1, length * size))
            };
            let end = problem.iterate(drawn.clone(), &[toe], &[2], step, |amounts| {
                tried.borrow_mut().push(-amounts[2] / (length * size));
                None
            });
            (matches!(end, End::Settled(_)), tried.into_inner())
        };
        assert_eq!(ended(5e-15), (true, vec![]));
        let shares: Vec<f64> = (0..10).map(|k| 0.5f64.powi(k)).collect();
        for (length, is_settled) in [(2e-14, true), (5e-8, true), (2e-7, false), (1e-3, false)] {
            let (settled, tried) = ended(length);
            assert_eq!(settled, is_settled, "{length}");
            assert_eq!(tried.len(), shares.len(), "{length}");
            let mut pairs = tried.iter().zip(&shares);
            assert!(pairs.all(|(tried, share)| (tried / share - 1.0).abs() < 1e-15));
        }
    });
}

/// Newton's method meets the aims to rounding: without threads, without aims, and with both.
#[test]
fn an_iteration_without_aims_or_adjustments_stays() {
    with(&study(&[THREE]), |problem, drawn| {
        let targets = problem.targets();
        for (aims, adjustments) in [(&targets[..0], &[0, 2][..]), (&targets[..1], &[][..])] {
            let End::Settled(state) = problem.newton(drawn.clone(), aims, adjustments) else {
                panic!("nothing to do is done");
            };
            assert_eq!(state.amounts, drawn.amounts);
        }
        let End::Settled(state) = problem.newton(drawn.clone(), &targets, &[0, 1, 2]) else {
            panic!("three adjustments meet three aims");
        };
        assert!(problem.errors(&state, &targets).norm() < 1e-9);
    });
}

/// A tenth of a degree, a millimetre, and a thousandth of a degree per millimetre have the same weight, whatever the length
/// unit.
#[test]
fn errors_weigh_the_same_in_every_unit() {
    for (unit, millimetre) in [
        (LengthUnit::Millimetre, 1.0),
        (LengthUnit::Metre, 1e-3),
        (LengthUnit::Inch, 1.0 / 25.4),
    ] {
        let mut study = study(&[THREE, "setup.want={camber=-1.5,scrub_radius=20.0}"]);
        let Vehicle::Wheel(wheel) = &mut study.vehicle else {
            unreachable!("a study of one wheel")
        };
        wheel.suspension.length_unit = unit;
        with(&study, |problem, _| {
            assert_eq!(problem.statics.len(), 6);
            for (of, weight) in problem.statics.iter().zip(&problem.weights) {
                let as_much = match of {
                    Static::RideHeightChange => millimetre,
                    Static::Characteristic(Characteristic::ScrubRadius) => millimetre,
                    Static::Characteristic(Characteristic::BumpSteer) => 1e-3 / millimetre,
                    Static::Characteristic(_) => 0.1,
                    Static::Axle(_) => unreachable!("a study of one wheel"),
                };
                assert!((weight * as_much - 1.0).abs() < 1e-14, "{unit:?} {of:?}");
            }
        });
    }
}

/// An aim is met within the allowed error plus 1e-9. The error names a missed aim even if its value does not exist.
#[test]
fn aims_are_met_to_rounding() {
    let errors = [5e-9, -5e-9, 5e-10, -5e-10, 0.5, -0.501].map(Some);
    let allowed = [0.0, 0.0, 0.0, 0.0, 0.5, 0.5];
    let expected = [false, false, true, true, true, false];
    assert_eq!(within(&errors, &allowed), expected);
    assert_eq!(within(&[None], &[0.0]), [true]);

    with(&study(&[THREE]), |problem, drawn| {
        let targets = problem.targets();
        assert_eq!(targets.len(), 3);
        let mut state = drawn.clone();
        for i in &targets {
            state.values[*i] = problem.aims[*i].value().unwrap();
        }
        let missed = |state: &AdjustedSuspension| match problem.out_of_reach(state, &targets) {
            SetUpError::OutOfReach(missed) => missed.iter().map(|m| m.of).collect::<Vec<_>>(),
            other => panic!("{other:?}"),
        };
        assert_eq!(missed(&state), []);
        for i in &targets {
            for off in [1e-6, f64::NAN] {
                let mut state = state.clone();
                state.values[*i] += off;
                assert_eq!(missed(&state), [problem.statics[*i]]);
            }
        }
    });
}

/// Half a step of a shim may cause half its effect plus 1 %. A thread adds the effect of half a sixteenth of a turn.
#[test]
fn half_steps_allow_half_effects() {
    let shim =
        "setup={adjust=[{shim=\"upper_ball_joint\",axis=\"y\",step=0.5}],want={camber=-1.5}}";
    let both = "setup={adjust=[{shim=\"upper_ball_joint\",axis=\"y\",step=0.5},\
                {length=\"tie_rod\",per_turn=2.0}],want={camber=-1.5,toe=-0.1}}";
    for (setup, has_thread) in [(shim, false), (both, true)] {
        let study = study(&[setup]);
        let assembler = Assembler::new(study.wheel()).unwrap();
        let found = SetUp::solve(&study, study.setup.as_ref().unwrap(), &assembler).unwrap();
        let by = &found.last().by;
        // The thread restores toe, and changes camber a little.
        let effect = if has_thread {
            by[0][0] - by[1][0] * by[0][1] / by[1][1]
        } else {
            by[0][0]
        };
        let allowed = 1.01 * 0.25 * effect.abs();
        assert!((found.allowed[0] / allowed - 1.0).abs() < 1e-9);
        let thread = if has_thread {
            1.01 * 0.5 * 2.0 / 16.0 * by[1][0].abs()
        } else {
            0.0
        };
        let turned = found.allowed_rounded[0] - found.allowed[0];
        assert!((turned - thread).abs() < 1e-12, "{turned} {thread}");
    }
}

/// An adjustment of up to a tenth of the suspension's size is accepted. A larger one is refused with its amount.
#[test]
fn adjustments_beyond_a_tenth_of_the_size_are_refused() {
    let adjust = "setup.adjust=[{shim=\"upper_ball_joint\",axis=\"y\"}]";
    let at = |amount: f64| {
        let study = study(&[
            adjust,
            "setup.want={camber=0.0}",
            "setup.ride_height_change=0.0",
        ]);
        let size = study.wheel().size();
        let camber = with(&study, |problem, _| {
            problem.state(&[amount * size]).unwrap().values[0]
        });
        let want = format!("setup.want={{camber={camber:?}}}");
        let study = self::study(&[adjust, &want, "setup.ride_height_change=0.0"]);
        let assembler = Assembler::new(study.wheel()).unwrap();
        let found = SetUp::solve(&study, study.setup.as_ref().unwrap(), &assembler);
        found.map(|found| found.last().amounts[0] / size)
    };
    assert!((at(-0.09).unwrap() + 0.09).abs() < 1e-9);
    match at(-0.11) {
        Err(SetUpError::Absurd { adjustment: 0, .. }) => {}
        other => panic!("{other:?}"),
    }
}

const SHIMS: [&str; 5] = [
    "{shim=\"upper_ball_joint\",axis=\"y\",step=0.5}",
    "{shim=\"upper_arm_front\",axis=\"y\",step=0.7}",
    "{shim=\"upper_arm_rear\",axis=\"y\",step=0.3}",
    "{shim=\"tie_rod_inner\",axis=\"y\",step=0.4}",
    "{shim=\"tie_rod_inner\",axis=\"z\",step=1.0}",
];

fn shims() -> Study {
    study(&[
        &format!("setup.adjust=[{}]", SHIMS.join(",")),
        "setup.want={camber=-2.3,toe=0.1,caster=4.0}",
        "setup.ride_height_change=0.0",
    ])
}

/// The neighbours are the nearest amounts and the eight best of all roundings up and down, by the linear model.
#[test]
fn neighbours_are_the_best_of_all_roundings() {
    with(&shims(), |problem, drawn| {
        let levels = problem.levels(drawn);
        assert_eq!((levels.rest.len(), levels.threads.len()), (3, 0));
        let steps: Vec<f64> = problem.shims().map(|(_, step)| step).collect();
        for number in 0..6 {
            let part = |k: usize| 1.3 * (0.3 + k as f64 + 1.7 * f64::from(number)).sin();
            let amounts: Vec<f64> = (0..5).map(part).collect();
            let real = problem.state(&amounts).unwrap();
            let errors = problem.errors(&real, &levels.rest);
            let effects = problem.effects(&real, &levels.rest, &levels.shims);
            let mut all: Vec<(f64, Vec<f64>)> = (0..32)
                .map(|choice| {
                    let whole = |k: usize| {
                        let steps = (amounts[k] / steps[k]).floor();
                        steps + f64::from(choice >> k & 1)
                    };
                    let whole: Vec<f64> = (0..5).map(|k| whole(k) * steps[k]).collect();
                    let off = DVector::from_fn(5, |k, _| whole[k] - amounts[k]);
                    ((&errors + &effects * off).norm(), whole)
                })
                .collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut expected: Vec<_> = all.into_iter().take(8).map(|(_, whole)| whole).collect();
            let nearest = (0..5).map(|k| (amounts[k] / steps[k]).round() * steps[k]);
            let nearest: Vec<f64> = nearest.collect();
            if !expected.contains(&nearest) {
                expected.push(nearest);
            }
            assert_eq!(problem.neighbours(&real, &levels), expected, "{number}");
        }
    });
}

/// Shims within 1e-9 of whole steps count as whole. Without remaining errors, shims take the nearest whole steps.
#[test]
fn whole_shims_have_one_neighbour() {
    with(&shims(), |problem, drawn| {
        let levels = problem.levels(drawn);
        let count = |off: f64, levels: &Levels| {
            let amounts = [(3.0 + off) * 0.5, 0.0, 0.0, 0.0, 0.0];
            let real = problem.state(&amounts).unwrap();
            problem.neighbours(&real, levels).len()
        };
        assert_eq!((count(5e-10, &levels), count(5e-9, &levels)), (1, 2));
        let met = Levels {
            rest: Vec::new(),
            ..levels
        };
        assert_eq!(count(0.4, &met), 1);
    });
}
