//! Levenberg-Marquardt between bounds, as a solver for argmin.
//!
//! At x, with residuals r and Jacobian J, the step d = W s (W the widths of the ranges) is
//!
//! ```text
//! s = argmin |J W s + r|^2 + damping |s|^2   over all s that keep x + W s in the box       (1)
//! damping = max( mu |r|^2, drift |J W| |r| )                                               (2)
//! ```
//!
//! where drift = eps / [`DRIFT`], and eps is the machine precision. (1) is solved exactly (`BoundedLeastSquares`). With
//! damping proportional to |r|^2 the method converges quadratically to a zero of r. This holds even if zeros are not isolated
//! and J does not have full rank (Ch. Kanzow, N. Yamashita, M. Fukushima, Levenberg-Marquardt methods with strong local
//! convergence properties for solving nonlinear equations with convex constraints, J. Comput. Appl. Math. 172, 2004). mu
//! follows the ratio of the actual reduction to the predicted one (J. Fan, Y. Yuan, On the quadratic convergence of the
//! Levenberg-Marquardt method without nonsingularity assumption, Computing 74, 2005). The method needs no decision about the
//! rank: directions that leave the residuals unchanged have no gradient, and damping does not move them.
//!
//! The second term of (2) also prevents moves along these directions that rounding would cause. Rounding turns the zero
//! singular value of such a direction into one of about eps |J W|. The left singular vector may have a component along r, so
//! the step along the direction is up to eps |J W| |r| / damping. The second term limits that step to [`DRIFT`] of the range.
//! This term goes to zero with r, so it does not slow down the convergence.
//!
//! If singular values spread over many decades, the cost has a narrow, curved valley. Steps along the floor of this valley
//! would soon become very short. Even a short step along the floor raises the cost, because the floor curves and the step
//! ends on a steep wall. So a trial that does not lower the cost is corrected before it is rejected. Newton steps move the
//! trial to the point with the residuals that the model predicted. These Newton steps e use Jacobians that the trials have
//! already computed:
//!
//! ```text
//! e = argmin |J' W e + r' - (r + J W s)|^2 + damping |e|^2     with r' and J' at the trial          (3)
//! ```
//!
//! The Newton steps continue as long as each is at most half as long as the previous one, because then Newton's method
//! converges. Unlike the cost, this test does not depend on the steepness of the walls (P. Deuflhard, Newton methods for
//! nonlinear problems, 2004, sections 3.3 and 4.3). The corrections are known as a remedy for the Maratos effect (J. Nocedal,
//! S. Wright, Numerical optimization, 2nd ed., section 18.3). Every trial that is finally accepted has a lower cost.

use super::fit_record::{ArgminState, FitRecord, of};
use super::local_model::LocalModel;
use super::stationarity::{CONVERGED, between_bounds};
use super::{
    Bounds, Control, Fit, Infeasible, Iteration, LeastSquares, Linearisation, Options, Termination,
};
use argmin::core::{Error, KV, Problem, Solver, TerminationStatus};
use nalgebra::DVector;

/// Largest move in one step, as a fraction of the range, along a direction without effect on the residuals. The rounding of
/// J causes such moves.
const DRIFT: f64 = 1e-6;
/// First damping, relative to the square of the longest column of J W. It damps directions whose effect on the residuals is
/// less than a thirtieth of the largest effect.
const FIRST_DAMPING: f64 = 1e-3;
/// Smallest accepted ratio of actual to predicted reduction of the cost. A negligible reduction is accepted at any ratio.
const ACCEPTABLE: f64 = 1e-4;
/// Ratio of actual to predicted reduction of the cost below which the damping rises for the next step.
const POOR: f64 = 0.25;
/// Ratio of actual to predicted reduction of the cost above which the damping falls for the next step.
const GOOD: f64 = 0.75;
/// Length of a step, as a fraction of the range, up to which the residuals count as linear. Along such a step, curvature changes
/// the residuals by less than the rounding errors. A kink changes them by little more than the rounding errors.
const STRAIGHT: f64 = 1e-11;
/// Largest number of corrections of a trial. Each correction is at most half as long as the previous correction. Most trials
/// converge quadratically.
const CORRECTIONS: u32 = 8;

/// The solver. One iteration makes one accepted step, after as many trials as needed.
pub struct LevenbergMarquardt<'a> {
    record: FitRecord<'a>,
    /// Factor mu of equation (2) of this module.
    damping_factor: f64,
    /// Residuals and Jacobian at the present point of the run.
    current: Linearisation,
    model: LocalModel<'a>,
    trial_x: DVector<f64>,
    trial: Linearisation,
    /// Residuals that the model predicts at the trial.
    promised: DVector<f64>,
    /// Actual residuals at the trial minus `promised`.
    excess: DVector<f64>,
    /// Linear model of `excess` for the correction of a trial by equation (3) of this module.
    correction: LocalModel<'a>,
    /// Point at the end of the correction's step.
    corrected_x: DVector<f64>,
    /// Largest norm of the deviation from the predicted residuals after a step of at most [`STRAIGHT`]. This deviation comes
    /// from rounding only.
    seen_rounding: f64,
}

impl<'a> LevenbergMarquardt<'a> {
    /// Makes a solver within `bounds`, for start number `start`.
    pub fn new(
        bounds: &'a Bounds,
        options: &'a Options,
        control: Control<'a>,
        start: usize,
    ) -> Self {
        let n = bounds.variables();
        LevenbergMarquardt {
            record: FitRecord::new(bounds, options, control, start),
            damping_factor: 0.0,
            current: Linearisation::new(0, n),
            model: LocalModel::new(bounds, 0),
            trial_x: DVector::zeros(n),
            trial: Linearisation::new(0, n),
            promised: DVector::zeros(0),
            excess: DVector::zeros(0),
            correction: LocalModel::new(bounds, 0),
            corrected_x: DVector::zeros(n),
            seen_rounding: 0.0,
        }
    }

    /// Converts the finished run into its result.
    pub(super) fn into_fit(self, state: ArgminState) -> Fit {
        let x = state.param.expect("the state has a start point");
        let active_bounds = self.record.bounds.active_bounds(&x);
        let residual = self.residual(&self.current, &x);
        let (termination, history) = self.record.finished(residual);
        Fit {
            active_bounds,
            residual: Some(residual),
            x,
            evaluation: self.current,
            termination,
            history,
            constraints: None,
            left: None,
        }
    }

    /// Imbalance of the optimality conditions at a point.
    fn residual(&self, at: &Linearisation, x: &DVector<f64>) -> f64 {
        let pivot = 0.5 * self.model.scale();
        between_bounds(at, x, self.record.bounds, pivot, self.seen_rounding)
    }

    /// Prepares the model at the current point and tests that point for a minimum.
    fn rebuild_model(&mut self, x: &DVector<f64>) {
        let Linearisation {
            residuals,
            jacobian,
        } = &self.current;
        self.model.build(x, jacobian, residuals);
        let size = residuals.norm();
        if self.current.misfit() <= self.record.options.misfit_below {
            self.record.end(Termination::MisfitReached);
        } else if self
            .model
            .is_stationary(size, self.record.options.gradient_below)
        {
            self.record.end(Termination::Stationary);
        }
    }

    /// Returns the reduction of the cost that the model predicts with the smallest possible damping, `drift`. Afterwards
    /// the model again contains the step with `damping`.
    fn undamped_reduction(&mut self, drift: f64, damping: f64) -> f64 {
        self.model.solve(drift);
        let reduction = self.model.predicted_reduction();
        self.model.solve(damping);
        reduction
    }

    /// Returns true if the model predicts a reduction of the cost of at most `negligible`. A small reduction `predicted` by
    /// a damped step does not show that the point is a minimum. The predicted reduction by an undamped step must be small,
    /// too.
    fn is_flat(&mut self, predicted: f64, negligible: f64, drift: f64, damping: f64) -> bool {
        predicted <= negligible && self.undamped_reduction(drift, damping) <= negligible
    }

    /// Moves `x` to the trial point. Returns the length of the step.
    fn accept(&mut self, x: &mut DVector<f64>) -> f64 {
        let step = self.record.bounds.distance(x, &self.trial_x);
        std::mem::swap(x, &mut self.trial_x);
        std::mem::swap(&mut self.current, &mut self.trial);
        if !self.record.has_ended() {
            self.rebuild_model(x);
        }
        step
    }

    /// Ends the run, because a step no longer changes the variables visibly.
    fn end_below_resolution(&mut self, obstacle: Option<Infeasible>) {
        self.record.end(match obstacle {
            Some(reason) => Termination::NoFeasibleStep(reason),
            None => Termination::StepBelowResolution,
        });
    }

    /// Evaluates the trial point.
    fn evaluate_trial(&mut self, problem: &mut impl LeastSquares) -> Result<(), Infeasible> {
        problem.evaluate(&self.trial_x, &mut self.trial)?;
        self.trial.check()
    }

    /// Predicts the residuals at the trial point by their slopes at `x`.
    fn promise(&mut self, x: &DVector<f64>) {
        self.corrected_x.copy_from(&self.trial_x);
        self.corrected_x -= x;
        self.promised.copy_from(&self.current.residuals);
        self.promised
            .gemv(1.0, &self.current.jacobian, &self.corrected_x, 1.0);
    }

    /// Stores the deviation from the predicted residuals as the rounding error of the residuals, if the step from `x` to the
    /// trial is at most [`STRAIGHT`].
    fn note_rounding(&mut self, x: &DVector<f64>) {
        if self.model.largest_component() <= STRAIGHT {
            self.promise(x);
            self.promised -= &self.trial.residuals;
            self.seen_rounding = self.seen_rounding.max(self.promised.norm());
        }
    }

    /// Corrects a trial reached from `x` until the cost is at most `goal`. The function stops if a correction is more than
    /// half as long as the previous correction. Returns the number of evaluated points. The second value is an error if a
    /// point has no residuals.
    fn correct(
        &mut self,
        problem: &mut impl LeastSquares,
        x: &DVector<f64>,
        damping: f64,
        goal: f64,
    ) -> (u32, Result<(), Infeasible>) {
        let mut length = self.model.step_length();
        self.promise(x);
        for evaluations in 0..CORRECTIONS {
            self.excess.copy_from(&self.trial.residuals);
            self.excess -= &self.promised;
            let (model, x) = (&mut self.correction, &mut self.trial_x);
            model.build(x, &self.trial.jacobian, &self.excess);
            model.solve(damping);
            if self.trial.cost() <= goal || model.step_length() > 0.5 * length {
                return (evaluations, Ok(()));
            }
            if !self.record.may_evaluate() {
                return (evaluations, Ok(()));
            }
            length = model.step_length();
            model.step_from(x, &mut self.corrected_x);
            std::mem::swap(x, &mut self.corrected_x);
            if let Err(reason) = self.evaluate_trial(problem) {
                return (evaluations + 1, Err(reason));
            }
        }
        (CORRECTIONS, Ok(()))
    }
}

/// Factor by which an accepted step changes the damping. `ratio` is the actual reduction of the cost divided by the
/// predicted reduction.
fn change_of_damping(ratio: f64, shortened: bool) -> f64 {
    match ratio {
        ratio if ratio < POOR => 4.0,
        ratio if ratio > GOOD && !shortened => 0.1,
        _ => 1.0,
    }
}

impl<P: LeastSquares> Solver<P, ArgminState> for LevenbergMarquardt<'_> {
    fn name(&self) -> &str {
        "bounded Levenberg-Marquardt"
    }

    fn init(
        &mut self,
        problem: &mut Problem<P>,
        state: ArgminState,
    ) -> Result<(ArgminState, Option<KV>), Error> {
        let problem = of(problem);
        let (m, n) = (problem.residuals(), problem.variables());
        assert_eq!(n, self.record.bounds.variables(), "one range per variable");
        self.current = Linearisation::new(m, n);
        self.trial = Linearisation::new(m, n);
        self.model = LocalModel::new(self.record.bounds, m);
        self.correction = LocalModel::new(self.record.bounds, m);
        self.promised = DVector::zeros(m);
        self.excess = DVector::zeros(m);

        let x = state.param.as_ref().expect("the state has a start point");
        problem.evaluate(x, &mut self.current)?;
        self.current.check()?;
        self.rebuild_model(x);
        let longest = self.model.longest_column();
        let cost = self.current.cost();
        self.damping_factor = FIRST_DAMPING * longest * longest / (2.0 * cost);
        self.record.add(x, Iteration::at(&self.current));
        Ok((state.cost(cost), None))
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<P>,
        mut state: ArgminState,
    ) -> Result<(ArgminState, Option<KV>), Error> {
        let problem = of(problem);
        let mut x = state.take_param().expect("the state has a start point");
        let cost = self.current.cost();
        let negligible = self.record.options.reduction_below * cost;
        let drift = f64::EPSILON / DRIFT * self.model.norm() * (2.0 * cost).sqrt();
        let mut damping = drift.max(self.damping_factor * 2.0 * cost);
        let (mut evaluations, mut infeasible) = (0, 0);
        let mut obstacle = None;
        let mut shortened = false;
        let mut step = 0.0;

        self.model.solve(damping);
        loop {
            if self.model.largest_component() <= self.record.options.step_below {
                self.end_below_resolution(obstacle);
                break;
            }
            if !self.record.may_evaluate() {
                break;
            }
            self.model.step_from(&x, &mut self.trial_x);
            evaluations += 1;
            if let Err(reason) = self.evaluate_trial(problem) {
                infeasible += 1;
                obstacle = Some(reason);
                self.model.shorten(&mut damping);
                shortened = true;
                continue;
            }
            self.note_rounding(&x);
            let predicted = self.model.predicted_reduction();
            let found = cost - self.trial.cost();
            let is_negligible = obstacle.is_none()
                && found.abs() <= negligible
                && self.is_flat(predicted, negligible, drift, damping);
            // A point whose slope exceeds rounding errors is not a minimum, as long as steps still lower the misfit.
            let at_end = is_negligible
                && (found <= 0.0 || self.residual(&self.trial, &self.trial_x) < CONVERGED);
            if at_end {
                self.record.end(Termination::NoFurtherDescent);
            }
            let acceptable = |found: f64| found > 0.0 && found >= ACCEPTABLE * predicted;
            let mut accepted = acceptable(found) || (is_negligible && found > 0.0);
            if !accepted && !at_end {
                let goal = cost - POOR * predicted;
                let (more, outcome) = self.correct(problem, &x, damping, goal);
                evaluations += more;
                infeasible += u32::from(outcome.is_err());
                accepted = outcome.is_ok() && acceptable(cost - self.trial.cost());
            }
            if accepted {
                let change = change_of_damping((cost - self.trial.cost()) / predicted, shortened);
                self.damping_factor = change * damping / (2.0 * cost);
                step = self.accept(&mut x);
            }
            if accepted || self.record.has_ended() {
                break;
            }
            self.model.shorten(&mut damping);
            shortened = true;
        }

        let iteration = Iteration {
            iteration: state.iter + 1,
            step,
            damping,
            evaluations,
            infeasible,
            ..Iteration::at(&self.current)
        };
        self.record.add(&x, iteration);
        Ok((state.param(x).cost(self.current.cost()), None))
    }

    fn terminate(&mut self, state: &ArgminState) -> TerminationStatus {
        self.record.status(state)
    }
}
