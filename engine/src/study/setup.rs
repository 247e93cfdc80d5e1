//! `[setup]`: adjustments and target values.

use super::error::Problems;
use super::file;
use super::members::{coordinate, member};
use super::outputs::characteristic;
use super::resolve::Context;
use super::suspension::positive;
use super::{Adjustment, Increment, Setup, Want};
use crate::assembly::BuildParameter;
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
    let adjust: Vec<_> = written
        .iter()
        .map(|a| adjustment(a, context, problems))
        .collect();
    for (i, adjustment) in adjust.iter().enumerate() {
        let Some(adjustment) = adjustment else {
            continue;
        };
        let same = |other: &Option<Adjustment>| {
            other
                .as_ref()
                .is_some_and(|o| o.change.0 == adjustment.change.0)
        };
        if let Some(first) = adjust[..i].iter().position(same) {
            let message = format!("{} is already adjusted", adjustment.name);
            let error = problems.add(written[i].span(), message);
            error.related(written[first].span(), "here");
        }
    }
    let mut want = Vec::new();
    for (name, number) in section.want.iter().flatten() {
        let found = characteristic(name, context.suspension, problems)?;
        want.push(Want {
            characteristic: found,
            value: found
                .info()
                .unit
                .from_printed(number.value, context.suspension.length_unit),
        });
    }
    // Sorts by the order of the catalogue, whatever their order in the file.
    want.sort_by_key(|want| want.characteristic);
    Some(Setup {
        adjust: adjust
            .into_iter()
            .collect::<Option<_>>()
            .filter(|a: &Vec<_>| !a.is_empty())?,
        want,
        ride_height_change: ride_height_change(section, problems),
    })
}

/// Target change of the ride height: as written, or the negative of the written travel.
fn ride_height_change(section: &file::Setup, problems: &mut Problems) -> Option<f64> {
    match (&section.ride_height_change, &section.travel) {
        (Some(change), Some(travel)) => {
            let message = "expected ride_height_change or travel, found both: ride_height_change is positive where \
                           the car becomes higher, travel is its negative";
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
    context: &Context,
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
            let (name, member) = member(length, context.suspension, problems)?;
            (name, (BuildParameter::Length(member), 1.0))
        }
        (None, Some(shim)) => {
            let Some(axis) = &written.axis else {
                let message =
                    "expected axis, along which the shim moves the point: \"x\", \"y\" or \"z\"";
                return problems.refuse(place, message);
            };
            let change = coordinate(shim, axis, context.suspension, problems)?;
            (format!("{} {}", shim.get_ref(), axis.get_ref()), change)
        }
        (Some(length), Some(_)) => {
            return problems.refuse(length.span(), "expected length or shim, found both");
        }
        (None, None) => {
            let message = "expected length = \"tie_rod\", or shim = \"upper_ball_joint\" with axis";
            return problems.refuse(place, message);
        }
    };
    if let (Some(per_turn), Some(_)) = (&written.per_turn, &written.step) {
        let message = "expected per_turn, of a thread, or step, of shims, found both";
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
        increment,
    })
}
