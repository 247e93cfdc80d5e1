//! Poses that are connected to the design position.
//!
//! A mechanism has many assemblies; the one meant is the one reached from the design position by moving
//! it. So every pose is found by walking: the rack first, at zero travel, then the drive, station by
//! station outward. A step is taken by the closed form where there is one and nothing is close to
//! changing (slope, toggle), else by following the closure equations with steps small enough that
//! Newton's method cannot leave the branch.

use super::accuracy::{Demand, MARGIN, PoseError};
use super::certificate::Unproven;
use super::closed_form::ClosedForm;
use super::closure::{Closure, Driver};
use super::continuation::{Curve, Moving, PathEnd};
use super::limits::LimitCause;
use super::loads::{Balance, Support};
use super::lu::{Lu6, Matrix6};
use super::motion::{Factorised, Lifted, MotionPoint};
use super::point_coordinates::{self, Refusal};
use super::pose::{Pose, Posture};
use super::sensitivity::Linearised;
use super::work::{Tally, Work};
use crate::model::{Drive, Mechanism, PointId};
use crate::number::{Jet, Matrix3, Vector3};
use std::fmt;
use std::ops::ControlFlow;

/// Why a station has no pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// The drive cannot get there: the mechanism folds at `limit`.
    Unreachable {
        /// What drives.
        drive: Drive,
        /// The value at the fold.
        limit: f64,
        /// Why it goes no further.
        cause: LimitCause,
    },
    /// The rack cannot get there, at zero travel.
    RackUnreachable {
        /// The displacement at the fold, towards the kernel's +y.
        limit: f64,
        /// Why it goes no further.
        cause: LimitCause,
    },
    /// The pose was reached, but its derivatives do not exist there.
    Singular,
    /// A proof was asked for and there is none.
    Uncertified(Unproven),
    /// The seed paper's drive asks for the arm's highest or lowest position, or beyond it.
    DeadCentre,
    /// The formulation in point coordinates found no pose.
    PointCoordinates {
        /// What drives.
        drive: point_coordinates::Drive,
        /// Why there is none; the value of the drive in it is as the study counts it.
        refusal: point_coordinates::Refusal,
    },
}

/// Why a design cannot be solved at all.
#[derive(Clone, Debug, PartialEq)]
pub enum DesignFault {
    /// A coordinate is not a finite number.
    NotFinite(PointId),
    /// The outer joint of an arm lies on the arm's axis.
    ArmWithoutRadius {
        /// The joint.
        outer: PointId,
    },
    /// A tie rod whose inner end is on the steering axis cannot steer.
    NoSteering {
        /// The end that lies on the axis.
        end: PointId,
    },
    /// The tie rod is in line with the plane it should turn the knuckle out of.
    Toggle,
    /// The strut has no length above the ball joint.
    NoStrutLength,
    /// The upper arm is in line with the steering axis, so that it does not hold the knuckle.
    UpperArmInLine {
        /// The upper ball joint.
        outer: PointId,
    },
    /// Two points that a rod, a strut axis or the wheel's spin axis runs between coincide.
    Coincident {
        /// One.
        first: PointId,
        /// The other.
        second: PointId,
    },
    /// The coordinates are so large, or the points so close to each other for their distance from the
    /// origin, that double precision cannot tell them apart.
    OutOfScale,
    /// The seed paper's drive is singular in the design position.
    DeadCentre {
        /// The outer joint of the arm.
        outer: PointId,
    },
    /// The formulation in point coordinates cannot describe the design.
    PointCoordinates(point_coordinates::Refusal),
    /// Some combination of the constraints does not hold the knuckle, or the drive cannot move it.
    Singular,
}

impl DesignFault {
    /// The fault in words, with the names of the points.
    pub fn describe(&self, mechanism: &Mechanism) -> String {
        let name = |id: &PointId| mechanism.name(*id).to_owned();
        match self {
            DesignFault::NotFinite(id) => format!("{} is not a finite point", name(id)),
            DesignFault::ArmWithoutRadius { outer } => {
                format!("{} lies on the axis of its arm, so the arm cannot move it", name(outer))
            }
            DesignFault::NoSteering { end } => format!(
                "{} lies on the steering axis, so the tie rod does not hold the wheel's heading",
                name(end)
            ),
            DesignFault::Coincident { first, second } => format!(
                "{} and {} coincide, but what runs between them needs a length",
                name(first),
                name(second)
            ),
            DesignFault::OutOfScale => "the points are too far from the origin, or too large or small, \
                 for double precision to tell them apart"
                .to_owned(),
            DesignFault::Toggle => "the tie rod is at toggle in the design position: its ends lie in one \
                 plane with the steering axis"
                .to_owned(),
            DesignFault::NoStrutLength => {
                "the strut has no length: its mount is at the foot of the ball joint on the strut axis"
                    .to_owned()
            }
            DesignFault::UpperArmInLine { outer } => format!(
                "the upper arm is in line with the steering axis, so it does not hold {}",
                name(outer)
            ),
            DesignFault::DeadCentre { outer } => format!(
                "{} is at the highest or lowest point of its arm's circle, where the drive \
                 \"paper_theta\" is singular",
                name(outer)
            ),
            DesignFault::PointCoordinates(refusal) => format!(
                "the design position cannot be solved in point coordinates: {refusal}"
            ),
            DesignFault::Singular => {
                "the design position is singular: the drive cannot move the wheel from it".to_owned()
            }
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Unreachable {
                drive: Drive::Travel,
                limit,
                cause,
            } => write!(f, "the wheel travel ends at {limit:.6}: {cause}"),
            Failure::Unreachable {
                drive: Drive::ArmAngle,
                limit,
                cause,
            } => write!(
                f,
                "the arm turns no further than {:.6} deg: {cause}",
                limit.to_degrees()
            ),
            Failure::RackUnreachable { limit, cause } => {
                write!(
                    f,
                    "the rack moves no further than {:.6}: {cause}",
                    limit.abs()
                )
            }
            Failure::Singular => write!(f, "the pose is singular: it has no derivatives"),
            Failure::Uncertified(reason) => write!(f, "the pose is not proved: {reason}"),
            Failure::DeadCentre => write!(
                f,
                "theta takes the arm to its highest or lowest position or beyond, where this drive \
                 is singular"
            ),
            Failure::PointCoordinates {
                drive,
                refusal: Refusal::Unreachable { value, limit },
            } => match drive {
                point_coordinates::Drive::Travel => {
                    write!(f, "the wheel travel ends at {value:.6}: {limit}")
                }
                point_coordinates::Drive::ArmAngle => {
                    let value = value.to_degrees();
                    write!(f, "the arm turns no further than {value:.6} deg: {limit}")
                }
                point_coordinates::Drive::PaperTheta => {
                    let value = value.to_degrees();
                    write!(f, "theta gets no further than {value:.6} deg: {limit}")
                }
            },
            Failure::PointCoordinates { refusal, .. } => refusal.fmt(f),
        }
    }
}

/// The order in which stations are visited: outward from the design position, so that every step
/// starts at a neighbour.
#[derive(Clone, Debug, PartialEq)]
pub struct March {
    /// Drive values by station.
    values: Vec<f64>,
    /// Stations at and above the design position, upward.
    up: Vec<usize>,
    /// Stations below it, downward.
    down: Vec<usize>,
}

impl March {
    /// The march through these drive values.
    pub fn through(values: &[f64]) -> Self {
        let (mut up, mut down): (Vec<_>, Vec<_>) =
            (0..values.len()).partition(|i| values[*i] >= 0.0);
        up.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
        down.sort_by(|a, b| values[*b].total_cmp(&values[*a]));
        March {
            values: values.to_vec(),
            up,
            down,
        }
    }

    /// The stations of each side, outward.
    pub(crate) fn sides(&self) -> [&[usize]; 2] {
        [&self.up, &self.down]
    }

    /// Drive values by station.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

/// Relative quantities below this are taken as zero: with less, fewer than six digits of a
/// double-precision result would be left.
pub(super) const DEGENERATE: f64 = 1e-10;

/// Sizes whose eighth powers, and their inverses, are ordinary doubles.
const SIZES: std::ops::Range<f64> = 1e-30..1e30;

/// Finds the poses of one design after another.
#[derive(Clone, Debug)]
pub struct Solver<'m> {
    mechanism: &'m Mechanism,
    design: Vec<Vector3<f64>>,
    closure: Closure<f64>,
    form: Option<ClosedForm<f64>>,
    /// For the predictor of the step-by-step path; made when first needed.
    lifted: Option<Lifted<3>>,
    lifted_is_current: bool,
    size: f64,
    /// The largest coordinate, at least the size: what positions are rounded at.
    reach: f64,
    /// The last pose that Newton's method settled at, with its factors.
    settled: Option<Settled>,
    /// The last pose that is one of the closed form's, with the tangent of half the arm's angle.
    formed: Option<(Pose<f64>, MotionPoint<f64>, f64)>,
    work: Tally,
    demand: Demand,
}

/// A pose whose Jacobian is factorised already.
#[derive(Clone, Copy, Debug)]
struct Settled {
    pose: Pose<f64>,
    point: MotionPoint<f64>,
    factors: Lu6<f64>,
}

/// A pose with the motion point it was found at.
pub(super) type Station = (Pose<f64>, MotionPoint<f64>);

/// A place on the path.
#[derive(Clone, Copy, Debug)]
struct Place {
    point: MotionPoint<f64>,
    pose: Pose<f64>,
    quick: Option<Quick>,
}

/// What the closed form knows of a place: tangent of half the arm angle, its slope by the drive, and
/// the same at the place before.
#[derive(Clone, Copy, Debug)]
struct Quick {
    tangent: f64,
    slope: f64,
    before: Option<(f64, f64, f64)>,
    /// How fast the pose moved by the tangent in the last step; known where less than full precision is
    /// asked for.
    speed: Option<PoseError>,
    /// What may not vanish on the way, with its slope by the tangent.
    margins: [Jet<f64, 2>; 2],
}

impl<'m> Solver<'m> {
    /// A solver for this mechanism, at first for this design.
    pub fn new(mechanism: &'m Mechanism, design: &[Vector3<f64>]) -> Result<Self, DesignFault> {
        let mut solver = Solver {
            mechanism,
            design: design.to_vec(),
            closure: Closure::new(mechanism, design),
            form: None,
            lifted: None,
            lifted_is_current: false,
            size: 1.0,
            reach: 1.0,
            settled: None,
            formed: None,
            work: Tally::default(),
            demand: Demand::default(),
        };
        solver.prepare(design)?;
        Ok(solver)
    }

    /// Takes over another design of the same mechanism.
    pub fn prepare(&mut self, design: &[Vector3<f64>]) -> Result<(), DesignFault> {
        self.design.copy_from_slice(design);
        for (i, p) in design.iter().enumerate() {
            if !(p.x.is_finite() && p.y.is_finite() && p.z.is_finite()) {
                return Err(DesignFault::NotFinite(PointId(i)));
            }
        }
        self.size = self.mechanism.size(design);
        self.reach = self.mechanism.reach(design);
        self.lifted_is_current = false;
        self.settled = None;
        self.formed = None;
        // Products of up to eight lengths must neither overflow nor underflow, and coordinates must
        // leave six digits of the size. Written so that NaN, from an overflow, is refused.
        if !(self.reach * DEGENERATE < self.size && SIZES.contains(&self.size)) {
            return Err(DesignFault::OutOfScale);
        }
        self.check_distinct()?;
        for arm in &self.mechanism.arms {
            let [front, rear, outer] = [arm.front, arm.rear, arm.outer].map(|id| design[id.0]);
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

    /// Refuses rods and axes without a length, or so short that rounding of the coordinates leaves fewer
    /// than six digits of their direction.
    fn check_distinct(&self) -> Result<(), DesignFault> {
        let shortest = (DEGENERATE * self.size).max(1e6 * f64::EPSILON * self.reach);
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

    /// Asks for less than full double precision: poses that are off by no more than this.
    pub fn with_accuracy(mut self, allowed: PoseError) -> Self {
        self.demand = Demand::new(allowed);
        self
    }

    /// A bound on the error of every pose found so far.
    pub fn error_bound(&self) -> PoseError {
        self.demand.bound(self.reach, self.size)
    }

    /// What was done since the solver was made.
    pub fn work(&self) -> Work {
        self.work.work()
    }

    /// The design being solved.
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

    /// The size of the mechanism: the largest distance of a point from the knuckle's origin.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Visits every station of the march with the rack at `rack` (towards the kernel's +y), outward
    /// from the design position; `visit` gets the station's number and its pose or the reason there is
    /// none, and may break off the march.
    pub fn march(
        &mut self,
        drive: Drive,
        march: &March,
        rack: f64,
        mut visit: impl FnMut(&Self, usize, Result<&Pose<f64>, Failure>) -> ControlFlow<()>,
    ) -> Result<(), DesignFault> {
        let start = self.rack_placed(drive, rack)?;
        for side in [&march.up, &march.down] {
            let mut place = start;
            for &station in side {
                if let Ok(from) = place {
                    let value = march.values[station];
                    place = self.advance(
                        &from,
                        MotionPoint {
                            value,
                            ..from.point
                        },
                    );
                }
                let found = place.as_ref().map(|at| &at.pose).map_err(|f| *f);
                self.formed = place.ok().and_then(|at| {
                    let quick = at.quick?;
                    // Newton's pose agrees with the closed form's to less than all digits.
                    let is_design = at.point.value == 0.0 && at.point.rack == 0.0;
                    // Near a fold rates lose digits: there the factors of the Jacobian tell how many.
                    let is_steep =
                        at.point.drive == Drive::Travel && quick.slope.abs() * self.size > STEEP;
                    if quick.before.is_none() && !is_design || is_steep {
                        return None;
                    }
                    Some((at.pose, at.point, quick.tangent))
                });
                if visit(self, station, found).is_break() {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// The place at zero drive with the rack displaced.
    fn rack_placed(
        &mut self,
        drive: Drive,
        rack: f64,
    ) -> Result<Result<Place, Failure>, DesignFault> {
        let start = self.start(drive)?;
        Ok(match rack {
            0.0 => Ok(start),
            _ => self.advance(
                &start,
                MotionPoint {
                    rack,
                    ..start.point
                },
            ),
        })
    }

    /// Pose and motion point at zero drive with the rack displaced.
    pub(super) fn placed(
        &mut self,
        drive: Drive,
        rack: f64,
    ) -> Result<Result<Station, Failure>, DesignFault> {
        let place = self.rack_placed(drive, rack)?;
        Ok(place.map(|place| (place.pose, place.point)))
    }

    /// Pose and motion point of the design position.
    pub(super) fn design_place(&self, drive: Drive) -> (Pose<f64>, MotionPoint<f64>) {
        let pose = self.design_pose();
        let point = MotionPoint {
            drive,
            value: 0.0,
            rack: 0.0,
        };
        (pose, point)
    }

    /// The pose at `to`, followed from the one at `from`.
    pub(super) fn pose_towards(
        &mut self,
        pose: &Pose<f64>,
        from: &MotionPoint<f64>,
        to: &MotionPoint<f64>,
    ) -> Result<Pose<f64>, Failure> {
        let place = Place {
            point: *from,
            pose: *pose,
            quick: None,
        };
        self.follow(&place, to)
    }

    /// The path on which `moving` moves and the rest is held as at `held`.
    pub(super) fn curve(&mut self, moving: Moving, held: MotionPoint<f64>) -> Curve<'_> {
        self.lift();
        Curve {
            mechanism: self.mechanism,
            design: &self.design,
            closure: &self.closure,
            lifted: self.lifted.as_ref().expect("just made"),
            size: self.size,
            rounding: ROUNDING * self.reach / self.size,
            work: &self.work,
            moving,
            held,
        }
    }

    /// Brings the lifted design up to date.
    fn lift(&mut self) {
        if !self.lifted_is_current {
            match &mut self.lifted {
                Some(lifted) => lifted.prepare(self.mechanism, &self.design),
                None => self.lifted = Some(Lifted::new(self.mechanism, &self.design)),
            }
            self.lifted_is_current = true;
        }
    }

    /// The design position, if the drive can move the mechanism from there.
    fn start(&mut self, drive: Drive) -> Result<Place, DesignFault> {
        let (pose, point) = self.design_place(drive);
        let lu = self
            .factorise(&pose, &point)
            .filter(|lu| lu.determinant().abs() > DEGENERATE)
            .ok_or(DesignFault::Singular)?;
        debug_assert!(lu.determinant().is_finite());
        self.settled = Some(Settled {
            pose,
            point,
            factors: lu,
        });
        Ok(Place {
            point,
            pose,
            quick: self.quick_from(&pose, &point),
        })
    }

    pub(super) fn posture<'a>(&'a self, pose: &Pose<f64>, rack: f64) -> Posture<'a, f64> {
        Posture {
            mechanism: self.mechanism,
            design: &self.design,
            pose: *pose,
            rack,
            steering: None,
        }
    }

    pub(super) fn factorise(&self, pose: &Pose<f64>, point: &MotionPoint<f64>) -> Option<Lu6<f64>> {
        match self.factors_at(pose, point) {
            Some(factors) => Some(*factors),
            None => self.factorised(pose, point).map(|(_, lu)| lu),
        }
    }

    /// The factors of the Jacobian, where they are known.
    fn factors_at(&self, pose: &Pose<f64>, point: &MotionPoint<f64>) -> Option<&Lu6<f64>> {
        let settled = self.settled.as_ref()?;
        (settled.pose == *pose && settled.point == *point).then_some(&settled.factors)
    }

    /// The Jacobian and its factors.
    pub(super) fn factorised(
        &self,
        pose: &Pose<f64>,
        point: &MotionPoint<f64>,
    ) -> Option<(Matrix6<f64>, Lu6<f64>)> {
        let at = self.posture(pose, point.rack);
        let jacobian = self.closure.jacobian(&at, point.driver());
        self.work.note(|w| w.factorisations += 1);
        Some((jacobian, Lu6::new(jacobian, self.size)?))
    }

    fn advance(&mut self, from: &Place, to: MotionPoint<f64>) -> Result<Place, Failure> {
        if to == from.point {
            return Ok(*from);
        }
        match self.step_by_closed_form(from, &to) {
            Some(place) => Ok(place),
            None => {
                let pose = self.follow(from, &to)?;
                Ok(Place {
                    point: to,
                    pose,
                    quick: self.quick_from(&pose, &to),
                })
            }
        }
    }

    /// What the closed form needs to go on from a pose.
    fn quick_from(&self, pose: &Pose<f64>, point: &MotionPoint<f64>) -> Option<Quick> {
        let form = self.form.as_ref()?;
        let tangent = form.half_tangent(pose);
        // Beyond a right angle the tangent of the half angle loses its advantage. Far from the origin
        // the closed form would lose what the closure equations keep.
        if !(tangent.abs() <= 1.0 && self.reach < FAR * self.size) {
            return None;
        }
        // The path may have passed a toggle: then the closed form speaks of another assembly.
        let found = form.pose(&form.at_half_tangent(tangent, point.rack));
        let apart = distance(&found, pose, self.size);
        if apart.is_nan() || apart > SAME * self.size {
            return None;
        }
        let state = form
            .map(Jet::constant)
            .at_half_tangent(Jet::<f64, 2>::variable(tangent), Jet::constant(point.rack));
        let rise = form.map(Jet::constant).travel(&state)[1];
        Some(Quick {
            tangent,
            slope: match point.drive {
                Drive::Travel => 1.0 / rise,
                Drive::ArmAngle => 0.5 * (1.0 + tangent * tangent),
            },
            before: None,
            speed: None,
            margins: state.margins(),
        })
    }

    /// One step by the closed form, if nothing speaks against it.
    fn step_by_closed_form(&self, from: &Place, to: &MotionPoint<f64>) -> Option<Place> {
        let form = self.form.as_ref()?;
        let quick = from.quick?;
        if to.rack != from.point.rack {
            return None;
        }
        let (start, end) = (from.point.value, to.value);
        let lifted = form.map(Jet::<f64, 2>::constant);
        let rack = Jet::constant(to.rack);
        // What may be left of the tangent's error.
        let allowed = match quick.speed {
            Some(speed) => speed.scaled(MARGIN).times_in(self.demand.allowed),
            None => 0.0,
        };
        let mut left = 0.0;
        let mut evaluated = None;
        let (tangent, slope, margins) = match to.drive {
            // No equation to solve.
            Drive::ArmAngle => {
                let tangent = (0.5 * end).tan();
                let state = lifted.at_half_tangent(Jet::variable(tangent), rack);
                (tangent, quick.slope, state.margins())
            }
            Drive::Travel => {
                let predicted = quick.extrapolated(start, end);
                let mut tangent = predicted;
                let mut slope = quick.slope;
                let mut margins = quick.margins;
                let mut settled = false;
                for iteration in 0..4 {
                    self.work.note(|w| w.closed_form_evaluations += 1);
                    let state = lifted.at_half_tangent(Jet::variable(tangent), rack);
                    let rise = lifted.travel(&state);
                    let correction = (end - rise[0]) / rise[1];
                    slope = 1.0 / rise[1];
                    margins = state.margins();
                    let steady = slope / quick.slope;
                    let first_is_long = iteration == 0
                        && correction.abs() > 0.1 * (predicted - quick.tangent).abs();
                    // Written so that NaN, from a state that does not exist, is refused.
                    if first_is_long || !(steady > 0.5 && steady < 2.0) {
                        return None;
                    }
                    // What the correction leaves, by the change of the slope since the place before.
                    let bend = (steady - 1.0) / (tangent - quick.tangent);
                    let short = correction.abs() <= 1e-3 * (predicted - quick.tangent).abs();
                    // Good enough as it is: the slope changes by less than a factor of two.
                    if short && 2.0 * correction.abs() <= allowed {
                        left = 2.0 * correction.abs();
                        evaluated = Some(state.now());
                        settled = true;
                        break;
                    }
                    left = (MARGIN * bend.abs() + 1.0) * correction * correction;
                    tangent += correction;
                    // The error left is of the order of the correction squared.
                    if correction.abs() <= 1e-8 || (short && left <= allowed) {
                        settled = true;
                        break;
                    }
                }
                if !settled {
                    return None;
                }
                (tangent, slope, margins)
            }
        };
        let step = tangent - quick.tangent;
        let state = match evaluated {
            Some(state) => state,
            None => {
                self.work.note(|w| w.closed_form_evaluations += 1);
                form.at_half_tangent(tangent, to.rack)
            }
        };
        // Half an angle's tangent grows by at least half of the angle.
        if !(step.abs() <= 0.5 * LONGEST_TURN
            && tangent.abs() < 1.0
            && state.is_ordinary()
            && stays_clear(&lifted, rack, &quick, (tangent, &margins)))
        {
            return None;
        }
        self.work.note(|w| w.closed_form_solves += 1);
        let pose = form.pose(&state);
        let speed = self.demand.is_modest().then(|| {
            let moved = PoseError::between(&from.pose, &pose, self.size);
            let speed = moved.scaled(1.0 / step.abs());
            let fastest = quick.speed.map_or(speed, |before| before.max(speed));
            self.demand.note(fastest.scaled(2.0 * left));
            speed
        });
        Some(Place {
            point: *to,
            pose,
            quick: Some(Quick {
                tangent,
                slope,
                before: Some((start, quick.tangent, quick.slope)),
                speed,
                margins,
            }),
        })
    }

    /// Follows the closure equations from one place to a motion point: in steps of the drive, accepted
    /// only where a second-order prediction was good and the determinant has not changed much; where
    /// that takes many, by the arc length of the path, which passes folds and finds them.
    fn follow(&mut self, from: &Place, to: &MotionPoint<f64>) -> Result<Pose<f64>, Failure> {
        self.lift();
        let lifted = self.lifted.as_ref().expect("just made");
        let start = from.point;
        let between = |t: f64| MotionPoint {
            drive: to.drive,
            value: start.value + (to.value - start.value) * t,
            rack: start.rack + (to.rack - start.rack) * t,
        };
        let (mut reached, mut step, mut pose) = (0.0, 1.0_f64, from.pose);
        let mut lu = self.factorise(&pose, &start);
        while reached < 1.0 {
            let target = if reached + step >= 1.0 {
                1.0
            } else {
                reached + step
            };
            let here = between(reached);
            let direction = MotionPoint {
                drive: to.drive,
                value: Jet([here.value, to.value - start.value, 0.0]),
                rack: Jet([here.rack, to.rack - start.rack, 0.0]),
            };
            let accepted = lu.as_ref().and_then(|lu| {
                self.work.note(|w| w.right_hand_sides += 2);
                let series = lifted.series(self.mechanism, lu, &pose, &direction);
                let predicted = predict(&series, target - reached);
                let point = if target == 1.0 { *to } else { between(target) };
                self.correct(&pose, &predicted, &point, lu.determinant())
            });
            match accepted {
                Some((found, factors)) => {
                    pose = found;
                    lu = Some(factors);
                    reached = target;
                    step *= 2.0;
                }
                None => {
                    step = 0.5 * (target - reached);
                    if step < SHORTEST_STEP {
                        return self.follow_arc(&pose, &here, to);
                    }
                }
            }
        }
        if let Some(factors) = lu {
            self.settled = Some(Settled {
                pose,
                point: *to,
                factors,
            });
        }
        Ok(pose)
    }

    /// Follows the path by its arc length; drive or rack move, not both.
    fn follow_arc(
        &mut self,
        pose: &Pose<f64>,
        from: &MotionPoint<f64>,
        to: &MotionPoint<f64>,
    ) -> Result<Pose<f64>, Failure> {
        let (moving, value, target) = if to.rack != from.rack {
            (Moving::Rack, from.rack, to.rack)
        } else {
            (Moving::Drive, from.value, to.value)
        };
        let curve = self.curve(moving, *to);
        let (limit, cause) = match curve.to(pose, value, target) {
            Ok(found) => return Ok(found.pose()),
            Err(PathEnd::Fold(fold)) => (fold.value(), curve.cause(&fold)),
            Err(PathEnd::Unresolved(limit)) => (limit, LimitCause::Unresolved),
        };
        Err(match moving {
            Moving::Rack => Failure::RackUnreachable { limit, cause },
            Moving::Drive => Failure::Unreachable {
                drive: to.drive,
                limit,
                cause,
            },
        })
    }

    /// Newton's method from a pose that is close already; `None` where it does not settle.
    pub(super) fn polished(&self, pose: &Pose<f64>, point: &MotionPoint<f64>) -> Option<Pose<f64>> {
        let (mut pose, mut last) = (*pose, f64::INFINITY);
        for _ in 0..60 {
            let at = self.posture(&pose, point.rack);
            self.work.note(Work::note_newton);
            let (next, correction, _) = self.closure.newton_step(&at, point.driver(), self.size)?;
            if correction >= last || correction.is_nan() {
                // Corrections that no longer shrink are rounding, amplified by the condition.
                return (last <= 1e-6 * self.size).then_some(pose);
            }
            pose = next;
            pose.rotation = pose.rotation.orthonormalised();
            last = correction;
        }
        None
    }

    /// Whether a pose obeys the closure equations to within their rounding.
    pub(super) fn closes(&self, pose: &Pose<f64>, point: &MotionPoint<f64>) -> bool {
        let at = self.posture(pose, point.rack);
        let residuals = self.closure.residuals(&at, point.driver());
        // Each is formed of a dozen products and sums of lengths within the reach.
        residuals
            .iter()
            .all(|r| r.abs() <= 16.0 * ROUNDING * self.reach)
    }

    /// Newton's method from a predicted pose; `None` if the prediction was poor, the determinant
    /// changed much (or changed sign) or the iteration did not settle.
    fn correct(
        &self,
        before: &Pose<f64>,
        predicted: &Pose<f64>,
        point: &MotionPoint<f64>,
        determinant: f64,
    ) -> Option<(Pose<f64>, Lu6<f64>)> {
        let moved = distance(before, predicted, self.size);
        if moved.is_nan() || moved > LONGEST_TURN * self.size {
            return None;
        }
        let driver: Driver<f64> = point.driver();
        let mut pose = *predicted;
        let mut last = f64::INFINITY;
        for iteration in 0..12 {
            let at = self.posture(&pose, point.rack);
            self.work.note(Work::note_newton);
            let (next, correction, _) = self.closure.newton_step(&at, driver, self.size)?;
            let rounding = ROUNDING * self.reach;
            if iteration == 0 && correction > GOOD_PREDICTION * moved + rounding {
                return None;
            }
            // What a correction leaves shrinks faster than the corrections did.
            let left = correction * (correction / last);
            let left = PoseError {
                length: 2.0 * left,
                angle: left / self.size,
            };
            let modest = iteration > 0 && left.times_in(self.demand.allowed) >= 1.0;
            if modest {
                self.demand.note(left);
            }
            // Rounding level: the corrections no longer shrink.
            if modest
                || correction <= rounding
                || (correction >= 0.5 * last && last <= (1e-9 * self.size).max(100.0 * rounding))
            {
                let settled = Pose {
                    origin: next.origin,
                    rotation: next.rotation.orthonormalised(),
                };
                let lu = self.factorise(&settled, point)?;
                let steady = lu.determinant() / determinant;
                return (steady > 0.25 && steady < 4.0).then_some((settled, lu));
            }
            if correction > last {
                return None;
            }
            pose = next;
            last = correction;
        }
        None
    }

    /// The posture in a pose found by this solver, as a power series along the motion.
    pub fn posture_series<'a, const N: usize>(
        &'a self,
        lifted: &'a Lifted<N>,
        pose: &Pose<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
    ) -> Result<Posture<'a, Jet<f64, N>>, Failure> {
        if let Some(series) = self.formed_series(lifted, pose, motion) {
            return Ok(lifted.at(self.mechanism, series, motion.rack));
        }
        let (posture, _) = self.factorised_series(lifted, pose, motion, false)?;
        Ok(posture)
    }

    /// The posture with the factors of its Jacobian, if there was a need for them; with `linearise` there
    /// is.
    pub(super) fn factorised_series<'a, const N: usize>(
        &'a self,
        lifted: &'a Lifted<N>,
        pose: &Pose<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
        linearise: bool,
    ) -> Result<Factorised<'a, N>, Failure> {
        let known = self.factors_at(pose, &motion.value_point());
        lifted
            .posture(
                self.mechanism,
                &self.closure,
                &self.design,
                pose,
                motion,
                known,
                &self.work,
                linearise,
            )
            .ok_or(Failure::Singular)
    }

    /// The series of a pose that the closed form gave, by the closed form.
    pub(super) fn formed_series<const N: usize>(
        &self,
        lifted: &Lifted<N>,
        pose: &Pose<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
    ) -> Option<Pose<Jet<f64, N>>> {
        if N == 1 || lifted.is_steered() {
            return None;
        }
        let (formed, point, tangent) = self.formed.as_ref()?;
        if formed != pose || *point != motion.value_point() {
            return None;
        }
        self.work.note(|w| {
            w.closed_form_evaluations += 1;
            w.right_hand_sides += N as u64 - 1;
        });
        self.form.as_ref()?.pose_series(*tangent, motion)
    }

    /// A pose found by this solver, the rack at `rack`, ready to be loaded; [`Failure::Singular`] where the
    /// support cannot carry a load.
    pub fn balance(
        &self,
        pose: &Pose<f64>,
        rack: f64,
        support: Support,
    ) -> Result<Balance<'_>, Failure> {
        let at = self.posture(pose, rack);
        Balance::new(&self.closure, at, support, self.size(), &self.work).ok_or(Failure::Singular)
    }

    /// As [`Solver::posture_series`], ready for sensitivities.
    pub fn linearised<'a, const N: usize>(
        &'a self,
        lifted: &'a Lifted<N>,
        pose: &Pose<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
    ) -> Result<Linearised<'a, N>, Failure> {
        let (posture, factors) = self.factorised_series(lifted, pose, motion, true)?;
        let factors = factors.ok_or(Failure::Singular)?;
        Ok(lifted.linearised(posture, factors, motion, &self.work))
    }
}

/// The longest turn of an arm, and the longest move relative to the size, in one step (rad).
const LONGEST_TURN: f64 = 0.2;
/// How far, as a part of the move, a second-order prediction may miss. On a smooth path it misses by the
/// cube of the step; near another assembly by much more.
pub(super) const GOOD_PREDICTION: f64 = 0.01;
/// The shortest step in the drive, as a part of the whole way to the next station. Where it would be
/// shorter the path turns sharply, and is followed by its arc length.
const SHORTEST_STEP: f64 = 1.0 / 16.0;
/// Length of the pieces in which a step of the closed form is looked at, as a tangent of half the angle:
/// longer than the steps of an ordinary study.
const PIECE: f64 = 0.01;
/// How many sizes from the origin the closed form keeps its accuracy.
const FAR: f64 = 1e3;
/// Slope of the half tangent by the travel, in sizes, beyond which a fold is near.
const STEEP: f64 = 50.0;
/// Poses this close together, in sizes, are one; assemblies that are closer are near a toggle, where the
/// closed form is not used.
const SAME: f64 = 1e-9;
/// Corrections this small relative to the size are rounding.
pub(super) const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Whether what may not vanish stays positive on the way from one place to a tangent with its margins:
/// piece by piece, where the way is long.
fn stays_clear(
    form: &ClosedForm<Jet<f64, 2>>,
    rack: Jet<f64, 2>,
    from: &Quick,
    (tangent, margins): (f64, &[Jet<f64, 2>; 2]),
) -> bool {
    let step = tangent - from.tangent;
    let pieces = (step.abs() / PIECE).ceil().max(1.0);
    let mut before = from.margins;
    let mut piece = 1.0;
    while piece < pieces {
        let between = from.tangent + step * (piece / pieces);
        let here = form.at_half_tangent(Jet::variable(between), rack).margins();
        if !keep_clear(&before, &here, step / pieces) {
            return false;
        }
        before = here;
        piece += 1.0;
    }
    keep_clear(&before, margins, step / pieces)
}

/// Whether margins stay positive over a step, by their values and slopes at both ends. One that is
/// convex lies above both tangents, one that is concave above its ends.
fn keep_clear(before: &[Jet<f64, 2>; 2], after: &[Jet<f64, 2>; 2], step: f64) -> bool {
    before.iter().zip(after).all(|(a, b)| {
        let least = 0.25 * a[0].min(b[0]);
        a[0] > 0.0 && b[0] > 0.0 && a[0] + a[1] * step > least && b[0] - b[1] * step > least
    })
}

impl Quick {
    /// The tangent at `end` by the cubic through the last two places and their slopes, or along the
    /// slope where there is only one.
    fn extrapolated(&self, start: f64, end: f64) -> f64 {
        let step = end - start;
        match self.before {
            None => self.tangent + self.slope * step,
            Some((before, tangent, slope)) => {
                let width = start - before;
                let secant = (self.tangent - tangent) / width;
                let bend = (self.slope - secant) / width;
                let twist = (self.slope + slope - 2.0 * secant) / (width * width);
                self.tangent + step * (self.slope + step * (bend + twist * (step + width)))
            }
        }
    }
}

/// The pose a part of the way along its series.
pub(super) fn predict(series: &Pose<Jet<f64, 3>>, step: f64) -> Pose<f64> {
    let along = |c: Jet<f64, 3>| c[0] + step * (c[1] + step * c[2]);
    let pose = series.map(along);
    // The truncated series is a rotation to second order only.
    let rotation = pose.rotation.orthonormalised().orthonormalised();
    Pose {
        origin: pose.origin,
        rotation: rotation.orthonormalised(),
    }
}

/// How far apart two poses are, the rotation counted at the distance `size`.
fn distance(a: &Pose<f64>, b: &Pose<f64>, size: f64) -> f64 {
    let turned = a
        .rotation
        .columns
        .iter()
        .zip(b.rotation.columns)
        .map(|(p, q)| (*p - q).norm())
        .fold(0.0, f64::max);
    (a.origin - b.origin).norm().max(turned * size)
}
