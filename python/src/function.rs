//! Curves as a pure function of the design.

use crate::errors::failure;
use crate::study::Study;
use crate::threads::{checked, on_threads};
use hardpoint::{DesignFunction, DesignStatus, DesignVariable, Evaluation, FunctionError};
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayDyn, PyArrayMethods, PyReadonlyArray2,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use rayon::prelude::*;

/// Designs that one thread takes at a time: of values, and of values with Jacobians, which take longer.
const CHUNK: usize = 128;
const DIFFERENTIATED: usize = 32;
/// Chunks between two looks for Ctrl-C.
const GROUP: usize = 512;

/// A pure function of the design.
#[pyclass(frozen, module = "hardpoint._hardpoint")]
pub(crate) struct Function {
    function: DesignFunction,
    text: String,
    name: String,
}

/// Designs of one chunk, and where their results go.
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
    fn new(py: Python<'_>, study: &Study, variables: Option<Vec<String>>) -> PyResult<Self> {
        let own = &study.study;
        let function = named(own, variables)
            .and_then(|variables| py.detach(|| DesignFunction::with_variables(own, variables)));
        Ok(Function {
            function: function.map_err(|e| failure(e.to_string()))?,
            text: own.text.clone(),
            name: own.name.clone(),
        })
    }

    #[getter]
    fn variables(&self) -> Vec<String> {
        let variables = self.function.variables().iter();
        variables.map(|v| v.name.clone()).collect()
    }

    /// Lowest and highest value of each variable, (variables, 2).
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

    /// Drive value and rack displacement of each station, (stations, 2), as columns print them.
    #[getter]
    fn stations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let stations = self.function.motion();
        let count = stations.len();
        let flat: Vec<f64> = stations.into_iter().flatten().collect();
        flat.into_pyarray(py).reshape([count, 2])
    }

    /// Values of designs (n, variables): (n, outputs, stations), and what came of each design.
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
        let values = PyArray3::<f64>::zeros(py, [n, f.len() / f.stations(), f.stations()], false);
        let mut status = vec![DesignStatus::Ok; n];
        {
            let mut write = values.readwrite();
            let (k, row) = (f.variables().len(), f.len());
            let chunks = (write.as_slice_mut()?.chunks_mut(CHUNK * row))
                .zip(status.chunks_mut(CHUNK))
                .enumerate()
                .map(|(number, (values, status))| Chunk {
                    x: &x[number * CHUNK * k..][..status.len() * k],
                    values,
                    jacobian: &mut [],
                    status,
                })
                .collect();
            self.carry_out(py, threads, chunks, |evaluation, chunk| {
                evaluation.values(chunk.x, chunk.values, chunk.status);
            })?;
        }
        Ok((values, words(status).into_pyarray(py)))
    }

    /// Values and exact Jacobians of designs (n, variables): (n, outputs, stations) and (n, outputs, stations,
    /// variables).
    #[pyo3(signature = (x, threads=None))]
    fn value_and_jacobian<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray2<'py, f64>,
        threads: Option<usize>,
    ) -> PyResult<(
        Bound<'py, PyArray3<f64>>,
        Bound<'py, PyArrayDyn<f64>>,
        Bound<'py, PyArray1<u8>>,
    )> {
        let f = &self.function;
        let n = x.shape()[0];
        let x = rows(&x, f.variables().len())?;
        let (stations, k) = (f.stations(), f.variables().len());
        let outputs = f.len() / stations;
        let values = PyArray3::<f64>::zeros(py, [n, outputs, stations], false);
        let jacobian = PyArrayDyn::<f64>::zeros(py, &[n, outputs, stations, k][..], false);
        let mut status = vec![DesignStatus::Ok; n];
        {
            let (mut write_y, mut write_j) = (values.readwrite(), jacobian.readwrite());
            let row = f.len();
            let chunks = (write_y.as_slice_mut()?.chunks_mut(DIFFERENTIATED * row))
                .zip(
                    write_j
                        .as_slice_mut()?
                        .chunks_mut((DIFFERENTIATED * row * k).max(1)),
                )
                .zip(status.chunks_mut(DIFFERENTIATED))
                .enumerate()
                .map(|(number, ((values, jacobian), status))| Chunk {
                    x: &x[number * DIFFERENTIATED * k..][..status.len() * k],
                    values,
                    jacobian,
                    status,
                })
                .collect();
            self.carry_out(py, threads, chunks, |evaluation, chunk| {
                evaluation.value_and_jacobian(chunk.x, chunk.values, chunk.jacobian, chunk.status);
            })?;
        }
        Ok((values, jacobian, words(status).into_pyarray(py)))
    }

    fn __repr__(&self) -> String {
        let (k, a, s) = (
            self.function.variables().len(),
            self.function.outputs().len(),
            self.function.stations(),
        );
        format!(
            "<hardpoint.Function {:?}: {k} variables -> {a} outputs x {s} stations>",
            self.name
        )
    }

    fn __reduce__(&self, py: Python<'_>) -> PyResult<(Py<PyAny>, (Py<PyAny>, Vec<String>))> {
        let class = py.get_type::<Function>().into_any().unbind();
        let loads = py.get_type::<Study>().getattr("loads")?;
        let study = loads.call1((&self.text, format!("{}.toml", self.name)))?;
        Ok((class, (study.unbind(), self.variables())))
    }
}

impl Function {
    /// Evaluates chunks: on the calling thread where there is one of either, else on so many threads.
    fn carry_out(
        &self,
        py: Python<'_>,
        threads: Option<usize>,
        mut chunks: Vec<Chunk<'_>>,
        work: impl Fn(&mut Evaluation<'_>, &mut Chunk<'_>) + Send + Sync,
    ) -> PyResult<()> {
        checked(threads)?;
        let f = &self.function;
        let alone = threads == Some(1) || chunks.len() == 1;
        for group in chunks.chunks_mut(GROUP) {
            py.detach(|| match alone {
                true => {
                    let mut evaluation = f.evaluation();
                    group
                        .iter_mut()
                        .for_each(|chunk| work(&mut evaluation, chunk));
                    Ok(())
                }
                false => on_threads(threads, || {
                    let all = group.par_iter_mut();
                    all.for_each_init(|| f.evaluation(), &work);
                }),
            })?;
            py.check_signals()?;
        }
        Ok(())
    }
}

/// The variables of these names, or those a study moves where none are given.
pub(crate) fn named(
    study: &hardpoint::Study,
    names: Option<Vec<String>>,
) -> Result<Vec<DesignVariable>, FunctionError> {
    match names {
        None => Ok(DesignVariable::of(study)),
        Some(names) => {
            let names = names.iter();
            names.map(|n| DesignVariable::named(n, study)).collect()
        }
    }
}

/// The rows of an array of designs, one after the other, with a column for each of `k` variables.
pub(crate) fn rows<'a>(x: &'a PyReadonlyArray2<'_, f64>, k: usize) -> PyResult<&'a [f64]> {
    let shape = x.shape();
    if shape[1] != k {
        return Err(failure(format!(
            "x has shape {shape:?}; expected (n, {k}), a column for each of variables"
        )));
    }
    x.as_slice()
        .map_err(|_| failure("x is not contiguous in C order"))
}

fn words(status: Vec<DesignStatus>) -> Vec<u8> {
    status.into_iter().map(|s| s as u8).collect()
}
