//! Both wheels of an axle at a time, an axle in each lane.
//!
//! In heave both wheels have the same travel, and each is found as it would be alone. With the body rolled by phi
//! on a plane ground of normal n both contact points C are at one height over it, and the travels z = heave +- s
//! follow from that:
//!
//! ```text
//! f(s) = h_l(heave + s) - h_r(heave - s) = 0      h = n.C,  f_s = h_l' + h_r'
//! ```
//!
//! The poses of both wheels and s are predicted along the roll angle, as the pose of one wheel is along its
//! travel, and corrected together: one step of Newton's method, with the closure equations and f linearised at the
//! prediction, nearly always leaves nothing but rounding. C is the lowest point of the wheel, so that h' is
//! n.C' with the wheel locked.
//!
//! Beyond what is asked of each wheel, a lane is rejected where a contact point rises less than half as fast as
//! its wheel.

use super::route::{Leg, Route, RouteStep};
use super::{
    Acceptance, Batch, Form, KnucklePoint, KnuckleVector, LONGEST_STEP, LaneDesign, LanePose,
    Method, Rejection, Tracked, weighted,
};
use crate::derive::DesignedSpinAxis;
use crate::mechanism::Ground;
use crate::model::{Drive, Mechanism};
use crate::number::{SimdReal, Vector3, outlined};
use crate::solve::StationOrder;

/// Corrections a lane may take to settle.
const MOST_ROUNDS: usize = 5;
/// The least rise of a contact point by the travel of its wheel.
const LEAST_RISE: f64 = 0.5;
/// How far apart the heights of both contact points may be, in the tolerance of a length: a height is a sum of
/// more roundings.
const OF_HEIGHTS: f64 = 4.0;

/// What the stations of a route are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PairDrive {
    /// Equal travels of both wheels, each on a level pad.
    Heave,
    /// Roll angles on a plane ground.
    Roll {
        /// From the middle of the axle to a contact point, about.
        half_track: f64,
        /// Loaded radius of the wheels.
        radius: f64,
    },
}

/// The stations that are visited in one go.
#[derive(Clone, Debug)]
pub struct PairStations {
    /// Mean travel in roll; 0 in heave.
    pub heave: f64,
    /// Displacement of the rack towards the left wheel's outside.
    pub rack: f64,
    /// Travels or roll angles.
    pub order: StationOrder,
}

/// A way to solve axles of one kind in lanes.
#[derive(Clone, Debug)]
pub struct PairBatch<'a> {
    wheels: [Batch<'a>; 2],
    drive: PairDrive,
    routes: Vec<Route>,
}

/// Where an axle stands.
#[derive(Clone, Copy)]
pub struct Stand<B> {
    /// Travels of left and right wheel.
    pub travels: [B; 2],
    /// The ground in the left wheel's frame.
    pub ground: Ground<B>,
    /// Roll angle.
    pub roll: B,
}

/// What is read off the poses of both wheels.
pub trait VisitPair<B: SimdReal> {
    /// The poses of left and right wheel, each in its own frame, as [`Visit::pose`](super::Visit::pose) has them.
    fn pair<P: LanePose<B>>(
        &mut self,
        station: usize,
        at: [&P; 2],
        stand: Stand<B>,
        accepted: Acceptance<B>,
    );
}

/// How a wheel moves, to first order, from unknowns that are near a pose.
pub(super) struct Linear<B: SimdReal> {
    /// The wheel centre.
    pub centre: Vector3<B>,
    /// Unit vector along the spin axis.
    pub axis: Vector3<B>,
    /// Velocity of the wheel centre and angular velocity, to the pose at the travel wanted,
    pub rest: [Vector3<B>; 2],
    /// and from there on by the travel.
    pub rate: [Vector3<B>; 2],
    /// Whether the pose is near.
    pub is_near: B::Mask,
}

/// What unknowns have come to.
pub(super) struct Corrected<B: SimdReal, const N: usize> {
    /// Where the residuals are rounding.
    pub is_settled: B::Mask,
    /// The unknowns, what is left of the residuals taken away.
    pub unknowns: [B; N],
    /// The wheel centre.
    pub centre: Vector3<B>,
    /// Unit vector along the spin axis.
    pub axis: Vector3<B>,
}

/// One wheel of a pair, of `N` unknowns.
pub(super) trait Wheel<B: SimdReal, const N: usize> {
    /// What is watched along the path.
    type Guard: Copy;

    /// Derivatives of the unknowns by travel and by the rack in the base design.
    fn slopes(&self) -> [[f64; N]; 2];
    /// The guard before the first place.
    fn start(&self) -> Self::Guard;
    /// Linearises at unknowns near the pose at a travel, lanes being frozen that have settled.
    fn linear(&mut self, unknowns: &[B; N], rack: B, travel: B, settled: B::Mask) -> Linear<B>;
    /// The unknowns at a travel so much beyond that of the linearisation.
    fn moved(&self, unknowns: &[B; N], further: B) -> [B; N];
    /// Looks at unknowns that should be those at a travel.
    fn corrected(&mut self, unknowns: &[B; N], rack: B, travel: B) -> Corrected<B, N>;
    /// Accepts lanes that are well conditioned and on their branch, `step` being the way from the guard before in
    /// travel, on the stations' legs.
    fn check(
        &self,
        unknowns: &[B; N],
        before: Option<&Self::Guard>,
        step: Option<B>,
        accepted: &mut Acceptance<B>,
    ) -> Self::Guard;
    /// The pose of these unknowns.
    fn pose<'p>(&'p self, unknowns: &[B; N], rack: B, travel: B) -> impl LanePose<B> + 'p;
}

/// The centre and the spin axis of a wheel, fixed to its knuckle.
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

/// Height of the contact point over the ground's origin, with its change by the motions of the wheel.
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

impl<'a> PairBatch<'a> {
    /// For axles of these mechanisms near `bases`, left and right, each in its own frame; `None` where they cannot
    /// be solved in lanes.
    pub fn new(
        mechanisms: [&'a Mechanism; 2],
        bases: [&[Vector3<f64>]; 2],
        drive: PairDrive,
        stations: &[PairStations],
    ) -> Option<Self> {
        let nowhere = StationOrder::through(&[]);
        let wheel =
            |side: usize| Batch::new(mechanisms[side], bases[side], Drive::Travel, &nowhere, &[]);
        let wheels = [wheel(0)?, wheel(1)?];
        let longest_travel = LONGEST_STEP * mechanisms[0].size(bases[0]);
        let longest = match drive {
            PairDrive::Heave => longest_travel,
            PairDrive::Roll { half_track, .. } => longest_travel / half_track,
        };
        let route = |s: &PairStations| {
            Route::with_lead(&s.order, [s.rack, s.heave], longest, longest_travel)
        };
        Some(PairBatch {
            routes: stations.iter().map(route).collect(),
            wheels,
            drive,
        })
    }

    /// Whether it visits every station: two may not coincide, and none be out of all reach.
    pub fn is_complete(&self) -> bool {
        self.routes.iter().all(|route| route.is_complete)
    }

    /// The batch of a wheel, for the constants of its designs.
    pub fn wheel(&self, side: usize) -> &Batch<'a> {
        &self.wheels[side]
    }

    /// Room for the history of [`PairBatch::solve`].
    pub fn history<B: SimdReal>(&self, like: B) -> Vec<B> {
        let places = self.routes.iter().map(|route| route.places.len());
        let unknowns = self.wheels[0].unknowns();
        vec![like.zero(); (2 * unknowns + 1) * places.max().unwrap_or(0)]
    }

    /// Visits the stations of this number. The designs, left and right, must be of [`PairBatch::wheel`], and
    /// `points` what they were made of.
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
        let mut accepted = Acceptance::everywhere(left.origin.x);
        accepted.require(left.distinct & right.distinct, Rejection::NoLength);
        let on_left = WheelOnKnuckle::of(self.wheels[0].mechanism, left, points[0]);
        let on_right = WheelOnKnuckle::of(self.wheels[1].mechanism, right, points[1]);
        let [first, second] = &self.wheels;
        match (&first.way, &second.way, &left.form, &right.form) {
            (Method::Arm(one), Method::Arm(two), Form::Arm(left), Form::Arm(right)) => {
                let mut left = one.wheel(left, on_left, first.tolerance);
                let mut right = two.wheel(right, on_right, second.tolerance);
                self.track(&mut left, &mut right, places, accepted, history, visit)
            }
            (
                Method::Linkage(one),
                Method::Linkage(two),
                Form::Linkage(left),
                Form::Linkage(right),
            ) => {
                let mut left = one.wheel(left, on_left, first.tolerance);
                let mut right = two.wheel(right, on_right, second.tolerance);
                self.track(&mut left, &mut right, places, accepted, history, visit)
            }
            _ => unreachable!("designs of another batch"),
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

    #[inline(always)]
    fn track<B: SimdReal, const N: usize, W: Wheel<B, N>>(
        &self,
        left: &mut W,
        right: &mut W,
        places: &[RouteStep],
        start: Acceptance<B>,
        history: &mut [B],
        visit: &mut impl VisitPair<B>,
    ) -> Tracked<B> {
        let zero = history[0].zero();
        let radius = match self.drive {
            PairDrive::Heave => None,
            PairDrive::Roll { radius, .. } => Some(radius),
        };
        let coarser = self.wheels[0].tolerance.max(self.wheels[1].tolerance);
        let level = zero.lit(OF_HEIGHTS * coarser);
        let least_rise = zero.lit(LEAST_RISE);
        let (left_history, rest) = history.split_at_mut(N * places.len());
        let (right_history, half_history) = rest.split_at_mut(N * places.len());
        // Unused stencil entries point at place 0 with weight 0; 0 times NaN is NaN.
        left_history[..N].fill(zero);
        right_history[..N].fill(zero);
        half_history[0] = zero;
        let mut tracked = Tracked::start(start);
        // By leg.
        let mut last = [([left.start(), right.start()], [zero; 2]); 2];
        for (number, place) in places.iter().enumerate() {
            let mut accepted = tracked.legs[place.leg.side()];
            let (mean, roll) = self.at(place);
            let (mean, roll) = (zero.lit(mean), roll);
            let ground = Ground {
                sine: zero.lit(roll.sin()),
                cosine: zero.lit(roll.cos()),
            };
            let rack = zero.lit(place.rack);
            // The first steps go by the slopes of the base design.
            let (along_left, along_right) = match self.drive {
                PairDrive::Heave => (place.along_slope, place.along_slope),
                PairDrive::Roll { half_track, .. } => (
                    place.along_heave - half_track * place.along_slope,
                    place.along_heave + half_track * place.along_slope,
                ),
            };
            let mut half = weighted::<1, _, B>(&place.prediction, half_history, 0, zero)
                + zero.lit(0.5 * (along_left - along_right));
            let mut left_unknowns = predicted(
                place,
                left_history,
                left.slopes(),
                [along_left, place.along_rack],
                zero,
            );
            let mut right_unknowns = predicted(
                place,
                right_history,
                right.slopes(),
                [along_right, -place.along_rack],
                zero,
            );
            let prediction = (left_unknowns, right_unknowns, half);
            let places_of = N * number..N * (number + 1);
            // What other places are predicted from must be a number even where nothing was found.
            if !B::any(accepted.lanes()) {
                left_history[places_of.clone()].copy_from_slice(&left_unknowns);
                right_history[places_of].copy_from_slice(&right_unknowns);
                half_history[number] = half;
                continue;
            }
            let mut settled = zero.less(zero);
            let mut is_near = settled;
            let mut rises = zero.everywhere();
            let mut round = 1;
            loop {
                let one = linear(left, &left_unknowns, [rack, mean + half], settled);
                let two = linear(right, &right_unknowns, [-rack, mean - half], settled);
                let mut step = zero;
                if let Some(radius) = radius {
                    let [left_height, left_rise] = height(ground, radius, &one);
                    let [right_height, right_rise] = height(ground.mirrored(), radius, &two);
                    step = (right_height - left_height) / (left_rise + right_rise);
                    let upward = least_rise.less(left_rise) & least_rise.less(right_rise);
                    rises = (rises & settled) | (upward & !settled);
                }
                if round == 1 {
                    is_near = one.is_near & two.is_near;
                }
                // A lane that has settled stays where it is.
                half = B::select(settled, half, half + step);
                left_unknowns = kept(settled, left_unknowns, left.moved(&left_unknowns, step));
                right_unknowns = kept(settled, right_unknowns, right.moved(&right_unknowns, -step));
                let one = corrected(left, &left_unknowns, [rack, mean + half]);
                let two = corrected(right, &right_unknowns, [-rack, mean - half]);
                let mut small = one.is_settled & two.is_settled;
                if let Some(radius) = radius {
                    let mirrored = ground.mirrored();
                    let left_contact = one.centre + ground.contact_lever(one.axis, radius);
                    let right_contact = two.centre + mirrored.contact_lever(two.axis, radius);
                    let apart =
                        ground.normal().dot(left_contact) - mirrored.normal().dot(right_contact);
                    small = small & apart.abs().less(level);
                }
                left_unknowns = kept(!small | settled, left_unknowns, one.unknowns);
                right_unknowns = kept(!small | settled, right_unknowns, two.unknowns);
                settled = settled | small;
                tracked.rounds += 1;
                if round == MOST_ROUNDS || B::all(settled | !accepted.lanes()) {
                    break;
                }
                round += 1;
            }
            accepted.require(settled, Rejection::NotSettled);
            accepted.require(is_near, Rejection::ChangedTooMuch);
            accepted.require(rises, Rejection::FoldNear);
            let side = place.leg.side();
            let travels = [mean + half, mean - half];
            let (mut guards, before) = last[side];
            let is_on_the_way = place.leg == Leg::Rack;
            let unknowns = [&left_unknowns, &right_unknowns];
            // A loop, for the compiler: the guards are the longest piece of the way.
            let mut wheel = 0;
            while wheel < 2 {
                let step = match is_on_the_way {
                    true => None,
                    false => Some(travels[wheel] - before[wheel]),
                };
                let guard = guards[wheel];
                let known = match number {
                    0 => None,
                    _ => Some(&guard),
                };
                let of = [&*left, &*right][wheel];
                guards[wheel] = of.check(unknowns[wheel], known, step, &mut accepted);
                wheel += 1;
            }
            let watch = (guards, travels);
            match is_on_the_way {
                true => last = [watch; 2],
                false => last[side] = watch,
            }
            let found = accepted.lanes();
            let (left_predicted, right_predicted, half_predicted) = prediction;
            left_history[places_of.clone()].copy_from_slice(&kept(
                found,
                left_unknowns,
                left_predicted,
            ));
            right_history[places_of].copy_from_slice(&kept(found, right_unknowns, right_predicted));
            half_history[number] = B::select(found, half, half_predicted);
            tracked.set(place.leg, accepted);
            if let Some(station) = place.station {
                let stand = Stand {
                    travels,
                    ground,
                    roll: zero.lit(roll),
                };
                let one = left.pose(&left_unknowns, rack, travels[0]);
                let two = right.pose(&right_unknowns, -rack, travels[1]);
                visit.pair(station, [&one, &two], stand, accepted);
            }
        }
        tracked
    }
}

/// [`Wheel::linear`] in a function of its own, for both wheels.
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

/// [`Wheel::corrected`] likewise.
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

/// `yes` where the mask is set, else `no`.
#[inline(always)]
fn kept<B: SimdReal, const N: usize>(mask: B::Mask, yes: [B; N], no: [B; N]) -> [B; N] {
    let mut kept = yes;
    for k in 0..N {
        kept[k] = B::select(mask, yes[k], no[k]);
    }
    kept
}

/// The unknowns of a wheel as the places before have them, with so much of travel and rack along the slopes.
#[inline(always)]
fn predicted<B: SimdReal, const N: usize>(
    place: &RouteStep,
    history: &[B],
    [by_travel, by_rack]: [[f64; N]; 2],
    [travel, rack]: [f64; 2],
    zero: B,
) -> [B; N] {
    let mut unknowns = [zero; N];
    for k in 0..N {
        let slope = by_travel[k] * travel + by_rack[k] * rack;
        unknowns[k] = weighted::<N, _, B>(&place.prediction, history, k, zero) + zero.lit(slope);
    }
    unknowns
}
