//! Constraints that keep points on one plane or line.

use super::super::Limited;
use super::super::error::Problems;
use super::super::resolve::each;
use super::super::subject::point;
use super::Reader;
use crate::characteristics::Measure;
use crate::mechanism::DEGENERATE;
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
                "expected at least {least} points of a {what}, found {}: fewer always lie on one",
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
        let leading: Vec<_> = ids[..least - 1]
            .iter()
            .map(|id| self.suspension().design[id.0])
            .collect();
        if !span_a_flat(&leading) {
            let message = format!(
                "the first {} points do not define a {what} in the design position; list other points first",
                least - 1
            );
            return problems.refuse(names.span(), message);
        }
        let zero = Some(0.0);
        let mut parts = Vec::new();
        if what == "plane" {
            for id in &ids[3..] {
                let of = Measure::OffPlane([ids[0], ids[1], ids[2], *id]);
                parts.push(self.limited(of, zero, zero));
            }
        } else {
            let design = &self.suspension().design;
            let along = (design[ids[1].0] - design[ids[0].0])
                .to_array()
                .each(f64::abs);
            // The line has its largest component along `most`. Conditions in the two other axes are sufficient.
            let most = (0..3).max_by(|a, b| along[*a].total_cmp(&along[*b]))?;
            for id in &ids[2..] {
                for axis in (0..3).filter(|axis| *axis != most) {
                    let of = Measure::OffLine([ids[0], ids[1], *id], axis);
                    parts.push(self.limited(of, zero, zero));
                }
            }
        }
        let list: Vec<&str> = list.iter().map(|name| name.get_ref().as_str()).collect();
        Some((format!("{} on one {what}", list.join(", ")), parts))
    }
}

/// Returns true if two points define a line, or if three define a plane, in double precision.
fn span_a_flat(points: &[Vector3<f64>]) -> bool {
    let along = points[1] - points[0];
    let farthest = points.iter().map(|p| p.norm()).fold(0.0, f64::max);
    let is_line = along.norm() > DEGENERATE * farthest;
    is_line
        && points.get(2).is_none_or(|third| {
            let other = *third - points[0];
            along.cross(other).norm() > DEGENERATE * along.norm() * other.norm()
        })
}
