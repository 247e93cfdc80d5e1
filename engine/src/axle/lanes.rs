//! Quantities of several axles at the same time. Each SIMD lane contains one axle.

use super::Quantity;
use super::formulas::{roll, steering};
use super::reading::{ALWAYS, WheelParts};
use super::state::{AxleState, Hold};
use crate::ask::NoValue;
use crate::characteristics::{
    Characteristic, Constants, DesignWheel, Inputs, LaneAxle, LaneInputs, NumberPart, Slots,
    VectorPart, Wheel,
};
use crate::model::Side;
use crate::number::{Outlined, SimdReal, Vector3, outlined};

/// Values of several wheels in SIMD lanes, and first derivatives of these values with respect to travel. Derivatives
/// with respect to the rack are available only for the carrier and, if the axle is rigid, for the axle itself.
#[derive(Clone, Copy, Debug)]
pub struct LaneWheel<'i, B> {
    inputs: &'i Inputs<B>,
    by_rack: &'i [Vector3<B>; 2],
    axle: &'i LaneAxle<B>,
}

impl<'i, B> LaneWheel<'i, B> {
    /// Makes the wheels from the inputs in SIMD lanes.
    #[inline(always)]
    pub fn of(read: &'i LaneInputs<B>) -> Self {
        LaneWheel {
            inputs: read.inputs(),
            by_rack: read.by_rack(),
            axle: read.axle(),
        }
    }
}

impl<B: SimdReal> WheelParts<B> for LaneWheel<'_, B> {
    #[inline(always)]
    fn like(&self) -> B {
        self.inputs.turn.x
    }

    #[inline(always)]
    fn read_vector(&self, part: VectorPart, powers: [usize; 2]) -> Vector3<B> {
        match (self.wheel(powers), powers, part) {
            (Some(wheel), ..) => wheel.vector(part),
            (None, [0, 1], VectorPart::Centre) => self.by_rack[0],
            (None, [0, 1], VectorPart::SpinAxis) => {
                self.by_rack[1].cross(self.inputs.now.spin_axis)
            }
            _ => self.unknown(),
        }
    }

    #[inline(always)]
    fn number(&self, part: NumberPart, powers: [usize; 2]) -> B {
        match self.wheel(powers) {
            Some(wheel) => wheel.number(part),
            None => self.unknown().x,
        }
    }

    /// The SIMD lanes contain the angular velocity of the carrier instead of the columns of its rotation matrix. For a
    /// rigid axle, they also contain the columns of the axle's rotation matrix along x and y.
    #[inline(always)]
    fn column(&self, i: usize, powers: [usize; 2]) -> Vector3<B> {
        if self.axle.is_steered {
            self.unknown()
        } else {
            self.axle_column(i, powers)
        }
    }

    #[inline(always)]
    fn axle_column(&self, i: usize, powers: [usize; 2]) -> Vector3<B> {
        match (self.axle.columns.get(i), powers) {
            (Some(column), [0, 0]) => *column,
            _ => self.unknown(),
        }
    }

    #[inline(always)]
    fn design(&self) -> DesignWheel<B> {
        self.inputs.design
    }

    #[inline(always)]
    fn twist(&self, powers: [usize; 2]) -> [Vector3<B>; 2] {
        let inputs = self.inputs;
        match powers {
            [1, 0] => [inputs.rate.centre, inputs.turn],
            [0, 1] => *self.by_rack,
            _ => [self.unknown(); 2],
        }
    }

    #[inline(always)]
    fn axle_twist(&self, powers: [usize; 2]) -> [Vector3<B>; 2] {
        let LaneAxle {
            turns,
            kingpin_by_held,
            ..
        } = *self.axle;
        match powers {
            [1, 0] => [self.inputs.rate.steering_point, turns[0]],
            [0, 1] => [kingpin_by_held, turns[1]],
            _ => [self.unknown(); 2],
        }
    }

    #[inline(always)]
    fn inputs(&self, constants: Constants) -> Inputs<B> {
        Inputs {
            constants,
            ..*self.inputs
        }
    }
}

impl<B: SimdReal> LaneWheel<'_, B> {
    /// Returns the values of the wheels for the powers [0, 0] of travel and rack, and their derivatives with respect to
    /// travel for [1, 0]. `None` for other powers.
    #[inline(always)]
    fn wheel(&self, powers: [usize; 2]) -> Option<&Wheel<B>> {
        match powers {
            [0, 0] => Some(&self.inputs.now),
            [1, 0] => Some(&self.inputs.rate),
            _ => None,
        }
    }

    #[inline(always)]
    fn unknown(&self) -> Vector3<B> {
        let unknown = self.inputs.turn.x.constant(f64::NAN);
        Vector3::new(unknown, unknown, unknown)
    }
}

impl Quantity {
    /// Returns true if SIMD lanes can compute the quantity. They can compute every wheel characteristic, and the
    /// quantities that are marked `lanes` in the axle's catalogue.
    pub fn is_for_lanes(self) -> bool {
        match self {
            Quantity::Corner(..) => true,
            Quantity::Wheel(_, q) => q.is_for_lanes(),
            Quantity::Axle(q) => q.is_for_lanes(),
            Quantity::Figure(_) => false,
        }
    }

    /// Returns the slots (values of a wheel) that the quantity uses. Only for lanes that contain several designs.
    pub fn lane_slots(self, side: Side) -> Slots {
        match self {
            Quantity::Corner(own, _) if own != side => Slots::default(),
            Quantity::Corner(_, c) => Slots::default().with(c.info().reads),
            Quantity::Wheel(..) | Quantity::Axle(_) => {
                Slots::default().with(ALWAYS).with(self.info().reads)
            }
            Quantity::Figure(_) => Slots::default(),
        }
    }

    /// Returns the values in SIMD lanes. A value is NaN if it is missing, under the same conditions as in
    /// [`Quantity::value`].
    #[inline(always)]
    pub fn value_in_lanes<B: SimdReal>(self, state: &AxleState<B, LaneWheel<B>>) -> B {
        let like = state.like();
        let value = match self {
            Quantity::Corner(side, characteristic) => outlined!(
                [B: SimdReal] like;
                c: Characteristic = characteristic,
                inputs: &'p Inputs<B> = state.readings[side as usize].inputs => B { c.evaluate(inputs) }
            ),
            _ => like.outlined(OfAxle {
                quantity: self,
                state,
            }),
        };
        value.finite()
    }
}

struct OfAxle<'s, 'i, B> {
    quantity: Quantity,
    state: &'s AxleState<'s, B, LaneWheel<'i, B>>,
}

impl<B: SimdReal> Outlined for OfAxle<'_, '_, B> {
    type Output = B;
    #[inline(always)]
    fn work(self) -> B {
        let OfAxle { quantity, state } = self;
        let unknown = state.like().constant(f64::NAN);
        let value = match quantity {
            // A wheel characteristic needs only its own wheel. A rigid mechanism has no test results.
            Quantity::Corner(..) | Quantity::Figure(_) => unknown,
            Quantity::Wheel(side, q) => q.evaluate_in_lanes(state, side),
            Quantity::Axle(q) => q.evaluate_in_lanes(state),
        };
        let mut has_value = unknown.everywhere();
        if quantity.is_of_the_plane() && state.hold == Hold::TravelsOnPads {
            let apart = state.mismatch().abs();
            has_value = !(state.track().scaled(Quantity::SAME_PLANE)).less(apart);
        }
        let void = match quantity {
            Quantity::Axle(q) => q.possible_void(),
            _ => None,
        };
        let has_value = match void {
            Some(NoValue::StraightAhead) => {
                let steer = steering::mean_steer(state).abs();
                has_value & !steer.less(steer.constant(steering::STRAIGHT_AHEAD))
            }
            Some(NoValue::ParallelNormals) => has_value & roll::normals_meet(state),
            _ => has_value,
        };
        B::select(has_value, value, unknown)
    }
}
