//! Fits of a linear model to simulated errors, the variables within their ranges.
//!
//! Errors e of the measurements, normal and independent, with the scatter s, move the residuals of the model
//! r(x) = J (x - x0) + w e about a truth x0. Each simulated fit yields what (2) of
//! [`profile_interval`](super::profile_interval) has of the true one:
//!
//! ```text
//! T = (min { |r(x)|^2 : in the box, x_j = x0_j } - min { |r(x)|^2 : in the box }) / s*^2      (1)
//! ```
//!
//! s* being the scatter of the simulated fit, with its own number of free variables. The seed is the same for all, so
//! that results are reproducible and quantiles change smoothly with x0.

use super::{ActiveBound, BoundedLeastSquares, Bounds, Linearisation};
use nalgebra::{DMatrix, DVector};

/// Number of fits. The probability above their 95 % quantile is 5 % with a standard deviation of 1.1 %.
const FITS: usize = 400;
const SEED: u64 = 0x5EED_0F17;
/// Damping of the bounded problems, relative to the largest column.
const DAMPING: f64 = 1e-10;

/// Simulated fits of a model.
pub(super) struct SimulatedFits<'a> {
    bounds: &'a Bounds,
    weights: &'a [f64],
    /// J times the ranges.
    jacobian: DMatrix<f64>,
    /// The triangle of it.
    triangle: DMatrix<f64>,
    /// Weighted errors of scatter 1: a column for each fit.
    errors: DMatrix<f64>,
    /// The same after the rotations that make the triangle.
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
        // With fewer residuals than variables, residuals that are always zero make up the difference.
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

    /// The root of a quantile of T of a variable, for the truth `x0` and a scatter of the errors.
    pub(super) fn quantile(
        &self,
        variable: usize,
        x0: &DVector<f64>,
        scatter: f64,
        probability: f64,
    ) -> f64 {
        let n = self.bounds.variables();
        // Moves in fractions of the ranges and in units of the scatter.
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
        ratios.sort_by(f64::total_cmp);
        let place = (probability * FITS as f64).ceil() as usize;
        ratios[place.min(FITS - 1)].sqrt()
    }

    /// The variance s*^2 of a simulated fit.
    fn variance(&self, fit: usize, moves: &DVector<f64>, free: usize) -> f64 {
        let residuals = &self.jacobian * moves + self.errors.column(fit);
        let squares = residuals.iter().zip(self.weights);
        let sum: f64 = squares.map(|(r, w)| (r / w).powi(2)).sum();
        sum / residuals.len().saturating_sub(free).max(1) as f64
    }
}

/// A reproducible sequence of numbers (G. Steele, D. Lea, Ch. Flood, Fast splittable pseudorandom number generators,
/// OOPSLA 2014).
struct Noise(u64);

impl Noise {
    /// A number between 0 and 1, neither of them.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        ((z >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }

    /// A normal number (G. E. P. Box, M. E. Muller, 1958).
    fn normal(&mut self) -> f64 {
        let (u, v) = (self.uniform(), self.uniform());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }
}
