//! Orthogonal triangularisation by Householder reflections (G. H. Golub, Ch. F. Van Loan, Matrix Computations, 4th ed., 5.2),
//! in place and without allocation of memory.
//!
//! nalgebra's own decomposition allocates and keeps Q. The solvers need only R and Q^T b, tens of thousands of times, for
//! matrices of a few hundred entries.

use nalgebra::DMatrix;

/// Smallest norm of a column that counts as nonzero. The square of a smaller norm would not be a normal floating-point
/// number.
const SMALLEST_NORM: f64 = 1.5e-154;

/// Writes the columns of a Jacobian into `to`, each multiplied by its factor and extended with zeros to `rows` rows.
pub(super) fn scale_columns(jacobian: &DMatrix<f64>, by: &[f64], rows: usize, to: &mut Vec<f64>) {
    to.clear();
    to.resize(by.len() * rows, 0.0);
    let columns = jacobian.as_slice().chunks_exact(jacobian.nrows().max(1));
    for (j, column) in columns.enumerate() {
        for (row, entry) in column.iter().enumerate() {
            to[j * rows + row] = entry * by[j];
        }
    }
}

/// Makes the matrix `a` upper triangular by reflections, and applies the same reflections to `b`.
///
/// `a` is stored by columns, each with `rows` entries. It has at most `rows` columns; `b` has `rows` entries. Afterwards the upper
/// triangle of `a` is R, and `b` is Q^T b. The entries of `a` below the diagonal are undefined. The method is backward stable for
/// any rank. Dependent columns give small diagonal entries.
pub(super) fn triangularise(a: &mut [f64], rows: usize, b: &mut [f64]) {
    triangularise_within(a, rows, |_| rows, b);
}

/// Triangularises like [`triangularise`], for columns with known zeros: column k has only zeros from row `end(k)` on. `end` must
/// not decrease. For triangles whose rows are interleaved, this saves two thirds of the work.
pub(super) fn triangularise_within(
    a: &mut [f64],
    rows: usize,
    end: impl Fn(usize) -> usize,
    b: &mut [f64],
) {
    for k in 0..a.len() / rows {
        let end = end(k);
        let (done, ahead) = a.split_at_mut((k + 1) * rows);
        let mirror = &mut done[k * rows + k..][..end - k];
        let norm = dot(mirror, mirror).sqrt();
        if norm < SMALLEST_NORM {
            mirror[0] = 0.0;
            continue;
        }
        // The diagonal entry and `first` have opposite signs, to avoid cancellation. |mirror|^2 = 2 norm (norm + |first|).
        let first = mirror[0];
        let diagonal = -norm.copysign(first);
        mirror[0] = first - diagonal;
        let scale = 1.0 / (norm * (norm + first.abs()));
        for column in ahead.chunks_exact_mut(rows) {
            reflect(mirror, scale, &mut column[k..end]);
        }
        reflect(mirror, scale, &mut b[k..end]);
        mirror[0] = diagonal;
    }
}

/// Solves R x = b for the upper triangle R of `a` (columns of `rows` entries), and leaves x in the head of `b`. An unknown
/// with a zero diagonal entry becomes zero.
pub(super) fn back_substitute(a: &[f64], rows: usize, b: &mut [f64]) {
    for k in (0..a.len() / rows).rev() {
        let column = &a[k * rows..];
        b[k] = if column[k] == 0.0 {
            0.0
        } else {
            b[k] / column[k]
        };
        let x = b[k];
        for (b, r) in b[..k].iter_mut().zip(column) {
            *b -= x * r;
        }
    }
}

/// Replaces x by x - scale mirror (mirror . x).
fn reflect(mirror: &[f64], scale: f64, x: &mut [f64]) {
    let factor = scale * dot(mirror, x);
    let mirror = &mirror[..x.len()];
    for (k, x) in x.iter_mut().enumerate() {
        *x -= factor * mirror[k];
    }
}

/// Scalar product with eight separate partial sums, so that no addition must wait for the previous one.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().min(b.len());
    let (a, b) = (&a[..count], &b[..count]);
    let (a_eights, a_rest) = a.as_chunks::<8>();
    let (b_eights, b_rest) = b.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for (k, a) in a_eights.iter().enumerate() {
        for lane in 0..8 {
            sums[lane] += a[lane] * b_eights[k][lane];
        }
    }
    let mut rest = 0.0;
    for (k, a) in a_rest.iter().enumerate() {
        rest += a * b_rest[k];
    }
    let mut sum = 0.0;
    for part in &sums {
        sum += part;
    }
    sum + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimise::test_problems::Noise;
    use nalgebra::DVector;

    /// The triangle is the same with and without the use of known zeros.
    #[test]
    fn known_zeros_change_nothing() {
        let mut noise = Noise::new(2);
        for ends in [vec![2, 4, 6], vec![1, 3, 3, 7], vec![5; 5]] {
            let (columns, rows) = (ends.len(), 7);
            let a = DMatrix::from_fn(
                rows,
                columns,
                |i, j| if i < ends[j] { noise.next() } else { 0.0 },
            );
            let b = DVector::from_fn(rows, |_, _| noise.next());
            let (mut r, mut c) = (a.clone(), b.clone());
            triangularise(r.as_mut_slice(), rows, c.as_mut_slice());
            let (mut within, mut d) = (a.clone(), b.clone());
            triangularise_within(within.as_mut_slice(), rows, |k| ends[k], d.as_mut_slice());
            let difference =
                within.rows(0, columns).upper_triangle() - r.rows(0, columns).upper_triangle();
            assert!(difference.amax() < 1e-14, "{ends:?}");
            assert!(
                (d.rows(0, columns) - c.rows(0, columns)).amax() < 1e-14,
                "{ends:?}"
            );
        }
    }

    /// The test requires R^T R = A^T A and R^T Q^T b = A^T b, up to the rounding error of products of `rows` terms.
    #[test]
    fn the_triangle_has_the_inner_products_of_the_matrix() {
        let mut noise = Noise::new(1);
        for (rows, columns) in [(1, 1), (3, 3), (7, 2), (82, 6), (200, 40)] {
            let a = DMatrix::from_fn(rows, columns, |_, _| noise.next());
            let b = DVector::from_fn(rows, |_, _| noise.next());
            let (mut r, mut c) = (a.clone(), b.clone());
            triangularise(r.as_mut_slice(), rows, c.as_mut_slice());
            let r = r.rows(0, columns).upper_triangle();
            let bound = 4.0 * (rows * columns) as f64 * f64::EPSILON;
            let inner = (r.transpose() * &r - a.transpose() * &a).amax();
            let outer = (r.transpose() * c.rows(0, columns) - a.transpose() * &b).amax();
            assert!(inner <= bound * a.norm_squared(), "{rows} x {columns}");
            assert!(outer <= bound * a.norm() * b.norm(), "{rows} x {columns}");
        }
    }

    #[test]
    fn a_square_system_is_solved() {
        let mut a = [2.0, 1.0, 1.0, 1.0, 3.0, 2.0, 1.0, 0.0, 1.0];
        let mut b = [7.0, 7.0, 8.0];
        let x = [1.0, 2.0, 3.0];
        triangularise(&mut a, 3, &mut b);
        back_substitute(&a, 3, &mut b);
        for (found, wanted) in b.iter().zip(x) {
            assert!((found - wanted).abs() < 100.0 * f64::EPSILON);
        }
    }

    #[test]
    fn zero_columns_give_zero_unknowns() {
        let mut a = [3.0, 4.0, 0.0, 0.0];
        let mut b = [3.0, 4.0];
        triangularise(&mut a, 2, &mut b);
        back_substitute(&a, 2, &mut b);
        assert!((b[0] - 1.0).abs() < 4.0 * f64::EPSILON);
        assert_eq!(b[1], 0.0);
    }
}
