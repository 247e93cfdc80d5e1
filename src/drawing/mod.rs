//! Drawings of a page: the mechanism along its motion, the effect of each coordinate, and some designs of a sweep.
//! This module solves them from a study; `report` draws them.

mod sweep;

use crate::curves::{Curves, frames, influences};
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::plan::Plan;
use crate::report::{DrawnDesign, Record};
use crate::study::Study;

/// The most frames of the drawing, and stations of the sensitivities: a page must stay small and a run
/// of a million stations must not be run twice.
const MOST_FRAMES: usize = 400;
/// The most displacements of the rack among them.
const MOST_RACKS: usize = 9;

/// A design to be recorded: label, file with its curves, the suspension and the curves themselves.
pub type Solved<'a> = (&'a str, &'a str, &'a Suspension, &'a Curves);

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
            Some((_, _, suspension, _)) => influences(suspension, &few)?,
            None => Vec::new(),
        };
        let drawn = drawn(&few, designs)?;
        Ok(Record::with(command, study, plan, drawn, influences))
    }
}

/// Designs with their frames. Where several curves are of the very same mechanism the last has them.
fn drawn<'a>(few: &Plan, designs: &[Solved<'a>]) -> Result<Vec<DrawnDesign<'a>>, DesignFault> {
    let shown_later = |number: usize, suspension: &Suspension| {
        let mut later = designs[number + 1..].iter();
        later.any(|(_, _, other, _)| std::ptr::eq(*other, suspension))
    };
    let designs = designs.iter().enumerate();
    let drawn = designs.map(|(number, (label, file, suspension, curves))| {
        let frames = match shown_later(number, suspension) {
            true => Vec::new(),
            false => frames(suspension, few)?,
        };
        Ok(DrawnDesign {
            label,
            file,
            curves,
            frames,
        })
    });
    drawn.collect()
}
