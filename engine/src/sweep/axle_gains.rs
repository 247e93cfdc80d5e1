//! Gains of an axle: derivatives by each number that moves, in the design position, one design after another.
//!
//! They take one derivative more than the values do, which lanes do not carry.

use super::axle::{AxleStations, pair};
use super::evaluate::{Block, FindsSlopes, Pairs};
use crate::axle::{AxleSolver, Read};
use crate::mechanism::DesignFault;

/// Those that are asked for; `None` where none are.
pub(super) fn axle_gains<'a>(
    stations: &'a AxleStations<'a>,
) -> Result<Option<Box<dyn FindsSlopes + 'a>>, DesignFault> {
    if stations.gains.is_empty() {
        return Ok(None);
    }
    let quantities = stations.gains.iter().filter_map(|g| g.quantity());
    let orders = quantities.map(|q| q.rate_order());
    Ok(Some(match orders.max().unwrap_or(0) {
        0 => Gains::<2>::boxed(stations)?,
        1 => Gains::<3>::boxed(stations)?,
        _ => Gains::<4>::boxed(stations)?,
    }))
}

struct Gains<'a, const N: usize> {
    stations: &'a AxleStations<'a>,
    solver: AxleSolver<'a, N>,
}

impl<'a, const N: usize> Gains<'a, N> {
    fn boxed(stations: &'a AxleStations<'a>) -> Result<Box<dyn FindsSlopes + 'a>, DesignFault> {
        let solver = AxleSolver::new(&stations.axle, &stations.quantities, stations.steers);
        Ok(Box::new(Gains::<N> {
            stations,
            solver: solver.map_err(|(_, fault)| fault)?,
        }))
    }

    fn read(&mut self, wheels: Pairs<'_>) -> Option<Read<'a>> {
        self.solver.prepare(wheels).ok()?;
        let placed = self.solver.place(&self.stations.design_placement()).ok()?;
        self.solver.read(&placed).ok()
    }
}

impl<const N: usize> FindsSlopes for Gains<'_, N> {
    fn evaluate(&mut self, designs: Pairs<'_>, block: &mut Block) {
        let points = self.stations.axle.left.design.len();
        for number in 0..designs[0].len() / points {
            let read = self.read(pair(designs, number, points));
            for (k, column) in self.stations.gains.iter().enumerate() {
                let gain = read.as_ref().and_then(|read| column.evaluate(read)?.ok());
                block.put_slope(number, k, gain.unwrap_or(f64::NAN));
            }
        }
    }
}
