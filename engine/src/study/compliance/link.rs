//! `[links.NAME]`: elastic members.

use super::super::error::Problems;
use super::super::file::{self, File};
use super::super::names::nearest;
use super::super::suspension::above_zero;
use super::super::value::Text;
use crate::compliance::{AxialStiffness, Compliance, LinkMember, LinkPart, link_members};
use crate::model::{Constraint, PointId, Suspension};
use toml::Spanned;

/// Reads a link with its name.
pub(super) fn link(
    name: &Text,
    written: &Spanned<file::LinkStiffness>,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<(String, LinkPart)> {
    let members = link_members(&suspension.mechanism);
    let found = members.iter().find(|(known, _)| known == name.get_ref());
    let Some((known, member)) = found else {
        let message = format!("{:?} is not a link", name.get_ref());
        let error = problems.add(name.span(), message);
        let names = || members.iter().map(|(name, _)| name.as_str());
        match nearest(name.get_ref(), names()) {
            Some(near) => error.help(format!("did you mean \"{near}\"?")),
            None => error.help(format!(
                "links are {}",
                names().collect::<Vec<_>>().join(", ")
            )),
        };
        return None;
    };
    let part = written.get_ref();
    let stiffness = match (&part.axial_stiffness, &part.modulus, &part.area) {
        (Some(rate), None, None) => AxialStiffness::Rate(above_zero(rate, problems)?),
        (None, Some(modulus), Some(area)) => {
            let (modulus, area) = (above_zero(modulus, problems), above_zero(area, problems));
            AxialStiffness::PerStrain(modulus? * area?)
        }
        (rate, modulus, area) => {
            let both = rate.is_some() && (modulus.is_some() || area.is_some());
            let message = if both {
                "expected either axial_stiffness, or modulus and area; found both"
            } else {
                "expected axial_stiffness, or modulus and area"
            };
            return problems.refuse(written.span(), message);
        }
    };
    let part = LinkPart {
        member: *member,
        stiffness,
        preload: part.preload.as_ref().map_or(0.0, |tension| tension.value),
    };
    Some((known.clone(), part))
}

/// Refuses members with two elastic entries, and arms with only one elastic leg (member from a pivot to the outer joint).
pub(super) fn check_members(
    file: &File,
    suspension: &Suspension,
    parts: &Compliance,
    problems: &mut Problems,
) -> Option<()> {
    let mechanism = &suspension.mechanism;
    let stretches = |inner: PointId, outer: PointId| {
        let member = LinkMember::Rod { inner, outer };
        parts.links.iter().any(|part| part.member == member)
    };
    let place = |name: &str| {
        let written = file.links.iter().find(|(known, _)| known.get_ref() == name);
        written.map_or(0..0, |(known, _)| known.span())
    };
    for constraint in &mechanism.constraints {
        let Constraint::Link { inner, outer } = *constraint else {
            continue;
        };
        if !stretches(inner, outer) {
            continue;
        }
        let name = mechanism.link_name(inner);
        let arm = mechanism.arms.iter().find(|arm| arm.outer == outer);
        let ends = match arm {
            Some(arm) => [arm.front, arm.rear],
            None => [inner, outer],
        };
        if let Some(end) = ends.into_iter().find(|id| parts.bushing_at(*id).is_some()) {
            let message = format!(
                "{name} has axial stiffness, and a bushing at {}: expected one of them",
                mechanism.name(end)
            );
            return problems.refuse(place(name), &message);
        }
        if let Some(arm) = arm
            && let Some(other) = ends.into_iter().find(|id| !stretches(*id, arm.outer))
        {
            let message = format!(
                "one leg of an arm is elastic and the other is not: expected [links.{}] too, or \
                 bushings",
                mechanism.name(other)
            );
            return problems.refuse(place(name), &message);
        }
    }
    Some(())
}
