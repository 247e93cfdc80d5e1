//! Geometric measures of `[outputs]`: lengths, plunges, angles of joints, and clearances.

use super::OutputMeasure;
use super::constraints::joint_angle;
use super::error::Problems;
use super::file::{self, File};
use super::resolve::each;
use super::subject::{length, pair};
use crate::characteristics::Measure;
use crate::model::Suspension;
use std::ops::Range;
use toml::Spanned;

/// Position of the first measure in the file. `None` if there are no measures.
pub(super) fn measured(section: &file::Outputs) -> Option<Range<usize>> {
    let lengths = section.lengths.iter().map(Spanned::span);
    let plunges = section.plunges.iter().map(Spanned::span);
    let angles = section.articulations.iter().map(Spanned::span);
    let clearances = section.clearances.iter().map(Spanned::span);
    lengths
        .chain(plunges)
        .chain(angles)
        .chain(clearances)
        .next()
}

/// Reads the measures. `None` if one has an error.
pub(super) fn measures(
    section: &file::Outputs,
    file: &File,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Vec<OutputMeasure>> {
    let measure = |name: String, of: Measure| OutputMeasure { name, of };
    let lengths = each(&section.lengths, |written| {
        let (name, ends) = length(written, suspension, problems)?;
        Some(measure(format!("{name}_length"), Measure::Length(ends)))
    });
    let plunges = each(&section.plunges, |written| {
        let (name, ends) = length(written, suspension, problems)?;
        Some(measure(format!("{name}_plunge"), Measure::Plunge(ends)))
    });
    let angles = each(&section.articulations, |name| {
        let of = joint_angle(name, file, suspension, problems)?;
        Some(measure(format!("{}_articulation", name.get_ref()), of))
    });
    let clearances = each(&section.clearances, |names| {
        let ([a, b], both) = pair(names, "two members", suspension, problems)?;
        Some(measure(
            format!("{a}_to_{b}_clearance"),
            Measure::Clearance(both),
        ))
    });
    let all = [lengths?, plunges?, angles?, clearances?].concat();
    for (number, own) in all.iter().enumerate() {
        let mut characteristics = section.characteristics.iter();
        let is_characteristic = characteristics.any(|text| *text.get_ref() == own.name);
        if is_characteristic || all[..number].iter().any(|other| other.name == own.name) {
            let place = measured(section).unwrap_or_default();
            return problems.refuse(place, format!("{} is requested twice", own.name));
        }
    }
    Some(all)
}
