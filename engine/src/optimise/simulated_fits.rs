//! Fits of a linear model to simulated errors, with the variables within their ranges.
//!
//! The errors e of the measurements are normal and independent, with the scatter s. With these errors, the residuals of the
//! model about the true values x0 are r(x) = J (x - x0) + w e, with the weights w of the residuals. Each simulated fit gives
//! the same quantities as the real fit in (2) of [`profile_interval`](super::profile_interval):
//!
//! ```text
//! T = (min { |r(x)|^2 : in the box, x_j = x0_j } - min { |r(x)|^2 : in the box }) / s*^2      (1)
//! ```
//!
//! Here s* is the scatter of the simulated fit. It is computed with the number of variables that are free at the end of this
//! fit. All simulations use the same seed, so that results are reproducible and quantiles change smoothly with x0.

use super::{ActiveBound, BoundedLeastSquares, Bounds, Linearisation};
use crate::sorting::sort_numbers;
use nalgebra::{DMatrix, DVector};

/// Number of simulated fits. With this number, the probability of values above the estimated 95 % quantile is 5 % with a
/// standard deviation of 1.1 %.
const FITS: usize = 400;
const SEED: u64 = 0x5EED_0F17;
/// Damping of the bounded least-squares problems, relative to the largest column of the Jacobian.
const DAMPING: f64 = 1e-10;

/// Simulated fits of a linear model.
pub(super) struct SimulatedFits<'a> {
    bounds: &'a Bounds,
    weights: &'a [f64],
    /// Jacobian J times the ranges.
    jacobian: DMatrix<f64>,
    /// Triangular factor of the Jacobian, which is multiplied by the ranges.
    triangle: DMatrix<f64>,
    /// Random errors of the residuals, one column for each fit: standard normal numbers, times the weights.
    errors: DMatrix<f64>,
    /// Errors after the orthogonal transformation that gives `triangle`.
    rotated: DMatrix<f64>,
}

impl<'a> SimulatedFits<'a> {
    pub(super) fn new(at: &Linearisation, bounds: &'a Bounds, weights: &'a [f64]) -> Self {
        let (rows, n) = (at.residuals.len(), bounds.variables());
        let mut jacobian = at.jacobian.clone();
        for (mut column, width) in jacobian.column_iter_mut().zip(bounds.width()) {
            column *= *width;
        }
        let mut noise = Noise(SEED);
        let errors = DMatrix::from_fn(rows, FITS, |i, _| weights[i] * noise.normal());
        // If there are fewer residuals than variables, additional rows of zeros fill the matrix.
        let padded = jacobian.clone().resize_vertically(rows.max(n), 0.0);
        let decomposed = padded.qr();
        let q = decomposed.q();
        let rotated = q.rows(0, rows).tr_mul(&errors);
        SimulatedFits {
            bounds,
            weights,
            jacobian,
            triangle: decomposed.r(),
            errors,
            rotated,
        }
    }

    /// Square root of a quantile of T (equation (1) of this module) for a variable. The true values are `x0`, and the
    /// errors of the measurements have this scatter.
    pub(super) fn quantile(
        &self,
        variable: usize,
        x0: &DVector<f64>,
        scatter: f64,
        probability: f64,
    ) -> f64 {
        let n = self.bounds.variables();
        // Moves are measured in fractions of the variables' ranges, divided by the scatter.
        let end = |bound: &DVector<f64>| -> Vec<f64> {
            let room = |j: usize| (bound[j] - x0[j]) / self.bounds.width()[j] / scatter;
            (0..n).map(room).collect()
        };
        let (lower, upper) = (end(self.bounds.lower()), end(self.bounds.upper()));
        let without = |ends: &[f64]| {
            let mut ends = ends.to_vec();
            ends.remove(variable);
            ends
        };
        let (lower_others, upper_others) = (without(&lower), without(&upper));
        let others = self.triangle.clone().remove_column(variable);
        let largest = self.triangle.column_iter().map(|c| c.norm_squared());
        let damping = DAMPING * DAMPING * largest.fold(f64::MIN_POSITIVE, f64::max);
        let mut whole = BoundedLeastSquares::new(n, n);
        let mut rest = (n > 1).then(|| BoundedLeastSquares::new(n - 1, n));
        let (widths, narrow) = (DVector::repeat(n, 1.0), DVector::repeat(n - 1, 1.0));
        let mut ratios: Vec<f64> = (0..FITS)
            .map(|fit| {
                let errors = self.rotated.column(fit).into_owned();
                whole.reduce(&self.triangle, &widths, &errors);
                whole.solve(damping, &lower, &upper);
                let moves = DVector::from_column_slice(whole.step());
                let least = (&self.triangle * &moves + &errors).norm_squared();
                let held = match &mut rest {
                    None => errors.norm_squared(),
                    Some(rest) => {
                        rest.reduce(&others, &narrow, &errors);
                        rest.solve(damping, &lower_others, &upper_others);
                        let moves = DVector::from_column_slice(rest.step());
                        (&others * moves + &errors).norm_squared()
                    }
                };
                let active = whole.active_bounds().iter();
                let free = active.filter(|a| **a == ActiveBound::Free).count();
                (held - least).max(0.0) / self.variance(fit, &moves, free)
            })
            .collect();
        sort_numbers(&mut ratios);
        let place = (probability * FITS as f64).ceil() as usize;
        ratios[place.min(FITS - 1)].sqrt()
    }

    /// Variance s*^2 of the errors in a simulated fit, from its residuals. `free` is the number of variables that are free
    /// at the end of the fit.
    fn variance(&self, fit: usize, moves: &DVector<f64>, free: usize) -> f64 {
        let residuals = &self.jacobian * moves + self.errors.column(fit);
        let squares = residuals.iter().zip(self.weights);
        let sum: f64 = squares.map(|(r, w)| (r / w).powi(2)).sum();
        sum / residuals.len().saturating_sub(free).max(1) as f64
    }
}

/// Reproducible pseudorandom numbers (G. Steele, D. Lea, Ch. Flood, Fast splittable pseudorandom number generators, OOPSLA
/// 2014).
struct Noise(u64);

impl Noise {
    /// A number strictly between 0 and 1.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        ((z >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }

    /// A normally distributed number (G. E. P. Box, M. E. Muller, 1958).
    fn normal(&mut self) -> f64 {
        let (u, v) = (self.uniform(), self.uniform());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two variables near their bounds. The closed form of each fit is the interior minimum or the best point of the four
    /// edges.
    #[test]
    fn fits_of_two_variables_are_the_closed_form() {
        let bounds = Bounds::new(&[[-0.4, 2.0], [0.0, 0.5]]).unwrap();
        let jacobian = DMatrix::from_row_slice(4, 2, &[1.0, 0.4, 0.3, 2.0, -0.5, 1.0, 0.2, 0.6]);
        let at = Linearisation {
            residuals: DVector::zeros(4),
            jacobian,
        };
        let fits = SimulatedFits::new(&at, &bounds, &[1.0; 4]);
        let x0 = DVector::from_column_slice(&[0.1, 0.2]);
        let scatter = 0.9;
        // Moves are in fractions of the ranges and in units of the scatter.
        let ends: [[f64; 2]; 2] = std::array::from_fn(|j| {
            [bounds.lower()[j], bounds.upper()[j]]
                .map(|end| (end - x0[j]) / bounds.width()[j] / scatter)
        });
        let r = &fits.triangle;
        for variable in [0, 1] {
            let mut ratios: Vec<f64> = (0..FITS)
                .map(|fit| {
                    let e = fits.rotated.column(fit).into_owned();
                    let squares =
                        |v: [f64; 2]| (r * DVector::from_row_slice(&v) + &e).norm_squared();
                    // Best move of one variable while the other variable is fixed.
                    let along = |held: usize, value: f64| {
                        let free = 1 - held;
                        let rest = &e + r.column(held) * value;
                        let best = -r.column(free).dot(&rest) / r.column(free).norm_squared();
                        let mut v = [value; 2];
                        v[free] = best.clamp(ends[free][0], ends[free][1]);
                        v
                    };
                    let inner = r.clone().lu().solve(&-&e).unwrap();
                    let is_inside = (0..2).all(|j| (ends[j][0]..=ends[j][1]).contains(&inner[j]));
                    let candidates = if is_inside {
                        vec![[inner[0], inner[1]]]
                    } else {
                        vec![
                            along(0, ends[0][0]),
                            along(0, ends[0][1]),
                            along(1, ends[1][0]),
                            along(1, ends[1][1]),
                        ]
                    };
                    let better = |a: &[f64; 2], b: &[f64; 2]| squares(*a).total_cmp(&squares(*b));
                    let best = candidates.into_iter().min_by(better).unwrap();
                    let free = (0..2).filter(|j| !ends[*j].contains(&best[*j])).count();
                    let moves = DVector::from_row_slice(&best);
                    let held = squares(along(variable, 0.0));
                    (held - squares(best)).max(0.0) / fits.variance(fit, &moves, free)
                })
                .collect();
            sort_numbers(&mut ratios);
            for (probability, place) in [(0.95, 380), (0.9, 360), (1.0, 399)] {
                let found = fits.quantile(variable, &x0, scatter, probability - 0.001);
                let expected = ratios[place].sqrt();
                assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
            }
        }
    }

    /// The simulated errors have mean 0, variance 1 and tails like the normal distribution.
    #[test]
    fn errors_are_normal() {
        let mut noise = Noise(SEED);
        let count = 40_000;
        let errors: Vec<f64> = (0..count).map(|_| noise.normal()).collect();
        let mean =
            |f: &dyn Fn(f64) -> f64| errors.iter().map(|e| f(*e)).sum::<f64>() / count as f64;
        assert!(mean(&|e| e).abs() < 0.02);
        assert!((mean(&|e| e * e) - 1.0).abs() < 0.03);
        assert!((mean(&|e| f64::from(u8::from(e.abs() > 1.959_964))) - 0.05).abs() < 0.004);
    }
}
