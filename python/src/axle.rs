//! Curves of both wheels.

use crate::errors::failure;
use hardpoint::axle::axle_curves;
use hardpoint::model::Side;
use hardpoint::report::axle_motion;
use hardpoint::study::AxleStudy;
use numpy::{IntoPyArray, PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The curves of an axle: columns, where the stations are, statuses and, where the study asks for them,
/// sensitivities (stations, columns, points, 3), for each side where the right one has hardpoints of its own.
pub(crate) fn solve<'py>(
    py: Python<'py>,
    AxleStudy { axle, plan }: &AxleStudy,
) -> PyResult<Bound<'py, PyDict>> {
    let found = py
        .detach(|| axle_curves(axle, plan))
        .map_err(|(side, fault)| {
            let mechanism = &axle.suspension(side).mechanism;
            failure(format!(
                "{} wheel: {}",
                side.name(),
                fault.describe(mechanism)
            ))
        })?;
    let array = |values: Vec<f64>| -> Bound<'py, PyArray1<f64>> { values.into_pyarray(py) };
    let stations = &found.stations;
    let (columns, info) = (PyDict::new(py), PyDict::new(py));
    for (k, c) in found.columns.iter().enumerate() {
        let values = stations.iter().map(|s| s.value(k).unwrap_or(f64::NAN));
        columns.set_item(&c.name, array(values.collect()))?;
        let positive = c.by.is_none().then(|| c.quantity.positive());
        info.set_item(&c.name, (c.quantity.name(), &c.unit, positive))?;
    }
    let motion = PyDict::new(py);
    for (name, values) in axle_motion(axle, plan, &found) {
        let values = values.into_iter().map(|v| v.unwrap_or(f64::NAN));
        motion.set_item(name, array(values.collect()))?;
    }
    let result = PyDict::new(py);
    result.set_item("columns", columns)?;
    result.set_item("info", info)?;
    result.set_item("motion", motion)?;
    let words: Vec<&str> = stations.iter().map(|s| s.status).collect();
    result.set_item("status", words)?;
    let points = &plan.sensitivities;
    if !points.is_empty() {
        let sides = if axle.right.is_some() { 2 } else { 1 };
        let shape = [sides, stations.len(), found.columns.len(), points.len(), 3];
        let sensitivities = PyArrayDyn::<f64>::zeros(py, &shape[..], false);
        {
            let mut write = sensitivities.readwrite();
            let mut view = write.as_array_mut();
            view.fill(f64::NAN);
            for s in &found.sensitivities {
                let side = usize::from(s.side == Some(Side::Right));
                if let Some(p) = points.iter().position(|p| *p == s.point) {
                    view[&[side, s.station, s.column, p, s.axis as usize][..]] = s.value;
                }
            }
        }
        let names = points.iter().map(|p| axle.left.mechanism.name(*p));
        result.set_item("sensitivities", sensitivities)?;
        result.set_item("sensitivity_points", names.collect::<Vec<_>>())?;
    }
    Ok(result)
}
