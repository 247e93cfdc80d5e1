//! Set-up of an axle as a whole: adjustments of its halves and of parts that exist only once, and target values of the axle.
//! The axle is solid, or it has elastic parts and different wheels.

use super::super::AxleStudy;
use super::super::axle::{lacks_nothing, quantities};
use super::super::elastic_targets::in_equilibrium;
use super::{Adjustment, Problems, Static, Want, file};
use crate::ask::Need;
use crate::assembly::BuildParameter;
use crate::axle::{AxleQuantity, Quantity};
use crate::model::{Mechanism, Side, Suspension};
use crate::number::Each;
use crate::sorting::sort_by_key;
use crate::study::names::choose;
use toml::Spanned;

/// Adjustments that an element of `adjust` describes: one for each half, or one for a part that exists only once.
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
        // Uses the axes of the left wheel, because adjustments of the right half are given for the mirror image of that
        // half.
        let of_side = Suspension {
            frame: suspension.frame,
            ..both.axle.suspension(side).clone()
        };
        let mut own = super::adjustment(written, &of_side, problems)?;
        let (parameter, share) = own.change;
        let mechanism = &of_side.mechanism;
        if own.lifts(mechanism) || holds_spring(parameter, mechanism) {
            let message = if both.axle.is_rigid() {
                "the seats of a solid axle's springs cannot be adjusted yet; use \
                 ride_height_change to give the height at which the car stands"
            } else {
                "this adjustment lifts one side of an axle whose wheels differ, which elastic \
                 parts do not allow yet; use ride_height_change to give the height at which the \
                 car stands"
            };
            return problems.refuse(written.span(), message);
        }
        let seen = parameter.seen_from_other(mechanism);
        own.seen_from_other = seen.map(|(parameter, sign)| (parameter, sign * share));
        if parameter.is_single(mechanism) {
            if let Some(text) = &written.get_ref().side {
                let message = format!(
                    "the axle has only one {}: remove the key \"side\"",
                    own.name
                );
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

/// Returns true if `parameter` is a coordinate of an end of the spring.
fn holds_spring(parameter: BuildParameter, mechanism: &Mechanism) -> bool {
    let BuildParameter::Coordinate(id, _) = parameter else {
        return false;
    };
    let seats = mechanism.spring.map(|spring| [spring.upper, spring.lower]);
    seats.is_some_and(|seats| seats.contains(&id))
}

/// Target values of the axle, in the order of the catalogue. A target for a wheel quantity applies to both wheels.
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
            if let (Quantity::Corner(_, of), true) = (quantity, axle.elastic.is_some()) {
                in_equilibrium(name, of, &axle.left, problems)?;
            }
            if let Some(reason) = no_static_value(quantity) {
                let message = format!("{} {reason}", name.get_ref());
                return problems.refuse(name.span(), message);
            }
            let (of, value) = (Static::Axle(quantity), number.value);
            want.push((place, Want { of, value }));
        }
    }
    sort_by_key(&mut want, |(place, _)| *place);
    Some(want.into_iter().map(|(_, want)| want).collect())
}

/// Reason why a quantity has no static value that adjustments could set.
fn no_static_value(quantity: Quantity) -> Option<&'static str> {
    if let Quantity::Figure(_) = quantity {
        return Some(
            "is a result of a test, but a set-up adjusts static values only; tune it with [optimise]",
        );
    }
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
