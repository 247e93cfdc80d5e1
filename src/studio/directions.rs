//! Remaining freedom of a design: moves that leave the targets unchanged, and the limits of the mechanism.

use super::message::{Designed, DirectionsAnswer, FreeDirection, LimitEnd, LimitsAnswer};
use super::study_file::Opened;
use crate::analyse::{Range, RangeEnd};
use crate::model::Axis;
use crate::optimise::{Bounds, Identifiability, assessed};
use crate::solve::Solver;
use crate::study::Variable;

/// Largest change of the misfit, in tolerances, by a move across the whole range that counts as no change.
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
    // A turn moves points along arcs, not straight lines, and a rate moves no point.
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

/// Limits of wheel and rack from the design position, with their causes.
pub(super) fn limits(opened: &Opened, of: &Designed) -> Result<LimitsAnswer, String> {
    let moved = opened.moved(&of.design)?;
    if moved.is_elastic() {
        return Err("limits need the rigid mechanism: the study has [compliance]".to_owned());
    }
    let suspension = moved.wheel();
    let mechanism = &suspension.mechanism;
    let fault = |fault: crate::mechanism::DesignFault| fault.describe(mechanism);
    let mut solver = Solver::new(mechanism, &suspension.design).map_err(fault)?;
    let limits = solver.limits().map_err(fault)?;
    let sign = suspension.frame.sign(Axis::Y);
    Ok(LimitsAnswer {
        travel: ends(&limits.travel, 1.0),
        rack: limits.rack.as_ref().map(|range| ends(range, sign)),
    })
}

fn ends(range: &Range, sign: f64) -> [LimitEnd; 2] {
    let end = |end: &RangeEnd| match end {
        RangeEnd::Fold(limit) => LimitEnd {
            value: Some(sign * limit.value),
            because: limit.cause.to_string(),
        },
        RangeEnd::FullTurn => LimitEnd {
            value: None,
            because: "no limit: it turns all the way round".to_owned(),
        },
        RangeEnd::Toggle { value, rod } => LimitEnd {
            value: Some(sign * value),
            because: format!("the {rod} is at toggle"),
        },
        RangeEnd::Unresolved(value) => LimitEnd {
            value: Some(sign * value),
            because: "the path could not be followed further".to_owned(),
        },
    };
    let [lower, upper] = [end(&range.lower), end(&range.upper)];
    if sign < 0.0 {
        [upper, lower]
    } else {
        [lower, upper]
    }
}
