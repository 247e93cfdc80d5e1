//! The jig of `[tolerance]`.

use super::super::error::Problems;
use super::super::outputs::hardpoint;
use super::super::suspension::above_zero;
use super::super::value::{Number, Text};
use super::super::{Contributor, Law, Source, file};
use crate::assembly::BuildParameter;
use crate::model::{Axis, PointId, Suspension};
use crate::number::Vector3;
use std::ops::Range as Span;
use toml::Spanned;

/// Points that a jig moves and rotates together, about their centroid.
pub(super) fn jig(
    names: &Spanned<Vec<Text>>,
    written: &file::Scatter,
    place: Span<usize>,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Contributor> {
    for (span, key) in [
        (written.sigma.as_ref().map(|n| n.span.clone()), "sigma"),
        (written.limits.as_ref().map(Spanned::span), "limits"),
        (written.axis.as_ref().map(Spanned::span), "axis"),
    ] {
        if let Some(span) = span {
            problems.add(
                span,
                format!("a jig has the keys \"shift\" and \"turn\", not {key}"),
            );
        }
    }
    let points: Option<Vec<PointId>> = names
        .get_ref()
        .iter()
        .map(|name| hardpoint(name, suspension, problems))
        .collect();
    let points = points?;
    if points.len() < 2 {
        return problems.refuse(names.span(), "expected two hardpoints or more in a jig");
    }
    let sigma = |number: &Option<Number>, problems: &mut Problems| match number {
        None => Some(0.0),
        Some(number) => above_zero(number, problems),
    };
    let (shift, turn) = (
        sigma(&written.shift, problems)?,
        sigma(&written.turn, problems)?,
    );
    if shift == 0.0 && turn == 0.0 {
        return problems.refuse(place, "expected \"shift\", \"turn\" (degrees) or both");
    }
    let places = points.iter().map(|id| suspension.design[id.0]);
    let sum = places.clone().fold(Vector3::default(), |a, b| a + b);
    let centre = sum * (1.0 / points.len() as f64);
    let name = names.get_ref().iter().map(|n| n.get_ref().as_str());
    let name = format!("jig {}", name.collect::<Vec<_>>().join("+"));
    let mut sources = Vec::new();
    let changes = |moves: &dyn Fn(Vector3<f64>) -> Vector3<f64>| {
        let mut changes = Vec::new();
        for (id, place) in points.iter().zip(places.clone()) {
            for (axis, by) in Axis::ALL.into_iter().zip(moves(place - centre).to_array()) {
                if by != 0.0 {
                    changes.push((BuildParameter::Coordinate(*id, axis), by));
                }
            }
        }
        changes
    };
    for axis in Axis::ALL {
        let mut unit = [0.0; 3];
        unit[axis as usize] = 1.0;
        let unit = Vector3::from(unit);
        if shift > 0.0 {
            let changes = changes(&|_| unit * suspension.frame.sign(axis));
            let name = format!("{name} shift {}", axis.name());
            sources.push(Source::of_parts(
                name,
                changes,
                Law::Normal { sigma: shift },
            ));
        }
        if turn > 0.0 {
            let changes = changes(&|lever| unit.cross(lever) * suspension.frame.turn_sign(axis));
            let sigma = turn.to_radians();
            let name = format!("{name} turn {}", axis.name());
            sources.push(Source::of_parts(name, changes, Law::Normal { sigma }));
        }
    }
    Some(Contributor { name, sources })
}
