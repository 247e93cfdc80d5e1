//! Tests of complete runs.

use super::test_problems::{
    Function, Noise, PUBLISHED, Rows, freudenstein_roth, rosenbrock, vector, written,
};
use super::*;
use nalgebra::{DMatrix, DVector};
use std::sync::atomic::{AtomicBool, Ordering};

fn run(
    rows: impl Fn(&[f64]) -> Rows,
    ranges: &[[f64; 2]],
    start: &[f64],
    options: &Options,
) -> Fit {
    let problem = written(rows, start);
    let bounds = Bounds::new(ranges).unwrap();
    let start = vector(start);
    fit(0, problem, &bounds, &start, options, Control::default()).unwrap()
}

/// Options for a run that stops only if no step lowers the cost any further.
fn to_the_end() -> Options {
    Options {
        misfit_below: 0.0,
        reduction_below: 64.0 * f64::EPSILON,
        ..Options::default()
    }
}

fn sum_of_squares(fit: &Fit) -> f64 {
    fit.evaluation.residuals.norm_squared()
}

/// Largest violation of the Kuhn-Tucker conditions, as the cosine of the angle between the residuals and a column of the
/// Jacobian.
fn violation(fit: &Fit) -> f64 {
    let Linearisation {
        residuals,
        jacobian,
    } = &fit.evaluation;
    let cosine = |j: usize| {
        let column = jacobian.column(j);
        let cosine = column.dot(residuals) / (column.norm() * residuals.norm());
        match fit.active_bounds[j] {
            ActiveBound::Free => cosine.abs(),
            ActiveBound::Lower => (-cosine).max(0.0),
            ActiveBound::Upper => cosine.max(0.0),
        }
    };
    (0..fit.active_bounds.len())
        .map(cosine)
        .fold(0.0, crate::number::larger)
}

#[test]
fn val_published_minima_are_found() {
    for published in PUBLISHED {
        let fit = run(
            published.rows,
            published.ranges,
            published.start,
            &to_the_end(),
        );
        let found = sum_of_squares(&fit);
        let name = published.name;
        println!(
            "{name}: {found:e} in {} iterations, {} evaluations: {}",
            fit.history.len() - 1,
            fit.evaluations(),
            fit.termination
        );
        assert!(fit.termination.at_minimum(), "{name}: {}", fit.termination);
        assert!(
            fit.history.len() <= 100,
            "{name}: {} iterations",
            fit.history.len()
        );
        if published.sum_of_squares == 0.0 {
            assert!(found < 1e-24, "{name}: {found:e}");
        } else {
            // The comparison covers all published digits.
            let off = (found - published.sum_of_squares).abs() / published.sum_of_squares;
            assert!(off < 5e-6, "{name}: {found:e}");
            assert!(violation(&fit) < 1e-6, "{name}: {:e}", violation(&fit));
        }
    }
}

/// Compares the derivatives with central differences. With the step h, the cube root of the rounding error, the error of the
/// differences is about h^2 = 4e-11 times the third derivatives. Third derivatives here go up to a thousand.
#[test]
fn derivatives_of_the_test_problems_are_right() {
    for published in PUBLISHED {
        let n = published.start.len();
        for (i, (_, gradient)) in (published.rows)(published.start)
            .unwrap()
            .iter()
            .enumerate()
        {
            for j in 0..n {
                let residual = |offset: f64| {
                    let mut x = published.start.to_vec();
                    x[j] += offset;
                    (published.rows)(&x).unwrap()[i].0
                };
                let h = f64::EPSILON.cbrt();
                let difference = (residual(h) - residual(-h)) / (2.0 * h);
                let scale = 1.0 + residual(0.0).abs() + gradient[j].abs();
                let off = (gradient[j] - difference).abs();
                assert!(off < 1e-7 * scale, "{} {i} {j}: {off:e}", published.name);
            }
        }
    }
}

/// Compares with the closed-form minimiser of problem 2 of Hock and Schittkowski.
#[test]
fn val_a_bound_active_at_the_minimum_is_met_exactly() {
    let fit = run(
        rosenbrock,
        &[[-100.0, 100.0], [1.5, 100.0]],
        &[2.0, 3.0],
        &to_the_end(),
    );
    let a = (598.0_f64 / 1200.0).sqrt();
    let b = 400.0 * a * a * a;
    let x = 2.0 * a * ((1.0 / b).acos() / 3.0).cos();
    assert_eq!(fit.x[1], 1.5);
    assert_eq!(fit.active_bounds, [ActiveBound::Free, ActiveBound::Lower]);
    assert!((fit.x[0] - x).abs() < 1e-8, "{} {x}", fit.x[0]);
}

/// Near a zero of the residuals, the misfit after an iteration is at most the square of the misfit before it.
#[test]
fn zeros_are_approached_quadratically() {
    let fit = run(
        freudenstein_roth,
        &[[-100.0, 100.0]; 2],
        &[6.0, 5.0],
        &to_the_end(),
    );
    assert!((&fit.x - vector(&[5.0, 4.0])).amax() < 1e-14, "{}", fit.x);
    let misfits: Vec<f64> = fit.history.iter().map(|i| i.misfit).collect();
    let near = misfits
        .windows(2)
        .filter(|pair| pair[0] < 1.0 && pair[0] > 1e-7);
    for pair in near {
        assert!(pair[1] <= pair[0] * pair[0], "{misfits:?}");
    }
}

/// Residuals that are nonlinear functions of the sum of the variables.
fn seen_by_its_sum(target: f64) -> impl Fn(&[f64]) -> Rows {
    move |x: &[f64]| {
        let sum = x[0] + x[1] + x[2];
        let row = |i: usize| {
            let t = i as f64 / 10.0;
            let slope = t + 0.1 * sum;
            (t * sum + 0.05 * sum * sum - t * target, vec![slope; 3])
        };
        Ok((0..20).map(row).collect())
    }
}

#[test]
fn what_the_residuals_do_not_see_stays_where_it_is() {
    // In the first case the residuals can reach zero; in the second case their minimum is above zero.
    for target in [0.0, 1.0] {
        let start = [0.5, -0.1, 0.2];
        let fit = run(
            seen_by_its_sum(target),
            &[[-2.0, 2.0]; 3],
            &start,
            &Options::default(),
        );
        assert!(fit.termination.at_minimum(), "{}", fit.termination);
        assert!(fit.history.len() < 20, "{} iterations", fit.history.len());
        // The move is along (1, 1, 1), because the ranges are equal.
        let moves: Vec<f64> = fit
            .x
            .iter()
            .zip(start)
            .map(|(x, start)| x - start)
            .collect();
        assert!(
            (moves[0] - moves[1]).abs() < 1e-5 && (moves[1] - moves[2]).abs() < 1e-5,
            "{moves:?}"
        );
    }
}

/// Fits a random linear map of rank 3 on 6 variables, with residuals that cannot be zero. Rounding causes tiny singular
/// values. The design must not move along their directions.
#[test]
fn rounding_does_not_move_a_rank_deficient_fit() {
    for seed in 0..20 {
        let mut noise = Noise::new(seed);
        let left = DMatrix::from_fn(82, 3, |_, _| 1000.0 * noise.next());
        let right = DMatrix::from_fn(3, 6, |_, _| noise.next());
        let a = &left * &right;
        let b = DVector::from_fn(82, |_, _| 100.0 * noise.next());
        let (a_, b_) = (a.clone(), b.clone());
        let rows = move |x: &[f64]| {
            let r = &a_ * DVector::from_column_slice(x) - &b_;
            let row = |i: usize| (r[i], a_.row(i).iter().copied().collect());
            Ok((0..82).map(row).collect())
        };
        let fit = run(rows, &[[-1.0, 1.0]; 6], &[0.0; 6], &to_the_end());
        assert!(fit.termination.at_minimum(), "{}", fit.termination);
        assert!(
            fit.active_bounds
                .iter()
                .all(|&hold| hold == ActiveBound::Free)
        );
        // Part of the variables' move that lies outside the span of the rows of `right`. This part has no effect on the
        // residuals.
        let square = &right * right.transpose();
        let seen = right.transpose() * square.lu().solve(&(&right * &fit.x)).unwrap();
        let unseen = (&fit.x - seen).norm();
        assert!(unseen < 1e-5, "seed {seed}: {unseen:e} of {}", fit.x.norm());
    }
}

/// The singular values span eight decades and the solution is known. The run finds every coordinate of the solution.
#[test]
fn val_a_planted_design_is_found_through_weak_directions() {
    for seed in 0..10 {
        let mut noise = Noise::new(100 + seed);
        let q = DMatrix::from_fn(82, 6, |_, _| noise.next()).qr().q();
        let v = DMatrix::from_fn(6, 6, |_, _| noise.next()).qr().q();
        let s = DMatrix::from_diagonal(&DVector::from_fn(6, |i, _| {
            1e3 * 10f64.powf(-1.6 * i as f64)
        }));
        let a = q * s * v;
        let planted = DVector::from_fn(6, |_, _| 0.015 * noise.next());
        let truth = planted.clone();
        let rows = move |x: &[f64]| {
            let move_ = DVector::from_column_slice(x) - &truth;
            // The residuals are nonlinear, so the solver needs more than one step.
            let curved = move_.map(|d| d + 3.0 * d * d);
            let slopes = move_.map(|d| 1.0 + 6.0 * d);
            let r = &a * curved;
            let row = |i: usize| {
                (
                    r[i],
                    a.row(i).transpose().component_mul(&slopes).data.into(),
                )
            };
            Ok((0..82).map(row).collect())
        };
        let options = Options {
            misfit_below: 0.0,
            ..Options::default()
        };
        let fit = run(rows, &[[-0.02, 0.02]; 6], &[0.0; 6], &options);
        let off = (&fit.x - planted).amax();
        assert!(off < 1e-9, "seed {seed}: {off:e} after {}", fit.termination);
        assert!(fit.history.len() < 40, "{} iterations", fit.history.len());
    }
}

/// Rosenbrock's function, with no residuals in a forbidden region: right of a line through the valley, or beyond a parabola.
fn fenced(fence: fn(&[f64]) -> bool) -> impl Fn(&[f64]) -> Rows {
    move |x: &[f64]| {
        if fence(x) {
            Err(Infeasible::Refused("beyond the fence".into()))
        } else {
            rosenbrock(x)
        }
    }
}

#[test]
fn infeasible_trials_are_counted_and_avoided() {
    let fit = run(
        fenced(|x| x[1] < x[0] * x[0] - 0.2),
        &[[-3.0, 3.0]; 2],
        &[-1.2, 1.5],
        &Options::default(),
    );
    assert!((&fit.x - vector(&[1.0, 1.0])).amax() < 1e-9, "{}", fit.x);
    assert!(fit.history.iter().any(|i| i.infeasible > 0));
}

#[test]
fn a_minimum_out_of_reach_ends_with_its_reason() {
    let fit = run(
        fenced(|x| x[0] > 0.5),
        &[[-3.0, 3.0]; 2],
        &[-1.2, 1.0],
        &Options::default(),
    );
    let reason = Infeasible::Refused("beyond the fence".into());
    assert_eq!(fit.termination, Termination::NoFeasibleStep(reason));
    assert!(fit.x[0] <= 0.5 && fit.x[0] > 0.5 - 1e-6, "{}", fit.x);
}

#[test]
fn residuals_that_are_not_numbers_are_refused_with_a_reason() {
    let rows: Function = |x| Ok(vec![(x[0], vec![1.0]), ((x[0] - 1.0).sqrt(), vec![1.0])]);
    let bounds = Bounds::new(&[[-2.0, 2.0]]).unwrap();
    let start = vector(&[0.0]);
    let options = Options::default();
    let problem = written(rows, &[0.0]);
    let refused = fit(0, problem, &bounds, &start, &options, Control::default()).unwrap_err();
    assert!(
        refused.to_string().starts_with("residual 1 is NaN"),
        "{refused}"
    );
}

#[test]
fn a_start_without_residuals_is_an_error_with_its_reason() {
    let bounds = Bounds::new(&[[-3.0, 3.0]; 2]).unwrap();
    let start = vector(&[2.0, 0.0]);
    let options = Options::default();
    let problem = written(fenced(|x| x[0] > 0.5), &[0.0; 2]);
    let refused = fit(0, problem, &bounds, &start, &options, Control::default());
    assert_eq!(refused, Err(Infeasible::Refused("beyond the fence".into())));
}

#[test]
fn a_start_at_the_minimum_ends_at_once() {
    let fit = run(
        rosenbrock,
        &[[-3.0, 3.0]; 2],
        &[1.0, 1.0],
        &Options::default(),
    );
    assert_eq!(fit.termination, Termination::MisfitReached);
    assert_eq!(fit.evaluations(), 1);
}

#[test]
fn a_corner_all_bounds_hold_is_stationary() {
    let rows: Function = |x| {
        Ok(vec![
            (x[0] + 3.0, vec![1.0, 0.0]),
            (x[1] - 4.0, vec![0.0, 1.0]),
        ])
    };
    let fit = run(rows, &[[-1.0, 1.0]; 2], &[0.0, 0.0], &Options::default());
    assert_eq!(fit.termination, Termination::Stationary);
    assert_eq!(fit.x, vector(&[-1.0, 1.0]));
    assert_eq!(fit.active_bounds, [ActiveBound::Lower, ActiveBound::Upper]);
}

#[test]
fn limits_and_interrupts_keep_what_is_reached() {
    let options = Options {
        max_iterations: 3,
        ..Options::default()
    };
    let limited = run(rosenbrock, &[[-3.0, 3.0]; 2], &[-1.2, 1.0], &options);
    assert_eq!(limited.termination, Termination::IterationLimit);
    assert_eq!(limited.history.len(), 4);

    let flag = AtomicBool::new(false);
    let stop = |_: usize, iteration: &Iteration| {
        flag.store(iteration.iteration >= 2, Ordering::Relaxed);
    };
    let control = Control {
        interrupt: Some(&flag),
        watch: Some(&stop),
    };
    let bounds = Bounds::new(&[[-3.0, 3.0]; 2]).unwrap();
    let start = vector(&[-1.2, 1.0]);
    let problem = written(rosenbrock, &[-1.2, 1.0]);
    let stopped = fit(0, problem, &bounds, &start, &Options::default(), control).unwrap();
    assert_eq!(stopped.termination, Termination::Interrupted);
    assert_eq!(stopped.history, limited.history[..3]);
}

/// The cost never rises during a run. Every minimum satisfies the Kuhn-Tucker conditions.
#[test]
fn random_bounded_problems_end_at_kuhn_tucker_points() {
    for seed in 0..60 {
        let mut noise = Noise::new(1000 + seed);
        let n = 1 + seed as usize % 8;
        let a = DMatrix::from_fn(200, n, |_, _| noise.next());
        let b = DVector::from_fn(200, |_, _| 2.0 * noise.next());
        let curve = 0.3 * noise.next();
        let goal = DVector::from_fn(n, |_, _| 2.0 * noise.next());
        let rows = move |x: &[f64]| {
            let x = DVector::from_column_slice(x);
            let r = &a * (&x - &goal) + x.norm_squared() * curve * &b + 0.3 * &b;
            let row = |i: usize| {
                let gradient = a.row(i).transpose() + 2.0 * curve * b[i] * &x;
                (r[i], gradient.data.into())
            };
            Ok((0..200).map(row).collect())
        };
        let ranges: Vec<[f64; 2]> = (0..n)
            .map(|_| [-1.0 - 0.5 * noise.next(), 0.6 + 0.5 * noise.next()])
            .collect();
        let fit = run(rows, &ranges, &vec![0.0; n], &to_the_end());
        assert!(
            fit.termination.at_minimum(),
            "seed {seed}: {}",
            fit.termination
        );
        assert!(
            fit.history
                .windows(2)
                .all(|pair| pair[1].cost <= pair[0].cost)
        );
        assert!(violation(&fit) < 1e-6, "seed {seed}: {:e}", violation(&fit));
    }
}
