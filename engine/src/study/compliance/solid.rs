//! Elastic parts of a solid axle: parts of both halves, and parts that exist only once, such as a Panhard rod.

use super::super::error::Problems;
use super::super::file;
use super::super::value::Text;
use super::WheelParts;
use crate::compliance::{LinkMember, LinkPart};
use crate::model::Mechanism;
use crate::sorting::sort_by_key;

fn is_single_link(mechanism: &Mechanism, part: &LinkPart) -> bool {
    match part.member {
        LinkMember::Rod { inner, .. } => mechanism.is_single(inner),
        LinkMember::RockerRod(_) => false,
    }
}

impl WheelParts {
    /// Moves the parts that exist only once to the end. Then the other parts have the same indices in both halves.
    pub(super) fn order(&mut self, mechanism: &Mechanism) {
        sort_by_key(&mut self.bushings, |part| mechanism.is_single(part.point));
        sort_by_key(&mut self.links, |(_, part)| is_single_link(mechanism, part));
    }

    /// Removes the parts that exist only once. They belong to the left half.
    pub(super) fn remove_singles(&mut self, mechanism: &Mechanism) {
        self.bushings
            .retain(|part| !mechanism.is_single(part.point));
        self.links
            .retain(|(_, part)| !is_single_link(mechanism, part));
    }
}

/// Refuses rates of the right half for a part that exists only once. Returns true if there are no such rates.
pub(super) fn refuse_single_rates(
    own: &file::OwnRight,
    mechanism: &Mechanism,
    problems: &mut Problems,
) -> bool {
    let once = |name: &&Text| {
        let ends = ["", "_chassis"].map(|end| format!("{}{end}", name.get_ref()));
        let mut ends = ends.iter().filter_map(|name| mechanism.point(name));
        ends.any(|id| mechanism.is_single(id))
    };
    let names = own.bushings.keys().chain(own.links.keys());
    let found: Vec<&Text> = names.filter(once).collect();
    for name in &found {
        let message = format!(
            "the axle has only one {}: expected its rates in [bushings] or [links] only",
            name.get_ref()
        );
        problems.add(name.span(), message);
    }
    found.is_empty()
}
