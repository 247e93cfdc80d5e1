//! Solid axles and twist beams: required and refused entries of a study, and differences of the right half.

use super::error::Problems;
use super::file::{self, File};
use super::outputs::hardpoint;
use super::suspension::position;
use super::value::{RightWheel, Text};
use crate::mechanism::DesignFault;
use crate::model::{Drive, Mechanism, RigidAxle, Suspension};
use crate::solve::Solver;
use std::ops::Range as Span;
use toml::Spanned;

/// Refuses entries that a solid axle or a twist beam does not support; true if there are none.
pub(super) fn refuse(file: &File, suspension: &Suspension, problems: &mut Problems) -> bool {
    let mut refused: Vec<(Option<Span<usize>>, &str)> = Vec::new();
    let motions = std::iter::once(&file.motion).chain(file.motions.values());
    for motion in motions.map(Spanned::get_ref) {
        let steered = "this axle has no rack; leave rack and steering_wheel_angle out";
        refused.push((motion.rack.as_ref().map(Spanned::span), steered));
        let wheel = motion.steering_wheel_angle.as_ref();
        refused.push((wheel.map(Spanned::span), steered));
        let travel = motion.travel.as_ref().map(Spanned::span);
        refused.push((
            travel,
            "this axle has two travels; expected heave, roll, or travel_left and travel_right",
        ));
    }
    let outputs = file.outputs.as_ref();
    let certify = outputs.and_then(|o| o.certify.as_ref());
    let is_beam = suspension.mechanism.topology.is_twist_beam();
    let has_watt = suspension.mechanism.point("watt_pivot").is_some();
    let certify = certify.filter(|certify| (is_beam || has_watt) && *certify.get_ref());
    let loads = outputs.and_then(|o| o.loads.as_ref()).filter(|_| is_beam);
    let parts = file.bushings.values().map(Spanned::span);
    let parts = parts.chain(file.links.values().map(Spanned::span));
    let parts = parts.chain(file.compliance.as_ref().map(Spanned::span));
    let parts = parts.filter(|_| is_beam || has_watt);
    refused.extend([
        (
            certify.map(Spanned::span),
            match is_beam {
                true => "certify proves quadratic equations, and the hinge of a twist beam obeys others; leave certify out",
                false => "certify proves quadratic equations, and the rocker of a Watt linkage obeys others; leave certify out",
            },
        ),
        (
            loads.map(Spanned::span),
            "a twist beam bends, so the forces of its mounts do not follow from rigid halves; leave loads out",
        ),
        (
            file.steering.as_ref().map(Spanned::span),
            "steering of this axle is not available yet; leave [steering] out",
        ),
        (
            file.tolerance.as_ref().map(Spanned::span),
            "[tolerance] needs separate derivatives for both halves, and this axle has only those of both together; leave it out",
        ),
        (
            file.setup.as_ref().map(|setup| setup.adjust.span()),
            "[setup] is not available for this axle yet; leave it out",
        ),
    ]);
    refused.extend(parts.map(|span| {
        let message = match is_beam {
            true => "elastic parts are not available for twist beams yet; leave [compliance], [bushings] and [links] out",
            false => "elastic parts are not available with a Watt linkage yet; expected a Panhard rod, or no [compliance], [bushings] and [links]",
        };
        (Some(span), message)
    }));
    let mut sound = is_beam || links(file, suspension, problems);
    for (span, message) in refused {
        if let Some(span) = span {
            problems.add(span, message);
            sound = false;
        }
    }
    sound
}

/// Returns true for two lower links, two upper links and a Panhard rod.
pub(super) fn has_five_links(section: &file::Suspension, mechanism: &Mechanism) -> bool {
    let singles = section.single.as_ref();
    let is_paired = singles.is_none_or(|names| names.get_ref().is_empty());
    is_paired && mechanism.rigid_axle.is_some() && mechanism.point("panhard_axle").is_some()
}

/// Four links hold the axle: two pairs, or a pair of lower links, a single upper link and a Panhard rod or a Watt linkage.
/// Five links need elastic parts.
fn links(file: &File, suspension: &Suspension, problems: &mut Problems) -> bool {
    let section = &file.suspension;
    let has = |name: &str| suspension.mechanism.point(name).is_some();
    let (has_panhard, has_watt) = (has("panhard_axle"), has("watt_pivot"));
    if has_panhard && has_watt {
        let message =
            "a Panhard rod and a Watt linkage both hold the axle sideways: expected one of them";
        return problems
            .refuse::<()>(section.hardpoints.span(), message)
            .is_some();
    }
    let has_lateral = has_panhard || has_watt;
    let single = section.single.as_ref();
    let names = single.map_or(&[][..], |names| names.get_ref());
    for name in names {
        if name.get_ref() != "upper_link" {
            let message = format!(
                "{:?} cannot be single; expected single = [\"upper_link\"]",
                name.get_ref()
            );
            problems.add(name.span(), message);
            return false;
        }
    }
    match (names.is_empty(), has_lateral) {
        (true, false) | (false, true) => true,
        (true, true) if has_panhard && file.compliance.is_some() => true,
        (true, true) => {
            let written = section.hardpoints.get_ref().keys();
            let panhard = written
                .filter(|text| {
                    ["panhard_", "watt_"]
                        .iter()
                        .any(|of| text.get_ref().starts_with(of))
                })
                .map(Text::span)
                .next();
            let place = panhard.unwrap_or(section.hardpoints.span());
            let message = format!(
                "five links: with two upper links and a {} the axle binds in roll, and only the rubber of its joints lets it move",
                if has_watt {
                    "Watt linkage"
                } else {
                    "Panhard rod"
                }
            );
            let error = problems.add(place, message);
            error.help(match has_watt {
                true => "give the upper links as one in the middle (single = [\"upper_link\"] in [suspension]), or leave the Watt linkage out",
                false => "give the links axial_stiffness ([links.upper_link] and the others, with [compliance]), give the upper links as one in \
                          the middle (single = [\"upper_link\"] in [suspension]), or leave the Panhard rod out",
            });
            false
        }
        (false, false) => {
            let message = "three links leave the axle free sideways: expected panhard_chassis and panhard_axle, or a Watt linkage";
            let place = single.map_or(section.hardpoints.span(), Spanned::span);
            problems.add(place, message);
            false
        }
    }
}

/// Axle as seen from its left and from its right wheel. The second is `None` if the axle is its own mirror image.
pub(super) fn wheels(
    file: &File,
    suspension: &Suspension,
    rigid: &RigidAxle,
    problems: &mut Problems,
) -> Option<(Suspension, Option<Suspension>)> {
    let mut left = suspension.clone();
    let written = file.axle.as_ref();
    let written = written.and_then(|section| section.get_ref().right.as_ref());
    let place = written.map_or(file.suspension.hardpoints.span(), Spanned::span);
    match written.map(Spanned::get_ref) {
        None => {}
        Some(RightWheel::Word(word)) if word == "mirrored" => {}
        Some(RightWheel::Word(word)) => {
            let message = format!("unknown right wheel {word:?}; expected \"mirrored\" or a table");
            return problems.refuse(place, message);
        }
        Some(RightWheel::Own(own)) => {
            if !own.bodies.is_empty() || own.wheel.is_some() {
                let message = "the right half of this axle differs in hardpoints and spring only";
                return problems.refuse(place, message);
            }
            differences(own, rigid, &mut left, problems)?;
        }
    }

    let solver = Solver::new(&left.mechanism, &left.design);
    if let Err(fault) = solver.and_then(|solver| solver.check_start(Drive::Travel)) {
        let message = match fault {
            DesignFault::Singular => {
                "the links do not hold the axle in the design position: one motion is left beside heave and roll".to_owned()
            }
            fault => fault.describe(&left.mechanism),
        };
        let error = problems.add(file.suspension.hardpoints.span(), message);
        error.help(
            "links that are parallel from above leave the axle free sideways: splay the upper links, or give a single upper \
             link and a Panhard rod",
        );
        return None;
    }
    let mut right = left.clone();
    rigid.turn_over(&left.design, &mut right.design);
    let is_symmetric = rigid.is_symmetric(&left.design);
    right.frame = left.frame.of_other_side();
    Some((left, (!is_symmetric).then_some(right)))
}

/// Places the points of the right half that are not mirror images.
fn differences(
    own: &file::OwnRight,
    rigid: &RigidAxle,
    left: &mut Suspension,
    problems: &mut Problems,
) -> Option<()> {
    let mut sound = true;
    for (text, coordinates) in &own.hardpoints {
        let id = hardpoint(text, left, problems);
        let position = position(coordinates, problems);
        let (Some(id), Some(position)) = (id, position) else {
            sound = false;
            continue;
        };
        let pair = rigid.pairs.iter().find(|[near, _]| *near == id);
        let Some([_, far]) = pair else {
            let message = format!(
                "the axle has {} once: expected it in [suspension.hardpoints] alone, with its true y",
                text.get_ref()
            );
            problems.add(text.span(), message);
            sound = false;
            continue;
        };
        left.design[far.0] = left.frame.vector(position);
        if left.design[far.0].y > 0.0 {
            let message = format!(
                "{} is on the left side: the right half has its true y",
                text.get_ref()
            );
            problems.add(text.span(), message);
            sound = false;
        }
    }
    sound.then_some(())
}
