//! Solver for the position of an axle: it solves both corners and the conditions at the ground.
//!
//! On a plane ground with the normal n, both contact points C have the same height h = n.C. So f = h_l(z_l) - h_r(z_r) = 0.
//! For a given roll angle and the travels z_l, z_r = heave +- s, this is one equation in s. Its slope n.C_l' + n.C_r' is
//! near 2, with C' the velocity of the carrier's point at C with respect to travel. The slope stays positive until a wheel
//! reaches a fold, the turning point at which the travel reverses. So Newton's method finds the only root. For given
//! travels, f = 0 is one equation in the roll angle, with the slope track.

mod corner;
mod linearised;
mod placement;
mod prove;
mod reading;
mod rolling;
mod steering;

pub use placement::Placement;
pub use reading::Read;
pub(crate) use steering::displace;

use super::adjoint::{add_gradient, inputs_on_tape};
use super::at_load::LOAD_TERMS;
use super::carriers::Carriers;
use super::expanded::Expandable;
use super::reading::{Parts, Reading, Snapshot, WheelParts, along};
use super::setup::Setup;
use super::state::{AxleState, Hold, Motion};
use super::taylor::{Line, Taylor};
use super::{Axle, AxleColumn, Quantity};
use crate::analyse::{Balance, Limits, Support};
use crate::ask::NoValue;
use crate::derive::{DesignSeries, Linearised, MotionPoint};
use crate::linear::lu::Lu6;
use crate::mechanism::{Configuration, DesignFault, Failure, Ground, NoPose, Pose};
use crate::model::{
    Axis, AxleSteering, AxleTravel, Drive, Mechanism, PointId, RigidAxle, RockerId, Rod, Side,
};
use crate::number::{Each, Jet, Tape, Tracked, Vector3};
use crate::solve::{Solver, StationOrder, Toggles};
use crate::threads::checkpoint;
use corner::{Corner, Wanted, read_wheel};
use linearised::{LinearisedAxle, linearise};
use std::ops::ControlFlow;

/// If the range of the rack causes the failure, returns the absolute value of the rack displacement at the end of this
/// range. `None` for any other failure.
fn rack_end(failure: &NoPose) -> Option<f64> {
    match failure.of_wheel()? {
        Failure::RackUnreachable { limit, .. } => Some(limit.abs()),
        _ => None,
    }
}

/// Joins the results of both wheels, left first. Returns a failure if a wheel has one. If neither wheel can reach the rack
/// displacement, this is the failure of the wheel whose rack range ends first.
pub(super) fn join_results<T>(
    left: Result<T, NoPose>,
    right: Result<T, NoPose>,
) -> Result<[T; 2], NoPose> {
    match (left, right) {
        (Ok(left), Ok(right)) => Ok([left, right]),
        (Err(left), Err(right)) => {
            let ends = rack_end(&left).zip(rack_end(&right));
            let right_is_first = ends.is_some_and(|(left, right)| right < left);
            Err(if right_is_first { right } else { left })
        }
        (Err(failure), _) | (_, Err(failure)) => Err(failure),
    }
}

/// Callback with two arguments: the index of a requested quantity, and the gradients of this quantity with respect to
/// the points of the left and right wheel.
pub(super) type ReceiveGradients<'r> = dyn FnMut(usize, [&[Vector3<f64>]; 2]) + 'r;

/// A position of an axle that the solver found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxlePose {
    /// Travels of the left and the right wheel.
    pub travels: [f64; 2],
    /// Roll angle of the body, in radians.
    pub roll: f64,
    /// Displacement of the rack, positive in the outboard direction of the left wheel.
    pub rack: f64,
    /// Coordinates that stay constant in motions from this position.
    pub hold: Hold,
    /// Heave at which the level axle carries the same load. `None` if the mean travel is not computed from a load.
    pub(super) at_load: Option<f64>,
    poses: [Pose<f64>; 2],
}

impl AxlePose {
    /// Poses of both carriers, each in the kernel's frame of its own side.
    pub fn poses(&self) -> &[Pose<f64>; 2] {
        &self.poses
    }
}

/// Solver for the positions of one axle. The design of the axle can be replaced. Power series of quantities have `N`
/// coefficients, one more than the order of their highest derivative.
#[derive(Clone, Debug)]
pub struct AxleSolver<'a, const N: usize> {
    pub(super) axle: &'a Axle,
    corners: [Corner<'a, N>; 2],
    setup: &'a Setup,
    /// Solver for positions at a load. It is created when it is first needed.
    pub(super) loads: Option<Box<AxleSolver<'a, LOAD_TERMS>>>,
    parts: Parts,
    lines: &'static [Line],
    /// Complete designs of a rigid axle: as seen from its left wheel, and as seen from its right wheel.
    whole: [Vec<Vector3<f64>>; 2],
    buffer: Vec<Vector3<Jet<f64, N>>>,
    gradients: [Vec<Vector3<f64>>; 2],
}

/// Largest number of Newton steps for the difference of travels (including halved steps), or for the roll angle.
const MOST_STEPS: usize = 80;
/// Number of terms in the series for the heights of contact points.
const TERMS: usize = 4;
/// Largest number of rounds in which all unsolved placements are solved together. The solver then solves each
/// remaining placement on its own.
const MOST_ROUNDS: usize = 4;
/// Largest step along the series of a pose, relative to the mechanism's size. Up to this step, the error of four terms is smaller
/// than rounding errors, except close to a fold.
const NEAR: f64 = 1e-4;
/// Largest permitted difference between the heights of the two contact points, as a multiple of the rounding of a length. A
/// height contains more rounding errors than a length.
const OF_HEIGHTS: f64 = 4.0;

/// Number whose gradient is requested.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sought {
    Quantity(Quantity),
    /// Coordinate of a point of one wheel.
    Point(Side, PointId, Axis),
}

/// Values of one wheel at a travel.
#[derive(Clone, Debug)]
pub struct WheelRead {
    travel: f64,
    pose: Pose<f64>,
    reading: Reading<f64>,
    condition: Option<f64>,
    /// Rod at or beyond a toggle (the dead centre at which it cannot turn its lever). `None` if there is no such rod.
    toggle: Option<Rod>,
    /// Rockers at or beyond a toggle.
    stuck: Vec<RockerId>,
    /// Positions of the points, as power series in the wheel's own travel and rack.
    points: Vec<Vector3<Taylor<f64>>>,
}

impl WheelRead {
    /// Returns the values of the wheel. `None` if a rocker is at or beyond a toggle.
    pub(super) fn without_toggle(self) -> Option<Reading<f64>> {
        self.toggle.is_none().then_some(self.reading)
    }
}

impl<'a, const N: usize> AxleSolver<'a, N> {
    /// Makes a solver for positions in which these quantities are computed. If `by_rack` is true, the solver also
    /// computes derivatives with respect to the rack. Returns an error if a wheel has no solution in the design position.
    pub fn new(
        axle: &'a Axle,
        quantities: &[Quantity],
        by_rack: bool,
    ) -> Result<Self, (Side, DesignFault)> {
        let slots: Vec<_> = quantities
            .iter()
            .flat_map(|q| q.info().reads)
            .copied()
            .collect();
        let parts = Parts::of(&slots, Carriers::of(axle));
        let order = |q: &Quantity| q.rate_order();
        let orders_by_rack = quantities.iter().filter(|q| q.info().by_rack).map(order);
        // The solver needs additional terms for derivatives along motions.
        let further = (N - 1).saturating_sub(quantities.iter().map(order).max().unwrap_or(0));
        let degree_with_rack = if by_rack {
            N - 1
        } else {
            orders_by_rack.max().map_or(0, |order| order + further)
        };
        let corner = |side| {
            let rockers = axle.rockers(side, quantities);
            let mut corner = Corner::new(axle, side, &parts, &rockers).map_err(|f| (side, f))?;
            corner.begin(0.0).map_err(|fault| (side, fault))?;
            Ok(corner)
        };
        let corners = [corner(Side::Left)?, corner(Side::Right)?];
        let zero = Vector3::new(0.0, 0.0, 0.0);
        let points = corners[0].mechanism.points.len();
        Ok(AxleSolver {
            axle,
            loads: None,
            corners,
            setup: &axle.setup,
            parts,
            lines: Line::needed(if axle.is_rigid() {
                // Each wheel of a rigid axle moves with both travels, so the series need all terms of both.
                N - 1
            } else {
                degree_with_rack
            }),
            whole: Default::default(),
            buffer: vec![zero.map(Jet::constant); points],
            gradients: [vec![zero; points], vec![zero; points]],
        })
    }

    /// Requests the condition number of the closure equations' Jacobian in every position that is read.
    pub fn find_conditions(&mut self) {
        for corner in &mut self.corners {
            corner.has_condition = true;
        }
    }

    /// Checks every rocker for toggles, including rockers that do not affect the requested quantities.
    pub fn watch_all_rockers(&mut self) {
        for corner in &mut self.corners {
            let rockers = (0..corner.mechanism.rockers.len()).map(RockerId);
            corner.toggles = Toggles::of(corner.mechanism, rockers);
            corner.begun = None;
        }
    }

    /// Checks these rockers of one wheel for toggles, in addition to the rockers that affect the requested quantities.
    pub fn watch(&mut self, side: Side, rockers: impl IntoIterator<Item = RockerId>) {
        let corner = &mut self.corners[side as usize];
        corner.toggles = corner.toggles.and(corner.mechanism, rockers);
        corner.begun = None;
    }

    /// Selects points of both wheels. Their positions are then computed in every position of the axle.
    pub fn read_points(&mut self, points: &[PointId]) {
        for side in Side::ALL {
            let corner = &mut self.corners[side as usize];
            corner.points = points.to_vec();
            let mechanism = corner.mechanism;
            let rockers = points.iter().flat_map(|id| mechanism.rockers_moving(*id));
            self.watch(side, rockers);
        }
    }

    /// Moves the steering gear of a steered axle to a displacement, for both wheels.
    pub(crate) fn steer(&mut self, displacement: f64) -> Result<(), NoPose> {
        let [left, right] = &mut self.corners;
        join_results(left.steer(displacement), right.steer(displacement)).map(|_| ())
    }

    /// Returns true if a drag link steers the wheels of a solid axle.
    pub(super) fn is_steered(&self) -> bool {
        self.axle.left.mechanism.axle_steering().is_some()
    }

    /// Prepares one wheel in a position for loads. The error is [`Failure::Singular`] if the wheel cannot carry a load, or
    /// if the steering gear has another displacement than in this position.
    pub fn balance(
        &self,
        side: Side,
        placed: &AxlePose,
        support: Support,
    ) -> Result<Balance<'_>, Failure> {
        let corner = &self.corners[side as usize];
        let rack = placed.rack * corner.rack_sign;
        // The steering gear of the design must be at the displacement of the pose.
        if self.is_steered() && corner.steered.displacement != placed.rack {
            return Err(Failure::Singular);
        }
        corner
            .solver
            .balance(&placed.poses[side as usize], rack, support)
    }

    /// Returns the LU factors of the closure equations' Jacobian for each wheel in a position. The steering gear must be at
    /// the displacement of this position. `None` if a Jacobian is singular.
    pub(crate) fn factorised(&self, placed: &AxlePose) -> Option<[Lu6<f64>; 2]> {
        let coordinates = self.coordinates(placed.travels, placed.rack);
        let wheel = |side: Side| {
            let corner = &self.corners[side as usize];
            let (travel, rack) = coordinates[side as usize];
            let (value, rack) = corner.inner(travel, rack);
            let point = MotionPoint {
                drive: Drive::Travel,
                value,
                rack,
            };
            corner
                .solver
                .factorise(&placed.poses[side as usize], &point)
        };
        Some([wheel(Side::Left)?, wheel(Side::Right)?])
    }

    /// Prepares both wheels of a position of the axle's own design for series along directions of the design. The
    /// steering gear must be at the displacement of this position. `None` if the closure equations' Jacobian of a wheel is singular.
    pub(crate) fn expandable(&self, placed: &AxlePose) -> Option<[Expandable<'a>; 2]> {
        let coordinates = self.coordinates(placed.travels, placed.rack);
        let factors = self.factorised(placed)?;
        let axle = self.axle;
        Some(Side::ALL.map(|side| Expandable {
            mechanism: &axle.suspension(side).mechanism,
            design: &axle.suspension(side).design,
            pose: placed.poses[side as usize],
            factors: factors[side as usize],
            coordinates: coordinates[side as usize],
            gear: placed.rack,
            lines: self.lines,
            parts: self.parts,
        }))
    }

    /// Prepares both wheels of a position for gradients of formulas.
    pub(crate) fn linearised(&self, placed: &AxlePose) -> Result<LinearisedAxle<'_, N>, NoPose> {
        let coordinates = self.coordinates(placed.travels, placed.rack);
        linearise(&self.corners, (self.lines, self.parts), placed, coordinates)
    }

    /// Replaces the designs by other designs of the same mechanisms, each in the frame of its side.
    ///
    /// For a rigid axle, only the left design is used. Its right half moves by the mirror image of the displacement of its
    /// left half.
    pub fn prepare(&mut self, designs: [&[Vector3<f64>]; 2]) -> Result<(), (Side, DesignFault)> {
        let Some(rigid) = self.rigid() else {
            return self.prepare_whole(designs);
        };
        let mut whole = std::mem::take(&mut self.whole);
        for design in &mut whole {
            design.clear();
            design.extend_from_slice(designs[0]);
        }
        let [left, right] = &mut whole;
        rigid.complete(&self.axle.left.design, left);
        rigid.turn_over(left, right);
        let prepared = self.prepare_whole([left, right]);
        self.whole = whole;
        prepared
    }

    /// Returns true if one body carries both wheels.
    pub(super) fn is_rigid(&self) -> bool {
        self.axle.is_rigid()
    }

    /// Returns the data of a rigid axle. `None` for independent wheels.
    fn rigid(&self) -> Option<&'a RigidAxle> {
        self.axle.left.mechanism.rigid_axle.as_ref()
    }

    /// Returns driving travel and rack displacement of each wheel, in its own frame. For a rigid axle, they are the mean travel and
    /// half the difference of the travels: first the travel that drives the axle, then the held travel.
    pub(crate) fn coordinates(&self, travels: [f64; 2], rack: f64) -> [(f64, f64); 2] {
        let [left, right] = travels;
        match self.rigid() {
            None => [0, 1].each(|side| (travels[side], rack * self.corners[side].rack_sign)),
            Some(rigid) => {
                let (mean, difference) = (0.5 * (left + right), 0.5 * (left - right));
                match rigid.held {
                    AxleTravel::Mean => [(difference, mean), (-difference, mean)],
                    AxleTravel::Difference => [(mean, difference), (mean, -difference)],
                }
            }
        }
    }

    /// Returns the driving travel and the rack displacement of both wheels in a level position with this `heave`. For a rigid axle,
    /// returns half the difference of travels (0) and the mean travel instead.
    fn level(&self, heave: f64, rack: f64) -> (f64, f64) {
        match self.rigid() {
            Some(_) => (0.0, heave),
            None => (heave, rack),
        }
    }

    /// Replaces the designs by complete designs of both sides, such as simulated builds. No point is computed from
    /// another point.
    pub(crate) fn prepare_whole(
        &mut self,
        designs: [&[Vector3<f64>]; 2],
    ) -> Result<(), (Side, DesignFault)> {
        for (corner, design) in self.corners.iter_mut().zip(designs) {
            let side = corner.side;
            corner.prepare(design).map_err(|fault| (side, fault))?;
        }
        match &mut self.loads {
            Some(loads) => loads.prepare_whole(designs),
            None => Ok(()),
        }
    }

    /// Values of each wheel that the solver computes.
    pub(super) fn parts(&self) -> &Parts {
        &self.parts
    }

    fn radius(&self) -> f64 {
        self.setup.wheel_radius.unwrap_or(f64::NAN)
    }

    /// Finds the limits of one wheel alone, in the frame of its side.
    pub(super) fn limits_of(&mut self, side: Side) -> Result<Limits, (Side, DesignFault)> {
        let limits = self.corners[side as usize].solver.limits();
        limits.map_err(|fault| (side, fault))
    }

    /// Finds the pose of one wheel at a travel, with the rack centred (for a rigid axle, at zero mean travel).
    pub(super) fn pose(&mut self, side: Side, travel: f64) -> Option<Pose<f64>> {
        let corner = &mut self.corners[side as usize];
        corner.at(travel, 0.0, |_, _, pose| Ok(*pose)).ok()
    }

    /// Returns the roll angle of the plane under both wheels in these poses. `None` if there is no such plane.
    pub(super) fn plane_under(&self, poses: &[Pose<f64>; 2]) -> Option<f64> {
        self.tilted(poses).ok()
    }

    /// Spin axis of a wheel in the design position, in the frame of its side.
    pub fn spin_axis(&self, side: Side) -> Vector3<f64> {
        let corner = &self.corners[side as usize];
        let design_pose = corner.solver.design_pose();
        corner.configuration(design_pose).designed_spin_axis()
    }

    /// Returns the design of a wheel in the frame of its side. The steering gear of a steered axle has the displacement
    /// of the last position that was computed.
    pub(super) fn design(&self, side: Side) -> &[Vector3<f64>] {
        self.corners[side as usize].solver.design()
    }

    /// Returns one wheel in a position, with its rack centred. The steering gear must be at its displacement.
    pub(super) fn configuration_of(&self, side: Side, placed: &AxlePose) -> Configuration<'_, f64> {
        self.corners[side as usize].configuration(placed.poses[side as usize])
    }

    /// Returns one wheel in a position, for drawings. The rack of an independent suspension is at the displacement of
    /// this position. The steering gear of a steered axle must be at its displacement.
    pub(crate) fn drawn_configuration(
        &self,
        side: Side,
        placed: &AxlePose,
    ) -> Configuration<'_, f64> {
        let mut at = self.configuration_of(side, placed);
        at.rack = placed.rack * side.sign();
        at
    }

    /// Returns a solid axle in the design position, as seen from its left wheel. The steering gear has its last
    /// displacement.
    pub(super) fn configuration_at_rest(&self) -> Configuration<'_, f64> {
        let [left, _] = &self.corners;
        left.configuration(left.solver.design_pose())
    }

    /// Returns the designs of both wheels, each in the frame of its side. The steering gear of a steered axle is
    /// centred.
    pub(super) fn designs(&self) -> [Vec<Vector3<f64>>; 2] {
        let steering = self.axle.left.mechanism.axle_steering();
        self.corners.each_ref().map(|corner| {
            let mut design = corner.solver.design().to_vec();
            if let Some(steering) = steering {
                steering.displace(0.0, &mut design);
            }
            design
        })
    }

    /// Returns the size of the left wheel's mechanism: the largest distance of a point from the carrier's origin.
    /// Tolerances for lengths are relative to this size.
    pub(super) fn size(&self) -> f64 {
        self.corners[0].solver.size()
    }

    /// Identifiers of the points of each wheel.
    pub fn points(&self) -> impl Iterator<Item = PointId> {
        (0..self.buffer.len()).map(PointId)
    }
}
