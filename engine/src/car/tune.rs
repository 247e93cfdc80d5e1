//! Tuning of a car: results of load cases against targets, by hardpoints, rates and figures of the car.

use super::parameters::{AxleParameter, BodyParameter, Parameter};
use super::{Car, CarGradient, CarQuantity, CarSolver, Case};
use crate::axle::Law;
use crate::model::{Axis, PointId, Side};
use crate::optimise::{
    Bounds, Control, Fit, Infeasible, LeastSquares, Linearisation, Options, multistart,
};
use nalgebra::DVector;

/// Quantity that a variable moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moves {
    /// A coordinate of a hardpoint of both wheels of an axle, 0 the front one; in the study's axes.
    Hardpoint {
        /// The axle.
        axle: usize,
        /// The hardpoint.
        point: PointId,
        /// The coordinate.
        axis: Axis,
    },
    /// A rate of an axle.
    Rate {
        /// The axle.
        axle: usize,
        /// The rate.
        parameter: AxleParameter,
    },
    /// A figure of the car, in the axes of the front study.
    Body(BodyParameter),
    /// The wheelbase.
    Wheelbase,
}

/// A number that moves a part of the car: an offset of a hardpoint, else a value.
#[derive(Clone, Debug, PartialEq)]
pub struct CarVariable {
    /// Quantity that the variable moves.
    pub moves: Moves,
    /// Lowest and highest value.
    pub range: [f64; 2],
}

/// A target of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct CarTarget {
    /// The result.
    pub quantity: CarQuantity,
    /// Number of the case.
    pub case: usize,
    /// Lowest and highest wanted value, as printed; the same for a value.
    pub wanted: [f64; 2],
    /// Deviation that counts as one.
    pub tolerance: f64,
    /// Weight.
    pub weight: f64,
}

impl CarTarget {
    /// Deviation of a printed value from the wanted one; 0 within a band.
    pub fn deviation(&self, found: f64) -> f64 {
        let [low, high] = self.wanted;
        found - found.clamp(low, high)
    }
}

impl Moves {
    /// The coordinate of a figure of the car that this is, if it is one.
    fn axis(parameter: BodyParameter) -> Option<Axis> {
        match parameter {
            BodyParameter::CgX => Some(Axis::X),
            BodyParameter::CgY => Some(Axis::Y),
            BodyParameter::CgZ => Some(Axis::Z),
            _ => None,
        }
    }

    /// Sign between the study's axes and the kernel's.
    fn sign(&self, car: &Car) -> f64 {
        match self {
            Moves::Hardpoint { axle, axis, .. } => car.axles[*axle].left.frame.sign(*axis),
            Moves::Body(parameter) => {
                Moves::axis(*parameter).map_or(1.0, |axis| car.axles[0].left.frame.sign(axis))
            }
            _ => 1.0,
        }
    }

    /// The value in a car, as the study writes it; 0 for the offset of a hardpoint. `None` if the car has no such figure.
    pub fn value(&self, car: &Car) -> Option<f64> {
        match *self {
            Moves::Hardpoint { .. } => Some(0.0),
            Moves::Rate { axle, parameter } => {
                let setup = &car.axles[axle].setup;
                match parameter {
                    AxleParameter::SpringRate => match &setup.springs.as_ref()?[0].spring {
                        Law::Linear { rate, .. } => Some(*rate),
                        Law::Curve(_) => None,
                    },
                    _ if !parameter.is_of(&car.axles[axle]) => None,
                    AxleParameter::BarRate => setup.bar_rate,
                    AxleParameter::HeaveSpringRate => Some(setup.rocker_springs.heave_spring?.rate),
                    AxleParameter::TBarRate => setup.rocker_springs.t_bar,
                    AxleParameter::HeaveBarRate => Some(setup.rocker_springs.heave_bar?.rate),
                    AxleParameter::TyreRate => Some(car.tyres?[axle].rate),
                    _ => None,
                }
            }
            Moves::Body(parameter) => {
                let sign = self.sign(car);
                match parameter {
                    BodyParameter::Mass => Some(car.mass),
                    BodyParameter::CgX => Some(sign * car.cg.x),
                    BodyParameter::CgY => Some(sign * car.cg.y),
                    BodyParameter::CgZ => Some(sign * car.cg.z),
                    BodyParameter::BrakeShareFront => car.brake_share_front,
                    BodyParameter::DriveShareFront => car.drive_share_front,
                    _ => None,
                }
            }
            Moves::Wheelbase => {
                let mid = |axle: usize| {
                    let centre = |side: Side| {
                        let wheel = car.axles[axle].suspension(side);
                        wheel.design[wheel.mechanism.wheel_centre.0].x
                    };
                    0.5 * (centre(Side::Left) + centre(Side::Right))
                };
                Some(mid(0) - mid(1) - car.rear_offset.x)
            }
        }
    }

    /// Moves a part of the car to a value; a hardpoint by it.
    pub fn apply(&self, value: f64, car: &mut Car) {
        let sign = self.sign(car);
        let now = self.value(car).unwrap_or(0.0);
        match *self {
            Moves::Hardpoint { axle, point, axis } => {
                let axle = &mut car.axles[axle];
                let mut left = axle.left.design.clone();
                left[point.0][axis] += sign * value;
                axle.complete(&mut left);
                let right = axle.right_design(&left).map(|points| points.collect());
                if let (Some(wheel), Some(design)) = (&mut axle.right, right) {
                    wheel.design = design;
                }
                axle.left.design = left;
            }
            Moves::Rate { axle, parameter } => {
                let setup = &mut car.axles[axle].setup;
                match parameter {
                    AxleParameter::SpringRate => {
                        for law in setup.springs.iter_mut().flatten() {
                            if let Law::Linear { rate, .. } = &mut law.spring {
                                *rate += value - now;
                            }
                        }
                    }
                    AxleParameter::BarRate => setup.bar_rate = Some(value),
                    AxleParameter::TBarRate => setup.rocker_springs.t_bar = Some(value),
                    AxleParameter::HeaveSpringRate => {
                        if let Some(law) = &mut setup.rocker_springs.heave_spring {
                            law.rate = value;
                        }
                    }
                    AxleParameter::HeaveBarRate => {
                        if let Some(law) = &mut setup.rocker_springs.heave_bar {
                            law.rate = value;
                        }
                    }
                    _ => {
                        if let Some(tyres) = &mut car.tyres {
                            tyres[axle].rate = value;
                        }
                    }
                }
            }
            Moves::Body(parameter) => match parameter {
                BodyParameter::Mass => car.mass = value,
                BodyParameter::CgX => car.cg.x = sign * value,
                BodyParameter::CgY => car.cg.y = sign * value,
                BodyParameter::CgZ => car.cg.z = sign * value,
                BodyParameter::BrakeShareFront => car.brake_share_front = Some(value),
                _ => car.drive_share_front = Some(value),
            },
            Moves::Wheelbase => car.rear_offset.x -= value - now,
        }
    }

    /// Its name in columns, without the unit: `front_tie_rod_inner_dz`, `rear_anti_roll_bar_rate`, `car_cg_z`.
    pub fn stem(&self, car: &Car) -> String {
        match *self {
            Moves::Hardpoint { axle, point, axis } => {
                let name = car.axles[axle].left.mechanism.name(point);
                format!("{}_{name}_d{}", ["front", "rear"][axle], axis.name())
            }
            _ => self.label(car).replace('.', "_"),
        }
    }

    /// Its unit; empty for a share.
    pub fn unit(&self, car: &Car) -> String {
        let length = car.length_unit.symbol();
        match self {
            Moves::Hardpoint { .. } | Moves::Wheelbase => length.to_owned(),
            Moves::Rate { parameter, .. } => match parameter {
                AxleParameter::BarRate | AxleParameter::TBarRate | AxleParameter::HeaveBarRate => {
                    format!("N_{length}_per_rad")
                }
                _ => format!("N_per_{length}"),
            },
            Moves::Body(BodyParameter::Mass) => "kg".to_owned(),
            Moves::Body(parameter) if Moves::axis(*parameter).is_some() => length.to_owned(),
            Moves::Body(_) => String::new(),
        }
    }

    /// The derivative of a result by the variable.
    pub fn slope(&self, car: &Car, gradient: &CarGradient) -> f64 {
        let by = |parameter: Parameter| gradient.parameters[parameter.place()];
        match *self {
            Moves::Hardpoint { axle, point, axis } => {
                self.sign(car) * gradient.hardpoints[axle][point.0][axis]
            }
            Moves::Rate { axle, parameter } => by(Parameter::Axle(axle, parameter)),
            Moves::Body(parameter) => self.sign(car) * by(Parameter::Body(parameter)),
            Moves::Wheelbase => -by(Parameter::Axle(1, AxleParameter::OffsetX)),
        }
    }

    /// Name of the variable.
    pub fn label(&self, car: &Car) -> String {
        let end = |axle: usize| ["front", "rear"][axle];
        match *self {
            Moves::Hardpoint { axle, point, axis } => {
                let name = car.axles[axle].left.mechanism.name(point);
                format!("{}.{name}.{}", end(axle), axis.name())
            }
            Moves::Rate { axle, parameter } => format!("{}.{}", end(axle), rate_key(parameter)),
            Moves::Body(parameter) => format!("car.{}", body_key(parameter)),
            Moves::Wheelbase => "car.wheelbase".to_owned(),
        }
    }
}

/// Key of a rate in an axle's study.
pub fn rate_key(parameter: AxleParameter) -> &'static str {
    match parameter {
        AxleParameter::SpringRate => "spring.rate",
        AxleParameter::SpringForce => "spring.force",
        AxleParameter::BarRate => "anti_roll_bar.rate",
        AxleParameter::HeaveSpringRate => "heave_spring.rate",
        AxleParameter::HeaveSpringForce => "heave_spring.force",
        AxleParameter::TBarRate => "t_bar.rate",
        AxleParameter::HeaveBarRate => "heave_bar.rate",
        AxleParameter::HeaveBarTorque => "heave_bar.torque",
        AxleParameter::TyreRate => "tyre.rate",
        AxleParameter::Radius => "wheel.radius",
        AxleParameter::UnsprungMass => "vehicle.unsprung_mass",
        AxleParameter::OffsetX => "offset_x",
        AxleParameter::OffsetY => "offset_y",
        AxleParameter::OffsetZ => "offset_z",
        AxleParameter::Rack => "rack",
    }
}

/// Name of a figure of the body or the case.
pub fn body_key(parameter: BodyParameter) -> &'static str {
    match parameter {
        BodyParameter::Mass => "mass",
        BodyParameter::CgX => "cg_x",
        BodyParameter::CgY => "cg_y",
        BodyParameter::CgZ => "cg_z",
        BodyParameter::BrakeShareFront => "brake_share_front",
        BodyParameter::DriveShareFront => "drive_share_front",
        BodyParameter::Ax => "ax",
        BodyParameter::Ay => "ay",
        BodyParameter::Az => "az",
        BodyParameter::Speed => "speed",
        BodyParameter::Warp => "warp",
    }
}

/// The car with variables at these values.
pub fn moved(car: &Car, variables: &[CarVariable], x: &[f64]) -> Car {
    let mut moved = car.clone();
    for (variable, value) in variables.iter().zip(x) {
        variable.moves.apply(*value, &mut moved);
    }
    moved
}

/// Targets of cases as a least-squares problem.
struct Objective<'a> {
    car: &'a Car,
    cases: &'a [Case],
    variables: &'a [CarVariable],
    targets: &'a [CarTarget],
}

impl LeastSquares for Objective<'_> {
    fn variables(&self) -> usize {
        self.variables.len()
    }

    fn residuals(&self) -> usize {
        self.targets.len()
    }

    fn evaluate(&mut self, x: &DVector<f64>, into: &mut Linearisation) -> Result<(), Infeasible> {
        let car = moved(self.car, self.variables, x.as_slice());
        let refused = |text: String| Infeasible::Refused(text);
        let solver = CarSolver::new(&car);
        let mut solver = solver.map_err(|(axle, side, fault)| {
            refused(car.axles[axle].describe_fault((side, fault)))
        })?;
        for (number, case) in self.cases.iter().enumerate() {
            let rows: Vec<usize> = (0..self.targets.len())
                .filter(|row| self.targets[*row].case == number)
                .collect();
            if rows.is_empty() {
                continue;
            }
            let fails = |why: super::NoEquilibrium| refused(format!("case {}: {why}", case.name));
            let found = solver.solve(case).map_err(fails)?;
            let quantities: Vec<CarQuantity> =
                rows.iter().map(|row| self.targets[*row].quantity).collect();
            let gradients = solver.gradients(case, &found, &quantities).map_err(fails)?;
            for (row, gradient) in rows.into_iter().zip(&gradients) {
                let target = &self.targets[row];
                let printed = target.quantity.info().unit.printed_factor(car.length_unit);
                let scale = target.weight.sqrt() / target.tolerance;
                let deviation = target.deviation(printed * gradient.value);
                into.residuals[row] = scale * deviation;
                // Inside a band nothing changes the deviation.
                let is_inside = deviation == 0.0 && target.wanted[0] < target.wanted[1];
                for (column, variable) in self.variables.iter().enumerate() {
                    let slope = match is_inside {
                        true => 0.0,
                        false => variable.moves.slope(&car, gradient),
                    };
                    into.jacobian[(row, column)] = scale * printed * slope;
                }
            }
        }
        Ok(())
    }
}

/// Budget and starts of a tuning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CarRun {
    /// Cap on iterations of each start.
    pub max_iterations: u64,
    /// Number of starts: the design, then points spread over the ranges.
    pub starts: usize,
    /// Seed of the points.
    pub seed: u32,
}

/// Tunes a car, and returns the best of several starts. Errors if the cases cannot be solved in the study's design, or a range
/// is empty.
pub fn tune(
    car: &Car,
    cases: &[Case],
    variables: &[CarVariable],
    targets: &[CarTarget],
    run: CarRun,
    control: Control<'_>,
) -> Result<Fit, String> {
    let ranges: Vec<[f64; 2]> = variables.iter().map(|variable| variable.range).collect();
    let bounds = Bounds::new(&ranges).map_err(|fault| fault.to_string())?;
    let start = variables
        .iter()
        .map(|variable| variable.moves.value(car).unwrap_or(0.0));
    let start = DVector::from_iterator(variables.len(), start);
    let options = Options {
        max_iterations: run.max_iterations,
        max_evaluations: 10 * run.max_iterations,
        ..Options::default()
    };
    let objective = || Objective {
        car,
        cases,
        variables,
        targets,
    };
    let starts = run.starts.max(1);
    let found = multistart(
        objective, &bounds, &start, starts, run.seed, &options, control,
    );
    let mut starts = found.starts;
    // Without a best start the reason is that of the design.
    let best = starts.swap_remove(found.best.unwrap_or(0));
    best.outcome.map_err(|fault| fault.to_string())
}
