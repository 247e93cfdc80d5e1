//! Sweeps into arrays.

use crate::errors::failure;
use crate::function::{named, rows};
use crate::study::Study;
use crate::threads::on_threads;
use hardpoint::study::{DesignTable, Designs, FileFormat, StudyErrors, Sweep};
use hardpoint::sweep::{NotBegun, SweepPlan};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// Blocks between two looks for Ctrl-C at first, and how long they should take: at the end of a piece the threads wait for
/// one another, and whoever stops it for the piece to end.
const PIECE: u64 = 64;
const SHORT: Duration = Duration::from_millis(200);

fn not_begun(study: &Study, error: NotBegun) -> PyErr {
    let of_file = |errors: StudyErrors| crate::errors::study_error(&errors);
    match error {
        NotBegun::Designs(errors) => of_file(errors),
        NotBegun::Fault(fault) => study.fault(&fault),
        NotBegun::TwoColumns(name) => failure(format!("two columns would be named {name}")),
    }
}

/// The designs of a study's own `[sweep]`.
fn own_sweep(study: &Study) -> PyResult<&Sweep> {
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
    let variables = named(own, variables).map_err(|e| failure(e.to_string()))?;
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

/// The rows of a sweep: a column for each variable and output, the numbers of the designs that failed and why. Of
/// the study's own designs, or of those in the rows of `x`.
#[pyfunction]
#[pyo3(signature = (study, x=None, variables=None, threads=None))]
pub(crate) fn sweep<'py>(
    py: Python<'py>,
    study: &Study,
    x: Option<PyReadonlyArray2<'py, f64>>,
    variables: Option<Vec<String>>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let own = &study.study;
    let given = x.map(|x| given(study, &x, variables)).transpose()?;
    let sweep = match &given {
        Some(sweep) => sweep,
        None => own_sweep(study)?,
    };
    let plan = SweepPlan::of(own, sweep).map_err(|e| not_begun(study, e))?;
    let record = &plan.record;
    let names = record.value_columns();
    let width = record.variables.len();
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
    for column in &mut columns {
        let room = column.try_reserve_exact(usize::try_from(record.designs).unwrap_or(usize::MAX));
        room.map_err(|_| {
            let (designs, columns) = (record.designs, names.len());
            failure(format!(
                "{designs} designs with {columns} columns do not fit into memory"
            ))
        })?;
    }
    let mut failed: Vec<i64> = Vec::new();
    let mut reasons: Vec<String> = Vec::new();
    let blocks = record.blocks();
    let (mut first, mut piece) = (0, PIECE);
    while first < blocks {
        let (end, begun) = (blocks.min(first + piece), Instant::now());
        py.detach(|| {
            on_threads(threads, || {
                plan.run(
                    first..end,
                    || true,
                    |rows| {
                        let (of_variables, of_outputs) = columns.split_at_mut(width);
                        append(&rows.variables, of_variables);
                        append(&rows.outputs, of_outputs);
                        for design in 0..rows.designs() {
                            if let Some(failing) = &rows.failing[design] {
                                failed.push(rows.first as i64 + design as i64);
                                reasons.push(failing.reason.clone());
                            }
                        }
                        ControlFlow::Continue(())
                    },
                );
            })
        })?;
        py.check_signals()?;
        piece = match begun.elapsed() {
            took if took < SHORT => 2 * piece,
            took if took > 4 * SHORT => (piece / 2).max(1),
            _ => piece,
        };
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
    let sweep = own_sweep(study)?;
    let plan = SweepPlan::of(&study.study, sweep).map_err(|e| not_begun(study, e))?;
    Ok(plan.record.parts())
}
