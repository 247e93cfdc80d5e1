//! Wheels with elastic parts: values in equilibrium and test results, one design at a time.

use super::elastic_lanes::ElasticLanes;
use super::evaluator::{Design, Evaluator, SolvesOneByOne};
use super::{Block, NotInLanes, Stations};
use crate::compliance::{ElasticWheel, KcRun, KcValue, Parameter};
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::number::Width;
use crate::study::{ComplianceStudy, WheelStudy};

/// A value that a sweep or a tolerance analysis reads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ElasticRead {
    /// Test result or characteristic to read.
    pub value: KcValue,
    /// Derivative of the value with respect to wheel travel, if the study requests this derivative in the design position.
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
    /// Rates of elastic parts that differ between designs.
    rates: Vec<Parameter>,
}

impl ElasticQuantities {
    /// Lists the values of a wheel: characteristics at every station, test results in the design position. `further`
    /// lists additional pairs of value and station. `rates` are the rates of elastic parts that differ between designs.
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
        width: Option<Width>,
    ) -> Result<Evaluator<'a>, DesignFault> {
        let (suspension, parts) = (&self.suspension, &self.elastic.parts);
        let own = ElasticWheel::new(suspension, parts);
        let own = own.map_err(|fault| fault.of_design())?;
        let one_by_one = ElasticOneByOne(ElasticDesigns::new(self, stations));
        let mut evaluator = Evaluator::of(suspension.design.len(), Box::new(one_by_one));
        if let Some(width) = width {
            evaluator.lanes = if own.fits_lanes() {
                Ok(Box::new(ElasticLanes::new(self, stations, width)))
            } else {
                Err(NotInLanes::Elastic)
            };
        }
        Ok(evaluator)
    }
}

/// Reads the values of designs of an elastic wheel. The rates of elastic parts can differ between designs.
pub(super) struct ElasticDesigns<'a> {
    of: &'a ElasticQuantities,
    elastic: ComplianceStudy,
    stations: &'a Stations,
    /// Values to read at the present station, with the requested derivatives with respect to wheel travel.
    wanted: Vec<KcValue>,
}

impl<'a> ElasticDesigns<'a> {
    pub(super) fn new(of: &'a ElasticQuantities, stations: &'a Stations) -> Self {
        ElasticDesigns {
            of,
            elastic: of.elastic.clone(),
            stations,
            wanted: Vec::new(),
        }
    }

    pub(super) fn stations(&self) -> &'a Stations {
        self.stations
    }

    /// Prepares the elastic wheel of a design, with the equilibria and tests that its values need.
    pub(super) fn run(&mut self, design: Design<'_>) -> Result<KcRun<'a>, DesignFault> {
        for (parameter, value) in self.of.rates.iter().zip(design.rates) {
            parameter.check(*value)?;
            self.elastic.parts.set_rate(*parameter, *value);
        }
        let (suspension, parts) = (&self.of.suspension, &self.elastic.parts);
        KcRun::of(suspension, design.wheels[0], parts, self.elastic.tyre_rate)
            .map_err(|fault| fault.of_design())
    }

    /// Travel and rack displacement of a station, along the kernel's axes.
    pub(super) fn place(&self, station: usize) -> [f64; 2] {
        let stations = self.stations;
        let travel = stations.values()[stations.value_of(station)];
        [travel, stations.racks[stations.rack_of(station)]]
    }

    /// Values with derivatives with respect to wheel travel at a station.
    fn slopes(&self, station: usize) -> impl Iterator<Item = (usize, KcValue)> + '_ {
        let is_design = station == self.stations.design();
        let reads = self.of.reads.iter().enumerate();
        reads.filter_map(move |(k, read)| Some((k, read.slope.filter(|_| is_design)?)))
    }

    /// Selects the values to read at a station, for [`Self::wanted`].
    pub(super) fn want(&mut self, station: usize) {
        let mut wanted = std::mem::take(&mut self.wanted);
        wanted.clear();
        let numbers = self.of.at_stations[station].iter();
        wanted.extend(numbers.map(|k| self.of.reads[*k].value));
        wanted.extend(self.slopes(station).map(|(_, slope)| slope));
        self.wanted = wanted;
    }

    /// Values to read at the station of the last call of [`Self::want`].
    pub(super) fn wanted(&self) -> &[KcValue] {
        &self.wanted
    }

    /// Writes the values that are read at a station.
    pub(super) fn put(
        &self,
        found: &[Option<f64>],
        design: usize,
        station: usize,
        block: &mut Block,
    ) {
        let numbers = &self.of.at_stations[station];
        let (values, of_slopes) = found.split_at(numbers.len());
        for (number, value) in numbers.iter().zip(values) {
            block.put(design, *number, station, value.unwrap_or(f64::NAN));
        }
        for ((number, _), slope) in self.slopes(station).zip(of_slopes) {
            block.put_slope(design, number, slope.unwrap_or(f64::NAN));
        }
    }
}

/// Evaluates elastic wheels, one design at a time.
struct ElasticOneByOne<'a>(ElasticDesigns<'a>);

impl SolvesOneByOne for ElasticOneByOne<'_> {
    fn evaluate(&mut self, design: Design<'_>, block: &mut Block) -> Result<(), DesignFault> {
        let own = &mut self.0;
        let run = own.run(design)?;
        for station in 0..own.stations.count() {
            own.want(station);
            let [travel, rack] = own.place(station);
            match run.wheel().at(travel, rack) {
                Err(why) => block.fail(design.number, station, why.into()),
                Ok(at) => {
                    let values = run.values_at(&at, &own.wanted, |_, _| None);
                    own.put(&values, design.number, station, block);
                }
            }
        }
        Ok(())
    }
}
