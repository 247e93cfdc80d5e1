//! `[optimise]`: what may move.

use super::error::Problems;
use super::file;
use super::motion::within;
use super::names::choose;
use super::outputs::hardpoint;
use super::resolve::Context;
use super::targets::{WrittenCurve, targets};
use super::value::Whole;
use super::{Optimise, Variable};
use crate::model::{Axis, Suspension};

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
    for (i, variable) in written.iter().enumerate() {
        let same = |other: &&file::Variable| {
            (other.hardpoint.get_ref(), other.axis.get_ref())
                == (variable.hardpoint.get_ref(), variable.axis.get_ref())
        };
        if let Some(first) = written[..i].iter().find(same) {
            let (point, axis) = (variable.hardpoint.get_ref(), variable.axis.get_ref());
            let message = format!("{axis} of {point} is already a variable");
            let error = problems.add(variable.hardpoint.span(), message);
            error.related(first.hardpoint.span(), "here");
        }
    }
    resolved.into_iter().collect()
}

fn variable(
    written: &file::Variable,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Variable> {
    let axes = Axis::ALL.map(|axis| (axis.name(), axis));
    let point = hardpoint(&written.hardpoint, suspension, problems);
    let axis = choose(&written.axis, "axis", &axes, problems);
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
    Some(Variable {
        point: point?,
        axis: axis?,
        range,
    })
}
