//! Solid axles and twist beams: required and refused keys of a study, and points of the right half that are not mirror images.

use super::error::Problems;
use super::file::{self, File};
use super::outputs::hardpoint;
use super::suspension::{position, three};
use super::value::{RightWheel, Text};
use crate::mechanism::DesignFault;
use crate::model::{Axis, Drive, Frame, Mechanism, RigidAxle, Suspension};
use crate::solve::Solver;
use std::ops::Range as Span;
use toml::Spanned;

/// Sets the direction in which the steering gear moves the drag link.
pub(super) fn steer(
    file: &File,
    frame: Frame,
    mechanism: &mut Mechanism,
    problems: &mut Problems,
) -> Option<()> {
    let written = file.steering.as_ref().map(Spanned::get_ref);
    let Some(written) = written.and_then(|steering| steering.direction.as_ref()) else {
        return Some(());
    };
    let rigid = mechanism.rigid_axle.as_mut();
    let Some(steering) = rigid.and_then(|rigid| rigid.steering.as_mut()) else {
        let message = "the key \"direction\" is for the drag link of a solid axle, but this study has no drag link";
        return problems.refuse(written.span(), message);
    };
    let direction = three(written, "components [x, y, z]", problems)?;
    let length = direction.norm();
    if length == 0.0 || !length.is_finite() {
        let message = "the direction of the drag link has length 0";
        return problems.refuse(written.span(), message);
    }
    // A displacement is positive along the study's y axis, which may point opposite to the kernel's y axis (to the left).
    let along = frame.sign(Axis::Y) / length;
    steering.direction = frame.vector(direction) * along;
    Some(())
}

/// Keys and sections that a solid axle or a twist beam does not support: the position of each in the file, and the reason. The
/// position is `None` if the study does not contain the key.
type Refused<'a> = Vec<(Option<Span<usize>>, &'a str)>;

/// Keys of motions and of `[steering]` that this axle does not support, because it has a drag link or because it has none.
fn refused_steering(file: &File, mechanism: &Mechanism) -> Refused<'static> {
    let is_steered = mechanism.axle_steering().is_some();
    let motions = std::iter::once(&file.motion).chain(file.motions.values());
    let motions = motions.map(Spanned::get_ref);
    let mut refused: Refused = Vec::new();
    for motion in motions {
        let rack = motion.rack.as_ref().map(Spanned::span);
        let wheel = motion.steering_wheel_angle.as_ref().map(Spanned::span);
        if is_steered {
            refused.push((
            wheel,
            "a drag link steers this axle, and no ratio relates the drag link to a steering wheel; expected the key \"rack\": the displacement of the drag link's end",
        ))
        } else {
            let steered = "this axle has no rack and no drag link; remove the keys \"rack\" and \"steering_wheel_angle\"";
            refused.extend([(rack, steered), (wheel, steered)]);
        }
    }
    let Some(section) = &file.steering else {
        return refused;
    };
    let own = section.get_ref();
    if !is_steered {
        let message = if mechanism.topology.is_twist_beam() {
            "a twist beam is not steered; leave [steering] out"
        } else {
            "[steering] of a solid axle needs its drag link: drag_link_body, drag_link_knuckle, kingpin_upper, kingpin_lower and tie_rod_end"
        };
        refused.push((Some(section.span()), message));
        return refused;
    }
    for written in [&own.c_factor, &own.rack_stiffness, &own.column_stiffness] {
        let message = "a drag link steers this axle, and it has no rack; expected only the key \"direction\" in [steering]";
        refused.push((written.as_ref().map(|number| number.span.clone()), message));
    }
    refused
}

/// Refuses keys and sections that a solid axle or a twist beam does not support, and links that do not hold the axle. Returns
/// true if it refuses nothing.
pub(super) fn refuse(file: &File, suspension: &Suspension, problems: &mut Problems) -> bool {
    let is_steered = suspension.mechanism.axle_steering().is_some();
    let mut refused = refused_steering(file, &suspension.mechanism);
    let motions = std::iter::once(&file.motion).chain(file.motions.values());
    for motion in motions.map(Spanned::get_ref) {
        let travel = motion.travel.as_ref().map(Spanned::span);
        refused.push((
            travel,
            "this axle has two travels; expected heave, roll, or travel_left and travel_right",
        ));
    }
    let outputs = file.outputs.as_ref();
    let certify = outputs.and_then(|o| o.certify.as_ref());
    let is_beam = suspension.mechanism.topology.is_twist_beam();
    let has_watt = suspension.mechanism.has_watt_linkage();
    let is_quadratic = !is_beam && !has_watt && !is_steered;
    let certify = certify.filter(|certify| !is_quadratic && *certify.get_ref());
    let parts = file.bushings.values().map(Spanned::span);
    let parts = parts.chain(file.links.values().map(Spanned::span));
    let parts = parts.chain(file.compliance.as_ref().map(Spanned::span));
    refused.extend([(
        certify.map(Spanned::span),
        match is_beam {
            true => {
                "certify needs quadratic equations, and those of the hinge of a twist \
                         beam are not quadratic; remove the key \"certify\""
            }
            false if is_steered => {
                "certify needs quadratic equations, and those of the knuckles of a steered \
                     axle are not quadratic; remove the key \"certify\""
            }
            false => {
                "certify needs quadratic equations, and those of the rocker of a Watt \
                          linkage are not quadratic; remove the key \"certify\""
            }
        },
    )]);
    refused.extend(bushings_of_five_links(file, suspension));
    let mut sound = is_beam || links(file, suspension, problems);
    sound &= drag_link_is_left(&file.suspension, suspension, problems);
    for (span, message) in refused {
        if let Some(span) = span {
            problems.add(span, message);
            sound = false;
        }
    }
    if let Some(reason) = suspension.mechanism.why_not_elastic() {
        for span in parts {
            let instead = if has_watt && !is_steered {
                "expected a Panhard rod, or no [compliance], [bushings] and [links]"
            } else {
                "leave [compliance], [bushings] and [links] out"
            };
            problems.add(span, format!("{reason}; {instead}"));
            sound = false;
        }
    }
    sound
}

/// Bushings of an axle on five links that is assembled from its parts. If parts do not fit exactly, the links are stretched.
/// The calculation of these tensions does not include the axial stiffness of bushings.
fn bushings_of_five_links(file: &File, suspension: &Suspension) -> Refused<'static> {
    let is_assembled = file.tolerance.is_some() || file.setup.is_some();
    let is_refused = is_assembled && suspension.mechanism.has_extra_links();
    let names = file.bushings.keys().filter(|_| is_refused);
    let message = "[tolerance] and [setup] of an axle on five links do not support bushings. Give \
                   axial_stiffness in [links.NAME] instead, and include the rubber of both joints in it";
    names.map(|name| (Some(name.span()), message)).collect()
}

/// Returns true for two lower links, two upper links and a Panhard rod.
pub(super) fn has_five_links(section: &file::Suspension, mechanism: &Mechanism) -> bool {
    let singles = section.single.as_ref();
    let is_paired = singles.is_none_or(|names| names.get_ref().is_empty());
    is_paired && mechanism.rigid_axle.is_some() && mechanism.point("panhard_axle").is_some()
}

/// Returns true if the drag link's end at the knuckle is on the left side, or if there is no drag link.
fn drag_link_is_left(
    section: &file::Suspension,
    suspension: &Suspension,
    problems: &mut Problems,
) -> bool {
    let name = "drag_link_knuckle";
    let Some(end) = suspension.mechanism.point(name) else {
        return true;
    };
    if suspension.design[end.0].y > 0.0 {
        return true;
    }
    let mut written = section.hardpoints.get_ref().keys();
    let place = written.find(|text| text.get_ref() == name);
    let place = place.map_or(section.hardpoints.span(), Text::span);
    let error = problems.add(
        place,
        "drag_link_knuckle is on the right side; expected the left side, because the drag link turns the left knuckle",
    );
    error.help("if the drag link turns the right knuckle, write the mirror image of the axle: reverse the sign of every y");
    false
}

/// Checks the links that hold the axle. There must be four: two pairs, or a pair of lower links, a single upper link and a
/// Panhard rod or a Watt linkage. Five links need elastic parts.
fn links(file: &File, suspension: &Suspension, problems: &mut Problems) -> bool {
    let section = &file.suspension;
    let has = |name: &str| suspension.mechanism.point(name).is_some();
    let (has_panhard, has_watt) = (has("panhard_axle"), suspension.mechanism.has_watt_linkage());
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
                "five links: with two upper links and a {} the axle can move in roll only if its \
                 joints are elastic",
                if has_watt {
                    "Watt linkage"
                } else {
                    "Panhard rod"
                }
            );
            let error = problems.add(place, message);
            error.help(if has_watt { "give the upper links as one in the middle (single = [\"upper_link\"] in [suspension]), or leave the Watt linkage out" } else { "give the links axial_stiffness ([links.upper_link] and the others, with [compliance]), give the upper links as one in \
            the middle (single = [\"upper_link\"] in [suspension]), or leave the Panhard rod out" });
            false
        }
        (false, false) => {
            let message = "three links let the axle move freely sideways: expected \
                           panhard_chassis and panhard_axle, or a Watt linkage";
            let place = single.map_or(section.hardpoints.span(), Spanned::span);
            problems.add(place, message);
            false
        }
    }
}

/// Axle as seen from its left wheel, and as seen from its right wheel. The second view is `None` if the axle is
/// symmetric.
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
            let bodies = own.bodies.keys().next().map(Text::span);
            let wheel = own.wheel.as_ref().map(Spanned::span);
            for (section, place) in [("bodies", bodies), ("wheel", wheel)] {
                if let Some(place) = place {
                    let message = format!(
                        "the right half of this axle differs in hardpoints and spring only: leave [axle.right.{section}] out"
                    );
                    return problems.refuse(place, message);
                }
            }
            differences(own, rigid, &mut left, problems)?;
        }
    }
    let solver = Solver::new(&left.mechanism, &left.design);
    if let Err(fault) = solver.and_then(|solver| solver.check_start(Drive::Travel)) {
        let message = match fault {
            DesignFault::Singular => {
                "the links do not hold the axle in the design position: one more motion is free, \
                 in addition to heave and roll"
                    .to_owned()
            }
            fault => fault.describe(&left.mechanism),
        };
        let error = problems.add(file.suspension.hardpoints.span(), message);
        error.help(
            "links that are parallel from above let the axle move freely sideways: give the upper \
             links different directions, or give a single upper link and a Panhard rod",
        );
        return None;
    }
    let mut right = left.clone();
    rigid.turn_over(&left.design, &mut right.design);
    let is_symmetric = rigid.is_symmetric(&left.design);
    right.frame = left.frame.of_other_side();
    right.mechanism = left.mechanism.from_other_wheel();
    Some((left, (!is_symmetric).then_some(right)))
}

/// Sets the points of the right half that are not mirror images.
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
                "the axle has only one {}: expected it in [suspension.hardpoints] only, with its \
                 actual y",
                text.get_ref()
            );
            problems.add(text.span(), message);
            sound = false;
            continue;
        };
        rigid.put_far(*far, left.frame.vector(position), &mut left.design);
        if left.design[far.0].y > 0.0 {
            let message = format!(
                "{} is on the left side: give points of the right half with their actual (not mirrored) y",
                text.get_ref()
            );
            problems.add(text.span(), message);
            sound = false;
        }
    }
    sound.then_some(())
}
