//! Sum of squares as a function of the variables, stored as a triangular factor.

use super::super::super::Linearisation;
use super::super::super::qr::{dot, scale_columns, triangularise};

/// Sum of squares |A d + a|^2, stored as |R d + q|^2 + rest.
#[derive(Clone, Debug, Default)]
pub(super) struct Squares {
    pub(super) triangle: Vec<f64>,
    pub(super) offset: Vec<f64>,
    pub(super) rest: f64,
}

impl Squares {
    pub(super) fn new(variables: usize) -> Self {
        Squares {
            triangle: vec![0.0; variables * variables],
            offset: vec![0.0; variables],
            rest: 0.0,
        }
    }

    /// Reduces residuals and their Jacobian, whose columns are scaled by `width`.
    pub(super) fn reduce(&mut self, of: &Linearisation, width: &[f64], matrix: &mut Vec<f64>) {
        let n = self.offset.len();
        let rows = of.residuals.len().max(n);
        scale_columns(&of.jacobian, width, rows, matrix);
        let mut vector = std::mem::take(&mut self.offset);
        vector.clear();
        vector.extend_from_slice(of.residuals.as_slice());
        vector.resize(rows, 0.0);
        triangularise(matrix, rows, &mut vector);
        for (j, column) in self.triangle.chunks_exact_mut(n).enumerate() {
            column[..=j].copy_from_slice(&matrix[j * rows..][..=j]);
        }
        self.rest = vector[n..].iter().map(|r| r * r).sum();
        vector.truncate(n);
        self.offset = vector;
    }

    pub(super) fn largest_pivot(&self) -> f64 {
        let n = self.offset.len();
        (0..n).fold(0.0, |most, k| self.triangle[k * n + k].abs().max(most))
    }

    pub(super) fn longest_column(&self) -> f64 {
        let columns = self.triangle.chunks_exact(self.offset.len());
        columns.fold(0.0, |most, column| dot(column, column).sqrt().max(most))
    }

    /// Writes R d into `to`.
    pub(super) fn image(&self, d: &[f64], to: &mut [f64]) {
        to.fill(0.0);
        for (j, column) in self.triangle.chunks_exact(d.len()).enumerate() {
            for i in 0..=j {
                to[i] += column[i] * d[j];
            }
        }
    }

    /// Difference |A d + a|^2 - |a|^2.
    pub(super) fn change(&self, d: &[f64], scratch: &mut [f64]) -> f64 {
        self.image(d, scratch);
        let image = scratch.iter().zip(&self.offset);
        image.map(|(r, q)| r * (r + 2.0 * q)).sum()
    }

    /// Norm |A d + a|.
    pub(super) fn norm_after(&self, d: &[f64], scratch: &mut [f64]) -> f64 {
        self.image(d, scratch);
        let image = scratch.iter().zip(&self.offset);
        let seen: f64 = image.map(|(r, q)| (r + q) * (r + q)).sum();
        (seen + self.rest).sqrt()
    }

    /// Entry j of R^T q.
    pub(super) fn gradient(&self, j: usize) -> f64 {
        let n = self.offset.len();
        dot(&self.triangle[j * n..][..n], &self.offset)
    }
}
