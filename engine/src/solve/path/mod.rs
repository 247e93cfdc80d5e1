//! Poses that are connected to the design position.
//!
//! A mechanism has many assemblies. The required assembly is the one that the mechanism reaches by a motion from the design
//! position. So every pose is found by following a path: first the rack moves at zero drive, then the drive moves outward,
//! station by station. The module `tracker` finds the poses up to the last station that its checks accept. From that station
//! on, the solver follows the closure equations. Its steps are so small that Newton's method stays on the solution branch.

mod follow;
mod series;
mod stations;

pub(super) use crate::mechanism::{DesignFault, Failure};
pub(crate) use follow::predict;
pub use stations::StationOrder;

use super::closed_form::ClosedForm;
use super::continuation::{Curve, Moving};
use super::tracker::{PoseTracker, Rejection, TrackedPoses};
use crate::derive::{DesignSeries, MotionPoint};
use crate::linear::lu::{Lu6, Matrix6};
use crate::mechanism::Closure;
use crate::mechanism::{Configuration, Pose};
use crate::mechanism::{DEGENERATE, ROUNDING};
use crate::mechanism::{Work, WorkCounter};
use crate::model::{Drive, Mechanism, PointId};
use crate::number::{Each, Matrix3, Vector3};
use crate::threads::checkpoint;
use std::ops::ControlFlow;

/// Range of permitted sizes of a mechanism. The eighth powers of these sizes, and their inverses, neither overflow nor underflow.
const SIZES: std::ops::Range<f64> = 1e-30..1e30;

/// Finds the poses of a design. [`Solver::prepare`] changes to the next design.
#[derive(Clone, Debug)]
pub struct Solver<'m> {
    mechanism: &'m Mechanism,
    design: Vec<Vector3<f64>>,
    pub(crate) closure: Closure<f64>,
    form: Option<ClosedForm<f64>>,
    tracker: Option<PoseTracker<'m>>,
    /// Poses that the tracker found in the last visit.
    tracked: TrackedPoses,
    /// The design's closure equations as Taylor series along the motion. The continuation predicts poses from them. Made
    /// when first needed.
    design_series: Option<DesignSeries<3>>,
    series_is_current: bool,
    size: f64,
    /// Largest distance of a point from the coordinate origin, or the size if the size is larger. Rounding errors of positions
    /// are relative to this length.
    coordinate_scale: f64,
    pub(crate) work: WorkCounter,
}

/// Callback that receives the index of a station and its pose, or the reason why it has no pose. The visitor may end
/// the visit.
type Visitor<'v, 'm> =
    dyn FnMut(&Solver<'m>, usize, Result<&Pose<f64>, Failure>) -> ControlFlow<()> + 'v;

/// A point on the path: a pose with its motion point (values of drive and rack).
pub(crate) type Station = (Pose<f64>, MotionPoint<f64>);

impl<'m> Solver<'m> {
    /// Makes a solver for this mechanism, at first with this design. Designs far from it are also solved, but more slowly.
    /// An error says why the design cannot be solved.
    pub fn new(mechanism: &'m Mechanism, design: &[Vector3<f64>]) -> Result<Self, DesignFault> {
        let mut solver = Solver {
            mechanism,
            design: design.to_vec(),
            closure: Closure::new(mechanism, design),
            form: None,
            tracker: Some(PoseTracker::new(mechanism, design)),
            tracked: TrackedPoses::default(),
            design_series: None,
            series_is_current: false,
            size: 1.0,
            coordinate_scale: 1.0,
            work: WorkCounter::default(),
        };
        solver.prepare(design)?;
        Ok(solver)
    }

    /// Changes to another design of the same mechanism. An error says why it cannot be solved.
    pub fn prepare(&mut self, design: &[Vector3<f64>]) -> Result<(), DesignFault> {
        self.design.copy_from_slice(design);
        for (i, p) in design.iter().enumerate() {
            if !(p.x.is_finite() && p.y.is_finite() && p.z.is_finite()) {
                return Err(DesignFault::NotFinite(PointId(i)));
            }
        }
        self.size = self.mechanism.size(design);
        self.coordinate_scale = self.mechanism.coordinate_scale(design);
        self.series_is_current = false;
        // Products of up to eight lengths must neither overflow nor underflow. Lengths of the mechanism's size must have at
        // least six digits after the rounding of coordinates. The condition is written so that NaN from an overflow is
        // refused.
        if !(self.coordinate_scale * DEGENERATE < self.size && SIZES.contains(&self.size)) {
            return Err(DesignFault::OutOfScale);
        }
        self.check_distinct()?;
        for arm in &self.mechanism.arms {
            let [front, rear, outer] = [arm.front, arm.rear, arm.outer].each(|id| design[id.0]);
            let axis = (rear - front).normalised();
            let radius = axis.cross(outer - front).norm();
            if radius.is_nan() || radius <= DEGENERATE * self.size {
                return Err(DesignFault::ArmWithoutRadius { outer: arm.outer });
            }
        }
        self.closure.prepare(self.mechanism, design);
        self.form = ClosedForm::of(self.mechanism, design)?;
        Ok(())
    }

    /// Refuses rods and axes without length. Also refuses rods and axes so short that the rounding of coordinates leaves fewer
    /// than six digits of their direction.
    fn check_distinct(&self) -> Result<(), DesignFault> {
        let shortest = (DEGENERATE * self.size).max(1e6 * f64::EPSILON * self.coordinate_scale);
        let distinct = |first: PointId, second: PointId| {
            let apart = self.design[second.0] - self.design[first.0];
            if apart.norm_squared() > shortest * shortest {
                Ok(())
            } else {
                Err(DesignFault::Coincident { first, second })
            }
        };
        let mut pairs = self.mechanism.lengths();
        pairs.try_for_each(|(first, second)| distinct(first, second))
    }

    /// The mechanism.
    pub fn mechanism(&self) -> &'m Mechanism {
        self.mechanism
    }

    /// Returns a solver that finds every pose by continuation. It finds the same poses more slowly, for comparison.
    pub fn by_continuation(mut self) -> Self {
        self.tracker = None;
        self
    }

    /// Counts of the solver's steps since the solver was made.
    pub fn work(&self) -> Work {
        self.work.work()
    }

    /// Present design.
    pub fn design(&self) -> &[Vector3<f64>] {
        &self.design
    }

    /// The pose of the knuckle in the design position.
    pub fn design_pose(&self) -> Pose<f64> {
        Pose {
            origin: self.design[self.mechanism.origin.0],
            rotation: Matrix3::identity(0.0),
        }
    }

    /// Size of the mechanism: the largest distance of a point from the knuckle's origin.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Visits every station of the order with the rack at `rack` (towards the kernel's +y), outward from the design
    /// position. `visit` receives the station's index and its pose, or the reason why it has no pose. The visitor may
    /// end the visit.
    pub fn for_each_pose(
        &mut self,
        drive: Drive,
        station_order: &StationOrder,
        rack: f64,
        mut visit: impl FnMut(&Self, usize, Result<&Pose<f64>, Failure>) -> ControlFlow<()>,
    ) -> Result<(), DesignFault> {
        self.visit_stations(drive, station_order, rack, &mut visit)
    }

    /// Visits stations like [`Solver::for_each_pose`], but is compiled once for all visitors.
    fn visit_stations(
        &mut self,
        drive: Drive,
        station_order: &StationOrder,
        rack: f64,
        visit: &mut Visitor<'_, 'm>,
    ) -> Result<(), DesignFault> {
        let design = self.start(drive)?;
        let mut tracked = std::mem::take(&mut self.tracked);
        tracked.clear(station_order);
        if let Some(tracker) = &mut self.tracker {
            tracker.track(&self.design, drive, station_order, rack, &mut tracked);
        }
        self.note_tracked(&tracked);
        let mut placed = None;
        'sides: for side in station_order.sides() {
            let mut last: Option<Result<Station, Failure>> = None;
            for &station in side {
                checkpoint();
                let point = MotionPoint {
                    drive,
                    value: station_order.values()[station],
                    rack,
                };
                let here = match tracked.poses[station] {
                    // The design pose is known exactly. The tracker's pose has rounding errors, which matter near a rocker's
                    // toggle.
                    _ if point == design.1 => Ok(design),
                    Ok(pose) => Ok((pose, point)),
                    Err(_) => {
                        let from = last.unwrap_or_else(|| {
                            *placed.get_or_insert_with(|| self.displaced(&design, rack))
                        });
                        from.and_then(|from| self.advance(&from, point))
                    }
                };
                last = Some(here);
                let found = here.as_ref().map(|(pose, _)| pose).map_err(|f| *f);
                if visit(self, station, found).is_break() {
                    break 'sides;
                }
            }
        }
        self.tracked = tracked;
        Ok(())
    }

    /// Reason why the tracker rejected a station of the last visit. `None` if it accepted the station, or if there is no such
    /// station. Not available during a visit.
    pub fn rejection(&self, station: usize) -> Option<Rejection> {
        self.tracked.poses.get(station)?.err()
    }

    fn note_tracked(&self, tracked: &TrackedPoses) {
        let poses = tracked.poses.iter().filter(|pose| pose.is_ok()).count() as u64;
        let rounds = tracked.rounds;
        self.work.note(|w| match self.form {
            Some(_) => {
                w.closed_form_solves += poses;
                w.closed_form_evaluations += 2 * rounds;
            }
            None => {
                w.newton_iterations += rounds;
                w.factorisations += rounds;
                w.right_hand_sides += 2 * rounds;
            }
        });
    }

    /// Follows the path from the design position to zero drive with the rack displaced.
    fn displaced(&mut self, design: &Station, rack: f64) -> Result<Station, Failure> {
        let point = MotionPoint { rack, ..design.1 };
        self.advance(design, point)
    }

    /// Pose and motion point at zero drive with the rack displaced.
    pub(crate) fn placed(
        &mut self,
        drive: Drive,
        rack: f64,
    ) -> Result<Result<Station, Failure>, DesignFault> {
        let start = self.start(drive)?;
        Ok(self.displaced(&start, rack))
    }

    /// Pose and motion point of the design position.
    pub(crate) fn design_place(&self, drive: Drive) -> Station {
        let pose = self.design_pose();
        let point = MotionPoint {
            drive,
            value: 0.0,
            rack: 0.0,
        };
        (pose, point)
    }

    /// Curve along which `moving` changes, with all other quantities fixed at `held`.
    pub(crate) fn curve(&mut self, moving: Moving, held: MotionPoint<f64>) -> Curve<'_> {
        self.prepare_series();
        Curve {
            mechanism: self.mechanism,
            design: &self.design,
            closure: &self.closure,
            design_series: self.design_series.as_ref().expect("just made"),
            size: self.size,
            rounding: ROUNDING * self.coordinate_scale / self.size,
            work: &self.work,
            moving,
            held,
        }
    }

    /// Makes the Taylor series for the present design, unless they are up to date.
    fn prepare_series(&mut self) {
        if !self.series_is_current {
            match &mut self.design_series {
                Some(design_series) => design_series.prepare(self.mechanism, &self.design),
                None => self.design_series = Some(DesignSeries::new(self.mechanism, &self.design)),
            }
            self.series_is_current = true;
        }
    }

    /// Checks that the drive can move the mechanism from its design position.
    ///
    /// # Errors
    /// Returns an error if the design position is singular.
    pub fn check_start(&self, drive: Drive) -> Result<(), DesignFault> {
        self.start(drive).map(drop)
    }

    /// Start of the path at the design position, if the drive can move the mechanism from there.
    fn start(&self, drive: Drive) -> Result<Station, DesignFault> {
        let (pose, point) = self.design_place(drive);
        let lu = self
            .factorise(&pose, &point)
            .filter(|lu| lu.determinant().abs() > DEGENERATE)
            .ok_or(DesignFault::Singular)?;
        debug_assert!(lu.determinant().is_finite());
        Ok((pose, point))
    }

    pub(crate) fn configuration<'a>(
        &'a self,
        pose: &Pose<f64>,
        rack: f64,
    ) -> Configuration<'a, f64> {
        Configuration::new(self.mechanism, &self.design, *pose, rack)
    }

    pub(crate) fn factorise(&self, pose: &Pose<f64>, point: &MotionPoint<f64>) -> Option<Lu6<f64>> {
        self.factorised(pose, point).map(|(_, lu)| lu)
    }

    /// Jacobian of the closure equations in a pose, and its LU factors. `None` if the Jacobian is singular.
    pub(crate) fn factorised(
        &self,
        pose: &Pose<f64>,
        point: &MotionPoint<f64>,
    ) -> Option<(Matrix6<f64>, Lu6<f64>)> {
        let at = self.configuration(pose, point.rack);
        let jacobian = self.closure.jacobian(&at, point.driver());
        self.work.note(|w| w.factorisations += 1);
        Some((jacobian, Lu6::new(jacobian, self.size)?))
    }

    /// Follows the path to the motion point `to`.
    fn advance(&mut self, from: &Station, to: MotionPoint<f64>) -> Result<Station, Failure> {
        if to == from.1 {
            return Ok(*from);
        }
        Ok((self.follow(from, &to)?, to))
    }
}
