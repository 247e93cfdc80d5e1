//! `constraints` of `[optimise]`: limits that a design must satisfy.

mod joints;
mod regions;

use super::axle_targets::quantities_of_side;
use super::elastic_targets;
use super::error::Problems;
use super::file::{self, Constraint as Written, Coordinates};
use super::names::choose;
use super::outputs::characteristic;
use super::resolve::{Context, each};
use super::subject::{force, length, member, point, site};
use super::suspension::three;
use super::targets::refuse_keys_of_cars;
use super::value::{Number, Text};
use super::{AxleStudy, Constraint, Limited, Motion, Site};
use crate::ask::Unit;
use crate::characteristics::{Measure, Quantity};
use crate::compliance::KcValue;
use crate::mechanism::DEGENERATE;
use crate::model::{Axis, LengthUnit, Side, Suspension};
use crate::number::Vector3;
use std::ops::Range as Span;
use toml::Spanned;

/// Reads the constraints. `None` if one has an error.
pub(super) fn constraints(
    section: &file::Optimise,
    context: &Context,
    problems: &mut Problems,
) -> Option<Vec<Constraint>> {
    for own in section.constraints.iter().map(Spanned::get_ref) {
        refuse_keys_of_cars([&own.case, &own.axle], problems)?;
    }
    each_constraint(&section.constraints, context, problems)
}

/// Reads the constraints of a list.
pub(super) fn each_constraint<'w>(
    written: impl IntoIterator<Item = &'w Spanned<Written>>,
    context: &Context,
    problems: &mut Problems,
) -> Option<Vec<Constraint>> {
    let read = each(written, |written| {
        let reader = Reader {
            written: written.get_ref(),
            place: written.span(),
            context,
        };
        reader.constraint(problems)
    });
    Some(read?.into_iter().flatten().collect())
}

/// One constraint as written.
struct Reader<'a> {
    written: &'a Written,
    place: Span<usize>,
    context: &'a Context<'a>,
}

/// Keys of limits.
const LIMITS: [&str; 3] = ["between", "at_least", "at_most"];

/// Lower and upper limit, in the units of the file.
type Limits = [Option<f64>; 2];

impl Reader<'_> {
    /// Reads the constraint. With a motion of an axle there is one for each wheel.
    fn constraint(&self, problems: &mut Problems) -> Option<Vec<Constraint>> {
        let written = self.written;
        if let (Some(both), Some(name)) = (self.context.axle, &written.characteristic)
            && both.axle.elastic.is_some()
        {
            return self.of_elastic_axle(both, name, problems);
        }
        let sites = self.sites(problems)?;
        let is_design = match &written.at {
            None => false,
            Some(text) if text.get_ref() == "design" => true,
            Some(text) => {
                let message = format!("expected \"design\", found {:?}", text.get_ref());
                return problems.refuse(text.span(), message);
            }
        };
        let subjects = [
            written.length.is_some(),
            written.point.is_some(),
            written.members.is_some(),
            written.articulation.is_some(),
            written.plunge.is_some(),
            written.characteristic.is_some(),
            written.load.is_some(),
            written.coplanar.is_some(),
            written.line.is_some(),
        ];
        if subjects.iter().filter(|given| **given).count() != 1 {
            let message = "expected one of length, point, members, articulation, plunge, characteristic, load, \
                           coplanar and line";
            return problems.refuse(self.place.clone(), message);
        }
        let (name, parts) = if let Some(written) = &written.length {
            self.length(written, problems)?
        } else if let Some(name) = &written.characteristic {
            self.characteristic(name, problems)?
        } else if let Some(name) = &written.load {
            self.load(name, problems)?
        } else if let Some(name) = &written.articulation {
            self.articulation(name, problems)?
        } else if let Some(ends) = &written.plunge {
            self.plunge(ends, problems)?
        } else if let Some(names) = &written.members {
            self.members(names, problems)?
        } else if let Some(name) = &written.point {
            self.point(name, problems)?
        } else {
            self.aligned(problems)?
        };
        let mechanism = &self.suspension().mechanism;
        let is_of_pose = |part: &Limited| {
            let is_still = is_design && !matches!(part.of, Measure::Carried(_));
            !is_still && !part.of.is_fixed(mechanism) && !matches!(part.of, Measure::Elastic(_))
        };
        if self.context.is_elastic() && parts.iter().any(is_of_pose) {
            let message = match self.context.axle {
                None => {
                    "with [compliance] this constraint applies to the rigid mechanism: expected at = \"design\", or a \
                     characteristic or figure"
                }
                Some(_) => {
                    "with [compliance] this constraint applies to the rigid mechanism: expected at = \"design\"; a target with \
                     between, at_least or at_most limits quantities of an elastic axle"
                }
            };
            return problems.refuse(self.place.clone(), message);
        }
        let moves = || parts.iter().any(|part| !part.of.is_fixed(mechanism));
        let has_motion = is_design || sites.iter().all(|(_, site)| site.motion.is_some());
        if self.context.axle.is_some() && !has_motion && moves() {
            let message = "constraints of an axle hold through a named motion: expected motion = \"NAME\", with travel and \
                           rack (the left wheel), heave, or travel_left and travel_right in [motions.NAME]; or at = \"design\"";
            return problems.refuse(self.place.clone(), message);
        }
        // Without a named motion, a test figure is limited at the design height.
        let of_figure =
            |part: &Limited| matches!(part.of, Measure::Elastic(KcValue::Figure { .. }));
        let is_design = is_design || parts.iter().any(of_figure) && written.motion.is_none();
        let called = written.name.as_ref().map(|name| name.get_ref().clone());
        let name = called.unwrap_or(name);
        let of_wheel = |(side, site): (Option<Side>, Site)| Constraint {
            name: match side {
                Some(side) => format!("{name}, {} wheel", side.name()),
                None => name.clone(),
            },
            parts: parts.clone(),
            site: (!is_design).then_some(site),
        };
        Some(sites.into_iter().map(of_wheel).collect())
    }

    /// Limits of a quantity of an elastic axle in the design position, one for each wheel that has it.
    fn of_elastic_axle(
        &self,
        both: &AxleStudy,
        name: &Text,
        problems: &mut Problems,
    ) -> Option<Vec<Constraint>> {
        self.takes(&LIMITS, problems);
        let written = self.written;
        let places = [
            written.motion.as_ref().map(Text::span),
            written.rack.as_ref().map(Spanned::span),
            written
                .at
                .as_ref()
                .filter(|at| at.get_ref() != "design")
                .map(Text::span),
        ];
        if let Some(place) = places.into_iter().flatten().next() {
            let message = "limits of an elastic axle hold in the design position; a target with between, at_least or at_most \
                           holds over a motion";
            return problems.refuse(place, message);
        }
        let quantities = quantities_of_side(name, &written.side, &both.axle, problems)?;
        let limits = self.needed_limits(problems)?;
        let called = written.name.as_ref().map(|name| name.get_ref().clone());
        let called = called.unwrap_or_else(|| format!("{} {}", name.get_ref(), words(limits)));
        let constraint = |quantity: &crate::axle::Quantity| Constraint {
            name: match quantity.side() {
                Some(side) => format!("{called}, {} wheel", side.name()),
                None => called.clone(),
            },
            parts: vec![self.limited_as_printed(
                Measure::OfAxle(*quantity),
                quantity.info().unit,
                limits,
            )],
            site: None,
        };
        Some(quantities.iter().map(constraint).collect())
    }

    /// Motion and rack displacements of the constraint. A motion of an axle becomes a motion of each wheel, in the axes of a
    /// left wheel.
    fn sites(&self, problems: &mut Problems) -> Option<Vec<(Option<Side>, Site)>> {
        let written = self.written;
        let of_axle = written.motion.as_ref().zip(self.context.axle);
        let of_axle = of_axle.and_then(|(text, both)| {
            let named = both.motions.iter().find(|(name, _)| name == text.get_ref());
            Some((text, both, named?))
        });
        let side = match &written.side {
            None => None,
            Some(text) => {
                if of_axle.is_none() {
                    let message = "side needs a motion of an axle: heave, or travel_left and travel_right, in [motions.NAME]";
                    return problems.refuse(text.span(), message);
                }
                let sides = Side::ALL.map(|side| (side.name(), side));
                Some(choose(text, "side", &sides, problems)?)
            }
        };
        if let Some((text, both, _)) = of_axle
            && both.axle.is_rigid()
        {
            let message = "constraints of this axle hold in the design position: expected at = \"design\", and no motion";
            return problems.refuse(text.span(), message);
        }
        let Some((text, both, (name, motion))) = of_axle else {
            let site = site(&written.motion, &written.rack, self.context, problems)?;
            return Some(vec![(None, site)]);
        };
        if let Some(rack) = &written.rack {
            let message = format!("the motion {name} gives the rack; leave rack out");
            return problems.refuse(rack.span(), message);
        }
        let Some(travels) = motion.wheel_travels() else {
            let message = format!(
                "on a plane ground the travels of the wheels follow from the design, and a constraint needs them: expected \
                 heave on pads, or travel_left and travel_right, in [motions.{name}]"
            );
            return problems.refuse(text.span(), message);
        };
        if both.axle.right.is_some() && side != Some(Side::Left) {
            let message = "the right wheel has dimensions of its own, which constraints do not reach: expected side = \"left\"";
            return problems.refuse(self.place.clone(), message);
        }
        let sign = self.suspension().frame.sign(Axis::Y);
        let of_side = |side: Side| {
            // The right wheel is treated as a left wheel, so its rack moves with the opposite sign.
            let outwards = if side == Side::Left { sign } else { -sign };
            let racks: Vec<f64> = motion.racks.iter().map(|r| outwards * r + 0.0).collect();
            let motion = Motion {
                values: travels[side as usize].to_vec(),
                rack: racks.clone(),
                rack_moves: true,
                ..Motion::still()
            };
            Site {
                motion: Some((name.clone(), motion)),
                racks,
                axle: None,
            }
        };
        let sides = Side::ALL
            .into_iter()
            .filter(|own| side.is_none_or(|s| s == *own));
        Some(sides.map(|side| (Some(side), of_side(side))).collect())
    }

    fn suspension(&self) -> &Suspension {
        self.context.suspension
    }

    /// Length of 1 mm in the study's unit: the smallest visible length.
    fn length_scale(&self) -> f64 {
        self.suspension().length_unit.per_metre() / 1000.0
    }

    /// Reads `between`, `at_least` and `at_most`.
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
                    return problems.refuse(between.span(), message);
                };
                if written.at_least.is_some() || written.at_most.is_some() {
                    let message =
                        "between says both limits; expected it alone, or at_least and at_most";
                    return problems.refuse(between.span(), message);
                }
                [Some(low.value), Some(high.value)]
            }
        };
        if let [Some(low), Some(high)] = limits
            && low > high
        {
            let message = format!("the limits are reversed: {low} is above {high}");
            return problems.refuse(self.place.clone(), message);
        }
        Some(limits)
    }

    /// Reads limits. At least one is required.
    fn needed_limits(&self, problems: &mut Problems) -> Option<Limits> {
        let limits = self.limits(problems)?;
        if limits == [None, None] {
            let message = "expected a limit: between = [lower, upper], at_least or at_most";
            return problems.refuse(self.place.clone(), message);
        }
        Some(limits)
    }

    /// Refuses all keys that are not in `keys`.
    fn takes(&self, keys: &[&str], problems: &mut Problems) {
        self.refuse(|key| !keys.contains(&key), problems);
    }

    fn refuse(&self, is_refused: impl Fn(&str) -> bool, problems: &mut Problems) {
        let w = self.written;
        let number = |n: &Option<Number>| n.as_ref().map(|n| n.span.clone());
        let given = [
            ("kept", w.kept.as_ref().map(Spanned::span)),
            ("inside", w.inside.as_ref().map(Spanned::span)),
            ("outside", w.outside.as_ref().map(Spanned::span)),
            ("clearance", number(&w.clearance)),
            ("radii", w.radii.as_ref().map(Spanned::span)),
            ("between", w.between.as_ref().map(Spanned::span)),
            ("at_least", number(&w.at_least)),
            ("at_most", number(&w.at_most)),
        ];
        for (key, place) in given {
            if let Some(place) = place.filter(|_| is_refused(key)) {
                let message = format!("{key} has no meaning for this kind of constraint");
                problems.add(place, message);
            }
        }
    }

    fn length(
        &self,
        written: &Spanned<super::value::MemberName>,
        problems: &mut Problems,
    ) -> Option<(String, Vec<Limited>)> {
        self.takes(&["kept", "between", "at_least", "at_most"], problems);
        let (name, ends) = length(written, self.suspension(), problems)?;
        let kept = self.written.kept.as_ref().is_some_and(|k| *k.get_ref());
        let [lower, upper] = match kept {
            true => {
                self.refuse(|key| LIMITS.contains(&key), problems);
                let [a, b] = ends.map(|id| self.suspension().design[id.0]);
                [Some((a - b).norm()); 2]
            }
            false => self.needed_limits(problems)?,
        };
        let of = self.limited(Measure::Length(ends), lower, upper);
        let name = match kept {
            true => format!("length {name} kept"),
            false => format!("length {name} {}", words([lower, upper])),
        };
        Some((name, vec![of]))
    }

    fn characteristic(
        &self,
        name: &Text,
        problems: &mut Problems,
    ) -> Option<(String, Vec<Limited>)> {
        self.takes(&LIMITS, problems);
        let (of, unit) = match self.context.elastic {
            Some(elastic) => {
                let found = elastic_targets::quantity(name, elastic, self.suspension(), problems)?;
                let subject = found.subject(self.suspension().length_unit);
                (Measure::Elastic(found.value()), subject.unit)
            }
            None => {
                let found = characteristic(name, self.suspension(), problems)?;
                let quantity = Quantity::Characteristic(found);
                (Measure::Quantity(quantity), found.info().unit)
            }
        };
        let limits = self.needed_limits(problems)?;
        let name = format!("{} {}", name.get_ref(), words(limits));
        Some((name, vec![self.limited_as_printed(of, unit, limits)]))
    }

    /// A measure with limits in its printed unit.
    fn limited_as_printed(&self, of: Measure, unit: Unit, limits: Limits) -> Limited {
        let length = self.suspension().length_unit;
        let (visible, symbol) = visible_change(unit, length);
        let inside = |printed: f64| unit.from_printed(printed, length);
        let [lower, upper] = limits.map(|limit| limit.map(inside));
        Limited {
            of,
            lower,
            upper,
            scale: inside(visible),
            visible,
            unit: symbol,
        }
    }

    fn load(&self, name: &Text, problems: &mut Problems) -> Option<(String, Vec<Limited>)> {
        self.takes(&LIMITS, problems);
        let (force, sign) = force(name, self.context, problems)?;
        let limits = self.needed_limits(problems)?;
        let unit = self.suspension().length_unit;
        let [lower, upper] = limits.map(|limit| limit.map(|value| value * unit.newtons() * sign));
        let is_turned = sign < 0.0;
        let of = Limited {
            of: Measure::Carried(force),
            lower: if is_turned { upper } else { lower },
            upper: if is_turned { lower } else { upper },
            scale: 10.0 * unit.newtons(),
            visible: 10.0,
            unit: unit.force_symbol().to_owned(),
        };
        Some((format!("{} {}", name.get_ref(), words(limits)), vec![of]))
    }

    fn members(
        &self,
        names: &Spanned<Vec<Text>>,
        problems: &mut Problems,
    ) -> Option<(String, Vec<Limited>)> {
        if let Some(region) = &self.written.inside {
            return self.members_inside(names, region, problems);
        }
        self.takes(&["inside", "clearance", "radii"], problems);
        let [a, b] = names.get_ref().as_slice() else {
            let message = format!(
                "expected two members with a clearance, or inside = {{ rim = ... }}; found {}",
                names.get_ref().len()
            );
            return problems.refuse(names.span(), message);
        };
        let found = [a, b].map(|name| member(name, self.suspension(), problems));
        let [Some(first), Some(second)] = found else {
            return None;
        };
        if first.iter().any(|end| second.contains(end)) {
            let message = format!("{} and {} meet in a joint", a.get_ref(), b.get_ref());
            return problems.refuse(names.span(), message);
        }
        let radii = self.radii(2, problems)?;
        let gap = self.clearance(problems)?;
        let least = radii[0] + radii[1] + gap;
        let of = self.limited(Measure::Clearance([first, second]), Some(least), None);
        let name = format!("clearance of {} and {}", a.get_ref(), b.get_ref());
        Some((name, vec![of]))
    }

    /// Radii of `count` members. All zero if none are given.
    fn radii(&self, count: usize, problems: &mut Problems) -> Option<Vec<f64>> {
        let Some(radii) = &self.written.radii else {
            return Some(vec![0.0; count]);
        };
        let numbers: Vec<f64> = radii.get_ref().iter().map(|r| r.value).collect();
        if numbers.len() == count && numbers.iter().all(|r| *r >= 0.0) {
            return Some(numbers);
        }
        let message = format!("expected {count} radii, one for each member, none negative");
        problems.refuse(radii.span(), message)
    }

    fn clearance(&self, problems: &mut Problems) -> Option<f64> {
        match &self.written.clearance {
            None => Some(0.0),
            Some(gap) if gap.value >= 0.0 => Some(gap.value),
            Some(gap) => {
                let message = format!("expected a clearance from 0 up, found {}", gap.value);
                problems.refuse(gap.span.clone(), message)
            }
        }
    }

    fn vector(&self, written: &Coordinates, problems: &mut Problems) -> Option<Vector3<f64>> {
        let v = three(written, "coordinates", problems)?;
        Some(self.suspension().frame.vector(v))
    }

    /// A length with limits.
    fn limited(&self, of: Measure, lower: Option<f64>, upper: Option<f64>) -> Limited {
        Limited {
            of,
            lower,
            upper,
            scale: self.length_scale(),
            visible: self.length_scale(),
            unit: self.suspension().length_unit.symbol().to_owned(),
        }
    }

    /// Reads `coplanar` and `line`.
    fn aligned(&self, problems: &mut Problems) -> Option<(String, Vec<Limited>)> {
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
                "expected at least {least} points of a {what}, found {}: fewer always are on one",
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
                "the first {} points do not define a {what} in the design position; begin with others",
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
                .map(f64::abs);
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

/// Describes limits in words.
fn words(limits: Limits) -> String {
    match limits {
        [Some(low), Some(high)] if low == high => format!("equal to {low}"),
        [Some(low), Some(high)] => format!("between {low} and {high}"),
        [Some(low), None] => format!("at least {low}"),
        [None, Some(high)] => format!("at most {high}"),
        [None, None] => String::new(),
    }
}

/// Change of a printed value that counts as 1 in the rows of a tuning: a visible change. Also returns its unit in words.
pub(super) fn visible_change(unit: Unit, length: LengthUnit) -> (f64, String) {
    let millimetre = length.per_metre() / 1000.0;
    let symbol = length.symbol();
    let (force, (_, lever)) = (length.force_symbol(), length.lever());
    match unit {
        Unit::Angle => (1.0, "deg".to_owned()),
        Unit::Length => (millimetre, symbol.to_owned()),
        Unit::AnglePerLength => (1e-3 / millimetre, format!("deg/{symbol}")),
        Unit::LengthPerAngle => (millimetre, format!("{symbol}/deg")),
        Unit::Percent => (1.0, "%".to_owned()),
        Unit::Ratio | Unit::AnglePerAngle => (0.01, "1".to_owned()),
        Unit::Force => (1.0, force.to_owned()),
        Unit::ForcePerLength => (1.0 / millimetre, format!("{force}/{symbol}")),
        Unit::Torque => (1.0, format!("{force} {lever}")),
        Unit::TorquePerAngle => (1.0, format!("{force} {lever}/deg")),
        Unit::Frequency => (0.01, "Hz".to_owned()),
        Unit::AnglePerForce => (0.001, "deg/kN".to_owned()),
        Unit::LengthPerForce => (0.01 * millimetre, format!("{symbol}/kN")),
        Unit::AnglePerTorque => (0.001, "deg/(100 N m)".to_owned()),
        Unit::Stiffness => (1.0, "N/mm".to_owned()),
        Unit::AnglePerG => (0.01, "deg per g".to_owned()),
    }
}
