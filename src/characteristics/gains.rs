//! Gains: derivatives of the angles by wheel travel.
//!
//! A gain runs its angle's own formula on a first-order jet along the motion, so there is no second
//! formula that could differ, and divides by the rise of the wheel centre. That makes it a derivative
//! by wheel travel whatever drives the mechanism.

use super::{Formula, Info, Inputs, Slot, Unit, Wheel, angles};
use crate::number::{Jet, Real, Vector3};

#[inline(always)]
fn by_travel<F: Formula, T: Real>(inputs: &Inputs<T>) -> T {
    #[inline(always)]
    fn along<T: Real>(now: Vector3<T>, rate: Vector3<T>) -> Vector3<Jet<T, 2>> {
        Vector3::new(
            Jet([now.x, rate.x]),
            Jet([now.y, rate.y]),
            Jet([now.z, rate.z]),
        )
    }
    // An angle reads the two directions and nothing else.
    let still = Jet::constant(inputs.turn.x.zero());
    let nothing = Wheel::filled(still);
    let (now, rate) = (&inputs.now, &inputs.rate);
    let moving = Inputs {
        now: Wheel {
            spin_axis: along(now.spin_axis, rate.spin_axis),
            steering_direction: along(now.steering_direction, rate.steering_direction),
            ..nothing
        },
        rate: nothing,
        turn: nothing.centre,
        design: nothing,
        constants: inputs.constants,
    };
    F::evaluate(&moving)[1] / inputs.rate.centre.z
}

macro_rules! gain {
    ($gain:ident, $angle:ident, $name:literal, $positive:literal, $formula:literal, $slot:ident, $rate:ident) => {
        #[doc = concat!("Derivative of ", stringify!($angle), " by wheel travel.")]
        pub(super) struct $gain;
        impl Formula for $gain {
            const INFO: Info = Info {
                name: $name,
                unit: Unit::AnglePerLength,
                positive: $positive,
                formula: $formula,
                source: "derivative of the angle by wheel travel, from the velocity analysis",
                reads: &[Slot::$slot, Slot::$rate, Slot::CentreRate],
                needs: <angles::$angle as Formula>::INFO.needs,
            };
            #[inline(always)]
            fn evaluate<T: Real>(inputs: &Inputs<T>) -> T {
                by_travel::<angles::$angle, T>(inputs)
            }
        }
    };
}

gain!(
    CamberGain,
    Camber,
    "camber_gain",
    "camber grows in jounce",
    "d camber / d travel",
    SpinAxis,
    SpinAxisRate
);
gain!(
    BumpSteer,
    Toe,
    "bump_steer",
    "toe-in in jounce",
    "d toe / d travel",
    SpinAxis,
    SpinAxisRate
);
gain!(
    CasterGain,
    Caster,
    "caster_gain",
    "caster grows in jounce",
    "d caster / d travel",
    SteeringDirection,
    SteeringDirectionRate
);
gain!(
    KingpinInclinationGain,
    KingpinInclination,
    "kingpin_inclination_gain",
    "kingpin inclination grows in jounce",
    "d kingpin_inclination / d travel",
    SteeringDirection,
    SteeringDirectionRate
);
