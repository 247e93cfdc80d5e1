//! Verdict on a tuning: targets and constraints that the variables cannot change, and the prices of limits. A wheel, an axle
//! and a car share these definitions.

use super::constrained::KEPT;
use super::fixed::{MISSED, moves};
use super::layout::whole;
use super::{Bounds, Fit, Linearisation};

/// Relative difference up to which two computed prices of the same constraint count as equal.
const SAME_PRICE: f64 = 0.05;
/// Smallest effect of the variables on a target, as a share of the target's deviation. If moves across all ranges change
/// the deviation by less, the variables hardly affect the target.
const HARDLY: f64 = 0.05;

/// A limit of a constraint at the end of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limit {
    /// Row of the limit, and the row of the second component if the limit is on the length of a vector.
    pub rows: [Option<usize>; 2],
    /// Violation in visible units (1 mm or 1 degree).
    pub violation: f64,
}

impl Limit {
    /// Makes the limit of a row. If the row is a component of a distance, `other` is the row of the second component. `values` has
    /// the values of all rows. `violation` returns the violation of a row with a value. The result is `None` for the second
    /// component, because the first one counts for both.
    pub(crate) fn of_row(
        row: usize,
        other: Option<usize>,
        values: &[f64],
        violation: impl Fn(usize, f64) -> f64,
    ) -> Option<Self> {
        whole(row, other, |row| values[row]).map(|value| Limit {
            rows: [Some(row), other],
            violation: violation(row, value),
        })
    }
}

/// Price of a limit: reduction of the misfit if the limit moves outwards by one unit. The misfit is a multiple of the tolerances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Price {
    /// The limit does not bind, or the misfit is good enough despite the limit. Also if the run did not end at a minimum, or
    /// searched for the largest yield.
    Nothing,
    /// Reduction of the misfit if the limit moves outwards by one unit of the constraint.
    PerUnit(f64),
    /// The limit binds together with other limits, and the gradients of these limits are linearly dependent. The share of
    /// each limit in the price is not determined.
    NotDetermined,
}

impl Price {
    /// Reduction of the misfit if the limit moves outwards by one unit of the constraint. `None` if there is no price, or if the
    /// price is not determined.
    pub fn per_unit(self) -> Option<f64> {
        match self {
            Price::PerUnit(price) => Some(price),
            Price::Nothing | Price::NotDetermined => None,
        }
    }

    /// Price of a constraint at the end of a run. `visible` is a visible change (1 mm or 1 degree), given in the unit of
    /// the constraint.
    pub(crate) fn of(fit: &Fit, limits: impl Iterator<Item = Limit>, visible: f64) -> Self {
        let Some(state) = &fit.constraints else {
            return Price::Nothing;
        };
        let mut pulls = [0.0; 2];
        // A limit that does not bind has no price. A row that no variable changes has no price either.
        for limit in limits.filter(|limit| limit.violation >= -KEPT) {
            let pull = |multipliers: &[f64]| {
                let rows = limit.rows.iter().flatten();
                let movable = rows.filter(|row| state.movable[**row]);
                movable.fold(0.0, |norm: f64, row| norm.hypot(multipliers[*row]))
            };
            let of = |m: &Option<Vec<f64>>| m.as_deref().map(pull);
            let first = of(&state.multipliers).unwrap_or(0.0);
            let other = of(&state.alternatives).unwrap_or(first);
            pulls[0] += first;
            pulls[1] += other;
        }
        let count = fit.evaluation.residuals.len() as f64;
        let [price, other] = pulls.map(|pull| pull / (count * fit.misfit()));
        let most = price.max(other);
        if most.is_nan() || most <= 1e-6 {
            Price::Nothing
        } else if (price - other).abs() > SAME_PRICE * most {
            Price::NotDetermined
        } else {
            Price::PerUnit(price / visible)
        }
    }
}

/// Indices of constraints with a violated row that no variable changes. `of_rows` has the constraint of each row, and
/// `violation` returns the violation of a row with this value, in visible units.
pub(crate) fn unmoved_constraints(
    fit: &Fit,
    of_rows: &[usize],
    violation: impl Fn(usize, f64) -> f64,
) -> Vec<usize> {
    let Some(state) = &fit.constraints else {
        return Vec::new();
    };
    let rows = of_rows.iter().enumerate();
    let missed =
        rows.filter(|(row, _)| !state.movable[*row] && violation(*row, state.values[*row]) > KEPT);
    let mut missed: Vec<usize> = missed.map(|(_, constraint)| *constraint).collect();
    missed.sort_unstable();
    missed.dedup();
    missed
}

/// A missed target that the variables hardly change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlightEffect {
    /// Index of the target.
    pub target: usize,
    /// Deviation of the tuned design from the target, in multiples of the tolerance.
    pub deviation: f64,
    /// Change of the target if every variable moves across its range, to first order, in multiples of the tolerance.
    pub change: f64,
}

/// Missed targets on which the variables have too little effect.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unmoved {
    /// Indices of missed targets that no variable changes.
    pub targets: Vec<usize>,
    /// True if one of these targets is missed by more than its tolerance.
    pub exceeds_tolerance: bool,
    /// Targets missed by more than their tolerance that the variables hardly change.
    pub slightly: Vec<SlightEffect>,
}

/// Residuals of a tuning: the target of each row, and the evaluations at which the effects of the variables are known.
pub(crate) struct Residuals<'a> {
    /// Index of the target of each row.
    pub of_rows: &'a [usize],
    /// Evaluations at the study's design and at the end of every start.
    pub seen: &'a [&'a Linearisation],
    /// Ranges of the variables.
    pub bounds: &'a Bounds,
}

impl Residuals<'_> {
    fn rows(&self, target: usize) -> impl Iterator<Item = usize> {
        let rows = self.of_rows.iter().enumerate();
        rows.filter(move |(_, of)| **of == target)
            .map(|(row, _)| row)
    }

    /// Finds the missed targets on which the variables have too little effect. `deviations` has the root mean square
    /// deviation from each target, in multiples of the tolerance. `end` has the residuals of the tuned design.
    pub(crate) fn unmoved(&self, deviations: &[f64], end: &Linearisation) -> Unmoved {
        let mut found = Unmoved::default();
        for (target, deviation) in deviations.iter().copied().enumerate() {
            if deviation <= 1e-6 {
                continue;
            }
            if !self.is_moved(target) {
                found.targets.push(target);
                found.exceeds_tolerance |= deviation > MISSED;
            } else if deviation > MISSED {
                let share = self.share(target, end);
                if share < HARDLY {
                    found.slightly.push(SlightEffect {
                        target,
                        deviation,
                        change: share * deviation,
                    });
                }
            }
        }
        found
    }

    /// Returns true if some variable changes a target at one of the evaluations.
    fn is_moved(&self, target: usize) -> bool {
        let moves = |row: usize| self.seen.iter().any(|at| moves(at, row, self.bounds));
        self.rows(target).any(moves)
    }

    /// Change of a target if every variable moves across its range, to first order, as a share of its deviation at `end`.
    fn share(&self, target: usize, end: &Linearisation) -> f64 {
        let width = self.bounds.width();
        let reach = |at: &Linearisation, row: usize| {
            let slopes = at.jacobian.row(row);
            let slopes = slopes.iter().zip(width.iter());
            slopes
                .map(|(slope, width)| (slope * width).abs())
                .sum::<f64>()
        };
        let square_at = |at: &&Linearisation| {
            let rows = self.rows(target).map(|row| reach(at, row).powi(2));
            rows.sum::<f64>()
        };
        let reached = self.seen.iter().map(square_at).fold(0.0, f64::max);
        let deviation = self.rows(target).map(|row| end.residuals[row].powi(2));
        (reached / deviation.sum::<f64>()).sqrt()
    }
}
