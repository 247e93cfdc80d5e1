//! Tuning of studies.

use crate::answers::as_json;
use crate::errors::failure;
use crate::function::named;
use crate::study::Study;
use crate::threads::{interruptible, on_threads};
use hardpoint::in_motions::InMotion;
use hardpoint::mechanism::DesignFault;
use hardpoint::model::Suspension;
use hardpoint::optimise::{
    Control, Infeasible, Iteration, Linearisation, TargetLayout, Tuning, assessed_at, evaluated,
    front, price_list, tune,
};
use hardpoint::report::{
    FrontRecord, PriceRecord, Record, TuningSummary, curves_csv, front_csv, history_csv,
    side_effects_table,
};
use hardpoint::side_effects::side_effects;
use hardpoint::solved::Solved;
use hardpoint::study::{Optimise, Variable};
use hardpoint::yields::not_increased;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::PyStopIteration;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;

/// Returns a study with its `[optimise]` section, or an error without it.
fn tuned(study: &Study) -> PyResult<(&hardpoint::study::Study, &Optimise)> {
    let own = study.whole();
    let optimise = own.optimise.as_ref().ok_or_else(|| {
        failure(
            "the study has no [optimise] section, which gives variables, their ranges and targets",
        )
    })?;
    Ok((own, optimise))
}

/// A tuning with the results derived from it.
struct Tuned {
    tuning: Tuning,
    summary: TuningSummary,
    front: Option<Vec<u8>>,
    /// Pareto front in JSON, as the record of a run contains it.
    front_record: Option<String>,
    /// True if every curve of the tuned design was found, and also the Pareto front if it was requested.
    is_complete: bool,
    is_interrupted: bool,
}

/// Tunes a study. An error describes in words why the design itself cannot be solved.
fn tune_study(
    own: &hardpoint::study::Study,
    optimise: &Optimise,
    wants: [bool; 2],
    control: Control<'_>,
) -> Result<Tuned, String> {
    let [with_front, with_prices] = wants;
    let words = |fault: DesignFault| fault.describe(&own.wheel().mechanism);
    let tuning = tune(&own.vehicle, optimise, control).map_err(words)?;
    let is_raised = || control.interrupt.is_some_and(|f| f.load(Ordering::Relaxed));
    let moved = tuning.best.as_ref().map(|best| own.moved(&best.offsets));
    let after = moved.as_ref().map(Solved::with_targets).transpose()?;
    let goes_on = tuning.best.is_some() && !is_raised();
    let front = if goes_on && with_front && !optimise.front.is_empty() {
        Some(front(&own.vehicle, optimise, &tuning, control).map_err(words)?)
    } else {
        None
    };
    let prices = if goes_on && with_prices && !optimise.fit {
        price_list(&own.vehicle, optimise, &tuning, control).map_err(words)?
    } else {
        Vec::new()
    };
    let curves = after.as_ref().map(Solved::curves);
    let mut summary = TuningSummary::of(own, optimise, &tuning, curves);
    let kept = tuning.best.as_ref().map(|best| &best.offsets[..]);
    summary.prices = PriceRecord::all(optimise, &prices, kept);
    if let Some(moved) = &moved {
        summary.side_effects = side_effects(own, moved).map_err(words)?;
    }
    let has_front = front.as_ref().is_none_or(|front| !front.choices.is_empty());
    Ok(Tuned {
        is_complete: after.as_ref().is_some_and(Solved::is_complete) && has_front,
        front_record: front.as_ref().map(|front| {
            let record = FrontRecord::of(own, optimise, front, Solved::table);
            serde_json::to_string(&record).expect("JSON can store records")
        }),
        front: front.map(|front| front_csv(own, optimise, &front)),
        summary,
        tuning,
        is_interrupted: is_raised(),
    })
}

/// Calls the callback with a start, an iteration and a misfit. Returns true if it ends the tuning.
fn stops(callback: &Bound<'_, PyAny>, progress: (usize, u64, f64)) -> PyResult<bool> {
    match callback.call1(progress) {
        Ok(answer) => answer.is_truthy(),
        Err(error) if error.is_instance_of::<PyStopIteration>(callback.py()) => Ok(true),
        Err(error) => Err(error),
    }
}

/// Expected yields of a tuning for yield. `None` for other tunings. Raises an exception if the yield could not be
/// increased.
fn expected_yield<'py>(py: Python<'py>, tuning: &Tuning) -> PyResult<Option<Bound<'py, PyDict>>> {
    Ok(match &tuning.expected_yield {
        None => None,
        Some(Ok(expected)) => {
            let known = PyDict::new(py);
            let [without_scatter, tuned] = expected.judged;
            known.set_item("without_scatter", without_scatter)?;
            known.set_item("tuned", tuned)?;
            known.set_item("builds", expected.judged_builds)?;
            known.set_item("surrogate", expected.surrogate)?;
            Some(known)
        }
        Some(Err(reason)) => return Err(failure(not_increased(reason))),
    })
}

/// Adds the tables of a tuning as CSV: side effects, history and Pareto front.
fn add_tables(result: &Bound<'_, PyDict>, found: &Tuned) -> PyResult<()> {
    let py = result.py();
    let effects = &found.summary.side_effects;
    let effects = (!effects.is_empty()).then(|| side_effects_table(effects).csv(None));
    result.set_item(
        "side_effects",
        effects.map(|csv| PyBytes::new(py, csv.as_bytes())),
    )?;
    let history = history_csv(&found.tuning.starts);
    result.set_item("history", PyBytes::new(py, &history))?;
    result.set_item(
        "front",
        found.front.as_deref().map(|csv| PyBytes::new(py, csv)),
    )
}

/// Tunes a study towards its targets. `callback(start, iteration, misfit)` is called on this thread. If it returns true or raises
/// `StopIteration`, the tuning ends with its present result.
#[pyfunction]
#[pyo3(signature = (study, with_front=true, with_prices=false, threads=None, callback=None))]
pub(crate) fn optimise<'py>(
    py: Python<'py>,
    study: &Study,
    with_front: bool,
    with_prices: bool,
    threads: Option<usize>,
    callback: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (own, optimise) = tuned(study)?;
    let (sender, iterations) = channel();
    let watch = move |start: usize, iteration: &Iteration| {
        let _ = sender.send((start, iteration.iteration, iteration.misfit));
    };
    let has_callback = callback.is_some();
    let listen = |_: Python<'_>, flag: &AtomicBool| -> PyResult<()> {
        let Some(callback) = &callback else {
            return Ok(());
        };
        for progress in iterations.try_iter() {
            if stops(callback, progress)? {
                flag.store(true, Ordering::Relaxed);
            }
        }
        Ok(())
    };
    let work = |flag: &AtomicBool| {
        let control = Control {
            interrupt: Some(flag),
            watch: if has_callback { Some(&watch) } else { None },
        };
        tune_study(own, optimise, [with_front, with_prices], control)
    };
    let found = interruptible(py, threads, work, listen)?.map_err(failure)?;
    let Tuned {
        tuning, summary, ..
    } = &found;
    let result = PyDict::new(py);
    let names: Vec<String> = optimise.variables.iter().map(Variable::label).collect();
    result.set_item("variables", names)?;
    let mut message = vec![summary.headline()];
    message.extend(tuning.starts.best_fit().map(|fit| fit.ended()));
    message.extend(summary.remarks());
    let mut is_whole = found.is_complete && !summary.falls_short() && !found.is_interrupted;
    is_whole &= (tuning.starts.best_fit()).is_some_and(|fit| fit.is_feasible());
    match &tuning.best {
        None => {
            result.set_item("x", py.None())?;
            result.set_item("study", py.None())?;
        }
        Some(best) => {
            result.set_item("x", best.offsets.clone().into_pyarray(py))?;
            let text = own.with_points_of(&own.moved(&best.offsets));
            let file = study.file_name();
            let read = own.read_again(&file, &text);
            match read {
                Ok(read) => result.set_item("study", Bound::new(py, Study::of(Ok(read))?)?)?,
                Err(errors) => {
                    is_whole = false;
                    message.push(format!(
                        "the tuned study is invalid: {}",
                        errors.render(false)
                    ));
                    result.set_item("study", py.None())?;
                }
            }
        }
    }
    if found.is_interrupted {
        message.push(summary.interrupted_in_words());
    }
    result.set_item("success", is_whole)?;
    result.set_item("message", message.join("; "))?;
    let json = serde_json::to_string(summary).map_err(|e| failure(e.to_string()))?;
    result.set_item("summary", json)?;
    result.set_item("expected_yield", expected_yield(py, tuning)?)?;
    result.set_item("front_record", &found.front_record)?;
    add_tables(&result, &found)?;
    Ok(result)
}

/// Files of a tuning: the curves before and after, and the record. `front` is the record of the Pareto front.
#[pyfunction]
#[pyo3(signature = (study, tuned=None, front=None))]
pub(crate) fn tuning_files<'py>(
    py: Python<'py>,
    study: &Study,
    tuned: Option<&Study>,
    front: Option<&str>,
) -> PyResult<Bound<'py, PyDict>> {
    let (own, tuned) = (study.whole(), tuned.map(Study::whole));
    let files = on_threads(py, Some(1), |_| -> Result<_, String> {
        let before = Solved::with_targets(own)?;
        let after = tuned.map(Solved::with_targets).transpose()?;
        let mut designs = vec![("before", "curves_before.csv", &before)];
        designs.extend(after.as_ref().map(|after| ("after", "curves.csv", after)));
        let record = Solved::record("optimise", &designs)?;
        let studies = [("before", Some(own)), ("after", tuned)];
        let studies = studies
            .into_iter()
            .filter_map(|(label, own)| Some((label, own?)));
        let in_motions = InMotion::all(&studies.collect::<Vec<_>>(), true)?;
        let front = front.map(serde_json::from_str::<FrontRecord>).transpose();
        let front = front.map_err(|e| e.to_string())?;
        let own = designs.iter();
        let own = own.map(|(_, file, solved)| ((*file).to_owned(), solved.csv()));
        let mut files: Vec<(String, Vec<u8>)> = own.collect();
        let named = in_motions.iter().flat_map(InMotion::files);
        files.extend(named.map(|(file, curves)| (file.to_owned(), curves_csv(curves))));
        let sensitivities = after.as_ref().and_then(Solved::sensitivities_csv);
        files.extend(sensitivities.map(|csv| ("sensitivities.csv".to_owned(), csv)));
        let motions = in_motions.into_iter().map(|own| own.record).collect();
        let record = Record {
            front,
            motions,
            ..record
        };
        files.push(("report.json".to_owned(), as_json(&record)));
        Ok(files)
    })?;
    let result = PyDict::new(py);
    for (name, bytes) in files.map_err(failure)? {
        result.set_item(name, PyBytes::new(py, &bytes))?;
    }
    Ok(result)
}

/// Targets and constraints of a study as functions of the variables.
#[pyclass(frozen, module = "hardpoint._hardpoint")]
pub(crate) struct Residuals {
    study: Py<Study>,
    layout: TargetLayout,
    names: Vec<String>,
    /// Variables as offsets from the design.
    variables: Vec<Variable>,
    /// Value of each variable at the design: 0 for an offset.
    at_design: Vec<f64>,
}

#[pymethods]
impl Residuals {
    /// Makes the functions for the variables with these names. Without names, uses the variables of `[optimise]`.
    #[new]
    #[pyo3(signature = (study, variables=None))]
    fn new(py: Python<'_>, study: Py<Study>, variables: Option<Vec<String>>) -> PyResult<Self> {
        let (own, optimise) = tuned(study.get())?;
        let (mut names, mut moved, mut at_design) = (Vec::new(), Vec::new(), Vec::new());
        match variables {
            None => {
                names.extend(optimise.variables.iter().map(Variable::label));
                moved.clone_from(&optimise.variables);
                at_design.resize(moved.len(), 0.0);
            }
            Some(asked) => {
                for variable in named(own, Some(asked))? {
                    let (offset, at) = variable.as_offset(own.wheel()).ok_or_else(|| {
                        let name = &variable.name;
                        failure(format!(
                            "{name} is a coordinate of several points, and constraints do not support \
                             it; give offsets instead"
                        ))
                    })?;
                    names.push(variable.name);
                    moved.push(offset);
                    at_design.push(at);
                }
            }
        }
        let layout = py.detach(|| TargetLayout::nominal(optimise, &own.vehicle));
        Ok(Residuals {
            study,
            layout,
            names,
            variables: moved,
            at_design,
        })
    }

    #[getter]
    fn variables(&self) -> Vec<String> {
        self.names.clone()
    }

    /// Lowest and highest value of each variable, as an array (variables, 2).
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let flat: Vec<f64> = self.variables.iter().flat_map(|v| v.range).collect();
        let count = flat.len() / 2;
        flat.into_pyarray(py).reshape([count, 2])
    }

    /// Column name of the target of each residual.
    #[getter]
    fn rows(&self) -> PyResult<Vec<String>> {
        let (_, optimise) = tuned(self.study.get())?;
        let name = |target: usize| optimise.targets[target].of.column.clone();
        let rows = self.layout.targets_of_rows();
        Ok(rows.into_iter().map(name).collect())
    }

    /// Name of the constraint and its limit for each row of `constraints`. Also returns the number of rows that are equalities;
    /// they come first.
    #[getter]
    fn constraint_rows(&self) -> PyResult<(Vec<String>, usize)> {
        let (_, optimise) = tuned(self.study.get())?;
        let equalities = self.layout.equalities();
        let rows = self.layout.labels().iter().enumerate().map(|(row, label)| {
            let name = &optimise.constraints[label.constraint].name;
            match (row < equalities, label.is_upper) {
                (true, _) => name.clone(),
                (false, true) => format!("{name}: upper limit"),
                (false, false) => format!("{name}: lower limit"),
            }
        });
        Ok((rows.collect(), equalities))
    }

    /// Returns the study with the variables of `[optimise]` at the offsets `x`, even if these functions have other variables.
    fn moved(&self, py: Python<'_>, x: Vec<f64>) -> PyResult<Study> {
        let (own, _) = tuned(self.study.get())?;
        Study::moved(self.study.bind(py), own.moved(&x))
    }

    /// Residuals and their derivatives at `x`, or the reason in words why the design at `x` has no residuals.
    fn value_and_jacobian<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Evaluated<'py>> {
        in_arrays(py, self.at(py, &x, evaluated)?)
    }

    /// Values of the constraints with their derivatives at `x`, one row for each limit. A limit is satisfied if its value is at
    /// most 0; an equality, if its value is 0. A violation that matters in practice, such as one millimetre, has the value 1. If
    /// the design at `x` has no values, returns the reason in words.
    fn constraints<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Evaluated<'py>> {
        let found = self.at(py, &x, assessed_at)?;
        in_arrays(py, found.map(|found| found.rows))
    }
}

impl Residuals {
    /// Evaluates the targets, or targets and constraints, at `x`. An error explains why the design of the study cannot be solved.
    fn at<T: Send>(
        &self,
        py: Python<'_>,
        x: &PyReadonlyArray1<'_, f64>,
        evaluate: fn(&Suspension, &[Variable], &TargetLayout, &[f64]) -> Result<T, DesignFault>,
    ) -> PyResult<T> {
        let (own, _) = tuned(self.study.get())?;
        let x = x.as_slice().map_err(|_| failure("x is not contiguous"))?;
        let x: Vec<f64> = x
            .iter()
            .zip(&self.at_design)
            .map(|(x, at)| x - at)
            .collect();
        let wheel = own.wheel();
        // The evaluation runs on this thread, because waking another thread takes as long as the evaluation.
        let found = py.detach(|| evaluate(wheel, &self.variables, &self.layout, &x));
        py.check_signals()?;
        found.map_err(|fault| failure(fault.describe(&wheel.mechanism)))
    }
}

/// Values and derivatives as arrays, or the reason why they do not exist.
fn in_arrays(py: Python<'_>, found: Result<Linearisation, Infeasible>) -> PyResult<Evaluated<'_>> {
    let found = match found {
        Ok(found) => found,
        Err(infeasible) => return Ok(Evaluated::Not(infeasible.to_string())),
    };
    let (rows, columns) = found.jacobian.shape();
    // nalgebra stores a matrix column by column, so the rows are collected here.
    let jacobian: Vec<f64> = (0..rows)
        .flat_map(|r| (0..columns).map(move |c| (r, c)))
        .map(|at| found.jacobian[at])
        .collect();
    let values: Vec<f64> = found.residuals.iter().copied().collect();
    let jacobian = jacobian.into_pyarray(py).reshape([rows, columns])?;
    Ok(Evaluated::Found((values.into_pyarray(py), jacobian)))
}

/// Residuals with their Jacobian, or the reason why they do not exist.
#[derive(IntoPyObject)]
enum Evaluated<'py> {
    Found((Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>)),
    Not(String),
}
