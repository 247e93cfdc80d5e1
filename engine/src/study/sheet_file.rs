//! Measured K&C sheets in the layout of `kc.csv` as targets: a target for each figure, station by station.

use super::curve_file::{at_record, delimiter};
use super::elastic_targets;
use super::error::{Problems, Source, StudyErrors};
use super::file::Target as Written;
use super::resolve::Context;
use super::source::{LONGEST_TEXT, read_text};
use super::value::{Number, Text};
use super::{ComplianceStudy, ElasticFigure, Site, Target, Wanted};
use crate::compliance::{HeldQuantity, KcValue, TestLoad};
use std::sync::Arc;
use toml::Spanned;

/// Columns that a sheet needs.
const NEEDED: [&str; 3] = ["load", "quantity", "value"];

/// A target as it is written out in a study: figure, travel, rack, value and tolerance, in printed units.
#[derive(Clone, Debug)]
pub(super) struct SheetTarget {
    /// Name of the figure.
    pub figure: String,
    /// Wheel travel.
    pub travel: f64,
    /// Rack displacement.
    pub rack: f64,
    /// The measured value.
    pub value: f64,
    /// Its tolerance.
    pub tolerance: f64,
    /// Weight of each.
    pub weight: f64,
}

/// Reads the file of a target if it is a sheet; otherwise `None`.
fn sheet(path: &Text, context: &Context) -> Option<Arc<Source>> {
    let full = context.directory.join(path.get_ref());
    // A file that cannot be read is reported by the reader of curves.
    let text = read_text(&full, LONGEST_TEXT).ok()?;
    let header = text.trim_start().lines().next()?;
    let separator = char::from(delimiter(&text));
    let names: Vec<&str> = header
        .split(separator)
        .map(|name| name.trim().trim_matches('"'))
        .collect();
    NEEDED.iter().all(|name| names.contains(name)).then(|| {
        Arc::new(Source {
            name: full.display().to_string(),
            text,
        })
    })
}

/// The targets of a measured sheet; `None` if the target's file is not a sheet. With a figure or characteristic the
/// rows of that figure count alone.
pub(super) fn targets(
    spanned: &Spanned<Written>,
    context: &Context,
    problems: &mut Problems,
) -> Option<Option<Vec<(Target, SheetTarget)>>> {
    let written = spanned.get_ref();
    let (Some(path), Some(elastic)) = (&written.file, context.elastic) else {
        return None;
    };
    let source = sheet(path, context)?;
    Some(of_sheet(spanned, elastic, &source, context, problems))
}

fn of_sheet(
    spanned: &Spanned<Written>,
    elastic: &ComplianceStudy,
    source: &Arc<Source>,
    context: &Context,
    problems: &mut Problems,
) -> Option<Vec<(Target, SheetTarget)>> {
    let written = spanned.get_ref();
    let others = [
        ("points", written.points.as_ref().map(Spanned::span)),
        ("column", written.column.as_ref().map(Spanned::span)),
        ("at", written.at.as_ref().map(|n| n.span.clone())),
        ("value", written.value.as_ref().map(|n| n.span.clone())),
        ("rack", written.rack.as_ref().map(Spanned::span)),
        ("motion", written.motion.as_ref().map(Spanned::span)),
        ("point", written.point.as_ref().map(Spanned::span)),
        ("length", written.length.as_ref().map(Spanned::span)),
        ("load", written.load.as_ref().map(Spanned::span)),
    ];
    for (key, span) in others {
        if let Some(span) = span {
            let message = format!("the sheet has travel, rack and values: expected no {key}");
            return problems.refuse(span, &message);
        }
    }
    let only = match written.figure.as_ref().or(written.characteristic.as_ref()) {
        None => None,
        Some(name) => {
            let found = elastic_targets::quantity(name, elastic, context.suspension, problems)?;
            Some(found.value())
        }
    };
    let factor = super::suspension::above_zero(&written.tolerance, problems)?;
    let weight = match &written.weight {
        None => 1.0,
        Some(weight) => super::suspension::above_zero(weight, problems)?,
    };
    let read = Reader {
        source,
        elastic,
        context,
        only,
        tolerance: factor,
        weight,
    };
    match read.targets() {
        Ok(found) if found.is_empty() => {
            let message = "the sheet has no row with a value of these figures";
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
    elastic: &'a ComplianceStudy,
    context: &'a Context<'a>,
    /// The only value that counts.
    only: Option<KcValue>,
    /// Tolerance of the target: of each value, or a factor of the column `tolerance`.
    tolerance: f64,
    weight: f64,
}

/// Cells of a row by the names of their columns.
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

    fn wrong<T>(&self, message: String) -> Result<T, StudyErrors> {
        Err(at_record(self.source, self.record, message))
    }

    /// A number; `None` for an empty cell.
    fn number(&self, name: &str) -> Result<Option<f64>, StudyErrors> {
        match self.cell(name) {
            "" => Ok(None),
            text => match Number::parsed(text) {
                Ok(number) => Ok(Some(number)),
                Err(wanted) => self.wrong(format!("expected {wanted} as {name}, found {text:?}")),
            },
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
                None => header = Some(record),
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

    /// Adds the targets of a row: its value, and its secant.
    fn row(&self, row: &Row<'_>, into: &mut Vec<(Target, SheetTarget)>) -> Result<(), StudyErrors> {
        for name in ["mode", "wheel", "anti_roll_bar"] {
            if !row.cell(name).is_empty() {
                return row.wrong(format!("{name} is of an axle; expected an empty cell"));
            }
        }
        for (column, is_secant) in [("value", false), ("secant", true)] {
            let Some(value) = row.number(column)? else {
                continue;
            };
            let Some(figure) = self.figure(row, is_secant)? else {
                continue;
            };
            if self.only.is_some_and(|only| only != figure.value) {
                continue;
            }
            into.push(self.target(row, figure, value)?);
        }
        Ok(())
    }

    /// The figure of a row. `None` for the secant of a motion, which has none.
    fn figure(&self, row: &Row<'_>, is_secant: bool) -> Result<Option<ElasticFigure>, StudyErrors> {
        let (load, quantity, hold) = (row.cell("load"), row.cell("quantity"), row.cell("hold"));
        let u = self.context.suspension.length_unit.symbol();
        let trail = row.number(&format!("trail_{u}"))?;
        let all = elastic_targets::figures(self.elastic, self.context.suspension);
        let is_load = |of: TestLoad| of.name() == load;
        if !TestLoad::ALL.iter().any(|(_, of)| is_load(*of)) {
            return row.wrong(format!("{load:?} is no load of a test"));
        }
        let is_named = |figure: &&ElasticFigure| match figure.value {
            KcValue::Figure {
                test,
                quantity: name,
                is_secant: secant,
            } => {
                let held = match test.held {
                    HeldQuantity::WheelHeight => "wheel_height",
                    HeldQuantity::WheelLoad => "wheel_load",
                };
                let same_trail = trail.is_none_or(|trail| trail == test.trail);
                let same_hold = hold.is_empty() || hold == held;
                is_load(test.load)
                    && name == quantity
                    && secant == is_secant
                    && same_trail
                    && same_hold
            }
            _ => false,
        };
        let mut found = all.iter().filter(is_named);
        let figure = match (found.next(), found.next()) {
            (Some(figure), None) => figure.clone(),
            (Some(_), Some(_)) => {
                return row.wrong(format!(
                    "several tests of the study have {quantity} by {load}: expected trail_{u} and hold"
                ));
            }
            (None, _) if is_secant => return Ok(None),
            (None, _) => {
                return row.wrong(format!(
                    "no test of the study has {quantity} by {load} with this trail and hold: add it to tests in [compliance]"
                ));
            }
        };
        let expected = figure.unit.suffix(self.context.suspension.length_unit);
        let unit = row.cell("unit");
        if unit != expected && row.header.iter().any(|column| column == "unit") {
            return row.wrong(format!(
                "expected {expected:?} as the unit of {quantity}, found {unit:?}"
            ));
        }
        Ok(Some(figure))
    }

    fn target(
        &self,
        row: &Row<'_>,
        figure: ElasticFigure,
        value: f64,
    ) -> Result<(Target, SheetTarget), StudyErrors> {
        let length = self.context.suspension.length_unit;
        let u = length.symbol();
        let travel = row.number(&format!("travel_{u}"))?.unwrap_or(0.0);
        let rack = row.number(&format!("rack_{u}"))?.unwrap_or(0.0);
        let own = row.number("tolerance")?;
        let tolerance = match (own, self.only) {
            (Some(own), _) if own > 0.0 => own * self.tolerance,
            (Some(own), _) => {
                return row.wrong(format!("expected a tolerance above 0, found {own}"));
            }
            (None, Some(_)) => self.tolerance,
            (None, None) => {
                return row.wrong(
                    "figures of several units need a tolerance each: expected a column tolerance, or figure in the target"
                        .to_owned(),
                );
            }
        };
        let of = elastic_targets::ElasticQuantity::Figure(figure.clone()).subject(length);
        let target = Target {
            wanted: Wanted::At {
                drive: travel,
                value: of.from_printed(value),
            },
            tolerance: of.from_printed(tolerance).abs(),
            weight: self.weight,
            site: Site {
                racks: vec![rack],
                ..Site::default()
            },
            stations: Vec::new(),
            of,
        };
        let text = SheetTarget {
            figure: figure.name,
            travel,
            rack,
            value,
            tolerance,
            weight: self.weight,
        };
        Ok((target, text))
    }
}
