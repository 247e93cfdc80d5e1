//! `[subframe]`: hardpoints on the subframe, and its mounts.

use super::super::error::Problems;
use super::super::file::{self, File};
use super::super::outputs::hardpoint;
use super::super::resolve::each;
use super::super::suspension::position;
use super::bushing::{check_directions, rubber};
use crate::compliance::{Compliance, LinkMember, Subframe, SubframeMount};
use crate::model::{Body, Constraint, PointId, Suspension};
use std::path::Path;
use toml::Spanned;

/// Reads the subframe. `Some(None)` if the study has no subframe, `None` if the subframe has an error.
pub(super) fn subframe(
    file: &File,
    suspension: &Suspension,
    directory: &Path,
    problems: &mut Problems,
) -> Option<Option<Subframe>> {
    let Some(section) = &file.subframe else {
        return Some(None);
    };
    let written = section.get_ref();
    let mechanism = &suspension.mechanism;
    if written.carries.get_ref().is_empty() {
        let message = "the subframe carries no hardpoint and would have no effect: expected the names of hardpoints on it";
        return problems.refuse(written.carries.span(), message);
    }
    let carries = each(written.carries.get_ref(), |text| {
        let id = hardpoint(text, suspension, problems)?;
        if matches!(mechanism.body(id), Body::Chassis | Body::Rack) {
            return Some(id);
        }
        let message = format!(
            "{} is on a moving part of the wheel: expected a hardpoint of the body or the rack",
            text.get_ref()
        );
        problems.refuse(text.span(), &message)
    });
    if written.mounts.is_empty() {
        let message =
            "a subframe needs mounts: give each name with the coordinates of the left-hand mount";
        return problems.refuse(section.span(), message);
    }
    let mounts = each(&written.mounts, |(name, at)| {
        let Some((_, bushing)) = file
            .bushings
            .iter()
            .find(|(known, _)| known.get_ref() == name.get_ref())
        else {
            let message = format!(
                "the mount {} has no [bushings.{}]",
                name.get_ref(),
                name.get_ref()
            );
            return problems.refuse(name.span(), &message);
        };
        if mechanism.point(name.get_ref()).is_some() {
            let message = format!("{} is a hardpoint: expected another name", name.get_ref());
            return problems.refuse(name.span(), &message);
        }
        let at = suspension.frame.vector(position(at, problems)?);
        let found = rubber(name, bushing, suspension, directory, problems)?;
        let mount = SubframeMount {
            name: name.get_ref().clone(),
            at,
            shapes: found.shapes,
            preload: found.preload,
            x_axis: found.x_axis,
            z_axis: found.z_axis,
        };
        check_directions(name, bushing, mount.directions(), "the vertical", problems)?;
        Some(mount)
    });
    let found = Subframe {
        carries: carries?,
        mounts: mounts?,
    };
    check_held(section, &found, suspension, problems)?;
    Some(Some(found))
}

/// Refuses a subframe that carries only one pivot of an arm, a hinge, a rocker or the anti-roll bar. Also refuses a subframe
/// that carries the top of a strut.
fn check_held(
    section: &Spanned<file::Subframe>,
    subframe: &Subframe,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<()> {
    let mechanism = &suspension.mechanism;
    let name = |id: PointId| mechanism.name(id);
    let is_held = |id: PointId| subframe.carries.contains(&id);
    let mut pairs: Vec<[PointId; 2]> = mechanism
        .arms
        .iter()
        .map(|arm| [arm.front, arm.rear])
        .collect();
    pairs.extend(
        mechanism
            .rockers
            .iter()
            .map(|rocker| [rocker.first, rocker.second]),
    );
    for constraint in &mechanism.constraints {
        match *constraint {
            Constraint::Revolute { first, second } => pairs.push([first, second]),
            Constraint::StrutLine { top, .. } if is_held(top) => {
                let message = format!(
                    "{} must stay on the body: the top of a strut on a subframe is not supported",
                    name(top)
                );
                return problems.refuse(section.get_ref().carries.span(), &message);
            }
            _ => {}
        }
    }
    for [first, second] in pairs {
        if is_held(first) != is_held(second) {
            let message = format!(
                "{} and {} belong to one part: list both in `carries`, or neither",
                name(first),
                name(second)
            );
            return problems.refuse(section.get_ref().carries.span(), &message);
        }
    }
    Some(())
}

/// Refuses springs and anti-roll bars between bodies that they must not connect in an elastic axle.
pub(super) fn check_reach(
    section: &Spanned<file::Compliance>,
    subframe: Option<&Subframe>,
    suspension: &Suspension,
    parts: &Compliance,
    has_bar: bool,
    problems: &mut Problems,
) -> Option<()> {
    let mechanism = &suspension.mechanism;
    let is_held = |id: PointId| subframe.is_some_and(|own| own.carries.contains(&id));
    // True if the subframe carries the arm of this point. `None` if the point is not on an arm.
    let under = |id: PointId| match mechanism.body(id) {
        Body::Arm(arm) => Some(is_held(mechanism.arms[arm.0].front)),
        _ => None,
    };
    if let Some(spring) = mechanism.spring {
        let rocker = match mechanism.body(spring.lower) {
            Body::Rocker(id) => Some(mechanism.rocker(id)),
            _ => None,
        };
        let seat = rocker.map_or(spring.lower, |rocker| rocker.outer);
        let of_arm = under(seat);
        if let Some(rocker) = rocker
            && (is_held(rocker.first) != is_held(spring.upper)
                || of_arm.is_some_and(|held| held != is_held(rocker.first)))
        {
            let message = "rocker, spring_upper and the arm under the rod: expected all of them on the subframe, or all on the body";
            return problems.refuse(section.span(), message);
        }
        if is_held(spring.upper) && of_arm == Some(false) {
            let message = "spring_upper is on the subframe and the arm under the spring on the body: expected the arm on the subframe, too";
            return problems.refuse(section.span(), message);
        }
    }
    let Some(bar) = mechanism.anti_roll_bar().filter(|_| has_bar) else {
        return Some(());
    };
    let lever = mechanism.rocker(bar);
    let (mut foot, mut rocker) = (lever.outer, None);
    if let Body::Rocker(id) = mechanism.body(lever.outer) {
        rocker = Some(id);
        foot = mechanism.rocker(id).outer;
    }
    if let Body::StrutRod(_) | Body::Rocker(_) = mechanism.body(foot) {
        let message = "with [compliance] the drop link of the anti-roll bar must be attached to an arm, the wheel carrier, or a rocker that one of these moves";
        return problems.refuse(section.span(), message);
    }
    let stretches = |id| {
        parts
            .links
            .iter()
            .any(|part| part.member == LinkMember::RockerRod(id))
    };
    if rocker.is_some_and(stretches) {
        let message = "a drop link on a rocker whose rod is elastic is not available; leave the \
                       rod out of [links]";
        return problems.refuse(section.span(), message);
    }
    let holders = [
        under(foot),
        rocker.map(|id| is_held(mechanism.rocker(id).first)),
    ];
    let on_subframe = is_held(lever.first);
    if holders
        .into_iter()
        .flatten()
        .any(|held| held != on_subframe)
    {
        let message = "the anti-roll bar and the part under its drop link: expected both on the subframe, or both on the body";
        return problems.refuse(section.span(), message);
    }
    Some(())
}
