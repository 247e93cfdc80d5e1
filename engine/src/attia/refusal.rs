//! Why the paper's equations give no answer.

use thiserror::Error;

/// A way in which the fifteen equations lose rank.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Singular {
    /// Equations (11) to (14) leave out the z-components of the vector products.
    #[error("the strut is horizontal")]
    HorizontalStrut,
    /// Equations (5) to (10) do not hold the points in their plane.
    #[error("the points 5, 6, 7 and 8 of the knuckle lie in one plane")]
    CoplanarKnuckle,
    /// Then 5, 6 and 7 are on one line, and any fourth point is in a plane with them.
    #[error("the ball joint lies on the axis of the strut")]
    BallJointOnStrutAxis,
    /// 6 and 7 do not define the strut's axis.
    #[error("the points 6 and 7 of the strut's axis coincide")]
    StrutPointsCoincide,
    /// Points 4 and 9 do not define the rod's axis.
    #[error("the points 4 and 9 of the strut's rod coincide")]
    RodPointsCoincide,
    /// The strut's axis is perpendicular to the line 4-5.
    #[error("the strut has no length: its top is at the foot of the ball joint")]
    NoStrutLength,
    /// The lower arm has no radius.
    #[error("the ball joint lies on the axis of the lower arm")]
    BallJointOnArmAxis,
    /// The tie rod does not hold the knuckle.
    #[error("tie-rod toggle: the tie rod and the steering axis lie in one plane")]
    TieRodToggle,
    /// The paper's drive at theta = k pi, or beyond what the arm reaches.
    #[error(
        "the lower arm is at its highest or lowest position, where the paper's drive is singular"
    )]
    DeadCentre,
    /// The drive by travel at the end of the travel.
    #[error("the wheel centre is at its highest or lowest position")]
    TravelLimit,
}

/// Why a pose was not found.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum Refusal {
    /// At the pose asked for, fewer than half of the digits would be left.
    #[error("singular: {0}")]
    Singular(Singular),
    /// The branch of the design position ends before the pose asked for.
    #[error("unreachable: the motion ends where the drive is {value}; there, {limit}")]
    Unreachable {
        /// The value of the drive up to which the branch was followed.
        value: f64,
        /// What ends it.
        limit: Singular,
    },
    /// The branch of the design position ends before the rack is where it was asked to be.
    #[error("unreachable: the rack does not get there; where it stops, {limit}")]
    RackUnreachable {
        /// What ends it.
        limit: Singular,
    },
    /// A number in the input is not finite.
    #[error("the input is not finite")]
    NotFinite,
}
