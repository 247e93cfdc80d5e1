//! Drive values of targets: their unit in the study, and the range of the motion.

use super::super::drive_rounding::{DriveRounding, ends};
use super::super::resolve::Context;
use super::super::{Motion, Site};
use crate::number::Each;

/// Drive values of a motion as written in a study: angles are in the motion's `angle_unit`.
pub(super) struct DriveValues<'a> {
    motion: &'a Motion,
    is_in_radians: bool,
}

impl<'a> DriveValues<'a> {
    /// Returns the drive values of the motion of a target. `site` names this motion.
    pub(super) fn of(motion: &'a Motion, site: &Site, context: &Context) -> Self {
        let file = context.file;
        let section = match &site.motion {
            None => Some(&file.motion),
            Some((name, _)) => {
                let mut sections = file.motions.iter();
                let named = sections.find(|(own, _)| own.get_ref() == name);
                named.map(|(_, section)| section)
            }
        };
        let unit = section.and_then(|section| section.get_ref().angle_unit.as_ref());
        let is_radian = unit.is_some_and(|unit| unit.get_ref() == "rad");
        DriveValues {
            motion,
            is_in_radians: motion.drive.is_angle() && is_radian,
        }
    }

    /// Converts a drive value as written to length units or radians.
    pub(super) fn in_kernel(&self, written: f64) -> f64 {
        if self.motion.drive.is_angle() && !self.is_in_radians {
            written.to_radians()
        } else {
            written
        }
    }

    /// Converts a drive value from a column of a file, where angles are in degrees, to the study's unit.
    pub(super) fn of_column(&self, drive: f64) -> f64 {
        if self.is_in_radians {
            drive.to_radians()
        } else {
            drive
        }
    }

    /// Converts a drive value of the motion to the study's unit.
    pub(super) fn as_written(&self, drive: f64) -> f64 {
        if self.is_in_radians {
            drive
        } else {
            self.motion.drive.printed(drive)
        }
    }

    /// Message if a drive value as written is outside of the motion.
    pub(super) fn outside(&self, written: f64) -> Option<String> {
        let drive = self.in_kernel(written);
        let values = &self.motion.values;
        let is_within = DriveRounding::of(values).is_within(drive, ends(values));
        (!is_within).then(|| {
            let range = self.range_in_words();
            format!("{written} is outside of the motion, which {range}")
        })
    }

    /// Message if a measured point cannot be compared at its drive value.
    pub(super) fn refuse_measured(&self, written: f64) -> Option<String> {
        let message = self.outside(written)?;
        Some(format!(
            "{message}: extend the motion, or remove the measured point"
        ))
    }

    /// Describes the range of the motion, in the study's unit.
    pub(super) fn range_in_words(&self) -> String {
        let [lowest, highest] = ends(&self.motion.values).each(|value| self.as_written(value));
        let unit = match (self.motion.drive.is_angle(), self.is_in_radians) {
            (false, _) => "",
            (true, false) => " degrees",
            (true, true) => " radians",
        };
        format!("runs from {lowest} to {highest}{unit}")
    }
}
