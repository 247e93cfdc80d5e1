//! Gaussian elimination with partial pivoting, in every SIMD lane, for all right-hand sides of a matrix at once.
//!
//! Each lane has separate pivots. If a pivot is zero, the results in its lane are not finite.

#![expect(
    clippy::needless_range_loop,
    reason = "rows and columns of matrices are named by their numbers"
)]

use crate::number::{MaskOf, SimdReal, Valued};

/// Solves A X = B and A x = c. Replaces the first `size` rows of B and c with the solutions X and x.
/// Afterwards the diagonal of `a` contains the pivots. Returns the SIMD lanes in which every pivot is finite and not
/// zero.
#[inline(always)]
pub(crate) fn eliminate<T: Valued, const N: usize, const C: usize>(
    a: &mut [[T; N]; N],
    b: &mut [[T; C]; N],
    c: &mut [T; N],
    size: usize,
) -> MaskOf<T> {
    let mut is_regular = a[0][0].plain_value().everywhere();
    for k in 0..size {
        take_pivot(a, b, c, k, size);
        let pivot = a[k][k].plain_value().abs();
        is_regular = is_regular & pivot.is_above(0.0) & pivot.is_below(f64::INFINITY);
        let inverse = a[k][k].one() / a[k][k];
        for i in k + 1..size {
            let factor = a[i][k] * inverse;
            for j in k + 1..size {
                a[i][j] = a[i][j].minus_product(factor, a[k][j]);
            }
            for j in 0..C {
                b[i][j] = b[i][j].minus_product(factor, b[k][j]);
            }
            c[i] = c[i].minus_product(factor, c[k]);
        }
    }
    for i in (0..size).rev() {
        for j in i + 1..size {
            for k in 0..C {
                b[i][k] = b[i][k].minus_product(a[i][j], b[j][k]);
            }
            c[i] = c[i].minus_product(a[i][j], c[j]);
        }
        for k in 0..C {
            b[i][k] = b[i][k] / a[i][i];
        }
        c[i] = c[i] / a[i][i];
    }
    is_regular
}

/// Exchanges row `k` with later rows until its entry in column `k` (the pivot) has the largest absolute value. In SIMD
/// registers, each lane exchanges its own rows.
#[inline(always)]
fn take_pivot<T: Valued, const N: usize, const C: usize>(
    a: &mut [[T; N]; N],
    b: &mut [[T; C]; N],
    c: &mut [T; N],
    k: usize,
    size: usize,
) {
    let value = |number: T| number.plain_value().abs();
    if !T::IN_REGISTERS {
        let mut pivot = k;
        for i in k + 1..size {
            if T::Plain::any(value(a[pivot][k]).less(value(a[i][k]))) {
                pivot = i;
            }
        }
        a.swap(k, pivot);
        b.swap(k, pivot);
        c.swap(k, pivot);
        return;
    }
    for i in k + 1..size {
        let is_larger = value(a[k][k]).less(value(a[i][k]));
        if T::Plain::any(is_larger) {
            let exchanged = |upper: T, lower: T| {
                let first = T::choose(is_larger, lower, upper);
                (first, T::choose(is_larger, upper, lower))
            };
            for j in k..size {
                (a[k][j], a[i][j]) = exchanged(a[k][j], a[i][j]);
            }
            for j in 0..C {
                (b[k][j], b[i][j]) = exchanged(b[k][j], b[i][j]);
            }
            (c[k], c[i]) = exchanged(c[k], c[i]);
        }
    }
}
