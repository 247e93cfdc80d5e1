//! Margins of the constraints, from the values of their rows.

use super::{Beside, Part, RowLabel, TargetLayout};

/// Violation up to which reports and sweeps count a constraint as satisfied, in visible units
/// ([`crate::study::Limited::visible`]): a millionth of a millimetre or of a degree is rounding. Runs use a smaller limit.
pub const VIOLATED: f64 = 1e-6;

/// Smallest margin (distance to a limit) of a constraint in one design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margin {
    /// Distance from the value to the nearest limit, in the constraint's unit; negative if the limit is violated. NaN if a
    /// value of the constraint is missing.
    pub margin: f64,
    /// Drive value of the station with the smallest margin, or of the extreme near it. `None` if the constraint does not
    /// change along the motion, or applies at only one drive value.
    pub at: Option<f64>,
    /// True if the nearest limit is the upper one.
    pub is_upper: bool,
}

/// Largest difference between values of a row at several stations that counts as a rounding error, in the row's unit.
const CONSTANT: f64 = 1e-6;

/// For each row that is one of the two components of a point's distance from a line, finds the row of the other component.
pub(super) fn other_components(labels: &[RowLabel], parts: &[Part]) -> Vec<Option<usize>> {
    let other = |own: &RowLabel| {
        let components = parts[own.part].limited.of.components()?;
        labels.iter().position(|label| {
            let is_same = components.contains(&parts[label.part].limited.of);
            is_same && label.part != own.part && label.constraint == own.constraint
        })
    };
    labels.iter().map(other).collect()
}

/// Combines the values of two rows that are the components of a distance: returns the norm. `other` is the row of the other
/// component, and `of` returns the value of a row. For any other row, returns the value itself. Returns `None` for the
/// second component, because the first component already counts for both.
pub(in crate::optimise) fn whole(
    row: usize,
    other: Option<usize>,
    of: impl Fn(usize) -> f64,
) -> Option<f64> {
    match other {
        None => Some(of(row)),
        Some(other) if row < other => Some(of(row).hypot(of(other))),
        Some(_) => None,
    }
}

impl TargetLayout {
    /// Drive value of a constraint's row. `None` for a quantity of an axle, which has limits only in the design position.
    /// Also `None` if the leg has one station, or a part of a wheel with elastic parts has a limit at one station.
    fn place_of(&self, label: &RowLabel) -> Option<f64> {
        let Some(leg) = self.legs.get(label.leg) else {
            let Some(Beside::Elastic(elastic)) = &self.beside else {
                return None;
            };
            return elastic.place_of(label.part, label.station);
        };
        let values = leg.order.values();
        (values.len() > 1).then(|| values[label.station])
    }

    /// Row of the other component of a distance. `None` if the row is not a component of a distance.
    pub(crate) fn other_component(&self, row: usize) -> Option<usize> {
        self.others[row]
    }

    /// Value of a row or of the distance of which it is the first component, as in [`whole`].
    pub(in crate::optimise) fn whole(&self, row: usize, of: impl Fn(usize) -> f64) -> Option<f64> {
        whole(row, self.others[row], of)
    }

    /// Smallest margin of each constraint, from the values of all rows, and from the drive values of the extremes that rows
    /// hold.
    pub(in crate::optimise) fn margins(
        &self,
        values: &[f64],
        extremes: &[Option<f64>],
    ) -> Vec<Margin> {
        let none = Margin {
            margin: f64::INFINITY,
            at: None,
            is_upper: false,
        };
        let mut margins = vec![none; self.constraints];
        let mut nearest = vec![0; self.constraints];
        for (row, label) in self.labels.iter().enumerate() {
            let Some(value) = self.whole(row, |row| values[row]) else {
                continue;
            };
            let (margin, least) = (self.margin(row, value), &mut margins[label.constraint]);
            // A missing value gives the constraint a margin without value, whatever its other rows are.
            if margin < least.margin || margin.is_nan() {
                let extreme = extremes.get(row).copied().flatten();
                *least = Margin {
                    margin,
                    at: extreme.or_else(|| self.place_of(label)),
                    is_upper: label.is_upper,
                };
                nearest[label.constraint] = row;
            }
        }
        for (margin, row) in margins.iter_mut().zip(nearest) {
            if margin.at.is_some() && self.is_constant(row, values) {
                margin.at = None;
            }
        }
        margins
    }

    /// Returns true if the value of a row is constant along the motion. It is constant if it belongs to the design position,
    /// if it cannot change (as the length of a rigid part), or if it is the same at all stations.
    fn is_constant(&self, row: usize, values: &[f64]) -> bool {
        let own = self.labels[row];
        let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
        let mut stations = 0;
        for (other, label) in self.labels.iter().enumerate() {
            let is_same =
                (label.part, label.is_upper, label.leg) == (own.part, own.is_upper, own.leg);
            if let (true, Some(value)) = (is_same, self.whole(other, |row| values[row])) {
                ends = [ends[0].min(value), ends[1].max(value)];
                stations += 1;
            }
        }
        let is_same = stations > 1 && ends[1] - ends[0] <= CONSTANT;
        self.parts[own.part].is_at_design || is_same
    }

    /// Margin between a row's value and its limit, in the constraint's unit; negative if the limit is violated.
    pub fn margin(&self, row: usize, value: f64) -> f64 {
        let part = &self.parts[self.labels[row].part].limited;
        part.margin(self.violation(row, value))
    }

    /// Violation of a row's limit in the row's unit; negative if there is margin.
    pub(in crate::optimise) fn violation(&self, row: usize, value: f64) -> f64 {
        if row < self.equalities {
            value.abs()
        } else {
            value
        }
    }

    /// Absolute values of the limits of the constraints' rows, in the rows' unit.
    pub(in crate::optimise) fn row_limits(&self) -> Vec<f64> {
        let limit = |label: &RowLabel| {
            let part = &self.parts[label.part].limited;
            let limit = if label.is_upper {
                part.upper
            } else {
                part.lower
            };
            limit.map_or(0.0, |limit| (limit / part.scale).abs())
        };
        self.labels.iter().map(limit).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;
    use std::path::Path;

    /// If one value of a constraint is missing, its margin has no value, at whatever station. The margins of the other
    /// constraints do not change.
    #[test]
    fn a_missing_value_leaves_no_margin() {
        let text = include_str!("../../../templates/double_wishbone.toml");
        let study = Study::from_text("study.toml", text, Path::new("")).unwrap();
        let overrides = [
            "motion.travel=[-10.0,0.0,10.0]",
            "optimise.variables=[{ hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-5.0, 5.0] }]",
            "optimise.targets=[{ characteristic = \"toe\", at = 0.0, value = 0.0, tolerance = 0.1 }]",
            "optimise.constraints=[{ characteristic = \"camber\", between = [-5.0, 5.0] }, \
             { characteristic = \"toe\", between = [-5.0, 5.0] }]",
        ];
        let overrides = overrides.map(str::to_owned);
        let study = study.with_overrides("study.toml", &overrides).unwrap();
        let layout = TargetLayout::of(study.optimise.as_ref().unwrap(), &study.vehicle);
        let labels = layout.labels();
        let values: Vec<f64> = (0..labels.len()).map(|row| -1.0 - row as f64).collect();
        let all = layout.margins(&values, &[]);
        assert!(all.len() == 2 && all.iter().all(|own| own.margin > 0.0));
        for (row, label) in labels.iter().enumerate() {
            let mut missing = values.clone();
            missing[row] = f64::NAN;
            let found = layout.margins(&missing, &[]);
            assert!(found[label.constraint].margin.is_nan());
            let other = 1 - label.constraint;
            assert_eq!(found[other].margin, all[other].margin);
        }
    }
}
