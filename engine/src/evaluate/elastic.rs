//! Wheels with elastic parts, one design at a time: values in equilibrium and test figures.

use super::evaluator::{Evaluator, Pairs, SolvesOneByOne};
use super::{Block, NotInLanes, Stations};
use crate::compliance::{ElasticWheel, KcRun, KcValue, Parameter};
use crate::mechanism::DesignFault;
use crate::model::{Axis, Suspension};
use crate::study::{ComplianceStudy, WheelStudy};

/// A value that a sweep or a tolerance reads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ElasticRead {
    /// The value.
    pub value: KcValue,
    /// Derivative by wheel travel, if it is requested in the design position.
    pub slope: Option<KcValue>,
}

/// Values of a wheel with elastic parts at stations.
#[derive(Clone, Debug)]
pub(crate) struct ElasticQuantities {
    suspension: Suspension,
    elastic: ComplianceStudy,
    reads: Vec<ElasticRead>,
    /// Indices of the values to read at each station.
    at_stations: Vec<Vec<usize>>,
    /// Rates that differ between designs.
    rates: Vec<Parameter>,
}

impl ElasticQuantities {
    /// Values of a wheel: characteristics at every station, test figures in the design position. `further` lists more, as
    /// pairs of value and station. `rates` differ between designs.
    pub(crate) fn of(
        own: &WheelStudy,
        elastic: &ComplianceStudy,
        stations: &Stations,
        reads: Vec<ElasticRead>,
        further: &[[usize; 2]],
        rates: Vec<Parameter>,
    ) -> Self {
        let is_read = |value: usize, station: usize| {
            let is_figure = matches!(reads[value].value, KcValue::Figure { .. });
            !is_figure || station == stations.design() || further.contains(&[value, station])
        };
        let at_station = |station| {
            (0..reads.len())
                .filter(|value| is_read(*value, station))
                .collect()
        };
        let at_stations = (0..stations.count()).map(at_station).collect();
        ElasticQuantities {
            suspension: own.suspension.clone(),
            elastic: elastic.clone(),
            reads,
            at_stations,
            rates,
        }
    }

    /// Indices of the values to read at a station.
    pub(super) fn read_at(&self, station: usize) -> &[usize] {
        &self.at_stations[station]
    }

    /// Evaluator of designs. An error says why the study's own design has no elastic model.
    pub(super) fn evaluator<'a>(
        &'a self,
        stations: &'a Stations,
    ) -> Result<Evaluator<'a>, DesignFault> {
        let (suspension, parts) = (&self.suspension, &self.elastic.parts);
        let own = ElasticWheel::new(suspension, parts);
        own.map_err(|fault| fault.of_design(parts, suspension))?;
        let one_by_one = ElasticOneByOne {
            of: self,
            elastic: self.elastic.clone(),
            stations,
            rates: Vec::new(),
            wanted: Vec::new(),
        };
        let mut evaluator = Evaluator::of(suspension.design.len(), Box::new(one_by_one));
        evaluator.lanes = Err(NotInLanes::Elastic);
        Ok(evaluator)
    }
}

/// Evaluates one design at a time.
struct ElasticOneByOne<'a> {
    of: &'a ElasticQuantities,
    elastic: ComplianceStudy,
    stations: &'a Stations,
    /// Rates of the block's designs. Empty if none varies.
    rates: Vec<f64>,
    wanted: Vec<KcValue>,
}

impl SolvesOneByOne for ElasticOneByOne<'_> {
    fn evaluate(&mut self, designs: Pairs<'_>, numbers: &[usize], block: &mut Block) {
        let points = self.of.suspension.design.len();
        for &number in numbers {
            let design = &designs[0][number * points..(number + 1) * points];
            block.forget(number);
            let width = self.of.rates.len();
            let own = &self.rates[(number * width).min(self.rates.len())..];
            if own.iter().take(width).any(|rate| *rate <= 0.0) {
                let reason = "the rate of an elastic part is not above 0".to_owned();
                block.faults.push((number, DesignFault::Elastic(reason)));
                continue;
            }
            for (parameter, value) in self.of.rates.iter().zip(own) {
                self.elastic.parts.set_rate(*parameter, *value);
            }
            let (suspension, parts) = (&self.of.suspension, &self.elastic.parts);
            match KcRun::of(suspension, design, parts, self.elastic.tyre_rate) {
                Ok(run) => read(
                    self.of,
                    self.stations,
                    &run,
                    number,
                    &mut self.wanted,
                    block,
                ),
                Err(fault) => block
                    .faults
                    .push((number, fault.of_design(parts, suspension))),
            }
        }
    }

    fn take_rates(&mut self, rates: &[f64]) {
        self.rates.clear();
        self.rates.extend_from_slice(rates);
    }
}

/// Reads all values of a design.
fn read(
    of: &ElasticQuantities,
    stations: &Stations,
    run: &KcRun<'_>,
    design: usize,
    wanted: &mut Vec<KcValue>,
    block: &mut Block,
) {
    let sign = of.suspension.frame.sign(Axis::Y);
    for (station, numbers) in of.at_stations.iter().enumerate() {
        let travel = stations.values()[stations.value_of(station)];
        let rack = stations.racks[stations.rack_of(station)] * sign;
        let slopes: Vec<usize> = if station == stations.design() {
            (0..of.reads.len())
                .filter(|k| of.reads[*k].slope.is_some())
                .collect()
        } else {
            Vec::new()
        };
        wanted.clear();
        wanted.extend(numbers.iter().map(|k| of.reads[*k].value));
        wanted.extend(slopes.iter().filter_map(|k| of.reads[*k].slope));
        match run.values([travel, rack], wanted) {
            Err(why) => block.fail(design, station, why.into()),
            Ok(found) => {
                let (values, of_slopes) = found.split_at(numbers.len());
                for (number, value) in numbers.iter().zip(values) {
                    block.put(design, *number, station, value.unwrap_or(f64::NAN));
                }
                for (number, slope) in slopes.iter().zip(of_slopes) {
                    block.put_slope(design, *number, slope.unwrap_or(f64::NAN));
                }
            }
        }
    }
}
