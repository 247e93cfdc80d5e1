//! Runs a plan: visits the stations, reads values, and differentiates them.

use super::drive_law::DriveLaw;
use super::loads::Loads;
use super::prover::Prover;
use super::{ByTime, Column, Curves, MotionColumn, Proof, Sensitivity, Station, Status};
use crate::ask::NoValue;
use crate::characteristics::{Measure, Quantity, Slot, Slots, WheelReading};
use crate::derive::{DesignSeries, Linearised, MotionPoint};
use crate::mechanism::{Configuration, DesignFault, Failure, Pose, Work, WorkCounter};
use crate::model::{Axis, PointId, RockerId, Rod, Suspension};
use crate::number::{Each, Jet, Vector3};
use crate::plan::{Output, Plan};
use crate::solve::{LEAST_DIGITS, Rejection, Solver, Toggles, rate_digits};
use crate::sorting::sort_by_key;
use crate::study::{Drive, Formulation};
use crate::threads::on_large_stacks;
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// Computes the curves of a suspension that a plan requests. An error says why its design position cannot be solved.
pub fn curves(suspension: &Suspension, plan: &Plan) -> Result<Curves, DesignFault> {
    if plan.certify {
        on_large_stacks(1, || curves_here(suspension, plan))
    } else {
        curves_here(suspension, plan)
    }
}

fn curves_here(suspension: &Suspension, plan: &Plan) -> Result<Curves, DesignFault> {
    match plan.coefficients {
        1 => Run::<1>::new(suspension, plan).run(),
        2 => Run::<2>::new(suspension, plan).run(),
        3 => Run::<3>::new(suspension, plan).run(),
        _ => Run::<4>::new(suspension, plan).run(),
    }
}

/// A run in which every Taylor series has `N` coefficients.
pub(super) struct Run<'a, const N: usize> {
    pub(super) suspension: &'a Suspension,
    pub(super) plan: &'a Plan,
    pub(super) design_series: DesignSeries<N>,
    /// Columns of the outputs, then columns of the loads.
    columns: Vec<Column>,
    loads: Loads<'a>,
    /// Rockers that influence each output.
    rockers: Vec<Vec<RockerId>>,
    pub(super) toggles: Toggles,
    stations: Vec<Station>,
    sensitivities: Vec<Sensitivity>,
    /// Numbers of stations that the slower continuation method solved instead of the tracker, for each reason.
    left_to_continuation: BTreeMap<Rejection, usize>,
    /// Work that the solver counted.
    pub(super) work: Work,
    /// Counter of the work for reading characteristics.
    work_counter: WorkCounter,
}

/// Results at one station before they are stored in `stations`.
pub(super) struct Findings {
    pub(super) travel: f64,
    pub(super) values: Vec<Result<f64, NoValue>>,
    /// True if loads are requested and no member supports them in this pose.
    pub(super) unsupported: bool,
    /// Rod that is at or beyond its toggle and influences a requested quantity.
    pub(super) toggle: Option<Rod>,
    pub(super) gradients: Vec<Sensitivity>,
    pub(super) condition: Option<f64>,
    pub(super) proof: Option<Proof>,
}

impl<'a, const N: usize> Run<'a, N> {
    fn new(suspension: &'a Suspension, plan: &'a Plan) -> Self {
        let loads = Loads::of(
            &suspension.mechanism,
            (suspension.frame, suspension.length_unit),
            &plan.loads,
        );
        let mut columns = Column::all(plan, suspension.length_unit);
        columns.extend(loads.columns());
        let mut stations = Vec::with_capacity(plan.stations());
        for rack in &plan.racks {
            for (number, value) in plan.station_order.values().iter().enumerate() {
                stations.push(Station {
                    at: place(plan, number, *value, *rack),
                    // The status stays `DeadCentre` if the solver's drive cannot reach the drive value of the station.
                    status: Status::Failed(Failure::DeadCentre.into()),
                    values: vec![Err(NoValue::NoPose); columns.len()],
                    condition: None,
                    proof: None,
                });
            }
        }
        let rockers: Vec<_> = plan
            .outputs
            .iter()
            .map(|o| o.of.rockers(&suspension.mechanism))
            .collect();
        let watched = rockers.iter().flatten().copied().chain(loads.rocker());
        let toggles = Toggles::of(&suspension.mechanism, watched);
        Run {
            suspension,
            plan,
            design_series: DesignSeries::new(&suspension.mechanism, &suspension.design)
                .with_steering_axis(plan.reads_steering_axis())
                .with_sensitivities_to(&suspension.mechanism, &plan.sensitivities),
            stations,
            columns,
            loads,
            rockers,
            toggles,
            sensitivities: Vec::new(),
            left_to_continuation: BTreeMap::new(),
            work: Work::default(),
            work_counter: WorkCounter::default(),
        }
    }

    fn run(mut self) -> Result<Curves, DesignFault> {
        match self.plan.formulation {
            Formulation::KnucklePose => self.by_knuckle_pose()?,
            Formulation::PointCoordinates => self.by_point_coordinates()?,
        }
        // Stations are visited outward, but results are in the order of the motion.
        sort_by_key(&mut self.sensitivities, |s| s.station);
        let bounds = if self.plan.certify {
            ["position_error", "uniqueness"]
                .map(|bound| format!("{bound}_{}", self.suspension.length_unit.symbol()))
                .to_vec()
        } else {
            Vec::new()
        };
        Ok(Curves {
            motion: motion(self.plan, self.suspension.length_unit.symbol()),
            columns: self.columns,
            bounds,
            stations: self.stations,
            sensitivities: self.sensitivities,
            work: self.work + self.work_counter.work(),
            left_to_continuation: self.left_to_continuation.into_iter().collect(),
        })
    }

    fn by_knuckle_pose(&mut self) -> Result<(), DesignFault> {
        let (suspension, plan) = (self.suspension, self.plan);
        let drive_law = DriveLaw::of(suspension, plan)?;
        let mut solver = Solver::new(&suspension.mechanism, &suspension.design)?;
        let prover = plan.certify.then(|| Prover::new(suspension));
        for (i, rack) in plan.racks.iter().enumerate() {
            let drive = plan.drive.in_kernel();
            let rack = rack * plan.rack_sign;
            self.toggles.begin(&mut solver, drive, rack)?;
            let mut take =
                |solver: &Solver, place: usize, pose: Result<&Pose<f64>, Failure>, proof| {
                    let number = drive_law.stations[place];
                    let motion = drive_law.motion(plan.station_order.values()[number], rack);
                    let found = pose.and_then(|pose| self.read(solver, pose, number, &motion));
                    self.note(i, number, found.map(|f| Findings { proof, ..f }));
                    ControlFlow::Continue(())
                };
            match &prover {
                None => solver.for_each_pose(
                    drive,
                    &drive_law.station_order,
                    rack,
                    |solver, place, pose| take(solver, place, pose, None),
                )?,
                Some(prover) => {
                    let certifier = &prover.certifier;
                    solver.for_each_certified_pose(
                        certifier,
                        drive,
                        &drive_law.station_order,
                        rack,
                        |solver, place, proved| {
                            let proof = proved.as_ref().ok().map(|(_, c)| prover.proof(c));
                            take(solver, place, proved.map(|(pose, _)| pose), proof)
                        },
                    )?;
                }
            }
            for place in 0..drive_law.stations.len() {
                if let Some(reason) = solver.rejection(place) {
                    *self.left_to_continuation.entry(reason).or_default() += 1;
                }
            }
        }
        self.work = solver.work();
        Ok(())
    }

    /// Stores the result at station `number` of the motion, at the rack displacement with index `rack`.
    pub(super) fn note(&mut self, rack: usize, number: usize, found: Result<Findings, Failure>) {
        let index = rack * self.plan.station_order.values().len() + number;
        let station = &mut self.stations[index];
        match found {
            Ok(findings) => {
                // Near a singularity, positions lose half as many digits as derivatives and sensitivities.
                let differentiated =
                    self.plan.coefficients > 1 || !self.plan.sensitivities.is_empty();
                let digits = findings.condition.map(rate_digits);
                station.status = match (findings.toggle, digits) {
                    (Some(rod), _) => Status::Toggle([Some(rod), None]),
                    _ if findings.unsupported => Status::Unsupported,
                    (_, Some(digits)) if differentiated && digits < LEAST_DIGITS => {
                        Status::IllConditioned
                    }
                    _ => Status::Ok,
                };
                station.condition = findings.condition;
                station.proof = findings.proof;
                station.at[TRAVEL] = station.at[TRAVEL].or(Some(findings.travel));
                station.values = findings.values;
                let gradients = findings.gradients.into_iter();
                self.sensitivities.extend(gradients.map(|g| Sensitivity {
                    station: index,
                    ..g
                }));
            }
            Err(failure) => station.status = Status::Failed(failure.into()),
        }
    }

    /// Reads every requested quantity from a pose.
    fn read(
        &mut self,
        solver: &Solver,
        pose: &Pose<f64>,
        number: usize,
        motion: &MotionPoint<Jet<f64, N>>,
    ) -> Result<Findings, Failure> {
        let drive = motion.value[0];
        if self.plan.sensitivities.is_empty() {
            let (configuration, condition) =
                solver.conditioned_series(&self.design_series, pose, motion)?;
            return Ok(Findings {
                condition: Some(condition.number),
                ..self.loaded(solver, pose, &configuration, number, drive)
            });
        }
        let linearised = solver.linearised(&self.design_series, pose, motion)?;
        let findings = self.loaded(solver, pose, &linearised.at, number, drive);
        Ok(Findings {
            gradients: self.gradients(&linearised, number),
            condition: Some(linearised.conditioning(solver.size()).number),
            ..findings
        })
    }

    /// Values of all columns, including the columns of the loads.
    fn loaded(
        &self,
        solver: &Solver,
        pose: &Pose<f64>,
        at: &Configuration<Jet<f64, N>>,
        number: usize,
        drive: f64,
    ) -> Findings {
        let mut findings = self.values(Some(solver), at, number, drive);
        let stuck = self.loads.rocker().filter(|id| self.toggles.holds(*id));
        if stuck.is_some() {
            findings
                .values
                .resize(self.columns.len(), Err(NoValue::Toggle));
        } else if !self.loads.is_empty() {
            match solver.balance(pose, at.rack[0], self.loads.support) {
                Ok(balance) => {
                    let slots = Slots::default().with(&[Slot::SpinAxis, Slot::Centre]);
                    let wheel = WheelReading::reading(at, self.plan.constants, slots);
                    let contact = wheel.contact_point().map(|c| c[0]);
                    let forces = self.loads.forces(&balance, contact);
                    let forces = forces.map(|force| force.ok_or(NoValue::NotFinite));
                    findings.values.extend(forces);
                }
                Err(_) => {
                    findings
                        .values
                        .resize(self.columns.len(), Err(NoValue::Unsupported));
                    findings.unsupported = true;
                }
            }
        }
        findings
    }

    /// Values of the outputs' columns at station `number`, with the drive value `drive`. `solver` is the solver that found
    /// the pose; `None` for the equations of Attia's paper.
    pub(super) fn values(
        &self,
        solver: Option<&Solver>,
        at: &Configuration<Jet<f64, N>>,
        number: usize,
        drive: f64,
    ) -> Findings {
        let plan = self.plan;
        let in_time = ByTime::at(plan.time.as_ref(), number);
        let toggle = self.toggles.note(solver, at, drive);
        let view = WheelReading::reading(at, plan.constants, plan.reads);
        let mut values = Vec::with_capacity(self.columns.len());
        for (columns, output) in self.columns_by_output() {
            if self.is_stuck(columns) {
                values.extend(columns.iter().map(|_| Err(NoValue::Toggle)));
                continue;
            }
            let (counts, undefined) = match output.quantity() {
                Some(Quantity::Characteristic(c)) => (1, NoValue::Undefined(c.undefined_where())),
                Some(_) => (0, NoValue::NotFinite),
                None => (0, NoValue::Undefined(Measure::KINK)),
            };
            self.work_counter
                .note(|w| w.characteristic_evaluations += counts);
            let series = match output.quantity() {
                Some(quantity) => view.value(at, quantity),
                None => output.of.shown(at),
            };
            let mut orders = [0.0; 3];
            for (order, value) in orders.iter_mut().enumerate().take(output.highest + 1) {
                *value = series.derivative(order);
            }
            for column in columns {
                let value = in_time.apply(output.is_rate(), orders, column.order);
                let printed = value * column.factor;
                values.push(if printed.is_finite() {
                    Ok(printed)
                } else {
                    Err(undefined)
                });
            }
        }
        let centre = at.mechanism.wheel_centre;
        Findings {
            travel: (at.point(centre).z - at.designed(centre).z)[0],
            values,
            unsupported: false,
            toggle,
            gradients: Vec::new(),
            condition: None,
            proof: None,
        }
    }

    /// Returns true if these columns of one output depend on a rocker at or beyond its toggle.
    fn is_stuck(&self, columns: &[Column]) -> bool {
        let of = columns.first().and_then(|column| column.of);
        let mut rockers = of.into_iter().flat_map(|of| &self.rockers[of]);
        rockers.any(|id| self.toggles.holds(*id))
    }

    /// Columns of each output, in the plan's order.
    fn columns_by_output(&self) -> impl Iterator<Item = (&[Column], &Output)> {
        let columns = self.columns.chunk_by(|a, b| a.of == b.of);
        columns.filter_map(|columns| Some((columns, &self.plan.outputs[columns[0].of?])))
    }

    /// Sensitivities of every column.
    fn gradients(&self, linearised: &Linearised<'_, N>, number: usize) -> Vec<Sensitivity> {
        let plan = self.plan;
        let in_time = ByTime::at(plan.time.as_ref(), number);
        let view = WheelReading::reading(&linearised.at, plan.constants, plan.reads);
        let zero = Vector3::new(0.0, 0.0, 0.0).map(Jet::constant);
        let mut buffer = vec![zero; self.suspension.design.len()];
        let count = self.columns.len() * plan.sensitivities.len() * Axis::ALL.len();
        let mut gradients = Vec::with_capacity(count);
        // Gradients, `[point][order]`, before the conversion to derivatives with respect to time.
        let mut found: Vec<[Vector3<f64>; 3]> = vec![[Vector3::default(); 3]; buffer.len()];
        let mut index = 0;
        for (columns, output) in self.columns_by_output() {
            let counts = matches!(output.quantity(), Some(Quantity::Characteristic(_)));
            self.work_counter
                .note(|w| w.characteristic_gradients += u64::from(counts));
            if self.is_stuck(columns) {
                found.fill([Vector3::new(f64::NAN, f64::NAN, f64::NAN); 3])
            } else {
                let mut receive =
                    |order: usize, id: PointId, gradient| found[id.0][order] = gradient;
                let highest = output.highest;
                match output.quantity() {
                    Some(quantity) => {
                        view.gradients(linearised, quantity, highest, &mut buffer, &mut receive);
                    }
                    None => {
                        output
                            .of
                            .shown_gradients(linearised, highest, &mut buffer, &mut receive)
                    }
                }
            }
            for column in columns {
                for id in &plan.sensitivities {
                    for axis in Axis::ALL {
                        let orders = found[id.0].each(|g| g[axis]);
                        let value = in_time.apply(output.is_rate(), orders, column.order);
                        gradients.push(Sensitivity {
                            station: 0,
                            column: index,
                            side: None,
                            point: *id,
                            axis,
                            value: value * column.factor * self.suspension.frame.sign(axis),
                        });
                    }
                }
                index += 1;
            }
        }
        gradients
    }
}

/// Index of the travel among the coordinates of the motion.
const TRAVEL: usize = 0;

/// Coordinates of the motion: travel, the drive's angle, rack and time. If an angle is the drive, the travel is a result. The
/// time does not name a station, because the drive value does.
pub(super) fn motion(plan: &Plan, length: &'static str) -> Vec<MotionColumn> {
    let travel = MotionColumn {
        is_given: !plan.drive.is_angle(),
        ..MotionColumn::given(Drive::Travel.key(), length)
    };
    let rack = MotionColumn {
        is_written: plan.rack_moves,
        ..MotionColumn::given("rack", length)
    };
    let angle = || MotionColumn::given(plan.drive.key(), "deg");
    let time = MotionColumn {
        is_given: false,
        ..MotionColumn::given("time", "s")
    };
    let mut motion = vec![travel];
    motion.extend(plan.drive.is_angle().then(angle));
    motion.push(rack);
    motion.extend(plan.time.is_some().then_some(time));
    motion
}

/// Coordinates of the motion at a station, in the order of [`motion`].
pub(super) fn place(plan: &Plan, number: usize, value: f64, rack: f64) -> Vec<Option<f64>> {
    let printed = Some(plan.drive.printed(value));
    let mut at = if plan.drive.is_angle() {
        vec![None, printed]
    } else {
        vec![printed]
    };
    at.push(Some(rack));
    at.extend(plan.time.as_ref().map(|law| Some(law.times[number])));
    at
}
