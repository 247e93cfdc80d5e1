//! Curves as a pure function of the design variables.

use crate::errors::{failure, too_large};
use crate::status::of_designs;
use crate::study::Study;
use crate::threads::{LISTEN, checked, on_threads};
use hardpoint::{DesignFunction, DesignStatus, DesignVariable, Evaluation, FunctionError, Move};
use numpy::{
    Element, IntoPyArray, PyArray, PyArray1, PyArray2, PyArray3, PyArray4, PyArrayMethods,
    PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use rayon::prelude::*;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Number of designs per chunk for values. One CPU thread evaluates one chunk at a time.
const CHUNK: usize = 128;
/// Number of designs per chunk for Jacobians. A Jacobian takes longer than values.
const DIFFERENTIATED: usize = 32;
/// Number of designs per chunk for an axle, whose designs are solved one by one.
const OF_AXLE: usize = 1;

/// Pure function from design variables to curves.
#[pyclass(frozen, module = "hardpoint._hardpoint")]
pub(crate) struct Function {
    function: Arc<DesignFunction>,
    /// Workspaces of earlier calls, kept for later calls. Making a workspace takes longer than evaluating a design.
    idle: Mutex<Vec<Workspace>>,
    /// Study of the function. `moved` and pickling use it.
    study: Py<Study>,
    is_axle: bool,
}

self_cell::self_cell!(
    /// A workspace together with the function that it evaluates.
    struct Workspace {
        owner: Arc<DesignFunction>,
        #[not_covariant]
        dependent: Evaluation,
    }
);

/// A workspace that a call uses. After the call, other calls can use it again, unless the call panicked.
struct InUse<'f> {
    function: &'f Function,
    workspace: Option<Workspace>,
}

impl InUse<'_> {
    fn work_on(&mut self, work: impl FnOnce(&mut Evaluation<'_>)) {
        if let Some(workspace) = &mut self.workspace {
            workspace.with_dependent_mut(|_, evaluation| work(evaluation));
        }
    }
}

impl Drop for InUse<'_> {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            self.function.idle().extend(self.workspace.take());
        }
    }
}

/// Designs of one chunk, and the slices for their results.
struct Chunk<'a> {
    x: &'a [f64],
    values: &'a mut [f64],
    jacobian: &'a mut [f64],
    status: &'a mut [DesignStatus],
}

#[pymethods]
impl Function {
    #[new]
    #[pyo3(signature = (study, variables=None))]
    fn new(py: Python<'_>, study: Py<Study>, variables: Option<Vec<String>>) -> PyResult<Self> {
        let own = &study.get().study;
        let variables = named(own, variables)?;
        let made = on_threads(py, Some(1), |_| {
            DesignFunction::with_variables(own, variables)
        });
        let function = made?;
        Ok(Function {
            function: Arc::new(function.map_err(|e| failure(e.to_string()))?),
            idle: Mutex::default(),
            is_axle: own.axle().is_some(),
            study,
        })
    }

    #[getter]
    fn variables(&self) -> Vec<String> {
        let variables = self.function.variables().iter();
        variables.map(|v| v.name.clone()).collect()
    }

    /// Lowest and highest value of each variable, as an array (variables, 2).
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let variables = self.function.variables();
        let flat: Vec<f64> = variables.iter().flat_map(DesignVariable::range).collect();
        flat.into_pyarray(py).reshape([variables.len(), 2])
    }

    #[getter]
    fn outputs(&self) -> Vec<String> {
        self.function.outputs()
    }

    /// Number of stations at which the curves have values.
    #[getter]
    fn stations(&self) -> usize {
        self.function.stations()
    }

    /// Returns the study with its variables set to `x`. `x` must have one number for each variable.
    fn moved(&self, py: Python<'_>, x: Vec<f64>) -> PyResult<Study> {
        let study = self.study.bind(py);
        Study::moved(study, self.function.moved(&study.get().study, &x))
    }

    /// Values and status of designs. The input has the shape (n, variables); the values have the shape (n, outputs,
    /// stations).
    #[pyo3(signature = (x, threads=None))]
    fn values<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray2<'py, f64>,
        threads: Option<usize>,
    ) -> PyResult<(Bound<'py, PyArray3<f64>>, Bound<'py, PyArray1<u8>>)> {
        let f = &self.function;
        let n = x.shape()[0];
        let x = rows(&x, f.variables().len())?;
        let values: Bound<'_, PyArray3<f64>> =
            zeros(py, &[n, f.len() / f.stations(), f.stations()])?;
        let mut status = vec![DesignStatus::Ok; n];
        {
            let mut write = values.readwrite();
            let (k, row) = (f.variables().len(), f.len());
            let at_once = if self.is_axle { OF_AXLE } else { CHUNK };
            let chunks = (write.as_slice_mut()?.chunks_mut(at_once * row))
                .zip(status.chunks_mut(at_once))
                .enumerate()
                .map(|(number, (values, status))| Chunk {
                    x: &x[number * at_once * k..][..status.len() * k],
                    values,
                    jacobian: &mut [],
                    status,
                })
                .collect();
            self.carry_out(py, threads, chunks, |evaluation, chunk| {
                evaluation.values(chunk.x, chunk.values, chunk.status);
            })?;
        }
        Ok((values, of_designs(&status).into_pyarray(py)))
    }

    /// Values and exact Jacobians of designs. The input has the shape (n, variables), the values (n, outputs, stations),
    /// and the Jacobians (n, outputs, stations, variables).
    #[pyo3(signature = (x, threads=None))]
    fn value_and_jacobian<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray2<'py, f64>,
        threads: Option<usize>,
    ) -> PyResult<(
        Bound<'py, PyArray3<f64>>,
        Bound<'py, PyArray4<f64>>,
        Bound<'py, PyArray1<u8>>,
    )> {
        let f = &self.function;
        let n = x.shape()[0];
        let x = rows(&x, f.variables().len())?;
        let (stations, k) = (f.stations(), f.variables().len());
        let outputs = f.len() / stations;
        let values: Bound<'_, PyArray3<f64>> = zeros(py, &[n, outputs, stations])?;
        let jacobian: Bound<'_, PyArray4<f64>> = zeros(py, &[n, outputs, stations, k])?;
        let mut status = vec![DesignStatus::Ok; n];
        {
            let (mut write_y, mut write_j) = (values.readwrite(), jacobian.readwrite());
            let row = f.len();
            let at_once = if self.is_axle {
                OF_AXLE
            } else {
                DIFFERENTIATED
            };
            let chunks = (write_y.as_slice_mut()?.chunks_mut(at_once * row))
                .zip(
                    write_j
                        .as_slice_mut()?
                        .chunks_mut((at_once * row * k).max(1)),
                )
                .zip(status.chunks_mut(at_once))
                .enumerate()
                .map(|(number, ((values, jacobian), status))| Chunk {
                    x: &x[number * at_once * k..][..status.len() * k],
                    values,
                    jacobian,
                    status,
                })
                .collect();
            self.carry_out(py, threads, chunks, |evaluation, chunk| {
                evaluation.value_and_jacobian(chunk.x, chunk.values, chunk.jacobian, chunk.status);
            })?;
        }
        Ok((values, jacobian, of_designs(&status).into_pyarray(py)))
    }

    fn __repr__(&self) -> String {
        let (k, a, s) = (
            self.function.variables().len(),
            self.function.outputs().len(),
            self.function.stations(),
        );
        format!(
            "<hardpoint.Function {:?}: {k} variables -> {a} outputs x {s} stations>",
            self.study.get().study.name
        )
    }

    fn __reduce__(&self, py: Python<'_>) -> (Py<PyAny>, (Py<Study>, Vec<String>)) {
        let class = py.get_type::<Function>().into_any().unbind();
        (class, (self.study.clone_ref(py), self.variables()))
    }
}

impl Function {
    fn idle(&self) -> std::sync::MutexGuard<'_, Vec<Workspace>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns an unused workspace of an earlier call, or a new workspace.
    fn workspace(&self) -> InUse<'_> {
        let idle = self.idle().pop();
        let make = || Workspace::new(self.function.clone(), |function| function.evaluation());
        InUse {
            function: self,
            workspace: Some(idle.unwrap_or_else(make)),
        }
    }

    /// Evaluates chunks of designs. A single chunk, or `threads = 1`, runs on the calling thread; otherwise a pool of threads
    /// runs them.
    fn carry_out(
        &self,
        py: Python<'_>,
        threads: Option<usize>,
        mut chunks: Vec<Chunk<'_>>,
        work: impl Fn(&mut Evaluation<'_>, &mut Chunk<'_>) + Send + Sync,
    ) -> PyResult<()> {
        checked(threads)?;
        if threads != Some(1) && chunks.len() > 1 {
            return on_threads(py, threads, |flag| {
                let all = chunks.par_iter_mut();
                all.for_each_init(
                    || self.workspace(),
                    |workspace, chunk| {
                        if !flag.load(Ordering::Relaxed) {
                            workspace.work_on(|evaluation| work(evaluation, chunk));
                        }
                    },
                );
            });
        }
        let mut left = chunks.iter_mut();
        loop {
            let (left, work) = (&mut left, &work);
            let is_done = py.detach(move || {
                let (begun, mut workspace) = (Instant::now(), self.workspace());
                for chunk in left {
                    workspace.work_on(|evaluation| work(evaluation, chunk));
                    if begun.elapsed() > LISTEN {
                        return false;
                    }
                }
                true
            });
            if is_done {
                return Ok(());
            }
            py.check_signals()?;
        }
    }
}

/// Makes an array of zeros, or raises a `MemoryError`.
pub(crate) fn zeros<'py, T: Element, D: numpy::ndarray::Dimension>(
    py: Python<'py>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArray<T, D>>> {
    let made = py.import("numpy")?.call_method1("zeros", (shape.to_vec(),));
    let array = made.map_err(|_| too_large(shape))?;
    Ok(array.cast_into()?)
}

/// Returns the variables with these names. Without names, returns the variables that the study moves.
pub(crate) fn named(
    study: &hardpoint::Study,
    names: Option<Vec<String>>,
) -> PyResult<Vec<DesignVariable>> {
    let Some(names) = names else {
        return Ok(DesignVariable::of(study));
    };
    let variables = names.iter().map(|n| DesignVariable::named(n, study));
    let variables: Result<Vec<_>, FunctionError> = variables.collect();
    let variables = variables.map_err(|e| failure(e.to_string()))?;
    let later = |place: usize| {
        variables[place + 1..]
            .iter()
            .map(move |later| (place, later))
    };
    let mut pairs = (0..variables.len()).flat_map(later);
    match pairs.find(|(first, later)| contradict(study, &variables[*first], later)) {
        None => Ok(variables),
        Some((first, later)) => Err(failure(format!(
            "{} and {} give the same coordinate; leave one of them out",
            variables[first].name, later.name
        ))),
    }
}

/// Returns true if two variables are the same, or if one sets a coordinate that the other one moves. Two offsets of the same
/// coordinate do not conflict: they add up.
fn contradict(study: &hardpoint::Study, a: &DesignVariable, b: &DesignVariable) -> bool {
    if a.name == b.name {
        return true;
    }
    match (a.swept_as(), b.swept_as()) {
        (Some(a), Some(b)) => {
            let same = |m: &Move| (b.moves.iter()).any(|n| (n.point, n.axis) == (m.point, m.axis));
            (a.absolute || b.absolute) && a.moves.iter().any(same)
        }
        // The name of a rotation consists of the names of its points.
        (Some(other), None) => other.absolute && turns(study, &b.name, &other.moves),
        (None, Some(other)) => other.absolute && turns(study, &a.name, &other.moves),
        (None, None) => false,
    }
}

/// Returns true if the rotation with this name turns a point that is also in `moves`.
fn turns(study: &hardpoint::Study, name: &str, moves: &[Move]) -> bool {
    let (points, _) = name.rsplit_once("_turn_").unwrap_or((name, ""));
    let mechanism = &study.wheel().mechanism;
    let mut moved = moves.iter().map(|m| mechanism.name(m.point));
    moved.any(|moved| points.split('+').any(|point| point == moved))
}

/// Rows of an array of designs as one slice, row after row. Each row has `k` values, one per variable.
pub(crate) fn rows<'a>(x: &'a PyReadonlyArray2<'_, f64>, k: usize) -> PyResult<&'a [f64]> {
    let shape = x.shape();
    if shape[1] != k {
        return Err(failure(format!(
            "x has shape {shape:?}; expected (n, {k}), one column for each of `variables`"
        )));
    }
    x.as_slice()
        .map_err(|_| failure("x is not contiguous in C order; use numpy.ascontiguousarray(x)"))
}
