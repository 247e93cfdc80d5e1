//! Formulas of the axle's catalogue, over any number type.

pub(super) mod loads;
pub(in crate::axle) mod rigid;
pub(super) mod roll;
pub(super) mod steering;
