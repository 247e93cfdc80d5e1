//! Linear model of the residuals about a point, and the step that it proposes.

use super::{ActiveBound, BoundedLeastSquares, Bounds};
use nalgebra::{DMatrix, DVector};

/// Residuals and Jacobian at a point, reduced to a triangle, with the distances to the bounds.
///
/// Steps are measured in fractions of the ranges.
pub(super) struct LocalModel<'a> {
    bounds: &'a Bounds,
    subproblem: BoundedLeastSquares,
    /// Lower bounds of the step, in fractions of the ranges.
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl<'a> LocalModel<'a> {
    /// Allocates memory for a model of m `residuals`.
    pub(super) fn new(bounds: &'a Bounds, residuals: usize) -> Self {
        let n = bounds.variables();
        LocalModel {
            bounds,
            subproblem: BoundedLeastSquares::new(n, residuals),
            lower: vec![0.0; n],
            upper: vec![0.0; n],
        }
    }

    /// Builds the model of `residuals` about `x`.
    pub(super) fn build(
        &mut self,
        x: &DVector<f64>,
        jacobian: &DMatrix<f64>,
        residuals: &DVector<f64>,
    ) {
        let (bounds, width) = (self.bounds, self.bounds.width());
        self.subproblem.reduce(jacobian, width, residuals);
        for j in 0..x.len() {
            self.lower[j] = (bounds.lower()[j] - x[j]) / width[j];
            self.upper[j] = (bounds.upper()[j] - x[j]) / width[j];
        }
    }

    /// Finds the step with this damping.
    pub(super) fn solve(&mut self, damping: f64) {
        self.subproblem.solve(damping, &self.lower, &self.upper);
    }

    /// Raises the damping until the step is at most half its present length.
    pub(super) fn shorten(&mut self, damping: &mut f64) {
        let length = self.step_length();
        *damping = damping.max(f64::MIN_POSITIVE);
        // The growth factor itself grows, because the damping may start many decades below the first value that has an
        // effect. After 64 rounds the damping has grown by more than the largest floating-point number.
        let mut growth = 4.0;
        for _ in 0..64 {
            if self.step_length() <= 0.5 * length {
                break;
            }
            *damping = (*damping * growth).min(f64::MAX);
            growth *= 2.0;
            self.solve(*damping);
        }
    }

    /// Euclidean length of the step, in fractions of the ranges.
    pub(super) fn step_length(&self) -> f64 {
        let step = self.subproblem.step();
        step.iter().map(|s| s * s).sum::<f64>().sqrt()
    }

    /// Largest component of the step, as an absolute value in fractions of the ranges.
    pub(super) fn largest_component(&self) -> f64 {
        let step = self.subproblem.step();
        step.iter().fold(0.0, |largest, s| s.abs().max(largest))
    }

    /// Reduction of half the sum of squares by the step, from the model.
    pub(super) fn predicted_reduction(&self) -> f64 {
        0.5 * self.subproblem.predicted_reduction()
    }

    /// Writes the end of the step from `x` into `to`. If the step holds a variable at a bound, the variable is set exactly
    /// to the bound.
    pub(super) fn step_from(&self, x: &DVector<f64>, to: &mut DVector<f64>) {
        let (step, active_bounds) = (self.subproblem.step(), self.subproblem.active_bounds());
        for j in 0..x.len() {
            let (lower, upper) = (self.bounds.lower()[j], self.bounds.upper()[j]);
            to[j] = match active_bounds[j] {
                ActiveBound::Lower => lower,
                ActiveBound::Upper => upper,
                ActiveBound::Free => (x[j] + self.bounds.width()[j] * step[j]).clamp(lower, upper),
            };
        }
    }

    /// Returns true if the residuals are orthogonal to the columns of the Jacobian. The function ignores the columns of
    /// variables whose bounds prevent a lower cost. `size` is the norm of the residuals, and `cosine` is the tolerance.
    pub(super) fn is_stationary(&self, size: f64, cosine: f64) -> bool {
        let columns = self.subproblem.column_norms().iter().enumerate();
        columns.into_iter().all(|(j, column)| {
            let slope = self.subproblem.gradient(j);
            let blocked =
                (slope > 0.0 && self.lower[j] == 0.0) || (slope < 0.0 && self.upper[j] == 0.0);
            blocked || slope.abs() <= cosine * size * column
        })
    }

    /// Scale for the imbalance of the optimality conditions.
    pub(super) fn scale(&self) -> f64 {
        self.subproblem.largest_pivot()
    }

    /// Norm of the longest column of the scaled Jacobian.
    pub(super) fn longest_column(&self) -> f64 {
        let norms = self.subproblem.column_norms();
        norms.iter().copied().fold(0.0, f64::max)
    }

    /// Frobenius norm of the scaled Jacobian.
    pub(super) fn norm(&self) -> f64 {
        let norms = self.subproblem.column_norms();
        norms.iter().map(|n| n * n).sum::<f64>().sqrt()
    }
}
