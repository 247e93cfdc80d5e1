//! Limits of a design, and the nearest limits among builds.

use crate::answers::tolerance_of;
use crate::errors::failure;
use crate::study::Study;
use crate::threads::{interruptible, on_threads};
use hardpoint::limits::{LimitEnd, LimitRow, NearestEnd, NearestLimits, VehicleLimits};
use hardpoint::scatter;
use hardpoint::tolerance::Problem;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Lower and upper end of each quantity, by name. `None` if nothing moves the quantity.
type Ranges<'py> = Bound<'py, PyDict>;

/// Limits of a study: (lower, upper) with their causes. A wheel has limits of travel, rack and arm angle. An axle has limits of
/// its travels, rack and roll. Elastic parts add limits of their loads.
#[pyfunction]
pub(crate) fn limits<'py>(py: Python<'py>, study: &Study) -> PyResult<Ranges<'py>> {
    let own = study.whole();
    let found = on_threads(py, Some(1), |_| {
        VehicleLimits::of_vehicle(own, &own.vehicle)
    })?;
    let rows = found.map_err(failure)?.rows;
    let result = PyDict::new(py);
    for (name, row) in names(own, &rows).into_iter().zip(&rows) {
        let [lower, upper] = row.ends.each_ref().map(|end| (value(end), &end.cause));
        result.set_item(name, (lower, upper))?;
    }
    add_missing(own, &result)?;
    Ok(result)
}

/// Nearest limits among the first builds of `[tolerance]`: (lower, upper), each with its cause and its build. If no build has
/// limits, the limits are NaN and have no build. Also returns the number of builds that have no limits. `progress(done, all)` is
/// called on this thread.
#[pyfunction]
#[pyo3(signature = (study, builds, threads=None, progress=None))]
pub(crate) fn limits_of_builds<'py>(
    py: Python<'py>,
    study: &Study,
    builds: u64,
    threads: Option<usize>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<(Ranges<'py>, u64)> {
    if builds == 0 {
        return Err(failure("builds is 0; expected at least 1"));
    }
    let own = study.whole();
    let tolerance = tolerance_of(own)?;
    let done = AtomicU64::new(0);
    let work = |flag: &AtomicBool| -> Result<(Vec<LimitRow>, NearestLimits), String> {
        let problem = Problem::of(own, tolerance).map_err(|why| scatter::refusal(own, why))?;
        let nominal = VehicleLimits::of_vehicle(own, &own.vehicle)?;
        let one = |number| {
            let limits = VehicleLimits::of_build(own, &problem, number);
            done.fetch_add(1, Ordering::Relaxed);
            NearestLimits::of(number, limits)
        };
        let all = (0..builds).into_par_iter();
        let heard = all.take_any_while(|_| !flag.load(Ordering::Relaxed));
        let nearest = heard
            .map(one)
            .reduce(NearestLimits::default, NearestLimits::and);
        Ok((nominal.rows, nearest))
    };
    let listen = |_: Python<'_>, _: &AtomicBool| match &progress {
        None => Ok(()),
        Some(progress) => {
            let done = done.load(Ordering::Relaxed);
            progress.call1((done, builds)).map(drop)
        }
    };
    let (rows, nearest) = interruptible(py, threads, work, listen)?.map_err(failure)?;
    let result = PyDict::new(py);
    for (place, name) in names(own, &rows).into_iter().enumerate() {
        let end = |nearest: Option<&NearestEnd>| match nearest {
            Some(NearestEnd { end, build }) => (value(end), end.cause.clone(), Some(*build)),
            None => (f64::NAN, "no build has limits".to_owned(), None),
        };
        let ends = nearest.rows.get(place);
        let [lower, upper] = [0, 1].map(|side| end(ends.map(|ends| &ends[side])));
        result.set_item(name, (lower, upper))?;
    }
    add_missing(own, &result)?;
    Ok((result, nearest.rejected.0))
}

/// Value of a limit; NaN for an unknown or missing limit.
fn value(end: &LimitEnd) -> f64 {
    end.value.unwrap_or(f64::NAN)
}

/// Names of the rows of the table of limits. A name is the quantity without the study's unit of length. Further rows of the
/// same quantity also name the fixed positions of the other quantities, as in `travel, rack 10`.
fn names(own: &hardpoint::Study, rows: &[LimitRow]) -> Vec<String> {
    let length = format!("_{}", own.wheel().length_unit.symbol());
    let mut names: Vec<String> = Vec::new();
    for row in rows {
        let quantity = row.quantity.as_str();
        // In a unit of moment, such as newton metres, the unit of length stays in the name.
        let short = quantity
            .strip_suffix(&length)
            .filter(|rest| !rest.ends_with("_N"));
        let name = short.unwrap_or(quantity).to_owned();
        let name = if names.contains(&name) {
            format!("{name}, {}", row.at)
        } else {
            name
        };
        names.push(name);
    }
    names
}

/// Adds `None` for each usual quantity that this study does not move.
fn add_missing(own: &hardpoint::Study, result: &Ranges<'_>) -> PyResult<()> {
    let usual: &[&str] = match own.axle() {
        None => &["travel", "rack", "arm_angle_deg"],
        Some(_) => &["rack", "roll_deg"],
    };
    for name in usual {
        if !result.contains(name)? {
            result.set_item(name, None::<f64>)?;
        }
    }
    Ok(())
}
