//! LU factorisation with partial pivoting. It solves the six closure equations of a wheel (one for each constraint of the
//! wheel carrier). A path tangent (direction of the curve of poses) can add a row and a column to these equations. The
//! factorisation also serves a certificate (proof that a pose exists; twelve equations), Attia's paper (fifteen equations)
//! and the tangent of a car's states.

use crate::number::{Each, Jet, Scalar, array_of};

/// Six numbers: residuals, multipliers, or a twist (displacement, rotation).
pub(crate) type Vector6<T> = [T; 6];
/// Six rows of six numbers.
pub(crate) type Matrix6<T> = [[T; 6]; 6];

/// Factors of a row-permuted matrix: unit lower triangle and upper triangle in one array.
#[derive(Clone, Copy, Debug)]
pub struct Lu<T, const N: usize> {
    factors: [[T; N]; N],
    /// Row permutation: row `order[i]` of the matrix became row `i`.
    order: [usize; N],
    determinant: f64,
}

/// Factors of the Jacobian of the six closure equations.
pub type Lu6<T> = Lu<T, 6>;

impl<T: Scalar> Lu6<T> {
    /// Factorises the Jacobian of the closure equations. Its last three columns are moments, in length units. So the
    /// function divides the determinant by `size`^3, where `size` is a typical length of the suspension. The resulting
    /// number is +-1 for six orthogonal unit lines, and 0 at a singularity. `None` as in [`Lu::of`].
    #[inline]
    pub fn new(jacobian: Matrix6<T>, size: f64) -> Option<Self> {
        Lu::of(jacobian, size.powi(-3))
    }
}

impl<T: Scalar, const N: usize> Lu<T, N> {
    /// Factorises a matrix. The stored determinant is the determinant of the matrix, multiplied by `unit`. Returns `None`
    /// if the stored determinant is zero or not finite, for example because a pivot is zero or NaN.
    #[inline]
    pub fn of(mut a: [[T; N]; N], unit: f64) -> Option<Self> {
        let mut order: [usize; N] = array_of(|i| i);
        let mut determinant = unit;
        for k in 0..N {
            let mut pivot = k;
            for i in k + 1..N {
                if a[i][k].value().abs() > a[pivot][k].value().abs() {
                    pivot = i;
                }
            }
            if pivot != k {
                a.swap(k, pivot);
                order.swap(k, pivot);
                determinant = -determinant;
            }
            determinant *= a[k][k].value();
            let inverse = a[k][k].one() / a[k][k];
            let pivot_row = a[k];
            for row in a.iter_mut().skip(k + 1) {
                let factor = row[k] * inverse;
                row[k] = factor;
                for j in k + 1..N {
                    row[j] = row[j] - factor * pivot_row[j];
                }
            }
        }
        (determinant.is_finite() && determinant != 0.0).then_some(Lu {
            factors: a,
            order,
            determinant,
        })
    }

    /// Determinant of the matrix, multiplied by the `unit` of [`Lu::of`]. Its sign does not change along a sequence of
    /// poses without a singularity.
    pub fn determinant(&self) -> f64 {
        self.determinant
    }

    /// Pivots, in the order of elimination.
    pub fn pivots(&self) -> [T; N] {
        array_of(|k| self.factors[k][k])
    }

    /// Solves A x = b for x.
    #[inline]
    pub fn solve(&self, b: [T; N]) -> [T; N] {
        let mut x = self.order.each(|i| b[i]);
        for i in 1..N {
            for j in 0..i {
                x[i] = x[i] - self.factors[i][j] * x[j];
            }
        }
        for i in (0..N).rev() {
            for j in i + 1..N {
                x[i] = x[i] - self.factors[i][j] * x[j];
            }
            x[i] = x[i] / self.factors[i][i];
        }
        x
    }

    /// Solves A^T x = b for x.
    #[inline]
    pub fn solve_transposed(&self, b: [T; N]) -> [T; N] {
        let mut y = b;
        for i in 0..N {
            for j in 0..i {
                y[i] = y[i] - self.factors[j][i] * y[j];
            }
            y[i] = y[i] / self.factors[i][i];
        }
        for i in (0..N).rev() {
            for j in i + 1..N {
                y[i] = y[i] - self.factors[j][i] * y[j];
            }
        }
        let mut x = y;
        for i in 0..N {
            x[self.order[i]] = y[i];
        }
        x
    }

    /// Solves A x = b for a matrix and a right-hand side that are Taylor series in one variable. `self` holds the factors of
    /// the constant part of `matrix`.
    pub(crate) fn solve_series<const M: usize>(
        &self,
        matrix: &[[Jet<T, M>; N]; N],
        b: &[Jet<T, M>; N],
    ) -> [Jet<T, M>; N] {
        let entry = |row: usize, column: usize, i: usize| matrix[row][column][i];
        coefficient_by_coefficient(b, entry, |right| self.solve(right))
    }

    /// Solves A^T x = b for a matrix and a right-hand side that are Taylor series, like [`Lu::solve_series`].
    #[inline]
    pub(crate) fn solve_transposed_series<const M: usize>(
        &self,
        matrix: &[[Jet<T, M>; N]; N],
        b: &[Jet<T, M>; N],
    ) -> [Jet<T, M>; N] {
        let entry = |row: usize, column: usize, i: usize| matrix[column][row][i];
        coefficient_by_coefficient(b, entry, |right| self.solve_transposed(right))
    }
}

/// Solves A x = b for Taylor series: A_0 x_k = b_k - sum_i A_i x_(k-i), where the index is the power of the series.
/// `entry` returns an entry of A_i, given its row, its column and i. `solve` solves a system with A_0.
#[inline(always)]
fn coefficient_by_coefficient<T: Scalar, const N: usize, const M: usize>(
    b: &[Jet<T, M>; N],
    entry: impl Fn(usize, usize, usize) -> T,
    solve: impl Fn([T; N]) -> [T; N],
) -> [Jet<T, M>; N] {
    let mut x = *b;
    for k in 0..M {
        let mut right = b.each(|series| series[k]);
        for i in 1..=k {
            for (row, sum) in right.iter_mut().enumerate() {
                for (column, known) in x.iter().enumerate() {
                    *sum = *sum - entry(row, column, i) * known[k - i];
                }
            }
        }
        let part = solve(right);
        for row in 0..N {
            x[row].0[k] = part[row];
        }
    }
    x
}

impl<const N: usize> Lu<f64, N> {
    /// The matrix as the product of its factors. Its rows have the order of the factors: row i was row `order[i]` of the
    /// original matrix.
    pub(crate) fn matrix(&self) -> [[f64; N]; N] {
        let f = &self.factors;
        let mut rows = *f;
        for (i, row) in rows.iter_mut().enumerate() {
            row[..i].fill(0.0);
        }
        for i in (1..N).rev() {
            for j in 0..i {
                let upper = rows[j];
                add(&mut rows[i], f[i][j], &upper);
            }
        }
        rows
    }

    /// Inverse of the matrix.
    pub fn inverse(&self) -> [[f64; N]; N] {
        let f = &self.factors;
        let mut rows = [[0.0; N]; N];
        for (row, of) in rows.iter_mut().zip(self.order) {
            row[of] = 1.0;
        }
        for i in 1..N {
            for j in 0..i {
                let known = rows[j];
                add(&mut rows[i], -f[i][j], &known);
            }
        }
        for i in (0..N).rev() {
            for j in i + 1..N {
                let known = rows[j];
                add(&mut rows[i], -f[i][j], &known);
            }
            let inverse = 1.0 / f[i][i];
            rows[i].iter_mut().for_each(|c| *c *= inverse);
        }
        rows
    }
}

/// Adds the row `other`, multiplied by `factor`, to the row `row`.
#[inline]
fn add<const N: usize>(row: &mut [f64; N], factor: f64, other: &[f64; N]) {
    for j in 0..N {
        row[j] += factor * other[j];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Real;
    use std::array::from_fn;

    const A: Matrix6<f64> = [
        [0.0, 2.0, 1.0, -1.0, 0.5, 3.0],
        [1.0, 0.0, -2.0, 4.0, 1.0, 0.0],
        [3.0, 1.0, 0.0, 0.5, -1.0, 2.0],
        [-1.0, 5.0, 2.0, 0.0, 1.0, 1.0],
        [2.0, -2.0, 1.0, 1.0, 0.0, -3.0],
        [0.5, 1.0, 4.0, -1.0, -2.0, 5.0],
    ];

    /// Bound of the residual relative to |A| |x|. The elimination is backward stable: the residual is of the order of eps
    /// |A| |x| for any condition number. With partial pivoting of six rows, entries grow by at most 2^5.
    const BOUND: f64 = 36.0 * 32.0 * f64::EPSILON;

    #[test]
    fn the_inverse_is_that_of_the_matrix() {
        let lu = Lu6::new(A, 1.0).unwrap();
        let (matrix, inverse) = (lu.matrix(), lu.inverse());
        let largest = |m: &Matrix6<f64>| m.iter().flatten().map(|c| c.abs()).fold(0.0, f64::max);
        for (i, row) in matrix.iter().enumerate() {
            let found = A[lu.order[i]].iter().zip(row);
            assert!(found.into_iter().all(|(a, b)| (a - b).abs() < BOUND * 5.0));
            for k in 0..6 {
                let product: f64 = (0..6).map(|j| row[j] * inverse[j][k]).sum();
                let error = product - if lu.order[i] == k { 1.0 } else { 0.0 };
                assert!(error.abs() < BOUND * 5.0 * largest(&inverse), "{error:e}");
            }
        }
    }

    /// Fifteen equations, the number in Attia's paper. The matrix times the solution equals the right-hand side within a
    /// few rounding errors.
    #[test]
    fn fifteen_equations_are_solved_both_ways() {
        let mut seed = 0.3_f64;
        let mut next = || {
            seed = (seed * 1013.7 + 0.41).fract();
            seed - 0.5
        };
        let a: [[f64; 15]; 15] = from_fn(|_| from_fn(|_| next()));
        let b: [f64; 15] = from_fn(|_| next());
        let lu = Lu::of(a, 1.0).unwrap();
        assert!((0..15).filter(|i| lu.order[*i] != *i).count() > 5);
        let (x, y) = (lu.solve(b), lu.solve_transposed(b));
        let largest = x.iter().chain(&y).fold(0.0_f64, |m, c| m.max(c.abs()));
        for k in 0..15 {
            let residual: f64 = (0..15).map(|j| a[k][j] * x[j]).sum::<f64>() - b[k];
            let transposed: f64 = (0..15).map(|i| a[i][k] * y[i]).sum::<f64>() - b[k];
            let bound = 64.0 * f64::EPSILON * largest;
            assert!(residual.abs() < bound && transposed.abs() < bound);
        }
    }

    #[test]
    fn a_singular_matrix_is_refused() {
        let mut singular = A;
        singular[4] = [0.0; 6];
        assert!(Lu6::new(singular, 1.0).is_none());
    }

    #[test]
    fn a_series_solution_satisfies_the_series_equation() {
        let matrix: Matrix6<Jet<f64, 3>> =
            from_fn(|i| from_fn(|j| Jet([A[i][j], A[j][i] * 0.3, (i as f64 - j as f64) * 0.1])));
        let b: Vector6<Jet<f64, 3>> = from_fn(|i| Jet([1.0 + i as f64, -0.5, 0.25 * i as f64]));
        let lu = Lu6::new(A, 1.0).unwrap();
        let x = lu.solve_series(&matrix, &b);
        let y = lu.solve_transposed_series(&matrix, &b);
        for j in 0..6 {
            let mut sums = [b[j].zero(); 2];
            for i in 0..6 {
                sums[0] = sums[0] + matrix[j][i] * x[i];
                sums[1] = sums[1] + matrix[i][j] * y[i];
            }
            let largest = x
                .iter()
                .chain(&y)
                .flat_map(|c| c.0)
                .fold(0.0_f64, |m, c| m.max(c.abs()));
            for k in 0..3 {
                for sum in &sums {
                    assert!((sum[k] - b[j][k]).abs() < 3.0 * BOUND * 5.0 * largest);
                }
            }
        }
    }
}
