//! Source of `hardpoint export`: a study, or the directory of a run.

use super::exit::Stop;
use super::export::{ExportArguments, Step, Target};
use super::output::{STUDY_COPY, is_set_up, kept_study};
use super::sweep::check_number;
use super::terminal::{note, width};
use crate::checked::{Checked, motion_alone};
use crate::exchange::{
    Grid, Outgoing, Page, Rounded, Value, curves_in, moved_coordinates, page_of_csv, point_rows,
    ranges_of_coordinates, rounded, tuned_coordinates,
};
use crate::model::{FrameConvention, LengthUnit};
use crate::number::Vector3;
use crate::report::{Cell, Table, brief, counted, motion_names, split_unit};
use crate::results::Manifest;
use crate::solved::Solved;
use crate::study::{LONGEST_TABLE, Study, read_bytes};
use crate::sweep::SweepPlan;
use std::path::{Path, PathBuf};

/// Name of the file with the tuned study in the directory of a tuning.
const TUNED: &str = "optimised.toml";

/// Source of an export.
pub(super) struct Source {
    path: PathBuf,
    /// True for a study in memory. Then `path` is only its name in messages, even if a file or a directory has this name.
    is_in_memory: bool,
    /// Files that the export has read. The exported file must not replace one of them.
    pub(super) inputs: Vec<PathBuf>,
    /// Study at the exported design. `None` for a run that keeps no study.
    study: Option<Study>,
    /// Rounded design, if rounding was requested.
    rounded: Option<Rounded>,
    /// Names and contents of the CSV tables in the directory of a run. Empty for a study.
    tables: Vec<(String, Vec<u8>)>,
    unit: Option<LengthUnit>,
    frame: Option<FrameConvention>,
}

impl Source {
    pub(super) fn read(arguments: &ExportArguments) -> Result<Self, Stop> {
        let path = &arguments.source;
        let mut source = Source::of(arguments, None);
        source.inputs.push(path.clone());
        if path.is_dir() {
            source.read_run(arguments)?;
        } else {
            source.study = Some(Study::read_elastic(path, &arguments.set)?);
        }
        source.prepared(arguments)
    }

    /// Makes the source of a study in memory.
    pub(super) fn of_study(arguments: &ExportArguments, study: Study) -> Result<Self, Stop> {
        Source::of(arguments, Some(study)).prepared(arguments)
    }

    fn of(arguments: &ExportArguments, study: Option<Study>) -> Self {
        Source {
            path: arguments.source.clone(),
            is_in_memory: study.is_some(),
            inputs: Vec::new(),
            study,
            rounded: None,
            tables: Vec::new(),
            unit: arguments.unit,
            frame: arguments.frame,
        }
    }

    /// Checks the study and changes it to the design that is to be exported.
    fn prepared(self, arguments: &ExportArguments) -> Result<Self, Stop> {
        let mut source = self;
        let path = &arguments.source;
        let Some(study) = &source.study else {
            let needs_points = arguments.round.is_some() || arguments.design.is_some();
            if needs_points || arguments.unit.is_some() || arguments.frame.is_some() {
                source.study()?;
            }
            return Ok(source);
        };
        let mechanism = &study.wheel().mechanism;
        let only = |targets: &[Target], message: &'static str| {
            (!targets.contains(&arguments.to)).then_some(message)
        };
        let points = [
            Target::Csv,
            Target::Xlsx,
            Target::Dxf,
            Target::Stl,
            Target::Toml,
        ];
        let refused = if mechanism.rigid_axle.is_none() {
            None
        } else if mechanism.topology.is_twist_beam() {
            only(
                &points,
                "a twist beam can only be exported to CSV, to a workbook, to DXF, to STL and to a study",
            )
        } else if mechanism.axle_steering().is_some() {
            only(
                &points,
                "a solid axle with a drag link can only be exported to CSV, to a workbook, to DXF, to STL and to a \
                 study",
            )
        } else {
            only(
                &[&points[..], &[Target::Assetto]].concat(),
                "a solid axle can only be exported to CSV, to a workbook, to DXF, to STL, to Assetto Corsa and to a \
                 study",
            )
        };
        if let Some(message) = refused {
            return Err(Stop::in_file(path, message));
        }
        let keeps_parts = [Target::Csv, Target::Bus, Target::Toml].contains(&arguments.to);
        if study.is_elastic() && !keeps_parts {
            note(
                "Elastic parts are not exported: the file has the hardpoints of the relaxed position.\n",
            );
        }
        // A study that `check` refuses is not exported.
        Checked::of(&motion_alone(study)).map_err(|why| Stop::in_file(path, why))?;
        source.inputs.extend(study.inputs.iter().cloned());
        let before = source.design_of_file(arguments)?;
        if let Some(number) = arguments.design {
            source.study = Some(of_sweep(study, number, path)?);
        }
        if let Some(step) = arguments.round {
            source.round(step, arguments.round_all, &before)?;
        }
        source.set_other_curves_aside(arguments.to == Target::Xlsx);
        Ok(source)
    }

    /// Reads the study and the tables of a run's directory.
    fn read_run(&mut self, arguments: &ExportArguments) -> Result<(), Stop> {
        for name in ["curves", "curves_before", "designs", "pareto", "history"] {
            let file = self.path.join(name).with_extension("csv");
            if !file.exists() {
                continue;
            }
            let bytes = read_bytes(&file, LONGEST_TABLE);
            let bytes = bytes.map_err(|reason| Stop::in_file(&file, reason))?;
            self.tables.push((name.to_owned(), bytes));
            self.inputs.push(file);
        }
        self.inputs
            .extend([TUNED, STUDY_COPY].map(|name| self.path.join(name)));
        if is_set_up(&self.path) {
            return Err(Stop::in_file(
                &self.path,
                "this is a run of `hardpoint setup`: its study.toml has the points before the adjustments, so the adjusted \
                 points cannot be exported; export the study itself, or use the tables of the run as they are",
            ));
        }
        self.study = kept_study(&self.path, &arguments.set)?;
        if self.tables.is_empty() && self.study.is_none() {
            return Err(Stop::in_file(
                &self.path,
                "it is not the directory of a run: there is no curves.csv, designs.csv or optimised.toml",
            ));
        }
        Ok(())
    }

    /// Design in the study's own file, before `--set` and `--design`. For a tuning, the design before the tuning.
    fn design_of_file(&self, arguments: &ExportArguments) -> Result<Vec<Vector3<f64>>, Stop> {
        let study = self.study()?;
        let file = match self.is_tuning() {
            true => self.path.join(STUDY_COPY),
            false if self.is_in_memory || arguments.set.is_empty() => {
                return Ok(study.wheel().design.clone());
            }
            false if self.path.is_dir() => self.path.join(STUDY_COPY),
            false => self.path.clone(),
        };
        if file.is_file() {
            Ok(Study::read_elastic(&file, &[])?.wheel().design.clone())
        } else {
            // Runs of earlier versions contain no copy of the study, and standard input is not a file. In these cases, the
            // function returns the design of the study that was read.
            Ok(study.wheel().design.clone())
        }
    }

    /// True if the source is the directory of a tuning.
    fn is_tuning(&self) -> bool {
        !self.is_in_memory && self.path.is_dir() && self.path.join(TUNED).is_file()
    }

    /// Rounds the coordinates that were moved or tuned to multiples of `step`, or with `all` every coordinate. Prints the effect
    /// on the misfit of the targets. `before` is the design without the moves.
    fn round(
        &mut self,
        (step, unit): Step,
        all: bool,
        before: &[Vector3<f64>],
    ) -> Result<(), Stop> {
        let study = self.study()?;
        let own_right = study.axle().is_some_and(|a| a.axle.right.is_some());
        if own_right {
            return Err(Stop::in_file(
                &self.path,
                "axle.right: --round needs a right wheel that is the mirror image of the left \
                 one, but the right wheel has different points",
            ));
        }
        let design = &study.wheel().design;
        let mut free = if before.len() == design.len() {
            moved_coordinates(design, before)
        } else {
            vec![true; 3 * design.len()]
        };
        // In the directory of a tuning, the tuned coordinates differ between `design` and `before`. In any other source, the
        // variables of the study name the tuned coordinates.
        if !self.is_tuning() {
            let tuned = tuned_coordinates(study);
            free.iter_mut()
                .zip(tuned)
                .for_each(|(f, tuned)| *f |= tuned);
        }
        if all {
            free.fill(true);
        }
        if !free.contains(&true) {
            note(
                "no coordinate was moved or tuned, so none is rounded; --round-all rounds every coordinate\n",
            );
        }
        let of_file = self.unit.unwrap_or(study.wheel().length_unit);
        let unit = unit.unwrap_or(of_file);
        let grid = Grid { step, unit };
        let refused = |reason: String| Stop::in_file(&self.path, reason);
        let origin = if before.len() == design.len() {
            before
        } else {
            design
        };
        let ranges = ranges_of_coordinates(study, origin);
        let rounded = rounded(study, grid, &free, &ranges).map_err(refused)?;
        let after = study.at_design(rounded.design.clone());
        say_loss(study, &after, &rounded, &free);
        self.study = Some(after);
        self.rounded = Some(rounded);
        Ok(())
    }

    /// Renames the table `curves` of a run if its curves do not belong to the exported study, for example because `--set` has
    /// changed its points, its motion or its wheel. If the exported file has sheets, a note states the new name.
    fn set_other_curves_aside(&mut self, has_sheets: bool) {
        let Some(study) = &self.study else { return };
        let manifest = Manifest::read(&self.path).unwrap_or_default();
        let author = manifest
            .author("curves.csv")
            .map(|run| run.command.as_str());
        // Curves of a tuning belong to the tuned study.
        let is_of_kept = if self.is_tuning() {
            author == Some("optimise")
        } else {
            matches!(author, Some("solve" | "tolerance"))
        };
        let kept = || kept_study(&self.path, &[]).ok().flatten();
        let is_own = is_of_kept && kept().is_some_and(|kept| kept.vehicle == study.vehicle);
        let name = match author {
            _ if is_own => return,
            Some(command) => format!("curves_of_{command}"),
            None => "curves_of_run".to_owned(),
        };
        for (table, _) in &mut self.tables {
            if table == "curves" {
                if has_sheets {
                    note(&format!(
                        "The sheet curves is solved for the exported points. The sheet {name} has the curves of the run.\n"
                    ));
                }
                table.clone_from(&name);
            }
        }
    }

    /// True if the exported design keeps all constraints, or was not rounded.
    pub(super) fn keeps_constraints(&self) -> bool {
        let mut rounded = self.rounded.iter();
        rounded.all(|rounded| rounded.broken.is_empty())
    }

    pub(super) fn study(&self) -> Result<&Study, Stop> {
        self.study.as_ref().ok_or_else(|| {
            Stop::in_file(
                &self.path,
                "this run has no study.toml, so there are no points to export; export its study instead",
            )
        })
    }

    /// Text of the study at the exported design, for the file `out`. Targets, constraints and comments stay.
    pub(super) fn study_text(&self, out: Option<&Path>) -> Result<String, Stop> {
        let study = self.study()?;
        let directory = out.and_then(Path::parent).unwrap_or(Path::new(""));
        let text = study.text_in(directory);
        let own = Study::elastic_from_text(&study.name, &text, directory)?;
        Ok(own.with_points_of(study))
    }

    /// Exported study, in the unit and the axes of the exported file.
    pub(super) fn outgoing(&self) -> Result<Outgoing<'_>, Stop> {
        let study = self.study()?;
        Ok(match &self.rounded {
            Some(rounded) => Outgoing::rounded(study, rounded, self.unit, self.frame),
            None => Outgoing::of(study, self.unit, self.frame),
        })
    }

    /// Curves of the exported points, in the study's unit and axes. They come from the run, or are solved again.
    pub(super) fn curves(&self) -> Result<Page, Stop> {
        let refused = |reason: String| Stop::in_file(&self.path, reason);
        let of_run = self.tables.iter().find(|(name, _)| name == "curves");
        if let Some((_, csv)) = of_run {
            return page_of_csv("curves", csv).map_err(refused);
        }
        let solved = Solved::of(self.study()?).map_err(refused)?;
        page_of_csv("curves", &solved.csv()).map_err(refused)
    }

    /// Sheets of a workbook: hardpoints, curves, and the other tables of a run.
    pub(super) fn pages(&self) -> Result<Vec<Page>, Stop> {
        let mut pages = Vec::new();
        let outgoing = match self.study {
            Some(_) => Some(self.outgoing()?),
            None => None,
        };
        match &outgoing {
            Some(outgoing) => {
                pages.push(Page {
                    name: "hardpoints".to_owned(),
                    rows: point_rows(outgoing),
                });
                pages.push(curves_in(outgoing, self.curves()?));
            }
            None => note(&format!(
                "{}: this run has no study.toml, so the workbook has its tables and no hardpoints\n",
                self.path.display()
            )),
        }
        let mut as_they_are = Vec::new();
        for (name, csv) in &self.tables {
            let refused = |reason| Stop::in_file(&self.path, format!("{name}.csv: {reason}"));
            let page = page_of_csv(name, csv).map_err(refused)?;
            match &outgoing {
                Some(_) if name == "curves" => {}
                Some(outgoing) if name.starts_with("curves") => {
                    pages.push(curves_in(outgoing, page));
                }
                _ => {
                    as_they_are.push(name.as_str());
                    pages.push(page);
                }
            }
        }
        if let (Some(outgoing), false) = (outgoing, as_they_are.is_empty()) {
            let suspension = outgoing.study.wheel();
            let (own, axes) = (suspension.length_unit, suspension.frame.meaning().0);
            if (own, axes) != (outgoing.unit, outgoing.convention) {
                note(&format!(
                    "{}: not converted, in the unit and axes of the run ({} and {})\n",
                    as_they_are.join(", "),
                    own.symbol(),
                    axes.name()
                ));
            }
        }
        Ok(pages)
    }
}

/// Study with the hardpoints of the design with this number in its sweep. Errors name the file `path`.
fn of_sweep(study: &Study, number: u64, path: &Path) -> Result<Study, Stop> {
    let refused = |reason: &str| Stop::in_file(path, reason);
    let sweep = study.sweep.as_ref();
    let sweep = sweep.ok_or_else(|| refused("--design needs [sweep], but the study has none"))?;
    let plan = SweepPlan::of(study, sweep)
        .map_err(|_| refused("the sweep cannot start; `hardpoint sweep` prints the reason"))?;
    check_number(number, &plan.record).map_err(|reason| refused(&reason))?;
    Ok(plan.moved(number))
}

/// Prints the effect of rounding: the misfit of the targets, and the largest change of each curve.
fn say_loss(before: &Study, after: &Study, rounded: &Rounded, free: &[bool]) {
    let grid = rounded.grid;
    let (step, unit) = (grid.step, grid.unit.symbol());
    let coordinates = free.iter().filter(|free| **free).count();
    let rounded_to = format!(
        "{coordinates} of {} coordinates rounded to {step} {unit}",
        free.len()
    );
    match &rounded.loss {
        None => note(&format!(
            "{rounded_to}; the study has no targets, so the change of the misfit is not known\n"
        )),
        Some(loss) => {
            let ordinary = loss.ordinary.map_or("no curves".to_owned(), |misfit| {
                format!("misfit {misfit:.4}")
            });
            let otherwise = match loss.otherwise {
                0 => "each coordinate rounded to its nearest multiple".to_owned(),
                count => format!(
                    "the nearest multiples would give {ordinary}, so the multiple on the other side is used for {}",
                    counted(count, "coordinate")
                ),
            };
            note(&format!(
                "{rounded_to}: misfit {:.4} -> {:.4} tolerances; {otherwise}\n",
                loss.exact, loss.best
            ));
        }
    }
    for broken in &rounded.broken {
        let was = match broken.missed_before {
            0.0 => "satisfied before rounding".to_owned(),
            f64::INFINITY => "no value before rounding".to_owned(),
            missed => format!("{} before rounding", brief(missed)),
        };
        let missed = match broken.missed {
            f64::INFINITY => "which has no value".to_owned(),
            missed => format!("missed by {} {}", brief(missed), broken.unit),
        };
        note(&format!(
            "limit violated after rounding: {}, {missed} ({was})\n",
            broken.name
        ));
    }
    let curves = [before, after].map(|study| {
        let solved = Solved::of(study).ok()?;
        let page = page_of_csv("curves", &solved.csv()).ok()?;
        Some((motion_names(solved.curves()).len(), page))
    });
    if let [Some((motion, before)), Some((_, after))] = curves {
        note(&changes(motion, &before, &after).text(width()));
    }
}

/// Table of the largest absolute change of each output between two tables of curves. The first `motion` columns describe the
/// motion and are left out.
fn changes(motion: usize, before: &Page, after: &Page) -> Table {
    let mut table = Table::new(["output", "largest change"]);
    let header = before.rows.first().map_or(&[][..], Vec::as_slice);
    for (column, name) in header.iter().enumerate().skip(motion) {
        let Value::Text(name) = name else { continue };
        let number = |row: &Vec<Value>| match row.get(column) {
            Some(Value::Number(number)) => Some(*number),
            _ => None,
        };
        let pairs = before.rows.iter().zip(&after.rows);
        let changes: Vec<f64> = pairs
            .filter_map(|(a, b)| Some((number(b)? - number(a)?).abs()))
            .collect();
        if let Some(largest) = changes.into_iter().reduce(f64::max) {
            let figure = Cell::figure(largest, split_unit(name).1);
            table.push([Cell::from(name.as_str()), figure]);
        }
    }
    table
}
