//! Common parts of all minimisation methods in this folder. argmin runs the method; the record keeps the iterations of the
//! run and the reason for the end of the run. Only this module calls argmin.

use super::{ActiveBound, Bounds, Control, Infeasible, Iteration, Options, Termination};
use argmin::core::{Executor, IterState, Problem, Solver, TerminationReason, TerminationStatus};
use nalgebra::DVector;

/// State of a run in argmin: the variables and the cost.
pub type ArgminState = IterState<DVector<f64>, (), (), (), (), f64>;

/// Runs a solver from `start`, or from the nearest point within `bounds`. An error gives the reason why there are no
/// residuals at this point.
pub(super) fn execute<P, S: Solver<P, ArgminState>>(
    problem: P,
    solver: S,
    bounds: &Bounds,
    start: &DVector<f64>,
) -> Result<(S, ArgminState), Infeasible> {
    let result = Executor::new(problem, solver)
        .configure(|state| state.param(bounds.nearest(start)))
        // The process has its own handler for Ctrl-C, so argmin must not install one.
        .ctrlc(false)
        .timer(false)
        .run();
    match result {
        Ok(result) => Ok((result.solver, result.state)),
        Err(error) => Err(error.downcast().expect("a solver fails only at its start")),
    }
}

/// Returns the problem for an evaluation. argmin gives access only through `&P`, but an evaluation needs `&mut` access to
/// the workspace of the problem. The history counts the calls.
pub(super) fn of<P>(problem: &mut Problem<P>) -> &mut P {
    problem
        .problem
        .as_mut()
        .expect("argmin returns the problem")
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
    /// Makes the record of start number `start`, before its first iteration.
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

    /// Returns true if one more evaluation is allowed, and counts it. Returns false after a request to stop or at the limit;
    /// the run has then ended.
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

    /// Ends the run after the present iteration.
    pub(super) fn end(&mut self, reason: Termination) {
        self.termination = Some(reason);
    }

    /// Returns the reason for the end of the run, and its iterations. `residual` is the imbalance of the optimality
    /// conditions.
    pub(super) fn finished(self, residual: f64) -> (Termination, Vec<Iteration>) {
        let reason = self.termination.expect("a run ends for a reason");
        (reason.checked(residual), self.history)
    }

    /// Records an iteration that ended at `x` in the history, and reports it to the observer. The log of argmin stays empty.
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

    /// Reports to argmin after every iteration whether the run continues.
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
            // argmin receives only the text of the reason. argmin's own list of reasons is shorter, and no code reads it.
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
