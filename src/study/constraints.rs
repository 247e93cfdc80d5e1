//! `constraints` of `[optimise]`: what must hold.

use super::error::Problems;
use super::file::{self, Constraint as Written, Coordinates};
use super::outputs::characteristic;
use super::resolve::Context;
use super::subject::{length, member, point, site};
use super::suspension::above_zero;
use super::value::{Number, Text};
use super::{Constraint, Limited};
use crate::characteristics::{Measure, Quantity, Stud, Unit};
use crate::model::{Axis, Body, Constraint as Holds, PointId, SteeringAxis, Suspension};
use crate::number::Vector3;
use std::ops::Range as Span;
use toml::Spanned;

/// The constraints, if nothing is wrong with them.
pub(super) fn constraints(
    section: &file::Optimise,
    context: &Context,
    problems: &mut Problems,
) -> Option<Vec<Constraint>> {
    let resolved: Vec<_> = section
        .constraints
        .iter()
        .map(|written| {
            let reader = Reader {
                written: written.get_ref(),
                place: written.span(),
                context,
            };
            reader.constraint(problems)
        })
        .collect();
    resolved.into_iter().collect()
}

/// One constraint as written.
struct Reader<'a> {
    written: &'a Written,
    place: Span<usize>,
    context: &'a Context<'a>,
}

/// Lower and upper limit, in the units of the file.
type Limits = [Option<f64>; 2];

impl Reader<'_> {
    fn constraint(&self, problems: &mut Problems) -> Option<Constraint> {
        let written = self.written;
        let site = site(&written.motion, &written.rack, self.context, problems)?;
        let is_design = match &written.at {
            None => false,
            Some(text) if text.get_ref() == "design" => true,
            Some(text) => {
                let message = format!("expected \"design\", found {:?}", text.get_ref());
                problems.add(text.span(), message);
                return None;
            }
        };
        let subjects = [
            written.length.is_some(),
            written.point.is_some(),
            written.members.is_some(),
            written.articulation.is_some(),
            written.characteristic.is_some(),
            written.coplanar.is_some(),
            written.line.is_some(),
        ];
        if subjects.iter().filter(|given| **given).count() != 1 {
            let message = "expected one of length, point, members, articulation, characteristic, \
                           coplanar and line";
            problems.add(self.place.clone(), message);
            return None;
        }
        let (name, parts) = if let Some(written) = &written.length {
            self.length(written, problems)?
        } else if let Some(name) = &written.characteristic {
            self.characteristic(name, problems)?
        } else if let Some(name) = &written.articulation {
            self.articulation(name, problems)?
        } else if let Some(names) = &written.members {
            self.members(names, problems)?
        } else if let Some(name) = &written.point {
            self.point(name, problems)?
        } else {
            self.aligned(problems)?
        };
        let mechanism = &self.suspension().mechanism;
        let moves = || parts.iter().any(|part| !part.of.is_fixed(mechanism));
        if self.context.axle.is_some() && !is_design && moves() {
            let message = "what changes along the motion of an axle cannot be a constraint; expected at = \"design\": \
                           in the design position, of the left wheel";
            problems.add(self.place.clone(), message);
            return None;
        }
        let called = written.name.as_ref().map(|name| name.get_ref().clone());
        Some(Constraint {
            name: called.unwrap_or(name),
            parts,
            site: (!is_design).then_some(site),
        })
    }

    fn suspension(&self) -> &Suspension {
        self.context.suspension
    }

    /// A length that anybody would see, and what it is called.
    fn length_scale(&self) -> (f64, String) {
        let unit = self.suspension().length_unit;
        (unit.per_metre() / 1000.0, "mm".to_owned())
    }

    /// `between`, `at_least` and `at_most`.
    fn limits(&self, problems: &mut Problems) -> Option<Limits> {
        let written = self.written;
        let value = |number: &Option<Number>| number.as_ref().map(|n| n.value);
        let limits = match &written.between {
            None => [value(&written.at_least), value(&written.at_most)],
            Some(between) => {
                let [low, high] = between.get_ref().as_slice() else {
                    let message = format!(
                        "expected two limits [lower, upper], found {}",
                        between.get_ref().len()
                    );
                    problems.add(between.span(), message);
                    return None;
                };
                if written.at_least.is_some() || written.at_most.is_some() {
                    let message =
                        "between says both limits; expected it alone, or at_least and at_most";
                    problems.add(between.span(), message);
                    return None;
                }
                [Some(low.value), Some(high.value)]
            }
        };
        if let [Some(low), Some(high)] = limits
            && low > high
        {
            let message = format!("the limits are reversed: {low} is above {high}");
            problems.add(self.place.clone(), message);
            return None;
        }
        Some(limits)
    }

    /// Limits of which there must be some.
    fn needed_limits(&self, problems: &mut Problems) -> Option<Limits> {
        let limits = self.limits(problems)?;
        if limits == [None, None] {
            let message = "expected a limit: between = [lower, upper], at_least or at_most";
            problems.add(self.place.clone(), message);
            return None;
        }
        Some(limits)
    }

    /// What the constraint does not read, if it is there.
    fn refuse(&self, keys: &[&str], problems: &mut Problems) {
        let w = self.written;
        let number = |n: &Option<Number>| n.as_ref().map(|n| n.span.clone());
        for key in keys {
            let found = match *key {
                "kept" => w.kept.as_ref().map(Spanned::span),
                "inside" => w.inside.as_ref().map(Spanned::span),
                "outside" => w.outside.as_ref().map(Spanned::span),
                "clearance" => number(&w.clearance),
                "radii" => w.radii.as_ref().map(Spanned::span),
                "between" => w.between.as_ref().map(Spanned::span),
                "at_least" => number(&w.at_least),
                "at_most" => number(&w.at_most),
                _ => None,
            };
            if let Some(place) = found {
                let message = format!("{key} says nothing of this kind of constraint");
                problems.add(place, message);
            }
        }
    }

    fn length(
        &self,
        written: &Spanned<super::value::MemberName>,
        problems: &mut Problems,
    ) -> Option<(String, Vec<Limited>)> {
        self.refuse(&["inside", "outside", "clearance", "radii"], problems);
        let (name, ends) = length(written, self.suspension(), problems)?;
        let kept = self.written.kept.as_ref().is_some_and(|k| *k.get_ref());
        let [lower, upper] = match kept {
            true => {
                self.refuse(&["between", "at_least", "at_most"], problems);
                let [a, b] = ends.map(|id| self.suspension().design[id.0]);
                [Some((a - b).norm()); 2]
            }
            false => self.needed_limits(problems)?,
        };
        let (scale, unit) = self.length_scale();
        let of = Limited {
            of: Measure::Length(ends),
            lower,
            upper,
            scale,
            unit,
        };
        let name = match kept {
            true => format!("length {name} as it is"),
            false => format!("length {name} {}", words([lower, upper])),
        };
        Some((name, vec![of]))
    }

    fn characteristic(
        &self,
        name: &Text,
        problems: &mut Problems,
    ) -> Option<(String, Vec<Limited>)> {
        self.refuse(
            &["kept", "inside", "outside", "clearance", "radii"],
            problems,
        );
        let found = characteristic(name, self.suspension(), problems)?;
        let limits = self.needed_limits(problems)?;
        let unit = found.info().unit;
        let visible = match unit {
            Unit::Angle => 1.0,
            Unit::Length => self.length_scale().0,
            Unit::AnglePerLength => 1e-3 / self.length_scale().0,
            Unit::Percent => 1.0,
            Unit::Ratio => 0.01,
        };
        let symbol = match unit {
            Unit::Angle => "deg",
            Unit::Length => "mm",
            Unit::AnglePerLength => "0.001 deg/mm",
            Unit::Percent => "%",
            Unit::Ratio => "0.01",
        };
        let [lower, upper] = limits.map(|limit| limit.map(|value| unit.from_printed(value)));
        let of = Limited {
            of: Measure::Quantity(Quantity::Characteristic(found)),
            lower,
            upper,
            scale: unit.from_printed(visible),
            unit: symbol.to_owned(),
        };
        Some((format!("{} {}", name.get_ref(), words(limits)), vec![of]))
    }

    fn members(
        &self,
        names: &Spanned<Vec<Text>>,
        problems: &mut Problems,
    ) -> Option<(String, Vec<Limited>)> {
        let keys = [
            "kept", "inside", "outside", "between", "at_least", "at_most",
        ];
        self.refuse(&keys, problems);
        let [a, b] = names.get_ref().as_slice() else {
            let message = format!("expected two members, found {}", names.get_ref().len());
            problems.add(names.span(), message);
            return None;
        };
        let found = [a, b].map(|name| member(name, self.suspension(), problems));
        let [Some(first), Some(second)] = found else {
            return None;
        };
        if first.iter().any(|end| second.contains(end)) {
            let message = format!("{} and {} meet in a joint", a.get_ref(), b.get_ref());
            problems.add(names.span(), message);
            return None;
        }
        let radii = match &self.written.radii {
            None => [0.0; 2],
            Some(radii) => match radii.get_ref().as_slice() {
                [a, b] if a.value >= 0.0 && b.value >= 0.0 => [a.value, b.value],
                _ => {
                    let message = "expected two radii, not negative";
                    problems.add(radii.span(), message);
                    return None;
                }
            },
        };
        let gap = self.clearance(problems)?;
        let (scale, unit) = self.length_scale();
        let of = Limited {
            of: Measure::Clearance([first, second]),
            lower: Some(radii[0] + radii[1] + gap),
            upper: None,
            scale,
            unit,
        };
        let name = format!("clearance of {} and {}", a.get_ref(), b.get_ref());
        Some((name, vec![of]))
    }

    fn clearance(&self, problems: &mut Problems) -> Option<f64> {
        match &self.written.clearance {
            None => Some(0.0),
            Some(gap) if gap.value >= 0.0 => Some(gap.value),
            Some(gap) => {
                let message = format!("expected a clearance from 0 up, found {}", gap.value);
                problems.add(gap.span.clone(), message);
                None
            }
        }
    }

    fn vector(&self, written: &Coordinates, problems: &mut Problems) -> Option<Vector3<f64>> {
        let [x, y, z] = written.get_ref().as_slice() else {
            let message = format!(
                "expected three coordinates, found {}",
                written.get_ref().len()
            );
            problems.add(written.span(), message);
            return None;
        };
        let v = Vector3::new(x.value, y.value, z.value);
        Some(self.suspension().frame.vector(v))
    }

    fn point(&self, name: &Text, problems: &mut Problems) -> Option<(String, Vec<Limited>)> {
        self.refuse(
            &["kept", "radii", "between", "at_least", "at_most"],
            problems,
        );
        let id = point(name, self.suspension(), problems);
        let (region, is_inside) = match (&self.written.inside, &self.written.outside) {
            (Some(region), None) => (region, true),
            (None, Some(region)) => (region, false),
            _ => {
                let message = "expected inside or outside: where the point stays, or does not go";
                problems.add(self.place.clone(), message);
                return None;
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
            let message = "expected one of box, half_space, sphere, cylinder and rim";
            problems.add(region.span(), message);
            return None;
        }
        let ends = [&shape.from, &shape.to];
        if shape.rim.is_none()
            && let Some(end) = ends.into_iter().flatten().next()
        {
            problems.add(end.span.clone(), "from and to belong to rim");
            return None;
        }
        let spin_axis = ["wheel_centre", "spindle_inner"];
        if shape.rim.is_some() && spin_axis.contains(&name.get_ref().as_str()) {
            let message = format!(
                "{} lies on the spin axis, so nothing moves it out of the rim; expected a point that may come near it",
                name.get_ref()
            );
            problems.add(name.span(), message);
            return None;
        }
        let (what, parts) = match is_inside {
            true => self.inside(id, shape, region.span(), gap, problems)?,
            false => self.outside(id, shape, region.span(), gap, problems)?,
        };
        let word = if is_inside { "inside" } else { "outside" };
        Some((format!("{} {word} the {what}", name.get_ref()), parts))
    }

    fn limited(&self, of: Measure, lower: Option<f64>, upper: Option<f64>) -> Limited {
        let (scale, unit) = self.length_scale();
        Limited {
            of,
            lower,
            upper,
            scale,
            unit,
        }
    }

    /// A box as its middle and half its edges.
    fn corners(
        &self,
        corners: &Spanned<Vec<Coordinates>>,
        problems: &mut Problems,
    ) -> Option<[Vector3<f64>; 2]> {
        let [a, b] = corners.get_ref().as_slice() else {
            let message = format!("expected two corners, found {}", corners.get_ref().len());
            problems.add(corners.span(), message);
            return None;
        };
        let (a, b) = (self.vector(a, problems)?, self.vector(b, problems)?);
        let half = ((b - a) * 0.5).map(f64::abs);
        if half.to_array().contains(&0.0) {
            problems.add(
                corners.span(),
                "the box has no volume: the corners agree in a coordinate",
            );
            return None;
        }
        Some([(a + b) * 0.5, half])
    }

    /// A tube: the middle of its axis, the direction and half its length.
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
            problems.add(
                tube.to.span(),
                "the cylinder has no length: from and to are one point",
            );
            return None;
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
            problems.add(space.normal.span(), "a normal has a length");
            return None;
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
        let room = |room: f64, problems: &mut Problems| {
            if room > gap {
                return Some(room - gap);
            }
            let message = format!("there is no room: {room} with a clearance of {gap}");
            problems.add(place.clone(), message);
            None
        };
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
        let end = |end: &Option<Number>| end.as_ref().map(|number| number.value);
        let (from, to) = (end(&shape.from), end(&shape.to));
        if let (Some(low), Some(high)) = (from, to)
            && low >= high
        {
            let message = format!("from = {low} is not inboard of to = {high}");
            problems.add(place, message);
            return None;
        }
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
            let message = "a rim has an inside only; what is outside of it is left of a wheel";
            problems.add(place, message);
            return None;
        };
        Some((what, vec![self.limited(of, Some(lower), None)]))
    }

    fn articulation(&self, name: &Text, problems: &mut Problems) -> Option<(String, Vec<Limited>)> {
        let keys = [
            "kept",
            "inside",
            "outside",
            "clearance",
            "radii",
            "between",
            "at_least",
        ];
        self.refuse(&keys, problems);
        let suspension = self.suspension();
        let mechanism = &suspension.mechanism;
        let joint = point(name, suspension, problems)?;
        let Some(most) = &self.written.at_most else {
            let message = "articulation needs at_most: the largest angle, in degrees";
            problems.add(self.place.clone(), message);
            return None;
        };
        if !(most.value > 0.0 && most.value < 90.0) {
            let message = format!("expected an angle between 0 and 90, found {}", most.value);
            problems.add(most.span.clone(), message);
            return None;
        }
        let stud = self.stud(name, joint, problems)?;
        let angle = most.value.to_radians();
        let degree = 1.0_f64.to_radians();
        let arm = mechanism.arms.iter().find(|arm| arm.outer == joint);
        let rod = mechanism.constraints.iter().find_map(|c| match *c {
            Holds::Link { inner, outer } if outer == joint => Some(inner),
            _ => None,
        });
        let part = match (arm, rod) {
            (Some(arm), _) if mechanism.body(joint) == Body::Knuckle => Limited {
                of: Measure::BallJoint {
                    joint,
                    axis: [arm.front, arm.rear],
                    stud,
                },
                lower: None,
                // Half the angle's sine does not cancel: 1 - cos a = 2 sin^2(a/2).
                upper: Some(2.0 * (0.5 * angle).sin().powi(2)),
                scale: angle.sin() * degree,
                unit: "deg".to_owned(),
            },
            (None, Some(other)) => Limited {
                of: Measure::RodEnd {
                    rod: [joint, other],
                    stud,
                },
                lower: Some(-angle),
                upper: Some(angle),
                scale: degree,
                unit: "deg".to_owned(),
            },
            _ => {
                let message = format!(
                    "{} is no joint of the wheel carrier with an arm or a rod",
                    name.get_ref()
                );
                problems.add(name.span(), message);
                return None;
            }
        };
        let name = format!(
            "articulation of {} at most {} deg",
            name.get_ref(),
            most.value
        );
        Some((name, vec![part]))
    }

    /// The stud of a joint: as the study has it, or along the steering axis.
    fn stud(&self, name: &Text, joint: PointId, problems: &mut Problems) -> Option<Stud> {
        let mechanism = &self.suspension().mechanism;
        let studs = &self.context.file.suspension.studs;
        let given = studs
            .iter()
            .find(|(key, _)| key.get_ref() == name.get_ref());
        if let Some((_, direction)) = given {
            let along = self.vector(direction, problems)?;
            if along.norm() == 0.0 {
                problems.add(direction.span(), "a stud has a direction");
                return None;
            }
            return Some(Stud::Along(along * (1.0 / along.norm())));
        }
        match mechanism.steering_axis {
            Some(SteeringAxis::Through { lower, upper }) => Some(Stud::Between(lower, upper)),
            _ => {
                let message = format!(
                    "the direction of the stud of {} is not known: {} has no steering axis through \
                     two joints",
                    mechanism.name(joint),
                    mechanism.topology.name
                );
                let error = problems.add(name.span(), message);
                error.help(format!(
                    "[suspension.studs] {} = [0.0, 0.0, 1.0]",
                    mechanism.name(joint)
                ));
                None
            }
        }
    }

    /// `coplanar` and `line`.
    fn aligned(&self, problems: &mut Problems) -> Option<(String, Vec<Limited>)> {
        let keys = [
            "kept",
            "inside",
            "outside",
            "clearance",
            "radii",
            "between",
            "at_least",
            "at_most",
        ];
        self.refuse(&keys, problems);
        let written = self.written;
        let (names, least, what) = match (&written.coplanar, &written.line) {
            (Some(names), _) => (names, 4, "plane"),
            (None, Some(names)) => (names, 3, "line"),
            (None, None) => return None,
        };
        let list = names.get_ref();
        if list.len() < least {
            let message = format!(
                "expected at least {least} points of a {what}, found {}: fewer always are on one",
                list.len()
            );
            problems.add(names.span(), message);
            return None;
        }
        let ids: Vec<Option<PointId>> = list
            .iter()
            .map(|name| point(name, self.suspension(), problems))
            .collect();
        let ids: Vec<PointId> = ids.into_iter().collect::<Option<_>>()?;
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
                .map(f64::abs);
            // The two axes that are least along the line: the others follow.
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

/// Limits in words.
fn words(limits: Limits) -> String {
    match limits {
        [Some(low), Some(high)] if low == high => format!("equal to {low}"),
        [Some(low), Some(high)] => format!("between {low} and {high}"),
        [Some(low), None] => format!("at least {low}"),
        [None, Some(high)] => format!("at most {high}"),
        [None, None] => String::new(),
    }
}
