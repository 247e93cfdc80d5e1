//! Curves as a pure function of the design: the inputs are values of variables, the results are values and exact Jacobians.
//!
//! Optimisers, surrogate models and differentiable programs need such a function. A [`DesignFunction`] owns its data, is
//! `Send + Sync` and has no lifetime. Every thread takes a separate [`Evaluation`] from the function. Arrays are plain
//! slices; the last index runs fastest. Values are in the units of the column names. Offsets and coordinates are in the
//! study's length unit and axes, rotations in degrees. A value that does not exist is NaN. A status tells whether every
//! station has a pose. The results contain a row for every design.
//!
//! A variable of an axle moves the same points of both wheels, each in the frame of its side. So a derivative is a sum over
//! the moved points of both wheels: the gradient with respect to the point, times the rate of the point. If the right wheel
//! has different hardpoints, they move by the same offsets, and rotate by the same angle about their own centroid.

mod variable;

pub use variable::{DesignVariable, FunctionError};

use crate::axle::Axle;
use crate::curves::Column;
use crate::evaluate::{
    AxleStations, BLOCK, Block, Evaluated, Evaluator, GradientEvaluator, Request, Stations,
};
use crate::mechanism::{DesignFault, NoPose};
use crate::model::{Axis, Drive, PointId, Side, Suspension};
use crate::number::{Vector3, Width};
use crate::optimise::{PointRate, moved_design, point_rates};
use crate::plan::{Output, Plan};
use crate::study::{AxleStudy, Formulation, Study, Variable, Vehicle, WheelStudy};
use nalgebra::DVector;
use std::borrow::Cow;
use std::sync::Arc;

/// Curves of a study as a function of its variables.
#[derive(Clone, Debug)]
pub struct DesignFunction {
    /// Single wheel, or left wheel of an axle.
    suspension: Arc<Suspension>,
    /// Right wheel of an axle, if its hardpoints differ from the left ones.
    right: Option<Arc<Suspension>>,
    names: Vec<DesignVariable>,
    /// Variables in the form that the solver uses, in the order of `names`: the points that each variable moves.
    variables: Vec<Variable>,
    request: Arc<Request<'static>>,
    /// Index of each station of the motion among the stations of `request`. The results have the order of `of_motion`.
    of_motion: Vec<usize>,
    /// Drive value and rack displacement of each station of the motion, in printed units.
    motion: Vec<[f64; 2]>,
    /// Points that any variable moves.
    moved: Vec<PointId>,
}

/// Status of the evaluation of a design.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum DesignStatus {
    /// Every station has a pose. A value that is not defined in its pose is NaN.
    Ok = 0,
    /// At least one station has no pose, lacks values at a toggle of a rocker, or has no derivatives.
    Failed = 1,
    /// The design cannot be solved at all.
    Faulty = 2,
}

impl DesignFunction {
    /// Makes the function of a study over its motion, with the variables of [`DesignVariable::of`]. The outputs are the
    /// characteristics and point coordinates of a wheel, or the quantities of an axle; other outputs are left out. Returns a
    /// [`FunctionError`] if the study cannot be converted to a function.
    pub fn of(study: &Study) -> Result<Self, FunctionError> {
        DesignFunction::with_variables(study, DesignVariable::of(study))
    }

    /// Makes the function of a study, with the given variables instead of the study's variables.
    pub fn with_variables(
        study: &Study,
        names: Vec<DesignVariable>,
    ) -> Result<Self, FunctionError> {
        let (request, motion) = match &study.vehicle {
            Vehicle::Axle(both) => of_axle(both)?,
            Vehicle::Wheel(own) => of_corner(own)?,
        };
        let variables: Vec<Variable> = names.iter().map(|v| v.moved.clone()).collect();
        let mut moved: Vec<PointId> = variables.iter().flat_map(Variable::points).collect();
        moved.sort_unstable();
        moved.dedup();
        let right = study.axle().and_then(|both| both.axle.right.clone());
        let function = DesignFunction {
            suspension: Arc::new(study.wheel().clone()),
            right: right.map(Arc::new),
            of_motion: request.stations().of_motion().collect(),
            motion,
            request: Arc::new(request),
            names,
            variables,
            moved,
        };
        let solved = function.gradients().map(drop);
        let solved = solved.map_err(|(side, fault)| match study.axle() {
            Some(both) => both.axle.describe_fault((side, fault)),
            None => fault.describe(&study.wheel().mechanism),
        });
        let solved = solved.and_then(|()| {
            let values = function.values().map(drop);
            values.map_err(|fault| fault.describe(&study.wheel().mechanism))
        });
        // Checks that the evaluators can be made for this design. Later evaluations make them in the same way, so they
        // cannot fail.
        solved.map_err(FunctionError::Design)?;
        Ok(function)
    }

    /// Variables with names and ranges. A row of `x` in [`Evaluation::values`] has the same order.
    pub fn variables(&self) -> &[DesignVariable] {
        &self.names
    }

    /// Names of the outputs with their units, as in column headings.
    pub fn outputs(&self) -> Vec<String> {
        let columns = self.request.columns().iter();
        columns.map(|column| column.name.clone()).collect()
    }

    /// Drive value and rack displacement of each station, in the units and axes of the results. For an axle, the drive value
    /// is the value of the coordinate that is the abscissa of curves.
    pub fn motion(&self) -> Vec<[f64; 2]> {
        self.motion.clone()
    }

    /// Number of stations.
    pub fn stations(&self) -> usize {
        self.of_motion.len()
    }

    /// Number of values for one design: outputs times stations.
    pub fn len(&self) -> usize {
        self.request.columns().len() * self.stations()
    }

    /// Returns true if the function has no values. This is never the case for a function that [`DesignFunction::of`] makes.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Makes a workspace for evaluations, one for each CPU thread. The workspace makes its evaluators when values or
    /// derivatives are first requested.
    pub fn evaluation(&self) -> Evaluation<'_> {
        Evaluation {
            function: self,
            values: None,
            gradients: None,
            failures: Vec::new(),
            designs: Vec::new(),
            rights: Vec::new(),
            offsets: DVector::zeros(self.variables.len()),
            point_rates: Default::default(),
        }
    }

    fn values(&self) -> Result<Values<'_>, DesignFault> {
        let evaluator = self.request.evaluator(Width::widest())?;
        Ok((evaluator, self.request.block()))
    }

    fn gradients(&self) -> Result<Gradients<'_>, (Side, DesignFault)> {
        let width = Width::widest();
        let evaluator = self.request.gradients(&self.moved, width)?;
        Ok((evaluator, Evaluated::default()))
    }
}

/// Makes the request for a wheel's outputs over its motion. Also returns drive value and rack displacement of each station in
/// printed units.
fn of_corner(own: &WheelStudy) -> Result<(Request<'static>, Vec<[f64; 2]>), FunctionError> {
    let is_own_drive = own.motion.drive != crate::study::Drive::PaperTheta;
    if own.formulation != Formulation::KnucklePose || !is_own_drive {
        return Err(FunctionError::Formulation);
    }
    if own.compliance.is_some() {
        return Err(FunctionError::Elastic);
    }
    let suspension = &own.suspension;
    let mut plan = Plan::of(own);
    let is_output = |o: &Output| o.quantity().is_some_and(|quantity| !quantity.is_rate());
    plan.outputs.retain(is_output);
    for output in &mut plan.outputs {
        output.highest = 0;
    }
    if plan.outputs.is_empty() {
        return Err(FunctionError::NoOutputs);
    }
    let columns = Column::all(&plan, suspension.length_unit);
    let quantities = plan.outputs.iter().filter_map(Output::quantity).collect();
    let stations = Stations::of(&own.motion, &suspension.frame, &[]);
    let sign = suspension.frame.sign(Axis::Y);
    let printed = |value: f64| match stations.drive {
        Drive::Travel => value,
        Drive::ArmAngle => value.to_degrees(),
    };
    let at = |station: usize| {
        let value = stations.values()[stations.value_of(station)];
        let rack = stations.racks[stations.rack_of(station)];
        [printed(value), sign * rack + 0.0]
    };
    let motion = stations.of_motion().map(at).collect();
    let suspension = Cow::Owned(suspension.clone());
    let request = Request::of_corner(suspension, stations, quantities, columns);
    Ok((request, motion))
}

/// Makes the request for an axle's quantities over its motion. Also returns, for each station, the value of the coordinate that
/// is the abscissa, and the rack displacement, in printed units.
fn of_axle(
    AxleStudy { axle, plan, .. }: &AxleStudy,
) -> Result<(Request<'static>, Vec<[f64; 2]>), FunctionError> {
    if axle.elastic.is_some() {
        return Err(FunctionError::Elastic);
    }
    if plan.quantities.is_empty() {
        return Err(FunctionError::NoOutputs);
    }
    let plan = plan.quantities_alone();
    let over = plan.motion.moving()[0];
    let sign = axle.left.frame.sign(Axis::Y);
    let placements = plan.motion.placements().into_iter();
    let at = placements.map(|p| [over.written(p.along(over), axle), sign * p.rack() + 0.0]);
    let motion = at.collect();
    let axle: Cow<'static, Axle> = Cow::Owned(axle.clone());
    let stations = AxleStations::of(axle, &plan, []);
    Ok((Request::of_axle(stations), motion))
}

/// Workspace of a [`DesignFunction`]. It computes on the calling thread. If the engine is compiled without optimisation, as
/// in the dev profile of a program that embeds it, the evaluation needs 8 MiB of stack. By default, a thread of `std::thread`
/// or rayon has only 2 MiB.
pub struct Evaluation<'f> {
    function: &'f DesignFunction,
    values: Option<Values<'f>>,
    gradients: Option<Gradients<'f>>,
    /// Stations without a pose, or without all values, from the latest call of [`Evaluation::values`].
    failures: Vec<(usize, usize, NoPose)>,
    designs: Vec<Vector3<f64>>,
    /// Designs of right wheels. Empty for a single wheel, and for an axle whose right wheel is the mirror image of the left
    /// wheel.
    rights: Vec<Vector3<f64>>,
    offsets: DVector<f64>,
    /// Rates at which the variables move the points: of the left (or only) wheel, then of the right wheel.
    point_rates: [Vec<PointRate>; 2],
}

/// Evaluator of values, and memory for its results.
type Values<'f> = (Evaluator<'f>, Block);

/// Evaluator of values with derivatives, and memory for its results.
type Gradients<'f> = (GradientEvaluator<'f>, Evaluated);

impl<'f> Evaluation<'f> {
    /// Computes the values of several designs, in SIMD lanes where possible. `x` has a row of variables for each design,
    /// `values` has the shape `[design][output][station]`, and `status` has an entry for each design.
    ///
    /// # Panics
    /// Panics if the lengths of the slices do not match.
    pub fn values(&mut self, x: &[f64], values: &mut [f64], status: &mut [DesignStatus]) {
        let f = self.function;
        let (width, count) = (f.variables.len(), status.len());
        f.check_lengths(x, values, count);
        self.failures.clear();
        let mut first = 0;
        while first < count {
            let now = (count - first).min(BLOCK);
            self.place(&x[first * width..(first + now) * width], now);
            let make = || f.values().expect("the function has a workspace");
            let (evaluator, block) = self.values.get_or_insert_with(make);
            evaluator.evaluate_pairs([&self.designs, &self.rights], block);
            for number in 0..now {
                let at = (first + number) * f.len();
                let own = &mut values[at..at + f.len()];
                for (k, column) in f.request.columns().iter().enumerate() {
                    for (s, station) in f.of_motion.iter().enumerate() {
                        let value = block.value(number, k, *station) * column.factor();
                        own[k * f.of_motion.len() + s] = value;
                    }
                }
            }
            let status = &mut status[first..first + now];
            status.fill(DesignStatus::Ok);
            for failure in block.failures() {
                let own = f.of_motion.iter().position(|s| *s == failure.station);
                if let Some(station) = own {
                    status[failure.design] = DesignStatus::Failed;
                    let place = (first + failure.design, station, failure.failure);
                    self.failures.push(place);
                }
            }
            for (number, _) in block.faults() {
                status[*number] = DesignStatus::Faulty;
            }
            first += now;
        }
    }

    /// Computes the values of several designs together with their exact derivatives with respect to the variables. `jacobian`
    /// has the shape `[design][output][station][variable]`, per length unit (per degree for a rotation). If the outputs can be
    /// differentiated in SIMD lanes, several designs are computed at once. Otherwise designs are computed one by one.
    ///
    /// # Panics
    /// Panics if the lengths of the slices do not match.
    pub fn value_and_jacobian(
        &mut self,
        x: &[f64],
        values: &mut [f64],
        jacobian: &mut [f64],
        status: &mut [DesignStatus],
    ) {
        let f = self.function;
        let (width, count) = (f.variables.len(), status.len());
        f.check_lengths(x, values, count);
        assert_eq!(
            jacobian.len(),
            values.len() * width,
            "jacobian needs a number per value and variable"
        );
        let make = || f.gradients().expect("the function has a workspace");
        let (mut evaluator, mut found) = self.gradients.take().unwrap_or_else(make);
        let at_once = evaluator.at_once();
        for first in (0..count).step_by(at_once) {
            let now = at_once.min(count - first);
            self.place(&x[first * width..(first + now) * width], now);
            evaluator.evaluate([&self.designs, &self.rights], &mut found);
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

    /// Makes `count` designs from the values `x` of the variables.
    fn place(&mut self, x: &[f64], count: usize) {
        let f = self.function;
        let (width, points) = (self.offsets.len(), f.suspension.design.len());
        self.designs.resize(count * points, Vector3::default());
        let of_right = f.right.as_ref().map_or(0, |_| count * points);
        self.rights.resize(of_right, Vector3::default());
        for number in 0..count {
            let x = &x[number * width..(number + 1) * width];
            f.offsets(x, &mut self.offsets);
            let place = number * points..(number + 1) * points;
            let left = &mut self.designs[place.clone()];
            f.design(x, &self.offsets, left);
            if let Some(own) = &f.right {
                f.right_design(own, &self.offsets, left, &mut self.rights[place]);
            }
        }
    }

    /// Computes the rates at which the variables move the points. The rates apply to the design at `x`.
    fn differentiate(&mut self, x: &[f64]) {
        let f = self.function;
        f.offsets(x, &mut self.offsets);
        let [left, right] = &mut self.point_rates;
        let (frame, offsets) = (&f.suspension.frame, &self.offsets);
        point_rates(&f.suspension.design, frame, &f.variables, offsets, left);
        match &f.right {
            Some(own) => point_rates(&own.design, frame, &f.variables, offsets, right),
            None => right.clone_from(left),
        }
    }

    /// Copies the values of design `number`. Computes its derivatives with respect to the variables from the derivatives with
    /// respect to points.
    fn read(
        &self,
        found: &Evaluated,
        number: usize,
        values: &mut [f64],
        jacobian: &mut [f64],
    ) -> DesignStatus {
        let f = self.function;
        let width = f.variables.len();
        let sides = match f.request.axle() {
            Some(_) => &Side::ALL[..],
            None => &Side::ALL[..1],
        };
        for (k, column) in f.request.columns().iter().enumerate() {
            for (s, station) in f.of_motion.iter().enumerate() {
                let place = k * f.of_motion.len() + s;
                let row = &mut jacobian[place * width..(place + 1) * width];
                let value = found.value(number, k, *station) * column.factor();
                if !value.is_finite() {
                    values[place] = f64::NAN;
                    row.fill(f64::NAN);
                    continue;
                }
                values[place] = value;
                row.fill(0.0);
                for side in sides {
                    let gradient = found.gradient((number, k, *station), *side);
                    for rate in &self.point_rates[*side as usize] {
                        row[rate.column] += gradient[rate.point].dot(rate.by) * column.factor();
                    }
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

    /// Stations without a pose, or without all values, from the latest call of [`Evaluation::values`]: index of the design,
    /// station of the motion, and reason.
    pub fn failures(&self) -> impl Iterator<Item = (usize, usize, &NoPose)> {
        let failures = self.failures.iter();
        failures.map(|(design, station, reason)| (*design, *station, reason))
    }
}

impl DesignFunction {
    /// Panics if the lengths of `x` and `values` do not match the number of designs.
    fn check_lengths(&self, x: &[f64], values: &[f64], designs: usize) {
        assert_eq!(
            x.len(),
            designs * self.variables.len(),
            "x needs a row of variables for each design"
        );
        assert_eq!(
            values.len(),
            designs * self.len(),
            "values needs a number per output and station of each design"
        );
    }

    /// Writes the variables' offsets from the design into `into`. The offset is 0 for a variable that is a coordinate.
    fn offsets(&self, x: &[f64], into: &mut DVector<f64>) {
        for ((variable, x), into) in self.names.iter().zip(x).zip(into.iter_mut()) {
            *into = if variable.absolute { 0.0 } else { *x };
        }
    }

    /// Returns the study of this function with the variables at `x`.
    pub fn moved(&self, study: &Study, x: &[f64]) -> Study {
        let mut offsets = DVector::zeros(self.names.len());
        self.offsets(x, &mut offsets);
        let mut left = self.suspension.design.clone();
        self.design(x, &offsets, &mut left);
        let mut moved = study.at_design(left.clone());
        let own = study.axle().and_then(|both| both.axle.own_right());
        let right = moved.axle_mut().and_then(|both| both.axle.right.as_mut());
        if let (Some(own), Some(right)) = (own, right) {
            self.right_design(own, &offsets, &left, &mut right.design);
        }
        moved
    }

    /// Writes the design of the right wheel into `into`, if its hardpoints differ from the left ones. In the frame of
    /// its side, the right wheel has the same offsets as the left wheel, and the same rotations about its own centroids.
    fn right_design(
        &self,
        own: &Suspension,
        offsets: &DVector<f64>,
        left: &[Vector3<f64>],
        into: &mut [Vector3<f64>],
    ) {
        let Suspension { design, frame, .. } = &*self.suspension;
        moved_design(&own.design, frame, &self.variables, offsets, into);
        for variable in self.names.iter().filter(|v| v.absolute) {
            for m in &variable.moved.moves {
                let (point, axis) = (m.point.0, m.axis);
                into[point][axis] =
                    own.design[point][axis] + (left[point][axis] - design[point][axis]);
            }
        }
    }

    /// Writes the design at `x` into `into`. A variable is an offset, or a coordinate if it is absolute.
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
