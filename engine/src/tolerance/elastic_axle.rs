//! The first-order answer of an axle with elastic parts.
//!
//! Each side's parts move its built design alone; rates scatter beside them, those of each wheel by themselves and those of
//! shared parts once. With p the built designs and k the rates,
//!
//! ```text
//! dy/dx = (dy/dp_left) (dp_left/dx) + (dy/dp_right) (dp_right/dx) + (dy/dk) (dk/dx)
//! ```
//!
//! The derivatives of a station's values come from one tape. Second derivatives are not formed.

use super::Problem;
use super::axle_expansion::moves;
use super::elastic::rates;
use crate::assembly::NoSetUp;
use crate::axle::AxleRead;
use crate::compliance::{AxleParameter, Parameter};
use crate::evaluate::AxleStations;
use crate::model::{Axis, PointId, Side};
use crate::number::{Tape, Vector3};
use crate::study::{AxleComplianceStudy, Source};

/// Derivatives of every value by each source (`[cell][source]`); NaN without a value.
pub(super) fn gradients(
    problem: &Problem,
    stations: &AxleStations<'_>,
    elastic: &AxleComplianceStudy,
    sources: &[&Source],
) -> Result<Vec<f64>, NoSetUp> {
    let moves = moves(problem, sources)?;
    let axle = &stations.axle;
    let designs = Side::ALL.map(|side| &axle.suspension(side).design[..]);
    let equilibria = axle.equilibria(designs, &elastic.parts);
    let equilibria = equilibria.map_err(|(_, fault)| NoSetUp::Fault(fault))?;
    let points = axle.left.design.len();
    let mut parameters: Vec<AxleParameter> = Vec::new();
    for side in Side::ALL {
        for point in (0..points).map(PointId) {
            parameters.extend(Axis::ALL.map(|axis| AxleParameter {
                parameter: Parameter::Point(point, axis),
                side: Some(side),
            }));
        }
    }
    let of_points = parameters.len();
    parameters.extend(rates(problem.tolerance).map(|(parameter, _)| parameter));
    let mut gradient = vec![f64::NAN; problem.cells() * sources.len()];
    let mut tape = Tape::default();
    for (station, placement) in stations.placements.iter().enumerate() {
        let Some(at) = placement.on_level_pads() else {
            continue;
        };
        let numbers = stations.quantities_at(station);
        let reads = numbers.iter().map(|k| stations.quantities[*k].into());
        let reads: Vec<AxleRead> = reads.collect();
        // A station without equilibrium has no derivatives.
        let _: Result<(), _> =
            equilibria.gradients(at, &reads, &parameters, &mut tape, &mut |number, _, by| {
                let cell = problem.cell(numbers[number], station);
                let (by_points, by_rates) = by.split_at(of_points);
                let by_sides: Vec<&[f64]> = by_points.chunks_exact(3 * points).collect();
                let mut by_rates = by_rates.iter();
                for (k, (source, moves)) in sources.iter().zip(&moves).enumerate() {
                    let along = |(way, by): (&Vector3<f64>, &[f64])| {
                        way.x * by[0] + way.y * by[1] + way.z * by[2]
                    };
                    let sides = moves.iter().zip(&by_sides);
                    let coordinates =
                        sides.flat_map(|(own, by)| own.iter().zip(by.chunks_exact(3)));
                    let mut slope: f64 = coordinates.map(along).sum();
                    if let Some(rate) = &source.rate {
                        let by = by_rates.next();
                        slope += by.map_or(0.0, |by| by * rate.scattered(0.0)[1]);
                    }
                    gradient[cell * sources.len() + k] = slope;
                }
            });
    }
    Ok(gradient)
}
