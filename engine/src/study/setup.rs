//! `[setup]`: adjustments and target values.

mod whole;

use super::axle::is_in_equilibrium;
use super::elastic_targets::in_equilibrium;
use super::error::Problems;
use super::file;
use super::members::{coordinate, member};
use super::outputs::characteristic;
use super::resolve::Context;
use super::suspension::positive;
use super::value::Text;
use super::{Adjustment, Increment, Setup, Want};
use crate::assembly::{BuildParameter, Static};
use crate::axle::Quantity;
use crate::characteristics::Characteristic;
use crate::model::Suspension;
use crate::sorting::sort_by_key;
use toml::Spanned;

/// Reads the set-up. `None` if it has an error.
pub(super) fn setup(
    section: &file::Setup,
    context: &Context,
    problems: &mut Problems,
) -> Option<Setup> {
    let written = section.adjust.get_ref();
    if written.is_empty() {
        let message = "expected at least one adjustment, found an empty list";
        problems.add(section.adjust.span(), message);
    }
    let whole = context.axle.filter(|both| both.axle.is_set_up_as_a_whole());
    let mut adjust: Vec<(usize, Adjustment)> = Vec::new();
    let mut sound = true;
    for (number, entry) in written.iter().enumerate() {
        let own = match whole {
            Some(both) => whole::adjustments(entry, both, context.suspension, problems),
            None => adjustment_of_wheel(entry, context, problems).map(|one| vec![one]),
        };
        sound &= own.is_some();
        for adjustment in own.into_iter().flatten() {
            let same = |(_, other): &&(usize, Adjustment)| {
                (other.side, other.change.0) == (adjustment.side, adjustment.change.0)
            };
            if let Some((first, _)) = adjust.iter().find(same) {
                let message = format!("{} is already adjusted", adjustment.name);
                let error = problems.add(entry.span(), message);
                error.related(written[*first].span(), "here");
            }
            adjust.push((number, adjustment));
        }
    }
    let want = match whole {
        Some(both) => whole::want(section, both, problems)?,
        None => want_of_wheel(section, context, problems)?,
    };
    let adjust: Vec<_> = adjust
        .into_iter()
        .map(|(_, adjustment)| adjustment)
        .collect();
    Some(Setup {
        adjust: Some(adjust).filter(|adjust| sound && !adjust.is_empty())?,
        want,
        ride_height_change: ride_height_change(section, problems),
    })
}

/// Target values of one wheel.
fn want_of_wheel(
    section: &file::Setup,
    context: &Context,
    problems: &mut Problems,
) -> Option<Vec<Want>> {
    let mut want = Vec::new();
    for (name, number) in section.want.iter().flatten() {
        if context.axle.is_some() && is_of_axle_only(name.get_ref()) {
            return refuse_axle_value(name, problems);
        }
        let found = characteristic(name, context.suspension, problems)?;
        if context.is_elastic() {
            in_equilibrium(name, found, context.suspension, problems)?;
        }
        want.push((found, number.value));
    }
    if let Some(both) = context.axle {
        let sound = section.want.iter().flatten().all(|(name, _)| {
            let of_name = both.axle.quantities(name.get_ref());
            let mut of_name = of_name.into_iter();
            of_name.all(|quantity| is_in_equilibrium(name, quantity, &both.axle, problems))
        });
        sound.then_some(())?;
    }
    // Sorts by the order of the catalogue, so that the order in the file does not matter.
    sort_by_key(&mut want, |(characteristic, _)| *characteristic);
    let want = want.into_iter().map(|(characteristic, value)| Want {
        of: Static::Characteristic(characteristic),
        value,
    });
    Some(want.collect())
}

/// Returns true for a quantity that describes both wheels of an axle.
fn is_of_axle_only(name: &str) -> bool {
    let mut of_wheel = Characteristic::ALL.iter().map(|c| c.info().name);
    Quantity::names().contains(&name) && !of_wheel.any(|own| own == name)
}

/// Refuses a target value that describes both wheels of an axle whose wheels are set up one by one.
fn refuse_axle_value(name: &Text, problems: &mut Problems) -> Option<Vec<Want>> {
    let name_of = name.get_ref();
    let message =
        format!("{name_of} describes both wheels, but [setup] has target values of each wheel");
    let help = match name_of.strip_prefix("total_") {
        Some(of_wheel) => {
            format!("give half of {name_of} as {of_wheel}: the value applies to each wheel")
        }
        None => "give values of one wheel, such as toe, camber or caster".to_owned(),
    };
    problems.add(name.span(), message).help(help);
    None
}

/// Reads an adjustment of one wheel, or of both wheels of an axle if its wheels are independent.
fn adjustment_of_wheel(
    written: &Spanned<file::Adjustment>,
    context: &Context,
    problems: &mut Problems,
) -> Option<Adjustment> {
    if let Some(side) = &written.get_ref().side {
        let message = "the key \"side\" is for axles that are set up as a whole: solid axles, and axles with elastic parts and wheels that differ. \
                       Here each adjustment applies to every wheel: remove the key \"side\"";
        return problems.refuse(side.span(), message);
    }
    adjustment(written, context.suspension, problems)
}

/// Target change of the ride height: the written change, or the written travel with the opposite sign.
fn ride_height_change(section: &file::Setup, problems: &mut Problems) -> Option<f64> {
    match (&section.ride_height_change, &section.travel) {
        (Some(change), Some(travel)) => {
            let message = "expected ride_height_change or travel, found both: ride_height_change \
                           is positive if the car becomes higher, travel is its negative";
            let error = problems.add(travel.span.clone(), message);
            error.related(change.span.clone(), "ride_height_change");
            None
        }
        (Some(change), None) => Some(change.value),
        (None, Some(travel)) => Some(0.0 - travel.value),
        (None, None) => None,
    }
}

fn adjustment(
    written: &Spanned<file::Adjustment>,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Adjustment> {
    let place = written.span();
    let written = written.get_ref();
    let per_turn = positive(&written.per_turn, problems);
    let step = positive(&written.step, problems);
    let (name, change) = match (&written.length, &written.shim) {
        (Some(length), None) => {
            if let Some(axis) = &written.axis {
                problems.add(
                    axis.span(),
                    "a length has no axis: it changes along the member",
                );
            }
            let (name, member) = member(length, suspension, problems)?;
            (name, (BuildParameter::Length(member), 1.0))
        }
        (None, Some(shim)) => {
            let Some(axis) = &written.axis else {
                let message = "expected the key \"axis\", along which the shim moves the point: \"x\", \"y\" or \"z\"";
                return problems.refuse(place, message);
            };
            let change = coordinate(shim, axis, suspension, problems)?;
            (format!("{} {}", shim.get_ref(), axis.get_ref()), change)
        }
        (Some(length), Some(_)) => {
            return problems.refuse(length.span(), "expected \"length\" or \"shim\", found both");
        }
        (None, None) => {
            let message = "expected length = \"tie_rod\", or shim = \"upper_ball_joint\" with axis";
            return problems.refuse(place, message);
        }
    };
    if let (Some(per_turn), Some(_)) = (&written.per_turn, &written.step) {
        let message = "expected \"per_turn\" (thread) or \"step\" (shims), found both";
        problems.add(per_turn.span.clone(), message);
    }
    let increment = match (per_turn?, step?) {
        (Some(per_turn), _) => Increment::Thread { per_turn },
        (None, Some(step)) => Increment::Shims { step },
        (None, None) => Increment::Free,
    };
    Some(Adjustment {
        name,
        change,
        side: None,
        seen_from_other: None,
        increment,
    })
}
