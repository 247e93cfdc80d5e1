//! Set-up of a solid axle: adjustments of its halves and of its single parts, and target values of the whole axle.

use super::super::AxleStudy;
use super::super::axle::{lacks_nothing, quantities};
use super::{Adjustment, Problems, Static, Want, file};
use crate::ask::Need;
use crate::assembly::BuildParameter;
use crate::axle::{AxleQuantity, Quantity};
use crate::model::{Side, Suspension};
use crate::number::Each;
use crate::study::names::choose;
use toml::Spanned;

/// Adjustments of an entry: one of each half, or one of a part that exists only once.
pub(super) fn adjustments(
    written: &Spanned<file::Adjustment>,
    both: &AxleStudy,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Vec<Adjustment>> {
    let sides = Side::ALL.each(|side| (side.name(), side));
    let side = &written.get_ref().side;
    let only = match side {
        None => None,
        Some(text) => Some(choose(text, "side", &sides, problems)?),
    };
    let mut found = Vec::new();
    for side in Side::ALL {
        if only.is_some_and(|only| only != side) {
            continue;
        }
        // Uses the left wheel's axes, because amounts of the right half are those of its mirror image.
        let of_side = Suspension {
            frame: suspension.frame,
            ..both.axle.suspension(side).clone()
        };
        let mut own = super::adjustment(written, &of_side, problems)?;
        let (parameter, share) = own.change;
        holds_no_spring(parameter, &of_side, written, problems)?;
        let mechanism = &of_side.mechanism;
        let seen = parameter.seen_from_other(mechanism);
        own.seen_from_other = seen.map(|(parameter, sign)| (parameter, sign * share));
        if parameter.is_single(mechanism) {
            if let Some(text) = &written.get_ref().side {
                let message = format!("the axle has only one {}: leave side out", own.name);
                return problems.refuse(text.span(), message);
            }
            return Some(vec![own]);
        }
        own.side = Some(side);
        own.name = format!("{} {}", side.name(), own.name);
        found.push(own);
    }
    Some(found)
}

/// Refuses shims at a spring seat, because they would lift one side of the car.
fn holds_no_spring(
    parameter: BuildParameter,
    suspension: &Suspension,
    written: &Spanned<file::Adjustment>,
    problems: &mut Problems,
) -> Option<()> {
    let BuildParameter::Coordinate(id, _) = parameter else {
        return Some(());
    };
    let spring = suspension.mechanism.spring;
    if spring.is_none_or(|spring| id != spring.upper && id != spring.lower) {
        return Some(());
    }
    let message = "the seats of a solid axle's springs cannot be adjusted yet; ride_height_change \
                   gives the change of the ride height";
    problems.refuse(written.span(), message)
}

/// Target values of the axle, in the order of the catalogue. A target for a quantity of a wheel applies to both wheels.
pub(super) fn want(
    section: &file::Setup,
    both: &AxleStudy,
    problems: &mut Problems,
) -> Option<Vec<Want>> {
    let axle = &both.axle;
    let names = axle.quantity_names();
    let mut want = Vec::new();
    for (name, number) in section.want.iter().flatten() {
        let of_name = quantities(name, axle, problems)?;
        let place = names.iter().position(|own| own == name.get_ref());
        for quantity in of_name {
            if !lacks_nothing(name, quantity, axle, problems) {
                return None;
            }
            if let Some(reason) = no_static_value(quantity) {
                let message = format!("{} {reason}", name.get_ref());
                return problems.refuse(name.span(), message);
            }
            let (of, value) = (Static::Axle(quantity), number.value);
            want.push((place, Want { of, value }));
        }
    }
    want.sort_by_key(|(place, _)| *place);
    Some(want.into_iter().map(|(_, want)| want).collect())
}

/// Reason why a quantity has no static value that adjustments could set.
fn no_static_value(quantity: Quantity) -> Option<&'static str> {
    let sprung = [
        Need::SpringForce,
        Need::Springs,
        Need::BarRate,
        Need::TyreRate,
    ];
    if quantity
        .info()
        .needs
        .iter()
        .any(|need| sprung.contains(need))
    {
        return Some(
            "contains the forces of springs or bars, and a set-up depends on geometry only; leave \
             it out",
        );
    }
    let is_zero = [AxleQuantity::TrackChange, AxleQuantity::RollAngle]
        .each(Quantity::Axle)
        .contains(&quantity);
    is_zero.then_some("is always 0 in the static position; leave it out")
}
