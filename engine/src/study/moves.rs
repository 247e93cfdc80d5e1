//! Coordinates that a variable of `[sweep]` or `[optimise]` moves.

use super::Move;
use super::error::Problems;
use super::file::Coordinates;
use super::members;
use super::outputs::{distinct, hardpoint};
use super::resolve::some;
use super::value::{Number, Text};
use crate::ask::Accepted;
use crate::model::{Axis, PointId, Suspension};
use std::ops::Range as Span;
use toml::Spanned;

/// Keys of a variable that describe its move.
pub(super) struct Written<'a> {
    /// Position of the variable in the file.
    pub place: Span<usize>,
    /// Name of the hardpoint. A variable gives either `hardpoint` or `hardpoints`.
    pub hardpoint: &'a Option<Text>,
    /// Names of several hardpoints that move together.
    pub hardpoints: &'a Option<Spanned<Vec<Text>>>,
    /// Displacement of each hardpoint per unit of the variable.
    pub factors: &'a Option<Spanned<Vec<Number>>>,
    /// Axis `x`, `y` or `z`. A variable gives either `axis` or `direction`.
    pub axis: Option<&'a Text>,
    /// Direction of the move.
    pub direction: Option<&'a Coordinates>,
}

/// Reads the coordinates that a variable moves. `None` if one of the keys has an error.
pub(super) fn moves(
    written: &Written<'_>,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Vec<Move>> {
    let shares = shares(written, problems);
    let points = points(written, suspension, problems)?;
    let shares = shares?;
    let moved = |(point, factor): (PointId, f64)| {
        shares.iter().map(move |(axis, share)| Move {
            point,
            axis: *axis,
            factor: factor * share,
        })
    };
    Some(points.into_iter().flat_map(moved).collect())
}

/// Displacement along each axis per unit of the variable: 1 along a single axis, or the components of a unit vector.
fn shares(written: &Written<'_>, problems: &mut Problems) -> Option<Vec<(Axis, f64)>> {
    match (written.axis, written.direction) {
        (Some(axis), None) => Some(vec![(members::axis(axis, problems)?, 1.0)]),
        (None, Some(direction)) => {
            let entries: Vec<f64> = direction.get_ref().iter().map(|c| c.value).collect();
            let length = entries.iter().fold(0.0, |sum: f64, c| sum.hypot(*c));
            if entries.len() != 3 || !(length > 0.0 && length.is_finite()) {
                let message = "expected a direction [x, y, z] other than 0";
                return problems.refuse(direction.span(), message);
            }
            let shares = Axis::ALL.into_iter().zip(entries);
            let shares = shares.map(|(axis, entry)| (axis, entry / length));
            Some(shares.filter(|(_, share)| *share != 0.0).collect())
        }
        (Some(_), Some(direction)) => {
            let message = "expected \"axis\" or \"direction\", found both";
            problems.refuse(direction.span(), message)
        }
        (None, None) => {
            let message =
                "expected the key \"axis\" or the key \"direction\": the direction of the movement";
            problems.refuse(written.place.clone(), message)
        }
    }
}

/// Reads the lowest and the highest value of a variable. `what` names the values in messages.
pub(super) fn range(
    written: &Spanned<Vec<Number>>,
    what: &str,
    problems: &mut Problems,
) -> Option<[f64; 2]> {
    let [low, high] = match written.get_ref().as_slice() {
        [low, high] => [low.value, high.value],
        other => {
            let found = other.len();
            let message = format!("expected two {what} [lowest, highest], found {found}");
            return problems.refuse_count(written, 2, message);
        }
    };
    if low == high {
        let message = format!("the range is empty: both ends are {low}");
        return problems.refuse(written.span(), message);
    }
    if low > high {
        let message = format!("the range is reversed: {low} is above {high}");
        let error = problems.add(written.span(), message);
        error.help(format!("range = [{high}, {low}]"));
        return None;
    }
    Some([low, high])
}

/// Reads the lowest and the highest value of a variable. Refuses the range if a study does not accept both values for the
/// part that the variable changes.
pub(super) fn accepted_range(
    written: &Spanned<Vec<Number>>,
    what: &str,
    accepted: Accepted,
    problems: &mut Problems,
) -> Option<[f64; 2]> {
    let ends = range(written, what, problems)?;
    match accepted.first_outside(ends) {
        None => Some(ends),
        Some(end) => {
            let message = format!("expected {what} {accepted}, found {end}");
            problems.refuse(written.span(), message)
        }
    }
}

/// Names of the moving points, for example `lower_arm_front+lower_arm_rear`.
pub(super) fn names(moves: &[Move], suspension: &Suspension) -> String {
    let names = moves.iter().map(|m| suspension.mechanism.name(m.point));
    let mut names: Vec<&str> = names.collect();
    // With a direction, a point is listed once for each of its coordinates.
    names.dedup();
    names.join("+")
}

/// Hardpoints that a variable moves, and their displacements.
fn points(
    written: &Written<'_>,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Vec<(PointId, f64)>> {
    let list = match (written.hardpoint, written.hardpoints) {
        (Some(name), None) => {
            if let Some(factors) = written.factors {
                let message =
                    "the key \"factors\" needs \"hardpoints\", a list of points that move together";
                problems.add(factors.span(), message);
            }
            return Some(vec![(hardpoint(name, suspension, problems)?, 1.0)]);
        }
        (None, Some(list)) => list,
        (Some(_), Some(list)) => {
            let message = "expected \"hardpoint\" or \"hardpoints\", found both";
            return problems.refuse(list.span(), message);
        }
        (None, None) => {
            let message = "expected the key \"hardpoint\" or the key \"hardpoints\"";
            return problems.refuse(written.place.clone(), message);
        }
    };
    let names = some(list, "hardpoint", problems)?;
    let points = distinct(names, problems, |name, problems| {
        hardpoint(name, suspension, problems)
    })?;
    let Some(factors) = written.factors else {
        return Some(points.into_iter().map(|point| (point, 1.0)).collect());
    };
    let numbers = factors.get_ref();
    if numbers.len() != points.len() {
        let message = format!(
            "expected a factor for each of the {} hardpoints, found {}",
            points.len(),
            numbers.len()
        );
        return problems.refuse(factors.span(), message);
    }
    if let Some(zero) = numbers.iter().find(|n| n.value == 0.0) {
        let message = "a hardpoint with factor 0 does not move; leave it out";
        return problems.refuse(zero.span.clone(), message);
    }
    let factors = numbers.iter().map(|n| n.value);
    Some(points.into_iter().zip(factors).collect())
}
