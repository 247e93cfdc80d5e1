//! First level of a set-up: threaded adjusters (threads) give their static values exactly the target values, for any
//! shims. The parent module explains both levels.

use super::problem::Problem;
use super::{AdjustedSuspension, SetUpError};
use nalgebra::{DMatrix, DVector};

/// Largest number of steps of Newton's method.
const MOST_STEPS: usize = 40;
/// Ratio of an adjustment's effect on a value to the largest effect, below which the effect counts as zero. A combination of
/// adjustments with only such effects has no influence on any target value.
const FLAT: f64 = 1e-8;
/// Size of a step of the adjustments, relative to the suspension's size, at which the iteration ends.
const STILL: f64 = 1e-14;
/// Largest step of the adjustments, relative to the suspension's size, that counts as a rounding error. It counts as one only if
/// no fraction of the step reduces the errors of the values.
const ROUNDING: f64 = 1e-7;
/// Fraction of a step below which the solver does not halve further.
const SHORTEST: f64 = 1e-3;

/// Assignment of the values with targets: threaded adjusters meet some values exactly, shims minimise the errors of the
/// others.
#[derive(Clone, Debug)]
pub(super) struct Levels {
    /// Indices of the target values that the threaded adjusters meet exactly: the set S in the equations of module `set_up`.
    pub(super) exact: Vec<usize>,
    /// Indices of the target values whose errors the shims minimise: the set R in the equations of module `set_up`.
    pub(super) rest: Vec<usize>,
    /// Indices of the continuous adjustments, such as threaded adjusters, among all adjustments.
    pub(super) threads: Vec<usize>,
    /// Indices of the shims among all adjustments.
    pub(super) shims: Vec<usize>,
}

/// Finds independent rows of a matrix, by Gram-Schmidt with pivoting. Each step of equation (1) in module `set_up` takes the row
/// with the largest remainder.
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

/// Result of an iteration that changes adjustments until values meet their targets. Holds the last state.
pub(super) enum End<S = AdjustedSuspension> {
    /// The values meet their targets, or are as close to them as least squares allows.
    Settled(S),
    /// No step brings the values closer to their targets.
    Stuck(S),
}

/// Repeats steps until a step no longer changes the parts. `size` is the size of the suspension. `errors` returns the
/// weighted errors of a state, and `step` the next step from this state. `trial` returns the state after the displacement
/// `-step`, or after a fraction of it.
fn iterate<S>(
    mut state: S,
    size: f64,
    errors: impl Fn(&S) -> DVector<f64>,
    step: impl Fn(&S, &DVector<f64>) -> Option<DVector<f64>>,
    trial: impl Fn(&S, &DVector<f64>) -> Option<S>,
) -> End<S> {
    for _ in 0..MOST_STEPS {
        let before = errors(&state);
        let Some(step) = step(&state, &before) else {
            return End::Stuck(state);
        };
        if step.norm() <= STILL * size {
            return End::Settled(state);
        }
        let mut share = 1.0;
        let next = loop {
            if let Some(next) = trial(&state, &(&step * -share))
                && errors(&next).norm() <= before.norm()
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

impl Problem<'_> {
    /// Meets the targets of the given values with the given adjustments. If this is impossible, the error names the
    /// missed targets.
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

    /// Runs an iteration for the targets of some values. If the iteration misses them, it drops the target with the
    /// largest error and tries again, until it meets the remaining targets. The error then names the missed targets.
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
                    // A NaN error counts as the largest error.
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

    /// Runs Newton's method, equation (2) of module `set_up`. Each step is the shortest one that meets the targets of the
    /// linearised values. A step is halved if the parts cannot be assembled or the errors grow.
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

    /// Repeats steps in some of the adjustments until a step no longer changes the parts. `trial` returns the state for
    /// new amounts of the adjustments.
    pub(super) fn iterate(
        &self,
        state: AdjustedSuspension,
        aims: &[usize],
        adjustments: &[usize],
        step: impl Fn(&AdjustedSuspension, &DVector<f64>) -> Option<DVector<f64>>,
        trial: impl Fn(&[f64]) -> Option<AdjustedSuspension>,
    ) -> End {
        let errors = |state: &AdjustedSuspension| self.errors(state, aims);
        iterate(state, self.size(), errors, step, |state, displacement| {
            let mut amounts = state.amounts.clone();
            for (adjustment, change) in adjustments.iter().zip(displacement) {
                amounts[*adjustment] += change;
            }
            trial(&amounts)
        })
    }
}

/// Returns the least-squares step of smallest norm. `None` if an error or an effect is not finite.
pub(super) fn least_step(effects: DMatrix<f64>, errors: &DVector<f64>) -> Option<DVector<f64>> {
    if errors.iter().chain(effects.iter()).any(|v| !v.is_finite()) {
        return None;
    }
    let decomposed = effects.svd(true, true);
    let flat = FLAT * decomposed.singular_values.max();
    decomposed.solve(errors, flat).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;

    /// An adjustment counts as having an effect on a value with a target if the effect is above 1e-8 of the largest
    /// effect. The choice of the values for the threaded adjusters and the steps towards their targets use this
    /// threshold.
    #[test]
    fn effects_count_down_to_a_hundred_millionth() {
        let rows = |across: f64| DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 1.0, across]);
        assert_eq!(felt(rows(2e-8)).len(), 2);
        assert_eq!(felt(rows(5e-9)).len(), 1);
        let step = |effect: f64| {
            let effects = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, effect]));
            least_step(effects, &DVector::from_vec(vec![0.0, effect])).unwrap()
        };
        assert!((step(2e-8)[1] - 1.0).abs() < 1e-12);
        assert_eq!(step(5e-9)[1], 0.0);
    }

    /// The solver tries a full step, then halves it while the fraction is above a thousandth. It does not try a step below 1e-14
    /// of the suspension's size. If no fraction of a step reduces the errors, a step up to 1e-7 of the size counts as a rounding
    /// error. A longer step means that the solver is stuck.
    #[test]
    fn steps_are_halved_and_end_at_their_thresholds() {
        let size = 400.0;
        let ended = |length: f64| {
            let tried = RefCell::new(Vec::new());
            let step = |_: &(), _: &DVector<f64>| Some(DVector::from_element(1, length * size));
            let errors = |_: &()| DVector::from_element(1, 1.0);
            let end = iterate((), size, errors, step, |(), displacement| {
                tried.borrow_mut().push(-displacement[0] / (length * size));
                None
            });
            (matches!(end, End::Settled(())), tried.into_inner())
        };
        assert_eq!(ended(5e-15), (true, vec![]));
        let shares: Vec<f64> = (0..10).map(|k| 0.5f64.powi(k)).collect();
        for (length, is_settled) in [(2e-14, true), (5e-8, true), (2e-7, false), (1e-3, false)] {
            let (settled, tried) = ended(length);
            assert_eq!(settled, is_settled, "{length}");
            assert_eq!(tried.len(), shares.len(), "{length}");
            let mut pairs = tried.iter().zip(&shares);
            assert!(pairs.all(|(tried, share)| (tried / share - 1.0).abs() < 1e-15));
        }
    }

    /// Newton's method for x^3 = 8 ends at 2 from both sides. From 0.5, the full step would make the error larger. From
    /// 0.01, even the shortest fraction of the step would make it larger, so the iteration is stuck. If there is no
    /// step, the iteration ends at once.
    #[test]
    fn the_iteration_finds_a_root_by_shorter_steps() {
        let errors = |x: &f64| DVector::from_element(1, x.powi(3) - 8.0);
        let step = |x: &f64, errors: &DVector<f64>| Some(errors / (3.0 * x * x));
        let trial = |x: &f64, displacement: &DVector<f64>| Some(x + displacement[0]);
        for start in [0.5, 1.9, 50.0] {
            let End::Settled(root) = iterate(start, 1.0, errors, step, trial) else {
                panic!("no root from {start}");
            };
            assert!((root - 2.0).abs() < 1e-14, "{root}");
        }
        let far = iterate(1e-2, 1.0, errors, step, trial);
        assert!(matches!(far, End::Stuck(1e-2)));
        let missing = |_: &f64, _: &DVector<f64>| None;
        let end = iterate(1.0, 1.0, errors, missing, |_, _| None);
        assert!(matches!(end, End::Stuck(1.0)));
    }
}
