//! Common parts of every method here: the loop, and the record of iterations and of the reason for the end.

use super::{ActiveBound, Bounds, Control, Infeasible, Iteration, Options, Termination};
use nalgebra::DVector;

/// A method that minimises a problem `P` step by step.
pub(super) trait Method<'a, P> {
    /// Evaluates the start. An error says why there are no residuals there.
    fn begin(&mut self, problem: &mut P, x: &DVector<f64>) -> Result<(), Infeasible>;

    /// Makes one accepted step, or ends the run. `done` is the number of iterations before.
    fn iterate(&mut self, problem: &mut P, x: DVector<f64>, done: u64) -> DVector<f64>;

    /// The record of the run.
    fn record(&mut self) -> &mut FitRecord<'a>;
}

/// Runs a method from the point of the box nearest to `start`. Returns the last point; an error says why there are no
/// residuals even at the start.
pub(super) fn execute<'a, P>(
    problem: &mut P,
    method: &mut impl Method<'a, P>,
    bounds: &Bounds,
    start: &DVector<f64>,
) -> Result<DVector<f64>, Infeasible> {
    let mut x = bounds.nearest(start);
    method.begin(problem, &x)?;
    let mut done = 0;
    while method.record().goes_on(done) {
        x = method.iterate(problem, x, done);
        done += 1;
    }
    Ok(x)
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

    /// Records an iteration that ended at `x`, in the history and for the control.
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

    /// Returns true if the run continues after so many iterations.
    fn goes_on(&mut self, done: u64) -> bool {
        if self.termination.is_none() {
            if self.control.is_interrupted() {
                self.termination = Some(Termination::Interrupted);
            } else if done >= self.options.max_iterations {
                self.termination = Some(Termination::IterationLimit);
            }
        }
        self.termination.is_none()
    }
}

/// Number of evaluations of a run, failed ones included.
pub(super) fn evaluations(history: &[Iteration]) -> u64 {
    history.iter().map(|i| u64::from(i.evaluations)).sum()
}
