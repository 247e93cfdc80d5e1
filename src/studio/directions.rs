//! Possible changes of a design: moves that leave the targets unchanged, and the limits of the mechanism.

use super::message::{Designed, DirectionsAnswer, FreeDirection, LimitsAnswer};
use super::study_file::Opened;
use crate::limits::LimitTable;
use crate::optimise::{Bounds, Identifiability, assessed};
use crate::study::Variable;

/// Largest change of the misfit, in tolerances, that counts as no change, for a move across the whole range.
const UNSEEN: f64 = 0.01;
/// Largest number of directions.
const MOST: usize = 8;

/// Combinations of the study's variables that leave the targets unchanged, to first order.
pub(super) fn directions(opened: &Opened, of: &Designed) -> Result<DirectionsAnswer, String> {
    let (Some(optimise), Some(layout)) = (&opened.study.optimise, &opened.layout) else {
        return Ok(DirectionsAnswer {
            directions: Vec::new(),
        });
    };
    let moved = opened.moved(&of.design)?;
    let suspension = moved.wheel();
    // A rotation moves points along arcs, not straight lines, and a rate moves no point.
    let is_straight = |v: &&Variable| v.turn.is_none() && v.rate.is_none();
    let straight = optimise.variables.iter().filter(is_straight);
    let variables: Vec<_> = straight.cloned().collect();
    let ranges: Vec<[f64; 2]> = variables.iter().map(|v| v.range).collect();
    let none = || DirectionsAnswer {
        directions: Vec::new(),
    };
    let found = assessed(suspension, &variables, layout)
        .map_err(|fault| fault.describe(&suspension.mechanism))?;
    let (Ok(found), Ok(bounds)) = (found, Bounds::new(&ranges)) else {
        return Ok(none());
    };
    let identifiability = Identifiability::new(&found.goal, &bounds, UNSEEN);
    let direction = |change: &nalgebra::DVector<f64>| {
        let mut by = vec![[0.0; 3]; suspension.design.len()];
        let mut parts = Vec::new();
        for ((variable, share), range) in variables.iter().zip(change).zip(&ranges) {
            if share.abs() <= 1e-3 * (range[1] - range[0]) {
                continue;
            }
            for m in &variable.moves {
                by[m.point.0][m.axis as usize] += m.factor * share;
            }
            parts.push(format!("{} {} {share:+.2}", variable.name, variable.way()));
        }
        FreeDirection {
            name: parts.join(", "),
            change: by,
            free: [-1.0, 1.0],
        }
    };
    let unseen = identifiability.unseen.iter().take(MOST);
    Ok(DirectionsAnswer {
        directions: unseen.map(|d| direction(&d.change)).collect(),
    })
}

/// Limits of the mechanism, with the parts that end its motion.
pub(super) fn limits(opened: &Opened, of: &Designed) -> Result<LimitsAnswer, String> {
    let LimitTable { table, notes, .. } = LimitTable::of(&opened.moved(&of.design)?)?;
    Ok(LimitsAnswer::of(
        "Limits of the mechanism",
        &table,
        |_| true,
        notes,
    ))
}
