//! Names of the quantities of an axle.

use super::super::error::Problems;
use super::super::names::choose;
use super::super::untested;
use super::super::value::Text;
use crate::axle::{Axle, AxleKind, Quantity};

/// All quantities of an axle with this name. Quantities of the two wheels share a name. `None` if the axle has no quantity
/// of this name.
pub(in super::super) fn quantities(
    text: &Text,
    axle: &Axle,
    problems: &mut Problems,
) -> Option<Vec<Quantity>> {
    let names = axle.quantity_names();
    let what = "quantity of an axle";
    let known = || names.iter().map(|name| &**name);
    if let Some(elastic) = &axle.elastic
        && untested::refuses(text, what, known, &elastic.tests, problems)
    {
        return None;
    }
    let names: Vec<_> = names.iter().map(|name| (&**name, &**name)).collect();
    let name = choose(text, what, &names, problems)?;
    let found = axle.quantities(name);
    if found.is_empty() {
        let of = |kind: AxleKind| Quantity::named(name).iter().any(|q| q.is_of(kind));
        let needs = match (
            of(AxleKind::Independent),
            of(AxleKind::SteeredSolid),
            of(AxleKind::Solid),
        ) {
            (true, true, _) => "independently suspended wheels, or a drag link",
            (true, false, _) => "independently suspended wheels",
            (_, _, true) => "a solid axle",
            _ => "a twist beam",
        };
        let message = match axle.kind() {
            AxleKind::Independent => {
                format!("{name} needs {needs}; these wheels are suspended independently")
            }
            AxleKind::Solid | AxleKind::SteeredSolid => {
                format!("{name} needs {needs}; this is a solid axle")
            }
            AxleKind::TwistBeam => format!("{name} needs {needs}; this is a twist beam"),
        };
        return problems.refuse(text.span(), message);
    }
    Some(found)
}
