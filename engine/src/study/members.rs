//! Finds members and dimensions by their names in a study.

use super::error::Problems;
use super::names::choose;
use super::outputs::hardpoint;
use super::value::{MemberName, Text};
use crate::assembly::{BuildParameter, Member};
use crate::model::{Axis, Suspension};
use crate::number::Each;
use toml::Spanned;

/// A dimension, and a factor. A change of the dimension in the study's axes, times this factor, is the change in the
/// kernel's frame. The kernel's frame has the axes of a left wheel: x forward, y left, z up.
pub(super) type Change = (BuildParameter, f64);

/// Finds the member with this name, or the member between these two points. Returns it with its name.
pub(super) fn member(
    written: &Spanned<MemberName>,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<(String, Member)> {
    let mechanism = &suspension.mechanism;
    if mechanism.topology.is_twist_beam() {
        let message = "a twist beam has no links: expected hardpoints, such as mount, shear_centre, wheel_centre or spindle_inner";
        return problems.refuse(written.span(), message);
    }
    let mut members = Member::all(mechanism);
    // Members of a solid axle are named as in its left half.
    members.retain(|(_, member)| {
        let ends = member.ends(mechanism);
        ends.is_none_or(|(inner, outer)| !mechanism.is_far(inner) || !mechanism.is_far(outer))
    });
    match written.get_ref() {
        MemberName::Name(name) => {
            let options: Vec<_> = members.iter().map(|(n, m)| (n.as_str(), *m)).collect();
            let text = Text::new(written.span(), name.clone());
            let member = choose(&text, "member", &options, problems)?;
            Some((name.clone(), member))
        }
        MemberName::Ends(ends) => {
            let points: Option<Vec<_>> = ends
                .iter()
                .map(|end| hardpoint(end, suspension, problems))
                .collect();
            let points = points?;
            let [a, b] = points.as_slice() else {
                let message = format!("expected the two ends of a member, found {}", points.len());
                return problems.refuse(written.span(), message);
            };
            let found = members.into_iter().find(|(_, member)| {
                let ends = member.ends(mechanism);
                ends == Some((*a, *b)) || ends == Some((*b, *a))
            });
            if found.is_none() {
                let message = format!(
                    "no member runs from {} to {}",
                    mechanism.name(*a),
                    mechanism.name(*b)
                );
                problems.add(written.span(), message);
            }
            found
        }
    }
}

/// Coordinate of a point along an axis of the study.
pub(super) fn coordinate(
    point: &Text,
    axis: &Text,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Change> {
    let id = hardpoint(point, suspension, problems);
    let axis = self::axis(axis, problems)?;
    let parameter = BuildParameter::Coordinate(id?, axis);
    Some((parameter, suspension.frame.sign(axis)))
}

/// Reads an axis of the study.
pub(super) fn axis(text: &Text, problems: &mut Problems) -> Option<Axis> {
    choose(text, "axis", &Axis::ALL.each(|a| (a.name(), a)), problems)
}
