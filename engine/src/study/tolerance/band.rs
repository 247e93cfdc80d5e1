//! Bands of `[tolerance]`.

use super::super::drive_rounding::{DriveRounding, ends};
use super::super::elastic_targets;
use super::super::error::Problems;
use super::super::outputs::characteristic;
use super::super::resolve::Context;
use super::super::{Band, TargetQuantity, axle_targets, file};
use crate::number::Each;
use toml::Spanned;

pub(super) fn band(
    spanned: &Spanned<file::Band>,
    context: &Context,
    problems: &mut Problems,
) -> Option<Band> {
    let place = spanned.span();
    let written = spanned.get_ref();
    let length = context.suspension.length_unit;
    let of = match context.axle {
        Some(axle) => axle_targets::band(spanned, axle, context, problems),
        None => {
            axle_targets::Where::from(written).refuse(true, problems);
            if let Some(motion) = &written.motion {
                let message =
                    "a band of one wheel applies to [motion]; a named motion needs [axle]";
                problems
                    .add(motion.span(), message)
                    .help("include its stations in [motion], or add [axle]");
            }
            let name = &written.characteristic;
            let found = match context.elastic {
                Some(elastic) => {
                    elastic_targets::quantity(name, elastic, context.suspension, problems)
                        .map(|found| found.subject(length))
                }
                // Errors in the elastic parts are already reported.
                None if context.file.compliance.is_some() => None,
                None => characteristic(name, context.suspension, problems)
                    .map(|found| TargetQuantity::characteristic(found, length)),
            };
            found.map(|subject| (subject, None))
        }
    };
    let site = of.as_ref().and_then(|(_, site)| site.as_ref());
    let values = match (site, context.axle) {
        (Some(site), _) => Some(&site.values),
        (None, None) => context.motion.map(|motion| &motion.values),
        // Errors in the stations are already reported.
        (None, Some(_)) => None,
    };
    let at = match (&written.at, values) {
        (None, _) => Some(None),
        (Some(at), Some(values)) => {
            let [lowest, highest] = ends(values);
            if !DriveRounding::of(values).is_within(at.value, [lowest, highest]) {
                let message = format!(
                    "{} is outside of the motion, which runs from {lowest} to {highest}",
                    at.value
                );
                problems.refuse(at.span.clone(), message)
            } else {
                Some(Some(at.value))
            }
        }
        (Some(_), None) => None,
    };
    let rows = site.filter(|site| site.held.has_rows());
    if let (Some(site), Some(at)) = (rows, &written.at)
        && !DriveRounding::of(&site.values).is_among(at.value, &site.values)
    {
        let message = format!("no row of the motion has {}", at.value);
        return problems.refuse(at.span.clone(), message);
    }
    let ends = match (&written.between, &written.at_least, &written.at_most) {
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
    };
    let (of, site) = of?;
    Some(Band {
        at: at?,
        between: ends?.each(|end| of.from_printed(end)),
        of,
        site,
    })
}
