//! `constraints` of `[optimise]`: limits that a design must satisfy.

mod aligned;
mod joints;
mod limits;
mod of_axle;
mod regions;

use super::elastic_targets;
use super::error::Problems;
use super::file::{self, Constraint as Written, Coordinates};
use super::outputs::characteristic;
use super::resolve::{Context, each};
use super::subject::{force, length, pair};
use super::suspension::three;
use super::targets::refuse_keys_of_cars;
use super::value::Text;
use super::{Constraint, Limited, Site};
use crate::ask::Unit;
use crate::characteristics::{Measure, Quantity};
use crate::compliance::KcValue;
use crate::model::{LengthUnit, Side, Suspension};
use crate::number::{Each, Vector3};
pub use joints::named_joints;
pub(super) use joints::{check_studs, joint_angle};
use limits::{LIMITS, Limits, words};
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

impl Reader<'_> {
    /// Reads the constraint. With a motion of an axle, the result has one constraint for each wheel.
    fn constraint(&self, problems: &mut Problems) -> Option<Vec<Constraint>> {
        let written = self.written;
        if let (Some(both), Some(name)) = (self.context.axle, &written.characteristic)
            && (both.axle.elastic.is_some() || both.axle.is_rigid())
        {
            return self.of_whole_axle(both, name, problems);
        }
        let sites = self.sites(problems)?;
        let is_design = self.is_of_design(problems)?;
        let (name, parts) = self.subject(problems)?;
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
            let message = "a constraint of an axle needs a named motion or at = \"design\": \
                           expected motion = \"NAME\". In [motions.NAME] give travel and rack \
                           (the left wheel), heave, or travel_left and travel_right";
            return problems.refuse(self.place.clone(), message);
        }
        // Without a named motion, limits of a test result apply at the design height.
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

    /// Returns true if the constraint applies only to the design position.
    fn is_of_design(&self, problems: &mut Problems) -> Option<bool> {
        match &self.written.at {
            None => Some(false),
            Some(text) if text.get_ref() == "design" => Some(true),
            Some(text) => {
                let message = format!("expected \"design\", found {:?}", text.get_ref());
                problems.refuse(text.span(), message)
            }
        }
    }

    /// Reads the subject of the constraint: its name, and its parts with limits.
    fn subject(&self, problems: &mut Problems) -> Option<(String, Vec<Limited>)> {
        let written = self.written;
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
        if let Some(written) = &written.length {
            self.length(written, problems)
        } else if let Some(name) = &written.characteristic {
            self.characteristic(name, problems)
        } else if let Some(name) = &written.load {
            self.load(name, problems)
        } else if let Some(name) = &written.articulation {
            self.articulation(name, problems)
        } else if let Some(ends) = &written.plunge {
            self.plunge(ends, problems)
        } else if let Some(names) = &written.members {
            self.members(names, problems)
        } else if let Some(name) = &written.point {
            self.point(name, problems)
        } else {
            self.aligned(problems)
        }
    }

    fn suspension(&self) -> &Suspension {
        self.context.suspension
    }

    /// Length of 1 mm in the study's unit: the smallest change of a length that a user would notice.
    fn length_scale(&self) -> f64 {
        self.suspension().length_unit.per_metre() / 1000.0
    }

    fn length(
        &self,
        written: &Spanned<super::value::MemberName>,
        problems: &mut Problems,
    ) -> Option<(String, Vec<Limited>)> {
        self.takes(&["kept", "between", "at_least", "at_most"], problems);
        let (name, ends) = length(written, self.suspension(), problems)?;
        let kept = self.written.kept.as_ref().is_some_and(|k| *k.get_ref());
        let [lower, upper] = if kept {
            self.refuse(|key| LIMITS.contains(&key), problems);
            let [a, b] = ends.each(|id| self.suspension().design[id.0]);
            [Some((a - b).norm()); 2]
        } else {
            self.needed_limits(problems)?
        };
        let of = self.limited(Measure::Length(ends), lower, upper);
        let name = if kept {
            format!("length {name} kept")
        } else {
            format!("length {name} {}", words([lower, upper]))
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

    /// A measure with limits in the unit of printed results.
    fn limited_as_printed(&self, of: Measure, unit: Unit, limits: Limits) -> Limited {
        let length = self.suspension().length_unit;
        let (visible, symbol) = visible_change(unit, length);
        let inside = |printed: f64| unit.from_printed(printed, length);
        let [lower, upper] = limits.each(|limit| limit.map(inside));
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
        let [lower, upper] = limits.each(|limit| limit.map(|value| value * unit.newtons() * sign));
        let is_turned = sign < 0.0;
        let (visible, symbol) = visible_change(Unit::Force, unit);
        let of = Limited {
            of: Measure::Carried(force),
            lower: if is_turned { upper } else { lower },
            upper: if is_turned { lower } else { upper },
            scale: visible * unit.newtons(),
            visible,
            unit: symbol,
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
        let expected = "two members with a clearance, or inside = { rim = ... }";
        let ([a, b], both) = pair(names, expected, self.suspension(), problems)?;
        let radii = self.radii(2, problems)?;
        let gap = self.clearance(problems)?;
        let least = radii[0] + radii[1] + gap;
        let of = self.limited(Measure::Clearance(both), Some(least), None);
        let name = format!("clearance of {a} and {b}");
        Some((name, vec![of]))
    }

    /// Radii of `count` members. All are zero if the study gives no radii.
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
                let message = format!("expected a clearance of 0 or more, found {}", gap.value);
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
}

/// Returns a change of a printed value that a user would notice, and its unit in words. A tuning divides deviations from
/// limits by this change.
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
        Unit::Force => (10.0, force.to_owned()),
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
