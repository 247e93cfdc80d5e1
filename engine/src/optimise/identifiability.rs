//! Directions of change that alter the residuals at a solution, and directions that leave them unchanged.

use super::{Bounds, Linearisation};
use crate::sorting::sort_by;
use nalgebra::{DMatrix, DVector};

/// A direction in the space of the variables.
#[derive(Clone, Debug, PartialEq)]
pub struct Direction {
    /// Change of each variable in its own unit. The variable with the largest change relative to its range moves across the
    /// whole range, upwards.
    pub change: DVector<f64>,
    /// Change of the residuals (root mean square, in multiples of the tolerance) along `change`, to first order.
    pub effect: f64,
    /// Shares of `change`, forwards and backwards, up to which the design stays within the ranges and the misfit rises by at
    /// most [`Direction::RISE`]. 0 until `try_out` has run.
    pub free: [f64; 2],
}

impl Direction {
    /// Largest rise of the misfit, in multiples of the tolerance, that counts as no change.
    pub const RISE: f64 = 0.1;

    /// Computes `free` for moves along `change` from the point `x`. `misfit` is the misfit at `x`. `misfit_at` returns the
    /// misfit at another point. It returns `None` if that point has no misfit or violates a constraint.
    pub fn try_out(
        &mut self,
        x: &DVector<f64>,
        misfit: f64,
        bounds: &Bounds,
        mut misfit_at: impl FnMut(&DVector<f64>) -> Option<f64>,
    ) {
        for (free, sign) in self.free.iter_mut().zip([1.0, -1.0]) {
            // Reduces the move so that it stays within the ranges.
            let mut most: f64 = 1.0;
            for j in 0..x.len() {
                let change = sign * self.change[j];
                let room = match change {
                    change if change > 0.0 => (bounds.upper()[j] - x[j]) / change,
                    change if change < 0.0 => (bounds.lower()[j] - x[j]) / change,
                    _ => continue,
                };
                most = most.min(room.max(0.0));
            }
            let mut keeps = |share: f64| {
                let moved = bounds.nearest(&(x + &self.change * (sign * share)));
                misfit_at(&moved).is_some_and(|found| found <= misfit + Direction::RISE)
            };
            if keeps(most) {
                *free = most;
                continue;
            }
            let (mut low, mut high) = (0.0_f64, most);
            for _ in 0..10 {
                let middle = low.midpoint(high);
                if keeps(middle) {
                    low = middle
                } else {
                    high = middle
                }
            }
            *free = low;
        }
    }
}

/// Singular value decomposition of the Jacobian scaled by the ranges, and its interpretation.
#[derive(Clone, Debug, PartialEq)]
pub struct Identifiability {
    /// Singular values in falling order, one for each variable: change of the residuals (norm, in multiples of the tolerance)
    /// per fraction of the ranges.
    pub singular_values: Vec<f64>,
    /// Number of directions whose effect on the residuals is above `effect_below`, the limit given to
    /// [`Identifiability::new`].
    pub rank: usize,
    /// Basis of the directions without effect: combinations of variables that leave all targets unchanged. They also leave
    /// the rows given to [`Identifiability::keeping`] unchanged. In each direction, one variable moves across its whole
    /// range. Each direction contains a variable that does not occur in the other directions of the basis.
    pub unseen: Vec<Direction>,
}

impl Identifiability {
    /// Analyses the Jacobian at a point. A direction is unseen if a move along it across the whole range changes the
    /// residuals (root mean square, in multiples of the tolerance) by no more than `effect_below`.
    ///
    /// The analysis is exact for small moves. Active bounds are ignored.
    pub fn new(evaluation: &Linearisation, bounds: &Bounds, effect_below: f64) -> Self {
        let none = DMatrix::zeros(0, bounds.variables());
        Self::keeping(evaluation, &none, bounds, effect_below)
    }

    /// Analyses the Jacobian at a point like [`Identifiability::new`]. The unseen directions must also leave additional
    /// rows unchanged: each row changes by no more than `effect_below`. `kept` contains the derivatives of these rows.
    pub fn keeping(
        evaluation: &Linearisation,
        kept: &DMatrix<f64>,
        bounds: &Bounds,
        effect_below: f64,
    ) -> Self {
        let n = bounds.variables();
        let scaled = |of: &DMatrix<f64>| {
            let mut scaled = of.clone();
            for (mut column, &width) in scaled.column_iter_mut().zip(bounds.width()) {
                column *= width;
            }
            scaled
        };
        let (targets, kept) = (scaled(&evaluation.jacobian), scaled(kept));
        let root = (targets.nrows() as f64).sqrt();
        let effect = |direction: &DVector<f64>| (&targets * direction).norm() / root;
        let is_unseen = |direction: &DVector<f64>| {
            effect(direction) <= effect_below && (&kept * direction).norm() <= effect_below
        };
        let across_all = |vectors: DMatrix<f64>| {
            let columns = vectors.column_iter();
            columns.map(|column| across(column.into_owned())).collect()
        };
        let (singular_values, directions) = right_singular_vectors(&targets);
        let mut directions: Vec<DVector<f64>> = across_all(directions);
        let rank = directions
            .iter()
            .filter(|d| effect(d) > effect_below)
            .count();
        if kept.nrows() > 0 {
            let mut stacked = DMatrix::zeros(targets.nrows() + kept.nrows(), n);
            stacked.rows_mut(0, targets.nrows()).copy_from(&targets);
            let of_kept = &kept * root;
            stacked
                .rows_mut(targets.nrows(), kept.nrows())
                .copy_from(&of_kept);
            directions = across_all(right_singular_vectors(&stacked).1);
        }
        let unseen: Vec<DVector<f64>> = directions.into_iter().filter(is_unseen).collect();

        let mut basis = DMatrix::zeros(n, unseen.len());
        for (mut column, direction) in basis.column_iter_mut().zip(&unseen) {
            column.copy_from(direction);
        }
        separate(&mut basis);
        let unseen = basis
            .column_iter()
            .map(|column| across(column.into_owned()))
            .map(|direction| Direction {
                effect: effect(&direction),
                change: direction.component_mul(bounds.width()),
                free: [0.0; 2],
            })
            .collect();
        Identifiability {
            singular_values,
            rank,
            unseen,
        }
    }
}

/// Scales a direction so that its largest component is 1.
fn across(direction: DVector<f64>) -> DVector<f64> {
    let largest = direction[direction.iamax()];
    direction / largest
}

/// Singular values in falling order, and right singular vectors (columns) of `a`. The method rotates columns until all are
/// orthogonal (one-sided Jacobi: G. H. Golub, Ch. F. Van Loan, Matrix Computations, 4th ed., 8.6.3). It finds even small
/// singular values of badly scaled columns to high relative accuracy.
pub(super) fn right_singular_vectors(a: &DMatrix<f64>) -> (Vec<f64>, DMatrix<f64>) {
    let n = a.ncols();
    let mut columns = a.clone();
    let mut vectors = DMatrix::identity(n, n);
    let rounding = f64::EPSILON * (a.nrows() as f64).sqrt();
    // Convergence is quadratic after a few passes over all pairs of columns; the limit is never reached in practice.
    for _ in 0..60 {
        let mut rotated = false;
        for p in 0..n {
            for q in p + 1..n {
                let (pp, qq) = (
                    columns.column(p).norm_squared(),
                    columns.column(q).norm_squared(),
                );
                let pq = columns.column(p).dot(&columns.column(q));
                if pq.abs() <= rounding * (pp * qq).sqrt() {
                    continue;
                }
                rotated = true;
                let cotangent = (qq - pp) / (2.0 * pq);
                let tangent =
                    1.0_f64.copysign(cotangent) / (cotangent.abs() + cotangent.hypot(1.0));
                let cosine = 1.0 / tangent.hypot(1.0);
                for matrix in [&mut columns, &mut vectors] {
                    rotate(matrix, p, q, cosine, cosine * tangent);
                }
            }
        }
        if !rotated {
            break;
        }
    }
    let values: Vec<f64> = columns.column_iter().map(|column| column.norm()).collect();
    let mut order: Vec<usize> = (0..n).collect();
    sort_by(&mut order, |&i, &j| values[j].total_cmp(&values[i]));
    let sorted = order.iter().map(|&j| values[j]).collect();
    (sorted, vectors.select_columns(&order))
}

/// Rotates columns p and q of `matrix` by the angle with this cosine and sine.
fn rotate(matrix: &mut DMatrix<f64>, p: usize, q: usize, cosine: f64, sine: f64) {
    for row in 0..matrix.nrows() {
        let (x, y) = (matrix[(row, p)], matrix[(row, q)]);
        matrix[(row, p)] = cosine * x - sine * y;
        matrix[(row, q)] = sine * x + cosine * y;
    }
}

/// Combines the columns so that each column has a row in which all other columns are zero. The method is Gauss-Jordan
/// elimination with the largest entry as the pivot.
fn separate(basis: &mut DMatrix<f64>) {
    let columns = basis.ncols();
    for done in 0..columns {
        let (row, pivot) = basis.columns(done, columns - done).iamax_full();
        basis.swap_columns(done, done + pivot);
        let direction = basis.column(done) / basis[(row, done)];
        for other in (0..columns).filter(|&other| other != done) {
            let factor = basis[(row, other)];
            basis.column_mut(other).axpy(-factor, &direction, 1.0);
            basis[(row, other)] = 0.0;
        }
        basis.set_column(done, &direction);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimise::test_problems::Noise;

    fn analyse(jacobian: DMatrix<f64>, ranges: &[[f64; 2]]) -> Identifiability {
        let residuals = DVector::zeros(jacobian.nrows());
        let evaluation = Linearisation {
            residuals,
            jacobian,
        };
        Identifiability::new(&evaluation, &Bounds::new(ranges).unwrap(), 1e-3)
    }

    /// The third column is half the first column, minus the second column. The fourth column is zero.
    #[test]
    fn combinations_are_named() {
        let mut noise = Noise::new(3);
        let mut jacobian = DMatrix::from_fn(30, 4, |_, _| noise.next());
        let combined = 0.5 * jacobian.column(0) - jacobian.column(1);
        jacobian.set_column(2, &combined);
        jacobian.fill_column(3, 0.0);
        let found = analyse(jacobian, &[[-1.0, 1.0]; 4]);
        assert_eq!(found.rank, 2);
        assert_eq!(found.unseen.len(), 2);
        let alone = DVector::from_column_slice(&[0.0, 0.0, 0.0, 2.0]);
        let combined = DVector::from_column_slice(&[-1.0, 2.0, 2.0, 0.0]);
        for wanted in [alone, combined] {
            let near = |direction: &Direction| {
                let off = (&direction.change - &wanted).amax();
                off.min((&direction.change + &wanted).amax()) < 1e-12
            };
            assert!(found.unseen.iter().any(near), "{:?}", found.unseen);
        }
    }

    /// An additional row that must stay unchanged removes one unseen direction. The remaining unseen directions leave this
    /// row unchanged. The rank does not change, because it counts only effects on targets.
    #[test]
    fn unseen_directions_leave_kept_rows_unchanged() {
        let evaluation = Linearisation {
            residuals: DVector::zeros(6),
            jacobian: DMatrix::from_fn(6, 4, |_, j| if j == 0 { 1.0 } else { 0.0 }),
        };
        let bounds = Bounds::new(&[[-1.0, 1.0], [-2.0, 2.0], [-5.0, 5.0], [0.0, 1.0]]).unwrap();
        let kept = DMatrix::from_row_slice(1, 4, &[0.3, 1.0, -0.5, 0.0]);
        let found = Identifiability::keeping(&evaluation, &kept, &bounds, 1e-3);
        assert_eq!((found.rank, found.unseen.len()), (1, 2));
        for direction in &found.unseen {
            assert!((&kept * &direction.change)[0].abs() < 1e-12);
            assert!(direction.effect < 1e-12);
        }
        assert_eq!(
            Identifiability::new(&evaluation, &bounds, 1e-3)
                .unseen
                .len(),
            3
        );
    }

    #[test]
    fn singular_values_over_ten_decades_are_right() {
        let mut noise = Noise::new(4);
        let q = DMatrix::from_fn(50, 6, |_, _| noise.next()).qr().q();
        let v = DMatrix::from_fn(6, 6, |_, _| noise.next()).qr().q();
        let values = DVector::from_fn(6, |i, _| 100.0 * 10f64.powi(-2 * i as i32));
        let found = analyse(q * DMatrix::from_diagonal(&values) * v, &[[0.0, 1.0]; 6]);
        for (found, wanted) in found.singular_values.iter().zip(values.iter()) {
            assert!(
                (found - wanted).abs() < 100.0 * f64::EPSILON * 100.0,
                "{found} {wanted}"
            );
        }
    }

    /// A direction is free while the misfit rises by at most 0.1 and the variables stay in their ranges. The test covers
    /// directions without effect, and directions whose free share is known.
    #[test]
    fn directions_are_free_until_they_are_felt() {
        let bounds = Bounds::new(&[[-1.0, 3.0], [-2.0, 2.0]]).unwrap();
        let x = DVector::from_column_slice(&[0.0, 0.5]);
        let mut tried = Direction {
            change: DVector::from_column_slice(&[4.0, -1.0]),
            effect: 0.0,
            free: [0.0; 2],
        };
        // The first variable can move to x = 3 and x = -1.
        tried.try_out(&x, 2.0, &bounds, |_| Some(2.0 + Direction::RISE));
        assert_eq!(tried.free, [0.75, 0.25]);
        // The misfit rises by 1 per unit of the first variable, upwards only.
        tried.try_out(&x, 2.0, &bounds, |x| Some(2.0 + f64::max(x[0], 0.0)));
        assert!((tried.free[0] - 0.1 / 4.0).abs() < 1e-3, "{:?}", tried.free);
        assert!(tried.free[0] <= 0.1 / 4.0 && tried.free[1] == 0.25);
        // In the first case there is no misfit beyond x = 1. In the second case there is no misfit anywhere.
        tried.try_out(&x, 2.0, &bounds, |x| (x[0] < 1.0).then_some(2.0));
        assert!((tried.free[0] - 0.25).abs() < 1e-3 && tried.free[0] < 0.25);
        tried.free = [0.0; 2];
        tried.try_out(&x, 2.0, &bounds, |_| None);
        assert_eq!(tried.free, [0.0; 2]);
    }

    /// The size of a range matters: with the same Jacobian, variables with wide ranges have large effects, and variables with
    /// narrow ranges have almost none.
    #[test]
    fn effects_are_those_of_the_whole_range() {
        let jacobian = DMatrix::from_element(4, 1, 1.0);
        assert_eq!(analyse(jacobian.clone(), &[[0.0, 1.0]]).rank, 1);
        let small = analyse(jacobian, &[[0.0, 1e-4]]);
        assert_eq!(small.rank, 0);
        assert!((small.unseen[0].effect - 1e-4).abs() < 1e-18);
        assert!((small.unseen[0].change[0] - 1e-4).abs() < 1e-18);
    }
}
