//! Levenberg-Marquardt between bounds, as a solver for argmin.
//!
//! At x, with residuals r and Jacobian J, the step d = W s (W the widths of the ranges) is
//!
//! ```text
//! s = argmin |J W s + r|^2 + damping |s|^2   over all s that keep x + W s in the box       (1)
//! damping = max( mu |r|^2, drift |J W| |r| )                                               (2)
//! ```
//!
//! (1) is solved exactly ([`BoundedLeastSquares`]). Damping in proportion to |r|^2 makes the method
//! converge quadratically to a zero of r even where zeros are not isolated, so that J has no full
//! rank (Ch. Kanzow, N. Yamashita, M. Fukushima, Levenberg-Marquardt methods with strong local
//! convergence properties for solving nonlinear equations with convex constraints, J. Comput. Appl.
//! Math. 172, 2004); mu follows the ratio of the reduction found to the one predicted (J. Fan,
//! Y. Yuan, On the quadratic convergence of the Levenberg-Marquardt method without nonsingularity
//! assumption, Computing 74, 2005). No rank has to be decided: directions the residuals do not see
//! have no gradient, and damping leaves them alone.
//!
//! The second term of (2) sees to it that they are left alone in finite precision as well. Rounding
//! turns the zero singular value of such a direction into one of about e |J W|, e being the machine
//! precision, with a left vector that may well see r: the step along it is up to e |J W| |r| /
//! damping. The term bounds that by [`DRIFT`] of the range. It vanishes with r, too, and so does not
//! spoil the convergence.

use super::{
    BoundedLeastSquares, Bounds, Control, Evaluation, Fit, Hold, Infeasible, Iteration,
    LeastSquares, Termination,
};
use argmin::core::{Error, IterState, KV, Problem, Solver, TerminationReason, TerminationStatus};
use argmin::kv;
use nalgebra::DVector;
use std::sync::atomic::Ordering;

/// When to stop. Each is an inequality; the first that holds ends the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// misfit <= this, the misfit being the root mean square of the residuals, in tolerances. The
    /// default is the rounding of curves that are some thousand tolerances high. Below it, fits are
    /// equally good.
    pub misfit_below: f64,
    /// Reductions of the cost, both predicted and found, <= this times the cost. The default, 1e-10,
    /// leaves the misfit right to ten digits; a minimum with zero misfit is found to the last digit
    /// whatever this is, because the cost keeps falling by large fractions of itself.
    pub reduction_below: f64,
    /// max_j |step_j| / range_j <= this. The default is the rounding of a coordinate up to sixteen
    /// times as large as the range it moves in.
    pub step_below: f64,
    /// |r . column_j| <= this |r| |column_j| for all columns of the Jacobian whose variable is free to
    /// descend. The default is the rounding of that inner product over some thousand residuals.
    pub gradient_below: f64,
    /// iterations >= this.
    pub max_iterations: u64,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            misfit_below: 4096.0 * f64::EPSILON,
            reduction_below: 1e-10,
            step_below: 16.0 * f64::EPSILON,
            gradient_below: 64.0 * f64::EPSILON,
            max_iterations: 200,
        }
    }
}

/// The fraction of its range a direction that the residuals do not see may move by in one step,
/// because of the rounding of J.
const DRIFT: f64 = 1e-6;
/// First damping, relative to the square of the longest column of J W: the directions it affects are
/// those seen thirty times less than the best.
const FIRST_DAMPING: f64 = 1e-3;
/// A step is accepted from this ratio of the reduction found to the one predicted.
const ACCEPTABLE: f64 = 1e-4;
/// Below this ratio damping grows for the next step, above the other it falls.
const POOR: f64 = 0.25;
const GOOD: f64 = 0.75;

/// What argmin keeps of a run: the variables and the cost.
pub type State = IterState<DVector<f64>, (), (), (), (), f64>;

/// The solver. One iteration makes one accepted step, after as many trials as that takes.
pub struct LevenbergMarquardt<'a> {
    bounds: &'a Bounds,
    options: &'a Options,
    control: Control<'a>,
    start: usize,
    /// mu of (2).
    damping_factor: f64,
    /// At the variables of the state.
    current: Evaluation,
    trial: Evaluation,
    trial_x: DVector<f64>,
    subproblem: BoundedLeastSquares,
    /// Bounds of the step, in fractions of the ranges.
    lower: Vec<f64>,
    upper: Vec<f64>,
    termination: Option<Termination>,
    history: Vec<Iteration>,
}

impl<'a> LevenbergMarquardt<'a> {
    /// A solver within `bounds`, for the start number `start`.
    pub fn new(
        bounds: &'a Bounds,
        options: &'a Options,
        control: Control<'a>,
        start: usize,
    ) -> Self {
        let n = bounds.variables();
        LevenbergMarquardt {
            bounds,
            options,
            control,
            start,
            damping_factor: 0.0,
            current: Evaluation::new(0, n),
            trial: Evaluation::new(0, n),
            trial_x: DVector::zeros(n),
            subproblem: BoundedLeastSquares::new(n, 0),
            lower: vec![0.0; n],
            upper: vec![0.0; n],
            termination: None,
            history: Vec::new(),
        }
    }

    /// What the run came to.
    pub(super) fn into_fit(self, state: State) -> Fit {
        let x = state.param.expect("the state was given its start");
        Fit {
            holds: self.bounds.holds(&x),
            x,
            evaluation: self.current,
            termination: self.termination.expect("a run ends for a reason"),
            history: self.history,
        }
    }

    /// Prepares the sub-problem at the current point and tests whether that is a minimum.
    fn arrive(&mut self, x: &DVector<f64>) {
        let (bounds, current) = (self.bounds, &self.current);
        self.subproblem
            .reduce(&current.jacobian, bounds.width(), &current.residuals);
        for j in 0..x.len() {
            self.lower[j] = (bounds.lower()[j] - x[j]) / bounds.width()[j];
            self.upper[j] = (bounds.upper()[j] - x[j]) / bounds.width()[j];
        }
        if current.misfit() <= self.options.misfit_below {
            self.termination = Some(Termination::MisfitReached);
        } else if self.is_stationary() {
            self.termination = Some(Termination::Stationary);
        }
    }

    fn is_stationary(&self) -> bool {
        let size = self.current.residuals.norm();
        (0..self.lower.len()).all(|j| {
            let slope = self.subproblem.gradient(j);
            let blocked =
                (slope > 0.0 && self.lower[j] == 0.0) || (slope < 0.0 && self.upper[j] == 0.0);
            let column = self.subproblem.column_norms()[j];
            blocked || slope.abs() <= self.options.gradient_below * size * column
        })
    }

    /// Where the step of the sub-problem leads; on a bound exactly where it holds a variable.
    fn take_trial_point(&mut self, x: &DVector<f64>) {
        let (step, holds) = (self.subproblem.step(), self.subproblem.holds());
        for j in 0..x.len() {
            let (lower, upper) = (self.bounds.lower()[j], self.bounds.upper()[j]);
            self.trial_x[j] = match holds[j] {
                Hold::Lower => lower,
                Hold::Upper => upper,
                Hold::Free => (x[j] + self.bounds.width()[j] * step[j]).clamp(lower, upper),
            };
        }
    }

    /// Raises the damping until the step is at most half as long.
    fn shorten(&mut self, damping: &mut f64) {
        let length = norm(self.subproblem.step());
        // Growing growth, as the damping may be many decades below where it begins to tell.
        let mut growth = 4.0;
        while norm(self.subproblem.step()) > 0.5 * length {
            *damping *= growth;
            growth *= 2.0;
            self.subproblem.solve(*damping, &self.lower, &self.upper);
        }
    }

    fn record(&mut self, iteration: Iteration) -> KV {
        let log = kv!(
            "misfit" => iteration.misfit;
            "step" => iteration.step;
            "damping" => iteration.damping;
            "held" => iteration.held as u64;
            "rejected" => u64::from(iteration.rejected);
            "infeasible" => u64::from(iteration.infeasible);
        );
        if let Some(watch) = self.control.watch {
            watch(self.start, &iteration);
        }
        self.history.push(iteration);
        log
    }
}

impl<P: LeastSquares> Solver<P, State> for LevenbergMarquardt<'_> {
    fn name(&self) -> &str {
        "bounded Levenberg-Marquardt"
    }

    fn init(
        &mut self,
        problem: &mut Problem<P>,
        state: State,
    ) -> Result<(State, Option<KV>), Error> {
        let problem = of(problem);
        let (m, n) = (problem.residuals(), problem.variables());
        assert_eq!(n, self.bounds.variables(), "one range per variable");
        self.current = Evaluation::new(m, n);
        self.trial = Evaluation::new(m, n);
        self.subproblem = BoundedLeastSquares::new(n, m);

        let x = state.param.as_ref().expect("the state was given its start");
        problem.evaluate(x, &mut self.current)?;
        self.current.check()?;
        self.arrive(x);
        let longest = self
            .subproblem
            .column_norms()
            .iter()
            .copied()
            .fold(0.0, f64::max);
        let cost = self.current.cost();
        self.damping_factor = FIRST_DAMPING * longest * longest / (2.0 * cost);
        let log = self.record(Iteration {
            iteration: 0,
            cost,
            misfit: self.current.misfit(),
            step: 0.0,
            damping: 0.0,
            held: count_held(&self.bounds.holds(x)),
            rejected: 0,
            infeasible: 0,
        });
        Ok((state.cost(cost), Some(log)))
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<P>,
        mut state: State,
    ) -> Result<(State, Option<KV>), Error> {
        let problem = of(problem);
        let x = state.take_param().expect("the state was given its start");
        let cost = self.current.cost();
        let size = (2.0 * cost).sqrt();
        let norms = DVector::from_column_slice(self.subproblem.column_norms());
        let mut damping =
            (self.damping_factor * 2.0 * cost).max(f64::EPSILON / DRIFT * norms.norm() * size);
        let (mut rejected, mut infeasible) = (0, 0);
        let mut obstacle: Option<Infeasible> = None;
        let mut accepted = false;

        self.subproblem.solve(damping, &self.lower, &self.upper);
        while !accepted && self.termination.is_none() {
            if largest(self.subproblem.step()) <= self.options.step_below {
                self.termination = Some(match obstacle.take() {
                    Some(reason) => Termination::NoFeasibleStep(reason),
                    None => Termination::StepBelowResolution,
                });
                break;
            }
            self.take_trial_point(&x);
            let evaluated = problem
                .evaluate(&self.trial_x, &mut self.trial)
                .and_then(|()| self.trial.check());
            if let Err(reason) = evaluated {
                infeasible += 1;
                obstacle = Some(reason);
                self.shorten(&mut damping);
                continue;
            }
            let predicted = 0.5 * self.subproblem.predicted_reduction();
            let found = cost - self.trial.cost();
            let ratio = found / predicted;
            let negligible = self.options.reduction_below * cost;
            if obstacle.is_none() && predicted <= negligible && found.abs() <= negligible {
                self.termination = Some(Termination::NoFurtherDescent);
            }
            // A step that ends the run is taken if it descends at all.
            accepted = ratio >= ACCEPTABLE || (self.termination.is_some() && found > 0.0);
            if accepted {
                let change = match ratio {
                    ratio if ratio < POOR => 4.0,
                    ratio if ratio > GOOD => 0.1,
                    _ => 1.0,
                };
                self.damping_factor = change * damping / (2.0 * cost);
            } else {
                rejected += 1;
                if self.termination.is_none() {
                    self.shorten(&mut damping);
                }
            }
        }

        let mut step = 0.0;
        let mut next = x;
        if accepted {
            step = norm(self.subproblem.step());
            std::mem::swap(&mut next, &mut self.trial_x);
            std::mem::swap(&mut self.current, &mut self.trial);
            let ended = self.termination.take();
            self.arrive(&next);
            self.termination = self.termination.take().or(ended);
        }
        let cost = self.current.cost();
        let log = self.record(Iteration {
            iteration: state.iter + 1,
            cost,
            misfit: self.current.misfit(),
            step,
            damping,
            held: count_held(&self.bounds.holds(&next)),
            rejected,
            infeasible,
        });
        Ok((state.param(next).cost(cost), Some(log)))
    }

    fn terminate(&mut self, state: &State) -> TerminationStatus {
        if self.termination.is_none() {
            let interrupted = self.control.interrupt;
            if interrupted.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
                self.termination = Some(Termination::Interrupted);
            } else if state.iter >= self.options.max_iterations {
                self.termination = Some(Termination::IterationLimit);
            }
        }
        match &self.termination {
            None => TerminationStatus::NotTerminated,
            Some(reason) => TerminationStatus::Terminated(match reason {
                Termination::Interrupted => TerminationReason::Interrupt,
                Termination::IterationLimit => TerminationReason::MaxItersReached,
                Termination::MisfitReached => TerminationReason::TargetCostReached,
                Termination::NoFeasibleStep(_) => TerminationReason::SolverExit(reason.to_string()),
                _ => TerminationReason::SolverConverged,
            }),
        }
    }
}

/// The problem itself. argmin lends it as `&P` and counts calls by name; its evaluation has a
/// workspace, and the history counts.
fn of<P>(problem: &mut Problem<P>) -> &mut P {
    problem
        .problem
        .as_mut()
        .expect("argmin gives the problem back")
}

fn norm(step: &[f64]) -> f64 {
    step.iter().map(|s| s * s).sum::<f64>().sqrt()
}

fn largest(step: &[f64]) -> f64 {
    step.iter().fold(0.0, |largest, s| s.abs().max(largest))
}

fn count_held(holds: &[Hold]) -> usize {
    holds.iter().filter(|&&hold| hold != Hold::Free).count()
}
