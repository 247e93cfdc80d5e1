//! Exact second-order result of the tolerance analysis of an axle.
//!
//! As for one wheel (module `expansion`), the deviations of the parts move along a direction by a variable distance. The
//! built designs of both wheels, the poses and the values in these poses are Taylor series in this distance. Module
//! `axle/series` computes the positions on the ground. Quantities that contain velocities have no second-order result.
//!
//! Positions that follow from a load have no second-order result, either.

use super::Problem;
use super::expansion::combined;
use crate::assembly::{Built, SetUpError};
use crate::axle::{
    AxleSolver, Carriers, DesignedWheel, Parts, Placement, Quantity, Series, SeriesPosition,
};
use crate::evaluate::AxleStations;
use crate::model::SteeringAxis;
use crate::number::{Jet, Vector3};
use crate::study::Source;

/// Largest number of positions of the axle as Taylor series. Their computation takes some seconds.
const MOST_SERIES: usize = 300_000;

/// Second-order terms of the mean and of the variance, for each cell (an output at a station).
pub(super) fn second(
    problem: &Problem,
    stations: &AxleStations,
) -> Result<Vec<[f64; 2]>, SetUpError> {
    let mechanism = &stations.axle.left.mechanism;
    let is_readable = |quantity: &Quantity| {
        let by_screw = mechanism.steering_axis == Some(SteeringAxis::Instantaneous)
            && matches!(quantity, Quantity::Corner(_, c) if c.info().reads_steering_axis());
        quantity.rate_order() == 0 && !by_screw
    };
    let readable: Vec<bool> = stations.quantities.iter().map(is_readable).collect();
    let count = problem.tolerance.sources();
    let work = count.saturating_mul(count + 1) / 2 * stations.placements.len();
    let positions = if work <= MOST_SERIES && readable.contains(&true) {
        Some(DrawnPositions::of(problem, stations)?)
    } else {
        None
    };
    let second_derivatives =
        positions.map(|positions| move |along: &[&Source]| positions.second_derivatives(along));
    Ok(combined(problem, &readable, second_derivatives))
}

/// Poses of the nominal axle.
struct DrawnPositions<'p> {
    problem: &'p Problem<'p>,
    stations: &'p AxleStations<'p>,
    built: Vec<Built>,
    parts: Parts,
    positions: Vec<Option<DrawnPosition>>,
}

/// A pose of the nominal axle, with data for its Taylor series.
struct DrawnPosition {
    at: SeriesPosition,
    /// True for each quantity that has a value in this pose.
    has_value: Vec<bool>,
}

impl<'p> DrawnPositions<'p> {
    fn of(problem: &'p Problem, stations: &'p AxleStations) -> Result<Self, SetUpError> {
        let axle = &stations.axle;
        let mut built = Vec::new();
        for wheel_assembler in &problem.wheel_assemblers {
            built.push(wheel_assembler.assembler.build_drawn()?);
        }
        // The slopes of the ground condition need first derivatives of both wheels.
        let solver = AxleSolver::<2>::new(axle, &stations.quantities, false);
        let mut solver = solver.map_err(|(_, fault)| SetUpError::Fault(fault))?;
        let placed = solver.place_all(&stations.placements);
        let position = |(placement, placed): (&Placement, Result<crate::axle::AxlePose, _>)| {
            // The mean travel under a load depends on forces, and second derivatives of forces are not computed.
            let placed = placed
                .ok()
                .filter(|_| !matches!(placement, Placement::AtLoad { .. }))?;
            let read = solver.read(&placed).ok()?;
            let has_value = |quantity: &Quantity| read.value(*quantity).is_ok();
            Some(DrawnPosition {
                at: solver.series_position(&placed, &read)?,
                has_value: stations.quantities.iter().map(has_value).collect(),
            })
        };
        let placements = stations.placements.iter();
        let positions = placements.zip(placed).map(position).collect();
        let slots: Vec<_> = stations
            .quantities
            .iter()
            .flat_map(|q| q.info().reads)
            .copied()
            .collect();
        Ok(DrawnPositions {
            problem,
            stations,
            built,
            parts: Parts::of(&slots, Carriers::of(axle)),
            positions,
        })
    }

    /// Second derivative of each cell (an output at a station). The derivative is along the sum of the directions of some
    /// tolerance sources, each scaled by its standard deviation.
    fn second_derivatives(&self, along: &[&Source]) -> Vec<f64> {
        let wheel_assemblers = self.problem.wheel_assemblers.iter().zip(&self.built);
        let designs: Vec<Vec<Vector3<Series>>> = wheel_assemblers
            .map(|(wheel_assembler, built)| wheel_assembler.series(built, along))
            .collect();
        let axle = &*self.stations.axle;
        let wheels = DesignedWheel::both(axle, &designs);
        let mut second_derivatives = vec![f64::NAN; self.problem.cells()];
        for (station, position) in self.positions.iter().enumerate() {
            let Some(position) = position else {
                continue;
            };
            let gear = Jet::constant(position.at.rack);
            let steered = DesignedWheel::steered(axle, &wheels, gear);
            let (state, _) = position.at.on_ground(axle, &self.parts, &steered);
            for (output, quantity) in self.stations.quantities.iter().enumerate() {
                if position.has_value[output] && quantity.rate_order() == 0 {
                    let value = quantity.evaluate(&state).derivative(2);
                    second_derivatives[self.problem.cell(output, station)] = value;
                }
            }
        }
        second_derivatives
    }
}
