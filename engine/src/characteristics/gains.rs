//! Gains: derivatives of the angles with respect to wheel travel.
//!
//! The program evaluates the angle's formula with first-order series along the motion, so the formula is written only once. It
//! divides the rate of the angle by the rate of the wheel centre's height. So a gain is a derivative with respect to wheel
//! travel for any drive.

use super::{
    Characteristic, Constants, DesignWheel, Formula, Info, Inputs, Slot, Unit, Wheel, angles,
};
use crate::number::{Dual, Jet, Matrix3, Real, Vector3, outlined};
use std::marker::PhantomData;

#[inline(always)]
fn by_travel<F: Formula, T: Real>(inputs: &Inputs<T>) -> T {
    let rate = &inputs.rate;
    slope::<F, T>(inputs, rate.spin_axis, rate.steering_direction) / rate.centre.z
}

/// Rate of an angle, if the direction that it reads (spin axis or steering axis) changes at the given rate. Each angle reads only
/// one of these two directions.
#[inline(always)]
fn slope<F: Formula, T: Real>(
    inputs: &Inputs<T>,
    spin_axis: Vector3<T>,
    steering_direction: Vector3<T>,
) -> T {
    F::evaluate(&moving(inputs, spin_axis, steering_direction))[1]
}

/// Inputs of an angle as first-order series. The spin axis and the steering axis's direction have the given rates.
#[inline(always)]
fn moving<T: Real>(
    inputs: &Inputs<T>,
    spin_axis: Vector3<T>,
    steering_direction: Vector3<T>,
) -> Inputs<Jet<T, 2>> {
    let now = &inputs.now;
    of_directions(
        now.spin_axis.with_rate(spin_axis),
        now.steering_direction.with_rate(steering_direction),
        Jet::constant(inputs.turn.x.zero()),
    )
}

/// Inputs of an angle. Only spin axis and steering direction can be inputs of an angle, so every other number is
/// `filling`.
#[inline(always)]
fn of_directions<T: Real>(
    spin_axis: Vector3<T>,
    steering_direction: Vector3<T>,
    filling: T,
) -> Inputs<T> {
    let nothing = Wheel::filled(filling);
    Inputs {
        now: Wheel {
            spin_axis,
            steering_direction,
            ..nothing
        },
        rate: nothing,
        turn: nothing.centre,
        design: DesignWheel::filled(nothing.centre.x),
        constants: Constants::default(),
    }
}

/// Evaluates an expression for the formula of an angle. Covers the listed angles; without a list, covers camber, toe, caster and
/// kingpin inclination. `None` for other characteristics.
macro_rules! of_angle {
    ($characteristic:expr, $formula:ident => $value:expr) => {
        of_angle!($characteristic, $formula => $value, Camber, Toe, Caster, KingpinInclination)
    };
    ($characteristic:expr, $formula:ident => $value:expr, $($angle:ident),*) => {
        match $characteristic {
            $(Characteristic::$angle => {
                type $formula = angles::$angle;
                Some($value)
            })*
            _ => None,
        }
    };
}

/// Returns true for camber, toe, caster and kingpin inclination.
pub(super) fn is_angle(c: Characteristic) -> bool {
    of_angle!(c, Angle => Angle::INFO.name).is_some()
}

impl Characteristic {
    /// Camber or toe, in radians, from the unit spin axis. NaN for other characteristics.
    #[inline(always)]
    pub(crate) fn of_spin_axis<T: Real>(self, spin_axis: Vector3<T>) -> T {
        let unknown = spin_axis.x.constant(f64::NAN);
        let inputs = of_directions(spin_axis, spin_axis.map(|_| unknown), unknown);
        of_angle!(self, Angle => Angle::evaluate(&inputs), Camber, Toe).unwrap_or(unknown)
    }
}

/// Derivative of an angle with respect to the drive coordinate, from the rates of spin axis and steering axis. `None` for other
/// characteristics.
#[inline(always)]
pub(super) fn by_drive<T: Real>(c: Characteristic, inputs: &Inputs<T>) -> Option<T> {
    let rate = &inputs.rate;
    of_angle!(c, Angle => slope::<Angle, T>(inputs, rate.spin_axis, rate.steering_direction))
}

/// Derivative of an angle with respect to the direction that it reads: the spin axis or the steering axis. `None` for other
/// characteristics.
#[inline(always)]
pub(super) fn by_direction<T: Real>(c: Characteristic, inputs: &Inputs<T>) -> Option<Vector3<T>> {
    let now = &inputs.now;
    let moved = of_directions(
        Dual::inputs(now.spin_axis),
        Dual::inputs(now.steering_direction),
        Dual::constant(inputs.turn.x.zero()),
    );
    of_angle!(c, Angle => Vector3::from(Angle::evaluate(&moved).partials))
}

/// Derivative of an angle with respect to the direction that it reads (spin axis or steering axis), as a series along the motion.
/// The second coefficient is the derivative of the angle's slope with respect to the direction, because the order of the two
/// differentiations does not matter. `None` for other characteristics.
#[inline(always)]
pub(super) fn by_direction_along<T: Real>(
    c: Characteristic,
    inputs: &Inputs<T>,
) -> Option<Vector3<Jet<T, 2>>> {
    let rate = &inputs.rate;
    let along = moving(inputs, rate.spin_axis, rate.steering_direction);
    let [x, y, z] = Matrix3::identity(along.turn.x).columns;
    of_angle!(c, Angle => Vector3::new(
        slope_outlined::<Angle, _>(&along, x),
        slope_outlined::<Angle, _>(&along, y),
        slope_outlined::<Angle, _>(&along, z),
    ))
}

/// Rate of an angle if the direction that it reads (spin axis or steering axis) has the rate `direction`. This code is compiled as
/// a separate function.
#[inline(always)]
fn slope_outlined<F: Formula, T: Real>(inputs: &Inputs<T>, direction: Vector3<T>) -> T {
    outlined!(
        [F: Formula, T: Real] inputs.turn.x;
        _angle: PhantomData<F> = PhantomData::<F>, inputs: &'p Inputs<T> = inputs, direction: Vector3<T> = direction
            => T { slope::<F, T>(inputs, direction, direction) }
    )
}

/// Defines the gains, one per line: angle, name, meaning of a positive value, formula, and inputs.
macro_rules! gains {
    ($($gain:ident, $angle:ident, $name:literal, $positive:literal, $formula:literal, $slot:ident, $rate:ident;)*) => {
        $(
            #[doc = concat!("Derivative of ", stringify!($angle), " with respect to wheel travel.")]
            pub(super) struct $gain;
            impl Formula for $gain {
                const INFO: Info = Info {
                    name: $name,
                    unit: Unit::AnglePerLength,
                    positive: $positive,
                    formula: $formula,
                    source: "derivative of the angle with respect to wheel travel, from the velocity analysis",
                    reads: &[Slot::$slot, Slot::$rate, Slot::CentreRate],
                    needs: <angles::$angle as Formula>::INFO.needs,
                    ..Info::EMPTY
                }
                .of_wheel();
                #[inline(always)]
                fn evaluate<T: Real>(inputs: &Inputs<T>) -> T {
                    by_travel::<angles::$angle, T>(inputs)
                }
            }
        )*

        /// Angle whose derivative with respect to travel is this gain.
        pub(super) fn angle_of_gain(c: Characteristic) -> Option<Characteristic> {
            match c {
                $(Characteristic::$gain => Some(Characteristic::$angle),)*
                _ => None,
            }
        }
    };
}

gains! {
    CamberGain, Camber, "camber_gain", "camber grows in jounce", "d camber / d travel", SpinAxis, SpinAxisRate;
    BumpSteer, Toe, "bump_steer", "toe-in in jounce", "d toe / d travel", SpinAxis, SpinAxisRate;
    CasterGain, Caster, "caster_gain", "caster grows in jounce", "d caster / d travel", SteeringDirection, SteeringDirectionRate;
    KingpinInclinationGain, KingpinInclination, "kingpin_inclination_gain", "kingpin inclination grows in jounce", "d kingpin_inclination / d travel", SteeringDirection, SteeringDirectionRate;
}
