//! A state in equilibrium.

use super::super::NoEquilibrium;
use super::super::equations::{TRAVELS, UNKNOWNS};
use super::super::tangent::{Factors, Matrix};
use crate::axle::AxlePose;

/// A state in equilibrium.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// Values of the unknowns.
    pub unknowns: [f64; UNKNOWNS],
    /// True for each lifted wheel: front left, front right, rear left, rear right.
    pub lifted: [bool; 4],
    /// Number of evaluations of the equations.
    pub evaluations: usize,
    /// Pose of both wheels of each axle.
    pub placed: [AxlePose; 2],
    /// True if the wheels come from their curves, which agree with poses up to rounding error.
    pub(in crate::car) is_near: bool,
    /// Derivatives of the equations by the unknowns.
    pub(in crate::car) tangent: Box<Matrix>,
    /// Factors of the tangent.
    pub(in crate::car) factors: Box<Factors>,
}

impl Equilibrium {
    /// Makes the state at the end of Newton's method from the last unknowns, with the residuals and the tangent there. It takes
    /// one last step with this tangent. The readings also hold near their travels, so they need no update.
    pub(super) fn converged(
        unknowns: [f64; UNKNOWNS],
        lifted: [bool; 4],
        placed: [AxlePose; 2],
        is_near: bool,
        evaluations: usize,
        (residuals, tangent): ([f64; UNKNOWNS], Matrix),
    ) -> Result<Self, NoEquilibrium> {
        let factors = Factors::of(&tangent).ok_or(NoEquilibrium::Singular)?;
        let mut state = Equilibrium {
            unknowns,
            lifted,
            evaluations,
            placed,
            is_near,
            factors: Box::new(factors),
            tangent: Box::new(tangent),
        };
        let last = state.factors.solve(residuals.map(|residual| -residual));
        for (unknown, step) in state.unknowns.iter_mut().zip(last) {
            *unknown += step;
        }
        Ok(state)
    }

    /// Travels of the wheels.
    #[inline]
    pub(in crate::car) fn travels(&self) -> [f64; 4] {
        [0, 1, 2, 3].map(|k| self.unknowns[TRAVELS + k])
    }
}
