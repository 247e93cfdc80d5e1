//! What a fit of measured curves knows of each coordinate.
//!
//! With the residuals r_i in tolerances, their weights w_i, and k free variables, the variance of a
//! measurement in squared tolerances is
//!
//! ```text
//! s^2 = sum_i r_i^2 / (N - k)                                                              (1)
//! C   = A^-1 (sum_i w_i^2 g_i g_i^T) A^-1 s^2,     A = sum_i w_i g_i g_i^T                   (2)
//! ```
//!
//! g_i being the gradient of r_i by the free variables: tolerances are taken as in proportion to the
//! scatter of the measurements, weights as the engineer's own (G. A. F. Seber, C. J. Wild, Nonlinear
//! regression, 1989, 2.1.2 and 2.8.8). A^-1 comes from the singular values of the weighted Jacobian, its
//! columns scaled by the ranges, so that no normal equations are formed. The interval that holds the truth
//! in 95 of 100 fits is t sqrt(C_jj) on either side, t being Student's quantile for N - k.

use super::identifiability::right_singular_vectors;
use super::{ActiveBound, Bounds, Linearisation};
use nalgebra::{DMatrix, DVector};

/// What is known of the coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct StandardErrors {
    /// The scatter of a measurement about the fit, in tolerances: s of (1).
    pub scatter: f64,
    /// By variable: `None` where the measurements do not determine it. A variable at a bound is none, and so
    /// is one whose interval is wider than its range.
    pub errors: Vec<Option<StandardError>>,
    /// Pairs of variables that the measurements hardly tell apart, with their correlation, the worst first.
    pub correlations: Vec<(usize, usize, f64)>,
}

/// What is known of a coordinate, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandardError {
    /// The standard error.
    pub sigma: f64,
    /// Half the interval that holds the truth in 95 of 100 fits.
    pub interval: f64,
}

/// Correlations above this are told.
const CLOSE: f64 = 0.95;

impl StandardErrors {
    /// Standard errors of a fit. `weights` are the square roots of w, by residual. `None` if there are no more
    /// residuals than free variables.
    pub fn of(
        at: &Linearisation,
        active_bounds: &[ActiveBound],
        bounds: &Bounds,
        weights: &[f64],
    ) -> Option<Self> {
        let free: Vec<usize> = (0..active_bounds.len())
            .filter(|j| active_bounds[*j] == ActiveBound::Free)
            .collect();
        let rows = at.residuals.len();
        if rows <= free.len() {
            return None;
        }
        let freedoms = rows - free.len();
        let squares = at
            .residuals
            .iter()
            .zip(weights)
            .map(|(r, w)| (r / w) * (r / w));
        let scatter = (squares.sum::<f64>() / freedoms as f64).sqrt();
        let mut errors = vec![None; active_bounds.len()];
        if free.is_empty() {
            return Some(StandardErrors {
                scatter,
                errors,
                correlations: Vec::new(),
            });
        }
        let k = free.len();
        let scaled = DMatrix::from_fn(rows, k, |i, j| {
            at.jacobian[(i, free[j])] * bounds.width()[free[j]]
        });
        let (values, vectors) = right_singular_vectors(&scaled);
        // What rounding leaves of a direction that is not seen at all.
        let nothing = 1e-13 * values[0];
        let inverse: Vec<f64> = values
            .iter()
            .map(|v| if *v > nothing { 1.0 / (v * v) } else { 0.0 })
            .collect();
        let unseen = |j: usize| {
            let hidden = (0..k).filter(|d| values[*d] <= nothing);
            hidden.map(|d| vectors[(j, d)].powi(2)).sum::<f64>() > 1e-12
        };
        // A^-1 times the rows, weighed once more: the square of it is (2).
        let a_inverse =
            &vectors * DMatrix::from_diagonal(&DVector::from_vec(inverse)) * vectors.transpose();
        let mut weighed = scaled;
        for (mut row, weight) in weighed.row_iter_mut().zip(weights) {
            row *= *weight;
        }
        let spread = weighed * a_inverse * scatter;
        let t = student_quantile(freedoms);
        let norms: Vec<f64> = spread.column_iter().map(|c| c.norm()).collect();
        for (j, &variable) in free.iter().enumerate() {
            let width = bounds.width()[variable];
            let found = StandardError {
                sigma: norms[j] * width,
                interval: t * norms[j] * width,
            };
            if !unseen(j) && found.interval.is_finite() && found.interval <= width {
                errors[variable] = Some(found);
            }
        }
        let mut correlations = Vec::new();
        for i in 0..k {
            for j in i + 1..k {
                let product = spread.column(i).dot(&spread.column(j));
                let correlation = product / (norms[i] * norms[j]);
                if correlation.abs() > CLOSE {
                    correlations.push((free[i], free[j], correlation));
                }
            }
        }
        correlations.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
        Some(StandardErrors {
            scatter,
            errors,
            correlations,
        })
    }
}

/// The quantile of Student's distribution that 97.5 % lie below: exact for one and two freedoms, else the
/// expansion about the normal one (M. Abramowitz, I. A. Stegun, Handbook of mathematical functions,
/// 26.7.5), right to three digits for three freedoms and to six for ten.
fn student_quantile(freedoms: usize) -> f64 {
    const NORMAL: f64 = 1.959_963_984_540_054;
    let z = NORMAL;
    let power = |n: i32| z.powi(n);
    match freedoms {
        1 => 12.706_204_736_174_7,
        2 => 4.302_652_729_749_46,
        _ => {
            let n = freedoms as f64;
            let terms = [
                (power(3) + z) / 4.0,
                (5.0 * power(5) + 16.0 * power(3) + 3.0 * z) / 96.0,
                (3.0 * power(7) + 19.0 * power(5) + 17.0 * power(3) - 15.0 * z) / 384.0,
                (79.0 * power(9) + 776.0 * power(7) + 1482.0 * power(5)
                    - 1920.0 * power(3)
                    - 945.0 * z)
                    / 92_160.0,
            ];
            let sum = terms.iter().rev().fold(0.0, |sum, term| (sum + term) / n);
            z + sum
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimise::test_problems::Noise;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (freedoms, wanted, bound) in [
            (3, 3.182_446, 4e-3),
            (5, 2.570_582, 4e-4),
            (10, 2.228_139, 1e-5),
            (30, 2.042_272, 1e-6),
            (120, 1.979_930, 1e-6),
        ] {
            let found = student_quantile(freedoms);
            assert!((found - wanted).abs() < bound, "{freedoms}: {found}");
        }
    }

    /// Normal noise by Box and Muller.
    fn normal(noise: &mut Noise) -> f64 {
        let (u, v) = (0.5 * (noise.next() + 1.0), 0.5 * (noise.next() + 1.0));
        (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }

    /// A linear fit with planted noise: each 95 % interval holds the truth in 93 to 97 of 100 fits.
    #[test]
    fn intervals_hold_the_truth_as_often_as_they_say() {
        let mut noise = Noise::new(8);
        let (rows, fits) = (15, 4000);
        let jacobian = DMatrix::from_fn(rows, 3, |_, _| noise.next());
        let bounds = Bounds::new(&[[-50.0, 50.0]; 3]).unwrap();
        for weights in [
            vec![1.0; rows],
            (0..rows).map(|i| if i < 5 { 2.0 } else { 1.0 }).collect(),
        ] {
            let weighed = DMatrix::from_fn(rows, 3, |i, j| jacobian[(i, j)] * weights[i]);
            let qr = weighed.clone().qr();
            let mut held = [0; 3];
            for _ in 0..fits {
                let errors = DVector::from_fn(rows, |i, _| 0.7 * normal(&mut noise) * weights[i]);
                // The truth is 0; the fit is where the weighed residuals are least.
                let x = qr
                    .r()
                    .solve_upper_triangular(&(qr.q().transpose() * &errors))
                    .unwrap();
                let at = Linearisation {
                    residuals: &weighed * &x - &errors,
                    jacobian: weighed.clone(),
                };
                let free = [ActiveBound::Free; 3];
                let found = StandardErrors::of(&at, &free, &bounds, &weights).unwrap();
                for j in 0..3 {
                    held[j] += usize::from(x[j].abs() <= found.errors[j].unwrap().interval);
                }
            }
            for held in held {
                let share = held as f64 / fits as f64;
                assert!((0.93..=0.97).contains(&share), "{share}");
            }
        }
    }

    #[test]
    fn what_is_not_seen_is_not_determined() {
        let mut noise = Noise::new(9);
        let mut jacobian = DMatrix::from_fn(20, 3, |_, _| noise.next());
        let twin = jacobian.column(0).into_owned();
        jacobian.set_column(1, &twin);
        let at = Linearisation {
            residuals: DVector::from_fn(20, |_, _| 0.1 * noise.next()),
            jacobian,
        };
        let bounds = Bounds::new(&[[-5.0, 5.0]; 3]).unwrap();
        let free = [ActiveBound::Free; 3];
        let found = StandardErrors::of(&at, &free, &bounds, &[1.0; 20]).unwrap();
        assert_eq!((found.errors[0], found.errors[1]), (None, None));
        assert!(found.errors[2].is_some());
    }
}
