//! The loop over the waypoints of a route, for any number of unknowns. It predicts the unknowns from earlier waypoints,
//! corrects them by Newton's method until the residuals are at rounding level, and applies the checks.

use super::route::{Leg, RouteStep, Stencil};
use super::{Acceptance, Rejection};
use crate::number::SimdReal;

/// Result of tracking a route.
#[derive(Clone, Copy)]
pub struct Tracked<B: SimdReal> {
    /// Lanes that are accepted to the end of each leg of the route: [above the design position, below it].
    pub legs: [Acceptance<B>; 2],
    /// Number of rounds of corrections, for all lanes together.
    pub rounds: u64,
}

impl<B: SimdReal> Tracked<B> {
    /// Lanes that are accepted at every station.
    #[inline(always)]
    pub fn everywhere(&self) -> B::Mask {
        self.legs[0].lanes() & self.legs[1].lanes()
    }
}

/// Equations for the `N` unknowns of a waypoint, and the visitor of the solved poses.
pub(super) trait PlaceEquations<B: SimdReal, const N: usize> {
    /// Largest number of corrections in which the design of a SIMD lane must converge.
    const MOST_ROUNDS: usize;
    /// True if rejected lanes count as converged. This setting is useful if a round makes corrections until all lanes
    /// have converged. If a round makes one correction, the loop is faster without it.
    const LEAVES_REJECTED: bool = false;
    /// Numbers of a waypoint that the checks compare with the numbers of the next waypoint.
    type Guard: Copy;

    /// Predicts the unknowns from the previous waypoints.
    fn predict(&mut self, place: &RouteStep, history: &[B]) -> [B; N];
    /// Makes one correction. The first correction of a waypoint is round 1. Returns the lanes whose residuals are at
    /// rounding level. Lanes that have converged (`settled`) keep their unknowns.
    fn correct(
        &mut self,
        place: &RouteStep,
        unknowns: &mut [B; N],
        settled: B::Mask,
        round: usize,
    ) -> B::Mask;
    /// Accepts lanes that are well conditioned and on their solution branch. `before` holds the numbers of the previous
    /// waypoint, if there is one. These numbers determine the branch. Returns the numbers of this waypoint for the next check.
    fn check(
        &mut self,
        place: &RouteStep,
        unknowns: &[B; N],
        before: &Option<Self::Guard>,
        accepted: &mut Acceptance<B>,
    ) -> Self::Guard;
    /// Passes the pose at a station to the visitor.
    fn visit(
        &mut self,
        place: &RouteStep,
        station: usize,
        unknowns: &[B; N],
        accepted: Acceptance<B>,
    );
}

/// Visits every waypoint of a route. `history` receives the unknowns and must have space for the unknowns of all waypoints.
#[inline(always)]
pub(super) fn track<B: SimdReal, const N: usize, E: PlaceEquations<B, N>>(
    equations: &mut E,
    places: &[RouteStep],
    start: Acceptance<B>,
    history: &mut [B],
) -> Tracked<B> {
    let zero = history[0].zero();
    let mut tracked = Tracked {
        legs: [start; 2],
        rounds: 0,
    };
    let mut last = [None; 2];
    // Unused stencil entries refer to waypoint 0 with weight 0. Waypoint 0 is set to zero, because 0 times NaN is
    // NaN.
    history[..N].fill(zero);
    for (number, place) in places.iter().enumerate() {
        let side = place.leg.side();
        let mut accepted = tracked.legs[side];
        let predicted = equations.predict(place, history);
        let here = &mut history[N * number..N * (number + 1)];
        // The prediction of later waypoints uses these unknowns, so they must not contain NaN even if no lane was
        // accepted.
        if !B::any(accepted.lanes()) {
            here.copy_from_slice(&predicted);
            continue;
        }
        let mut unknowns = predicted;
        let mut settled = if E::LEAVES_REJECTED {
            !accepted.lanes()
        } else {
            zero.less(zero)
        };
        let mut round = 1;
        loop {
            settled = settled | equations.correct(place, &mut unknowns, settled, round);
            tracked.rounds += 1;
            if round == E::MOST_ROUNDS || B::all(settled | !accepted.lanes()) {
                break;
            }
            round += 1;
        }
        accepted.require(settled, Rejection::NotSettled);
        let guard = equations.check(place, &unknowns, &last[side], &mut accepted);
        here.copy_from_slice(&kept(accepted.lanes(), unknowns, predicted));
        match place.leg {
            Leg::Rack => {
                last = [Some(guard); 2];
                tracked.legs = [accepted; 2];
            }
            Leg::Up | Leg::Down => {
                last[side] = Some(guard);
                tracked.legs[side] = accepted;
            }
        }
        if let Some(station) = place.station {
            equations.visit(place, station, &unknowns, accepted);
        }
    }
    tracked
}

/// Predicts unknowns from earlier waypoints, and adds `along_slopes`: a step along the slopes of the base design,
/// which predicts the first steps.
#[inline(always)]
pub(super) fn predicted<B: SimdReal, const N: usize>(
    place: &RouteStep,
    history: &[B],
    along_slopes: [f64; N],
) -> [B; N] {
    let mut unknowns = [history[0]; N];
    for k in 0..N {
        let along = history[0].constant(along_slopes[k]);
        unknowns[k] = weighted::<N, _, B>(&place.prediction, history, k) + along;
    }
    unknowns
}

/// Weighted sum of unknown number `unknown` over the visited waypoints. The nearest waypoint is added last, because its
/// unknown is computed last.
#[inline(always)]
pub(super) fn weighted<const N: usize, const PLACES: usize, B: SimdReal>(
    weights: &Stencil<PLACES>,
    history: &[B],
    unknown: usize,
) -> B {
    let mut k = weights.len() - 1;
    let mut sum = history[N * weights[k].0 + unknown] * history[0].constant(weights[k].1);
    while k > 0 {
        k -= 1;
        let (place, weight) = weights[k];
        sum = sum.plus_product(history[N * place + unknown], history[0].constant(weight));
    }
    sum
}

/// Selects `yes` where the mask is set, else `no`.
#[inline(always)]
pub(super) fn kept<B: SimdReal, const N: usize>(mask: B::Mask, yes: [B; N], no: [B; N]) -> [B; N] {
    let mut kept = yes;
    for k in 0..N {
        kept[k] = B::select(mask, yes[k], no[k]);
    }
    kept
}
