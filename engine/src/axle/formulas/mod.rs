//! Formulas of the axle's catalogue, for any number type.

pub(super) mod loads;
pub(in crate::axle) mod rigid;
pub(super) mod roll;
pub(super) mod steering;
