//! Results of commands in memory: the files that the command writes, by name, and its summary.

use crate::curves::in_motion;
use crate::errors::failure;
use crate::study::Study;
use crate::threads::{interruptible, on_threads};
use hardpoint::assembled;
use hardpoint::compared;
use hardpoint::report::{
    Comparison, FinishedRun, OtherProgram, Picture, Record, Run, ToleranceSummary, car_page,
    comparison_page, kc_page, page, pictures as drawn_pictures, rejected, set_up_page, sweep_page,
};
use hardpoint::results::RunDirectory;
use hardpoint::rig::RigTests;
use hardpoint::scatter;
use hardpoint::set_up::{Refusal, set_up};
use hardpoint::solved::Solved;
use hardpoint::study::{Drive, Tolerance};
use hardpoint::sweep::SweepPlan;
use hardpoint::tolerance::{Expansion, Forecast, Problem, monte_carlo};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Files of a run with their names, and the summary of the run as JSON.
struct Answer {
    files: Vec<(String, Vec<u8>)>,
    summary: String,
}

impl Answer {
    fn of(files: Vec<(&str, Vec<u8>)>, summary: &impl serde::Serialize) -> Self {
        let summary = serde_json::to_string_pretty(summary).expect("JSON can store summaries");
        let files = files
            .into_iter()
            .map(|(name, bytes)| (name.to_owned(), bytes));
        Answer {
            files: files.collect(),
            summary: summary + "\n",
        }
    }

    fn into_dict(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let result = PyDict::new(py);
        for (name, bytes) in &self.files {
            result.set_item(name, PyBytes::new(py, bytes))?;
        }
        result.set_item("summary.json", PyBytes::new(py, self.summary.as_bytes()))?;
        Ok(result)
    }
}

/// JSON of a record, as the program writes it to a file.
pub(crate) fn as_json(record: &Record) -> Vec<u8> {
    let text = serde_json::to_string(record).expect("JSON can store records");
    (text + "\n").into_bytes()
}

/// Files of `solve`, over the motion of `[motion]` or over one of `[motions]`.
#[pyfunction]
#[pyo3(signature = (study, motion=None))]
pub(crate) fn solve_files<'py>(
    py: Python<'py>,
    study: &Study,
    motion: Option<&str>,
) -> PyResult<Bound<'py, PyDict>> {
    let own = study.whole();
    let moved = motion.map(|name| in_motion(own, name)).transpose()?;
    let own = moved.as_ref().unwrap_or(own);
    let answer = on_threads(py, Some(1), |_| -> Result<Answer, String> {
        let solved = Solved::of(own)?;
        let record = Solved::record("solve", &[("design", "curves.csv", &solved)])?;
        let mut files = vec![("curves.csv", solved.csv())];
        files.extend(
            solved
                .sensitivities_csv()
                .map(|csv| ("sensitivities.csv", csv)),
        );
        files.push(("report.json", as_json(&record)));
        Ok(Answer::of(files, &solved.summary()?))
    })?;
    answer.map_err(failure)?.into_dict(py)
}

/// Makes the HTML page of a run whose files are in memory. On request, also returns the pictures of its curves, by name.
#[pyfunction]
#[pyo3(signature = (files, pictures=false))]
pub(crate) fn page_of_files<'py>(
    py: Python<'py>,
    files: BTreeMap<String, Vec<u8>>,
    pictures: bool,
) -> PyResult<(String, Bound<'py, PyDict>)> {
    let made = on_threads(py, Some(1), |_| {
        let run = Run::of_files(&files).map_err(|e| e.to_string())?;
        let drawn = if pictures {
            drawn_pictures(&run)
        } else {
            Vec::new()
        };
        Ok::<_, String>((page(&run), drawn))
    })?;
    let (html, drawn) = made.map_err(failure)?;
    Ok((html, by_name(py, &drawn)?))
}

/// Contents of pictures as a dictionary, by the names of the pictures.
fn by_name<'py>(py: Python<'py>, pictures: &[Picture]) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    for picture in pictures {
        result.set_item(&picture.name, PyBytes::new(py, &picture.contents))?;
    }
    Ok(result)
}

/// Returns the study. Refuses a study with elastic parts, because the result `what` would ignore them.
pub(crate) fn rigid<'s>(own: &'s hardpoint::Study, what: &str) -> PyResult<&'s hardpoint::Study> {
    if own.is_elastic() {
        Err(failure(format!(
            "{what} would ignore the elastic parts of the study: remove [compliance] to use the \
             rigid mechanism"
        )))
    } else {
        Ok(own)
    }
}

/// Results of the `kc` tests (kinematics and compliance): tables, page and summary by file name.
#[pyfunction]
#[pyo3(signature = (study, names=None))]
pub(crate) fn kc<'py>(
    py: Python<'py>,
    study: &Study,
    names: Option<&str>,
) -> PyResult<Bound<'py, PyDict>> {
    let own = study.whole();
    let other = match names {
        None => None,
        Some("adams") => Some(OtherProgram::Adams),
        Some("altair") => Some(OtherProgram::Altair),
        Some(names) => {
            return Err(failure(format!(
                "names is {names:?}; expected \"adams\" or \"altair\""
            )));
        }
    };
    let answer = on_threads(py, Some(1), |_| -> Result<Answer, String> {
        let tests = RigTests::of(own, other)?;
        let mut files = tests.tables();
        let page = kc_page(&own.name, &tests.results);
        files.push(("report.html", page.into_bytes()));
        Ok(Answer::of(files, &tests.summary()))
    })?;
    answer.map_err(failure)?.into_dict(py)
}

/// Adjustments that give the static values of `[setup]`: tables, page and summary by file name. `curves.csv` is missing with the
/// drive of Attia's paper.
#[pyfunction]
pub(crate) fn setup<'py>(py: Python<'py>, study: &Study) -> PyResult<Bound<'py, PyDict>> {
    let own = study.whole();
    let setup = own.setup.as_ref().ok_or_else(|| {
        failure("the study has no [setup] section, which gives adjustments and target values")
    })?;
    let answer = on_threads(py, Some(1), |_| -> Result<Answer, String> {
        let found = set_up(own, setup).map_err(Refusal::reason)?;
        let mut files = vec![
            ("setup.csv", found.steps_table().csv(None).into_bytes()),
            ("effects.csv", found.effects_table().csv(None).into_bytes()),
        ];
        if found.adjusted.motion().drive != Drive::PaperTheta {
            files.insert(0, ("curves.csv", Solved::of(&found.adjusted)?.csv()));
        }
        files.push(("report.html", set_up_page(&found.wheels).into_bytes()));
        Ok(Answer::of(files, &found.record()))
    })?;
    answer.map_err(failure)?.into_dict(py)
}

pub(crate) fn tolerance_of(own: &hardpoint::Study) -> PyResult<&Tolerance> {
    own.tolerance.as_ref().ok_or_else(|| {
        failure("the study has no [tolerance] section, which gives the scatter of parts")
    })
}

/// Effect of the scatter of `[tolerance]` on the results, as files by name. `progress(done, all)` is called on this thread.
#[pyfunction]
#[pyo3(signature = (study, threads=None, progress=None))]
pub(crate) fn tolerance<'py>(
    py: Python<'py>,
    study: &Study,
    threads: Option<usize>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let own = study.whole();
    let tolerance = tolerance_of(own)?;
    let done = AtomicU64::new(0);
    let work = |flag: &AtomicBool| scattered(own, tolerance, flag, &done);
    let listen = |_: Python<'_>, _: &AtomicBool| match &progress {
        None => Ok(()),
        Some(progress) => {
            let done = done.load(Ordering::Relaxed);
            progress.call1((done, tolerance.builds)).map(drop)
        }
    };
    let answer = interruptible(py, threads, work, listen)?;
    answer.map_err(failure)?.into_dict(py)
}

/// Computes the results of all builds. An interrupted call returns no results.
fn scattered(
    own: &hardpoint::Study,
    tolerance: &Tolerance,
    flag: &AtomicBool,
    done: &AtomicU64,
) -> Result<Answer, String> {
    let refused = |reason| scatter::refusal(own, reason);
    let words = |fault: hardpoint::mechanism::DesignFault| fault.describe(&own.wheel().mechanism);
    let problem = Problem::of(own, tolerance).map_err(refused)?;
    let problem = problem.interruptible(flag);
    let drawn = problem.drawn().map_err(words)?;
    let expansion = Expansion::of(&problem).map_err(refused)?;
    let forecast = Forecast::of(&problem, &expansion, &drawn);
    let builds = monte_carlo(&problem, &drawn, |count| {
        done.store(count, Ordering::Relaxed);
        if flag.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    let builds = builds.map_err(words)?;
    let yields = forecast.as_ref().map(|forecast| forecast.rank(&builds));
    let summary = ToleranceSummary::of(&problem, &drawn, &expansion, &builds, yields.as_ref());
    let unit = own.wheel().length_unit.symbol();
    let contributors: Vec<String> = tolerance.scatter.iter().map(|c| c.name.clone()).collect();
    let mut files = vec![
        ("tolerance.csv", summary.csv(unit)),
        (
            "contributors.csv",
            summary.contributors_csv(&contributors, unit),
        ),
    ];
    let record = scatter::with_fans(&problem, &builds, |designs| {
        for (file, (.., curves)) in scatter::FAN_FILES.into_iter().zip(designs) {
            files.push((file, curves.csv()));
        }
        Solved::record("tolerance", designs)
    })??;
    files.push(("report.json", as_json(&record)));
    Ok(Answer::of(files, &summary))
}

/// Study of one build of `[tolerance]`, by its number from 0.
#[pyfunction]
pub(crate) fn build(py: Python<'_>, study: &Study, number: u64) -> PyResult<Study> {
    let own = study.whole();
    let tolerance = tolerance_of(own)?;
    let text = on_threads(py, Some(1), |_| -> Result<String, String> {
        let problem = Problem::of(own, tolerance).map_err(|why| scatter::refusal(own, why))?;
        problem.built_text(number).map_err(|(side, reject)| {
            format!(
                "build {number} cannot be assembled: {}",
                rejected(side, &reject)
            )
        })
    })?;
    let text = text.map_err(failure)?;
    let file = study.file_name();
    Study::of(py.detach(|| own.read_again(&file, &text)))
}

/// Study of one design of `[sweep]`, by its number from 0.
#[pyfunction]
pub(crate) fn swept_design(py: Python<'_>, study: &Study, number: u64) -> PyResult<Study> {
    let own = study.whole();
    let sweep = crate::sweep::own_sweep(study)?;
    let plan = on_threads(py, Some(1), |_| SweepPlan::of(own, sweep))?;
    let plan = plan.map_err(|e| crate::sweep::not_begun(study, e))?;
    let designs = plan.record.designs;
    if number >= designs {
        return Err(failure(format!(
            "there is no design {number}; the sweep has {designs}, numbered from 0"
        )));
    }
    let text = own.with_points_of(&plan.moved(number));
    let file = study.file_name();
    Study::of(py.detach(|| own.read_again(&file, &text)))
}

/// All positions in which the parts of the design can be assembled at a travel and a rack displacement, as CSV. Travel and rack
/// displacement are in the study's length unit and axes. Also returns descriptions of the regions in which the search
/// could not decide.
#[pyfunction]
pub(crate) fn assemblies<'py>(
    py: Python<'py>,
    study: &Study,
    travel: f64,
    rack: f64,
) -> PyResult<(Bound<'py, PyBytes>, Vec<String>)> {
    let own = rigid(&study.study, "assemblies")?;
    for (name, value) in [("travel", travel), ("rack", rack)] {
        if !value.is_finite() {
            return Err(failure(format!(
                "{name} is {value}; expected a finite length"
            )));
        }
    }
    let found = on_threads(py, Some(1), |_| assembled::assemblies(own, travel, rack))?;
    let found = found.map_err(failure)?;
    let csv = found.table.csv(None);
    Ok((PyBytes::new(py, csv.as_bytes()), found.undecided()))
}

/// Curves and points of several studies side by side, over the motion of the first study, as files by name.
#[pyfunction]
pub(crate) fn compare<'py>(
    py: Python<'py>,
    studies: Vec<(String, Py<Study>)>,
) -> PyResult<Bound<'py, PyDict>> {
    let answer = on_threads(py, Some(1), |_| -> Result<Answer, String> {
        let (mut designs, mut motion) = (Vec::new(), None);
        for (label, study) in &studies {
            let own = study.get().study.clone();
            let compared = compared::of_study(own, label.clone(), &mut motion);
            designs.push(compared.map_err(|why| format!("{label}: {why}"))?);
        }
        let comparison = Comparison::of(&designs)?;
        let labels: Vec<String> = studies.iter().map(|(label, _)| label.clone()).collect();
        let page = comparison_page(&comparison, &labels);
        let files = vec![
            ("comparison.csv", comparison.csv()),
            ("moved.csv", comparison.moved_table().csv(None).into_bytes()),
            ("report.html", page.into_bytes()),
        ];
        Ok(Answer::of(files, &comparison.labels))
    })?;
    answer.map_err(failure)?.into_dict(py)
}

/// Makes the page of a finished run and writes it into the run's directory. Returns the pictures of its curves by name, if they
/// are requested.
#[pyfunction]
#[pyo3(signature = (directory, pictures=false, force=false))]
pub(crate) fn report<'py>(
    py: Python<'py>,
    directory: PathBuf,
    pictures: bool,
    force: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let made = on_threads(py, Some(1), |_| -> Result<Vec<Picture>, String> {
        let run = FinishedRun::read(&directory).map_err(|e| e.to_string())?;
        let claimed = RunDirectory::reopen(&directory, &["report.html"], force);
        let claimed = claimed.map_err(|e| e.to_string())?;
        let (html, drawn) = match &run {
            FinishedRun::Curves(run) if pictures => (page(run), drawn_pictures(run)),
            FinishedRun::Curves(run) => (page(run), Vec::new()),
            FinishedRun::Sweep(_) if pictures => {
                return Err(
                    "a sweep has no pictures; its page has plots that can be saved".to_owned(),
                );
            }
            FinishedRun::Sweep(sweep) => (sweep_page(sweep), Vec::new()),
            FinishedRun::Car(_) if pictures => {
                return Err("a run of a car has no pictures; its page has charts".to_owned());
            }
            FinishedRun::Car(car) => (car_page(car), Vec::new()),
        };
        let written = claimed.write("report.html", html.as_bytes());
        written.map_err(|e| e.to_string())?;
        Ok(drawn)
    })?;
    by_name(py, &made.map_err(failure)?)
}
