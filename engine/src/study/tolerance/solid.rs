//! Tolerances of the parts of a solid axle: parts that exist only once, and parts of its halves.

use super::super::Contributor;
use super::super::error::Problems;
use crate::model::{Side, Suspension};
use std::ops::Range as Span;

/// Returns true for a part that exists only once. Returns false for a part of a half, or of another vehicle. Refuses a jig
/// that holds parts of both kinds.
pub(super) fn is_single(
    contributor: &Contributor,
    suspension: &Suspension,
    place: Span<usize>,
    problems: &mut Problems,
) -> Option<bool> {
    let all = contributor
        .sources
        .iter()
        .flat_map(|source| &source.changes);
    let mut kinds = all.map(|(parameter, _)| parameter.is_single(&suspension.mechanism));
    let Some(first) = kinds.next() else {
        return Some(false);
    };
    if kinds.any(|kind| kind != first) {
        let message = "a jig holds points of one half of the axle, or unpaired points, not both";
        return problems.refuse(place, message);
    }
    Some(first)
}

/// Removes the tolerance sources of a part from the right wheel. This applies to parts that exist only once per axle, because
/// their sources belong to the left wheel.
pub(super) fn scatter_once(contributor: &mut Contributor, side: Side) {
    if side == Side::Right {
        contributor.sources.clear();
    }
}

/// Stores the dimensions of each source as they are in the mechanism of a solid axle's other wheel.
pub(super) fn note_other_view(contributor: &mut Contributor, suspension: &Suspension) {
    for source in &mut contributor.sources {
        let seen = source.changes.iter().filter_map(|(parameter, share)| {
            let (parameter, sign) = parameter.seen_from_other(&suspension.mechanism)?;
            Some((parameter, sign * share))
        });
        source.seen_from_other = seen.collect();
    }
}
