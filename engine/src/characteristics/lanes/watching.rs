//! Checks the rods of rockers for toggles from station to station.

use crate::mechanism::{Configuration, RodReach, Twist};
use crate::model::RockerId;
use crate::number::{Outlined, SimdReal};

/// Positions of the rods of rockers at earlier stations.
#[derive(Clone, Debug)]
pub(super) struct ToggleWatch<B> {
    /// Positions of each rod at the first and at the latest station.
    rods: Vec<[RodReach<B>; 2]>,
    /// True if a station at this rack displacement has been visited.
    has_begun: bool,
}

impl<B> ToggleWatch<B> {
    /// Prepares for stations at another rack displacement.
    #[inline(always)]
    pub(super) fn begin(&mut self) {
        self.has_begun = false;
    }
}

impl<B: SimdReal> ToggleWatch<B> {
    /// Makes a record for this number of rockers, without any rod positions. `nothing` is NaN.
    #[inline(always)]
    pub(super) fn of(rockers: usize, nothing: B) -> Self {
        ToggleWatch {
            rods: vec![[RodReach::filled(nothing); 2]; rockers],
            has_begun: false,
        }
    }

    /// Advances to the next pose, given the motion of the knuckle in that pose. Returns the lanes in which no rod can have
    /// reached a toggle since the previous station.
    #[inline(always)]
    pub(super) fn watch(
        &mut self,
        rockers: &[RockerId],
        at: &Configuration<'_, B>,
        motion: &Twist<B>,
    ) -> B::Mask {
        let watching = Watching {
            rockers,
            at,
            motion,
            on_their_way: self,
        };
        at.rack.outlined(watching)
    }
}

struct Watching<'i, B: SimdReal> {
    rockers: &'i [RockerId],
    at: &'i Configuration<'i, B>,
    motion: &'i Twist<B>,
    on_their_way: &'i mut ToggleWatch<B>,
}

impl<B: SimdReal> Outlined for Watching<'_, B> {
    type Output = B::Mask;
    #[inline(always)]
    fn work(self) -> B::Mask {
        let mut right = self.at.rack.everywhere();
        let ToggleWatch { rods, has_begun } = self.on_their_way;
        for ([first, last], id) in rods.iter_mut().zip(self.rockers) {
            let rod = self.at.moving_rod(*id, self.motion);
            let before = if *has_begun {
                // If the next station lies on the other side of the first station, the first station is nearer than the
                // previous station.
                rod.nearer(first, last)
            } else {
                // Before the first station, the rack has moved from the design position. So the path begins with the rod in
                // the design position, except on a steered axle.
                *first = rod;
                if self.at.mechanism.axle_steering().is_some() {
                    // Before the first station, the steering gear has also moved. So the path begins with the axle at
                    // rest and the steering gear at its new position.
                    self.at.rod_at_rest(*id)
                } else {
                    self.at.designed_rod(*id)
                }
            };
            right = right & before.keeps_leverage_to(&rod);
            *last = rod;
        }
        *has_begun = true;
        right
    }
}
