//! Trial steps. The model proposes a step; the solver evaluates, corrects, accepts or refuses it.

use super::super::super::{Infeasible, Termination};
use super::super::Constrained;
use super::super::model::Proposal;
use super::{BALANCED, GOOD, KEPT, POOR, RESOLUTION, STUCK, SequentialConvex, TRIALS, WHOLE};
use nalgebra::DVector;

/// Trial steps of one iteration.
#[derive(Default)]
pub(super) struct Trials {
    /// Goal and violation of the current point.
    pub from: [f64; 2],
    /// True if the model includes the estimate of the curvature.
    pub curved: bool,
    /// Largest reduction of the goal that counts as zero.
    pub negligible: f64,
    /// Number of trial steps in this iteration.
    pub count: usize,
    /// Number of evaluations in this iteration.
    pub evaluations: u32,
    /// Number of evaluations without a result, in this iteration.
    pub infeasible: u32,
    /// Reason of the last evaluation without a result.
    pub obstacle: Option<Infeasible>,
}

/// Step that the model proposes.
struct Step {
    /// Largest component of the step, in half ranges of the variables.
    length: f64,
    /// Reduction of the goal that the model predicts for the step.
    predicted: f64,
    /// True if the current point is the optimum of the convex model, so no step improves the model.
    is_balanced: bool,
}

/// Result of a trial step.
pub(super) enum Trial {
    /// Refused. Another trial follows.
    Refused,
    /// The run ends at the current point.
    Ended,
    /// Accepted, with the length of the step in fractions of the ranges.
    Accepted(f64),
}

impl SequentialConvex<'_> {
    /// Proposes a step and evaluates it. If the step is accepted, `x` moves.
    pub(super) fn try_step(
        &mut self,
        problem: &mut impl Constrained,
        x: &mut DVector<f64>,
        trials: &mut Trials,
    ) -> Trial {
        let proposal = self.model.solve(self.radius, trials.curved);
        let (length, predicted) = (
            self.model.largest_component(),
            self.model.predicted_reduction(),
        );
        let step = Step {
            length,
            predicted,
            is_balanced: proposal == Proposal::Optimal
                && trials.from[1] <= KEPT
                && length < self.radius
                && predicted.abs() <= trials.negligible,
        };
        if self.ends_at(&proposal, &step, trials) || !self.record.may_evaluate() {
            return Trial::Ended;
        }
        self.model.step_from(x, &mut self.trial_x);
        trials.evaluations += 1;
        match self.evaluate_trial(problem) {
            Ok(false) => {}
            Ok(true) => return self.try_with_new_rows(x, trials),
            Err(reason) => {
                trials.infeasible += 1;
                trials.obstacle = Some(reason);
                self.radius = 0.3 * length;
                return Trial::Refused;
            }
        }
        let mut accepted = self.is_better(trials.from, predicted);
        if step.is_balanced && trials.obstacle.is_none() {
            self.record.end(Termination::NoFurtherDescent);
            if !accepted {
                return Trial::Ended;
            }
        }
        if !accepted && self.pair(&self.trial)[1] > trials.from[1].max(KEPT) {
            // The trial has a larger violation. The reason can be the curvature of the rows, so a corrected step is tried.
            match self.try_corrected(problem, x, predicted, trials) {
                Some(is_better) => accepted = is_better,
                None => return self.try_with_new_rows(x, trials),
            }
        }
        match (accepted, self.record.has_ended()) {
            (true, _) => Trial::Accepted(self.accept(x, &step, trials.from)),
            (false, true) => Trial::Ended,
            (false, false) => {
                self.keep_beside(length);
                self.radius = (0.3 * length).min(0.5 * self.radius);
                Trial::Refused
            }
        }
    }

    /// Ends the run at the current point if the proposed step cannot improve it. Returns true if the run ends.
    fn ends_at(&mut self, proposal: &Proposal, step: &Step, trials: &mut Trials) -> bool {
        if let Proposal::Relaxed {
            remaining,
            culprits,
        } = proposal
            && *remaining >= (1.0 - STUCK) * trials.from[1]
            && trials.from[1] > KEPT
        {
            self.culprits.clone_from(culprits);
            self.record.end(Termination::ConstraintsExcludeEachOther);
            return true;
        }
        // Rounding errors may keep the step from getting shorter. So after [`TRIALS`] trials the step counts as the
        // shortest possible step.
        trials.count += 1;
        let shortest = self.record.options.step_below.max(RESOLUTION);
        if step.length <= shortest || trials.count > TRIALS {
            self.record.end(match trials.obstacle.take() {
                Some(reason) => Termination::NoFeasibleStep(reason),
                None => Termination::StepBelowResolution,
            });
            return true;
        }
        let is_optimum = step.is_balanced && trials.obstacle.is_none();
        if is_optimum && self.model.imbalance() <= BALANCED {
            // A further step would not reduce the goal visibly.
            self.record.end(Termination::NoFurtherDescent);
            return true;
        }
        false
    }

    /// Includes the rows that were constant so far, and refuses the trial. The next trial considers these rows.
    fn try_with_new_rows(&mut self, x: &DVector<f64>, trials: &mut Trials) -> Trial {
        self.count_new_rows(x);
        trials.from = self.pair(&self.current);
        Trial::Refused
    }

    /// Corrects the refused step for the curvature of the rows, and evaluates the corrected step. Returns true if the
    /// corrected step is better. Returns `None` if rows that were constant so far change at the corrected trial.
    fn try_corrected(
        &mut self,
        problem: &mut impl Constrained,
        x: &DVector<f64>,
        predicted: f64,
        trials: &mut Trials,
    ) -> Option<bool> {
        let corrected = self.model.solve_corrected(&self.trial, trials.curved);
        let moves = corrected == Proposal::Optimal && self.model.largest_component() > 0.0;
        if !moves || !self.record.may_evaluate() {
            return Some(false);
        }
        self.model.step_from(x, &mut self.trial_x);
        trials.evaluations += 1;
        match self.evaluate_trial(problem) {
            Ok(false) => Some(self.is_better(trials.from, predicted)),
            Ok(true) => None,
            Err(_) => {
                trials.infeasible += 1;
                Some(false)
            }
        }
    }

    /// Moves to the trial, and adapts the trust radius (limit of the step's components) to the accuracy of the model's
    /// prediction. Returns the length of the step in fractions of the ranges.
    fn accept(&mut self, x: &mut DVector<f64>, step: &Step, from: [f64; 2]) -> f64 {
        let &Step {
            length, predicted, ..
        } = step;
        let [goal, violation] = self.pair(&self.trial);
        if violation > KEPT || predicted <= 0.0 || from[1] > KEPT {
            self.filter.pass(from[0], from[1]);
        }
        let ratio = (from[0] - goal) / predicted;
        if from[1] <= KEPT && predicted > 0.0 && ratio < POOR {
            self.radius = 0.5 * length;
        } else if length >= 0.99 * self.radius && (ratio > GOOD || violation < 0.1 * from[1]) {
            self.radius = (2.5 * self.radius).min(WHOLE);
        }
        let size = self.record.bounds.distance(x, &self.trial_x);
        self.model.learn(&self.current, &self.trial);
        std::mem::swap(x, &mut self.trial_x);
        std::mem::swap(&mut self.current, &mut self.trial);
        self.leave_beside(length);
        self.rebuild_model(x);
        size
    }
}
