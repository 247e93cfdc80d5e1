//! Curvature that the linear models of residuals and rows do not contain. It is estimated from the steps.

use super::super::qr::dot;

/// Factor for the curvature that is added along the normals of the held rows if the quadratic program uses the estimate S
/// of [`Curvature`]. The factor multiplies the largest diagonal entry of R^T R + S, with the triangle R of the objective.
const ACROSS: f64 = 4.0;
/// Largest number of shifts tried to make a matrix positive definite. Each shift is ten times the previous shift.
const SHIFTS: usize = 40;

/// Symmetric rank-one estimate S of the curvature that the linear models of residuals and rows do not contain.
pub(super) struct Curvature {
    variables: usize,
    /// Matrix S, column after column.
    matrix: Vec<f64>,
    /// True if S is in use.
    in_use: bool,
}

impl Curvature {
    pub(super) fn new(variables: usize) -> Self {
        Curvature {
            variables,
            matrix: vec![0.0; variables * variables],
            in_use: false,
        }
    }

    fn image(&self, d: &[f64]) -> Vec<f64> {
        let rows = self.matrix.chunks_exact(self.variables);
        rows.map(|row| dot(row, d)).collect()
    }

    /// Returns d . S d. Returns zero if S is not in use.
    pub(super) fn quadratic(&self, d: &[f64]) -> f64 {
        if self.in_use {
            dot(&self.image(d), d)
        } else {
            0.0
        }
    }

    /// Changes S by a matrix of rank one, so that S d = y. d is the last step. y is the part of the gradient's change over
    /// this step that the linear models do not predict. Leaves S unchanged if the change of S would be very large, or not
    /// finite.
    pub(super) fn learn(&mut self, d: &[f64], y: &[f64]) {
        let n = self.variables;
        let image = self.image(d);
        let off: Vec<f64> = y.iter().zip(&image).map(|(y, s)| y - s).collect();
        let along = dot(&off, d);
        let size = (dot(&off, &off) * dot(d, d)).sqrt();
        // The comparison of the absolute value is false for NaN, so NaN is rejected, too.
        let is_sound = along.is_finite() && along.abs() > 1e-8 * size;
        if !is_sound {
            return;
        }
        for j in 0..n {
            for i in 0..n {
                self.matrix[j * n + i] += off[i] * off[j] / along;
            }
        }
    }

    /// Replaces the triangle R (`triangle`) by the factor of R^T R + S, with the estimate S of the curvature. A shift of the
    /// diagonal makes this sum positive definite. Replaces q (`offset`) so that the slope R^T q of the objective |R d + q|^2 / 2
    /// stays the same.
    ///
    /// At a minimum under constraints, R^T R + S must be positive only for steps that keep the held rows unchanged. For all
    /// other steps, the function adds the square of each held row a.d + c with a weight w: w (a.d + c)^2 / 2. This square
    /// is zero where the row is held, so the multiplier of the row does not change. A shift of the diagonal alone would
    /// shorten steps in every direction.
    pub(super) fn add_to(
        &mut self,
        held: &[(Vec<f64>, f64)],
        triangle: &mut [f64],
        offset: &mut [f64],
    ) {
        let n = self.variables;
        self.in_use = true;
        let columns: Vec<&[f64]> = triangle.chunks_exact(n).collect();
        let mut slope: Vec<f64> = columns.iter().map(|column| dot(column, offset)).collect();
        let mut square = vec![0.0; n * n];
        for j in 0..n {
            for i in 0..n {
                square[j * n + i] = dot(columns[i], columns[j]) + self.matrix[j * n + i];
            }
        }
        let trace = (0..n).fold(0.0, |most: f64, k| most.max(square[k * n + k].abs()));
        for (normal, c) in held {
            let square_of_normal = dot(normal, normal);
            if square_of_normal < f64::MIN_POSITIVE {
                continue;
            }
            let weight = ACROSS * trace / square_of_normal;
            for j in 0..n {
                slope[j] += weight * c * normal[j];
                for i in 0..n {
                    square[j * n + i] += weight * normal[i] * normal[j];
                }
            }
        }
        let mut shift = 1e-13 * trace.max(f64::MIN_POSITIVE);
        let mut shifts = std::iter::repeat_with(|| {
            let by = shift;
            shift *= 10.0;
            by
        });
        let mut shifts = shifts.by_ref().take(SHIFTS);
        // If the matrix contains NaN, no shift makes the matrix positive definite. The curvature is then left out.
        let Some(factor) = shifts.find_map(|by| cholesky(&square, n, by)) else {
            self.in_use = false;
            return;
        };
        triangle.copy_from_slice(&factor);
        // Solves R^T q = slope.
        for k in 0..n {
            let column = &factor[k * n..];
            offset[k] = (slope[k] - dot(&column[..k], &offset[..k])) / column[k];
        }
    }
}

/// Factor R with R^T R = `square` + `shift` times the unit matrix, column after column. `None` if this sum is not positive
/// definite.
fn cholesky(square: &[f64], n: usize, shift: f64) -> Option<Vec<f64>> {
    let mut factor = vec![0.0; n * n];
    for j in 0..n {
        for i in 0..=j {
            let (before, column) = factor.split_at(j * n);
            let other = if i < j { &before[i * n..] } else { column };
            let sum = square[j * n + i] - dot(&other[..i], &column[..i]);
            factor[j * n + i] = if i < j {
                sum / factor[i * n + i]
            } else {
                let pivot = sum + shift;
                if pivot.is_nan() || pivot <= 0.1 * shift {
                    return None;
                }
                pivot.sqrt()
            };
        }
    }
    Some(factor)
}
