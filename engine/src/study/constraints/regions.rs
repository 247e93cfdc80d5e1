//! Regions that a point must stay inside or outside, and rims that members must stay inside.

use super::super::Limited;
use super::super::error::Problems;
use super::super::file::{self, Coordinates};
use super::super::resolve::some;
use super::super::subject::{member, point};
use super::super::suspension::above_zero;
use super::super::value::Text;
use super::Reader;
use crate::characteristics::{Measure, Quantity};
use crate::model::{Axis, PointId, SpinAxis};
use crate::number::{Each, Vector3};
use std::ops::Range as Span;
use toml::Spanned;

impl Reader<'_> {
    pub(super) fn point(
        &self,
        name: &Text,
        problems: &mut Problems,
    ) -> Option<(String, Vec<Limited>)> {
        self.takes(&["inside", "outside", "clearance"], problems);
        let id = point(name, self.suspension(), problems);
        let (region, is_inside) = match (&self.written.inside, &self.written.outside) {
            (Some(region), None) => (region, true),
            (None, Some(region)) => (region, false),
            _ => {
                let message = "expected the key \"inside\" or the key \"outside\"";
                return problems.refuse(self.place.clone(), message);
            }
        };
        let gap = self.clearance(problems)?;
        let id = id?;
        let shape = region.get_ref();
        let given = [
            shape.corners.is_some(),
            shape.half_space.is_some(),
            shape.sphere.is_some(),
            shape.cylinder.is_some(),
            shape.rim.is_some(),
        ];
        if given.iter().filter(|g| **g).count() != 1 {
            let message = "expected one of the keys \"box\", \"half_space\", \"sphere\", \"cylinder\" and \"rim\"";
            return problems.refuse(region.span(), message);
        }
        let ends = [&shape.from, &shape.to];
        if shape.rim.is_none()
            && let Some(end) = ends.into_iter().flatten().next()
        {
            return problems.refuse(
                end.span.clone(),
                "the keys \"from\" and \"to\" can only be used with \"rim\"",
            );
        }
        if shape.rim.is_some() && self.is_on_spin_axis(id) {
            let message = format!(
                "{} lies on the spin axis, so its distance from this axis is always 0; expected a point off the axis",
                name.get_ref()
            );
            return problems.refuse(name.span(), message);
        }
        let (what, parts) = if is_inside {
            self.inside(id, shape, region.span(), gap, problems)?
        } else {
            self.outside(id, shape, region.span(), gap, problems)?
        };
        let word = if is_inside { "inside" } else { "outside" };
        Some((format!("{} {word} the {what}", name.get_ref()), parts))
    }

    /// A box, given by its centre and half its edges.
    fn corners(
        &self,
        corners: &Spanned<Vec<Coordinates>>,
        problems: &mut Problems,
    ) -> Option<[Vector3<f64>; 2]> {
        let [a, b] = corners.get_ref().as_slice() else {
            let message = format!("expected two corners, found {}", corners.get_ref().len());
            return problems.refuse(corners.span(), message);
        };
        let (a, b) = (self.vector(a, problems)?, self.vector(b, problems)?);
        let half = ((b - a) * 0.5).map(f64::abs);
        if half.to_array().contains(&0.0) {
            return problems.refuse(
                corners.span(),
                "the box has no volume: the corners agree in a coordinate",
            );
        }
        Some([(a + b) * 0.5, half])
    }

    /// A tube: centre of its axis, direction of the axis, half its length, and its radius.
    fn tube(
        &self,
        tube: &file::Cylinder,
        problems: &mut Problems,
    ) -> Option<(Vector3<f64>, Vector3<f64>, f64, f64)> {
        let (from, to) = (
            self.vector(&tube.from, problems)?,
            self.vector(&tube.to, problems)?,
        );
        let radius = above_zero(&tube.radius, problems)?;
        let length = (to - from).norm();
        if length == 0.0 {
            return problems.refuse(
                tube.to.span(),
                "the cylinder has no length: from and to coincide",
            );
        }
        let along = (to - from) * (1.0 / length);
        Some(((from + to) * 0.5, along, 0.5 * length, radius))
    }

    fn half_space(
        &self,
        id: PointId,
        space: &file::HalfSpace,
        problems: &mut Problems,
    ) -> Option<Measure> {
        let over = self.vector(&space.point, problems)?;
        let normal = self.vector(&space.normal, problems)?;
        let length = normal.norm();
        if length == 0.0 {
            return problems.refuse(space.normal.span(), "expected a normal other than 0");
        }
        Some(Measure::Height {
            point: id,
            over,
            normal: normal * (1.0 / length),
        })
    }

    fn inside(
        &self,
        id: PointId,
        shape: &file::Region,
        place: Span<usize>,
        gap: f64,
        problems: &mut Problems,
    ) -> Option<(&'static str, Vec<Limited>)> {
        let room =
            |room: f64, problems: &mut Problems| room_beside(room, gap, place.clone(), problems);
        if let Some(corners) = &shape.corners {
            let [middle, half] = self.corners(corners, problems)?;
            let mut parts = Vec::new();
            for axis in Axis::ALL {
                let (m, h) = (middle[axis], half[axis]);
                let h = room(h, problems)?;
                let of = Measure::Quantity(Quantity::Coordinate(id, axis));
                parts.push(self.limited(of, Some(m - h), Some(m + h)));
            }
            return Some(("box", parts));
        }
        if let Some(space) = &shape.half_space {
            let of = self.half_space(id, space, problems)?;
            return Some(("half-space", vec![self.limited(of, Some(gap), None)]));
        }
        if let Some(ball) = &shape.sphere {
            let radius = above_zero(&ball.radius, problems)?;
            let of = Measure::DistanceFrom(id, self.vector(&ball.centre, problems)?);
            let upper = room(radius, problems)?;
            return Some(("sphere", vec![self.limited(of, None, Some(upper))]));
        }
        if let Some(tube) = &shape.cylinder {
            let (middle, along, half, radius) = self.tube(tube, problems)?;
            let (radius, half) = (room(radius, problems)?, room(half, problems)?);
            let radial = Measure::FromLine {
                point: id,
                through: middle,
                along,
            };
            let axial = Measure::Height {
                point: id,
                over: middle,
                normal: along,
            };
            let parts = vec![
                self.limited(radial, None, Some(radius)),
                self.limited(axial, Some(-half), Some(half)),
            ];
            return Some(("cylinder", parts));
        }
        let rim = shape.rim.as_ref()?;
        let radius = above_zero(rim, problems)?;
        let radius = room(radius, problems)?;
        let [from, to] = rim_ends(shape, place, problems)?;
        let mut parts = vec![self.limited(Measure::FromSpinAxis(id), None, Some(radius))];
        if from.is_some() || to.is_some() {
            parts.push(self.limited(Measure::AlongSpinAxis(id), from, to));
        }
        Some(("rim", parts))
    }

    fn outside(
        &self,
        id: PointId,
        shape: &file::Region,
        place: Span<usize>,
        gap: f64,
        problems: &mut Problems,
    ) -> Option<(&'static str, Vec<Limited>)> {
        let (what, of, lower) = if let Some(corners) = &shape.corners {
            let [middle, half] = self.corners(corners, problems)?;
            let of = Measure::FromBox {
                point: id,
                middle,
                half,
            };
            ("box", of, gap)
        } else if let Some(space) = &shape.half_space {
            let of = self.half_space(id, space, problems)?;
            return Some(("half-space", vec![self.limited(of, None, Some(-gap))]));
        } else if let Some(ball) = &shape.sphere {
            let radius = above_zero(&ball.radius, problems)?;
            let of = Measure::DistanceFrom(id, self.vector(&ball.centre, problems)?);
            ("sphere", of, radius + gap)
        } else if let Some(tube) = &shape.cylinder {
            let (middle, along, half, radius) = self.tube(tube, problems)?;
            let of = Measure::FromTube {
                point: id,
                middle,
                along,
                half,
                radius,
            };
            ("cylinder", of, gap)
        } else {
            let message = "the key \"rim\" works with \"inside\" only";
            return problems.refuse(place, message);
        };
        Some((what, vec![self.limited(of, Some(lower), None)]))
    }

    /// Returns true if a point lies on the spin axis in the design position. Its distance from the axis then has no
    /// derivative.
    fn is_on_spin_axis(&self, PointId(point): PointId) -> bool {
        let suspension = self.suspension();
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let centre = design[mechanism.wheel_centre.0];
        let axis = match mechanism.spin_axis {
            SpinAxis::From(PointId(inner)) => centre - design[inner],
            SpinAxis::Along(axis) => axis,
        };
        let away = design[point] - centre;
        away.cross(axis).norm() <= 1e-9 * suspension.size() * axis.norm()
    }

    /// Reads members that must stay inside the rim. A straight member inside a round rim is closest to the rim at its ends. With
    /// `from`, the limit applies only outboard of this end of the rim: the point where the member enters the rim can replace its
    /// inner end. With `to`, the outer end of the member must be inboard of the rim's outer end.
    pub(super) fn members_inside(
        &self,
        names: &Spanned<Vec<Text>>,
        region: &Spanned<file::Region>,
        problems: &mut Problems,
    ) -> Option<(String, Vec<Limited>)> {
        self.takes(&["inside", "clearance", "radii"], problems);
        let shape = region.get_ref();
        let Some(rim) = &shape.rim else {
            let message = "members can stay inside a rim only; expected the key \"rim\": the radius of the rim";
            return problems.refuse(region.span(), message);
        };
        let [from, to] = rim_ends(shape, region.span(), problems)?;
        let radius = above_zero(rim, problems)?;
        let list = some(names, "member", problems)?;
        let gap = self.clearance(problems)?;
        let radii = self.radii(list.len(), problems)?;
        let design = &self.suspension().design;
        let mut parts = Vec::new();
        for (name, thick) in list.iter().zip(radii) {
            let mut ends = member(name, self.suspension(), problems)?;
            // Puts the outer end first.
            if design[ends[0].0].y < design[ends[1].0].y {
                ends.reverse();
            }
            let [outer, inner] = ends;
            let free = room_beside(radius, thick + gap, region.span(), problems)?;
            let upper = Some(free);
            let near = match from {
                Some(from) => self.limited(Measure::FromSpinAxisAt(ends, from), None, upper),
                None => self.limited(Measure::FromSpinAxis(inner), None, upper),
            };
            // A member that ends on the axis, like a drive shaft, has a limit only where it enters the rim.
            if !self.is_on_spin_axis(outer) {
                parts.push(self.limited(Measure::FromSpinAxis(outer), None, upper));
            }
            parts.push(near);
            if to.is_some() {
                parts.push(self.limited(Measure::AlongSpinAxis(outer), None, to));
            }
        }
        let list: Vec<&str> = list.iter().map(|name| name.get_ref().as_str()).collect();
        Some((format!("{} inside the rim", list.join(", ")), parts))
    }
}

/// Ends of a rim, as distances outboard of the wheel centre.
fn rim_ends(
    shape: &file::Region,
    place: Span<usize>,
    problems: &mut Problems,
) -> Option<[Option<f64>; 2]> {
    let ends = [&shape.from, &shape.to].each(|end| end.as_ref().map(|number| number.value));
    if let [Some(low), Some(high)] = ends
        && low >= high
    {
        let message = format!("from = {low} is not inboard of to = {high}");
        return problems.refuse(place, message);
    }
    Some(ends)
}

/// Subtracts a gap from a dimension of the region. Refuses a result that is not positive.
fn room_beside(room: f64, gap: f64, place: Span<usize>, problems: &mut Problems) -> Option<f64> {
    if room > gap {
        return Some(room - gap);
    }
    let message =
        format!("the region is empty: its dimension {room} is not above the clearance {gap}");
    problems.refuse(place, message)
}
