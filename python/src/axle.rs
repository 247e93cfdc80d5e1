//! Curves and limits of both wheels.

use crate::errors::failure;
use crate::study::{cause_of, ends};
use crate::threads::on_threads;
use hardpoint::analyse::Range;
use hardpoint::axle::{AxleEnd, TravelRanges};
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
    let ranges: [(&str, &Range, f64); 2] = match &found.travels {
        TravelRanges::OfWheels([left, right]) => {
            [("left_travel", left, 1.0), ("right_travel", right, 1.0)]
        }
        TravelRanges::OfAxle {
            heave,
            half_difference,
        } => [
            ("heave", heave, 1.0),
            ("travel_difference", half_difference, 2.0),
        ],
    };
    for (name, range, factor) in ranges {
        let causes = [&range.lower, &range.upper].map(cause_of);
        result.set_item(name, ends(causes, factor))?;
    }
    let end = |end: &AxleEnd| {
        let (_, cause) = cause_of(&end.end);
        let cause = match axle.is_rigid() {
            true => cause,
            false => format!("{} wheel: {cause}", end.side.name()),
        };
        (end.value, cause)
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
