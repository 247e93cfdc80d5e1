//! Search for the smallest change of the design that is good enough.
//!
//! The search starts from a design with a low misfit. It lowers the distance from the study's own design, while the misfit
//! stays below a level m and the constraints are satisfied. One run usually converges. If the run ends at an infeasible
//! point, with an error, or at its limit of evaluations, more runs follow:
//!
//! - from the end of the first run, if this point is feasible
//! - for several rising levels between the lowest misfit and m; each run starts from the end of the previous run
//! - from the study's own design
//!
//! All runs except the last refuse steps that would exceed the level by far. A result for a lower level also satisfies a
//! higher level, so the search returns the result nearest to the study's own design. If no run for m converged, a smaller
//! change may exist. The termination then says so.

use super::constrained::{Assessment, Constrained, ConstrainedFit, KEPT, constrained_fit};
use super::fixed::FixedRows;
use super::trade::{ConstrainedTrade, Criterion, Distance};
use super::tune::Tuner;
use super::{Fit, Iteration, Linearisation, Options, Termination};
use nalgebra::DVector;

/// Moves shorter than this share of the range count as zero.
const NO_MOVE: f64 = 1e-9;
/// Intermediate levels (limits of the misfit), as shares of the difference between the lowest misfit and the final level m.
const RUNGS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];
/// Smallest limit for the rise of the violation by a step: one tolerance, or one visible unit of a constraint. In this module
/// the limit is the level, if that is larger. Steps with a larger violation would lead to other minima.
pub(super) const NEAR_LEVEL: f64 = 1.0;
/// Largest numbers of evaluations, as shares of [`Options::max_evaluations`]. The first constant applies to all runs
/// together, the second to each run.
const ALL_RUNS: f64 = 0.1;
const ONE_RUN: f64 = 0.03;
/// Relative difference up to which distances count as equal. A design that violates a constraint by up to [`KEPT`] can be
/// nearer by such a difference than the nearest design that satisfies the constraint exactly.
const AS_NEAR: f64 = 1e-6;

/// Level to which the misfit may rise.
#[derive(Clone, Copy)]
pub(super) struct Level<'l> {
    pub misfit: f64,
    /// True if a misfit at the level is good enough. Otherwise the level is slightly above the smallest misfit.
    pub is_good_enough: bool,
    pub fixed: &'l FixedRows,
    pub options: &'l Options,
}

/// State of a search for the nearest design, which consists of several runs.
struct Search<'s, 'a> {
    tuner: &'s Tuner<'a>,
    index: usize,
    level: Level<'s>,
    distance: Distance<'s>,
    history: Vec<Iteration>,
    /// Nearest design so far that satisfies the level and the constraints, with its distance. The flag is true if no nearer
    /// design exists.
    best: Option<(f64, ConstrainedFit, bool)>,
    /// Reason for the end of the last run.
    ended: Option<Termination>,
    /// Number of evaluations that the search may still make.
    left: u64,
}

/// Returns true if a distance is at most as large as another distance, up to the relative difference [`AS_NEAR`].
fn is_as_near(distance: f64, other: f64) -> bool {
    distance <= other + AS_NEAR * other
}

impl Search<'_, '_> {
    /// Runs the search with a limit on the misfit. Returns the end point if it satisfies this limit and the constraints.
    fn run(
        &mut self,
        from: &DVector<f64>,
        misfit: f64,
        known: Option<&Linearisation>,
        options: &Options,
    ) -> Option<DVector<f64>> {
        let tuner = self.tuner;
        let options = Options {
            max_evaluations: options.max_evaluations.min(self.left),
            ..options.clone()
        };
        if self.left == 0 {
            return None;
        }
        let problem = tuner.problem_without(self.level.fixed);
        let (all, movement) = (tuner.all_targets(), Criterion::movement());
        let mut near =
            ConstrainedTrade::new(problem, &self.distance, &movement, vec![(&all, misfit)]);
        if let Some(known) = known {
            near = near.knowing(from, known);
        }
        let found = constrained_fit(
            self.index,
            near,
            &tuner.bounds,
            from,
            &options,
            tuner.control,
        );
        // The start point always needs one evaluation.
        self.left -= 1;
        let mut found = found.ok()?;
        self.left = self.left.saturating_sub(found.evaluations() - 1);
        if known.is_some()
            && let Some(first) = found.history.first_mut()
        {
            first.evaluations = 0;
        }
        self.history.append(&mut found.history);
        self.ended = Some(found.termination.clone());
        if !found.is_feasible() {
            return None;
        }
        let is_known = found.termination.at_minimum() && misfit >= self.level.misfit;
        let (distance, x) = (self.distance.of(&found.x), found.x.clone());
        let is_better = self.best.as_ref().is_none_or(|(least, _, was_known)| {
            let tie = AS_NEAR * least;
            distance < least - tie || (distance <= least + tie && is_known && !was_known)
        });
        if is_better {
            self.best = Some((distance, found, is_known));
        }
        Some(x)
    }

    /// Returns true if a nearest design at a distance of at most `most` has been found, or if the search must stop.
    fn is_over(&self, most: f64) -> bool {
        let near = self.best.as_ref();
        near.is_some_and(|(distance, _, known)| *known && is_as_near(*distance, most))
            || self.ended == Some(Termination::Interrupted)
            || self.left == 0
    }

    /// Options of a run. A run may use only a share of all evaluations.
    fn options(&self, violation_below: f64) -> Options {
        let all = self.level.options.max_evaluations as f64;
        Options {
            violation_below,
            max_evaluations: (ONE_RUN * all) as u64,
            ..self.level.options.clone()
        }
    }

    /// Tries further runs after the first one, from `x` with the misfit `misfit`.
    fn try_again(&mut self, x: &DVector<f64>, misfit: f64, most: f64) {
        let level = self.level.misfit;
        let near = self.options(level.max(NEAR_LEVEL));
        if let Some((_, found, _)) = &self.best {
            let from = found.x.clone();
            self.run(&from, level, None, &near);
        }
        let mut from = x.clone();
        for share in RUNGS {
            if self.is_over(most) {
                return;
            }
            let rung = match share {
                1.0 => level,
                share => misfit + share * (level - misfit),
            };
            if let Some(next) = self.run(&from, rung, None, &near) {
                from = next;
            }
        }
        if !self.is_over(most) {
            let design = self.tuner.bounds.nearest(&self.tuner.design);
            let far = self.options(f64::INFINITY);
            self.run(&design, level, None, &far);
        }
    }
}

impl Tuner<'_> {
    /// Moves a fit as near to the study's own design as the highest permitted misfit (`level`) and the constraints allow.
    pub(super) fn draw_near(&self, index: usize, fit: &mut Fit, level: Level<'_>) {
        let mut search = Search {
            tuner: self,
            index,
            level,
            distance: self.distance(),
            history: Vec::new(),
            best: None,
            ended: None,
            left: (ALL_RUNS * level.options.max_evaluations as f64).max(1.0) as u64,
        };
        let most = search.distance.of(&fit.x);
        fit.left = fit.minimum().filter(|_| !level.is_good_enough).cloned();
        let known = fit.constraints.is_none().then_some(&fit.evaluation);
        let near = search.options(level.misfit.max(NEAR_LEVEL));
        search.run(&fit.x, level.misfit, known, &near);
        if !search.is_over(most) {
            search.try_again(&fit.x, fit.misfit(), most);
        }
        let Search {
            mut history,
            best,
            ended,
            ..
        } = search;
        let steps = fit.history.last().map_or(0, |i| i.iteration);
        for (k, iteration) in history.iter_mut().enumerate() {
            iteration.iteration = steps + 1 + k as u64;
        }
        fit.history.append(&mut history);
        let near = best.filter(|(distance, ..)| is_as_near(*distance, most));
        let is_known = near.as_ref().is_some_and(|(.., known)| *known);
        fit.termination = match (ended, is_known, level.is_good_enough) {
            (Some(Termination::Interrupted), false, _) => Termination::Interrupted,
            (_, true, true) => Termination::NearestGoodEnough,
            (_, true, false) => Termination::NearestOfTheBest,
            (_, false, true) => Termination::GoodEnoughNotKnownNearest,
            (_, false, false) => Termination::BestNotKnownNearest,
        };
        if let Some((_, found, _)) = near {
            self.take_near(fit, found, level);
        }
        if !is_known {
            // The stored imbalance belongs to another problem: to a search for the lowest misfit, or to a lower level. So
            // it is removed.
            fit.residual = None;
        }
    }

    /// Replaces the fit by the design that the search found.
    fn take_near(&self, fit: &mut Fit, mut found: ConstrainedFit, level: Level<'_>) {
        let mut violation = found.violation;
        let (x, targets, rows) = match self.unmoved_exactly(&found, level) {
            Some((x, at, kept)) => {
                violation = kept;
                (x, at.goal, at.rows)
            }
            // The first level limits the misfit of all targets, so its residuals are the residuals of the targets.
            None => (found.x, found.at.levels.swap_remove(0), found.at.rows),
        };
        fit.active_bounds = self.bounds.active_bounds(&x);
        fit.x = x;
        fit.evaluation = targets;
        fit.residual = Some(found.imbalance);
        if let Some(state) = &mut fit.constraints {
            state.values = rows.residuals;
            state.violation = violation;
            for (all, own) in state.movable.iter_mut().zip(found.movable) {
                *all |= own;
            }
        }
    }

    /// Returns the design found, with variables that hardly moved set back to their exact design values. `None` if there are
    /// no such variables, or if the level or a constraint would be violated.
    fn unmoved_exactly(
        &self,
        found: &ConstrainedFit,
        level: Level<'_>,
    ) -> Option<(DVector<f64>, Assessment, f64)> {
        let mut x = found.x.clone();
        for j in 0..x.len() {
            if (x[j] - self.design[j]).abs() <= NO_MOVE * self.bounds.width()[j] {
                x[j] = self.design[j];
            }
        }
        if x == found.x {
            return None;
        }
        let mut problem = self.problem_without(level.fixed);
        let shape = problem.shape();
        let mut at = Assessment::new(&shape);
        problem.assess(&x, &mut at).ok()?;
        at.check().ok()?;
        let counts = |row: usize| found.movable.get(row).copied().unwrap_or(true);
        let violation = at.violation_of(shape.equalities, &[], counts);
        let is_kept = violation <= KEPT && at.goal.misfit() <= level.misfit + KEPT;
        is_kept.then_some((x, at, violation))
    }
}
