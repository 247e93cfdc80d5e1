//! Points at different positions in the compared designs.

use super::super::table::{Cell, Table};
use super::{Compared, ComparedPoints, Comparison};
use crate::model::{Axis, Side};

/// A point whose position in a design differs from its position in the first design.
#[derive(Clone, Debug)]
pub(super) struct Moved {
    /// Side of the wheel. `None` unless a design has points of its own for the right wheel.
    side: Option<Side>,
    point: String,
    label: String,
    /// Displacement from the first design, in its axes and unit.
    by: [f64; 3],
}

/// Points that some designs do not have, and the labels of the designs that have them.
#[derive(Clone, Debug)]
pub(super) struct PartialPoints {
    names: Vec<String>,
    labels: Vec<String>,
}

impl Comparison {
    /// Sentences about the points that only some of the designs have. They are not in [`Comparison::moved_table`].
    pub fn partial_points(&self) -> impl Iterator<Item = String> {
        let sentence = |of: &PartialPoints| {
            let [names, labels] = [&of.names, &of.labels].map(|list| list.join(", "));
            format!("Hardpoints only in {labels}: {names}")
        };
        self.partial_points.iter().map(sentence)
    }

    /// Table of the points that differ from the first design, in its axes and unit. Points that only one of both designs has are
    /// left out.
    pub fn moved_table(&self) -> Table {
        let unit = self.unit.symbol();
        let axes = ["x", "y", "z"].map(|axis| format!("d{axis} {unit}"));
        let sided = self.moved.iter().any(|moved| moved.side.is_some());
        let side = sided.then(|| "side".to_owned()).into_iter();
        let names = side.chain(["hardpoint", "of"].map(str::to_owned));
        let header = names.chain(axes).chain([format!("moved {unit}")]);
        let mut table = Table::with_columns(header);
        for moved in &self.moved {
            let [x, y, z] = moved.by;
            let distance = x.hypot(y).hypot(z);
            let cells = [x, y, z, distance].map(|length| Cell::figure(length, unit));
            let names = [moved.point.as_str(), moved.label.as_str()].map(Cell::from);
            let side = sided.then(|| Cell::from(moved.side.map(Side::name)));
            table.push_row(side.into_iter().chain(names).chain(cells));
        }
        table.keyed(if sided { 3 } else { 2 })
    }
}

/// Points of equal names at different positions. If a design has separate points for the right wheel, both wheels are compared.
pub(super) fn moved(designs: &[Compared]) -> Vec<Moved> {
    let differs = |d: &Compared| matches!(d.points, Some(ComparedPoints::BothWheels(_)));
    if designs.iter().any(differs) {
        let wheels = Side::ALL.into_iter().enumerate();
        let moved = wheels.map(|(number, side)| moved_of(designs, number, Some(side)));
        return moved.flatten().collect();
    }
    moved_of(designs, 0, None)
}

/// Points that some of the designs with known points do not have, grouped by the designs that have them.
pub(super) fn partial_points(designs: &[Compared]) -> Vec<PartialPoints> {
    let known = designs.iter().filter_map(|design| {
        // Both wheels have points of the same names.
        let points = design.points.as_ref()?.wheel(0).points.iter();
        let names: Vec<&String> = points.map(|(name, _)| name).collect();
        Some((&design.label, names))
    });
    let known: Vec<(&String, Vec<&String>)> = known.collect();
    let mut groups: Vec<PartialPoints> = Vec::new();
    for name in known.iter().flat_map(|(_, names)| names) {
        let having = known.iter().filter(|(_, names)| names.contains(name));
        let labels: Vec<String> = having.map(|(label, _)| (*label).clone()).collect();
        if labels.len() == known.len() {
            continue;
        }
        match groups.iter_mut().find(|group| group.labels == labels) {
            Some(group) if group.names.contains(name) => {}
            Some(group) => group.names.push((*name).clone()),
            None => groups.push(PartialPoints {
                names: vec![(*name).clone()],
                labels,
            }),
        }
    }
    groups
}

/// Relative difference of coordinates that a conversion of units and back causes. In each direction, the coordinate, the ratio
/// of the units and the product are rounded once.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Points of one wheel whose positions differ between the designs.
fn moved_of(designs: &[Compared], wheel: usize, side: Option<Side>) -> Vec<Moved> {
    let first = &designs[0];
    let Some(reference) = first.points.as_ref().map(|points| points.wheel(wheel)) else {
        return Vec::new();
    };
    // If the first design has the points of one wheel only, its right wheel is the mirror image. The mirror image is
    // stored in the frame of a left wheel, so the sign of y changes.
    let is_mirror_image = matches!(first.points, Some(ComparedPoints::OneWheel(_)));
    let mut signs = reference.signs;
    if side == Some(Side::Right) && is_mirror_image {
        signs[Axis::Y as usize] = -signs[Axis::Y as usize];
    }
    let mut moved = Vec::new();
    for (name, from) in &reference.points {
        for design in &designs[1..] {
            let Some(points) = &design.points else {
                continue;
            };
            let ratio = first.unit.per_metre() / design.unit.per_metre();
            let mut points = points.wheel(wheel).points.iter();
            let Some((_, to)) = points.find(|(known, _)| known == name) else {
                continue;
            };
            let by = [0, 1, 2].map(|axis| signs[axis] * (to[axis] * ratio - from[axis]));
            let rounding = if first.unit == design.unit {
                0.0
            } else {
                ROUNDING
            };
            let is_moved = |axis: usize| by[axis].abs() > rounding * from[axis].abs();
            if (0..3).any(is_moved) {
                moved.push(Moved {
                    side,
                    point: name.clone(),
                    label: design.label.clone(),
                    by,
                });
            }
        }
    }
    moved
}
