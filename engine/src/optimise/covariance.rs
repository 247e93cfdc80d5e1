//! Covariance of the variables of a fit, from the singular values of the fit's Jacobian.

use super::identifiability::right_singular_vectors;
use super::{Bounds, Linearisation};
use crate::sorting::sort_by;
use nalgebra::{DMatrix, DVector};

/// Correlation above which a pair of variables is reported.
pub(super) const CLOSE: f64 = 0.95;

/// Covariance of some variables, divided by the variance s^2 of a measurement, in fractions of the ranges. It is equation
/// (2) of module [`standard_errors`](super::standard_errors).
pub(super) struct Covariance {
    variables: Vec<usize>,
    /// Matrix with one column for each variable. The scalar product of two columns is the covariance of their variables.
    pub spread: DMatrix<f64>,
    /// Diagonal of A^-1, with the matrix A of equation (2) of module [`standard_errors`](super::standard_errors).
    inverse: Vec<f64>,
    /// True for each variable that the measurements do not determine.
    pub unseen: Vec<bool>,
}

impl Covariance {
    pub(super) fn of(
        at: &Linearisation,
        variables: Vec<usize>,
        bounds: &Bounds,
        weights: &[f64],
    ) -> Option<Self> {
        let (rows, k) = (at.residuals.len(), variables.len());
        if k == 0 {
            return None;
        }
        let scaled = DMatrix::from_fn(rows, k, |i, j| {
            at.jacobian[(i, variables[j])] * bounds.width()[variables[j]]
        });
        let (values, vectors) = right_singular_vectors(&scaled);
        // Singular values up to this limit are rounding errors. The measurements do not determine the directions of these
        // singular values.
        let nothing = 1e-13 * values[0];
        let inverse: Vec<f64> = values
            .iter()
            .map(|v| if *v > nothing { 1.0 / (v * v) } else { 0.0 })
            .collect();
        let unseen = |j: usize| {
            let hidden = (0..k).filter(|d| values[*d] <= nothing);
            hidden.map(|d| vectors[(j, d)].powi(2)).sum::<f64>() > 1e-12
        };
        // The Jacobian already contains the weights. The code multiplies its rows by the weights once more, then multiplies
        // the matrix by A^-1. The scalar products of the columns are then the covariances.
        let a_inverse =
            &vectors * DMatrix::from_diagonal(&DVector::from_vec(inverse)) * vectors.transpose();
        let mut weighed = scaled;
        for (mut row, weight) in weighed.row_iter_mut().zip(weights) {
            row *= *weight;
        }
        Some(Covariance {
            spread: weighed * &a_inverse,
            inverse: a_inverse.diagonal().iter().copied().collect(),
            unseen: (0..k).map(unseen).collect(),
            variables,
        })
    }

    /// Ratio k_j, equation (3) of module [`standard_errors`](super::standard_errors): the variance of a variable, divided
    /// by its variance if all weights were 1/variance. Returns 1 if the ratio is not known, and 0 if the covariance does
    /// not include the variable.
    pub(super) fn ratio(&self, variable: usize) -> f64 {
        let Some(j) = self.variables.iter().position(|v| *v == variable) else {
            return 0.0;
        };
        if self.unseen[j] || self.inverse[j] <= 0.0 {
            return 1.0;
        }
        self.spread.column(j).norm_squared() / self.inverse[j]
    }

    /// Pairs of variables with close correlation, the closest first. A variable that the measurements do not determine has no
    /// correlations.
    pub(super) fn correlations(&self) -> Vec<(usize, usize, f64)> {
        let norms: Vec<f64> = self.spread.column_iter().map(|c| c.norm()).collect();
        let mut correlations = Vec::new();
        let count = self.variables.len();
        for i in (0..count).filter(|i| !self.unseen[*i]) {
            for j in (i + 1..count).filter(|j| !self.unseen[*j]) {
                let product = self.spread.column(i).dot(&self.spread.column(j));
                let correlation = product / (norms[i] * norms[j]);
                if correlation.abs() > CLOSE {
                    correlations.push((self.variables[i], self.variables[j], correlation));
                }
            }
        }
        sort_by(&mut correlations, |a, b| b.2.abs().total_cmp(&a.2.abs()));
        correlations
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two columns at an angle a give estimates with the correlation -cos a. Correlations above 0.95 are reported, the
    /// closest first.
    #[test]
    fn close_correlations_are_told() {
        let bounds = Bounds::new(&[[-1.0, 1.0], [0.0, 4.0], [0.0, 1.0], [0.0, 7.0]]).unwrap();
        let told = |cosines: [f64; 2]| {
            let jacobian = DMatrix::from_fn(5, 4, |i, j| {
                let cosine = cosines[j / 2];
                match (i, j) {
                    (0, 0) | (2, 2) => 1.0,
                    (0, 1) | (2, 3) => cosine,
                    (1, 1) | (3, 3) => (1.0 - cosine * cosine).sqrt(),
                    _ => 0.0,
                }
            });
            let at = Linearisation {
                residuals: DVector::zeros(5),
                jacobian,
            };
            let all = Covariance::of(&at, vec![0, 1, 2, 3], &bounds, &[1.0; 5]).unwrap();
            all.correlations()
        };
        assert_eq!(told([0.5, -0.949]), []);
        for (cosines, expected) in [
            ([0.951, 0.0], vec![(0, 1, -0.951)]),
            ([0.951, -0.98], vec![(2, 3, 0.98), (0, 1, -0.951)]),
            ([0.99, -0.96], vec![(0, 1, -0.99), (2, 3, 0.96)]),
        ] {
            let found = told(cosines);
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(&expected) {
                assert_eq!((found.0, found.1), (expected.0, expected.1));
                assert!((found.2 - expected.2).abs() < 1e-12, "{found:?}");
            }
        }
    }

    /// Variables with equal columns count as not determined. All other variables count as determined. With weights of 1 every
    /// ratio of variances is 1.
    #[test]
    fn twins_are_unseen() {
        let bounds = Bounds::new(&[[-1.0, 1.0]; 3]).unwrap();
        let rows = [1.0, 1.0, 0.0, 2.0, 2.0, 1.0, 0.0, 0.0, 3.0];
        let at = Linearisation {
            residuals: DVector::zeros(3),
            jacobian: DMatrix::from_row_slice(3, 3, &rows),
        };
        let all = Covariance::of(&at, vec![0, 1, 2], &bounds, &[1.0; 3]).unwrap();
        assert_eq!(all.unseen, [true, true, false]);
        assert_eq!(all.correlations(), []);
        assert_eq!((all.ratio(0), all.ratio(1)), (1.0, 1.0));
        assert!((all.ratio(2) - 1.0).abs() < 1e-12);
        assert_eq!(all.ratio(7), 0.0);
        assert!(Covariance::of(&at, Vec::new(), &bounds, &[1.0; 3]).is_none());
    }
}
