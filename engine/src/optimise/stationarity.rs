//! Imbalance of the optimality conditions, which measures how close a point is to a minimum.
//!
//! At a minimum of f under rows c <= 0, levels and bounds, non-negative multipliers exist with which the gradients of the
//! constraints cancel the gradient of f:
//!
//! ```text
//! g + sum_i m_i a_i = 0      g, a_i: gradients of f and of the binding constraints, in half ranges       (1)
//! ```
//!
//! The imbalance is the largest component of the left side of (1), divided by the larger of two numbers. The first number is
//! the largest term of (1). The second number is the largest slope that the squared residuals could have: the largest pivot
//! of their scaled Jacobian times their norm. The imbalance is 0 at a minimum and of order one elsewhere. A run has converged
//! if its imbalance is below [`CONVERGED`].
//!
//! A computed slope is a sum of products, so rounding keeps it from being exactly zero. Residuals have the rounding error
//! [`Options::misfit_below`], or a larger rounding error if short steps have shown it. For example, the rounding error of
//! an equilibrium is larger than the error of a pose. Variables have a resolution: no method makes smaller steps. A slope counts
//! as zero if the rounding error and the resolution can explain it. So a fit to exact measurements converges. Its residuals
//! and their slope consist of rounding errors only, even if the slope is large relative to the residuals.
//!
//! Multipliers come from non-negative least squares, which minimise the left side of (1). If gradients are linearly
//! dependent, several sets of multipliers minimise it, and the code uses the smallest set. At a kink a row has several
//! gradients. The same least squares over all of these gradients give the least-norm subgradient.

use super::{BoundedLeastSquares, Bounds, Linearisation, Options};
use nalgebra::{DMatrix, DVector};

/// Imbalance of the optimality conditions below which a run counts as converged.
pub(super) const CONVERGED: f64 = 1e-6;
/// Damping of the least squares for multipliers. The columns of the least squares have length 1. A gradient counts as
/// dependent on the others if its part outside their span is smaller than the square root of this damping.
const DEPENDENT: f64 = 1e-18;

/// Numbers with which slopes are compared.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Largest slope that the squared residuals could have.
    steepest: f64,
    /// Largest size of a slope that consists of rounding errors only.
    rounding: f64,
}

/// Properties of the squared residuals that give the [`Scale`], in half ranges of the variables.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sizes {
    /// Number of residuals.
    pub residuals: usize,
    /// Norm of the residuals.
    pub norm: f64,
    /// Largest pivot (diagonal entry of the triangular factor) of the residuals' scaled Jacobian.
    pub pivot: f64,
    /// Norm of the longest column of the residuals' scaled Jacobian.
    pub longest: f64,
    /// Norm of the rounding errors of the residuals, as observed in short steps; 0 without such steps.
    pub seen_rounding: f64,
    /// Number of variables.
    pub variables: usize,
    /// Shortest step of a variable.
    pub resolution: f64,
}

impl Scale {
    /// Scale for the slopes of half the squared residuals.
    pub(super) fn new(of: Sizes) -> Self {
        let usual = Options::default().misfit_below * (of.residuals as f64).sqrt();
        let of_residuals = usual.max(of.seen_rounding);
        let of_variables = of.longest * of.resolution * (of.variables as f64).sqrt();
        Scale {
            steepest: of.pivot * of.norm,
            rounding: of.longest * (of_residuals + of_variables),
        }
    }

    /// Imbalance of the optimality conditions. `left` is the largest component of the left side of equation (1) of this
    /// module. It is compared with the [`Scale`] and with `most`, the largest term of equation (1).
    pub(super) fn residual(self, left: f64, most: f64) -> f64 {
        let size = most.max(self.steepest).max(f64::MIN_POSITIVE);
        if left.is_nan() {
            f64::INFINITY
        } else {
            (left - self.rounding).max(0.0) / size
        }
    }
}

/// Imbalance of the optimality conditions of a problem that has bounds, but no constraint rows and no levels (limits of a
/// norm of residuals). `pivot` is the largest pivot of the scaled Jacobian, in half ranges. `seen_rounding` is the norm of
/// the rounding errors of the residuals, as observed in short steps.
pub(super) fn between_bounds(
    at: &Linearisation,
    x: &DVector<f64>,
    bounds: &Bounds,
    pivot: f64,
    seen_rounding: f64,
) -> f64 {
    let (mut left, mut most, mut longest) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (j, column) in at.jacobian.column_iter().enumerate() {
        let half = 0.5 * bounds.width()[j];
        let slope = half * column.dot(&at.residuals);
        longest = longest.max(half * column.norm());
        let blocked = (slope > 0.0 && x[j] <= bounds.lower()[j])
            || (slope < 0.0 && x[j] >= bounds.upper()[j]);
        most = most.max(slope.abs());
        if !blocked {
            left = left.max(slope.abs());
        }
    }
    let sizes = Sizes {
        residuals: at.residuals.len(),
        norm: at.residuals.norm(),
        pivot,
        longest,
        seen_rounding,
        variables: x.len(),
        // Smallest step in half ranges. `step_below` is in fractions of the ranges.
        resolution: 2.0 * Options::default().step_below,
    };
    Scale::new(sizes).residual(left, most)
}

/// Gradients of the binding constraints and bounds, in half ranges.
#[derive(Clone, Debug, Default)]
pub(super) struct Pushes {
    gradients: Vec<f64>,
    /// True for each multiplier that may have either sign.
    is_free: Vec<bool>,
}

/// Multipliers with which the gradients of the constraints best cancel the gradient of the objective, and the remainder.
#[derive(Clone, Debug)]
pub(super) struct Balance {
    pub residual: f64,
    /// Multipliers in the order of the gradients.
    pub multipliers: Vec<f64>,
}

impl Pushes {
    /// Adds the gradient of a row, level or bound. `is_free` is true for an equality, whose multiplier may have either sign.
    pub(super) fn add(&mut self, gradient: &[f64], is_free: bool) {
        self.gradients.extend_from_slice(gradient);
        self.is_free.push(is_free);
    }

    /// Multipliers with the smallest left side of equation (1) of this module. If several sets of multipliers are equally
    /// good, returns the smallest set.
    pub(super) fn balance(&self, slope: &[f64], scale: Scale) -> Balance {
        let (n, count) = (slope.len(), self.is_free.len());
        let most = |of: &[f64]| of.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        if count == 0 {
            return Balance {
                residual: scale.residual(most(slope), most(slope)),
                multipliers: Vec::new(),
            };
        }
        let columns = DMatrix::from_column_slice(n, count, &self.gradients);
        let norms = columns.column_iter().map(|c| c.norm());
        let width: Vec<f64> = norms
            .map(|norm| if norm > 0.0 { 1.0 / norm } else { 0.0 })
            .collect();
        let width = DVector::from_vec(width);
        let mut squares = BoundedLeastSquares::new(count, n);
        squares.reduce(&columns, &width, &DVector::from_column_slice(slope));
        let lower = self.is_free.iter();
        let lower: Vec<f64> = lower
            .map(|free| if *free { f64::NEG_INFINITY } else { 0.0 })
            .collect();
        squares.solve(DEPENDENT, &lower, &vec![f64::INFINITY; count]);
        let multipliers: Vec<f64> = squares
            .step()
            .iter()
            .zip(width.iter())
            .map(|(s, w)| s * w)
            .collect();
        let mut sum = DVector::from_column_slice(slope);
        let mut largest = most(slope);
        for (column, multiplier) in columns.column_iter().zip(&multipliers) {
            sum.axpy(*multiplier, &column, 1.0);
            largest = largest.max(multiplier.abs() * column.amax());
        }
        Balance {
            residual: scale.residual(sum.amax(), largest),
            multipliers,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimise::test_problems::Noise;

    /// Makes the scale for one residual of size 1 with slopes of size 1.
    fn plain(variables: usize) -> Scale {
        Scale::new(Sizes {
            residuals: 1,
            norm: 1.0,
            pivot: 1.0,
            longest: 1.0,
            seen_rounding: 0.0,
            variables,
            resolution: 1e-12,
        })
    }

    /// Slopes that are combinations of random gradients with known multipliers can be balanced. With multipliers of the
    /// opposite signs they cannot be balanced.
    #[test]
    fn planted_multipliers_balance_and_those_of_the_wrong_sign_do_not() {
        let mut noise = Noise::new(11);
        let scale = plain(5);
        for round in 0..50 {
            let mut pushes = Pushes::default();
            let mut slope = vec![0.0; 5];
            for row in 0..3 {
                let gradient: Vec<f64> = (0..5).map(|_| noise.next()).collect();
                let multiplier = 0.1 + noise.next().abs();
                for (slope, a) in slope.iter_mut().zip(&gradient) {
                    *slope -= multiplier * a;
                }
                pushes.add(&gradient, false);
                // Every second row appears twice.
                if (round + row) % 2 == 0 {
                    pushes.add(&gradient, false);
                }
            }
            let found = pushes.balance(&slope, scale);
            assert!(found.residual < 1e-12, "{round}: {}", found.residual);
            let turned: Vec<f64> = slope.iter().map(|s| -s).collect();
            assert!(pushes.balance(&turned, scale).residual > 1e-3);
        }
    }

    /// One gradient cannot balance the slope. Together with the gradients on the other sides of a kink, it can.
    #[test]
    fn gradients_on_both_sides_of_a_kink_balance_together() {
        let scale = plain(2);
        let mut pushes = Pushes::default();
        pushes.add(&[1.0, 0.3], false);
        assert!(pushes.balance(&[-0.2, 1.0], scale).residual > 0.1);
        pushes.add(&[-1.0, -0.7], false);
        pushes.add(&[1.0, -1.0], false);
        assert!(pushes.balance(&[-0.2, 1.0], scale).residual < 1e-12);
    }

    /// Two equal gradients get equal multipliers, although only the sum of the two multipliers is determined.
    #[test]
    fn equal_gradients_share_their_multiplier() {
        let mut pushes = Pushes::default();
        pushes.add(&[1.0, 2.0], false);
        pushes.add(&[1.0, 2.0], false);
        let found = pushes.balance(&[-4.0, -8.0], plain(2));
        assert!((found.multipliers[0] - 2.0).abs() < 1e-6, "{found:?}");
        assert!((found.multipliers[1] - 2.0).abs() < 1e-6, "{found:?}");
    }
}
