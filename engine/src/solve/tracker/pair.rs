//! Both wheels of an axle at a time, with an axle in each lane.
//!
//! In heave both wheels have the same travel, and each is solved as a single wheel. In roll by the angle phi on a plane
//! ground with normal n, both contact points C have the same height above it. The travels z = heave +- s follow from
//!
//! ```text
//! f(s) = h_l(heave + s) - h_r(heave - s) = 0,    h = n.C                               (1)
//! f_s  = h_l' + h_r'                                                                   (2)
//! ```
//!
//! The poses of both wheels and s are predicted along the roll angle, like the pose of one wheel along its travel, and
//! corrected together. One step of Newton's method, with the closure equations and f linearised at the prediction, almost
//! always reaches rounding. C is the lowest point of the wheel, so h' is n.C' for a wheel that does not rotate in its
//! carrier.
//!
//! In addition to the conditions for each wheel, a lane is rejected if a contact point rises less than half as fast as its
//! wheel.

#[cfg(test)]
mod guards;

use super::linkage::UNKNOWNS;
use super::route::{Leg, Route, RouteStep};
use super::track::{PlaceEquations, Tracked, kept, predicted, track};
use super::{
    Acceptance, CornerTracker, Form, KnucklePoint, KnuckleVector, LONGEST_STEP, LaneDesign,
    LanePose, Method, Rejection,
};
use crate::derive::DesignedSpinAxis;
use crate::mechanism::Ground;
use crate::model::{AxleTravel, Drive, Mechanism};
use crate::number::{SimdReal, Vector3, outlined};
use crate::solve::StationOrder;

/// Largest number of corrections for a lane to settle.
const MOST_ROUNDS: usize = 5;
/// Smallest rise of a contact point per travel of its wheel.
const LEAST_RISE: f64 = 0.5;
/// Largest difference of the heights of both contact points, in tolerances of a length. A height contains more roundings
/// than a length.
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

/// Stations that are visited together. For a rigid axle, the mean travel takes the place of the rack, and the difference of
/// its travels the place of travel.
#[derive(Clone, Debug)]
pub struct PairStations {
    /// Mean travel in roll. 0 in heave.
    pub heave: f64,
    /// Displacement of the rack towards the left wheel's outside. For a rigid axle, the mean travel.
    pub rack: f64,
    /// Travels or roll angles.
    pub order: StationOrder,
}

/// Solves axles of one kind in lanes.
#[derive(Clone, Debug)]
pub struct AxleTracker<'a> {
    wheels: [CornerTracker<'a>; 2],
    drive: PairDrive,
    routes: Vec<Route>,
    /// Ratio of the right wheel's rack displacement to the left one's, each in its own frame: -1, or 1 if both are the mean
    /// travel of a rigid axle.
    right_rack: f64,
}

/// Travels, ground and roll angle of an axle, in each lane.
#[derive(Clone, Copy)]
pub struct GroundContact<B> {
    /// Travels of the left and right wheel.
    pub travels: [B; 2],
    /// The ground in the left wheel's frame.
    pub ground: Ground<B>,
    /// Roll angle.
    pub roll: B,
}

/// Receives the poses of both wheels.
pub trait VisitPair<B: SimdReal> {
    /// Receives the poses of the left and right wheel, each in its own frame, like [`Visit::pose`](super::Visit::pose).
    fn pair<P: LanePose<B>>(
        &mut self,
        station: usize,
        at: [&P; 2],
        stand: GroundContact<B>,
        accepted: Acceptance<B>,
    );
}

/// A wheel, linearised about unknowns near a pose.
pub(super) struct Linear<B: SimdReal> {
    /// Wheel centre.
    pub centre: Vector3<B>,
    /// Unit vector along the spin axis.
    pub axis: Vector3<B>,
    /// Displacement of the wheel centre and rotation, from the unknowns to the pose at the required travel.
    pub rest: [Vector3<B>; 2],
    /// Velocity of the wheel centre and angular velocity by the travel.
    pub rate: [Vector3<B>; 2],
    /// Lanes in which this pose is near.
    pub is_near: B::Mask,
}

/// A wheel after a correction of its unknowns.
pub(super) struct Corrected<B: SimdReal, const N: usize> {
    /// Lanes whose residuals are at rounding level.
    pub is_settled: B::Mask,
    /// Unknowns, corrected once more for the remaining residuals.
    pub unknowns: [B; N],
    /// Wheel centre.
    pub centre: Vector3<B>,
    /// Unit vector along the spin axis.
    pub axis: Vector3<B>,
}

/// One wheel of a pair, with `N` unknowns.
pub(super) trait Wheel<B: SimdReal, const N: usize> {
    /// Numbers whose change along the path is guarded.
    type Guard: Copy;

    /// Derivatives of the unknowns by travel and by the rack in the base design.
    fn slopes(&self) -> [[f64; N]; 2];
    /// Linearises about unknowns near the pose at a travel. Settled lanes keep the numbers of their guard.
    fn linear(&mut self, unknowns: &[B; N], rack: B, travel: B, settled: B::Mask) -> Linear<B>;
    /// The unknowns at the travel of the linearisation plus `further`.
    fn moved(&self, unknowns: &[B; N], further: B) -> [B; N];
    /// Checks and corrects unknowns that should be those at a travel.
    fn corrected(&mut self, unknowns: &[B; N], rack: B, travel: B) -> Corrected<B, N>;
    /// Accepts lanes that are well conditioned and on their branch. `step` is the change of travel since the previous guard.
    /// It is given only on the legs of stations.
    fn check(
        &self,
        unknowns: &[B; N],
        before: &Option<Self::Guard>,
        step: Option<B>,
        accepted: &mut Acceptance<B>,
    ) -> Self::Guard;
    /// Pose with these unknowns.
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

/// Height of the contact point above the ground's origin at the required travel, and its derivative by travel, both to first
/// order.
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
    /// Prepares to solve axles of these mechanisms near `bases`, left and right, each in its own frame. `None` if they
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
        let route =
            |s: &PairStations| Route::through(&s.order, [s.rack, s.heave], longest, longest_travel);
        Some(AxleTracker {
            routes: stations.iter().map(route).collect(),
            wheels,
            drive,
            right_rack: match &mechanisms[0].rigid_axle {
                Some(rigid) if rigid.held == AxleTravel::Mean => 1.0,
                _ => -1.0,
            },
        })
    }

    /// Ratio of the right wheel's rack displacement to the left one's, each in its own frame.
    pub fn right_rack(&self) -> f64 {
        self.right_rack
    }

    /// Returns true if the tracker visits every station. It leaves out stations that coincide or are far out of reach.
    pub fn is_complete(&self) -> bool {
        self.routes.iter().all(|route| route.is_complete)
    }

    /// Tracker of a wheel. It makes the constants of the wheel's designs.
    pub fn wheel(&self, side: usize) -> &CornerTracker<'a> {
        &self.wheels[side]
    }

    /// Allocates the history for [`AxleTracker::solve`].
    pub fn history<B: SimdReal>(&self, like: B) -> Vec<B> {
        let places = self.routes.iter().map(|route| route.places.len());
        let unknowns = self.wheels[0].unknowns();
        vec![like.zero(); (2 * unknowns + 1) * places.max().unwrap_or(0)]
    }

    /// Visits the stations of entry `stations` in the list given to [`AxleTracker::new`]. The designs, left and right, must
    /// be made by [`AxleTracker::wheel`], and `points` must be their points.
    #[inline(always)]
    pub fn solve<B: SimdReal>(
        &self,
        designs: [&LaneDesign<'_, B>; 2],
        points: [&[Vector3<B>]; 2],
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
            ) => {
                let left = one.wheel(left, on_left, first.tolerance);
                let right = two.wheel(right, on_right, second.tolerance);
                let mut pair = self.pair::<B, _, _, UNKNOWNS>([left, right], like, visit);
                track::<B, { 2 * UNKNOWNS + 1 }, _>(&mut pair, places, accepted, history)
            }
            _ => unreachable!("designs of another tracker"),
        }
    }

    /// Mean travel and roll angle at a place.
    #[inline(always)]
    fn at(&self, place: &RouteStep) -> (f64, f64) {
        match self.drive {
            PairDrive::Heave => (place.value, 0.0),
            PairDrive::Roll { .. } => (place.heave, place.value),
        }
    }

    /// Equations of both wheels, for designs of this tracker.
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
        let coarser = self.wheels[0].tolerance.max(self.wheels[1].tolerance);
        BothWheels {
            tracker: self,
            wheels,
            level: like.constant(OF_HEIGHTS * coarser),
            radius: match self.drive {
                PairDrive::Heave => None,
                PairDrive::Roll { radius, .. } => Some(radius),
            },
            visitor,
            ground: Ground::level(like),
            is_near: like.everywhere(),
            rises: like.everywhere(),
        }
    }
}

/// Equations of both wheels of an axle, each with `N` unknowns. The unknowns are those of the left wheel, those of the right
/// one, and half the difference of their travels.
struct BothWheels<'w, B: SimdReal, W, V, const N: usize> {
    tracker: &'w AxleTracker<'w>,
    wheels: [W; 2],
    /// Largest difference of the heights of both contact points.
    level: B,
    /// Loaded radius of the wheels, if both stand on one ground.
    radius: Option<f64>,
    visitor: &'w mut V,
    /// Ground at this place, in the left wheel's frame.
    ground: Ground<B>,
    /// Lanes in which the prediction of this place was within its permitted error.
    is_near: B::Mask,
    /// Lanes in which both contact points rise fast enough with their wheels.
    rises: B::Mask,
}

impl<B: SimdReal, W, V, const N: usize> BothWheels<'_, B, W, V, N> {
    /// [rack displacement, travel] of the left and right wheel at a place. `half` is half the difference of the travels.
    #[inline(always)]
    fn motions(&self, place: &RouteStep, half: B) -> [[B; 2]; 2] {
        let (mean, _) = self.tracker.at(place);
        let (mean, rack) = (half.constant(mean), half.constant(place.rack));
        let right = rack.scaled(self.tracker.right_rack);
        [[rack, mean + half], [right, mean - half]]
    }
}

/// Splits the unknowns into those of each wheel and half the difference of their travels.
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
    /// Guards of both wheels, and their travels.
    type Guard = ([Option<W::Guard>; 2], [B; 2]);

    #[inline(always)]
    fn predict(&mut self, place: &RouteStep, history: &[B]) -> [B; ALL] {
        let (_, roll) = self.tracker.at(place);
        self.ground = Ground {
            sine: history[0].constant(roll.sin()),
            cosine: history[0].constant(roll.cos()),
        };
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
            [along_right, self.tracker.right_rack * place.along_rack],
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
        if let Some(radius) = self.radius {
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
        // A settled lane does not change.
        half = B::select(settled, half, half + step);
        left_unknowns = kept(settled, left_unknowns, left.moved(&left_unknowns, step));
        right_unknowns = kept(settled, right_unknowns, right.moved(&right_unknowns, -step));
        let [on_left, on_right] = self.motions(place, half);
        let [left, right] = &mut self.wheels;
        let one = corrected(left, &left_unknowns, on_left);
        let two = corrected(right, &right_unknowns, on_right);
        let mut is_settled = one.is_settled & two.is_settled;
        if let Some(radius) = self.radius {
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
        // A loop, so that the compiler compiles the guards, the longest piece of the method, only once.
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
        let (_, roll) = self.tracker.at(place);
        let stand = GroundContact {
            travels: [left_travel, right_travel],
            ground: self.ground,
            roll: half.constant(roll),
        };
        let [left, right] = &self.wheels;
        let one = left.pose(&left_unknowns, left_rack, left_travel);
        let two = right.pose(&right_unknowns, right_rack, right_travel);
        self.visitor.pair(station, [&one, &two], stand, accepted);
    }
}

/// Calls [`Wheel::linear`] as a separate function, for both wheels.
#[inline(always)]
fn linear<B: SimdReal, const N: usize, W: Wheel<B, N>>(
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
fn corrected<B: SimdReal, const N: usize, W: Wheel<B, N>>(
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
