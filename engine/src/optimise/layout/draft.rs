//! Draft of a leg (a motion at one rack displacement). Stations can still be added to the draft.

use super::rows::RowNumbers;
use super::{Extremes, Leg, TargetSample};
use crate::evaluate::index_or_push;
use crate::model::{Axis, Drive, Frame};
use crate::solve::StationOrder;
use crate::sorting::sort_by;
use crate::study::{Motion, Sample, Site};

/// Index of the measure of a target of one wheel, and the scale of the target's residual.
pub(super) struct TargetPlace {
    /// Index of the measure.
    pub of: usize,
    /// Residual per deviation in the unit of the measure.
    pub scale: f64,
}

/// A leg (a motion at one rack displacement) to which stations can still be added.
pub(super) struct Draft {
    drive: Drive,
    rack: f64,
    pub values: Vec<f64>,
    /// For each target sample: the indices of its row, target and station, and its target value.
    pub targets: Vec<(usize, usize, usize, Sample)>,
    /// Constraint parts to check: the indices of the part and of the station.
    pub checks: Vec<(usize, usize)>,
    /// Parts whose limits also apply to extremes between the stations.
    pub extremes: Vec<usize>,
}

impl Draft {
    /// Returns the index of the station with this drive value, and adds it if it is missing.
    pub(super) fn station(&mut self, drive: f64) -> usize {
        index_or_push(&mut self.values, drive)
    }

    /// Removes the stations that no target or constraint uses.
    pub(super) fn leave_out_unused(&mut self) {
        let of_targets = self.targets.iter_mut().map(|(_, _, station, _)| station);
        let of_checks = self.checks.iter_mut().map(|(_, station)| station);
        let mut all: Vec<&mut usize> = of_targets.chain(of_checks).collect();
        let is_used = |station: &usize| all.iter().any(|s| **s == *station);
        let used: Vec<usize> = (0..self.values.len()).filter(is_used).collect();
        for station in &mut all {
            **station = used.binary_search(station).expect("it is used");
        }
        self.values = used.iter().map(|station| self.values[*station]).collect();
    }

    /// Converts the draft into the leg with this index, and numbers the rows of its constraints.
    pub(super) fn into_leg(
        self,
        number: usize,
        places: &[TargetPlace],
        numbers: &mut RowNumbers<'_>,
    ) -> Leg {
        let mut targets = vec![Vec::new(); self.values.len()];
        for (row, target, station, wanted) in self.targets {
            targets[station].push(TargetSample {
                row,
                target,
                of: places[target].of,
                wanted,
                scale: places[target].scale,
            });
        }
        let mut checks = vec![Vec::new(); self.values.len()];
        for (part, station) in self.checks {
            checks[station].push(numbers.check(part, number, station));
        }
        let mut by_drive: Vec<usize> = (0..self.values.len()).collect();
        sort_by(&mut by_drive, |a, b| {
            self.values[*a].total_cmp(&self.values[*b])
        });
        let extremes = self.extremes.iter().flat_map(|part| {
            let of_part = |sign| Extremes::of(*part, sign, &by_drive, &checks);
            [-1.0, 1.0].into_iter().filter_map(of_part)
        });
        let order = StationOrder::through(&self.values);
        Leg {
            drive: self.drive,
            rack: self.rack,
            extremes: extremes.collect(),
            visits: [
                order.only(|station| !checks[station].is_empty()),
                order.only(|station| !targets[station].is_empty()),
                order.clone(),
            ],
            order,
            targets,
            checks,
        }
    }
}

/// Returns the index of the draft with this drive and this rack displacement whose stations begin with `values`. Adds the
/// draft if it is missing.
pub(super) fn draft_of(drafts: &mut Vec<Draft>, drive: Drive, rack: f64, values: &[f64]) -> usize {
    let same = |d: &Draft| d.drive == drive && d.rack == rack && d.values.starts_with(values);
    drafts.iter().position(same).unwrap_or_else(|| {
        drafts.push(Draft {
            drive,
            rack,
            values: values.to_vec(),
            targets: Vec::new(),
            checks: Vec::new(),
            extremes: Vec::new(),
        });
        drafts.len() - 1
    })
}

/// Returns the motion to which a target or constraint applies. Also returns the indices of the motion's drafts, one for
/// each rack displacement.
pub(super) fn legs_of<'m>(
    site: &'m Site,
    motion: &'m Motion,
    frame: &Frame,
    drafts: &mut Vec<Draft>,
) -> (&'m Motion, Vec<usize>) {
    let motion = site.motion.as_ref().map_or(motion, |(_, motion)| motion);
    let home = motion.design_rack();
    let racks = match site.racks.as_slice() {
        [] => vec![home],
        racks => racks.to_vec(),
    };
    let drive = motion.drive.in_kernel();
    let of_rack = |rack: f64| draft_of(drafts, drive, frame.sign(Axis::Y) * rack, &motion.values);
    (motion, racks.into_iter().map(of_rack).collect())
}
