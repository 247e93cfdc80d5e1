//! A minimum from one start, and the history of the search.

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

/// Means to stop a run, and to watch it.
#[derive(Clone, Copy, Default)]
pub struct Control<'a> {
    /// Once true, the run ends before its next evaluation, with its present result.
    pub interrupt: Option<&'a AtomicBool>,
    /// Called after each iteration; where several starts run in parallel, from their threads.
    pub watch: Option<&'a ProgressCallback<'a>>,
}

impl Control<'_> {
    /// Returns true if a run is to end.
    pub(super) fn is_interrupted(&self) -> bool {
        Interrupt(self.interrupt).is_raised()
    }
}

/// Receives the index of a start and its latest iteration.
pub type ProgressCallback<'a> = dyn Fn(usize, &Iteration) + Sync + 'a;

/// One iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Iteration {
    /// Number; 0 is the start.
    pub iteration: u64,
    /// Half the sum of the squared residuals, at its end.
    pub cost: f64,
    /// The root mean square of the residuals, at its end.
    pub misfit: f64,
    /// Length of the accepted step in fractions of the ranges; 0 where none was accepted.
    pub step: f64,
    /// Damping of its last trial.
    pub damping: f64,
    /// Variables at bounds, at its end.
    pub held: usize,
    /// Points evaluated on the way.
    pub evaluations: u32,
    /// Number of those evaluations without residuals.
    pub infeasible: u32,
}

impl Iteration {
    /// Returns the start, or an iteration without progress: it ends with this evaluation.
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

/// Why a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Termination {
    /// The misfit is not above [`Options::misfit_below`].
    MisfitReached,
    /// The misfit of the targets that variables move is not above [`Options::misfit_below`]; others are missed.
    MovedTargetsMet,
    /// No step lowers the cost by more than [`Options::reduction_below`] of it.
    NoFurtherDescent,
    /// The step would be shorter than [`Options::step_below`].
    StepBelowResolution,
    /// The residuals are at right angles to all columns of the Jacobian, but for variables that
    /// their bounds keep from descending: [`Options::gradient_below`].
    Stationary,
    /// Every step that would lower the cost, however short, leads where there are no residuals.
    NoFeasibleStep(Infeasible),
    /// The design is good enough, and no other one nearby that is moves less.
    NearestGoodEnough,
    /// No design is good enough. This one is as good as the best, and no other one nearby that is moves less.
    NearestOfTheBest,
    /// The design is good enough, but the search for a nearer one did not converge.
    GoodEnoughNotKnownNearest,
    /// No design is good enough. This one is as good as the best, but the search for a nearer one did not converge.
    BestNotKnownNearest,
    /// No step lowers the cost by more than [`Options::reduction_below`] of it, or it would be shorter than
    /// [`Options::step_below`], yet the optimality conditions are not met.
    NotStationary,
    /// No small move raises the yield.
    LargestYield,
    /// The yield is above that of the optimum without scatter, but the search for the largest did not converge.
    YieldNotConverged,
    /// No small move lessens the violation of the constraints.
    ConstraintsExcludeEachOther,
    /// [`Options::max_iterations`] iterations were made.
    IterationLimit,
    /// [`Options::max_evaluations`] evaluations were made.
    EvaluationLimit,
    /// The run was asked to stop.
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

    /// The same end, seen with the residual of the optimality conditions: only where that is below [`CONVERGED`] it is
    /// a minimum.
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
                "converged: all targets that a variable moves are met, the others are missed"
            }
            Termination::NoFurtherDescent => "converged: no further descent",
            Termination::StepBelowResolution => "converged: the step is below resolution",
            Termination::Stationary => "converged: stationary between the bounds",
            Termination::NoFeasibleStep(reason) => return write!(f, "no feasible step: {reason}"),
            Termination::NearestGoodEnough => "converged: smallest change that is good enough",
            Termination::NearestOfTheBest => "converged: smallest change among the best designs",
            Termination::GoodEnoughNotKnownNearest => {
                "good enough, not known to be the smallest change"
            }
            Termination::BestNotKnownNearest => {
                "as good as the best, not known to be the smallest change"
            }
            Termination::LargestYield => "converged: no small change raises the yield",
            Termination::YieldNotConverged => {
                "a larger yield than without scatter, not known to be the largest"
            }
            Termination::NotStationary => {
                "not converged: no step improves the design, but the slope is not zero"
            }
            Termination::ConstraintsExcludeEachOther => "the constraints exclude one another",
            Termination::IterationLimit => "the limit of iterations was reached",
            Termination::EvaluationLimit => "the limit of evaluations was reached",
            Termination::Interrupted => "interrupted",
        })
    }
}

/// End of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The variables, within their bounds.
    pub x: DVector<f64>,
    /// Residuals and Jacobian at `x`.
    pub evaluation: Linearisation,
    /// Position of each variable relative to its bounds.
    pub active_bounds: Vec<ActiveBound>,
    /// Reason for the end.
    pub termination: Termination,
    /// Residual of the optimality conditions of the last minimisation, relative to the sizes of their terms. The run
    /// minimised the misfit, or the distance from the design at a limited misfit. 0 at a minimum.
    pub residual: f64,
    /// The start and every iteration after it.
    pub history: Vec<Iteration>,
    /// State of the constraints, if there are any.
    pub constraints: Option<ConstraintState>,
}

/// State of constraints at the end of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstraintState {
    /// The rows.
    pub values: DVector<f64>,
    /// The largest violation.
    pub violation: f64,
    /// Rows that some variable moves; the others count neither as kept nor as violated.
    pub movable: Vec<bool>,
    /// The derivative of half the sum of squared residuals by each row's limit, negated; `None` if the run did not end
    /// at a minimum of that sum.
    pub multipliers: Option<Vec<f64>>,
    /// Other multipliers that are as good: gradients that depend on one another share the push out in any way.
    pub alternatives: Option<Vec<f64>>,
    /// Rows and bounds that exclude one another, if there are such.
    pub culprits: Vec<Held>,
}

impl Fit {
    /// The largest violation of the constraints, if there are any.
    pub(super) fn violation(&self) -> f64 {
        self.constraints.as_ref().map_or(0.0, |c| c.violation)
    }

    /// Returns true if the constraints, if there are any, are kept.
    pub fn is_feasible(&self) -> bool {
        self.violation() <= KEPT
    }

    /// Returns the reason for the end in words, with the residual of the optimality conditions if the run did not
    /// converge.
    pub fn ended(&self) -> String {
        let is_short = matches!(
            self.termination,
            Termination::Interrupted | Termination::ConstraintsExcludeEachOther
        );
        match self.termination.at_minimum() || is_short {
            true => self.termination.to_string(),
            false => format!("{} (KKT residual {:.1e})", self.termination, self.residual),
        }
    }

    /// The root mean square of the residuals.
    pub fn misfit(&self) -> f64 {
        self.evaluation.misfit()
    }

    /// Number of evaluations made, failed ones included.
    pub fn evaluations(&self) -> u64 {
        evaluations(&self.history)
    }
}

/// Minimises from the point of the box nearest to `start`, which is the start of number `index`. Errors if there are no
/// residuals even there.
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
