//! Rows of the constraints: one for each limit of each part at each station.

use super::super::Linearisation;
use super::{Extremes, Part, RowLabel};
use crate::model::Mechanism;
use crate::study::{Limited, Optimise};

/// A part of a constraint at one station, with the indices of its rows.
#[derive(Clone, Copy, Debug)]
pub(in crate::optimise) struct Check {
    pub part: usize,
    /// Index of the row of the lower limit. `None` without this limit.
    pub lower: Option<usize>,
    /// Index of the row of the upper limit. `None` without this limit.
    pub upper: Option<usize>,
    /// Index of the row of an equality, which has no other row.
    pub equal: Option<usize>,
}

impl Check {
    /// Writes the rows of the limits, from the value of the part and its derivatives with respect to the variables.
    pub(in crate::optimise) fn write(
        &self,
        of: &Limited,
        found: f64,
        slopes: &[f64],
        rows: &mut Linearisation,
    ) {
        let limits = [
            (self.lower, of.lower, -1.0),
            (self.upper, of.upper, 1.0),
            (self.equal, of.upper, 1.0),
        ];
        for (row, limit, sign) in limits {
            if let (Some(row), Some(limit)) = (row, limit) {
                let scale = sign / of.scale;
                rows.residuals[row] = (found - limit) * scale;
                rows.write_slopes(row, slopes, scale);
            }
        }
    }
}

impl Extremes {
    /// Collects the rows that set an upper limit (`sign` 1) or a lower limit (`sign` -1) for the values of a part. `None` if
    /// no station has such a limit.
    pub(super) fn of(
        part: usize,
        sign: f64,
        by_drive: &[usize],
        checks: &[Vec<Check>],
    ) -> Option<Extremes> {
        let row = |station: &usize| {
            let check = checks[*station].iter().find(|check| check.part == part)?;
            let row = if sign > 0.0 { check.upper } else { check.lower };
            Some((*station, row?))
        };
        let rows: Vec<(usize, usize)> = by_drive.iter().filter_map(row).collect();
        (!rows.is_empty()).then_some(Extremes { part, sign, rows })
    }
}

/// Numbers the rows of the constraints: equalities first, then limits in the order of the checks.
pub(super) struct RowNumbers<'p> {
    parts: &'p [Part],
    labels: Vec<RowLabel>,
    equalities: usize,
}

impl<'p> RowNumbers<'p> {
    /// Numbers the equalities among these checks. Each check is given by its part, leg and station.
    pub(super) fn of(
        parts: &'p [Part],
        checks: impl Iterator<Item = (usize, usize, usize)>,
    ) -> Self {
        let mut numbers = RowNumbers {
            parts,
            labels: Vec::new(),
            equalities: 0,
        };
        for (part, leg, station) in checks {
            let Limited { lower, upper, .. } = &parts[part].limited;
            if lower.is_some() && lower == upper {
                let label = numbers.label(part, true, leg, station);
                numbers.labels.push(label);
            }
        }
        numbers.equalities = numbers.labels.len();
        numbers
    }

    fn label(&self, part: usize, is_upper: bool, leg: usize, station: usize) -> RowLabel {
        RowLabel {
            constraint: self.parts[part].constraint,
            part,
            is_upper,
            leg,
            station,
        }
    }

    /// Rows of a part at a station: the row of its equality, or a new row for each limit.
    pub(super) fn check(&mut self, part: usize, leg: usize, station: usize) -> Check {
        let equal = self.label(part, true, leg, station);
        let mut equalities = self.labels[..self.equalities].iter();
        let equal = equalities.position(|label| *label == equal);
        let limited = &self.parts[part].limited;
        let mut row = |limit: Option<f64>, is_upper: bool| {
            limit.filter(|_| equal.is_none())?;
            self.labels.push(self.label(part, is_upper, leg, station));
            Some(self.labels.len() - 1)
        };
        Check {
            part,
            lower: row(limited.lower, false),
            upper: row(limited.upper, true),
            equal,
        }
    }

    /// Returns the constraint, station and limit of each row, and the number of equalities.
    pub(super) fn into_labels(self) -> (Vec<RowLabel>, usize) {
        (self.labels, self.equalities)
    }
}

/// Parts of all constraints.
pub(super) fn parts(optimise: &Optimise, mechanism: &Mechanism) -> Vec<Part> {
    let constraints = optimise.constraints.iter().enumerate();
    let parts = constraints.flat_map(|(number, constraint)| {
        constraint.parts.iter().map(move |part| Part {
            constraint: number,
            is_at_design: constraint.site.is_none() || part.of.is_fixed(mechanism),
            limited: part.clone(),
        })
    });
    parts.collect()
}
