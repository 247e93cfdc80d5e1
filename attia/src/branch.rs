//! Distinguishes the assemblies of a mechanism, and measures how far a position is from singular positions. Points have the numbers
//! of Attia's paper, as in the table of this crate's first page.

use super::drive::{Drive, Driving};
use super::equations::Fixed;
use super::{Moving, Singular};

/// Signs that distinguish the proper solution from the improper ones at a given position of the arm.
///
/// The first two signs cannot change along a motion. Each of the other two changes where its volume passes zero (see
/// `Volumes`). If the arm is driven, such a position is singular. At a given position of the arm, the four signs make the pose
/// unique. Only two square roots have a choice of sign: the strut's length, and the distance of the tie-rod end from the plane
/// 3-4-5. All other points follow rigidly.
///
/// So a check of these signs excludes wrong roots for [`Drive::ArmAngle`]. For [`Drive::PaperTheta`] the check also needs the
/// side of the arm. The sign of the Jacobian's determinant distinguishes the two sides. The drive with the wheel travel could
/// pass through a strut of zero length, as it passes through a tie-rod toggle. No real strut has zero length, so the branch
/// ends at this length, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Branch {
    /// Handedness of the knuckle. The mirror image of the knuckle has the other sign.
    chirality: bool,
    /// True if the direction from point 9 to point 4 agrees with the direction from point 6 to point 7.
    rod: bool,
    /// True if point 4 (strut top) is on the positive side of the foot of point 5 (ball joint) on the strut's axis.
    strut: bool,
    /// True if point 8 (tie-rod end) is on the positive side of the plane 3-4-5. `None` for the drive with the wheel travel: this
    /// drive is not singular at a tie-rod toggle, so the side may change.
    tie_rod: Option<bool>,
}

impl Branch {
    pub(crate) fn of(drive: Drive, fixed: &Fixed, moving: &Moving) -> Self {
        let v = Volumes::of(fixed, moving);
        Branch {
            chirality: v.knuckle > 0.0,
            rod: v.rod > 0.0,
            strut: v.strut > 0.0,
            tie_rod: (drive != Drive::Travel).then_some(v.tie_rod > 0.0),
        }
    }
}

/// Triple and scalar products of points whose signs identify a branch.
struct Volumes {
    knuckle: f64,
    rod: f64,
    strut: f64,
    tie_rod: f64,
}

impl Volumes {
    fn of(fixed: &Fixed, moving: &Moving) -> Self {
        let [_, _, p3, p4] = fixed.0;
        let [p5, p6, p7, p8, p9] = *moving;
        let axis = p7 - p6;
        Volumes {
            knuckle: axis.cross(p6 - p5).dot(p8 - p5),
            rod: axis.dot(p4 - p9),
            strut: axis.dot(p4 - p5),
            tie_rod: (p4 - p5).cross(p3 - p5).dot(p8 - p5),
        }
    }
}

/// Returns the nearest singularity of this position. Each singularity has a margin between 0 (singular) and 1.
///
/// `arm_to_travel` is the wheel centre's vertical velocity while the arm is driven, in units of d51 times the arm's angular
/// velocity. Only the drive with the wheel travel uses `arm_to_travel`.
pub(crate) fn nearest_singularity(
    driving: &Driving,
    fixed: &Fixed,
    moving: &Moving,
    arm_to_travel: Option<f64>,
) -> Singular {
    let [_, _, p3, p4] = fixed.0;
    let [p5, p6, p7, p8, p9] = *moving;
    let (axis, steering, tie_rod_arm) = (p7 - p6, p4 - p5, p8 - p5);
    let offset = axis.cross(steering).norm();
    let size = steering.norm();
    let v = Volumes::of(fixed, moving);
    let toggle = steering.cross(p3 - p5).norm() * tie_rod_arm.norm();
    // If several margins are zero at once, the first one in this list is the cause of the others.
    let mut margins = [
        (Singular::BallJointOnArmAxis, driving.arm_share()),
        (Singular::StrutPointsCoincide, ratio(axis.norm(), size)),
        (Singular::RodPointsCoincide, ratio((p9 - p4).norm(), size)),
        (Singular::HorizontalStrut, ratio(axis.z, axis.norm())),
        (Singular::NoStrutLength, ratio(v.strut, axis.norm() * size)),
        (
            Singular::BallJointOnStrutAxis,
            ratio(offset, axis.norm() * size),
        ),
        (
            Singular::CoplanarKnuckle,
            ratio(v.knuckle, offset * tie_rod_arm.norm()),
        ),
        (Singular::TieRodToggle, ratio(v.tie_rod, toggle)),
        (Singular::DeadCentre, 1.0),
        (Singular::TravelLimit, 1.0),
    ];
    match driving.kind() {
        Drive::ArmAngle => {}
        Drive::PaperTheta => margins[8].1 = driving.arm_sine(moving).abs(),
        Drive::Travel => {
            // The drive with the wheel travel is not singular at a tie-rod toggle.
            margins[7].1 = 1.0;
            margins[9].1 = arm_to_travel.map_or(1.0, f64::abs);
        }
    }
    // Margins below the square root of the rounding unit count as equal, so the order of the list decides between them.
    let margin = |m: &(Singular, f64)| m.1.max(f64::EPSILON.sqrt());
    let nearest = margins
        .iter()
        .min_by(|a, b| margin(a).total_cmp(&margin(b)));
    nearest.expect("there is at least one margin").0
}

/// Quotient |a| / b. Returns zero if the quotient is not a number, so that unknown points count as singular.
fn ratio(a: f64, b: f64) -> f64 {
    let ratio = a.abs() / b;
    if ratio.is_nan() { 0.0 } else { ratio }
}
