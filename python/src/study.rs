//! Studies, and functions that work on one design.

use crate::errors::{failure, not_done, study_error};
use crate::threads::on_threads;
use hardpoint::Topology;
use hardpoint::axle::{AxleQuantity, WheelQuantity};
use hardpoint::characteristics::Characteristic;
use hardpoint::mechanism::GeometryFault;
use hardpoint::number::Vector3;
use hardpoint::solved::Solved;
use hardpoint::study::{Designs, StudyErrors};
use numpy::{IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::OnceLock;

/// A study. It is immutable. Pickling stores its text, and the directory of the files that the text names.
#[pyclass(frozen, module = "hardpoint._hardpoint")]
pub(crate) struct Study {
    /// Data of the study. If its points were moved, its text is still the text of `moved_from`.
    pub(crate) study: hardpoint::study::Study,
    /// The original study, if this study was made by moving its points instead of reading a text.
    moved_from: Option<Py<Study>>,
    /// Copy of the study whose text contains the moved points. It is made at its first use, and only if points were
    /// moved.
    whole: OnceLock<hardpoint::study::Study>,
}

#[pymethods]
impl Study {
    /// Reads a study from a file.
    #[staticmethod]
    #[pyo3(signature = (path, overrides=Vec::new()))]
    fn load(py: Python<'_>, path: PathBuf, overrides: Vec<String>) -> PyResult<Self> {
        Study::of(py.detach(|| hardpoint::study::Study::read_elastic(&path, &overrides)))
    }

    /// Reads a study from its text. `directory` holds the files that the text names.
    #[staticmethod]
    #[pyo3(signature = (text, name="study.toml", directory=None))]
    fn loads(py: Python<'_>, text: &str, name: &str, directory: Option<PathBuf>) -> PyResult<Self> {
        let directory = directory.unwrap_or_default();
        Study::of(py.detach(|| hardpoint::study::Study::elastic_from_text(name, text, &directory)))
    }

    /// Text of the study. Target curves from files are written into it.
    #[getter]
    fn text(&self) -> &str {
        &self.whole().text
    }

    #[getter]
    fn name(&self) -> &str {
        &self.study.name
    }

    #[getter]
    fn topology(&self) -> &str {
        self.study.wheel().mechanism.topology.name
    }

    #[getter]
    fn length_unit(&self) -> &str {
        self.study.wheel().length_unit.symbol()
    }

    /// Names of the variables that functions and sweeps of the study use by default.
    #[getter]
    fn variables(&self) -> Vec<String> {
        let variables = hardpoint::DesignVariable::of(&self.study);
        variables.into_iter().map(|v| v.name).collect()
    }

    /// Names of the variables of `[sweep]`. Empty without `[sweep]`.
    #[getter]
    fn sweep_variables(&self) -> Vec<String> {
        let designs = self.study.sweep.as_ref().map(|sweep| &sweep.designs);
        let variables = match designs {
            Some(Designs::Sampled(sampled)) => &sampled.variables[..],
            Some(Designs::Given(table)) => &table.variables,
            Some(Designs::File(_)) | None => &[],
        };
        variables.iter().map(|v| v.name.clone()).collect()
    }

    /// Names of the motions in `[motions]` that have curves.
    #[getter]
    fn motions(&self) -> Vec<String> {
        let names = self.study.motion_names().into_iter();
        names.map(str::to_owned).collect()
    }

    /// True if the study describes an axle.
    #[getter]
    fn is_axle(&self) -> bool {
        self.study.axle().is_some()
    }

    /// Names of the points.
    #[getter]
    fn points(&self) -> Vec<String> {
        let points = self.study.wheel().mechanism.points.iter();
        points.map(|p| p.name.clone()).collect()
    }

    /// Design positions of the points in the study's axes and length unit, as an array (points, 3).
    #[getter]
    fn design<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let suspension = self.study.wheel();
        let points = suspension.design.iter();
        // Adding 0.0 turns negative zeros, which appear if an axis is reversed, into positive zeros.
        let rows: Vec<f64> = points
            .flat_map(|p| suspension.frame.vector(*p).to_array().map(|c| c + 0.0))
            .collect();
        rows.into_pyarray(py).reshape([suspension.design.len(), 3])
    }

    /// Study with other design positions (points, 3), in the study's axes and length unit. It equals the study that would be read
    /// from a text with these points.
    fn with_design(slf: &Bound<'_, Self>, design: PyReadonlyArray2<'_, f64>) -> PyResult<Self> {
        let this = slf.get();
        let suspension = this.study.wheel();
        let expected = [suspension.design.len(), 3];
        let array = design.as_array();
        if array.shape() != expected {
            return Err(failure(format!(
                "design has shape ({}, {}); expected ({}, 3), one row for each of `points`",
                array.shape()[0],
                array.shape()[1],
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
        Self::moved(slf, this.study.at_design(moved))
    }

    /// Study with overridden fields. Each override looks like `motion.rack=5.0`.
    fn with_overrides(&self, py: Python<'_>, overrides: Vec<String>) -> PyResult<Self> {
        let (file, whole) = (self.file_name(), self.whole());
        Study::of(py.detach(|| whole.with_overrides(&file, &overrides)))
    }

    fn __repr__(&self) -> String {
        format!(
            "<hardpoint.Study {:?}: {}>",
            self.study.name,
            self.topology()
        )
    }

    fn __reduce__(&self, py: Python<'_>) -> PyResult<(Py<PyAny>, (String, String, PathBuf))> {
        let loads = py.get_type::<Study>().getattr("loads")?.unbind();
        let text = self.text().to_owned();
        Ok((
            loads,
            (text, self.file_name(), self.study.directory.clone()),
        ))
    }
}

impl Study {
    pub(crate) fn of(read: Result<hardpoint::study::Study, StudyErrors>) -> PyResult<Self> {
        let study = read.map_err(|errors| study_error(&errors))?;
        Ok(Study {
            study,
            moved_from: None,
            whole: OnceLock::new(),
        })
    }

    /// Study with moved points. It equals the study that would be read from a text with these points.
    pub(crate) fn moved(slf: &Bound<'_, Self>, moved: hardpoint::study::Study) -> PyResult<Self> {
        let (py, this) = (slf.py(), slf.get());
        let root = match &this.moved_from {
            Some(root) => root.clone_ref(py),
            None => slf.clone().unbind(),
        };
        // If the study does not name the body of a drop link, the points decide which body carries it.
        let wheel = moved.wheel();
        if wheel.mechanism.keeps_drop_link(&wheel.design) && is_sound(&moved) {
            return Ok(Study {
                study: moved,
                moved_from: Some(root),
                whole: OnceLock::new(),
            });
        }
        let text = root.get().study.with_points_of(&moved);
        Study::of(py.detach(|| moved.read_again(&this.file_name(), &text)))
    }

    /// Study whose text contains its present points.
    pub(crate) fn whole(&self) -> &hardpoint::study::Study {
        match &self.moved_from {
            None => &self.study,
            Some(root) => self.whole.get_or_init(|| {
                let mut whole = self.study.clone();
                whole.text = root.get().study.with_points_of(&self.study);
                whole
            }),
        }
    }

    pub(crate) fn file_name(&self) -> String {
        format!("{}.toml", self.study.name)
    }

    /// Exception for a fault in the design of the study.
    pub(crate) fn fault(&self, fault: &hardpoint::mechanism::DesignFault) -> PyErr {
        failure(fault.describe(&self.study.wheel().mechanism))
    }
}

/// Returns true if the study's points pass all checks that reading a study makes.
fn is_sound(study: &hardpoint::study::Study) -> bool {
    let right = study.axle().and_then(|both| both.axle.right.as_ref());
    let mut wheels = [Some(study.wheel()), right].into_iter().flatten();
    wheels.all(|wheel| GeometryFault::all_of(wheel).is_empty())
}

/// Names of the topologies (kinds of suspension).
#[pyfunction]
pub(crate) fn topologies() -> Vec<&'static str> {
    Topology::ALL.iter().map(|t| t.name).collect()
}

/// Commented study of a topology. The study runs without changes.
#[pyfunction]
#[pyo3(signature = (topology, parts=Vec::new()))]
pub(crate) fn template(topology: &str, parts: Vec<String>) -> PyResult<String> {
    hardpoint::cli::template(topology, &parts).map_err(failure)
}

/// JSON schema of studies, as text.
#[pyfunction]
pub(crate) fn schema(py: Python<'_>) -> &'static str {
    static SCHEMA: OnceLock<String> = OnceLock::new();
    py.detach(|| SCHEMA.get_or_init(|| hardpoint::study::schema().to_string()))
}

/// Checks a study as `hardpoint check` does. Returns warnings and remarks, one per line, and the stations that cannot
/// be solved.
#[pyfunction]
pub(crate) fn check(py: Python<'_>, study: &Study) -> PyResult<(Vec<String>, Vec<String>)> {
    let own = &study.study;
    on_threads(py, Some(1), |_| -> Result<_, String> {
        let alone = hardpoint::checked::motion_alone(own);
        let checked = hardpoint::checked::Checked::of(&alone)?;
        Ok((checked.remarks(own), checked.failures(own.wheel())))
    })?
    .map_err(failure)
}

/// Drawing of the mechanism along the study's motion, as JSON: the bodies, and their positions at some stations.
#[pyfunction]
pub(crate) fn drawing(py: Python<'_>, study: &Study) -> PyResult<String> {
    let own = &study.study;
    let record = on_threads(py, Some(1), |_| {
        let solved = Solved::of(own)?;
        Solved::record("solve", &[("design", "curves.csv", &solved)])
    })?;
    let record = record.map_err(failure)?;
    let frames = record.motion.designs.last().map(|design| &design.frames);
    Ok(serde_json::json!({ "scene": record.scene, "frames": frames }).to_string())
}

/// Runs a command of the program in this process, as in `["report", "out/front"]`. Returns the exit code. With `is_program`,
/// the command handles signals as the stand-alone program does.
#[pyfunction]
#[pyo3(signature = (arguments, is_program=false))]
pub(crate) fn command(py: Python<'_>, arguments: Vec<String>, is_program: bool) -> PyResult<u8> {
    let arguments = ["hardpoint".to_owned()].into_iter().chain(arguments);
    if is_program {
        return Ok(py.detach(|| hardpoint::cli::run_with(arguments)));
    }
    crate::threads::command(py, || hardpoint::cli::run_embedded(arguments))
}

/// Runs a command and suppresses its standard output. Returns its exit code and its text for standard error.
#[pyfunction]
pub(crate) fn command_captured(py: Python<'_>, arguments: Vec<String>) -> PyResult<(u8, String)> {
    let arguments = ["hardpoint".to_owned(), "--quiet".to_owned()]
        .into_iter()
        .chain(arguments);
    crate::threads::command(py, || hardpoint::cli::run_captured(arguments))
}

/// Exports a study with the arguments of the program. Returns the program's remarks. Files that the study names need not exist.
#[pyfunction]
pub(crate) fn export_study(
    py: Python<'_>,
    study: &Study,
    arguments: Vec<String>,
) -> PyResult<String> {
    let own = study.whole();
    let done = crate::threads::command(py, || hardpoint::cli::export_study(own, &arguments))?;
    done.map_err(not_done)
}

/// Imports points with the arguments of the program: from the file that they name, or from a JSON map. Returns the text of the
/// study, and the summary.
#[pyfunction]
#[pyo3(signature = (arguments, points=None, names=BTreeMap::new()))]
pub(crate) fn import_study(
    py: Python<'_>,
    arguments: Vec<String>,
    points: Option<String>,
    names: BTreeMap<String, String>,
) -> PyResult<(String, String)> {
    let points = points.as_deref();
    let done = crate::threads::command(py, move || {
        hardpoint::cli::import_study(&arguments, points, names)
    })?;
    done.map_err(not_done)
}

/// Formula and literature source of every catalogue quantity, by its name without unit.
#[pyfunction]
pub(crate) fn catalogue() -> BTreeMap<&'static str, (&'static str, &'static str)> {
    let wheel = Characteristic::ALL.iter().map(|c| c.info());
    let of_wheels = WheelQuantity::ALL.iter().map(|q| q.info());
    let axle = AxleQuantity::ALL.iter().map(|q| q.info());
    // The quantities of an axle are at the end. So an axle quantity replaces a wheel quantity of the same name.
    let all = wheel.chain(of_wheels).chain(axle);
    all.map(|info| (info.name, (info.formula, info.source)))
        .collect()
}
