//! A state of a car in equilibrium.

use super::super::equations::{LOADS, TRAVELS, UNKNOWNS};
use super::super::tangent::Factors;
use crate::axle::AxlePose;
use crate::number::Each;

/// A state of a car in equilibrium.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// Values of the unknowns x of the equations.
    pub unknowns: [f64; UNKNOWNS],
    /// True for each lifted wheel: front left, front right, rear left, rear right.
    pub lifted: [bool; 4],
    /// Number of evaluations of the equations.
    pub evaluations: usize,
    /// Rack displacement of each axle.
    pub racks: [f64; 2],
    /// Poses of the wheels of each axle. `None` if the wheels were computed from their curves, which agree with poses
    /// up to rounding errors. If there are no poses, [`CarSolver::poses`](super::CarSolver::poses) solves them.
    pub(in crate::car) placed: Option<Box<[AxlePose; 2]>>,
    /// LU factors of the tangent (derivatives of the equations with respect to the unknowns) at one of the last steps.
    /// From there to the equilibrium, the tangent changes negligibly. `None` for a state from SIMD lanes whose tangent
    /// was not computed.
    pub(in crate::car) factors: Option<Box<Factors>>,
}

impl Equilibrium {
    /// Travels of the wheels: front left, front right, rear left, rear right.
    #[inline]
    pub(in crate::car) fn travels(&self) -> [f64; 4] {
        [0, 1, 2, 3].each(|k| self.unknowns[TRAVELS + k])
    }

    /// Loads of the wheels: front left, front right, rear left, rear right.
    pub(in crate::car) fn loads(&self) -> [f64; 4] {
        [0, 1, 2, 3].each(|k| self.unknowns[LOADS + k])
    }
}
