//! Second level of a set-up: whole shims minimise the errors of the values that threaded adjusters cannot bring to
//! their targets.

use super::levels::{End, Levels, least_step};
use super::problem::Problem;
use super::{AdjustedSuspension, MET, SetUpError};
use crate::sorting::sort_by;
use nalgebra::{DMatrix, DVector};

/// Largest number of shims for which the program tries both neighbouring whole numbers: 2^10 combinations. For further
/// shims it takes the nearest whole number.
const MOST_ENUMERATED: usize = 10;
/// Largest number of combinations of whole shims that are assembled, besides the combination nearest to the unrounded optimum.
const MOST_ASSEMBLED: usize = 8;
/// Difference of two weighted errors below which they count as equal: 0.005 degrees or 0.05 mm. The printed instructions use
/// the same threshold for effects.
const INVISIBLE: f64 = 0.05;
/// Distance from a whole number of steps within which an amount of shims counts as whole.
const WHOLE: f64 = 1e-9;

impl Problem<'_> {
    /// Returns the state that meets the target values best, and the assignment of these values to threaded adjusters
    /// and shims.
    pub(super) fn solve(
        &self,
        drawn: &AdjustedSuspension,
    ) -> Result<(AdjustedSuspension, Levels), SetUpError> {
        let levels = self.levels(drawn);
        let real = if levels.rest.is_empty() {
            let all: Vec<usize> = (0..self.increments.len()).collect();
            self.meet(drawn.clone(), &levels.exact, &all)?
        } else {
            let met = self.meet(drawn.clone(), &levels.exact, &levels.threads)?;
            self.serve(met, &levels)?
        };
        if levels.shims.is_empty() {
            return Ok((real, levels));
        }
        let whole = self.whole(&real, &levels)?;
        Ok((whole, levels))
    }

    /// Returns the weighted effects of shims on the values in `R`, while the threaded adjusters keep the other values at their
    /// targets: `G` in equation (4) of module `set_up`.
    pub(super) fn reduced_effects(
        &self,
        levels: &Levels,
        state: &AdjustedSuspension,
    ) -> DMatrix<f64> {
        let own = self.effects(state, &levels.rest, &levels.shims);
        if levels.exact.is_empty() || levels.threads.is_empty() {
            return own;
        }
        let by_threads = self.effects(state, &levels.exact, &levels.threads);
        let by_shims = self.effects(state, &levels.exact, &levels.shims);
        let others = self.effects(state, &levels.rest, &levels.threads);
        let columns = by_shims.column_iter();
        let answers: Option<Vec<_>> = columns
            .map(|column| least_step(by_threads.clone(), &column.clone_owned()))
            .collect();
        match answers {
            Some(answers) if !answers.is_empty() => own - others * DMatrix::from_columns(&answers),
            _ => own,
        }
    }

    /// Finds the best shims of any thickness by the Gauss-Newton method, equation (5) of module `set_up`. In every trial, the
    /// threaded adjusters bring their values to the targets.
    fn serve(
        &self,
        state: AdjustedSuspension,
        levels: &Levels,
    ) -> Result<AdjustedSuspension, SetUpError> {
        if levels.shims.is_empty() {
            return Ok(state);
        }
        self.settle(state, &levels.rest, |state, aims| {
            let mut levels = levels.clone();
            levels.rest = aims.to_vec();
            let step = |state: &AdjustedSuspension, errors: &DVector<f64>| {
                least_step(self.reduced_effects(&levels, state), errors)
            };
            let trial = |amounts: &[f64]| match self.with_threads(amounts, &levels) {
                Ok(End::Settled(state)) => Some(state),
                Ok(End::Stuck(_)) | Err(_) => None,
            };
            self.iterate(state, aims, &levels.shims, step, trial)
        })
    }

    /// Returns the state with these shims after the threaded adjusters have brought their values to the targets: `X(z)` in
    /// equation (2) of module `set_up`.
    fn with_threads(&self, amounts: &[f64], levels: &Levels) -> Result<End, SetUpError> {
        Ok(self.newton(self.state(amounts)?, &levels.exact, &levels.threads))
    }

    /// Returns the best state with whole shims near a state whose shims have any thickness.
    fn whole(
        &self,
        real: &AdjustedSuspension,
        levels: &Levels,
    ) -> Result<AdjustedSuspension, SetUpError> {
        let mut settled: Vec<(bool, f64, f64, AdjustedSuspension)> = Vec::new();
        let mut refused = None;
        for amounts in self.neighbours(real, levels) {
            let state = match self.with_threads(&amounts, levels) {
                Ok(End::Settled(state)) => state,
                Ok(End::Stuck(state)) => {
                    refused.get_or_insert(self.out_of_reach(&state, &levels.exact));
                    continue;
                }
                Err(reason) => {
                    refused.get_or_insert(reason);
                    continue;
                }
            };
            let allowed = self.half_steps(levels, &state);
            let is_beyond = levels.rest.iter().any(|i| {
                let aim = self.aims[*i].value().unwrap_or(f64::NAN);
                let is_near = (state.values[*i] - aim).abs() <= MET + allowed[*i];
                // A NaN value counts as beyond its allowed error.
                !is_near
            });
            let errors = self.errors(&state, &levels.rest).norm();
            let changed: f64 = state.amounts.iter().map(|a| a * a).sum();
            settled.push((is_beyond, errors, changed, state));
        }
        let least = settled
            .iter()
            .map(|(beyond, errors, ..)| (*beyond, *errors));
        let least = least.min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        // Two states count as equally good if the difference of their errors is too small to measure. Among these states, the
        // one with the smallest adjustment is the best.
        let as_good = settled.into_iter().filter(|(beyond, errors, ..)| {
            least.is_some_and(|least| *beyond == least.0 && *errors <= least.1 + INVISIBLE)
        });
        let best = as_good.min_by(|a, b| a.2.total_cmp(&b.2).then(a.1.total_cmp(&b.1)));
        match (best, refused) {
            (Some((.., state)), _) => Ok(state),
            (None, Some(reason)) => Err(reason),
            (None, None) => Err(SetUpError::Unsettled),
        }
    }

    /// Returns combinations of whole shims near the amounts of a state. They are the combinations with the smallest estimated
    /// errors, and the nearest combination. The estimate is the linear model, equation (6) of module `set_up`.
    pub(super) fn neighbours(&self, real: &AdjustedSuspension, levels: &Levels) -> Vec<Vec<f64>> {
        let mut nearest = real.amounts.clone();
        let mut open = Vec::new();
        let by = self.reduced_effects(levels, real);
        for (column, (k, step)) in self.shims().enumerate() {
            let steps = real.amounts[k] / step;
            nearest[k] = steps.round() * step;
            if (steps - steps.round()).abs() > WHOLE {
                open.push((column, k, step, steps));
            }
        }
        // If `R` is empty, there is no error to minimise. If the amount of every shim is already whole, there is no
        // choice. In both cases the nearest whole amounts are the result.
        if levels.rest.is_empty() || open.is_empty() {
            return vec![nearest];
        }
        // The shims whose step has the largest effect come first.
        let effect =
            |(column, _, step, _): &(usize, usize, f64, f64)| by.column(*column).norm() * step;
        sort_by(&mut open, |a, b| effect(b).total_cmp(&effect(a)));
        open.truncate(MOST_ENUMERATED);
        let errors = self.errors(real, &levels.rest);
        let mut ranked: Vec<(f64, f64, Vec<f64>)> = (0..1usize << open.len())
            .map(|choice| {
                let mut amounts = nearest.clone();
                for (bit, (_, k, step, steps)) in open.iter().enumerate() {
                    let up = f64::from(u8::from(choice >> bit & 1 == 1));
                    amounts[*k] = (steps.floor() + up) * step;
                }
                let (mut left, mut distance) = (errors.clone(), 0.0);
                for (column, (k, step)) in self.shims().enumerate() {
                    let off = amounts[k] - real.amounts[k];
                    left += by.column(column) * off;
                    distance += (off / step).powi(2);
                }
                (left.norm_squared(), distance, amounts)
            })
            .collect();
        sort_by(&mut ranked, |a, b| {
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        ranked.truncate(MOST_ASSEMBLED);
        let mut neighbours: Vec<Vec<f64>> =
            ranked.into_iter().map(|(.., amounts)| amounts).collect();
        if !neighbours.contains(&nearest) {
            neighbours.push(nearest);
        }
        neighbours
    }
}
