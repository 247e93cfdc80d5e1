//! Influence of each hardpoint coordinate on each curve.

use super::{Sensitivity, wheel_curves};
use crate::characteristics::Quantity;
use crate::mechanism::DesignFault;
use crate::model::{Axis, PointId};
use crate::plan::{Output, Plan};
use crate::study::WheelStudy;
use serde::{Deserialize, Serialize};

/// Influence of a hardpoint coordinate on an output over the motion, from its derivatives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Influence {
    /// Name of the output's column.
    pub output: String,
    /// Coordinate, for example `tie_rod_inner.z`.
    pub coordinate: String,
    /// Derivative with the largest absolute value over the motion, in the output's unit per length unit.
    pub largest: f64,
    /// Root mean square of the derivative over the motion. It shows how far the curve moves.
    pub rms: f64,
    /// Root mean square of the derivative's difference from its mean over the motion. It shows how much the curve changes its
    /// shape.
    pub bend: f64,
}

/// Influence of every coordinate on every characteristic and test result of a plan, with the rack at its first position. Stations
/// without a pose, or without the value, are ignored. Coordinates without influence are left out, and coordinates whose derivative
/// is not finite at some station.
pub fn influences(own: &WheelStudy, plan: &Plan) -> Result<Vec<Influence>, DesignFault> {
    let suspension = &own.suspension;
    let outputs: Vec<Output> = plan
        .outputs
        .iter()
        .filter(|o| matches!(o.quantity(), Some(Quantity::Characteristic(_))))
        .map(|o| Output {
            highest: 0,
            ..o.clone()
        })
        .collect();
    if outputs.is_empty() && plan.figures.is_empty() {
        return Ok(Vec::new());
    }
    let rate_order = outputs.iter().map(|o| o.of.rate_order()).max();
    let points = 0..suspension.mechanism.points.len();
    let found = wheel_curves(
        own,
        &Plan {
            racks: plan.racks[..1].to_vec(),
            time: None,
            coefficients: rate_order.unwrap_or(0) + 1,
            sensitivities: points.map(PointId).collect(),
            outputs,
            certify: false,
            ..plan.clone()
        },
    )?;
    // Derivatives of each value with respect to each coordinate, over the motion. A station has no derivatives of values that do
    // not exist there.
    let coordinates = suspension.mechanism.points.len() * Axis::ALL.len();
    let mut over_motion: Vec<Vec<Sensitivity>> = Vec::new();
    over_motion.resize_with(found.columns.len() * coordinates, Vec::new);
    for slope in found.sensitivities {
        let coordinate = slope.point.0 * Axis::ALL.len() + slope.axis as usize;
        over_motion[slope.column * coordinates + coordinate].push(slope);
    }
    let mut influences = Vec::new();
    for slopes in over_motion {
        let Some(first) = slopes.first() else {
            continue;
        };
        let values = || slopes.iter().map(|s| s.value);
        let largest = values().max_by(|a, b| a.abs().total_cmp(&b.abs()));
        let mean_of = |f: &dyn Fn(f64) -> f64| values().map(f).sum::<f64>() / slopes.len() as f64;
        let mean = mean_of(&|v| v);
        let influence = Influence {
            output: found.columns[first.column].name.clone(),
            coordinate: format!(
                "{}.{}",
                suspension.mechanism.name(first.point),
                first.axis.name()
            ),
            largest: largest.unwrap_or(0.0),
            rms: mean_of(&|v| v * v).sqrt(),
            bend: mean_of(&|v| (v - mean) * (v - mean)).sqrt(),
        };
        if influence.rms > 0.0 && influence.rms.is_finite() {
            influences.push(influence);
        }
    }
    Ok(influences)
}
