//! The formulas of the axle's catalogue, over any number.

pub(super) mod loads;
pub(super) mod roll;
pub(super) mod steering;

use super::state::{State, WheelState};
use crate::model::Side;
use crate::number::Scalar;

/// One wheel of a state.
pub(super) fn wheel<'s, T: Scalar>(state: &'s State<T>, side: Side) -> WheelState<'s, T> {
    let [left, right] = state.wheels();
    match side {
        Side::Left => left,
        Side::Right => right,
    }
}
