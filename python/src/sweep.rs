//! Sweeps into arrays.

use crate::errors::{failure, too_large};
use crate::function::{named, rows};
use crate::status;
use crate::study::Study;
use crate::threads::{interruptible, on_threads};
use hardpoint::Rows;
use hardpoint::study::{DesignTable, Designs, FileFormat, StudyErrors, Sweep};
use hardpoint::sweep::{NotBegun, SweepPlan, SweepRecord, Swept};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

pub(crate) fn not_begun(study: &Study, error: NotBegun) -> PyErr {
    let of_file = |errors: StudyErrors| crate::errors::study_error(&errors);
    match error {
        NotBegun::Designs(errors) => of_file(errors),
        NotBegun::Fault(fault) => study.fault(&fault),
        NotBegun::TwoColumns(name) => failure(format!("two columns would be named {name}")),
    }
}

/// The designs of a study's own `[sweep]`.
pub(crate) fn own_sweep(study: &Study) -> PyResult<&Sweep> {
    let sweep = study.study.sweep.as_ref();
    sweep.ok_or_else(|| {
        failure("the study has no [sweep], which says which designs there are; give them as x")
    })
}

/// The designs given as rows of an array, a column for each of these variables.
fn given(
    study: &Study,
    x: &PyReadonlyArray2<'_, f64>,
    variables: Option<Vec<String>>,
) -> PyResult<Sweep> {
    let own = &study.study;
    let variables = named(own, variables)?;
    let swept = variables.iter().map(|variable| {
        let turns = || {
            failure(format!(
                "{} is a turn, which sweeps do not know",
                variable.name
            ))
        };
        variable.swept_as().ok_or_else(turns)
    });
    let values = rows(x, variables.len())?;
    let table = DesignTable::of(swept.collect::<PyResult<_>>()?, values.to_vec());
    Ok(Sweep {
        designs: Designs::Given(table.map_err(|reason| failure(format!("x: {reason}")))?),
        curves: false,
        format: FileFormat::Csv,
    })
}

/// Appends rows, one after another, to columns.
fn append(rows: &[f64], columns: &mut [Vec<f64>]) {
    let width = columns.len();
    for (k, column) in columns.iter_mut().enumerate() {
        column.extend(rows.iter().skip(k).step_by(width));
    }
}

/// Rows that are taken from the threads.
struct Table {
    columns: Vec<Vec<f64>>,
    status: Vec<u8>,
    reasons: Vec<(u64, String)>,
}

impl Table {
    /// Room for the rows of a sweep, or `MemoryError`.
    fn of(record: &SweepRecord) -> PyResult<Self> {
        let designs = usize::try_from(record.designs).unwrap_or(usize::MAX);
        let count = record.value_columns().len();
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); count];
        let mut status = Vec::new();
        let room = (columns.iter_mut()).try_for_each(|column| column.try_reserve_exact(designs));
        let room = room.and_then(|()| status.try_reserve_exact(designs));
        room.map_err(|_| too_large(&[designs, count]))?;
        Ok(Table {
            columns,
            status,
            reasons: Vec::new(),
        })
    }

    fn append(&mut self, rows: &Rows, variables: usize) {
        let (of_variables, of_outputs) = self.columns.split_at_mut(variables);
        append(&rows.variables, of_variables);
        append(&rows.outputs, of_outputs);
        for (design, failing) in rows.failing.iter().enumerate() {
            let word = failing.as_ref().map_or("ok", |failing| &failing.status);
            self.status.push(status::code(word));
            if let Some(failing) = failing {
                let design = rows.first + design as u64;
                self.reasons.push((design, failing.reason.clone()));
            }
        }
    }
}

/// The rows of a sweep: a column for each variable and output, the status of each design, and why designs failed. Of
/// the study's own designs, or of those in the rows of `x`. `progress(done, all)` is called on this thread.
#[pyfunction]
#[pyo3(signature = (study, x=None, variables=None, threads=None, progress=None))]
pub(crate) fn sweep<'py>(
    py: Python<'py>,
    study: &Study,
    x: Option<PyReadonlyArray2<'py, f64>>,
    variables: Option<Vec<String>>,
    threads: Option<usize>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let own = &study.study;
    let given = x.map(|x| given(study, &x, variables)).transpose()?;
    let sweep = match &given {
        Some(sweep) => sweep,
        None => own_sweep(study)?,
    };
    let plan = on_threads(py, Some(1), |_| SweepPlan::of(own, sweep))?;
    let plan = plan.map_err(|e| not_begun(study, e))?;
    collect(py, Swept::Suspension(&plan), threads, progress)
}

/// The rows of a sweep: columns, number of variables, status and reasons.
pub(crate) fn collect<'py>(
    py: Python<'py>,
    swept: Swept<'_>,
    threads: Option<usize>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let record = swept.record();
    let mut table = Table::of(record)?;
    let done = AtomicU64::new(0);
    let listen = |_: Python<'_>, _: &AtomicBool| match &progress {
        None => Ok(()),
        Some(progress) => {
            let done = done.load(Ordering::Relaxed);
            progress.call1((done, record.designs)).map(drop)
        }
    };
    let work = |flag: &AtomicBool| {
        let go_on = || !flag.load(Ordering::Relaxed);
        swept.run(0..record.blocks(), go_on, |rows| {
            table.append(rows, record.variables.len());
            done.fetch_add(rows.designs() as u64, Ordering::Relaxed);
            ControlFlow::Continue(())
        });
    };
    interruptible(py, threads, work, listen)?;
    let columns = PyDict::new(py);
    for (name, column) in record.value_columns().iter().zip(table.columns) {
        let column: Bound<'py, PyArray1<f64>> = column.into_pyarray(py);
        columns.set_item(name, column)?;
    }
    let result = PyDict::new(py);
    result.set_item("columns", columns)?;
    result.set_item("variables", record.variables.len())?;
    result.set_item("status", table.status.into_pyarray(py))?;
    let reasons = PyDict::new(py);
    for (design, reason) in table.reasons {
        reasons.set_item(design, reason)?;
    }
    result.set_item("reasons", reasons)?;
    Ok(result)
}

/// The number of parts of a study's sweep, each 131,072 designs or a little fewer.
#[pyfunction]
pub(crate) fn sweep_parts(study: &Study) -> PyResult<u64> {
    let sweep = own_sweep(study)?;
    let plan = SweepPlan::of(&study.study, sweep).map_err(|e| not_begun(study, e))?;
    Ok(plan.record.parts())
}
