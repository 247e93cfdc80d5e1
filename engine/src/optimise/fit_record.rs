//! Common parts of every method here. argmin runs the method, and the record keeps its iterations and the reason for
//! its end. Only this module calls argmin.

use super::{ActiveBound, Bounds, Control, Infeasible, Iteration, Options, Termination};
use argmin::core::{Executor, IterState, Problem, Solver, TerminationReason, TerminationStatus};
use nalgebra::DVector;

/// State of a run in argmin: the variables and the cost.
pub type ArgminState = IterState<DVector<f64>, (), (), (), (), f64>;

/// Runs a solver from the point of the box nearest to `start`; an error says why there are no residuals even
/// there.
pub(super) fn execute<P, S: Solver<P, ArgminState>>(
    problem: P,
    solver: S,
    bounds: &Bounds,
    start: &DVector<f64>,
) -> Result<(S, ArgminState), Infeasible> {
    let result = Executor::new(problem, solver)
        .configure(|state| state.param(bounds.nearest(start)))
        // The process has one handler for Ctrl-C, and it is not argmin's.
        .ctrlc(false)
        .timer(false)
        .run();
    match result {
        Ok(result) => Ok((result.solver, result.state)),
        Err(error) => Err(error
            .downcast()
            .expect("the only error of a solver is that of its start")),
    }
}

/// The problem itself. argmin lends it as `&P` and counts calls by name; its evaluation has a
/// workspace, and the history counts.
pub(super) fn of<P>(problem: &mut Problem<P>) -> &mut P {
    problem
        .problem
        .as_mut()
        .expect("argmin gives the problem back")
}

/// Record of a run: its start, its iterations and the reason for its end.
pub(super) struct FitRecord<'a> {
    pub bounds: &'a Bounds,
    pub options: &'a Options,
    control: Control<'a>,
    start: usize,
    termination: Option<Termination>,
    history: Vec<Iteration>,
    evaluations: u64,
}

impl<'a> FitRecord<'a> {
    /// The course of the run from start number `start`, before its first iteration.
    pub(super) fn new(
        bounds: &'a Bounds,
        options: &'a Options,
        control: Control<'a>,
        start: usize,
    ) -> Self {
        FitRecord {
            bounds,
            options,
            control,
            start,
            termination: None,
            history: Vec::new(),
            evaluations: 0,
        }
    }

    /// Returns true if one more evaluation is allowed. It counts every evaluation and obeys requests to stop. If it
    /// returns false, the run has ended.
    pub(super) fn may_evaluate(&mut self) -> bool {
        if self.control.is_interrupted() {
            self.termination = Some(Termination::Interrupted);
            return false;
        }
        if self.evaluations >= self.options.max_evaluations {
            self.termination = Some(Termination::EvaluationLimit);
            return false;
        }
        self.evaluations += 1;
        true
    }

    /// Returns true if the run has ended.
    pub(super) fn has_ended(&self) -> bool {
        self.termination.is_some()
    }

    /// Ends the run after the iteration under way.
    pub(super) fn end(&mut self, reason: Termination) {
        self.termination = Some(reason);
    }

    /// Why the run ended, given its residual of the optimality conditions, and its iterations.
    pub(super) fn finished(self, residual: f64) -> (Termination, Vec<Iteration>) {
        let reason = self.termination.expect("a run ends for a reason");
        (reason.checked(residual), self.history)
    }

    /// Records an iteration that ended at `x`, in the history and for the control. argmin's own log would be for its
    /// observers, and there are none.
    pub(super) fn add(&mut self, x: &DVector<f64>, mut iteration: Iteration) {
        let active_bounds = self.bounds.active_bounds(x);
        let held = active_bounds
            .iter()
            .filter(|hold| **hold != ActiveBound::Free);
        iteration.held = held.count();
        if let Some(watch) = self.control.watch {
            watch(self.start, &iteration);
        }
        self.history.push(iteration);
    }

    /// Tells argmin after every iteration if the run continues.
    pub(super) fn status(&mut self, state: &ArgminState) -> TerminationStatus {
        if self.termination.is_none() {
            if self.control.is_interrupted() {
                self.termination = Some(Termination::Interrupted);
            } else if state.iter >= self.options.max_iterations {
                self.termination = Some(Termination::IterationLimit);
            }
        }
        match &self.termination {
            None => TerminationStatus::NotTerminated,
            // In our words: argmin's own are fewer, and nobody asks it.
            Some(reason) => {
                let reason = TerminationReason::SolverExit(reason.to_string());
                TerminationStatus::Terminated(reason)
            }
        }
    }
}

/// Number of evaluations of a run, failed ones included.
pub(super) fn evaluations(history: &[Iteration]) -> u64 {
    history.iter().map(|i| u64::from(i.evaluations)).sum()
}
