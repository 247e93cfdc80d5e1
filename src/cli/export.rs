//! `hardpoint export`

use super::check::Checked;
use super::exit::{Exit, Stop};
use super::limits::motion_alone;
use super::output::kept_study;
use super::terminal::{note, width};
use crate::exchange::{
    Page, Rounded, csv, into_subsystem, page_of_csv, point_rows, rounded, subsystem, workbook,
};
use crate::number::Vector3;
use crate::report::{Cell, Table};
use crate::results;
use crate::solved::Solved;
use crate::study::{LONGEST_TABLE, LONGEST_TEXT, Study, read_bytes};
use crate::sweep::SweepPlan;
use clap::{Args, ValueEnum};
use std::io::Write;
use std::path::{Path, PathBuf};

/// What is exported, and how.
#[derive(Args)]
pub(super) struct ExportArguments {
    /// A study file, or the directory of a run
    source: PathBuf,
    /// What is written
    #[arg(long, value_enum)]
    to: Target,
    /// Round the points to multiples of this length with the least loss against the targets
    #[arg(long, value_name = "LENGTH", value_parser = grid)]
    round: Option<f64>,
    /// With --to adams: a subsystem whose hardpoints are replaced in a copy
    #[arg(long, value_name = "FILE.sub")]
    into: Option<PathBuf>,
    /// The points of one design of the study's sweep, by its number
    #[arg(long, value_name = "NUMBER")]
    design: Option<u64>,
    /// Override a field of the study, as in --set motion.rack=5.0; may be given more than once
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
    /// Where it goes [default: standard output; a workbook needs a file]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Replace a file that is there
    #[arg(long)]
    force: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Target {
    /// The points as a table
    Csv,
    /// The points and the curves as a workbook
    Xlsx,
    /// The points as hardpoints of an Adams/Car subsystem
    Adams,
}

fn grid(text: &str) -> Result<f64, String> {
    let length = text.parse::<f64>().ok();
    let length = length.filter(|length| (1e-9..=1e6).contains(length));
    length.ok_or_else(|| "expected a length above 0, as in --round 0.1".to_owned())
}

pub(super) fn run(arguments: &ExportArguments) -> Result<Exit, Stop> {
    if arguments.into.is_some() && arguments.to != Target::Adams {
        return Err(Stop::wrong_input("--into needs --to adams"));
    }
    if arguments.to == Target::Xlsx && arguments.out.is_none() {
        return Err(Stop::wrong_input(
            "a workbook is no text for a terminal: say with --out where it goes",
        ));
    }
    if arguments.into.is_some() && arguments.into == arguments.out {
        return Err(Stop::wrong_input(
            "--into is copied, not changed: give another file with --out",
        ));
    }
    let source = Source::read(arguments)?;
    source.say_what_is_left_out(arguments.to)?;
    let bytes = match arguments.to {
        Target::Csv => csv(&point_rows(source.study()?, &source.design)),
        Target::Xlsx => workbook(&source.pages()?),
        Target::Adams => {
            let study = source.study()?;
            let written = match &arguments.into {
                None => subsystem(study, &source.design),
                Some(path) => {
                    let refused = |reason: String| Stop::in_file(path, reason);
                    let file = read_bytes(path, LONGEST_TEXT).map_err(refused)?;
                    into_subsystem(study, &source.design, &file).map_err(refused)?
                }
            };
            for line in written.notes {
                note(&format!("{line}\n"));
            }
            written.bytes
        }
    };
    match &arguments.out {
        None => std::io::stdout().write_all(&bytes)?,
        Some(out) => save(out, &bytes, arguments.force)?,
    }
    Ok(Exit::Done)
}

/// Writes a file, whole or not at all; over one that is there only by force.
pub(super) fn save(out: &Path, bytes: &[u8], force: bool) -> Result<(), Stop> {
    if out.exists() && !force {
        return Err(Stop::wrong_input(format!(
            "{} is there already; --force replaces it",
            out.display()
        )));
    }
    let directory = out.parent().filter(|parent| !parent.as_os_str().is_empty());
    let written = || {
        let mut file = results::temporary(directory.unwrap_or(Path::new(".")))?;
        file.write_all(bytes)?;
        file.persist(out).map_err(|error| error.error)
    };
    results::undivided(written)
        .map(drop)
        .map_err(|error| Stop::wrong_input(format!("cannot write {}: {error}", out.display())))
}

/// What is exported.
struct Source {
    path: PathBuf,
    /// The study; `None` of a run that keeps none.
    study: Option<Study>,
    /// Its points.
    design: Vec<Vector3<f64>>,
    /// The tables of a run's directory: their names and contents.
    tables: Vec<(&'static str, Vec<u8>)>,
}

impl Source {
    fn read(arguments: &ExportArguments) -> Result<Self, Stop> {
        let path = &arguments.source;
        let mut source = Source {
            path: path.clone(),
            study: None,
            design: Vec::new(),
            tables: Vec::new(),
        };
        if path.is_dir() {
            for name in ["curves", "curves_before", "designs", "pareto", "history"] {
                let table = path.join(name).with_extension("csv");
                if !table.exists() {
                    continue;
                }
                let bytes = read_bytes(&table, LONGEST_TABLE);
                let bytes = bytes.map_err(|reason| Stop::in_file(&table, reason))?;
                source.tables.push((name, bytes));
            }
            source.study = kept_study(path, &arguments.set)?;
            if source.tables.is_empty() && source.study.is_none() {
                return Err(Stop::in_file(
                    path,
                    "not the directory of a run: there is no curves.csv, designs.csv or optimised.toml",
                ));
            }
        } else {
            source.study = Some(Study::read(path, &arguments.set)?);
        }
        let Some(study) = &source.study else {
            if arguments.round.is_some() || arguments.design.is_some() {
                source.study()?;
            }
            return Ok(source);
        };
        Checked::of(&motion_alone(study), path)?;
        source.design = match arguments.design {
            None => study.suspension.design.clone(),
            Some(number) => of_sweep(study, number, path)?,
        };
        if let Some(grid) = arguments.round {
            let rounded = rounded(study, &source.design, grid);
            let rounded = rounded.map_err(|reason| Stop::in_file(path, reason))?;
            say_loss(study, &source.design, &rounded, grid);
            source.design = rounded.design;
        }
        Ok(source)
    }

    /// Of an axle the left wheel is written, of which the right one need not be the mirror image. A file in which the
    /// two are one is refused then.
    fn say_what_is_left_out(&self, to: Target) -> Result<(), Stop> {
        let axle = self.study.as_ref().and_then(|study| study.axle.as_ref());
        let Some((left, right)) = axle.and_then(|a| Some((&a.axle.left, a.axle.right.as_ref()?)))
        else {
            return Ok(());
        };
        let points = left
            .mechanism
            .points
            .iter()
            .zip(left.design.iter().zip(&right.design));
        let own = points.filter(|(_, (left, right))| left != right);
        let own: Vec<&str> = own.map(|(point, _)| point.name.as_str()).collect();
        if own.is_empty() {
            return Ok(());
        }
        let words = format!(
            "{}: axle.right: the right wheel's own hardpoints are not exported yet: {}",
            self.path.display(),
            own.join(", ")
        );
        match to {
            Target::Adams => Err(Stop::wrong_input(format!(
                "{words}; the file would have the mirror image of the left ones"
            ))),
            _ => {
                note(&format!("warning: {words}\n"));
                Ok(())
            }
        }
    }

    fn study(&self) -> Result<&Study, Stop> {
        self.study.as_ref().ok_or_else(|| {
            Stop::in_file(
                &self.path,
                "this run keeps no study, so there are no points to export; export the study it was of",
            )
        })
    }

    fn pages(&self) -> Result<Vec<Page>, Stop> {
        if self.study.is_none() {
            note(&format!(
                "{}: this run keeps no study: the workbook has its tables alone, and no hardpoints\n",
                self.path.display()
            ));
        }
        let refused = |reason: String| Stop::in_file(&self.path, reason);
        let mut pages = Vec::new();
        if let Some(study) = &self.study {
            pages.push(Page {
                name: "hardpoints".to_owned(),
                rows: point_rows(study, &self.design),
            });
            if self.tables.is_empty() {
                let study = study.at_design(self.design.clone());
                let csv = Solved::of(&study).map_err(refused)?.csv();
                pages.push(page_of_csv("curves", &csv).map_err(refused)?);
            }
        }
        for (name, csv) in &self.tables {
            let page = page_of_csv(name, csv);
            pages.push(page.map_err(|reason| refused(format!("{name}.csv: {reason}")))?);
        }
        Ok(pages)
    }
}

/// A design of a study's sweep.
fn of_sweep(study: &Study, number: u64, path: &Path) -> Result<Vec<Vector3<f64>>, Stop> {
    let refused = |reason: &str| Stop::in_file(path, reason);
    let sweep = study.sweep.as_ref();
    let sweep = sweep.ok_or_else(|| refused("--design is of a sweep, and there is no [sweep]"))?;
    let plan = SweepPlan::of(study, sweep)
        .map_err(|_| refused("the sweep cannot begin; `hardpoint sweep` says why"))?;
    if number >= plan.record.designs {
        return Err(refused(&format!(
            "there is no design {number}; the sweep has {}, numbered from 0",
            plan.record.designs
        )));
    }
    Ok(plan.design(number))
}

/// What rounding costs: the misfit of the targets, and the largest change of every curve.
fn say_loss(study: &Study, before: &[Vector3<f64>], rounded: &Rounded, grid: f64) {
    let unit = study.suspension.length_unit.symbol();
    match &rounded.loss {
        None => note(&format!(
            "rounded to {grid} {unit}; the study has no targets that would say what that costs\n"
        )),
        Some(loss) => {
            let ordinary = loss
                .ordinary
                .map_or("no curve".to_owned(), |misfit| format!("{misfit:.4}"));
            note(&format!(
                "rounded to {grid} {unit}: misfit {:.4} -> {:.4} tolerances ({ordinary} if each coordinate were \
                 rounded by itself; {} are rounded the other way)\n",
                loss.exact, loss.best, loss.otherwise
            ));
        }
    }
    let designs = [before, &rounded.design].map(|d| study.at_design(d.to_vec()));
    let [Ok(before), Ok(after)] = designs.each_ref().map(Solved::of) else {
        return;
    };
    let (Some(before), Some(after)) = (before.wheel(), after.wheel()) else {
        return;
    };
    let mut table = Table::new(["output", "largest change"]);
    for (number, column) in before.columns.iter().enumerate() {
        let pairs = before.stations.iter().zip(&after.stations);
        let changes =
            pairs.filter_map(|(a, b)| Some((b.values[number]? - a.values[number]?).abs()));
        let largest = changes.fold(0.0, f64::max);
        table.push([
            Cell::from(column.name.as_str()),
            Cell::figure(largest, &column.unit),
        ]);
    }
    note(&table.text(width()));
}
