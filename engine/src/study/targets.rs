//! `targets` of `[optimise]`: target curves, values and bands.

mod band;
mod column_unit;
mod drive_values;
mod stations;

use super::axle_targets;
use super::curve_file::{self, WantedColumns};
use super::drive_rounding::{DriveRounding, ends, ends_of_curve};
use super::elastic_targets;
use super::error::Problems;
use super::file::{self, Target as Written};
use super::names::choose;
use super::resolve::{Context, each, some};
use super::sheet_file::{self, SheetTarget};
use super::subject::{site, subject};
use super::suspension::above_zero;
use super::value::{Number, Text};
use super::{Interpolation, Motion, Site, Target, TargetQuantity, Wanted};
use drive_values::DriveValues;
use stations::{added_stations, rack_displacements};
use std::ops::Range as Span;
use toml::Spanned;

/// A curve as written: drive value and target value, in the file's units.
pub(super) type WrittenCurve = Vec<[f64; 2]>;

/// Contents of a file that a target names. They replace the target in the study's text.
#[derive(Clone, Debug)]
pub(super) enum FromFile {
    /// Points of a target curve.
    Curve(WrittenCurve),
    /// Targets of a measured sheet.
    Sheet(Vec<SheetTarget>),
}

/// Targets, and the data from files, each with the index of the target as written.
type ReadTargets = (Vec<Target>, Vec<(usize, FromFile)>);

/// Reads the targets, and the data from files, each with the index of the target as written. `None` if there is an error.
pub(super) fn targets(
    section: &file::Optimise,
    context: &Context,
    problems: &mut Problems,
) -> Option<ReadTargets> {
    let written = some(&section.targets, "target", problems)?;
    let is_fit = section.fit.as_ref().is_some_and(|fit| *fit.get_ref());
    for own in written.iter().map(Spanned::get_ref) {
        refuse_keys_of_cars([&own.case, &own.axle], problems)?;
    }
    each_target(written, is_fit, context, problems)
}

/// Refuses keys of a target or a constraint that are only for studies of cars.
pub(super) fn refuse_keys_of_cars(
    written: [&Option<Text>; 2],
    problems: &mut Problems,
) -> Option<()> {
    for (key, given) in ["case", "axle"].into_iter().zip(written) {
        if let Some(text) = given {
            let message = format!("{key} needs [car]: the study of a car has load cases and axles");
            return problems.refuse(text.span(), message);
        }
    }
    Some(())
}

/// Reads the targets of a list.
pub(super) fn each_target<'w>(
    written: impl IntoIterator<Item = &'w Spanned<Written>>,
    is_fit: bool,
    context: &Context,
    problems: &mut Problems,
) -> Option<ReadTargets> {
    let read = each(written, |t| {
        match sheet_file::targets(t, context, problems) {
            Some(sheet) => {
                let (targets, texts) = sheet?.into_iter().unzip();
                Some((targets, Some(FromFile::Sheet(texts))))
            }
            None => {
                let (target, curve) = target(t, is_fit, context, problems)?;
                Some((vec![target], curve.map(FromFile::Curve)))
            }
        }
    })?;
    let (mut targets, mut files) = (Vec::new(), Vec::new());
    for (place, (own, file)) in read.into_iter().enumerate() {
        targets.extend(own);
        files.extend(file.map(|file| (place, file)));
    }
    Some((targets, files))
}

fn target(
    spanned: &Spanned<Written>,
    is_fit: bool,
    context: &Context,
    problems: &mut Problems,
) -> Option<(Target, Option<WrittenCurve>)> {
    let place = spanned.span();
    let written = spanned.get_ref();
    let (of, site, axle_motion) = quantity_and_site(spanned, context, problems);
    let tolerance = not_tiny(&written.tolerance, problems);
    let weight = weight(&written.weight, problems);
    let interpolation = interpolation(written, problems);
    if let (Some(axis), None) = (&written.axis, &written.point) {
        let message = "the key \"axis\" needs \"point\": it names a coordinate of the point";
        problems.add(axis.span(), message);
    }
    if let (Some(column), None) = (&written.column, &written.file) {
        problems.add(
            column.span(),
            "the key \"column\" needs \"file\": it names a column of the file",
        );
    }
    let (of, site) = (of?, site?);
    let motion = site.motion.as_ref().map(|(_, motion)| motion);
    let motion = axle_motion.as_ref().or(motion).or(context.motion)?;
    let target = TargetContext {
        motion,
        drives: DriveValues::of(motion, &site, context),
        place,
        of: &of,
        interpolation: interpolation?,
        is_fit,
    };

    let (wanted, from_file) = target.wanted(written, &site, context, problems)?;
    let has_rows = site.axle.as_ref().is_some_and(|site| site.held.has_rows());
    if has_rows {
        target.check_rows(&wanted, written, problems)?;
    }
    let target = Target {
        tolerance: of.from_printed(tolerance?).abs(),
        // In a motion given as a table of rows, no stations can be added between the rows.
        stations: if has_rows {
            Vec::new()
        } else {
            added_stations(&wanted, target.motion)
        },
        of: of.clone(),
        wanted,
        weight: weight?,
        site: site.clone(),
    };
    Some((target, from_file))
}

/// Quantity of a target, the stations at which it applies (its site), and for an axle its motion. A part with an error
/// is `None`.
fn quantity_and_site(
    spanned: &Spanned<Written>,
    context: &Context,
    problems: &mut Problems,
) -> (Option<TargetQuantity>, Option<Site>, Option<Motion>) {
    let written = spanned.get_ref();
    if let Some(study) = context.axle {
        return match axle_targets::target(spanned, study, context, problems) {
            Some((of, site, motion)) => (Some(of), Some(site), Some(motion)),
            None => (None, None, None),
        };
    }
    axle_targets::Where::from(written).refuse(false, problems);
    let of = match (context.elastic, &written.figure) {
        (Some(elastic), _) => elastic_targets::subject(spanned, elastic, context, problems),
        // Errors in the elastic parts are already reported.
        (None, Some(_)) if context.file.compliance.is_some() => None,
        (None, Some(figure)) => problems.refuse(
            figure.span(),
            "the key \"figure\" (a test result) needs [compliance] with elastic parts",
        ),
        (None, None) => subject(spanned, context, problems),
    };
    let site = site(&written.motion, &written.rack, context, problems);
    (of, site, None)
}

/// Message if a measured value at this drive value cannot be compared, because the drive value is outside of the motion.
pub(super) fn refuse_measured(
    at: f64,
    motion: &Motion,
    site: &Site,
    context: &Context,
) -> Option<String> {
    DriveValues::of(motion, site, context).refuse_measured(at)
}

/// Message if a tolerance or a weight is so small that division by it, or by its square, may overflow.
pub(super) fn tiny(value: f64) -> Option<String> {
    const LEAST: f64 = 1e-12;
    (value < LEAST).then(|| format!("expected a number of at least {LEAST:e}, found {value:e}"))
}

/// Checks that the number is positive and not tiny.
pub(super) fn not_tiny(number: &Number, problems: &mut Problems) -> Option<f64> {
    let value = above_zero(number, problems)?;
    match tiny(value) {
        None => Some(value),
        Some(message) => problems.refuse(number.span.clone(), message),
    }
}

/// Weight of a target: 1 if the study gives none.
pub(super) fn weight(written: &Option<Number>, problems: &mut Problems) -> Option<f64> {
    match written {
        None => Some(1.0),
        Some(weight) => not_tiny(weight, problems),
    }
}

fn interpolation(written: &Written, problems: &mut Problems) -> Option<Interpolation> {
    let kinds = [
        ("linear", Interpolation::Linear),
        ("monotone_cubic", Interpolation::MonotoneCubic),
    ];
    let Some(text) = &written.interpolation else {
        return Some(Interpolation::MonotoneCubic);
    };
    if written.at.is_some() && written.points.is_none() {
        problems.add(
            text.span(),
            "the key \"interpolation\" does not apply to a single value",
        );
    }
    choose(text, "interpolation", &kinds, problems)
}

/// Points of a curve as written.
fn curve(
    points: &[Spanned<Vec<Number>>],
    place: Span<usize>,
    as_measured: bool,
    problems: &mut Problems,
) -> Option<WrittenCurve> {
    let mut curve: WrittenCurve = Vec::new();
    for point in points {
        let [drive, value] = point.get_ref().as_slice() else {
            let message = format!(
                "expected a pair [drive value, target value], found {} numbers",
                point.get_ref().len()
            );
            return problems.refuse_count(point, 2, message);
        };
        let last = curve.last().filter(|_| !as_measured);
        if let Some([before, _]) = last.filter(|[before, _]| *before >= drive.value) {
            let message = format!("{} is not above {before}, the previous value", drive.value);
            let error = problems.add(drive.span.clone(), message);
            error.help("the points of a curve are given by strictly rising drive value");
            return None;
        }
        curve.push([drive.value, value.value]);
    }
    match curve.as_slice() {
        [] => problems.refuse(place, "expected at least two points, found an empty list"),
        [[drive, value]] => {
            let error = problems.add(place, "a curve has at least two points, found one");
            error.help(format!(
                "write a single value as at = {drive:?}, value = {value:?}"
            ));
            None
        }
        _ => Some(curve),
    }
}

/// Position of a target in the file, its quantity and its motion.
struct TargetContext<'a> {
    motion: &'a Motion,
    drives: DriveValues<'a>,
    place: Span<usize>,
    of: &'a TargetQuantity,
    interpolation: Interpolation,
    /// True if the target belongs to a fit. Points of its curve are then measured points.
    is_fit: bool,
}

impl TargetContext<'_> {
    /// Checks that a motion given as a table of rows has a row for each drive value of a target. For a target curve, at least
    /// one row must lie on the curve.
    fn check_rows(
        &self,
        wanted: &Wanted,
        written: &Written,
        problems: &mut Problems,
    ) -> Option<()> {
        let rows = &self.motion.values;
        let samples = wanted.samples(rows);
        let rounding = DriveRounding::of(rows);
        let mut samples_off = samples.iter();
        let off = samples_off.find(|sample| !rounding.is_among(sample.drive, rows));
        let place = written
            .at
            .as_ref()
            .map_or(self.place.clone(), |at| at.span.clone());
        if let Some(sample) = off {
            let known: Vec<_> = rows.iter().map(ToString::to_string).collect();
            let message = format!(
                "no row of the motion has {}; the rows have {}",
                sample.drive,
                known.join(", ")
            );
            return problems.refuse(place, message);
        }
        if samples.is_empty() {
            return problems.refuse(
                place,
                "no row of the motion is within the range of this target's curve",
            );
        }
        Some(())
    }

    /// Reads the target values, and the curve if it comes from a file.
    fn wanted(
        &self,
        written: &Written,
        site: &Site,
        context: &Context,
        problems: &mut Problems,
    ) -> Option<(Wanted, Option<WrittenCurve>)> {
        let mut from_file = None;
        let band =
            written.between.is_some() || written.at_least.is_some() || written.at_most.is_some();
        let given = (
            &written.points,
            &written.file,
            &written.at,
            &written.value,
            band,
        );
        let wanted = match given {
            (Some(points), None, None, None, false) => {
                let drives = points.get_ref().iter();
                let drives = drives.filter_map(|point| point.get_ref().first());
                for drive in drives.filter(|_| self.is_fit) {
                    if let Some(message) = self.drives.refuse_measured(drive.value) {
                        return problems.refuse(drive.span.clone(), message);
                    }
                }
                let curve = curve(points.get_ref(), points.span(), self.is_fit, problems)?;
                self.curve(&curve, points.span(), problems)
            }
            (None, Some(path), None, None, false) => {
                let curve = self.curve_of_file(path, written, site, context, problems)?;
                let wanted = self.curve(&curve, path.span(), problems);
                from_file = Some(curve);
                wanted
            }
            (None, None, Some(at), Some(value), false) => {
                self.single(at, problems).map(|drive| Wanted::At {
                    drive,
                    value: self.of.from_printed(value.value),
                })
            }
            (None, None, at, None, true) => self.band(written, at.as_ref(), problems),
            (None, None, Some(at), None, false) => {
                problems.refuse(at.span.clone(), "\"at\" needs \"value\": the target value")
            }
            // Without a travel, the target of a test result applies at the design height.
            (None, None, None, Some(value), false) if self.of.is_figure() => {
                let value = self.of.from_printed(value.value);
                Some(Wanted::At { drive: 0.0, value })
            }
            (None, None, None, Some(value), false) => problems.refuse(
                value.span.clone(),
                "\"value\" needs \"at\": the drive value of the target",
            ),
            (None, None, None, None, false) => {
                let message = "expected points = [[drive, value], ...], file = \"curve.csv\", \"at\" and \"value\", or a band: \
                           \"between\", \"at_least\", \"at_most\"";
                problems.refuse(self.place.clone(), message)
            }
            _ => {
                let message = "expected one of \"points\", \"file\", \"at\" with \"value\", or a band, found more than one";
                problems.refuse(self.place.clone(), message)
            }
        };
        Some((wanted?, from_file))
    }

    /// Reads the curve of a target from a file.
    fn curve_of_file(
        &self,
        path: &Text,
        written: &Written,
        site: &Site,
        context: &Context,
        problems: &mut Problems,
    ) -> Option<WrittenCurve> {
        let length_unit = context.suspension.length_unit;
        let drive = self.motion.drive.column(length_unit);
        let columns = WantedColumns {
            drive: &drive,
            value: column_unit::checked(written.column.as_ref(), self.of, problems)?,
            length_unit,
            racks: &rack_displacements(site, self.motion),
            as_measured: self.is_fit,
            refuse_measured: &|drive| self.drives.refuse_measured(self.drives.of_column(drive)),
        };
        let curve = curve_file::read(path, context.directory, &columns, problems)?;
        let curve = curve.iter();
        let curve = curve.map(|[d, value]| [self.drives.of_column(*d), *value]);
        Some(curve.collect())
    }

    /// Converts a curve to a target. Checks that a station of the motion is on the curve, or a point of the curve within the
    /// motion. Measured points are not checked here.
    fn curve(
        &self,
        curve: &[[f64; 2]],
        place: Span<usize>,
        problems: &mut Problems,
    ) -> Option<Wanted> {
        let motion = self.motion;
        let points: Vec<[f64; 2]> = curve
            .iter()
            .map(|[drive, value]| [self.drives.in_kernel(*drive), self.of.from_printed(*value)])
            .collect();
        if self.is_fit {
            return Some(Wanted::Points(points));
        }
        let rounding = DriveRounding::of(&motion.values);
        let [of_motion, of_curve] = [ends(&motion.values), ends_of_curve(&points)];
        let mut stations = motion.values.iter();
        let has_station = stations.any(|station| rounding.is_within(*station, of_curve));
        let mut knots = points.iter().map(|point| point[0]);
        if !has_station && !knots.any(|knot| rounding.is_within(knot, of_motion)) {
            let [first, last] = [curve[0][0], curve[curve.len() - 1][0]];
            let message = format!(
                "no station of the motion, which {}, is on this curve, which runs from {first} to {last}",
                self.drives.range_in_words()
            );
            return problems.refuse(place, message);
        }
        Some(Wanted::Curve {
            points,
            interpolation: self.interpolation,
        })
    }

    /// A single drive value, which must be within the motion.
    fn single(&self, at: &Number, problems: &mut Problems) -> Option<f64> {
        match self.drives.outside(at.value) {
            None => Some(self.drives.in_kernel(at.value)),
            Some(message) => problems.refuse(at.span.clone(), message),
        }
    }
}
