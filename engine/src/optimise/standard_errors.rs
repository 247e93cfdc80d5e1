//! Standard errors and correlations of the variables of a fit to measured curves.
//!
//! With the weighted residuals r_i in multiples of the tolerance, their weights w_i, the number N of residuals, and k free
//! variables, the variance of a measurement in squared tolerances is
//!
//! ```text
//! s^2 = sum_i (r_i / w_i)^2 / (N - k)                                                      (1)
//! C   = A^-1 (sum_i w_i^2 g_i g_i^T) A^-1 s^2,     A = sum_i g_i g_i^T                       (2)
//! ```
//!
//! with g_i the gradient of r_i with respect to the variables. The tolerances are assumed to be proportional to the scatter
//! of the measurements. The weights are free choices of the engineer (G. A. F. Seber, C. J. Wild, Nonlinear regression, 1989,
//! 2.1.2 and 2.8.8). A^-1 comes from the singular values of the weighted Jacobian, with columns scaled by the ranges, so that
//! no normal equations are formed. Standard errors are the roots of C_jj. Correlations come from C with all variables free,
//! so they depend only on the data, not on bounds.
//!
//! A variable at its bound is not known: its true value may lie anywhere within its range. If (2) treated the variable as
//! fixed at the bound, the errors of the other variables would be too small. So a fit with a variable at its bound has no
//! standard errors.
//!
//! With weights, the sum of squares near its minimum rises as if the variance of variable j were (A^-1)_jj s^2. The intervals
//! divide by the ratio
//!
//! ```text
//! k_j = C_jj / ((A^-1)_jj s^2)                                                              (3)
//! ```
//!
//! If all weights are 1, the ratio is 1. Near bounds, the ratio depends on the choice of the free variables. The code
//! computes one ratio with all variables free, and one with only the variables between their bounds free. It takes the larger
//! ratio. Intervals take the ranges of all variables into account ([`profile_interval`](super::profile_interval)).

use super::covariance::Covariance;
use super::profile_interval::{ConfidenceInterval, Solved};
use super::simulated_fits::SimulatedFits;
use super::student::Student;
use super::{ActiveBound, Bounds, Linearisation};
use nalgebra::DVector;

/// Uncertainty of the variables of a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct StandardErrors {
    /// Standard deviation s of a measurement about the fit, in multiples of the tolerance.
    pub scatter: f64,
    /// Standard error of each variable. `None` for a variable that the measurements do not determine. `None` for all
    /// variables if one of them is at its bound.
    pub sigmas: Vec<Option<f64>>,
    /// Confidence interval of each variable.
    pub intervals: Vec<ConfidenceInterval>,
    /// Pairs of variables that the measurements hardly distinguish, with their correlation, the closest first.
    pub correlations: Vec<(usize, usize, f64)>,
}

impl StandardErrors {
    /// Standard errors and intervals of a fit that ended at `x`. `weights` are the weights of the residuals, one for each
    /// residual. `evaluate` writes the residuals of a point, and returns false if the point has no residuals. `None` if
    /// there are no more residuals than free variables.
    pub fn of(
        x: &DVector<f64>,
        at: &Linearisation,
        bounds: &Bounds,
        weights: &[f64],
        mut evaluate: impl FnMut(&DVector<f64>, &mut Linearisation) -> bool,
    ) -> Option<Self> {
        let active_bounds = bounds.active_bounds(x);
        let variables = 0..active_bounds.len();
        let is_free = |j: &usize| active_bounds[*j] == ActiveBound::Free;
        let free: Vec<usize> = variables.clone().filter(is_free).collect();
        let rows = at.residuals.len();
        if rows <= free.len() {
            return None;
        }
        let freedoms = rows - free.len();
        let squares = at.residuals.iter().zip(weights);
        let squares = squares.map(|(r, w)| (r / w) * (r / w));
        let scatter = (squares.sum::<f64>() / freedoms as f64).sqrt();
        let is_inside = free.len() == active_bounds.len();
        let all = Covariance::of(at, variables.clone().collect(), bounds, weights)?;
        let held = Covariance::of(at, free, bounds, weights);
        let errors: Vec<Option<f64>> = variables
            .clone()
            .map(|j| {
                let error = all.spread.column(j).norm() * scatter * bounds.width()[j];
                (!all.unseen[j] && error.is_finite()).then_some(error)
            })
            .collect();
        let solved = Solved {
            x,
            at,
            bounds,
            student: Student::new(freedoms),
            errors: &errors,
            simulated: SimulatedFits::new(at, bounds, weights),
        };
        let interval = |j: usize| {
            if all.unseen[j] {
                return ConfidenceInterval::NotDetermined;
            }
            let held = held.as_ref().map_or(0.0, |held| held.ratio(j));
            let ratio = all.ratio(j).max(held).sqrt();
            solved.interval(j, [scatter, ratio], &mut evaluate)
        };
        let intervals: Vec<ConfidenceInterval> = variables.clone().map(interval).collect();
        let sigma = |j: usize| {
            let is_known = is_inside && intervals[j] != ConfidenceInterval::NotDetermined;
            errors[j].filter(|_| is_known)
        };
        Some(StandardErrors {
            scatter,
            sigmas: variables.map(sigma).collect(),
            intervals,
            correlations: all.correlations(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimise::BoundedLeastSquares;
    use crate::optimise::covariance::CLOSE;
    use crate::optimise::test_problems::Noise;
    use nalgebra::DMatrix;

    /// Normal noise by Box and Muller.
    fn normal(noise: &mut Noise) -> f64 {
        let (u, v) = (0.5 * (noise.next() + 1.0), 0.5 * (noise.next() + 1.0));
        (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }

    /// Weighted measurements of a linear model. The residuals are J x - y.
    struct Linear {
        jacobian: DMatrix<f64>,
        measured: DVector<f64>,
        bounds: Bounds,
        weights: Vec<f64>,
    }

    impl Linear {
        fn at(&self, x: &DVector<f64>) -> Linearisation {
            Linearisation {
                residuals: &self.jacobian * x - &self.measured,
                jacobian: self.jacobian.clone(),
            }
        }

        /// Minimum of the least squares within the bounds.
        fn solved(&self) -> DVector<f64> {
            let middle = 0.5 * (self.bounds.lower() + self.bounds.upper());
            let at = self.at(&middle);
            let n = middle.len();
            let mut solver = BoundedLeastSquares::new(n, at.residuals.len());
            solver.reduce(&at.jacobian, &DVector::repeat(n, 1.0), &at.residuals);
            let ends = [self.bounds.lower(), self.bounds.upper()]
                .map(|end| (end - &middle).as_slice().to_vec());
            solver.solve(1e-18, &ends[0], &ends[1]);
            let moved = &middle + DVector::from_column_slice(solver.step());
            let x = self.bounds.nearest(&moved);
            // The solver may hold variables at a bound. Such variables are set exactly to the bound.
            let active = solver.active_bounds();
            DVector::from_fn(n, |j, _| match active[j] {
                ActiveBound::Free => x[j],
                ActiveBound::Lower => self.bounds.lower()[j],
                ActiveBound::Upper => self.bounds.upper()[j],
            })
        }

        /// Returns the errors, and the number of evaluations for them.
        fn errors(&self, x: &DVector<f64>) -> (StandardErrors, usize) {
            let mut evaluations = 0;
            let evaluate = |x: &DVector<f64>, into: &mut Linearisation| {
                evaluations += 1;
                *into = self.at(x);
                true
            };
            let found =
                StandardErrors::of(x, &self.at(x), &self.bounds, &self.weights, evaluate).unwrap();
            (found, evaluations)
        }
    }

    fn holds(interval: ConfidenceInterval, truth: f64) -> bool {
        match interval {
            ConfidenceInterval::TwoSided { lower, upper } => (lower..=upper).contains(&truth),
            ConfidenceInterval::AtMost(upper) => truth <= upper,
            ConfidenceInterval::AtLeast(lower) => lower <= truth,
            ConfidenceInterval::NotDetermined => true,
        }
    }

    /// Fits a straight line to N points, with 1 to 5 degrees of freedom. Compares the result with textbook formulas for the
    /// standard errors of slope and intercept. Also compares it with quantiles of Student's distribution, and with the
    /// known correlation.
    #[test]
    fn intervals_of_a_line_are_the_closed_form() {
        let quantiles = [
            12.706_204_736,
            4.302_652_730,
            3.182_446_305,
            2.776_445_105,
            2.570_581_836,
        ];
        let mut noise = Noise::new(21);
        for (freedoms, t) in (1..).zip(quantiles) {
            let rows = freedoms + 2;
            let places: Vec<f64> = (0..rows).map(|i| i as f64 + 0.3 * noise.next()).collect();
            let jacobian = DMatrix::from_fn(rows, 2, |i, j| places[i].powi(j as i32));
            let measured = DVector::from_fn(rows, |i, _| 2.0 - 0.5 * places[i] + noise.next());
            let n = rows as f64;
            let mean = places.iter().sum::<f64>() / n;
            let spread: f64 = places.iter().map(|x| (x - mean).powi(2)).sum();
            let height = measured.sum() / n;
            let product = |i: usize| (places[i] - mean) * (measured[i] - height);
            let slope = (0..rows).map(product).sum::<f64>() / spread;
            let intercept = height - slope * mean;
            let left = |i: usize| (measured[i] - intercept - slope * places[i]).powi(2);
            let scatter = ((0..rows).map(left).sum::<f64>() / freedoms as f64).sqrt();
            let wanted = [
                (intercept, scatter * (1.0 / n + mean * mean / spread).sqrt()),
                (slope, scatter / spread.sqrt()),
            ];
            let line = Linear {
                jacobian,
                measured,
                bounds: Bounds::new(&[[-1e4, 1e4]; 2]).unwrap(),
                weights: vec![1.0; rows],
            };
            let x = DVector::from_column_slice(&[intercept, slope]);
            let (found, evaluations) = line.errors(&x);
            assert_eq!(evaluations, 4);
            assert!((found.scatter / scatter - 1.0).abs() < 1e-9);
            for (j, (value, error)) in wanted.into_iter().enumerate() {
                assert!((found.sigmas[j].unwrap() / error - 1.0).abs() < 1e-9);
                let ConfidenceInterval::TwoSided { lower, upper } = found.intervals[j] else {
                    panic!("{freedoms} freedoms: {:?}", found.intervals[j]);
                };
                let half = t * error;
                for end in [value - lower, upper - value] {
                    assert!((end / half - 1.0).abs() < 1e-6, "{freedoms}: {end} {half}");
                }
            }
            let correlation = -mean / (spread / n + mean * mean).sqrt();
            let told = found.correlations.first().map(|c| c.2);
            match told {
                Some(told) => assert!((told - correlation).abs() < 1e-9),
                None => assert!(correlation.abs() <= CLOSE + 1e-9),
            }
        }
    }

    /// Fits a linear model with simulated noise. Each 95 % interval contains the true value in 93 to 97 of 100 fits.
    #[test]
    fn intervals_hold_the_truth_as_often_as_they_say() {
        let mut noise = Noise::new(8);
        let (rows, fits) = (15, 4000);
        let jacobian = DMatrix::from_fn(rows, 3, |_, _| noise.next());
        for weights in [
            vec![1.0; rows],
            (0..rows).map(|i| if i < 5 { 2.0 } else { 1.0 }).collect(),
        ] {
            let mut held = [0; 3];
            for _ in 0..fits {
                // The true value is 0.
                let fit = Linear {
                    jacobian: DMatrix::from_fn(rows, 3, |i, j| jacobian[(i, j)] * weights[i]),
                    measured: DVector::from_fn(rows, |i, _| 0.7 * normal(&mut noise) * weights[i]),
                    bounds: Bounds::new(&[[-50.0, 50.0]; 3]).unwrap(),
                    weights: weights.clone(),
                };
                let (found, _) = fit.errors(&fit.solved());
                for (held, interval) in held.iter_mut().zip(&found.intervals) {
                    *held += usize::from(holds(*interval, 0.0));
                }
            }
            for held in held {
                let share = held as f64 / fits as f64;
                assert!((0.93..=0.97).contains(&share), "{share}");
            }
        }
    }

    /// Fits linear models of four correlated variables with one to three variables at bounds. The true values are inside the
    /// box or on its border. Some fits use weights of 1, others use weights that differ from 1/variance. At least 80 % of the
    /// intervals of free variables are two-sided, and 92 to 98 % contain the true value. At least 92 % of the one-sided
    /// limits contain the true value.
    #[test]
    fn intervals_beside_bounds_hold_the_truth() {
        let mut noise = Noise::new(31);
        let (rows, n, scatter) = (16, 4, 0.5);
        for weights in [
            vec![1.0; rows],
            (0..rows)
                .map(|i| if i % 3 == 0 { 2.5 } else { 1.0 })
                .collect(),
        ] {
            // Counts: [fits of free variables, two-sided intervals, intervals that contain the true value]; [limits, limits
            // that contain the true value]
            let (mut free, mut limits) = ([[0; 3]; 4], [0; 2]);
            for _ in 0..260 {
                let common = DVector::from_fn(rows, |_, _| noise.next());
                let jacobian =
                    DMatrix::from_fn(rows, n, |i, _| weights[i] * (common[i] + noise.next()));
                let truth = DVector::from_fn(n, |_, _| match noise.next() {
                    x if x < -0.5 => -1.0,
                    x if x > 0.5 => 1.0,
                    x => 2.0 * x,
                });
                let errors =
                    DVector::from_fn(rows, |i, _| scatter * weights[i] * normal(&mut noise));
                let fit = Linear {
                    measured: &jacobian * &truth + errors,
                    jacobian,
                    bounds: Bounds::new(&[[-1.0, 1.0]; 4]).unwrap(),
                    weights: weights.clone(),
                };
                let x = fit.solved();
                let active = fit.bounds.active_bounds(&x);
                let count = active.iter().filter(|a| **a != ActiveBound::Free).count();
                if !(1..=3).contains(&count) {
                    continue;
                }
                let (found, _) = fit.errors(&x);
                assert_eq!(found.sigmas, [None; 4]);
                for j in 0..n {
                    let holds = usize::from(holds(found.intervals[j], truth[j]));
                    match (active[j], found.intervals[j]) {
                        (ActiveBound::Free, ConfidenceInterval::TwoSided { .. }) => {
                            for place in [0, count] {
                                free[place][0] += 1;
                                free[place][1] += 1;
                                free[place][2] += holds;
                            }
                        }
                        (ActiveBound::Free, _) => {
                            free[0][0] += 1;
                            free[count][0] += 1;
                        }
                        _ => {
                            limits[0] += 1;
                            limits[1] += holds;
                        }
                    }
                }
            }
            println!("{free:?} {limits:?}");
            let [all, two_sided, held] = free[0].map(|n| n as f64);
            assert!(two_sided >= 0.8 * all);
            assert!(
                (0.92..=0.98).contains(&(held / two_sided)),
                "{}",
                held / two_sided
            );
            assert!(limits[0] > 100, "{limits:?}");
            assert!(limits[1] as f64 >= 0.92 * limits[0] as f64);
        }
    }

    /// One variable is at its bound. The end of its interval satisfies equations (4) and (5) of module `profile_interval`.
    /// The test evaluates these equations in closed form for a true value at the end of the interval.
    #[test]
    fn one_variable_at_its_bound_has_a_limit() {
        let rows = 400;
        for below in [0.0, 0.5, 1.0, 2.0] {
            // Without the bound, the estimate (the mean of `rows` measurements) would lie `below` standard deviations beyond
            // the bound.
            let mut noise = Noise::new(5);
            let mut errors = DVector::from_fn(rows, |_, _| normal(&mut noise));
            errors.add_scalar_mut(-errors.mean());
            let error = (errors.norm_squared() / rows as f64).sqrt() / (rows as f64).sqrt();
            errors.add_scalar_mut(-below * error);
            let fit = Linear {
                jacobian: DMatrix::from_element(rows, 1, 1.0),
                measured: errors,
                bounds: Bounds::new(&[[0.0, 1.0]]).unwrap(),
                weights: vec![1.0; rows],
            };
            let x = DVector::zeros(1);
            let (found, _) = fit.errors(&x);
            let ConfidenceInterval::AtMost(upper) = found.intervals[0] else {
                panic!("{:?}", found.intervals[0]);
            };
            let d = upper / error;
            // T (equation (2) of `profile_interval`) at the end of the interval is d (2 (below + d) - d). By equations (4)
            // and (5), the probability of a larger T is at most 5 %. The probability is slightly less if the simulation
            // gives a larger quantile.
            let q = (d * (2.0 * below + d)).sqrt();
            let student = Student::new(rows);
            let towards = if q <= d {
                q
            } else {
                (q * q + d * d) / (2.0 * d)
            };
            let outside = student.tail(q) + student.tail(towards);
            assert!(
                (0.03..=0.0501).contains(&outside),
                "{below}: {d} {q} {outside}"
            );
            if below == 0.0 {
                assert!((d - 1.96).abs() < 0.15, "{d}");
            }
        }
    }

    /// Estimate of a mean near a bound, from measurements whose errors add up to zero. `room` is the distance of the mean
    /// from the bound in standard errors.
    fn mean(rows: usize, room: f64) -> (StandardErrors, f64) {
        let mut noise = Noise::new(rows as u64);
        let mut errors = DVector::from_fn(rows, |_, _| normal(&mut noise));
        errors.add_scalar_mut(-errors.mean());
        let freedoms = (rows - 1) as f64;
        let error = (errors.norm_squared() / freedoms / rows as f64).sqrt();
        let fit = Linear {
            jacobian: DMatrix::from_element(rows, 1, 1.0),
            measured: errors,
            bounds: Bounds::new(&[[-room * error, 1e3 * error]]).unwrap(),
            weights: vec![1.0; rows],
        };
        (fit.errors(&DVector::zeros(1)).0, error)
    }

    /// If no bound is within four standard errors of either end, the interval equals the interval of Student's distribution.
    /// Closer to a bound, the end on the side of this bound differs.
    #[test]
    fn bounds_count_within_four_standard_errors() {
        for rows in 8..30 {
            let t = Student::new(rows - 1).quantile(0.025);
            for (room, is_far) in [(t + 4.2, true), (t + 0.6, false)] {
                let (found, error) = mean(rows, room);
                let ConfidenceInterval::TwoSided { lower, upper } = found.intervals[0] else {
                    panic!("{:?}", found.intervals[0]);
                };
                let [below, above] = [-lower, upper].map(|end| end / (t * error));
                if is_far {
                    assert!((above - 1.0).abs() < 1e-6, "{rows} {room}: {above}");
                    assert!((below - 1.0).abs() < 1e-6, "{rows} {room}: {below}");
                } else {
                    assert!(above > 0.9, "{rows} {room}: {above}");
                    assert!((below - 1.0).abs() > 1e-3, "{rows} {room}: {below}");
                }
            }
        }
    }

    /// If the model fits the measurements exactly, their scatter counts as a billionth of a tolerance, not as zero.
    #[test]
    fn exact_measurements_have_rounding_errors() {
        let rows = 9;
        let fit = Linear {
            jacobian: DMatrix::from_element(rows, 1, 1.0),
            measured: DVector::zeros(rows),
            bounds: Bounds::new(&[[-1.0, 1.0]]).unwrap(),
            weights: vec![1.0; rows],
        };
        let (found, _) = fit.errors(&DVector::zeros(1));
        let ConfidenceInterval::TwoSided { lower, upper } = found.intervals[0] else {
            panic!("{:?}", found.intervals[0]);
        };
        let half = Student::new(rows - 1).quantile(0.025) * 1e-9 / 3.0;
        for end in [-lower, upper] {
            assert!((end / half - 1.0).abs() < 1e-3, "{end} {half}");
        }
    }

    #[test]
    fn what_is_not_seen_is_not_determined() {
        let mut noise = Noise::new(9);
        let mut jacobian = DMatrix::from_fn(20, 3, |_, _| noise.next());
        let twin = jacobian.column(0).into_owned();
        jacobian.set_column(1, &twin);
        let fit = Linear {
            jacobian,
            measured: DVector::from_fn(20, |_, _| 0.1 * noise.next()),
            bounds: Bounds::new(&[[-5.0, 5.0]; 3]).unwrap(),
            weights: vec![1.0; 20],
        };
        let mut x = fit.solved();
        // All points with the same mean are equally good. The test uses the middle of these points.
        let mean = 0.5 * (x[0] + x[1]);
        (x[0], x[1]) = (mean, mean);
        let (found, _) = fit.errors(&x);
        let none = ConfidenceInterval::NotDetermined;
        assert_eq!((found.sigmas[0], found.sigmas[1]), (None, None));
        assert_eq!((found.intervals[0], found.intervals[1]), (none, none));
        assert!(found.sigmas[2].is_some());
    }
}
