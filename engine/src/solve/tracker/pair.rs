//! Solves both wheels of an axle together, with one axle in each SIMD lane.
//!
//! In heave both wheels have the same travel, and each is solved as a single wheel. In roll by the angle phi on a plane
//! ground with normal n, both contact points C have the same height above it. The travels z = heave +- s follow from
//!
//! ```text
//! f(s) = h_l(heave + s) - h_r(heave - s) = 0,    h = n.C                               (1)
//! f_s  = h_l' + h_r'                                                                   (2)
//! ```
//!
//! The poses of both wheels and s are predicted along the roll angle, like the pose of one wheel along its travel, and corrected
//! together. A step of Newton's method linearises the closure equations and f at the prediction. After one step, the solution is
//! almost always exact up to rounding errors. C is the lowest point of the wheel, so h' is n.C' for a wheel that does not rotate in
//! its carrier.
//!
//! Wheels that share one mechanism have their own equations (see `linkage/one_body.rs`).
//!
//! The conditions for each wheel also apply. In roll, the tracker also rejects a lane if a contact point rises less than
//! half as fast as its wheel.

mod both_wheels;
#[cfg(test)]
mod guards;

use super::linkage::{NewtonSteps, OneBody, UNKNOWNS, UNKNOWNS_OF_AXLE};
use super::route::{Route, RouteStep};
use super::track::{Tracked, track};
use super::{
    Acceptance, CornerTracker, Form, KnucklePoint, KnuckleVector, LONGEST_STEP, LaneDesign,
    LanePose, Method, Rejection,
};
use crate::derive::DesignedSpinAxis;
use crate::mechanism::Ground;
use crate::model::{Drive, Mechanism};
use crate::number::{SimdReal, Vector3};
use crate::solve::StationOrder;
use both_wheels::BothWheels;

/// Largest number of corrections in which the axle of a SIMD lane must converge.
pub(super) const MOST_ROUNDS: usize = 5;
/// Smallest rise of a contact point per travel of its wheel.
pub(super) const LEAST_RISE: f64 = 0.5;
/// Largest permitted difference between the heights of the two contact points, as a multiple of the tolerance of a length. A
/// height contains more rounding errors than a length.
const OF_HEIGHTS: f64 = 4.0;

/// Coordinate whose values are the stations of a route.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PairDrive {
    /// Equal travels of both wheels, each on a level pad.
    Heave,
    /// Roll angles on a plane ground.
    Roll {
        /// Approximate distance of a contact point from the middle of the axle.
        half_track: f64,
        /// Loaded radius of the wheels.
        radius: f64,
    },
}

/// Stations that are visited together, at one mean travel and one rack displacement. For a rigid axle in roll, the mean
/// travel takes the place of the rack displacement.
#[derive(Clone, Debug)]
pub struct PairStations {
    /// Mean travel in roll. 0 in heave.
    pub heave: f64,
    /// Displacement of the rack towards the left wheel's outside. For a rigid axle, the mean travel in roll and 0 in heave.
    pub rack: f64,
    /// Largest height by which a steering gear lifts a wheel centre of the base design, at zero travel of the axle.
    pub lift: f64,
    /// Travels (in heave) or roll angles of the stations, and the order in which they are visited.
    pub order: StationOrder,
}

/// Solves axles of one kind in lanes.
#[derive(Clone, Debug)]
pub struct AxleTracker<'a> {
    wheels: [CornerTracker<'a>; 2],
    pub(super) drive: PairDrive,
    routes: Vec<Route>,
    /// True if the wheels share one mechanism.
    is_one_body: bool,
}

/// Travels, ground and roll angle of an axle, in each lane.
#[derive(Clone, Copy)]
pub struct GroundContact<B> {
    /// Travels of the left and right wheel.
    pub travels: [B; 2],
    /// The ground in the left wheel's frame.
    pub ground: Ground<B>,
    /// Roll angle of the body.
    pub roll: B,
}

/// Receives the poses of both wheels.
pub trait VisitPair<B: SimdReal> {
    /// Receives the poses of the left and right wheel, each in the frame of its wheel, like [`Visit::pose`](super::Visit::pose).
    fn pair<P: LanePose<B>, Q: LanePose<B>>(
        &mut self,
        station: usize,
        left: &P,
        right: &Q,
        stand: GroundContact<B>,
        accepted: Acceptance<B>,
    );
}

/// A wheel, linearised about unknowns near a pose.
pub(super) struct Linear<B: SimdReal> {
    /// Position of the wheel centre.
    pub centre: Vector3<B>,
    /// Unit vector along the spin axis.
    pub axis: Vector3<B>,
    /// Remaining displacement of the wheel centre, and remaining rotation, from the pose of these unknowns to the pose at the
    /// required travel.
    pub rest: [Vector3<B>; 2],
    /// Velocity of the wheel centre and angular velocity, both per unit of travel.
    pub rate: [Vector3<B>; 2],
    /// Lanes in which the step from these unknowns to the pose at the required travel is within its limit. All lanes if the
    /// wheel has one unknown.
    pub is_near: B::Mask,
}

/// A wheel after a correction of its unknowns.
pub(super) struct Corrected<B: SimdReal, const N: usize> {
    /// Lanes whose residuals are as small as rounding errors.
    pub is_settled: B::Mask,
    /// Unknowns. Six unknowns are corrected once more for the remaining residuals.
    pub unknowns: [B; N],
    /// Position of the wheel centre.
    pub centre: Vector3<B>,
    /// Unit vector along the spin axis.
    pub axis: Vector3<B>,
}

/// One wheel of a pair, with `N` unknowns.
pub(super) trait Wheel<B: SimdReal, const N: usize> {
    /// Numbers of a wheel that the checks compare from one waypoint (a station or a point between stations) to the next.
    type Guard: Copy;

    /// Derivatives of the unknowns with respect to travel and to the rack in the base design.
    fn slopes(&self) -> [[f64; N]; 2];
    /// Linearises about unknowns near the pose at a travel. In lanes that have converged (`settled`), the values for
    /// [`Wheel::check`] do not change.
    fn linear(&mut self, unknowns: &[B; N], rack: B, travel: B, settled: B::Mask) -> Linear<B>;
    /// Returns the unknowns at a travel. This travel is the travel of the linearisation plus `further`.
    fn moved(&self, unknowns: &[B; N], further: B) -> [B; N];
    /// Checks the residuals of moved unknowns at a travel. Six unknowns are corrected once more.
    fn corrected(&mut self, unknowns: &[B; N], rack: B, travel: B) -> Corrected<B, N>;
    /// Accepts lanes that are well conditioned and on their solution branch. `step` is the change of travel since the previous
    /// check. The caller passes `step` only on the legs of the route that contain the stations.
    fn check(
        &self,
        unknowns: &[B; N],
        before: &Option<Self::Guard>,
        step: Option<B>,
        accepted: &mut Acceptance<B>,
    ) -> Self::Guard;
    /// Pose for these unknowns.
    fn pose<'p>(&'p self, unknowns: &[B; N], rack: B, travel: B) -> impl LanePose<B> + 'p;
}

/// Centre and spin axis of a wheel, fixed to its knuckle.
pub(super) struct WheelOnKnuckle<B> {
    pub centre: KnucklePoint<B>,
    pub axis: KnuckleVector<B>,
}

impl<B: SimdReal> WheelOnKnuckle<B> {
    #[inline(always)]
    fn of(mechanism: &Mechanism, lanes: &LaneDesign<'_, B>, design: &[Vector3<B>]) -> Self {
        WheelOnKnuckle {
            centre: lanes.point(design[mechanism.wheel_centre.0]),
            axis: lanes.vector(DesignedSpinAxis::of(mechanism, design).direction),
        }
    }
}

/// Height of the contact point above the ground's origin at the required travel, and its derivative with respect to
/// travel, both to first order.
#[inline(always)]
fn height<B: SimdReal>(ground: Ground<B>, radius: f64, wheel: &Linear<B>) -> [B; 2] {
    let lever = ground.contact_lever(wheel.axis, radius);
    let normal = ground.normal();
    let [rest, rest_turn] = wheel.rest;
    let [rate, rate_turn] = wheel.rate;
    let here = normal.dot(wheel.centre + lever);
    [
        here + normal.dot(rest + rest_turn.cross(lever)),
        normal.dot(rate + rate_turn.cross(lever)),
    ]
}

impl<'a> AxleTracker<'a> {
    /// Prepares to solve axles of these mechanisms near `bases`, left and right, each in the frame of its wheel. `None` if they
    /// cannot be solved in lanes.
    pub fn new(
        mechanisms: [&'a Mechanism; 2],
        bases: [&[Vector3<f64>]; 2],
        drive: PairDrive,
        stations: &[PairStations],
    ) -> Option<Self> {
        let nowhere = StationOrder::through(&[]);
        let wheel = |side: usize| {
            CornerTracker::new(mechanisms[side], bases[side], Drive::Travel, &nowhere, &[])
        };
        let wheels = [wheel(0)?, wheel(1)?];
        let longest_travel = LONGEST_STEP * mechanisms[0].size(bases[0]);
        let longest = match drive {
            PairDrive::Heave => longest_travel,
            PairDrive::Roll { half_track, .. } => longest_travel / half_track,
        };
        let route = |s: &PairStations| {
            let lead = [s.rack, s.heave, s.lift];
            Route::through(&s.order, lead, longest, longest_travel)
        };
        Some(AxleTracker {
            routes: stations.iter().map(route).collect(),
            wheels,
            drive,
            is_one_body: mechanisms[0].rigid_axle.is_some(),
        })
    }

    /// Returns true if the tracker visits every station. A route leaves out stations that coincide or are too far away.
    pub fn is_complete(&self) -> bool {
        self.routes.iter().all(|route| route.is_complete)
    }

    /// Tracker of a wheel, which makes the constants of the wheel's designs.
    pub fn wheel(&self, side: usize) -> &CornerTracker<'a> {
        &self.wheels[side]
    }

    /// Allocates the memory for the unknowns at all waypoints, which is the `history` of [`AxleTracker::solve`].
    pub fn history<B: SimdReal>(&self, like: B) -> Vec<B> {
        let places = self.routes.iter().map(|route| route.places.len());
        let unknowns = if self.is_one_body {
            UNKNOWNS_OF_AXLE
        } else {
            2 * self.wheels[0].unknowns() + 1
        };
        vec![like.zero(); unknowns * places.max().unwrap_or(0)]
    }

    /// Visits the stations with index `stations` in the list that [`AxleTracker::new`] received. [`AxleTracker::wheel`] must have
    /// made the designs (left, right) from `points`. `rest` is the lift of the wheel centres by a steering gear: first the mean
    /// lift, then half the difference of both lifts.
    #[inline(always)]
    pub fn solve<B: SimdReal>(
        &self,
        designs: [&LaneDesign<'_, B>; 2],
        points: [&[Vector3<B>]; 2],
        rest: [B; 2],
        stations: usize,
        history: &mut [B],
        visit: &mut impl VisitPair<B>,
    ) -> Tracked<B> {
        let places = &self.routes[stations].places;
        let [left, right] = designs;
        let like = left.origin.x;
        let mut accepted = Acceptance::everywhere(like);
        accepted.require(left.distinct & right.distinct, Rejection::NoLength);
        let on_left = WheelOnKnuckle::of(self.wheels[0].mechanism, left, points[0]);
        let on_right = WheelOnKnuckle::of(self.wheels[1].mechanism, right, points[1]);
        let [first, second] = &self.wheels;
        match (&first.method, &second.method, &left.form, &right.form) {
            (Method::Arm(one), Method::Arm(two), Form::Arm(left), Form::Arm(right)) => {
                let left = one.wheel(left, on_left, first.tolerance);
                let right = two.wheel(right, on_right, second.tolerance);
                let mut pair = self.pair::<B, _, _, 1>([left, right], like, visit);
                track::<B, 3, _>(&mut pair, places, accepted, history)
            }
            (
                Method::Linkage(one),
                Method::Linkage(two),
                Form::Linkage(left),
                Form::Linkage(right),
            ) if self.is_one_body => {
                let axes = [
                    DesignedSpinAxis::of(first.mechanism, points[0]).direction,
                    DesignedSpinAxis::of(second.mechanism, points[1]).direction,
                ];
                let steps = NewtonSteps::of(one, left, first.tolerance);
                let level = self.level(like);
                let mut pair = OneBody::new(self, steps, right, axes, rest, level, visit);
                track::<B, UNKNOWNS_OF_AXLE, _>(&mut pair, places, accepted, history)
            }
            (
                Method::Linkage(one),
                Method::Linkage(two),
                Form::Linkage(left),
                Form::Linkage(right),
            ) => {
                let left = one.wheel(left, on_left, first.tolerance);
                let right = two.wheel(right, on_right, second.tolerance);
                let mut pair = self.pair::<B, _, _, UNKNOWNS>([left, right], like, visit);
                track::<B, { 2 * UNKNOWNS + 1 }, _>(&mut pair, places, accepted, history)
            }
            _ => unreachable!("designs of another tracker"),
        }
    }

    /// Mean travel and roll angle at a waypoint.
    #[inline(always)]
    pub(super) fn at(&self, place: &RouteStep) -> (f64, f64) {
        match self.drive {
            PairDrive::Heave => (place.value, 0.0),
            PairDrive::Roll { .. } => (place.heave, place.value),
        }
    }

    /// Ground at a waypoint, in the left wheel's frame.
    #[inline(always)]
    pub(super) fn ground<B: SimdReal>(&self, place: &RouteStep, like: B) -> Ground<B> {
        let (_, roll) = self.at(place);
        Ground {
            sine: like.constant(roll.sin()),
            cosine: like.constant(roll.cos()),
        }
    }

    /// Travels of both wheels at a waypoint, with the ground and the roll angle.
    #[inline(always)]
    pub(super) fn stand<B: SimdReal>(
        &self,
        place: &RouteStep,
        ground: Ground<B>,
        travels: [B; 2],
    ) -> GroundContact<B> {
        let (_, roll) = self.at(place);
        GroundContact {
            travels,
            ground,
            roll: travels[0].constant(roll),
        }
    }

    /// Loaded radius of the wheels. `None` if each wheel stands on its own pad.
    #[inline(always)]
    pub(super) fn radius(&self) -> Option<f64> {
        match self.drive {
            PairDrive::Heave => None,
            PairDrive::Roll { radius, .. } => Some(radius),
        }
    }

    /// Largest permitted difference between the heights of the two contact points.
    #[inline(always)]
    fn level<B: SimdReal>(&self, like: B) -> B {
        let coarser = self.wheels[0].tolerance.max(self.wheels[1].tolerance);
        like.constant(OF_HEIGHTS * coarser)
    }

    /// Equations of both wheels, for designs that this tracker has made.
    #[inline(always)]
    fn pair<'w, B, W, V, const N: usize>(
        &'w self,
        wheels: [W; 2],
        like: B,
        visitor: &'w mut V,
    ) -> BothWheels<'w, B, W, V, N>
    where
        B: SimdReal,
        W: Wheel<B, N>,
    {
        BothWheels {
            tracker: self,
            wheels,
            level: self.level(like),
            visitor,
            ground: Ground::level(like),
            is_near: like.everywhere(),
            rises: like.everywhere(),
        }
    }
}
