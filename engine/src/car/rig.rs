//! Targets and constraints of one axle on its test rig (the axle without the car), as part of the tuning of a car.

use super::Car;
use super::tune::RigGoals;
use crate::optimise::{
    Assessment, Constrained, Deviation, Infeasible, Linearisation, Objective, Shape, TargetLayout,
};
use crate::study::{Constraint, Vehicle};
use nalgebra::DVector;

/// Residuals and constraint rows of one axle on its rig, in the tuning problem of the car.
pub(super) struct RigRows<'a> {
    goals: &'a RigGoals,
    layout: &'a TargetLayout,
    objective: Objective<'a>,
    assessment: Assessment,
}

impl<'a> RigRows<'a> {
    /// Makes the residuals and constraint rows. The error is the reason why the design position of the axle cannot be
    /// solved.
    pub(super) fn new(
        vehicle: &'a Vehicle,
        goals: &'a RigGoals,
        layout: &'a TargetLayout,
    ) -> Result<Self, String> {
        let wheel = vehicle.wheel();
        let objective = Objective::new(wheel, &goals.optimise.variables, layout);
        let objective = objective.map_err(|fault| fault.describe(&wheel.mechanism))?;
        Ok(RigRows {
            goals,
            layout,
            assessment: Assessment::new(&objective.shape()),
            objective,
        })
    }

    pub(super) fn shape(&self) -> Shape {
        self.objective.shape()
    }

    pub(super) fn row_limits(&self) -> Vec<f64> {
        self.objective.row_limits()
    }

    /// For each constraint row, the index of the constraint to which it belongs.
    pub(super) fn constraints_of_rows(&self) -> impl Iterator<Item = usize> {
        self.layout.labels().iter().map(|label| label.constraint)
    }

    /// For each constraint row that is a component of a distance, the row of the other component.
    pub(super) fn other_components(&self) -> impl Iterator<Item = Option<usize>> {
        (0..self.layout.labels().len()).map(|row| self.layout.other_component(row))
    }

    /// Number of the axle's constraints.
    pub(super) fn constraints(&self) -> usize {
        self.goals.optimise.constraints.len()
    }

    /// For each constraint, the violation that has the value 1 in its rows. The violation is in the unit of the
    /// constraint.
    pub(super) fn visible_units(&self) -> impl Iterator<Item = f64> {
        let constraints = self.goals.optimise.constraints.iter();
        constraints.map(Constraint::visible)
    }

    /// Number of the axle's targets.
    pub(super) fn targets(&self) -> usize {
        self.goals.optimise.targets.len()
    }

    /// For each residual, the index of its target, and the residual per deviation of one tolerance. `scale` is the factor on
    /// all residuals of the car.
    pub(super) fn targets_of_rows(&self, scale: f64) -> impl Iterator<Item = (usize, f64)> {
        let share = self.share(scale);
        let rows = self.layout.targets_of_rows().into_iter();
        rows.map(move |target| (target, share * self.layout.share(target)))
    }

    /// Factor that converts the residuals of this axle's problem to residuals of the car's problem.
    fn share(&self, scale: f64) -> f64 {
        scale * (self.weights() / self.layout.residuals().max(1) as f64).sqrt()
    }

    /// Sum of the targets' weights.
    pub(super) fn weights(&self) -> f64 {
        self.goals.optimise.targets.iter().map(|t| t.weight).sum()
    }

    /// Computes residuals and constraints of the axle for values `x` of the car's variables.
    pub(super) fn assess(&mut self, x: &DVector<f64>) -> Result<(), Infeasible> {
        let own = self.own(x);
        self.objective.assess(&own, &mut self.assessment)
    }

    /// Values of the axle's variables, from the values `x` of the car's variables.
    fn own(&self, x: &DVector<f64>) -> DVector<f64> {
        let own = self.goals.columns.iter().map(|column| x[*column]);
        DVector::from_iterator(self.goals.columns.len(), own)
    }

    /// Writes the residuals of the axle to the rows from `first` on, with the factors of the car's problem. In the car's
    /// problem, the factor on each squared residual is the weight of the target divided by its number of stations.
    /// `scale` is the factor on all residuals of the car.
    pub(super) fn write_residuals(&self, first: usize, scale: f64, into: &mut Linearisation) {
        let own = &self.assessment.goal;
        let rows = own.residuals.len();
        let share = self.share(scale);
        for row in 0..rows {
            self.write(own, (row, first + row), share, into);
        }
    }

    /// Writes the constraint rows of the axle. `first` contains the first row of the equalities, and the first row of the
    /// other constraints.
    pub(super) fn write_rows(&self, first: [usize; 2], into: &mut Linearisation) {
        let equalities = self.shape().equalities;
        for row in 0..self.assessment.rows.residuals.len() {
            let place = if row < equalities {
                first[0] + row
            } else {
                first[1] + row - equalities
            };
            self.write(&self.assessment.rows, (row, place), 1.0, into);
        }
    }

    fn write(
        &self,
        own: &Linearisation,
        (from, to): (usize, usize),
        scale: f64,
        into: &mut Linearisation,
    ) {
        into.residuals[to] = scale * own.residuals[from];
        into.jacobian.row_mut(to).fill(0.0);
        for (place, column) in self.goals.columns.iter().enumerate() {
            into.jacobian[(to, *column)] += scale * own.jacobian[(from, place)];
        }
    }
}

/// Deviations of an axle from its targets, and margins of its constraints.
#[derive(Clone, Debug, PartialEq)]
pub struct RigOutcome {
    /// Deviation from each target.
    pub targets: Vec<Deviation>,
    /// Smallest margin of each constraint, in the unit of the constraint; negative if the constraint is violated.
    pub margins: Vec<f64>,
}

impl RigGoals {
    /// Computes the outcome for the axle with index `end` of a car. `vehicle` is the study of this axle; the design and
    /// rates of the car replace its own design and rates.
    pub(crate) fn outcome_in(
        &self,
        vehicle: &Vehicle,
        car: &Car,
        end: usize,
    ) -> Result<RigOutcome, String> {
        let mut vehicle = vehicle.clone();
        if let Vehicle::Axle(both) = &mut vehicle {
            both.axle = car.axles[end].clone();
            if let Some(tyres) = &car.tyres {
                both.axle.setup.tyre_rate = Some(tyres[end].rate);
            }
        }
        let variables = self.columns.iter().max().map_or(0, |last| last + 1);
        self.outcome(&vehicle, &vec![0.0; variables])
    }

    /// Computes deviations and margins for values `x` of the car's variables. The error is the reason why they do not
    /// exist.
    pub fn outcome(&self, vehicle: &Vehicle, x: &[f64]) -> Result<RigOutcome, String> {
        let layout = TargetLayout::of(&self.optimise, vehicle);
        let mut rows = RigRows::new(vehicle, self, &layout)?;
        let x = DVector::from_column_slice(x);
        let own = rows.own(&x);
        let margins = rows.objective.margins(&own, &mut rows.assessment);
        let margins = margins.map_err(|why| why.to_string())?;
        Ok(RigOutcome {
            targets: layout.deviations(&rows.assessment.goal.residuals),
            margins: margins.iter().map(|margin| margin.margin).collect(),
        })
    }
}
