//! Customs of engineers: tolerances of changes that nobody asked for, and quantities that belong to a target.

use crate::ask::Unit;
use crate::characteristics::Characteristic;
use crate::model::LengthUnit;

/// Millimetres of a length that count as a change.
const LENGTH: f64 = 1.0;

/// Lengths that grow beyond all bounds as links become parallel. An engineer judges them by the curves that they
/// describe, so they have no tolerance of their own.
const UNBOUNDED: [&str; 6] = [
    "front_view_swing_arm",
    "side_view_swing_arm",
    "front_view_centre_lateral",
    "front_view_centre_height",
    "side_view_centre_longitudinal",
    "side_view_centre_height",
];

/// Beginnings of the names of a car's results that grow without bounds in a turn, as the kinematic roll centre does.
const UNBOUNDED_IN_TURNS: [&str; 3] = [
    "roll_centre_height_",
    "roll_centre_lateral_",
    "roll_centre_moment_arm",
];

/// Change of a quantity up to which an engineer does not mind it, in the printed unit: toe 0.05 degrees, camber, roll and pitch
/// 0.1 degrees, caster and inclination of the steering axis 0.2 degrees, lengths 1 mm, the share of the front axle in the
/// load transfer 1 %, roll gradient 0.05 degrees/g. `None` for all others.
pub(super) fn tolerance(name: &str, unit: Unit, length: LengthUnit) -> Option<f64> {
    match (name, unit) {
        ("toe", _) => Some(0.05),
        ("camber" | "camber_to_road" | "roll" | "pitch", _) => Some(0.1),
        ("lateral_load_transfer_distribution", _) => Some(1.0),
        ("roll_gradient", _) => Some(0.05),
        _ if UNBOUNDED_IN_TURNS.iter().any(|of| name.starts_with(of)) => None,
        ("caster" | "kingpin_inclination", _) => Some(0.2),
        (_, Unit::Length) if !UNBOUNDED.contains(&name) => {
            Some(length.convert(LENGTH, LengthUnit::Millimetre))
        }
        _ => None,
    }
}

/// Returns true for a quantity that is judged with the rack at 0. Toe is a steer angle as soon as the wheels are steered;
/// the kinematic roll centre of steered wheels moves without bounds.
pub(super) fn is_judged_straight_ahead(name: &str) -> bool {
    ["toe", "roll_centre_height"].contains(&name)
}

/// The characteristic whose value over travel a gain determines, up to its value in the design position.
pub(super) fn integral_of(gain: Characteristic) -> Option<Characteristic> {
    Some(match gain {
        Characteristic::BumpSteer => Characteristic::Toe,
        Characteristic::CamberGain => Characteristic::Camber,
        Characteristic::CasterGain => Characteristic::Caster,
        Characteristic::KingpinInclinationGain => Characteristic::KingpinInclination,
        Characteristic::MotionRatio => Characteristic::SpringLength,
        Characteristic::AntiRollBarMotionRatio => Characteristic::AntiRollBarAngle,
        _ => return None,
    })
}
