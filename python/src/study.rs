//! Studies, and what is asked of one design.

use crate::errors::{failure, study_error};
use hardpoint::Topology;
use hardpoint::analyse::{Range, RangeEnd};
use hardpoint::axle::axle_curves;
use hardpoint::curves::{Curves, curves};
use hardpoint::model::{Axis, Side};
use hardpoint::number::Vector3;
use hardpoint::plan::Plan;
use hardpoint::solve::Solver;
use hardpoint::study::StudyErrors;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// A study: frozen, pickled as its text.
#[pyclass(frozen, module = "hardpoint._hardpoint")]
pub(crate) struct Study {
    pub(crate) study: hardpoint::study::Study,
}

#[pymethods]
impl Study {
    /// From a file.
    #[staticmethod]
    #[pyo3(signature = (path, overrides=Vec::new()))]
    fn load(path: PathBuf, overrides: Vec<String>) -> PyResult<Self> {
        let study = hardpoint::study::Study::read(&path, &overrides);
        Study::of(study)
    }

    /// From its text; `directory` is where the files it names are.
    #[staticmethod]
    #[pyo3(signature = (text, name="study.toml", directory=None))]
    fn loads(text: &str, name: &str, directory: Option<PathBuf>) -> PyResult<Self> {
        let directory = directory.unwrap_or_default();
        let study = hardpoint::study::Study::from_text(name, text, &directory);
        Study::of(study)
    }

    /// The text, target curves from files written out.
    #[getter]
    fn text(&self) -> &str {
        &self.study.text
    }

    #[getter]
    fn name(&self) -> &str {
        &self.study.name
    }

    #[getter]
    fn topology(&self) -> &str {
        self.study.suspension.mechanism.topology.name
    }

    #[getter]
    fn length_unit(&self) -> &str {
        self.study.suspension.length_unit.symbol()
    }

    /// Names of what moves in functions and sweeps of the study, unless others are given.
    #[getter]
    fn variables(&self) -> Vec<String> {
        let variables = hardpoint::DesignVariable::of(&self.study);
        variables.into_iter().map(|v| v.name).collect()
    }

    /// Names of the points.
    #[getter]
    fn points(&self) -> Vec<String> {
        let points = self.study.suspension.mechanism.points.iter();
        points.map(|p| p.name.clone()).collect()
    }

    /// Their design positions, (points, 3), in the study's axes.
    #[getter]
    fn design<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let suspension = &self.study.suspension;
        let points = suspension.design.iter();
        // No negative zeros from axes that point the other way.
        let rows: Vec<f64> = points
            .flat_map(|p| suspension.frame.vector(*p).to_array().map(|c| c + 0.0))
            .collect();
        rows.into_pyarray(py).reshape([suspension.design.len(), 3])
    }

    /// The study with other design positions.
    fn with_design(&self, design: PyReadonlyArray2<'_, f64>) -> PyResult<Self> {
        let suspension = &self.study.suspension;
        let expected = [suspension.design.len(), 3];
        let array = design.as_array();
        if array.shape() != expected {
            return Err(failure(format!(
                "design has shape {:?}; expected ({}, 3), a row for each of points",
                array.shape(),
                expected[0]
            )));
        }
        if let Some(bad) = array.iter().find(|c| !c.is_finite()) {
            return Err(failure(format!(
                "design has {bad}; expected finite coordinates"
            )));
        }
        let rows = array.rows().into_iter();
        let moved: Vec<Vector3<f64>> = rows
            .map(|p| suspension.frame.vector(Vector3::new(p[0], p[1], p[2])))
            .collect();
        let text = self.study.with_design(&moved);
        Self::loads(&text, &self.file_name(), None)
    }

    /// The study with fields overridden, each as in `motion.rack=5.0`.
    fn with_overrides(&self, overrides: Vec<String>) -> PyResult<Self> {
        let file = self.file_name();
        let study = self.study.with_overrides(&file, &overrides);
        Study::of(study)
    }

    fn __repr__(&self) -> String {
        format!(
            "<hardpoint.Study {:?}: {}>",
            self.study.name,
            self.topology()
        )
    }

    fn __reduce__(&self, py: Python<'_>) -> PyResult<(Py<PyAny>, (String, String))> {
        let loads = py.get_type::<Study>().getattr("loads")?.unbind();
        Ok((loads, (self.study.text.clone(), self.file_name())))
    }
}

impl Study {
    fn of(read: Result<hardpoint::study::Study, StudyErrors>) -> PyResult<Self> {
        let study = read.map_err(|errors| study_error(&errors))?;
        Ok(Study { study })
    }

    fn file_name(&self) -> String {
        format!("{}.toml", self.study.name)
    }

    /// A fault of the study's own design.
    pub(crate) fn fault(&self, fault: &hardpoint::mechanism::DesignFault) -> PyErr {
        failure(fault.describe(&self.study.suspension.mechanism))
    }
}

/// Names of the topologies.
#[pyfunction]
pub(crate) fn topologies() -> Vec<&'static str> {
    Topology::ALL.iter().map(|t| t.name).collect()
}

/// A commented study that runs as it is.
#[pyfunction]
pub(crate) fn template(topology: &str) -> PyResult<&'static str> {
    let known = Topology::named(topology);
    let known = known.ok_or_else(|| failure(format!("there is no topology {topology:?}")))?;
    Ok(known.template)
}

/// The JSON schema of studies, as text.
#[pyfunction]
pub(crate) fn schema() -> String {
    hardpoint::study::schema().to_string()
}

/// The curves: columns, stations, statuses and, where the study asks for them, sensitivities.
#[pyfunction]
pub(crate) fn solve<'py>(py: Python<'py>, study: &Study) -> PyResult<Bound<'py, PyDict>> {
    let own = &study.study;
    let found = match &own.axle {
        Some(both) => py
            .detach(|| axle_curves(&both.axle, &both.plan))
            .map(|found| found.curves)
            .map_err(|fault| failure(both.axle.describe_fault(fault)))?,
        None => py
            .detach(|| curves(&own.suspension, &Plan::of(own)))
            .map_err(|fault| study.fault(&fault))?,
    };
    let column = |values: &mut dyn Iterator<Item = Option<f64>>| -> Bound<'py, PyArray1<f64>> {
        let values: Vec<f64> = values.map(|v| v.unwrap_or(f64::NAN)).collect();
        values.into_pyarray(py)
    };
    let (columns, info) = (PyDict::new(py), PyDict::new(py));
    for (k, c) in found.columns.iter().enumerate() {
        let mut values = found.stations.iter().map(|s| s.value(k));
        columns.set_item(&c.name, column(&mut values))?;
        info.set_item(&c.name, (&c.output, &c.unit, c.positive))?;
    }
    let motion = PyDict::new(py);
    for c in &found.motion {
        if own.axle.is_none() || c.is_written {
            motion.set_item(c.name(), column(&mut found.along(c.key)))?;
        }
    }
    let result = PyDict::new(py);
    result.set_item("columns", columns)?;
    result.set_item("info", info)?;
    if own.axle.is_none() {
        let drive = own.motion.drive.key();
        result.set_item("drive", column(&mut found.along(drive)))?;
    }
    result.set_item("motion", motion)?;
    let words: Vec<&str> = found.stations.iter().map(|s| s.status.word()).collect();
    result.set_item("status", words)?;
    set_sensitivities(py, own, &found, &result)?;
    Ok(result)
}

/// Adds the sensitivities of curves to a result: `[station][column][point][axis]`, of an axle by side before that.
fn set_sensitivities(
    py: Python<'_>,
    study: &hardpoint::study::Study,
    found: &Curves,
    result: &Bound<'_, PyDict>,
) -> PyResult<()> {
    let (points, sides) = match &study.axle {
        Some(both) => {
            let sides = if both.axle.right.is_some() { 2 } else { 1 };
            (&both.plan.sensitivities, Some(sides))
        }
        None => (&study.outputs.sensitivities, None),
    };
    if points.is_empty() {
        return Ok(());
    }
    let shape = [found.stations.len(), found.columns.len(), points.len(), 3];
    let known = found.sensitivities.iter().filter_map(|s| {
        let point = points.iter().position(|p| *p == s.point)?;
        Some((s, [s.station, s.column, point, s.axis as usize]))
    });
    let array = match sides {
        None => mostly_nan(py, shape, known.map(|(s, at)| (at, s.value))),
        Some(sides) => {
            let [stations, columns, points, axes] = shape;
            let known = known.map(|(s, [station, column, point, axis])| {
                let side = usize::from(s.side == Some(Side::Right));
                ([side, station, column, point, axis], s.value)
            });
            mostly_nan(py, [sides, stations, columns, points, axes], known)
        }
    };
    let names = points.iter().map(|p| study.suspension.mechanism.name(*p));
    result.set_item("sensitivities", array)?;
    result.set_item("sensitivity_points", names.collect::<Vec<_>>())
}

/// An array with values at some places, NaN at all others.
pub(crate) fn mostly_nan<const N: usize>(
    py: Python<'_>,
    shape: [usize; N],
    known: impl Iterator<Item = ([usize; N], f64)>,
) -> Bound<'_, PyArrayDyn<f64>> {
    let array = PyArrayDyn::<f64>::zeros(py, &shape[..], false);
    {
        let mut write = array.readwrite();
        let mut view = write.as_array_mut();
        view.fill(f64::NAN);
        for (at, value) in known {
            view[&at[..]] = value;
        }
    }
    array
}

/// How far travel, rack and arm go from the design position: (lower, upper) with their causes.
#[pyfunction]
pub(crate) fn limits<'py>(py: Python<'py>, study: &Study) -> PyResult<Bound<'py, PyDict>> {
    if let Some(axle) = &study.study.axle {
        return crate::axle::limits(py, axle);
    }
    let suspension = &study.study.suspension;
    let found = py.detach(|| {
        Solver::new(&suspension.mechanism, &suspension.design).and_then(|mut s| s.limits())
    });
    let found = found.map_err(|fault| study.fault(&fault))?;
    let range =
        |range: &Range, factor: f64| ends([&range.lower, &range.upper].map(cause_of), factor);
    let result = PyDict::new(py);
    result.set_item("travel", range(&found.travel, 1.0))?;
    let rack_sign = suspension.frame.sign(Axis::Y);
    let rack = found.rack.as_ref().map(|r| range(r, rack_sign));
    result.set_item("rack", rack)?;
    let degrees = 1.0_f64.to_degrees();
    let angle = found.arm_angle.as_ref().map(|r| range(r, degrees));
    result.set_item("arm_angle_deg", angle)?;
    Ok(result)
}

/// An end of a range and its cause; of one that turns right round there is half a turn on either side.
pub(crate) type End = (f64, String);

/// The value of an end, NaN where there is none, and its cause.
pub(crate) fn cause_of(end: &RangeEnd) -> End {
    match end {
        RangeEnd::Fold(limit) => (end.value(), limit.cause.to_string()),
        RangeEnd::FullTurn => (f64::NAN, "turns right round".to_owned()),
        RangeEnd::Unresolved(_) => {
            let cause = "the path could not be followed any further";
            (end.value(), cause.to_owned())
        }
    }
}

/// Both ends as they are printed, the lower one first.
pub(crate) fn ends([lower, upper]: [End; 2], factor: f64) -> [End; 2] {
    let half_turn = std::f64::consts::PI;
    let printed = |(value, cause): End, otherwise: f64| {
        let value = if value.is_nan() { otherwise } else { value };
        (value * factor, cause)
    };
    let [lower, upper] = [printed(lower, -half_turn), printed(upper, half_turn)];
    match factor < 0.0 {
        true => [upper, lower],
        false => [lower, upper],
    }
}

/// Solves the design position and says what is doubtful about it, in words.
#[pyfunction]
pub(crate) fn check(py: Python<'_>, study: &Study) -> PyResult<Vec<String>> {
    let own = &study.study;
    let doubts = py.detach(|| hardpoint::report::study_doubts(own));
    doubts.map_err(|(side, fault)| match &own.axle {
        Some(both) => failure(both.axle.describe_fault((side, fault))),
        None => study.fault(&fault),
    })
}

/// Runs a command of the program in this process, as in `["report", "out/front"]`; its exit code. As the program
/// itself it handles signals, else they are left to Python.
#[pyfunction]
#[pyo3(signature = (arguments, is_program=false))]
pub(crate) fn command(py: Python<'_>, arguments: Vec<String>, is_program: bool) -> u8 {
    let arguments = ["hardpoint".to_owned()].into_iter().chain(arguments);
    py.detach(|| match is_program {
        true => hardpoint::cli::run_with(arguments),
        false => hardpoint::cli::run_embedded(arguments),
    })
}
