//! The first level: threads meet their aims exactly, whatever the shims are.

use super::problem::Problem;
use super::{AdjustedSuspension, NoSetUp};
use nalgebra::{DMatrix, DVector};

/// The most steps of Newton's method.
pub(super) const MOST_STEPS: usize = 40;
/// Effects below this part of the largest are directions that no aim feels.
pub(super) const FLAT: f64 = 1e-8;
/// Steps up to this, in parts of the size, do not change the parts.
pub(super) const STILL: f64 = 1e-14;
/// Steps up to this that make nothing better are rounding.
pub(super) const ROUNDING: f64 = 1e-7;
/// The smallest part of a step that is tried.
pub(super) const SHORTEST: f64 = 1e-3;

/// Who meets which aim.
#[derive(Clone, Debug)]
pub(super) struct Levels {
    /// Values that threads meet exactly: `S`.
    pub(super) exact: Vec<usize>,
    /// Values that shims serve: `R`.
    pub(super) rest: Vec<usize>,
    /// Numbers of the continuous adjustments.
    pub(super) threads: Vec<usize>,
    /// Numbers of the shims.
    pub(super) shims: Vec<usize>,
}

/// Rows of a matrix that are independent, by Gram-Schmidt with pivoting: each time the row of which most is left, equation (1).
pub(super) fn felt(mut rows: DMatrix<f64>) -> Vec<usize> {
    let mut taken = Vec::new();
    let mut largest = 0.0;
    while taken.len() < rows.ncols() {
        let norms = rows.row_iter().map(|row| row.norm()).enumerate();
        let left = norms.filter(|(i, norm)| !taken.contains(i) && norm.is_finite());
        let Some((pivot, norm)) = left.max_by(|a, b| a.1.total_cmp(&b.1)) else {
            break;
        };
        largest = f64::max(largest, norm);
        if norm <= FLAT * largest {
            break;
        }
        let direction = rows.row(pivot) / norm;
        for i in 0..rows.nrows() {
            let along = rows.row(i).dot(&direction);
            let mut row = rows.row_mut(i);
            row -= &direction * along;
        }
        taken.push(pivot);
    }
    taken
}

impl Problem<'_> {
    /// Meets some aims by some adjustments, the smallest of those that do: Newton's method (2), halved where the parts do not go
    /// together or the errors grow.
    pub(super) fn meet(
        &self,
        mut state: AdjustedSuspension,
        aims: &[usize],
        adjustments: &[usize],
    ) -> Result<AdjustedSuspension, NoSetUp> {
        if aims.is_empty() || adjustments.is_empty() {
            return Ok(state);
        }
        let size = self.assembler.suspension().size();
        for _ in 0..MOST_STEPS {
            let errors = self.errors(&state, aims);
            let effects = self.effects(&state, aims, adjustments);
            let Some(step) = least_step(effects, &errors) else {
                return Err(self.out_of_reach(&state, aims));
            };
            if step.norm() <= STILL * size {
                return Ok(state);
            }
            let mut share = 1.0;
            let next = loop {
                let mut amounts = state.amounts.clone();
                for (k, adjustment) in adjustments.iter().enumerate() {
                    amounts[*adjustment] -= share * step[k];
                }
                if let Ok(next) = self.state(&amounts)
                    && self.errors(&next, aims).norm() <= errors.norm()
                {
                    break Some(next);
                }
                share *= 0.5;
                if share < SHORTEST {
                    break None;
                }
            };
            match next {
                Some(next) => state = next,
                None if step.norm() <= ROUNDING * size => return Ok(state),
                None => break,
            }
        }
        Err(self.out_of_reach(&state, aims))
    }
}

/// The least-squares step of smallest norm; `None` if an error or an effect has no value.
pub(super) fn least_step(effects: DMatrix<f64>, errors: &DVector<f64>) -> Option<DVector<f64>> {
    if errors.iter().chain(effects.iter()).any(|v| !v.is_finite()) {
        return None;
    }
    let decomposed = effects.svd(true, true);
    let flat = FLAT * decomposed.singular_values.max();
    decomposed.solve(errors, flat).ok()
}
