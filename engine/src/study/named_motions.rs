//! Named motions in `[motions.NAME]`.

use super::error::Problems;
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
        if let Some(motion) = motion::motion(section, true, problems) {
            motions.push((name.get_ref().clone(), motion));
        }
    }
    motions
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
