//! Catalogue of wheel characteristics. Each has a name, a unit, a sign, its inputs and one formula.
//!
//! All code that names characteristics uses this catalogue: validation of studies, the plan, column names and tables. A
//! formula is written once, over [`Real`]. With other number types it gives its derivatives with respect to travel and
//! hardpoints. A new characteristic is one type in one of the files below and one line in `catalogue!`.
//!
//! Everything here is in the kernel's frame: a left wheel, x forward, y left (outboard), z up. Angles are in radians and
//! lengths in the study's unit. Signs therefore follow [`Info::positive`], for any side and axes of the study.

mod angles;
mod anti;
mod attia;
mod carried;
mod constants;
mod gains;
mod instant_centre;
mod lanes;
mod measure;
mod quantity;
mod reading;
mod seeds;
mod spring;
mod steering;
mod track;
mod undefined;
mod wheel;
mod wheel_reading;

use crate::ask::{Info, Need, Unit, with_unit};
pub use attia::{attia_camber, attia_kingpin};
pub use carried::CarriedForce;
pub use constants::Constants;
pub use instant_centre::{InstantCentres, instant_centres_of};
pub use lanes::{ByDirections, LaneAxle, LaneInputs, LaneReader, LaneWheels};
pub use measure::{Across, Measure, Stud};
pub(crate) use measure::{Input, Vectors};
pub use quantity::Quantity;
pub use wheel::{DesignWheel, Inputs, Slot, Slots, Wheel};
pub(crate) use wheel::{NumberPart, VectorPart};
pub use wheel_reading::WheelReading;

use crate::model::{LengthUnit, Suspension};
use crate::number::{Dual, Real, Vector3, outlined};
use std::marker::PhantomData;

/// One characteristic: its entry in the catalogue and its formula.
trait Formula {
    const INFO: Info;
    fn evaluate<T: Real>(inputs: &Inputs<T>) -> T;
}

/// Defines characteristics. Each one has an [`Info`] and a formula over [`Inputs`] of any number type `T` that is [`Real`].
macro_rules! formulas {
    ($($(#[$about:meta])* $name:ident { $($entry:tt)* } = |$inputs:ident| $value:expr;)*) => {$(
        $(#[$about])*
        pub(super) struct $name;
        impl $crate::characteristics::Formula for $name {
            const INFO: $crate::ask::Info =
                $crate::ask::Info { $($entry)* ..$crate::ask::Info::EMPTY }.of_wheel();
            #[inline(always)]
            fn evaluate<T: $crate::number::Real>($inputs: &$crate::characteristics::Inputs<T>) -> T {
                $value
            }
        }
    )*};
}
use formulas;

macro_rules! catalogue {
    ($($variant:ident => $formula:ty,)*) => {
        /// A wheel characteristic.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Characteristic {
            $(
                #[doc = concat!("See [`Characteristic::info`] of `", stringify!($variant), "`.")]
                $variant,
            )*
        }

        impl Characteristic {
            /// Whole catalogue, in the order of printed results.
            pub const ALL: &'static [Characteristic] = &[$(Characteristic::$variant),*];

            /// Catalogue entry of the characteristic: its name, unit, sign, inputs and source.
            #[inline]
            pub fn info(self) -> &'static Info {
                match self {
                    $(Characteristic::$variant => &<$formula as Formula>::INFO,)*
                }
            }

            /// Value of the characteristic for these inputs, in radians and length units.
            #[inline(always)]
            pub fn evaluate<T: Real>(self, inputs: &Inputs<T>) -> T {
                match self {
                    $(Characteristic::$variant => value_of::<$formula, T>(inputs),)*
                }
            }

            /// Derivatives with respect to all inputs of the formula.
            #[inline]
            pub fn gradient<T: Real>(self, inputs: &Inputs<T>) -> Gradient<T> {
                match self {
                    $(Characteristic::$variant => gradient_of::<$formula, T>(inputs),)*
                }
            }
        }
    };
}

catalogue! {
    Camber => angles::Camber,
    Toe => angles::Toe,
    ToeAtRim => angles::ToeAtRim,
    Caster => angles::Caster,
    KingpinInclination => angles::KingpinInclination,
    ScrubRadius => steering::ScrubRadius,
    CasterTrail => steering::CasterTrail,
    KingpinOffset => steering::KingpinOffset,
    SpindleTrail => steering::SpindleTrail,
    SteeringAxisAtGroundLongitudinal => steering::SteeringAxisAtGroundLongitudinal,
    SteeringAxisAtGroundLateral => steering::SteeringAxisAtGroundLateral,
    HalfTrackChange => track::HalfTrackChange,
    WheelbaseChange => track::WheelbaseChange,
    CamberGain => gains::CamberGain,
    BumpSteer => gains::BumpSteer,
    CasterGain => gains::CasterGain,
    KingpinInclinationGain => gains::KingpinInclinationGain,
    RollCentreHeight => instant_centre::RollCentreHeight,
    FrontViewSwingArm => instant_centre::FrontViewSwingArm,
    SideViewSwingArm => instant_centre::SideViewSwingArm,
    FrontViewCentreLateral => instant_centre::FrontViewCentreLateral,
    FrontViewCentreHeight => instant_centre::FrontViewCentreHeight,
    SideViewCentreLongitudinal => instant_centre::SideViewCentreLongitudinal,
    SideViewCentreHeight => instant_centre::SideViewCentreHeight,
    AntiDive => anti::AntiDive,
    AntiLift => anti::AntiLift,
    AntiSquat => anti::AntiSquat,
    MotionRatio => spring::MotionRatio,
    SpringLength => spring::SpringLength,
    SpringInclination => spring::SpringInclination,
    RockerAngle => spring::RockerAngle,
    AntiRollBarAngle => spring::AntiRollBarAngle,
    AntiRollBarMotionRatio => spring::AntiRollBarMotionRatio,
    AttiaKingpin => attia::AttiaKingpin,
    AttiaCamber => attia::AttiaCamber,
}

/// Derivatives of a characteristic with respect to the slots that it reads, in the order of [`Info::reads`].
pub type Gradient<T> = [Vector3<T>; Slot::MOST];

impl Characteristic {
    /// Column name: the characteristic with its unit, for example `camber_deg`.
    pub fn column(self, length: LengthUnit) -> String {
        let info = self.info();
        with_unit(info.name, &info.unit.suffix(length))
    }

    /// Characteristic with this name.
    pub fn named(name: &str) -> Option<Characteristic> {
        Self::ALL.iter().find(|c| c.info().name == name).copied()
    }

    /// Characteristics that can be computed for a suspension, because it has all parts and inputs that they need.
    pub fn available(suspension: &Suspension) -> impl Iterator<Item = Characteristic> {
        let all = Self::ALL.iter().copied();
        all.filter(|c| c.info().needs.iter().all(|need| need.met_by(suspension)))
    }
}

/// Value of a formula. This code is compiled as a separate function.
#[inline(always)]
fn value_of<F: Formula, T: Real>(inputs: &Inputs<T>) -> T {
    outlined!(
        [F: Formula, T: Real] inputs.turn.x;
        _formula: PhantomData<F> = PhantomData::<F>, inputs: &'p Inputs<T> = inputs => T { F::evaluate(inputs) }
    )
}

/// Derivatives of a formula with respect to all its inputs, slot by slot.
#[inline(never)]
fn gradient_of<F: Formula, T: Real>(inputs: &Inputs<T>) -> Gradient<T> {
    let (zero, one) = (inputs.turn.x.zero(), inputs.turn.x.one());
    let mut seeded = if size_of::<T>() > size_of::<f64>() {
        constants(inputs, F::INFO.reads)
    } else {
        // With inlining, the compiler drops numbers that the formula does not read, and a Jacobian takes a fifth less time. For
        // long series, inlining would add seconds of compile time.
        constants_inline(inputs, F::INFO.reads)
    };
    let mut gradient = [inputs.turn.zero(); Slot::MOST];
    for (k, slot) in F::INFO.reads.iter().enumerate() {
        slot.seed(&mut seeded, one);
        gradient[k] = Vector3::from(F::evaluate(&seeded).partials);
        slot.seed(&mut seeded, zero);
    }
    gradient
}

/// Inputs that a formula reads, as dual numbers with zero derivatives. Other inputs are NaN. This function is not inlined, so all
/// formulas share its compiled code.
#[inline(never)]
fn constants<T: Real>(inputs: &Inputs<T>, reads: &[Slot]) -> Inputs<Dual<T, 3>> {
    constants_inline(inputs, reads)
}

/// Inputs that a formula reads, as dual numbers with zero derivatives. Other inputs are NaN. This function is always inlined.
#[inline(always)]
fn constants_inline<T: Real>(inputs: &Inputs<T>, reads: &[Slot]) -> Inputs<Dual<T, 3>> {
    let nothing = Dual::constant(inputs.turn.x.constant(f64::NAN));
    inputs.only(reads, nothing, Dual::constant)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_no_formula_reads_more_than_it_can() {
        for (i, c) in Characteristic::ALL.iter().enumerate() {
            assert_eq!(Characteristic::named(c.info().name), Some(*c));
            assert!(c.info().reads.len() <= Slot::MOST, "{}", c.info().name);
            assert_eq!(*c as usize, i);
            assert_eq!(
                c.info().reads_steering_axis(),
                c.info().needs.contains(&Need::SteeringAxis),
                "{}",
                c.info().name
            );
        }
    }

    /// A formula reads exactly its declared inputs: a change of a declared input changes the value, and a change of another
    /// input does not.
    #[test]
    fn declared_dependencies_are_the_true_ones() {
        let plain = wheel::tests::sample();
        for c in Characteristic::ALL {
            let before = c.evaluate(&plain);
            assert!(before.is_finite(), "{}", c.info().name);
            for slot in Slot::ALL {
                let mut moved = plain.map(Dual::<f64, 3>::constant);
                slot.seed(&mut moved, 1.0);
                let partials = c.evaluate(&moved).partials;
                let depends = partials.iter().any(|p| *p != 0.0);
                assert_eq!(
                    depends,
                    c.info().reads.contains(slot),
                    "{} and {slot:?}: {partials:?}",
                    c.info().name
                );
            }
        }
    }
}
