//! Residuals of a system of equations, and derivatives of the residuals.

#![expect(
    clippy::needless_range_loop,
    reason = "rows and columns of matrices are named by their numbers"
)]

use super::super::limb::{Evaluated, Followers, LimbStep, tangent_of};
use super::state::Step;
use super::{Held, LOOSE, MOST_JOINTS, MOST_LIMBS};
use crate::linear::elimination::eliminate;
use crate::linear::square::{MOST, SquareLu};
use crate::number::{Each, MaskOf, Scalar, SimdReal, Valued, array_of, outlined};

/// Equations of a wheel in a state.
#[derive(Clone, Copy, Debug)]
pub(in crate::compliance) struct Equations<T: Valued> {
    pub(in crate::compliance) size: usize,
    pub(in crate::compliance) residual: [T; MOST],
    pub(in crate::compliance) matrix: [[T; MOST]; MOST],
    pub(in crate::compliance) followers: [Followers<T>; MOST_LIMBS],
    /// Unbalanced forces on the inner unknowns of each part.
    pub(in crate::compliance) inner: [[T; 7]; MOST_LIMBS],
    /// First part that is unstable by itself, in any SIMD lane.
    pub(in crate::compliance) unstable: Option<usize>,
    /// SIMD lanes in which every part is stable by itself.
    pub(in crate::compliance) is_stable: MaskOf<T>,
    /// First part with a motion that has no stiffness, in any SIMD lane.
    pub(in crate::compliance) loose: Option<usize>,
    joints: usize,
}

/// Reason why a system has no Newton step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::compliance) enum Singular {
    /// A part has a motion without stiffness.
    Limb(usize),
    /// The carrier has a motion without stiffness.
    Carrier,
}

impl<T: Valued> Equations<T> {
    /// Makes the equations for this number of rigid joints. Their only forces are the external forces `held` on the
    /// carrier.
    #[inline(always)]
    pub(in crate::compliance) fn empty(like: T, joints: usize, held: Option<&Held<T>>) -> Self {
        let zero = like.zero();
        let mut equations = Equations {
            size: 6 + joints,
            residual: [zero; MOST],
            matrix: [[zero; MOST]; MOST],
            followers: [Followers::none(zero); MOST_LIMBS],
            inner: [[zero; 7]; MOST_LIMBS],
            unstable: None,
            is_stable: zero.plain_value().everywhere(),
            loose: None,
            joints,
        };
        equations.hold(held);
        equations
    }

    /// Resets the equations for another state.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        let zero = self.residual[0].zero();
        for i in 0..self.size {
            self.residual[i] = zero;
            for j in 0..self.size {
                self.matrix[i][j] = zero;
            }
        }
        self.size = 6 + self.joints;
        self.is_stable = zero.plain_value().everywhere();
        (self.unstable, self.loose) = (None, None);
    }

    /// Sets the residuals of the carrier to minus the external forces that hold it. Before, they must be zero.
    #[inline(always)]
    pub(super) fn hold(&mut self, held: Option<&Held<T>>) {
        if let Some(held) = held {
            for k in 0..6 {
                self.residual[k] = -held.carrier[k];
            }
        }
    }

    #[inline(always)]
    pub(in crate::compliance) fn note(&mut self, limb: usize, of: &Evaluated<T>) {
        self.is_stable = self.is_stable & of.is_stable;
        if !T::Plain::all(of.is_stable) {
            self.unstable = self.unstable.or(Some(limb));
        }
        // NaN fails this comparison.
        let is_held = of.least_pivot.is_above(LOOSE);
        if !T::Plain::all(is_held) {
            self.loose = self.loose.or(Some(limb));
        }
        self.followers[limb] = of.followers;
        self.inner[limb] = of.inner;
    }

    /// Sets the row and the column of a rigid joint with its gap `miss`.
    #[inline(always)]
    pub(in crate::compliance) fn set_joint(&mut self, number: usize, miss: T, row: [T; 6]) {
        let k = 6 + number;
        self.residual[k] = miss;
        for i in 0..6 {
            self.matrix[k][i] = row[i];
            self.matrix[i][k] = row[i];
        }
    }

    /// Makes the tangent stiffnesses constant, that is, removes their derivatives. [`Conditions::is_correction`](super::Conditions)
    /// requires this.
    pub(in crate::compliance) fn fix_tangents(&mut self) {
        self.matrix = self.matrix.each(|row| row.each(|c| tangent_of(c, true)));
        for followers in &mut self.followers {
            followers.by = followers.by.each(|row| row.each(|c| tangent_of(c, true)));
        }
    }

    /// Solves equation (1) of `system.rs` for the unknowns of a Newton step. `None` if the equations are singular in every SIMD
    /// lane.
    #[inline(always)]
    pub(in crate::compliance) fn solution(&self) -> Option<[T; MOST]> {
        outlined!(
            [T: Valued] self.residual[0]; own: &'p Equations<T> = self => Option<[T; MOST]> {
                let mut matrix = own.matrix;
                let mut solution = own.residual;
                for k in 0..own.size {
                    solution[k] = -solution[k];
                }
                let mut none = [[]; MOST];
                let is_regular = eliminate(&mut matrix, &mut none, &mut solution, own.size);
                T::Plain::any(is_regular).then_some(solution)
            }
        )
    }

    /// Computes all unknowns of the parts from the unknowns of equation (1) of `system.rs`. If `is_rate` is true, the result
    /// contains the rates of the unknowns along a motion in which the forces stay in balance.
    #[inline(always)]
    pub(in crate::compliance) fn step(&self, solution: &[T; MOST], is_rate: bool) -> Step<T> {
        let carrier: [T; 6] = array_of(|i| solution[i]);
        self.step_seen(solution, |_, limb| limb.step(&carrier, None, is_rate))
    }

    /// Works like `step`, but `of_limb` returns the step of each part with its own degrees of freedom. Its argument is
    /// the index of the part.
    #[inline(always)]
    pub(in crate::compliance) fn step_seen(
        &self,
        solution: &[T; MOST],
        of_limb: impl Fn(usize, &Followers<T>) -> LimbStep<T>,
    ) -> Step<T> {
        let carrier: [T; 6] = array_of(|i| solution[i]);
        let zero = carrier[0].zero();
        let mut joints = [zero; MOST_JOINTS];
        joints[..self.joints].copy_from_slice(&solution[6..6 + self.joints]);
        Step {
            carrier,
            limbs: array_of(|k| of_limb(k, &self.followers[k])),
            joints,
            vertical: if self.size > 6 + self.joints {
                solution[6 + self.joints]
            } else {
                zero
            },
        }
    }
}

impl<T: Scalar> Equations<T> {
    /// Tangent of the carrier: derivatives of the forces on it with respect to its shift and rotation.
    pub(in crate::compliance) fn tangent(&self) -> [[f64; 6]; 6] {
        array_of(|i| array_of(|j| self.matrix[i][j].value()))
    }

    /// Returns the rows of rigid joints and of the held height. The product of each row with a free motion of the
    /// carrier is zero.
    pub(in crate::compliance) fn rows(&self) -> impl Iterator<Item = [f64; 6]> + '_ {
        let row = |i: usize| array_of(|j| self.matrix[i][j].value());
        (6..self.size).map(row)
    }

    pub(in crate::compliance) fn factors(&self) -> Option<SquareLu<T>> {
        SquareLu::of(self.matrix, self.size)
    }
}
