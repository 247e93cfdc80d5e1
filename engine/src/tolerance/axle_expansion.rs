//! Exact first-order result of the tolerance analysis of an axle.
//!
//! Deviations of the parts of one side move only the built design of this side ([`crate::assembly`]). Values of the axle have
//! gradients with respect to every hardpoint coordinate of both sides. The gradients include the ground conditions, which
//! determine both travels (`AxleSolver::gradients`):
//!
//! ```text
//! dy/dx = (dy/dp_left) (dp_left/dx) + (dy/dp_right) (dp_right/dx)
//! ```
//!
//! Module `axle_second` computes the second order.

use super::Problem;
use super::wheel_assembler::WheelAssembler;
use crate::assembly::{Built, SetUpError};
use crate::evaluate::Evaluated;
use crate::model::Side;
use crate::number::Vector3;
use crate::study::Source;

/// Derivatives of the position of every point of a wheel with respect to a tolerance source.
pub(super) type Moves = Vec<Vector3<f64>>;

/// Derivatives of every cell (an output at a station) with respect to each tolerance source, `[cell][source]`. NaN if
/// there is no value or no derivative.
pub(super) fn gradients(problem: &Problem, sources: &[&Source]) -> Result<Vec<f64>, SetUpError> {
    let moves = moves(problem, sources)?;
    let drawn = |side: Side| {
        &problem.wheel_assemblers[side as usize]
            .assembler
            .suspension()
            .design[..]
    };
    let evaluator = problem.request.gradients(&[], None);
    let mut evaluator = evaluator.map_err(|(_, fault)| SetUpError::Fault(fault))?;
    let mut found = Evaluated::default();
    evaluator.evaluate(Side::ALL.map(drawn), &mut found);
    let mut gradients = vec![f64::NAN; problem.cells() * sources.len()];
    for output in 0..problem.outputs().len() {
        for station in 0..problem.stations().count() {
            if found.value(0, output, station).is_nan() {
                continue;
            }
            let cell = problem.cell(output, station);
            for (source, moves) in moves.iter().enumerate() {
                let of_side =
                    |(side, moves): (Side, &Moves)| found.along((0, output, station), side, moves);
                let sides = Side::ALL.into_iter().zip(moves).map(of_side);
                gradients[cell * sources.len() + source] = sides.sum::<f64>();
            }
        }
    }
    Ok(gradients)
}

/// Derivatives of the points of both built wheels with respect to each tolerance source.
pub(super) fn moves(problem: &Problem, sources: &[&Source]) -> Result<Vec<[Moves; 2]>, SetUpError> {
    let mut all: Vec<[Moves; 2]> = vec![Default::default(); sources.len()];
    for (side, wheel_assembler) in problem.wheel_assemblers.iter().enumerate() {
        let built = wheel_assembler.assembler.build_drawn()?;
        for (moves, own) in all
            .iter_mut()
            .zip(moves_of_wheel(wheel_assembler, &built, sources))
        {
            moves[side] = own;
        }
    }
    Ok(all)
}

/// Derivatives of the points of one built wheel with respect to each tolerance source. Empty for a source that does not move this
/// wheel.
pub(super) fn moves_of_wheel(
    wheel_assembler: &WheelAssembler,
    built: &Built,
    sources: &[&Source],
) -> impl Iterator<Item = Moves> {
    let own = move |source: &&Source| match wheel_assembler.direction(built, source) {
        direction if direction.is_empty() => Vec::new(),
        direction => wheel_assembler.assembler.design_by(built, &direction).0,
    };
    sources.iter().map(own)
}
