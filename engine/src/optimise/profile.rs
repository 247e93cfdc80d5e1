//! Profile of a linear fit: the smallest sum of squares for each value of one variable, with the other variables within their
//! ranges.

use super::qr::{scale_columns, triangularise};
use super::{BoundedLeastSquares, Bounds, Linearisation};
use nalgebra::{DMatrix, DVector};

/// Largest number of trials in the search for one end of the interval.
const TRIALS: usize = 60;
/// Factor for the value at an end of the bracket that has not moved in two successive trials (Illinois method). It changes
/// the path, not the result.
const ILLINOIS: f64 = 0.5;
/// Damping of the bounded problems, relative to the largest column. The damping fixes the moves along directions that leave
/// all residuals unchanged.
const DAMPING: f64 = 1e-10;

/// Profile of a variable by equation (1) of module [`profile_interval`](super::profile_interval): smallest sum of squares
/// for each value of the variable. The residuals are linearised at a point.
pub(super) struct Profile<'a> {
    point: &'a DVector<f64>,
    bounds: &'a Bounds,
    variable: usize,
    others: Vec<usize>,
    /// Triangular factor of the columns of the Jacobian J that belong to the other variables, scaled by the ranges.
    triangle: DMatrix<f64>,
    /// The variable's column of J after the rotations that give `triangle`.
    column: DVector<f64>,
    /// Entry of the variable's column in the row after the rows of `triangle`.
    diagonal: f64,
    /// Residuals after the rotations that give `triangle`.
    offset: DVector<f64>,
    /// Residual in the row of `diagonal`.
    last: f64,
    /// Part of the sum of squares that no move of a variable changes.
    rest: f64,
    /// Distances from the point to the lower ends of the other variables' ranges, in fractions of the ranges.
    lower: Vec<f64>,
    /// Distances from the point to the upper ends of the other variables' ranges, in fractions of the ranges.
    upper: Vec<f64>,
    damping: f64,
}

impl<'a> Profile<'a> {
    pub(super) fn new(
        point: &'a DVector<f64>,
        at: &Linearisation,
        bounds: &'a Bounds,
        variable: usize,
    ) -> Self {
        let n = bounds.variables();
        let others: Vec<usize> = (0..n).filter(|j| *j != variable).collect();
        let order = [&others[..], &[variable]].concat();
        let widths: Vec<f64> = order.iter().map(|j| bounds.width()[*j]).collect();
        let rows = at.residuals.len().max(n);
        let mut matrix = Vec::new();
        let ordered = at.jacobian.select_columns(&order);
        scale_columns(&ordered, &widths, rows, &mut matrix);
        let mut vector = at.residuals.as_slice().to_vec();
        vector.resize(rows, 0.0);
        triangularise(&mut matrix, rows, &mut vector);
        let entry = |i: usize, j: usize| if i <= j { matrix[j * rows + i] } else { 0.0 };
        let fraction = |bound: &DVector<f64>| {
            let of = |j: &usize| (bound[*j] - point[*j]) / bounds.width()[*j];
            others.iter().map(of).collect()
        };
        let triangle = DMatrix::from_fn(n - 1, n - 1, entry);
        let largest = triangle.column_iter().map(|c| c.norm_squared());
        Profile {
            point,
            bounds,
            variable,
            column: DVector::from_fn(n - 1, |i, _| entry(i, n - 1)),
            diagonal: entry(n - 1, n - 1),
            offset: DVector::from_fn(n - 1, |i, _| vector[i]),
            last: vector[n - 1],
            rest: vector[n..].iter().map(|r| r * r).sum(),
            lower: fraction(bounds.lower()),
            upper: fraction(bounds.upper()),
            damping: DAMPING * DAMPING * largest.fold(f64::MIN_POSITIVE, f64::max),
            others,
            triangle,
        }
    }

    /// Minimum of |R v + offset|^2 over moves v of the other variables between two bounds, and the minimising move. R is
    /// `triangle`.
    fn least(&self, offset: &DVector<f64>, lower: &[f64], upper: &[f64]) -> (f64, DVector<f64>) {
        let n = self.others.len();
        if n == 0 {
            return (0.0, DVector::zeros(0));
        }
        let mut solver = BoundedLeastSquares::new(n, n);
        solver.reduce(&self.triangle, &DVector::repeat(n, 1.0), offset);
        solver.solve(self.damping, lower, upper);
        let moves = DVector::from_column_slice(solver.step());
        ((&self.triangle * &moves + offset).norm_squared(), moves)
    }

    /// Move of the variable from the point to this value, in fractions of its range.
    fn fraction(&self, value: f64) -> f64 {
        (value - self.point[self.variable]) / self.bounds.width()[self.variable]
    }

    /// Smallest sum of squares S_j(c) for the value c of the variable, and the moves of the other variables. See equation
    /// (1) of module [`profile_interval`](super::profile_interval).
    fn squares(&self, value: f64) -> (f64, DVector<f64>) {
        let own = self.fraction(value);
        let offset = &self.offset + &self.column * own;
        let (squares, moves) = self.least(&offset, &self.lower, &self.upper);
        let last = self.last + self.diagonal * own;
        (self.rest + last * last + squares, moves)
    }

    /// Root of the smallest |J (x - point)|^2 over points x of the box with this value of the variable. J is the Jacobian
    /// at `point`.
    pub(super) fn distance(&self, value: f64) -> f64 {
        let own = self.fraction(value);
        let (squares, _) = self.least(&(&self.column * own), &self.lower, &self.upper);
        (squares + (self.diagonal * own).powi(2)).sqrt()
    }

    /// Finds the value between `from` and `bound` at which the smallest sum of squares reaches `level`, and the point with
    /// this sum. `None` if the sum does not reach `level` at the bound, or already exceeds it at `from`. The search is the
    /// Illinois method (M. Dowell, P. Jarratt, A modified regula falsi method, BIT 11, 1971), on the root of the rise of the
    /// sum above its value at `from`.
    pub(super) fn end(&self, from: f64, bound: f64, level: f64) -> Option<(f64, DVector<f64>)> {
        let first = self.squares(from).0;
        if first > level || self.squares(bound).0 <= level {
            return None;
        }
        let height = (level - first).sqrt();
        let excess = |value: f64| {
            let (squares, moves) = self.squares(value);
            ((squares - first).max(0.0).sqrt() - height, moves)
        };
        let (mut inside, mut outside) = (from, bound);
        let (mut low, mut high) = (-height, excess(bound).0);
        let mut was_inside = None;
        for _ in 0..TRIALS {
            let slope = (outside - inside) / (high - low);
            let value = if high > low {
                outside - high * slope
            } else {
                inside
            };
            let (found, moves) = excess(value);
            let is_inside = found <= 0.0;
            let repeats = was_inside == Some(is_inside);
            if is_inside {
                (inside, low) = (value, found);
                high *= if repeats { ILLINOIS } else { 1.0 };
            } else {
                (outside, high) = (value, found);
                low *= if repeats { ILLINOIS } else { 1.0 };
            }
            was_inside = Some(is_inside);
            let is_close = (outside - inside).abs() <= 1e-9 * (outside - from).abs();
            if found.abs() <= 1e-9 * height || is_close {
                return Some((value, self.place(value, &moves)));
            }
        }
        let (_, moves) = excess(outside);
        Some((outside, self.place(outside, &moves)))
    }

    /// Point with the smallest sum of squares for a value of the variable.
    pub(super) fn point(&self, value: f64) -> DVector<f64> {
        self.place(value, &self.squares(value).1)
    }

    /// Point with this value of the variable, after these moves of the other variables.
    fn place(&self, value: f64, moves: &DVector<f64>) -> DVector<f64> {
        let mut x = self.point.clone();
        x[self.variable] = value;
        for (place, &j) in self.others.iter().enumerate() {
            x[j] += moves[place] * self.bounds.width()[j];
        }
        self.bounds.nearest(&x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the profile with the closed form for two variables. In the closed form, the other variable takes its best
    /// value within its range.
    #[test]
    fn profiles_are_the_closed_form() {
        let bounds = Bounds::new(&[[-2.0, 4.0], [0.0, 0.5]]).unwrap();
        let jacobian = DMatrix::from_row_slice(3, 2, &[1.0, 0.7, -0.2, 1.5, 0.4, 0.9]);
        let measured = DVector::from_column_slice(&[0.6, 0.3, 0.4]);
        let x = DVector::from_column_slice(&[0.3, 0.2]);
        let at = Linearisation {
            residuals: &jacobian * &x - &measured,
            jacobian: jacobian.clone(),
        };
        let squares = |held: usize, value: f64, from: &DVector<f64>| {
            let free = 1 - held;
            let rest = jacobian.column(held) * value - from;
            let column = jacobian.column(free);
            let best = -column.dot(&rest) / column.norm_squared();
            let best = best.clamp(bounds.lower()[free], bounds.upper()[free]);
            let mut place = DVector::from_element(2, value);
            place[free] = best;
            (((&jacobian * &place) - from).norm_squared(), place)
        };
        for variable in [0, 1] {
            let profile = Profile::new(&x, &at, &bounds, variable);
            let ends = [bounds.lower()[variable], bounds.upper()[variable]];
            for share in [0.0, 0.1, 0.35, 0.6, 1.0] {
                let value = ends[0] + share * (ends[1] - ends[0]);
                let (expected, place) = squares(variable, value, &measured);
                let (found, _) = profile.squares(value);
                assert!((found - expected).abs() < 1e-12, "{found} {expected}");
                assert!((profile.point(value) - place).norm() < 1e-8);
                let (apart, _) = squares(variable, value, &(&jacobian * &x));
                assert!((profile.distance(value) - apart.sqrt()).abs() < 1e-9);
            }
            let (from, first) = (x[variable], profile.squares(x[variable]).0);
            for bound in ends {
                let last = profile.squares(bound).0;
                assert!(last > first, "{variable} {bound}");
                for share in [0.01, 0.3, 0.7, 0.99] {
                    let level = first + share * (last - first);
                    let (end, _) = profile.end(from, bound, level).unwrap();
                    assert!((profile.squares(end).0 - level).abs() < 1e-7 * (last - first));
                    assert!((end - from) * (bound - from) > 0.0);
                }
                assert!(profile.end(from, bound, last * 1.01).is_none());
                assert!(profile.end(from, bound, first * 0.99).is_none());
            }
        }
    }
}
