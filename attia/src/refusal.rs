//! Reasons why the paper's equations give no answer.

use std::fmt;
use thiserror::Error;

/// Reason why the fifteen equations lose rank.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Singular {
    /// The strut's axis is horizontal. Equations (11) to (14) then fail, because they leave out the z-components of the vector
    /// products.
    HorizontalStrut,
    /// Knuckle points 5 to 8 lie in one plane. Equations (5) to (10) then do not hold the points in this plane.
    CoplanarKnuckle,
    /// Point 5 lies on the strut's axis. Then points 5, 6 and 7 are on one line, and every fourth point lies in one plane with
    /// them.
    BallJointOnStrutAxis,
    /// Points 6 and 7 coincide, so they do not define the strut's axis.
    StrutPointsCoincide,
    /// Points 4 and 9 coincide, so they do not define the rod's axis.
    RodPointsCoincide,
    /// The strut's axis is perpendicular to the line 4-5.
    NoStrutLength,
    /// The ball joint lies on the lower arm's axis, so the arm has no radius.
    BallJointOnArmAxis,
    /// The tie rod is in a toggle position and does not hold the knuckle.
    TieRodToggle,
    /// The paper's drive is at theta = k pi, or beyond the reach of the arm.
    DeadCentre,
    /// The drive is the wheel travel, and the wheel is at the end of its travel.
    TravelLimit,
}

impl Singular {
    /// The reason in words.
    pub fn words(self) -> &'static str {
        match self {
            Singular::HorizontalStrut => "the strut is horizontal",
            Singular::CoplanarKnuckle => {
                "lower_ball_joint, tie_rod_outer and the strut axis lie in one plane"
            }
            Singular::BallJointOnStrutAxis => "the ball joint lies on the axis of the strut",
            Singular::StrutPointsCoincide => "the two points that define the strut axis coincide",
            Singular::RodPointsCoincide => {
                "strut_top and the second point of the strut's rod coincide"
            }
            Singular::NoStrutLength => {
                "the strut has no length: strut_top is at the foot of the perpendicular from the \
                 ball joint to the strut axis"
            }
            Singular::BallJointOnArmAxis => "the ball joint lies on the axis of the lower arm",
            Singular::TieRodToggle => {
                "tie-rod toggle: the tie rod and the steering axis lie in one plane"
            }
            Singular::DeadCentre => {
                "the lower arm is at its highest or lowest position, where the drive \"paper_theta\" is singular"
            }
            Singular::TravelLimit => "the wheel centre is at its highest or lowest position",
        }
    }
}

impl fmt::Display for Singular {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.words())
    }
}

impl std::error::Error for Singular {}

/// Reason why no pose was found.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum Refusal {
    /// The requested pose is so near to a singular position that fewer than half of the digits would be correct.
    #[error("singular: {0}")]
    Singular(Singular),
    /// The solution branch of the design position ends before the requested pose.
    #[error("unreachable: the motion ends at the drive value {value}: {limit}")]
    Unreachable {
        /// Value of the drive up to which the branch was followed.
        value: f64,
        /// Singularity that ends the branch.
        limit: Singular,
    },
    /// The solution branch of the design position ends before the rack reaches the requested displacement.
    #[error("unreachable: the rack ends before this position: {limit}")]
    RackUnreachable {
        /// Singularity that stops the rack.
        limit: Singular,
    },
    /// An input number is not finite.
    #[error("the input is not finite")]
    NotFinite,
}
