//! Warnings about the targets of a tuning.

use crate::report::figure::brief;
use crate::report::ranges::ends;
use crate::study::{DriveRounding, Limit, Study, Target, Wanted};

/// Largest plausible span of a target's points, relative to the span of the motion.
const SPAN: f64 = 4.0;

/// Warnings about targets whose points are partly outside of the motion, one per line. The part of a target outside of the
/// motion has no effect.
pub(super) fn target_doubts(study: &Study) -> Vec<String> {
    let targets = study.optimise.iter().flat_map(|o| &o.targets);
    targets
        .filter_map(|target| beyond_motion(study, target))
        .collect()
}

fn beyond_motion(study: &Study, target: &Target) -> Option<String> {
    let curve = |limit: &Option<Limit>| match limit {
        Some(Limit::Curve { points, .. }) => points.clone(),
        _ => Vec::new(),
    };
    let points = match &target.wanted {
        Wanted::Curve { points, .. } => points.clone(),
        Wanted::Band { lower, upper, .. } => [curve(lower), curve(upper)].concat(),
        Wanted::At { .. } | Wanted::Points(_) => return None,
    };
    let (drive, length) = (study.motion().drive, study.wheel().length_unit);
    let values = match (&target.site.axle, &target.site.motion) {
        (Some(site), _) => &site.values,
        (None, Some((_, motion))) => &motion.values,
        (None, None) => &study.motion().values,
    };
    let own = ends(points.iter().map(|[at, _]| *at))?;
    let moved = ends(values.iter().copied())?;
    let width = |[low, high]: [f64; 2]| high - low;
    let rounding = DriveRounding::of(values);
    let is_inside = own.iter().all(|end| rounding.is_within(*end, moved));
    if is_inside || width(moved) == 0.0 {
        return None;
    }
    let range = |ends: [f64; 2]| {
        let [low, high] = ends.map(|end| brief(target.printed_at(drive, end)));
        format!("{low} to {high}")
    };
    let unit = target.unit_at(drive, length);
    let (name, own_range, moved_range) = (&target.of.column, range(own), range(moved));
    Some(if width(own) > SPAN * width(moved) {
        format!(
            "please check: the points of the target {name} run from {own_range} {unit}, its motion only from \
             {moved_range} {unit}. Are they in another unit?"
        )
    } else {
        format!(
            "the points of the target {name} run from {own_range} {unit}, its motion from {moved_range} {unit}: the \
             part outside of the motion has no effect"
        )
    })
}
