//! Gains of an axle: derivatives by each number that moves, in the design position, one design after another.
//!
//! They take one derivative more than the values do, which lanes do not carry.

use super::Block;
use super::axle::AxleStations;
use crate::axle::{AxleSolver, Read};
use crate::mechanism::DesignFault;
use crate::number::Vector3;

/// Finds the gains of the designs of a block.
pub(super) trait AxleGains: Send {
    /// Of designs given as the left wheel's points of one after the other; what is not found is left empty.
    fn evaluate(&mut self, designs: &[Vector3<f64>], block: &mut Block);
}

/// Those that are asked for; `None` where none are.
pub(super) fn axle_gains<'a>(
    stations: &'a AxleStations<'a>,
) -> Result<Option<Box<dyn AxleGains + 'a>>, DesignFault> {
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
    right: Vec<Vector3<f64>>,
}

impl<'a, const N: usize> Gains<'a, N> {
    fn boxed(stations: &'a AxleStations<'a>) -> Result<Box<dyn AxleGains + 'a>, DesignFault> {
        let solver = AxleSolver::new(stations.axle, &stations.quantities, stations.steers);
        Ok(Box::new(Gains::<N> {
            stations,
            solver: solver.map_err(|(_, fault)| fault)?,
            right: Vec::new(),
        }))
    }

    fn read(&mut self, left: &[Vector3<f64>]) -> Option<Read<'a>> {
        let is_own = self.stations.right_design(left, &mut self.right);
        let right = if is_own { &self.right } else { left };
        self.solver.prepare([left, right]).ok()?;
        let placed = self.solver.place(&self.stations.design_placement()).ok()?;
        self.solver.read(&placed).ok()
    }
}

impl<const N: usize> AxleGains for Gains<'_, N> {
    fn evaluate(&mut self, designs: &[Vector3<f64>], block: &mut Block) {
        let points = self.stations.axle.left.design.len();
        for (number, left) in designs.chunks_exact(points).enumerate() {
            let read = self.read(left);
            for (k, column) in self.stations.gains.iter().enumerate() {
                let gain = read.as_ref().and_then(|read| column.evaluate(read)?.ok());
                block.put_slope(number, k, gain.unwrap_or(f64::NAN));
            }
        }
    }
}
