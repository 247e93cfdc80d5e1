//! Newton steps in the six unknowns, and checks that the steps stay on the solution branch.

use super::super::{Acceptance, Rejection, within_half};
use super::linear::{Linear, Linearising};
use super::pose::LinkagePose;
use super::{ByLinkage, LinkageDesign, UNKNOWNS, moved};
use crate::mechanism::{Configuration, Driver, Twist};
use crate::number::{SimdReal, Vector3};
use std::cell::{Cell, RefCell};

/// Smallest accepted determinant of the blocks A and S (module `linkage`), divided by its value in the base design.
const LEAST: f64 = 0.25;

/// Largest accepted correction of a prediction in each direction, relative to the mechanism's size or in rad.
const LARGEST_CORRECTION: f64 = 0.02;
/// Largest rotation of the knuckle about each axis in one step, as the tangent of half the angle. Together with the limits of
/// the determinants this keeps Newton's method on the solution branch. `tests/it/lanes` compares every lane with the
/// continuation.
const LONGEST: f64 = 0.1;

/// Newton steps in the six unknowns.
pub(in crate::solve::tracker) struct NewtonSteps<'w, 'd, B> {
    pub(super) method: &'w ByLinkage,
    linkage: &'w LinkageDesign<'d, B>,
    tolerance: f64,
    /// Closure equations linearised about the latest unknowns.
    pub(super) linear: RefCell<Linear<B>>,
    /// Determinants of the blocks A and S (module `linkage`) in the linearisation with which each lane converged.
    pub(super) determinants: [B; 2],
}

impl<'w, 'd, B: SimdReal> NewtonSteps<'w, 'd, B> {
    #[inline(always)]
    pub(in crate::solve::tracker) fn of(
        method: &'w ByLinkage,
        linkage: &'w LinkageDesign<'d, B>,
        tolerance: f64,
    ) -> Self {
        let zero = linkage.design[0].x.zero();
        NewtonSteps {
            method,
            linkage,
            tolerance,
            linear: RefCell::new(Linear::unformed(method, zero)),
            determinants: [zero; 2],
        }
    }

    /// Linearises the equations about these unknowns. The determinants of lanes that have converged do not change.
    /// Returns the configuration with these unknowns and the Newton step.
    #[inline(always)]
    pub(super) fn linearise(
        &mut self,
        unknowns: &[B; UNKNOWNS],
        [rack, travel]: [B; 2],
        settled: B::Mask,
    ) -> (Configuration<'d, B>, Twist<B>) {
        let at = self.linkage.configuration(*unknowns, rack);
        let linear = self.linear.get_mut();
        travel.outlined(Linearising {
            linkage: self.linkage,
            at: &at,
            travel,
            linear,
        });
        let [a, s] = linear.blocks.determinants();
        let [known_a, known_s] = self.determinants;
        self.determinants = [
            B::select(settled, known_a, a),
            B::select(settled, known_s, s),
        ];
        let step = -linear.blocks.solve(linear.residuals);
        (at, step)
    }

    /// Derivative of the pose with respect to the travel, in the latest linearisation.
    #[inline(always)]
    pub(super) fn by_travel(&mut self) -> Twist<B> {
        self.linear.get_mut().by_travel()
    }

    /// Motion of the knuckle for these steps of rack and travel, in the latest linearisation.
    #[inline(always)]
    pub(super) fn along(&mut self, rack: B, travel: B) -> Twist<B> {
        let by_travel = self.by_travel();
        let by_rack = self.linear.get_mut().steering();
        Twist {
            shift: (by_rack.shift * rack).plus_scaled(by_travel.shift, travel),
            turn: (by_rack.turn * rack).plus_scaled(by_travel.turn, travel),
        }
    }

    /// Constants of the designs in the SIMD lanes.
    #[inline(always)]
    pub(super) fn linkage(&self) -> &'w LinkageDesign<'d, B> {
        self.linkage
    }

    /// Lanes in which a Newton step is within [`LARGEST_CORRECTION`], the largest accepted correction of a prediction.
    #[inline(always)]
    pub(super) fn is_near(&self, step: &Twist<B>) -> B::Mask {
        let like = step.shift.x;
        let largest = like.constant(LARGEST_CORRECTION);
        let inverse_size = like.constant(1.0 / self.method.size);
        is_less(step.shift * inverse_size, largest) & is_less(step.turn, largest)
    }

    /// Checks the unknowns after a step. Returns the configuration, the lanes whose residuals are at rounding level, and the
    /// unknowns after one more correction with the present Jacobian. Rates are accurate only with this correction.
    #[inline(always)]
    pub(super) fn check_residual(
        &mut self,
        unknowns: &[B; UNKNOWNS],
        motion: [B; 2],
    ) -> (Configuration<'d, B>, B::Mask, [B; UNKNOWNS]) {
        let (at, is_settled, rest) = self.remaining(unknowns, motion);
        (at, is_settled, moved(*unknowns, &rest))
    }

    /// Checks the unknowns after a step, and also returns the correction itself.
    #[inline(always)]
    pub(super) fn remaining(
        &mut self,
        unknowns: &[B; UNKNOWNS],
        [rack, travel]: [B; 2],
    ) -> (Configuration<'d, B>, B::Mask, Twist<B>) {
        let at = self.linkage.configuration(*unknowns, rack);
        let driver = Driver::Travel(travel);
        let missed = self.linkage.closure.residuals_inlined(&at, driver);
        let [a, b, c, d, e, g] = missed;
        let tolerance = travel.constant(self.tolerance);
        let is_settled =
            is_less(Vector3::new(a, b, c), tolerance) & is_less(Vector3::new(d, e, g), tolerance);
        let rest = -self.linear.get_mut().blocks.solve(missed);
        (at, is_settled, rest)
    }

    /// Accepts lanes that are well conditioned and on their solution branch.
    #[inline(always)]
    pub(super) fn guard(
        &self,
        &[_, _, _, x, y, z]: &[B; UNKNOWNS],
        before: &Option<BranchGuard<B>>,
        accepted: &mut Acceptance<B>,
    ) -> BranchGuard<B> {
        let guard = BranchGuard {
            turned: Vector3::new(x, y, z),
            determinants: self.determinants,
        };
        guard.check(&self.method.determinants, accepted);
        if let Some(before) = before {
            guard.check_step(before, accepted);
        }
        guard
    }

    #[inline(always)]
    pub(super) fn pose(
        &self,
        unknowns: &[B; UNKNOWNS],
        [rack, travel]: [B; 2],
    ) -> LinkagePose<'_, 'd, B> {
        LinkagePose {
            linkage: self.linkage,
            at: self.linkage.configuration(*unknowns, rack),
            travel,
            linear: &self.linear,
            is_linear: Cell::new(false),
        }
    }
}

/// Rotation of the knuckle and determinants at a waypoint. The checks compare them with their values at the next waypoint.
#[derive(Clone, Copy)]
pub(in crate::solve::tracker) struct BranchGuard<B> {
    /// Rotation of the knuckle, as tan(angle/2) times the axis.
    pub(super) turned: Vector3<B>,
    pub(super) determinants: [B; 2],
}

impl<B: SimdReal> BranchGuard<B> {
    /// Accepts lanes in which the Jacobian is about as well conditioned as in the base design. Rejects NaN.
    #[inline(always)]
    pub(super) fn check(&self, base: &[f64; 2], accepted: &mut Acceptance<B>) {
        let [a, s] = self.determinants;
        let is_conditioned = a.constant(LEAST * base[0].abs()).less(a.abs())
            & s.constant(LEAST * base[1].abs()).less(s.abs());
        accepted.require(is_conditioned, Rejection::IllConditioned);
    }

    /// Accepts lanes in which no determinant could have vanished since the previous waypoint and the knuckle has not rotated
    /// far. A determinant could have vanished if it changed too much.
    #[inline(always)]
    pub(super) fn check_step(&self, before: &Self, accepted: &mut Acceptance<B>) {
        let [a, s] = self.determinants;
        let is_steady =
            within_half(a, before.determinants[0]) & within_half(s, before.determinants[1]);
        accepted.require(is_steady, Rejection::ChangedTooMuch);
        let is_short = is_less(self.turned - before.turned, a.constant(LONGEST));
        accepted.require(is_short, Rejection::TurnedFar);
    }
}

/// Lanes in which the absolute value of every component is below a bound.
#[inline(always)]
fn is_less<B: SimdReal>(vector: Vector3<B>, bound: B) -> B::Mask {
    vector.x.abs().less(bound) & vector.y.abs().less(bound) & vector.z.abs().less(bound)
}
