//! Start of Newton's method.

use super::super::equations::UNKNOWNS;
use super::super::tangent::Factors;
use super::equilibrium::Equilibrium;

/// Largest number of Newton steps, including steps back, from a start that is not an equilibrium.
const MOST_STEPS: usize = 60;
/// Largest number of Newton steps from a neighbouring state. If more steps would be needed, it is faster to begin again
/// from a start nearer to the case.
const MOST_STEPS_BESIDE: usize = 20;

/// Start of Newton's method: unknowns, lifted wheels, and LU factors of a tangent.
#[derive(Clone, Copy)]
pub(in crate::car) struct Start<'f> {
    pub(super) unknowns: [f64; UNKNOWNS],
    pub(super) lifted: [bool; 4],
    pub(super) factors: Option<&'f Factors>,
    /// True if the wheels of the result may be computed from their curves.
    pub(super) may_be_near: bool,
    /// Largest number of Newton steps for one set of wheels in contact.
    pub(super) most_steps: usize,
}

impl<'f> Start<'f> {
    /// Makes a start with all wheels on the ground.
    pub(in crate::car) fn of(unknowns: [f64; UNKNOWNS]) -> Self {
        Start {
            unknowns,
            lifted: [false; 4],
            factors: None,
            may_be_near: false,
            most_steps: MOST_STEPS,
        }
    }

    /// Makes a start from a solved state.
    pub(in crate::car) fn at(found: &'f Equilibrium) -> Self {
        Start {
            unknowns: found.unknowns,
            lifted: found.lifted,
            factors: found.factors.as_deref(),
            may_be_near: false,
            most_steps: MOST_STEPS_BESIDE,
        }
    }

    /// Makes a start from a neighbouring state, as in a map of cases. The wheels may be computed from their curves.
    pub(super) fn beside(found: &'f Equilibrium) -> Self {
        Start {
            may_be_near: true,
            ..Start::at(found)
        }
    }
}
