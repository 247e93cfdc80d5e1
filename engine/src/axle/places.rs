//! Coordinates of an axle's stations, and bounds of certificates, as they are printed.

use super::certificate::AxleProof;
use super::solver::{AxlePose, Placement};
use super::{Axle, AxleMotion, AxlePlan, WheelMotion};
use crate::ask::degrees;
use crate::curves::{MotionColumn, Proof};
use crate::model::Axis;
use crate::number::Each;

/// Returns the columns for the coordinates of a motion: roll, heave, both travels, rack, steering wheel and time. In
/// roll, the travels are results. If travels are given, the roll angle is a result.
pub(super) fn motion_columns(motion: &AxleMotion, axle: &Axle) -> Vec<MotionColumn> {
    let length = axle.left.length_unit.symbol();
    let given = MotionColumn::given;
    let follows = |key, unit| MotionColumn {
        is_given: false,
        ..given(key, unit)
    };
    let mut columns = Vec::new();
    match &motion.wheels {
        WheelMotion::Heave(_) => columns.push(given("heave", length)),
        WheelMotion::Roll { .. } => {
            columns.extend([given("roll", "deg"), given("heave", length)]);
        }
        WheelMotion::Travels { on_plane, .. } => {
            columns.extend(on_plane.then(|| follows("roll", "deg")));
        }
    }
    let travels = ["travel_left", "travel_right"];
    columns.extend(travels.map(|key| match motion.wheels {
        WheelMotion::Travels { .. } => given(key, length),
        _ => follows(key, length),
    }));
    let steers = motion.steering_wheel.is_some();
    columns.push(MotionColumn {
        is_given: !steers,
        is_written: motion.shows_rack,
        ..given("rack", length)
    });
    columns.extend(steers.then(|| given("steering_wheel_angle", "deg")));
    columns.extend(motion.time.is_some().then(|| follows("time", "s")));
    columns
}

/// Returns the values of these coordinates at the station with this index and placement. `placed` is the pose, if the
/// station has a pose.
pub(super) fn place(
    motion: &AxleMotion,
    axle: &Axle,
    (number, placement): (usize, &Placement),
    placed: Option<&AxlePose>,
) -> Vec<Option<f64>> {
    let (roll, heave, travels) = match *placement {
        Placement::Roll { heave, roll, .. } | Placement::AtLoad { heave, roll, .. } => {
            (Some(roll), heave, None)
        }
        Placement::Travels { travels, .. } => (None, travels[0], Some(travels)),
    };
    let roll = roll.or(placed.map(|p| p.roll)).map(degrees);
    let travels = placed.map(|p| p.travels).or(travels);
    let mut at = Vec::new();
    at.extend(motion.shows_roll().then_some(roll));
    at.extend(motion.shows_heave().then_some(Some(heave)));
    at.extend([0, 1].each(|side| travels.map(|t| t[side])));
    at.push(Some(placement.rack() * axle.left.frame.sign(Axis::Y) + 0.0));
    let angle = motion.steering_wheel_at(number);
    at.extend(angle.map(|angle| Some(degrees(angle))));
    let time = motion.time.as_ref();
    at.extend(time.map(|time| Some(time.law.times[motion.time_at(number)])));
    at
}

/// Returns two flags. The first is true if the travels are results. The second is true if the roll angle is a result.
fn follows(plan: &AxlePlan) -> [bool; 2] {
    let rolls = matches!(plan.motion.wheels, WheelMotion::Roll { .. });
    [rolls, plan.motion.shows_roll() && !rolls]
}

/// Returns the names of the certified bounds. Empty unless the plan requests certificates.
pub(super) fn bounds(plan: &AxlePlan, axle: &Axle) -> Vec<String> {
    if !plan.certify {
        return Vec::new();
    }
    let unit = axle.left.length_unit.symbol();
    let [travels, roll] = follows(plan);
    let errors = ["left", "right"].map(|side| format!("{side}_position_error_{unit}"));
    let mut names = errors.to_vec();
    names.extend(travels.then(|| format!("travel_error_{unit}")));
    names.extend(roll.then(|| "roll_error_deg".to_owned()));
    names.push(format!("uniqueness_{unit}"));
    names
}

/// Returns the certificate of a station. The bounds are in the order of [`bounds`].
pub(super) fn proof(plan: &AxlePlan, proved: &AxleProof) -> Proof {
    let [travels, roll] = follows(plan);
    let [left, right] = proved.position_errors;
    let mut bounds = vec![left, right];
    bounds.extend(travels.then_some(proved.travel_error));
    // The factor covers the rounding error of the conversion to degrees.
    bounds.extend(roll.then(|| proved.roll_error.to_degrees() * (1.0 + 1e-12)));
    bounds.push(proved.uniqueness);
    Proof {
        position_error: left.max(right),
        uniqueness: proved.uniqueness,
        bounds,
    }
}
