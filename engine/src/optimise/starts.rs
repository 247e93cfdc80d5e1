//! Starts of a tuning: runs from several points, and the choice among their results.

use super::constrained::constrained_fit;
use super::fit::fit;
use super::fixed::{FixedRows, Without};
use super::multistart::{every_start, fits, least_misfit, least_violation, nearest};
use super::nearest::Level;
use super::pool::PoolGuard;
use super::tune::Tuner;
use super::{Fit, Linearisation, Multistart, Objective, Options, Start, Termination, multistart};
use nalgebra::DVector;
use rayon::prelude::*;

/// Largest ratio to the smallest misfit up to which designs count as equally good. It applies if no design is good enough.
const AS_GOOD: f64 = 1.01;
/// Largest number of repetitions of all starts. The starts run again if a residual changes that was constant at the design.
const ROUNDS: usize = 3;
/// Number of starts that are tried before the program reports that constraints exclude one another.
pub(super) const STARTS_BEFORE_REFUSAL: usize = 4;

impl<'a> Tuner<'a> {
    /// Runs every start and chooses the result. Residuals that are constant at the design are removed. If some of them change
    /// elsewhere, they are restored, and the starts run again.
    pub(super) fn starts(&self, at_design: Option<&Linearisation>) -> Multistart {
        let mut fixed =
            at_design.map_or_else(FixedRows::default, |at| FixedRows::at(at, &self.bounds));
        let mut starts = self.starts_without(&fixed);
        for round in 1..=ROUNDS {
            let Some(fewer) = fixed.without_moved() else {
                break;
            };
            fixed = if round < ROUNDS {
                fewer
            } else {
                FixedRows::default()
            };
            starts = self.starts_without(&fixed);
        }
        for start in &mut starts.starts {
            if let Ok(fit) = &mut start.outcome {
                fixed.put_back(fit);
            }
        }
        starts
    }

    /// Makes the problem without some residuals.
    pub(super) fn problem_without<'f>(
        &'f self,
        fixed: &'f FixedRows,
    ) -> Without<'f, PoolGuard<'f, Objective<'a>>> {
        Without {
            problem: self.problem(),
            fixed,
            bounds: &self.bounds,
        }
    }

    /// Runs every start without the constant residuals, and chooses the best result.
    fn starts_without(&self, fixed: &FixedRows) -> Multistart {
        let optimise = self.optimise;
        let options = self.options();
        let is_constrained = !self.layout.labels().is_empty();
        if !is_constrained && optimise.good_enough == 0.0 {
            return multistart(
                || self.problem_without(fixed),
                &self.bounds,
                &self.design,
                optimise.starts,
                optimise.seed,
                &options,
                self.control,
            );
        }
        let mut starts = self.lowered(fixed, &options, is_constrained);
        let least = least_misfit(&starts);
        if let Some(least) = least
            && optimise.good_enough > 0.0
        {
            let good = self.good_enough_without(fixed);
            let is_good = least <= good;
            let misfit = if is_good { good } else { AS_GOOD * least };
            let count = self.layout.residuals() as f64;
            let total = (misfit * misfit + fixed.square() / count).sqrt();
            let level = Level {
                misfit,
                is_good_enough: total <= optimise.good_enough * (1.0 + 1e-9),
                fixed,
                options: &options,
            };
            let each = starts.par_iter_mut().enumerate();
            each.for_each(|(index, start)| {
                if let Ok(fit) = &mut start.outcome
                    && fit.is_feasible()
                    && fit.termination != Termination::Interrupted
                    && fit.misfit() <= level.misfit
                {
                    self.draw_near(index, fit, level);
                }
            });
            self.count_moving_rows(&mut starts);
        }
        // A run that stopped because its misfit was good enough still misses the removed targets.
        for start in &mut starts {
            if let Ok(fit) = &mut start.outcome
                && fit.termination == Termination::MisfitReached
                && fit.misfit() > options.misfit_below
            {
                fit.termination = Termination::GoodEnoughNotKnownNearest;
            }
        }
        let best = self.choose(&starts, least, self.good_enough_without(fixed));
        Multistart { starts, best }
    }

    /// Limit for the misfit of the residuals that variables change. Together with the constant residuals it gives `good_enough`,
    /// if that is possible.
    fn good_enough_without(&self, fixed: &FixedRows) -> f64 {
        let good = self.optimise.good_enough;
        let rest = good * good - fixed.square() / self.layout.residuals() as f64;
        if rest > 0.0 { rest.sqrt() } else { good }
    }

    /// Lowers the misfit from every start, until it is good enough or at a minimum.
    fn lowered(&self, fixed: &FixedRows, options: &Options, is_constrained: bool) -> Vec<Start> {
        let optimise = self.optimise;
        let until_good = Options {
            misfit_below: options.misfit_below.max(self.good_enough_without(fixed)),
            ..options.clone()
        };
        let first = |index: usize, x: &DVector<f64>| {
            let (problem, bounds) = (self.problem_without(fixed), &self.bounds);
            if !is_constrained {
                return fit(index, problem, bounds, x, &until_good, self.control);
            }
            let fit = constrained_fit(index, problem, bounds, x, &until_good, self.control)?;
            let good = fit.at.goal.misfit() <= until_good.misfit_below;
            Ok(fit.into_fit(&self.bounds, !good))
        };
        let run = |numbers| {
            let (bounds, design, seed) = (&self.bounds, &self.design, optimise.seed);
            every_start(numbers, bounds, design, seed, self.control, first)
        };
        let mut starts = run(0..optimise.starts);
        self.count_moving_rows(&mut starts);
        if least_misfit(&starts).is_none() && starts.len() < STARTS_BEFORE_REFUSAL {
            starts.extend(run(starts.len()..STARTS_BEFORE_REFUSAL));
            self.count_moving_rows(&mut starts);
        }
        starts
    }

    /// Marks a row as movable in every start if some variable changes this row in any start.
    fn count_moving_rows(&self, starts: &mut [Start]) {
        let states =
            |(_, fit): (usize, &'_ Fit)| fit.constraints.clone().map(|state| state.movable);
        let mut moving = vec![false; self.layout.labels().len()];
        for own in fits(starts).filter_map(states) {
            for (all, own) in moving.iter_mut().zip(own) {
                *all |= own;
            }
        }
        for start in starts {
            let Ok(fit) = &mut start.outcome else {
                continue;
            };
            let Some(state) = &mut fit.constraints else {
                continue;
            };
            if state.movable != moving {
                let values = state.values.iter().enumerate();
                let counted = values.filter(|(row, _)| moving[*row]);
                let violations = counted.map(|(row, value)| self.layout.violation(row, *value));
                state.violation = violations.fold(0.0, f64::max);
                state.movable.clone_from(&moving);
            }
        }
    }

    /// Chooses the result. Among the starts that satisfy the constraints and are good enough, it takes the one with the
    /// smallest move. If no start is good enough, it takes the smallest move among the starts that are about as good as the
    /// best. If no start satisfies the constraints, it takes the smallest violation. `least` is the smallest misfit of the
    /// starts that satisfy the constraints.
    fn choose(&self, starts: &[Start], least: Option<f64>, good: f64) -> Option<usize> {
        let Some(least) = least else {
            return least_violation(starts);
        };
        let good = match good {
            0.0 => least * (1.0 + 1e-9),
            good if least <= good => good * (1.0 + 1e-6),
            _ => least * AS_GOOD * (1.0 + 1e-6),
        };
        let distance = self.distance();
        nearest(starts, good, |x| distance.of(x), 1e-6)
    }
}
