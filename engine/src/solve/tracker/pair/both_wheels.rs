//! Equations of both wheels of an axle on a ground.

use super::super::route::{Leg, RouteStep};
use super::super::track::{PlaceEquations, kept, predicted};
use super::super::{Acceptance, Rejection};
use super::{
    AxleTracker, Corrected, LEAST_RISE, Linear, MOST_ROUNDS, PairDrive, VisitPair, Wheel, height,
};
use crate::mechanism::Ground;
use crate::number::{SimdReal, outlined};

/// Equations of both wheels of an axle, each with `N` unknowns. The unknowns are the unknowns of the left wheel, then of
/// the right wheel, and half the difference of their travels.
pub(super) struct BothWheels<'w, B: SimdReal, W, V, const N: usize> {
    pub(super) tracker: &'w AxleTracker<'w>,
    pub(super) wheels: [W; 2],
    /// Largest permitted difference between the heights of the two contact points.
    pub(super) level: B,
    pub(super) visitor: &'w mut V,
    /// Ground at this waypoint, in the left wheel's frame.
    pub(super) ground: Ground<B>,
    /// Lanes in which the first correction of this waypoint's prediction was within its limit.
    pub(super) is_near: B::Mask,
    /// Lanes in which both contact points rise fast enough with their wheels.
    pub(super) rises: B::Mask,
}

impl<B: SimdReal, W, V, const N: usize> BothWheels<'_, B, W, V, N> {
    /// Returns [rack displacement, travel] of the left and right wheel at a waypoint. `half` is half the difference of
    /// the travels.
    #[inline(always)]
    fn motions(&self, place: &RouteStep, half: B) -> [[B; 2]; 2] {
        let (mean, _) = self.tracker.at(place);
        let (mean, rack) = (half.constant(mean), half.constant(place.rack));
        [[rack, mean + half], [-rack, mean - half]]
    }
}

/// Splits the unknowns of the axle into the unknowns of each wheel and half the difference of their travels.
#[inline(always)]
fn parted<B: Copy, const N: usize, const ALL: usize>(unknowns: &[B; ALL]) -> ([[B; N]; 2], B) {
    const { assert!(ALL == 2 * N + 1) };
    let mut wheels = [[unknowns[0]; N]; 2];
    wheels[0].copy_from_slice(&unknowns[..N]);
    wheels[1].copy_from_slice(&unknowns[N..2 * N]);
    (wheels, unknowns[2 * N])
}

/// Joins the unknowns of both wheels and half the difference of their travels.
#[inline(always)]
fn joined<B: Copy, const N: usize, const ALL: usize>(wheels: &[[B; N]; 2], half: B) -> [B; ALL] {
    const { assert!(ALL == 2 * N + 1) };
    let mut unknowns = [half; ALL];
    unknowns[..N].copy_from_slice(&wheels[0]);
    unknowns[N..2 * N].copy_from_slice(&wheels[1]);
    unknowns
}

impl<B, W, V, const N: usize, const ALL: usize> PlaceEquations<B, ALL>
    for BothWheels<'_, B, W, V, N>
where
    B: SimdReal,
    W: Wheel<B, N>,
    V: VisitPair<B>,
{
    const MOST_ROUNDS: usize = MOST_ROUNDS;
    /// Values for the checks of both wheels, and the travels of the wheels.
    type Guard = ([Option<W::Guard>; 2], [B; 2]);

    #[inline(always)]
    fn predict(&mut self, place: &RouteStep, history: &[B]) -> [B; ALL] {
        self.ground = self.tracker.ground(place, history[0]);
        // The first steps use the slopes of the base design.
        let (along_left, along_right) = match self.tracker.drive {
            PairDrive::Heave => (place.along_slope, place.along_slope),
            PairDrive::Roll { half_track, .. } => (
                place.along_heave - half_track * place.along_slope,
                place.along_heave + half_track * place.along_slope,
            ),
        };
        let mut along = [[0.0; N]; 2];
        let ways = [
            [along_left, place.along_rack],
            [along_right, -place.along_rack],
        ];
        for wheel in 0..2 {
            let [by_travel, by_rack] = self.wheels[wheel].slopes();
            let [travel, rack] = ways[wheel];
            for k in 0..N {
                along[wheel][k] = by_travel[k] * travel + by_rack[k] * rack;
            }
        }
        let half = 0.5 * (along_left - along_right);
        predicted(place, history, joined(&along, half))
    }

    #[inline(always)]
    fn correct(
        &mut self,
        place: &RouteStep,
        unknowns: &mut [B; ALL],
        settled: B::Mask,
        round: usize,
    ) -> B::Mask {
        let ([mut left_unknowns, mut right_unknowns], mut half) = parted::<B, N, ALL>(unknowns);
        let ground = self.ground;
        let mirrored = ground.mirrored();
        let [on_left, on_right] = self.motions(place, half);
        let [left, right] = &mut self.wheels;
        let one = linear(left, &left_unknowns, on_left, settled);
        let two = linear(right, &right_unknowns, on_right, settled);
        let mut step = half.zero();
        if let Some(radius) = self.tracker.radius() {
            let [left_height, left_rise] = height(ground, radius, &one);
            let [right_height, right_rise] = height(mirrored, radius, &two);
            step = (right_height - left_height) / (left_rise + right_rise);
            let least_rise = half.constant(LEAST_RISE);
            let upward = least_rise.less(left_rise) & least_rise.less(right_rise);
            self.rises = match round {
                1 => upward,
                _ => (self.rises & settled) | (upward & !settled),
            };
        }
        if round == 1 {
            self.is_near = one.is_near & two.is_near;
        }
        // A lane that has converged does not change.
        half = B::select(settled, half, half + step);
        left_unknowns = kept(settled, left_unknowns, left.moved(&left_unknowns, step));
        right_unknowns = kept(settled, right_unknowns, right.moved(&right_unknowns, -step));
        let [on_left, on_right] = self.motions(place, half);
        let [left, right] = &mut self.wheels;
        let one = corrected(left, &left_unknowns, on_left);
        let two = corrected(right, &right_unknowns, on_right);
        let mut is_settled = one.is_settled & two.is_settled;
        if let Some(radius) = self.tracker.radius() {
            let left_contact = one.centre + ground.contact_lever(one.axis, radius);
            let right_contact = two.centre + mirrored.contact_lever(two.axis, radius);
            let apart = ground.normal().dot(left_contact) - mirrored.normal().dot(right_contact);
            is_settled = is_settled & apart.abs().less(self.level);
        }
        let stays = !is_settled | settled;
        left_unknowns = kept(stays, left_unknowns, one.unknowns);
        right_unknowns = kept(stays, right_unknowns, two.unknowns);
        *unknowns = joined(&[left_unknowns, right_unknowns], half);
        is_settled
    }

    #[inline(always)]
    fn check(
        &mut self,
        place: &RouteStep,
        unknowns: &[B; ALL],
        before: &Option<Self::Guard>,
        accepted: &mut Acceptance<B>,
    ) -> Self::Guard {
        accepted.require(self.is_near, Rejection::ChangedTooMuch);
        accepted.require(self.rises, Rejection::FoldNear);
        let (wheels, half) = parted::<B, N, ALL>(unknowns);
        let [[_, left], [_, right]] = self.motions(place, half);
        let travels = [left, right];
        let (known, steps) = match before {
            None => ([None; 2], [None; 2]),
            Some((guards, before)) => (
                *guards,
                match place.leg {
                    Leg::Rack => [None; 2],
                    _ => [Some(left - before[0]), Some(right - before[1])],
                },
            ),
        };
        // Uses a loop, so that the checks, the longest part of the method, are compiled only once.
        let mut guards = known;
        let mut wheel = 0;
        while wheel < 2 {
            let (of, unknowns) = (&self.wheels[wheel], &wheels[wheel]);
            guards[wheel] = Some(of.check(unknowns, &known[wheel], steps[wheel], accepted));
            wheel += 1;
        }
        (guards, travels)
    }

    #[inline(always)]
    fn visit(
        &mut self,
        place: &RouteStep,
        station: usize,
        unknowns: &[B; ALL],
        accepted: Acceptance<B>,
    ) {
        let ([left_unknowns, right_unknowns], half) = parted::<B, N, ALL>(unknowns);
        let [[left_rack, left_travel], [right_rack, right_travel]] = self.motions(place, half);
        let travels = [left_travel, right_travel];
        let stand = self.tracker.stand(place, self.ground, travels);
        let [left, right] = &self.wheels;
        let one = left.pose(&left_unknowns, left_rack, left_travel);
        let two = right.pose(&right_unknowns, right_rack, right_travel);
        self.visitor.pair(station, &one, &two, stand, accepted);
    }
}

/// Calls [`Wheel::linear`] as a separate function, for both wheels.
#[inline(always)]
pub(super) fn linear<B: SimdReal, const N: usize, W: Wheel<B, N>>(
    wheel: &mut W,
    unknowns: &[B; N],
    [rack, travel]: [B; 2],
    settled: B::Mask,
) -> Linear<B> {
    outlined!(
        [B: SimdReal, W: Wheel<B, N>; N] travel;
        wheel: &'p mut W = wheel, unknowns: [B; N] = *unknowns, rack: B = rack, travel: B = travel,
        settled: B::Mask = settled => Linear<B> { wheel.linear(&unknowns, rack, travel, settled) }
    )
}

/// Calls [`Wheel::corrected`] as a separate function, for both wheels.
#[inline(always)]
pub(super) fn corrected<B: SimdReal, const N: usize, W: Wheel<B, N>>(
    wheel: &mut W,
    unknowns: &[B; N],
    [rack, travel]: [B; 2],
) -> Corrected<B, N> {
    outlined!(
        [B: SimdReal, W: Wheel<B, N>; N] travel;
        wheel: &'p mut W = wheel, unknowns: [B; N] = *unknowns, rack: B = rack, travel: B = travel
            => Corrected<B, N> { wheel.corrected(&unknowns, rack, travel) }
    )
}
