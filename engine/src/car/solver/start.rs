//! Start of Newton's method.

use super::super::equations::UNKNOWNS;
use super::super::tangent::Factors;
use super::equilibrium::Equilibrium;

/// Start of Newton's method: unknowns, lifted wheels and factors of a tangent.
#[derive(Clone, Copy)]
pub(in crate::car) struct Start<'f> {
    pub(super) unknowns: [f64; UNKNOWNS],
    pub(super) lifted: [bool; 4],
    pub(super) factors: Option<&'f Factors>,
    /// True if the wheels of the result may come from their curves.
    pub(super) may_be_near: bool,
}

impl<'f> Start<'f> {
    /// Starts with all wheels down.
    pub(in crate::car) fn of(unknowns: [f64; UNKNOWNS]) -> Self {
        Start {
            unknowns,
            lifted: [false; 4],
            factors: None,
            may_be_near: false,
        }
    }

    /// Starts from a state that was found.
    pub(in crate::car) fn at(found: &'f Equilibrium) -> Self {
        Start {
            unknowns: found.unknowns,
            lifted: found.lifted,
            factors: Some(&found.factors),
            may_be_near: false,
        }
    }

    /// Starts from a neighbouring state, as in a map. Wheels may come from their curves.
    pub(super) fn beside(found: &'f Equilibrium) -> Self {
        Start {
            may_be_near: true,
            ..Start::at(found)
        }
    }
}
