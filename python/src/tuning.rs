//! Tuning.

use crate::errors::failure;
use crate::study::Study;
use crate::threads::on_threads;
use hardpoint::SideEffect;
use hardpoint::optimise::{Control, TargetLayout, evaluated, tune};
use hardpoint::report::FittedOffset;
use hardpoint::side_effects::side_effects;
use hardpoint::study::{Optimise, Variable};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A study and its `[optimise]`.
fn tuned(study: &Study) -> PyResult<(&hardpoint::study::Study, &Optimise)> {
    let own = &study.study;
    let optimise = own.optimise.as_ref().ok_or_else(|| {
        failure("the study has no [optimise], which says what may move and what is wanted")
    })?;
    Ok((own, optimise))
}

/// Tunes a study towards its targets.
#[pyfunction]
#[pyo3(signature = (study, threads=None))]
pub(crate) fn optimise<'py>(
    py: Python<'py>,
    study: &Study,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let (own, optimise) = tuned(study)?;
    let tuning = py.detach(|| {
        on_threads(threads, || {
            tune(&own.suspension, &own.motion, optimise, Control::default())
        })
    })?;
    py.check_signals()?;
    let tuning = tuning.map_err(|fault| study.fault(&fault))?;
    let result = PyDict::new(py);
    result.set_item("before", tuning.before.as_ref().map(|b| b.misfit).ok())?;
    let names: Vec<String> = optimise.variables.iter().map(Variable::label).collect();
    result.set_item("variables", names)?;
    match &tuning.best {
        None => {
            result.set_item("x", py.None())?;
            result.set_item("misfit", f64::NAN)?;
            result.set_item("text", py.None())?;
        }
        Some(best) => {
            result.set_item("x", best.offsets.clone().into_pyarray(py))?;
            result.set_item("misfit", best.after.misfit)?;
            let targets = best.after.targets.iter();
            let targets: Vec<(f64, f64, f64)> =
                targets.map(|t| (t.rms, t.worst, t.worst_at)).collect();
            result.set_item("targets", targets)?;
            if let Some(errors) = &best.errors {
                let fitted = errors.intervals.iter().map(|i| FittedOffset::from(*i));
                let fitted: Vec<(&str, Option<f64>, Option<f64>)> = fitted
                    .map(|fitted| {
                        let [lower, upper] = fitted.ends();
                        (fitted.word(), lower, upper)
                    })
                    .collect();
                result.set_item("scatter", errors.scatter)?;
                result.set_item("standard_errors", errors.sigmas.clone())?;
                result.set_item("intervals", fitted)?;
            }
            let moved = own.moved(&best.offsets);
            let effects = py.detach(|| side_effects(own, &moved));
            let effects = effects.map_err(|fault| study.fault(&fault))?;
            let effects = effects.iter().map(|effect| side_effect(py, effect));
            result.set_item("side_effects", effects.collect::<PyResult<Vec<_>>>()?)?;
            result.set_item("text", own.with_points_of(&moved))?;
        }
    }
    Ok(result)
}

/// A side effect by its fields.
fn side_effect<'py>(py: Python<'py>, effect: &SideEffect) -> PyResult<Bound<'py, PyDict>> {
    let fields = PyDict::new(py);
    fields.set_item("output", &effect.output)?;
    fields.set_item("unit", &effect.unit)?;
    fields.set_item("before_min", effect.before_min)?;
    fields.set_item("before_max", effect.before_max)?;
    fields.set_item("after_min", effect.after_min)?;
    fields.set_item("after_max", effect.after_max)?;
    fields.set_item("largest_change", effect.largest_change)?;
    let at = PyDict::new(py);
    for place in &effect.at {
        at.set_item(format!("{}_{}", place.name, place.unit), place.value)?;
    }
    fields.set_item("at", at)?;
    fields.set_item("wheel", &effect.wheel)?;
    fields.set_item("tolerance", effect.tolerance)?;
    fields.set_item("flagged", effect.flagged)?;
    fields.set_item("lost", effect.lost)?;
    Ok(fields)
}

/// The targets of a study as least squares.
#[pyclass(frozen, module = "hardpoint._hardpoint")]
pub(crate) struct Residuals {
    study: hardpoint::study::Study,
    layout: TargetLayout,
}

#[pymethods]
impl Residuals {
    #[new]
    fn new(study: &Study) -> PyResult<Self> {
        let (own, optimise) = tuned(study)?;
        let layout = TargetLayout::of(optimise, &own.motion, &own.suspension);
        Ok(Residuals {
            study: own.clone(),
            layout,
        })
    }

    #[getter]
    fn variables(&self) -> Vec<String> {
        let variables = self.study.optimise.iter().flat_map(|o| &o.variables);
        variables.map(Variable::label).collect()
    }

    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let variables = self.study.optimise.iter().flat_map(|o| &o.variables);
        let flat: Vec<f64> = variables.flat_map(|v| v.range).collect();
        let count = flat.len() / 2;
        flat.into_pyarray(py).reshape([count, 2])
    }

    fn value_and_jacobian<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>)> {
        let variables = self
            .study
            .optimise
            .as_ref()
            .map_or(&[][..], |o| &o.variables);
        let x = x.as_slice().map_err(|_| failure("x is not contiguous"))?;
        if x.len() != variables.len() {
            return Err(failure(format!(
                "x has shape ({},); expected ({},), a value for each of names",
                x.len(),
                variables.len()
            )));
        }
        if let Some(bad) = x.iter().find(|v| !v.is_finite()) {
            return Err(failure(format!("x has {bad}; expected finite offsets")));
        }
        let suspension = &self.study.suspension;
        let evaluation = py
            .detach(|| evaluated(suspension, variables, &self.layout, x))
            .map_err(|fault| failure(fault.describe(&suspension.mechanism)))?
            .map_err(|infeasible| failure(infeasible.to_string()))?;
        let (rows, columns) = evaluation.jacobian.shape();
        // nalgebra lies column by column.
        let jacobian: Vec<f64> = (0..rows)
            .flat_map(|r| (0..columns).map(move |c| (r, c)))
            .map(|at| evaluation.jacobian[at])
            .collect();
        let values: Vec<f64> = evaluation.residuals.iter().copied().collect();
        Ok((
            values.into_pyarray(py),
            jacobian.into_pyarray(py).reshape([rows, columns])?,
        ))
    }
}
