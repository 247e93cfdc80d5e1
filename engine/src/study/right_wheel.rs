//! `[axle.right]`: right wheel of an axle, if it is not the mirror image of the left wheel.

use super::error::Problems;
use super::file::{self, File};
use super::outputs::hardpoint;
use super::suspension::{below_right_angle, bodies, position};
use super::value::{RightWheel, Text};
use crate::mechanism::GeometryFault;
use crate::model::{PointId, SpinAxis, Suspension};
use crate::number::Each;
use crate::solve::Solver;
use toml::Spanned;

/// Section `[axle.right]` of the study. `None` if the right wheel is the mirror image of the left wheel.
pub(super) fn own(file: &File) -> Option<&file::OwnRight> {
    match file.axle.as_ref()?.get_ref().right.as_ref()?.get_ref() {
        RightWheel::Own(own) => Some(own),
        RightWheel::Word(_) => None,
    }
}

/// Reads the right wheel of an axle, without its springs. `Some(None)` if it is the mirror image of the left wheel, `None`
/// if it has an error.
pub(super) fn right_wheel(
    file: &File,
    left: &Suspension,
    problems: &mut Problems,
) -> Option<Option<Suspension>> {
    let section = file.axle.as_ref().map(Spanned::get_ref);
    let Some(written) = section.and_then(|section| section.right.as_ref()) else {
        return Some(None);
    };
    let place = written.span();
    if let RightWheel::Word(word) = written.get_ref() {
        if word == "mirrored" {
            return Some(None);
        }
        let message = format!("unknown right wheel {word:?}; expected \"mirrored\" or a table");
        return problems.refuse(place, message);
    }
    let own = own(file)?;
    if own.hardpoints.is_empty() && own.bodies.is_empty() && own.wheel.is_none() {
        return Some(None);
    }
    let mut right = left.clone();
    right.frame = left.frame.of_other_side();
    let mut sound = true;
    for (text, coordinates) in &own.hardpoints {
        let id = extra_point(text, left).or_else(|| hardpoint(text, left, problems));
        let position = position(coordinates, problems);
        match (id, position) {
            (Some(id), Some(position)) => right.design[id.0] = right.frame.vector(position),
            _ => sound = false,
        }
    }
    sound &= bodies(&own.bodies, &mut right.mechanism, problems).is_some();
    sound &= spin_axis(file, own, &mut right, problems).is_some();
    if !sound {
        return None;
    }
    let centre = right.design[right.mechanism.wheel_centre.0];
    if centre.y < 0.0 {
        let message = "the right wheel's wheel_centre is on the left side: give its hardpoints in \
                       the study's axes, with their actual (not mirrored) y";
        return problems.refuse(place, message);
    }
    if let Some(fault) = GeometryFault::first_of(&right) {
        return problems.refuse(place, format!("right wheel: {fault}"));
    }
    if let Err(fault) = Solver::new(&right.mechanism, &right.design) {
        let message = format!("right wheel: {}", fault.describe(&right.mechanism));
        return problems.refuse(place, message);
    }
    Some(Some(right))
}

/// Extra point with this name. Its position can differ between the two sides of a built axle.
fn extra_point(text: &Text, left: &Suspension) -> Option<PointId> {
    let (mechanism, name) = (&left.mechanism, text.get_ref());
    match mechanism.topology.hardpoint(name) {
        Some(_) => None,
        None => mechanism.point(name),
    }
}

/// Static camber and toe of the right wheel. A missing value equals the value of the left wheel.
fn spin_axis(
    file: &File,
    own: &file::OwnRight,
    right: &mut Suspension,
    problems: &mut Problems,
) -> Option<()> {
    let Some(wheel) = &own.wheel else {
        return Some(());
    };
    let mechanism = &mut right.mechanism;
    if let SpinAxis::From(inner) = mechanism.spin_axis {
        let name = mechanism.name(inner);
        let message = format!("{name} already gives camber and toe of the design position");
        let error = problems.add(wheel.span(), message);
        error.help(format!(
            "{name} in [axle.right.hardpoints] gives camber and toe of the right wheel"
        ));
        return None;
    }
    let wheel = wheel.get_ref();
    let left = &file.wheel;
    let camber = wheel.static_camber.as_ref().or(left.static_camber.as_ref());
    let toe = wheel.static_toe.as_ref().or(left.static_toe.as_ref());
    let [camber, toe] = [camber, toe].each(|angle| below_right_angle(angle, problems));
    let (camber, toe) = (camber?.to_radians(), toe?.to_radians());
    mechanism.spin_axis = SpinAxis::standing(camber, toe);
    Some(())
}
