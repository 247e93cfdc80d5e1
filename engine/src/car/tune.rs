//! Tuning of a car. The design variables are hardpoints, rates and parameters of the car. The goals are results of load
//! cases, and curves and constraints of single axles on their test rigs (without the car).
//!
//! Let d be the deviations of a target, each divided by the tolerance, and w the weight of the target. The misfit is
//! defined as in an axle's study:
//!
//! ```text
//! misfit^2 = sum w rms(d)^2 / sum w                                                                              (1)
//! ```
//!
//! A target of a case has one deviation. A target of a rig has one deviation per station.

use super::moves::CarVariable;
use super::objective::{Objective, Problem};
use super::{Car, CarQuantity, Case};
use crate::optimise::{
    Bounds, Constrained, Control, Fit, HoldingBound, LeastSquares, Limit, Linearisation, Minimum,
    Multistart, Options, Price, Residuals, Unmoved, Without, constrained_multistart,
    is_satisfied_from, multistart, smallest_conflict, starts_without_fixed, unmoved_constraints,
};
use crate::study::{Optimise, Vehicle};
use nalgebra::DVector;

/// Target for a result of a load case.
#[derive(Clone, Debug, PartialEq)]
pub struct CarTarget {
    /// Result to which the target applies.
    pub quantity: CarQuantity,
    /// Index of the case.
    pub case: usize,
    /// Lowest and highest target value, in the printed unit. The two values are equal for a single target value, and
    /// different for a band.
    pub wanted: [f64; 2],
    /// Tolerance: a deviation of this size counts as 1.
    pub tolerance: f64,
    /// Weight of the target.
    pub weight: f64,
}

impl CarTarget {
    /// Returns the deviation of a printed value from the target value. Inside a target band, the deviation is 0.
    pub fn deviation(&self, found: f64) -> f64 {
        let [low, high] = self.wanted;
        found - found.clamp(low, high)
    }
}

/// Limits on a result of a load case.
#[derive(Clone, Debug, PartialEq)]
pub struct CarConstraint {
    /// Name of the constraint.
    pub name: String,
    /// Result to which the limits apply.
    pub quantity: CarQuantity,
    /// Index of the case.
    pub case: usize,
    /// Lowest and highest allowed value of the result, in the printed unit; infinite without a limit.
    pub between: [f64; 2],
    /// Violation that has the value 1 in the constraint row, in the printed unit.
    pub visible: f64,
}

impl CarConstraint {
    /// Margin between a printed value and the nearer limit. Negative if the limit is violated.
    pub fn margin(&self, value: f64) -> f64 {
        let [low, high] = self.between;
        (value - low).min(high - value) + 0.0
    }
}

/// Targets and constraints of one axle on its test rig (the axle without the car).
#[derive(Clone, Debug, PartialEq)]
pub struct RigGoals {
    /// Targets, constraints and design variables, as in a study of the axle alone.
    pub optimise: Optimise,
    /// Index of each of these design variables among the design variables of the car.
    pub columns: Vec<usize>,
}

/// Goals of a tuning.
#[derive(Clone, Copy, Debug)]
pub struct CarGoals<'a> {
    /// Load cases.
    pub cases: &'a [Case],
    /// Design variables.
    pub variables: &'a [CarVariable],
    /// Targets on results of load cases.
    pub targets: &'a [CarTarget],
    /// Constraints on results of load cases.
    pub constraints: &'a [CarConstraint],
    /// Front and rear axle with their goals on the rig.
    pub rigs: [Option<(&'a Vehicle, &'a RigGoals)>; 2],
}

/// Settings of a tuning run: its limits and its starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CarRun {
    /// Largest number of iterations per start.
    pub max_iterations: u64,
    /// Number of starts. The first start is the design; the others are distributed over the ranges.
    pub starts: usize,
    /// Seed of the random starts.
    pub seed: u32,
}

/// Result of a tuning.
#[derive(Clone, Debug)]
pub struct CarTuning {
    /// Misfit of the car before the tuning. `None` if it cannot be computed.
    pub misfit_before: Option<f64>,
    /// All starts, and the index of the best.
    pub starts: Multistart,
    /// Missed targets on which the variables have no effect or too little effect. The indices run over the targets of
    /// the cases, of the front rig and of the rear rig.
    pub unmoved: Unmoved,
    /// Indices of violated constraints that no variable changes. The indices are numbered as in `contradiction`.
    pub unmoved_constraints: Vec<usize>,
    /// Price of each constraint: reduction of the misfit per unit by which the limit moves outwards. The constraints
    /// are numbered as in `contradiction`.
    pub prices: Vec<Price>,
    /// Bounds of variables that hold the misfit, the most effective first. The targets are numbered as in `unmoved`. `None` if the
    /// tuning did not end at a minimum of the misfit.
    pub holding: Option<Vec<HoldingBound>>,
    /// Indices of constraints that cannot all be satisfied together. The indices run over the cases, the front rig and
    /// the rear rig. Without any one of these constraints, the others could be satisfied. Empty if all constraints can
    /// be satisfied together.
    pub contradiction: Vec<usize>,
}

impl CarTuning {
    /// Number of starts that were interrupted, and total number of starts.
    pub fn interrupted(&self) -> [usize; 2] {
        [self.starts.interrupted(), self.starts.starts.len()]
    }

    /// True if a request cannot be met: the best start violates a constraint, or no variable changes a target that is missed
    /// by more than its tolerance.
    pub fn falls_short(&self) -> bool {
        let is_violated = self.starts.best_fit().is_some_and(|fit| !fit.is_feasible());
        is_violated || !self.unmoved_constraints.is_empty() || self.unmoved.exceeds_tolerance
    }
}

/// Tunes a car from several starts. In the result, one start is the best. The function fails if a range is empty, or if
/// an axle with goals on its rig cannot be solved. It also fails if the cases cannot be solved from any start.
pub fn tune(
    car: &Car,
    goals: CarGoals<'_>,
    run: CarRun,
    control: Control<'_>,
) -> Result<CarTuning, String> {
    let ranges: Vec<[f64; 2]> = goals.variables.iter().map(|v| v.range).collect();
    let bounds = Bounds::new(&ranges).map_err(|fault| fault.to_string())?;
    let start = goals.variables.iter();
    let start = start.map(|variable| variable.moves.value(car).unwrap_or(0.0));
    let start = DVector::from_iterator(goals.variables.len(), start);
    let options = Options {
        max_iterations: run.max_iterations,
        max_evaluations: 10 * run.max_iterations,
        ..Options::default()
    };
    let problem = Problem::of(car, goals)?;
    let objective = || problem.objective();
    let mut at_start = Linearisation::new(objective().residuals(), start.len());
    let evaluated = objective().evaluate(&start, &mut at_start);
    let at_start = evaluated.is_ok().then_some(at_start);
    let (count, seed) = (run.starts.max(1), run.seed);
    let is_constrained = objective().shape().rows > 0;
    let found = starts_without_fixed(at_start.as_ref(), &bounds, |fixed| {
        let problem = || Without {
            problem: objective(),
            fixed,
            bounds: &bounds,
        };
        if is_constrained {
            constrained_multistart(problem, &bounds, &start, count, seed, &options, control)
        } else {
            multistart(problem, &bounds, &start, count, seed, &options, control)
        }
    });
    // If no start succeeds, return the error of the first start (the design).
    if let (None, Err(fault)) = (found.best, &found.starts[0].outcome) {
        return Err(fault.to_string());
    }
    let contradiction = match found.best_fit() {
        Some(fit) if !fit.is_feasible() => contradiction(&problem, &found, &bounds, control),
        _ => Vec::new(),
    };
    let mut tuning = CarTuning {
        misfit_before: at_start.as_ref().map(Linearisation::misfit),
        unmoved: Unmoved::default(),
        unmoved_constraints: Vec::new(),
        prices: Vec::new(),
        holding: None,
        contradiction,
        starts: found,
    };
    if let Some(fit) = tuning.starts.best_fit() {
        let mut objective = objective();
        let holding = holding_bounds(&mut objective, fit, &bounds);
        let unmoved = unmoved(&objective, &tuning.starts, fit, at_start.as_ref(), &bounds);
        let (prices, still) = limits(&objective, fit);
        (tuning.unmoved, tuning.prices, tuning.unmoved_constraints) = (unmoved, prices, still);
        tuning.holding = holding;
    }
    Ok(tuning)
}

/// Finds the missed targets on which the variables have no effect or too little effect.
fn unmoved(
    objective: &Objective<'_>,
    starts: &Multistart,
    fit: &Fit,
    at_start: Option<&Linearisation>,
    bounds: &Bounds,
) -> Unmoved {
    let rows = objective.targets_of_rows();
    let count = rows.last().map_or(0, |(target, _)| target + 1);
    let (mut squares, mut stations) = (vec![0.0; count], vec![0.0; count]);
    for ((target, unit), residual) in rows.iter().zip(fit.evaluation.residuals.iter()) {
        squares[*target] += (residual / unit).powi(2);
        stations[*target] += 1.0;
    }
    let rms = squares.iter().zip(&stations);
    let rms: Vec<f64> = rms.map(|(square, n)| (square / n).sqrt()).collect();
    let of_rows: Vec<usize> = rows.iter().map(|(target, _)| *target).collect();
    let ends = starts.starts.iter();
    let ends = ends.filter_map(|start| Some(&start.outcome.as_ref().ok()?.evaluation));
    let residuals = Residuals {
        of_rows: &of_rows,
        seen: &ends.chain(at_start).collect::<Vec<_>>(),
        bounds,
    };
    residuals.unmoved(&rms, &fit.evaluation)
}

/// Finds the bounds that hold the misfit, under the conditions of [`CarTuning::holding`].
fn holding_bounds(
    objective: &mut Objective<'_>,
    fit: &Fit,
    bounds: &Bounds,
) -> Option<Vec<HoldingBound>> {
    let of_rows = objective.targets_of_rows().into_iter();
    let of_rows: Vec<usize> = of_rows.map(|(target, _)| target).collect();
    Minimum::of(fit, &of_rows, bounds, objective)
}

/// Returns the price of each constraint (reduction of the misfit per unit by which the limit moves outwards). Also
/// returns the indices of violated constraints that no variable changes.
fn limits(objective: &Objective<'_>, fit: &Fit) -> (Vec<Price>, Vec<usize>) {
    let Some(state) = &fit.constraints else {
        return (Vec::new(), Vec::new());
    };
    let equalities = objective.equalities();
    let violation = |row: usize, value: f64| {
        if row < equalities { value.abs() } else { value }
    };
    let (of_rows, _) = objective.constraints_of_rows();
    let others = objective.other_components();
    let units = objective.visible_units();
    let values = state.values.as_slice();
    let limit = |row: usize| Limit::of_row(row, others[row], values, violation);
    let price = |(number, visible): (usize, &f64)| {
        let rows = (0..of_rows.len()).filter(|row| of_rows[*row] == number);
        Price::of(fit, rows.filter_map(limit), *visible)
    };
    (
        units.iter().enumerate().map(price).collect(),
        unmoved_constraints(fit, &of_rows, violation),
    )
}

/// Finds constraints that cannot be satisfied together, and returns their indices.
fn contradiction(
    problem: &Problem<'_>,
    starts: &Multistart,
    bounds: &Bounds,
    control: Control<'_>,
) -> Vec<usize> {
    let (of_rows, count) = problem.objective().constraints_of_rows();
    smallest_conflict(starts, &of_rows, count, |kept| {
        let goals = &problem.goals;
        let of_cases = goals.constraints.iter().enumerate();
        let of_cases = of_cases.filter(|(number, _)| kept.contains(number));
        let constraints: Vec<CarConstraint> = of_cases.map(|(_, own)| own.clone()).collect();
        let mut next = goals.constraints.len();
        let rigs = goals.rigs.map(|rig| {
            let (_, goals) = rig?;
            let mut own = goals.clone();
            own.optimise.constraints.retain(|_| {
                next += 1;
                kept.contains(&(next - 1))
            });
            Some(own)
        });
        let [front, rear] = goals.rigs;
        let rig = |rig: Option<(_, _)>, own| Some((rig?.0, Option::as_ref(own)?));
        let goals = CarGoals {
            constraints: &constraints,
            rigs: [rig(front, &rigs[0]), rig(rear, &rigs[1])],
            ..*goals
        };
        // The problem with all constraints is valid, so a problem with fewer constraints is valid too.
        Problem::of(problem.car, goals)
            .is_ok_and(|some| is_satisfied_from(starts, bounds, control, || some.objective()))
    })
}
