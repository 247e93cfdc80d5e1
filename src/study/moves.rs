//! Which coordinates a variable of `[sweep]` or `[optimise]` moves.

use super::Move;
use super::error::Problems;
use super::names::choose;
use super::outputs::hardpoint;
use super::value::{Number, Text};
use crate::model::{Axis, PointId, Suspension};
use std::ops::Range as Span;
use toml::Spanned;

/// The keys of a variable that say so.
pub(super) struct Written<'a> {
    /// Where the variable is.
    pub place: Span<usize>,
    /// Name of the hardpoint,
    pub hardpoint: &'a Option<Text>,
    /// or names of several that move together.
    pub hardpoints: &'a Option<Spanned<Vec<Text>>>,
    /// How far each of them moves per unit of the variable.
    pub factors: &'a Option<Spanned<Vec<Number>>>,
    /// `x`, `y` or `z`.
    pub axis: &'a Text,
}

/// The coordinates, if nothing is wrong with what is written.
pub(super) fn moves(
    written: &Written<'_>,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Vec<Move>> {
    let axes = Axis::ALL.map(|axis| (axis.name(), axis));
    let axis = choose(written.axis, "axis", &axes, problems);
    let points = points(written, suspension, problems);
    let axis = axis?;
    let moved = |(point, factor)| Move {
        point,
        axis,
        factor,
    };
    Some(points?.into_iter().map(moved).collect())
}

/// The names of what moves: `lower_arm_front+lower_arm_rear`.
pub(super) fn names(moves: &[Move], suspension: &Suspension) -> String {
    let names = moves.iter().map(|m| suspension.mechanism.name(m.point));
    names.collect::<Vec<_>>().join("+")
}

/// The hardpoints a variable moves, and how far.
fn points(
    written: &Written<'_>,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Vec<(PointId, f64)>> {
    let list = match (written.hardpoint, written.hardpoints) {
        (Some(name), None) => {
            if let Some(factors) = written.factors {
                let message = "factors belong to hardpoints, several that move together";
                problems.add(factors.span(), message);
            }
            return Some(vec![(hardpoint(name, suspension, problems)?, 1.0)]);
        }
        (None, Some(list)) => list,
        (Some(_), Some(list)) => {
            let message = "expected hardpoint, or hardpoints that move together, found both";
            problems.add(list.span(), message);
            return None;
        }
        (None, None) => {
            let message = "expected hardpoint, or hardpoints that move together";
            problems.add(written.place.clone(), message);
            return None;
        }
    };
    let names = list.get_ref();
    if names.is_empty() {
        let message = "expected at least one hardpoint, found an empty list";
        problems.add(list.span(), message);
        return None;
    }
    let points: Vec<_> = names
        .iter()
        .map(|name| hardpoint(name, suspension, problems))
        .collect();
    for (i, name) in names.iter().enumerate() {
        if let Some(first) = names[..i].iter().find(|n| n.get_ref() == name.get_ref()) {
            let message = format!("{:?} is listed twice", name.get_ref());
            let error = problems.add(name.span(), message);
            error.related(first.span(), "first here");
        }
    }
    let points: Vec<PointId> = points.into_iter().collect::<Option<_>>()?;
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
        problems.add(factors.span(), message);
        return None;
    }
    if let Some(zero) = numbers.iter().find(|n| n.value == 0.0) {
        let message = "a hardpoint with factor 0 does not move; leave it out";
        problems.add(zero.span.clone(), message);
        return None;
    }
    let factors = numbers.iter().map(|n| n.value);
    Some(points.into_iter().zip(factors).collect())
}
