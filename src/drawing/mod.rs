//! Drawings of a page: the mechanism along its motion, the effect of each coordinate, and some designs of a sweep.
//! This module solves them from a study; `report` draws them.

mod sweep;

use crate::curves::{Curves, Frame, frames, influences};
use crate::mechanism::DesignFault;
use crate::plan::Plan;
use crate::report::{DrawnDesign, Record};
use crate::study::{Study, WheelStudy};

/// The most frames of the drawing, and stations of the sensitivities: a page must stay small and a run
/// of a million stations must not be run twice.
const MOST_FRAMES: usize = 400;
/// The most displacements of the rack among them.
const MOST_RACKS: usize = 9;

/// A design to be recorded: label, file with its curves, the wheel and the curves themselves.
pub type Solved<'a> = (&'a str, &'a str, &'a WheelStudy, &'a Curves);

impl Record {
    /// The record of a run. The last of the designs is the one sensitivities are taken of.
    ///
    /// # Errors
    /// If one of them cannot be solved in the design position.
    pub fn of(
        command: &str,
        study: &Study,
        plan: &Plan,
        designs: &[Solved<'_>],
    ) -> Result<Self, DesignFault> {
        let few = plan.thinned(MOST_FRAMES, MOST_RACKS);
        let influences = match designs.last() {
            Some((_, _, wheel, _)) => influences(wheel, &few)?,
            None => Vec::new(),
        };
        let drawn = drawn(&few, designs)?;
        Ok(Record::with(command, study, plan, drawn, influences))
    }
}

/// Takes instantaneous centres out of drawings of elastic wheels: they are of the rigid mechanism.
pub(crate) fn leave_out_centres(frames: &mut [Frame]) {
    for placed in frames
        .iter_mut()
        .filter_map(|frame| frame.pose.as_mut().ok())
    {
        placed.roll_centre = None;
        placed.front_view_centre = None;
        placed.side_view_centre = None;
    }
}

/// Designs with their frames. Where several curves are of the very same mechanism the last has them.
fn drawn<'a>(few: &Plan, designs: &[Solved<'a>]) -> Result<Vec<DrawnDesign<'a>>, DesignFault> {
    let shown_later = |number: usize, wheel: &WheelStudy| {
        let mut later = designs[number + 1..].iter();
        later.any(|(_, _, other, _)| std::ptr::eq(*other, wheel))
    };
    let designs = designs.iter().enumerate();
    let drawn = designs.map(|(number, (label, file, wheel, curves))| {
        let mut frames = match shown_later(number, wheel) {
            true => Vec::new(),
            false => frames(&wheel.suspension, few)?,
        };
        if wheel.compliance.is_some() {
            leave_out_centres(&mut frames);
        }
        Ok(DrawnDesign {
            label,
            file,
            curves,
            frames,
        })
    });
    drawn.collect()
}
