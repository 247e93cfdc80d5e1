//! Tuning of a car. The design variables are hardpoints, rates and parameters of the car. The goals are results of load
//! cases, and curves and constraints of the axles on their rigs.
//!
//! Let d be the deviations of a target, each divided by the tolerance, and w the weight of the target. The misfit is
//! defined as in an axle's study:
//!
//! ```text
//! misfit^2 = sum w rms(d)^2 / sum w                                                                              (1)
//! ```
//!
//! A target of a case has one deviation. A target of a rig has one deviation per station.

use super::moves::{CarVariable, moved};
use super::rig::RigRows;
use super::{Car, CarQuantity, CarSolver, Case, NoEquilibrium};
use crate::mechanism::DesignFault;
use crate::optimise::{
    Assessment, Bounds, Constrained, Control, Infeasible, LeastSquares, Linearisation, Multistart,
    Options, Shape, TargetLayout, constrained_multistart, is_satisfied_from, multistart,
    smallest_conflict,
};
use crate::study::{Optimise, Vehicle};
use nalgebra::DVector;

/// Target for a result of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct CarTarget {
    /// Result to which the target applies.
    pub quantity: CarQuantity,
    /// Index of the case.
    pub case: usize,
    /// Lowest and highest target value, in the printed unit. The two values are equal if the target is a single value.
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

/// Limits on a result of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct CarConstraint {
    /// Name of the constraint.
    pub name: String,
    /// Result to which the limits apply.
    pub quantity: CarQuantity,
    /// Index of the case.
    pub case: usize,
    /// Lowest and highest value, in the printed unit; infinite without a limit.
    pub between: [f64; 2],
    /// Violation that counts as 1, as a difference of the printed value.
    pub visible: f64,
}

/// Targets and constraints of one axle on its rig.
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
    /// Targets of cases.
    pub targets: &'a [CarTarget],
    /// Constraints of cases.
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

/// Goals as residuals and constraint rows. The rows of the cases come first, then the rows of the front rig and of the
/// rear rig.
struct Objective<'a> {
    car: &'a Car,
    goals: CarGoals<'a>,
    rigs: Vec<RigRows<'a>>,
    /// Factor on all residuals, by equation (1).
    scale: f64,
}

/// Purpose of a requested result of a case.
enum Use {
    /// The result belongs to a target with this index.
    Target(usize),
    /// The result belongs to a constraint. The fields are the index of the constraint and the index of its first row.
    Constraint(usize, usize),
}

impl Objective<'_> {
    /// Number of residuals from cases.
    fn residuals_of_cases(&self) -> usize {
        self.goals.targets.len()
    }

    /// Returns the index of the first row of each constraint on a case, and the number of all these rows.
    fn rows_of_cases(&self) -> (Vec<usize>, usize) {
        let mut first = Vec::new();
        let mut count = 0;
        for constraint in self.goals.constraints {
            first.push(count);
            count += constraint.between.iter().filter(|l| l.is_finite()).count();
        }
        (first, count)
    }

    /// Returns, for each row, the index of the constraint to which it belongs, and the number of constraints. The
    /// constraints of the cases come first, then those of the front rig and of the rear rig.
    fn constraints_of_rows(&self) -> (Vec<usize>, usize) {
        let (mut equalities, mut others) = (Vec::new(), Vec::new());
        for (number, constraint) in self.goals.constraints.iter().enumerate() {
            let limits = constraint.between.iter().filter(|l| l.is_finite());
            others.extend(limits.map(|_| number));
        }
        let mut count = self.goals.constraints.len();
        for rig in &self.rigs {
            let own = rig.shape().equalities;
            for (row, constraint) in rig.constraints_of_rows().enumerate() {
                let into = if row < own {
                    &mut equalities
                } else {
                    &mut others
                };
                into.push(count + constraint);
            }
            count += rig.constraints();
        }
        equalities.extend(others);
        (equalities, count)
    }

    fn equalities(&self) -> usize {
        self.rigs.iter().map(|rig| rig.shape().equalities).sum()
    }

    /// Computes residuals and rows at `x`.
    fn evaluate_all(
        &mut self,
        x: &DVector<f64>,
        into: &mut Linearisation,
        mut rows: Option<&mut Linearisation>,
    ) -> Result<(), Infeasible> {
        let car = moved(self.car, self.goals.variables, x.as_slice());
        if let Some(reason) = car.refusal() {
            return Err(Infeasible::Refused(reason));
        }
        let solver = CarSolver::new(&car);
        let mut solver =
            solver.map_err(|fault| Infeasible::Refused(self.car.describe_fault(&fault)))?;
        for number in 0..self.goals.cases.len() {
            self.evaluate_case(&car, &mut solver, number, into, rows.as_deref_mut())?;
        }
        let mut residual = self.residuals_of_cases();
        // The rows of equalities come before all other rows.
        let mut equality = 0;
        let mut row = self.equalities() + self.rows_of_cases().1;
        for rig in &mut self.rigs {
            let shape = rig.shape();
            rig.assess(x)?;
            rig.write_residuals(residual, self.scale, into);
            if let Some(rows) = rows.as_deref_mut() {
                rig.write_rows([equality, row], rows);
            }
            residual += shape.goal;
            equality += shape.equalities;
            row += shape.rows - shape.equalities;
        }
        Ok(())
    }

    /// Computes residuals and rows of one case.
    fn evaluate_case(
        &self,
        car: &Car,
        solver: &mut CarSolver<'_>,
        number: usize,
        into: &mut Linearisation,
        mut rows: Option<&mut Linearisation>,
    ) -> Result<(), Infeasible> {
        let goals = &self.goals;
        let case = &goals.cases[number];
        let mut uses = Vec::new();
        let mut quantities: Vec<CarQuantity> = Vec::new();
        for (row, target) in goals.targets.iter().enumerate() {
            if target.case == number {
                uses.push(Use::Target(row));
                quantities.push(target.quantity);
            }
        }
        if rows.is_some() {
            let (first, _) = self.rows_of_cases();
            for (place, constraint) in goals.constraints.iter().enumerate() {
                if constraint.case == number {
                    uses.push(Use::Constraint(place, self.equalities() + first[place]));
                    quantities.push(constraint.quantity);
                }
            }
        }
        if quantities.is_empty() {
            return Ok(());
        }
        let fails = |why: NoEquilibrium| {
            Infeasible::Refused(format!("case {}: {}", case.name, why.describe(car)))
        };
        let found = solver.solve(case).map_err(fails)?;
        let gradients = solver.gradients(case, &found, &quantities).map_err(fails)?;
        for (used, gradient) in uses.iter().zip(&gradients) {
            let unit = gradient_unit(used, goals);
            let printed = unit.info().unit.printed_factor(car.length_unit);
            let value = printed * gradient.value;
            let slope = |variable: &CarVariable| printed * variable.moves.slope(car, gradient);
            match *used {
                Use::Target(row) => {
                    let target = &goals.targets[row];
                    let scale = self.scale * target.weight.sqrt() / target.tolerance;
                    let deviation = target.deviation(value);
                    into.residuals[row] = scale * deviation;
                    // Inside a band, the deviation stays zero.
                    let is_inside = deviation == 0.0 && target.wanted[0] < target.wanted[1];
                    for (column, variable) in goals.variables.iter().enumerate() {
                        into.jacobian[(row, column)] = if is_inside {
                            0.0
                        } else {
                            scale * slope(variable)
                        };
                    }
                }
                Use::Constraint(place, first) => {
                    let Some(rows) = rows.as_deref_mut() else {
                        continue;
                    };
                    let constraint = &goals.constraints[place];
                    let limits = constraint.between.into_iter().zip([-1.0, 1.0]);
                    let limits = limits.filter(|(limit, _)| limit.is_finite());
                    for (row, (limit, sign)) in (first..).zip(limits) {
                        let scale = sign / constraint.visible;
                        rows.residuals[row] = scale * (value - limit);
                        for (column, variable) in goals.variables.iter().enumerate() {
                            rows.jacobian[(row, column)] = scale * slope(variable);
                        }
                    }
                }
            }
        }
        Ok(())
    }
}

/// Returns the quantity of a target or a constraint. The unit of the gradient depends on it.
fn gradient_unit(used: &Use, goals: &CarGoals<'_>) -> CarQuantity {
    match *used {
        Use::Target(row) => goals.targets[row].quantity,
        Use::Constraint(place, _) => goals.constraints[place].quantity,
    }
}

impl LeastSquares for Objective<'_> {
    fn variables(&self) -> usize {
        self.goals.variables.len()
    }

    fn residuals(&self) -> usize {
        let of_rigs: usize = self.rigs.iter().map(|rig| rig.shape().goal).sum();
        self.residuals_of_cases() + of_rigs
    }

    fn evaluate(&mut self, x: &DVector<f64>, into: &mut Linearisation) -> Result<(), Infeasible> {
        self.evaluate_all(x, into, None)
    }
}

impl Constrained for Objective<'_> {
    fn shape(&self) -> Shape {
        let of_rigs: usize = self.rigs.iter().map(|rig| rig.shape().rows).sum();
        Shape {
            variables: self.variables(),
            goal: self.residuals(),
            levels: Vec::new(),
            rows: self.rows_of_cases().1 + of_rigs,
            equalities: self.equalities(),
        }
    }

    fn row_limits(&self) -> Vec<f64> {
        let mut limits = vec![0.0; self.shape().rows];
        let mut equality = 0;
        let mut row = self.equalities();
        for constraint in self.goals.constraints {
            for limit in constraint.between.iter().filter(|l| l.is_finite()) {
                limits[row] = limit.abs() / constraint.visible;
                row += 1;
            }
        }
        for rig in &self.rigs {
            let equalities = rig.shape().equalities;
            for (place, limit) in rig.row_limits().into_iter().enumerate() {
                let next = if place < equalities {
                    &mut equality
                } else {
                    &mut row
                };
                limits[*next] = limit;
                *next += 1;
            }
        }
        limits
    }

    fn assess(&mut self, x: &DVector<f64>, into: &mut Assessment) -> Result<(), Infeasible> {
        self.evaluate_all(x, &mut into.goal, Some(&mut into.rows))
    }
}

/// Result of a tuning.
#[derive(Clone, Debug)]
pub struct CarTuning {
    /// All starts, and the index of the best.
    pub starts: Multistart,
    /// Indices of constraints that cannot all be satisfied together. The indices run over the cases, the front rig and
    /// the rear rig. Without any one of these constraints, the others could be satisfied. Empty if all constraints can
    /// be satisfied together.
    pub contradiction: Vec<usize>,
}

/// Tuning problem: a car, its goals, and the layouts of the goals on the rigs.
struct Problem<'a> {
    car: &'a Car,
    goals: CarGoals<'a>,
    layouts: Vec<(&'a Vehicle, &'a RigGoals, TargetLayout)>,
    scale: f64,
}

impl<'a> Problem<'a> {
    /// Makes the problem. The error describes an axle whose design position cannot be solved.
    fn of(car: &'a Car, goals: CarGoals<'a>) -> Result<Self, String> {
        let layouts = goals.rigs.into_iter().flatten().map(|(vehicle, own)| {
            let layout = TargetLayout::of(&own.optimise, vehicle);
            (vehicle, own, layout)
        });
        let mut problem = Problem {
            car,
            goals,
            layouts: layouts.collect(),
            scale: 1.0,
        };
        let rigs = problem.rigs().map_err(|fault| format!("{fault:?}"))?;
        let residuals: usize = rigs.iter().map(|rig| rig.shape().goal).sum();
        let of_cases: f64 = goals.targets.iter().map(|target| target.weight).sum();
        let weights = of_cases + rigs.iter().map(RigRows::weights).sum::<f64>();
        drop(rigs);
        problem.scale = ((goals.targets.len() + residuals) as f64 / weights).sqrt();
        Ok(problem)
    }

    fn rigs(&self) -> Result<Vec<RigRows<'_>>, DesignFault> {
        let layouts = self.layouts.iter();
        let rows = layouts.map(|(vehicle, own, layout)| RigRows::new(vehicle, own, layout));
        rows.collect()
    }

    /// Makes the residuals and constraint rows. [`Problem::of`] has already checked the axles.
    fn objective(&self) -> Objective<'_> {
        Objective {
            car: self.car,
            goals: self.goals,
            rigs: self.rigs().unwrap_or_default(),
            scale: self.scale,
        }
    }
}

/// Tunes a car from several starts. In the result, one start is the best. The function fails if a range is empty, or if
/// the cases cannot be solved from any start.
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
    let starts = run.starts.max(1);
    let found = match objective().shape().rows {
        0 => multistart(
            objective, &bounds, &start, starts, run.seed, &options, control,
        ),
        _ => constrained_multistart(
            objective, &bounds, &start, starts, run.seed, &options, control,
        ),
    };
    // If no start succeeds, return the error of the first start (the design).
    if let (None, Err(fault)) = (found.best, &found.starts[0].outcome) {
        return Err(fault.to_string());
    }
    let is_violated = found.best_fit().is_some_and(|fit| !fit.is_feasible());
    let contradiction = if is_violated {
        contradiction(&problem, &found, &bounds, control)
    } else {
        Vec::new()
    };
    Ok(CarTuning {
        starts: found,
        contradiction,
    })
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
        // The whole problem is valid, so a problem with fewer constraints is valid too.
        Problem::of(problem.car, goals)
            .is_ok_and(|some| is_satisfied_from(starts, bounds, control, || some.objective()))
    })
}
