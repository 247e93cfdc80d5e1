//! Bands of `[tolerance]`.

use super::super::drive_rounding::{DriveRounding, ends};
use super::super::elastic_targets;
use super::super::error::Problems;
use super::super::outputs::characteristic;
use super::super::resolve::Context;
use super::super::value::Number;
use super::super::{Band, Drive, TargetQuantity, axle_targets, file};
use crate::number::Each;
use std::ops::Range as Span;
use toml::Spanned;

/// Reads a band: its quantity, the stations at which it applies, and its limits.
pub(super) fn band(
    spanned: &Spanned<file::Band>,
    context: &Context,
    problems: &mut Problems,
) -> Option<Band> {
    let written = spanned.get_ref();
    let of = match context.axle {
        Some(axle) => axle_targets::band(spanned, axle, context, problems),
        None => quantity_of_wheel(written, context, problems).map(|of| (of, None)),
    };
    let site = of.as_ref().and_then(|(_, site)| site.as_ref());
    let values = match (site, context.axle) {
        (Some(site), _) => Some(&site.values),
        // This is a band of one wheel without its own stations. `[tolerance]` already refuses a motion whose drive is not the
        // travel. So the band's drive value is checked only if the drive is the travel.
        (None, None) => {
            let motion = context
                .motion
                .filter(|motion| motion.drive == Drive::Travel);
            motion.map(|motion| &motion.values)
        }
        // Errors in the stations are already reported.
        (None, Some(_)) => None,
    };
    let at = match (&written.at, values) {
        (None, _) => Some(None),
        (Some(at), Some(values)) => drive_value(at, values, problems).map(Some),
        (Some(_), None) => None,
    };
    let rows = site.filter(|site| site.held.has_rows());
    if let (Some(site), Some(at)) = (rows, &written.at)
        && !DriveRounding::of(&site.values).is_among(at.value, &site.values)
    {
        let message = format!("no row of the motion has {}", at.value);
        return problems.refuse(at.span.clone(), message);
    }
    let limits = limits(written, spanned.span(), problems);
    let (of, site) = of?;
    Some(Band {
        at: at?,
        between: limits?.each(|end| of.from_printed(end)),
        of,
        site,
    })
}

/// Reads the quantity of a band of one wheel.
fn quantity_of_wheel(
    written: &file::Band,
    context: &Context,
    problems: &mut Problems,
) -> Option<TargetQuantity> {
    axle_targets::Where::from(written).refuse(true, problems);
    if let Some(motion) = &written.motion {
        let message = "a band of one wheel applies to [motion]; a named motion needs [axle]";
        problems
            .add(motion.span(), message)
            .help("include its stations in [motion], or add [axle]");
    }
    let (name, length) = (&written.characteristic, context.suspension.length_unit);
    match context.elastic {
        Some(elastic) => elastic_targets::quantity(name, elastic, context.suspension, problems)
            .map(|found| found.subject(length)),
        // Errors in the elastic parts are already reported.
        None if context.file.compliance.is_some() => None,
        None => characteristic(name, context.suspension, problems)
            .map(|found| TargetQuantity::characteristic(found, length)),
    }
}

/// Reads the only drive value at which a band applies. It must be within the motion, which has the drive values `values`.
fn drive_value(at: &Number, values: &[f64], problems: &mut Problems) -> Option<f64> {
    let [lowest, highest] = ends(values);
    if DriveRounding::of(values).is_within(at.value, [lowest, highest]) {
        return Some(at.value);
    }
    let message = format!(
        "{} is outside of the motion, which runs from {lowest} to {highest}",
        at.value
    );
    problems.refuse(at.span.clone(), message)
}

/// Reads the lowest and the highest allowed value. Without one of them, the band has no limit on this side.
fn limits(written: &file::Band, place: Span<usize>, problems: &mut Problems) -> Option<[f64; 2]> {
    match (&written.between, &written.at_least, &written.at_most) {
        (Some(between), None, None) => match between.get_ref().as_slice() {
            [low, high] if low.value < high.value => Some([low.value, high.value]),
            _ => {
                let message = "expected between = [lowest, highest], the first below the second";
                problems.refuse(between.span(), message)
            }
        },
        (None, Some(low), None) => Some([low.value, f64::INFINITY]),
        (None, None, Some(high)) => Some([f64::NEG_INFINITY, high.value]),
        _ => {
            let message = "expected one of between = [lowest, highest], at_least and at_most";
            problems.refuse(place, message)
        }
    }
}
