//! Rows of a table that belong to one curve: the rows with one value of the second moving coordinate.

use super::style::SHADES;
use crate::report::curve_table::CurveTable;
use crate::report::record::MotionRecord;
use std::collections::HashMap;

/// Largest number of curves per design and wheel in one chart.
const MOST_FAMILIES: usize = 9;

/// Rows of a design for one value of the second moving coordinate.
pub(in crate::report) struct Family {
    /// Value of the second moving coordinate. 0 without a second moving coordinate.
    pub place: f64,
    /// Rows of the design's table with this value.
    pub rows: Vec<usize>,
    /// Index of the family's colour in the sequential colour scale.
    pub(super) shade: usize,
    /// True if `place` is the value nearest to zero.
    pub is_present: bool,
}

/// Columns of the coordinates that move in addition to the coordinate on the horizontal axis. For a wheel it is the rack; for
/// an axle it is every other coordinate.
pub(in crate::report) fn moving_beside<'r>(
    motion: &'r MotionRecord,
    abscissa: &str,
) -> Vec<&'r String> {
    let drive = (!motion.further.is_empty()).then_some(&motion.drive);
    let all = drive.into_iter().chain(&motion.further).chain(&motion.rack);
    all.filter(|name| *name != abscissa).collect()
}

/// Value nearest to zero among the values of a column. `None` if the column has no values.
pub(super) fn nearest_to_zero(values: &[Option<f64>]) -> Option<f64> {
    let known = values.iter().flatten().copied();
    known.min_by(|a, b| a.abs().total_cmp(&b.abs()))
}

/// Groups the rows of a table by their values in the first of the columns `moving`. Uses only rows in which all other columns of
/// `moving` have their value nearest to zero. Also returns the number of different values of the first column. If there are more
/// than nine values, the function keeps the first, the last, the one nearest to zero, and evenly spaced others.
pub(in crate::report) fn families(moving: &[&String], table: &CurveTable) -> (Vec<Family>, usize) {
    let mut columns = moving.iter().filter_map(|name| table.column(name));
    let apart = columns.next();
    let held: Vec<_> = columns
        .map(|values| (values, nearest_to_zero(values)))
        .collect();
    let mut found: Vec<(f64, Vec<usize>)> = Vec::new();
    let mut numbers = HashMap::new();
    for row in 0..table.rows() {
        if held.iter().any(|(values, value)| values[row] != *value) {
            continue;
        }
        let Some(place) = apart.map_or(Some(0.0), |values| values[row]) else {
            continue;
        };
        // Adding 0 makes -0 equal to 0.
        let number = *numbers
            .entry((place + 0.0).to_bits())
            .or_insert(found.len());
        if number == found.len() {
            found.push((place, Vec::new()));
        }
        found[number].1.push(row);
    }
    let all = found.len();
    let present = (0..all).min_by(|a, b| found[*a].0.abs().total_cmp(&found[*b].0.abs()));
    let is_kept = |k: usize| {
        let evenly = |i: usize| i * (all - 1) / (MOST_FAMILIES - 1);
        all <= MOST_FAMILIES || Some(k) == present || (0..MOST_FAMILIES).any(|i| evenly(i) == k)
    };
    let last = all.saturating_sub(1).max(1);
    let family = |(k, (place, rows)): (usize, (f64, Vec<usize>))| Family {
        place,
        rows,
        shade: (k * (SHADES - 1) + last / 2) / last,
        is_present: Some(k) == present,
    };
    let kept = found.into_iter().enumerate().filter(|(k, _)| is_kept(*k));
    (kept.map(family).collect(), all)
}
