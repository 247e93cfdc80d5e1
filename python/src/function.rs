//! Curves as a pure function of the design.

use crate::errors::failure;
use crate::study::Study;
use crate::threads::on_threads;
use hardpoint::{DesignFunction, DesignStatus};
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayDyn, PyArrayMethods, PyReadonlyArray2,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use rayon::prelude::*;

/// Designs between two looks for Ctrl-C.
const PIECE: usize = 65_536;
/// Designs that one thread takes at a time.
const CHUNK: usize = 128;

/// A pure function of the design.
#[pyclass(frozen, module = "hardpoint._hardpoint")]
pub(crate) struct Function {
    function: DesignFunction,
    text: String,
    name: String,
}

#[pymethods]
impl Function {
    #[new]
    #[pyo3(signature = (study, variables=None))]
    fn new(py: Python<'_>, study: &Study, variables: Option<Vec<String>>) -> PyResult<Self> {
        let function = py
            .detach(|| DesignFunction::of(&study.study))
            .map_err(|e| failure(e.to_string()))?;
        let function = match variables {
            None => function,
            Some(names) => {
                let every = DesignFunction::every_coordinate(&study.study);
                let mut chosen = Vec::new();
                for name in names {
                    let known = function.variables().iter().chain(&every);
                    let found = known.into_iter().find(|v| v.name == name);
                    let Some(found) = found else {
                        return Err(failure(format!(
                            "there is no variable {name:?}; a hardpoint with its axis is meant, as in \
                             tie_rod_inner_dz"
                        )));
                    };
                    chosen.push(found.clone());
                }
                DesignFunction::with_variables(&study.study, chosen)
                    .map_err(|e| failure(e.to_string()))?
            }
        };
        Ok(Function {
            function,
            text: study.study.text.clone(),
            name: study.study.name.clone(),
        })
    }

    #[getter]
    fn variables(&self) -> Vec<String> {
        self.function
            .variables()
            .iter()
            .map(|v| v.name.clone())
            .collect()
    }

    /// Lowest and highest value of each variable, (variables, 2).
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let variables = self.function.variables();
        let flat: Vec<f64> = variables.iter().flat_map(|v| v.range).collect();
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
        let (x, n) = self.rows(&x)?;
        let shape = [n, f.outputs().len(), f.stations()];
        let values = PyArray3::<f64>::zeros(py, shape, false);
        let mut status = vec![DesignStatus::Ok; n];
        {
            let mut write = values.readwrite();
            let into = write.as_slice_mut()?;
            let (k, row) = (f.variables().len(), f.len());
            for ((x, into), status) in x
                .chunks((PIECE * k).max(1))
                .zip(into.chunks_mut((PIECE * row).max(1)))
                .zip(status.chunks_mut(PIECE))
            {
                py.detach(|| {
                    on_threads(threads, || {
                        x.par_chunks((CHUNK * k).max(1))
                            .zip(into.par_chunks_mut(CHUNK * row))
                            .zip(status.par_chunks_mut(CHUNK))
                            .try_for_each_init(
                                || f.evaluation(),
                                |evaluation, ((x, into), status)| match evaluation {
                                    Ok(evaluation) => {
                                        evaluation.values(x, into, status);
                                        Ok(())
                                    }
                                    Err(_) => Err(()),
                                },
                            )
                    })
                })?
                .map_err(|()| failure("the study's own design cannot be solved"))?;
                py.check_signals()?;
            }
        }
        let status: Vec<u8> = status.into_iter().map(|s| s as u8).collect();
        Ok((values, status.into_pyarray(py)))
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
        let (x, n) = self.rows(&x)?;
        let (outputs, stations, k) = (f.outputs().len(), f.stations(), f.variables().len());
        let values = PyArray3::<f64>::zeros(py, [n, outputs, stations], false);
        let jacobian = PyArrayDyn::<f64>::zeros(py, &[n, outputs, stations, k][..], false);
        let mut status = vec![DesignStatus::Ok; n];
        {
            let (mut write_y, mut write_j) = (values.readwrite(), jacobian.readwrite());
            let (y, j) = (write_y.as_slice_mut()?, write_j.as_slice_mut()?);
            let row = f.len();
            // Small enough that Ctrl-C is heard soon.
            let piece = 512;
            for (((x, y), j), status) in x
                .chunks((piece * k).max(1))
                .zip(y.chunks_mut((piece * row).max(1)))
                .zip(j.chunks_mut((piece * row * k).max(1)))
                .zip(status.chunks_mut(piece))
            {
                let all = x
                    .par_chunks(k.max(1))
                    .zip(y.par_chunks_mut(row))
                    .zip(j.par_chunks_mut((row * k).max(1)))
                    .zip(status.par_iter_mut());
                py.detach(|| {
                    on_threads(if n == 1 { Some(1) } else { threads }, || {
                        all.try_for_each_init(
                            || f.evaluation(),
                            |evaluation, (((x, y), j), status)| match evaluation {
                                Ok(evaluation) => {
                                    *status = evaluation.value_and_jacobian(x, y, j);
                                    Ok(())
                                }
                                Err(_) => Err(()),
                            },
                        )
                    })
                })?
                .map_err(|()| failure("the study's own design cannot be solved"))?;
                py.check_signals()?;
            }
        }
        let status: Vec<u8> = status.into_iter().map(|s| s as u8).collect();
        Ok((values, jacobian, status.into_pyarray(py)))
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
    /// The rows of an array of designs, and their number.
    fn rows<'a>(&self, x: &'a PyReadonlyArray2<'_, f64>) -> PyResult<(&'a [f64], usize)> {
        let k = self.function.variables().len();
        let shape = x.shape();
        if shape[1] != k {
            return Err(failure(format!(
                "x has shape {shape:?}; expected (n, {k}), a column for each of variables"
            )));
        }
        let slice = x.as_slice();
        let slice = slice.map_err(|_| failure("x is not contiguous in C order"))?;
        Ok((slice, shape[0]))
    }
}
