//! `hardpoint compare`

use super::TableFormat;
use super::exit::{Exit, Stop};
use super::output::kept_study;
use super::terminal::{eprint, is_quiet, note, print, width};
use crate::axle::{Axle, AxleMotion};
use crate::model::{Axis, LengthUnit, Suspension};
use crate::report::{
    Compared, ComparedPoints, Comparison, CurveTable, Format, NamedPoints, Tables, comparison_page,
    printable,
};
use crate::results::{Claim, RunDirectory};
use crate::solved::Solved;
use crate::study::{Drive, LONGEST_TABLE, Motion, Study, read_bytes};
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};

/// What is compared, and where it goes.
#[derive(Args)]
pub(super) struct CompareArguments {
    /// Studies and directories of runs, in any mixture; the first is what the others are compared with
    #[arg(required = true, num_args = 2.., value_name = "STUDY_OR_RUN")]
    sources: Vec<PathBuf>,
    /// Directory for comparison.csv and report.html, or - for the CSV on standard output
    #[arg(long, value_name = "DIR", default_value = "out/compare")]
    out: PathBuf,
    /// Replace what other commands have written there
    #[arg(long)]
    force: bool,
    /// How tables are printed
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    format: TableFormat,
}

pub(super) fn run(arguments: &CompareArguments) -> Result<Exit, Stop> {
    let labels = labels(&arguments.sources);
    let mut designs: Vec<Compared> = Vec::new();
    // Studies are solved over the motion of the first one.
    let mut motion = None;
    let mut is_complete = true;
    for (path, label) in arguments.sources.iter().zip(labels) {
        let (compared, complete) = match path.is_dir() {
            true => (of_run(path, label)?, true),
            false => of_study(path, label, &mut motion)?,
        };
        is_complete &= complete;
        designs.push(compared);
    }
    let comparison = Comparison::of(&designs).map_err(Stop::wrong_input)?;
    let mut topologies: Vec<String> = designs.iter().filter_map(|d| d.topology.clone()).collect();
    topologies.dedup();
    if arguments.out == Path::new("-") {
        std::io::stdout().write_all(&comparison.csv())?;
    } else {
        let claim = Claim {
            command: "compare",
            files: &["comparison.csv", "report.html"],
            inputs: &arguments.sources,
            force: arguments.force,
            ..Claim::default()
        };
        let directory = RunDirectory::claim(&arguments.out, &claim).map_err(Stop::wrong_input)?;
        let files = arguments.sources.iter().map(|p| p.display().to_string());
        let page = comparison_page(&comparison, &topologies, &files.collect::<Vec<_>>());
        let csv = comparison.csv();
        let written = directory.write("comparison.csv", &csv);
        let written = written.and_then(|()| directory.write("report.html", page.as_bytes()));
        let written = written.and_then(|()| directory.finish());
        written.map_err(Stop::unwritten)?;
    }
    let format: Format = arguments.format.into();
    let mut tables = Tables::default();
    tables.push("figures", comparison.table());
    let moved = comparison.moved_table();
    if format != Format::Text || !moved.is_empty() {
        tables.push("moved", moved);
    }
    let text = tables.render(format, width());
    match (format, arguments.out == Path::new("-")) {
        (Format::Text, true) => note(&text),
        (Format::Text, false) if is_quiet() => (),
        (Format::Text, false) => print(&text)?,
        (_, true) => eprint(&text),
        (_, false) => std::io::stdout().write_all(text.as_bytes())?,
    }
    if arguments.out != Path::new("-") {
        note(&format!(
            "\n{}: comparison.csv, report.html\n",
            arguments.out.display()
        ));
    }
    for (column, labels) in &comparison.partial {
        note(&format!("{column}: of {} alone\n", labels.join(", ")));
    }
    Ok(Exit::of(is_complete))
}

/// Names of files without what they share, each different.
fn labels(sources: &[PathBuf]) -> Vec<String> {
    let mut labels: Vec<String> = Vec::new();
    for path in sources {
        let name = match path.is_dir() {
            true => path.file_name(),
            false => path.file_stem(),
        };
        let whole = path.display().to_string();
        let name = name.map_or(whole.clone(), |n| n.to_string_lossy().into_owned());
        // They become names of columns.
        let mut label = printable(&name).replace(['\n', '\t'], " ");
        if labels.contains(&label) {
            label = printable(&whole);
        }
        if labels.contains(&label) {
            label += &format!(" ({})", labels.len() + 1);
        }
        labels.push(label);
    }
    labels
}

/// The motion of the first study, over which the others are solved.
enum FirstMotion {
    Wheel { motion: Motion, unit: LengthUnit },
    Axle { motion: AxleMotion, axle: Axle },
}

impl FirstMotion {
    /// The motion of a study; `None` if other studies keep their own.
    fn of(study: &Study) -> Option<FirstMotion> {
        if let Some(both) = &study.axle {
            let (motion, axle) = (both.plan.course.clone(), both.axle.clone());
            return Some(FirstMotion::Axle { motion, axle });
        }
        let (motion, unit) = (study.motion.clone(), study.suspension.length_unit);
        is_over_travel(&motion).then_some(FirstMotion::Wheel { motion, unit })
    }

    /// Replaces the motion of a further study of the same kind. A mixture of wheels and axles is refused later, with
    /// that of runs.
    fn replace_in(&self, study: &mut Study) -> Result<(), String> {
        let to = study.suspension.length_unit;
        match (self, &mut study.axle) {
            (FirstMotion::Axle { motion, axle }, Some(both)) => {
                let [own, other] = [axle, &both.axle].map(|axle| axle.left.frame.sign(Axis::Y));
                if motion.shows_rack && own != other {
                    let why = "rack: the first study's y axis points the other way; give both studies the same frame";
                    return Err(why.to_owned());
                }
                both.plan.course = motion.for_axle(axle, &both.axle)?;
            }
            (FirstMotion::Wheel { motion, unit }, None) if is_over_travel(&study.motion) => {
                let ratio = to.per_metre() / unit.per_metre();
                let scaled = |lengths: &[f64]| lengths.iter().map(|l| l * ratio).collect();
                study.motion.values = scaled(&motion.values);
                study.motion.rack = scaled(&motion.rack);
                study.motion.rack_moves = motion.rack_moves;
            }
            _ => (),
        }
        Ok(())
    }
}

fn is_over_travel(motion: &Motion) -> bool {
    motion.drive == Drive::Travel && motion.time.is_none()
}

fn of_study(
    path: &Path,
    label: String,
    first: &mut Option<FirstMotion>,
) -> Result<(Compared, bool), Stop> {
    let mut study = Study::read(path, &[])?;
    match first {
        None => *first = FirstMotion::of(&study),
        Some(first) => {
            let replaced = first.replace_in(&mut study);
            replaced.map_err(|why| Stop::in_file(path, why))?;
        }
    }
    let solved = Solved::of(&study).map_err(|why| Stop::in_file(path, why))?;
    let table = CurveTable::read(&solved.csv()).expect("curves are written as they are read");
    let compared = compared(label, &study, table);
    Ok((compared, solved.is_complete()))
}

fn compared(label: String, study: &Study, curves: CurveTable) -> Compared {
    let suspension = &study.suspension;
    let named = |wheel: &Suspension| {
        let points = wheel.mechanism.points.iter().zip(&wheel.design);
        let points = points.map(|(point, at)| (point.name.clone(), at.to_array()));
        NamedPoints {
            points: points.collect(),
            signs: Axis::ALL.map(|axis| wheel.frame.sign(axis)),
        }
    };
    let axle = study.axle.as_ref().map(|both| &both.axle);
    let right = axle.and_then(|axle| axle.right.as_ref());
    let points = match right {
        Some(right) => ComparedPoints::BothWheels([named(suspension), named(right)]),
        None => ComparedPoints::OneWheel(named(suspension)),
    };
    Compared {
        label,
        topology: Some(suspension.mechanism.topology.name.to_owned()),
        curves,
        unit: suspension.length_unit,
        points: Some(points),
    }
}

/// A finished run: the curves it wrote, and the points of the study it keeps.
fn of_run(path: &Path, label: String) -> Result<Compared, Stop> {
    let file = path.join("curves.csv");
    if !file.exists() {
        let reason =
            "there is no curves.csv, which `hardpoint solve` and `hardpoint optimise` write";
        return Err(Stop::in_file(path, reason));
    }
    let csv = read_bytes(&file, LONGEST_TABLE);
    let csv = csv.map_err(|reason| Stop::in_file(&file, reason))?;
    let refused = |reason: String| Stop::in_file(path, format!("curves.csv: {reason}"));
    let table = CurveTable::read(&csv).map_err(refused)?;
    if let Some(study) = kept_study(path, &[])? {
        return Ok(compared(label, &study, table));
    }
    let first = table.header.first().map_or("", String::as_str);
    let unit = first.rsplit('_').next().and_then(crate::exchange::unit_of);
    let unit = unit.ok_or_else(|| {
        refused(format!(
            "the first column is {first}, which has no unit of length"
        ))
    })?;
    Ok(Compared {
        label,
        topology: None,
        curves: table,
        unit,
        points: None,
    })
}
