//! Constraints that keep points on one plane or line.

use super::super::Limited;
use super::super::error::Problems;
use super::super::resolve::each;
use super::super::subject::point;
use super::Reader;
use crate::characteristics::{Across, Measure};
use crate::mechanism::DEGENERATE;
use crate::model::PointId;
use crate::number::{Each, Vector3};

impl Reader<'_> {
    /// Reads `coplanar` and `line`.
    pub(super) fn aligned(&self, problems: &mut Problems) -> Option<(String, Vec<Limited>)> {
        self.takes(&[], problems);
        let written = self.written;
        let (names, least, what) = match (&written.coplanar, &written.line) {
            (Some(names), _) => (names, 4, "plane"),
            (None, Some(names)) => (names, 3, "line"),
            (None, None) => return None,
        };
        let list = names.get_ref();
        if list.len() < least {
            let message = format!(
                "expected at least {least} points of a {what}, found {}: fewer points always lie on one {what}",
                list.len()
            );
            return problems.refuse(names.span(), message);
        }
        let ids = each(list, |name| point(name, self.suspension(), problems))?;
        for (number, id) in ids.iter().enumerate() {
            if let Some(first) = ids[..number].iter().position(|earlier| earlier == id) {
                let message = format!("{} is listed twice", list[number].get_ref());
                let error = problems.add(list[number].span(), message);
                error.related(list[first].span(), "here");
                return None;
            }
        }
        let design = &self.suspension().design;
        // The order of the points in the list has no influence.
        let mut sorted = ids;
        sorted.sort_by_key(|id| id.0);
        let parts = if what == "plane" {
            off_plane(&sorted, design)
        } else {
            off_line(&sorted, design)
        };
        let Some(parts) = parts else {
            let message = match what {
                "plane" => {
                    "the points lie on one line in the design position, so they define no plane"
                }
                _ => "the points coincide in the design position, so they define no line",
            };
            return problems.refuse(names.span(), message);
        };
        let zero = Some(0.0);
        let parts = parts.into_iter().map(|of| self.limited(of, zero, zero));
        let list: Vec<&str> = list.iter().map(|name| name.get_ref().as_str()).collect();
        Some((
            format!("{} on one {what}", list.join(", ")),
            parts.collect(),
        ))
    }
}

/// Distances of points from the plane through those three that form the largest triangle. `None` if the points lie on one line.
fn off_plane(ids: &[PointId], design: &[Vector3<f64>]) -> Option<Vec<Measure>> {
    let at = |id: PointId| design[id.0];
    let area = |[a, b, c]: [PointId; 3]| (at(b) - at(a)).cross(at(c) - at(a)).norm();
    let triangles = ids.iter().enumerate().flat_map(|(k, c)| {
        let sides = ids[..k].iter().enumerate();
        sides.flat_map(move |(j, b)| ids[..j].iter().map(move |a| [*a, *b, *c]))
    });
    let [a, b, c] = first_largest(triangles, area)?;
    let sides = (at(b) - at(a)).norm() * (at(c) - at(a)).norm();
    if area([a, b, c]) <= DEGENERATE * sides {
        return None;
    }
    let others = ids.iter().filter(|id| ![a, b, c].contains(id));
    Some(others.map(|id| Measure::OffPlane([a, b, c, *id])).collect())
}

/// Distances of points from the line through those two that are farthest apart. Each distance has two components, so that it
/// is smooth. `None` if the points coincide.
fn off_line(ids: &[PointId], design: &[Vector3<f64>]) -> Option<Vec<Measure>> {
    let along = |[a, b]: [PointId; 2]| design[b.0] - design[a.0];
    let pairs = ids.iter().enumerate();
    let pairs = pairs.flat_map(|(k, b)| ids[..k].iter().map(move |a| [*a, *b]));
    let [a, b] = first_largest(pairs, |pair| along(pair).norm())?;
    let farthest = ids.iter().map(|id| design[id.0].norm()).fold(0.0, f64::max);
    if along([a, b]).norm() <= DEGENERATE * farthest {
        return None;
    }
    let size = along([a, b]).to_array().each(f64::abs);
    // The axis that is farthest from parallel to the line.
    let axis = (0..3).min_by(|a, b| size[*a].total_cmp(&size[*b]))?;
    let others = ids.iter().filter(|id| ![a, b].contains(id));
    let components = others.flat_map(|id| {
        let along = |is_second| Measure::OffLine([a, b, *id], Across { axis, is_second });
        [false, true].map(along)
    });
    Some(components.collect())
}

/// First of the candidates with the largest size.
fn first_largest<C: Copy>(
    candidates: impl Iterator<Item = C>,
    size: impl Fn(C) -> f64,
) -> Option<C> {
    let sized = candidates.map(|own| (own, size(own)));
    let largest = sized.reduce(|best, next| if next.1 > best.1 { next } else { best });
    largest.map(|(own, _)| own)
}
