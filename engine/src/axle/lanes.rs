//! Quantities of many axles at a time, one in each lane.

use super::formulas::{roll, steering};
use super::reading::{
    ALWAYS, BAR_ANGLE, CENTRE, DESIGN_CENTRE, DESIGN_SPIN_AXIS, ROCKER_ANGLE, SPIN_AXIS, SPRING,
    SPRING_LENGTH, STEERING_DIRECTION, STEERING_POINT, STRUT_UPPER, WheelParts,
};
use super::state::{AxleState, Hold};
use super::{Quantity, Void};
use crate::characteristics::{Characteristic, Constants, Inputs, LaneInputs, Slots};
use crate::model::Side;
use crate::number::{Outlined, SimdReal, Vector3, outlined};

/// A wheel read in lanes: its parts and their first derivatives by travel; by the rack only those of the carrier.
#[derive(Clone, Copy, Debug)]
pub struct LaneWheel<'i, B> {
    inputs: &'i Inputs<B>,
    by_rack: &'i [Vector3<B>; 2],
}

impl<'i, B> LaneWheel<'i, B> {
    /// The wheel as its inputs in lanes describe it.
    #[inline(always)]
    pub fn of(read: &'i LaneInputs<B>) -> Self {
        LaneWheel {
            inputs: read.inputs(),
            by_rack: read.by_rack(),
        }
    }
}

impl<B: SimdReal> WheelParts<B> for LaneWheel<'_, B> {
    #[inline(always)]
    fn like(&self) -> B {
        self.inputs.turn.x
    }

    #[inline(always)]
    fn coefficient(&self, part: usize, powers: [usize; 2]) -> B {
        outlined!(
            [B: SimdReal] self.inputs.turn.x;
            wheel: &'p LaneWheel<'p, B> = self, part: usize = part, powers: [usize; 2] = powers => B {
                wheel.read(part, powers)
            }
        )
    }

    #[inline(always)]
    fn vector(&self, first: usize, powers: [usize; 2]) -> Vector3<B> {
        outlined!(
            [B: SimdReal] self.inputs.turn.x;
            wheel: &'p LaneWheel<'p, B> = self, first: usize = first, powers: [usize; 2] = powers => Vector3<B> {
                Vector3::new(
                    wheel.read(first, powers),
                    wheel.read(first + 1, powers),
                    wheel.read(first + 2, powers),
                )
            }
        )
    }

    #[inline(always)]
    fn twist(&self, powers: [usize; 2]) -> [Vector3<B>; 2] {
        let inputs = self.inputs;
        match powers {
            [1, 0] => [inputs.rate.centre, inputs.turn],
            [0, 1] => *self.by_rack,
            _ => {
                let unknown = inputs.turn.x.lit(f64::NAN);
                [Vector3::new(unknown, unknown, unknown); 2]
            }
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
    #[inline(always)]
    fn read(&self, part: usize, powers: [usize; 2]) -> B {
        let inputs = self.inputs;
        let unknown = inputs.turn.x.lit(f64::NAN);
        let of = |first: usize, vector: Vector3<B>| match part - first {
            0 => vector.x,
            1 => vector.y,
            _ => vector.z,
        };
        let wheel = match (powers, part) {
            ([0, 0], _) => &inputs.now,
            ([1, 0], _) => &inputs.rate,
            ([0, 1], CENTRE..3) => return of(CENTRE, self.by_rack[0]),
            ([0, 1], SPIN_AXIS..STEERING_POINT) => {
                return of(SPIN_AXIS, self.by_rack[1].cross(inputs.now.spin_axis));
            }
            _ => return unknown,
        };
        match part {
            CENTRE..3 => of(CENTRE, wheel.centre),
            SPIN_AXIS..STEERING_POINT => of(SPIN_AXIS, wheel.spin_axis),
            STEERING_POINT..STEERING_DIRECTION => of(STEERING_POINT, wheel.steering_point),
            STEERING_DIRECTION..SPRING => of(STEERING_DIRECTION, wheel.steering_direction),
            SPRING..STRUT_UPPER => of(SPRING, wheel.spring),
            STRUT_UPPER..SPRING_LENGTH => of(STRUT_UPPER, wheel.strut_upper),
            SPRING_LENGTH => wheel.spring_length,
            ROCKER_ANGLE => wheel.rocker_angle,
            BAR_ANGLE => wheel.bar_angle,
            DESIGN_SPIN_AXIS..DESIGN_CENTRE => of(DESIGN_SPIN_AXIS, inputs.design.spin_axis),
            DESIGN_CENTRE.. => of(DESIGN_CENTRE, inputs.design.centre),
            _ => unknown,
        }
    }
}

impl Quantity {
    /// Whether lanes can provide the quantity: every characteristic of a wheel, and what the axle's catalogue marks.
    pub fn is_for_lanes(self) -> bool {
        match self {
            Quantity::Corner(..) => true,
            Quantity::Wheel(_, q) => q.is_for_lanes(),
            Quantity::Axle(q) => q.is_for_lanes(),
        }
    }

    /// The slots of a wheel that it reads in lanes.
    pub fn lane_slots(self, side: Side) -> Slots {
        match self {
            Quantity::Corner(own, _) if own != side => Slots::default(),
            Quantity::Corner(_, c) => Slots::default().with(c.info().reads),
            Quantity::Wheel(..) | Quantity::Axle(_) => Slots::default().with(ALWAYS),
        }
    }

    /// The value in lanes; NaN where it has none, as [`Quantity::value`] has it.
    #[inline(always)]
    pub fn value_in_lanes<B: SimdReal>(self, state: &AxleState<B, LaneWheel<B>>) -> B {
        let like = state.like();
        let value = match self {
            Quantity::Corner(side, characteristic) => outlined!(
                [B: SimdReal] like;
                c: Characteristic = characteristic, constants: Constants = state.setup.constants,
                wheel: LaneWheel<'p, B> = state.readings[side as usize] => B { c.evaluate(&wheel.inputs(constants)) }
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
        let unknown = state.like().lit(f64::NAN);
        let value = match quantity {
            // Characteristics of a wheel are read of that wheel alone.
            Quantity::Corner(..) => unknown,
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
            Some(Void::StraightAhead) => {
                let steer = steering::mean_steer(state).abs();
                has_value & !steer.less(steer.lit(steering::STRAIGHT_AHEAD))
            }
            Some(Void::ParallelNormals) => {
                let [left, right] = roll::jacking(state);
                let sum = (left + right).abs();
                let across = (left - right).abs();
                let meet = across.less(sum.scaled(roll::FARTHEST_MEETING));
                has_value & meet & sum.lit(roll::UPRIGHT).less(sum)
            }
            _ => has_value,
        };
        B::select(has_value, value, unknown)
    }
}
