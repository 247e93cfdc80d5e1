//! Curves of a study.

use crate::errors::failure;
use crate::status;
use crate::study::Study;
use crate::threads::on_threads;
use hardpoint::curves::{Curves, Status};
use hardpoint::model::Side;
use hardpoint::study::Vehicle;
use numpy::{IntoPyArray, PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Builds the columns of a result table, with their units and signs.
pub(crate) struct Columns<'py> {
    py: Python<'py>,
    columns: Bound<'py, PyDict>,
    info: Bound<'py, PyDict>,
}

impl<'py> Columns<'py> {
    pub(crate) fn new(py: Python<'py>) -> Self {
        let (columns, info) = (PyDict::new(py), PyDict::new(py));
        Columns { py, columns, info }
    }

    /// Adds a column; a missing value becomes NaN. `info` holds the name of its output, its unit, and the meaning of a positive
    /// value.
    pub(crate) fn push(
        &self,
        name: &str,
        info: (&str, &str, Option<&str>),
        values: impl Iterator<Item = Option<f64>>,
    ) -> PyResult<()> {
        let values: Vec<f64> = values.map(|v| v.unwrap_or(f64::NAN)).collect();
        let values: Bound<'_, PyArray1<f64>> = values.into_pyarray(self.py);
        self.columns.set_item(name, values)?;
        self.info.set_item(name, info)
    }

    /// Returns the result table: columns, info, status codes, and a reason for each station whose values are missing or doubtful.
    pub(crate) fn finish(
        self,
        stations: impl Iterator<Item = (&'static str, Option<String>)>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (mut codes, reasons) = (Vec::new(), PyDict::new(self.py));
        for (number, (word, reason)) in stations.enumerate() {
            codes.push(status::code(word));
            if let Some(reason) = reason {
                reasons.set_item(number, reason)?;
            }
        }
        let result = PyDict::new(self.py);
        result.set_item("columns", self.columns)?;
        result.set_item("info", self.info)?;
        result.set_item("status", codes.into_pyarray(self.py))?;
        result.set_item("reasons", reasons)?;
        Ok(result)
    }
}

/// Reason why a station has no values or doubtful values, from its status word. `None` for a station without doubt.
pub(crate) fn reason(word: &str) -> Option<String> {
    let reason = match word {
        "ok" => return None,
        "ill_conditioned" => {
            "close to a singular pose: derivatives have fewer than six correct digits"
        }
        "unsupported" => "the mechanism cannot carry the loads in this pose: forces have no values",
        "toggle" => "a rod is at a toggle: quantities of its rocker have no values",
        other => other,
    };
    Some(reason.to_owned())
}

/// Curves over the motion of `[motion]` or over one of `[motions]`: columns, stations, statuses, and sensitivities if the study
/// requests them.
#[pyfunction]
#[pyo3(signature = (study, motion=None, threads=None))]
pub(crate) fn solve<'py>(
    py: Python<'py>,
    study: &Study,
    motion: Option<&str>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    match motion {
        None => of_own_motion(py, study, &study.study, threads),
        Some(name) => of_own_motion(py, study, &in_motion(&study.study, name)?, threads),
    }
}

/// Study with one of its `[motions]` as its motion.
pub(crate) fn in_motion(
    own: &hardpoint::study::Study,
    name: &str,
) -> PyResult<hardpoint::study::Study> {
    own.in_motion(name).ok_or_else(|| {
        let known = own.motion_names();
        let known = if known.is_empty() {
            "none".to_owned()
        } else {
            known.join(", ")
        };
        failure(format!(
            "there is no motion {name:?}; [motions] has {known}"
        ))
    })
}

fn of_own_motion<'py>(
    py: Python<'py>,
    study: &Study,
    own: &hardpoint::study::Study,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let found = on_threads(py, threads, |_| own.curves())?;
    let found = found.map_err(|error| failure(error.to_string()))?;
    let stations = &found.stations;
    let columns = Columns::new(py);
    let mut motion = Vec::new();
    for c in found.motion.iter().filter(|c| c.is_written) {
        let positive = match c.key {
            "travel" | "travel_left" | "travel_right" | "heave" => Some("in jounce"),
            "roll" => Some("right wheel in jounce, as in a left turn"),
            "rack" => Some("along the study's +y"),
            "steering_wheel_angle" => Some("to the left"),
            _ => None,
        };
        columns.push(&c.name(), (c.key, c.unit, positive), found.along(c.key))?;
        motion.push(c.name());
    }
    // The name of the drive comes first in the list.
    if let Some(drive) = found.motion.iter().find(|c| c.is_given && c.is_written) {
        motion.sort_by_key(|name| *name != drive.name());
    }
    for (k, c) in found.columns.iter().enumerate() {
        let values = stations.iter().map(|s| s.value(k));
        columns.push(&c.name, (&c.output, &c.unit, c.positive), values)?;
    }
    for (k, name) in found.bounds.iter().enumerate() {
        let (output, unit) = name.rsplit_once('_').unwrap_or((name, ""));
        let values = stations.iter().map(|s| Some(s.proof.as_ref()?.bounds[k]));
        columns.push(name, (output, unit, None), values)?;
    }
    let (length, frame) = (own.wheel().length_unit, own.wheel().frame);
    let result = columns.finish(stations.iter().map(|station| {
        let word = station.status.word();
        let reason = match station.status {
            Status::Failed(failure) => Some(failure.describe(length, frame)),
            _ => reason(word),
        };
        (word, reason)
    }))?;
    result.set_item("motion", motion)?;
    let names = found.columns.iter().map(|c| c.name.as_str());
    result.set_item("outputs", names.collect::<Vec<_>>())?;
    set_sensitivities(py, study, &found, &result)?;
    Ok(result)
}

/// Adds the sensitivities of curves to a result. Their axes are `[station][column][point][axis]`; an axle has the side as first
/// axis.
fn set_sensitivities(
    py: Python<'_>,
    study: &Study,
    found: &Curves,
    result: &Bound<'_, PyDict>,
) -> PyResult<()> {
    let study = &study.study;
    let (points, sides) = match &study.vehicle {
        Vehicle::Axle(both) => {
            let sides = if both.axle.right.is_some() { 2 } else { 1 };
            (&both.plan.sensitivities, Some(sides))
        }
        Vehicle::Wheel(own) => (&own.outputs.sensitivities, None),
    };
    if points.is_empty() {
        return Ok(());
    }
    let shape = [found.stations.len(), found.columns.len(), points.len(), 3];
    let known = found.sensitivities.iter().filter_map(|s| {
        let point = points.iter().position(|p| *p == s.point)?;
        Some((s, [s.station, s.column, point, s.axis as usize]))
    });
    let array = match sides {
        None => mostly_nan(py, shape, known.map(|(s, at)| (at, s.value))),
        Some(sides) => {
            let [stations, columns, points, axes] = shape;
            let known = known.map(|(s, [station, column, point, axis])| {
                let side = usize::from(s.side == Some(Side::Right));
                ([side, station, column, point, axis], s.value)
            });
            mostly_nan(py, [sides, stations, columns, points, axes], known)
        }
    };
    let names = points.iter().map(|p| study.wheel().mechanism.name(*p));
    result.set_item("sensitivities", array)?;
    result.set_item("sensitivity_points", names.collect::<Vec<_>>())
}

/// Array with the given values at their indices and NaN everywhere else.
pub(crate) fn mostly_nan<const N: usize>(
    py: Python<'_>,
    shape: [usize; N],
    known: impl Iterator<Item = ([usize; N], f64)>,
) -> Bound<'_, PyArrayDyn<f64>> {
    let array = PyArrayDyn::<f64>::zeros(py, &shape[..], false);
    // numpy's borrow checker refuses the strides of an empty array.
    if !shape.contains(&0) {
        let mut write = array.readwrite();
        let mut view = write.as_array_mut();
        view.fill(f64::NAN);
        for (at, value) in known {
            view[&at[..]] = value;
        }
    }
    array
}
