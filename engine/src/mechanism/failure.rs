//! Reasons why there is no pose, or no solvable design.

use crate::model::Rod;
use crate::model::{Axis, Drive, Frame, LengthUnit, Mechanism, PointId};
use std::error::Error;
use std::fmt;

/// Reason why a station has no pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// The drive cannot reach the requested value: the mechanism folds at `limit`, or the solver could not follow it further.
    Unreachable {
        /// Kind of drive.
        drive: Drive,
        /// Value at the end of the path: a length, or an angle in radians.
        limit: f64,
        /// Reason for the end of the path.
        cause: LimitCause,
    },
    /// With the drive at zero, the rack cannot reach the requested displacement. For a rigid axle, the held travel takes the
    /// place of the rack displacement.
    RackUnreachable {
        /// Displacement at the end of the path, towards the kernel's +y.
        limit: f64,
        /// Reason for the end of the path.
        cause: LimitCause,
    },
    /// The solver reached the pose, but its derivatives do not exist there. Or a steering gear makes the design of its axle
    /// singular.
    Singular,
    /// A certificate was requested, but the pose could not be certified.
    Uncertified(Unproven),
    /// The solver reached the pose. But a requested quantity depends on a rocker that is at its toggle in this pose, or has
    /// passed it. Or a knuckle of a steered axle is at or beyond its toggle.
    Toggle(Rod),
    /// The drive of Attia's paper requests the arm's highest or lowest position, or a position beyond it.
    DeadCentre,
    /// The formulation in point coordinates found no pose.
    PointCoordinates(FormulationFailure),
}

/// Reason why a formulation other than the knuckle pose (see [`crate::solve::Formulation`]) has no pose. The field
/// `cause` of a variant is a clause about a part, such as "the strut is horizontal".
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FormulationFailure {
    /// Fewer than half of the digits would be correct in the requested pose.
    Singular {
        /// Part that is singular.
        cause: &'static str,
    },
    /// The solution branch of the design position ends before the drive value.
    DriveEnds {
        /// Kind of drive.
        drive: Drive,
        /// Last drive value that the solver reached on this branch, in the study's convention: a length, or radians.
        value: f64,
        /// Part that is singular at the end of the branch.
        cause: &'static str,
    },
    /// The solution branch of the design position ends before the angle theta of Attia's paper.
    ThetaEnds {
        /// Last angle that the solver reached on this branch, in radians.
        value: f64,
        /// Part that is singular at the end of the branch.
        cause: &'static str,
    },
    /// The solution branch of the design position ends before the requested displacement of the rack.
    RackEnds {
        /// Part that is singular at the end of the branch.
        cause: &'static str,
    },
    /// A number in the input is not finite.
    NotFinite,
}

impl fmt::Display for FormulationFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FormulationFailure::Singular { cause } => write!(f, "singular: {cause}"),
            FormulationFailure::DriveEnds { value, cause, .. }
            | FormulationFailure::ThetaEnds { value, cause } => write!(
                f,
                "unreachable: the motion ends at the drive value {value}: {cause}"
            ),
            FormulationFailure::RackEnds { cause } => write!(
                f,
                "unreachable: the rack ends before this position: {cause}"
            ),
            FormulationFailure::NotFinite => f.write_str("the input is not finite"),
        }
    }
}

/// Reason why a mechanism stops at a fold (see `solve::cause`). Either a part is singular at the fold, or no part is
/// singular and a quantity reaches an extreme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitCause {
    /// The tie rod's ends and the steering axis lie in one plane, so the tie rod no longer holds the wheel's steer angle.
    TieRodToggle,
    /// The upper arm is in line with the steering axis, seen along the axis of the arm, so the knuckle can swing.
    UpperArmStraight,
    /// The strut is perpendicular to the steering axis, so the knuckle can swing.
    StrutSquare,
    /// Some of the links have become dependent on each other. The wheel carrier has an additional degree of freedom.
    DependentLinks,
    /// The links of a rigid axle are at a toggle.
    AxleFolds,
    /// The arms of a twist beam are vertical, or its halves block each other.
    BeamFolds,
    /// No part is singular. The wheel centre is at the highest point of its path.
    CentreHighest,
    /// No part is singular. The wheel centre is at the lowest point of its path.
    CentreLowest,
    /// No part is singular. The arm stops while the wheel moves on.
    ArmStandsStill,
    /// No part is singular. The rack stops while the wheel steers on, with its centre at constant height.
    RackStandsStill,
    /// The path could not be followed: it meets the path of another assembly, or comes so close that rounding cannot
    /// distinguish them. The limit is the last value that was reached.
    Unresolved,
}

impl LimitCause {
    /// Returns true if a part is singular.
    pub fn is_part(self) -> bool {
        matches!(
            self,
            LimitCause::TieRodToggle
                | LimitCause::UpperArmStraight
                | LimitCause::StrutSquare
                | LimitCause::DependentLinks
                | LimitCause::AxleFolds
                | LimitCause::BeamFolds
        )
    }

    /// Describes the event at the limit, without a note on singular parts.
    pub fn words(self) -> &'static str {
        match self {
            LimitCause::TieRodToggle => "the tie rod is at toggle",
            LimitCause::UpperArmStraight => "the upper arm is in line with the steering axis",
            LimitCause::StrutSquare => "the strut is perpendicular to the steering axis",
            LimitCause::DependentLinks => "links are at toggle: their lines are linearly dependent",
            LimitCause::AxleFolds => "the links of the axle are at toggle",
            LimitCause::BeamFolds => {
                "the wheel centres cannot move any further: the arms are vertical, or the halves block each other"
            }
            LimitCause::CentreHighest => "the wheel centre is at its highest point",
            LimitCause::CentreLowest => "the wheel centre is at its lowest point",
            LimitCause::ArmStandsStill => "the arm stops while the wheel moves on",
            LimitCause::RackStandsStill => "the rack stops while the wheel steers on",
            LimitCause::Unresolved => "the path meets another assembly there",
        }
    }
}

impl fmt::Display for LimitCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.words())?;
        if self.is_part() || *self == LimitCause::Unresolved {
            return Ok(());
        }
        f.write_str(", no part is at a singularity")
    }
}

/// Distance of a part from its singular position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartMeasure {
    /// The part, named by the cause of a fold. The fold occurs when the part reaches its singular position.
    pub cause: LimitCause,
    /// Sine of the angle between the part and its singular position; 0 at that position.
    pub sine: f64,
}

/// A toggle of a rocker: the dead centre at which its rod can no longer turn it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toggle {
    /// Last travel at which the rod still has leverage. The toggle is about 1e-10 mechanism sizes beyond it.
    pub travel: f64,
    /// Rod that is in line with its lever: the rod of the rocker, or the rod of another rocker that moves this rocker.
    pub rod: Rod,
}

/// Reason why the proof fails that exactly one exact pose is near a computed pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unproven {
    /// The pose is singular, or singular within double precision.
    Singular,
    /// The residual is too large compared with the distance to the next solution, so the inequality fails.
    TooClose,
    /// The pose is certified. But it is not certified that the pose is on the solution branch of the design position.
    Branch,
}

impl fmt::Display for Unproven {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Unproven::Singular => "the pose is singular in double precision",
            Unproven::TooClose => {
                "another assembly is too close to be distinguished in double precision"
            }
            Unproven::Branch => "the path from the design position could not be certified",
        })
    }
}

/// Reason why a design cannot be solved at all.
#[derive(Clone, Debug, PartialEq)]
pub enum DesignFault {
    /// A coordinate is not a finite number.
    NotFinite(PointId),
    /// The outer joint of an arm lies on the arm's axis.
    ArmWithoutRadius {
        /// Outer joint of the arm.
        outer: PointId,
    },
    /// An end of the tie rod is on the steering axis, so the tie rod cannot steer the wheel.
    NoSteering {
        /// End of the tie rod that lies on the axis.
        end: PointId,
    },
    /// The tie rod lies in the plane through steering axis and rack joint, so the tie rod cannot rotate the knuckle.
    Toggle,
    /// The strut has no length: its mount is at the foot of the perpendicular from the ball joint to the strut axis.
    NoStrutLength,
    /// The upper arm is in line with the steering axis, so the arm does not hold the knuckle.
    UpperArmInLine {
        /// Upper ball joint.
        outer: PointId,
    },
    /// Two points that define a rod, a strut, the axis of an arm or knuckle, or the wheel's spin axis coincide or almost
    /// coincide.
    Coincident {
        /// First point.
        first: PointId,
        /// Second point.
        second: PointId,
    },
    /// The suspension is too large or too small, or its points are too close to each other compared with their distance from
    /// the origin. Double precision cannot distinguish the points.
    OutOfScale,
    /// The drive of Attia's paper is singular in the design position.
    DeadCentre {
        /// Outer joint of the arm.
        outer: PointId,
    },
    /// The formulation in point coordinates cannot describe the design.
    PointCoordinates(FormulationFailure),
    /// The program does not contain the formulation of this name.
    NoFormulation(&'static str),
    /// The constraints are dependent and do not hold the knuckle, or the drive cannot move it.
    Singular,
    /// The elastic parts have no equilibrium in the initial position. The text is the reason.
    Elastic(String),
}

impl DesignFault {
    /// Describes the fault in words, with the names of the points.
    pub fn describe(&self, mechanism: &Mechanism) -> String {
        self.words(|id| mechanism.name(*id).to_owned())
    }

    fn words(&self, name: impl Fn(&PointId) -> String) -> String {
        match self {
            DesignFault::NotFinite(id) => format!("{} is not a finite point", name(id)),
            DesignFault::ArmWithoutRadius { outer } => {
                format!(
                    "{} lies on the axis of its arm, so the arm cannot move it",
                    name(outer)
                )
            }
            DesignFault::NoSteering { end } => format!(
                "{} lies on the steering axis, so the tie rod does not hold the wheel's steer angle",
                name(end)
            ),
            DesignFault::Coincident { first, second } => format!(
                "{} and {} coincide, but the member between them needs a length",
                name(first),
                name(second)
            ),
            DesignFault::OutOfScale => "the points are too far from the origin, or too large or \
                                        small, to be distinguished in double precision"
                .to_owned(),
            DesignFault::Toggle => {
                "the tie rod is at toggle in the design position: its ends lie in one \
                 plane with the steering axis"
                    .to_owned()
            }
            DesignFault::NoStrutLength => {
                "the strut has no length: its mount is at the foot of the perpendicular from the \
                 ball joint to the strut axis"
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
            DesignFault::PointCoordinates(failure) => {
                format!("the design position cannot be solved in point coordinates: {failure}")
            }
            DesignFault::NoFormulation(name) => format!(
                "this program has no formulation = \"{name}\": use \"knuckle_pose\", or call hardpoint_attia::register() \
                 before solving"
            ),
            DesignFault::Singular => {
                "the design position is singular: the drive cannot move the wheel from it"
                    .to_owned()
            }
            DesignFault::Elastic(reason) => reason.clone(),
        }
    }
}

/// Writes the fault with indices of points, from 0, in the order of the mechanism's points. [`DesignFault::describe`] writes
/// names instead.
impl fmt::Display for DesignFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words(|id| format!("point number {}", id.0)))
    }
}

impl Error for DesignFault {}

impl Failure {
    /// Describes the reason in words, with lengths in this unit and the rack in the axes of this frame.
    pub fn describe(&self, unit: LengthUnit, frame: Frame) -> String {
        self.words(Some(unit), frame.sign(Axis::Y))
    }

    fn words(&self, unit: Option<LengthUnit>, rack_sign: f64) -> String {
        let length = |value: f64| match unit {
            Some(unit) => format!("{value:.6} {}", unit.symbol()),
            None => format!("{value:.6}"),
        };
        let travel = |end: f64| format!("the wheel travel ends at {}", length(end));
        let angle = |what: &str, end: f64| {
            let end = end.to_degrees();
            format!("{what} no further than {end:.6} deg")
        };
        match self {
            Failure::Unreachable {
                drive,
                limit,
                cause,
            } => match drive {
                Drive::Travel => format!("{}: {cause}", travel(*limit)),
                Drive::ArmAngle => format!("{}: {cause}", angle("the arm turns", *limit)),
            },
            Failure::RackUnreachable { limit, cause } => {
                let limit = length(rack_sign * limit);
                format!("the rack moves no further than {limit}: {cause}")
            }
            Failure::Singular => "the pose is singular: it has no derivatives".to_owned(),
            Failure::Toggle(rod) => format!(
                "the {rod} is at toggle there, or between there and the design position: it cannot turn {} any further",
                rod.turns()
            ),
            Failure::Uncertified(reason) => format!("the pose is not certified: {reason}"),
            Failure::DeadCentre => {
                "theta takes the arm to its highest or lowest position or beyond, where this drive \
                                    is singular"
                    .to_owned()
            }
            Failure::PointCoordinates(failure) => match failure {
                FormulationFailure::DriveEnds {
                    drive,
                    value,
                    cause,
                } => match drive {
                    Drive::Travel => format!("{}: {cause}", travel(*value)),
                    Drive::ArmAngle => format!("{}: {cause}", angle("the arm turns", *value)),
                },
                FormulationFailure::ThetaEnds { value, cause } => {
                    format!("{}: {cause}", angle("theta gets", *value))
                }
                other => other.to_string(),
            },
        }
    }
}

/// Writes the reason with lengths in the unit of the hardpoints and the rack in the kernel's axes. [`Failure::describe`] uses the
/// unit and axes of a study.
impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words(None, 1.0))
    }
}

impl Error for Failure {}
