//! Data for the drawings of a page: the mechanism along its motion, the effect of each hardpoint coordinate, and
//! some designs of a sweep.
//! This module computes the data from a study; `report` draws them.

mod sweep;

use crate::curves::{Curves, influences, wheel_frames};
use crate::mechanism::DesignFault;
use crate::plan::Plan;
use crate::report::{DrawnDesign, Record};
use crate::study::{Study, WheelStudy};

/// Largest number of frames (poses) in the drawing, and of stations with sensitivities on the page. The limit keeps the page small.
/// It also saves time, because the program solves these stations once more for the drawing and for the sensitivities.
const MOST_FRAMES: usize = 400;
/// Largest number of rack displacements among the frames of the drawing.
const MOST_RACKS: usize = 9;

/// A design for the record of a run: label, name of the file with its curves, study of the wheel, and curves.
pub type Solved<'a> = (&'a str, &'a str, &'a WheelStudy, &'a Curves);

impl Record {
    /// Makes the record of a run of one wheel, for the report page. The sensitivities in the record belong to the last design.
    ///
    /// # Errors
    /// If a design cannot be solved in the design position.
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

/// Designs with their frames (poses for the drawing). If several entries have the same wheel
/// study, only the last one gets frames.
fn drawn<'a>(few: &Plan, designs: &[Solved<'a>]) -> Result<Vec<DrawnDesign<'a>>, DesignFault> {
    let shown_later = |number: usize, wheel: &WheelStudy| {
        let mut later = designs[number + 1..].iter();
        later.any(|(_, _, other, _)| std::ptr::eq(*other, wheel))
    };
    let designs = designs.iter().enumerate();
    let drawn = designs.map(|(number, (label, file, wheel, curves))| {
        let frames = if shown_later(number, wheel) {
            Vec::new()
        } else {
            wheel_frames(wheel, few)?
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
