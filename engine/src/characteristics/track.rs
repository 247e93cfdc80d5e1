//! Displacements from the design position.

use super::{Inputs, Need, Slot, Unit, formulas};
use crate::number::{Real, Vector3};

const CONTACT: &[Slot] = &[
    Slot::SpinAxis,
    Slot::Centre,
    Slot::DesignSpinAxis,
    Slot::DesignCentre,
];

#[inline(always)]
fn contact_displacement<T: Real>(inputs: &Inputs<T>) -> Vector3<T> {
    inputs.contact_point() - inputs.design.contact_point(inputs.constants.wheel_radius)
}

formulas! {
    /// Sideways displacement of the contact point.
    HalfTrackChange {
        name: "half_track_change",
        unit: Unit::Length,
        positive: "track wider than in the design position",
        formula: "C_y - C_y(design)",
        source: "track change of ISO 8855, for one wheel",
        reads: CONTACT,
        needs: &[Need::WheelRadius],
    } = |inputs| contact_displacement(inputs).y;

    /// Longitudinal displacement of the contact point.
    WheelbaseChange {
        name: "wheelbase_change",
        unit: Unit::Length,
        positive: "contact point forward of its design position",
        formula: "C_x - C_x(design)",
        source: "wheelbase change of ISO 8855, for one wheel",
        reads: CONTACT,
        needs: &[Need::WheelRadius],
    } = |inputs| contact_displacement(inputs).x;
}
