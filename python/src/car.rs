//! Cars: load cases, sweeps, tunings and derivatives.

use crate::curves::{Columns, mostly_nan};
use crate::errors::{failure, study_error};
use crate::study::Study;
use crate::sweep::collect;
use crate::threads::{interruptible, on_threads};
use hardpoint::car::{CarFault, CarRequest, CarSolver, CarVariable};
use hardpoint::optimise::Control;
use hardpoint::report::{
    CarComparison, CarResults, CarState, CarToleranceSummary, CarVerdict, car_limits as limits_of,
    lift_limits_table, optimised_car,
};
use hardpoint::scatter;
use hardpoint::side_effects::side_effects_of_car;
use hardpoint::study::{CarStudy, TunedCar};
use hardpoint::sweep::{CarNotBegun, CarSweepPlan, Swept};
use hardpoint::tolerance::CarProblem;
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Study of a car. It is immutable. Pickling stores its text and the texts of both axles.
#[pyclass(frozen, module = "hardpoint._hardpoint")]
pub(crate) struct Car {
    study: CarStudy,
}

impl Car {
    fn fault(&self, fault: &CarFault) -> PyErr {
        failure(self.study.car.describe_fault(fault))
    }

    /// Variables of `[optimise]`, or of `[sweep]` if there is no `[optimise]`.
    fn own_variables(&self) -> &[CarVariable] {
        match (&self.study.optimise, &self.study.sweep) {
            (Some(optimise), _) => &optimise.variables,
            (None, Some(sweep)) => &sweep.variables,
            (None, None) => &[],
        }
    }

    fn columns(&self) -> Vec<String> {
        let length = self.study.car.length_unit;
        let quantities = self.study.quantities.iter();
        quantities.map(|quantity| quantity.column(length)).collect()
    }
}

#[pymethods]
impl Car {
    /// Reads the study of a car from a file, which names the files of both axles.
    #[staticmethod]
    #[pyo3(signature = (path, overrides=Vec::new()))]
    fn load(py: Python<'_>, path: PathBuf, overrides: Vec<String>) -> PyResult<Self> {
        let study = py.detach(|| CarStudy::read(&path, &overrides));
        let study = study.map_err(|errors| study_error(&errors))?;
        Ok(Car { study })
    }

    /// Makes a car from its text and the studies of both axles. File names in the text are ignored.
    #[staticmethod]
    fn of(py: Python<'_>, name: &str, text: &str, front: &Study, rear: &Study) -> PyResult<Self> {
        let axles = [front, rear].map(|axle| axle.whole().clone());
        let study = py.detach(|| CarStudy::of_axles(name, text, axles));
        let study = study.map_err(|errors| study_error(&errors))?;
        Ok(Car { study })
    }

    /// Text of the study after all overrides.
    #[getter]
    fn text(&self) -> &str {
        &self.study.text
    }

    /// Studies of the front and the rear axle.
    #[getter]
    fn axles(&self) -> PyResult<(Study, Study)> {
        let [front, rear] = self.study.axles.clone();
        Ok((Study::of(Ok(front))?, Study::of(Ok(rear))?))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.study.name
    }

    #[getter]
    fn length_unit(&self) -> &str {
        self.study.car.length_unit.symbol()
    }

    /// Names of the load cases, `static` first.
    #[getter]
    fn cases(&self) -> Vec<String> {
        let cases = self.study.cases.iter();
        cases.map(|case| case.name.clone()).collect()
    }

    /// Columns of the results that the study requests.
    #[getter]
    fn results(&self) -> Vec<String> {
        self.columns()
    }

    /// Columns of the variables of `[optimise]`, or of `[sweep]` if there is no `[optimise]`.
    #[getter]
    fn variables(&self) -> Vec<String> {
        let variables = self.own_variables().iter();
        let named = variables.map(|variable| {
            let (stem, unit) = (
                variable.moves.stem(&self.study.car),
                variable.moves.unit(&self.study.car),
            );
            if unit.is_empty() {
                stem
            } else {
                format!("{stem}_{unit}")
            }
        });
        named.collect()
    }

    fn __repr__(&self) -> String {
        let cases = self.study.cases.len();
        format!("<hardpoint.Car {:?}: {cases} cases>", self.study.name)
    }

    fn __reduce__(&self, py: Python<'_>) -> PyResult<(Py<PyAny>, (String, String, Study, Study))> {
        let of = py.get_type::<Car>().getattr("of")?.unbind();
        let (front, rear) = self.axles()?;
        let (name, text) = (self.study.name.clone(), self.study.text.clone());
        Ok((of, (name, text, front, rear)))
    }
}

/// Results of the load cases: one column per result, one row per case. Accelerations are in g.
#[pyfunction]
pub(crate) fn car_solve<'py>(py: Python<'py>, car: &Car) -> PyResult<Bound<'py, PyDict>> {
    let study = &car.study;
    let solved = on_threads(py, Some(1), |_| {
        let mut solver = CarSolver::new(&study.car)?;
        Ok(CarResults::solve(study, &mut solver, study.cases.len()))
    })?;
    let solved = solved.map_err(|fault| car.fault(&fault))?;
    let columns = Columns::new(py);
    let accelerations: [(&str, fn(&hardpoint::car::Case) -> f64); 3] = [
        ("ax", |case| case.ax),
        ("ay", |case| case.ay),
        ("az", |case| case.az),
    ];
    for (name, of) in accelerations {
        let values = study.cases.iter().map(|case| Some(of(case)));
        columns.push(&format!("{name}_g"), (name, "g", None), values)?;
    }
    for quantity in &study.quantities {
        let info = quantity.info();
        let (name, unit) = (quantity.name(), info.unit.suffix(study.car.length_unit));
        let values = study.cases.iter().zip(&solved.states);
        let values = values.map(|(case, state)| match state {
            CarState::Solved { solved, .. } => quantity.printed(solved, case),
            CarState::Failed(_) => None,
        });
        let column = quantity.column(study.car.length_unit);
        columns.push(&column, (&name, &unit, Some(info.positive)), values)?;
    }
    columns.finish(solved.states.iter().map(|state| match state {
        CarState::Solved { .. } => ("ok", None),
        CarState::Failed(why) => (why.status(), Some(why.describe(&study.car))),
    }))
}

/// Derivatives of the results of all cases with respect to the variables, as an array (cases, results, variables), in the units of
/// the columns. NaN if a result is not defined.
#[pyfunction]
pub(crate) fn car_derivatives<'py>(py: Python<'py>, car: &Car) -> PyResult<Bound<'py, PyAny>> {
    let study = &car.study;
    let variables = car.own_variables();
    let request = CarRequest::of(&study.cases, &study.quantities, []);
    let gradients = on_threads(py, Some(1), |_| request.gradients(&study.car))?;
    let gradients = gradients.map_err(|fault| car.fault(&fault))?;
    let shape = [study.cases.len(), study.quantities.len(), variables.len()];
    let mut known = Vec::new();
    for (result, gradient) in request.results.iter().zip(&gradients) {
        let Some(gradient) = gradient else { continue };
        let unit = result.quantity.info().unit;
        let factor = unit.printed_factor(study.car.length_unit);
        for (column, quantity) in study.quantities.iter().enumerate() {
            if *quantity == result.quantity {
                for (k, variable) in variables.iter().enumerate() {
                    let slope = factor * variable.moves.slope(&study.car, gradient);
                    known.push(([result.case, column, k], slope));
                }
            }
        }
    }
    Ok(mostly_nan(py, shape, known.into_iter()).into_any())
}

/// Rows of the car's sweep. `progress(done, all)` is called on this thread.
#[pyfunction]
#[pyo3(signature = (car, threads=None, progress=None))]
pub(crate) fn car_sweep<'py>(
    py: Python<'py>,
    car: &Car,
    threads: Option<usize>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let study = &car.study;
    let sweep = study.sweep.as_ref();
    let sweep =
        sweep.ok_or_else(|| failure("the study has no [sweep], which gives the designs"))?;
    let plan = on_threads(py, Some(1), |_| CarSweepPlan::of(study, sweep))?;
    let plan = plan.map_err(|reason| match reason {
        CarNotBegun::Fault(fault) => car.fault(&fault),
        CarNotBegun::Columns(fault) => failure(fault.to_string()),
    })?;
    collect(py, Swept::Car(&plan), None, threads, progress)
}

/// Tunes a car towards its targets. `success` is true if the tuning ended at a minimum and violates no constraint. It is false if a
/// missed target depends on no variable.
#[pyfunction]
#[pyo3(signature = (car, threads=None))]
pub(crate) fn car_optimise<'py>(
    py: Python<'py>,
    car: &Car,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let study = &car.study;
    let wanted = study.optimise.as_ref().ok_or_else(|| {
        failure("the study has no [optimise], which gives variables, their ranges and targets")
    })?;
    let work = |flag: &AtomicBool| {
        let control = Control {
            interrupt: Some(flag),
            ..Control::default()
        };
        let TunedCar {
            fit,
            study: tuned,
            tuning,
        } = study.tuned(wanted, control)?;
        let records = [study, &tuned].map(|of| {
            let solver = CarSolver::new(&of.car).map_err(|fault| of.car.describe_fault(&fault));
            Ok::<_, String>(CarResults::solve(of, &mut solver?, of.cases.len()))
        });
        let effects = side_effects_of_car(study, &tuned)?;
        let effects = serde_json::to_string(&effects).map_err(|e| e.to_string())?;
        let [before, after] = records;
        let (before, after) = (before?, after?);
        let x = fit.x.as_slice();
        let constraints = after.constraint_records(wanted, &before, x, &tuning.prices);
        let targets = after.target_records(wanted, &before, x);
        let verdict = CarVerdict {
            study,
            targets: &targets,
            constraints: &constraints,
            tuning: &tuning,
        };
        let mut message = vec![fit.ended().to_string()];
        message.extend(verdict.remarks());
        let targets = serde_json::to_string(&targets).map_err(|e| e.to_string())?;
        let texts = optimised_car(study, &tuned.car, fit.x.as_slice());
        let is_kept = fit.termination.at_minimum() && !tuning.falls_short();
        Ok::<_, String>((fit, is_kept, message, targets, effects, texts))
    };
    let (tuned, is_kept, message, targets, effects, texts) =
        interruptible(py, threads, work, |_, _| Ok(()))?.map_err(failure)?;
    let x = tuned.x.as_slice();
    let result = PyDict::new(py);
    result.set_item("x", x.to_vec().into_pyarray(py))?;
    result.set_item("success", is_kept)?;
    result.set_item("message", message.join("; "))?;
    result.set_item("misfit", tuned.misfit())?;
    result.set_item("targets", targets)?;
    result.set_item("side_effects", effects)?;
    result.set_item("studies", texts.to_vec())?;
    Ok(result)
}

/// Warnings about the car at rest. The second list has one line if the car has no equilibrium at rest; otherwise it is empty.
#[pyfunction]
pub(crate) fn car_check(py: Python<'_>, car: &Car) -> PyResult<(Vec<String>, Vec<String>)> {
    let study = &car.study;
    let checked = on_threads(py, Some(1), |_| {
        let mut solver = CarSolver::new(&study.car)?;
        let results = CarResults::solve(study, &mut solver, 1);
        Ok((results.warnings(), results.failures()))
    })?;
    checked.map_err(|fault| car.fault(&fault))
}

/// Accelerations at which a wheel lifts, and at which the car loses its equilibrium. The result is CSV with a row for each
/// direction and load case.
#[pyfunction]
pub(crate) fn car_limits<'py>(py: Python<'py>, car: &Car) -> PyResult<Bound<'py, PyBytes>> {
    let study = &car.study;
    let found = on_threads(py, Some(1), |_| {
        let mut solver = CarSolver::new(&study.car)?;
        Ok(lift_limits_table(
            &limits_of(study, &mut solver),
            &study.car,
        ))
    })?;
    let table = found.map_err(|fault| car.fault(&fault))?;
    Ok(PyBytes::new(py, table.csv(None).as_bytes()))
}

/// Results of several cars side by side, as files by name.
#[pyfunction]
pub(crate) fn car_compare<'py>(
    py: Python<'py>,
    cars: Vec<(String, Py<Car>)>,
) -> PyResult<Bound<'py, PyDict>> {
    let made = on_threads(py, Some(1), |_| -> Result<_, String> {
        let mut all = Vec::new();
        for (label, car) in &cars {
            let study = &car.get().study;
            let described = |fault| format!("{label}: {}", study.car.describe_fault(&fault));
            let mut solver = CarSolver::new(&study.car).map_err(described)?;
            let results = CarResults::solve(study, &mut solver, study.cases.len());
            all.push((label.clone(), results));
        }
        let comparison = CarComparison::of(&all)?;
        let changes = comparison.changes_table().csv(None).into_bytes();
        Ok([
            ("comparison.csv", comparison.csv()),
            ("changes.csv", changes),
        ])
    })?;
    let result = PyDict::new(py);
    for (name, bytes) in made.map_err(failure)? {
        result.set_item(name, PyBytes::new(py, &bytes))?;
    }
    Ok(result)
}

/// Effect of the scatter of a car's parts, as files by name. `progress(done, all)` is called on this thread.
#[pyfunction]
#[pyo3(signature = (car, threads=None, progress=None))]
pub(crate) fn car_tolerance<'py>(
    py: Python<'py>,
    car: &Car,
    threads: Option<usize>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let study = &car.study;
    let tolerance = study.tolerance.as_ref().ok_or_else(|| {
        failure("the study has no [tolerance] section, which gives the scatter of parts")
    })?;
    let done = AtomicU64::new(0);
    let refused = |(axle, why): (usize, _)| {
        let reason = scatter::refusal(&study.axles[axle], why);
        format!("{} axle: {reason}", hardpoint::car::AXLE_NAMES[axle])
    };
    let work = |flag: &AtomicBool| -> Result<_, String> {
        let problem = CarProblem::of(study, tolerance).map_err(refused)?;
        let nominal = problem.nominal();
        let nominal = nominal.map_err(|fault| study.car.describe_fault(&fault))?;
        let expansion = problem.expansion().map_err(refused)?;
        let builds = problem.monte_carlo(&nominal, |count| {
            done.store(count, Ordering::Relaxed);
            if flag.load(Ordering::Relaxed) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        let summary = CarToleranceSummary::of(&problem, &nominal, &expansion, &builds);
        let json = serde_json::to_vec_pretty(&summary).expect("JSON can store summaries");
        Ok([
            ("tolerance.csv", summary.csv()),
            ("contributors.csv", summary.contributors_csv()),
            ("summary.json", json),
        ])
    };
    let listen = |_: Python<'_>, _: &AtomicBool| match &progress {
        None => Ok(()),
        Some(progress) => {
            let done = done.load(Ordering::Relaxed);
            progress.call1((done, tolerance.builds)).map(drop)
        }
    };
    let files = interruptible(py, threads, work, listen)?.map_err(failure)?;
    let result = PyDict::new(py);
    for (name, bytes) in files {
        result.set_item(name, PyBytes::new(py, &bytes))?;
    }
    Ok(result)
}
