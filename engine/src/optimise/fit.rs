//! Minimum from one start, and the history of the search.

use super::constrained::KEPT;
use super::fit_record::{evaluations, execute};
use super::stationarity::CONVERGED;
use super::{
    ActiveBound, Bounds, Held, Infeasible, LeastSquares, LevenbergMarquardt, Linearisation, Options,
};
use crate::threads::Interrupt;
use nalgebra::DVector;
use std::fmt;
use std::sync::atomic::AtomicBool;

/// Controls that stop and observe a run.
#[derive(Clone, Copy, Default)]
pub struct Control<'a> {
    /// Flag that stops the run. Once true, the run ends before its next evaluation, with the result so far.
    pub interrupt: Option<&'a AtomicBool>,
    /// Callback after each iteration. If several starts run in parallel on CPU threads, the callback runs on the thread of
    /// the start.
    pub watch: Option<&'a ProgressCallback<'a>>,
}

impl Control<'_> {
    /// Returns true if the run must stop.
    pub(super) fn is_interrupted(&self) -> bool {
        Interrupt(self.interrupt).is_raised()
    }
}

/// Receives the index of a start and its latest iteration.
pub type ProgressCallback<'a> = dyn Fn(usize, &Iteration) + Sync + 'a;

/// One iteration of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Iteration {
    /// Number of the iteration; 0 is the start.
    pub iteration: u64,
    /// Half the sum of the squared residuals at the end of the iteration.
    pub cost: f64,
    /// Root mean square of the residuals at the end of the iteration.
    pub misfit: f64,
    /// Length of the accepted step in fractions of the ranges; 0 if none was accepted.
    pub step: f64,
    /// Damping of the last trial step.
    pub damping: f64,
    /// Number of variables at bounds at the end of the iteration.
    pub held: usize,
    /// Number of points evaluated during the iteration.
    pub evaluations: u32,
    /// Number of evaluations at points where the residuals could not be computed.
    pub infeasible: u32,
}

impl Iteration {
    /// Makes the record of the start of a run, or of an iteration without progress. `end` is the last evaluation of the
    /// iteration.
    pub(super) fn at(end: &Linearisation) -> Self {
        Iteration {
            iteration: 0,
            cost: end.cost(),
            misfit: end.misfit(),
            step: 0.0,
            damping: 0.0,
            held: 0,
            evaluations: 1,
            infeasible: 0,
        }
    }
}

/// Reason for the end of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Termination {
    /// The misfit is at or below [`Options::misfit_below`].
    MisfitReached,
    /// The misfit of the targets that variables move is at or below [`Options::misfit_below`]; the other targets are not met,
    /// but no variable changes them.
    MovedTargetsMet,
    /// No step lowers the cost by more than the share [`Options::reduction_below`].
    NoFurtherDescent,
    /// The step would be shorter than [`Options::step_below`].
    StepBelowResolution,
    /// The residuals are orthogonal to all columns of the Jacobian, within [`Options::gradient_below`]. Variables that a bound
    /// stops do not count.
    Stationary,
    /// Every step that would lower the cost leads to a point where the residuals cannot be computed, even if the step is
    /// very short.
    NoFeasibleStep(Infeasible),
    /// The design is good enough, and no other good enough design nearby has a smaller change.
    NearestGoodEnough,
    /// No design is good enough. This design is as good as the best one found, and no equally good design nearby has a
    /// smaller change.
    NearestOfTheBest,
    /// The design is good enough, but the search for a smaller change did not converge.
    GoodEnoughNotKnownNearest,
    /// No design is good enough. This design is as good as the best one found, but the search for a smaller change did not
    /// converge.
    BestNotKnownNearest,
    /// The run ended as with `NoFurtherDescent`, `StepBelowResolution` or `Stationary`. But the optimality conditions are not
    /// satisfied, or a constraint is violated.
    NotStationary,
    /// No small move raises the yield.
    LargestYield,
    /// The yield is above the yield of the optimum without scatter, but the search for the largest yield did not converge.
    YieldNotConverged,
    /// No small move reduces the violation of the constraints.
    ConstraintsExcludeEachOther,
    /// [`Options::max_iterations`] iterations were made.
    IterationLimit,
    /// [`Options::max_evaluations`] evaluations were made.
    EvaluationLimit,
    /// A request stopped the run.
    Interrupted,
}

impl Termination {
    /// Returns true if the run ended for a reason that counts as a minimum.
    pub fn at_minimum(&self) -> bool {
        match self {
            Termination::MisfitReached
            | Termination::MovedTargetsMet
            | Termination::NoFurtherDescent
            | Termination::StepBelowResolution
            | Termination::NearestGoodEnough
            | Termination::NearestOfTheBest
            | Termination::LargestYield
            | Termination::Stationary => true,
            Termination::NoFeasibleStep(_)
            | Termination::NotStationary
            | Termination::GoodEnoughNotKnownNearest
            | Termination::BestNotKnownNearest
            | Termination::YieldNotConverged
            | Termination::ConstraintsExcludeEachOther
            | Termination::IterationLimit
            | Termination::EvaluationLimit
            | Termination::Interrupted => false,
        }
    }

    /// Checks the reason against the imbalance of the optimality conditions. An end without further progress counts as a
    /// minimum only if the imbalance is below [`CONVERGED`].
    pub(super) fn checked(self, residual: f64) -> Self {
        match self {
            Termination::NoFurtherDescent
            | Termination::StepBelowResolution
            | Termination::Stationary
                if residual >= CONVERGED =>
            {
                Termination::NotStationary
            }
            end => end,
        }
    }
}

impl fmt::Display for Termination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Termination::MisfitReached => "converged: the targets are met",
            Termination::MovedTargetsMet => {
                "converged: all targets that a variable affects are met, the others are missed"
            }
            Termination::NoFurtherDescent => "converged: no step improves the design any further",
            Termination::StepBelowResolution => {
                "converged: the next step is too small to change the result"
            }
            Termination::Stationary => {
                "converged: no small move within the ranges improves the design"
            }
            Termination::NoFeasibleStep(reason) => return write!(f, "no feasible step: {reason}"),
            Termination::NearestGoodEnough => {
                "converged: smallest change with a misfit below good_enough"
            }
            Termination::NearestOfTheBest => {
                "converged: smallest change among designs with nearly the least misfit"
            }
            Termination::GoodEnoughNotKnownNearest => {
                "good enough; a slightly smaller change may exist"
            }
            Termination::BestNotKnownNearest => {
                "as good as the best; a slightly smaller change may exist"
            }
            Termination::LargestYield => "converged: no small change raises the yield",
            Termination::YieldNotConverged => {
                "the yield is larger than without scatter, but may not be the largest"
            }
            Termination::NotStationary => {
                "not converged: no step improves the design, but the slope is not zero"
            }
            Termination::ConstraintsExcludeEachOther => {
                "a constraint is violated, and no small move reduces its violation"
            }
            Termination::IterationLimit => "the limit of iterations was reached",
            Termination::EvaluationLimit => "the limit of evaluations was reached",
            Termination::Interrupted => "interrupted",
        })
    }
}

/// Result of a run: end point, residuals, and reason for the end.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Values of the variables, within their bounds.
    pub x: DVector<f64>,
    /// Residuals and Jacobian at `x`.
    pub evaluation: Linearisation,
    /// Position of each variable relative to its bounds.
    pub active_bounds: Vec<ActiveBound>,
    /// Reason for the end of the run.
    pub termination: Termination,
    /// Imbalance of the optimality conditions of the last minimisation, relative to the sizes of their terms. 0 if rounding
    /// errors explain the imbalance. The last minimisation lowers either the misfit, or the distance from the design under a
    /// limit on the misfit. `None` if a search for the smallest distance is needed, but was not made or did not converge.
    pub residual: Option<f64>,
    /// The start and every iteration after it.
    pub history: Vec<Iteration>,
    /// State of the constraints, if there are any.
    pub constraints: Option<ConstraintState>,
    /// Minimum of the misfit that a search for a smaller change left. `None` without such a search, and if a misfit at or above
    /// this minimum is good enough.
    pub left: Option<DVector<f64>>,
}

/// State of constraints at the end of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstraintState {
    /// Values of the constraint rows.
    pub values: DVector<f64>,
    /// Largest violation among the constraint rows, in the unit of the rows.
    pub violation: f64,
    /// True for each row that some variable moves. The other rows count neither as satisfied nor as violated.
    pub movable: Vec<bool>,
    /// Derivative of half the sum of squared residuals with respect to each row's limit, negated. `None` if the run did not
    /// end at a minimum of this sum.
    pub multipliers: Option<Vec<f64>>,
    /// Multipliers by least squares, if they satisfy the optimality conditions. They differ from `multipliers` by more than
    /// rounding errors only if gradients are linearly dependent.
    pub alternatives: Option<Vec<f64>>,
    /// Rows and bounds that contradict one another, if there are any.
    pub culprits: Vec<Held>,
}

impl ConstraintState {
    /// Returns true if a row counts as satisfied or violated: some variable moves it.
    pub(super) fn counts(&self, row: usize) -> bool {
        self.movable.get(row).copied().unwrap_or(true)
    }
}

impl Fit {
    /// Largest violation of the constraints; 0 without constraints.
    pub(super) fn violation(&self) -> f64 {
        self.constraints.as_ref().map_or(0.0, |c| c.violation)
    }

    /// Returns true if all constraints are satisfied.
    pub fn is_feasible(&self) -> bool {
        self.violation() <= KEPT
    }

    /// Describes the reason for the end of the run in words. If the run did not converge, adds the imbalance of the optimality
    /// conditions. Does not add it after a request to stop, or if constraints contradict one another.
    pub fn ended(&self) -> String {
        let is_short = matches!(
            self.termination,
            Termination::Interrupted | Termination::ConstraintsExcludeEachOther
        );
        match self.residual {
            Some(residual) if !self.termination.at_minimum() && !is_short => {
                format!("{} (KKT residual {residual:.1e})", self.termination)
            }
            _ => self.termination.to_string(),
        }
    }

    /// Root mean square of the residuals.
    pub fn misfit(&self) -> f64 {
        self.evaluation.misfit()
    }

    /// Number of evaluations made, failed ones included.
    pub fn evaluations(&self) -> u64 {
        evaluations(&self.history)
    }

    /// Adds an iteration without progress: a search for a better point that found none.
    pub(super) fn add_search(&mut self, evaluations: u64) {
        let held = self.history.last().map_or(0, |i| i.held);
        self.history.push(Iteration {
            iteration: self.history.last().map_or(0, |i| i.iteration + 1),
            held,
            evaluations: u32::try_from(evaluations).unwrap_or(u32::MAX),
            ..Iteration::at(&self.evaluation)
        });
    }
}

/// Minimises from `start`, or from the nearest point within `bounds`. `index` is the number of this start. An error gives
/// the reason why there are no residuals at this point.
pub fn fit(
    index: usize,
    problem: impl LeastSquares,
    bounds: &Bounds,
    start: &DVector<f64>,
    options: &Options,
    control: Control<'_>,
) -> Result<Fit, Infeasible> {
    let solver = LevenbergMarquardt::new(bounds, options, control, index);
    let (solver, state) = execute(problem, solver, bounds, start)?;
    Ok(solver.into_fit(state))
}
