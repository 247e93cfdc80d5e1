//! Targets from measured K&C sheets (CSV files) with the columns of `kc.csv`. Each test result at each station becomes a
//! target.

mod columns;
mod keys;
mod of_axle;

use super::axle_targets::AxleSite;
use super::curve_file::{self, at_record, delimiter};
use super::elastic_targets;
use super::elastic_targets::ElasticQuantity;
use super::error::{Problems, Source, StudyErrors};
use super::file::Target as Written;
use super::names::nearest;
use super::resolve::Context;
use super::source::{LONGEST_TEXT, read_text};
use super::targets::{refuse_measured, tiny, weight};
use super::value::{Number, Text};
use super::{AxleStudy, ComplianceStudy, ElasticFigure, Site, Target, TargetQuantity, Wanted};
use crate::ask::six_digits;
use crate::compliance::{HeldQuantity, KcTest, KcValue, TestLoad, figure_names, figures_by};
use crate::model::Side;
use columns::NEEDED;
use keys::refuse_other_keys;
use of_axle::AxlePlace;
use std::sync::Arc;
use toml::Spanned;

/// Keys of a target in a study: test result, station, value and tolerance, in printed units.
#[derive(Clone, Debug)]
pub(super) struct SheetTarget {
    /// Keys of the target with text values.
    pub words: Vec<(&'static str, String)>,
    /// Keys of the target with numbers.
    pub numbers: Vec<(&'static str, f64)>,
}

/// A file, and the required columns that it lacks.
type Sheet = (Arc<Source>, Vec<&'static str>);

/// Reads the file of a target. `None` for an empty file, which the program reports later, when it reads the file as a curve.
/// The error says why the file cannot be read.
fn sheet(path: &Text, context: &Context) -> Result<Option<Sheet>, String> {
    let full = context.directory.join(path.get_ref());
    let text = read_text(&full, LONGEST_TEXT)?;
    let Some(header) = text.trim_start().lines().next() else {
        return Ok(None);
    };
    let separator = char::from(delimiter(&text));
    let names: Vec<&str> = header
        .split(separator)
        .map(|name| name.trim().trim_matches('"'))
        .collect();
    let missing = NEEDED.into_iter().filter(|name| !names.contains(name));
    let missing = missing.collect();
    let source = Source {
        name: full.display().to_string(),
        text,
    };
    Ok(Some((Arc::new(source), missing)))
}

/// Returns true if a target has no keys for the quantity of a curve, so its file must be a sheet.
fn must_be_a_sheet(written: &Written) -> bool {
    let named = [&written.figure, &written.characteristic];
    named.iter().all(|name| name.is_none())
        && written.column.is_none()
        && written.point.is_none()
        && written.length.is_none()
}

/// Targets of a measured sheet. `None` if the target's file is not a sheet. If the target names a test result or a
/// characteristic, only rows of this quantity are used.
pub(super) fn targets(
    spanned: &Spanned<Written>,
    context: &Context,
    problems: &mut Problems,
) -> Option<Option<Vec<(Target, SheetTarget)>>> {
    let written = spanned.get_ref();
    let path = written.file.as_ref()?;
    let of = match (context.elastic, context.axle) {
        (Some(elastic), _) => SheetOf::Wheel(elastic),
        (None, Some(both)) if both.axle.elastic.is_some() => SheetOf::Axle(both),
        _ => return None,
    };
    let (source, missing) = match sheet(path, context) {
        Ok(Some(found)) => found,
        Ok(None) => return None,
        // If the file cannot be read, only this error is reported, not the missing keys of a curve.
        Err(reason) if must_be_a_sheet(written) => {
            curve_file::unreadable(path, context.directory, &reason, problems);
            return Some(None);
        }
        Err(_) => return None,
    };
    if !missing.is_empty() {
        if !must_be_a_sheet(written) {
            return None;
        }
        let message = format!(
            "{} has no column {}. A measured sheet needs the columns load, quantity and value. For a file with a curve, name its \
             figure or characteristic here",
            path.get_ref(),
            missing.join(", ")
        );
        return Some(problems.refuse(path.span(), &message));
    }
    Some(of_sheet(spanned, of, &source, context, problems))
}

/// Elastic parts that a sheet measures.
#[derive(Clone, Copy)]
enum SheetOf<'a> {
    Wheel(&'a ComplianceStudy),
    Axle(&'a AxleStudy),
}

fn of_sheet(
    spanned: &Spanned<Written>,
    of: SheetOf<'_>,
    source: &Arc<Source>,
    context: &Context,
    problems: &mut Problems,
) -> Option<Vec<(Target, SheetTarget)>> {
    let written = spanned.get_ref();
    refuse_other_keys(written, problems)?;
    let named = written.figure.as_ref().or(written.characteristic.as_ref());
    if let Some(name) = named {
        match of {
            SheetOf::Wheel(elastic) => {
                elastic_targets::quantity(name, elastic, context.suspension, problems).map(drop)?;
            }
            SheetOf::Axle(both) => super::axle::quantities(name, &both.axle, problems).map(drop)?,
        }
    }
    let only = named.map(|name| name.get_ref().as_str());
    let factor = super::suspension::above_zero(&written.tolerance, problems)?;
    let weight = weight(&written.weight, problems)?;
    let read = Reader {
        source,
        of,
        context,
        only,
        tolerance: factor,
        weight,
    };
    match read.targets() {
        Ok(found) if found.is_empty() => {
            let message = "the sheet has no row with a value for the requested results";
            problems.refuse(spanned.span(), message)
        }
        Ok(found) => Some(found),
        Err(errors) => {
            problems.append(errors);
            None
        }
    }
}

struct Reader<'a> {
    source: &'a Arc<Source>,
    of: SheetOf<'a>,
    context: &'a Context<'a>,
    /// Name of the only test result to read, if the target names it.
    only: Option<&'a str>,
    /// Tolerance of each value, or factor for the column `tolerance`.
    tolerance: f64,
    weight: f64,
}

/// Cells of a row, by the names of their columns.
struct Row<'a> {
    source: &'a Arc<Source>,
    header: &'a csv::StringRecord,
    record: &'a csv::StringRecord,
}

impl Row<'_> {
    fn cell(&self, name: &str) -> &str {
        let place = self.header.iter().position(|column| column == name);
        place.and_then(|place| self.record.get(place)).unwrap_or("")
    }

    fn has(&self, name: &str) -> bool {
        self.header.iter().any(|column| column == name)
    }

    fn wrong<T>(&self, message: String) -> Result<T, StudyErrors> {
        Err(at_record(self.source, self.record, message))
    }

    /// Reads a number. `None` for an empty cell.
    fn number(&self, name: &str) -> Result<Option<f64>, StudyErrors> {
        match self.cell(name) {
            "" => Ok(None),
            text => match Number::parsed(text) {
                Ok(number) => Ok(Some(number)),
                Err(wanted) => self.wrong(format!("expected {wanted} as {name}, found {text:?}")),
            },
        }
    }

    /// Reads a wheel travel or a rack displacement. 0 if the sheet has no such column.
    fn position(&self, name: &str) -> Result<f64, StudyErrors> {
        match self.number(name)? {
            Some(position) => Ok(position),
            None if self.has(name) => self.wrong(format!(
                "{name} is empty, but the row has a value: expected a number as {name}"
            )),
            None => Ok(0.0),
        }
    }
}

impl Reader<'_> {
    fn targets(&self) -> Result<Vec<(Target, SheetTarget)>, StudyErrors> {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(delimiter(&self.source.text))
            .trim(csv::Trim::All)
            .from_reader(self.source.text.as_bytes());
        let mut header: Option<csv::StringRecord> = None;
        let mut found = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| {
                StudyErrors::from(super::StudyError::of_file(
                    &self.source.name,
                    error.to_string(),
                ))
            })?;
            match &header {
                None => {
                    columns::check(&record, self.context.suspension.length_unit)
                        .map_err(|message| at_record(self.source, &record, message))?;
                    header = Some(record);
                }
                Some(header) => self.row(
                    &Row {
                        source: self.source,
                        header,
                        record: &record,
                    },
                    &mut found,
                )?,
            }
        }
        Ok(found)
    }

    /// Adds the targets of a row of the sheet: one for its value, and one for its secant.
    fn row(&self, row: &Row<'_>, into: &mut Vec<(Target, SheetTarget)>) -> Result<(), StudyErrors> {
        for (column, is_secant) in [("value", false), ("secant", true)] {
            let Some(value) = row.number(column)? else {
                continue;
            };
            let load = row.cell("load");
            if !TestLoad::ALL.iter().any(|(_, of)| of.name() == load) {
                return row.wrong(format!("{load:?} is not a load of a test"));
            }
            let figure = match self.of {
                SheetOf::Wheel(elastic) => self.figure_of_wheel(elastic, row, is_secant)?,
                SheetOf::Axle(both) => self.figure_of_axle(both, row, is_secant)?,
            };
            let Some(figure) = figure else {
                continue;
            };
            let expected = figure.of.unit.suffix(self.context.suspension.length_unit);
            let unit = row.cell("unit");
            if unit != expected && row.has("unit") {
                let quantity = row.cell("quantity");
                return row.wrong(format!(
                    "expected {expected:?} as the unit of {quantity}, found {unit:?}"
                ));
            }
            if self.only.is_none_or(|only| only == figure.name) {
                into.push(self.target(row, figure, value)?);
            }
        }
        Ok(())
    }

    /// Returns true if a row of the sheet belongs to a test. Empty cells match every test.
    fn is_of(&self, row: &Row<'_>, test: &KcTest) -> Result<bool, StudyErrors> {
        let u = self.context.suspension.length_unit.symbol();
        let trail = row.number(&format!("trail_{u}"))?;
        let held = match test.held {
            HeldQuantity::WheelHeight => "wheel_height",
            HeldQuantity::WheelLoad => "wheel_load",
        };
        let bar = if test.has_bar {
            "connected"
        } else {
            "disconnected"
        };
        let steering = if test.locks_rack {
            "locked_rack"
        } else {
            "locked_wheel"
        };
        let same = |column: &str, own: &str| ["", own].contains(&row.cell(column));
        Ok(row.cell("load") == test.load.name()
            // The trails are compared with six digits, because a conversion of units may have rounded them.
            && trail.is_none_or(|trail| six_digits(trail) == six_digits(test.trail))
            && same("hold", held)
            && same("mode", test.mode.name())
            && same("anti_roll_bar", bar)
            && same("steering", steering))
    }

    /// Returns the test result that fits a row. More than one fitting test result is an error. `None` for a missing secant.
    fn only_one<F>(
        row: &Row<'_>,
        is_secant: bool,
        found: Vec<F>,
        columns: &str,
    ) -> Result<Option<F>, StudyErrors> {
        let (load, quantity) = (row.cell("load"), row.cell("quantity"));
        match found.len() {
            1 => Ok(found.into_iter().next()),
            0 if is_secant => Ok(None),
            0 if !figure_names().contains(&quantity) => {
                let of_load = TestLoad::ALL.iter().filter(|(name, _)| *name == load);
                let of_load = of_load.flat_map(|(_, load)| figures_by(*load));
                let meant = nearest(quantity, of_load.copied());
                let meant = meant.or_else(|| nearest(quantity, figure_names()));
                let meant = meant.map_or(String::new(), |near| format!("; did you mean {near:?}?"));
                row.wrong(format!("unknown quantity {quantity:?}{meant}"))
            }
            0 => row.wrong(format!(
                "no test of the study gives {quantity} by {load} with these {columns}: add such a test to tests in [compliance]"
            )),
            _ => row.wrong(format!(
                "several tests of the study give {quantity} by {load}: fill in {columns} to select one"
            )),
        }
    }

    /// Test result that a row of the sheet contains. `None` for a secant of a test with a motion, because such a test
    /// has no secants.
    fn figure_of_wheel(
        &self,
        elastic: &ComplianceStudy,
        row: &Row<'_>,
        is_secant: bool,
    ) -> Result<Option<SheetFigure>, StudyErrors> {
        for name in ["mode", "wheel", "anti_roll_bar", "steering"] {
            if !row.cell(name).is_empty() {
                return row.wrong(format!(
                    "{name} applies to axles only, and this study describes one wheel; expected an empty cell"
                ));
            }
        }
        let suspension = self.context.suspension;
        let mut found: Vec<ElasticFigure> = Vec::new();
        for figure in elastic_targets::figures(elastic, suspension) {
            if let KcValue::Figure {
                test,
                quantity,
                is_secant: secant,
            } = figure.value
                && secant == is_secant
                && quantity == row.cell("quantity")
                && self.is_of(row, &test)?
            {
                found.push(figure);
            }
        }
        let u = suspension.length_unit.symbol();
        let figure = Self::only_one(row, is_secant, found, &format!("trail_{u} and hold"))?;
        Ok(figure.map(|figure| SheetFigure {
            name: figure.name.clone(),
            of: ElasticQuantity::Figure(figure).subject(suspension.length_unit),
            side: None,
        }))
    }

    fn target(
        &self,
        row: &Row<'_>,
        figure: SheetFigure,
        value: f64,
    ) -> Result<(Target, SheetTarget), StudyErrors> {
        let u = self.context.suspension.length_unit.symbol();
        let own = row.number("tolerance")?;
        let tolerance = match (own, self.only) {
            (Some(own), _) if own > 0.0 => own * self.tolerance,
            (Some(own), _) => {
                return row.wrong(format!("expected a tolerance above 0, found {own}"));
            }
            (None, Some(_)) => self.tolerance,
            (None, None) => {
                return row.wrong(
                    "this row has no tolerance: expected a number in the column tolerance, or the key \"figure\" in the target"
                        .to_owned(),
                );
            }
        };
        if let Some(message) = tiny(tolerance) {
            return row.wrong(format!("tolerance: {message}"));
        }
        let mut words = vec![("figure", figure.name)];
        let (site, drive, mut numbers) = match self.of {
            SheetOf::Wheel(_) => {
                let travel = row.position(&format!("travel_{u}"))?;
                let rack = row.position(&format!("rack_{u}"))?;
                let site = Site {
                    racks: vec![rack],
                    ..Site::default()
                };
                (site, travel, vec![("at", travel), ("rack", rack)])
            }
            SheetOf::Axle(both) => {
                let AxlePlace { site, at, numbers } = self.place_of_axle(both, row)?;
                words.push(("over", site.over.key().to_owned()));
                words.extend(figure.side.map(|side| ("side", side.name().to_owned())));
                let site = Site {
                    axle: Some(site),
                    ..Site::default()
                };
                (site, at, numbers)
            }
        };
        self.check_within(drive, &site, row)?;
        numbers.extend([
            ("value", value),
            ("tolerance", tolerance),
            ("weight", self.weight),
        ]);
        let of = figure.of;
        let target = Target {
            wanted: Wanted::At {
                drive,
                value: of.from_printed(value),
            },
            tolerance: of.from_printed(tolerance).abs(),
            weight: self.weight,
            site,
            stations: Vec::new(),
            of,
        };
        Ok((target, SheetTarget { words, numbers }))
    }

    /// Refuses a row at a position outside of the motion, because a tuning does not compare values there.
    fn check_within(&self, at: f64, site: &Site, row: &Row<'_>) -> Result<(), StudyErrors> {
        let of_axle = site.axle.as_ref().map(AxleSite::motion);
        // A motion with an error is already reported.
        let motion = of_axle.as_ref().or(self.context.motion);
        match motion.and_then(|motion| refuse_measured(at, motion, site, self.context)) {
            Some(message) => row.wrong(message),
            None => Ok(()),
        }
    }
}

/// Test result of a row.
struct SheetFigure {
    /// Name of the test result in a study.
    name: String,
    of: TargetQuantity,
    /// Wheel that the row of the sheet names, for an axle.
    side: Option<Side>,
}
