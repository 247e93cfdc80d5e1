//! Curves and limits of both wheels.

use crate::errors::failure;
use crate::study::{cause_of, ends};
use crate::threads::on_threads;
use hardpoint::axle::AxleEnd;
use hardpoint::model::Axis;
use hardpoint::study::AxleStudy;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The curves of an axle: columns, where the stations are, statuses and, where the study asks for them,
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
