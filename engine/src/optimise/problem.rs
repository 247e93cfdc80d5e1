//! Problems to minimise.

use nalgebra::{DMatrix, DVector};

/// A nonlinear least-squares problem: minimise the sum of the squares of m residuals over n variables.
///
/// Residuals are in multiples of the tolerance: 1 is the largest acceptable deviation.
pub trait LeastSquares {
    /// Number n of variables, at least one.
    fn variables(&self) -> usize;

    /// Number m of residuals, at least one. May be smaller than n.
    fn residuals(&self) -> usize;

    /// Computes all residuals at `x` and their exact derivatives. Writes both into `into`.
    ///
    /// One pass computes the residuals and the derivatives, because they share nearly all of the work. The method takes
    /// `&mut self` so that a problem may keep its workspace. But the result must depend on `x` alone: the method must not
    /// start from the result of the previous call.
    fn evaluate(&mut self, x: &DVector<f64>, into: &mut Linearisation) -> Result<(), Infeasible>;
}

/// Residuals and their derivatives at one point.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearisation {
    /// Residuals, m numbers, in multiples of the tolerance.
    pub residuals: DVector<f64>,
    /// Derivatives of the residuals (rows) with respect to the variables (columns), an m x n matrix.
    pub jacobian: DMatrix<f64>,
}

impl Linearisation {
    /// Allocates memory for m `residuals` of n `variables`.
    pub fn new(residuals: usize, variables: usize) -> Self {
        Linearisation {
            residuals: DVector::zeros(residuals),
            jacobian: DMatrix::zeros(residuals, variables),
        }
    }

    /// Half the sum of the squared residuals.
    pub fn cost(&self) -> f64 {
        0.5 * self.residuals.norm_squared()
    }

    /// Root mean square of the residuals. The value is 1 if each residual is as large as its tolerance, for any number of
    /// residuals.
    pub fn misfit(&self) -> f64 {
        (self.residuals.norm_squared() / self.residuals.len() as f64).sqrt()
    }

    /// Writes derivatives with respect to the variables, times a factor, into a row.
    pub(super) fn write_slopes(&mut self, row: usize, slopes: &[f64], scale: f64) {
        for (column, slope) in slopes.iter().enumerate() {
            self.jacobian[(row, column)] = slope * scale;
        }
    }

    /// Refuses entries that are not finite, or so large that their squares could overflow.
    pub(super) fn check(&self) -> Result<(), Infeasible> {
        // The squares of usable numbers do not overflow. The sum of 1e8 such squares is still finite.
        let usable = |value: &f64| value.abs() < 1e150;
        // Nearly always all numbers are usable. So a check of all numbers is faster than a check that stops at the first
        // unusable number.
        let all = |values: &[f64]| values.iter().fold(true, |all, value| all & usable(value));
        if all(self.residuals.as_slice()) && all(self.jacobian.as_slice()) {
            return Ok(());
        }
        if let Some(row) = self.residuals.iter().position(|value| !usable(value)) {
            let value = self.residuals[row];
            return Err(Infeasible::Residual { row, value });
        }
        if let Some(index) = self.jacobian.iter().position(|value| !usable(value)) {
            let (row, column) = self.jacobian.vector_to_matrix_index(index);
            let value = self.jacobian[(row, column)];
            return Err(Infeasible::Derivative { row, column, value });
        }
        Ok(())
    }
}

/// Reason why there are no residuals at a point.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Infeasible {
    /// The problem refuses the point: the design cannot be assembled, or does not reach a station.
    #[error("{0}")]
    Refused(String),
    /// A request stopped the run before this evaluation.
    #[error("interrupted")]
    Interrupted,
    /// A residual is not a usable number.
    #[error("residual {row} is {value}")]
    Residual {
        /// Index of the residual.
        row: usize,
        /// Value of the residual.
        value: f64,
    },
    /// A derivative is not a usable number.
    #[error("the derivative of residual {row} with respect to variable {column} is {value}")]
    Derivative {
        /// Index of the residual.
        row: usize,
        /// Index of the variable.
        column: usize,
        /// Value of the derivative.
        value: f64,
    },
}
