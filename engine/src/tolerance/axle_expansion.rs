//! The first-order answer of an axle, exact.
//!
//! Each side's parts move its built design alone ([`crate::assembly`]), and what is read of the axle has gradients by
//! every hardpoint coordinate of either side, with what the ground asks of both travels
//! ([`AxleSolver::gradients`]):
//!
//! ```text
//! dy/dx = (dy/dp_left) (dp_left/dx) + (dy/dp_right) (dp_right/dx)
//! ```
//!
//! The second order is in module `axle_second`.

use super::Problem;
use crate::assembly::{NoSetUp, Rest};
use crate::axle::{AxleSolver, Hold};
use crate::number::Vector3;
use crate::study::Source;
use crate::sweep::AxleStations;

/// How fast every value changes with each source: `[cell][source]`, NaN where there is no value.
pub(super) fn gradients(
    problem: &Problem,
    stations: &AxleStations,
    sources: &[&Source],
) -> Result<Vec<f64>, NoSetUp> {
    let orders = stations.quantities.iter().map(|q| q.rate_order());
    let on_plane = |p: &crate::axle::Placement| p.hold() != Hold::TravelsOnPads;
    let by_ground = usize::from(stations.placements.iter().any(on_plane));
    match orders.max().unwrap_or(0) + by_ground {
        0 => found::<1>(problem, stations, sources),
        1 => found::<2>(problem, stations, sources),
        2 => found::<3>(problem, stations, sources),
        _ => found::<4>(problem, stations, sources),
    }
}

/// How every point of a wheel moves with a source.
type Moves = Vec<Vector3<f64>>;

fn found<const N: usize>(
    problem: &Problem,
    stations: &AxleStations,
    sources: &[&Source],
) -> Result<Vec<f64>, NoSetUp> {
    let moves = moves(problem, sources)?;
    let mut gradients = vec![f64::NAN; problem.cells() * sources.len()];
    let solver = AxleSolver::<N>::new(&stations.axle, &stations.quantities, false);
    let mut solver = solver.map_err(|(_, fault)| NoSetUp::Fault(fault))?;
    let placed = solver.place_all(&stations.placements);
    for (station, placed) in placed.into_iter().enumerate() {
        let read = placed.and_then(|placed| Ok((placed, solver.read(&placed)?)));
        let Ok((placed, read)) = read else {
            continue;
        };
        let receive = |output: usize, by: [&[Vector3<f64>]; 2]| {
            if read.value(stations.quantities[output]).is_err() {
                return;
            }
            let cell = problem.cell(output, station);
            for (source, moves) in moves.iter().enumerate() {
                let of_side = |(moves, by): (&Moves, &[Vector3<f64>])| -> f64 {
                    let pairs = moves.iter().zip(by);
                    // What does not move adds nothing, even where the derivative by it has no value.
                    let moving = pairs.filter(|(way, _)| way.to_array() != [0.0; 3]);
                    moving.map(|(way, by)| by.dot(*way)).sum()
                };
                let sides = moves.iter().zip(by).map(of_side);
                gradients[cell * sources.len() + source] = sides.sum();
            }
        };
        // What cannot be differentiated stays unknown.
        let _ = solver.gradients(&placed, &stations.quantities, receive);
    }
    Ok(gradients)
}

/// How both wheels' built designs move with each source.
fn moves(problem: &Problem, sources: &[&Source]) -> Result<Vec<[Moves; 2]>, NoSetUp> {
    let mut all: Vec<[Moves; 2]> = vec![Default::default(); sources.len()];
    for (side, workshop) in problem.workshops.iter().enumerate() {
        let assembler = &workshop.assembler;
        let built = assembler.build(assembler.drawn(), Rest::Height(0.0))?;
        for (moves, source) in all.iter_mut().zip(sources) {
            let direction = workshop.direction(&built, source);
            if !direction.is_empty() {
                moves[side] = assembler.design_by(&built, &direction).0;
            }
        }
    }
    Ok(all)
}
