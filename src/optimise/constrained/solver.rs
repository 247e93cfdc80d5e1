//! The loop: one accepted step for each iteration of argmin.

use super::super::active_set::Held;
use super::super::levenberg_marquardt::{State, of};
use super::super::{Bounds, Control, Evaluation, Infeasible, Iteration, Options, Termination};
use super::filter::Filter;
use super::model::{ConvexModel, Proposal};
use super::{Assessment, Constrained};
use argmin::core::{Error, Executor, KV, Problem, Solver, TerminationReason, TerminationStatus};
use argmin::kv;
use nalgebra::DVector;
use std::sync::atomic::Ordering;

/// Rows violated by no more than this are kept: a millionth of what anybody would see.
pub(in crate::optimise) const KEPT: f64 = 1e-7;
/// A run ends at this share of [`Options::reduction_below`]: multipliers are right to the root of it.
const NEGLIGIBLE: f64 = 1e-2;
/// First radius, in half ranges.
const FIRST_RADIUS: f64 = 1.0;
/// A radius that holds the whole box.
const WHOLE: f64 = 4.0;
/// A step is accepted from this ratio of the reduction found to the one predicted.
const ACCEPTABLE: f64 = 1e-4;
const POOR: f64 = 0.25;
const GOOD: f64 = 0.75;
/// Iterations after which the estimate of the curvature is put to use.
const CURVED_FROM: u64 = 7;
/// A violation that the model cannot lower by more than this share of it does not shrink.
const STUCK: f64 = 1e-4;

/// Where a run under constraints ended.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstrainedFit {
    /// The variables, within their bounds.
    pub x: DVector<f64>,
    /// Everything there.
    pub at: Assessment,
    /// The largest violation there.
    pub violation: f64,
    /// The derivative of half the squared goal by each row's limit, negated: not negative but for rows
    /// that must vanish.
    pub multipliers: Vec<f64>,
    /// Likewise by bounds, per half range: negative at a lower one.
    pub bound_multipliers: Vec<f64>,
    /// Likewise by half the square of the level.
    pub level_multiplier: f64,
    /// How far slopes and multipliers are from balance, relative to their sizes.
    pub imbalance: f64,
    /// Rows that exclude one another about x, where there are such.
    pub culprits: Vec<Held>,
    /// Why it ended.
    pub termination: Termination,
    /// The start and every iteration after it.
    pub history: Vec<Iteration>,
}

impl ConstrainedFit {
    /// Number of evaluations made, failed ones included.
    pub fn evaluations(&self) -> u64 {
        let evaluations = |iteration: &Iteration| u64::from(iteration.evaluations);
        self.history.iter().map(evaluations).sum()
    }

    /// Whether rows and level are kept.
    pub fn is_feasible(&self) -> bool {
        self.violation <= KEPT
    }
}

/// Minimises from the point of the box nearest to `start`; an error says why there are no residuals
/// even there.
pub fn constrained_fit(
    index: usize,
    problem: impl Constrained,
    bounds: &Bounds,
    start: &DVector<f64>,
    options: &Options,
    control: Control<'_>,
) -> Result<ConstrainedFit, Infeasible> {
    let shape = problem.shape();
    let level = problem.level();
    let n = bounds.variables();
    let solver = SequentialConvex {
        bounds,
        options,
        control,
        start: index,
        equalities: shape.equalities,
        level,
        model: ConvexModel::new(bounds, shape.equalities, shape.rows, level),
        current: Assessment::new(shape, n),
        trial: Assessment::new(shape, n),
        trial_x: DVector::zeros(n),
        filter: Filter::new(0.0),
        radius: FIRST_RADIUS,
        culprits: Vec::new(),
        termination: None,
        history: Vec::new(),
    };
    let result = Executor::new(problem, solver)
        .configure(|state| state.param(bounds.nearest(start)))
        .ctrlc(false)
        .run();
    match result {
        Ok(result) => Ok(result.solver.into_fit(result.state)),
        Err(error) => Err(error
            .downcast()
            .expect("the only error of the solver is that of its start")),
    }
}

struct SequentialConvex<'a> {
    bounds: &'a Bounds,
    options: &'a Options,
    control: Control<'a>,
    start: usize,
    equalities: usize,
    level: f64,
    model: ConvexModel<'a>,
    current: Assessment,
    trial: Assessment,
    trial_x: DVector<f64>,
    filter: Filter,
    radius: f64,
    culprits: Vec<Held>,
    termination: Option<Termination>,
    history: Vec<Iteration>,
}

impl SequentialConvex<'_> {
    fn into_fit(mut self, state: State) -> ConstrainedFit {
        let x = state.param.expect("the state was given its start");
        // Multipliers of the end itself, not of the step that led there.
        self.model.solve(WHOLE, false);
        let imbalance = self.model.imbalance();
        let (rows, bounds, level) = self.model.multipliers();
        ConstrainedFit {
            violation: self.current.violation(self.equalities, self.level),
            multipliers: rows.to_vec(),
            bound_multipliers: bounds.to_vec(),
            level_multiplier: level,
            imbalance,
            x,
            at: self.current,
            culprits: self.culprits,
            termination: self.termination.expect("a run ends for a reason"),
            history: self.history,
        }
    }

    /// The residuals a run is told by: those held to a level, where there are any.
    fn reported(&self) -> &Evaluation {
        match self.current.level.residuals.is_empty() {
            true => &self.current.goal,
            false => &self.current.level,
        }
    }

    /// Goal and violation of a point.
    fn pair(&self, of: &Assessment) -> [f64; 2] {
        [of.goal.cost(), of.violation(self.equalities, self.level)]
    }

    fn evaluate_trial(&mut self, problem: &mut impl Constrained) -> Result<(), Infeasible> {
        problem.assess(&self.trial_x, &mut self.trial)?;
        self.trial.check()
    }

    /// Prepares the model at the current point.
    fn rebuild_model(&mut self, x: &DVector<f64>) {
        self.model.build(x, &self.current);
        let [_, violation] = self.pair(&self.current);
        if self.current.goal.misfit() <= self.options.misfit_below && violation <= KEPT {
            self.termination = Some(Termination::MisfitReached);
        }
    }

    fn record(&mut self, iteration: Iteration) -> KV {
        let log = kv!(
            "misfit" => iteration.misfit;
            "step" => iteration.step;
            "radius" => self.radius;
            "evaluations" => u64::from(iteration.evaluations);
        );
        if let Some(watch) = self.control.watch {
            watch(self.start, &iteration);
        }
        self.history.push(iteration);
        log
    }

    /// Whether the trial is better than where the run is; `predicted` is the model's reduction of the
    /// goal.
    fn is_better(&mut self, from: [f64; 2], predicted: f64) -> bool {
        let [goal, violation] = self.pair(&self.trial);
        let [from_goal, from_violation] = from;
        let kept = violation <= KEPT.max(0.1 * from_violation);
        if from_violation <= KEPT && kept && predicted > 0.0 {
            return from_goal - goal >= ACCEPTABLE * predicted
                && self.filter.accepts(goal, violation);
        }
        let better = violation <= (1.0 - 1e-5) * from_violation
            || goal <= from_goal - 1e-5 * violation.max(KEPT);
        better && self.filter.accepts(goal, violation)
    }
}

impl<P: Constrained> Solver<P, State> for SequentialConvex<'_> {
    fn name(&self) -> &str {
        "sequential convex programs"
    }

    fn init(
        &mut self,
        problem: &mut Problem<P>,
        state: State,
    ) -> Result<(State, Option<KV>), Error> {
        let problem = of(problem);
        assert_eq!(problem.variables(), self.bounds.variables());
        let x = state.param.as_ref().expect("the state was given its start");
        problem.assess(x, &mut self.current)?;
        self.current.check()?;
        self.rebuild_model(x);
        let [cost, violation] = self.pair(&self.current);
        self.filter = Filter::new(violation);
        let log = self.record(Iteration {
            iteration: 0,
            cost: self.reported().cost(),
            misfit: self.reported().misfit(),
            step: 0.0,
            damping: 0.0,
            held: 0,
            evaluations: 1,
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
        let mut x = state.take_param().expect("the state was given its start");
        let from = self.pair(&self.current);
        let curved = state.iter >= CURVED_FROM;
        let negligible = self.options.reduction_below * NEGLIGIBLE * from[0];
        let (mut evaluations, mut infeasible) = (0, 0);
        let mut obstacle = None;
        let mut step = 0.0;
        loop {
            let proposal = self.model.solve(self.radius, curved);
            let length = self.model.largest_component();
            let predicted = self.model.predicted_reduction();
            if let Proposal::Relaxed {
                remaining,
                culprits,
            } = &proposal
                && *remaining >= (1.0 - STUCK) * from[1]
                && from[1] > KEPT
            {
                self.culprits.clone_from(culprits);
                self.termination = Some(Termination::ConstraintsExcludeEachOther);
                break;
            }
            let is_still = length <= self.options.step_below.max(1e-12);
            let is_balanced = proposal == Proposal::Optimal
                && from[1] <= KEPT
                && length < self.radius
                && predicted.abs() <= negligible;
            if is_still {
                self.termination = Some(match obstacle {
                    Some(reason) => Termination::NoFeasibleStep(reason),
                    None => Termination::StepBelowResolution,
                });
                break;
            }
            self.model.step_from(&x, &mut self.trial_x);
            evaluations += 1;
            if let Err(reason) = self.evaluate_trial(problem) {
                infeasible += 1;
                obstacle = Some(reason);
                self.radius = 0.3 * length;
                continue;
            }
            let mut accepted = self.is_better(from, predicted);
            if is_balanced && obstacle.is_none() {
                self.termination = Some(Termination::NoFurtherDescent);
                if !accepted {
                    break;
                }
            }
            if !accepted && self.pair(&self.trial)[1] > from[1].max(KEPT) {
                // Curvature of the rows is in the way.
                let corrected = self.model.solve_corrected(&self.trial, curved);
                if corrected == Proposal::Optimal && self.model.largest_component() > 0.0 {
                    self.model.step_from(&x, &mut self.trial_x);
                    evaluations += 1;
                    match self.evaluate_trial(problem) {
                        Ok(()) => accepted = self.is_better(from, predicted),
                        Err(_) => infeasible += 1,
                    }
                }
            }
            if !accepted {
                self.radius = (0.3 * length).min(0.5 * self.radius);
                continue;
            }
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
            step = self.bounds.distance(&x, &self.trial_x);
            self.model.learn(&self.current, &self.trial);
            std::mem::swap(&mut x, &mut self.trial_x);
            std::mem::swap(&mut self.current, &mut self.trial);
            let ended = self.termination.take();
            self.rebuild_model(&x);
            self.termination = self.termination.take().or(ended);
            break;
        }
        let cost = self.current.goal.cost();
        let held = self.bounds.holds(&x);
        let log = self.record(Iteration {
            iteration: state.iter + 1,
            cost: self.reported().cost(),
            misfit: self.reported().misfit(),
            step,
            damping: 0.0,
            held: super::super::levenberg_marquardt::count_held(&held),
            evaluations,
            infeasible,
        });
        Ok((state.param(x).cost(cost), Some(log)))
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
                Termination::NoFeasibleStep(_) | Termination::ConstraintsExcludeEachOther => {
                    TerminationReason::SolverExit(reason.to_string())
                }
                _ => TerminationReason::SolverConverged,
            }),
        }
    }
}
