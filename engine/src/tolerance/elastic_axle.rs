//! First-order result of the tolerance analysis of an axle with elastic parts.
//!
//! Deviations of the parts of a wheel move only the built design of that wheel. Rates (stiffnesses) also scatter. The rates of the
//! two wheels scatter independently, and a shared part has one rate. With p the built designs and k the rates,
//!
//! ```text
//! dy/dx = (dy/dp_left) (dp_left/dx) + (dy/dp_right) (dp_right/dx) + (dy/dk) (dk/dx)
//! ```
//!
//! Parts of a solid axle on five links cause tensions T in the links of a build ([`crate::assembly`]). These tensions add the
//! term (dy/dT) (dT/dx).
//!
//! For each station, a tape (a record of the operations, for adjoint differentiation) gives the derivatives of the values.
//! Second derivatives are not computed.

use super::Problem;
use super::axle_expansion::moves;
use super::elastic::{rates, write_slopes};
use super::wheel_assembler::WheelAssembler;
use crate::assembly::SetUpError;
use crate::axle::AxleRead;
use crate::compliance::{AxleParameter, Parameter};
use crate::evaluate::AxleStations;
use crate::model::{Axis, PointId, Side};
use crate::study::{AxleComplianceStudy, Source, Tolerance};

/// Inputs of the elastic parts that differ between builds: first the rates that scatter, then the tensions of links.
pub(super) fn inputs<'t>(
    tolerance: &'t Tolerance,
    left: &'t WheelAssembler,
) -> impl Iterator<Item = AxleParameter> + 't {
    let tensions = left.tensions.iter().map(|own| own.parameter);
    rates(tolerance).map(|(of, _)| of).chain(tensions)
}

/// Derivatives of the tensions of links with respect to each tolerance source, `[source][link]`, in the order of [`inputs`].
fn tensions(problem: &Problem, sources: &[&Source]) -> Result<Vec<f64>, SetUpError> {
    let left = &problem.wheel_assemblers[0];
    if left.tensions.is_empty() {
        return Ok(Vec::new());
    }
    let assembler = &left.assembler;
    let built = assembler.build_drawn()?;
    let by_source = sources.iter().flat_map(|source| {
        let by = assembler.tensions_by(&built, left.changes(source));
        let links = left.tensions.iter();
        links.map(move |own| by.map_or(0.0, |by| by[own.link]))
    });
    Ok(by_source.collect())
}

/// Derivatives of every cell (an output at a station) with respect to each tolerance source, `[cell][source]`. NaN if
/// there is no value.
pub(super) fn gradients(
    problem: &Problem,
    stations: &AxleStations<'_>,
    elastic: &AxleComplianceStudy,
    sources: &[&Source],
) -> Result<Vec<f64>, SetUpError> {
    let moves = moves(problem, sources)?;
    let tensions = tensions(problem, sources)?;
    let axle = &stations.axle;
    let equilibria = axle.own_equilibria(elastic);
    let equilibria = equilibria.map_err(|(_, fault)| SetUpError::Fault(fault))?;
    let mut parameters: Vec<AxleParameter> = Vec::new();
    for side in Side::ALL {
        for point in (0..axle.left.design.len()).map(PointId) {
            parameters.extend(Axis::ALL.map(|axis| AxleParameter {
                parameter: Parameter::Point(point, axis),
                side: Some(side),
            }));
        }
    }
    parameters.extend(inputs(problem.tolerance, &problem.wheel_assemblers[0]));
    let mut gradient = vec![f64::NAN; problem.cells() * sources.len()];
    for (station, placement) in stations.placements.iter().enumerate() {
        let Some(at) = placement.on_level_pads() else {
            continue;
        };
        let numbers = stations.quantities_at(station);
        let reads = numbers.iter().map(|k| stations.quantities[*k].into());
        let reads: Vec<AxleRead> = reads.collect();
        // A station without an equilibrium has no derivatives.
        let _: Result<(), _> =
            equilibria.gradients(at, &reads, &parameters, &mut |number, _, by| {
                let cell = problem.cell(numbers[number], station);
                let into = &mut gradient[cell * sources.len()..][..sources.len()];
                let width = tensions.len() / sources.len().max(1);
                let (by, by_tensions) = by.split_at(by.len() - width);
                write_slopes(sources, |k| &moves[k][..], by, into);
                for (slope, by_source) in into.iter_mut().zip(tensions.chunks_exact(width.max(1))) {
                    let along = by_source.iter().zip(by_tensions).map(|(t, y)| t * y);
                    *slope += along.sum::<f64>();
                }
            });
    }
    Ok(gradient)
}
