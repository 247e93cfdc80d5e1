//! Distinguishes a mechanism's assemblies, and measures the distance of a position from the singular ones.

use super::drive::{Drive, Driving};
use super::equations::Fixed;
use super::{Moving, Singular};

/// The signs that tell the proper solution from the improper ones at a given position of the arm.
///
/// The first two cannot change along a motion at all. The others do so where they pass zero, which for a
/// driven arm is a singular position. For a given arm the pose is unique once the signs are (the strut's
/// length is a square root, the tie-rod end's distance from the plane 3-4-5 another; the rest is rigid),
/// so with them checked no wrong root can be returned for [`Drive::ArmAngle`], nor for
/// [`Drive::PaperTheta`] with the arm on its side, which the sign of the Jacobian's determinant tells.
/// The drive by travel could pass a strut of no length, as it does pass a tie-rod toggle; there is no such
/// strut, so that is where its branch ends too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Branch {
    /// The knuckle, not its mirror image.
    chirality: bool,
    /// 9 is from 4 the way 6 is from 7.
    rod: bool,
    /// 4 is on its own side of the foot of 5 on the strut's axis.
    strut: bool,
    /// 8 is on its own side of the plane 3-4-5. Not for the drive by travel, which passes the toggle
    /// regularly.
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

/// The products whose signs make up a branch.
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

/// The singularity this position is nearest to, by margins between 0 (singular) and 1.
///
/// `arm_to_travel` is the wheel centre's vertical velocity with the arm driven, in units of d51 times
/// the arm's angular velocity; it only matters to the drive by travel.
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
    // Where several are zero at once, the first is the cause of the others.
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
            // The drive by travel passes a toggle regularly.
            margins[7].1 = 1.0;
            margins[9].1 = arm_to_travel.map_or(1.0, f64::abs);
        }
    }
    // Below the square root of rounding they are all as good as zero.
    let margin = |m: &(Singular, f64)| m.1.max(f64::EPSILON.sqrt());
    let nearest = margins
        .iter()
        .min_by(|a, b| margin(a).total_cmp(&margin(b)));
    nearest.expect("there are margins").0
}

/// |a| / b, zero where that is not a number: unknown points count as singular.
fn ratio(a: f64, b: f64) -> f64 {
    let ratio = a.abs() / b;
    if ratio.is_nan() { 0.0 } else { ratio }
}
