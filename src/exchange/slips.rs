//! Typing errors in the points of a file: one coordinate with a wrong sign or decimal place. A typing error may explain why the
//! axes or the half track are uncertain. Then the importer names the typing error instead of asking about the whole file.

use super::corner::Picked;
use super::notes::Notes;
use super::place;
use super::refusal::{Question, Refusal};
use super::table::PointTable;
use super::{Hardpoint, ImportOptions};
use crate::model::Side;
use crate::report::Slip;

/// Describes a typing error in a point of the file. `outcome` states the consequence of the corrected value, such as "all points
/// fit together".
pub(super) fn in_words(point: &Hardpoint, slip: &Slip, outcome: &str) -> String {
    let words = slip.describe(point.position[slip.axis], slip.likely);
    format!(
        "{:?} ({}), {}, seems to have {words}: with this value {outcome}. Correct it in the file",
        point.called, point.place, point.name
    )
}

/// Checks of a wheel's points: axes, side and half track.
pub(super) struct Checks<'a> {
    pub(super) table: &'a PointTable,
    pub(super) options: &'a ImportOptions<'a>,
    pub(super) wanted: Option<Side>,
    pub(super) half_track: Option<f64>,
    /// True if a half track of the file is compared with the points.
    pub(super) compare: bool,
}

impl Checks<'_> {
    /// True if the points pass all checks.
    fn pass(&self, mut picked: Vec<Picked>) -> bool {
        let mut notes = Notes::default();
        let placed = place::place(self.table, self.options, self.wanted, &picked, &mut notes);
        let Ok(mut placed) = placed else {
            return false;
        };
        if !self.options.topology.carries_both_wheels() {
            place::mirror(&mut placed, self.wanted, &mut picked, &mut notes);
        }
        let flags = (self.options.half_track.is_some(), self.compare);
        let moved = place::to_half_track(placed, self.half_track, flags, &mut picked, &mut notes);
        moved.is_ok() && notes.doubts().next().is_none()
    }

    /// Replaces the reason of a refusal by the typing error that explains it, if there is one. `picked` are the points as
    /// written in the file.
    pub(super) fn explain(&self, picked: &[Picked], refusal: Refusal) -> Refusal {
        let points: Vec<[f64; 3]> = picked.iter().map(|p| p.hardpoint.position).collect();
        let changed = |points: &[[f64; 3]]| {
            let mut changed = picked.to_vec();
            for (point, position) in changed.iter_mut().zip(points) {
                point.hardpoint.position = *position;
            }
            changed
        };
        let Some(slip) = Slip::of(&points, |points| self.pass(changed(points))) else {
            return refusal;
        };
        let reason = in_words(
            &picked[slip.point].hardpoint,
            &slip,
            "all points fit together",
        );
        match refusal {
            Refusal::Wrong(_) => Refusal::Wrong(reason),
            Refusal::Open(question) => Refusal::Open(Question {
                reason: format!("{reason}. If the value is right"),
                ..question
            }),
        }
    }
}
