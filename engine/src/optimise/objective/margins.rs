//! Margins of the constraints in one design.

use super::{FAR, Objective};
use crate::number::Vector3;
use crate::optimise::{Assessment, Infeasible, Margin};
use nalgebra::DVector;

impl Objective<'_> {
    /// Assesses the design at `x` and returns the margin of each constraint. Unlike a search step, this computes the extremes
    /// between stations for all limits, also for those with a large margin.
    pub fn margins(
        &mut self,
        x: &DVector<f64>,
        into: &mut Assessment,
    ) -> Result<Vec<Margin>, Infeasible> {
        self.move_to(x);
        self.margins_here(x, into)
    }

    /// Assesses a given design like [`Objective::margins`]. The variables of this problem move no points. `left` contains the
    /// points of the wheel, or of the left wheel of an axle. `right` contains the points of the right wheel; it is empty if
    /// the right wheel is a mirror image. The variables, which are rates, have the values `x`.
    pub(in crate::optimise) fn margins_of_design(
        &mut self,
        [left, right]: [&[Vector3<f64>]; 2],
        x: &DVector<f64>,
        into: &mut Assessment,
    ) -> Result<Vec<Margin>, Infeasible> {
        self.wheel.design.copy_from_slice(left);
        if let Some(wheel) = &mut self.right {
            wheel.design.copy_from_slice(right);
        }
        self.margins_here(x, into)
    }

    /// Assesses the present design, like [`Objective::margins`]: the points in `self.wheel` and `self.right`.
    fn margins_here(
        &mut self,
        x: &DVector<f64>,
        into: &mut Assessment,
    ) -> Result<Vec<Margin>, Infeasible> {
        self.far = f64::INFINITY;
        let assessed = self.evaluate_here(x, &mut into.goal, Some(&mut into.rows));
        self.far = FAR;
        assessed?;
        let values = into.rows.residuals.as_slice();
        Ok(self.layout.margins(values, &self.extremes))
    }
}
