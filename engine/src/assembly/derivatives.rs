//! Curves of built mechanisms with their derivatives with respect to the parts.

use super::assembler::Assembler;
use super::rest::{Built, Direction};
use crate::curves::{Curves, curves};
use crate::mechanism::DesignFault;
use crate::model::PointId;
use crate::plan::Plan;

/// Curves of a built mechanism, with derivatives along directions (changes of parts that happen together).
#[derive(Clone, Debug)]
pub struct BuiltCurves {
    /// Curves, without sensitivities.
    pub curves: Curves,
    /// Derivative of the static height of the wheel centre along each direction, in length units per unit of the direction.
    pub height: Vec<f64>,
    /// Derivatives of the columns, `[direction][station][column]`, in the column's unit per unit of the direction. A
    /// column is a value, a rate or a curvature.
    derivatives: Vec<f64>,
}

impl BuiltCurves {
    /// Derivative of a column at a station along a direction.
    pub fn derivative(&self, direction: usize, station: usize, column: usize) -> f64 {
        let columns = self.curves.columns.len();
        let stations = self.curves.stations.len();
        self.derivatives[(direction * stations + station) * columns + column]
    }
}

/// Returns the curves of a built mechanism at the stations and for the quantities of a plan, with their derivatives along
/// directions of its parts. The derivatives at a station without a pose are NaN. Derivatives of a column without a value may be
/// NaN.
pub fn built_curves(
    assembler: &Assembler,
    built: &Built,
    plan: &Plan,
    directions: &[&Direction],
) -> Result<BuiltCurves, DesignFault> {
    let suspension = &built.suspension;
    let mut plan = plan.clone();
    plan.sensitivities = if directions.is_empty() {
        Vec::new()
    } else {
        (0..suspension.design.len()).map(PointId).collect()
    };
    let mut curves = curves(suspension, &plan)?;
    let sensitivities = std::mem::take(&mut curves.sensitivities);
    let (columns, stations) = (curves.columns.len(), curves.stations.len());
    let mut derivatives = vec![f64::NAN; directions.len() * stations * columns];
    let mut heights = Vec::with_capacity(directions.len());
    for (d, direction) in directions.iter().enumerate() {
        let (moves, height) = assembler.design_by(built, direction);
        heights.push(height);
        let of_direction = &mut derivatives[d * stations * columns..(d + 1) * stations * columns];
        for s in &sensitivities {
            let entry = &mut of_direction[s.station * columns + s.column];
            if entry.is_nan() {
                *entry = 0.0;
            }
        }
        for s in &sensitivities {
            let along = moves[s.point.0][s.axis];
            let sign = suspension.frame.sign(s.axis);
            // If a point does not move, it contributes nothing, even if the sensitivity with respect to this point is not
            // defined.
            if along != 0.0 {
                of_direction[s.station * columns + s.column] += s.value * sign * along;
            }
        }
    }
    Ok(BuiltCurves {
        curves,
        height: heights,
        derivatives,
    })
}
