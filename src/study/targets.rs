//! `targets` of `[optimise]`: wanted curves and values.

use super::curve_file;
use super::error::Problems;
use super::file::{self, Target as Written};
use super::names::choose;
use super::outputs::characteristic;
use super::resolve::Context;
use super::suspension::above_zero;
use super::value::Number;
use super::{Interpolation, Motion, Target, Wanted};
use crate::characteristics::Unit;
use std::ops::Range as Span;
use toml::Spanned;

/// The least tolerance, in the units of columns. Deviations in tolerances stay far from the largest number.
const LEAST_TOLERANCE: f64 = 1e-12;

/// A curve as written: drive value and wanted value, in the file's units.
pub type WrittenCurve = Vec<[f64; 2]>;

/// The targets, if nothing is wrong with them, each with its curve if that came from a file.
pub fn targets(
    section: &file::Optimise,
    context: &Context,
    problems: &mut Problems,
) -> Option<Vec<(Target, Option<WrittenCurve>)>> {
    let written = section.targets.get_ref();
    if written.is_empty() {
        problems.add(
            section.targets.span(),
            "expected at least one target, found an empty list",
        );
        return None;
    }
    let resolved: Vec<_> = written
        .iter()
        .map(|t| target(t, context, problems))
        .collect();
    resolved.into_iter().collect()
}

fn target(
    written: &Spanned<Written>,
    context: &Context,
    problems: &mut Problems,
) -> Option<(Target, Option<WrittenCurve>)> {
    let place = written.span();
    let written = written.get_ref();
    let characteristic = characteristic(&written.characteristic, context.suspension, problems);
    let tolerance = not_tiny(&written.tolerance, problems);
    if let Some(tolerance) = tolerance.filter(|tolerance| *tolerance < LEAST_TOLERANCE) {
        let message =
            format!("no value is known to {tolerance:?}; expected at least {LEAST_TOLERANCE:?}");
        problems.add(written.tolerance.span.clone(), message);
        return None;
    }
    let weight = match &written.weight {
        None => Some(1.0),
        Some(weight) => not_tiny(weight, problems),
    };
    let interpolation = interpolation(written, problems);
    let characteristic = characteristic?;
    let unit = characteristic.info().unit;

    let mut from_file = None;
    let wanted = match (&written.points, &written.file, &written.at, &written.value) {
        (Some(points), None, None, None) => {
            let curve = curve(points, problems)?;
            wanted_curve(
                &curve,
                points.span(),
                unit,
                interpolation?,
                context,
                problems,
            )
        }
        (None, Some(path), None, None) => {
            let drive = drive_column(context);
            let value = characteristic.column(context.suspension.length_unit);
            let curve = curve_file::read(path, context.directory, [&drive, &value], problems)?;
            let wanted = wanted_curve(&curve, path.span(), unit, interpolation?, context, problems);
            from_file = Some(curve);
            wanted
        }
        (None, None, Some(at), Some(value)) => wanted_value(at, value, unit, context, problems),
        (None, None, Some(at), None) => {
            problems.add(at.span.clone(), "at needs value: what is wanted there");
            None
        }
        (None, None, None, Some(value)) => {
            problems.add(
                value.span.clone(),
                "value needs at: the drive value where it is wanted",
            );
            None
        }
        (None, None, None, None) => {
            let message = "expected what is wanted: points = [[drive, value], ...], file = \"curve.csv\", \
                           or at and value";
            problems.add(place, message);
            None
        }
        _ => {
            let message = "expected one of points, file, or at with value, found more than one";
            problems.add(place, message);
            None
        }
    };
    let target = Target {
        characteristic,
        wanted: wanted?,
        tolerance: unit.from_printed(tolerance?),
        weight: weight?,
    };
    Some((target, from_file))
}

/// The number, which must be above zero by so much that quotients by it, and their squares, do not overflow.
fn not_tiny(number: &Number, problems: &mut Problems) -> Option<f64> {
    const LEAST: f64 = 1e-12;
    let value = above_zero(number, problems)?;
    if value >= LEAST {
        return Some(value);
    }
    let message = format!("expected a number of at least {LEAST:e}, found {value:e}");
    problems.add(number.span.clone(), message);
    None
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
        problems.add(text.span(), "a single value has nothing to interpolate");
    }
    choose(text, "interpolation", &kinds, problems)
}

/// The points of a curve as written.
fn curve(
    points: &Spanned<Vec<Spanned<Vec<Number>>>>,
    problems: &mut Problems,
) -> Option<WrittenCurve> {
    let mut curve: WrittenCurve = Vec::new();
    for point in points.get_ref() {
        let [drive, value] = point.get_ref().as_slice() else {
            let message = format!(
                "expected a pair [drive value, wanted value], found {} numbers",
                point.get_ref().len()
            );
            problems.add(point.span(), message);
            return None;
        };
        if let Some([before, _]) = curve.last().filter(|[before, _]| *before >= drive.value) {
            let message = format!(
                "{} does not rise above {before}, the one before",
                drive.value
            );
            let error = problems.add(drive.span.clone(), message);
            error.help("the points of a curve are given by strictly rising drive value");
            return None;
        }
        curve.push([drive.value, value.value]);
    }
    match curve.as_slice() {
        [] => {
            problems.add(
                points.span(),
                "expected at least two points, found an empty list",
            );
            None
        }
        [[drive, value]] => {
            let error = problems.add(points.span(), "a curve has at least two points, found one");
            error.help(format!(
                "a single value is at = {drive:?}, value = {value:?}"
            ));
            None
        }
        _ => Some(curve),
    }
}

fn wanted_curve(
    curve: &[[f64; 2]],
    place: Span<usize>,
    unit: Unit,
    interpolation: Interpolation,
    context: &Context,
    problems: &mut Problems,
) -> Option<Wanted> {
    let motion = context.motion?;
    let points: Vec<[f64; 2]> = curve
        .iter()
        .map(|[drive, value]| [drive_value(motion, *drive), unit.from_printed(*value)])
        .collect();
    let [first, last] = [curve[0][0], curve[curve.len() - 1][0]];
    let ends = points[0][0]..=points[points.len() - 1][0];
    if !motion.values.iter().any(|station| ends.contains(station)) {
        let message = format!(
            "no station of the motion, which {}, is on this curve, which runs from {first} to {last}",
            reach(motion)
        );
        problems.add(place, message);
        return None;
    }
    Some(Wanted::Curve {
        points,
        interpolation,
    })
}

fn wanted_value(
    at: &Number,
    value: &Number,
    unit: Unit,
    context: &Context,
    problems: &mut Problems,
) -> Option<Wanted> {
    let motion = context.motion?;
    let drive = drive_value(motion, at.value);
    let (lowest, highest) = ends(&motion.values);
    if drive < lowest || drive > highest {
        let message = format!(
            "{} is outside of the motion, which {}",
            at.value,
            reach(motion)
        );
        problems.add(at.span.clone(), message);
        return None;
    }
    Some(Wanted::At {
        drive,
        value: unit.from_printed(value.value),
    })
}

/// The drive value a target speaks of: degrees become radians.
fn drive_value(motion: &Motion, written: f64) -> f64 {
    match motion.drive.is_angle() {
        false => written,
        true => written.to_radians(),
    }
}

/// The name of the drive's column in files.
fn drive_column(context: &Context) -> String {
    match context.motion.map(|motion| motion.drive) {
        Some(drive) if drive.is_angle() => format!("{}_deg", drive.key()),
        _ => format!("travel_{}", context.suspension.length_unit.symbol()),
    }
}

fn ends(values: &[f64]) -> (f64, f64) {
    let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (lowest, highest)
}

/// Words for the range of the motion, in the unit of target abscissae.
fn reach(motion: &Motion) -> String {
    let (lowest, highest) = ends(&motion.values);
    let [lowest, highest] = [lowest, highest].map(|value| motion.drive.printed(value));
    match motion.drive.is_angle() {
        false => format!("runs from {lowest} to {highest}"),
        true => format!("runs from {lowest} to {highest} degrees"),
    }
}
