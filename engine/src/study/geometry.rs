//! Errors in the geometry, each with its position in the file and a remedy.

use super::error::Problems;
use super::file;
use super::value::Text;
use crate::mechanism::GeometryFault;
use crate::model::Suspension;
use std::ops::Range as Span;

/// Reports errors of the geometry. `None` if there are any errors. Only errors of one kind are reported, because errors of
/// other kinds may follow from them.
pub(super) fn check(
    section: &file::Suspension,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<()> {
    let faults = GeometryFault::all_of(suspension);
    for fault in &faults {
        add(section, fault, problems);
    }
    faults.is_empty().then_some(())
}

/// Position in the file at which a hardpoint is named.
fn place(section: &file::Suspension, name: &str) -> Span<usize> {
    let hardpoints = &section.hardpoints;
    let mut names = hardpoints.get_ref().keys();
    let text = names.find(|text| text.get_ref() == name);
    text.map_or(hardpoints.span(), Text::span)
}

fn add(section: &file::Suspension, fault: &GeometryFault, problems: &mut Problems) {
    let message = fault.to_string();
    match fault {
        GeometryFault::Coincident { first, second, .. } => {
            let error = problems.add(place(section, second), message);
            error.related(place(section, first), "the same place");
        }
        GeometryFault::ArmInLine { outer, .. } => {
            problems.add(place(section, outer), message);
        }
        GeometryFault::LeverInLine { inner, .. } | GeometryFault::LeverAtToggle { inner, .. } => {
            problems.add(place(section, inner), message);
        }
        GeometryFault::ImplausibleSize { .. } => {
            let written = section.length_unit.as_ref();
            let place = written.map_or(section.hardpoints.span(), Text::span);
            let help =
                "length_unit is the unit of every length in the file: \"mm\", \"m\" or \"in\"";
            problems.add(place, message).help(help);
        }
        GeometryFault::WrongSide { wheel_centre } => {
            let help = "side and frame must fit the coordinates: a left wheel has positive y in \
                        \"iso8855\", negative y in \"sae_j670\" and \"x_rear\"";
            let error = problems.add(place(section, wheel_centre), message);
            error.help(help);
        }
    }
}
