//! Formulas of the axle's catalogue, over any number type.

pub(super) mod loads;
pub(super) mod rigid;
pub(super) mod roll;
pub(super) mod steering;
