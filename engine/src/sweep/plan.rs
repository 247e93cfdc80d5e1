//! Plan of a sweep: the results for each design, and the workers that compute them.

mod description;
mod goals;
mod requests;
mod targets;
mod worker;

pub use worker::Worker;

use super::record::{
    ELASTIC_BLOCKS_OF_PART, Kind, MoveRecord, OutputColumn, TargetColumn, VariableRecord,
};
use super::rows::{Failing, Rows};
use super::{BLOCKS_OF_PART, ColumnFault, FORM, Samples, SweepRecord, Swept};
use crate::ask::with_unit;
use crate::axle::AxlePlan;
use crate::characteristics::Quantity;
use crate::compliance::{AxleParameter, KcValue, Parameter};
use crate::curves::Column;
use crate::evaluate::{
    AxleStations, Block, ElasticAxleParts, ElasticQuantities, ElasticRead, Evaluator, NotInLanes,
    Request, Stations,
};
use crate::mechanism::DesignFault;
use crate::model::{Axis, Frame, Suspension};
use crate::number::{Vector3, Width};
use crate::plan::{Output, Plan};
use crate::study::{
    AxleSample, AxleStudy, ComplianceStudy, DesignTable, Designs, Optimise, Sample, Study,
    StudyErrors, Sweep, Target, TargetKind, Vehicle, WheelStudy,
};
use description::describe;
use goals::{GoalAssessor, GoalValues, Goals};
use requests::{is_figure, of_study};
use std::borrow::Cow;
use std::ops::{ControlFlow, Range};
use targets::{SweptTarget, SweptWish, TargetStations};

/// Plan of a sweep: the results to compute for each design.
#[derive(Clone, Debug)]
pub struct SweepPlan<'s> {
    /// Description of the results, as in `sweep.json`.
    pub record: SweepRecord,
    /// Quantities to read in each pose, including quantities of targets, and the stations of each design.
    request: Request<'s>,
    /// For each quantity, its derivatives with respect to the drive value. The list of a quantity is empty for a test result,
    /// and for a quantity that already is a derivative. For an axle, it contains the derivatives that the study requests.
    gains: Vec<Vec<Gain>>,
    /// Number of quantities that are read over the whole motion. The other quantities apply only to the design position.
    over_motion: usize,
    targets: Vec<SweptTarget>,
    /// Targets whose stations are not stations of the sweep, and all constraints. `None` if there are none.
    goals: Option<Goals>,
    samples: Samples,
    study: &'s Study,
}

/// A derivative of a quantity in the design position.
#[derive(Clone, Debug)]
struct Gain {
    column: String,
    unit: String,
    factor: f64,
    /// Index of the derivative among the slopes of a block.
    slope: usize,
}

/// Reason why a sweep cannot start.
#[derive(Debug)]
pub enum NotBegun {
    /// The file with the designs has an error.
    Designs(StudyErrors),
    /// The study's own design cannot be solved.
    Fault(DesignFault),
    /// The columns of the results cannot be written.
    Columns(ColumnFault),
}

impl From<DesignFault> for NotBegun {
    fn from(fault: DesignFault) -> Self {
        NotBegun::Fault(fault)
    }
}

impl<'s> SweepPlan<'s> {
    /// Plans the sweep of a study.
    pub fn of(study: &'s Study, sweep: &Sweep) -> Result<Self, NotBegun> {
        let suspension = study.wheel();
        let samples = match &sweep.designs {
            Designs::Sampled(sampled) => Samples::Sampled(sampled.clone()),
            Designs::File(path) => {
                Samples::Table(DesignTable::of_study(path, study).map_err(NotBegun::Designs)?)
            }
            Designs::Given(table) => Samples::Table(table.clone()),
        };
        let targets = study.optimise.as_ref();
        let targets = targets.map_or(&[][..], |o| o.ranking_targets());
        let is_swept = |target: &&Target| target.is_in_sweep(study.motion());
        let swept: Vec<Target> = targets.iter().filter(is_swept).cloned().collect();
        let others = targets.iter().filter(|target| !is_swept(target)).cloned();
        let others: Vec<Target> = others.collect();
        let goals = Goals::of(study, sweep, &others, samples.rates());
        let (request, gains, wishes) = of_study(study, sweep, &swept, &samples);
        let (mut wishes, mut of_goals) = (wishes.into_iter(), 0..);
        let targets = targets.iter().map(|target| SweptTarget {
            name: target.swept_name(suspension.length_unit),
            tolerance: target.tolerance,
            weight: target.weight,
            stations: if is_swept(&target) {
                TargetStations::OfSweep(wishes.next().unwrap_or_default())
            } else {
                TargetStations::Own(of_goals.next().unwrap_or_default())
            },
        });
        let figures = match &study.vehicle {
            Vehicle::Wheel(own) => Plan::with_targets(own, study.optimise.as_ref())
                .figures
                .len(),
            Vehicle::Axle(_) => {
                let quantities = request.axle().map_or(&[][..], |axle| &axle.quantities);
                quantities.iter().filter(|q| is_figure(q)).count()
            }
        };
        let mut plan = SweepPlan {
            over_motion: request.columns().len() - figures,
            targets: targets.collect(),
            goals,
            record: describe(study, sweep, &samples, request.stations()),
            request,
            gains,
            samples,
            study,
        };
        if plan.goals.is_some() && study.vehicle.is_elastic() {
            plan.record.blocks_of_part = ELASTIC_BLOCKS_OF_PART;
        }
        plan.record.outputs = plan.output_columns();
        plan.record.check_columns().map_err(NotBegun::Columns)?;
        let at_design = plan.worker()?.row_of(&suspension.design);
        for (output, value) in plan.record.outputs.iter_mut().zip(at_design) {
            output.at_design = value.is_finite().then_some(value);
        }
        Ok(plan)
    }

    /// Makes a worker. Each CPU thread has one worker.
    pub fn worker(&self) -> Result<Worker<'_>, DesignFault> {
        self.worker_of_width(Width::widest())
    }

    /// Makes a worker that solves designs in SIMD lanes of this width, or one by one if the width is `None`.
    pub fn worker_of_width(&self, width: Option<Width>) -> Result<Worker<'_>, DesignFault> {
        Ok(Worker {
            plan: self,
            evaluator: self.request.evaluator(width)?,
            block: self.request.block(),
            designs: Vec::new(),
            rates: Vec::new(),
            goals: match &self.goals {
                Some(goals) => Some(goals.assessor(self.study)?),
                None => None,
            },
            rows: Rows::default(),
        })
    }

    /// Runs the sweep like [`Swept::run`].
    pub fn run(
        &self,
        blocks: Range<u64>,
        go_on: impl Fn() -> bool + Sync,
        take: impl FnMut(&Rows) -> ControlFlow<()> + Send,
    ) {
        Swept::Suspension(self).run(blocks, go_on, take);
    }

    /// Stations of each design.
    pub fn stations(&self) -> &Stations {
        self.request.stations()
    }

    /// Quantities of one wheel, including quantities of targets. Empty for an axle, and for a wheel with elastic parts.
    pub fn quantities(&self) -> &[Quantity] {
        self.request.of_wheel()
    }

    /// Columns of the quantities' values, one for each quantity.
    pub fn values(&self) -> &[Column] {
        self.request.columns()
    }

    /// Quantities that are read in each pose of an axle, including quantities of targets. Empty for a study of one wheel.
    pub fn axle_quantities(&self) -> &[crate::axle::Quantity] {
        self.request.axle().map_or(&[], |axle| &axle.quantities)
    }

    /// Returns true if the file of designs has different design numbers than the results.
    pub fn has_other_numbers(&self) -> bool {
        matches!(&self.samples, Samples::Table(table) if table.has_other_numbers)
    }

    /// Number of columns in the file of designs that are results of another sweep. They are not read.
    pub fn results_in_designs(&self) -> usize {
        match &self.samples {
            Samples::Table(table) => table.results,
            Samples::Sampled(_) => 0,
        }
    }

    /// Points of the design with this number, in the kernel's frame.
    pub fn design(&self, number: u64) -> Vec<Vector3<f64>> {
        let Suspension { design, frame, .. } = self.study.wheel();
        let mut values = vec![0.0; self.samples.variables().len()];
        self.samples.values(number, &mut values);
        let mut moved = design.clone();
        self.samples.place(&values, frame, design, &mut moved);
        moved
    }

    /// Returns the study with the hardpoints and rates of the design with this number.
    pub fn moved(&self, number: u64) -> Study {
        let mut moved = self.study.at_design(self.design(number));
        let mut values = vec![0.0; self.samples.variables().len()];
        self.samples.values(number, &mut values);
        let mut rates = Vec::new();
        self.samples.append_rates(&values, &mut rates);
        for (rate, value) in self.samples.rates().zip(rates) {
            moved.vehicle.set_rate(rate.parameter.into(), value);
        }
        moved
    }

    /// Returns true if a quantity is read over the motion, false if it applies only to the design position.
    fn is_over_motion(&self, quantity: usize) -> bool {
        quantity < self.over_motion
    }

    /// Columns of results, in the order in which [`Worker`] writes them.
    fn output_columns(&self) -> Vec<OutputColumn> {
        let mut columns = Vec::new();
        for (number, (value, gains)) in self.values().iter().zip(&self.gains).enumerate() {
            let output = value.output.as_str();
            let kinds = [
                ("min", Kind::Min),
                ("max", Kind::Max),
                ("design", Kind::Design),
            ];
            let first = if self.is_over_motion(number) { 0 } else { 2 };
            for (word, kind) in kinds.into_iter().skip(first) {
                let name = with_unit(format!("{output}_{word}"), &value.unit);
                columns.push(OutputColumn::new(name, output, kind, &value.unit));
            }
            for gain in gains {
                let column = gain.column.clone();
                columns.push(OutputColumn::new(column, output, Kind::Gain, &gain.unit));
            }
        }
        let names = self.targets.iter().map(|target| target.name.clone());
        columns.extend(OutputColumn::of_targets(&names.collect::<Vec<_>>()));
        let margins = self.goals.iter().flat_map(|goals| &goals.columns);
        columns.extend(margins.cloned());
        columns
    }

    /// Writes the outputs of a design, given by its index in the block. `goals` are the values of [`SweepPlan::goals`].
    fn summarise(
        &self,
        block: &Block,
        design: usize,
        goals: Option<&GoalValues>,
        into: &mut [f64],
    ) {
        let mut cells = into.iter_mut();
        let mut put = |value: f64| {
            let cell = cells.next().expect("each output has a cell");
            // A number that is not finite becomes NaN, and a negative zero becomes 0.
            *cell = if value.is_finite() {
                value + 0.0
            } else {
                f64::NAN
            };
        };
        for (k, (column, gains)) in self.values().iter().zip(&self.gains).enumerate() {
            let (value_at, factor) = (|station| block.value(design, k, station), column.factor());
            if !self.is_over_motion(k) {
                put(value_at(self.stations().design()) * factor);
                continue;
            }
            let (mut min, mut max) = (f64::INFINITY, f64::NEG_INFINITY);
            for station in self.stations().of_motion() {
                let value = value_at(station) * factor;
                // If some stations have no value, the user could mistake the range over the other stations for the range
                // over the whole motion. So the range is NaN.
                (min, max) = if value.is_nan() {
                    (f64::NAN, f64::NAN)
                } else {
                    (
                        if value < min { value } else { min },
                        if value > max { value } else { max },
                    )
                };
                if min.is_nan() {
                    break;
                }
            }
            put(min);
            put(max);
            put(value_at(self.stations().design()) * factor);
            for gain in gains {
                put(block.slope(design, gain.slope) * gain.factor);
            }
        }
        let (mut squares, mut weights) = (0.0, 0.0);
        for target in &self.targets {
            let square = |wish: &SweptWish| {
                let value = block.value(design, wish.quantity, wish.station);
                let deviation = wish.wanted.deviation(value) / target.tolerance;
                deviation * deviation
            };
            let (rms, square) = match &target.stations {
                TargetStations::OfSweep(wishes) => {
                    let square = wishes.iter().map(square).sum::<f64>() / wishes.len() as f64;
                    (square.sqrt(), square)
                }
                TargetStations::Own(number) => {
                    let rms = goals.map_or(f64::NAN, |goals| goals.rms[*number]);
                    (rms, rms * rms)
                }
            };
            put(rms);
            squares += target.weight * square;
            weights += target.weight;
        }
        if weights > 0.0 {
            put((squares / weights).sqrt());
        }
        for margin in goals.into_iter().flat_map(|goals| &goals.margins) {
            put(*margin);
        }
    }

    /// Writes the reason of the failure for each design of the block that failed at a station.
    fn failing(&self, block: &Block, into: &mut Vec<Option<Failing>>) {
        into.clear();
        into.resize(block.designs(), None);
        let values = self.stations().values();
        let drive = self.study.motion().drive;
        for failed in block.failures() {
            let entry = &mut into[failed.design];
            let count = entry.as_ref().map_or(0, |f| f.stations);
            if self.request.is_in_motion(failed.station) {
                let at = drive.printed(values[self.stations().value_of(failed.station)]);
                let nearer = |f: &Failing| f.at.is_none_or(|known| at.abs() < known.abs());
                if entry.as_ref().is_none_or(nearer) {
                    *entry = Some(Failing::stations(&failed.failure, at));
                }
            } else if entry.is_none() {
                *entry = Some(Failing::beside(&failed.failure));
            }
            if let Some(entry) = entry {
                entry.stations = count + 1;
            }
        }
        let mechanism = &self.study.wheel().mechanism;
        for (design, fault) in block.faults() {
            let all = self.stations().count();
            into[*design] = Some(Failing::degenerate(fault, mechanism, all));
        }
    }
}
