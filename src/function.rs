//! Curves as a pure function of the design: offsets of variables in, values and exact Jacobians out.
//!
//! This is what an optimiser, a surrogate or a differentiable program takes. A [`DesignFunction`] owns what it
//! uses, is `Send + Sync` and has no lifetime; every thread that evaluates takes an [`Evaluation`] of its own
//! from it. Arrays are plain slices, the last index running fastest. Values are in the units of the column
//! names, offsets in the study's length unit and axes. What has no value is NaN, with a status that says why;
//! nothing is dropped.

use crate::characteristics::{Constants, Quantity, Slots, WheelReading};
use crate::derive::{DesignSeries, MotionPoint};
use crate::mechanism::{DesignFault, Failure, Toggles};
use crate::model::{Axis, Drive, PointId, Suspension};
use crate::number::{Jet, Vector3};
use crate::plan::{Output, Plan};
use crate::solve::Solver;
use crate::study::{Formulation, Move, Study, SweepVariable};
use crate::sweep::{BLOCK, Block, Evaluator, Stations};
use std::ops::ControlFlow;
use std::sync::Arc;
use thiserror::Error;

/// Why there is no function.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FunctionError {
    /// The study solves the seed paper's equations, which do not give every output of every design.
    #[error(
        "a study with formulation = \"point_coordinates\" or drive = \"paper_theta\" is no function of the design"
    )]
    Formulation,
    /// The study asks for nothing that is a function of position.
    #[error("the study asks for no characteristic and no point")]
    NoOutputs,
    /// The design itself cannot be solved.
    #[error("{0}")]
    Design(String),
}

/// Curves of a study as a function of what its variables move.
#[derive(Clone, Debug)]
pub struct DesignFunction {
    suspension: Arc<Suspension>,
    variables: Vec<SweepVariable>,
    outputs: Vec<Output>,
    quantities: Vec<Quantity>,
    stations: Stations,
    /// The stations of the motion, in the order of the results.
    of_motion: Vec<usize>,
    /// Each with what the design does to it.
    moved: Vec<PointId>,
}

/// What came of a design.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum DesignStatus {
    /// Every station has a pose.
    Ok = 0,
    /// Some station cannot be reached, or has no derivatives.
    Failed = 1,
    /// The design cannot be solved at all.
    Faulty = 2,
}

impl DesignFunction {
    /// The outputs of a study over its motion, as a function of its variables: those of `[optimise]`, else of
    /// `[sweep]`, else every coordinate of every hardpoint.
    pub fn of(study: &Study) -> Result<Self, FunctionError> {
        let variables = match (&study.optimise, &study.sweep) {
            (Some(optimise), _) => {
                let offsets = optimise.variables.iter();
                let offset = |v: &crate::study::Variable| SweepVariable {
                    name: offset_name(&v.moves, &study.suspension),
                    moves: v.moves.clone(),
                    absolute: false,
                    range: v.range,
                    steps: None,
                };
                offsets.map(offset).collect()
            }
            (None, Some(sweep)) => match &sweep.designs {
                crate::study::Designs::Sampled(sampled) => sampled.variables.clone(),
                crate::study::Designs::File(_) => every_coordinate(&study.suspension),
            },
            (None, None) => every_coordinate(&study.suspension),
        };
        DesignFunction::with_variables(study, variables)
    }

    /// As [`DesignFunction::of`], as a function of these variables.
    pub fn with_variables(
        study: &Study,
        variables: Vec<SweepVariable>,
    ) -> Result<Self, FunctionError> {
        let is_own_drive = study.motion.drive != crate::study::Drive::PaperTheta;
        if study.formulation != Formulation::KnucklePose || !is_own_drive {
            return Err(FunctionError::Formulation);
        }
        let plan = Plan::of(study);
        let outputs: Vec<Output> = plan
            .outputs
            .into_iter()
            .filter(|o| !matches!(o.quantity, Quantity::AngularVelocity(_)))
            .collect();
        if outputs.is_empty() {
            return Err(FunctionError::NoOutputs);
        }
        let stations = Stations::of(&study.motion, &study.suspension.frame, &[]);
        let of_motion = stations
            .of_motion()
            .map(|(rack, value)| stations.number(rack, value))
            .collect();
        let mut moved: Vec<PointId> = variables
            .iter()
            .flat_map(|v| v.moves.iter().map(|m| m.point))
            .collect();
        moved.sort_unstable();
        moved.dedup();
        let function = DesignFunction {
            suspension: Arc::new(study.suspension.clone()),
            quantities: outputs.iter().map(|o| o.quantity).collect(),
            outputs,
            variables,
            stations,
            of_motion,
            moved,
        };
        match function.evaluation() {
            Ok(_) => Ok(function),
            Err(fault) => {
                let reason = fault.describe(&function.suspension.mechanism);
                Err(FunctionError::Design(reason))
            }
        }
    }

    /// What moves, with names and ranges.
    pub fn variables(&self) -> &[SweepVariable] {
        &self.variables
    }

    /// Names of the outputs with their units, as columns have them.
    pub fn outputs(&self) -> Vec<String> {
        let name = |o: &Output| match o.unit.is_empty() {
            true => o.name.clone(),
            false => format!("{}_{}", o.name, o.unit),
        };
        self.outputs.iter().map(name).collect()
    }

    /// Drive value and rack displacement of each station, as results print them.
    pub fn motion(&self) -> Vec<[f64; 2]> {
        let sign = self.suspension.frame.sign(Axis::Y);
        let printed = |v: f64| match self.stations.drive {
            Drive::Travel => v,
            Drive::ArmAngle => v.to_degrees(),
        };
        let stations = self.stations.of_motion();
        let at = |(r, v): (usize, usize)| {
            let (rack, value) = (self.stations.racks[r], self.stations.values()[v]);
            [printed(value), sign * rack + 0.0]
        };
        stations.map(at).collect()
    }

    /// Every coordinate of every hardpoint of a study as a variable, by up to ten millimetres.
    pub fn every_coordinate(study: &Study) -> Vec<SweepVariable> {
        every_coordinate(&study.suspension)
    }

    /// Number of stations.
    pub fn stations(&self) -> usize {
        self.of_motion.len()
    }

    /// Numbers of an evaluation of one design: outputs times stations.
    pub fn len(&self) -> usize {
        self.outputs.len() * self.stations()
    }

    /// Whether there is nothing to evaluate; there always is.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A workspace to evaluate with, one for each thread.
    ///
    /// # Errors
    /// If the study's own design cannot be solved.
    pub fn evaluation(&self) -> Result<Evaluation<'_>, DesignFault> {
        let Suspension {
            mechanism, design, ..
        } = &*self.suspension;
        let slots = self
            .quantities
            .iter()
            .fold(Slots::default(), |slots, q| slots.with(q.reads()));
        let rockers: Vec<_> = self
            .quantities
            .iter()
            .map(|q| q.rockers(mechanism))
            .collect();
        let steering_axis = slots.contain_steering_axis();
        Ok(Evaluation {
            function: self,
            evaluator: Evaluator::new(&self.suspension, &self.stations, &self.quantities)?,
            block: Block::new(self.quantities.len(), self.stations.count()),
            designs: Vec::new(),
            slots,
            toggles: Toggles::of(mechanism, rockers.into_iter().flatten()),
            solver: Solver::new(mechanism, design)?,
            series: DesignSeries::new(mechanism, design)
                .with_steering_axis(steering_axis)
                .with_sensitivities_to(mechanism, &self.moved),
            buffer: vec![Vector3::new(0.0, 0.0, 0.0).map(Jet::constant); design.len()],
        })
    }

    /// The design at offsets (or coordinates, where a variable is absolute).
    fn design(&self, x: &[f64], into: &mut [Vector3<f64>]) {
        let Suspension { design, frame, .. } = &*self.suspension;
        into.copy_from_slice(design);
        for (variable, value) in self.variables.iter().zip(x) {
            for m in &variable.moves {
                let sign = frame.sign(m.axis);
                let point = &mut into[m.point.0];
                let coordinate = match m.axis {
                    Axis::X => &mut point.x,
                    Axis::Y => &mut point.y,
                    Axis::Z => &mut point.z,
                };
                match variable.absolute {
                    true => *coordinate = sign * value,
                    false => *coordinate += sign * m.factor * value,
                }
            }
        }
    }
}

/// A workspace of a [`DesignFunction`].
pub struct Evaluation<'f> {
    function: &'f DesignFunction,
    evaluator: Evaluator<'f>,
    block: Block,
    designs: Vec<Vector3<f64>>,
    slots: Slots,
    toggles: Toggles,
    solver: Solver<'f>,
    series: DesignSeries<2>,
    buffer: Vec<Vector3<Jet<f64, 2>>>,
}

impl Evaluation<'_> {
    /// The values of several designs, in SIMD lanes: `x` has a row of variables for each, `values` gets
    /// `[design][output][station]`, `status` an entry for each.
    ///
    /// # Panics
    /// If the slices do not fit each other.
    pub fn values(&mut self, x: &[f64], values: &mut [f64], status: &mut [DesignStatus]) {
        let f = self.function;
        let (width, points) = (f.variables.len(), f.suspension.design.len());
        let count = status.len();
        assert_eq!(x.len(), count * width, "a row of variables for each design");
        assert_eq!(values.len(), count * f.len(), "room for each design");
        let mut first = 0;
        while first < count {
            let now = (count - first).min(BLOCK);
            self.designs.resize(now * points, Vector3::default());
            for (number, design) in self.designs.chunks_mut(points).enumerate() {
                let row = (first + number) * width;
                f.design(&x[row..row + width], design);
            }
            self.evaluator.evaluate(&self.designs, &mut self.block);
            for number in 0..now {
                let at = (first + number) * f.len();
                let own = &mut values[at..at + f.len()];
                for (k, output) in f.outputs.iter().enumerate() {
                    for (s, station) in f.of_motion.iter().enumerate() {
                        let value = self.block.value(number, k, *station) * output.factor;
                        own[k * f.of_motion.len() + s] = value;
                    }
                }
            }
            let status = &mut status[first..first + now];
            status.fill(DesignStatus::Ok);
            for failure in self.block.failures() {
                if f.of_motion.contains(&failure.station) {
                    status[failure.design] = DesignStatus::Failed;
                }
            }
            for (number, _) in self.block.faults() {
                status[*number] = DesignStatus::Faulty;
            }
            first += now;
        }
    }

    /// The values of one design and their derivatives by the variables, exact: `jacobian` gets
    /// `[output][station][variable]`, per length unit.
    ///
    /// # Panics
    /// If the slices do not fit each other.
    pub fn value_and_jacobian(
        &mut self,
        x: &[f64],
        values: &mut [f64],
        jacobian: &mut [f64],
    ) -> DesignStatus {
        let f = self.function;
        let width = f.variables.len();
        let mut status = [DesignStatus::Ok];
        self.values(x, values, &mut status);
        assert_eq!(jacobian.len(), f.len() * width, "room for each derivative");
        jacobian.fill(f64::NAN);
        match self.differentiate(x, jacobian) {
            Ok(()) => status[0],
            Err(_) => DesignStatus::Faulty,
        }
    }

    fn differentiate(&mut self, x: &[f64], jacobian: &mut [f64]) -> Result<(), DesignFault> {
        let Evaluation {
            function: f,
            slots,
            toggles,
            solver,
            series,
            buffer,
            designs,
            ..
        } = self;
        let Suspension {
            mechanism,
            design,
            frame,
            ..
        } = &*f.suspension;
        let constants = Constants::of(&f.suspension);
        designs.resize(design.len(), Vector3::default());
        f.design(x, designs);
        solver.prepare(designs)?;
        series.prepare(mechanism, designs);
        let (count, width) = (f.of_motion.len(), f.variables.len());
        let drive = f.stations.drive;
        for (r, rack) in f.stations.racks.iter().enumerate() {
            let rack = *rack;
            toggles.begin(solver, drive, rack)?;
            solver.for_each_pose(drive, &f.stations.station_order, rack, |solver, v, pose| {
                let number = f.stations.number(r, v);
                let Some(s) = f.of_motion.iter().position(|own| *own == number) else {
                    return ControlFlow::Continue(());
                };
                let motion = MotionPoint {
                    drive,
                    value: f.stations.values()[v],
                    rack,
                };
                let linearised = pose
                    .and_then(|pose| solver.linearised(series, pose, &motion.along_drive::<2>()));
                let Ok(linearised) = linearised else {
                    return ControlFlow::Continue(());
                };
                if toggles.note(&linearised.at, motion.value).is_some() {
                    return ControlFlow::Continue(());
                }
                let reading = WheelReading::reading(&linearised.at, constants, *slots);
                for (k, output) in f.outputs.iter().enumerate() {
                    let row = &mut jacobian[(k * count + s) * width..][..width];
                    row.fill(0.0);
                    let add = |_: usize, point: PointId, by: Vector3<f64>| {
                        for (entry, variable) in row.iter_mut().zip(&f.variables) {
                            for m in variable.moves.iter().filter(|m| m.point == point) {
                                let factor = match variable.absolute {
                                    true => 1.0,
                                    false => m.factor,
                                };
                                let by = by.to_array()[m.axis as usize];
                                *entry += by * frame.sign(m.axis) * factor * output.factor;
                            }
                        }
                    };
                    reading.gradients(&linearised, output.quantity, 0, buffer, add);
                }
                ControlFlow::Continue(())
            })?;
        }
        Ok(())
    }

    /// Why a station of the last designs has no pose, in words: (design, station of the motion, reason).
    pub fn failures(&self) -> impl Iterator<Item = (usize, usize, &Failure)> {
        let f = self.function;
        self.block.failures().iter().filter_map(|failure| {
            let own = f.of_motion.iter().position(|s| *s == failure.station)?;
            Some((failure.design, own, &failure.failure))
        })
    }
}

/// `tie_rod_inner_dz`, or `lower_arm_front+lower_arm_rear_dz`.
fn offset_name(moves: &[Move], suspension: &Suspension) -> String {
    let names = moves.iter().map(|m| suspension.mechanism.name(m.point));
    let axis = moves.first().map_or("", |m| m.axis.name());
    format!("{}_d{axis}", names.collect::<Vec<_>>().join("+"))
}

/// Every coordinate of every hardpoint, by up to ten millimetres.
fn every_coordinate(suspension: &Suspension) -> Vec<SweepVariable> {
    let far = 0.01 * suspension.length_unit.per_metre();
    let points = (0..suspension.design.len()).map(PointId);
    let variable = |point: PointId, axis: Axis| {
        let moves = vec![Move {
            point,
            axis,
            factor: 1.0,
        }];
        SweepVariable {
            name: offset_name(&moves, suspension),
            moves,
            absolute: false,
            range: [-far, far],
            steps: None,
        }
    };
    points
        .flat_map(|point| Axis::ALL.map(|axis| variable(point, axis)))
        .collect()
}
