//! First level of a set-up: threads reach their target values exactly, whatever the shims are.

use super::problem::Problem;
use super::{AdjustedSuspension, SetUpError};
use nalgebra::{DMatrix, DVector};

/// Largest number of steps of Newton's method.
const MOST_STEPS: usize = 40;
/// Share of the largest effect below which effects count as zero. No aim depends on such directions.
const FLAT: f64 = 1e-8;
/// Size of steps, as a share of the suspension's size, that do not change the parts.
const STILL: f64 = 1e-14;
/// Size of steps without improvement that count as rounding.
const ROUNDING: f64 = 1e-7;
/// Smallest part of a step that is tried.
const SHORTEST: f64 = 1e-3;

/// Assignment of aims to threads and shims.
#[derive(Clone, Debug)]
pub(super) struct Levels {
    /// Indices of values that threads meet exactly: `S`.
    pub(super) exact: Vec<usize>,
    /// Indices of values that shims serve: `R`.
    pub(super) rest: Vec<usize>,
    /// Indices of the continuous adjustments.
    pub(super) threads: Vec<usize>,
    /// Indices of the shims.
    pub(super) shims: Vec<usize>,
}

/// Finds independent rows of a matrix, by Gram-Schmidt with pivoting. Each time it takes the row with the largest remainder,
/// equation (1).
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

/// Result of an iteration.
pub(super) enum End {
    /// The values meet their aims, or are as close as least squares can bring them.
    Settled(AdjustedSuspension),
    /// No step brings the values closer to their aims.
    Stuck(AdjustedSuspension),
}

impl Problem<'_> {
    /// Meets the given aims with the given adjustments, or names the aims that are out of reach.
    pub(super) fn meet(
        &self,
        state: AdjustedSuspension,
        aims: &[usize],
        adjustments: &[usize],
    ) -> Result<AdjustedSuspension, SetUpError> {
        self.settle(state, aims, |state, aims| {
            self.newton(state, aims, adjustments)
        })
    }

    /// Runs an iteration for some aims. If it does not meet them, leaves out the aim with the largest error and tries
    /// again, until it meets the others. The error then names the missed aims.
    pub(super) fn settle(
        &self,
        state: AdjustedSuspension,
        aims: &[usize],
        iteration: impl Fn(AdjustedSuspension, &[usize]) -> End,
    ) -> Result<AdjustedSuspension, SetUpError> {
        let mut left = aims.to_vec();
        let mut ended = iteration(state, &left);
        loop {
            match ended {
                End::Settled(state) if left.len() == aims.len() => return Ok(state),
                End::Settled(state) => return Err(self.out_of_reach(&state, aims)),
                End::Stuck(state) => {
                    let errors = self.errors(&state, &left);
                    // An error without a value counts as the largest.
                    let sizes = errors
                        .iter()
                        .map(|e| if e.is_nan() { f64::INFINITY } else { e.abs() });
                    let worst = sizes.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
                    match worst {
                        Some((worst, _)) if left.len() > 1 => drop(left.remove(worst)),
                        _ => return Err(self.out_of_reach(&state, aims)),
                    }
                    ended = iteration(state, &left);
                }
            }
        }
    }

    /// Runs Newton's method (2) with the smallest steps that meet the aims. It halves a step if the parts cannot be
    /// assembled or the errors grow.
    pub(super) fn newton(
        &self,
        state: AdjustedSuspension,
        aims: &[usize],
        adjustments: &[usize],
    ) -> End {
        if aims.is_empty() || adjustments.is_empty() {
            return End::Settled(state);
        }
        let step = |state: &AdjustedSuspension, errors: &DVector<f64>| {
            least_step(self.effects(state, aims, adjustments), errors)
        };
        self.iterate(state, aims, adjustments, step, |amounts| {
            self.state(amounts).ok()
        })
    }

    /// Takes steps of some adjustments until they no longer change the parts. `trial` gives the state for changed amounts.
    pub(super) fn iterate(
        &self,
        mut state: AdjustedSuspension,
        aims: &[usize],
        adjustments: &[usize],
        step: impl Fn(&AdjustedSuspension, &DVector<f64>) -> Option<DVector<f64>>,
        trial: impl Fn(&[f64]) -> Option<AdjustedSuspension>,
    ) -> End {
        let size = self.size();
        for _ in 0..MOST_STEPS {
            let errors = self.errors(&state, aims);
            let Some(step) = step(&state, &errors) else {
                return End::Stuck(state);
            };
            if step.norm() <= STILL * size {
                return End::Settled(state);
            }
            let mut share = 1.0;
            let next = loop {
                let mut amounts = state.amounts.clone();
                for (k, adjustment) in adjustments.iter().enumerate() {
                    amounts[*adjustment] -= share * step[k];
                }
                if let Some(next) = trial(&amounts)
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
                None if step.norm() <= ROUNDING * size => return End::Settled(state),
                None => return End::Stuck(state),
            }
        }
        End::Stuck(state)
    }
}

/// Least-squares step of smallest norm. `None` if an error or an effect has no value.
pub(super) fn least_step(effects: DMatrix<f64>, errors: &DVector<f64>) -> Option<DVector<f64>> {
    if errors.iter().chain(effects.iter()).any(|v| !v.is_finite()) {
        return None;
    }
    let decomposed = effects.svd(true, true);
    let flat = FLAT * decomposed.singular_values.max();
    decomposed.solve(errors, flat).ok()
}
