//! `hardpoint compare`: compares curves, hardpoints and key values of two or more designs.

use super::TableFormat;
use super::exit::{Exit, Stop};
use super::interrupt;
use super::output::{is_set_up, kept_study, say_set_aside};
use super::terminal::{eprint, is_quiet, note, print, width};
use crate::compared::{FirstMotion, compared};
use crate::report::{
    Compared, ComparedKc, Comparison, CurveTable, Format, KcComparison, Tables, comparison_page,
    counted, printable,
};
use crate::results::{Claim, RunDirectory, digest_of_texts};
use crate::set_up::set_up;
use crate::study::{LONGEST_TABLE, Study, read_bytes};
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Name of the file with the results of `hardpoint kc`.
const KC: &str = "kc.csv";

/// Arguments of a comparison.
#[derive(Args)]
pub(super) struct CompareArguments {
    /// Studies and directories of runs, in any mixture; the others are compared with the first
    #[arg(required = true, num_args = 2.., value_name = "STUDY_OR_RUN")]
    pub(super) sources: Vec<PathBuf>,
    /// Directory for comparison.csv and report.html, or - for the CSV on standard output
    /// [default: out/compare]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Overwrite existing files, also files of other runs
    #[arg(long)]
    pub(super) force: bool,
    /// Format of printed tables
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    pub(super) format: TableFormat,
}

impl CompareArguments {
    /// Directory of the results. `None` if the CSV goes to standard output.
    pub(super) fn directory(&self) -> Option<&Path> {
        let out = self.out.as_deref().unwrap_or(Path::new("out/compare"));
        (out != Path::new("-")).then_some(out)
    }
}

pub(super) fn run(arguments: &CompareArguments) -> Result<Exit, Stop> {
    if super::car::are_cars(arguments)? {
        return super::car::compare(arguments);
    }
    if are_kc_runs(&arguments.sources)? {
        return of_kc_runs(arguments);
    }
    let labels = labels(&arguments.sources);
    let mut designs: Vec<Compared> = Vec::new();
    // All studies are solved over the motion of the first study.
    let mut motion = None;
    for (path, label) in arguments.sources.iter().zip(labels) {
        designs.push(if path.is_dir() {
            of_run(path, label, designs.first(), &mut motion)?
        } else {
            of_study(path, label, &mut motion)?
        });
    }
    let comparison = Comparison::of(&designs).map_err(Stop::wrong_input)?;
    let files = arguments.sources.iter().map(|p| p.display().to_string());
    let page = comparison_page(&comparison, &files.collect::<Vec<_>>());
    write(
        arguments,
        &arguments.sources,
        &comparison.csv(),
        Some(&page),
    )?;
    let format: Format = arguments.format.into();
    let mut tables = Tables::default();
    tables.push("figures", comparison.table());
    let moved = comparison.moved_table();
    if format != Format::Text || !moved.is_empty() {
        tables.push("moved", moved);
    }
    print_tables(arguments, &tables)?;
    let unsolved = comparison.unsolved_stations(&designs);
    for stations in comparison.missing_stations().into_iter().chain(unsolved) {
        note(&format!("\n{stations}\n"));
    }
    if let Some(out) = arguments.directory() {
        note(&format!(
            "\n{}: comparison.csv, report.html\n",
            out.display()
        ));
    }
    for (column, labels) in &comparison.partial {
        note(&format!("{column}: only in {}\n", labels.join(", ")));
    }
    for points in comparison.partial_points() {
        note(&format!("{points}\n"));
    }
    Ok(Exit::of(designs.iter().all(|own| own.curves.is_complete())))
}

/// Writes `comparison.csv` and the page `report.html` to the directory. Without a page, removes an old `report.html`. If the
/// output is standard output, writes only the CSV.
pub(super) fn write(
    arguments: &CompareArguments,
    inputs: &[PathBuf],
    csv: &[u8],
    page: Option<&str>,
) -> Result<(), Stop> {
    let Some(path) = arguments.directory() else {
        std::io::stdout().write_all(csv)?;
        return Ok(());
    };
    let claim = Claim {
        command: "compare",
        // A comparison has no study of its own. The digest of its results identifies it.
        digest: digest_of_texts(&[&String::from_utf8_lossy(csv)]),
        files: &["comparison.csv", "report.html"],
        inputs,
        force: arguments.force,
        set_aside: arguments.out.is_none(),
        ..Claim::default()
    };
    let directory = RunDirectory::claim(path, &claim).map_err(Stop::wrong_input)?;
    say_set_aside(path, &directory);
    let written = directory.write("comparison.csv", csv);
    let written = written.and_then(|()| match page {
        Some(page) => directory.write("report.html", page.as_bytes()),
        None => directory.remove("report.html"),
    });
    // A signal that arrives from here on does not interrupt the command.
    interrupt::stops_by_itself();
    let written = written.and_then(|()| directory.finish());
    written.map_err(Stop::unwritten)
}

/// True if all sources are runs of `kc`. Refuses a mixture of such runs and other sources.
fn are_kc_runs(sources: &[PathBuf]) -> Result<bool, Stop> {
    let is_kc = |path: &&PathBuf| path.join(KC).is_file() && !path.join("curves.csv").exists();
    match sources.iter().filter(is_kc).count() {
        0 => Ok(false),
        count if count == sources.len() => Ok(true),
        _ => Err(Stop::wrong_input(
            "a run of `hardpoint kc` can be compared with runs of `hardpoint kc` only",
        )),
    }
}

fn of_kc_runs(arguments: &CompareArguments) -> Result<Exit, Stop> {
    let mut runs = Vec::new();
    for (path, label) in arguments.sources.iter().zip(labels(&arguments.sources)) {
        let file = path.join(KC);
        let csv = read_bytes(&file, LONGEST_TABLE);
        let csv = csv.map_err(|reason| Stop::in_file(&file, reason))?;
        let study = kept_study(path, &[])?;
        let axes = study.map(|study| study.wheel().frame.meaning().0);
        runs.push(ComparedKc { label, csv, axes });
    }
    let comparison = KcComparison::of(&runs).map_err(Stop::wrong_input)?;
    write(arguments, &arguments.sources, &comparison.csv(), None)?;
    let mut tables = Tables::default();
    tables.push("figures", comparison.table());
    print_tables(arguments, &tables)?;
    note(&format!(
        "\nEqual to four digits in all runs: {}\n",
        counted(comparison.equal(), "value")
    ));
    if let Some(out) = arguments.directory() {
        note(&format!("{}: comparison.csv\n", out.display()));
    }
    Ok(Exit::Done)
}

/// Prints the tables of the comparison. The tables go to standard error if the CSV goes to standard output.
pub(super) fn print_tables(arguments: &CompareArguments, tables: &Tables) -> Result<(), Stop> {
    let format: Format = arguments.format.into();
    let text = tables.render(format, width());
    match (format, arguments.directory().is_none()) {
        (Format::Text, true) => note(&text),
        (Format::Text, false) if is_quiet() => (),
        (Format::Text, false) => print(&text)?,
        (_, true) => eprint(&text),
        (_, false) => std::io::stdout().write_all(text.as_bytes())?,
    }
    Ok(())
}

/// Unique labels of the compared sources: name of the directory, or of the file without its extension. If an
/// earlier source has the same name, the label is the whole path. If that is also taken, a number follows the path.
pub(super) fn labels(sources: &[PathBuf]) -> Vec<String> {
    let mut labels: Vec<String> = Vec::new();
    for path in sources {
        let name = if path.is_dir() {
            path.file_name()
        } else {
            path.file_stem()
        };
        let whole = path.display().to_string();
        let name = name.map_or(whole.clone(), |n| n.to_string_lossy().into_owned());
        // Labels become names of columns, so they must be printable.
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

fn of_study(path: &Path, label: String, first: &mut Option<FirstMotion>) -> Result<Compared, Stop> {
    let study = Study::read_elastic(path, &[])?;
    crate::compared::of_study(study, label, first).map_err(|why| Stop::in_file(path, why))
}

/// Returns the curves and points of a finished run for the comparison. If the run lacks stations of the first design, this
/// function solves the kept study again over the motion of the first design, if possible. For a run of `setup`, the study has
/// the adjusted points.
fn of_run(
    path: &Path,
    label: String,
    first: Option<&Compared>,
    motion: &mut Option<FirstMotion>,
) -> Result<Compared, Stop> {
    let study = kept_study(path, &[])?;
    let study = match study {
        Some(study) if is_set_up(path) => Some(adjusted_study(path, &study)?),
        study => study,
    };
    let compared = curves_of_run(path, label.clone(), study.as_ref())?;
    let Some(first) = first else {
        *motion = study.as_ref().map(FirstMotion::of);
        return Ok(compared);
    };
    let Some(study) = study.filter(|_| motion.is_some()) else {
        return Ok(compared);
    };
    if Comparison::has_all_stations(first, &compared) {
        return Ok(compared);
    }
    match crate::compared::of_study(study, label, motion) {
        Ok(solved) => {
            note(&format!(
                "{}: its stations differ from the stations of {}, so its study is solved again over the same motion\n",
                path.display(),
                first.label
            ));
            Ok(solved)
        }
        // A study that cannot follow the motion of the first design keeps the curves of its own run. These curves may have
        // some stations in common with the first design.
        Err(_) => Ok(compared),
    }
}

/// Study with the adjustments of a run of `setup`. The run keeps the study before the adjustments, so this function computes
/// them again.
fn adjusted_study(path: &Path, study: &Study) -> Result<Study, Stop> {
    let Some(setup) = &study.setup else {
        let reason = "study.toml has no section [setup], so the adjusted points of this set-up are not known; run \
                      `hardpoint setup` again";
        return Err(Stop::in_file(path, reason));
    };
    let found = set_up(study, setup).map_err(|refusal| Stop::in_file(path, refusal.reason()))?;
    Ok(found.adjusted)
}

/// Reads the curves that a run wrote, and the points of the study that is kept with the run.
fn curves_of_run(path: &Path, label: String, study: Option<&Study>) -> Result<Compared, Stop> {
    let file = path.join("curves.csv");
    if !file.exists() {
        let reason = "there is no curves.csv; `hardpoint solve` and `hardpoint optimise` write one";
        return Err(Stop::in_file(path, reason));
    }
    let csv = read_bytes(&file, LONGEST_TABLE);
    let csv = csv.map_err(|reason| Stop::in_file(&file, reason))?;
    let refused = |reason: String| Stop::in_file(path, format!("curves.csv: {reason}"));
    let table = CurveTable::read(&csv).map_err(refused)?;
    if let Some(study) = study {
        return Ok(compared(label, study, table));
    }
    let first = table.header.first().map_or("", String::as_str);
    let unit = first.rsplit('_').next().and_then(crate::exchange::unit_of);
    let unit = unit.ok_or_else(|| {
        refused(format!(
            "the name of the first column, {first}, does not end in a unit of length"
        ))
    })?;
    Ok(Compared {
        label,
        topology: None,
        curves: table,
        unit,
        axes: None,
        points: None,
        mechanism: None,
    })
}
