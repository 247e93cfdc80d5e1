//! Starts of a tuning: runs from several points, and the choice among their results.

use super::constrained::{KEPT, constrained_fit};
use super::fit::fit;
use super::fixed::{FixedRows, Without, starts_without_fixed};
use super::multistart::{every_start, fits, least_misfit, least_violation, nearest};
use super::nearest::Level;
use super::pool::PoolGuard;
use super::tune::Tuner;
use super::{
    Fit, Infeasible, Linearisation, Multistart, Objective, Options, Start, Termination, multistart,
};
use nalgebra::DVector;
use rayon::prelude::*;

/// Designs count as equally good if their misfits are at most this multiple of the smallest misfit. This rule applies only if
/// no design is good enough.
const AS_GOOD: f64 = 1.01;
/// Largest number of repetitions of the search for the smallest change. The search is repeated if a descent from its result
/// ends at a smaller misfit.
const DESCENTS: usize = 4;
/// Relative difference from which a misfit counts as smaller.
const LOWER: f64 = 1e-4;
/// Number of starts that the program runs before it reports that constraints contradict one another.
pub(super) const STARTS_BEFORE_REFUSAL: usize = 4;

impl<'a> Tuner<'a> {
    /// Runs every start and chooses the result. The residuals that are constant at the design do not take part.
    pub(super) fn starts(&self, at_design: Option<&Linearisation>) -> Multistart {
        starts_without_fixed(at_design, &self.bounds, |fixed| self.starts_without(fixed))
    }

    /// Makes the problem without the residuals in `fixed`.
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
        if !self.is_constrained() && optimise.good_enough == 0.0 {
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
        let mut lowered = self.lowered(fixed, &options);
        let mut found = self.drawn_near(&lowered, fixed, &options);
        let mut descents = 0;
        while self.descends_further(&mut lowered, &mut found, fixed, &options) {
            found = self.drawn_near(&lowered, fixed, &options);
            descents += 1;
            if descents == DESCENTS {
                if let Some(Ok(fit)) = found.best.map(|best| found.starts[best].outcome.as_mut())
                    && fit.termination == Termination::NearestOfTheBest
                {
                    fit.termination = Termination::BestNotKnownNearest;
                    fit.residual = None;
                }
                break;
            }
        }
        // A run may have stopped at a misfit that is good enough, but above `misfit_below`. `MisfitReached` does not apply
        // to such a run, and a smaller change may exist.
        for start in &mut found.starts {
            if let Ok(fit) = &mut start.outcome
                && fit.termination == Termination::MisfitReached
                && fit.misfit() > options.misfit_below
            {
                fit.termination = Termination::GoodEnoughNotKnownNearest;
                fit.residual = None;
            }
        }
        found
    }

    /// Moves the results of the starts back towards the design, if their misfit is at most the level to which a misfit may
    /// rise. Leaves them unchanged if `good_enough` is 0. Chooses the result.
    fn drawn_near(&self, lowered: &[Start], fixed: &FixedRows, options: &Options) -> Multistart {
        let mut starts = lowered.to_vec();
        let least = least_misfit(&starts);
        let level = least.map(|least| self.level(least, fixed, options));
        if let Some(level) = level
            && self.optimise.good_enough > 0.0
        {
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
        let best = self.choose(&starts, level.map(|level| level.misfit));
        Multistart { starts, best }
    }

    /// Looks for a smaller misfit: lowers the misfit from the result, if no design is good enough. The search for the
    /// smallest change may have left the valley of the smallest misfit found. If the new run ends below that misfit, the
    /// function stores the end of the run in `lowered` and returns true.
    fn descends_further(
        &self,
        lowered: &mut [Start],
        found: &mut Multistart,
        fixed: &FixedRows,
        options: &Options,
    ) -> bool {
        let (Some(least), Some(best)) = (least_misfit(lowered), found.best) else {
            return false;
        };
        let Ok(near) = &mut found.starts[best].outcome else {
            return false;
        };
        let is_at_level = matches!(
            near.termination,
            Termination::NearestOfTheBest | Termination::BestNotKnownNearest
        );
        if !is_at_level || least <= self.good_enough_without(fixed) || self.control.is_interrupted()
        {
            return false;
        }
        let Ok(mut descent) = self.lowered_from(best, &near.x, fixed, options) else {
            return false;
        };
        let is_lower = descent.is_feasible() && descent.misfit() < (1.0 - LOWER) * least;
        if is_lower {
            let last = near.history.last().map_or(0, |i| i.iteration);
            for iteration in &mut descent.history {
                iteration.iteration += last + 1;
            }
            let history = std::mem::take(&mut descent.history);
            descent.history.clone_from(&near.history);
            descent.history.extend(history);
            lowered[best].outcome = Ok(descent);
        } else {
            near.add_search(descent.evaluations());
        }
        is_lower
    }

    /// Level to which the misfit may rise. `least` is the smallest misfit found.
    fn level<'l>(&self, least: f64, fixed: &'l FixedRows, options: &'l Options) -> Level<'l> {
        let good_enough = self.optimise.good_enough;
        let good = self.good_enough_without(fixed);
        let constant = self.constant_square(fixed);
        let misfit = if least <= good {
            good
        } else {
            // The share [`AS_GOOD`] applies to the misfit of all targets, including the constant residuals. If these are
            // large, the other residuals need not be better than good enough.
            let whole = AS_GOOD * AS_GOOD * (least * least + constant) - constant;
            (AS_GOOD * least).max(good_enough.min(whole.max(0.0).sqrt()))
        };
        Level {
            misfit,
            is_good_enough: (misfit * misfit + constant).sqrt() <= good_enough * (1.0 + 1e-9),
            fixed,
            options,
        }
    }

    /// Mean square that the constant residuals add to the square of the misfit.
    fn constant_square(&self, fixed: &FixedRows) -> f64 {
        fixed.square() / self.layout.residuals() as f64
    }

    /// Limit for the misfit of the residuals that variables change. Together with the constant residuals, this limit gives
    /// the misfit `good_enough`, if that is possible. Otherwise the limit makes the misfit of all residuals about as small
    /// as possible.
    fn good_enough_without(&self, fixed: &FixedRows) -> f64 {
        let (good, constant) = (self.optimise.good_enough, self.constant_square(fixed));
        let rest = good * good - constant;
        if rest > 0.0 {
            rest.sqrt()
        } else {
            good.min(((AS_GOOD * AS_GOOD - 1.0) * constant).sqrt())
        }
    }

    /// Lowers the misfit from a point, until it is good enough or at a minimum.
    fn lowered_from(
        &self,
        index: usize,
        x: &DVector<f64>,
        fixed: &FixedRows,
        options: &Options,
    ) -> Result<Fit, Infeasible> {
        let until_good = Options {
            misfit_below: options.misfit_below.max(self.good_enough_without(fixed)),
            ..options.clone()
        };
        let (problem, bounds) = (self.problem_without(fixed), &self.bounds);
        if !self.is_constrained() {
            return fit(index, problem, bounds, x, &until_good, self.control);
        }
        let fit = constrained_fit(index, problem, bounds, x, &until_good, self.control)?;
        let good = fit.at.goal.misfit() <= until_good.misfit_below;
        Ok(fit.into_fit(&self.bounds, !good))
    }

    fn is_constrained(&self) -> bool {
        !self.layout.labels().is_empty()
    }

    /// Lowers the misfit from every start, until it is good enough or at a minimum.
    fn lowered(&self, fixed: &FixedRows, options: &Options) -> Vec<Start> {
        let optimise = self.optimise;
        let first = |index: usize, x: &DVector<f64>| self.lowered_from(index, x, fixed, options);
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

    /// Chooses the result. Among the starts that satisfy the constraints with a misfit up to `level`, the function takes
    /// the one with the smallest move. `level` is `None` if no start satisfied the constraints. The function then takes the
    /// start with the smallest violation.
    fn choose(&self, starts: &[Start], level: Option<f64>) -> Option<usize> {
        let distance = self.distance();
        let near = level.and_then(|level| {
            let good = match self.optimise.good_enough {
                0.0 => least_misfit(starts)? * (1.0 + 1e-9),
                _ => (level + KEPT) * (1.0 + 1e-6),
            };
            nearest(starts, good, |x| distance.of(x), 1e-6)
        });
        near.or_else(|| least_violation(starts))
    }
}
