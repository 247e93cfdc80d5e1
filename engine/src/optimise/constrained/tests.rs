//! Problems whose constrained minima are known.

use super::super::test_problems::{Noise, Values, stated};
use super::super::{Bounds, Control, Options, Termination};
use super::{ConstrainedFit, constrained_fit};
use nalgebra::{DMatrix, DVector};

fn solve<F: FnMut(&[f64]) -> [Values; 3]>(
    start: &[f64],
    ranges: &[[f64; 2]],
    equalities: usize,
    level: f64,
    at: F,
) -> ConstrainedFit {
    let problem = stated(start, equalities, level, at);
    let bounds = Bounds::new(ranges).unwrap();
    let start = DVector::from_column_slice(start);
    let options = Options::default();
    constrained_fit(0, problem, &bounds, &start, &options, Control::default()).unwrap()
}

fn near(found: &DVector<f64>, wanted: &[f64], bound: f64) {
    let off = (found - DVector::from_column_slice(wanted)).amax();
    assert!(off < bound, "{found} {wanted:?}");
}

/// Least squares with one linear row, between bounds that are not round numbers. In the result, each variable lies exactly
/// on a bound, or its distance from the bounds is larger than the solver's resolution.
#[test]
fn variables_at_bounds_are_exactly_on_them() {
    let mut noise = Noise::new(11);
    let mut on_bounds = 0;
    for _ in 0..400 {
        let n = 4;
        let aims: Vec<f64> = (0..n).map(|_| 3.0 * noise.next()).collect();
        let mix: Vec<f64> = (0..n * n).map(|_| noise.next()).collect();
        let ranges: Vec<[f64; 2]> = (0..n)
            .map(|_| [-0.1 - noise.next().abs(), 0.1 + noise.next().abs()])
            .collect();
        let at = |x: &[f64]| {
            let goal = (0..n).map(|i| {
                let mut row = mix[i * n..][..n].to_vec();
                row[i] += 2.0;
                let value: f64 = row
                    .iter()
                    .zip(x)
                    .zip(&aims)
                    .map(|((a, x), aim)| a * (x - aim))
                    .sum();
                (
                    value + 0.1 * value * value,
                    row.iter().map(|a| a * (1.0 + 0.2 * value)).collect(),
                )
            });
            let plane = (x.iter().sum::<f64>() - 0.3, vec![1.0; n]);
            [goal.collect(), vec![], vec![plane]]
        };
        let fit = solve(&[0.0; 4], &ranges, 0, f64::INFINITY, at);
        for (x, [lower, upper]) in fit.x.iter().zip(&ranges) {
            let near = (x - lower).min(upper - x) / (0.5 * (upper - lower));
            assert!(near == 0.0 || near > 1e-12, "{near:e}");
            on_bounds += usize::from(near == 0.0);
        }
    }
    assert!(on_bounds > 400, "{on_bounds}");
}

/// Rosenbrock's valley within a disc. The minimum lies on the circle, where the gradient points outward.
#[test]
fn rosenbrock_in_a_disc_ends_on_its_edge() {
    let at = |x: &[f64]| {
        let goal = vec![
            (10.0 * (x[1] - x[0] * x[0]), vec![-20.0 * x[0], 10.0]),
            (1.0 - x[0], vec![-1.0, 0.0]),
        ];
        let disc = x[0] * x[0] + x[1] * x[1] - 1.0;
        [goal, vec![], vec![(disc, vec![2.0 * x[0], 2.0 * x[1]])]]
    };
    for start in [[-1.2, 1.0], [0.0, 0.0], [1.5, -1.5], [2.0, 2.0]] {
        let fit = solve(&start, &[[-3.0, 3.0]; 2], 0, f64::INFINITY, at);
        // The expected numbers solve the first-order conditions on the circle, by Newton's method to full precision.
        near(&fit.x, &[0.786_415_154_172, 0.617_698_316_529], 1e-8);
        assert!(fit.is_feasible() && fit.multipliers[0] > 0.0);
        assert!(fit.imbalance < 1e-6, "{}", fit.imbalance);
        assert!(fit.history.len() < 40, "{}", fit.history.len());
    }
}

/// The solver finds the exact projection of a point onto the intersection of a plane and a half-space, within the box.
#[test]
fn projections_are_exact_and_multipliers_are_prices() {
    let at = |limit: f64| {
        move |x: &[f64]| {
            let goal = (0..3).map(|j| {
                let mut gradient = vec![0.0; 3];
                gradient[j] = 1.0;
                (x[j] - [3.0, 1.0, -2.0][j], gradient)
            });
            let plane = (x[0] + x[1] + x[2], vec![1.0; 3]);
            let half = (x[0] - limit, vec![1.0, 0.0, 0.0]);
            [goal.collect(), vec![], vec![plane, half]]
        }
    };
    let run = |limit| solve(&[0.0; 3], &[[-5.0, 5.0]; 3], 1, f64::INFINITY, at(limit));
    let fit = run(1.0);
    near(&fit.x, &[1.0, 1.0, -2.0], 1e-9);
    let fit = run(0.5);
    near(&fit.x, &[0.5, 1.25, -1.75], 1e-9);
    // Multiplier of the limit: the derivative of the goal with respect to the limit, negated.
    let step = 1e-3;
    let goal = |limit| run(limit).at.goal.cost();
    let slope = (goal(0.5 + step) - goal(0.5 - step)) / (2.0 * step);
    assert!(
        (fit.multipliers[1] + slope).abs() < 1e-6,
        "{slope} {:?}",
        fit.multipliers
    );
}

/// If two discs do not intersect, the run names both discs. No small move from the end of the run reduces the violation.
#[test]
fn a_planted_contradiction_ends_with_its_rows() {
    let at = |x: &[f64]| {
        let circle = |a: f64| {
            let value = (x[0] - a) * (x[0] - a) + x[1] * x[1] - 1.0;
            (value, vec![2.0 * (x[0] - a), 2.0 * x[1]])
        };
        let idle = (x[1] - 10.0, vec![0.0, 1.0]);
        let goal = vec![(x[1] - 1.0, vec![0.0, 1.0]), (x[0], vec![1.0, 0.0])];
        [goal, vec![], vec![circle(-2.0), idle, circle(2.0)]]
    };
    let fit = solve(&[0.3, 2.0], &[[-5.0, 5.0]; 2], 0, f64::INFINITY, at);
    assert_eq!(fit.termination, Termination::ConstraintsExcludeEachOther);
    let rows = fit
        .culprits
        .iter()
        .filter(|h| matches!(h, super::super::Held::Row(0 | 2)));
    assert_eq!(rows.count(), 2, "{:?}", fit.culprits);
    assert_eq!(fit.culprits.len(), 2);
    assert!(fit.history.len() < 40);
}

/// Residuals vanish on a circle, and their norm is limited. The point nearest to (2, 1) is on the boundary of the allowed
/// band around the circle.
#[test]
fn a_level_is_met_exactly_even_about_a_zero_of_its_residuals() {
    // The constraint is |b| = |x0^2 + x1^2 - 1| <= level. The goal is the distance from (2, 1). The solution lies on the
    // ray from the origin through this point.
    for level in [0.5, 0.1, 1e-3, 1e-6] {
        let at = |x: &[f64]| {
            let goal = vec![(x[0] - 2.0, vec![1.0, 0.0]), (x[1] - 1.0, vec![0.0, 1.0])];
            let circle = x[0] * x[0] + x[1] * x[1] - 1.0;
            [goal, vec![(circle, vec![2.0 * x[0], 2.0 * x[1]])], vec![]]
        };
        for start in [[0.6, 0.8], [2.0, 1.0]] {
            let fit = solve(&start, &[[-3.0, 3.0]; 2], 0, level, at);
            let radius = (1.0 + level).sqrt();
            let unit = 1.0 / 5.0_f64.sqrt();
            near(&fit.x, &[2.0 * unit * radius, unit * radius], 1e-6);
            assert!(
                fit.is_feasible(),
                "{level} {start:?} {} {}",
                fit.violation,
                fit.termination
            );
        }
    }
}

/// No point within the bounds satisfies the constraint row. The smallest violation is at a corner of the bounds, and the
/// goal decreases away from this corner. The run ends exactly at the corner.
#[test]
fn an_unreachable_row_ends_exactly_on_the_bounds() {
    let mut noise = Noise::new(23);
    for _ in 0..200 {
        let slopes: Vec<f64> = (0..3)
            .map(|_| noise.next())
            .map(|s| s + 0.3 * s.signum())
            .collect();
        let ranges: Vec<[f64; 2]> = (0..3)
            .map(|_| [-0.1 - noise.next().abs(), 0.1 + noise.next().abs()])
            .collect();
        let at = |x: &[f64]| {
            let goal = (0..3).map(|j| {
                let mut gradient = vec![0.0; 3];
                gradient[j] = 5.0;
                (5.0 * (x[j] - slopes[j]), gradient)
            });
            let sum: f64 = slopes.iter().zip(x).map(|(s, x)| s * x).sum();
            let gradient = slopes.iter().map(|s| s * (1.0 + 0.02 * sum));
            let row = (20.0 + sum + 0.01 * sum * sum, gradient.collect());
            [goal.collect(), vec![], vec![row]]
        };
        let fit = solve(&[0.0; 3], &ranges, 0, f64::INFINITY, at);
        assert_eq!(fit.termination, Termination::ConstraintsExcludeEachOther);
        let corner = slopes.iter().zip(&ranges);
        let corner: Vec<f64> = corner.map(|(s, r)| r[usize::from(*s < 0.0)]).collect();
        assert_eq!(fit.x.as_slice(), corner);
    }
}

/// Random problems with curved residuals and curved rows. At the ends of at least 59 of 60 runs, the multipliers balance the
/// slopes.
#[test]
fn random_constrained_problems_end_at_kuhn_tucker_points() {
    let (mut balanced, mut evaluations) = (0, Vec::new());
    for seed in 0..60 {
        let mut noise = Noise::new(500 + seed);
        let n = 2 + seed as usize % 7;
        let (m, k) = (40, 30);
        let a = DMatrix::from_fn(m, n, |_, _| noise.next());
        let b = DVector::from_fn(m, |_, _| noise.next());
        let goal = DVector::from_fn(n, |_, _| 1.5 * noise.next());
        let c = DMatrix::from_fn(k, n, |_, _| noise.next());
        let bend = DVector::from_fn(k, |_, _| 0.3 * noise.next());
        let slack = DVector::from_fn(k, |_, _| 0.1 + 0.3 * noise.next().abs());
        let curve = 0.2 * noise.next();
        let equalities = usize::from(seed % 3 == 0);
        let at = move |x: &[f64]| {
            let x = DVector::from_column_slice(x);
            let square = x.norm_squared();
            let r = &a * (&x - &goal) + square * curve * &b;
            let residual = |i: usize| {
                let gradient = a.row(i).transpose() + 2.0 * curve * b[i] * &x;
                (r[i], gradient.data.into())
            };
            let row = |i: usize| {
                let slack = if i < equalities { 0.0 } else { slack[i] };
                let value = c.row(i).transpose().dot(&x) + bend[i] * square - slack;
                let gradient = c.row(i).transpose() + 2.0 * bend[i] * &x;
                (value, gradient.data.into())
            };
            [
                (0..m).map(residual).collect(),
                vec![],
                (0..k).map(row).collect(),
            ]
        };
        let start = vec![0.0; n];
        let fit = solve(&start, &vec![[-1.0, 1.2]; n], equalities, f64::INFINITY, at);
        assert!(
            fit.is_feasible(),
            "seed {seed}: {} {}",
            fit.violation,
            fit.termination
        );
        assert!(
            fit.termination.at_minimum(),
            "seed {seed}: {}",
            fit.termination
        );
        balanced += usize::from(fit.imbalance < 1e-6);
        evaluations.push(fit.evaluations());
        for (row, multiplier) in fit.multipliers.iter().enumerate().skip(equalities) {
            assert!(*multiplier >= 0.0, "seed {seed} row {row}: {multiplier}");
        }
    }
    evaluations.sort_unstable();
    assert!(balanced >= 59, "{balanced} of 60");
    assert!(evaluations[30] <= 12, "{evaluations:?}");
}

/// A problem with large residuals, for which the Gauss-Newton method alone would take hundreds of iterations.
#[test]
fn curvature_is_learnt_where_residuals_are_large() {
    let at = |x: &[f64]| {
        let goal = (0..20).map(|i| {
            let t = f64::from(i + 1) / 5.0;
            let (first, second) = (x[0] + t * x[1] - t.exp(), x[2] + x[3] * t.sin() - t.cos());
            let value = first * first + second * second;
            let gradient = vec![
                2.0 * first,
                2.0 * first * t,
                2.0 * second,
                2.0 * second * t.sin(),
            ];
            (value, gradient)
        });
        [
            goal.collect(),
            vec![],
            vec![(x[0] - 20.0, vec![1.0, 0.0, 0.0, 0.0])],
        ]
    };
    // Brown and Dennis: least sum of squares 85822.2 (problem 16 of Moré, Garbow and Hillstrom).
    let fit = solve(
        &[25.0, 5.0, -5.0, -1.0],
        &[[-50.0, 50.0]; 4],
        0,
        f64::INFINITY,
        at,
    );
    let sum = 2.0 * fit.at.goal.cost();
    assert!((sum - 85_822.2).abs() < 0.1, "{sum} {}", fit.termination);
    assert!(fit.evaluations() < 60, "{}", fit.evaluations());
}

/// Rosenbrock's valley in a disc, with added constant rows. The slopes of these rows are only rounding errors. The third row
/// has the value `missed`; the others are at the limit.
fn beside_still_rows(noise: f64, missed: f64, equalities: usize) -> ConstrainedFit {
    let at = move |x: &[f64]| {
        let goal = vec![
            (10.0 * (x[1] - x[0] * x[0]), vec![-20.0 * x[0], 10.0]),
            (1.0 - x[0], vec![-1.0, 0.0]),
        ];
        let disc = x[0] * x[0] + x[1] * x[1] - 1.0;
        let still = (noise, vec![noise, -noise]);
        let far = (missed, vec![0.0, noise]);
        let rows = vec![
            still.clone(),
            still,
            far,
            (disc, vec![2.0 * x[0], 2.0 * x[1]]),
        ];
        [goal, vec![], rows]
    };
    let ranges = [[-3.0, 3.0]; 2];
    solve(&[-1.2, 1.0], &ranges, equalities, f64::INFINITY, at)
}

/// Constant rows change neither the minimum nor its multipliers, whatever their rounding.
#[test]
fn rows_that_stand_still_change_nothing() {
    for noise in [0.0, 1e-300, 1e-17, -1e-17, 1e-13] {
        for missed in [-1.0, 0.0, noise, 5.0] {
            for equalities in [0, 2, 3] {
                let fit = beside_still_rows(noise, missed, equalities);
                near(&fit.x, &[0.786_415_154_172, 0.617_698_316_529], 1e-8);
                assert!(
                    fit.is_feasible() && fit.termination.at_minimum(),
                    "{}",
                    fit.termination
                );
                assert!(fit.imbalance < 1e-6, "{noise} {missed}: {}", fit.imbalance);
                assert_eq!(fit.multipliers[..3], [0.0; 3]);
                assert!(fit.multipliers[3] > 0.0);
                assert_eq!(fit.movable, [false, false, false, true]);
                assert!(fit.evaluations() < 60);
            }
        }
    }
}

/// The solver uses a row whose slope vanishes at the start and that binds elsewhere.
#[test]
fn a_row_that_begins_to_move_is_counted() {
    // The constraint is x1^2 <= 1/4. The start is x1 = 0. The goal has its minimum at x = (1, 2).
    let at = |x: &[f64]| {
        let goal = vec![(x[0] - 1.0, vec![1.0, 0.0]), (x[1] - 2.0, vec![0.0, 1.0])];
        let row = (x[1] * x[1] - 0.25, vec![0.0, 2.0 * x[1]]);
        [goal, vec![], vec![row]]
    };
    let fit = solve(&[0.0, 0.0], &[[-3.0, 3.0]; 2], 0, f64::INFINITY, at);
    near(&fit.x, &[1.0, 0.5], 1e-7);
    assert!(
        fit.is_feasible() && fit.termination.at_minimum(),
        "{}",
        fit.termination
    );
    assert!(
        (fit.multipliers[0] - 1.5).abs() < 1e-5,
        "{:?}",
        fit.multipliers
    );
}

/// With the same row three times, the run finds the minimum and reports that the multipliers are not unique.
#[test]
fn multipliers_of_equal_rows_are_known_to_be_open() {
    for wobble in [0.0, 1e-16, 1e-13] {
        let at = move |x: &[f64]| {
            let goal = vec![(x[0] - 1.0, vec![1.0, 0.0]), (x[1] - 2.0, vec![0.0, 1.0])];
            let row = |k: f64| (x[0] + x[1] - 1.0 + k * wobble, vec![1.0 + k * wobble, 1.0]);
            [goal, vec![], vec![row(0.0), row(1.0), row(-1.0)]]
        };
        let fit = solve(&[0.0, 0.0], &[[-3.0, 3.0]; 2], 0, f64::INFINITY, at);
        near(&fit.x, &[0.0, 1.0], 1e-7);
        assert!(
            fit.termination.at_minimum() && fit.imbalance < 1e-6,
            "{wobble}: {} {}",
            fit.termination,
            fit.imbalance
        );
        let sum: f64 = fit.multipliers.iter().sum();
        assert!((sum - 1.0).abs() < 1e-6, "{:?}", fit.multipliers);
        let other = fit.alternatives.unwrap();
        assert!((other.iter().sum::<f64>() - 1.0).abs() < 1e-6, "{other:?}");
        let apart = fit
            .multipliers
            .iter()
            .zip(&other)
            .map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f64::max) > 0.1, "{other:?}");
    }
}

/// A run stops at the next evaluation after a request to stop. It also stops when its budget of evaluations is used up, even
/// while all trial steps are refused.
#[test]
fn evaluations_end_at_a_request_and_at_their_budget() {
    use std::cell::Cell;
    use std::sync::atomic::{AtomicBool, Ordering};
    for stop_at in [1, 2, 5, 9] {
        for by_flag in [true, false] {
            let (flag, count) = (AtomicBool::new(false), Cell::new(0_u64));
            let at = |x: &[f64]| {
                count.set(count.get() + 1);
                // The first evaluation only determines the shape of the problem. It is not part of the run.
                if by_flag && count.get() == stop_at + 1 {
                    flag.store(true, Ordering::Relaxed);
                }
                let goal = vec![
                    (100.0 * (x[1] - x[0] * x[0]), vec![-200.0 * x[0], 100.0]),
                    (1.0 - x[0], vec![-1.0, 0.0]),
                ];
                let disc = x[0] * x[0] + x[1] * x[1] - 1.0;
                [goal, vec![], vec![(disc, vec![2.0 * x[0], 2.0 * x[1]])]]
            };
            let problem = stated(&[-1.2, 1.0], 0, f64::INFINITY, at);
            let bounds = Bounds::new(&[[-3.0, 3.0]; 2]).unwrap();
            let options = Options {
                max_evaluations: if by_flag { 2000 } else { stop_at - 1 },
                ..Options::default()
            };
            let control = Control {
                interrupt: Some(&flag),
                watch: None,
            };
            let start = DVector::from_column_slice(&[-1.2, 1.0]);
            let fit = constrained_fit(0, problem, &bounds, &start, &options, control).unwrap();
            assert_eq!(count.get(), stop_at + 1);
            assert_eq!(fit.evaluations(), stop_at);
            let wanted = if by_flag {
                Termination::Interrupted
            } else {
                Termination::EvaluationLimit
            };
            assert_eq!(fit.termination, wanted);
        }
    }
}
