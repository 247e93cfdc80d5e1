//! Sweeps of a car: results of load cases for each design.

use super::margins::{distinguish, margin_column, margin_columns};
use super::record::{
    CAR_BLOCKS_OF_PART, Kind, MoveRecord, OutputColumn, TargetColumn, VariableRecord,
};
use super::rows::{Failing, Rows};
use super::{ColumnFault, FORM, Samples, SweepRecord};
use crate::car::{
    AXLE_NAMES, Car, CarConstraint, CarFault, CarQuantity, CarRequest, CarTarget, CaseResult,
    RigGoals, moved,
};
use crate::study::{CarStudy, CarSweep, Sampled, Sampling, Target};

/// Plan of a sweep of a car: the results to compute for each design.
#[derive(Clone, Debug)]
pub struct CarSweepPlan<'s> {
    /// Description of the results, as in `sweep.json`.
    pub record: SweepRecord,
    study: &'s CarStudy,
    sweep: &'s CarSweep,
    samples: Samples,
    request: CarRequest<'s>,
    targets: &'s [CarTarget],
    /// For each target, the index of its result in the request.
    places: Vec<usize>,
    /// Constraints of load cases, each with the index of its result in the request. Empty if the sweep does not evaluate
    /// constraints.
    constraints: Vec<(&'s CarConstraint, usize)>,
    /// Targets and constraints of single axles (an axle without the car), each with the index of the axle.
    rigs: Vec<(usize, &'s RigGoals)>,
}

/// Reason why a sweep of a car cannot start.
#[derive(Debug)]
pub enum CarNotBegun {
    /// The study's own design cannot be solved.
    Fault(CarFault),
    /// The columns of the results cannot be written.
    Columns(ColumnFault),
}

impl<'s> CarSweepPlan<'s> {
    /// Plans the sweep of a study.
    ///
    /// # Errors
    /// Returns the reason if the study's own design cannot be solved, or if the columns cannot be written.
    pub fn of(study: &'s CarStudy, sweep: &'s CarSweep) -> Result<Self, CarNotBegun> {
        let tuning = study.optimise.as_ref();
        let targets = tuning.map_or(&[][..], |o| &o.targets);
        let constraints = tuning.filter(|_| sweep.constraints);
        let constraints = constraints.map_or(&[][..], |o| &o.constraints);
        let of_targets = targets.iter().map(|own| (own.case, own.quantity));
        let of_constraints = constraints.iter().map(|own| (own.case, own.quantity));
        let wanted = of_targets.chain(of_constraints);
        let wanted = wanted.map(|(case, quantity)| CaseResult { case, quantity });
        let request = CarRequest::of(&study.cases, &study.kept_quantities(), wanted);
        let constraints = constraints.iter();
        let constraints = constraints
            .filter_map(|own| Some((own, request.place(own.case, own.quantity)?)))
            .collect();
        let place = |target: &CarTarget| request.place(target.case, target.quantity);
        let places = targets.iter().filter_map(place).collect();
        let samples = Samples::Sampled(sweep.sampled.clone());
        let mut plan = CarSweepPlan {
            record: describe(study, sweep, targets),
            study,
            sweep,
            samples,
            request,
            targets,
            places,
            constraints,
            rigs: rigs(study),
        };
        plan.record.outputs = plan.outputs();
        plan.record.check_columns().map_err(CarNotBegun::Columns)?;
        let mut values = vec![f64::NAN; plan.record.outputs.len()];
        let mut results = vec![f64::NAN; plan.request.results.len()];
        plan.row_of(&study.car, &mut results, &mut values)
            .map_err(CarNotBegun::Fault)?;
        for (output, value) in plan.record.outputs.iter_mut().zip(values) {
            output.at_design = value.is_finite().then_some(value);
        }
        Ok(plan)
    }

    /// Makes a worker. Each CPU thread has one worker.
    pub fn worker(&self) -> CarWorker<'_> {
        CarWorker {
            plan: self,
            rows: Rows::default(),
            results: vec![f64::NAN; self.request.results.len()],
        }
    }

    /// Values of the variables in the design with this number.
    pub fn values(&self, number: u64) -> Vec<f64> {
        let mut values = vec![0.0; self.sweep.variables.len()];
        self.samples.values(number, &mut values);
        values
    }

    /// Car with these values of the variables.
    pub fn car(&self, values: &[f64]) -> Car {
        moved(&self.study.car, &self.sweep.variables, values)
    }

    fn outputs(&self) -> Vec<OutputColumn> {
        let car = &self.study.car;
        let of_result = |result: &CaseResult| {
            let unit = result.quantity.info().unit.suffix(car.length_unit);
            let name = self.name(result.case, result.quantity);
            OutputColumn::new(self.request.column(result, car), &name, Kind::Case, &unit)
        };
        let results = self.request.results.iter();
        let mut columns: Vec<OutputColumn> = results.map(of_result).collect();
        let of_cases = self.targets.iter();
        let of_cases = of_cases.map(|target| self.name(target.case, target.quantity));
        let length = car.length_unit;
        let of_rigs = targets_of_rigs(&self.rigs);
        let of_rigs = of_rigs.map(|(end, own)| format!("{}_{}", AXLE_NAMES[end], own.name(length)));
        let names: Vec<String> = of_cases.chain(of_rigs).collect();
        columns.extend(OutputColumn::of_targets(&names));
        let mut margins: Vec<OutputColumn> = self
            .constraints
            .iter()
            .map(|(own, _)| {
                let unit = own.quantity.info().unit.suffix(length);
                margin_column(&own.name, &unit, Some(own.visible))
            })
            .collect();
        for (end, goals) in self.rigs.iter().filter(|_| self.sweep.constraints) {
            let own = margin_columns(&goals.optimise.constraints, AXLE_NAMES[*end]);
            margins.extend(own);
        }
        distinguish(&mut margins);
        columns.extend(margins);
        columns
    }

    /// Name of a result with its case, without the unit.
    fn name(&self, case: usize, quantity: CarQuantity) -> String {
        format!("{}_{}", self.study.cases[case].name, quantity.name())
    }

    /// Writes the results of a car. The returned reason says why some load cases failed, or why an axle alone has no
    /// values. `None` if nothing failed.
    fn row_of(
        &self,
        car: &Car,
        results: &mut [f64],
        into: &mut [f64],
    ) -> Result<Option<Failing>, CarFault> {
        let failed = self.request.values(car, results)?;
        let (values, rest) = into.split_at_mut(results.len());
        values.copy_from_slice(results);
        let mut rest = rest.iter_mut();
        let mut put = |value: f64| {
            if let Some(cell) = rest.next() {
                *cell = value;
            }
        };
        let (mut squares, mut weights) = (0.0, 0.0);
        let mut weigh = |rms: f64, weight: f64| {
            put(rms);
            squares += weight * rms * rms;
            weights += weight;
        };
        for (target, place) in self.targets.iter().zip(&self.places) {
            let deviation = target.deviation(results[*place]) / target.tolerance;
            weigh(deviation.abs(), target.weight);
        }
        let of_cases = self.constraints.iter();
        let of_cases = of_cases.map(|(own, place)| own.margin(results[*place]));
        let mut margins: Vec<f64> = of_cases.collect();
        let mut failing = failed.map(|failed| {
            let case = &self.study.cases[failed.first].name;
            Failing::case(case, &failed, car)
        });
        for (end, goals) in &self.rigs {
            let outcome = goals.outcome_in(&self.study.axles[*end].vehicle, car, *end);
            for (number, target) in goals.optimise.targets.iter().enumerate() {
                let rms = outcome.as_ref().map(|found| found.targets[number].rms);
                weigh(rms.unwrap_or(f64::NAN), target.weight);
            }
            match outcome {
                Ok(found) => margins.extend(found.margins),
                Err(_) => {
                    let missing = goals.optimise.constraints.iter().map(|_| f64::NAN);
                    margins.extend(missing);
                    failing = failing.or_else(|| Some(Failing::axle_alone(AXLE_NAMES[*end])));
                }
            }
        }
        if weights > 0.0 {
            put((squares / weights).sqrt());
        }
        if self.sweep.constraints {
            margins.into_iter().for_each(put);
        }
        Ok(failing)
    }
}

/// Worker that solves blocks of designs of a car and writes their rows. Each CPU thread has one worker.
pub struct CarWorker<'p> {
    plan: &'p CarSweepPlan<'p>,
    rows: Rows,
    results: Vec<f64>,
}

impl CarWorker<'_> {
    /// Computes the rows of a block of the sweep.
    pub fn rows(&mut self, block: u64) -> &Rows {
        let (plan, rows) = (self.plan, &mut self.rows);
        let range = plan.record.designs_of(block);
        let (count, width) = (
            (range.end - range.start) as usize,
            plan.record.variables.len(),
        );
        let outputs = plan.record.outputs.len();
        rows.first = range.start;
        rows.variables.resize(count * width, 0.0);
        rows.outputs.resize(count * outputs, f64::NAN);
        rows.outputs.fill(f64::NAN);
        rows.failing.clear();
        let into = rows.variables.chunks_exact_mut(width);
        for ((number, values), outputs) in
            range.zip(into).zip(rows.outputs.chunks_exact_mut(outputs))
        {
            plan.samples.values(number, values);
            for value in values.iter_mut() {
                *value += 0.0;
            }
            let car = plan.car(values);
            let failing = match car.counted_refusal() {
                Some(reason) => Err(reason),
                None => {
                    let row = plan.row_of(&car, &mut self.results, outputs);
                    row.map_err(|fault| car.describe_fault(&fault))
                }
            };
            let of_design = |reason| Some(Failing::of_design(reason, plan.study.cases.len()));
            rows.failing.push(failing.unwrap_or_else(of_design));
        }
        &self.rows
    }
}

/// Targets and constraints of single axles, each with the index of the axle.
fn rigs(study: &CarStudy) -> Vec<(usize, &RigGoals)> {
    let rigs = study
        .optimise
        .iter()
        .flat_map(|own| own.rigs.iter().enumerate());
    rigs.filter_map(|(end, goals)| Some((end, goals.as_ref()?)))
        .collect()
}

/// Targets of single axles, each with the index of the axle.
fn targets_of_rigs<'r>(
    rigs: &'r [(usize, &RigGoals)],
) -> impl Iterator<Item = (usize, &'r Target)> {
    let of = |(end, goals): &'r (usize, &RigGoals)| {
        let targets = goals.optimise.targets.iter();
        targets.map(|target| (*end, target))
    };
    rigs.iter().flat_map(of)
}

fn describe(study: &CarStudy, sweep: &CarSweep, targets: &[CarTarget]) -> SweepRecord {
    let car = &study.car;
    let Sampled { method, seed, .. } = sweep.sampled;
    let columns = sweep.sampled.variables.iter();
    let variables = columns.zip(&sweep.variables).map(|(column, variable)| {
        let moves = variable.moves.points().iter().map(|at| MoveRecord {
            hardpoint: format!(
                "{}_{}",
                crate::car::AXLE_NAMES[at.axle],
                car.axles[at.axle].left.mechanism.name(at.point)
            ),
            axis: at.axis.name().to_owned(),
            factor: at.factor,
        });
        VariableRecord {
            column: crate::ask::with_unit(column.name.clone(), &variable.moves.unit(car)),
            low: variable.range[0],
            high: variable.range[1],
            steps: column.steps.filter(|_| method == Sampling::Grid),
            at_design: variable.moves.value(car).map(|value| value + 0.0),
            moves: moves.collect(),
        }
    });
    let rigs = rigs(study);
    let of_rigs = targets_of_rigs(&rigs).map(|(end, target)| TargetColumn {
        column: format!("{}_{}", AXLE_NAMES[end], target.of.column),
        tolerance: (target.tolerance * target.of.factor()).abs(),
        weight: target.weight,
        // A target of a single axle has no points here, because the points of its curve are not values of a load case.
        points: Vec::new(),
    });
    let targets = targets.iter().map(|target| TargetColumn {
        column: format!(
            "{}_{}",
            study.cases[target.case].name,
            target.quantity.column(car.length_unit)
        ),
        tolerance: target.tolerance,
        weight: target.weight,
        points: match target.wanted {
            [low, high] if low == high => vec![[target.case as f64, low]],
            _ => Vec::new(),
        },
    });
    SweepRecord {
        form: FORM,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        digest: digest(study, sweep),
        study: study.name.clone(),
        topology: SweepRecord::CAR.to_owned(),
        length_unit: car.length_unit.symbol().to_owned(),
        method: method.name().to_owned(),
        seed: Some(seed),
        designs: sweep.sampled.designs(),
        blocks_of_part: CAR_BLOCKS_OF_PART,
        drive: "case".to_owned(),
        stations: study.cases.len(),
        variables: variables.collect(),
        outputs: Vec::new(),
        targets: targets.chain(of_rigs).collect(),
        is_fit: false,
        unchecked_constraints: if sweep.constraints {
            Vec::new()
        } else {
            constraints(study)
        },
        curves: false,
        format: sweep.format.name().to_owned(),
    }
}

/// Names of the constraints of the load cases and of the single axles.
fn constraints(study: &CarStudy) -> Vec<String> {
    let Some(optimise) = &study.optimise else {
        return Vec::new();
    };
    let of_cases = optimise.constraints.iter().map(|own| own.name.clone());
    let rigs = optimise.rigs.iter().flatten();
    let of_rigs = rigs.flat_map(|rig| rig.optimise.constraints.iter().map(|own| own.name.clone()));
    of_cases.chain(of_rigs).collect()
}

/// SHA-256 digest of everything that determines the results. The digest covers the meaning of the study, not its text.
fn digest(study: &CarStudy, sweep: &CarSweep) -> String {
    let rigs = rigs(study);
    let of_rigs: Vec<(usize, &Target)> = targets_of_rigs(&rigs).collect();
    let limits = study.optimise.as_ref().filter(|_| sweep.constraints);
    let of_rigs_limits = rigs.iter().map(|(_, own)| &own.optimise.constraints);
    let meaning = (
        (&study.car, &study.cases, &study.quantities),
        study.optimise.as_ref().map(|o| &o.targets),
        limits.map(|o| (&o.constraints, of_rigs_limits.collect::<Vec<_>>())),
        of_rigs,
        (&sweep.variables, sweep.format),
    );
    super::digest_of(&format!(
        "{} {meaning:?} {:?}",
        env!("CARGO_PKG_VERSION"),
        sweep.sampled.meaning()
    ))
}
