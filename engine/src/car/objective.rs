//! Tuning of a car as a least-squares problem with constraints: residuals, constraint rows and their derivatives.

use super::moves::{CarVariable, moved};
use super::rig::RigRows;
use super::tune::{CarGoals, RigGoals};
use super::{AXLE_NAMES, Car, CarQuantity, CarSolver, NoEquilibrium};
use crate::optimise::{
    Assessment, Constrained, Infeasible, LeastSquares, Linearisation, Shape, TargetLayout,
};
use crate::study::Vehicle;
use nalgebra::DVector;

/// Goals of the tuning: residuals of the targets, and constraint rows. A constraint has one or more rows, for example one
/// per limit. The residuals of the load cases come first. The residuals of the front rig and of the rear rig (one axle
/// without the car) follow. `in_row_order` puts the constraint rows in order.
pub(super) struct Objective<'a> {
    car: &'a Car,
    goals: CarGoals<'a>,
    rigs: Vec<RigRows<'a>>,
    /// Factor on all residuals, so that their mean square is the squared misfit of `tune.rs`.
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
    /// Number of residuals from load cases.
    fn residuals_of_cases(&self) -> usize {
        self.goals.targets.len()
    }

    /// Returns the index of the first row of each constraint on a load case, and the number of all these rows. The index
    /// counts only rows of load cases.
    fn rows_of_cases(&self) -> (Vec<usize>, usize) {
        let mut first = Vec::new();
        let mut count = 0;
        for constraint in self.goals.constraints {
            first.push(count);
            count += constraint.between.iter().filter(|l| l.is_finite()).count();
        }
        (first, count)
    }

    /// Puts an entry for each row in the order of the rows: equalities of the rigs first, then rows of the cases, then the other
    /// rows of the rigs. `of_rigs` has the entries of each rig.
    fn in_row_order<T>(&self, of_cases: Vec<T>, of_rigs: Vec<Vec<T>>) -> Vec<T> {
        let (mut equalities, mut others) = (Vec::new(), of_cases);
        for (rig, mut entries) in self.rigs.iter().zip(of_rigs) {
            others.extend(entries.drain(rig.shape().equalities..));
            equalities.extend(entries);
        }
        equalities.extend(others);
        equalities
    }

    /// Returns, for each row, the index of the constraint to which it belongs, and the number of constraints. The
    /// constraints of the load cases come first, then the constraints of the front rig and of the rear rig.
    pub(super) fn constraints_of_rows(&self) -> (Vec<usize>, usize) {
        let mut of_cases = Vec::new();
        for (number, constraint) in self.goals.constraints.iter().enumerate() {
            let limits = constraint.between.iter().filter(|l| l.is_finite());
            of_cases.extend(limits.map(|_| number));
        }
        let mut count = self.goals.constraints.len();
        let mut of_rigs = Vec::new();
        for rig in &self.rigs {
            let own = rig.constraints_of_rows();
            of_rigs.push(own.map(|constraint| count + constraint).collect());
            count += rig.constraints();
        }
        (self.in_row_order(of_cases, of_rigs), count)
    }

    /// For each constraint row that is a component of a distance, returns the row of the other component.
    pub(super) fn other_components(&self) -> Vec<Option<usize>> {
        let of_cases = self.rows_of_cases().1;
        let (mut equality, mut other) = (0, self.equalities() + of_cases);
        let mut of_rigs = Vec::new();
        for rig in &self.rigs {
            let shape = rig.shape();
            let place = |row: usize| match row.checked_sub(shape.equalities) {
                None => equality + row,
                Some(row) => other + row,
            };
            let components = rig.other_components();
            of_rigs.push(components.map(|own| own.map(place)).collect());
            equality += shape.equalities;
            other += shape.rows - shape.equalities;
        }
        self.in_row_order(vec![None; of_cases], of_rigs)
    }

    /// Returns, for each constraint, the violation that has the value 1 in its rows, in the unit of the constraint. A
    /// violation of this size is visible in practice, such as 1 mm or 1 degree.
    pub(super) fn visible_units(&self) -> Vec<f64> {
        let of_cases = self.goals.constraints.iter().map(|own| own.visible);
        let of_rigs = self.rigs.iter().flat_map(RigRows::visible_units);
        of_cases.chain(of_rigs).collect()
    }

    /// Returns, for each residual, the index of its target, and the residual per deviation of one tolerance. The targets
    /// of the load cases come first, then the targets of the front rig and of the rear rig.
    pub(super) fn targets_of_rows(&self) -> Vec<(usize, f64)> {
        let of_cases = self.goals.targets.iter().enumerate();
        let of_cases = of_cases.map(|(number, own)| (number, self.scale * own.weight.sqrt()));
        let mut rows: Vec<(usize, f64)> = of_cases.collect();
        let mut count = self.goals.targets.len();
        for rig in &self.rigs {
            let own = rig.targets_of_rows(self.scale);
            rows.extend(own.map(|(target, unit)| (count + target, unit)));
            count += rig.targets();
        }
        rows
    }

    pub(super) fn equalities(&self) -> usize {
        self.rigs.iter().map(|rig| rig.shape().equalities).sum()
    }

    /// Computes residuals and constraint rows at the values `x` of the variables.
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
        // The rows of equality constraints come before all other rows.
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

    /// Computes residuals and constraint rows of one load case.
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

/// Returns the quantity of a target or a constraint. The unit of this quantity is the unit of the gradient.
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

/// Tuning problem: a car, its goals, and the lists of the residuals and constraint rows of the rigs.
pub(super) struct Problem<'a> {
    pub(super) car: &'a Car,
    pub(super) goals: CarGoals<'a>,
    /// Index, study, goals and layout of each axle with goals.
    layouts: Vec<(usize, &'a Vehicle, &'a RigGoals, TargetLayout)>,
    scale: f64,
}

impl<'a> Problem<'a> {
    /// Makes the problem. The error describes an axle whose design position cannot be solved.
    pub(super) fn of(car: &'a Car, goals: CarGoals<'a>) -> Result<Self, String> {
        let layouts = goals.rigs.into_iter().enumerate().filter_map(|(end, rig)| {
            let (vehicle, own) = rig?;
            let layout = TargetLayout::of(&own.optimise, vehicle);
            Some((end, vehicle, own, layout))
        });
        let mut problem = Problem {
            car,
            goals,
            layouts: layouts.collect(),
            scale: 1.0,
        };
        let rigs = problem.rigs()?;
        let residuals: usize = rigs.iter().map(|rig| rig.shape().goal).sum();
        let of_cases: f64 = goals.targets.iter().map(|target| target.weight).sum();
        let weights = of_cases + rigs.iter().map(RigRows::weights).sum::<f64>();
        drop(rigs);
        problem.scale = ((goals.targets.len() + residuals) as f64 / weights).sqrt();
        Ok(problem)
    }

    fn rigs(&self) -> Result<Vec<RigRows<'_>>, String> {
        let layouts = self.layouts.iter();
        let rows = layouts.map(|(end, vehicle, own, layout)| {
            let rows = RigRows::new(vehicle, own, layout);
            rows.map_err(|reason| format!("{} axle: {reason}", AXLE_NAMES[*end]))
        });
        rows.collect()
    }

    /// Makes the residuals and constraint rows. [`Problem::of`] has already checked the axles.
    pub(super) fn objective(&self) -> Objective<'_> {
        Objective {
            car: self.car,
            goals: self.goals,
            rigs: self.rigs().unwrap_or_default(),
            scale: self.scale,
        }
    }
}
