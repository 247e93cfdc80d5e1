//! Legs while their stations are collected.

use super::rows::RowNumbers;
use super::{Extremes, Leg, TargetSample};
use crate::evaluate::index_or_push;
use crate::model::{Axis, Drive, Frame};
use crate::solve::StationOrder;
use crate::study::{Motion, Sample, Site};

/// Place of a target of one wheel among the measures, and its scale.
pub(super) struct TargetPlace {
    /// Number of the measure.
    pub of: usize,
    /// Residual per deviation in the unit of the measure.
    pub scale: f64,
}

/// A leg while its stations are collected.
pub(super) struct Draft {
    drive: Drive,
    rack: f64,
    pub values: Vec<f64>,
    /// Row, target, station and wanted value.
    pub targets: Vec<(usize, usize, usize, Sample)>,
    /// Part and station.
    pub checks: Vec<(usize, usize)>,
    /// Parts whose extremes between the stations count.
    pub extremes: Vec<usize>,
}

impl Draft {
    /// Number of the station with this drive value; a missing one is added.
    pub(super) fn station(&mut self, drive: f64) -> usize {
        index_or_push(&mut self.values, drive)
    }

    /// Leaves out the stations that no target or constraint uses; they are not visited.
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

    /// The leg of this number, with its rows.
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
        by_drive.sort_by(|a, b| self.values[*a].total_cmp(&self.values[*b]));
        let extremes = self.extremes.iter().flat_map(|part| {
            let of_part = |sign| Extremes::of(*part, sign, &by_drive, &checks);
            [-1.0, 1.0].into_iter().filter_map(of_part)
        });
        Leg {
            drive: self.drive,
            rack: self.rack,
            order: StationOrder::through(&self.values),
            extremes: extremes.collect(),
            targets,
            checks,
        }
    }
}

/// Number of the draft with this drive, this rack displacement and stations that begin with these; a missing draft is
/// added.
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

/// The motion of a site and the numbers of its drafts, one for each rack displacement.
pub(super) fn legs_of<'m>(
    site: &'m Site,
    motion: &'m Motion,
    frame: &Frame,
    drafts: &mut Vec<Draft>,
) -> (&'m Motion, Vec<usize>) {
    let motion = site.motion.as_ref().map_or(motion, |(_, motion)| motion);
    let home = if motion.rack_moves {
        0.0
    } else {
        motion.rack[0]
    };
    let racks = match site.racks.as_slice() {
        [] => vec![home],
        racks => racks.to_vec(),
    };
    let drive = motion.drive.in_kernel();
    let of_rack = |rack: f64| draft_of(drafts, drive, frame.sign(Axis::Y) * rack, &motion.values);
    (motion, racks.into_iter().map(of_rack).collect())
}
