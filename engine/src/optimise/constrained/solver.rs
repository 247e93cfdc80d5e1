//! Main loop of the solver. Each iteration of argmin makes one accepted step.

mod steps;

use super::super::active_set::Held;
use super::super::fit_record::{ArgminState, FitRecord, evaluations, execute, of};
use super::super::{
    Bounds, ConstraintState, Control, Fit, Infeasible, Iteration, Linearisation, Options,
    Termination,
};
use super::filter::Filter;
use super::model::ConvexModel;
use super::movable::Movable;
use super::{Assessment, Constrained};
use argmin::core::{Error, KV, Problem, Solver, TerminationStatus};
use nalgebra::DVector;
use steps::{Trial, Trials};

/// Largest violation with which a constraint counts as satisfied: 1e-7 of a visible difference (1 mm or 1 degree).
pub(in crate::optimise) const KEPT: f64 = 1e-7;
/// A run ends when the relative reduction of the goal is below this fraction of [`Options::reduction_below`]. The relative
/// error of the multipliers is about the square root of this relative reduction.
const NEGLIGIBLE: f64 = 1e-2;
/// Largest imbalance of the optimality conditions with which the multipliers count as the multipliers of a minimum. The error
/// of the goal is about the square of the imbalance.
const BALANCED: f64 = 1e-8;
/// Limit of the components of the first step, in half ranges of the variables (trust radius).
const FIRST_RADIUS: f64 = 1.0;
/// Trust radius, in half ranges, that contains the whole box of the variables.
const WHOLE: f64 = 4.0;
/// Smallest accepted ratio of actual to predicted reduction of the goal.
const ACCEPTABLE: f64 = 1e-4;
const POOR: f64 = 0.25;
const GOOD: f64 = 0.75;
/// Largest distance of a refused trial from the current point, in half ranges, for which the slopes at the trial are used. So
/// near to the current point, different slopes are those on the other side of a kink.
const BESIDE: f64 = 1e-6;
/// Largest number of stored refused trials.
const SIDES: usize = 4;
/// Number of iterations before the estimate of the curvature is used.
const CURVED_FROM: u64 = 7;
/// Step length, in half ranges, that counts as zero. The solver does not compute steps more accurately.
pub(super) const RESOLUTION: f64 = 1e-12;
/// Largest number of trials in an iteration. Unless the previous trial brought new rows into use, each trial step is at most
/// half as long as the previous step.
const TRIALS: usize = 60;
/// Smallest relative decrease of a violation. If the model predicts a smaller decrease, the violation counts as stuck.
const STUCK: f64 = 1e-4;

/// End of a run under constraints.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstrainedFit {
    /// Values of the variables, within their bounds.
    pub x: DVector<f64>,
    /// Residuals of the goal, of the levels (limits of a norm) and of the constraint rows at `x`.
    pub at: Assessment,
    /// Largest violation at `x` among the levels and the rows that some variable changes.
    pub violation: f64,
    /// True for each row that some variable changed at any point of the run.
    pub movable: Vec<bool>,
    /// Derivative of half the squared goal with respect to each row's limit, negated. Not negative except for equalities.
    pub multipliers: Vec<f64>,
    /// Derivative of half the squared goal with respect to half the square of each level, negated.
    pub level_multipliers: Vec<f64>,
    /// Multipliers of the rows by least squares, if they satisfy the optimality conditions. They differ from `multipliers` by
    /// more than rounding errors only if gradients are linearly dependent.
    pub alternatives: Option<Vec<f64>>,
    /// Imbalance of the optimality conditions (slopes plus multipliers times gradients), relative to the sizes of the terms.
    pub imbalance: f64,
    /// Rows and bounds that cannot be met together near `x`, if there are any.
    pub culprits: Vec<Held>,
    /// Reason for the end of the run.
    pub termination: Termination,
    /// The start and every iteration after it.
    pub history: Vec<Iteration>,
}

impl ConstrainedFit {
    /// Number of evaluations made, failed ones included.
    pub fn evaluations(&self) -> u64 {
        evaluations(&self.history)
    }

    /// Returns true if the end point satisfies, up to `KEPT`, all constraints: the rows, and the limits (levels) of the norms
    /// of residuals.
    pub fn is_feasible(&self) -> bool {
        self.violation <= KEPT
    }

    /// Converts the result of the run into a `Fit`. `at_minimum` is true if the multipliers are meaningful.
    pub(in crate::optimise) fn into_fit(self, bounds: &Bounds, at_minimum: bool) -> Fit {
        let is_minimum = at_minimum && self.termination.at_minimum();
        Fit {
            active_bounds: bounds.active_bounds(&self.x),
            x: self.x,
            evaluation: self.at.goal,
            termination: self.termination,
            residual: Some(self.imbalance),
            history: self.history,
            constraints: Some(ConstraintState {
                values: self.at.rows.residuals,
                violation: self.violation,
                movable: self.movable,
                multipliers: is_minimum.then_some(self.multipliers),
                alternatives: self.alternatives.filter(|_| is_minimum),
                culprits: self.culprits,
            }),
            left: None,
        }
    }
}

/// Minimises from `start`, or from the nearest point within `bounds`. An error gives the reason why there are no residuals
/// at this point.
pub fn constrained_fit(
    index: usize,
    problem: impl Constrained,
    bounds: &Bounds,
    start: &DVector<f64>,
    options: &Options,
    control: Control<'_>,
) -> Result<ConstrainedFit, Infeasible> {
    let shape = problem.shape();
    let levels: Vec<f64> = shape.levels.iter().map(|level| level.1).collect();
    let n = bounds.variables();
    let solver = SequentialConvex {
        record: FitRecord::new(bounds, options, control, index),
        equalities: shape.equalities,
        model: ConvexModel::new(bounds, &shape),
        limits: problem.row_limits(),
        movable: None,
        levels,
        current: Assessment::new(&shape),
        trial: Assessment::new(&shape),
        trial_x: DVector::zeros(n),
        beside: Vec::new(),
        gone: 0.0,
        filter: Filter::new(0.0, f64::INFINITY),
        radius: FIRST_RADIUS,
        culprits: Vec::new(),
    };
    let (solver, state) = execute(problem, solver, bounds, start)?;
    Ok(solver.into_fit(state))
}

struct SequentialConvex<'a> {
    record: FitRecord<'a>,
    equalities: usize,
    levels: Vec<f64>,
    /// Absolute values of the limits of the constraint rows.
    limits: Vec<f64>,
    /// Constraint rows in use. `None` before the run has begun.
    movable: Option<Movable>,
    model: ConvexModel<'a>,
    current: Assessment,
    trial: Assessment,
    trial_x: DVector<f64>,
    /// Constraint rows, linearised at the latest refused trial points near the current point. At a kink, these rows have the
    /// slopes on its other sides.
    beside: Vec<Linearisation>,
    /// Distance that the current point has moved since `beside` was last cleared, in half ranges.
    gone: f64,
    filter: Filter,
    radius: f64,
    culprits: Vec<Held>,
}

impl SequentialConvex<'_> {
    fn into_fit(mut self, state: ArgminState) -> ConstrainedFit {
        let x = state.param.expect("the state has a start point");
        // Computes the multipliers at the end point itself. The multipliers of the step to this point differ.
        self.model.solve(WHOLE, false);
        let settled = self.model.settle_multipliers(&self.beside);
        let imbalance = settled.residual;
        let [rows, levels] = self.model.multipliers().map(<[f64]>::to_vec);
        let violation = self.pair(&self.current)[1];
        // A point with violated rows is not a minimum, even if the multipliers balance.
        let checked = if violation <= KEPT {
            imbalance
        } else {
            f64::INFINITY
        };
        let (termination, history) = self.record.finished(checked);
        ConstrainedFit {
            violation,
            movable: self.movable.map_or(Vec::new(), Movable::into_taking_part),
            alternatives: settled.alternatives,
            multipliers: rows,
            level_multipliers: levels,
            imbalance,
            x,
            at: self.current,
            culprits: self.culprits,
            termination,
            history,
        }
    }

    /// Residuals that a run reports: the residuals of the first level, or the residuals of the goal if there are no levels.
    fn reported(&self) -> &Linearisation {
        self.current.levels.first().unwrap_or(&self.current.goal)
    }

    /// Goal (half the squared norm of its residuals) and violation of a point.
    fn pair(&self, of: &Assessment) -> [f64; 2] {
        let counts = |row| self.takes_part(row);
        let violation = of.violation_of(self.equalities, &self.levels, counts);
        [of.goal.cost(), violation]
    }

    /// Returns true if some variable is known to change this row. Also returns true before the rows have been examined.
    fn takes_part(&self, row: usize) -> bool {
        self.movable.as_ref().is_none_or(|m| m.takes_part(row))
    }

    /// Evaluates the trial and examines its rows. Returns true if rows that were constant so far change at the trial.
    fn evaluate_trial(&mut self, problem: &mut impl Constrained) -> Result<bool, Infeasible> {
        problem.assess(&self.trial_x, &mut self.trial)?;
        self.trial.check()?;
        let (rows, bounds) = (&self.trial.rows, self.record.bounds);
        Ok(self.movable.as_mut().is_some_and(|m| m.look(rows, bounds)))
    }

    /// Includes rows that were constant so far. The filter starts again, because violations now include these rows.
    fn count_new_rows(&mut self, x: &DVector<f64>) {
        self.rebuild_model(x);
        let [_, violation] = self.pair(&self.current);
        self.filter = Filter::new(violation, self.record.options.violation_below);
    }

    /// Stores the rows of the refused trial, if the trial is at most [`BESIDE`] away from the current point. `length` is this
    /// distance. If the store is full, the function first removes the oldest trial.
    fn keep_beside(&mut self, length: f64) {
        if length <= BESIDE {
            if self.beside.len() == SIDES {
                self.beside.remove(0);
            }
            self.beside.push(self.trial.rows.clone());
        }
    }

    /// Removes the stored trials if the steps since the last removal, this one included, add up to more than [`BESIDE`].
    fn leave_beside(&mut self, length: f64) {
        self.gone += length;
        if self.gone > BESIDE {
            self.beside.clear();
            self.gone = 0.0;
        }
    }

    /// Prepares the model at the current point.
    fn rebuild_model(&mut self, x: &DVector<f64>) {
        let movable = self.movable.as_ref();
        self.model.build(x, &self.current, movable);
        let [_, violation] = self.pair(&self.current);
        if self.current.goal.misfit() <= self.record.options.misfit_below && violation <= KEPT {
            self.record.end(Termination::MisfitReached);
        }
    }

    /// Returns true if the trial is better than the current point. `predicted` is the model's reduction of the goal.
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

impl<P: Constrained> Solver<P, ArgminState> for SequentialConvex<'_> {
    fn name(&self) -> &str {
        "sequential convex programs"
    }

    fn init(
        &mut self,
        problem: &mut Problem<P>,
        state: ArgminState,
    ) -> Result<(ArgminState, Option<KV>), Error> {
        let problem = of(problem);
        assert_eq!(problem.shape().variables, self.record.bounds.variables());
        let x = state.param.as_ref().expect("the state has a start point");
        problem.assess(x, &mut self.current)?;
        self.current.check()?;
        let (rows, bounds) = (&self.current.rows, self.record.bounds);
        self.movable = Some(Movable::new(&self.limits, rows, bounds));
        self.rebuild_model(x);
        let [cost, violation] = self.pair(&self.current);
        self.filter = Filter::new(violation, self.record.options.violation_below);
        self.record.add(x, Iteration::at(self.reported()));
        Ok((state.cost(cost), None))
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<P>,
        mut state: ArgminState,
    ) -> Result<(ArgminState, Option<KV>), Error> {
        let problem = of(problem);
        let mut x = state.take_param().expect("the state has a start point");
        let from = self.pair(&self.current);
        let mut trials = Trials {
            from,
            curved: state.iter >= CURVED_FROM,
            negligible: self.record.options.reduction_below * NEGLIGIBLE * from[0],
            ..Trials::default()
        };
        let step = loop {
            match self.try_step(problem, &mut x, &mut trials) {
                Trial::Refused => {}
                Trial::Ended => break 0.0,
                Trial::Accepted(step) => break step,
            }
        };
        let cost = self.current.goal.cost();
        let iteration = Iteration {
            iteration: state.iter + 1,
            step,
            evaluations: trials.evaluations,
            infeasible: trials.infeasible,
            ..Iteration::at(self.reported())
        };
        self.record.add(&x, iteration);
        Ok((state.param(x).cost(cost), None))
    }

    fn terminate(&mut self, state: &ArgminState) -> TerminationStatus {
        self.record.status(state)
    }
}
