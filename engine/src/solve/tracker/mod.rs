//! Tracks many designs at a time, one in each SIMD lane of the processor.
//!
//! This module computes all ordinary poses. A sweep has a design in each lane. A single design is computed with ordinary
//! numbers ([`poses`]). A mechanism with a closed form has one unknown ([`arm`]); every other mechanism has six
//! ([`linkage`]). An axle has the unknowns of each wheel and half the difference of the travels ([`pair`]). One loop solves
//! the equations in all cases ([`track`](mod@track)). It visits the waypoints of a route: the stations and the points that
//! divide long steps. The unknowns at a waypoint are predicted from earlier waypoints. Almost always one correction reaches
//! rounding; otherwise more steps follow. A converged lane is frozen, so its neighbours do not affect it.
//!
//! Checks, called guards in the code, decide at every waypoint which lanes are accepted. A rejected lane gets a reason
//! ([`Rejection`]) and stays rejected to the end of its leg, up or down. The continuation ([`Solver`](crate::solve::Solver))
//! then starts from the last accepted station. The tracker rejects a lane if
//!
//! - a rod has no length, or the iteration does not settle;
//! - the mechanism is not well conditioned;
//! - a number that must not vanish changes by more than half (or doubles) from one waypoint to the next, because it could
//!   vanish in between. In the closed form, this number is a product, and the same check applies to the slope of the path;
//! - the prediction of six unknowns needs a large correction;
//! - the mechanism rotates far in one step, or (in the closed form) from the design position;
//! - a fold is near, because the slope of an arm is large.
//!
//! Code that reads a pose also rejects lanes whose quantity is poorly determined. Examples are a horizontal steering axis, the
//! angles of a wheel on its side, and a rocker close to its toggle. Further examples are the steering axis if the rack
//! hardly rotates the knuckle, and velocities if a knuckle in six unknowns rotates fast per unit of travel.
//!
//! So a lane is either correct or rejected. The decision depends only on the design in the lane.

mod acceptance;
mod along_travel;
mod arm;
#[cfg(test)]
mod boundary;
mod linkage;
mod pair;
mod poses;
mod route;
mod track;

use super::closed_form::{Carried, Members, Roles};
use super::path::StationOrder;
use crate::derive::Gradient;
use crate::mechanism::{Configuration, Twist, Wrench};
use crate::model::{Drive, Mechanism, PointId, SteeringAxis};
use crate::number::{MOST_LANES, SimdReal, Vector3, outlined};
pub use acceptance::{Acceptance, Rejection};
pub(crate) use along_travel::{AlongTravel, SeriesDesign};
use arm::{ArmDesign, ByArm};
pub(crate) use arm::{FARTHEST, STEEPEST};
use linkage::{ByLinkage, LinkageDesign};
pub use pair::{AxleTracker, GroundContact, PairDrive, PairStations, VisitPair};
pub(crate) use poses::{PoseTracker, TrackedPoses};
use route::Route;
pub use track::Tracked;
use track::track;

/// Solves designs of one mechanism in lanes.
#[derive(Clone, Debug)]
pub struct CornerTracker<'a> {
    mechanism: &'a Mechanism,
    method: Method,
    drive: Drive,
    /// One route for each displacement of the rack.
    routes: Vec<Route>,
    /// Pairs of points that must not coincide: the ends of rods and axes.
    distinct: Vec<(PointId, PointId)>,
    /// Square of the shortest permitted distance between the points of a pair.
    shortest: f64,
    /// Largest residual that counts as a rounding error, as a length.
    tolerance: f64,
}

#[derive(Clone, Debug)]
enum Method {
    Arm(ByArm),
    Linkage(ByLinkage),
}

/// Receives the poses that the tracker solves.
pub trait Visit<B: SimdReal> {
    /// Receives a pose. Lanes that are not accepted may hold any numbers, including NaN. The tracker skips a station
    /// if no lane was accepted at the previous waypoint of its leg.
    fn pose(&mut self, station: usize, at: &impl AdjointPose<B>, accepted: Acceptance<B>);
}

/// Constants of the designs, one design in each SIMD lane.
#[derive(Clone)]
pub struct LaneDesign<'d, B: SimdReal> {
    form: Form<'d, B>,
    /// Origin of the knuckle in the design position. Poses contain the present position of the origin.
    origin: Vector3<B>,
    /// Lanes in which all rods and axes have a length.
    distinct: B::Mask,
}

#[derive(Clone)]
enum Form<'d, B: SimdReal> {
    Arm(ArmDesign<'d, B>),
    Linkage(LinkageDesign<'d, B>),
}

/// A vector fixed to the knuckle.
#[derive(Clone, Copy, Debug)]
pub struct KnuckleVector<B>(InKnuckle<B>);

#[derive(Clone, Copy, Debug)]
enum InKnuckle<B> {
    Carried(Carried<B>),
    Designed(Vector3<B>),
}

/// A point fixed to the knuckle.
#[derive(Clone, Copy, Debug)]
pub struct KnucklePoint<B>(KnuckleVector<B>);

/// Terms shared by the gradients in all poses of a design: the members that carry forces. `None` for a mechanism without a
/// closed form.
pub struct AdjointConstants<B>(Option<Members<B>>);

impl<B: SimdReal> LaneDesign<'_, B> {
    /// Vector of the knuckle, given in the design position.
    #[inline(always)]
    pub fn vector(&self, designed: Vector3<B>) -> KnuckleVector<B> {
        KnuckleVector(match &self.form {
            Form::Arm(arm) => InKnuckle::Carried(arm.carrier.carried(designed)),
            Form::Linkage(_) => InKnuckle::Designed(designed),
        })
    }

    /// Point of the knuckle, given in the design position.
    #[inline(always)]
    pub fn point(&self, designed: Vector3<B>) -> KnucklePoint<B> {
        KnucklePoint(self.vector(designed - self.origin))
    }
}

/// The mechanism in a pose, in each lane.
pub trait LanePose<B: SimdReal> {
    /// A vector of the knuckle in this pose.
    fn vector(&self, vector: &KnuckleVector<B>) -> Vector3<B>;
    /// Position of the knuckle's origin.
    fn origin(&self) -> Vector3<B>;
    /// A point of the steering axis, the vector along it, and the lanes in which both are accurate. An instantaneous axis is
    /// accurate if the rack rotates the knuckle enough and the axis is not near horizontal.
    fn steering_axis(&self) -> (Vector3<B>, Vector3<B>, B::Mask);
    /// Velocities of the knuckle per unit of the drive.
    fn rates(&self) -> LaneRates<B>;
    /// Velocity of the knuckle's origin and angular velocity, both per unit of rack displacement with the drive
    /// held, from the rates of this pose.
    fn by_rack(&self, rates: &LaneRates<B>) -> Twist<B>;
    /// Lanes in which velocities are accurate. Near a fold, the knuckle rotates fast and velocities are not accurate.
    fn velocity_is_reliable(&self, rates: &LaneRates<B>) -> B::Mask;
    /// Derivatives of the steering axis with respect to the drive.
    fn steering_axis_rates(&self, rates: &LaneRates<B>) -> (Vector3<B>, Vector3<B>);

    /// The pose as a configuration. `rack` is the rack displacement of the pose.
    fn configuration(&self, rack: B) -> Configuration<'_, B>;

    /// Position of a point of the knuckle.
    #[inline(always)]
    fn point(&self, point: &KnucklePoint<B>) -> Vector3<B> {
        self.origin() + self.vector(&point.0)
    }
}

/// A pose of a single wheel, which also gives gradients with respect to the hardpoints.
pub trait AdjointPose<B: SimdReal>: LanePose<B> {
    /// Prepares gradients in this pose, driven by the travel, from its configuration and rates.
    fn adjoint<'p>(
        &'p self,
        members: &'p AdjointConstants<B>,
        at: &'p Configuration<'p, B>,
        rates: &LaneRates<B>,
    ) -> impl LaneAdjoint<B> + 'p;
}

/// Makes gradients with respect to the hardpoints in a pose (see [`Seeds`](crate::derive::Seeds)).
pub trait LaneAdjoint<B: SimdReal> {
    /// Subtracts the effect of the closure equations from the gradient of an output that was computed at a fixed pose.
    /// `wrench` is the output's derivative with respect to the pose.
    fn subtract(&self, wrench: &Wrench<B>, gradient: &mut (impl Gradient<B> + ?Sized));
}

/// Motion of the knuckle in a pose, per unit of the drive.
#[derive(Clone, Copy)]
pub struct LaneRates<B> {
    origin: Vector3<B>,
    turn: Vector3<B>,
    /// Rate of the vector along the steering axis. Zero for a mechanism without a closed form.
    steering_axis: Vector3<B>,
}

impl<B: Copy> KnuckleVector<B> {
    /// The vector in the design position, if the mechanism is a linkage.
    #[inline(always)]
    fn designed(&self) -> Vector3<B> {
        match self.0 {
            InKnuckle::Designed(vector) => vector,
            InKnuckle::Carried(_) => unreachable!("linkages have this vector"),
        }
    }
}

impl<B: SimdReal> LaneRates<B> {
    /// Rates of a mechanism without a closed form.
    #[inline(always)]
    fn of(twist: Twist<B>) -> Self {
        LaneRates {
            origin: twist.shift,
            turn: twist.turn,
            steering_axis: twist.turn.zero(),
        }
    }

    /// Rate of a vector fixed to the knuckle, from the vector in this pose.
    #[inline(always)]
    pub fn vector(&self, now: Vector3<B>) -> Vector3<B> {
        self.turn.cross(now)
    }

    /// Velocity of a point fixed to the knuckle, from its position in this pose.
    #[inline(always)]
    pub fn point(&self, at: &impl LanePose<B>, now: Vector3<B>) -> Vector3<B> {
        self.origin + self.turn.cross(now - at.origin())
    }

    /// Angular velocity of the knuckle.
    #[inline(always)]
    pub fn turn(&self) -> Vector3<B> {
        self.turn
    }

    /// Velocity of the knuckle's origin and angular velocity.
    #[inline(always)]
    pub fn twist(&self) -> Twist<B> {
        Twist {
            shift: self.origin,
            turn: self.turn,
        }
    }
}

/// Longest step as a share of the size, or in rad for an arm's angle. Longer steps are divided.
const LONGEST_STEP: f64 = 0.02;
/// Largest residual that counts as a rounding error, as a share of the largest coordinate. The limit allows the rounding
/// errors of a few operations. Near a fold, rates amplify the remaining residual a thousandfold.
const TOLERANCE: f64 = 1e-15;
/// Shortest rod as a share of the largest coordinate. The continuation solves designs with shorter rods.
const SHORTEST_LENGTH: f64 = 1e-6;
/// Largest distance from the origin, relative to the mechanism's size. Mechanisms farther away are not tracked, because accuracy
/// would be lost.
const FAR: f64 = 100.0;

impl<'a> CornerTracker<'a> {
    /// Prepares to solve designs of this mechanism that are not far from `base`, with the rack at each of `racks`
    /// (towards the kernel's +y). `None` if they cannot be solved in lanes.
    pub fn new(
        mechanism: &'a Mechanism,
        base: &[Vector3<f64>],
        drive: Drive,
        station_order: &StationOrder,
        racks: &[f64],
    ) -> Option<Self> {
        let (size, coordinate_scale) = (mechanism.size(base), mechanism.coordinate_scale(base));
        let method = match Roles::of(mechanism) {
            Some(roles) => Method::Arm(ByArm::of(roles, base, drive, size)?),
            None => Method::Linkage(ByLinkage::of(mechanism, base, drive, size)?),
        };
        (coordinate_scale < FAR * size).then_some(())?;
        let longest = match drive {
            Drive::Travel => LONGEST_STEP * size,
            Drive::ArmAngle => LONGEST_STEP,
        };
        Some(CornerTracker {
            mechanism,
            method,
            drive,
            routes: racks
                .iter()
                .map(|rack| {
                    Route::through(
                        station_order,
                        [*rack, 0.0, 0.0],
                        longest,
                        LONGEST_STEP * size,
                    )
                })
                .collect(),
            distinct: mechanism.lengths().collect(),
            shortest: (SHORTEST_LENGTH * coordinate_scale).powi(2),
            tolerance: TOLERANCE * coordinate_scale,
        })
    }

    /// Returns true if the tracker visits every station. A route leaves out stations that coincide or are too far away.
    pub fn is_complete(&self) -> bool {
        self.routes.iter().all(|route| route.is_complete)
    }

    /// Coordinate that drives the mechanism.
    pub fn drive(&self) -> Drive {
        self.drive
    }

    /// Returns true if `axis` is the steering axis that [`LanePose::steering_axis`] returns.
    pub fn steers_about(&self, axis: Option<SteeringAxis>) -> bool {
        match &self.method {
            Method::Arm(method) => axis == Some(method.steering_axis()),
            Method::Linkage(_) => axis == Some(SteeringAxis::Instantaneous),
        }
    }

    /// Allocates the memory for the unknowns at all waypoints, which is the `history` of [`CornerTracker::solve`].
    pub fn history<B: SimdReal>(&self, like: B) -> Vec<B> {
        let places = self.routes.iter().map(|route| route.places.len());
        vec![like.zero(); self.unknowns() * places.max().unwrap_or(0)]
    }

    /// Length of the history (the unknowns at all waypoints) of a single design along the route at the `rack`-th rack
    /// displacement: unknowns times waypoints.
    pub(crate) fn steps(&self, rack: usize) -> usize {
        self.unknowns() * self.routes[rack].places.len()
    }

    /// Number of unknowns per station of one wheel.
    fn unknowns(&self) -> usize {
        match self.method {
            Method::Arm(_) => 1,
            Method::Linkage(_) => linkage::UNKNOWNS,
        }
    }

    /// Makes the constants of designs from their points. Each number contains one design in each lane.
    #[inline(always)]
    pub fn design<'d, B: SimdReal>(&'d self, design: &'d [Vector3<B>]) -> LaneDesign<'d, B> {
        outlined!(
            [B: SimdReal] design[0].x;
            tracker: &'p CornerTracker<'p> = self, design: &'p [Vector3<B>] = design => LaneDesign<'p, B> {
                tracker.design_inline(design)
            }
        )
    }

    #[inline(always)]
    fn design_inline<'d, B: SimdReal>(&'d self, design: &'d [Vector3<B>]) -> LaneDesign<'d, B> {
        let origin = design[self.mechanism.origin.0];
        let shortest = origin.x.constant(self.shortest);
        let mut distinct = origin.x.zero().less(shortest);
        for (first, second) in &self.distinct {
            let length = (design[second.0] - design[first.0]).norm_squared();
            distinct = distinct & shortest.less(length);
        }
        LaneDesign {
            form: match &self.method {
                Method::Arm(method) => Form::Arm(method.design(self.mechanism, design)),
                Method::Linkage(_) => Form::Linkage(LinkageDesign::new(self.mechanism, design)),
            },
            origin,
            distinct,
        }
    }

    /// Members of a design that carry forces: terms shared by the gradients in all its poses. This tracker must have made
    /// the design.
    #[inline(always)]
    pub fn members<B: SimdReal>(&self, design: &LaneDesign<'_, B>) -> AdjointConstants<B> {
        AdjointConstants(match (&self.method, &design.form) {
            (Method::Arm(method), Form::Arm(form)) => Some(method.members(form)),
            _ => None,
        })
    }

    /// Visits every station with the rack at its `rack`-th displacement. This tracker must have made the design.
    #[inline(always)]
    pub fn solve<B: SimdReal>(
        &self,
        design: &LaneDesign<'_, B>,
        rack: usize,
        history: &mut [B],
        visit: &mut impl Visit<B>,
    ) -> Tracked<B> {
        outlined!(
            [B: SimdReal, V: Visit<B>] design.origin.x;
            tracker: &'p CornerTracker<'p> = self, design: &'p LaneDesign<'p, B> = design, rack: usize = rack,
            history: &'p mut [B] = history, visit: &'p mut V = visit => Tracked<B> {
                tracker.solve_inline(design, rack, history, visit)
            }
        )
    }

    #[inline(always)]
    fn solve_inline<B: SimdReal>(
        &self,
        design: &LaneDesign<'_, B>,
        rack: usize,
        history: &mut [B],
        visit: &mut impl Visit<B>,
    ) -> Tracked<B> {
        let places = &self.routes[rack].places;
        let mut accepted = Acceptance::everywhere(design.origin.x);
        accepted.require(design.distinct, Rejection::NoLength);
        match (&self.method, &design.form) {
            (Method::Arm(method), Form::Arm(form)) => {
                let mut corner = method.corner(form, self.drive, self.tolerance, visit);
                track(&mut corner, places, accepted, history)
            }
            (Method::Linkage(method), Form::Linkage(form)) => {
                let mut corner = method.corner(form, self.tolerance, visit);
                track(&mut corner, places, accepted, history)
            }
            _ => unreachable!("a design of another tracker"),
        }
    }
}

/// Solves several stations of one design at a time, one station in each lane.
impl CornerTracker<'_> {
    /// Indices of the stations in the order in which [`CornerTracker::visit_stations_in_lanes`] assigns them to
    /// lanes.
    pub fn stations_in_lanes(&self, rack: usize) -> impl Iterator<Item = usize> {
        self.routes[rack].places.iter().filter_map(|p| p.station)
    }

    /// Visits the stations of one design, with one station in each lane. All lanes contain the same design. `history`
    /// comes from [`CornerTracker::track_one`], which must have accepted every station. The visitor receives the index of
    /// a group of stations instead of a station. Lanes beyond the last station repeat the last station.
    #[inline(always)]
    pub fn visit_stations_in_lanes<B: SimdReal>(
        &self,
        design: &LaneDesign<'_, B>,
        rack: usize,
        history: &[f64],
        visit: &mut impl Visit<B>,
    ) {
        let like = design.origin.x;
        let unknowns = self.unknowns();
        let places = &self.routes[rack].places;
        let mut lanes = [[0.0; MOST_LANES]; linkage::UNKNOWNS];
        let mut values = [0.0; MOST_LANES];
        let (mut filled, mut group) = (0, 0);
        for (number, place) in places.iter().enumerate() {
            if place.station.is_some() {
                let here = &history[unknowns * number..];
                for (k, lanes) in lanes[..unknowns].iter_mut().enumerate() {
                    lanes[filled..].fill(here[k]);
                }
                values[filled..].fill(place.value);
                filled += 1;
            }
            if filled == 0 || (filled < B::LANES && number + 1 < places.len()) {
                continue;
            }
            let (value, rack) = (like.load(&values), like.constant(place.rack));
            let acceptance = Acceptance::everywhere(like);
            match (&self.method, &design.form) {
                (Method::Arm(method), Form::Arm(form)) => {
                    let tangent = like.load(&lanes[0]);
                    method.visit_stations_in_lanes(
                        form,
                        self.drive,
                        tangent,
                        rack,
                        #[inline(always)]
                        |pose| visit.pose(group, pose, acceptance),
                    );
                }
                (Method::Linkage(method), Form::Linkage(form)) => {
                    let mut unknowns = [like; linkage::UNKNOWNS];
                    for (unknown, lanes) in unknowns.iter_mut().zip(&lanes) {
                        *unknown = like.load(lanes);
                    }
                    method.visit_stations_in_lanes(
                        form,
                        unknowns,
                        value,
                        rack,
                        #[inline(always)]
                        |pose| visit.pose(group, pose, acceptance),
                    );
                }
                _ => unreachable!("a design of another tracker"),
            }
            filled = 0;
            group += 1;
        }
    }
}

/// Lanes in which `now` has the sign of `before`, and its absolute value is between half and twice the absolute value of
/// `before`.
#[inline(always)]
fn within_half<B: SimdReal>(now: B, before: B) -> B::Mask {
    ((now - (before + before)) * now.minus_product(before, before.constant(0.5)))
        .less(before.zero())
}
