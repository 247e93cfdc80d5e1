//! Characteristics of the wheel in an equilibrium, and their derivatives with respect to wheel travel.
//!
//! The formulas come from the catalogue of characteristics. Velocities are derivatives of the equilibrium with respect to
//! wheel travel, with the rack held and without horizontal loads.

use super::derivatives::Tangent;
use super::wheel::{Change, ElasticWheel, Equilibrium};
use crate::characteristics::{Characteristic, Inputs};
use crate::number::{Dual, Jet, Scalar};

/// Advice for messages: results that replace some quantities of the rigid mechanism.
const INSTEAD: &str = "with [compliance] use jacking_by_lateral_force, jacking_by_braking, \
                       compliant_wheel_rate or compliant_ride_rate";

/// Returns the reason why a characteristic is not defined in an equilibrium, and which results replace it. `None` if it
/// is defined.
pub fn not_of_equilibrium(of: Characteristic) -> Option<[&'static str; 2]> {
    use Characteristic as C;
    match of {
        C::Camber
        | C::Toe
        | C::ToeAtRim
        | C::Caster
        | C::KingpinInclination
        | C::ScrubRadius
        | C::CasterTrail
        | C::KingpinOffset
        | C::SpindleTrail
        | C::SteeringAxisAtGroundLongitudinal
        | C::SteeringAxisAtGroundLateral
        | C::HalfTrackChange
        | C::WheelbaseChange
        | C::CamberGain
        | C::BumpSteer
        | C::CasterGain
        | C::KingpinInclinationGain
        | C::MotionRatio
        | C::SpringLength => None,
        C::RollCentreHeight
        | C::FrontViewSwingArm
        | C::SideViewSwingArm
        | C::FrontViewCentreLateral
        | C::FrontViewCentreHeight
        | C::SideViewCentreLongitudinal
        | C::SideViewCentreHeight
        | C::AntiDive
        | C::AntiLift
        | C::AntiSquat => Some(["applies to the rigid mechanism only", INSTEAD]),
        C::SpringInclination
        | C::RockerAngle
        | C::AntiRollBarAngle
        | C::AntiRollBarMotionRatio
        | C::AttiaKingpin
        | C::AttiaCamber => Some([
            "applies to the rigid mechanism only",
            "with [compliance] it is not available; remove [compliance], [bushings] and [links] for the rigid mechanism",
        ]),
    }
}

impl<T: Scalar> ElasticWheel<T> {
    /// Returns the inputs of the catalogue's formulas, with their first derivatives with respect to wheel travel.
    pub(super) fn inputs_by_travel(&self, tangent: &Tangent<T>) -> Option<Inputs<Jet<T, 2>>> {
        let state = self.moving_by(tangent, &Change::Travel)?;
        let geometry = self.geometry.map(Jet::constant);
        let mut inputs = geometry.inputs(&state, self.constants);
        if let Some([length, rate]) = self.spring_length_by(tangent, &Change::Travel) {
            inputs.now.spring_length = Jet([length, rate]);
        }
        Some(inputs)
    }

    /// Returns the value of a characteristic, or its derivative with respect to wheel travel. `None` if the
    /// characteristic is not defined.
    pub(super) fn of_inputs(
        inputs: &Inputs<Jet<T, 2>>,
        of: Characteristic,
        is_rate: bool,
    ) -> Option<T> {
        let found = if is_rate {
            of.evaluate(inputs)[1]
        } else {
            of.evaluate(&inputs.with_rates())
        };
        found.value().is_finite().then_some(found)
    }

    /// Returns the length of the spring, and the derivative of this length with respect to an input.
    fn spring_length_by(&self, tangent: &Tangent<T>, change: &Change<T>) -> Option<[T; 2]> {
        let rate = self.rate(tangent, change)?;
        let dual = self.built.system_over(Dual::<T, 1>::constant);
        let step = rate.map(|c| Dual {
            value: c.zero(),
            partials: [c],
        });
        let state = dual.stepped(&tangent.state.map(Dual::constant), &step);
        let length = dual.spring_length(&state, Dual::constant(tangent.task.rack))?;
        Some([length.value, length.partials[0]])
    }

    /// Value of a characteristic that only depends on positions.
    pub fn characteristic(&self, at: &Equilibrium<T>, of: Characteristic) -> T {
        let mut inputs = self.geometry.inputs(&at.solution.state, self.constants);
        if of == Characteristic::SpringLength
            && let Some(spring) = self.spring(at)
        {
            inputs.now.spring_length = spring.length;
        }
        of.evaluate(&inputs)
    }
}
