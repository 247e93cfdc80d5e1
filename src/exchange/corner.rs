//! Chooses the axle and the wheel, and selects a point of this wheel for each hardpoint. Points of two axles are never
//! mixed.

use super::notes::Notes;
use super::refusal::{Question, Refusal};
use super::roles::{self, Role};
use super::table::{Kind, Marks, NamedPoint, PointTable};
use super::{Hardpoint, ImportOptions};
use crate::model::{AxlePosition, Side};

/// A point with the hardpoint that it represents.
pub(super) struct Named<'t> {
    pub point: &'t NamedPoint,
    pub role: Role,
}

impl Named<'_> {
    /// Wheel and axle of the point. A column or a title of the file has priority over the name of the point.
    fn marks(&self) -> Marks {
        self.point.marks.or(self.role.marks)
    }
}

/// Wheel that is imported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    pub axle: Option<AxlePosition>,
    /// Side of the wheel, if the user or the file gives it.
    pub side: Option<Side>,
}

/// A point of the file for a hardpoint, with the wheel for which its coordinates were written.
#[derive(Clone, Debug)]
pub(super) struct Picked {
    pub hardpoint: Hardpoint,
    /// Side for which the coordinates were written. `None` if the file does not give it.
    pub origin: Option<Side>,
}

/// Name of an axle: "front" or "rear".
pub(super) fn name_of(axle: AxlePosition) -> &'static str {
    match axle {
        AxlePosition::Front => "front",
        AxlePosition::Rear => "rear",
    }
}

/// Chooses the axle and the wheel. Without `--side`, this is the left wheel if the file has points of it, else the right wheel. If
/// the file states no side, the side stays open.
///
/// # Errors
/// The file has two axles and none is chosen, it lacks the chosen one, or it states another topology.
pub(super) fn choose(
    table: &PointTable,
    named: &[Named<'_>],
    options: &ImportOptions<'_>,
    notes: &mut Notes,
) -> Result<Corner, Refusal> {
    let axle = axle(table, named, options, notes)?;
    let of_axle = |named: &&Named<'_>| {
        let own = named.marks().axle;
        own.is_none() || axle.is_none() || own == axle
    };
    let has = |side: Side| {
        let mut known = named.iter().filter(of_axle);
        known.any(|named| {
            named.marks().side == Some(side) || (named.point.mirrored && side == Side::Left)
        })
    };
    let marked = Side::ALL.into_iter().find(|side| has(*side));
    let side = options.side.or(marked);
    Ok(Corner { axle, side })
}

/// Chooses the axle: the one of `--axle`, the only one in the file, or the only one with points that `--map` names.
fn axle(
    table: &PointTable,
    named: &[Named<'_>],
    options: &ImportOptions<'_>,
    notes: &mut Notes,
) -> Result<Option<AxlePosition>, Refusal> {
    let of_points = named.iter().map(Named::marks);
    let of_kinds = table.kinds.iter().map(|(axle, _)| Marks {
        side: None,
        axle: *axle,
    });
    let there = roles::axles(of_points.chain(of_kinds));
    let chosen = match (options.axle, there.as_slice()) {
        (Some(wanted), there) if there.is_empty() || there.contains(&wanted) => Some(wanted),
        (Some(wanted), there) => {
            let there: Vec<&str> = there.iter().map(|axle| name_of(*axle)).collect();
            return Err(Refusal::Wrong(format!(
                "--axle {}: the file has points of the {} axle only",
                name_of(wanted),
                there.join(" and the ")
            )));
        }
        (None, []) => None,
        (None, [only]) => {
            notes.push(format!(
                "axle: {}, the only axle in the file",
                name_of(*only)
            ));
            Some(*only)
        }
        (None, _) => {
            // If the points that `--map` names belong to one axle only, this axle is imported.
            let mapped = named
                .iter()
                .filter(|named| options.names.contains_key(named.role.hardpoint));
            match roles::axles(mapped.map(Named::marks)).as_slice() {
                [one] => {
                    notes.push(format!(
                        "axle: {}, because --map names points of it",
                        name_of(*one)
                    ));
                    Some(*one)
                }
                _ => {
                    return Err(Question::of(
                        "the file has points of the front and of the rear axle, but a study describes only one (--car --out \
                         DIR imports both as a car)"
                            .to_owned(),
                        "--axle",
                        &["front", "rear"],
                    ));
                }
            }
        }
    };
    kind(table, chosen, options)?;
    Ok(chosen)
}

/// Refuses a topology that contradicts the kind of suspension in the file.
fn kind(
    table: &PointTable,
    axle: Option<AxlePosition>,
    options: &ImportOptions<'_>,
) -> Result<(), Refusal> {
    let of_axle = |(of, _): &&(Option<AxlePosition>, Kind)| of.is_none() || *of == axle;
    match table.kinds.iter().find(of_axle).map(|(_, kind)| kind) {
        Some(Kind::Other(reason)) => Err(Refusal::Wrong(reason.clone())),
        Some(Kind::Unclear(name, reason))
            if *name == options.topology.name && options.names.is_empty() =>
        {
            Err(Refusal::Wrong(reason.clone()))
        }
        Some(Kind::Topology(name) | Kind::Unclear(name, _)) if *name != options.topology.name => {
            Err(Refusal::Wrong(format!(
                "according to the file, the suspension{} is a {name}: give --topology {name}",
                axle.map_or(String::new(), |axle| format!(
                    " of the {} axle",
                    name_of(axle)
                ))
            )))
        }
        _ => Ok(()),
    }
}

/// Point of one hardpoint for the chosen wheel. `None` if the file has no such point. A point of the other wheel is not mirrored
/// yet; see [`Picked::origin`].
///
/// # Errors
/// Two points fit equally well and differ, or the coordinates cannot be read.
pub(super) fn pick(
    hardpoint: &'static str,
    named: &[Named<'_>],
    corner: Corner,
) -> Result<Option<Picked>, Refusal> {
    // Points of the chosen axle come first, then points without an axle. Points of the other axle are never used.
    let of_axle = |axle: Option<AxlePosition>| -> Vec<&Named<'_>> {
        let of = named.iter().filter(|n| n.role.hardpoint == hardpoint);
        of.filter(|n| corner.axle.is_none() || n.marks().axle == axle)
            .collect()
    };
    let mut candidates = of_axle(corner.axle);
    if candidates.is_empty() {
        candidates = of_axle(None);
    }
    // Order of preference: the wheel's own rows, rows for both wheels, rows without a side, rows of the other wheel.
    let rank = |named: &Named<'_>| match (named.marks().side, named.point.mirrored) {
        (Some(side), false) if Some(side) == corner.side => 0,
        (_, true) => 1,
        (None, false) => 2,
        _ => 3,
    };
    let Some(best) = candidates.iter().map(|named| rank(named)).min() else {
        return Ok(None);
    };
    let mut chosen = candidates.iter().filter(|named| rank(named) == best);
    let first = chosen
        .next()
        .expect("at least one candidate has the best rank");
    if let Some(second) = chosen.find(|other| other.point.position != first.point.position) {
        let [a, b] = [first.point, second.point];
        // `--map` refers to points by name, so it cannot distinguish points with the same name.
        let remedy = if a.name.trim().to_lowercase() == b.name.trim().to_lowercase() {
            "rename or remove one of the two"
        } else {
            "select one with --map, or remove one"
        };
        return Err(Refusal::Wrong(format!(
            "{:?} ({}) and {:?} ({}) both seem to be {hardpoint}, with different coordinates: {remedy}",
            a.name, a.place, b.name, b.place
        )));
    }
    let position = first.point.position.clone();
    let position = position.map_err(|reason| format!("{hardpoint}: {reason}"))?;
    let origin = match best {
        0 => corner.side,
        1 => Some(Side::Left),
        2 => None,
        _ => first.marks().side,
    };
    Ok(Some(Picked {
        hardpoint: Hardpoint {
            name: hardpoint,
            position,
            called: first.point.name.clone(),
            place: first.point.place.clone(),
            body: first.point.body.clone(),
            named_body: first.role.body,
        },
        origin,
    }))
}

/// Coordinates of a hardpoint that the file gives for the other wheel. `None` if the side of the wheel is not known, or the file
/// has no such point.
pub(super) fn of_other_wheel(
    hardpoint: &'static str,
    named: &[Named<'_>],
    corner: Corner,
) -> Option<[f64; 3]> {
    let other = corner.side?;
    let mut of = named.iter().filter(|n| n.role.hardpoint == hardpoint);
    let found = of.find(|n| {
        let marks = n.marks();
        marks.side.is_some_and(|side| side != other)
            && (corner.axle.is_none() || marks.axle == corner.axle)
    })?;
    found.point.position.clone().ok()
}
