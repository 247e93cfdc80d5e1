//! Sweeps whose results are arrays.

use crate::errors::{failure, not_done, study_error, too_large};
use crate::function::{named, rows};
use crate::status;
use crate::study::Study;
use crate::threads::{command, interruptible, on_threads};
use hardpoint::Rows;
use hardpoint::cli::NotDone;
use hardpoint::mechanism::DesignFault;
use hardpoint::report::{DrawnDesigns, SweepRun, SweepText, sweep_page as page_of};
use hardpoint::study::{DesignTable, Designs, FileFormat, StudyErrors, Sweep, SweepVariable};
use hardpoint::sweep::{NotBegun, SweepPlan, SweepRecord, Swept, SweptWorker, in_order};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

pub(crate) fn not_begun(study: &Study, error: NotBegun) -> PyErr {
    let of_file = |errors: StudyErrors| study_error(&errors);
    match error {
        NotBegun::Designs(errors) => of_file(errors),
        NotBegun::Fault(fault) => study.fault(&fault),
        NotBegun::Columns(fault) => failure(fault.to_string()),
    }
}

/// Sweep in the study's `[sweep]`.
pub(crate) fn own_sweep(study: &Study) -> PyResult<&Sweep> {
    let sweep = study.study.sweep.as_ref();
    sweep.ok_or_else(|| {
        failure("the study has no [sweep], which defines the designs; give them as x")
    })
}

/// Sweep of the designs in the rows of an array, with one column per variable.
fn given(
    study: &Study,
    x: &PyReadonlyArray2<'_, f64>,
    variables: Option<Vec<String>>,
) -> PyResult<Sweep> {
    let own = &study.study;
    let variables = swept(own, variables)?;
    let values = rows(x, variables.len())?;
    let table = DesignTable::of(variables, values.to_vec());
    Ok(Sweep {
        designs: Designs::Given(table.map_err(|reason| failure(format!("x: {reason}")))?),
        curves: own.sweep.as_ref().is_some_and(|sweep| sweep.curves),
        format: FileFormat::Csv,
        constraints: own.sweep.as_ref().is_none_or(|sweep| sweep.constraints),
    })
}

/// Returns the variables with these names, as columns of a table of designs. Without names, returns the variables that
/// the study moves. The name of a rate refers to a variable of the study's `[sweep]`.
fn swept(own: &hardpoint::Study, names: Option<Vec<String>>) -> PyResult<Vec<SweepVariable>> {
    let of_sweep = match own.sweep.as_ref().map(|sweep| &sweep.designs) {
        Some(Designs::Sampled(sampled)) => &sampled.variables[..],
        _ => &[],
    };
    let is_rate = |name: &str| of_sweep.iter().find(|v| v.rate.is_some() && v.name == name);
    let names = names.unwrap_or_else(|| {
        let variables = hardpoint::DesignVariable::of(own).into_iter();
        variables.map(|variable| variable.name).collect()
    });
    let is_second = |k: usize| is_rate(&names[k]).is_some() && names[..k].contains(&names[k]);
    if let Some(k) = (0..names.len()).find(|k| is_second(*k)) {
        let reason = format!(
            "the variable {} is given twice; remove one of the two",
            names[k]
        );
        return Err(failure(reason));
    }
    let of_points = names.iter().filter(|name| is_rate(name).is_none()).cloned();
    let mut of_points = named(own, Some(of_points.collect()))?.into_iter();
    let variable = |name: &String| {
        if let Some(rate) = is_rate(name) {
            return Ok(rate.clone());
        }
        let moved = of_points.next().and_then(|variable| variable.swept_as());
        moved.ok_or_else(|| {
            failure(format!(
                "{name} cannot be a column of designs: expected coordinates or offsets of hardpoints, or rates of [sweep]"
            ))
        })
    };
    names.iter().map(variable).collect()
}

/// Columns of the variables with these names, with their values in the study's design.
#[pyfunction]
pub(crate) fn sweep_columns(study: &Study, variables: Vec<String>) -> PyResult<Vec<(String, f64)>> {
    let variables = swept(&study.study, Some(variables))?;
    let wheel = study.study.wheel();
    let column = |variable: &SweepVariable| {
        let value = variable.at_design(wheel).ok_or_else(|| {
            failure(format!(
                "{} has no value at the design, because several hardpoints share it; use an offset",
                variable.name
            ))
        })?;
        Ok((variable.column(wheel.length_unit), value))
    };
    variables.iter().map(column).collect()
}

/// Distributes the values of consecutive rows to the columns.
fn append(rows: &[f64], columns: &mut [Vec<f64>]) {
    let width = columns.len();
    for (k, column) in columns.iter_mut().enumerate() {
        column.extend(rows.iter().skip(k).step_by(width));
    }
}

/// Table that collects the rows that several CPU threads compute.
struct Table {
    columns: Vec<Vec<f64>>,
    status: Vec<u8>,
    reasons: Vec<(u64, String)>,
}

impl Table {
    /// Reserves memory for the rows of a sweep, or raises `MemoryError`.
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

/// Rows of a sweep: one column per variable and output, the status of each design, and the reason for each failed design. The
/// designs come from `[sweep]` or from the rows of `x`. `progress(done, all)` is called on this thread.
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
    let text = plan.record.curves.then(|| SweepText::of(&plan, own, true));
    collect(
        py,
        Swept::Suspension(&plan),
        text.as_ref(),
        threads,
        progress,
    )
}

/// HTML page of a sweep. The designs come from `[sweep]` or from the rows of `x`. The function solves the designs again.
#[pyfunction]
#[pyo3(signature = (study, x=None, variables=None))]
pub(crate) fn sweep_page(
    py: Python<'_>,
    study: &Study,
    x: Option<PyReadonlyArray2<'_, f64>>,
    variables: Option<Vec<String>>,
) -> PyResult<String> {
    let own = study.whole();
    let given = x.map(|x| given(study, &x, variables)).transpose()?;
    let sweep = match &given {
        Some(sweep) => sweep,
        None => own_sweep(study)?,
    };
    let made = on_threads(py, None, |flag| -> Result<_, NotBegun> {
        let plan = SweepPlan::of(own, sweep)?;
        let go_on = || !flag.load(Ordering::Relaxed);
        let run = SweepRun::of(&plan, go_on, |summary| -> Result<_, DesignFault> {
            // The page of an axle shows no mechanism.
            let wheel = own.vehicle.one_wheel();
            let drawn = wheel.map(|wheel| DrawnDesigns::of(own, wheel, &plan, summary));
            drawn.transpose()
        });
        let run = run.map_err(NotBegun::Fault)?;
        Ok(run.map_or_else(String::new, |run| page_of(&run)))
    })?;
    made.map_err(|e| not_begun(study, e))
}

/// Writes a sweep into a directory as `hardpoint sweep` does. The designs come from `[sweep]` or from the rows of `x`.
/// `part` selects one part: its number from 0, and the number of parts. Returns true if every requested part is computed. Without
/// `part`, every design must also be solved, and every output must have a value.
#[pyfunction]
#[pyo3(signature = (study, directory, x=None, variables=None, part=None, threads=None))]
pub(crate) fn sweep_into(
    py: Python<'_>,
    study: &Study,
    directory: PathBuf,
    x: Option<PyReadonlyArray2<'_, f64>>,
    variables: Option<Vec<String>>,
    part: Option<(u64, u64)>,
    threads: Option<usize>,
) -> PyResult<bool> {
    let given = x.map(|x| given(study, &x, variables)).transpose()?;
    let mut own = study.whole().clone();
    if let Some(given) = given {
        own.sweep = Some(given);
    }
    // `-` would mean standard output.
    let out = directory.to_str().filter(|out| *out != "-");
    let out = out.ok_or_else(|| {
        let name = directory.display();
        failure(format!(
            "{name}: expected a directory other than -, whose name is UTF-8 text"
        ))
    })?;
    let mut arguments = vec![
        "sweep".to_owned(),
        // Suppresses printing, because a Python function does not print.
        "--quiet".to_owned(),
        format!("--out={out}"),
    ];
    if let Some((part, parts)) = part {
        arguments.push(format!("--shard={}/{parts}", part + 1));
    }
    arguments.extend(threads.map(|threads| format!("--threads={threads}")));
    // The name of a study may begin with a hyphen.
    arguments.extend(["--".to_owned(), study.file_name()]);
    let done = command(py, || hardpoint::cli::sweep_study(&own, &arguments))?;
    done.map_err(|reason| match reason {
        NotDone::Incomplete(text) => PyOSError::new_err(text),
        other => not_done(other),
    })
}

/// Collects the rows of a sweep: columns, number of variables, status and reasons.
pub(crate) fn collect<'py>(
    py: Python<'py>,
    swept: Swept<'_>,
    text: Option<&SweepText>,
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
    let header = text.and_then(SweepText::curves_header);
    let mut curves = header.map(<[u8]>::to_vec);
    let work = |flag: &AtomicBool| {
        let solved = |worker: &mut _, block| solve_block(worker, block, text);
        // The consumer of the rows never returns an error.
        let _: Result<(), ()> = in_order(
            0..record.blocks(),
            || swept.worker(),
            |worker, block| (!flag.load(Ordering::Relaxed)).then(|| solved(worker, block)),
            |(rows, of_curves): (Rows, Vec<u8>)| {
                table.append(&rows, record.variables.len());
                if let Some(curves) = &mut curves {
                    curves.extend(of_curves);
                }
                done.fetch_add(rows.designs() as u64, Ordering::Relaxed);
                Ok(())
            },
        );
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
    let curves = curves.map(|curves| PyBytes::new(py, &curves));
    result.set_item("curves", curves)?;
    Ok(result)
}

/// Rows of a block of designs, and the curves of these designs if they are requested.
fn solve_block(
    worker: &mut SweptWorker<'_>,
    block: u64,
    text: Option<&SweepText>,
) -> (Rows, Vec<u8>) {
    let rows = worker.rows(block).clone();
    let curves = text.map_or_else(Vec::new, |text| text.curves(worker, rows.first));
    (rows, curves)
}

/// Number of parts of a study's sweep. A part has 131,072 designs, or 1,024 in some sweeps of elastic parts. The last part has
/// fewer.
#[pyfunction]
pub(crate) fn sweep_parts(py: Python<'_>, study: &Study) -> PyResult<u64> {
    let sweep = own_sweep(study)?;
    let plan = on_threads(py, Some(1), |_| SweepPlan::of(&study.study, sweep))?;
    Ok(plan.map_err(|e| not_begun(study, e))?.record.parts())
}
