//! Bodies that carry the ends of springs and rods. The user, a column or a name gives them. Otherwise the importer assumes the
//! usual body, or another body that is much nearer.

use super::roles::body_of;
use super::{Hardpoint, Imported};
use crate::model::{Mechanism, PointId};
use std::collections::BTreeMap;

/// A hardpoint that may be mounted on different bodies.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Seat {
    pub hardpoint: &'static str,
    /// Usual body of this hardpoint.
    usual: &'static str,
    /// Body on which the hardpoint is mounted.
    pub body: &'static str,
    /// True if neither the user nor the file states the body.
    is_assumed: bool,
}

/// Finds the bodies that carry the ends of springs and rods.
///
/// # Errors
/// A given body cannot carry the end, or it is not clear which body carries the drop link.
pub(super) fn of(
    imported: &Imported,
    named: &BTreeMap<String, String>,
) -> Result<Vec<Seat>, String> {
    let names: Vec<&'static str> = imported.hardpoints.iter().map(|h| h.name).collect();
    let mechanism = (imported.topology.build)(imported.topology, &names);
    if let Some(unknown) = named.keys().find(|name| {
        let id = mechanism.point(name);
        id.is_none_or(|id| mechanism.possible_bodies(id).is_empty())
    }) {
        return Err(format!(
            "--body {unknown}=...: expected an end of a spring or rod of this suspension, such as drop_link_outer"
        ));
    }
    let mut seats = Vec::new();
    for hardpoint in &imported.hardpoints {
        let Some(id) = mechanism.point(hardpoint.name) else {
            continue;
        };
        let possible: Vec<&'static str> = mechanism
            .possible_bodies(id)
            .into_iter()
            .map(|(name, _)| name)
            .collect();
        let bodies = mechanism.bodies.iter();
        let mut own = bodies.filter(|(_, body)| *body == mechanism.body(id));
        let Some((usual, _)) = own.next().filter(|_| possible.len() > 1) else {
            continue;
        };
        let stated = stated(hardpoint, named, &possible, imported)?;
        let near = || nearest(imported, &mechanism, id, usual, &possible);
        let body = match stated {
            Some(body) => body,
            None => near()?.unwrap_or(usual),
        };
        seats.push(Seat {
            hardpoint: hardpoint.name,
            usual,
            body,
            is_assumed: stated.is_none(),
        });
    }
    Ok(seats)
}

/// Body that the user, a column of the file or the point's name gives for a hardpoint. `None` if none of them gives a body.
fn stated(
    hardpoint: &Hardpoint,
    named: &BTreeMap<String, String>,
    possible: &[&'static str],
    imported: &Imported,
) -> Result<Option<&'static str>, String> {
    let of_words = |text: &str| {
        let plain = text.trim().to_lowercase().replace(' ', "_");
        let exact = possible.iter().find(|body| **body == plain);
        exact.copied().or_else(|| {
            let meant = body_of(text, imported.topology)?;
            possible.iter().find(|body| **body == meant).copied()
        })
    };
    let written = named.get(hardpoint.name).or(hardpoint.body.as_ref());
    if let Some(text) = written {
        let place = if named.contains_key(hardpoint.name) {
            format!("--body {}", hardpoint.name)
        } else {
            format!("{}: body of {}", hardpoint.place, hardpoint.name)
        };
        return of_words(text).map(Some).ok_or_else(|| {
            format!(
                "{place} is {text:?}; expected one of {}",
                possible.join(", ")
            )
        });
    }
    let meant = hardpoint.named_body;
    Ok(meant.and_then(|meant| possible.iter().find(|body| **body == meant).copied()))
}

/// A nearer body replaces the usual body if its distance from the point is less than this fraction of the usual body's distance.
const NEARER: f64 = 0.5;

/// Finds a body that is much nearer to an end of a spring or rod than the usual body. The distance of a body is the smallest
/// distance from the lines between its joints. Returns `None` to keep the usual body.
fn nearest(
    imported: &Imported,
    mechanism: &Mechanism,
    id: PointId,
    usual: &'static str,
    possible: &[&'static str],
) -> Result<Option<&'static str>, String> {
    let name = mechanism.name(id);
    let at = |name: &str| {
        let found = imported.hardpoints.iter().find(|h| h.name == name);
        found.map(|h| h.position)
    };
    let Some(end) = at(name) else {
        return Ok(None);
    };
    let members = |body: &str| -> Vec<[Option<[f64; 3]>; 2]> {
        let list: &[(&str, &str)] = match body {
            "lower_arm" => &[
                ("lower_arm_front", "lower_ball_joint"),
                ("lower_arm_rear", "lower_ball_joint"),
            ],
            "upper_arm" => &[
                ("upper_arm_front", "upper_ball_joint"),
                ("upper_arm_rear", "upper_ball_joint"),
            ],
            "rocker" => &[
                ("rocker_pivot_front", "rocker_pivot_rear"),
                ("rocker_pivot_front", "pushrod_inner"),
                ("rocker_pivot_front", "pullrod_inner"),
                ("rocker_pivot_front", "spring_lower"),
            ],
            _ => &[],
        };
        let ends = list.iter().map(|(a, b)| [at(a), at(b)]);
        ends.collect()
    };
    let distance = |body: &str| {
        let lines = members(body).into_iter();
        let distances = lines.filter_map(|[a, b]| Some(to_segment(end, a?, b?)));
        distances.reduce(f64::min)
    };
    let near = possible
        .iter()
        .filter_map(|body| Some((*body, distance(body)?)));
    let mut near: Vec<(&'static str, f64)> = near.collect();
    near.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    let Some((nearest, least)) = near.first().copied() else {
        return Ok(None);
    };
    // If the drop link were on a wrong body, the motion ratio of the bar would be wrong by a large factor.
    let has_rocker = near.iter().any(|(body, _)| *body == "rocker");
    if name == "drop_link_outer" && has_rocker {
        if near.iter().skip(1).all(|(_, other)| least < NEARER * other) {
            return Ok(Some(nearest));
        }
        let flags: Vec<String> = near
            .iter()
            .map(|(body, _)| format!("--body drop_link_outer={body}"))
            .collect();
        return Err(format!(
            "the file does not state the body of drop_link_outer, and the point is near several \
             bodies: give {}",
            flags.join(" or ")
        ));
    }
    let usual_distance = distance(usual);
    Ok(usual_distance
        .is_some_and(|usual| least < NEARER * usual)
        .then_some(nearest))
}

/// Distance of a point from the segment between two others.
fn to_segment(point: [f64; 3], a: [f64; 3], b: [f64; 3]) -> f64 {
    let sub = |p: [f64; 3], q: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| p[k] - q[k]) };
    let dot = |p: [f64; 3], q: [f64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let (along, from) = (sub(b, a), sub(point, a));
    let length = dot(along, along);
    let share = if length > 0.0 {
        (dot(from, along) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let foot: [f64; 3] = std::array::from_fn(|k| a[k] + share * along[k]);
    let apart = sub(point, foot);
    dot(apart, apart).sqrt()
}

/// Notes about assumed bodies.
pub(super) fn notes(seats: &[Seat]) -> Option<String> {
    let assumed: Vec<String> = seats
        .iter()
        .filter(|seat| seat.is_assumed)
        .map(|seat| {
            let near = if seat.body == seat.usual {
                ""
            } else {
                " (the point is near it)"
            };
            format!(
                "{} on the {}{near}",
                seat.hardpoint,
                seat.body.replace('_', " ")
            )
        })
        .collect();
    (!assumed.is_empty()).then(|| {
        format!(
            "bodies: {} is assumed, because the file states none; use --body or \
             [suspension.bodies] to change this",
            assumed.join(", ")
        )
    })
}

impl Seat {
    /// Line of the study that names the body, if it is not the usual one.
    pub(super) fn unusual(&self) -> Option<(&'static str, &'static str)> {
        (self.body != self.usual).then_some((self.hardpoint, self.body))
    }
}
