//! Misfit, deviations from targets, and hardpoints of a design, for its report page.

use super::message::Misfit;
use crate::report::{Cell, PageDesign, Table, brief};

/// A named point with its coordinates in the study's axes.
pub(super) type NamedPoint<'a> = (&'a str, [f64; 3]);

/// Makes the first section of a report page. `unit` is the symbol of the study's length unit. `found` is the
/// misfit of the design, or `None` without targets.
pub(super) fn page_design<'a>(
    points: impl Iterator<Item = NamedPoint<'a>>,
    unit: &str,
    found: Option<&Misfit>,
) -> PageDesign {
    let axes = ["x", "y", "z"].map(|axis| format!("{axis} [{unit}]"));
    let mut hardpoints = Table::with_columns(["point".to_owned()].into_iter().chain(axes));
    for (name, place) in points {
        hardpoints.push_row([Cell::from(name)].into_iter().chain(place.map(Cell::from)));
    }
    let mut targets = Table::new(["target", "rms", "largest", "at"]);
    for target in found.iter().flat_map(|found| &found.targets) {
        let at = target.worst_at.map_or(String::new(), |at| brief(at) + " ");
        targets.push([
            Cell::from(target.column.as_str()),
            Cell::by(target.rms, brief),
            Cell::by(target.worst, brief),
            Cell::from(at + &target.worst_at_unit),
        ]);
    }
    let mut constraints = Table::new(["constraint", "margin", "unit"]);
    for own in found.iter().flat_map(|found| &found.constraints) {
        constraints.push([
            Cell::from(own.name.as_str()),
            Cell::by(own.margin, brief),
            Cell::from(own.unit.as_str()),
        ]);
    }
    PageDesign {
        misfit: found.and_then(|found| found.value),
        verdict: found.map(Misfit::verdict),
        targets: (!targets.is_empty()).then_some(targets),
        constraints: (!constraints.is_empty()).then_some(constraints),
        hardpoints,
    }
}
