//! Directions in which a design can change while the targets keep their values, and the limits of the mechanism.

use super::job::count_from_file;
use super::message::{Designed, DirectionsAnswer, FreeDirection, LimitsAnswer, VariableOverview};
use super::overview::variable;
use super::study_file::Opened;
use crate::limits::LimitTable;
use crate::optimise::{Bounds, Identifiability, Linearisation, assessed};
use crate::report::{brief, to_digits, with_plus};
use crate::study::Variable;

/// Largest change of the misfit (in multiples of the tolerances) that counts as no change, if the variables move across their
/// whole ranges.
const UNSEEN: f64 = 0.01;
/// Largest number of directions in an answer.
const MOST: usize = 8;

/// Combinations of the study's variables that leave the targets unchanged, to first order. Rotations and rates are left out. The
/// answer is empty without targets, and if the targets of the design cannot be evaluated.
pub(super) fn directions(opened: &Opened, of: &Designed) -> Result<DirectionsAnswer, String> {
    let moved = opened.moved(&of.design)?;
    let (Some(optimise), Some(layout)) = (&moved.optimise, opened.layout_of(&moved)) else {
        return Ok(DirectionsAnswer::none());
    };
    let suspension = moved.wheel();
    // A rotation moves points along arcs, not straight lines, and a rate moves no point.
    let is_straight = |v: &&Variable| v.turn.is_none() && v.rate.is_none();
    let straight = optimise.variables.iter().filter(is_straight);
    let variables: Vec<_> = straight.cloned().collect();
    let found = assessed(suspension, &variables, &layout)
        .map_err(|fault| fault.describe(&suspension.mechanism))?;
    let Ok(found) = found else {
        return Ok(DirectionsAnswer::none());
    };
    let shown = variables.iter().map(|own| VariableOverview {
        name: format!("{} {}", own.name, own.way()),
        ..variable(own)
    });
    let shown: Vec<VariableOverview> = shown.collect();
    let left = variables.into_iter().map(|mut own| {
        count_from_file(&mut own, opened.study.wheel(), &suspension.design);
        own.range
    });
    let left: Vec<[f64; 2]> = left.collect();
    Ok(unseen(&found.goal, &shown, &left, suspension.design.len()))
}

/// Directions that leave the residuals of the targets (the rows of `goal`) unchanged, to first order. The columns of `goal` belong
/// to the variables. `left` has the ranges of the variables relative to the present design. `points` is the number of points of the
/// design. The name of a direction leaves out variables that move by at most a thousandth of their range.
pub(super) fn unseen(
    goal: &Linearisation,
    variables: &[VariableOverview],
    left: &[[f64; 2]],
    points: usize,
) -> DirectionsAnswer {
    let ranges: Vec<[f64; 2]> = variables.iter().map(|own| own.range).collect();
    let Ok(bounds) = Bounds::new(&ranges) else {
        return DirectionsAnswer::none();
    };
    let identifiability = Identifiability::new(goal, &bounds, UNSEEN);
    let direction = |change: &nalgebra::DVector<f64>| {
        let mut by = vec![[0.0; 3]; points];
        let mut parts = Vec::new();
        let mut free = [-1.0_f64, 1.0];
        for ((variable, left), share) in variables.iter().zip(left).zip(change) {
            let [low, high] = variable.range;
            if share.abs() <= 1e-3 * (high - low) {
                continue;
            }
            let [one, other] = left.map(|end| end / share);
            free = [
                free[0].max(one.min(other).min(0.0)),
                free[1].min(one.max(other).max(0.0)),
            ];
            for (point, axis, factor) in &variable.moves {
                by[*point][*axis] += factor * share;
            }
            let by = with_plus(*share, brief(to_digits(*share, 3)));
            parts.push(format!("{} {by}", variable.name));
        }
        FreeDirection {
            name: parts.join(", "),
            change: by,
            free,
        }
    };
    let unseen = identifiability.unseen.iter().take(MOST);
    DirectionsAnswer {
        directions: unseen.map(|d| direction(&d.change)).collect(),
    }
}

/// Table of the limits of a design's motion, with the parts that cause the limits.
pub(super) fn limits(opened: &Opened, of: &Designed) -> Result<LimitsAnswer, String> {
    let limits = LimitTable::of(&opened.moved(&of.design)?)?;
    Ok(LimitsAnswer::of(
        "Limits of the mechanism",
        &limits.table(),
        |_| true,
        limits.notes,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The name of a direction gives small amounts of its variables, as in a study in metres, with three digits.
    #[test]
    fn amounts_of_small_moves_have_digits() {
        let variable = |name: &str| VariableOverview {
            name: name.to_owned(),
            moves: Vec::new(),
            is_turn: false,
            range: [-0.001_234, 0.001_234],
        };
        let mut goal = Linearisation::new(1, 2);
        goal.jacobian[(0, 0)] = 1e6;
        goal.jacobian[(0, 1)] = -1e6;
        let variables = [variable("a"), variable("b")];
        let found = unseen(&goal, &variables, &[[-0.001_234, 0.001_234]; 2], 0).directions;
        assert_eq!(found.len(), 1);
        let parts: Vec<&str> = found[0].name.split(", ").collect();
        assert_eq!(parts.len(), 2);
        for part in parts {
            assert!(part.ends_with("0.00247"), "{part}");
        }
        // The change is a whole range, so each variable reaches its ends at half of the change.
        assert!((found[0].free[0] + 0.5).abs() < 1e-9 && (found[0].free[1] - 0.5).abs() < 1e-9);
        // A variable that was moved to an end of its range moves in one direction only.
        let left = [[-0.002_468, 0.0], [-0.001_234, 0.001_234]];
        let [low, high] = unseen(&goal, &variables, &left, 0).directions[0].free;
        let is_one_sided = (low == 0.0) != (high == 0.0);
        assert!(
            is_one_sided && (high - low - 0.5).abs() < 1e-9,
            "{low} {high}"
        );
    }
}
