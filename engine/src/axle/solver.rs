//! Solver for the position of an axle: both corners, and the conditions at the ground.
//!
//! On a plane ground both contact points are at one height, f = h_l(z_l) - h_r(z_r) = 0 with h = n.C. With
//! the roll angle given and z_l, z_r = heave +- s this is one equation in s. Its slope n.C_l' + n.C_r' is
//! near 2 and positive while neither wheel is at a fold of its travel, so that the root is the only one
//! and Newton's method meets it. With both travels given it is one in the roll angle, of slope -track.

use super::adjoint::{add_gradient, inputs_on_tape};
use super::at_load::LOAD_TERMS;
use super::reading::{Parts, Reading, Snapshot, WheelParts, along};
use super::setup::Setup;
use super::state::{AxleState, Carriers, Hold, Motion};
use super::taylor::{Line, Taylor};
use super::{Axle, Quantity};
use crate::analyse::{Balance, Certifier, Limits, Support};
use crate::ask::NoValue;
use crate::derive::{DesignSeries, Linearised, MotionPoint};
use crate::mechanism::{Configuration, DesignFault, Failure, Ground, NoPose, Pose, Unproven};
use crate::model::{Axis, AxleTravel, Drive, Mechanism, PointId, RigidAxle, RockerId, Rod, Side};
use crate::number::{Each, Jet, Tape, Tracked, Vector3};
use crate::solve::{Solver, StationOrder, Toggles};
use crate::threads::checkpoint;
use std::ops::ControlFlow;

/// The position that an axle is to take. Lengths are in the study's unit; the rack is positive towards the left wheel's
/// outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placement {
    /// The body rolled on a plane ground.
    Roll {
        /// Mean travel of the wheel centres.
        heave: f64,
        /// Roll angle in radians.
        roll: f64,
        /// Displacement of the rack.
        rack: f64,
    },
    /// The body rolled on a plane ground, with a mean travel that follows from the load. The axle carries the same
    /// load as when it stands level at `heave`, with the rack in the middle.
    AtLoad {
        /// Mean travel of the wheel centres at which the level axle carries the same load.
        heave: f64,
        /// Roll angle in radians.
        roll: f64,
        /// Displacement of the rack.
        rack: f64,
    },
    /// Given travels of both wheels.
    Travels {
        /// Travels of left and right wheel.
        travels: [f64; 2],
        /// Displacement of the rack.
        rack: f64,
        /// True if both wheels stand on one plane. Otherwise the body is level, and each wheel stands on a level pad.
        on_plane: bool,
    },
}

impl Placement {
    /// Travels and rack, if both wheels stand on level pads at given heights; `None` for another placement.
    pub fn on_level_pads(&self) -> Option<([f64; 2], f64)> {
        match *self {
            Placement::Travels {
                travels,
                rack,
                on_plane: false,
            } => Some((travels, rack)),
            _ => None,
        }
    }

    /// Displacement of the rack.
    pub fn rack(&self) -> f64 {
        match *self {
            Placement::Roll { rack, .. }
            | Placement::AtLoad { rack, .. }
            | Placement::Travels { rack, .. } => rack,
        }
    }

    /// Mean travel of both wheel centres; of a placement at a load that of the level axle.
    pub(super) fn mean(&self) -> f64 {
        match *self {
            Placement::Roll { heave, .. } | Placement::AtLoad { heave, .. } => heave,
            Placement::Travels {
                travels: [left, right],
                ..
            } => 0.5 * (left + right),
        }
    }

    /// Quantities that stay fixed in motions from this placement.
    pub fn hold(&self) -> Hold {
        match self {
            Placement::Roll { .. } | Placement::AtLoad { .. } => Hold::MeanTravel,
            Placement::Travels { on_plane: true, .. } => Hold::TravelsOnPlane,
            Placement::Travels { .. } => Hold::TravelsOnPads,
        }
    }
}

impl std::fmt::Display for Placement {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Placement::Roll { heave, roll, .. } => {
                let roll = roll.to_degrees();
                write!(f, "roll {roll:.6} deg, heave {}", heave + 0.0)?;
            }
            Placement::AtLoad { heave, roll, .. } => {
                let roll = roll.to_degrees();
                write!(f, "roll {roll:.6} deg at the load of heave {}", heave + 0.0)?;
            }
            Placement::Travels {
                travels: [left, right],
                ..
            } => write!(f, "travels {} and {}", left + 0.0, right + 0.0)?,
        }
        write!(f, ", rack {} to the left", self.rack() + 0.0)
    }
}

/// Magnitude of the rack displacement at which the wheel can no longer follow, if that is the failure.
fn rack_end(failure: &NoPose) -> Option<f64> {
    match failure.of_wheel()? {
        Failure::RackUnreachable { limit, .. } => Some(limit.abs()),
        _ => None,
    }
}

/// Joins the results of both wheels. If neither can follow the rack, the failure is that of the wheel which ends first.
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

/// Receives the index of a requested quantity, and its gradients by the points of the left and of the right wheel.
pub(super) type ReceiveGradients<'r> = dyn FnMut(usize, [&[Vector3<f64>]; 2]) + 'r;

/// A position that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxlePose {
    /// Travel of left and right wheel.
    pub travels: [f64; 2],
    /// Roll angle, radians.
    pub roll: f64,
    /// Displacement of the rack towards the left wheel's outside.
    pub rack: f64,
    /// Quantities that stay fixed in motions from this position.
    pub hold: Hold,
    /// Only if the mean travel followed from a load: the heave at which the level axle carries that load.
    pub(super) at_load: Option<f64>,
    poses: [Pose<f64>; 2],
}

impl AxlePose {
    /// The poses of both carriers, each in the kernel's frame of its own side.
    pub fn poses(&self) -> &[Pose<f64>; 2] {
        &self.poses
    }
}

/// One corner of the axle, ready to be solved.
#[derive(Clone, Debug)]
struct Corner<'a, const N: usize> {
    mechanism: &'a Mechanism,
    solver: Solver<'a>,
    /// Series of poses along the travel, for heights of contact points.
    slopes: DesignSeries<TERMS>,
    series: DesignSeries<N>,
    /// 1, or -1 for the right wheel, in whose own frame the rack moves the other way. (The mean travel of a rigid axle takes
    /// the rack's place and is the same at both wheels.)
    rack_sign: f64,
    toggles: Toggles,
    /// Rack displacement, in this wheel's own frame, that `toggles` has begun with; `None` before the first.
    begun: Option<f64>,
    /// Travels at which this design was found to end, per rack position.
    ends: Vec<End>,
    side: Side,
    /// Points that are read with the wheel.
    points: Vec<PointId>,
}

/// The end of the travel at one rack displacement, both in the wheel's own frame. It is remembered because finding it
/// takes as long as a hundred poses, and a search for a roll angle that does not exist comes there again and again.
#[derive(Clone, Copy, Debug)]
struct End {
    rack: f64,
    travel: f64,
    failure: Failure,
}

/// Solves the positions of one axle, one design after another. `N` coefficients of every power series are
/// known: one more than the highest derivative that is read.
#[derive(Clone, Debug)]
pub struct AxleSolver<'a, const N: usize> {
    pub(super) axle: &'a Axle,
    corners: [Corner<'a, N>; 2],
    setup: &'a Setup,
    /// Solver of loads for positions at a load; made when first needed.
    pub(super) loads: Option<Box<AxleSolver<'a, LOAD_TERMS>>>,
    parts: Parts,
    lines: &'static [Line],
    /// Both designs of a rigid axle, complete.
    whole: [Vec<Vector3<f64>>; 2],
    tape: Tape,
    buffer: Vec<Vector3<Jet<f64, N>>>,
    gradients: [Vec<Vector3<f64>>; 2],
}

/// The most Newton steps in the difference of travels, those back included.
const MOST_STEPS: usize = 80;
/// Terms of the series of heights.
const TERMS: usize = 4;
/// Rounds in which all open placements are solved together; placements still open after them are solved one by one.
const MOST_ROUNDS: usize = 4;
/// The farthest a pose is moved along its series, in sizes: four terms then leave less than rounding.
const NEAR: f64 = 1e-4;

/// A wheel in a pose: its rate of motion by travel, and the height of its contact point over the origin.
struct WheelSeries {
    pose: Pose<Jet<f64, TERMS>>,
    height: Jet<f64, TERMS>,
}

impl WheelSeries {
    fn of(
        at: &Configuration<Jet<f64, TERMS>>,
        centre: PointId,
        ground: Ground<f64>,
        radius: f64,
    ) -> Self {
        let ground = ground.map(Jet::constant);
        let contact = at.point(centre) + ground.contact_lever(at.spin_axis(), radius);
        WheelSeries {
            pose: at.pose,
            height: ground.normal().dot(contact),
        }
    }

    /// The pose a little further in travel.
    fn moved(&self, step: f64) -> Pose<f64> {
        if step == 0.0 {
            return self.pose.map(|c| c[0]);
        }
        let along = |c: Jet<f64, TERMS>| c[0] + step * (c[1] + step * (c[2] + step * c[3]));
        let pose = self.pose.map(along);
        Pose {
            origin: pose.origin,
            rotation: pose.rotation.orthonormalised(),
        }
    }
}

/// Returns true if the wheels rise with their travels, given the slopes of both heights. Independent wheels must both rise. A
/// rigid axle needs the sum of the slopes to be positive. Returns false for NaN.
fn rise(is_rigid: bool, [left, right]: [f64; 2]) -> bool {
    match is_rigid {
        true => left + right > 0.0,
        false => left > 0.0 && right > 0.0,
    }
}

/// The change of half the difference of travels that puts two wheels at one height, by their series.
fn solve_level(left: &Jet<f64, TERMS>, right: &Jet<f64, TERMS>) -> f64 {
    // The right wheel goes the other way.
    let f = [0, 1, 2, 3].map(|k| match k % 2 {
        0 => left[k] - right[k],
        _ => left[k] + right[k],
    });
    let mut step = -f[0] / f[1];
    for _ in 0..4 {
        let value = f[0] + step * (f[1] + step * (f[2] + step * f[3]));
        let slope = f[1] + step * (2.0 * f[2] + step * 3.0 * f[3]);
        step -= value / slope;
    }
    step
}

impl<'a, const N: usize> Corner<'a, N> {
    fn new(
        axle: &'a Axle,
        side: Side,
        parts: &Parts,
        rockers: &[RockerId],
    ) -> Result<Self, DesignFault> {
        let suspension = axle.suspension(side);
        let mechanism = &suspension.mechanism;
        let design = &suspension.design;
        Ok(Corner {
            mechanism,
            solver: Solver::new(mechanism, design)?,
            slopes: DesignSeries::new(mechanism, design).with_steering_axis(false),
            series: DesignSeries::new(mechanism, design)
                .with_steering_axis(parts.contain_steering_axis()),
            rack_sign: match &mechanism.rigid_axle {
                Some(rigid) if rigid.held == AxleTravel::Mean => 1.0,
                _ => side.sign(),
            },
            toggles: Toggles::of(mechanism, rockers.iter().copied()),
            begun: None,
            ends: Vec::new(),
            side,
            points: Vec::new(),
        })
    }

    fn prepare(&mut self, design: &[Vector3<f64>]) -> Result<(), DesignFault> {
        self.solver.prepare(design)?;
        self.slopes.prepare(self.mechanism, design);
        self.series.prepare(self.mechanism, design);
        self.begun = None;
        self.ends.clear();
        Ok(())
    }

    /// The failure of a travel beyond one that is known to be the end.
    fn beyond_an_end(&self, travel: f64, rack: f64) -> Option<Failure> {
        let is_beyond =
            |end: &&End| end.rack == rack && (travel - end.travel) * end.travel.signum() > 0.0;
        let end = self.ends.iter().find(is_beyond)?;
        Some(end.failure)
    }

    /// Makes ready to look for toggles at this rack displacement.
    fn begin(&mut self, rack: f64) -> Result<(), DesignFault> {
        match self.begun == Some(rack) {
            true => self.toggles.begin_again(),
            false => {
                self.toggles.begin(&mut self.solver, Drive::Travel, rack)?;
                self.begun = Some(rack);
            }
        }
        Ok(())
    }

    /// The failure of this wheel at a travel; of a rigid axle, whose mean travel is held, at its drive.
    fn fails(&self, travel: f64, failure: Failure) -> NoPose {
        if self.mechanism.rigid_axle.is_some() {
            return NoPose::RigidAxle {
                difference: 2.0 * travel * self.side.sign(),
                failure,
                side: self.side,
            };
        }
        NoPose::Wheel {
            side: self.side,
            travel,
            failure,
        }
    }

    /// The wheel in a pose, with the rack in the middle.
    fn configuration(&self, pose: Pose<f64>) -> Configuration<'_, f64> {
        Configuration::new(self.mechanism, self.solver.design(), pose, 0.0)
    }

    /// Solves the pose at a travel and hands it to `read`.
    fn at<R>(
        &mut self,
        travel: f64,
        rack: f64,
        mut read: impl FnMut(&Solver, &DesignSeries<TERMS>, &Pose<f64>) -> Result<R, Failure>,
    ) -> Result<R, NoPose> {
        if let Some(failure) = self.beyond_an_end(travel, rack) {
            return Err(self.fails(travel, failure));
        }
        let order = StationOrder::through(&[travel]);
        let mut found = Err(Failure::Singular);
        let Corner { solver, slopes, .. } = self;
        let visited = solver.for_each_pose(Drive::Travel, &order, rack, |solver, _, pose| {
            found = pose.and_then(|pose| read(solver, slopes, pose));
            ControlFlow::Continue(())
        });
        // The design position was looked at when the solver was made.
        let found = visited.map_err(|_| Failure::Singular).and(found);
        if let Err(failure @ Failure::Unreachable { limit, .. }) = found {
            self.ends.push(End {
                rack,
                travel: limit,
                failure,
            });
        }
        found.map_err(|failure| self.fails(travel, failure))
    }

    /// The wheel at a travel on this ground.
    fn height(
        &mut self,
        travel: f64,
        rack: f64,
        ground: Ground<f64>,
        radius: f64,
    ) -> Result<WheelSeries, NoPose> {
        let rack = rack * self.rack_sign;
        let motion = MotionPoint {
            drive: Drive::Travel,
            value: travel,
            rack,
        };
        let centre = self.mechanism.wheel_centre;
        self.at(travel, rack, |solver, slopes, pose| {
            let at = solver.configuration_series(slopes, pose, &motion.along_drive())?;
            Ok(WheelSeries::of(&at, centre, ground, radius))
        })
    }

    /// The wheel at many travels, each on a ground of its own; `None` for a travel that it cannot reach.
    fn heights(
        &mut self,
        travels: &[f64],
        rack: f64,
        ground: impl Fn(usize) -> Ground<f64>,
        radius: f64,
    ) -> Vec<Option<WheelSeries>> {
        let rack = rack * self.rack_sign;
        let centre = self.mechanism.wheel_centre;
        let mut found: Vec<_> = travels.iter().map(|_| None).collect();
        let order = StationOrder::through(travels);
        let Corner { solver, slopes, .. } = self;
        // Stations that cannot be visited stay `None`.
        let _ = solver.for_each_pose(Drive::Travel, &order, rack, |solver, station, pose| {
            let motion = MotionPoint {
                drive: Drive::Travel,
                value: travels[station],
                rack,
            };
            let at = pose
                .and_then(|pose| solver.configuration_series(slopes, pose, &motion.along_drive()));
            let standing = at.map(|at| WheelSeries::of(&at, centre, ground(station), radius));
            found[station] = standing.ok();
            ControlFlow::Continue(())
        });
        found
    }

    /// Reads a pose at a travel and a rack displacement, both in this wheel's own frame.
    fn read(
        &self,
        pose: &Pose<f64>,
        travel: f64,
        rack: f64,
        (lines, parts): (&[Line], &Parts),
    ) -> Result<WheelRead, Failure> {
        let Corner {
            solver,
            series,
            toggles,
            points,
            ..
        } = self;
        read_wheel(
            solver,
            series,
            toggles,
            pose,
            (travel, rack),
            (lines, parts, points),
        )
    }
}

/// Reads a pose of a wheel at a travel and a rack displacement, both in the wheel's own frame.
fn read_wheel<const N: usize>(
    solver: &Solver,
    series: &DesignSeries<N>,
    toggles: &Toggles,
    pose: &Pose<f64>,
    (travel, rack): (f64, f64),
    (lines, parts, points): (&[Line], &Parts, &[PointId]),
) -> Result<WheelRead, Failure> {
    let mut snapshots = [Snapshot::<N>::unknown(); 4];
    // For every line, the series of each point along it.
    let mut ways = Vec::new();
    let (mut condition, mut toggle) = (0.0_f64, None);
    for (number, line) in lines.iter().enumerate() {
        let motion = along(line, travel, rack);
        let (at, conditioning) = solver.conditioned_series(series, pose, &motion)?;
        condition = condition.max(conditioning.number);
        snapshots[number] = Snapshot::of(&at, parts);
        ways.extend(points.iter().map(|id| at.point(*id)));
        if number == 0 {
            toggle = toggles.note(Some(solver), &at, travel);
        }
    }
    Ok(WheelRead {
        travel,
        pose: *pose,
        reading: Reading::of(&snapshots[..lines.len()]),
        condition,
        toggle,
        points: (0..points.len())
            .map(|point| {
                let along = |axis: Axis| {
                    let lines = ways.chunks_exact(points.len());
                    let series: Vec<&[f64]> = lines.map(|way| &way[point][axis].0[..]).collect();
                    Taylor::through(&series)
                };
                Vector3::from(Axis::ALL.map(along))
            })
            .collect(),
    })
}

/// Both wheels of a position, ready for gradients of formulas by the hardpoints.
pub(crate) struct LinearisedAxle<'s, const N: usize> {
    /// For each wheel, the wheel along each line.
    wheels: [Vec<Linearised<'s, N>>; 2],
    snapshots: [Vec<Snapshot<N>>; 2],
    parts: Parts,
}

impl<const N: usize> LinearisedAxle<'_, N> {
    /// Both wheels as inputs on the tape, each with the place of its first input. Series along several lines are combined on
    /// the tape, so that the inputs of the right wheel do not follow at once.
    pub(crate) fn on_tape<'t>(&self, tape: &'t Tape) -> [(Reading<Tracked<'t>>, usize); 2] {
        self.snapshots.each_ref().each(|lines| {
            let first = tape.len();
            (Reading::on_tape(tape, lines, &self.parts), first)
        })
    }

    /// Count of the inputs of each wheel.
    pub(crate) fn inputs(&self) -> usize {
        inputs_on_tape::<N>(&self.parts, self.wheels[0].len())
    }

    /// Working memory for [`LinearisedAxle::add_gradient`].
    pub(crate) fn buffer(&self) -> Vec<Vector3<Jet<f64, N>>> {
        let zero = Jet::constant(0.0);
        let points = self.wheels[0][0].at.mechanism.points.len();
        vec![Vector3::new(zero, zero, zero); points]
    }

    /// Adds the gradient by the hardpoints of a wheel, from the derivatives by its inputs.
    pub(crate) fn add_gradient(
        &self,
        side: Side,
        by: &[f64],
        buffer: &mut [Vector3<Jet<f64, N>>],
        gradient: &mut [Vector3<f64>],
    ) {
        let lines = &self.wheels[side as usize];
        let per_line = self.inputs() / lines.len();
        for (linearised, by) in lines.iter().zip(by.chunks(per_line)) {
            add_gradient(linearised, &self.parts, by, buffer, gradient);
        }
    }
}

/// Linearises both wheels of a position along the lines that are read.
fn linearise<'s, const N: usize>(
    corners: &'s [Corner<'_, N>; 2],
    (lines, parts): (&[Line], Parts),
    placed: &AxlePose,
    coordinates: [(f64, f64); 2],
) -> Result<LinearisedAxle<'s, N>, NoPose> {
    let mut wheels = [Vec::new(), Vec::new()];
    for (corner, linearised) in corners.iter().zip(&mut wheels) {
        let pose = &placed.poses[corner.side as usize];
        let (travel, rack) = coordinates[corner.side as usize];
        for line in lines {
            let motion = along::<N>(line, travel, rack);
            let found = corner.solver.linearised(&corner.series, pose, &motion);
            linearised.push(found.map_err(|failure| corner.fails(travel, failure))?);
        }
    }
    let snapshots = wheels.each_ref().map(|of_wheel| {
        let lines = of_wheel.iter();
        lines
            .map(|linearised| Snapshot::of(&linearised.at, &parts))
            .collect::<Vec<_>>()
    });
    Ok(LinearisedAxle {
        wheels,
        snapshots,
        parts,
    })
}

/// A number whose gradient is sought.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sought {
    Quantity(Quantity),
    /// A coordinate of a point of one wheel.
    Point(Side, PointId, Axis),
}

/// The derivative of a sought number by the mean travel.
fn derivative_by_heave<const N: usize>(
    state: &AxleState<'_, f64>,
    linearised: &[Vec<Linearised<'_, N>>; 2],
    sought: &Sought,
) -> f64 {
    match *sought {
        Sought::Quantity(quantity) => quantity.evaluate(&state.moving(Motion::Heave))[1],
        Sought::Point(side, id, axis) => {
            let place = linearised[side as usize][0].at.point(id)[axis];
            let by_travel = place.0.get(1).copied().unwrap_or(f64::NAN);
            // Of a rigid axle the second line is that of the held travel.
            let by_rack = match (state.carriers.is_rigid(), linearised[side as usize].get(1)) {
                (false, _) => 0.0,
                (true, None) => f64::NAN,
                (true, Some(line)) => line.at.point(id)[axis]
                    .0
                    .get(1)
                    .copied()
                    .unwrap_or(f64::NAN),
            };
            state.along(Motion::Heave, side, [by_travel, by_rack])
        }
    }
}

/// One wheel as it was read at a travel.
#[derive(Clone, Debug)]
pub struct WheelRead {
    travel: f64,
    pose: Pose<f64>,
    reading: Reading<f64>,
    condition: f64,
    /// A rod that is at or beyond a toggle, if any.
    toggle: Option<Rod>,
    /// Positions of the points as power series in the wheel's own travel and rack.
    points: Vec<Vector3<Taylor<f64>>>,
}

impl WheelRead {
    /// The wheel; `None` where a rocker is at toggle or beyond.
    pub(super) fn without_toggle(self) -> Option<Reading<f64>> {
        self.toggle.is_none().then_some(self.reading)
    }
}

/// State of an axle in a position, with everything that its quantities need.
pub struct Read<'a> {
    /// The state.
    pub state: AxleState<'a, f64>,
    /// The larger condition number of the two wheels.
    pub condition: f64,
    /// For each wheel: the rod that is at or beyond a toggle, if any.
    pub toggles: [Option<Rod>; 2],
    /// For each wheel: the positions of the points of [`AxleSolver::read_points`] as power series in its own travel and
    /// rack, in the kernel's frame of its side.
    pub points: [Vec<Vector3<Taylor<f64>>>; 2],
}

impl Read<'_> {
    /// The value of a quantity, or the reason for its absence.
    pub fn value(&self, quantity: Quantity) -> Result<f64, NoValue> {
        match self.is_stuck(quantity) {
            true => Err(NoValue::Toggle),
            false => quantity.value(&self.state),
        }
    }

    /// Why what rockers carry is nowhere, where one of them is at toggle or beyond.
    pub fn toggle_failure(&self, placed: &AxlePose) -> Option<NoPose> {
        Side::ALL.into_iter().find_map(|side| {
            Some(NoPose::Wheel {
                side,
                travel: placed.travels[side as usize],
                failure: Failure::Toggle(self.toggles[side as usize]?),
            })
        })
    }

    /// Returns true if a quantity moves with a rocker that is at toggle or beyond.
    pub fn is_stuck(&self, quantity: Quantity) -> bool {
        let mut sides = Side::ALL.into_iter();
        sides.any(|side| self.toggles[side as usize].is_some() && quantity.moves_with_rocker(side))
    }
}

impl<'a, const N: usize> AxleSolver<'a, N> {
    /// A solver for positions in which these quantities are read. `by_rack` requests derivatives by the rack beyond
    /// those that the quantities themselves need. Errors if the design position of a wheel cannot be solved.
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
        let parts = Parts::of(&slots);
        let order = |q: &Quantity| q.rate_order();
        let orders_by_rack = quantities.iter().filter(|q| q.info().by_rack).map(order);
        // Orders beyond those that the quantities need themselves are for derivatives along motions.
        let further = (N - 1).saturating_sub(quantities.iter().map(order).max().unwrap_or(0));
        let degree_with_rack = match by_rack {
            true => N - 1,
            false => orders_by_rack.max().map_or(0, |order| order + further),
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
            lines: Line::needed(match axle.is_rigid() {
                // Each wheel moves with both travels.
                true => N - 1,
                false => degree_with_rack,
            }),
            whole: Default::default(),
            tape: Tape::default(),
            buffer: vec![zero.map(Jet::constant); points],
            gradients: [vec![zero; points], vec![zero; points]],
        })
    }

    /// Looks for toggles of every rocker, not only of those that the quantities move with.
    pub fn watch_all_rockers(&mut self) {
        for corner in &mut self.corners {
            let rockers = (0..corner.mechanism.rockers.len()).map(RockerId);
            corner.toggles = Toggles::of(corner.mechanism, rockers);
            corner.begun = None;
        }
    }

    /// Looks for toggles of these rockers of one wheel, beside those that the quantities move with.
    pub fn watch(&mut self, side: Side, rockers: impl IntoIterator<Item = RockerId>) {
        let corner = &mut self.corners[side as usize];
        corner.toggles = corner.toggles.and(corner.mechanism, rockers);
        corner.begun = None;
    }

    /// Reads these points of both wheels with every position.
    pub fn read_points(&mut self, points: &[PointId]) {
        for side in Side::ALL {
            let corner = &mut self.corners[side as usize];
            corner.points = points.to_vec();
            let mechanism = corner.mechanism;
            let rockers = points.iter().flat_map(|id| mechanism.rockers_moving(*id));
            self.watch(side, rockers);
        }
    }

    /// One wheel in a position, ready to be loaded; [`Failure::Singular`] where the support cannot carry a load.
    pub fn balance(
        &self,
        side: Side,
        placed: &AxlePose,
        support: Support,
    ) -> Result<Balance<'_>, Failure> {
        let corner = &self.corners[side as usize];
        let rack = placed.rack * corner.rack_sign;
        corner
            .solver
            .balance(&placed.poses[side as usize], rack, support)
    }

    /// Both wheels of a position, ready for gradients of formulas.
    pub(crate) fn linearised(&self, placed: &AxlePose) -> Result<LinearisedAxle<'_, N>, NoPose> {
        let coordinates = self.coordinates(placed.travels, placed.rack);
        linearise(&self.corners, (self.lines, self.parts), placed, coordinates)
    }

    /// Takes over other designs of the same mechanisms, each in the frame of its side.
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

    /// The far half, if one body carries both wheels.
    fn rigid(&self) -> Option<&'a RigidAxle> {
        self.axle.left.mechanism.rigid_axle.as_ref()
    }

    /// Drive and rack of each wheel, in its own frame, at these travels. A rigid axle has its two travels there.
    pub(super) fn coordinates(&self, travels: [f64; 2], rack: f64) -> [(f64, f64); 2] {
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

    /// Drive of both wheels and rack when the axle stands level at `heave`. Roll moves the drives of the wheels
    /// oppositely.
    fn level(&self, heave: f64, rack: f64) -> (f64, f64) {
        match self.rigid() {
            Some(_) => (0.0, heave),
            None => (heave, rack),
        }
    }

    fn prepare_whole(&mut self, designs: [&[Vector3<f64>]; 2]) -> Result<(), (Side, DesignFault)> {
        for (corner, design) in self.corners.iter_mut().zip(designs) {
            let side = corner.side;
            corner.prepare(design).map_err(|fault| (side, fault))?;
        }
        match &mut self.loads {
            Some(loads) => loads.prepare(designs),
            None => Ok(()),
        }
    }

    fn radius(&self) -> f64 {
        self.setup.wheel_radius.unwrap_or(f64::NAN)
    }

    /// Finds positions. Those in roll at one rack displacement are found together: each round solves the curves of both
    /// wheels at the travels where the series of the round before put them.
    pub fn place_all(&mut self, placements: &[Placement]) -> Vec<Result<AxlePose, NoPose>> {
        let mut by_rack: Vec<(f64, Vec<usize>)> = Vec::new();
        for (number, placement) in placements.iter().enumerate() {
            if let Placement::Roll { heave, rack, .. } = *placement {
                let (_, rack) = self.level(heave, rack);
                match by_rack.iter_mut().find(|(known, _)| *known == rack) {
                    Some((_, numbers)) => numbers.push(number),
                    None => by_rack.push((rack, vec![number])),
                }
            }
        }
        let mut found: Vec<Option<AxlePose>> = vec![None; placements.len()];
        for (rack, numbers) in by_rack {
            self.roll_together(rack, &numbers, placements, &mut found);
        }
        let each = placements.iter().zip(found);
        each.map(|(placement, found)| found.map_or_else(|| self.place_alone(placement), Ok))
            .collect()
    }

    /// Finds a position.
    pub fn place(&mut self, placement: &Placement) -> Result<AxlePose, NoPose> {
        let mut found = self.place_all(std::slice::from_ref(placement));
        found.swap_remove(0)
    }

    /// First guess for half the difference of the travels. It supposes that independent wheel centres move straight up, and
    /// that those of a rigid axle move on a circle.
    fn straight_half(&self, roll: f64) -> f64 {
        let level = Ground::level(0.0);
        let half = |side: Side| {
            let pose = self.corners[side as usize].solver.design_pose();
            self.contact(side, &pose, level).y
        };
        let slope = match self.is_rigid() {
            true => roll.sin(),
            false => roll.tan(),
        };
        -0.5 * slope * (half(Side::Left) + half(Side::Right))
    }

    /// Finds those of the numbered placements, all in roll at one rack displacement, that take no more than a few
    /// rounds.
    fn roll_together(
        &mut self,
        rack: f64,
        numbers: &[usize],
        placements: &[Placement],
        found: &mut [Option<AxlePose>],
    ) {
        struct Open {
            number: usize,
            heave: f64,
            /// Drive of both wheels at this heave and no roll.
            level: f64,
            roll: f64,
            half: f64,
        }
        let radius = self.radius();
        let is_rigid = self.is_rigid();
        let size = self.corners[0].solver.size();
        let open = numbers
            .iter()
            .filter_map(|number| match placements[*number] {
                Placement::Roll { heave, roll, rack } => Some(Open {
                    number: *number,
                    heave,
                    level: self.level(heave, rack).0,
                    roll,
                    half: self.straight_half(roll),
                }),
                _ => None,
            });
        let mut open: Vec<Open> = open.collect();
        for _ in 0..MOST_ROUNDS {
            if open.is_empty() {
                return;
            }
            let travels = |sign: f64| -> Vec<f64> {
                let travel = |at: &Open| at.level + sign * at.half;
                open.iter().map(travel).collect()
            };
            let ground = |station: usize| Ground::rolled(open[station].roll);
            let [left, right] = &mut self.corners;
            let lefts = left.heights(&travels(1.0), rack, ground, radius);
            let mirrored = |station: usize| ground(station).mirrored();
            let rights = right.heights(&travels(-1.0), rack, mirrored, radius);
            let mut still = Vec::new();
            for (at, wheels) in open.iter().zip(lefts.into_iter().zip(rights)) {
                let (Some(left), Some(right)) = wheels else {
                    continue;
                };
                // Written so that NaN is left to be solved alone.
                if !rise(is_rigid, [left.height[1], right.height[1]]) {
                    continue;
                }
                let step = solve_level(&left.height, &right.height);
                if step.abs() <= NEAR * size {
                    let half = at.half + step;
                    found[at.number] = Some(AxlePose {
                        travels: [at.heave + half, at.heave - half],
                        roll: at.roll,
                        rack: placements[at.number].rack(),
                        hold: Hold::MeanTravel,
                        at_load: None,
                        poses: [left.moved(step), right.moved(-step)],
                    });
                } else if step.is_finite() {
                    still.push(Open {
                        half: at.half + step,
                        ..*at
                    });
                }
            }
            open = still;
        }
    }

    /// Finds a position by itself.
    fn place_alone(&mut self, placement: &Placement) -> Result<AxlePose, NoPose> {
        checkpoint();
        let rack = placement.rack();
        let (travels, poses, roll) = match *placement {
            Placement::AtLoad { heave, roll, rack } => return self.at_load(heave, roll, rack),
            Placement::Roll { heave, roll, .. } => {
                let (travels, poses) = self.rolled(heave, roll, rack)?;
                (travels, poses, roll)
            }
            Placement::Travels {
                travels, on_plane, ..
            } => {
                let coordinates = self.coordinates(travels, rack);
                let mut pose = |side: Side| {
                    let corner = &mut self.corners[side as usize];
                    let (drive, rack) = coordinates[side as usize];
                    corner.at(drive, rack, |_, _, pose| Ok(*pose))
                };
                let poses = join_results(pose(Side::Left), pose(Side::Right))?;
                let roll = match on_plane {
                    false => 0.0,
                    true => self.tilted(&poses)?,
                };
                (travels, poses, roll)
            }
        };
        Ok(AxlePose {
            travels,
            roll,
            rack,
            hold: placement.hold(),
            at_load: None,
            poses,
        })
    }

    /// Travels and poses at a roll angle.
    fn rolled(
        &mut self,
        heave: f64,
        roll: f64,
        rack: f64,
    ) -> Result<([f64; 2], [Pose<f64>; 2]), NoPose> {
        let ground = Ground::rolled(roll);
        let radius = self.radius();
        let is_rigid = self.is_rigid();
        let size = self.corners[0].solver.size();
        let mut half = self.straight_half(roll);
        let (level, rack) = self.level(heave, rack);
        // Where both wheels stood last, which a step may go back towards.
        let mut reached = None;
        let mut smallest = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let [left, right] = &mut self.corners;
            let found = join_results(
                left.height(level + half, rack, ground, radius),
                right.height(level - half, rack, ground.mirrored(), radius),
            );
            // Where a wheel falls by its travel, both are beyond the position wanted. NaN falls.
            let rises =
                |l: &WheelSeries, r: &WheelSeries| rise(is_rigid, [l.height[1], r.height[1]]);
            let found = found.and_then(|[l, r]| match rises(&l, &r) {
                true => Ok((l, r)),
                false => Err(NoPose::NoGround),
            });
            let (left_wheel, right_wheel) = match found {
                Ok(found) => found,
                // Half the way back to where both wheels could stand.
                Err(failure) => {
                    let back = reached.unwrap_or(0.0);
                    if (half - back).abs() <= 1e-9 * size {
                        return Err(failure);
                    }
                    half = 0.5 * (half + back);
                    continue;
                }
            };
            let (left, right) = (left_wheel.height, right_wheel.height);
            let (mismatch, slope) = (left[0] - right[0], left[1] + right[1]);
            let step = -mismatch / slope;
            let is_rounding = step.abs() <= 4.0 * f64::EPSILON * size;
            if is_rounding || step.abs() >= smallest && smallest <= 1e-9 * size {
                let poses = [left_wheel.moved(0.0), right_wheel.moved(0.0)];
                return Ok(([heave + half, heave - half], poses));
            }
            smallest = smallest.min(step.abs());
            reached = Some(half);
            half += step;
        }
        Err(NoPose::NoGround)
    }

    fn contact(&self, side: Side, pose: &Pose<f64>, ground: Ground<f64>) -> Vector3<f64> {
        let corner = &self.corners[side as usize];
        let at = corner.configuration(*pose);
        at.point(corner.mechanism.wheel_centre)
            + ground.contact_lever(at.spin_axis(), self.radius())
    }

    fn track_of(&self, [left, right]: [&Pose<f64>; 2], ground: Ground<f64>) -> f64 {
        let mirrored = ground.mirrored();
        let left = self.contact(Side::Left, left, ground);
        let right = self.contact(Side::Right, right, mirrored);
        left.dot(ground.outboard()) + right.dot(mirrored.outboard())
    }

    /// The roll angle at which both wheels stand on a plane.
    fn tilted(&self, [left, right]: &[Pose<f64>; 2]) -> Result<f64, NoPose> {
        // A rigid axle may stand upright, far from a level ground: it begins at the line through both wheel centres.
        let mut roll = match self.is_rigid() {
            false => 0.0_f64,
            true => (right.origin.z - left.origin.z).atan2(left.origin.y + right.origin.y),
        };
        let mut smallest = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let ground = Ground::rolled(roll);
            let mirrored = ground.mirrored();
            let left_height = self.contact(Side::Left, left, ground).dot(ground.normal());
            let right_height = self.contact(Side::Right, right, mirrored);
            let right_height = right_height.dot(mirrored.normal());
            let step = -(left_height - right_height) / self.track_of([left, right], ground);
            if step.abs() <= 2.0 * f64::EPSILON || step.abs() >= smallest && smallest <= 1e-12 {
                return Ok(roll);
            }
            smallest = smallest.min(step.abs());
            roll += step;
        }
        Err(NoPose::NoGround)
    }

    /// Reads a position.
    pub fn read(&mut self, placed: &AxlePose) -> Result<Read<'a>, NoPose> {
        let (lines, parts) = (self.lines, self.parts);
        let coordinates = self.coordinates(placed.travels, placed.rack);
        let mut wheel = |side: Side| {
            let corner = &mut self.corners[side as usize];
            let (travel, rack) = coordinates[side as usize];
            let pose = &placed.poses[side as usize];
            let found = corner.begin(rack).map_err(|_| Failure::Singular);
            let found = found.and_then(|()| corner.read(pose, travel, rack, (lines, &parts)));
            found.map_err(|failure| corner.fails(travel, failure))
        };
        let [left, right] = [wheel(Side::Left)?, wheel(Side::Right)?];
        Ok(self.both([&left, &right], placed))
    }

    /// Reads one wheel at many travels and one rack displacement, outward from the design position, as the curves of a
    /// single wheel are read.
    pub fn wheel_curve(
        &mut self,
        side: Side,
        travels: &[f64],
        rack: f64,
    ) -> Vec<Result<WheelRead, NoPose>> {
        let (lines, parts) = (self.lines, self.parts);
        let corner = &mut self.corners[side as usize];
        let rack = rack * corner.rack_sign;
        let fails = |travel: f64, failure| NoPose::Wheel {
            side,
            travel,
            failure,
        };
        let unvisited = |travel: &f64| Err(fails(*travel, Failure::Singular));
        let mut found: Vec<_> = travels.iter().map(unvisited).collect();
        // The design position was checked when the solver was made; stations that cannot be visited keep their failure.
        if corner.begin(rack).is_err() {
            return found;
        }
        let Corner {
            solver,
            series,
            toggles,
            points,
            ..
        } = corner;
        let order = StationOrder::through(travels);
        let _ = solver.for_each_pose(Drive::Travel, &order, rack, |solver, station, pose| {
            let travel = travels[station];
            let at = (travel, rack);
            let wheel = pose.and_then(|pose| {
                read_wheel(solver, series, toggles, pose, at, (lines, &parts, points))
            });
            found[station] = wheel.map_err(|failure| fails(travel, failure));
            ControlFlow::Continue(())
        });
        found
    }

    /// The position of two wheels that were read at their travels.
    pub fn pair(
        &self,
        wheels: [&WheelRead; 2],
        rack: f64,
        on_plane: bool,
    ) -> Result<(AxlePose, Read<'a>), NoPose> {
        checkpoint();
        let poses = wheels.each(|wheel| wheel.pose);
        let (roll, hold) = match on_plane {
            false => (0.0, Hold::TravelsOnPads),
            true => (self.tilted(&poses)?, Hold::TravelsOnPlane),
        };
        let placed = AxlePose {
            travels: wheels.each(|wheel| wheel.travel),
            roll,
            rack,
            hold,
            at_load: None,
            poses,
        };
        Ok((placed, self.both(wheels, &placed)))
    }

    fn both(&self, wheels: [&WheelRead; 2], placed: &AxlePose) -> Read<'a> {
        let [left, right] = wheels;
        Read {
            state: self.state([left.reading, right.reading], placed),
            condition: left.condition.max(right.condition),
            toggles: [left.toggle, right.toggle],
            points: [left.points.clone(), right.points.clone()],
        }
    }

    fn state<T: crate::number::Real>(
        &self,
        readings: [Reading<T>; 2],
        placed: &AxlePose,
    ) -> AxleState<'a, T> {
        let like = readings[0].like();
        AxleState {
            readings,
            ground: Ground::rolled(placed.roll).map(|c| like.constant(c)),
            roll: like.constant(placed.roll),
            hold: placed.hold,
            carriers: Carriers::of(self.axle),
            setup: self.setup,
        }
    }

    /// The gradients of quantities in a position by every hardpoint coordinate of each side, in the frame of
    /// that side. `receive` gets the number of the quantity and both gradients, by point.
    ///
    /// A gradient is NaN if its quantity needs terms that the series lack because `N` is too small.
    pub fn gradients(
        &mut self,
        placed: &AxlePose,
        quantities: &[Quantity],
        mut receive: impl FnMut(usize, [&[Vector3<f64>]; 2]),
    ) -> Result<(), NoPose> {
        let sought: Vec<_> = quantities.iter().copied().map(Sought::Quantity).collect();
        self.gradients_of(placed, &sought, &mut receive)
    }

    /// The gradients of quantities and of coordinates of points, the latter in the frame of their side.
    pub(super) fn gradients_of(
        &mut self,
        placed: &AxlePose,
        sought: &[Sought],
        receive: &mut ReceiveGradients<'_>,
    ) -> Result<(), NoPose> {
        let by_heave = match placed.at_load {
            Some(level) => Some(self.loads()?.heave_by_design(level, placed)?),
            None => None,
        };
        let (lines, parts) = (self.lines, self.parts);
        let coordinates = self.coordinates(placed.travels, placed.rack);
        let plain = self.read(placed)?.state;
        let slopes = {
            let [left, right] = plain.wheels().each(|wheel| wheel.rise());
            [left + right, plain.track()]
        };
        let linearised = linearise(&self.corners, (lines, parts), placed, coordinates)?;
        let inputs = linearised.inputs();
        // The wheels stand on the tape once; every quantity follows them.
        self.tape.clear();
        let tape = &self.tape;
        let [(left, of_left), (right, of_right)] = linearised.on_tape(tape);
        let (readings, first) = ([left, right], [of_left, of_right]);
        let state = self.state(readings, placed).settled(slopes);
        let value = |sought: &Sought| match sought {
            Sought::Quantity(quantity) => quantity.evaluate(&state),
            // A point moves with its wheel's travel, which depends on the design if it follows from the ground.
            Sought::Point(side, ..) => state.readings[*side as usize].travel(),
        };
        let values: Vec<_> = sought.iter().map(value).collect();
        tape.gradients(&values, of_right + inputs, |number, by_numbers| {
            let sought = &sought[number];
            for side in Side::ALL {
                let by = &by_numbers[first[side as usize]..][..inputs];
                let gradient = &mut self.gradients[side as usize];
                gradient.fill(Vector3::new(0.0, 0.0, 0.0));
                linearised.add_gradient(side, by, &mut self.buffer, gradient);
            }
            if let Sought::Point(side, id, axis) = *sought {
                let linearised = &linearised.wheels[side as usize][0];
                let by_travel = linearised.at.point(id)[axis].0.get(1).copied();
                for by in self.gradients.iter_mut().flatten() {
                    // On pads no travel follows from the ground.
                    *by = *by * by_travel.unwrap_or(0.0);
                }
                let zero = Vector3::new(0.0, 0.0, 0.0);
                self.buffer.fill(zero.map(Jet::constant));
                let along = Axis::ALL.each(|other| Jet::constant(f64::from(other == axis)));
                linearised.gradient(&mut self.buffer, |sink| sink.point(id, along.into()));
                let own = self.gradients[side as usize].iter_mut();
                for (total, by) in own.zip(&self.buffer) {
                    *total = *total + by.map(|c| c[0]);
                }
            }
            if let Some(heaves) = &by_heave {
                let along = derivative_by_heave(&plain, &linearised.wheels, sought);
                for (gradient, heaves) in self.gradients.iter_mut().zip(heaves) {
                    for (total, by) in gradient.iter_mut().zip(heaves) {
                        *total = *total + *by * along;
                    }
                }
            }
            let rigid = self.axle.left.mechanism.rigid_axle.as_ref();
            let [left, right] = &mut self.gradients;
            if let Some(rigid) = rigid {
                rigid.gather([left, right]);
            }
            receive(number, [left, right]);
        });
        Ok(())
    }

    /// Proves that poses of one wheel, at these values of its drive and one rack displacement, lie on the branch of its design
    /// position. The mean travel of a rigid axle takes the place of the rack.
    pub(super) fn prove_branch(
        &mut self,
        certifier: &Certifier,
        side: Side,
        rack: f64,
        (travels, poses): (&[f64], &[Pose<f64>]),
    ) -> Vec<Result<(), NoPose>> {
        let corner = &mut self.corners[side as usize];
        let order = StationOrder::through(travels);
        let found: Vec<_> = poses.iter().copied().map(Ok).collect();
        let mut proved = vec![Err(Failure::Uncertified(Unproven::Branch)); travels.len()];
        let rack = rack * corner.rack_sign;
        // The design position was looked at when the solver was made.
        let _ = corner.solver.prove_poses(
            certifier,
            Drive::Travel,
            &order,
            rack,
            &found,
            |_, station, certified| {
                proved[station] = certified.map(|_| ());
                ControlFlow::Continue(())
            },
        );
        let wheel = |(proved, travel): (Result<(), Failure>, &f64)| {
            proved.map_err(|failure| corner.fails(*travel, failure))
        };
        proved.into_iter().zip(travels).map(wheel).collect()
    }

    /// Returns the limits of one wheel alone, in the frame of its side.
    pub(super) fn limits_of(&mut self, side: Side) -> Result<Limits, (Side, DesignFault)> {
        let limits = self.corners[side as usize].solver.limits();
        limits.map_err(|fault| (side, fault))
    }

    /// The pose of one wheel at a travel, the rack in the middle.
    pub(super) fn pose(&mut self, side: Side, travel: f64) -> Option<Pose<f64>> {
        let corner = &mut self.corners[side as usize];
        corner.at(travel, 0.0, |_, _, pose| Ok(*pose)).ok()
    }

    /// The roll angle of a plane under both wheels in these poses.
    pub(super) fn plane_under(&self, poses: &[Pose<f64>; 2]) -> Option<f64> {
        self.tilted(poses).ok()
    }

    /// The spin axis of a wheel in the design position, in the frame of its side.
    pub fn spin_axis(&self, side: Side) -> Vector3<f64> {
        let corner = &self.corners[side as usize];
        corner
            .configuration(corner.solver.design_pose())
            .spin_axis()
    }

    /// The designs of both wheels, each in the frame of its side.
    pub(super) fn designs(&self) -> [Vec<Vector3<f64>>; 2] {
        self.corners
            .each_ref()
            .map(|corner| corner.solver.design().to_vec())
    }

    /// The size of the left wheel's mechanism, against which lengths are measured.
    pub(super) fn size(&self) -> f64 {
        self.corners[0].solver.size()
    }

    /// The points of each wheel.
    pub fn points(&self) -> impl Iterator<Item = PointId> {
        (0..self.buffer.len()).map(PointId)
    }
}
