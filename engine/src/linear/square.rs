//! LU factorisation of a square matrix of up to [`MOST`] rows, without heap memory.

use crate::number::{Scalar, array_of};

/// Largest number of rows of a matrix that [`SquareLu`] can factorise.
pub(crate) const MOST: usize = 12;

/// Factors of a row-permuted matrix of `size` rows: unit lower triangle and upper triangle in one array.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SquareLu<T> {
    factors: [[T; MOST]; MOST],
    order: [usize; MOST],
    size: usize,
}

impl<T: Scalar> SquareLu<T> {
    /// Factorises the first `size` rows and columns of a matrix. Returns `None` if a pivot is zero or not finite.
    #[inline]
    pub(crate) fn of(mut a: [[T; MOST]; MOST], size: usize) -> Option<Self> {
        let mut order: [usize; MOST] = array_of(|i| i);
        for k in 0..size {
            let mut pivot = k;
            for i in k + 1..size {
                if a[i][k].value().abs() > a[pivot][k].value().abs() {
                    pivot = i;
                }
            }
            if pivot != k {
                a.swap(k, pivot);
                order.swap(k, pivot);
            }
            let is_usable = a[k][k].value().is_finite() && a[k][k].value() != 0.0;
            if !is_usable {
                return None;
            }
            let inverse = a[k][k].one() / a[k][k];
            let pivot_row = a[k];
            for row in a.iter_mut().take(size).skip(k + 1) {
                let factor = row[k] * inverse;
                row[k] = factor;
                for j in k + 1..size {
                    row[j] = row[j] - factor * pivot_row[j];
                }
            }
        }
        Some(SquareLu {
            factors: a,
            order,
            size,
        })
    }

    /// Solves A x = b for x. After the first `size` entries, the result contains the entries of `b` unchanged.
    #[inline]
    pub(crate) fn solve(&self, b: &[T; MOST]) -> [T; MOST] {
        let mut x = *b;
        for i in 0..self.size {
            x[i] = b[self.order[i]];
        }
        for i in 1..self.size {
            for j in 0..i {
                x[i] = x[i] - self.factors[i][j] * x[j];
            }
        }
        for i in (0..self.size).rev() {
            for j in i + 1..self.size {
                x[i] = x[i] - self.factors[i][j] * x[j];
            }
            x[i] = x[i] / self.factors[i][i];
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The matrix times the solution equals the right-hand side within a few rounding errors.
    #[test]
    fn the_solution_satisfies_the_equations() {
        let mut seed = 0.3_f64;
        let mut next = || {
            seed = (seed * 1013.7 + 0.41).fract();
            seed - 0.5
        };
        let a: [[f64; MOST]; MOST] = std::array::from_fn(|_| std::array::from_fn(|_| next()));
        let b: [f64; MOST] = std::array::from_fn(|_| next());
        for size in [1, 7, MOST] {
            let x = SquareLu::of(a, size).unwrap().solve(&b);
            let largest = x.iter().take(size).fold(0.0_f64, |m, c| m.max(c.abs()));
            for i in 0..size {
                let sum: f64 = (0..size).map(|j| a[i][j] * x[j]).sum();
                assert!((sum - b[i]).abs() < 64.0 * f64::EPSILON * largest);
            }
        }
        assert!(SquareLu::of([[0.0; MOST]; MOST], 3).is_none());
    }
}
