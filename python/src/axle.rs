//! Curves and limits of both wheels.

use crate::curves::{Columns, mostly_nan, reason};
use crate::errors::failure;
use crate::study::{cause_of, ends};
use crate::threads::on_threads;
use hardpoint::axle::{AxleEnd, axle_curves};
use hardpoint::model::{Axis, Side};
use hardpoint::report::{axle_motion, axle_proofs};
use hardpoint::study::AxleStudy;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The curves of an axle: columns, where the stations are, statuses and, where the study asks for them,
/// sensitivities (stations, columns, points, 3), for each side where the right one has hardpoints of its own.
pub(crate) fn solve<'py>(
    py: Python<'py>,
    AxleStudy { axle, plan }: &AxleStudy,
) -> PyResult<Bound<'py, PyDict>> {
    let found = on_threads(py, Some(1), |_| axle_curves(axle, plan))?;
    let found = found.map_err(|fault| failure(axle.describe_fault(fault)))?;
    let stations = &found.stations;
    let columns = Columns::new(py);
    let mut motion = Vec::new();
    for (name, values) in axle_motion(axle, plan, &found) {
        let (output, unit) = name.rsplit_once('_').unwrap_or((&name, ""));
        columns.push(&name, (output, unit, None), values.into_iter())?;
        motion.push(name);
    }
    for (k, c) in found.columns.iter().enumerate() {
        let values = stations.iter().map(|s| s.value(k));
        columns.push(&c.name, (&c.output(), &c.unit, c.positive()), values)?;
    }
    for (name, values) in axle_proofs(axle, plan, &found) {
        let (output, unit) = name.rsplit_once('_').unwrap_or((&name, ""));
        columns.push(&name, (output, unit, None), values.into_iter())?;
    }
    let result = columns.finish(stations.iter().map(|station| {
        let reason = match &station.placed {
            Err(failure) => Some(failure.describe(axle)),
            Ok(_) => reason(station.status),
        };
        (station.status, reason)
    }))?;
    result.set_item("motion", motion)?;
    let names = found.columns.iter().map(|c| c.name.as_str());
    result.set_item("outputs", names.collect::<Vec<_>>())?;
    let points = &plan.sensitivities;
    if !points.is_empty() {
        let sides = if axle.right.is_some() { 2 } else { 1 };
        let shape = [sides, stations.len(), found.columns.len(), points.len(), 3];
        let known = found.sensitivities.iter().filter_map(|s| {
            let side = usize::from(s.side == Some(Side::Right));
            let p = points.iter().position(|p| *p == s.point)?;
            Some(([side, s.station, s.column, p, s.axis as usize], s.value))
        });
        let names = points.iter().map(|p| axle.left.mechanism.name(*p));
        result.set_item("sensitivities", mostly_nan(py, shape, known))?;
        result.set_item("sensitivity_points", names.collect::<Vec<_>>())?;
    }
    Ok(result)
}

/// How far both travels, the rack and roll go: (lower, upper) with their causes.
pub(crate) fn limits<'py>(
    py: Python<'py>,
    AxleStudy { axle, .. }: &AxleStudy,
) -> PyResult<Bound<'py, PyDict>> {
    let found = on_threads(py, Some(1), |_| axle.limits())?;
    let found = found.map_err(|fault| failure(axle.describe_fault(fault)))?;
    let result = PyDict::new(py);
    for (name, range) in ["left_travel", "right_travel"]
        .into_iter()
        .zip(&found.travels)
    {
        result.set_item(name, ends([&range.lower, &range.upper].map(cause_of), 1.0))?;
    }
    let end = |end: &AxleEnd| {
        let (_, cause) = cause_of(&end.end);
        (end.value, format!("{} wheel: {cause}", end.side.name()))
    };
    let sign = axle.left.frame.sign(Axis::Y);
    let rack = found.rack.as_ref();
    result.set_item(
        "rack",
        rack.map(|both| ends(both.each_ref().map(end), sign)),
    )?;
    let roll = match &found.roll {
        [Some(lower), Some(upper)] => Some([lower, upper].map(end)),
        _ => None,
    };
    result.set_item(
        "roll_deg",
        roll.map(|both| ends(both, 1.0_f64.to_degrees())),
    )?;
    Ok(result)
}
