//! Curves as a pure function of the design: offsets of variables in, values and exact Jacobians out.
//!
//! This is what an optimiser, a surrogate or a differentiable program takes. A [`DesignFunction`] owns what it
//! uses, is `Send + Sync` and has no lifetime; every thread that evaluates takes an [`Evaluation`] of its own
//! from it. Arrays are plain slices, the last index running fastest. Values are in the units of the column
//! names, offsets in the study's length unit and axes. What has no value is NaN, with a status that says why;
//! nothing is dropped.

mod axle;

use self::axle::{AxleEvaluator, AxleFunction};
use crate::ask::with_unit;
use crate::characteristics::Quantity;
use crate::evaluate::{Evaluated, GradientEvaluator};
use crate::mechanism::DesignFault;
use crate::model::{Axis, Drive, PointId, Suspension};
use crate::number::{Vector3, Width};
use crate::optimise::{PointRate, moved_design, point_rates};
use crate::plan::{Output, Plan};
use crate::study::{Designs, Formulation, Study, SweepVariable, Variable, nearest};
use crate::sweep::{BLOCK, Block, Evaluator, StationFailure, Stations};
use nalgebra::DVector;
use std::sync::Arc;
use thiserror::Error;

/// Why there is no function.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FunctionError {
    /// The study solves the seed paper's equations, which do not give every output of every design.
    #[error(
        "DesignFunction does not support formulation = \"point_coordinates\" or drive = \"paper_theta\""
    )]
    Formulation,
    /// The study asks for nothing that is a function of position.
    #[error("the study requests no characteristic and no point")]
    NoOutputs,
    /// The design itself cannot be solved.
    #[error("{0}")]
    Design(String),
    /// No variable has this name.
    #[error(
        "there is no variable {0:?}; expected a hardpoint and how it moves, as in tie_rod_inner_dz for an offset \
         or tie_rod_inner_z for a coordinate{1}"
    )]
    UnknownVariable(String, String),
}

/// One of the numbers that a design is a function of.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignVariable {
    /// Unique: `tie_rod_inner_dz`, `lower_arm_front+lower_arm_rear_dz`, `tie_rod_inner_z` of a coordinate,
    /// `lower_arm_front+lower_arm_rear_turn_x` of a turn.
    pub name: String,
    /// The points it moves and its range: an offset from the design in the study's length unit and axes, or degrees of
    /// a turn.
    moved: Variable,
    /// Whether the number is the coordinate itself rather than an offset.
    absolute: bool,
}

impl DesignVariable {
    /// The variables of a study: those of `[optimise]`, else those of `[sweep]`, else every coordinate of every
    /// hardpoint.
    pub fn of(study: &Study) -> Vec<Self> {
        if let Some(optimise) = &study.optimise {
            return optimise.variables.iter().map(Self::tuned).collect();
        }
        match study.sweep.as_ref().map(|sweep| &sweep.designs) {
            Some(Designs::Sampled(sampled)) => sampled.variables.iter().map(Self::swept).collect(),
            Some(Designs::Given(table)) => table.variables.iter().map(Self::swept).collect(),
            Some(Designs::File(_)) | None => Self::every_coordinate(&study.suspension),
        }
    }

    /// The variable of this name: one of `[optimise]` or `[sweep]`, or the offset or the coordinate of any hardpoint
    /// along an axis.
    ///
    /// # Errors
    /// [`FunctionError::UnknownVariable`] if there is none, with the name that comes nearest.
    pub fn named(name: &str, study: &Study) -> Result<Self, FunctionError> {
        let mut known = Self::of(study);
        if let Some(Designs::Sampled(sampled)) = study.sweep.as_ref().map(|sweep| &sweep.designs) {
            known.extend(sampled.variables.iter().map(Self::swept));
        }
        let offsets = Self::every_coordinate(&study.suspension);
        let coordinates: Vec<Self> = offsets
            .iter()
            .map(|v| v.as_coordinate(&study.suspension))
            .collect();
        known.extend(offsets.into_iter().chain(coordinates));
        let meant = nearest(name, known.iter().map(|v| v.name.as_str()));
        let meant = meant.map_or(String::new(), |near| format!("; did you mean {near}?"));
        let found = known.iter().find(|v| v.name == name).cloned();
        found.ok_or_else(|| FunctionError::UnknownVariable(name.to_owned(), meant))
    }

    fn tuned(variable: &Variable) -> Self {
        DesignVariable {
            name: variable.label(),
            moved: variable.clone(),
            absolute: false,
        }
    }

    fn swept(variable: &SweepVariable) -> Self {
        DesignVariable {
            name: variable.name.clone(),
            moved: Variable {
                name: variable.name.clone(),
                moves: variable.moves.clone(),
                turn: None,
                range: variable.range,
                cost: 1.0,
            },
            absolute: variable.absolute,
        }
    }

    /// An offset of every coordinate of every hardpoint by up to ten millimetres.
    fn every_coordinate(suspension: &Suspension) -> Vec<Self> {
        let far = 0.01 * suspension.length_unit.per_metre();
        let all = Variable::every_coordinate(suspension, [-far, far]);
        all.iter().map(Self::tuned).collect()
    }

    /// A variable that is the coordinate itself in place of its offset. A variable that moves more than one coordinate
    /// stays as it is.
    fn as_coordinate(&self, suspension: &Suspension) -> Self {
        let [m] = self.moved.moves[..] else {
            return self.clone();
        };
        let at = suspension.design[m.point.0][m.axis];
        let at = at * suspension.frame.sign(m.axis) + 0.0;
        let mut moved = self.moved.clone();
        moved.range = moved.range.map(|offset| at + offset);
        DesignVariable {
            name: format!("{}_{}", self.moved.name, m.axis.name()),
            moved,
            absolute: true,
        }
    }

    /// Lowest and highest value, in the study's axes and length unit, or in degrees for a turn.
    pub fn range(&self) -> [f64; 2] {
        self.moved.range
    }

    /// The variable as a column of a table of designs. `None` for a turn, which cannot be one.
    pub fn swept_as(&self) -> Option<SweepVariable> {
        self.moved.turn.is_none().then(|| SweepVariable {
            name: self.name.clone(),
            moves: self.moved.moves.clone(),
            absolute: self.absolute,
            range: self.moved.range,
            steps: None,
        })
    }
}

/// Curves of a study as a function of what its variables move.
#[derive(Clone, Debug)]
pub struct DesignFunction {
    suspension: Arc<Suspension>,
    names: Vec<DesignVariable>,
    /// The points that the variables of `names` move.
    variables: Vec<Variable>,
    outputs: Vec<Output>,
    quantities: Vec<Quantity>,
    stations: Stations,
    /// Numbers of the motion's stations among `stations`, in the order of the results.
    of_motion: Vec<usize>,
    /// The points that any variable moves.
    moved: Vec<PointId>,
    /// For an axle: its outputs and stations; `outputs`, `quantities` and `stations` above are then unused.
    axle: Option<Arc<AxleFunction>>,
}

/// Whether a design could be evaluated.
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
    /// The outputs of a study over its motion, as a function of its variables ([`DesignVariable::of`]). Errors as
    /// [`FunctionError`] says.
    pub fn of(study: &Study) -> Result<Self, FunctionError> {
        DesignFunction::with_variables(study, DesignVariable::of(study))
    }

    /// The outputs of a study over its motion, as a function of these variables.
    pub fn with_variables(
        study: &Study,
        names: Vec<DesignVariable>,
    ) -> Result<Self, FunctionError> {
        let is_own_drive = study.motion.drive != crate::study::Drive::PaperTheta;
        if study.formulation != Formulation::KnucklePose || !is_own_drive {
            return Err(FunctionError::Formulation);
        }
        let axle = study.axle.as_ref();
        let axle = axle.map(|both| Arc::new(AxleFunction::of(both)));
        let plan = Plan::of(study);
        let outputs: Vec<Output> = plan
            .outputs
            .into_iter()
            .filter(|o| !matches!(o.quantity, Quantity::AngularVelocity(_)))
            .collect();
        if outputs.is_empty() && axle.is_none() {
            return Err(FunctionError::NoOutputs);
        }
        let stations = Stations::of(&study.motion, &study.suspension.frame, &[]);
        let of_motion = stations.of_motion().collect();
        let variables: Vec<Variable> = names.iter().map(|v| v.moved.clone()).collect();
        let mut moved: Vec<PointId> = variables.iter().flat_map(Variable::points).collect();
        moved.sort_unstable();
        moved.dedup();
        let function = DesignFunction {
            suspension: Arc::new(study.suspension.clone()),
            quantities: outputs.iter().map(|o| o.quantity).collect(),
            outputs,
            names,
            variables,
            stations,
            of_motion,
            moved,
            axle,
        };
        let solved = match &function.axle {
            Some(axle) => {
                let solved = axle.evaluator(true).map(drop);
                solved.map_err(|fault| axle.both.axle.describe_fault(fault))
            }
            None => {
                let solved = function.values().map(drop);
                let solved = solved.and_then(|()| function.gradients().map(drop));
                solved.map_err(|fault| fault.describe(&function.suspension.mechanism))
            }
        };
        // From here on workspaces can be made.
        solved.map_err(FunctionError::Design)?;
        Ok(function)
    }

    /// The variables, with names and ranges, in the order of a row of `x`.
    pub fn variables(&self) -> &[DesignVariable] {
        &self.names
    }

    /// Names of the outputs with their units, as columns have them.
    pub fn outputs(&self) -> Vec<String> {
        if let Some(axle) = &self.axle {
            return axle.outputs();
        }
        let name = |o: &Output| with_unit(&o.name, &o.unit);
        self.outputs.iter().map(name).collect()
    }

    /// Drive value and rack displacement of each station in the units and axes of the results. For an axle the drive
    /// value is that of the first number that moves.
    pub fn motion(&self) -> Vec<[f64; 2]> {
        if let Some(axle) = &self.axle {
            return axle.motion();
        }
        let sign = self.suspension.frame.sign(Axis::Y);
        let printed = |v: f64| match self.stations.drive {
            Drive::Travel => v,
            Drive::ArmAngle => v.to_degrees(),
        };
        let stations = &self.stations;
        let at = |station: &usize| {
            let value = stations.values()[stations.value_of(*station)];
            let rack = stations.racks[stations.rack_of(*station)];
            [printed(value), sign * rack + 0.0]
        };
        self.of_motion.iter().map(at).collect()
    }

    /// Number of stations.
    pub fn stations(&self) -> usize {
        let of_axle = self.axle.as_ref().map(|axle| axle.placements.len());
        of_axle.unwrap_or(self.of_motion.len())
    }

    /// Numbers of an evaluation of one design: outputs times stations.
    pub fn len(&self) -> usize {
        let of_axle = self.axle.as_ref().map(|axle| axle.columns.len());
        of_axle.unwrap_or(self.outputs.len()) * self.stations()
    }

    /// Whether there is nothing to evaluate; there always is.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A workspace to evaluate with, one for each thread. What it needs for values, and for derivatives, it makes when
    /// it is first asked for them.
    pub fn evaluation(&self) -> Evaluation<'_> {
        Evaluation {
            function: self,
            values: None,
            gradients: None,
            of_axle: None,
            designs: Vec::new(),
            offsets: DVector::zeros(self.variables.len()),
            point_rates: Vec::new(),
        }
    }

    fn values(&self) -> Result<Values<'_>, DesignFault> {
        let evaluator = Evaluator::new(&self.suspension, &self.stations, &self.quantities)?;
        let block = Block::new(self.quantities.len(), self.stations.count());
        Ok((evaluator, block))
    }

    fn gradients(&self) -> Result<Gradients<'_>, DesignFault> {
        let (suspension, quantities) = (&*self.suspension, &self.quantities[..]);
        let (stations, width) = (&self.stations, Some(Width::widest()));
        let moved = &self.moved;
        let evaluator = GradientEvaluator::new(suspension, stations, quantities, moved, width)?;
        Ok((evaluator, Evaluated::default()))
    }
}

/// A workspace of a [`DesignFunction`]. It computes on the thread that calls: where the engine was compiled without
/// optimisation (the dev profile of a program that embeds it) that takes 8 MiB of stack, four times what a thread of
/// `std::thread` or rayon has unless it is said.
pub struct Evaluation<'f> {
    function: &'f DesignFunction,
    values: Option<Values<'f>>,
    gradients: Option<Gradients<'f>>,
    of_axle: Option<OfAxle<'f>>,
    designs: Vec<Vector3<f64>>,
    offsets: DVector<f64>,
    point_rates: Vec<PointRate>,
}

/// The evaluator of values, and the block it fills.
type Values<'f> = (Evaluator<'f>, Block);

/// The evaluator of values with derivatives, and room for what it finds.
type Gradients<'f> = (GradientEvaluator<'f>, Evaluated);

/// Evaluator of an axle. `differentiates` says whether it forms derivatives; `right` and `right_rates` are the design
/// and point rates of a right wheel that has its own hardpoints.
struct OfAxle<'f> {
    differentiates: bool,
    evaluator: Box<dyn AxleEvaluator + 'f>,
    right: Vec<Vector3<f64>>,
    right_rates: Vec<PointRate>,
}

impl<'f> Evaluation<'f> {
    /// The values of several designs, in SIMD lanes: `x` has a row of variables for each, `values` gets
    /// `[design][output][station]`, `status` an entry for each.
    ///
    /// # Panics
    /// If the slices do not fit each other.
    pub fn values(&mut self, x: &[f64], values: &mut [f64], status: &mut [DesignStatus]) {
        let f = self.function;
        let width = f.variables.len();
        let count = status.len();
        assert_eq!(x.len(), count * width, "a row of variables for each design");
        assert_eq!(values.len(), count * f.len(), "room for each design");
        if let Some(axle) = &f.axle {
            return self.evaluate_axles(axle, x, values, None, status);
        }
        let mut first = 0;
        while first < count {
            let now = (count - first).min(BLOCK);
            self.place(&x[first * width..(first + now) * width], now);
            let make = || f.values().expect("the function was made with one");
            let (evaluator, block) = self.values.get_or_insert_with(make);
            evaluator.evaluate(&self.designs, block);
            for number in 0..now {
                let at = (first + number) * f.len();
                let own = &mut values[at..at + f.len()];
                for (k, output) in f.outputs.iter().enumerate() {
                    for (s, station) in f.of_motion.iter().enumerate() {
                        let value = block.value(number, k, *station) * output.factor;
                        own[k * f.of_motion.len() + s] = value;
                    }
                }
            }
            let status = &mut status[first..first + now];
            status.fill(DesignStatus::Ok);
            for failure in block.failures() {
                if f.of_motion.contains(&failure.station) {
                    status[failure.design] = DesignStatus::Failed;
                }
            }
            for (number, _) in block.faults() {
                status[*number] = DesignStatus::Faulty;
            }
            first += now;
        }
    }

    /// The values of several designs and their derivatives by the variables, exact, found together: `jacobian` gets
    /// `[design][output][station][variable]`, per length unit (per degree of a turn). Designs go side by side in
    /// SIMD lanes where what is asked for can be differentiated there, else one by one.
    ///
    /// # Panics
    /// If the slices do not fit each other.
    pub fn value_and_jacobian(
        &mut self,
        x: &[f64],
        values: &mut [f64],
        jacobian: &mut [f64],
        status: &mut [DesignStatus],
    ) {
        let f = self.function;
        let (width, count) = (f.variables.len(), status.len());
        assert_eq!(x.len(), count * width, "a row of variables for each design");
        assert_eq!(values.len(), count * f.len(), "room for each design");
        assert_eq!(
            jacobian.len(),
            values.len() * width,
            "room for each derivative"
        );
        if let Some(axle) = &f.axle {
            return self.evaluate_axles(axle, x, values, Some(jacobian), status);
        }
        let make = || f.gradients().expect("the function was made with one");
        let (mut evaluator, mut found) = self.gradients.take().unwrap_or_else(make);
        let at_once = evaluator.at_once();
        for first in (0..count).step_by(at_once) {
            let now = at_once.min(count - first);
            self.place(&x[first * width..(first + now) * width], now);
            evaluator.evaluate(&self.designs, &mut found);
            for number in 0..now {
                let design = first + number;
                self.differentiate(&x[design * width..(design + 1) * width]);
                let at = design * f.len();
                status[design] = self.read(
                    &found,
                    number,
                    &mut values[at..at + f.len()],
                    &mut jacobian[at * width..(at + f.len()) * width],
                );
            }
        }
        self.gradients = Some((evaluator, found));
    }

    /// Evaluates designs of an axle, with derivatives if there is a `jacobian` to write them to.
    fn evaluate_axles(
        &mut self,
        axle: &'f AxleFunction,
        x: &[f64],
        values: &mut [f64],
        mut jacobian: Option<&mut [f64]>,
        status: &mut [DesignStatus],
    ) {
        let f = self.function;
        let (width, row) = (f.variables.len(), f.len());
        let differentiates = jacobian.is_some();
        let known = self.of_axle.take();
        let known = known.filter(|known| known.differentiates == differentiates);
        let mut of_axle = known.unwrap_or_else(|| {
            let evaluator = axle.evaluator(differentiates);
            let evaluator = evaluator.map_err(|(_, fault)| fault);
            OfAxle {
                differentiates,
                evaluator: evaluator.expect("the function was made with one"),
                right: Vec::new(),
                right_rates: Vec::new(),
            }
        });
        for (number, status) in status.iter_mut().enumerate() {
            let x = &x[number * width..(number + 1) * width];
            self.place(x, 1);
            self.differentiate(x);
            let OfAxle {
                evaluator,
                right,
                right_rates,
                ..
            } = &mut of_axle;
            let left = (&self.designs[..], &self.point_rates[..]);
            let mut sides = [left; 2];
            if let Some(own) = &axle.both.axle.right {
                f.right_design(own, &self.offsets, &self.designs, right);
                let (frame, offsets) = (&f.suspension.frame, &self.offsets);
                point_rates(&own.design, frame, &f.variables, offsets, right_rates);
                sides[1] = (right, right_rates);
            }
            let values = &mut values[number * row..(number + 1) * row];
            let at = number * row * width..(number + 1) * row * width;
            let jacobian = jacobian.as_mut().map(|jacobian| &mut jacobian[at]);
            *status = evaluator.evaluate(sides, values, jacobian);
        }
        self.of_axle = Some(of_axle);
    }

    /// Forms the `count` designs whose variables are `x`.
    fn place(&mut self, x: &[f64], count: usize) {
        let (width, points) = (self.offsets.len(), self.function.suspension.design.len());
        self.designs.resize(count * points, Vector3::default());
        for number in 0..count {
            let x = &x[number * width..(number + 1) * width];
            self.function.offsets(x, &mut self.offsets);
            let into = &mut self.designs[number * points..(number + 1) * points];
            self.function.design(x, &self.offsets, into);
        }
    }

    /// Finds how the variables move the points at `x`.
    fn differentiate(&mut self, x: &[f64]) {
        let f = self.function;
        let Suspension { design, frame, .. } = &*f.suspension;
        f.offsets(x, &mut self.offsets);
        point_rates(
            design,
            frame,
            &f.variables,
            &self.offsets,
            &mut self.point_rates,
        );
    }

    /// Copies the values of design `number`, and its derivatives by the variables, which are formed from those by
    /// points.
    fn read(
        &self,
        found: &Evaluated,
        number: usize,
        values: &mut [f64],
        jacobian: &mut [f64],
    ) -> DesignStatus {
        let f = self.function;
        let width = f.variables.len();
        for (k, output) in f.outputs.iter().enumerate() {
            for (s, station) in f.of_motion.iter().enumerate() {
                let place = k * f.of_motion.len() + s;
                let row = &mut jacobian[place * width..(place + 1) * width];
                let value = found.value(number, k, *station) * output.factor;
                if !found.is_solved(number, *station) || !value.is_finite() {
                    values[place] = f64::NAN;
                    row.fill(f64::NAN);
                    continue;
                }
                values[place] = value;
                row.fill(0.0);
                let gradient = found.gradient(number, k, *station);
                for rate in &self.point_rates {
                    row[rate.column] += gradient[rate.point].dot(rate.by) * output.factor;
                }
            }
        }
        let is_solved = |station: &usize| found.is_solved(number, *station);
        match found.fault(number) {
            Some(_) => DesignStatus::Faulty,
            None if f.of_motion.iter().all(is_solved) => DesignStatus::Ok,
            None => DesignStatus::Failed,
        }
    }

    /// Why a station of the designs whose values were last asked for has no pose: (design, station of the motion,
    /// reason).
    pub fn failures(&self) -> impl Iterator<Item = (usize, usize, &StationFailure)> {
        let f = self.function;
        let failures = self.values.iter().flat_map(|(_, block)| block.failures());
        failures.filter_map(|failure| {
            let own = f.of_motion.iter().position(|s| *s == failure.station)?;
            Some((failure.design, own, &failure.failure))
        })
    }
}

impl DesignFunction {
    /// Writes the offsets from the design into `into`; those of variables that are coordinates are 0.
    fn offsets(&self, x: &[f64], into: &mut DVector<f64>) {
        for ((variable, x), into) in self.names.iter().zip(x).zip(into.iter_mut()) {
            *into = if variable.absolute { 0.0 } else { *x };
        }
    }

    /// Writes the design of a right wheel with hardpoints of its own, which moves as the left one does, into `into`.
    fn right_design(
        &self,
        own: &Suspension,
        offsets: &DVector<f64>,
        left: &[Vector3<f64>],
        into: &mut Vec<Vector3<f64>>,
    ) {
        let Suspension { design, frame, .. } = &*self.suspension;
        into.clone_from(&own.design);
        moved_design(&own.design, frame, &self.variables, offsets, into);
        for variable in self.names.iter().filter(|v| v.absolute) {
            for m in &variable.moved.moves {
                let (point, axis) = (m.point.0, m.axis);
                into[point][axis] =
                    own.design[point][axis] + (left[point][axis] - design[point][axis]);
            }
        }
    }

    /// Writes the design at `x` into `into`: variables are offsets, or coordinates for those that are absolute.
    fn design(&self, x: &[f64], offsets: &DVector<f64>, into: &mut [Vector3<f64>]) {
        let Suspension { design, frame, .. } = &*self.suspension;
        moved_design(design, frame, &self.variables, offsets, into);
        for (variable, value) in self.names.iter().zip(x).filter(|(v, _)| v.absolute) {
            for m in &variable.moved.moves {
                m.apply(frame, *value, true, into);
            }
        }
    }
}
