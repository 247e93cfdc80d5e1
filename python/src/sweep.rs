//! Sweeps into arrays.

use crate::errors::failure;
use crate::study::Study;
use crate::threads::on_threads;
use hardpoint::study::StudyErrors;
use hardpoint::sweep::{NotBegun, Rows, SweepPlan, in_order};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Blocks between two looks for Ctrl-C.
const PIECE: u64 = 512;

fn not_begun(study: &Study, error: NotBegun) -> PyErr {
    let of_file = |errors: StudyErrors| crate::errors::study_error(&errors);
    match error {
        NotBegun::Designs(errors) => of_file(errors),
        NotBegun::Fault(fault) => study.fault(&fault),
        NotBegun::TwoColumns(name) => failure(format!("two columns would be named {name}")),
    }
}

/// The rows of a sweep: a column for each variable and output, the numbers of the designs that failed and why.
#[pyfunction]
#[pyo3(signature = (study, threads=None))]
pub(crate) fn sweep<'py>(
    py: Python<'py>,
    study: &Study,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let own = &study.study;
    let Some(sweep) = &own.sweep else {
        return Err(failure(
            "the study has no [sweep], which says which designs there are",
        ));
    };
    let plan = SweepPlan::of(own, sweep).map_err(|e| not_begun(study, e))?;
    let record = &plan.record;
    let names: Vec<String> = record
        .variables
        .iter()
        .map(|v| v.column.clone())
        .chain(record.outputs.iter().map(|o| o.column.clone()))
        .collect();
    let width = record.variables.len();
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
    let mut failed: Vec<i64> = Vec::new();
    let mut reasons: Vec<String> = Vec::new();
    let blocks = record.blocks();
    let mut first = 0;
    while first < blocks {
        let end = blocks.min(first + PIECE);
        let done = py.detach(|| {
            on_threads(threads, || {
                in_order(
                    first..end,
                    || plan.worker(),
                    |worker, block| worker.as_mut().ok().map(|w| w.rows(block).clone()),
                    |rows: Rows| {
                        for design in 0..rows.designs() {
                            for (column, value) in columns.iter_mut().zip(rows.variables(design)) {
                                column.push(*value);
                            }
                            for (column, value) in
                                columns[width..].iter_mut().zip(rows.outputs(design))
                            {
                                column.push(*value);
                            }
                            if let Some(failing) = &rows.failing[design] {
                                failed.push(rows.first as i64 + design as i64);
                                reasons.push(failing.reason.clone());
                            }
                        }
                        Ok::<(), std::convert::Infallible>(())
                    },
                )
            })
        })?;
        match done {
            Ok(()) => {}
            Err(never) => match never {},
        }
        py.check_signals()?;
        first = end;
    }
    let table = PyDict::new(py);
    for (name, column) in names.iter().zip(columns) {
        let column: Bound<'py, PyArray1<f64>> = column.into_pyarray(py);
        table.set_item(name, column)?;
    }
    let result = PyDict::new(py);
    result.set_item("columns", table)?;
    result.set_item("failed", failed.into_pyarray(py))?;
    result.set_item("reasons", reasons)?;
    Ok(result)
}

/// The number of parts of a study's sweep, each 131,072 designs or a little fewer.
#[pyfunction]
pub(crate) fn sweep_parts(study: &Study) -> PyResult<u64> {
    let own = &study.study;
    let Some(sweep) = &own.sweep else {
        return Err(failure(
            "the study has no [sweep], which says which designs there are",
        ));
    };
    let plan = SweepPlan::of(own, sweep).map_err(|e| not_begun(study, e))?;
    Ok(plan.record.parts())
}
