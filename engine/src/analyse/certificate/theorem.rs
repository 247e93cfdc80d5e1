//! One application of the theorem of Newton and Kantorovich.
//!
//! The sums with many terms are |A F|, |1 - A J| and |A H|. They are computed in plain doubles from the middles and
//! radii of intervals. Then a bound of the rounding error is added. With the unit roundoff u, a sum of n products has
//! an error of at most n u/(1 - n u) times the sum of the absolute values of these products (N. J. Higham, *Accuracy
//! and Stability of Numerical Algorithms*, 3.1). All these sums of products have at most sixteen terms.

use super::quadratic::{Jacobian, PoseBend, middles, radius};
use super::{N, Square};
use crate::linear::lu::Lu;
use crate::mechanism::Unproven;
use crate::number::Real;
use crate::number::{Each, Interval, array_of};

/// Radii that the theorem returns: error bound and radius of uniqueness.
pub(crate) struct Radii {
    pub error: f64,
    pub uniqueness: f64,
}

/// Bound on the relative rounding error of a sum: sixteen units of roundoff, times two. The factor two covers the denominator 1
/// - n u and the rounding of the products in the bound.
pub(crate) const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Factor that rounds sums upward. The sums have up to two hundred non-negative terms. Each term is rounded a few
/// times. Rounding changes a sum by less than 1e-12 of its value.
const UPWARD: f64 = 1.0 + 1e-12;

/// Applies the theorem of Newton and Kantorovich. A is an approximate inverse of the middle of the Jacobian. `residual` bounds
/// |A F|.
pub(crate) fn radii(
    inverse: &Square,
    jacobian: &Jacobian,
    bends: &[PoseBend],
    residual: f64,
) -> Result<Radii, Unproven> {
    let left = Interval::point(1.0) - Interval::point(defect(inverse, jacobian));
    // `left.low` is never NaN, because interval bounds are never NaN.
    if left.low <= 0.0 {
        return Err(Unproven::Singular);
    }
    let (residual, bend) = (
        Interval::point(residual),
        Interval::point(curvature(inverse, bends)),
    );
    let discriminant = left.squared() - (residual * bend).scaled(2.0);
    if discriminant.low < 0.0 {
        return Err(Unproven::TooClose);
    }
    let root = left + discriminant.sqrt();
    let error = (residual.scaled(2.0) / root).high;
    let uniqueness = (root / bend).low;
    if error.is_finite() && uniqueness.is_finite() {
        Ok(Radii { error, uniqueness })
    } else {
        Err(Unproven::Singular)
    }
}

/// Bound on |1 - A J|, for an approximate inverse A of the Jacobian J.
pub(crate) fn defect(inverse: &Square, jacobian: &Jacobian) -> f64 {
    let middle = middles(jacobian);
    let off: Square = array_of(|k| {
        array_of(|j| radius(jacobian[k][j], middle[k][j]) + ROUNDING * middle[k][j].abs())
    });
    let row = |i: usize| {
        let mut product = [0.0; N];
        let mut unsure = [0.0; N];
        product[i] = -1.0;
        unsure[i] = ROUNDING;
        for k in 0..N {
            let factor = inverse[i][k];
            for j in 0..N {
                product[j] += factor * middle[k][j];
                unsure[j] += factor.abs() * off[k][j];
            }
        }
        let terms = product.iter().zip(&unsure);
        terms.map(|(p, u)| p.abs() + u).sum::<f64>()
    };
    largest((0..N).map(row))
}

/// Bound on |A H|, for an approximate inverse A and the second derivatives H of the equations.
fn curvature(inverse: &Square, bends: &[PoseBend]) -> f64 {
    let row = |i: usize| {
        let (mut total, mut unsure) = (0.0, 0.0);
        for pair in bends.chunk_by(|a, b| a.pair == b.pair) {
            let mut sum = 0.0;
            for bend in pair {
                let factor = inverse[i][bend.equation];
                sum += factor * bend.middle;
                unsure += factor.abs() * bend.off;
            }
            total += sum.abs();
        }
        total + unsure
    };
    largest((0..N).map(row))
}

/// Returns the largest of several sums of non-negative terms, rounded up. The result includes a bound for underflow.
fn largest(sums: impl Iterator<Item = f64>) -> f64 {
    sums.fold(0.0, |most: f64, sum| {
        // The comparison `bound <= f64::MAX` is false for NaN, so the result is then infinite.
        let bound = sum * UPWARD + f64::MIN_POSITIVE;
        if bound <= f64::MAX {
            most.max(bound)
        } else {
            f64::INFINITY
        }
    })
}

/// Returns a bound on the norm of A times a vector. A is the approximate inverse of the Jacobian.
pub(crate) fn image(inverse: &Square, vector: &[Interval; N]) -> f64 {
    let middle = vector.each(Interval::middle);
    let off: [f64; N] = array_of(|j| radius(vector[j], middle[j]) + ROUNDING * middle[j].abs());
    let row = |row: &[f64; N]| {
        let (mut sum, mut unsure) = (0.0, 0.0);
        for j in 0..N {
            sum += row[j] * middle[j];
            unsure += row[j].abs() * off[j];
        }
        f64::abs(sum) + unsure
    };
    largest(inverse.iter().map(row))
}

/// Approximate inverse of a matrix.
pub(crate) fn inverse(matrix: &Square) -> Result<Square, Unproven> {
    let factors = Lu::of(*matrix, 1.0).ok_or(Unproven::Singular)?;
    Ok(factors.inverse())
}
