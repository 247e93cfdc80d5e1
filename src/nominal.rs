//! Targets of the nominal design, also in a study whose tuning improves builds.

use crate::optimise::TargetLayout;
use crate::study::{Optimise, Vehicle};

/// Layout of the targets of the nominal design alone. The layout of a robust study has the rows of all its builds. An evaluation
/// of the nominal design must not use that layout: it fills the rows of one build, and its misfit is divided by the number of all
/// rows.
pub fn nominal_targets(optimise: &Optimise, vehicle: &Vehicle) -> TargetLayout {
    let nominal = Optimise {
        scatter: None,
        ..optimise.clone()
    };
    TargetLayout::of(&nominal, vehicle)
}
