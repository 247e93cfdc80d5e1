//! Constraints on angles of joints, and on plunges (changes of a length along the motion).

use super::super::Limited;
use super::super::error::Problems;
use super::super::file::{Coordinates, File};
use super::super::names::choose;
use super::super::subject::{length, point};
use super::super::suspension::three;
use super::super::value::{MemberName, Text};
use super::{LIMITS, Reader, words};
use crate::characteristics::{Measure, Stud};
use crate::model::{Body, Constraint as Holds, Mechanism, PointId, SteeringAxis, Suspension};
use crate::number::{Each, Vector3};
use toml::Spanned;

/// Names of the extra points at the joints of a drive shaft.
const SHAFT: [&str; 2] = ["drive_shaft_inner", "drive_shaft_outer"];

impl Reader<'_> {
    pub(super) fn articulation(
        &self,
        name: &Text,
        problems: &mut Problems,
    ) -> Option<(String, Vec<Limited>)> {
        self.takes(&["at_most"], problems);
        let Some(most) = &self.written.at_most else {
            let message = "articulation needs at_most: the largest angle, in degrees";
            return problems.refuse(self.place.clone(), message);
        };
        if !(most.value > 0.0 && most.value < 90.0) {
            let message = format!("expected an angle between 0 and 90, found {}", most.value);
            return problems.refuse(most.span.clone(), message);
        }
        let angle = most.value.to_radians();
        let degree = 1.0_f64.to_radians();
        let of = joint_angle(name, self.context.file, self.suspension(), problems)?;
        // The versine 1 - cos a = 2 sin^2(a/2) is smooth at a = 0, where the angle itself has a kink. With this scale, the
        // constraint's value changes by 1 per degree at the limit, so that Lagrange multipliers are per degree. Elsewhere
        // `Limited::margin` converts to degrees.
        let (lower, upper, scale) = if of.is_versine() {
            let most = 2.0 * (0.5 * angle).sin().powi(2);
            (None, Some(most), angle.sin() * degree)
        } else {
            (Some(-angle), Some(angle), degree)
        };
        let part = Limited {
            of,
            lower,
            upper,
            scale,
            visible: 1.0,
            unit: "deg".to_owned(),
        };
        let title = format!(
            "articulation of {} at most {} deg",
            name.get_ref(),
            most.value
        );
        Some((title, vec![part]))
    }

    /// Constraint on the plunge: the change of a length along the motion.
    pub(super) fn plunge(
        &self,
        written: &Spanned<MemberName>,
        problems: &mut Problems,
    ) -> Option<(String, Vec<Limited>)> {
        self.takes(&LIMITS, problems);
        let (name, ends) = length(written, self.suspension(), problems)?;
        let limits = self.needed_limits(problems)?;
        let [lower, upper] = limits;
        // The plunge is zero in the design position, so limits that exclude zero are refused.
        if lower.is_some_and(|low| low > 0.0) || upper.is_some_and(|high| high < 0.0) {
            let message = "a plunge is measured from the design position; expected limits with 0 \
                           between them";
            return problems.refuse(self.place.clone(), message);
        }
        let of = self.limited(Measure::Plunge(ends), lower, upper);
        Some((format!("plunge of {name} {}", words(limits)), vec![of]))
    }
}

/// Measure of a joint's angle. The joint connects the wheel carrier with an arm or a rod, or belongs to a drive shaft.
pub(crate) fn joint_angle(
    name: &Text,
    file: &File,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Measure> {
    let mechanism = &suspension.mechanism;
    let joint = point(name, suspension, problems)?;
    if let Some(of) = shaft_joint(name, joint, mechanism, problems)? {
        return Some(of);
    }
    let stud = stud(name, joint, file, suspension, problems)?;
    match Housing::of(joint, mechanism) {
        Some(Housing::Arm(axis)) => Some(Measure::BallJoint { joint, axis, stud }),
        Some(Housing::Rod(other)) => Some(Measure::RodEnd {
            rod: [joint, other],
            stud,
        }),
        None => {
            let message = format!(
                "{} is not a joint of the wheel carrier with an arm or a rod",
                name.get_ref()
            );
            problems.refuse(name.span(), message)
        }
    }
}

/// Part that has the housing of a joint of the wheel carrier.
enum Housing {
    /// An arm, with its two pivots.
    Arm([PointId; 2]),
    /// A rod, with the end that is not at the joint.
    Rod(PointId),
}

impl Housing {
    /// Part with the housing of the joint at a point. `None` if the point is not a joint of the wheel carrier with an arm
    /// or a rod.
    fn of(joint: PointId, mechanism: &Mechanism) -> Option<Self> {
        let arm = mechanism.arms.iter().find(|arm| arm.outer == joint);
        let rod = mechanism.constraints.iter().find_map(|c| match *c {
            Holds::Link { inner, outer } if outer == joint => Some(inner),
            _ => None,
        });
        match (arm, rod) {
            (Some(arm), _) if mechanism.body(joint) == Body::Knuckle => {
                Some(Housing::Arm([arm.front, arm.rear]))
            }
            (None, Some(other)) => Some(Housing::Rod(other)),
            _ => None,
        }
    }
}

/// Checks the names and directions of `[suspension.studs]`, including studs that no output or constraint uses.
pub(crate) fn check_studs(file: &File, suspension: &Suspension, problems: &mut Problems) {
    let mechanism = &suspension.mechanism;
    let joints: Vec<(&str, ())> = (0..mechanism.points.len())
        .map(PointId)
        .filter(|point| Housing::of(*point, mechanism).is_some())
        .map(|point| (mechanism.name(point), ()))
        .collect();
    for (name, direction) in &file.suspension.studs {
        choose(name, "joint of the wheel carrier", &joints, problems);
        if three(direction, "coordinates", problems).is_some()
            && stud_direction(direction, suspension).is_none()
        {
            problems.add(direction.span(), "expected a direction other than 0");
        }
    }
}

/// Direction of a stud in the kernel's frame (x forward, y left, z up), with length 1. `None` for a direction that
/// [`check_studs`] refuses.
fn stud_direction(written: &Coordinates, suspension: &Suspension) -> Option<Vector3<f64>> {
    let [x, y, z] = written.get_ref().as_slice() else {
        return None;
    };
    let along = suspension
        .frame
        .vector(Vector3::new(x.value, y.value, z.value));
    (along.norm() > 0.0).then(|| along * (1.0 / along.norm()))
}

/// Joints whose angle can have a limit: joints of the wheel carrier with an arm or a rod, and both joints of a drive shaft.
/// Joints of a solid axle's far half (the half of the other wheel) are excluded.
pub fn named_joints(suspension: &Suspension) -> Vec<PointId> {
    let mechanism = &suspension.mechanism;
    let points = (0..mechanism.points.len()).map(PointId);
    let points = points.filter(|point| !mechanism.is_far(*point));
    let shaft = SHAFT.each(|end| mechanism.point(end));
    let is_of_shaft = |point| shaft.iter().all(Option::is_some) && shaft.contains(&Some(point));
    points
        .filter(|point| is_of_shaft(*point) || Housing::of(*point, mechanism).is_some())
        .collect()
}

/// Returns the joint of a drive shaft with this name. `Some(None)` if the name belongs to another joint, `None` if there is an
/// error.
fn shaft_joint(
    name: &Text,
    joint: PointId,
    mechanism: &Mechanism,
    problems: &mut Problems,
) -> Option<Option<Measure>> {
    let (of, body, expected): (fn([PointId; 2]) -> Measure, _, _) = match &**name.get_ref() {
        "drive_shaft_outer" => (Measure::OuterShaftJoint, Body::Knuckle, "wheel carrier"),
        "drive_shaft_inner" => (Measure::InnerShaftJoint, Body::Chassis, "chassis"),
        _ => return Some(None),
    };
    if mechanism.body(joint) != body {
        let message = format!("{} must be a point of the {expected}", name.get_ref());
        return problems.refuse(name.span(), message);
    }
    let ends = SHAFT.each(|end| mechanism.point(end));
    let [Some(inner), Some(outer)] = ends else {
        let message = "a drive shaft has two ends: expected the extra points drive_shaft_inner and \
                       drive_shaft_outer";
        return problems.refuse(name.span(), message);
    };
    Some(Some(of([inner, outer])))
}

/// Stud of a joint, fixed in the wheel carrier. `[suspension.studs]` gives the direction of the stud in the design position.
/// Without this entry, the stud has the direction of the steering axis.
fn stud(
    name: &Text,
    joint: PointId,
    file: &File,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Stud> {
    let mechanism = &suspension.mechanism;
    let studs = &file.suspension.studs;
    let given = studs
        .iter()
        .find(|(key, _)| key.get_ref() == name.get_ref());
    if let Some((_, direction)) = given {
        return stud_direction(direction, suspension).map(Stud::Along);
    }
    match mechanism.steering_axis {
        Some(SteeringAxis::Through { lower, upper }) => Some(Stud::Between(lower, upper)),
        _ => {
            let message = format!(
                "the direction of the stud of {} is not known: {} has no steering axis through \
                 two joints",
                mechanism.name(joint),
                mechanism.topology.name
            );
            let error = problems.add(name.span(), message);
            error.help(format!(
                "give it in [suspension.studs], for example {} = [0.0, 0.0, 1.0]",
                mechanism.name(joint)
            ));
            None
        }
    }
}
