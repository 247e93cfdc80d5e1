//! Equations of a single wheel in six unknowns.

use super::super::route::RouteStep;
use super::super::track::{PlaceEquations, kept, predicted};
use super::super::{Acceptance, Rejection, Visit};
use super::newton::{BranchGuard, NewtonSteps};
use super::{ByLinkage, UNKNOWNS, moved};
use crate::number::{Real, SimdReal};

/// Largest number of corrections in which the design of a SIMD lane must converge.
const MOST_ROUNDS: usize = 5;

/// Equations of a single wheel.
pub(in crate::solve::tracker) struct LinkageCorner<'w, 'd, B: SimdReal, V> {
    pub(super) steps: NewtonSteps<'w, 'd, B>,
    pub(super) visitor: &'w mut V,
    /// Lanes in which Newton's first correction of this waypoint's prediction was within its limit.
    pub(super) is_near: B::Mask,
}

/// Rack displacement and travel at a waypoint.
#[inline(always)]
pub(super) fn at_place<B: Real>(place: &RouteStep, like: B) -> [B; 2] {
    [like.constant(place.rack), like.constant(place.value)]
}

impl<B: SimdReal, V: Visit<B>> PlaceEquations<B, UNKNOWNS> for LinkageCorner<'_, '_, B, V> {
    const MOST_ROUNDS: usize = MOST_ROUNDS;
    type Guard = BranchGuard<B>;

    #[inline(always)]
    fn predict(&mut self, place: &RouteStep, history: &[B]) -> [B; UNKNOWNS] {
        let ByLinkage {
            by_travel, by_rack, ..
        } = self.steps.method;
        let mut along = [0.0; UNKNOWNS];
        for k in 0..UNKNOWNS {
            along[k] = by_travel[k] * place.along_slope + by_rack[k] * place.along_rack;
        }
        predicted(place, history, along)
    }

    #[inline(always)]
    fn correct(
        &mut self,
        place: &RouteStep,
        unknowns: &mut [B; UNKNOWNS],
        settled: B::Mask,
        round: usize,
    ) -> B::Mask {
        let motion = at_place(place, unknowns[0]);
        let (_, step) = self.steps.linearise(unknowns, motion, settled);
        if round == 1 {
            self.is_near = self.steps.is_near(&step);
        }
        let next = moved(*unknowns, &step);
        let (_, is_settled, rest) = self.steps.check_residual(&next, motion);
        *unknowns = kept(settled, *unknowns, kept(is_settled, rest, next));
        is_settled
    }

    #[inline(always)]
    fn check(
        &mut self,
        _: &RouteStep,
        unknowns: &[B; UNKNOWNS],
        before: &Option<BranchGuard<B>>,
        accepted: &mut Acceptance<B>,
    ) -> BranchGuard<B> {
        accepted.require(self.is_near, Rejection::ChangedTooMuch);
        self.steps.guard(unknowns, before, accepted)
    }

    #[inline(always)]
    fn visit(
        &mut self,
        place: &RouteStep,
        station: usize,
        unknowns: &[B; UNKNOWNS],
        accepted: Acceptance<B>,
    ) {
        let pose = self.steps.pose(unknowns, at_place(place, unknowns[0]));
        self.visitor.pose(station, &pose, accepted);
    }
}
