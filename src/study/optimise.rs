//! `[optimise]`: what may move.

use super::error::Problems;
use super::file;
use super::motion::within;
use super::moves;
use super::names::choose;
use super::resolve::Context;
use super::targets::{WrittenCurve, targets};
use super::value::Whole;
use super::{Optimise, Variable};
use crate::model::Suspension;
use toml::Spanned;

/// The optimisation, if nothing is wrong with it, and the target curves that came from files, by the
/// place of their target.
pub fn optimise(
    section: &file::Optimise,
    context: &Context,
    problems: &mut Problems,
) -> Option<(Optimise, Vec<(usize, WrittenCurve)>)> {
    if let Some(method) = &section.method {
        choose(method, "method", &[("levenberg_marquardt", ())], problems);
    }
    let mut whole = |number: &Option<Whole>, default, bounds| match number {
        None => Some(default),
        Some(number) => within(number, bounds, problems),
    };
    let starts = whole(&section.starts, 1, 1..=1_000_000);
    let seed = whole(&section.seed, 1, 0..=i64::from(u32::MAX));
    let max_iterations = whole(&section.max_iterations, 200, 1..=i64::MAX);
    let variables = variables(section, context.suspension, problems);
    let targets = targets(section, context, problems);
    let (targets, curves): (Vec<_>, Vec<_>) = targets?.into_iter().unzip();
    let curves = curves.into_iter().enumerate();
    let curves = curves
        .filter_map(|(place, curve)| Some((place, curve?)))
        .collect();
    let optimise = Optimise {
        starts: usize::try_from(starts?).ok()?,
        seed: u32::try_from(seed?).ok()?,
        max_iterations: u64::try_from(max_iterations?).ok()?,
        variables: variables?,
        targets,
    };
    Some((optimise, curves))
}

fn variables(
    section: &file::Optimise,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Vec<Variable>> {
    let written = section.variables.get_ref();
    if written.is_empty() {
        problems.add(
            section.variables.span(),
            "expected at least one variable, found an empty list",
        );
        return None;
    }
    let resolved: Vec<_> = written
        .iter()
        .map(|v| variable(v, suspension, problems))
        .collect();
    let place = |i: usize| {
        let variable = &written[i];
        let points = &variable.get_ref().hardpoint;
        points.as_ref().map_or(variable.span(), Spanned::span)
    };
    for (i, variable) in resolved.iter().enumerate() {
        let Some(variable) = variable else { continue };
        let same = |other: &Option<Variable>| {
            let other = other.as_ref();
            other.is_some_and(|other| other.moves == variable.moves)
        };
        if let Some(first) = resolved[..i].iter().position(same) {
            let axis = variable.moves[0].axis.name();
            let message = format!("{axis} of {} is already a variable", variable.name);
            let error = problems.add(place(i), message);
            error.related(place(first), "here");
        }
    }
    resolved.into_iter().collect()
}

fn variable(
    variable: &Spanned<file::Variable>,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Variable> {
    let written = variable.get_ref();
    let moved = moves::Written {
        place: variable.span(),
        hardpoint: &written.hardpoint,
        hardpoints: &written.hardpoints,
        factors: &written.factors,
        axis: &written.axis,
    };
    let moves = moves::moves(&moved, suspension, problems);
    let place = written.range.span();
    let range = match written.range.get_ref().as_slice() {
        [low, high] => [low.value, high.value],
        other => {
            let message = format!(
                "expected two offsets [lowest, highest], found {}",
                other.len()
            );
            problems.add(place, message);
            return None;
        }
    };
    let [low, high] = range;
    if low == high {
        problems.add(place, format!("the range is empty: both ends are {low}"));
        return None;
    }
    if low > high {
        let error = problems.add(
            place,
            format!("the range is reversed: {low} is above {high}"),
        );
        error.help(format!("range = [{high}, {low}]"));
        return None;
    }
    if low > 0.0 || high < 0.0 {
        let message =
            format!("offsets from {low} to {high} leave out the design, which is offset 0");
        problems.add(place, message);
        return None;
    }
    let moves = moves?;
    Some(Variable {
        name: moves::names(&moves, suspension),
        moves,
        range,
    })
}
