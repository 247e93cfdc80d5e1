//! What manufacturing scatter does to curves and figures.
//!
//! Parts scatter by independent numbers z with mean m and variance s^2 ([`crate::study::Source`]). Whatever is read off a
//! build is, about the drawing,
//!
//! ```text
//! y = y0 + g.z + z.H z/2 + ...
//! sigma^2 = sum of g_k^2 s_k^2        first order, each term a share
//! mean y - y0 = tr(H S)/2             second order, m = 0
//! sigma^2 grows by tr((H S)^2)/2      of normal z; a uniform z_k adds H_kk^2 s_k^4 (1.8 - 3)/4
//! ```
//!
//! g and H are exact ([`crate::build`]): no difference quotients. Beside them a Monte Carlo puts builds together
//! and solves them over the motion. The linear answer is said to hold where mean shift squared and growth of the variance are
//! below 2 % of sigma^2.

mod builds;
mod draw;
mod expansion;
mod lanes;
mod monte_carlo;
mod order;
mod yields;

pub use draw::normal_quantile;
pub use expansion::{Expansion, HOLDS, Remainder};
pub use monte_carlo::{MonteCarlo, Spread, monte_carlo, monte_carlo_in};
pub use yields::{BandYield, Ranking, Yields, rank};

use crate::build::{Alignment, Assembler, NoSetUp};
use crate::characteristics::{Characteristic, Quantity};
use crate::mechanism::DesignFault;
use crate::study::{Study, Tolerance};
use crate::sweep::Stations;

/// The percentiles that are reported.
pub const PERCENTILES: [f64; 7] = [0.5, 1.0, 5.0, 50.0, 95.0, 99.0, 99.5];

/// A study's tolerances, made ready.
pub struct Problem<'a> {
    /// The study.
    pub study: &'a Study,
    /// Its tolerances.
    pub tolerance: &'a Tolerance,
    /// Puts builds together.
    pub assembler: Assembler,
    /// What is looked at: the study's outputs, then those of bands.
    pub characteristics: Vec<Characteristic>,
    /// Where: the stations of the motion, the drawn position, the places of bands.
    pub stations: Stations,
    quantities: Vec<Quantity>,
    alignment: Option<Alignment>,
}

impl<'a> Problem<'a> {
    /// Of a study. An error says why its own design cannot be solved, or not be aligned.
    pub fn of(study: &'a Study, tolerance: &'a Tolerance) -> Result<Self, NoSetUp> {
        let assembler = Assembler::new(&study.suspension)?;
        let mut characteristics = study.outputs.characteristics.clone();
        for band in &tolerance.bands {
            if !characteristics.contains(&band.characteristic) {
                characteristics.push(band.characteristic);
            }
        }
        let further: Vec<f64> = tolerance.bands.iter().filter_map(|band| band.at).collect();
        let stations = Stations::of(&study.motion, &study.suspension.frame, &further);
        let alignment = match (tolerance.aligned, &study.setup) {
            (true, Some(setup)) => Some(Alignment::of(&setup.adjust, &assembler)?),
            _ => None,
        };
        Ok(Problem {
            study,
            tolerance,
            quantities: characteristics
                .iter()
                .map(|c| Quantity::Characteristic(*c))
                .collect(),
            assembler,
            characteristics,
            stations,
            alignment,
        })
    }

    /// Number of values of a build: outputs times stations.
    pub fn cells(&self) -> usize {
        self.characteristics.len() * self.stations.count()
    }

    /// The value's number of an output at a station.
    pub fn cell(&self, output: usize, station: usize) -> usize {
        output * self.stations.count() + station
    }

    /// The stations at which a band is looked at.
    pub fn stations_of(&self, band: &crate::study::Band) -> Vec<usize> {
        match band.at {
            Some(at) => self.stations.at(at).into_iter().collect(),
            None => self
                .stations
                .of_motion()
                .map(|(rack, value)| self.stations.number(rack, value))
                .collect(),
        }
    }

    /// The place of a characteristic among those looked at.
    pub fn output(&self, characteristic: Characteristic) -> usize {
        let place = self
            .characteristics
            .iter()
            .position(|c| *c == characteristic);
        place.expect("every band's characteristic is looked at")
    }

    /// The values of the suspension as drawn, by cell.
    pub fn drawn(&self) -> Result<Vec<f64>, DesignFault> {
        builds::drawn_values(self)
    }
}
