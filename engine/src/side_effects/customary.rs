//! Customary tolerances for changes that no target requests. Also lists the quantities that follow from a target for
//! another quantity.

use crate::ask::Unit;
use crate::characteristics::Characteristic;
use crate::model::{LengthUnit, Suspension};

/// Smallest relevant change of a length, in mm.
const LENGTH: f64 = 1.0;
/// Smallest relevant change of toe at the rim, in mm: 0.05 degrees at a rim of 340 mm.
const TOE_AT_RIM: f64 = 0.3;
/// Smallest relevant change of a turning circle, as a share of its value. The tolerance is a share, because a turning
/// circle becomes infinitely large near straight ahead.
const TURNING_CIRCLE: f64 = 0.01;

/// Customary tolerance of a change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tolerance {
    /// A fixed tolerance, in the printed unit of the quantity.
    Fixed(f64),
    /// A tolerance that is this share of the value before the tuning.
    Share(f64),
}

impl Tolerance {
    /// Returns the tolerance in the printed unit. `before` is the value before the tuning.
    pub(super) fn of(self, before: f64) -> f64 {
        match self {
            Tolerance::Fixed(tolerance) => tolerance,
            Tolerance::Share(share) => share * before.abs(),
        }
    }
}

/// Lengths that grow without bounds as links become parallel. Only their curves show whether a change matters, so they have
/// no tolerance.
const UNBOUNDED: [&str; 6] = [
    "front_view_swing_arm",
    "side_view_swing_arm",
    "front_view_centre_lateral",
    "front_view_centre_height",
    "side_view_centre_longitudinal",
    "side_view_centre_height",
];

/// Prefixes of the names of a car's results that grow without bounds in a turn, like the kinematic roll centre.
const UNBOUNDED_IN_TURNS: [&str; 3] = [
    "roll_centre_height_",
    "roll_centre_lateral_",
    "roll_centre_moment_arm",
];

/// Largest change of a quantity that an engineer tolerates, in the printed unit. Angles: toe 0.05 degrees; total toe, camber,
/// roll and pitch 0.1 degrees; caster and inclination of the steering axis 0.2 degrees. Roll gradient: 0.05 degrees/g.
/// Lengths: turning circle 1 % of its value, toe at the rim 0.3 mm, total toe at the rim 0.6 mm, other lengths 1 mm. Share of
/// the front axle in the load transfer: 1 %. `None` for all other quantities, and for lengths that grow without bounds.
pub(super) fn tolerance(name: &str, unit: Unit, length: LengthUnit) -> Option<Tolerance> {
    let fixed = match (name, unit) {
        ("turning_circle", _) => return Some(Tolerance::Share(TURNING_CIRCLE)),
        ("toe" | "roll_gradient", _) => 0.05,
        ("total_toe", _) => 0.1,
        ("toe_at_rim", _) => length.convert(TOE_AT_RIM, LengthUnit::Millimetre),
        ("total_toe_at_rim", _) => length.convert(2.0 * TOE_AT_RIM, LengthUnit::Millimetre),
        ("camber" | "camber_to_road" | "roll" | "pitch", _) => 0.1,
        ("lateral_load_transfer_distribution", _) => 1.0,
        _ if UNBOUNDED_IN_TURNS.iter().any(|of| name.starts_with(of)) => return None,
        ("caster" | "kingpin_inclination", _) => 0.2,
        (_, Unit::Length) if !UNBOUNDED.contains(&name) => {
            length.convert(LENGTH, LengthUnit::Millimetre)
        }
        _ => return None,
    };
    Some(Tolerance::Fixed(fixed))
}

/// Returns true for a quantity that is compared only with the rack at 0. When the wheels are steered, toe is a steer angle,
/// and the kinematic roll centre moves without bounds.
pub(super) fn is_judged_straight_ahead(name: &str) -> bool {
    let is_toe = ["toe", "toe_at_rim", "total_toe", "total_toe_at_rim"].contains(&name);
    is_toe || ["roll_centre_height", "roll_centre_lateral"].contains(&name)
}

/// Returns true if a target for the characteristic `target` also determines the curve of the characteristic `of`. The
/// value of `of` in the design position may remain free.
pub(super) fn determines(target: Characteristic, of: Characteristic) -> bool {
    use Characteristic::{Toe, ToeAtRim};
    let is_same =
        |one, other| one == other || matches!((one, other), (Toe, ToeAtRim) | (ToeAtRim, Toe));
    is_same(target, of) || integral_of(target).is_some_and(|own| is_same(own, of))
}

/// Slope of a characteristic over wheel travel for a gain of 1, in printed units. `None` if the gain does not determine the
/// slope of this characteristic.
pub(super) fn slope_by_gain(
    gain: Characteristic,
    of: Characteristic,
    suspension: &Suspension,
) -> Option<f64> {
    use Characteristic::{MotionRatio, Toe, ToeAtRim};
    // A spring becomes shorter in jounce.
    let sign = if gain == MotionRatio { -1.0 } else { 1.0 };
    match (integral_of(gain)?, of) {
        // Toe at the rim is proportional to small angles of toe.
        (Toe, ToeAtRim) => Some(suspension.rim_diameter?.to_radians()),
        (own, of) => (own == of).then_some(sign),
    }
}

/// Characteristic whose slope over wheel travel is determined by a gain. `None` if the gain determines no slope.
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
