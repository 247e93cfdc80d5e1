//! Small dense linear algebra over any number.

pub(crate) mod lu;
pub(crate) mod square;
