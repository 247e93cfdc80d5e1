//! Bounds of variables that hold the misfit up, and the targets that they keep from their goals.
//!
//! Let F be half the sum of the squared residuals r, and let x be a minimum of F between the bounds. Variable j stops at a bound
//! with the outward direction s (1 for an upper bound, -1 for a lower bound). If the bound moves outwards by b, the smallest F
//! changes at first by
//!
//! ```text
//! dF/db = s (J_j^T r + sum_i m_i a_ij)      m_i, a_i: multipliers and gradients of the binding constraints        (1)
//! ```
//!
//! (1) is exact, because F is stationary with respect to all other variables. These variables follow the bound. Their first-order
//! moves y minimise the change of the residuals and keep the binding constraints:
//!
//! ```text
//! |s J_j + J y| = min,   s a_ij + a_i y = 0                                                                        (2)
//! ```
//!
//! The change s J_j + J y of the residuals divides (1) among the targets.

use super::{
    ActiveBound, Assessment, BoundedLeastSquares, Bounds, Constrained, Fit, Linearisation,
    Termination,
};
use crate::number::larger;
use nalgebra::{DMatrix, DVector};

/// A bound holds the misfit, or a target, only if a move of the bound by the whole range would lower it by more than this share,
/// to first order.
const HOLDS: f64 = 0.01;
/// Weight of the constraints in (2), relative to the residuals.
const CONSTRAINTS_FIRST: f64 = 1e5;
/// Root mean square change of the residuals by a move across the whole range, below which a variable does not follow a bound in
/// (2). The limit keeps variables without effect in place.
const FOLLOWS: f64 = 0.01;

/// A bound of a variable that keeps the misfit from falling further.
#[derive(Clone, Debug, PartialEq)]
pub struct HoldingBound {
    /// Index of the variable.
    pub variable: usize,
    /// True for the upper bound of the variable.
    pub is_upper: bool,
    /// Reduction of the misfit per unit of the variable by which the bound moves outwards.
    pub price: f64,
    /// Targets that the bound keeps from their goals. For each target: its index, and the reduction of its root mean square
    /// deviation per unit by which the bound moves outwards, as a share of this deviation.
    pub targets: Vec<(usize, f64)>,
}

/// Minimum of the misfit, with the binding constraints.
pub(crate) struct Minimum<'a> {
    /// Values of the variables.
    pub x: &'a DVector<f64>,
    /// Residuals of the targets.
    pub goal: &'a Linearisation,
    /// Gradients of the constraints' rows. It has no rows without constraints.
    pub rows: &'a DMatrix<f64>,
    /// Multipliers of the rows: derivative of F with respect to each row's limit, negated.
    pub multipliers: &'a [f64],
    /// Ranges of the variables.
    pub bounds: &'a Bounds,
    /// Index of the target of each residual.
    pub of_rows: &'a [usize],
}

impl Minimum<'_> {
    /// Finds the bounds that hold the misfit of a fit. `None` if the fit did not end at a minimum of the misfit, or near one.
    pub(crate) fn of(
        fit: &Fit,
        of_rows: &[usize],
        bounds: &Bounds,
        problem: &mut impl Constrained,
    ) -> Option<Vec<HoldingBound>> {
        let x = fit.minimum()?;
        let multipliers = match &fit.constraints {
            Some(state) => state.multipliers.as_deref()?,
            None => &[],
        };
        let mut at = Assessment::new(&problem.shape());
        problem.assess(x, &mut at).ok()?;
        let minimum = Minimum {
            x,
            goal: &at.goal,
            rows: &at.rows.jacobian,
            multipliers,
            bounds,
            of_rows,
        };
        Some(minimum.holding_bounds())
    }

    /// Finds the bounds that hold the misfit, the most effective first. Effects are compared for moves by the same share of the
    /// ranges.
    pub(super) fn holding_bounds(&self) -> Vec<HoldingBound> {
        let active = self.bounds.active_bounds(self.x);
        let free = |j: &usize| active[*j] == ActiveBound::Free;
        let free: Vec<usize> = (0..active.len()).filter(free).collect();
        let misfit = self.goal.misfit();
        let count = self.goal.residuals.len() as f64;
        let sides = active.iter().enumerate().filter_map(|(j, side)| {
            let is_upper = match side {
                ActiveBound::Free => return None,
                ActiveBound::Lower => false,
                ActiveBound::Upper => true,
            };
            let outward = if is_upper { 1.0 } else { -1.0 };
            let price = -outward * self.slope(j) / (count * misfit);
            (price * self.bounds.width()[j] > HOLDS * misfit).then(|| HoldingBound {
                variable: j,
                is_upper,
                price,
                targets: self.held_targets(&self.change(j, outward, &free), j),
            })
        });
        let mut found: Vec<HoldingBound> = sides.collect();
        let effect = |own: &HoldingBound| own.price * self.bounds.width()[own.variable];
        found.sort_by(|a, b| effect(b).total_cmp(&effect(a)));
        found
    }

    /// Derivative of F with respect to a variable, with the multipliers of the constraints.
    fn slope(&self, j: usize) -> f64 {
        let rows = self.rows.column(j);
        let rows = rows.iter().zip(self.multipliers);
        let held: f64 = rows.map(|(gradient, m)| gradient * m).sum();
        self.goal.jacobian.column(j).dot(&self.goal.residuals) + held
    }

    /// Change (2) of the residuals per unit by which variable `j` moves outwards, while the variables `free` follow.
    fn change(&self, j: usize, outward: f64, free: &[usize]) -> DVector<f64> {
        let jacobian = &self.goal.jacobian;
        let own = jacobian.column(j) * outward;
        if free.is_empty() {
            return own;
        }
        let width =
            DVector::from_iterator(free.len(), free.iter().map(|k| self.bounds.width()[*k]));
        let binding: Vec<usize> = (0..self.rows.nrows())
            .filter(|row| self.multipliers[*row] != 0.0)
            .collect();
        let targets = jacobian.nrows();
        let size = |of: &DMatrix<f64>, row: usize| {
            let entries = of.row(row);
            let entries = entries.iter().zip(self.bounds.width().iter());
            entries
                .map(|(slope, width)| (slope * width).powi(2))
                .sum::<f64>()
                .sqrt()
        };
        let largest = (0..targets)
            .map(|row| size(jacobian, row))
            .fold(0.0, larger);
        // Values of the residuals' rows, then of the weighted rows of the binding constraints.
        let entry = |row: usize, variable: usize| match row.checked_sub(targets) {
            None => jacobian[(row, variable)],
            Some(number) => {
                let row = binding[number];
                let own = size(self.rows, row).max(f64::MIN_POSITIVE);
                self.rows[(row, variable)] * CONSTRAINTS_FIRST * largest / own
            }
        };
        let all = targets + binding.len();
        let columns = DMatrix::from_fn(all, free.len(), |row, k| entry(row, free[k]));
        let moved = DVector::from_fn(all, |row, _| outward * entry(row, j));
        let mut squares = BoundedLeastSquares::new(free.len(), all);
        squares.reduce(&columns, &width, &moved);
        let unlimited = vec![f64::INFINITY; free.len()];
        let below = vec![f64::NEG_INFINITY; free.len()];
        squares.solve(FOLLOWS * FOLLOWS * targets as f64, &below, &unlimited);
        let steps = squares.step().iter().zip(&width).zip(free);
        steps.fold(own, |sum, ((step, width), k)| {
            sum + jacobian.column(*k) * (step * width)
        })
    }

    /// Targets whose root mean square deviation falls with this change of the residuals, the most affected first.
    fn held_targets(&self, change: &DVector<f64>, j: usize) -> Vec<(usize, f64)> {
        let count = self.of_rows.iter().max().map_or(0, |last| last + 1);
        let (mut squares, mut products) = (vec![0.0; count], vec![0.0; count]);
        let rows = self.goal.residuals.iter().zip(change.iter());
        for ((residual, change), target) in rows.zip(self.of_rows) {
            squares[*target] += residual * residual;
            products[*target] += residual * change;
        }
        let shares = squares
            .iter()
            .zip(&products)
            .map(|(square, product)| -product / square);
        let held = |(_, share): &(usize, f64)| share * self.bounds.width()[j] > HOLDS;
        let mut found: Vec<(usize, f64)> = shares.enumerate().filter(held).collect();
        found.sort_by(|a, b| b.1.total_cmp(&a.1));
        found
    }
}

impl Fit {
    /// Point with the smallest misfit of a run that ended at a minimum of the misfit, or near the design with nearly the smallest
    /// misfit. `None` for other runs: there, bounds and limits do not determine the misfit.
    pub(crate) fn minimum(&self) -> Option<&DVector<f64>> {
        let is_minimum = matches!(
            self.termination,
            Termination::NoFurtherDescent
                | Termination::StepBelowResolution
                | Termination::Stationary
        );
        let is_minimum = is_minimum && self.is_feasible();
        self.left.as_ref().or(is_minimum.then_some(&self.x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimise::test_problems::{Noise, Values, stated, vector};
    use crate::optimise::{Control, Options, constrained_fit};

    /// Residuals of two targets and one limited sum, with random coefficients. There are more residuals than variables, so no
    /// target is met exactly.
    fn linear(noise: &mut Noise) -> impl Fn(&[f64]) -> [Values; 3] + Clone + use<> {
        let rows: Vec<[f64; 4]> = (0..6).map(|_| [(); 4].map(|()| noise.next())).collect();
        move |x: &[f64]| {
            let goal = rows.iter().map(|[a, b, c, aim]| {
                let value = a * x[0] + b * x[1] + c * x[2] - 3.0 * aim;
                (value, vec![*a, *b, *c])
            });
            let limited = (x[0] + x[1] + x[2] - 0.2, vec![1.0; 3]);
            [goal.collect(), vec![], vec![limited]]
        }
    }

    const OF_ROWS: [usize; 6] = [0, 0, 0, 1, 1, 1];

    fn minimum<F: Fn(&[f64]) -> [Values; 3] + Clone>(at: &F, ranges: &[[f64; 2]]) -> (Fit, Bounds) {
        let bounds = Bounds::new(ranges).unwrap();
        let problem = stated(&[0.0; 3], 0, f64::INFINITY, at.clone());
        let (start, options) = (vector(&[0.0; 3]), Options::default());
        let found = constrained_fit(0, problem, &bounds, &start, &options, Control::default());
        (found.unwrap().into_fit(&bounds, true), bounds)
    }

    /// Root mean square of the residuals of each target.
    fn deviations(fit: &Fit) -> [f64; 2] {
        let residuals = fit.evaluation.residuals.as_slice();
        [&residuals[..3], &residuals[3..]]
            .map(|own| (own.iter().map(|r| r * r).sum::<f64>() / 3.0).sqrt())
    }

    /// Moves each bound outwards by a small step and minimises again. The misfit and the deviations of both targets change as
    /// predicted. Bounds that are not named lower the misfit by less than the named share.
    #[test]
    fn a_moved_bound_lowers_misfit_and_deviations_as_predicted() {
        let mut noise = Noise::new(4);
        let (mut named, mut bound_rows) = (0, 0);
        for _ in 0..60 {
            let at = linear(&mut noise);
            let ranges = [[-0.5, 0.4], [-0.3, 0.6], [-0.4, 0.5]];
            let (fit, bounds) = minimum(&at, &ranges);
            let mut problem = stated(&[0.0; 3], 0, f64::INFINITY, at.clone());
            let found = Minimum::of(&fit, &OF_ROWS, &bounds, &mut problem).unwrap();
            bound_rows += usize::from(fit.constraints.as_ref().unwrap().values[0] > -1e-9);
            for own in &found {
                let step = 1e-4;
                let mut wider = ranges;
                let end = &mut wider[own.variable][usize::from(own.is_upper)];
                *end += if own.is_upper { step } else { -step };
                let (moved, _) = minimum(&at, &wider);
                let fall = (fit.misfit() - moved.misfit()) / step;
                assert!(
                    (fall - own.price).abs() < 1e-2 * own.price,
                    "{fall} {own:?}"
                );
                let pairs = deviations(&fit).into_iter().zip(deviations(&moved));
                for (target, (before, after)) in pairs.enumerate() {
                    let share = (before - after) / (step * before);
                    let told = own.targets.iter().find(|(number, _)| *number == target);
                    let told = told.map_or_else(|| share.min(HOLDS), |(_, share)| *share);
                    assert!(
                        (share - told).abs() < 2e-2 * (1.0 + share.abs()),
                        "{share} {own:?}"
                    );
                }
                named += 1;
            }
        }
        assert!(named > 40 && bound_rows > 5, "{named} {bound_rows}");
    }

    /// Without a minimum of the misfit, the bounds are not known.
    #[test]
    fn a_run_that_stopped_early_names_no_bounds() {
        let (mut fit, bounds) = minimum(&linear(&mut Noise::new(4)), &[[-0.5, 0.4]; 3]);
        fit.termination = Termination::IterationLimit;
        let mut problem = stated(&[0.0; 3], 0, f64::INFINITY, linear(&mut Noise::new(4)));
        assert_eq!(Minimum::of(&fit, &OF_ROWS, &bounds, &mut problem), None);
    }
}
