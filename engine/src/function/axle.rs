//! Curves of an axle as a function of the design: designs one at a time, both wheels of each.
//!
//! A variable moves the same points of both wheels, each in the frame of its side, so that a derivative is the sum of
//! both wheels' gradients along the variable's rates; a right wheel with hardpoints of its own is moved as the left one
//! is.

use super::DesignStatus;
use crate::axle::{AxleColumn, AxleSolver, Placement, Quantity};
use crate::mechanism::DesignFault;
use crate::model::{Axis, Side};
use crate::number::Vector3;
use crate::optimise::PointRate;
use crate::study::AxleStudy;

/// The positions of an axle, and the columns that are read in them.
#[derive(Clone, Debug)]
pub(super) struct AxleFunction {
    pub both: AxleStudy,
    pub columns: Vec<AxleColumn>,
    pub placements: Vec<Placement>,
}

/// Points of one side, and how the variables move them.
pub(super) type Moved<'m> = (&'m [Vector3<f64>], &'m [PointRate]);

/// Evaluates designs.
pub(super) trait AxleEvaluator {
    /// Writes values `[output][station]` and, where there are columns of a Jacobian, derivatives by them; NaN for what
    /// has none.
    fn evaluate(
        &mut self,
        sides: [Moved<'_>; 2],
        values: &mut [f64],
        jacobian: Option<&mut [f64]>,
    ) -> DesignStatus;
}

impl AxleFunction {
    pub(super) fn of(both: &AxleStudy) -> Self {
        let plan = both.plan.quantities_alone();
        AxleFunction {
            columns: plan.columns(&both.axle),
            placements: plan.course.placements(),
            both: AxleStudy {
                axle: both.axle.clone(),
                plan,
            },
        }
    }

    /// Names of the outputs with their units.
    pub(super) fn outputs(&self) -> Vec<String> {
        self.columns.iter().map(|c| c.name.clone()).collect()
    }

    /// For each station, the value of the first number that moves and the rack displacement, as results print them.
    pub(super) fn motion(&self) -> Vec<[f64; 2]> {
        let AxleStudy { axle, plan } = &self.both;
        let over = plan.course.moving()[0];
        let sign = axle.left.frame.sign(Axis::Y);
        let place = |p: &Placement| [over.written(p.along(over), axle), sign * p.rack() + 0.0];
        self.placements.iter().map(place).collect()
    }

    /// An evaluator of values, or of values with derivatives.
    pub(super) fn evaluator(
        &self,
        differentiates: bool,
    ) -> Result<Box<dyn AxleEvaluator + '_>, (Side, DesignFault)> {
        Ok(match self.both.plan.degree_for(differentiates) {
            0 => OneByOne::<1>::new(self)?,
            1 => OneByOne::<2>::new(self)?,
            2 => OneByOne::<3>::new(self)?,
            _ => OneByOne::<4>::new(self)?,
        })
    }
}

struct OneByOne<'a, const N: usize> {
    function: &'a AxleFunction,
    solver: AxleSolver<'a, N>,
}

impl<'a, const N: usize> OneByOne<'a, N> {
    fn new(function: &'a AxleFunction) -> Result<Box<Self>, (Side, DesignFault)> {
        let AxleStudy { axle, plan } = &function.both;
        let solver = AxleSolver::new(axle, &plan.quantities, false)?;
        Ok(Box::new(OneByOne { function, solver }))
    }
}

impl<const N: usize> AxleEvaluator for OneByOne<'_, N> {
    fn evaluate(
        &mut self,
        sides: [Moved<'_>; 2],
        values: &mut [f64],
        mut jacobian: Option<&mut [f64]>,
    ) -> DesignStatus {
        let OneByOne { function, solver } = self;
        values.fill(f64::NAN);
        if let Some(jacobian) = &mut jacobian {
            jacobian.fill(f64::NAN);
        }
        if solver.prepare(sides.map(|(design, _)| design)).is_err() {
            return DesignStatus::Faulty;
        }
        let (quantities, stations) = (&function.both.plan.quantities, function.placements.len());
        let mut status = DesignStatus::Ok;
        let placed = solver.place_all(&function.placements);
        for (station, placed) in placed.into_iter().enumerate() {
            let read = placed.and_then(|placed| Ok((solver.read(&placed)?, placed)));
            let Ok((read, placed)) = read else {
                status = DesignStatus::Failed;
                continue;
            };
            // What has no value by its definition has no derivative either.
            let mut there: Vec<Quantity> = Vec::new();
            let mut places = Vec::new();
            for (k, (quantity, column)) in quantities.iter().zip(&function.columns).enumerate() {
                if let Ok(value) = read.value(*quantity) {
                    values[k * stations + station] = value * column.factor;
                    there.push(*quantity);
                    places.push((k * stations + station, column.factor));
                }
            }
            let Some(jacobian) = &mut jacobian else {
                continue;
            };
            let width = jacobian.len() / values.len();
            let receive = |number: usize, gradients: [&[Vector3<f64>]; 2]| {
                let (place, factor) = places[number];
                let row = &mut jacobian[place * width..(place + 1) * width];
                row.fill(0.0);
                for ((_, point_rates), gradient) in sides.iter().zip(gradients) {
                    for rate in *point_rates {
                        row[rate.column] += gradient[rate.point].dot(rate.by) * factor;
                    }
                }
            };
            if solver.gradients(&placed, &there, receive).is_err() {
                status = DesignStatus::Failed;
            }
        }
        status
    }
}
