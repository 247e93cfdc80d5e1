//! Influence of one hardpoint coordinate on each curve of a wheel or an axle.

use super::answer::{asking_for, in_motion, thinned};
use super::message::{InfluenceAnswer, InfluenceColumn, InfluenceRequest};
use super::study_file::Opened;
use crate::curves::wheel_curves;
use crate::model::{Axis, PointId};
use crate::plan::Plan;
use crate::study::Vehicle;

/// Derivatives of the requested columns of the curves with respect to one hardpoint coordinate, at each station. Unit: unit of
/// the column per length unit. The stations equal the stations of the curves at the same `curves_rack`.
pub(super) fn influence(
    opened: &Opened,
    request: &InfluenceRequest,
) -> Result<InfluenceAnswer, String> {
    let study = opened.moved(&request.of.design)?;
    let Some(axis) = Axis::ALL.get(request.axis) else {
        return Err("expected an axis 0, 1 or 2".to_owned());
    };
    if request.point >= study.wheel().design.len() {
        return Err("there is no such point".to_owned());
    }
    let point = PointId(request.point);
    let names = &request.characteristics;
    let shown = in_motion(&study, request.motion.as_deref())?;
    let own = match &shown.vehicle {
        Vehicle::Axle(both) => return super::axle::influence(both, request, point, *axis),
        Vehicle::Wheel(own) => own,
    };
    let mut plan = Plan {
        sensitivities: vec![point],
        loads: Vec::new(),
        ..Plan::of(&asking_for(own, names)?)
    };
    if let Some(rack) = request.curves_rack {
        plan.racks = vec![rack];
    }
    let plan = thinned(plan);
    let suspension = &own.suspension;
    let found = wheel_curves(own, &plan).map_err(|f| f.describe(&suspension.mechanism))?;
    let stations = found.stations.len();
    let mut columns: Vec<InfluenceColumn> = found
        .columns
        .iter()
        .map(|column| InfluenceColumn {
            column: column.name.clone(),
            slopes: vec![None; stations],
        })
        .collect();
    for s in found.sensitivities.iter().filter(|s| s.axis == *axis) {
        columns[s.column].slopes[s.station] = s.value.is_finite().then_some(s.value);
    }
    Ok(InfluenceAnswer { columns })
}
