//! Subjects of targets and constraints: characteristics, coordinates of points, lengths, members and forces. Also their motions.

use super::error::Problems;
use super::members::axis;
use super::names::choose;
use super::outputs::characteristic;
use super::resolve::Context;
use super::value::{MemberName, Numbers, Text};
use super::{Site, TargetKind, TargetQuantity, file, named_motions};
use crate::analyse::{Support, members as carriers};
use crate::ask::Unit;
use crate::characteristics::{CarriedForce, Measure, Quantity};
use crate::model::{Constraint, PointId, Suspension};
use crate::number::Each;
use toml::Spanned;

/// Point of the study: a hardpoint or an extra point. Points of a solid axle's far half (the half of the other wheel) are
/// excluded.
pub(super) fn point(
    text: &Text,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<PointId> {
    let points = suspension.mechanism.points.iter().enumerate();
    let points = points.map(|(i, p)| (p.name.as_str(), PointId(i)));
    let points: Vec<_> = points
        .filter(|(_, id)| !suspension.mechanism.is_far(*id))
        .collect();
    choose(text, "point", &points, problems)
}

/// Members of a suspension, with the names from the columns of loads: rods, legs of arms (from a pivot to the outer joint),
/// spring. The drive shaft between two extra points is included.
pub fn named_members(suspension: &Suspension) -> Vec<(String, [PointId; 2])> {
    let mechanism = &suspension.mechanism;
    let mut members: Vec<(String, [PointId; 2])> = Vec::new();
    for constraint in &mechanism.constraints {
        if let Some((inner, outer)) = constraint
            .link()
            .filter(|(inner, _)| !mechanism.is_far(*inner))
        {
            members.push((mechanism.link_name(inner).to_owned(), [inner, outer]));
        }
        if let Constraint::StrutLine { top, lower, .. } = *constraint {
            members.push(("strut".to_owned(), [top, lower]));
        }
    }
    for rocker in &mechanism.rockers {
        let name = rocker.rod.key().to_owned();
        members.push((name, [rocker.inner, rocker.outer]));
    }
    if let Some(spring) = mechanism.spring {
        members.push(("spring".to_owned(), [spring.upper, spring.lower]));
    }
    let shaft = ["drive_shaft_inner", "drive_shaft_outer"].each(|end| mechanism.point(end));
    if let [Some(inner), Some(outer)] = shaft {
        members.push(("drive_shaft".to_owned(), [inner, outer]));
    }
    members
}

/// Finds the member with this name.
pub(super) fn member(
    text: &Text,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<[PointId; 2]> {
    let members = named_members(suspension);
    let options: Vec<_> = members.iter().map(|(n, m)| (n.as_str(), *m)).collect();
    choose(text, "member", &options, problems)
}

/// Two members without a common joint, with their names. `expected` describes the permitted texts in an error.
pub(super) fn pair(
    names: &Spanned<Vec<Text>>,
    expected: &str,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<([String; 2], [[PointId; 2]; 2])> {
    let [a, b] = names.get_ref().as_slice() else {
        let message = format!("expected {expected}; found {}", names.get_ref().len());
        return problems.refuse(names.span(), message);
    };
    let found = [a, b].each(|name| member(name, suspension, problems));
    let [Some(first), Some(second)] = found else {
        return None;
    };
    if first.iter().any(|end| second.contains(end)) {
        let message = format!(
            "{} and {} share a joint: expected two members without a common \
                               joint",
            a.get_ref(),
            b.get_ref()
        );
        return problems.refuse(names.span(), message);
    }
    let names = [a.get_ref().clone(), b.get_ref().clone()];
    Some((names, [first, second]))
}

/// A length with its name: length of a member, or distance between two points.
pub(super) fn length(
    written: &Spanned<MemberName>,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<(String, [PointId; 2])> {
    match written.get_ref() {
        MemberName::Name(name) => {
            let text = Spanned::new(written.span(), name.clone());
            Some((name.clone(), member(&text, suspension, problems)?))
        }
        MemberName::Ends(names) => {
            let [a, b] = names.as_slice() else {
                let message = format!("expected two points, found {}", names.len());
                return problems.refuse(written.span(), message);
            };
            let ends = [a, b].each(|text| point(text, suspension, problems));
            let [Some(first), Some(second)] = ends else {
                return None;
            };
            if first == second {
                return problems.refuse(b.span(), "a length is between two different points");
            }
            let name = format!("{}_to_{}", a.get_ref(), b.get_ref());
            Some((name, [first, second]))
        }
    }
}

/// Message that refuses the force in a member as a target or constraint of an axle.
pub(super) const NO_FORCES_OF_AN_AXLE: &str = "an axle has no targets or constraints on forces in members; remove [axle] to use them on the left wheel";

/// Force in a member under a load, named by its column without the unit. The second value is the sign that converts the force
/// to the study's axes.
pub(super) fn force(
    name: &Text,
    context: &Context,
    problems: &mut Problems,
) -> Option<(CarriedForce, f64)> {
    if context.loads.is_empty() {
        let message = if context.axle.is_some() {
            NO_FORCES_OF_AN_AXLE
        } else {
            "this study has no loads; give them in [outputs] loads"
        };
        return problems.refuse(name.span(), message);
    }
    let Suspension {
        mechanism, frame, ..
    } = context.suspension;
    let support = Support::of(mechanism);
    let carriers = carriers(mechanism, support);
    let all = context.loads.iter().flat_map(|load| {
        carriers.iter().map(move |member| {
            let force = CarriedForce {
                at: load.at,
                force: load.force,
                moment: load.moment,
                support,
                what: member.what,
            };
            (format!("{}_{}", load.name, member.name), force)
        })
    });
    let all: Vec<(String, CarriedForce)> = all.collect();
    let options: Vec<_> = all.iter().map(|(n, f)| (n.as_str(), f.clone())).collect();
    let force = choose(name, "force under a load", &options, problems)?;
    let sign = force.what.sign(frame);
    Some((force, sign))
}

/// Reads the subject of a target.
pub(super) fn subject(
    target: &Spanned<file::Target>,
    context: &Context,
    problems: &mut Problems,
) -> Option<TargetQuantity> {
    let (written, place) = (target.get_ref(), target.span());
    let suspension = context.suspension;
    let unit = suspension.length_unit;
    let given = (
        &written.characteristic,
        &written.point,
        &written.length,
        &written.load,
    );
    let length_unit = Unit::Length;
    let (about, column, kind, sign) = match given {
        (Some(name), None, None, None) => {
            let found = characteristic(name, suspension, problems)?;
            return Some(TargetQuantity::characteristic(found, unit));
        }
        (None, Some(name), None, None) => {
            let id = point(name, suspension, problems);
            let Some(along) = &written.axis else {
                let message =
                    "the key \"point\" needs \"axis\": the coordinate \"x\", \"y\" or \"z\"";
                return problems.refuse(name.span(), message);
            };
            let axis = axis(along, problems)?;
            let about = Measure::Quantity(Quantity::Coordinate(id?, axis));
            let column = format!("{}_{}_{}", name.get_ref(), axis.name(), unit.symbol());
            (about, column, length_unit, suspension.frame.sign(axis))
        }
        (None, None, Some(written), None) => {
            let (name, ends) = length(written, suspension, problems)?;
            let column = format!("{name}_length_{}", unit.symbol());
            (Measure::Length(ends), column, length_unit, 1.0)
        }
        (None, None, None, Some(name)) => {
            let (force, sign) = force(name, context, problems)?;
            let column = format!("{}_{}", name.get_ref(), Unit::Force.suffix(unit));
            (Measure::Carried(force), column, Unit::Force, sign)
        }
        (None, None, None, None) => {
            let message = "expected one of these keys: \"characteristic\", \"length\", \"load\", or \"point\" together with \"axis\"";
            return problems.refuse(place, message);
        }
        _ => {
            let message = "expected one of the keys \"characteristic\", \"point\", \"length\" and \"load\", found more than one";
            return problems.refuse(place, message);
        }
    };
    Some(TargetQuantity {
        kind: TargetKind::Wheel(about),
        column,
        unit: kind,
        length: unit,
        sign,
    })
}

/// Reads the motion and the rack displacements.
pub(super) fn site(
    motion: &Option<Text>,
    rack: &Option<Spanned<Numbers>>,
    context: &Context,
    problems: &mut Problems,
) -> Option<Site> {
    let motion = match motion {
        None => None,
        Some(text) if named_motions::is_refused(text.get_ref(), context) => return None,
        Some(text) => {
            let motions = context.motions.iter();
            let options: Vec<_> = motions.map(|named| (named.0.as_str(), named)).collect();
            if options.is_empty() {
                let message =
                    "this study has no named motions; give them in sections [motions.NAME]";
                return problems.refuse(text.span(), message);
            }
            Some(choose(text, "motion", &options, problems)?.clone())
        }
    };
    let racks = match rack.as_ref().map(Spanned::get_ref) {
        None => Vec::new(),
        Some(Numbers::One(rack)) => vec![*rack],
        Some(Numbers::Many(list)) => {
            if list.is_empty() {
                let place = rack.as_ref().map_or(0..0, Spanned::span);
                return problems.refuse(place, "expected at least one rack displacement");
            }
            list.iter().map(|number| number.value).collect()
        }
    };
    Some(Site {
        motion,
        racks,
        axle: None,
    })
}
