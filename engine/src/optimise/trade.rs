//! Problems that lower one criterion with limits on the others. Used for the smallest change, the Pareto front and the price list
//! (misfit against size of change).

use super::constrained::{Assessment, Constrained, Shape};
use super::{Bounds, Infeasible, Linearisation};
use nalgebra::DVector;

/// A quantity that a problem minimises or limits.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Criterion {
    /// Indices of the criterion's residuals. `None` if the criterion is the distance by which the variables move from the design.
    rows: Option<Vec<usize>>,
    /// Ratio between the norm of the criterion's residuals and the value of the criterion.
    pub unit: f64,
}

impl Criterion {
    /// Misfit of some residuals. Their norm is `unit` times the misfit.
    pub(super) fn misfit(rows: Vec<usize>, unit: f64) -> Self {
        let rows = Some(rows);
        Criterion { rows, unit }
    }

    /// Move from the design: the root of a sum over the variables, of cost times the square of (move / range).
    pub(super) fn movement() -> Self {
        Criterion {
            rows: None,
            unit: 1.0,
        }
    }

    /// Indices of the criterion's residuals. `None` if the criterion is the distance by which the variables move from the design.
    pub(super) fn rows(&self) -> Option<&[usize]> {
        self.rows.as_deref()
    }

    fn residuals(&self, variables: usize) -> usize {
        self.rows.as_ref().map_or(variables, Vec::len)
    }
}

/// Function that measures the distance of the variables from the design.
#[derive(Clone, Debug)]
pub(super) struct Distance<'a> {
    design: &'a DVector<f64>,
    /// Weight of each variable: square root of the variable's cost, divided by the variable's range.
    weights: DVector<f64>,
}

impl<'a> Distance<'a> {
    pub(super) fn new(design: &'a DVector<f64>, bounds: &Bounds, costs: &[f64]) -> Self {
        let weights = bounds.width().iter().zip(costs);
        let weights: Vec<f64> = weights.map(|(width, cost)| cost.sqrt() / width).collect();
        Distance {
            design,
            weights: weights.into(),
        }
    }

    /// Distance of `x` from the design.
    pub(super) fn of(&self, x: &DVector<f64>) -> f64 {
        (x - self.design).component_mul(&self.weights).norm()
    }

    fn write(&self, x: &DVector<f64>, into: &mut Linearisation) {
        into.jacobian.fill(0.0);
        for (j, weight) in self.weights.iter().enumerate() {
            into.residuals[j] = weight * (x[j] - self.design[j]);
            into.jacobian[(j, j)] = *weight;
        }
    }
}

/// A problem that lowers one criterion with limits on the others, and keeps the constraints of the original problem.
pub(super) struct ConstrainedTrade<'a, P> {
    problem: P,
    distance: &'a Distance<'a>,
    lowered: &'a Criterion,
    held: Vec<(&'a Criterion, f64)>,
    assessment: Assessment,
    /// Point at which `assessment` is already known.
    known: Option<DVector<f64>>,
}

impl<'a, P: Constrained> ConstrainedTrade<'a, P> {
    /// Makes the problem that lowers criterion `lowered`. `held` holds the limited criteria and their limits.
    pub(super) fn new(
        problem: P,
        distance: &'a Distance<'a>,
        lowered: &'a Criterion,
        held: Vec<(&'a Criterion, f64)>,
    ) -> Self {
        ConstrainedTrade {
            assessment: Assessment::new(&problem.shape()),
            problem,
            distance,
            lowered,
            held,
            known: None,
        }
    }

    /// Stores residuals that are already known at a point `x`. Use only for problems without constraints.
    pub(super) fn knowing(mut self, x: &DVector<f64>, residuals: &Linearisation) -> Self {
        assert_eq!(
            self.assessment.rows.residuals.len(),
            0,
            "residuals are given, but not the values of the constraints"
        );
        self.assessment.goal.clone_from(residuals);
        self.known = Some(x.clone());
        self
    }

    fn write(&self, aim: &Criterion, x: &DVector<f64>, into: &mut Linearisation) {
        let Some(rows) = &aim.rows else {
            return self.distance.write(x, into);
        };
        let from = &self.assessment.goal;
        for (to, row) in rows.iter().enumerate() {
            into.residuals[to] = from.residuals[*row];
        }
        let columns = into.jacobian.column_iter_mut();
        for (mut column, from) in columns.zip(from.jacobian.column_iter()) {
            for (to, row) in rows.iter().enumerate() {
                column[to] = from[*row];
            }
        }
    }
}

impl<P: Constrained> Constrained for ConstrainedTrade<'_, P> {
    fn shape(&self) -> Shape {
        let shape = self.problem.shape();
        let n = shape.variables;
        let held = self.held.iter();
        let levels = held.map(|(aim, amount)| (aim.residuals(n), aim.unit * amount));
        Shape {
            goal: self.lowered.residuals(n),
            levels: levels.collect(),
            ..shape
        }
    }

    fn row_limits(&self) -> Vec<f64> {
        self.problem.row_limits()
    }

    fn assess(&mut self, x: &DVector<f64>, into: &mut Assessment) -> Result<(), Infeasible> {
        if self.known.take().is_none_or(|known| known != *x) {
            self.problem.assess(x, &mut self.assessment)?;
        }
        self.write(self.lowered, x, &mut into.goal);
        for ((aim, _), level) in self.held.iter().zip(&mut into.levels) {
            self.write(aim, x, level);
        }
        std::mem::swap(&mut into.rows, &mut self.assessment.rows);
        Ok(())
    }
}
