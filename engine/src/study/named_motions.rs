//! Named motions in `[motions.NAME]`.

use super::error::Problems;
use super::resolve::Context;
use super::{Drive, Motion, axle, file, motion};
use crate::model::Suspension;

/// Named motions of one wheel. In a study of an axle, they are motions of its left wheel.
pub(super) fn of_wheel(
    file: &file::File,
    of_axle: bool,
    problems: &mut Problems,
) -> Vec<(String, Motion)> {
    let mut motions = Vec::new();
    for (name, section) in &file.motions {
        if of_axle && axle::moves_axle(section.get_ref()) {
            continue;
        }
        if of_axle && has_rack_alone(section.get_ref()) {
            let message = "the rack alone does not tell a motion of both wheels from a motion of the left wheel";
            let error = problems.add(section.span(), message);
            error.help("add heave = 0.0 to steer both wheels at the design height");
            continue;
        }
        if let Some(motion) = motion::motion(section, true, problems) {
            motions.push((name.get_ref().clone(), motion));
        }
    }
    motions
}

/// Returns true if the rack is the only coordinate of a motion.
fn has_rack_alone(motion: &file::Motion) -> bool {
    let drives = [&motion.travel, &motion.arm_angle, &motion.theta];
    motion.rack.is_some() && motion.time.is_none() && drives.iter().all(|own| own.is_none())
}

/// Returns true if the study has a motion of one wheel with this name, with or without errors.
pub(super) fn is_of_wheel(name: &str, context: &Context) -> bool {
    context.file.motions.iter().any(|(own, section)| {
        let moves_axle = context.axle.is_some() && axle::moves_axle(section.get_ref());
        own.get_ref() == name && !moves_axle
    })
}

/// Returns true if the motion of one wheel with this name has an error. This error is already reported.
pub(super) fn is_refused(name: &str, context: &Context) -> bool {
    let is_read = context.motions.iter().any(|own| own.0 == name);
    !is_read && is_of_wheel(name, context)
}

/// Checks the names of all motions. Also checks drives and time laws of the motions of one wheel that have no errors.
pub(super) fn check(
    file: &file::File,
    motions: &[(String, Motion)],
    suspension: &Suspension,
    problems: &mut Problems,
) {
    for (name, section) in &file.motions {
        let same = |named: &&(String, Motion)| named.0 == *name.get_ref();
        if let Some((_, motion)) = motions.iter().find(same) {
            motion::check_drive(section, motion, suspension, problems);
            if motion.drive == Drive::PaperTheta || motion.time.is_some() {
                let message = "a named motion needs the key \"travel\" or \"arm_angle\", and must not have \"time\"";
                problems.add(section.span(), message);
            }
        }
        if *name.get_ref() == "before" || name.get_ref().starts_with("before_") {
            let message = "the name of a motion cannot begin with \"before\": a tuning writes the curves of the earlier design as curves_before.csv";
            problems.add(name.span(), message);
        }
        if name.get_ref().is_empty() || name.get_ref().contains(['/', '\\', '.']) {
            let message =
                "the name of a motion is part of a file name: expected letters, digits and _";
            problems.add(name.span(), message);
        }
    }
}
