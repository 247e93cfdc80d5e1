//! Small dense linear algebra over any number type.

pub(crate) mod elimination;
pub(crate) mod lu;
pub(crate) mod square;
