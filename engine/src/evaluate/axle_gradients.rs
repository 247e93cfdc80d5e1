//! Gradients of axle quantities with respect to the hardpoints of both wheels, one axle at a time.

use super::evaluator::Design;
use super::gradients_one_by_one::DifferentiatesOneByOne;
use super::{AxleStations, Evaluated};
use crate::axle::{AxleSolver, Hold};
use crate::mechanism::DesignFault;
use crate::model::Side;
use crate::number::Vector3;

/// Solves axles one after another. Each Taylor series has `N` coefficients.
struct OneByOne<'a, const N: usize> {
    stations: &'a AxleStations<'a>,
    solver: AxleSolver<'a, N>,
}

impl AxleStations<'_> {
    /// Makes a solver of values with their gradients. On a plane ground, the travels of the wheels at a required position
    /// depend on the hardpoints. The gradients then need one more order of derivatives than the values. An error says why
    /// the axle's own design cannot be solved.
    pub(super) fn differentiating(
        &self,
    ) -> Result<Box<dyn DifferentiatesOneByOne + '_>, (Side, DesignFault)> {
        let orders = self.quantities.iter().map(|q| q.rate_order());
        let is_on_plane = self
            .placements
            .iter()
            .any(|placement| placement.hold() != Hold::TravelsOnPads);
        Ok(match orders.max().unwrap_or(0) + usize::from(is_on_plane) {
            0 => OneByOne::<1>::new(self)?,
            1 => OneByOne::<2>::new(self)?,
            2 => OneByOne::<3>::new(self)?,
            _ => OneByOne::<4>::new(self)?,
        })
    }
}

impl<'a, const N: usize> OneByOne<'a, N> {
    fn new(stations: &'a AxleStations<'a>) -> Result<Box<Self>, (Side, DesignFault)> {
        let solver = AxleSolver::new(&stations.axle, &stations.quantities, false)?;
        Ok(Box::new(OneByOne { stations, solver }))
    }
}

impl<const N: usize> DifferentiatesOneByOne for OneByOne<'_, N> {
    fn evaluate(&mut self, design: Design<'_>, into: &mut Evaluated) -> Result<(), DesignFault> {
        let OneByOne { stations, solver } = self;
        let number = design.number;
        let prepared = stations.prepare(solver, design.wheels);
        prepared.map_err(|(_, fault)| fault)?;
        let placed = solver.place_all(&stations.placements);
        for (station, placed) in placed.into_iter().enumerate() {
            let read = placed.and_then(|placed| Ok((solver.read(&placed)?, placed)));
            let Ok((read, placed)) = read else {
                continue;
            };
            let toggle = read.toggle_failure(&placed);
            // A quantity without a value in this pose has no derivatives there.
            let (mut numbers, mut quantities) = (Vec::new(), Vec::new());
            for (k, quantity) in stations.quantities.iter().enumerate() {
                if let Ok(value) = read.value(*quantity) {
                    into.put(number, k, station, value);
                    numbers.push(k);
                    quantities.push(*quantity);
                }
            }
            let receive = |k: usize, gradients: [&[Vector3<f64>]; 2]| {
                for (side, gradient) in Side::ALL.into_iter().zip(gradients) {
                    into.put_gradients((number, numbers[k], station), side, gradient);
                }
            };
            let found = if stations.of_builds {
                solver.gradients_by_each_point(&placed, &quantities, receive)
            } else {
                solver.gradients(&placed, &quantities, receive)
            };
            into.solved_of(number)[station] = found.is_ok() && toggle.is_none();
        }
        Ok(())
    }
}
