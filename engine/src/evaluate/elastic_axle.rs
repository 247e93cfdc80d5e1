//! Axles with elastic parts, one design at a time: quantities in equilibrium, test results in the design position.

use super::evaluator::{Design, Evaluator, FindsSlopes, SolvesOneByOne};
use super::{AxleStations, Block, NotInLanes};
use crate::axle::{AxleColumn, AxleRead, Equilibria, Quantity};
use crate::compliance::{AxleCompliance, AxleParameter};
use crate::mechanism::{DesignFault, NoPose};
use crate::study::AxleComplianceStudy;

/// Elastic parts of an axle whose designs are evaluated.
#[derive(Clone, Debug)]
pub(crate) struct ElasticAxleParts {
    /// Rates of elastic parts and tensions that differ between designs.
    pub rates: Vec<AxleParameter>,
    /// Test results to read at stations other than the design position, as [quantity, station].
    pub further: Vec<[usize; 2]>,
}

impl AxleStations<'_> {
    /// Quantities to read at a station: test results only where requested, all other quantities at every station.
    pub(crate) fn quantities_at(&self, station: usize) -> Vec<usize> {
        let further = self.elastic.as_ref().map_or(&[][..], |own| &own.further);
        let is_read = |k: &usize| {
            let is_figure = matches!(self.quantities[*k], Quantity::Figure(_));
            !is_figure || station == self.design || further.contains(&[*k, station])
        };
        (0..self.quantities.len()).filter(is_read).collect()
    }

    /// Evaluator of designs with elastic parts. An error says why the axle's own design has no elastic model.
    pub(super) fn elastic_evaluator<'s>(
        &'s self,
        elastic: &'s AxleComplianceStudy,
    ) -> Result<Evaluator<'s>, DesignFault> {
        let own = self.axle.own_equilibria(elastic);
        own.map_err(|(_, fault)| fault)?;
        let reader = || OneByOne {
            stations: self,
            parts: elastic.parts.clone(),
        };
        let mut evaluator = Evaluator::of(self.axle.left.design.len(), Box::new(reader()));
        evaluator.axle = Some(&self.axle);
        evaluator.lanes = Err(NotInLanes::Elastic);
        if !self.gains.is_empty() {
            evaluator.slopes = Some(Box::new(reader()));
        }
        Ok(evaluator)
    }
}

/// Evaluates elastic axles, one design at a time.
struct OneByOne<'a> {
    stations: &'a AxleStations<'a>,
    parts: AxleCompliance,
}

impl<'a> OneByOne<'a> {
    /// Prepares the equilibria of a design.
    fn equilibria(&mut self, design: Design<'_>) -> Result<Equilibria<'a>, DesignFault> {
        let parameters = self.stations.elastic.as_ref();
        let parameters = parameters.map_or(&[][..], |own| &own.rates);
        for (parameter, value) in parameters.iter().zip(design.rates) {
            parameter.parameter.check(*value)?;
            self.parts.set_rate(*parameter, *value);
        }
        let found = self.stations.axle.equilibria(design.wheels, &self.parts);
        found.map_err(|(_, fault)| fault)
    }
}

impl SolvesOneByOne for OneByOne<'_> {
    fn evaluate(&mut self, design: Design<'_>, block: &mut Block) -> Result<(), DesignFault> {
        let equilibria = self.equilibria(design)?;
        for (station, placement) in self.stations.placements.iter().enumerate() {
            let quantities = self.stations.quantities_at(station);
            let reads = quantities.iter().map(|k| self.stations.quantities[*k]);
            let reads: Vec<AxleRead> = reads.map(AxleRead::from).collect();
            let found = match placement.on_level_pads() {
                Some(at) => equilibria.values(at, &reads).map_err(NoPose::from),
                None => Err(NoPose::NoGround),
            };
            match found {
                Err(why) => block.fail(design.number, station, why),
                Ok(values) => {
                    for (k, value) in quantities.into_iter().zip(values) {
                        if let Some(value) = value {
                            block.put(design.number, k, station, value);
                        }
                    }
                }
            }
        }
        Ok(())
    }
}

/// Computes derivatives in the design position with respect to each moving coordinate.
impl FindsSlopes for OneByOne<'_> {
    fn evaluate(&mut self, design: Design<'_>, block: &mut Block) {
        let stations = self.stations;
        let gains = stations.gains.iter();
        let reads: Vec<AxleRead> = gains.filter_map(AxleColumn::read).collect();
        let at = stations.placements[stations.design].on_level_pads();
        let at = at.filter(|_| stations.has_values_at_design(design.number, block));
        let found = at.and_then(|at| {
            let axle = self.equilibria(design).ok()?;
            axle.values(at, &reads).ok()
        });
        for k in 0..reads.len() {
            let slope = found.as_ref().and_then(|values| values[k]);
            block.put_slope(design.number, k, slope.unwrap_or(f64::NAN));
        }
    }
}
