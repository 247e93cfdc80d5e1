//! Separates rows that variables can change from constant rows.
//!
//! A row without a slope does not restrict steps. If it is satisfied, every step keeps it satisfied; if it is violated, no
//! step can reduce the violation. The computed gradient of such a row is not zero but a rounding error. A quadratic program
//! that uses this gradient divides by a rounding error. A row is *constant* at a point if a move of all variables across
//! their ranges changes it, to first order, by no more than its rounding:
//!
//! ```text
//! sum_j |a_j| width_j <= max(1e-9, 256 e (|value| + 2 |limit|)),     e: the machine precision            (1)
//! ```
//!
//! Rows are in visible units, 1 mm or 1 degree. Some hundreds of operations compute them from coordinates of up to ten
//! thousand units, so their rounding error is about 1e-9. This is a hundredth of the largest violation that still counts as
//! satisfied. The second term is the rounding error of larger values.
//!
//! A row that is constant at the start may change elsewhere. So every evaluation examines the row again, even if the step
//! is then refused. The row is used from the first evaluation at which it has a slope, or at which its value differs by
//! more than (1). The violation of a run counts only the rows in use. The caller reports violated rows that were never
//! used.

use super::super::{Bounds, Linearisation};

/// First term of equation (1) of this module: rounding error of a constraint's row, in the unit of the row.
const ROUNDING: f64 = 1e-9;
/// Factor of the second term of equation (1) of this module: rounding error of a row, relative to its value.
const RELATIVE_ROUNDING: f64 = 256.0 * f64::EPSILON;

/// Rows that are used in a run.
#[derive(Clone, Debug)]
pub(super) struct Movable {
    /// Rounding error of each row by equation (1) of this module.
    rounding: Vec<f64>,
    takes_part: Vec<bool>,
    /// Values of the rows at the start.
    first: Vec<f64>,
    standing: usize,
}

impl Movable {
    /// Examines the rows at the start of a run. `limits` are the limits of the rows.
    pub(super) fn new(limits: &[f64], start: &Linearisation, bounds: &Bounds) -> Self {
        let values = start.residuals.iter().zip(limits);
        let rounding = values.map(|(value, limit)| {
            ROUNDING.max(RELATIVE_ROUNDING * (value.abs() + 2.0 * limit.abs()))
        });
        let mut movable = Movable {
            rounding: rounding.collect(),
            takes_part: vec![false; limits.len()],
            first: start.residuals.as_slice().to_vec(),
            standing: limits.len(),
        };
        movable.look(start, bounds);
        movable
    }

    /// Examines the rows at another point. Returns true if more rows are in use than before.
    pub(super) fn look(&mut self, at: &Linearisation, bounds: &Bounds) -> bool {
        if self.standing == 0 {
            return false;
        }
        let before = self.standing;
        for row in 0..self.takes_part.len() {
            if self.takes_part[row] {
                continue;
            }
            let changed = (at.residuals[row] - self.first[row]).abs() > self.rounding[row];
            if changed || self.moves_at(row, at, bounds) {
                self.takes_part[row] = true;
                self.standing -= 1;
            }
        }
        self.standing < before
    }

    /// Returns true if a row is in use.
    pub(super) fn takes_part(&self, row: usize) -> bool {
        self.takes_part[row]
    }

    /// Returns true if some variable changes a row at a point.
    pub(super) fn moves_at(&self, row: usize, at: &Linearisation, bounds: &Bounds) -> bool {
        let slopes = at.jacobian.row(row);
        let slopes = slopes.iter().zip(bounds.width().iter());
        slopes.map(|(a, width)| (a * width).abs()).sum::<f64>() > self.rounding[row]
    }

    /// Returns a flag for each row: true if it is in use.
    pub(super) fn into_taking_part(self) -> Vec<bool> {
        self.takes_part
    }
}
